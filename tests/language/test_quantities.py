"""Units against pint, an independent table of them, and its quantities at the front door."""

from __future__ import annotations

import math
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st

import navsym as nav
from navsym.core.arrays import without_units
from navsym.core.units import BASES, NAMES, PREFIXES, TABLE, combine, print_unit, read_unit
from navsym.language.values import read_constant, write_value

pint = pytest.importorskip("pint", reason="pint is not installed: pip install 'navsym[units]'")

REGISTRY = pint.UnitRegistry()
EXACT = pint.UnitRegistry(non_int_type=Fraction)
Q = REGISTRY.Quantity
#: Where pint means another unit by the same letters, or has none: its own words for ours.
OTHER = {
    "1": "dimensionless", "g": "standard_gravity", "mg": "0.001 standard_gravity", "ug": "1e-6 standard_gravity",
    "E": "1e-9/s^2", "kn": "knot", "gon": "grade", "rev": "turn", "cycle": "turn", "h": "hour", "G": "1e-4 tesla",
    "%": "percent", "Gal": "0.01 m/s^2", "mGal": "1e-5 m/s^2",
}  # fmt: skip
FACTORS = st.tuples(st.sampled_from([*BASES, *TABLE]), st.sampled_from([-3, -2, -1, 1, 2, 3, Fraction(1, 2)]))
PINTS = st.tuples(st.sampled_from([*PREFIXES]), st.sampled_from([*NAMES]), st.sampled_from([-2, -1, 1, 2, 0.5]))


def dimensions(powers):
    """The dimensions of a unit as pint has them."""
    names = dict(zip(BASES, "length time mass current temperature substance luminosity".split(), strict=True))
    return {f"[{names[key]}]": float(n) for key, n in powers.items() if key in BASES}


def factor(powers):
    """The size of a unit in SI as a double."""
    return math.prod((math.pi if k == "pi" else k) ** float(n) for k, n in powers.items() if k not in BASES)


def in_si(quantity):
    """Magnitude and dimensions of a quantity by pint alone."""
    base = quantity.to_base_units()
    found = {name: float(n) for name, n in dict(base.dimensionality).items()}
    return float(base.magnitude), found


@given(st.lists(FACTORS, min_size=1, max_size=4))
def test_products_of_powers_of_our_units_are_those_of_pint(factors):
    powers = combine((read_unit(name), Fraction(n)) for name, n in factors)
    quantity = math.prod((Q(OTHER.get(name, name)) ** float(n) for name, n in factors), start=Q(1.0, ""))
    size, found = in_si(quantity)
    assert found == pytest.approx(dimensions(powers)) and size == pytest.approx(factor(powers), rel=1e-13)


@pytest.mark.parametrize("name", [name for name in (*BASES, *TABLE) if "pi" not in read_unit(name)])
def test_every_unit_without_pi_is_exactly_that_of_pint(name):
    base = EXACT.Quantity(Fraction(1), "") * EXACT(OTHER.get(name, name))
    ours = math.prod((Fraction(k) ** int(n) for k, n in read_unit(name).items() if k not in BASES), start=Fraction(1))
    assert Fraction(base.to_base_units().magnitude) == ours


@given(st.lists(PINTS, min_size=1, max_size=3), st.fractions(-1000, 1000, max_denominator=1000))
def test_a_quantity_of_pint_is_in_si_what_pint_says(parts, number):
    words = [(f"{prefix}{name}", n) for prefix, name, n in parts if f"{prefix}{name}" in REGISTRY]
    assume(words and len({name for name, _ in words}) == len(words))
    unit = math.prod((REGISTRY.Unit(name) ** n for name, n in words), start=REGISTRY.Unit(""))
    size, _ = in_si(Q(float(number), unit))
    assert float(read_constant(Q(number, unit), "")) == pytest.approx(size, rel=1e-13)
    assert without_units(Q(float(number), unit), "") == pytest.approx(size, rel=1e-13)


def test_a_printed_unit_keeps_its_scale_under_a_root():
    assert print_unit(read_unit("sqrt(km)")) == "2^(3/2) 5^(3/2) m^(1/2)"
    assert print_unit(read_unit("sqrt(deg)")) == "pi^(1/2)/6 1/5^(1/2)"


def test_a_degree_per_hour_is_exact():
    assert read_constant(Q(1, "deg/h"), "") == sp.pi / 648000
    assert write_value(Q(Fraction(1, 3), "km"), "") == "1000/3"
    assert write_value(Q(Decimal("0.05"), "deg/hour**0.5"), "") == "1/216000*pi"
    assert read_constant("3 deg/h", "") == read_constant(Q(3, "deg/h"), "") == read_constant("3 degree/hour", "")
    assert read_constant(Q(1, "km**0.5"), "") == sp.sqrt(1000)
    assert read_constant(Q(sp.sqrt(2), "km"), "") == 1000 * sp.sqrt(2)


@pytest.mark.parametrize(
    ("value", "unit", "said"),
    [
        (Q(1, "m"), "s", "expected a quantity in s; got one in meter"),
        ("1 m", "deg/h", "expected a quantity in deg/h; got one in m"),
        (Q(0.1, "deg/h"), "", 'the float 0.1 of degree hour^(-1); write Fraction("1/10") in its place'),
        (Q(20, "degC"), "", "got 'degree_Celsius'"),
        (Q(20, "lightyear"), "m", "got 'light_year'"),
        ("1e2/3 m", "", "expected"),
        ("1.2E", "", "expected"),  # a number that was cut, no Eotvos
        (Q(1, "gauss"), "T", "got 'gauss'"),  # a unit of another system, which pint does not convert either
        ("3 furlongs", "", "got 'furlongs'"),
        ("2 pi", "", "write a product with *"),
        (Q(1, "m**1000"), "", "got"),
        (Q(Decimal("1e100000000"), "m"), "", "expected"),
        (Q(math.nan, "m"), "", "nan"),
    ],
)
def test_a_wrong_quantity_is_an_error_that_says_what_was_expected(value, unit, said):
    with pytest.raises(nav.NavsymError) as error:
        read_constant(value, "here", unit)
    assert said in str(error.value)


def test_a_quantity_is_in_the_unit_that_a_model_declares():
    w, T = {"unit": "deg/h"}, {"unit": "min", "range": ["0", "200"]}  # k turns (deg/h)**2 into 1/min**2
    model = nav.Model(
        "x v", F=[["0", "1"], ["-k*w**2", "0"]], H=["x"], interval="T", targets={"s": "w*v"}, w=w, T=T, k="real"
    )
    for rate in (Q(15, "deg/h"), "15 deg/h", "15", 15, Q(Fraction(1, 4), "arcmin/s")):
        assert model.read({"w": rate, "k": 1}).F[1, 0] == -225
    assert model.read({"w": Q(1, "rad/s"), "k": 1}).F[1, 0] == -(sp.Integer(648000) ** 2) / sp.pi**2
    part = model.with_values(w=15, k=1)  # what is left of the declarations keeps their units
    assert part.read({"T": Q(1, "hour")}).T == nav.Model.from_document(part.document()).read({"T": "1 h"}).T == 60
    for wrong in ({"w": Q(1, "m")}, {"T": "1 deg"}, {"T": Q(5, "hour")}, {"T": "5 h"}):
        with pytest.raises(nav.NavsymError, match=r"expected a (quantity in|value in the declared)"):
            model.read(wrong)
    phases = nav.phases(model, "s", w=1, k=1, T=(Q(6, "s"), Q(60, "s")), seconds=2)
    assert phases.regimes[0].ends == ("1/10", "1")


def test_the_length_of_a_flight_is_in_the_unit_of_the_interval():
    model = nav.Model("x v", F=[["0", "1"], ["0", "0"]], H=["x"], interval="T", T={"unit": "min", "sign": "positive"})
    found = [nav.observe(model).accuracy(T=T).document() for T in (2, "2 min", Q(120, "s"))]
    assert found[0] == found[1] == found[2]


def test_an_entry_of_a_declared_vector_has_its_unit():
    rows = [["0", "f[3]", "-f[2]"], ["-f[3]", "0", "f[1]"], ["f[2]", "-f[1]", "0"]]
    entries = "[" + ", ".join("[" + ", ".join(row) + "]" for row in rows) + "]"
    f = {"vector": 3, "unit": "mg"}
    model = nav.Model("v[3]", F=[[entries]], H=["eye(3)"], interval=1, f=f)
    assert model.read({"f_1": Q(1, "standard_gravity")}).F[1, 2] == 1000


def test_ranges_of_a_claim_are_in_its_units():
    km = {"unit": "km"}
    assert nav.prove("h <= 9", h={**km, "range": (Q(0, "m"), Q(9000, "m"))}).scope == "all h in [0, 9]"
    assert nav.prove("h <= 9", h={**km, "range": ["0", "9000 m"]}).holds
    assert nav.prove("h <= 9", h=km, box={"h": (Q(0, "m"), Q(9000, "m"))}).holds
    assert nav.prove("h <= 9000", box={"h": ("0", "9 km")}).holds
    assert nav.prove("h <= 9000", h=(Q(0, "m"), Q(9, "km"))).holds
    assert nav.prove("1000*h >= 0", h={**km, "range": ("0 m", "oo")}).holds
    assert nav.prove(Q(1, "deg/h"), "=", "pi/648000").holds
    with pytest.raises(nav.NavsymError, match="expected a quantity in km; got one in second"):
        nav.prove("h <= 9", h={**km, "range": (Q(0, "s"), Q(9, "s"))})


def test_a_letter_behind_a_number_is_no_unit_in_a_formula():
    for text in ("y = 2 T", "y = 2 m", "2 m = 2"):
        with pytest.raises(nav.NavsymError, match="expected an operator or the end"):
            nav.prove(text)


def test_numbers_of_a_guard_are_exact_and_in_si():
    model = nav.Model("x v", F=[["0", "1"], ["0", "0"]], H=["x"], sigma=Q(100, "cm"), targets={"speed": "v"})
    bare, united, written = (nav.Guard(model, "speed", step=step) for step in (60, Q(1, "min"), "1 min"))
    for z in (0.1, 1.2, 1.9, 3.1):
        answers = bare.step(z), united.step([Q(z, "m")], sigma=Q(1, "m")), written.step(f"{z} m")
        assert answers[0].value == answers[1].value == answers[2].value
    turn = nav.Guard(nav.Model("a", F=[["0"]], H=["a"], sigma=1))
    assert turn.step(Q(0.5, "deg"), t=Q(1, "s")).value == math.radians(0.5)
    with pytest.raises(nav.NavsymError, match="expected a rational number"):
        turn.step(Q(1, "deg"), t=2)


def test_arrays_of_quantities_are_in_the_units_of_their_places():
    row, rows = Q(np.array([1.0, 2.0]), "km"), [Q(1, "km"), Q(2000, "m")]
    for value in (row, rows, [1000, 2000]):
        assert nav.core.arrays.as_array("x", value, (2,), "two").tolist() == [1000, 2000]
    assert str(nav.limits(Q(500, "cm"), acceleration=Q(0.5, "m/s**2"), step=Q(1000, "ms"))) == str(
        nav.limits(5, acceleration=0.5, step=1)
    )
    with pytest.raises(nav.NavsymError, match="limits: noise: expected a quantity in m; got one in second"):
        nav.limits(Q(5, "s"), acceleration=0.5)
    assert (
        nav.condition(n=4, tau=Q(200, "ms"), rho=Q(Fraction(1, 6371), "1/km")).document()
        == nav.condition(n=4, tau="0.2", rho="1/6371000").document()
    )


def test_a_search_and_a_track_take_quantities():
    heights = np.add.outer(np.arange(8.0) ** 2, 3 * np.arange(8.0)).tolist()
    t, x = [0.0, 1.0, 2.0], [2.0, 3.0, 4.0]
    table = {
        "map": {"heights": heights, "x0": 0, "y0": 0, "dx": 1, "dy": 1},
        "position": {"step": [1, 1], "half_count": [1, 1]},
    }
    track = {"t": t, "x": x, "y": x, "h": [10.0, 18.0, 28.0]}
    united = {
        "t": Q(t, "s"),
        "x": Q(np.array(x) / 1000, "km"),
        "y": [Q(100 * v, "cm") for v in x],
        "h": Q(track["h"], "m"),
    }
    answers = [nav.locate({**table, "track": own}, method="position").document() for own in (track, united)]
    assert answers[0] == answers[1]
    with pytest.raises(nav.NavsymError, match="expected a quantity in m; got one in degree"):
        nav.locate({**table, "track": {**track, "x": Q(x, "deg")}}, method="position")
    t = np.arange(30.0)
    data = {"t": t, "lat": 50 + 1e-4 * t, "lon": 30 + 1e-4 * t, "height": 100 + 0 * t}
    united = {
        "t": Q(t / 60, "min"),
        "lat": Q(np.radians(data["lat"]), "rad"),
        "lon": data["lon"],
        "height": Q(data["height"], "m"),
    }
    assert np.allclose(nav.track(united).velocity, nav.track(data).velocity, atol=1e-6)


def test_navsym_loads_no_pint_of_its_own():
    code = (
        "import sys, navsym as nav; nav.prove('x = x'); nav.limits(5, acceleration=0.5); print('pint' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_a_number_goes_out_as_a_quantity():
    number = nav.Number("0.99999999", "1.00000001")
    for unit in ("deg/h", "mg", "m/s/sqrt(h)", "ft", "1"):
        back = without_units(number.quantity(unit, REGISTRY), "", unit)
        assert back == pytest.approx(1, rel=1e-15)
    assert number.quantity("km").check("[length]")
    with pytest.raises(nav.NavsymError, match="got 'furlong'"):
        number.quantity("furlong")
