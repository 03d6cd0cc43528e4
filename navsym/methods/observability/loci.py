"""All parameter values at which an observable subspace shrinks.

A chain of generic dimension m spans at every parameter point what its first m vectors span there, so that the
drops are the points where these vectors, of one measurement or of all together, have a smaller rank. What is
regular everywhere is taken out first (``observability_reduction``); the rest is decided by cases on pivots
(``observability_cases``), factored, split into components, over the real numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import sympy as sp

from navsym.errors import TooLargeError
from navsym.methods.observability.cases import LAST_PRODUCTS, LAST_TERMS, drops_by_cases, minor_on
from navsym.methods.observability.chains import Chains, Observability
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
    starts = [(chain.vectors[0], chain.dimension) for chain in chains.chains]
    answer = {}
    for name, part, rank in [
        *((chain.name, [start], chain.dimension) for chain, start in zip(chains.chains, starts, strict=True)),
        ("joint", starts, chains.joint_dimension),
    ]:
        rest = krylov_remainder(part, chains.matrix, chains.ring)
        answer[name] = drops_of(rest.rows, rank - rest.regular, chains.ring)
    listed = None if answer["joint"][1] else drops_by_staircases(chains)
    return answer if listed is None else {**answer, "joint": (irredundant(listed), True)}


def drops_by_staircases(chains: Chains) -> list[System] | None:
    """The joint drop locus by its definition, or None when it is too long to write down.

    At any point take vectors of the first chain while they are independent, then of the second, and so on: what a
    chain adds is closed under the motion modulo the chains before it, so the vectors taken span all. The joint rank is
    therefore n exactly where one staircase (k_1, ..., k_s) has a determinant that is not zero; that is far fewer
    determinants than all maximal minors. Only for systems that are observable somewhere.
    """
    ring, steps = chains.ring, staircases(chains)
    if chains.joint_dimension < len(chains.matrix) or len(steps) > MOST_STAIRCASES:
        return None
    minors: list[Poly] = []
    for step in steps:
        rows = chains.staircase_vectors(step)
        try:
            minor, full, _ = minor_on(rows, len(rows), [], list(range(len(rows))), ring, LAST_PRODUCTS)
        except TooLargeError:
            return None
        minors += [minor] if full else []
        if minors and minors[-1].is_constant():
            return []
        if sum(map(len, minors)) > LAST_TERMS:
            return None
    return components(minors, ring)


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


def drops_of(rows: Matrix, rank: int, ring: Ring) -> tuple[list[System], bool]:
    """Components of the locus where rows with a generic rank have a smaller one, and whether these are all."""
    found, complete = drops_by_cases(rows, rank, ring)
    return irredundant(found), complete


def drops_by_minors(sets: Sequence[Matrix], ring: Ring) -> list[System]:
    """Slow twin: the common zeros of all maximal minors of all sets of independent rows."""
    minors: list[Poly] = []
    for rows in sets:
        value = [determinant(rows, ring)] if len(rows) == len(rows[0]) else maximal_minors(rows, ring)
        minors += [minor for minor in value if minor != 0]
        if any(minor.is_constant() for minor in minors):
            return []
    return components(minors, ring)
