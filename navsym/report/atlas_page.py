"""The atlas of observability as a page of the report: ranks by manoeuvre and aiding, then every cell in words."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from navsym.report.page import slug
from navsym.studies.atlas.kept import Cell, atlas
from navsym.studies.atlas.published import PUBLISHED

#: The name of a model, its aidings across, and its manoeuvres down with their cells; None where there is no cell.
Sheet = tuple[str, tuple[str, ...], Mapping[str, tuple[Cell | None, ...]]]


def list_sheets() -> list[Sheet]:
    """A sheet for each model, in the order of the atlas."""
    split = {name: name.split(": ") for name in atlas}
    sheets: list[Sheet] = []
    for model in dict.fromkeys(parts[0] for parts in split.values()):
        own = [parts for parts in split.values() if parts[0] == model]
        aidings = tuple(dict.fromkeys(parts[2] for parts in own))
        rows = {
            manoeuvre: tuple(atlas.entries.get(f"{model}: {manoeuvre}: {aiding}") for aiding in aidings)
            for manoeuvre in dict.fromkeys(parts[1] for parts in own)
        }
        sheets.append((model, aidings, rows))
    return sheets


def atlas_pages(template: Callable[[str], Any], shared: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Name and text of the page.

    >>> from navsym.report.page import environment
    >>> ((name, text),) = atlas_pages(environment().get_template, {})
    >>> name, "level turn" in text
    ('atlas.html', True)
    """
    anchors = {name: f"c-{slug(name)}" for name in atlas}
    cells, known = [*atlas.values()], [(one, "holds" if one.holds(atlas) else "does not hold") for one in PUBLISHED]
    yield (
        "atlas.html",
        template("atlas.html").render(shared, sheets=list_sheets(), anchors=anchors, cells=cells, published=known),
    )
