"""Text from outside: expressions, models, claims and data files, read without running anything."""
