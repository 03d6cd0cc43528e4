"""The numerical experiment of the paper, run again: the two-stage observer on simulated and on recorded flights."""
