"""Pictures in one style: units on the axes, colours that everybody can tell apart, SVG.

Every function takes plain arrays and returns a matplotlib ``Figure`` made without any global state;
``svg`` turns it into text that is the same for the same data.
"""

from __future__ import annotations

import html
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from navsym.claims import Record
from navsym.core.balls import enclose, exact_ball, tape
from navsym.core.errors import DomainError, NavsymError
from navsym.guaranteed.phases.answer import PhaseMap, Phases, Regime
from navsym.guaranteed.solver import Estimator
from navsym.language.expression import to_text
from navsym.language.names import quote
from navsym.multimodel.engine import Estimates
from navsym.observability.accuracy import Accuracy
from navsym.report.explain import Side, arithmetic, read_side
from navsym.report.names import latex_name
from navsym.terrain.locate import Fix
from navsym.trajectory.conditioning import Conditions
from navsym.trajectory.motion import Track
from navsym.verification.ledger import Ledger, may_be_the_copy, records_about

#: The palette of Okabe and Ito, told apart with every common colour blindness.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#f0e442", "#000000")
STYLES = ("-", "--", ":", "-.")
Array = np.ndarray
Rows = Sequence[Mapping[str, Any]]


class Picture(Figure):
    """A figure that shows itself in a notebook, also where pyplot is not imported."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()


def figure(width: float = 7.0, height: float = 3.5) -> tuple[Figure, Axes]:
    """An empty figure with one pair of axes, without a frame on the right and above."""
    made, (axes,) = panels((1,), height, width)
    return made, axes


def svg(picture: Figure) -> str:
    """The picture as SVG text, without a date and with reproducible names inside."""
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": "navsym", "svg.fonttype": "none"}):
        picture.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def panels(ratios: Sequence[float], height: float, width: float = 7.0) -> tuple[Figure, list[Axes]]:
    """Axes one above the other over one abscissa, without a frame on the right and above."""
    made = Picture(figsize=(width, height), layout="constrained")
    found = list(made.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0])
    for axes in found:
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(True, color="0.9", linewidth=0.6)
        axes.set_axisbelow(True)
    return made, found


def phase_diagram(regimes: Rows, *, parameter: str, unit: str, quantity: str) -> Figure:
    """The optimum over a parameter, and below it the instants that reach it; boundaries of regimes as lines.

    regimes : each with ``at`` (n,) values of the parameter, ``value`` (n,), ``label`` and perhaps
              ``instants`` (k, n), where the measurements stand
    """
    placed = any("instants" in regime for regime in regimes)
    made, drawn = panels((3, 2), 5.2) if placed else panels((1,), 3.5)
    for place, regime in enumerate(regimes):
        style = {"linestyle": STYLES[place % 4], "color": COLOURS[place % 7]}
        drawn[0].plot(regime["at"], regime["value"], label=regime["label"], **style)
        for instant in regime.get("instants", ()):
            drawn[1].plot(regime["at"], instant, **style)
        for axes in drawn if place else ():
            axes.axvline(regime["at"][0], color="0.6", linewidth=0.8)
    drawn[0].set(xlabel=f"{parameter}, {unit}", ylabel=quantity)
    drawn[0].legend(loc="best", frameon=False, labelspacing=0.9)
    if placed:
        drawn[0].xaxis.label.set_visible(False)
        drawn[1].set(xlabel=f"{parameter}, {unit}", ylabel=f"where to measure,\n{unit}")
    return made


def mode_ribbon(times: Array, probabilities: Array, names: Sequence[str]) -> Figure:
    """Mode probabilities (n, k) as a ribbon that is always one high."""
    made, axes = figure(height=3.0)
    axes.stackplot(times, probabilities.T, colors=COLOURS[: probabilities.shape[1]], labels=names, step="mid")
    axes.set(xlabel="time, s", ylabel="probability of the mode", ylim=(0, 1))
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    return made


def verdict_matrix(papers: Sequence[tuple[str, Sequence[tuple[str, str]]]], *, columns: int = 20) -> Figure:
    """Papers and their numbered equations, one square each, in the colour and with the mark of the worst verdict.

    papers : (name, ((equation, status), ...)) with a key of :data:`SQUARES` as status
    """
    lines = [max(1, -(-len(equations) // columns)) for _, equations in papers]
    height = sum(lines) + 0.75 * len(papers) + 1.4
    made = Picture(figsize=(9.2, 0.34 * height + 0.2), layout="constrained")
    axes = made.add_subplot()
    axes.set(xlim=(-0.1, columns), ylim=(height, -0.1), aspect="auto")
    axes.set_axis_off()
    top = 0.0
    for (name, equations), rows in zip(papers, lines, strict=True):
        axes.text(0, top + 0.45, name, fontsize=9, fontweight="bold", va="center")
        for place, (equation, status) in enumerate(equations):
            square(axes, place % columns, top + 0.75 + place // columns, equation, status)
        top += 0.75 + rows
    for place, status in enumerate((*SQUARES,)):
        x = place * columns / len(SQUARES)
        square(axes, x, top + 0.25, "", status)
        axes.text(x + 1.05, top + 0.7, status, fontsize=8, va="center")
    return made


#: Ground, ink and mark of a square; luminance tells refuted from proved as well as the hue.
SQUARES = {
    "PROVED": ("#cfe8f6", "#00476e", "✓"),
    "CERTIFIED": ("#9fd3cb", "#003d33", "◎"),
    "REFUTED": ("#c8480b", "#ffffff", "✗"),
    "perhaps the copy": ("#fbe0d0", "#8a2d00", "✗"),
    "CONFIRMED": ("#e3e3f5", "#2b2b70", "≈"),
    "OPEN": ("#f5e3a1", "#4d3b00", "?"),
    "definition": ("#efefef", "#595959", "·"),
}


def square(axes: Axes, x: float, y: float, equation: str, status: str) -> None:
    """One equation: its number and the mark of its verdict."""
    ground, ink, mark = SQUARES[status]
    axes.add_patch(Rectangle((x + 0.04, y + 0.06), 0.92, 0.84, facecolor=ground, edgecolor=ink, linewidth=0.6))
    text = f"{equation} {mark}".strip()
    axes.text(x + 0.5, y + 0.5, text, ha="center", va="center", fontsize=7.2, color=ink)


# Pictures of answers


def plot(answer: Any) -> Figure:
    """A picture of an answer, as a matplotlib figure; a notebook shows it, ``savefig`` writes it.

    An Estimator shows its dual polynomials within their bounds, and its weights; Phases show value and times by the
    parameter; a map shows its regions; estimates of a filter show the probabilities of the modes; a track shows
    velocities with their deviations; an accuracy least deviations and weakest directions along the flight; condition
    numbers are compared with doubles; a ledger shows its verdicts; a
    refuted record both sides.

    Raises DomainError for an answer without a picture.

    >>> import navsym as nav
    >>> drift = nav.solve("examples/schuler-velocity.toml", "drift", T="pi/2")
    >>> picture = nav.plot(drift)
    >>> [axes.get_xlabel() for axes in picture.axes]
    ['time, unit of the model', 'time, unit of the model']
    """
    record = getattr(answer, "record", answer)
    if isinstance(record, Record):
        curves = refuted_curves(record)
        if curves is None:
            message = "expected a refuted formula with a counterexample; got a claim without a curve; see nav.explain"
            raise DomainError(message, where=record.id)
        return refutation_plot(curves)
    for kind, draw in PICTURES.items():
        if isinstance(answer, kind):
            drawn: Figure = draw(answer)
            return drawn
    expected = ", ".join(kind.__name__ for kind in PICTURES)
    raise DomainError(f"expected one of {expected}, or a refuted claim; got {quote(answer)}; plot one of these")


def plot_estimator(found: Estimator) -> Figure:
    """Dual polynomials over their bounds ``x . H_j(t) / sigma_j``, and the weights of the support."""
    made, (above, below) = panels((2, 1), 4.4)
    above.axhspan(-1, 1, color="0.93", zorder=0)
    dual = np.array([float(Fraction(x)) for x in found.dual])
    v = np.linspace(0.0, 1.0, 400)
    seen: set[str] = set()
    for panel in found.problem.exact().panels:
        times, rows, sigma = panel.numbers(v)
        name = found.problem.measurements[panel.measurement]
        colour = COLOURS[panel.measurement % len(COLOURS)]
        label = {} if name in seen else {"label": name}
        above.plot(times, dual @ rows / sigma, STYLES[panel.measurement % 4], color=colour, **label)
        seen.add(name)
    for point in found.support:
        colour = COLOURS[found.problem.measurements.index(point.measurement) % len(COLOURS)]
        at, weight = float(point.at), float(point.weight)
        above.plot(at, np.sign(weight), "o", color=colour)
        below.vlines(at, 0, weight, color=colour, linewidth=3)
        below.plot(at, weight, "o", color=colour)
    above.set(xlabel=f"time, {MODEL_UNIT}", ylabel="dual polynomial over its bound, 1")
    above.legend(loc="best", frameon=False)
    below.axhline(0, color="0.4", linewidth=1)
    below.set(xlabel=f"time, {MODEL_UNIT}", ylabel="weight, 1")
    return made


def plot_phases(found: Phases) -> Figure:
    """The optimum and the times of its measurements by the parameter; regimes without a closed form as their table."""
    rows = [row for regime in found.regimes if (row := curve_of_regime(regime)) is not None]
    if not rows:
        raise DomainError("expected a regime with a value; got none; choose another range", where=found.target)
    return phase_diagram(rows, parameter=found.parameter, unit=MODEL_UNIT, quantity=f"deviation of {found.target}, 1")


def plot_map(found: PhaseMap) -> Figure:
    """Regions in the plane of both parameters, a colour for each closed form; what is not proved stays white."""
    made, axes = figure()
    first, second = found.parameters
    for k, parts in enumerate(found.regions):
        label = to_text(parts[0].regime.closed.value)  # type: ignore[union-attr]
        for part in parts:
            low, high = (float(exact_ball(end).mid()) for end in (part.low, part.high))
            across = np.linspace(low, high, POINTS)
            sides = [program_values(end, found.second, across) for end in (part.regime.lower, part.regime.upper)]
            own = {"label": label if len(label) <= 30 else f"region {k + 1}"} if part is parts[0] else {}
            axes.fill_between(across, *sides, color=COLOURS[k % len(COLOURS)], alpha=0.6, linewidth=0, **own)
    axes.set(xlabel=f"{second}, {MODEL_UNIT}", ylabel=f"{first}, {MODEL_UNIT}")
    axes.legend(loc="best", frameon=False)
    return made


def program_values(expression: Any, name: Any, at: Array) -> Array:
    """An expression at many values of its symbol, from balls."""
    program = tape(expression)
    return np.array([float(enclose(program, {name: exact_ball(Fraction(float(x)))}).mid()) for x in at])


def curve_of_regime(regime: Regime) -> Mapping[str, Any] | None:
    """Values of the parameter with the optimum there, and with the times where they have closed forms."""
    if regime.value is None:
        table = [(row["at"], row["lower"]) for row in regime.table]
        if not table:
            return None
        at, value = (np.array([float(Fraction(x)) for x in column]) for column in zip(*table, strict=True))
        return {"at": at, "value": value, "label": "enclosures"}
    low, high = (float(exact_ball(end).mid()) for end in (regime.lower, regime.upper))
    at = np.linspace(low, high, POINTS + 1)[1:-1]
    drawn = [regime.value, *(p.at for p in regime.support if p.at is not None)]
    curves = [program_values(e, regime.family.parameter, at) for e in drawn]
    text = regime.document()["value"]
    label = text if len(text) <= 30 else " to ".join(regime.ends)
    return {"at": at, "value": curves[0], "label": label, "instants": np.array(curves[1:])}


def plot_filter(found: Estimates) -> Figure:
    """Probabilities of the modes after every step."""
    steps = np.arange(1, len(found.probabilities) + 1)
    names = [f"mode {k + 1}" for k in range(found.probabilities.shape[1])]
    made = mode_ribbon(steps, found.probabilities, names)
    made.axes[0].set_xlabel("step, 1")
    return made


def plot_track(found: Track) -> Figure:
    """Velocity east, north and up with three standard deviations."""
    made, axes = figure()
    for k, name in enumerate(("east", "north", "up")):
        speed, spread = found.velocity[:, k], 3 * found.velocity_sd[:, k]
        axes.fill_between(found.t, speed - spread, speed + spread, color=COLOURS[k], alpha=0.2, linewidth=0)
        axes.plot(found.t, speed, STYLES[k], color=COLOURS[k], label=name)
    axes.set(xlabel="time, s", ylabel="velocity, m/s")
    axes.legend(loc="best", frameon=False)
    return made


def plot_accuracy(found: Accuracy) -> Figure:
    """Least deviations along the flight, and below them the components of the weakest direction."""
    made, drawn = panels((3, 2) if found.weakest else (1,), 5.2 if found.weakest else 3.5)
    times = [time for time, *_ in found.history]
    for k, name in enumerate(dict.fromkeys(name for _, shown, *_ in found.history for name in shown)):
        values = [shown.get(name, np.nan) for _, shown, *_ in found.history]
        drawn[0].semilogy(times, values, STYLES[k % 4], color=COLOURS[k % 7], label=name)
    if found.weakest:
        drawn[0].semilogy(times, [size for *_, size in found.history], ":", color="0.3", label="weakest direction")
        for k, state in enumerate(found.weakest):
            parts = [abs(direction[state]) for _, _, direction, _ in found.history]
            drawn[1].plot(times, parts, STYLES[k % 4], color=COLOURS[k % 7], label=state)
        drawn[1].set(xlabel=f"time, {MODEL_UNIT}", ylabel="weakest direction, 1")
    drawn[0].set(xlabel=f"time, {MODEL_UNIT}", ylabel="standard deviation, unit of the target")
    drawn[0].legend(loc="best", frameon=False)
    return made


def plot_conditions(found: Conditions) -> Figure:
    """Certified condition numbers beside those of double precision, logarithmic."""
    made, axes = figure(height=3.0)
    names = [matrix.name for matrix in found]
    axes.semilogy(names, [float(matrix.value) for matrix in found], "o", color=COLOURS[0], label="certified")
    doubles = [np.nan if matrix.double is None else matrix.double for matrix in found]
    axes.semilogy(names, doubles, "x", color=COLOURS[1], markersize=9, label="double precision")
    axes.set(xlabel="matrix, name", ylabel="condition number, 1")
    axes.legend(loc="best", frameon=False)
    return made


def plot_fix(found: Fix) -> Figure:
    """The criterion over the hypotheses of position; needs the map of criteria, ``maps=True``."""
    if found.criterion_map is None:
        raise DomainError("expected a fix with its criterion map; got one without; ask locate for maps", where="plot")
    made, axes = figure(5.0, 4.2)
    rows, columns = found.criterion_map.shape
    half = (columns - 1) // 2, (rows - 1) // 2
    finite = np.where(np.isfinite(found.criterion_map), found.criterion_map, np.nan)
    extent = (-half[0] - 0.5, half[0] + 0.5, -half[1] - 0.5, half[1] + 0.5)
    drawn = axes.imshow(np.sqrt(finite), origin="lower", extent=extent, cmap="viridis")
    made.colorbar(drawn, ax=axes, label="root of the criterion, m")
    axes.plot(*found.position_index, "*", color=COLOURS[4], markeredgecolor="black", markersize=14)
    axes.set(xlabel="hypothesis in x, index", ylabel="hypothesis in y, index")
    return made


def plot_ledger(found: Ledger) -> Figure:
    """One square for each numbered equation, with its worst verdict."""
    papers = []
    for summary, records in found.by_paper():
        card = found.cards.get(summary.module)
        equations = card.equations if card else tuple(record.number for record in records)
        cells = []
        for equation in equations:
            about = records_about(equation, equations, records)
            damaged = bool(about) and may_be_the_copy(about[0])
            status = "definition" if not about else "perhaps the copy" if damaged else str(about[0].status)
            cells.append((equation, status))
        papers.append((summary.module, cells))
    return verdict_matrix(papers)


MODEL_UNIT = "unit of the model"
PICTURES: dict[type, Callable[[Any], Figure]] = {
    Estimator: plot_estimator,
    Phases: plot_phases,
    PhaseMap: plot_map,
    Estimates: plot_filter,
    Track: plot_track,
    Conditions: plot_conditions,
    Accuracy: plot_accuracy,
    Fix: plot_fix,
    Ledger: plot_ledger,
}


# Both sides of a refuted formula

POINTS = 160
INK = "#123456"  # replaced by the colour of the page's text
LARGEST = 1e12


@dataclass(frozen=True, slots=True, eq=False)
class RefutedCurves:
    """Printed and derived side along one symbol, the others at their values in the counterexample."""

    along: str
    point: Mapping[str, float]
    x: Array
    sides: tuple[Array, Array]
    marks: tuple[float, float]
    names: tuple[str, str]

    def words(self) -> str:
        """What the picture shows, for those who do not see it."""
        others = {name: number for name, number in self.point.items() if name != self.along}
        values = ", ".join(f"{name} = {number:.4g}" for name, number in others.items())
        held = (
            "" if not others else f" with {values}" if len(others) <= 4 else " with the others as in the counterexample"
        )
        at = f"at {self.along} = {self.point[self.along]:.4g} they are {self.marks[0]:.6g} and {self.marks[1]:.6g}"
        one, other = (name if "side" in name else f"{name} side" for name in self.names)
        return f"{one.capitalize()} (dashed) and {other} (solid) along {self.along}{held}; {at}. Units are the paper's."


def refutation_svg(record: Record) -> str:
    """Both sides of a refuted formula around its counterexample, as SVG for a page; empty where there is no curve."""
    curves = refuted_curves(record)
    if curves is None:
        return ""
    label = html.escape(f"{record.id}: {curves.words()}", quote=True)
    drawn = svg(refutation_plot(curves)).replace(INK, "currentColor")
    drawn = re.sub(r"<metadata>.*?</metadata>\s*", "", drawn[drawn.index("<svg") :], flags=re.DOTALL)
    drawn = drawn.replace("<svg ", f'<svg class="plot" role="img" aria-label="{label}" ', 1)
    return f"<figure>{drawn}<figcaption>{html.escape(curves.words())}</figcaption></figure>"


def refutation_plot(curves: RefutedCurves) -> Figure:
    """Solid line for the derived side, dashed for the printed one, a mark on each at the counterexample."""
    made, axes = figure(4.8, 2.4)
    made.patch.set_alpha(0)
    axes.patch.set_alpha(0)
    for name, style, colour, y, mark in zip(
        curves.names, ("--", "-"), COLOURS[1::-1], curves.sides, curves.marks, strict=True
    ):
        axes.plot(curves.x, y, style, color=colour, label=name)
        axes.plot(curves.point[curves.along], mark, "o", color=colour, fillstyle="none" if style == "--" else "full")
    values = np.sort(np.concatenate([y[np.isfinite(y)] for y in curves.sides]))
    low, high = values[len(values) // 20], values[-1 - len(values) // 20]  # poles are cut off
    low, high = min(low, *curves.marks), max(high, *curves.marks)
    margin = 0.08 * (high - low) or 0.5
    axes.set(xlabel=f"${latex_name(curves.along)}$", ylabel="both sides", ylim=(low - margin, high + margin))
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2, frameon=False, labelcolor=INK)
    axes.tick_params(colors=INK)
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set_color(INK)
    for spine in axes.spines.values():
        spine.set_edgecolor(INK)
    return made


def refuted_curves(record: Record) -> RefutedCurves | None:
    """Both sides along the first symbol of the counterexample that stands in them; None where there is no curve.

    For tuples and matrices the first entry that differs is drawn. Values are doubles: a picture, not a decision.
    """
    line = next((line for line in arithmetic(record) if line.differs), None) if record.derived else None
    texts = record.counterexample or {}
    along = next((n for n in texts if line is not None and any(n in side.names for side in line.sides)), None)
    if line is None or along is None:
        return None
    held = {name: height(read_side(text), {}) for name, text in texts.items()}
    lower, upper = sorted((0.02 * held[along], 2 * held[along])) if held[along] else (-1.0, 1.0)
    x = np.linspace(lower, upper, POINTS + 1)
    curves = tuple(np.array([height(side, held | {along: float(value)}) for value in x]) for side in line.sides)
    marks = tuple(height(side, held) for side in line.sides)
    if any(np.isfinite(y).sum() < POINTS // 4 for y in curves) or not all(np.isfinite((*marks, *held.values()))):
        return None
    names = ("one side", "other side") if record.paper.endswith(".toml") else ("printed", "derived")
    return RefutedCurves(along, held, x, curves, marks, names)  # type: ignore[arg-type]


def height(side: Side, point: Mapping[str, float]) -> float:
    """The value of a side at a point; NaN where there is none, or one of 1e12 and more."""
    try:
        ball = side.at({name: exact_ball(Fraction(number)) for name, number in point.items()})
    except (NavsymError, ArithmeticError, ValueError):
        return np.nan
    value = float(ball.mid()) if ball.is_finite() else np.nan
    return value if abs(value) < LARGEST else np.nan
