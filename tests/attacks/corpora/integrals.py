"""Antiderivatives of the independent test suites of a rule-based integrator, as statements ``derivative = integrand``.

Read from a checkout of github.com/RuleBasedIntegration/MathematicaSyntaxTestSuite, folder
``0 Independent test suites``; figures in docs/corpora.md are of commit 32b79cedb8a5a80e82e6db9f67e9cdf88cf11217.
A line is ``{integrand, variable, steps, antiderivative}``, perhaps with a second antiderivative, which is left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

from tests.attacks.statements import Statement
from tests.attacks.trees import ONE, Tree, UnreadableError, derivative, names_in, number, read, replace, write

REPOSITORY = "MathematicaSyntaxTestSuite"
FOLDER = "0 Independent test suites"
LONGEST = 4_000  # characters of a statement

TOKEN = re.compile(r"\s*(?:(\d+\.?\d*|\.\d+)|([A-Za-z]\w*)|([-+*/^(),{}\[\]]))")
SAME = ("Sin", "Cos", "Tan", "Cot", "Sec", "Csc", "Exp", "Log", "Sqrt", "Abs", "Sinh", "Cosh", "Tanh")
#: Functions of the suites in the language of files, by the real functions that they are on the line.
MEANINGS = {name: f"{name.lower()}(x)" for name in SAME} | {
    "ArcSin": "asin(x)", "ArcCos": "acos(x)", "ArcTan": "atan(x)", "ArcCot": "atan(1/x)", "ArcSec": "acos(1/x)",
    "ArcCsc": "asin(1/x)", "ArcSinh": "log(x + sqrt(x**2 + 1))", "ArcCosh": "log(x + sqrt(x - 1)*sqrt(x + 1))",
    "ArcTanh": "log((1 + x)/(1 - x))/2", "ArcCoth": "log((x + 1)/(x - 1))/2", "Sech": "1/cosh(x)", "Csch": "1/sinh(x)",
    "Coth": "cosh(x)/sinh(x)", "ArcSech": "log(1/x + sqrt(1/x - 1)*sqrt(1/x + 1))",
    "ArcCsch": "log(1/x + sqrt(1/x**2 + 1))",
}  # fmt: skip
#: Derivatives that need no logarithm, as a table of integrals prints them.
SLOPES = {
    "ArcSinh": "1/sqrt(x**2 + 1)", "ArcCosh": "1/(sqrt(x - 1)*sqrt(x + 1))", "ArcTanh": "1/(1 - x**2)",
    "ArcCoth": "1/(1 - x**2)", "ArcCot": "-1/(1 + x**2)",
}  # fmt: skip


class Reader:
    """Recursive descent over the tokens of one line of a suite."""

    def __init__(self, text: str):
        self.tokens: list[str] = []
        place, text = 0, text.rstrip()
        while place < len(text):
            match = TOKEN.match(text, place)
            if match is None:
                raise UnreadableError(text[place : place + 20])
            self.tokens.append(match[match.lastindex])
            place = match.end()
        self.tokens.append("")
        self.place = 0

    def take(self, *marks: str) -> str:
        mark = self.tokens[self.place]
        if mark == "" or mark not in marks:
            return ""
        self.place += 1
        return mark

    def expect(self, mark: str) -> None:
        if not self.take(mark):
            raise UnreadableError(f"{self.tokens[self.place]!r}, expected {mark}")

    def entries(self) -> list[Tree]:
        """The formulas between braces."""
        self.expect("{")
        found = [self.sum()]
        while self.take(","):
            found.append(self.sum())
        self.expect("}")
        return found

    def sum(self) -> Tree:
        tree = self.product()
        while mark := self.take("+", "-"):
            tree = (mark, tree, self.product())
        return tree

    def product(self) -> Tree:
        tree = self.unary()
        while mark := self.take("*", "/"):
            tree = (mark, tree, self.unary())
        return tree

    def unary(self) -> Tree:
        if mark := self.take("+", "-"):
            tree = self.product()
            return tree if mark == "+" else ("neg", tree)
        base = self.atom()
        if not self.take("^"):
            return base
        exponent = self.unary()
        return ("exp", exponent) if base == ("name", "E") else ("**", base, exponent)

    def atom(self) -> Tree:
        word = self.tokens[self.place]
        self.place += 1
        if word[:1].isdigit() or word[:1] == ".":
            return number(Fraction(word))
        if word == "(":
            tree = self.sum()
            self.expect(")")
            return tree
        if not word[:1].isalpha() or word == "I":
            raise UnreadableError(word)
        if not self.take("["):
            return ("pi",) if word == "Pi" else ("name", word)
        operands = [self.sum()]
        while self.take(","):
            operands.append(self.sum())
        self.expect("]")
        if word == "ArcTan" and len(operands) == 2:
            return ("atan2", operands[1], operands[0])
        if word not in MEANINGS or len(operands) != 1:
            raise UnreadableError(word)
        return (word, operands[0])


def plain(tree: Tree) -> Tree:
    """The formula with functions of the language of files."""
    head, *parts = tree
    parts = [plain(part) if isinstance(part, tuple) else part for part in parts]
    if tree == ("name", "E"):
        return ("exp", ONE)
    return replace(read(MEANINGS[head]), {"x": parts[0]}) if head in MEANINGS else (head, *parts)


def slope(tree: Tree, name: str) -> Tree:
    """The derivative, term by term: inverse hyperbolic functions by their own rules."""
    head, *parts = tree
    if head in ("+", "-"):
        return (head, slope(parts[0], name), slope(parts[1], name))
    if head == "neg":
        return ("neg", slope(parts[0], name))
    if head == "*" and name not in names_of(parts[0]):
        return ("*", plain(parts[0]), slope(parts[1], name))
    if head == "/" and name not in names_of(parts[1]):
        return ("/", slope(parts[0], name), plain(parts[1]))
    if head in SLOPES:
        inside = plain(parts[0])
        return ("*", replace(read(SLOPES[head]), {"x": inside}), derivative(inside, name))
    return derivative(plain(tree), name)


def names_of(tree: Tree) -> set[str]:
    return names_in(plain(tree))


def read_line(line: str) -> Statement:
    """The statement of one line; raises UnreadableError where it is outside the language."""
    reader = Reader(line)
    integrand, variable, _, antiderivative, *_ = reader.entries()
    if variable[0] != "name":
        raise UnreadableError(f"{variable}")
    text = f"{write(slope(antiderivative, variable[1]))} = {write(plain(integrand))}"
    if len(text) > LONGEST:
        raise UnreadableError("too long")
    written = set(re.findall(r"[A-Za-z_]\w*", text))
    names = (names_of(integrand) | names_of(antiderivative)) & written  # some cancel while the slope is taken
    return Statement(text, None, dict.fromkeys(sorted(names), "real"))


def read_entries(checkout: Path) -> Iterator[tuple[str, Statement | None]]:
    """(file and line, statement) of every entry of the suites; None for one outside the language."""
    for path in sorted((checkout / FOLDER).glob("*.m")):
        for k, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if line.startswith("{"):
                place = f"{path.name}:{k}"
                try:
                    yield place, read_line(line)
                except (UnreadableError, ValueError):
                    yield place, None
