"""The conventions of a model as one page: its cards, what excludes each neighbour, or what must change.

The page needs no network and no script; the template escapes every word.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from navsym.conventions.card import HEADINGS, attitude_formula, list_neighbours
from navsym.report.page import MARKS, environment

if TYPE_CHECKING:
    from navsym.conventions.answer import Conventions

MOST = 8  # cards that stand beside each other


def conventions_page(answer: Conventions) -> str:
    """The page of an answer as HTML.

    >>> import navsym as nav
    >>> page = conventions_page(nav.conventions("examples/conventions.toml"))
    >>> "C_est = (E - [p x]) C" in page, "<script" in page
    (True, False)
    """
    data = answer.document()
    cards = data["cards"] or [card for card in [data["nearest"]] if card]
    rows = [(title, [card[name] for card in cards[:MOST]]) for name, title in HEADINGS.items()]
    rows = [(title, words) for title, words in rows if any(word is not None for word in words)]
    formulas = [attitude_formula(card) if card["rotation_sign"] else None for card in cards[:MOST]]
    if any(formulas):
        rows.append(("that is", formulas))
    said = {"title": answer.name, "data": data, "neighbours": list_neighbours(data), "marks": MARKS}
    return environment().get_template("conventions.html").render(cards=cards, rows=rows, most=MOST, **said)
