"""What table 1 would mean: its figures read with the paper's own bias, grids and numbers of runs.

The paper does not say how large the velocity errors of its flights were, nor how long a flight was (1000 measurements
at 2 Hz are 500 s, the text has 1000 s). Its figures do not fit either length together with velocity errors over the
searched +-5 m/s; what they do fit is found here.
"""

import sympy as sp

from navsym.claims import Bound, Equation, claims
from navsym_papers.terrain_search.experiment_printed import FULL, FULL_SPEED, POSITION, SEQUENTIAL, SEQUENTIAL_SPEED

#: Step and half range of the velocity hypotheses in m/s, step of the positions in metres, length of 1000 measurements.
SPEED_STEP, SPEED_RANGE, PLACE_STEP, HALF_RUN = map(sp.Integer, (1, 5, 50, 500))
RUNS = sp.Integer(5 * 20)


def uniform_variance(half_width: sp.Expr) -> sp.Expr:
    """Variance of a number spread evenly over ``-half_width ... half_width``."""
    e = sp.Symbol("e", real=True)
    primitive = e**3 / 3 / (2 * half_width)
    return primitive.subs(e, half_width) - primitive.subs(e, -half_width)


def velocity_behind(error: sp.Expr, duration: sp.Expr) -> sp.Expr:
    """RMS velocity error of both axes whose bias delta V T/2 (claim ``bias.mean``) is ``error`` metres."""
    return 2 * error / duration


def bias_of_the_range() -> sp.Expr:
    """RMS bias at the end of 500 s of velocity errors spread evenly over the searched range of both axes."""
    return sp.sqrt(2 * uniform_variance(SPEED_RANGE)) * HALF_RUN / 2


def error_of_the_grids(duration: sp.Expr) -> sp.Expr:
    """RMS position error at the end that the two grids leave by themselves, both axes.

    On even terrain the best hypothesis is the nearest one in the position at the middle of the run and in the
    velocity, which differ from the truth by errors spread evenly over one cell each: the step of velocity moves the
    middle by whole steps of position when it does so in half of the run.
    """
    middle, speed = uniform_variance(PLACE_STEP / 2), uniform_variance(SPEED_STEP / 2)
    return sp.sqrt(2 * (middle + (duration / 2) ** 2 * speed))


def relative_deviation(runs: sp.Integer) -> sp.Expr:
    """Relative standard deviation of an RMS over runs of two normal errors: half that of the mean square.

    A square s^2 x^2 of a normal x has the mean s^2 and the variance s^4 (E x^4 - 1); the moments are the derivatives
    of exp(w^2/2) at zero.
    """
    w = sp.Symbol("w", real=True)
    fourth = sp.diff(sp.exp(w**2 / 2), w, 4).subs(w, 0)
    return sp.sqrt((fourth - 1) / (2 * runs)) / 2


CLAIMS = claims(
    "table.bias | By the bias delta V T/2 the 152.2 m are velocity errors of 609 mm/s in 500 s; the range would "
    "leave 1021 m. | CERTIFIED",
    lambda: Equation(
        [sp.Integer(609), sp.Integer(1021)],
        [1000 * velocity_behind(POSITION, HALF_RUN), bias_of_the_range()],
        tolerance=sp.Rational(1, 2),
    ),
    "table.bias.step | These 0.61 m/s are less than one step of velocity on each axis, spread evenly: +-1 m/s "
    "would be 0.82 m/s.",
    lambda: Bound(velocity_behind(POSITION, HALF_RUN), "<", sp.sqrt(2 * uniform_variance(SPEED_STEP))),
    "table.bias.gain | Of 0.61 m/s the sequential search leaves 0.55 m/s by the printed digits: a gain of less "
    "than a tenth.",
    lambda: Bound(SEQUENTIAL_SPEED, ">", sp.Rational(9, 10) * velocity_behind(POSITION, HALF_RUN)),
    "table.bias.thousand | In the 1000 s of the text they are 0.30 m/s, and both searches of table 1 would have "
    "made the velocity worse.",
    lambda: Bound(velocity_behind(POSITION, 2 * HALF_RUN), "<", FULL_SPEED),
    "table.grid | Steps of 50 m and 1 m/s alone leave 104 m after 500 s and 205 m after 1000 s. | CERTIFIED",
    lambda: Equation(
        [sp.Integer(104), sp.Integer(205)],
        [error_of_the_grids(HALF_RUN), error_of_the_grids(2 * HALF_RUN)],
        tolerance=sp.Rational(1, 2),
    ),
    "table.grid.length | The 92.7 m of the joint search are reached by its grids alone, without noise, in a flight "
    "of 443 s. | CERTIFIED",
    lambda: Equation(FULL, error_of_the_grids(sp.Integer(443)), tolerance=sp.Rational(1, 20)),
    "table.runs | 5 tracks with 20 flights each are 100 runs: an RMS of normal errors in two axes is known to 5 "
    "per cent.",
    lambda: Equation([sp.Integer(100), sp.Rational(1, 20)], [RUNS, relative_deviation(RUNS)]),
    "table.runs.position | The 4.6 per cent between 97.0 m and 92.7 m are within one standard deviation (7.1) of "
    "two independent series.",
    lambda: Bound(SEQUENTIAL / FULL - 1, "<", sp.sqrt(2) * relative_deviation(RUNS)),
    "table.runs.velocity | The 14.6 per cent between 0.55 and 0.48 m/s are, by the printed digits, more than two "
    "standard deviations.",
    lambda: Bound(SEQUENTIAL_SPEED / FULL_SPEED - 1, ">", 2 * sp.sqrt(2) * relative_deviation(RUNS)),
)
