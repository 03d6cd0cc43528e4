"""Verified formulas as code in several languages, with vectors, bounds and certificates beside it."""
