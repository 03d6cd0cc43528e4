"""Error models of source code: F, G, H, reset or a transition are read by audit and handed to conventions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import navsym as nav
from navsym.cli.main import run

EXAMPLE = Path(__file__).parents[2] / "examples" / "error_model.toml"
ROLES = {
    "position": ["p1", "p2", "p3"],
    "velocity": ["v1", "v2", "v3"],
    "attitude": ["t1", "t2", "t3"],
    "accelerometer_bias": ["a1", "a2", "a3"],
    "gyro_bias": ["g1", "g2", "g3"],
}
PYTHON = """
import numpy as np
def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
def transition(C, a, w, dt, late):
    F = np.eye(15)
    F[0:3, 3:6] = np.eye(3) * dt
    F[3:6, 6:9] = -C @ skew(a) * dt
    F[3:6, 9:12] = -C * dt
    F[6:9, 6:9] = np.eye(3) - skew(w) * dt
    F[6:9, 12:15] = -np.eye(3) * dt
    return F
"""


def coded(folder: Path, text: str = PYTHON, **model: Any) -> dict[str, Any]:
    """A document about a Python source in a folder."""
    (folder / "filter.py").write_text(text)
    symbols = {"C": {"matrix": [3, 3]}, "a": {"vector": 3}, "w": {"vector": 3}, "dt": "positive"}
    block = {"name": "kf", "file": str(folder / "filter.py"), "function": "transition", "symbols": symbols}
    return {
        "code": [block],
        "model": {"states": [name for names in ROLES.values() for name in names], **model},
        "roles": ROLES,
        "quantities": {"rotation": "kf:C", "specific_force_body": "kf:a", "angular_rate": ["w[0]", "w[1]", "w[2]"]},
        "known": {"frame": "inertial", "error": "estimate - truth"},
    }


def test_the_block_of_the_code_that_must_change_is_named_with_its_line(capsys):
    answer = nav.conventions(EXAMPLE)
    (conflict,) = answer.conflicts
    line = next(
        k for k, text in enumerate(EXAMPLE.with_suffix(".c").read_text().split("\n"), 1) if "F[i][9 + j]" in text
    )
    assert (conflict.block, conflict.status) == (("velocity", "accelerometer_bias"), "PROVED")
    assert [place.rpartition("/")[2] for place in conflict.places] == [f"error_model.c:{line}"]
    assert "-C[0][0]" in conflict.change and answer.document()["conflicts"][0]["places"]
    assert run(["conventions", str(EXAMPLE)]) == 1
    assert f"error_model.c:{line}" in capsys.readouterr().out


def test_the_mended_code_has_a_card(tmp_path):
    source = EXAMPLE.with_suffix(".c").read_text().replace("F[i][9 + j] = C[i][j]", "F[i][9 + j] = -C[i][j]")
    (tmp_path / "error_model.c").write_text(source)
    file = tmp_path / "model.toml"
    file.write_text(EXAMPLE.read_text())
    (card,) = nav.conventions(file).cards
    assert (card.attitude_error, card.rotation_sign, card.bias_sign) == ("frame", "-", "estimate - truth")


def test_of_a_transition_the_slope_at_a_step_of_zero_is_taken(tmp_path):
    answer = nav.conventions(coded(tmp_path, Phi="kf:return", step="dt"))
    assert answer.complete and [(c.attitude_error, c.rotation_sign) for c in answer.cards] == [("body", "+")]
    again = nav.conventions(coded(tmp_path, PYTHON.replace("-skew(w)", "+skew(w)").replace("- skew(w)", "+ skew(w)"),
                                  Phi="kf:return", step="dt"))  # fmt: skip
    assert [c.block for c in again.conflicts] == [("attitude", "attitude")]


CASES = PYTHON.replace("    return F", "    if late > 0:\n        F[3:6, 9:12] = C * dt\n    return F")


@pytest.mark.parametrize(
    ("text", "model", "kind", "named"),
    [
        (PYTHON, {"Phi": "kf:return"}, "empty", "step"),
        (PYTHON.replace("np.eye(15)", "2*np.eye(15)"), {"Phi": "kf:return", "step": "dt"}, "domain", "unit matrix"),
        (PYTHON, {"Phi": "kf:return", "step": "1/10"}, "domain", "input as step"),
        (PYTHON, {"F": "kf:G"}, "unknown-symbol", "G"),
        (PYTHON, {"F": "ekf:return"}, "unknown-symbol", "ekf"),
        (PYTHON, {"F": "kf:return", "Phi": "kf:return", "step": "dt"}, "duplicate", "both"),
        (PYTHON, {"F": 3}, "shape", "expected"),
        (CASES, {"Phi": "kf:return", "step": "dt"}, "domain", "late > 0"),
        (PYTHON.replace("return F", "return load(F)"), {"F": "kf:return"}, "domain", "not read"),
    ],
)
def test_code_that_gives_no_matrix_is_refused_with_its_reason(tmp_path, text, model, kind, named):
    with pytest.raises(nav.NavsymError) as caught:
        nav.conventions(coded(tmp_path, text, **model))
    assert caught.value.kind == kind and named in str(caught.value) and "\n" not in str(caught.value)
