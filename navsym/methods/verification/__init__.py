"""Verdicts on the claims of papers, and when a kept one may be used again."""
