"""Models whose F depends on the time: rigorous Taylor integration against closed forms."""

from __future__ import annotations

import json

import numpy as np
import pytest
import sympy as sp
from flint import arb
from scipy.linalg import expm
from scipy.optimize import linprog

from navsym import checker
from navsym.core.errors import DomainError, NavsymError, NotEstimableError
from navsym.guaranteed.estimability import unobservable_directions
from navsym.guaranteed.problem import from_contents
from navsym.guaranteed.solver import solve
from navsym.guaranteed.time_varying import largest_upper_end
from navsym.models.modelfile import model_from


def model(F, h, T, target, pieces=None):
    n = len(h)
    document = {
        "model": {"states": [f"x{k}" for k in range(n)], "F": F},
        "measurement": [{"name": "z", "h": h, "sigma": "1"}],
        "interval": {"T": T},
        "targets": {"c": target},
    }
    if pieces is not None:
        del document["model"]["F"]
        document["piece"] = pieces
    return from_contents(model_from(document))


def encloses(solution, value):
    exact = sp.Rational(str(sp.N(value, 50)))
    return sp.Rational(solution.lower) <= exact <= sp.Rational(solution.upper)


def test_a_rate_that_grows_with_time_has_its_gauss_function():
    """x' = -2 t x: H(tau) = exp(T^2 - tau^2) is largest at 0."""
    solution = solve(model([["-2*t"]], ["1"], "1", ["1"]), digits=25)
    assert encloses(solution, sp.exp(-1)) and solution.status == "CERTIFIED"
    assert checker.check(checker.load(json.dumps(dict(solution.certificate)))) == "sliver"


def test_a_double_integrator_whose_gain_varies():
    """x' = (1 + t) v: position at T from its measurements is its own; v costs 2 over the distance of a unit speed."""
    solution = solve(model([["0", "1+t"], ["0", "0"]], ["1", "0"], "2", ["0", "1"]), digits=25)
    assert encloses(solution, sp.Rational(2, 4))


def test_pieces_may_vary_and_agree_with_one_piece():
    F = [["0", "1+t"], ["0", "0"]]
    pieces = [{"from": "0", "to": "1", "F": F}, {"from": "1", "to": "2", "F": F}]
    solution = solve(model(F, ["1", "0"], "2", ["0", "1"], pieces), digits=20)
    assert encloses(solution, sp.Rational(1, 2))


@pytest.mark.long
@pytest.mark.parametrize("T", ["1", "pi/2"])
def test_a_matrix_without_a_closed_exponential_is_integrated(T):
    """The characteristic polynomial s**3 - s - 1 is irreducible; the peer is a linear program on a fine grid."""
    F = [["0", "1", "0"], ["0", "0", "1"], ["1", "1", "0"]]
    solution = solve(model(F, ["1", "0", "0"], T, ["0", "0", "1"]), digits=20)
    assert checker.check(checker.load(json.dumps(dict(solution.certificate)))) == "sliver"
    length = {"1": 1.0, "pi/2": np.pi / 2}[T]
    H = np.array([expm(np.array(F, dtype=float) * (s - length))[0] for s in np.linspace(0, length, 2001)])
    grid = linprog(np.ones(2 * len(H)), A_eq=np.hstack([H.T, -H.T]), b_eq=[0, 0, 1])
    assert float(solution.value) == pytest.approx(grid.fun, rel=1e-6)


@pytest.mark.parametrize(
    ("F", "h", "target", "direction"),
    [
        ([["0", "t"], ["0", "0"]], ["0", "1"], ["1", "0"], "1, 0"),
        ([["0", "1+t", "1+t"], ["0", "0", "0"], ["0", "0", "0"]], ["1", "0", "0"], ["0", "1", "0"], "0, -1, 1"),
        ([["0", "-t"], ["t", "0"]], ["cos(t**2/2)", "sin(t**2/2)"], ["1", "0"], r"-sin\(1/2\)/cos\(1/2\), 1"),
        ([["0", "1/(1+t)"], ["0", "-1/(1+t)"]], ["0", "1"], ["1", "0"], "1, 0"),
    ],
)
def test_a_state_that_no_measurement_shows_is_named_exactly_also_where_F_depends_on_the_time(F, h, target, direction):
    with pytest.raises(NotEstimableError, match=rf"null direction \[{direction}\]"):
        solve(model(F, h, "1", target), digits=20)


def test_what_a_null_direction_does_not_change_is_estimated():
    """The component along the measured direction, of a state that turns: one observation at the end."""
    F, h = [["0", "-t"], ["t", "0"]], ["cos(t**2/2)", "sin(t**2/2)"]
    assert encloses(solve(model(F, h, "1", ["cos(1/2)", "sin(1/2)"]), digits=20), 1)


def test_a_state_that_no_piece_shows_is_named_and_one_that_an_earlier_piece_shows_is_estimated():
    """Velocity is measured: position is never seen. A gain that begins at 1 hides the bias after it only."""
    velocity = [["0", "1", "0"], ["0", "0", "t"], ["0", "0", "0"]]
    later = [["0", "1", "0"], ["0", "0", "1"], ["0", "0", "0"]]
    pieces = [{"from": "0", "to": "1", "F": velocity}, {"from": "1", "to": "2", "F": later}]
    with pytest.raises(NotEstimableError, match=r"null direction \[1, 0, 0\]"):
        solve(model(None, ["0", "1", "0"], "2", ["1", "0", "0"], pieces), digits=20)
    seen = [{"from": "0", "to": "1", "F": [["0", "t"], ["0", "0"]]}, {"from": "1", "to": "2", "F": [["0", "0"]] * 2}]
    assert solve(model(None, ["1", "0"], "2", ["0", "1"], seen), digits=20).status == "CERTIFIED"


def test_a_regressor_with_a_kink_proves_no_null_direction():
    """z = |t - 1/2| x1 + (t - 1/2) x2 is blind to (1, 1) before 1/2 only, or after it; both are seen together."""
    found = model_from(
        {
            "model": {"states": ["a", "b"], "F": [["t", "0"], ["0", "t"]]},
            "measurement": [{"name": "z", "h": ["abs(t - 1/2)", "t - 1/2"], "sigma": "1"}],
            "interval": {"T": "1"},
            "targets": {"c": ["1", "0"]},
        }
    )
    assert unobservable_directions(found) == []


def test_ends_that_are_not_rational_and_singularities_are_refused():
    with pytest.raises(DomainError, match="rational ends"):
        model([["-2*t"]], ["1"], "pi", ["1"])
    with pytest.raises(NavsymError, match="steps of order"):
        model([["1/(t-1/2)"]], ["1"], "1", ["1"])


@pytest.mark.parametrize("h", ["sqrt(t*(1 - t) + 1/10)", "1/(t*(1 - t) + 1/10)"])
def test_a_regressor_that_one_ball_cannot_enclose_still_has_the_error_of_the_motion(h):
    F = [["0", "exp(t)"], ["0", "0"]]
    assert model(F, [h, "0"], "1", ["0", "1"]).error >= model(F, ["1", "0"], "1", ["0", "1"]).error / 10


@pytest.mark.parametrize("h", [["1/(3*t - 1)", "0"], ["1", "log(t - 1/3)"], ["0", "1/t"]])
def test_a_regressor_that_is_singular_on_the_interval_is_refused(h):
    with pytest.raises(NavsymError, match="expected functions that are finite"):
        model([["0", "t"], ["0", "0"]], h, "1", ["0", "1"])


def test_the_largest_of_balls_is_no_number_when_one_of_them_is_none():
    assert 4 <= largest_upper_end([arb(1), arb(3, 1), arb(2)]) < 4.001
    for at in range(3):
        values = [arb(1), arb(2), arb(3)]
        values[at] = arb("nan")
        assert not largest_upper_end(values).is_finite()
