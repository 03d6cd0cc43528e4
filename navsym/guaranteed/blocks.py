"""Vector measurements: the best linear estimate from blocks whose noise is bounded as a vector, with a certificate.

A block is ``z_i = H_i x + r_i`` with noise in a set B_i: ``|r_j| <= s_j`` for each entry ("linf"),
``sum |r_j|/s_j <= 1`` ("l1"), or ``r' E^-1 r <= 1`` ("l2": a ball or an ellipsoid). An estimate ``sum w_i . z_i`` of
``P . x`` is unbiased when ``sum H_i' w_i = P``; its guaranteed error is the sum of the largest ``w_i . r_i``. By weak
duality no unbiased estimate has a smaller one than ``x . P`` for any x whose measurements are noise, ``H_i x`` in B_i:
such a state looks like zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb, fmpq, fmpq_mat

from navsym.claims.display import write_card, write_table
from navsym.core.answers import Answer
from navsym.core.balls import precision
from navsym.core.errors import DomainError, EmptyError, NotEstimableError, ShapeError
from navsym.core.exact import decimal, from_decimal, to_fmpq, upper_end
from navsym.core.numbers import Number
from navsym.guaranteed.search.cones import Cone, Proposal, propose_optima
from navsym.guaranteed.streaming.numbers import read_exact, to_float, write_rational
from navsym.language.names import quote

NORMS = ("l2", "linf", "l1")
BITS, DIGITS, PLACES = 320, 24, 60
#: The dual is drawn in by this part of itself before it is rounded, so that it stays admissible noise.
SHRINK = 1 - fmpq(1, 10**50)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Block:
    """Measurements that come together: ``z = H x + r`` with bounded noise r.

    H     : p rows of m numbers
    bound : one number, p numbers, or for "l2" also a symmetric positive definite matrix E with ``r' E^-1 r <= 1``;
            for "l2" numbers s are half axes
    norm  : "l2", "linf" or "l1"

    Numbers are exact: text, ints, Fractions; a float is the decimal that it prints as. Raises ShapeError, EmptyError
    and DomainError.

    >>> import navsym as nav
    >>> nav.Block([["1", "0"], ["0", "1"]], "1/2")
    Block(2 measurements of 2 unknowns, l2)
    """

    H: Any
    bound: Any = 1
    norm: str = "l2"

    def __post_init__(self) -> None:
        if self.norm not in NORMS:
            raise DomainError(f'expected "l2", "linf" or "l1"; got {quote(self.norm)}; choose one', where="Block: norm")
        H = read_table(self.H, "Block: H")
        object.__setattr__(self, "H", H)
        object.__setattr__(self, "bound", read_bound(self.bound, int(H.nrows()), self.norm))

    @property
    def cone(self) -> Cone:
        """The block for the search."""
        return Cone(self.H, self.norm, self.bound)

    def __repr__(self) -> str:
        return f"Block({self.H.nrows()} measurements of {self.H.ncols()} unknowns, {self.norm})"


def read_table(rows: Any, where: str) -> fmpq_mat:
    """A matrix of exact numbers. Raises EmptyError and ShapeError."""
    listed = [[read_exact(e, where) for e in as_list(row, where)] for row in as_list(rows, where)]
    if not listed or not listed[0]:
        raise EmptyError("expected rows of numbers; got none; give at least one", where=where)
    if len({len(row) for row in listed}) > 1:
        sizes = sorted({len(row) for row in listed})
        raise ShapeError(f"expected rows of one length; got lengths {sizes}; complete them", where=where)
    return fmpq_mat(len(listed), len(listed[0]), [e for row in listed for e in row])


def as_list(value: Any, where: str) -> list[Any]:
    """The entries of a list, a tuple or an array. Raises ShapeError."""
    if isinstance(value, np.ndarray):
        return list(value.tolist()) if value.ndim else [value.item()]
    if not isinstance(value, list | tuple):
        raise ShapeError(f"expected a list; got {quote(value)}; put it in brackets", where=where)
    return list(value)


def read_bound(bound: Any, p: int, norm: str) -> fmpq_mat:
    """Sizes (p, 1), or for "l2" the shape (p, p). Raises ShapeError and DomainError."""
    where = "Block: bound"
    items = as_list(bound, where) if isinstance(bound, list | tuple | np.ndarray) else [bound] * p
    if norm == "l2" and items and isinstance(items[0], list | tuple | np.ndarray):
        shape = read_table(items, where)
        if (shape.nrows(), shape.ncols()) != (p, p):
            got = f"{shape.nrows()} by {shape.ncols()}"
            raise ShapeError(f"expected a matrix {p} by {p}; got {got}; complete it", where=where)
        minors = [fmpq_mat(k, k, [shape[i, j] for i in range(k) for j in range(k)]).det() for k in range(1, p + 1)]
        if shape != shape.transpose() or min(minors) <= 0:
            message = "expected a symmetric positive definite matrix; got another; mend it"
            raise DomainError(message, where=where)
        return shape
    sizes = [read_exact(item, where) for item in items]
    if len(sizes) != p:
        raise ShapeError(f"expected {p} numbers, one a measurement; got {len(sizes)}; complete them", where=where)
    if min(sizes) <= 0:
        raise DomainError(f"expected positive bounds; got {write_rational(min(sizes))}; mend it", where=where)
    if norm != "l2":
        return fmpq_mat(p, 1, sizes)
    return fmpq_mat(p, p, [s * s if i == j else fmpq(0) for i, s in enumerate(sizes) for j in range(p)])


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BlockEstimator(Answer):
    """The best linear estimate from blocks of measurements, with its enclosed guaranteed error.

    value       : the guaranteed error, a :class:`Number`
    weights     : block by block, exact; the estimate is ``sum w_i . z_i``
    dual        : x, exact: a state whose measurements are admissible noise, and whose target is the lower bound; with
                  an entry more for each constraint
    noise       : block by block, the measurements ``H_i x`` of the dual
    shares      : what each block contributes to the value, as parts of one: with the bound of a block 1 % larger the
                  value grows by 1 % of its share, to first order
    certificate : plain data that the independent checker replays, kind "cones"
    """

    target: str
    value: Number
    weights: tuple[tuple[fmpq, ...], ...]
    dual: tuple[fmpq, ...]
    noise: tuple[tuple[fmpq, ...], ...]
    shares: tuple[float, ...]
    certificate: Mapping[str, Any]

    def estimate(self, measurements: Sequence[Any]) -> float:
        """``sum w_i . z_i`` for measurements block by block."""
        total = fmpq(0)
        for w, z in zip(self.weights, measurements, strict=True):
            values = [read_exact(e, "estimate") for e in as_list(z, "estimate")]
            total += sum((a * b for a, b in zip(w, values, strict=True)), fmpq(0))
        return to_float(total)

    def worst_case(self) -> list[list[float]]:
        """Noise block by block that attains the value, up to its digits: the measurements ``H_i x`` of the dual.

        The state 0 with this noise and the state x without any give the same measurements.

        >>> import navsym as nav
        >>> nav.solve_blocks([nav.Block([["1"], ["1"]])], ["1"]).worst_case()
        [[0.7071067811865476, 0.7071067811865476]]
        """
        return [[to_float(e) for e in block] for block in self.noise]

    def document(self) -> dict[str, Any]:
        """The answer as plain data."""
        return {
            "target": self.target,
            "value": self.value.document(),
            "weights": [[to_float(e) for e in w] for w in self.weights],
            "dual": [to_float(e) for e in self.dual],
            "shares": list(self.shares),
            "certificate": dict(self.certificate),
        }

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificate in a list, for :func:`navsym.check`."""
        return [self.certificate]

    def __repr__(self) -> str:
        used = sum(any(e != 0 for e in w) for w in self.weights)
        return f"BlockEstimator({quote(self.target)[1:-1]}: {self.value}, {used} of {len(self.weights)} blocks)"

    def _repr_html_(self) -> str:
        rows = [
            (str(k), ", ".join(f"{to_float(e):.6g}" for e in w), f"{share:.6g}")
            for k, (w, share) in enumerate(zip(self.weights, self.shares, strict=True), 1)
        ]
        return write_card([repr(self), write_table(("block", "weights", "share of the error"), rows)], "")


def solve_blocks(
    blocks: Sequence[Block],
    target: Sequence[Any] | Mapping[str, Sequence[Any]],
    *,
    constraints: Sequence[tuple[Sequence[Any], Any]] = (),
) -> BlockEstimator | dict[str, BlockEstimator]:
    """The linear estimate with the least guaranteed error from blocks of vector measurements.

    Minimises ``sum_i max w_i . r_i`` over the noise of each block, subject to ``sum H_i' w_i = P``: second-order cones
    for balls and ellipsoids. Both bounds of the value are exact, and agree to 20 digits as a rule.

    blocks      : :class:`Block`, all of the same unknowns
    target      : P, one number an unknown; or a mapping of names to several, which gives an answer for each
    constraints : pairs (c, d) of vectors c_i, block by block, and a number: ``sum c_i . w_i = d``. Zeros and the times
                  of a drift make the estimate blind to it; ones and 0 give weights of zero mean

    Unknowns that nobody asks for are nuisance parameters: their entry of P is 0. Raises NotEstimableError, ShapeError,
    EmptyError and DomainError.

    >>> import navsym as nav
    >>> found = nav.solve_blocks([nav.Block([["1", "0"], ["0", "1"]]), nav.Block([["1", "1"]], "1/4")], ["1", "0"])
    >>> found.value.lower[:8], found.check()
    ('0.820970', <1 checked, all ACCEPTED>)
    """
    if isinstance(target, Mapping):
        return {name: solve_target(blocks, P, constraints, name) for name, P in target.items()}
    return solve_target(blocks, target, constraints, "target")


def solve_target(
    blocks: Sequence[Block], target: Sequence[Any], constraints: Sequence[tuple[Sequence[Any], Any]], name: str
) -> BlockEstimator:
    """The answer for one target."""
    cones, functional = state_problem(blocks, target, constraints)
    kept = independent_columns(cones, functional)
    narrow = [Cone(pick_columns(cone.H, kept), cone.norm, cone.size) for cone in cones]
    P = fmpq_mat(len(kept), 1, [functional[k, 0] for k in kept])
    with precision(BITS):
        nothing = Proposal([fmpq(0)] * len(kept), [[fmpq(0)] * cone.rows for cone in narrow])
        answers = [bound_optimum(narrow, P, found) for found in propose_optima(narrow, P) or [nothing]]
        weights, dual, costs, least = min(answers, key=lambda one: float((sum(one[2], arb(0)) - one[3]).mid()))
        total = sum(costs, arb(0))
        whole = [fmpq(0)] * functional.nrows()
        for k, x in zip(kept, dual, strict=True):
            whole[k] = x
        value = Number(decimal(least, DIGITS, -1), upper_end(total, DIGITS))
        shares = tuple(float((c / total).mid()) for c in costs)
    certificate = write_certificate(cones, functional, weights, whole, value)
    noise = tuple(tuple((cone.H * fmpq_mat(len(whole), 1, whole)).entries()) for cone in cones)
    return BlockEstimator(name, value, tuple(map(tuple, weights)), tuple(whole), noise, shares, certificate)


def bound_optimum(
    cones: Sequence[Cone], P: fmpq_mat, found: Proposal
) -> tuple[list[list[fmpq]], list[fmpq], list[arb], fmpq]:
    """Unbiased weights, an admissible dual, the costs of the weights block by block, and what the dual is worth."""
    weights, dual = balance_weights(cones, P, found.weights), admissible_dual(cones, found.x)
    costs = [cone.cost(w) for cone, w in zip(cones, weights, strict=True)]
    return weights, dual, costs, sum((x * p for x, p in zip(dual, P.entries(), strict=True)), fmpq(0))


def state_problem(
    blocks: Sequence[Block], target: Sequence[Any], constraints: Sequence[tuple[Sequence[Any], Any]]
) -> tuple[list[Cone], fmpq_mat]:
    """Regressors with a column for each constraint, and the functional. Raises ShapeError, EmptyError, DomainError."""
    P = [read_exact(p, "solve_blocks: target") for p in as_list(target, "solve_blocks: target")]
    if not blocks or not P:
        raise EmptyError("expected blocks and a target; got none; give at least one of each", where="solve_blocks")
    cones = [block.cone for block in blocks]
    for cone in cones:
        if cone.H.ncols() != len(P):
            message = f"expected {len(P)} unknowns in each block; got {cone.H.ncols()}; complete the rows"
            raise ShapeError(message, where="solve_blocks: blocks")
    for c, d in constraints:
        columns = [[read_exact(e, "constraints") for e in as_list(part, "solve_blocks: constraints")] for part in c]
        if [len(part) for part in columns] != [cone.rows for cone in cones]:
            message = "expected a number for each measurement of each block; got others; complete them"
            raise ShapeError(message, where="solve_blocks: constraints")
        cones = [
            Cone(add_column(cone.H, part), cone.norm, cone.size) for cone, part in zip(cones, columns, strict=True)
        ]
        P.append(read_exact(d, "solve_blocks: constraints"))
    if not any(P):
        raise DomainError("expected a target that is not zero; got zeros; every estimate of it is free", where="target")
    return cones, fmpq_mat(len(P), 1, P)


def add_column(H: fmpq_mat, column: Sequence[fmpq]) -> fmpq_mat:
    """H with one more column."""
    rows = [[*row, e] for row, e in zip(H.tolist(), column, strict=True)]
    return fmpq_mat(len(rows), len(rows[0]), [e for row in rows for e in row])


def pick_columns(H: fmpq_mat, columns: Sequence[int]) -> fmpq_mat:
    """Some columns of a matrix."""
    return fmpq_mat(H.nrows(), len(columns), [row[k] for row in H.tolist() for k in columns])


def stack(cones: Sequence[Cone]) -> fmpq_mat:
    """All regressors, one row for each measurement."""
    rows = [e for cone in cones for e in cone.H.entries()]
    return fmpq_mat(sum(cone.rows for cone in cones), cones[0].H.ncols(), rows)


def pivots_of(matrix: fmpq_mat) -> list[int]:
    """The pivot columns of the reduced echelon form."""
    reduced, rank = matrix.rref()
    return [next(j for j in range(matrix.ncols()) if reduced[i, j] != 0) for i in range(rank)]


def independent_columns(cones: Sequence[Cone], functional: fmpq_mat) -> list[int]:
    """Unknowns in which unbiased weights are unbiased in all. Raises NotEstimableError."""
    H = stack(cones)
    more = fmpq_mat(H.nrows() + 1, H.ncols(), [*H.entries(), *functional.entries()])
    if more.rank() > H.rank():
        raise NotEstimableError(
            f"the target is not estimable from these {H.nrows()} measurements: it does not lie in the row space of the "
            f"regressors (rank {H.rank()} of {H.ncols()}); add measurements or estimate fewer unknowns"
        )
    return pivots_of(H)


def balance_weights(cones: Sequence[Cone], P: fmpq_mat, proposed: Sequence[Sequence[fmpq]]) -> list[list[fmpq]]:
    """The weights, rounded and made exactly unbiased on rows that carry the largest of them."""
    flat, rows = [decimal_of(e) for w in proposed for e in w], stack(cones).tolist()
    order = sorted(range(len(flat)), key=lambda k: -abs(flat[k]))
    turned = fmpq_mat(len(order), P.nrows(), [e for k in order for e in rows[k]]).transpose()
    picked = [order[k] for k in pivots_of(turned)]
    rest = P - stack(cones).transpose() * fmpq_mat(len(flat), 1, flat)
    columns = fmpq_mat(len(picked), P.nrows(), [e for k in picked for e in rows[k]]).transpose()
    for k, e in zip(picked, columns.solve(rest).entries(), strict=True):
        flat[k] += e
    ends = [sum(cone.rows for cone in cones[:k]) for k in range(len(cones) + 1)]
    return [flat[a:b] for a, b in pairwise(ends)]


def decimal_of(x: fmpq) -> fmpq:
    """The number rounded to PLACES digits."""
    return from_decimal(decimal(x, PLACES))


def admissible_dual(cones: Sequence[Cone], x: Sequence[fmpq]) -> list[fmpq]:
    """The dual scaled and rounded, so that all its measurements are admissible noise exactly."""
    rounded = [decimal_of(e) for e in x]
    column = fmpq_mat(len(x), 1, rounded)
    gauges = [(cone.gauge(column), cone.norm) for cone in cones]
    worst = max((arb(g).sqrt() if norm == "l2" else arb(g) for g, norm in gauges), key=lambda g: float(g.mid()))
    factor = to_fmpq((SHRINK / worst).mid()) if worst > 0 else fmpq(1)
    scale = from_decimal(decimal(factor, PLACES, -1))
    return [e * scale for e in rounded]


def write_certificate(
    cones: Sequence[Cone], functional: fmpq_mat, weights: Sequence[Sequence[fmpq]], dual: Sequence[fmpq], value: Number
) -> dict[str, Any]:
    """The certificate of kind cones."""
    text = lambda numbers: [write_rational(e) for e in numbers]  # noqa: E731
    blocks = [
        {
            "H": [text(row) for row in cone.H.tolist()],
            "norm": cone.norm,
            "size": [text(row) for row in cone.size.tolist()],
            "weights": text(w),
        }
        for cone, w in zip(cones, weights, strict=True)
    ]
    ends = {"lower": value.lower, "upper": value.upper, "bits": BITS}
    return {"kind": "cones", "blocks": blocks, "functional": text(functional.entries()), "dual": text(dual)} | ends
