"""Set-up: a fast start, an honest lock, and a bootstrap that survives what happens to checkouts."""

from __future__ import annotations

import ast
import importlib.util
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

import navsym

ROOT = Path(__file__).resolve().parents[1]
LOCK = (ROOT / "requirements.lock").read_text(encoding="utf-8")
EXTRA_LOCK = (ROOT / "requirements-extra.lock").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))

HEAVY = ["sympy", "flint", "numpy", "scipy", "casadi", "cvxpy", "osqp", "clarabel", "highspy", "numba"]
HEAVY += ["matplotlib", "jinja2", "typer", "dask", "jupytext", "IPython"]


# A fast start


def cpu_seconds(*words: str) -> float:
    """User and system time of one child process, the best of five."""
    return min(cpu_seconds_once(*words) for _ in range(5))


def cpu_seconds_once(*words: str) -> float:
    """User and system time of one child process that must succeed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *words], cwd=ROOT, stdout=subprocess.DEVNULL, check=True, timeout=60)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def loaded_by(code: str) -> set[str]:
    """Heavy modules that are in memory after some code has run in a fresh interpreter."""
    ask = f"import sys\n{code}\nprint('\\n' + ' '.join(m for m in {HEAVY!r} if m in sys.modules))"
    words = [sys.executable, "-c", ask]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True, timeout=60)
    return set(done.stdout.splitlines()[-1].split())


def test_importing_navsym_takes_at_most_0_15_seconds_of_cpu() -> None:
    assert cpu_seconds("-c", "import navsym") <= 0.15


def test_the_help_takes_at_most_half_a_second_of_cpu() -> None:
    assert cpu_seconds("-m", "navsym", "--help") <= 0.5


ROOMS = [f"navsym.{path.parent.name}" for path in sorted((ROOT / "navsym").glob("*/__init__.py"))]


@pytest.mark.parametrize("module", ["navsym", "navsym.core.errors", "navsym.cli.main", "navsym_papers", *ROOMS])
def test_an_import_loads_no_engine(module: str) -> None:
    assert loaded_by(f"import {module}") == set()


def test_the_help_loads_no_engine() -> None:
    assert loaded_by("from navsym.cli.main import run\nrun(['--help'])") == set()


# The lock


def lock_entries(lock: str = LOCK) -> dict[str, str]:
    """``name==version ; marker`` -> its block of hashes."""
    blocks = re.split(r"^(?=\S)", lock, flags=re.M)
    return {block.split("\\")[0].strip(): block for block in blocks if block.strip()}


def normal(name: str) -> str:
    """Distribution names are compared in lower case with ``-``."""
    return re.sub(r"[-_.]+", "-", re.split(r"[<>=!~;\[ ]", name)[0]).lower()


def locked(lock: str = LOCK) -> set[str]:
    """Names of all locked distributions."""
    return {normal(entry) for entry in lock_entries(lock)}


@pytest.mark.parametrize("lock", [LOCK, EXTRA_LOCK], ids=["packages", "extras"])
def test_every_line_of_the_lock_pins_one_version_and_its_hashes(lock: str) -> None:
    for entry, block in lock_entries(lock).items():
        assert re.match(r"[\w.-]+==[\w.]+( ;.*)?$", entry), entry
        assert re.findall(r"--hash=sha256:[0-9a-f]{64}\b", block), entry


@pytest.mark.parametrize("lock", [LOCK, EXTRA_LOCK], ids=["packages", "extras"])
def test_the_lock_names_no_host_and_no_path(lock: str) -> None:
    assert not re.search(r"://|@|--index|--find|file:|^-e|^/", lock, flags=re.M)


def test_the_lock_of_extras_holds_every_extra_and_disagrees_with_the_lock_nowhere() -> None:
    extras = PROJECT["project"]["optional-dependencies"]
    wanted = [name for extra in ("notebook", "docs", "cross", "maps", "units", "fuzz") for name in extras[extra]]
    assert {normal(name) for name in wanted} <= locked(EXTRA_LOCK)
    versions = {entry.split(" ;")[0] for entry in lock_entries()}
    shared = {entry.split(" ;")[0] for entry in lock_entries(EXTRA_LOCK) if normal(entry) in locked()}
    assert shared <= versions


def test_the_lock_holds_everything_that_bootstrap_installs() -> None:
    project = PROJECT["project"]
    extras = project["optional-dependencies"]
    wanted = [*project["dependencies"], *extras["test"], *extras["cluster"], *extras["build"]]
    assert {normal(name) for name in wanted} <= locked()


def test_the_lock_holds_the_build_backend() -> None:
    assert {normal(name) for name in PROJECT["build-system"]["requires"]} <= locked()


# One version everywhere


def test_the_wheel_installs_names_of_its_own_and_every_file_of_a_paper(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, cwd=ROOT, capture_output=True, check=True, timeout=300)
    (wheel,) = tmp_path.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {name.partition("/")[0] for name in names} == {"navsym", "navsym_papers", f"{wheel.stem[:12]}.dist-info"}
    papers = ROOT / "derivations"
    files = [path for path in papers.rglob("*") if path.suffix in (".py", ".toml", ".json", ".md")]
    assert {f"navsym_papers/{path.relative_to(papers).as_posix()}" for path in files} <= names


def test_the_citation_and_the_changelog_know_the_version() -> None:
    assert f"version: {navsym.__version__}" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"## [{navsym.__version__}]" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_ci_runs_the_test_command_of_the_readme() -> None:
    ci = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "python3 bootstrap.py test" in ci
    assert "python3 bootstrap.py test" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


# Bootstrap, without a network


@pytest.fixture
def bootstrap() -> ModuleType:
    spec = importlib.util.spec_from_file_location("bootstrap", ROOT / "bootstrap.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout with a space in its path and nothing but what bootstrap reads."""
    root = tmp_path / "a checkout"
    root.mkdir()
    for name in ("bootstrap.py", "pyproject.toml", "requirements.lock", "requirements-extra.lock"):
        shutil.copy(ROOT / name, root / name)
    return root


@pytest.fixture
def finished(bootstrap: ModuleType, checkout: Path) -> Path:
    """A complete environment as bootstrap leaves it, with a stand-in for the interpreter."""
    venv = checkout / ".venv"
    python = Path(bootstrap.python_of(str(venv)))
    python.parent.mkdir(parents=True)
    python.write_text("")
    (venv / bootstrap.MINE).write_text("")
    bootstrap.write_stamp(str(venv), bootstrap.wanted(str(checkout)))
    return venv


def test_bootstrap_uses_only_the_standard_library() -> None:
    tree = ast.parse((ROOT / "bootstrap.py").read_text(encoding="utf-8"))
    names = {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
    assert names <= sys.stdlib_module_names
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]


def test_bootstrap_is_readable_for_an_old_python_that_it_refuses() -> None:
    ast.parse((ROOT / "bootstrap.py").read_text(encoding="utf-8"), feature_version=(3, 6))


@pytest.mark.parametrize("version", [(3, 6), (3, 10), (3, 14), (4, 0)])
def test_other_pythons_are_refused_with_advice(bootstrap: ModuleType, version: tuple[int, int]) -> None:
    message = bootstrap.refusal(version)
    assert f"got {version[0]}.{version[1]};" in message and "expected Python 3.11, 3.12 or 3.13" in message


@pytest.mark.parametrize("version", [(3, 11), (3, 12), (3, 13)])
def test_supported_pythons_are_accepted(bootstrap: ModuleType, version: tuple[int, int]) -> None:
    assert bootstrap.refusal(version) is None
    assert PROJECT["project"]["requires-python"] == ">=3.11,<3.14"


def state(bootstrap: ModuleType, venv: Path) -> str:
    """What bootstrap makes of an environment."""
    return str(bootstrap.state(str(venv), bootstrap.wanted(str(venv.parent))))


def test_a_finished_environment_is_used_at_once(bootstrap: ModuleType, finished: Path) -> None:
    assert state(bootstrap, finished) == "ready"
    assert bootstrap.prepare(str(finished.parent)) == bootstrap.python_of(str(finished))


def test_an_interrupted_run_starts_afresh(bootstrap: ModuleType, finished: Path) -> None:
    bootstrap.drop_stamp(str(finished))
    assert state(bootstrap, finished) == "absent" and bootstrap.is_ours(str(finished))


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"inputs": "x"}'])
def test_a_damaged_stamp_counts_as_none(bootstrap: ModuleType, finished: Path, text: str) -> None:
    (finished / bootstrap.STAMP).write_text(text)
    assert state(bootstrap, finished) == "absent"


def test_a_changed_lock_updates_in_place(bootstrap: ModuleType, finished: Path) -> None:
    with (finished.parent / "requirements.lock").open("a") as file:
        file.write("\n")
    assert state(bootstrap, finished) == "stale"


def test_extras_are_added_to_the_environment_that_is_there(
    bootstrap: ModuleType, finished: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps: list[list[str]] = []
    monkeypatch.setattr(bootstrap, "ROOT", str(finished.parent))
    monkeypatch.setattr(bootstrap, "run", lambda command, advice: steps.append(command))
    assert bootstrap.main(["extras"]) == 0
    assert [step[-2:] for step in steps] == [["-r", "requirements-extra.lock"]]
    assert steps[0][0] == bootstrap.python_of(str(finished)) and "--require-hashes" in steps[0]


def test_a_moved_checkout_makes_its_environment_again(bootstrap: ModuleType, finished: Path) -> None:
    moved = finished.parent.with_name("moved")
    finished.parent.rename(moved)
    assert state(bootstrap, moved / ".venv") == "absent"


def test_another_python_makes_the_environment_again(bootstrap: ModuleType, finished: Path) -> None:
    stamp = {**bootstrap.wanted(str(finished.parent)), "python": "3.12.0 elsewhere"}
    bootstrap.write_stamp(str(finished), stamp)
    assert state(bootstrap, finished) == "absent"


def test_a_missing_interpreter_makes_the_environment_again(bootstrap: ModuleType, finished: Path) -> None:
    Path(bootstrap.python_of(str(finished))).unlink()
    assert state(bootstrap, finished) == "absent"


def test_somebody_elses_environment_is_left_alone(bootstrap: ModuleType, checkout: Path) -> None:
    foreign = checkout / ".venv"
    (foreign / "bin").mkdir(parents=True)
    assert not bootstrap.is_ours(str(foreign))
    assert bootstrap.choose(str(checkout)) == str(checkout / ".venv-navsym")


def test_a_link_to_an_environment_is_left_alone(bootstrap: ModuleType, finished: Path, tmp_path: Path) -> None:
    link = tmp_path / ".venv"
    link.symlink_to(finished)
    assert not bootstrap.is_ours(str(link))


def test_the_stamp_is_written_last(bootstrap: ModuleType, checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(venv: str) -> None:
        raise bootstrap.Trouble("no network")

    monkeypatch.setattr(bootstrap, "install", stop)
    monkeypatch.setattr(bootstrap, "run", lambda command, advice: None)
    with pytest.raises(bootstrap.Trouble, match="no network"):
        bootstrap.prepare(str(checkout))
    assert (checkout / ".venv" / bootstrap.MINE).exists()
    assert not (checkout / ".venv" / bootstrap.STAMP).exists()


def test_verbs_and_their_arguments_are_passed_on_unchanged(bootstrap: ModuleType) -> None:
    assert bootstrap.command_for("py", ["test", "-k", "a b"]) == ["py", "-m", "pytest", "-k", "a b"]
    assert bootstrap.command_for("py", ["test"])[:3] == ["py", "-m", "pytest"]
    words = ["solve", "my file.toml", "--json"]
    assert bootstrap.command_for("py", words) == ["py", "-P", "-m", "navsym", *words]


def test_settings_that_lead_pip_astray_are_dropped(bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {"PIP_USER": "1", "PYTHONPATH": "x", "PIP_INDEX_URL": "kept"}.items():
        monkeypatch.setenv(name, value)
    environment = bootstrap.quiet_environment()
    assert not {"PIP_USER", "PYTHONPATH"} & set(environment)
    assert environment["PIP_INDEX_URL"] == "kept" and environment["PIP_DISABLE_PIP_VERSION_CHECK"] == "1"


def test_trouble_is_one_document_and_status_3(
    bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stop(root: str) -> str:
        raise bootstrap.Trouble("no network; do this")

    monkeypatch.setattr(bootstrap, "prepare", stop)
    assert bootstrap.main(["verify", "--json"]) == 3
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "missing" and error["message"] == "no network; do this"


def test_a_failing_step_shows_its_last_lines_and_the_advice(
    bootstrap: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(bootstrap.Trouble, match="do that"):
        bootstrap.run([sys.executable, "-c", "print('first'); raise SystemExit('last')"], "do that")
    assert "last" in capsys.readouterr().err
