"""Dynamics and measurements: linear models, transition matrices, inertial error equations, the Earth."""
