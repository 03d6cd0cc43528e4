"""The front door: every public name is documented, and the examples in its documentation run."""

from __future__ import annotations

import doctest
import inspect
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import navsym as nav

NAMES = [name for name in nav.__all__ if not name.startswith("__")]
#: Values rather than functions or classes: they have the documentation of their type.
VALUES = {"PROVED", "CERTIFIED", "CONFIRMED", "REFUTED", "OPEN"}
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
#: Names whose examples take several seconds of processor time.
LONG = {"Phases", "PhaseMap", "doctor"}


def documented(name: str) -> dict[str, Any]:
    """A public name with its public methods: what a reader of ``help`` sees."""
    value = getattr(nav, name)
    parts = {name: value}
    if inspect.isclass(value):
        parts |= {f"{name}.{key}": member for key, member in vars(value).items() if not key.startswith("_")}
    return {key: part for key, part in parts.items() if inspect.getdoc(part)}


def examples_of(name: str) -> list[doctest.DocTest]:
    """The examples in the documentation of a name and of its methods, each with ``nav`` at hand."""
    parser = doctest.DocTestParser()
    texts = {key: inspect.getdoc(part) or "" for key, part in documented(name).items()}
    tests = [
        parser.get_doctest(text, {"nav": nav, name: getattr(nav, name)}, key, None, 0) for key, text in texts.items()
    ]
    return [test for test in tests if test.examples]


def run(test: doctest.DocTest) -> str:
    """What failed, as doctest words it; empty when nothing did."""
    report: list[str] = []
    doctest.DocTestRunner(optionflags=FLAGS, verbose=False).run(test, out=report.append, clear_globs=False)
    return "".join(report)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.long] * (name in LONG)) for name in sorted(set(NAMES) - VALUES)]
)
def test_a_public_name_is_documented_with_an_example_that_runs(name: str, tmp_path: Path, monkeypatch: Any) -> None:
    assert inspect.getdoc(getattr(nav, name)), f"{name} has no documentation"
    found = examples_of(name)
    assert found, f"{name} has no example"
    root = Path(__file__).resolve().parents[1]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(root / "examples")
    assert not (failures := "".join(map(run, found))), failures


def test_the_first_session_runs() -> None:
    test = doctest.DocTestParser().get_doctest(nav.__doc__ or "", {"nav": nav}, "navsym", None, 0)
    assert test.examples and not (failures := run(test)), failures


def test_the_front_door_opens_without_an_engine() -> None:
    script = (
        "import sys, time; start = time.process_time(); import navsym; spent = time.process_time() - start;"
        "engines = {'sympy', 'numpy', 'flint', 'scipy', 'casadi', 'cvxpy', 'numba', 'typer', 'rich', 'matplotlib'};"
        "loaded = engines & set(sys.modules); assert not loaded, loaded; assert spent < 0.15, spent"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env={**os.environ})
    assert done.returncode == 0, done.stderr


def test_a_folder_of_the_same_name_does_not_hide_a_function() -> None:
    import navsym.claims.paper
    import navsym.export.folder
    import navsym.prove.ladder  # noqa: F401

    assert all(inspect.isfunction(getattr(nav, name)) for name in ("prove", "export", "claims", "report", "check"))
