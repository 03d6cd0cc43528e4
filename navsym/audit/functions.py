"""The functions of numbers and arrays that estimator code calls, by their names in each language."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from fractions import Fraction

from navsym.audit.form import Function, Part, Unit, walk
from navsym.audit.values import (
    LARGEST_INVERSE,
    Array,
    List,
    Quaternion,
    Scalar,
    Unreadable,
    Value,
    add,
    as_real,
    constant_of,
    cross_product,
    demand,
    determinant,
    divide,
    find_unread,
    forbid,
    identity_array,
    invert,
    join,
    make_array,
    map_cell,
    map_cells,
    matrix_product,
    minus,
    multiply,
    operate,
    raise_to,
    rotate,
    square_sum,
    total,
    transpose,
)
from navsym.language.tree import ONE, PI, ZERO, Tree, build_call, build_inverse, build_number

CONSTANTS: dict[str, Tree] = dict.fromkeys(("M_PI", "math.pi", "np.pi", "numpy.pi", "pi", "M_PI_F", "PI"), PI)
CONSTANTS |= dict.fromkeys(("M_PI_2", "M_PI_2_F"), multiply(build_number(Fraction(1, 2)), PI))
TWICE = build_number(2)
#: Functions of numpy that give another name of their argument.
VIEWS = ("asarray", "transpose")
HARMLESS = frozenset(("printf", "fprintf", "print", "assert", "disp", "static_assert", "puts"))
#: Functions without a formula that write nothing, by language.
PURE = {
    "c": frozenset("isnan isfinite isinf".split()),
    "cpp": frozenset("isnan isfinite isinf std::isnan std::isfinite std::isinf".split()),
    "python": frozenset(
        "isinstance len hasattr callable type np.isscalar np.any np.all np.isnan np.isfinite np.shape np.ndim "
        "np.isclose np.allclose math.isnan math.isinf".split()
    ),
    "matlab": frozenset("isinf isnan isempty any all numel length size strcmp strcmpi nargin ischar isfield".split()),
    "rust": frozenset(),
}
#: Names that are no real numbers: functions that MATLAB calls without parentheses, what is infinite or not a number.
NAMED_CALLS = {
    "c": frozenset("NAN INFINITY HUGE_VAL HUGE_VALF".split()), "cpp": frozenset("NAN INFINITY HUGE_VAL".split()),
    "matlab": frozenset(
        "rand randn randi tic toc now clock cputime input NaN nan NA Inf inf i j I J e eps realmin realmax flintmax "
        "ans zeros ones eye".split()
    ),
    "python": frozenset(f"{m}.{name}" for m in ("np", "numpy", "math") for name in "nan NaN inf Inf".split()),
    "rust": frozenset(f"{f}::{name}" for f in ("f32", "f64") for name in "NAN INFINITY NEG_INFINITY".split()),
}  # fmt: skip
PREFIX = re.compile(r"\A(std::|::|math\.|np\.|numpy\.|matrix::|Eigen::)")
#: The larger or the smaller of two numbers.
EXTREMES = {
    "c": r"fm(ax|in)f?", "cpp": r"(std::|::|matrix::|Eigen::)?fm(ax|in)f?|std::m(ax|in)", "matlab": r"m(ax|in)",
    "python": r"((math|np|numpy)\.)?m(ax|in)imum|m(ax|in)", "rust": r"fm(ax|in)",
}  # fmt: skip
#: With one of these ``abs`` of C++ is that of real numbers, too.
ABS_OF_REALS = re.compile(rb"using\s+(namespace\s+std|std::abs)\s*;|<math\.h>|<stdlib\.h>|<Eigen/")
Known = Callable[..., Value]
MAKE = re.compile(r"(?:^|::)Mat(?:rix)?(?:(\d)[fd]?|<\w+,(\d+),(\d+)>|X[fd]?)::(Zero|Identity)$")


def bare_name(name: str) -> str:
    """A name of a function without namespace, module and the suffix f of C."""
    bare = PREFIX.sub("", name, count=1)
    return bare[:-1] if bare.endswith("f") and bare[:-1] in NUMBERS else bare


def names_view(name: str) -> bool:
    """True for a function of numpy that gives another name of its argument."""
    return bare_name(name) in VIEWS


def is_known(name: str, language: str) -> bool:
    """True for a function that has a meaning of its own in the language."""
    if language == "python" and PREFIX.match(name) is None and name != "abs":
        return False
    return bare_name(name) in NAMES[language] or (language == "cpp" and MAKE.search(name) is not None)


def does_take(name: str, count: int, language: str) -> bool:
    """True for a known function that only reads so many arguments; one more of numpy is where it writes."""
    most = max((n for known, n in KNOWN if known == bare_name(name)), default=2)
    return is_known(name, language) and (language != "python" or count <= most)


def may_return_view(unit: Unit, function: Function, around: tuple[Function, ...] = ()) -> bool:
    """True for a function of Python that may return what it was given, or a part of it."""
    fresh = {"op", "minus", "number", "compare", "refused"}
    values = dict[str, list[Part]]()
    for part in walk(*function.body):
        if part.kind == "assign" and part.parts[0].kind == "name" and not part.parts[1]:
            values.setdefault(part.parts[0].parts[0], []).append(part.parts[2])
    given = {argument.name for argument in function.arguments}

    def may_share(value: Part, met: frozenset[str] = frozenset()) -> bool:
        if value.kind == "name" and value.parts[0] in values.keys() - given - met:
            name = value.parts[0]
            return any(may_share(v, met | {name}) for v in values[name])
        if value.kind == "call":
            return is_view(unit, value, (*around, function))
        return value.kind not in fresh

    returned = (p.parts[0] for p in walk(*function.body) if p.kind == "return")
    return function in around or any(value is not None and may_share(value) for value in returned)


def is_view(unit: Unit, value: Part, around: tuple[Function, ...] = ()) -> bool:
    """True for an expression of Python whose value may share cells with an array in it."""
    if value.kind != "call":
        return value.kind in ("index", "method", "choose")
    functions = unit.functions.get(value.parts[0], [])
    return names_view(value.parts[0]) or any(may_return_view(unit, function, around) for function in functions)


def extreme_of(name: str, language: str) -> str:
    """``>=`` for a name of the larger of two numbers, ``<=`` for one of the smaller; else nothing."""
    return "" if not re.fullmatch(EXTREMES[language], name) else ">=" if "max" in name else "<="


def call_known(name: str, values: Sequence[Value], unit: Unit) -> Value:
    """The value of a known function."""
    if (unread := find_unread(*values)) is not None:
        return unread
    if unit.language == "cpp" and name == "abs" and ABS_OF_REALS.search(unit.source) is None:
        raise Unreadable("abs, which cuts to an integer beside <cmath>; std::abs does not")
    values = [Array(value.shape, value.cells) if isinstance(value, List) else value for value in values]
    if (known := KNOWN.get((bare_name(name), len(values)))) is not None:
        return known(unit, *values)
    if found := MAKE.search(name):
        named = (found[1] or found[2], found[1] or found[3])
        sides = sizes_of(unit, *values) or tuple(int(side) for side in named if side)
        if len(sides) == 2:
            return identity_array(*sides) if found[4] == "Identity" else filled(sides, 0)
    raise Unreadable(f"the function {name} with {len(values)} arguments")


def join_named(name: str, values: Sequence[Value]) -> Value:
    """``np.hstack([a, b])`` and its like; a vector is a row of a matrix, and is joined with vectors to one."""
    sizes = {len(value.shape) if isinstance(value, Array) else 0 for value in values}
    if sizes == {1} and name in ("hstack", "concatenate"):
        cells = tuple(c for value in values for c in value.cells)
        return Array((len(cells),), cells)
    known = {"row": {0, 1, 2}, "vstack": {1, 2}, "hstack": {2}, "concatenate": {2}}.get(name, set())
    forbid(not sizes <= known, f"{name} of arrays of different shapes")
    rows = [Array((1, *v.shape), v.cells) if isinstance(v, Array) and len(v.shape) == 1 else v for v in values]
    return join(*rows, across=name in ("hstack", "row"))


# Each takes the source, and the values to which it is applied; a method is applied to what stands before it.


def cellwise(step: Callable[..., Tree]) -> Known:
    """A function of numbers, of arrays cell by cell."""
    return lambda unit, *values: as_real(map_cells(step, *values))


def whole_or_real(step: Callable[..., Tree]) -> Known:
    """The same of functions that give integers for integers, in numpy and C++."""
    real, keeping = cellwise(step), ("python", "cpp")
    return lambda unit, *values: map_cells(step, *values) if unit.language in keeping else real(unit, *values)


def plain(name: str) -> Known:
    """A function that the language of statements has."""
    return cellwise(lambda *trees: build_call(name, *trees))


def turn(factor: Fraction) -> Known:
    """An angle in another unit."""
    return cellwise(lambda x: multiply(multiply(build_number(factor), PI if factor < 1 else build_inverse(PI)), x))


def absolute(unit: Unit, value: Value) -> Value:
    forbid(unit.language == "c", "abs, which cuts to an integer in C; fabs does not")
    return whole_or_real(lambda x: build_call("abs", x))(unit, value)


def filled(shape: tuple[int, ...], number: int) -> Array:
    """An array of one number."""
    return make_array(shape, lambda *_: Scalar(build_number(number)))


def sizes_of(unit: Unit, *values: Value) -> tuple[int, ...]:
    """The shape that arguments give: numbers, or a tuple of them."""
    numbers = [constant_of(cell) for value in values for cell in value.cells]
    forbid(any(n is None or n.denominator != 1 for n in numbers), "a size that is no constant")
    sizes = tuple(int(n) for n in numbers if n is not None)
    return sizes * 2 if unit.language == "matlab" and len(sizes) == 1 else sizes


def make_diagonal(unit: Unit, value: Value) -> Value:
    array = demand(value, Array, why := "diag of what is no vector")
    forbid(len(array.shape) != 1, why)
    zero = Scalar(ZERO, "int" if all(isinstance(c, Scalar) and c.number == "int" for c in array.cells) else "real")
    return make_array(array.shape * 2, lambda i, j: array.cells[i] if i == j else zero)


def make_outer(unit: Unit, a: Value, b: Value) -> Value:
    left, right = (demand(value, Array, "outer of what are no vectors").cells for value in (a, b))
    return Array((len(left), len(right)), tuple(map_cell(multiply, x, y) for x in left for y in right))


def norm_of(unit: Unit, value: Value) -> Value:
    forbid(is_matrix(value), "the norm of a matrix")
    return length_of(value)


def length_of(value: Value) -> Value:
    """The root of the sum of the squares of all cells."""
    return map_cells(lambda x: build_call("sqrt", x), square_sum(value))


def is_matrix(value: Value) -> bool:
    """True for an array with several rows and columns."""
    return isinstance(value, Array) and len(value.shape) == 2 and 1 not in value.shape


def dot_of(unit: Unit, a: Value, b: Value) -> Value:
    """The product of two vectors; of numpy's matrices, their product."""
    if unit.language == "python":
        return matrix_product(a, b)
    left, right = (demand(value, Array, "a dot product of what are no vectors").cells for value in (a, b))
    forbid(len(left) != len(right) or is_matrix(a) or is_matrix(b), "a dot product of different sizes, or of matrices")
    return matrix_product(*(Array((len(cells),), cells) for cells in (left, right)))


def normalize(unit: Unit, value: Value) -> Value:
    """A vector over its length."""
    return map_cells(divide, value, length_of(value))


def diagonal_of(unit: Unit, value: Value) -> Array:
    matrix = demand(value, Array, why := "the diagonal of what is no matrix")
    forbid(len(matrix.shape) != 2, why)
    return Array((min(matrix.shape),), tuple(matrix.at(i, i) for i in range(min(matrix.shape))))


def determine(unit: Unit, value: Value) -> Value:
    array = demand(value, Array, why := "the determinant of what is no small square matrix")
    forbid(array.shape != array.shape[:1] * 2 or (n := array.shape[0]) > LARGEST_INVERSE, why)
    return map_cell(lambda *trees: determinant([list(trees[k * n : k * n + n]) for k in range(n)]), *array.cells)


def sum_of(unit: Unit, value: Value) -> Value:
    """The sum of all entries; of a matrix MATLAB sums the columns."""
    array = demand(value, Array, why := "the sum of what is no vector")
    forbid(unit.language == "matlab" and is_matrix(array), why)
    return map_cell(total, *array.cells)


def make_matrix(unit: Unit, *values: Value) -> Value:
    """The entries row by row, behind the sizes."""
    *sizes, entries = values
    shape = sizes_of(unit, *sizes)
    array = demand(entries, Array, why := "entries that do not fit the sizes")
    forbid(array.shape != (math.prod(shape),), why)
    return Array(shape, array.cells)


def make_quaternion(unit: Unit, *values: Value) -> Value:
    """From w, i, j and k, or from w and the vector."""
    w, *cells = (cell for value in values for cell in value.cells)
    forbid(len(cells) != 3, "a quaternion of other than four numbers")
    return Quaternion((4,), (*cells, w))


def require_quaternion(unit: Unit, value: Value) -> Quaternion:
    return demand(value, Quaternion, "an array where a quaternion is needed")


def conjugate(unit: Unit, value: Value) -> Value:
    """A quaternion with its vector turned round."""
    *vector, w = require_quaternion(unit, value).cells
    return Quaternion((4,), (*(map_cell(minus, cell) for cell in vector), w))


def invert_any(unit: Unit, value: Value) -> Value:
    """The inverse of a matrix; of a quaternion of Eigen its conjugate over its square."""
    if isinstance(value, Quaternion) and unit.language == "cpp":
        return map_cells(divide, conjugate(unit, value), square_sum(value))
    return invert(value)


def rotation_of(unit: Unit, value: Value) -> Value:
    """The matrix of a quaternion, whose columns are the turned axes; as it stands also where its length is not one."""
    quaternion, axes = require_quaternion(unit, value), identity_array(3, 3)
    cells = (c for i in range(3) for c in rotate(quaternion, axes.row(i)).cells)
    return transpose(Array((3, 3), tuple(cells)), True)


def as_another(unit: Unit, value: Value) -> Value:
    """A number or a vector in another type; a matrix of nalgebra takes nested arrays as its columns."""
    is_matrix = isinstance(value, Array) and len(value.shape) != 1
    forbid(is_matrix, "a matrix made of another, which nalgebra may read by columns")
    return value


JOINS = {f"{module}.{name}": name for module in ("np", "numpy") for name in "hstack vstack concatenate block".split()}
PLAIN = "sin cos tan exp log sqrt asin acos atan sinh cosh tanh".split()
ALL, ARRAYS, NALGEBRA, OTHERS = "c cpp python matlab rust", "python matlab", "cpp rust", "c cpp matlab rust"
Row = tuple[str, tuple[int, ...], str, str, Known]
#: Functions and methods: names; numbers of arguments, that on which a method is called among them; the languages that
#: have it as a function, where it may stand with others for several numbers; those that have it as a method; meaning.
TABLE: tuple[Row, ...] = (
    *((name, (1,), ALL, "", plain(name)) for name in PLAIN),
    ("fabs", (1,), ALL, "", plain("abs")), ("abs", (1,), ALL, "", absolute), ("absolute", (1,), "python", "", absolute),
    ("pow", (2,), ALL, "", cellwise(raise_to)), ("power", (2,), "python", "", whole_or_real(raise_to)),
    ("square", (1,), "python", "", whole_or_real(lambda x: raise_to(x, TWICE))),
    ("atan2", (2,), ALL, "", plain("atan2")), ("arctan2", (2,), "python", "", plain("atan2")),
    *((f"arc{name}", (1,), "python", "", plain(f"a{name}")) for name in ("sin", "cos", "tan")),
    ("hypot", (2,), ALL, "",
     cellwise(lambda x, y: build_call("sqrt", add(raise_to(x, TWICE), raise_to(y, TWICE))))),
    ("expm1", (1,), ALL, "", cellwise(lambda x: add(build_call("exp", x), minus(ONE)))),
    ("log1p", (1,), ALL, "", cellwise(lambda x: build_call("log", add(ONE, x)))),
    ("deg2rad", (1,), ARRAYS, "", turn(Fraction(1, 180))), ("radians", (1,), "python", "", turn(Fraction(1, 180))),
    ("rad2deg", (1,), ARRAYS, "", turn(Fraction(180))), ("degrees", (1,), "python", "", turn(Fraction(180))),
    ("eye", (1, 2), f"{ARRAYS} rust", "", lambda unit, *values: identity_array(*(sizes_of(unit, *values) * 2)[:2])),
    ("identity", (1,), ARRAYS, "", lambda unit, value: identity_array(*(sizes_of(unit, value) * 2)[:2])),
    ("zeros", (1, 2), f"{ARRAYS} rust", "", lambda unit, *values: filled(sizes_of(unit, *values), 0)),
    ("ones", (1, 2), ARRAYS, "", lambda unit, *values: filled(sizes_of(unit, *values), 1)),
    ("array asarray", (1,), ARRAYS, "", lambda unit, value: value),
    ("copy", (1,), ARRAYS, ALL, lambda unit, value: value), ("eval", (1,), "", OTHERS, lambda unit, value: value),
    *((name, (1,), where, ALL, lambda unit, value: transpose(value, unit.rules.matrix))
      for name, where in (("transpose", ARRAYS), ("T", ""))),
    ("norm", (1,), ARRAYS, OTHERS, norm_of), ("linalg.norm", (1,), ARRAYS, "", norm_of),
    ("squaredNorm norm_squared", (1,), "", OTHERS, lambda unit, value: square_sum(value)),
    ("normalized unit", (1,), "", OTHERS, normalize), ("normalize", (1,), "", "c matlab rust", normalize),
    ("diag", (1,), ARRAYS, "", make_diagonal), ("asDiagonal", (1,), "", OTHERS, make_diagonal),
    ("diagonal", (1,), "", ALL, diagonal_of), ("outer", (2,), ARRAYS, "", make_outer),
    ("cross", (2,), f"{ARRAYS} cpp", OTHERS, lambda unit, a, b: cross_product(a, b)),
    ("dot", (2,), ARRAYS, ALL, dot_of), ("matmul", (2,), ARRAYS, "", lambda unit, a, b: operate(unit, "@", a, b)),
    ("cwiseProduct", (2,), "", OTHERS, lambda unit, a, b: map_cells(multiply, a, b)),
    ("inv linalg.inv", (1,), ARRAYS, "", lambda unit, value: invert(value)), ("inverse", (1,), "", OTHERS, invert_any),
    ("linalg.solve", (2,), ARRAYS, "", lambda unit, a, b: matrix_product(invert(a), b)),
    ("trace", (1,), ARRAYS, ALL, lambda unit, value: map_cell(total, *diagonal_of(unit, value).cells)),
    ("sum", (1,), ARRAYS, ALL, sum_of), ("det linalg.det", (1,), ARRAYS, "", determine),
    ("determinant", (1,), "", OTHERS, determine), ("conjugate", (1,), "", OTHERS, conjugate),
    ("toRotationMatrix", (1,), "", OTHERS, rotation_of),
    *((name, (1,), "", OTHERS, lambda unit, value, n=n: Array((n,), require_quaternion(unit, value).cells[:n]))
      for name, n in (("coeffs", 4), ("vec", 3))),
    # constructors of nalgebra and Eigen; the reader of Rust writes the sizes of a type before the entries
    ("Matrix::new", (2, 3), NALGEBRA, "", make_matrix), ("Quaternion::new", (4,), NALGEBRA, "", make_quaternion),
    ("Quaternion::from_parts", (2,), NALGEBRA, "", make_quaternion), ("Convert::into", (1,), NALGEBRA, "", as_another),
    ("Quaternion::new_unchecked", (1,), NALGEBRA, "", require_quaternion),
    ("Quaternion::from_quaternion Quaternion::new_normalize", (1,), NALGEBRA, "",
     lambda unit, value: normalize(unit, require_quaternion(unit, value))),
    ("Quaternion::identity", (0,), NALGEBRA, "",
     lambda unit: Quaternion((4,), (*[Scalar(ZERO)] * 3, Scalar(ONE)))),
)  # fmt: skip
ROWS: list[Row] = [(name, *row) for names, *row in TABLE for name in names.split()]  # type: ignore[misc]
KNOWN: dict[tuple[str, int], Known] = {(name, n): known for name, counts, *_, known in ROWS for n in counts}
NAMES = {language: frozenset(row[0] for row in ROWS if language in row[2].split()) for language in ALL.split()}
#: Functions of numbers, which all languages have.
NUMBERS = frozenset(row[0] for row in ROWS if row[2] == ALL)
#: Methods by name and number of arguments, with their languages.
METHODS = {(name, n - 1): where for name, counts, _, where, _ in ROWS for n in counts if where}
#: What changes its own vector or matrix in C++, and what gives the changed one.
IN_PLACE = {"normalize": "normalized", "transposeInPlace": "transpose"}


def is_method(name: str, count: int, language: str) -> bool:
    """True for a method that gives a value and writes nothing."""
    return language in METHODS.get((name, count), "").split()
