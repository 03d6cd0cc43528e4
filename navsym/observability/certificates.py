"""Certificates of ranks and of their drops, for the checker, in the words of the model.

A rank is granted by a point that attains it and by columns that no row sees (``check_observability``). A drop is the
same with zeros beside: where they vanish the columns stay unseen, because every remainder is a sum of the zeros. Here
point, columns and factors are found; the checker alone grants them. What finds no certificate stands as unchecked, with
the reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, count, islice, product
from math import lcm, prod
from typing import Any

import numpy as np
import sympy as sp
from flint import Ordering, fmpq_mpoly_ctx
from sympy.polys.polyerrors import BasePolynomialError

from navsym import checker
from navsym.core.errors import NavsymError
from navsym.core.rational_functions import cancel_fraction, replace_square
from navsym.language.printer import to_text
from navsym.models.certificates import matrix_texts
from navsym.models.linear import LinearModel
from navsym.observability.cases import replace_in_entry, replace_in_row, solved_variables
from navsym.observability.chains import JointObservability
from navsym.observability.linear import Matrix, null_vectors, primitive_vector, scalar_product
from navsym.observability.motion import Motion, motion_of
from navsym.observability.points import search_points
from navsym.observability.rank_drops import RankDrop
from navsym.observability.reduction import System, lies_in_ideal
from navsym.observability.ring import Poly, Ring
from navsym.observability.tree import linear_places

#: Points tried, terms of the columns and of all remainders of a constant and of a moving model, bits for each state.
POINTS, COLUMN_TERMS, TERMS, BITS = 6, (4000, 1500), (200_000, 60_000), 96
#: Rounds of divisions by all zeros, and steps of Newton's method.
DIVISIONS, NEWTON = 20, 25
#: Why there is no certificate.
NO_DIRECTIONS, NO_RANK, IN_PASSING = "no directions were found", "the rank was not found", "it holds in passing"
LONG, NO_SHARES, NO_POINT = "long directions", "no short sums of the zeros were found", "no exact point was found"
#: Largest product of numerator and denominator under a root.
LARGE = 2**100
#: Values of angles that an equation names.
TURNS = (sp.Integer(0), sp.pi, sp.pi / 2, -sp.pi / 2)


@dataclass(frozen=True, slots=True, eq=False)
class Statement:
    """What a certificate says: the rows of H in these places show ``rank`` dimensions where the system vanishes.

    Where something must not vanish, its reciprocal t is one more constant of the system: t f - 1 = 0 (Rabinowitsch).
    """

    model: LinearModel
    motion: Motion
    rows: Matrix
    bottoms: list[Poly]
    places: Sequence[int]
    system: System
    rank: int
    nonzero: System

    @property
    def ring(self) -> Ring:
        """The ring of all polynomials."""
        return self.motion.ring

    @property
    def zeros(self) -> System:
        """The system, and the relations of the manifold of the states."""
        symbols, generator = self.ring.symbols, self.ring.context.gen
        own = [k for k in self.motion.roots if symbols[k] in self.model.squares]
        return [*self.system, *(generator(k) ** 2 - self.motion.roots[k] for k in own)]


@dataclass(frozen=True, slots=True, eq=False)
class Certifier:
    """Proposes certificates of one model; ``certify`` and its like return what the checker grants, or why nothing."""

    model: LinearModel
    motion: Motion
    rows: Matrix
    bottoms: list[Poly]

    @classmethod
    def of(cls, model: LinearModel) -> Certifier:
        """Read the model once."""
        motion, listed = motion_of(model)
        return cls(model, motion, [row for row, _ in listed], [bottom for _, bottom in listed])

    def certify(
        self, rank: int, columns: Matrix, system: System, places: Sequence[int], nonzero: System | None = None
    ) -> dict[str, Any] | str:
        """That the measurements in some places show ``rank`` dimensions where the system vanishes.

        columns : n - rank columns that none of them sees there
        nonzero : what does not vanish there
        """
        units = nonzero or []
        motion = replace(self.motion, ring=self.motion.ring.with_units(units)) if units else self.motion
        said = Statement(self.model, motion, self.rows, self.bottoms, places, system, rank, units)
        found = certify_columns(said, columns)
        shorter = shorten_columns(columns, said) if isinstance(found, str) else columns
        return certify_columns(said, shorter) if count_terms(shorter) < count_terms(columns) else found

    def certify_rank(self, joint: JointObservability) -> dict[str, Any] | str:
        """The generic rank of all measurements together."""
        found = joint.chains.directions
        return NO_DIRECTIONS if found is None else self.certify(joint.joint_dimension, found, [], range(len(self.rows)))

    def certify_drop(self, drop: RankDrop, owners: Sequence[str] = ()) -> dict[str, Any] | str:
        """A drop that lasts, with the rank that is left on it; owners : the measurement of each row, if not its own."""
        names = owners or self.model.measurements
        places = [k for k, name in enumerate(names) if drop.subspace in ("joint", name)]
        found = [self.certify(leaf.rank, leaf.unseen, leaf.system, places, leaf.nonzero) for leaf in drop.leaves]
        reasons = [item for item in found if isinstance(item, str)]
        if reasons or not found:
            return next(iter(reasons), NO_RANK if drop.lasting else IN_PASSING)
        return found[0] if len(found) == 1 else {"kind": "all", "of": found}


def certify_columns(said: Statement, columns: Matrix) -> dict[str, Any] | str:
    """A certificate with these columns, or why there is none."""
    motion = said.motion
    with suppress(NavsymError):
        long = count_terms(columns) > COLUMN_TERMS[bool(motion.rates)]
        columns, free = diagonal_columns([] if long else columns, motion.size, motion.ring, said.system)
        if len(columns) != motion.size - said.rank:
            return LONG
        shares = factors_of(said, columns, free, said.zeros) if said.zeros else []
        return NO_SHARES if shares is None else first_granted(propose(said, columns, free, shares))
    return LONG


def first_granted(proposed: Iterable[dict[str, Any]]) -> dict[str, Any] | str:
    """The first certificate that the checker accepts; what it refuses for its length is as long with other points."""
    for item in proposed:
        try:
            checker.check(item)
        except checker.Refused as refusal:
            if "too many terms" in str(refusal):
                return LONG
            continue
        return item
    return NO_POINT


def count_terms(columns: Matrix) -> int:
    """Terms of all entries."""
    return sum(map(len, chain(*columns)))


def shorten_columns(columns: Matrix, said: Statement) -> Matrix:
    """The same directions on the system, without the variables that its equations name and without common factors."""
    for f, place in zip(said.system, own_variables(said.system, said.ring), strict=True):
        if place is not None:
            columns = [replace_in_row(column, f, place, said.ring) for column in columns]
    return [primitive_vector(column, said.ring) for column in columns]


def list_nested(drops: Iterable[RankDrop]) -> Iterator[RankDrop]:
    """Drops, each before those inside it."""
    for drop in drops:
        yield drop
        yield from list_nested(drop.inside)


def is_granted(item: Mapping[str, Any]) -> bool:
    """True when the checker accepts a certificate."""
    try:
        return bool(checker.check(item))
    except checker.Refused:
        return False


def propose(
    said: Statement, columns: Matrix, free: Sequence[int], shares: list[list[sp.Expr]]
) -> Iterator[dict[str, Any]]:
    """Certificates with a point each."""
    ring, n, zeros = said.ring, said.motion.size, said.zeros
    H, named = said.model.H.extract(list(said.places), list(range(n))), [ring.expression(f) for f in zeros]
    null = sp.Matrix(len(columns), n, [ring.expression(x) for column in columns for x in column])
    known = sp.Mul(*(ring.condition(f) for f in said.nonzero))
    slope = rate_of(said.model, known)
    longest = max(len(str(s)) for s in (*ring.symbols, said.model.time, *said.model.rates))
    t = sp.Symbol("t" * (longest + 1), real=True)
    if said.nonzero:
        shares = [[*row, sp.Integer(0)] for row in shares]
        shares.insert(len(zeros), [*([sp.Integer(0)] * len(zeros)), -t * slope])
        named.append(t * known - 1)
    factors = sp.Matrix(len(shares), len(named), [x for row in shares for x in row])
    symbols, rates = symbols_and_rates(said.model, [said.model.F, H, null, factors, sp.Matrix(named)])
    rates |= {t: -(t**2) * slope} if said.nonzero and slope != 0 else {}
    searched = ({s: sp.Integer(1) for s in symbols} | at for at in islice(search_points(zeros, ring), POINTS))
    for point in chain(points_on(zeros, said, symbols), searched if zeros and not said.motion.roots else ()):
        value = known.subs(point)
        if value == 0:
            continue
        point[t] = 1 / value
        yield {
            "kind": "observability",
            "statement": {
                "F": matrix_texts(said.model.F),
                "H": matrix_texts(H),
                "rates": {s.name: to_text(rate) for s, rate in rates.items()},
                "zeros": [to_text(zero) for zero in named],
                "rank": said.rank,
            },
            "point": {s.name: to_text(point[s]) for s in symbols},
            "order": n,
            "free": free,
            "null": matrix_texts(null),
            "shares": matrix_texts(factors),
            "bits": 256 + BITS * n,
        }


def rate_of(model: LinearModel, value: sp.Expr) -> sp.Expr:
    """Derivative along the motion."""
    given = {model.time: sp.Integer(1), **model.rates}
    return sp.expand(sp.Add(*(sp.diff(value, s) * rate for s, rate in given.items())))


def symbols_and_rates(model: LinearModel, matrices: Sequence[sp.MatrixBase]) -> tuple[list[sp.Symbol], dict[Any, Any]]:
    """All symbols of the matrices and of the rates of those that move, and these rates."""
    given = {model.time: sp.Integer(1), **model.rates}
    found: set[Any] = set().union(*(matrix.free_symbols for matrix in matrices))
    rates: dict[Any, Any] = {}
    while moving := (found & given.keys()) - rates.keys():
        for symbol in moving:
            rates[symbol] = sp.sympify(given[symbol], strict=True)
            found |= rates[symbol].free_symbols
    return sorted(found, key=str), {s: rates[s] for s in sorted(rates, key=str)}


def diagonal_columns(columns: Matrix, n: int, ring: Ring, system: System | None = None) -> tuple[Matrix, list[int]]:
    """Columns with the same span of which each has a place where the others are zero, and these places; else none.

    Where the system vanishes, none vanishes in its place.
    """
    if count_terms(columns) > COLUMN_TERMS[0]:
        return [], []
    places = free_places(columns, n, system or [])
    if len(places) < len(columns):
        columns = null_vectors(null_vectors(columns, n, ring), n, ring)
        places = free_places(columns, n, system or [])
    return (columns, places) if len(places) == len(columns) else ([], [])


def free_places(columns: Matrix, n: int, system: System) -> list[int]:
    """For each column the place of its shortest entry where all others are zero; fewer where one has none."""
    found = []
    for column in columns:
        own = [k for k in range(n) if column[k] != 0 and all(c is column or c[k] == 0 for c in columns)]
        own.sort(key=lambda k: len(column[k]))
        found += next(([k] for k in own if not lies_in_ideal(column[k], system)), [])
    return found


# Remainders as sums of the zeros


def factors_of(said: Statement, columns: Matrix, free: Sequence[int], zeros: System) -> list[list[sp.Expr]] | None:
    """For every remainder of the checker, in its order, the factors of the zeros; None where one was not found."""
    found = []
    budget = TERMS[bool(said.motion.rates)]
    for value, bottom in remainders(said, columns, free, zeros):
        budget -= len(value)
        row = as_combination(value, zeros, said) if budget > 0 else None
        if row is None:
            return None
        parts, unit = row
        found.append([said.ring.expression(cancel_fraction(part, unit * bottom)) for part in parts])
    return found


def remainders(said: Statement, columns: Matrix, free: Sequence[int], zeros: System) -> Iterator[tuple[Poly, Poly]]:
    """z', H N and F N - N' - N M as (top, bottom)."""
    ring, n = said.ring, said.motion.size
    motion = replace(said.motion, roots={})
    zero, one, clock = ring.constant(0), ring.constant(1), motion.clock
    for z in zeros:
        yield motion.derivative(z), clock
    for place, column in product(said.places, columns):
        yield scalar_product(said.rows[place], column, zero), said.bottoms[place]
    for column in columns:
        flow = motion.retreat(column)
        shares = [(flow[k], own[k], own) for k, own in zip(free, columns, strict=True) if flow[k] != 0]
        whole = prod((pivot for _, pivot, _ in shares), start=one)
        for i in range(n):
            value = whole * flow[i]
            for share, pivot, own in shares:
                value = value - whole / pivot * share * own[i] if own[i] != 0 else value
            yield value, whole * clock


def as_combination(value: Poly, zeros: System, said: Statement) -> tuple[list[Poly], Poly] | None:
    """(factors q, unit u) with u value = sum q_k zeros_k up to squares of roots; None where there are none."""
    ring = said.ring
    unit, parts = ring.constant(1), [ring.constant(0) for _ in zeros]
    places = own_variables(zeros, ring)
    for k in sorted(range(len(zeros)), key=lambda k: places[k] is None):
        f, place = zeros[k], places[k]
        scale = ring.constant(1)
        if k >= len(said.system):
            root = next(g for g, square in said.motion.roots.items() if ring.context.gen(g) ** 2 - square == f)
            rest = replace_square(value, root, said.motion.roots[root])
        elif place is not None and value != 0 and (degree := int(value.degrees()[place])):
            factor = f.derivative(place)
            rest = replace_in_entry(value, place, factor * ring.context.gen(place) - f, factor, degree, ring)
            scale = factor**degree
        else:
            rest = divmod(value, f)[1] if place is None else value
        parts, unit = [part * scale for part in parts], unit * scale
        parts[k] = (value * scale - rest) / f
        value = rest
    if said.motion.reduced(value) == 0:
        return parts, unit
    tried = (divide_on(value, zeros, parts, unit, order) for order in (ring.context.ordering(), Ordering.lex))
    return next((found for found in tried if found is not None), None)


def own_variables(system: System, ring: Ring) -> list[int | None]:
    """Places of variables of degree one that stand in no other equation, with a unit as factor where it can be."""
    found = []
    for f, place in solved_variables(system, ring):
        alone = (k for k, _ in linear_places(f) if not any(g is not f and g.degrees()[k] for g in system))
        found.append(min(alone, key=lambda k: len(f.derivative(k)), default=None) if place is None else place)
    return found


def divide_on(
    value: Poly, zeros: System, parts: list[Poly], unit: Poly, order: Ordering
) -> tuple[list[Poly], Poly] | None:
    """Go on by division by all zeros in turn, which ends with 0 where they are a Groebner basis; None elsewhere."""
    whole = value.context()
    ring = fmpq_mpoly_ctx.get(whole.names(), order)
    rest, *divisors = (ring.from_dict(f.to_dict()) for f in (value, *zeros))
    found = [ring.from_dict({}) for _ in zeros]
    for _ in range(DIVISIONS):
        for k, f in enumerate(divisors):
            quotient, rest = divmod(rest, f)
            found[k] += quotient
    if rest != 0:
        return None
    scale = lcm(*(int(c.q) for quotient in found for c in quotient.coeffs()))
    quotients = [whole.from_dict({powers: int((c * scale).p) for powers, c in q.to_dict().items()}) for q in found]
    return [part * scale + q for part, q in zip(parts, quotients, strict=True)], unit * scale


# Points


def points_on(zeros: System, said: Statement, symbols: Sequence[sp.Symbol]) -> Iterator[dict[Any, sp.Expr]]:
    """A few points where the zeros vanish: rational but for what the equations give, by roots or angles."""
    texts = [said.ring.expression(f) for f in zeros]
    angles = sorted({s for text in texts for f in text.atoms(sp.sin, sp.cos) for s in f.free_symbols}, key=str)
    turns = [(TURNS[k] if k < len(TURNS) else 4 * sp.atan(sp.Rational(1, k)),) * len(angles) for k in range(POINTS)]
    turns += [values for values in product(TURNS, repeat=2) if len({*values}) == len(angles) == 2]
    for (fine, values), k in zip(product((500, 1), turns), count()):
        size = 7 if k % 2 and fine > 1 else 1
        signed = [size if k == 0 or (i + k) % 3 else -size for i in range(len(symbols))]
        at = {
            s: sp.Rational(sp.prime(2 * i + k + 3), c * (7 * i + 2 * k + 9))
            if fine > 1
            else sp.Integer(c * ((5 * i + 3 * k) % 17 + 2))
            for i, (s, c) in enumerate(zip(symbols, signed, strict=True))
        }
        at |= dict(zip(angles, values, strict=True))
        here = [text.subs({s: at[s] for s in angles}).expand(trig=True) for text in texts]
        rest = [value for value in here if value != 0]
        if all(value.free_symbols for value in rest):
            with suppress(BasePolynomialError, np.linalg.LinAlgError):
                found = solve_near(rest, at, k, fine) if rest else {}
                yield from [] if found is None else [at | found]


def solve_near(
    zeros: list[sp.Expr], at: Mapping[Any, sp.Expr], turn: int, fine: int = 500
) -> dict[Any, sp.Expr] | None:
    """Rational values near a point, or roots, at which polynomials vanish; None where they were not found.

    Newton's steps find the way in floats, and how many variables depend there on the others; exact algebra solves for
    these, those of low degree if possible.

    turn : place of the symbol that comes first
    fine : largest denominator of what is free
    """
    names = sorted(set().union(*(zero.free_symbols for zero in zeros)), key=str)
    names = names[turn % len(names) :] + names[: turn % len(names)]
    system = [sp.Poly(zero, *names, domain="QQ") for zero in zeros]
    slopes = [[f.diff(x) for x in names] for f in system]
    near, degrees = np.array([float(at[x]) for x in names]), [max(f.degree(x) for f in system) for x in names]
    easy = np.diag([100.0**-degree for degree in degrees])
    for _ in range(NEWTON):
        J = np.array([[value_near(g, near) for g in row] for row in slopes])
        near = near - easy @ np.linalg.lstsq(J @ easy, [value_near(f, near) for f in system], rcond=1e-9)[0]
    order = sorted(range(len(names)), key=degrees.__getitem__)
    own: list[int] = []
    for j in order:
        own += [j] if np.linalg.matrix_rank(J[:, [*own, j]], tol=1e-6) > len(own) else []
    found = {names[j]: sp.Rational(Fraction(near[j]).limit_denominator(fine)) for j in order if j not in own}
    basis = sp.groebner([zero.subs(found) for zero in zeros], *(names[j] for j in own), order="lex", domain="QQ")
    for zero in reversed(basis.exprs):
        left = [names[j] for j in own if names[j] in zero.free_symbols and names[j] not in found]
        c = sp.Poly(zero.subs(found), left[0]).all_coeffs() if len(left) == 1 else []
        if len(c) == 2:
            found[left[0]] = -c[1] / c[0]
        elif len(c) == 3 and (root := c[1] ** 2 - 4 * c[0] * c[2]).is_nonnegative:
            found[left[0]] = (sp.sqrt(root) - c[1]) / (2 * c[0])
    long = any(r.base.is_Rational and r.base.p * r.base.q > LARGE for x in found.values() for r in x.atoms(sp.Pow))
    return None if long or len(found) < len(names) else found


def value_near(f: sp.Poly, point: Any) -> float:
    """A polynomial at a point in floats."""
    return float(sum(float(c) * np.prod(point ** np.array(powers)) for powers, c in f.terms()))
