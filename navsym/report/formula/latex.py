r"""Formulas that people wrote in a small part of LaTeX, as MathML; and sentences with such formulas.

The part is a whitelist: letters, digits, signs, Greek, accents, fractions, roots, indices, sums and
integrals, matrices. A command outside it is refused, so that what passes here may also be handed
to LaTeX itself: nothing that reads files or defines commands is on the list.
"""

from __future__ import annotations

import html
import re
from collections.abc import Callable

from markupsafe import Markup

from navsym.core.errors import ExpressionSyntaxError
from navsym.report.formula.notation import is_tall
from navsym.report.names import GREEK, latex_escape

TOKEN = re.compile(
    r"\\begin\{(?P<open>[a-z]+)\}|\\end\{(?P<close>[a-z]+)\}|\\(?P<word>[A-Za-z]+|.)|"
    r"(?P<number>\d+(?:\.\d+)?)|(?P<char>\S)",
    re.S,
)
LETTERS = GREEK | {"varphi": "φ", "varepsilon": "ε", "ell": "ℓ", "partial": "∂", "infty": "∞"}
FUNCTIONS = frozenset("sin cos tan cot exp log ln max min det arctan diag tr".split())
SIGNS = {
    "cdot": "·",
    "times": "×",
    "le": "≤",
    "ge": "≥",
    "ne": "≠",
    "ll": "≪",
    "gg": "≫",
    "approx": "≈",
    "pm": "±",
    "to": "→",
    "in": "∈",
    "ldots": "…",
    "colon": ":",
    "|": "‖",
    "circ": "∘",
    "sum": "∑",
    "int": "∫",
    "iint": "∬",
    "{": "{",
    "}": "}",
    "%": "%",
    "top": "⊤",
    "mid": "∣",
    "forall": "∀",
    "dots": "…",
    "cdots": "⋯",
}
SPACES = {",": "0.17em", ";": "0.28em", " ": "0.25em", "quad": "1em", "qquad": "2em"}
ACCENTS = {"dot": "˙", "ddot": "¨", "hat": "^", "tilde": "~", "bar": "¯", "overline": "¯"}
BRACKETS = "()[]|./"
RELATIONS = frozenset(("=", "<", ">", "le", "ge", "ne", "ll", "gg", "approx"))
BINARY = frozenset(("+", "-", "times", "cdot"))
MATRICES = {"pmatrix": ("(", ")"), "bmatrix": ("[", "]"), "matrix": ("", "")}
STRETCHED = frozenset(("sum",))


class Reader:
    """Recursive descent over the tokens; every method returns MathML of what it has read."""

    def __init__(self, source: str):
        self.source, self.place = source, 0
        self.tokens = list(TOKEN.finditer(source))

    def refuse(self, got: str) -> ExpressionSyntaxError:
        """The error for what is not in this part of LaTeX."""
        message = f"expected one of the known LaTeX commands; got {got[:40]}; write it with those"
        return ExpressionSyntaxError(message, where=self.source[:60])

    @property
    def next(self) -> re.Match[str] | None:
        """The token that is read next, None at the end."""
        return self.tokens[self.place] if self.place < len(self.tokens) else None

    def take(self) -> re.Match[str]:
        """The next token, which is read; raises ExpressionSyntaxError at the end."""
        token = self.next
        if token is None:
            raise self.refuse("the end")
        self.place += 1
        return token

    def row(self, stop: Callable[[re.Match[str]], bool]) -> str:
        """Everything up to a token that ends it, which is left."""
        parts = []
        while (token := self.next) is not None and not stop(token):
            parts.append(self.scripted())
        return "<mrow>" + "".join(parts) + "</mrow>"

    def pieces(self) -> list[str]:
        """The whole formula, cut before the signs at which a line may end."""
        found: list[str] = [""]
        before = None
        while (token := self.next) is not None:
            new = bool(found[-1]) and may_break(before, token)
            part = self.scripted()
            if new:  # the first sign of a row would be taken for a prefix
                found.append(part.replace("<mo", '<mo form="infix"', 1))
            else:
                found[-1] += part
            before = token
        return [piece for piece in found if piece]

    def scripted(self) -> str:
        """An atom with what hangs below and above it."""
        first = self.next["word"] if self.next is not None else None
        large, gap = first in STRETCHED, '<mspace width="0.1em"></mspace>' if first in FUNCTIONS else ""
        hanging = self.next is not None and self.next["char"] in ("_", "^")  # m/s$^2$: nothing to hang on
        base, below, above = "<mrow></mrow>" if hanging else self.atom(), "", ""
        while (token := self.next) is not None and token["char"] in ("_", "^"):
            self.take()
            if token["char"] == "_":
                below = self.atom()
            else:
                above = self.atom()
        kind = ("munder", "mover", "munderover") if large else ("msub", "msup", "msubsup")
        if below and above:
            return f"{gap}<{kind[2]}>{base}{below}{above}</{kind[2]}>{gap}"
        if below or above:
            name = kind[0] if below else kind[1]
            return f"{gap}<{name}>{base}{below or above}</{name}>{gap}"
        return gap + base + gap

    def atom(self) -> str:
        """A letter, number, sign, command, group or matrix; raises ExpressionSyntaxError for anything else."""
        token = self.take()
        if token["open"] is not None:
            return self.matrix(token["open"])
        if token["word"] is not None:
            return self.command(token["word"])
        if token["number"] is not None:
            return f"<mn>{token['number']}</mn>"
        char = token["char"]
        if char == "{":
            return self.group()
        if char is None or char in "}_^&$#~\\":
            raise self.refuse(token.group())
        if char.isalpha():
            return f"<mi>{char}</mi>"
        sign = {"*": "∗", "-": "−", "'": "′"}.get(char, char)
        still = ' stretchy="false" lspace="0" rspace="0"' if char in BRACKETS else ""
        return f"<mo{still}>{html.escape(sign)}</mo>"

    def group(self) -> str:
        """What stands up to the closing brace, the opening one being read."""
        inner = self.row(lambda token: token["char"] == "}")
        self.take()
        return inner

    def command(self, word: str) -> str:
        """A command with its arguments; raises ExpressionSyntaxError for one that is not known."""
        if word in LETTERS:
            return f"<mi>{LETTERS[word]}</mi>"
        if word in FUNCTIONS:
            return f'<mi mathvariant="normal">{word}</mi>'
        if word == "displaystyle":
            return "<mrow></mrow>"
        if word in SPACES:
            return f'<mspace width="{SPACES[word]}"></mspace>'
        if word in SIGNS:
            return f"<mo>{SIGNS[word]}</mo>"
        if word == "frac":
            return f"<mfrac>{self.atom()}{self.atom()}</mfrac>"
        if word == "sqrt":
            return f"<msqrt>{self.atom()}</msqrt>"
        if word in ACCENTS:
            return f'<mover accent="true">{self.atom()}<mo stretchy="false">{ACCENTS[word]}</mo></mover>'
        if word in ("mathrm", "text", "operatorname"):
            return self.upright()
        if word == "left":
            return self.fenced()
        raise self.refuse(f"\\{word}")

    def upright(self) -> str:
        """Words between braces as text; raises ExpressionSyntaxError for no brace, or a command inside."""
        opening = self.take()
        if opening["char"] != "{":
            raise self.refuse("no brace")
        while (token := self.take())["char"] != "}":
            if token["word"] is not None:
                raise self.refuse(token.group())
        words = self.source[opening.end() : token.start()]
        return f"<mtext>{html.escape(words)}</mtext>"

    def fenced(self) -> str:
        r"""What stands between ``\left`` and ``\right``, with brackets as tall as it."""
        left = self.bracket()
        inner = self.row(lambda token: token["word"] == "right")
        self.take()
        still = "" if is_tall(inner) else ' stretchy="false"'
        first, last = (f"<mo{still}>{sign}</mo>" if sign else "" for sign in (left, self.bracket()))
        return f"<mrow>{first}{inner}{last}</mrow>"

    def bracket(self) -> str:
        r"""The sign after ``\left`` or ``\right``; nothing for a dot."""
        token = self.take()
        sign = token["char"] or {"{": "{", "}": "}", "|": "‖"}.get(token["word"] or "", "")
        if not sign:
            raise self.refuse(token.group())
        return "" if sign == "." else html.escape(sign)

    def matrix(self, kind: str) -> str:
        """Rows and cells of a matrix up to its end; raises ExpressionSyntaxError for another environment."""
        if kind not in MATRICES:
            raise self.refuse(rf"\begin{{{kind}}}")
        left, right = (f"<mo>{sign}</mo>" if sign else "" for sign in MATRICES[kind])
        rows, cells = [], []
        while True:
            cells.append(self.row(lambda t: t["close"] is not None or t["char"] == "&" or t["word"] == "\\"))
            token = self.take()
            if token["char"] == "&":
                continue
            rows.append("<mtr>" + "".join(f"<mtd>{cell}</mtd>" for cell in cells) + "</mtr>")
            cells = []
            if token["close"] is not None:
                return f"<mrow>{left}<mtable>{''.join(rows)}</mtable>{right}</mrow>"


def may_break(before: re.Match[str] | None, token: re.Match[str]) -> bool:
    """A line may end before a relation, and before a sign between two terms."""
    sign = token["word"] or token["char"]
    if sign in RELATIONS:
        return True
    opening = before is None or before["char"] in tuple("([{,;=") or before["word"] in RELATIONS
    return sign in BINARY and not opening


def mathml(source: str, display: bool = False) -> Markup:
    """A formula as MathML, one element for each piece of a line; raises ExpressionSyntaxError as said above."""
    pieces = Reader(source).pieces()
    style = ' displaystyle="true"' if display else ""
    return Markup("<wbr>".join(f"<math{style}><mrow>{piece}</mrow></math>" for piece in pieces))


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


def sentence_plain(text: str) -> str:
    """The same sentence for a terminal: formulas as their source."""
    return "".join(part for part, _ in split_sentence(text))
