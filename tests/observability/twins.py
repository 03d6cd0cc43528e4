"""Slow twins of the algorithms of observability, by their definitions."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from navsym.observability.chains import Chains
from navsym.observability.linear import Matrix, determinant
from navsym.observability.rank_drops import System, components, compositions, find_drops
from navsym.observability.ring import Poly, Ring


def determinant_slowly(matrix: Matrix, ring: Ring) -> Poly:
    """Twin of :func:`determinant`: expansion along the first row."""
    if not matrix:
        return ring.constant(1)
    total = ring.constant(0)
    for j, entry in enumerate(matrix[0]):
        if entry != 0:
            minor = [row[:j] + row[j + 1 :] for row in matrix[1:]]
            total = total + entry * determinant_slowly(minor, ring) * (-1) ** j
    return total


def maximal_minors(vectors: Matrix, ring: Ring) -> list[Poly]:
    """All r x r minors of r vectors of length n, by adding one vector at a time.

    The minors of the first k vectors on every k-subset of places follow from those of k - 1, so
    that nothing is computed twice: sum over k of C(n, k) k products.
    """
    minors: dict[tuple[int, ...], Poly] = {(): ring.constant(1)}
    size = len(vectors[0])
    for count, vector in enumerate(vectors, start=1):
        larger = {}
        for places in combinations(range(size), count):
            total = ring.constant(0)
            for index, place in enumerate(places):
                smaller = minors.get(places[:index] + places[index + 1 :])
                if smaller is not None and vector[place] != 0:
                    total = total + smaller * vector[place] * (-1) ** (count - 1 - index)
            if total != 0:
                larger[places] = total
        minors = larger
    return list(minors.values())


def staircases(chains: Chains) -> list[tuple[int, ...]]:
    """All (k_1, ..., k_s) with the joint dimension as sum and k_i at most the chain's dimension."""
    return list(compositions(chains.joint_dimension, [chain.dimension for chain in chains.chains]))


def drops_by_minors(sets: Sequence[Matrix], ring: Ring) -> list[System]:
    """Slow twin: the common zeros of all maximal minors of all sets of independent rows."""
    minors: list[Poly] = []
    for rows in sets:
        value = [determinant(rows, ring)] if len(rows) == len(rows[0]) else maximal_minors(rows, ring)
        minors += [minor for minor in value if minor != 0]
        if any(minor.is_constant() for minor in minors):
            return []
    return components(minors, ring)


def rank_drops(found):
    """The drops of every subspace."""
    return find_drops(found).drops


def drops_and_completeness(found):
    """The drops, and which lists are whole."""
    answer = find_drops(found)
    return answer.drops, answer.complete
