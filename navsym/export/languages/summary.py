"""What every header says of a function: claim, source, formulas, cost, bound, domain, units."""

from __future__ import annotations

import math
import textwrap
from dataclasses import asdict
from typing import Any

from navsym.export.parts import ExportedFunction, Output, Piece

WIDTH = 108
INDENT = " " * 9


def summary(function: ExportedFunction) -> list[str]:
    """What every header says: formula, source, verdict, domain, cost, bound; long lines go on below their words."""
    return [part for line in facts(function) for part in wrapped(line)]


def wrapped(line: str) -> list[str]:
    """A line as lines that fit on a screen."""
    broken = textwrap.wrap(
        line, WIDTH, subsequent_indent=INDENT, break_long_words=False, break_on_hyphens=False, drop_whitespace=True
    )
    return broken or [line]


def facts(function: ExportedFunction) -> list[str]:
    """One line for each thing there is to say, its kind in the first nine places."""
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
        lines += ["         where nothing overflows or underflows; the status says where"] if piece.graph.guards else []
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


def field_text(function: ExportedFunction, field: Output) -> str:
    """The entries of a field of the state as the formulas name them, and its unit."""
    given = next((a for a in function.called_with if a.name == field.name), None)
    entries = function.inputs[given.first : given.first + (given.size or 1)] if given else ()
    names = ", ".join(i.symbol.name for i in entries) or "stays as it was made"
    return f"{names} [{unit_of(field.unit)}]".replace("*/", "* /")


def state_record(function: ExportedFunction) -> dict[str, Any] | None:
    """The state as plain data: program, fields with the argument and the output of each, outputs of the step."""
    if function.state is None:
        return None
    places = {a.name: k for k, a in enumerate(function.called_with)}
    fields = [{"name": old, "argument": places.get(old, -1), "output": new} for old, new in function.fields.items()]
    return {"program": function.state.program, "fields": fields, "outputs": [o.name for o in function.outputs]}


def function_record(function: ExportedFunction) -> dict[str, Any]:
    """A function for the manifest: inputs with ranges, arguments, outputs, state and pieces."""
    return {
        "name": function.name,
        "inputs": [
            {"name": i.name, "symbol": i.symbol.name, "range": i.text, "unit": i.unit or None} | ends(i.low, i.high)
            for i in function.inputs
        ],
        "arguments": [{"name": a.name, "inputs": [a.first, a.size or 1]} for a in function.called_with],
        "outputs": [{"name": o.name, "shape": list(o.shape), "unit": o.unit or None} for o in function.outputs],
        "state": state_record(function),
        "pieces": [piece_record(function, piece) for piece in function.pieces],
    }


def ends(low: float, high: float) -> dict[str, float | None]:
    """Accepted range; null where it has no end."""
    infinite = float("inf")
    return {"low": None if low == -infinite else low, "high": None if high == infinite else high}


def piece_record(function: ExportedFunction, piece: Piece) -> dict[str, Any]:
    """A piece for the manifest: where it ends, its source without the certificate, operations, rounding bound."""
    source = {k: v for k, v in asdict(piece.source).items() if k != "certificate"}
    return {
        "up_to": piece.limit,
        "source": source,
        "operations": dict(sorted(piece.graph.operations().items())),
        "rounding": bound_text(function, piece),
        "tie": piece.tie,
    }


TIES = {
    "identical": "proved, same expression",
    "normal form": "proved by the normal form",
    "enclosures": "held by enclosures at the test vectors only",
}


def cost(piece: Piece) -> str:
    """How many operations of each kind a piece takes, in words."""
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
    library = f"u = 2^{arithmetic.u}, library functions within {arithmetic.library} or {2 * arithmetic.library} ulp"
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
        return f"error at most {scaled:.3g} u times the sum of the magnitudes of its terms (underflow aside)"
    if math.isfinite(absolute):
        return f"absolute error at most {absolute:.3g}"
    return "no uniform bound; each test vector carries its own"
