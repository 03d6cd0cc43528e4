"""The one form into which all languages are read: functions of assignments, branches, loops and calls.

A part knows the bytes of the source from which it came. Nothing is evaluated here.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from navsym.language.tree import Tree

#: Macros whose text is not known as an expression: it may write to anything, or leave the function.
NO_EXPRESSION, TWO_DEFINITIONS = "a macro that is no expression", "a macro with two definitions"
UNDEFINED = "a macro that is undefined again"
OTHER_NAME = "a pointer or reference of the file, which is another name of something"
HIDDEN_MACROS = (NO_EXPRESSION, TWO_DEFINITIONS, UNDEFINED, OTHER_NAME)
#: What a function of C gives that may be written to.
SECOND = "another name"


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A part of an expression or a statement.

    kind  : of a statement: declare (name, number, shape, value, shared) · assign (target, sign, value) · block (body) ·
            if (test, then, else) · for (name, start, stop, step, body) · loop (first, test, step, body, whether the
            test comes late) · moved (name, why, names), of a pointer · return (value) · do (call) · unread (why,
            names) · jump (why, names) · fail (why) · several (targets, call); of an expression: number (value,
            kind) · name (text) · index (base, indices) · call (name, arguments) · method (base, name, arguments) ·
            op (sign, a, b) · minus (a) · compare (sign, a, b) · both (a, b) · either (a, b) · not (a) · list (items) ·
            choose (test, a, b) · slice (start, stop) · first (a), which is ``*a`` · address (a) · cast (kind, a) ·
            refused (why)
    line  : of the source, from 1
    span  : first byte in the source, and the one behind the last
    """

    kind: str
    line: int
    parts: tuple[Any, ...]
    span: tuple[int, int] = (0, 0)


@dataclass(frozen=True, slots=True)
class Argument:
    """A parameter of a function.

    number : "real", or a type of integers
    shape  : its sizes, None where the source does not say
    shared : True when the caller sees what is written to it
    spare  : True where it has a value that a call may leave out
    """

    name: str
    number: str = "real"
    shape: tuple[Part, ...] | None = None
    shared: bool = False
    spare: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """A function as it is written.

    outputs : the names that MATLAB returns
    number  : what others return
    region  : the bytes of the source in which it is known, where it is not known in all of it
    extent  : its own bytes
    """

    name: str
    line: int
    arguments: tuple[Argument, ...]
    body: tuple[Part, ...]
    outputs: tuple[str, ...] = ()
    number: str = "auto"
    region: tuple[int, int] | None = None
    extent: tuple[int, int] = (0, 0)

    def takes(self, count: int) -> bool:
        """True where it may be called with so many arguments."""
        return sum(not argument.spare for argument in self.arguments) <= count <= len(self.arguments)


@dataclass(frozen=True, slots=True)
class Rules:
    """What a sign means in one language and not in the next.

    first    : the first index, 0 or 1
    integer  : True where the quotient of two integers is cut
    matrix   : True where ``*`` is the product of matrices
    entry    : how entries are written, with one index and with two
    root     : how a square root is written
    turned   : what is behind a transposed matrix, if the language has matrices
    """

    first: int = 0
    integer: bool = False
    matrix: bool = False
    entry: tuple[str, str] = ("{}[{}]", "{}[{}][{}]")
    root: str = "sqrt({})"
    turned: str = ""


RULES = {
    "c": Rules(integer=True),
    "cpp": Rules(integer=True, matrix=True, entry=("{}({})", "{}({}, {})"), turned=".transpose()"),
    "python": Rules(entry=("{}[{}]", "{}[{}, {}]"), root="np.sqrt({})", turned=".T"),
    "matlab": Rules(first=1, matrix=True, entry=("{}({})", "{}({},{})"), turned="'"),
    "rust": Rules(integer=True, matrix=True, root="{}.sqrt()", turned=".transpose()"),
}


@dataclass(slots=True, eq=False)
class Unit:
    """A source file in this form.

    functions : by name; several of one name are overloads
    constants : declarations of the file that never change, in their order
    macros    : name -> what an object-like macro stands for; a text says why it is refused
    ignored   : functions and macros that write nothing, as a mapping declares
    pieces    : first byte, lines before it and file of every further file that was read behind this one
    defined   : names that the preprocessor knows, as a mapping declares; None where it does not say
    members   : member of a structure -> what it holds and its sizes, where the file says so
    decimals  : decimal of the source -> the number for which it stands, as a mapping declares
    variables : names of C that are values, and no types
    overlaid : names of members of unions, which share their place with others
    types     : name of a type that the file defines -> what it stands for, in C
    kinds     : name of a variable of C -> the types with which it is declared
    imported  : what names of numpy and math are called in Python
    effects   : what functions may write, as far as it was asked
    regions   : name that is not known in all of the source -> the bytes in which it is
    taken     : types that are taken as real, with their first bytes and the names that they are given to
    virtual   : functions in whose place another one may stand -> why, where the file says so; else nothing
    """

    file: str
    language: str
    source: bytes
    functions: dict[str, list[Function]] = field(default_factory=dict)
    constants: list[Part] = field(default_factory=list)
    macros: dict[str, Part | str] = field(default_factory=dict)
    ignored: frozenset[str] = frozenset()
    pieces: tuple[tuple[int, int, str], ...] = ()
    defined: frozenset[str] | None = None
    members: dict[str, tuple[str, tuple[int, ...] | None]] = field(default_factory=dict)
    decimals: dict[Fraction, Tree] = field(default_factory=dict)
    variables: set[str] = field(default_factory=set)
    overlaid: set[str] = field(default_factory=set)
    kinds: dict[str, set[str]] = field(default_factory=dict)
    imported: dict[str, str] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    types: dict[str, str] = field(default_factory=dict)
    effects: dict[Function, Any] = field(default_factory=dict)
    regions: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    taken: list[tuple[str, int, str]] = field(default_factory=list)
    virtual: dict[str, str] = field(default_factory=dict)

    @property
    def rules(self) -> Rules:
        """What signs mean in its language."""
        return RULES[self.language]

    def is_array(self, name: str) -> bool:
        """True for a name before parentheses that holds entries; of others two calls may give two values."""
        return name.replace("->", ".") in self.declared or name in self.members

    def knows(self, name: str, part: Part) -> bool:
        """True for a name that is known at a part, and not only under conditions of the preprocessor."""
        return name not in self.regions or any(a <= part.span[0] < b for a, b in self.regions[name])

    def locate(self, line: int) -> tuple[str, int]:
        """The file of a line, and its number there."""
        for _, before, file in reversed(self.pieces):
            if line > before:
                return file, line - before
        return self.file, line

    def text(self, part: Part) -> str:
        """The source of a part."""
        return self.source[part.span[0] : part.span[1]].decode("utf-8", "replace")


def walk(*parts: Any) -> Iterator[Part]:
    """The parts, and all that is in them."""
    waiting = list(parts)
    while waiting:
        current = waiting.pop()
        if isinstance(current, Part):
            yield current
            waiting.extend(current.parts)
        elif isinstance(current, tuple):
            waiting.extend(current)


def sides_of(part: Part) -> list[Part]:
    """The parts directly in one, also those in a list."""
    return [p for x in part.parts for p in (x if isinstance(x, tuple) else (x,)) if isinstance(p, Part)]


def names_in(*parts: Any) -> set[str]:
    """The names that parts read or write."""
    return {inner.parts[0] for inner in walk(*parts) if inner.kind == "name"}


def called_in(*parts: Any) -> set[str]:
    """The names before parentheses: ``v`` of ``v(0)``."""
    return {inner.parts[0] for inner in walk(*parts) if inner.kind == "call"}


def mentioned_in(*parts: Any) -> set[str]:
    """The names that parts read, write or call."""
    return names_in(*parts) | called_in(*parts)


def head_of(name: str) -> str:
    """The structure to which a member belongs: ``s`` of ``s->a.b``."""
    return name.replace("->", ".").replace("[", ".").split(".")[0]


def spell_entry(unit: Unit, name: str, place: tuple[int, ...]) -> str:
    """An entry as the source writes it: ``F[0][1]``, ``F(0, 1)``."""
    if not place:
        return name
    numbers = [i + unit.rules.first for i in place]
    one, two = unit.rules.entry
    if len(numbers) < 3:
        return (one if len(numbers) == 1 else two).format(name, *numbers)
    return f"{name}[{', '.join(map(str, numbers))}]"


def spell_alike(unit: Unit, spelling: str) -> str:
    """An entry that a mapping writes in its own way, ``P[1, 2]``, as the source writes it."""
    name, _, rest = spelling.partition("[")
    if (found := re.fullmatch(r"\d+(?:(?:, *|\]\[)\d+)?\]", rest)) is None:
        return spelling
    return spell_entry(unit, name, tuple(int(n) - unit.rules.first for n in re.findall(r"\d+", found[0])))
