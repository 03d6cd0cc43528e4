"""Certified condition numbers of a polynomial motion seen through its position."""

from __future__ import annotations

import navsym as nav
from navsym.cli._options import called_options
from navsym.cli._progress import Progress
from navsym.cli.output import Told, remark, table


def command(*, n: int, tau: str = "0.2", rho: str = "1/6371000", digits: int = 30) -> Told:
    """Certified 2-norm condition numbers of the matrices N_p, N_pN, N_f and N_s, beside double precision.

    Example: navsym condition --n 20 --tau 0.2 --rho 1/6371000
    """
    resume = "nothing is kept: a smaller --n or fewer --digits take less time"
    with called_options("condition"), Progress("matrices", 4, resume) as bar:
        found = nav.condition(n, tau, rho, digits, progress=bar.step)
    for line in found.warnings:
        remark(f"warning: {line}")
    heads, rows = found.table()
    title = f"condition numbers, n = {found.n}, tau = {found.tau} s, rho = {found.rho} 1/m"
    return Told(found.document, lambda: table(heads, rows, title=title, right=heads[1:]))
