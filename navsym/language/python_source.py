"""An exact expression as Python source, written as a person would write it with sympy at hand as ``sp``."""

from __future__ import annotations

import sympy as sp

SUM, PRODUCT, MINUS, POWER, ATOM = range(5)
#: A side of a claim that is longer is written with one term on each line.
WIDE = 92


def side_source(expression: sp.Expr) -> str:
    """Source of a side of a claim: a sympy value even for a bare number, a long sum with one term on each line."""
    if isinstance(expression, sp.Integer):
        return f"sp.Integer({int(expression)})"
    text = exact_source(expression)
    if len(text) <= WIDE or not isinstance(expression, sp.Add):
        return text
    return "(\n" + "".join(f"            {part}\n" for part in terms(expression)) + "        )"


def exact_source(expression: sp.Expr, floor: int = SUM) -> str:
    """Source that builds the expression exactly; in brackets when it binds looser than ``floor`` asks.

    No quotient of two plain integers is ever written: Python would make a float of it.
    """
    text, level = written(expression)
    return text if level >= floor else f"({text})"


def written(expression: sp.Expr) -> tuple[str, int]:
    """Source and how tightly it binds."""
    if isinstance(expression, sp.Integer):
        return str(int(expression)), ATOM if expression >= 0 else MINUS
    if isinstance(expression, sp.Rational):
        return f"sp.Rational({int(expression.p)}, {int(expression.q)})", ATOM
    if isinstance(expression, sp.Symbol):
        return str(expression.name), ATOM
    if expression is sp.pi or expression is sp.E:
        return ("sp.pi" if expression is sp.pi else "sp.E"), ATOM
    if isinstance(expression, sp.Add):
        return " ".join(terms(expression)), SUM
    if isinstance(expression, sp.Mul):
        return product(expression)
    if isinstance(expression, sp.Pow):
        return power(expression)
    name = expression.func.__name__
    return f"sp.{name}({', '.join(exact_source(part) for part in expression.args)})", ATOM


def terms(expression: sp.Add) -> list[str]:
    """The terms with their signs, the first without a plus and negative ones behind: ``1 - K*h``."""
    found: list[str] = []
    for term in sorted(expression.as_ordered_terms(), key=is_negative):
        negative = is_negative(term)
        text = exact_source(-term if negative else term, PRODUCT)
        sign = "-" if negative else "+"
        found.append(f"{sign} {text}" if found else ("-" if negative else "") + text)
    return found


def is_negative(term: sp.Expr) -> bool:
    """True for a term that is written with a minus."""
    return bool(term.could_extract_minus_sign()) and not isinstance(term, sp.Add)


def product(expression: sp.Mul) -> tuple[str, int]:
    """``-2*a*(b + c)/(3*d)``: sums last, so that a number before one is not multiplied into it."""
    number, factors = expression.as_coeff_mul()
    if not number.is_Rational:
        number, factors = sp.Integer(1), expression.args
    above = sorted((f for f in factors if not divides(f)), key=lambda f: isinstance(f, sp.Add))
    below = [1 / f for f in factors if divides(f)]
    top = [exact_source(f, MINUS) for f in above]
    bottom = [exact_source(f, MINUS) for f in below]
    whole, part = abs(int(number.p)), int(number.q)
    if not top and not bottom:
        return exact_source(number), ATOM
    top = [str(whole)] * (whole != 1 or not top) + top
    bottom = [str(part)] * (part != 1) + bottom
    text = "*".join(top) + (f"/({'*'.join(bottom)})" if len(bottom) > 1 else "/" + bottom[0] if bottom else "")
    return ("-" if number.p < 0 else "") + text, PRODUCT


def divides(factor: sp.Expr) -> bool:
    """True for a factor that is written below the line; a bare power of a number stays above, with its own exponent."""
    return isinstance(factor, sp.Pow) and factor.exp.is_Rational and factor.exp < 0 and not factor.base.is_number


def power(expression: sp.Pow) -> tuple[str, int]:
    """A power and how tightly it binds: ``sp.sqrt`` for 1/2, ``1/`` for -1 over what is no number, else ``**``."""
    base, exponent = expression.args
    if exponent == sp.Rational(1, 2):
        return f"sp.sqrt({exact_source(base)})", ATOM
    if exponent == -1 and not base.is_number:
        return f"1/{exact_source(base, POWER)}", PRODUCT
    below = f"sp.Integer({int(base)})" if isinstance(base, sp.Integer) else exact_source(base, ATOM)
    return f"{below}**{exact_source(exponent, ATOM)}", POWER
