r"""Formulas that people wrote in a small part of LaTeX, as MathML; and sentences with such formulas.

The part is a whitelist: letters, digits, signs, Greek, accents, fractions, roots, indices, sums and integrals,
matrices. A command outside it is refused, so that what passes here may also be handed to LaTeX itself: nothing that
reads files or defines commands is on the list. latex2mathml converts what has passed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.etree import ElementTree

from latex2mathml.converter import convert
from markupsafe import Markup

from navsym.core.errors import ExpressionSyntaxError
from navsym.report.formula.notation import is_tall
from navsym.report.names import GREEK, latex_escape

TOKEN = re.compile(
    r"\\begin\{(?P<open>[a-z]+)\}|\\end\{(?P<close>[a-z]+)\}|\\(?P<word>[A-Za-z]+|.)|"
    r"(?P<number>\d+(?:\.\d+)?)|(?P<char>\S)",
    re.S,
)
FUNCTIONS = frozenset("sin cos tan cot exp log ln max min det arctan diag tr".split())
ACCENTS = {"dot": "˙", "ddot": "¨", "hat": "^", "tilde": "~", "bar": "¯", "overline": "¯"}
BOLD = frozenset(("mathbf", "boldsymbol", "vec"))
UPRIGHT = frozenset(("mathrm", "text", "operatorname"))
SIGNS = frozenset(
    "cdot times le ge ne ll gg approx pm to in ldots colon | circ sum int iint { } % top mid forall dots cdots".split()
)
LETTERS = frozenset({*GREEK, "varphi", "varepsilon", "ell", "partial", "infty"})
SPACES = frozenset((",", ";", " ", "quad", "qquad"))
KNOWN = FUNCTIONS | BOLD | UPRIGHT | SIGNS | LETTERS | SPACES | ACCENTS.keys()
KNOWN |= {"frac", "sqrt", "left", "right", "displaystyle", "\\"}
MATRICES = frozenset(("pmatrix", "bmatrix", "matrix"))
RELATIONS = frozenset(("=", "<", ">", "le", "ge", "ne", "ll", "gg", "approx"))
BINARY = frozenset(("+", "-", "times", "cdot"))
PARTS = {"msub": 2, "msup": 2, "mfrac": 2, "munder": 2, "mover": 2, "msubsup": 3, "munderover": 3}
GAP = "0.1em"  # beside the name of a function


def refuse(got: str, source: str) -> ExpressionSyntaxError:
    """The error for what is not in this part of LaTeX."""
    message = f"expected one of the known LaTeX commands; got {got[:40]}; write it with those"
    return ExpressionSyntaxError(message, where=source[:60])


def read_tokens(source: str) -> list[tuple[re.Match[str], int]]:
    """Tokens with the depth at which they stand; raises ExpressionSyntaxError for what is not on the whitelist."""
    found: list[tuple[re.Match[str], int]] = []
    closing: list[str] = []
    for token in TOKEN.finditer(source):
        word, char = token["word"], token["char"]
        if word is not None and (word not in KNOWN or (closing and closing[-1] == "words")):
            raise refuse(token.group(), source)
        if token["open"] is not None and token["open"] not in MATRICES:
            raise refuse(token.group(), source)
        ends = token["close"] or ("right" if word == "right" else char if char == "}" else None)
        if ends is not None:
            wanted = closing.pop() if closing else ""
            if ends != ("}" if wanted == "words" else wanted):
                raise refuse(token.group(), source)
        is_lost = char == "&" and (not closing or closing[-1] not in MATRICES)
        if is_lost or char in ("$", "#", "~", "\\") or not (char or "x").isprintable():
            raise refuse(token.group(), source)
        found.append((token, len(closing)))
        if char == "{":
            before = found[-2][0]["word"] if len(found) > 1 else None
            closing.append("words" if before in UPRIGHT else "}")
        elif token["open"] is not None or word == "left":
            closing.append(token["open"] or "right")
    if closing:
        raise refuse("the end", source)
    return found


def split_pieces(source: str) -> Iterator[str]:
    """The formula, cut before the signs at which a line may end: relations, and signs between two terms."""
    start, before = 0, None
    for token, depth in read_tokens(source):
        sign = token["word"] or token["char"]
        opening = before is None or before["char"] in tuple("([{,;=^_") or before["word"] in RELATIONS
        if depth == 0 and token.start() > start and (sign in RELATIONS or (sign in BINARY and not opening)):
            yield source[start : token.start()]
            start = token.start()
        before = token
    yield source[start:]


def mathml(source: str, display: bool = False) -> Markup:
    """A formula as MathML, one element for each piece of a line; raises ExpressionSyntaxError as said above."""
    style = ' displaystyle="true"' if display else ""
    made = []
    for place, piece in enumerate(split_pieces(source)):
        row = convert_piece(piece, source)
        if place and row.text is None and len(row) and row[0].tag == "mo":
            row[0].set("form", "infix")  # the first sign of a row would be taken for a prefix
        made.append(f"<math{style}>{ElementTree.tostring(row, encoding='unicode', short_empty_elements=False)}</math>")
    return Markup("<wbr>".join(made))


def convert_piece(piece: str, source: str) -> ElementTree.Element:
    """The row of a piece of a formula, with accents, sums, brackets and functions as they are set in print."""
    plain = re.sub(r"\\(diag|tr)\b", r"\\text{\1}", piece)
    plain = re.sub(r"\\(?:mathrm|operatorname)\s*\{", r"\\text{", plain)
    plain = re.sub(r"^\s*([_^])", r"{}\1", plain)  # m/s$^2$: nothing to hang on
    try:
        made = convert(plain).replace(' xmlns="http://www.w3.org/1998/Math/MathML"', "")
        row = ElementTree.fromstring(made)[0]
    except (Exception, RecursionError) as error:  # the converter has errors of many kinds
        raise refuse(f"{type(error).__name__} in {piece}", source) from None
    nodes = list(row.iter())
    if "\\" in "".join(row.itertext()) or any(len(node) != PARTS.get(node.tag, len(node)) for node in nodes):
        raise refuse(piece, source)
    for node in nodes:
        refine(node)
    return row


def refine(node: ElementTree.Element) -> None:
    """One element as print has it: limits below a sum, accents, brackets that grow, gaps beside functions."""
    base = "".join(node[0].itertext()) if len(node) else ""
    if node.tag in ("msub", "msup", "msubsup") and base == "∑":
        node.tag = {"msub": "munder", "msup": "mover", "msubsup": "munderover"}[node.tag]
    elif node.tag == "mover" and (node[1].text or "") in ACCENTS.values():
        node.set("accent", "true")
        node[1].set("stretchy", "false")
    fences = [child for child in node if child.tag == "mo" and child.get("fence") == "true"]
    tall = is_tall(ElementTree.tostring(node, encoding="unicode"))
    for child in fences:
        for name in ("fence", "form", "stretchy"):
            child.attrib.pop(name, None)
        if not tall:
            child.set("stretchy", "false")
    if node.tag in ("mrow", "mtd", "mstyle"):
        for place in range(len(node) - 1, -1, -1):
            if node[place].tag in ("mi", "msup", "msub") and next(node[place].itertext(), "") in FUNCTIONS:
                for at in (place + 1, place):
                    node.insert(at, ElementTree.Element("mspace", width=GAP))


def split_sentence(text: str) -> list[tuple[str, bool]]:
    """Parts of a sentence with formulas between dollar signs: (part, is it a formula)."""
    parts = text.split("$")
    if len(parts) % 2 == 0:
        raise ExpressionSyntaxError("expected dollar signs in pairs; got an odd one; close it", where=text[:60])
    return [(part, place % 2 == 1) for place, part in enumerate(parts) if part]


def sentence_html(text: str) -> Markup:
    """A sentence for a page: words escaped, formulas as MathML; a formula that stands alone is displayed."""
    parts = split_sentence(text)
    alone = len(parts) == 1
    return Markup("").join(mathml(part, display=alone) if is_formula else part for part, is_formula in parts)


def sentence_latex(text: str) -> str:
    """The same sentence for LaTeX: words escaped, formulas as they are, after the whitelist has passed them."""
    parts = split_sentence(text)
    for part, is_formula in parts:
        if is_formula:
            mathml(part)
    if len(parts) == 1 and parts[0][1]:
        return rf"\[ {latex_math(parts[0][0])} \]"
    return "".join(f"${latex_math(part)}$" if formula else latex_escape(part) for part, formula in parts)


def latex_math(source: str) -> str:
    """Words that plain LaTeX knows under another name."""
    return re.sub(r"\\(diag|tr|arctan)\b", r"\\operatorname{\1}", source)


def convert_own(source: str) -> Markup | None:
    """LaTeX of the project's own writing, such as that of the book, as MathML; None where the converter gives up."""
    try:
        return Markup(convert(source, display="block"))
    except Exception:  # it raises whatever comes of a command that it does not know; the LaTeX is shown instead
        return None
