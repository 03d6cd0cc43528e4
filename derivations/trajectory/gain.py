"""The printed constant gain: its stability, its noise, its lag, against the printed errors."""

import math
from collections.abc import Sequence
from fractions import Fraction

import flint
import sympy as sp

from navsym.claims import CERTIFIED, UNDECIDED, Finding, Property, claims, fact, state
from navsym.core.balls import enclose
from navsym.language.expression import to_text
from navsym_papers.trajectory.experiment import stability as methods
from navsym_papers.trajectory.experiment.stability import normalised_scale, stationary_covariance, write_half_plane
from navsym_papers.trajectory.experiment_printed import TAU
from navsym_papers.trajectory.hurwitz import say_signs
from navsym_papers.trajectory.model import pascal_rows
from navsym_papers.trajectory.scaling import write_rows

PERIOD = Fraction(360)

GAIN = tuple(map(Fraction, ("0.0919", "0.00655", "0.000226", "0.00000404", "0.000000032")))
#: Half a unit of the last printed digit of each gain.
ROUNDING = tuple(map(Fraction, ("5e-5", "5e-6", "5e-7", "5e-9", "5e-10")))


def stability(scale: list[flint.arb], fifth: tuple[Fraction, Fraction] = (GAIN[4], ROUNDING[4])) -> Finding:
    found = methods.gain_stability((*GAIN[:4], fifth[0]), (*ROUNDING[:4], fifth[1]), scale)
    method = "Routh's column in balls over the rounding box of the gain"
    scope = "n = 5, tau = 0.2 s, every gain that rounds to these digits"
    return Finding(
        found.stable if found.stable is not None else UNDECIDED, method, CERTIFIED, scope=scope, evidence=found.reason
    )


def say_stable(scale: list[str], fifth: tuple[Fraction, Fraction] = (GAIN[4], ROUNDING[4])) -> tuple[dict, ...]:
    """That the roots of det(z E - Phi + k h) lie inside the unit circle for every gain of the box.

    scale : divisors of the gains k1, k2, ..., as texts

    With z = (1 + w)/(1 - w) it is a polynomial in w over (1 - w)^5, whose roots have to lie left of the imaginary axis.
    """
    gains = [*zip(GAIN[:4], ROUNDING, strict=False), fifth]
    return say_stable_within(scale, {f"k{i}": [str(k - w), str(k + w), []] for i, (k, w) in enumerate(gains, start=1)})


def say_stable_within(scale: list[str], box: dict[str, list]) -> tuple[dict, ...]:
    """:func:`say_stable` for other ranges of the gains."""
    n, coefficients = len(scale), write_half_plane(scale)
    Phi = write_rows(pascal_rows(n))
    gain = write_rows([[f"k{i}/({text})"] for i, text in enumerate(scale, start=1)])
    left = f"det((1 + w)*eye({n}) - (1 - w)*({Phi} - {gain} @ {write_rows([[1] * n])}))"
    right = " + ".join(f"({c})*w**{n - k}" if k < n else f"({c})" for k, c in enumerate(coefficients))
    return state(left, "=", right, box | {"w": [None, None, []]}), *say_signs(coefficients, box)


METRIC = [str(math.factorial(j) / TAU**j) for j in range(5)]
NORMALISED = [f"sqrt({sum(i ** (2 * j) for i in range(1, 6))})" for j in range(5)]
#: The printed K_5 with one exponent less.
SMALLER = GAIN[4] / 10, ROUNDING[4] / 10


def in_f(metric: tuple[Fraction, ...]) -> list[Fraction]:
    """A gain in D_p variables, as the printed one is read, in the variables f."""
    return [k * TAU**j / math.factorial(j) for j, k in enumerate(metric)]


def stationary_deviation(state: int, digits: int) -> Finding:
    """Standard deviation of state 1 (m), 2 (m/s) or 3 (m/s^2) under white noise of 1 m, as text."""
    factor = Fraction(math.factorial(state - 1)) / TAU ** (state - 1)
    variance = stationary_covariance(in_f(GAIN))[state - 1][state - 1] * factor**2
    scope = "stationary error under white noise of 1 m, printed gain in D_p variables, straight course"
    return Finding(
        methods.root_decimal(variance, digits), "exact solution of P = C P C^T + K K^T", CERTIFIED, scope=scope
    )


def say_stationary(low: str, high: str) -> tuple[dict, ...]:
    """That P is stationary, P = C P C' + K K', and the root of its first entry lies between two numbers."""
    P = stationary_covariance(in_f(GAIN))
    deviation = f"sqrt({P[0][0]})"
    return say_still(P, in_f(GAIN)), state(low, "<=", deviation), state(deviation, "<=", high)


def say_still(P: list[list[Fraction]], drive: list[Fraction]) -> dict:
    """That P = C P C' + d d' with C of the printed gain."""
    gain, Phi = in_f(GAIN), pascal_rows(len(GAIN))
    C = write_rows([[entry - k for entry in row] for row, k in zip(Phi, gain, strict=True)])
    d = write_rows([[k] for k in drive])
    return state(write_rows(P), "=", f"{C} @ {write_rows(P)} @ {C}.T + {d} @ {d}.T")


def decimals(value: flint.arb, digits: int) -> str:
    """A ball rounded to so many decimals, when that is decided."""
    whole = (value * 10**digits + flint.arb(1) / 2).floor().unique_fmpz()
    assert whole is not None, "the rounding is not decided"
    return f"{int(whole) / 10**digits:.{digits}f}"


def say_between(ends: Sequence[sp.Expr], printed: str) -> list[dict]:
    """That what lies between two numbers rounds to the printed digits; where they round to others, that it is near."""
    half = Fraction(1, 2 * 10 ** len(printed.partition(".")[2]))
    low, high = str(Fraction(printed) - half), str(Fraction(printed) + half)
    below, above = map(to_text, ends if round_between(ends, len(printed) - 2) == printed else ends[::-1])
    return [state(low, "<=", below), state(above, "<=", high)]


def round_between(ends: Sequence[sp.Expr], digits: int) -> str:
    """So many decimals of what lies between two numbers, when they are decided."""
    (found,) = {decimals(enclose(end, bits=400), digits) for end in ends}
    return found


def say_yawing(printed: str, state: int) -> Property:
    """RMS of the steady error of speed (2) or acceleration (3) at |V| = 100 m/s that yawing alone causes.

    V_2 = 100 cos(45 deg + d sin(wt)), d = 5 deg, contains sin(wt) with amplitude 100 sqrt(2) J_1(d); over
    whole periods its harmonics are orthogonal, so that the first one bounds the whole from below.
    """
    lag = methods.harmonic_lag(in_f(GAIN), TAU, PERIOD, state) * (2 * sp.pi / sp.Rational(PERIOD)) ** (state - 2)
    ends = [100 * amplitude * lag for amplitude in methods.bound_bessel(1)]
    method, scope = "response to the first harmonic, ball arithmetic", "steady yawing at 100 m/s, printed gain in D_p "
    scope += "variables, no noise"
    found = round_between(ends, len(printed) - 2)
    return fact(printed, found, method, CERTIFIED, scope=scope, meaning=say_between(ends, printed))


CLAIMS = claims(
    "experiment.gain | With the printed constant gain in the variables x^q the algorithm goes on working (is "
    "stable). | undecidable: in the normalised variables, in which y is said to live, a root of modulus 1.0006 "
    "makes the estimate grow without bound; the same digits are stable in D_p variables (metres, m/s, ...), where "
    "the printed errors do not come out, and K_5 = 3.2e-9 would be stable here: variables or an exponent, the copy "
    "cannot tell",
    lambda: Property(True, stability(normalised_scale(5)), say_stable(NORMALISED)),
    "experiment.gain* | With the printed constant gain in the variables D_p x (metres, m/s, ...) the algorithm is "
    "stable. | CERTIFIED",
    lambda: Property(True, stability(methods.metric_scale(5, TAU)), say_stable(METRIC)),
    "experiment.gain.exponent | With K_5 = 3.2e-9 for 3.2e-8 in the printed constant gain the algorithm is stable "
    "in the variables x^q. | CERTIFIED",
    lambda: Property(True, stability(normalised_scale(5), SMALLER), say_stable(NORMALISED, SMALLER)),
    "experiment.sigma_phi.gain | Position error of 0.06 m with the printed constant gain (stationary part). | "
    "undecidable: the printed gain passes 0.23 m of the 1 m noise; 0.06 m would need a first gain below 0.06; by "
    "hand: 0.0919 of every new error of 1 m enters, which is 0.09 m already",
    lambda: Property("0.06", stationary_deviation(1, 2), say_stationary("0.055", "0.065")),
    "experiment.sigma_phi.gain* | Stationary position error with the printed constant gain. | CERTIFIED",
    lambda: Property("0.23", stationary_deviation(1, 2), say_stationary("0.225", "0.235")),
    "experiment.sigma_v.yaw.100 | |V| = 100 m/s: error of V_2 while yawing with the printed constant gain. | "
    "undecidable: the printed gain lags 18 % behind a motion of period 360 s: 0.8 m/s of the 4.4 m/s of V_2, both "
    "root mean squares (the amplitude of V_2 is 6.2 m/s)",
    lambda: say_yawing("0.090", 2),
    "experiment.sigma_v.yaw.100* | |V| = 100 m/s: lag of V_2 behind the first harmonic of the yawing, printed "
    "gain. | CERTIFIED",
    lambda: say_yawing("0.806", 2),
    "experiment.sigma_a.yaw.100 | |V| = 100 m/s: error of the acceleration while yawing with the printed constant "
    "gain. | undecidable: the printed gain misses 77 % of the acceleration at a period of 360 s; by hand: 0.77 of "
    "6.2 m/s times 2 pi/360 s over sqrt(2) is 0.06 m/s^2",
    lambda: say_yawing("0.01", 3),
    "experiment.sigma_a.yaw.100* | |V| = 100 m/s: lag of the acceleration behind the first harmonic of the yawing, "
    "printed gain. | CERTIFIED",
    lambda: say_yawing("0.06", 3),
)
