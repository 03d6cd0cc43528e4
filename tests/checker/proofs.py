"""Statements with proofs by every rule: true ones, hostile ones that lack a hypothesis, and points that refute.

A row of TRUE and HOSTILE is (rule, statement, witness, proof), and a hostile one ends with the reason of its refusal.
:func:`discrepancies` runs all of it against any module with the checker's names: the checker itself, a mutant of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

LINE, UNIT, BOTH, TWO, BELOW = [None, None, []], ["0", "1", []], ["-1", "1", []], ["1", "2", []], ["-2", "-1", []]
LONG, OPEN, BAR, HOLED = ["-2", "1", []], ["0", "1", ["open-low"]], ["-1", "1", ["open-low", "open-high"]], "nonzero"
NONZERO, HOLE, UP = [None, None, [HOLED]], ["-1", "1", [HOLED]], ["0", None, []]


# Statements and proofs, briefly
def state(left: str, relation: str, right: str = "0", exists=(), tolerance=None, **symbols: Any) -> dict[str, Any]:
    entries = {"left": left, "relation": relation, "right": right, "symbols": symbols}
    return entries | {"exists": list(exists), "tolerance": tolerance}


def prove(statement: Any, witness: dict[str, str], *proofs: Any) -> dict[str, Any]:
    return {"kind": "proof", "statement": statement, "bits": 128, "witness": witness, "proofs": list(proofs)}


def refute(statement: Any, point: dict[str, str], zero: Any = None) -> dict[str, Any]:
    return {"kind": "counterexample", "statement": statement, "bits": 128, "point": point, "zero": zero}


def by(rule: str, proof: Any = ..., **data: Any) -> dict[str, Any]:
    return {"rule": rule} | data | ({} if proof is ... else {"proof": proof})


I, B = by("identity"), by("balls", bits=60, cells=20)
X0, X1, XB, XY = {"x": "0"}, {"x": "1"}, {"x": "-1"}, {"x": "1", "y": "1"}


def stated(left, relation, right, *names, given=(), rates=None, exists=(), tolerance=None, **symbols):
    """A statement of the whole language: u, v, w are vectors of three, q one of four, A, B matrices of two rows."""
    sizes = {**dict.fromkeys("uvw", (3, 1)), "q": (4, 1), **dict.fromkeys("AB", (2, 2)), "G": (2, 3)}
    shapes = {
        name: [[f"{name}_{i}_{j}" for j in range(sizes[name][1])] for i in range(sizes[name][0])] for name in names
    }
    ranges = {entry: LINE for rows in shapes.values() for row in rows for entry in row} | symbols
    whole = state(left, relation, right, exists, tolerance, **ranges)
    return whole | {"shapes": shapes, "given": list(given), "rates": rates or {}}


def modulo(to, proof, *cofactors, defined=()):
    return by("modulo", proof, to=to, cofactors=list(cofactors), defined=list(defined))


def between(*proofs):
    return by("between", proofs=list(proofs))


def equal(to, proof, *defined):
    return by("equal", proof, to=to, defined=list(defined))


def rewrite(old, new, same, proof, *defined):
    return by("rewrite", proof, **{"from": old, "to": new}, defined=list(defined), equal=same)


def multiply(factor, positive, proof=I, *defined):
    return by("multiply", proof, by=factor, defined=list(defined), positive=positive)


def cases(of, *proofs):
    return by("cases", of=of, proofs=list(proofs))


def split(at, *proofs):
    return by("split", symbol="x", at=at, proofs=list(proofs))


def integers(first, *proofs):
    return by("integers", symbol="x", **{"from": first}, proofs=list(proofs))


def abstract(terms, ranges, to, inside, proof, *defined):
    return by("abstract", proof, terms=terms, ranges=ranges, to=to, inside=inside, defined=list(defined))


def dense(besides, point, proof, *defined):
    return by("dense", proof, **{"except": besides}, point=point, defined=list(defined))


def solve(atom, value, *proofs, share="1", defined=()):
    return by("solve", share=share, atom=atom, value=value, defined=list(defined), proofs=list(proofs))


def squares(left, right, sign, *proofs, defined=()):
    return by("squares", left=left, right=right, sign=sign, defined=list(defined), proofs=list(proofs))


def derivative(point, value, slopes, *defined):
    return by("derivative", point=point, value=value, slopes=slopes, defined=list(defined))


def given(*weights):
    return by("given", weights=list(weights))


def empty(place, proof):
    return by("empty", proof, hypothesis=place)


def span(end, share="1", symbol="x"):
    return by("range", symbol=symbol, end=end, share=share)


def angle(turn, *proofs, share="1"):
    return by("angle", turn=turn, share=share, proofs=list(proofs))


def corners(symbols, *proofs):
    return by("corners", symbols=list(symbols), proofs=list(proofs))


def factors(*entries):
    return by("product", factors=list(entries))


def add(*proofs, strict=0):
    return by("sum", proofs=list(proofs), strict=strict)


def slope(end, rise, floor, strict=0, continuous=(), smooth=()):
    data = {"continuous": list(continuous), "smooth": list(smooth), "slope": rise, "floor": floor}
    return by("slope", symbol="x", end=end, strict=strict, **data)


def concave(curve, *floors, continuous=(), smooth=()):
    data = {"continuous": list(continuous), "smooth": list(smooth), "curve": curve, "floors": list(floors)}
    return by("concave", symbol="x", **data)


def cones(*splits):
    return by("cones", splits=list(splits))


def quadratic(coefficients, *proofs, defined=()):
    return by(
        "quadratic", symbol="x", coefficients=coefficients.split(", "), defined=list(defined), proofs=list(proofs)
    )


def roots(low, high):
    return by("roots", **{"from": low, "to": high})


def signs(text, *entries):
    """A term that is a product, by its factors."""
    return equal(text, factors(*entries))


def turned(text, *arguments, **share):
    return equal(text, angle(*arguments, **share))


def bounded(premise):
    return by("bounded", premise)


SQUARE = state("x**2", ">=", x=LINE)
QUARTER = solve("atan(1)", "pi/4", I, B, B, share="2")
HALVES = [0, 1, None, None]
NOWHERE = "0*log(-1)"  # has no value
VANISHING = "(sin(x)**2 + cos(x)**2 - 1)"

# fmt: off
TRUE = [
    ("identity", state("sin(x)**2 + cos(x)**2", "=", "1", x=LINE), X0, I),
    ("identity", state("x - x", ">=", x=LINE), X0, I),
    ("zero", state("(x + 1)**2 - x**2", ">=", "2*x + 1", x=LINE), X0, by("zero", derivative(X0, I, [I]))),
    ("equal", state("x**2 + 1", ">", x=TWO), X1, equal("1 + x*x", B)),
    ("equal", state("x", ">", x=OPEN), X1, equal("x*x*x**(-1)", factors(*[[1, span(0)]] * 3), by("side", span(0),
     sign=1))),
    ("rewrite", state("x**2", ">=", x=BELOW), XB, rewrite("2", "1 + 1", I, B)),
    ("rewrite", state("1 + sqrt((x + 1)**2)", ">", x=UNIT), X0, rewrite("sqrt((x + 1)**2)", "x + 1",
     solve("sqrt((x + 1)**2)", "x + 1", I, B), B)),
    ("multiply", state("x**2 + 1", ">", x=TWO), X1, multiply("2", B, B)),
    ("multiply", state("(x - 1)/x", ">=", x=TWO), X1, multiply("x", B, equal("x - 1", span(0)))),
    ("exponential", state("x**2 + 1", ">", x=TWO), X1, by("exponential", B)),
    ("exponential", state("x", "=", "log(exp(x))", x=LINE), X0, by("exponential", I)),
    ("side", state("x**2 + 1", "!=", x=TWO), X1, by("side", B, sign=1)),
    ("side", state("x", "!=", x=BELOW), XB, by("side", B, sign=-1)),
    ("cases", state("abs(x) + x", ">=", x=LINE), X0, cases("x", given("2"), I)),
    ("cases", state("abs(x) - x**2", ">=", x=BOTH), X0, cases("x", roots("0", "1"), roots("-1", "0"))),
    ("cases", state("abs(x - y)", ">=", "x - y", x=LINE, y=LINE), XY, cases("x - y", I, given("2"))),
    ("cases", state("abs(x) + 1/2", ">", x=BAR), X0, cases("x", B, B)),
    ("split", state("x - 1", ">=", x=TWO), X1, split("3/2", span(0), B)),
    ("split", state("abs(x)", ">=", "x", x=["-1", "pi", []]), X0, split("0", *[cases("x", I, given("2"))] * 2)),
    ("integers", state("x*(x - 1)*(x - 2)", "=", x=["-1/2", "5/2", ["integer"]]), X1, integers(0, I, I, I)),
    ("integers", state("sin(pi*x)", "=", x=["0", "1", ["integer"]]), X1, integers(0, I, I)),
    ("abstract", state("x**2 - 1/2", ">=", x=TWO), X1, abstract({"u": "x"}, {"u": TWO}, "u**2 - 1/2", [span(0),
     span(1)], B)),
    ("abstract", state("exp(x) + exp(-x)", ">", x=LINE), X0, abstract({"u": "exp(x)", "v": "exp(-x)"}, {"u": ["0", None,
     ["open-low"]], "v": UP}, "u + v", [signs("exp(x)", None), signs("exp(-x)", None)], cones(None))),
    ("dense", SQUARE, X0, dense("x", X1, equal("x**2", factors(None)))),
    ("dense", state("x**4 + x**2", ">=", x=BAR), X0, dense("x", X1, multiply("x**(-2)", factors(None),
     equal("x**2 + 1", roots("-1", "1"))))),
    ("dense", state("sqrt(x)", ">=", x=OPEN), X1, dense("sin(x)*exp(2*x)**3*cosh(x)", X1, signs("sqrt(x)", None),
     span(0))),
    ("solve", state("log(4)", "=", "2*log(2)"), {}, solve("log(4)", "2*log(2)", I)),
    ("solve", state("sqrt(x**2 + 2*x + 1)", "=", "x + 1", x=UNIT), X0, solve("sqrt(x**2 + 2*x + 1)", "x + 1", I, B)),
    ("solve", state("abs(x)", "=", "-x", x=BELOW), XB, solve("abs(x)", "-x", I, B)),
    ("solve", state("2*x", "=", "2*abs(x)", x=UNIT), X0, solve("abs(x)", "x", I, span(0), share="-2")),
    ("solve", state("(x**3)**(2/3)", "=", "x**2", x=UNIT), X0, solve("(x**3)**(2/3)", "x**2", I, signs("x**2",
     None))),
    ("solve", state("asin(sin(x))", "=", "x", x=UNIT), X0, solve("asin(sin(x))", "x", I, B, B)),
    ("solve", state("acos(cos(x))", "=", "x", x=UNIT), X0, solve("acos(cos(x))", "x", I, span(0), B)),
    ("solve", state("atan(tan(x))", "=", "x", x=UNIT), X0, solve("atan(tan(x))", "x", I, B, B)),
    ("solve", state("atan2(sin(x), cos(x))", "=", "x", x=["-1", "pi", []]), X0, solve("atan2(sin(x), cos(x))", "x", I,
     equal("1", B), span(1), B)),
    ("squares", state("sqrt(x)*sqrt(y)", "=", "sqrt(x*y)", x=UNIT, y=UNIT), XY, squares("sqrt(x)*sqrt(y)",
     "sqrt(x*y)", 1, I, factors(None, None), factors(None))),
    ("squares", state("-abs(x)", "=", "-sqrt(x*x)", x=LINE), X0, squares("-abs(x)", "-sqrt(x*x)", -1, I, factors(None,
     None, None), factors(None, None, None))),
    ("squares", state("sqrt(x + 1)", ">=", "1", x=UNIT), X0, squares("sqrt(x + 1)", "1", 1, equal("x", span(0)),
     factors(None))),
    ("squares", state("sqrt(x + 2)", ">", "1", x=UNIT), X0, squares("sqrt(x + 2)", "1", 1, equal("x + 1", B),
     factors(None))),
    ("derivative", state("(x + 1)**2", "=", "x**2 + 2*x + 1", x=LINE), X0, derivative(X0, I, [I])),
    ("derivative", state("atan(x) + atan(1/x)", "=", "pi/2", x=["0", None, ["open-low"]]), X1, derivative(X1,
     QUARTER, [I], by("side", span(0), sign=1), *[roots("0", None)] * 2)),
    ("balls", state("x**2 + 1", ">", x=TWO), X1, B),
    ("balls", state("x - x**2 + 1/100", ">", x=UNIT), X0, B),
    ("balls", state("1 + sqrt(x)", "!=", x=["-1", "1", []]), X0, B),
    ("balls", state("atan2(x, 1)", "<", "1", x=UNIT), X0, B),
    ("given", state("abs(x)", ">=", x=LINE), X0, cases("x", given("1"), given("1"))),
    ("given", state("abs(x)*2 + abs(y)", ">=", x=LINE, y=LINE), XY, cases("x", *[cases("y", *[given("2",
     "1")] * 2)] * 2)),
    ("empty", state("abs(x)", "=", "x", x=["0", None, ["open-low"]]), X1, cases("x", I, empty(0, span(0)))),
    ("empty", state("abs(x)", "<", "2", x=["-1", "0", ["open-high"]]), XB, cases("x", empty(0, span(1)), B)),
    ("range", state("x - 1", ">=", x=TWO), X1, span(0)),
    ("range", state("2*pi - 2*x", ">", x=["0", "pi", ["open-high"]]), X1, span(1, "2")),
    ("range", state("x", ">", x=["0", "1", [HOLED]]), X1, span(0)),
    ("angle", state("sin(x)", ">=", x=["0", "3", []]), X0, turned("sin(x)", 0, equal("x", span(0)), B)),
    ("angle", state("cos(x)", ">", x=BOTH), X0, turned("cos(x)", 0, B, B)),
    ("angle", state("-2*sin(x)", ">", x=["4", "6", []]), {"x": "5"}, turned("-2*sin(x)", 1, B, B, share="2")),
    ("angle", state("-sin(x)", ">", x=["-3", "-1", []]), XB, turned("-sin(x)", -1, B, B)),
    ("angle", state("-cos(x)", ">", x=["2", "4", []]), {"x": "3"}, turned("-cos(x)", 1, B, B)),
    ("bounded", state("2 + sin(x)", ">", x=LINE), X0, bounded(B)),
    ("bounded", state("3 - 2*cos(x) + sin(y)", ">=", x=LINE, y=LINE), XY, bounded(I)),
    ("bounded", state("1 - tanh(x)", ">", x=LINE), X0, bounded(I)),
    ("bounded", state("pi/2 - atan(x)", ">", x=LINE), X0, bounded(I)),
    ("bounded", state("asin(x) + pi/2", ">=", x=BOTH), X0, bounded(I)),
    ("bounded", state("pi - acos(x)", ">=", x=BOTH), X0, bounded(I)),
    ("bounded", state("2*acos(x)", ">=", x=BOTH), X0, bounded(I)),
    ("bounded", state("pi + atan2(x, y)", ">=", x=LINE, y=LINE), XY, bounded(I)),
    ("corners", state("x + 2", ">=", x=TWO), X1, corners("x", B, B)),
    ("corners", state("x**2 + 1", ">=", x=TWO), X1, corners("", B)),
    ("corners", state("x*y + 1", ">=", x=BOTH, y=BOTH), XY, corners("xy", B, I, I, B)),
    ("corners", state("x*exp(y) + exp(y)", ">=", x=BOTH, y=UNIT), XY, corners("x", I, B)),
    ("corners", state("3 - x", ">", x=["0", "sqrt(2)", ["open-high"]]), X1, corners("x", B, B)),
    ("product", SQUARE, X0, signs("x**2", None)),
    ("product", state("x**(-2)", ">", x=NONZERO), X1, signs("x**(-2)", None)),
    ("product", state("x**2", ">", x=NONZERO), X1, signs("x**2", [1, roots(None, None)])),
    ("product", state("x**(1/2)", ">=", x=UNIT), X1, signs("x**(1/2)", None)),
    ("product", state("x**(-1/2)", ">", x=OPEN), X1, signs("x**(-1/2)", None)),
    ("product", state("x**(-3/2)*x**3", ">", x=OPEN), X1, signs("x**(-3/2)*x**3", None, [1, span(0)])),
    ("product", state("exp(x)*cosh(x)", ">", x=LINE), X1, signs("exp(x)*cosh(x)", None, None)),
    ("product", state("abs(x)*acos(y)*sqrt(y)", ">=", x=LINE, y=UNIT), XY, signs("abs(x)*acos(y)*sqrt(y)",
     *[None] * 3)),
    ("product", state("abs(x)", ">", x=TWO), X1, signs("abs(x)", [1, by("side", B, sign=1)])),
    ("product", state("x**x", ">", x=TWO), X1, signs("x**x", None)),
    ("product", state("-x*y", ">", x=TWO, y=BELOW), {"x": "1", "y": "-1"}, signs("-1*x*y", None, [1, B], [-1, B])),
    ("product", state("x**3", ">", x=TWO), X1, signs("x**3", [1, B])),
    ("product", state("1/x", ">", x=OPEN), X1, signs("1/x", None, [1, span(0)])),
    ("product", state("x**3", ">=", x=UNIT), X1, signs("x**3", [1, span(0)])),
    ("product", state("x*exp(x)", "!=", x=TWO), X1, signs("x*exp(x)", [1, by("side", B, sign=1)], None)),
    ("product", state("-x", "!=", x=TWO), X1, signs("-1*x", None, [-1, B])),
    ("product", state("1/x", "!=", x=NONZERO), X1, signs("1/x", None, None)),
    ("sum", state("x + x**2", ">=", x=UNIT), X1, add(span(0), factors(None), I)),
    ("sum", state("exp(x) + x**2", ">", x=LINE), X1, add(factors(None), factors(None), I)),
    ("sum", state("x**2 + exp(x)", ">", x=LINE), X1, add(factors(None), factors(None), I, strict=1)),
    ("slope", state("x - sin(x)", ">=", x=UNIT), X1, slope(0, bounded(I), I)),
    ("slope", state("exp(x) - 1", ">", x=OPEN), X1, slope(0, factors(None), I, strict=1)),
    ("slope", state("x + 1", ">", x=UNIT), X1, slope(0, B, B)),
    ("slope", state("2 - x**2", ">", x=UNIT), X1, slope(1, factors(None, None, None, [1, span(0)]), B)),
    ("slope", state("x**(1/2)", ">=", x=UNIT), X1, slope(0, factors(None, [1, B], None), B, continuous=[span(0)],
     smooth=[span(0)])),
    ("slope", state("x*y", ">=", x=UNIT, y=TWO), XY, slope(0, B, I)),
    ("concave", state("x - x**2", ">=", x=UNIT), X1, concave(B, I, I)),
    ("concave", state("sin(x)", ">=", x=["0", "pi", ["open-high"]]), X1, concave(turned("sin(x)", 0, equal("x",
     span(0)), span(1)), I, I)),
    ("concave", state("x**(1/2) - x", ">=", x=UNIT), X1, concave(signs("0.25*x**(-3/2)", None, None), B, I,
     continuous=[span(0)], smooth=[span(0)])),
    ("cones", state("x**2 + 1", ">", x=TWO), X1, cones(None)),
    ("cones", state("x**2 - x*y + y**2", ">=", x=LINE, y=LINE), XY, cones(HALVES, None, None, HALVES)),
    ("cones", state("x*(1 - x)", ">=", x=UNIT), X0, cones(None)),
    ("cones", state("x**2 - x + 1", ">=", x=UP), X0, cones([0, 2, None, None])),
    ("cones", state("x**2 - x + 1", ">=", x=UP), X0, cones([2, 0, None, None])),
    ("cones", state("x + 2*y - 3", ">=", x=["1", "3", []], y=["1", "2", []]), XY, cones(None)),
    ("cones", state("13 - 3*x - 2*y", ">=", x=["1", "3", []], y=["1", "2", []]), XY, cones(None)),
    ("cones", state("x*y + x - y + 1", ">", x=["2", "3", []], y=["-1", "5", []]), {"x": "2", "y": "0"}, cones(None)),
    ("bounded", state("1 - erf(x)", ">", x=LINE), X0, bounded(I)),
    ("bounded", state("1 + erf(x)", ">", x=LINE), X0, bounded(I)),
    ("bounded", state("1 - tanh(x)", ">", x=LINE), X0, bounded(I)),
    ("bounded", state("pi/2 + atan(x)", ">", x=LINE), X0, bounded(I)),
    # Beyond the ends of asin, acos, log and roots there is nothing to show.
    ("balls", state("x + 3/2 + 0*asin(x)", ">", x=["-3", "1", []]), X0, B),
    ("balls", state("3/2 - x + 0*acos(x)", ">", x=["-1", "3", []]), X0, B),
    ("range", state("x", ">", x=["0", "3", ["open-low", "open-high", "nonzero", "integer"]]), X1, span(0)),
    ("balls", state("asin(x) + acos(x) + 1", ">", x=["-2", "2", []]), X0, B),
    ("cones", state("x - 1", ">", x=["1", None, ["open-low"]]), {"x": "2"}, cones(None)),
    ("cones", state("x - 1", ">=", x=["1", None, []]), {"x": "2"}, cones(None)),
    ("cones", state("-x", ">", x=[None, "0", ["open-high"]]), XB, cones(None)),
    ("cones", state("1/2 - x", ">", x=[None, "0", []]), XB, cones(None)),
    ("cones", state("x**2", ">", x=NONZERO), X1, cones(None, None)),
    ("cones", state("x + y", ">", x=["0", None, ["open-low"]], y=UP), XY, cones([0, 1, None, None])),
    ("quadratic", state("(x - 3)**2 + y", ">=", x=UP, y=UP), XY, quadratic("1, -6, 9 + y", B, add(B, span(0,
     symbol="y")), equal("4*y", span(0, "4", "y")))),
    ("quadratic", state("x**2 + x + 1", ">", x=LINE), X0, quadratic("1, 1, 1", B, B, B)),
    ("quadratic", state("x**2 + x*y + y**2", ">=", x=LINE, y=LINE), XY, quadratic("1, y, y**2", B, factors(None),
     signs("3*y**2", None, None))),
    ("quadratic", state("x**2 + 2*x + 1", ">=", x=LINE), X0, quadratic("1, 2, 1", B, B, I)),
    ("roots", state("x**2 + 1", ">", x=TWO), X1, roots("1", "2")),
    ("roots", state("x**3 - x", ">=", x=TWO), X1, roots("1", "2")),
    ("roots", state("x**3 - x", ">", x=["1", "2", ["open-low"]]), {"x": "2"}, roots("1", "2")),
    ("roots", state("x - x**3", ">", x=["0", "1", ["open-high", HOLED]]), {"x": "1/2"}, roots("0", "1")),
    ("roots", state("x**4", ">", x=NONZERO), X1, roots(None, None)),
    ("roots", state("(x - 1)**2", ">=", x=["0", "2", []]), X1, roots("0", "2")),
    ("roots", state("(x**2 - 1)/(x - 1)", ">", x=["0", "3", []]), X0, roots("0", "3")),
    ("roots", state("x**2 - 1", ">", x=["sqrt(2)", "2", []]), {"x": "2"}, roots("7/5", "9/4")),
    ("roots", state("x**2 - 2", "!=", x=["3/2", "2", []]), {"x": "2"}, roots("3/2", None)),
    ("roots", state("-1/x**3", ">", x=BELOW), XB, roots("-3", "-1")),
]
# fmt: on


# What is refused, and why: the statements are false but where a proof of another form is asked for
MINUS = state("-1", ">=", x=LONG)
SHIFTED = state("x + 3/5", ">=", x=LONG)  # false for x < -3/5, where sqrt(x) has no value
ROOT = "x + 3/5 + 0*sqrt(x)"
POLE = state("-1/x", ">=", x=BOTH)
CUT = state("-atan2(-x**2, -1)", ">=", x=BOTH)
JUMP = state("atan2(x, -1) + atan(x)", "=", "pi", x=BOTH)
KINK = state("abs(x) - 1/2", ">=", x=BOTH)
FALLING = state("atan2(x, -1)", ">=", x=BOTH)
FALLS = equal("(x*x + 1)**(-1)", roots("-1", "1"))
CAPTURE = abstract({"u": "x"}, {"u": BOTH}, "u", [span(0), span(1)], given("1"))
CAPTURED = abstract({"u": "-x"}, {"u": BOTH}, "-u", [span(1), span(0)], given("1"))
REUSED = abstract({"x": "-x"}, {"x": BOTH}, "-x", [span(1), span(0)], given("1"))
MINUS_X = state("0*x - 1", ">=", x=TWO)
LEFT = "(x - abs(x))"  # vanishes for x >= 0
VACUOUS = rewrite(LEFT, "0", solve("abs(x)", "x", I, span(0), share="-1"), factors(None, [1, span(0)], None, [-1, I]))
ONE_POINT = ["1", "1", []]
COUNT = ["0", "3", ["integer"]]
WHOLE = state("x*(x - 1)*(x - 2)", "=", x=COUNT)
X2, XH = {"x": "2"}, {"x": "1/2"}
# fmt: off
HOSTILE = [
    ("identity", state("sqrt(x**2)", "=", "x", x=BOTH), X0, I, "the sides differ"),
    ("identity", state("0*x", ">", x=BOTH), X0, I, "the sides differ"),
    ("identity", state("0*x", "!=", x=BOTH), X0, I, "the sides differ"),
    ("identity", state("sin_1(atan2(0*x, x))", "=", x=TWO), X1, I, "of a root or angle"),
    ("identity", state("sin_1(atan(x) + atan(1/x) - pi/2)", "=", x=TWO), X1, I, "of a root or angle"),
    ("identity", state("exp_1(log(x*x) - 2*log(x))", "=", x=TWO), X1, I, "of a root or angle"),
    ("identity", state("sin_1(asin(x/9) + acos(x/9) - pi/2)", "=", x=TWO), X1, I, "of a root or angle"),
    ("zero", state("x - 1/2", ">=", x=UNIT), X1, by("zero", I), "the sides differ"),
    ("zero", state("0*x", ">", x=UNIT), X1, by("zero", I), "expected >="),
    ("zero", state("0*x", "!=", x=UNIT), X1, by("zero", I), "expected >="),
    ("equal", MINUS, X0, equal("1", B), "the terms differ"),
    ("equal", SHIFTED, X0, equal(ROOT, B), "expected 1 entries"),
    ("equal", SHIFTED, X0, equal(ROOT, B, B), "not shown"),
    ("equal", SHIFTED, X0, equal("x + 3/5 + 0*x**(1/2)", B), "expected 1 entries"),
    ("equal", state("-1", ">=", x=["1/2", "1", []]), X1, equal("-x**0", B), "the terms differ|expected"),
    ("rewrite", MINUS, X0, rewrite("-1", "1", I, B), "the sides differ"),
    ("rewrite", state("-x**2", ">=", x=BELOW), XB, rewrite("2", "2 + 0*x", I, B), "another exponent"),
    ("rewrite", SHIFTED, X0, rewrite("x", "x + 0*sqrt(x)", I, B), "expected 1 entries"),
    ("rewrite", state("x", ">=", x=BOTH), X0, rewrite("x", "abs(x)", I, signs("abs(x)", None)), "the sides differ"),
    ("multiply", state("-1", ">=", x=UNIT), X1, multiply("-1", B, B), "not shown"),
    ("multiply", state("-1", ">=", x=["0", "0", []]), X0, multiply("x", span(0), B), "the end belongs"),
    ("multiply", SHIFTED, X0, multiply("1 + sqrt(x)", B, B), "expected 1 entries"),
    ("multiply", state("x", ">", x=TWO), X1, multiply(NOWHERE, B), "expected 1 entries"),
    ("multiply", state("sqrt(x)", ">", x=UNIT), X1, multiply("x**(-1/2)", factors(None), equal("1", B)), "1 entries"),
    ("exponential", state("-1", ">", x=LINE), X0, by("exponential", B), "not shown"),
    ("exponential", state("x", ">=", x=BOTH), X0, by("exponential", signs("exp(x)", None)), "the terms differ"),
    ("side", state("x", "!=", x=UNIT), X0, by("side", span(0), sign=1), "the end belongs"),
    ("side", state("x", "!=", x=BOTH), X0, by("side", B, sign=1), "not shown"),
    ("side", state("x", ">=", x=BELOW), XB, by("side", B, sign=-1), "expected !="),
    ("side", state("x", "=", x=BELOW), XB, by("side", B, sign=-1), "expected !="),
    ("side", state("x", "!=", x=BOTH), X0, by("side", B, sign=2), "an integer from"),
    ("cases", state("abs(x) + 2*x", ">=", x=BOTH), X0, cases("x", given("3"), given("1")), "the term is another one"),
    ("cases", state("x", ">=", x=BOTH), X0, cases("x", span(0), span(0)), "the term is another one"),
    ("cases", state("x", ">=", x=["-2", "-1", []]), XB, cases("x", given("1"), span(1)), "the term is another one"),
    ("cases", state("-x", ">=", x=TWO), X1, cases("x", span(0), given("1")), "the term is another one"),
    ("cases", state("abs(x)", ">", x=BAR), X0, cases("x", span(0), span(1)), "the end belongs"),
    ("cases", state("-abs(x)", ">", "-1", x=BOTH), X0, cases("x", span(1), span(0)), "the end belongs"),
    ("cases", SHIFTED, X0, cases("sqrt(x)", B, B), "expected 1 entries"),
    ("cases", state("-1", ">=", x=UNIT), X0, cases("0*x", B, B), "not shown"),
    ("cases", state("abs(x) + x", ">=", "1", x=BOTH), X1, cases("x", given("2")), "expected 2 entries"),
    ("cases", state("x", ">=", x=BOTH), X1, cases("u + 0", CAPTURE, CAPTURED), "a symbol without a range"),
    ("abstract", state("x", ">=", x=BOTH), X1, cases("x + 0", given("1"), REUSED), "in use"),
    ("split", state("x", "!=", x=BAR), XH, split("0", by("side", span(1), sign=-1), by("side", span(0), sign=1)),
     "the end belongs"),
    ("split", state("x", ">=", x=BOTH), X1, split("0", span(0), span(0)), "the term is another one"),
    ("split", MINUS_X, X1, split("log(-1)", slope(1, I, B), slope(0, I, B)), "may not exist"),
    ("split", state("-1", ">=", x=TWO), X1, split("x", slope(1, I, B), slope(0, I, B)), "expected a number"),
    ("split", state("x", ">=", x=BOTH), X1, split("0", span(0)), "expected 2 entries"),
    ("split", state("x", ">=", x=BOTH), X1, by("split", symbol="y", at="0", proofs=[B, B]), "without a range"),
    ("integers", WHOLE, X0, integers(0, I, I, I), "more integers"),
    ("integers", state("(x - 1)*(x - 2)*(x - 3)", "=", x=COUNT), X1, integers(1, I, I, I), "more integers"),
    ("integers", WHOLE | {"symbols": {"x": ["0", "2", []]}}, X0, integers(0, I, I, I), "expected an integer"),
    ("integers", WHOLE | {"symbols": {"x": ["0", None, ["integer"]]}}, X0, integers(0, I, I, I), "more integers"),
    ("integers", WHOLE | {"symbols": {"x": [None, "2", ["integer"]]}}, X0, integers(0, I, I, I), "more integers"),
    ("integers", state("x", "=", x=["0", "1", ["integer"]]), X0, integers(0, I, I), "the sides differ"),
    ("abstract", state("x", ">", x=BOTH), X1, abstract({"u": "x"}, {"u": TWO}, "u", [span(0), span(1)], B),
     "another one"),
    ("abstract", state("-x", ">", x=BOTH), XB, abstract({"u": "x"}, {"u": BELOW}, "-u", [span(0), span(1)], B),
     "another one"),
    ("abstract", state("x", ">", x=UNIT), X1, abstract({"u": "x"}, {"u": OPEN}, "u", [span(0), span(1)], span(0,
     symbol="u")), "the end belongs"),
    ("abstract", state("x", ">=", x=BOTH), X1, abstract({"u": "x*x"}, {"u": UP}, "u", [signs("x*x", [1, B], [1, B])],
     span(0, symbol="u")), "not shown|the terms differ"),
    ("abstract", state("-1", ">=", x=BOTH), X1, abstract({"u": "x**2"}, {"u": UP}, "u", [signs("x**2", None)], span(0,
     symbol="u")), "the terms differ"),
    ("abstract", state("x", ">=", x=BOTH), X1, abstract({"x": "1 + x**2"}, {"x": TWO}, "x", [B, B], B), "in use"),
    ("abstract", state("x", ">", x=UNIT), X1, abstract({"u": "x"}, {"u": ["0", "1", [HOLED]]}, "u", [span(0), span(1)],
     span(0, symbol="u")), "no interval"),
    ("abstract", state("sin(pi*x)", "=", x=UNIT), X1, abstract({"u": "x"}, {"u": ["0", "1", ["integer"]]}, "sin(pi*u)",
     [span(0), span(1)], by("integers", symbol="u", **{"from": 0}, proofs=[I, I])), "no interval"),
    ("abstract", state("-x**2", ">=", x=BELOW), XB, abstract({"u": "2"}, {"u": TWO}, "-x**u", [I, I], B),
     "another exponent"),
    ("abstract", SHIFTED, X0, abstract({"u": "x"}, {"u": LONG}, "u + 3/5 + 0*sqrt(u)", [span(0), span(1)], by("balls",
     bits=60, cells=20)), "expected 1 entries"),
    ("abstract", state("-1", ">=", x=LONG), X0, abstract({"u": "1 + sqrt(x)"}, {"u": TWO}, "-1", [B, B], B),
     "expected 1 entries"),
    ("dense", state("-1", ">=", x=BOTH), X0, dense(VANISHING, X1, equal(f"{VANISHING}*(-{VANISHING})**(-1)",
     rewrite(VANISHING, "0", I, factors(None, [1, I])))), "may vanish throughout"),
    ("dense", CUT, X1, dense("x", X1, I, B, B), "not shown"),
    ("dense", state("x", ">", x=["0", "1", []]), X1, dense("x", X1, span(0)), "expected >="),
    ("dense", state("x**2", ">", x=BOTH), X1, dense("x", X1, multiply("x**(-2)", factors(None), equal("1", B))),
     "expected >="),
    ("dense", state("-1", ">=", x=ONE_POINT), X1, dense("x - 1", X2, B), "a side without inner points"),
    ("dense", state("-1", ">=", x=["1", "2", ["integer"]]), X1, dense("(x - 1)*(x - 2)", X0, B),
     "a side without inner points"),
    ("dense", state("-x", ">=", x=UP), X0, dense(LEFT, XB, equal(f"-1*x*{LEFT}*{LEFT}**(-1)", VACUOUS)),
     "expected an entire function"),
    ("dense", state("-1", ">=", x=BOTH), X0, dense("x**(-1)*x", X1, B), "expected an entire function"),
    ("dense", state("-1", ">=", x=BOTH), X0, dense("x**(1/2)", X1, B), "expected an entire function"),
    ("dense", state("-1", ">=", x=BOTH), X0, dense("x**0", X1, B), "expected an entire function"),
    ("dense", state("sqrt(x)", ">=", x=UNIT), X0, dense("x", X1, signs("sqrt(x)", None)), "expected 1 entries"),
    ("solve", state("sqrt(x**2 + 2*x + 1)", "=", "-x - 1", x=UNIT), X0, solve("sqrt(x**2 + 2*x + 1)", "-x - 1", I, B),
     "not shown"),
    ("solve", state("sqrt(x**2)", "=", "2*x", x=TWO), X1, solve("sqrt(x**2)", "2*x", I, B), "the sides differ"),
    ("solve", state("abs(x)", "=", "x", x=BOTH), X0, solve("abs(x)", "x", I, span(0)), "another one"),
    ("solve", state("abs(x)", "=", "2*x", x=TWO), X1, solve("abs(x)", "2*x", I, B), "the sides differ"),
    ("solve", state("(x**2)**(1/2)", "=", "x", x=BOTH), X0, solve("(x**2)**(1/2)", "x", I, span(0)), "another one"),
    ("solve", state("x**(2/3)", "=", "x", x=TWO), X1, solve("x**(2/3)", "x", I, B), "the sides differ"),
    ("solve", state("log(x)", "=", "x", x=TWO), X1, solve("log(x)", "x", I), "the sides differ"),
    ("solve", state("asin(sin(x))", "=", "x", x=["0", "3", []]), X0, solve("asin(sin(x))", "x", I, B, B),
     "not shown"),
    ("solve", state("asin(sin(x))", "=", "x", x=["-3", "0", []]), X0, solve("asin(sin(x))", "x", I, B, B),
     "not shown"),
    ("solve", state("asin(x)", "=", "x", x=UNIT), X0, solve("asin(x)", "x", I, B, B), "the sides differ"),
    ("solve", state("acos(cos(x))", "=", "x", x=["-1", "0", []]), X0, solve("acos(cos(x))", "x", I, B, B),
     "not shown"),
    ("solve", state("acos(cos(x))", "=", "x", x=["3", "4", []]), {"x": "3"}, solve("acos(cos(x))", "x", I, B, B),
     "not shown"),
    ("solve", state("acos(x)", "=", "1 - x", x=UNIT), X1, solve("acos(x)", "1 - x", I, span(1), B),
     "the sides differ"),
    ("solve", state("atan(tan(x))", "=", "x", x=["2", "4", []]), X2, solve("atan(tan(x))", "x", I, B, B),
     "not shown"),
    ("solve", state("atan(tan(x))", "=", "x", x=["-4", "-2", []]), {"x": "-3"}, solve("atan(tan(x))", "x", I, B, B),
     "not shown"),
    ("solve", state("atan(x)", "=", "x", x=UNIT), X0, solve("atan(x)", "x", I, B, B), "the sides differ"),
    ("solve", state("atan2(sin(x), cos(x))", "=", "x", x=["3", "4", []]), {"x": "3"}, solve("atan2(sin(x), cos(x))",
     "x", I, equal("1", B), B, B), "not shown"),
    ("solve", state("atan2(sin(x), cos(x))", "=", "x", x=["-4", "-3", []]), {"x": "-3"}, solve("atan2(sin(x), cos(x))",
     "x", I, equal("1", B), B, B), "not shown"),
    ("solve", state("atan2(0, -1)", "=", "-pi"), {}, solve("atan2(0, -1)", "-pi", I, B, B, I), "the sides differ"),
    ("solve", state("atan2(sin(x), cos(x))", "=", "x + pi", x=["-3", "-2", []]), {"x": "-2"},
     solve("atan2(sin(x), cos(x))", "x + pi", I, equal("-1", B), B, B), "not shown"),
    ("solve", state("atan2(x, 1)", "=", "x", x=UNIT), X0, solve("atan2(x, 1)", "x", I, B, B, B), "the sides differ"),
    ("solve", state("sqrt((x + 3/5)**2)", "=", "x + 3/5", x=LONG), X0, solve("sqrt((x + 3/5)**2)", ROOT, I, B),
     "expected 1 entries"),
    ("solve", state("1", "=", x=UNIT), X1, solve("sqrt(x)", "sqrt(x)", I, I, share="0"), "expected an equation"),
    ("solve", state("abs(x)", ">", "x", x=UNIT), X1, solve("abs(x)", "x", I, span(0)), "expected an equation"),
    ("solve", state("sqrt(x**2)", "=", "2*x", x=TWO), X1, solve("sqrt(x**2)", "x", I, B), "the equation differs"),
    ("solve", state("sin(x)", "=", "x", x=TWO), X1, solve("sin(x)", "x", I, I), "expected an inverse function"),
    ("squares", state("1", "=", "-1"), {}, squares("1", "-1", 1, I, B, B), "not shown"),
    ("squares", state("1", "=", "-1"), {}, squares("1", "-1", 1, I, B), "expected 3 entries"),
    ("squares", state("1", "=", "-1"), {}, squares("1", "-1", -1, I, B, B), "not shown"),
    ("squares", state("-2", ">=", "1"), {}, squares("-2", "1", 1, B, B), "not shown"),
    ("squares", state("-2", ">=", "-1"), {}, squares("-2", "-1", -1, B, B), "a wrong sign"),
    ("squares", state("-2", ">", "-1"), {}, squares("-2", "-1", -1, B, B), "a wrong sign"),
    ("squares", state("-1", "=", "1"), {}, squares("-1", "1", 0, I, I, I), "expected a sign"),
    ("squares", state("1", "!=", "1"), {}, squares("1", "1", 1, B, B), "a wrong sign"),
    ("squares", state("2", ">=", "3"), {}, squares("2", "3", 1, B, B), "not shown"),
    ("squares", state("2", ">", "2"), {}, squares("2", "2", 1, I, B), "the sides differ"),
    ("squares", state("1", "=", "2"), {}, squares("1", "2", 1, I, B, B), "the sides differ"),
    ("squares", MINUS, X0, squares("2", "1", 1, B, B), "the terms differ"),
    ("squares", SHIFTED, X0, squares(ROOT, "0*sqrt(x)", 1, B, B), "expected 1 entries"),
    ("derivative", state("x/abs(x)", "=", "1", x=HOLE), X1, derivative(X1, I, [I], B, B), "a box with holes"),
    ("derivative", state("atan(x) + atan(1/x)", "=", "pi/2", x=HOLE), X1, derivative(X1, QUARTER, [I],
     *[roots("-1", "1")] * 3), "a box with holes"),
    ("derivative", state("0*x", "=", "1", x=COUNT), X1, derivative(X1, B, [I]), "a box with holes"),
    ("derivative", state("x/abs(x)", "=", "1", x=BOTH), X1, derivative(X1, B, [I]), "entries"),
    ("derivative", JUMP, X1, derivative(X1, I, [I], B, B, B), "so many cells"),
    ("derivative", JUMP, X1, derivative(X1, I, [I], B, B), "expected 3 entries"),
    ("derivative", state("0*x + 1", "=", x=LINE), X0, derivative(X0, I, [I]), "the sides differ"),
    ("derivative", state("x", "=", x=LINE), X0, derivative(X0, I, [I]), "the sides differ"),
    ("derivative", state("x*y", "=", x=LINE, y=LINE), {"x": "0", "y": "0"}, derivative({"x": "0", "y": "0"}, I, [I]),
     "2 entries"),
    ("derivative", state("x - y", "=", x=LINE, y=LINE), XY, derivative(X1, I, [I, I]),
     "the sides differ|every symbol"),
    ("derivative", state("0*x + y", "=", x=LINE, y=LINE), {"x": "0", "y": "0"}, derivative({"x": "0", "y": "0"}, I, [I,
     I]), "differ"),
    ("derivative", state("0*x + 1", "=", x=LINE), X0, derivative({"x": "log(-1)"}, multiply(NOWHERE, B), [I]),
     "may not exist"),
    ("derivative", state("1 + 0*sqrt(x)", "=", x=TWO), X1, derivative(XB, multiply("0*sqrt(-1)", B), [I], B),
     "outside"),
    ("derivative", state("0*x + 1", "=", x=LINE), X0, derivative({}, I, [I]), "every symbol"),
    ("derivative", state("0*x", ">", x=LINE), X0, derivative(X0, I, [I]), "expected an equation"),
    ("balls", state("x", ">", x=UNIT), X1, B, "not shown"),
    ("balls", state("x + 3/5", ">", x=BOTH), X1, B, "not shown"),
    ("balls", state("1/5 - x", ">=", x=UNIT), X0, B, "not shown"),
    ("balls", state("x**2 - 1/10**3", ">=", x=BOTH), X1, B, "not shown"),
    ("balls", state("0*x", "=", x=UNIT), X1, B, "expected an inequality"),
    ("balls", state("1", "=", x=UNIT), X1, B, "expected an inequality"),
    ("balls", state("x", "!=", x=BOTH), X1, B, "not shown"),
    ("balls", state("x + 1", ">", x=UP), X1, B, "not shown"),
    ("balls", state("asin(x) + 2", ">", "1", x=LONG), X0, B, "not shown"),
    ("balls", state("1 - x**2", ">=", x=["0", "1.01", []]), X0, B, "not shown"),
    ("balls", state("sqrt(x)", ">", "1/100", x=BOTH), X1, B, "not shown|so many cells"),
    ("balls", state("log(x)", ">", "-10", x=UNIT), X1, B, "so many cells"),
    ("balls", state("acos(x)", "<", "3", x=BOTH), X1, B, "so many cells"),
    ("balls", state("(x*x - 1/4)**(-1/2)", "<", "5", x=UNIT), X1, B, "so many cells"),
    ("balls", state("x**x", ">", "7/10", x=UNIT), X1, B, "so many cells"),
    ("given", state("-abs(x)", ">=", x=LINE), X0, cases("x", given("-1"), given("-1")), "weights"),
    ("given", state("abs(x)", ">", x=LINE), X0, cases("x", given("1"), given("1")), "expected >="),
    ("given", state("abs(x)", "!=", x=LINE), X0, cases("x", given("1"), given("1")), "expected >="),
    ("given", state("abs(x) - 1", ">=", x=LINE), X1, cases("x", given("1"), given("1")), "another one"),
    ("given", MINUS, X0, given(), "another one"),
    ("given", state("-abs(x)", ">=", x=LINE), X0, cases("x", given(), given()), "expected 1 entries"),
    ("empty", state("abs(x)", "=", "x", x=UP), X1, cases("x", I, empty(0, span(0))), "the end belongs"),
    ("empty", state("abs(x)", "=", "x", x=BOTH), X1, cases("x", I, empty(0, B)), "not shown"),
    ("empty", state("abs(x)", "=", "-x", x=["0", None, ["open-low"]]), X1, cases("x", empty(0, span(0)), I), "another"),
    ("empty", state("abs(x)", "=", "x", x=TWO), X1, cases("x", I, empty(1, span(0))), "expected an integer"),
    ("empty", state("x", "=", "1", x=TWO), X1, empty(0, B), "expected an integer"),
    ("range", state("x", ">", x=UNIT), X1, span(0), "the end belongs"),
    ("range", state("1 - x", ">", x=UNIT), X0, span(1), "the end belongs"),
    ("range", state("x", ">", x=["0", "1", ["open-high"]]), XH, span(0), "the end belongs"),
    ("range", state("x - 1", ">", x=["1", "2", [HOLED]]), X2, span(0), "the end belongs"),
    ("range", state("-x", ">=", x=UNIT), X0, span(0, "-1"), "expected a symbol"),
    ("range", state("0*x", ">", x=OPEN), X1, span(0, "0"), "expected a symbol"),
    ("range", state("-x", ">=", x=UNIT), X0, span(1), "the term is another one"),
    ("range", state("x - 1", ">=", x=UNIT), X1, span(0), "the term is another one"),
    ("range", state("x", ">=", x=[None, "1", []]), X1, span(0), "without this end"),
    ("range", state("x", "!=", x=UNIT), X1, span(0), "expected a symbol"),
    ("range", state("x", ">=", x=BOTH, y=UP), XY, span(0, symbol="y"), "the term is another one"),
    ("angle", state("sin(x)", ">=", x=["0", "4", []]), X0, turned("sin(x)", 0, equal("x", span(0)), B), "not shown"),
    ("angle", state("sin(x)", ">=", x=["-1", "3", []]), X0, turned("sin(x)", 0, B, B), "not shown"),
    ("angle", state("-sin(x)", ">=", x=UNIT), X0, turned("-sin(x)", 0, equal("x", span(0)), B, share="-1"),
     "expected >= or >"),
    ("angle", state("0*sin(x)", ">", x=TWO), X1, turned("0*sin(x)", 0, B, B, share="0"), "expected >= or >"),
    ("angle", state("sin(x)", ">=", x=["4", "6", []]), {"x": "5"}, turned("sin(x)", 1, B, B), "another one"),
    ("angle", state("-sin(x)", ">=", x=TWO), X1, turned("-sin(x)", 0, B, B), "another one"),
    ("angle", state("sin(x)*cos(x)", ">=", x=["0", "3", []]), X0, turned("sin(x)*cos(x)", 0, B, B),
     "one sine or cosine"),
    ("angle", state("cos(x)", ">=", x=["0", "3", []]), X0, turned("cos(x)", 0, B, B), "not shown"),
    ("angle", state("cos(x)", ">=", x=["-3", "0", []]), X0, turned("cos(x)", 0, B, B), "not shown"),
    ("angle", state("sin(x)", ">", x=UNIT), X1, turned("sin(x)", 0, equal("x", span(0)), B), "the end belongs"),
    ("angle", state("sin(x)", ">", x=["1", "pi", []]), X1, turned("sin(x)", 0, B, span(1)), "the end belongs"),
    ("angle", state("sin(x)", "!=", x=BOTH), X1, turned("sin(x)", 0, I, I), "expected >= or >"),
    ("bounded", state("1 - sin(x)", ">", x=LINE), X0, bounded(I), "the sides differ"),
    ("bounded", state("sin(x) + 0.99", ">=", x=LINE), X0, bounded(B), "not shown"),
    ("bounded", state("cos(x) + 0.99", ">=", x=LINE), X0, bounded(B), "not shown"),
    ("bounded", state("1 - 2*sin(x)", ">=", x=LINE), X0, bounded(B), "not shown"),
    ("bounded", state("0.99 - tanh(x)", ">=", x=LINE), X0, bounded(B), "not shown"),
    ("bounded", state("1.57 - atan(x)", ">=", x=LINE), X0, bounded(B), "not shown"),
    ("bounded", state("1.57 - asin(x)", ">=", x=BOTH), X0, bounded(B), "not shown"),
    ("bounded", state("acos(x) - 0.01", ">=", x=BOTH), X0, bounded(B), "not shown"),
    ("bounded", state("3.14 - acos(x)", ">=", x=BOTH), X0, bounded(B), "not shown"),
    ("bounded", state("3.14 - atan2(x, y)", ">=", x=LINE, y=LINE), XY, bounded(B), "not shown"),
    ("bounded", state("pi - atan2(x, y)", ">", x=LINE, y=LINE), XY, bounded(I), "the sides differ"),
    ("bounded", state("acos(x)", ">", x=BOTH), X0, bounded(I), "the sides differ"),
    ("bounded", state("pi/2 - asin(x)", ">", x=BOTH), X0, bounded(I), "the sides differ"),
    ("bounded", state("1 + cos(x)", ">", x=LINE), X0, bounded(I), "the sides differ"),
    ("bounded", state("0*tanh(x)", ">", x=LINE), X0, bounded(I), "the sides differ"),
    ("bounded", state("2 - tanh(x)*exp(x)", ">", x=LINE), X0, bounded(B), "a product of functions"),
    ("bounded", state("2 - x", ">=", x=LINE), X0, bounded(B), "without a known range"),
    ("bounded", state("2 - x**3", ">=", x=LINE), X0, bounded(B), "without a known range"),
    ("bounded", state("2 - sinh(x)", ">=", x=LINE), X0, bounded(B), "without a known range"),
    ("bounded", state("sin(x)", "!=", x=LINE), X1, bounded(B), "expected >= or >"),
    ("corners", state("x**2 - 1/4", ">=", x=BOTH), X1, corners("x", B, B), "of a higher degree"),
    ("corners", state("x*y*x", ">=", "1/4*y", x=BOTH, y=TWO), XY, corners("x", B, B), "of a higher degree"),
    ("corners", state("1/x", ">=", "-3/2", x=BOTH), X1, corners("x", B, B), "depends where the term is defined"),
    ("corners", state("x + 0*sqrt(x - 1/4)", ">=", "1/2", x=UNIT), X1, corners("x", B, B), "where the term is defined"),
    ("corners", state("sin(x) + 0.9", ">=", x=["0", "2*pi", []]), X0, corners("x", B, B), "inside a function"),
    ("corners", state("x*exp(x) + 3/8", ">=", x=["-20", "0", []]), X0, corners("x", B, B), "inside a function"),
    ("corners", state("x", ">=", x=[None, "1", []]), X1, corners("x", B, B), "without an end"),
    ("corners", state("x", "!=", x=BOTH), X1, corners("x", by("side", B, sign=-1), by("side", B, sign=1)),
     "symbols of the box"),
    ("corners", state("x*y + 1/2", ">=", x=BOTH, y=BOTH), XY, corners("xy", B, B, B, B), "not shown"),
    ("corners", state("x*y + 1/2", ">=", x=BOTH, y=BOTH), XY, corners("xy", B, B), "expected 4 entries"),
    ("corners", state("x", ">=", x=BOTH), X1, corners("x", B), "expected 2 entries"),
    ("corners", state("x", ">=", x=BOTH), X1, corners("y", B, B), "symbols of the box"),
    ("corners", state("x", ">", x=["0", "1", []]), X1, corners("x", B, B), "not shown"),
    ("corners", state("x - 1/2", ">=", exists=["sqrt((x - 1/8)*(7/8 - x))"], x=UNIT), XH, corners("x",
     multiply("0*sqrt((0 - 1/8)*(7/8 - 0))", B), B), "expected 1 entries"),
    ("product", state("x**3", ">=", x=BOTH), X1, signs("x**3", None), "a factor without a proof"),
    ("product", state("x**2", ">", x=BOTH), X1, signs("x**2", None), "a factor without a proof"),
    ("product", state("x**2", "!=", x=BOTH), X1, signs("x**2", None), "a factor without a proof"),
    ("product", state("x**(1/2)", ">", x=UNIT), X1, signs("x**(1/2)", None), "a factor without a proof"),
    ("product", state("abs(x)", ">", x=BOTH), X1, signs("abs(x)", None), "a factor without a proof"),
    ("product", state("acos(x)", ">", x=BOTH), X0, signs("acos(x)", None), "a factor without a proof"),
    ("product", state("sqrt(x)", "!=", x=UNIT), X1, signs("sqrt(x)", None), "a factor without a proof"),
    ("product", state("sinh(x)", ">=", x=BOTH), X0, signs("sinh(x)", None), "a factor without a proof"),
    ("product", state("log(x)", ">=", x=OPEN), X1, signs("log(x)", None), "a factor without a proof"),
    ("product", state("1/x", ">=", x=HOLE), X1, signs("1/x", None, None), "a factor without a proof"),
    ("product", state("1/x", ">", x=HOLE), X1, signs("1/x", None, None), "a factor without a proof"),
    ("product", state("1/x", ">", x=HOLE), X1, signs("1/x", None, [1, B]), "so many cells"),
    ("product", state("x", "!=", x=BOTH), X1, signs("x", None), "a factor without a proof|expected"),
    ("product", state("x", "!=", x=BOTH), X1, signs("x*1", [1, span(0)], None), "expected a symbol"),
    ("product", state("-1*x**2", ">=", x=BOTH), X0, signs("-1*x**2", None, None), "the product of the signs"),
    ("product", state("x*y", ">", x=TWO, y=BELOW), {"x": "1", "y": "-1"}, signs("x*y", [1, B], [-1, B]),
     "of the signs"),
    ("product", state("0*x", ">", x=TWO), X1, signs("0*x", None, [1, B]), "a factor 0"),
    ("product", state("0*x", "!=", x=TWO), X1, signs("0*x", None, [1, by("side", B, sign=1)]), "a factor 0"),
    ("product", state("-1*x", ">=", x=TWO), X1, signs("-1*x", [1, B], [1, B]), "a factor 0"),
    ("product", state("x*y", ">", x=BOTH, y=BOTH), XY, signs("x*y", [1, B], [1, B]), "not shown"),
    ("product", state("x**2", ">", x=BOTH), X1, signs("x**2", [1, factors(None)]),
     "expected a|without a proof|sides"),
    ("product", state("x**2", ">", x=BOTH), X1, signs("x**2", [1, by("side", B, sign=1)]), "not shown"),
    ("product", state("x*x", ">", x=["0", "1", []]), X1, signs("x*x", [1, span(0)], [1, span(0)]), "the end belongs"),
    ("product", state("x**3", ">", x=["0", "1", []]), X1, signs("x**3", [1, span(0)]), "the end belongs"),
    ("product", state("x*exp(x)", ">=", x=BOTH), X1, signs("x*exp(x)", [0, I], None), "expected a sign"),
    ("product", state("x**y", ">=", x=TWO, y=TWO), XY, signs("x**y", [1, B]), "no number"),
    ("product", state("1/x", ">", x=BELOW), XB, signs("1/x", None, [1, B]), "not shown"),
    ("product", state("x*x**2", ">=", x=BELOW), XB, signs("x*x**2", [-1, B], None), "the product of the signs"),
    ("product", state("1/x", "=", x=TWO), X1, signs("1/x", None, [1, B]), "expected an inequality"),
    ("product", state("0*x", "=", "x", x=BELOW), XB, factors(None), "expected an inequality"),
    ("sum", state("x + x**2", ">", x=UNIT), X1, add(span(0), factors(None), I), "the end belongs"),
    ("sum", state("x**2 + abs(x)", ">", x=BOTH), X1, add(factors(None), factors(None), I, strict=2),
     "the sides differ"),
    ("sum", state("x - 1/2", ">=", x=UNIT), X1, add(span(0), B, I), "not shown"),
    ("sum", state("1 - x", ">=", x=["0", "3", []]), X1, add(B, B, I), "not shown"),
    ("sum", state("abs(x) + x**2", "!=", x=BOTH), X1, add(factors(None), factors(None), I), "expected >= or >"),
    ("sum", state("x + x**2", ">=", x=BOTH), X1, add(factors(None), I), "expected 3 entries"),
    ("slope", state("x", ">", x=UNIT), X1, slope(0, B, I, strict=1), "the end belongs"),
    ("slope", state("exp(x) - 1", ">", x=OPEN), X1, slope(0, factors(None), I, strict="2"), "a point of one symbol"),
    ("slope", state("exp(x) - 1 + 0*y", ">", x=OPEN, y=UNIT), XY, slope(0, B, I, strict="1/2"), "of one symbol"),
    ("slope", state("x**(1/2)", ">=", x=UNIT), X1, slope(0, factors(None, [1, B], None), B, continuous=[span(0)]),
     "expected 1 entries"),
    ("slope", state("2 - x**(-1/2)", ">=", x=OPEN), X1, slope(0, I, I, continuous=[span(0)]), "the end belongs"),
    ("slope", state("2 - (1 - x)**(-1/2)", ">=", x=["0", "1", ["open-high"]]), X0, slope(1, I, I,
     continuous=[equal("1 - x", span(1))]), "the end belongs"),
    ("concave", state("1 - (1 - x)**(-1/2)", ">=", x=["0", "1", ["open-high"]]), X0, concave(I, I, I,
     continuous=[equal("1 - x", span(1))]), "the end belongs"),
    ("bounded", state("1 - sin(x)", ">", x=LINE), X0, bounded(I), "the sides differ"),
    ("concave", state("1 - x**(-1/2)", ">=", x=OPEN), X1, concave(I, I, I, continuous=[span(0)]),
     "the end belongs"),
    ("derivative", state("sqrt(x)", "=", "sqrt(x) + 0*x", x=UNIT), X1, derivative(X1, I, [I], span(0)),
     "the end belongs|entries"),
    ("sum", state("x + x**2", ">", x=UNIT), X1, add(span(0), factors(None), I, strict=3), "integer from"),
    ("identity", state("x", "=", "x", x=UNIT), X1, I | {"note": "1"}, "exactly the keys"),
    ("cases", state("abs(x)", ">", x=BOTH), X1, cases("x", span(0), span(1)), "the end belongs"),
    ("slope", state("1/(1 - 2*x)", ">=", x=UNIT), X0, slope(0, signs("2*(1 - 2*x)**(-2)", None, None), B,
     continuous=[integers(0, B, B)]), "expected an integer"),
    ("concave", state("1/(1 - 2*x)", ">=", x=UNIT), X0, concave(I, B, B, continuous=[integers(0, B, B)]),
     "expected an integer"),
    ("identity", state("(a + b + c + d + 1)**20*(a - b + c - d + 1)**20", "=", **dict.fromkeys("abcd", LINE)),
     {"a": "1", "b": "1", "c": "1", "d": "1"}, I, "too many terms"),
    ("identity", state("(a + b + c + d + 1)**900", "=", **dict.fromkeys("abcd", LINE)),
     {"a": "1", "b": "1", "c": "1", "d": "1"}, I, "too many terms"),
    ("cones", state("a + b + c + d + e + f + g + h + x", ">=", **dict.fromkeys("abcdefghx", UP)),
     dict.fromkeys("abcdefghx", "1"), cones(None), "too many symbols"),
    # Sturm's chain of these needs more than three remainders.
    ("roots", state("3*x**4 - x**3 + 6*x**2 - 5*x + 1", ">", x=UNIT), X0, roots("0", "1"), "a zero|change of sign"),
    ("roots", state("3*x**4 - x**3 + 6*x**2 - 5*x + 1", ">=", x=UNIT), X0, roots("0", "1"), "a change of sign"),
    ("roots", state("2*x**5 - 2*x**4 + 5*x**3 - 5*x + 2", "!=", x=UNIT), X0, roots("0", "1"), "a zero inside"),
    ("range", state("x", ">=", x=UNIT), X1, span(2), "integer from"),
    # Where a root or an arc is defined at one point of a cell only, it has a value there.
    ("balls", state("sqrt(x)", ">=", "1", x=["0", "0", []]), X0, B, "not shown"),
    ("balls", state("asin(x)", ">=", "2", x=["1", "1", []]), X1, B, "not shown"),
    ("balls", state("asin(-x)", ">=", "0", x=["1", "1", []]), X1, B, "not shown"),
    ("balls", state("1/x", ">", x=BELOW), XB, B, "not shown"),
    ("slope", state("1 - x", ">", x=UNIT), X0, slope(1, B, I, strict=1), "the end belongs"),
    ("slope", state("x", ">", x=UNIT), X1, slope(0, B, I), "the sides differ"),
    ("slope", state("0*x", ">", x=OPEN), X1, slope(0, I, I, strict=1), "the sides differ"),
    ("slope", state("0*x", ">", x=OPEN), X1, slope(0, I, I), "the sides differ"),
    ("slope", FALLING, X1, slope(1, FALLS, B, continuous=[B, B]), "not shown"),
    ("slope", FALLING, X1, slope(1, FALLS, B, continuous=[B]), "expected 2 entries"),
    ("slope", state("tan(x)", ">=", x=["0", "3", []]), X0, slope(0, signs("cos(x)**(-2)", None), I, continuous=[B]),
     "not shown|many"),
    ("slope", state("tan(x)", ">=", x=["0", "3", []]), X0, slope(0, signs("cos(x)**(-2)", None), I),
     "expected 1 entries"),
    ("slope", state("-x", ">=", x=UNIT), X0, slope(0, B, I), "not shown"),
    ("slope", state("x - 1", ">=", x=UNIT), X1, slope(1, B, I), "not shown"),
    ("slope", state("x - 1/2", ">=", x=UNIT), X1, slope(0, B, B), "not shown"),
    ("slope", state("abs(x - abs(x)) - x", ">=", x=UNIT), X0, slope(0, B, I, smooth=[B, B]), "entries|not shown"),
    ("slope", POLE | {"symbols": {"x": HOLE}}, XB, slope(0, signs("x**(-2)", None), I, continuous=[roots("-1", "1")]),
     "a zero inside"),
    ("slope", POLE | {"symbols": {"x": HOLE}}, XB, slope(0, signs("x**(-2)", None), I), "expected 1 entries"),
    ("slope", POLE, XB, slope(0, signs("x**(-2)", None), B), "expected 1 entries"),
    ("slope", state("x", ">=", x=[None, "1", []]), X1, slope(0, B, I), "without this end"),
    ("slope", state("x", "!=", x=UNIT), X1, slope(0, B, I), "expected a symbol"),
    ("slope", state("y", ">=", x=BOTH, y=BOTH), XY, slope(0, I, by("range", symbol="y", end=0, share="1")),
     "another one"),
    ("slope", state("(x - 1/2)**2", ">=", "1/8", x=UNIT), X0, cases("x - 1/2", slope(0, given("2"), B), slope(1,
     given("2"), B)), "entries"),
    ("concave", state("x**2 - x", ">=", x=UNIT), X0, concave(B, I, I), "not shown"),
    ("concave", state("x - x**2", ">=", "1/8", x=UNIT), XH, concave(B, I, I), "the sides differ"),
    ("concave", state("x - x**2", ">", x=UNIT), XH, concave(B, I, I), "expected >="),
    ("concave", state("x - 1/2", "!=", x=UNIT), X1, concave(I, by("side", B, sign=-1), by("side", B, sign=1)),
     "expected >="),
    ("concave", state("x - x**2", ">=", x=["0", None, []]), XH, concave(B, I, I), "without an end"),
    ("concave", state("x - x**2", ">=", x=[None, "1", []]), XH, concave(B, I, I), "without an end"),
    ("concave", state("x - x**2", ">=", x=["0", "2", []]), XH, concave(B, I, I), "the sides differ"),
    ("concave", state("x - x**2", ">=", x=["-1", "1", []]), XH, concave(B, I, I), "the sides differ"),
    ("concave", state("3 - 1/x**2", ">=", x=BOTH), X1, concave(signs("6*x**(-4)", None, None), B, B),
     "expected 1 entries"),
    ("concave", state("3 - 1/x**2", ">=", x=HOLE), X1, concave(signs("6*x**(-4)", None, None), B, B,
     continuous=[roots("-1", "1")]), "a zero inside"),
    ("concave", KINK, X1, concave(I, B, B, smooth=[roots("-1", "1")]), "a zero inside|entries"),
    ("concave", KINK, X1, concave(I, B, B), "expected"),
    ("concave", state("x", ">=", x=BOTH), X1, concave(I, B), "expected 2 entries"),
    ("cones", state("x**2 - x + 1/8", ">=", x=UNIT), X0, cones(None), "a negative coefficient"),
    ("cones", state("x - y", ">=", x=UP, y=UP), XY, cones([0, 1, None, None]), "a negative coefficient"),
    ("cones", state("y - x", ">=", x=UP, y=UP), XY, cones([0, 1, None, None]), "a negative coefficient"),
    ("cones", state("x**2", ">", x=LINE), X1, cones(None, None), "it may be 0"),
    ("cones", state("x**2 + y**2", ">", x=NONZERO, y=LINE), {"x": "1", "y": "0"},
     cones(*[None] * 4) | {"splits": [None] * 3}, "expected 4"),
    ("cones", state("y**2", ">", x=NONZERO, y=LINE), XY, cones(None, None), "it may be 0"),
    ("cones", state("x", ">=", x=LINE), X1, cones(None), "expected 2 entries"),
    ("cones", state("x", ">=", x=LINE), X1, cones(None, None), "a negative coefficient"),
    ("cones", state("x - 1", ">", x=["1", None, []]), X2, cones(None), "it may be 0"),
    ("cones", state("1 - x", ">", x=[None, "1", []]), X0, cones(None), "it may be 0"),
    ("cones", state("x - 2", ">=", x=["1", None, []]), X2, cones(None), "a negative coefficient"),
    ("cones", state("1 - x", ">=", x=[None, "2", []]), X1, cones(None), "a negative coefficient"),
    ("cones", state("x*y", ">", x=["0", None, ["open-low"]], y=UP), XY, cones([0, 1, None, None]), "it may be 0"),
    ("cones", state("x + y", ">", x=UNIT, y=UNIT), XY, cones(None), "it may be 0"),
    ("cones", state("x*(1 - x)", ">", x=UNIT), XH, cones(None), "it may be 0"),
    ("cones", state("x - 3", ">=", x=["pi", None, []]), {"x": "4"}, cones(None), "an irrational end"),
    ("cones", state("3 - x", ">=", x=["0", "pi", []]), X0, cones(None), "an irrational end"),
    ("cones", state("x", ">=", x=ONE_POINT), X1, cones(None), "an empty range"),
    ("cones", state("sin(x) + 1", ">=", x=UP), X1, cones(None), "no polynomial"),
    ("cones", state("x**(-1) - 1", ">=", x=UP), X1, cones(None), "no polynomial"),
    ("cones", state("x**(1/2)", ">", x=UP), X1, cones(None), "no polynomial"),
    ("cones", state("x - y", ">=", x=UP, y=UP), XY, cones([0, 0, None, None]), "one variable"),
    ("cones", state("x - y", ">=", x=UP, y=UP), XY, cones([0, 5, None, None]), "an integer from"),
    ("cones", state("x**2", "!=", x=LINE), X1, cones(None, None), "expected >= or >"),
    ("quadratic", state("x**2 + 3*x + 1", ">=", x=LINE), X0, quadratic("1, 3, 1", B, B, B), "not shown"),
    ("quadratic", state("-x**2 - x - 1", ">=", x=LINE), X0, quadratic("-1, -1, -1", B, B, B), "not shown"),
    ("quadratic", state("-x**2", ">=", x=LINE), X1, quadratic("-1, 0, 0", B, I, I), "not shown"),
    ("quadratic", state("0*x - 1", ">=", x=LINE), X0, quadratic("0, 0, -1", I, B, I), "not shown"),
    ("quadratic", state("x**2 + 2*x + 1", ">", x=LINE), X0, quadratic("1, 2, 1", B, B, I), "the sides differ"),
    ("quadratic", state("x**2 - 1", ">=", x=LINE), X2, quadratic("1, 0, 1", B, B, B), "the term is another one"),
    ("quadratic", state("x**2 - 2*x", ">=", x=LINE), X2, quadratic("1, 0, 1 - 2*x", B, B, B),
     "the symbol in a coefficient"),
    ("quadratic", state("x**2 + 3*x + 1", "!=", x=LINE), X1, quadratic("1, 3, 1", B, B, by("side", B, sign=-1)),
     "expected >= or >"),
    ("quadratic", state("0*x + y + 3/5", ">=", x=LINE, y=LONG), XY, quadratic("0, 0, y + 3/5 + 0*sqrt(y)", I, B, I),
     "1 entries"),
    ("roots", state("1/2", ">=", "x", x=UNIT), X0, roots("0", "1"), "a change of sign"),
    ("roots", state("(x - 1/2)*(x - 1/3)", ">=", x=UNIT), X1, roots("0", "1"), "a change of sign"),
    ("roots", state("(x - 1/2)**3*(x - 1/3)", ">=", x=UNIT), X1, roots("0", "1"), "a change of sign"),
    ("roots", state("(x - 1/2)**2", ">", x=UNIT), X1, roots("0", "1"), "a zero inside"),
    ("roots", state("x", ">", x=UNIT), X1, roots("0", "1"), "a zero at an end"),
    ("roots", state("1 - x", ">", x=OPEN), XH, roots("0", "1"), "a zero at an end"),
    ("roots", state("x", ">=", "1/4", x=UNIT), X1, roots("1/4", "1"), "an end inside the range"),
    ("roots", state("3/4 - x", ">=", x=UNIT), X0, roots("0", "3/4"), "an end inside the range"),
    ("roots", state("x", ">=", x=LINE), X1, roots("0", None), "an end inside the range"),
    ("roots", state("-x", ">=", x=LINE), X0, roots(None, "0"), "an end inside the range"),
    ("roots", state("-x**2 - 1", ">=", x=LINE), X0, roots(None, None), "the wrong sign"),
    ("roots", state("-x**2", ">=", x=UNIT), X0, roots("0", "1"), "the wrong sign"),
    ("roots", state("x**3 - 5*x - 1", ">=", x=["1", None, []]), {"x": "3"}, roots("1", None),
     "the wrong sign|a change"),
    ("roots", state("x + 5", ">=", x=[None, "0", []]), X0, roots(None, "0"), "a change of sign"),
    ("roots", state("5 - x", ">=", x=["0", None, []]), X0, roots("0", None), "a change of sign"),
    ("roots", state("-1/x", ">=", x=HOLE), XB, roots("-1", "1"), "a change of sign"),
    ("roots", state("(x - 1)**2", ">", x=["0", "2", [HOLED]]), X2, roots("0", "2"), "a zero inside"),
    ("roots", state("x**2", ">", x=["0", "2", ["open-high"]]), X1, roots("-1", "2"), "a zero inside"),
    ("roots", state("x", "!=", x=BOTH), X1, roots("-1", "1"), "a zero inside"),
    ("roots", state("x", "!=", x=UNIT), X1, roots("0", "1"), "a zero at an end"),
    ("roots", state("x**2 + 1", "=", x=UNIT), X1, roots("0", "1"), "expected an inequality"),
    ("roots", state("0*x", "!=", x=UNIT), X1, roots("0", "1"), "expected an inequality"),
    ("roots", state("sin(x) + 1", ">=", x=UNIT), X1, roots("0", "1"), "no rational function"),
    ("roots", state("x**2 + 1", ">", x=["1", "1", []]), X1, roots("1", "1"), "an empty range"),
    ("roots", state("x + y", ">=", x=UNIT, y=UNIT), XY, roots("0", "1"), "malformed"),
]
# fmt: on


# The rules of hypotheses
# fmt: off
TRUE += [
    ("modulo", stated("x**2", "=", "4", given=["x = 2"], x=LINE), {"x": "2"}, modulo("0", I, "x + 2")),
    ("modulo", stated("x**2", ">", "3", given=["x = 2"], x=LINE), {"x": "2"}, modulo("1", B, "x + 2")),
    ("modulo", stated("x", "=", "y", given=["x*y = 1", "y**2 = 1"], x=LINE, y=LINE), XY, modulo("0", I, "y", "-x",
     defined=())),
    ("modulo", stated("1/x", "=", "y", given=["x*y = 1"], x=LINE, y=LINE), XY, modulo("0", I, "-1/x")),
    ("between", stated("x", "=", "0", given=["x >= 0", "-x >= 0"], x=LINE), X0, between(given("1", "0"), given("0",
     "1"))),
]
HOSTILE += [
    ("modulo", stated("x**2", "=", "4", given=["x = 2"], x=LINE), {"x": "2"}, modulo("0", I, "x - 2"),
     "terms differ"),
    ("modulo", stated("x**2", "=", "4", given=["x = 2"], x=LINE), {"x": "2"}, modulo("0", I), "expected 1 entries"),
    ("modulo", stated("x", "=", "4", given=["x**2 = 16"], x=LINE), {"x": "4"}, modulo("0", I, "1/(x + 4)"),
     "expected 1 entries"),
    ("modulo", state("x", "=", "4", x=LINE), {"x": "4"}, modulo("0", I), "the terms differ"),
    ("modulo", stated("x", "=", "4", given=["x >= 4"], x=LINE), {"x": "4"}, modulo("0", I, "1"),
     "expected a list of entries"),
    ("modulo", stated("x", "=", "3", given=["x - x = 1"], x=LINE), {"x": "3"}, modulo("0", I, "-(x - 3)"),
     "no value at the witness"),
    ("modulo", stated("x", "=", "y", given=["x = 2"], x=LINE, y=LINE), {"x": "2", "y": "2"}, modulo("0", I, "1 - z"),
     "the terms differ"),
    ("between", state("x", "=", x=UNIT), X0, between(span(0), span(1)), "the term is another one"),
    ("between", state("x", ">=", x=UNIT), X0, between(span(0), span(0)), "expected an equation"),
    ("slope", stated("x", ">=", "1", given=["x = 1"], x=["0", "2", []]), X1, slope(0, B, modulo("0", I, "1")),
     "expected a list of entries"),
    ("dense", stated("(x - 1)**2", ">=", "0", given=["x = 1"], x=LINE), X1, dense("x", {"x": "1"}, modulo("0", I,
     "x - 1")), "expected a list of entries"),
    ("derivative", stated("x", "=", "1", given=["x = 1"], x=LINE), X1, derivative({"x": "1"}, I, [modulo("0", I,
     "1")]), "expected a list of entries"),
    ("corners", stated("x - 1", ">=", "0", given=["x = 1"], x=["0", "2", []]), X1, corners(["x"], modulo("0", I, "1"),
     B), "expected a list of entries"),
]
# fmt: on


# What is no statement or no witness, and points that refute or do not
# fmt: off
WITNESSES = [
    (SQUARE, X0, by("unheard-of"), "a known rule"),
    (SQUARE, X0, ["identity"], "a known rule"),
    (state("x", "=", "x", x=["0", "log(-1)", []]), X0, I, "may not exist"),
    (state("x", "=", "x", x=["0", "sqrt(-1)*0", []]), X0, I, "may not exist"),
    (state("x", "=", "x", x=["0", "x", []]), X0, I, "a symbol in the end"),
    (state("x", "=", "x", x=["0", "1", ["open"]]), X0, I, "an unknown flag"),
    (state("x", "=", "x", y=UNIT), {"y": "0"}, I, "a symbol without a range"),
    (state("x", "<>", "x", x=UNIT), X0, I, "an unknown relation"),
    (state("x", ">=", tolerance="1", x=UNIT), X0, I, "a tolerance of an inequality"),
    (state("x", "=", tolerance="1/2", x=UNIT) | {"tolerance": "-1"}, X0, I, "expected 2 entries"),
    (state("x", "=", "x", pi=UNIT), {"pi": "0"}, I, "or pi"),
    (state("x", "=", "x", x=UNIT), X2, I, "outside the box"),
    (state("x", "=", "x", x=OPEN), X0, I, "outside the box"),
    (state("x", "=", "x", x=["0", "1", ["open-high"]]), X1, I, "outside the box"),
    (state("x", "=", "x", x=NONZERO), X0, I, "outside the box"),
    (state("x", "=", "x", x=COUNT), XH, I, "outside the box"),
    (state("x", "=", "x", x=COUNT), {"x": "sqrt(2)"}, I, "outside the box"),
    (state("x", "=", "x", x=LINE), {}, I, "every symbol"),
    (state("x", "=", "x", x=LINE), {"x": "x"}, I, "expected a number"),
    (state("x", "=", "x", x=LINE), {"x": "1/0"}, I, "may not exist|division"),
    (state("1/x", "=", "1/x", x=LINE), X0, I, "no value at the witness"),
    (state("x", "=", "x", exists=["log(x)"], x=LINE), XB, I, "no value at the witness"),
    (state("0*log(-1 - x**2)", "=", x=LINE), X0, I, "no value at the witness"),
    (state("x**0", "=", "1", x=LINE), X0, I, "no value at the witness"),
    (state("atan2(0*x, x)", "=", "atan2(0*x, x)", x=LINE), X0, I, "no value at the witness"),
    (state("x", "=", tolerance="1", x=LINE), X0, I, "expected 2 entries"),
]
# fmt: on
# fmt: off
FAILS = [
    (state("x", "=", "1", x=LINE), X0, None),
    (state("x", "!=", "1", x=LINE), X1, None),
    (state("sin(x)", "!=", x=LINE), {"x": "pi"}, I),
    (state("x", ">", "1", x=TWO), X1, None),
    (state("x", "<", "1", x=TWO), X1, None),
    (state("x", ">=", "1", x=LINE), X0, None),
    (state("x", "<=", "1", x=LINE), X2, None),
    (state("cos(x)**2", ">", x=LINE), {"x": "pi/2"}, I),
    (state("x", "=", tolerance="1/2", x=LINE), X1, None),
    (state("x", "=", tolerance="1/2", x=LINE), XB, None),
    (state("x", "<", "2", x=["0", "2", []]), X2, None),
]
# fmt: on
# fmt: off
STANDS = [
    (state("x", ">", x=TWO), {"x": "1.5**(1 + 0*log(-1))"}, multiply(NOWHERE, B), "may not exist"),
    (state("x", ">", x=TWO), X0, None, "outside the box"),
    (state("x", "!=", x=NONZERO), X0, None, "outside the box"),
    (state("x", ">", x=OPEN), X0, None, "outside the box"),
    (state("x", "<", "1", x=["0", "1", ["open-high"]]), X1, None, "outside the box"),
    (state("x", "!=", "1/2", x=["0", "1", ["integer"]]), XH, None, "outside the box"),
    (state("x*x**0", "!=", x=UNIT), X0, None, "no value at the point"),
    (state("x**2", ">=", x=LINE), X0, I, "allows 0"),
    (state("x", "=", "x", x=LINE), X0, I, "allows 0"),
    (state("x", "=", "x", x=LINE), X0, None, "not seen to fail"),
    (state("x", ">", x=UNIT), X1, None, "not seen to fail"),
    (state("x", ">=", x=UNIT), X0, None, "not seen to fail"),
    (state("x", "!=", x=UNIT), X1, None, "not seen to fail"),
    (state("x", ">", x=UNIT), X1, I, "the sides differ"),
    (state("x", "=", tolerance="1", x=UNIT), X1, None, "not seen to fail"),
    (state("sin(x)", ">", "-1/10**40", x=LINE), {"x": "pi"}, None, "not seen to fail"),
    (state("x", ">", exists=["1/x"], x=UNIT), X0, None, "no value at the point"),
]
# fmt: on


def answer(module: Any, statement: Any, item: Any) -> str:
    """The verdict, or the reason of a refusal."""
    try:
        return str(module.grant(statement, item))
    except module.Refused as why:
        return str(why)


def discrepancies(module: Any, reasons: bool = True, first: str = "") -> Iterator[str]:
    """What a module answers otherwise than it must; without reasons only its verdicts count.

    The rows of the first rule come before the others.
    """
    from tests.checker import language  # its rows are made of these

    hostile = [(s, prove(s, at, proof), why) for _, s, at, proof, why in sorted(HOSTILE, key=lambda r: r[0] != first)]
    of_the_rule = sum(row[0] == first for row in HOSTILE)
    yield from granted(module, hostile[:of_the_rule], reasons)
    for rule, statement, witness, proof in sorted(TRUE, key=lambda row: row[0] != first):
        if answer(module, statement, prove(statement, witness, proof)) != "HOLDS":
            yield f"refused by {rule}: {statement}"
    for statement, point, zero in FAILS:
        if answer(module, statement, refute(statement, point, zero)) != "FAILS":
            yield f"not refuted: {statement}"
    hostile += [(s, prove(s, at, proof), why) for s, at, proof, why in WITNESSES]
    hostile += [(s, refute(s, at, zero), why) for s, at, zero, why in STANDS]
    hostile += [(s, prove(s, {}, I), why) for s, why in language.MEANINGLESS]
    hostile += [(s, prove(s, at, *proofs), why) for s, at, proofs, why in language.NOWHERE_DEFINED]
    hostile += [(s, refute(s, at, zero), why) for s, at, zero, why in language.LANGUAGE_STANDS]
    yield from granted(module, hostile[of_the_rule:], reasons)
    for statements, item, expected in language.GRANTS:
        found = answer(module, statements, item)
        if not re.search(expected, found):
            yield f"{found}, not {expected}: {statements}"
    for statement, at, proofs, is_true in language.list_language():
        found = answer(module, statement, prove(statement, at, *proofs))
        if (found == "HOLDS") != is_true:
            yield f"{found}: {statement}"
    for statement, point, zero in language.LANGUAGE_FAILS:
        if answer(module, statement, refute(statement, point, zero)) != "FAILS":
            yield f"not refuted: {statement}"


def granted(module: Any, hostile: list[Any], reasons: bool) -> Iterator[str]:
    """Rows that the module grants, or refuses for another reason."""
    for statement, item, why in hostile:
        given_answer = answer(module, statement, item)
        if given_answer in ("HOLDS", "FAILS") or (reasons and not re.search(why, given_answer)):
            yield f"{given_answer}, not {why}: {statement} {item}"
