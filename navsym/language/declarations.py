"""Declared symbols: a range, or what is known of the sign."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from navsym.core.errors import DomainError, ExpressionSyntaxError, ShapeError, TooLargeError
from navsym.core.units import drop_unit
from navsym.language.arithmetic import sign_of_constant
from navsym.language.expression import Expr, Symbol, symbol
from navsym.language.names import quote, suggest_nearest
from navsym.language.schema import SIDE, Table, as_list, describe_value, join_place, read_entry

Kind = Literal["range", "real", "positive", "nonnegative", "nonzero"]

SIGNS: dict[str, dict[str, bool]] = {
    "real": {},
    "positive": {"positive": True},
    "nonnegative": {"nonnegative": True},
    "nonzero": {"nonzero": True},
}


@dataclass(frozen=True, slots=True)
class Parameter:
    """A declared symbol.

    symbol       : real, and positive or nonnegative where the declaration says so
    lower, upper : exact ends of its range, None where it has none (closed where given)
    kind         : "range", or the word of the declaration
    unit         : in which its values are; SI where it is empty
    """

    name: str
    symbol: Symbol
    lower: Expr | None
    upper: Expr | None
    kind: Kind
    unit: str = ""


def read_parameters(table: Table, where: str) -> dict[str, Parameter]:
    """Parameters of a ``[parameters]`` or ``[symbols]`` table, in its order."""
    if len(table) > SIDE:
        message = f"expected at most {SIDE} names; got {len(table)}; split the file"
        raise TooLargeError(message, where=where)
    return {name: read_parameter(name, value, join_place(where, name)) for name, value in table.items()}


def read_parameter(name: str, value: Any, where: str) -> Parameter:
    """One declaration: a range, or a word about the sign."""
    if isinstance(value, list):
        lower, upper = read_range(value, where)
        is_positive = sign_of_constant(lower) == 1
        own = symbol(name, where=where, positive=is_positive, nonnegative=not is_positive and lower == 0)
        return Parameter(name, own, lower, upper, "range")
    if not isinstance(value, str) or value not in SIGNS:
        got = quote(value) if isinstance(value, str) else describe_value(value)
        hint = f": {suggest_nearest(value, SIGNS)}" if isinstance(value, str) else ""
        expected = f'a range such as ["1/2", "2"] or one of {", ".join(SIGNS)}'
        remedy = f"{advise_on_declaration(value, name)}{hint}"
        raise ExpressionSyntaxError(f"expected {expected}; got {got}; {remedy}", where=where)
    made = symbol(name, where=where, **SIGNS[value])
    return Parameter(name, made, None, None, value)  # type: ignore[arg-type]


def advise_on_declaration(value: Any, name: str) -> str:
    """What to do with a declaration that is none; a number is what people write for a constant."""
    text = value if isinstance(value, str) else "a number" if isinstance(value, int | float) else ""
    if text == "a number" or text[:1].isdigit() or text[:1] in "+-.":
        return f"declare a range and give the value by --set {name}=…, or write the number in place of {name}"
    return "correct it"


def read_range(value: Any, where: str, unit: str = "") -> tuple[Expr, Expr]:
    """Two exact numbers, the first below the second; ``"9 km"`` is one too, in a unit or in SI."""
    ends = as_list(value, where, "a range of two numbers")
    if len(ends) != 2:
        raise ShapeError(f"expected a range of two numbers; got {len(ends)}; give both ends", where=where)
    places = [join_place(where, i) for i in range(2)]
    lower, upper = (read_entry(drop_unit(end, at, unit), {}, at) for end, at in zip(ends, places, strict=True))
    if sign_of_constant(upper - lower) == 0:
        message = f"expected two different numbers; got {cut_text(lower)} twice; write a constant in place of the name"
        raise DomainError(message, where=where)
    require_order(lower, upper, where)
    return lower, upper


def require_order(lower: Expr, upper: Expr, where: str) -> None:
    """Refuse ends that are not in order, as far as that can be decided."""
    if sign_of_constant(upper - lower) in (0, -1):
        got = f"{cut_text(lower)} and {cut_text(upper)}"
        message = f"expected the lower end below the upper one; got {got}; swap or correct them"
        raise DomainError(message, where=where)


def require_positive(value: Expr, what: str, where: str) -> None:
    """Refuse a number that is not positive, and a name that is not declared to be."""
    declared = value.is_Symbol and (value.is_positive or value.is_nonnegative)
    if not declared and (value.is_Symbol or sign_of_constant(value) in (0, -1) or value.is_nonpositive):
        message = f"expected {what} above zero; got {cut_text(value)}; correct it or declare it positive"
        raise DomainError(message, where=where)


def cut_text(value: object) -> str:
    """An expression of our own making, cut for a message."""
    text = str(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def symbols_of(parameters: Mapping[str, Parameter]) -> dict[str, Symbol]:
    """Name -> symbol."""
    return {name: parameter.symbol for name, parameter in parameters.items()}


def box_of(parameters: Mapping[str, Parameter]) -> dict[Symbol, tuple[Expr, Expr]]:
    """Symbol -> (lower, upper) for the parameters that have a range."""
    return {p.symbol: (p.lower, p.upper) for p in parameters.values() if p.kind == "range"}
