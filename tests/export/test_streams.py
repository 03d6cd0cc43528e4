"""A guard as code: the C and its twin do the same, their bounds hold for the doubles that they return."""

from __future__ import annotations

import json
import random
import subprocess
from fractions import Fraction

import numpy as np
import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.export.streams import Rule


def chain(n):
    """x_i' = x_(i+1)."""
    return [["1" if j == i + 1 else "0" for j in range(n)] for i in range(n)]


OSCILLATOR = [["0", "1"], ["-1", "0"]]


def guard_of(F, H, sigma, memory, step, **options):
    """A guard of the last state."""
    states = " ".join(f"x{k}" for k in range(len(F)))
    return nav.Guard(
        nav.Model(states, F, H, sigma, targets={"goal": f"x{len(F) - 1}"}), memory=memory, step=step, **options
    )


def twin(guard):
    return Rule(guard).twin


def stream(count, sensors, seed=1):
    """Measurements with gaps and bounds that change."""
    generator = random.Random(seed)
    for _ in range(count):
        z = [generator.uniform(-3, 3) if generator.random() < 0.7 else None for _ in range(sensors)]
        yield z, [generator.choice((0.5, 1.0, 3.0)) for _ in range(sensors)]


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """A guard and its folder."""
    out = tmp_path_factory.mktemp("guard") / "code"
    guard = guard_of(OSCILLATOR, ["x0", "x1"], ["1", "1/3"], 12, "1/4")
    return guard, out, nav.export(guard, ["c", "cpp", "python"], out, vectors=20)


def test_a_guard_is_exported_compiled_and_replayed(exported):
    _, out, answer = exported
    assert [outcome.status for outcome in answer.outcomes] == ["verified"] * 3
    assert (
        all(row.status == "ACCEPTED" for row in nav.check(out))
        and "12 epochs" in (out / "c" / "model_goal_guard.h").read_text()
    )
    assert nav.Guard.load(out / "guard.json").length == 12


def test_no_memory_is_allocated(exported):
    source = (exported[1] / "c" / "model_goal_guard.c").read_text()
    assert not any(word in source for word in ("malloc", "calloc", "alloca", "free(")) and "nv_table" in source


PROGRAM = r"""
#define _POSIX_C_SOURCE 199309L
#include "model_goal_guard.h"
#include <stdio.h>
#include <string.h>
#include <time.h>
int main(void)
{
    static model_goal_guard_state state;
    double in[4], out[5];
    model_goal_guard_start(&state);
    while (fread(in, sizeof in, 1, stdin) == 1) {
        model_goal_guard_estimate e = {0.0, 0.0, 0.0};
        struct timespec start, end;
        clock_gettime(CLOCK_MONOTONIC, &start);
        out[0] = (double)model_goal_guard_step(&state, in, in + 2, &e);
        clock_gettime(CLOCK_MONOTONIC, &end);
        out[1] = e.estimate; out[2] = e.radius; out[3] = e.least;
        out[4] = (double)(end.tv_sec - start.tv_sec) * 1e6 + (double)(end.tv_nsec - start.tv_nsec) * 1e-3;
        fwrite(out, sizeof out, 1, stdout);
    }
    FILE *status = fopen("/proc/self/status", "r"); /* Linux: the largest memory so far */
    char line[128];
    while (status != NULL && fgets(line, (int)sizeof line, status) != NULL)
        if (strncmp(line, "VmHWM:", 6) == 0)
            fputs(line + 6, stderr);
    return 0;
}
"""


def stream_in_c(guard, code, count, folder, compared=None):
    """Rows of (status, estimate, radius, least, microseconds), and the largest memory of the program in kB.

    The first ``compared`` rows are those of the twin bit for bit; all where it is left out.
    """
    (folder / "program.c").write_text(PROGRAM)
    command = ["gcc", "-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-pedantic", f"-I{code}"]
    subprocess.run([*command, "program.c", f"{code}/model_goal_guard.c", "-o", "run", "-lm"], cwd=folder, check=True)
    given = np.array([[*z, *sigma] for z, sigma in stream(count, 2)], dtype=float)  # None is NaN
    done = subprocess.run([folder / "run"], input=given.tobytes(), capture_output=True, check=True)
    rule, rows = twin(guard), np.frombuffer(done.stdout).reshape(-1, 5)
    assert len(rows) == count
    for (z, sigma), (status, *numbers) in zip(stream(compared or count, 2), rows[:, :4].tolist(), strict=False):
        expected = rule.step(z, sigma)
        assert status == expected[0] and (status != 0 or numbers == list(expected[1:]))
    return rows, int((done.stderr.split() or [0])[0])


def test_the_c_and_its_twin_agree_bit_for_bit(exported, tmp_path):
    guard, out, _ = exported
    rows, _ = stream_in_c(guard, out / "c", 300, tmp_path)
    assert (rows[:, 0] == 0).sum() > 290


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_a_million_epochs_in_c_keep_their_gap_and_a_constant_memory(tmp_path):
    """Three unknowns, 16 epochs in memory, two measurements with gaps and bounds that change at random."""
    guard = guard_of(chain(3), ["x0", "x0 + x2"], ["1", "1/3"], 16, "1/2")
    nav.export(guard, "c", tmp_path / "code", vectors=20)
    rows, memory = stream_in_c(guard, tmp_path / "code" / "c", 1_000_000, tmp_path, 25_000)
    seen = rows[rows[:, 0] == 0]
    gap, median = ((seen[:, 2] - seen[:, 3]) / seen[:, 2]).max(), np.median(rows[:, 4])
    print(len(seen), f"{gap:.1e}", median, np.quantile(rows[:, 4], 0.99), memory)  # documented
    assert len(seen) > 999_000 and median < 20 and gap < 1e-12 and memory < 8_000


@pytest.mark.parametrize("F, H", [(chain(1), ["x0"]), (chain(3), ["x0", "x0 + x2"]), (OSCILLATOR, ["x0"])])
def test_the_bounds_enclose_the_radius_of_the_guard(F, H):
    guard, seen = guard_of(F, H, ["1"] * len(H), 9, "1/2"), 0
    rule, exact = twin(guard), guard_of(F, H, ["1"] * len(H), 9, "1/2", bound="variance")
    for z, sigma in stream(60, len(H)):
        status, _, radius, least = rule.step(z, sigma)
        known = exact.step(z, sigma={name: s for name, s in zip(exact.flow.names, sigma, strict=True)}).radius
        if status == 0:
            assert Fraction(least) <= Fraction(known.upper) and Fraction(radius) >= Fraction(known.lower)
            assert radius - least <= 1e-11 * radius
            seen += 1
    assert seen > 40


BALL = [["1", "-1/2"], ["-1/2", "1"]]
PLANE = [["0", "0", "1", "0"], ["0", "0", "0", "1"], ["0"] * 4, ["0"] * 4]


def guard_of_block(norm, shape=None, sensors=3, **options):
    """Positions in a plane whose errors are bounded together, beside one by itself; the target is a velocity."""
    block = {"measurements": "z1 z2", "norm": norm} | ({"shape": shape} if shape else {})
    H, sigma = ["x0", "x1", "x2 + x3"][:sensors], ["1", "2", "1/2"][:sensors]
    model = nav.Model("x0 x1 x2 x3", PLANE, H, sigma, targets={"goal": "x2 - x3"}, blocks=[block])
    return nav.Guard(model, memory=6, step="1/2", **options)


@pytest.mark.parametrize(("norm", "shape", "near"), [("l1", None, 1e-11), ("l2", None, 1e-9), ("l2", BALL, 1e-9)])
def test_the_bounds_of_a_block_enclose_the_radius_of_the_guard(norm, shape, near):
    rule, exact, seen = twin(guard_of_block(norm, shape)), guard_of_block(norm, shape), 0
    for z, sigma in stream(40, 3):
        small = [None if x is None else x / 20 for x in z]  # every state near zero explains it
        status, _, radius, least = rule.step(small, sigma)
        known = exact.step(small, sigma=sigma).radius
        if status == 0:
            assert Fraction(least) <= Fraction(known.upper) and Fraction(radius) >= Fraction(known.lower)
            assert radius - least <= near * radius
            seen += 1
    assert seen > 30


@pytest.mark.long
@pytest.mark.parametrize(("norm", "shape"), [("l1", None), ("l2", BALL)])
def test_a_block_is_exported_and_c_and_twin_agree_bit_for_bit(norm, shape, tmp_path):
    block = {"measurements": "z1 z2", "norm": norm} | ({"shape": shape} if shape else {})
    model = nav.Model("x0 x1 x2 x3", PLANE, ["x0", "x1"], ["1", "1/3"], targets={"goal": "x3"}, blocks=[block])
    guard = nav.Guard(model, memory=8, step="1/4")
    answer = nav.export(guard, ["c", "cpp", "python"], tmp_path / "code", vectors=10)
    assert [outcome.status for outcome in answer.outcomes] == ["verified"] * 3 and nav.check(tmp_path / "code").accepted
    rows, _ = stream_in_c(guard, tmp_path / "code" / "c", 60, tmp_path)
    assert (rows[:, 0] == 0).sum() > 50


def test_noise_on_the_edge_of_a_ball_is_within_the_radius():
    """The worst noise of the exact guard, in the rule: its error is not above the radius, and reaches it."""
    guard, rule, seen = guard_of_block("l2", BALL, 2, bound="variance"), twin(guard_of_block("l2", BALL, 2)), 0
    for _ in range(8):
        rule.step([0.0] * 2)
        worst = guard.step([0] * 2)
        noise = {(t, name): error for t, name, error in worst.worst_case()}
        replay = twin(guard_of_block("l2", BALL, 2))
        for lag in reversed(range(len(rule.epochs))):
            last = replay.step([noise.get((worst.t - lag / 2, f"z{j}"), 0.0) for j in (1, 2)])
        if last[0] == 0:
            assert last[2] * (1 - 1e-8) <= abs(last[1]) <= last[2]
            seen += 1
    assert seen > 5


def test_large_measurements_beside_small_bounds_cost_no_more_than_their_rounding():
    """z of a thousand and bounds from a thousandth to a hundred: rounding is a millionth of some bounds."""
    rule, generator, seen = twin(guard_of(chain(3), ["x0", "x0 + x2"], ["1", "1"], 9, "1/2")), random.Random(3), 0
    for _ in range(300):
        z = [generator.uniform(-1000, 1000) if generator.random() < 0.75 else None for _ in range(2)]
        status, _, radius, least = rule.step(z, [generator.choice((0.001, 0.5, 3.0, 100.0)) for _ in range(2)])
        assert status != 0 or radius - least <= 1e-6 * radius
        seen += status == 0
    assert seen > 290


def exact_errors(scale, sigma, drop=0.0):
    """(error, radius) in exact arithmetic of a polynomial of degree 4 seen through doubles; errors of at most sigma.

    drop : part of the radius that is left out
    """
    n, step = 5, Fraction(1, 8)
    rule = twin(guard_of(chain(n), ["x0"], [sigma], 20, step))
    generator = random.Random(3)
    state = [Fraction(generator.randint(-9, 9)) * scale for _ in range(n)]
    factorials = [1, 1, 2, 6, 24]
    bound = Fraction(rule.sigma[0])
    for k in range(60):
        t = k * step
        true = sum(x * t**i / factorials[i] for i, x in enumerate(state))
        z = float(true + bound * Fraction(generator.randint(-999, 999), 1000))
        near = abs(Fraction(z) - true) <= bound  # or no double is
        status, value, radius, _ = rule.step([z if near else None])
        if status == 0:
            yield abs(Fraction(value) - state[-1]), Fraction(radius) * Fraction(1 - drop)


def test_rounding_is_part_of_the_radius():
    errors = list(exact_errors(10**6, "1/100000000"))
    assert len(errors) > 20 and all(error <= radius for error, radius in errors)
    assert any(error > radius for error, radius in exact_errors(10**6, "1/100000000", drop=0.9999))


@pytest.mark.parametrize(
    "place, old, new",
    [
        ("test_main.c", "model_goal_guard_start(&state);", ""),
        ("model_goal_guard.c", "out->radius = (cost", "out->radius = (0.99 * cost"),
        ("model_goal_guard.c", "(value / f->ratio)", "value * 1.01"),
        ("model_goal_guard.c", "state->newest + 1) < NV_N", "state->newest + 2) < NV_N"),
        ("model_goal_guard.c", "best = k;", "best = 0;"),
        ("model_goal_guard.c", "*sure = root", "*sure = 0.5 * root"),
    ],
)
def test_spoiled_code_fails_on_its_vectors(exported, tmp_path, place, old, new):
    folder = exported[1] / "c"
    for file in folder.glob("*.[ch]"):
        text = file.read_text()
        (tmp_path / file.name).write_text(text.replace(old, new) if file.name == place else text)
    assert old in (folder / place).read_text()
    subprocess.run("gcc -std=c99 -O1 *.c -o run -lm", shell=True, cwd=tmp_path, check=True)
    done = subprocess.run([tmp_path / "run"], capture_output=True, text=True)
    assert done.returncode == 1 and " wrong 0 " not in done.stdout


def test_names_of_a_model_do_not_become_code(tmp_path):
    model = nav.Model("b", [["0"]], ["b"], targets={"b':*": "b"})
    answer = nav.export(nav.Guard(model, memory=2, step=1), ["c", "python"], tmp_path / "x", vectors=5)
    assert [outcome.status for outcome in answer.outcomes] == ["verified"] * 2
    assert (tmp_path / "x" / "c" / "model_b____guard.h").is_file()


@pytest.mark.parametrize(
    "options, words",
    [
        ({"memory": 5}, "no step"),
        ({"step": 1}, "no memory"),
        ({"memory": 5, "step": 1, "outliers": 1}, "outliers=1"),
        ({"memory": 1, "step": 1}, "longer memory"),
    ],
)
def test_what_has_no_rule_is_refused(options, words, tmp_path):
    guard = nav.Guard(nav.Model("x v", chain(2), ["x"], targets={"v": "v"}), **options)
    with pytest.raises(nav.NavsymError, match=words):
        nav.export(guard, "c", tmp_path / "x")
    assert not (tmp_path / "x").exists()


def test_regressors_of_time_and_other_languages_are_refused(tmp_path):
    basis = nav.Guard(nav.Model.from_basis(["1", "s"]), "c1", memory=5, step=1)
    with pytest.raises(nav.NavsymError, match="do not depend on time"):
        nav.export(basis, "c", tmp_path / "x")
    guard = guard_of(chain(1), ["x0"], "1", 3, 1)
    with pytest.raises(nav.NavsymError, match="rust"):
        nav.export(guard, "rust", tmp_path / "x")
    with pytest.raises(nav.NavsymError, match="float"):
        nav.export(guard, "c", tmp_path / "x", real="float")


def test_the_file_of_a_guard_is_exported_by_the_verb(tmp_path, capsys):
    guard_of(chain(2), ["x0"], "1", 6, "1/2").save(tmp_path / "guard.json")
    options = ["--to", "python", "--out", str(tmp_path / "code"), "--vectors", "6", "--json"]
    assert run(["export", str(tmp_path / "guard.json"), *options]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["languages"][0]["status"] == "verified" and document["functions"][0]["status"] == ["CERTIFIED"]
