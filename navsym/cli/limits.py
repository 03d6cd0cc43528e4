"""The least error of velocity and acceleration that any algorithm can guarantee from positions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._options import called_options
from navsym.cli.output import Told, table

if TYPE_CHECKING:
    from navsym.trajectory.limits import Limit, Limits


def command(
    *,
    noise: float,
    acceleration: float | None = None,
    jerk: float | None = None,
    step: float | None = None,
    memory: float | None = None,
) -> Told:
    """The least error of a velocity that any algorithm guarantees from positions, and the rule that reaches it.

    Example: navsym limits --noise 5 --acceleration 0.5 --step 1
    """
    with called_options("limits"):
        found = nav.limits(noise, acceleration=acceleration, jerk=jerk, step=step, memory=memory)
    return Told(found.document, lambda: as_text(found))


def as_text(found: Limits) -> str:
    """The limits, and what is lost by sampling."""
    unit = {"acceleration": "m/s^2", "jerk": "m/s^3"}[found.bounded]
    blocks = [
        f"positions wrong by at most {found.noise:g} m, {found.bounded} at most {found.bound:g} {unit}\n",
        rules_text("least guaranteed error", found.limits),
        "No algorithm does better; these positions reach it, and older ones add nothing.\nProved in "
        + "; ".join(f"{limit.claims[0]}, .upper" for limit in found.limits)
        + "\n",
    ]
    if found.sampled:
        blocks.append(rules_text(f"guaranteed with a position every {found.sampled.step:g} s", found.sampled.limits))
    return "\n".join(blocks)


def rules_text(title: str, limits: tuple[Limit, ...]) -> str:
    """Errors with the ages and weights that reach them."""
    rows = [
        [limit.derivative, f"{limit.rule.error:.6g} {limit.unit}", *map(several, (limit.rule.ages, limit.rule.weights))]
        for limit in limits
    ]
    return table(["", title, "ages of the positions, s", "weights"], rows)


def several(numbers: Iterable[float]) -> str:
    """Numbers in one cell."""
    return "; ".join(f"{number:.6g}" for number in numbers)
