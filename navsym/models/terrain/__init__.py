"""Height maps, tracks over them, and what may enter."""
