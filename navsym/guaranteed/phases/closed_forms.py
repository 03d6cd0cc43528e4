"""Closed forms of a regime: found from samples with many digits, proved as identities.

Places are recognised (:mod:`navsym.guaranteed.phases.recognise`), the dual and the weights then
solve linear systems with exact entries, and the pair goes to the ladder of proof as one
:class:`~navsym.claims.Optimum`. Recognition only proposes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import sympy as sp

from navsym.claims import OPEN, Equation, Optimum, Verdict
from navsym.claims.statement import Box
from navsym.core.balls import UnsupportedError, enclose
from navsym.core.exact import rational_near, to_fraction, to_rational
from navsym.core.sandbox import Exhausted, run_limited
from navsym.guaranteed.certificate.fixed import dual_attempts
from navsym.guaranteed.certificate.polish import ContactSolution, sharpen_contacts
from navsym.guaranteed.phases.budget import LEAST, Budget
from navsym.guaranteed.phases.family import Family, U
from navsym.guaranteed.phases.patterns import Pattern, PatternInterval, contact_pattern, sample_contacts
from navsym.guaranteed.phases.recognise import recognise_place
from navsym.prove.equations import decide_equation, weakest_verdict
from navsym.prove.grant import grant_documents, leave_unchecked, write_optimum
from navsym.prove.ladder import DEFAULT_MEGABYTES, search_verdict
from navsym.prove.optimum import decide_feasibility, decide_times, decide_values
from navsym.prove.products import as_product

# Closed forms for monomials on [0, T]: shares of the interval, powers of T, and Lagrange's weights.
#
# With contacts ``c_i T`` and ``omega(t) = prod (t - c_i)``, a rational polynomial, the weights that pick
# coefficient k of every polynomial of the span are
#
#     w_i = sum_{j > k} omega_j c_i**(j-k-1) / omega'(c_i) / T**k,
#
# a polynomial in c_i with rational coefficients, whatever algebraic number c_i is.


def short_rational(x: sp.Expr) -> sp.Rational | None:
    """The rational with a small denominator within 1e-35 of a number with many digits, or None."""
    return rational_near(sp.Rational(str(sp.N(x, 70))), 10**7, sp.Rational(1, 10**35))


def monomial_weights(family: Family, places: Sequence[sp.Expr]) -> tuple[sp.Expr, ...] | None:
    """Weights of contacts ``c_i T``, as many as unknowns; None when omega is not rational."""
    T, m = family.parameter, len(family.functional)
    shares = [sp.expand(p / T) for p in places]
    if len(places) != m or any(c.free_symbols for c in shares):
        return None
    omega = rational_product(shares)
    if omega is None:
        return None
    slope = [k * c for k, c in enumerate(omega)][1:]
    weights = []
    for c in shares:
        below = short_rational(sum(a * sp.N(c, 90) ** k for k, a in enumerate(slope)))
        if below is None:
            return None
        terms = [
            p * sum((omega[j] * c ** (j - k - 1) for j in range(k + 1, m + 1)), sp.S.Zero) / below / T**k
            for k, p in enumerate(family.functional)
            if p != 0
        ]
        weights.append(sp.expand(sum(terms, sp.S.Zero)))
    return tuple(weights)


def rational_product(shares: Sequence[sp.Expr]) -> list[sp.Rational] | None:
    """Coefficients of ``prod (t - c_i)``, lowest first, when they are recognised as rational."""
    c = [sp.Integer(1)]
    for share in shares:
        value = sp.Rational(str(sp.N(share, 90)))
        shifted = [sp.S.Zero, *c]
        c = [a - value * b for a, b in zip(shifted, [*c, sp.S.Zero], strict=True)]
    found = [short_rational(a) for a in c]
    return None if any(a is None for a in found) else [a for a in found if a is not None]


def power_law_dual(
    family: Family, duals: Sequence[Sequence[sp.Rational]], lengths: Sequence[sp.Rational]
) -> tuple[sp.Expr, ...] | None:
    """Dual ``x_k = d_k / T**k`` with rational d_k, agreed on by all samples."""
    T, found = family.parameter, []
    for k in range(len(family.functional)):
        values = [short_rational(x[k] * t**k) for x, t in zip(duals, lengths, strict=True)]
        if values[0] is None or any(v != values[0] for v in values):
            return None
        found.append(values[0] / T**k)
    return tuple(found)


BITS = 320
#: Seconds that a certificate of a closed form may take beside its proof.
MOST_SECONDS = 10.0
GOAL, NOTHING = 1e-60, 1e-20


@dataclass(frozen=True, slots=True, eq=False)
class ClosedForm:
    """Places in u, weights, dual and value as expressions in T, and the verdict on the pair."""

    panels: tuple[int, ...]
    places: tuple[sp.Expr, ...]
    weights: tuple[sp.Expr, ...]
    dual: tuple[sp.Expr, ...]
    value: sp.Expr
    verdict: Verdict


@dataclass(frozen=True, slots=True, eq=False)
class SharpMember:
    """One member of the family with many digits."""

    T: sp.Rational
    places: tuple[sp.Rational, ...]
    polished: ContactSolution


def sample_regime(
    family: Family, span: PatternInterval, shares: Sequence[str] = ("0.23", "0.41", "0.59", "0.83")
) -> list[SharpMember]:
    """Members of a span whose pattern is that of the span."""
    found = []
    for share in shares:
        T = (span.lower + (span.upper - span.lower) * Fraction(share)).limit_denominator(10**6)
        one = sharp_member(family, T, span.pattern)
        if one is not None:
            found.append(one)
    return found


def sharp_member(family: Family, T: Fraction, pattern: Pattern | None) -> SharpMember | None:
    """The member of length T with about 90 digits, or None when its pattern is another one."""
    basis, contacts = sample_contacts(family, T, pattern)
    if pattern is not None and contact_pattern(contacts) != pattern:
        return None
    value = to_rational(T)
    done = sharpen_contacts(family.exact(value).panels, basis, contacts, BITS, GOAL)
    places = []
    for k, v in zip(done.panel, done.v, strict=True):
        start, end = (sp.Rational(str(sp.N(e, 95))) if not e.is_Rational else e for e in family.ends(value, k))
        places.append(start + (end - start) * to_rational(v))
    return SharpMember(value, tuple(places), done)


# -- exact linear algebra on the contacts ---------------------------------------------------------


def recognise_places(family: Family, span: PatternInterval, found: Sequence[SharpMember]) -> tuple[sp.Expr, ...] | None:
    """Exact places of a span from its samples; None where one is not recognised, or the samples are too few."""
    if len(found) < 3:
        return None
    panels, lengths = [k for k, _, _ in span.pattern], [s.T for s in found]
    columns = [[s.places[i] for s in found] for i in range(len(span.pattern))]
    places = [recognise_place(family, k, c, lengths) for k, c in zip(panels, columns, strict=True)]
    exact = tuple(p for p in places if p is not None)
    return exact if len(exact) == len(panels) else None


def propose_closed_forms(family: Family, span: PatternInterval) -> list[ClosedForm]:
    """Closed forms of a span as guesses, not yet proved; the dual with most zeros first."""
    found = sample_regime(family, span)
    exact = recognise_places(family, span, found)
    if exact is None:
        return []
    if family.growing and family.rows == (tuple(U**k for k in range(len(family.functional))),):
        quick = monomial_guess(family, span, exact, found)
        if quick is not None:
            return [quick]
    return complete_forms(family, span, exact, found)


def complete_forms(
    family: Family, span: PatternInterval, exact: tuple[sp.Expr, ...], found: Sequence[SharpMember]
) -> list[ClosedForm]:
    """Closed forms on exact places: weights, and duals that are feasible at the samples found; not yet proved."""
    lengths, panels = [s.T for s in found], tuple(k for k, _, _ in span.pattern)
    weights = solve_weights(family, span, exact, lengths[0])
    if weights is None:
        return []
    guesses = []
    moving = itertools.islice(propose_duals(family, span, exact, lengths), 3)
    for dual in (*moving, *constant_duals(family, span, found)):
        value = shorten_formula(sum((x * p for x, p in zip(dual, family.functional, strict=True)), sp.S.Zero))
        guesses.append(ClosedForm(panels, exact, weights, dual, value, Verdict(OPEN, "none")))
    return guesses


def monomial_guess(
    family: Family, span: PatternInterval, places: tuple[sp.Expr, ...], found: Sequence[SharpMember]
) -> ClosedForm | None:
    """A closed form for monomials on [0, T], not yet proved: weights from the places, the dual by powers of T.

    places : closed forms of the contacts. None when the samples follow no power law or the weights are not found
    """
    duals_ = [[to_rational(x) for x in s.polished.dual] for s in found]
    dual = power_law_dual(family, duals_, [s.T for s in found])
    weights = monomial_weights(family, places)
    if dual is None or weights is None:
        return None
    value = sum((x * p for x, p in zip(dual, family.functional, strict=True)), sp.S.Zero)
    return ClosedForm(tuple(k for k, _, _ in span.pattern), places, weights, dual, value, Verdict(OPEN, "none"))


def prove_closed_form(
    family: Family, guesses: Sequence[ClosedForm], lower: sp.Expr, upper: sp.Expr, seconds: float = 60.0
) -> ClosedForm | None:
    """The first guess that the ladder proves or certifies on the whole of (lower, upper); else the first.

    seconds : for all guesses together; each may take its share of what is left
    What had to be taken for granted on the way (a divisor that may vanish inside the range) leaves a guess OPEN.
    """
    best: ClosedForm | None = None
    limit, (T, value, ends) = Budget.of(seconds), signed_parameter(family.parameter, lower, upper)
    for k, guess in enumerate(guesses):
        mine = limit.share(1 / (len(guesses) - k)).left()
        if mine < LEAST:
            break
        verdict = decide_form(family, guess, {family.parameter: value}, {T: ends}, mine)
        if verdict.assumptions:
            verdict = Verdict(OPEN, "none", evidence=f"not shown: {', '.join(verdict.assumptions)}")
        done = replace(guess, verdict=verdict)
        if verdict.status.holds:
            return done
        best = best or done
    return best


def propose_duals(
    family: Family, span: PatternInterval, places: Sequence[sp.Expr], lengths: Sequence[sp.Rational]
) -> Iterator[tuple[sp.Expr, ...]]:
    """Solutions x of ``x . H(u_i) = s_i sigma`` and ``x . H'(u_i) = 0``; those with most zeros first.

    Where these leave x free, further conditions are tried: ``x . H`` opposite at the ends of a measurement, or at its
    bound at an end.
    """
    rows, right = contact_equations(family, span, places)
    rank = len(first_independent_rows(numeric_matrix(family, rows, lengths[0])))
    for columns in itertools.combinations(range(len(rows[0])), rank):
        yield from solve_dual(family, rows, right, columns, lengths)
    free = len(rows[0]) - rank
    for more in itertools.combinations(conditions_at_ends(family), free) if free else ():
        left, bounds = [row for row, _ in more], [bound for _, bound in more]
        yield from solve_dual(family, [*rows, *left], [*right, *bounds], range(len(rows[0])), lengths)


def conditions_at_ends(family: Family) -> list[tuple[list[sp.Expr], sp.Expr]]:
    """Rows and right sides: a dual polynomial balanced between the ends of a panel, or at its bound at one of them."""
    ends = [
        ([h.subs(U, a) for h in row], [h.subs(U, b) for h in row])
        for row, (a, b) in zip(family.rows, family.panels, strict=True)
    ]
    balanced = [([x + y for x, y in zip(a, b, strict=True)], sp.S.Zero) for a, b in ends]
    signed_ = [(e, s * sigma) for pair, sigma in zip(ends, family.sigma, strict=True) for e in pair for s in (1, -1)]
    return balanced + [(row, sp.sympify(bound, strict=True)) for row, bound in signed_]


def constant_duals(family: Family, span: PatternInterval, found: Sequence[SharpMember]) -> list[tuple[sp.Expr, ...]]:
    """Duals with rational entries that do not move, where contacts are too few to determine one.

    Of a growing interval what stays within the bound on the longest does so on the others: that one comes first.
    """
    if sum(1 if kind != "no" else 2 for _, kind, _ in span.pattern) >= len(family.functional):
        return []
    done: list[tuple[sp.Expr, ...]] = []
    for T in (span.upper, span.lower, to_fraction(found[-1].T)):
        basis, contacts = sample_contacts(family, T, span.pattern)
        problem = family.exact(to_rational(T))
        refined_ = sharpen_contacts(problem.panels, basis, contacts, BITS, GOAL)
        for base, _, _ in dual_attempts(problem, basis, contacts, refined_, 14):
            x = tuple(to_rational(c) for c in base)
            short = all(c.q <= 720 for c in x)
            if short and x not in done and all(is_feasible(family, one.T, np.array(x, dtype=float)) for one in found):
                done.append(x)
    return done


def contact_equations(
    family: Family, span: PatternInterval, places: Sequence[sp.Expr]
) -> tuple[list[list[sp.Expr]], list[sp.Expr]]:
    """Rows and right sides of what the dual satisfies at its contacts."""
    rows, right = [], []
    for (k, kind, s), u in zip(span.pattern, places, strict=True):
        rows.append([h.subs(U, u) for h in family.rows[k]])
        right.append(sp.sympify(s * family.sigma[k], strict=True))
        if kind == "no":
            rows.append([h.diff(U).subs(U, u) for h in family.rows[k]])
            right.append(sp.S.Zero)
    return rows, right


def numeric_matrix(family: Family, rows: Sequence[Sequence[sp.Expr]], p: sp.Rational) -> np.ndarray:
    """Double values of a matrix for one value of the parameter."""
    return np.array([[float(family.at(e, p).evalf(30)) for e in row] for row in rows])


def solve_dual(
    family: Family,
    rows: Sequence[Sequence[sp.Expr]],
    right: Sequence[sp.Expr],
    columns: Sequence[int],
    lengths: Sequence[sp.Rational],
) -> Iterator[tuple[sp.Expr, ...]]:
    """The exact solution with zeros outside the columns, if it is feasible at every sample."""
    columns, m = list(columns), len(rows[0])
    numeric = numeric_matrix(family, rows, lengths[0])[:, columns]
    picked = first_independent_rows(numeric)
    if len(picked) < len(columns):
        return
    for T in lengths:
        A, b = numeric_matrix(family, rows, T)[:, columns], numeric_matrix(family, [right], T)[0]
        x, size = np.zeros(m), np.abs(A).max(axis=0) + 1e-300
        x[columns] = np.linalg.lstsq(A / size, b, rcond=None)[0] / size
        if np.abs(A @ x[columns] - b).max() > 1e-9 * np.abs(b).max() or not is_feasible(family, T, x):
            return
    solved = solve_by_cramer(sp.Matrix(rows), right, picked, columns)
    if solved is not None:
        full = [sp.S.Zero] * m
        for c, value in zip(columns, solved, strict=True):
            full[c] = value
        yield tuple(full)


def is_feasible(family: Family, T: sp.Rational, x: np.ndarray) -> bool:
    """|x . H| <= sigma on a grid, up to rounding."""
    for panel in family.exact(T).panels:
        _, H, sigma = panel.numbers(np.linspace(0.0, 1.0, 801))
        if np.abs(x @ H).max() > sigma * (1 + 1e-9):
            return False
    return True


def first_independent_rows(A: np.ndarray) -> list[int]:
    """Indices of rows that span the row space, greedily; rows and columns may have units of any size."""
    picked: list[int] = []
    for axis in (0, 1):
        size = np.abs(A).max(axis=axis, keepdims=True)
        A = A / np.where(size > NOTHING * size.max(), size, 1.0)  # a cosine that vanishes is not scaled up
    for i in range(A.shape[0]):
        if np.linalg.matrix_rank(A[[*picked, i]], tol=1e-9) > len(picked):
            picked.append(i)
    return picked


def solve_by_cramer(
    A: sp.Matrix, right: Sequence[sp.Expr], rows: Sequence[int], columns: Sequence[int]
) -> list[sp.Expr] | None:
    """Cramer's rule on the chosen rows and columns, every quotient brought to a product if it has one."""
    block = A.extract(list(rows), list(columns))
    b = sp.Matrix([right[i] for i in rows])
    below = sp.expand(block.det(method="berkowitz"))
    solved = []
    for j in range(block.cols):
        changed = block.copy()
        changed[:, j] = b
        above = sp.expand(changed.det(method="berkowitz"))
        solved.append(shorten_formula(above / below))
    return solved


def shorten_formula(expression: sp.Expr) -> sp.Expr:
    """A short form: the product of the normal form when there is one; nothing rests on it."""
    if not expression.free_symbols:
        return sp.radsimp(sp.expand(sp.expand_trig(expression)))
    if not expression.has(sp.sin, sp.cos, sp.exp):
        return sp.factor(expression)
    product = as_product(expression)
    choices = [expression] if product is None else [product]
    simplified = sp.simplify(choices[0])
    choices.append(simplified)
    # ``1/tan(x)`` as ``cot(x)``, which exists at the poles of the tangent as well.
    inverse = lambda e: e.is_Pow and isinstance(e.base, sp.tan) and e.exp.is_negative  # noqa: E731
    return min(choices, key=sp.count_ops).replace(inverse, lambda e: sp.cot(*e.base.args) ** -e.exp)


def solve_weights(
    family: Family, span: PatternInterval, places: Sequence[sp.Expr], T: sp.Rational
) -> tuple[sp.Expr, ...] | None:
    """Exact weights from ``sum w_i H(u_i) = P`` on independent rows."""
    N = sp.Matrix([[h.subs(U, u) for h in family.rows[k]] for (k, _, _), u in zip(span.pattern, places, strict=True)]).T
    numeric = numeric_matrix(family, N.tolist(), T)
    rows = first_independent_rows(numeric)
    if len(rows) < N.cols:
        return None
    solved = solve_by_cramer(N, family.functional, rows[: N.cols], range(N.cols))
    return None if solved is None else tuple(solved)


def decide_form(
    family: Family,
    guess: ClosedForm,
    values: Mapping[sp.Symbol, sp.Expr],
    box: Box,
    seconds: float,
    most: float = MOST_SECONDS,
) -> Verdict:
    """The ladder's verdict on the pair with expressions in the symbols of a box for the parameters.

    most : seconds that the certificate of the whole may take, 0 for none
    """
    put = lambda e: sp.sympify(e, strict=True).subs(values)  # noqa: E731
    statements = [
        Optimum(
            regressors=tuple(put(h / sigma) for h in row),
            functional=tuple(map(put, family.functional)),
            variable=U,
            interval=tuple(map(put, ends)),
            dual=tuple(map(put, guess.dual)),
            support=tuple(map(put, guess.places)),
            weights=tuple(put(w * family.sigma[k]) for w, k in zip(guess.weights, guess.panels, strict=True)),
            value=put(guess.value),
            box=box,
        )
        for row, sigma, ends in zip(family.rows, family.sigma, family.panels, strict=True)
    ]
    try:
        done = run_limited(
            decide_jointly, (statements, guess.panels, min(seconds / 2, most)), seconds, DEFAULT_MEGABYTES
        )
    except UnsupportedError as error:  # a guess with a divisor that vanishes for all values is no closed form
        return Verdict(OPEN, "none", evidence=error.message)
    return Verdict(OPEN, "none", evidence="stopped") if isinstance(done, Exhausted) else done


def signed_parameter(
    p: sp.Symbol, lower: sp.Expr, upper: sp.Expr
) -> tuple[sp.Symbol, sp.Expr, tuple[sp.Expr, sp.Expr]]:
    """A symbol for the parameter, positive where the range lets it, the parameter's value in it, and its range.

    At zero itself, the end of an open range, weights may be infinite: hence positive, not nonnegative. A range below
    zero is mirrored.
    """
    positive = sp.Symbol(p.name, positive=True)
    if bool(enclose(lower) >= 0):
        return positive, positive, (lower, upper)
    mirrored = sp.Symbol(f"minus_{p.name}", positive=True)
    return (mirrored, -mirrored, (-upper, -lower)) if bool(enclose(upper) <= 0) else (p, p, (lower, upper))


def decide_jointly(statements: Sequence[Optimum], panels: Sequence[int], seconds: float) -> Verdict:
    """The four conditions, each statement with one measurement over its bound, with the certificate of the whole.

    Without one the verdict says ``unchecked``: the checker has then seen each sign and each identity, not their sum.
    """
    verdict = search_verdict(statements[0]) if len(statements) == 1 else search_jointly(statements, panels)
    if not verdict.status.holds or verdict.assumptions or not seconds:
        return leave_unchecked(verdict)
    granted = grant_documents(write_optimum(statements, panels), verdict, seconds)
    return granted if granted.status.holds else leave_unchecked(verdict)


def search_jointly(statements: Sequence[Optimum], panels: Sequence[int]) -> Verdict:
    """What the search makes of the conditions of several measurements."""
    first = statements[0]
    sums = tuple(
        sum(
            (
                w * statements[k].regressors[j].subs(first.variable, at)
                for w, at, k in zip(first.weights, first.support, panels, strict=True)
            ),
            sp.S.Zero,
        )
        for j in range(len(first.functional))
    )
    balance = decide_equation(Equation(sums, tuple(first.functional), first.box))
    feasible_ = [decide_feasibility(statement) for statement in statements]
    inside = [decide_times(replace(s, support=own(first.support, panels, k))) for k, s in enumerate(statements)]
    verdict = weakest_verdict([balance, *inside, *feasible_, decide_values(first)])
    return replace(verdict, method=f"exact primal-dual pair ({verdict.method})")


def own(places: Sequence[sp.Expr], panels: Sequence[int], k: int) -> tuple[sp.Expr, ...]:
    """Those of the places that lie on panel k."""
    return tuple(at for at, panel in zip(places, panels, strict=True) if panel == k)
