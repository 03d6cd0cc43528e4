"""The functions of numbers and arrays that estimator code calls, by their names in each language."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from fractions import Fraction

from navsym.audit.form import Function, Part, Unit, called_in, has_effects, head_of, mentioned_in, names_in, walk
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
    cells_of,
    constant_of,
    cross_product,
    demand,
    determinant,
    divide,
    find_unread,
    forbid,
    identity_array,
    invert,
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

#: Functions of one number, by their names without prefix and suffix.
PLAIN = {
    **{name: name for name in "sin cos tan exp log sqrt asin acos atan sinh cosh tanh".split()},
    **{"fabs": "abs", "abs": "abs"},
}
#: The same of numpy.
NUMPY = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "absolute": "abs"}
#: Degrees to radians and back.
ANGLES = {"deg2rad": Fraction(1, 180), "radians": Fraction(1, 180), "rad2deg": Fraction(180), "degrees": Fraction(180)}
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
    return bare[:-1] if bare.endswith("f") and bare[:-1] in SCALAR else bare


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
    bare = bare_name(name)
    most = max((n for known, n in KNOWN if known == bare), default=2)
    return is_known(name, language) and (language != "python" or count <= most)


def find_race(unit: Unit, parts: tuple[Part, ...], local: set[str], fixed: set[str]) -> Part | None:
    """An operand with a call that writes what another operand reads, or may read; None where there is none."""
    own = unit.functions
    writing = {n for n in called_in(*parts) & own.keys() if any(map(has_effects, own[n]))}
    for node in (Part("list", 0, parts), *walk(*parts)) if writing else ():
        kinds = ("op", "compare", "call", "method", "index", "list")
        sides = [p for x in node.parts for p in (x if isinstance(x, tuple) else (x,)) if isinstance(p, Part)]
        for side in sides if node.kind in kinds else ():
            given = [mentioned_in(*p.parts[1]) for p in walk(side) if p.kind == "call" and p.parts[0] in writing]
            rest = mentioned_in(*(other for other in sides if other is not side)) if given else set()
            rest -= fixed | {*unit.macros, *CONSTANTS}
            shared = {*map(head_of, rest)} & {*map(head_of, set[str]().union(*given))}
            if shared or any(n not in local and not is_known(n, unit.language) for n in rest):
                return side
    return None


def may_change(unit: Unit, function: Function, owner: str) -> bool:
    """True for a structure that the function, or one that it calls, may write to."""
    parts = [*walk(*function.body)]
    called = [f.body for p in parts if p.kind == "call" for f in unit.functions.get(p.parts[0], ())]
    changing = ("assign", "moved", "address", "do", "unread", "jump", "refused")
    changed = (p for p in [*parts, *walk(*called)] if p.kind in changing)
    names = {n for p in changed for n in (names_in(p.parts[0]) if p.kind == "assign" else names_in(p))}
    hidden = (p.parts[1] for p in parts if p.kind in ("unread", "jump", "refused") and len(p.parts) > 1)
    return head_of(owner) in {*map(head_of, names)}.union(*hidden)


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


def same(unit: Unit, value: Value) -> Value:
    return value


def filled(shape: tuple[int, ...], number: int) -> Array:
    """An array of one number."""
    return make_array(shape, lambda *_: Scalar(build_number(number)))


def sizes_of(unit: Unit, *values: Value) -> tuple[int, ...]:
    """The shape that arguments give: numbers, or a tuple of them."""
    numbers = [constant_of(cell) for value in values for cell in cells_of(value)]
    forbid(any(n is None or n.denominator != 1 for n in numbers), "a size that is no constant")
    sizes = tuple(int(n) for n in numbers if n is not None)
    return sizes * 2 if unit.language == "matlab" and len(sizes) == 1 else sizes


def require(value: Value, dimension: int, what: str) -> Array:
    """An array of so many sizes."""
    why = f"{what} of what is no {'vector' if dimension == 1 else 'matrix'}"
    forbid(len(demand(value, Array, why).shape) != dimension, why)
    return demand(value, Array, why)


def make_diagonal(unit: Unit, value: Value) -> Value:
    cells = require(value, 1, "diag").cells
    whole = all(isinstance(cell, Scalar) and cell.number == "int" for cell in cells)
    zero = Scalar(build_number(0), "int" if whole else "real")
    return make_array((len(cells),) * 2, lambda i, j: cells[i] if i == j else zero)


def make_outer(unit: Unit, a: Value, b: Value) -> Value:
    left, right = (demand(value, Array, "outer of what are no vectors").cells for value in (a, b))
    return Array((len(left), len(right)), tuple(map_cell(multiply, x, y) for x in left for y in right))


def norm_of(unit: Unit, value: Value) -> Value:
    forbid(is_matrix(value), "the norm of a matrix")
    return map_cells(lambda x: build_call("sqrt", x), square_sum(value))


def is_matrix(value: Value) -> bool:
    """True for an array with several rows and columns."""
    return isinstance(value, Array) and len(value.shape) == 2 and 1 not in value.shape


def dot_of(unit: Unit, a: Value, b: Value) -> Value:
    """The product of two vectors; of numpy's matrices, their product."""
    if unit.language == "python":
        return matrix_product(a, b)
    left, right = (demand(value, Array, "a dot product of what are no vectors").cells for value in (a, b))
    is_other = len(left) != len(right) or is_matrix(a) or is_matrix(b)
    forbid(is_other, "a dot product of different sizes, or of matrices")
    return matrix_product(*(Array((len(cells),), cells) for cells in (left, right)))


def normalize(unit: Unit, value: Value) -> Value:
    """A vector over its length."""
    return map_cells(divide, value, map_cells(lambda x: build_call("sqrt", x), square_sum(value)))


def diagonal_of(unit: Unit, value: Value) -> Array:
    matrix = require(value, 2, "the diagonal")
    return Array((min(matrix.shape),), tuple(matrix.at(i, i) for i in range(min(matrix.shape))))


def trace_of(unit: Unit, value: Value) -> Value:
    return map_cell(lambda *trees: total(list(trees)), *diagonal_of(unit, value).cells)


def determine(unit: Unit, value: Value) -> Value:
    n = value.shape[0] if isinstance(value, Array) else 0
    if not isinstance(value, Array) or value.shape != (n, n) or n > LARGEST_INVERSE:
        raise Unreadable("the determinant of what is no small square matrix")
    return map_cell(lambda *trees: determinant([list(trees[k * n : k * n + n]) for k in range(n)]), *value.cells)


def sum_of(unit: Unit, value: Value) -> Value:
    """The sum of all entries; of a matrix MATLAB sums the columns."""
    if not isinstance(value, Array) or (unit.language == "matlab" and is_matrix(value)):
        raise Unreadable("the sum of what is no vector")
    return map_cell(lambda *trees: total(list(trees)), *value.cells)


def make_matrix(unit: Unit, *values: Value) -> Value:
    """The entries row by row, behind the sizes."""
    *sizes, entries = values
    shape = sizes_of(unit, *sizes)
    if not isinstance(entries, Array) or len(entries.shape) != 1 or math.prod(shape) != len(entries.cells):
        raise Unreadable("entries that do not fit the sizes")
    return Array(shape, entries.cells)


def make_quaternion(unit: Unit, *values: Value) -> Value:
    """From w, i, j and k, or from w and the vector."""
    w, *cells = (cell for value in values for cell in cells_of(value))
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
    if isinstance(value, Array) and len(value.shape) != 1:
        raise Unreadable("a matrix made of another, which nalgebra may read by columns")
    return value


def transposed(unit: Unit, value: Value) -> Value:
    return transpose(value, unit.rules.matrix)


#: Functions of numbers by name and number of arguments: with others they mean something else.
NUMBERS: dict[tuple[str, int], Known] = {
    **{(name, 1): plain(meaning) for name, meaning in PLAIN.items()}, ("abs", 1): absolute,
    ("pow", 2): cellwise(raise_to), ("atan2", 2): plain("atan2"),
    ("hypot", 2): cellwise(lambda x, y: build_call("sqrt", add(raise_to(x, TWICE), raise_to(y, TWICE)))),
    ("expm1", 1): cellwise(lambda x: add(build_call("exp", x), minus(ONE))),
    ("log1p", 1): cellwise(lambda x: build_call("log", add(ONE, x))),
}  # fmt: skip
#: Functions of arrays.
ARRAYS: dict[tuple[str, int], Known] = {
    **dict.fromkeys((("eye", 1), ("eye", 2), ("identity", 1)),
                    lambda unit, *values: identity_array(*(sizes_of(unit, *values) * 2)[:2])),
    **dict.fromkeys((("zeros", 1), ("zeros", 2)), lambda unit, *values: filled(sizes_of(unit, *values), 0)),
    **dict.fromkeys((("ones", 1), ("ones", 2)), lambda unit, *values: filled(sizes_of(unit, *values), 1)),
    **dict.fromkeys((("array", 1), ("asarray", 1), ("copy", 1)), same), ("transpose", 1): transposed,
    **dict.fromkeys((("norm", 1), ("linalg.norm", 1)), norm_of), ("diag", 1): make_diagonal, ("outer", 2): make_outer,
    ("cross", 2): lambda unit, a, b: cross_product(a, b), ("dot", 2): dot_of,
    ("matmul", 2): lambda unit, a, b: operate(unit, "@", a, b),
    **dict.fromkeys((("inv", 1), ("linalg.inv", 1)), lambda unit, value: invert(value)),
    ("linalg.solve", 2): lambda unit, a, b: matrix_product(invert(a), b), ("trace", 1): trace_of, ("sum", 1): sum_of,
    **dict.fromkeys((("det", 1), ("linalg.det", 1)), determine),
}  # fmt: skip
#: Functions that only numpy has, and degrees.
OF_NUMPY: dict[tuple[str, int], Known] = {
    **{(name, 1): plain(meaning) for name, meaning in NUMPY.items()}, ("absolute", 1): absolute,
    ("square", 1): whole_or_real(lambda x: raise_to(x, TWICE)),
    ("power", 2): whole_or_real(raise_to), ("arctan2", 2): plain("atan2"),
}  # fmt: skip
OF_ANGLES: dict[tuple[str, int], Known] = {(name, 1): turn(factor) for name, factor in ANGLES.items()}
#: Constructors of nalgebra and Eigen; the reader of Rust writes the sizes of a type before the entries.
NALGEBRA: dict[tuple[str, int], Known] = {
    ("Matrix::new", 2): make_matrix, ("Matrix::new", 3): make_matrix, ("Quaternion::new", 4): make_quaternion,
    ("Quaternion::from_parts", 2): make_quaternion, ("Quaternion::new_unchecked", 1): require_quaternion,
    **dict.fromkeys(
        (("Quaternion::from_quaternion", 1), ("Quaternion::new_normalize", 1)),
        lambda unit, value: normalize(unit, require_quaternion(unit, value)),
    ),
    ("Convert::into", 1): as_another,
    ("Quaternion::identity", 0): lambda unit: Quaternion((4,), (*[Scalar(ZERO)] * 3, Scalar(ONE))),
}  # fmt: skip
KNOWN = NUMBERS | ARRAYS | OF_NUMPY | OF_ANGLES | NALGEBRA
SCALAR = frozenset(name for name, _ in NUMBERS)
#: The names that each language has.
NAMES: dict[str, frozenset[str]] = {
    language: SCALAR.union(others, *({name for name, _ in table} for table in tables))
    for language, others, tables in (
        ("c", (), ()), ("cpp", ("cross",), (NALGEBRA,)), ("rust", ("zeros", "eye"), (NALGEBRA,)),
        ("matlab", ("deg2rad", "rad2deg"), (ARRAYS,)), ("python", (), (ARRAYS, OF_NUMPY, OF_ANGLES)),
    )
}  # fmt: skip
#: Methods by name and number of arguments.
METHODS: dict[tuple[str, int], Known] = {
    **dict.fromkeys((("transpose", 0), ("T", 0)), transposed), **dict.fromkeys((("copy", 0), ("eval", 0)), same),
    **dict.fromkeys((("squaredNorm", 0), ("norm_squared", 0)), lambda unit, value: square_sum(value)),
    **dict.fromkeys((("normalized", 0), ("normalize", 0), ("unit", 0)), normalize), ("norm", 0): norm_of,
    ("dot", 1): dot_of, ("cross", 1): ARRAYS["cross", 2], ("conjugate", 0): conjugate, ("inverse", 0): invert_any,
    ("toRotationMatrix", 0): rotation_of, 
    **{(name, 0): lambda unit, value, n=n: Array((n,), require_quaternion(unit, value).cells[:n])
       for name, n in (("coeffs", 4), ("vec", 3))},
    ("trace", 0): trace_of, ("sum", 0): sum_of, ("diagonal", 0): diagonal_of, ("determinant", 0): determine,
    ("asDiagonal", 0): make_diagonal, ("cwiseProduct", 1): lambda unit, a, b: map_cells(multiply, a, b),
}  # fmt: skip
#: What changes its own vector or matrix in C++, and what gives the changed one.
IN_PLACE = {"normalize": "normalized", "transposeInPlace": "transpose"}


def is_method(name: str, count: int, language: str) -> bool:
    """True for a method that gives a value and writes nothing."""
    of_numpy = name in ("T", "transpose", "copy", "dot", "sum", "trace", "diagonal")
    is_there = of_numpy if language == "python" else language != "cpp" or name not in IN_PLACE
    return (name, count) in METHODS and is_there
