"""What a proof takes for granted, and what of it the box guarantees."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence

import sympy as sp

from navsym.claims.statement import Box
from navsym.prove.sampling.points import ranges_of
from navsym.prove.signs import Sign, prove_sign
from navsym.prove.wording import expression_text

#: What is not defined everywhere.
WATCHED = (sp.Pow, sp.tan, sp.sec, sp.cot, sp.csc, sp.atan2, sp.asin, sp.acos, sp.log)


@functools.lru_cache(maxsize=256)
def order_nodes(expression: sp.Basic) -> list[sp.Basic]:
    """Nodes of a tree that are not defined everywhere, in an order that does not depend on the run."""
    return sorted(expression.atoms(*WATCHED), key=sp.default_sort_key)


def list_nodes(expression: sp.Basic, *kinds: type) -> list[sp.Basic]:
    """Those of some kinds."""
    return [node for node in order_nodes(expression) if isinstance(node, kinds)]


def divisors_inside(expression: sp.Basic) -> list[sp.Basic]:
    """What has to be nonzero: bases of negative powers anywhere in the expression, arguments of functions included."""
    found = [power.base for power in list_nodes(expression, sp.Pow) if power.exp.is_Rational and power.exp < 0]
    found += [sp.cos(node.args[0]) for node in list_nodes(expression, sp.tan, sp.sec)]
    found += [sp.sin(node.args[0]) for node in list_nodes(expression, sp.cot, sp.csc)]
    found += [sum(a**2 for a in node.args) for node in list_nodes(expression, sp.atan2)]
    return [divisor for divisor in found if not divisor.is_Number]


def radicands_inside(expression: sp.Basic) -> list[sp.Basic]:
    """What has to be nonnegative for roots, inverse sines and inverse cosines to be real."""
    powers = list_nodes(expression, sp.Pow)
    found = [p.base for p in powers if p.exp.is_Rational and not p.exp.is_Integer and not p.base.is_nonnegative]
    return found + [1 - node.args[0] ** 2 for node in list_nodes(expression, sp.asin, sp.acos)]


def logarithms_inside(expression: sp.Basic) -> list[sp.Basic]:
    """Arguments of logarithms and bases of general powers, which have to be positive."""
    found = [node.args[0] for node in list_nodes(expression, sp.log)]
    found += [p.base for p in list_nodes(expression, sp.Pow) if not p.exp.is_Rational]
    return [argument for argument in found if not argument.is_positive]


def is_positive(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved to be positive on the box."""
    return prove_sign(expression, box, Sign.POSITIVE).at_least(Sign.POSITIVE)


def is_nonnegative(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved not to be negative on the box."""
    return prove_sign(expression, box).at_least(Sign.NONNEGATIVE)


def is_nonzero(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved to vanish nowhere on the box; a negative power is zero nowhere."""
    is_reciprocal = expression.is_Pow and expression.exp.is_negative
    if is_reciprocal or is_positive(expression, box) or is_positive(-expression, box):
        return True
    limits = ranges_of(sorted(expression.free_symbols, key=str), box).values()
    has_parts = any(limit.parted for limit in limits)  # of two signs, with a gap between
    return has_parts and prove_sign(expression, box, Sign.NONZERO).at_least(Sign.NONZERO)


#: What is taken for granted of the sides: where it is found, in words, and when the box guarantees it.
KINDS: tuple[tuple[Callable[[sp.Basic], list[sp.Basic]], str, Callable[[sp.Expr, Box], bool]], ...] = (
    (divisors_inside, "!= 0", is_nonzero),
    (radicands_inside, ">= 0", is_nonnegative),
    (logarithms_inside, "> 0", is_positive),
)


def remaining_assumptions(
    sides: Sequence[sp.Basic],
    box: Box,
    nonzero: Sequence[sp.Expr] = (),
    at: Callable[[sp.Expr], sp.Expr] = lambda part: part,
) -> tuple[str, ...]:
    """What the sides as they are written take for granted and the box does not guarantee.

    nonzero : what else is taken to be nonzero
    at      : what stands for a part on the box, where its variables are written by others there
    """
    whole = sp.Tuple(*sides)
    found = [
        f"{expression_text(part)} {sign}"
        for list_parts, sign, holds in KINDS
        for part in dict.fromkeys([*list_parts(whole), *(nonzero if list_parts is divisors_inside else ())])
        if not holds(at(part), box)
    ]
    return tuple(dict.fromkeys(found))
