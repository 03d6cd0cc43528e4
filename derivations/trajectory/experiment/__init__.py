"""The numerical experiment of the paper, run again: two courses, differentiated by every algorithm."""
