"""Text from outside: tokens, expressions, files and their schemas, and the printer that writes them back."""
