"""Answers for integrals, sums, products and limits: candidates of the algebra, and proofs that the checker accepts."""
