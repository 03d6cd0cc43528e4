"""A step of constant turn and speed, with its Jacobian."""

import math

import numpy as np
from numpy import cos, sin


def wrap(a):
    return math.atan2(math.sin(a), math.cos(a))


def ctrv(x, u, dt):
    px, py, th, v = x
    a, w = u
    J = np.zeros((4, 4))
    J[0, :] = [1, 0, -v * sin(th) * dt, cos(th) * dt]
    J[1] = [0, 1, v * cos(th) * dt, sin(th) * dt]
    J[2, 2], J[3, 3] = 1, 1.0
    new = np.array([px + v * cos(th) * dt, py + v * sin(th) * dt, wrap(th + w * dt), v + a * dt])
    return np.vstack((J, new))
