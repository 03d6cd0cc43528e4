"""The residual of a magnetometer."""

import numpy as np


def mag(q, m):
    q = q / np.linalg.norm(q)
    w, x, y, z = q
    R = np.array(
        [
            [1 - 2 * (y**2 + z**2), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x**2 + z**2), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x**2 + y**2)],
        ]
    )
    h = R @ m
    b = np.array([np.hypot(h[0], h[1]), 0.0, h[2]])
    e = [0.0] * 3
    for i in range(3):
        e[i] = h[i] - b[i]
    e = [0.5 * e[0]] + e[1:]  # noqa: RUF005
    return np.array(e)
