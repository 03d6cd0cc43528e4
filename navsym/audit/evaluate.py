"""Expressions of the source on symbols: names, entries, blocks, arithmetic and calls."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from navsym.audit.cases import Condition, Order, Reading
from navsym.audit.form import SECOND, Argument, Function, Part, Unit, head_of, names_in, spell_entry, walk
from navsym.audit.functions import (
    CONSTANTS,
    JOINS,
    KNOWN,
    NAMED_CALLS,
    call_known,
    extreme_of,
    is_known,
    is_method,
    is_view,
    join_named,
)
from navsym.audit.values import (
    CUT,
    LIMITS,
    Array,
    Cell,
    CellView,
    Index,
    List,
    Quaternion,
    Scalar,
    Unread,
    Unreadable,
    Unset,
    Value,
    Variable,
    add,
    as_real,
    combine,
    constant_of,
    convert,
    demand,
    divide,
    does_fit,
    find_unread,
    forbid,
    is_truth,
    join,
    map_cells,
    minus,
    number_type,
    places_of,
    promote,
    require_fit,
    require_no_wrap,
    share,
    total,
)
from navsym.audit.writes import changed_in, owners_in, sources_of
from navsym.language.tree import Tree, build_call, build_number

TRUTHS = ("compare", "both", "either", "not")
KINDS: dict[str, type[Array]] = {"quaternion": Quaternion, "list": List}
INLINED = 12
LETTERS = ("x", "y", "z", "w", "i", "j", "k")
UNDECIDED = "which stands under a condition of the preprocessor that is not decided"

#: Source spelling of an input -> its symbol.
Inputs = Callable[[str], Tree]
Edits = Mapping[int, Part | Callable[["Evaluator", Part], Value]]


class Returning(Exception):
    """The end of a function, with its value."""

    def __init__(self, value: Value | None):
        super().__init__()
        self.value = value


class Failing(Exception):
    """The end of a run in an error of the source."""


@dataclass(slots=True, eq=False)
class Evaluator:
    """The state of one run, and what expressions mean in it; :class:`Machine` has the statements and conditions.

    edits   : parts in the place of others, by ``id``, or what computes a value in their place
    most    : how many steps it may take
    choices : the ways taken at undecided conditions; None leaves unread what depends on one
    is_bold : True where a condition that is not read has two ways as well
    is_split : True where a minimum or maximum has two ways; else it is a formula
    frame   : the names of the running function
    aliases : reference or pointer to a structure -> the structure, and the sign before a member of it
    shadows : what a block's own names have hidden, one table for each block
    ended   : the names of blocks that have ended
    seconds : pointers and references to what is not known
    moved   : pointers that were set again -> the names that they may lead to now, None for any
    order   : of what is read and written that others may know
    outputs : what the last function of MATLAB that was read returned
    parted : objects of C++ to whose parts a method of theirs has led, which were written
    """

    block: ClassVar[Any]
    decide: ClassVar[Any]
    decide_known: ClassVar[Any]
    choose: ClassVar[Any]
    arrays_in: ClassVar[Any]
    write: ClassVar[Any]

    reading: Reading
    inputs: Inputs
    shapes: Mapping[str, Index]
    edits: Edits
    most: int
    choices: list[bool] | None
    is_bold: bool = True
    is_split: bool = True
    frame: dict[str, Variable] = field(default_factory=dict)
    aliases: dict[str, tuple[str, str]] = field(default_factory=dict)
    file_names: dict[str, Variable] = field(default_factory=dict)
    globals: dict[str, Variable] = field(default_factory=dict)
    conditions: list[Condition] = field(default_factory=list)
    other_ways: list[list[bool]] = field(default_factory=list)
    shadows: list[dict[str, Variable | None]] = field(default_factory=list)
    ended: dict[str, Variable] = field(default_factory=dict)
    calls: list[str] = field(default_factory=list)
    expanding: list[str] = field(default_factory=list)
    steps: int = 0
    lost: Unread | None = None
    lost_heads: dict[str, Unread] = field(default_factory=dict)
    outputs: list[Value] = field(default_factory=list)
    seconds: list[Variable] = field(default_factory=list)
    moved: dict[str, tuple[str, ...] | None] = field(default_factory=dict)
    order: Order = field(default_factory=Order)
    parted: set[str] = field(default_factory=set)

    @property
    def unit(self) -> Unit:
        """The source."""
        return self.reading.unit

    def variable(self, name: str) -> Variable:
        """What a name stands for; an unknown one is an input."""
        name = self.canonical(name)
        if name in self.frame:
            return self.frame[name]
        if name in self.file_names:
            return self.file_names[name]
        if name in self.unit.macros:
            raise Unreadable(f"{name}, a macro where a variable is needed")
        if name not in self.globals:
            owners = owners_in(self.unit, name)
            forbid(owners, f"a member of what {', '.join(owners)} of this file gives")
            shape, head = self.shapes.get(name), head_of(name)
            if head in self.lost_heads:
                return Variable(name, shape=shape, is_input=True, all_unread=self.lost_heads[head])
            own = re.split(r"->|\.", name)[-1] if self.unit.language in ("c", "cpp") else name
            number, sizes = self.unit.members.get(own, ("real", None))
            self.globals[name] = Variable(name, number, shape or sizes, is_input=True, all_unread=self.lost)
            share(self.globals[name], self.seconds)
        return self.globals[name]

    def canonical(self, name: str) -> str:
        """A member of a structure by the structure's own name."""
        head = head_of(name)
        if head == name or head not in self.aliases:
            return name
        (owner, sign), rest = self.aliases[head], name[len(head) :]
        return owner + (sign + rest.lstrip("->.") if sign else rest)

    def owner_of(self, value: Part) -> tuple[str, str] | None:
        """The structure to which a reference or pointer leads, and the sign before its members where it is another."""
        if value.kind not in ("name", "address", "first"):
            return None
        sign = {"name": "", "address": ".", "first": "->"}[value.kind]
        inner = value if value.kind == "name" else value.parts[0]
        if inner.kind != "name":
            return None
        owner, before = self.aliases.get(inner.parts[0], (self.canonical(inner.parts[0]), ""))
        return (owner, before if sign in ("", "->") and before else sign)

    def read(self, variable: Variable, place: Index, line: int) -> Cell:
        """One cell."""
        if variable.all_unread is not None:
            return variable.all_unread
        if variable.is_input:
            self.order.note(variable, self.unit.language, self.reading.apart)
        if place in variable.cells:
            return variable.cells[place]
        if variable.is_input:
            cell = Scalar(self.inputs(spell_entry(self.unit, variable.name, place)), promote(variable.number), 0)
            if variable.shape is None:  # a number or an array from now on
                variable.shape = () if not place else None
                variable.cells[place] = cell
                if not place and not self.unit.rules.integer:
                    self.reading.scalars.add(variable.name)
            return cell
        return Unset(line, f"{spell_entry(self.unit, variable.name, place)} has no value there")

    def whole(self, part: Part) -> int:
        """A constant whole number."""
        if part.kind == "number" and part.parts[1] == "int" and not (self.edits or self.unit.decimals):
            self.steps += 1
            return int(part.parts[0])
        value = self.value(part)
        forbid(is_truth(value), "a truth where a whole number is needed", part.line)
        if (exact := constant_of(value)) is None or exact.denominator != 1:
            raise Unreadable("an index or size that is no constant", part.line)
        return int(exact)

    def targets(self, part: Part) -> tuple[Variable, list[Index], Index]:
        """Variable, places and shape of an entry or a block."""
        if part.kind == "first":
            variable = self.variable(part.parts[0].parts[0])
            is_array = bool(variable.shape) or (variable.shape is None and any(variable.cells))
            return variable, [(0,) * max(len(variable.shape or ()), 1) if is_array else ()], ()
        if part.kind == "method" and self.unit.language == "cpp":
            base, method, arguments = part.parts
            forbid(method in self.unit.functions, f"the method {method} of another object")
            if base.kind == "name" and arguments:
                part = Part("call", part.line, (f"{base.parts[0]}.{method}", arguments), part.span)
        part = self.entry_of(part)
        if part.kind == "name":
            variable = self.variable(part.parts[0])
            shape = variable.shape or ()
            return variable, [*places_of(shape)], shape
        why = f"the method {part.parts[1]}" if part.kind == "method" else "a target that is no entry"
        forbid(part.kind not in ("index", "call"), why)
        indices: list[Part] = []
        while part.kind == "index":
            forbid(indices and any(index.kind == "slice" for index in part.parts[1]), "an index of a block")
            indices = [*part.parts[1], *indices]
            part = part.parts[0]
        forbid(self.entry_of(part) is not part, "an entry of a member of an array")
        if part.kind == "call":
            is_own = part.parts[0] in self.unit.functions and part.parts[0] not in self.frame
            forbid(is_own, f"the call of {part.parts[0]} where a variable is needed")
            indices = [*part.parts[1], *indices]
            self.require_entries(part.parts[0])
            if self.unit.language == "cpp" and self.variable(part.parts[0]).number == "quaternion":
                raise Unreadable("an entry of a quaternion by its number, which libraries count differently")
        elif part.kind != "name":
            raise Unreadable("an index of an expression")
        elif "()" in part.parts[0]:
            self.require_entries(part.parts[0])
        forbid(part.parts[0] in self.parted, "an entry of what one of its methods may have written")
        variable = self.variable(part.parts[0])
        return variable, *self.resolve(variable, indices)

    def require_entries(self, name: str) -> None:
        """Refuse the call of a function that is not known: two calls may give two values, as of a clock."""
        base, _, method = name.replace("->", ".").rpartition(".")
        known = self.find(base) if base and self.unit.language == "cpp" else None
        forbid(known is not None and (known.shape or any(known.cells)), f"the method {method}")  # M.topRows(1) is in M
        may_be = self.unit.language in ("cpp", "matlab") or (self.unit.language == "c" and "()" in name)
        is_lost = name in self.globals and self.globals[name].all_unread is not None  # it has a better reason
        if name not in self.frame and not is_lost and not (may_be and self.unit.is_array(name)):
            raise Unreadable(f"the function {name}, which this file does not define")

    def resolve(self, variable: Variable, indices: list[Part]) -> tuple[list[Index], Index]:
        """The places that indices and slices mean, and their shape."""
        sizes = variable.shape
        if sizes and len(sizes) == 2 and 1 in sizes and len(indices) == 1 and self.unit.language in ("matlab", "cpp"):
            spot = self.index_range(indices[0], max(sizes))
            is_column = indices[0].kind == "slice" and indices[0].parts == (None, None)  # w(:), of a row, too
            shape = (1, *spot[1]) if sizes[0] == 1 and spot[1] and not is_column else spot[1]
            return [(0, k) if sizes[0] == 1 else (k, 0) for k in spot[0]], shape
        if sizes and len(sizes) == 2 and len(indices) == 1 and self.unit.language in ("cpp", "rust"):
            raise Unreadable("one index of a matrix, which Eigen and nalgebra count by columns")
        if sizes and len(indices) < len(sizes) and self.unit.language != "matlab":
            indices = [*indices, *[Part("slice", 0, (None, None))] * (len(sizes) - len(indices))]
        is_column = sizes is not None and len(indices) == 2 and len(sizes) == 1 and self.unit.rules.matrix
        if is_column and self.whole(indices[1]) == self.unit.rules.first:  # v(i, 0)
            indices = indices[:1]
        if sizes == () and self.unit.language == "matlab" and all(self.whole(index) == 1 for index in indices):
            return [()], ()  # of a number
        if sizes is not None and len(indices) != len(sizes):
            number = "an index of one number; what it is computed from may lack its size in [code.symbols]"
            raise Unreadable(f"{len(indices)} indices of an array of {len(sizes)}" if sizes else number)
        spots = [self.index_range(index, sizes[k] if sizes else None) for k, index in enumerate(indices)]
        shape = tuple(size for _, sides in spots for size in sides)
        if self.unit.language == "matlab" and len(spots) == 2 and shape and not spots[0][1]:
            shape = (1, *shape)  # a row stays one
        return [*itertools.product(*(row for row, _ in spots))], shape

    def index_range(self, index: Part, size: int | None) -> tuple[list[int], Index]:
        """The whole numbers that one index means, from 0, and its part of the shape."""
        first, outer = self.unit.rules.first, self.frame
        forbid(index.kind == "slice" and size is None, "a slice of an array without a known size")
        if self.unit.language == "matlab" and size is not None:
            self.frame = {**outer, "end": Variable("end", "int", (), {(): Scalar(build_number(size), "int")})}
        try:
            ends = [None if end is None else self.whole(end) for end in index.parts if index.kind == "slice"]
            i = 0 if ends else self.whole(index) - first
        finally:
            self.frame = outer
        if ends and size is not None:
            low, high = 0 if ends[0] is None else ends[0] - first, size if ends[1] is None else ends[1]
            low, high = (low + size if low < 0 else low), (high + size if high < 0 else high)
            forbid(not 0 <= low <= high <= size, "a slice outside the array")
            return [*range(low, high)], (high - low,)
        if i < 0 and self.unit.language == "python" and size is not None:
            i += size
        forbid(i < 0 or (size is not None and i >= size), "an index outside the array")
        return [i], ()

    def value(self, part: Part, wants_value: bool = True) -> Value:
        """The value of an expression."""
        if (edited := self.edits.get(id(part))) is not None:  # while a mend is sought
            if not isinstance(edited, Part):
                return edited(self, part)
            part = edited
        self.steps += 1
        kind = part.kind
        try:
            if kind == "number":
                number, numeral = part.parts
                if self.unit.decimals and (known := self.unit.decimals.get(abs(number))) is not None:
                    return Scalar(known if number > 0 else minus(known))
                return Scalar(build_number(number), numeral)
            if kind == "name":
                return self.named_value(part)
            if kind == "op":
                sign, a, b = part.parts
                return combine(self.unit, sign, self.value(a), self.value(b))
            if kind == "minus":
                return require_fit(self.unit, require_no_wrap(map_cells(minus, self.value(part.parts[0]))))
            if kind in ("index", "first"):
                return self.entries(part)
            if kind == "call":
                return self.call(part, wants_value)
            if kind == "method":
                return self.method(part)
            if kind == "list":
                if self.unit.language == "matlab":
                    return self.rows(part)
                whole = self.stack([self.value(item) for item in part.parts[0]])
                return List(whole.shape, whole.cells) if self.unit.language == "python" else whole
            if kind == "not" and self.unit.language == "rust" and part.parts[0].kind not in TRUTHS:
                raise Unreadable("! of what may be an integer")
            if kind == "compare" or (kind in ("both", "either", "not") and self.unit.rules.integer):
                kind = "bool" if self.unit.language == "python" else "int"  # True is no index of numpy
                return Scalar(build_number(int(self.decide_known(part))), kind)
            if kind == "choose":
                chosen, other = part.parts[1:] if self.decide(part.parts[0]) else part.parts[:0:-1]
                return self.common(self.value(chosen), other)
            if kind == "cast":
                return self.cast(part)
        except Unreadable as refusal:
            raise Unreadable(refusal.why, refusal.line or part.line) from None
        raise Unreadable(part.parts[0] if kind == "refused" else f"a {kind} where a number is needed", part.line)

    def named_value(self, part: Part) -> Value:
        """The value of a name: of a variable, a macro or a constant such as pi."""
        name = self.canonical(part.parts[0])
        if self.unit.language == "matlab" and name not in self.frame and name in self.unit.functions:
            return self.inline(Part("call", part.line, (name, ()), part.span), True)
        forbid(name not in self.frame and not self.unit.knows(name, part), f"{name}, {UNDECIDED}")
        if name not in self.frame and name in self.unit.macros:
            return self.macro(name)
        if (entry := self.entry_of(part)) is not part:
            return self.entries(entry)
        if name not in self.frame and name not in self.file_names and name in CONSTANTS:
            return Scalar(CONSTANTS[name])
        if "()" in name or name in NAMED_CALLS.get(self.unit.language, ()):
            self.require_entries(name)
        variable = self.variable(name)
        if variable.number == "other" and not variable.shape and variable.all_unread is None:
            raise Unreadable(f"{name} as a whole, of a type that is no number")
        return self.whole_value(variable, part.line)

    def macro(self, name: str) -> Value:
        """An object-like macro in its place."""
        meaning = self.unit.macros[name]
        if isinstance(meaning, str) or name in self.expanding:
            raise Unreadable(f"{name}: {meaning if isinstance(meaning, str) else 'a macro of itself'}")
        self.expanding.append(name)
        try:
            return self.value(meaning)
        except Unreadable as refusal:
            raise Unreadable(f"{name}: {refusal.why}") from None
        finally:
            self.expanding.pop()

    def common(self, value: Value, other: Part) -> Value:
        """The chosen one of two numbers of C, in the type that both have."""
        if self.unit.language not in ("c", "cpp") or not isinstance(value, Scalar) or value.number not in LIMITS:
            return value
        kind = self.kind_of(other)
        forbid(not kind, "a choice between numbers whose type is not known", other.line)
        number = "real" if kind == "real" else max(promote(kind), value.number)
        forbid(number in LIMITS and not does_fit(value, number), CUT, other.line)
        return require_fit(self.unit, replace(value, number=number))

    def kind_of(self, part: Part) -> str:
        """The type of a number of C that is not computed; nothing where it is not known."""
        kind = ""
        if part.kind in ("number", "cast"):
            kind = part.parts[part.kind == "number"]
        elif part.kind in ("compare", "both", "either", "not"):
            kind = "int"
        elif part.kind in ("op", "choose", "minus"):
            kinds = {promote(self.kind_of(side)) for side in part.parts[-2:] if isinstance(side, Part)}
            kind = "real" if "real" in kinds else "" if "" in kinds else max(kinds)
        elif part.kind == "call" and part.parts[0] in self.unit.functions:
            numbers = {function.number for function in self.unit.functions[part.parts[0]]}
            kind = numbers.pop() if len(numbers) == 1 else ""
        elif part.kind == "call" and is_known(part.parts[0], self.unit.language):
            kind = "" if part.parts[0].endswith("abs") and "f" not in part.parts[0] else "real"
        elif part.kind in ("name", "index") and (names := [p for p in walk(part) if p.kind == "name"]):
            name = next(p for p in names if part.kind == "name" or p.span[0] == part.span[0]).parts[0]
            meaning = self.unit.macros.get(name)
            if isinstance(meaning, Part) and meaning.kind != "name":
                return self.kind_of(meaning)
            kind = "real" if name in CONSTANTS else "" if meaning else self.variable(name).number
        return kind if kind in (*LIMITS, "real") else ""

    def cast(self, part: Part) -> Value:
        value, kind = self.value(part.parts[1]), part.parts[0]
        if kind not in LIMITS:
            return as_real(value)
        number = demand(value, Scalar, CUT)
        forbid(constant_of(number) is None or not does_fit(number, kind), CUT)
        return replace(number, number=promote(kind))

    def entries(self, part: Part) -> Value:
        """An entry or a block of a variable."""
        try:
            variable, places, shape = self.targets(part)
        except Unreadable:
            is_inner = part.kind == "index" and part.parts[0].kind in ("call", "method", "op", "index")
            base = self.value(part.parts[0]) if is_inner else None
            if not isinstance(base, Array):
                raise
            number = "list" if isinstance(base, List) else "real"
            variable = Variable("", number, base.shape, cells=dict(zip(places_of(base.shape), base.cells, strict=True)))
            places, shape = self.resolve(variable, [*part.parts[1]])
        if not shape:
            return self.read(variable, places[0], part.line)
        kind = List if variable.number == "list" else Array
        return kind(shape, tuple(self.read(variable, place, part.line) for place in places))

    def rows(self, part: Part) -> Value:
        """The brackets of MATLAB: rows of numbers, or of blocks, in which a vector is a column."""
        rows = [[self.value(cell) for cell in row.parts[0]] for row in part.parts[0]]
        if (unread := find_unread(*itertools.chain(*rows))) is not None:
            return unread  # which may be a block of any size
        if any(isinstance(cell, Array) for row in rows for cell in row):
            return join(*(join(*row, across=True) for row in rows), across=False)
        return self.stack([self.stack(row) for row in rows])

    def stack(self, values: list[Value]) -> Array:
        """Numbers as a vector, vectors as the rows of a matrix."""
        shapes = {value.shape for value in values}
        forbid(len(shapes) != 1 or not values, "a list of different shapes")
        (shape,) = shapes
        return Array((len(values), *shape), tuple(c for v in values for c in v.cells))

    def linked(self, value: Part | None) -> Variable:
        """The variable to which a reference or pointer is a second name."""
        while value is not None and value.kind == "address":
            value = value.parts[0]
        value = value.parts[0] if value is not None and value.kind == "first" else value  # *p
        value = self.entry_of(value) if value is not None else None
        if value is not None and value.kind == "name":
            return self.variable(value.parts[0])
        if value is not None and value.kind in ("index", "call", "method"):
            base, (place, *others), _ = self.targets(value)
            forbid(others, "a block where an entry is needed", value.line)
            name = spell_entry(self.unit, base.name, place)
            base.cells.setdefault(place, self.read(base, place, value.line))
            view = Variable(name, base.number, ())
            view.cells = CellView(base, place)
            view.views.append(base)  # a write that is not read loses the whole of it: a pointer may be moved
            return view
        raise Unreadable("a reference or pointer to what is no variable")

    def call(self, part: Part, wants_value: bool) -> Value:
        """A known function, one of the file, or an entry ``M(i, j)``."""
        name, arguments = part.parts
        forbid(name not in self.frame and not self.unit.knows(name, part), f"{name}, {UNDECIDED}")
        if name in self.unit.macros:
            why = self.unit.macros[name]
            raise Unreadable(f"{name}: {why if isinstance(why, str) else 'a macro that is called'}")
        if name not in self.frame and name in self.unit.functions:
            return self.inline(part, wants_value)
        if name not in self.frame and (sign := extreme_of(name, self.unit.language)) and len(arguments) == 2:
            return self.extreme(part, sign)
        if name in JOINS and len(arguments) == 1 and arguments[0].kind == "list":
            return self.join_arrays(JOINS[name], arguments[0])
        if name not in self.frame and is_known(name, self.unit.language):
            return call_known(name, [self.value(a) for a in arguments], self.unit)
        if arguments:
            return self.entries(part)
        self.require_entries(f"{name}()")
        return self.whole_value(self.variable(f"{name}()"), part.line)

    def join_arrays(self, name: str, part: Part) -> Value:
        """``np.hstack([a, b])`` and its like; a vector is a row of a matrix, and is joined with vectors to one."""
        items = part.parts[0]
        if name == "block" and items and all(item.kind == "list" for item in items):
            return join(*(self.join_arrays("row", item) for item in items), across=False)
        return join_named(name, [self.value(item) for item in items])

    def extreme(self, part: Part, sign: str) -> Value:
        """The larger or the smaller of two numbers, as cases."""
        both = [self.value(argument) for argument in part.parts[1]]
        if (unread := find_unread(*both)) is not None:
            return unread
        a, b = (demand(value, Scalar, f"{part.parts[0]} of arrays") for value in both)
        x, y = constant_of(a), constant_of(b)
        text = " >= ".join(self.unit.text(argument) for argument in part.parts[1])
        if x is not None and y is not None:
            is_first = x >= y
        else:  # one condition for both, so that the larger and the smaller of the same two are told apart together
            if not self.is_split:  # (a + b + |a - b|)/2 is the larger one
                apart = build_call("abs", add(a.tree, minus(b.tree)))
                whole = total(a.tree, b.tree, apart if sign == ">=" else minus(apart))
                return Scalar(divide(whole, build_number(2)))
            is_first = self.choose(Condition(text, part.line, True, ">=", a.tree, b.tree))
        result = a if is_first == (sign == ">=") else b
        return as_real(result) if "fm" in part.parts[0] and self.unit.language in ("c", "cpp") else result

    def inline(self, part: Part, wants_value: bool) -> Value:
        """The body of a function of the file, on its arguments."""
        name, arguments = part.parts
        candidates = [f for f in self.unit.functions[name] if f.takes(len(arguments))]
        near = [f for f in candidates if f.region is None or f.region[0] <= part.span[0] < f.region[1]]
        forbid(candidates and not near, f"{name}, {UNDECIDED}")
        candidates = near
        forbid(len(candidates) != 1, f"a call of {name}, which has {len(candidates)} definitions that fit")
        if name in self.calls or len(self.calls) >= INLINED:
            raise Unreadable(f"the recursion of {name}" if name in self.calls else "calls nested too deep")
        function = candidates[0]
        forbid(len(function.arguments) != len(arguments), f"{name} without an argument that has a value of its own")
        if (why := self.unit.virtual.get(name)) is not None:
            forbid(why, f"{name}, in whose place another function may stand ({why})")
            self.reading.kept.add(name)
        self.reading.functions.add(function)
        forbid(function.number == SECOND, f"{name}, which gives another name of something")
        forbid(any(a.name.startswith("*") for a in function.arguments), f"{name} of any number of arguments")
        self.require_no_structure(function, arguments)
        frame = {a.name: self.bind(a, given, function) for a, given in zip(function.arguments, arguments, strict=True)}
        for output in function.outputs:
            frame.setdefault(output, Variable(output))
        heads = {"self", *frame}
        frame |= {known: variable for known, variable in self.frame.items() if known != head_of(known) in heads}
        outer, shadows, aliases = self.frame, self.shadows, self.aliases
        self.frame, self.shadows, self.aliases, returned = frame, [], {}, None
        self.calls.append(name)
        try:
            self.block(function.body)
        except Returning as end:
            returned = end.value
        finally:
            self.frame, self.shadows, self.aliases = outer, shadows, aliases
            self.calls.pop()
        if self.unit.language == "python":  # the members of an object are the caller's, too
            outer |= {known: variable for known, variable in frame.items() if known != head_of(known) in heads}
        if function.outputs and returned is None:
            self.outputs = [self.whole_value(frame[output], part.line) for output in function.outputs]
            returned = self.outputs[0]
        forbid(returned is None and wants_value, f"{name} returns no value")
        is_lazy = self.unit.language == "cpp" and function.number == "auto" and isinstance(returned, Array)
        forbid(is_lazy, f"{name}, whose auto may be an expression that is computed when it is used")
        return convert(returned, function.number, part.line) if returned is not None else Unread(part.line, "no value")

    def require_no_structure(self, function: Function, arguments: tuple[Part, ...]) -> None:
        """Refuse a structure under another name: its members would be other names."""
        heads = {head_of(name) for name in names_in(*function.body) if head_of(name) != name}
        for argument, given in zip(function.arguments, arguments, strict=True):
            inner = given.parts[0] if given.kind == "address" else given
            is_same = inner.kind == "name" and inner is given and inner.parts[0] == argument.name
            is_same = is_same and argument.name not in self.aliases
            forbid(argument.name in heads and not is_same, f"a structure that {function.name} knows by another name")

    def whole_value(self, variable: Variable, line: int) -> Value:
        """A variable as a value."""
        if variable.all_unread is not None:
            return variable.all_unread
        if variable.shape:
            kind = KINDS.get(variable.number, Array)
            return kind(variable.shape, tuple(self.read(variable, place, line) for place in places_of(variable.shape)))
        if variable.shape is None and variable.cells and () not in variable.cells:
            raise Unreadable(f"{variable.name} as a whole, of unknown size")
        return self.read(variable, (), line)

    def bind(self, argument: Argument, given: Part, function: Function) -> Variable:
        """A parameter of an inlined function: the caller's own variable, or a copy of a value."""
        inner = self.entry_of(given.parts[0] if given.kind == "address" else given)
        changed = changed_in(self.unit, function).changed
        is_number = argument.shared and argument.number != "other" and argument.name not in changed
        is_copied = is_number and given.kind != "address" and self.is_copied(argument.name, inner)
        if is_copied:
            argument = replace(argument, shared=False)
        is_open = self.unit.language == "cpp" and argument.number == "other" and not argument.shared
        forbid(is_open and argument.name in changed, f"what {function.name} may change, or a copy of it")
        if inner.kind == "name" and (argument.shared or given.kind == "address" or argument.shape is not None):
            variable = self.variable(inner.parts[0])
            if argument.shape is not None and variable.shape is None and not variable.cells:
                variable.shape = tuple(self.whole(size) for size in argument.shape)
            is_copy = not argument.shared and given.kind != "address" and argument.name in changed
            if argument.shared or ((variable.shape is None or variable.shape) and not is_copy):
                return variable
            if is_copy and variable.shape is None:
                raise Unreadable(f"a copy of {variable.name}, of unknown size; declare it", given.line)
        if given.kind == "address":
            return self.linked(given)
        is_place = inner.kind == "index" or (inner.kind == "call" and inner.parts[0] in self.frame)
        if argument.shared and is_place:
            _, _, sides = self.targets(inner)
            if sides and argument.name in changed:
                raise Unreadable(f"a part of an array that {function.name} may change", given.line)
            if not sides and self.unit.language != "python":
                return self.linked(inner)
        is_python, is_c = self.unit.language == "python", self.unit.rules.integer
        is_open = argument.number in ("auto", "other")
        is_alias = given.kind in ("method", "call", "choose") and is_view(self.unit, given) and given.parts[1] != "copy"
        if is_python and is_alias and argument.name in changed:
            raise Unreadable(f"a view of an array that {function.name} may change", given.line)
        value = self.value(given)
        if argument.number == "auto" and any(isinstance(c, Scalar) and c.number in LIMITS for c in value.cells):
            raise Unreadable(f"an integer given to the template {function.name}, which may cut quotients", given.line)
        shape = value.shape
        variable = Variable(argument.name, "list" if isinstance(value, List) else argument.number, shape)
        if isinstance(value, Unread):
            variable.all_unread = value
            return variable
        self.write(variable, value, given)
        is_row = is_place and not any(side.kind == "slice" for side in walk(inner))  # of C, whose name is a pointer
        if is_copied and not variable.shape:
            share(variable, [self.linked(inner)])
        elif variable.shape and (is_place or is_alias if is_python else is_c and (is_row or is_open)):
            share(variable, self.arrays_in(sources_of(given)))
        return variable

    def is_copied(self, name: str, value: Part) -> bool:
        """True where a reference to a constant number of C++ may be a copy: its type is not that of the number."""
        if self.unit.language != "cpp" or value.kind not in ("name", "index", "call"):
            return False
        try:
            variable, places, shape = self.targets(value)
        except Unreadable:
            return False
        own, other = (self.unit.kinds.get(re.split(r"->|\.", n)[-1], set()) for n in (name, variable.name))
        pair = {*map(number_type, own | other)}
        return not shape and len(places) == 1 and len(pair - {"auto"}) != 1 and pair != {"auto"}

    def method(self, part: Part) -> Value:
        """``M.transpose()`` and the like; an accessor without arguments is a name."""
        base, name, arguments = part.parts
        is_array = base.kind != "name" or name == "T" or bool(self.variable_shape(base.parts[0]))
        if (is_known_method := is_method(name, len(arguments), self.unit.language)) and is_array:
            return KNOWN[name, 1 + len(arguments)](self.unit, self.value(base), *map(self.value, arguments))
        if base.kind == "name" and self.variable_shape(base.parts[0]):
            forbid(arguments, f"the method {name}")
            return self.entries(self.component(part, base.parts[0], name))
        if is_known_method:  # never an accessor: without its size nobody knows what it gives
            raise Unreadable(f"{name} of what has no known size; declare it under [code.symbols]")
        forbid(name in self.unit.functions, f"the method {name} of another object")
        if base.kind == "name" and self.unit.language in ("c", "cpp"):
            return self.call(Part("call", part.line, (f"{base.parts[0]}.{name}", arguments), part.span), True)
        raise Unreadable(f"the method {name}")

    def entry_of(self, part: Part) -> Part:
        """``v.x`` and ``v.x()`` of a vector as an entry, which may have another name; else the part itself."""
        if part.kind == "name" and part.parts[0] not in self.shapes:
            base, dot, field = part.parts[0].rpartition(".")
            return self.component(part, base, field) if dot and self.variable_shape(base) else part
        is_short = part.kind == "method" and not part.parts[2] and part.parts[1] in LETTERS
        base = part.parts[0].parts[0] if is_short and part.parts[0].kind == "name" else ""
        is_own = is_short and self.unit.language == "cpp" and part.parts[1] in self.unit.functions
        return self.component(part, base, part.parts[1]) if base and not is_own and self.variable_shape(base) else part

    def component(self, part: Part, name: str, letter: str) -> Part:
        """The entry of a vector of two or three, or of a quaternion, that has a letter."""
        shape = self.variable_shape(name) or ()
        letters = "xyz"[: shape[0]] if shape in ((2,), (3,)) else ""
        if self.variable(name).number == "quaternion":
            letters = "xyzw" if self.unit.language == "cpp" else "ijkw"
        forbid(len(letter) != 1 or letter not in letters, f"the method {letter}")
        place = Part("number", part.line, (letters.index(letter), "int"))
        return Part("index", part.line, (Part("name", part.line, (name,), part.span), (place,)), part.span)

    def variable_shape(self, name: str) -> Index | None:
        """The shape of a name that is known already."""
        known = self.find(name)
        return known.shape if known else self.shapes.get(self.canonical(name))

    def find(self, name: str) -> Variable | None:
        """What a name stands for that is known already."""
        name = self.canonical(name)
        return self.frame.get(name) or self.file_names.get(name) or self.globals.get(name)
