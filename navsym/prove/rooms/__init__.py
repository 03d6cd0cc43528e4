"""Rooms of the search: each proposes proofs of a goal by one rule of the checker."""
