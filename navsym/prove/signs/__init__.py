"""Positive or not: exact signs, cones, half angles, derivatives, divided boxes."""
