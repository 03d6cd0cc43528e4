"""Condition numbers for Coq: bounds of |N x| by sums of squares, and vectors at which they are nearly reached."""

from __future__ import annotations

from collections.abc import Mapping
from math import isqrt, lcm
from typing import Any, NamedTuple

from flint import arb, ctx, fmpq, fmpq_mat, fmpz_mat

from navsym import checker
from navsym.export.coq.terms import Unwritten
from navsym.prove.rooms.quadrics import split_squares

#: Powers of two and of ten by which roots and vectors are multiplied before they are rounded, one after the other.
BITS, DIGITS = range(0, 4000, 60), (20, 40, 80, 160, 320)


def write_condition(name: str, part: Mapping[str, Any]) -> str:
    """The theorem that a condition number lies between two numbers, or outside, with its script.

    The condition number of N is the quotient of the largest and the smallest |N x| / |x|; with columns of unit length
    |x|^2 is the sum of |column|^2 x_j^2. Neither changes when N is multiplied by a number.
    """
    statement, outside = part["statement"], part["outside"]
    rows = [[checker.read_number(x) for x in row] for row in statement["matrix"]]
    low, high = checker.read_number(statement["lower"]), checker.read_number(statement["upper"])
    times, unit = lcm(*(int(x.q) for row in rows for x in row)), statement["unit"]
    N = [[int((x * times).p) for x in row] for row in rows]
    a, b, c, d = (checker.read_number(x) * (1 if unit else times**2) for x in part["brackets"])
    pair = Pair.of(fmpq_mat(fmpz_mat(N)), unit, f"matrix_{name} ({'column_squares' if unit else 'ones'} matrix_{name})")
    is_above = outside and high * high < a / d
    end = (high + root(a / d)) / 2 if is_above else (low + root(b / c)) / 2 if outside else high
    if not outside:
        ending = f"split; [exact ({pair.reach(low, b, c)}) | exact bound]"
    else:
        side, reason = ("right", pair.reach(end, b, c)) if is_above else ("left", "bound")
        ending = f"{side}. exists ({end.p} / {end.q}). split; [lra | exact ({reason})]"
    words = f"The condition number of the matrix{', its columns of unit length,' * unit} lies"
    words += f" {'outside of' if outside else 'between'} {low} and {high}; the matrix times {times} follows."
    says = f"{'beyond' if outside else 'within'} {pair.terms} ({low.p} / {low.q}) ({high.p} / {high.q})"
    regular = pair.bound(2 * root(b / c) + 1 if is_above else end, b, c)
    return f"""(* {words} *)
Definition matrix_{name} : list (list Z) := {write_rows(N)}.
Theorem {name} : {says}.
Proof.
destruct ({regular}) as [regular bound]. split; [exact regular |].
{ending}.
Qed.
"""


class Pair(NamedTuple):
    """The quadratic forms |N x|^2 and |x|^2, and N with the weights of |x|^2 as terms of Coq."""

    seen: fmpq_mat
    size: fmpq_mat
    terms: str

    @staticmethod
    def of(N: fmpq_mat, unit: bool, terms: str) -> Pair:
        """From N, and whether its columns are taken with unit length."""
        gram, n = N.transpose() * N, N.ncols()
        entries = [(gram[i, i] if unit else 1) if i == j else 0 for i in range(n) for j in range(n)]
        return Pair(gram, fmpq_mat(n, n, entries), terms)

    def bound(self, q: fmpq, b: fmpq, c: fmpq) -> str:
        """A proof that the condition number is at most q: |N x|^2 <= b' |x|^2 and |N x|^2 >= c' |x|^2, b' = q^2 c'."""
        above = b * (1 + (q * q * c / b - 1) / 3)
        below = above / (q * q)
        s, first = find_squares(self.size * above.p - self.seen * above.q, self.size * (above.q * (above - b) / 2))
        t, second = find_squares(self.seen * below.q - self.size * below.p, self.size * (below.q * (c - below) / 2))
        numbers = " ".join(f"({x})" for x in (above.q, above.p, below.q, below.p, s, t))
        return self.prove("at_most", q, f"{numbers} {write_rows(first)} {write_rows(second)}")

    def reach(self, q: fmpq, b: fmpq, c: fmpq) -> str:
        """A proof that the condition number is at least q: vectors near to those of its two singular values."""
        for digits in DIGITS:
            x, y = (find_vector(self.size * limit - self.seen, self.size, digits) for limit in (b, c if q > 1 else b))
            (seen, size), (least, other) = ([(v.transpose() * A * v)[0, 0] for A in self[:2]] for v in (x, y))
            if q * q * least * size <= seen * other:
                return self.prove("at_least", q, " ".join(write_rows([*map(int, v.entries())]) for v in (x, y)))
        raise Unwritten("no vectors that show the condition number")

    def prove(self, name: str, q: fmpq, words: str) -> str:
        """A lemma of ``condition.v`` whose numbers are compared by computation."""
        return f"show_{name} {self.terms} ({q.p}) ({q.q}) {words} ltac:(vm_cast_no_check (eq_refl true))"


def find_squares(form: fmpq_mat, spare: fmpq_mat) -> tuple[int, list[list[int]]]:
    """A factor s and rows r, such that s times the form less all (r x)^2 has squares that outweigh its products.

    The squares of the rows nearly sum up to s times the form less what is spare.
    """
    n, squares = form.nrows(), split_squares((form - spare).tolist())
    for bits in BITS if squares else ():
        with ctx.workprec(4000):
            rows = [
                [int((arb(d * 4**bits).sqrt() * x).mid().floor().unique_fmpz() or 0) for x in r]
                for d, r in squares or ()
            ]
        rest = form * 4**bits - fmpq_mat(fmpz_mat(rows).transpose() * fmpz_mat(rows))
        if all(2 * rest[i, i] >= sum(abs(rest[i, j]) for j in range(n)) for i in range(n)):
            return 4**bits, rows
    raise Unwritten("no squares that show the condition number")


def find_vector(shifted: fmpq_mat, length: fmpq_mat, digits: int) -> fmpq_mat:
    """A vector of whole numbers near to that which a nearly singular matrix enlarges least."""
    v = fmpq_mat([[k + 1] for k in range(shifted.nrows())])
    for _ in range(2):
        v = shifted.solve(length * v)
        largest = max(map(abs, v.entries()))
        v = fmpq_mat([[(x * 10**digits / largest).floor()] for x in v.entries()])
    return v


def root(q: fmpq) -> fmpq:
    """A square root to sixty digits, rounded down."""
    return fmpq(isqrt(int(q.p * 10**120 // q.q)), 10**60)


def write_rows(rows: list[Any]) -> str:
    """Whole numbers, or rows of them, as a list of Coq."""
    return f"{rows}%Z".replace(",", ";")
