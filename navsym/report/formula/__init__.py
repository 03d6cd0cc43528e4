"""Formulas for reading: from text to MathML and LaTeX."""
