"""How MathML and LaTeX write the pieces of a formula."""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from navsym.report.names import latex_name, mathml_name


@dataclass(frozen=True, slots=True)
class Style:
    """How one notation writes the pieces.

    quotient : a fraction; full : the same in the size of the line, wherever it stands
    place    : on the line; inside a fraction, a call or a matrix; or raised as an exponent
    """

    number: Callable[[str], str]
    name: Callable[[str], str]
    function: Callable[[str], str]
    sign: Callable[[str], str]
    row: Callable[[list[str]], str]
    quotient: Callable[[str, str], str]
    full: Callable[[str, str], str]
    power: Callable[[str, str], str]
    root: Callable[[str], str]
    fenced: Callable[[str, str, str], str]
    matrix: Callable[[list[list[str]]], str]
    place: Literal["line", "inside", "raised"] = "line"

    def inside(self) -> Style:
        """The style of what stands inside a fraction, a call or a matrix; in an exponent nothing grows again."""
        return replace(self, place="inside") if self.place == "line" else self

    def above(self) -> Style:
        """The style of an exponent."""
        return replace(self, place="raised")

    def fraction(self, top: str, bottom: str) -> str:
        """A fraction; inside something it keeps the size of the line, so that it can still be read."""
        return (self.full if self.place == "inside" else self.quotient)(top, bottom)


def scientific(text: str, plain: str, powered: str) -> str:
    """A numeral as it is printed; ``6.37e+07`` with a power of ten."""
    mantissa, mark, exponent = text.partition("e")
    return powered.format(mantissa, int(exponent)) if mark else plain.format(text)


def operator(text: str) -> str:
    """A sign of MathML."""
    return f"<mo>{html.escape(text)}</mo>"


def mathml_sign(text: str) -> str:
    """A sign of a formula as MathML: an invisible product beside a function, else the sign for it."""
    if text == BESIDE_A_FUNCTION:
        return '<mo lspace="0.17em">⁢</mo>'
    if text == "/":
        return '<mo lspace="0.05em" rspace="0.05em">/</mo>'
    return operator(MATHML_SIGNS.get(text, text))


def is_tall(inner: str) -> bool:
    """True for MathML that is higher than a line, so that brackets around it have to grow."""
    return any(tag in inner for tag in ("<mfrac", "<mtable", "<munder"))


def mathml_fenced(left: str, inner: str, right: str) -> str:
    """Brackets that grow with what is tall; around one line a growing bracket would stand in a gap."""
    still = "" if is_tall(inner) else ' stretchy="false"'
    first, last = (f"<mo{still}>{html.escape(sign)}</mo>" for sign in (left, right))
    return rowed([first, inner, last])


def rowed(parts: list[str]) -> str:
    """Parts in a row; a single one as it is."""
    return parts[0] if len(parts) == 1 else "<mrow>" + "".join(parts) + "</mrow>"


def mathml_matrix(rows: list[list[str]]) -> str:
    """A matrix in square brackets."""
    body = "".join("<mtr>" + "".join(f"<mtd>{cell}</mtd>" for cell in row) + "</mtr>" for row in rows)
    return rowed([operator("["), f"<mtable>{body}</mtable>", operator("]")])


def latex_matrix(rows: list[list[str]]) -> str:
    """A matrix in square brackets, its rows apart where they hold tall fractions."""
    lines = [" & ".join(row) for row in rows]
    apart = r" \\[1ex] " if any(r"\dfrac" in line for line in lines) else r" \\ "
    return r"\begin{bmatrix} " + apart.join(lines) + r" \end{bmatrix}"


BESIDE_A_FUNCTION = "thin *"  # a product in which the name of a function would touch its neighbour
MATHML_SIGNS = {"-": "−", "*": "⁢", "<=": "≤", ">=": "≥", "!=": "≠", "+-": "±"}
LATEX_SIGNS = {
    "*": r"\,",
    BESIDE_A_FUNCTION: r"\,",
    "<=": r" \le ",
    ">=": r" \ge ",
    "!=": r" \ne ",
    "+-": r" \pm ",
    "/": "/",
    "·": r" \cdot ",
    ";": r";\quad ",
}

POWER_OF_TEN = "<mrow><mn>{}</mn><mo>·</mo><msup><mn>10</mn><mn>{}</mn></msup></mrow>"
MATHML = Style(
    number=lambda text: scientific(text, "<mn>{}</mn>", POWER_OF_TEN),
    name=mathml_name,
    function=lambda text: mathml_name(text, function=True),
    sign=mathml_sign,
    row=rowed,
    quotient=lambda top, bottom: f"<mfrac>{top}{bottom}</mfrac>",
    full=lambda top, bottom: f'<mstyle displaystyle="true" scriptlevel="0"><mfrac>{top}{bottom}</mfrac></mstyle>',
    power=lambda base, exponent: f"<msup>{base}{exponent}</msup>",
    root=lambda inner: f"<msqrt>{inner}</msqrt>",
    fenced=mathml_fenced,
    matrix=mathml_matrix,
)
LATEX = Style(
    number=lambda text: scientific(text, "{}", r"{} \cdot 10^{{{}}}"),
    name=latex_name,
    function=lambda text: latex_name(text, function=True),
    sign=lambda text: LATEX_SIGNS.get(text, f" {text} " if text != "," else ", "),
    row=lambda parts: "".join(parts),
    quotient=lambda top, bottom: rf"\frac{{{top}}}{{{bottom}}}",
    full=lambda top, bottom: rf"\dfrac{{{top}}}{{{bottom}}}",
    power=lambda base, exponent: f"{base}^{{{exponent}}}",
    root=lambda inner: rf"\sqrt{{{inner}}}",
    fenced=lambda left, inner, right: rf"\left{left} {inner} \right{right}",
    matrix=latex_matrix,
)
