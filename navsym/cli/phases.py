"""The complete solution as a parameter varies: regimes, boundaries, closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli._settings import values_of
from navsym.cli.output import dumps, emit, table, write_text
from navsym.core.errors import DomainError, ExpressionSyntaxError, NavsymError

RESUME = "nothing is kept: a shorter --range, --quick, or fewer --seconds take less time"


def command(
    file: Annotated[Path, typer.Argument(help="model or basis file (TOML)")],
    target: Annotated[str | None, typer.Option(help="name of the target; not needed where the file has one")] = None,
    parameter: Annotated[str, typer.Option(help="name of the parameter that is the interval's length")] = "T",
    range_: Annotated[
        str | None, typer.Option("--range", help='its range, such as "0, 2*pi"; default: the declared one')
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="value of another parameter, such as w=1/2; may be repeated")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="leave regimes without a closed form uncertified")] = False,
    unique: Annotated[
        bool, typer.Option("--unique", help="prove of closed forms, too, that no other estimator is optimal (slower)")
    ] = False,
    seconds: Annotated[
        float,
        typer.Option(help="work (processor time) after which what is known is given, and the rest named as uncovered"),
    ] = 300.0,
    out: Annotated[Path | None, typer.Option(help="write the certificates to files of this name, numbered")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Which instants, which weights and which value are optimal, on exactly which range of a parameter.

    Example: navsym phases examples/schuler-velocity.toml --target drift --range "0, 2*pi"
    """
    from navsym.guaranteed.phases.driver import phases
    from navsym.guaranteed.phases.family import family_of
    from navsym.models.modelfile import read_model

    found = read_model(file, values_of(set_))
    try:
        lower, upper = ends_of(found, parameter, range_)
        with Progress("steps", resume=RESUME) as bar:
            answer = phases(
                family_of(found, target, parameter),
                lower,
                upper,
                certify=not quick,
                alone=unique,
                seconds=seconds,
                progress=bar.told_by_job,
            )
    except NavsymError as error:
        raise error.at(str(file)) from None
    document = answer.document()
    if out is not None:
        for k, certificate in enumerate(answer.certificates()):
            write_text(out.with_name(f"{out.stem}-{k + 1}.json"), dumps(certificate) + "\n")
    emit(document, as_json=json_, text=lambda: as_text(document))


def ends_of(found: Any, parameter: str, text: str | None) -> tuple[Any, Any]:
    """The range of the option, or the one that the file declares for the parameter."""
    from navsym.language.expression import parse

    if text is not None:
        parts = text.split(",")
        if len(parts) != 2:
            raise ExpressionSyntaxError(
                f'expected two numbers; got {text[:40]!r}; write --range "0, 2*pi"', where="--range"
            )
        return parse(parts[0], {}, where="--range"), parse(parts[1], {}, where="--range")
    for symbol, ends in found.box.items():
        if symbol.name == parameter and None not in ends:
            return ends
    raise DomainError(f'expected a range of {parameter}; got none; give --range "0, 2*pi"')


def as_text(document: dict[str, Any]) -> str:
    """Regimes with instants and weights, what happens between them, values of implicit ones, what is left out."""
    name, (lower, upper) = document["parameter"], document["range"]
    title = f"{document['target']}, {name} from {lower} to {upper}"
    heads = ("regime", name, "value", "instant", "weight", "measurement", "only one", "verdict")
    rows = [row for k, regime in enumerate(document["regimes"], 1) for row in regime_rows(k, regime, name)]
    parts = [table(heads, rows, title=title)]
    if document["boundaries"]:
        changes = [(b["at"] or "no closed form", located(b), b["why"]) for b in document["boundaries"]]
        parts.append(table((name, "decimal", "what happens there"), changes, title="Boundaries"))
    for k, regime in enumerate(document["regimes"], 1):
        if "table" in regime:
            rows = [row for one in regime["table"] for row in value_rows(one, name)]
            title = f"Regime {k}: values at some {name}"
            parts.append(table((name, "value", "instant", "weight", "measurement"), rows, title=title))
    return "\n\n".join([*parts, "\n".join(remarks(document))])


def regime_rows(k: int, regime: dict[str, Any], name: str) -> list[tuple[str, ...]]:
    """One line for every instant; what holds for all of them stands on the first."""
    only = {True: "yes", None: "not decided"}[regime["unique"]]
    known = f"{short(regime['from'])} < {name} < {short(regime['to'])}", regime["value"] or "see below"
    first, rest = (str(k), *known), ("", "", "")
    last = (only, regime["status"])
    return [
        (*(rest if i else first), row["at"] or "inside", weight(row), row["measurement"], *(("", "") if i else last))
        for i, row in enumerate(regime["support"])
    ]


def weight(row: dict[str, Any]) -> str:
    """The weight's closed form, or its sign."""
    return str(row["weight"]) if "weight" in row else "negative" if row["sign"] < 0 else "positive"


def value_rows(one: dict[str, Any], name: str) -> list[tuple[str, ...]]:
    """The enclosed value at one value of the parameter, with instants and weights to seven digits."""
    first = one[name], between(one["lower"], one["upper"])
    return [
        (*(("", "") if i else first), f"{float(row['at']):.7g}", f"{float(row['weight']):.7g}", row["measurement"])
        for i, row in enumerate(one["support"])
    ]


def short(end: str) -> str:
    """A long decimal cut after twelve digits, and shown to be."""
    whole, point, digits = end.partition(".")
    return f"{whole}.{digits[:12]}…" if point and digits.isdigit() and len(digits) > 12 else end


def located(boundary: dict[str, Any]) -> str:
    """A boundary as a decimal: sixteen digits of what is known exactly, else the digits that its ends share."""
    lower, upper = boundary["lower"], boundary["upper"]
    return between(lower, upper) if boundary["at"] is None else f"{(float(lower) + float(upper)) / 2:.16g}"


def between(lower: str, upper: str) -> str:
    """The digits that two decimals share, or both where they share few."""
    same = next((k for k, (a, b) in enumerate(zip(lower, upper, strict=False)) if a != b), len(lower))
    shared = lower[:same]
    if lower == upper:
        return lower
    return f"{shared[:24]}…" if "." in shared[:-4] else f"{lower[:16]} to {upper[:16]}"


def remarks(document: dict[str, Any]) -> list[str]:
    """What the verdicts mean, and whether anything is left out."""
    name, (lower, upper) = document["parameter"], document["range"]
    said = {regime["status"] for regime in document["regimes"]}
    words = {
        "PROVED": f"PROVED: the closed form is optimal for every {name} of the regime, by exact identities and signs.",
        "CERTIFIED": f"CERTIFIED: the same by rigorous enclosures, for every {name} of the regime.",
        "OPEN": "OPEN: not shown for the whole regime.",
    }
    lines = [text for status, text in words.items() if status in said]
    lines += [f"Given up: {what}; more --seconds may help." for what in document.get("given_up", ())]
    if document["uncovered"]:
        parts = ", ".join(f"{short(a)} to {short(b)}" for a, b in document["uncovered"])
        return [*lines, f"Not covered: {name} from {parts}."]
    return [*lines, f"Complete: no {name} between {lower} and {upper} is left out."]
