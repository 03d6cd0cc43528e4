"""The numerical experiment of the paper, run again: switching signals and a recorded road, filtered by every method."""
