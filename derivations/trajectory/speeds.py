"""What three runs that differ in speed alone have in common: |V| = 2, 100 and 300 m/s, "other conditions kept".

On a straight course the motion is a polynomial that the model has exactly: the speed drops out of every error,
innovation and change of the criterion, so that the tuning does not see it. Off it the error is noise plus a lag
in proportion to the speed, and a mean square cannot fall while the speed grows.
"""

from fractions import Fraction
from itertools import pairwise

import sympy as sp

from navsym.claims import PROVED, Equation, Finding, Property, claim, claims, state
from navsym_papers.trajectory.model import dynamics, first_state, nilpotent_exponential

N = 3
STEPS = 3
rho, tau, V = sp.symbols("rho tau V", positive=True)
PHI = nilpotent_exponential(dynamics(N, rho), tau)
H = first_state(N)


def gains() -> list[sp.Matrix]:
    """A free gain for every step, as the tuning may choose it."""
    return [sp.Matrix(sp.symbols(f"K{k}_1:{N + 1}", real=True)) for k in range(STEPS)]


def noises() -> list[sp.Symbol]:
    return list(sp.symbols(f"e0:{STEPS}", real=True))


def run(truth: list[sp.Matrix], start_error: sp.Matrix) -> tuple[list[sp.Expr], list[sp.Matrix]]:
    """Innovations and estimates of ``STEPS`` steps of the algorithm with free gains and noise, the first one before."""
    innovations, estimates = [], [truth[0] + start_error]
    for true, gain, noise in zip(truth[1:], gains(), noises(), strict=True):
        predicted = PHI * estimates[-1]
        innovations.append(sp.expand((H * (true - predicted))[0] + noise))
        estimates.append((predicted + gain * innovations[-1]).applyfunc(sp.expand))
    return innovations, estimates


def straight(speed: sp.Expr) -> list[sp.Matrix]:
    """States of a straight course: position, constant speed, no acceleration."""
    place = sp.Symbol("x1", real=True)
    return [sp.Matrix([place + rho * speed * tau * k, speed, *([0] * (N - 2))]) for k in range(STEPS + 1)]


@claim("experiment.straight.free")
def the_tuning_does_not_see_the_speed():
    """On a straight course innovations, errors and all three terms of J are free of |V|, whatever the gains; n = 3.

    Given the same noise and the same first errors the tuned gains of the three runs are then the same as well.
    """
    error = sp.Matrix(sp.symbols(f"d1:{N + 1}", real=True))
    printed, derived = [], []
    for speed, side in ((V, derived), (sp.Integer(0), printed)):
        truth = straight(speed)
        innovations, estimates = run(truth, error)
        side += innovations
        for (before, after), true in zip(pairwise(estimates), truth[1:], strict=True):
            side += [*(after - true), *(after - before)[1:]]
    return Equation([sp.expand(x) for x in printed], [sp.expand(x) for x in derived])


@claim("experiment.straight.squares")
def mean_square_is_noise_plus_lag():
    """The mean-square speed error is the noise part plus V^2 times the square of the lag: no product of the two; n = 3.

    V p_k is what the motion departs from the polynomial of the model by step k, any numbers p_k.
    """
    departures = [sp.Matrix(sp.symbols(f"p{k}_1:{N + 1}", real=True)) for k in range(STEPS + 1)]
    truth = [base + V * bend for base, bend in zip(straight(V), departures, strict=True)]
    _, estimates = run(truth, -V * departures[0])
    error = sp.expand((estimates[-1] - truth[-1])[1])
    sigma = sp.Symbol("sigma", positive=True)
    coefficients = [error.coeff(noise) for noise in noises()]
    lag = sp.expand(error.subs(dict.fromkeys(noises(), 0)) / V)
    independent = {a * b: (sigma**2 if a == b else 0) for a in noises() for b in noises()}
    mean_square = sp.expand(error**2).subs(independent).subs(dict.fromkeys(noises(), 0))
    return Equation(sigma**2 * sum(c**2 for c in coefficients) + V**2 * lag**2, mean_square)


#: Printed RMS errors of V_2 with half a unit of the last digit, by speed.
STRAIGHT = {2: ("0.06", "0.005"), 100: ("0.019", "0.0005"), 300: ("0.08", "0.005")}
YAWING = {2: ("0.07", "0.005"), 100: ("0.090", "0.0005"), 300: ("0.09", "0.005")}


def one_gain(figures: dict[int, tuple[str, str]]) -> Finding:
    """Whether N + V^2 S, N and S not negative, meets all rounding ranges.

    For speeds a < b the slope S lies between (low_b - high_a) and (high_b - low_a) over b^2 - a^2; with N >= 0
    it is at most high_a / a^2. For such an S the ranges of N meet in pairs, and intervals that do have a common point.
    """
    low = {v: (Fraction(x) - Fraction(half)) ** 2 for v, (x, half) in figures.items()}
    high = {v: (Fraction(x) + Fraction(half)) ** 2 for v, (x, half) in figures.items()}
    pairs = [(a, b) for a in figures for b in figures if a < b]
    least = max([Fraction(0), *((low[b] - high[a]) / (b * b - a * a) for a, b in pairs)])
    most = min([*(high[a] / (a * a) for a in figures), *((high[b] - low[a]) / (b * b - a * a) for a, b in pairs)])
    scope = "mean square N + V^2 S at 2, 100 and 300 m/s, every value that rounds to the printed digits"
    evidence = f"the slope S would have to be at least {float(least):.3g} and at most {float(most):.3g}"
    return Finding(least <= most, "two linear inequalities in exact fractions", PROVED, scope=scope, evidence=evidence)


CLAIMS = claims(
    # The error falls from 0.06 at 2 m/s to 0.019 at 100 m/s and rises to 0.08 at 300 m/s: with one gain it cannot fall.
    "experiment.one_gain.straight | No one gain has mean squares N + V^2 S that are the printed ones on straight "
    "courses at 2, 100 and 300 m/s.",
    lambda: Property(
        printed=False,
        derived=one_gain(STRAIGHT),
        meaning=(
            state("m + (10000 - 4)*S", ">", "0.0195**2", {"m": ["0.055**2", "0.065**2", []], "S": ["0", None, []]}),
        ),
    ),
    # From 0.07 at 2 m/s and 0.090 at 100 m/s one gain makes at least 0.16 m/s at 300 m/s.
    "experiment.one_gain.yawing | No one gain has mean squares N + V^2 S that are the printed ones while yawing at "
    "2, 100 and 300 m/s.",
    lambda: Property(
        printed=False,
        derived=one_gain(YAWING),
        meaning=(
            state(
                "m + (90000 - 4)*(a - m)/(10000 - 4)",
                ">",
                "0.095**2",
                {"m": ["0.065**2", "0.075**2", []], "a": ["0.0895**2", "0.0905**2", []]},
            ),
        ),
    ),
)
