"""The command line: verbs are found, statuses are kept, and every error is one line or one document."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from navsym import __version__
from navsym.cli import _options, main

VERB = '''
    """Count things that are there."""
    import os
    import typer
    from navsym.cli.output import Told
    from navsym.core.errors import MissingEngineError, ShapeError

    def deeper(n):                        # without defaults: 3.13.0 forgets to count calls that use them
        return deeper(n + 1)

    def command(what: str, *, times: int = 1) -> Told:
        """Count."""
        if what == "shape":
            raise ShapeError("expected 2 rows; got 3; drop one", where="a.toml: F")
        if what == "engine":
            raise MissingEngineError("expected node; got none; install it")
        if what == "absent":
            import no_such_engine
        if what == "ours":
            import navsym.no_such_room
        if what == "defect":
            raise KeyError("x\\n\\x1b[31my")
        if what == "nan":
            Told({"x": float("nan")}, "").print(as_json=True)
        if what == "deep":
            return deeper(0)
        if what == "cut":
            raise EOFError("marshal data too short")
        if what == "interrupt":
            raise KeyboardInterrupt
        if what == "pipe":
            raise BrokenPipeError
        if what == "exit":
            raise typer.Exit(1)
        if what == "differs":
            return Told({}, "", 1)
        return Told({"what": what, "times": times}, lambda: what * times)
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of verbs of our own, searched instead of the real one."""
    import navsym.cli

    (tmp_path / "count_things.py").write_text(textwrap.dedent(VERB))
    monkeypatch.setattr(main, "FOLDER", tmp_path)
    monkeypatch.setattr(navsym.cli, "__path__", [str(tmp_path)])
    table = {"all": {"what": "words", "times": "how often", "json": "print one JSON document"}}
    monkeypatch.setattr(_options, "read_table", lambda: table)
    monkeypatch.delitem(sys.modules, "navsym.cli.count_things", raising=False)
    return tmp_path


def run(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of one command line."""
    capsys.readouterr()
    status = main.run(words)
    captured = capsys.readouterr()
    return status, captured.out, captured.err


# Finding verbs


def test_a_verb_is_a_file_and_its_help_line_the_first_line_of_it(folder: Path) -> None:
    (folder / "_private.py").write_text('"""No verb."""')
    (folder / "main.py").write_text('"""No verb either."""')
    assert list(main.verbs()) == ["count-things"]
    assert "count-things  Count things that are there." in main.overview()


def test_the_help_does_not_run_the_files_that_it_reads(folder: Path) -> None:
    (folder / "loud.py").write_text('"""Loud."""\nraise SystemExit("executed")')
    (folder / "broken.py").write_text("def (")
    assert "loud          Loud." in main.overview()
    assert "broken        (no description)" in main.overview()


def test_without_a_verb_the_help_is_printed_with_status_2(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys)[0] == 2
    status, out, err = run(capsys, "--help")
    assert status == 0 and out.startswith("usage: navsym VERB") and err == ""


def test_the_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "-V") == run(capsys, "--version") == (0, f"navsym {__version__}\n", "")


def test_every_real_verb_has_a_help_line_and_a_command() -> None:
    for verb, path in main.verbs().items():
        assert main.help_line(path) != "(no description)", verb
        assert "def command(" in path.read_text(encoding="utf-8"), verb


def test_the_readme_lists_every_verb_and_no_other() -> None:
    text = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\| `([a-z-]+)", text.split("## Verbs")[1].split("##")[0], flags=re.M))
    assert listed == set(main.verbs())


def test_a_verb_runs_with_its_options(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "count-things", "ab", "--times", "2") == (0, "abab\n", "")
    status, out, err = run(capsys, "count-things", "ab", "--json")
    assert (status, json.loads(out), err) == (0, {"what": "ab", "times": 1}, "")


def test_a_verb_has_help_of_its_own(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = run(capsys, "count-things", "--help")
    assert status == 0 and "navsym count-things" in out and "--times" in out


@pytest.mark.parametrize("word", ["differs", "exit"])
def test_a_verb_returns_its_status(folder: Path, capsys: pytest.CaptureFixture[str], word: str) -> None:
    assert run(capsys, "count-things", word)[0] == 1


# Errors

ERRORS = [
    (["count-things", "shape"], 2, "shape", "a.toml: F", "expected 2 rows; got 3; drop one"),
    (["count-things", "engine"], 3, "missing", "", "expected node"),
    (["count-things", "absent"], 3, "missing", "", "expected the Python package no_such_engine"),
    (["count-things", "ours"], 1, "internal", "", "NAVSYM_DEBUG=1"),
    (["count-things", "defect"], 1, "internal", "", "got KeyError"),
    (["count-things", "nan"], 1, "internal", "", "got ValueError"),
    (["count-things", "deep"], 1, "internal", "", "got RecursionError"),
    (["count-things", "cut"], 1, "internal", "", "got EndOfFile: marshal data too short"),
    (["count-things"], 2, "syntax", "command line", "got nothing after the verb"),
    (["count-things", "a", "b"], 2, "syntax", "command line", "got a b"),
    (["count-things", "a", "--times", "x"], 2, "syntax", "command line", "got a --times x"),
    (["count-things", "a", "--bad"], 2, "syntax", "command line", "; see navsym count-things --help"),
    (["count-thing", "a"], 2, "syntax", "command line", "did you mean count-things?"),
    (["--bad"], 2, "syntax", "command line", "got --bad"),
    (["../main"], 2, "syntax", "command line", "got ../main"),
]


@pytest.mark.parametrize(("words", "status", "kind", "where", "message"), ERRORS)
def test_an_error_is_one_line_on_standard_error(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], status: int, kind: str, where: str, message: str
) -> None:
    got, out, err = run(capsys, *words)
    assert (got, out) == (status, "")
    assert err.startswith(": ".join(filter(None, ["navsym", kind, where]))) and message in err
    assert err.count("\n") == 1 and "Traceback" not in err and "\x1b" not in err


@pytest.mark.parametrize(("words", "status", "kind", "where", "message"), ERRORS)
def test_with_json_an_error_is_the_one_document_on_standard_output(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], status: int, kind: str, where: str, message: str
) -> None:
    got, out, err = run(capsys, *words, "--json")
    error = json.loads(out)["error"]
    assert (got, err) == (status, "")
    assert (error["kind"], error["where"]) == (kind, where) and set(error) == {"kind", "where", "message"}
    assert error["message"].startswith("expected ") and "; got " in error["message"]
    if "--json" not in error["message"]:
        assert message in error["message"]


def test_the_debug_switch_shows_the_traceback(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NAVSYM_DEBUG", "1")
    status, out, err = run(capsys, "count-things", "defect", "--json")
    assert status == 1 and json.loads(out)["error"]["kind"] == "internal"
    assert "Traceback" in err


def test_an_interruption_is_one_line_and_status_130(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = "navsym: interrupted and nothing is kept: the same command starts again\n"
    assert run(capsys, "count-things", "interrupt") == (130, "", said)


def test_a_broken_pipe_inside_a_verb_is_silent(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(main, "silence_stdout", lambda: None)
    assert run(capsys, "count-things", "pipe") == (141, "", "")


# Whole processes


def navsym(*words: str, **options: object) -> subprocess.CompletedProcess[bytes]:
    """The program as a process."""
    command = [sys.executable, "-m", "navsym", *words]
    return subprocess.run(command, capture_output=True, timeout=120, **options)  # type: ignore[call-overload, no-any-return]


def test_the_module_and_the_console_script_are_the_same_program() -> None:
    import tomllib

    root = Path(__file__).resolve().parents[2]
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["scripts"]["navsym"] == "navsym.cli.main:main"
    assert navsym("--version").stdout.decode() == f"navsym {__version__}\n"


def test_output_is_utf_8_whatever_the_locale_says() -> None:
    env = {**os.environ, "LC_ALL": "C.UTF-8", "PYTHONIOENCODING": "ascii"}
    done = navsym("σ", "--json", env=env)
    assert done.returncode == 2 and "σ" in json.loads(done.stdout.decode("utf-8"))["error"]["message"]


def test_a_name_that_is_not_text_still_gives_one_document() -> None:
    done = navsym(os.fsdecode(b"\xff"), "--json")
    assert done.returncode == 2 and json.loads(done.stdout.decode("utf-8"))["error"]["kind"] == "syntax"


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="needs POSIX pipes")
def test_a_reader_that_goes_away_causes_no_noise() -> None:
    read, write = os.pipe()
    os.close(read)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "navsym", "--help"], stdout=write, stderr=subprocess.PIPE, check=False, timeout=120
        )
    finally:
        os.close(write)
    assert (done.returncode, done.stderr) == (141, b"")
