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
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.claims.display import write_card, write_table
from navsym.core.answers import Answer
from navsym.core.balls import precision
from navsym.core.errors import DomainError, EmptyError, ExpressionSyntaxError, NotEstimableError, ShapeError
from navsym.core.exact import decimal, from_decimal, to_fmpq, upper_end
from navsym.core.numbers import Number
from navsym.guaranteed.search.cones import Cone
from navsym.guaranteed.streaming.exchange import Cloud, exchange
from navsym.guaranteed.streaming.flow import in_row_space, pivot_columns
from navsym.guaranteed.streaming.numbers import read_exact, to_float
from navsym.language.names import quote
from navsym.models.modelfile import NORMS

BITS, DIGITS, PLACES = 320, 24, 60
#: A weight below zero costs so many times what it would as a measurement, where none is allowed; more where that is
#: too little.
FAR = (10**12, 10**24, 10**48)
#: The dual is drawn in by this part of itself before it is rounded, so that it stays admissible noise.
SHRINK = 1 - fmpq(1, 10**50)
#: Weights that cost less than this part of the largest are zero; bounds that differ by less have met.
TINY, CLOSE = arb("1e-60"), arb("1e-20")


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
    def part(self) -> Part:
        """The block as the search takes it."""
        return Part(self.H, self.norm, self.bound)

    def __repr__(self) -> str:
        return f"Block({self.H.nrows()} measurements of {self.H.ncols()} unknowns, {self.norm})"


class Part(NamedTuple):
    """Rows H, a norm and its size, exact; the norm "nonpositive" allows weights that are not negative, for free."""

    H: fmpq_mat
    norm: str
    size: fmpq_mat

    @property
    def cone(self) -> Cone:
        """The allowed noise."""
        return Cone(self.norm, arb_mat(self.size))

    def reach(self) -> list[arb]:
        """The largest that each entry of the noise can be."""
        sizes = self.size.entries()
        return [arb(self.size[j, j]).sqrt() if self.norm == "l2" else arb(sizes[j]) for j in range(self.H.nrows())]

    def cost(self, w: Sequence[fmpq]) -> arb:
        """The largest ``w . r`` of allowed noise. Raises NotEstimableError for weights that are not allowed."""
        if self.norm != "nonpositive":
            return self.cone.cost(arb_mat([[arb(e)] for e in w]))
        if min(w) < 0:
            message = (
                "expected constraints that unbiased weights keep; got some for which the search finds none; loosen them"
            )
            raise NotEstimableError(message, where="solve_blocks: constraints")
        return arb(0)


Constraint = Sequence[Any]
RELATIONS = ("=", "<=", ">=")


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
        raise DomainError(f"expected positive bounds; got {min(sizes)}; mend it", where=where)
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
        rows = [as_list(z, "estimate") for z in as_list(measurements, "estimate")]
        sizes, given = ([len(part) for part in parts] for parts in (self.weights, rows))
        if given != sizes:
            message = f"expected measurements block by block, {sizes} of them; got {given}; complete them"
            raise ShapeError(message, where="estimate")
        pairs = ((w, z) for part, row in zip(self.weights, rows, strict=True) for w, z in zip(part, row, strict=True))
        return to_float(sum((w * read_exact(z, "estimate") for w, z in pairs), fmpq(0)))

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
    constraints: Sequence[Constraint] = (),
) -> BlockEstimator | dict[str, BlockEstimator]:
    """The linear estimate with the least guaranteed error from blocks of vector measurements.

    Minimises ``sum_i max w_i . r_i`` over the noise of each block, subject to ``sum H_i' w_i = P``: second-order cones
    for balls and ellipsoids. Both bounds of the value are exact, and agree to 20 digits as a rule.

    blocks      : :class:`Block`, all of the same unknowns
    target      : P, one number an unknown; or a mapping of names to several, which gives an answer for each
    constraints : (c, "<=", d) with vectors c_i, block by block, and a number: ``sum c_i . w_i <= d``; also ">=" and
                  "=", which (c, d) means, too. The times of a drift and 0 make the estimate blind to it; ones and 0
                  give weights of zero mean; ``>= 0`` for one weight forbids that it is negative

    Unknowns that nobody asks for are nuisance parameters: their entry of P is 0. All may be, where weights of zero do
    not keep the constraints. Raises NotEstimableError, ShapeError,
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
    blocks: Sequence[Block], target: Sequence[Any], constraints: Sequence[Constraint], name: str
) -> BlockEstimator:
    """The answer for one target."""
    stated, functional = state_problem(blocks, target, constraints)
    with precision(BITS):
        weights, dual, costs, value = find_optimum(stated, functional)
        shares = tuple(float((c / sum(costs, arb(0))).mid()) for c in costs[: len(blocks)])
    certificate = write_certificate(stated, functional, weights, dual, value)
    measured = list(zip(stated, weights, strict=True))[: len(blocks)]
    noise = tuple(tuple((block.H * fmpq_mat(len(dual), 1, dual)).entries()) for block, _ in measured)
    return BlockEstimator(name, value, tuple(tuple(w) for _, w in measured), tuple(dual), noise, shares, certificate)


def find_optimum(parts: Sequence[Part], functional: fmpq_mat) -> tuple[list[list[fmpq]], list[fmpq], list[arb], Number]:
    """Unbiased weights, an admissible dual, the costs of the weights block by block, and the bounds that they show."""
    kept = independent_columns(parts, functional)
    narrow = [part._replace(H=fmpq_mat([[row[k] for k in kept] for row in part.H.tolist()])) for part in parts]
    P = fmpq_mat(len(kept), 1, [functional[k, 0] for k in kept])
    for far in FAR:
        x, proposed = propose_optimum(narrow, P, far)
        weights = balance_weights(narrow, P, proposed)
        if all(part.norm != "nonpositive" or w[0] >= 0 for part, w in zip(narrow, weights, strict=True)):
            break
    costs = [part.cost(w) for part, w in zip(narrow, weights, strict=True)]
    whole_cost = sum(costs, arb(0))
    dual, worth = bound_below(narrow, P, x)
    if not whole_cost - worth < whole_cost * CLOSE:
        dual, worth = max((dual, worth), bound_below(narrow, P, touch_noise(narrow, weights)), key=lambda d: d[1])
    whole = [fmpq(0)] * functional.nrows()
    for k, e in zip(kept, dual, strict=True):
        whole[k] = e
    return weights, whole, costs, Number(decimal(worth, DIGITS, -1), upper_end(whole_cost, DIGITS))


def bound_below(parts: Sequence[Part], P: fmpq_mat, x: Sequence[fmpq]) -> tuple[list[fmpq], fmpq]:
    """An admissible dual near a proposed one, and the bound that it shows."""
    dual = admissible_dual(parts, x)
    return dual, sum((e * p for e, p in zip(dual, P.entries(), strict=True)), fmpq(0))


def touch_noise(
    parts: Sequence[Part], weights: Sequence[Sequence[fmpq]], tight: frozenset[int] = frozenset()
) -> list[fmpq]:
    """A dual whose measurements are the noise that costs the weights most, and least, in squares, where these are zero.

    It is the optimum where the weights are, and as few measurements as unknowns, or one block without weights, decide.
    An inequality whose multiplier would have the wrong sign gets none: it is among ``tight``.
    """
    m = parts[0].H.ncols()
    square, rows, sides = arb_mat(m, m), list[list[fmpq]](), list[arb]()
    tight |= {i for i, w in enumerate(weights) if any(w)}
    for i, (part, w) in enumerate(zip(parts, weights, strict=True)):
        square += arb_mat(part.H.transpose()) * part.cone.square() * arb_mat(part.H)
        if i in tight:
            worst = [arb(0)] if part.norm == "nonpositive" else part.cone.worst(arb_mat([[arb(e)] for e in w]))
            used = [k for k, e in enumerate(w) if part.norm != "linf" or e != 0]
            rows, sides = rows + [part.H.tolist()[k] for k in used], sides + [worst[k] for k in used]
    kept = pivot_columns(fmpq_mat(rows).transpose().tolist()) if rows else []
    table = [square.tolist()[i] + [arb(rows[k][i]) for k in kept] for i in range(m)]
    table += [[*map(arb, rows[k]), *[arb(0)] * len(kept)] for k in kept]
    try:
        found = arb_mat(table).solve(arb_mat([[e] for e in [arb(0)] * m + [sides[k] for k in kept]]))
    except ZeroDivisionError:
        return [fmpq(0)] * m
    x = arb_mat([[e.mid()] for e in found.entries()[:m]])
    free = (i for i, part in enumerate(parts) if part.norm == "nonpositive" and i not in tight)
    over = frozenset(i for i in free if (arb_mat(parts[i].H) * x)[0, 0] > 0)
    return touch_noise(parts, weights, tight | over) if over else [to_fmpq(e) for e in x.entries()]


def certify_optimum(parts: Sequence[Part], functional: fmpq_mat) -> dict[str, Any]:
    """The certificate of the optimum, of kind cones."""
    with precision(BITS):
        weights, dual, _, value = find_optimum(parts, functional)
    return write_certificate(parts, functional, weights, dual, value)


def propose_optimum(parts: Sequence[Part], P: fmpq_mat, far: int) -> tuple[list[fmpq], list[list[fmpq]]]:
    """A dual and weights block by block, near the optimum; zeros where none is found, on which nothing rests."""
    ends = [sum(part.H.nrows() for part in parts[:k]) for k in range(len(parts) + 1)]
    spans = list(pairwise(ends))
    rows = [arb_mat([row]) for part in parts for row in part.H.tolist()]
    sigma = [e * (far if part.norm == "nonpositive" else 1) for part in parts for e in part.reach()]
    scaled = np.array([[float((e / s).mid()) for e in v.entries()] for v, s in zip(rows, sigma, strict=True)])
    cones = [
        (p.cone, range(a, b)) for p, (a, b) in zip(parts, spans, strict=True) if p.norm in ("l1", "l2") and b > a + 1
    ]
    cloud = Cloud(rows, sigma, scaled, cones=cones)
    if parts[-1].norm == "nonpositive":  # a weight w costs sigma (|w| - w)
        free = [part.norm == "nonpositive" for part in parts for _ in range(part.H.nrows())]
        cloud.offset = [-s if one else arb(0) for s, one in zip(sigma, free, strict=True)]
        cloud.shifted = -np.array(free, dtype=float)
    with np.errstate(all="ignore"):  # doubles only say where to look
        found = exchange(cloud, arb_mat(P.transpose()), cloud.start() or [])
    if found is None or found.ray is not None:
        return [fmpq(0)] * P.nrows(), [[fmpq(0)] * (b - a) for a, b in spans]
    weights = [cloud.spread(found).get(k, arb(0)).mid() for k in range(len(rows))]
    sizes = [(abs(w) * s).mid() for w, s in zip(weights, sigma, strict=True)]
    seen = max(sizes) * TINY
    flat = [to_fmpq(w) if size > seen else fmpq(0) for w, size in zip(weights, sizes, strict=True)]
    return [to_fmpq(e.mid()) for e in found.dual.entries()], [flat[a:b] for a, b in spans]


def state_problem(
    blocks: Sequence[Block], target: Sequence[Any], constraints: Sequence[Constraint]
) -> tuple[list[Part], fmpq_mat]:
    """Regressors with a column for each constraint, and the functional. Raises ShapeError, EmptyError, DomainError.

    What an inequality leaves is a weight of its own, which must not be negative: ``sum c_i . w_i + w = d``.
    """
    if not isinstance(blocks, list | tuple) or not all(isinstance(block, Block) for block in blocks):
        message = f"expected a list of blocks; got {quote(blocks)}; write [nav.Block(...), ...]"
        raise ExpressionSyntaxError(message, where="solve_blocks: blocks")
    P = [read_exact(p, "solve_blocks: target") for p in as_list(target, "solve_blocks: target")]
    if not blocks or not P:
        raise EmptyError("expected blocks and a target; got none; give at least one of each", where="solve_blocks")
    parts, left, free = [block.part for block in blocks], {}, not any(P)
    for part in parts:
        if part.H.ncols() != len(P):
            message = f"expected {len(P)} unknowns in each block; got {part.H.ncols()}; complete the rows"
            raise ShapeError(message, where="solve_blocks: blocks")
    for constraint in constraints:
        columns, relation, bound = read_constraint(constraint, [int(part.H.nrows()) for part in parts])
        free = free and (bound == 0 or relation == ("<=" if bound > 0 else ">="))
        tables = [zip(part.H.tolist(), c, strict=True) for part, c in zip(parts, columns, strict=True)]
        wider = [fmpq_mat([[*row, e] for row, e in table]) for table in tables]
        parts = [part._replace(H=H) for part, H in zip(parts, wider, strict=True)]
        if relation != "=":
            largest = max((abs(e) for c in columns for e in c), default=fmpq(0)) or fmpq(1)
            left[len(P)] = fmpq(1 if relation == "<=" else -1) * largest
        P.append(bound)
    if free:
        raise DomainError("expected a target that is not zero; got zeros; every estimate of it is free", where="target")
    reach = max(to_fmpq(e.upper()) for part in parts for e in part.reach())
    for k, sign in left.items():
        row = fmpq_mat(1, len(P), [sign if j == k else fmpq(0) for j in range(len(P))])
        parts.append(Part(row, "nonpositive", fmpq_mat(1, 1, [reach])))
    return parts, fmpq_mat(len(P), 1, P)


def read_constraint(constraint: Any, sizes: Sequence[int]) -> tuple[list[list[fmpq]], str, fmpq]:
    """Factors block by block, a relation and a number. Raises ShapeError and DomainError."""
    where = "solve_blocks: constraints"
    given = as_list(constraint, where)
    if len(given) == 2:
        given.insert(1, "=")
    if len(given) != 3 or given[1] not in RELATIONS:
        message = f'expected (factors, "<=", number), or with ">=" or "="; got {quote(constraint)}; write all three'
        raise DomainError(message, where=where)
    factors, relation, bound = given
    columns = [[read_exact(e, where) for e in as_list(part, where)] for part in as_list(factors, where)]
    if [len(part) for part in columns] != list(sizes):
        message = "expected a number for each measurement of each block; got others; complete them"
        raise ShapeError(message, where=where)
    return columns, relation, read_exact(bound, where)


def stack(parts: Sequence[Part]) -> fmpq_mat:
    """All regressors, one row for each measurement."""
    return fmpq_mat([row for part in parts for row in part.H.tolist()])


def independent_columns(parts: Sequence[Part], functional: fmpq_mat) -> list[int]:
    """Unknowns in which unbiased weights are unbiased in all. Raises NotEstimableError."""
    H = stack(parts)
    if not in_row_space(functional.entries(), H.tolist()):
        raise NotEstimableError(
            f"the target is not estimable from these {H.nrows()} measurements: it does not lie in the row space of the "
            f"regressors (rank {H.rank()} of {H.ncols()}); add measurements or estimate fewer unknowns"
        )
    return pivot_columns(H.tolist())


def balance_weights(parts: Sequence[Part], P: fmpq_mat, proposed: Sequence[Sequence[fmpq]]) -> list[list[fmpq]]:
    """The weights, rounded and made exactly unbiased on rows that carry the largest of them."""
    flat, rows = [decimal_of(e) for w in proposed for e in w], stack(parts).tolist()
    order = sorted(range(len(flat)), key=lambda k: -abs(flat[k]))
    used = [k for k in order if flat[k] != 0]
    for some in (used, order):  # a weight that is zero stays so where it may
        table = [[rows[k][i] for k in some] + [P[i, 0]] for i in range(P.nrows())]
        if (picked := pivot_columns(table)) and picked[-1] < len(some):
            break
    rest = P - stack(parts).transpose() * fmpq_mat(len(flat), 1, flat)
    picked = [some[k] for k in picked]
    kept = pivot_columns([rows[k] for k in picked])
    square = fmpq_mat([[rows[k][i] for k in picked] for i in kept])
    for k, e in zip(picked, square.solve(fmpq_mat([[rest[i, 0]] for i in kept])).entries(), strict=True):
        flat[k] += e
    ends = [sum(part.H.nrows() for part in parts[:k]) for k in range(len(parts) + 1)]
    return [flat[a:b] for a, b in pairwise(ends)]


def decimal_of(x: fmpq) -> fmpq:
    """The number rounded to PLACES digits."""
    return from_decimal(decimal(x, PLACES))


def admissible_dual(parts: Sequence[Part], x: Sequence[fmpq]) -> list[fmpq]:
    """The dual scaled and rounded, so that all its measurements are admissible noise exactly."""
    rounded, worst = [decimal_of(e) for e in x], arb(0)
    for part in parts:
        if part.norm == "nonpositive":
            k = next(k for k, e in enumerate(part.H.entries()) if e != 0)
            rounded[k] = min(rounded[k] * part.H[0, k], fmpq(0)) / part.H[0, k]
    column = fmpq_mat(len(x), 1, rounded)
    for part in parts:
        if part.norm != "nonpositive":
            worst = worst.max(part.cone.gauge(arb_mat(part.H * column)))
    factor = to_fmpq((SHRINK / worst).lower()) if worst > 0 else fmpq(1)
    scale = from_decimal(decimal(factor, PLACES, -1))
    return [e * scale for e in rounded]


def write_certificate(
    parts: Sequence[Part], functional: fmpq_mat, weights: Sequence[Sequence[fmpq]], dual: Sequence[fmpq], value: Number
) -> dict[str, Any]:
    """The certificate of kind cones."""
    text = lambda numbers: [str(e) for e in numbers]  # noqa: E731
    blocks = [
        {
            "H": [text(row) for row in part.H.tolist()],
            "norm": part.norm,
            "size": [] if part.norm == "nonpositive" else [text(row) for row in part.size.tolist()],
            "weights": text(w),
        }
        for part, w in zip(parts, weights, strict=True)
    ]
    ends = {"lower": value.lower, "upper": value.upper, "bits": BITS}
    return {"kind": "cones", "blocks": blocks, "functional": text(functional.entries()), "dual": text(dual)} | ends
