"""The hypothesis tree in exact numbers: the reference by which every other engine is judged.

Plain Python, one entry at a time, over any kind of number: ``Fraction`` with the exponentials of (18) to
sixty digits (:func:`fractions_kit`), or exact expressions, for claims about single examples. It shares no
line with the floating-point engines, not even the algebra: covariances are corrected by ``P - K S K^T``,
which is right when nothing is rounded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from itertools import groupby
from typing import Any

from navsym.multimodel.schemes import Scheme

Matrix = list[list[Any]]
Vector = list[Any]

#: Digits that :func:`fractions_kit` keeps of exponentials, roots and merged moments.
DIGITS = 60


@dataclass(frozen=True, slots=True)
class Kit:
    """What the tree needs to know about its numbers.

    density : (v^T S^-1 v, det S, p) -> density of (18)
    tidy    : shortens a merged number; the identity where numbers do not grow
    """

    density: Callable[[Any, Any, int], Any]
    tidy: Callable[[Any], Any]


def fractions_kit() -> Kit:
    """Fractions; densities and merged moments rounded to sixty digits."""
    context = Context(prec=DIGITS, Emin=-(10**9), Emax=10**9)
    two_pi = Decimal("6.283185307179586476925286766559005768394338798750211641949889184615632812572")

    def density(distance: Fraction, determinant: Fraction, p: int) -> Fraction:
        exponent = context.exp(as_decimal(-distance / 2, context))
        root = context.sqrt(context.multiply(as_decimal(determinant, context), context.power(two_pi, p)))
        return Fraction(context.divide(exponent, root))

    def tidy(value: Fraction) -> Fraction:
        return Fraction(as_decimal(value, context))

    return Kit(density, tidy)


def as_decimal(value: Fraction, context: Context) -> Decimal:
    """A fraction to the digits of the context."""
    return context.divide(Decimal(value.numerator), Decimal(value.denominator))


@dataclass(frozen=True, slots=True)
class Model:
    """One mode in one step: F, Q (n, n), H (p, n), R (p, p) as nested lists of exact numbers."""

    F: Matrix
    Q: Matrix
    H: Matrix
    R: Matrix


@dataclass(frozen=True, slots=True)
class Leaf:
    """One hypothesis: unnormalised weight for every last mode, mean (n,), covariance (n, n)."""

    weights: tuple[Any, ...]
    mean: Vector
    covariance: Matrix


@dataclass(frozen=True, slots=True)
class ExactStep:
    """Mode probabilities, mean, covariance, and the likelihood of the measurement given those before."""

    probabilities: Vector
    mean: Vector
    covariance: Matrix
    likelihood: Any
    leaves: tuple[Leaf, ...]


def run_exactly(
    rule: Scheme,
    models: Sequence[Sequence[Model]],
    transitions: Sequence[Matrix],
    roots: Sequence[Leaf],
    measurements: Sequence[Sequence[Any]],
    kit: Kit,
) -> list[ExactStep]:
    """Run a scheme over exact numbers.

    models[k][i], transitions[k][i][j] (rows = from) : of step k + 1
    roots : hypotheses at step 0, weights summing to one in all
    measurements[k] : numbers of step k + 1, None where one is missing
    """
    leaves = list(roots)
    found = []
    for k, z in enumerate(measurements, start=1):
        branches = branch_leaves(rule, leaves, transitions[k - 1], kit)
        grown = [filter_leaf(leaf, models[k - 1][i], i, z, kit) for i, leaf in branches]
        step = weigh_leaves(grown, len(models[k - 1]), kit)
        found.append(step)
        leaves = fold_leaves(rule, k, step, kit)
    return found


def branch_leaves(rule: Scheme, leaves: list[Leaf], transition: Matrix, kit: Kit) -> list[tuple[int, Leaf]]:
    """(next mode, hypothesis with its prior weight as the only entry), before prediction."""
    modes = range(len(transition))
    if rule.branching == "own":
        return [(i, Leaf((leaf.weights[i],), leaf.mean, leaf.covariance)) for i, leaf in enumerate(leaves)]
    ahead = [
        (i, Leaf((sum(leaf.weights[j] * transition[j][i] for j in modes),), leaf.mean, leaf.covariance))
        for leaf in leaves
        for i in modes
    ]
    if rule.branching == "cross":
        return ahead
    groups = [[leaf for i, leaf in ahead if i == mode] for mode in modes]
    return [(i, Leaf((total(group),), *merge_leaves(group, kit))) for i, group in enumerate(groups)]


def total(leaves: Sequence[Leaf]) -> Any:
    """Sum of all weights."""
    return sum(sum(leaf.weights) for leaf in leaves)


def merge_leaves(leaves: Sequence[Leaf], kit: Kit) -> tuple[Vector, Matrix]:
    """Mean and covariance of a group: multistructure:12* and :13, entry by entry."""
    whole = total(leaves)
    shares = [sum(leaf.weights) / whole for leaf in leaves]
    n = range(len(leaves[0].mean))
    mean = [kit.tidy(sum(g * leaf.mean[a] for g, leaf in zip(shares, leaves, strict=True))) for a in n]

    def entry(a: int, b: int) -> Any:
        return sum(
            g * (leaf.covariance[a][b] + (leaf.mean[a] - mean[a]) * (leaf.mean[b] - mean[b]))
            for g, leaf in zip(shares, leaves, strict=True)
        )

    return mean, [[kit.tidy(entry(a, b)) for b in n] for a in n]


def filter_leaf(leaf: Leaf, model: Model, mode: int, z: Sequence[Any], kit: Kit) -> tuple[int, Leaf]:
    """Kalman filter of one hypothesis; its weight is multiplied by the density of the innovation."""
    mean = product_with(model.F, leaf.mean)
    P = add(product(product(model.F, leaf.covariance), transposed(model.F)), model.Q)
    came = [j for j, value in enumerate(z) if value is not None]
    if not came:
        return mode, Leaf(leaf.weights, mean, P)
    H = [model.H[j] for j in came]
    R = [[model.R[i][j] for j in came] for i in came]
    innovation = [z[j] - expected for j, expected in zip(came, product_with(H, mean), strict=True)]
    PHt = product(P, transposed(H))
    S = add(product(H, PHt), R)
    solved, determinant = solve(S, [[v, *row] for v, row in zip(innovation, transposed(PHt), strict=True)])
    distance = sum(v * row[0] for v, row in zip(innovation, solved, strict=True))
    shift = product_with(PHt, [row[0] for row in solved])
    shrink = product(PHt, [row[1:] for row in solved])
    corrected = [[x - y for x, y in zip(*rows, strict=True)] for rows in zip(P, shrink, strict=True)]
    weight = leaf.weights[0] * kit.density(distance, determinant, len(came))
    return mode, Leaf((weight,), [m + d for m, d in zip(mean, shift, strict=True)], corrected)


def weigh_leaves(grown: Sequence[tuple[int, Leaf]], modes: int, kit: Kit) -> ExactStep:
    """Normalise the weights of all branches and take the moments."""
    likelihood = total([leaf for _, leaf in grown])
    leaves = tuple(
        Leaf(tuple(leaf.weights[0] / likelihood if i == mode else 0 for i in range(modes)), leaf.mean, leaf.covariance)
        for mode, leaf in grown
    )
    mean, covariance = merge_leaves(leaves, kit)
    return ExactStep(mode_weights(leaves, modes), mean, covariance, likelihood, leaves)


def mode_weights(leaves: Sequence[Leaf], modes: int) -> Vector:
    """Total weight of every last mode."""
    return [sum(leaf.weights[i] for leaf in leaves) for i in range(modes)]


def fold_leaves(rule: Scheme, k: int, step: ExactStep, kit: Kit) -> list[Leaf]:
    """Replace groups of leaves by one each, as the scheme says."""
    if rule.folding == "none" or k % rule.period:
        return list(step.leaves)
    if rule.folding == "all":
        return [Leaf(tuple(step.probabilities), step.mean, step.covariance)]

    def last_mode(leaf: Leaf) -> int:
        return next(i for i, weight in enumerate(leaf.weights) if weight != 0)

    ordered = sorted(step.leaves, key=last_mode)
    groups = [list(group) for _, group in groupby(ordered, key=last_mode)]
    modes = range(len(step.probabilities))
    return [Leaf(tuple(mode_weights(group, len(modes))), *merge_leaves(group, kit)) for group in groups]


def product_with(A: Matrix, x: Vector) -> Vector:
    """A x for A (m, n) and x (n,)."""
    return [sum(a * b for a, b in zip(row, x, strict=True)) for row in A]


def product(A: Matrix, B: Matrix) -> Matrix:
    """A B for A (m, n) and B (n, p)."""
    return [product_with(transposed(B), row) for row in A]


def add(A: Matrix, B: Matrix) -> Matrix:
    """A + B, entry by entry."""
    return [[a + b for a, b in zip(*rows, strict=True)] for rows in zip(A, B, strict=True)]


def transposed(A: Matrix) -> Matrix:
    """The transpose of A."""
    return [list(column) for column in zip(*A, strict=True)]


def solve(S: Matrix, B: Matrix) -> tuple[Matrix, Any]:
    """``S^-1 B`` and det S by elimination; the pivots of a positive definite S are never zero."""
    rows = [[*s, *b] for s, b in zip(S, B, strict=True)]
    determinant: Any = 1
    for i, row in enumerate(rows):
        pivot = row[i]
        determinant = determinant * pivot
        rows[i] = [value / pivot for value in row]
        for j, other in enumerate(rows):
            if j != i:
                factor = other[i]
                rows[j] = [x - factor * y for x, y in zip(other, rows[i], strict=True)]
    return [row[len(S) :] for row in rows], determinant
