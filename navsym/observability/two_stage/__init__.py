"""Estimators of two stages: gains, observers and the experiment of the paper."""
