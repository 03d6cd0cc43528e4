"""Maps in two parameters: against single optima, a scaling law, forms that are wrong, and by hand."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import navsym as nav
from navsym.claims import OPEN, Verdict
from navsym.cli.main import run
from navsym.core.balls import enclose
from navsym.guaranteed.phases.budget import Budget
from navsym.guaranteed.phases.patterns import sample_contacts
from navsym.guaranteed.phases.plane import prove_part, slice_family
from tests.benchmarks.lengths import values_for_lengths
from tests.benchmarks.twofold import exact_panels

TRIPLE = {
    "states": "x v a",
    "F": [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3],
    "H": ["x", "v"],
    "sigma": ["1", "p"],
    "interval": "T",
    "targets": {"a": "a"},
    "T": ("1", "6"),
    "p": ("1/2", "2"),
}
SCHULER = {
    "states": "y1 y2 y3",
    "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-w**2", "0"]],
    "H": ["y1"],
    "interval": "T",
    "targets": {"drift": "y3", "tilt": "y2"},
    "T": ("1/2", "6"),
    "w": ("1/2", "2"),
}


@pytest.fixture(scope="module")
def triple():
    return nav.phases(nav.Model(**TRIPLE), parameter=("T", "p"))


def value_at(found, values):
    """The value of the proved parts that contain a point; checked to be one."""
    first, second = (sp.Rational(str(values[name])) for name in found.parameters)
    here = set()
    for part in found.parts:
        ends = [end.subs(found.second, second) for end in (part.regime.lower, part.regime.upper)]
        inside = bool(enclose(first - ends[0]) >= 0) and bool(enclose(ends[1] - first) >= 0)
        if part.regime.closed and inside and part.low <= second <= part.high:
            put = {found.family.parameter: first, found.second: second}
            here.add(round(float(enclose(part.regime.value.subs(put)).mid()), 12))
    assert len(here) == 1, (values, here)
    return here.pop()


def disagreements(found, count, seed):
    """At how many random points of the rectangle the formula is not the optimum that a search finds there."""
    rng, wrong = random.Random(seed), 0
    low, high = found.second_ends
    for _ in range(count):
        second = sp.Rational(str(low + (high - low) * sp.Rational(rng.randrange(1, 10**6), 10**6)))
        share = sp.Rational(rng.randrange(1, 10**6), 10**6)
        first = found.first_ends[0] + (found.first_ends[1] - found.first_ends[0]) * share
        one = slice_family(found.family, found.second, second)
        basis, contacts = sample_contacts(one, Fraction(int(first.p), int(first.q)))
        cost = basis.scale * exact_panels(basis.panels).value(contacts)
        formula = value_at(found, dict(zip(found.parameters, (first, second), strict=True)))
        wrong += abs(cost - formula) > 1e-8 * formula
    return wrong


def disagreements_on_slices(found, slices, each, seed):
    """(points, disagreements) on random values of the second parameter, with as many of the first on each.

    The optimum is that of the search that follows contacts from one length to the next.
    """
    rng, compared, wrong = np.random.default_rng(seed), 0, 0
    low, high = (float(end) for end in found.second_ends)
    for second in rng.uniform(low, high, slices):
        exact = sp.Rational(float(second))
        T = rng.uniform(*(float(end) for end in found.first_ends), each)
        values = values_for_lengths(slice_family(found.family, found.second, exact), T)
        formula = np.full(each, np.nan)
        for part in found.parts:
            if part.regime.closed and part.low <= exact <= part.high:
                ends = [float(end.subs(found.second, exact)) for end in (part.regime.lower, part.regime.upper)]
                inside = np.abs(T - sum(ends) / 2) <= (ends[1] - ends[0]) / 2
                value = sp.lambdify(found.family.parameter, part.regime.value.subs(found.second, exact), "numpy")
                formula[inside] = value(T[inside])
        compared += int(np.isfinite(formula).sum())
        wrong += int((np.abs(values - formula) > 1e-8 * formula).sum())
    return compared, wrong


@pytest.mark.slow
@pytest.mark.parametrize("channel", ["drift", "tilt", "acceleration"])
def test_ten_thousand_points_of_three_channels_have_the_optimum_of_one_parameter(channel):
    """3,400 points a channel: 10,200 in all."""
    if channel == "acceleration":
        found = nav.phases(nav.Model(**TRIPLE), parameter=("T", "p"))
    else:
        found = nav.phases(nav.Model(**SCHULER, sigma=["1"]), channel, T=("1/2", "6"), w=("1/2", "2"))
    assert disagreements_on_slices(found, 34, 100, 5) == (3400, 0)


@pytest.mark.long
def test_two_sensors_share_the_rectangle_along_a_curve(triple):
    """Velocities give the acceleration with 2 p/T, positions with 16/T**2: the curve is T = 8/p."""
    values = [str(parts[0].regime.value) for parts in triple.regions]
    assert values == ["2*p/T", "16/T**2"] and triple.uncovered == () and triple.covered == 1.0
    assert [curve.equation for curve in triple.curves] == ["T = 8/p"]
    assert {str(part.regime.status) for part in triple.parts} == {"PROVED"}
    assert str(triple.parts[0].high) == "4/3"  # there the curve leaves the rectangle


def test_the_formulas_are_the_optimum_at_random_points(triple):
    assert disagreements(triple, 20, 1) == 0
    assert disagreements_on_slices(triple, 4, 10, 1) == (40, 0)


def test_the_certified_optimum_of_a_point_encloses_the_formula(triple):
    found = triple.at(T="5", p="19/10")
    assert float(found.value.lower) == pytest.approx(value_at(triple, {"T": 5, "p": Fraction(19, 10)}), rel=1e-12)


def test_a_closed_form_outside_its_region_is_not_proved(triple):
    one, other = (parts[0] for parts in triple.regions)
    wrong = replace(one.regime.closed, verdict=Verdict(OPEN, "none"))
    bare = replace(other, regime=replace(other.regime, closed=None, status=OPEN))
    (left,) = prove_part(bare, wrong, triple.second, Budget.of(20), 0)
    assert left.regime.closed is None
    (held,) = prove_part(bare, other.regime.closed, triple.second, Budget.of(20), 0)
    assert held.regime.closed is not None


def test_a_formula_that_is_too_small_is_not_proved(triple):
    part = triple.parts[0]
    less = replace(part.regime.closed, value=part.regime.closed.value * sp.Rational(99, 100))
    bare = replace(part, regime=replace(part.regime, closed=None, status=OPEN))
    assert prove_part(bare, less, triple.second, Budget.of(20), 0)[0].regime.closed is None


def test_what_is_not_proved_in_time_is_named():
    found = nav.phases(nav.Model(**TRIPLE), T=("1", "6"), p=("1", "2"), seconds=0.5)
    assert found.uncovered and found.given_up and found.covered < 1.0


@pytest.mark.parametrize(
    "target", [pytest.param("drift", marks=pytest.mark.long), pytest.param("tilt", marks=pytest.mark.slow)]
)
def test_the_channel_with_a_free_frequency_follows_the_law_of_scaling(target):
    """In the time w t there is one parameter, w T: the map is that of T with curves c/w."""
    model = nav.Model(**SCHULER, sigma=["1"])
    found = nav.phases(model, target, T=("1/2", "6"), w=("1/2", "2"))
    assert found.uncovered == () and not any((curve.at * found.second).free_symbols for curve in found.curves)
    assert disagreements(found, 100, 2) == 0
    power = {"drift": 2, "tilt": 1}[target]
    for T, w in (("3/2", "6/5"), ("4", "1/2"), ("11/2", "3/4"), ("5/2", "1")):
        scaled = nav.solve(model, target, T=str(Fraction(T) * Fraction(w)), w="1")
        got = value_at(found, {"T": Fraction(T), "w": Fraction(w)})
        assert got == pytest.approx(float(scaled.value.lower) * float(Fraction(w)) ** power, rel=1e-9)


@pytest.mark.long
def test_the_command_line_prints_regions_curves_and_the_share(tmp_path, capsys):
    path = tmp_path / "triple.toml"
    nav.Model(**TRIPLE).save(path)
    status = run(["phases", str(path), "--parameter", "T, p", "--range", "1, 6; 1, 2", "--json"])
    document = json.loads(capsys.readouterr().out)
    assert status == 0 and document["parameters"] == ["T", "p"] and document["covered"] == 1.0
    assert [curve["equation"] for curve in document["curves"]] == ["T = 8/p"]
    assert [region["value"] for region in document["regions"]] == ["2*p/T", "16/T**2"]


@pytest.mark.parametrize(
    ("options", "kind"),
    [
        ({"T": ("1", "6"), "p": ("2", "1")}, "domain"),
        ({"T": ("1", "6"), "p": ("1", "2"), "quick": True}, "domain"),
        ({"T": ("1", "6"), "p": ("1", "2"), "unique": True}, "domain"),
        ({"parameter": ("T", "T")}, "domain"),
        ({"parameter": ()}, "domain"),
        ({"T": ("1", "6"), "p": ("1", "2", "3")}, "syntax"),
        ({"T": ("1", "6"), "q": ("1", "2")}, "domain"),
    ],
)
def test_what_is_no_rectangle_is_an_error_of_one_line(options, kind):
    with pytest.raises(nav.NavsymError) as caught:
        nav.phases(nav.Model(**TRIPLE), **options)
    assert caught.value.kind in (kind, "unknown-symbol") and "\n" not in str(caught.value)


def test_the_picture_and_the_table_of_a_map_show_every_region(triple):
    picture = triple.plot()
    assert len(picture.axes[0].collections) == len(triple.parts)
    assert "T = 8/p" in triple._repr_html_() and "2 regions" in repr(triple)
