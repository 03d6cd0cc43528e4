"""From a card to a model: F, H, G and reset in the user's names, derived; and a card read from a file.

A file with a table [card] and no F asks for the model of the card. Fields that do not matter for the model, and those
that follow from the others, may be left out; where two cards remain, the field in which they differ is asked for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from fractions import Fraction
from functools import cache
from typing import Any

from navsym.conventions.card import CHOICES, NORTH, WHOLE, Card
from navsym.conventions.measuring import CORRECTED, RESET_MARK, full_column
from navsym.conventions.mechanisation import CONSTANTS, Mechanisation
from navsym.conventions.reading import HIDDEN, Problem, matrix_of, print_matrix, read_known, read_problem
from navsym.conventions.search import Block, list_blocks, list_cards, list_sizes, plain_card, sign_of
from navsym.conventions.symbols import Formulas
from navsym.core.errors import DomainError, EmptyError
from navsym.language.names import join_place, quote
from navsym.language.schema import as_table

#: How the names of quantities that the file lacks begin -> what to give.
UNNAMED = {
    **{"ca": "attitude_correction", "cv": "velocity_correction", "cp": "position_correction", "wander": "wander_angle"},
    **{"c": "rotation", "f": "specific_force", "w": "angular_rate", "v": "velocity", "r0": "position"},
    **{"r1": "position", "r2": "position", "g": "gravity", "R": "radii", "slope": "radius_slope", "rate": "earth_rate"},
    "pull": "gravitational_parameter",
    "m": "known_vector",
}


def fill_model(document: Mapping[str, Any], where: str = "") -> dict[str, Any]:
    """A document with F: its card is what is known, or the one from which F, H, G and the reset are derived here.

    Raises DomainError for a card that contradicts itself, EmptyError for one that says too little.
    """
    place = join_place(where, "card")
    words = read_known(as_table(document["card"], place), place)
    rest = {name: value for name, value in document.items() if name != "card"}
    model = as_table(document.get("model", {}), join_place(where, "model"))
    spot = join_place(where, "known")
    known = as_table(document.get("known", {}), spot)
    for name, word in known.items():
        if words.get(name, word) != word:
            message = f"expected {quote(words[name])}, as the card says; got {quote(word)}; correct one of them"
            raise DomainError(message, where=join_place(spot, name))
    if "F" in model:
        return {**rest, "known": {**known, **words}}
    if words.get("azimuth") == NORTH and "wander_angle" in as_table(rest.get("quantities", {}), where):
        rest["known"] = {**known, "azimuth": NORTH}  # the angle is for conversions
    problem = read_problem({**rest, "model": empty_model(rest, model)}, where)
    card = choose_card(problem, words, place)
    formulas = Formulas(problem, plain_card(card))
    flow = Mechanisation(plain_card(card), formulas.world)
    matrices = {name: written for name in ("F", "H", "G", "reset") if (written := print_matrix(getattr(problem, name)))}
    write_blocks(problem, flow, formulas, lambda block: sign_of(card, block), matrices)
    require_names("card", *matrices.values())
    return {**rest, "card": card.words(), "model": {**model, "states": list(problem.states), **matrices}}


def empty_model(document: Mapping[str, Any], model: Mapping[str, Any]) -> dict[str, Any]:
    """The model with zeros where the card will write."""

    def items(table: str) -> list[Any]:
        places = document.get(table)
        values = places.values() if isinstance(places, Mapping) else ()
        return [k for v in values for k in (v if isinstance(v, list) else [v])]

    def count(table: str) -> int:
        return max([k for k in items(table) if isinstance(k, int) and k < 1000], default=0)

    states, given = model.get("states", items("roles")), document.get("quantities")
    n = len(states) if isinstance(states, list) else 0
    shapes = {"F": (n, n), "H": (count("measured"), n), "G": (n, count("noises"))}
    if isinstance(given, Mapping) and any(f"{role}_correction" in given for role in CORRECTED):
        shapes["reset"] = (n, n)
    zeros = {name: [["0"] * width for _ in range(height)] for name, (height, width) in shapes.items() if height * width}
    for k, row in enumerate(zeros.get("reset", [])):
        row[k] = "1"
    return {**model, "states": states, **zeros}


def require_known(problem: Problem, where: str) -> None:
    """Refuse known words that no card has together."""
    if next(list_cards(problem, problem.known), None) is None:
        choose_card(problem, problem.known, where)


def choose_card(problem: Problem, words: Mapping[str, str], where: str) -> Card:
    """The one card that says these words, or says no others."""
    if WHOLE in list_sizes(problem):
        words = {"attitude_size": WHOLE, **words}
    right = list(list_cards(problem, words))
    whole = right if len(right) == 1 else [card for card in right if card.words() == words]
    if len(whole) == 1:
        return whole[0]
    for name in (f.name for f in fields(Card) if f.name in CHOICES):
        near = right or list(list_cards(problem, {k: w for k, w in words.items() if k != name}))
        found = list(dict.fromkeys(str(getattr(card, name)) for card in near))
        if right and len(found) > 1 and name not in words:
            known = ", ".join(word for word in found if word != "None")
            message = f"expected {name}, one of {known}; got no such key; add it to the card"
            raise EmptyError(message, where=join_place(where, name))
        if not right and near and name in words:
            wanted = f"no {name}" if found == ["None"] else f"{name} {' or '.join(found)}"
            message = f"expected {wanted} beside the other words; got {quote(words[name])}; correct it"
            raise DomainError(message, where=join_place(where, name))
    raise DomainError("expected words of one card; got words that exclude each other; correct them", where=where)


def write_blocks(
    problem: Problem,
    flow: Mechanisation,
    formulas: Formulas,
    sign: Callable[[Block], Fraction],
    matrices: Mapping[str, list[list[str]]],
) -> None:
    """Write the blocks of a mechanisation into those of F, H, G and the reset that are given."""
    columns = cache(lambda column: [full_column(flow, column, k) for k in range(3)])
    for row, column in list_blocks(problem):
        if (name := matrix_of((row, column))) not in matrices or {row, column} <= {*CONSTANTS}:
            continue
        matrix, factor = matrices[name], sign((row, column))
        for i, place in enumerate(problem.places(row)):
            for j, other in enumerate(problem.places(column)):
                text = formulas.write(columns(column)[j][row][i], factor)
                unit = row == RESET_MARK + column and i == j
                matrix[place][other] = ("1" if text == "0" else f"1 + {text}") if unit else text


def list_missing(M: Sequence[Sequence[str]]) -> dict[str, str]:
    """The quantities without a name in the entries of a matrix, each with its word."""
    names = sorted({*re.findall(HIDDEN + r"(\w+)", " ".join(cell for row in M for cell in row))})
    return {name: next((word for key, word in UNNAMED.items() if name.startswith(key)), name) for name in names}


def require_names(where: str, *matrices: Sequence[Sequence[str]]) -> None:
    """Refuse a model that needs a quantity that the file does not name."""
    if missing := sorted({word for M in matrices for word in list_missing(M).values()}):
        message = f"expected quantities with {' and '.join(missing)}; got none; add them to [quantities]"
        raise EmptyError(message, where=f"{where}: quantities")
