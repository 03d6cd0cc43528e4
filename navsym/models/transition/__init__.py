"""Transition matrices in closed form."""
