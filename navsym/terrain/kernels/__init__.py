"""Compiled loops of the search over hypotheses."""
