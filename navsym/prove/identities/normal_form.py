"""Deciding identities: every expression of the language as a quotient of polynomials.

Sines and cosines are written with ``z = exp(i angle / d)``, one z for each independent angle
monomial at the common denominator d of its coefficients, so that half and multiple angles are
powers; multiples of pi and the square roots of 2, 3 and 5 live in a cyclotomic field, as powers
of one root of unity. Real exponentials get generators in the same way, roots of symbols are
taken out by a substitution ``x = s**q``, other roots get a generator g with ``g**q = radicand``,
and whatever else occurs (log, atan, …) is an atom. The numerator of ``left - right`` is then a
polynomial over the rationals, and the identity holds when it reduces to zero.

Angles that are linearly independent over the rationals have algebraically independent z, hence
for rational functions, sines, cosines and exponentials of polynomials the answer is complete:
zero exactly when the identity holds. With dependent roots or atoms the answer "zero" is still
sound; "not zero" is never used to refute (a point and a ball do that).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import sympy as sp

from navsym.prove.identities.converter import Converter, UndefinedExpressionError, vanishes_identically
from navsym.prove.identities.ingredients import Monomial, OutsideLanguageError

__all__ = ["OutsideLanguageError", "Reduction", "UndefinedExpressionError", "reduce_to_zero", "vanishes_identically"]


@dataclass(frozen=True, slots=True)
class Reduction:
    """Outcome of a reduction.

    zero      : the expression reduces to zero
    divisors, radicands, arguments : what has to be nonzero, nonnegative, positive
    ring      : the ring in words, for the evidence
    complete  : no roots and no atoms were met, so that "not zero" is an answer as well
    """

    zero: bool
    divisors: tuple[sp.Basic, ...]
    radicands: tuple[sp.Basic, ...]
    arguments: tuple[sp.Basic, ...]
    ring: str
    complete: bool


@functools.lru_cache(maxsize=256)
def reduce_to_zero(expression: sp.Expr) -> Reduction:
    """Decide whether an expression of the language vanishes identically.

    Raises OutsideLanguageError outside the language and UndefinedExpressionError when a
    divisor vanishes identically.
    """
    expression = sp.sympify(expression, strict=True)
    converter = Converter([expression])
    quotient = converter.convert(expression)
    for divisor in divisors_inside(expression):
        converter.divide_by(divisor)
    converter.check_divisors()
    return Reduction(
        zero=converter.vanishes(quotient),
        divisors=tuple(d for d in converter.divisors if not d.is_Number),
        radicands=tuple(dict.fromkeys([*converter.radicands, *radicands_inside(expression)])),
        arguments=tuple(dict.fromkeys([*converter.arguments, *logarithms_inside(expression)])),
        ring=describe_ring(converter),
        complete=not converter.roots and not converter.atoms,
    )


WATCHED = (sp.Pow, sp.tan, sp.sec, sp.cot, sp.csc, sp.atan2, sp.asin, sp.acos, sp.log)


@functools.lru_cache(maxsize=256)
def order_nodes(expression: sp.Basic) -> list[sp.Basic]:
    """Nodes of a tree that are not defined everywhere, in an order that does not depend on the run."""
    return sorted(expression.atoms(*WATCHED), key=sp.default_sort_key)


def list_nodes(expression: sp.Basic, *kinds: type) -> list[sp.Basic]:
    """Those of some kinds."""
    return [node for node in order_nodes(expression) if isinstance(node, kinds)]


def divisors_inside(expression: sp.Expr) -> list[sp.Basic]:
    """Bases of negative powers anywhere in the expression, arguments of functions included."""
    found = [power.base for power in list_nodes(expression, sp.Pow) if power.exp.is_Rational and power.exp < 0]
    found += [sp.cos(node.args[0]) for node in list_nodes(expression, sp.tan, sp.sec)]
    found += [sp.sin(node.args[0]) for node in list_nodes(expression, sp.cot, sp.csc)]
    return found + [sum(a**2 for a in node.args) for node in list_nodes(expression, sp.atan2)]


def radicands_inside(expression: sp.Expr) -> list[sp.Basic]:
    """What has to be nonnegative for roots, inverse sines and inverse cosines to be real."""
    powers = list_nodes(expression, sp.Pow)
    found = [p.base for p in powers if p.exp.is_Rational and not p.exp.is_Integer and not p.base.is_nonnegative]
    return found + [1 - node.args[0] ** 2 for node in list_nodes(expression, sp.asin, sp.acos)]


def logarithms_inside(expression: sp.Expr) -> list[sp.Basic]:
    """Arguments of logarithms and bases of general powers, which have to be positive."""
    found = [node.args[0] for node in list_nodes(expression, sp.log)]
    found += [p.base for p in list_nodes(expression, sp.Pow) if not p.exp.is_Rational]
    return [argument for argument in found if not argument.is_positive]


def describe_ring(converter: Converter) -> str:
    """The ring in words: ``Q(zeta_24)[T, exp(i T/4)]``."""
    found = converter.found
    field_name = "Q" if found.unity <= 2 else f"Q(zeta_{found.unity})"
    generators = [symbol.name if q == 1 else f"{symbol.name}^(1/{q})" for symbol, q in found.symbols.items()]
    generators += [f"exp(i {angle_name(m, d)})" for m, d in found.angles.items()]
    generators += [f"exp({angle_name(m, d)})" for m, d in found.exponents.items()]
    generators += [str(atom) for atom in converter.atoms]
    generators += [f"({radicand})^(1/{q})" for radicand, q in converter.roots]
    return f"{field_name}[{', '.join(generators)}]" if generators else field_name


def angle_name(monomial: Monomial, denominator: int) -> str:
    parts = [str(b) if e == 1 else f"{b}^({e})" for b, e in sorted(monomial, key=lambda item: str(item[0]))]
    name = " ".join(parts) or "1"
    return name if denominator == 1 else f"{name}/{denominator}"
