"""Attacks on navsym itself."""
