"""Velocity and acceleration from measured positions, and how well posed that is."""
