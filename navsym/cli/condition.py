"""Certified condition numbers of a polynomial motion seen through its position.

The work is done by :func:`navsym.trajectory.conditioning.document`; this file reads, calls and prints.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, remark, table

MATRICES = ("N_p", "N_pN", "N_f", "N_s")


def command(
    n: Annotated[int, typer.Option("--n", help="order of the motion, 1 to 120")],
    tau: Annotated[str, typer.Option("--tau", help="step in seconds: decimal or fraction, read exactly")] = "0.2",
    rho: Annotated[str, typer.Option("--rho", help="factor of the speed, 1/m: decimal or fraction")] = "1/6371000",
    digits: Annotated[int, typer.Option("--digits", help="significant digits of the enclosures")] = 30,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Certified 2-norm condition numbers of the matrices N_p, N_pN, N_f and N_s, beside double precision.

    Example: navsym condition --n 20 --tau 0.2 --rho 1/6371000
    """
    from navsym.trajectory.conditioning import document

    with Progress("matrices", len(MATRICES), "nothing is kept: a smaller --n or fewer --digits take less time") as bar:
        found = document(n, exact("--rho", rho), exact("--tau", tau), digits, bar.step)
    for line in found["warnings"]:
        remark(f"warning: {line}")
    emit(found, as_json=json_, text=lambda: shown(found))


def exact(name: str, text: str) -> Fraction:
    """A decimal or a fraction, read exactly; nothing else and nothing huge."""
    import re

    from navsym.core.errors import ExpressionSyntaxError, TooLargeError

    number = r"\d{1,60}(?:\.\d{0,60})?(?:[eE][+-]?\d{1,3})?"
    if not re.fullmatch(rf"[+-]?{number}(?:/{number})?", text.strip(), re.ASCII):
        message = f"expected a decimal or a fraction such as 1/6371000; got {text[:60]!r}; write it so"
        raise ExpressionSyntaxError(message, where=name)
    above, _, below = text.strip().partition("/")
    if below and Fraction(below) == 0:
        raise ExpressionSyntaxError("expected a denominator that is not zero; got 0; correct it", where=name)
    value = Fraction(above) / (Fraction(below) if below else 1)
    if value and not Fraction(1, 10**100) < abs(value) < 10**100:
        raise TooLargeError("expected a number between 1e-100 and 1e100; got another; rescale it", where=name)
    return value


def shown(found: dict[str, Any]) -> str:
    rows = [(name, found[name]["lower"], found[name]["upper"], *double(found[name])) for name in MATRICES]
    head = ("matrix", "at least", "at most", "double precision", "off by")
    title = f"condition numbers, n = {found['n']}, tau = {found['tau']} s, rho = {found['rho']} 1/m"
    return f"{title}\n" + table(head, rows, right=head[1:])


def double(part: dict[str, Any]) -> tuple[str, str]:
    if part["double"] is None:
        return "overflow", ""
    return f"{part['double']:.6e}", f"{100 * part['relative_error']:+.2g} %"
