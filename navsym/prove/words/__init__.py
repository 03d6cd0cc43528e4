"""Matrices of any size: sums of words, their completion, and exact matrices where a claim fails."""
