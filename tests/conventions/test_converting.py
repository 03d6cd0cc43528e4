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
from navsym.conventions.frames import Passage, carry_motion, change_frame, restore_terms
from navsym.conventions.mechanisation import ROLES, Mechanisation, World
from navsym.conventions.points import BITS, draw_point, evaluate
from navsym.conventions.reading import read_problem
from navsym.conventions.search import key_of_points
from navsym.core.balls import precision
from navsym.core.errors import DomainError
from navsym.core.exact import to_fmpq
from navsym.language.expression import read_tree
from tests.conventions import models
from tests.conventions.reference import AXES, STEP, Flight, exp, push, skew, stack, vec
from tests.conventions.test_generator import EXACT, ball, full_problem, random_card, world_of
from tests.conventions.test_measuring import number, sola


def random_pair(pick: random.Random, moves: bool = False) -> tuple[Card, Card]:
    """A card, and one with other definitions of the errors and other axes, or in another frame where that can be."""
    while True:
        card = random_card(pick, EXACT)
        target = card
        if moves:
            frame = pick.choice([f for f in CHOICES["frame"] if f != card.frame])
            radii = {"sphere": 1, "ellipsoid": 2}.get(card.earth, 1)
            try:
                words = {name: pick.choice(CHOICES[name]) for name in ("axes", "azimuth", "angle")} | {"frame": frame}
                card = restore_terms(card, frame, radii)
                target = change_frame(card, words, radii, True, card.earth_rate != "dropped", False)
            except DomainError:
                continue
        curved = target.frame == "local-level" and target.earth != "none"
        names = [n for n in CONVERTED if getattr(target, n) is not None and (curved or n != "position_error")]
        free = [n for n in names if n not in ("frame", "azimuth")]
        return card, replace(target, **{name: pick.choice(CHOICES[name]) for name in free})


ANGLE, LONGITUDE = mp.mpf("0.9"), mp.mpf("0.4")


def carry(flight: Flight, target: Card, x: dict[str, Any]) -> dict[str, Any]:
    """A state in the axes or the frame of another card, typed from the definitions of the frames."""
    card, C, v, r = flight.card, x["C"], x["velocity"], x["position"]
    turned = flight.axes(x)
    if card.frame == target.frame:
        A = AXES[target.axes] * AXES[card.axes].T
        flat = card.frame != "local-level" or card.earth == "none"
        return {**x, "C": A * C, "velocity": A * v, "position": A * r if flat else r}
    rate = 0 if "kept" not in (card.earth_rate, target.earth_rate) else flight.rate
    W, turn = vec(0, 0, rate), exp(vec(0, 0, ANGLE))
    if card.frame == "local-level":
        L, lon, h = r
        M = level(L, lon) * turned.T
        C, v, r = M * C, M * v, place(flight, L, lon, h)
    elif card.frame == "inertial":
        C, r = turn.T * C, turn.T * r
        v = turn.T * v - skew(W) * r
    if target.frame == "inertial":
        C, v, r = turn * C, turn * (v + skew(W) * r), turn * r
    if target.frame == "local-level":
        r = locate(flight, r)
        M = Flight(target, 1).axes(x) * level(r[0], r[1]).T
        C, v = M * C, M * v
    return {**x, "C": C, "velocity": v, "position": r}


def level(L: Any, lon: Any) -> Any:
    """Rotation from north, east, down to the Earth."""
    s, c, sl, cl = mp.sin(L), mp.cos(L), mp.sin(lon), mp.cos(lon)
    return mp.matrix([[-s * cl, -sl, -c * cl], [-s * sl, cl, -c * sl], [c, 0, -s]])


def place(flight: Flight, L: Any, lon: Any, h: Any) -> Any:
    """The position from the centre of the Earth."""
    E, s, c = flight.radii(L)[1], mp.sin(L), mp.cos(L)
    return vec((E + h) * c * mp.cos(lon), (E + h) * c * mp.sin(lon), ((1 - flight.e2) * E + h) * s)


def locate(flight: Flight, r: Any) -> Any:
    """Latitude, longitude and height of a position near that of the flight, by Newton's steps."""
    L, lon, h = flight.L, LONGITUDE, flight.h
    for _ in range(7):
        N, E = flight.radii(L)
        north, east, down = level(L, lon).T * (r - place(flight, L, lon, h))
        L, lon, h = L + north / (N + h), lon + east / ((E + h) * mp.cos(L)), h - down
    return vec(L, lon, h)


def matrix_of(card: Card, target: Card, world: World) -> list[list[Any]]:
    """T in a world of balls."""
    return matrix_of_way(ways(Mechanisation(card, world), target)[0])


def matrix_of_way(way: Passage) -> list[list[Any]]:
    """T of a way."""
    signs = (way.source.card.signs(), way.target.card.signs())
    columns = [transform(way, ROLES[j // 3], j % 3) for j in range(15)]
    factors = [[to_fmpq(signs[1][ROLES[i // 3]] / signs[0][ROLES[j // 3]]) for j in range(15)] for i in range(15)]
    return [[arb(factors[i][j] * columns[j][ROLES[i // 3]][i % 3].error) for j in range(15)] for i in range(15)]


@pytest.mark.parametrize("frame", [None, *CHOICES["frame"]])
def test_the_transformation_is_the_change_of_coordinates_of_the_errors(frame):
    pick, done = random.Random(12), 0
    while done < 3:
        card, target = random_pair(pick, frame is not None)
        if frame not in (None, target.frame):
            continue
        done += 1
        flight, other = Flight(card, done), Flight(target, done)
        if card.frame != target.frame == "local-level":
            flight.e2, flight.alpha = other.e2, other.alpha
            flight.r = place(flight, flight.L, LONGITUDE, flight.h)
            if card.frame == "inertial":
                flight.r = exp(vec(0, 0, ANGLE)) * flight.r
        sides = {"meridian": LONGITUDE, "angle": ANGLE}
        circles = {name: (ball(mp.sin(angle)), ball(mp.cos(angle))) for name, angle in sides.items()}
        with precision(BITS):
            T = matrix_of(card, target, replace(world_of(flight), **circles))
        x, J = flight.truth(), mp.matrix(15, 15)
        for j in range(15):
            ends = [
                stack(other.error(carry(flight, target, x), carry(flight, target, push(x, j, side * STEP))))
                for side in (1, -1)
            ]
            J[:, j] = (ends[0] - ends[1]) / (2 * STEP)
        expected = J * flight.sensitivity(x) ** -1
        worst = max(abs(number(T[i][j]) - expected[i, j]) for i in range(15) for j in range(15))
        assert worst < mp.mpf(10) ** -9, (card, target)


@pytest.mark.long
@pytest.mark.parametrize("moves", [False, True])
def test_two_hundred_random_pairs_lead_back(moves):
    pick, problem = random.Random(200), full_problem()
    for seed in range(200 if not moves else 100):
        card, target = random_pair(pick, moves)
        with precision(BITS):
            world = draw_point(problem, key_of_points(card), seed + 1).world
            world = replace(world, RE=world.RN if "sphere" in (card.earth, target.earth) else world.RE)
            flow = Mechanisation(card, world)
            there, back = (matrix_of_way(way) for way in ways(flow, target))
            for i in range(15):
                for j in range(15):
                    total = sum((arb(back[i][k] * there[k][j]) for k in range(15)), arb(0))
                    assert (total - int(i == j)).contains(0) and total.rad() < 1e-30, (card, target)


def ways(flow: Mechanisation, target: Card) -> list[Passage]:
    """The way to a card and the way back."""
    other = carry_motion(flow, target)
    return [Passage(flow, other), Passage(other, flow)]


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


QUANTITIES = {
    "specific_force": ["u1", "u2", "u3"], "specific_force_body": models.F_B, "rotation": models.C, "latitude": "L",
    "velocity": ["v1", "v2", "v3"], "height": "h", "radii": ["R"], "longitude": "lon", "earth_angle": "th",
    "earth_rate": "W", "gravity": ["0", "0", "g"], "transport_rate": ["t1", "t2", "t3"],
}  # fmt: skip


@pytest.mark.parametrize(
    "changes", [{"frame": "earth"}, {"frame": "inertial"}, {"axes": "ENU"}, {"error": "truth - estimate"}]
)
def test_quantities_of_the_target_are_those_of_the_motion_there(changes):
    card = Card("local-level", "NED", "north", earth="sphere", earth_rate="kept", transport_rate="kept")
    target, flight = replace(card, **changes), Flight(card, 4)
    values = {"L": flight.L, "h": flight.h, "lon": mp.mpf(0.4), "th": ANGLE, "W": flight.rate, "R": flight.a, "g": 3}
    vectors = {"specific_force": flight.C * flight.f, "specific_force_body": flight.f, "velocity": flight.v}
    values |= {n: x for name, v in vectors.items() for n, x in zip(QUANTITIES[name], v, strict=True)}
    values |= {n: flight.C[i, j] for i, row in enumerate(models.C) for j, n in enumerate(row)}
    problem = read_problem(models.document("pva", {}, QUANTITIES))
    converter = Converter(problem, card, target)
    flow = carry_motion(Mechanisation(card, converter.formulas.world), target)
    found, moved = converter.quantities(flow), carry(flight, target, flight.truth())
    expected = {"rotation": moved["C"], "velocity": moved["velocity"], "specific_force": moved["C"] * flight.f}
    if target.frame == "earth":
        expected["gravity"] = moved["C"] * flight.C.T * vec(0, 0, 3)
    with precision(BITS):
        balls = {name: ball(mp.mpf(x)) for name, x in values.items()}
        for name, wanted in expected.items():
            texts = [x for row in found[name] for x in (row if isinstance(row, list) else [row])]
            for text, number_of in zip(texts, wanted, strict=True):
                assert abs(number(evaluate(read_tree(text, None), balls)) - number_of) < 1e-30, (name, text)
    assert ("transport_rate" in found) == (target.frame == card.frame) and found["latitude"] == ["L"]


def test_a_wrong_conversion_is_not_granted():
    found = nav.conventions(models.sola_local())
    converter = Converter(found.problem, found.cards[0], found.cards[0])
    F = [list(row) for row in models.sola_local()["model"]["F"]]
    spoiled = copy.deepcopy(F)
    spoiled[3][7] = f"-({spoiled[3][7]})"
    assert converter.is_proved([(F, F)]) and not converter.is_proved([(F, spoiled)])


@pytest.mark.parametrize(
    "changes",
    [
        {"frame": "local-level"},
        {"frame": "moon"},
        {"angle": "phi"},
        {"error": "both"},
        {"earth": "sphere"},
        {"position_error": "geodetic"},
    ],
)
def test_what_is_no_definition_of_an_error_is_refused(changes):
    with pytest.raises(DomainError, match="expected"):
        nav.conventions(models.sola_local()).convert(**changes)
