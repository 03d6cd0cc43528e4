"""Many points at once: bands against balls, the twin against the ball analysis, wrong results that are caught."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st

from navsym.core.balls import precision
from navsym.export.accuracy.rounding import BITS
from navsym.export.accuracy.vectors import analysed, exact_values, piece_at
from navsym.export.languages.targets import TARGETS
from navsym.export.ready import READY
from tests.attacks.points import bands, sweep, twin
from tests.export import samples

COMPILER = pytest.mark.skipif(TARGETS["c"].executable() is None, reason="needs a C compiler")
NUMBER = st.floats(-1e12, 1e12).filter(lambda x: x == 0 or abs(x) > 1e-12)
OPERATIONS = {
    "added": (bands.added, lambda x, y: x + y),
    "multiplied": (bands.multiplied, lambda x, y: x * y),
    "divided": (bands.divided, lambda x, y: x / y),
}


def band_of(high: float, low: float) -> bands.Band:
    head, tail = bands.fast_two_sum(np.array([high]), np.array([low]))
    return bands.Band(head, tail, np.zeros(1))


def ball(band: bands.Band) -> arb:
    return bands.ball_of(*(float(x.ravel()[0]) for x in (band.high, band.low, band.error)))


@pytest.mark.parametrize("name", OPERATIONS)
@given(numbers=st.tuples(NUMBER, NUMBER), tails=st.tuples(st.floats(-1, 1), st.floats(-1, 1)))
def test_a_band_contains_what_the_balls_compute(name: str, numbers, tails) -> None:
    a, b = (band_of(x, x * t * 2.0**-54) for x, t in zip(numbers, tails, strict=True))
    ours, theirs = OPERATIONS[name]
    with np.errstate(all="ignore"):
        found = ours(a, b)
    if not np.isfinite(found.error).all():
        assert (name == "divided" and numbers[1] == 0) or 0 < abs(float(found.high[0])) < bands.LEAST
        return
    with precision(600):
        assert ball(found).contains(theirs(ball(a), ball(b)))
        assert found.error[0] <= 2.0**-99 * abs(found.high[0])


@given(x=st.floats(0.1, 100), n=st.integers(-9, 9), error=st.floats(0, 1e-20))
def test_errors_of_the_arguments_are_carried_through(x: float, n: int, error: float) -> None:
    a = bands.Band(np.array([x]), np.zeros(1), np.array([error]))
    found = bands.whole_power(a, n)
    with precision(300):
        for end in (arb(x) - arb(error), arb(x) + arb(error)):
            assert ball(found).contains(end**n)


def test_nothing_is_known_of_what_underflows_or_overflows() -> None:
    tiny, large = bands.exactly(np.array([1e-200])), bands.exactly(np.array([1e200]))
    with np.errstate(all="ignore"):
        for found in (
            bands.multiplied(tiny, tiny),
            bands.multiplied(large, large),
            bands.divided(tiny, large),
            bands.divided(large, bands.exactly(np.zeros(1))),
        ):
            assert np.isinf(found.error).all()


def test_a_zero_stays_exact() -> None:
    found = bands.multiplied(bands.exactly(np.zeros(1)), bands.exactly(np.array([3.0])))
    assert found.high[0] == 0 and found.error[0] == 0


# -- the twin ---------------------------------------


def ready(name: str, real: str = "double") -> list:
    from navsym.export.materials import functions_from

    return functions_from(name, real=real)


def held_to_the_balls(function, count: int = 120) -> int:
    """Values inside each other's errors, and bounds within SLACK, at every point that the twin settles."""
    settled = 0
    chosen = list(itertools.islice(sweep.many_points(function, count), count))
    for piece in function.pieces:
        here = [p for p in chosen if piece_at(function, p) is piece]
        if not here:
            continue
        columns = [np.array(c) for c in zip(*here, strict=True)]
        with np.errstate(all="ignore"):
            values = twin.formula_values(piece, columns)
            bounds, doubt = twin.rounding_bounds(piece, columns, function.arithmetic)
        for k in np.flatnonzero(~np.broadcast_to(doubt, len(here))):
            settled += agreed(
                piece,
                here[k],
                function.arithmetic,
                [at(v, k, len(here)) for v in values],
                [float(np.broadcast_to(b, len(here))[k]) for b in bounds],
            )
    return settled


def at(band: bands.Band, k: int, n: int) -> tuple[float, ...]:
    return tuple(float(np.broadcast_to(x, n)[k]) for x in (band.high, band.low, band.error))


def agreed(piece, point, arithmetic, values, bounds) -> int:
    with precision(BITS):
        balls = [arb(x) for x in point]
        exact, errors = exact_values(piece, balls), [r.absolute for r in analysed(piece, balls, arithmetic)]
        for value, bound, theirs, error in zip(values, bounds, exact, errors, strict=True):
            if np.isfinite(value[2]) and theirs.is_finite():
                assert bands.ball_of(*value).overlaps(theirs)
            if not error.is_finite():
                assert bound == np.inf
            elif bound > sweep.LEAST_BOUND:
                assert abs(bound / float(error) - 1) < twin.SLACK / 16
    return 1


@pytest.mark.parametrize("real", ["double", "float"])
def test_the_twin_is_the_ball_analysis_on_all_samples(real: str) -> None:
    assert sum(held_to_the_balls(f, 60) for f in samples.functions(real)) > 0


@pytest.mark.slow
@pytest.mark.parametrize("name", READY)
def test_the_twin_is_the_ball_analysis_on_every_ready_made_function(name: str) -> None:
    for function in ready(name):
        assert held_to_the_balls(function) > (0 if not function.inputs else 60), function.name


# -- the sweep ---------------------------------------


@COMPILER
@pytest.mark.parametrize("real", ["double", pytest.param("float", marks=pytest.mark.long)])
def test_the_c_of_every_sample_holds_at_many_points(real: str) -> None:
    for name, found in sweep.sweep_c(samples.functions(real), 3000).items():
        assert found.wrong == 0, (name, found)


@COMPILER
@pytest.mark.parametrize("name", [pytest.param(n, marks=[] if n == "earth" else pytest.mark.long) for n in READY])
def test_the_c_of_every_ready_made_function_holds_at_two_thousand_points(name: str) -> None:
    functions = ready(name)
    for function, found in zip(functions, sweep.sweep_c(functions, 2000).values(), strict=True):
        assert found.wrong == 0, (function.name, found)
        assert found.points >= (2000 if function.inputs else 1)


@COMPILER
def test_a_result_beyond_its_bound_is_caught(tmp_path: Path) -> None:
    function = samples.by_name("Phi33")
    (call,) = sweep.compiled_c([function], tmp_path)

    def off(columns):
        statuses, results = call(columns)
        return statuses, results * np.where(np.arange(results.shape[1]) == 77, 1 + 1e-13, 1.0)

    found = sweep.sweep(function, off, 500)
    assert found.wrong == 1 and found.example is not None


@COMPILER
def test_a_status_that_is_not_ok_is_caught(tmp_path: Path) -> None:
    function = samples.by_name("Phi33")
    (call,) = sweep.compiled_c([function], tmp_path)
    found = sweep.sweep(function, lambda columns: (call(columns)[0] + 2, call(columns)[1]), 60)
    assert found.wrong == found.points >= 60


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_float_points_are_numbers_of_the_type(seed: int) -> None:
    from navsym.export.parts import inside

    low = -0.3 - seed * 1e-9
    assert float(np.float32(inside(sp.Rational(low), 1, "float"))) == inside(sp.Rational(low), 1, "float") >= low
    assert inside(sp.Rational(low), 1, "double") == low
