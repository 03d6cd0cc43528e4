"""Position and velocity from a height profile over a map."""
