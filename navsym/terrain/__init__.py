"""Position and velocity from a measured profile over a height map."""
