"""Attacks in batches: mutants of formulas, altered certificates, damaged files, killed writers."""
