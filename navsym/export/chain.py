"""Algorithms as chains of proved links, and programs of two chains: the first state, and a step.

A link is a claim of a paper, or a formula of our own together with the theorem that justifies it; theorems are
decided when the code is made, and what does not hold does not leave. The value of a link has a name, and later
links refer to it by that name, so that each is proved and bounded by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from navsym.claims import PROVED, Statement, Verdict
from navsym.core.errors import DomainError
from navsym.export.functions import formula_lines, function_of, require_exportable
from navsym.export.parts import ExportedFunction, Layout, Material, Output, Source, State, overlap
from navsym.prove.ladder import decide_within
from navsym.prove.wording import expression_text

SECONDS = 90.0
Decided = Callable[[str], Material]
Results = Sequence[tuple[Output, Sequence[sp.Expr]]]


@dataclass(frozen=True, slots=True)
class Link:
    """Some values of a chain.

    claim    : id of a paper's claim whose results they are; "" for formulas of our own
    results  : their names in order, "" for one that is not needed
    formulas : the formulas of our own, in earlier names and in inputs
    theorem  : the statement that justifies them; None for a mere definition
    rename   : symbol of the claim -> name in this chain
    cites    : claims that say the same in the words of a paper
    """

    results: tuple[str, ...]
    claim: str = ""
    formulas: tuple[sp.Expr, ...] = ()
    theorem: Callable[[], Statement] | None = None
    rename: Mapping[str, str] = field(default_factory=dict)
    cites: tuple[str, ...] = ()


def define(values: Mapping[sp.Symbol, sp.Expr], theorem: Any = None, cites: tuple[str, ...] = ()) -> Link:
    """The link of formulas of our own by the symbols that they give a value to."""
    return Link(tuple(s.name for s in values), "", tuple(values.values()), theorem, cites=cites)


@dataclass(frozen=True, slots=True)
class Chain:
    """Links in order.

    outputs : output -> names of its entries, or the one name of a number
    box     : accepted range of an input by its name, in place of the claims' own
    """

    title: str
    links: tuple[Link, ...]
    outputs: Mapping[str, tuple[str, ...] | str]
    layout: Layout = field(default_factory=Layout)
    box: Mapping[str, tuple[Any, Any]] = field(default_factory=dict)
    paper: str = ""

    def function(self, name: str, decided: Decided, real: str) -> ExportedFunction:
        """The chain as a function; raises RefusedError when a link does not hold."""
        parts = [part_of(link, decided) for link in self.links]
        names = Names()
        lets = [let for link, part in zip(self.links, parts, strict=True) for let in bound(link, part, names)]
        results = [self.output(o, entries, names) for o, entries in self.outputs.items()]
        whole = Material(name, results, self.ranges(parts, names), self.source(parts, lets, results), tuple(lets))
        return function_of([whole], real=real, name=name, layout=self.layout)

    def output(self, name: str, entries: tuple[str, ...] | str, names: Names) -> tuple[Output, list[sp.Expr]]:
        """An output, a number or an array of names, with the symbols of its entries."""
        flat = (entries,) if isinstance(entries, str) else entries
        return Output(name, () if isinstance(entries, str) else (len(flat),)), [names.symbol(n) for n in flat]

    def ranges(self, parts: Sequence[Material], names: Names) -> dict[sp.Symbol, tuple[Any, Any]]:
        """Ranges of the inputs: where the claims and the chain have one, what lies in all of them."""
        found: dict[sp.Symbol, tuple[Any, Any]] = {}
        stated = [(s.name, ends) for part in parts for s, ends in part.box.items()] + list(self.box.items())
        for name, ends in stated:
            if name in names.inputs:
                symbol = names.inputs[name]
                found[symbol] = overlap(found.get(symbol, (None, None)), ends)
        return found

    def source(self, parts: Sequence[Material], lets: Sequence[tuple[sp.Symbol, sp.Expr]], results: Results) -> Source:
        """The sources of all links as one; the weakest status counts."""
        renamed = [(output, flat) for output, flat in results if output.shape or output.name != str(flat[0])]
        order = ("PROVED", "CERTIFIED", "CONFIRMED")
        sources = [part.source for part in parts]
        said = [s for s in sources if s.method != "definition"] or sources  # a mere name for a value says nothing
        certificates = [dict(s.certificate) for s in sources if s.certificate]
        papers = [s.paper for s in sources if s.paper]
        return Source(
            claim=" then ".join(dict.fromkeys(s.claim for s in said)),
            title=self.title,
            paper=self.paper or "; ".join(dict.fromkeys(papers)),
            equation="; ".join(dict.fromkeys(s.equation for s in said if s.equation)),
            status=max((s.status for s in sources), key=order.index),
            method=", ".join(dict.fromkeys(s.method for s in sources)),
            scope="; ".join(dict.fromkeys(s.scope for s in sources if s.scope)),
            assumptions=tuple(dict.fromkeys(a for s in sources for a in s.assumptions)),
            formula=(*(f"{name.name} = {expression_text(formula)}" for name, formula in lets), *formula_lines(renamed)),
            certificate={"kind": "all", "of": certificates} if certificates else None,
        )


class Names:
    """The symbols of a chain under construction: inputs as they are met, values as they are made."""

    def __init__(self) -> None:
        self.inputs: dict[str, sp.Symbol] = {}
        self.values: dict[str, sp.Symbol] = {}

    def symbol(self, name: str, like: sp.Symbol | None = None) -> sp.Symbol:
        """The value of this name, else the input; a new input has the assumptions of the symbol given."""
        if name in self.values:
            return self.values[name]
        positive = like is not None and like.is_positive
        return self.inputs.setdefault(name, sp.Symbol(name, positive=True) if positive else sp.Symbol(name, real=True))

    def make(self, name: str) -> sp.Symbol:
        """A new symbol for a value; raises DomainError when the name is taken."""
        if name in self.values or name in self.inputs:
            raise DomainError(f"expected a new name in the chain; got {name} again; rename the result")
        self.values[name] = sp.Symbol(name, real=True)
        return self.values[name]


def bound(link: Link, part: Material, names: Names) -> list[tuple[sp.Symbol, sp.Expr]]:
    """(name, formula) of every result that has a name, in the symbols of the chain."""
    flat = [e for _, entries in part.results for e in entries]
    if len(flat) != len(link.results):
        raise DomainError(f"expected {len(link.results)} results of {part.claim}; got {len(flat)}; correct the chain")
    needed = [e for e, n in zip(flat, link.results, strict=True) if n]
    symbols = sorted({s for e in needed for s in e.free_symbols}, key=lambda s: s.name)
    table = {s: names.symbol(link.rename.get(s.name, s.name), s) for s in symbols}
    inner = sorted(s.name for s, made in table.items() if made in names.values.values())
    ranged = [n for n in inner if link.claim and (n in {s.name for s in part.box})]
    if ranged:
        wanted = f"expected inputs in the proved range of {link.claim}"
        raise DomainError(f"{wanted}; got values for {', '.join(ranged)}; prove their range first")
    return [(names.make(n), e.xreplace(table)) for n, e in zip((n for n in link.results if n), needed, strict=True)]


def part_of(link: Link, decided: Decided) -> Material:
    """The results of a link with their source."""
    if link.claim:
        return decided(link.claim)
    verdict = Verdict(PROVED, "definition") if link.theorem is None else decide_within(link.theorem(), SECONDS)
    shown = ", ".join(n for n in link.results if n) or "the first state, which is given"
    require_exportable(f"the formulas of {shown}", verdict, None, False)
    where = f"definition of {shown}" if link.theorem is None else f"theorem of {shown}"
    source = Source.of(verdict, claim=" and ".join(link.cites) or where, equation=where)
    return Material(where, [(Output("own", (len(link.formulas),)), list(link.formulas))], {}, source)


def kept(title: str, names: Sequence[str], layout: Layout, box: Mapping[str, tuple[Any, Any]] | None = None) -> Chain:
    """A first state as it is given: ``NAME_0`` comes out as ``NAME``, tested for its range."""
    entries = {name: layout.arrays.get(name, name) for name in names}
    arrays = {f"{name}_0": layout.arrays[name] for name in names if name in layout.arrays}
    numbers = [name for name in names if name not in layout.arrays]
    links = [Link((name,), "", (sp.Symbol(f"{name}_0", real=True),)) for name in numbers] or [Link(())]
    units = {**layout.units, **{f"{name}_0": layout.units.get(name, "") for name in names}}
    order = tuple(f"{name}_0" for name in names)
    tests = {**layout.tests, **{f"{n}_0": layout.tests[n] for n in numbers if n in layout.tests}}
    return Chain(title, tuple(links), entries, Layout(arrays, order, tests, units), box or {})


def real(name: str) -> sp.Symbol:
    """A real symbol."""
    return sp.Symbol(name, real=True)


def symmetric(upper: Sequence[sp.Expr]) -> sp.Matrix:
    """A symmetric matrix (2, 2) from its upper triangle (11, 12, 22)."""
    return sp.Matrix([[upper[0], upper[1]], [upper[1], upper[2]]])


def units_of(names: Mapping[str, str]) -> dict[str, str]:
    """Name -> unit, from the names of every unit in one text."""
    return {name: unit for unit, text in names.items() for name in text.split()}


@dataclass(frozen=True, slots=True)
class Regimes:
    """Claims that follow each other in one parameter, each brought to common results by ``arrange``."""

    claims: tuple[str, ...]
    arrange: Callable[[Material], Material]
    layout: Layout = field(default_factory=Layout)

    def function(self, name: str, decided: Decided, real: str) -> ExportedFunction:
        """The claims as one function of several pieces; raises RefusedError when one does not hold."""
        parts = [self.arrange(decided(claim)) for claim in self.claims]
        return function_of(parts, real=real, name=name, layout=self.layout)


@dataclass(frozen=True, slots=True)
class Program:
    """A first state and a step.

    fields : outputs of ``init``, each with the output of ``step`` that replaces it, "" for one that stays;
             the step takes a field as the argument of the same name
    """

    init: Chain | Regimes
    step: Chain
    fields: Mapping[str, str]

    def functions(self, name: str, decided: Decided, real: str) -> list[ExportedFunction]:
        """``NAME_start`` and ``NAME_next``, the second with its state."""
        start = self.init.function(f"{name}_start", decided, real)
        kept_units = {self.fields[o.name]: o.unit for o in start.outputs if self.fields.get(o.name)}
        step = replace(self.step, layout=replace(self.step.layout, units=kept_units | dict(self.step.layout.units)))
        made = step.function(f"{name}_next", decided, real)
        missing = set(self.fields) - {o.name for o in start.outputs}
        if missing:
            raise DomainError(f"expected fields among the outputs of init; got {sorted(missing)}; correct it")
        return [start, replace(made, state=State(name, tuple(self.fields.items()), start))]
