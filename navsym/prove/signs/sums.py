"""|u| of a sum of symbols: t = |u| takes the place of one of them, once for each sign of u.

With x = y + t and x = y - t, t >= 0, the claim ``|sin x - sin y| <= |x - y|`` is one about t and y. The new box
holds every point of the old one; it holds no more when the range of the symbol that is left out follows
from those of the others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import sympy as sp

from navsym.prove.sampling.points import Range
from navsym.prove.signs.exact import Limits, Sign, constant_sign

#: Symbols that are tried as the one to be replaced.
MOST_FORMS = 2


@dataclass(frozen=True, slots=True)
class Sum:
    """A number and rational multiples of symbols."""

    constant: sp.Expr
    shares: Mapping[sp.Symbol, sp.Rational]

    def times(self, factor: sp.Rational) -> Sum:
        return Sum(factor * self.constant, {s: factor * share for s, share in self.shares.items()})

    def least(self, limits: Limits) -> sp.Expr | None:
        """The least value on the box; None where there is none."""
        value = self.constant
        for symbol, share in self.shares.items():
            end = limits[symbol].lower if share > 0 else limits[symbol].upper
            if end is None:
                return None
            value += share * end
        return value

    def expression(self) -> sp.Expr:
        return self.constant + sp.Add(*(share * symbol for symbol, share in self.shares.items()))


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """The expression for one sign of u, on a box that holds this part of the old one; ``wider`` when it holds more."""

    expression: sp.Expr
    limits: dict[sp.Symbol, Range]
    wider: bool = False


def read_sum(expression: sp.Expr) -> Sum | None:
    """The expression as such a sum; None when it has another form."""
    constant: sp.Expr = sp.Integer(0)
    shares: dict[sp.Symbol, sp.Rational] = {}
    for term in sp.Add.make_args(expression):
        share, symbol = term.as_coeff_Mul()
        if not term.free_symbols:
            constant += term
        elif isinstance(symbol, sp.Symbol) and share.is_Rational:
            shares[symbol] = share
        else:
            return None
    return Sum(constant, shares)


def cases_of_sum(expression: sp.Expr, value: sp.Abs, limits: Limits) -> list[list[Case]] | None:
    """The cases that u >= 0 and u <= 0 leave for ``value`` = |u|; None when u is no sum of symbols.

    Each case comes in several forms, of which one is enough; those with the smaller box come first.
    """
    inside = read_sum(value.args[0])
    if inside is None or not inside.shares:
        return None
    both = [inside.times(sp.Integer(sign)) for sign in (1, -1)]
    possible = [signed for signed in both if not is_negative_sum(signed, limits)]
    cases = [forms_of_case(expression, value, signed, limits) for signed in possible]
    return cases if all(cases) else None


def is_negative_sum(inside: Sum, limits: Limits) -> bool:
    """True when the sum is negative on the whole box."""
    turned = inside.times(sp.Integer(-1)).least(limits)
    return turned is not None and constant_sign(turned).sign == Sign.POSITIVE


def forms_of_case(expression: sp.Expr, value: sp.Abs, inside: Sum, limits: Limits) -> list[Case]:
    """The expression where ``inside`` is not negative; no form when no symbol can be replaced."""
    least, turned = inside.least(limits), inside.times(sp.Integer(-1)).least(limits)
    if least is not None and constant_sign(least).sign != Sign.UNKNOWN:
        case = expression.xreplace({value: inside.expression()})
        return [Case(case, {s: limits[s] for s in case.free_symbols})]
    t = sp.Dummy("t", nonnegative=True)
    around = {**limits, t: Range(sp.Integer(0), None if turned is None else -turned)}
    forms = []
    for wider, symbol, solved in sorted(replacements(inside, t, around), key=lambda item: (item[0], item[1].name)):
        case = expression.xreplace({value: t}).xreplace({symbol: solved})
        forms.append(Case(case, {s: around[s] for s in case.free_symbols}, wider))
    return forms[:MOST_FORMS]


def replacements(inside: Sum, t: sp.Symbol, limits: Limits) -> Iterator[tuple[bool, sp.Symbol, sp.Expr]]:
    """Symbols that ``inside = t`` can be solved for, with what they are, and whether their ranges get lost."""
    for symbol, share in inside.shares.items():
        if limits[symbol].integer:
            continue
        others = {s: -a / share for s, a in inside.shares.items() if s != symbol}
        solved = Sum(-inside.constant / share, {**others, t: 1 / share})
        yield not is_inside_range(solved, limits[symbol], limits), symbol, solved.expression()


def is_inside_range(solved: Sum, limit: Range, limits: Limits) -> bool:
    """True when the sum lies in the range for all values of its symbols."""
    ends = [(limit.lower, solved)] if limit.lower is not None else []
    ends += [(-limit.upper, solved.times(sp.Integer(-1)))] if limit.upper is not None else []
    for end, value in ends:
        least = value.least(limits)
        if least is None or constant_sign(least - end).sign == Sign.UNKNOWN:
            return False
    return True
