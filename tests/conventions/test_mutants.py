"""Spoiled models: one sign, a transposition, a swapped frame, a quaternion in another order. The cards must change."""

from __future__ import annotations

import random
import re
from itertools import product
from typing import Any

import pytest

from tests.conventions import models
from tests.conventions.test_finding import cards_of, list_mutants
from tests.conventions.test_measuring import sola

SQUARES = "(q0**2 + q1**2 + q2**2 + q3**2)"
#: Rotation from the body of a quaternion whose scalar is q0 (Hamilton).
BY_QUATERNION = [
    ["q0**2 + q1**2 - q2**2 - q3**2", "2*(q1*q2 - q0*q3)", "2*(q1*q3 + q0*q2)"],
    ["2*(q1*q2 + q0*q3)", "q0**2 - q1**2 + q2**2 - q3**2", "2*(q2*q3 - q0*q1)"],
    ["2*(q1*q3 - q0*q2)", "2*(q2*q3 + q0*q1)", "q0**2 - q1**2 - q2**2 + q3**2"],
]
ROTATION = [[f"({entry})/{SQUARES}" for entry in row] for row in BY_QUATERNION]
#: Other readings of the same four numbers: scalar last, and the rotation to the body (JPL).
ORDERS = {"last": dict(zip("0123", "1230", strict=True)), "first": dict(zip("0123", "3012", strict=True))}


def quaternion_model(spoiled: str = "", how: str = "") -> dict[str, Any]:
    """Sola's global error with a rotation by a quaternion; one block may read the quaternion in another way."""
    turned = [" + ".join(f"({ROTATION[i][k]})*{models.F_B[k]}" for k in range(3)) for i in range(3)]
    blocks = {"va": models.neg(models.skew(turned)), "vb": models.neg(ROTATION), "ag": models.neg(ROTATION)}
    if spoiled:
        block = blocks[spoiled]
        order = ORDERS.get(how)
        if order:
            block = [[re.sub(r"q(\d)", lambda m: "q" + order[m[1]], cell) for cell in row] for row in block]
        blocks[spoiled] = block if order else models.transpose(block)
    quantities = {"specific_force_body": models.F_B, "angular_rate": models.W_B, "rotation": ROTATION}
    declared = {f"q{k}": "positive" for k in range(4)}
    return models.document("vagb", blocks, quantities, {"frame": "inertial"}, **declared)


def list_order_mutants() -> list[dict[str, Any]]:
    """One block of the model with the quaternion in another order, or of the other rotation."""
    return [quaternion_model(block, how) for block in ("va", "vb", "ag") for how in ("last", "first", "jpl")]


def test_a_quaternion_in_another_order_is_noticed():
    right = cards_of(quaternion_model())
    assert right and all(card.attitude_error == "frame" for card in right)
    assert all(cards_of(mutant) != right for mutant in list_order_mutants())


def list_measured_mutants() -> list[dict[str, Any]]:
    """One sign of an entry of H, G or the reset."""
    document, mutants = sola(), list[dict[str, Any]]()
    for name in ("H", "G", "reset"):
        M = document["model"][name]
        for i, j in product(range(len(M)), range(len(M[0]))):
            if M[i][j] != "0":
                rows = [list(row) for row in M]
                rows[i][j] = f"-({M[i][j]})"
                mutants.append({**document, "model": {**document["model"], name: rows}})
    return mutants


@pytest.mark.long
def test_signs_of_measurements_noise_and_reset_are_noticed():
    right = cards_of(sola())
    mutants = list_measured_mutants()
    assert len(mutants) > 40 and all(cards_of(mutant) != right for mutant in random.Random(5).sample(mutants, 20))


@pytest.mark.slow
def test_of_more_than_a_thousand_spoiled_models_nearly_all_are_noticed():
    noticed, total = sum(cards_of(m) != cards_of(sola()) for m in list_measured_mutants()), len(list_measured_mutants())
    for build in (quaternion_model, sola, *models.PUBLISHED.values()):
        document = build()
        right = cards_of(document)
        mutants = list_order_mutants() if build is quaternion_model else list_mutants(document)
        for mutant in mutants if right else []:
            total, noticed = total + 1, noticed + (cards_of(mutant) != right)
    assert total > 1000 and noticed >= 0.97 * total
