"""Which part of the state each measurement observes, exactly and for symbols.

For dx/dt = G x, sigma_k = h_k^T x the observable functionals of measurement k are spanned by the
chain a_1 = h_k, a_{j+1} = G^T a_j (joint_correction:1.2). The chain breaks off at the first vector
that depends on the earlier ones, a_{m+1} = theta_1 a_1 + ... + theta_m a_m (joint_correction:1.4):
m is the dimension, theta the companion coefficients. All arithmetic is exact in Q[parameters];
a coupling of 1e-15 is not zero. The dimensions are generic: where they drop is the subject of
``observability_loci``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import sympy as sp
from flint import nmod_mat

from navsym.core.errors import DomainError, EmptyError, TooLargeError, UnobservableError
from navsym.core.rational_functions import (Quotient, cancel_fraction, clear_denominators, factor_exactly, multiply_coefficients)
from navsym.models.linear import LinearModel
from navsym.observability.linear import (
    PRIME,
    Matrix,
    at_point,
    independent_places,
    integer_points,
    linear_relation,
    null_vectors,
    residue,
    residue_chains,
    residue_rank,
    scalar_product,
    transposed_times,
    triangular_form,
)
from navsym.observability.reduction import krylov_remainder, krylov_rows
from navsym.observability.ring import Poly, Ring

# The relation that ends a chain, from the characteristic polynomial.
#
# a_{m+1} = theta_1 a_1 + ... + theta_m a_m says that p^m - theta_m p^(m-1) - ... annihilates the chain. It divides
# the characteristic polynomial of the matrix, which is monic with coefficients in Z[parameters]; by Gauss' lemma so
# are its monic factors. For m = n it is the characteristic polynomial itself (Cayley and Hamilton); for m < n the
# factor is picked at an integer point and then checked on every component.


#: So many combinations of factors are tried.
CHOICES = 4096
#: A characteristic polynomial with more terms is not factored.
TERMS = 4000


def characteristic_coefficients(matrix: Matrix, ring: Ring) -> list[Poly]:
    """Coefficients of det(pE - matrix), the leading 1 first, without divisions (Samuelson and Berkowitz)."""
    zero, one = ring.constant(0), ring.constant(1)
    found = [one]
    for size in range(len(matrix)):
        column = [matrix[r][size] for r in range(size)]
        toeplitz = [one, -matrix[size][size]]
        for _ in range(size):
            toeplitz.append(-scalar_product(matrix[size][:size], column, zero))
            column = [scalar_product(matrix[r][:size], column, zero) for r in range(size)]
        found = [
            sum((toeplitz[i - j] * found[j] for j in range(max(0, i - size - 1), min(i, size) + 1)), zero)
            for i in range(size + 2)
        ]
    return found


def chain_relation(vectors: Matrix, m: int, matrix: Matrix, ring: Ring, point: Sequence[int]) -> list[Poly] | None:
    """theta_1 ... theta_m of a chain whose first m vectors are independent; None when it was not found.

    vectors : a_1 ... a_{m+1};  point : integers at which a_1 ... a_m are independent modulo the prime
    """
    whole = characteristic_coefficients(matrix, ring)
    if m == len(matrix):
        return [-c for c in whole[:0:-1]]
    if sum(map(len, whole)) > TERMS:
        return None
    wanted = residue_relation(vectors, m, point)
    for factor in monic_factors(whole, m, ring):
        theta = [-c for c in factor[:0:-1]]
        if [residue(t, point) for t in theta] == wanted and annihilates(theta, vectors, ring):
            return theta
    return None


def residue_relation(vectors: Matrix, m: int, point: Sequence[int]) -> list[int] | None:
    """theta modulo the prime at the point; None when the point is unlucky."""
    rows = at_point(vectors, point)
    width = len(rows[0])
    augmented = nmod_mat(width, m + 1, [rows[r][c] for c in range(width) for r in range(m + 1)], PRIME)
    reduced, rank = augmented.rref()
    if rank != m:
        return None
    return [int(reduced[k, m]) for k in range(m)]


def annihilates(theta: Sequence[Poly], vectors: Matrix, ring: Ring) -> bool:
    """True when a_{m+1} = sum theta_j a_j, component by component."""
    zero = ring.constant(0)
    size = len(theta)
    return all(
        scalar_product(theta, [vectors[j][k] for j in range(size)], zero) == vectors[size][k]
        for k in range(len(vectors[0]))
    )


def monic_factors(coefficients: Sequence[Poly], degree: int, ring: Ring) -> list[list[Poly]]:
    """Monic divisors of the given degree of a monic polynomial in p, each as coefficients, the 1 first."""
    wider, p = Ring.over([*ring.symbols, sp.Dummy("p")]).context, len(ring.symbols)
    total: Poly = sum(
        (
            wider.from_dict({(*powers, place): int(c) for powers, c in coefficient.to_dict().items()})
            for place, coefficient in enumerate(reversed(coefficients))
        ),
        wider.constant(0),
    )
    parts = [(monic_by_power(f, p, ring), int(power)) for f, power in factor_exactly(total)[1]]
    found = []
    for count, powers in enumerate(product(*(range(power + 1) for _, power in parts))):
        if count > CHOICES:
            break
        if sum(k * (len(f) - 1) for k, (f, _) in zip(powers, parts, strict=True)) == degree:
            value = [ring.constant(1)]
            for k, (f, _) in zip(powers, parts, strict=True):
                for _ in range(k):
                    value = multiply_coefficients(value, f)
            found.append(value)
    return found


def monic_by_power(f: Poly, place: int, ring: Ring) -> list[Poly]:
    """Coefficients of a monic polynomial by the powers of one generator, the leading 1 first."""
    degree = int(f.degrees()[place])
    parts: list[dict[tuple[int, ...], int]] = [{} for _ in range(degree + 1)]
    for powers, c in f.to_dict().items():
        parts[degree - int(powers[place])][tuple(map(int, powers[:place]))] = int(c)
    found = [ring.context.from_dict(part) for part in parts]
    return [-c for c in found] if found[0] == -1 else found


#: Largest number of states; exact symbolic answers grow fast.
STATES = 40


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """The vectors a_1 ... a_m of one measurement, without denominators.

    vectors   : m polynomial vectors; ``a_j = vectors[j - 1] / (bottom * clock**(j - 1))``
    bottom    : common denominator of h
    clock     : common denominator of G, the same for all chains
    companion : theta_1 ... theta_m
    """

    name: str
    vectors: Matrix
    bottom: Poly
    clock: Poly
    companion: tuple[Quotient, ...]

    @property
    def dimension(self) -> int:
        """m, the dimension of what the measurement observes."""
        return len(self.vectors)


@dataclass(frozen=True, slots=True, eq=False)
class Chains:
    """All chains of a model, and the staircase that spans what is observed jointly.

    matrix    : numerator of G, (n, n); ``G = matrix / clock``
    staircase : (k_1, ..., k_s): k_1 vectors of the first chain, then k_2 of the second, ... are a
                basis of the jointly observable functionals
    """

    ring: Ring
    states: tuple[str, ...]
    matrix: Matrix
    clock: Poly
    chains: tuple[Chain, ...]
    staircase: tuple[int, ...]

    @property
    def size(self) -> int:
        """n, the number of states."""
        return len(self.states)

    @property
    def joint_dimension(self) -> int:
        """Dimension of what all measurements observe together, the generic rank of the model."""
        return sum(self.staircase)

    def staircase_vectors(self, counts: Sequence[int]) -> Matrix:
        """counts[k] first vectors of every chain, one below the other; longer chains are continued."""
        return [v for chain, count in zip(self.chains, counts, strict=True) for v in self.first(chain, count)]

    def first(self, chain: Chain, count: int) -> Matrix:
        """The first vectors of a chain, also beyond its dimension."""
        vectors = list(chain.vectors[:count])
        while len(vectors) < count:
            vectors.append(transposed_times(self.matrix, vectors[-1], self.ring))
        return vectors

    def weight(self, counts: Sequence[int]) -> Poly:
        """Product of the denominators that the staircase vectors were freed of."""
        total = self.ring.constant(1)
        for chain, count in zip(self.chains, counts, strict=True):
            total = total * chain.bottom**count * self.clock ** (count * (count - 1) // 2)
        return total


def chains_of(model: LinearModel) -> Chains:
    """Chains of all measurements of a constant model, with proofs of their dimensions.

    Raises DomainError (time-varying model, zero row h, entries that are no rational functions),
    EmptyError (no measurement), TooLargeError. Measurements with equal rows are redundant, not wrong.
    """
    need_chains(model)
    ring = Ring.of([model.F, model.H])
    need_nonzero_rows(model, ring)
    n = model.size
    matrix, clock = numerators([model.F[i, :] for i in range(n)], ring)
    rows = [numerators([model.H[k, :]], ring) for k in range(model.H.rows)]
    chains = tuple(
        chain_of(name, row[0], bottom, matrix, clock, ring)
        for name, (row, bottom) in zip(model.measurements, rows, strict=True)
    )
    staircase = joint_staircase(chains, matrix, ring, n)
    return Chains(ring, model.states, matrix, clock, chains, staircase)


def need_chains(model: LinearModel) -> None:
    """Refuse what has no chains: time-varying or too large models, and models without a measurement."""
    if not model.constant:
        raise DomainError(f"expected constant F and H; got entries with the time {model.time}; freeze them at one time")
    if model.size > STATES:
        raise TooLargeError(f"expected at most {STATES} states; got {model.size}; split the model")
    if model.H.rows == 0:
        raise EmptyError("expected at least one measurement; got none; add a row h")


def need_nonzero_rows(model: LinearModel, ring: Ring) -> None:
    """Refuse rows h that are zero, also in disguise: (a + 1)^2 - a^2 - 2 a - 1 is zero."""
    for k, name in enumerate(model.measurements):
        if all(ring.quotient(entry).top == 0 for entry in model.H[k, :]):
            raise DomainError(f"measurement {name}: expected a row h that is not zero; got zeros; remove it")


def numerators(rows: Sequence[sp.Matrix], ring: Ring) -> tuple[Matrix, Poly]:
    """Entries times their least common denominator, and that denominator."""
    known = {entry: ring.quotient(entry) for entry in dict.fromkeys(entry for row in rows for entry in row)}
    return clear_denominators([[known[entry] for entry in row] for row in rows], ring.constant(1))


def chain_of(name: str, row: list[Poly], bottom: Poly, matrix: Matrix, clock: Poly, ring: Ring) -> Chain:
    """Vectors up to the first dependent one; its relation proves that the chain ends there."""
    vectors = [row]
    dimension, point = generic_rank([row], matrix, ring)
    while True:
        while len(vectors) <= dimension:
            vectors.append(transposed_times(matrix, vectors[-1], ring))
        theta = chain_relation(vectors, dimension, matrix, ring, point)
        coefficients = (
            linear_relation(vectors[:dimension], vectors[dimension], ring)
            if theta is None
            else [Quotient(part, ring.constant(1)) for part in theta]
        )
        if coefficients is not None:
            break
        dimension += 1  # the points were unlucky: the relation, not they, decides
    m = dimension
    companion = tuple(  # joint_correction:1.4
        cancel_fraction(c.top * clock**j, c.bottom * clock**m) for j, c in enumerate(coefficients)
    )
    return Chain(name, vectors[:m], bottom, clock, companion)


def generic_rank(rows: Matrix, matrix: Matrix, ring: Ring) -> tuple[int, tuple[int, ...]]:
    """Largest rank of the chains of the rows at the integer points, a proved lower bound, and its point.

    The chains run in residues, so that this takes microseconds even for many symbols.
    """
    ranks = {point: residue_rank(residue_chains(rows, matrix, point)) for point in integer_points(ring)}
    best = max(ranks, key=lambda point: ranks[point])
    return ranks[best], best


def joint_staircase(chains: tuple[Chain, ...], matrix: Matrix, ring: Ring, n: int) -> tuple[int, ...]:
    """Numbers of vectors of every chain that are needed after those of the earlier chains.

    The counts at a point are a proved lower bound of the rank; elimination of what is not regular everywhere
    proves the upper one. Where they differ the points were unlucky, and relations decide.
    """
    tries = [staircase_at(chains, point) for point in integer_points(ring)]
    counts = max(tries, key=sum)
    starts = [(chain.vectors[0], chain.dimension) for chain in chains]
    rest = krylov_remainder(starts, matrix, ring)
    upper = n if sum(counts) == n else rest.regular + len(triangular_form(rest.rows, ring).rows)
    return counts if sum(counts) == upper else staircase_by_relations(chains, ring, n)


def staircase_at(chains: tuple[Chain, ...], point: Sequence[int]) -> tuple[int, ...]:
    """The counts at a point, modulo the prime."""
    rows = at_point([vector for chain in chains for vector in chain.vectors], point)
    chosen = set(independent_places(rows))
    counts, first = [], 0
    for chain in chains:
        counts.append(sum(1 for k in range(first, first + chain.dimension) if k in chosen))
        first += chain.dimension
    return tuple(counts)


def staircase_by_relations(chains: tuple[Chain, ...], ring: Ring, n: int) -> tuple[int, ...]:
    """Twin of :func:`joint_staircase` that proves every dependence by a relation; slow."""
    counts: list[int] = []
    basis: Matrix = []
    for chain in chains:
        count = 0
        while len(basis) + count < n and count < chain.dimension:
            if linear_relation([*basis, *chain.vectors[:count]], chain.vectors[count], ring) is not None:
                break
            count += 1
        basis = [*basis, *chain.vectors[:count]]
        counts.append(count)
    return tuple(counts)


@dataclass(frozen=True, slots=True)
class ProvedRank:
    """Generic rank of an observability matrix with the reasons for both bounds.

    point : integers for the parameters at which a minor of this size is not zero modulo a prime
    upper : why it is not larger
    """

    rank: int
    point: tuple[int, ...]
    upper: str


def prove_rank(model: LinearModel) -> ProvedRank:
    """Generic rank of everything that the measurements observe together, and nothing else.

    Below: a minor that is not zero at a point. Above: either there are no more states, or as many
    unobservable directions N are exhibited, with h N = 0 for every measurement and G N inside the span of N.
    """
    need_chains(model)
    ring = Ring.of([model.F, model.H])
    need_nonzero_rows(model, ring)
    matrix, _ = numerators([model.F[i, :] for i in range(model.size)], ring)
    rows = [numerators([model.H[k, :]], ring)[0][0] for k in range(model.H.rows)]
    rank, point = generic_rank(rows, matrix, ring)
    if rank == model.size:
        return ProvedRank(model.size, point, "the number of states")
    if exhibit_unobservable(rows, matrix, ring, rank, point) is not None:
        count = model.size - rank
        return ProvedRank(rank, point, f"{count} hidden directions, invariant and seen by no measurement")
    return ProvedRank(chains_of(model).joint_dimension, point, "relations close the staircase")


def exhibit_unobservable(rows: Matrix, matrix: Matrix, ring: Ring, rank: int, point: Sequence[int]) -> Matrix | None:
    """n - rank directions that no measurement ever shows, or None when the rank was too small.

    The basis takes the chains step by step, all measurements in turn, which keeps the degrees low.
    """
    n, step = len(matrix), list(rows)
    basis: Matrix = []
    residues: list[list[int]] = []
    while len(basis) < rank:
        for vector in step:
            trial = [*residues, *at_point([vector], point)]
            if residue_rank(trial) > len(residues):
                basis.append(vector)
                residues = trial
        step = [transposed_times(matrix, vector, ring) for vector in step]
    directions = null_vectors(basis, n, ring)
    zero = ring.constant(0)
    for vector in directions:
        moved = [scalar_product(row, vector, zero) for row in matrix]
        seen = [scalar_product(row, vector, zero) for row in rows] + [scalar_product(row, moved, zero) for row in basis]
        if any(value != 0 for value in seen):
            return None
    return directions


# The answer in sympy


@dataclass(frozen=True, slots=True, eq=False)
class MeasurementObservability:
    """The subspace that one scalar measurement observes.

    basis     : (m, n) rows a_1 ... a_m
    companion : theta_1 ... theta_m with a_{m+1} = sum theta_j a_j
    """

    name: str
    basis: sp.ImmutableMatrix
    companion: tuple[sp.Expr, ...]

    @property
    def dimension(self) -> int:
        """m, the dimension of what the measurement observes."""
        return self.basis.rows


@dataclass(frozen=True, slots=True, eq=False)
class JointObservability:
    """Generic observability of a model, proved.

    staircase    : how many chain vectors of every measurement form a basis of the observed functionals
    unobservable : (n - joint_dimension, n) rows x with h_k^T G^j x = 0 for all j and k
    assumptions  : denominators that are taken to be nonzero
    """

    states: tuple[str, ...]
    measurements: tuple[MeasurementObservability, ...]
    staircase: tuple[int, ...]
    unobservable: sp.ImmutableMatrix
    assumptions: tuple[sp.Expr, ...]
    chains: Chains

    @property
    def joint_dimension(self) -> int:
        """Dimension of what all measurements observe together, the generic rank of the model."""
        return sum(self.staircase)

    @property
    def observable(self) -> bool:
        """True when the measurements together observe all states, for all but special parameters."""
        return self.joint_dimension == len(self.states)


def observe_jointly(model: LinearModel) -> JointObservability:
    """Chains, dimensions, companion coefficients and unobservable directions of a constant model.

    Raises the same errors as :func:`chains_of`.
    """
    chains = chains_of(model)
    ring, n = chains.ring, chains.size
    directions: Matrix = []
    if chains.joint_dimension < n:
        starts = [(chain.vectors[0], chain.dimension) for chain in chains.chains]
        directions = null_vectors(krylov_rows(starts, chains.matrix, chains.joint_dimension, ring), n, ring)
    entries = [ring.expression(x) for vector in directions for x in vector]
    return JointObservability(
        states=model.states,
        measurements=tuple(
            MeasurementObservability(
                chain.name, chain_rows(chain.vectors, chain, ring), tuple(map(ring.expression, chain.companion))
            )
            for chain in chains.chains
        ),
        staircase=chains.staircase,
        unobservable=sp.ImmutableMatrix(len(directions), n, entries),
        assumptions=model_denominators(chains),
        chains=chains,
    )


def chain_rows(vectors: Matrix, chain: Chain, ring: Ring) -> sp.ImmutableMatrix:
    """The vectors as rows with their denominators put back."""
    entries = []
    for j, vector in enumerate(vectors):
        scale = chain.bottom * chain.clock**j
        entries += [ring.expression(cancel_fraction(x, scale)) for x in vector]
    return sp.ImmutableMatrix(len(vectors), len(chain.vectors[0]), entries)


def model_denominators(chains: Chains) -> tuple[sp.Expr, ...]:
    """Denominators of the model, which must not vanish."""
    ring = chains.ring
    bottoms = [chains.clock, *(chain.bottom for chain in chains.chains)]
    written = dict.fromkeys(ring.factored(b) for b in bottoms if not b.is_constant())
    return tuple(value for value in written if not value.is_Number)


def direction_names(vector: Sequence[sp.Expr], states: Sequence[str]) -> str:
    """A direction of the state by its components: ``(x1, x3) = (1, -2)``; the others are zero."""
    parts = [(state, str(value)) for value, state in zip(vector, states, strict=True) if value != 0]
    if len(parts) == 1:
        return parts[0][0]
    return f"({', '.join(state for state, _ in parts)}) = ({', '.join(value for _, value in parts)})"


def functional_names(vector: Sequence[sp.Expr], states: Sequence[str]) -> str:
    """A functional as the combination of states that it measures: ``x1 - 2*x3``; parentheses around sums."""
    parts = []
    for value, state in zip(vector, states, strict=True):
        if value != 0:
            text = str(value)
            factor = f"({text})" if value.is_Add else text
            parts.append(state if value == 1 else f"-{state}" if value == -1 else f"{factor}*{state}")
    return " + ".join(parts).replace("+ -", "- ")


def need_observable(found: JointObservability) -> None:
    """Raise UnobservableError with the directions that no measurement shows."""
    if not found.observable:
        rows = found.unobservable
        named = "; ".join(direction_names(rows[k, :], found.states) for k in range(rows.rows))
        raise UnobservableError(
            f"expected an observable pair; got rank {found.joint_dimension} of {len(found.states)}, no "
            f"measurement "
            f"shows the direction {named}; measure it or leave it out"
        )
