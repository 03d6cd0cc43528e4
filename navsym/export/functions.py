"""What leaves the house: a claim that holds, as a function with domain, graph, bound and source.

A claim that does not hold is refused here, and nowhere later; a refuted one names its correction.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp
from flint import arb

from navsym.claims import CONFIRMED, REFUTED, Bound, Equation, Optimum, Statement, Verdict
from navsym.errors import NavsymError, ShapeError
from navsym.export.expression_graph import Graph, build
from navsym.export.forms import factored, safe
from navsym.export.names import function_name, identifier
from navsym.export.parts import ExportedFunction, Input, Material, Output, Piece, Source, inside
from navsym.export.regimes import common_outputs, in_order, joined_box, limit_of
from navsym.export.rounding import ARITHMETICS, BITS, LIBRARY, Arithmetic, analyse
from navsym.export.uniform import uniform_bound
from navsym.proof.balls import precision
from navsym.proof.normal_form import OutsideLanguageError, reduce_to_zero
from navsym.proof.sampling import range_of
from navsym.proof.wording import text_of

SMALLEST = {"double": 2.0**-60, "float": 2.0**-20}  # stands for an open end at zero
LARGE = 1000.0  # of a symbol without a range, for vectors and bounds
MOST_OUTPUTS = 400
SAMPLES = 12


class RefusedError(NavsymError):
    """A claim that must not be exported."""

    kind = "refused"


# -- refusal ---------------------------------------


def require_exportable(claim: str, verdict: Verdict, correction: str | None, allow_confirmed: bool) -> None:
    """Raise RefusedError unless the verdict allows code; a refuted claim names what corrects it."""
    if verdict.status.holds or (verdict.status == CONFIRMED and allow_confirmed):
        return
    if verdict.status == REFUTED:
        advice = f"export {correction}, which corrects it" if correction else "correct it first"
        raise RefusedError(f"expected a claim that holds; got {claim}, which is refuted; {advice}")
    if verdict.status == CONFIRMED:
        advice = "add --allow-confirmed if samples are enough for you"
        raise RefusedError(
            f"expected a proved claim; got {claim}, which is only CONFIRMED by samples; {advice}"
        )
    raise RefusedError(
        f"expected a proved claim; got {claim}, which is {verdict.status} ({verdict.evidence[:160]}); prove it first"
    )


# -- results of a statement ---------------------------------------


def results_of(statement: Statement, claim: str) -> list[tuple[Output, list[sp.Expr]]]:
    """Outputs and their exact formulas: the printed side of an equation, the solution of an optimum."""
    if isinstance(statement, Equation):
        side = statement.printed if statement.tolerance is None else statement.derived
        return [entries(side, "value")]
    if isinstance(statement, Optimum):
        parts = [("value", statement.value), ("weights", statement.weights)]
        parts += [("instants", statement.support), ("dual", statement.dual)]
        return [entries(side, name) for name, side in parts]
    kind = "an inequality" if isinstance(statement, Bound) else "a fact"
    raise RefusedError(
        f"expected an equation or an optimum; got {claim}, {kind}; there is nothing to compute"
    )


def entries(side: Any, name: str) -> tuple[Output, list[sp.Expr]]:
    """Scalar, vector or matrix as an output and its entries in row-major order."""
    shape: tuple[int, ...]
    if isinstance(side, sp.MatrixBase):
        shape = (side.rows,) if side.cols == 1 else (side.rows, side.cols)
        flat = [sp.sympify(x, strict=True) for x in side]
    elif isinstance(side, (tuple, list)):
        shape, flat = (len(side),), [sp.sympify(x, strict=True) for x in side]
    else:
        shape, flat = (), [sp.sympify(side, strict=True)]
    if not 0 < len(flat) <= MOST_OUTPUTS:
        raise ShapeError(f"expected 1 to {MOST_OUTPUTS} results; got {len(flat)}; do export a part")
    return Output(name, shape), flat


# -- inputs ---------------------------------------


def inputs_of(symbols: Sequence[sp.Symbol], box: Mapping[Any, Any], real: str) -> tuple[Input, ...]:
    """Arguments in alphabetical order, with ranges rounded into the proved ones."""
    made: list[Input] = []
    for symbol in sorted(symbols, key=lambda s: (s.name.lower(), s.name)):
        name = identifier(symbol.name, [*(i.name for i in made), "value", "weights", "instants", "dual"])
        made.append(input_of(symbol, name, box, real))
    return tuple(made)


def input_of(symbol: sp.Symbol, name: str, box: Mapping[Any, Any], real: str) -> Input:
    """One argument: accepted range, and the range in which vectors and bounds live."""
    limits = range_of(symbol, box)
    low = -np.inf if limits.lower is None else inside(limits.lower, 1, real)
    high = np.inf if limits.upper is None else inside(limits.upper, -1, real)
    opened = bool(limits.open_lower) and limits.lower is not None
    test_high = min(high, max(LARGE, 2 * abs(low))) if np.isfinite(low) else min(high, LARGE)
    test_low = max(low, -max(LARGE, 2 * abs(high))) if np.isfinite(high) else max(low, -LARGE)
    if opened and low == 0.0:
        test_low = low = SMALLEST[real]
        opened = False
    text = f"{'-oo' if limits.lower is None else text_of(limits.lower)} {'<' if limits.open_lower else '<='} "
    text += f"{symbol.name} <= {'oo' if limits.upper is None else text_of(limits.upper)}"
    return Input(symbol, name, float(low), float(high), opened, float(test_low), float(test_high), text)


# -- the function ---------------------------------------


def material(
    claim: str,
    statement: Statement,
    verdict: Verdict,
    *,
    title: str = "",
    paper: str = "",
    equation: str = "",
    correction: str | None = None,
    allow_confirmed: bool = False,
) -> Material:
    """A decided claim as material for a function; raises RefusedError when it must not leave."""
    require_exportable(claim, verdict, correction, allow_confirmed)
    results = results_of(statement, claim)
    formula = tuple(
        f"{output.name}{'' if not output.shape else f'[{k}]'} = {text_of(e)}"
        for output, flat in results
        for k, e in enumerate(flat)
    )
    source = Source(
        claim, title, paper, equation, str(verdict.status), verdict.method, verdict.scope,
        tuple(verdict.assumptions), formula, verdict.certificate,
    )  # fmt: skip
    box = statement.box if isinstance(statement, (Equation, Optimum)) else {}
    return Material(claim, results, box, source)


def function_of(
    parts: Sequence[Material], *, real: str = "double", name: str | None = None
) -> ExportedFunction:
    """The function of one claim, or of several regimes that follow each other in one parameter."""
    name = name or function_name("_then_".join(part.claim for part in parts))
    parts, switch_symbol = in_order(parts)
    symbols = sorted({s for part in parts for _, flat in part.results for e in flat for s in e.free_symbols}
                     | ({switch_symbol} if switch_symbol is not None else set()), key=str)  # fmt: skip
    box = joined_box(parts, switch_symbol)
    inputs = inputs_of(symbols, box, real)
    arithmetic = ARITHMETICS[real]
    outputs, padded = common_outputs(parts)
    pieces = tuple(
        piece_of(
            part,
            formulas,
            inputs,
            arithmetic,
            limit_of(part, switch_symbol, k == len(parts) - 1, real),
            switch_symbol,
        )
        for k, (part, formulas) in enumerate(zip(parts, padded, strict=True))
    )
    places = {i.symbol: k for k, i in enumerate(inputs)}
    switch = None if switch_symbol is None else places[switch_symbol]
    return ExportedFunction(name, inputs, outputs, pieces, arithmetic, switch)


def piece_of(
    part: Material,
    formulas: Sequence[sp.Expr],
    inputs: tuple[Input, ...],
    arithmetic: Arithmetic,
    limit: float | None,
    switch: sp.Symbol | None,
) -> Piece:
    """The graph of one regime: the form of each formula that keeps most digits, tied to the formula."""
    symbols = [i.symbol for i in inputs]
    box = [(i.test_low, i.test_high) for i in inputs]
    if switch is not None:
        k = symbols.index(switch)
        low, high = (
            inside(end, d, arithmetic.name) for end, d in zip(part.box[switch], (1, -1), strict=True)
        )
        box[k] = (max(box[k][0], low), min(box[k][1], high))
    ranges = {i.symbol: (i.low, i.high) for i in inputs}
    forms = [best_form(formula, symbols, ranges, box, arithmetic) for formula in formulas]
    graph = min(
        (build(forms, symbols, share=share) for share in (True, False)),
        key=lambda g: lost_digits(g, box, arithmetic) + sum(LIBRARY.get(n.op, 0) for n in g.nodes) / 4,
    )
    tie = tie_to_formula(graph, formulas)
    if tie is None:
        raise RefusedError(f"expected code equal to {part.claim}; got a graph that differs; do report this")
    literals = literals_of(graph, arithmetic)
    bound = uniform_bound(graph, box, arithmetic, literals)
    return Piece(limit, tuple(formulas), tuple(forms), graph, literals, bound, tie, part.source)


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
    better = costs[1] < costs[0] - 0.5 and tie_to_formula(graphs[1], [formula]) in (
        "identical",
        "normal form",
    )
    return other if better else printed


def lost_digits(graph: Graph, box: list[tuple[float, float]], arithmetic: Arithmetic) -> float:
    """Mean over sample points of the bits that the derived bound concedes, 60 where there is none."""
    generator = random.Random(0)
    literals, total = literals_of(graph, arithmetic), 0.0
    for _ in range(SAMPLES):
        with precision(BITS):
            point = [arb(spread(generator, low, high)) for low, high in box]
            done = analyse(graph, point, arithmetic, literals)
            worst = max(float(done[r].relative / arithmetic.unit()) for r in graph.roots)
        total += min(60.0, math.log2(worst)) if worst > 1 else 0.0
    return total / SAMPLES


def spread(generator: random.Random, low: float, high: float) -> float:
    """A number of the range, often near zero when the range is positive."""
    if low > 0 and generator.random() < 0.5:
        return math.exp(generator.uniform(math.log(max(low, high * 1e-6)), math.log(high)))
    return generator.uniform(low, high)


def literals_of(graph: Graph, arithmetic: Arithmetic) -> tuple[float | None, ...]:
    """The number in the code for each constant node."""
    return tuple(literal(n.value, arithmetic) if n.op == "const" else None for n in graph.nodes)


def tie_to_formula(graph: Graph, formulas: Sequence[sp.Expr]) -> str | None:
    """How the exact meaning of the graph is known to be the formula; None when they differ.

    "identical" or "normal form" is a proof. "enclosures" means that the normal form has no answer
    (an atom outside its ring), and only the vectors hold the graph to the formula.
    """
    ties = {"identical"}
    for meaning, formula in zip(graph.meaning(), formulas, strict=True):
        if meaning == formula:
            continue
        try:
            reduction = reduce_to_zero(meaning - formula)
        except (OutsideLanguageError, NavsymError):
            ties.add("enclosures")
            continue
        if not reduction.zero:
            if reduction.complete:
                return None
            ties.add("enclosures")
        else:
            ties.add("normal form")
    return next(tie for tie in ("enclosures", "normal form", "identical") if tie in ties)


def literal(value: sp.Expr, arithmetic: Arithmetic) -> float:
    """The number that stands in the code for an exact constant: the nearest of the type."""
    nearest = int(value.p) / int(value.q) if value.is_Rational else float(sp.N(value, 40))
    return float(np.float32(nearest)) if arithmetic.name == "float" else nearest
