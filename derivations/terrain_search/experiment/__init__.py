"""The numerical experiment of the paper, run again: flights over a map, matched by every algorithm."""
