"""One rounding bound for a whole box: cells are measured, and split where they are worst."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import arb

from navsym.core.balls import precision
from navsym.export.accuracy.continuation import analyse
from navsym.export.accuracy.rounding import BITS, Arithmetic, Bounded, float_above
from navsym.export.expression_graph import Graph

CELLS = 160
GEOMETRIC = 40  # cells that halve their distance to zero
NEVER = 10**6  # the exponent of an overflow that does not happen: where one does, the code says so by its status

Box = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Uniform:
    """Bounds for each result that hold on the whole box wherever nothing overflows; infinite where there is none.

    relative : in units of u: ``|computed - exact| <= relative u |exact|``
    scaled   : in units of u, over the sum of the magnitudes of the terms (underflow aside)
    absolute : ``|computed - exact| <= absolute``
    finite   : no operation can overflow anywhere in the box
    """

    relative: tuple[float, ...]
    scaled: tuple[float, ...]
    absolute: tuple[float, ...]
    finite: bool


def uniform_bound(
    graph: Graph,
    box: Sequence[tuple[float, float]],
    arithmetic: Arithmetic,
    literals: Sequence[Any],
    cells: int = CELLS,
) -> Uniform:
    """Bounds over a box of exact ends, by subdividing where they are worst.

    A side that comes near zero is first cut geometrically, since relative bounds repeat there.
    """
    queue: list[tuple[float, int, Box, Uniform]] = []
    waiting = starting_cells(box)
    count = 0
    while waiting or (queue and count < cells):
        if not waiting:
            _, _, worst, _ = queue[0]
            waiting = split(worst)
            if not waiting:
                break
            heapq.heappop(queue)
        part = waiting.pop()
        found = measured(graph, part, arithmetic, literals)
        count += 1
        # Relative bounds are capped, so that one zero does not hide the others.
        cost = sum(min(r, 1e6) for r in found.relative) + sum(min(r, 1e12) for r in found.scaled)
        heapq.heappush(queue, (-cost, count, part, found))
    every = [cell[-1] for cell in queue]
    relative, scaled, absolute = (
        tuple(map(max, zip(*(getattr(u, name) for u in every), strict=True)))
        for name in ("relative", "scaled", "absolute")
    )
    return Uniform(relative, scaled, absolute, finite=all(u.finite for u in every))


def starting_cells(box: Sequence[tuple[float, float]]) -> list[Box]:
    """The box, cut geometrically along the first side that comes near zero."""
    for place, (low, high) in enumerate(box):
        if low > 0 and high > 4 * low:
            ends = [high]
            while ends[-1] > 4 * low and len(ends) < GEOMETRIC:
                ends.append(ends[-1] / 4)
            ends.append(low)
            pairs = zip(ends[1:], ends, strict=False)
            return [(*box[:place], pair, *box[place + 1 :]) for pair in pairs]
    return [tuple(box)]


def split(box: Box) -> list[Box]:
    """Two halves along the side that is widest relative to its size."""
    if not box:
        return []
    widths = [(high - low) / (max(abs(low), abs(high)) or 1) for low, high in box]
    side = max(range(len(box)), key=lambda i: widths[i])
    low, high = box[side]
    middle = (low + high) / 2
    if not low < middle < high:
        return []
    return [(*box[:side], end, *box[side + 1 :]) for end in ((low, middle), (middle, high))]


def measured(graph: Graph, box: Box, arithmetic: Arithmetic, literals: Sequence[Any]) -> Uniform:
    """Bounds of one cell, with floats as ends."""
    found = on_cell(graph, box, replace(arithmetic, top=NEVER), literals)
    results = [found[root] for root in graph.roots]
    with precision(BITS):
        unit = arithmetic.unit()
        return Uniform(
            tuple(float_above(r.relative / unit) for r in results),
            tuple(float_above(r.scaled / unit) for r in results),
            tuple(float_above(r.absolute) for r in results),
            all(node.is_finite(arithmetic) for node in found),
        )


def on_cell(graph: Graph, cell: Box, arithmetic: Arithmetic, literals: Sequence[Any]) -> list[Bounded]:
    """Values and bounds of all nodes on one cell; in code a node without a bound would be infinite, or undefined."""
    with precision(BITS):
        balls = [arb(low).union(arb(high)) if low != high else arb(low) for low, high in cell]
    return analyse(graph, balls, arithmetic, literals)
