"""Graphs as assignments: what all languages share. A language adds its spelling.

Every binary operation stands in parentheses of its own, so that no language's precedence matters,
and a blank on either side of an operator, so that tests can find and corrupt it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from navsym.export.expression_graph import Graph
from navsym.export.parts import ExportedFunction, Piece

SIGNS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
LONGEST = 76


@dataclass(frozen=True, slots=True)
class Spelling:
    """How a language writes numbers and calls.

    calls     : operation -> format with {0}, {1}
    nan, inf  : how these are written, for test vectors
    suffix    : put behind every literal (``f`` in C with float)
    """

    calls: Mapping[str, str]
    nan: str
    inf: str
    suffix: str = ""
    exponent: str = "e"

    def number(self, value: float) -> str:
        """A literal that is read back as exactly this number."""
        if math.isnan(value):
            return self.nan
        if math.isinf(value):
            return self.inf if value > 0 else f"-{self.inf}"
        text = repr(float(value))
        if "e" in text:
            head, tail = text.split("e")
            text = f"{head if '.' in head else head + '.0'}{self.exponent}{int(tail)}"
        elif self.exponent != "e":
            text += f"{self.exponent}0"
        return text + self.suffix


def calls(prefix: str = "", suffix: str = "", **special: str) -> dict[str, str]:
    """Names of the library functions with a prefix or suffix, and those that are written otherwise."""
    names = "sin cos exp log sqrt asin acos atan sinh cosh tanh expm1".split()
    table = {name: f"{prefix}{name}{suffix}({{0}})" for name in names}
    table |= {"abs": f"{prefix}fabs{suffix}({{0}})", "atan2": f"{prefix}atan2{suffix}({{0}}, {{1}})"}
    table |= {"pow": f"{prefix}pow{suffix}({{0}}, {{1}})", "max": f"{prefix}fmax{suffix}({{0}}, {{1}})"}
    table |= {"min": f"{prefix}fmin{suffix}({{0}}, {{1}})"}
    return table | {name: f"navsym_{name}({{0}})" for name in HELPERS} | special


def assignments(
    piece: Piece, names: list[str], spelling: Spelling
) -> tuple[list[tuple[str, str]], list[str]]:
    """([(temporary, expression), …], [expression of each result]).

    What the formulas name keeps its name; shared nodes and long expressions get a temporary; everything else stands
    where it is used.
    """
    lines, results = loops_of(piece, names, spelling, frozenset())
    return [(name, text) for name, text, _ in lines], results


def loops_of(
    piece: Piece, names: list[str], spelling: Spelling, apart: frozenset[str]
) -> tuple[list[tuple[str, str, bool]], list[str]]:
    """The same with every operation of ``apart`` in an assignment of its own, marked True."""
    graph, counts = piece.graph, piece.graph.uses()
    text: list[str] = []
    lines: list[tuple[str, str, bool]] = []
    for place, node in enumerate(graph.nodes):
        written = node_text(graph, place, text, names, piece, spelling)
        simple = node.op in ("input", "const") or (
            node.op == "neg" and graph.nodes[node.args[0]].op == "const"
        )
        named = graph.names.get(place)
        if not simple and (named or counts[place] > 1 or len(written) > LONGEST or node.op in apart):
            name = named or f"t{len(lines)}"
            lines.append((name, bare(written), node.op in apart))
            written = name
        text.append(written)
    return lines, [bare(text[root]) for root in graph.roots]


def node_text(
    graph: Graph, place: int, text: list[str], names: list[str], piece: Piece, spelling: Spelling
) -> str:
    """One node in terms of its arguments."""
    node = graph.nodes[place]
    args = [text[a] for a in node.args]
    if node.op == "input":
        return names[node.value]
    if node.op == "const":
        value: Any = piece.literals[place]
        return spelling.number(value)
    if node.op == "neg":
        return f"(-{args[0]})"
    if node.op in SIGNS:
        return f"({args[0]} {SIGNS[node.op]} {args[1]})"
    return spelling.calls[node.op].format(*(bare(a) for a in args))


def bare(text: str) -> str:
    """The text without the one pair of parentheses that encloses all of it."""
    if not (text.startswith("(") and text.endswith(")")):
        return text
    depth = 0
    for place, char in enumerate(text):
        depth += (char == "(") - (char == ")")
        if depth == 0 and place < len(text) - 1:
            return text
    return text[1:-1]


def code_names(function: ExportedFunction, entry: str = "{0}[{1}]") -> list[str]:
    """The name of every input in code: a number by itself, or an entry of its array."""
    return [
        entry.format(a.name, k) if a.size else a.name for a in function.called_with for k in range(a.size or 1)
    ]


#: 1/6, 1/20, 1/42, …: sin(x)/x = 1 - y/6 (1 - y/20 (1 - y/42 …)) with y = x^2.
SINC_STEPS = (6, 20, 42, 72)
#: (x - sin x) = x^3/6 (1 - y/20 (1 - y/42 (…))).
X_MINUS_SIN_STEPS = (20, 42, 72, 110, 156, 210, 272, 342, 420)


@dataclass(frozen=True, slots=True)
class Helper:
    """A function without cancellation and without a hole at zero: a series below the switch, the formula above it.

    about  : what it is, and why the series will do; {switch} in it
    steps  : divisors of the nested series {series} in y = x^2; none for one that is constant
    series : the series with what stands before and behind it; {one} and {six} are numbers
    formula : the plain form; {x} is the argument, {sin}, {sinh}, {expm1} are functions of it
    """

    about: str
    switch: float
    steps: tuple[int, ...]
    series: str
    formula: str


HELPERS = {
    "sinc": Helper(
        "sin(x)/x; below {switch} its series, whose remainder is under x^10/11! < 2^-65.",
        0.0625, SINC_STEPS, "{series}", "{sin} / {x}",
    ),
    "x_minus_sin": Helper(
        "x - sin(x); below {switch} its series, since the difference would cancel.",
        1.0, X_MINUS_SIN_STEPS, "((x * y) / {six}) * {series}", "{x} - {sin}",
    ),
    "sinc_defect": Helper(
        "(x - sin(x))/x^3; below {switch} its series, since the difference would cancel; 1/6 at zero.",
        1.0, X_MINUS_SIN_STEPS, "{series} / {six}", "((({x} - {sin}) / {x}) / {x}) / {x}",
    ),
    "exprel": Helper("(exp(x) - 1)/x; below {switch} it is 1 within 2^-61.", 2.0**-60, (), "{one}", "{expm1} / {x}"),
    "sinhc": Helper("sinh(x)/x; below {switch} it is 1 within 2^-62.", 2.0**-30, (), "{one}", "{sinh} / {x}"),
}  # fmt: skip


def helpers_used(*functions: ExportedFunction) -> list[str]:
    """Names of the helper functions that the code needs."""
    used = {node.op for function in functions for piece in function.pieces for node in piece.graph.nodes}
    return [name for name in HELPERS if name in used]


def horner(steps: tuple[int, ...], one: str, number: Any) -> str:
    """The nested product 1 - y/s1 (1 - y/s2 (…))."""
    text = f"({one} - (y / {number(float(steps[-1]))}))"
    for step in reversed(steps[:-1]):
        text = f"({one} - ((y / {number(float(step))}) * {text}))"
    return text


def helper_parts(name: str, s: Spelling, x: str = "x") -> tuple[str, str, str]:
    """(switch, series below it, formula above it) of a helper in this language; ``x`` is the formula's argument."""
    helper, one = HELPERS[name], s.number(1.0)
    series = horner(helper.steps, one, s.number) if helper.steps else ""
    functions = {f: s.calls[f].format(x) for f in ("sin", "sinh", "expm1")}
    below = helper.series.format(series=series, one=one, six=s.number(6.0))
    return s.number(helper.switch), below, helper.formula.format(x=x, **functions)


def helper_about(name: str, s: Spelling) -> str:
    """The comment of a helper."""
    return HELPERS[name].about.format(switch=s.number(HELPERS[name].switch).removesuffix(s.suffix))


def squares_if_needed(name: str, line: str) -> list[str]:
    """The line that makes y, for a helper whose series has it."""
    return [line] if HELPERS[name].steps else []


def result_fields(function: ExportedFunction, name: str) -> str:
    """``output: value`` of every output, from results that are written as ``name`` with their place."""
    parts, k = [], 0
    for output in function.outputs:
        entries = ", ".join(name.format(k + e) for e in range(output.size))
        parts.append(f"{output.name}: [{entries}]" if output.shape else f"{output.name}: {entries}")
        k += output.size
    return ", ".join(parts)


def summary(function: ExportedFunction) -> list[str]:
    """What every header says: formula, source, verdict, domain, cost, bound. One line each."""
    lines = []
    for piece in function.pieces:
        source = piece.source
        where = "" if function.switch is None else f" up to {function.inputs[function.switch].name}"
        where += "" if piece.limit is None or not where else f" = {piece.limit!r}"
        lines += [f"Claim    {source.claim}: {source.status} ({source.method}){where if piece.limit else ''}"]
        lines += [f"         {source.title}"] if source.title else []
        lines += [f"Source   {source.paper}, {source.equation}"] if source.paper else []
        lines += [f"Scope    {source.scope}"] if source.scope else []
        lines += [f"Assumes  {'; '.join(source.assumptions)}"] if source.assumptions else []
        lines += [f"Formula  {formula}" for formula in source.formula]
        lines += [f"Cost     {cost(piece)}", f"Rounding {bound_text(function, piece)}"]
        lines += [f"Tie      code graph equals the formula: {TIES[piece.tie]}"]
    lines += [f"Domain   {line}" for line in domain_lines(function)]
    return lines + [f"Result   {o.name} [{unit_of(o.unit)}]" for o in function.outputs]


def domain_lines(function: ExportedFunction) -> list[str]:
    """Proved range, accepted range and unit of every argument; one line for an array whose entries are alike."""
    lines = []
    for a in function.called_with:
        entries = function.inputs[a.first : a.first + (a.size or 1)]
        alike = len({(i.around, i.low, i.high, i.unit) for i in entries}) == 1
        name = f"{a.name}[{a.size}]" if a.size else a.name
        shown = [(name, entries[0])] if alike else [(f"{a.name}[{k}]", i) for k, i in enumerate(entries)]
        for word, i in shown:
            text = i.around.format("each" if a.size and alike else i.symbol.name)
            lines.append(f"{word}: {text}; accepted {accepted(i.low, i.high)} [{unit_of(i.unit)}]")
    return lines


def accepted(low: float, high: float) -> str:
    """The accepted range in words."""
    if math.isinf(low) and math.isinf(high):
        return "when finite"
    if math.isinf(high):
        return f"from {low!r} on"
    return f"up to {high!r}" if math.isinf(low) else f"from {low!r} to {high!r}"


def unit_of(text: str) -> str:
    """The unit in words."""
    return text or "unit not stated"


TIES = {
    "identical": "proved, same expression",
    "normal form": "proved by the normal form",
    "enclosures": "held by enclosures at the test vectors only",
}


def cost(piece: Piece) -> str:
    counted = sorted(piece.graph.operations().items())
    return ", ".join(f"{count} {op}" for op, count in counted) or "no operation"


def bound_text(function: ExportedFunction, piece: Piece) -> str:
    """The derived rounding bounds in words, one for each output."""
    arithmetic, place, parts = function.arithmetic, 0, []
    for output in function.outputs:
        entries = slice(place, place + output.size)
        place += output.size
        name = f"{output.name}: " if len(function.outputs) > 1 else ""
        parts.append(name + entry_bound(piece, entries))
    limits = sizes(function)
    where = f" with {', '.join(limits)}" if limits else ""
    library = (
        f"u = 2^{arithmetic.u}, library functions within {arithmetic.library} or {2 * arithmetic.library} ulp"
    )
    return f"{'; '.join(dict.fromkeys(parts))}{where} ({library})"


def sizes(function: ExportedFunction) -> list[str]:
    """Where a bound of unlimited arguments holds: ``|x| <= 10``, an array for all of its entries if they agree."""
    found: dict[float, list[str]] = {}
    for a in function.called_with:
        entries = function.inputs[a.first : a.first + (a.size or 1)]
        tops = [max(abs(i.test_low), abs(i.test_high)) for i in entries]
        free = [math.isinf(i.low) or math.isinf(i.high) for i in entries]
        if a.size and all(free) and len(set(tops)) == 1:
            found.setdefault(tops[0], []).append(a.name)
            continue
        for i, top, unbounded in zip(entries, tops, free, strict=True):
            if unbounded:
                found.setdefault(top, []).append(i.name)
    return [f"{', '.join(f'|{name}|' for name in names)} <= {top:g}" for top, names in found.items()]


def entry_bound(piece: Piece, entries: slice) -> str:
    """The strongest kind of bound that all entries of one output have."""
    bound = piece.bound
    relative, scaled, absolute = (max(b[entries]) for b in (bound.relative, bound.scaled, bound.absolute))
    if relative == 0:
        return "exact"
    if relative < 1e4:
        return f"relative error at most {relative:.3g} u, within {math.ceil(relative - 1e-6)} ulp"
    if scaled < 1e4:
        return f"error at most {scaled:.3g} u times the sum of the magnitudes of its terms"
    if math.isfinite(absolute):
        return f"absolute error at most {absolute:.3g}"
    return "no uniform bound; each test vector carries its own"
