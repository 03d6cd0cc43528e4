"""The commands that the README promises run as they stand there."""

from __future__ import annotations

import importlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from navsym.claims import equation_of
from navsym.cli import main
from navsym.verification.ledger import Ledger, records_about
from tests.report import devtools

ROOT = Path(__file__).resolve().parents[1]

#: Commands that end with another status than 0, by the verb.
STATUS = {"prove": 1}


def commands() -> list[list[str]]:
    """The command lines of the section "Ten minutes", without the bootstrap."""
    section = (ROOT / "README.md").read_text(encoding="utf-8").split("## Ten minutes")[1]
    block = re.search(r"```sh\n(.*?)```", section, re.S)
    assert block is not None
    lines = [line.partition(" #")[0].strip() for line in block.group(1).splitlines()]
    return [shlex.split(line)[2:] for line in lines if line]


def run(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """One command, with outputs under a folder of the test."""
    words = [word.replace("build/", f"{folder}/") for word in words]
    environment = {**os.environ, "NAVSYM_CACHE": str(folder / "cache"), "NO_COLOR": "1"}
    command = [sys.executable, "-m", "navsym", *words]
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=600)


def test_the_tour_has_its_steps() -> None:
    assert [words[0] for words in commands()] == [
        "verify",
        "explain",
        "prove",
        "derive",
        "solve",
        "phases",
        "export",
        "check",
        "report",
    ]


def clean_clone(folder: Path) -> Path:
    """The committed state in a folder of its own, as somebody else would get it."""
    clone = folder / "navsym"
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(clone)], check=True, timeout=120)
    return clone


@pytest.mark.slow
def test_the_tour_runs_from_a_clean_clone_to_the_browser(tmp_path: Path) -> None:
    """Every line as it stands, in an empty home, and the last page in a browser; the wall times are printed."""
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("no git, or no repository: there is nothing to clone")
    clone = clean_clone(tmp_path)
    kept = {key: value for key, value in os.environ.items() if key.startswith(("PIP_", "SSL_", "PATH", "LANG"))}
    environment = {**kept, "HOME": str(tmp_path / "home"), "NO_COLOR": "1"}
    (tmp_path / "home").mkdir()
    started = time.monotonic()
    for words in commands():
        begun = time.monotonic()
        line = [sys.executable, "bootstrap.py", *words]
        done = subprocess.run(line, cwd=clone, env=environment, capture_output=True, text=True, timeout=1200)
        if done.returncode == 3 and "network" in done.stderr:
            pytest.skip("the packages cannot be fetched here")
        assert done.returncode == STATUS.get(words[0], 0), (words, done.stdout[-2000:], done.stderr[-2000:])
        assert "Traceback" not in done.stderr
        print(f"{time.monotonic() - begun:6.1f} s  {shlex.join(words)}")
    print(f"{time.monotonic() - started:6.1f} s  the whole tour")
    look(clone / "build" / "pages" / "index.html", tmp_path)


def look(index: Path, folder: Path) -> None:
    """Open the index, go to a refuted equation and to its erratum sheet; the console stays quiet."""
    if devtools.found() is None:
        print("no browser on this machine: the pages were made and not looked at")
        return
    browser = devtools.Browser(folder / "profile")
    try:
        browser.open(index.as_uri())
        assert browser.value("document.querySelectorAll('section.paper').length") >= 6
        cell = browser.value("document.querySelector('a.cell.refuted').href")
        browser.open(cell)
        assert browser.value("document.querySelector('article:target .badge').innerText").endswith("REFUTED")
        sheet = browser.value("[...document.querySelectorAll('header a')].at(-1).href")
        browser.open(sheet)
        assert browser.value("document.querySelectorAll('.erratum > li .right').length") >= 10
        assert not browser.trouble
    finally:
        browser.close()


def spaced(text: str) -> str:
    """Text with single spaces: a table may be wider or narrower, and a line may end elsewhere."""
    return " ".join(text.split())


def shown_after(words: str) -> list[str]:
    """The lines of the block that follows some words of the README."""
    block = re.search(r"```(?:text)?\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8").split(words)[1], re.S)
    assert block is not None
    return [spaced(line) for line in block.group(1).splitlines() if line.strip()]


def test_the_example_of_the_first_screen_is_what_is_printed(tmp_path: Path) -> None:
    said = spaced(run(["explain", "guaranteed_velocity:4.3.u2"], tmp_path).stdout)
    assert [line for line in shown_after("guaranteed_velocity:4.3.u2`, shortened") if line not in said] == []


@pytest.mark.slow
def test_the_regimes_of_the_readme_are_what_is_printed(tmp_path: Path) -> None:
    said = spaced(run(next(words for words in commands() if words[0] == "phases"), tmp_path).stdout)
    assert [line for line in shown_after("## Beyond the paper") if line not in said] == []


def test_the_python_of_the_first_screen_runs(tmp_path: Path) -> None:
    """Every statement as it stands; the verdicts of a whole paper have tests of their own."""
    section = (ROOT / "README.md").read_text(encoding="utf-8").split("## In Python")[1]
    block = re.search(r"```python\n(.*?)```", section, re.S)
    assert block is not None
    lines = [line for line in block.group(1).splitlines() if not line.startswith("nav.verify(")]
    script = "\n".join(
        [*lines, "print(drift.value, drift.check().accepted, nav.prove('sin(2*a) = 2*sin(a)*cos(a)').status)"]
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[0].startswith("4.8284271247461900976") and done.stdout.split()[1:] == ["True", "PROVED"]
    assert (tmp_path / "build" / "weights" / "c").is_dir()


PAPERS = ("guaranteed_velocity", "joint_correction", "multistructure", "terrain_search", "trajectory")


def slips(module: str) -> tuple[int, int, int, int]:
    """Numbered equations of a paper, those whose formula slips, those that the copy may have damaged; other slips.

    Other slips are printed sentences, figures and formulas without a number, each cause once.
    """
    equations = importlib.import_module(f"navsym_papers.{module}").PAPER.equations
    ledger = json.loads((ROOT / "derivations" / "verdicts.json").read_text(encoding="utf-8"))
    mine = [record for record in Ledger.from_json(ledger) if record.paper == module]
    own = [{r.slip for r in records_about(e, equations, mine) if r.status == "REFUTED"} for e in equations]
    slip = [r for r in mine if r.status == "REFUTED" and r.slip == "paper" and r.cause is None]
    others = [r for r in slip if r.kind == "beside" or equation_of(r.number, equations) is None]
    printed = sum("paper" in kinds for kinds in own)
    return len(equations), printed, sum(bool(kinds) and "paper" not in kinds for kinds in own), len(others)


def test_the_first_screen_counts_what_the_ledger_counts() -> None:
    equations, printed, copied, others = map(sum, zip(*map(slips, PAPERS), strict=True))
    text = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert f"Of {equations} numbered equations of five published papers, {printed} need a correction" in text
    assert f"{copied} more may be damaged only in the copy that was read" in text
    assert f"{others} other statements and figures" in text


def test_the_largest_error_of_the_printed_table_is_that_of_the_ledger() -> None:
    records = json.loads((ROOT / "derivations" / "verdicts.json").read_text(encoding="utf-8"))["claims"]
    found = {r["id"]: r["printed"] for r in records if r["id"].startswith("trajectory:table.n")}
    pairs = [(float(found[name]), float(found[f"{name}*"])) for name in found if f"{name}*" in found]
    assert len(pairs) == 16
    text = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert f"off by factors up to {round(max(max(a / b, b / a) for a, b in pairs), -3):,.0f}" in text


#: What the table of the first screen says was found, as claims: id -> whose slip it is.
SAID = {
    "guaranteed_velocity:4.14.y2": "paper",
    "guaranteed_velocity:4.3.u2": "undecidable",
    "joint_correction:2.8.x6": "undecidable",
    "joint_correction:1.10.gz": "undecidable",
    "joint_correction:3.3.y1": "scan",
    "multistructure:11": "paper",
    "multistructure:12": "paper",
    "multistructure:13": "paper",
    "multistructure:9": "paper",
    "multistructure:14.follows": "paper",
}


def test_every_slip_that_the_first_screen_names_is_refuted_in_the_ledger() -> None:
    ledger = json.loads((ROOT / "derivations" / "verdicts.json").read_text(encoding="utf-8"))["claims"]
    known = {record["id"]: (record["status"], record["slip"]) for record in ledger}
    assert {name: known[name] for name in SAID} == {name: ("REFUTED", slip) for name, slip in SAID.items()}


@pytest.mark.parametrize(
    "words", [w for w in commands() if w[0] in ("explain", "prove", "derive", "solve")], ids=" ".join
)
def test_the_quick_steps_of_the_tour_run_in_every_run(words: list[str], tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path / "cache"))
    assert main.run([word.replace("build/", f"{tmp_path}/") for word in words]) == STATUS.get(words[0], 0)
    assert capsys.readouterr().out.strip()
