"""How far computed values may lie from exact ones: derived bounds, vectors, many points."""
