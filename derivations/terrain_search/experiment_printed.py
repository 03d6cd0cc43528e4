"""The experiment: noise of the altimeter, the two accuracy measures and their units, table 1."""

import sympy as sp

from navsym.claims import Bound, Equation, claims
from navsym_papers.terrain_search.model import n
from navsym_papers.terrain_search.problem import count_of

POSITION, FULL, SEQUENTIAL = sp.Rational("152.2"), sp.Rational("92.7"), sp.Rational("97.0")
FULL_SPEED, SEQUENTIAL_SPEED = sp.Rational("0.48"), sp.Rational("0.55")
scale = sp.Symbol("lamda", positive=True)


def noise():
    absolute, above = sp.symbols("h_abs h_rv", positive=True)
    return Equation(
        [sp.Rational("0.015") * above, sp.Integer(12)],
        [noise_deviation(absolute, above), noise_deviation(absolute, sp.Integer(800))],
    )


def noise_deviation(absolute, above):
    """Deviation of h_abs - h_rv (1 + 0.015 e), e normal of variance one: the size of its derivative."""
    e = sp.Symbol("e", real=True)
    return -sp.diff(absolute - above * (1 + sp.Rational("0.015") * e), e)


# The accuracy measures


def errors(count):
    """Errors of ``count`` runs in x and y."""
    return [(sp.Symbol(f"e{m}", positive=True), sp.Symbol(f"f{m}", positive=True)) for m in range(count)]


def printed_measure(runs, count):
    """sqrt(sum sqrt(e^2 + f^2) / (n - 1)) of n runs."""
    return sp.sqrt(sum(sp.sqrt(e**2 + f**2) for e, f in runs) / (count - 1))


def mean_square_measure(runs, count):
    """sqrt(sum (e^2 + f^2) / n) of n runs."""
    return sp.sqrt(sum(e**2 + f**2 for e, f in runs) / count)


def scales(measure, count):
    """That a measure of so many runs is as much larger as the unit is smaller."""
    runs = errors(count)
    return Equation(scale * measure(runs, count), measure([(scale * e, scale * f) for e, f in runs], count))


def largest_error():
    """Largest error of the position search after 1000 s: true and found hypothesis in opposite corners.

    Along an axis: 1000 m found, 1000 m and 5 m/s true, and 2000 m for what accelerometer errors may add.
    """
    along = sp.Integer(1000) + 1000 + 5 * 1000 + 2000
    return sp.sqrt(2 * along**2)


def mean_error_that_the_measure_would_need():
    runs, mean_error = 20, sp.Symbol("e", nonnegative=True)
    # At a mean error of 20 km - e the square of the measure is (n + 1)/(n - 1) times it, below 152.2^2.
    return Bound((20000 - mean_error) * sp.Rational(runs + 1, runs - 1), "<", POSITION**2)


def mean_error_in_a_cell():
    # In polar coordinates it is the integral of sec^3/3 from 0 to pi/4; the primitive of sec^3 is checked at every
    # angle.
    angle = sp.Symbol("phi", real=True)
    sec, tan = 1 / sp.cos(angle), sp.tan(angle)
    primitive = (sec * tan + sp.log(sec + tan)) / 2
    at = (primitive.subs(angle, sp.pi / 4) - primitive.subs(angle, 0)) / 3
    return Equation(
        [sec**3, (sp.sqrt(2) + sp.log(1 + sp.sqrt(2))) / 6], [sp.diff(primitive, angle), at], {angle: (0, sp.pi / 4)}
    )


def accuracy_is_that_of_the_grid():
    # A uniform error in a cell has the variance 1/12 on an axis; the end is half of 500 s from the middle.
    deviation = sp.sqrt(2 * sp.Rational(1, 12))
    return Equation([41, 102], [100 * deviation, deviation * 250], tolerance=sp.Rational(1, 2))


def white_accelerometer_errors():
    steps, interval = 2000, sp.Rational(1, 2)
    square = steps * sp.Rational("0.005") * interval**2 + (sp.Rational("0.001") * 1000) ** 2
    return Equation(sp.Rational("2.65"), sp.sqrt(2 * square), tolerance=sp.Rational("0.005"))


CLAIMS = claims(
    "grid.experiment | 41 hypotheses of 50 m and 11 of 1 m/s reach 1000 m and 5 m/s to either side.",
    lambda: Equation(
        [sp.Integer(41), sp.Integer(11)], [sp.Integer(len(range(-1000, 1001, 50))), sp.Integer(len(range(-5, 6, 1)))]
    ),
    "noise | If an altimeter errs in proportion to what it measures, the deviation is 0.015 h_rv: 12 m at 800 m.",
    noise,
    "sigma.unit | The accuracy measure is a length: in a unit 1/lambda it is lambda times as large. | paper: under "
    "the outer root stand lengths, not their squares: the measure is a root of metres, though table 1 gives "
    "metres; the inner root should not be there; by hand: errors of 100 m each make it about 10",
    lambda: scales(printed_measure, 3),
    "sigma.unit* | The root of the mean square error is a length.",
    lambda: scales(mean_square_measure, 3),
    "sigmaV.unit | The velocity measure is a velocity: it scales with the unit of velocity. | paper: the same "
    "inner root in the velocity measure: a root of m/s where the table has m/s; by hand: errors of 0.25 m/s each "
    "make it about 0.5",
    lambda: scales(printed_measure, 2),
    "sigmaV.unit* | The root of the mean square velocity error is a velocity.",
    lambda: scales(mean_square_measure, 2),
    "sigma.count | The sum over i = 0…n has as many terms as there are experiments, n. | paper: the sum i = 0…n "
    "has n + 1 terms for n experiments",
    lambda: Equation(n, count_of(0, n)),
    "sigma.count* | The sum over i = 1…n has n terms.",
    lambda: Equation(n, count_of(1, n)),
    # In 1000 s and 20 runs or more. An accelerometer error that is constant in a run adds 44 km: then it could be.
    "sigma.table | If accelerometers add at most 2 km to errors within the hypotheses, 152.2 is no value of the "
    "printed measure.",
    lambda: Bound(POSITION, ">", sp.sqrt((20 + 1) * largest_error() / (20 - 1))),
    "sigma.mean | As a value of the printed measure for 20 runs, 152.2 would need a mean error of 20 km and more.",
    mean_error_that_the_measure_would_need,
    # Words about table 1
    "table.close | By the printed digits the sequential search loses at most 15 per cent in position.",
    lambda: Bound(SEQUENTIAL, "<=", sp.Rational("1.15") * FULL),
    "table.close.velocity | By the printed digits the sequential search loses at most 15 per cent in velocity.",
    lambda: Bound(SEQUENTIAL_SPEED, "<=", sp.Rational("1.15") * FULL_SPEED),
    "table.close.mean | If the figures are values of the printed measure, mean errors grow by 9.5 and 31.3 per "
    "cent, not at most 15. | CERTIFIED",
    lambda: Equation(
        [sp.Rational("9.5"), sp.Rational("31.3")],
        [100 * ((SEQUENTIAL / FULL) ** 2 - 1), 100 * ((SEQUENTIAL_SPEED / FULL_SPEED) ** 2 - 1)],
        tolerance=sp.Rational("0.05"),
    ),
    "sigmaV.cell | The mean distance from the middle of a square cell of side 1 is (sqrt(2) + ln(1 + sqrt(2)))/6.",
    mean_error_in_a_cell,
    "sigmaV.floor | As values of the printed measure 0.48 and 0.55 mean less than the 0.38 m/s of errors even in "
    "cells of 1 m/s.",
    lambda: Bound(SEQUENTIAL_SPEED**2, "<", (sp.sqrt(2) + sp.log(1 + sp.sqrt(2))) / 6),
    "table.better | By table 1 the position search is worse than the sequential one by more than half.",
    lambda: Bound(POSITION, ">=", sp.Rational("1.5") * SEQUENTIAL),
    "table.quantisation | A grid of 1 m/s by itself leaves errors of 0.41 m/s and, 250 s from the middle of 500 s, "
    "102 m. | CERTIFIED",
    accuracy_is_that_of_the_grid,
    "table.acceleration | The printed mean of 0.001 m/s^2 on both axes leaves 0.71 m/s after 1000 s, more than the "
    "0.48 of table 1.",
    lambda: Bound(FULL_SPEED, "<", sp.sqrt(2) * (sp.Rational("0.001") * 1000 / 2)),
    "table.acceleration.sigma | Read as a constant of the run, an accelerometer error of one sigma leaves the "
    "searched +-5 m/s within 71 s.",
    lambda: Bound(sp.Integer(5), "<", sp.sqrt(sp.Rational("0.005")) * 71),
    "table.acceleration.white | Read as white, one of N(0.001, 0.005) a measurement at 2 Hz: 2.65 m/s on both axes "
    "after 1000 s. | CERTIFIED",
    white_accelerometer_errors,
    "table.real_time | The joint search of table 1 keeps up with the flight: 40.1 s for 1000 measurements at 2 Hz.",
    lambda: Bound(sp.Rational("40.1"), "<=", sp.Rational(1000, 2)),
)
