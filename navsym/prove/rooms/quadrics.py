"""Quadratic inequalities below quadratic hypotheses: f = sum l_k h_k + sum m_j g_j + a sum of squares (the S-lemma).

With hypotheses h_k = 0 and g_j >= 0 the multipliers l_k and m_j >= 0 make the matrix of f - sum l_k h_k - sum m_j g_j
in (1, x) positive semidefinite (Yakubovich 1971; Boyd and Vandenberghe, Convex Optimization, 2004, appendix B.2). They
are sought by an interior point method, rounded to simple fractions, and the squares come from an exact L D L'; the
checker multiplies out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import chain
from typing import Any

from flint import Ordering, arb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from navsym.prove.rooms.goals import Hole, Holes, Proof, Term, player, write_number, write_term

MOST_SYMBOLS, MANY_SYMBOLS, MOST_HYPOTHESES = 20, 4, 60
DENOMINATORS = (1, 2, 4, 3, 6, 8, 12, 5, 60)
Rows = list[list[fmpq]]


def by_quadrics(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The rule ``modulo`` to a sum of squares and of hypotheses >= 0."""
    is_free = not (goal.zeros or goal.given)
    if goal.relation != ">=" or (is_free and len(player.symbols_of(goal.term)) < MANY_SYMBOLS):
        return  # few symbols are soon completed to squares one after the other
    found = find_sum(goal.term, goal.zeros, goal.given)
    if found is not None:
        total, cofactors, proofs = found
        inner: Proof = {"rule": "sum", "proofs": [Hole() if p is None else dict(p) for p in proofs], "strict": 0}
        yield {"rule": "modulo", "to": total, "cofactors": [*cofactors], "defined": Holes(), "proof": inner}


@lru_cache(maxsize=256)
def find_sum(
    term: Term, zeros: tuple[Term, ...], given: tuple[Term, ...]
) -> tuple[str, list[str], list[Proof | None]] | None:
    """The sum as text, the cofactors of ``zeros``, and a proof for each of its terms; None for that of a square.

    Hypotheses on roots and other functions are not used.
    """
    plain = {t for t in (term, *zeros, *given) if all(g[0] == "symbol" for g in player.list_generators(t))}
    parts = [*dict.fromkeys(g for t in (term, *zeros, *given) if t in plain for g in player.list_generators(t))]
    if term not in plain or len(parts) > MOST_SYMBOLS:
        return None
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(parts))], Ordering.degrevlex)
    generators = dict(zip(parts, ring.gens(), strict=True))
    target, *others = [
        read_quadric(t, generators, ring, len(parts)) if t in plain else None for t in (term, *zeros, *given)
    ]
    if target is None or len(others) > MOST_HYPOTHESES:
        return None
    without = ([fmpq(0)] * len(zeros), [fmpq(0)] * len(given))
    used = list_multipliers(target, others, len(zeros)) if any(rows is not None for rows in others) else ()
    for shares, weights in chain((without,), used):
        squares = split_squares(combine(target, others, [-s for s in (*shares, *weights)]))
        if squares is None:
            continue
        terms = [("*", player.number(w), g) for w, g in zip(weights, given, strict=True) if w]
        proofs: list[Proof | None] = [
            {"rule": "given", "weights": [write_number(w) if j == k else "0" for j in range(len(given))]}
            for k, w in enumerate(weights)
            if w
        ]
        for d, row in squares:
            inner = [("*", player.number(c), p) for c, p in zip(row, (player.ONE, *parts), strict=True) if c != 0]
            terms.append(("*", player.number(d), ("^", ("+", player.ZERO, *inner), player.number(2))))
        proofs += [None] * len(squares)
        while len(terms) < 2:  # a sum has two terms
            terms, proofs = [*terms, player.ZERO], [*proofs, {"rule": "identity"}]
        return write_term(("+", *terms)), [write_number(s) for s in shares], proofs
    return None


def read_quadric(term: Term, generators: dict[Term, fmpq_mpoly], ring: Any, n: int) -> Rows | None:
    """The symmetric matrix of a polynomial of degree two in (1, x); None for any other term."""
    top, bottom = player.to_quotient(term, generators, ring)
    if not bottom.is_constant() or bottom == 0 or top.total_degree() > 2:
        return None
    rows = [[fmpq(0)] * (n + 1) for _ in range(n + 1)]
    scale = next(iter(bottom.to_dict().values()))
    for powers, c in top.to_dict().items():
        places = [k + 1 for k, q in enumerate(powers) for _ in range(int(q))]
        i, j = ([0, 0, *places])[-2:]
        rows[i][j] += c / scale / 2
        rows[j][i] += c / scale / 2
    return rows


def combine(target: Rows, others: Sequence[Rows | None], shares: Sequence[fmpq]) -> Rows:
    """The target and a sum of multiples of others."""
    rows = [[*row] for row in target]
    for other, share in zip(others, shares, strict=True):
        if other is not None and share != 0:
            rows = [[a + share * b for a, b in zip(r, s, strict=True)] for r, s in zip(rows, other, strict=True)]
    return rows


def list_multipliers(target: Rows, others: Sequence[Rows | None], free: int) -> Iterator[tuple[list[fmpq], list[fmpq]]]:
    """Candidates, from the coarsest rounding to the finest; all but the first ``free`` ones are >= 0."""
    values = solve_cone(target, others, free)
    seen = set()
    for denominator in DENOMINATORS if values else ():
        fractions = tuple(Fraction(round(v * denominator), denominator) for v in values or ())
        if fractions not in seen and all(w >= 0 for w in fractions[free:]):
            seen.add(fractions)
            exact = [fmpq(q.numerator, q.denominator) for q in fractions]
            yield exact[:free], exact[free:]


def solve_cone(target: Rows, others: Sequence[Rows | None], free: int) -> list[float] | None:
    """Multipliers in floats with target - sum of multiples semidefinite, of least sum of sizes: few are not 0.

    A multiplier of any sign is the difference of two that are >= 0.
    """
    import clarabel
    import numpy as np
    from scipy import sparse

    n = len(target)
    places = [(i, j) for j in range(n) for i in range(j + 1)]  # the upper triangle by columns

    def write(rows: Rows, sign: int = 1) -> Any:
        entries = [(rows[i][j] * sign, 1.0 if i == j else 2**0.5) for i, j in places]
        return np.array([int(q.p) / int(q.q) * scale for q, scale in entries])

    used = [(k, sign) for k, rows in enumerate(others) if rows is not None for sign in ((1, -1) if k < free else (1,))]
    columns = [write(others[k], sign) for k, sign in used]  # type: ignore[arg-type]
    size = len(used)
    A = sparse.vstack([sparse.csc_matrix(np.column_stack(columns)), -sparse.identity(size)]).tocsc()
    b = np.concatenate([write(target), np.zeros(size)])
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_iter = False, 60
    cones = [clarabel.PSDTriangleConeT(n), clarabel.NonnegativeConeT(size)]
    costs = 1 + np.array([k for k, _ in used]) / 100  # of hypotheses that repeat others the first ones
    found = clarabel.DefaultSolver(sparse.csc_matrix((size, size)), costs, A, b, cones, settings).solve()
    if "Solved" not in str(found.status):
        return None
    values = [0.0] * len(others)
    for (place, sign), value in zip(used, found.x, strict=True):
        values[place] += sign * float(value)
    return values


def split_squares(rows: Rows) -> list[tuple[fmpq, list[fmpq]]] | None:
    """d_k > 0 and rows r_k with M = sum d_k r_k' r_k, by L D L'; None for a matrix that is not semidefinite."""
    rest, found = [[*row] for row in rows], []
    for k in range(len(rows)):
        pivot = rest[k][k]
        if pivot < 0 or (pivot == 0 and any(c != 0 for c in rest[k])):
            return None
        if pivot == 0:
            continue
        row = [c / pivot for c in rest[k]]
        found.append((pivot, row))
        rest = [[a - pivot * row[i] * row[j] for j, a in enumerate(line)] for i, line in enumerate(rest)]
    return found
