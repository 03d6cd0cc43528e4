"""Directions of the state that no measurement ever shows, exhibited and checked: the proof that a rank is not larger.

Columns N with h N = 0 for every measurement and F N - N' in their own span stay unseen by every derivative: the
derivative of h N = 0 is (D h) N = h (F N - N') taken once more. Both are polynomial identities. Where they come from
does not matter: elimination of the rows, the generic leaf of the tree, or a guess of low degree in the symbols (a
symmetry such as a turn about gravity, a change of scale, a common shift) that is fitted at points modulo a prime and
rebuilt in whole numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations_with_replacement
from math import lcm

from flint import nmod_mat

from navsym.observability.linear import (
    PRIME,
    Matrix,
    at_point,
    independent_places,
    linear_relation,
    null_vectors,
    primitive_vector,
    residue_rank,
    scalar_product,
)
from navsym.observability.motion import Motion, residue_chains
from navsym.observability.reduction import UnitBasis
from navsym.observability.ring import Poly, Ring
from navsym.observability.tree import leaf_on

#: Terms of the rows that are eliminated for a moving model, unknowns of a guess, and the size of a rebuilt fraction.
ROW_TERMS, UNKNOWNS, SIZE = 1500, 700, 10**6


def find_unobservable(rows: Matrix, motion: Motion, rank: int, point: Sequence[int]) -> Matrix | None:
    """n - rank independent directions that no measurement ever shows; None when none were found.

    rows : one row h per measurement;  point : where the rank is attained, modulo the prime
    """
    if not motion.rates and not motion.roots:
        resting = resting_directions(rows, motion, rank, point)
        return exhibit_unobservable(rows, motion, rank, point) if resting is None else resting
    return (
        guess_unobservable(rows, motion, rank, (0, 1))
        or (exhibit_unobservable(rows, motion, rank, point) if not motion.roots else None)
        or guess_unobservable(rows, motion, rank, (2, 3))
        or (unseen_generically(rows, motion, rank) if not motion.roots else None)
    )


def unseen_generically(rows: Matrix, motion: Motion, rank: int) -> Matrix | None:
    """The columns of the generic leaf; None where its rows get long."""
    leaf = leaf_on([], rows, motion.ring, motion)
    return leaf.unseen if leaf is not None and leaf.rank == rank else None


def resting_directions(rows: Matrix, motion: Motion, rank: int, point: Sequence[int]) -> Matrix | None:
    """Directions with h N = 0 and F N = 0 of a constant model, where these are all: short rows, so that it is quick."""
    listed = [*rows, *motion.matrix]
    chosen = independent_places(at_point(listed, point))
    if len(chosen) != rank:
        return None
    short = simplified_rows([listed[k] for k in chosen], motion.ring)
    found = null_vectors(short, motion.size, motion.ring)
    if sum(len(x) for vector in found for x in vector) > ROW_TERMS:
        found = null_vectors(short, motion.size, motion.ring, light_columns(short, point))
    zero = motion.ring.constant(0)
    seen = any(motion.reduced(scalar_product(row, vector, zero)) != 0 for row in listed for vector in found)
    return None if seen else found


def light_columns(rows: Matrix, point: Sequence[int]) -> list[int]:
    """Places of independent columns, those with few terms first: pivots in them give short null vectors."""
    columns = sorted(enumerate(zip(*rows, strict=True)), key=lambda item: sum(map(len, item[1])))
    return [columns[k][0] for k in independent_places(at_point([[*column] for _, column in columns], point))]


def simplified_rows(rows: Matrix, ring: Ring) -> Matrix:
    """Rows with the same span over the field, without common factors; those with a number clear its column."""
    basis, rest, waiting = UnitBasis(ring), list[list[Poly]](), list(rows)
    while waiting:
        rest, taken = [], False
        for row in waiting:
            row = basis.reduced(primitive_vector(row, ring))
            row = primitive_vector(row, ring)
            if basis.take(row):
                taken = True
            else:
                rest.append(row)
        waiting = rest if taken else []
    return [*basis.rows, *rest]


def exhibit_unobservable(rows: Matrix, motion: Motion, rank: int, point: Sequence[int]) -> Matrix | None:
    """The directions by elimination of observed rows, or None when the rank was too small or the rows too long.

    The basis takes the chains step by step, all measurements in turn, which keeps the degrees low.
    """
    step = list(rows)
    basis: Matrix = []
    residues: list[list[int]] = []
    while len(basis) < rank:
        for vector in step:
            trial = [*residues, *at_point([vector], point)]
            if residue_rank(trial) > len(residues):
                basis.append(vector)
                residues = trial
        if motion.rates and sum(len(entry) for vector in step for entry in vector) > ROW_TERMS:
            return None
        step = [motion.advance(vector) for vector in step]
    directions = null_vectors(basis, motion.size, motion.ring)
    zero = motion.ring.constant(0)
    for vector in directions:
        moved = motion.retreat(vector)
        seen = [scalar_product(row, vector, zero) for row in rows] + [scalar_product(row, moved, zero) for row in basis]
        if any(value != 0 for value in seen):
            return None
    return directions


# Guesses of low degree


def guess_unobservable(rows: Matrix, motion: Motion, rank: int, degrees: Sequence[int]) -> Matrix | None:
    """The directions as polynomial columns of the first degree that has enough of them, checked exactly."""
    missing = motion.size - rank
    for degree in degrees:
        terms = guess_terms(motion, degree)
        if len(terms) * motion.size > UNKNOWNS:
            return None
        columns = fit_columns(rows, motion, terms, rank)
        chosen = independent_columns(columns, motion, missing)
        if len(chosen) == missing and is_closed(rows, motion, chosen):
            return [primitive_vector(column, motion.ring) for column in chosen]
    return None


def guess_terms(motion: Motion, degree: int) -> list[Poly]:
    """Monomials up to a degree in the symbols and in sines and cosines of whole angles, as forms of one degree."""
    ring, halves = motion.ring, {place for pair in motion.ring.pairs() for place in pair}
    plain = [ring.context.gen(k) for k in range(len(ring.symbols)) if k not in halves]
    plain = [g for g in plain if not any(g == ring.context.gen(place) for place in motion.roots)] + [
        ring.context.gen(place) for place in motion.roots
    ]
    whole = ring.constant(1)
    turned: list[Poly] = []
    for sine, cosine in ring.pairs():
        S, C = ring.context.gen(sine), ring.context.gen(cosine)
        turned = [f * (S * S + C * C) for f in turned] + [whole * 2 * S * C, whole * (C * C - S * S)]
        whole = whole * (S * S + C * C)
    found: list[Poly] = []
    for count in range(degree + 1):
        for factors in combinations_with_replacement(range(len(plain) + len(turned)), count):
            angles = [k for k in factors if k >= len(plain)]
            if len(angles) > 1:
                continue
            value = turned[angles[0] - len(plain)] if angles else whole
            for k in (k for k in factors if k < len(plain)):
                value = value * plain[k]
            if motion.reduced(value) == value:
                found.append(value)
    return found


def fit_columns(rows: Matrix, motion: Motion, terms: Sequence[Poly], rank: int) -> Iterator[list[Poly]]:
    """Combinations of the terms, entry by entry, that the rows do not see at enough points modulo the prime."""
    n, width = motion.size, len(terms) * motion.size
    equations: list[list[int]] = []
    for point in motion.points(width // max(rank, 1) + 3):
        chains = nmod_mat(residue_chains(rows, motion, point), PRIME)
        reduced, found = chains.rref()
        values = [row[0] for row in at_point([[term] for term in terms], point)]
        for k in range(found):
            seen = [int(reduced[k, i]) for i in range(n)]
            equations.append([a * v % PRIME if a else 0 for a in seen for v in values])
    kernel, count = nmod_mat(equations, PRIME).nullspace() if equations else (None, 0)
    if kernel is None:
        return
    table, _ = nmod_mat(
        [[int(kernel[i, k]) for i in range(width)] for k in range(count)] or [[0] * width], PRIME
    ).rref()
    for k in range(count):
        rebuilt = rebuild_integers([int(table[k, i]) for i in range(width)])
        if rebuilt is not None:
            size = len(terms)
            zero = motion.ring.constant(0)
            yield [
                sum((terms[j] * rebuilt[i * size + j] for j in range(size) if rebuilt[i * size + j]), zero)
                for i in range(n)
            ]


def rebuild_integers(values: Sequence[int]) -> list[int] | None:
    """Whole numbers in the proportion of small fractions that the residues stand for; None where one is not small."""
    fractions = [rebuild_fraction(value) for value in values]
    known = [f for f in fractions if f is not None]
    if len(known) < len(fractions):
        return None
    bottom = lcm(*(b for _, b in known))
    return [a * (bottom // b) for a, b in known]


def rebuild_fraction(value: int) -> tuple[int, int] | None:
    """a/b with small a and b > 0 and a = b value modulo the prime, by Euclid's algorithm."""
    last, rest, s, t = PRIME, value % PRIME, 0, 1
    while rest > SIZE:
        q = last // rest
        last, rest, s, t = rest, last - q * rest, t, s - q * t
    if t == 0 or abs(t) > SIZE:
        return None
    return (rest, t) if t > 0 else (-rest, -t)


def independent_columns(columns: Iterator[list[Poly]], motion: Motion, missing: int) -> Matrix:
    """The shortest columns that are independent at a point, as many as are missing."""
    point = motion.points(1)[0]
    chosen: Matrix = []
    for column in sorted(columns, key=lambda entries: sum(map(len, entries))):
        if residue_rank(at_point([*chosen, column], point)) > len(chosen):
            chosen.append(column)
        if len(chosen) == missing:
            break
    return chosen


def is_closed(rows: Matrix, motion: Motion, columns: Matrix) -> bool:
    """h N = 0 and F N - N' in the span of the columns, as identities of polynomials."""
    zero = motion.ring.constant(0)
    if any(motion.reduced(scalar_product(row, column, zero)) != 0 for row in rows for column in columns):
        return False
    return all(is_combination(columns, motion.retreat(column), motion) for column in columns)


def is_combination(columns: Matrix, target: list[Poly], motion: Motion) -> bool:
    """True when a column is a combination of independent ones over the field of the symbols."""
    if all(entry == 0 for entry in target):
        return True
    if not motion.roots:
        return linear_relation(columns, target, motion.ring) is not None
    return all(motion.reduced(minor) == 0 for minor in bordered_minors([*columns, target], motion))


def bordered_minors(vectors: Matrix, motion: Motion) -> Iterator[Poly]:
    """Determinants of the last vector beside the others, on columns where these are independent at a point."""
    first = vectors[:-1]
    residues = at_point(first, motion.points(1)[0])
    _, rank = nmod_mat(residues, PRIME).rref()
    if rank < len(first):
        yield motion.ring.constant(1)
        return
    chosen: list[int] = []
    for column in range(len(vectors[0])):
        if residue_rank([[row[k] for k in (*chosen, column)] for row in residues]) > len(chosen):
            chosen.append(column)
    for column in range(len(vectors[0])):
        if column not in chosen:
            yield expand_determinant([[row[k] for k in (*chosen, column)] for row in vectors], motion)


def expand_determinant(matrix: Matrix, motion: Motion) -> Poly:
    """Determinant by the first row, roots reduced on the way: no division."""
    if len(matrix) == 1:
        return matrix[0][0]
    total = motion.ring.constant(0)
    for column, entry in enumerate(matrix[0]):
        if entry != 0:
            minor = expand_determinant([[*row[:column], *row[column + 1 :]] for row in matrix[1:]], motion)
            total = motion.reduced(total + entry * minor * (-1) ** column)
    return total
