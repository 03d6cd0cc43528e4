"""The mathematics of ahrs issue 48: a reference field that is turned the wrong way."""

import numpy as np


def before(R, m):
    h = R @ m
    b = np.array([np.sqrt(h[0] ** 2 + h[1] ** 2), 0.0, h[2]])
    return R @ b


def after(R, m):
    h = R @ m
    b = np.array([np.sqrt(h[0] ** 2 + h[1] ** 2), 0.0, h[2]])
    return R.T @ b


def wanted(R, m):
    h = R @ m
    r = np.sqrt(h[0] ** 2 + h[1] ** 2)
    return np.array([R[0, 0] * r + R[2, 0] * h[2], R[0, 1] * r + R[2, 1] * h[2], R[0, 2] * r + R[2, 2] * h[2]])
