"""Design: the instants, sensors and grades of sensors within a budget whose guaranteed error is least, with a proof.

A selection buys sensors and instants, and may use the rows whose needs it bought. Its error is ``min sum sigma |w|``
over unbiased weights on these rows. A dual x with ``|h . x| <= sigma`` on the rows of a selection bounds its error from
below by ``x . P``: so whoever has a smaller error buys, for each dual, the needs of a row at which that dual fails.
Duals are collected until no purchase within the budget does so for all of them (implicit hitting sets; Moreno-Centeno
and Karp 2013).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count, pairwise, product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.claims import CERTIFIED, OPEN, Status
from navsym.claims.display import write_card, write_table
from navsym.core.answers import Answer, named, plain
from navsym.core.balls import precision
from navsym.core.errors import (
    DomainError,
    DuplicateError,
    EmptyError,
    NotEstimableError,
    TooLargeError,
    UnknownSymbolError,
)
from navsym.core.exact import decimal, from_decimal, lower_end, to_rational, upper_end
from navsym.core.numbers import Number
from navsym.guaranteed.baselines import LP_SOLVERS, Comparison, compare_on_grid
from navsym.guaranteed.convex import GridProblem
from navsym.guaranteed.problem import list_sums
from navsym.guaranteed.search.cones import largest
from navsym.guaranteed.streaming.exchange import Cloud, Optimum, bounds_of, exchange, rehearse, solve_basis, to_doubles
from navsym.guaranteed.streaming.flow import BITS, Flow, name_measurements
from navsym.guaranteed.streaming.guard import whole_number
from navsym.guaranteed.streaming.memory import Row
from navsym.guaranteed.streaming.numbers import read_exact
from navsym.language.expression import to_text
from navsym.language.files import file_in_errors, name_file
from navsym.language.names import quote, suggest_nearest
from navsym.language.schema import as_table, expect_keys
from navsym.language.tomlfile import read_toml
from navsym.models.model import contents_of
from navsym.models.modelfile import BasisFile, Measurement, ModelFile

Needs = frozenset[str]


MOST_ROWS, MOST_DUALS, MOST_CELLS = 400, 3000, 80_000
MOST_DIGITS = 40
#: A weight beside the rows costs so many times what the dual of a basis is worth; more where no selection costs less.
FAR = (10**6, 10**18, 10**36)
#: Parts of the way at which a slope in time is taken, in seconds: its error is of this order.
STEP = fmpq(1, 2**60)
ORDERS = 3


class Offer(NamedTuple):
    """A measurement that may be had at every instant: its place in the model, what it needs, and its own bound."""

    place: int
    needs: Needs
    own: fmpq | None


@dataclass(frozen=True, slots=True)
class DesignPoint:
    """One measurement of a design.

    at, measurement, sigma : where it stands, and its noise bound, as exact text
    weight : in units of the target per unit of the measurement
    share  : part of the value: with this bound 1 % larger the value grows by 1 % of it, to first order; for independent
             errors these are the shares of repetitions with the least variance (Elfving 1952)
    slope  : how the value changes with this instant, per unit of time, to first order; None where fewer measurements
             than unknowns have a weight, because the dual is then not unique
    """

    at: str
    measurement: str
    sigma: str
    weight: float
    share: float
    slope: float | None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Design(Answer):
    """The selection within a budget whose guaranteed error is least.

    value       : enclosure of that error; its lower bound holds for every selection within the budget
    bought      : what the selection needs: instants as "t = 1/2", sensors by name, grades as "name 1/2"
    cost        : what that costs, at most the budget
    points      : measurements with a weight, see :class:`DesignPoint`
    status      : CERTIFIED where the two bounds meet, else OPEN
    certificate : plain data that the independent checker replays, kind "design"
    grid        : all measurements that are bought, in doubles

    >>> import navsym as nav
    >>> model = nav.Model(states="x v", F=[["0", "1"], ["0", "0"]], H=["x"], targets={"v": "v"})
    >>> found = nav.design(model, times=range(5), budget=2)
    >>> found.bought, found.points[0].share, found.points[0].slope, found.check()
    (('t = 0', 't = 4', 'z1'), 0.5, 0.125, <1 checked, all ACCEPTED>)
    """

    target: str
    value: Number
    bought: tuple[str, ...]
    cost: str
    points: tuple[DesignPoint, ...]
    status: Status
    certificate: Mapping[str, Any]
    grid: GridProblem

    def compare(
        self, solvers: Sequence[str] = LP_SOLVERS, progress: Callable[[str], None] = lambda solver: None
    ) -> Comparison:
        """Least squares, the Kalman filter and general solvers on the measurements that are bought: ``--compare``.

        solvers, progress : as for :meth:`Estimator.compare`
        """
        return compare_on_grid(self.grid, self.grid, float(self.value.upper), solvers, progress)

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym solve --design``."""
        head = named(self, "target status value bought cost")
        return head | {"support": plain(self.points)} | named(self, "certificate")

    def __repr__(self) -> str:
        where = ", ".join(f"{p.measurement} at {p.at}" for p in self.points)
        return f"Design({quote(self.target)[1:-1]}: {self.value}, cost {self.cost}: {where}; {self.status})"

    def _repr_html_(self) -> str:
        names = DesignPoint.__slots__
        rows = [tuple(str(getattr(p, n)) for n in names) for p in self.points]
        return write_card([repr(self), write_table(names, rows)], str(self.status))


def design(
    model: Any,
    target: str | None = None,
    *,
    times: Sequence[Any] | None = None,
    budget: Any = None,
    instant: Any = 1,
    sensors: Mapping[str, Any] | None = None,
    digits: int = 30,
    values: Mapping[str, Any] | None = None,
) -> Design:
    """The instants, sensors and noise bounds within a budget that have the least guaranteed error of a target.

    The target is that of the last of the times. Every measurement needs its instant and its sensor, each bought once.
    The value is proved to be the least of all selections within the budget: certificate of kind "design".

    model   : a :class:`navsym.Model`, or the path of a model file, whose table [design] holds what is left out here
    times   : instants to choose from
    budget  : what all that is bought may cost
    instant : what an instant costs
    sensors : measurement -> its cost, or a list of grades (noise bound, cost); those left out are not used; by default
              all, free of charge, so that the budget counts instants
    digits  : certified digits of the value, 1 to 40

    Raises NotEstimableError where no selection within the budget is seen to show the target.

    >>> import navsym as nav
    >>> model = nav.Model(states="x v", F=[["0", "1"], ["0", "0"]], H=["x", "v"], targets={"start": "x - 4*v"})
    >>> nav.design(model, times=range(5), budget=6, sensors={"z1": 1, "z2": [("2", 1), ("1/2", 4)]})
    Design(start: 1, cost 2: z1 at 0; CERTIFIED)
    """
    with file_in_errors(model):
        if isinstance(model, str | os.PathLike) and times is None:
            table = as_table(read_toml(model).get("design", {}), f"{name_file(model)}: design")
            expect_keys(table, ("times", "budget", "instant", "sensors"), f"{name_file(model)}: design")
            if "times" in table and "budget" in table:
                return design(Path(model), target, digits=digits, values=values, **table)
        if times is None or budget is None:
            message = "expected times and a budget; got none; give both, or a table [design] in the model file"
            raise EmptyError(message, where="design")
        whole_number(digits, 1, MOST_DIGITS, "design: digits")
        with precision(BITS):
            contents = contents_of(model, values, {}, "design")
            offers, prices = read_offers(contents, sensors)
            contents, sums = add_sums(contents, offers)
            flow = Flow(contents, target, "design")
            rows, needs, prices = list_candidates(flow, times, instant, [*offers, *sums], prices)
            limit = read_exact(budget, "design: budget")
            return search_far(flow, rows, needs, prices, limit, digits)


def search_far(
    flow: Flow, rows: list[Row], needs: list[Needs], prices: dict[str, fmpq], budget: fmpq, digits: int
) -> Design:
    """The best selection, first among those whose errors are not far above that of all rows."""
    found = None
    for far in FAR:
        try:
            market = Market(flow, rows, needs, prices, budget, digits, far)
            found = market, market.search()
        except (np.linalg.LinAlgError, ZeroDivisionError):
            break
        if market.best is not None:
            break
    if found is None:
        message = "expected regressors of like size; got some that doubles do not tell apart; scale the unknowns"
        raise TooLargeError(message, where="design")
    return found[0].answer(found[1])


def read_offers(
    contents: ModelFile | BasisFile, sensors: Mapping[str, Any] | None
) -> tuple[list[Offer], dict[str, fmpq]]:
    """Measurements on offer and what they cost. Raises DomainError and UnknownSymbolError."""
    if not isinstance(sensors, Mapping | None):
        message = "expected a mapping of sensors to costs; got another value; write one"
        raise DomainError(message, where="design")
    names = name_measurements(contents)
    prices, offers = dict[str, fmpq](), list[Offer]()
    for name, offer in (dict.fromkeys(names, 0) if sensors is None else sensors).items():
        if name not in names:
            hint = suggest_nearest(name, names)
            message = f"expected a measurement of the model; got {quote(name)}; correct it: {hint}"
            raise UnknownSymbolError(message, where="design: sensors")
        where = f"design: sensors.{name}"
        grades: Sequence[Any] = offer if isinstance(offer, list | tuple) else [(None, offer)]
        for grade in grades:
            if not isinstance(grade, list | tuple) or len(grade) != 2:
                message = f"expected a pair (noise bound, cost); got {quote(grade)}; write two numbers"
                raise DomainError(message, where=where)
            own = None if grades is not offer else read_exact(grade[0], where)
            if own is not None and own <= 0:
                raise DomainError(f"expected a positive noise bound; got {quote(grade[0])}; correct it", where=where)
            item = name if own is None else f"{name} {own}"
            if item in prices:
                message = f"expected different noise bounds; got {quote(grade[0])} twice; keep the cheaper grade"
                raise DuplicateError(message, where=where)
            prices[item] = read_exact(grade[1], where)
            offers.append(Offer(names.index(name), frozenset({item}), own))
    return offers, prices


def add_sums(contents: ModelFile | BasisFile, offers: Sequence[Offer]) -> tuple[ModelFile | BasisFile, list[Offer]]:
    """The model with sums of measurements in place of blocks of norm "l1", for each choice of members on offer."""
    if isinstance(contents, BasisFile) or not contents.blocks:
        return contents, []
    measurements, sums = [*contents.measurements], list[Offer]()
    for block in contents.blocks:
        if block.norm == "linf" or len(block.names) == 1:
            continue
        if block.norm == "l2":
            message = 'expected blocks with "l1" or "linf" in a design; got "l2", which no finite list of rows states'
            raise DomainError(f'{message}; choose "l1", or ask solve_blocks for each selection', where="design: model")
        each = [[None, *(o for o in offers if contents.measurements[o.place].name == name)] for name in block.names]
        for chosen in product(*each):
            members = [o for o in chosen if o is not None]
            rows = [contents.measurements[o.place] for o in members]
            graded = zip(rows, members, strict=True)
            rows = [m if o.own is None else Measurement(" ".join(o.needs), m.h, to_rational(o.own)) for m, o in graded]
            for one in list_sums(rows) if len(rows) > 1 else ():
                sums.append(Offer(len(measurements), frozenset().union(*(o.needs for o in members)), None))
                measurements.append(one)
    return replace(contents, measurements=tuple(measurements), blocks=()), sums


def list_candidates(
    flow: Flow, times: Sequence[Any], instant: Any, offers: Sequence[Offer], sensors: Mapping[str, fmpq]
) -> tuple[list[Row], list[Needs], dict[str, fmpq]]:
    """All rows that may be bought, what each needs, and what things cost. Raises DomainError, TooLargeError."""
    if isinstance(times, str) or not isinstance(times, Iterable):
        message = "expected a list of times; got another value; write one"
        raise DomainError(message, where="design")
    at = sorted(read_exact(t, "design: times") for t in times)
    twice = next((a for a, b in pairwise(at) if a == b), None)
    if twice is not None:
        message = f"expected different times; got {twice} twice; drop one, or add a sensor for two"
        raise DuplicateError(message, where="design: times")
    prices = {f"t = {t}": read_exact(instant, "design: instant") for t in at} | dict(sensors)
    negative = [name for name, price in prices.items() if price < 0]
    if negative or not at or not offers:
        got = f"a negative one of {quote(negative[0])}" if negative else "no instants or no sensors"
        raise DomainError(f"expected instants, sensors and costs of at least 0; got {got}; correct it", where="design")
    if len(at) * len(offers) > MOST_ROWS:
        got = f"{len(at)} instants of {len(offers)} sensors"
        raise TooLargeError(f"expected at most {MOST_ROWS} measurements; got {got}; thin them out", where="design")
    rows, needs = [], []
    for t in at:
        for j, items, own in offers:
            sigma, text = flow.sigma(j, t) if own is None else (arb(own), str(own))
            rows.append(Row(t, j, fmpq(0), sigma, text, own))
            needs.append(items | {f"t = {t}"})
    return rows, needs, prices


class Market:
    """The rows on offer, and the duals collected so far; unit vectors beside the rows make every selection solvable."""

    def __init__(
        self,
        flow: Flow,
        rows: list[Row],
        needs: list[Needs],
        prices: dict[str, fmpq],
        budget: fmpq,
        digits: int,
        far: int,
    ):
        #: The proved lower bound is below the value by this part of it.
        self.digits, self.margin = digits, fmpq(1, 10 ** (digits + 1))
        self.flow, self.rows, self.needs, self.prices, self.budget = flow, rows, needs, prices, budget
        self.now = rows[-1].t
        flow.choose_unknowns(frozenset(row.j for row in rows))
        self.m = flow.size
        self.table = arb_mat([self.row_at(row.j, row.t).entries() for row in rows])
        self.target = flow.cut(flow.row_of_target)
        self.exact = [flow.exact_row(row.j, row.t, self.now) for row in rows]
        self.units = [[fmpq(int(i == k)) for i in range(self.m)] for k in range(self.m)]
        self.cloud = self.make_cloud(far)
        self.names = list(prices)
        self.bits = [sum(1 << self.names.index(name) for name in n) for n in needs]
        self.free = sum(1 << k for k, price in enumerate(prices.values()) if price == 0)
        self.known: dict[int, fmpq] = {}
        self.duals: dict[frozenset[int], arb_mat] = {}
        self.best: Optimum | None = None
        self.first = self.optimum(set(range(len(rows))))
        self.least = far // 1000 * bounds_of(self.cloud, self.first)[1]
        self.random = np.random.default_rng(0)

    def make_cloud(self, far: int) -> Cloud:
        """The rows and the unit vectors as the exchange takes them."""
        lines, bounds = self.table.tolist(), [row.sigma for row in self.rows]
        reach = np.linalg.pinv([[float(e / s) for e in v] for v, s in zip(lines, bounds, strict=True)])
        bounds += [arb(far) * max(r, 1e-6) for r in np.abs(reach).sum(axis=1)]
        lines += [list(map(arb, line)) for line in self.units]
        balls = [[e / s for e in v] for v, s in zip(lines, bounds, strict=True)]
        wide = max(float(e.rad()) for v in balls for e in v)
        return Cloud([arb_mat([v]) for v in lines], bounds, np.array([list(map(float, v)) for v in balls]), wide=wide)

    def price(self, items: int) -> fmpq:
        """What things cost together; one bit for each."""
        if items not in self.known:
            self.known[items] = sum((p for k, p in enumerate(self.prices.values()) if items >> k & 1), fmpq(0))
        return self.known[items]

    def mask(self, rows: set[int]) -> Any:
        """Which rows and unit vectors may be used."""
        return np.array([*(i in rows for i in range(len(self.rows))), *[True] * self.m])

    def optimum(self, rows: set[int]) -> Optimum:
        """The optimum over some rows and the unit vectors."""
        n = len(self.rows)
        found = exchange(replace(self.cloud, active=self.mask(rows)), self.target, range(n, n + self.m))
        if found is None:
            raise TooLargeError("expected regressors of like size; got an exchange without end; scale the unknowns")
        return found

    def weigh(self, found: Optimum) -> list[tuple[int, arb]] | None:
        """Rows and weights of an optimum; None where a unit vector carries weight, or may."""
        n = len(self.rows)
        if max(found.basis) < n:
            return list(zip(found.basis, found.weights.entries(), strict=True))
        lines = [None if row is None else [row[c] for c in self.flow.columns] for row in self.exact]
        exact: list[Any] = [[*lines, *self.units][k] for k in found.basis]
        goal: list[Any] = [[self.flow.exact_target(k)] for k in self.flow.columns]
        weights: Any
        if None in exact or [None] in goal:
            columns = arb_mat([self.cloud.vectors[k].entries() for k in found.basis]).transpose()
            weights = columns.solve(self.target.transpose(), algorithm="lu").entries()  # keeps zeros
        else:
            weights = fmpq_mat(exact).transpose().solve(fmpq_mat(goal)).entries()
        zeros = [w == 0 for w in weights]
        pairs = [(k, arb(w)) for k, w, zero in zip(found.basis, weights, zeros, strict=True) if not zero]
        return pairs if all(k < n for k, _ in pairs) else None

    def failing(self, dual: arb_mat, value: arb) -> tuple[frozenset[int], arb_mat]:
        """The needs of rows at which the dual, scaled to the goal, exceeds the bound; and that dual, as decimals."""
        x = self.round_dual(dual, self.goal / value)
        return self.refused(x), x

    def round_dual(self, dual: arb_mat, scale: arb) -> arb_mat:
        """A dual times a factor, as decimals."""
        return arb_mat([[arb(from_decimal(decimal(e * scale, self.digits + 28)))] for e in dual.entries()])

    def refused(self, x: arb_mat) -> frozenset[int]:
        """The needs of rows at which a dual exceeds the bound, or may."""
        sizes = (self.table * x).entries()
        return frozenset(n for n, f, row in zip(self.bits, sizes, self.rows, strict=True) if not abs(f) <= row.sigma)

    def search(self) -> bool:
        """Collect duals; whether they exclude every selection that is better than the best."""
        self.improve(self.fill(0)[1])
        self.duals = dict([self.failing(self.first.dual, bounds_of(self.cloud, self.first)[0])])
        while len(self.duals) < MOST_DUALS:
            nodes = count()
            bought = self.buy(list(self.duals), self.free, nodes)
            if bought is None:
                return True
            if next(nodes) > MOST_CELLS:
                return False
            rows, found = self.fill(bought)
            before = self.least
            self.improve(found)
            if self.least is not before:
                again = (self.failing(x, (self.target * x)[0, 0]) for x in self.duals.values())
                self.duals = dict(again)
            known = len(self.duals)
            for _ in range(ORDERS):
                dual = self.refute(set(rows), found)
                self.duals.setdefault(*self.failing(dual.dual, bounds_of(self.cloud, dual)[0]))
            if len(self.duals) == known and self.least is before:
                return False  # balls do not tell whether this selection shows the target
        return False

    @property
    def goal(self) -> arb:
        """What no selection may be shown to fall below: a little less than the least error so far."""
        return self.least * arb(1 - self.margin / 2)

    def buy(self, sets: list[frozenset[int]], bought: int, nodes: Iterator[int]) -> int | None:
        """Things within the budget that meet all sets; the checker goes the same way."""
        first = min(sets, key=len, default=None)
        if next(nodes) > MOST_CELLS or first is None:
            return bought
        for larger in {bought | n for n in first}:
            if self.price(larger) <= self.budget:
                found = self.buy([s for s in sets if all(n & ~larger for n in s)], larger, nodes)
                if found is not None:
                    return found
        return None

    def fill(self, bought: int) -> tuple[set[int], Optimum]:
        """The rows of a purchase and their optimum; the rest of the budget goes to rows that the dual refuses most."""
        while True:
            rows = {i for i, n in enumerate(self.bits) if not n & ~bought}
            found = self.optimum(rows)
            sizes = np.abs(self.cloud.scaled[: len(self.rows)] @ [float(e) for e in found.dual.entries()])
            wanted = (bought | self.bits[i] for i in np.argsort(-sizes) if sizes[i] > 1 + 1e-9 and i not in rows)
            larger = next((items for items in wanted if self.price(items) <= self.budget), None)
            if larger is None:
                return rows, found
            bought = larger

    def improve(self, found: Optimum) -> None:
        """Keep an optimum where it is the best so far, and go on from what its weights need as long as that helps."""
        while (pairs := self.weigh(found)) is not None and (cost := bounds_of(self.cloud, found)[1]) < self.least:
            self.least, self.best = cost, found
            bought = 0
            for i, w in pairs:
                bought |= 0 if w.contains(0) else self.bits[i]
            found = self.fill(bought)[1]

    def refute(self, rows: set[int], found: Optimum) -> Optimum:
        """A dual that is worth the goal and fails at few rows: in doubles they are allowed one by one while it is."""
        goal, n = float(self.goal), len(self.rows)
        basis, signs, worth = found.basis, found.signs, float(bounds_of(self.cloud, found)[0])
        x = np.array([float(e) for e in found.dual.entries()])
        active, P = self.mask(rows), to_doubles(self.target)
        cloud = replace(self.cloud, active=active)
        for i in self.random.permutation(n):
            if active[i]:
                continue
            active[i] = True
            if abs(cloud.scaled[i] @ x) * goal < worth:
                continue
            other = rehearse(cloud, P, list(basis), list(signs))
            y = np.linalg.solve(cloud.scaled[other[0]], np.array(other[1], dtype=float))
            if P @ y >= goal * (1 + 1e-9) and np.abs(cloud.scaled[active] @ y).max() < 1 + 1e-9:
                (basis, signs), x, worth = other, y, float(P @ y)
            else:
                active[i] = False
        return solve_basis(self.cloud, self.target, list(basis), list(signs)) or found

    def answer(self, done: bool) -> Design:
        """The best selection with its certificate; ``done`` is what the search said."""
        pairs = self.weigh(self.best) if self.best else None
        if self.best is None or pairs is None:
            got = f"none with an error below {float(self.least):.3g}" if done else "none in so many steps"
            message = f"expected a selection within the budget that shows {quote(self.flow.target)}; got {got}"
            raise NotEstimableError(f"{message}; raise the budget or add instants", where="design")
        cost, found = self.least, self.best
        duals = self.drop_idle() if done else [self.least_dual()]
        points = self.list_points(pairs, found.dual, cost)
        used = {i for i, w in pairs if not w.contains(0)}
        bought = sum(1 << k for k, name in enumerate(self.names) if any(name in self.needs[i] for i in used))
        certificate = self.write_certificate(found, duals, cost)
        value = Number(certificate["lower"], certificate["upper"])
        rows = [i for i, n in enumerate(self.bits) if not n & ~bought]
        lines = np.array([[float(e) for e in self.table.tolist()[i]] for i in rows])
        turn = np.linalg.svd(lines, full_matrices=False)[2][: np.linalg.matrix_rank(lines)]  # what these rows show
        grid = GridProblem(turn @ lines.T, turn @ to_doubles(self.target), [float(self.rows[i].sigma) for i in rows])
        words = tuple(name for k, name in enumerate(self.names) if bought >> k & 1)
        status = CERTIFIED if done else OPEN
        price = str(self.price(bought))
        return Design(self.flow.target, value, words, price, points, status, certificate, grid)

    def drop_idle(self) -> list[arb_mat]:
        """Duals without which a better selection would not be excluded."""
        needed = dict(self.duals)
        for sets in self.duals:
            rest = [s for s in needed if s != sets]
            if self.buy(rest, self.free, count()) is None:
                del needed[sets]
        return list(needed.values())

    def least_dual(self) -> arb_mat:
        """The dual of all rows, which bounds every selection; drawn in as far as its rounded numbers need."""
        x = self.round_dual(self.first.dual, arb(1))
        sizes = [abs(f) / row.sigma for f, row in zip((self.table * x).entries(), self.rows, strict=True)]
        x = self.round_dual(self.first.dual, arb(1 - self.margin) / largest([arb(1), *sizes]) ** 4)
        return x * 0 if self.refused(x) else x

    def list_points(self, pairs: Sequence[tuple[int, arb]], dual: arb_mat, cost: arb) -> tuple[DesignPoint, ...]:
        """The support with its sensitivities: ``dV/dsigma = |w|``, ``dV/dt = -w h'(t) . x``."""
        points, used = [], [(i, w) for i, w in sorted(pairs) if not w.contains(0)]
        for i, w in used:
            row, slope = self.rows[i], None
            if len(used) == self.m:
                slope = float(-w * ((self.row_at(row.j, row.t + STEP) - self.row_at(row.j, row.t)) * dual)[0, 0] / STEP)
            share, name = float(row.sigma * abs(w) / cost), self.flow.names[row.j]
            points.append(DesignPoint(str(row.t), name, row.text, float(w), share, slope))
        return tuple(points)

    def row_at(self, j: int, t: fmpq) -> arb_mat:
        """A measurement at a time in the kept unknowns at the time of the estimate; also a little after it."""
        if t <= self.now or not self.flow.F:
            return self.flow.cut(arb_mat([self.flow.ball_row(j, t, self.now)]))
        later = self.flow.transition(self.now, t)
        return self.flow.cut(self.flow.row(j, t) if later is None else self.flow.row(j, t) * later)

    def write_certificate(self, found: Optimum, duals: Sequence[arb_mat], cost: arb) -> dict[str, Any]:
        """The certificate of kind design."""
        flow, columns, rows = self.flow, self.flow.columns, []
        for row, numbers, needs in zip(self.rows, self.exact, self.needs, strict=True):
            texts = flow.row_text(row.j, row.t, self.now) if numbers is None else [str(e) for e in numbers]
            if texts is None:
                message = "expected an F whose exp(F t) has a formula; got another; simplify F"
                raise DomainError(message, where="design: model")
            rows.append({"H": [texts[k] for k in columns], "sigma": row.text, "needs": sorted(needs)})
        worth = min(((self.target * x)[0, 0] for x in duals), key=float)
        nodes = count()
        self.buy([self.refused(x) for x in duals], self.free, nodes)
        return {
            "kind": "design",
            "rows": rows,
            "costs": {name: str(price) for name, price in self.prices.items()},
            "budget": str(self.budget),
            "functional": [to_text(flow.functional[k]) for k in columns],
            "support": list(found.basis),
            "duals": [[decimal(e, self.digits + 28) for e in x.entries()] for x in duals],
            "lower": lower_end(worth, self.digits + 11),
            "upper": upper_end(cost, self.digits + 11),
            "bits": BITS + 64,
            "cells": next(nodes) // 4 + 1,
        }
