"""The mathematics of PythonRobotics pull request 62: a derivative that lacks the speed."""

import numpy as np


def before(x, u, dt):
    yaw, v = x[2], u[0]
    xn = np.array([x[0] + dt * v * np.cos(yaw), x[1] + dt * v * np.sin(yaw), x[2] + dt * u[1]])
    J = np.array([[1.0, 0.0, -dt * np.sin(yaw)], [0.0, 1.0, dt * v * np.cos(yaw)], [0.0, 0.0, 1.0]])
    return J


def after(x, u, dt):
    yaw, v = x[2], u[0]
    xn = np.array([x[0] + dt * v * np.cos(yaw), x[1] + dt * v * np.sin(yaw), x[2] + dt * u[1]])
    J = np.array([[1.0, 0.0, -dt * v * np.sin(yaw)], [0.0, 1.0, dt * v * np.cos(yaw)], [0.0, 0.0, 1.0]])
    return J
