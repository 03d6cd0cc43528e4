"""Functions of our own in exported code: against cancellation, and defined where only the formula has a hole.

Every language writes them from the same parts (:func:`helper_parts`); their bounds are proved in the tests.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from navsym.export.parts import ExportedFunction

if TYPE_CHECKING:
    from navsym.export.languages.printing import Spelling

#: 1/6, 1/20, 1/42, …: sin(x)/x = 1 - y/6 (1 - y/20 (1 - y/42 …)) with y = x^2.
SINC_STEPS = (6, 20, 42, 72)
#: (x - sin x) = x^3/6 (1 - y/20 (1 - y/42 (…))).
X_MINUS_SIN_STEPS = (20, 42, 72, 110, 156, 210, 272, 342, 420)


@dataclass(frozen=True, slots=True)
class Helper:
    """A function without cancellation and without a hole at zero: a series below the switch, the formula above it.

    about  : what it is, and why the series will do; {switch} in it
    steps  : divisors of the nested series {series} in y = x^2; none for one that is constant
    series : the series with what stands before and behind it; {one} and {six} are numbers
    formula : the plain form; {x} is the argument, {sin}, {sinh}, {expm1} are functions of it
    """

    about: str
    switch: float
    steps: tuple[int, ...]
    series: str
    formula: str


HELPERS = {
    "sinc": Helper(
        "sin(x)/x; below {switch} its series, whose remainder is under x^10/11! < 2^-65.",
        0.0625, SINC_STEPS, "{series}", "{sin} / {x}",
    ),
    "x_minus_sin": Helper(
        "x - sin(x); below {switch} its series, since the difference would cancel.",
        1.0, X_MINUS_SIN_STEPS, "((x * y) / {six}) * {series}", "{x} - {sin}",
    ),
    "sinc_defect": Helper(
        "(x - sin(x))/x^3; below {switch} its series, since the difference would cancel; 1/6 at zero.",
        1.0, X_MINUS_SIN_STEPS, "{series} / {six}", "((({x} - {sin}) / {x}) / {x}) / {x}",
    ),
    "exprel": Helper("(exp(x) - 1)/x; below {switch} it is 1 within 2^-61.", 2.0**-60, (), "{one}", "{expm1} / {x}"),
    "sinhc": Helper("sinh(x)/x; below {switch} it is 1 within 2^-62.", 2.0**-30, (), "{one}", "{sinh} / {x}"),
}  # fmt: skip


def helpers_used(*functions: ExportedFunction) -> list[str]:
    """Names of the helper functions that the code needs."""
    used = {node.op for function in functions for piece in function.pieces for node in piece.graph.nodes}
    return [name for name in HELPERS if name in used]


def horner(steps: tuple[int, ...], one: str, number: Any) -> str:
    """The nested product 1 - y/s1 (1 - y/s2 (…))."""
    text = f"({one} - (y / {number(float(steps[-1]))}))"
    for step in reversed(steps[:-1]):
        text = f"({one} - ((y / {number(float(step))}) * {text}))"
    return text


def helper_parts(name: str, s: Spelling, x: str = "x") -> tuple[str, str, str]:
    """(switch, series below it, formula above it) of a helper in this language; ``x`` is the formula's argument."""
    helper, one = HELPERS[name], s.number(1.0)
    series = horner(helper.steps, one, s.number) if helper.steps else ""
    functions = {f: s.calls[f].format(x) for f in ("sin", "sinh", "expm1")}
    below = helper.series.format(series=series, one=one, six=s.number(6.0))
    return s.number(helper.switch), below, helper.formula.format(x=x, **functions)


def helper_about(name: str, s: Spelling) -> str:
    """The comment of a helper."""
    return HELPERS[name].about.format(switch=s.number(HELPERS[name].switch).removesuffix(s.suffix))


def squares_if_needed(name: str, line: str) -> list[str]:
    """The line that makes y, for a helper whose series has it."""
    return [line] if HELPERS[name].steps else []
