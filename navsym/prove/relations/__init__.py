"""Hypotheses: cofactors of what is equal because of them, and exact points where they hold."""
