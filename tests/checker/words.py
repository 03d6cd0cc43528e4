"""Certificates of the kinds words and sized: true ones, and forgeries that each fail at one check."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator
from typing import Any

SQUARE, TALL, FLAT = ["n", "n"], ["n", "m"], ["m", "n"]


def state(left: str, right: str, relation: str = "=", given=(), symbols=None, dimensions=("n", "m"), **matrices: Any):
    """A statement: name=size, or name=(size, property, …)."""
    declared = {}
    for name, item in matrices.items():
        size, *words = item if isinstance(item, tuple) else (item,)
        declared[name] = {"size": size, "is": words}
    sides = {"left": left, "relation": relation, "right": right, "symbols": symbols or {}, "matrices": declared}
    return {**sides, "dimensions": [*dimensions], "given": [*given]}


def at(n: int = 2, m: int = 1, numbers=None, **matrices: str) -> dict[str, Any]:
    """A point: matrices by their rows, ``"1 2; 3 4"``."""
    rows = {name: [row.split() for row in text.split(";")] for name, text in matrices.items()}
    return {"sizes": {"n": n, "m": m}, "matrices": rows, "numbers": numbers or {}}


def share(c: str, left: str, relation: int, right: str, word: str | None = None) -> dict[str, Any]:
    return {"coefficient": c, "left": left, "right": right, "relation": relation, "word": word}


def words(statement, witness, *shares) -> dict[str, Any]:
    return {"kind": "words", "statement": statement, "witness": witness, "shares": [*shares]}


def sized(statement, point) -> dict[str, Any]:
    return {"kind": "sized", "statement": statement, "point": point}


A, B, TURN, UNIT = "1 2; 0 1", "2 1; 1 1", "0 -1; 1 0", "1 0; 0 1"
REAL, ABOVE, APART = [None, None, []], ["0", None, ["open-low"]], [None, None, ["nonzero"]]

DIFFERENCE = words(
    state("inv(A) - inv(B)", "inv(A) @ (B - A) @ inv(B)", A=SQUARE, B=SQUARE),
    at(A=A, B=B),
    share("-1", "inv__A", 4, ""),
    share("1", "", 2, "inv__B"),
)
TRACE = words(state("trace(A @ inv(A))", "n", A=(SQUARE, "invertible")), at(A=A), share("1", "", 0, "", ""))
TRACED = words(
    state("trace(A @ inv(A))*B", "n*B", A=(SQUARE, "invertible"), B=TALL), at(A=A, B="1; 2"), share("1", "", 0, "", "B")
)
OUTER = words(state("trace(u @ v.T)", "dot(v, u)", u=["n", 1], v=["n", 1]), at(u="1; 2", v="3; 1"))
# A product that is said to be another matrix is no inverse, though it is one at the witness.
UNSAID = words(
    state("B @ A", "eye(n)", given=["A @ B = C"], A=SQUARE, B=SQUARE, C=SQUARE),
    at(A=UNIT, B=UNIT, C=UNIT),
    share("1", "", 2, ""),
)
LINE = words(
    state("u @ u.T @ u @ u.T", "u @ u.T", given=["dot(u, u) = 1"], u=["n", 1]),
    at(u="1; 0"),
    share("1", "", 0, "", "u u.T"),
)
SCALED = words(state("inv(a*A)", "inv(A)/a", symbols={"a": APART}, A=SQUARE), at(A=A, numbers={"a": "2"}))
ROOT = words(state("trace(A)**(1/2)*B", "B", A=SQUARE, B=SQUARE), at(A="1 0; 0 0", B=A))
WAVE = words(state("cos(trace(A))*B", "B", A=SQUARE, B=SQUARE), at(A=TURN, B=A))
SAME = words(state("A", "B", "!=", A=SQUARE, B=SQUARE), at(A=A, B=B))
DIVIDED = words(
    state("a*b*A", "a*b*B", given=["b*A = b*B"], symbols={"a": REAL, "b": APART}, A=SQUARE, B=SQUARE),
    at(A=A, B=A, numbers={"a": "3", "b": "2"}),
    share("a", "", 0, ""),
)
ORTHOGONAL = words(
    state("U.T @ U + S + S.T + D @ E", "eye(n) + E @ D", U=(SQUARE, "orthogonal"), S=(SQUARE, "skew"),
          D=(SQUARE, "diagonal"), E=(SQUARE, "diagonal"), F=(FLAT,), G=(["m", "m"], "diagonal")),
    at(U=TURN, S=TURN, D="1 0; 0 2", E="3 0; 0 0", F="1 2", G="4"),
    share("1", "", 5, ""),
    share("1", "", 6, ""),
    share("1", "", 8, ""),
)  # fmt: skip
GAIN = "inv(H @ P @ H.T + R)"
PUSHED = words(
    state(f"{GAIN} @ (R + H @ P @ transpose(H)) - zeros(m, m)", "eye(m)", P=(SQUARE, "nonnegative"),
          R=(["m", "m"], "positive"), H=FLAT),
    at(P="1 1; 1 1", R="1", H="1 0"),
    share("1", "", 4, ""),
    share("-1", "inv__arg__1", 2, ""),
)  # fmt: skip
ONE_SIDED = words(
    state("B @ A", "eye(n)", given=["A @ B = eye(n)"], A=SQUARE, B=SQUARE),
    at(A=A, B="1 -2; 0 1"),
    share("1", "", 2, ""),
)
NUMBER = words(state("dot(u, v) + v.T @ u", "2*(u.T @ v)", u=["n", 1], v=["n", 1]), at(u="1; 2", v="3; 4"))
UNITS = words(
    state("exp(0)*inv(2*eye(n)) @ inv(inv(A)) - 0*(-A) + 0*pi**2*A*0 + -zeros(n, 2) @ B", "A/2", A=SQUARE, B=[2, "n"]),
    at(A=A, B="1 2; 3 4"),
)
RANK_ONE = words(
    state("(u @ v.T) @ (u @ v.T)/(1 + v.T @ u)", "dot(u, v)*(u @ v.T)/(v.T @ u + 1)", u=["n", 1], v=["n", 1]),
    at(u="1; 2", v="3; 4"),
)
DEFINITE = words(
    state("inv(A + P) @ S", "inv(A + P) @ (P + P)", given=["S = P + P"], A=SQUARE, P=(SQUARE, "positive"), S=SQUARE),
    at(A=A, P="2 1; 1 2", S="4 2; 2 4"),
    share("1", "inv__arg__1", 2, ""),
)
#: Statements that fail at one point.
COMMUTING = sized(state("A @ B", "B @ A", A=SQUARE, B=SQUARE), at(A=A, B=B))
APART_AT_ALL = sized(state("A", "B", "!=", A=SQUARE, B=SQUARE), at(A=A, B=A))
SIGNS = [
    sized(state("trace(A)", "n", sign, A=SQUARE), at(A=f"{x} 0; 0 1"))
    for sign, x in (("=", 2), ("!=", 1), (">", 1), (">=", 0), ("<", 1), ("<=", 2))
]
PROPERTIES = [
    sized(state("A", "zeros(n, n)", A=(SQUARE, word)), at(A=rows))
    for word, rows in (
        ("symmetric", "1 2; 2 1"), ("positive", "2 1; 1 2"), ("nonnegative", "1 1; 1 1"), ("invertible", A),
        ("orthogonal", TURN), ("skew", TURN), ("diagonal", "1 0; 0 2"),
    )
]  # fmt: skip
POWERS = sized(
    state("abs(x)*x**y*A", "2*x*x**y*A", symbols={"x": REAL, "y": REAL}, A=SQUARE),
    at(A=A, numbers={"x": "2", "y": "3"}),
)
TRACE_OF = words(
    state("trace(u @ v.T)*A", "dot(u, v)*A", A=SQUARE, u=["n", 1], v=["n", 1]), at(A=A, u="1; 2", v="3; 4")
)
TWICE = words(state("inv(A + B) - inv(A + B)", "zeros(n, n)", A=SQUARE, B=SQUARE), at(A=A, B=B))
BOTH_SIDES = words(
    state("Y @ X", "eye(2)", given=["X @ Y = eye(2)"], X=[2, 2], Y=[2, 2]),
    at(X=A, Y="1 -2; 0 1"),
    share("1", "", 2, ""),
)
QUOTIENT = words(
    state("A/b", "A/b", symbols={"b": REAL}, A=(SQUARE, "invertible")),
    at(A=A, numbers={"b": "2"}),
    share("1/b", "", 0, ""),
    share("-1/b", "", 0, ""),
)
OF_NUMBERS = words(
    state("dot(u, inv(A) @ A @ u)/b", "dot(u, u)/b", symbols={"b": REAL}, A=(SQUARE, "invertible"), u=["n", 1]),
    at(A=A, u="1; 2", numbers={"b": "2"}),
    share("1/b", "u.T", 2, "u"),
)
NEGATIVE = words(state("-A + A", "zeros(n, n)", A=SQUARE), at(A=A))
POWER = words(state("trace(A)**2*B", "trace(A)*trace(A)*B", A=SQUARE, B=SQUARE), at(A=A, B=B))
SINGULAR = sized(state("inv(A)", "A", A=SQUARE), at(A=B))
NOT_NEGATIVE = sized(state("A", "eye(n)", A=(SQUARE, "nonnegative")), at(n=3, A="1 1 1; 1 1 1; 1 1 1"))
DEFINITE_3 = sized(state("A", "eye(n)", A=(SQUARE, "positive")), at(n=3, A="2 1 0; 1 2 1; 0 1 2"))
#: Symmetric matrices that one principal minor alone, or one leading minor alone, shows to be no such matrices.
MINORS = [
    (NOT_NEGATIVE, rows)
    for rows in (
        "-1 0 0; 0 0 0; 0 0 0", "0 0 0; 0 -1 0; 0 0 0", "0 0 0; 0 0 0; 0 0 -1", "1 2 0; 2 1 0; 0 0 0",
        "0 0 0; 0 1 2; 0 2 1", "1 0 2; 0 0 0; 2 0 1", "1 1 -1; 1 1 1; -1 1 1", "1 0 0; 0 1 0; 1 0 1",
    )
] + [
    (DEFINITE_3, rows)
    for rows in ("-1 0 0; 0 -1 0; 0 0 1", "1 2 0; 2 1 0; 0 0 -1", "1 0 0; 0 1 0; 0 0 -1", "1 0 0; 0 1 0; 0 0 0",
                 "1 1 0; 1 1 0; 0 0 1", "0 0 0; 0 0 0; 0 0 0", "1 0 0; 0 1 0; 1 0 1")
]  # fmt: skip
TRUE = [
    OUTER, TRACE_OF, TWICE, BOTH_SIDES, QUOTIENT, OF_NUMBERS, NEGATIVE, POWER, SINGULAR, NOT_NEGATIVE, DEFINITE_3,
    POWERS, DIFFERENCE, TRACE, TRACED, LINE, SCALED, DIVIDED, ORTHOGONAL, PUSHED, ONE_SIDED, NUMBER, UNITS, RANK_ONE,
    DEFINITE,
    COMMUTING, APART_AT_ALL, *SIGNS, *PROPERTIES,
]  # fmt: skip

#: Statements of SIGNS, and what makes them hold, at and beside the end.
HOLDING = [*zip([SIGNS[k] for k in (0, 1, 2, 2, 3, 3, 4, 4, 5, 5)], (1, 2, 2, 3, 1, 2, 0, -1, 1, 0), strict=True)]

LEFT, RIGHT, MATRICES = ["statement", "left"], ["statement", "right"], ["statement", "matrices"]
POINT = ["witness", "matrices"]
#: Certificate, place, what stands there instead, and why it is refused.
FORGERIES: list[tuple[Any, list[Any], Any, str]] = [
    *((item, ["point", "matrices", "A"], [r.split() for r in rows.split(";")], "properties") for item, rows in MINORS),
    (words(state("inv(A @ B)", "inv(A) @ inv(B)", A=SQUARE, B=SQUARE), at(A=UNIT, B=UNIT)), ["shares"], [], "another"),
    (words(state("inv(A + B)", "inv(A - B)", A=SQUARE, B=SQUARE), at(A=A, B="0 0; 0 0")), ["shares"], [], "another"),
    (
        words(state("K @ H", "eye(n)", given=["H @ K = eye(m)"], H=FLAT, K=TALL), at(n=1, H="1", K="1")),
        ["shares"],
        [share("1", "", 2, "")],
        "integer from 0 to 1",
    ),
    (QUOTIENT, ["shares", 0, "coefficient"], "1/(b + 1)", "may not exist"),
    (
        words(
            state("sqrt(b)*A", "sqrt(b)*A", symbols={"b": REAL}, A=(SQUARE, "invertible")),
            at(A=A, numbers={"b": "4"}),
            share("1/b", "", 0, ""),
            share("-1/b", "", 0, ""),
        ),
        ["witness", "numbers", "b"],
        "1",
        "may not exist",
    ),
    (words(state("-A", "A", A=SQUARE), at(A="0 0; 0 0")), ["shares"], [], "another sum"),
    (words(state("trace(A)**0*B", "B", A=SQUARE, B=SQUARE), at(A=A, B=B)), ["shares"], [], "a root or inverse power"),
    (POWER, LEFT, "trace(A)**1*trace(A)*B", ""),
    (POWER, LEFT, "x1*B", "an unknown name"),
    (SINGULAR, ["point", "matrices", "A"], [["1", "1"], ["1", "1"]], "a singular matrix"),
    *((item, ["point", "matrices", "A", 0, 0], str(x), "the statement holds there") for item, x in HOLDING),
    (DIFFERENCE, ["shares", 0, "coefficient"], "1", "another sum"),
    (DIFFERENCE, ["shares", 0, "relation"], 0, "another sum"),
    (DIFFERENCE, ["shares", 0, "relation"], 8, "integer from 0 to 7"),
    (DIFFERENCE, ["shares", 0, "relation"], -1, "integer from"),
    (DIFFERENCE, ["shares", 0, "left"], "inv__A.T", "another sum"),
    (DIFFERENCE, ["shares", 0, "left"], "C", "a letter"),
    (DIFFERENCE, ["shares", 0, "left"], None, "expected a word"),
    (DIFFERENCE, ["shares"], [], "another sum"),
    (DIFFERENCE, RIGHT, "inv(A) @ (A - B) @ inv(B)", "no value at the witness"),
    (DIFFERENCE, RIGHT, "inv(B) @ (B - A) @ inv(A)", "another sum"),
    (DIFFERENCE, [*POINT, "A"], [["1", "2"], ["2", "4"]], "singular"),
    (DIFFERENCE, [*POINT, "A"], [["1", "2"]], "2 entries"),
    (DIFFERENCE, [*POINT, "A"], [["1"], ["2"]], "2 entries"),
    (DIFFERENCE, POINT, {"A": [["1", "0"], ["0", "1"]]}, "every matrix"),
    (DIFFERENCE, POINT, [], "every matrix"),
    (DIFFERENCE, [*POINT, "C"], [["1"]], "every matrix"),
    (DIFFERENCE, ["witness", "sizes"], {"n": 2}, "every dimension"),
    (DIFFERENCE, ["witness", "sizes", "n"], 9, "integer from 1 to 8"),
    (DIFFERENCE, ["witness", "numbers"], {"a": "1"}, "every symbol"),
    (DIFFERENCE, ["statement", "relation"], "!=", "may have no value at the witness|do not prove"),
    (DIFFERENCE, ["statement", "relation"], "<", "no order"),
    (DIFFERENCE, ["statement", "relation"], "~", "unknown relation"),
    (DIFFERENCE, ["statement", "given"], ["A = B"], "does not hold"),
    (DIFFERENCE, ["statement", "given"], ["trace(A) = 3"], "does not hold"),
    (DIFFERENCE, ["statement", "given"], ["A"], "hypothesis with ="),
    (DIFFERENCE, ["statement", "given"], ["A = A = A"], "more than one"),
    (DIFFERENCE, ["statement", "symbols"], {"trace__1": REAL}, "name of the checker"),
    (DIFFERENCE, ["statement", "symbols"], {"A": REAL}, "given twice"),
    (DIFFERENCE, ["statement", "symbols"], [], "by name"),
    (DIFFERENCE, ["statement", "dimensions"], ["n", "m", "A"], "given twice"),
    (DIFFERENCE, ["statement", "dimensions"], ["m"], "every dimension"),
    (DIFFERENCE, [*MATRICES, "A", "is"], ["regular"], "unknown property"),
    (DIFFERENCE, [*MATRICES, "A", "is"], ["positive"], "without its properties"),
    (DIFFERENCE, [*MATRICES, "A"], {"size": ["n", "m"], "is": ["symmetric"]}, "of square matrices"),
    (DIFFERENCE, [*MATRICES, "A"], {"size": [1, 1], "is": []}, "as a number"),
    (DIFFERENCE, [*MATRICES, "A"], {"size": ["n", "m"], "is": []}, "1 entries"),
    (DIFFERENCE, RIGHT, "1", "different shapes"),
    (DIFFERENCE, RIGHT, "A B", "more than one"),
    (DIFFERENCE, RIGHT, "A; B", "unexpected characters"),
    (DIFFERENCE, RIGHT, "C", "unknown name"),
    (DIFFERENCE, RIGHT, "A[1,2]", "more than one"),
    (DIFFERENCE, RIGHT, "A*B", "written with @"),
    (DIFFERENCE, RIGHT, "A/B", "division by a matrix"),
    (DIFFERENCE, RIGHT, "A**2", "power of a matrix"),
    (DIFFERENCE, RIGHT, "2**A", "power of a matrix"),
    (DIFFERENCE, RIGHT, "trace(A)**(1/2)*A", "no rational number"),
    (DIFFERENCE, RIGHT, "exp(trace(A))*A", "no rational number"),
    (DIFFERENCE, RIGHT, "exp(A)", "unknown function"),
    (DIFFERENCE, RIGHT, "det(A)*A", "unknown function"),
    (DIFFERENCE, RIGHT, "trace(A, B)*A", "wrong number"),
    (DIFFERENCE, RIGHT, "A.S", "expected T"),
    (DIFFERENCE, RIGHT, "2.T", "expected a matrix|expected T|unexpected"),
    (DIFFERENCE, RIGHT, "(2).T*A", "expected a matrix"),
    (DIFFERENCE, RIGHT, "(A", "no \\)"),
    (DIFFERENCE, RIGHT, "trace(A", "no \\)"),
    (DIFFERENCE, RIGHT, "eye(n", "no \\)"),
    (DIFFERENCE, RIGHT, "zeros(n)", "zeros\\(m, n\\)"),
    (DIFFERENCE, RIGHT, "eye(k)", "integer from"),
    (DIFFERENCE, RIGHT, "eye(m)", "different shapes"),
    (DIFFERENCE, RIGHT, "zeros(n, m)", "different shapes"),
    (DIFFERENCE, RIGHT, "zeros(n, m) @ A", "do not fit"),
    (DIFFERENCE, RIGHT, "inv(zeros(n, m))", "square matrix"),
    (DIFFERENCE, RIGHT, "inv(2)*A", "square matrix"),
    (DIFFERENCE, RIGHT, "trace(zeros(n, m))*A", "square matrix"),
    (DIFFERENCE, RIGHT, "dot(A, A)*A", "two vectors"),
    (DIFFERENCE, RIGHT, "2**(1/2)*A", "no rational number"),
    (DIFFERENCE, RIGHT, "A/0", "no rational|may not exist|division"),
    (ROOT, ["kind"], "words", "root or inverse power"),
    (WAVE, ["kind"], "words", "function of a trace"),
    (SAME, ["kind"], "words", "do not prove"),
    (TRACE, RIGHT, "m", "no value at the witness"),
    (TRACE, RIGHT, "1", "no value at the witness"),
    (TRACED, ["shares", 0, "word"], "B.T", "do not fit"),
    (TRACED, ["shares", 0, "word"], "", "do not fit"),
    (TRACED, ["shares", 0, "word"], None, "do not fit"),
    (TRACED, ["shares", 0, "left"], "B", "do not fit"),
    (TRACED, ["shares", 0, "right"], "B", "do not fit"),
    (LINE, ["statement", "given"], [], "no value at the witness|integer from|another sum"),
    (LINE, ["shares", 0, "word"], "u", "do not fit"),
    (LINE, [*POINT, "u"], [["1"], ["1"]], "does not hold"),
    (SCALED, RIGHT, "inv(A)*a", "no value at the witness"),
    (SCALED, ["witness", "numbers"], {"a": "0"}, "outside"),
    (DIVIDED, ["shares", 0, "coefficient"], "a*b/b", ""),
    (DIVIDED, ["shares", 0, "coefficient"], "a*a/a", "may not exist"),
    (DIVIDED, ["shares", 0, "coefficient"], "a + log(a) - log(a)", "may not exist"),
    (ORTHOGONAL, [*MATRICES, "U", "is"], [], "another sum|integer from|do not fit"),
    (ORTHOGONAL, [*MATRICES, "S", "is"], ["symmetric"], "without its properties"),
    (ORTHOGONAL, [*MATRICES, "E", "is"], ["symmetric"], "another sum|integer from"),
    (ORTHOGONAL, [*POINT, "U"], [["1", "1"], ["0", "1"]], "without its properties"),
    (ORTHOGONAL, [*POINT, "E"], [["1", "1"], ["1", "1"]], "without its properties"),
    (PUSHED, [*POINT, "P"], [["-1", "0"], ["0", "1"]], "without its properties"),
    (PUSHED, ["shares", 1, "left"], "inv__arg__1.T", "a letter"),
    (ONE_SIDED, ["statement", "given"], [], "integer from"),
    (ONE_SIDED, MATRICES, {"A": {"size": TALL, "is": []}, "B": {"size": FLAT, "is": []}}, "different shapes|entries"),
    (UNSAID, ["shares", 0, "relation"], 2, "integer from"),
    (RANK_ONE, RIGHT, "dot(u, u)*(u @ v.T)/(v.T @ u + 1)", "no value at the witness"),
    (COMMUTING, ["point", "matrices", "B"], [["1", "0"], ["0", "1"]], "holds there"),
    (COMMUTING, ["point", "sizes", "n"], 1, "1 entries"),
    (POWERS, ["point", "numbers"], {"x": "-1", "y": "2"}, "no rational number"),
    *((item, ["point", "matrices", "A"], [["1", "2"], ["3", "7"]], "without its properties") for item in PROPERTIES
      if item["statement"]["matrices"]["A"]["is"] != ["invertible"]),
    (PROPERTIES[3], ["point", "matrices", "A"], [["1", "2"], ["2", "4"]], "without its properties"),
    (PROPERTIES[2], ["statement", "matrices", "A", "size"], [9, 9], "entries"),
]  # fmt: skip


def changed(item: Any, path: list[Any], value: Any) -> Any:
    """A copy with one entry replaced."""
    forged = copy.deepcopy(item)
    place = forged
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return forged


def judge(item: Any, module: Any) -> str:
    """Why a certificate is refused; nothing for one that is accepted."""
    try:
        module.check(item)
    except module.Refused as refusal:
        return str(refusal) or "refused"
    return ""


#: Declared for the texts of KNOWN and TAKEN, and hypotheses of some.
DECLARED = {
    **dict.fromkeys("AB", SQUARE), **dict.fromkeys("VW", (SQUARE, "invertible")), "U": (SQUARE, "orthogonal"),
    **dict.fromkeys("PQ", (SQUARE, "positive")), "N": (SQUARE, "nonnegative"), "H": FLAT, "K": TALL,
    "E": (SQUARE, "symmetric"), "R": (["m", "m"], "positive"), "S": ["m", "m"], "u": ["n", 1], "v": ["n", 1],
}  # fmt: skip
NUMBERS = {"a": APART, "b": REAL, "c": ABOVE, "d": ["1", None, []], "e": ["0", None, []], "f": ["0", None, [*APART[2]]]}
#: Inverses and quotients that exist, by what is declared: positive sums, M N M', products of regular factors.
KNOWN = """inv(A @ A.T + eye(n)); inv(V @ V.T); inv(H @ P @ H.T + R); inv(H @ N @ H.T + R); inv(P + N); inv(-P)
inv(a*P); inv(c*P + Q); inv(P/c + Q); inv(c**2*P/3 + Q); inv(c*P/n + Q); inv(d*P + Q); inv(f*P + Q)
inv(a*c*P); inv(a**2*P)
inv((c + 2)*P + Q); inv(inv(P) + N); inv(V @ W); inv(V @ P @ V); inv(V @ P @ V.T + Q); inv(V @ N @ V.T + P)
inv(A @ V @ P @ V.T @ A.T + P); inv(U); inv(V.T); inv(H.T @ H + eye(n)); inv(H @ H.T + R); A/(1 + dot(u, u))
A/(1 + dot(u, N @ u)); A/(c + dot(u, u) + dot(v, v)); A/b; zeros(n, m) @ R; inv(eye(n)); 2*inv(P)
S = H @ P @ H.T + R: inv(S); S = inv(R): inv(S)"""
#: The same where it has to be assumed.
TAKEN = """inv(H @ E @ H.T + R); inv(A @ E @ A.T + P); inv(V @ E @ V.T)
inv(A @ A.T); inv(A @ A.T + N); inv(H @ A @ H.T + R); inv(H @ P @ H.T); inv(P - Q); inv(V + P); inv(N + N)
inv(- P + N); inv(b*P); inv(a*P + Q); inv(0*P); inv(2*N); inv(a*N); inv(e*P + Q); inv(b*c*P); inv((c + b)*P + Q)
inv((c - 2)*P); inv(inv(V) + Q); inv(V @ B); inv(V @ P @ V + Q); inv(V @ W @ V.T + P); inv(V @ W @ P @ V.T + P)
inv(U + P); inv(A.T); inv(H @ K); inv(zeros(n, n)); A/trace(B); A/dot(u, u); A/(1 + dot(u, v)); A/(1 + dot(u, A @ u))
A/(b + dot(u, u)); A/(dot(u, u) + dot(v, v)); A/(1 - dot(u, u)); H @ P @ H.T + R = S: inv(S); S + R = R: inv(S)
-S = R: inv(S)"""


def list_assumed(module: Any) -> Iterator[str]:
    """Which inverses and quotients are taken to exist without a reason, or not taken to."""
    for table, is_taken in ((KNOWN, False), (TAKEN, True)):
        for line in table.replace("\n", "; ").split("; "):
            given, _, text = line.rpartition(": ")
            inside = text[4:-1] if text.startswith("inv") else text[2:]
            expected = [f"{inside} invertible" if text.startswith("inv") else f"{inside} != 0"] * is_taken
            statement = state(text, text, given=[given] if given else [], symbols=NUMBERS, **DECLARED)
            algebra = module.Words(statement)
            algebra.state()
            if [*algebra.assumed] != expected:
                yield f"{[*algebra.assumed]}, not {expected}: {text}"


def discrepancies(module: Any) -> Iterator[str]:
    """What a module with the checker's names answers otherwise than it must."""
    yield from (f"refused: {item}: {judge(item, module)}" for item in TRUE if judge(item, module))
    for item, path, value, why in FORGERIES:
        answer = judge(changed(item, path, value), module)
        if (answer != "") != (why != "") or not re.search(why, answer):
            yield f"{path} {value}: expected {why or 'acceptance'}; got {answer or 'acceptance'}"
