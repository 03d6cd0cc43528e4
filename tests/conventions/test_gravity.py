"""Gravity along the normal of the Earth, and cards of files, beside a second mechanisation."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import mpmath as mp
import pytest
import sympy as sp

import navsym as nav
from navsym.conventions.generating import fill_model
from navsym.conventions.measuring import full_column
from navsym.conventions.mechanisation import ROLES, Mechanisation
from navsym.conventions.points import BITS, draw_point, evaluate
from navsym.conventions.search import key_of_points, narrow_card
from navsym.core.balls import precision
from navsym.language.expression import read_tree
from tests.conventions import reference
from tests.conventions.test_generator import STRUCTURES, ball, full_problem

STATES = {role: [f"{role[:2]}{role[-1]}{k}" for k in (1, 2, 3)] for role in ROLES[:5]}
WORDS = {
    "error": "estimate - truth", "rotation_sign": "+", "bias_sign": "truth - estimate", "attitude_error": "frame",
    "vector_error": "difference", "position_error": "metres",
}  # fmt: skip
MOTION = {
    "specific_force_body": ["f1", "f2", "f3"], "angular_rate": ["w1", "w2", "w3"], "velocity": ["v1", "v2", "v3"],
    "rotation": [[f"c{i}{j}" for j in (1, 2, 3)] for i in (1, 2, 3)], "height": "h", "latitude": "L", "gravity": "g",
}  # fmt: skip
NAMES = ["longitude", "h", "L", "g", "W", "R", "RN", "RE", *(f"{n}{k}" for n in "fwvx" for k in (1, 2, 3))]
PARAMETERS = {
    **dict.fromkeys([*NAMES, *(x for row in MOTION["rotation"] for x in row)], "real"),
    **dict.fromkeys(("R", "RN", "RE"), "positive"), "L": ["-3/2", "3/2"],
}  # fmt: skip
NORMAL = {"frame": "earth", "gravity_gradient": "normal", "earth_rate": "kept"}
LEVEL = {
    "frame": "local-level", "axes": "NED", "angle": "phi", "earth": "sphere", "gravity_gradient": "none",
    "earth_rate": "kept", "transport_rate": "kept", "height_variation": "kept",
}  # fmt: skip


def document_of(words: dict[str, str], **quantities: Any) -> dict[str, Any]:
    """A file with a card."""
    given = {**MOTION, **quantities}
    return {"card": {**WORDS, **words}, "parameters": dict(PARAMETERS), "roles": STATES, "quantities": given}


class PlumbLine(reference.Flight):
    """A flight in whose gravity a plumb line hangs along the normal of an ellipsoid."""

    def __init__(self, card: Any, seed: int):
        super().__init__(card, seed)
        self.r = self.place(self.L, mp.mpf("0.4"), self.h)

    def place(self, L: Any, longitude: Any, h: Any) -> Any:
        E = self.radii(L)[1]
        across = (E + h) * mp.cos(L)
        return reference.vec(
            across * mp.cos(longitude), across * mp.sin(longitude), ((1 - self.e2) * E + h) * mp.sin(L)
        )

    def gravity(self, x: dict[str, Any]) -> Any:
        near = (self.L, mp.mpf("0.4"), self.h)
        L, longitude, h = mp.findroot(lambda *at: list(self.place(*at) - x["position"]), near, tol=mp.mpf(10) ** -100)
        north, east = self.radii(self.L)
        radius = {"R": north, "RN": north, "RE": east}[self.card.gravity_radius.split(" ")[0]] + self.h
        down = -reference.vec(mp.cos(L) * mp.cos(longitude), mp.cos(L) * mp.sin(longitude), mp.sin(L))
        value = self.g[0] * (1 - 2 * (h - self.h) / radius) * down
        spin = reference.skew(self.turning(self.L, x))
        return value - spin * spin * (x["position"] - self.r) if self.card.centrifugal == "kept" else value

    def values(self) -> dict[str, Any]:
        """The parameters by their names."""
        north, east = self.radii(self.L)
        numbers = {"L": self.L, "h": self.h, "longitude": mp.mpf("0.4"), "g": self.g[0], "W": self.rate, "R": self.a}
        vectors = {"f": self.f, "w": self.w, "v": self.v, "x": self.r}
        numbers |= {f"{name}{k + 1}": v[k] for name, v in vectors.items() for k in range(3)}
        numbers |= {f"c{i + 1}{j + 1}": self.C[i, j] for i in range(3) for j in range(3)}
        return {name: ball(x) for name, x in {**numbers, "RN": north, "RE": east}.items()}


@pytest.mark.parametrize(
    ("words", "quantities"),
    [
        (
            {**NORMAL, "frame": "inertial", "earth": "sphere", "gravity_radius": "R + h", "vector_error": "body"},
            {"radii": "R"},
        ),
        pytest.param(
            {**NORMAL, "earth": "ellipsoid", "gravity_radius": "RN + h", "vector_error": "rotated"},
            {"radii": ["RN", "RE"], "position": ["x1", "x2", "x3"]},
            marks=pytest.mark.long,
        ),
        pytest.param(
            {**NORMAL, "earth": "ellipsoid", "gravity_radius": "RE + h", "centrifugal": "kept"},
            {"radii": ["RN", "RE"]},
            marks=pytest.mark.long,
        ),
    ],
)
def test_gravity_of_one_number_along_the_normal_is_linearised_as_such(words, quantities):
    if words["frame"] == "inertial":
        words = {name: word for name, word in words.items() if name != "earth_rate"}
    else:
        words, quantities = {"centrifugal": "dropped", **words}, {**quantities, "earth_rate": "W"}
    found = nav.conventions(document_of(words, longitude="longitude", **quantities))
    alike = {"gravity_gradient", "gravity_radius"}  # over a sphere gravity along the normal is that of a centre
    assert found.complete and all(getattr(found.cards[0], name) == words[name] for name in words.keys() - alike)
    card = replace(found.cards[0], **{name: words[name] for name in alike})
    flight = PlumbLine(card, 5)
    expected, states = reference.error_dynamics(flight), [*found.problem.states]
    places = [states.index(name) for role in ROLES[:5] for name in STATES[role]]
    with precision(BITS):
        values = flight.values()
        for i, j in product(range(9), range(15)):
            value = evaluate(read_tree(found.model()["F"][places[i]][places[j]], None), values)
            assert abs(mp.mpf(value.str(40, radius=False)) - expected[i, j]) < 1e-9, (i, j)


@pytest.mark.long
def test_a_radial_gradient_beside_two_radii_says_by_which():
    words = {"frame": "earth", "earth_rate": "kept", "centrifugal": "dropped", "gravity_gradient": "radial"}
    place = {"earth_rate": "W", "position": ["x1", "x2", "x3"]}
    with pytest.raises(nav.NavsymError, match=r"gravity_radius, one of sqrt\(RN\*RE\) \+ h"):
        nav.conventions(document_of(words, radii=["RN", "RE"], **place))
    alone, two = document_of(words, radii="RE + h", **place), document_of(words, radii=["RN", "RE"], **place)
    two["model"], two["card"] = nav.conventions(alone).model(), {"frame": "earth"}
    assert {card.gravity_radius for card in nav.conventions(two).cards} == {"RE + h"}


def test_vectors_that_turn_with_the_attitude_bring_gravity_into_its_column():
    problem = full_problem()
    cards = [card for card in STRUCTURES if card.vector_error == "rotated" and card.frame != "local-level"]
    with precision(BITS):
        for card in dict.fromkeys(cards):
            world = draw_point(problem, key_of_points(card), 1).world
            columns = [
                full_column(Mechanisation(c, world), "attitude", 1) for c in (card, narrow_card(card, "attitude"))
            ]
            for x, y in zip(*(column["velocity"] for column in columns), strict=True):
                assert evaluate(read_tree("0", None), {}).overlaps(x - y), card


@pytest.mark.long
def test_entries_longer_than_a_formula_may_be_are_decided_too():
    words = {**WORDS, "frame": "inertial", "gravity_gradient": "radial", "vector_error": "body", "earth": "ellipsoid"}
    words["gravity_radius"] = "RN"
    quantities = {"radii": ["RN", "RE"], "position": ["x1", "x2", "x3"], "longitude": "longitude"}
    found = nav.conventions(document_of(words, **quantities))
    assert found.complete and all(getattr(found.cards[0], name) == word for name, word in words.items())
    assert max(len(entry) for row in found.model()["F"] for entry in row) > 10_000
    wrong = document_of(words, **quantities)
    wrong["model"] = {"states": list(found.problem.states), "F": [list(row) for row in found.model()["F"]]}
    row, column = found.problem.states.index(STATES["velocity"][0]), found.problem.states.index(STATES["position"][1])
    wrong["model"]["F"][row][column] = "g"
    assert not nav.conventions(wrong).cards


def test_a_measured_height_excludes_frames_without_one_and_no_more():
    document = document_of(LEVEL, radii="R", earth_rate="W")
    document["measured"] = {"height": 1}
    document["card"]["innovation"] = "measurement - prediction"
    found = nav.conventions(document)
    assert found.complete and {card.frame for card in found.cards} == {"local-level"}
    assert found.model()["H"][0].count("0") == 14


@pytest.mark.long
@pytest.mark.parametrize("azimuth", ["north", "wander"])
def test_a_named_wander_angle_serves_axes_to_the_north_for_conversions(azimuth):
    other = {"north": "wander", "wander": "north"}[azimuth]
    document = document_of({**LEVEL, "azimuth": azimuth}, radii="R", earth_rate="W", wander_angle="longitude")
    there = nav.conventions(document).convert(azimuth=other)
    assert (there.source.azimuth, there.target.azimuth) == (azimuth, other)
    assert there.proved and not there.neglected_entries() and nav.check(there).accepted
    assert attitude_rows(there) == rows_of_wander(-1 if azimuth == "wander" else 1)


def test_what_is_known_beside_a_card_to_the_north_stays_known_with_a_wander_angle():
    document = document_of({**LEVEL, "azimuth": "north"}, radii="R", earth_rate="W", wander_angle="longitude")
    document["known"] = {"error": "estimate - truth"}
    assert fill_model(document)["known"] == {"error": "estimate - truth", "azimuth": "north"}


def attitude_rows(conversion):
    """The block of T from attitude to attitude."""
    places = [conversion.problem.states.index(name) for name in STATES["attitude"]]
    return sp.Matrix(3, 3, [sp.sympify(conversion.T[i][j]) for i in places for j in places])


def rows_of_wander(sense=1):
    """Axes to the north are turned about down by the angle, from north to east."""
    z = sense * sp.Symbol("longitude")
    return sp.Matrix([[sp.cos(z), sp.sin(z), 0], [-sp.sin(z), sp.cos(z), 0], [0, 0, 1]])


@pytest.mark.long
@pytest.mark.parametrize("target", [{"axes": "NED"}, {"axes": "NED", "angle": "psi"}])
def test_axes_that_wander_are_reached_from_the_frame_of_the_earth_by_their_angle(target):
    words = {**NORMAL, "earth": "sphere", "gravity_radius": "R + h", "centrifugal": "kept"}
    document = document_of(words, radii="R", earth_rate="W", longitude="x1", wander_angle="longitude")
    document["roles"] = {name: STATES[name] for name in ROLES[:3]}
    document["card"].pop("bias_sign")
    document["quantities"]["attitude_correction"] = ["x1", "x2", "x3"]  # a reset that has to be written, too
    found = nav.conventions(document)
    north, wander = (found.convert(frame="local-level", azimuth=a, **target) for a in ("north", "wander"))
    assert north.proved and wander.proved
    turned = attitude_rows(wander) - rows_of_wander() * attitude_rows(north)
    assert turned.expand() == sp.zeros(3, 3)


@pytest.mark.long
def test_axes_that_wander_by_an_angle_without_a_name_are_not_reached():
    document = document_of(LEVEL, radii="R", earth_rate="W")
    with pytest.raises(nav.NavsymError, match="quantities with wander_angle"):
        nav.conventions(document).convert(azimuth="wander")


def test_a_conversion_starts_from_the_card_of_the_file_and_counts_its_steps():
    turned = {"error": "truth - estimate", "rotation_sign": "-", "bias_sign": "estimate - truth"}
    document = document_of({**turned, "frame": "inertial"})
    document["card"].pop("position_error")
    document["roles"] = {name: STATES[name] for name in ("velocity", "attitude", "gyro_bias")}
    document["quantities"] = {name: MOTION[name] for name in ("specific_force_body", "angular_rate", "rotation")}
    found, steps = nav.conventions(document, known={"frame": "inertial"}), list[tuple[int, int]]()
    assert {card.error for card in found.cards} == {"truth - estimate", "estimate - truth"}
    there = found.convert(progress=lambda *step: steps.append(step), bias_sign="truth - estimate")
    assert there.proved and {name: getattr(there.source, name) for name in turned} == turned
    place = there.problem.states.index(STATES["gyro_bias"][0])
    assert there.T[place][place] == "-1"
    assert [done for done, _ in steps] == [*range(1, len(steps) + 1)] and all(done <= of for done, of in steps)
