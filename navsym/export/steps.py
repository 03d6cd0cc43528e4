"""Stateful algorithms: proved equations put one after the other into one step, with an explicit state.

A step is an ordinary exported function from (state, measurement, parameters) to the next state; only its
formulas are composed. Around it the C target adds a structure with ``init`` and ``step``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import sympy as sp

from navsym.errors import DomainError
from navsym.export.functions import ExportedFunction, Material, Output, Source, function_of
from navsym.export.printing import Spelling


@dataclass(frozen=True, slots=True)
class Stage:
    """One claim of a step; ``results`` names its results in order, "" for one that is not needed."""

    claim: str
    results: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Step:
    """Claims in order; the results of one are the symbols of the next.

    outputs : output -> names of results
    state   : symbol before the step -> name of the result that replaces it
    """

    stages: tuple[Stage, ...]
    outputs: Mapping[str, tuple[str, ...]]
    state: Mapping[str, str]


def step_function(step: Step, parts: Sequence[Material], name: str, real: str = "double") -> ExportedFunction:
    """The composed function; raises DomainError when a stage has another number of results."""
    known: dict[str, sp.Expr] = {}
    before: dict[str, sp.Symbol] = {}
    for stage, part in zip(step.stages, parts, strict=True):
        flat = [e for _, entries in part.results for e in entries]
        if len(flat) != len(stage.results):
            wanted = f"expected {len(stage.results)} results of {stage.claim}"
            raise DomainError(f"{wanted}; got {len(flat)}; do correct the step")
        symbols = sorted({s for e in flat for s in e.free_symbols}, key=lambda s: s.name)
        replaced = {s: known[s.name] if s.name in known else before.setdefault(s.name, s) for s in symbols}
        found = [e.xreplace(replaced) for e in flat]
        known |= {n: e for n, e in zip(stage.results, found, strict=True) if n}
    results = [(Output(o, (len(names),)), [known[n] for n in names]) for o, names in step.outputs.items()]
    composed = Material("+".join(part.claim for part in parts), results, joined(parts), source_of(parts))
    function = function_of([composed], real=real, name=name)
    return replace(function, state=state_places(step, function))


def joined(parts: Sequence[Material]) -> dict[sp.Symbol, tuple[object, object]]:
    return {s: ends for part in parts for s, ends in part.box.items()}


def source_of(parts: Sequence[Material]) -> Source:
    """The sources of all stages as one; the weakest status counts."""
    order = ("PROVED", "CERTIFIED", "CONFIRMED")
    first = parts[0].source
    certificates = [dict(p.source.certificate) for p in parts if p.source.certificate]
    return Source(
        claim=" then ".join(part.claim for part in parts),
        title="One step, composed of the equations named below",
        paper=first.paper,
        equation="; ".join(dict.fromkeys(part.source.equation for part in parts)),
        status=max((part.source.status for part in parts), key=order.index),
        method=", ".join(dict.fromkeys(part.source.method for part in parts)),
        scope="; ".join(dict.fromkeys(part.source.scope for part in parts if part.source.scope)),
        assumptions=tuple(dict.fromkeys(a for part in parts for a in part.source.assumptions)),
        formula=tuple(f"{part.claim}: {line}" for part in parts for line in part.source.formula),
        certificate={"kind": "all", "of": certificates} if certificates else None,
    )


def state_places(step: Step, function: ExportedFunction) -> tuple[tuple[int, int], ...]:
    """(place of the input, place of the result) for every state symbol."""
    names = [name for group in step.outputs.values() for name in group]
    inputs = [i.symbol.name for i in function.inputs]
    return tuple((inputs.index(old), names.index(new)) for old, new in step.state.items() if old in inputs)


# -- C: a structure with init and step ---------------------------------------


def c_state_header(function: ExportedFunction, s: Spelling, license_: str) -> str:
    """``NAME_state.h``: the state, ``NAME_init`` and ``NAME_step``; all in the header, nothing static mutable."""
    real, name = function.arithmetic.name, function.name
    kept = [k for k, _ in function.state]
    fields = [function.inputs[k].name for k in kept]
    others = [i for k, i in enumerate(function.inputs) if k not in kept]
    tests = [test for k in kept for test in range_tests(function, k, s)]
    calls = [f"state->{i.name}" if k in kept else i.name for k, i in enumerate(function.inputs)]
    calls += [f"&r[{place}]" for place in output_places(function)]
    guard = f"NAVSYM_{name.upper()}_STATE_H"
    lines = [f"/* {license_} */", f"#ifndef {guard}", f"#define {guard}", ""]
    lines += ["#include <float.h>", f'#include "{name}.h"', "", "typedef struct {"]
    lines += [f"    {real} {field};" for field in fields] + [f"}} {name}_state;", ""]
    lines += ["/* Sets the state; refuses values outside the domain of the step and leaves the state as it was. */"]
    lines += [f"static inline navsym_status {name}_init(", f"    {name}_state *state,"]
    lines += [",\n".join(f"    {real} {field}" for field in fields) + ")", "{"]
    lines += [f"    if (!({(chr(10) + '          && ').join(tests)})) {{", "        return NAVSYM_DOMAIN;", "    }"]
    lines += [f"    state->{field} = {field};" for field in fields] + ["    return NAVSYM_OK;", "}", ""]
    lines += ["/* One step; the state changes only when the status is NAVSYM_OK. */"]
    arguments = "".join(f",\n    {real} {i.name}" for i in others)
    lines += [f"static inline navsym_status {name}_step(", f"    {name}_state *state{arguments})", "{"]
    lines += [f"    {real} r[{function.size}];", f"    const navsym_status status = {name}("]
    lines += [f"        {', '.join(calls)});"]
    lines += ["    if (status == NAVSYM_OK) {"]
    lines += [f"        state->{function.inputs[k].name} = r[{place}];" for k, place in function.state]
    return "\n".join([*lines, "    }", "    return status;", "}", "", "#endif", ""])


def range_tests(function: ExportedFunction, k: int, s: Spelling) -> list[str]:
    i, largest = function.inputs[k], "FLT_MAX" if function.arithmetic.name == "float" else "DBL_MAX"
    low = s.number(i.low) if math.isfinite(i.low) else f"-{largest}"
    high = s.number(i.high) if math.isfinite(i.high) else largest
    return [f"({i.name} >= {low}) && ({i.name} <= {high})"]


def output_places(function: ExportedFunction) -> list[int]:
    places, at = [], 0
    for output in function.outputs:
        places.append(at)
        at += output.size
    return places
