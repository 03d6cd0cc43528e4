"""Regimes that follow each other in one parameter: their order, limits and common results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp

from navsym.core.errors import DomainError, ShapeError
from navsym.export.parts import Material, Output, inside
from navsym.prove.identities.normal_form import vanishes_identically


def in_order(parts: Sequence[Material]) -> tuple[list[Material], sp.Symbol | None]:
    """Regimes sorted along the one parameter in which they adjoin; raises DomainError on a gap."""
    if len(parts) == 1:
        return list(parts), None
    symbols = {s for part in parts for s in part.box}
    if len(symbols) != 1:
        raise DomainError(f"expected regimes in one parameter; got {len(symbols)}; export them singly")
    (symbol,) = symbols
    ordered = sorted(parts, key=lambda part: inside(part.box[symbol][0], 1))
    for before, after in pairwise(ordered):
        if not same_number(before.box[symbol][1], after.box[symbol][0]):
            raise DomainError(f"expected regimes that adjoin; got a gap before {after.claim}; add the missing one")
    return ordered, symbol


def same_number(a: Any, b: Any) -> bool:
    """Equality of exact numbers, by the normal form."""
    return vanishes_identically(sp.sympify(a, strict=True) - sp.sympify(b, strict=True))


def joined_box(parts: Sequence[Material], switch: sp.Symbol | None) -> Mapping[Any, Any]:
    """The box of one claim, or the range of the parameter over all regimes."""
    if switch is None:
        return parts[0].box
    return {switch: (parts[0].box[switch][0], parts[-1].box[switch][1])}


def limit_of(part: Material, switch: sp.Symbol | None, last: bool, real: str) -> float | None:
    """The last double of a regime; the next double lies inside the next one."""
    return None if switch is None or last else inside(part.box[switch][1], -1, real)


def common_outputs(parts: Sequence[Material]) -> tuple[tuple[Output, ...], list[list[sp.Expr]]]:
    """Outputs large enough for all regimes; shorter vectors end with zeros."""
    names = [output.name for output, _ in parts[0].results]
    if any([output.name for output, _ in part.results] != names for part in parts):
        raise ShapeError("expected regimes with the same outputs; got different ones; export them singly")
    outputs, columns = [], []
    for k, name in enumerate(names):
        sizes = [part.results[k][0].shape for part in parts]
        shape = max(sizes, key=lambda s: int(np.prod(s, dtype=int)))
        if any(len(s) != len(shape) or (len(s) != 1 and s != shape) for s in sizes):
            raise ShapeError(f"expected {name} of one shape in all regimes; got several; export them singly")
        outputs.append(Output(name, shape))
        columns.append(
            [part.results[k][1] + [sp.S.Zero] * (outputs[k].size - len(part.results[k][1])) for part in parts]
        )
    return tuple(outputs), [[e for column in columns for e in column[p]] for p in range(len(parts))]
