"""The mathematics of zscilib pull request 72 and ahrs issue 95: a wrong term in the Jacobian of the gradient step."""

import numpy as np


def before(q, a):
    f = np.array(
        [
            2 * (q[1] * q[3] - q[0] * q[2]) - a[0],
            2 * (q[0] * q[1] + q[2] * q[3]) - a[1],
            2 * (0.5 - q[1] ** 2 - q[2] ** 2) - a[2],
        ]
    )
    J = np.array(
        [
            [-2 * q[2], 2 * q[3], 2 * q[0], 2 * q[1]],
            [2 * q[1], 2 * q[0], 2 * q[3], 2 * q[2]],
            [0.0, -4 * q[1], -4 * q[2], 0.0],
        ]
    )
    return J


def after(q, a):
    f = np.array(
        [
            2 * (q[1] * q[3] - q[0] * q[2]) - a[0],
            2 * (q[0] * q[1] + q[2] * q[3]) - a[1],
            2 * (0.5 - q[1] ** 2 - q[2] ** 2) - a[2],
        ]
    )
    J = np.array(
        [
            [-2 * q[2], 2 * q[3], -2 * q[0], 2 * q[1]],
            [2 * q[1], 2 * q[0], 2 * q[3], 2 * q[2]],
            [0.0, -4 * q[1], -4 * q[2], 0.0],
        ]
    )
    return J
