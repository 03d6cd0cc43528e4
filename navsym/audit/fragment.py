"""Some lines of a function, read by themselves: what they read and do not assign is an input."""

from __future__ import annotations

from dataclasses import replace

from navsym.audit.form import Argument, Function, Part, Unit, called_in, names_in, walk
from navsym.core.errors import DomainError

Body = tuple[Part, ...]


def take_lines(unit: Unit, function: Function, first: int, last: int, where: str) -> Function:
    """The statements between two lines as a function; raises DomainError where the lines cut a statement.

    Names that are declared before keep their numbers and sizes, references what they stand for. A pointer that is set
    again is no number any more, so that what depends on it stays unread.
    """
    body, before = function.body, list[Part]()
    while True:
        near = [s for s in body if s.line <= last and last_line(unit, s) >= first]
        if near and all(first <= s.line and last_line(unit, s) <= last for s in near):
            break
        blocks = [part for s in near if len(near) == 1 for part in s.parts if isinstance(part, tuple)]
        inner = [b for b in blocks if isinstance((*b, 0)[0], Part) and covers(unit, b, first, last)]
        if len(inner) != 1:
            got = "half of one" if near else "none"
            message = f"expected whole statements of one block of {function.name} in lines {first} to {last}; got {got}"
            raise DomainError(f"{message}; correct the lines", where=where)
        before += [s for s in body if s.line < near[0].line] + near
        body = inner[0]
    before += [s for s in body if s.line < near[0].line]
    before = [inner for s in before for inner in ((s, *s.parts[0]) if s.kind == "loop" else (s,))]
    declared = {s.parts[0]: s for s in before if s.kind in ("declare", "for")}
    reseated = {s.parts[0].parts[0] for s in walk(*function.body) if s.kind == "assign" and s.parts[0].kind == "name"}
    links = [s for s in declared.values() if is_link(s) and s.parts[0] not in reseated]
    arguments = {argument.name: argument for argument in function.arguments}
    for name, statement in declared.items():
        if statement not in links:
            arguments[name] = argument_of(statement)
    used = names_in(*near, *links) | called_in(*near, *links)
    kept = tuple(replace(a, shared=True) for a in arguments.values() if a.name in used)
    return Function(function.name, near[0].line, kept, (*links, *near))


def last_line(unit: Unit, statement: Part) -> int:
    """The line in which a statement ends; ``elif`` ends before its ``else``."""
    end = max(part.span[1] for part in walk(statement))
    return 1 + unit.source.count(b"\n", 0, max(end - 1, 0))


def covers(unit: Unit, body: Body, first: int, last: int) -> bool:
    """True for a block with a statement in these lines."""
    return any(s.line <= last and last_line(unit, s) >= first for s in body)


def is_link(statement: Part) -> bool:
    """True for the declaration of a reference or pointer."""
    return statement.kind == "declare" and bool(statement.parts[4])


def argument_of(statement: Part) -> Argument:
    """A name that was declared before the lines, as an input."""
    if statement.kind == "for":
        return Argument(statement.parts[0], "int", ())
    name, number, shape, value, is_pointer = statement.parts
    if is_pointer or number == "matrix":
        return Argument(name, "other", () if is_pointer else shape)
    is_number = number == "real" and shape is None and (value is None or value.kind == "number")
    return Argument(name, number, shape if shape is not None or not is_number else ())
