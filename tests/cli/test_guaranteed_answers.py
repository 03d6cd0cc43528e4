"""150 problems with answers known from elsewhere, solved from the command line: Chebyshev, Elfving, scaling laws."""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache

import mpmath
import pytest
import sympy as sp

from navsym.cli.main import run

s = sp.Symbol("s")


def toml(rows, interval, target, sigma=None):
    several = isinstance(rows[0], list)
    ends = json.dumps(list(map(str, interval)))
    lines = ["[basis]", 'variable = "s"', f"H = {json.dumps(rows)}", f"interval = {ends}"]
    if sigma is not None:
        lines.append(f"sigma = {json.dumps(list(map(str, sigma)))}")
    assert several == (sigma is not None)
    return "\n".join([*lines, "[targets]", f"c = {json.dumps(list(map(str, target)))}", ""])


@pytest.fixture
def answer(tmp_path, capsys):
    def solved(rows, interval, target, sigma=None, *options):
        path = tmp_path / "problem.toml"
        path.write_text(toml(rows, interval, target, sigma))
        status = run(["solve", str(path), "--json", *options])
        return status, json.loads(capsys.readouterr().out)

    return solved


def needs(found, value, digits=28):
    """Certified, and the value known from elsewhere lies in the enclosure."""
    status, data = found
    assert status == 0 and data["status"] == "CERTIFIED", data
    with mpmath.workdps(60):
        low, high = (mpmath.mpf(data["value"][end]) for end in ("lower", "upper"))
        exact = mpmath.mpf(str(sp.N(value, 55)))
        assert low <= exact * (1 + mpmath.mpf(10) ** -50) and exact * (1 - mpmath.mpf(10) ** -50) <= high
        assert (high - low) <= high * mpmath.mpf(10) ** -digits
    return data


def powers(m):
    return ["1", "s", *(f"s**{k}" for k in range(2, m))][:m]


def unit(m, k, scale=1):
    return [scale if j == k else 0 for j in range(m)]


@cache
def chebyshev(n, shifted):
    return sp.Poly(sp.chebyshevt(n, 2 * s - 1 if shifted else s), s)


@pytest.mark.parametrize(
    ("m", "k"),
    [
        *((m, k) for m in range(2, 9) for k in range(1, m)),
        *(pytest.param(9, k, marks=[pytest.mark.long] if k < 8 else []) for k in range(1, 9)),
    ],
)
def test_coefficients_on_the_unit_interval_are_those_of_shifted_chebyshev_polynomials(answer, m, k):
    value = abs(chebyshev(m - 1, True).coeff_monomial(s**k))
    needs(answer(powers(m), (0, 1), unit(m, k)), value)


@pytest.mark.parametrize(("m", "k"), [(m, k) for m in range(2, 9) for k in range(1, m)])
def test_coefficients_on_a_symmetric_interval_are_those_of_the_polynomial_of_their_parity(answer, m, k):
    degree = m - 1 if (m - 1 - k) % 2 == 0 else m - 2
    value = abs(chebyshev(degree, False).coeff_monomial(s**k))
    needs(answer(powers(m), (-1, 1), unit(m, k)), value, 9 if (m - 1 - k) % 2 else 28)


@pytest.mark.parametrize("point", ["3/2", "2", "-1", "5", "101/100", "-1/7", "10"])
@pytest.mark.parametrize("m", [2, 3, 5])
def test_extrapolation_costs_the_chebyshev_polynomial_there(answer, m, point):
    at = sp.Rational(point)
    value = abs(chebyshev(m - 1, True).eval(at))
    needs(answer(powers(m), (0, 1), [at**k for k in range(m)]), value)


@pytest.mark.parametrize("point", ["0", "1/3", "1/2", "1"])
def test_the_value_at_a_measured_instant_costs_its_noise(answer, point):
    at = sp.Rational(point)
    status, data = answer(powers(4), (0, 1), [at**k for k in range(4)])
    assert status == 0 and float(data["value"]["lower"]) == pytest.approx(1.0, abs=1e-9)
    assert Fraction(data["value"]["lower"]) <= 1 <= Fraction(data["value"]["upper"])


@pytest.mark.parametrize("length", ["1/1000", "1/10", "3", "100", "10000"])
@pytest.mark.parametrize("k", [1, 3])
def test_a_longer_interval_scales_every_coefficient(answer, length, k):
    T = sp.Rational(length)
    needs(answer(powers(5), (0, length), unit(5, k)), abs(chebyshev(4, True).coeff_monomial(s**k)) / T**k)


@pytest.mark.parametrize("factor", ["2", "1/3", "1000000007", "1/1000000000"])
def test_scaling_laws_of_the_functional_and_of_the_noise(answer, factor):
    c = sp.Rational(factor)
    rows = ["1", "s", "sin(s)", "cos(2*s)"]
    plain = answer(rows, (0, 2), unit(4, 2))[1]["value"]
    middle = (sp.Rational(plain["lower"]) + sp.Rational(plain["upper"])) / 2
    for found in (answer(rows, (0, 2), unit(4, 2, c)), answer([rows], (0, 2), unit(4, 2), [c])):
        low, high = (sp.Rational(found[1]["value"][end]) for end in ("lower", "upper"))
        assert low <= c * middle * (1 + sp.Rational(1, 10**29)) and c * middle * (1 - sp.Rational(1, 10**29)) <= high


@pytest.mark.parametrize("shift", ["1", "-3", "pi", "1000"])
def test_a_shift_of_time_changes_nothing(answer, shift):
    rows = ["1", f"(s-({shift}))", f"(s-({shift}))**2"]
    needs(answer(rows, (shift, f"{shift}+1"), [0, 0, 1]), sp.Integer(8))


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
def test_a_harmonic_over_full_periods_costs_one(answer, n):
    rows = ["1", "sin(s)", "cos(s)", f"sin({n + 1}*s)", f"cos({n + 1}*s)"]
    status, data = answer(rows, (0, "2*pi"), [0, 0, 0, 1, 0])
    assert status == 0
    assert Fraction(data["value"]["lower"]) <= 1 <= Fraction(data["value"]["upper"])
    assert float(data["value"]["lower"]) == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize("ratio", ["1/10", "1", "3", "100"])
def test_the_better_of_two_like_measurements_is_used(answer, ratio):
    rows = ["1", "s", "s**2"]
    value = 8 * min(sp.Rational(ratio), 1)
    status, data = answer([rows, rows], (0, 1), [0, 0, 1], [1, ratio])
    assert status == 0
    assert float(data["value"]["lower"]) == pytest.approx(float(value), rel=1e-9)


@pytest.mark.parametrize("sigma", ["1/100", "1/2", "1", "100"])
def test_velocity_beside_position_bounds_the_slope(answer, sigma):
    """Slope of a line: positions at both ends cost 2, a measured velocity its noise."""
    status, data = answer([["1", "s"], ["0", "1"]], (0, 1), [0, 1], [1, sigma])
    value = min(2, sp.Rational(sigma))
    assert status == 0 and float(data["value"]["lower"]) == pytest.approx(float(value), rel=1e-9)


@pytest.mark.parametrize("rate", ["1/10", "1", "5"])
def test_two_exponentials_alternate_at_the_ends(answer, rate):
    a = sp.Rational(rate)
    value = (1 + 1) / (1 - sp.exp(-a))
    needs(answer(["1", f"exp(-{rate}*s)"], (0, 1), [0, 1]), value)


@pytest.mark.parametrize("frequency", ["1", "7", "40"])
def test_three_functions_of_a_turn_have_an_explicit_alternance(answer, frequency):
    """The constant beside a turn over a quarter: f = c + a cos(w s - pi/4) is -1, 1, -1 at both ends and the middle."""
    rows = ["1", f"sin({frequency}*s)", f"cos({frequency}*s)"]
    h = sp.cos(sp.pi / 4)
    needs(answer(rows, (0, f"pi/(2*{frequency})"), [1, 0, 0]), (1 + h) / (1 - h))


@pytest.mark.parametrize("digits", ["5", "15", "50", "100", "200"])
def test_any_number_of_digits(answer, digits):
    needs(answer(powers(5), (0, 1), unit(5, 2), None, "--digits", digits), sp.Integer(160), int(digits))


@pytest.mark.parametrize("m", [12, 16, 20])
def test_many_monomials(answer, m):
    value = abs(chebyshev(m - 1, True).coeff_monomial(s ** (m - 1)))
    needs(answer(powers(m), (0, 1), unit(m, m - 1)), value)


@pytest.mark.parametrize("small", ["1/1000000000", "1/1000000000000"])
def test_a_nearly_unobservable_functional_is_solved(answer, small):
    found = answer(["1", "s", f"({small})*s**2"], (0, 1), [0, 0, 1])
    needs(found, 8 / sp.Rational(small))


@pytest.mark.parametrize(
    ("rows", "interval", "target", "sigma", "kind"),
    [
        (["1", "s"], (0, 0), [0, 1], None, "domain"),
        (["1", "s"], (1, 0), [0, 1], None, "domain"),
        (["0", "0"], (0, 1), [0, 1], None, "not-estimable"),
        (["0", "s"], (0, 1), [1, 0], None, "not-estimable"),
        (["1", "s", "2*s+1"], (0, 1), [0, 0, 1], None, "not-estimable"),
        ([["1", "s"]], (0, 1), [0, 1], [0], "domain"),
        ([["1", "s"]], (0, 1), [0, 1], [-1], "domain"),
        (["1", "s"], (0, "nan"), [0, 1], None, "unknown-symbol"),
        (["1", "1/s"], (0, 1), [0, 1], None, None),
        (["1", "log(s)"], (0, 1), [0, 1], None, None),
        (["1", "1/(s-1/2)"], (0, 1), [0, 1], None, None),
        (["1", "s"], ("pi", 3), [0, 1], None, "domain"),
        (["1", "s"], (0, 1), [0, 0], None, "domain"),
        (["1", "sqrt(s-1)"], (0, 1), [0, 1], None, "not-finite"),
    ],
)
def test_bad_problems_are_named(answer, rows, interval, target, sigma, kind):
    status, data = answer(rows, interval, target, sigma)
    assert status == 2 and set(data) == {"error"}, data
    assert kind is None or data["error"]["kind"] == kind
