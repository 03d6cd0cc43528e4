"""LaTeX and documents: formulas found in text, read twice by two grammars, and written in the language of files."""
