"""How the optimum changes with a parameter: regimes, boundaries, closed forms."""
