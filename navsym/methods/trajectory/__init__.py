"""Velocity and acceleration from positions."""
