"""Expression text cut into tokens, each with its place.

ASCII only, and only what the language has: a letter that merely looks like another one, a
hexadecimal number or a digit separator is refused where it stands.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn

from navsym.core.errors import ExpressionSyntaxError, NavsymError, TooLargeError
from navsym.language.advice import advise_on_character
from navsym.language.names import describe_character, quote

LENGTH = 10_000  # characters of one expression
DIGITS = 1_000  # digits of one number
EXPONENT = 1_000  # largest power, and largest decimal exponent
DEPTH = 100  # nesting of parentheses, functions and towers of powers
CALLS = 12  # nesting of functions: constants such as sin(sin(...)) are compared numerically

TOKEN = re.compile(
    r"[ \t\r\n]*(?:(?P<number>[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)|(?P<mark>\*\*|[-+*/(),])|(?P<end>\Z))"
)

#: The same tokens in one sweep, a number with all that clings to it; and numbers that need no second look.
QUICK = re.compile(r"[0-9][\w.]*|[A-Za-z][A-Za-z0-9_]*|\*\*|[-+*/(),]")
PLAIN = re.compile(r"[0-9]{1,400}(?:\.[0-9]{1,400})?", re.ASCII)
#: The same for the whole language, which has vectors, matrices and relations.
WIDE_TOKEN = re.compile(TOKEN.pattern.replace(r"\*\*|[-+*/(),]", r"\*\*|[<>!]=|[-+*/(),@.\[\]<>=]"))
WIDE_QUICK = re.compile(QUICK.pattern.replace(r"\*\*|[-+*/(),]", r"\*\*|[<>!]=|[-+*/(),@.\[\]<>=]"))
SPACE = re.compile(r"[ \t\r\n]+")


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of the text: its kind, its characters and where it starts."""

    kind: str  # number, name, mark or end
    text: str
    start: int


@dataclass(frozen=True, slots=True)
class Source:
    """The text with the place it came from, able to point at a column of itself; wide for the whole language."""

    text: str
    where: str
    wide: bool = False

    def place(self, at: int) -> str:
        """``where`` with the line and column added."""
        row = self.text.count("\n", 0, at)
        column = at - (self.text.rfind("\n", 0, at) + 1) + 1
        spot = f"column {column}" if row == 0 else f"line {row + 1}, column {column}"
        return f"{self.where}, {spot}" if self.where else spot

    def around(self, at: int) -> str:
        """The neighbourhood of a column, quoted and escaped."""
        low, high = max(0, at - 15), at + 25
        dots = "..." if low else "", "..." if high < len(self.text) else ""
        return ascii(dots[0] + self.text[low:high] + dots[1])

    def fail(
        self, at: int, expected: str, got: str, remedy: str, error: type[NavsymError] = ExpressionSyntaxError
    ) -> NoReturn:
        """Raise ``error`` at a column, with the text around it."""
        near = f" in {self.around(at)}" if self.text.strip() else ""
        raise error(f"expected {expected}; got {got}{near}; {remedy}", where=self.place(at))


def split_tokens(source: Source, length: int = LENGTH) -> list[str]:
    """The texts of the tokens without their places, and some empty ones behind the last; raises as :func:`tokenize`."""
    quick = WIDE_QUICK if source.wide else QUICK
    texts: list[str] = quick.findall(source.text) if len(source.text) <= length else []
    whole = "".join(texts) == SPACE.sub("", source.text)
    if not whole or any(text[0] in "0123456789" and not PLAIN.fullmatch(text) for text in set(texts)):
        texts = [token.text for token in tokenize(source, length)]
    return [*texts, "", "", "", ""]


def tokenize(source: Source, length: int = LENGTH) -> Iterator[Token]:
    """Tokens of the text one by one, the last of kind ``"end"``.

    Raises ExpressionSyntaxError for what the language does not have, TooLargeError for long texts and numbers.
    """
    if len(source.text) > length:
        got, remedy = f"{len(source.text)}", "split the expression"
        source.fail(length, f"at most {length} characters", got, remedy, TooLargeError)
    at, kind = 0, ""
    while kind != "end":
        match = (WIDE_TOKEN if source.wide else TOKEN).match(source.text, at)
        if match is None:
            at += len(source.text[at:]) - len(source.text[at:].lstrip(" \t\r\n"))
            expected, got = "ASCII letters, digits and + - * / ** ( ) ,", describe_character(source.text[at])
            source.fail(at, expected, got, advise_on_character(source.text, at))
        kind = str(match.lastgroup)
        token = Token(kind, match[kind], match.start(kind))
        at = match.end()
        if kind == "number":
            refuse_tail(source, token, at)
        yield token


def refuse_tail(source: Source, token: Token, at: int) -> None:
    """A number ends where its digits end; it is not too long, and its exponent is not either."""
    following = source.text[at : at + 1]
    if following.isalpha() or following in {"_", "."}:
        word = re.match(r"[\w.]*", source.text[token.start :])
        got = quote(word[0] if word else following)
        remedy = "write products with * and numbers in decimal without separators: 2*x, 1000, 0.5"
        source.fail(token.start, "a decimal number", got, remedy)
    mantissa, _, exponent = token.text.lower().partition("e")
    if len(mantissa) > DIGITS:
        got, remedy = f"{len(mantissa)}", "shorten the number"
        source.fail(token.start, f"at most {DIGITS} digits", got, remedy, TooLargeError)
    if exponent and (len(exponent) > 8 or abs(int(exponent)) > EXPONENT):
        expected = f"a decimal exponent of at most {EXPONENT}"
        source.fail(token.start, expected, quote(exponent), "rescale the units", TooLargeError)
