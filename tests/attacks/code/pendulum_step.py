"""One step of Heun's method for an inverted pendulum with friction, and its linear part."""

import numpy as np


def pendulum_step(x, u, dt):
    angle, rate = x[0], x[1]
    push = np.sin(angle) - 0.5 * rate + u
    ahead = angle + dt * rate
    faster = rate + dt * push
    again = np.sin(ahead) - 0.5 * faster + u
    slope = dt * (1.0 - 0.25 * dt) * np.cos(angle)
    return np.array([angle + 0.5 * dt * (rate + faster), rate + 0.5 * dt * (push + again), slope])
