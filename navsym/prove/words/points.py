"""Exact matrices of a small size that have all declared properties and satisfy the hypotheses: proposals of points.

Positive matrices are L L' + 1, orthogonal ones come from a skew matrix (Cayley). A hypothesis is solved for a matrix in
which it is linear, by linear algebra on its entries. The checker looks at every point.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from flint import fmpq, fmpq_mat

from navsym.prove.relations.points import draw_number
from navsym.prove.rooms.goals import player, write_term

Document = dict[str, Any]
TRIES = 40
#: Dimensions of the first, second and third name, and so on.
SIZES = ((2, 3), (3, 2), (2, 2), (2, 1), (1, 2), (3, 3), (1, 1))


class Probe(player.Sized):  # type: ignore[misc,name-defined]
    """A point that need not have its properties; what the hypotheses leave is noted."""

    def __init__(self, item: Document, point: Document):
        super().__init__(item, point)
        self.left: list[list[fmpq]] = []

    def make_letter(self, name: str, rows: Any, columns: Any, words: list[str]) -> Any:
        return self.matrices[name]

    def relate(self, x: Any) -> None:
        self.left.append(list_numbers(x.body) if isinstance(x, player.Typed) else [self.value_of(x)])


def list_numbers(x: fmpq_mat) -> list[fmpq]:
    """The entries, row by row."""
    return [x[i, j] for i in range(x.nrows()) for j in range(x.ncols())]


def draw_sized_points(document: Document) -> Iterator[tuple[Document, bool]]:
    """Points at which all of a statement has a value, and whether it holds there."""
    generator = random.Random(1)
    for k in range(TRIES):
        sizes = SIZES[k % len(SIZES)]
        size = {name: sizes[i % len(sizes)] for i, name in enumerate(document["dimensions"])}
        point = draw_point(document, size, generator, special=k >= len(SIZES))
        if point is None:
            continue
        matrices = {name: [[str(e) for e in row] for row in x.tolist()] for name, x in point["matrices"].items()}
        written = {**point, "matrices": matrices}  # as certificates have it
        try:
            yield written, player.Sized(document, written).evaluate()
        except (player.Refused, ZeroDivisionError):
            continue


def draw_point(
    document: Document, sizes: Mapping[str, int], generator: random.Random, special: bool
) -> Document | None:
    """Matrices and numbers, some of them solved from the hypotheses; None where these have no value."""
    numbers = {
        name: write_term(player.number(draw_number(player.read_range(limit), generator)))
        for name, limit in document["symbols"].items()
    }
    shapes = {name: [sizes.get(d, d) for d in item["size"]] for name, item in document["matrices"].items()}
    matrices = {
        name: draw_matrix(shape[0], shape[1], document["matrices"][name]["is"], generator, special)
        for name, shape in shapes.items()
    }
    point = {"sizes": dict(sizes), "matrices": matrices, "numbers": numbers}
    fixed: set[str] = set()
    for k, text in enumerate(document["given"]):
        names = [name for name in re.findall(r"[A-Za-z]\w*", text) if name in matrices]
        try:
            if any(probe_left(document, point)[k]):
                for name in dict.fromkeys(names):
                    if name not in fixed and solve_linear(document, point, k, name, generator):
                        break
        except (player.Refused, ZeroDivisionError):
            continue
        fixed.update(names)
    return point


def probe_left(document: Document, point: Document) -> list[list[fmpq]]:
    """What each hypothesis leaves, entry by entry."""
    probe = Probe(document, point)
    probe.suppose()
    return probe.left


def draw_matrix(m: int, n: int, words: Sequence[str], generator: random.Random, special: bool) -> fmpq_mat:
    """Small whole numbers with the declared properties; now and then a unit, a projection or an isometry."""
    x = fmpq_mat(m, n, [generator.randint(-2, 3) for _ in range(m * n)])
    unit = fmpq_mat(m, n, [int(i == j) for i in range(m) for j in range(n)])
    kind = generator.randrange(8) if special else 7
    if "orthogonal" in words:
        skew = x - x.transpose()
        return (unit - skew) * (unit + skew).inv()
    if "diagonal" in words:
        low = 1 if {"positive", "invertible"} & {*words} else 0
        return fmpq_mat(m, n, [generator.randint(low, 4) * (i == j) for i in range(m) for j in range(n)])
    if "positive" in words:
        return x * x.transpose() + unit
    if "nonnegative" in words:
        half = fmpq_mat(m, 1, [generator.randint(-2, 3) for _ in range(m)])
        return half * half.transpose()
    if "symmetric" in words or "skew" in words:
        x = x + x.transpose() if "symmetric" in words else x - x.transpose()
        return x + unit if "invertible" in words and x.det() == 0 else x
    if kind < 3:
        scale = (1, -1, 0)[kind] if "invertible" not in words else 1
        return unit * scale
    if kind == 3 and m >= n and "invertible" not in words:
        frame = draw_matrix(m, m, ["orthogonal"], generator, False)
        return fmpq_mat([[frame[i, j] for j in range(n)] for i in range(m)])
    if kind == 4 and m == n and "invertible" not in words:
        frame = draw_matrix(m, m, ["orthogonal"], generator, False)
        half = fmpq_mat([[frame[i, 0]] for i in range(m)])
        return half * half.transpose()
    while "invertible" in words and x.det() == 0:
        x = x + unit
    return x


def solve_linear(document: Document, point: Document, place: int, name: str, generator: random.Random) -> bool:
    """Set one matrix so that a hypothesis holds, if it is linear in its entries and has a solution."""
    matrices, old = point["matrices"], point["matrices"][name]
    m, n = old.nrows(), old.ncols()
    words = {*document["matrices"][name]["is"]}
    even = bool(words & {"symmetric", "positive", "nonnegative"})
    places = [(i, j) for i in range(m) for j in range(n) if not even or i <= j]
    basis = [fmpq_mat(m, n, [int((i, j) in {p, p[::-1]} if even else (i, j) == p) for i in range(m) for j in range(n)])
             for p in places]  # fmt: skip

    def value_at(x: fmpq_mat) -> list[fmpq]:
        matrices[name] = x
        return probe_left(document, point)[place]

    try:
        start = value_at(0 * old)
        columns = [[a - b for a, b in zip(value_at(e), start, strict=True)] for e in basis]
        x = solve_entries(columns, start, basis, generator)
        if x is not None and not any(value_at(x)):
            return True
    except (player.Refused, ZeroDivisionError):
        pass
    matrices[name] = old
    return False


def solve_entries(
    columns: list[list[fmpq]], start: list[fmpq], basis: list[fmpq_mat], generator: random.Random
) -> fmpq_mat | None:
    """A solution of start + sum x_k column_k = 0 with small numbers for what is free."""
    free = [fmpq(generator.randint(-2, 3)) for _ in columns]
    rows = [[*(column[i] for column in columns), -start[i]] for i in range(len(start))]
    reduced, rank = fmpq_mat(rows).rref()
    values = list(free)
    for i in range(rank):
        pivot = next(j for j in range(len(columns) + 1) if reduced[i, j] != 0)
        if pivot == len(columns):
            return None
        others = sum((reduced[i, j] * free[j] for j in range(pivot + 1, len(columns))), fmpq(0))
        values[pivot] = reduced[i, len(columns)] - others
    total = 0 * basis[0]
    for value, matrix in zip(values, basis, strict=True):
        total = total + matrix * value
    return total


def show_point(point: Document) -> dict[str, str]:
    """A point for people: dimensions, numbers, and matrices by their rows."""
    rows = {name: f"[{', '.join('[' + ', '.join(row) + ']' for row in x)}]" for name, x in point["matrices"].items()}
    return {**{name: str(size) for name, size in point["sizes"].items()}, **point["numbers"], **rows}
