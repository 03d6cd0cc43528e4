"""Expressions back to text: the inverse of the parser, and the same as Python source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

import sympy as sp

from navsym.core.errors import ExpressionSyntaxError, TooLargeError
from navsym.language.arithmetic import BITS, BUILDERS, number_bits
from navsym.language.names import check_name, quote

SUM, PRODUCT, POWER, ATOM = range(4)

NAMES: dict[type, str] = {builder: name for name, builder in BUILDERS.items() if isinstance(builder, type)}


def to_text(expression: sp.Expr) -> str:
    """Text of the language of files that means the expression: ``sin(T/2)**2``, ``3/4``, ``sqrt(x)``.

    ``parse(to_text(e), symbols) == e`` for every expression that the language can build.
    Raises ExpressionSyntaxError on anything outside the language (floating-point numbers, I,
    infinities, Piecewise, names that are not ASCII) and TooLargeError on depth.
    """
    return Printer().whole(expression)


def to_python(expression: sp.Expr) -> str:
    """Python source that builds the expression exactly, with sympy at hand as ``sp``: ``sp.sin(T/2)**2``.

    No quotient of two plain integers is written, of which Python would make a float. Raises as :func:`to_text`.
    """
    return Printer(python=True).whole(expression)


def refuse(part: object) -> NoReturn:
    """Raise ExpressionSyntaxError for what the language does not have."""
    kind = type(part).__name__
    text = quote(str(part)) if not isinstance(part, str) else quote(part)
    raise ExpressionSyntaxError(
        f"expected numbers, names, + - * / **, pi and the functions of the language; got {kind} {text}; "
        "rewrite it exactly in these terms"
    )


@dataclass(frozen=True, slots=True)
class Printer:
    """Writes expressions; every text comes with how tightly it binds.

    python : spell fractions, functions and pi for Python, and order terms and factors so that Python, which evaluates
             from left to right, multiplies nothing out
    """

    python: bool = False

    def whole(self, expression: sp.Expr) -> str:
        """Text of a whole expression; raises what :func:`to_text` says."""
        try:
            return self.write(sp.sympify(expression, strict=True), SUM)
        except (sp.SympifyError, TypeError):
            refuse(expression)
        except RecursionError:
            raise TooLargeError(
                "expected an expression that can be written; got one nested too deeply; name its parts"
            ) from None

    def write(self, e: sp.Expr, floor: int) -> str:
        """Text of ``e``, in parentheses when it binds less tightly than ``floor`` asks."""
        return add_brackets(self.spell(e), floor)

    def spell(self, e: sp.Expr) -> tuple[str, int]:
        """Text and how tightly it binds."""
        if isinstance(e, sp.Rational):
            return self.spell_number(e)
        if e is sp.pi:
            return self.prefix("pi"), ATOM
        if e is sp.E:
            return "sp.E" if self.python else "exp(1)", ATOM
        if isinstance(e, sp.Symbol):
            return check_name(e.name), ATOM
        if isinstance(e, sp.Add):
            return " ".join(self.signed_terms(e)), SUM
        if isinstance(e, sp.Mul):
            return self.spell_product(e)
        if isinstance(e, sp.Pow):
            return self.spell_power(e.base, e.exp)
        name = NAMES.get(type(e))
        if name is None or len(e.args) != (2 if name == "atan2" else 1):
            refuse(e)
        called = self.prefix(type(e).__name__ if self.python else name)
        return f"{called}({', '.join(self.write(part, SUM) for part in e.args)})", ATOM

    def prefix(self, name: str) -> str:
        """A name of the algebra."""
        return f"sp.{name}" if self.python else name

    def spell_number(self, e: sp.Rational) -> tuple[str, int]:
        """A number; a fraction binds like a quotient, a negative one like a sum."""
        if number_bits(e) > BITS:
            raise TooLargeError(f"expected numbers of at most {BITS} bits; got a larger one; rescale")
        if self.python and e.q != 1:
            return f"{'-' if e < 0 else ''}sp.Rational({abs(int(e.p))}, {int(e.q)})", SUM if e < 0 else ATOM
        if e < 0:
            return str(e), SUM
        return str(e), ATOM if e.q == 1 else PRODUCT

    def signed_terms(self, e: sp.Add) -> list[str]:
        """Terms in the usual order, each with its sign; in Python those with a minus last: ``1 - K*h``."""
        parts = [self.write(term, SUM) for term in e.as_ordered_terms()]
        if self.python:
            parts.sort(key=lambda part: part.startswith("-"))
        return parts[:1] + [f"- {part[1:]}" if part.startswith("-") else f"+ {part}" for part in parts[1:]]

    def spell_product(self, e: sp.Mul) -> tuple[str, int]:
        """Factors above and below one line; powers with negative rational exponents go below."""
        coefficient, rest = e.as_coeff_Mul()
        above, below = [], []
        for factor in sp.Mul.make_args(rest):
            if isinstance(factor, sp.Pow) and factor.exp.is_Rational and factor.exp < 0:
                below.append(self.spell_power(factor.base, -factor.exp))
            else:
                above.append(self.spell(factor))
        if not isinstance(coefficient, sp.Rational):
            refuse(coefficient)
        if self.python:  # a number before a sum would be multiplied into it
            above.sort(key=lambda part: part[1] == SUM)
        if coefficient.q != 1:
            below.insert(0, self.spell_number(sp.Integer(coefficient.q)))
        if abs(coefficient.p) != 1 or not above:
            above.insert(0, self.spell_number(sp.Integer(abs(coefficient.p))))
        top = "*".join(add_brackets(part, PRODUCT) for part in above)
        text = f"{top}/{self.divisor(below)}" if below else top
        return (f"-{text}", SUM) if coefficient < 0 else (text, PRODUCT)

    def divisor(self, below: list[tuple[str, int]]) -> str:
        """What stands behind the first ``/``; with a sum, one divisor after another: reading would multiply it out."""
        parts = [add_brackets(part, POWER) for part in below]
        if any(level == SUM for _, level in below):
            return "/".join(parts[1:] + parts[:1] if self.python else parts)  # 1/2 in Python is a float
        return parts[0] if len(parts) == 1 else f"({'*'.join(parts)})"

    def spell_power(self, base: sp.Expr, exponent: sp.Expr) -> tuple[str, int]:
        """A power; square roots by name, negative exponents as quotients."""
        if exponent == 1:
            return self.spell(base)
        if exponent == sp.Rational(1, 2):
            return f"{self.prefix('sqrt')}({self.write(base, SUM)})", ATOM
        if exponent.is_Rational and exponent < 0:
            return f"1/{add_brackets(self.spell_power(base, -exponent), POWER)}", PRODUCT
        return f"{self.write(base, ATOM)}**{self.write(exponent, ATOM)}", POWER


def add_brackets(part: tuple[str, int], floor: int) -> str:
    """A part in parentheses when it binds less tightly than ``floor`` asks."""
    text, level = part
    return text if level >= floor else f"({text})"
