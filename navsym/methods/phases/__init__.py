"""The complete guaranteed solution as a parameter varies."""
