"""A stateful step is the filter of the textbook: init once, step by step, refused measurements change nothing."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from navsym.cli.export import function_for
from navsym.export.c import files
from navsym.numeric.kalman import correct, predict

PROGRAM = """#include "trajectory_filter_state.h"
#include <math.h>
#include <stdio.h>

int main(void)
{
    trajectory_filter_state s;
    double z;
    if (trajectory_filter_init(&s, NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0) != NAVSYM_DOMAIN) { return 1; }
    if (trajectory_filter_init(&s, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 3.0, 0.0, 2.0) != NAVSYM_OK) { return 2; }
    while (scanf("%lf", &z) == 1) {
        const navsym_status status = trajectory_filter_step(&s, 0.25, 0.125, 0.0625, 0.5, z);
        if (isnan(z) ? (status != NAVSYM_DOMAIN) : (status != NAVSYM_OK)) { return 3; }
        printf("%.17g %.17g %.17g %.17g %.17g\\n", s.f1, s.f2, s.f3, s.p11, s.p33);
    }
    return 0;
}
"""


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs a C compiler")
def test_the_exported_filter_follows_the_textbook(tmp_path: Path) -> None:
    function = function_for("trajectory-filter", "double", False)
    made = files([function], {function.name: []}, "SPDX-License-Identifier: Apache-2.0")
    for name, text in made.items():
        if not name.startswith("test_"):
            (tmp_path / name).write_text(text)
    (tmp_path / "main.c").write_text(PROGRAM)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]
    subprocess.run(["gcc", *flags, "trajectory_filter.c", "main.c", "-o", "run", "-lm"], cwd=tmp_path, check=True)
    measurements = [*np.sin(np.arange(12.0)), np.nan, 0.5]
    text = " ".join(map(repr, map(float, measurements)))
    done = subprocess.run([str(tmp_path / "run")], input=text, capture_output=True, text=True, check=True)
    rows = [[float(x) for x in line.split()] for line in done.stdout.splitlines()]
    assert len(rows) == len(measurements)
    np.testing.assert_allclose(rows, textbook(measurements), rtol=1e-12, atol=1e-13)


def textbook(measurements: list[float]) -> list[list[float]]:
    """The same filter by the house's own Kalman step: Phi of Pascal's triangle, the first state is measured."""
    F = np.array([[1.0, 1.0, 1.0], [0.0, 1.0, 2.0], [0.0, 0.0, 1.0]])
    Q, H, R = np.diag([0.25, 0.125, 0.0625]), np.array([[1.0, 0.0, 0.0]]), np.array([[0.5]])
    mean, P, rows = np.zeros(3), np.diag([4.0, 3.0, 2.0]), []
    for z in measurements:
        if not np.isnan(z):
            mean, P = predict(mean, P, F, Q)
            mean, P, _ = correct(mean, P, np.array([z]), H, R)
        rows.append([*mean, P[0, 0], P[2, 2]])
    return rows


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs a C compiler")
def test_the_benchmark_runs_at_a_tiny_size() -> None:
    path = Path(__file__).resolve().parents[1] / "benchmarks" / "export.py"
    spec = importlib.util.spec_from_file_location("benchmark_export", path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert set(module.measure(1000)) == {"hand-written C", "casadi C", "lambdify(cse=True)"}
