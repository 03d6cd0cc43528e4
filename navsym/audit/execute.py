"""A function of the source, run on symbols: what its outputs are as formulas of its inputs, case by case."""

from __future__ import annotations

import contextlib
import functools
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from navsym.audit.cases import CASES, Case, Condition, Order, Reading, is_contradictory, list_cases
from navsym.audit.evaluate import Edits, Evaluator, Failing, Inputs, Returning
from navsym.audit.form import Argument, Function, Part, Unit, called_in, head_of, mentioned_in, names_in, sides_of, walk
from navsym.audit.functions import HARMLESS, IN_PLACE, PURE, is_view
from navsym.audit.values import (
    COMPARE,
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
    Value,
    Variable,
    combine,
    constant_of,
    convert,
    demand,
    does_fit,
    find_unread,
    forbid,
    is_integer,
    join,
    lose,
    lose_views,
    make_array,
    places_of,
    promote,
    require_one_sign,
    share,
)
from navsym.audit.writes import Writes, changed_in, find_race, is_naming, list_links, owners_in, sources_of, written_by
from navsym.core.errors import TooLargeError
from navsym.language.tree import NUMBER, ZERO, build_number

Body = tuple[Part, ...]
STEPS = 250_000
#: Of Eigen, what is computed cell by cell when it is used; another library computes it at once.
LAZY = ("transpose", "diagonal", "asDiagonal", "cwiseProduct")
OTHER_LIBRARY = re.compile(rb"\bmatrix(::|/)|AP_Math")
ROUNDS = 20_000  # of one loop
#: First two ways for all that is undecided.
WAYS = ((True, True), (False, True), (False, False))


def read_function(
    unit: Unit,
    function: Function,
    inputs: Inputs,
    shapes: Mapping[str, Index] | None = None,
    edits: Edits | None = None,
    known: Reading | None = None,
) -> Reading:
    """All cases of a function; more than 32 leave unread what its branches write.

    inputs : source spelling of an input -> its symbol
    shapes : sizes of inputs that the source does not say
    edits  : expressions and statements in the place of others, by ``id``
    known  : the reading without edits, of which one with edits may take the steps four times
    """
    reading, most = Reading(unit, function), STEPS if known is None else min(4 * known.steps + 1000, STEPS)
    start = functools.partial(Machine, reading, inputs, shapes or {}, edits or {}, most)
    for reading.ways in WAYS[WAYS.index(known.ways) if known is not None else 0 :]:
        reading.cases = list_cases(start, reading, function, *reading.ways)
        if reading.cases:
            break
    else:
        reading.cases = [start(None, False).run(function)]
    lasting = [case for case in reading.cases if not case.has_failed]
    for case in [] if lasting else reading.cases:
        why = Unread(function.line, f"every way through {function.name} ends in an error")
        case.returned = why
        for variable in case.variables.values():
            variable.all_unread = why
    reading.cases = lasting or reading.cases[:1]
    return reading


@dataclass(slots=True, eq=False)
class Machine(Evaluator):
    """One run. Undecided conditions take the ways of ``choices``, and then the first of both.

    choices : None leaves unread what depends on an undecided condition
    """

    def run(self, function: Function) -> Case:
        """The whole function."""
        for constant in self.unit.constants:  # nothing else depends on one that is not read
            name = constant.parts[0] if constant.kind == "declare" else constant.parts[0].parts[0]
            try:
                getattr(self, f"run_{constant.kind}")(*constant.parts, statement=constant)
            except Unreadable as refusal:
                unread = refusal.leave(constant)
                self.reading.refused.setdefault(unread.line, unread.why)
                self.frame[name] = Variable(name, all_unread=unread)
        once = [constant.parts[0] for constant in self.unit.constants if constant.kind == "declare"]
        for name in {name for name in once if once.count(name) > 1}:
            self.frame[name].all_unread = Unread(function.line, f"{name}, which has several values in this file")
        self.file_names, self.frame = self.frame, {}
        shared = frozenset(argument.name for argument in function.arguments if argument.shared)
        self.order = Order(frozenset(argument.name for argument in function.arguments) - shared, shared)
        self.reading.functions.add(function)
        for argument in function.arguments:
            self.frame[argument.name] = self.make_argument(argument)
        for name in function.outputs:
            self.frame.setdefault(name, Variable(name))
        returned, has_failed = None, False
        try:
            self.block(function.body)
        except Returning as end:
            returned = end.value
        except Failing:
            has_failed = True
        value = None if returned is None else convert(returned, function.number, function.line)
        return Case(tuple(self.conditions), {**self.ended, **self.globals, **self.frame}, value, has_failed)

    def make_argument(self, argument: Argument) -> Variable:
        """A parameter of the function that is audited: an input."""
        shape = self.shapes.get(argument.name)
        with contextlib.suppress(Unreadable):
            if shape is None and argument.shape is not None:
                shape = tuple(self.whole(size) for size in argument.shape)
        return Variable(argument.name, argument.number, shape, is_input=True)

    def block(self, body: tuple[Part, ...]) -> None:
        """Statements with names of their own."""
        with self.scope():
            for statement in body:
                self.statement(statement)

    @contextlib.contextmanager
    def scope(self) -> Iterator[None]:
        """Names that are declared here hide others until the end."""
        self.shadows.append({})
        try:
            yield
        finally:
            for name, hidden in self.shadows.pop().items():
                if self.shadows and name in self.frame:  # nobody reads on behind the body of a function
                    self.ended[name] = self.frame.pop(name)
                if hidden is not None:
                    self.frame[name] = hidden

    def statement(self, statement: Part) -> None:
        """One statement; what cannot be read leaves its names unread."""
        statement = self.edits.get(id(statement), statement)  # type: ignore[assignment]
        self.steps += 1
        if self.steps > self.most:
            message = f"expected at most {self.most} steps; got more; ask for a smaller function"
            raise TooLargeError(message, where=f"{self.unit.file}: line {statement.line}")
        if statement.kind != "block":
            self.reading.met.add(statement.span)
        try:
            getattr(self, f"run_{statement.kind}")(*statement.parts, statement=statement)
        except Unreadable as refusal:
            self.refuse(statement, refusal.leave(statement))
        finally:
            if self.moved and statement.kind != "moved":
                self.lose_pointees(self.written_by(statement).names, statement.line)

    def refuse(self, statement: Part, unread: Unread) -> None:
        """Leave unread what a statement may write."""
        self.reading.refused.setdefault(unread.line, unread.why)
        self.reading.refused_spans.add(statement.span)
        is_entry = statement.kind == "assign" and self.lose_entries(statement, unread)
        writes = self.written_by(*(statement.parts[1:] if is_entry else (statement,)))
        if writes.others or "this" in writes.names:
            self.lose(unread)
        closures = [name for name in called_in(statement) if self.is_closure(name)]
        names = {*writes.names, *(self.frame if closures else ())}
        names |= {self.canonical(name + ".").rstrip(".->") for name in names}
        for name in sorted(names | {base for n in names if self.variable_shape(base := n.rpartition(".")[0])}):
            if name in self.frame or not (name in {*self.file_names, *self.unit.macros} or owners_in(self.unit, name)):
                lose(self.variable(name), unread)
                self.lose_members(name, unread)
        for name, sources in list_links(self.unit, statement) if is_naming(self.unit, statement) else ():
            variable = self.frame[self.canonical(name)] = Variable(self.canonical(name), all_unread=unread)
            is_object = statement.kind == "declare" and statement.parts[1] == "other"  # which may keep references
            known = [v for n in sources if is_object and (v := self.frame.get(n) or self.globals.get(n)) is not None]
            share(variable, known or self.arrays_in(sources))
            if statement.kind == "declare" and statement.parts[4] != "const" and called_in(statement):
                share(variable, [*self.globals.values()])  # it may be another name of any
                self.seconds.append(variable)
        if writes.leaves:
            self.stop(unread)

    def written_by(self, *parts: Part) -> Writes:
        """What parts may write here."""
        entries = {name for name in self.frame if not self.is_closure(name)}
        numbers = {name for name in mentioned_in(*parts) if self.variable_shape(name) == ()}
        return written_by(self.unit, *parts, entries=entries, numbers=numbers)

    def lose_entries(self, statement: Part, unread: Unread) -> bool:
        """True where an assignment that is not read can only write known entries, which are unread now."""
        try:
            variable, places, _ = self.targets(statement.parts[0])
        except Unreadable:
            return False
        if statement.parts[0].kind == "name" or variable.all_unread is not None:
            return False
        for place in places:
            self.write_cell(variable, place, unread, statement)
        return True

    def lose_members(self, name: str, unread: Unread) -> None:
        """The members of a structure that may have been written as a whole."""
        self.lost_heads[name] = unread
        for variable in (*self.frame.values(), *self.globals.values()):
            if variable.name != name and head_of(variable.name) == name:
                variable.all_unread = unread

    def stop(self, unread: Unread) -> None:
        """The end of a run whose way nobody knows any more: nothing that it holds is read."""
        self.lose(unread)
        for variable in self.frame.values():
            variable.all_unread = unread
        raise Returning(unread)

    def lose(self, unread: Unread) -> None:
        """What does not belong to the function may have changed too."""
        self.lost = self.lost or unread
        for variable in self.globals.values():
            variable.all_unread = variable.all_unread or unread

    def is_closure(self, name: str) -> bool:
        """True for a name that is called though its value is not read: it may hold a function that writes any name."""
        known = self.frame.get(name) or self.globals.get(name)
        return known is not None and known.all_unread is not None

    def run_unread(self, why: str, names: tuple[str, ...], statement: Part) -> None:
        raise Unreadable(why)

    run_jump = run_unread

    def run_moved(self, name: str, why: str, names: tuple[str, ...], is_exact: bool, statement: Part) -> None:
        """A pointer that is set again: what it leads to is unread, and a write through it is one to all it may be."""
        unread = Unread(statement.line, why)
        self.lose_names((name, *names), unread)
        self.frame[name] = Variable(name, all_unread=unread)
        self.aliases.pop(name, None)
        self.moved[name] = names if is_exact else None
        raise Unreadable(why)

    def lose_names(self, names: Iterable[str], unread: Unread) -> None:
        """Leave unread some names and their members."""
        for name in names:
            lose(self.variable(name), unread)
            self.lose_members(name, unread)

    def lose_pointees(self, names: Iterable[str], line: int) -> None:
        """Leave unread what pointers that were set again may lead to, when it may be written through them."""
        unread = Unread(line, "what may be written by a pointer that was set again")
        for name in {head_of(name) for name in names} & self.moved.keys():
            known = self.moved[name]
            self.lose_names((name, *(known or ())), unread)
            if known is None:
                self.lose(unread)
                for variable in self.frame.values():
                    variable.all_unread = unread

    def run_fail(self, why: str, statement: Part) -> None:
        raise Failing(why)

    def run_several(self, targets: tuple[Part, ...], call: Part, statement: Part) -> None:
        """``[a, b] = f(x)`` of MATLAB, for a function of the file."""
        if call.kind != "call" or call.parts[0] not in self.unit.functions or call.parts[0] in self.frame:
            raise Unreadable("several names assigned at once")
        self.outputs = []
        self.value(call)
        forbid(len(self.outputs) < len(targets), "more names than values")
        for target, value in zip(targets, self.outputs[:], strict=False):
            self.note_unread(value, statement)
            forbid(target.kind != "name", "entries among several names assigned at once")
            self.rename(target.parts[0], call, value, statement)

    def run_declare(
        self, name: str, number: str, shape: Any, value: Part | None, is_link: bool, statement: Part
    ) -> None:
        """A new name, its value, or a second name of another variable."""
        if self.shadows and name not in self.shadows[-1]:
            self.shadows[-1][name] = self.frame.get(name)
        self.aliases.pop(name, None)
        is_number = is_link == "const" and number != "other" and value is not None
        copied = self.linked(value) if is_number and self.is_copied(name, value) else None  # type: ignore[arg-type]
        if is_link and copied is None:
            self.frame[name] = self.linked(value)
            owner = self.owner_of(value) if value is not None and not self.frame[name].shape else None
            if number == "other" and owner is not None:
                changed = changed_in(self.unit, self.reading.function).changed
                if is_link != "const" or head_of(owner[0]) in {*map(head_of, changed)}:
                    self.aliases[name] = owner  # else its members keep the names by which they are called here
            elif number == "other" and (is_link != "const" or self.frame[name].shape):
                raise Unreadable("a reference or pointer to a structure that is no name")
            return
        if number == "other" and any(name in table for table in self.shadows[:-1]):
            self.stop(Unread(statement.line, "a structure that hides another of its name"))
        if number == "other" and value is None:
            for member in (v for v in (*self.frame.values(), *self.globals.values()) if head_of(v.name) == name):
                member.all_unread = Unread(statement.line, f"{name} is made anew, with members that are not known")
        self.require_order(*([value] if value is not None else ()))
        sizes = () if shape is None else tuple(self.whole(size) for size in shape)
        result = None if value is None else self.value(value)
        if shape is None and isinstance(result, Array):
            forbid(number == "other", "a structure made of a list")
            sizes = result.shape  # auto
        elif isinstance(result, Array) and len(sizes) == 2:
            is_list = len(result.shape) == 1 and value is not None and value.kind == "list"
            fits = is_list or sizes in (self.fill(result, sizes).shape, result.shape[1:])  # type: ignore[union-attr]
            forbid(not fits, f"{name}, a matrix made of a row of numbers, which may be its columns")
        elif number == "matrix" and isinstance(result, Scalar):
            raise Unreadable(f"{name}, a matrix of unknown size")
        is_lazy = number != "matrix"
        if number in ("auto", "matrix"):
            is_quaternion = isinstance(result, Quaternion)
            number = "quaternion" if is_quaternion else result.number if isinstance(result, Scalar) else "real"
        variable = Variable(name, number, sizes)
        self.frame[name] = variable
        if result is not None:
            self.note_unread(result, statement)
            self.write(variable, self.fill(result, sizes), statement)
        if copied is not None:
            share(variable, [copied])
        lazy = ("op", "minus", "method", "index", *(("name",) if self.unit.language == "cpp" else ()))
        if is_lazy and shape is None and sizes and value is not None and value.kind in lazy:
            # auto of Eigen is computed when it is used, and of an array it is a pointer
            share(variable, self.arrays_in(sources_of(value)))

    def note_unread(self, value: Value, statement: Part) -> None:
        """Keep in mind an assignment of what is not read."""
        unread = next((cell for cell in value.cells if isinstance(cell, Unread)), None)
        if unread is not None:
            self.reading.valueless[statement.span] = unread.why

    def fill(self, value: Value, shape: Index) -> Value:
        """An initial value in its shape: the rest of a C initializer is zero."""
        if not isinstance(value, Array) or value.shape == shape:
            return value
        if len(value.shape) == len(shape) and all(a <= b for a, b in zip(value.shape, shape, strict=True)):
            zero = Scalar(build_number(0), "int")
            inside = {place: value.at(*place) for place in places_of(value.shape)}
            return make_array(shape, lambda *place: inside.get(place, zero))
        return value

    def run_assign(self, target: Part, sign: str, value: Part, statement: Part) -> None:
        """An assignment, also of a whole array, a row or a block."""
        self.require_order(value, *([target] if sign or target.kind != "name" else ()))
        first = self.value(target) if sign and self.unit.language == "python" else None  # read before the right side
        result = self.fill_by_commas(target, value) if sign == "<<" else self.value(value)
        sign = sign.removesuffix("<<")
        if self.unit.language == "cpp" and not OTHER_LIBRARY.search(self.unit.source) and self.overlaps(value, target):
            raise Unreadable("a matrix that Eigen changes while a part of it is read; write .eval()")
        if sign:
            before = first or self.value(target)
            forbid(isinstance(before, List), f"{sign}= of a list, which is no array")
            result = combine(self.unit, sign, before, result)
        self.note_unread(result, statement)
        target = self.entry_of(target)
        if target.kind == "name":
            variable = self.variable(target.parts[0])
            if isinstance(result, Array) and variable.shape in (None, ()) and not variable.is_input:
                variable.shape = result.shape
            elif not isinstance(result, Array) and variable.shape is None:
                variable.shape = ()
            if self.unit.language in ("python", "matlab") and not (sign and isinstance(result, Array | Unread)):
                self.rename(target.parts[0], value, result, statement)
                return
            self.write(variable, result, statement)
            return
        variable, places, _ = self.targets(target)
        if target.kind in ("method", "call"):  # of a matrix of unknown size a part, of an object perhaps a member
            self.parted.add(variable.name.replace("->", ".").rpartition(".")[0])
        if variable.number == "list" and isinstance(result, Array) and value.kind != "list":
            lose(variable, Unread(statement.line, "a row of a list that may stand in two places"))
            raise Unreadable("a row of a list that may stand in two places")
        if isinstance(result, Array) and math.prod(result.shape) != len(places):
            raise Unreadable("an assignment between shapes that do not fit")
        cells = result.cells if isinstance(result, Array) else (result,) * len(places)
        for place, cell in zip(places, cells, strict=True):
            self.write_cell(variable, place, cell, statement)

    def overlaps(self, value: Part, target: Part) -> bool:
        """True where Eigen writes the target while it reads the same cells in another order."""
        variable, written, _ = self.targets(target)
        near = (self.find(name) for name in mentioned_in(value))
        if len(written) < 2 or not any(v is variable or (v is not None and variable in v.views) for v in near):
            return False
        is_turned = value.kind == "method" and value.parts[1] == "inverse"
        return self.is_moved(value, variable, written, is_turned)

    def is_moved(self, part: Part, variable: Variable, written: list[Index], is_turned: bool) -> bool:
        """True where an expression reads cells of a variable elsewhere than they are written; a product is made before.

        is_turned : what is around the expression changes the order in which it is read
        """
        sides = sides_of(part)
        if part.kind in ("op", "minus", "choose"):
            is_product = part.parts[0] == "*" and all(isinstance(self.value(side), Array) for side in sides)
            if is_product and not any(s.kind == "method" and s.parts[1] == "asDiagonal" for s in sides):
                return False
        elif part.kind == "method" and part.parts[1] in (*LAZY, *(["inverse"] if is_turned else ())):
            is_turned |= part.parts[1] != "cwiseProduct"
        elif part.kind == "call" and any(not f.number for f in self.unit.functions.get(part.parts[0], ())):
            is_turned = True  # a reference to constants, perhaps to these
        else:
            try:
                base, places, _ = self.targets(part)
            except Unreadable:
                return False  # a value of its own
            is_same = base is variable and bool({*places} & {*written}) and (is_turned or places != written)
            return len(places) > 1 and (is_same or variable in base.views)
        return any(self.is_moved(side, variable, written, is_turned) for side in sides)

    def fill_by_commas(self, target: Part, value: Part) -> Value:
        """``M << A, b, c`` of Eigen: blocks side by side until a row is full, and then below."""
        *_, shape = self.targets(target)
        forbid(not shape, "<< into what has no known size", value.line)
        filled = self.targets(target)[0]
        near = [v for v in map(self.find, mentioned_in(value)) if v is not None]
        if any(filled in (v, getattr(v.cells, "base", None), *v.views) for v in near):
            raise Unreadable("a matrix that is filled with its own entries", value.line)
        rows, blocks = list[list[Value]]([[]]), [*map(self.value, value.parts[0])]
        if (unread := find_unread(*blocks)) is not None:
            return unread
        for block in blocks:
            rows[-1].append(block)
            if join(*rows[-1], across=True).shape[1:] == ((*shape, 1)[1],):  # type: ignore[union-attr]
                rows.append([])
        return join(*(join(*row, across=True) for row in rows if row), across=False)

    def rename(self, name: str, value: Part, result: Value, statement: Part) -> None:
        """An assignment of Python or MATLAB: the name stands for another value from now on.

        In Python two names share one array, and a slice is a view: a later write leaves the other one unread.
        """
        is_python, name = self.unit.language == "python", self.canonical(name)
        self.rename_object(name, value, statement)
        if is_python and value.kind == "name" and isinstance(result, Array):
            self.frame[name] = self.variable(value.parts[0])
            return
        bases = self.arrays_in(sources_of(value)) if is_python else []
        if is_python and value.kind == "call" and value.parts[0] in self.unit.functions:
            bases += [v for known, v in self.frame.items() if "." in known and v.shape]  # a member that it returns
        number = "list" if isinstance(result, List) else "real"
        variable = Variable(name, number, result.shape)
        cells = result.cells if isinstance(result, Array) else ()
        if is_python and not isinstance(result, List) and cells and all(is_integer(cell) for cell in cells):
            variable.number = "int"  # an array of integers cuts what is assigned to its entries
        self.write(variable, result, statement)
        self.frame[name] = variable
        if cells and bases and isinstance(result, List):
            share(variable, [*bases, variable])  # two of its rows may be one
        elif (cells or isinstance(result, Unread)) and is_view(self.unit, value):
            share(variable, bases)

    def rename_object(self, name: str, value: Part, statement: Part) -> None:
        """Members belong to what a name stood for before; of Python's objects two names may be of one."""
        unread = Unread(statement.line, f"a member of another {name}")
        for other in [other for other, (owner, _) in self.aliases.items() if owner == name]:
            self.aliases[other] = (f"{name}@{statement.line}", ".")
            self.lost_heads[f"{name}@{statement.line}"] = unread
        self.aliases.pop(name, None)
        is_copy = self.unit.language == "matlab" and value.kind == "name"  # perhaps of a structure
        if is_copy or any(known.startswith(f"{name}.") for known in (*self.frame, *self.globals)):
            self.lose_members(name, unread)
        if self.unit.language == "python" and value.kind == "name":
            self.aliases[name] = (self.canonical(value.parts[0]), ".")

    def arrays_in(self, names: Iterable[str]) -> list[Variable]:
        """The arrays among names, and what may be one."""
        return [self.variable(name) for name in names if self.variable_shape(name) or self.is_closure(name)]

    def write(self, variable: Variable, value: Value, statement: Part) -> None:
        """A whole variable."""
        if isinstance(value, Unread):
            lose(variable, value)
            return
        variable.all_unread = None
        shape = value.shape
        forbid(not shape and variable.shape, "a number assigned to an array")
        if variable.shape not in (None, shape) and math.prod(variable.shape or ()) != math.prod(shape):
            raise Unreadable("an assignment between shapes that do not fit")
        if shape:
            variable.shape = variable.shape or shape
        for place, cell in zip(places_of(variable.shape or ()), value.cells, strict=True):
            self.write_cell(variable, place, cell, statement)

    def write_cell(self, variable: Variable, place: Index, cell: Cell, statement: Part) -> None:
        """One cell, with the line of the statement."""
        if isinstance(cell, Scalar):
            forbid(variable.number in LIMITS and not does_fit(cell, variable.number), CUT)
            number = promote(variable.number) if self.unit.rules.integer else cell.number
            number = "real" if number in ("quaternion", "auto") else number
            cell = Scalar(cell.tree, number, statement.line, statement)
            self.reading.written.setdefault((cell.tree, variable.name, place), statement.line)
        variable.cells[place] = cell
        if variable.is_input:
            self.order.note(variable, self.unit.language, self.reading.apart, is_write=True)
        owner = self.frame.get(head_of(variable.name), variable)
        if owner is not variable and owner.views:
            lose(owner, Unread(statement.line, "a member of what may be another name"))
        if not isinstance(variable.cells, CellView):  # which has no cells of its own
            lose_views(variable, Unread(statement.line, "a view of an array that has changed; write a copy"))

    def run_block(self, body: Body, statement: Part) -> None:
        self.block(body)

    def run_if(self, test: Part, then: Body, other: Body, statement: Part) -> None:
        self.block(then if self.decide(test) else other)

    def run_for(self, name: str, start: Part, stop: Part, step: Part, body: Any, statement: Part) -> None:
        """A loop between constants."""
        first, end, by = map(self.whole, (start, stop, step))
        forbid(by == 0 or len(range(first, end, by)) > STEPS, "a loop without an end")
        with self.scope():
            if self.unit.language == "rust":  # where the counter is a name of its own
                self.shadows[-1][name] = self.frame.get(name)
            for i in range(first, end, by):
                self.frame[name] = Variable(name, "int", (), {(): Scalar(build_number(i), "int", statement.line)})
                self.block(body)
        if self.unit.language == "matlab" and not range(first, end, by):
            empty = Unread(statement.line, "the counter of a loop without a round, which is empty")
            self.frame[name] = Variable(name, all_unread=empty)

    def run_loop(self, first: Body, test: Part, step: Body, body: Body, is_late: bool, statement: Part) -> None:
        """``for`` of C and ``while``: the condition is known from whole numbers each time."""
        with self.scope():
            for part in first:
                getattr(self, f"run_{part.kind}")(*part.parts, statement=part)
            for _ in range(ROUNDS):
                if not is_late and not self.does_go_on(test):
                    return
                self.block(body)
                for part in step:
                    getattr(self, f"run_{part.kind}")(*part.parts, statement=part)
                is_late = False
        raise Unreadable("a loop without an end")

    def does_go_on(self, test: Part) -> bool:
        """Whether a condition between whole numbers holds; others may be rounded, or depend on inputs."""
        forbid(self.written_by(test), "a loop whose condition may write")
        choices, self.choices = self.choices, None
        leaves = [side for part in walk(test) if part.kind == "compare" for side in part.parts[1:]] or [test]
        try:
            if all(is_integer(self.value(leaf)) for leaf in leaves):  # type: ignore[arg-type]
                return self.decide_known(test)
        except Unreadable:
            pass
        finally:
            self.choices = choices
        raise Unreadable("a loop that does not count from one constant to another")

    def run_return(self, value: Part | None, statement: Part) -> None:
        if value is None:
            raise Returning(None)
        self.require_order(value)
        try:
            raise Returning(self.value(value))
        except Unreadable as refusal:
            if self.written_by(value):
                raise
            if self.unit.language == "python" and value.kind == "list":
                raise Returning(Unread(value.line, "several arrays returned; ask for them by their names")) from None
            unread = refusal.leave(statement)  # the end is known, the value is not
            self.reading.refused.setdefault(unread.line, unread.why)
            self.reading.refused_spans.add(statement.span)
            raise Returning(unread) from None

    def run_do(self, call: Part, statement: Part) -> None:
        """A call for its effect."""
        self.require_order(call)
        if call.kind == "method":
            base, name, arguments = call.parts
            if name in ("setZero", "zero", "setIdentity", "identity", "fill", "setAll"):
                self.reset(base, name, arguments, statement)
                return
            if name in IN_PLACE and self.unit.language == "cpp" and not arguments:
                self.run_assign(base, "", Part("method", call.line, (base, IN_PLACE[name], ()), call.span), statement)
                return
            if self.unit.language == "cpp" and name in ("transpose", "inverse", "conjugate"):  # of some libraries
                why = f"{name} without a use of its value: it may change what it is called on"
                for known in names_in(base):
                    lose(self.variable(known), Unread(statement.line, why))
                raise Unreadable(why)
        elif call.kind == "call" and call.parts[0] in {*HARMLESS, *PURE[self.unit.language], *self.unit.ignored}:
            if self.written_by(*call.parts[1]):
                raise Unreadable(f"an argument of {call.parts[0]} that may write")
            return
        elif call.kind == "call" and call.parts[0] == "memcpy" and len(call.parts[1]) == 3:
            target, source, size = call.parts[1]
            names = [self.unit.text(part) for part in (target, source)]
            if not any(self.unit.text(size).replace(" ", "") == f"sizeof({n})" and self.is_own(n) for n in names):
                raise Unreadable("memcpy of other than sizeof an array that is declared here")
            types = [self.unit.kinds.get(re.split(r"->|\.", n)[-1], set()) for n in names_in(target, source)]
            forbid(len(set[str]().union(*types)) > 1, "memcpy between numbers of different types")
            self.run_assign(target, "", source, statement)
            return
        elif call.kind == "call" and call.parts[0] == "memset" and len(call.parts[1]) == 3:
            name, size = (self.unit.text(part).replace(" ", "").lstrip("&") for part in call.parts[1][::2])
            if size != f"sizeof({name})" or (name in self.frame and not self.is_own(name)):
                raise Unreadable("memset of other than sizeof an array that is declared here")
            self.reset(call.parts[1][0], "memset", call.parts[1][1:2], statement)
            return
        self.value(call, wants_value=False)

    def require_order(self, *parts: Part) -> None:
        """Refuse operands of C of which one call writes what another one reads: their order is open."""
        is_open = self.unit.language in ("c", "cpp")
        if is_open and (call := find_race(self.unit, parts, {*self.frame}, {*self.file_names})):
            raise Unreadable("a call that writes beside others, in an order that C leaves open", call.line)

    def is_own(self, name: str) -> bool:
        """True for an array that the function declares; a pointer has another size."""
        known = self.frame.get(name)
        return known is not None and known.name == name and any(name in table for table in self.shadows)

    def reset(self, base: Part, name: str, arguments: tuple[Part, ...], statement: Part) -> None:
        """A whole array set to one number, or to ones on the diagonal."""
        while base.kind == "address":
            base = base.parts[0]
        forbid(base.kind != "name", f"{name} of what is no variable")
        variable = self.variable(base.parts[0])
        if not variable.shape or variable.number == "quaternion":
            raise Unreadable(f"{name} of an array without a known size")
        number = self.value(arguments[0]) if arguments else Scalar(build_number(0))
        forbid(name == "memset" and constant_of(number) != 0, "memset to bytes that are not zero")
        is_identity = name in ("setIdentity", "identity")
        one = Scalar(build_number(1))
        for place in places_of(variable.shape):
            on_diagonal = is_identity and len({*place, 0} if len(place) == 1 else {*place}) == 1
            self.write_cell(variable, place, one if on_diagonal else number, statement)  # type: ignore[arg-type]
        variable.all_unread = None

    def decide(self, test: Part) -> bool:
        """Whether a condition holds in this case; one that is not read has two ways, of which nothing is known."""
        try:
            return self.decide_known(test)
        except Unreadable as refusal:
            if self.choices is None or not self.is_bold:
                raise
            self.refuse(test, refusal.leave(test))
            return self.choose(Condition(self.unit.text(test), test.line, True, f"?{len(self.conditions)}"))

    def decide_known(self, test: Part) -> bool:
        """Whether a condition holds that can be read."""
        if test.kind == "both":
            return self.decide(test.parts[0]) and self.decide(test.parts[1])
        if test.kind == "either":
            return self.decide(test.parts[0]) or self.decide(test.parts[1])
        if test.kind == "not":
            return not self.decide(test.parts[0])
        forbid(test.kind in ("refused", "list"), "a condition outside the language of audit")
        self.require_order(test)
        sign, *sides = test.parts if test.kind == "compare" else ("!=", test)
        is_size = sides[0].kind == "call" and sides[0].parts[0] in ("fabs", "fabsf")
        if is_size and sign == "<=" and self.unit.text(sides[1]) in ("DBL_MAX", "FLT_MAX"):
            return True  # numbers are real numbers here
        both = [*map(self.value, sides), Scalar(ZERO, "int")][:2]
        a, b = (demand(value, Scalar, "a condition on what is not read") for value in both)
        require_one_sign(a, b)  # -1 < 1U does not hold
        if a.tree.head == b.tree.head == NUMBER:
            return COMPARE[sign](a.tree.args[0], b.tree.args[0])
        return self.choose(Condition(self.unit.text(test), test.line, True, sign, a.tree, b.tree))

    def choose(self, condition: Condition) -> bool:
        """The way of this run at an undecided condition."""
        for way in (True, False):
            if is_contradictory((*self.conditions, replace(condition, holds=way))):
                return not way
        if self.choices is None:
            raise Unreadable(f"one of more than {CASES} cases", condition.line)
        place = len(self.conditions)
        holds = self.choices[place] if place < len(self.choices) else True
        if place >= len(self.choices):
            self.other_ways.append([*(known.holds for known in self.conditions), False])
        self.conditions.append(replace(condition, holds=holds))
        return holds
