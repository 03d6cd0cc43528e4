"""Which part of the state each measurement observes, exactly and for symbols.

For dx/dt = G x, sigma_k = h_k^T x the observable functionals of measurement k are spanned by the
chain a_1 = h_k, a_{j+1} = G^T a_j (joint_correction:1.2). The chain breaks off at the first vector
that depends on the earlier ones, a_{m+1} = theta_1 a_1 + ... + theta_m a_m (joint_correction:1.4):
m is the dimension, theta the companion coefficients. All arithmetic is exact in Q[parameters];
a coupling of 1e-15 is not zero. The dimensions are generic: where they drop is the subject of
``rank_drops``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import sympy as sp

from navsym.core.errors import DomainError, EmptyError, TooLargeError, UnobservableError
from navsym.core.rational_functions import Quotient, cancel_fraction, clear_denominators
from navsym.models.linear import LinearModel
from navsym.observability.directions import find_unobservable
from navsym.observability.linear import (
    Matrix,
    at_point,
    independent_places,
    linear_relation,
    null_vectors,
    residue_rank,
    scalar_product,
)
from navsym.observability.motion import Motion, motion_of, residue_chains
from navsym.observability.ring import Poly, Ring


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


#: Largest number of states; exact symbolic answers grow fast.
STATES = 40
#: Terms of a vector, or of a whole chain to be solved, up to which those of a moving model are written.
LONGEST = 300
#: The same for a vector and a chain of a constant model, whose relation comes from the characteristic polynomial.
LONGEST_CONSTANT, LONGEST_CHAIN = 800, 1200


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """The vectors a_1 ... a_m of one measurement, without denominators.

    vectors   : m polynomial vectors; ``a_j = vectors[j - 1] / (bottom * clock**(j - 1))``. Of a nonlinear model the
                first ones only, where the others are too long to write
    bottom    : common denominator of h
    clock     : common denominator of G, the same for all chains; both are 1 where they move
    companion : theta_1 ... theta_m; None where the relation is too long to write
    dimension : m, what the measurement observes
    stacked   : all rows that the legs of a motion show, of a model in pieces; none of another
    """

    name: str
    vectors: Matrix
    bottom: Poly
    clock: Poly
    companion: tuple[Quotient, ...] | None
    dimension: int
    stacked: Matrix = field(default_factory=list)

    @property
    def starts(self) -> Matrix:
        """The rows from which all others follow along the motion."""
        return self.stacked or self.vectors[:1]


@dataclass(frozen=True, slots=True, eq=False)
class Chains:
    """All chains of a model, and the staircase that spans what is observed jointly.

    staircase  : (k_1, ..., k_s): k_1 vectors of the first chain, then k_2 of the second, ... are a
                 basis of the jointly observable functionals
    directions : columns that no measurement shows, without denominators; None where none could be exhibited, so that
                 the rank is proved from below only
    model      : F and the rows of H;  owners : the measurement of each row
    """

    states: tuple[str, ...]
    model: LinearModel
    owners: tuple[str, ...]
    motion: Motion
    chains: tuple[Chain, ...]
    staircase: tuple[int, ...]
    directions: Matrix | None

    @property
    def ring(self) -> Ring:
        """The ring of the entries."""
        return self.motion.ring

    @property
    def matrix(self) -> Matrix:
        """Numerator of G, (n, n); ``G = matrix / clock``."""
        return self.motion.matrix

    @property
    def clock(self) -> Poly:
        """Denominator of G."""
        return self.motion.clock

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
            vectors.append(self.motion.advance(vectors[-1]))
        return vectors

    def weight(self, counts: Sequence[int]) -> Poly:
        """Product of the denominators that the staircase vectors were freed of."""
        total = self.ring.constant(1)
        for chain, count in zip(self.chains, counts, strict=True):
            total = total * chain.bottom**count * self.clock ** (count * (count - 1) // 2)
        return total


def chains_of(model: LinearModel, owners: tuple[str, ...] = ()) -> Chains:
    """Chains of all measurements of a model, with proofs of their dimensions.

    owners : of a state at rest, of which a measurement has several rows, the measurement of each row

    Raises DomainError (time-varying model, zero row h, entries that are no rational functions),
    EmptyError (no measurement), TooLargeError. Measurements with equal rows are redundant, not wrong.
    """
    motion, rows = moving_rows(model)
    if owners:
        groups = {name: [row for (row, _), owner in zip(rows, owners, strict=True) if owner == name] for name in owners}
        chains = tuple(stacked_chain(name, group, motion) for name, group in groups.items())
    else:
        chains = tuple(chain_of(name, *row, motion) for name, row in zip(model.measurements, rows, strict=True))
    staircase, directions = joint_staircase(chains, motion)
    return Chains(model.states, model, owners or model.measurements, motion, chains, staircase, directions)


def stacked_chain(name: str, rows: Matrix, motion: Motion) -> Chain:
    """What the rows of one measurement show of a state at rest."""
    one = motion.ring.constant(1)
    vectors = [rows[k] for k in independent_places(at_point(rows, motion.points(1)[0]))]
    unseen = null_vectors(vectors, motion.size, motion.ring)
    if any(scalar_product(row, column, 0 * one) != 0 for row in rows for column in unseen):
        raise ArithmeticError("stacked rows: the point was unlucky")
    return Chain(name, vectors, one, one, None, len(vectors), rows)


def moving_rows(model: LinearModel) -> tuple[Motion, list[tuple[list[Poly], Poly]]]:
    """The motion of a model and its rows h with their denominators; refuses rows that are zero."""
    need_chains(model)
    motion, rows = motion_of(model)
    for name, (row, _) in zip(model.measurements, rows, strict=True):
        if all(entry == 0 for entry in row):
            raise DomainError(f"measurement {name}: expected a row h that is not zero; got zeros; remove it")
    return motion, rows


def need_chains(model: LinearModel) -> None:
    """Refuse what has no chains: too large models, and models without a measurement."""
    if model.size > STATES:
        raise TooLargeError(f"expected at most {STATES} states; got {model.size}; split the model")
    if model.H.rows == 0:
        raise EmptyError("expected at least one measurement; got none; add a row h")


def numerators(rows: Sequence[sp.Matrix], ring: Ring) -> tuple[Matrix, Poly]:
    """Entries times their least common denominator, and that denominator."""
    known = {entry: ring.quotient(entry) for entry in dict.fromkeys(entry for row in rows for entry in row)}
    return clear_denominators([[known[entry] for entry in row] for row in rows], ring.constant(1))


def chain_of(name: str, row: list[Poly], bottom: Poly, motion: Motion) -> Chain:
    """Vectors up to the first dependent one; its relation proves that the chain ends there."""
    vectors, ring = [row], motion.ring
    dimension, _ = generic_rank([row], motion)
    clock = motion.clock
    if motion.derivative(clock) != 0 or motion.derivative(bottom) != 0:
        clock = bottom = ring.constant(1)
    while True:
        while len(vectors) <= dimension:
            if sum(len(entry) for entry in vectors[-1]) > (LONGEST if motion.rates else LONGEST_CONSTANT):
                return Chain(name, vectors[:dimension], bottom, clock, None, dimension)
            vectors.append(motion.advance(vectors[-1]))
        terms = sum(len(x) for v in vectors for x in v)
        if terms > (LONGEST if motion.rates else LONGEST_CHAIN) or (motion.rates and motion.roots):
            return Chain(name, vectors[:dimension], bottom, clock, None, dimension)
        coefficients = chain_coefficients(vectors, dimension, motion)
        if coefficients is not None:
            break
        dimension += 1  # the points were unlucky: the relation, not they, decides
    m = dimension
    companion = tuple(  # joint_correction:1.4
        cancel_fraction(c.top * clock**j, c.bottom * clock**m) for j, c in enumerate(coefficients)
    )
    return Chain(name, vectors[:m], bottom, clock, companion, m)


def chain_coefficients(vectors: Matrix, m: int, motion: Motion) -> list[Quotient] | None:
    """theta_1 ... theta_m without the clock: solved for, or by Cayley and Hamilton where a constant chain spans all."""
    ring = motion.ring
    if motion.rates or m < motion.size:
        return linear_relation(vectors[:m], vectors[m], ring)
    whole = characteristic_coefficients(motion.matrix, ring)
    return [Quotient(-c, ring.constant(1)) for c in whole[:0:-1]]


def generic_rank(rows: Matrix, motion: Motion) -> tuple[int, tuple[int, ...]]:
    """Largest rank of the chains of the rows at a few points, a proved lower bound, and its point.

    The chains run in residues, so that this takes milliseconds even for many symbols.
    """
    ranks = {point: residue_rank(residue_chains(rows, motion, point)) for point in motion.points()}
    best = max(ranks, key=lambda point: ranks[point])
    return ranks[best], best


def joint_staircase(chains: tuple[Chain, ...], motion: Motion) -> tuple[tuple[int, ...], Matrix | None]:
    """Numbers of vectors of every chain that are needed after those of the earlier chains, and what they leave.

    The counts at a point are a proved lower bound of the rank; unobservable directions prove the upper one.
    """
    starts = [row for chain in chains for row in chain.starts]
    tries = {point: staircase_at(chains, motion, point) for point in motion.points()}
    point = max(tries, key=lambda key: sum(tries[key]))
    counts, n = tries[point], motion.size
    if sum(counts) == n:
        return counts, []
    directions = find_unobservable(starts, motion, sum(counts), point)
    return counts, directions


def staircase_at(chains: tuple[Chain, ...], motion: Motion, point: Sequence[int]) -> tuple[int, ...]:
    """The counts at a point, modulo the prime."""
    listed = [(k, row) for k, chain in enumerate(chains) for row in chain.starts]
    chosen = independent_places(residue_chains([row for _, row in listed], motion, point))
    taken = [listed[place // motion.size][0] for place in chosen]
    return tuple(map(taken.count, range(len(chains))))


@dataclass(frozen=True, slots=True)
class ProvedRank:
    """Generic rank of an observability matrix with the reasons for both bounds.

    point : integers for the parameters at which a minor of this size is not zero modulo a prime
    upper : why it is not larger; "" where that is not proved
    """

    rank: int
    point: tuple[int, ...]
    upper: str


def prove_rank(model: LinearModel) -> ProvedRank:
    """Generic rank of everything that the measurements observe together, and nothing else.

    Below: a minor that is not zero at a point. Above: either there are no more states, or as many
    unobservable directions N are exhibited, with h N = 0 for every measurement and G N inside the span of N.
    """
    motion, listed = moving_rows(model)
    rows = [row for row, _ in listed]
    rank, point = generic_rank(rows, motion)
    if rank == model.size:
        return ProvedRank(model.size, point, "the number of states")
    found = find_unobservable(rows, motion, rank, point)
    upper = f"{model.size - rank} hidden directions, invariant and seen by no measurement" if found is not None else ""
    return ProvedRank(rank, point, upper)


# The answer in sympy


@dataclass(frozen=True, slots=True, eq=False)
class MeasurementObservability:
    """The subspace that one scalar measurement observes.

    basis     : (m, n) rows a_1 ... a_m
                Fewer rows where those of a nonlinear model are too long to write
    companion : theta_1 ... theta_m with a_{m+1} = sum theta_j a_j; empty where it is too long to write
    dimension : m, the dimension of what the measurement observes
    """

    name: str
    basis: sp.ImmutableMatrix
    companion: tuple[sp.Expr, ...]
    dimension: int


@dataclass(frozen=True, slots=True, eq=False)
class JointObservability:
    """Generic observability of a model, proved.

    staircase    : how many chain vectors of every measurement form a basis of the observed functionals
    unobservable : (n - joint_dimension, n) rows x with h_k^T G^j x = 0 for all j and k; no rows where none were found
    observed     : (joint_dimension, n) functionals that are known: all that vanish on the unobservable directions
    proved       : False when the rank is proved from below only
    assumptions  : denominators that are taken to be nonzero
    """

    states: tuple[str, ...]
    measurements: tuple[MeasurementObservability, ...]
    staircase: tuple[int, ...]
    unobservable: sp.ImmutableMatrix
    assumptions: tuple[sp.Expr, ...]
    written: Chains | None
    observed: sp.ImmutableMatrix
    proved: bool = True

    @property
    def chains(self) -> Chains:
        """The chains of a model without unknown inputs. Raises DomainError beside these."""
        if self.written is None:
            raise DomainError("expected a model without unknown inputs; got inputs; leave them out")
        return self.written

    @property
    def joint_dimension(self) -> int:
        """Dimension of what all measurements observe together, the generic rank of the model."""
        return sum(self.staircase)

    @property
    def observable(self) -> bool:
        """True when the measurements together observe all states, for all but special parameters."""
        return self.joint_dimension == len(self.states)


def observe_jointly(model: LinearModel, owners: tuple[str, ...] = ()) -> JointObservability:
    """Chains, dimensions, companion coefficients and unobservable directions of a model.

    Arguments and errors are those of :func:`chains_of`.
    """
    chains = chains_of(model, owners)
    ring, n = chains.ring, chains.size
    directions = chains.directions or []
    entries = [ring.expression(x) for vector in directions for x in vector]
    return JointObservability(
        states=model.states,
        measurements=tuple(
            MeasurementObservability(
                chain.name,
                chain_rows(chain.vectors, chain, ring),
                tuple(map(ring.expression, chain.companion or ())),
                chain.dimension,
            )
            for chain in chains.chains
        ),
        staircase=chains.staircase,
        unobservable=sp.ImmutableMatrix(len(directions), n, entries),
        assumptions=model_denominators(chains),
        written=chains,
        observed=observed_rows(chains),
        proved=chains.directions is not None,
    )


def observed_rows(chains: Chains) -> sp.ImmutableMatrix:
    """Functionals that vanish on all unobservable directions; none where these are not known, or too long."""
    ring, n = chains.ring, chains.size
    short = sum(len(x) for column in chains.directions or [] for x in column) <= LONGEST
    rows = null_vectors(chains.directions, n, ring) if chains.directions is not None and short else []
    return sp.ImmutableMatrix(len(rows), n, [ring.expression(x) for row in rows for x in row])


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
    bottoms = [chains.motion.clock, *(chain.bottom for chain in chains.chains)]
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
