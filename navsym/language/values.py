"""Values from Python as text of the language of files: exact numbers and formulas, never floats."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any

from navsym.core.errors import DomainError, NavsymError, NotFiniteError
from navsym.language.names import inside, shown


def exact_text(value: Any, where: str = "") -> str:
    """Text of the language of files for one exact value.

    value : text (returned as it is), int, Fraction, Decimal, an integer of numpy, or a sympy expression
    where : names the argument in errors

    Raises DomainError for a float, with its exact spelling, and for what is no formula; NotFiniteError for infinities.

    >>> exact_text(Fraction(1, 3)), exact_text("cos(w*t)"), exact_text(Decimal("0.25"))
    ('1/3', 'cos(w*t)', '1/4')
    """
    if isinstance(value, str):
        return value
    value = plain_number(value)
    if isinstance(value, bool):
        raise DomainError(f"expected an exact number or a formula; got {value}; write a number", where=where)
    if isinstance(value, float | complex):
        raise float_error(value, where)
    if isinstance(value, Decimal):
        if not value.is_finite():
            raise NotFiniteError(f"expected a finite number; got {value}; give one", where=where)
        value = Fraction(value)
    if isinstance(value, int | Fraction):
        return str(value)
    return formula_text(value, where)


def formula_text(value: Any, where: str) -> str:
    """Text of a sympy expression; whoever made one has loaded sympy, so that nobody else waits for it."""
    sympy = sys.modules.get("sympy")
    if sympy is None or not isinstance(value, sympy.Basic):
        got = shown(value)
        raise DomainError(f'expected an exact number or a formula; got {got}; write it as text: "1/2"', where=where)
    for inexact in value.atoms(sympy.Float):
        raise float_error(float(inexact), where)
    from navsym.language.printer import to_text

    try:
        return to_text(value)
    except NavsymError as error:
        raise error.at(where) if where else error from None


def plain_number(value: Any) -> Any:
    """A scalar of numpy as the number of Python that it is; anything else as it is."""
    item = getattr(value, "item", None)
    return item() if callable(item) and getattr(value, "shape", None) == () else value


def float_error(value: float | complex, where: str) -> NavsymError:
    """The error for a number that is not exact, with the spelling that is: 0.1 is "1/10" or "0.1" as text."""
    if isinstance(value, complex):
        return DomainError(f"expected a real exact number; got {value}; give its parts", where=where)
    if value != value or value in (float("inf"), float("-inf")):
        return NotFiniteError(f"expected a finite number; got {value}; give one", where=where)
    exact = Fraction(repr(value))
    spellings = f'"{value!r}" as text' if exact.denominator > 10_000 else f'"{exact}" or "{value!r}" as text'
    return DomainError(f"expected an exact number; got the float {value!r}; write {spellings}", where=where)


def text_list(value: Any, where: str) -> Any:
    """A list of texts from a list, tuple, array or matrix, nested as deep as it is; a single value as one text.

    >>> text_list([[0, Fraction(-1, 2)], ["a", "b"]], "F")
    [['0', '-1/2'], ['a', 'b']]
    """
    rows = value.tolist() if hasattr(value, "tolist") and not isinstance(value, str) else value
    if isinstance(rows, list | tuple):
        return [text_list(row, inside(where, k)) for k, row in enumerate(rows)]
    return exact_text(rows, where)


def text_values(values: Mapping[str, Any], where: str = "") -> dict[str, str]:
    """Exact values of parameters as text: name -> value; ``where`` names the call in errors."""
    return {name: exact_text(value, inside(where, name)) for name, value in values.items()}
