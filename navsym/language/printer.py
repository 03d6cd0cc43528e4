"""Expressions back to text: the inverse of the parser."""

from __future__ import annotations

from typing import NoReturn

import sympy as sp

from navsym.core.errors import ExpressionSyntaxError, TooLargeError
from navsym.language.arithmetic import BITS, BUILDERS, number_bits
from navsym.language.names import check_name, shown

SUM, PRODUCT, POWER, ATOM = range(4)

NAMES: dict[type, str] = {builder: name for name, builder in BUILDERS.items() if isinstance(builder, type)}


def to_text(expression: sp.Expr) -> str:
    """Text of the language of files that means the expression: ``sin(T/2)**2``, ``3/4``, ``sqrt(x)``.

    ``parse(to_text(e), symbols) == e`` for every expression that the language can build.
    Raises ExpressionSyntaxError on anything outside the language (floating-point numbers, I,
    infinities, Piecewise, names that are not ASCII) and TooLargeError on depth.
    """
    try:
        return write(sp.sympify(expression, strict=True), SUM)
    except (sp.SympifyError, TypeError):
        refuse(expression)
    except RecursionError:
        raise TooLargeError(
            "expected an expression that can be written; got one nested too deeply; name its parts"
        ) from None


def refuse(part: object) -> NoReturn:
    """Raise ExpressionSyntaxError for what the language does not have."""
    kind = type(part).__name__
    text = shown(str(part)) if not isinstance(part, str) else shown(part)
    raise ExpressionSyntaxError(
        f"expected numbers, names, + - * / **, pi and the functions of the language; got {kind} {text}; "
        "rewrite it exactly in these terms"
    )


def write(e: sp.Expr, floor: int) -> str:
    """Text of ``e``, in parentheses when it binds less tightly than ``floor`` asks."""
    text, level = written(e)
    return text if level >= floor else f"({text})"


def written(e: sp.Expr) -> tuple[str, int]:
    """Text and how tightly it binds."""
    if isinstance(e, sp.Rational):
        return rational(e)
    if e is sp.pi:
        return "pi", ATOM
    if e is sp.E:
        return "exp(1)", ATOM
    if isinstance(e, sp.Symbol):
        return check_name(e.name), ATOM
    if isinstance(e, sp.Add):
        return plus(e), SUM
    if isinstance(e, sp.Mul):
        return times(e)
    if isinstance(e, sp.Pow):
        return powered(e.base, e.exp)
    name = NAMES.get(type(e))
    if name is None or len(e.args) != (2 if name == "atan2" else 1):
        refuse(e)
    return f"{name}({', '.join(write(part, SUM) for part in e.args)})", ATOM


def rational(e: sp.Rational) -> tuple[str, int]:
    """A number; a fraction binds like a quotient, a negative one like a sum."""
    if number_bits(e) > BITS:
        raise TooLargeError(f"expected numbers of at most {BITS} bits; got a larger one; rescale")
    if e < 0:
        return str(e), SUM
    return str(e), ATOM if e.q == 1 else PRODUCT


def plus(e: sp.Add) -> str:
    """Terms in the usual order, with their signs between them."""
    text = ""
    for term in e.as_ordered_terms():
        part = write(term, SUM)
        if not text:
            text = part
        elif part.startswith("-"):
            text += f" - {part[1:]}"
        else:
            text += f" + {part}"
    return text


def times(e: sp.Mul) -> tuple[str, int]:
    """Factors above and below one line; powers with negative rational exponents go below."""
    coefficient, rest = e.as_coeff_Mul()
    above, below = [], []
    for factor in sp.Mul.make_args(rest):
        if isinstance(factor, sp.Pow) and factor.exp.is_Rational and factor.exp < 0:
            below.append(powered(factor.base, -factor.exp))
        else:
            above.append(written(factor))
    if not isinstance(coefficient, sp.Rational):
        refuse(coefficient)
    if coefficient.q != 1:
        below.insert(0, rational(sp.Integer(coefficient.q)))
    if abs(coefficient.p) != 1 or not above:
        above.insert(0, rational(sp.Integer(abs(coefficient.p))))
    top = "*".join(tight(part, PRODUCT) for part in above)
    parts = [tight(part, POWER) for part in below]
    bottom = parts[0] if len(parts) == 1 else f"({'*'.join(parts)})"
    if any(level == SUM for _, level in below):
        bottom = "/".join(parts)  # reading 2*(x + y) would multiply it out
    text = f"{top}/{bottom}" if below else top
    return (f"-{text}", SUM) if coefficient < 0 else (text, PRODUCT)


def tight(part: tuple[str, int], floor: int) -> str:
    """A part in parentheses when it binds less tightly than ``floor`` asks."""
    text, level = part
    return text if level >= floor else f"({text})"


def powered(base: sp.Expr, exponent: sp.Expr) -> tuple[str, int]:
    """A power; square roots by name, negative exponents as quotients."""
    if exponent == 1:
        return written(base)
    if exponent == sp.Rational(1, 2):
        return f"sqrt({write(base, SUM)})", ATOM
    if exponent.is_Rational and exponent < 0:
        below = powered(base, -exponent)
        return f"1/{tight(below, POWER)}", PRODUCT
    return f"{write(base, ATOM)}**{write(exponent, ATOM)}", POWER
