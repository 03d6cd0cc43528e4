"""All parameter values at which an observable subspace shrinks.

A chain of generic dimension m spans at every parameter point what its first m vectors span there, so that the
drops are the points where these vectors, of one measurement or of all together, have a smaller rank. What is
regular everywhere is taken out first (``observability_reduction``); the rest is decided by cases on pivots
(``observability_cases``), factored, split into components, over the real numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import sympy as sp

from navsym.errors import TooLargeError
from navsym.methods.observability.cases import LAST_PRODUCTS, LAST_TERMS, drops_by_all_minors, drops_by_cases, minor_on
from navsym.methods.observability.chains import Chain, Chains, Observability
from navsym.methods.observability.interpolation import POINTS, chain_determinant, points_needed
from navsym.methods.observability.linear import Matrix, determinant, maximal_minors
from navsym.methods.observability.reduction import krylov_remainder
from navsym.methods.observability.ring import Poly, Ring, odd
from navsym.methods.observability.zeros import System, components, irredundant

#: So many staircases at most, when the joint locus is written down by its definition.
MOST_STAIRCASES = 40


@dataclass(frozen=True, slots=True, eq=False)
class RankDrop:
    """The rank of a subspace is smaller where all the polynomials vanish together.

    subspace : name of a measurement, or "joint"
    zeros    : polynomials, irreducible over the rationals where that could be reached
    complete : True when the drops listed for this subspace are proved to be all real ones
    """

    subspace: str
    zeros: tuple[sp.Expr, ...]
    complete: bool

    @property
    def condition(self) -> str:
        """The drop as text: ``zero = 0`` for every polynomial, joined by ``and``."""
        return " and ".join(f"{zero} = 0" for zero in self.zeros)

    @property
    def allowed(self) -> bool | None:
        """False when what the symbols are declared to be (positive, nonzero) excludes it, else None."""
        return False if any(excluded(zero) for zero in self.zeros) else None


def excluded(zero: sp.Expr) -> bool:
    """A symbol that is declared nonzero, or a sum of products of positive symbols."""
    if zero.is_Symbol:
        return bool(zero.is_positive or zero.is_nonzero)
    return bool(all(term.is_positive for term in sp.Add.make_args(zero)))


def rank_drops(found: Observability) -> tuple[RankDrop, ...]:
    """Drops of every measurement's subspace and of the joint one, with completeness."""
    return drops_and_completeness(found)[0]


def drops_and_completeness(found: Observability) -> tuple[tuple[RankDrop, ...], dict[str, bool]]:
    """The drops, and for every subspace whether its list is proved complete, also when it is empty."""
    ring, answer = found.chains.ring, all_drops(found.chains)
    drops = tuple(
        RankDrop(name, tuple(ring.condition(f) for f in system), complete)
        for name, (systems, complete) in answer.items()
        for system in whole_angles(systems, ring)
    )
    return drops, {name: complete for name, (_, complete) in answer.items()}


def whole_angles(systems: list[System], ring: Ring) -> list[System]:
    """Two equations in half an angle that make one in the whole angle stand as that one.

    sin(x/2) = 0 or cos(x/2) = 0 is sin(x) = 0; f = 0 or its mirror image (cos(x/2) with the other sign) = 0 is
    one equation as well.
    """
    listed = list(systems)
    for sine, cosine in ring.pairs():
        S, C = ring.context.gen(sine), ring.context.gen(cosine)
        singles = [f for (f,) in (system for system in listed if len(system) == 1) if odd(f, cosine)]
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


def all_drops(chains: Chains) -> dict[str, tuple[list[System], bool]]:
    """Drops of every chain and of all of them together, each from what is not regular everywhere."""
    answer = {chain.name: drops_of_group(chains, (chain,), chain.dimension) for chain in chains.chains}
    if len(chains.chains) == 1:
        return {**answer, "joint": answer[chains.chains[0].name]}
    return {**answer, "joint": drops_of_group(chains, chains.chains, chains.joint_dimension)}


def drops_of_group(chains: Chains, part: tuple[Chain, ...], rank: int) -> tuple[list[System], bool]:
    """Drops of what some chains span together: by cases, or else by the definition, written in one of three ways."""
    ring = chains.ring
    rest = krylov_remainder([(chain.vectors[0], chain.dimension) for chain in part], chains.matrix, ring)
    found, complete = drops_by_cases(rest.rows, rank - rest.regular, ring)
    if not complete:
        for written in (
            lambda: drops_by_staircases(chains, part, rank, by_values),
            lambda: drops_by_all_minors(rest.rows, rank - rest.regular, ring),
            lambda: drops_by_staircases(chains, part, rank, by_elimination),
        ):
            listed = written()
            if listed is not None:
                return irredundant(listed), True
    return irredundant(found), complete


#: The determinant of the first vectors of some chains, so many of each; None when it is too long to form.
Determinant = Callable[[Chains, tuple[Chain, ...], tuple[int, ...]], Poly | None]


def by_values(chains: Chains, part: tuple[Chain, ...], step: tuple[int, ...]) -> Poly | None:
    """By interpolation from values at integer points."""
    starts = [(chain.vectors[0], count) for chain, count in zip(part, step, strict=True)]
    return chain_determinant(starts, chains.matrix, chains.ring)


def by_elimination(chains: Chains, part: tuple[Chain, ...], step: tuple[int, ...]) -> Poly | None:
    """By fraction-free elimination."""
    rows = [v for chain, count in zip(part, step, strict=True) for v in chains.first(chain, count)]
    zero = chains.ring.constant(0)
    try:
        minor, full, _ = minor_on(rows, len(rows), [], list(range(len(rows))), chains.ring, LAST_PRODUCTS)
    except TooLargeError:
        return None
    return minor if full else zero


def drops_by_staircases(
    chains: Chains, part: tuple[Chain, ...], rank: int, determinant_of: Determinant
) -> list[System] | None:
    """The drop locus of some chains by its definition, or None when it is too long to write down.

    At any point take vectors of the first chain while they are independent, then of the second, and so on: what a
    chain adds is closed under the motion modulo the chains before it, so the vectors taken span all. The joint rank is
    therefore n exactly where one staircase (k_1, ..., k_s) has a determinant that is not zero; that is far fewer
    determinants than all maximal minors. Only for chains that observe everything somewhere.
    """
    steps = list(compositions(rank, [chain.dimension for chain in part]))
    if rank < len(chains.matrix) or len(steps) > MOST_STAIRCASES:
        return None
    if determinant_of is by_values and too_many_points(chains, part, steps):
        return None
    minors: list[Poly] = []
    for step in steps:
        minor = determinant_of(chains, part, step)
        if minor is None:
            return None
        if minor != 0 and minor.is_constant():
            return []
        minors += [minor] if minor != 0 else []
        if sum(map(len, minors)) > LAST_TERMS:
            return None
    return components(minors, chains.ring)


def too_many_points(chains: Chains, part: tuple[Chain, ...], steps: Sequence[tuple[int, ...]]) -> bool:
    """Whether the determinants of all staircases take more values than one of them may."""
    starts = [chain.vectors[0] for chain in part]
    return sum(points_needed(list(zip(starts, step, strict=True)), chains.matrix) for step in steps) > POINTS


def staircases(chains: Chains) -> list[tuple[int, ...]]:
    """All (k_1, ..., k_s) with the joint dimension as sum and k_i at most the chain's dimension."""
    return list(compositions(chains.joint_dimension, [chain.dimension for chain in chains.chains]))


def compositions(total: int, caps: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """All tuples of nonnegative numbers with the given sum, each at most its cap."""
    if not caps:
        if total == 0:
            yield ()
        return
    for first in range(min(total, caps[0]), -1, -1):
        for rest in compositions(total - first, caps[1:]):
            yield (first, *rest)


def drops_by_minors(sets: Sequence[Matrix], ring: Ring) -> list[System]:
    """Slow twin: the common zeros of all maximal minors of all sets of independent rows."""
    minors: list[Poly] = []
    for rows in sets:
        value = [determinant(rows, ring)] if len(rows) == len(rows[0]) else maximal_minors(rows, ring)
        minors += [minor for minor in value if minor != 0]
        if any(minor.is_constant() for minor in minors):
            return []
    return components(minors, ring)
