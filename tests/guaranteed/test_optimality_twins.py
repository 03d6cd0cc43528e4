"""The fast tests of an optimum beside their slow twins: one polynomial for a panel, tapes; boxes of exact contacts."""

from __future__ import annotations

import random
from functools import partial

import pytest
import sympy as sp
from flint import arb, arb_series, fmpq

from navsym.core.balls import OPERATIONS, precision
from navsym.guaranteed.certificate import basis as basis_room
from navsym.guaranteed.certificate.basis import DependentError, make_basis, orthonormal_transform, sample_panels
from navsym.guaranteed.certificate.enclosure import (
    Panel,
    PanelCell,
    PanelProblem,
    Touch,
    interval_ball,
    joint_tape,
    panel_polynomial,
    prove_panel_bound,
    series_terms,
    shift_polynomial,
)
from navsym.guaranteed.certificate.entire import REMAINDERS
from navsym.guaranteed.certificate.fixed import certify, solution_box, solution_unknowns
from navsym.guaranteed.certificate.polish import sharpen_contacts
from navsym.guaranteed.search.exchange import find_contacts

t = sp.Symbol("t", real=True)
R, e, sin, cos = sp.Rational, sp.exp, sp.sin, sp.cos
FULL = {
    "drift of the velocity problem": ([1, -sin(1 - t), cos(1 - t) - 1], [0, 0, 1], 1),
    "monomials": ([t**k for k in range(6)], [0, 0, 0, 1, 0, 0], 1),
    "a mixed basis": ([1, t, sin(2 * t), cos(2 * t), e(-t), t * e(-t)], [0, 0, 0, 1, 0, 0], 3),
}


def problem(functions, functional, end, sigma=1):
    panel = Panel(0, tuple(map(sp.sympify, functions)), t, sp.S.Zero, sp.sympify(end), sp.sympify(sigma))
    return PanelProblem((panel,), tuple(map(sp.sympify, functional)))


def polished(case, sigma=1):
    made = problem(*case, sigma)
    basis = make_basis(made)
    return made, sharpen_contacts(made.panels, basis, find_contacts(basis.panels), 256, 1e-50)


@pytest.mark.parametrize("case", FULL)
def test_the_image_of_newtons_method_contains_the_solution_of_a_smaller_box(case):
    made, found = polished(FULL[case], R(2, 3))
    with precision(256):
        centre = [c.mid() for c in solution_unknowns(found)]
        small, large = (
            solution_box(made, found, centre, [radius * (1 + abs(c)).mid() for c in centre])
            for radius in (arb(10) ** -40, arb(10) ** -12)
        )
        assert small is not None and large is not None
        assert all(a.overlaps(b) and a.rad() <= b.rad() for a, b in zip(small, large, strict=True))


@pytest.mark.parametrize("case", FULL)
@pytest.mark.parametrize("k", [0, -1])
def test_a_centre_off_the_solution_by_more_than_the_box_is_refused(case, k):
    made, found = polished(FULL[case])
    with precision(256):
        radii = [arb(10) ** -20 * (1 + abs(c)).mid() for c in solution_unknowns(found)]
        off = list(solution_unknowns(found))
        off[k] = (off[k] + 3 * radii[k]).mid()
        assert solution_box(made, found, off, radii) is None


def test_a_box_with_a_ball_that_is_no_number_is_refused():
    made, found = polished(FULL["monomials"])
    with precision(256):
        centre = list(solution_unknowns(found))
        assert solution_box(made, found, [arb("nan"), *centre[1:]], [arb(10) ** -20] * len(centre)) is None


@pytest.mark.parametrize("case", FULL)
def test_the_polynomial_of_a_panel_encloses_every_coefficient_of_every_cell(case):
    panel, x = problem(*FULL[case]).panels[0], [arb(k + 1) / 3 for k in range(len(FULL[case][0]))]
    rng = random.Random(case)
    with precision(160):
        model = panel_polynomial(panel, x)
        assert model is not None
        for _ in range(40):
            lower, upper = sorted(fmpq(rng.randint(0, 1 << 20), 1 << 20) for _ in range(2))
            if lower == upper:
                continue
            centre, radius = (lower + upper) / 2, (upper - lower) / 2
            coarse = shift_polynomial(model, None, PanelCell(lower, upper), centre, radius)
            last = len(coarse) - 1
            point = panel.dual_polynomial(x, arb(centre), radius, last)
            somewhere = lower + (upper - lower) * fmpq(rng.randint(0, 64), 64)
            there = panel.dual_polynomial(x, arb(somewhere), radius, last)
            assert all(a.overlaps(b) for a, b in zip(coarse[:last], point, strict=False))
            assert coarse[last].overlaps(there[last])


def test_a_dual_that_exceeds_its_bound_by_a_trillionth_between_coarse_cells_is_refused():
    functions, end = (sp.S.One, sin(9 * t), cos(9 * t), t), sp.S(5)
    panel = Panel(0, functions, t, sp.S.Zero, end, sp.S.One)
    with precision(200):
        over = [arb(0), arb(1) + arb(10) ** -12, arb(0), arb(0)]
        under = [arb(0), arb(1) - arb(10) ** -12, arb(0), arb(0)]
        assert prove_panel_bound(panel, over, []) is None
        tops = [fmpq(round(float(sp.pi / 18 + k * sp.pi / 9) * 2**60), 5 * 2**60) for k in range(14)]
        touches = [Touch(at, (-1) ** k) for k, at in enumerate(tops)]
        assert prove_panel_bound(panel, under, touches) is not None
        assert prove_panel_bound(panel, over, touches) is None


def test_a_panel_with_a_singular_or_wild_function_has_no_polynomial_and_is_still_bounded():
    root = Panel(0, (sp.sqrt(t), sp.S.One), t, R(1, 10**6), sp.S(1), sp.S.One)
    wild = Panel(0, (sin(300 * t), sp.S.One), t, sp.S(0), sp.S(1), sp.S.One)
    with precision(160):
        for panel in (root, wild):
            assert panel_polynomial(panel, [arb(1) / 2, arb(0)]) is None
            assert prove_panel_bound(panel, [arb(1) / 2, arb(0)], []) is not None
            assert prove_panel_bound(panel, [arb(2), arb(0)], []) is None


def test_tapes_give_the_balls_of_the_plain_operations():
    expressions = [sp.sympify(h) for h in FULL["a mixed basis"][0]] + [t**3 / (1 + t**2), sp.sqrt(1 + t), sp.tan(t / 4)]
    tape = joint_tape(expressions)
    for value in (arb(1) / 3, interval_ball(fmpq(1, 8), fmpq(1, 4)), arb_series([arb(1) / 3, arb(1)])):
        with precision(120), series_terms(6):
            done = []
            for step in tape.steps:
                arguments = [done[i] for i in step.arguments]
                done.append(OPERATIONS[step.operation](step.constant, arguments, {t: value}))
            plain, quick = [done[i] for i in tape.outputs], tape.run({t: value})
            assert [str(a) for a in plain] == [str(a) for a in quick]


def test_a_scaled_noise_bound_scales_the_weights_in_the_certificate():
    case = FULL["monomials"]
    one, two = certify(problem(*case), 20), certify(problem(*case, 2), 20)
    assert 2 * one.lower <= two.upper and two.lower <= 2 * one.upper
    weights = [[float(row["weight"][0]) for row in c.certificate["pieces"][0]["contacts"]] for c in (one, two)]
    assert weights[1] == pytest.approx([2 * w for w in weights[0]])


@pytest.mark.parametrize("case", FULL)
def test_a_transform_of_doubles_makes_the_functions_as_orthonormal_as_that_in_balls(case, monkeypatch):
    made = problem(*FULL[case])
    with precision(192):
        values = sample_panels(made.panels, 32, 192)
        for transform in (orthonormal_transform, partial(in_balls, monkeypatch)):
            A, loss = transform(values, 192)
            q = values * A.transpose()
            gram = (q.transpose() * q) * (arb(1) / 32)
            assert all(abs(gram[i, j] - (i == j)) < 1e-6 for i in range(gram.nrows()) for j in range(gram.ncols()))
            assert A.det() != 0 and loss < 12


def in_balls(monkeypatch, values, bits):
    monkeypatch.setattr(basis_room, "double_transform", lambda values: None)
    return orthonormal_transform(values, bits)


@pytest.mark.parametrize("f", [sin, cos, e])
@pytest.mark.parametrize("k", [0, 1, 4])
def test_a_remainder_is_its_function_without_the_first_terms_over_a_power_and_has_its_derivatives(f, k):
    first = sum(f(t).diff(t, j).subs(t, 0) * t**j / sp.factorial(j) for j in range(k))
    plain, entire = (f(3 * t) - first.subs(t, 3 * t) if k else f(3 * t)) / (3 * t) ** k, REMAINDERS[f](k, 3 * t)
    for order in range(3):
        one, other = (joint_tape([h.diff(t, order)]) for h in (plain, entire))
        with precision(200):
            at = {t: arb(1) / 7}
            a, b = one.run(at)[0], other.run(at)[0]
            assert a.overlaps(b) and abs(a - b) < 1e-30
            assert other.run({t: arb(0)})[0].is_finite() and not entire.func(k, t).on_balls(None, arb(2)).is_finite()


def test_pivots_that_are_known_to_few_bits_are_no_pivots():
    """1e-150 of an independent function is too little for 192 bits, and enough for more."""
    made = problem([1, t, t + e(t) / 10**150], [0, 0, 1], 1)
    with pytest.raises(DependentError):
        orthonormal_transform(sample_panels(made.panels, 32, 192), 192)
    assert make_basis(made).bits > 192
