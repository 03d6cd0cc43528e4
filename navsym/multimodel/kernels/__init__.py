"""Compiled loops of the bank of filters."""
