"""The least error of velocity and acceleration that any algorithm can guarantee from positions.

The work is done by :mod:`navsym.trajectory.limits`; this file reads, calls and prints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.cli.output import emit, table
from navsym.core.errors import DomainError, TooLargeError

if TYPE_CHECKING:
    from navsym.core.arrays import Array
    from navsym.trajectory.limits import Rule

#: Order of the derivative that is bounded -> its name and unit.
BOUNDED = {2: ("acceleration", "m/s^2"), 3: ("jerk", "m/s^3")}
#: Derivative that is asked for -> its name and unit.
ASKED = {1: ("velocity", "m/s"), 2: ("acceleration", "m/s^2")}
#: Closed forms of the least error, by derivative and order.
FORMULAS = {
    (1, 2): "2*sqrt(noise*acceleration)",
    (1, 3): "(243/8*noise**2*jerk)**(1/3)",
    (2, 3): "(24*noise*jerk**2)**(1/3)",
}
MOST_POSITIONS = 1_000_000
LEAST = 1e-50


def command(
    noise: Annotated[float, typer.Option(help="largest error of a position, metres")],
    acceleration: Annotated[float | None, typer.Option(help="largest acceleration of the motion, m/s^2")] = None,
    jerk: Annotated[float | None, typer.Option(help="or: largest rate of the acceleration, m/s^3")] = None,
    step: Annotated[float | None, typer.Option(help="positions come every so many seconds")] = None,
    memory: Annotated[
        float | None, typer.Option(help="seconds of positions at hand, with --step; default: as many as help")
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """The least error of a velocity that any algorithm guarantees from positions, and the rule that reaches it.

    Example: navsym limits --noise 5 --acceleration 0.5 --step 1
    """
    order, bound = bounded(acceleration, jerk)
    for name, value in (("--noise", noise), (f"--{BOUNDED[order][0]}", bound)):
        if not LEAST < value < 1 / LEAST:
            between = f"a positive number between {LEAST:g} and {1 / LEAST:g}"
            message = f"expected {between}; got {value:g}; give the largest absolute value"
            raise DomainError(message, where=name)
    limits = [limit(noise, bound, derivative, order) for derivative in range(1, order)]
    data = {
        "noise": noise,
        "bounded": BOUNDED[order][0],
        "bound": bound,
        "limits": limits,
        "sampled": sampled(noise, bound, order, step, memory),
    }
    emit(data, as_json=json_, text=lambda: as_text(data))


def bounded(acceleration: float | None, jerk: float | None) -> tuple[int, float]:
    """Order of the derivative that is known to stay within a bound, and the bound."""
    if acceleration is not None and jerk is None:
        return 2, acceleration
    if jerk is not None and acceleration is None:
        return 3, jerk
    got = "neither" if jerk is None else "both"
    message = f"expected one of --acceleration and --jerk; got {got}; say what of the motion is bounded"
    raise DomainError(message, where="--acceleration, --jerk")


def limit(noise: float, bound: float, derivative: int, order: int) -> dict[str, Any]:
    """What no algorithm undercuts, and the rule that reaches it."""
    from navsym.trajectory.limits import best_ages, least_error, rule

    name, unit = ASKED[derivative]
    claims = f"trajectory:limit.{name}.{BOUNDED[order][0]}"
    return {
        "derivative": name,
        "unit": unit,
        "least_error": least_error(noise, bound, derivative, order),
        "formula": FORMULAS[derivative, order],
        "rule": as_data(rule(best_ages(noise, bound, order), noise, bound, derivative)),
        "claims": [f"{claims}.lower", f"{claims}.upper"],
    }


def sampled(noise: float, bound: float, order: int, step: float | None, memory: float | None) -> dict[str, Any] | None:
    """The best rules among positions that come at a rate; None without one."""
    from navsym.trajectory.limits import best_rule

    if step is None:
        if memory is not None:
            message = "expected --step with it; got --memory alone; say how often positions come"
            raise DomainError(message, where="--memory")
        return None
    ages = available(noise, bound, order, step, memory)
    rules = [
        {"derivative": ASKED[d][0], "unit": ASKED[d][1], "rule": as_data(best_rule(ages, noise, bound, d, order))}
        for d in range(1, order)
    ]
    return {"step": step, "positions": len(ages), "limits": rules}


def available(noise: float, bound: float, order: int, step: float, memory: float | None) -> Array:
    """Ages of the positions at hand: no more of them than can help."""
    import math

    import numpy as np

    from navsym.trajectory.limits import NEAR, best_ages

    for name, value in (("--step", step), ("--memory", memory)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise DomainError(f"expected a positive number of seconds; got {value}; correct it", where=name)
    useful = float(best_ages(noise, bound, order)[-1]) / step + NEAR
    count = min(useful, math.inf if memory is None else memory / step * (1 + 1e-12))
    if count >= MOST_POSITIONS:
        message = f"expected at most {MOST_POSITIONS} positions; got about {count:.3g}; give a longer --step"
        raise TooLargeError(message, where="--step")
    if count < order - 1:
        message = f"expected at least {order} positions; got {math.floor(count) + 1}; remember more of them"
        raise DomainError(message, where="--memory")
    return np.arange(math.floor(count) + 1, dtype=float) * step


def as_data(found: Rule) -> dict[str, Any]:
    """A rule as plain data."""
    return {
        "ages": found.ages.tolist(),
        "weights": found.weights.tolist(),
        "error": found.error,
        "noise": found.noise,
        "motion": found.motion,
    }


# Text for people


def as_text(data: dict[str, Any]) -> str:
    """The limits, and what is lost by sampling."""
    name = data["bounded"]
    unit = next(unit for known, unit in BOUNDED.values() if known == name)
    blocks = [
        f"positions wrong by at most {data['noise']:g} m, {name} at most {data['bound']:g} {unit}\n",
        rules_text("least guaranteed error", data["limits"]),
        "No algorithm does better; these positions reach it, and older ones add nothing.\nProved in "
        + "; ".join(found["claims"][0] + ", .upper" for found in data["limits"])
        + "\n",
    ]
    if data["sampled"]:
        head = f"guaranteed with a position every {data['sampled']['step']:g} s"
        blocks.append(rules_text(head, data["sampled"]["limits"]))
    return "\n".join(blocks)


def rules_text(title: str, found: list[dict[str, Any]]) -> str:
    """Errors with the ages and weights that reach them."""
    rows = [
        [
            part["derivative"],
            f"{part['rule']['error']:.6g} {part['unit']}",
            several(part["rule"]["ages"]),
            several(part["rule"]["weights"]),
        ]
        for part in found
    ]
    return table(["", title, "ages of the positions, s", "weights"], rows)


def several(numbers: list[float]) -> str:
    return "; ".join(f"{number:.6g}" for number in numbers)
