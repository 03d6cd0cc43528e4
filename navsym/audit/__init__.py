"""The formulas inside source code, read and decided."""
