"""Units of formulas: inferred for every symbol from the declared ones; a meaningless sum is an error.

The exponents of a product are the sums of those of its factors, terms of a sum have the same, what a sine or an
exponential is taken of has none: linear equations, solved exactly as they come. A symbol without a unit is an unknown,
each entry of a vector or matrix by itself. Where no unit is declared, nothing is said. The radian is 1.

Scales (km beside m, degrees) are looked at in a second pass, where a number such as 1000 or pi/180 may convert.

Numbers of a formula have no unit. Those of models and of source code often have one, which nobody wrote: with ``loose``
a number that is added, compared or chosen has that of its neighbours, and as a factor each has an unknown one, except
whole numbers up to 12 and their quotients, which stay numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import chain, permutations
from typing import Any

from navsym.core.errors import DomainError
from navsym.core.units import Powers, combine, print_unit, read_unit
from navsym.language.domains import rational_value
from navsym.language.names import FUNCTIONS
from navsym.language.printer import TIGHT, WHOLE, Text, Writer
from navsym.language.shapes import Shape
from navsym.language.tree import (
    NUMBER,
    POWER,
    PRODUCT,
    SUM,
    SYMBOL,
    ZERO,
    Tree,
    build,
    list_names,
    list_parts,
    parts_of,
)
from navsym.language.vectors import BINDERS, INFINITE, RELATIONS

#: The unit of a part: ("unit", base) and ("name", symbol) -> exponent. None is zero, which has every unit.
Form = dict[tuple[str, Any], Fraction]
Cell = Form | None
#: A number has one cell, an array a list of rows.
Units = list[list[Cell]]

NUMBERS = 12  # whole numbers up to here, and their quotients, convert no unit
TIME = "t"
ONLY_ALIKE, ALIKE = ("atan2",), ("min", "max")


class ConflictError(Exception):
    """Two units that are not one: their forms."""


class System:
    """Linear equations between exponents, each solved for one unknown as it comes."""

    def __init__(self) -> None:
        self.solved: dict[tuple[str, Any], Form] = {}

    def reduce(self, form: Form) -> Form:
        """The form without the unknowns that are known."""
        return combine((self.solved.get(key, {key: Fraction(1)}), n) for key, n in form.items())  # type: ignore[misc,arg-type,return-value]

    def equate(self, x: Form, y: Form) -> None:
        """Both are one unit; raises ConflictError where they cannot be."""
        rest = self.reduce(combine([(x, 1), (y, -1)]))  # type: ignore[list-item,arg-type]
        free = [key for key in rest if key[0] != "unit"]
        if not free:
            if rest:
                raise ConflictError
            return
        # A number that may convert has a scale and no dimension: it is solved for before the symbols.
        chosen = min(free, key=lambda key: key[0] != "number")
        share = rest.pop(chosen)
        value = combine([(rest, Fraction(-1) / share)])  # type: ignore[list-item]
        for key, form in self.solved.items():
            if chosen in form:
                more = form.pop(chosen)
                self.solved[key] = combine([(form, 1), (value, more)])  # type: ignore[list-item,assignment]
        self.solved[chosen] = value  # type: ignore[assignment]


class PlainWriter(Writer):
    """Trees of the whole language as text, for messages."""

    def spell(self, part: Tree, inner: list[Text]) -> Text:
        """A part from the texts of its own parts."""
        texts = [text.text for text in inner]
        if part.head == "@":
            return Text(f"{self.enclose(inner[0], TIGHT)} @ {self.enclose(inner[1], WHOLE)}", TIGHT)
        if part.head == "T":
            return Text(f"{self.enclose(inner[0], WHOLE)}.T", WHOLE)
        if part.head == "index":
            return Text(f"{self.enclose(inner[0], WHOLE)}[{','.join(texts[1:])}]", WHOLE)
        if part.head in ("row", "matrix"):
            bare = part.head == "row" and len(texts) == 1
            return Text(texts[0] if bare else f"[{', '.join(texts)}]", WHOLE)
        if part.head in RELATIONS:
            return Text(f"{texts[0]} {part.head} {texts[1]}", WHOLE)
        return super().spell(part, inner)


def print_part(tree: Tree) -> str:
    """A part as text, cut for a message."""
    text = PlainWriter().whole(tree)
    return text if len(text) <= 60 else f"{text[:60]}..."


class Inference:
    """The units of the parts of some formulas.

    declared : name -> powers of the unit, of every entry of a vector or matrix
    scales   : look at scales, and not at dimensions
    loose    : numbers may have units
    """

    def __init__(self, shapes: Mapping[str, Shape], declared: Mapping[str, Powers], scales: bool, loose: bool):
        self.shapes, self.scales, self.loose, self.where = shapes, scales, loose, ""
        self.bare = dict[Tree, bool]()  # numbers, and whether they are 0
        self.declared = {name: self.project(powers) for name, powers in declared.items()}
        self.system = System()
        self.numbers = 0

    def project(self, powers: Powers) -> Form:
        """The part of a unit that this pass looks at."""
        return {("unit", k): n for k, n in powers.items() if (not isinstance(k, str) or k == "pi") == self.scales}

    # Symbols and numbers

    def symbol(self, name: str) -> Units:
        """The unit of a name, of each entry of an array."""
        shape = self.shapes.get(name)
        rows = shape.rows if shape is not None and shape.rows else ((name,),)
        pure = shape is not None and (
            shape.kind == "rotation" or any("dot(" in r for r in shape.relations) or is_integer(shape)
        )
        if name in self.declared or pure:
            return [[self.declared.get(name, {}) for _ in row] for row in rows]
        return [[{("name", entry): Fraction(1)} for entry in row] for row in rows]

    def is_small(self, part: Tree) -> bool:
        """Whether no unit is hidden in a number."""
        if part.head == NUMBER:
            return max(abs(part.args[0].numerator), part.args[0].denominator) <= NUMBERS
        return all(map(self.is_small, parts_of(part))) and not (self.scales and part.head == "pi")

    def number(self, part: Tree, beside: str) -> Cell:
        """A number beside others; one that may convert units, or have one, is an unknown of its own."""
        if self.bare[part] or (self.loose and beside in NEIGHBOURS):
            return None
        if self.is_small(part) or not (self.scales or self.loose):
            return {}
        self.numbers += 1
        return {("number", self.numbers): Fraction(1)}

    # Equations

    def equate(self, x: Cell, y: Cell, what: str, left: Tree, right: Tree) -> Cell:
        """Two parts have one unit, which is returned."""
        if x is None or y is None:
            return x if y is None else y
        try:
            self.system.equate(x, y)
        except ConflictError:
            got = f"{print_part(left)} in {self.show(x)} and {print_part(right)} in {self.show(y)}"
            message = f"expected {what} of one unit; got {got}; correct one of them"
            raise DomainError(message, where=self.where) from None
        return x

    def plain(self, x: Cell, part: Tree, what: str) -> None:
        """A part has no unit."""
        try:
            self.system.equate(x or {}, {})
        except ConflictError:
            message = f"expected {what} of a number without unit; got {print_part(part)} in {self.show(x or {})}"
            remedy = "convert it to radians" if self.scales else "divide by a quantity of its unit"
            raise DomainError(f"{message}; {remedy}", where=self.where) from None

    def show(self, form: Form) -> str:
        """A unit in words."""
        reduced = self.system.reduce(form)
        powers: Powers = {key[1]: n for key, n in reduced.items() if key[0] == "unit"}
        unknown = [(key[1], n) for key, n in reduced.items() if key[0] == "name"]
        names = [f"the unit of {name}" + ("" if n == 1 else f"^{n}") for name, n in unknown]
        return " ".join([print_unit(powers), *names]) + " times the base unit" * self.scales

    def total(self, cells: Iterable[tuple[Cell, Tree]], what: str) -> Cell:
        """The unit of a sum."""
        first: tuple[Cell, Tree] | None = None
        for cell, part in cells:
            if cell is None:
                continue
            if first is not None:
                self.equate(first[0], cell, what, first[1], part)
            first = first or (cell, part)
        return first[0] if first else None

    # Parts

    def units_of(
        self, trees: Sequence[Tree], places: Sequence[str], refused: list[DomainError] | None = None
    ) -> dict[Tree, Units]:
        """The units of all parts, entry by entry; what is refused is raised, or put into the list and passed over."""
        values: dict[Tree, Units] = {}
        for self.where, part in list_places(trees, places):
            try:
                values[part] = self.step(part, [values[inner] for inner in parts_of(part)])
            except DomainError as error:
                if refused is None:
                    raise
                refused.append(error)
                values[part] = [[None]]
        return values

    def step(self, part: Tree, inner: list[Units]) -> Units:
        """The units of a part from those of its own parts."""
        head = part.head
        if head in PLAIN and all(p in self.bare for p in parts_of(part)):
            zeros = [self.bare[p] for p in parts_of(part)]
            self.bare[part] = (head == PRODUCT and any(zeros)) or (head == SUM and all(zeros)) or part is ZERO
            return [[self.number(part, "")]]
        inner = [[[self.number(p, head)]] if p in self.bare else x for p, x in zip(parts_of(part), inner, strict=True)]
        if head == SYMBOL:
            return [[None]] if part.args[0] == INFINITE else self.symbol(part.args[0])
        if head == SUM:
            return self.each(part, inner, "terms")
        if head == PRODUCT:
            return self.product(inner)
        if head == POWER:
            return [[self.power(part, inner[0][0][0], inner[1][0][0])]]
        if head in RELATIONS:
            self.relate(part, inner)
            return [[{}]]
        if head in BINDERS:
            others = [units[0][0] for units in inner[1:]]
            return [[self.bound(part, [cell, *others]) for cell in row] for row in inner[0]]
        if head in STEPS:
            return STEPS[head](self, part, inner)
        if head in (*FUNCTIONS, "erf", "floor"):
            self.plain(inner[0][0][0], part.args[0], head)
            return [[{}]]
        return inner[0] if inner else [[{}]]

    def each(self, part: Tree, inner: list[Units], what: str) -> Units:
        """Entry by entry the one unit of all parts."""
        cells = [[*zip(*rows, strict=False)] for rows in zip(*inner, strict=False)]
        return [[self.total(zip(cell, part.args, strict=True), what) for cell in row] for row in cells]

    def product(self, inner: list[Units]) -> Units:
        """Numbers and at most one array."""
        array, *others = sorted(inner, key=lambda units: -len(units) * len(units[0]))  # equal factors are one object
        return [[multiply(cell, *(units[0][0] for units in others)) for cell in row] for row in array]

    def power(self, part: Tree, base: Cell, exponent: Cell) -> Cell:
        """A power: with an exponent that is no number the base has no unit, unless the exponent is a whole number."""
        if (number := rational_value(part.args[1])) is not None:
            return None if base is None else scale(base, number)
        self.plain(exponent, part.args[1], "an exponent")
        if all(map(self.is_whole, list_names(part.args[1]))):
            self.numbers += 1
            return {("name", f"power {self.numbers}"): Fraction(1)} if base else base
        self.plain(base, part.args[0], "a power with a symbol as exponent")
        return {}

    def is_whole(self, name: str) -> bool:
        """Whether a name is declared as a whole number."""
        return name in self.shapes and is_integer(self.shapes[name])

    def relate(self, part: Tree, inner: list[Units]) -> None:
        """Both sides of a relation; a number beside a quantity may be a value of it in the units of the author."""
        if part.head in ("=", "!=") or self.bare.keys().isdisjoint(part.args):
            self.each(part, inner, "two sides")

    def bound(self, part: Tree, cells: list[Cell]) -> Cell:
        """Integrals, sums, products and limits: their ends are in the unit of their variable."""
        value, variable = cells[0], cells[1]
        for cell, end in zip(cells[2:], part.args[2:], strict=True):
            self.equate(variable, cell, "an end and its variable", part.args[1], end)
        if part.head == "integral":
            return multiply(value, variable)
        if part.head == "product" and value:
            self.numbers += 1
            return {("name", f"power {self.numbers}"): Fraction(1)}
        return value

    def alike(self, column: Units, part: Tree) -> Cell:
        """The one unit of the entries of a column."""
        return self.total(((row[0], part) for row in column), "entries")

    # Functions, by the name of the head

    def step_expm(self, part: Tree, inner: list[Units]) -> Units:
        """Every power of the matrix has its units; an entry that no power has is an unknown."""
        A, square = inner[0], self.times(inner[0], inner[0], part)
        whole = self.each(build("+", (part, part, part)), [A, square, diagonal([{}] * len(A))], "powers of a matrix")
        self.numbers += 1
        name = f"expm {self.numbers}"
        return [
            [{("name", f"{name} {i} {j}"): Fraction(1)} if cell is None else cell for j, cell in enumerate(row)]
            for i, row in enumerate(whole)
        ]

    def step_alike(self, part: Tree, inner: list[Units]) -> Units:
        cell = self.total(((units[0][0], p) for units, p in zip(inner, part.args, strict=True)), "arguments")
        return [[{} if part.head in ONLY_ALIKE else cell]]

    def step_index(self, part: Tree, inner: list[Units]) -> Units:
        places = [int(p.args[0]) - 1 for p in part.args[1:]]
        return [[inner[0][places[0]][places[1] if len(places) > 1 else 0]]]

    def times(self, A: Units, B: Units, part: Tree) -> Units:
        """A matrix product, whose every entry is a sum."""

        def cell(row: list[Cell], column: list[Cell]) -> Cell:
            return self.total(((multiply(a, b), part) for a, b in zip(row, column, strict=True)), "terms")

        columns = transpose(B)
        return [[cell(row, column) for column in columns] for row in A]

    def step_cross(self, part: Tree, inner: list[Units]) -> Units:
        self.alike(inner[1], part.args[1])
        return self.times(self.step_skew(part, inner), inner[1], part)

    def step_skew(self, part: Tree, inner: list[Units]) -> Units:
        self.alike(inner[0], part.args[0])  # the entries of a vector in space have one unit
        x, y, z = (row[0] for row in inner[0])
        return [[None, z, y], [z, None, x], [y, x, None]]

    def determinant(self, A: Units, part: Tree) -> Cell:
        """The unit of a determinant: each of its terms has it."""
        terms = (multiply(*(A[i][j] for i, j in enumerate(order))) for order in permutations(range(len(A))))
        return self.total(((term, part) for term in terms), "terms of a determinant")

    def step_inv(self, part: Tree, inner: list[Units]) -> Units:
        A = inner[0]
        whole = self.determinant(A, part)
        if whole is None:
            name, side = print_part(part), range(len(A))
            return [[{("name", f"{name} {i} {j}"): Fraction(1)} for j in side] for i in side]

        def entry(i: int, j: int) -> Cell:
            minor = [[cell for c, cell in enumerate(row) if c != i] for r, row in enumerate(A) if r != j]
            cofactor = self.determinant(minor, part)
            return multiply(cofactor, scale(whole, Fraction(-1)))

        return [[entry(i, j) for j in range(len(A))] for i in range(len(A))]

    def step_qmul(self, part: Tree, inner: list[Units]) -> Units:
        p, q = ([row[0] for row in units] for units in inner)
        return [[self.total(((multiply(p[a], q[a ^ i]), part) for a in range(4)), "terms")] for i in range(4)]

    def step_rot(self, part: Tree, inner: list[Units]) -> Units:
        square = self.total(((multiply(row[0], row[0]), part) for row in inner[0]), "terms")
        return [[square] * 3 for _ in range(3)]

    def step_diff(self, part: Tree, inner: list[Units]) -> Units:
        times = int(part.args[2].args[0]) if len(part.args) > 2 else 1
        by = scale(inner[1][0][0] or {}, Fraction(-times))
        return [[multiply(cell, by) for cell in row] for row in inner[0]]

    def by_time(self, units: Units) -> Units:
        """A rate: the time is the symbol t, whose unit may be unknown."""
        rate = scale(self.symbol(TIME)[0][0] or {}, Fraction(-1))
        return [[multiply(cell, rate) for cell in row] for row in units]


#: Heads of numbers, if their parts are numbers, and those whose numbers have the unit of their neighbours.
PLAIN = {NUMBER, "pi", SUM, PRODUCT, POWER, *FUNCTIONS}
NEIGHBOURS = {SUM, "where", *ONLY_ALIKE, *ALIKE, *RELATIONS}
#: Head of a call -> its units, from the call and the units of its parts.
STEPS: dict[str, Callable[[Inference, Tree, list[Units]], Units]] = {
    "sqrt": lambda s, _, u: [[None if u[0][0][0] is None else scale(u[0][0][0], Fraction(1, 2))]],
    "sign": lambda s, _, u: [[{}]],
    **dict.fromkeys(("abs", "conj"), lambda s, _, u: u[0]),
    **dict.fromkeys((*ONLY_ALIKE, *ALIKE), Inference.step_alike),
    **dict.fromkeys(("T", "transpose"), lambda s, _, u: transpose(u[0])),
    "row": lambda s, _, u: [[units[0][0] for units in u]],
    "matrix": lambda s, _, u: [units[0] for units in u],
    "where": lambda s, part, u: [
        [s.equate(x, y, "two cases", *part.args[1:]) for x, y in zip(*rows, strict=True)]
        for rows in zip(*u[1:], strict=True)
    ],
    "eye": lambda s, part, _: diagonal([{}] * int(part.args[0].args[0])),
    "diag": lambda s, _, u: diagonal([row[0] for units in u for row in units]),
    "zeros": lambda s, part, _: [[None] * int(part.args[-1].args[0]) for _ in range(int(part.args[0].args[0]))],
    "@": lambda s, part, u: s.times(u[0], u[1], part),
    "dot": lambda s, part, u: s.times(transpose(u[0]), u[1], part),
    "cov": lambda s, part, u: s.times(u[0], transpose(u[-1]), part),
    "norm": lambda s, part, u: [[s.alike(u[0], part)]],
    "trace": lambda s, part, u: [[s.total(((row[i], part) for i, row in enumerate(u[0])), "entries")]],
    "det": lambda s, part, u: [[s.determinant(u[0], part)]],
    "dot_": lambda s, _, u: s.by_time(u[0]),
    "index": Inference.step_index, "cross": Inference.step_cross, "skew": Inference.step_skew,
    "inv": Inference.step_inv, "expm": Inference.step_expm, "qmul": Inference.step_qmul,
    "rot": Inference.step_rot, "diff": Inference.step_diff,
}  # fmt: skip


def transpose(units: Units) -> Units:
    """Columns as rows."""
    return [list(column) for column in zip(*units, strict=True)]


def diagonal(cells: Sequence[Cell]) -> Units:
    """A matrix that is zero beside its diagonal."""
    return [[cell if i == j else None for j in range(len(cells))] for i, cell in enumerate(cells)]


def multiply(*cells: Cell) -> Cell:
    """The unit of a product; zero times anything is zero."""
    if any(cell is None for cell in cells):
        return None
    return combine((cell, 1) for cell in cells)  # type: ignore[misc,return-value]


def scale(form: Form, exponent: Fraction) -> Form:
    """A power of a unit."""
    return combine([(form, exponent)])  # type: ignore[list-item,return-value]


def is_integer(shape: Shape) -> bool:
    """Whether a name is declared as a whole number."""
    return any("integer" in limits[2] for limits in shape.ranges.values())


def infer_units(
    trees: Sequence[Tree],
    shapes: Mapping[str, Shape],
    rates: Mapping[str, Tree] | None = None,
    *,
    where: str | Sequence[str] = "",
    loose: bool = False,
    refused: list[DomainError] | None = None,
) -> dict[str, str]:
    """The units of all names of some formulas, as far as the declared ones settle them.

    trees   : relations, or parts whose own sums are looked at
    shapes  : name -> declaration, with ``unit`` where there is one
    rates   : name -> its derivative by the time t
    where   : of all formulas, or of each
    loose   : numbers may have units, as in source code
    refused : where errors go, so that the others are found too

    Returns name (of an entry, for an array) -> unit. Raises DomainError that names two parts whose units differ where
    they should be one; says nothing where no unit is declared.

    >>> from navsym.language.shapes import read_shape
    >>> from navsym.language.vectors import read_hypothesis
    >>> table = {"v": {"unit": "m/s"}, "T": {"unit": "s"}, "a": {}}
    >>> shapes = {name: read_shape(name, value, (), "")[0] for name, value in table.items()}
    >>> infer_units([read_hypothesis("v = a*T", dict.fromkeys(shapes))], shapes)
    {'v': 'm/s', 'a': 'm/s^2', 'T': 's'}
    """
    names = {*list_names(*trees, *(rates or {}).values()), TIME, *(rates or {})}
    known = [shapes[name] for name in sorted(names & set(shapes))]
    declared = {shape.name: read_unit(shape.unit) for shape in known if shape.unit}
    if not declared or any(shape.sizes for shape in known):
        return {}
    passes = [False]
    if any(not isinstance(key, str) or key == "pi" for powers in declared.values() for key in powers):
        passes.append(True)
    places = [where] * len(trees) if isinstance(where, str) else where
    found: dict[str, Powers] = {}
    for scales in passes:
        inference = Inference(shapes, declared, scales, loose)
        for name, rate in (rates or {}).items():
            own, units = inference.by_time(inference.symbol(name)), inference.units_of([rate], [""])[rate]
            for x, y in zip(chain(*own), chain(*units), strict=True):
                inference.equate(x, y, f"the rate of {name} and its formula", rate, rate)
        inference.units_of(trees, places, refused)
        if refused:
            return {}
        for entry, form in list_forms(trees, inference):
            reduced = inference.system.reduce(form)
            if all(key[0] == "unit" for key in reduced):
                found[entry] = combine([(found.get(entry, {}), 1), ({key[1]: n for key, n in reduced.items()}, 1)])
            else:
                found.pop(entry, None)
    return {entry: print_unit(powers) for entry, powers in found.items()}


def list_places(trees: Sequence[Tree], places: Sequence[str]) -> Iterator[tuple[str, Tree]]:
    """Every part once, behind its own parts, with the place of the first tree that has it."""
    met, k = set[Tree](), 0
    for part in list_parts(*trees):
        while trees[k] in met:
            k += 1
        met.add(part)
        yield places[k], part


def list_forms(trees: Sequence[Tree], inference: Inference) -> Iterator[tuple[str, Form]]:
    """The names of entries with their forms."""
    for part in list_parts(*trees):
        if part.head == SYMBOL and part.args[0] != INFINITE:
            shape = inference.shapes.get(part.args[0])
            rows = shape.rows if shape is not None and shape.rows else ((part.args[0],),)
            yield from zip(chain(*rows), chain(*inference.symbol(part.args[0])), strict=True)  # type: ignore[misc]
