"""Which form of a formula becomes code, and how that code is tied to the formula."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp
from flint import arb

from navsym.core.balls import precision
from navsym.export.accuracy.continuation import analyse
from navsym.export.accuracy.rounding import BITS, LIBRARY, Arithmetic, literals_of
from navsym.export.accuracy.vectors import sample
from navsym.export.expression_graph import Graph, build
from navsym.export.forms import factored, safe
from navsym.prove.identities import has_unique_form, vanishes_identically

SAMPLES = 12


def best_form(
    formula: sp.Expr,
    symbols: Sequence[sp.Symbol],
    ranges: Mapping[sp.Symbol, Any],
    box: list[tuple[float, float]],
    arithmetic: Arithmetic,
) -> sp.Expr:
    """The printed form, unless its factored form is proved equal and costs less.

    Cost: bits lost in the mean, and a tenth of a bit for each operation.
    """
    printed = safe(formula, ranges)
    nicer = factored(formula)
    if nicer is None:
        return printed
    other = safe(nicer, ranges)
    graphs = [build([form], symbols, share=False) for form in (printed, other)]
    costs = [lost_digits(graph, box, arithmetic) + 0.1 * graph.operations().total() for graph in graphs]
    better = costs[1] < costs[0] - 0.5 and tie_to_formula(graphs[1], [formula])[1] in ("identical", "normal form")
    return other if better else printed


def lost_digits(graph: Graph, box: list[tuple[float, float]], arithmetic: Arithmetic) -> float:
    """Mean over sample points of the bits that the derived bound concedes, 60 where there is none."""
    generator = random.Random(0)
    literals, total = literals_of(graph, arithmetic), 0.0
    for _ in range(SAMPLES):
        with precision(BITS):
            point = [arb(sample(low, high, generator)) for low, high in box]
            done = analyse(graph, point, arithmetic, literals)
            worst = max(float(done[r].relative / arithmetic.unit()) for r in graph.roots)
        total += min(60.0, math.log2(worst)) if worst > 1 else 0.0
    return total / SAMPLES


def tie_to_formula(
    graph: Graph, formulas: Sequence[sp.Expr], lets: Mapping[sp.Symbol, sp.Expr] | None = None
) -> tuple[list[tuple[sp.Expr, sp.Expr]], str | None]:
    """How the exact meaning of the graph is known to be the formula; None when they differ.

    "identical" or "normal form" is a proof. "enclosures" means that the normal form has no answer
    (an atom outside its ring), and only the vectors hold the graph to the formula. Named values are
    compared one by one, so that a chain is proved link by link.
    """
    named, known = graph.named_meanings(), lets or {}
    pairs = [(known[name], meaning) for name, meaning in named.items()]
    pairs += zip(formulas, graph.meaning(), strict=True)
    ties = [tie_of(meaning, formula) for formula, meaning in pairs]
    return pairs, None if None in ties else next(tie for tie in TIES if tie in (*ties, "identical"))


TIES = ("enclosures", "normal form", "identical")  # the weakest one counts


def tie_of(meaning: sp.Expr, formula: sp.Expr) -> str | None:
    """The tie of one value; None when it differs from its formula."""
    if meaning == formula:
        return "identical"
    if vanishes_identically(meaning - formula):
        return "normal form"
    return None if has_unique_form(meaning - formula) else "enclosures"


def best_graph(
    forms: Sequence[sp.Expr],
    symbols: Sequence[sp.Symbol],
    lets: Sequence[tuple[sp.Symbol, sp.Expr]],
    box: list[tuple[float, float]],
    arithmetic: Arithmetic,
) -> tuple[Graph, Graph]:
    """The cheaper of the graphs with and without shared angles, with and without the names of its values."""
    candidates = [build(forms, symbols, share=share, lets=lets) for share in (True, False)]
    pairs = [(graph, graph.without_names()) for graph in candidates]

    def cost(pair: tuple[Graph, Graph]) -> float:
        return lost_digits(pair[1], box, arithmetic) + sum(LIBRARY.get(n.op, 0) for n in pair[1].nodes) / 4

    return min(pairs, key=cost)
