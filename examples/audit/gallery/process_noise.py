"""The mathematics of filterpy commit 1b298ff: a power of the step in the noise of the acceleration."""


def before(dt, variance):
    place = dt**3 / 4 * variance
    both = dt**3 / 2 * variance
    speed = dt**2 * variance
    return place, both, speed


def after(dt, variance):
    place = dt**4 / 4 * variance
    both = dt**3 / 2 * variance
    speed = dt**2 * variance
    return place, both, speed
