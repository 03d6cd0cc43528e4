"""Sums of sines and cosines as products, so that their signs can be read off exactly.

``2 cos(t - T/2) - 2 cos(T/2)`` becomes ``4 sin(t/2) sin((T - t)/2)``. In the normal form of the checker, with
``z = exp(i angle)``, a trigonometric polynomial is an ordinary one: factor it there, and bring every factor back to
real form about its middle power. The product is returned only when exact algebra shows it equal to the sum, so that the
factoring itself need not be trusted.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import lcm
from typing import Any

import sympy as sp
from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx
from sympy.simplify.fu import TR1, TR2

from navsym.core.errors import NavsymError
from navsym.core.exact import to_rational
from navsym.core.rational_functions import factor_exactly
from navsym.language.expression import symbol
from navsym.prove.identities import read_term, vanishes_identically
from navsym.prove.rooms.goals import player

#: A monomial: exponents of the atoms of the normal form. What such an atom is of, and its kind.
Powers = tuple[fmpq, ...]
Base = tuple[str, sp.Expr]


def as_product(expression: sp.Expr) -> sp.Expr | None:
    """The expression as a product of real factors, or None when no factoring was found."""
    if not expression.has(sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc):
        return None
    try:
        found = real_factors(sp.fraction(sp.together(TR2(TR1(expression)))))
    except (NavsymError, player.Refused):
        return None
    if found is None or sum(map(len, found)) < 2:
        return None
    product = sp.Mul(*found[0]) / sp.Mul(*found[1])
    product = product.xreplace({symbol(own.name): own for own in expression.free_symbols})
    # The phases left out of the factors multiply to a rational constant.
    product *= constant_ratio(expression, product)
    return product if vanishes_identically(expression - product) else None


def as_squares(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr | None:
    """``a cos x + b sin x + c`` with ``a**2 + b**2 = c**2``, zero at one angle, as ``((a + c cos x)**2 + …) / (2 c)``.

    None for others, and for what has the symbol in other ways.
    """
    angles = {wave.args[0] for wave in expression.atoms(sp.sin, sp.cos) if wave.has(symbol)}
    if len(angles) != 1:
        return None
    cosine, sine = sp.cos(*angles), sp.sin(*angles)
    whole = sp.expand(expression)
    a, b = whole.coeff(cosine), whole.coeff(sine)
    c = sp.expand(whole - a * cosine - b * sine)
    if c == 0 or any(part.has(symbol) for part in (a, b, c)) or not vanishes_identically(c**2 - a**2 - b**2):
        return None
    return ((a + c * cosine) ** 2 + (b + c * sine) ** 2) / (2 * c)


def constant_ratio(expression: sp.Expr, product: sp.Expr) -> sp.Rational:
    """Guess the constant from one point, or 1; the guess is proved afterwards."""
    symbols = sorted(expression.free_symbols, key=str)
    point = {symbol: sp.Rational(7 + 4 * k, 10 + 3 * k) for k, symbol in enumerate(symbols)}
    value, base = complex(expression.subs(point).evalf(30)), complex(product.subs(point).evalf(30))
    ratio = Fraction((value / base).real).limit_denominator(4096) if base else 0
    return to_rational(ratio or Fraction(1))


def real_factors(sides: tuple[sp.Expr, sp.Expr]) -> list[list[sp.Expr]] | None:
    """Real forms of the irreducible factors of a quotient in lowest terms, without phases and constants."""
    numbers = [read_exact(side) for side in sides]
    atoms = list({atom for number in numbers for monomial in number.terms for atom, _ in monomial})
    known = [(read_atom(atom), atom) for atom in atoms]
    if not all(number.terms for number in numbers) or any(base is None for base, _ in known):
        return None
    known.sort(key=lambda pair: sp.default_sort_key(sp.Tuple(sp.Symbol(pair[0][0]), pair[0][1])))  # type: ignore[index]
    bases, atoms = [base for base, _ in known if base], [atom for _, atom in known]
    rows = [{tuple(fmpq(dict(m).get(atom, 0)) for atom in atoms): c for m, c in number} for number in numbers]
    sizes = [lcm(*(int(q.q) for q in powers)) for powers in zip(*rows[0], *rows[1], strict=True)]
    low = [tuple(map(min, zip(*row, strict=True))) for row in rows]
    ring = fmpq_mpoly_ctx.get([f"g{k}" for k in range(len(atoms))], Ordering.lex)
    above, below = (
        ring.from_dict({tuple(int(e) for e in scale(m, start, sizes)): c for m, c in row.items()})
        for row, start in zip(rows, low, strict=True)
    )
    common = above.gcd(below)
    found = [real_forms(bases, part / common, start, sizes) for part, start in zip((above, below), low, strict=True)]
    return None if None in found else [forms for forms in found if forms is not None]


def read_exact(expression: sp.Expr) -> Any:
    """The normal form of an expression."""
    term = read_term(expression)
    names = player.make_symbols(sorted(player.symbols_of(term)))
    return player.evaluate(term, names, player.Exact).parts[0].divide_turns()


def scale(powers: Powers, start: Powers, sizes: list[int]) -> Powers:
    """Whole exponents above the lowest ones."""
    return tuple((q - low) * n for q, low, n in zip(powers, start, sizes, strict=True))


def real_forms(bases: list[Base], polynomial: fmpq_mpoly, start: Powers, sizes: list[int]) -> list[sp.Expr] | None:
    """Real forms of the factors of a polynomial times its lowest powers; None where one has none."""
    forms = [real_form(bases, {start: fmpq(1)})]
    for factor, power in factor_exactly(polynomial)[1]:
        terms = {tuple(fmpq(int(e), n) for e, n in zip(m, sizes, strict=True)): c for m, c in factor.to_dict().items()}
        form = real_form(bases, terms)
        forms.append(None if form is None else form**power)
    return None if None in forms else [form for form in forms if form != 1]


def read_atom(atom: Any) -> Base | None:
    """The kind of an atom and what it is of: a symbol, exp or cis of a product of symbols and pi; None for others."""
    _, kind, content = atom
    if kind.startswith("symbol "):
        return "symbol", symbol(kind.removeprefix("symbol "))
    if kind == "pi":
        return "symbol", sp.pi
    if kind not in ("exp", "cis"):
        return None
    product = sp.Integer(1)
    for monomial, _ in content:
        for inner, power in monomial:
            base = read_atom(inner)
            if base is None or base[0] != "symbol":
                return None
            product *= base[1] ** to_rational(fmpq(power))
    return ("turn" if atom == player.TURN else kind), product


def real_form(bases: list[Base], terms: Mapping[Powers, fmpq]) -> sp.Expr | None:
    """A factor divided by its middle power: a sum of cosines, or i times a sum of sines."""
    places = [k for k, (kind, _) in enumerate(bases) if kind == "cis"]
    turns = [k for k, (kind, _) in enumerate(bases) if kind == "turn"]
    if len(terms) > 1 and any(powers[k] for powers in terms for k in turns):
        return None  # a root of unity inside the factor
    middle = {k: (min(p[k] for p in terms) + max(p[k] for p in terms)) / 2 for k in places}
    for parity in (1, -1):
        mirrored = (tuple(2 * middle[k] - q if k in middle else q for k, q in enumerate(powers)) for powers in terms)
        if all(terms.get(m) == parity * c for m, c in zip(mirrored, terms.values(), strict=True)):
            return sp.Add(*(real_term(bases, powers, middle, c, parity) for powers, c in terms.items()))
    return None


def real_term(bases: list[Base], powers: Powers, middle: Mapping[int, fmpq], c: fmpq, parity: int) -> sp.Expr:
    """One term of a real form: the cosine or sine of what is left of its angles, times its symbols and exponentials."""
    angle, share = sp.Integer(0), to_rational(c)
    for k, ((kind, base), q) in enumerate(zip(bases, powers, strict=True)):
        if kind == "cis":
            angle += to_rational(q - middle[k]) * base
        elif kind != "turn":
            share *= base ** to_rational(q) if kind == "symbol" else sp.exp(to_rational(q) * base)
    return share * (sp.cos if parity == 1 else sp.sin)(angle)
