"""The hypothesis tree in exact numbers: the reference by which every other engine is judged.

Plain Python, one entry at a time, over any kind of number: ``Fraction`` with the exponentials of (18) to
sixty digits, or exact expressions, for claims about single examples. It shares no
line with the floating-point engines, not even the algebra: covariances are corrected by ``P - K S K^T``,
which is right when nothing is rounded.

Where S is singular the density is the one on the range of S: r independent rows correct, the other rows must follow
from them, and ``(2 pi)^(-r/2) pdet(S)^(-1/2) exp(-v^T S^+ v / 2)`` is the density, pdet being the product of the
eigenvalues that are not zero. With ``S + e I`` and e -> 0 the density grows like ``e^(-(p-r)/2)``: a mode whose
S has the smaller rank, and that still fits, outweighs the others whatever theirs are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from navsym.multimodel.schemes import Scheme

Matrix = list[list[Any]]
Vector = list[Any]

NEGLIGIBLE = 2.0**-200
#: Numbers of a file are doubles, often rounded from decimals: sums of them agree to some last places.
AGREEMENT = 2.0**-46


@dataclass(frozen=True, slots=True)
class Kit:
    """What the tree needs to know about its numbers.

    density : (v^T S^+ v, pdet S, rank of S) -> density of (18) on the range of S
    tidy    : shortens a merged number; the identity where numbers do not grow
    rounded : True for numbers of many digits instead of exact ones: every result is tidied, a variance below
              NEGLIGIBLE of the terms it is made of is zero, and measurements agree to AGREEMENT of theirs
    weight  : of one dimension that S lacks; exact numbers have none so large, and compare equal ranks only
    """

    density: Callable[[Any, Any, int], Any]
    tidy: Callable[[Any], Any]
    rounded: bool = False
    weight: Any = 1


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

    A measurement that is impossible under every mode is left out; its step has the likelihood 0.
    """
    leaves = list(roots)
    found = []
    for k, z in enumerate(measurements, start=1):
        branches = branch_leaves(rule, leaves, transitions[k - 1], kit)
        grown = [filter_leaf(leaf, models[k - 1][i], i, z, kit) for i, leaf in branches]
        if impossible := total([leaf for _, leaf in grown]) == 0:
            grown = [filter_leaf(leaf, models[k - 1][i], i, [None] * len(z), kit) for i, leaf in branches]
        step = weigh_leaves(grown, len(models[k - 1]), kit)
        step = replace(step, likelihood=0) if impossible else step
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
    """Mean and covariance of a group: multistructure:12* and :13, entry by entry; equal shares where none is likely."""
    whole = total(leaves)
    shares = [sum(leaf.weights) / whole if whole != 0 else kit.tidy(whole + 1) / len(leaves) for leaf in leaves]
    if kit.rounded:  # a mode that another outweighs by a dimension has no share in the moments
        shares = [share if share * kit.weight.sqrt() > 1 else 0 * share for share in shares]
    n = range(len(leaves[0].mean))
    mean = [kit.tidy(sum(g * leaf.mean[a] for g, leaf in zip(shares, leaves, strict=True))) for a in n]

    def entry(a: int, b: int) -> Any:
        return sum(
            g * (leaf.covariance[a][b] + (leaf.mean[a] - mean[a]) * (leaf.mean[b] - mean[b]))
            for g, leaf in zip(shares, leaves, strict=True)
        )

    covariance = [[kit.tidy(entry(a, b)) for b in n] for a in n]
    if not kit.rounded:
        return mean, covariance
    # Means that differ by their last digits only are equal.
    return mean, clean(covariance, [x * x * NEGLIGIBLE**2 for x in mean], kit)


def filter_leaf(leaf: Leaf, model: Model, mode: int, z: Sequence[Any], kit: Kit) -> tuple[int, Leaf]:
    """Kalman filter of one hypothesis; its weight is multiplied by the density of the innovation."""
    mean = shorten(product_with(model.F, leaf.mean), kit)
    P = add(product(product(model.F, leaf.covariance), transposed(model.F)), model.Q)
    P = clean(P, sizes_of_terms(model.F, leaf.covariance, model.Q, kit), kit)
    came = [j for j, value in enumerate(z) if value is not None]
    if not came:
        return mode, Leaf(leaf.weights, mean, P)
    H = [model.H[j] for j in came]
    R = [[model.R[i][j] for j in came] for i in came]
    innovation = [z[j] - expected for j, expected in zip(came, product_with(H, mean), strict=True)]
    PHt = product(P, transposed(H))
    S = add(product(H, PHt), R)
    right = [[v, *row] for v, row in zip(innovation, transposed(PHt), strict=True)]
    solved, determinant, gaps = solve(S, right, sizes_of_terms(H, P, R, kit), kit)
    if not all(is_fitting(gap, spread, [z[j] for j in came], H, mean, kit) for gap, spread in gaps):
        return mode, Leaf((0 * leaf.weights[0],), mean, P)
    distance = sum(v * row[0] for v, row in zip(innovation, solved, strict=True))
    shift = product_with(PHt, [row[0] for row in solved])
    shrink = product(PHt, [row[1:] for row in solved])
    corrected = [[x - y for x, y in zip(*rows, strict=True)] for rows in zip(P, shrink, strict=True)]
    corrected = clean(corrected, [P[a][a] for a in range(len(P))], kit)
    weight = leaf.weights[0] * kit.density(distance, determinant, len(came) - len(gaps)) * kit.weight ** len(gaps)
    return mode, Leaf((weight,), shorten([m + d for m, d in zip(mean, shift, strict=True)], kit), corrected)


def sizes_of_terms(A: Matrix, P: Matrix, N: Matrix, kit: Kit) -> Vector:
    """Bounds ``n sum_b A_ab^2 P_bb + N_aa`` of the terms on the diagonal of ``A P A^T + N``; needed when rounded."""
    n = len(P) if kit.rounded else 0
    return [n * sum(row[b] * row[b] * P[b][b] for b in range(n)) + N[a][a] for a, row in enumerate(A)]


def shorten(values: Vector, kit: Kit) -> Vector:
    """Rounded numbers without the digits beyond theirs; exact ones as they are."""
    return [kit.tidy(value) for value in values] if kit.rounded else values


def is_zero(variance: Any, scale: Any, kit: Kit) -> bool:
    """Whether a variance is zero, beside the terms that it is made of."""
    return bool(variance <= NEGLIGIBLE * scale if kit.rounded else variance == 0)


def clean(P: Matrix, scales: Vector, kit: Kit) -> Matrix:
    """The same covariance; among rounded numbers with zeros in the rows and columns of a variance that is none."""
    if not kit.rounded:
        return P
    known = [is_zero(P[a][a], scale, kit) for a, scale in enumerate(scales)]
    n = range(len(P))
    return [[0 * P[a][b] if known[a] or known[b] else kit.tidy((P[a][b] + P[b][a]) / 2) for b in n] for a in n]


def is_fitting(gap: Any, spread: Vector, z: Vector, H: Matrix, mean: Vector, kit: Kit) -> bool:
    """Whether a measurement that follows from others is what they say; ``gap`` is sum spread_j (z_j - h_j m)."""
    if not kit.rounded:
        return bool(gap == 0)
    predicted = [sum(abs(h * m) for h, m in zip(row, mean, strict=True)) for row in H]
    sizes = [abs(a * (abs(value) + size)) for a, value, size in zip(spread, z, predicted, strict=True)]
    return bool(abs(gap) <= AGREEMENT * sum(sizes))


def weigh_leaves(grown: Sequence[tuple[int, Leaf]], modes: int, kit: Kit) -> ExactStep:
    """Normalise the weights of all branches and take the moments."""
    likelihood = total([leaf for _, leaf in grown])
    shares = shorten([leaf.weights[0] / likelihood for _, leaf in grown], kit)
    leaves = tuple(
        Leaf(tuple(share if i == mode else 0 for i in range(modes)), leaf.mean, leaf.covariance)
        for share, (mode, leaf) in zip(shares, grown, strict=True)
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

    modes = range(len(step.probabilities))
    groups = [step.leaves[i :: len(modes)] for i in modes]  # a branch has the mode of its place
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


def solve(S: Matrix, B: Matrix, scales: Vector, kit: Kit) -> tuple[Matrix, Any, list[tuple[Any, Vector]]]:
    """``S^- B`` by elimination, pdet S, and (gap, spread) of every row that follows from others.

    S^- inverts S on independent rows J and is zero elsewhere. Row d of S is A_d times the rows J: spread is 1 at d
    and -A_d at J, and gap the same sum of the first column of B. ``pdet S = det S_JJ det(I + A A^T)``.
    """
    p = len(S)
    rows = [[*s, *b] for s, b in zip(S, B, strict=True)]
    determinant: Any = 1
    free: list[int] = []
    for i in range(p):
        pivot = rows[i][i]
        if is_zero(pivot, scales[i], kit):
            free.append(i)
            continue
        determinant = determinant * pivot
        rows[i] = [value / pivot for value in rows[i]]
        for j, other in enumerate(rows):
            if j != i:
                factor = other[i]
                rows[j] = [x - factor * y for x, y in zip(other, rows[i], strict=True)]
    gaps = [(rows[d][p], [1 if j == d else 0 if j in free else -rows[j][d] for j in range(p)]) for d in free]
    solved = [[0 * value for value in row[p:]] if i in free else row[p:] for i, row in enumerate(rows)]
    if free:
        spreads = [spread for _, spread in gaps]
        gram = product(spreads, transposed(spreads))
        determinant = determinant * solve(gram, [[] for _ in free], [gram[d][d] for d in range(len(free))], kit)[1]
    return solved, determinant, gaps
