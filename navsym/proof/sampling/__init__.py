"""Looking for a counterexample: points, a second look, a descent."""
