"""The page of the atlas: ``python docs/atlas_table.py`` writes ``docs/atlas.md`` from the cells that are kept.

``python docs/atlas_table.py NAME …`` computes these cells again first, ``--all`` all of them (some minutes).
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from navsym.report.atlas_page import list_sheets  # noqa: E402
from navsym.studies.atlas.kept import RANK, Cell, atlas  # noqa: E402
from navsym.studies.atlas.published import PUBLISHED  # noqa: E402
from navsym.studies.atlas.scenes import cell_names  # noqa: E402
from tests.studies.atlas_cells import compute_cell, keep_atlas  # noqa: E402

HEAD = """# Atlas of observability

Produced by `python docs/atlas_table.py`; do not edit.

What does an aiding show along a manoeuvre? {count} error models answer, each computed: {complete} with a complete
list of the conditions under which the rank drops, {granted} of {ranks} ranks granted by the checker. The error models
come from the generator of error dynamics (`navsym/studies/atlas/scenes.py`): the mechanisation is linearised exactly
along the motion, and no row is typed.

* **INS**: 15 states in north, east, down with the angle phi over a flat Earth that turns with `uN` north and `uD`
  down. Biases are in the body. Magnetic field `m1 m2 m3`, lever arm `l1 l2 l3`, beacon `c11 c12 c13` from the body.
* **VIO**: 15 states in the body over a flat Earth at rest, angles and lever arm `l1 l2 l3` of the camera, its time
  offset, and landmarks `c11 c12 c13`, … from the camera.
* Velocities are `v1 v2 v3` or `V`, accelerations `a1 a2`, turn rates `w`, `u1`, `u2`. In the figure eight the rate
  swings: `w' = q`, `q' = -k w`.
* Gravity `g` and the third components `c13`, `c23`, `c33` of what is seen are not zero. Where the attitude is
  constant the body is aligned with north, east, down.
* Ranks hold over an interval, for generic parameters. A star: no other condition than those listed lowers the rank. A
  question mark: proved from below only.
* An empty place is a cell that takes more than a minute: on the way its rows, or what its certificates have to say,
  get thousands of terms.
* A rank that the checker does not grant stands as unchecked, with the reason: directions that are too long to write.
* Each rank is that of textbook error equations in other coordinates, too, modulo a prime
  (`tests/studies/test_atlas.py`).

```python
>>> import navsym as nav
>>> cell = nav.atlas["VIO: figure eight: three landmarks"]
>>> cell.rank, cell.size, cell.unobservable[0]
(26, 31, 'turn about gravity through the body')
>>> nav.atlas["INS: level turn: position"].model.states[:3]
('position_1', 'position_2', 'position_3')
```
"""


def page() -> Iterator[str]:
    """The blocks of the page."""
    cells = [*atlas.values()]
    yield HEAD.format(
        count=len(cells),
        complete=sum(cell.complete for cell in cells),
        granted=sum(cell.checked for cell in cells),
        ranks=sum(len(cell.drops) + 1 for cell in cells),
    )
    for model, aidings, rows in list_sheets():
        head = f"## {model}\n\n| manoeuvre | {' | '.join(aidings)} |\n|"
        yield head + " --- |" * (len(aidings) + 1)
        for manoeuvre, row in rows.items():
            yield f"| {manoeuvre} | {' | '.join(map(mark, row))} |"
        yield ""
    yield "## Published statements\n\nEach is held by a test on the cells.\n"
    for statement in PUBLISHED:
        word = "holds" if statement.holds(atlas) else "does not hold"
        yield wrap(f"{statement.text} ({statement.source}): {word}.")
    yield "\n## Cells\n"
    for cell in cells:
        yield from describe(cell)


def mark(cell: Cell | None) -> str:
    """Rank and number of states."""
    if cell is None:
        return ""
    return f"{cell.rank}/{cell.size}{'*' if cell.complete else ''}{'' if cell.proved else '?'}"


def describe(cell: Cell) -> Iterator[str]:
    """What a cell says."""

    def note(key: str) -> str:
        return f", unchecked: {cell.unchecked[key]}" if key in cell.unchecked else ""

    yield f"**{cell.name}**: rank {cell.rank} of {cell.size}{note(RANK)}\n"
    for direction in cell.unobservable:
        yield wrap(f"not shown: {direction}")
    for condition, rank in cell.drops.items():
        yield wrap(f"`{condition}`: {'a smaller rank' if rank is None else f'rank {rank}'}{note(condition)}")
    if not cell.complete:
        yield wrap(f"the list may be incomplete: sets of points left undecided: {cell.open}")
    yield ""


def wrap(text: str) -> str:
    """A point of a list."""
    return textwrap.fill(text, 118, initial_indent="* ", subsequent_indent="  ", break_on_hyphens=False)


if __name__ == "__main__":
    if wanted := [*cell_names()] if sys.argv[1:] == ["--all"] else sys.argv[1:]:
        keep_atlas(map(compute_cell, wanted))
        atlas.__dict__.pop("cells", None)
    (ROOT / "docs" / "atlas.md").write_text("\n".join(page()).rstrip("\n") + "\n", encoding="utf-8")
