"""The mechanisation written a second time, in mpmath, and linearised by differences: an independent reference.

Nothing here comes from navsym: equations of motion and definitions of errors are typed from the definitions, the
rate of the error is a central difference in the size of the error and in time, at 60 digits.
"""

from __future__ import annotations

import random
from typing import Any

import mpmath as mp

mp.mp.dps = 60
STEP = mp.mpf(10) ** -20
AXES = {
    None: mp.eye(3),
    "NED": mp.eye(3),
    "ENU": mp.matrix([[0, 1, 0], [1, 0, 0], [0, 0, -1]]),
    "NWU": mp.diag([1, -1, -1]),
}
ROLES = ("position", "velocity", "attitude", "gyro_bias", "accelerometer_bias")


def skew(u: Any) -> Any:
    return mp.matrix([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])


def vec(*x: Any) -> Any:
    return mp.matrix([mp.mpf(v) for v in x])


def exp(p: Any) -> Any:
    """Rotation by a vector (Rodrigues)."""
    n = mp.norm(p)
    if n == 0:
        return mp.eye(3)
    K = skew(p / n)
    return mp.eye(3) + mp.sin(n) * K + (1 - mp.cos(n)) * K * K


def log(R: Any) -> Any:
    """The vector of a small rotation."""
    half = vec(R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]) / 2
    n = mp.norm(half)
    return half if n == 0 else half * (mp.asin(n) / n)


class Flight:
    """A random state with its sensors, on an ellipsoid of the size of a few metres so that no term is small."""

    def __init__(self, card: Any, seed: int):
        pick = random.Random(seed)

        def some(n: int = 3, low: float = -2, high: float = 2) -> Any:
            return vec(*(round(pick.uniform(low, high), 6) for _ in range(n)))

        self.card, self.f, self.w = card, some(), some()
        self.C = exp(some())
        self.v, self.r = some(), some(low=1, high=3)
        self.L, self.h = mp.mpf(round(pick.uniform(-1.1, 1.1), 6)), mp.mpf(round(pick.uniform(0.3, 1), 6))
        self.rate, self.a = mp.mpf("0.7"), mp.mpf(5)
        self.e2 = mp.mpf(0) if card.earth == "sphere" else mp.mpf("0.3")
        self.g = some(low=1, high=3)
        self.mu = mp.mpf(9)
        self.L0 = self.L
        self.alpha = mp.mpf("0.8") if card.azimuth == "wander" else mp.mpf(0)

    def axes(self, x: dict[str, Any]) -> Any:
        """Rotation from north, east, down to the axes."""
        s, c = mp.sin(x["azimuth"][0]), mp.cos(x["azimuth"][0])
        return AXES[self.card.axes] * mp.matrix([[c, s, 0], [-s, c, 0], [0, 0, 1]])

    def radii(self, L: Any) -> tuple[Any, Any]:
        w = 1 - self.e2 * mp.sin(L) ** 2
        return self.a * (1 - self.e2) / w ** mp.mpf("1.5"), self.a / mp.sqrt(w)

    def turning(self, L: Any, x: dict[str, Any]) -> Any:
        """The Earth's rate in the frame."""
        if self.card.earth_rate != "kept":
            return vec(0, 0, 0)
        if self.card.frame == "earth":
            return vec(0, 0, self.rate)
        return self.axes(x) * vec(self.rate * mp.cos(L), 0, -self.rate * mp.sin(L))

    def derivative(self, x: dict[str, Any]) -> dict[str, Any]:
        card, A = self.card, self.axes(x)
        w, f = self.w - x["gyro_bias"], self.f - x["accelerometer_bias"]
        curved = card.frame == "local-level" and card.earth != "none"
        transport, position, azimuth = vec(0, 0, 0), x["velocity"], vec(0)
        turning = self.turning(x["position"][0] if curved else self.L, x)
        if curved:
            L, _, h = x["position"]
            N, Ea, D = A.T * x["velocity"]
            RN, RE = self.radii(L)
            azimuth = vec(Ea * mp.tan(L) / (RE + h) if card.azimuth == "wander" else 0)
            if card.transport_rate == "kept":
                transport = A * vec(Ea / (RE + h), -N / (RN + h), azimuth[0] - Ea * mp.tan(L) / (RE + h))
            position = vec(N / (RN + h), Ea / ((RE + h) * mp.cos(L)), -D)
        gravity = self.gravity(x)
        acceleration = x["C"] * f + gravity - skew(2 * turning + transport) * x["velocity"]
        return {
            "C": x["C"] * skew(w) - skew(turning + transport) * x["C"],
            "velocity": acceleration,
            "position": position,
            "azimuth": azimuth,
        }

    def gravity(self, x: dict[str, Any]) -> Any:
        card = self.card
        if card.frame == "local-level":
            down = self.g[0]
            if card.gravity_gradient == "vertical":
                RN, RE = self.radii(self.L0)
                radius = {"R": RN, "RN": RN, "RE": RE, "sqrt(RN*RE)": mp.sqrt(RN * RE)}[
                    card.gravity_radius.split(" ")[0]
                ]
                radius += self.h if "+ h" in card.gravity_radius else 0
                down *= 1 - 2 * (x["position"][2] - self.h) / radius
            return AXES[card.axes] * vec(0, 0, down)
        r = x["position"]
        value = self.g if card.gravity_gradient == "none" else -self.mu * r / mp.norm(r) ** 3
        if card.centrifugal == "kept":
            spin = skew(self.turning(self.L, x))
            value = value - spin * spin * (r if card.gravity_gradient == "central" else r - self.r)
        return value

    def truth(self) -> dict[str, Any]:
        curved = self.card.frame == "local-level" and self.card.earth != "none"
        position = vec(self.L, 0.4, self.h) if curved else self.r
        return {
            "C": self.C,
            "velocity": self.v,
            "position": position,
            "gyro_bias": vec(0, 0, 0),
            "accelerometer_bias": vec(0, 0, 0),
            "azimuth": vec(self.alpha),
            "least turn": vec(mp.sin(self.L) if curved and self.card.azimuth == "wander" else 0),
        }

    # Errors by the definitions of a card

    def signs(self) -> tuple[Any, ...]:
        card = self.card
        plus = "estimate - truth"
        return (
            (1 if card.error == plus else -1),
            mp.mpf(1 if card.rotation_sign == "+" else -1) / (2 if card.attitude_size == "half angle" else 1),
            (1 if card.bias_sign == plus else -1),
        )

    def moved(self, x: dict[str, Any], y: dict[str, Any]) -> Any:
        """From the true to the estimated local level for psi; its turn about the vertical for wandering axes."""
        if self.card.earth == "none" or self.card.frame != "local-level":
            return mp.eye(3)

        def level(state: dict[str, Any]) -> Any:
            """Rotation from the Earth to the axes."""
            p = state["position"]
            s, c, sl, cl = mp.sin(p[0]), mp.cos(p[0]), mp.sin(p[1]), mp.cos(p[1])
            return self.axes(state) * mp.matrix([[-s * cl, -s * sl, c], [-sl, cl, 0], [-c * cl, -c * sl, -s]])

        whole = level(y) * level(x).T
        if self.card.angle == "psi":
            return whole
        return exp(mp.diag([0, 0, 1]) * log(whole)) if self.card.azimuth == "wander" else mp.eye(3)

    def error(self, x: dict[str, Any], y: dict[str, Any]) -> dict[str, Any]:
        """The error of the estimate y of the truth x."""
        card = self.card
        e, s, b = self.signs()
        frame = self.moved(x, y)
        C, v = frame * x["C"], frame * x["velocity"]
        small = y["C"] * C.T if card.attitude_error == "frame" else C.T * y["C"]

        def vector(estimate: Any, true: Any) -> Any:
            if card.vector_error == "rotated":
                return e * (estimate - y["C"] * C.T * true)
            if card.vector_error == "velocity in body" and true is v:
                return e * (y["C"].T * estimate - C.T * true)
            return e * (C.T * (estimate - true)) if card.vector_error == "body" else e * (estimate - true)

        if card.frame == "local-level" and card.earth != "none":
            position = e * (y["position"] - x["position"])
            if card.position_error == "metres":
                L, _, h = x["position"]
                RN, RE = self.radii(L)
                position = self.axes(x) * mp.diag([RN + h, (RE + h) * mp.cos(L), -1]) * position
        else:
            position = vector(y["position"], x["position"])
        biases = {k: b * (y[k] - x[k]) for k in ("gyro_bias", "accelerometer_bias")}
        return {"attitude": s * log(small), "velocity": vector(y["velocity"], v), "position": position, **biases}

    def sensitivity(self, x: dict[str, Any]) -> Any:
        """Change of the error with the fifteen coordinates of the estimate, at the truth."""
        J = mp.matrix(15, 15)
        for j in range(15):
            J[:, j] = (stack(self.error(x, push(x, j, STEP))) - stack(self.error(x, push(x, j, -STEP)))) / (2 * STEP)
        return J


def stack(error: dict[str, Any]) -> Any:
    return mp.matrix([error[name][k] for name in ROLES for k in range(3)])


def push(x: dict[str, Any], j: int, size: Any) -> dict[str, Any]:
    """The state with one of its fifteen coordinates moved."""
    y = {k: v.copy() for k, v in x.items()}
    name, k = ROLES[j // 3], j % 3
    if name == "attitude":
        axis = vec(0, 0, 0)
        axis[k] = size
        y["C"] = exp(axis) * y["C"]
    else:
        y[name][k] += size
        if j == 1:  # by which the axes of the estimate do not turn about the vertical
            y["azimuth"][0] += size * x["least turn"][0]
    return y


def flow(flight: Flight, x: dict[str, Any], time: Any) -> dict[str, Any]:
    rate = flight.derivative(x)
    y = {k: v.copy() for k, v in x.items()}
    y["velocity"] += time * rate["velocity"]
    y["position"] += time * rate["position"]
    y["azimuth"] += time * rate["azimuth"]
    # an orthogonal step: C' = C [u x] with u from C' itself
    u = x["C"].T * rate["C"]
    y["C"] = x["C"] * exp(time * vec(u[2, 1], u[0, 2], u[1, 0]))
    return y


def error_dynamics(flight: Flight) -> Any:
    """F (15, 15) in the order position, velocity, attitude, biases of gyros, of accelerometers."""
    x = flight.truth()
    F = mp.matrix(15, 15)

    def rate_of_error(y: dict[str, Any]) -> Any:
        after, before = (stack(flight.error(flow(flight, x, t), flow(flight, y, t))) for t in (STEP, -STEP))
        return (after - before) / (2 * STEP)

    inverse, size = flight.sensitivity(x) ** -1, mp.mpf(10) ** -12
    for j in range(15):
        columns = []
        for sign in (1, -1):  # what is of second order in the error is even and cancels
            y = x
            for k in range(15):
                y = push(y, k, sign * size * inverse[k, j])
            columns.append(rate_of_error(y))
        F[:, j] = (columns[0] - columns[1]) / (2 * size)
    return F
