"""What verbs print: one document, plain or drawn tables, files written whole."""

from __future__ import annotations

import io
import json
import os
import shlex
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from navsym.cli import output
from navsym.cli.output import OutputError, Told, dumps, plain_table, put, table, visible, write_text

ROOT = Path(__file__).resolve().parents[2]

# Documents


def test_a_document_is_one_line_of_text_per_key_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    assert Told({"a": [1, 2.5, None, True], "σ": "ё"}, "never", 3).print(as_json=True) == 3
    assert json.loads(capsys.readouterr().out) == {"a": [1, 2.5, None, True], "σ": "ё"}


def test_the_text_is_only_made_when_it_is_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    def explode() -> str:
        raise AssertionError("called")

    Told(dict, explode).print(as_json=True)
    Told(explode, lambda: "shown").print(as_json=False)
    Told({}, "").print(as_json=False)
    assert capsys.readouterr().out == "{}\nshown\n"


@pytest.mark.parametrize("value", [float("nan"), float("inf"), np.float64("nan"), np.array([1.0, np.inf])])
def test_a_document_never_holds_nan_or_infinity(value: object) -> None:
    with pytest.raises(ValueError, match="JSON"):
        dumps({"x": value})


def test_arrays_and_their_scalars_become_lists_and_numbers() -> None:
    document = {"m": np.eye(2), "n": np.int64(3), "x": np.float64(0.5), "b": np.bool_(True)}
    assert json.loads(dumps(document)) == {"m": [[1.0, 0.0], [0.0, 1.0]], "n": 3, "x": 0.5, "b": True}


def test_what_is_not_plain_data_is_refused() -> None:
    with pytest.raises(TypeError, match="object is not plain data"):
        dumps({"x": object()})


def test_lone_surrogates_of_file_names_do_not_break_the_output() -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    put("a\udcffσ", stream)
    assert stream.buffer.getvalue() == "a?σ".encode()  # type: ignore[attr-defined]


def test_a_files_words_cannot_steer_the_terminal() -> None:
    assert visible("a\x1b[2Jb\rc\x9bd\nσ") == "a\\x1b[2Jb\\rc\\x9bd\nσ"


# Tables


def test_plain_columns_are_aligned() -> None:
    text = plain_table(["name", "n"], [["a", "1"], ["long name", "20"]], "Title", frozenset({"n"}))
    assert text.splitlines() == ["Title", "name        n", "---------  --", "a           1", "long name  20"]


def test_an_empty_table_has_its_headings() -> None:
    assert table(["a", "b"], []).splitlines() == ["a  b", "-  -"]


def test_cells_stay_on_their_line() -> None:
    assert len(table(["a"], [["x\ny"], ["[bold]z"]]).splitlines()) == 4


def test_a_row_of_the_wrong_length_is_a_defect() -> None:
    with pytest.raises(ValueError, match="zip"):
        table(["a", "b"], [["only one"]])


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("environment", "coloured"),
    [({}, True), ({"NO_COLOR": "1"}, False), ({"NO_COLOR": ""}, True), ({"TERM": "dumb"}, False)],
)
def test_colour_is_for_terminals_that_want_it(
    monkeypatch: pytest.MonkeyPatch, environment: dict[str, str], coloured: bool
) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert output.wants_colour(Terminal()) is coloured
    assert output.wants_colour(io.StringIO()) is False


def test_a_drawn_table_shows_brackets_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output, "wants_colour", lambda: True)
    text = table(["what", "status"], [["[bold]x[/bold]", "PROVED"]], title="[red]t")
    assert "[bold]x[/bold]" in text and "PROVED" in text and "[red]t" in text


# Files


def test_a_file_is_written_whole(tmp_path: Path) -> None:
    path = tmp_path / "σ.txt"
    write_text(path, "one\n")
    write_text(path, "два\n")
    assert path.read_bytes() == "два\n".encode()
    assert os.listdir(tmp_path) == ["σ.txt"]


def test_a_file_that_fails_half_way_leaves_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="No space left on device"):
        write_text(path, "new")
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["a.txt"]


def test_a_missing_folder_is_said_with_the_path(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="got 'No such file or directory'") as caught:
        write_text(tmp_path / "no" / "a.txt", "x")
    assert caught.value.kind == "output" and caught.value.where.endswith("a.txt")


@pytest.mark.skipif(os.name == "nt", reason="POSIX permissions")
def test_permissions_are_those_of_a_new_file_or_of_the_old_one(tmp_path: Path) -> None:
    mask = os.umask(0o022)
    try:
        write_text(tmp_path / "new", "x")
        (tmp_path / "old").write_text("")
        (tmp_path / "old").chmod(0o640)
        write_text(tmp_path / "old", "x")
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o644
    assert stat.S_IMODE((tmp_path / "old").stat().st_mode) == 0o640


@pytest.mark.skipif(os.name == "nt", reason="POSIX links and devices")
def test_a_link_is_followed_and_a_device_is_written_to(tmp_path: Path) -> None:
    (tmp_path / "target").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "target")
    write_text(tmp_path / "link", "new")
    write_text(os.devnull, "gone")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "target").read_text() == "new"


SHOW = [sys.executable, "-m", "navsym", "cite", "guaranteed_velocity:4.3.u2"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("options", [[], ["--json"]], ids=["text", "json"])
@pytest.mark.parametrize("redirection", [">/dev/full", ">&-"])
def test_an_output_that_is_full_or_closed_is_one_line_on_standard_error(options, redirection):
    line = shlex.join([*SHOW, *options]) + " " + redirection
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run(
        ["sh", "-c", line], cwd=ROOT, env=buffered, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1 and done.stderr.startswith("navsym: output: standard output: expected")


def test_text_for_people_keeps_no_control_character_but_the_colours_of_a_terminal(monkeypatch, capsys) -> None:
    text = "title \x1b[31mred\x1b]0;window\x07 \u202eleft"
    Told({}, text).print(as_json=False)
    assert capsys.readouterr().out == "title \\x1b[31mred\\x1b]0;window\\x07 \\u202eleft\n"
    monkeypatch.setattr("navsym.cli.output.wants_colour", lambda: True)
    Told({}, text).print(as_json=False)
    assert capsys.readouterr().out == "title \x1b[31mred\\x1b]0;window\\x07 \\u202eleft\n"
