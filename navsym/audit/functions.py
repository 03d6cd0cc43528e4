"""The functions of numbers and arrays that estimator code calls, by their names in each language."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from fractions import Fraction

from navsym.audit.form import Unit
from navsym.audit.values import (
    LARGEST_INVERSE,
    Array,
    List,
    Quaternion,
    Scalar,
    Unread,
    Unreadable,
    Value,
    add,
    as_real,
    constant_of,
    count_cells,
    cross_product,
    determinant,
    divide,
    identity_array,
    invert,
    make_array,
    map_cell,
    map_cells,
    matrix_product,
    minus,
    multiply,
    raise_to,
    root,
    rotate,
    square_sum,
    total,
    transpose,
)
from navsym.language.tree import ONE, PI, ZERO, Tree, build_call, build_inverse, build_number

#: Functions of one number, by their names without prefix and suffix.
PLAIN = {
    **{name: name for name in "sin cos tan exp log sqrt asin acos atan sinh cosh tanh".split()},
    **{"fabs": "abs", "abs": "abs", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "absolute": "abs"},
}
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
#: Functions that MATLAB calls without parentheses.
NAMED_CALLS = {"matlab": frozenset("rand randn randi tic toc now clock cputime input".split())}
PREFIX = re.compile(r"(std::|::|math\.|np\.|numpy\.|matrix::|Eigen::)")


def bare_name(name: str) -> str:
    """A name of a function without namespace, module and the suffix f of C."""
    bare = PREFIX.sub("", name, count=1)
    is_float = bare.endswith("f") and bare[:-1] in (*PLAIN, "pow", "atan2", "hypot")
    return bare[:-1] if is_float else bare


def is_known(name: str, language: str) -> bool:
    """True for a function that has a meaning of its own in the language."""
    bare = bare_name(name)
    if language == "python":
        known = (
            bare in PLAIN
            or bare in TWO
            or bare in {known for known, _ in ARRAYS}
            or bare in ("arctan2", "power", "square", *ANGLES)
        )
        return known and (PREFIX.match(name) is not None or name == "abs")
    if language in ("rust", "cpp") and (
        name in {known for known, _ in NALGEBRA} or (language == "rust" and bare in ("zeros", "eye"))
    ):
        return True
    if bare in TWO or (bare in PLAIN and not bare.startswith("arc") and bare != "absolute"):
        return True
    if language == "matlab":
        return bare in {known for known, _ in ARRAYS} or bare in ("deg2rad", "rad2deg")
    return language == "cpp" and (bare == "cross" or MAKE.search(name) is not None)


def does_take(name: str, count: int, language: str) -> bool:
    """True for a known function that only reads so many arguments; one more of numpy is where it writes."""
    bare = bare_name(name)
    most = 1 if bare in (*PLAIN, *ANGLES, "square") else max((n for known, n in ARRAYS if known == bare), default=2)
    return is_known(name, language) and (language != "python" or count <= most)


def extreme_of(name: str, language: str) -> str:
    """``>=`` for a name of the larger of two numbers, ``<=`` for one of the smaller; else nothing."""
    known = {"c": ("fmax", "fmin"), "cpp": ("fmax", "fmin"), "matlab": ("max", "min"), "python": ("maximum", "minimum")}
    bare = PREFIX.sub("", name, count=1)
    known["rust"] = known["c"]
    bare = bare.removesuffix("f") if language in ("c", "cpp") else bare
    if name in ("std::max", "std::min") or (name in ("max", "min") and language == "python"):
        return ">=" if name.endswith("max") else "<="
    return dict(zip(known.get(language, ()), (">=", "<="), strict=False)).get(bare, "")


TWO = ("pow", "atan2", "hypot")
MAKE = re.compile(r"(?:^|::)Mat(?:rix)?(?:(\d)[fd]?|<\w+,(\d+),(\d+)>|X[fd]?)::(Zero|Identity)$")


def call_known(name: str, values: Sequence[Value], unit: Unit, line: int) -> Value:
    """The value of a known function."""
    unread = next((value for value in values if isinstance(value, Unread)), None)
    if unread is not None:
        return unread
    values = [Array(value.shape, value.cells) if isinstance(value, List) else value for value in values]
    bare = bare_name(name)
    if bare in PLAIN and len(values) == 1:
        if bare == "abs" and unit.language in ("c",):
            raise Unreadable(line, "abs, which cuts to an integer in C; fabs does not")
        return as_real(map_cells(lambda x: build_call(PLAIN[bare], x), values[0]))
    if bare in ANGLES and len(values) == 1:
        factor = ANGLES[bare]
        turn = multiply(build_number(factor), PI if factor < 1 else build_inverse(PI))
        return as_real(map_cells(lambda x: multiply(turn, x), values[0]))
    if bare in ("pow", "power") and len(values) == 2:
        return as_real(map_cells(raise_to, *values))
    if bare in ("atan2", "arctan2") and len(values) == 2:
        return as_real(map_cells(lambda y, x: build_call("atan2", y, x), *values))
    if bare == "hypot" and len(values) == 2:
        return map_cells(lambda x, y: root(add(raise_to(x, TWICE), raise_to(y, TWICE))), *values)
    if bare == "square" and len(values) == 1:
        return map_cells(lambda x: raise_to(x, TWICE), values[0])
    if unit.language in ("rust", "cpp") and (name, len(values)) in NALGEBRA:
        return NALGEBRA[name, len(values)](values, unit)
    if (bare, len(values)) in ARRAYS:
        return ARRAYS[bare, len(values)](values, unit)
    if found := MAKE.search(name):
        sides = sizes_of(values, unit) or tuple(
            int(side) for side in (found[1] or found[2], found[1] or found[3]) if side
        )
        if len(sides) == 2:
            return identity_array(*sides) if found[4] == "Identity" else filled(sides, 0)
    raise Unreadable(line, f"the function {name} with {len(values)} arguments")


def filled(shape: tuple[int, ...], number: int) -> Array:
    """An array of one number."""
    return make_array(shape, lambda *_: Scalar(build_number(number)))


def sizes_of(values: Sequence[Value], unit: Unit) -> tuple[int, ...]:
    """The shape that arguments give: numbers, or a tuple of them."""
    cells = [c for v in values for c in (v.cells if isinstance(v, Array) else (v,))]
    numbers = [constant_of(cell) for cell in cells]
    if any(n is None or n.denominator != 1 for n in numbers):
        raise Unreadable(0, "a size that is no constant")
    sizes = tuple(int(n) for n in numbers if n is not None)
    return sizes * 2 if unit.language == "matlab" and len(sizes) == 1 else sizes


def make_diagonal(values: Sequence[Value], unit: Unit) -> Value:
    (value,) = values
    if not isinstance(value, Array) or len(value.shape) != 1:
        raise Unreadable(0, "diag of what is no vector")
    whole = all(isinstance(cell, Scalar) and cell.number == "int" for cell in value.cells)
    zero = Scalar(build_number(0), "int" if whole else "real")
    return make_array(value.shape * 2, lambda i, j: value.cells[i] if i == j else zero)


def make_outer(values: Sequence[Value], unit: Unit) -> Value:
    a, b = values
    if not (isinstance(a, Array) and isinstance(b, Array)):
        raise Unreadable(0, "outer of what are no vectors")
    cells = [map_cells(multiply, x, y) for x in a.cells for y in b.cells]
    return Array((len(a.cells), len(b.cells)), tuple(cells))  # type: ignore[arg-type]


def norm_of(values: Sequence[Value], unit: Unit) -> Value:
    (value,) = values
    if isinstance(value, Array) and len(value.shape) == 2 and 1 not in value.shape:
        raise Unreadable(0, "the norm of a matrix")
    return map_cells(root, square_sum(value))


def multiply_arrays(values: Sequence[Value], unit: Unit) -> Value:
    if not all(isinstance(value, Array) for value in values):
        raise Unreadable(0, "a product of matrices with a number")
    return matrix_product(values[0], values[1])


def dot_of(values: Sequence[Value], unit: Unit) -> Value:
    """The product of two vectors; of numpy's matrices, their product."""
    a, b = values
    if unit.language == "python":
        return matrix_product(a, b)
    if not (isinstance(a, Array) and isinstance(b, Array)):
        raise Unreadable(0, "a dot product of what are no vectors")
    if count_cells(a.shape) != count_cells(b.shape) or any(len(v.shape) == 2 and 1 not in v.shape for v in (a, b)):
        raise Unreadable(0, "a dot product of different sizes, or of matrices")
    flat = (len(a.cells),)
    return matrix_product(Array(flat, a.cells), Array(flat, b.cells))


Known = Callable[[Sequence[Value], Unit], Value]
#: Functions of arrays by name and number of arguments: with others they mean something else.
ARRAYS: dict[tuple[str, int], Known] = {
    **dict.fromkeys((("eye", 1), ("eye", 2), ("identity", 1)), lambda v, u: identity_array(*(sizes_of(v, u) * 2)[:2])),
    **dict.fromkeys((("zeros", 1), ("zeros", 2)), lambda values, unit: filled(sizes_of(values, unit), 0)),
    **dict.fromkeys((("ones", 1), ("ones", 2)), lambda values, unit: filled(sizes_of(values, unit), 1)),
    **dict.fromkeys((("array", 1), ("asarray", 1), ("copy", 1)), lambda values, unit: values[0]),
    **dict.fromkeys((("norm", 1), ("linalg.norm", 1)), norm_of), ("diag", 1): make_diagonal, ("outer", 2): make_outer,
    ("cross", 2): lambda values, unit: cross_product(values[0], values[1]), ("dot", 2): dot_of,
    **dict.fromkeys((("inv", 1), ("linalg.inv", 1)), lambda values, unit: invert(values[0])),
    ("linalg.solve", 2): lambda values, unit: matrix_product(invert(values[0]), values[1]),
    **dict.fromkeys((("det", 1), ("linalg.det", 1)), lambda values, unit: determine(values[0], (), unit)),
    ("trace", 1): lambda values, unit: trace_of(values[0], (), unit),
    ("sum", 1): lambda values, unit: sum_of(values[0], (), unit),
    ("matmul", 2): multiply_arrays,
    ("transpose", 1): lambda values, unit: transpose(values[0], unit.rules.matrix),
}  # fmt: skip


def make_matrix(values: Sequence[Value], unit: Unit) -> Value:
    """The entries row by row, behind the sizes."""
    *sizes, entries = values
    shape = sizes_of(sizes, unit)
    if not isinstance(entries, Array) or len(entries.shape) != 1 or count_cells(shape) != len(entries.cells):
        raise Unreadable(0, "entries that do not fit the sizes")
    return Array(shape, entries.cells)


def make_quaternion(values: Sequence[Value], unit: Unit) -> Value:
    """From w, i, j and k."""
    if len(values) != 4 or not all(isinstance(value, Scalar) for value in values):
        raise Unreadable(0, "a quaternion of other than four numbers")
    return Quaternion((4,), (*values[1:], values[0]))  # type: ignore[arg-type]


def make_of_parts(values: Sequence[Value], unit: Unit) -> Value:
    """From w and the vector."""
    w, vector = values
    if not isinstance(vector, Array) or vector.shape != (3,) or not isinstance(w, Scalar):
        raise Unreadable(0, "a quaternion of other than a number and three")
    return Quaternion((4,), (*vector.cells, w))


def require_quaternion(values: Sequence[Value], unit: Unit) -> Value:
    (value,) = values
    if not isinstance(value, Quaternion):
        raise Unreadable(0, "a quaternion made of something else")
    return value


#: Constructors of nalgebra and Eigen; the reader of Rust writes the sizes of a type before the entries.
NALGEBRA: dict[tuple[str, int], Known] = {
    ("Matrix::new", 2): make_matrix, ("Matrix::new", 3): make_matrix, ("Quaternion::new", 4): make_quaternion,
    ("Quaternion::from_parts", 2): make_of_parts, ("Quaternion::new_unchecked", 1): require_quaternion,
    **dict.fromkeys(
        (("Quaternion::from_quaternion", 1), ("Quaternion::new_normalize", 1)),
        lambda values, unit: normalize(require_quaternion(values, unit), (), unit),
    ),
    ("Quaternion::identity", 0): lambda values, unit: Quaternion((4,), (*[Scalar(ZERO)] * 3, Scalar(ONE))),
}  # fmt: skip

Method = Callable[[Value, Sequence[Value], Unit], Value]


def normalize(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    """A vector over its length."""
    length = map_cells(root, square_sum(value))
    return map_cells(divide, value, length)


def diagonal_of(value: Value, _: Sequence[Value], unit: Unit) -> Array:
    """The diagonal of a matrix."""
    if not isinstance(value, Array) or len(value.shape) != 2:
        raise Unreadable(0, "the diagonal of what is no matrix")
    return Array((min(value.shape),), tuple(value.at(i, i) for i in range(min(value.shape))))


def trace_of(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    """The sum of the diagonal."""
    return map_cell(lambda *trees: total(list(trees)), *diagonal_of(value, (), unit).cells)


def determine(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    """The determinant."""
    n = value.shape[0] if isinstance(value, Array) else 0
    if not isinstance(value, Array) or value.shape != (n, n) or n > LARGEST_INVERSE:
        raise Unreadable(0, "the determinant of what is no small square matrix")
    return map_cell(lambda *trees: determinant([list(trees[k * n : k * n + n]) for k in range(n)]), *value.cells)


def sum_of(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    """The sum of all entries; of a matrix MATLAB sums the columns."""
    if not isinstance(value, Array) or (unit.language == "matlab" and len(value.shape) == 2 and 1 not in value.shape):
        raise Unreadable(0, "the sum of what is no vector")
    return map_cell(lambda *trees: total(list(trees)), *value.cells)


def conjugate(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    """A quaternion with its vector turned round."""
    if not isinstance(value, Quaternion):
        raise Unreadable(0, "the conjugate of what is no quaternion")
    return Quaternion((4,), (*(map_cell(minus, cell) for cell in value.cells[:3]), value.cells[3]))


def invert_any(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    """The inverse of a matrix; of a quaternion of Eigen its conjugate over its square."""
    if isinstance(value, Quaternion) and unit.language == "cpp":
        return map_cells(divide, conjugate(value, (), unit), square_sum(value))
    return invert(value)


def rotation_of(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    """The matrix of a quaternion, whose columns are the turned axes; as it stands also where its length is not one."""
    if not isinstance(value, Quaternion):
        raise Unreadable(0, "the rotation of what is no quaternion")
    axes = identity_array(3, 3)
    return transpose(Array((3, 3), tuple(c for i in range(3) for c in rotate(value, axes.row(i)).cells)), True)


def coefficients_of(count: int) -> Method:
    """The first coefficients of a quaternion, as a vector."""

    def take(value: Value, _: Sequence[Value], unit: Unit) -> Value:
        if not isinstance(value, Quaternion):
            raise Unreadable(0, "the coefficients of what is no quaternion")
        return Array((count,), value.cells[:count])

    return take


def transposed(value: Value, _: Sequence[Value], unit: Unit) -> Value:
    return transpose(value, unit.rules.matrix)


#: Methods by name and number of arguments.
METHODS: dict[tuple[str, int], Method] = {
    **dict.fromkeys((("transpose", 0), ("T", 0)), transposed),
    **dict.fromkeys((("copy", 0), ("eval", 0)), lambda value, _, unit: value),
    **dict.fromkeys((("squaredNorm", 0), ("norm_squared", 0)), lambda value, _, unit: square_sum(value)),
    **dict.fromkeys((("normalized", 0), ("normalize", 0), ("unit", 0)), normalize),
    ("dot", 1): lambda value, others, unit: dot_of([value, *others], unit),
    ("cross", 1): lambda value, others, unit: cross_product(value, others[0]),
    ("norm", 0): lambda value, _, unit: norm_of([value], unit),
    ("conjugate", 0): conjugate, ("inverse", 0): invert_any,
    ("toRotationMatrix", 0): rotation_of, ("coeffs", 0): coefficients_of(4), ("vec", 0): coefficients_of(3),
    ("trace", 0): trace_of, ("sum", 0): sum_of, ("diagonal", 0): diagonal_of,
    ("determinant", 0): determine, ("asDiagonal", 0): lambda value, _, unit: make_diagonal([value], unit),
    ("cwiseProduct", 1): lambda value, others, unit: map_cells(multiply, value, others[0]),
}  # fmt: skip
#: What changes its own vector or matrix in C++, and what gives the changed one.
IN_PLACE = {"normalize": "normalized", "transposeInPlace": "transpose"}


def is_method(name: str, count: int, language: str) -> bool:
    """True for a method that gives a value and writes nothing."""
    is_there = (
        name in ("T", "transpose", "copy", "dot", "sum", "trace", "diagonal")
        if language == "python"
        else language != "cpp" or name not in IN_PLACE
    )
    return (name, count) in METHODS and is_there
