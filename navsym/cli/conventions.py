"""Find the conventions of an error model: frame, axes, side and sign of its errors, terms kept and dropped."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import navsym as nav
from navsym.cli._progress import Progress
from navsym.cli._settings import values_of
from navsym.cli.derive import aligned
from navsym.cli.output import Told, table, write_text
from navsym.conventions.card import HEADINGS, attitude_formula, list_neighbours


def command(
    file: Path,
    *,
    card: Path | None = None,
    convert: list[str] | None = None,
    latex: bool = False,
    html: Path | None = None,
) -> Told:
    """Find all conventions under which an error model is right. Status 1 when there are none.

    Example: navsym conventions examples/conventions.toml
    """
    answer = nav.conventions(file, card=card)
    changes = {} if convert is None else values_of(convert, "--convert", "FIELD=WORD", "--convert attitude_error=body")
    with Progress("steps") as bar:
        shown: Any = answer.convert(None, bar.follow, **changes) if changes else answer
    if html is not None:
        from navsym.report.conventions_page import conventions_page

        write_text(html, conventions_page(answer))
    document = {**answer.document(), **({"conversion": shown.document()} if changes else {})}
    document |= {"latex": shown.latex()} if latex else {}
    words = conversion_text if changes else as_text
    text = document["latex"] if latex else lambda: words(document)
    return Told(document, text, 0 if answer.cards else 1)


# Text for people


def as_text(data: Mapping[str, Any]) -> str:
    """The cards in words and what excludes their neighbours, or what must change."""
    blocks = [cards_text(data["cards"])] if data["cards"] else [conflicts_text(data)]
    if data["excluded"]:
        blocks.append(table(["neighbour with another", "namely", "is excluded", "at"], [*list_neighbours(data)]))
    others = "one card examined" if data["examined"] == 1 else f"{data['examined']} cards examined"
    left = f"{len(data['undecided'])} more cards are undecided: they are neither proved nor excluded"
    proved = (
        "each card is proved, each other one excluded at a point" if data["cards"] else "each is excluded at a point"
    )
    proved = proved if data["complete"] else left
    unused = f"; not looked at: {', '.join(data['unused'])}" if data["unused"] else ""
    return "\n\n".join([*blocks, f"{others}; {proved}{unused}"]) + "\n"


def cards_text(cards: Sequence[Mapping[str, Any]]) -> str:
    """What all cards share, the formula of the attitude error, and a table of what differs."""
    shared = [name for name in HEADINGS if len({card[name] for card in cards}) == 1 and cards[0][name] is not None]
    lines = [f"{HEADINGS[name]}: {cards[0][name]}" for name in shared]
    if {"attitude_error", "rotation_sign"} <= set(shared):
        lines.append(f"that is: {attitude_formula(cards[0])}")
    dropped = {tuple(map(tuple, card["dropped"])) for card in cards}
    if len(dropped) == 1 and next(iter(dropped)):
        lines.append("dropped: " + "; ".join(f"{row} by {column}" for row, column in next(iter(dropped))))
    free = [name for name in HEADINGS if len({card[name] for card in cards}) > 1]
    count = "one card" if len(cards) == 1 else f"{len(cards)} cards, that differ in"
    if not free:
        return "\n".join([count, *lines])
    rows = [[str(card[name] or "") for name in free] for card in cards]
    return "\n".join([*lines, "", count, table([HEADINGS[name] for name in free], rows)])


def conflicts_text(data: Mapping[str, Any]) -> str:
    """The blocks that must change for the nearest card."""
    if data["undecided"]:
        head = f"no card is proved; {len(data['undecided'])} are undecided: no point excludes them"
        return f"{head}\n{cards_text(data['undecided'])}"
    if not data["conflicts"]:
        return "no card, and none is near"
    head = f"no card; the fewest blocks that must change: {len(data['conflicts'])}"
    lines = [head, table(["block", "entries", "change", "verdict"], [conflict_row(c) for c in data["conflicts"]])]
    if data["alternatives"]:
        sets = ("; ".join(" by ".join(block) for block in blocks) for blocks in data["alternatives"])
        lines.append("or as few others: " + " | ".join(sets))
    return "\n".join([*lines, "", "then one card is", cards_text([data["nearest"]])])


def conversion_text(data: Mapping[str, Any]) -> str:
    """The model in other errors: its matrices, and what is proved."""
    found = data["conversion"]
    matrices = {"T: x_to = T x": "T", "F of the new errors": "F", "neglected": "neglected"}
    matrices |= {name: name for name in ("H", "G", "reset")}
    blocks = [
        "\n".join([heading, *aligned(found[name])])
        for heading, name in matrices.items()
        if found[name] and any(x != "0" for row in found[name] for x in row)
    ]
    proved = "proved: F_to T = T (F + neglected) + T'" if found["proved"] else "not all is proved"
    return "\n\n".join([*blocks, proved]) + "\n"


def conflict_row(conflict: Mapping[str, Any]) -> list[str]:
    """One block that must change."""
    entries = " ".join(f"{conflict['matrix']}[{i},{j}]" for i, j in conflict["entries"])
    entries += f" ({', '.join(conflict['places'])})" if "places" in conflict else ""
    return [" by ".join(conflict["block"]), entries, conflict["change"], conflict["status"]]
