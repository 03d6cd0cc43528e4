"""Is it equal, is it positive, where does it fail: statements in, verdicts out."""
