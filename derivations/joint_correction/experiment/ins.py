"""The algorithm (3.2), (3.3) in all its situations, run against the full error model.

Truth: the 16-state model (2.1)-(2.5) with every term, along a flight. Algorithm: the ten variables
x_1 ... x_6, y_1, y_2, y_5, y_6 with gains by poles, switched by what information there is. Truth and
algorithm are one linear system, so its covariance propagates exactly; Monte Carlo runs the same
steps with drawn numbers. The Kalman filter of the full model is the bound that nothing beats.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache

import numpy as np
import sympy as sp

from navsym.core.arrays import Array, freeze
from navsym_papers.joint_correction import inertial
from navsym_papers.joint_correction.experiment.flight import EARTH_RADIUS, SCHULER_RATE, Flight


class Situation(StrEnum):
    """What information there is."""

    VELOCITY = "velocity"
    POSITION = "position"
    BOTH = "both"
    NEITHER = "neither"


@dataclass(frozen=True, slots=True)
class Errors:
    """Standard deviations of the errors, in the units that engineers use, and intensities of the noise.

    tilt, heading and position angles in radians, gyro drift in rad/s, accelerometer in m/s^2,
    velocities in m/s, positions in metres; noise_velocity and noise_position are standard deviations of
    measurements averaged over one second.
    """

    tilt: float = 1.0e-4
    velocity: float = 0.5
    position: float = 5000.0
    heading: float = 1.0e-3
    drift: float = 0.01 * np.pi / 180 / 3600
    accelerometer: float = 1.0e-3
    velocity_bias: float = 0.3
    position_bias: float = 50.0
    noise_velocity: float = 0.5
    noise_position: float = 30.0

    def covariance(self) -> Array:
        """(16, 16) of the dimensionless full state; alpha and beta start from position and platform errors.

        beta = alpha - gamma: a position error gamma appears in beta with the opposite sign.
        """
        w0 = SCHULER_RATE
        gamma = self.position / EARTH_RADIUS
        sigma = {
            "alpha": self.tilt,
            "pi": self.velocity / EARTH_RADIUS / w0,
            "nu": self.drift / w0,
            "epsilon": self.accelerometer / EARTH_RADIUS / w0**2,
            "w_c": self.velocity_bias / EARTH_RADIUS / w0,
            "w_M": self.position_bias / EARTH_RADIUS,
        }
        P = np.zeros((16, 16))
        for k, state in enumerate(inertial.FULL):
            kind = str(state).rpartition("_")[0] if not str(state).startswith("w") else str(state)[:3]
            P[k, k] = sigma.get(kind, 0.0) ** 2
        for tilt, turn in ((0, 4), (1, 5)):
            P[turn, turn] = P[tilt, tilt] + gamma**2
            P[tilt, turn] = P[turn, tilt] = P[tilt, tilt]
        P[6, 6] = self.heading**2
        return P

    def noise(self) -> Array:
        """Intensities (4,) of r^c and r^M in dimensionless time."""
        velocity = self.noise_velocity / EARTH_RADIUS / SCHULER_RATE
        position = self.noise_position / EARTH_RADIUS
        return np.array([velocity, velocity, position, position]) ** 2 * SCHULER_RATE


# Matrices along the flight

RATES = (*inertial.OMEGA[:2], *inertial.EARTH)


@cache
def compiled() -> tuple[object, ...]:
    """Fast functions for F, H of truth and algorithm, and the meaning of their variables.

    Arguments: omega_1, omega_2, u_1, u_2, u_3.
    """
    from navsym.core.casadi_functions import casadi_function

    truth, algorithm = inertial.full_model(), inertial.joint_model()
    equations = inertial.dimensionless()
    x, y = inertial.velocity_variables(equations), inertial.position_variables(equations)
    meaning = sp.Matrix([[sp.diff(m, s) for s in inertial.FULL] for m in (*x, y[0], y[1], y[4], y[5])])
    matrices = {"F": truth.F, "H": truth.H, "A": algorithm.F, "C": algorithm.H, "M": meaning}
    return tuple(
        casadi_function(name, [list(RATES)], sp.Matrix(value).subs(inertial.MU, 1)) for name, value in matrices.items()
    )


@dataclass(frozen=True, slots=True, eq=False)
class Linearised:
    """Matrices at every instant of a flight.

    F (N, 16, 16), H (N, 4, 16), A (N, 10, 10), C (N, 4, 10), M (N, 10, 16).
    """

    F: Array
    H: Array
    A: Array
    C: Array
    M: Array


def along(flight: Flight) -> Linearised:
    """All matrices along a flight; mu is contained in its rates."""
    rates = np.hstack([flight.omega, flight.u])
    found = []
    for function in compiled():
        found.append(freeze(np.array([np.array(function(row)) for row in rates])))  # type: ignore[operator]
    return Linearised(*found)


def gains(situation: Situation, lambda_c: float, lambda_h: float) -> Array:
    """(10, 4): gains of x_1 ... x_6, y_1, y_2, y_5, y_6 on the four innovations, by situation.

    Velocity: (p + lambda_c)^3 per channel; both: and (p + lambda_h)^2 for y (plain, so that the link
    between the channels costs nothing, joint_correction:3.coupled.position_plain); position only:
    (p + lambda_h)^4 on y_1, y_2, x_1, x_2 (joint_correction:3.situations.position_only).
    """
    K = np.zeros((10, 4))
    velocity = (1 - 3 * lambda_c**2, 3 * lambda_c - lambda_c**3, lambda_c**3)  # joint_correction:3.2.gains
    h = lambda_h
    for channel in (0, 1):
        if situation in (Situation.VELOCITY, Situation.BOTH):
            K[3 * channel : 3 * channel + 3, channel] = velocity
        if situation is Situation.BOTH:
            K[6 + 2 * channel : 8 + 2 * channel, 2 + channel] = 2 * h, h**2
        if situation is Situation.POSITION:
            K[6 + 2 * channel : 8 + 2 * channel, 2 + channel] = 4 * h, 6 * h**2 - 1
            K[3 * channel : 3 * channel + 2, 2 + channel] = 4 * h - 4 * h**3, 6 * h**2 - h**4 - 1
    return K


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """What happens: a situation for each step, and the poles of the stages.

    situations : one per step;  lambda_c, lambda_h : decay rates in dimensionless time
    fresh      : when position information comes for the first time, y_1° and y_5° start at the measured
                 values (as joint_correction:1.6.initial does for x) and y_2°, y_6° at x_2°, x_5°
    """

    situations: tuple[Situation, ...]
    lambda_c: float = 2.0
    lambda_h: float = 3.0
    fresh: bool = True

    @property
    def first_position(self) -> int | None:
        """The step at which position information comes for the first time."""
        with_position = (Situation.POSITION, Situation.BOTH)
        return next((k for k, s in enumerate(self.situations) if s in with_position), None)


def plan(phases: Sequence[tuple[Situation, float]], step: float, lambda_c: float = 2.0, lambda_h: float = 3.0) -> Plan:
    """Phases (situation, minutes) one after the other."""
    situations = [s for s, minutes in phases for _ in range(round(minutes * 60.0 / step))]
    return Plan(tuple(situations), lambda_c, lambda_h)


# Covariance and Monte Carlo of the same steps


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """Joint steps of truth and algorithm: s -> Phi s + Gamma r for s = (16 truths, 10 estimates)."""

    Phi: Array
    Gamma: Array
    noise: Array
    M: Array


def steps_of(flight: Flight, chosen: Plan, errors: Errors, repaired: bool = False) -> Steps:
    """Matrices of every step; the noise is held over a step with the variance intensity/step."""
    matrices = along(flight)
    dtau = float(flight.tau[1] - flight.tau[0])
    count = len(chosen.situations)
    Phi, Gamma = np.empty((count, 26, 26)), np.zeros((count, 26, 4))
    table = {s: gains(s, chosen.lambda_c, chosen.lambda_h) for s in Situation}
    for k, situation in enumerate(chosen.situations):
        K = table[situation]
        if repaired and situation in (Situation.VELOCITY, Situation.BOTH):
            K = decoupled(K, matrices.C[k])
        F, A = matrices.F[k], matrices.A[k] - K @ matrices.C[k]
        whole = np.zeros((26, 26))
        whole[:16, :16], whole[16:, 16:], whole[16:, :16] = F, A, K @ matrices.H[k]
        Phi[k], integral = exponential_step(whole * dtau)
        Gamma[k] = integral[:, 16:] @ K * dtau
        if chosen.fresh and k == chosen.first_position:
            reset, measured = fresh_start(matrices.H[k])
            Gamma[k] += Phi[k] @ measured
            Phi[k] = Phi[k] @ reset
    return Steps(Phi, Gamma, errors.noise() / dtau, matrices.M)


def fresh_start(H: Array) -> tuple[Array, Array]:
    """(reset, measured): y_1°, y_5° become sigma^M, y_2°, y_6° become x_2°, x_5°; the rest stays."""
    reset, measured = np.eye(26), np.zeros((26, 4))
    for channel in (0, 1):
        y, speed, x = 22 + 2 * channel, 23 + 2 * channel, 17 + 3 * channel
        reset[[y, speed]] = 0.0
        reset[y, :16] = H[2 + channel]
        reset[speed, x] = 1.0
        measured[y, 2 + channel] = 1.0
    return reset, measured


def exponential_step(A: Array) -> tuple[Array, Array]:
    """exp(A) and its mean over the step, by six terms of the series: steps are a few thousandths long."""
    total, mean, term = np.eye(len(A)), np.eye(len(A)), np.eye(len(A))
    for k in range(1, 7):
        term = term @ A / k
        total = total + term
        mean = mean + term / (k + 1)
    return total, mean


def decoupled(K: Array, C: Array) -> Array:
    """Velocity gains that take the link kappa = mu u_3 out of the error equations exactly.

    In chain coordinates the two channels do not see each other (the two-stage split of section 1 with
    m = l = 3), so the gains there are those without the link; back in x they mix the channels
    (joint_correction:3.coupled.repaired).
    """
    kappa = C[0, 3]
    L = chain_matrix(kappa)
    free = chain_matrix(0.0)
    repaired = K.copy()
    repaired[:6, :2] = np.linalg.solve(L, free @ K[:6, :2])
    return repaired


def chain_matrix(kappa: float) -> Array:
    """Rows a_1, a_2, a_3, b_1, b_2, b_3 of the homogeneous velocity group."""
    return np.array(
        [
            [0, 1, 1, kappa, 0, 0],
            [-1, 0, 0, 0, kappa, 0],
            [0, -1, 0, -kappa, 0, 0],
            [-kappa, 0, 0, 0, 1, 1],
            [0, -kappa, 0, -1, 0, 0],
            [kappa, 0, 0, 0, -1, 0]
        ],
        dtype=float
    )  # fmt: skip


def standard_deviations(steps: Steps, errors: Errors) -> Array:
    """(N + 1, 10): standard deviations of the errors of x_1 ... x_6, y_1, y_2, y_5, y_6, propagated exactly."""
    P = np.zeros((26, 26))
    P[:16, :16] = errors.covariance()
    found = [spread(P, steps.M[0])]
    for k, (Phi, Gamma) in enumerate(zip(steps.Phi, steps.Gamma, strict=True)):
        P = Phi @ P @ Phi.T + (Gamma * steps.noise) @ Gamma.T
        P = (P + P.T) / 2
        found.append(spread(P, steps.M[k + 1]))
    return np.array(found)


def spread(P: Array, M: Array) -> Array:
    """Standard deviations of M xi - estimate."""
    E = np.hstack([M, -np.eye(10)])
    return np.sqrt(np.einsum("ij,jk,ik->i", E, P, E))


def monte_carlo(steps: Steps, errors: Errors, runs: int, seed: int = 0) -> Array:
    """(N + 1, 10): root mean square errors of drawn runs of the same steps."""
    source = np.random.default_rng(seed)
    values, vectors = np.linalg.eigh(errors.covariance())
    state = np.zeros((26, runs))
    state[:16] = vectors @ (np.sqrt(np.maximum(values, 0.0))[:, None] * source.standard_normal((16, runs)))
    found = [rms(state, steps.M[0])]
    scale = np.sqrt(steps.noise)[:, None]
    for k, (Phi, Gamma) in enumerate(zip(steps.Phi, steps.Gamma, strict=True)):
        state = Phi @ state + Gamma @ (scale * source.standard_normal((4, runs)))
        found.append(rms(state, steps.M[k + 1]))
    return np.array(found)


def rms(state: Array, M: Array) -> Array:
    """Root mean square over the runs of M xi - estimate."""
    error = M @ state[:16] - state[16:]
    return np.sqrt((error**2).mean(axis=1))


def kalman_deviations(flight: Flight, chosen: Plan, errors: Errors) -> Array:
    """(N + 1, 10): standard deviations of the same variables for the Kalman filter of the full model.

    It knows the prior covariance, the intensities and every term: no linear estimator is better.
    Joseph's form; the measurement of a step acts at its end with the variance intensity/step.
    """
    matrices = along(flight)
    dtau = float(flight.tau[1] - flight.tau[0])
    R = errors.noise() / dtau
    used = {Situation.VELOCITY: [0, 1], Situation.POSITION: [2, 3], Situation.BOTH: [0, 1, 2, 3], Situation.NEITHER: []}
    P = errors.covariance()
    found = [np.sqrt(np.einsum("ij,jk,ik->i", matrices.M[0], P, matrices.M[0]))]
    for k, situation in enumerate(chosen.situations):
        Phi, _ = exponential_step(matrices.F[k] * dtau)
        P = Phi @ P @ Phi.T
        for row in used[situation]:
            h = matrices.H[k + 1, row]
            gain = P @ h / (h @ P @ h + R[row])
            keep = np.eye(16) - np.outer(gain, h)
            P = keep @ P @ keep.T + np.outer(gain, gain) * R[row]
        P = (P + P.T) / 2
        found.append(np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", matrices.M[k + 1], P, matrices.M[k + 1]), 0.0)))
    return np.array(found)


#: How many estimators :func:`compare` compares.
ESTIMATORS = 5


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Position errors (metres, root of the sum over both axes) of four estimators at minutes after t_1."""

    minutes: tuple[float, ...]
    rows: dict[str, tuple[float, ...]] = field(default_factory=dict)


def compare(
    flight: Flight,
    errors: Errors,
    before: float = 90.0,
    during: float = 30.0,
    lambda_c: float = 2.0,
    lambda_h: float = 3.0,
    minutes: Sequence[float] = (1.0, 5.0, 10.0, 20.0, 30.0),
    step: Callable[[], None] = lambda: None,
) -> Comparison:
    """Velocity information for ``before`` minutes, then both for ``during`` minutes.

    Compared: the two-stage algorithm, the same with decoupled gains, both stages started together at t_1 (no
    pre-estimation), a single-stage observer of position alone, and the Kalman filter of the full model.
    ``step`` is called after each of the :data:`ESTIMATORS`.
    """
    seconds = float(flight.tau[1] - flight.tau[0]) / SCHULER_RATE
    V, B, P, N = Situation.VELOCITY, Situation.BOTH, Situation.POSITION, Situation.NEITHER
    cases = {
        "two stages": ((V, before), (B, during)),
        "two stages, not pre-estimated": ((N, before), (B, during)),
        "single stage, position only": ((N, before), (P, during)),
    }
    found = {name: plan(phases, seconds, lambda_c, lambda_h) for name, phases in cases.items()}
    curves = {}
    for name, p in found.items():
        curves[name] = standard_deviations(steps_of(flight, p, errors), errors)
        step()
    first = found["two stages"]
    curves["two stages, link removed"] = standard_deviations(steps_of(flight, first, errors, repaired=True), errors)
    step()
    curves["Kalman filter, full model"] = kalman_deviations(flight, first, errors)
    step()
    places = [round((before + m) * 60.0 / seconds) for m in minutes]
    rows = {name: tuple(float(position_error(curve)[k]) for k in places) for name, curve in curves.items()}
    return Comparison(tuple(minutes), rows)


def position_error(curve: Array) -> Array:
    """(N + 1,) metres: root of the sum of the variances of y_1 and y_5."""
    return EARTH_RADIUS * np.hypot(curve[:, 6], curve[:, 8])
