"""Values of Python programs as text of the language: nothing but that text goes on.

A caller gives text, integers, fractions, decimals, sympy expressions or arrays of integers. All of them are written
down and read again like a file, so that no object of the algebra gets behind the caps and checks of the reader.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError, ExpressionSyntaxError, NavsymError, TooLargeError
from navsym.core.units import convert_text, drop_unit, is_quantity, unit_text
from navsym.language.algebra import float_error
from navsym.language.declarations import SIGNS
from navsym.language.expression import Expr, parse
from navsym.language.names import join_place, quote
from navsym.language.printer import to_text

#: Longest whole number or fraction: Python itself refuses to write one of more than 4,300 digits.
MOST_BITS = 12_000
#: Where the whole numbers begin that sympy assumes.
WHOLE: dict[str, dict[str, bool]] = {"-oo": {}, "0": {"nonnegative": True}, "1": {"positive": True}}
#: Places behind the name of an array: ``v_1`` or ``P__1_2``.
ENTRY = re.compile(r"(?:_+\d+)+$", re.ASCII)
#: What a symbol of sympy without assumptions is taken for, and what stronger words include.
STRONGER = {"positive": ("nonnegative", "nonzero", "real"), "nonnegative": ("real",), "nonzero": ("real",), "real": ()}


def write_value(value: Any, where: str, unit: str = "") -> str:
    """Text of an exact value; text itself stays as it is.

    unit : what quantities of pint are converted to, exactly; SI where it is empty

    Raises DomainError for a float and shows its exact spelling, ExpressionSyntaxError for any other kind of value.

    >>> write_value(Fraction(1, 3), ""), write_value("cos(w*t)", ""), write_value(sp.sqrt(2), "")
    ('1/3', 'cos(w*t)', 'sqrt(2)')
    """
    if isinstance(value, str):
        return value
    if is_quantity(value):
        number = value.magnitude
        if isinstance(number, float) and abs(number) < math.inf:
            remedy = f'write Fraction("{Fraction(repr(float(number)))}") in its place'
            message = f"expected an exact magnitude; got the float {float(number)!r} of {unit_text(value)}; {remedy}"
            raise DomainError(message, where=where)
        return convert_text(write_value(number, where), unit_text(value), unit, where)
    if isinstance(value, sp.Basic):
        return write_expression(value, where)
    if isinstance(value, bool):
        raise ExpressionSyntaxError(f"expected an exact number; got {value}; write 0 or 1", where=where)
    if isinstance(value, numbers.Rational):
        exact = Fraction(int(value.numerator), int(value.denominator))
        if exact.numerator.bit_length() + exact.denominator.bit_length() > MOST_BITS:
            message = f"expected a number of at most {MOST_BITS} bits; got {quote(value)}; write it as a power"
            raise TooLargeError(message, where=where)
        return str(exact)
    if isinstance(value, Decimal) and value.is_finite():
        return f"{value:f}" if abs(value.adjusted()) < 100 else str(value)
    if isinstance(value, (numbers.Real, Decimal)):
        raise float_error(float(value), where)
    got = quote(value)
    message = f"expected text, an exact number or a sympy expression; got {got}; write the formula as text"
    raise ExpressionSyntaxError(message, where=where)


def write_expression(value: sp.Basic, where: str) -> str:
    """Text of a sympy expression without floating-point numbers."""
    floats = sorted(value.atoms(sp.Float), key=str)
    if floats:
        raise float_error(float(floats[0]), where)
    try:
        return to_text(value, calculus=True)
    except NavsymError as error:
        raise error.at(where) from None


def read_constant(value: Any, where: str, unit: str = "") -> Expr:
    """The exact number that a value means, in a unit or in SI: ``"pi/2"``, ``Fraction(1, 3)``, ``"3 deg/h"``.

    Raises the errors of :func:`write_value` and of the reader, and DomainError for a quantity of another dimension.
    """
    return parse(drop_unit(write_value(value, where, unit), where, unit), {}, where=where)


def write_entries(value: Any, where: str, unit: str = "") -> Any:
    """Text of a value, or nested lists of texts for a list, a matrix of sympy or an array of numpy.

    >>> write_entries([[0, Fraction(-1, 2)], ["a", "b"]], "F")
    [['0', '-1/2'], ['a', 'b']]
    """
    rows = value.tolist() if hasattr(value.magnitude if is_quantity(value) else value, "tolist") else value
    if isinstance(rows, (list, tuple)):
        return [write_entries(row, join_place(where, i), unit) for i, row in enumerate(rows)]
    return write_value(rows, where, unit)


def write_declaration(value: Any, where: str, unit: str = "") -> Any:
    """A declaration as ``[symbols]`` has it: a word, or a range of two texts from a pair of exact numbers.

    unit : of the ends of a range of quantities; a table says its own
    """
    if isinstance(value, (tuple, list)):
        return [write_value(end, join_place(where, i), unit) for i, end in enumerate(value)]
    if isinstance(value, Mapping) and isinstance(value.get("range"), (tuple, list)):
        return {**value, "range": write_declaration(value["range"], join_place(where, "range"), value.get("unit", ""))}
    if isinstance(value, (str, Mapping)):
        return value
    expected = f'a range such as ("1/2", "2") or one of {", ".join(SIGNS)}'
    message = f"expected {expected}; got {quote(value)}; declare it in one of these ways"
    raise ExpressionSyntaxError(message, where=where)


def declared_unit(name: str, declared: Any) -> str:
    """The unit that a table declares for a name, or for the array of which it is an entry; empty where it has none."""
    own = declared.get(name, declared.get(ENTRY.sub("", str(name)))) if isinstance(declared, Mapping) else None
    return str(own.get("unit", "")) if isinstance(own, Mapping) else ""


def read_assumptions(values: Iterable[Any], where: str) -> dict[str, Any]:
    """Name -> word of the symbols in expressions of sympy: what their assumptions say.

    Raises DomainError for two symbols of one name, and for assumptions that no declaration expresses.
    """
    symbols: dict[str, sp.Symbol] = {}
    for symbol in sorted(set(symbols_in_values(values)), key=lambda s: (s.name, str(s.assumptions0))):
        known = symbols.setdefault(symbol.name, symbol)
        if known != symbol:
            got = f"two called {symbol.name}, {declaration_word(known, where)} and {declaration_word(symbol, where)}"
            message = f"expected one symbol of each name; got {got}; declare both alike or rename one"
            raise DomainError(message, where=where)
    return {name: declaration_word(symbol, where) for name, symbol in symbols.items()}


def symbols_in_values(values: Iterable[Any]) -> Iterable[sp.Symbol]:
    """Symbols in values of sympy, also inside lists."""
    for value in values:
        if isinstance(value, (sp.Basic, sp.MatrixBase)):
            yield from value.free_symbols
        elif isinstance(value, (list, tuple)):
            yield from symbols_in_values(value)


def declaration_word(symbol: sp.Symbol, where: str) -> Any:
    """The declaration that says what sympy assumes of a symbol; one without assumptions is real."""
    if symbol == sp.Symbol(symbol.name):
        return "real"
    for word, assumptions in SIGNS.items():
        if symbol == sp.Symbol(symbol.name, real=True, **assumptions):
            return word
    for low, assumptions in WHOLE.items():
        if symbol == sp.Symbol(symbol.name, integer=True, **assumptions):
            return {"integer": [low, "oo"]}
    assumed = ", ".join(name for name, value in sorted(symbol._assumptions_orig.items()) if value)
    expected = f"symbols that sympy takes to be {' or '.join(SIGNS)}"
    message = f"expected {expected}; got {symbol} ({assumed}); declare it in one of these ways"
    raise DomainError(message, where=where)


def merge_declarations(
    words: Mapping[str, str], given: Mapping[str, Any], where: str
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Declarations and ranges inside them, from the symbols of sympy and from what the caller declared.

    A range of a symbol that sympy takes to be positive narrows that declaration: an expression that was simplified
    by it would be wrong outside. Raises DomainError where a word says less than the symbol.
    """
    declared: dict[str, Any] = dict(words)
    box: dict[str, Any] = {}
    for name, value in given.items():
        word = words.get(name, "real")
        if word == "real":
            declared[name] = value
        elif isinstance(value, list):
            box[name] = value
        elif value != word and word not in STRONGER.get(str(value), ()):
            got = f"{name} = {value!r} for a symbol that sympy takes to be {word}"
            message = f"expected one declaration of {name}; got {got}; declare it {word} or change the symbol"
            raise DomainError(message, where=f"{where}: {name}")
        else:
            declared[name] = value
    return declared, box
