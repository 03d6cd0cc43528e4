"""Candidates of matrix exponentials: functions of s that solve dX/ds = A X, X(0) = E; nothing is believed.

With the minimal polynomial m(x) of A, of degree d, exp(s A) = sum_i phi_i(s) B_i for a basis phi of the solutions of
m(D) phi = 0, and the matrices B_i solve sum_i phi_i^(j)(0) B_i = A^j for j = 0 ... d - 1 (Moler and Van Loan, Nineteen
dubious ways to compute the exponential of a matrix, 2003, sections 5 and 6). Factors of degree 1 and 2 are solved.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from math import isqrt
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from navsym.language.printer import to_text
from navsym.prove.rooms.goals import Hole, Holes, player, to_sympy, values_of

Entry = dict[str, Any]
Factor = tuple[tuple[sp.Expr, ...], int]  # the coefficients behind the first one, which is 1, and the multiplicity
MOST_HYPOTHESES, MOST_DEGREE = 3, 8
X = sp.Symbol("x")


def list_exponentials(question: Any, goal: Any) -> Iterator[Callable[[], Entry]]:
    """Entries for the rule of a matrix exponential, each made anew with empty holes."""
    n = isqrt(len(question.term) - 1)
    matrix = sp.Matrix(n, n, [to_sympy(entry) for entry in question.term[1:]])
    for solution in list_solutions(matrix, sp.Symbol(question.variable, real=True), goal):
        rows = [[to_text(entry) for entry in row] for row in solution.tolist()]
        for plain in (True, False):
            yield functools.partial(make_entry, rows, plain)


def make_entry(rows: list[list[str]], plain: bool) -> Entry:
    """The entry of the rule, with holes."""
    count = len(rows) ** 2
    proofs = [[None if plain else Hole() for _ in range(count)] for _ in range(2)]
    return {"rows": rows, "smooth": Holes(), "equal": proofs[0], "start": proofs[1]}


def list_solutions(matrix: sp.Matrix, s: sp.Symbol, goal: Any) -> Iterator[sp.Matrix]:
    """Closed forms of exp(s A)."""
    whole = DomainMatrix.from_Matrix(matrix).to_field()
    factors = [factor for factor in factor_characteristic(whole, goal) if factor is not None]
    degree = sum(len(tail) * times for tail, times in factors)
    if degree != matrix.rows or degree > 16:
        return
    factors = take_minimal(whole, factors)
    degree = sum(len(tail) * times for tail, times in factors)
    if degree > MOST_DEGREE and any(any(tail) for tail, _ in factors):
        return
    functions: list[sp.Expr] = []
    values: dict[sp.Symbol, sp.Expr] = {}
    for tail, times in factors:
        basis = list_basis(tail, s, goal, values)
        if basis is None:
            return
        functions += [s**k * f for k in range(times) for f in basis]
    slopes = sp.Matrix(degree, degree, lambda j, i: sp.diff(functions[i], s, j).subs(s, 0))
    shares = slopes.inv().applyfunc(sp.cancel)
    powers = [sp.eye(matrix.rows)]
    while len(powers) < degree:
        powers.append(powers[-1] * matrix)
    total = sp.zeros(*matrix.shape)
    for i, f in enumerate(functions):
        share = sum((shares[i, j].xreplace(values) * powers[j] for j in range(degree)), sp.zeros(*matrix.shape))
        total += share.applyfunc(tidy) * f.xreplace(values)
    yield total


def tidy(entry: sp.Expr) -> sp.Expr:
    """A rational function without common factors; what has a root stays as it is."""
    return entry if any(p.exp.is_Rational and p.exp.q > 1 for p in entry.atoms(sp.Pow)) else sp.cancel(entry)


def factor_characteristic(whole: DomainMatrix, goal: Any) -> Iterator[Factor | None]:
    """The irreducible factors of the characteristic polynomial, reduced by few hypotheses; None for a high degree."""
    coefficients = [whole.domain.to_sympy(c) for c in whole.charpoly()]
    if 0 < len(goal.zeros) <= MOST_HYPOTHESES:
        zeros = [to_sympy(t) for t in goal.zeros]
        letters = sorted(set().union(*(z.free_symbols for z in zeros)), key=str)
        basis = sp.groebner(zeros, *letters).exprs
        coefficients = [sp.reduced(c, basis, *letters)[1] if c.is_polynomial(*letters) else c for c in coefficients]
    polynomial = sum((c * X**k for k, c in enumerate(reversed(coefficients))), sp.S.Zero)
    for factor, times in sp.factor_list(sp.numer(sp.together(polynomial)), X)[1]:
        first, *tail = sp.Poly(factor, X).all_coeffs()
        if factor.has(X):
            yield (tuple(sp.cancel(c / first) for c in tail), int(times)) if len(tail) < 3 else None


def take_minimal(whole: DomainMatrix, factors: list[Factor]) -> list[Factor]:
    """The factors with the least multiplicities for which their product vanishes at the matrix."""
    size = whole.shape[0]
    one = DomainMatrix.eye(size, whole.domain)

    def is_zero(chosen: list[Factor]) -> bool:
        product = one
        for tail, times in chosen:
            value = one
            for c in tail:
                value = value * whole + one * whole.domain.from_sympy(c)
            product = product * value**times
        return bool(product.is_zero_matrix)

    for k, (tail, times) in enumerate(factors):
        for fewer in range(1, times):
            chosen = [*factors[:k], (tail, fewer), *factors[k + 1 :]]
            try:
                if is_zero(chosen):
                    factors = chosen
                    break
            except sp.polys.polyerrors.BasePolynomialError:  # a coefficient that the hypotheses have changed
                return factors
    return factors


def list_basis(
    tail: tuple[sp.Expr, ...], s: sp.Symbol, goal: Any, values: dict[sp.Symbol, sp.Expr]
) -> list[sp.Expr] | None:
    """Solutions for a factor; ``values`` gets what its new letters are. None where the sign below a root changes."""

    def name(value: sp.Expr) -> sp.Symbol:
        letter = sp.Symbol(f"z{len(values)}", real=True)
        values[letter] = value
        return letter

    if len(tail) == 1:
        return [sp.exp(name(-tail[0]) * s) if tail[0] != 0 else sp.S.One]
    b, c = tail
    square = sp.factor(c - b**2 / 4)
    term = player.parse(to_text(square))
    signs = values_of(goal._replace(zeros=()), term) if square.free_symbols else [player.value_of(term, {})]
    if not signs or not (all(v > 0 for v in signs) or all(v < 0 for v in signs)):
        return None
    omega, decay = name(find_root(square if signs[0] > 0 else -square, goal)), name(-b / 2) if b != 0 else sp.S.Zero
    functions = (sp.cos, sp.sin) if signs[0] > 0 else (sp.cosh, sp.sinh)
    return [sp.exp(decay * s) * f(omega * s) for f in functions]


def find_root(square: sp.Expr, goal: Any) -> sp.Expr:
    """A root, up to its sign, with no more below the radical than has to stand there."""
    root, rest = sp.S.One, sp.S.One
    for part, sign in zip(sp.fraction(square), (1, -1), strict=True):
        content, factors = sp.factor_list(part)
        root *= sp.sqrt(abs(content)) ** sign
        rest *= sp.sign(content)
        for f, times in factors:
            root *= f ** (sign * (times // 2))
            low = values_of(goal._replace(zeros=()), player.parse(to_text(f))) if times % 2 else []
            alone = bool(low) and all(v > 0 for v in low)
            root *= sp.sqrt(f) ** sign if alone else 1
            rest *= 1 if alone or not times % 2 else f**sign
    return root * sp.sqrt(rest)
