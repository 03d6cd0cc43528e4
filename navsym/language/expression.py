"""Expressions in files: text to trees and to sympy, by a grammar of our own.

No string from a file reaches sympy's parsers or ``eval``. Numbers are read exactly. The
grammar, from the loosest to the tightest binding::

    sum      = product (("+" | "-") product)*
    product  = unary (("*" | "/") unary)*
    unary    = ("+" | "-")* power
    power    = atom ["**" unary]                     right associative, above a leading minus
    atom     = number | name | "pi" | function "(" sum ["," sum] ")" | "(" sum ")"

The tree holds what is written, with these conventions: signs in a row are one, ``-3`` and ``3/4`` at the head of a
product are numbers, ``-x`` is ``-1*x``, ``x - y`` is ``x + (-1)*y`` and ``x/y`` is ``x*y**(-1)``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice
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
from navsym.language import advice
from navsym.language.algebra import evaluate, evaluate_freely
from navsym.language.arithmetic import FACTORS, Refusal, refuse_size
from navsym.language.domains import list_conditions
from navsym.language.names import FUNCTIONS, INVERSES, RESERVED, check_name, quote
from navsym.language.printer import to_text
from navsym.language.tokens import CALLS, DEPTH, LENGTH, Source, Token, split_tokens, tokenize
from navsym.language.tree import (
    ARITY,
    MINUS_ONE,
    PI,
    POWER,
    PRODUCT,
    SUM,
    SYMBOL,
    Tree,
    build,
    build_number,
    build_symbol,
    list_names,
    list_parts,
    replace,
)

__all__ = ["Expr", "Matrix", "Parsed", "Symbol", "parse", "parse_noting", "read_tree", "symbol", "to_text"]

MARKS, SIGNS, OPENERS = frozenset("*/@"), frozenset("+-"), frozenset(("**", "(", ".", "["))
FOLLOWERS = OPENERS | {"/"}  # a number before one of them may be a part of another one
ZERO_LEAF, ONE_LEAF = build_number(0), build_number(1)
LONGEST = 2_000_000  # characters of a text that is read into a tree: nothing is evaluated there

# What the other files of this room need of the algebra, by our names.
Expr, Symbol, Matrix = sp.Expr, sp.Symbol, sp.ImmutableMatrix
ZERO, ONE = sp.S.Zero, sp.S.One


@dataclass(frozen=True, slots=True, eq=False)
class Parsed:
    """An expression with what its text takes for granted: sympy cancels ``x/x`` before anyone can ask.

    divisors  : what it divides by, to be nonzero
    radicands : what it takes roots and fractional powers of, and 1 - u**2 for asin(u) and acos(u), nonnegative
    arguments : what it takes logarithms and symbolic powers of, to be positive
    tree      : the text as it was written
    """

    expression: sp.Expr
    divisors: tuple[sp.Expr, ...]
    radicands: tuple[sp.Expr, ...]
    arguments: tuple[sp.Expr, ...]
    tree: Tree


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
    reader = start_reading(text, symbols, where, LENGTH)
    try:
        tree = reader.whole()
        values = evaluate(tree, symbols, reader.refuse_part)
        if values[tree].has(sp.I, sp.nan, sp.zoo, sp.oo, -sp.oo, sp.Float):
            reader.source.fail(0, "a finite real value", "another one", "correct the expression", DomainError)
        divisors, radicands, arguments = list_needs(tree, values)
        return Parsed(values[tree], divisors, radicands, arguments, tree)
    except RecursionError:
        reader.source.fail(0, "less nesting", "an expression too deep to build", "give parts a name", TooLargeError)


def list_needs(tree: Tree, values: dict[Tree, sp.Expr]) -> list[tuple[sp.Expr, ...]]:
    """What must be nonzero, nonnegative and positive, unless it is a constant or its symbols were declared so."""
    found: dict[str, dict[sp.Expr, None]] = {"!= 0": {}, ">= 0": {}, "> 0": {}}
    for part, relation in list_conditions(tree):
        if list_names(part):
            value = evaluate_freely(part, values)
            declared = {"!= 0": False, ">= 0": value.is_nonnegative, "> 0": value.is_positive}[relation]
            if value.free_symbols and not declared:
                found[relation][value] = None
    return [tuple(some) for some in found.values()]


def read_tree(text: str, names: Collection[str] | None = None, *, where: str = "") -> Tree:
    """The tree of a text; nothing in it is evaluated.

    names : the declared names; None takes every name that has no other meaning

    Raises EmptyError, ExpressionSyntaxError, UnknownSymbolError or TooLargeError (caps on length, depth and digits).

    >>> read_tree("0**0 + 1/(x - x)", {"x"})
    <0**0 + 1/(x - x)>
    """
    return start_reading(text, names, where, LONGEST).whole()


def start_reading(text: str, names: Collection[str] | None, where: str, length: int) -> Reader:
    """A reader at the beginning of a text, which must be one."""
    if not isinstance(text, str):
        message = f'expected an expression as text; got {quote(text)}; put it in quotes, such as "1/2"'
        raise ExpressionSyntaxError(message, where=where)
    for name in RESERVED.intersection(names or ()):
        check_name(name, where=where)
    if not text.strip():
        raise EmptyError('expected an expression; got an empty text; write one, such as "0"', where=where)
    source = Source(text, where)
    return Reader(source, split_tokens(source, length), names)


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
    """Recursive descent over the tokens; sums and products are built in one piece each.

    tokens : the texts of the tokens, an empty one at the end
    leaves : text of a token -> the number or symbol that it means
    places : part -> the token at which it was written first
    """

    source: Source
    tokens: list[str]
    names: Collection[str] | None
    position: int = 0
    depth: int = 0
    calls: int = 0
    leaves: dict[str, Tree] = field(default_factory=lambda: {"pi": PI})
    places: dict[Tree, int] = field(default_factory=dict)

    def make(self, at: int, head: str, *args: Tree) -> Tree:
        """A part, with its place."""
        part = build(head, args)
        self.places.setdefault(part, at)
        return part

    def whole(self) -> Tree:
        """The text as one tree, up to its end."""
        value = self.sum()
        if self.tokens[self.position]:
            self.unexpected("an operator or the end")
        return value

    def sum(self) -> Tree:
        """Terms with their signs."""
        at, tokens = self.position, self.tokens
        terms = [self.product(False)]
        while (mark := tokens[self.position]) in SIGNS:
            self.position += 1
            terms.append(self.product(mark == "-"))
        return self.make(at, SUM, *terms) if len(terms) > 1 else terms[0]

    def product(self, minus: bool) -> Tree:
        """Factors, inverted divisors, and what stands behind @, from left to right; a minus before them is a factor."""
        at, tokens = self.position, self.tokens
        factors = self.signed(minus, head=True)
        while (mark := tokens[self.position]) in MARKS:
            mark_at = self.position
            self.position += 1
            factor = self.unary()
            if mark == "@":
                left = self.make(at, PRODUCT, *factors) if len(factors) != 1 else factors[0]
                factors = [self.make(mark_at, "@", left, factor)]
            else:
                factors.append(factor if mark == "*" else self.make(mark_at, POWER, factor, MINUS_ONE))
            if len(factors) > FACTORS:
                self.refuse(mark_at, refuse_size(f"at most {FACTORS} factors in a product", "more"))
        return self.make(at, PRODUCT, *factors) if len(factors) != 1 else factors[0]

    def unary(self) -> Tree:
        """A power with signs before it; a name or a number alone, and its power with plain digits, in one look."""
        at = self.position
        token, following, exponent, behind = self.tokens[at : at + 4]
        leaf = self.leaves.get(token)
        if leaf is not None and following not in OPENERS:
            self.position += 1
            return leaf
        if leaf is not None and following == "**" and exponent.isdigit() and behind != "**":
            self.position += 3
            return self.make(at + 1, POWER, leaf, self.number(exponent))
        factors = self.signed(False, head=False)
        return self.make(at, PRODUCT, *factors) if len(factors) > 1 else factors[0]

    def signed(self, minus: bool, head: bool) -> list[Tree]:
        """The first factors behind signs, a minus as a number: none for the 1 of ``1/x``, one for ``-3``.

        head : at the head of a product, where ``3/4`` is one number
        """
        at = self.position
        token = self.tokens[at]
        while token in SIGNS:
            minus ^= token == "-"
            self.position += 1
            token = self.tokens[self.position]
        following = self.tokens[self.position + 1]
        leaf = self.leaves.get("-" + token if minus else token)
        if leaf is not None and following not in FOLLOWERS:
            self.position += 1
            return [leaf]
        if not token[:1].isdigit() or following == "**":
            return [MINUS_ONE, self.power()] if minus else [self.power()]
        divisor = self.literal_divisor() if head and following == "/" else ""
        self.position += 3 if divisor else 1
        if head and following == "/" and not (divisor or minus) and self.number(token) is ONE_LEAF:
            return []
        number = self.number(token, "-" * minus, divisor)
        self.places.setdefault(number, at)
        return [number]

    def literal_divisor(self) -> str:
        """The digits behind ``/`` when they alone are the divisor, and it is not zero."""
        token, following = self.tokens[self.position + 2 : self.position + 4]
        plain = token[:1].isdigit() and following != "**" and self.number(token) is not ZERO_LEAF
        return token if plain else ""

    def number(self, token: str, sign: str = "", divisor: str = "") -> Tree:
        """The number that digits mean, with a sign and over another one."""
        text = f"{sign}{token}/{divisor}" if divisor else sign + token
        leaf = self.leaves.get(text)
        if leaf is None:
            value = Fraction(sign + token) / Fraction(divisor) if divisor else Fraction(text)
            leaf = self.leaves[text] = build_number(value)
        return leaf

    def power(self) -> Tree:
        """An atom, raised or not."""
        base = self.atom()
        if self.tokens[self.position] != "**":
            return base
        at = self.position
        self.position += 1
        return self.make(at, POWER, base, self.nested(at, self.unary))

    def atom(self) -> Tree:
        """A number, a name, a call or a sum in parentheses."""
        at, token = self.position, self.tokens[self.position]
        if token == "(":
            self.position += 1
            value = self.nested(at, self.sum)
            self.close(at)
            return value
        if token[:1].isdigit():
            self.position += 1
            return self.number(token)
        if token[:1].isalpha():
            self.position += 1
            return self.name(at, token)
        self.unexpected("a number, a name, a function or (")

    def name(self, at: int, token: str) -> Tree:
        """A function, pi, or what the caller declared."""
        if token in FUNCTIONS:
            return self.function(at, token)
        if token == "pi":
            return PI
        if self.names is not None and token not in self.names:
            got, remedy = quote(token), advice.advise_on_name(token, self.names)
            self.fail(at, "a declared name or a function", got, remedy, UnknownSymbolError)
        if self.tokens[self.position] == "(":
            remedy = f"write a product with *: {token}*(...)"
            self.fail(at, "an operator after a name", f"{token}(", remedy)
        return self.leaves.setdefault(token, build(SYMBOL, (token,)))

    def function(self, at: int, name: str) -> Tree:
        """A call with as many arguments as the function takes."""
        opening = self.position
        self.open(name)
        self.calls += 1
        if self.calls > CALLS:
            got, remedy = "more", "give parts a name"
            self.fail(at, f"functions nested at most {CALLS} deep", got, remedy, TooLargeError)
        arguments = [self.nested(opening, self.sum)]
        while len(arguments) < ARITY[name] and self.tokens[self.position] == ",":
            self.position += 1
            arguments.append(self.nested(opening, self.sum))
        if len(arguments) < ARITY[name]:
            self.unexpected(f"a comma, since {name} takes {ARITY[name]} arguments,")
        if self.tokens[self.position] == ",":
            number = "one argument" if ARITY[name] == 1 else "two arguments"
            remedy = f"write a decimal point, or remove the rest: {name} takes {number}"
            self.fail(self.position, f") after the last argument of {name}", "','", remedy)
        self.close(opening)
        self.calls -= 1
        return self.apply(at, name, arguments)

    def apply(self, at: int, name: str, arguments: list[Tree]) -> Tree:
        """A function at its arguments; an inverse hyperbolic one is its logarithm."""
        if name not in INVERSES:
            return self.make(at, name, *arguments)
        tree = replace(read_tree(INVERSES[name]), {build_symbol("x"): arguments[0]})
        for part in list_parts(tree):
            self.places.setdefault(part, at)
        return tree

    def open(self, name: str) -> None:
        """The parenthesis behind the name of a function."""
        token = self.tokens[self.position]
        if token == "**":
            self.unexpected(f"( after {name}")
        if token != "(":
            got = quote(token) if token else "the end of the text"
            remedy = f"put what it is taken of in parentheses: {name}(...)"
            self.fail(self.position, f"( after {name}", got, remedy)
        self.position += 1

    def close(self, opening: int) -> None:
        """The parenthesis that ends what ``opening`` began."""
        if self.tokens[self.position] != ")":
            place = self.source.place(self.token_at(opening).start).rpartition(", ")[2]
            self.unexpected(f") to close the ( of {place}")
        self.position += 1

    def nested(self, at: int, rule: Callable[[], Tree]) -> Tree:
        """A rule one level deeper."""
        self.depth += 1
        if self.depth > DEPTH:
            self.fail(at, f"at most {DEPTH} levels", "more", "give parts a name", TooLargeError)
        value = rule()
        self.depth -= 1
        return value

    # -- errors, with the places of their tokens -----------------------------------------

    def token_at(self, at: int) -> Token:
        """A token with its place, which reading without errors does not need."""
        return next(islice(tokenize(self.source, LONGEST), at, None))

    def fail(
        self, at: int, expected: str, got: str, remedy: str, error: type[NavsymError] = ExpressionSyntaxError
    ) -> NoReturn:
        """Raise the error at a token."""
        self.source.fail(self.token_at(at).start, expected, got, remedy, error)

    def unexpected(self, expected: str) -> NoReturn:
        """Refuse the token that stands here."""
        token = self.token_at(self.position)
        got = "the end of the text" if token.kind == "end" else quote(token.text)
        implicit = token.kind in ("number", "name") or token.text == "("
        self.source.fail(token.start, expected, got, advice.advise_on_token(self.source.text, token.start, implicit))

    def refuse_part(self, part: Tree, refusal: Refusal) -> NoReturn:
        """Place a refusal of the algebra where the part was written first."""
        at = self.places[part]
        if refusal.expected == "a nonzero divisor" and self.tokens[at] == "**":
            refusal = Refusal(refusal.error, "a nonzero base", "zero to a negative power", refusal.remedy)
        self.refuse(at, refusal)

    def refuse(self, at: int, refusal: Refusal) -> NoReturn:
        """Place a refusal at a token."""
        self.fail(at, refusal.expected, refusal.got, refusal.remedy, refusal.error)
