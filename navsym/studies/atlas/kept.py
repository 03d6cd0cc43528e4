"""The atlas as a mapping: cells as they were computed, each with the error model that it is about."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from navsym.core.catalogue import Catalogue
from navsym.core.tables import Shown, Table
from navsym.language.printer import to_text
from navsym.models.model import Model

#: The cells as they were computed: name -> all of a cell but its name.
KEPT = Path(__file__).with_name("atlas.json")
#: The key of the generic rank among what is unchecked.
RANK = "rank"


@dataclass(frozen=True, slots=True)
class Cell(Shown):
    """An error model with an aiding along a manoeuvre, and what its measurements show over an interval.

    name         : "MODEL: MANOEUVRE: AIDING"
    size, rank   : number of states, and of the directions that are shown
    proved       : False where the rank is known from below only
    unobservable : a basis of what is not shown, in words
    drops        : condition -> rank that is left there, None where it was not found
    complete     : True where these are proved to be all conditions, for gravity and depths that are not zero
    open         : number of sets of points at which nothing was decided
    unchecked    : "rank" or a condition -> why the checker does not grant this rank; it grants all others
    certificate  : hash of what the checker read
    """

    name: str
    size: int
    rank: int
    proved: bool
    unobservable: tuple[str, ...]
    drops: Mapping[str, int | None]
    complete: bool
    open: int
    unchecked: Mapping[str, str]
    certificate: str

    @property
    def checked(self) -> int:
        """Number of ranks that the checker grants, of ``1 + len(drops)``."""
        return 1 + len(self.drops) - len(self.unchecked)

    @property
    def model(self) -> Model:
        """The error model, written by the generator of error dynamics."""
        from navsym.studies.atlas.scenes import model_of

        linear = model_of(self.name)
        rates = {symbol.name: to_text(rate) for symbol, rate in linear.rates.items()}
        return Model(linear.states, linear.F, linear.H, measurements=linear.measurements, rates=rates, name="atlas")

    def document(self) -> dict[str, Any]:
        """The cell as plain data."""
        return {**asdict(self), "unobservable": list(self.unobservable)}

    def table(self) -> Table:
        """What is shown and what is not, and where the rank drops."""
        drops = [f"{condition}: {'' if rank is None else rank}" for condition, rank in self.drops.items()]
        row = (self.name, f"{self.rank} of {self.size}", "; ".join(self.unobservable), "; ".join(drops))
        return ("cell", "rank", "unobservable", "drops"), [row]

    def __repr__(self) -> str:
        return f"<{self.name}: rank {self.rank} of {self.size}>"


class Atlas(Catalogue[Cell]):
    """All cells by name. They are recomputed by tests, not when they are read.

    >>> import navsym as nav
    >>> cell = nav.atlas["INS: rest: position"]
    >>> cell, cell.drops
    (<INS: rest: position: rank 12 of 15>, {'uN = 0': 11})
    >>> nav.observe(cell.model).rank
    12
    """

    name, expected, remedy = "atlas", "the name of a cell", "list them with list(nav.atlas)"

    @cached_property
    def entries(self) -> dict[str, Cell]:
        """The cells in the order of models, manoeuvres and aidings."""
        kept = json.loads(KEPT.read_text(encoding="utf-8"))
        return {
            name: Cell(name, **{**cell, "unobservable": tuple(cell["unobservable"])}) for name, cell in kept.items()
        }

    def table(self) -> Table:
        """All cells."""
        return ("cell", "rank", "unobservable", "drops"), [row for cell in self.values() for row in cell.table()[1]]

    def __repr__(self) -> str:
        return f"<atlas: {len(self)} cells>"


#: The atlas.
atlas = Atlas()
