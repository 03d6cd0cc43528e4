"""Values of the source: formulas of the inputs, arrays of them, and what could not be read."""

from __future__ import annotations

import functools
import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from typing import ClassVar, TypeVar

from navsym.audit.form import Part, Unit
from navsym.language.tree import (
    NUMBER,
    ONE,
    ZERO,
    Tree,
    build_inverse,
    build_number,
    build_power,
    build_product,
    build_sum,
    negate,
)

Index = tuple[int, ...]
Kind = TypeVar("Kind")
LARGEST = 4096  # cells of one array
TERMS = 2000  # of one sum
LARGEST_INVERSE = 4
CUT = "a real number cut to an integer"
WRAP = "numbers of which C takes one below zero for a large one"
#: Types of integers and what they hold; C counts with those of less than 32 bits as with "int".
LIMITS = {
    "bool": (0, 1), "int8": (-(2**7), 2**7 - 1), "uint8": (0, 2**8 - 1), "int16": (-(2**15), 2**15 - 1),
    "uint16": (0, 2**16 - 1), "int": (-(2**31), 2**31 - 1), "unsigned": (0, 2**32 - 1),
}  # fmt: skip


COMPARE: Mapping[str, Callable[[Fraction, Fraction], bool]] = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip


class Unreadable(Exception):
    """A part of the source that is not read: the reason, and a line where it is not that of the innermost part."""

    def __init__(self, why: str, line: int = 0):
        super().__init__(why)
        self.line, self.why = line, why

    def leave(self, part: Part) -> Unread:
        """What takes the place of the value of a part."""
        return Unread(self.line or part.line, self.why)


def forbid(condition: object, why: str, line: int = 0) -> None:
    """Raise Unreadable where a condition holds."""
    if condition:
        raise Unreadable(why, line)


def demand(value: object, kind: type[Kind], why: str) -> Kind:
    """The value, where it is of a kind."""
    if not isinstance(value, kind):
        raise Unreadable(why)
    return value


class Single:
    """What is one cell, as arrays have several."""

    __slots__ = ()
    shape: ClassVar[Index] = ()

    @property
    def cells(self) -> tuple[Cell, ...]:
        """The cell itself."""
        return (self,)  # type: ignore[return-value]


@dataclass(frozen=True, slots=True, eq=False)
class Scalar(Single):
    """A number as a formula of the inputs.

    number : "int", "unsigned" or "real"
    line   : where it was assigned, 0 for what was not
    origin : the statement that assigned it
    """

    tree: Tree
    number: str = "real"
    line: int = 0
    origin: Part | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Unread(Single):
    """A value that depends on a refused line."""

    line: int
    why: str


class Unset(Unread):
    """A cell to which nothing is assigned."""


Cell = Scalar | Unread


@dataclass(frozen=True, slots=True, eq=False)
class Array:
    """Cells row by row; a vector has one size, and so has a column of Eigen."""

    shape: Index
    cells: tuple[Cell, ...]

    def at(self, *place: int) -> Cell:
        """The cell at a place, from 0."""
        where = 0
        for size, i in zip(self.shape, place, strict=True):
            where = where * size + i
        return self.cells[where]

    def row(self, i: int) -> Array:
        """One row of a matrix."""
        return Array(self.shape[1:], self.cells[i * self.shape[1] : (i + 1) * self.shape[1]])


class Quaternion(Array):
    """The cells of a quaternion of nalgebra or Eigen: i, j, k and w, in this order."""


class List(Array):
    """A list or tuple of Python, which ``+`` joins and ``*`` repeats."""


Value = Scalar | Array | Unread


def is_integer(cell: Cell) -> bool:
    """True for a cell that holds an integer of the source."""
    return isinstance(cell, Scalar) and cell.number in LIMITS


def is_truth(value: object) -> bool:
    """True for True and False of Python."""
    return isinstance(value, Scalar) and value.number == "bool"


@dataclass(slots=True, eq=False)
class Variable:
    """What a name holds.

    shape    : None while the source does not say; () for a number
    cells    : what has been assigned, by place from 0
    is_input : True when the caller gives what has not been assigned
    views    : other names of a part of it
    """

    name: str
    number: str = "real"
    shape: Index | None = None
    cells: dict[Index, Cell] = field(default_factory=dict)
    is_input: bool = False
    all_unread: Unread | None = None
    views: list[Variable] = field(default_factory=list)


class CellView(dict[Index, Cell]):
    """The one cell of a reference, which lives in another variable."""

    def __init__(self, base: Variable, place: Index):
        super().__init__()
        self.base, self.where = base, place

    def __getitem__(self, _: Index) -> Cell:
        return self.base.all_unread if self.base.all_unread is not None else self.base.cells[self.where]

    def __setitem__(self, _: Index, cell: Cell) -> None:
        self.base.cells[self.where] = cell

    def __contains__(self, _: object) -> bool:
        return True


def lose(variable: Variable, unread: Unread) -> None:
    """Leave unread a variable, and all that share its cells."""
    waiting, met = [variable], set[int]()
    while waiting:
        current = waiting.pop()
        if id(current) not in met:
            met.add(id(current))
            current.all_unread = unread
            waiting += current.views


def lose_views(variable: Variable, unread: Unread) -> None:
    """Leave unread the other names of the cells of a variable."""
    kept = variable.all_unread
    if variable.views:
        lose(variable, unread)
        if variable not in variable.views:
            variable.all_unread = kept


def share(variable: Variable, bases: list[Variable]) -> None:
    """A variable that may share cells with others."""
    for base in bases:
        base.views.append(variable)
        variable.views.append(base)


def places_of(shape: Index) -> Iterator[Index]:
    """All places of a shape, row by row."""
    return product(*map(range, shape))


# Arithmetic: zeros and ones of loops over constant matrices disappear, numbers are joined


def add(a: Tree, b: Tree) -> Tree:
    """a + b."""
    if a is ZERO or b is ZERO:
        return b if a is ZERO else a
    if a.head == b.head == NUMBER:
        return build_number(a.args[0] + b.args[0])
    terms = (*(a.args if a.head == "+" else (a,)), *(b.args if b.head == "+" else (b,)))
    forbid(len(terms) > TERMS, f"a sum of more than {TERMS} terms")
    return build_sum(*terms)


def minus(a: Tree) -> Tree:
    """-a."""
    return build_number(-a.args[0]) if a.head == NUMBER else negate(a)


def multiply(a: Tree, b: Tree) -> Tree:
    """a b."""
    if a is ZERO or b is ZERO:
        return ZERO
    if a is ONE or b is ONE:
        return b if a is ONE else a
    return build_number(a.args[0] * b.args[0]) if a.head == b.head == NUMBER else build_product(a, b)


def divide(a: Tree, b: Tree) -> Tree:
    """a / b; also where b is zero, which has no value."""
    if b.head == NUMBER and b is not ZERO:
        return multiply(build_number(1 / b.args[0]), a) if a.head != NUMBER else build_number(a.args[0] / b.args[0])
    return multiply(a, build_inverse(b)) if b is not ONE else a


def raise_to(a: Tree, b: Tree) -> Tree:
    """a**b; a product for small whole powers of numbers."""
    if a.head == b.head == NUMBER and b.args[0].denominator == 1 and 0 < b.args[0] <= 8:
        return build_number(a.args[0] ** int(b.args[0]))
    return a if b is ONE else build_power(a, b)


def total(*trees: Tree) -> Tree:
    """The sum of trees."""
    result = ZERO
    for tree in trees:
        result = add(result, tree)
    return result


# Arrays


def map_cells(step: Callable[..., Tree], *values: Value) -> Value:
    """A function of the trees of numbers or arrays of one shape, cell by cell; numbers go with every cell."""
    shapes = {value.shape for value in values if isinstance(value, Array)}
    forbid(len(shapes) > 1, "arrays of different shapes")
    if not shapes:
        return map_cell(step, *values)  # type: ignore[arg-type]
    (shape,) = shapes
    rows = [v.cells if isinstance(v, Array) else (v,) * math.prod(shape) for v in values]
    kind = Quaternion if any(isinstance(value, Quaternion) for value in values) else Array
    return kind(shape, tuple(map_cell(step, *cells) for cells in zip(*rows, strict=True)))


def map_cell(step: Callable[..., Tree], *cells: Cell) -> Cell:
    """The same for single cells; what is unread stays so."""
    trees = []
    for cell in cells:
        if isinstance(cell, Unread):
            return cell
        trees.append(cell.tree)
    kinds = {cell.number for cell in cells if isinstance(cell, Scalar)}
    return Scalar(step(*trees), "real" if not kinds <= {"int", "unsigned"} else max(kinds, default="int"))


def find_unread(*values: Value) -> Unread | None:
    """The first of the values that is not read."""
    return next((value for value in values if isinstance(value, Unread)), None)


def make_array(shape: Index, cell: Callable[..., Cell]) -> Array:
    """An array by places."""
    forbid(math.prod(shape) > LARGEST or any(size < 0 for size in shape), f"an array of more than {LARGEST} cells")
    return Array(shape, tuple(cell(*place) for place in places_of(shape)))


def transpose(value: Value, column: bool) -> Value:
    """The transpose; of a vector the row, where the language has columns (``column``), else itself."""
    array = demand(value, Array, "the transpose of what has no known size; declare it under [code.symbols]")
    if len(array.shape) == 1:
        return Array((1, *array.shape), array.cells) if column else array
    m, n = array.shape
    return Array((n,), array.cells) if m == 1 and column else make_array((n, m), lambda i, j: array.at(j, i))


def join(*values: Value, across: bool) -> Value:
    """Matrices side by side, or below each other; a vector is a column, a number a matrix of one."""
    if (unread := find_unread(*values)) is not None:
        return unread
    blocks = [v if isinstance(v, Array) else Array((1, 1), (v,)) for v in values]
    blocks = [b if len(b.shape) == 2 else Array((*b.shape, 1), b.cells) for b in blocks]
    blocks = [b for b in blocks if b.cells]  # [] joins with everything
    sides = {block.shape[0 if across else 1] for block in blocks}
    forbid(len(sides) != 1, "blocks of different sizes side by side" if blocks else "a matrix without entries")
    if not across:
        return Array((sum(b.shape[0] for b in blocks), *sides), tuple(cell for b in blocks for cell in b.cells))
    (height,) = sides
    cells = tuple(b.at(i, j) for i in range(height) for b in blocks for j in range(b.shape[1]))
    return Array((height, sum(b.shape[1] for b in blocks)), cells)


def matrix_product(a: Value, b: Value) -> Value:
    """The product of matrices, rows and columns; a number goes with every cell."""
    if not (isinstance(a, Array) and isinstance(b, Array)):
        return map_cells(multiply, a, b)
    left = a.shape if len(a.shape) == 2 else (1, *a.shape)
    if len(a.shape) == 1 and len(b.shape) == 2 and b.shape[0] == 1:
        left = (*a.shape, 1)  # a column and a row
    right = b.shape if len(b.shape) == 2 else (*b.shape, 1)
    forbid(left[1] != right[0], "a product of matrices that do not fit")

    def cell(i: int, j: int) -> Cell:
        row = [a.cells[i * left[1] + k] for k in range(left[1])]
        column = [b.cells[k * right[1] + j] for k in range(left[1])]
        return map_cell(lambda *t: total(*(multiply(t[k], t[k + left[1]]) for k in range(left[1]))), *row, *column)

    whole = make_array((left[0], right[1]), cell)
    if left[0] == right[1] == 1 and (len(a.shape), len(b.shape)) != (2, 2):
        return whole.cells[0]
    if len(b.shape) == 1:
        return Array((left[0],), whole.cells)
    return Array((right[1],), whole.cells) if len(a.shape) == 1 and left[0] == 1 else whole


def determinant(rows: list[list[Tree]]) -> Tree:
    """By the first row."""
    if not rows:
        return ONE
    minors = [determinant([[*row[:j], *row[j + 1 :]] for row in rows[1:]]) for j in range(len(rows))]
    return total(*(multiply(x if j % 2 == 0 else minus(x), minors[j]) for j, x in enumerate(rows[0]) if x is not ZERO))


def invert(value: Value) -> Value:
    """The inverse of a small matrix, minors over the determinant; of a number its inverse."""
    if not isinstance(value, Array):
        return map_cells(lambda x: divide(ONE, x), value)
    n = value.shape[0]
    if value.shape != (n, n) or n > LARGEST_INVERSE:
        raise Unreadable(f"the inverse of what is no square matrix of at most {LARGEST_INVERSE} rows")

    def cell(i: int, j: int) -> Cell:
        def step(*trees: Tree) -> Tree:
            rows = [list(trees[k * n : k * n + n]) for k in range(n)]
            minor = determinant([[*row[:i], *row[i + 1 :]] for k, row in enumerate(rows) if k != j])
            return divide(minor if (i + j) % 2 == 0 else minus(minor), determinant(rows))

        return map_cell(step, *value.cells)

    return make_array((n, n), cell)


def cross_product(a: Value, b: Value) -> Value:
    """The cross product of two vectors of three; of two rows it is a row."""
    if not (isinstance(a, Array) and isinstance(b, Array) and len(a.cells) == len(b.cells) == 3):
        raise Unreadable("a cross product of what are no three-vectors")
    forbid(a.shape != b.shape and (1, 3) in (a.shape, b.shape), "a cross product of a row and another vector")

    def cell(i: int) -> Cell:
        j, k = (i + 1) % 3, (i + 2) % 3
        parts = (a.cells[j], b.cells[k], a.cells[k], b.cells[j])
        return map_cell(lambda p, q, r, s: add(multiply(p, q), minus(multiply(r, s))), *parts)

    return Array(a.shape if a.shape == b.shape else (3,), tuple(map(cell, range(3))))


def quaternion_product(a: Quaternion, b: Quaternion) -> Quaternion:
    """Hamilton's product."""
    (u, w), (v, s) = ((Array((3,), q.cells[:3]), q.cells[3]) for q in (a, b))
    vector = map_cells(total, map_cells(multiply, w, v), map_cells(multiply, s, u), cross_product(u, v))
    real = map_cells(lambda x, y: add(x, minus(y)), map_cells(multiply, w, s), matrix_product(u, v))
    return Quaternion((4,), (*vector.cells, *real.cells))


def rotate(quaternion: Value, vector: Value) -> Array:
    """``q*v`` of Eigen and nalgebra: v + w t + u x t, where t = 2 u x v; a rotation where q has the length one."""
    assert isinstance(quaternion, Array)
    u, w = Array((3,), quaternion.cells[:3]), quaternion.cells[3]
    t = map_cells(lambda x: multiply(build_number(2), x), cross_product(u, vector))
    parts = vector, map_cells(multiply, w, t), cross_product(u, t)
    return map_cells(total, *parts)  # type: ignore[return-value]


def square_sum(value: Value) -> Cell:
    """The sum of the squares of all cells."""
    return map_cell(lambda *trees: total(*(raise_to(t, build_number(2)) for t in trees)), *value.cells)


def identity_array(m: int, n: int) -> Array:
    """Ones on the diagonal."""
    return make_array((m, n), lambda i, j: Scalar(ONE if i == j else ZERO))


def relate_rotation(matrix: Array) -> tuple[Tree, ...]:
    """What is zero of a rotation: C C' - E, C' C - E, and c_i x c_j - c_k for its rows."""
    mirror = transpose(matrix, True)
    rows, one = [matrix.row(i) for i in range(3)], identity_array(3, 3)
    pairs: list[tuple[Value, Value]] = [(matrix_product(matrix, mirror), one), (matrix_product(mirror, matrix), one)]
    pairs += [(cross_product(rows[i], rows[(i + 1) % 3]), rows[(i + 2) % 3]) for i in range(3)]
    cells = [c for p in pairs for c in map_cells(lambda a, b: add(a, minus(b)), *p).cells]  # type: ignore[union-attr]
    return tuple(dict.fromkeys(cell.tree for cell in cells if isinstance(cell, Scalar)))


def constant_of(value: Value) -> Fraction | None:
    """The number that a value is, or None."""
    return Fraction(value.tree.args[0]) if isinstance(value, Scalar) and value.tree.head == NUMBER else None


# The operators of the languages


def whole_kind(text: str) -> str:
    """The name in LIMITS of a type of integers of C or Rust."""
    bits = next((bits for mark, bits in (("8", 8), ("char", 8), ("16", 16), ("short", 16)) if mark in text), 0)
    if text == "bool":
        return "bool"
    is_unsigned = text.startswith(("u", "size_t"))
    return f"{'u' * is_unsigned}int{bits}" if bits else "unsigned" if is_unsigned else "int"


def number_type(text: str) -> str:
    """The type of the numbers in a matrix of Eigen, which has one for each size; other types as they are."""
    pattern = r"(?:\w+::)*(?:Row)?(?:Matrix|Vector|Quaternion)\w*?(?:([fd])|<(\w+)\b.*>)"
    found = re.fullmatch(pattern, text.replace(" ", ""))
    return text if found is None else found[2] or {"f": "float", "d": "double"}[found[1]]


def promote(kind: str) -> str:
    """The type in which C counts with a number of a type."""
    return "int" if kind in LIMITS and kind != "unsigned" else kind


def does_fit(cell: Scalar, kind: str) -> bool:
    """True for what a variable of a type of integers holds as it is; others than constants fit in one of 32 bits."""
    exact, (low, high) = constant_of(cell), LIMITS[kind]
    if exact is None:
        return cell.number in LIMITS and kind == promote(cell.number)
    return exact.denominator == 1 and low <= exact <= high


def require_fit(unit: Unit, value: Value) -> Value:
    """The value, where no constant among its integers is past the ends of its type."""
    for cell in value.cells if unit.rules.integer else ():
        if isinstance(cell, Scalar) and cell.number in LIMITS and not does_fit(cell, cell.number):
            raise Unreadable("integers that do not fit their type")
    return value


def as_real(value: Value) -> Value:
    """Not an integer any more."""
    if isinstance(value, Array):
        return type(value)(value.shape, tuple(as_real(cell) for cell in value.cells))  # type: ignore[misc]
    return replace(value, number="real") if isinstance(value, Scalar) else value


def convert(value: Value, number: str, line: int) -> Value:
    """A returned number in the type that a function returns."""
    if not isinstance(value, Scalar) or number not in (*LIMITS, "real"):
        return value
    if number != "real" and not does_fit(value, number):
        return Unread(line, CUT)
    return replace(value, number=promote(number))


def combine(unit: Unit, sign: str, a: Value, b: Value) -> Value:
    """The arithmetic of a language."""
    require_one_sign(a, b)
    result = operate(unit, sign, a, b)
    return require_fit(unit, result if sign != "-" else require_no_wrap(result))


def require_one_sign(*values: Value) -> None:
    """Refuse unsigned numbers beside one that may be below zero, which C takes for a large one."""
    whole = [cell for value in values for cell in value.cells if isinstance(cell, Scalar) and cell.number in LIMITS]
    others = [constant_of(cell) for cell in whole if cell.number != "unsigned"]
    forbid(len(others) < len(whole) and any(number is None or number < 0 for number in others), WRAP)


def require_no_wrap(value: Value) -> Value:
    """A difference, which may be below zero: of unsigned numbers it has another value there."""
    if isinstance(value, Scalar) and value.number == "unsigned" and constant_of(value) is None:
        raise Unreadable("a difference of unsigned numbers, which may wrap round")
    return value


def operate(unit: Unit, sign: str, a: Value, b: Value) -> Value:
    """The same, whatever fits."""
    if (unread := find_unread(a, b)) is not None:
        return unread
    both, rules = isinstance(a, Array) and isinstance(b, Array), unit.rules
    if unit.language == "c" and (isinstance(a, Array) or isinstance(b, Array)):
        raise Unreadable("arithmetic with an array, which is a pointer in C")
    if (isinstance(a, List) or isinstance(b, List)) and (joined := join_lists(sign, a, b)) is not None:
        return joined
    if sign in ("*", "@"):
        kinds = [isinstance(value, Quaternion) for value in (a, b)]
        if isinstance(a, Quaternion) and isinstance(b, Quaternion):
            return quaternion_product(a, b)
        if kinds == [True, False] and both and unit.language in ("cpp", "rust") and b.shape == (3,):  # type: ignore[union-attr]
            return rotate(a, b)
        forbid(both and any(kinds), "the product of a quaternion and a vector")
        if both and unit.language == "rust" and len(a.shape) == len(b.shape) == 1:  # type: ignore[union-attr]
            raise Unreadable("the product of two columns")
        forbid(sign == "@" and not both, "a product of matrices of unknown size; declare them under [code.symbols]")
        return matrix_product(a, b) if both and (sign == "@" or rules.matrix) else map_cells(multiply, a, b)
    if sign in ("+", "-"):
        if unit.language == "cpp" and isinstance(a, Array) != isinstance(b, Array):
            raise Unreadable("the sum of a number and a matrix")
        return map_cells(add if sign == "+" else lambda x, y: add(x, minus(y)), a, b)
    if sign in (".*", "./", ".^"):
        return map_cells({".*": multiply, "./": divide, ".^": raise_to}[sign], a, b)
    if sign != "**":
        return quotient(unit, sign, a, b)
    if not rules.matrix or not (isinstance(a, Array) or isinstance(b, Array)):
        return map_cells(raise_to, a, b)
    times = constant_of(b)
    if times is None or times.denominator != 1 or not 0 < times < 9 or a.shape != a.shape[:1] * 2:  # type: ignore[union-attr]
        raise Unreadable("the power of a matrix")
    factors: list[Value] = [a] * int(times)
    return functools.reduce(matrix_product, factors)


def join_lists(sign: str, a: Value, b: Value) -> Value | None:
    """``[x, y] + [z]`` and ``[x]*3``; None where one side is an array of numpy."""
    pair = [value for value in (a, b) if isinstance(value, List)]
    times = constant_of(b if isinstance(a, List) else a)
    (size, *rest), cells = pair[0].shape, pair[0].cells
    if len(pair) == 2 and sign == "+" and [*pair[1].shape[1:]] == rest:
        return List((size + pair[1].shape[0], *rest), cells + pair[1].cells)
    forbid(len(pair) == 1 and sign == "*" and rest, "a list repeated in a list, which shares its rows")
    if len(pair) == 1 and sign == "*" and times is not None and times.denominator == 1 and 0 < times <= LARGEST:
        return List((size * int(times), *rest), cells * int(times))
    if len(pair) == 2 or not (isinstance(a, Array) and isinstance(b, Array)):
        raise Unreadable("arithmetic of a list, which is no array")
    return None


def quotient(unit: Unit, sign: str, a: Value, b: Value) -> Value:
    """A quotient; of integers it is cut in C, which is read for constants only."""
    if isinstance(b, Array) and unit.rules.matrix:
        forbid(unit.language != "matlab" or len(b.shape) != 2, "division by a matrix")
        return matrix_product(a, invert(b))
    whole = [isinstance(v, Scalar) and v.number in LIMITS for v in (a, b)]
    if sign == "/" and not (unit.rules.integer and all(whole)):
        return as_real(map_cells(divide, a, b))
    forbid(sign not in ("/", "//", "%"), f"the operator {sign}")
    x, y = constant_of(a), constant_of(b)
    if x is None or y is None or y == 0 or not all(whole) or x < 0 or y < 0:
        raise Unreadable("a quotient or remainder of integers that are no constants")
    return Scalar(build_number(x // y if sign != "%" else x % y), "int")
