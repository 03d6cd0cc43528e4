"""What the parts of a printed formula mean: shapes of vectors and matrices decide which product is meant.

The outcome is text of the language of files. Where readers of the printed line differ, the formula is refused.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from navsym.language.latex.notation import Notation, Shape
from navsym.language.latex.parts import Part, Refusal, join_terms, list_names
from navsym.language.names import FUNCTIONS

#: How tightly a text binds.
SUM, PRODUCT, POWER, WHOLE = range(4)
SCALAR: Shape = ()
WAVES = ("sin", "cos", "tan")
WRITE = "write parentheses"
CALLING = ("(", "[", "{<")
#: The methods of heads that are no words.
METHODS = {"+": "terms", "*": "product", "^": "power", "-": "minus", "norm": "abs"}


@dataclass(frozen=True, slots=True)
class Term:
    """Text of the language with its shape.

    column        : for a transposed column, the text of the column
    is_quaternion : True for a column of four that is multiplied as a quaternion
    is_unit       : True for a quaternion of length one
    """

    text: str
    level: int = WHOLE
    shape: Shape = SCALAR
    column: str = ""
    is_quaternion: bool = False
    is_unit: bool = False

    def inside(self, floor: int) -> str:
        """The text in brackets when it binds less tightly than ``floor`` asks."""
        return self.text if self.level >= floor else f"({self.text})"


def explain(part: Part, notation: Notation, as_column: bool = False) -> Term:
    """The text that the parts mean. Raises Refusal where they have no meaning, or two.

    as_column : True for a row of entries beside a column: its entries below each other
    """
    explainer = Explainer(notation)
    return explainer.stack(part) if as_column else explainer.explain(part)


def list_columns(parts: list[Part], notation: Notation) -> list[bool]:
    """For both sides, whether a row or a list of entries stands for a column, because the other side is one."""
    rows = [is_row(part) for part in parts]
    if all(rows):
        heads = {part.head for part in parts}
        blocks = heads == {"matrix"} and any(explain(c, notation).shape for part in parts for c in part.args[1:])
        return [blocks or len(heads) == 2] * 2
    if not any(rows):
        return rows
    other = explain(parts[rows.index(False)], notation).shape
    return [row and other[1:] == ("1",) and other[0] != "1" for row in rows]


def take_order(part: Part) -> tuple[Part, tuple[str, int] | None]:
    """A side without ``O(x^k)`` at its end, and the name with its order. Raises Refusal for another O."""
    *terms, last = part.args if part.head == "+" else (part,)
    last = last.args[0] if last.head == "-" else last
    if last.head != "order":
        return part, None
    inner = last.args[0]
    base, power = inner.args if inner.head == "^" else (inner, Part("num", ("1",)))
    whole = power.head == "num" and re.fullmatch("[1-9][0-9]?", power.args[0])
    if len(last.args) != 1 or base.head != "name" or not whole:
        raise Refusal(last.at, "O(x^k) of one name and a whole power", "another O", "write it so, or the claim by hand")
    return join_terms(terms) if terms else Part("num", ("0",), last.at), (base.args[0], int(power.args[0]))


def is_row(part: Part) -> bool:
    """True for several entries beside each other."""
    return part.head == "list" or (part.head == "matrix" and part.args[0] == 1 and len(part.args) > 2)


def size_unit(term: Term, size: str) -> Term:
    """A multiple of the unit matrix, of which the size was not printed, with its size."""
    is_open = "eye(?)" in term.text and term.shape == ("?", "?")
    return replace(term, text=term.text.replace("eye(?)", f"eye({size})"), shape=(size, size)) if is_open else term


def fit_sides(left: Term, right: Term, at: int) -> tuple[Term, Term]:
    """Two sides of one shape; a plain 0 takes the shape of the other side."""
    left, right = size_unit(left, (*right.shape, "?")[0]), size_unit(right, (*left.shape, "?")[0])
    if left.shape != right.shape and not may_be_same(left.shape, right.shape):
        for one, other in ((left, right), (right, left)):
            if one.text == "0" and other.shape:
                zero = Term(f"zeros({', '.join(other.shape)})", WHOLE, other.shape)
                return (zero, other) if one is left else (other, zero)
        got = f"{say(left.shape)} and {say(right.shape)}"
        raise Refusal(at, "two sides of one shape", got, "correct a declaration")
    return left, right


def may_be_same(one: Shape, other: Shape) -> bool:
    """True for equal shapes, and where a size is not known."""
    return len(one) == len(other) and all(a == b or "?" in (a, b) for a, b in zip(one, other, strict=True))


def is_space_vector(shape: Shape) -> bool:
    """True for a column of three, or of open size."""
    return shape in (("3", "1"), ("?", "1"))


def fits(one: str, other: str) -> bool:
    """True for sizes that agree; an open size is not taken for 1, which would make another product."""
    return one == other or ("?" in (one, other) and "1" not in (one, other))


def say(shape: Shape) -> str:
    """A shape in words."""
    return "a scalar" if not shape else f"a vector of {shape[0]}" if shape[1] == "1" else f"{shape[0]} by {shape[1]}"


class Explainer:
    """One method for each head of a part."""

    def __init__(self, notation: Notation) -> None:
        self.notation = notation

    def explain(self, part: Part) -> Term:
        """Text and shape of a part."""
        if part.head == "index":
            return Term(f"{part.args[0]}[{','.join(part.args[1:])}]")
        if part.head == "eye":
            return Term(f"eye({part.args[0]})", shape=(part.args[0],) * 2)
        if part.head == "zeros":
            return Term(f"zeros({', '.join(part.args)})", shape=part.args)
        if part.head == "order":
            expected = "O(x^k) as the last term of the right side"
            raise Refusal(part.at, expected, "it elsewhere", "move it, or leave it out")
        if part.head == "()":
            return self.explain(part.args[1])
        method: Callable[[Part], Term] = getattr(self, f"explain_{METHODS.get(part.head, part.head)}")
        return method(part)

    def scalar(self, part: Part, what: str) -> Term:
        """A part that has to be a scalar."""
        term = self.explain(part)
        if term.shape:
            raise Refusal(part.at, f"a scalar {what}", say(term.shape), "correct the formula or a declaration")
        return term

    def explain_num(self, part: Part) -> Term:
        (text,) = part.args
        return Term(f"0{text}" if text[0] == "." else text)

    def explain_name(self, part: Part) -> Term:
        (name,) = part.args
        quaternion = self.notation.quaternions.get(name)
        return Term(name, WHOLE, self.notation.shapes.get(name, SCALAR), "", quaternion is not None, bool(quaternion))

    def explain_minus(self, part: Part) -> Term:
        term = self.explain(part.args[0])
        return Term(f"-{term.inside(PRODUCT)}", SUM, term.shape, "", term.is_quaternion)

    def explain_terms(self, part: Part) -> Term:
        """A sum of terms of one shape."""
        terms = [self.explain(term.args[0] if term.head == "-" else term) for term in part.args]
        shape = next((term.shape for term in terms if "?" not in term.shape), terms[0].shape)
        for piece, term in zip(part.args, terms, strict=True):
            if not may_be_same(term.shape, shape):
                got = f"{say(shape)} and {say(term.shape)}"
                raise Refusal(piece.at, "terms of one shape", got, "correct the formula or a declaration")
        terms = [size_unit(term, shape[0]) if shape else term for term in terms]
        signs = [term.head == "-" for term in part.args]
        text = ("-" if signs[0] else "") + terms[0].inside(PRODUCT)
        for minus, term in zip(signs[1:], terms[1:], strict=True):
            text += f" {'-' if minus else '+'} {term.inside(PRODUCT)}"
        return Term(text, SUM, shape, "", any(term.is_quaternion for term in terms))

    # -- products ----------------------------------------------------------------------------

    def explain_product(self, part: Part) -> Term:
        """A product: its marks and the shapes of its factors say which one."""
        args = self.drop_variables(part.args)
        if len(args) == 1:
            return self.explain(args[0])
        factors, marks = [self.explain(factor) for factor in args[::2]], ["", *args[1::2]]
        columns = [f.shape[1:] == ("1",) or (bool(f.shape) and f.shape[0] == f.shape[1]) for f in factors]
        open_ended = refuse_doubtful(args, columns if "." not in marks else [False] * len(columns))
        places = [place for place, factor in enumerate(factors) if factor.shape]
        for place, mark in enumerate(marks):
            if mark == "*" and places:
                raise Refusal(args[2 * place].at, "scalars beside *", "others: which product?", r"write \cdot or none")
            if mark == "/" and factors[place].shape:
                raise Refusal(args[2 * place].at, "a scalar as divisor", say(factors[place].shape), "use an inverse")
        if not places:
            return multiply_scalars(factors, marks, args)
        whole = self.multiply([factors[p] for p in places], [marks[p] for p in places[1:]], args[2 * places[-1]].at)
        if open_ended and not whole.shape:
            raise Refusal(args[0].at, *DOUBTFUL_ARGUMENT)
        scalars = [(m, f) for m, f in zip(marks, factors, strict=True) if not f.shape]
        return scale(whole, [f for m, f in scalars if m != "/"], [f for m, f in scalars if m == "/"])

    def drop_variables(self, args: tuple[Any, ...]) -> tuple[Any, ...]:
        """``x(t)`` of a declared function of t is the name x, and ``x(t)^2`` its square.

        Another name before one name in brackets is refused, and a function of t before what else holds t.
        """
        kept: list[Any] = [args[0]]
        for mark, factor in zip(args[1::2], args[2::2], strict=True):
            before = kept[-1].args[0] if kept[-1].head in ("dot", "^") else kept[-1]
            group = factor.args[0] if factor.head == "^" else factor
            if mark == "" and before.head in ("name", "index") and group.head == "()" and group.args[0] in CALLING:
                name, inside = before.args[0], group.args[1]
                variable, inner = self.notation.functions.get(name), inside.args[0]
                is_single = inside.head in ("name", "num")
                if is_single and variable == inner and kept[-1].head != "^":
                    kept[-1] = kept[-1] if factor is group else replace(factor, args=(kept[-1], *factor.args[1:]))
                    continue
                if is_single or variable in list_names(inside):
                    question = f"is {name}({inner if is_single else '...'}) a product or a function?"
                    remedy = r"write \cdot, or name the value in [latex]"
                    raise Refusal(group.at, "a product that is plain", question, remedy)
            kept += [mark, factor]
        return tuple(kept)

    def multiply(self, factors: list[Term], marks: list[str], at: int) -> Term:
        """The product of vectors, matrices and quaternions."""
        if len(factors) == 1:
            return factors[0]
        vectors = all(f.shape[1] == "1" for f in factors)
        if all(f.is_quaternion for f in factors) and set(marks) <= {"", "ox"}:
            text = factors[0].text
            for factor in factors[1:]:
                text = f"qmul({text}, {factor.text})"
            return Term(text, WHOLE, ("4", "1"), "", True, all(f.is_unit for f in factors))
        if "ox" in marks:
            raise Refusal(at, r"quaternions on both sides of \otimes", "another factor", "declare it a quaternion")
        if "x" in marks:
            if len(factors) > 2 or not vectors or any(f.shape[0] not in ("3", "?") for f in factors):
                raise Refusal(at, r"two vectors of three beside \times", "others", WRITE)
            return Term(f"cross({factors[0].text}, {factors[1].text})", WHOLE, ("3", "1"))
        if "." in marks and vectors:
            if len(factors) > 2 or not may_be_same(factors[0].shape, factors[1].shape):
                raise Refusal(at, r"two vectors of one length beside \cdot", "others", WRITE)
            return Term(f"dot({factors[0].text}, {factors[1].text})")
        return chain(factors, at)

    def explain_list(self, part: Part) -> Term:
        """Entries with commas, which are a column beside a declared one only."""
        raise Refusal(part.at, "one value in parentheses", "a list: a vector or what?", r"write \begin{bmatrix}, or ^T")

    def stack(self, part: Part) -> Term:
        """The entries of a row or a list below each other: scalars and columns."""
        terms = [self.explain(cell) for cell in part.args[1:]]
        if any(term.shape and term.shape[1] != "1" for term in terms):
            raise Refusal(part.at, "scalars and columns as entries", "a matrix", r"write \begin{bmatrix} in blocks")
        sizes = [term.shape[0] if term.shape else "1" for term in terms]
        return Term("[" + ", ".join(f"[{term.text}]" for term in terms) + "]", WHOLE, (add(sizes), "1"))

    def explain_power(self, part: Part) -> Term:
        """A power, or a mark in its place."""
        mark = part.args[1].args[0] if part.args[1].head == "mark" else ""
        if part.args[0].head == "list" and mark in ("T", "top"):
            return self.stack(part.args[0])
        base, exponent = self.explain(part.args[0]), part.args[1]
        if exponent.head == "mark":
            return self.explain_mark(base, exponent)
        power = self.scalar(exponent, "as exponent")
        if not base.shape:
            if part.args[0].head == "num" and part.args[0].args[0] == "oo":
                raise Refusal(part.at, "a finite number", "a power of infinity", "correct it")
            return Term(f"{base.inside(WHOLE)}**{power.inside(WHOLE)}", POWER)
        if power.text == "-1" and base.is_quaternion:
            text = f"conj({base.text})"
            conjugate = Term(text, WHOLE, base.shape, "", True, True)
            return conjugate if base.is_unit else Term(f"{text}/norm({base.text})**2", PRODUCT, base.shape, "", True)
        if power.text == "-1" and base.shape[0] == base.shape[1]:
            return Term(f"inv({base.text})", WHOLE, base.shape)
        if power.text in ("2", "3") and base.shape[0] == base.shape[1] and not base.is_quaternion:
            return Term(" @ ".join([base.inside(POWER)] * int(power.text)), PRODUCT, base.shape)
        question = f"{base.text} with {power.text}: is it a power, a frame or an index?"
        raise Refusal(exponent.at, "a power of a scalar", question, "write the name in [latex], or a norm")

    def explain_mark(self, base: Term, mark: Part) -> Term:
        """Transposes, conjugates and cross matrices."""
        kind = mark.args[0]
        if kind in ("T", "top", "-T", "-top"):
            if not base.shape and kind == "T" and "T" in self.notation and not self.notation.shapes["T"]:
                return Term(f"{base.inside(WHOLE)}**T", POWER)
            if not base.shape:
                expected = "a vector or matrix before a transpose"
                raise Refusal(mark.at, expected, "a scalar", "declare it, or name the power")
            if kind[0] == "-":
                if base.shape[0] != base.shape[1]:
                    raise Refusal(mark.at, "a square matrix", say(base.shape), "correct a declaration")
                return Term(f"inv({base.text}).T", WHOLE, base.shape)
            column = base.text if base.shape[1] == "1" and base.shape[0] != "1" else ""
            return Term(f"{base.inside(WHOLE)}.T", WHOLE, base.shape[::-1], column)
        if kind == "*" and base.is_quaternion:
            return Term(f"conj({base.text})", WHOLE, base.shape, "", True, base.is_unit)
        if kind == "skew" and is_space_vector(base.shape):
            return Term(f"skew({base.text})", WHOLE, ("3", "3"))
        expected = "a transpose, a conjugate of a quaternion or a power"
        raise Refusal(mark.at, expected, "another mark", "name it in [latex]")

    def explain_frac(self, part: Part) -> Term:
        above, below = self.explain(part.args[0]), self.scalar(part.args[1], "as denominator")
        return Term(f"{above.inside(PRODUCT)}/{below.inside(POWER)}", PRODUCT, above.shape, "", above.is_quaternion)

    def explain_sqrt(self, part: Part) -> Term:
        inner = self.scalar(part.args[0], "under the root")
        if len(part.args) == 1:
            return Term(f"sqrt({inner.text})")
        order = self.scalar(part.args[1], "as order of the root")
        if not re.fullmatch("[2-9]", order.text):
            raise Refusal(part.args[1].at, "a root of order 2 to 9", order.text, "write a power")
        return Term(f"{inner.inside(WHOLE)}**(1/{order.text})", POWER)

    # -- functions ---------------------------------------------------------------------------

    def explain_inner(self, part: Part) -> Term:
        """The inner product of two columns."""
        one, other = map(self.explain, part.args)
        if one.shape[1:] != ("1",) or not may_be_same(one.shape, other.shape):
            raise Refusal(part.at, "two columns of one length", f"{say(one.shape)} and {say(other.shape)}", WRITE)
        return Term(f"dot({one.text}, {other.text})")

    def explain_cases(self, part: Part) -> Term:
        """``where`` in the order of the rows; two comparisons in a row stand inside each other."""
        *rows, last = part.args
        whole = self.explain(last)
        for value, condition in reversed(list(zip(rows[::2], rows[1::2], strict=True))):
            term = self.explain(value)
            if not may_be_same(term.shape, whole.shape):
                got = f"{say(term.shape)} and {say(whole.shape)}"
                raise Refusal(value.at, "values of one shape", got, "correct one")
            sides = [self.scalar(side, "in a condition").text for side in condition.args[::2]]
            for place in reversed(range(len(sides) - 1)):
                compared = f"{sides[place]} {condition.args[2 * place + 1]} {sides[place + 1]}"
                term = Term(f"where({compared}, {term.text}, {whole.text})", WHOLE, whole.shape)
            whole = term
        return whole

    def explain_abs(self, part: Part) -> Term:
        inner = self.explain(part.args[0])
        if not inner.shape and part.head == "abs":
            return Term(f"abs({inner.text})")
        if not inner.shape or inner.shape[1] != "1":
            raise Refusal(part.at, "the length of a vector", say(inner.shape), "write det, or name the norm in [latex]")
        return Term(f"norm({inner.text})")

    def explain_floor(self, part: Part) -> Term:
        return Term(f"floor({self.scalar(part.args[0], 'in the brackets of floor').text})")

    def explain_skew(self, part: Part) -> Term:
        inner = self.explain(part.args[0])
        if not is_space_vector(inner.shape):
            raise Refusal(part.at, "the cross matrix of a vector of three", say(inner.shape), "declare { vector = 3 }")
        return Term(f"skew({inner.text})", WHOLE, ("3", "3"))

    def explain_call(self, part: Part) -> Term:
        """A function at its arguments, with the power behind its name."""
        name, power, _, *pieces = part.args
        if name == "log?":
            question = "is \\log natural or decimal?"
            raise Refusal(part.at, r"\ln or \log_{10}", question, r"write log = '\log' in [latex] where it is natural")
        arguments = [self.explain(piece) for piece in pieces]
        called = self.apply(name, arguments, part)
        if power is None:
            return called
        exponent = self.explain(power) if power.head != "mark" else Term("")
        if not re.fullmatch("[1-9][0-9]?", exponent.text) or called.shape:
            got = "the inverse function, or one over the function?" if exponent.text == "-1" else "another power"
            raise Refusal(power.at, "a positive whole power of a function", got, "write the inverse by its name")
        return Term(f"{called.inside(WHOLE)}**{exponent.text}", POWER)

    def apply(self, name: str, arguments: list[Term], part: Part) -> Term:
        """A function of the language at its arguments."""
        shapes, text = [a.shape for a in arguments], ", ".join(a.text for a in arguments)
        square = len(shapes) == 1 and len(shapes[0]) == 2 and fits(*shapes[0])
        if name in ("log_2", "log_10") and shapes == [SCALAR]:
            return Term(f"log({text})/log({name[4:]})", PRODUCT)
        if name in ("det", "trace") and square:
            return Term(f"{name}({text})")
        if name in ("exp", "expm") and square:
            return Term(f"expm({text})", WHOLE, shapes[0])
        if name == "skew" and len(shapes) == 1 and is_space_vector(shapes[0]):
            return Term(f"skew({text})", WHOLE, ("3", "3"))
        if name == "rot" and shapes in ([("4", "1")], [("?", "1")]):
            return Term(f"rot({text})", WHOLE, ("3", "3"))
        if name == "E" and len(shapes) == 1:
            return Term(f"E({text})", WHOLE, shapes[0])
        is_pair = len(shapes) < 3 and {shape[1:] for shape in shapes} in ({()}, {("1",)})
        if name == "cov" and is_pair:
            return Term(f"cov({text})", WHOLE, (*shapes[0][:1], *shapes[-1][:1]))
        if name == "diag" and not any(shapes):
            return Term(f"diag({text})", WHOLE, (str(len(shapes)),) * 2)
        wanted = 2 if name == "atan2" else len(shapes) if name in ("min", "max") and len(shapes) > 1 else 1
        known = name in FUNCTIONS or name in ("sign", "erf") or (name in ("min", "max") and wanted > 1)
        if known and shapes == [SCALAR] * wanted:
            return Term(f"{name}({text})")
        got = ", ".join(map(say, shapes))
        raise Refusal(part.at, f"arguments that {name} takes", got, "correct the formula or a declaration")

    def explain_matrix(self, part: Part) -> Term:
        """A matrix of scalars, or of blocks that fit."""
        count, *cells = part.args
        terms = [self.explain(cell) for cell in cells]
        width = len(cells) // count
        rows = [terms[place : place + width] for place in range(0, len(terms), width)]
        text = "[" + ", ".join("[" + ", ".join(term.text for term in row) + "]" for row in rows) + "]"
        sizes = [[term.shape or ("1", "1") for term in row] for row in rows]
        for row in sizes:
            for size, first in zip(row, sizes[0], strict=True):
                if not fits(size[0], row[0][0]) or not fits(size[1], first[1]):
                    raise Refusal(part.at, "blocks that fit", "others", r"write zeros as \mathbf{0}_{3\times 3}")
        return Term(text, WHOLE, (add(row[0][0] for row in sizes), add(size[1] for size in sizes[0])))

    # -- calculus ----------------------------------------------------------------------------

    def explain_dot(self, part: Part) -> Term:
        inner, order = self.explain(part.args[0]), part.args[1]
        return Term("dot_(" * order + inner.text + ")" * order, WHOLE, inner.shape, "", inner.is_quaternion)

    def explain_diff(self, part: Part) -> Term:
        body, variable, order, letter, _ = part.args
        if body.head in ("+", "*"):
            raise Refusal(body.at, "one factor under the derivative", "more", WRITE)
        inner, by = self.explain(body), self.explain(variable)
        moving = by.text in self.notation.functions.values() or (by.text == "t" and self.notation.rates)
        if letter == "p" and moving:
            raise Refusal(part.at, "a derivative that is plain", "partial or total?", r"write \dot or \frac{d}{dt}")
        if by.shape and (by.shape[1] != "1" or inner.shape[1:] != ("1",) or order > 1):
            raise Refusal(part.at, "a column differentiated by a column", "others", "write the entries")
        shape = (inner.shape[0], by.shape[0]) if by.shape else inner.shape
        behind = f", {order}" if order > 1 else ""
        return Term(f"diff({inner.text}, {by.text}{behind})", WHOLE, shape)

    def explain_limit(self, part: Part) -> Term:
        body, by, end = part.args
        name = self.scalar(by, "that moves").text
        self.require_free(body, name, part.at)
        return Term(f"limit({self.explain(body).text}, {name}, {self.scalar(end, 'as point').text})", WHOLE,
                    self.explain(body).shape)  # fmt: skip

    def require_free(self, body: Part, index: str, at: int) -> None:
        """Refuse a name whose LaTeX depends on the bound letter while its text is a constant."""
        for name in list_names(body):
            if name == index or self.notation.functions.get(name) == index:
                continue
            if index in list_letters(dict(self.notation.spellings).get(name, ""), name):
                question = f"{name}, which depends on {index} as it is printed"
                raise Refusal(at, f"names that do not depend on {index}, or entries of a vector", question,
                              f'declare {{ function = "{index}" }}, or a vector for its entries')  # fmt: skip

    def explain_integral(self, part: Part) -> Term:
        body, variable, start, end = part.args
        self.require_free(body, str(variable.args[0]), part.at)
        inner, by = self.explain(body), self.scalar(variable, "under d")
        ends = [self.scalar(piece, "as end of the integral").text for piece in (start, end)]
        return Term(f"integral({inner.text}, {by.text}, {ends[0]}, {ends[1]})", WHOLE, inner.shape)

    def explain_sum(self, part: Part) -> Term:
        name, body, index, start, end = part.args
        if self.notation.shapes.get(index):
            raise Refusal(part.at, "a scalar as the index", f"the vector or matrix {index}", "rename it")
        self.require_free(body, index, part.at)
        inner = self.explain(body)
        ends = [self.scalar(piece, "as end of the sum").text for piece in (start, end)]
        if name == "product" and inner.shape:
            raise Refusal(part.at, "a product of scalars", "matrices", "write the factors")
        return Term(f"{name}({inner.text}, {index}, {ends[0]}, {ends[1]})", WHOLE, inner.shape)


def list_letters(latex: str, name: str) -> set[str]:
    """The names in the LaTeX of a name, words apart; without LaTeX those in its subscript."""
    if not latex:
        pieces = name.split("_")[1:]
        return {letter for piece in pieces for letter in (piece, *(piece if len(piece) < 3 else ""))}
    text = re.sub(r"\\(?:mathrm|text|textrm|operatorname)\s*\{[^{}]*\}", " ", latex)
    plain = re.sub(r"\\(?:mathbf|boldsymbol|bm|left|right)(?![A-Za-z])|[{}\s]", " ", text)
    found = re.findall(r"\\([A-Za-z]+)|([A-Za-z])(?: *_ *([A-Za-z0-9]))?", plain)
    letters = {piece for pieces in found for piece in pieces if piece}
    return letters | {f"{one}_{other}" for _, one, other in found if other}


DOUBTFUL_ARGUMENT = ("an argument in parentheses", "a factor that may be part of the argument or not", WRITE)


def refuse_doubtful(args: tuple[Any, ...], columns: list[bool]) -> bool:
    r"""Refuse a product that readers take differently. True where a column or square matrix ends the ``\sin a``.

    columns : which factors are such, so that no sine can be taken of them
    """
    factors, marks, open_ended = args[::2], args[1::2], False
    for place, mark in enumerate(marks):
        before, behind = factors[place], factors[place + 1]
        if "/" in marks[:place]:
            raise Refusal(behind.at, "one divisor behind /", "more factors: which are below the line?", r"write \frac")
        number = behind.args[0] if behind.head == "^" else behind
        if mark == "" and number.head == "num" and number.args[0][0] not in "po":
            raise Refusal(behind.at, "a number before its factors", "one behind", r"write \cdot, or a subscript")
        named = behind.args[0] if behind.head == "^" else behind
        if mark == "" and before.head == "name" and before.args[0] in ("Delta", "delta") and named.head == "name":
            question = f"is {before.args[0]} {named.args[0]} one name or a product?"
            raise Refusal(before.at, "a difference by its name", question, r"write it in [latex], or \cdot")
        is_fraction = behind.head == "frac" and all(piece.head == "num" for piece in behind.args)
        if mark == "" and before.head == "num" and is_fraction:
            raise Refusal(behind.at, "a number or a product", "a mixed number?", r"write \cdot")
        is_open = (before.head == "call" and not before.args[2]) or (before.head == "diff" and not before.args[4])
        if before.head == "integral" or (before.head == "diff" and is_open):
            raise Refusal(behind.at, "parentheses around what is integrated or differentiated", "none", WRITE)
        if is_open and mark == "" and before.head == "call" and before.args[0] in WAVES and columns[place + 1]:
            open_ended = True
        elif is_open and (mark == "/" or (mark == "" and behind.head != "call")):
            raise Refusal(behind.at, *DOUBTFUL_ARGUMENT)
    return open_ended


def multiply_scalars(factors: list[Term], marks: list[str], args: tuple[Any, ...]) -> Term:
    """A product of scalars in its order."""
    for place, mark in enumerate(marks):
        if mark == "ox":
            raise Refusal(args[2 * place].at, r"quaternions beside \otimes", "a scalar", "declare them")
    text = factors[0].inside(PRODUCT)
    for mark, factor in zip(marks[1:], factors[1:], strict=True):
        text += ("/" if mark == "/" else "*") + factor.inside(POWER)
    return Term(text, PRODUCT)


def scale(whole: Term, above: list[Term], below: list[Term]) -> Term:
    """A vector or matrix times scalars, which come first, over others."""
    text, level = whole.text, whole.level
    if above:
        head = "*".join([above[0].inside(PRODUCT), *(f.inside(POWER) for f in above[1:])])
        text, level = f"{head}*{whole.inside(POWER)}", PRODUCT
    for divisor in below:
        text, level = f"{text if level >= POWER or above else f'({text})'}/{divisor.inside(POWER)}", PRODUCT
    if not above and not below:
        return whole
    return Term(text, level, whole.shape, "", whole.is_quaternion)


def chain(factors: list[Term], at: int) -> Term:
    """A product of matrices; a row that is a transposed column, up to the next column, is a dot product."""
    for one, other in pairwise(factors):
        if not fits(one.shape[1], other.shape[0]):
            got = f"{say(one.shape)} and {say(other.shape)}"
            raise Refusal(at, "factors that fit", f"{got}: dot, cross or outer product?", r"write \cdot, \times or ^T")
    scalars: list[Term] = []
    for start, row in enumerate(factors):
        stop = next((p for p in range(start + 1, len(factors)) if factors[p].shape[1] == "1"), 0) if row.column else 0
        if stop:
            right = join_chain(factors[start + 1 : stop + 1])
            scalars.append(Term(f"dot({row.column}, {right.text})"))
            factors = factors[:start] + factors[stop + 1 :]
            break
    if not scalars:
        return join_chain(factors)
    if not factors:
        return scalars[0]
    return scale(chain(factors, at) if len(factors) > 1 else factors[0], scalars, [])


def join_chain(factors: list[Term]) -> Term:
    """Matrices with ``@`` between them."""
    if len(factors) == 1:
        return factors[0]
    for place, factor in enumerate(factors):
        near = factors[place - 1].shape[1] if place else factors[1].shape[0]
        factors = [*factors[:place], size_unit(factor, near), *factors[place + 1 :]]
    text = " @ ".join([factors[0].inside(PRODUCT) if "*" not in factors[0].text else factors[0].inside(POWER),
                       *(f.inside(POWER) for f in factors[1:])])  # fmt: skip
    quaternion = factors[-1].is_quaternion
    return Term(text, PRODUCT, (factors[0].shape[0], factors[-1].shape[1]), "", quaternion)


def add(sizes: Any) -> str:
    """A sum of sizes."""
    found = list(sizes)
    if "?" in found:
        return "?"
    if all(size.isdigit() for size in found):
        return str(sum(map(int, found)))
    return found[0] if len(found) == 1 else "+".join(found)
