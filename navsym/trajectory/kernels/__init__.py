"""Compiled loops of smoothing and inversion."""
