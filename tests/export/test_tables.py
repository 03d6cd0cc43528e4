"""Regimes without a closed form as code: tables whose errors of interpolation enclose the certified optimum."""

from __future__ import annotations

import importlib.util
import math
import random
from dataclasses import replace
from fractions import Fraction

import pytest
import sympy as sp

import navsym as nav
from navsym import checker
from navsym.export.materials import join_pieces
from navsym.guaranteed.phases import tables

#: Position alone shows the three errors of an inertial channel; no regime has a closed form.
CHANNEL = {
    "states": "x y1 y2 y3",
    "F": [["0", "1", "0", "0"], ["0", "0", "-1", "0"], ["0", "0", "0", "1"], ["0", "0", "-1", "0"]],
    "H": ["x"],
    "sigma": "3",
    "interval": "T",
    "targets": {"velocity": "y1"},
    "T": ("0", "2*pi"),
}


@pytest.fixture(scope="module")
def found():
    return nav.phases(nav.Model(**CHANNEL), T=("2", "2.05"))


def evaluate(polynomial, share):
    """The polynomial at a share."""
    return sum(c * share**k for k, c in enumerate(polynomial))


def distances(found, pieces, count, digits=40):
    """Error of the value, sum of sigma times those of the weights, that of the times, and the piece, at random."""
    rng, family = random.Random(2), found.family
    for _ in range(count):
        at = found.lower + (found.upper - found.lower) * sp.Rational(rng.randrange(1, 10**6), 10**6)
        piece = next(p for p in pieces if p.lower <= at <= p.upper)
        optimum = nav.solve(nav.Model(**CHANNEL), T=str(at), digits=digits)
        share, scale = piece.share.subs(family.parameter, at), at**piece.shift
        weights = [evaluate(weight, share) / scale for *_, weight in piece.contacts]
        times = [at - at * evaluate(place, share) for _, place, _ in piece.contacts]  # counted back from the end
        known = sorted((sp.Rational(p.at.lower), sp.Rational(p.weight.lower) * 3) for p in optimum.support)
        pairs = list(zip(sorted(zip(times, weights, strict=True)), known, strict=True))
        yield (
            abs(sum(map(abs, weights)) - sp.Rational(optimum.lower)),
            sum(abs(w - v) for (_, w), (_, v) in pairs),
            max(abs(t - u) for (t, _), (u, _) in pairs),
            piece,
        )


def test_errors_of_interpolation_enclose_the_certified_optimum(found):
    pieces = [piece for regime in found.regimes for piece in tables.tabulate_regime(regime)]
    assert pieces[0].lower == found.lower and pieces[-1].upper == found.upper
    for value, weights, times, piece in distances(found, pieces, 6):
        assert value <= piece.error + sp.Rational(1, 10**36) and weights <= piece.error + sp.Rational(1, 10**36)
        assert times <= piece.time_error + sp.Rational(1, 10**36) and piece.error < sp.Rational(1, 10**12)
        assert checker.check(piece.certificate) == "all"


def test_polynomials_of_low_degree_have_larger_errors_that_are_not_far_from_the_truth(found, monkeypatch):
    monkeypatch.setattr(tables, "DEGREES", (2,))
    pieces = [piece for regime in found.regimes for piece in tables.tabulate_regime(regime)]
    seen = [(value, weights, piece) for value, weights, _, piece in distances(found, pieces, 4, digits=20)]
    assert all(value <= piece.error and weights <= piece.error for value, weights, piece in seen)
    assert all(piece.error > sp.Rational(1, 10**12) for *_, piece in seen)
    assert max(weights / piece.error for _, weights, piece in seen) > sp.Rational(1, 100)


@pytest.mark.long
def test_a_regime_without_a_closed_form_is_exported_compiled_and_replayed(found, tmp_path):
    out = tmp_path / "code"
    short = nav.phases(nav.Model(**CHANNEL), T=("2", "2.02"))
    answer = nav.export(short, ["c", "python"], out, vectors=10)
    assert [outcome.status for outcome in answer.outcomes] == ["verified"] * 2
    assert all(row.status == "ACCEPTED" for row in nav.check(out))
    assert "within" in (out / "c" / "velocity.h").read_text()
    spec = importlib.util.spec_from_file_location("navsym_functions", out / "python" / "navsym_functions.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert Fraction("2.02") < 2.02  # the double nearest to the end is outside, and stands for it
    with pytest.raises(ValueError, match="expected numbers"):
        module.velocity(math.nextafter(2.02, 3.0))
    for at in (2.0, 2.0078125, 2.02):
        value, weights, times, error, late = module.velocity(at)
        known = nav.solve(nav.Model(**CHANNEL), T=str(Fraction(at)))
        assert abs(value - float(known.lower)) <= error + 1e-14 * value and error < 1e-12 and late < 1e-12
        assert list(weights) == pytest.approx([float(w) for w in known.weights], rel=1e-12)
        assert list(times) == pytest.approx([float(p.at) for p in known.support], abs=1e-12)


@pytest.mark.long
def test_noise_bounds_and_panels_that_move_with_the_parameter_are_part_of_the_table():
    model = nav.Model.from_basis(
        [["1", "s", "exp(s)"], ["0", "1", "exp(s)"]], variable="s", interval=["0", "1"], sigma=["1", "p"],
        targets={"slope": ["0", "1", "0"]}, p=("1/4", "1/2"),
    )  # fmt: skip
    answer = nav.phases(model, p=("1/4", "1/2"))
    pieces = [p for regime in answer.regimes if regime.closed is None for p in tables.tabulate_regime(regime)]
    for piece in pieces:
        at = (piece.lower * 2 + piece.upper) / 3
        share = piece.share.subs(answer.family.parameter, at)
        value = sum(abs(evaluate(weight, share)) for *_, weight in piece.contacts)
        known = nav.solve(model, p=str(at), digits=20)
        assert abs(value - sp.Rational(known.lower)) <= piece.error + sp.Rational(1, 10**17)


def test_a_hole_with_a_double_in_it_is_refused_and_one_without_is_closed(found):
    regime = found.regimes[0]
    pieces = list(tables.tabulate_regime(regime))
    from navsym.export.materials import material_of_piece

    parts = [material_of_piece(found, regime, piece) for piece in pieces]
    parameter, tiny = found.family.parameter, sp.Rational(1, 10**20)
    low, high = parts[1].box[parameter]
    late = [parts[0], replace(parts[1], box={parameter: (low + tiny, high)}), *parts[2:]]
    assert join_pieces(late, found, "double")[1].box[parameter] == (low, high)
    with pytest.raises(nav.NavsymError, match="whole range"):
        join_pieces([parts[0], *parts[2:]], found, "double")


@pytest.mark.long
def test_tables_meet_at_a_boundary_that_is_known_by_its_digits(tmp_path):
    model = nav.Model(**CHANNEL | {"targets": {"drift": "y3"}})
    answer = nav.phases(model, T=("2.35", "2.355"))
    assert len(answer.regimes) == 2 and len(answer.uncovered) == 0
    done = nav.export(answer, ["c", "python"], tmp_path / "code", vectors=20)
    assert [outcome.status for outcome in done.outcomes] == ["verified"] * 2
    spec = importlib.util.spec_from_file_location("edge", tmp_path / "code" / "python" / "navsym_functions.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    middle = float(sp.Rational(answer.boundaries[0].lower))
    for at in (middle, *(middle + side * 2.0**-k for k in (10, 30, 50) for side in (1, -1))):
        known = nav.solve(model, T=str(Fraction(at)))
        value, weights, times, error, _ = module.drift(at)
        slack = error + 1e-13 * value  # next to the boundary the single optimum is OPEN, and its ends are not close
        assert float(known.lower) - slack <= value <= float(known.upper) + slack
        assert sum(map(abs, weights)) * 3 == pytest.approx(value, rel=1e-12)


def test_an_optimum_that_is_not_enclosed_closely_is_refused_in_one_line(found, monkeypatch, tmp_path):
    monkeypatch.setattr(tables, "newton_image", lambda *these: None)
    with pytest.raises(nav.NavsymError, match="narrow the range") as caught:
        nav.export(found, "c", tmp_path / "x")
    assert "\n" not in str(caught.value) and not (tmp_path / "x").exists()
