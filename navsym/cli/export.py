"""Write proved formulas as code with vectors, bounds and certificates, compiled and run."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, table
from navsym.core.errors import DomainError, NavsymError

if TYPE_CHECKING:
    from navsym.export.functions import ExportedFunction, Material

SECONDS = 90.0
MEGABYTES = 4096
RESUME = "nothing was written: fewer languages in --to, fewer --vectors, or --no-run take less time"


def command(
    claims: Annotated[
        list[str], typer.Argument(help="module:number, FILE.toml:id, or regimes joined as A+B+C; or a ready-made name")
    ],
    to: Annotated[str, typer.Option("--to", help="languages separated by commas: see the documentation for all")] = "c",
    out: Annotated[Path, typer.Option("--out", help="folder for the code; made when it is not there")] = Path("export"),
    real: Annotated[str, typer.Option("--real", help="floating-point type of the code: double or float")] = "double",
    force: Annotated[bool, typer.Option("--force", help="replace files that are there")] = False,
    allow_confirmed: Annotated[
        bool, typer.Option("--allow-confirmed", help="accept claims that were only sampled (CONFIRMED)")
    ] = False,
    license_: Annotated[str, typer.Option("--license", help="SPDX identifier for the headers")] = "Apache-2.0",
    vectors: Annotated[int, typer.Option("--vectors", min=4, max=100_000, help="test vectors for each function")] = 48,
    unit: Annotated[
        list[str] | None, typer.Option("--unit", help="unit of a symbol or result, such as T=s; may be repeated")
    ] = None,
    run: Annotated[
        bool, typer.Option("--run/--no-run", help="compile and run the code on its vectors where this machine can")
    ] = True,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Write formulas that hold as code; what does not hold is refused, and what corrects it is named.

    Example: navsym export guaranteed_velocity:4.13.y3 --to c,python --out build/drift
    """
    from navsym.export.languages.targets import chosen
    from navsym.export.package import Order, export

    if real not in ("double", "float"):
        raise DomainError(f"expected double or float; got {real[:20]!r}; do correct it", where="--real")
    targets = tuple(chosen(to.split(","), real))
    units = dict(read_unit(text) for text in unit or [])
    words = ["navsym", "export", *claims, "--to", to, "--real", real, "--license", license_, "--vectors", str(vectors)]
    words += ["--allow-confirmed"] if allow_confirmed else []
    words += [word for text in unit or [] for word in ("--unit", text)]
    order = Order(targets, license_, vectors, tuple(words))
    wanted, functions = expanded(claims), []
    with Progress("parts", len(wanted) + len(targets), RESUME) as bar:
        for claim in wanted:
            functions += functions_for(claim, real, allow_confirmed, units)
            bar.step(claim)
        document = export(functions, order, out, force=force, execute=run, progress=bar.step)
    emit(document, as_json=json_, text=lambda: as_text(document))
    return 0


def expanded(claims: list[str]) -> list[str]:
    """Ready-made names replaced by what they stand for."""
    from navsym.export.ready import READY

    return [part for claim in claims for part in READY.get(claim, (claim,))]


def read_unit(text: str) -> tuple[str, str]:
    """``"T=s"`` as a name and a unit."""
    name, equals, words = (part.strip() for part in text.partition("="))
    if not (name and equals and words) or len(words) > 60 or not (words.isascii() and words.isprintable()):
        raise DomainError(f"expected NAME=UNIT in ASCII; got {text[:60]!r}; do correct it", where="--unit")
    return name, words


def functions_for(
    text: str, real: str, allow_confirmed: bool, units: Mapping[str, str] | None = None
) -> list[ExportedFunction]:
    """The functions of one argument; ``name=A+B`` gives a name; a ready-made program has two."""
    from navsym.export.functions import function_of
    from navsym.export.languages.names import function_name
    from navsym.export.parts import Layout
    from navsym.export.ready import ALGORITHMS, UNITS, algorithm

    if text in ALGORITHMS:
        return algorithm(text, lambda claim: material_for(claim, allow_confirmed), real)
    name, _, claims = text.rpartition("=") if "=" in text else ("", "", text)
    parts = [material_for(part, allow_confirmed) for part in claims.split("+")]
    known = {**UNITS.get(claims.partition(":")[0], {}), **(units or {})}
    return [function_of(parts, real=real, name=function_name(name) if name else None, layout=Layout(units=known))]


def material_for(text: str, allow_confirmed: bool) -> Material:
    """A claim of a paper or of a file, decided."""
    module, colon, number = text.rpartition(":")
    if not colon or not module or not number:
        raise DomainError(
            f"expected MODULE:NUMBER or FILE.toml:ID; got {text[:80]!r}; do correct it", where="command line"
        )
    if module.endswith(".toml"):
        return from_file(Path(module), number, allow_confirmed)
    return from_paper(module, number, allow_confirmed)


def from_paper(module: str, number: str, allow_confirmed: bool) -> Material:
    from navsym.claims import equation_of
    from navsym.cli.verify import load
    from navsym.export.functions import material
    from navsym.prove.ladder import decide_within

    (found,) = load([module])
    by_number = {claim.number: claim for claim in found.claims}
    if number not in by_number:
        raise unknown(number, list(by_number), module)
    claim = by_number[number]
    statement = claim.derive()
    corrections = [c.id for c in found.claims if c.corrects == number]
    equation = equation_of(number, found.paper.equations)
    return material(
        claim.id,
        statement,
        decide_within(statement, SECONDS),
        title=claim.title,
        paper=", ".join([*found.paper.authors, found.paper.title, str(found.paper.year or "")]).strip(", "),
        equation=f"equation ({equation})" if equation else f"statement {number}",
        correction=corrections[0] if corrections else None,
        allow_confirmed=allow_confirmed,
    )


def from_file(path: Path, wanted: str, allow_confirmed: bool) -> Material:
    from navsym.core.sandbox import Exhausted, run_limited
    from navsym.export.functions import material
    from navsym.prove.claimfile import decide_claim, read_claims, statement_of
    from navsym.prove.ladder import exhausted

    claims = {claim.id: claim for claim in read_claims(path).claims}
    if wanted not in claims:
        raise unknown(wanted, list(claims), path.name)
    claim = claims[wanted]
    outcome = run_limited(decide_claim, (claim,), SECONDS, MEGABYTES)
    verdict = exhausted(outcome) if isinstance(outcome, Exhausted) else outcome
    return material(
        f"{path.stem}:{wanted}",
        statement_of(claim),
        verdict,
        title=f"Claim {wanted} of a claim file",
        equation=f"claim {wanted}",
        paper=path.name,
        allow_confirmed=allow_confirmed,
    )


def unknown(name: str, known: list[str], where: str) -> NavsymError:
    close = difflib.get_close_matches(name, known, n=1)
    advice = f"did you mean {close[0]}?" if close else f"known are {', '.join(known[:8])}"
    return DomainError(f"expected a claim of {where}; got {name[:60]}; {advice}", where="command line")


def as_text(document: dict[str, Any]) -> str:
    rows = []
    for language in document["languages"]:
        found = language["functions"].values()
        worst = max((f["worst"] for f in found), default=None)
        count = sum(f["vectors"] for f in found)
        rows.append(
            (
                language["language"],
                language["status"],
                count or "",
                "" if worst is None else f"{worst:.2g}",
                language["why"],
            )
        )
    lines = [f"{f['name']}: {'; '.join(f['rounding'])}" for f in document["functions"]]
    head = table(("language", "status", "vectors", "worst eps", "remark"), rows)
    return "\n".join([*lines, head, f"{document['files']} files in {document['out']}"])
