"""Write proved formulas as code with vectors, bounds and certificates, compiled and run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._options import called_options
from navsym.cli._progress import Progress
from navsym.cli._settings import values_of
from navsym.cli.output import Told, table

if TYPE_CHECKING:
    from navsym.export.package import Exported

RESUME = "nothing was written; fewer languages in --to, fewer --vectors, or --no-run take less time"


def command(
    claims: list[str],
    *,
    to: str = "c",
    out: Path = Path("export"),
    real: str = "double",
    force: bool = False,
    allow_confirmed: bool = False,
    license_: str = "Apache-2.0",
    vectors: int = 48,
    unit: list[str] | None = None,
    run: bool = True,
) -> Told:
    """Write formulas that hold as code. A claim that does not hold is refused, with the one that corrects it.

    Example: navsym export guaranteed_velocity:4.13.y3 --to c,python --out build/drift
    """
    units = values_of(unit, "--unit", "NAME=UNIT in ASCII", "--unit T=s")
    words = ["navsym", "export", *claims, "--to", to, "--real", real, "--license", license_, "--vectors", str(vectors)]
    words += ["--allow-confirmed"] if allow_confirmed else []
    words += [word for text in unit or [] for word in ("--unit", text)]
    with called_options("export"), Progress("parts", resume=RESUME) as bar:
        exported = nav.export(
            claims,
            to=to.split(","),
            out=out,
            real=real,
            force=force,
            allow_confirmed=allow_confirmed,
            license=license_,
            vectors=vectors,
            units=units,
            run=run,
            command=words,
            progress=bar.follow,
        )
    return Told(exported.document, lambda: as_text(exported))


def as_text(exported: Exported) -> str:
    """The rounding bound of each function, and how each language did on its vectors."""
    rows = []
    for outcome in exported.outcomes:
        numbers = outcome.functions.values()
        worst = max((far for _, _, far in numbers), default=None)
        count = sum(n for n, _, _ in numbers)
        rows.append(
            (outcome.language, outcome.status, count or "", "" if worst is None else f"{worst:.2g}", outcome.why)
        )
    lines = [f"{f['name']}: {'; '.join(f['rounding'])}" for f in exported.document()["functions"]]
    head = table(("language", "status", "vectors", "worst eps", "remark"), rows)
    return "\n".join([*lines, head, f"{len(exported.files)} files in {exported.out}"])
