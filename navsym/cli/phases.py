"""The complete solution as a parameter varies, or two: regimes, boundaries, closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import navsym as nav
from navsym.cli._progress import Progress
from navsym.cli._settings import values_of
from navsym.cli.output import Told, dumps, table, write_text
from navsym.core.errors import DuplicateError, ExpressionSyntaxError

RESUME = "nothing is saved; a shorter --range, --quick or fewer --seconds take less time"


def command(
    file: Path,
    *,
    target: str | None = None,
    parameter: str = "T",
    range_: str | None = None,
    set_: list[str] | None = None,
    quick: bool = False,
    unique: bool = False,
    seconds: float = 300.0,
    out: Path | None = None,
) -> Told:
    """Find the optimal times, weights and value for every value of a parameter.

    Example: navsym phases examples/schuler-velocity.toml --target drift --range "0, 2*pi"
    """
    values: dict[str, Any] = dict(values_of(set_))
    names = [name.strip() for name in parameter.split(",")]
    ranges = {} if range_ is None else ranges_of(names, range_)
    twice = next((name for name in ranges if name in values), None)
    if twice is not None:
        message = f"expected a range or a value of {twice}; got both; leave one out"
        raise DuplicateError(message, where="--range")
    values |= ranges
    with Progress("steps", resume=RESUME) as bar:
        answer = nav.phases(
            file,
            target,
            parameter=names,
            quick=quick,
            unique=unique,
            seconds=seconds,
            values=values,
            progress=bar.follow,
        )
    if out is not None:
        for k, certificate in enumerate(answer.certificates()):
            write_text(out.with_name(f"{out.stem}-{k + 1}.json"), dumps(certificate) + "\n")
    document = answer.document()
    return Told(document, lambda: (map_text if len(names) == 2 else as_text)(document))


def ranges_of(names: list[str], text: str) -> dict[str, tuple[str, str]]:
    """The ranges of parameters, separated by semicolons."""
    texts = text.split(";")
    if len(texts) != len(names):
        message = f'expected {len(names)} ranges; got {len(texts)}; write --parameter "T, p" --range "0, 2*pi; 1, 2"'
        raise ExpressionSyntaxError(message, where="--range")
    return {name: ends_of(ends) for name, ends in zip(names, texts, strict=True)}


def ends_of(text: str) -> tuple[str, str]:
    """The two ends that the option names."""
    lower, comma, upper = text.partition(",")
    if not comma or "," in upper:
        message = f'expected two numbers; got {text[:40]!r}; write --range "0, 2*pi"'
        raise ExpressionSyntaxError(message, where="--range")
    return lower, upper


def as_text(document: dict[str, Any]) -> str:
    """Regimes with times and weights, boundaries, values without a closed form, what is not covered."""
    name, (lower, upper) = document["parameter"], document["range"]
    title = f"{document['target']}, {name} from {lower} to {upper}"
    heads = ("regime", name, "value", "time", "weight", "measurement", "only one", "verdict")
    rows = [row for k, regime in enumerate(document["regimes"], 1) for row in regime_rows(k, regime, name)]
    parts = [table(heads, rows, title=title)]
    if document["boundaries"]:
        changes = [(b["at"] or "no closed form", located(b), b["why"]) for b in document["boundaries"]]
        parts.append(table((name, "decimal", "event"), changes, title="Boundaries"))
    for k, regime in enumerate(document["regimes"], 1):
        if "table" in regime:
            rows = [row for one in regime["table"] for row in value_rows(one, name)]
            title = f"Regime {k}: values at some {name}"
            parts.append(table((name, "value", "time", "weight", "measurement"), rows, title=title))
    return "\n\n".join([*parts, "\n".join(remarks(document))])


def map_text(document: dict[str, Any]) -> str:
    """Regions with their parts, times and weights, the curves between them, points where these meet, what is left."""
    first, second = document["parameters"]
    ends = " and ".join(f"{name} from {a} to {b}" for name, (a, b) in document["range"].items())
    rows = [row for k, region in enumerate(document["regions"], 1) for row in region_rows(k, region, first, second)]
    heads = ("region", second, first, "value", "time", "weight", "measurement", "verdict")
    parts = [table(heads, rows, title=f"{document['target']}, {ends}")]
    if document["curves"]:
        rows = [(c["equation"], between_ends(c, {first, second}), c["why"]) for c in document["curves"]]
        parts.append(table(("curve", "for", "event"), rows, title="Curves"))
    if document["meetings"]:
        rows = [(m[first], m[second], "; ".join(m["curves"])) for m in document["meetings"]]
        parts.append(table((first, second, "curves"), rows, title="Points where curves meet"))
    lines = [f"Given up: {what}; more --seconds may help." for what in document.get("given_up", ())]
    lines += [f"Not covered: {between_ends(part, {first, second})}." for part in document["uncovered"]]
    lines.append(f"Closed forms are proved on {document['covered']:.4%} of the rectangle.")
    return "\n\n".join([*parts, "\n".join(lines)])


def region_rows(k: int, region: dict[str, Any], first: str, second: str) -> list[tuple[str, ...]]:
    """One line for every part and for every time, whichever are more."""
    rows = []
    for i in range(max(len(region["parts"]), len(region["support"]))):
        part, point = region["parts"][i : i + 1], region["support"][i : i + 1]
        ends = [" to ".join(map(short, part[0][name])) if part else "" for name in (second, first)]
        place = (point[0]["at"], weight(point[0]), point[0]["measurement"]) if point else ("", "", "")
        rows.append(("" if i else str(k), *ends, "" if i else region["value"], *place, "" if i else region["status"]))
    return rows


def between_ends(row: dict[str, Any], names: set[str]) -> str:
    """The ranges in a row, in words."""
    return ", ".join(
        f"{name} from {short(row[name][0])} to {short(row[name][1])}" for name in sorted(names & row.keys())
    )


def regime_rows(k: int, regime: dict[str, Any], name: str) -> list[tuple[str, ...]]:
    """One line for every time; the first line also shows what holds for all of them."""
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
    """The enclosed value at one value of the parameter, with times and weights to seven digits."""
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
