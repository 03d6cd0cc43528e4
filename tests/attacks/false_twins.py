"""True statements beside false ones of nearly the same text: a proof of the one is no proof of the other."""

from __future__ import annotations

import copy
import random
from collections.abc import Iterator
from typing import Any

import navsym as nav
from navsym.checker import Refused, check

ANY: dict[str, Any] = {"x": "real"}
BOTH: dict[str, Any] = {"x": "real", "y": "real"}
POSITIVE: dict[str, Any] = {"x": "positive"}
VECTORS: dict[str, Any] = {"u": {"vector": 3}, "v": {"vector": 3}}
SQUARE: dict[str, Any] = {"A": {"matrix": ["n", "n"]}, "B": {"matrix": ["n", "n"]}}
#: A true text, its declarations, and false texts with theirs.
TWINS: list[tuple[str, dict[str, Any], list[tuple[str, dict[str, Any]]]]] = [
    (
        "sin(x)**2 + cos(x)**2 = 1",
        ANY,
        [
            ("sin(x)**2 + cos(x)**2 = 1 + 1/10**30", ANY),
            ("sin(x)**2 - cos(x)**2 = 1", ANY),
            ("sin(x)**2 + cos(2*x)**2 = 1", ANY),
        ],
    ),
    (
        "sin(x) <= x",
        {"x": ["0", "pi"]},
        [
            ("sin(x) <= x", {"x": ["-1/1000", "pi"]}),
            ("sin(x) < x", {"x": ["0", "pi"]}),
            ("x <= sin(x)", {"x": ["0", "pi"]}),
            ("sin(x) <= x - 1/10**9", {"x": ["0", "pi"]}),
        ],
    ),
    ("x**4 + 1 > x", ANY, [("x**4 + 1/3 > x", ANY), ("x**4 + 1 > 2*x", ANY), ("x**3 + 1 > x", ANY)]),
    (
        "x**2 + y**2 >= 2*x*y",
        BOTH,
        [
            ("x**2 + y**2 > 2*x*y", BOTH),
            ("x**2 + y**2 >= 2*x*y + 1/10**20", BOTH),
            ("x**2 + y**2 >= 201/100*x*y", BOTH),
        ],
    ),
    (
        "exp(x) >= 1 + x",
        ANY,
        [("exp(x) > 1 + x", ANY), ("exp(x) >= 1 + x + x**2/2", ANY), ("exp(x) >= 1 + 11/10*x", ANY)],
    ),
    (
        "sqrt(x**2) = x",
        {"x": ["0", "5"]},
        [("sqrt(x**2) = x", {"x": ["-5", "5"]}), ("sqrt(x**2) = -x", {"x": ["0", "5"]})],
    ),
    ("log(x) <= x - 1", POSITIVE, [("log(x) < x - 1", POSITIVE), ("log(x) <= x - 2", POSITIVE)]),
    ("tanh(x) < 1", ANY, [("tanh(x) < 1 - 1/10**9", ANY), ("tanh(x) < 0", ANY)]),
    ("cos(x) >= 1 - x**2/2", ANY, [("cos(x) >= 1 - x**2/3", ANY), ("cos(x) > 1 - x**2/2", ANY)]),
    (
        "atan(x) + atan(1/x) = pi/2",
        POSITIVE,
        [("atan(x) + atan(1/x) = pi/2", {"x": "nonzero"}), ("atan(x) + atan(1/x) = pi/3", POSITIVE)],
    ),
    ("x/(1 + x**2) <= 1/2", ANY, [("x/(1 + x**2) < 1/2", ANY), ("x/(1 + x**2) <= 1/2 - 1/10**12", ANY)]),
    (
        "abs(x + y) <= abs(x) + abs(y)",
        BOTH,
        [("abs(x + y) >= abs(x) + abs(y)", BOTH), ("abs(x + y) < abs(x) + abs(y)", BOTH)],
    ),
    (
        "(x + y)**3 = x**3 + 3*x**2*y + 3*x*y**2 + y**3",
        BOTH,
        [
            ("(x + y)**3 = x**3 + 3*x**2*y + 3*x*y**2 - y**3", BOTH),
            ("(x + y)**3 = x**3 + 3*x**2*y + 2*x*y**2 + y**3", BOTH),
        ],
    ),
    ("1/x > 1/2", {"x": ["1", "3/2"]}, [("1/x > 1/2", {"x": ["1", "2"]}), ("1/x > 2/3", {"x": ["1", "3/2"]})]),
    ("max(x, 1 - x) >= 1/2", ANY, [("max(x, 1 - x) > 1/2", ANY), ("max(x, 1 - x) >= 51/100", ANY)]),
    ("floor(x) <= x", ANY, [("floor(x) < x", ANY), ("floor(x) <= x - 1/2", ANY)]),
    (
        "diff(sin(x)**2, x) = sin(2*x)",
        ANY,
        [("diff(sin(x)**2, x) = cos(2*x)", ANY), ("diff(sin(x)**2, x, 2) = sin(2*x)", ANY)],
    ),
    (
        "integral(t**2, t, 0, x) = x**3/3",
        ANY,
        [("integral(t**2, t, 0, x) = x**3/2", ANY), ("integral(t**2, t, 1, x) = x**3/3", ANY)],
    ),
    (
        "sum(k, k, 1, n) = n*(n + 1)/2",
        {"n": {"integer": ["1", "oo"]}},
        [
            ("sum(k, k, 1, n) = n*(n - 1)/2", {"n": {"integer": ["1", "oo"]}}),
            ("sum(k, k, 2, n) = n*(n + 1)/2", {"n": {"integer": ["1", "oo"]}}),
        ],
    ),
    ("limit(sin(x)/x, x, 0) = 1", ANY, [("limit(sin(x)/x, x, 0) = 2", ANY), ("limit(sin(2*x)/x, x, 0) = 1", ANY)]),
    ("dot(u, cross(u, v)) = 0", VECTORS, [("dot(u, cross(u, v)) = 1", VECTORS), ("dot(u, v) = 0", VECTORS)]),
    (
        "norm(u + v) <= norm(u) + norm(v)",
        VECTORS,
        [("norm(u + v) < norm(u) + norm(v)", VECTORS), ("norm(u + v) <= norm(u)", VECTORS)],
    ),
    (
        "sqrt(x*y) <= (x + y)/2",
        {"x": "positive", "y": "positive"},
        [
            ("sqrt(x*y) < (x + y)/2", {"x": "positive", "y": "positive"}),
            ("sqrt(x*y) <= (x + y)/3", {"x": "positive", "y": "positive"}),
        ],
    ),
    ("cosh(x)**2 - sinh(x)**2 = 1", ANY, [("cosh(x)**2 - sinh(x)**2 = -1", ANY), ("cosh(x)**2 + sinh(x)**2 = 1", ANY)]),
    (
        "x**3 - x >= -2/5",
        {"x": ["0", "1"]},
        [("x**3 - x >= -19/50", {"x": ["0", "1"]}), ("x**3 - x >= -2/5", {"x": ["-2", "1"]})],
    ),
    ("sin(x)*cos(y) <= 1", BOTH, [("sin(x)*cos(y) < 1", BOTH), ("sin(x)*cos(y) <= 99/100", BOTH)]),
    (
        "where(x < 0, -x, x) = abs(x)",
        ANY,
        [("where(x < 0, x, x) = abs(x)", ANY), ("where(x < 1, -x, x) = abs(x)", ANY)],
    ),
    (
        "E(w) = 0",
        {"w": {"random": {"mean": "0", "cov": "1"}}},
        [
            ("E(w) = 1", {"w": {"random": {"mean": "0", "cov": "1"}}}),
            ("E(w**2) = 0", {"w": {"random": {"mean": "0", "cov": "1"}}}),
        ],
    ),
    ("(A @ B).T = B.T @ A.T", SQUARE, [("(A @ B).T = A.T @ B.T", SQUARE), ("A @ B = B @ A", SQUARE)]),
    (
        "sin(x) > 2*x/pi - 1/10",
        {"x": ["0", "pi/2"]},
        [("sin(x) > 2*x/pi", {"x": ["0", "pi/2"]}), ("sin(x) > 2*x/pi - 1/10", {"x": ["0", "pi"]})],
    ),
]
#: What stands in the place of a leaf of a proof, and at a point.
LEAVES: tuple[Any, ...] = (0, 1, "0", "1", "-1", "1/2", "x", "x**2", "y", "1/x", "oo", "pi", None, [], {}, "1/10**9")
POINTS = ("0", "1", "-1", "1/2", "pi", "pi/2", "10**9", "sqrt(2)", "1/10**9")


def list_places(part: Any, rules: bool, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of the proofs in a certificate, or of its leaves."""
    inner = part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ()
    if ("rule" in part) if rules and isinstance(part, dict) else (not rules and not isinstance(part, dict | list)):
        yield path
    for key, value in inner:
        yield from list_places(value, rules, (*path, key))


def look_up(part: Any, path: tuple[Any, ...]) -> Any:
    """What stands at a path."""
    for key in path:
        part = part[key]
    return part


def exchange(certificate: dict[str, Any], path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    """The certificate with another value at a path."""
    forged = copy.deepcopy(certificate)
    look_up(forged, path[:-1])[path[-1]] = copy.deepcopy(value)
    return forged


def certify_twins(pairs: list[tuple[str, dict[str, Any], list[tuple[str, dict[str, Any]]]]]) -> list[tuple[Any, Any]]:
    """Certificates of the true statements, each beside the counterexamples of its false twins."""
    found = []
    for text, given, twins in pairs:
        proof = nav.prove(text, **given)
        refuted = [nav.prove(false, **wrong) for false, wrong in twins]
        assert proof.holds and all(str(verdict.status) == "REFUTED" for verdict in refuted), text
        found.append((proof.certificate, [verdict.certificate for verdict in refuted]))
    return found


def forge(certified: list[tuple[Any, Any]], rng: random.Random, count: int) -> Iterator[dict[str, Any]]:
    """Proofs put below false twins, with other proofs and leaves inside; counterexamples put below true statements."""
    pool = [look_up(proof, path) for proof, _ in certified for path in list_places(proof, rules=True)]
    for proof, refutations in certified:
        for refuted in refutations:
            forged = {**proof, "statement": refuted["statement"]}
            yield forged
            proofs = list(list_places(forged, rules=True))
            leaves = [path for path in list_places(forged, rules=False) if path[0] != "statement"]
            for _ in range(count):
                if proofs:
                    yield exchange(forged, rng.choice(proofs), rng.choice(pool))
                yield exchange(forged, rng.choice(leaves), rng.choice(LEAVES))
            turned = {**refuted, "statement": proof["statement"]}
            yield turned
            for name in turned.get("point", ()):
                for value in POINTS:
                    moved = exchange(turned, ("point", name), value)
                    yield from ({**moved, "zero": zero} for zero in (None, {"rule": "identity"}))


def list_accepted(forgeries: Iterator[dict[str, Any]]) -> tuple[int, list[dict[str, Any]]]:
    """How many were tried, and those that the checker takes."""
    number, taken = 0, []
    for forged in forgeries:
        number += 1
        try:
            check(forged)
        except Refused:
            continue
        taken.append(forged)
    return number, taken
