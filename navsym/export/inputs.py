"""Arguments of a function: their order, arrays, units, and ranges rounded into the proved ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp

from navsym.core.errors import ShapeError
from navsym.export.languages.names import LONGEST, identifier
from navsym.export.parts import Argument, Input, Layout, inside
from navsym.prove.sampling.points import Range, range_of
from navsym.prove.wording import expression_text

SMALLEST = {"double": 2.0**-60, "float": 2.0**-20}  # stands for an open end at zero
LARGE = 1000.0  # the end of a range that has none, for vectors and bounds


def inputs_of(
    symbols: Sequence[sp.Symbol], box: Mapping[Any, Any], real: str, layout: Layout, outputs: Sequence[str]
) -> tuple[Input, ...]:
    """Inputs in the order of the layout, then of the alphabet, with ranges rounded into the proved ones."""
    made: list[Input] = []
    taken = ["value", "weights", "instants", "dual", *outputs, *layout.arrays]
    for symbol in in_layout(symbols, layout):
        name = identifier(symbol.name[:LONGEST], [*(i.name for i in made), *taken])
        made.append(input_of(symbol, name, box, real, layout))
    return tuple(made)


def with_whole_arrays(symbols: Sequence[sp.Symbol], layout: Layout) -> list[sp.Symbol]:
    """The symbols, and those entries of their arrays that no formula needs."""
    present = {s.name for s in symbols}
    touched = [entries for entries in layout.arrays.values() if present & set(entries)]
    missing = [sp.Symbol(e, real=True) for entries in touched for e in entries if e not in present]
    return [*symbols, *missing]


def in_layout(symbols: Sequence[sp.Symbol], layout: Layout) -> list[sp.Symbol]:
    """Symbols in the order of the arguments; entries of an array stay together."""
    words = [entry for name in layout.order for entry in layout.arrays.get(name, (name,))]
    words += [entry for name, entries in layout.arrays.items() if name not in layout.order for entry in entries]
    place = {word: k for k, word in enumerate(words)}
    return sorted(symbols, key=lambda s: (place.get(s.name, len(place)), s.name.lower(), s.name))


def arguments_of(inputs: Sequence[Input], layout: Layout) -> tuple[Argument, ...]:
    """Arrays of the layout as arguments, where all of their entries are inputs; other inputs by themselves."""
    first = {entries[0]: (name, len(entries)) for name, entries in layout.arrays.items()}
    names, found, k = [i.symbol.name for i in inputs], [], 0
    while k < len(inputs):
        name, size = first.get(names[k], (inputs[k].name, 0))
        if size and tuple(names[k : k + size]) != tuple(layout.arrays[name]):
            raise ShapeError(f"expected all {size} entries of {name} as inputs; got some; correct the layout")
        found.append(Argument(name, k, size))
        k += size or 1
    return tuple(found)


def input_of(symbol: sp.Symbol, name: str, box: Mapping[Any, Any], real: str, layout: Layout) -> Input:
    """One argument: its unit, its accepted range, and the range of vectors and bounds, whose ends are of the type."""
    limits = range_of(symbol, box)
    low = -np.inf if limits.lower is None else inside(limits.lower, 1, real)
    high = np.inf if limits.upper is None else inside(limits.upper, -1, real)
    test_high = high if np.isfinite(high) else max(LARGE, 2 * abs(low)) if np.isfinite(low) else LARGE
    test_low = low if np.isfinite(low) else -max(LARGE, 2 * abs(high)) if np.isfinite(high) else -LARGE
    if limits.open_lower and low == 0.0:
        test_low = low = SMALLEST[real]
    array = next((a for a, entries in layout.arrays.items() if symbol.name in entries), "")
    wanted = layout.tests.get(symbol.name) or layout.tests.get(array, (test_low, test_high))
    first, last = max(wanted[0], low), min(wanted[1], high)
    tests = inside(sp.Rational(first), 1, real), inside(sp.Rational(last), -1, real)
    words = around(limits) + ", {0} whole" * (symbol.name in layout.whole)
    unit = layout.units.get(symbol.name) or layout.units.get(array, "")
    return Input(symbol, name, float(low), float(high), *tests, words, unit)


def around(limits: Range) -> str:
    """A range in words, with {0} for the name."""
    lower = "" if limits.lower is None else f"{expression_text(limits.lower)} {'<' if limits.open_lower else '<='} "
    upper = "" if limits.upper is None else f" <= {expression_text(limits.upper)}"
    hole = limits.nonzero and (limits.lower is None or limits.lower < 0) and (limits.upper is None or limits.upper > 0)
    if not (lower or upper):
        return "{0} != 0" if hole else "{0} real"
    return f"{lower}{{0}}{upper}" + (", {0} != 0" if hole else "")
