"""Every language that is here compiles without a warning, runs its vectors, and notices a corrupted operator."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from navsym.export.languages.targets import TARGETS, answering
from navsym.export.package import Order, files_of
from navsym.export.ready import READY
from navsym.export.roundtrip import run_target
from tests.export import corruption, samples

HERE = [name for name, target in TARGETS.items() if target.executable() is not None]
QUICK = [name for name in HERE if name in ("c", "python", "javascript")]
SLOW = [name for name in HERE if name not in (*QUICK, "casadi", "wasm", "html")]


def exported(functions, language: str, folder: Path, count: int = 16) -> Path:
    for name, text in files_of(functions, Order((TARGETS[language],), count=count)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder / language


@pytest.mark.parametrize("language", HERE)
def test_all_samples_stay_inside_their_enclosures(language: str, tmp_path: Path) -> None:
    outcome = run_target(exported(samples.functions(), language, tmp_path), TARGETS[language])
    assert outcome.status == "verified", outcome.why
    assert all(wrong == 0 for _, wrong, _ in outcome.functions.values())
    assert len(outcome.functions) == len(samples.functions())


@pytest.mark.parametrize(
    "language",
    [pytest.param(n, marks=[] if n == "c" else pytest.mark.slow) for n in HERE if "float" in TARGETS[n].reals],
)
def test_single_precision_stays_inside_its_enclosures(language: str, tmp_path: Path) -> None:
    outcome = run_target(exported(samples.functions("float"), language, tmp_path), TARGETS[language])
    assert outcome.status == "verified", outcome.why


@pytest.mark.skipif("c" not in HERE, reason="needs a C compiler")
def test_sanitizers_find_nothing_in_the_c_code(tmp_path: Path) -> None:
    compile_step, run_step = TARGETS["c"].steps
    watched = compile_step.replace("{tool}", "{tool} -fsanitize=address,undefined -fno-sanitize-recover=all")
    target = replace(TARGETS["c"], steps=(watched, run_step))
    outcome = run_target(exported(samples.functions(), "c", tmp_path), target)
    assert outcome.status == "verified", outcome.why


def test_a_language_without_its_tool_is_not_called_verified(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    outcome = run_target(exported([samples.by_name("versine")], "rust", tmp_path), TARGETS["rust"])
    assert outcome.status == "not executed"


# -- corruption ---------------------------------------


@pytest.mark.parametrize("language", QUICK)
def test_every_corrupted_operator_is_caught(language: str, tmp_path: Path) -> None:
    for name in ("Phi33",) if language == "python" else ("Phi33", "versine"):
        tried, left = corruption.survivors(samples.by_name(name), language, tmp_path / name)
        assert tried >= 3 and not left, left


@pytest.mark.slow
@pytest.mark.parametrize("language", QUICK + SLOW)
def test_every_corrupted_operator_of_every_sample_is_caught(language: str, tmp_path: Path) -> None:
    for function in samples.functions():
        _, left = corruption.survivors(function, language, tmp_path / function.name)
        assert not left, left


@pytest.mark.slow
@pytest.mark.parametrize("language", QUICK + SLOW)
def test_a_corrupted_operator_of_every_ready_made_function_is_caught(language: str, tmp_path: Path) -> None:
    assert not corruption.campaign(list(READY), [language], 1, tmp_path)["left"]


@pytest.mark.long
@pytest.mark.parametrize("name", ["trajectory", "earth"])
def test_a_corrupted_operator_of_ready_made_code_is_caught(name: str, tmp_path: Path) -> None:
    found = corruption.campaign([name], [n for n in QUICK if n != "c"], 1, tmp_path)
    assert found["tried"] and not found["left"]


@pytest.mark.slow
@pytest.mark.parametrize("real", ["double", "float"])
def test_a_hundred_thousand_points_lie_inside_their_enclosures(real: str, tmp_path: Path) -> None:
    function = samples.by_name("Phi33", real)
    outcome = run_target(exported([function], "c", tmp_path, 100_000), TARGETS["c"])
    assert outcome.status == "verified", outcome.why
    assert outcome.functions[function.name][0] >= 100_000


def test_a_stub_that_cannot_answer_is_not_a_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stub = tmp_path / "rustc-stub"
    stub.write_text("#!/bin/sh\nexit 1\n")
    stub.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    assert answering("rustc-stub") is None
    assert answering("no-such-program-at-all") is None
