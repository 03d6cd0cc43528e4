"""Condition numbers for Coq: bounds of |N x| by sums of squares, and vectors at which they are nearly reached."""

from __future__ import annotations

from collections.abc import Mapping
from math import isqrt, lcm
from typing import Any, NamedTuple

from flint import arb, ctx, fmpq, fmpq_mat, fmpz_mat

from navsym import checker
from navsym.export.coq.terms import Unwritten

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
    N = [[(x * times).p for x in row] for row in rows]
    matrix = f"matrix_{name}"
    sight = Sight(fmpz_mat(N), unit, f"{matrix} ({'column_squares' if unit else 'ones'} {matrix})")
    a, b, c, d = (checker.read_number(x) * (1 if unit else times**2) for x in part["brackets"])
    is_above = outside and high * high < a / d
    end = (high + root(a / d)) / 2 if is_above else (low + root(b / c)) / 2 if outside else high
    regular = sight.bound(2 * root(b / c) + 1 if is_above else end, b, c)
    script = [f"destruct ({regular}) as [regular bound]. split; [exact regular |]."]
    if not outside:
        script += [f"split; [exact ({sight.reach(low, b, c)}) | exact bound]."]
    elif is_above:
        script += [f"right. exists ({write(end)}). split; [lra | exact ({sight.reach(end, b, c)})]."]
    else:
        script += [f"left. exists ({write(end)}). split; [lra | exact bound]."]
    words = f"The condition number of the matrix{', its columns of unit length,' * unit} lies"
    words += f" {'outside of' if outside else 'between'} {low} and {high}; the matrix times {times} follows."
    says = f"{'beyond' if outside else 'within'} {sight.terms} ({write(low)}) ({write(high)})"
    lines = [f"(* {words} *)", f"Definition {matrix} : list (list Z) := {write_rows(N)}."]
    return "\n".join([*lines, f"Theorem {name} : {says}.", "Proof.", *script, "Qed.", ""])


class Sight(NamedTuple):
    """A matrix of whole numbers, whether its columns are taken with unit length, and both as terms of Coq."""

    matrix: fmpz_mat
    unit: bool
    terms: str

    def forms(self) -> tuple[fmpq_mat, fmpq_mat]:
        """The matrices of |N x|^2 and |x|^2."""
        gram, n = fmpq_mat(self.matrix.transpose() * self.matrix), self.matrix.ncols()
        length = fmpq_mat(n, n)
        for j in range(n):
            length[j, j] = gram[j, j] if self.unit else 1
        return gram, length

    def bound(self, q: fmpq, b: fmpq, c: fmpq) -> str:
        """A proof that the condition number is at most q: |N x|^2 <= b' |x|^2 and |N x|^2 >= c' |x|^2, b' = q^2 c'."""
        above = b * (1 + (q * q * c / b - 1) / 3)
        below, (gram, length) = above / (q * q), self.forms()
        numbers = [above.q, above.p, below.q, below.p]
        s, first = find_squares(length * above.p - gram * above.q, length * (above.q * (above - b) / 2))
        t, second = find_squares(gram * below.q - length * below.p, length * (below.q * (c - below) / 2))
        return self.prove("at_most", q, *(f"({x})" for x in (*numbers, s, t)), write_rows(first), write_rows(second))

    def reach(self, q: fmpq, b: fmpq, c: fmpq) -> str:
        """A proof that the condition number is at least q: vectors near to those of its two singular values."""
        gram, length = self.forms()
        for digits in DIGITS:
            x, y = (find_vector(length * limit - gram, length, digits) for limit in (b, c))
            x, y = (x, y) if q > 1 else (x, x)
            (seen, size), (least, other) = ([(v.transpose() * A * v)[0, 0] for A in (gram, length)] for v in (x, y))
            if q * q * least * size <= seen * other:
                return self.prove("at_least", q, *(f"{write_row(v.entries())}%Z" for v in (x, y)))
        raise Unwritten("no vectors that show the condition number")

    def prove(self, name: str, q: fmpq, *words: str) -> str:
        """A lemma of ``condition.v`` whose numbers are compared by computation."""
        return f"show_{name} {self.terms} ({q.p}) ({q.q}) {' '.join(words)} ltac:(vm_cast_no_check (eq_refl true))"


def find_squares(form: fmpq_mat, spare: fmpq_mat) -> tuple[int, list[list[int]]]:
    """A factor s and rows r, such that s times the form less all (r x)^2 has squares that outweigh its products.

    The squares of the rows nearly sum up to s times the form less what is spare.
    """
    ctx.prec, n = 4000, form.nrows()
    roots = take_roots(form - spare)
    for bits in BITS:
        rows = [[int((x * 2**bits).mid().floor().unique_fmpz()) for x in row] for row in roots]
        squares = fmpz_mat(rows)
        rest = form * 4**bits - fmpq_mat(squares.transpose() * squares)
        if all(2 * rest[i, i] >= sum(abs(rest[i, j]) for j in range(n)) for i in range(n)):
            return 4**bits, rows
    raise Unwritten("no squares that show the condition number")


def take_roots(form: fmpq_mat) -> list[list[arb]]:
    """Rows whose squares sum up to the form (Cholesky)."""
    rest, rows = [[arb(x) for x in row] for row in form.tolist()], []
    while rest:
        (pivot, *row), *below = rest
        if not pivot > 0:
            raise Unwritten("a form that may be negative")
        rows.append([arb(0)] * len(rows) + [x / pivot.sqrt() for x in (pivot, *row)])
        rest = [[x - first / pivot * y for x, y in zip(other, row, strict=True)] for first, *other in below]
    return rows


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


def write(q: fmpq) -> str:
    """A rational number as a fraction of real numbers."""
    return f"{q.p} / {q.q}" if q >= 0 else f"(- {-q.p}) / {q.q}"


def write_rows(rows: list[list[Any]]) -> str:
    """A list of rows of whole numbers."""
    return f"[{'; '.join(map(write_row, rows))}]%Z"


def write_row(row: list[Any]) -> str:
    """A list of whole numbers."""
    return f"[{'; '.join(map(str, row))}]"
