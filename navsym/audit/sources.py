"""The code that questions are about: a file, a function, and what its inputs are."""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

from flint import ctx, fmpq

from navsym.audit.cases import Reading
from navsym.audit.evaluate import Edits
from navsym.audit.execute import read_function
from navsym.audit.form import Argument, Function, Part, Unit, called_in, mentioned_in, names_in, spell_entry, walk
from navsym.audit.functions import CONSTANTS
from navsym.audit.names import Names, squeeze
from navsym.audit.syntax import SIZE, read_decimal
from navsym.audit.values import Array, Index, Scalar, places_of, relate_rotation
from navsym.core.choice import one_of
from navsym.core.errors import DomainError, DuplicateError, ExpressionSyntaxError, ShapeError, UnknownSymbolError
from navsym.core.units import read_unit as check_unit
from navsym.language.expression import read_tree
from navsym.language.files import decode, name_file, read_bytes
from navsym.language.names import expect_keys, join_place, quote, suggest_nearest
from navsym.language.printer import print_tree
from navsym.language.schema import Table, as_list, as_table, as_text, require_key
from navsym.language.shapes import NOTES
from navsym.language.tree import NUMBER, ONE, POWER, PRODUCT, SUM, ZERO, Tree, build_number, build_sum, negate
from navsym.prove.rooms.goals import player

LANGUAGES = {".c": "c", ".h": "c", ".py": "python", ".m": "matlab", ".rs": "rust"}
LANGUAGES |= dict.fromkeys((".cpp", ".cc", ".cxx", ".hpp", ".hh", ".ino"), "cpp")
LARGEST_SIDE = 64
BITS = 256  # at which a decimal is compared with what it stands for
#: The keys of a block ``[[code]]``.
KEYS = (
    "name", "file", "function", "lines", "also", "defined", "relations", "approximations", "symbols", "constants",
    "functions", "ignored", "language", "distinct",
)  # fmt: skip


@dataclass(slots=True, eq=False)
class Source:
    """A function of a file with the declarations of its inputs.

    shapes    : sizes of inputs that are arrays
    symmetric : names of matrices whose lower half is the upper one
    relations : polynomials of the inputs that are zero
    starts    : spelling of an entry -> the number that it holds at the beginning
    approximations : what may be put for what in the sense of that name
    distinct : parameters that share no memory with anything else
    """

    name: str
    unit: Unit
    function: Function
    names: Names
    shapes: Mapping[str, Index]
    symmetric: frozenset[str]
    relations: tuple[Tree, ...]
    reading: Reading | None = None
    mirrored: dict[str, str] | None = None
    starts: Mapping[str, Tree] = field(default_factory=dict)
    approximations: tuple[tuple[Tree, Tree], ...] = ()
    distinct: frozenset[str] = frozenset()

    def assumptions(self) -> list[str]:
        """What is taken for granted of the code, and neither the file nor the mapping says."""
        reading, unit = self.read(), self.unit
        names = {name.split(".")[-1] for f in reading.functions for name in names_in(*f.body)}
        extents = [f.extent for f in reading.functions]

        def is_near(at: int, name: str) -> bool:
            return name.split(".")[-1] in names or any(a <= at < b for a, b in extents)

        apart = {name for pair in reading.apart if not pair & self.distinct for name in pair}
        scalars = reading.scalars - {self.names.spellings.get(n, n) for n in self.names.declared}
        real = {word for word, at, name in unit.taken if is_near(at, name)}
        several = {"taken as real: ": real, "sizes: scalar: ": scalars, "apart in memory: ": apart}
        several["not overridden: "] = reading.kept
        return [head + ", ".join(sorted(words)) for head, words in several.items() if words]

    def symbol(self, spelling: str) -> Tree:
        """The symbol of an input; of a symmetric matrix that of the upper half."""
        if self.mirrored is None:
            lower = ((name, i, j) for name in self.symmetric for i, j in places_of(self.shapes[name]) if i > j)
            unit = self.unit
            self.mirrored = {spell_entry(unit, n, (i, j)): spell_entry(unit, n, (j, i)) for n, i, j in lower}
        return self.starts.get(spelling) or self.names.symbol(self.mirrored.get(spelling, spelling))

    def read(self, edits: Edits | None = None) -> Reading:
        """The function, read once; with edits it is read again."""
        if edits:
            return read_function(self.unit, self.function, self.symbol, self.shapes, edits, self.reading)
        if self.reading is None:
            self.reading = read_function(self.unit, self.function, self.symbol, self.shapes)
        return self.reading

    def inputs(self, reference: str, where: str) -> list[Tree]:
        """The symbols that a reference to an input means: one, or all of an array."""
        key = "".join(reference.split())
        argument = next((a for a in self.function.arguments if a.name == key), None)
        if (shape := self.shapes.get(key)) is None and argument is not None and argument.shape is not None:
            sizes = [int(size.parts[0]) for size in argument.shape if size.kind == "number"]
            shape = tuple(sizes) if len(sizes) == len(argument.shape) else None
        if shape:
            return [self.symbol(spell_entry(self.unit, key, place)) for place in places_of(shape)]
        if key not in self.names.symbols and key not in self.names.inputs:
            message = f"expected an input that {self.function.name} reads; got {quote(reference)}; correct it: "
            raise UnknownSymbolError(message + suggest_nearest(reference, self.names.symbols), where=where)
        return [self.names.symbol(reference)]


def load_unit(
    path: str | os.PathLike[str],
    language: str | None = None,
    also: Sequence[Path] = (),
    defined: frozenset[str] | None = None,
) -> Unit:
    """A source file in the one form; its language follows from the end of its name where none is given.

    also    : further files of the language, whose functions and constants it uses
    defined : names that the preprocessor of C knows; None reads both ways of an ``#ifdef``

    Raises NavsymError of kind ``missing-file``, ``syntax``, ``too-large`` or ``missing`` (no grammar on this machine).
    """
    where, language = name_file(path), language or LANGUAGES.get(Path(path).suffix.lower())
    if language is None:
        message = f"expected a source that ends in {' '.join(LANGUAGES)}; got {quote(Path(path).name)}; rename it"
        raise ExpressionSyntaxError(message, where=where)
    data, pieces = b"", list[tuple[int, int, str]]()
    for file in (Path(path), *also):  # one text, so that each part has a place of its own
        text = read_bytes(file, SIZE).removeprefix(b"\xef\xbb\xbf")
        decode(text, name_file(file))
        pieces.append((len(data), data.count(b"\n"), name_file(file)))
        data += text + b"\n" * bool(also)
    unit = read_unit(data, where, language, defined)
    unit.pieces = tuple(pieces[1:])
    return unit


def read_unit(data: bytes, where: str, language: str, defined: frozenset[str] | None) -> Unit:
    """A source in the one form."""
    unit = Unit(where, language, data, defined=defined)
    reader = load_reader(language)(unit)
    reader.read_file(reader.parse(data))
    bodies = (f.body for several in unit.functions.values() for f in several) if language == "cpp" else ()
    for part in walk(*bodies):
        if part.kind == "assign":  # to an entry of a member, M(0, 1) = x or s.v(0) = x
            target, (base, *name) = part.parts[0], part.parts[0].parts
            of_member = {f"{base.parts[0]}.{name[0]}"} if target.kind == "method" and base.kind == "name" else set()
            unit.declared |= {n.replace("->", ".") for n in called_in(target) | of_member}
    return unit


def read_expression(text: str, unit: Unit) -> Part:
    """One expression in the language of a source."""
    part: Part = load_reader(unit.language).read_text(text, unit)
    return part


def load_reader(language: str) -> Any:
    """The reader of a language, whose grammar is loaded when it is first needed."""
    return importlib.import_module(f"navsym.audit.{'c' if language == 'cpp' else language}_source").Reader


def find_function(unit: Unit, name: str, where: str, line: int | None = None) -> Function:
    """The function of a name, the last before a line; raises UnknownSymbolError, or DomainError for several."""
    candidates = unit.functions.get(name, [])
    if line is not None:
        candidates = sorted((f for f in candidates if f.line <= line), key=lambda f: f.line)[-1:]
    if not candidates:
        known = ", ".join([*unit.functions][:12]) or "none"
        message = f"expected a function of {Path(unit.file).name} ({known}); got {quote(name)}; correct the name"
        raise UnknownSymbolError(message, where=where)
    if len(candidates) > 1:
        lines = ", ".join(str(f.line) for f in candidates)
        message = f"expected one function {name}; got several, at lines {lines}; rename the one that is asked for"
        raise DomainError(message, where=where)
    return candidates[0]


def read_source(block: Any, folder: Path, names: Names, where: str, line: int | None = None) -> Source:
    """One ``[[code]]`` block; a line tells several functions of one name apart."""
    table = as_table(block, where)
    expect_keys(table, KEYS, where)
    given = ((key, require_key(table, key, where)) for key in ("name", "file", "function"))
    name, file, asked = (as_text(value, join_place(where, key), "a name") for key, value in given)
    if (language := table.get("language")) is not None:
        one_of(as_text(language, join_place(where, "language"), "a language"), LANGUAGES.values(), where)
    also, defined, ignored = (read_names(table, key, where) for key in ("also", "defined", "ignored"))
    known = None if defined is None else frozenset(defined)
    unit = load_unit(folder / file, language, [folder / other for other in also or ()], known)
    keys = ("constants", "functions", "symbols")
    constants, functions, symbols = (as_table(table.get(key, {}), join_place(where, key)) for key in keys)
    declare_constants(unit, constants, where)
    declare_functions(unit, functions, where)
    unit.ignored = frozenset(ignored or ())
    lines = read_lines(table["lines"], join_place(where, "lines")) if "lines" in table else None
    whole = function = find_function(unit, asked, join_place(where, "function"), lines[0] if lines else line)
    if lines is not None:
        function = take_lines(unit, function, *lines, join_place(where, "lines"))
        own = tuple(a for a in function.arguments if a.name not in constants)  # as the counter of a loop around them
        function = replace(function, arguments=own)
    place = join_place(where, "symbols")
    unit.declared |= {squeeze(spelling).partition("[")[0].replace("->", ".") for spelling in symbols}
    shapes, symmetric = read_symbols(symbols, names, place)
    starts = {
        spell_entry(unit, spelling, p): ONE if len({*p}) == 1 and declaration["start"] == "identity" else ZERO
        for spelling, declaration in symbols.items()
        if isinstance(declaration, dict) and read_start(declaration, join_place(place, spelling))
        for p in places_of(shapes[spelling])
    }
    distinct = frozenset(read_names(table, "distinct", where) or ())
    source = Source(name, unit, function, names, shapes, symmetric, (), starts=starts, distinct=distinct)
    names.inputs |= list_inputs(source, whole)
    relations, approximations = (read_equations(table, key, names, where) for key in ("relations", "approximations"))
    source.relations = tuple(build_sum(left, negate(right)) for left, right in relations)
    for spelling in [s for s, declaration in symbols.items() if is_rotation(declaration, join_place(place, s))]:
        cells = tuple(Scalar(source.symbol(spell_entry(unit, spelling, p))) for p in places_of((3, 3)))
        names.rotations[spelling] = tuple(cell.tree.args[0] for cell in cells)
        source.relations += relate_rotation(Array((3, 3), cells))
    for left, right in approximations:
        if left.head in (NUMBER, SUM, PRODUCT, POWER, "pi") or left is right:
            message = "expected a name or a function on the left; got something else; write sin(a) = a, or w1 = w0"
            raise DomainError(message, where=join_place(where, "approximations"))
    source.approximations = tuple(approximations)
    return source


def is_rotation(declaration: Any, where: str) -> bool:
    """True for an input that is declared as a rotation matrix; raises ShapeError for another size."""
    given = declaration.get("rotation", False) if isinstance(declaration, dict) else False
    if given is not False and (given is not True or declaration.get("matrix") != [3, 3]):
        raise ShapeError("expected matrix = [3, 3] and rotation = true; got something else; correct it", where=where)
    return bool(given)


def read_names(table: Table, key: str, where: str) -> list[str] | None:
    """A list of names, which may be empty; None where the key is not there."""
    place, names = join_place(where, key), table.get(key)
    return names if names in (None, []) else [as_text(name, place, "a name") for name in as_list(names, place)]


def list_inputs(source: Source, whole: Function) -> set[str]:
    """The names of inputs, whether the code reads them or not: a wrong version may have forgotten one."""
    cases, unit = source.read().cases, source.unit
    variables = [v for case in cases for v in case.variables.values()]
    own = {v.name for v in variables if not v.is_input} | {*unit.macros, *unit.functions}
    own |= {constant.parts[0] for constant in unit.constants if constant.kind == "declare"}
    named = {argument.name for argument in whole.arguments} | {*source.shapes} | (names_in(*whole.body) - {*CONSTANTS})
    return {v.name for v in variables if v.is_input} | (named - own)


def read_lines(value: Any, where: str) -> tuple[int, int]:
    """The first and the last line."""
    is_pair = isinstance(value, list) and len(value) == 2 and all(type(n) is int for n in value)
    if not is_pair or not 0 < value[0] <= value[1]:
        message = f"expected the first and the last line, [12, 30]; got {quote(value)}; correct them"
        raise ShapeError(message, where=where)
    return value[0], value[1]


def declare_constants(unit: Unit, table: Table, where: str) -> None:
    """Names whose values stand in files that are not read, such as headers; and decimals that stand for others."""
    for name, value in table.items():
        place = join_place(join_place(where, "constants"), name)
        if (decimal := read_decimal(name)) is not None:
            unit.decimals[decimal] = read_meaning(name, decimal, value, place)
            continue
        exact = read_decimal(str(value).removeprefix("-")) if not isinstance(value, bool) else None
        if exact is None:
            raise ExpressionSyntaxError(f"expected a number; got {quote(value)}; correct it", where=place)
        kind = "int" if isinstance(value, int) else "real"
        number = Part("number", 0, (-exact if str(value).startswith("-") else exact, kind))
        unit.constants.append(Part("declare", 0, (name, kind, (), number, False)))


def read_meaning(text: str, decimal: Fraction, value: Any, where: str) -> Tree:
    """The number for which a decimal of the source stands, ``pi/180``; it must be the same but for its last digit."""
    tree = read_tree(as_text(value, where, "an expression of numbers"), {}, where=where)
    apart = build_sum(tree, negate(build_number(decimal)))
    with ctx.workprec(BITS):
        ball, last = player.value_of(player.parse(print_tree(apart)), {}), Decimal(text).as_tuple().exponent
    if not abs(ball) <= 2 * fmpq(10) ** int(last):  # a double has no digit more
        message = f"expected an expression that is {text} to its last digit; got {quote(value)}; correct it"
        raise DomainError(message, where=where)
    return tree


def declare_functions(unit: Unit, table: Table, where: str) -> None:
    """Functions that stand in other files, each as ``{ of = ["x"], is = "x*x" }`` in the language of the source."""
    for name, value in table.items():
        place = join_place(join_place(where, "functions"), name)
        entry = as_table(value, place)
        expect_keys(entry, ("of", "is", "replace"), place)
        if name in unit.functions and entry.get("replace") is not True:
            message = f"expected a function of another file; got {name} of this one; remove it, or write replace = true"
            raise DuplicateError(message, where=place)
        names = [as_text(n, place, "a name") for n in as_list(require_key(entry, "of", place), place)]
        meaning = read_expression(as_text(require_key(entry, "is", place), place, "an expression"), unit)
        if meaning.kind == "refused":
            raise ExpressionSyntaxError(f"expected an expression; got {quote(entry['is'])}; correct it", where=place)
        body = (Part("return", 0, (meaning,)),)
        arguments = tuple(Argument(n, "real") for n in names)
        unit.functions[name] = [Function(name, 0, arguments, body, number="other")]  # a value, computed at once


def read_symbols(table: Table, names: Names, where: str) -> tuple[dict[str, Index], frozenset[str]]:
    """Declared inputs: numbers go to the table of names, sizes of arrays come back."""
    shapes, symmetric = {}, set()
    for spelling, declaration in table.items():
        place = join_place(where, spelling)
        for note, said in (("unit", names.units), ("frame", names.frames)):
            if isinstance(declaration, dict) and note in declaration:
                said[squeeze(spelling)] = text = as_text(declaration[note], join_place(place, note), f"a {note}")
                if note == "unit":
                    check_unit(text, join_place(place, note))
        sizes = declaration.get("matrix", declaration.get("vector")) if isinstance(declaration, dict) else None
        if sizes is None:
            if isinstance(declaration, dict):
                expect_keys(declaration, ("name", "range", "sign", *NOTES), place)
            names.declare(spelling, declaration, place)
            continue
        expect_keys(declaration, ("matrix", "vector", "symmetric", "start", "rotation", *NOTES), place)
        given = sizes if isinstance(sizes, list) else [sizes]
        if not all(isinstance(n, int) and not isinstance(n, bool) and 0 < n <= LARGEST_SIDE for n in given):
            message = f"expected sizes from 1 to {LARGEST_SIDE}, such as [3, 3]; got {quote(sizes)}; correct them"
            raise ShapeError(message, where=place)
        shapes[spelling] = tuple(given)
        if declaration.get("symmetric") is True:
            if len(given) != 2 or given[0] != given[1]:
                raise ShapeError(f"expected a square matrix; got {quote(sizes)}; remove symmetric", where=place)
            symmetric.add(spelling)
    return shapes, frozenset(symmetric)


def read_start(declaration: Table, where: str) -> bool:
    """True for an array that holds zeros or the identity at the beginning, as a mapping says."""
    one_of(declaration.get("start", "zero"), ("zero", "identity"), where)
    return "start" in declaration and bool({"matrix", "vector"} & {*declaration})


def read_equations(table: Table, key: str, names: Names, where: str) -> list[tuple[Tree, Tree]]:
    """A list of ``left = right`` as pairs."""
    pairs, place = list[tuple[Tree, Tree]](), join_place(where, key)
    for i, text in enumerate(as_list(table[key], place) if key in table else ()):
        own = join_place(place, i)
        sides = as_text(text, own, "an equation").split("=")
        if len(sides) != 2:
            raise ExpressionSyntaxError(f"expected one = in an equation; got {quote(text)}; correct it", where=own)
        left, right = (read_tree(names.translate(side, own), names.declarations, where=own) for side in sides)
        pairs.append((left, right))
    return pairs


# Some lines of a function, read by themselves: what they read and do not assign is an input


def take_lines(unit: Unit, function: Function, first: int, last: int, where: str) -> Function:
    """The statements between two lines as a function; raises DomainError where the lines cut a statement.

    Names that are declared before keep their numbers and sizes, references what they stand for. A pointer that is set
    again is no number any more, so that what depends on it stays unread.
    """
    body, before = function.body, list[Part]()

    def is_near(part: Any) -> bool:
        return isinstance(part, Part) and part.line <= last and last_line(unit, part) >= first

    while True:
        near = [s for s in body if is_near(s)]
        if near and all(first <= s.line and last_line(unit, s) <= last for s in near):
            break
        blocks = [part for s in near if len(near) == 1 for part in s.parts if isinstance(part, tuple)]
        inner = [block for block in blocks if any(map(is_near, block))]
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
    links = [s for s in declared.values() if s.kind == "declare" and s.parts[4] and s.parts[0] not in reseated]
    arguments = {argument.name: argument for argument in function.arguments}
    for name, statement in declared.items():
        if statement not in links:
            arguments[name] = argument_of(statement)
    kept = tuple(replace(arguments[name], shared=True) for name in arguments if name in mentioned_in(*near, *links))
    return Function(function.name, near[0].line, kept, (*links, *near))


def last_line(unit: Unit, statement: Part) -> int:
    """The line in which a statement ends; ``elif`` ends before its ``else``."""
    end = max(part.span[1] for part in walk(statement))
    return 1 + unit.source.count(b"\n", 0, max(end - 1, 0))


def argument_of(statement: Part) -> Argument:
    """A name that was declared before the lines, as an input."""
    if statement.kind == "for":
        return Argument(statement.parts[0], "int", ())
    name, number, shape, value, is_pointer = statement.parts
    if is_pointer or number == "matrix":
        return Argument(name, "other", () if is_pointer else shape)
    is_number = number == "real" and shape is None and (value is None or value.kind == "number")
    return Argument(name, number, shape if shape is not None or not is_number else ())
