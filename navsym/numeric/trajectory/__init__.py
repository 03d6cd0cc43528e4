"""Compiled loops of the filters for tracks."""
