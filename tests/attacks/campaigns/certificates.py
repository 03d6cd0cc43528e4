"""Certificates altered at random: the checker refuses what has become false.

An identity is altered in one token of one side, and is false when the sides differ to thirty digits at
a random point. An optimum is altered in its numbers (never in its problem), and is false when its
bounds no longer hold the true optimum. What is accepted although false is a hole.
"""

from __future__ import annotations

import copy
import random
from collections import Counter
from fractions import Fraction
from typing import Any

import sympy as sp

from navsym.checker import Refused, check
from navsym.core.errors import NavsymError
from navsym.guaranteed.problem import from_regressors
from navsym.guaranteed.solver import solve
from navsym.language.expression import parse, symbol, to_text
from navsym.prove.certificates import identity_certificate
from tests.attacks.campaigns.batches import Batch, Result, deal, result
from tests.attacks.campaigns.edits import list_mutants

BATCH = 100
BOUNDS = ("lower", "upper")
PROOF_FIELDS = ("dual", "support", "pieces", "cells", "bits", *BOUNDS)


def make_batches(honest: list[dict[str, Any]], inputs: int, seed: int = 0) -> list[Batch]:
    """``inputs`` alterations spread over the honest certificates."""
    return deal(honest, inputs, BATCH, seed)


def honest_certificates() -> list[dict[str, Any]]:
    """Certificates of our own making: three identities and three optima."""
    a, b = sp.symbols("a b", real=True)
    identities = [
        identity_certificate(sp.sin(a + b), sp.sin(a) * sp.cos(b) + sp.cos(a) * sp.sin(b)),
        identity_certificate(sp.cos(3 * a), 4 * sp.cos(a) ** 3 - 3 * sp.cos(a)),
        identity_certificate((a**3 - b**3) / (a - b), a**2 + a * b + b**2),
    ]
    s = sp.Symbol("t", real=True)
    bases = ([1, s], [1, s, s**2], [1, sp.sin(s)])
    optima = []
    for basis in bases:
        target = [0] * (len(basis) - 1) + [1]
        optima.append(dict(solve(from_regressors([basis], target, s, (0, 1)), digits=12).certificate))
    return [dict(item) for item in identities if item is not None] + optima


def judge(task: tuple[dict[str, Any], int, int]) -> Result:
    """Counts: refused, accepted and still true; wrong: accepted and false, or an error of another kind."""
    honest, size, seed = task
    source = random.Random(seed)
    counts: Counter[str] = Counter()
    wrong: list[Any] = []
    choices = alter_identity(honest) if honest["kind"] == "identity" else None
    for _ in range(size):
        item, false = source.choice(choices) if choices else alter_optimum(honest, source)
        outcome = answer(item)
        if outcome == "accepted":
            outcome = "accepted, false" if false else "accepted, still true"
        counts[outcome] += 1
        if outcome not in ("refused", "accepted, still true"):
            wrong.append({"certificate": item, "why": outcome})
    return result(counts, wrong)


def answer(item: dict[str, Any]) -> str:
    """The checker's answer to a certificate: ``accepted``, ``refused``, or ``crashed`` and the name of the error."""
    try:
        check(item)
    except Refused:
        return "refused"
    except Exception as error:
        return f"crashed: {type(error).__name__}"
    return "accepted"


def alter_identity(honest: dict[str, Any]) -> list[tuple[dict[str, Any], bool]]:
    """Every one-token mutant of either side, with whether numbers show that it is false."""
    known = {name: symbol(name) for name in honest["symbols"]}
    sides = {side: parse(honest[side], known) for side in ("left", "right")}
    found = []
    for side, other in (("left", "right"), ("right", "left")):
        for mutant in list_mutants(sides[side]):
            try:
                found.append(({**honest, side: to_text(mutant)}, is_unequal(mutant - sides[other])))
            except NavsymError:
                continue  # not in the language of files
    return found


def is_unequal(difference: sp.Expr) -> bool:
    """True when the difference is a number above 1e-15 at one of three rational points, evaluated to 30 digits."""
    symbols = sorted(difference.free_symbols, key=str)
    for k in range(1, 4):
        point = {s: sp.Rational(3 + 7 * k + 5 * i, 11 + 2 * i) for i, s in enumerate(symbols)}
        value = difference.subs(point).evalf(30)
        if value.is_number and abs(value) > sp.Float(10) ** -15:
            return True
    return False


def alter_optimum(honest: dict[str, Any], source: random.Random) -> tuple[dict[str, Any], bool]:
    """One number of the proof changed; false when the bounds have lost the optimum."""
    item = copy.deepcopy(honest)
    places = [place for field in PROOF_FIELDS if field in item for place in find_leaves(item[field], (field,))]
    place = source.choice(places)
    put(item, place, change(get(item, place), source))
    return item, has_lost_optimum(item, honest)


def has_lost_optimum(item: dict[str, Any], honest: dict[str, Any]) -> bool:
    """True when the bounds are no numbers or cannot hold the optimum that the honest ones enclose."""
    bounds = [decimal(source[name]) for source in (item, honest) for name in BOUNDS]
    if any(bound is None for bound in bounds):
        return True
    low, high, true_low, true_high = (bound for bound in bounds if bound is not None)
    return low > true_high or high < true_low


def find_leaves(value: Any, place: tuple[Any, ...]) -> list[tuple[Any, ...]]:
    """Paths, keys and places from the outside in, to all parts of nested data that are neither dict nor list."""
    if isinstance(value, dict):
        return [leaf for key, part in value.items() for leaf in find_leaves(part, (*place, key))]
    if isinstance(value, list):
        return [leaf for k, part in enumerate(value) for leaf in find_leaves(part, (*place, k))]
    return [place]


def get(item: Any, place: tuple[Any, ...]) -> Any:
    """The part of nested data at the end of a path of keys and places."""
    for key in place:
        item = item[key]
    return item


def put(item: Any, place: tuple[Any, ...], value: Any) -> None:
    """Replace, in place, the part of nested data at the end of a path, which has at least one step."""
    get(item, place[:-1])[place[-1]] = value


def change(value: Any, source: random.Random) -> Any:
    """Another number of the same type, near or far, or something that is no number at all."""
    if source.random() < 0.1:
        return source.choice(["", "nan", None, True, -1, [], {}, "1e9", "9" * 40, "1/0"])
    if isinstance(value, bool) or not isinstance(value, (int, str)):
        return source.choice([0, "1", None])
    if isinstance(value, int):
        return source.choice([-value, value + 1, value - 1, 0, 2 * value])
    number = decimal(value)
    if number is None:
        return source.choice(["from", "to", "no", "between"])
    return text_of(number + source.choice([1, -1]) * Fraction(1, 10 ** source.randint(0, 12)) * source.randint(1, 9))


def decimal(text: Any) -> Fraction | None:
    """The exact number that a text is, as a decimal or a fraction; None for other text and for what is no text."""
    try:
        return Fraction(text) if isinstance(text, str) else None
    except (ValueError, ZeroDivisionError):
        return None


def text_of(value: Fraction) -> str:
    """A decimal of forty places."""
    scaled = round(value * 10**40)
    digits = str(abs(scaled)).rjust(41, "0")
    return ("-" if scaled < 0 else "") + f"{digits[:-40]}.{digits[-40:]}"
