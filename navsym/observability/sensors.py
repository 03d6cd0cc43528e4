"""Which further measurements make a model observable, with the fewest of them, proved.

A direction x with G x = 0 and H x = 0 is a constant that no measurement ever shows. One more scalar measurement
lowers the dimension of these directions by at most one, so that at least so many are needed, whatever they
measure. That a set is enough is proved by one integer point at which the rank is full.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb

import sympy as sp
from flint import nmod_mat

from navsym.core.errors import DomainError, EmptyError, ShapeError, TooLargeError
from navsym.models.linear import LinearModel, exact_matrix
from navsym.observability.chains import need_chains, prove_rank
from navsym.observability.directions import exhibit_unobservable
from navsym.observability.linear import (
    PRIME,
    Matrix,
    at_point,
    independent_places,
    null_vectors,
    residue_rank,
    residues_on,
    scalar_product,
)
from navsym.observability.motion import Motion, motion_of, residue_chains
from navsym.observability.ring import Poly, Ring

#: Sets of candidates that are looked at, and sets for which a proof that they fail is written out, at most.
SETS, DISPROVED = 200_000, 500


@dataclass(frozen=True, slots=True, eq=False)
class Restoration:
    """The fewest further measurements that show every state.

    unobservable : dimension that the model's own measurements never show, generically
    needed : how many further scalar measurements are needed, whatever they measure (a proved lower bound)
    sets   : all sets of candidates of the least size found that are enough; none when all together are not
    proved : whether no smaller set of candidates is enough
    """

    unobservable: int
    needed: int
    sets: tuple[tuple[str, ...], ...]
    proved: bool

    @property
    def fewest(self) -> int | None:
        """The size of the smallest sets, None when there is none."""
        return len(self.sets[0]) if self.sets else None


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """The model and the candidates without denominators, and what is left to see at an integer point.

    unobservable : dimension that the model's own measurements do not show at the point
    chains : name -> independent vectors (k, unobservable) that a candidate shows of it, modulo the prime
    """

    ring: Ring
    motion: Motion
    own: Matrix
    rows: dict[str, list[Poly]]
    point: tuple[int, ...]
    unobservable: int
    chains: dict[str, list[list[int]]]

    @property
    def size(self) -> int:
        """n, the number of states."""
        return self.motion.size

    def seen_by(self, names: Sequence[str]) -> int:
        """Dimension of the unobservable part that a set of candidates shows, at the point."""
        return residue_rank([vector for name in names for vector in self.chains[name]])


def restore_observability(model: LinearModel, candidates: Mapping[str, Sequence[sp.Expr]] | None = None) -> Restoration:
    """The smallest sets of candidates that make a constant model observable for all but special parameters.

    candidates : name -> row of n exact entries; by default every state itself
    Raises EmptyError without candidates, ShapeError for rows of another length, TooLargeError for too many sets,
    and DomainError, EmptyError or TooLargeError for a model that has no chains.
    """
    need_chains(model)
    if not model.constant:
        raise DomainError("expected constant F and H to restore; got entries that move; leave candidates out")
    setting = lay_out(model, candidate_rows(model, candidates))
    missing, needed = model.size - prove_rank(model).rank, unseen_constants(setting)
    if not missing:
        return Restoration(0, 0, ((),), True)
    for size in range(max(needed, 1), len(setting.rows) + 1):
        if found := tuple(enough_sets(setting, size)):
            proved = size == max(needed, 1) or all_sets_fail(setting, size - 1)
            return Restoration(missing, needed, found, proved)
    return Restoration(missing, needed, (), all_sets_fail(setting, len(setting.rows)))


def candidate_rows(model: LinearModel, candidates: Mapping[str, Sequence[sp.Expr]] | None) -> dict[str, sp.Matrix]:
    """Candidates as exact rows; the states themselves when none are given."""
    if candidates is None:
        return {name: sp.eye(model.size)[i, :] for i, name in enumerate(model.states)}
    if not candidates:
        raise EmptyError("candidates: expected at least one measurement; got none; name what could be measured")
    for name, row in candidates.items():
        if len(row) != model.size:
            raise ShapeError(f"{name}: expected {model.size} entries, one per state; got {len(row)}; complete the row")
    return {name: exact_matrix(name, [list(row)]) for name, row in candidates.items()}


def lay_out(model: LinearModel, rows: Mapping[str, sp.Matrix]) -> Setting:
    """Everything over one ring, and the chains at the point where the model's own measurements see most."""
    motion, listed = motion_of(model, list(rows.values()))
    every = [row for row, _ in listed]
    own, free = every[: model.H.rows], dict(zip(rows, every[model.H.rows :], strict=True))
    seen = {point: residue_chains(own, motion, point) for point in motion.points()}
    point = max(seen, key=lambda key: residue_rank(seen[key]))
    kernel, missing = nmod_mat(seen[point], PRIME).nullspace()
    chains = {name: residues_on(residue_chains([row], motion, point), kernel, missing) for name, row in free.items()}
    return Setting(motion.ring, motion, own, free, point, missing, chains)


def unseen_constants(setting: Setting) -> int:
    """n - rank [G; H], exhibited as independent constants: each needs a further measurement of its own."""
    rows = [*setting.motion.matrix, *setting.own]
    kept = [rows[k] for k in independent_places(at_point(rows, setting.point))]
    candidates = null_vectors(kept, setting.size, setting.ring)
    zero = setting.ring.constant(0)
    return sum(all(scalar_product(row, vector, zero) == 0 for row in rows) for vector in candidates)


def enough_sets(setting: Setting, size: int) -> Iterator[tuple[str, ...]]:
    """The sets of a size at which the rank is full at the point: a minor that is not zero there is not zero."""
    count = comb(len(setting.rows), size)
    if count > SETS:
        raise TooLargeError(f"candidates: expected at most {SETS} sets of {size}; got {count}; name fewer candidates")
    for names in combinations(setting.rows, size):
        if setting.seen_by(names) == setting.unobservable:
            yield names


def all_sets_fail(setting: Setting, size: int) -> bool:
    """True when every set of a size is proved to leave a direction unobservable, with as many as its rank lacks."""
    if comb(len(setting.rows), size) > DISPROVED:
        return False
    return all(is_insufficient(setting, names) for names in combinations(setting.rows, size))


def is_insufficient(setting: Setting, names: Sequence[str]) -> bool:
    """True when unobservable directions of a set are exhibited."""
    rows = [*setting.own, *(setting.rows[name] for name in names)]
    rank = setting.size - setting.unobservable + setting.seen_by(names)
    return rank < setting.size and bool(exhibit_unobservable(rows, setting.motion, rank, setting.point))
