"""How well a flight shows the state: the bound of Cramer and Rao for every target, in certified balls.

Without process noise the least variance of an unbiased estimate of ``p x`` at the end of a flight is ``p M^-1 p`` with
the information ``M = Phi^-T W Phi^-1`` on the last state: what a Kalman smoother without a prior reaches. Where some
directions are never shown, ``p`` has to vanish along them, and M is taken on as many states as its rank says. The
weakest direction has the largest deviation when each state counts in a unit of its own.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp
from flint import arb, arb_mat, ctx, fmpq, fmpq_mat

from navsym.claims.display import write_card, write_table
from navsym.core.answers import Answer
from navsym.core.balls import enclose, precision
from navsym.core.errors import DomainError, EmptyError, UnknownSymbolError
from navsym.core.exact import decimal, from_decimal, lower_end, to_fmpq, upper_end
from navsym.core.numbers import Number
from navsym.language.names import quote, suggest_nearest
from navsym.language.values import read_constant
from navsym.models.modelfile import ModelFile
from navsym.observability.certificates import is_granted
from navsym.observability.chains import JointObservability, need_observable
from navsym.observability.flight import Flight, Reach, flight_of
from navsym.observability.ring import Ring

#: Working precisions, one after the other, digits of an answer, times of the history, and halvings of a search.
BITS, DIGITS, NODES, HALVINGS = (256, 512, 1024, 2048), 15, 24, 24
#: Squarings of the power iteration; and values that are in SI.
ROUNDS = 48
NO_UNITS: Mapping[str, str] = {}


@dataclass(frozen=True, slots=True)
class TargetAccuracy:
    """What a flight says of one functional of the last state.

    status    : "certified", "unobservable" (it is never known), or "open"
    deviation : of the best unbiased estimate, where that is certified
    reached   : a time at which the deviation is certified to be at most the demand; at ``before`` it is larger
    """

    name: str
    status: str
    deviation: Number | None = None
    demand: str | None = None
    reached: str | None = None
    before: str | None = None

    def document(self) -> dict[str, Any]:
        """The target as plain data."""
        ends = self.deviation.document() if self.deviation is not None else {"lower": None, "upper": None}
        searched = {"demand": self.demand, "reached": self.reached, "before": self.before}
        return {"target": self.name, "status": self.status, **ends, **(searched if self.demand is not None else {})}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Accuracy(Answer):
    """The accuracy that a flight allows, target by target.

    targets   : in the order of the model
    weakest   : state -> component of the direction with the largest deviation; ``scales`` gives each state its unit
    deviation : along this direction in these units; None where a direction is never shown, or it was not enclosed
    history   : (time, target -> deviation, weakest direction, its deviation), in doubles
    question, information : what was asked, and what is known at the end
    """

    name: str
    end: str
    targets: tuple[TargetAccuracy, ...]
    weakest: Mapping[str, float]
    deviation: Number | None
    history: tuple[tuple[float, Mapping[str, float], Mapping[str, float], float], ...]
    question: Question
    information: Information | None

    def document(self) -> dict[str, Any]:
        """The key ``accuracy`` of the document of ``navsym observe``."""
        deviation = self.deviation.document() if self.deviation is not None else None
        return {
            "at": self.end,
            "targets": [target.document() for target in self.targets],
            "weakest": {"direction": dict(self.weakest), "deviation": deviation},
        }

    def certificates(self) -> list[Mapping[str, Any]]:
        """Two for each certified target: all information matrices in the ball give deviations within its bounds."""
        names = [target.name for target in self.targets if target.deviation is not None]
        known = self.information
        found = [certify(known, self.question.targets[name]) for name in names if known is not None]
        return [item for item in found if item is not None]

    def __repr__(self) -> str:
        words = ", ".join(f"{target.name} {target.deviation or target.status}" for target in self.targets)
        return f"Accuracy({self.name} at t = {self.end}: {words})"

    def _repr_html_(self) -> str:
        """Targets with their deviations, for notebooks."""
        rows = [(t.name, str(t.deviation or t.status), t.reached or "") for t in self.targets]
        return write_card([write_table(("target", "standard deviation", "demand met at"), rows)])


@dataclass(frozen=True, slots=True, eq=False)
class Information:
    """M at a time on states that show as much as all: their places, and the inverse of this block."""

    places: list[int]
    block: arb_mat
    inverse: arb_mat

    def variance(self, p: Sequence[arb]) -> arb:
        """p M^-1 p of a functional that vanishes along all directions that are not shown."""
        row = arb_mat([[p[k] for k in self.places]])
        return (row * self.inverse * row.transpose())[0, 0]


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """What is asked of a flight.

    targets : name -> functional of the state;  scales : unit of each state;  demands : target -> wanted deviation
    unseen  : (k, n) directions that are never shown, in what moves
    """

    flight: Flight
    states: Sequence[str]
    targets: Mapping[str, Sequence[sp.Expr]]
    unseen: sp.ImmutableMatrix
    scales: Sequence[fmpq]
    demands: Mapping[str, fmpq]
    end: fmpq

    def answer(self, name: str) -> Accuracy:
        """The answer at the least precision that encloses all deviations well."""
        for bits in BITS[:1] if self.flight.is_moving else BITS:
            with precision(bits):
                found = self.answer_in_balls(name)
            if all(t.status == "unobservable" or is_narrow(t.deviation) for t in found.targets):
                break
        return found

    def answer_in_balls(self, name: str) -> Accuracy:
        """The answer at the working precision."""
        path = self.list_nodes()
        last, listed = self.information(path[-1]), list[TargetAccuracy]()
        for target, p in self.targets.items():
            status = self.status_of(p, path[-1]) if last is not None else "open"
            found = TargetAccuracy(target, status)
            if status == "certified" and last is not None:
                found = replace(found, deviation=as_number(last.variance(self.balls(p)).sqrt()))
                if target in self.demands:
                    found = self.search(found, path)
            listed.append(found)
        history = tuple(filter(None, (self.describe(reach) for reach in path)))
        full = self.unseen.rows == 0 and last is not None
        weakest = {} if not history else history[-1][2]
        deviation = as_number(largest_eigenvalue(self.scaled(last))[0].sqrt()) if full and last is not None else None
        return Accuracy(name, write_time(self.end), tuple(listed), weakest, deviation, history, self, last)

    def list_nodes(self) -> list[Reach]:
        """The flight at times that are evenly spread; of a model in steps at whole ones."""
        count = min(NODES, int(self.end.ceil())) if self.flight.steps else NODES
        times = [self.end * fmpq(k, count) for k in range(1, count + 1)]
        path = [self.flight.start()]
        for t in sorted({fmpq(t.ceil()) if self.flight.steps else t for t in times}):
            path.append(self.flight.advance(path[-1], t))
        return path

    def balls(self, p: Sequence[sp.Expr], values: Mapping[sp.Symbol, arb] | None = None) -> list[arb]:
        """A functional or a direction in balls."""
        return [enclose(entry, values, bits=ctx.prec) for entry in p]

    def information(self, reach: Reach) -> Information | None:
        """M by pivots; None where the balls do not show its rank."""
        try:
            back = reach.Phi.inv()
        except ZeroDivisionError:
            return None
        M = back.transpose() * reach.W * back
        unseen = arb_mat([self.balls(self.unseen.row(k), reach.values) for k in range(self.unseen.rows)] or [[arb(1)]])
        places = pivot_places(M, self.scales, len(self.states) - self.unseen.rows)
        if not (unseen * unseen.transpose()).det() > 0:  # directions that degenerate there
            return None
        if places is None:
            return None
        block = arb_mat([[M[i, j] for j in places] for i in places])
        return Information(places, block, block.inv())

    def status_of(self, p: Sequence[sp.Expr], reach: Reach) -> str:
        """Whether a functional vanishes along all directions that are never shown."""
        products = [
            sum((a * b for a, b in zip(p, self.unseen.row(k), strict=True)), sp.Integer(0))
            for k in range(self.unseen.rows)
        ]
        left = [value for value in products if Ring.of([value]).quotient(value).top != 0]
        if not left:
            return "certified"
        values = [enclose(value, reach.values, bits=ctx.prec) for value in left]
        return "unobservable" if any(v.is_finite() and not v.contains(0) for v in values) else "open"

    def scaled(self, found: Information) -> arb_mat:
        """The covariance of all states in their units."""
        units = [self.scales[k] for k in found.places]
        C = found.inverse.tolist()
        return arb_mat([[C[i][j] / arb(a * b) for j, b in enumerate(units)] for i, a in enumerate(units)])

    def describe(self, reach: Reach) -> tuple[float, Mapping[str, float], Mapping[str, float], float] | None:
        """One time of the history."""
        found = self.information(reach)
        if found is None:
            return None
        shown = {t: p for t, p in self.targets.items() if self.status_of(p, reach) == "certified"}
        deviations = {t: float(found.variance(self.balls(p)).sqrt().mid()) for t, p in shown.items()}
        time = float(to_fmpq(reach.at).p) / float(reach.at.q)
        if self.unseen.rows:
            return time, deviations, {}, float("inf")
        variance, direction = largest_eigenvalue(self.scaled(found))
        named = {self.states[k]: x for k, x in zip(found.places, direction, strict=True)}
        return time, deviations, {s: named[s] for s in self.states}, float(variance.sqrt().mid())

    # Time until a demand is met

    def search(self, found: TargetAccuracy, path: Sequence[Reach]) -> TargetAccuracy:
        """The first node at which the demand is met, and halvings between it and the last at which it is not."""
        demand, p = self.demands[found.name], self.balls(self.targets[found.name])
        verdicts = [self.is_met(reach, p, demand) for reach in path]
        found = replace(found, demand=write_time(demand))
        if True not in verdicts:
            return replace(found, before=write_time(self.end) if verdicts[-1] is False else None)
        place = verdicts.index(True)
        if place == 0 or verdicts[place - 1] is not False:
            return replace(found, reached=write_time(path[place].at))
        low, high = path[place - 1], path[place].at
        for _ in range(HALVINGS):
            middle = (low.at + high) / 2
            if self.flight.steps:
                middle = fmpq(middle.floor())
            if middle in (low.at, high):
                break
            reach = self.flight.advance(low, middle)
            met = self.is_met(reach, p, demand)
            if met is None:
                break
            low, high = (low, middle) if met else (reach, high)
        return replace(found, reached=write_time(high), before=write_time(low.at))

    def is_met(self, reach: Reach, p: Sequence[arb], demand: fmpq) -> bool | None:
        """Whether the deviation is at most the demand at a time; None where it is not decided."""
        found = self.information(reach)
        if found is None:
            return False if reach.at == 0 and self.flight.every is None else None
        variance, most = found.variance(p), arb(demand**2)
        return True if variance <= most else False if variance > most else None


# From arguments


def ask_accuracy(
    contents: ModelFile,
    joint: JointObservability,
    rates: Iterable[sp.Symbol],
    T: Any,
    every: Any,
    demands: Mapping[str, Any],
    scales: Mapping[str, Any],
    start: Mapping[str, Any],
) -> Question:
    """The question about a flight; arguments as in :meth:`Observability.accuracy`."""
    where, moving, n = "accuracy", {s.name: s for s in rates}, len(contents.states)
    own = {name: parameter.unit for name, parameter in contents.parameters.items()}
    end = read_values({"T": T}, ["T"], where, own)["T"] if T is not None else contents.T
    if end is None:
        raise EmptyError("expected the length of the flight; got no interval; give T", where=where)
    if contents.pieces[1:]:
        need_observable(joint)
    states = {name: [sp.Integer(i == k) for i in range(n)] for k, name in enumerate(contents.states)}
    targets = contents.targets or states
    step = None if every is None else read_values({"every": every}, ["every"], where)["every"]
    units = {name: sp.Integer(1) for name in states} | read_values(scales, states, f"{where}: scales")
    wanted = read_values(demands, targets, f"{where}: demands")
    for name, value in {"T": end, "every": step or end, **units, **wanted}.items():
        if not (value.is_Rational and value > 0):
            message = f"expected a positive fraction; got {quote(str(value))}; give one"
            raise DomainError(message, where=f"{where}: {name}")
    first = {moving[name]: value for name, value in read_values(start, moving, f"{where}: start", own).items()}
    flight = flight_of(contents, first, to_fmpq(end), None if step is None else to_fmpq(step), where)
    if flight.steps and not end.is_Integer:
        raise DomainError(f"expected a whole number of steps; got {end}; round it", where=f"{where}: T")
    sizes = [to_fmpq(unit) for unit in units.values()]
    met = {name: to_fmpq(value) for name, value in wanted.items()}
    return Question(flight, contents.states, targets, joint.unobservable, sizes, met, to_fmpq(end))


def read_values(
    given: Mapping[str, Any], known: Collection[str], where: str, units: Mapping[str, str] = NO_UNITS
) -> dict[str, sp.Expr]:
    """Exact numbers by name, in their units. Raises UnknownSymbolError for a name that is not among the known ones."""
    for name in given:
        if name not in known:
            remedy = suggest_nearest(str(name), known)
            raise UnknownSymbolError(f"expected a name of the model; got {quote(str(name))}; {remedy}", where=where)
    return {name: read_constant(value, f"{where}: {name}", units.get(name, "")) for name, value in given.items()}


def is_narrow(value: Number | None) -> bool:
    """True for an enclosure that needs no higher precision."""
    return value is not None and value.digits >= DIGITS - 3


def as_number(value: arb) -> Number | None:
    """The enclosure in decimals; None where the ball is not finite."""
    return Number(lower_end(value, DIGITS), upper_end(value, DIGITS)) if value.is_finite() else None


def write_time(value: fmpq) -> str:
    """A fraction as text: decimals where they end soon."""
    text = decimal(value, DIGITS)
    return text if fmpq(sp.Rational(text).p, sp.Rational(text).q) == value else str(value)


def pivot_places(M: arb_mat, scales: Sequence[fmpq], rank: int) -> list[int] | None:
    """Places of ``rank`` states on which M is positive definite, in order; None where the balls do not show it.

    Symmetric elimination by the largest pivot in the units of the states.
    """
    rest, free, chosen = M.tolist(), list(range(M.nrows())), list[int]()
    for _ in range(rank):
        k = max(free, key=lambda i: float((rest[i][i] * arb(scales[i] ** 2)).mid()))
        pivot = rest[k][k]
        if not pivot > 0:
            return None
        chosen.append(k)
        free.remove(k)
        for i in free:
            share = rest[i][k] / pivot
            rest[i] = [x - share * y for x, y in zip(rest[i], rest[k], strict=True)]
    return sorted(chosen)


def largest_eigenvalue(C: arb_mat) -> tuple[arb, list[float]]:
    """The largest eigenvalue of a covariance in a ball, and its direction in doubles.

    ``tr C^m / n <= lambda^m <= tr C^m``, where m doubles with each squaring; numbers s are taken out on the way.
    """
    n, value = C.nrows(), arb(0)
    for k in range(ROUNDS):
        size = C.trace().mid()
        C = C * (1 / size)
        value += size.log() / 2**k
        C = C * C
    trace = C.trace()
    value = (value + (trace / n).log().union(trace.log()) / 2**ROUNDS).exp()
    column = max(range(n), key=lambda k: float(C[k, k].mid()))
    x = [float(C[k, column].mid()) for k in range(n)]
    size = sum(v * v for v in x) ** 0.5
    return value, [v / size for v in x]


# Certificates


def certify(found: Information, p: Sequence[sp.Expr]) -> dict[str, Any] | None:
    """That M between two rational matrices gives a deviation between two numbers; None where none is granted.

    With a diagonal E above the radii, M lies between ``M - E`` and ``M + E``, and a deviation falls where information
    grows. Each end is the least cost of weights with ``M w = p`` in noise of covariance M: the kind ``cones``.
    """
    if not all(entry.is_Rational for entry in p):
        return None
    functional = [to_fmpq(p[k]) for k in found.places]
    for bits in (96, 192, 384, 768):
        middle, reach = round_block(found.block, bits)
        sides = [least_deviation(middle + sign * reach, functional) for sign in (1, -1)]
        item = {"kind": "all", "of": [side for side in sides if side is not None]}
        if len(item["of"]) == 2 and is_granted(item):
            return item
    return None


def round_block(block: arb_mat, bits: int) -> tuple[fmpq_mat, fmpq_mat]:
    """A rational matrix near a block, and the diagonal E: ``|r x y| <= (r/2) (x**2 u/v + y**2 v/u)`` in units u, v."""
    n = block.nrows()
    sizes = [
        int(to_fmpq(block[k, k]).ceil()).bit_length() // 2
        if block[k, k] > 1
        else -((1 / to_fmpq(block[k, k])).ceil().bit_length() // 2)
        for k in range(n)
    ]
    middle, radius = fmpq_mat(n, n), fmpq_mat(n, n)
    for i in range(n):
        for j in range(n):
            grid = fmpq(2) ** (sizes[i] + sizes[j] - bits)
            middle[i, j] = (to_fmpq(block[min(i, j), max(i, j)]) / grid).floor() * grid
            reach = 2 * grid + to_fmpq(block[i, j].rad()) + to_fmpq(block[j, i].rad())
            radius[i, i] += reach * fmpq(2) ** (sizes[i] - sizes[j])
    return middle, radius


def least_deviation(M: fmpq_mat, p: Sequence[fmpq]) -> dict[str, Any] | None:
    """The certificate for one rational information matrix; None for one that is not positive."""
    n = M.nrows()
    try:
        weights = M.solve(fmpq_mat(n, 1, list(p))).entries()
    except ZeroDivisionError:
        return None
    variance = sum((a * b for a, b in zip(p, weights, strict=True)), fmpq(0))
    if variance <= 0:
        return None
    with precision(BITS[0]):
        root = arb(variance).sqrt()
    lower, upper = lower_end(root, DIGITS), upper_end(root, DIGITS)
    rows = [[str(x) for x in row] for row in M.tolist()]
    block = {"H": rows, "norm": "l2", "size": rows, "weights": [str(w) for w in weights]}
    dual = [str(w / from_decimal(upper_end(root, 2 * DIGITS))) for w in weights]
    functional = [str(x) for x in p]
    ends = {"lower": lower, "upper": upper, "bits": BITS[0]}
    return {"kind": "cones", "blocks": [block], "functional": functional, "dual": dual, **ends}
