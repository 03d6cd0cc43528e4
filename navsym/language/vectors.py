"""The whole language of claims: vectors, matrices, cases and derivatives, read into a tree with a shape for each part.

To the grammar of :mod:`navsym.language.expression` come ``A @ B``, ``A.T``, ``v[1]``, ``A[1,2]`` (from 1), vectors
``[a, b]`` and matrices ``[[a, b], [c, d]]`` by their rows, the functions of :data:`TAKES`, ``where(a < b, x, y)``, and
``diff(f, x)``, ``diff(f, x, 2)``, ``dot_(x)``. A vector is a column; quaternions are vectors of four, scalar first. The
tree is for people: it says what is wrong with a text and shows it. The checker reads the text by itself.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, NoReturn

from navsym.core.errors import EmptyError, ExpressionSyntaxError, NavsymError, ShapeError, TooLargeError
from navsym.language.expression import LENGTH, Reader
from navsym.language.names import FUNCTIONS, RESERVED, quote
from navsym.language.printer import LOOSE, RAISED, TIGHT, WHOLE, LatexWriter, Text
from navsym.language.tokens import Source, split_tokens
from navsym.language.tree import MINUS_ONE, NUMBER, POWER, PRODUCT, SUM, SYMBOL, Tree, build, build_number, fold_tree

Size = tuple[Any, Any] | None  # rows and columns, whole numbers or names of dimensions; None for a number

RELATIONS = ("=", "!=", "<", "<=", ">", ">=")
MOST_INVERSE, MOST_DETERMINANT, MOST_ORDER, MOST_EXPONENT = 4, 5, 8, 16
#: What each function takes, in words, and how many arguments.
TAKES: dict[str, tuple[str, int, int]] = {
    "cross": ("two vectors of three", 2, 2),
    "dot": ("two vectors of one length", 2, 2),
    "norm": ("a vector", 1, 1),
    "skew": ("a vector of three", 1, 1),
    "det": (f"a square matrix of at most {MOST_DETERMINANT} rows", 1, 1),
    "inv": (f"a square matrix of at most {MOST_INVERSE} rows", 1, 1),
    "trace": ("a square matrix", 1, 1),
    "transpose": ("a matrix", 1, 1),
    "eye": ("a whole number", 1, 1),
    "zeros": ("two whole numbers", 2, 2),
    "diag": ("numbers, or one vector", 1, 64),
    "qmul": ("two quaternions, vectors of four with the scalar first", 2, 2),
    "conj": ("a quaternion, a vector of four with the scalar first", 1, 1),
    "rot": ("a quaternion, a vector of four with the scalar first", 1, 1),
    "where": ("a condition and two values of one shape", 3, 3),
    "min": ("numbers", 1, 64),
    "max": ("numbers", 1, 64),
    "sign": ("a number", 1, 1),
    "diff": ("a value, a symbol and how many times", 2, 3),
    "dot_": ("a value", 1, 1),
    "floor": ("a number", 1, 1),
    "erf": ("a number", 1, 1),
    "expm": (f"a square matrix of at most {MOST_EXPONENT} rows", 1, 1),
    "E": ("a value", 1, 1),
    "cov": ("one or two numbers or vectors", 1, 2),
}
#: Functions with a variable of their own, in words, and how many arguments.
BINDERS = {
    "integral": ("a value, its variable and two ends", 4),
    "sum": ("a value, its variable and two ends", 4),
    "product": ("a number, its variable and two ends", 4),
    "limit": ("a value, its variable and a point", 3),
}
INFINITE = "oo"
WIDE = re.compile(r"[@\[\]]|\.\s*T\b|\b(?:" + "|".join((*TAKES, *BINDERS)) + r")\s*\(")


def is_wide(text: str) -> bool:
    """True for a text that the grammar of numbers alone does not have."""
    return WIDE.search(text) is not None


def describe_size(size: Size) -> str:
    """A shape in words."""
    if size is None:
        return "a number"
    rows, columns = size
    return f"a vector of {rows}" if columns == 1 else f"a {rows} x {columns} matrix"


@dataclass(slots=True, eq=False)
class ValueReader(Reader):
    """Recursive descent for numbers, vectors and matrices; ``sizes`` has the shapes of parts that are no numbers."""

    arrays: Mapping[str, Size] = field(default_factory=dict)
    sizes: dict[Tree, Size] = field(default_factory=dict)

    def make(self, at: int, head: str, *args: Tree) -> Tree:
        """A part with its place and its shape; shapes that do not fit are refused here."""
        part = build(head, args)
        self.places.setdefault(part, at)
        size = self.size_of(at, part, [self.sizes.get(argument) for argument in args])
        if size is not None:
            self.sizes[part] = size
        return part

    def apply(self, at: int, name: str, arguments: list[Tree]) -> Tree:
        """A function of numbers as it is written."""
        return self.make(at, name, *arguments)

    def size_of(self, at: int, part: Tree, sizes: list[Size]) -> Size:
        """The shape of a part from those of its own parts."""
        if part.head in (SUM, *RELATIONS):
            if len(set(sizes)) > 1:
                what = "terms of one shape" if part.head == SUM else "two sides of one shape"
                self.refuse_shapes(at, what, sizes, "correct one of them")
            return sizes[0]
        if part.head == PRODUCT:
            arrays = [size for size in sizes if size is not None]
            if len(arrays) > 1:
                remedy = "write @ for a product of matrices, dot or cross for vectors"
                self.refuse_shapes(at, "numbers and at most one vector or matrix in a product with *", sizes, remedy)
            return arrays[0] if arrays else None
        if part.head == POWER and sizes != [None, None]:
            remedy = "write inv(A), A @ A or a product of numbers"
            self.refuse_shapes(at, "a quotient or power of numbers", sizes, remedy)
        if part.head == "@":
            (a, b) = sizes
            if a is None or b is None or a[1] != b[0]:
                self.refuse_shapes(at, "as many columns before @ as rows behind it", sizes, "correct one of them")
            return None if (a[0], b[1]) == (1, 1) else (a[0], b[1])
        if part.head in TAKES:
            return self.size_of_call(at, part, sizes)
        if part.head in BINDERS:
            if any(sizes[1:]) or (part.head == "product" and sizes[0]):
                self.refuse_shapes(at, f"{part.head} of {BINDERS[part.head][0]}", sizes, "correct the call")
            return sizes[0]
        if part.head in FUNCTIONS and any(sizes):
            self.refuse_shapes(at, f"{part.head} of a number", sizes, "take it of an entry, such as v[1]")
        return None

    def size_of_call(self, at: int, part: Tree, sizes: list[Size]) -> Size:
        """The shape of a function of vectors and matrices."""
        name, first = part.head, sizes[0]
        second = sizes[1] if len(sizes) > 1 else None
        last = sizes[-1]
        square = first is not None and first[0] == first[1]
        vector = first is not None and first[1] == 1
        fits: dict[str, tuple[bool, Callable[[], Size]]] = {
            "cross": (first == second == (3, 1), lambda: (3, 1)),
            "dot": (vector and first == second, lambda: None),
            "norm": (vector, lambda: None),
            "skew": (first == (3, 1), lambda: (3, 3)),
            "det": (square and self.is_small(first, MOST_DETERMINANT), lambda: None),
            "inv": (square and (bool(self.dimensions) or self.is_small(first, MOST_INVERSE)), lambda: first),
            "trace": (square, lambda: None),
            "transpose": (first is not None, lambda: (first[1], first[0])),  # type: ignore[index]
            "eye": (self.is_size(part.args[0]), lambda: (size_of(part.args[0]),) * 2),  # type: ignore[return-value]
            "zeros": (all(map(self.is_size, part.args)), lambda: (size_of(part.args[0]), size_of(part.args[-1]))),
            "diag": (not any(sizes) or (vector and len(sizes) == 1), lambda: (first[0] if first else len(sizes),) * 2),  # type: ignore[return-value]
            "qmul": (first == second == (4, 1), lambda: (4, 1)),
            "conj": (first == (4, 1), lambda: (4, 1)),
            "rot": (first == (4, 1), lambda: (3, 3)),
            "where": (first is None and second == sizes[-1], lambda: second),
            "diff": (second is None and part.args[-1].head in (SYMBOL, NUMBER, "index"), lambda: first),
            "dot_": (True, lambda: first),
            "expm": (square and self.is_small(first, MOST_EXPONENT), lambda: first),
            "E": (True, lambda: first),
            "cov": (
                not any(sizes) or (vector and last is not None and last[1] == 1),
                lambda: (first[0], last[0]) if any(sizes) and (first[0], last[0]) != (1, 1) else None,  # type: ignore[index]
            ),
        }
        good, result = fits.get(name, (not any(sizes), lambda: None))
        if not good:
            self.refuse_shapes(at, f"{name} of {TAKES[name][0]}", sizes, "correct the call")
        return result()

    @property
    def dimensions(self) -> set[str]:
        """The names of dimensions."""
        return {side for size in self.arrays.values() if size for side in size if isinstance(side, str)}

    def is_size(self, part: Tree) -> bool:
        """Whether a part is a whole number, or the name of a dimension."""
        return is_count(part) or (part.head == SYMBOL and part.args[0] in self.dimensions)

    @staticmethod
    def is_small(size: Size, most: int) -> bool:
        return size is not None and isinstance(size[0], int) and size[0] <= most

    def refuse_shapes(self, at: int, expected: str, sizes: list[Size], remedy: str) -> NoReturn:
        """Refuse values by their shapes."""
        self.fail(at, expected, " and ".join(map(describe_size, sizes)), remedy, ShapeError)

    # -- grammar ----------------------------------------------------------------------

    def atom(self) -> Tree:
        """A number, a name, a call, brackets or parentheses, with .T and indices behind it."""
        at = self.position
        value = self.rows() if self.tokens[at] == "[" else super(ValueReader, self).atom()
        while (mark := self.tokens[self.position]) in (".", "["):
            size = self.sizes.get(value)
            if size is None:
                what = "a vector or matrix before .T" if mark == "." else "a vector or matrix before an index"
                self.refuse_shapes(self.position, what, [None], "declare it as one, or correct it")
            self.position += 1
            if mark == ".":
                if self.tokens[self.position] != "T":
                    self.unexpected("T behind the point, the transpose,")
                self.position += 1
                value = build("T", (value,))
                self.places.setdefault(value, at)
                self.sizes[value] = (size[1], size[0])
            else:
                value = self.index(at, value, size)
        return value

    def index(self, at: int, value: Tree, size: tuple[int, int]) -> Tree:
        """An entry, counted from 1."""
        places = [self.place()]
        if self.tokens[self.position] == ",":
            self.position += 1
            places.append(self.place())
        if self.tokens[self.position] != "]":
            self.unexpected("] behind the index")
        self.position += 1
        ends = size if len(places) == 2 else size[:1]
        if not all(isinstance(side, int) for side in size):
            remedy = "state the claim by whole matrices, or give the dimensions as numbers"
            self.fail(at, "a matrix of fixed size before an index", describe_size(size), remedy, ShapeError)
        if len(places) == 1 and size[1] != 1:
            self.refuse_shapes(at, "two indices, as in A[1,2]", [size], "give row and column")
        if any(p > end for p, end in zip(places, ends, strict=True)):
            got = f"[{', '.join(map(str, places))}] of {describe_size(size)}"
            self.fail(at, "an index up to the last entry, counted from 1", got, "correct it", ShapeError)
        part = build("index", (value, *map(build_number, places)))
        self.places.setdefault(part, at)
        return part

    def place(self) -> int:
        """A whole number from 1 on."""
        token = self.tokens[self.position]
        if not (token.isdigit() and len(token) < 5 and int(token) >= 1):
            self.unexpected("a whole number from 1 on as an index")
        self.position += 1
        return int(token)

    def rows(self) -> Tree:
        """A vector by its entries, or a matrix by its rows."""
        at = self.position
        self.position += 1
        rows, deep = [], self.tokens[self.position] == "["
        while True:
            rows.append(self.row() if deep else [self.entry()])
            if self.tokens[self.position] != ",":
                break
            self.position += 1
        if self.tokens[self.position] != "]":
            self.unexpected(", or ] behind an entry")
        self.position += 1
        if len({*map(len, rows)}) > 1:
            got = f"rows of {', '.join(str(len(row)) for row in rows)}"
            self.fail(at, "rows of one length", got, "correct the matrix", ShapeError)
        lines = [build("row", tuple(row)) for row in rows]
        part = build("matrix", tuple(lines))
        self.places.setdefault(part, at)
        self.sizes[part] = (len(rows), len(rows[0]))
        return part

    def row(self) -> list[Tree]:
        """One row in brackets."""
        if self.tokens[self.position] != "[":
            self.unexpected("[ before a row")
        entries: list[Tree] = []
        while not entries or self.tokens[self.position] == ",":
            self.position += 1
            entries.append(self.entry())
        if self.tokens[self.position] != "]":
            self.unexpected(", or ] behind an entry")
        self.position += 1
        return entries

    def entry(self) -> Tree:
        """A number in a vector or matrix."""
        at = self.position
        value = self.nested(at, self.sum)
        if value in self.sizes:
            self.refuse_shapes(at, "numbers as entries", [self.sizes[value]], "write them out, or use diag and @")
        return value

    def name(self, at: int, token: str) -> Tree:
        """A vector or matrix, a function of them, or what numbers have."""
        called = self.tokens[self.position] == "("
        if token in self.arrays and not called:
            part = build(SYMBOL, (token,))
            if self.arrays[token] is not None:
                self.sizes[part] = self.arrays[token]
                return part
        if called and token in TAKES and token not in (self.names or ()):
            return self.call(at, token)
        if called and token in BINDERS and token not in (self.names or ()):
            return self.bind(at, token)
        return super(ValueReader, self).name(at, token)

    def call(self, at: int, name: str) -> Tree:
        """A function of vectors and matrices, a condition with its two values, or a derivative."""
        opening, (words, least, most) = self.position, TAKES[name]
        self.position += 1
        arguments = [self.nested(opening, self.relation if name == "where" else self.sum)]
        while self.tokens[self.position] == ",":
            self.position += 1
            arguments.append(self.nested(opening, self.sum))
        self.close(opening)
        if not least <= len(arguments) <= most:
            number = f"{len(arguments)} argument{'s' * (len(arguments) > 1)}"
            self.fail(at, f"{name} of {words}", number, "correct the call", ShapeError)
        if name == "diff" and arguments[1].head not in (SYMBOL, "index"):
            self.fail(at, "a symbol as the second argument of diff", "another expression", "name the symbol")
        if name == "diff" and len(arguments) == 3 and not is_count(arguments[2], MOST_ORDER):
            self.fail(at, f"a whole number of times from 1 to {MOST_ORDER} in diff", "another one", "correct it")
        return self.make(at, name, *arguments)

    def bind(self, at: int, name: str) -> Tree:
        """A function with a variable of its own, which is a number inside the call, whatever it is outside."""
        opening, words, most = self.position, *BINDERS[name]
        places = self.list_arguments(opening)
        if len(places) != most:
            number = f"{len(places)} argument{'s' * (len(places) > 1)}"
            self.fail(at, f"{name} of {words}", number, "correct the call", ShapeError)
        variable = self.tokens[places[1]]
        plain = variable[:1].isalpha() and variable not in (*RESERVED, INFINITE) and places[2] == places[1] + 2
        if not plain or self.arrays.get(variable) is not None:
            got = "another expression" if not plain else describe_size(self.arrays[variable])
            self.fail(places[1], f"the name of a number as the variable of {name}", got, "name another one")
        own = build(SYMBOL, (variable,))
        names, leaf = self.names, self.leaves.get(variable)
        self.names, self.leaves[variable] = {*(names or ()), variable}, own
        self.position = opening + 1
        arguments = [self.nested(opening, self.sum), own]
        self.names = names
        self.leaves.pop(variable)
        self.leaves |= {variable: leaf} if leaf is not None else {}
        for place in places[2:]:
            self.position = place
            arguments.append(self.end(opening))
        self.close(opening)
        return self.make(at, name, *arguments)

    def end(self, opening: int) -> Tree:
        """A number, oo or -oo."""
        minus = self.tokens[self.position] == "-"
        if self.tokens[self.position + minus] != INFINITE:
            return self.nested(opening, self.sum)
        self.position += 1 + minus
        if self.tokens[self.position] not in (",", ")"):
            self.unexpected("oo alone")
        return build(PRODUCT, (MINUS_ONE, build(SYMBOL, (INFINITE,)))) if minus else build(SYMBOL, (INFINITE,))

    def list_arguments(self, opening: int) -> list[int]:
        """The first token of each argument of a call."""
        places, depth = [opening + 1], 0
        for k in range(opening, len(self.tokens)):
            token = self.tokens[k]
            depth += (token in ("(", "[")) - (token in (")", "]"))
            if depth == 1 and token == ",":
                places.append(k + 1)
            if depth == 0 or not token:
                break
        return places

    def relation(self) -> Tree:
        """Two sides with a relation between them."""
        left, at = self.sum(), self.position
        if self.tokens[at] not in RELATIONS:
            self.unexpected(f"one of {' '.join(RELATIONS)}")
        self.position += 1
        part = build(self.tokens[at], (left, self.sum()))
        sizes = [self.sizes.get(side) for side in part.args]
        self.places.setdefault(part, at)
        self.size_of(at, part, sizes)
        if sizes[0] is not None and self.tokens[at] != "=":
            self.refuse_shapes(at, f"numbers beside {self.tokens[at]}", sizes, "compare entries")
        return part


def is_count(tree: Tree, most: int = 64) -> bool:
    """Whether a tree is a whole number from 1 to an end."""
    return tree.head == NUMBER and tree.args[0].denominator == 1 and 1 <= tree.args[0] <= most


def size_of(tree: Tree) -> int | str:
    """A whole number, or the name of a dimension."""
    return str(tree.args[0]) if tree.head == SYMBOL else int(tree.args[0])


def list_free_names(tree: Tree) -> frozenset[str]:
    """The names in a tree, without the variables of integrals, sums, products and limits inside these.

    >>> sorted(list_free_names(read_value("integral(a*x, x, 0, b)", {"a": None, "b": None}).tree))
    ['a', 'b']
    """

    def collect(part: Tree, inner: list[frozenset[str]]) -> frozenset[str]:
        if part.head == SYMBOL:
            return frozenset(part.args) - {INFINITE}
        if part.head in BINDERS:
            return (inner[0] - inner[1]).union(*inner[2:])
        return frozenset().union(*inner)

    return fold_tree(tree, collect)


@dataclass(frozen=True, slots=True)
class Value:
    """A text that was read: its tree, and rows and columns, None for a number."""

    tree: Tree
    size: Size


def read_value(text: str, arrays: Mapping[str, Size], *, where: str = "") -> Value:
    """The tree and the shape of a text.

    arrays : declared name -> rows and columns, None for a number

    Raises EmptyError, ExpressionSyntaxError, UnknownSymbolError, ShapeError or TooLargeError, with the column.

    >>> read_value("cross(u, [0, 0, 1])", {"u": (3, 1)}).size
    (3, 1)
    """
    reader = start_reading(text, arrays, where)
    tree = guard(reader, reader.whole)
    return Value(tree, reader.sizes.get(tree))


def read_hypothesis(text: str, arrays: Mapping[str, Size], *, where: str = "") -> Tree:
    """The tree of two sides with a relation between them; raises as :func:`read_value`."""
    reader = start_reading(text, arrays, where)

    def whole() -> Tree:
        part = reader.relation()
        if reader.tokens[reader.position]:
            reader.unexpected("the end of the hypothesis")
        return part

    return guard(reader, whole)


def guard(reader: ValueReader, read: Callable[[], Tree]) -> Tree:
    """The tree, or an error for nesting that is too deep."""
    try:
        return read()
    except RecursionError:
        reader.source.fail(0, "less nesting", "an expression too deep to read", "give parts a name", TooLargeError)


def start_reading(text: Any, arrays: Mapping[str, Size], where: str) -> ValueReader:
    """A reader at the beginning of a text."""
    if not isinstance(text, str):
        raise ExpressionSyntaxError(f"expected an expression as text; got {quote(text)}; put it in quotes", where=where)
    if not text.strip():
        raise EmptyError('expected an expression; got an empty text; write one, such as "0"', where=where)
    source = Source(text, where, wide=True)
    sides = {side for size in arrays.values() if size for side in size if isinstance(side, str)}
    arrays = {**dict.fromkeys(sides), **arrays}  # a dimension is a number
    names: Collection[str] = arrays.keys()
    return ValueReader(source, split_tokens(source, LENGTH), names, arrays=arrays)


# -- LaTeX -----------------------------------------------------------------------------

FORMS = {
    "dot": r"{0} \cdot {1}",
    "cross": r"{0} \times {1}",
    "norm": r"\left\|{0}\right\|",
    "skew": r"\left[{0} \times\right]",
    "qmul": r"{0} \otimes {1}",
    "dot_": r"\frac{{d}}{{dt}} {0}",
    "floor": r"\left\lfloor {0} \right\rfloor",
    "eye": r"\mathbf{{I}}_{{{0}}}",
    "zeros": r"\mathbf{{0}}_{{{0} \times {1}}}",
    "where": r"\begin{{cases}}{1} & {0} \\ {2} & \text{{otherwise}}\end{{cases}}",
}
#: Forms that enclose their parts by signs of their own.
CLOSED = ("norm", "skew", "floor", "eye", "zeros", "where")
BOUND = {
    "integral": r"\int_{{{2}}}^{{{3}}} {0} \, d{1}",
    "sum": r"\sum_{{{1} = {2}}}^{{{3}}} {0}",
    "product": r"\prod_{{{1} = {2}}}^{{{3}}} {0}",
    "limit": r"\lim_{{{1} \to {2}}} {0}",
}


class ValueWriter(LatexWriter):
    """LaTeX of trees with vectors and matrices, as they were written."""

    def spell(self, part: Tree, inner: list[Text]) -> Text:
        """A part from the texts of its own parts."""
        texts = [text.text for text in inner]
        if part.head == SYMBOL and part.args[0] == INFINITE:
            return Text(r"\infty", WHOLE)
        if part.head == "@":
            minus = texts[0].startswith("-") and part.args[0].head == PRODUCT  # (-A) B is -A B
            before = texts[0] if minus else self.enclose(inner[0], TIGHT)
            return Text(rf"{before} \, {self.enclose(inner[1], RAISED)}", LOOSE if minus else TIGHT)
        if part.head in ("T", "transpose", "inv", "conj"):
            raised = {"T": r"\top", "transpose": r"\top", "inv": "-1", "conj": "*"}[part.head]
            return Text(f"{self.enclose(inner[0], WHOLE)}^{{{raised}}}", RAISED)
        if part.head == "index":
            return Text(f"{{{self.enclose(inner[0], WHOLE)}}}_{{{', '.join(texts[1:])}}}", WHOLE)
        if part.head == "row":
            return Text(" & ".join(texts), WHOLE)
        if part.head == "matrix":
            lines = r" \\ ".join(texts)
            return Text(rf"\begin{{bmatrix}}{lines}\end{{bmatrix}}", WHOLE)
        if part.head in RELATIONS:
            sign = {"!=": r"\ne", "<=": r"\le", ">=": r"\ge"}.get(part.head, part.head)
            return Text(f"{texts[0]} {sign} {texts[1]}", LOOSE)
        if part.head in FORMS:
            closed = part.head in CLOSED
            written = FORMS[part.head].format(*(self.enclose(text, LOOSE if closed else RAISED) for text in inner))
            return Text(written, WHOLE if closed else TIGHT)
        if part.head in BOUND:
            return Text(BOUND[part.head].format(self.enclose(inner[0], TIGHT), *texts[1:]), LOOSE)
        if part.head == "diff":
            order = "" if len(texts) < 3 else f"^{{{texts[2]}}}"
            operator = rf"\frac{{\partial{order}}}{{\partial {texts[1]}{order}}}"
            return Text(f"{operator} {self.enclose(inner[0], RAISED)}", TIGHT)
        return super().spell(part, inner)


def print_value_latex(tree: Tree) -> str:
    r"""The tree in LaTeX, as it was written.

    >>> print(print_value_latex(read_value("A.T @ v", {"A": (3, 3), "v": (3, 1)}).tree))
    A^{\top} \, v
    """
    return fold_tree(tree, ValueWriter().spell).text


__all__ = ["NavsymError", "Value", "describe_size", "is_wide", "print_value_latex", "read_hypothesis", "read_value"]
