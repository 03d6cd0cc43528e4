"""Expressions in files: text to sympy and back, by a grammar of our own.

No string from a file reaches sympy's parsers or ``eval``. Numbers are read exactly. The
grammar, from the loosest to the tightest binding::

    sum      = product (("+" | "-") product)*
    product  = unary (("*" | "/") unary)*
    unary    = ("+" | "-")* power
    power    = atom ["**" unary]                     right associative, above a leading minus
    atom     = number | name | "pi" | function "(" sum ["," sum] ")" | "(" sum ")"
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NoReturn

import sympy as sp

from navsym.core.errors import (
    DomainError,
    EmptyError,
    ExpressionSyntaxError,
    NavsymError,
    TooLargeError,
    UnknownSymbolError,
)
from navsym.language import advice, arithmetic
from navsym.language.names import FUNCTIONS, RESERVED, check_name, quote
from navsym.language.printer import to_text
from navsym.language.tokens import CALLS, DEPTH, Source, Token, tokenize

ROOT_TOTAL = 3_000  # bits of all numbers under roots in one expression

__all__ = ["Expr", "Matrix", "Parsed", "Symbol", "parse", "parse_noting", "symbol", "to_text"]

# What the other files of this room need of the algebra, by our names.
Expr, Symbol, Matrix = sp.Expr, sp.Symbol, sp.ImmutableMatrix
ZERO, ONE = sp.S.Zero, sp.S.One


@dataclass(frozen=True, slots=True, eq=False)
class Parsed:
    """An expression with what its text takes for granted: sympy cancels ``x/x`` before anyone can ask.

    divisors  : what it divides by, to be nonzero
    radicands : what it takes roots and fractional powers of, and 1 - u**2 for asin(u) and acos(u), nonnegative
    arguments : what it takes logarithms and symbolic powers of, to be positive
    """

    expression: sp.Expr
    divisors: tuple[sp.Expr, ...]
    radicands: tuple[sp.Expr, ...] = ()
    arguments: tuple[sp.Expr, ...] = ()


def parse(text: str, symbols: Mapping[str, sp.Symbol], *, where: str = "") -> sp.Expr:
    """The expression that the text means, exactly.

    symbols : declared name -> symbol, made by :func:`symbol`
    where   : ``"file: key"``; the column is added to it

    Raises EmptyError, ExpressionSyntaxError, UnknownSymbolError, DomainError (division by zero, a value
    that is not real) or TooLargeError (caps on length, depth, exponents, digits, roots).
    """
    return parse_noting(text, symbols, where=where).expression


def parse_noting(text: str, symbols: Mapping[str, sp.Symbol], *, where: str = "") -> Parsed:
    """Like :func:`parse`, together with every symbolic divisor and radicand that the text has."""
    if not isinstance(text, str):
        raise ExpressionSyntaxError(
            f'expected an expression as text; got {quote(text)}; put it in quotes, such as "1/2"', where=where
        )
    for name in RESERVED & symbols.keys():
        check_name(name, where=where)
    if not text.strip():
        raise EmptyError('expected an expression; got an empty text; write one, such as "0"', where=where)
    source = Source(text, where)
    reader = Reader(source, tokenize(source), symbols)
    try:
        whole = reader.whole()
        noted = (reader.divisors, reader.radicands, reader.arguments)
        return Parsed(whole, *(tuple(dict.fromkeys(found)) for found in noted))
    except RecursionError:
        source.fail(0, "less nesting", "an expression too deep to build", "give parts a name", TooLargeError)


def symbol(
    name: str,
    *,
    real: bool = True,
    positive: bool = False,
    nonnegative: bool = False,
    nonzero: bool = False,
    where: str = "",
) -> sp.Symbol:
    """A symbol with a checked ASCII name: the only kind that may reach code generation."""
    wanted = {"real": real, "positive": positive, "nonnegative": nonnegative, "nonzero": nonzero}
    return sp.Symbol(check_name(name, where=where), **{key: True for key, value in wanted.items() if value})


@dataclass(slots=True, eq=False)
class Reader:
    """Recursive descent over the tokens; sums and products are built in one piece each."""

    source: Source
    tokens: list[Token]
    symbols: Mapping[str, sp.Symbol]
    position: int = 0
    depth: int = 0
    calls: int = 0
    root_bits: int = 0
    divisors: list[sp.Expr] = field(default_factory=list)
    radicands: list[sp.Expr] = field(default_factory=list)
    arguments: list[sp.Expr] = field(default_factory=list)

    @property
    def token(self) -> Token:
        """The token that is read next; the last one marks the end."""
        return self.tokens[self.position]

    def take(self, *marks: str) -> Token | None:
        """The next token if it is one of these marks."""
        token = self.token
        if token.kind != "mark" or token.text not in marks:
            return None
        self.position += 1
        return token

    def whole(self) -> sp.Expr:
        """The text as one expression, up to its end."""
        value = self.sum()
        if self.token.kind != "end":
            self.unexpected("an operator or the end")
        if value.has(sp.I, sp.nan, sp.zoo, sp.oo, -sp.oo, sp.Float):
            self.source.fail(0, "a finite real value", "another one", "correct the expression", DomainError)
        return value

    def sum(self) -> sp.Expr:
        """Terms, added in one step."""
        at, terms = self.token.start, [self.product()]
        while mark := self.take("+", "-"):
            term = self.product()
            terms.append(term if mark.text == "+" else self.minus(mark.start, term))
        return self.apply(at, arithmetic.add_exactly, terms)

    def product(self) -> sp.Expr:
        """Factors and inverted divisors, multiplied in one step; a leading minus is a factor."""
        at, sign = self.token.start, self.signs()
        factors = [self.power()] if sign > 0 else [sp.S.NegativeOne, self.power()]
        while mark := self.take("*", "/"):
            factor = self.unary()
            factors.append(factor if mark.text == "*" else self.inverse(mark.start, factor))
            self.apply(mark.start, arithmetic.bound_factors, factors)
        return self.apply(at, arithmetic.multiply_exactly, factors)

    def inverse(self, at: int, divisor: sp.Expr) -> sp.Expr:
        """One over a divisor, which is noted."""
        if divisor.free_symbols:
            self.divisors.append(divisor)
        return self.apply(at, arithmetic.invert_exactly, divisor)

    def unary(self) -> sp.Expr:
        """A power with signs before it."""
        at, sign = self.token.start, self.signs()
        value = self.power()
        return value if sign > 0 else self.minus(at, value)

    def signs(self) -> int:
        """The product of the signs that stand here."""
        sign = 1
        while mark := self.take("+", "-"):
            sign = -sign if mark.text == "-" else sign
        return sign

    def minus(self, at: int, value: sp.Expr) -> sp.Expr:
        """The value with the other sign."""
        return self.apply(at, arithmetic.multiply_exactly, [sp.S.NegativeOne, value])

    def power(self) -> sp.Expr:
        """An atom, raised or not; a base under a negative exponent is a divisor."""
        base = self.atom()
        mark = self.take("**")
        if mark is None:
            return base
        exponent = self.nested(mark, self.unary)
        if exponent.is_extended_negative is not False and base.free_symbols and exponent.is_number:
            self.divisors.append(base)
        self.count_roots(mark, base, exponent)
        return self.apply(mark.start, arithmetic.raise_exactly, base, exponent)

    def count_roots(self, mark: Token, base: sp.Expr, exponent: sp.Expr) -> None:
        """The algebra factors numbers under roots, again in every product: their total is bounded."""
        if exponent.is_integer is not True:
            self.root_bits += arithmetic.number_bits(base)
            note = self.note_radicand if exponent.is_number else self.note_argument
            note(base)
        if self.root_bits > ROOT_TOTAL:
            got, remedy = f"more, with {self.root_bits} bits", "split the expression"
            self.source.fail(mark.start, f"at most {ROOT_TOTAL} bits under roots", got, remedy, TooLargeError)

    def atom(self) -> sp.Expr:
        """A number, a name, a call or a sum in parentheses."""
        token = self.token
        self.position += 1
        if token.kind == "number":
            return self.apply(token.start, arithmetic.number_from_text, token.text)
        if token.kind == "name":
            return self.name(token)
        if token.text == "(":
            value = self.nested(token, self.sum)
            self.close(token)
            return value
        self.position -= 1
        self.unexpected("a number, a name, a function or (")

    def name(self, token: Token) -> sp.Expr:
        """A function, pi, or what the caller declared."""
        if token.text in FUNCTIONS:
            return self.function(token)
        if token.text == "pi":
            return sp.pi
        if token.text not in self.symbols:
            got, remedy = quote(token.text), advice.advise_on_name(token.text, self.symbols)
            self.source.fail(token.start, "a declared name or a function", got, remedy, UnknownSymbolError)
        if self.token.kind == "mark" and self.token.text == "(":
            remedy = f"write a product with *: {token.text}*(...)"
            self.source.fail(token.start, "an operator after a name", f"{token.text}(", remedy)
        return self.symbols[token.text]

    def function(self, token: Token) -> sp.Expr:
        """A call with as many arguments as the function takes."""
        wanted = 2 if token.text == "atan2" else 1
        opening = self.take("(")
        if opening is None and self.token.text == "**":
            self.unexpected(f"( after {token.text}")
        if opening is None:
            got = "the end of the text" if self.token.kind == "end" else quote(self.token.text)
            remedy = f"put what it is taken of in parentheses: {token.text}(...)"
            self.source.fail(self.token.start, f"( after {token.text}", got, remedy)
        self.calls += 1
        if self.calls > CALLS:
            got, remedy = "more", "give parts a name"
            self.source.fail(token.start, f"functions nested at most {CALLS} deep", got, remedy, TooLargeError)
        arguments = [self.nested(opening, self.sum)]
        while len(arguments) < wanted and self.take(","):
            arguments.append(self.nested(opening, self.sum))
        if len(arguments) < wanted:
            self.unexpected(f"a comma, since {token.text} takes {wanted} arguments,")
        if self.token.text == "," and self.token.kind == "mark":
            number = "one argument" if wanted == 1 else "two arguments"
            remedy = f"write a decimal point, or remove the rest: {token.text} takes {number}"
            self.source.fail(self.token.start, f") after the last argument of {token.text}", "','", remedy)
        self.close(opening)
        self.calls -= 1
        if token.text == "sqrt":
            self.count_roots(token, arguments[0], sp.S.Half)
        self.note_domain(token.text, arguments)
        return self.apply(token.start, arithmetic.call_function, token.text, arguments)

    def note_domain(self, name: str, arguments: list[sp.Expr]) -> None:
        """Remember where the function exists."""
        if name == "log":
            self.note_argument(arguments[0])
        if name in ("asin", "acos"):
            self.note_radicand(1 - arguments[0] ** 2)
        if name in ("tan", "cot", "sec", "csc"):
            self.note_pole(name, arguments[0])
        if name == "atan2" and any(part.free_symbols for part in arguments):
            self.divisors.append(sp.Add(*(part**2 for part in arguments)))

    def note_argument(self, base: sp.Expr) -> None:
        """Remember what must be positive, unless its symbols were declared so."""
        if base.free_symbols and not base.is_positive:
            self.arguments.append(base)

    def note_radicand(self, base: sp.Expr) -> None:
        """Remember what must be nonnegative, unless its symbols were declared so."""
        if base.free_symbols and not base.is_nonnegative:
            self.radicands.append(base)

    def note_pole(self, name: str, argument: sp.Expr) -> None:
        """tan and sec divide by the cosine, cot and csc by the sine."""
        divisor = sp.cos(argument) if name in ("tan", "sec") else sp.sin(argument)
        if divisor.free_symbols:
            self.divisors.append(divisor)

    def close(self, opening: Token) -> None:
        """The parenthesis that ends what ``opening`` began."""
        if not self.take(")"):
            self.unexpected(f") to close the ( of {self.source.place(opening.start).rpartition(', ')[2]}")

    def nested(self, token: Token, rule: Callable[[], sp.Expr]) -> sp.Expr:
        """A rule one level deeper."""
        self.depth += 1
        if self.depth > DEPTH:
            got, remedy = "more", "give parts a name"
            self.source.fail(token.start, f"at most {DEPTH} levels", got, remedy, TooLargeError)
        value = rule()
        self.depth -= 1
        return value

    def unexpected(self, expected: str) -> NoReturn:
        """Refuse the token that stands here."""
        token = self.token
        got = "the end of the text" if token.kind == "end" else quote(token.text)
        implicit = token.kind in ("number", "name") or token.text == "("
        self.source.fail(token.start, expected, got, advice.advise_on_token(self.source.text, token.start, implicit))

    def apply(self, at: int, step: Callable[..., sp.Expr], *arguments: object) -> sp.Expr:
        """One step of arithmetic, with its refusal placed in the text."""
        try:
            return step(*arguments)
        except arithmetic.Refusal as refusal:
            self.source.fail(at, refusal.expected, refusal.got, refusal.remedy, refusal.error)
        except (NavsymError, RecursionError, MemoryError):
            raise
        except Exception as failure:  # sympy's own evaluation gave up on an exotic constant
            got = f"one on which the algebra stops ({type(failure).__name__})"
            self.source.fail(at, "a value that exists exactly", got, "simplify it", DomainError)
