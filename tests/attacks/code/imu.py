"""A part of a transition matrix of inertial navigation."""

import numpy as np


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def imu(R, v, w, a, dt):
    theta = np.linalg.norm(w * dt)
    K = skew(w * dt) / theta
    dR = np.eye(3) + np.sin(theta) * K + (1 - np.cos(theta)) * (K @ K)
    F = np.block([[dR.T, np.zeros((3, 3))], [-R @ skew(a) * dt, np.eye(3)]])
    g = np.array([0.0, 0.0, -9.81])
    vn = v + (R.dot(a) + g) * dt
    s = np.sum(w**2) + np.sum(a) + np.trace(R) + max(vn[0], 0.0)
    return F[:, 0] * s + np.hstack((vn, -vn))
