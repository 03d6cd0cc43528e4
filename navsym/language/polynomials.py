"""Trees as polynomials over the rational numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx

from navsym.core.errors import DomainError, TooLargeError
from navsym.core.exact import to_fmpq
from navsym.language.names import quote
from navsym.language.tree import NUMBER, POWER, PRODUCT, SUM, SYMBOL, Tree, fold_tree, list_names

TERMS = 1_000_000  # of a power that is multiplied out
DEGREE = 2**31


def to_polynomial(tree: Tree, names: Sequence[str] | None = None) -> fmpq_mpoly:
    """The polynomial that the tree means, in the symbols ``names`` or in those of the tree by the alphabet.

    Raises DomainError for what is no polynomial, TooLargeError for powers of sums with over a million terms.

    >>> from navsym.language.expression import read_tree
    >>> to_polynomial(read_tree("(x + y)**2 - x*y/2"))
    x^2 + 3/2*x*y + y^2
    """
    names = sorted(list_names(tree)) if names is None else list(names)
    ring = fmpq_mpoly_ctx.get(names, Ordering.lex)
    symbols = dict(zip(names, ring.gens(), strict=True))

    def step(part: Tree, inner: list[fmpq_mpoly]) -> fmpq_mpoly:
        if part.head == NUMBER:
            return ring.constant(to_fmpq(part.args[0]))
        if part.head == SYMBOL and part.args[0] in symbols:
            return symbols[part.args[0]]
        if part.head == SUM:
            return add_all(inner)
        if part.head == PRODUCT:
            return math.prod(inner[1:], start=inner[0])
        if part.head == POWER:
            return raise_to(part, inner[0])
        raise refuse_part(part)

    return fold_tree(tree, step)


def add_all(terms: list[fmpq_mpoly]) -> fmpq_mpoly:
    """A sum by halves: one after another, each term would be copied with every one behind it."""
    while len(terms) > 1:
        pairs = zip(terms[::2], terms[1::2], strict=False)
        terms = [a + b for a, b in pairs] + terms[len(terms) // 2 * 2 :]
    return terms[0]


def raise_to(part: Tree, base: fmpq_mpoly) -> fmpq_mpoly:
    """A whole power; of a number also a negative one."""
    exponent = part.args[1]
    power = exponent.args[0] if exponent.head == NUMBER else Fraction(1, 2)
    n, is_number = power.numerator, base.is_constant()
    if power.denominator != 1 or (n < 0 and not is_number) or (n <= 0 and not base):
        raise refuse_part(part)
    size = max((max(abs(c.p), c.q) for c in base.coeffs()), default=1)
    is_long = (int(size).bit_length() - 1) * abs(n) > TERMS or max(base.degrees(), default=0) * n > DEGREE
    if is_long or (len(base) > 1 and math.comb(len(base) + n - 1, n) > TERMS):
        message = f"expected at most {TERMS} terms and digits; got {quote(repr(part))}; split the expression"
        raise TooLargeError(message)
    return base**n if n >= 0 else (1 / base.leading_coefficient()) ** -n + 0 * base


def refuse_part(part: Tree) -> DomainError:
    """The error for a part that makes the whole no polynomial."""
    message = f"expected a polynomial with rational coefficients; got {quote(repr(part))} in it; rewrite it"
    return DomainError(message)
