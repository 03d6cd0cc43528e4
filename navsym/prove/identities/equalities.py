"""Ways to prove that two sides are equal, each a function of the sides and the box, or None.

Every way ends in a reduction of the normal form, or in a number that is exactly zero; what it needs of
divisors, radicands and arguments of logarithms goes into the assumptions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import sympy as sp

from navsym.claims.statement import Box
from navsym.core.balls import enclose, tape
from navsym.core.errors import NavsymError
from navsym.prove.assumptions import add_sides, is_nonnegative, is_nonzero, is_positive
from navsym.prove.identities.cases import vanishes_in_all_cases
from navsym.prove.identities.normal_form import OutsideLanguageError, Reduction, reduce_to_zero, vanishes_identically
from navsym.prove.identities.numbers import denest, is_zero
from navsym.prove.identities.transcendental import (
    KINDS,
    Solution,
    expand_logarithms,
    least_principal_value,
    solve_for_inverses,
)
from navsym.prove.sampling.points import Point, draw_points, ranges_of


@dataclass(frozen=True, slots=True)
class Proof:
    """How two sides were proved equal, and what that took for granted."""

    method: str
    evidence: str
    reduction: Reduction


Way = Callable[[sp.Expr, sp.Expr, Box], Proof | None]


def first_proof(printed: sp.Expr, derived: sp.Expr, box: Box, ways: Iterable[Way]) -> Proof | None:
    """The first way that succeeds; one that meets something outside its language does not."""
    for way in ways:
        try:
            proof = way(printed, derived, box)
        except OutsideLanguageError:
            continue
        if proof is not None:
            return proof
    return None


def by_normal_form(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    reduction = reduce_to_zero(printed - derived)
    if not reduction.zero:
        return None
    reduction = add_sides(reduction, printed, derived)
    return Proof("normal form", f"printed - derived reduces to 0 in {reduction.ring}", reduction)


def by_number(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Two numbers: their difference is exactly zero."""
    difference = printed - derived
    if difference.free_symbols or not is_zero(difference):
        return None
    return Proof("exact number", "printed - derived is exactly zero", reduce_conditions(printed, derived))


def reduce_conditions(printed: sp.Expr, derived: sp.Expr) -> Reduction:
    """What the two sides divide by and take roots and logarithms of."""
    return add_sides(reduce_to_zero(printed), derived)


def by_logarithms(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Logarithms written out over the factors of their arguments that are positive on the box."""
    difference = printed - derived
    if not difference.has(sp.log):
        return None
    spread = expand_logarithms(difference, lambda factor: is_positive(factor, box))
    if spread == difference or not reduce_to_zero(spread).zero:
        return None
    evidence = f"with logarithms of products written out, printed - derived reduces to 0: {spread}"
    return Proof("logarithms of factors", evidence, reduce_conditions(printed, derived))


def by_nested_roots(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Nested square roots of numbers replaced by sums of roots that are proved to be the same numbers."""
    difference = printed - derived
    roots = {node: denest(node) for node in difference.atoms(sp.Pow) if not node.free_symbols}
    simpler = difference.xreplace({node: value for node, value in roots.items() if value != node})
    if simpler == difference or not reduce_to_zero(simpler).zero:
        return None
    evidence = f"with nested roots written out, printed - derived reduces to 0: {simpler}"
    return Proof("nested roots", evidence, reduce_conditions(printed, derived))


def by_cases(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Every absolute value replaced by its inside and by the negative of it."""
    difference = printed - derived
    if not difference.atoms(sp.Abs, sp.Pow) or not vanishes_in_all_cases(difference):
        return None
    evidence = "printed - derived reduces to 0 for every choice of signs of the absolute values"
    return Proof("cases", evidence, reduce_conditions(printed, derived))


def by_resolved_signs(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Replace |u| and sqrt(u**2) by u or -u where the sign of u is proved, and reduce again."""
    difference, notes = resolve_signs(printed - derived, box)
    if not notes:
        return None
    reduction = reduce_to_zero(difference)
    if not reduction.zero:
        return None
    reduction = add_sides(reduction, printed, derived)
    return Proof("normal form after signs", f"{'; '.join(notes)}; then 0 in {reduction.ring}", reduction)


def resolve_signs(expression: sp.Expr, box: Box) -> tuple[sp.Expr, list[str]]:
    notes: list[str] = []
    found = [node for node in expression.atoms(sp.Abs, sp.Pow) if inside_of_modulus(node) is not None]
    for node in sorted(found, key=sp.default_sort_key):
        inside = inside_of_modulus(node)
        assert inside is not None
        for value in (inside, -inside):
            if is_nonnegative(value, box):
                expression = expression.subs(node, value)
                notes.append(f"{node} = {value} on the box")
                break
    return expression, notes


def inside_of_modulus(node: sp.Basic) -> sp.Expr | None:
    """u for |u| and for sqrt(u**2); None for anything else."""
    if isinstance(node, sp.Abs):
        return node.args[0]
    if isinstance(node, sp.Pow) and node.exp == sp.Rational(1, 2) and isinstance(node.base, sp.Pow):
        inner = node.base
        if isinstance(inner.exp, sp.Integer) and inner.exp % 2 == 0 and inner.exp > 0:
            return inner.base ** (inner.exp / 2)
    return None


def by_equal_squares(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Equal squares and both sides nonnegative: what roots of sums need."""
    if not (printed - derived).atoms(sp.Pow, sp.Abs):
        return None
    reduction = reduce_to_zero(printed**2 - derived**2)
    if not reduction.zero:
        return None
    for flip in (1, -1):
        if all(is_nonnegative(flip * side, box) for side in (printed, derived)):
            reduction = add_sides(reduction, printed, derived)
            return Proof("squares", f"both sides of one sign, squares equal in {reduction.ring}", reduction)
    return None


def by_coefficients(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """A combination of functions of the symbols whose coefficients are numbers, all exactly zero."""
    difference = printed - derived
    if not difference.free_symbols or not difference.atoms(sp.Pow, sp.log):
        return None
    coefficients: dict[sp.Expr, sp.Expr] = {}
    for term in sp.Add.make_args(sp.expand_mul(difference)):
        number, function = term.as_independent(*term.free_symbols, as_Add=False)
        coefficients[function] = coefficients.get(function, sp.Integer(0)) + number
    gathered = sp.Add(*(number * function for function, number in coefficients.items()))
    if not all(is_zero(number) for number in coefficients.values()):
        return None
    if not vanishes_identically(difference - gathered):
        return None
    evidence = f"{len(coefficients)} numbers are exactly zero: the coefficients of functions of the symbols"
    return Proof("exact coefficients", evidence, reduce_conditions(printed, derived))


def by_solving_inverses(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Solve for an inverse function and use its definition."""
    if not (printed - derived).has(*KINDS):
        return None
    for solved in solve_for_inverses(printed - derived):
        try:
            proof = first_proof(solved.left, solved.right, box, ALGEBRAIC)
            if proof is None or not is_in_principal_range(solved, box):
                continue
            evidence = f"the definition of {solved.atom}: {solved.left} = {solved.right}; {proof.evidence}"
            return Proof("inverse function", evidence, add_sides(proof.reduction, printed, derived))
        except NavsymError:
            continue
    return None


def is_in_principal_range(solved: Solution, box: Box) -> bool:
    """The value lies where the inverse function has its values."""
    return all(least_principal_value(v) >= (0, False) or is_nonnegative(v, box) for v in solved.nonnegative) and all(
        least_principal_value(v) >= (0, True) or is_positive(v, box) for v in solved.positive
    )


def by_derivative(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """The gradient of the difference vanishes, and so does one value.

    Needs a connected box on which nothing is divided by zero and no root or logarithm ends, so that the
    difference is one smooth function there.
    """
    difference = printed - derived
    symbols = sorted(difference.free_symbols, key=str)
    if not symbols or any(limit.integer or limit.parted for limit in ranges_of(symbols, box).values()):
        return None
    if difference.has(sp.Abs, sp.sign, sp.Max, sp.Min, sp.atan2):
        return None
    if not all(reduce_to_zero(sp.diff(difference, symbol)).zero for symbol in symbols):
        return None
    point = find_common_point(difference, symbols, box) if is_smooth_on(difference, box) else None
    if point is None:
        return None
    place = ", ".join(f"{symbol} = {value}" for symbol, value in point.items())
    return Proof("derivative", f"equal derivatives, and equal at {place}", reduce_conditions(printed, derived))


def is_smooth_on(expression: sp.Expr, box: Box) -> bool:
    """True when divisors, radicands, arguments of logarithms are proved to stay away from zero."""
    conditions = reduce_to_zero(expression)
    inner = [*conditions.radicands, *conditions.arguments]
    inner += [a for node in expression.atoms(sp.asin, sp.acos) for a in (1 - node.args[0], 1 + node.args[0])]
    inner += [p.base for p in expression.atoms(sp.Pow) if p.exp.is_Rational and not p.exp.is_Integer]
    inner += [node.args[0] for node in expression.atoms(sp.log)]
    divisors = [*conditions.divisors]
    divisors += [sp.cos(node.args[0]) for node in expression.atoms(sp.tan, sp.sec)]
    divisors += [sp.sin(node.args[0]) for node in expression.atoms(sp.cot, sp.csc)]
    return all(is_positive(item, box) for item in inner) and all(is_nonzero(item, box) for item in divisors)


def find_common_point(difference: sp.Expr, symbols: list[sp.Symbol], box: Box) -> Point | None:
    """An exact point of the box at which the difference is exactly zero."""
    for point in draw_points(symbols, box, 12):
        value = difference.subs(point)
        if not value.has(sp.nan, sp.zoo, sp.oo) and enclose(tape(value)).contains(0) and is_zero(value):
            return point
    return None


#: What follows from algebra alone, and what the verdict of an equation tries, in this order.
ALGEBRAIC: tuple[Way, ...] = (
    by_normal_form,
    by_number,
    by_logarithms,
    by_nested_roots,
    by_cases,
    by_resolved_signs,
    by_coefficients,
    by_equal_squares,
)
WAYS: tuple[Way, ...] = (*ALGEBRAIC, by_solving_inverses, by_derivative)
