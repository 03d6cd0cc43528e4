"""Conversions between cards, against the change of coordinates of the second mechanisation, and there and back."""

from __future__ import annotations

import copy
import random
from dataclasses import replace
from typing import Any

import mpmath as mp
import pytest
from flint import arb

import navsym as nav
from navsym.conventions.card import CHOICES, Card
from navsym.conventions.converting import CONVERTED, Converter, transform
from navsym.conventions.mechanisation import ROLES, Mechanisation, World
from navsym.conventions.points import BITS, draw_point
from navsym.conventions.reading import read_problem
from navsym.conventions.search import key_of_points
from navsym.core.balls import precision
from navsym.core.errors import DomainError
from tests.conventions import models
from tests.conventions.reference import Flight
from tests.conventions.test_generator import EXACT, full_problem, random_card, world_of
from tests.conventions.test_measuring import number, sola


def random_pair(pick: random.Random) -> tuple[Card, Card]:
    """A card, and one with other definitions of the errors."""
    card = random_card(pick, EXACT)
    curved = card.frame == "local-level" and card.earth != "none"
    names = [n for n in CONVERTED if getattr(card, n) is not None and (curved or n != "position_error")]
    return card, replace(card, **{name: pick.choice(CHOICES[name]) for name in names})


def matrix_of(card: Card, target: Card, world: World) -> list[list[Any]]:
    """T in a world of balls."""
    signs, flows = (card.signs(), target.signs()), [Mechanisation(c, world) for c in (card, target)]
    columns = [transform(*flows, ROLES[j // 3], j % 3) for j in range(15)]
    return [
        [signs[1][ROLES[i // 3]] * signs[0][ROLES[j // 3]] * columns[j][ROLES[i // 3]][i % 3].error for j in range(15)]
        for i in range(15)
    ]


def test_the_transformation_is_the_change_of_coordinates_of_the_errors():
    pick = random.Random(12)
    for seed in range(4):
        card, target = random_pair(pick)
        flight, other = Flight(card, seed), Flight(target, seed)
        with precision(BITS):
            T = matrix_of(card, target, world_of(flight))
        x = flight.truth()
        expected = other.sensitivity(x) * flight.sensitivity(x) ** -1
        worst = max(abs(number(T[i][j]) - expected[i, j]) for i in range(15) for j in range(15))
        assert worst < mp.mpf(10) ** -9, (card, target)


@pytest.mark.long
def test_two_hundred_random_pairs_lead_back():
    pick, problem = random.Random(200), full_problem()
    for seed in range(200):
        card, target = random_pair(pick)
        with precision(BITS):
            world = draw_point(problem, key_of_points(card), seed + 1).world
            there, back = matrix_of(card, target, world), matrix_of(target, card, world)
            for i in range(15):
                for j in range(15):
                    total = sum((arb(back[i][k] * there[k][j]) for k in range(15)), arb(0))
                    assert (total - int(i == j)).contains(0) and total.rad() < 1e-30, (card, target)


@pytest.mark.long
def test_a_model_is_converted_with_its_measurements_and_noise_and_the_checker_grants_it():
    found = nav.conventions(sola())
    conversion = found.convert(attitude_error="frame", error="estimate - truth")
    assert conversion.proved and conversion.T[6][6:9] == ("c11", "c12", "c13")
    assert conversion.inverse[6][6:9] == ("c11", "c21", "c31")
    assert conversion.document()["to"]["attitude_error"] == "frame"


@pytest.mark.long
def test_from_psi_to_phi_and_back_is_the_same_model():
    document = models.psi_level()
    found = nav.conventions(document)
    conversion = found.convert(angle="phi")
    again = copy.deepcopy(document)
    again["model"]["F"] = [list(row) for row in conversion.F]
    answer, error = nav.conventions(again), found.cards[0].error
    card = next(c for c in answer.cards if c.angle == "phi" and c.error == error)
    back = answer.convert(card, angle="psi")
    assert conversion.proved and back.proved
    converter = Converter(read_problem(document), card, found.cards[0])
    rows = [list(row) for row in back.F]
    assert converter.is_proved([(rows, document["model"]["F"])])


def test_a_wrong_conversion_is_not_granted():
    found = nav.conventions(models.sola_local())
    converter = Converter(found.problem, found.cards[0], found.cards[0])
    F = [list(row) for row in models.sola_local()["model"]["F"]]
    spoiled = copy.deepcopy(F)
    spoiled[3][7] = f"-({spoiled[3][7]})"
    assert converter.is_proved([(F, F)]) and not converter.is_proved([(F, spoiled)])


@pytest.mark.parametrize(
    "changes",
    [{"frame": "earth"}, {"angle": "phi"}, {"error": "both"}, {"earth": "sphere"}, {"position_error": "geodetic"}],
)
def test_what_is_no_definition_of_an_error_is_refused(changes):
    with pytest.raises(DomainError, match="expected"):
        nav.conventions(models.sola_local()).convert(**changes)
