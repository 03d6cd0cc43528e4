"""Transition matrices exp(A t) of constant systems in closed form, with symbols for parameters.

The characteristic polynomial p of A is factored over Q(parameters), p = prod q_i^{m_i}. By the
Chinese remainder theorem there are polynomials E_i with E_i = 1 modulo q_i^{m_i} and E_i = 0
modulo the other factors, so that

    exp(A t) = sum_i E_i(A) r_i(A, t),      r_i(x, t) = exp(x t) modulo q_i^{m_i},

and r_i has a closed form for linear, quadratic and biquadratic factors (:mod:`transition_factors`);
other factors leave a sum over their roots. All arithmetic is exact, over polynomials in the
parameters. Gantmacher, The Theory of Matrices, vol. 1, chapter 5.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError, TooLargeError
from navsym.core.rational_functions import (
    Quotient,
    add_fractions,
    cancel_fraction,
    clear_denominators,
    factor_exactly,
    multiply_coefficients,
    polynomial_sum,
)
from navsym.models.linear import LinearModel, exact_entry, need_square
from navsym.models.transition.factors import closed_form
from navsym.models.transition.pieces import Form, Surd, Wave
from navsym.models.transition.rings import (
    Poly,
    Ring,
    companion_inverse,
    monic_division,
    monic_remainder,
    mu_coefficients,
    reduce_squares,
    ring_fraction,
    ring_of,
    write_quotient,
)

#: More states than this are refused: the number of terms grows too fast to be of use.
LARGEST = 16
#: Terms allowed in one polynomial on the way to the characteristic polynomial.
TERMS = 4000
Matrix = list[list[Poly]]


@dataclass(frozen=True, slots=True, eq=False)
class TransitionMatrix:
    """exp(A s) with its conditions.

    matrix      : (n, n) closed form
    time        : s, a symbol or an expression such as T - tau
    assumptions : relations that the formula takes to hold: divisors that are not zero, and
                  radicands that are positive when the form is to be read over the reals
    system      : A
    factors     : (factor of the characteristic polynomial in ``eigenvalue``, multiplicity, kind of form)
    """

    matrix: sp.ImmutableMatrix
    time: sp.Expr
    assumptions: tuple[sp.Basic, ...]
    system: sp.ImmutableMatrix
    factors: tuple[tuple[sp.Expr, int, str], ...] = ()


def transition_matrix(A: Any, time: Any, *, where: Mapping[sp.Symbol, Any] | None = None) -> TransitionMatrix:
    """exp(A time) of a constant matrix in closed form.

    A     : (n, n) exact entries: rational functions of parameters; other constants such as
            sin(latitude) count as parameters
    time  : an expression that does not occur in A
    where : exact values put in for parameters *before* the derivation; the way to a degenerate
            case that the generic formula excludes (``{w: 0}`` where it assumes w != 0)

    Raises ShapeError, DomainError (A depends on the time, or is degenerate for every value of its
    parameters, or has a repeated factor without closed form), TooLargeError (more than 16 states).
    """
    system = need_square("A", A)
    if where:
        system = need_square("A", system.subs(dict(where), simultaneous=True))
    moment = exact_entry("time", 0, 0, time)
    refuse_system(system, moment)
    ring = ring_of(system)
    fractions = [[ring_fraction(ring, entry) for entry in row] for row in system.tolist()]
    B, divisor = clear_denominators(fractions, ring.one)
    characteristic = characteristic_polynomial(ring, B)
    forms = [
        closed_form(ring, base, times, divisor, moment) for base, times in irreducible_divisors(ring, characteristic)
    ]
    terms = [term for form in forms for term in terms_of(ring, B, characteristic, form)]
    if any(reduce_squares(ring, term.divisor).is_zero() for term in terms):  # by sin^2 + cos^2 = 1 and the like
        raise dependence_error()
    matrix, divisors = assemble_matrix(ring, system.rows, terms)
    return TransitionMatrix(
        matrix=matrix,
        time=moment,
        assumptions=list_conditions(ring, [divisor, *divisors], forms),
        system=system,
        factors=tuple((form.factor, form.times, form.kind) for form in forms),
    )


def refuse_system(system: sp.ImmutableMatrix, time: sp.Expr) -> None:
    """Systems for which no closed form is looked for."""
    if system.rows > LARGEST:
        raise TooLargeError(f"A: expected at most {LARGEST} states; got {system.rows}; split the system into blocks")
    if time.free_symbols & system.free_symbols:
        raise DomainError(f"A: expected a constant matrix; got one that contains {time}; rename the time")


@dataclass(frozen=True, slots=True, eq=False)
class Regressors:
    """Measurements referred to the state at the end of the interval: z(tau) = H(tau)^T q + r, q = x(T).

    matrix      : (p, n), one row H_j(tau)^T per measurement
    end, time   : T and tau
    assumptions : as in :class:`TransitionMatrix`
    """

    matrix: sp.ImmutableMatrix
    end: sp.Expr
    time: sp.Expr
    assumptions: tuple[sp.Basic, ...]


def regressors(model: LinearModel, end: Any, time: Any) -> Regressors:
    """H(tau)^T = h exp(F (tau - T)) in closed form, one row per measurement.

    end, time : T and tau, expressions that do not occur in F

    The exponential is built as exp(-F (T - tau)): the elapsed time T - tau is not negative, and
    formulas are written in it. F must be constant; a measurement row may depend on the time.
    """
    need_constant(model, matrix_only=True)
    end, time = (exact_entry(name, 0, 0, value) for name, value in (("T", end), ("tau", time)))
    backward = transition_matrix(-model.F, end - time)
    rows = model.H.subs(model.time, time) * backward.matrix
    return Regressors(rows.applyfunc(spread_products), end, time, backward.assumptions)


def need_constant(model: LinearModel, *, matrix_only: bool = False) -> None:
    """DomainError when F (or, unless matrix_only, H) contains the time."""
    varying = model.time in model.F.free_symbols if matrix_only else not model.constant
    if varying:
        raise DomainError(
            f"F: expected a constant matrix; got one that contains the time {model.time}; "
            "give the motion in pieces, or the regressors themselves"
        )


def spread_products(entry: sp.Expr) -> sp.Expr:
    """A sum with its products spread out, unless that makes it longer; arguments stay as they are."""
    spread = sp.Add(*(sp.expand_mul(term, deep=False) for term in sp.Add.make_args(entry)))
    return spread if spread.count_ops() <= entry.count_ops() else entry


# --- from A to polynomials ---------------------------------------------------------------------


def characteristic_polynomial(ring: Ring, B: Matrix) -> list[Poly]:
    """Coefficients of det(mu - B), lowest first and monic: Faddeev and Leverrier."""
    n = len(B)
    result = [ring.zero] * n + [ring.one]
    M = [[ring.zero] * n for _ in range(n)]
    for k in range(1, n + 1):
        M = matrix_product(B, M)
        need_short(M)
        for i in range(n):
            M[i][i] += result[n - k + 1]
        trace = sum((B[i][j] * M[j][i] for i in range(n) for j in range(n)), ring.zero)
        result[n - k] = reduce_squares(ring, trace / -k)
    return result


def need_short(M: Matrix) -> None:
    """Refuse before the polynomials outgrow any use; a dense matrix of n^2 symbols has n! terms."""
    longest = max(len(entry) for row in M for entry in row)
    if longest > TERMS:
        raise TooLargeError(
            f"A: expected polynomials of at most {TERMS} terms; got {longest}; put in numbers for parameters "
            "or split the system"
        )


def matrix_product(X: Matrix, Y: Matrix) -> Matrix:
    """Product of matrices of polynomials; zeros, of which models are full, cost nothing."""
    rows = [[(j, x) for j, x in enumerate(row) if not x.is_zero()] for row in X]
    zero = X[0][0] * 0
    return [[reduce(lambda s, jx: s + jx[1] * Y[jx[0]][c], row, zero) for c in range(len(Y[0]))] for row in rows]


def irreducible_divisors(ring: Ring, monic: list[Poly]) -> list[tuple[list[Poly], int]]:
    """Irreducible monic factors with multiplicities, the zero eigenvalue first, then by degree."""
    whole = sum((c * ring.mu**k for k, c in enumerate(monic)), ring.zero)
    found = []
    for base, times in factor_exactly(whole)[1]:
        parts = mu_coefficients(ring, base)
        found.append(([part / parts[-1] for part in parts], int(times)))
    return sorted(found, key=lambda item: (len(item[0]), not item[0][0].is_zero(), str(item[0])))


# --- from polynomials to the matrix --------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Term:
    """(sum of waves) * M / divisor: one summand of the transition matrix."""

    waves: tuple[Wave, ...]
    M: Matrix
    divisor: Poly


def terms_of(ring: Ring, B: Matrix, characteristic: list[Poly], form: Form) -> list[Term]:
    """E_i(B) r_i(B, t) of one factor, one term for each piece of its form."""
    power = reduce(lambda x, _: multiply_coefficients(x, form.base), range(form.times), [ring.one])
    cofactor, _ = monic_division(ring, characteristic, power)
    inverse, resultant = companion_inverse(ring, monic_remainder(ring, cofactor, power), power)
    projected = [matrix_polynomial(ring, cofactor, B)]
    for _ in range(len(power) - 2):
        projected.append(matrix_product(projected[-1], B))
    return [
        Term(piece.waves, combine_matrices(ring, weights, projected), resultant)
        for piece in form.pieces
        for weights in [monic_remainder(ring, multiply_coefficients(piece.poly, inverse), power)]
    ]


def matrix_polynomial(ring: Ring, poly: list[Poly], B: Matrix) -> Matrix:
    """poly(B) by Horner's rule."""
    n = len(B)
    result = [[poly[-1] if i == j else ring.zero for j in range(n)] for i in range(n)]
    for c in reversed(poly[:-1]):
        result = matrix_product(result, B)
        for i in range(n):
            result[i][i] += c
    return result


def combine_matrices(ring: Ring, weights: list[Poly], matrices: list[Matrix]) -> Matrix:
    """Sum of polynomial weights times matrices of one size."""
    n = len(matrices[0])
    used = [(w, M) for w, M in zip(weights, matrices, strict=False) if not w.is_zero()]
    return [[reduce_squares(ring, sum((w * M[i][j] for w, M in used), ring.zero)) for j in range(n)] for i in range(n)]


def assemble_matrix(ring: Ring, n: int, terms: list[Term]) -> tuple[sp.ImmutableMatrix, list[Poly]]:
    """The matrix as sympy expressions, and the denominators that remain in it."""
    divisors: dict[str, Poly] = {}
    entries = [[entry_of(ring, terms, i, j, divisors) for j in range(n)] for i in range(n)]
    return sp.ImmutableMatrix(entries), list(divisors.values())


def entry_of(ring: Ring, terms: list[Term], i: int, j: int, divisors: dict[str, Poly]) -> sp.Expr:
    """One entry: sum over functions of time and surds of function * surd * rational coefficient."""
    sums: dict[sp.Expr, dict[sp.Expr, tuple[Quotient, Surd]]] = {}
    for term in terms:
        if term.M[i][j].is_zero():
            continue
        for wave in term.waves:
            above, below = wave.weight
            part = cancel_fraction(above * term.M[i][j], below * term.divisor)
            group = sums.setdefault(wave.function, {})
            known = group.get(wave.surd.value)
            group[wave.surd.value] = (part if known is None else add_fractions(known[0], part)), wave.surd
    return sp.Add(
        *(
            function * sp.Add(*(write_constant(ring, *item, divisors) for item in group.values()))
            for function, group in sums.items()
        )
    )


def write_constant(ring: Ring, value: Quotient, surd: Surd, divisors: dict[str, Poly]) -> sp.Expr:
    """value * surd; sqrt(r) / r is written 1 / sqrt(r). The denominator is noted as an assumption."""
    above, below = cancel_fraction(reduce_squares(ring, value[0]), reduce_squares(ring, value[1]))
    divisors.setdefault(str(below), below)
    if surd.radicand is not None and not above.is_zero():
        common = below.gcd(surd.radicand)
        if common.total_degree() == surd.radicand.total_degree():
            above, below = cancel_fraction(above * surd.radicand, below)
            return write_quotient(ring, above, below) / surd.value
    return write_quotient(ring, above, below) * surd.value


def dependence_error() -> DomainError:
    """The error for constants that are not independent, where the formula would divide by zero."""
    return DomainError(
        "A: expected a matrix whose formula has no zero divisor; got one with an identity hidden "
        "among its constants; write it in fewer constants"
    )


def list_conditions(ring: Ring, divisors: Iterable[Poly], forms: Iterable[Form]) -> tuple[sp.Basic, ...]:
    """Assumptions of the formula that the declared signs do not grant."""
    relations = dict.fromkeys(relation for form in forms for relation in form.conditions)
    stated = {
        sp.expand(side * r.lhs) for r in relations if isinstance(r, sp.core.relational.Relational) for side in (1, -1)
    }
    for divisor in divisors:
        for base, _ in factor_exactly(divisor)[1]:
            expression = polynomial_sum(ring.generators, base)
            if expression not in stated:
                relations.setdefault(sp.Ne(expression, 0))
    if sp.false in relations:
        raise dependence_error()
    return tuple(relation for relation in relations if relation is not sp.true)
