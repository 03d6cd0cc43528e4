"""Both sides of a refuted formula along one symbol, as a small SVG that follows the page's colours.

Drawn from the text of the record in double precision: a picture to see by, never a decision.
"""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from navsym.report.explain import entries_of
from navsym.report.formula.reader import Node, read_formula, unwrapped
from navsym.report.names import letter_of, split_name

Curve = list[tuple[float, float]]
POINTS = 160
WIDTH, HEIGHT = 460, 220
LEFT, RIGHT, TOP, BOTTOM = 72, 12, 26, 34

FUNCTIONS: dict[str, Callable[..., float]] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "exp": math.exp,
    "log": math.log,
    "sqrt": math.sqrt,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "atan2": math.atan2,
    "sinh": math.sinh,
    "cosh": math.cosh,
    "tanh": math.tanh,
    "abs": abs,
    "cot": lambda x: 1 / math.tan(x),
    "sec": lambda x: 1 / math.cos(x),
    "csc": lambda x: 1 / math.sin(x),
}
OPERATIONS: dict[str, Callable[[float, float], float]] = {
    "sum": lambda a, b: a + b,
    "difference": lambda a, b: a - b,
    "product": lambda a, b: a * b,
    "quotient": lambda a, b: a / b,
}


def value(node: Node, point: Mapping[str, float]) -> float:
    """Value of a formula in doubles; raises ValueError or ArithmeticError where there is none."""
    node = unwrapped(node)
    if node.kind == "number":
        return float(node.text)
    if node.kind == "name":
        return math.pi if node.text == "pi" else point[node.text]
    if node.kind == "minus":
        return -value(node.parts[0], point)
    if node.kind == "power":
        return real_power(*(value(part, point) for part in node.parts))
    if node.kind in OPERATIONS:
        return OPERATIONS[node.kind](*(value(part, point) for part in node.parts))
    if node.kind == "call" and node.text in FUNCTIONS:
        return FUNCTIONS[node.text](*(value(part, point) for part in node.parts))
    raise ValueError(f"no value for {node.kind}")


def real_power(base: float, exponent: float) -> float:
    """A power of real numbers; raises ValueError where it is not real."""
    result = base**exponent
    if isinstance(result, complex):
        raise ValueError("not real")
    return result


def refutation_plot(record: Mapping[str, Any]) -> str:
    """SVG of the printed and the derived side around the counterexample; empty where there is no curve.

    Drawn along the first symbol of the counterexample, the others held at their values. For
    tuples and matrices the first entry that differs is drawn.
    """
    point = record["counterexample"] or {}
    sides = differing_sides(record, point)
    if not point or sides is None:
        return ""
    centre = {name: constant(text) for name, text in point.items()}
    if any(number is None for number in centre.values()):
        return ""
    held = {name: number for name, number in centre.items() if number is not None}
    along = next((name for name in held if any(uses(side, name) for side in sides)), None)
    if along is None:
        return ""
    lower, upper = window(held[along])
    curves = [curve(side, along, held, lower, upper) for side in sides]
    marks = [safe(side, held) for side in sides]
    if any(len(points) < POINTS // 4 for points in curves) or None in marks:
        return ""
    return drawing(along, held, curves, [mark for mark in marks if mark is not None], (lower, upper), record["id"])


def differing_sides(record: Mapping[str, Any], point: Mapping[str, str]) -> tuple[Node, Node] | None:
    """Printed and derived trees of the first entry whose values differ at the point."""
    printed, derived = (entries_of(record[key].split(" +- ")[0]) for key in ("printed", "derived"))
    if not derived or len(printed) != len(derived):
        return None
    held = {name: constant(text) or 0.0 for name, text in point.items()}
    for left, right in zip(printed, derived, strict=True):
        first, second = read_formula(left), read_formula(right)
        if first is None or second is None:
            return None
        a, b = safe(first, held), safe(second, held)
        if a is not None and b is not None and abs(a - b) > 1e-9 * (abs(a) + abs(b)):
            return first, second
    return None


def constant(text: str) -> float | None:
    """The number that a text is, None when it is none."""
    node = read_formula(text)
    return None if node is None else safe(node, {})


def safe(node: Node, point: Mapping[str, float]) -> float | None:
    """The value of a formula at a point, None where it has none or is 1e12 and more."""
    try:
        found = value(node, point)
    except (ValueError, ArithmeticError, KeyError, TypeError):
        return None
    return found if math.isfinite(found) and abs(found) < 1e12 else None


def uses(node: Node, name: str) -> bool:
    """True when the name stands in the formula."""
    return (node.kind == "name" and node.text == name) or any(uses(part, name) for part in node.parts)


def window(centre: float) -> tuple[float, float]:
    """From near zero to twice the value: symbols are mostly lengths and times; around it when it is zero."""
    return (-1.0, 1.0) if centre == 0 else tuple(sorted((0.02 * centre, 2 * centre)))  # type: ignore[return-value]


def curve(side: Node, along: str, held: Mapping[str, float], lower: float, upper: float) -> Curve:
    """Points (x, y) of one side along a symbol, those with a value, the others held."""
    found = []
    for i in range(POINTS + 1):
        x = lower + (upper - lower) * i / POINTS
        y = safe(side, {**held, along: x})
        if y is not None:
            found.append((x, y))
    return found


def heights(curves: Sequence[Curve], marks: Sequence[float]) -> tuple[float, float]:
    """Range shown: poles are cut off at twice the height of the middle of all values around the marks."""
    values = sorted(y for points in curves for _, y in points)
    low, high = values[len(values) // 20], values[-1 - len(values) // 20]
    low, high = min(low, *marks), max(high, *marks)
    margin = 0.08 * (high - low) or 0.5
    return low - margin, high + margin


def drawing(
    along: str,
    held: Mapping[str, float],
    curves: Sequence[Curve],
    marks: Sequence[float],
    ends: tuple[float, float],
    name: str,
) -> str:
    """The SVG: solid line for the derived side, dashed for the printed one, a mark on each at the point."""
    low, high = heights(curves, marks)
    at_x = scale(ends, (LEFT, WIDTH - RIGHT))
    at_y = scale((low, high), (HEIGHT - BOTTOM, TOP))
    others = others_words({other: number for other, number in held.items() if other != along})
    words = f"Printed side (dashed) and derived side (solid) along {along}" + (f" with {others}" if others else "")
    words += f"; at {along} = {held[along]:.4g} they are {marks[0]:.6g} and {marks[1]:.6g}. Units are the paper's."
    parts = [*axes(along, ends, (low, high), at_x, at_y), *KEY]
    for kind, points in zip(("printed", "derived"), curves, strict=True):
        parts.append(f'<path class="line {kind}" d="{path(points, at_x, at_y, low, high)}"/>')
    for kind, mark in zip(("printed", "derived"), marks, strict=True):
        parts.append(f'<circle class="mark {kind}" cx="{at_x(held[along]):.1f}" cy="{at_y(mark):.1f}" r="4"/>')
    label = html.escape(f"{name}: {words}", quote=True)
    return (
        f'<figure><svg class="plot" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{label}">'
        + "".join(parts)
        + f"</svg><figcaption>{html.escape(words)}</figcaption></figure>"
    )


def key(x: int, kind: str) -> str:
    """A line of its kind with its name, above the frame."""
    return f'<path class="line {kind}" d="M{x} 12h24"/><text class="tick" x="{x + 29}" y="16">{kind}</text>'


KEY = (key(LEFT + 8, "printed"), key(LEFT + 110, "derived"))


def written(name: str) -> str:
    """A symbol as an axis names it: a letter with its index below."""
    stem, index = split_name(name)
    below = f'<tspan dy="3" font-size="8">{html.escape(index)}</tspan>' if index else ""
    return html.escape(letter_of(stem)) + below


def others_words(held: Mapping[str, float]) -> str:
    """What the other coordinates are, where a reader can take them in."""
    if len(held) > 4:
        return "the others as in the counterexample"
    return ", ".join(f"{name} = {number:.4g}" for name, number in held.items())


def scale(source: tuple[float, float], target: tuple[float, float]) -> Callable[[float], float]:
    """The linear map that takes one interval to the other."""
    slope = (target[1] - target[0]) / (source[1] - source[0])
    return lambda x: target[0] + (x - source[0]) * slope


def axes(
    along: str,
    ends: tuple[float, float],
    limits: tuple[float, float],
    at_x: Callable[[float], float],
    at_y: Callable[[float], float],
) -> list[str]:
    """SVG of the axes, their ticks and the grid."""
    bottom = HEIGHT - BOTTOM
    parts = [f'<path class="axis" d="M{LEFT} {TOP}V{bottom}H{WIDTH - RIGHT}"/>']
    for x in ticks(*ends):
        parts.append(f'<text class="tick" x="{at_x(x):.1f}" y="{bottom + 14}" text-anchor="middle">{x:.4g}</text>')
    for y in ticks(*limits):
        parts.append(f'<text class="tick" x="{LEFT - 6}" y="{at_y(y) + 4:.1f}" text-anchor="end">{y:.4g}</text>')
        parts.append(f'<path class="grid" d="M{LEFT} {at_y(y):.1f}H{WIDTH - RIGHT}"/>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    parts.append(f'<text class="tick" x="{middle}" y="{HEIGHT - 4}" text-anchor="middle">{written(along)}</text>')
    height = (TOP + bottom) / 2
    parts.append(
        f'<text class="tick" transform="translate(12 {height}) rotate(-90)" text-anchor="middle">both sides</text>'
    )
    return parts


def ticks(low: float, high: float) -> list[float]:
    """Four to eight round numbers."""
    step = 10 ** math.floor(math.log10((high - low) / 4))
    step = next(step * factor for factor in (1, 2, 5, 10) if (high - low) / (step * factor) <= 7)
    first = math.ceil(low / step)
    return [k * step for k in range(first, math.floor(high / step) + 1)]


def path(points: Curve, at_x: Callable[[float], float], at_y: Callable[[float], float], low: float, high: float) -> str:
    """A polyline that is lifted over what lies outside the window."""
    found, down = [], False
    for x, y in points:
        inside = low <= y <= high
        if inside:
            found.append(f"{'L' if down else 'M'}{at_x(x):.1f} {at_y(y):.1f}")
        down = inside
    return "".join(found)
