"""Balls around H(t) and rigorous bounds of ``|x . H(t)|`` over whole intervals.

A :class:`Panel` is one analytic piece of one measurement: its regressors as expressions in the
time, its ends and its noise bound. Time on a panel is ``t = start + (end - start) v`` with v in
[0, 1], so that cells, contacts and support points are exact fractions whatever the ends are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial
from math import comb
from operator import add, methodcaller, mul
from typing import Any

import numpy as np
import sympy as sp
from flint import arb, arb_mat, arb_poly, arb_series, ctx, fmpq
from numpy.typing import NDArray

from navsym.core.balls import OPERATIONS, Instruction, flatten, multiply_all, series_terms
from navsym.core.exact import to_fmpq

# Several expressions as one tape: shared parts once, constants once for each precision, run over balls and series.


@dataclass(frozen=True, slots=True, eq=False)
class JointTape:
    """Several expressions flattened into one tape, shared parts once; ``outputs`` are their places."""

    steps: tuple[Instruction, ...]
    outputs: tuple[int, ...]

    def run(self, values: Mapping[sp.Symbol, Any]) -> list[Any]:
        fixed, symbols, moving = prepare_steps(self, ctx.prec)
        done = list(fixed)
        for place, symbol in symbols:
            done[place] = values[symbol]
        for place, operation, first, second in moving:
            if second is None:
                done[place] = operation(done[first])
            elif second >= 0:
                done[place] = operation(done[first], done[second])
            else:
                done[place] = operation([done[i] for i in first])
        return [done[i] for i in self.outputs]

    def numbers(self, values: Mapping[sp.Symbol, Any]) -> list[Any]:
        """The same in double precision, over numpy arrays: a hint, never a bound."""
        done: list[Any] = []
        for step in self.steps:
            arguments = [done[i] for i in step.arguments]
            done.append(FLOATS[step.operation](step.constant, arguments, values))
        return [done[i] for i in self.outputs]


#: Where it goes, what is done, and the arguments: one (None), two, or a tuple of them (-1).
Moving = tuple[int, Callable[..., Any], Any, int | None]
#: Operations that are one call of an object or of two: what OPERATIONS does, without its lists.
UNARY = {name: methodcaller(name) for name in ("sin", "cos", "exp")}
TWO: dict[str, Callable[[Any, Any], Any]] = {"add": add, "mul": mul}


@lru_cache(maxsize=256)
def prepare_steps(tape: JointTape, bits: int) -> tuple[list[Any], list[tuple[int, sp.Symbol]], list[Moving]]:
    """The steps without a symbol, done at a precision, those that are symbols, and the others."""
    done: list[Any] = []
    symbols: list[tuple[int, sp.Symbol]] = []
    moving: list[Moving] = []
    for place, step in enumerate(tape.steps):
        if step.operation == "symbol":
            symbols.append((place, step.constant))
        elif any(done[i] is None for i in step.arguments):
            moving.append((place, *step_call(step)))
        else:
            done.append(OPERATIONS[step.operation](step.constant, [done[i] for i in step.arguments], {}))
            continue
        done.append(None)
    return done, symbols, moving


def step_call(step: Instruction) -> tuple[Callable[..., Any], Any, int | None]:
    """How a step is called."""
    if step.operation in UNARY:
        return UNARY[step.operation], step.arguments[0], None
    if step.operation in TWO and len(step.arguments) == 2:
        return TWO[step.operation], *step.arguments
    operation = OPERATIONS[step.operation]
    return (lambda arguments: operation(step.constant, arguments, {})), step.arguments, -1


def joint_tape(expressions: Sequence[sp.Expr]) -> JointTape:
    """Flatten expressions; raises :class:`~navsym.core.balls.UnsupportedError` outside the language."""
    return JointTape(*flatten(expressions))


FLOATS: dict[str, Any] = {
    "number": lambda c, a, v: float(int(c.p)) / float(int(c.q)),
    "pi": lambda c, a, v: np.pi,
    "e": lambda c, a, v: np.e,
    "symbol": lambda c, a, v: v[c],
    "add": lambda c, a, v: sum(a[1:], a[0]),
    "mul": lambda c, a, v: np.prod(a, axis=0) if all(np.ndim(x) == 0 for x in a) else multiply_all(a),
    "power": lambda c, a, v: a[0] ** c if c >= 0 else 1.0 / a[0] ** (-c),
    "root": lambda c, a, v: a[0] ** (c[0] / c[1]),
    "general_power": lambda c, a, v: a[0] ** a[1],
    "tan": lambda c, a, v: np.tan(a[0]),
    "cot": lambda c, a, v: 1.0 / np.tan(a[0]),
    "sec": lambda c, a, v: 1.0 / np.cos(a[0]),
    "csc": lambda c, a, v: 1.0 / np.sin(a[0]),
    "asin": lambda c, a, v: np.arcsin(a[0]),
    "acos": lambda c, a, v: np.arccos(a[0]),
    "atan": lambda c, a, v: np.arctan(a[0]),
    "atan2": lambda c, a, v: np.arctan2(a[0], a[1]),
    "max": lambda c, a, v: np.maximum.reduce(a),
    "min": lambda c, a, v: np.minimum.reduce(a),
} | {
    name: (lambda f: lambda c, a, v: f(a[0]))(getattr(np, name))
    for name in ("sin", "cos", "exp", "log", "abs", "sign", "sinh", "cosh", "tanh")
}


ORDER = 10


@dataclass(frozen=True)
class Panel:
    """One analytic piece of one measurement.

    measurement : index of the measurement
    functions   : H_1(t) … H_m(t)
    variable    : t
    start, end  : exact ends of the piece
    sigma       : noise bound of the measurement, positive
    values      : balls for the parameters that the expressions contain
    mix         : matrix A when the unknowns are those of A H, else None
    """

    measurement: int
    functions: tuple[sp.Expr, ...]
    variable: sp.Symbol
    start: sp.Expr
    end: sp.Expr
    sigma: sp.Expr
    values: Mapping[sp.Symbol, Any] = field(default_factory=dict)
    mix: arb_mat | None = None

    @cached_property
    def program(self) -> JointTape:
        return joint_tape(self.functions)

    @cached_property
    def slopes(self) -> JointTape:
        """H, all first derivatives, and all second ones halved."""
        first = [h.diff(self.variable) for h in self.functions]
        return joint_tape([*self.functions, *first, *(d.diff(self.variable) / 2 for d in first)])

    @cached_property
    def ends(self) -> JointTape:
        return joint_tape([self.start, self.end, self.sigma])

    @cached_property
    def kept(self) -> dict[int, tuple[arb, arb, arb]]:
        return {}

    def edges(self) -> tuple[arb, arb, arb]:
        """Start, end and noise bound as balls of the present precision, made once for each."""
        if ctx.prec not in self.kept:
            start, end, sigma = self.ends.run(self.values)
            self.kept[ctx.prec] = (arb(start), arb(end), arb(sigma))
        return self.kept[ctx.prec]

    def time(self, v: Any) -> arb:
        """Time at the fraction v of the panel."""
        start, end, _ = self.edges()
        return start + (end - start) * v

    def bound(self) -> arb:
        return self.edges()[2]

    def rows(self, v: Any) -> list[arb]:
        """H at the fraction v (a ball or an exact number)."""
        inputs = dict(self.values)
        inputs[self.variable] = self.time(v)
        return [arb(h) for h in self.program.run(inputs)]

    def numbers(self, v: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """Times (n,) at fractions v (n,), H there (m, n) and the noise bound, in double precision."""
        values = {symbol: float(ball.mid()) for symbol, ball in self.values.items()}
        start, end, sigma = (float(x) for x in self.ends.numbers(values))
        times = start + (end - start) * v
        rows = self.program.numbers({**values, self.variable: times})
        return times, np.array([np.broadcast_to(np.asarray(h, dtype=float), v.shape) for h in rows]), sigma

    def series(self, v: Any, scale: Any, order: int) -> list[list[arb]]:
        """Taylor coefficients 0 … order of every H in w, where the fraction is ``v + scale w``.

        With a ball for v the coefficients hold for every centre in it (Lagrange remainders).
        """
        with series_terms(order + 1):
            rows = [series_coefficients(h, order) for h in self.expanded(v, scale)]
        return rows if self.mix is None else (self.mix * arb_mat(rows)).tolist()

    def dual_polynomial(self, x: Sequence[arb], v: Any, scale: Any, order: int) -> list[arb]:
        """Taylor coefficients 0 … order of ``x . H``, see :meth:`series`."""
        if self.mix is not None:
            x = (self.mix.transpose() * arb_mat([[a] for a in x])).entries()
        with series_terms(order + 1):
            parts = zip(x, self.expanded(v, scale), strict=True)
            return series_coefficients(sum((a * h for a, h in parts), arb(0)), order)

    def expanded(self, v: Any, scale: Any) -> list[Any]:
        """Every expression as a series in w, or as a number where it is constant."""
        start, end, _ = self.edges()
        width = end - start
        inputs = dict(self.values)
        inputs[self.variable] = arb_series([start + width * v, width * scale])
        return self.program.run(inputs)


def series_coefficients(value: Any, order: int) -> list[arb]:
    """Coefficients 0 … order of a series, or of a number as a constant one."""
    if isinstance(value, arb_series):
        return [value[k] for k in range(order + 1)]
    return [arb(value)] + [arb(0)] * order


def combine_series(x: Sequence[arb], series: Sequence[Sequence[arb]]) -> list[arb]:
    """Taylor coefficients of ``x . H`` from those of H."""
    return [dot_product(x, [s[k] for s in series]) for k in range(len(series[0]))]


def dot_product(x: Sequence[arb], y: Sequence[arb]) -> arb:
    """Sum of the products ``x_i y_i``."""
    value = arb(0)
    for a, b in zip(x, y, strict=True):
        value += a * b
    return value


@dataclass(frozen=True)
class PanelProblem:
    """Minimise ``sum |w|`` times the noise bounds subject to ``sum w H = P``, with exact data.

    panels     : pieces of the measurements, in any order
    functional : P, exact expressions
    values     : balls for the parameters that the expressions contain
    """

    panels: tuple[Panel, ...]
    functional: tuple[sp.Expr, ...]
    values: Mapping[sp.Symbol, Any] = field(default_factory=dict)

    @cached_property
    def functional_program(self) -> JointTape:
        return joint_tape(self.functional)

    def target(self) -> list[arb]:
        """P as balls at the working precision."""
        return [arb(p) for p in self.functional_program.run(self.values)]


# -- |x . H| <= bound over a panel ---------------------------------------


@dataclass(frozen=True, slots=True)
class Touch:
    """A place where the dual polynomial touches its bound, or nearly so.

    at    : fraction of the panel, exact or a ball
    sign  : sign of f there
    exact : True when ``f = sign * bound`` holds exactly there, and f' = 0 too unless ``end``
    end   : "from" or "to" for a contact at that end of the panel, where only the value is known
    """

    at: Any
    sign: int
    exact: bool = False
    end: str = "no"


@dataclass(frozen=True, slots=True)
class PanelCell:
    """Part [lower, upper] of a panel, with the touch inside it, if any."""

    lower: fmpq
    upper: fmpq
    touch: Touch | None = None


#: Taylor coefficients of f in w on a cell, fraction ``centre + radius w``; the last one over the whole cell.
Expansion = Callable[[PanelCell, fmpq, fmpq], list[arb]]


def prove_by_cells(bound: arb, touches: Sequence[Touch], limit: int, expand: Expansion) -> int | None:
    """Number of cells that prove ``|f| <= bound`` for the function with these expansions, or None.

    Cells around touches pass by curvature or slope, all others by Taylor bounds; a cell that
    fails is halved. With exact touches the other cells must stay strictly below the bound.
    """
    strict = any(t.exact for t in touches)
    stack = first_cells(touches)
    used = 0
    while stack:
        cell = stack.pop()
        used += 1
        if used > limit:
            return None
        if is_cell_bounded(expand, cell, bound, strict):
            continue
        if cell.upper - cell.lower < fmpq(1, 1 << 400):
            return None
        stack.extend(split_cell(cell))
    return used


def first_cells(touches: Sequence[Touch]) -> list[PanelCell]:
    """[0, 1] cut between neighbouring touches; ends of the panel do not count as neighbours."""
    ordered = sorted(touches, key=lambda t: float(to_fmpq(t.at)))
    reach = [touch_extent(t) for t in ordered]
    cells: list[PanelCell] = []
    edge = fmpq(0)
    for i, touch in enumerate(ordered):
        gaps = [reach[i][0] - reach[i - 1][1]] if i else []
        gaps += [reach[i + 1][0] - reach[i][1]] if i + 1 < len(reach) else []
        radius = max(min(gaps), fmpq(0)) * fmpq(3, 8) if gaps else fmpq(1)
        lower, upper = max(reach[i][0] - radius, fmpq(0)), min(reach[i][1] + radius, fmpq(1))
        if touch.end == "to":  # a moving end: the ball of its places reaches to the end of the panel
            upper = fmpq(1)
        if lower > edge:
            cells.append(PanelCell(edge, lower))
        cells.append(PanelCell(lower, upper, touch))
        edge = upper
    if edge < 1:
        cells.append(PanelCell(edge, fmpq(1)))
    return cells


def touch_extent(touch: Touch) -> tuple[fmpq, fmpq]:
    """Ends of the ball of the place, or the exact place twice."""
    if isinstance(touch.at, arb):
        return to_fmpq(touch.at.lower()), to_fmpq(touch.at.upper())
    return to_fmpq(touch.at), to_fmpq(touch.at)


def split_cell(cell: PanelCell) -> list[PanelCell]:
    """Halves of a plain cell; a touch keeps a cell half-way nearer to its places, in the middle of two more."""
    if cell.touch is None:
        middle = (cell.lower + cell.upper) / 2
        return [PanelCell(cell.lower, middle), PanelCell(middle, cell.upper)]
    left, right = touch_extent(cell.touch)
    lower = cell.lower if cell.touch.end == "from" else (cell.lower + left) / 2
    upper = cell.upper if cell.touch.end == "to" else (cell.upper + right) / 2
    parts = [PanelCell(lower, upper, cell.touch)]
    if lower > cell.lower:
        parts.append(PanelCell(cell.lower, lower))
    if upper < cell.upper:
        parts.append(PanelCell(upper, cell.upper))
    return parts


def interval_ball(lower: fmpq, upper: fmpq) -> arb:
    """A ball around an interval with exact ends."""
    return arb((lower + upper) / 2) + arb((upper - lower) / 2) * arb(0, 1)


def is_cell_bounded(expand: Expansion, cell: PanelCell, bound: arb, strict: bool) -> bool:
    """``|f| <= bound`` on the cell (``<`` off an exact touch), from one Taylor expansion with remainder."""
    centre = (cell.lower + cell.upper) / 2 if cell.touch is None else to_fmpq(cell.touch.at)
    radius = max(centre - cell.lower, cell.upper - centre)
    taylor = expand(cell, centre, radius)
    spread = remainder_bound(taylor, 0)
    if cell.touch is not None and cell.touch.exact:
        return is_bounded_at_touch(cell, taylor, spread, bound)
    height = abs(taylor[0]) + spread
    if bool(height < bound) or (not strict and bool(height <= bound)):
        return True
    return cell.touch is not None and is_bounded_near_touch(cell, taylor, spread, bound)


def remainder_bound(taylor: Sequence[arb], derivative: int) -> arb:
    """Bound of ``f^(d)/d!`` minus its value at the centre, over ``|w| <= 1``."""
    sizes = map(arb.abs_upper, taylor[derivative + 1 :])
    return sum(sizes if derivative == 0 else map(mul, binomials(derivative, len(taylor)), sizes), arb(0))


@lru_cache(maxsize=256)
def binomials(derivative: int, size: int) -> tuple[int, ...]:
    """``binom(k, derivative)`` for all k from above the derivative to below the size."""
    return tuple(comb(k, derivative) for k in range(derivative + 1, size))


def is_bounded_near_touch(cell: PanelCell, taylor: Sequence[arb], spread: arb, bound: arb) -> bool:
    """f <= bound by concavity around the centre, or by monotony up to an end of the cell."""
    assert cell.touch is not None
    s = cell.touch.sign
    if not bool(-s * taylor[0] + spread <= bound):
        return False
    bend = s * taylor[2] + remainder_bound(taylor, 2)
    if bool(bend < 0) and bool(s * taylor[0] + taylor[1] ** 2 / (-4 * bend) <= bound):
        return True
    centre = to_fmpq(cell.touch.at)
    slope, change = s * taylor[1], remainder_bound(taylor, 1)
    rising = centre == cell.upper and bool(slope > change)
    falling = centre == cell.lower and bool(-slope > change)
    return (rising or falling) and bool(s * taylor[0] <= bound)


def is_bounded_at_touch(cell: PanelCell, taylor: Sequence[arb], spread: arb, bound: arb) -> bool:
    """True when ``|f| < bound`` is proved on the cell off an exact contact.

    At an inner contact, with f' = 0, f is strictly concave; up to a contact at an end of the panel it is strictly
    monotone, or concave with an outward slope there.
    """
    assert cell.touch is not None
    s, place = cell.touch.sign, arb(cell.touch.at)
    if cell.touch.end != "no" and place.rad() > 0:  # the slope below is that at one place
        return False
    inside = (cell.touch.end == "from" or bool(place >= arb(cell.lower))) and (
        cell.touch.end == "to" or bool(place <= arb(cell.upper))
    )
    if not inside or not bool(-s * taylor[0] + spread < bound):
        return False
    concave = bool(s * taylor[2] + remainder_bound(taylor, 2) < 0)
    if cell.touch.end == "no":
        return concave
    outward = (s if cell.touch.end == "to" else -s) * taylor[1]
    return bool(outward > remainder_bound(taylor, 1)) or (concave and bool(outward > 0))


# ``|x . H| <= sigma`` on a whole panel: one polynomial with a proved remainder for all coarse cells.
#
# About the middle of the panel, with ``v = (1 + u) / 2`` and u in [-1, 1], Taylor's formula with Lagrange's
# remainder holds for f and each of its derivatives with one and the same ball R around ``f^(n)(xi) / n!``, xi
# anywhere on the panel: ``f^(d)(u) / d! = sum_k<n binom(k, d) c_k u^(k-d) + binom(n, d) R u^(n-d)`` for d < n. So
# the polynomial with the coefficients ``c_0 … c_(n-1), R`` encloses every Taylor coefficient at every place, and
# shifted to a cell it does what a new expansion of all functions does, for a fifth of the time.


HALF = fmpq(1, 2)
#: Orders of the polynomial that are tried, and how small R must be, as a part of the bound.
LARGEST, SMALL = 48, arb(2) ** -20
#: What varies by less than so many times that is called constant.
FLAT = 16
#: Cells shorter than this part of the panel are expanded on their own: R may be too much for them.
SHORTEST_CELL = fmpq(1, 1 << 16)


def prove_panel_bound(panel: Panel, x: Sequence[arb], touches: Sequence[Touch], limit: int = 4000) -> int | None:
    """Number of cells that prove ``|x . H| <= sigma`` on the whole panel, or None."""
    anew: Expansion = partial(expand_cell, panel, x)
    model = panel_polynomial(panel, x)
    expand = anew if model is None else partial(shift_polynomial, model, anew)
    return prove_by_cells(panel.bound(), touches, limit, expand)


def panel_polynomial(panel: Panel, x: Sequence[arb]) -> arb_poly | None:
    """The coefficients ``c_0 … c_(n-1), R`` of f in u, or None where they do not help.

    No R may be small; balls in the data may make the coefficients wide, each on its own, while f is not; or f is
    almost constant, so that all of it may lie nearer to the bound than R.
    """
    wide = panel.dual_polynomial(x, interval_ball(fmpq(0), fmpq(1)), HALF, LARGEST)
    small = SMALL * panel.bound()
    order = next((k for k in range(3, LARGEST + 1) if bool(abs(wide[k]) < small)), None)
    if order is None:
        return None
    thin = panel.dual_polynomial(x, arb(HALF), HALF, order - 1)
    wavering = sum((abs(c) for c in thin[1:]), abs(wide[order]))
    if bool(wavering < FLAT * small) or not bool(sum((c.rad() for c in thin), arb(0)) < small):
        return None
    return arb_poly([*thin, wide[order]])


def shift_polynomial(model: arb_poly, anew: Expansion, cell: PanelCell, centre: fmpq, radius: fmpq) -> list[arb]:
    """What :func:`expand_cell` gives, from the polynomial of the panel; where that is too coarse, anew.

    Near a touch that is not exact a bound is met up to the last digits, which R does not have.
    """
    fine = cell.touch is not None and not cell.touch.exact
    if fine or cell.upper - cell.lower < SHORTEST_CELL:
        return anew(cell, centre, radius)
    taylor: list[arb] = model(arb_poly([arb(2 * centre - 1), arb(2 * radius)])).coeffs()
    return taylor + [arb(0)] * (3 - len(taylor))


def expand_cell(panel: Panel, x: Sequence[arb], cell: PanelCell, centre: fmpq, radius: fmpq) -> list[arb]:
    """Taylor coefficients of f in w, fraction ``centre + radius w``; the last one holds over the whole cell.

    Their order is above the degree of as many monomials, so that the remainder of these vanishes.
    """
    order = min(24, max(ORDER, len(x) + 2))
    point = panel.dual_polynomial(x, arb(centre), radius, order - 1)
    wide = panel.dual_polynomial(x, interval_ball(cell.lower, cell.upper), radius, order)
    return [*point, wide[order]]
