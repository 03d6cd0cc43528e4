"""Filters for signals whose model switches, as truncations of one exact recursion."""
