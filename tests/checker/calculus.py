"""Integrals, sums, products, limits, orders and exponentials: true answers, and answers that lack a hypothesis.

A row is (statement, witness, answers, proofs, reason): it holds where the reason is empty, else it is refused for it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from tests.checker.proofs import (
    LINE,
    TWO,
    UNIT,
    UP,
    X1,
    XY,
    B,
    I,
    abstract,
    answer,
    by,
    equal,
    modulo,
    multiply,
    prove,
    refute,
    roots,
    signs,
    span,
    squares,
    state,
    stated,
)  # fmt: skip

WHOLE, POSITIVE, COUNT = [None, None, ["integer"]], ["0", None, ["open-low"]], ["1", None, ["integer"]]
GROWTH: dict[str, Any] = {"signs": []}
ROOTS = by("roots", **{"from": None, "to": None})


def piece(antiderivative: str, limits=(0, 0), continuous=(), smooth=(), same=None, signs=()) -> dict[str, Any]:
    proofs = {"continuous": [*continuous], "smooth": [*smooth], "equal": same, "signs": [*signs]}
    return {"antiderivative": antiderivative, "limits": [*limits]} | proofs


def integral(*pieces: Any, cuts=()) -> dict[str, Any]:
    return {"cuts": [*cuts], "pieces": [*pieces]}


def sum_by(telescoper: str, defined=(), same=None, start=(), count=None, signs=()) -> dict[str, Any]:
    proofs = {"defined": [*defined], "equal": same, "start": [*start], "count": count, "signs": [*signs]}
    return {"telescoper": telescoper} | proofs


def taylor(top, bottom, order=0, defined=(), zeros=(), pole=(), around=(), signs=()) -> dict[str, Any]:
    proofs = {"defined": defined, "zeros": zeros, "pole": pole, "around": around, "signs": signs}
    return {"top": top, "bottom": bottom, "order": order} | {key: [*value] for key, value in proofs.items()}


def row(left, right, answers, why="", witness=None, proofs=(I,), relation="=", **symbols):
    return state(left, relation, right, **symbols), witness or {}, answers, proofs, why


def grows(left, right, why="", signs=(), **symbols):
    """A limit at infinity by growth."""
    witness = dict.fromkeys(symbols, "1")
    return row(f"limit({left}, x, oo)", right, [{"signs": [*signs]}], why, witness, **symbols)


NUMBER = (2, {"a": LINE})
LIMITS = [
    grows("x/(x + 1)", "1"),
    grows("2*x**2/(x - x**2)", "-2"),
    grows("exp(-1/x)", "1"),
    grows("cos(1/x)", "1"),
    grows("sin(2/x)*x", "2"),
    grows("atan(2/x)*x", "2"),
    grows("tanh(2/x)*x", "2"),
    grows("erf(1/x)*x", "2*pi**(-1/2)"),
    grows("erf(1/x)*x", "2*pi**(1/2)", "the sides differ"),
    grows("erf(1/x)", "0"),
    grows("exp(x/(x + 1))", "exp(1)"),
    grows("cos(x/(x + 1))", "cos(1)"),
    grows("erf(x/(x + 1))", "erf(1)"),
    grows("abs(1 - x)/x", "1"),
    grows("log(2*x/(x + 1))", "log(2)"),
    grows("log(2*x/(x + 1))/x", "0"),
    grows("log(x)/x", "0"),
    grows("log(1/x)/x", "0"),
    grows("sqrt(4*x**2 + 1)/x", "2"),
    grows("(4*x**2 + 1)**(-1/2)*x", "1/2"),
    grows("(1 - x)**(-1)*x", "-1"),
    grows("tan(1/x)*x", "1"),
    grows("sinh(1/x) + cosh(1/x)", "1"),
    grows("exp(-x**2)*x**9", "0"),
    grows("sin(x)/x", "0"),
    grows("sin(x)", "0", "no limit is known"),
    grows("abs(sin(x))", "0", "no limit is known"),
    grows("exp(sin(x))", "1", "no limit is known"),
    grows("exp(sin(x))/x", "0"),
    grows("exp(x)", "0", "an exponential that may grow"),
    grows("exp(x*sin(x))/x", "0", "no growth is known"),
    grows("atan(x*sin(x))/x", "0", "no growth is known"),
    grows("1/sin(x)", "0", "it may have no value"),
    grows("log(-x)/x", "0", "it may have no value"),
    grows("sqrt(-x)/x", "0", "it may have no value"),
    grows("sqrt(sin(x))/x", "0", "it may have no value"),
    grows("1/(x - x)", "0", "expected a sign|division by zero"),
    grows("asin(1/x)", "0", "no growth is known"),
    grows("x + oo", "0", "no limit is known"),
    # log(x) counts as x**(1/1000), exp(-x) as x**(-10**9).
    grows("log(x)*x**(-1/999)", "0"),
    grows("log(x)*x**(-1/1000)", "0", "no limit is known"),
    grows("exp(-x)*x**999999999", "0"),
    grows("exp(-x)*x**1000000000", "0", "no limit is known"),
    # A sign by its proof, and by another one.
    grows("atan(a*x)", "pi/2", "", [[1, span(0, symbol="a")]], a=POSITIVE),
    grows("atan(-a*x)", "-pi/2", "", [[-1, equal("a", span(0, symbol="a"))]], a=POSITIVE),
    grows("atan(a*x)", "-pi/2", "the term is another one", [[-1, span(0, symbol="a")]], a=POSITIVE),
    grows("atan(a*x)", "pi/2", "expected a sign", [[0, span(0, symbol="a")]], a=POSITIVE),
    grows("atan(a*x)", "pi/2", "integer from", [[2, span(0, symbol="a")]], a=POSITIVE),
    grows("atan(a*x)", "-pi/2", "integer from", [[-2, span(0, symbol="a")]], a=POSITIVE),
    grows("atan(a*x)", "pi/2", "expected 2 entries", [[1, span(0, symbol="a"), 1]], a=POSITIVE),
    grows("atan(a*x)", "pi/2", "expected a sign with its proof", a=POSITIVE),
    grows("atan(a*x)", "pi/2", "the end belongs", [[1, span(0, symbol="a")]], a=UP),
    grows("atan(3*x)", "pi/2", "a sign too many", [[1, B]]),
    row("limit(atan(x), x, -oo)", "-pi/2", [GROWTH]),
    row("limit(x, x, 1)", "1", [GROWTH], "expected oo"),
    row("limit(x**2, x, 3)", "9", [taylor("x__1**2", "1", pole=[B])]),
    row("limit(x**2, x, 3)", "9", [taylor("x__1**3", "x__1", pole=[B])]),
    row("limit(x**2, x, 3)", "9", [taylor("x__1**2", "1", pole=[B], signs=[[1, B]])], "a sign too many"),
    row("limit(sin(x)/x, x, 0)", "1", [taylor("sin(x__1)", "x__1", 1, zeros=[I, I], pole=[B, B], around=[1])]),
    row("limit(1/x, x, oo)", "0", [taylor("x__1", "1", pole=[B])]),
    row("limit(1/x, x, -oo)", "0", [taylor("-x__1", "1", pole=[B])]),
    row("limit(1/x, x, 0)", "0", [taylor("1", "x__1", pole=[B, B], around=[1])], "the bound is not shown"),
    # sqrt(x) has no values to the left of 0, log(x)/log(x) none there: the limit from both sides does not exist.
    row("limit(sqrt(x), x, 0)", "0", [taylor("sqrt(x__1)", "1", pole=[B, B], around=[0])], "entries|not shown"),
    row(
        "limit(x*log(x)/log(x), x, 0)", "0", [taylor("x__1", "1", pole=[B] * 3, around=[1, 1])], "a sign on both sides"
    ),
    row("limit(x*sqrt(x)/sqrt(x), x, 0)", "0", [taylor("x__1", "1", pole=[B] * 3, around=[1, 1])], "on both sides"),
    row("limit(abs(x)/x, x, 0)", "1", [taylor("abs(x__1)", "x__1", 1, zeros=[I, I], pole=[B, B], around=[1])], "entr"),
    row("limit(x**9*abs(x), x, 0)", "0", [taylor("x__1**9*abs(x__1)", "1", pole=[B])], "entries"),
    row(
        "limit(sin(x)**9/x**9, x, 0)",
        "1",
        [taylor("sin(x__1)**9", "x__1**9", 9, zeros=[I] * 18, pole=[B, B], around=[9])],
        "integer from 0 to 8",
    ),
    row("limit(1/x**9, x, 1)", "1", [taylor("1", "x__1**9", pole=[B, B], around=[9])], "integer from 0 to 8"),
    row("limit(x, x, 1)", "1", [taylor("x__1", "1", 9)], "integer from 0 to 8"),
    row("limit(1/x, x, -1)", "-1", [taylor("1", "x__1", pole=[B, B], around=[0])]),
    row("limit(log(x), x, 2)", "log(2)", [taylor("log(x__1)", "1", pole=[B, B], around=[0])]),
]
NATURAL = by("product", factors=[None])
AT_0 = [by("range", symbol="x__1", end=0, share="1")]
ABOVE = by("sum", proofs=[B, by("range", symbol="x__1", end=0, share="1")], strict=0)
APART = by("product", factors=[[1, by("side", ABOVE, sign=1)], [1, by("side", by("bounded", B), sign=1)]])
INTEGRALS = [
    row("integral(x**2, x, 0, 1)", "1/3", [integral(piece("x__1**3/3"))]),
    row("integral(x**2, x, 1, 0)", "-1/3", [integral(piece("x__1**3/3"))]),
    row("integral(cos(x), x, 0, 1)", "sin(1)", [integral(piece("sin(x__1)"), piece("sin(x__1)"), cuts=["1/2"])]),
    row("integral(exp(-x), x, 0, oo)", "1", [integral(piece("-exp(-x__1)", (0, 1)))]),
    row("integral(exp(x), x, -oo, 0)", "1", [integral(piece("exp(x__1)", (1, 0)))]),
    row("integral(exp(x), x, 0, -oo)", "-1", [integral(piece("exp(x__1)", (0, 1)))], "a range that ends at -oo"),
    row("integral(exp(-x), x, oo, 0)", "-1", [integral(piece("-exp(-x__1)", (1, 0)))], "a range that begins at oo"),
    row("integral(exp(-x**2)*x, x, -oo, oo)", "0", [integral(piece("-exp(-x__1**2)/2", (1, 1)))], "expected a cut"),
    row(
        "integral(x*exp(-x**2), x, -oo, oo)",
        "0",
        [integral(piece("-exp(-x__1**2)/2", (1, 0)), piece("-exp(-x__1**2)/2", (0, 1)), cuts=["0"])],
    ),
    # Roots at an end, where the integrand has no value.
    row("integral(x**(-1/2), x, 0, 1)", "2", [integral(piece("2*x__1**(1/2)", (1, 0), AT_0, AT_0))]),
    row("integral(x**(-1/2), x, 0, 1)", "2", [integral(piece("2*x__1**(1/2)", (1, 0), AT_0))], "expected 1 entries"),
    # F = 1/(x (2 + sin x)) has the limit 0, and 1/(x (sin x + 1 + exp(-x))) none: of 2 + sin x no limit is known.
    row(
        "integral(-(2 + sin(x) + x*cos(x))*(x*(2 + sin(x)))**(-2), x, 1, oo)",
        "-1/(2 + sin(1))",
        [integral(piece("(x__1*(2 + sin(x__1)))**(-1)", (0, 1), [APART], [APART]))],
        "a power that may have no value",
    ),
    # Poles: -1/x and log(x**2)/2 are no antiderivatives over 0, and 1/x**2 has no integral from 0.
    row("integral(1/x**2, x, -1, 1)", "-2", [integral(piece("-1/x__1"))], "expected 1 entries"),
    row("integral(1/x**2, x, -1, 1)", "-2", [integral(piece("-1/x__1", continuous=[B]))], "not shown"),
    row("integral(1/x**2, x, -1, 1)", "-2", [integral(piece("-1/x__1", (1, 1), [B], [B]))], "not shown"),
    row(
        "integral(1/x**2, x, -1, 1)",
        "-2",
        [integral(piece("-1/x__1", (0, 0), [B], [B]), piece("-1/x__1", (0, 0), [B], [B]), cuts=["0"])],
        "not shown",
    ),
    # A step at 0 has the derivative 0: it is not continuous on the whole range.
    row(
        "integral(0*x, x, -1, 1)",
        "2",
        [integral(piece("abs(x__1)/x__1", continuous=[B], smooth=[B], same=I))],
        "not shown|the sides differ",
    ),
    row("integral(0*x, x, -1, 1)", "2", [integral(piece("abs(x__1)/x__1"))], "the terms differ|expected 1 entries"),
    row("integral(1, x, 0, 2)", "1", [integral(piece("atan2(sin(x__1), cos(x__1))/2 + x__1/2"))], "entries"),
    row("integral(x/abs(x), x, -1, 1)", "0", [integral(piece("abs(x__1)"))], "expected . entries"),
    row("integral(1, x, 0, 1)", "1", [integral(piece("x__1", signs=[[1, B]]))], "a sign too many"),
    row("integral(1, x, 0, 1)", "1", [integral(piece("x__1", (2, 0)))], "integer from 0 to 1"),
    row("integral(1, x, 0, oo)", "1", [integral(piece("x__1", (0, 1)))], "no limit is known"),
    row("integral(2*x, x, 0, 1)", "1", [integral(piece("x__1**2 + x__1", same=B))], "expected an inequality"),
    row("integral(2*x, x, 0, 1)", "2", [integral(piece("x__1**2 + x__1", same=I))], "the sides differ"),
    row("integral(1, x, 0, 1) + 0*integral(x, x, 0, 1)", "1", [integral(piece("x__1"))], "without an answer"),
    row("x", "x", [integral(piece("x__1"))], "an answer without a question", {"x": "1"}, x=LINE),
    row("integral(oo*x, x, 0, 1)", "0", [integral(piece("oo*x__1**2/2"))], "a symbol without a range"),
    row("integral(x, x, 0, 2*oo)", "0", [integral(piece("x__1**2/2", (0, 1)))], "a sum or product with oo"),
    row("integral(1, x, 0, 1)", "1", [integral(piece("x__1"))], "a name that is in use", {"x__1": "1"}, x__1=LINE),
    row("integral(1, x, 0, 1)", "1", [integral(piece("x__1"))], "a name that is in use", {"oo": "1"}, oo=LINE),
    row("integral(where(x = 0, 1, 2), x, 0, 1)", "2", [integral(piece("2*x__1"))], "cases of a bound variable"),
    row("integral(where(x > 0, log(a), 2), x, 0, 1)", "2", [integral(piece("2*x__1"))], "may have no value", a=LINE),
    row("integral(min(x, 2), x, 0, 1)", "1", [integral(piece("x__1**2/2"))], "expected 1 entries"),
    # What is typed inside has to have a value; where it has none the statement says nothing.
    row("integral(log(a)*x, x, 0, 1)", "log(a)/2", [integral(piece("log(a)*x__1**2/2"))], "", {"a": "1"}, a=LINE),
    row("integral(0*log(a)*x, x, 0, 1)", "0", [integral(piece("0"))], "no value at the witness", {"a": "-1"}, a=LINE),
    row("integral(0/x, x, -1, 1)", "0", [integral(piece("0"))], "expected 1 entries"),
    row("integral([x, a], x, 0, 1)", "[1/2, a]", [
        integral(piece("x__1**2/2")), integral(piece("a*x__1")),
    ], "", {"a": "1"}, (I, I), a=LINE),
    row("integral([x, 1], x, 0, 1)", "[1/2, 1]", [integral(piece("x__1**2/2"))], "without an answer", proofs=(I, I)),
    row("integral([1/x, 1], x, 0, 1)[2]", "1", [integral(piece("log(x__1)")), integral(piece("x__1"))], "entries"),
    row("integral([0/x, 1], x, 0, 1)[2]", "1", [integral(piece("0")), integral(piece("x__1"))], "entries"),
    row("integral([integral(y, y, 0, x), x], x, 0, 1)", "[1/6, 1/2]", [
        integral(piece("y__1**2/2")), integral(piece("x__2**3/6")), integral(piece("x__2**2/2")),
    ], "", {}, (I, I)),
    row("integral(exp(-x)*integral(y, y, 0, 1), x, 0, oo)", "1/2", [
        integral(piece("y__1**2/2")), integral(piece("-exp(-x__2)/2", (0, 1))),
    ]),
    row("integral(x*integral(y, y, 0, 1), x, 0, a)", "a**2/4", [
        integral(piece("y__1**2/2")), integral(piece("x__2**2/4")),
    ], "", {"a": "1"}, a=LINE),
    row("integral(sum(1, k, 1, x), x, 0, 2)", "2", [
        sum_by("k__1", count=I), integral(piece("x__2**2/2")),
    ], "whole ends"),
    # exp(-x**2) is bounded by every power, 1/exp(-x**2) by none.
    row("integral((2*x - 2)*exp(x**2 - 2*x), x, 0, oo)", "-1", [
        integral(piece("exp(-x__1**2)**(-1)*exp(-x__1)**2", (0, 1), [NATURAL], [NATURAL])),
    ], "a power that may have no value|entries"),
    row("integral(x*integral(y, y, 0, x), x, 0, 2)", "2", [
        integral(piece("y__1**2/2")), integral(piece("x__2**4/8")),
    ]),
    row("integral(integral(1/(x + y), y, 1, 2), x, 0, 1)", "0", [
        integral(piece("log(x__2 + y__1)", (0, 0), [B], [B])), integral(piece("0")),
    ], "expected 2 entries"),
    row("integral(integral(1/(x + y), y, 1, 2), x, -2, 1)", "0", [
        integral(piece("log(x__2 + y__1)", (0, 0), [B], [B])), integral(piece("0")),
    ], "not shown"),
]  # fmt: skip
FROM_1 = equal("n", ROOTS | {"from": "1"})
NUMBERS = sum_by("k__1*(k__1 - 1)/2", count=FROM_1)
SUMS = [
    row("sum(k, k, 1, n)", "n*(n + 1)/2", [NUMBERS], "", {"n": "1"}, n=COUNT),
    row("sum(k, k, 1, n)", "n*(n + 1)/2", [NUMBERS | {"count": I}], "the sides differ", {"n": "1"}, n=COUNT),
    row("sum(k, k, 1, n)", "n*(n + 1)/2", [NUMBERS | {"count": ROOTS}], "wrong sign|of sign", {"n": "1"}, n=WHOLE),
    row("sum(k, k, a, 3)", "0", [sum_by("k__1*(k__1 - 1)/2")], "whole ends", {"a": "1"}, a=LINE),
    row("sum(k, k, 1, a)", "0", [sum_by("k__1*(k__1 - 1)/2")], "whole ends", {"a": "1"}, a=LINE),
    row("sum(k, k, 1, 1/2)", "0", [], "whole ends"),
    row("sum(k, k, 1/2, 2)", "0", [], "whole ends"),
    row("sum(k, k, 1, n)", "n*(n + 1)/2", ["terms"], "whole ends", {"n": "1"}, n=COUNT),
    row("sum([k, 1], k, 1, 3)", "[6, 3]", [], proofs=(I, I)),
    row("product([k, 1], k, 1, 3)", "[6, 1]", [], "expected a number", proofs=(I, I)),
    row("product([k, 1], k, 1, n)", "[6, 1]", [], "expected a number", {"n": "1"}, (I, I), n=COUNT),
    row("sum(k, k, 1, 3) + product(k, k, 1, 3)", "12", []),
    row("sum(k, k, 2, 1) + product(k, k, 2, 1)", "1", []),
    row("sum(0*k, k, 1, 400)", "0", []),
    row("sum(0*k, k, 1, 401)", "0", [], "too many terms"),
    row("sum(0/k, k, 0, 3)", "0", [], "no value at the witness"),
    row("sum(k, k, 1, -oo)", "0", [sum_by("k__1*(k__1 - 1)/2")], "a sum to -oo|whole ends"),
    row("sum(k, k, -oo, 1)", "0", [sum_by("k__1*(k__1 - 1)/2")], "whole ends"),
    row("sum(1/(k*(k + 1)), k, 1, oo)", "1", [sum_by("-1/k__1", [ROOTS | {"from": "0"}] * 0)], "entries"),
    row("sum(1/2**(0*k)*0, k, 1, oo)", "0", [sum_by("0", signs=[[1, B]])], "a sign too many"),
    row("sum(0*k, k, 1, oo)", "0", [sum_by("0", count=I)], "a sum to -oo"),
    row("sum(0*k, k, 1, oo)", "0", [sum_by("0")]),
    row("sum(0/k, k, -1, oo)", "0", [sum_by("0")], "entries"),
    row("product(1 + 0*k, k, 1, n)", "1", [sum_by("1", count=FROM_1)], "", {"n": "1"}, n=COUNT),
    # G = 0 has G(k + 1) = f(k) G(k) for every f.
    row("product(k, k, 1, n)", "0", [sum_by("0", count=FROM_1)], "entries|division",
        {"n": "1"}, n=COUNT),
    row("product(k, k, 1, n)", "0", [sum_by("0*k__1", start=[B], count=FROM_1)], "not shown",
        {"n": "1"}, n=COUNT),
]  # fmt: skip
ONE_BY = {"rows": [["exp(s__1)"]], "smooth": [], "equal": [None], "start": [None]}
TURN_BY = {
    "rows": [["cos(a*s__1)", "sin(a*s__1)"], ["-sin(a*s__1)", "cos(a*s__1)"]],
    "smooth": [], "equal": [None] * 4, "start": [None] * 4,
}  # fmt: skip


def change(item: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return item | changes


def exponential(text, right, item, why="", *names, **symbols):
    count = 1 if "[1" in text else 4
    statement = stated(text, "=", right, **symbols)
    return statement, dict.fromkeys(symbols, "1"), [item], [I] * count, why


EXPONENTIALS = [
    exponential("expm([[1]])", "[[exp(1)]]", ONE_BY),
    exponential("expm([[1]])", "[[exp(1)]]", change(ONE_BY, rows=[["exp(2*s__1)"]]), "the terms differ"),
    exponential("expm([[1]])", "[[2*exp(1)]]", change(ONE_BY, rows=[["2*exp(s__1)"]]), "the terms differ"),
    exponential("expm([[1]])", "[[exp(2)]]", change(ONE_BY, rows=[["exp(2*s__1)"]], equal=[I]), "the sides differ"),
    exponential("expm([[1]])", "[[2*exp(1)]]", change(ONE_BY, rows=[["2*exp(s__1)"]], start=[I]), "the sides differ"),
    exponential("expm([[1]])", "[[exp(1)]]", change(ONE_BY, rows=[["exp(abs(s__1))"]]), "expected 1 entries"),
    exponential("expm([[1]])", "[[exp(1)]]", change(ONE_BY, rows=[["exp(s__1)"], ["1"]]), "expected 1 entries"),
    # A slope that is 0 at both ends only, and one that has no value at the end.
    exponential(
        "expm([[0]])",
        "[[2]]",
        {
            "rows": [["1 + 3*s__1**2 - 2*s__1**3"]],
            "smooth": [],
            "equal": [by("integers", symbol="s__1", **{"from": 0}, proofs=[I, I])],
            "start": [None],
        },
        "expected an integer",
    ),
    exponential(
        "expm([[1]])",
        "[[exp(1)]]",
        change(ONE_BY, rows=[["exp(s__1) + 0*log(1 - s__1)"]], smooth=[by("range", symbol="s__1", end=1, share="1")]),
        "the end belongs",
    ),
    exponential("expm([[0, a], [-a, 0]])", "[[cos(a), sin(a)], [-sin(a), cos(a)]]", TURN_BY, a=LINE),
    exponential(
        "expm([[0, a], [-a, 0]])", "[[cos(a), -sin(a)], [sin(a), cos(a)]]", TURN_BY, "the sides differ", a=LINE
    ),
    exponential(
        "expm([[0, -a], [a, 0]])", "[[cos(a), sin(a)], [-sin(a), cos(a)]]", TURN_BY, "the terms differ", a=LINE
    ),
]


def order(left, right, small, why="", goals=1, witness=None, given=(), relation="=", tolerance=None, **symbols):
    statement = stated(left, relation, right, given=given, tolerance=tolerance, **symbols) | {"order": small}
    return statement, dict.fromkeys(symbols, "1") | (witness or {}), None, [I] * goals, why


ORDERS = [
    order("sin(x)", "x", {"x": 3}, goals=3, x=LINE),
    order("sin(x)", "x", {"x": 4}, "the sides differ", goals=4, x=LINE),
    order("exp(x)", "1", {"x": 1}, x=LINE),
    order("exp(x)", "1", {"x": 2}, "the sides differ", goals=2, x=LINE),
    order("x**9", "0", {"x": 8}, goals=8, x=LINE),
    order("x/(1 - x)", "x", {"x": 2}, goals=2, x=LINE),
    order("x**9", "0", {"x": 9}, "integer from 1 to 8", goals=9, x=LINE),
    order("x", "1", {"x": 0}, "integer from 1 to 8", goals=0, x=LINE),
    order("x", "0", {"y": 1}, "an order in no symbol", x=LINE),
    order("x", "0", {"x": 1, "y": 1}, "the order in one symbol", x=LINE, y=LINE),
    order("x", "0", ["x", 1], "the order in one symbol", x=LINE),
    order("x", "0", {}, "the order in one symbol", x=LINE),
    order("x", "0", {"x": 1}, "0 is no limit", x=["1", "2", []]),
    order("x", "0", {"x": 1}, "0 is no limit", x=WHOLE),
    order("x", "0", {"x": 1}, "0 is no limit", x=["0", "0", []]),
    order("x", "0", {"x": 1}, x=POSITIVE),
    order("x", "0", {"x": 1}, "a hypothesis on a small symbol", given=["x >= 1"], x=LINE),
    order("x", "1", {"x": 1}, "a hypothesis on a small symbol", given=["x = 1"], x=LINE),
    order("x", "0", {"x": 1}, "an order of what is no equation", relation=">", x=LINE),
    order("x", "0", {"x": 1}, "an order of what is no equation", tolerance="1", x=LINE),
    order("abs(x)", "0", {"x": 1}, "no value at the witness", x=LINE),
    order("sqrt(x)*0", "0", {"x": 1}, "no value at the witness", x=POSITIVE),
    order("x + floor(a)", "floor(a)", {"x": 1}, "an order of a floor", x=LINE, a=LINE),
    order("floor(x)", "0", {"x": 1}, "a hypothesis on a small symbol", x=["0", "1/2", []]),
]
#: Points that refute, or do not: (x - 1)**k has no value for x < 1, also for k = 2.
REFUTED = [
    (state("integral(x**2, x, 0, a)", "=", "a", a=LINE), {"a": "1"}, [integral(piece("x__1**3/3"))], ""),
    (state("integral(x**2, x, 0, a)", "=", "a**3/3", a=LINE), {"a": "1"}, [integral(piece("x__1**3/3"))], "not seen"),
    (state("integral((x - 1)**k, x, 0, 1)", "=", "0", k=LINE), {"k": "2"}, [integral(piece("(x__1 - 1)**3/3"))],
     "another exponent"),
    (stated("integral([x, log(y)][1], x, 0, 1)", "=", "1", y=LINE), {"y": "-1"}, [integral(piece("x__1**2/2"))],
     "no value at the point"),
    (state("x", "=", "1", x=LINE), ["x"], None, "expected numbers by symbol"),
    (state("sum(1/k, k, 1, n)", "=", "n", n=COUNT), {"n": "2"}, ["terms"], ""),
    (state("product(k, k, 1, n)", "=", "6", n=COUNT), {"n": "3"}, ["terms"], "not seen"),
    (state("sum(1/(k - 2), k, 1, n)", "=", "0", n=COUNT), {"n": "3"}, ["terms"], "expected 1 entries"),
    (state("sum(k, k, 1, n)", "=", "0", n=COUNT), {"n": "401"}, ["terms"], "too many terms"),
    (state("sum((a - 1)**k, k, 1, n)", "=", "5", a=LINE, n=COUNT), {"a": "0", "n": "2"}, ["terms"], "another exponent"),
]  # fmt: skip
#: Proofs by the other rules, each with a premise that is false, or a place that matters.
XYZ, MINUS, SEVEN = {"x": "1", "y": "1", "z": "1"}, {"x": "-1"}, ["6", "8", []]
RULES = [
    (
        state("x", ">", x=LINE),
        X1,
        None,
        [by("rewrite", B, **{"from": "x", "to": "x"}, defined=[], equal=I)],
        "not shown",
    ),
    (state("x", ">", x=LINE), X1, None, [multiply("2", B, B)], "not shown"),
    (state("x", ">", x=LINE), X1, None, [abstract({"u": "x"}, {"u": LINE}, "u", [], B)], "not shown"),
    (
        stated("x", "=", "0", given=["y = 0"], x=LINE, y=LINE),
        {"x": "0", "y": "0"},
        None,
        [modulo("x", I, "0")],
        "differ",
    ),
    (state("x", "=", "x", x=LINE), X1, None, [squares("x", "x", 2, I, I, I)], "integer from -1 to 1"),
    (state("x", "=", "x", x=LINE), X1, None, [squares("x", "x", -2, I, I, I)], "integer from -1 to 1"),
    (state("1 - x - 2*y + x*y", ">=", x=UNIT, y=UNIT), XY, None, [by("cones", splits=[None])], "negative coefficient"),
    (state("-(x - 7)**2*(x - 5)", ">=", x=SEVEN), {"x": "7"}, None, [roots("6", "8")], "the wrong sign"),
    (state("x**201*x + 1", ">", x=LINE), X1, None, [roots(None, None)], "no rational function"),
    (state("x**200*x**2 + 1", ">", x=LINE), X1, None, [roots(None, None)], "a polynomial of a high degree"),
    (stated("-x", ">=", "0", given=["x <= 0"], x=LINE), MINUS, None, [span(1)], ""),
    (stated("x", ">=", "0", given=["x >= 0"], x=LINE), X1, None, [span(0)], ""),
    (state("1/x", ">", x=UNIT), X1, None, [signs("1/x", None, [1, span(0)])], ""),
    (state("x + y + z", ">=", x=UP, y=UP, z=UP), XYZ, None, [by("cones", splits=[None])], ""),
    (state("1 - x - y + x*y", ">=", x=UNIT, y=UNIT), XY, None, [by("cones", splits=[None])], ""),
    (state("-x", ">=", x=[None, "0", []]), MINUS, None, [roots(None, "0")], ""),
    (state("x**200 + 1", ">", x=LINE), X1, None, [roots(None, None)], ""),
    (state("(x - 3)**(-2)", ">", x=TWO), X1, None, [roots("1", "2")], ""),
    (state("(1/(x - 3))**(-2)", ">", x=TWO), X1, None, [roots("1", "2")], ""),
    (state("x**(1/2)", "!=", x=UNIT), X1, None, [equal("x**(1/2)", by("product", factors=[[1, span(0)]]))], "expected"),
    (state("sin(x/sqrt(2))", "=", "sin(x*sqrt(2)/2)", x=LINE), X1, None, [I], ""),
    (state("sqrt(cos(pi/7) - cos(2*pi/7) + cos(3*pi/7))", "=", "sqrt(1/2)"), {}, None, [I], ""),
    (state("(x + y + z + 1)**6", "=", "((x + y + z + 1)**3)**2", x=LINE, y=LINE, z=LINE), XYZ, None, [I], ""),
    (
        state("v + w + x + y + z + 1", ">", **dict.fromkeys("vwxyz", UNIT)),
        XYZ | {"v": "1", "w": "1"},
        None,
        [by("cones", splits=[None])],
        "",
    ),
    (state("(x - 3)**(-3)", "<", x=TWO), X1, None, [equal("-(x - 3)**(-3)", roots("1", "2"))], ""),
]
ROWS = [*LIMITS, *INTEGRALS, *SUMS, *EXPONENTIALS, *ORDERS, *RULES]


def discrepancies(module: Any) -> Iterator[str]:
    """What a module with the checker's names answers otherwise than it must."""
    for statement, witness, answers, proofs, why in ROWS:
        item = prove(statement, witness, *proofs) | ({} if answers is None else {"answers": answers})
        found = answer(module, statement, item)
        if (found == "HOLDS") != (why == "") or not re.search(why, found):
            yield f"{found}, not {why or 'HOLDS'}: {statement['left']} {statement['relation']} {statement['right']}"
    for statement, point, answers, why in REFUTED:
        found = answer(module, statement, refute(statement, point) | ({} if answers is None else {"answers": answers}))
        if (found == "FAILS") != (why == "") or not re.search(why, found):
            yield f"{found}, not {why or 'FAILS'}: {statement}"
