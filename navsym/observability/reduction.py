"""Small matrices with the same rank: what is regular for all parameters is taken out first.

Observable functionals are rows over Z[parameters]. A row with an entry that vanishes nowhere is
independent everywhere: it clears its column from all other rows and from all later vectors of the chains, which
keeps their degrees low. What remains has few rows and columns, and its rank drops where the whole rank does.
"""

from __future__ import annotations

import functools
import itertools
import random
from collections.abc import Sequence
from math import gcd, prod
from typing import Any

import sympy as sp
from flint import fmpz_mpoly_vec

from navsym.core.errors import TooLargeError
from navsym.core.rational_functions import factor_exactly, polynomial_sum
from navsym.observability.linear import Matrix
from navsym.observability.motion import Motion
from navsym.observability.ring import Hashed, Poly, Ring, divide, gcd_all, irreducible_factors, is_divisor
from navsym.prove.signs import Sign, prove_sign

# Common real zeros of polynomials as a list of simple systems.
#
# A system is a list of polynomials that vanish together. Systems are split along factors, tidied by Groebner
# bases where those stay small, and left out where no real point can satisfy them.


System = list[Poly]

#: Groebner bases: number of polynomials, terms of each, bits of a coefficient.
LIMITS = (24, 120, 1000)
BRANCHES = 40
#: Terms of a polynomial whose sign is asked for.
DEFINITE_TERMS = 20
#: Terms of a polynomial that is looked at for a sum of two squares.
SQUARE_TERMS = 40
#: Points at which a sign is looked at before it is asked for.
TRIALS = 200
#: Terms of the rows of one step, of a moving and of a constant model.
MOVING_TERMS, CONSTANT_TERMS = 150, 20_000


def components(polynomials: Sequence[Poly], ring: Ring) -> list[list[Poly]]:
    """Real common zeros as a list of simple systems: {f = 0} or {f = 0 and g = 0 ...}.

    The greatest common divisor gives the hypersurfaces; what remains is branched on its factors
    until every branch is a system that does not factor any more.
    """
    common = gcd_all(polynomials, ring.constant(0))
    found = hypersurfaces(common, ring)
    rest = [p / common for p in polynomials]
    if not any(map(ring.is_unit, rest)):
        found += split_system(rest, ring)
    return irredundant(found)


def hypersurfaces(common: Poly, ring: Ring) -> list[list[Poly]]:
    """Real zeros of one polynomial, factor by factor; a sum of squares breaks up further."""
    found: list[list[Poly]] = []
    for f in (f for f in irreducible_factors(common) if not is_definite(f) and not ring.is_unit(f)):
        for system in alternatives(f, ring):
            found += [system] if system == [f] else split_system(system, ring)
    return found


def split_system(start: Sequence[Poly], ring: Ring) -> list[list[Poly]]:
    """Split ``{all start = 0}`` along factors; a branch too long to split is kept as it is."""
    open_branches, closed, steps = [list(start)], [], 0
    while open_branches:
        system = open_branches.pop()
        steps += 1
        if steps > BRANCHES:
            closed.append(system)
            continue
        tidy = reduce_generators(system, ring)
        if tidy is None:
            continue
        for place, f in enumerate(tidy):
            parts = alternatives(f, ring)
            if parts != [[f]]:
                open_branches += [[*tidy[:place], *part, *tidy[place + 1 :]] for part in parts]
                break
        else:
            closed.append(tidy)
    return closed


def alternatives(f: Poly, ring: Ring) -> list[list[Poly]]:
    """The real zeros of one polynomial as a union of systems; [[f]] when nothing is gained."""
    factors = irreducible_factors(f)
    if len(factors) != 1 or factors[0] != f:
        return [[g] for g in factors if not ring.is_unit(g)]
    squares = two_squares(f, ring)
    if squares is not None and ring.is_unit(squares[1]):
        place, twice, b, rest = squares
        return [[twice * ring.context.gen(place) + b, rest]]
    return real_systems([f], ring)


def real_systems(system: list[Poly], ring: Ring) -> list[list[Poly]]:
    """A sum of squares of monomials vanishes over the reals only where every monomial does."""
    f = system[0]
    if any(degree % 2 for degree in f.degrees()):
        return [system]
    terms = f.to_dict()
    signs = {int(c) > 0 for c in terms.values()}
    if len(terms) < 2 or len(signs) > 1 or any(p % 2 for powers in terms for p in powers):
        return [system]
    if any(not any(powers) for powers in terms):
        return []  # a positive constant beside squares
    return [[ring.context.from_dict({tuple(min(p, 1) for p in powers): 1}) for powers in terms]]


def two_squares(f: Poly, ring: Ring) -> tuple[int, Poly, Poly, Poly] | None:
    """(y, 2 a, b, r) of f = a y^2 + b y + c where b^2 - 4 a c <= 0 vanishes only with r; None for another polynomial.

    With f also (2 a y + b)^2 + (4 a c - b^2) = 4 a f vanishes, so that both squares do: r = 0 and 2 a y + b = 0.
    """
    if len(f) > SQUARE_TERMS:
        return None
    second = {k: f.derivative(k).derivative(k) for k, degree in enumerate(f.degrees()) if degree == 2}
    for place, twice in sorted(second.items(), key=lambda item: not ring.is_unit(item[1])):
        slope = f.derivative(place)
        gap = slope**2 - 2 * twice * f
        if gap == 0 or is_somewhere_positive(gap):
            continue
        content, factors = factor_exactly(gap)
        if content < 0 and all(power % 2 == 0 or is_nowhere_negative(base) for base, power in factors):
            rest = prod((base for base, _ in factors), start=ring.constant(1))
            return place, twice, slope - twice * ring.context.gen(place), rest
    return None


def is_somewhere_positive(f: Poly) -> bool:
    """True where a degree, or the first or last term in the order of terms, is that of no f <= 0: a quick look."""
    ends = [(f.coefficient(k), f.monomial(k)) for k in (0, len(f) - 1)]
    return any(int(e) % 2 for e in f.degrees()) or any(c > 0 or any(int(e) % 2 for e in powers) for c, powers in ends)


def is_nowhere_negative(f: Poly) -> bool:
    """True for monomials of even powers with positive factors, and for what is proved to be >= 0 at all real points."""
    if all(int(c) > 0 and not any(int(p) % 2 for p in powers) for powers, c in f.to_dict().items()):
        return True
    if len(f) > DEFINITE_TERMS or any(int(e) % 2 for e in f.degrees()):
        return False
    return all(f(*point) >= 0 for point in small_points(f.context().nvars())) and has_sign(Hashed(f), Sign.NONNEGATIVE)


def reduce_generators(system: list[Poly], ring: Ring) -> list[Poly] | None:
    """Reduced generators of the same real zeros; None when there are none."""
    system = [ring.without_units(p.primitive()[1]) for p in system if p != 0]
    if any(p.is_constant() for p in system) or is_nowhere(system, ring) or any(map(is_definite, system)):
        return None
    kept: list[Poly] = []
    for p in sorted(dict.fromkeys(map(Hashed, system)), key=lambda h: (h.poly.total_degree(), len(h.poly))):
        if not any(is_divisor(q, p.poly) for q in kept):
            kept.append(p.poly)
    if len(kept) > 1:
        generators: Any = fmpz_mpoly_vec(kept, ring.context)
        basis, done = generators.buchberger_naive(limits=LIMITS)
        if done:
            reduced = [p for p in basis.autoreduction(groebner=True) if p != 0]
            if any(map(ring.is_unit, reduced)) or is_nowhere(reduced, ring) or any(map(is_definite, reduced)):
                return None
            kept = reduced
    return kept


def is_definite(f: Poly) -> bool:
    """True for a polynomial that is proved to have one sign at all real points: it vanishes nowhere."""
    size = f.context().nvars()
    at_zero = f[(0,) * size]
    if at_zero == 0 or f.total_degree() % 2 or len(f) > DEFINITE_TERMS:
        return False
    if any(f(*point) * at_zero <= 0 for point in small_points(size)):
        return False
    return has_sign(Hashed(f if at_zero > 0 else -f), Sign.POSITIVE)


@functools.lru_cache(4096)
def has_sign(value: Hashed, sign: Sign) -> bool:
    """True for a polynomial that is proved to have a sign at all real points; a search meets the same ones often."""
    names = [sp.Symbol(f"x{k}", real=True) for k in range(value.poly.context().nvars())]
    return prove_sign(polynomial_sum(names, value.poly), {}, sign).at_least(sign)


@functools.cache
def small_points(size: int) -> list[list[int]]:
    """Points of so many small integers, often zero; always the same ones."""
    source = random.Random(7)
    return [[source.choice((0, 0, 1, -1, 2, -3, 7)) for _ in range(size)] for _ in range(TRIALS)]


def is_nowhere(system: Sequence[Poly], ring: Ring) -> bool:
    """Sine and cosine of half an angle do not vanish together, nor a sum of squares with a term of exponentials."""
    gens = [(ring.context.gen(sine), ring.context.gen(cosine)) for sine, cosine in ring.pairs()]
    if any(all(any(f == g or f == -g for f in system) for g in pair) for pair in gens):
        return True
    others = [k for k, s in enumerate(ring.symbols) if not isinstance(ring.meaning.get(s), sp.exp)]
    for f in system if len(others) < len(ring.symbols) else ():
        powers = [[int(p[k]) for k in others] for p in f.to_dict()]
        one_sign = len({int(c) > 0 for c in f.coeffs()}) == 1 and not any(p % 2 for row in powers for p in row)
        if one_sign and not all(map(any, powers)):
            return True
    return False


def irredundant(systems: list[list[Poly]]) -> list[list[Poly]]:
    """Without repetitions and without systems whose zeros visibly lie inside those of another one."""
    kept: list[list[Poly]] = []
    for system in sorted(systems, key=lambda s: (len(s), [len(f) for f in s], [str(f) for f in s])):
        if not any(is_inside(system, other) for other in kept):
            kept = [other for other in kept if not is_inside(other, system)]
            kept.append(system)
    return kept


def is_inside(inner: System, outer: System) -> bool:
    """True when every polynomial of the outer system lies in the ideal of the inner one: it vanishes there too."""
    return all(lies_in_ideal(f, inner) for f in outer)


def lies_in_ideal(value: Poly, system: System) -> bool:
    """True when a polynomial lies in the ideal of a system that is its own Groebner basis."""
    if value == 0 or not system:
        return bool(value == 0)
    if any(is_divisor(f, value) for f in system):
        return True
    generators: Any = fmpz_mpoly_vec(system, value.context())
    reduced: Any = value
    return bool(reduced.reduction_primitive_part(generators) == 0)


class UnitBasis:
    """Rows with a unit as pivot; every column of a pivot is zero in all other rows of the basis."""

    def __init__(self, ring: Ring) -> None:
        self.ring = ring
        self.rows: list[list[Poly]] = []
        self.columns: list[int] = []

    def over(self, ring: Ring) -> UnitBasis:
        """The same rows, where more is known to be a unit."""
        basis = UnitBasis(ring)
        basis.rows, basis.columns = self.rows, self.columns
        return basis

    def reduced(self, row: list[Poly]) -> list[Poly]:
        """The row without its parts along the basis, times a unit."""
        for own, column in zip(self.rows, self.columns, strict=True):
            if (factor := row[column]) != 0:
                row = [p * own[column] - factor * q for p, q in zip(row, own, strict=True)]
        return lower_row(row, self.ring)

    def take(self, row: list[Poly]) -> bool:
        """Add a reduced row that has a unit among its entries, a number if possible; False when it has none."""
        numbers = (k for k, entry in enumerate(row) if entry != 0 and entry.is_constant())
        column = next(itertools.chain(numbers, (k for k, entry in enumerate(row) if self.ring.is_unit(entry))), None)
        if column is None:
            return False
        pivot = row[column]
        for place, own in enumerate(self.rows):
            if (factor := own[column]) != 0:
                cleared = [p * pivot - factor * q for p, q in zip(own, row, strict=True)]
                self.rows[place] = lower_row(cleared, self.ring)
        self.rows.append(row)
        self.columns.append(column)
        return True


def lower_row(row: list[Poly], ring: Ring) -> list[Poly]:
    """The row without common factors that are numbers or units."""
    for unit in ring.units:
        while any(entry != 0 for entry in row) and (parts := divide_row(row, unit)):
            row = parts
    contents = [int(abs(entry.content())) for entry in row if entry != 0]  # type: ignore[attr-defined]
    if not contents or min(contents) == 1:
        return row
    common = gcd(*contents)
    return row if common == 1 else [entry / common if entry != 0 else entry for entry in row]


def divide_row(row: list[Poly], unit: Poly) -> list[Poly]:
    """The quotients of all entries; none where one leaves a remainder, at the first of them."""
    parts: list[Poly] = []
    for entry in row:
        if (quotient := divide(entry, unit)) is None:
            return []
        parts.append(quotient)
    return parts


def row_weight(row: list[Poly]) -> int:
    """Number of terms to multiply."""
    return sum(len(entry) for entry in row)


def written_rows(starts: Sequence[tuple[list[Poly], int]], motion: Motion) -> Matrix:
    """Short rows that span at every point what the chains (h, number of vectors) span there.

    Every vector is reduced before it is multiplied on: modulo the basis, which is multiplied on as well,
    nothing is lost, and degrees stay low.
    """
    basis = UnitBasis(motion.ring)
    step = [(list(row), count) for row, count in starts]
    rest: Matrix = []
    longest = MOVING_TERMS if motion.rates else CONSTANT_TERMS
    while step:
        following, total = [], 0
        for row, count in step:
            row = basis.reduced(row)
            total += sum(map(len, row))
            if total > longest:
                raise TooLargeError("expected rows that can be written; got too many terms; fix some parameters")
            if all(entry == 0 for entry in row):
                continue
            if not basis.take(row):
                rest.append(row)
            if count > 1:
                following.append((motion.advance(row), count - 1))
        step = following
    return [*basis.rows, *map(basis.reduced, rest)]
