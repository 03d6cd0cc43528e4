"""Closed forms of exp(F t)."""
