"""Trees written down: as text of the language, as Python source and in LaTeX, by one rule for brackets.

A writer turns every part into text together with how tightly the text binds; what binds less tightly than its place
asks stands in brackets. The text of the language is read back as the same tree.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import sympy as sp

from navsym.core.errors import TooLargeError
from navsym.language.algebra import from_sympy
from navsym.language.arithmetic import BITS
from navsym.language.tree import MINUS_ONE, NUMBER, ONE, POWER, PRODUCT, SUM, SYMBOL, Tree, build, fold_tree

ENCLOSURES = {"sqrt": r"\sqrt{{{}}}", "abs": r"\left|{}\right|", "exp": r"e^{{{}}}"}
TO_LATEX = {name: rf"\{name}" for name in "sin cos tan cot sec csc sinh cosh tanh".split()} | {"log": r"\ln"}
GREEK = frozenset(
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi rho sigma tau phi chi psi omega".split()
)

#: How tightly a text binds.
LOOSE, TIGHT, RAISED, WHOLE = range(4)


class Text(NamedTuple):
    """What stands for a part, how tightly it binds, and for ``1/u`` also what stands for u."""

    text: str
    level: int
    divisor: Text | None = None


def to_text(expression: sp.Expr, calculus: bool = False) -> str:
    """Text of the language of files that means the expression: ``sin(T/2)**2``, ``3/4``, ``sqrt(x)``.

    With ``calculus`` it may hold sums, integrals, limits and derivatives: ``integral(exp(-t), t, 0, oo)``.

    ``parse(to_text(e), symbols) == e`` for every expression that the language can build.
    Raises ExpressionSyntaxError on anything outside the language (I, infinities, Piecewise, names that are not ASCII),
    DomainError on floating-point numbers, DuplicateError on two symbols of one name and TooLargeError on size.
    """
    return print_tree(from_sympy(expression, calculus))


def to_python(expression: sp.Expr) -> str:
    """Python source that builds the expression exactly, with sympy at hand as ``sp``: ``sp.sin(T/2)**2``.

    No quotient of two plain integers is written, of which Python would make a float. Raises as :func:`to_text`.
    """
    return PythonWriter().whole(order_for_python(from_sympy(expression)))


def python_terms(expression: sp.Add) -> list[str]:
    """The terms of a sum as :func:`to_python` writes them, each with the sign before it."""
    tree, writer = order_for_python(from_sympy(expression)), PythonWriter()
    return writer.signed_terms(tree, [fold_tree(term, writer.spell) for term in tree.args])


def print_tree(tree: Tree) -> str:
    """Text of the language that is read as this tree and no other.

    >>> from navsym.language.expression import read_tree
    >>> print_tree(read_tree("x - (3*y)/2 + 1/(4)", {"x", "y"}))
    'x - (3*y)/2 + 1/(4)'
    """
    return Writer().whole(tree)


def is_whole(tree: Tree, low: int = 0) -> bool:
    """True for an integer that its digits alone write."""
    return tree.head == NUMBER and tree.args[0] >= low and tree.args[0].denominator == 1


class Writer:
    """Writes trees as text of the language; other notations change some of the steps."""

    def whole(self, tree: Tree) -> str:
        """Text of a whole tree."""
        return fold_tree(tree, self.spell).text

    def spell(self, part: Tree, inner: list[Text]) -> Text:
        """A part from the texts of its own parts."""
        if part.head == NUMBER:
            if max(part.args[0].numerator.bit_length(), part.args[0].denominator.bit_length()) > BITS:
                raise TooLargeError(f"expected numbers of at most {BITS} bits; got a larger one; rescale")
            return self.number(part.args[0])
        if part.head == SYMBOL:
            return Text(self.symbol(part.args[0]), WHOLE)
        if part.head == SUM:
            return Text(" ".join(self.signed_terms(part, inner)), LOOSE)
        if part.head == PRODUCT:
            return self.product(part, inner)
        if part.head == POWER:
            return self.power(part, *inner)
        return self.call(part, [text.text for text in inner])

    def number(self, value: Fraction) -> Text:
        """A number; a fraction binds like a quotient, a negative number like a sum."""
        return Text(str(value), LOOSE if value < 0 else WHOLE if value.denominator == 1 else TIGHT)

    def symbol(self, name: str) -> str:
        """A name."""
        return name

    def call(self, part: Tree, arguments: Sequence[str]) -> Text:
        """A function at its arguments; pi has none."""
        return Text(f"{part.head}({', '.join(arguments)})" if arguments else part.head, WHOLE)

    def enclose(self, part: Text, floor: int) -> str:
        """A part in brackets when it binds less tightly than ``floor`` asks."""
        return part.text if part.level >= floor else f"({part.text})"

    def signed_terms(self, part: Tree, inner: Sequence[Text]) -> list[str]:
        """Terms with their signs before them: ``["x", "- 2*y"]``."""
        spelt = zip(part.args, inner, strict=True)
        texts = [self.enclose(text, TIGHT) if term.head == SUM else text.text for term, text in spelt]
        return texts[:1] + [f"- {text[1:]}" if text.startswith("-") else f"+ {text}" for text in texts[1:]]

    def product(self, part: Tree, inner: Sequence[Text]) -> Text:
        """Factors, with inverses behind ``/``.

        Reading makes one number of 3/4 and -3, and drops the 1 of 1/x: brackets keep apart what is apart in the tree.
        """
        first, second = part.args[:2]
        text, bare = inner[0].text, is_whole(first) or is_whole(first, -(10**9))
        if first is MINUS_ONE and inner[1].divisor is None:
            text, bare = "-", False
        elif first.head != NUMBER and inner[0].divisor is None:
            text = self.enclose(inner[0], RAISED)
        elif first is ONE and inner[1].divisor is not None:
            text, bare = "(1)", False
        for factor, spelt in zip(part.args[1:], inner[1:], strict=True):
            if spelt.divisor is not None:
                text += "/" + self.divide(factor.args[0], spelt.divisor, bare)
            else:
                literal = text == "-" and is_whole(factor)
                text += "*" * (text != "-") + (f"({spelt.text})" if literal else self.enclose(spelt, RAISED))
            bare = False
        return Text(text, LOOSE if text.startswith("-") else TIGHT)

    def divide(self, divisor: Tree, spelt: Text, bare: bool) -> str:
        """What stands behind ``/``; bare where reading would make one number of it and what stands before."""
        return f"({spelt.text})" if bare and is_whole(divisor, 1) else self.enclose(spelt, RAISED)

    def power(self, part: Tree, base: Text, exponent: Text) -> Text:
        """A power; with exponent -1 a quotient."""
        if part.args[1] is MINUS_ONE:
            return Text(f"1/{self.divide(part.args[0], base, True)}", TIGHT, base)
        return Text(f"{self.enclose(base, WHOLE)}**{self.enclose(exponent, WHOLE)}", RAISED)


class PythonWriter(Writer):
    """Python source that builds an expression of sympy."""

    def number(self, value: Fraction) -> Text:
        """A fraction as one of sympy: Python would make a float of a quotient."""
        if value.denominator == 1:
            return super().number(value)
        text = f"sp.Rational({abs(value.numerator)}, {value.denominator})"
        return Text(f"-{text}", LOOSE) if value < 0 else Text(text, WHOLE)

    def call(self, part: Tree, arguments: Sequence[str]) -> Text:
        """A function of sympy."""
        if part.head == "exp" and arguments == ["1"]:
            return Text("sp.E", WHOLE)
        called = super().call(part, arguments).text
        return Text(f"sp.{'Abs' + called[3:] if part.head == 'abs' else called}", WHOLE)


def order_for_python(tree: Tree) -> Tree:
    """The tree with terms and factors in an order in which Python, from left to right, multiplies nothing out.

    Terms with a minus come last, sums behind other factors, divisors behind all of them and numbers among these last.
    """

    def late(factor: Tree) -> tuple[bool, bool]:
        if factor.head == POWER and factor.args[1] is MINUS_ONE:
            return True, factor.args[0].head == NUMBER
        return False, factor.head == SUM

    def has_minus(term: Tree) -> bool:
        first = term.args[0] if term.head == PRODUCT else term
        return first.head == NUMBER and first.args[0] < 0

    def step(part: Tree, inner: list[Tree]) -> Tree:
        if not inner:
            return part
        keys: dict[str, Callable[[Tree], Any]] = {SUM: has_minus, PRODUCT: late}
        return build(part.head, tuple(sorted(inner, key=keys[part.head]) if part.head in keys else inner))

    return fold_tree(tree, step)


class LatexWriter(Writer):
    """LaTeX: fractions one above the other, roots and absolute values by their signs."""

    def number(self, value: Fraction) -> Text:
        """A number; a fraction is a whole."""
        if value.denominator == 1:
            return super().number(value)
        sign = "-" if value < 0 else ""
        return Text(rf"{sign}\frac{{{abs(value.numerator)}}}{{{value.denominator}}}", LOOSE if sign else TIGHT)

    def symbol(self, name: str) -> str:
        """A name; Greek letters by their names, figures and what follows an underscore as an index."""
        letter, _, index = re.sub(r"(?<=[A-Za-z])(\d+)$", r"_\1", name).partition("_")
        head = rf"\{letter}" if letter.lower() in GREEK else letter if len(letter) < 2 else rf"\mathrm{{{letter}}}"
        return rf"{head}_{{{index.replace('_', ', ')}}}" if index else head

    def call(self, part: Tree, arguments: Sequence[str]) -> Text:
        """A function at its arguments."""
        if not arguments:
            return Text(rf"\{part.head}", WHOLE)
        if part.head in ENCLOSURES:
            return Text(ENCLOSURES[part.head].format(arguments[0]), RAISED if part.head == "exp" else WHOLE)
        name = TO_LATEX.get(part.head, rf"\operatorname{{{part.head}}}")
        return Text(rf"{name}\left({', '.join(arguments)}\right)", WHOLE)

    def enclose(self, part: Text, floor: int) -> str:
        """A part in brackets that grow with it."""
        return part.text if part.level >= floor else rf"\left({part.text}\right)"

    def product(self, part: Tree, inner: Sequence[Text]) -> Text:
        """Factors over divisors."""
        sign = part.args[0] is MINUS_ONE
        above = [text for text in inner[sign:] if text.divisor is None]
        below = [text.divisor for text in inner[sign:] if text.divisor is not None]
        alone = len(above) == 1 and bool(below)
        texts = [self.enclose(text, RAISED if at else LOOSE if alone else TIGHT) for at, text in enumerate(above)]
        if inner[0].text.startswith("-") and part.args[0].head == NUMBER and not sign:
            texts[0] = inner[0].text
        top = (r" \cdot " if any(text[:1].isdigit() for text in texts[1:]) else " ").join(texts) or "1"
        if below:
            under = below[0].text if len(below) == 1 else " ".join(self.enclose(text, RAISED) for text in below)
            top = rf"\frac{{{top}}}{{{under}}}"
        return Text(f"-{top}" if sign else top, LOOSE if sign or top.startswith("-") else TIGHT)

    def power(self, part: Tree, base: Text, exponent: Text) -> Text:
        """A power; its exponent needs no brackets."""
        if part.args[1] is MINUS_ONE:
            return Text(rf"\frac{{1}}{{{base.text}}}", TIGHT, base)
        return Text(f"{self.enclose(base, WHOLE)}^{{{exponent.text}}}", RAISED)
