"""The analysis of a whole graph: operations by their own bounds, parts with a hole by those of their branches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb

from navsym.export.accuracy.filled import filled_bounds
from navsym.export.accuracy.rounding import Arithmetic, Bounded, followed
from navsym.export.expression_graph import Graph


def analyse(graph: Graph, inputs: Sequence[arb], arithmetic: Arithmetic, literals: Sequence[Any]) -> list[Bounded]:
    """Value and error bounds of every node over the box of the inputs, which are taken as exact.

    literals : the number that stands in the code for each constant node (None for other nodes)
    """
    return followed(graph, inputs, arithmetic, literals, filled_bounds)
