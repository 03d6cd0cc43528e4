"""Where the rank of what a model shows is smaller than wanted: a tree of cases that leaves no parameters out.

A node is a set of points: the equations of its system hold, and its units do not vanish. Rows are taken into a basis
while they have a unit as pivot, each with its derivative behind it. Where no row has one, an entry p is chosen, and
the points are split: p != 0, where it is a unit from now on, and q = 0 for every irreducible factor q of p, over the
real numbers. Three facts make the answer a proof:

* the children cover their parent, so that the leaves cover all points;
* on a leaf the rows of the basis are independent and what they span holds its derivatives: the rank is their number at
  every point of it, and the columns that vanish on them are all that is not shown there;
* a smaller rank is a closed condition: it holds on the closure of the leaf, the zeros of the saturated system.

Along a motion an equation holds with all its derivatives, or almost never: q = 0 stands for both.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Any

import sympy as sp
from flint import Ordering, fmpz_mpoly_ctx, fmpz_mpoly_vec

from navsym.core.errors import TooLargeError
from navsym.core.rational_functions import powers_apart
from navsym.observability.cases import (
    SOLUTION,
    is_irreducible,
    minors_on,
    replace_in_row,
    solved_variables,
    substitute_row,
    substitute_rows,
)
from navsym.observability.linear import Matrix, null_columns
from navsym.observability.motion import Motion
from navsym.observability.reduction import (
    System,
    UnitBasis,
    alternatives,
    components,
    irredundant,
    is_definite,
    is_nowhere,
    lies_in_ideal,
    reduce_generators,
    row_weight,
    small_points,
    two_squares,
)
from navsym.observability.ring import Hashed, Poly, Ring, irreducible_factors

#: Nodes looked at, terms of a row, and terms of an entry to split on; what lies beyond is listed as open.
NODES, TERMS, SPLIT_TERMS = 120, 2000, 400
#: Nodes of a model that moves, whose rows get long.
MOVING_NODES = 24
#: Equations added when a condition is to hold along a motion, and terms of them.
STEPS, MOVED_TERMS = 200, 120
#: Of divisions with remainder: products of terms for a step, degree, letters of a factor of what is left, and how many.
PRODUCTS, DEGREE, LETTERS, REMAINDERS = 20_000, 40, 400, 60
#: Groebner bases of saturations: number of polynomials, terms, bits.
SATURATION = (40, 150, 500)


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """Points on which the rank is the same.

    system : equations of the closure of these points
    rank   : on the points
    unseen : n - rank columns that no row sees there, polynomials modulo the system
    nonzero : where the closure is too long to write, what does not vanish on the points; none otherwise
    dense  : True when the real points are known to be dense among the complex ones
    """

    system: System
    rank: int
    unseen: Matrix
    nonzero: System = field(default_factory=list)
    dense: bool = False


Advance = Callable[[list[Poly]], list[Poly]]


@dataclass(slots=True, eq=False)
class Node:
    """A set of points, and what is known of the rows there: system = 0, and no unit of the ring vanishes."""

    system: System
    ring: Ring
    basis: UnitBasis
    waiting: Matrix

    def tidy(self, row: list[Poly]) -> list[Poly]:
        """A row on the points of the node, without its parts along the basis, times a unit."""
        need_short(row)
        row = self.basis.reduced(need_short(substitute_row(row, self.system, self.ring)))
        return [0 * entry if lies_in_ideal(entry, self.system) else entry for entry in row]

    def grow(self, advance: Advance | None, wanted: int) -> list[Poly]:
        """Take rows while they have a unit as pivot; entries to split on where none has, none at a leaf."""
        stuck: Matrix = []
        while self.waiting and len(self.basis.rows) < wanted:
            self.waiting.sort(key=row_weight)
            row = need_short(self.tidy(self.waiting.pop(0)))
            if all(entry == 0 for entry in row):
                continue
            if not self.basis.take(row):
                stuck.append(row)
                continue
            self.waiting = [*self.waiting, *stuck, *([advance(row)] if advance is not None else [])]
            stuck = []
        self.waiting = [*stuck, *self.waiting]
        return [] if len(self.basis.rows) >= wanted else [entry for row in stuck for entry in row if entry != 0]

    def split_on(self, entries: Sequence[Poly]) -> list[Poly]:
        """Irreducible factors of the entry that is simplest without its units."""
        plain = [self.ring.without_units(entry) for entry in entries]
        chosen = min(plain, key=lambda f: (int(f.total_degree()), len(f)))
        if len(chosen) > SPLIT_TERMS:
            raise TooLargeError(f"expected conditions of at most {SPLIT_TERMS} terms; got more; fix some parameters")
        return irreducible_factors(chosen)

    def assume_nonzero(self, factors: Sequence[Poly]) -> None:
        """Go on where these polynomials do not vanish."""
        self.ring = self.ring.with_units(factors)
        self.basis = self.basis.over(self.ring)

    def follow(self, advance: Advance | None, wanted: int) -> None:
        """Take rows until none is left, on almost all points of the node."""
        while entries := self.grow(advance, wanted):
            self.assume_nonzero(self.split_on(entries))

    def unseen(self, width: int) -> Matrix:
        """The columns of so many entries that vanish on the basis, by its free columns."""
        return list(null_columns(self.basis.rows, self.basis.columns, width, self.ring))


def need_short(row: list[Poly]) -> list[Poly]:
    """The row, refused when it has too many terms."""
    if sum(map(len, row)) > TERMS:
        raise TooLargeError("expected rows that can be written; got too many terms; fix some parameters")
    return row


@dataclass(frozen=True, slots=True, eq=False)
class Cases:
    """The answer of a search.

    drops  : leaves of smaller ranks, without those inside others; their closures are all points of smaller rank
             except for those of the open systems
    open   : systems that were not decided
    """

    drops: list[Leaf]
    open: list[System]


@dataclass(slots=True, eq=False)
class Tree:
    """The search below a system for points where the rank is less than wanted."""

    ring: Ring
    wanted: int
    width: int
    motion: Motion | None = None
    most: int = NODES
    heap: list[tuple[int, int, Node]] = field(default_factory=list)
    drops: list[Leaf] = field(default_factory=list)
    open: list[System] = field(default_factory=list)
    count: int = 0

    def push(self, node: Node) -> None:
        """Put a node in the line: few equations come first, so that large sets are found before their parts."""
        self.count += 1
        heapq.heappush(self.heap, (len(node.system), self.count, node))

    def search(self) -> Cases:
        """All leaves, or as many as the limits allow."""
        visited = 0
        while self.heap:
            node = heapq.heappop(self.heap)[2]
            if is_covered(node.system, [leaf.system for leaf in self.drops if not leaf.nonzero]):
                continue
            visited += 1
            if visited > self.most:
                self.open.append(node.system)
                continue
            try:
                self.visit(node)
            except TooLargeError:
                self.open.append(node.system)
        listed = irredundant([leaf.system for leaf in self.drops if not leaf.nonzero])
        drops = [next(leaf for leaf in self.drops if leaf.system == system) for system in listed]
        drops += [leaf for leaf in self.drops if leaf.nonzero and not is_covered(leaf.system, listed)]
        left = [system for system in irredundant(self.open) if not is_covered(system, listed)]
        return Cases(drops, left)

    def visit(self, node: Node) -> None:
        """Make a node a leaf, or split it."""
        entries = node.grow(self.motion.advance if self.motion is not None else None, self.wanted)
        if entries:
            self.split(node, entries)
            return
        rank = len(node.basis.rows)
        if rank >= self.wanted:
            return
        system, unseen = node.system, node.unseen(self.width)
        dense = is_irreducible(system, node.ring) and has_dense_points(system, node.ring)
        try:
            closed, nonzero = closures(system, node.ring, self.ring), list[Poly]()
        except TooLargeError:
            closed, nonzero = [system], solving_units(system, node.ring, self.ring)
        self.drops += [Leaf(part, rank, unseen, nonzero, dense) for part in closed]

    def split(self, node: Node, entries: Sequence[Poly]) -> None:
        """p != 0, and the factors of p one by one, for the entry p that is simplest without its units.

        Of rows that do not move the points where some minors vanish are enough: elsewhere the rank is the wanted one.
        """
        minors = self.list_minors(node) if self.motion is None else []
        if minors:
            whole = any(map(node.ring.is_unit, minors))
            for part in [] if whole else components([*node.system, *minors], node.ring):
                self.push_parts(node, part)
            return
        factors = node.split_on(entries)
        for factor in factors:
            self.push_parts(node, [*node.system, factor])
        node.assume_nonzero(factors)
        self.push(node)

    def list_minors(self, node: Node) -> list[Poly]:
        """Minors of what is left of the rows on a node; none where the rank is smaller, or where they get long."""
        with suppress(TooLargeError):
            return minors_on(node.waiting, self.wanted - len(node.basis.rows), node.system, node.ring)
        return []

    def push_parts(self, node: Node, system: System) -> None:
        """Put the points of a node on which a larger system holds in the line, solved as far as possible."""
        waiting = [(system, node.ring)]
        for _ in range(STEPS):
            if not waiting:
                return
            part, ring = waiting.pop()
            tidy = tidy_system(part, ring, self.motion is not None)
            if tidy is None:
                continue
            try:
                parts = solve_further(tidy, ring, self.motion)
            except TooLargeError:
                self.open.append(tidy)
                continue
            if parts is None:
                child = restricted(replace(node, ring=ring), tidy)
                parts = []
                if child is not None:
                    self.push(child)
            waiting += parts
        self.open.append(system)


def tidy_system(system: System, ring: Ring, named: bool) -> System | None:
    """The equations without units and repetitions; None where no real point satisfies them.

    named : with what functions become there
    """
    plain = [ring.without_units(f.primitive()[1]) for f in system if f != 0]
    listed = [item.poly for item in dict.fromkeys(map(Hashed, [*plain, *(named_values(plain, ring) if named else [])]))]
    none = any(f.is_constant() for f in listed) or is_nowhere(listed, ring) or any(map(is_definite, listed))
    return None if none else listed


def named_values(system: System, ring: Ring) -> System:
    """What functions become where symbols vanish: sin(w) and sin(w t) are zero with w, exp(w) is one, and back."""
    gens = [ring.context.gen(k) for k in range(len(ring.symbols))]
    gone = {s: sp.Integer(0) for s, k in ring.places.items() if any(f == gens[k] for f in system)}
    known = gone | {symbol: text.subs(gone) for symbol, text in ring.meaning.items()}
    units = [ring.places[s] for s, value in known.items() if value == 1 and s in ring.places]
    ones = [
        ring.meaning[s] for s, k in ring.places.items() if s in ring.meaning and any(f == gens[k] - 1 for f in system)
    ]
    powers = [text.args[0].as_coeff_Mul()[1] for text in ones if isinstance(text, sp.exp)]
    sines = [ring.halves(a)[0] for a in ring.angles if known.get(a.symbol) == 0 or a.symbol in powers]
    return sines + [gens[k] - 1 for k in units] + [gens[ring.places[x]] for x in powers if x in ring.places]


Parts = list[tuple[System, Ring]]


def solve_further(system: System, ring: Ring, motion: Motion | None) -> Parts | None:
    """The points of a system where no unit vanishes, as a union one step nearer to a graph; None where that is reached.

    In a graph every equation names a variable of its own, c x = g, where c is a unit: its points are those of the other
    variables, and where something is not zero it is not zero almost everywhere. Where c is no unit, the points with
    c = 0 and g = 0 go their own way.
    """
    if any(len(f) > SPLIT_TERMS for f in system):
        raise TooLargeError(f"expected conditions of at most {SPLIT_TERMS} terms; got more; fix some parameters")
    for k, f in enumerate(system):
        parts = alternatives(f, ring)
        if parts != [[f]]:
            return [([*system[:k], *part, *system[k + 1 :]], ring) for part in parts]
        if (squares := two_squares(f, ring)) is not None:
            own, twice, b, root = squares
            y, others = ring.context.gen(own), [g for g in system if g is not f]
            at_zero = [twice, b, 2 * f - 2 * b * y - twice * y**2]
            return [([*others, twice * y + b, root], ring.with_units([twice])), ([*others, *at_zero], ring)]
    unsolved = [f for f, place in solved_variables(system, ring) if place is None]
    for f in unsolved:
        place = next((k for k, c in linear_places(f) if ring.is_unit(c)), None)
        if place is not None:
            return substituted(f, place, [g for g in system if g is not f], ring)
    places = [(c, k, f) for f in unsolved for k, c in linear_places(f)]
    if places:
        c, k, f = min(places, key=lambda found: (len(found[0]), found[0].total_degree(), len(found[2])))
        rest = [g for g in system if g is not f]
        nonzero = ring.with_units([c])
        return [(system, nonzero), ([*rest, c, f - c * ring.context.gen(k)], ring)]
    tidy = reduce_generators(unsolved, ring) if len(unsolved) > 1 else unsolved
    if tidy is None:
        return []
    if {*map(str, tidy)} != {*map(str, unsolved)}:
        return [([*(f for f in system if all(f is not g for g in unsolved)), *tidy], ring)]
    if any(len(f) > SOLUTION for f in system):
        raise TooLargeError(f"expected equations of at most {SOLUTION} terms; got more; fix some parameters")
    return derived_parts(system, unsolved, ring, motion)


def is_empty(system: System, ring: Ring) -> bool:
    """True when it is proved that no real point satisfies the equations where no unit vanishes."""
    waiting = [(system, ring)]
    for _ in range(STEPS):
        if not waiting:
            return True
        part, ring = waiting.pop()
        tidy = tidy_system(part, ring, False)
        if tidy is None or restricted(Node(part, ring, UnitBasis(ring), []), tidy) is None:
            continue
        try:
            parts = solve_further(tidy, ring, None)
        except TooLargeError:
            return False
        if parts is None:
            factors = split_remainders([f for f, place in solved_variables(tidy, ring) if place is None], ring)
            parts = None if factors is None else [([*tidy, factor], ring) for factor in factors]
        if parts is None:
            return False
        waiting += parts
    return False


def split_remainders(system: System, ring: Ring) -> list[Poly] | None:
    """Factors of which one vanishes wherever the system does, none of them in its ideal; None where none were found.

    Euclid's remainders of two equations in a variable vanish with both, and so does what is left without units.
    """
    count = 0
    for f, g in combinations(sorted(system, key=len), 2):
        for place in (k for k, degree in enumerate(g.degrees()) if degree and f.degrees()[k]):
            top, bottom = sorted((f, g), key=lambda h: -int(h.degrees()[place]))
            while bottom != 0 and bottom.degrees()[place]:
                rest, count = pseudo_remainder(top, bottom, place), count + 1
                if count > REMAINDERS:
                    return None
                if rest is None or rest == 0:
                    break
                top, bottom = bottom, ring.without_units(rest.primitive()[1])
                factors = irreducible_factors(bottom)
                short = all(len(str(factor)) <= LETTERS for factor in factors)
                if short and not any(lies_in_ideal(factor, system) for factor in factors):
                    return factors
    return None


def pseudo_remainder(top: Poly, bottom: Poly, place: int) -> Poly | None:
    """The rest of a division in a variable, times factors that keep it a polynomial; None where it gets long."""
    x, degree = top.context().gen(place), int(bottom.degrees()[place])
    lead = powers_apart(bottom, place)[degree,]
    while top != 0 and (own := int(top.degrees()[place])) >= degree:
        share = powers_apart(top, place)[own,]
        if len(top) * len(lead) + len(bottom) * len(share) > PRODUCTS or top.total_degree() > DEGREE:
            return None
        common = share.gcd(lead)
        top = lead / common * top - share / common * x ** (own - degree) * bottom
    return top


def linear_places(f: Poly) -> list[tuple[int, Poly]]:
    """Variables of degree one in a polynomial, with their factors, which do not hold them."""
    return [(k, f.derivative(k)) for k, degree in enumerate(f.degrees()) if degree == 1]


def substituted(f: Poly, place: int, others: System, ring: Ring) -> Parts:
    """A system with the variable that f = c x - g names put into its other equations and the units."""
    units = [replace_in_row([unit], f, place, ring)[0] for unit in ring.units]
    if any(unit == 0 for unit in units):
        return []
    found = [replace_in_row([g], f, place, ring)[0] for g in others]
    return [([f, *(g for g in found if g != 0)], replace(ring, units=()).with_units(units))]


def derived_parts(system: System, unsolved: System, ring: Ring, motion: Motion | None) -> Parts | None:
    """The system with the derivative of an equation along a motion; None where all are zero on it."""
    if motion is None or not motion.rates:
        return None
    rows = substitute_rows([[motion.derivative(f)] for f in system], system, ring)
    moved = [ring.without_units(f) for (f,) in rows]
    fresh = [f for f in moved if f != 0 and not lies_in_ideal(f, unsolved)]
    if not fresh:
        return None
    turns = list_turns(system, motion)
    if turns:
        return [(part, ring) for part in turns]
    shortest = min(fresh, key=len)
    if len(shortest) > MOVED_TERMS:
        raise TooLargeError(f"expected conditions of at most {MOVED_TERMS} terms; got more; fix some parameters")
    return [([*system, shortest], ring)]


def list_turns(system: System, motion: Motion) -> list[System]:
    """The points that keep a system on which one angle alone moves; none for another system.

    The rate vanishes all the time, or the angle takes infinitely many values: then all coefficients of the forms in its
    sine and cosine vanish.
    """
    ring, moving = motion.ring, {place for place in motion.rates if any(f.degrees()[place] for f in system)}
    pair = next((pair for pair in ring.pairs() if moving and moving <= {*pair}), None)
    if pair is None:
        return []
    rate, rest = divmod(ring.without_units(motion.rates[pair[0]]), ring.context.gen(pair[1]))
    listed = [powers_apart(f, *pair) for f in system]
    forms = all(len({sum(powers) for powers in parts}) == 1 for parts in listed)
    if rest != 0 or not forms or any(rate.degrees()[k] for k in pair):
        return []
    return [[*system, rate], [f for parts in listed for f in parts.values()]]


def is_covered(system: System, listed: Sequence[System]) -> bool:
    """True when the zeros of a system visibly lie inside those of one of the others."""
    return any(all(lies_in_ideal(f, system) for f in other) for other in listed)


def search_drops(
    rows: Sequence[list[Poly]],
    wanted: int,
    ring: Ring,
    motion: Motion | None = None,
    system: System | None = None,
    nodes: int | None = None,
) -> Cases:
    """Where the rank of the rows, and of all their derivatives along a motion, is below ``wanted``.

    system : only among its zeros; all points by default
    nodes  : so many cases at most
    """
    most = nodes or (MOVING_NODES if motion is not None and motion.rates else NODES)
    tree = Tree(ring, wanted, len(rows[0]) if rows else 0, motion, most)
    tree.push_parts(Node([], ring, UnitBasis(ring), [list(row) for row in rows]), system or [])
    return tree.search()


def leaf_on(system: System, rows: Matrix, ring: Ring, motion: Motion | None = None) -> Leaf | None:
    """Rank, and columns that are not shown, at almost all real points of a system.

    None for one that is not known to be irreducible with real points on all of it.
    """
    width = len(rows[0])
    node = restricted(Node([], ring, UnitBasis(ring), [list(row) for row in rows]), system)
    if node is None or not is_irreducible(system, ring) or not has_dense_points(system, ring):
        return None
    try:
        node.follow(motion.advance if motion is not None else None, width)
    except TooLargeError:
        return None
    return Leaf(system, len(node.basis.rows), node.unseen(width))


def has_dense_points(system: System, ring: Ring) -> bool:
    """True when no polynomial outside the ideal of an irreducible system vanishes at all its real points.

    Theorem: an irreducible f that has both signs generates all polynomials that vanish on its real zeros. The variables
    that the other equations name follow.
    """
    rest = [f for f, place in solved_variables(system, ring) if place is None]
    points = small_points(len(ring.symbols))
    return all(len({f(*point) > 0 for point in points if f(*point) != 0}) == 2 for f in rest)


def lost_columns(leaf: Leaf, generic: Matrix, ring: Ring) -> Matrix:
    """Columns that are not shown on a leaf, without those that are generically not shown."""
    node = restricted(Node([], ring, UnitBasis(ring), [list(column) for column in generic]), leaf.system)
    if node is None or not leaf.unseen:
        return []
    width, lost = len(leaf.unseen[0]), []
    node.follow(None, width)
    for column in leaf.unseen:
        known = len(node.basis.rows)
        node.waiting = [list(column)]
        node.follow(None, width)
        lost += [column] if len(node.basis.rows) > known else []
    return lost


def restricted(node: Node, system: System) -> Node | None:
    """A node among the zeros of a larger system; None where one of its units vanishes there."""
    units = [substitute_row([unit], system, node.ring)[0] for unit in node.ring.units]
    if any(lies_in_ideal(unit, system) for unit in units):
        return None
    ring = replace(node.ring, units=()).with_units(units)
    basis = UnitBasis(ring)
    for row, column in zip(node.basis.rows, node.basis.columns, strict=True):
        basis.rows.append(substitute_row(row, system, node.ring))
        basis.columns.append(column)
    return Node(system, ring, basis, [list(row) for row in node.waiting])


# Closures


def closures(system: System, ring: Ring, domain: Ring) -> list[System]:
    """The closure of the points with system = 0 where no unit of the ring vanishes, as simple systems.

    The units of the domain vanish nowhere and need no closure. A system that only names variables is closed.
    """
    if is_irreducible(system, domain):
        return [system]  # a unit does not vanish on a part of it
    for unit in solving_units(system, ring, domain):
        system = saturate(system, unit, domain)
    return components(system, domain)


def solving_units(system: System, ring: Ring, domain: Ring) -> list[Poly]:
    """The units of a ring, but not of the domain, that can vanish on a part of the closure of a system.

    In a graph over at most one more equation these are the factors of its variables.
    """
    units = ring.units
    if is_irreducible(system, ring):
        factors = [f.derivative(k) for f, k in solved_variables(system, ring) if k is not None]
        units = tuple(unit for factor in factors for unit in irreducible_factors(factor))
    known = [*map(str, domain.units)]
    return list({str(unit): unit for unit in units if str(unit) not in known}.values())


def saturate(system: System, unit: Poly, ring: Ring) -> System:
    """Generators of the polynomials f with unit^k f in the ideal: f of the ideal with 1 - y unit, without y.

    Raises TooLargeError where the Groebner basis gets long.
    """
    names = ("y", *(f"g{k}" for k in range(len(ring.symbols))))
    wider = fmpz_mpoly_ctx.get(names, Ordering.lex)

    def lift(f: Poly, power: int = 0) -> Poly:
        return wider.from_dict({(power, *map(int, powers)): int(c) for powers, c in f.to_dict().items()})

    generators: Any = fmpz_mpoly_vec([*map(lift, system), wider.constant(1) - lift(unit, 1)], wider)
    basis, done = generators.buchberger_naive(limits=SATURATION)
    if not done:
        raise TooLargeError("expected systems that can be written; got too many terms; fix some parameters")
    found = [f.to_dict() for f in basis.autoreduction(groebner=True) if f != 0]
    free = [f for f in found if not any(int(powers[0]) for powers in f)]
    return [ring.context.from_dict({tuple(map(int, p[1:])): int(c) for p, c in f.items()}) for f in free]
