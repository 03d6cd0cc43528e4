"""The arithmetic of a counterexample, done again in balls from the text of the two sides.

So a reader sees numbers that the decision itself did not hand over.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from typing import Any

from navsym.errors import NavsymError
from navsym.proof.balls import enclose, tape
from navsym.proof.wording import decimal_ends
from navsym.text.expression import parse, symbol
from navsym.text.names import RESERVED

Record = Mapping[str, Any]
LONGEST = 20_000
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """Both sides of one entry at the counterexample, as decimals that enclose them from below and above."""

    entry: int
    printed: tuple[str, str]
    derived: tuple[str, str]

    @property
    def differs(self) -> bool:
        """True when the two sides are not the same."""
        return self.printed != self.derived


def arithmetic(record: Record) -> list[Arithmetic]:
    """Values of both sides at the counterexample, for the entries that are numbers there."""
    point = record["counterexample"]
    if point is None:
        return []
    printed = entries_of(record["printed"].split(" +- ")[0])
    derived = entries_of(record["derived"])
    if not derived or len(printed) != len(derived):
        return []
    single, found = len(printed) == 1, []
    for place, pair in enumerate(zip(printed, derived, strict=True), start=1):
        if pair[0] == pair[1]:
            continue
        try:
            found.append(Arithmetic(0 if single else place, *(value_at(side, point) for side in pair)))
        except (NavsymError, ValueError, ArithmeticError, TypeError):
            continue
    return found


def value_at(text: str, point: Mapping[str, str]) -> tuple[str, str]:
    """Decimals below and above the value of an expression at a point.

    Raises NavsymError for text outside the language, ValueError where the value is not finite.
    """
    names = sorted({name for name in NAME.findall(text) if name not in RESERVED} | set(point))
    symbols = {name: symbol(name) for name in names}
    expression = parse(text, symbols)
    if expression.free_symbols - {symbols[name] for name in point}:
        raise ValueError(f"{text[:40]} is not a number there")
    at = {symbols[name]: enclose(tape(parse(value, {}))) for name, value in point.items()}
    ball = enclose(tape(expression), at)
    if not ball.is_finite():
        raise ValueError(f"{text[:40]} is not finite there")
    return decimal_ends(ball)


def entries_of(text: str) -> list[str]:
    """Scalar entries of a side: those of a tuple or a matrix, or the text itself."""
    text = text.strip()
    if len(text) > LONGEST or not text:
        return []
    if text[0] not in "([" or closing_place(text) != len(text) - 1:
        return [text]
    parts = split_parts(text[1:-1])
    if text[0] == "(" and len(parts) == 1:
        return [text]
    return [entry for part in parts for entry in entries_of(part)]


def closing_place(text: str) -> int:
    """Place of the bracket that closes the one at the beginning, -1 when there is none."""
    depth = 0
    for place, char in enumerate(text):
        depth += (char in "([") - (char in ")]")
        if depth == 0:
            return place
    return -1


def split_parts(text: str) -> list[str]:
    """Parts between the commas that stand in no bracket."""
    parts, depth, start = [], 0, 0
    for place, char in enumerate(text):
        depth += (char in "([") - (char in ")]")
        if char == "," and depth == 0:
            parts.append(text[start:place])
            start = place + 1
    return [part for part in (*parts, text[start:]) if part.strip()]


# -- numbers in words -------------------------------------------------------------------------


def ended(sentence: str) -> str:
    """The sentence with its full stop; cut digits end with an ellipsis already."""
    return sentence if sentence.endswith(("…", ".")) else sentence + "."


def ball_words(ends: tuple[str, str]) -> str:
    """``0.95885…`` for ends that agree so far, ``0.995`` for ends on both sides of it; both ends otherwise."""
    low, high = ends
    if low == high:
        return low.rstrip("0").rstrip(".") if "." in low else low
    if (rounded := common_rounding(low, high)) is not None:
        return rounded
    same = next((i for i, (a, b) in enumerate(zip(low, high, strict=False)) if a != b), min(len(low), len(high)))
    shared = low[:same]
    return f"{shared[:14]}…" if "." in shared and len(shared) > 6 else f"between {low} and {high}"


def common_rounding(low: str, high: str) -> str | None:
    """The number of at most eight digits between two ends that are nearer than that; None where there is none."""
    try:
        first, second = (Decimal(end) for end in (low, high))
        middle = Decimal(f"{(first + second) / 2:.8g}")
    except InvalidOperation:
        return None
    if not first <= middle <= second or second - first > abs(middle) * Decimal("1e-12"):
        return None
    plain = format(middle.normalize(), "f")
    return plain if len(plain) < 16 else format(middle.normalize(), "E")
