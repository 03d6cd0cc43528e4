"""One file for each language, and what the languages share."""
