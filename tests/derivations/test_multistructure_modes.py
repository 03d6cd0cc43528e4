"""Error models of the multi-structure paper: Jacobians twice, the Schuler channel three times."""

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose

from navsym.core.casadi_functions import casadi_function
from navsym_papers.multistructure import model as reckoning
from navsym_papers.multistructure.experiment import modes


@pytest.mark.parametrize("point", np.random.default_rng(2).uniform(-1.2, 1.2, (5, 6)))
def test_jacobians_by_sympy_and_by_algorithmic_differentiation_are_equal(point):
    import casadi as ca

    model = reckoning.dead_reckoning()
    S = model.right_side().subs(reckoning.radius, 3)
    inputs = [list(model.errors), list(model.sensor_errors), [*model.reckoned, *model.readings]]
    generated = casadi_function("S", inputs, S)
    where = np.concatenate([point[:5], [1.0]])
    shapes = [ca.MX.sym("e", 2), ca.MX.sym("d", 4), ca.MX.sym("u", 6)]
    value = generated(*shapes)
    differentiated = ca.Function("J", shapes, [ca.jacobian(value, shapes[0]), ca.jacobian(value, shapes[1])])
    ours = model.linear_parts()
    symbols = [*model.reckoned, *model.readings]
    for theirs, matrix in zip(differentiated(np.zeros(2), np.zeros(4), where), ours, strict=True):
        exact = matrix.subs(dict(zip(symbols, map(sp.Float, where), strict=True))).subs(reckoning.radius, 3)
        assert_allclose(np.array(theirs), np.array(exact.evalf(), dtype=float), rtol=1e-12, atol=1e-14)


def schuler_matrix() -> tuple[sp.Matrix, dict[str, sp.Symbol]]:
    """A of ``d/dt (v, phi, eps) = A (v, phi, eps)`` with g and R as symbols."""
    g, R = sp.symbols("g R", positive=True)
    return sp.Matrix([[0, g, 0], [-1 / R, 0, 1], [0, 0, 0]]), {"g": g, "R": R}


def schuler_transition() -> tuple[sp.Matrix, dict[str, sp.Symbol]]:
    """The closed form of exp(A tau), with w = sqrt(g / R).

    v' = v cos + (g/w) phi sin + (g/w^2) eps (1 - cos),  phi' = -(v w / g) sin + phi cos + (eps / w) sin.
    """
    _, symbols = schuler_matrix()
    g, R, tau = symbols["g"], symbols["R"], sp.Symbol("tau", positive=True)
    w = sp.sqrt(g / R)
    s, c = sp.sin(w * tau), sp.cos(w * tau)
    transition = sp.Matrix([[c, g / w * s, R * (1 - c)], [-w / g * s, c, s / w], [0, 0, 1]])
    return transition, {**symbols, "tau": tau}


def test_the_schuler_transition_solves_its_equation():
    A, symbols = schuler_matrix()
    transition, _ = schuler_transition()
    tau = sp.Symbol("tau", positive=True)
    rest = (transition.diff(tau) - A * transition).subs({symbols["g"]: 3, symbols["R"]: 5})
    assert all(sp.expand(entry) == 0 for entry in rest)
    assert transition.subs(tau, 0) == sp.eye(3)


def test_the_numbers_of_the_channel_are_those_of_its_formula():
    channel = modes.SchulerChannel()
    transition, symbols = schuler_transition()
    values = {symbols["g"]: modes.GRAVITY, symbols["R"]: modes.EARTH_RADIUS, symbols["tau"]: channel.tau}
    assert_allclose(channel.transition(), np.array(transition.subs(values).evalf(30), dtype=float), rtol=1e-9)


def test_the_channel_is_a_bank_of_three_modes():
    channel = modes.SchulerChannel()
    assert len(channel.models()) == len(modes.MODES) == 3
    assert_allclose(channel.mode_transition().sum(axis=1), 1.0, atol=1e-15)
    assert channel.models()[2]["R"][0, 0] == pytest.approx(100 * channel.models()[0]["R"][0, 0])
