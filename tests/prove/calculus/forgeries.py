"""Forged answers: each gives a false value, or a value where none exists, with proofs that its author could give."""

I = {"rule": "identity"}
BALLS = {"rule": "balls", "bits": 64, "cells": 1000}
WHOLE = [None, None, ["integer"]]
COUNT = {"rule": "equal", "to": "n", "defined": [], "proof": {"rule": "roots", "from": "1", "to": None}}
NATURAL = ["1", None, ["integer"]]
POSITIVE = ["0", None, ["open-low"]]
REAL = [None, None, []]


def piece(form, limits=(0, 0), continuous=(), smooth=(), equal=None, signs=()):
    proofs = {"continuous": [*continuous], "smooth": [*smooth], "equal": equal, "signs": [*signs]}
    return {"antiderivative": form, "limits": [*limits], **proofs}


def whole(*pieces, cuts=()):
    return {"cuts": [*cuts], "pieces": [*pieces]}


def steps(form, defined=(), equal=None, start=(), count=None, signs=()):
    own = {"telescoper": form, "defined": [*defined], "equal": equal, "start": [*start], "count": count}
    return {**own, "signs": [*signs]}


def quotient(top, bottom, order=0, defined=(), zeros=(), pole=(), around=(), signs=()):
    own = {"top": top, "bottom": bottom, "order": order, "defined": [*defined], "zeros": [*zeros]}
    return {**own, "pole": [*pole], "around": [*around], "signs": [*signs]}


#: left side, right side that the forged value gives, ranges, answer, what the checker says
INTEGRALS = [
    ("integral(1/x**2, x, -1, 1)", "-2", {}, whole(piece("-1/x__1")), "expected a list of|entries"),
    ("integral(1/x**2, x, -1, 1)", "-2", {}, whole(piece("-1/x__1", (0, 0), [BALLS], [BALLS])), "so many cells"),
    ("integral(1/x**2, x, -1, 1)", "-2", {}, whole(piece("-1/x__1", (1, 1), [BALLS], [BALLS])), "so many cells"),
    (
        "integral(1/x**2, x, -1, 1)",
        "-2",
        {},
        whole(piece("-1/x__1", (0, 1), [BALLS], [BALLS]), piece("-1/x__1", (1, 0), [BALLS], [BALLS]), cuts=["0"]),
        "no limit|may have no value|so many cells",
    ),
    ("integral(1/x, x, -1, 1)", "0", {}, whole(piece("log(abs(x__1))", (0, 0), [BALLS], [BALLS])), "entries|cells"),
    (
        "integral(1/x, x, 0, 1)",
        "0",
        {},
        whole(piece("log(x__1)", (1, 0), [BALLS], [BALLS, BALLS])),
        "no limit|entries|cells",
    ),
    ("integral(x**2, x, 0, 1)", "1", {}, whole(piece("x__1**3")), "terms differ"),
    ("integral(x**2, x, 0, 1)", "1/3 + 1", {}, whole(piece("x__1**3/3 + x__1")), "terms differ"),
    ("integral(abs(x), x, -1, 1)", "0", {}, whole(piece("x__1**2/2")), "terms differ|entries"),
    ("integral(abs(x), x, -1, 1)", "0", {}, whole(piece("x__1**2/2", equal=I)), "sides differ|terms differ|entries"),
    ("integral(x, x, 0, 1)", "0", {}, whole(piece("x__1**2/2"), cuts=["x__1"]), "variable in a cut"),
    ("integral(x, x, 0, 1)", "1", {}, whole(piece("x__1**2/2"), piece("x__1**2/2")), "entries"),
    ("integral(x, x, 0, 1)", "z", {}, whole(piece("x__1**2/2"), cuts=["z"]), "entries"),
    ("integral(1, x, 0, oo)", "0", {}, whole(piece("x__1", (0, 0))), "expected a limit at oo"),
    ("integral(1, x, 0, oo)", "1", {}, whole(piece("x__1", (0, 1))), "no limit is known"),
    ("integral(cos(x), x, 0, oo)", "0", {}, whole(piece("sin(x__1)", (0, 1))), "no limit is known"),
    ("integral(exp(x), x, 0, oo)", "-1", {}, whole(piece("exp(x__1)", (0, 1))), "exponential that may grow"),
    (
        "integral(exp(-a*x), x, 0, oo)",
        "1/a",
        {"a": ["0", None, []]},
        whole(
            piece(
                "-exp(-a*x__1)/a",
                (0, 1),
                [],
                [],
                None,
                [[-1, {"rule": "range", "symbol": "a", "end": 0, "share": "1"}]],
            )
        ),
        "belongs to the range",
    ),
    ("integral(x, x, -oo, oo)", "0", {}, whole(piece("x__1**2/2", (1, 1))), "expected a cut"),
    ("integral(exp(x), x, oo, 0)", "-1", {}, whole(piece("exp(x__1)", (1, 0))), "begins at oo"),
    ("integral(x, x, 0, x__1)", "0", {"x__1": REAL}, whole(piece("x__1**2/2")), "in use"),
    (
        "integral(1/(2 + cos(x)), x, 0, 2*pi)",
        "0",
        {},
        whole(piece("2/sqrt(3)*atan(tan(x__1/2)/sqrt(3))", (0, 0), [BALLS], [BALLS])),
        "cells|entries",
    ),
    ("integral(x*where(x = 0, 1, 0), x, -1, 1)", "0", {}, whole(piece("0")), "of a bound variable"),
    ("diff(integral(x, x, 0, t), t)", "0", {"t": POSITIVE}, whole(piece("x__1**2/2")), "a derivative of"),
    ("integral(x, x, 0, 1)", "1/2", {}, {"cuts": []}, "exactly the keys"),
]
SUMS = [
    ("sum(k, k, 1, n)", "n**2", {"n": NATURAL}, steps("k__1**2", count=COUNT), "terms differ"),
    ("sum(k, k, 1, n)", "n*(n + 1)/2", {"n": REAL}, steps("k__1*(k__1 - 1)/2", count=I), "whole ends"),
    ("sum(k, k, 1, n)", "n*(n + 1)/2", {"n": WHOLE}, steps("k__1*(k__1 - 1)/2", count=I), "sides differ"),
    (
        "sum(k, k, 1, n)",
        "n*(n + 1)/2",
        {"n": WHOLE},
        steps("k__1*(k__1 - 1)/2", count={"rule": "range", "symbol": "n", "end": 0, "share": "1"}),
        "without this end",
    ),
    ("sum(k, k, 1, n/2)", "n*(n + 2)/8", {"n": NATURAL}, steps("k__1*(k__1 - 1)/2", count=I), "whole ends"),
    ("sum(k, k, 1/2, n)", "n", {"n": NATURAL}, steps("k__1*(k__1 - 1)/2", count=I), "whole ends"),
    ("sum(1, k, 1, oo)", "0", {}, steps("k__1"), "no limit is known"),
    ("sum(k, k, -oo, n)", "0", {"n": NATURAL}, steps("k__1*(k__1 - 1)/2", count=I), "whole ends|unknown symbol"),
    (
        "sum(r**k, k, 0, oo)",
        "1/(1 - r)",
        {"r": ["1/2", "2", []]},
        steps("r**k__1/(r - 1)", [BALLS], None, [BALLS], None, [[1, I], [-1, I]]),
        "expected|sides differ|cells",
    ),
    (
        "sum(1/(k*(k + 1)), k, -3, n)",
        "-1/3 - 1/(n + 1)",
        {"n": NATURAL},
        steps("-1/k__1", [BALLS, BALLS], None, [], {"rule": "sum", "proofs": [BALLS, BALLS], "strict": 0}),
        "expected|cells",
    ),
    ("sum(k, k, 1, n)", "0", {"n": NATURAL}, steps("k__1*(k__1 - 1)/2", equal=I, count=I), "sides differ"),
    ("sum(k, k, n, 1)", "(2 - n)*(n + 1)/2", {"n": NATURAL}, steps("k__1*(k__1 - 1)/2", count=I), "sides differ"),
    ("sum(k, k, 1, n)", "1", {"n": NATURAL}, steps("m", count=I), "without a range|terms differ|sides differ"),
    ("sum(k, k, 1, oo)", "0", {}, steps("k__1*(k__1 - 1)/2", count=I), "to -oo|no limit"),
    ("sum(k, k, 1, n)", "0", {"n": NATURAL}, {"telescoper": "0"}, "exactly the keys"),
    ("sum(k, k, 1, 1000)", "500500", {}, steps("0"), "too many terms"),
]
PRODUCTS = [
    ("product(k, k, 1, n)", "n + 1", {"n": NATURAL}, steps("k__1", count=COUNT), "terms differ"),
    ("product(k/(k + 1), k, 1, n)", "n + 1", {"n": NATURAL}, steps("k__1", count=COUNT), "terms differ|entries"),
    ("product(k/(k + 1), k, 1, n)", "1/(n + 1)", {"n": WHOLE}, steps("1/k__1", count=I), "sides differ"),
    ("product(k/(k + 1), k, 1, n)", "1/(n + 1)", {"n": REAL}, steps("1/k__1", count=I), "whole ends"),
    (
        "product((k + 1)/k, k, 0, n)",
        "n + 1",
        {"n": NATURAL},
        steps("k__1", [BALLS], None, [BALLS], I),
        "expected|sides differ",
    ),
    ("product(k, k, 1, n)", "1", {"n": NATURAL}, steps("0", [], None, [I], I), "expected|sides differ"),
    (
        "product(k, k, 1, n)",
        "0",
        {"n": NATURAL},
        steps("0", [], None, [], {"rule": "range", "symbol": "n", "end": 0, "share": "1"}),
        "differ|another|entries",
    ),
    ("product(2, k, 1, oo)", "0", {}, steps("2**k__1"), "may grow"),
    ("product(k, k, 3, 1)", "0", {}, steps("0"), "differ|answer without"),
    ("product(k, k, 1/2, 5/2)", "1", {}, steps("1"), "whole ends"),
    ("product(k/(k + 1), k, 1, oo)", "1", {}, steps("k__1"), "terms differ|no limit"),
    ("product(k/(k + 1), k, 1, oo)", "0", {}, steps("k__1/(k__1 + 1)"), "terms differ|entries"),
    ("product(-1, k, 1, oo)", "0", {}, steps("(-1)**k__1"), "no value|expected|refused|power|exist|logarithm|list"),
    ("product(k, k, n, 1)", "1", {"n": NATURAL}, steps("1", count=I), "differ"),
    ("product(k, k, 1, n)", "1", {"n": NATURAL}, {"telescoper": "1"}, "exactly the keys"),
]
LIMITS = [
    ("limit(1/x, x, 0)", "0", {}, quotient("1", "x__1"), "entries"),
    ("limit(1/x, x, 0)", "0", {}, quotient("1", "x__1", 1, [], [I, I], [I, I], [1]), "differ|expected"),
    ("limit(sin(x)/x, x, 0)", "0", {}, quotient("0", "1"), "another one"),
    ("limit(sin(x)/x, x, 0)", "0", {}, quotient("sin(x__1)", "x__1", 0, [], [], [BALLS, BALLS], [1]), "cells|shown"),
    (
        "limit(sin(x)/x, x, 0)",
        "0",
        {},
        quotient("sin(x__1)", "x__1", 2, [], [I] * 4, [BALLS, BALLS], [1]),
        "cells|shown",
    ),
    (
        "limit(abs(x)/x, x, 0)",
        "1",
        {},
        quotient("abs(x__1)", "x__1", 1, [BALLS], [I, I], [BALLS, BALLS], [1]),
        "cells|shown|entries|expected",
    ),
    (
        "limit(sqrt(x), x, 0)",
        "0",
        {},
        quotient("sqrt(x__1)", "1", 0, [BALLS], [], [BALLS, BALLS], [0]),
        "cells|shown|entries|expected",
    ),
    ("limit(log(x)*0, x, 0)", "0", {}, quotient("0", "1", 0, [], [], [BALLS, BALLS], [1]), "sign on both sides"),
    ("limit(0*sqrt(x), x, 0)", "0", {}, quotient("0", "1", 0, [], [], [BALLS, BALLS], [2]), "sign on both sides"),
    ("limit(x, x, oo)", "0", {}, {"signs": []}, "no limit"),
    ("limit(sin(x), x, oo)", "0", {}, {"signs": []}, "no limit"),
    ("limit(exp(x), x, oo)", "0", {}, {"signs": []}, "may grow"),
    ("limit(exp(a*x), x, oo)", "0", {"a": REAL}, {"signs": [[-1, I]]}, "expected|differ"),
    ("limit(exp(a*x), x, oo)", "0", {"a": REAL}, {"signs": [[0, I]]}, "expected a sign"),
    ("limit(log(5 - x)/x, x, oo)", "0", {}, {"signs": []}, "may have no value"),
    ("limit(1/sin(x), x, oo)", "0", {}, {"signs": []}, "may have no value"),
    ("limit(1/x, x, oo)", "0", {}, {"signs": [[1, I]]}, "a sign too many"),
    ("limit(1/x, x, 1)", "1", {}, {"signs": []}, "expected oo"),
    ("limit(x + 1, x, 0)", "0", {}, quotient("x__1", "1"), "another one"),
    (  # (x**y)**(1/y) is x for x > 0 only, and abs(x) at y = 2
        "limit(0*y, y, 2)",
        "abs(x) - x",
        {"x": ["-2", "-1", []]},
        quotient("(x**y__1)**(1/y__1) - x", "1", 0, [BALLS], [], [BALLS]),
        "expected 2 entries",
    ),
]
ALL = [*INTEGRALS, *SUMS, *PRODUCTS, *LIMITS]
