"""Condition numbers known with certainty."""
