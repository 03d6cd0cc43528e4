"""A Kalman filter of constant velocity."""

import numpy as np


def cv(x, P, z, dt):
    F = np.eye(4)
    F[0, 2] = F[1, 3] = dt
    H = np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0]])
    Q = np.diag([0.1, 0.1, 0.2, 0.2]) * dt
    x = F @ x
    P = F @ P @ F.T + Q
    S = H @ P @ H.T + 0.5 * np.eye(2)
    K = P @ H.T @ np.linalg.inv(S)
    y = z - H @ x
    x = x + K @ y
    P = (np.eye(4) - K @ H) @ P
    return np.concatenate([x, P[0], P[:, 1]])
