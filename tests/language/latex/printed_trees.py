"""Random formulas with their values, printed to LaTeX in several styles: what is read back is evaluated by numpy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SUM, PRODUCT, OPEN, POWER, WHOLE = range(5)
VALUES = {
    **dict(a=0.7, b=1.3, c=0.4, x=1.1, y=0.9, t_1=0.6, v_N=1.7, omega=0.8, alpha=0.35, R_0=1.25),
    "u": np.array([[0.3], [-0.8], [1.1]]), "v": np.array([[0.9], [0.2], [-0.5]]), "w": np.array([[-0.4], [0.6], [0.7]]),
    "A": np.array([[0.9, 0.2, -0.1], [0.3, 1.2, 0.4], [-0.2, 0.1, 0.8]]),
    "M": np.array([[1.1, -0.3, 0.2], [0.0, 0.7, 0.5], [0.4, -0.2, 1.3]]),
}  # fmt: skip
SYMBOLS = {n: "real" if isinstance(v, float) else {"vector": 3} if v.shape[1] == 1 else {"matrix": [3, 3]}
           for n, v in VALUES.items()}  # fmt: skip
PRINTED = {"t_1": "t_1", "v_N": "v_N", "omega": r"\omega", "alpha": r"\alpha", "R_0": "R_{0}"}


def skew(v):
    x, y, z = v[:, 0]
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


FUNCTIONS = {
    **{name: getattr(np, name) for name in ("sin", "cos", "tanh", "exp", "sqrt", "abs")},
    "dot": lambda u, v: float(u[:, 0] @ v[:, 0]), "norm": lambda v: float(np.linalg.norm(v)), "skew": skew,
    "cross": lambda u, v: np.cross(u[:, 0], v[:, 0])[:, None], "inv": np.linalg.inv,
}  # fmt: skip


@dataclass
class Printed:
    """LaTeX with its value; ``last`` is True where nothing may follow without a dot."""

    latex: str
    level: int
    value: object
    is_number: bool = False


class Printer:
    """Draws formulas; every style is a choice of the random generator."""

    def __init__(self, random):
        self.random = random
        self.bold = random.random() < 0.5
        self.sized = random.random() < 0.5

    def group(self, part, floor):
        """The LaTeX in brackets where it binds too loosely."""
        if part.level >= floor:
            return part.latex
        left, right = self.random.choice(["()", "[]"])
        return rf"\left{left} {part.latex} \right{right}" if self.sized else f"{left}{part.latex}{right}"

    def draw(self, kind, depth):
        """A formula of a kind: scalar, vector or matrix."""
        return getattr(self, kind)(depth)

    def name(self, names, bold=False):
        name = self.random.choice(names)
        latex = PRINTED.get(name, name)
        if bold and self.bold:
            latex = rf"\mathbf{{{latex}}}" if self.random.random() < 0.7 else rf"\boldsymbol {latex}"
        return Printed(latex, WHOLE, VALUES[name])

    def plus(self, kind, depth):
        """A sum or a difference."""
        one, other = self.draw(kind, depth - 1), self.draw(kind, depth - 1)
        sign = self.random.choice("+-")
        space = self.random.choice(["", " ", r"\;"])
        value = one.value + other.value if sign == "+" else one.value - other.value
        return Printed(f"{one.latex}{space}{sign} {self.group(other, PRODUCT)}", SUM, value)

    def times(self, one, other, value, marks):
        """A product, implicit where that is plain."""
        left, right = self.group(one, OPEN if one.level != PRODUCT else PRODUCT), self.group(other, OPEN)
        plain = one.level != OPEN and not other.is_number and not right.startswith("-")
        mark = self.random.choice(marks if plain else [r" \cdot "])
        if mark == "" and (left[-1:].isalpha() or right[:1] in "([\\"):
            mark = " "
        if right[:1] in "([" or right.startswith((r"\left(", r"\left[")):
            mark = mark if "cdot" in mark else " "
        return Printed(f"{left}{mark}{right}", OPEN if other.level == OPEN else PRODUCT, value)

    def scalar(self, depth):
        if depth <= 0 or self.random.random() < 0.15:
            if self.random.random() < 0.3:
                text = self.random.choice(["2", "3", "0.5", "12"])
                return Printed(text, WHOLE, float(text), True)
            return self.name([n for n, v in VALUES.items() if isinstance(v, float)])
        rule = self.random.choice("plus minus times times fraction slash power call call root length dot".split())
        if rule == "plus":
            return self.plus("scalar", depth)
        inner = self.scalar(depth - 1)
        if rule == "minus":
            return Printed(f"-{self.group(inner, PRODUCT)}", SUM, -inner.value)
        if rule == "power":
            exponent = self.random.choice(["2", "3"])
            raised = f"^{exponent}" if self.random.random() < 0.5 else f"^{{{exponent}}}"
            return Printed(self.group(inner, WHOLE) + raised, POWER, inner.value ** int(exponent), inner.is_number)
        if rule == "call":
            return self.call(inner)
        if rule == "root":
            return Printed(rf"\sqrt{{1 + {self.group(inner, WHOLE)}^2}}", WHOLE, np.sqrt(1 + inner.value**2))
        if rule in ("length", "dot"):
            return self.length(rule, depth)
        other = self.scalar(depth - 1)
        if rule == "times":
            return self.times(inner, other, inner.value * other.value, ["", " ", r"\,", r" \cdot ", r" \times "])
        safe = Printed(rf"2 + {self.group(other, PRODUCT)}^2" if other.level == WHOLE else "2", SUM,
                       2 + other.value**2 if other.level == WHOLE else 2.0)  # fmt: skip
        if rule == "fraction":
            frac = self.random.choice([r"\frac", r"\dfrac", r"\tfrac"])
            return Printed(f"{frac}{{{inner.latex}}}{{{safe.latex}}}", WHOLE, inner.value / safe.value, inner.is_number)
        value = inner.value / safe.value
        if inner.level == OPEN:
            return Printed(rf"\frac{{{inner.latex}}}{{{safe.latex}}}", WHOLE, value)
        return Printed(f"{self.group(inner, OPEN)}/{self.group(safe, POWER)}", SUM, value)

    def call(self, inner):
        """A function, with its power behind the name or not."""
        name = self.random.choice(["sin", "cos", "tanh"])
        value = getattr(np, name)(inner.value)
        square = self.random.random() < 0.3
        head = rf"\{name}^2" if square else rf"\{name}"
        value = value**2 if square else value
        if (
            inner.level == WHOLE
            and not inner.latex.startswith((r"\left", "(", "[", "|", r"\|", r"\frac"))
            and (self.random.random() < 0.5)
        ):
            return Printed(f"{head} {inner.latex}", OPEN, value)
        if self.random.random() < 0.2 and not square:
            return Printed(rf"e^{{-{self.group(inner, WHOLE)}^2}}", POWER, np.exp(-(inner.value**2)))
        return Printed(rf"{head}\left({inner.latex}\right)" if self.sized else f"{head}({inner.latex})", POWER, value)

    def length(self, rule, depth):
        one, other = self.vector(depth - 1), self.vector(depth - 1)
        if rule == "length":
            return Printed(rf"\left\| {one.latex} \right\|", WHOLE, FUNCTIONS["norm"](one.value))
        value = FUNCTIONS["dot"](one.value, other.value)
        if self.random.random() < 0.5:
            return Printed(f"({self.group(one, WHOLE)}^T {self.group(other, WHOLE)})", WHOLE, value)
        return Printed(rf"({self.group(one, WHOLE)} \cdot {self.group(other, WHOLE)})", WHOLE, value)

    def vector(self, depth):
        if depth <= 0 or self.random.random() < 0.2:
            return self.name("uvw", bold=True)
        rule = self.random.choice("plus scaled cross moved over".split())
        if rule == "plus":
            return self.plus("vector", depth)
        one = self.vector(depth - 1)
        if rule == "cross":
            other = self.vector(depth - 1)
            value = FUNCTIONS["cross"](one.value, other.value)
            return Printed(rf"{self.group(one, WHOLE)} \times {self.group(other, WHOLE)}", SUM, value)
        if rule == "scaled":
            scalar = self.scalar(depth - 1)
            left = self.group(scalar, POWER)
            right = self.group(one, WHOLE)
            return Printed(f"{left} {right}", PRODUCT, scalar.value * one.value)
        if rule == "over":
            scalar = self.name(["x", "y", "R_0"])
            return Printed(rf"\frac{{{one.latex}}}{{{scalar.latex}}}", WHOLE, one.value / scalar.value)
        matrix = self.matrix(depth - 1)
        return Printed(f"{self.group(matrix, POWER)} {self.group(one, WHOLE)}", PRODUCT, matrix.value @ one.value)

    def matrix(self, depth):
        if depth <= 0 or self.random.random() < 0.2:
            return self.name("AM", bold=True)
        rule = self.random.choice("plus product turned skew inverse".split())
        if rule == "plus":
            return self.plus("matrix", depth)
        if rule == "skew":
            v = self.vector(depth - 1)
            latex = self.random.choice([rf"[{self.group(v, WHOLE)} \times]", rf"[{v.latex}]_\times",
                                        rf"\left\lfloor {v.latex} \right\rfloor_{{\times}}"])  # fmt: skip
            return Printed(latex, WHOLE, skew(v.value))
        one = self.matrix(depth - 1)
        if rule == "turned":
            mark = self.random.choice(["^T", r"^\top", r"^{\mathrm{T}}", "^{T}"])
            return Printed(self.group(one, WHOLE) + mark, POWER, one.value.T)
        if rule == "inverse":
            two = self.name("AM", bold=True)
            return Printed(two.latex + "^{-1}", POWER, np.linalg.inv(two.value))
        other = self.matrix(depth - 1)
        left, right = self.group(one, POWER), self.group(other, POWER)
        return Printed(f"{left} {right}", PRODUCT, one.value @ other.value)
