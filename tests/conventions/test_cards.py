"""Cards as files: models derived from them, all cards that are equal, and cards that say too little or too much."""

from __future__ import annotations

import copy
import random
import re
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.conventions.card import Card
from navsym.conventions.converting import convert
from navsym.conventions.generating import choose_card, fill_model
from navsym.conventions.reading import read_problem
from navsym.conventions.search import Comparison, find_candidates, list_cards
from navsym.core.errors import NavsymError
from navsym.language.tomlfile import read_toml
from tests.conventions import models
from tests.conventions.test_finding import cards_of, document_of
from tests.conventions.test_measuring import sola

EXAMPLES = Path(__file__).parents[2] / "examples"
CARD = EXAMPLES / "card.toml"
WORDS = read_toml(CARD)["card"]


@pytest.mark.long
def test_the_model_of_a_card_has_that_card_and_those_that_are_equal():
    found = nav.conventions(CARD)
    assert found.complete and all(found.cards[0].words()[name] == word for name, word in WORDS.items())
    assert len(found.cards) == 16  # a flat world at rest: any frame and axes, phi or psi, all signs or none changed
    again = nav.conventions({**read_toml(CARD), "card": found.cards[5].words()})
    assert again.model()["F"] == found.model()["F"] and set(again.cards) == set(found.cards)


def test_a_card_beside_a_model_asks_whether_it_is_right(tmp_path, capsys):
    model = str(EXAMPLES / "conventions.toml")
    assert len(nav.conventions(model, card=CARD).cards) == 1
    assert run(["conventions", model, "--card", str(CARD)]) == 0
    wrong = tmp_path / "card.toml"
    wrong.write_text(CARD.read_text().replace('rotation_sign  = "-"', 'rotation_sign  = "+"'))
    assert run(["conventions", model, "--card", str(wrong)]) == 1
    assert "must change" in capsys.readouterr().out


def test_a_card_is_right_beside_its_own_model_where_a_flat_earth_has_the_same_one():
    """With the psi angle and vectors in the body no rate of a sphere is left in the blocks of velocity and attitude."""
    whole = read_toml(CARD)
    roles = {role: whole["roles"][role] for role in ("velocity", "attitude")}
    quantities = {**whole["quantities"], "angular_rate": ["w1", "w2", "w3"], "radii": "R", "latitude": "L"}
    parameters = {**whole["parameters"], "w1": "real", "w2": "real", "w3": "real", "R": "positive", "L": ["-1", "1"]}
    document = {**whole, "roles": roles, "quantities": quantities, "parameters": parameters}
    words = {"frame": "local-level", "axes": "NED", "angle": "psi", "earth": "sphere", "transport_rate": "kept"}
    words |= {"earth_rate": "dropped", "error": "estimate - truth", "attitude_error": "body", "rotation_sign": "-"}
    words |= {"vector_error": "body"}
    found = nav.conventions({**document, "card": words, "model": fill_model({**document, "card": words})["model"]})
    assert found.complete and [{**card.words(), **words} == card.words() for card in found.cards] == [True]


def test_measurements_noise_and_reset_are_derived_too():
    document = sola()
    document["model"] = {"states": document["model"]["states"]}
    (words,) = (card.words() for card in nav.conventions(sola()).cards)
    found = nav.conventions({**document, "card": words})
    assert found.complete and words in [card.words() for card in found.cards]
    known = {"frame": "inertial", "error": words["error"]}
    assert {(c.block, c.matrix) for c in nav.conventions(sola(), known=known).conflicts} == set()
    assert found.model()["H"][0][:3] == ["1", "0", "0"] and found.model()["reset"][6][6] == "1"


def test_every_card_of_a_problem_is_chosen_by_its_own_words():
    document = models.groves_earth()
    problem = read_problem(document)
    cards = list(list_cards(problem))
    assert len({tuple(card.words().items()) for card in cards}) == len(cards)
    for card in random.Random(1).sample(cards, 20):
        assert choose_card(problem, card.words(), "card") == card


def test_a_card_that_leaves_a_term_out_is_chosen_by_its_own_words_beside_those_that_have_it():
    quantities = ABROAD | {"radii": ["RN", "RE", "R3"]}
    problem = read_problem(models.document("pvagb", {}, quantities, **models.declared(quantities)))
    cards = [c for c in list_cards(problem, {"frame": "earth", "gravity_gradient": "normal"}) if not c.gravity_radius]
    assert cards and all(choose_card(problem, card.words(), "card") == card for card in cards[:4])


def test_the_card_of_a_file_is_its_first_answer_where_a_flat_earth_has_the_same_model():
    quantities = {name: PLACED[name] for name in ("rotation", "specific_force_body", "radii", "earth_rate", "latitude")}
    document = models.document("vag", {}, quantities, **models.declared(quantities))
    card = replace(LEVEL, earth_rate="dropped", transport_rate="dropped", gravity_gradient="none")
    card = replace(card, gravity_radius=None, position_error=None)
    del document["model"], document["known"]
    found = nav.conventions({**document, "card": card.words()})
    assert found.complete and found.cards[0] == card
    assert {other.earth for other in found.cards[1:]} == {"none"}


@pytest.mark.parametrize(
    ("change", "kind", "named"),
    [
        ({"rotation_sign": None}, "empty", "rotation_sign"),
        ({"vector_error": None}, "empty", "vector_error"),
        ({"frame": "moon"}, "domain", "frame"),
        ({"axes": "NED"}, "domain", "local-level"),
        ({"centrifugal": "kept"}, "domain", "centrifugal"),
        ({"sense": "active"}, "syntax", "sense"),
        ({"frame": 3}, "syntax", "frame"),
    ],
)
def test_a_card_that_says_too_little_or_contradicts_itself_is_named(change: dict[str, Any], kind: str, named: str):
    words = {name: word for name, word in {**WORDS, **change}.items() if word is not None}
    with pytest.raises(NavsymError) as caught:
        nav.conventions({**read_toml(CARD), "card": words})
    assert (caught.value.kind, named in str(caught.value)) == (kind, True)
    assert "\n" not in str(caught.value)


def test_a_quantity_that_the_card_needs_is_asked_for():
    document = read_toml(CARD)
    del document["quantities"]["rotation"]
    with pytest.raises(NavsymError, match="rotation"):
        nav.conventions(document)
    with pytest.raises(NavsymError, match="card"):
        nav.conventions(document, card=EXAMPLES / "guard.toml")


# -- other axes and frames, proved on the text of a model -------------------------------------------------

PLACED = {
    **models.NED, "specific_force_body": models.F_B, "angular_rate": models.W_B, "radii": ["R"], "longitude": "lon",
    "earth_angle": "th",
}  # fmt: skip
PLACED.pop("specific_force")
ABROAD = PLACED | {"velocity": ["v1", "v2", "v3"], "position": ["r1", "r2", "r3"], "gravitational_parameter": "mu"}
LEVEL = Card(
    "local-level", "NED", "north", angle="phi", earth="sphere", earth_rate="kept", transport_rate="kept",
    gravity_gradient="vertical", gravity_radius="R + h", height_variation="kept", position_error="metres",
)  # fmt: skip
EARTH = Card(
    "earth",
    earth="sphere",
    earth_rate="kept",
    gravity_gradient="central",
    centrifugal="dropped",
    position_error="metres",
)
WAYS = [
    (LEVEL, PLACED, {"frame": "earth"}),
    (replace(LEVEL, earth_rate="dropped"), PLACED, {"frame": "inertial", "attitude_error": "body"}),
    (replace(LEVEL, angle="psi"), PLACED, {"axes": "ENU", "angle": "phi", "error": "truth - estimate"}),
    (EARTH, ABROAD, {"frame": "local-level", "axes": "NWU"}),
    (replace(EARTH, centrifugal="kept"), ABROAD, {"frame": "inertial", "vector_error": "rotated"}),
    (replace(EARTH, gravity_gradient="normal", gravity_radius="R + h"), ABROAD, {"frame": "local-level"}),
]
ELLIPSOID = PLACED | {"radii": ["RN", "RE"], "radius_slope": "rho"}


@pytest.mark.parametrize(
    ("card", "quantities", "changes"),
    [pytest.param(*way, marks=[] if k == 4 else [pytest.mark.long]) for k, way in enumerate(WAYS)]
    + [
        pytest.param(
            replace(LEVEL, earth="ellipsoid", radius_variation="kept", gravity_radius="RN + h"),
            ELLIPSOID,
            {"frame": "earth"},
            marks=pytest.mark.long,
        )
    ],
)
def test_a_model_in_another_frame_is_what_the_generator_gives_there(card, quantities, changes):
    problem = read_problem(document_of(card, "pvagb", quantities))
    conversion = convert(problem, card, changes)
    assert conversion.proved
    assert all(getattr(conversion.target, name) == word for name, word in changes.items())


FLAT = replace(LEVEL, earth="none", height_variation=None, transport_rate="dropped", gravity_gradient="none")
RADIAL = replace(EARTH, gravity_gradient="radial")
OVAL = replace(LEVEL, earth="ellipsoid", radius_variation="kept", gravity_radius="RN")
LOW = {name: trees for name, trees in ELLIPSOID.items() if name != "height"}  # radii that contain the height
TILTED = {name: trees for name, trees in ABROAD.items() if name != "longitude"} | {"earth_rate": ["e1", "e2", "e3"]}


@pytest.mark.parametrize(
    ("card", "quantities", "changes", "named"),
    [
        (LEVEL, PLACED, {"frame": "inertial"}, "centrifugal"),
        (replace(FLAT, gravity_radius=None), PLACED, {"frame": "earth"}, "flat"),
        (EARTH, {k: v for k, v in ABROAD.items() if k != "radii"}, {"frame": "local-level"}, "radii"),
        (replace(RADIAL, centrifugal="kept"), ABROAD, {"frame": "inertial"}, "gradient"),
        (LEVEL, PLACED, {"frame": "earth", "transport_rate": "dropped"}, "transport_rate"),
        (LEVEL, PLACED, {"gravity_gradient": "central"}, "one card"),
        (OVAL, LOW, {"frame": "earth", "vector_error": "rotated"}, "height"),
        (replace(EARTH, centrifugal="kept"), TILTED, {"frame": "inertial"}, "third axis"),
        (LEVEL, PLACED, {"transport_rate": "lost"}, "dropped"),
        (LEVEL, PLACED, {"azimuth": "free"}, "wander"),
    ],
)
def test_a_card_that_has_no_equal_is_refused_with_the_reason(card, quantities, changes, named):
    problem = read_problem(models.document("pvagb", {}, quantities, **models.declared(quantities)))
    with pytest.raises(NavsymError, match=named):
        convert(problem, card, changes)


LOST = replace(LEVEL, transport_rate="dropped", height_variation="dropped")
DROPPING = [
    (EARTH, replace(EARTH, centrifugal="kept"), ABROAD, {"frame": "inertial"}, {"velocity by position"}),
    (
        LEVEL,
        replace(LEVEL, earth_rate="dropped"),
        PLACED,
        {"earth_rate": "dropped", "angle": "psi"},
        {f"{a} by {b}" for a in ("velocity", "attitude") for b in ("position", "velocity", "attitude")}
        - {"velocity by attitude", "attitude by velocity"},
    ),
    (
        LOST,
        LEVEL,
        PLACED,
        {"frame": "earth", "vector_error": "body"},
        {f"{a} by {b}" for a in ("position", "velocity", "attitude") for b in ("position", "velocity", "attitude")}
        - {"position by velocity", "position by attitude", "velocity by attitude"},
    ),
    (RADIAL, replace(EARTH, gravity_gradient="normal", gravity_radius="R"), ABROAD, {"frame": "local-level"},
     {"velocity by position"}),
]  # fmt: skip


@pytest.mark.parametrize(
    ("card", "whole", "quantities", "changes", "blocks"),
    [pytest.param(*row, marks=[] if k < 2 else [pytest.mark.long]) for k, row in enumerate(DROPPING)],
)
def test_terms_that_the_target_has_and_the_model_has_not_are_named(card, whole, quantities, changes, blocks):
    found = convert(read_problem(document_of(card, "pvagb", quantities)), card, changes)
    exact = {name: word for name, word in changes.items() if name != "earth_rate"}
    same = convert(read_problem(document_of(whole, "pvagb", quantities)), whole, exact)
    assert found.proved and same.proved and not same.neglected_entries()
    assert (found.F, found.T, found.rate) == (same.F, same.T, same.rate)
    roles = ["position", "velocity", "attitude", "gyro_bias", "accelerometer_bias"]
    named = {f"{roles[(i - 1) // 3]} by {roles[(j - 1) // 3]}" for i, j in found.neglected_entries()}
    assert named == blocks
    assert "named entries" in repr(found) and found.document()["neglected"] == [list(r) for r in found.neglected]


@pytest.mark.long
def test_blocks_that_a_model_drops_are_named_by_its_conversion():
    document = document_of(LEVEL, "pvagb", PLACED)
    for i in (6, 7, 8):
        document["model"]["F"][i][0:3] = ["0", "0", "0"]  # attitude by position
    problem = read_problem(document)
    card = replace(LEVEL, dropped=(("attitude", "position"),))
    assert any(c.dropped == card.dropped for c in find_candidates(problem, Comparison(problem)).candidates)
    found = convert(problem, card, {"error": "truth - estimate"})
    assert found.proved and {(i > 6, j < 4) for i, j in found.neglected_entries()} == {(True, True)}
    assert found.target.dropped == ()


@pytest.mark.long
def test_a_velocity_in_the_body_turns_with_the_body_and_the_earth():
    changes = {"vector_error": "velocity in body", "attitude_error": "body"}
    problem = read_problem(document_of(LEVEL, "pvagb", PLACED | {"velocity": ["v1", "v2", "v3"]}))
    found = convert(problem, LEVEL, changes)
    assert found.proved and not found.neglected_entries()
    assert found.F[3][4] == "c13*cos(L)*W - c33*sin(L)*W + w3"  # -(w + C' W) x u


WANDER = PLACED | {"wander_angle": "alpha", "velocity": ["v1", "v2", "v3"]}
TURNED = replace(LEVEL, azimuth="wander")


@pytest.mark.parametrize(
    ("card", "quantities", "changes"),
    [
        (TURNED, WANDER, {"angle": "psi", "axes": "ENU"}),
        pytest.param(TURNED, WANDER, {"frame": "earth"}, marks=pytest.mark.long),
        pytest.param(LEVEL, WANDER, {"azimuth": "wander", "angle": "psi"}, marks=pytest.mark.long),
        pytest.param(
            EARTH, ABROAD | {"wander_angle": "alpha"}, {"frame": "local-level", "azimuth": "wander"},
            marks=pytest.mark.long,
        ),
        pytest.param(replace(LEVEL, angle="psi"), PLACED, {"frame": "earth"}, marks=pytest.mark.long),
        pytest.param(EARTH, ABROAD, {"frame": "local-level", "angle": "psi"}, marks=pytest.mark.long),
    ],
)  # fmt: skip
def test_axes_that_wander_and_the_psi_angle_are_left_and_reached_exactly(card, quantities, changes):
    found = convert(read_problem(document_of(card, "pvagb", quantities)), card, changes)
    assert found.proved and not found.neglected_entries()


@pytest.mark.long
def test_a_model_with_axes_that_wander_has_that_card_and_no_other():
    document = document_of(TURNED, "pvagb", WANDER)
    assert {(c.azimuth, c.axes, c.angle) for c in cards_of(document)} == {("wander", "NED", "phi")}
    north = copy.deepcopy(document)
    north["quantities"].pop("wander_angle")
    assert not any(c.azimuth == "wander" for c in cards_of(north))


def test_a_wrong_model_is_not_proved_in_another_frame():
    card, quantities, changes = WAYS[4]
    document = document_of(card, "pvagb", quantities)
    row, column = 3, 7
    document["model"]["F"][row][column] = f"-({document['model']['F'][row][column]})"
    assert not convert(read_problem(document), card, changes).proved


def test_a_conversion_leaves_as_code_in_both_directions(tmp_path):
    conversion = nav.conventions(EXAMPLES / "conventions.toml").convert(attitude_error="body")
    exported = conversion.export(to="python", out=str(tmp_path / "code"))
    names = [function["name"] for function in exported.functions]
    assert names == ["inertial_with_biases_T", "inertial_with_biases_T_inverse"]
    assert nav.check(tmp_path / "code").accepted
    spoiled = replace(conversion, proved=False)
    with pytest.raises(NavsymError, match="proved"):
        nav.export(spoiled, to="python", out=str(tmp_path / "other"))


# -- LaTeX ------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_blocks_in_latex_are_the_blocks_of_the_model_again():
    conversion = nav.conventions(EXAMPLES / "conventions.toml").convert(attitude_error="body", error="truth - estimate")
    lines = conversion.latex().split("\n")
    roles = {r"\delta v": (0, 3), r"\varphi": (3, 6), r"\delta b_g": (6, 9), r"\delta b_a": (9, 12)}
    found = {"T": 0, "F": 0}
    for line in lines:
        head = re.fullmatch(r"([TF])_\{(.*),\\,(.*)\} = (\\begin\{bmatrix\}.*\\end\{bmatrix\})(?: \\\\)?", line)
        if head is None:
            continue
        name, row, column, block = head.groups()
        a, c = roles[row][0], roles[column][0]
        cells = [[cell.strip() for cell in part.split("&")] for part in block[15:-13].split(r"\\")]
        for i, j in product(range(3), range(3)):
            spaced = re.sub(r"_\{(\d+)\}", r"\1", cells[i][j])
            text = re.sub(r"(?<=[0-9]) (?=[a-z])", "*", spaced)
            assert nav.prove(text, "=", getattr(conversion, name)[a + i][c + j]).status == nav.PROVED
        found[name] += 1
    rows = [(p, q) for p in roles.values() for q in roles.values()]
    for name, count in found.items():
        M = getattr(conversion, name)
        assert count == sum(any(M[i][j] != "0" for i in range(*p) for j in range(*q)) for p, q in rows) > 0


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ({}, [r"\hat C = \left(E + [\varphi \times]\right) C", r"\delta v = \hat v - v"]),
        ({"rotation_sign": "-", "attitude_error": "body"}, [r"\hat C = C \left(E - [\varphi \times]\right)"]),
        ({"error": "truth - estimate", "vector_error": "body"}, [r"\delta v = C^T \left(v - \hat v\right)"]),
        ({"vector_error": "rotated", "frame": "inertial"}, [r"\delta r = \hat r - \hat C C^T r"]),
        ({"vector_error": "rotated", "angle": "psi"}, [r"\delta r = \hat r - r", r"[\psi \times]"]),
    ],
)
def test_a_card_in_latex_is_its_definition_of_errors(changes, lines):
    text = replace(LEVEL, **changes)._repr_latex_()
    assert all(line in text for line in lines)


def test_a_zero_of_the_rotation_is_no_factor_of_an_entry():
    heading = [["cos(y)", "-sin(y)", "0"], ["sin(y)", "cos(y)", "0"], ["0", "0", "1"]]
    document = read_toml(CARD)
    roles = {**document["roles"], "gyro_scale": ["k1", "k2", "k3"]}
    quantities = {**document["quantities"], "rotation": heading, "angular_rate": models.W_B}
    parameters = {**document["parameters"], **dict.fromkeys(("y", *models.W_B), "real")}
    card = {**document["card"], "scale_sign": "truth - estimate"}
    F = nav.conventions({"card": card, "roles": roles, "quantities": quantities, "parameters": parameters}).model()["F"]
    assert not [x for row in F for x in row if "*0" in x or "0*" in x]
