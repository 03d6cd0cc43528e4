"""The Earth as an ellipsoid, positions on it, and motion over it."""
