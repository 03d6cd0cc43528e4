"""Which cards are found: published models, models made from a card, and models that were spoiled."""

from __future__ import annotations

import random
import re
from typing import Any

import pytest
from flint import arb

import navsym as nav
from navsym.conventions.card import CHOICES, Card, list_structures
from navsym.conventions.points import evaluate
from navsym.conventions.reading import read_problem
from navsym.conventions.search import Comparison, find_candidates
from navsym.conventions.symbols import Formulas
from navsym.language.expression import read_tree
from navsym.language.tree import list_names
from tests.conventions import models

PLUS, MINUS = "estimate - truth", "truth - estimate"

#: Model -> what its card says; the other card of the pair changes the signs of all states.
CARDS: dict[str, dict[str, Any]] = {
    "Groves, inertial frame": {
        "frame": "inertial",
        "attitude_error": "frame",
        "rotation_sign": "+",
        "bias_sign": MINUS,
    },
    "Groves, Earth frame": {"frame": "earth", "attitude_error": "frame", "rotation_sign": "+", "bias_sign": MINUS},
    "Sola, local error": {"attitude_error": "body", "rotation_sign": "+", "bias_sign": PLUS, "earth": "none"},
    "Sola, global error": {"attitude_error": "frame", "rotation_sign": "+", "bias_sign": PLUS},
    "right invariant": {"attitude_error": "frame", "vector_error": "rotated", "bias_sign": PLUS},
    "left invariant": {"attitude_error": "body", "vector_error": "body", "bias_sign": PLUS},
    "pronto": {"attitude_error": "body", "vector_error": "velocity in body", "rotation_sign": "-", "bias_sign": MINUS},
    "MSCKF": {"attitude_error": "body", "error": MINUS, "rotation_sign": "-", "bias_sign": MINUS},
    "msckf_vio": {"attitude_error": "body", "error": MINUS, "rotation_sign": "-", "bias_sign": MINUS},
    "OpenVINS": {"attitude_error": "body", "error": MINUS, "rotation_sign": "-", "bias_sign": MINUS},
    "slam_in_autonomous_driving": {"attitude_error": "body", "error": MINUS, "rotation_sign": "-", "bias_sign": MINUS},
    "VINS-Mono": {"attitude_error": "body", "rotation_sign": "+", "bias_sign": PLUS},
    "OKVIS": {"attitude_error": "frame", "rotation_sign": "+", "bias_sign": PLUS},
    "imu_gps_localization": {"attitude_error": "body", "rotation_sign": "+", "bias_sign": PLUS},
    "LINS": {"attitude_error": "body", "rotation_sign": "+", "bias_sign": PLUS},
    "eskf-gps-imu-fusion": {"attitude_error": "frame", "error": PLUS, "rotation_sign": "-", "bias_sign": MINUS},
}
ALONE = ("pronto", "MSCKF", "msckf_vio", "OpenVINS", "slam_in_autonomous_driving")  # their source says what an error is
LEVEL: dict[str, dict[str, Any]] = {
    "Groves, local level": {
        "axes": "NED",
        "angle": "phi",
        "rotation_sign": "+",
        "bias_sign": MINUS,
        "earth": "ellipsoid",
    },
    "KF-GINS": {"axes": "NED", "angle": "phi", "rotation_sign": "-", "bias_sign": MINUS, "position_error": "metres"},
    "PSINS": {"axes": "ENU", "angle": "phi", "rotation_sign": "-", "bias_sign": MINUS, "position_error": "geodetic"},
    "NaveGo 2014": {"axes": "NED", "angle": "phi", "rotation_sign": "-", "bias_sign": MINUS, "earth": "sphere"},
    "NaveGo, issue 107": {"axes": "NED", "angle": "phi", "rotation_sign": "-", "bias_sign": PLUS, "earth": "sphere"},
    "Savage": {"axes": "ENU", "azimuth": "wander", "angle": "psi", "rotation_sign": "-", "bias_sign": MINUS},
    "Farrell and Barth": {"axes": "NED", "angle": "phi", "rotation_sign": "+", "earth": "sphere"},
    "psi angle": {"angle": "psi", "rotation_sign": "-", "bias_sign": MINUS, "position_error": "metres"},
}


def has_card(answer: nav.Conventions, words: dict[str, Any]) -> bool:
    """True where one of the cards says these words."""
    return any(all(getattr(card, name) == word for name, word in words.items()) for card in answer.cards)


@pytest.mark.parametrize("name", CARDS)
def test_a_published_model_has_the_card_of_its_source(name):
    answer = nav.conventions(models.PUBLISHED[name]())
    assert answer.complete
    assert has_card(answer, CARDS[name])
    assert len(answer.cards) == (1 if name in ALONE else 2)


@pytest.mark.long
@pytest.mark.parametrize("name", LEVEL)
def test_a_published_model_of_a_local_level_has_the_card_of_its_source(name):
    answer = nav.conventions(models.PUBLISHED[name]())
    assert answer.complete
    assert has_card(answer, {"error": PLUS, "frame": "local-level", **LEVEL[name]})


CONFLICTS = {
    "LINS, before issue 4": {("attitude", "attitude")},
    "Minnesota": {("velocity", "position")},
    "eskf-gps-imu-fusion, with feedback": {("attitude", "gyro_bias"), ("velocity", "accelerometer_bias")},
    "pyins": {("attitude", "attitude"), ("velocity", "velocity"), ("attitude", "position")},
}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.long] * (n == "pyins")) for n in CONFLICTS])
def test_a_published_model_without_a_card_has_its_blocks_named(name):
    answer = nav.conventions(models.PUBLISHED[name]())
    assert answer.complete and not answer.cards
    assert {c.block for c in answer.conflicts} == CONFLICTS[name]
    assert {c.status for c in answer.conflicts} == {"PROVED"}


@pytest.mark.long
def test_two_bias_blocks_of_one_sign_beside_a_positive_force_contradict_each_other():
    document = models.navego() | {"known": {"frame": "local-level", "axes": "NED", "angle": "phi"}}
    answer = nav.conventions(document)
    assert not answer.cards
    assert [(c.block, c.status) for c in answer.conflicts] == [(("velocity", "accelerometer_bias"), "PROVED")]
    assert answer.conflicts[0].change.startswith("change the sign")
    assert (("attitude", "gyro_bias"),) in answer.alternatives
    for conflict in answer.conflicts:  # the mended model has a card
        for i, j in conflict.entries:
            entry = document["model"]["F"][i - 1][j - 1]
            document["model"]["F"][i - 1][j - 1] = f"-({entry})"
    assert nav.conventions(document).cards


def document_of(card: Card, order: str, quantities: dict[str, Any]) -> dict[str, Any]:
    """The model that the generator gives for a card."""
    empty = models.document(order, {}, quantities, **models.declared(quantities))
    formulas, signs = Formulas(read_problem(empty), card), card.signs()
    blocks = {
        a + b: formulas.block(models.SHORT[a], models.SHORT[b], signs[models.SHORT[a]] / signs[models.SHORT[b]])
        for a in order
        for b in order
    }
    return models.document(order, blocks, quantities, **models.declared(quantities))


QUANTITIES = {
    "specific_force_body": models.F_B, "angular_rate": models.W_B, "rotation": models.C, "velocity": ["v1", "v2", "v3"],
    "position": ["r1", "r2", "r3"], "gravity": ["g1", "g2", "g3"],
}  # fmt: skip


@pytest.mark.long
def test_a_model_made_from_a_card_has_that_card():
    pick = random.Random(11)
    cards = [
        card for card in list_structures(frozenset(models.SHORT.values()), 0, ("inertial",)) if card.earth == "none"
    ]
    for card in cards:
        error, bias = (pick.choice((PLUS, MINUS)) for _ in range(2))
        signed = Card(**{**plain(card), "error": error, "bias_sign": bias, "rotation_sign": pick.choice("+-")})
        answer = nav.conventions(document_of(signed, "pvagb", QUANTITIES), known={"frame": "inertial"})
        assert answer.complete
        assert signed in answer.cards


def plain(card: Card) -> dict[str, Any]:
    """The fields of a card."""
    return {name: getattr(card, name) for name in Card.__dataclass_fields__}


def list_mutants(document: dict[str, Any]) -> list[dict[str, Any]]:
    """One sign, a transposition, a swapped frame."""
    mutants = []

    def spoil(change: Any) -> None:
        F = [list(row) for row in document["model"]["F"]]
        change(F)
        if document["model"]["F"] != F:
            mutants.append({**document, "model": {**document["model"], "F": F}})

    size = len(document["model"]["F"])
    for i in range(size):
        for j in range(size):
            if not is_zero(document["model"]["F"][i][j]):
                spoil(lambda F, i=i, j=j: F[i].__setitem__(j, f"-({F[i][j]})"))
    for a in range(0, size, 3):
        for b in range(0, size, 3):

            def transpose(F: Any, a: int = a, b: int = b) -> None:
                block = [row[b : b + 3] for row in F[a : a + 3]]
                for i in range(3):
                    F[a + i][b : b + 3] = [block[k][i] for k in range(3)]

            spoil(transpose)
            spoil(lambda F, a=a, b=b: swap_frame(F, a, b))
    return mutants


def is_zero(text: str) -> bool:
    """True for what is zero however it is written, such as (0)*x: its sign is no mutant."""
    tree = read_tree(text, None)
    return evaluate(tree, {name: arb(k + 3) / 7 for k, name in enumerate(list_names(tree))}).contains(0)


def swap_frame(F: Any, a: int, b: int) -> None:
    """The rotation from frame to body where that from body to frame stands."""
    for i in range(3):
        for j in range(3):
            F[a + i][b + j] = re.sub(r"c(\d)(\d)", r"c\2\1", F[a + i][b + j])


def cards_of(document: dict[str, Any]) -> tuple[Card, ...]:
    """The candidates of a model; a complete answer has the same cards."""
    problem = read_problem(document)
    return find_candidates(problem, Comparison(problem)).candidates


@pytest.mark.long
@pytest.mark.parametrize("name", ["Sola, local error", "right invariant"])
def test_spoiled_models_are_noticed(name):
    document = models.PUBLISHED[name]()
    right, mutants = cards_of(document), list_mutants(document)
    pick = random.Random(2)
    chosen = pick.sample(mutants, min(30, len(mutants)))
    noticed = sum(cards_of(mutant) != right for mutant in chosen)
    assert noticed >= 0.97 * len(chosen)


def test_neighbours_are_excluded_by_an_entry_at_a_point():
    answer = nav.conventions(models.sola_local())
    fields = {exclusion.field for exclusion in answer.excluded}
    assert {"error", "attitude_error", "rotation_sign", "bias_sign", "vector_error"} <= fields
    assert all(exclusion.entry and exclusion.why for exclusion in answer.excluded)


@pytest.mark.long
def test_without_a_known_frame_a_flat_model_fits_every_frame():
    document = models.sola_global()
    document["known"] = {"error": PLUS}
    answer = nav.conventions(document)
    assert {card.frame for card in answer.cards} == set(CHOICES["frame"])
    assert {card.earth for card in answer.cards} == {"none"}


@pytest.mark.parametrize(("order", "gone"), [("va", "bgp"), ("ag", "pvb"), ("vab", "pg")])
def test_parts_of_a_model_are_enough(order, gone):
    whole = models.sola_local()
    keep = [k for k, state in enumerate(whole["model"]["states"]) if state[2] not in gone]
    F = [[whole["model"]["F"][i][j] for j in keep] for i in keep]
    states = [whole["model"]["states"][k] for k in keep]
    roles = {role: names for role, names in whole["roles"].items() if names[0] in states}
    answer = nav.conventions({**whole, "model": {"states": states, "F": F}, "roles": roles})
    assert answer.complete
    assert {card.attitude_error for card in answer.cards} == {"body"}


def test_biases_may_decay_and_not_grow():
    document = models.sola_local()
    document["parameters"]["tau"] = "positive"
    for entry, conflicts in (("-1/tau", 0), ("1/tau", 1)):
        for k in range(9, 12):
            document["model"]["F"][k][k] = entry
        answer = nav.conventions(document)
        assert bool(answer.cards) == (conflicts == 0)
        assert [c.block for c in answer.conflicts] == [("accelerometer_bias", "accelerometer_bias")] * conflicts


def test_an_entry_between_biases_that_no_point_tells_from_zero_is_not_taken_for_zero():
    document = models.sola_local()
    document["parameters"]["tau"] = "real"
    document["model"]["F"][9][10] = "(tau + 1)**2 - tau**2 - 2*tau - 1"
    assert nav.conventions(document).complete
    document["model"]["F"][9][10] += " + 1/10**90"
    answer = nav.conventions(document)
    assert not answer.cards and answer.undecided


def test_a_rotation_may_be_given_by_angles():
    quantities = {
        "specific_force_body": models.F_B,
        "rotation": [["cos(y)", "-sin(y)", "0"], ["sin(y)", "cos(y)", "0"], ["0", "0", "1"]],
    }
    C = quantities["rotation"]
    blocks = {
        "va": models.neg(models.mul(C, models.skew(models.F_B))),
        "vb": models.neg(C),
        "ag": models.neg([[*row] for row in models.E]),
    }
    document = models.document("vagb", blocks, quantities, {"frame": "inertial", "error": PLUS}, y="real")
    document["quantities"]["angular_rate"] = ["0", "0", "0"]
    answer = nav.conventions(document)
    assert answer.complete
    assert [(c.attitude_error, c.rotation_sign, c.bias_sign) for c in answer.cards] == [("body", "+", PLUS)]


@pytest.mark.long
def test_scale_factors_have_a_sign_of_their_own_and_move_to_other_errors():
    document = models.kf_gins(scaled=True)
    found = nav.conventions(document)
    assert found.complete and {(c.error, c.bias_sign, c.scale_sign) for c in found.cards} == {
        (PLUS, MINUS, MINUS), (MINUS, PLUS, PLUS)
    }  # fmt: skip
    for a in (0, 3):
        for row in document["model"]["F"][3 + a : 6 + a]:
            row[15:21] = [x if x == "0" else f"-({x})" for x in row[15:21]]
        if a == 0:  # one of the two sensors only: no sign of the scale factors makes both blocks right
            (conflict,) = nav.conventions(document).conflicts
            assert conflict.block[1] in ("gyro_scale", "accelerometer_scale") and conflict.status == "PROVED"
    assert {(c.bias_sign, c.scale_sign) for c in nav.conventions(document).cards} == {(MINUS, PLUS), (PLUS, MINUS)}


@pytest.mark.long
def test_scale_factors_are_converted():
    conversion = nav.conventions(models.kf_gins(scaled=True)).convert(attitude_error="body", scale_sign=PLUS)
    assert conversion.proved and conversion.F[6][15] == "w1"


@pytest.mark.long
def test_mended_rows_have_names_of_the_file_where_that_can_be():
    words = {
        "frame": "local-level", "axes": "NWU", "error": MINUS, "rotation_sign": "+", "angle": "psi",
        "earth": "ellipsoid", "vector_error": "rotated", "position_error": "geodetic", "radius_variation": "dropped",
        "earth_rate": "kept", "height_variation": "dropped", "gravity_gradient": "none", "attitude_error": "frame",
        "transport_rate": "kept",
    }  # fmt: skip
    empty = models.document("pva", {}, models.NED, words, **models.declared(models.NED))
    document = {**empty, "card": words, "known": words}
    del document["model"], document["known"]
    F = [list(row) for row in nav.conventions(document).model()["F"]]
    F[0][0], F[1][0] = F[1][0], F[0][0]
    (conflict,) = nav.conventions(
        {**empty, "model": {**empty["model"], "F": F}, "known": {"frame": "local-level"}}
    ).conflicts
    assert "unnamed" not in conflict.change and conflict.status == "PROVED"


def test_a_quantity_without_a_name_is_named_beside_the_mended_rows():
    document = models.sola_local()
    del document["quantities"]["angular_rate"]
    (conflict,) = nav.conventions(document).conflicts
    assert "unnamed_w0 is angular_rate, which [quantities] lacks" in conflict.change


def test_points_lie_in_the_declared_ranges_where_a_formula_has_another_branch():
    document = models.sola_local()
    document["model"]["F"][3][9] = document["model"]["F"][3][9].replace("c11", "sqrt(c11**2)")
    document["parameters"]["c11"] = "positive"
    assert nav.conventions(document).cards == nav.conventions(models.sola_local()).cards
    document["parameters"]["c11"] = ["2", "3"]
    with pytest.raises(nav.NavsymError, match="widen them"):
        nav.conventions(document)


def test_what_is_known_of_the_whole_filter_may_say_nothing_of_a_part():
    part = {"states": ["a1", "a2", "a3"], "F": [["0", "w3", "-w2"], ["-w3", "0", "w1"], ["w2", "-w1", "0"]]}
    document = {
        "model": part, "parameters": dict.fromkeys(models.W_B, "real"), "roles": {"attitude": part["states"]},
        "quantities": {"angular_rate": models.W_B}, "known": {"frame": "inertial", "error": MINUS},
    }  # fmt: skip
    assert {card.attitude_error for card in nav.conventions(document).cards} == {"body"}


def half_angle(share: str = "-1/2") -> dict[str, Any]:
    """Lefferts, Markley and Shuster (1982): the vector part of the error quaternion, and the bias of the gyros."""
    blocks = {"aa": models.neg(models.skew(models.W_B)), "ag": models.scale(share, models.E)}
    return models.document("ag", blocks, {"angular_rate": models.W_B}, {"frame": "inertial", "rotation_sign": "+"})


def test_the_vector_part_of_the_error_quaternion_is_half_of_the_angle():
    for share, size in (("-1/2", "half angle"), ("-1", "angle")):
        found = nav.conventions(half_angle(share))
        (card,) = found.cards
        assert found.complete and (card.attitude_error, card.attitude_size, card.bias_sign) == ("body", size, PLUS)
    other = found.convert(attitude_size="half angle")
    assert other.proved and [row[3:] for row in other.F[:3]] == [
        ("-1/2", "0", "0"),
        ("0", "-1/2", "0"),
        ("0", "0", "-1/2"),
    ]
    assert not nav.conventions(half_angle("-1/3")).cards


def test_a_progress_that_is_no_function_is_refused():
    with pytest.raises(nav.NavsymError, match="expected a function of two numbers"):
        nav.conventions(half_angle()).convert(None, None)  # type: ignore[arg-type]


def test_rates_that_are_written_as_formulas_exclude_the_cards_of_other_axes():
    """The flat Earth has another transport rate: it is no reading of the model, and it fell when it was looked at."""
    quantities = {**models.NED, "transport_rate": ["vE/(RE + h)", "-vN/(RN + h)", "-vE*tan(L)/(RE + h)"]}
    card = Card(
        "local-level", "NED", "north", angle="phi", bias_sign=None, earth="ellipsoid", earth_rate="kept",
        transport_rate="kept", height_variation="kept", radius_variation=None,
    )  # fmt: skip
    document = document_of(card, "va", quantities) | {"known": {"frame": "local-level", "error": PLUS}}
    answer = nav.conventions(document)
    assert answer.complete and {(c.axes, c.earth, c.attitude_error) for c in answer.cards} == {
        ("NED", "ellipsoid", "frame")
    }
    assert any(e.why.startswith(("earth_rate", "transport_rate")) for e in answer.excluded)
