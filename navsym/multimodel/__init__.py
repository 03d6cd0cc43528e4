"""Filters for signals whose model switches."""
