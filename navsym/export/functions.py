"""What leaves the house: a claim that holds, as a function with domain, graph, bound and source.

A claim that does not hold is refused here, and nowhere later; a refuted one names its correction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp

from navsym.claims import CONFIRMED, REFUTED, Bound, Equation, Optimum, Statement, Verdict
from navsym.core.errors import DomainError, NavsymError, ShapeError
from navsym.export.accuracy.overflow import watched
from navsym.export.accuracy.rounding import ARITHMETICS, Arithmetic, literals_of
from navsym.export.accuracy.uniform import CELLS, uniform_bound
from navsym.export.choice import best_form, best_graph, tie_to_formula
from navsym.export.expression_graph import Graph
from navsym.export.forms import safe
from navsym.export.inputs import arguments_of, inputs_of, with_whole_arrays
from navsym.export.languages.names import function_name, local_names
from navsym.export.parts import ExportedFunction, Input, Layout, Material, Output, Piece, Source, inside
from navsym.prove.identities import vanishes_identically
from navsym.prove.wording import expression_text

#: Paper -> symbol -> the last value that its code accepts, where a claim holds without end: one Schuler period.
LAST: dict[str, dict[str, sp.Expr]] = {"guaranteed_velocity": {"T": 2 * sp.pi}}
MOST_OUTPUTS = 400
WORK = 40_000  # nodes times cells that the uniform bound may cost


class RefusedError(NavsymError):
    """A claim that must not be exported."""

    kind = "refused"


def require_exportable(claim: str, verdict: Verdict, correction: str | None, allow_confirmed: bool) -> None:
    """Raise RefusedError unless the verdict allows code; a refuted claim names what corrects it."""
    if verdict.status.holds or (verdict.status == CONFIRMED and allow_confirmed):
        return
    if verdict.status == REFUTED:
        advice = f"export {correction}, which corrects it" if correction else "correct it first"
        raise RefusedError(f"expected a claim that holds; got {claim}, which is refuted; {advice}")
    if verdict.status == CONFIRMED:
        advice = "add allow_confirmed=True if samples are enough for you"
        raise RefusedError(f"expected a proved claim; got {claim}, which is only CONFIRMED by samples; {advice}")
    raise RefusedError(
        f"expected a proved claim; got {claim}, which is {verdict.status} ({verdict.evidence[:160]}); prove it first"
    )


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
    raise RefusedError(f"expected an equation or an optimum; got {claim}, {kind}; there is nothing to compute")


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
        raise ShapeError(f"expected 1 to {MOST_OUTPUTS} results; got {len(flat)}; export a part")
    return Output(name, shape), flat


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
    words = {"title": title, "paper": paper, "equation": equation, "formula": formula_lines(results)}
    source = Source.of(verdict, claim=claim, **words)
    box = statement.box if isinstance(statement, (Equation, Optimum)) else {}
    last = LAST.get(claim.partition(":")[0], {})
    ends = {s: (low, last.get(s.name) if high is None else high) for s, (low, high) in box.items()}
    return Material(claim, results, ends, source)


def formula_lines(results: Sequence[tuple[Output, Sequence[sp.Expr]]]) -> tuple[str, ...]:
    """``name = formula`` of every result, ``name[k] = formula`` of every entry."""
    return tuple(
        f"{output.name}{f'[{k}]' if output.shape else ''} = {expression_text(e)}"
        for output, flat in results
        for k, e in enumerate(flat)
    )


def function_of(
    parts: Sequence[Material],
    *,
    real: str = "double",
    name: str | None = None,
    layout: Layout = Layout(),  # noqa: B008 - frozen
) -> ExportedFunction:
    """The function of one claim, or of several regimes that follow each other in one parameter.

    parts : decided claims (:func:`material`), in the order of the parameter
    real  : ``double`` or ``float``
    Raises RefusedError for code that is not proved equal to its formula, ShapeError for too many results.
    """
    name = name or function_name("_then_".join(part.claim for part in parts))
    parts, switch_symbol = in_order(parts)
    whole = frozenset[str]().union(*(part.whole for part in parts))
    layout = replace(layout, arrays={**layout.arrays, **parts[0].arrays}, whole=whole)
    needed = needed_symbols(parts) | ({switch_symbol} if switch_symbol is not None else set())
    symbols = with_whole_arrays(sorted(needed, key=str), layout)
    box = parts[0].box
    if switch_symbol is not None:
        box = {switch_symbol: (box[switch_symbol][0], parts[-1].box[switch_symbol][1])}
    outputs, padded = common_outputs(parts)
    inputs = inputs_of(symbols, box, real, layout, [o.name for o in outputs])
    outputs = tuple(replace(o, unit=layout.units.get(o.name, o.unit)) for o in outputs)
    clash = name.lower() in {i.name.lower() for i in inputs}  # Fortran tells neither them nor their case apart
    arithmetic = ARITHMETICS[real]
    pieces = tuple(
        piece_of(
            part,
            formulas,
            inputs,
            arithmetic,
            limit_of(part, switch_symbol, k == len(parts) - 1, real),
            switch_symbol,
            [*(o.name for o in outputs), *layout.arrays],
        )
        for k, (part, formulas) in enumerate(zip(parts, padded, strict=True))
    )
    places = {i.symbol: k for k, i in enumerate(inputs)}
    switch = None if switch_symbol is None else places[switch_symbol]
    arguments = arguments_of(inputs, layout) if layout.arrays else ()
    return ExportedFunction(f"{name}_" if clash else name, inputs, outputs, pieces, arithmetic, switch, arguments)


def needed_symbols(parts: Sequence[Material]) -> set[sp.Symbol]:
    """Symbols of the results and named values that are no named values themselves."""
    formulas = [e for part in parts for _, flat in part.results for e in flat]
    formulas += [e for part in parts for _, e in part.lets]
    named = {s for part in parts for s, _ in part.lets}
    return {s for e in formulas for s in e.free_symbols} - named


def piece_of(
    part: Material,
    formulas: Sequence[sp.Expr],
    inputs: tuple[Input, ...],
    arithmetic: Arithmetic,
    limit: float | None,
    switch: sp.Symbol | None,
    taken: Sequence[str] = (),
) -> Piece:
    """The graph of one regime: the form of each formula that keeps most digits, tied to the formula.

    taken : names in code besides those of the inputs
    """
    symbols = [i.symbol for i in inputs]
    box = box_of_piece(part, inputs, switch, arithmetic)
    ranges = {i.symbol: (i.low, i.high) for i in inputs}
    plainly = bool(part.lets)  # the choice of forms needs values of all symbols; a chain keeps its forms
    forms = [safe(f, ranges) if plainly else best_form(f, symbols, ranges, box, arithmetic) for f in formulas]
    lets = [(name, safe(formula, ranges)) for name, formula in part.lets]
    tied, graph = best_graph(forms, symbols, lets, box, arithmetic)
    equals, tie = tie_to_formula(tied, formulas, dict(part.lets))
    if tie is None:
        raise RefusedError(f"expected code equal to {part.claim}; got a graph that differs; report this")
    graph = replace(graph, names=local_names(graph.names, [*(i.name for i in inputs), *taken]))
    literals = literals_of(graph, arithmetic)
    bound = uniform_bound(graph, box, arithmetic, literals, cells=cells_for(graph))
    graph = watched(graph, accepted_box(inputs, box, arithmetic), arithmetic, literals)
    literals = literals_of(graph, arithmetic)
    named = tuple((name, formula, form) for (name, formula), (_, form) in zip(part.lets, lets, strict=True))
    return Piece(
        limit, tuple(formulas), tuple(forms), graph, literals, bound, tie, part.source, named, tuple(equals), tuple(box)
    )


def rebounded(function: ExportedFunction, library: int) -> ExportedFunction:
    """The same code with the bounds for a library that is accurate to so many ulp."""
    arithmetic = replace(function.arithmetic, library=library)
    pieces = tuple(
        replace(p, bound=uniform_bound(p.graph, p.box, arithmetic, p.literals, cells=cells_for(p.graph)))
        for p in function.pieces
    )
    return replace(function, arithmetic=arithmetic, pieces=pieces)


def box_of_piece(
    part: Material, inputs: Sequence[Input], switch: sp.Symbol | None, arithmetic: Arithmetic
) -> list[tuple[float, float]]:
    """Where vectors and bounds of one regime live."""
    box = [(i.test_low, i.test_high) for i in inputs]
    if switch is not None:
        k = [i.symbol for i in inputs].index(switch)
        low, high = (inside(end, d, arithmetic.name) for end, d in zip(part.box[switch], (1, -1), strict=True))
        box[k] = (max(box[k][0], low), min(box[k][1], high))
    return box


def accepted_box(
    inputs: Sequence[Input], box: Sequence[tuple[float, float]], arithmetic: Arithmetic
) -> list[tuple[float, float]]:
    """All that the code accepts in one regime: vectors and bounds may live in less of it."""
    top = math.ldexp(1.0, arithmetic.top)
    return [
        (low if i.low == i.test_low else max(i.low, -top), high if i.high == i.test_high else min(i.high, top))
        for i, (low, high) in zip(inputs, box, strict=True)
    ]


def cells_for(graph: Graph) -> int:
    """Cells of the uniform bound: fewer for a long graph, whose bound is rarely uniform."""
    return max(2, min(CELLS, WORK // (len(graph.nodes) + 1)))


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
        step = sp.sympify(before.box[symbol][1], strict=True) - sp.sympify(after.box[symbol][0], strict=True)
        if not vanishes_identically(step):
            raise DomainError(f"expected regimes that adjoin; got a gap before {after.claim}; add the missing one")
    return ordered, symbol


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
