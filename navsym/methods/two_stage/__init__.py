"""Estimators of two stages: gains, error dynamics, simulation, a recorded flight."""
