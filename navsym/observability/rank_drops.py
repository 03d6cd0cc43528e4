"""All parameter values at which an observable subspace shrinks.

A chain of generic dimension m spans at every parameter point what its first m vectors span there, so that the
drops are the points where these vectors, of one measurement or of all together, have a smaller rank. One tree of cases
decides where, over the real numbers: on the vectors themselves for an instant, and along the motion for an interval.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp
from flint import fmpz, fmpz_mat

from navsym.claims.statement import Box
from navsym.core.errors import TooLargeError
from navsym.observability.chains import Chain, Chains, JointObservability
from navsym.observability.linear import Matrix
from navsym.observability.motion import Motion
from navsym.observability.reduction import (
    System,
    components,
    irredundant,
    is_nowhere,
    lies_in_ideal,
    reduce_generators,
    written_rows,
)
from navsym.observability.ring import Hashed, Poly, Ring, irreducible_factors, is_divisor, is_odd
from navsym.observability.tree import (
    SPLIT_TERMS,
    Cases,
    Leaf,
    is_covered,
    is_empty,
    leaf_on,
    lost_columns,
    named_values,
    search_drops,
)
from navsym.prove.assumptions import is_nonzero

# Determinants of chains by values at integer points.
#
# The vectors h, h G, ..., h G^(k-1) of a dense model have thousands of terms, and elimination multiplies them; their
# determinant at a point in integers takes microseconds. Its degree in a parameter x is bounded beforehand: where G is
# affine in x and x stands in r rows, or in r columns, of G, a unit lower triangular matrix turns row j > 1 of a chain
# into one of degree r in x (plus that of h), so that the degree is at most r times the number of steps. With
# G = G_0 + x B C, where C has r rows, h G^j = h G_0^j + x sum_i m_i C G_0^(j-1-i), and the series of the m_i is
# h(z) (1 - x z Q(z))^-1: the Toeplitz matrix of the determinant of 1 - x z Q(z), of degree r in x, clears the inverse.
# Values on the grid of all degrees determine the polynomial: nothing is left to chance.


#: So many points at most: about ten seconds of processor time for ten states.
POINTS = 120_000


def degree_in(entry: Poly, place: int) -> int:
    """Degree of a polynomial in one generator; 0 for the zero polynomial."""
    return int(entry.degrees()[place]) if entry != 0 else 0


def affine_steps(matrix: Matrix, place: int) -> int | None:
    """r of the module's text for one generator; None where the matrix is not affine in it."""
    held = [[degree_in(entry, place) for entry in row] for row in matrix]
    if max(map(max, held)) > 1:
        return None
    return min(sum(map(any, held)), sum(map(any, zip(*held, strict=True))))


def generator_degree_bound(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix, place: int) -> int:
    """Degree in one generator that the determinant of the chains (h, number of vectors) cannot exceed."""
    first = sum(count * max(degree_in(entry, place) for entry in row) for row, count in starts)
    highest = max(degree_in(entry, place) for row in matrix for entry in row)
    plain = highest * sum(count * (count - 1) // 2 for _, count in starts)
    steps = affine_steps(matrix, place)
    return first + (plain if steps is None else min(plain, steps * sum(count - 1 for _, count in starts if count)))


def points_needed(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix) -> int:
    """Number of integer points at which the determinant of the chains is taken."""
    starts = [(row, count) for row, count in starts if count]
    return math.prod(
        generator_degree_bound(starts, matrix, place) + 1 for place in range(matrix[0][0].context().nvars())
    )


def chain_determinant(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix, ring: Ring) -> Poly | None:
    """Determinant of the chains (h, number of vectors), n vectors together; None when it takes too many points."""
    starts = [(row, count) for row, count in starts if count]
    bounds = [generator_degree_bound(starts, matrix, place) for place in range(matrix[0][0].context().nvars())]
    if math.prod(bound + 1 for bound in bounds) > POINTS:
        return None
    motion = Table(itertools.chain(*matrix))
    rows = [(Table(row), count) for row, count in starts]
    grid = itertools.product(*(range(bound + 1) for bound in bounds))
    values = [determinant_at(rows, motion, len(matrix), point) for point in grid]
    for bound in bounds:
        values = along_first_axis(values, bound)
    powers = itertools.product(*(range(b + 1) for b in bounds))
    return ring.context.from_dict({power: c for power, c in zip(powers, values, strict=True) if c != 0})


class Table:
    """Entries to be taken at many points: numbers are converted once."""

    def __init__(self, entries: Iterable[Poly]) -> None:
        listed = list(entries)
        self.varying = [(place, entry) for place, entry in enumerate(listed) if entry != 0 and not entry.is_constant()]
        self.fixed = [fmpz(int(entry.leading_coefficient())) if len(entry) == 1 else fmpz(0) for entry in listed]

    def at(self, point: Sequence[int]) -> list[fmpz]:
        """Values of all entries at a point."""
        values = self.fixed.copy()
        for place, entry in self.varying:
            values[place] = entry(*point)
        return values


def determinant_at(starts: Sequence[tuple[Table, int]], motion: Table, n: int, point: Sequence[int]) -> fmpz:
    """The determinant at one point, in integers; chains are doubled with the squares of G."""
    powers = [fmpz_mat(n, n, motion.at(point))]
    rows: list[fmpz] = []
    for start, count in starts:
        chain = start.at(point)
        step = 0
        while len(chain) < n * count:
            if step == len(powers):
                powers.append(powers[-1] * powers[-1])
            more = fmpz_mat(len(chain) // n, n, chain) * powers[step]
            chain, step = chain + more.entries(), step + 1
        rows += chain[: n * count]
    return fmpz_mat(n, n, rows).det()


def along_first_axis(values: list[fmpz], bound: int) -> list[fmpz]:
    """From values at 0..bound to coefficients along the first axis of a grid, which becomes the last one."""
    size = bound + 1
    powers = fmpz_mat([[k**j for j in range(size)] for k in range(size)])
    found: Any = powers.solve(fmpz_mat(size, len(values) // size, values))
    return [value.p for value in found.transpose().entries()]


#: Cases of rows that do not move.
WRITTEN = 60
#: So many staircases at most, when the joint locus is written down by its definition, and terms of all of them.
MOST_STAIRCASES, LAST_TERMS = 40, 40_000
#: Drops inside drops inside drops are looked for so deep; more directions have too many terms to be read.
NESTED, DIRECTION_TERMS = 3, 60
#: Nodes looked at for the rank on one system, and terms of a zero that declarations may exclude.
FEW, LIMITED_TERMS = 12, 60


@dataclass(frozen=True, slots=True, eq=False)
class RankDrop:
    """The rank of a subspace is smaller where all the polynomials vanish together.

    subspace   : name of a measurement, or "joint"
    zeros      : polynomials, irreducible over the rationals where that could be reached
    nonzero    : polynomials that do not vanish on the drop; none where all points of the zeros belong to it
    complete   : True when the drops listed for this subspace are proved to be all real ones
    lasting    : False where the condition holds at an instant only: the motion leaves it, and the interval shows all
    excluded   : True when what the symbols are declared to be excludes it
    rank       : what is left at almost all points of the condition; None where it was not found
    directions : rows (k, n) of the directions that are shown elsewhere and lost here; none where they are long
    inside     : drops within this one, where the rank is smaller still; of the joint subspace
    whole      : True when ``inside`` is proved to hold all of them
    leaves     : system, rank and unseen columns of its parts as polynomials, from which its certificate is made
    """

    subspace: str
    zeros: tuple[sp.Expr, ...]
    complete: bool
    nonzero: tuple[sp.Expr, ...] = ()
    lasting: bool = True
    excluded: bool = False
    rank: int | None = None
    directions: sp.ImmutableMatrix = field(default_factory=lambda: sp.ImmutableMatrix(0, 0, []))
    inside: tuple[RankDrop, ...] = ()
    whole: bool = False
    leaves: tuple[Leaf, ...] = ()

    @property
    def condition(self) -> str:
        """The drop as text: ``zero = 0`` and ``factor != 0`` for every polynomial, joined by ``and``."""
        return " and ".join([join_conditions(self.zeros), *(f"{factor} != 0" for factor in self.nonzero)])


def join_conditions(zeros: Iterable[sp.Expr]) -> str:
    """Equations as text."""
    return " and ".join(f"{zero} = 0" for zero in zeros)


@dataclass(frozen=True, slots=True, eq=False)
class DropList:
    """The answer of :func:`find_drops`.

    complete : subspace -> whether its list is proved to hold all drops
    open     : subspace -> conditions under which nothing was decided; outside of them the list is complete, and where
               there are none and it is not complete, nothing is known beside the list
    """

    drops: tuple[RankDrop, ...]
    complete: dict[str, bool]
    open: dict[str, tuple[str, ...]]


def find_drops(found: JointObservability, box: Box | None = None) -> DropList:
    """The drops of every subspace. Of a model that moves those that last come first: the motion keeps them."""
    if found.written is None:
        return DropList((), {"joint": False}, {})
    chains, ring = found.chains, found.chains.ring
    drops: list[RankDrop] = []
    complete, left = {}, {}
    for name, (part, locus) in all_loci(chains).items():
        complete[name] = locus.complete
        left[name] = tuple(filter(None, (join_conditions(conditions_on(system, ring)) for system in locus.open)))
        rows = [row for chain in part for row in chain.starts]
        generic = leaf_on([], rows, ring, chains.motion) if locus.lasting else None
        view = View(name, rows, generic, chains.motion, locus.complete, box or {})
        drops += view.list_drops(locus.lasting, NESTED if name == "joint" else 0, locus.leaves)
        written = (conditions_on(system, ring) for system in join_half_angles(locus.passing, ring))
        drops += [view.make_drop(zeros, lasting=False) for zeros in written if zeros]
    return DropList(tuple(sorted(drops, key=lambda drop: not drop.lasting)), complete, left)


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What is needed to describe the drops of one subspace: its rows h, and what is generically not shown."""

    subspace: str
    rows: Matrix
    generic: Leaf | None
    motion: Motion
    complete: bool
    box: Box

    def make_drop(self, zeros: tuple[sp.Expr, ...], **more: Any) -> RankDrop:
        """A drop with its zeros."""
        excluded = any(is_nonzero(zero, self.box) for zero in zeros if self.is_limited(zero))
        return RankDrop(self.subspace, zeros, self.complete, excluded=excluded, **more)

    def is_limited(self, zero: sp.Expr) -> bool:
        """True for a short zero with a symbol of which something is declared beside that it is real."""
        return len(zero.args) <= LIMITED_TERMS and any(
            symbol in self.box or symbol.is_nonzero for symbol in zero.free_symbols
        )

    def list_drops(self, systems: list[System], depth: int, known: Sequence[Leaf]) -> list[RankDrop]:
        """Drops on some systems, each with its rank, its lost directions, and the drops inside it.

        known : leaves of the tree: those with what does not vanish on them are listed, too
        """
        ring = self.motion.ring
        listed = []
        for system in join_half_angles(with_values(systems, ring), ring):
            zeros = conditions_on(system, ring)
            if not zeros or is_nowhere(system, ring):
                continue
            leaves = () if self.is_vague(system) else self.leaves_on(system) or self.leaves_below(system, known)
            if not leaves:
                listed.append(self.make_drop(zeros))
                continue
            lost = [self.lost_on(leaf) for leaf in leaves]
            sizes = [sum(len(entry) for column in columns for entry in column) for columns in lost]
            short = lost[0] if all(columns == lost[0] for columns in lost) and sizes[0] <= DIRECTION_TERMS else []
            entries = [ring.expression(entry) for column in short for entry in column]
            inner = search_drops(self.rows, leaves[0].rank, ring, self.motion, system) if depth else None
            listed.append(
                self.make_drop(
                    zeros,
                    rank=leaves[0].rank,
                    directions=sp.ImmutableMatrix(len(short), self.motion.size, entries),
                    inside=tuple(self.list_drops(closed_systems(inner.drops), depth - 1, inner.drops)) if inner else (),
                    whole=inner is not None and not inner.open,
                    leaves=leaves,
                )
            )
        real = [leaf for leaf in known if leaf.nonzero and not is_empty(leaf.system, ring.with_units(leaf.nonzero))]
        partial = [(conditions_on(leaf.system, ring), leaf) for leaf in real]
        return listed + [
            self.make_drop(zeros, nonzero=tuple(map(ring.condition, leaf.nonzero)), rank=leaf.rank, leaves=(leaf,))
            for zeros, leaf in partial
            if zeros
        ]

    def lost_on(self, leaf: Leaf) -> Matrix:
        """Columns that are lost on a leaf; none where they are long."""
        with suppress(TooLargeError):
            return lost_columns(leaf, self.generic.unseen, self.motion.ring) if self.generic is not None else []
        return []

    def is_vague(self, system: System) -> bool:
        """True where functions may depend on each other: exp(a t) and exp(w t) are one where a = w, sin(w) is no w."""
        ring = self.motion.ring
        named = {s for text in ring.meaning.values() for s in text.free_symbols}
        held = {ring.places[s] for s in named | {a.symbol for a in ring.angles} if s in ring.places}
        mixed = [f for f in system if len(f) > 1 and any(f.degrees()[place] for place in held)]
        numbers = not ring.meaning and len(mixed) == 1 and sum(map(bool, mixed[0].degrees())) == 1
        zero = {s for s, place in ring.places.items() if any(f == ring.context.gen(place) for f in system)}
        sines = [ring.halves(a)[0] for a in ring.angles if a.symbol in (named | ring.places.keys()) - zero]
        turns = any(is_divisor(S, f) for S in sines for f in system)  # w = 0 is one of many points
        return turns or (bool(mixed) and not numbers)  # sin(w) is transcendental for algebraic w != 0 (Lindemann)

    def leaves_on(self, system: System) -> tuple[Leaf, ...]:
        """What is shown on a system, on both of its parts where it joins half angles; none where it was not found."""
        ring, long = self.motion.ring, sum(map(len, system)) > SPLIT_TERMS
        parts = [[f] for f in irreducible_factors(system[0])] if len(system) == 1 and not long else [system]
        found = [leaf_on(part, self.rows, ring, self.motion) for part in ([] if long else parts)]
        leaves = tuple(leaf for leaf in found if leaf is not None)
        return leaves if len(leaves) == len(parts) and len({leaf.rank for leaf in leaves}) == 1 else ()

    def leaves_below(self, system: System, known: Sequence[Leaf]) -> tuple[Leaf, ...]:
        """The leaf whose closure is the system: one that is known, or one that the tree below the system shows."""

        def whole(leaves: Sequence[Leaf]) -> tuple[Leaf, ...]:
            return tuple(
                leaf for leaf in leaves if leaf.dense and {*map(Hashed, leaf.system)} == {*map(Hashed, system)}
            )

        if whole(known) or self.generic is None:
            return whole(known)
        below = search_drops(self.rows, self.generic.rank, self.motion.ring, self.motion, system, FEW)
        return whole(below.drops)


def with_values(systems: list[System], ring: Ring) -> list[System]:
    """The systems with what functions become where their symbols vanish, once each."""
    whole = systems
    for _ in range(2):  # exp(w) = 1 gives w = 0, and that sin(w) = 0
        more = [[f for f in named_values(system, ring) if not lies_in_ideal(f, system)] for system in whole]
        whole = [[*system, *fresh] for system, fresh in zip(whole, more, strict=True)]
    return list({frozenset(map(Hashed, system)): system for system in whole}.values())


def closed_systems(leaves: Sequence[Leaf]) -> list[System]:
    """Systems of leaves whose closures are known."""
    return [leaf.system for leaf in leaves if not leaf.nonzero]


def conditions_on(system: System, ring: Ring) -> tuple[sp.Expr, ...]:
    """The equations in the symbols of the model; none where no point satisfies them.

    Generators that stand for functions follow the symbols in them: with w = 0 also sin(w*t) = 0, and cos(w*t) is not.
    """
    zeros = [ring.condition(f) for f in system]
    if any(isinstance(zero, sp.exp) for zero in zeros):
        return ()
    fixed = {zero: sp.Integer(0) for zero in zeros if zero.is_Symbol}
    if not ring.meaning and not fixed.keys() & {angle.symbol for angle in ring.angles}:
        return tuple(zeros)
    rest = [zero.subs(fixed) for zero in zeros if zero not in fixed]
    if any(zero.is_Number and zero != 0 for zero in rest):
        return ()
    return (*fixed, *(zero for zero in rest if zero != 0))


def join_half_angles(systems: list[System], ring: Ring) -> list[System]:
    """Two equations in half an angle that make one in the whole angle stand as that one.

    sin(x/2) = 0 or cos(x/2) = 0 is sin(x) = 0; f = 0 or its mirror image (cos(x/2) with the other sign) = 0 is
    one equation as well.
    """
    listed = list(systems)
    for sine, cosine in ring.pairs():
        S, C = ring.context.gen(sine), ring.context.gen(cosine)
        singles = [f for (f,) in (system for system in listed if len(system) == 1) if is_odd(f, cosine)]
        while singles:
            f = singles.pop()
            mirror = f.compose(*(-C if k == cosine else ring.context.gen(k) for k in range(len(ring.symbols))))
            partners = {"S": [C], "C": [S]}.get("S" if f == S else "C" if f == C else "", [mirror, -mirror])
            other = next((g for g in singles if any(g == partner for partner in partners)), None)
            if other is not None:
                singles.remove(other)
                place = next(k for k, system in enumerate(listed) if system == [f])
                listed[place] = [f * other]
                listed.remove([other])
    return listed


@dataclass(frozen=True, slots=True, eq=False)
class Locus:
    """Where the rank of a subspace is smaller: systems that the motion keeps, and those that hold in passing.

    leaves : of the tree
    open   : systems among whose zeros nothing was decided
    """

    lasting: list[System]
    passing: list[System] = field(default_factory=list)
    leaves: list[Leaf] = field(default_factory=list)
    open: list[System] = field(default_factory=list)
    complete: bool = True


def all_loci(chains: Chains) -> dict[str, tuple[tuple[Chain, ...], Locus]]:
    """Where every chain, and all of them together, span less."""
    answer = {chain.name: ((chain,), locus_of(chains, (chain,), chain.dimension)) for chain in chains.chains}
    if len(chains.chains) == 1:
        return {**answer, "joint": answer[chains.chains[0].name]}
    return {**answer, "joint": (chains.chains, locus_of(chains, chains.chains, chains.joint_dimension))}


def locus_of(chains: Chains, part: tuple[Chain, ...], rank: int) -> Locus:
    """Where some chains span less together: by the tree on written rows or along the motion, or by the definition."""
    ring, motion = chains.ring, chains.motion
    if motion.roots:
        return Locus([], complete=False)
    written = written_drops(part, rank, motion)
    systems = irredundant(closed_systems(written.drops))
    whole = not written.open and not any(leaf.nonzero for leaf in written.drops)
    if whole and not motion.rates:
        return Locus(systems, [], written.drops)
    chained = not motion.rates and not any(chain.stacked for chain in part)
    listed = drops_by_staircases(chains, part, rank) if chained else None
    if listed is not None:
        return Locus(irredundant(listed))
    found = search_drops([row for chain in part for row in chain.starts], rank, ring, motion)
    lasting, left = closed_systems(found.drops), found.open
    if not motion.rates:
        return Locus(irredundant([*lasting, *systems]), [], found.drops, left, not left)
    passing = [system for system in systems if not is_covered([*system, *named_values(system, ring)], lasting)]
    return Locus(lasting, passing, found.drops, left, whole and not left)


def written_drops(part: tuple[Chain, ...], rank: int, motion: Motion) -> Cases:
    """Where the first vectors of the chains, as many as their dimensions, span less; in reduced equations."""
    try:
        rows = written_rows([(row, chain.dimension) for chain in part for row in chain.starts], motion)
    except TooLargeError:
        return Cases([], [[]])
    found = search_drops(rows, rank, motion.ring, nodes=WRITTEN)
    tidy = [(leaf, reduce_generators(leaf.system, motion.ring)) for leaf in found.drops]
    return replace(found, drops=[replace(leaf, system=system) for leaf, system in tidy if system is not None])


def drops_by_staircases(chains: Chains, part: tuple[Chain, ...], rank: int) -> list[System] | None:
    """The drop locus of some chains by its definition, or None when it is too long to write down.

    At any point take vectors of the first chain while they are independent, then of the second, and so on: what a
    chain adds is closed under the motion modulo the chains before it, so the vectors taken span all. The joint rank is
    therefore n exactly where one staircase (k_1, ..., k_s) has a determinant that is not zero; that is far fewer
    determinants than all maximal minors. Only for chains that observe everything somewhere.
    """
    steps = list(compositions(rank, [chain.dimension for chain in part]))
    if rank < len(chains.matrix) or len(steps) > MOST_STAIRCASES:
        return None
    listed = [[(chain.vectors[0], count) for chain, count in zip(part, step, strict=True)] for step in steps]
    if sum(points_needed(starts, chains.matrix) for starts in listed) > POINTS:
        return None
    minors: list[Poly] = []
    for starts in listed:
        minor = chain_determinant(starts, chains.matrix, chains.ring)
        if minor is None:
            return None
        if chains.ring.is_unit(minor):
            return []
        minors += [minor] if minor != 0 else []
        if sum(map(len, minors)) > LAST_TERMS:
            return None
    return components(minors, chains.ring)


def compositions(total: int, caps: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """All tuples of nonnegative numbers with the given sum, each at most its cap."""
    if not caps and total == 0:
        yield ()
    for first in range(min(total, caps[0]), -1, -1) if caps else ():
        for rest in compositions(total - first, caps[1:]):
            yield (first, *rest)
