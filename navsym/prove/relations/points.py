"""Exact points at which hypotheses hold: unit vectors, rotations and unit quaternions have rational parameters.

Other hypotheses are solved for a symbol with a rational root. A point is a proposal: the checker looks at it.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import partial
from itertools import combinations
from math import isqrt
from typing import Any

from flint import fmpq

from navsym.prove.relations.cofactors import list_values
from navsym.prove.rooms.goals import as_term, draw_points, player

#: Rational numbers, and terms for the symbols that hypotheses give: ``W`` by ``W = sqrt(1 - e**2)``.
Point = dict[str, Any]
Rows = Sequence[Sequence[str]]
SHARE = fmpq(3, 8)  # of a crossed strip; its middle may be where sides agree


def draw_special_points(
    box: Mapping[str, Any], zeros: Sequence[Any], kinds: Mapping[str, tuple[str, Rows]], count: int
) -> Iterator[Point]:
    """Points of the box, some of which satisfy the hypotheses.

    kinds : name -> ("rotation", "orthogonal", "positive", "quaternion" or "vector", the names of the entries)
    """
    generator = random.Random(1)
    plain = [*draw_points(box, count)]
    for k in range(count):
        if not zeros:
            drawn = {n: draw_number(r, generator) for n, r in box.items()}
            if k % 4 == 2:  # near 0, where hypotheses such as |u| <= 1 hold
                lines = {n for n, r in box.items() if r.low is r.high is None and not r.integer}
                drawn = {n: v / 16 if n in lines else v for n, v in drawn.items()}
            yield plain[k] if k < len(plain) and k % 2 else drawn
            continue
        point = dict(plain[k % len(plain)]) if plain and k % 2 == 0 else {}
        for name, limit in box.items():
            if name not in point or k % 2:
                point[name] = draw_number(limit, generator)
        fixed: set[str] = set()
        frame = transpose(draw_rotation(generator))
        for place, (kind, rows) in enumerate(kinds.values()):
            entries = [name for row in rows for name in row]
            values = draw_entries(kind, place, len(entries), frame, k, generator)
            point.update(zip(entries, values, strict=True)) if values else None
            fixed.update(
                entries if kind in ("rotation", "quaternion", "orthogonal", "positive") or (values and k % 3) else ()
            )
        for zero, names in order_hypotheses(zeros, box):
            for kind, rows in kinds.values() if k % 3 else ():
                if kind == "vector" and player.symbols_of(zero) <= {name for row in rows for name in row}:
                    stretch(zero, point)
            solve_for_one(zero, names, point, box, fixed, k)
        yield point


def draw_corner_points(box: Mapping[str, Any], kinds: Mapping[str, tuple[str, Rows]]) -> Iterator[Point]:
    """Equal numbers, with unit and half turns, vectors on a line: where bounds are attained, or missed."""
    for value in (0, 1, -1, 50, -50, 2):
        point = {name: fmpq(value) for name in box}
        for place, (kind, rows) in enumerate(kinds.values()):
            n, entries = len(rows), [name for row in rows for name in row]
            if kind in ("rotation", "orthogonal", "positive"):
                turned = value if kind == "rotation" and n == 3 else 0
                size = fmpq(1, 10**9) if kind == "positive" and value < 0 else fmpq(1)
                diagonal = [-size if turned and i != turned % 3 else size for i in range(n)]
                point.update({rows[i][j]: fmpq(diagonal[i] if i == j else 0) for i in range(n) for j in range(n)})
            elif kind == "quaternion" or (kind == "vector" and value):
                far = place + 1 if kind == "vector" and value == 2 else value or 1  # 2: one behind the other on a line
                point.update({name: fmpq(far * (k == (value < 0))) for k, name in enumerate(entries)})
        yield point


def cross_cell(box: Mapping[str, Any], given: Sequence[Any], count: int) -> Iterator[Point]:
    """Points of lines inside all half-spaces of a case: a strip of any width is crossed.

    Other terms than linear ones are left out. The box bounds the lines as well.
    """
    generator = random.Random(2)
    for _ in range(count):
        start, step = ({n: draw_number(limit, generator) for n, limit in box.items()} for _ in range(2))
        slopes = [slope_along(term, start, step) for term in given]
        for sign, end in ((1, "low"), (-1, "high")):
            bounds = {n: player.constant_of(getattr(r, end)) for n, r in box.items() if getattr(r, end) is not None}
            slopes += [(sign * (start[n] - b), sign * step[n]) for n, b in bounds.items() if b is not None]
        roots = [(slope > 0, -value / slope) for value, slope in filter(None, slopes) if slope != 0]
        low = max((root for rising, root in roots if rising), default=None)
        high = min((root for rising, root in roots if not rising), default=None)
        first = (fmpq(0) if high is None else high - 2) if low is None else low
        last = (first + 2) if high is None else high
        yield {name: start[name] + (first + (last - first) * SHARE) * step[name] for name in box}


def slope_along(term: Any, start: Point, step: Point) -> tuple[fmpq, fmpq] | None:
    """Value and slope of a term that is linear along a line, as far as three of its points tell."""
    places = [{n: as_term(start[n] + k * step[n]) for n in player.symbols_of(term) & set(start)} for k in range(3)]
    try:
        values = [player.constant_of(player.substitute(term, place)) for place in places]
    except (player.Refused, ArithmeticError):
        return None
    if None in values or values[0] + values[2] != 2 * values[1]:
        return None
    return values[0], values[1] - values[0]


def draw_number(limit: Any, generator: random.Random) -> fmpq:
    """A short fraction in a range, as far as its ends are seen."""
    low, high = (None if end is None else float(player.value_of(end, {}).mid()) for end in (limit.low, limit.high))
    if limit.integer:
        return fmpq(round(generator.uniform(low if low is not None else -5, high if high is not None else 9)))
    if low is None and high is None:
        value = Fraction(generator.randint(-9, 9), generator.randint(1, 4))
        return fmpq(value.numerator or 1, value.denominator)
    share = generator.uniform(0.05, 0.95)
    if low is not None and high is not None:
        far = low + (high - low) * share
    else:
        far = low + share / (1 - share) if low is not None else (high or 0.0) - share / (1 - share)
    near = Fraction(far).limit_denominator(50)
    return fmpq(near.numerator, near.denominator)


def draw_entries(
    kind: str, place: int, size: int, frame: list[list[fmpq]], k: int, generator: random.Random
) -> list[fmpq]:
    """Values of the entries of a matrix or vector; none where any values do."""
    if kind == "rotation":
        return [entry for row in draw_rotation(generator) for entry in row]
    if kind in ("orthogonal", "positive"):
        return [entry for row in draw_square(kind, isqrt(size), generator) for entry in row]
    if kind == "quaternion":
        return draw_unit(4, generator)
    if kind == "vector" and k % 3 == 1 and size == 3:
        return frame[place % 3]
    return draw_unit(size, generator) if kind == "vector" and k % 3 == 2 else []


def draw_unit(size: int, generator: random.Random) -> list[fmpq]:
    """A rational point of the unit sphere, from a point of the plane by the lines through a pole."""
    s = [fmpq(generator.randint(-4, 4), generator.randint(1, 3)) for _ in range(size - 1)]
    square = sum((x * x for x in s), fmpq(0))
    return [(1 - square) / (1 + square), *(2 * x / (1 + square) for x in s)]


def draw_rotation(generator: random.Random) -> list[list[fmpq]]:
    """A rational rotation matrix, of a rational quaternion (Euler, Rodrigues)."""
    w, x, y, z = draw_unit(4, generator)
    return [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]


def draw_square(kind: str, n: int, generator: random.Random) -> list[list[fmpq]]:
    """A product of rotations by rational sines in pairs of axes, or X X' + 1."""
    rows = [[fmpq(i == j) for j in range(n)] for i in range(n)]
    if kind == "positive":
        x = [[fmpq(generator.randint(-2, 3)) for _ in range(n)] for _ in range(n)]
        return [[rows[i][j] + sum(a * b for a, b in zip(x[i], x[j], strict=True)) for j in range(n)] for i in range(n)]
    for i, j in combinations(range(n), 2):
        c, s = draw_unit(2, generator)
        for row in rows:
            row[i], row[j] = c * row[i] - s * row[j], s * row[i] + c * row[j]
    return rows


def transpose(rows: list[list[fmpq]]) -> list[list[fmpq]]:
    return [list(column) for column in zip(*rows, strict=True)]


def stretch(zero: Any, point: Point) -> None:
    """Move a vector along its line to where a hypothesis on its length holds, if that is a rational number."""
    here = {name: as_term(point[name]) for name in player.symbols_of(zero)}
    values = [player.constant_of(player.substitute(zero, place)) for place in (dict.fromkeys(here, player.ZERO), here)]
    if None in values or values[0] == values[1] or values[0] == 0:
        return
    square = values[0] / (values[0] - values[1])
    root = fmpq(isqrt(abs(int(square.p))), isqrt(int(square.q)))
    if root * root == square:
        point.update({name: root * point[name] for name in here})


def order_hypotheses(zeros: Sequence[Any], box: Mapping[str, Any]) -> list[tuple[Any, list[str]]]:
    """The hypotheses in the order to solve them, with the names to solve for.

    A name that stands in one of them alone is solved for after the others, which do not change by it. A name that is
    equal to the rest of its hypothesis comes first, then one without a range.
    """
    left, last = sorted(zeros, key=lambda zero: len(player.symbols_of(zero))), []

    def rank(zero: Any, name: str) -> int:
        if any(own[1] == name and name not in player.symbols_of(value) for own, value, _ in list_values(zero)):
            return 0
        return 1 if name not in box or box[name].low is box[name].high is None else 2

    while left:
        counts = Counter(name for zero in left for name in player.symbols_of(zero))
        alone = [{name for name in player.symbols_of(zero) if counts[name] == 1} for zero in left]
        ranks = [min((rank(zero, name) for name in names), default=3) for zero, names in zip(left, alone, strict=True)]
        place = ranks.index(min(ranks))
        zero = left.pop(place)
        names = alone[place] or player.symbols_of(zero)
        last.append((zero, sorted(sorted(names, reverse=True), key=partial(rank, zero))))
    return last[::-1]


def is_within(value: Any, limit: Any) -> bool:
    """Whether a number is shown to lie in a range; False where it has no value, or none that the checker finds."""
    try:
        return bool(player.is_inside(value, limit))
    except (player.Refused, ArithmeticError):
        return False


def solve_for_one(
    zero: Any, names: Sequence[str], point: Point, box: Mapping[str, Any], fixed: set[str], k: int
) -> None:
    """Move one symbol to a rational root of the hypothesis, the k-th of them in turn; it is not moved again.

    Where there is none, a symbol that the hypothesis is equal to has its value.
    """
    others = sorted(player.symbols_of(zero) - {*names}, reverse=True)
    for name in (name for name in (*names, *others) if name not in fixed):
        term = player.substitute(zero, {n: as_term(v) for n, v in point.items() if n != name})
        try:
            if name not in player.symbols_of(term):
                continue
            top, bottom = player.to_fraction(term)
        except (player.Refused, ZeroDivisionError):
            values = [value for own, value, _ in list_values(term) if own[1] == name and not player.symbols_of(value)]
            if values and is_within(values[0], box[name]):
                point[name] = values[0]
                fixed.add(name)
                return
            continue
        roots = [-line[0] / line[1] for line, _ in top.factor()[1] if line.degree() == 1] if top else []
        roots = sorted(root for root in roots if bottom(root) != 0)
        roots = [root for root in roots if name not in box or player.is_inside(player.number(root), box[name])]
        if roots:
            point[name] = roots[k % len(roots)]
            fixed.add(name)
            return
