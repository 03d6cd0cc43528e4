"""Small functions in the style of flown code with traps of meaning in them: what is read of each is what it computes.

``python -m tests.attacks.traps [LANGUAGE ...]`` prints how many functions are read, and what is read wrongly.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from navsym.audit.cases import Case
from navsym.audit.mend import evaluate
from navsym.audit.names import Names
from navsym.audit.values import Array, Cell, Unread, places_of
from navsym.core.errors import NavsymError
from tests.attacks.campaigns.code import LANGUAGES, Subject, compute, draw_points, read_code

FOLDER = Path(__file__).resolve().parent / "traps"
SIGNS = {"<": float.__lt__, "<=": float.__le__, ">": float.__gt__, ">=": float.__ge__, "==": float.__eq__,
         "!=": float.__ne__}  # fmt: skip


def list_traps(language: str) -> Iterator[Subject]:
    """The functions of a language; a head gives the name and the sizes that the source does not say."""
    end = next(end for end, name in LANGUAGES.items() if name == language)[1:]
    blocks = re.split(r"^=== ", (FOLDER / f"{end}.txt").read_text(), flags=re.MULTILINE)[1:]
    for head, _, text in (block.partition("\n") for block in blocks):
        sizes = re.findall(r"(\w+)=\(([\d,]*)\)", head)
        shapes = tuple((name, tuple(int(n) for n in size.split(",") if n)) for name, size in sizes)
        name = head.split()[0].split(".")[0]
        yield Subject(name, text, name, language, tuple((n, s) for n, s in shapes if s))


def read_trap(subject: Subject, seed: int = 1) -> tuple[str, list[str]]:
    """``right``, ``refused`` or ``wrong`` with what differs; ``silent`` where the function does not run."""
    values, points, names = compute([subject.text], subject, seed)[0], draw_points(subject, seed), Names()
    if values is None:
        return "silent", []
    try:
        cases = read_code("trap", subject.text, subject, names).read().cases
    except NavsymError as error:
        return "refused", [str(error)]
    per, notes, is_whole = len(values) // len(points), list[str](), True
    for k, point in enumerate(points):
        numbers = {names.symbols[key]: x for key, x in spell_point(subject, point).items() if key in names.symbols}
        case = next((case for case in cases if all(does_hold(c, numbers) is not False for c in case.conditions)), None)
        if case is None:
            notes.append("no case fits the point")
            continue
        is_known = all(does_hold(c, numbers) for c in case.conditions)
        cells = [*list_results(subject, case)] if is_known else [None] * per
        if len(cells) != per and not any(isinstance(cell, Unread) for cell in cells):
            notes.append(f"{len(cells)} values read, {per} computed")
        for cell, ran in zip(cells, values[k * per :], strict=False):
            read = None if cell is None or isinstance(cell, Unread) else evaluate(cell.tree, numbers)
            is_whole &= read is not None
            if read is not None and abs(read - ran) > 1e-6 * (1 + abs(ran)):
                notes.append(f"read {read}, computed {ran}")
    return ("wrong" if notes else "right" if is_whole else "refused"), notes


def spell_point(subject: Subject, point: list[Any]) -> dict[str, float]:
    """The inputs as the names of an audit spell them; Octave fills columns first."""
    numbers: dict[str, float] = {}
    for (name, sizes, _), given in zip(subject.parameters(), point, strict=True):
        if not sizes:
            numbers[name] = float(given[0])
            continue
        is_columns, first = subject.language == "matlab", int(subject.language == "matlab")
        places = sorted(places_of(sizes), key=lambda place: place[::-1]) if is_columns else places_of(sizes)
        for k, (place, x) in enumerate(zip(places, given, strict=True)):
            numbers[f"{name}[{','.join(str(i + first) for i in place)}]"] = float(x)
            numbers[f"{name}[{k + first}]"] = float(x)
    return numbers


def does_hold(condition: Any, numbers: dict[str, float]) -> bool | None:
    """Whether the condition of a case is what it says at a point; None where it is not read."""
    if condition.left is None:
        return None
    left, right = evaluate(condition.left, numbers), evaluate(condition.right, numbers)
    if left is None or right is None:
        return None
    return bool(SIGNS[condition.sign](left, right)) == condition.holds


def list_results(subject: Subject, case: Case) -> Iterator[Cell | None]:
    """What a case leaves, in the order in which the judges give it."""
    outputs = subject.outputs()
    sizes = {name: size for name, size, _ in subject.parameters()}
    for output in sorted(outputs, key=lambda name: name != "return"):
        if output == "return":
            value: Any = case.returned
            yield from in_order(subject, value) if isinstance(value, Array) else [value]
            continue
        variable = case.variables[output]
        shape = sizes.get(output) or variable.shape or ()
        cells = [variable.all_unread or variable.cells.get(place) for place in places_of(shape)]
        yield from in_order(subject, Array(shape, tuple(cells)))  # type: ignore[arg-type]


def in_order(subject: Subject, value: Array) -> list[Cell]:
    """The cells row by row; those of Octave column by column."""
    if subject.language != "matlab" or len(value.shape) < 2:
        return [*value.cells]
    return [value.at(*place) for place in sorted(places_of(value.shape), key=lambda place: place[::-1])]


if __name__ == "__main__":
    for language in sys.argv[1:] or dict.fromkeys(LANGUAGES.values()):
        counts = Counter[str]()
        for trap in list_traps(language):
            answer, different = read_trap(trap)
            counts[answer] += 1
            if answer in ("wrong", "silent"):
                print(answer, trap.name, *different[:2], flush=True)
        print(language, dict(counts), flush=True)
