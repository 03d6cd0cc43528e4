"""The state around a step, in every language that has one: a structure with ``init`` and ``step``.

The functions themselves are pure; they read everything before they write, and write only when they succeed, so that a
refused measurement leaves the state as it was. The test programs run every step through its state.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from navsym.export.parts import Argument, ExportedFunction, Output, State


def state_of(function: ExportedFunction) -> State:
    """The state of a step, which has one."""
    assert function.state is not None, "only a step has a state"
    return function.state


def field_outputs(function: ExportedFunction) -> list[Output]:
    """The fields in order, with their shapes, as ``init`` makes them."""
    known = {o.name: o for o in state_of(function).init.outputs}
    return [known[name] for name, _ in state_of(function).fields]


def field_text(function: ExportedFunction, field: Output) -> str:
    """The entries of a field as the formulas name them, and its unit."""
    given = next((a for a in function.called_with if a.name == field.name), None)
    entries = function.inputs[given.first : given.first + (given.size or 1)] if given else ()
    names = ", ".join(i.symbol.name for i in entries) or "stays as it was made"
    return f"{names} [{field.unit or 'unit not stated'}]".replace("*/", "* /")


def others(function: ExportedFunction) -> list[Argument]:
    """Arguments of the step that are no fields."""
    kept = {name for name, _ in state_of(function).fields}
    return [a for a in function.called_with if a.name not in kept]


def extras(function: ExportedFunction) -> list[Output]:
    """Results of the step that replace no field."""
    replaced = {new for _, new in state_of(function).fields}
    return [o for o in function.outputs if o.name not in replaced]


def output_places(function: ExportedFunction) -> list[int]:
    """Where each output begins among all results."""
    places, at = [], 0
    for output in function.outputs:
        places.append(at)
        at += output.size
    return places


# -- C ---------------------------------------


def c_header(function: ExportedFunction, license_: str) -> str:
    """``PROGRAM.h``: the state, ``PROGRAM_init`` and ``PROGRAM_step``; nothing static mutable."""
    state, real = state_of(function), function.arithmetic.name
    name, start = state.program, state.init
    guard = f"NAVSYM_{name.upper()}_PROGRAM_H"
    lines = [f"/* {license_} */", f"#ifndef {guard}", f"#define {guard}", ""]
    lines += [f'#include "{start.name}.h"', f'#include "{function.name}.h"', ""]
    lines += [f"/* {function.sources[0].title}: what is kept between two steps. */", "typedef struct {"]
    lines += [
        f"    {real} {o.name}{f'[{o.size}]' if o.shape else ''}; /* {field_text(function, o)} */"
        for o in field_outputs(function)
    ]
    lines += [f"}} {name}_state;", "", "/* Makes the first state; when refused, the state stays as it was. */"]
    given = "".join(f",\n    {c_parameter(a, real)}" for a in start.called_with)
    lines += [f"static inline navsym_status {name}_init(", f"    {name}_state *state{given})", "{"]
    fields = [f"{'' if o.shape else '&'}state->{o.name}" for o in start.outputs]
    lines += [f"    return {start.name}({', '.join([*(a.name for a in start.called_with), *fields])});", "}", ""]
    lines += ["/* One step; when refused, the state stays as it was. */"]
    given = "".join(f",\n    {c_parameter(a, real)}" for a in others(function))
    given += "".join(f",\n    {real} {f'{o.name}[{o.size}]' if o.shape else f'*{o.name}'}" for o in extras(function))
    lines += [f"static inline navsym_status {name}_step(", f"    {name}_state *state{given})", "{"]
    lines += [f"    return {function.name}({', '.join(c_step_words(function))});", "}", "", "#endif", ""]
    return "\n".join(lines)


def c_parameter(argument: Argument, real: str) -> str:
    """An argument of a C function: a number, or a constant array."""
    return f"const {real} {argument.name}[{argument.size}]" if argument.size else f"{real} {argument.name}"


def c_step_words(function: ExportedFunction) -> list[str]:
    """What the wrapper hands to the pure step: fields from the state and back into it."""
    fields = dict(state_of(function).fields)
    back = {new: old for old, new in fields.items() if new}
    words = [f"state->{a.name}" if a.name in fields else a.name for a in function.called_with]
    for o in function.outputs:
        place = f"state->{back[o.name]}" if o.name in back else o.name
        words.append(f"&{place}" if o.name in back and not o.shape else place)
    return words


def c_through_state(function: ExportedFunction) -> list[str]:
    """For the test program: a call of the step with loose arguments that goes through the state."""
    if function.state is None:
        return []
    real, state = function.arithmetic.name, function.state
    fields = dict(state.fields)
    known = {a.name: a for a in function.called_with}
    outs = [f"{real} {o.name}[{o.size}]" if o.shape else f"{real} *{o.name}" for o in function.outputs]
    given = ", ".join([*(c_parameter(a, real) for a in function.called_with), *outs])
    lines = [f"static navsym_status through_{function.name}({given})", "{", f"    {state.program}_state nv_s;"]
    lines += ["    int nv_k;"] if any(o.shape for o in field_outputs(function)) else []
    for o in field_outputs(function):
        zero = "0.0f" if real == "float" else "0.0"
        source = zero if o.name not in known else f"{o.name}[nv_k]" if o.shape else o.name
        loop = f"for (nv_k = 0; nv_k < {o.size}; nv_k++) {{ nv_s.{o.name}[nv_k] = {source}; }}"
        lines.append(f"    {loop}" if o.shape else f"    nv_s.{o.name} = {source};")
    words = ["&nv_s", *(a.name for a in others(function)), *(o.name for o in extras(function))]
    lines += ["    {", f"        const navsym_status nv_status = {state.program}_step({', '.join(words)});"]
    lines += ["        if (nv_status == NAVSYM_OK) {"]
    for old, new in fields.items():
        size = known[old].size if old in known else 0
        loop = f"for (nv_k = 0; nv_k < {size}; nv_k++) {{ {new}[nv_k] = nv_s.{old}[nv_k]; }}"
        lines += [] if not new else [f"            {loop}" if size else f"            *{new} = nv_s.{old};"]
    return ["\n".join([*lines, "        }", "        return nv_status;", "    }", "}", ""])]


# -- C++ ---------------------------------------


def cpp_program(function: ExportedFunction) -> list[str]:
    """A structure with members ``init`` and ``step``."""
    if function.state is None:
        return []
    real, state, start = function.arithmetic.name, function.state, function.state.init
    lines = ["/** State of the program; a refused call leaves it as it was. */", f"struct {state.program} {{"]
    for o in field_outputs(function):
        lines.append(f"    std::array<{real}, {o.size}> {o.name}{{}};" if o.shape else f"    {real} {o.name} = 0;")
    lines += ["", f"    Status init({cpp_parameters(start.called_with, real)}) noexcept", "    {"]
    lines += [f"        const auto made = {start.name}({', '.join(a.name for a in start.called_with)});"]
    lines += ["        if (made.status == Status::ok) {"]
    lines += [f"            this->{o.name} = made.{o.name};" for o in start.outputs]
    lines += ["        }", "        return made.status;", "    }", ""]
    lines += [f"    {function.name}_result step({cpp_parameters(others(function), real)}) noexcept", "    {"]
    kept = dict(state.fields)
    words = [f"this->{a.name}" if a.name in kept else a.name for a in function.called_with]
    lines += [f"        const auto made = {function.name}({', '.join(words)});"]
    lines += ["        if (made.status == Status::ok) {"]
    lines += [f"            this->{old} = made.{new};" for old, new in kept.items() if new]
    return ["\n".join([*lines, "        }", "        return made;", "    }", "};", ""])]


def cpp_parameters(arguments: Sequence[Argument], real: str) -> str:
    """Arguments of a C++ function: numbers, or references to constant std::arrays."""
    return ", ".join(
        f"const std::array<{real}, {a.size}>& {a.name}" if a.size else f"{real} {a.name}" for a in arguments
    )


def cpp_through_state(function: ExportedFunction, real: str) -> str:
    """For the test program: fill the state from a row, step, and take the fields as results."""
    n, state = len(function.inputs), state_of(function)
    fields = dict(state.fields)
    lines, words = [f"        navsym::{state.program} s;"], []
    for a in function.called_with:
        entries = [f"in[(k * {n}) + {a.first + e}]" for e in range(a.size or 1)]
        value = f"{{{', '.join(entries)}}}" if a.size else entries[0]
        if a.name in fields:
            lines.append(f"        s.{a.name} = {value};")
        else:
            words.append(f"std::array<{real}, {a.size}>{value}" if a.size else value)
    return "\n".join([*lines, f"        const auto result = s.step({', '.join(words)});"])


def through_accessors(function: ExportedFunction) -> list[str]:
    """Where a test finds every result: in the fields it replaces, else in the structure that came back."""
    back = {new: old for old, new in function.state.fields if new} if function.state else {}
    return [
        (f"s.{back[o.name]}" if o.name in back else f"result.{o.name}") + (f"[{e}]" if o.shape else "")
        for o in function.outputs
        for e in range(o.size)
    ]


# -- Rust ---------------------------------------


def rust_program(function: ExportedFunction, kind: str) -> list[str]:
    """A structure with ``init`` and ``step``."""
    if function.state is None:
        return []
    state, start = function.state, function.state.init
    lines = ["/// State of the program; a refused step leaves it as it was.", "#[derive(Clone, Copy, Debug)]"]
    lines += [f"pub struct {state.program} {{"]
    lines += [f"    pub {o.name}: {f'[{kind}; {o.size}]' if o.shape else kind}," for o in field_outputs(function)]
    given = ", ".join(rust_parameter(a, kind) for a in start.called_with)
    lines += ["}", "", f"impl {state.program} {{", f"    pub fn init({given}) -> Result<Self, Status> {{"]
    lines += [f"        let made = {start.name}({', '.join(a.name for a in start.called_with)})?;"]
    entries = ", ".join(f"{o.name}: made.{o.name}" for o in start.outputs)
    lines += [f"        Ok(Self {{ {entries} }})", "    }", ""]
    given = "".join(f", {rust_parameter(a, kind)}" for a in others(function))
    lines += [f"    pub fn step(&mut self{given}) -> Result<{function.name}_result, Status> {{"]
    kept = dict(state.fields)
    words = [f"{'&' if a.size else ''}self.{a.name}" if a.name in kept else a.name for a in function.called_with]
    lines += [f"        let made = {function.name}({', '.join(words)})?;"]
    lines += [f"        self.{old} = made.{new};" for old, new in kept.items() if new]
    return ["\n".join([*lines, "        Ok(made)", "    }", "}", ""])]


def rust_parameter(argument: Argument, kind: str) -> str:
    """An argument of a Rust function: a number, or a reference to an array."""
    return f"{argument.name}: &[{kind}; {argument.size}]" if argument.size else f"{argument.name}: {kind}"


def rust_through_state(function: ExportedFunction) -> str:
    """For the test program: a block that fills the state, steps, and gives back results and state."""
    n, state = len(function.inputs), state_of(function)
    known, made, words = {a.name: a for a in function.called_with}, [], []
    for o in field_outputs(function):
        a = known.get(o.name)
        entries = [f"input[k * {n} + {a.first + e}]" if a else "0.0" for e in range(o.size)]
        made.append(f"{o.name}: [{', '.join(entries)}]" if o.shape else f"{o.name}: {entries[0]}")
    for a in others(function):
        entries = [f"input[k * {n} + {a.first + e}]" for e in range(a.size or 1)]
        words.append(f"&[{', '.join(entries)}]" if a.size else entries[0])
    step = f"s.step({', '.join(words)})"
    return f"{{ let mut s = {state.program} {{ {', '.join(made)} }}; {step}.map(|result| (result, s)) }}"


# -- JavaScript and Python ---------------------------------------


def js_program(function: ExportedFunction) -> list[str]:
    """A class with ``init`` and ``step``; both return the status."""
    if function.state is None:
        return []
    state, start = function.state, function.state.init
    kept = dict(state.fields)
    words = [f"this.{a.name}" if a.name in kept else a.name for a in function.called_with]
    lines = ["/** State of the program; a refused call leaves it as it was. */", f"export class {state.program} {{"]
    lines += [f"  init({', '.join(a.name for a in start.called_with)}) {{"]
    lines += [f"    const {{ status, ...fields }} = {start.name}({', '.join(a.name for a in start.called_with)});"]
    lines += ["    if (status === 0) { Object.assign(this, fields); }", "    return { status };", "  }", ""]
    lines += [f"  step({', '.join(a.name for a in others(function))}) {{"]
    lines += [f"    const made = {function.name}({', '.join(words)});", "    if (made.status === 0) {"]
    lines += [f"      this.{old} = made.{new};" for old, new in kept.items() if new]
    return ["\n".join([*lines, "    }", "    return made;", "  }", "}", ""])]


def python_program(function: ExportedFunction) -> list[str]:
    """A class: ``__init__`` makes the first state, ``step`` moves it and returns the results of the step."""
    if function.state is None:
        return []
    state, start = function.state, function.state.init
    kept = dict(state.fields)
    words = [f"self.{a.name}" if a.name in kept else a.name for a in function.called_with]
    given = ", ".join(a.name for a in start.called_with)
    fields = ", ".join(f"self.{o.name}" for o in start.outputs)
    lines = [f"class {state.program}:", '    """State of the program; a refused call leaves it as it was."""', ""]
    lines += [f"    def __init__(self, {given}):", f"        {fields} = {start.name}({given})", ""]
    lines += [f"    def step(self, {', '.join(a.name for a in others(function))}):"]
    lines += [f"        results = {function.name}({', '.join(words)})"]
    back = {new: old for old, new in kept.items() if new}
    many = len(function.outputs) > 1
    for k, o in enumerate(function.outputs):
        lines += [f"        self.{back[o.name]} = results{f'[{k}]' if many else ''}"] if o.name in back else []
    return ["\n".join([*lines, "        return results", ""])]


# -- Octave and MATLAB ---------------------------------------


def octave_program(function: ExportedFunction, names: Mapping[str, str], license_: str) -> dict[str, str]:
    """``PROGRAM_init.m`` and ``PROGRAM_step.m``: a structure goes in and comes back, changed when the status is 0."""
    if function.state is None:
        return {}
    state, start = function.state, function.state.init
    fields = [f"state.{o.name}" for o in start.outputs]
    given = ", ".join(a.name for a in start.called_with)
    init = [f"function [status, state] = {state.program}_init({given})", f"  % {license_}"]
    init += ["  % Makes the first state; every field is NaN unless the status is 0.", "  state = struct();"]
    init += [f"  [{', '.join(['status', *fields])}] = {names[start.name]}({given});", "end", ""]
    kept = dict(state.fields)
    back = {new: old for old, new in kept.items() if new}
    left = [o.name for o in extras(function)]
    words = [f"state.{a.name}" if a.name in kept else a.name for a in function.called_with]
    given = ", ".join(["state", *(a.name for a in others(function))])
    step = [f"function [{', '.join(['status', 'state', *left])}] = {state.program}_step({given})", f"  % {license_}"]
    step += ["  % One step; when refused, the state stays as it was."]
    step += [f"  % state.{o.name}: {field_text(function, o)}" for o in field_outputs(function)]
    made = ", ".join(["status", *(o.name for o in function.outputs)])
    step += [f"  [{made}] = {names[function.name]}({', '.join(words)});", "  if status == 0"]
    step += [f"    state.{old} = {new};" for new, old in back.items()] + ["  end", "end", ""]
    return {f"{state.program}_init.m": "\n".join(init), f"{state.program}_step.m": "\n".join(step)}


def octave_through_state(function: ExportedFunction, name: str, results: str) -> str:
    """For the test: the step with loose arguments, through the state; a refused step must leave the state."""
    state, known = state_of(function), {a.name for a in function.called_with}
    back = {new: old for old, new in state.fields if new}
    lines = ["", f"function {results} = navsym_through_{name}({', '.join(a.name for a in function.called_with)})"]
    lines += [f"  before.{o.name} = {o.name if o.name in known else '0'};" for o in field_outputs(function)]
    left = ", ".join(["status", "after", *(o.name for o in extras(function))])
    given = ", ".join(["before", *(a.name for a in others(function))])
    lines += [f"  [{left}] = {state.program}_step({given});"]
    lines += [f"  {o.name} = after.{back[o.name]};" for o in function.outputs if o.name in back]
    lines += ["  if status ~= 0 && isequaln(before, after)"]
    lines += [f"    {o.name} = NaN;" for o in function.outputs if o.name in back]
    return "\n".join([*lines, "  end", "end", ""])


def calls_table(functions: Sequence[ExportedFunction], python: bool = False) -> str:
    """How the rows of vectors become calls, as a literal of JSON or of Python."""
    table = {
        f.name: {"arguments": [[a.first, a.size] for a in f.called_with], "state": state_record(f)} for f in functions
    }
    return repr(table) if python else json.dumps(table)


def state_record(function: ExportedFunction) -> dict[str, Any] | None:
    """The state as plain data: program, fields with the argument and the output of each, outputs of the step."""
    if function.state is None:
        return None
    places = {a.name: k for k, a in enumerate(function.called_with)}
    fields = [{"name": old, "argument": places.get(old, -1), "output": new} for old, new in function.state.fields]
    outputs = [o.name for o in function.outputs]
    return {"program": function.state.program, "fields": fields, "outputs": outputs}
