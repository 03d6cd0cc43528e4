"""Polynomials in one variable whose coefficients are polynomials in the parameters.

Lists of coefficients, lowest power first. Divisors are monic, so that no step needs a fraction.
"""

from __future__ import annotations

from navsym.models.parameter_ring import Poly, Ring

Coefficients = list[Poly]


def coefficients(ring: Ring, poly: Poly) -> Coefficients:
    """Coefficients of a polynomial of the ring in powers of its last variable mu."""
    parts: list[dict[tuple[int, ...], object]] = [{} for _ in range(poly.degrees()[-1] + 1)]
    for exponents, coefficient in poly.to_dict().items():
        parts[exponents[-1]][(*exponents[:-1], 0)] = coefficient
    return [ring.context.from_dict(part) for part in parts]


def product(ring: Ring, a: Coefficients, b: Coefficients) -> Coefficients:
    """Product of two polynomials."""
    result = [ring.zero] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] = result[i + j] + x * y
    return result


def monic_division(ring: Ring, a: Coefficients, b: Coefficients) -> tuple[Coefficients, Coefficients]:
    """Quotient and remainder by a monic b; the remainder has exactly deg b coefficients."""
    rest, n = list(a), len(b) - 1
    quotient = [ring.zero] * max(len(a) - n, 1)
    for k in range(len(a) - n - 1, -1, -1):
        lead = rest[k + n]
        quotient[k] = lead
        if not lead.is_zero():
            for j in range(n):
                rest[k + j] = rest[k + j] - lead * b[j]
    return quotient, (rest + [ring.zero] * n)[:n]


def monic_quotient(ring: Ring, a: Coefficients, b: Coefficients) -> Coefficients:
    """Quotient by a monic divisor."""
    return monic_division(ring, a, b)[0]


def monic_remainder(ring: Ring, a: Coefficients, b: Coefficients) -> Coefficients:
    """Remainder by a monic divisor, with exactly as many coefficients as its degree."""
    return monic_division(ring, a, b)[1]


def companion_inverse(ring: Ring, a: Coefficients, q: Coefficients) -> tuple[Coefficients, Poly]:
    """v and r with a v = r modulo the monic q, r free of the variable and in lowest terms with v.

    Column k of the linear system is x^k a modulo q; its determinant is the resultant of q and a.
    """
    n = len(q) - 1
    if all(c.is_zero() for c in a[1:]):  # a constant, as for the only factor of q
        return lowest_terms([ring.one], a[0])
    columns = [a]
    for _ in range(n - 1):
        columns.append(monic_remainder(ring, [ring.zero, *columns[-1]], q))
    rows = [[columns[k][i] for k in range(n)] + [ring.one if i == 0 else ring.zero] for i in range(n)]
    return lowest_terms(*solved(ring, rows))


def solved(ring: Ring, rows: list[Coefficients]) -> tuple[Coefficients, Poly]:
    """Solution of a square system as numerators and their common denominator, without fractions (Bareiss)."""
    n, last = len(rows), ring.one
    for k in range(n):
        pivot = next(i for i in range(k, n) if not rows[i][k].is_zero())
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(n):
            if i != k:
                rows[i] = [(rows[k][k] * x - rows[i][k] * y) / last for x, y in zip(rows[i], rows[k], strict=True)]
        last = rows[k][k]
    # Every diagonal entry is now the determinant (up to the sign of the row exchanges, which cancels).
    return [row[-1] for row in rows], last


def lowest_terms(numerators: Coefficients, divisor: Poly) -> tuple[Coefficients, Poly]:
    """Numerators and divisor without their common factor."""
    common = divisor
    for numerator in numerators:
        common = common.gcd(numerator)
    return [numerator / common for numerator in numerators], divisor / common
