"""The generator against an independent linearisation of the nonlinear mechanisation, and against itself in symbols."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any

import mpmath as mp
import pytest
from flint import arb

from navsym.conventions.card import CHOICES, NORTH, WANDER, Card, list_structures
from navsym.conventions.mechanisation import ROLES, Mechanisation, World
from navsym.conventions.points import BITS, draw_point, evaluate
from navsym.conventions.reading import read_problem
from navsym.conventions.search import key_of_points, narrow_card
from navsym.conventions.symbols import CIRCLES, Formulas, gradient_names, list_rules
from navsym.core.balls import precision
from navsym.language.expression import read_tree
from tests.conventions import models, reference

STRUCTURES = [
    card
    for radii, azimuth in ((1, NORTH), (2, NORTH), (1, WANDER), (2, WANDER))
    for card in list_structures(frozenset(ROLES), radii, CHOICES["frame"], azimuth=azimuth)
]
#: Cards that drop no part of a derivative: what they say is the exact linearisation of their mechanisation.
EXACT = [
    card
    for card in STRUCTURES
    if card.gravity_gradient != "radial"
    and card.height_variation != "dropped"
    and card.radius_variation in (None, "kept")
]


def random_card(pick: random.Random, cards: list[Card]) -> Card:
    """A card with random signs."""
    names = ("error", "rotation_sign", "attitude_size", "bias_sign")
    return replace(pick.choice(cards), **{name: pick.choice(CHOICES[name]) for name in names})


def ball(x: Any) -> arb:
    """A number of mpmath as a ball."""
    return arb(mp.nstr(x, 50))


def world_of(flight: reference.Flight) -> World:
    """The quantities of a flight."""
    card = flight.card
    RN, RE = (ball(x) for x in flight.radii(flight.L))
    sine, cosine = mp.sin(flight.L), mp.cos(flight.L)
    slope = 3 * flight.radii(flight.L)[0] * flight.e2 * sine * cosine / (1 - flight.e2 * sine**2)
    level, distance = card.frame == "local-level", mp.norm(flight.r)
    earth = [flight.rate * cosine, -flight.rate * sine] if level else [mp.mpf(0), mp.mpf(0), flight.rate]
    pull = flight.mu / distance**3
    cartesian = [-pull * x for x in flight.r] if card.gravity_gradient == "central" else list(flight.g)
    gravity = [flight.g[0]] if level else cartesian
    rows = [[ball(flight.C[i, j]) for j in range(3)] for i in range(3)]
    vectors = [[ball(x) for x in v] for v in (flight.f, flight.w, flight.v, flight.r, earth)]
    scalars = [ball(sine), ball(cosine), ball(flight.h), RN, RE, ball(slope)]
    names = gradient_names(RN, RE, ball(flight.h), RN, (RN * RE).sqrt())
    wander = ball(mp.sin(flight.alpha)), ball(mp.cos(flight.alpha))
    gravity = [ball(x) for x in gravity]
    return World(rows, *vectors, *scalars, gravity, ball(pull), ball(distance), names, wander=wander)


def worst_difference(flight: reference.Flight) -> Any:
    """The largest difference of an entry of F between generator and reference."""
    expected, signs, worst = reference.error_dynamics(flight), flight.card.signs(), mp.mpf(0)
    with precision(BITS):
        world = world_of(flight)
        for j in range(15):
            column = Mechanisation(flight.card, world).column(ROLES[j // 3], j % 3)
            for i in range(15):
                value = column[ROLES[i // 3]][i % 3]
                number = mp.mpf(value) if isinstance(value, int) else mp.mpf(value.str(40, radius=False))
                sign = signs[ROLES[i // 3]] / signs[ROLES[j // 3]]
                worst = max(worst, abs(sign * number - expected[i, j]))
    return worst


@pytest.mark.parametrize("frame", [*CHOICES["frame"], WANDER])
def test_error_dynamics_are_the_linearisation_along_a_flight(frame):
    pick = random.Random(frame)
    card = random_card(pick, [card for card in EXACT if frame in (card.frame, card.azimuth)])
    assert worst_difference(reference.Flight(card, 1)) < 1e-9, card


@pytest.mark.slow
def test_error_dynamics_are_the_linearisation_along_a_hundred_flights():
    pick = random.Random(7)
    for seed in range(100):
        card = random_card(pick, EXACT)
        assert worst_difference(reference.Flight(card, seed)) < 1e-9, card


def test_a_wrong_gyro_bias_would_be_seen_by_the_reference():
    flight = reference.Flight(replace(EXACT[0], bias_sign="truth - estimate"), 3)
    F = reference.error_dynamics(flight)
    flight.card = replace(flight.card, bias_sign="estimate - truth")
    G = reference.error_dynamics(flight)
    assert max(abs(F[i, j] + G[i, j]) for i in range(6, 9) for j in range(9, 12)) < 1e-9
    assert max(abs(F[i, j]) for i in range(6, 9) for j in range(9, 12)) > 0.1


def full_problem() -> Any:
    """A problem in which every quantity has a name."""
    quantities = {
        **models.NED, "specific_force_body": models.F_B, "angular_rate": models.W_B, "position": ["r1", "r2", "r3"],
        "wander_angle": "alpha",
    }  # fmt: skip
    quantities.pop("specific_force")
    return read_problem(models.document("pvagb", {}, quantities, **models.declared(quantities)))


def test_columns_do_not_depend_on_the_fields_that_the_search_leaves_out():
    problem, pick = full_problem(), random.Random(3)
    with precision(BITS):
        for card in pick.sample([card for card in STRUCTURES if card.earth != "sphere"], 12):
            role = pick.choice(ROLES[1:])
            world = draw_point(problem, key_of_points(card), 1).world
            columns = [Mechanisation(c, world).column(role, 1) for c in (card, narrow_card(card, role))]
            for row in ROLES:
                for x, y in zip(columns[0][row], columns[1][row], strict=True):
                    assert arb(x).overlaps(arb(y)), (card, role, row)


def test_formulas_have_the_values_of_the_generator():
    problem, pick = full_problem(), random.Random(4)
    cards = [card for card in STRUCTURES if card.earth != "sphere" and card.radius_variation != "kept"]
    for card in pick.sample([c for c in cards if c.gravity_gradient != "central"], 5):
        compare_formulas(problem, card, pick.choice(("velocity", "attitude", "gyro_bias")))


def test_a_quotient_is_written_as_it_is_read():
    formulas = Formulas(full_problem(), EXACT[0])
    value = formulas.world.v[0] / (formulas.world.cos * formulas.world.RN)
    assert formulas.read(formulas.write(value)) == value


def compare_formulas(problem: Any, card: Card, column: str) -> None:
    with precision(BITS):
        point = draw_point(problem, key_of_points(card), 2)
        numbers = [Mechanisation(card, point.world).column(column, k) for k in range(3)]
        formulas = Formulas(problem, card)
        for row in ("velocity", "attitude"):
            for i, texts in enumerate(formulas.block(row, column)):
                for j, text in enumerate(texts):
                    difference = evaluate(read_tree(text, None), point.values) - numbers[j][row][i]
                    assert difference.contains(0), (card, row, column, text)


def test_products_of_entries_of_a_rotation_have_one_normal_form():
    assert (
        len(list_rules()) - len(CIRCLES) == 20
    )  # the 45 products of entries span 25 dimensions beside entries and constants
