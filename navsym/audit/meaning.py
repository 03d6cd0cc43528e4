"""Units and frames of source code: the declared ones must allow what the code assigns, compares and returns.

Numbers of code often have a unit that nobody wrote: see :mod:`navsym.language.dimensions`, ``loose``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from navsym.audit.form import spell_entry
from navsym.audit.names import Names, squeeze
from navsym.audit.questions import Entry
from navsym.audit.sources import Source
from navsym.audit.values import Scalar, places_of
from navsym.core.errors import DomainError
from navsym.language.dimensions import infer_units, list_places, print_part
from navsym.language.shapes import Shape
from navsym.language.tree import NUMBER, PRODUCT, SUM, SYMBOL, Tree, build
from navsym.language.vectors import RELATIONS

#: Of a part: the frame of the vector that it is an entry of, both of a rotation's; "" for a number, None for unknown.
Frame = str | tuple[str, str] | None


def list_meaningless(names: Names, sources: Sequence[Source], entries: Sequence[Entry]) -> list[tuple[str, str]]:
    """Place and reason of every formula that the declared units and frames do not allow."""
    is_noted = names.units or names.frames
    formulas = [*list_formulas(sources, names), *list_sides(entries)] if is_noted else []
    if not formulas:
        return []
    places, trees = zip(*formulas, strict=True)
    shapes = {name: declare_unit(names, name) for name in names.spellings}
    refused: list[DomainError] = []
    infer_units(trees, shapes, where=places, loose=True, refused=refused)
    found = [(error.where, error.message) for error in refused]
    if names.frames:
        found += list_frames(trees, places, {name: frame_of(names, name) for name in names.spellings})
    return [*dict.fromkeys((place, names.show(why)) for place, why in found)]


def declare_unit(names: Names, name: str) -> Shape:
    """The declaration of a symbol; what is said of an array is said of its entries."""
    key = squeeze(names.spellings[name])
    unit = names.units.get(key) or names.units.get(key.partition("[")[0], "")
    return Shape(name, ((name,),), "scalar", {}, unit=unit)


# Frames: code has the entries of vectors one by one; a term is in the frame of its one entry, turned by rotations


def frame_of(names: Names, name: str) -> Frame:
    """What is declared of the frame of a symbol."""
    key = squeeze(names.spellings[name])
    said = names.frames.get(key) or names.frames.get(key.partition("[")[0])
    if said is None:
        return None if "[" in key else ""
    one, turns, other = said.partition(" to ")
    return (one.strip(), other.strip()) if turns else said


def list_frames(trees: Sequence[Tree], places: Sequence[str], known: Mapping[str, Frame]) -> Iterator[tuple[str, str]]:
    """Place and reason of every sum of entries in two frames, and of every rotation of an entry in a third one."""
    frames: dict[Tree, Frame] = {}
    for place, part in list_places(trees, places):
        if part.head in (NUMBER, SYMBOL):
            frames[part] = known.get(part.args[0]) if part.head == SYMBOL else ""
            continue
        inner = [(frames[p], p) for p in part.args]
        vectors = [(frame, p) for frame, p in inner if frame and isinstance(frame, str)]
        turns = [(frame, p) for frame, p in inner if isinstance(frame, tuple)]
        alone = vectors[0][0] if vectors else None
        frames[part] = None if any(frame != "" for frame, _ in inner) else ""
        if part.head in (SUM, *RELATIONS):
            other = next(((frame, p) for frame, p in vectors if frame != alone), None)
            if other is not None:
                got = f"{print_part(vectors[0][1])} in {alone} and {print_part(other[1])} in {other[0]}"
                yield place, f"expected terms in one frame; got {got}; turn one of them by its rotation"
            elif len(vectors) == len(inner):
                frames[part] = alone
        elif part.head == PRODUCT and len(vectors) == 1 and all(frame is not None for frame, _ in inner):
            if not turns:
                frames[part] = alone
            elif len(turns) == 1 and alone in (ends := turns[0][0]):
                frames[part] = ends[1 - ends.index(alone)]
            elif len(turns) == 1:
                got = f"{print_part(vectors[0][1])} in {alone} beside {print_part(turns[0][1])}, {' to '.join(ends)}"
                yield place, f"expected an entry in a frame of the rotation; got {got}; correct one of them"


def list_formulas(sources: Sequence[Source], names: Names) -> Iterator[tuple[str, Tree]]:
    """What the code assigns, in the order of its lines, with its comparisons and what it returns."""
    for source in sources:
        reading, lines = source.read(), list[tuple[int, Tree]]()
        written = {**reading.written}
        for case in reading.cases:
            for test in case.conditions:
                if test.left is not None and test.right is not None:
                    sign = test.sign if test.sign in RELATIONS else "="
                    lines.append((test.line, build(sign, (test.left, test.right))))
            if (value := case.returned) is not None:
                for place, cell in zip(places_of(value.shape), value.cells, strict=True):
                    if isinstance(cell, Scalar):
                        written[cell.tree, "return", place] = cell.line or source.function.line
        for (tree, name, place), line in written.items():
            spelling = spell_entry(source.unit, name, place)
            declared = not {squeeze(spelling), squeeze(name)}.isdisjoint(names.units.keys() | names.frames.keys())
            lines.append((line, build("=", (tree, source.symbol(spelling))) if declared else tree))
        for line, tree in sorted(lines, key=lambda pair: pair[0]):
            file, number = source.unit.locate(line)
            yield f"{file}:{number}", tree


def list_sides(entries: Sequence[Entry]) -> Iterator[tuple[str, Tree]]:
    """What the questions expect beside what the code has."""
    for entry in entries:
        if isinstance(entry.code, Scalar) and isinstance(entry.expected, Scalar):
            where = entry.asking.place(entry.key) if entry.asking is not None else ""
            yield f"{where}[{entry.place[0]},{entry.place[1]}]", build("=", (entry.code.tree, entry.expected.tree))
