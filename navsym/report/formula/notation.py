"""How MathML and LaTeX write the pieces of a formula."""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import dataclass

from navsym.report.page_names import latex_name, mathml_name


@dataclass(frozen=True, slots=True)
class Style:
    """How one notation writes the pieces."""

    number: Callable[[str], str]
    name: Callable[[str], str]
    function: Callable[[str], str]
    sign: Callable[[str], str]
    row: Callable[[list[str]], str]
    fraction: Callable[[str, str], str]
    power: Callable[[str, str], str]
    root: Callable[[str], str]
    fenced: Callable[[str, str, str], str]
    matrix: Callable[[list[list[str]]], str]


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


BESIDE_A_FUNCTION = "thin *"     # a product in which the name of a function would touch its neighbour
MATHML_SIGNS = {
    "-": "−", "*": "⁢", "<=": "≤", ">=": "≥", "!=": "≠", "+-": "±",
}  # fmt: skip
LATEX_SIGNS = {
    "*": r"\,", BESIDE_A_FUNCTION: r"\,",
    "<=": r" \le ", ">=": r" \ge ", "!=": r" \ne ", "+-": r" \pm ", "·": r" \cdot ", ";": r";\quad ",
}  # fmt: skip

POWER_OF_TEN = "<mrow><mn>{}</mn><mo>·</mo><msup><mn>10</mn><mn>{}</mn></msup></mrow>"
MATHML = Style(
    number=lambda text: scientific(text, "<mn>{}</mn>", POWER_OF_TEN),
    name=mathml_name,
    function=lambda text: mathml_name(text, function=True),
    sign=mathml_sign,
    row=rowed,
    fraction=lambda top, bottom: f"<mfrac>{top}{bottom}</mfrac>",
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
    fraction=lambda top, bottom: rf"\frac{{{top}}}{{{bottom}}}",
    power=lambda base, exponent: f"{base}^{{{exponent}}}",
    root=lambda inner: rf"\sqrt{{{inner}}}",
    fenced=lambda left, inner, right: rf"\left{left} {inner} \right{right}",
    matrix=lambda rows: (
        r"\begin{bmatrix} " + r" \\ ".join(" & ".join(row) for row in rows) + r" \end{bmatrix}"
    ),
)
