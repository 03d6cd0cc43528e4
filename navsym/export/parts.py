"""The nouns of the export: sources, arguments, results, regimes and functions, as plain data."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from navsym.claims import Verdict
from navsym.core.balls import enclose
from navsym.export.accuracy.rounding import Arithmetic
from navsym.export.accuracy.uniform import Uniform
from navsym.export.expression_graph import Graph


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Where a function comes from, in words and with its certificate."""

    claim: str
    title: str = ""
    paper: str = ""
    equation: str = ""
    status: str
    method: str
    scope: str = ""
    assumptions: tuple[str, ...] = ()
    formula: tuple[str, ...] = ()
    certificate: Mapping[str, Any] | None = None

    @classmethod
    def of(cls, verdict: Verdict, **words: Any) -> Source:
        """A source that says what a verdict says."""
        said: dict[str, Any] = {"method": verdict.method, "scope": verdict.scope, "certificate": verdict.certificate}
        return cls(status=str(verdict.status), assumptions=tuple(verdict.assumptions), **said, **words)


@dataclass(frozen=True, slots=True, eq=False)
class Input:
    """One argument.

    low, high   : accepted range as doubles, inside the proved one; infinite where it has no end
    test_low, test_high : the range of vectors and of the rounding bound
    around      : the proved range in words, with {0} for the name
    """

    symbol: sp.Symbol
    name: str
    low: float
    high: float
    test_low: float
    test_high: float
    around: str
    unit: str = ""

    @property
    def text(self) -> str:
        """The proved range in words."""
        return self.around.format(self.symbol.name)


@dataclass(frozen=True, slots=True)
class Output:
    """One result: a scalar (shape empty), a vector or a matrix in row-major order."""

    name: str
    shape: tuple[int, ...] = ()
    unit: str = ""

    @property
    def size(self) -> int:
        """How many numbers the output has."""
        return int(np.prod(self.shape, dtype=int))


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument as the caller sees it: a number (size 0) or an array of ``size`` inputs from ``first`` on."""

    name: str
    first: int
    size: int = 0


@dataclass(frozen=True, slots=True)
class Layout:
    """How the caller wants to see a function.

    arrays : name of an array argument -> symbols of its entries
    order  : arguments that come first, in this order; the others follow in alphabetical order
    tests  : symbol -> range of vectors and of the rounding bound, where it is narrower than the accepted one
    units  : symbol, array or output -> unit
    whole  : symbols that stand for whole numbers, as the text of an argument says
    """

    arrays: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    order: tuple[str, ...] = ()
    tests: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    whole: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """The function up to a limit of the switching input (None: without one).

    formulas : exact values of the results, in the symbols of the inputs and of the named values
    forms    : the formulas as they were made safe, equal to them
    lets     : named values in order: symbol, formula, safe form
    equals   : (formula, exact meaning of its node) for every named value and result
    box      : where the bound holds and vectors live
    literals : number in the code for each constant of the graph
    tie      : how the graph was tied to the formulas
    """

    limit: float | None
    formulas: tuple[sp.Expr, ...]
    forms: tuple[sp.Expr, ...]
    graph: Graph
    literals: tuple[float | None, ...]
    bound: Uniform
    tie: str
    source: Source
    lets: tuple[tuple[sp.Symbol, sp.Expr, sp.Expr], ...] = ()
    equals: tuple[tuple[sp.Expr, sp.Expr], ...] = ()
    box: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class ExportedFunction:
    """A function ready to be printed in any language.

    switch    : place of the input that chooses the piece
    arguments : the inputs as the caller sees them; empty means each input by itself
    state     : what a stateful step keeps, and how
    """

    name: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    pieces: tuple[Piece, ...]
    arithmetic: Arithmetic
    switch: int | None = None
    arguments: tuple[Argument, ...] = ()
    state: State | None = None

    @property
    def called_with(self) -> tuple[Argument, ...]:
        """Arguments in order; without arrays, every input by itself."""
        return self.arguments or tuple(Argument(i.name, k) for k, i in enumerate(self.inputs))

    @property
    def size(self) -> int:
        """Number of results, all outputs together."""
        return sum(output.size for output in self.outputs)

    @property
    def placed(self) -> tuple[tuple[Output, int], ...]:
        """Outputs, each with the place of its first entry among all results."""
        ends = itertools.accumulate(output.size for output in self.outputs)
        return tuple((output, end - output.size) for output, end in zip(self.outputs, ends, strict=True))

    @property
    def always_finite(self) -> bool:
        """Proved: nothing overflows for any accepted argument, so that no test of the results is needed."""
        whole = all(i.low == i.test_low and i.high == i.test_high for i in self.inputs)
        return whole and all(piece.bound.finite and not piece.graph.guards for piece in self.pieces)

    @property
    def fields(self) -> dict[str, str]:
        """Fields of the state, each with the output that replaces it; nothing for a function without a state."""
        return dict(self.state.fields) if self.state else {}

    @property
    def replaced(self) -> dict[str, str]:
        """Outputs of the step that replace a field, each with that field."""
        return {new: field for field, new in self.fields.items() if new}

    @property
    def field_outputs(self) -> tuple[Output, ...]:
        """The fields in order, with their shapes, as ``init`` makes them."""
        known = {o.name: o for o in self.state.init.outputs} if self.state else {}
        return tuple(known[name] for name in self.fields)

    @property
    def others(self) -> tuple[Argument, ...]:
        """Arguments of the step that are no fields."""
        return tuple(a for a in self.called_with if a.name not in self.fields)

    @property
    def extras(self) -> tuple[Output, ...]:
        """Results of the step that replace no field."""
        return tuple(o for o in self.outputs if o.name not in self.replaced)

    @property
    def sources(self) -> tuple[Source, ...]:
        """Sources of all pieces."""
        return tuple(piece.source for piece in self.pieces)


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """What a program keeps between its steps.

    program : name of the program
    fields  : names of the fields, each with the output of the step that replaces it, "" for one that stays;
              the step takes a field as the argument of the same name
    init    : the function that makes the first state; its outputs are the fields
    """

    program: str
    fields: tuple[tuple[str, str], ...]
    init: ExportedFunction


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """What a decided claim brings: results, box, source, named values, and the entries of its arrays."""

    claim: str
    results: list[tuple[Output, list[sp.Expr]]]
    box: Mapping[Any, Any]
    source: Source
    lets: tuple[tuple[sp.Symbol, sp.Expr], ...] = ()
    arrays: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    whole: frozenset[str] = frozenset()


def inside(end: Any, direction: int, real: str = "double") -> float:
    """The number of the type nearest to an exact end on its inner side (1: not below it, -1: not above)."""
    kind = np.float32 if real == "float" else np.float64
    ball = enclose(sp.sympify(end, strict=True), {}, 200)
    with np.errstate(over="ignore"):  # an end beyond the largest number becomes the largest number
        value = kind(float(sp.N(sp.sympify(end, strict=True), 40)))
        while (ball > float(value)) if direction > 0 else (ball < float(value)):
            value = np.nextafter(value, kind(direction * np.inf))
    return float(value)


def overlap(one: tuple[Any, Any], other: tuple[Any, Any]) -> tuple[Any, Any]:
    """What lies in both ranges of exact ends; None is an end at infinity."""

    def inner(ends: tuple[Any, Any], direction: int) -> Any:
        known = [sp.sympify(end, strict=True) for end in ends if end is not None]
        if len(known) < 2:
            return known[0] if known else None
        return known[0] if direction * enclose(known[0] - known[1], {}) >= 0 else known[1]

    return inner((one[0], other[0]), 1), inner((one[1], other[1]), -1)
