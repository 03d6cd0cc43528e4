"""Units and frames: formulas of the book and of the papers agree with them, slips of powers and units do not."""

from __future__ import annotations

import copy
import random
import re

import pytest

import navsym as nav
from navsym.core.errors import DomainError, NavsymError
from navsym.core.units import print_unit, read_unit
from navsym.language.algebra import from_sympy
from navsym.language.dimensions import infer_units
from navsym.language.frames import infer_frames
from navsym.language.shapes import Shape, read_shape
from navsym.language.tree import build
from navsym.language.vectors import read_hypothesis
from navsym.prove.claimfile import claims_from
from tests.derivations.statements import PAPERS
from tests.fidelity.scaling import Scaling, pairs_of
from tests.fidelity.test_units import held, slips
from tests.fidelity.units import units_of

NAMES = re.compile(r"(?<![\w.])[A-Za-z]\w*(?!\w|\s*\()")


def units(relation, **table):
    """The units that are inferred for a relation."""
    shapes = shapes_of(table)
    tree = read_hypothesis(relation, {name: shape.size for name, shape in shapes.items()})
    return infer_units([tree], shapes)


def frames(relation, **table):
    """The frames that are inferred for a relation."""
    shapes = shapes_of(table)
    tree = read_hypothesis(relation, {name: shape.size for name, shape in shapes.items()})
    return infer_frames([tree], shapes)


def shapes_of(table):
    return {name: read_shape(name, value, table, "")[0] for name, value in table.items()}


# -- units as text -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("N", "kg m/s^2"), ("deg/h", "arcsec/s"), ("kn", "nmi/h"), ("1/s", "Hz"), ("m*s^-2", "m/s/s"), ("rad", "1"),
        ("sqrt(m^4)", "m^2"), ("m**(3/2)", "m*sqrt(m)"), ("km/(s*K)", "km/s/K"),
    ],
)  # fmt: skip
def test_two_ways_of_writing_a_unit_are_one(one, other):
    assert read_unit(one) == read_unit(other)


@pytest.mark.parametrize("text", ["m", "1", "1/s", "m/s^2", "kg m^2/s^3", "m/s^(1/2)"])
def test_a_unit_that_is_printed_is_read_as_itself(text):
    assert print_unit(read_unit(text)) == text


@pytest.mark.parametrize(
    "text", ["", "m/", "m//s", "(m", "m)", "^2", "m^x", "furlong", "m" * 200, "sqrt", "((((", "m;s"]
)
def test_a_text_that_is_no_unit_is_refused(text):
    with pytest.raises(NavsymError):
        read_unit(text)


# -- units of formulas ---------------------------------------------------------------------------------

METRE, SECOND, SPEED = {"unit": "m"}, {"unit": "s"}, {"unit": "m/s"}


@pytest.mark.parametrize(
    "wrong",
    [
        "h + T = h", "h = v", "sin(h) = 1", "exp(-T) = 1", "h**T = 1", "h + 1 = h", "atan2(h, T) = 0", "h*T = h*v",
        "max(h, v) = h", "where(h < T, h, h) = h", "sqrt(h) = h", "diff(h*T, T) = h*T", "integral(v, T, 0, h) = h",
        "norm([h, v, 1]) = 0", "floor(h) = 1", "h**(2**2) = h",
        "erf(h/T) = 0", "expm([[1, h], [h, 1]]) = zeros(2, 2)", "cov(h, T) = h**2", "det([[h, v], [v, h]]) = 0",
        "[h, v] = [v, h]", "dot([h, h], [v, T]) = 0", "h*h = h", "h*v*h = h*v",
    ],
)  # fmt: skip
def test_a_meaningless_formula_is_an_error_that_names_both_sides(wrong):
    with pytest.raises(DomainError, match="unit") as error:
        units(wrong, h=METRE, T=SECOND, v=SPEED)
    assert error.value.got and error.value.remedy


@pytest.mark.parametrize(
    "right",
    [
        "h = v*T", "sin(h/(v*T)) = 0", "atan2(h, v*T) = 0", "sqrt(h**2 + (v*T)**2) = abs(h)", 
        "diff(h*T**2, T, 2) = 2*h",
       
        "integral(v, T, 0, h/v) = h", "0 = h", "h + 0 = h", "inv([[h, v], [v*h, v**2]]) @ [h, h*v] = [1, h/v]",
        "a*b = h", "h = a + 2*h", "2**3*h = h", "h**2*T**(-2) = v**2", "cov(h, T) = h*T",
        "expm([[0, T], [0, 0]]) = [[1, T], [0, 1]]", "floor(h/(v*T)) = 0", "E(h**2) = cov(h)",
        "h*h = h**2", "h*[v, h]*h = h**2*[v, h]",
    ],
)  # fmt: skip
def test_a_formula_that_means_something_is_left_alone(right):
    units(right, h=METRE, T=SECOND, v=SPEED, a={}, b={})


def test_units_are_inferred_for_every_name_that_they_settle():
    found = units("h = a*T**2/2 + b*T", h=METRE, T=SECOND, a={}, b={}, c={})
    assert found == {"h": "m", "a": "m/s^2", "T": "s", "b": "m/s"}
    found = units("h = k @ [v, v]", h=METRE, v=SPEED, k={"matrix": [1, 2]})
    assert found["k_1_1"] == found["k_1_2"] == "s"
    assert units("a*b = c", a={}, b={}, c={}) == {}


def test_an_unknown_unit_must_be_one_and_the_same_everywhere():
    with pytest.raises(DomainError, match="one unit"):
        units("[a*T, a] = [h, h]", h=METRE, T=SECOND, a={})


@pytest.mark.parametrize(
    ("relation", "good"),
    [("x = y", False), ("x = 1000*y", True), ("x = y + x", False), ("x*z = y*z", False), 
     ("sin(d) = 0", False), ("sin(pi/180*d) = 0", True)],
)  # fmt: skip
def test_a_scale_must_be_converted(relation, good):
    table = {"x": {"unit": "m"}, "y": {"unit": "km"}, "z": {"unit": "s"}, "d": {"unit": "deg"}}
    if good:
        units(relation, **table)
    else:
        with pytest.raises(DomainError, match="times the base unit"):
            units(relation, **table)


def test_a_rate_is_in_the_unit_by_the_unit_of_time():
    def claim(rate):
        return {
            "symbols": {"v": SPEED | {"function": "t"}, "a": {"unit": "m/s^2"}, "h": METRE, "t": SECOND},
            "rates": {"h": rate},
            "claim": [{"id": "one", "left": "dot_(h)", "right": "v"}],
        }

    claims_from(claim("v"))
    with pytest.raises(DomainError, match="rate of h"):
        claims_from(claim("a"))


def test_prove_refuses_a_meaningless_formula_and_decides_the_others():
    table = {"h": METRE, "T": SECOND, "v": SPEED}
    assert nav.prove("(h/T)**2 = h**2/T**2", **{k: v for k, v in table.items() if k != "v"}, exists="1/T").holds
    with pytest.raises(DomainError, match="h in m and T in s"):
        nav.prove("h + T = T + h", h=METRE, T=SECOND)


def test_a_printed_number_stands_for_a_quantity():
    symbols = {"h": {"range": ["1", "2"], "unit": "m"}}
    claims_from({"symbols": symbols, "claim": [{"id": "a", "left": "h", "right": "1.5", "tolerance": "0.5"}]})
    claims_from({"symbols": symbols, "claim": [{"id": "a", "left": "h", "right": "1", "relation": ">="}]})


# -- frames --------------------------------------------------------------------------------------------

N, B, C = {"vector": 3, "frame": "n"}, {"vector": 3, "frame": "b"}, {"rotation": "b to n"}


@pytest.mark.parametrize(
    "wrong",
    [
        "v + f = f", "v = f", "v = C.T @ f", "f = C @ v", "cross(v, f) = v", "dot(v, f) = 0", "v = C @ C @ f",
        "v = C @ skew(v) @ f", "v @ f.T = skew(v)", "C @ skew(f) @ C.T = skew(f)", "where(0 < 1, v, f) = v",
    ],
)  # fmt: skip
def test_vectors_of_two_frames_are_an_error_that_names_both(wrong):
    with pytest.raises(DomainError, match="frame") as error:
        frames(wrong, v=N, f=B, C=C)
    assert " and " in error.value.got


@pytest.mark.parametrize(
    "right",
    [
        "v = C @ f", "f = C.T @ v", "C @ skew(f) @ C.T = skew(C @ f)", "dot(v, C @ f) = 0", "v = inv(C.T) @ f",
        "cross(v, C @ f) = zeros(3, 1)", "v = 2*v - C @ f*norm(f)", "v[1] = f[1]", "v = [f[1], f[2], f[3]]",
        "C.T @ C = eye(3)",
    ],
)  # fmt: skip
def test_vectors_that_are_turned_are_left_alone(right):
    frames(right, v=N, f=B, C=C)


@pytest.mark.parametrize("wrong", ["C @ D = K", "D.T @ C.T = K", "C = D", "C + D = C", "C = D @ D"])
def test_rotations_in_an_order_that_joins_two_frames_are_an_error(wrong):
    turned = {"C": C, "D": {"rotation": "n to e"}, "K": {"rotation": "b to e"}}
    frames("D @ C = K", **turned)
    frames("C.T @ D.T = K.T", **turned)
    with pytest.raises(DomainError, match="frame") as error:
        frames(wrong, **turned)
    assert " and " in error.value.got


def test_frames_are_inferred_through_rotations():
    found = frames("w = C @ f + cross(g, w)", w={"vector": 3}, f=B, C=C, g={"vector": 3})
    assert found == {"w": "n", "C": "b to n", "f": "b", "g": "n"}
    assert frames("w = A @ f", w=N, f=B, A={"matrix": [3, 3]})["A"] == "b to n"
    assert frames("u = C @ w", u={"vector": 3}, w={"vector": 3}, C=C) == {}


# -- the book and the papers ---------------------------------------------------------------------------


def settled(entry):
    """Names of a book entry with their units, where every name of it has one that is known."""
    (claim,) = claims_from(dict(entry.document)).claims
    block, symbols = entry.document["claim"][0], entry.document["symbols"]
    shapes = {name: read_shape(name, value, symbols, "")[0] for name, value in symbols.items()}
    if block.get("relation", "=") != "=" or "chain" in block or entry.document.get("rates"):
        return {}
    sizes = {name: shape.size for name, shape in shapes.items()}
    found = infer_units([read_hypothesis(f"{block['left']} = {block['right']}", sizes)], shapes)
    names = set(NAMES.findall(f"{block['left']} {block['right']}")) & set(shapes)
    entries = {name: [e for row in shapes[name].rows for e in row] for name in names}
    if not all(es and all(e in found for e in es) for es in entries.values()):
        return {}
    return {name: found[es[0]] for name, es in entries.items() if found[es[0]] != "1"}


def list_mutants(entry, rng):
    """Claim files with one power of a symbol changed, or one declared unit."""
    known = settled(entry)
    block = entry.document["claim"][0]
    if not known or re.fullmatch(r"0|zeros\(.*\)", block["right"]) or "diff(" in block["left"] + block["right"]:
        return
    for side in ("left", "right"):
        for place in (m for m in NAMES.finditer(block[side]) if m[0] in known):
            document = copy.deepcopy(dict(entry.document))
            factor = rng.choice(["unitmetre", "unitsecond", "1/unitmetre"])
            document["symbols"] |= {
                "unitmetre": METRE | {"sign": "positive"},
                "unitsecond": SECOND | {"sign": "positive"},
            }
            text = block[side]
            document["claim"][0][side] = f"{text[: place.start()]}({place[0]}*({factor})){text[place.end() :]}"
            yield document


@pytest.mark.long
def test_slips_of_powers_and_units_in_the_book_are_noticed():
    rng = random.Random(22)
    mutants = [m for entry in nav.book.values() for m in list_mutants(entry, rng)]
    rng.shuffle(mutants)
    mutants = mutants[:500]
    noticed = 0
    for document in mutants:
        try:
            claims_from(document)
        except DomainError:
            noticed += 1
    assert len(mutants) == 500 and noticed >= 0.95 * len(mutants), (noticed, len(mutants))


def denied(pairs, table):
    """Whether units deny some pairs of sympy expressions; None for one that no tree can hold."""
    bases = ("m", "s", "kg")
    try:
        trees = [build("=", (from_sympy(left), from_sympy(right))) for left, right in pairs]
    except NavsymError:
        return None
    shapes = {
        name: Shape(name, ((name,),), "scalar", {}, unit=" ".join(f"{b}^{n}" for b, n in zip(bases, unit, strict=True)))
        for name, unit in table.items()
    }
    try:
        infer_units(trees, shapes)
    except DomainError:
        return True
    return False


@pytest.mark.long
@pytest.mark.parametrize("paper", PAPERS)
def test_formulas_of_the_papers_agree_with_their_units_and_slips_are_judged_as_by_scaling(paper):
    read = 0
    for claim, statement, table in held(paper):
        if table and not (verdict := denied(pairs_of(statement), table)):
            assert verdict is not True, claim.id
            read += verdict is False
    assert read or paper in ("joint_correction", "guaranteed_velocity")
    for derived, mutant in slips(paper, 40):
        names = {s.name for s in (derived - mutant).free_symbols}
        table = units_of(paper, names)
        if any(map(any, table.values())) and (verdict := denied([(mutant, derived)], table)) is not None:
            assert verdict == (Scaling([(mutant, derived)]).denied(table) is not None), (derived, mutant)
