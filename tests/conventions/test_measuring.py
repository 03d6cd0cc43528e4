"""H, G and reset of cards against differences of measurements and corrections typed a second time, in mpmath."""

from __future__ import annotations

import copy
import random
from dataclasses import replace
from typing import Any

import mpmath as mp
import pytest

import navsym as nav
from navsym.conventions.card import CHOICES, Card
from navsym.conventions.measuring import MEASURED, full_column
from navsym.conventions.mechanisation import CONSTANTS, ROLES, Mechanisation
from navsym.conventions.points import BITS
from navsym.core.balls import precision
from navsym.core.errors import NavsymError
from tests.conventions import models, reference
from tests.conventions.reference import STEP, Flight, exp, log, push, skew, vec
from tests.conventions.test_generator import EXACT, ball, random_card, world_of

ARM, SEEN, CORRECTION = vec("0.3", "-0.7", "0.2"), vec("0.9", "0.1", "-0.5"), vec("0.4", "-0.3", "0.8")


def measurement(flight: Flight, kind: str, x: dict[str, Any], y: dict[str, Any]) -> Any:
    """What the estimate y predicts less what the truth x shows, by the definitions of the measurements."""
    level = flight.card.frame == "local-level"
    curved = level and flight.card.earth != "none"
    A = flight.axes(x)
    if kind in ("position", "height"):
        moved = y["position"] - x["position"]
        arm = (y["C"] - x["C"]) * ARM
        if kind == "height":
            return vec(moved[2] if curved else (A.T * moved)[2] * -1)
        if not curved:
            return moved + arm
        L, _, h = x["position"]
        RN, RE = flight.radii(L)
        D = mp.diag([RN + h, (RE + h) * mp.cos(L), -1])
        return A * D * moved + arm if flight.card.position_error == "metres" else moved + D**-1 * A.T * arm
    if kind == "attitude":
        return log(y["C"] * x["C"].T)

    def shown(s: dict[str, Any]) -> Any:
        spin = (
            skew(flight.w - s["gyro_bias"] - s["C"].T * flight.turning(s["position"][0] if curved else flight.L, s))
            * ARM
        )
        return {
            "velocity": s["velocity"] + s["C"] * spin,
            "body_velocity": s["C"].T * s["velocity"] + spin,
            "zero_velocity": s["velocity"],
            "vector": s["C"].T * SEEN,
        }[kind]

    return shown(y) - shown(x)


def measurement_matrix(flight: Flight, kind: str) -> Any:
    """H for the signed error of the card: differences by coordinates, and those of the error solved for."""
    x = flight.truth()
    rows = MEASURED[kind]
    Z = mp.matrix(rows, 15)
    for j in range(15):
        ends = [measurement(flight, kind, x, push(x, j, side * STEP)) for side in (1, -1)]
        Z[:, j] = (ends[0] - ends[1]) / (2 * STEP)
    return Z * flight.sensitivity(x) ** -1


def world(flight: Flight) -> Any:
    """The quantities of a flight with arm, vector and correction."""
    arm, seen, c = ([ball(x) for x in v] for v in (ARM, SEEN, CORRECTION))
    kinds = tuple(kind for kind in MEASURED if kind != "height" or flight.card.frame == "local-level")
    corrections = {"attitude": c, "velocity": c[::-1], "position": c}
    return replace(world_of(flight), arm=arm, seen=seen, measured=kinds, corrections=corrections)


def number(x: Any) -> Any:
    return mp.mpf(x) if isinstance(x, int) else mp.mpf(x.str(40, radius=False))


def worst_of_H(flight: Flight) -> Any:
    """The largest difference of an entry of H between generator and reference."""
    card, signs, worst = flight.card, flight.card.signs(), mp.mpf(0)
    with precision(BITS):
        motion = world(flight)
        columns = [full_column(Mechanisation(card, motion), ROLES[j // 3], j % 3) for j in range(15)]
        for kind in motion.measured:
            expected = measurement_matrix(flight, kind)
            for j, column in enumerate(columns):
                for i, value in enumerate(column[f"measured {kind}"]):
                    worst = max(worst, abs(number(value) / signs[ROLES[j // 3]] - expected[i, j]))
    return worst


@pytest.mark.parametrize("frame", CHOICES["frame"])
def test_measurement_matrices_are_the_differences_of_measurements(frame):
    pick = random.Random(f"H {frame}")
    card = random_card(pick, [card for card in EXACT if card.frame == frame])
    assert worst_of_H(Flight(card, 2)) < 1e-9, card


@pytest.mark.slow
def test_measurement_matrices_are_the_differences_of_measurements_on_a_hundred_flights():
    pick = random.Random(8)
    for seed in range(100):
        card = random_card(pick, EXACT)
        assert worst_of_H(Flight(card, seed)) < 1e-9, card


def corrected(card: Card, C: Any, v: Any, error: Any, correction: Any) -> Any:
    """Attitude and velocity error that are left, stacked, after a correction is taken out; every sign plus."""
    p, dv = error[:3], error[3:]
    before = exp(p) * C if card.attitude_error == "frame" else C * exp(p)
    turned = before * C.T * v
    shifted = {
        "difference": v + dv, "rotated": turned + dv, "body": v + C * dv, "velocity in body": turned + before * dv,
    }[card.vector_error]  # fmt: skip
    q, dq = correction[:3], correction[3:]
    after = exp(-q) * before if card.attitude_error == "frame" else before * exp(-q)
    taken = {
        "difference": shifted - dq,
        "rotated": (before * after.T) ** -1 * (shifted - dq),
        "body": shifted - after * dq,
        "velocity in body": after * (before.T * shifted - dq),
    }[card.vector_error]
    small = after * C.T if card.attitude_error == "frame" else C.T * after
    left = {
        "difference": taken - v, "rotated": taken - after * C.T * v, "body": C.T * (taken - v),
        "velocity in body": after.T * taken - C.T * v,
    }[card.vector_error]  # fmt: skip
    return mp.matrix([*log(small), *left])


@pytest.mark.parametrize("side", CHOICES["attitude_error"])
@pytest.mark.parametrize("vector", CHOICES["vector_error"])
def test_the_reset_is_the_derivative_of_what_a_correction_leaves(side, vector):
    card = Card("inertial", attitude_error=side, vector_error=vector, position_error="metres")
    flight, step = Flight(card, 5), mp.mpf(10) ** -12
    correction = mp.matrix([*CORRECTION, *reversed(CORRECTION)])
    with precision(BITS):
        flow = Mechanisation(card, world(flight))
        for j in range(6):
            column = full_column(flow, ("attitude", "velocity")[j // 3], j % 3)
            unit = mp.matrix([mp.mpf(k == j) for k in range(6)])
            ends = [
                a
                * b
                * corrected(card, flight.C, flight.v, a * step * unit + b * step * correction, b * step * correction)
                for a in (1, -1)
                for b in (1, -1)
            ]
            expected = (ends[0] + ends[1] + ends[2] + ends[3]) / (4 * step**2)
            got = [number(x) for row in ("attitude", "velocity") for x in column[f"reset {row}"]]
            assert max(abs(x - y) for x, y in zip(got, expected, strict=True)) < 1e-9, (j, got, expected)


@pytest.mark.parametrize("vector", ["rotated", "body"])
def test_a_reset_over_a_curved_earth_leaves_the_position_alone(vector):
    """Latitude, longitude and height are not turned with the attitude: no correction couples their errors to others."""
    cards = [card for card in EXACT if card.frame == "local-level" and card.earth != "none"]
    card = next(card for card in cards if card.vector_error == vector)
    with precision(BITS):
        flow = Mechanisation(card, world(Flight(card, 5)))
        columns = [full_column(flow, role, k) for role in ("attitude", "velocity", "position") for k in range(3)]
    assert all(part == 0 for column in columns for part in column["reset position"])
    assert any(part != 0 for column in columns for part in column["reset velocity"])


@pytest.mark.parametrize("kind", ["noise", "scale"])
def test_noise_and_scale_of_a_sensor_drive_the_error_as_its_output_does(kind):
    card = random_card(random.Random(4), EXACT)
    flight = Flight(card, 6)
    x, signs = flight.truth(), card.signs()
    with precision(BITS):
        flow = Mechanisation(card, world(flight))
        for sensor, truth in (("gyro", flight.w), ("accelerometer", flight.f)):
            for k in range(3):
                name, size = (f"noise {sensor}", -1) if kind == "noise" else (f"{sensor}_scale", truth[k])
                ends = []
                for side in (1, -1):
                    y = {role: value.copy() for role, value in x.items()}
                    y[f"{sensor}_bias"][k] = side * STEP * size  # what is taken from the output, without or with noise
                    rate, true = flight.derivative(y), flight.derivative(x)
                    moved = [{n: s[n] + STEP * r[n] if n in r else s[n] for n in s} for s, r in ((x, true), (x, rate))]
                    ends.append(reference.stack(flight.error(*moved)))
                column = full_column(flow, name, k)
                for i in range(9):
                    value = signs[ROLES[i // 3]] * number(column[ROLES[i // 3]][i % 3])
                    assert abs(value - (ends[0] - ends[1])[i] / (2 * STEP**2)) < 1e-9, (name, i)
        assert full_column(flow, f"noise {CONSTANTS[0]}", 1)[CONSTANTS[0]] == [0, 1, 0]


# -- finding with H, G and reset -----------------------------------------------------------------------


def sola(reset: str = "-1/2") -> dict[str, Any]:
    """The local error of Sola with a fix behind a lever arm, a magnetometer, its noises and its reset (section 6)."""
    document = models.sola_local()
    names = {"lever_arm": "l", "known_vector": "m", "attitude_correction": "t"}
    document["quantities"] |= {quantity: [f"{n}{k}" for k in (1, 2, 3)] for quantity, n in names.items()}
    document["parameters"] |= {f"{n}{k}": "real" for n in names.values() for k in (1, 2, 3)}
    seen = [" + ".join(f"c{k}{i}*m{k}" for k in (1, 2, 3)) for i in (1, 2, 3)]
    arm = models.neg(models.mul(models.C, models.skew(["l1", "l2", "l3"])))
    half = models.scale(reset, models.skew(["t1", "t2", "t3"])) if reset else models.O
    document["model"] |= {
        "H": grid(6, 15, {(0, 0): models.E, (0, 6): arm, (3, 6): models.skew(seen)}),
        "G": grid(15, 12, {(3, 0): models.C, (6, 3): models.neg(models.E), (9, 6): models.E, (12, 9): models.E}),
        "reset": grid(15, 15, {(6, 6): half}, unit=True),
    }
    noises = ("accelerometer", "gyro", "accelerometer_bias", "gyro_bias")
    document["noises"] = {noise: [3 * k + i for i in (1, 2, 3)] for k, noise in enumerate(noises)}
    return document | {"measured": {"position": [1, 2, 3], "vector": [4, 5, 6]}}


def grid(rows: int, columns: int, blocks: Any, unit: bool = False) -> list[list[str]]:
    """A matrix of blocks; a zero on the diagonal of a block is one of the unit matrix."""
    A = [["1" if unit and i == j else "0" for j in range(columns)] for i in range(rows)]
    for (r, c), block in blocks.items():
        for i, row in enumerate(block):
            for j, cell in enumerate(row):
                if cell != "0":
                    A[r + i][c + j] = cell
    return A


def test_measurements_and_reset_tell_the_signs_that_F_leaves_open():
    found = nav.conventions(sola())
    (card,) = found.cards
    assert found.complete and (card.error, card.innovation) == ("truth - estimate", "measurement - prediction")
    assert len(nav.conventions(models.sola_local()).cards) == 2


def test_a_reset_that_is_left_out_says_nothing_and_one_of_the_wrong_sign_must_change():
    assert len(nav.conventions(sola("")).cards) == 2
    (conflict,) = nav.conventions(
        {**sola("1/2"), "known": {"frame": "inertial", "error": "truth - estimate"}}
    ).conflicts
    assert (conflict.matrix, conflict.block, conflict.status) == ("reset", ("reset attitude", "attitude"), "PROVED")


@pytest.mark.parametrize(
    ("matrix", "corner", "block"),
    [
        ("F", (0, 3), ("position", "velocity")),
        ("H", (0, 0), ("measured position", "position")),
        ("G", (9, 6), ("accelerometer_bias", "noise accelerometer_bias")),
    ],
)
def test_a_unit_matrix_that_is_left_out_is_no_small_term(matrix, corner, block):
    document, (row, column) = sola(), corner
    for cells in document["model"][matrix][row : row + 3]:
        cells[column : column + 3] = ["0"] * 3
    answer = nav.conventions(document)
    assert not answer.cards and [(c.block, c.status) for c in answer.conflicts] == [(block, "PROVED")]


@pytest.mark.parametrize(
    ("matrix", "entry", "block"),
    [
        ("H", (0, 7), ("measured position", "attitude")),
        ("H", (3, 8), ("measured vector", "attitude")),
        ("G", (3, 1), ("velocity", "noise accelerometer")),
    ],
)
def test_one_wrong_sign_is_found_in_its_block(matrix, entry, block):
    document = copy.deepcopy(sola())
    i, j = entry
    document["model"][matrix][i][j] = f"-({document['model'][matrix][i][j]})"
    found = nav.conventions(document)
    (conflict,) = found.conflicts
    assert not found.cards and (conflict.matrix, conflict.block) == (matrix, block)
    assert conflict.status == "PROVED" and conflict.entries == ((i + 1, j + 1),)


WITHOUT_H = {key: value for key, value in sola()["model"].items() if key != "H"}


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"measured": {"position": [1, 2]}}, "shape"),
        ({"measured": {"position": [1, 2, 7]}}, "shape"),
        ({"measured": {"position": [1, 2, 3], "vector": [3, 4, 5]}}, "duplicate"),
        ({"measured": {"odour": [1, 2, 3]}}, "syntax"),
        ({"noises": {"gyro": "one"}}, "shape"),
        ({"model": {**sola()["model"], "H": None}}, "shape"),
        *(({"model": WITHOUT_H, "measurement": value}, "shape") for value in (5, None, ["x"])),
    ],
)
def test_rows_that_do_not_exist_are_refused(changes, kind):
    with pytest.raises(NavsymError) as error:
        nav.conventions(sola() | changes)
    assert error.value.kind == kind


def test_rows_of_measurement_blocks_go_by_their_names():
    document = sola()
    rows = document["model"].pop("H")
    document["measurement"] = [{"name": f"z{k}", "h": row, "sigma": "1"} for k, row in enumerate(rows)]
    document["measured"] = {"position": ["z0", "z1", "z2"], "vector": ["z3", "z4", "z5"]}
    assert [card.innovation for card in nav.conventions(document).cards] == ["measurement - prediction"]


def groves_with_an_antenna(turning: str) -> dict[str, Any]:
    """The Earth's frame of Groves, 2nd edition, with (14.111) to (14.113): an antenna on a lever arm."""
    document, arm, rate = models.groves_earth(), ["l1", "l2", "l3"], models.W_B
    document["quantities"] |= {"lever_arm": arm, "angular_rate": rate}
    document["parameters"] |= dict.fromkeys([*arm, *rate], "real")
    rotated = [" + ".join(f"c{i}{k}*l{k}" for k in (1, 2, 3)) for i in (1, 2, 3)]
    spin = ["w2*l3 - w3*l2", "w3*l1 - w1*l3", "w1*l2 - w2*l1"]
    moved = [" + ".join(f"c{i}{k}*({spin[k - 1]})" for k in (1, 2, 3)) for i in (1, 2, 3)]
    carried = [f"-W*({rotated[1]})", f"W*({rotated[0]})", "0"]
    terms = {"value": models.skew([f"{x} - ({y})" for x, y in zip(moved, carried, strict=True)])}
    terms["dropped"] = models.skew(moved)
    product = models.mul(models.skew(["0", "0", "W"]), models.skew(rotated))
    terms["kept"] = [
        [f"{x} - ({y})" for x, y in zip(*rows, strict=True)] for rows in zip(terms["dropped"], product, strict=True)
    ]
    less, gyro = models.neg(models.E), models.mul(models.C, models.skew(arm))
    blocks = {(0, 0): models.skew(rotated), (0, 6): less, (3, 0): terms[turning], (3, 3): less, (3, 12): gyro}
    document["model"]["H"] = grid(6, 15, blocks)
    return document | {"measured": {"position": [1, 2, 3], "velocity": [4, 5, 6]}, "known": {"frame": "earth"}}


@pytest.mark.long
@pytest.mark.parametrize("turning", CHOICES["arm_rate"])
def test_the_rate_of_the_earth_in_a_lever_arm_is_kept_or_its_value_or_dropped(turning):
    found = nav.conventions(groves_with_an_antenna(turning))
    assert found.complete and {card.arm_rate for card in found.cards} == {turning}
    assert {(card.error, card.innovation) for card in found.cards} == {
        ("estimate - truth", "measurement - prediction"), ("truth - estimate", "prediction - measurement"),
    }  # fmt: skip
