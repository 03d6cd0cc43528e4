"""The example in the help of a verb runs as it is printed."""

from __future__ import annotations

import ast
import re
import shlex
import shutil
from pathlib import Path

import pytest

from navsym.cli.main import run, verbs

EXAMPLES = Path(__file__).parents[2] / "examples"
STATUS = {"audit": 1, "prove": 1}  # something is wrong there on purpose
AFTER = {"check": "report"}  # what a verb reads, another one writes
NOT_HERE = {
    "eval": "for a shell",
    "campaign": "minutes; tests/attacks runs small ones",
    "data": "fetches; tests/cli/test_data.py has a copy at hand",
    "diff build": "two folders of the reader's own; tests/cli/test_diff.py makes some",
    "export": "a compiler; the tour of the README runs it",
    "doctor": "compiles with an empty cache; tests/cli/test_doctor.py",
    "new-": "writes into derivations/; tests/cli/test_new_paper.py does so elsewhere",
}
SLOW = ("simulate", "verify", "sweep", "report", "check")


def examples():
    """Verb and words of every example in the help of a verb; a redirection is the shell's."""
    for verb, path in verbs().items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        command = next(n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == "command")
        for line in re.findall(r"Example: (.*)", ast.get_docstring(command) or ""):
            words = shlex.split(re.split(r"\s{3,}\(| >> ", line)[0])
            yield verb, words


def reason(words):
    """Why an example is not run here, or nothing."""
    line = " ".join(words).removeprefix("navsym ")
    return next((why for start, why in NOT_HERE.items() if line.split(" --")[0].startswith(start)), "")


#: The first example of the README, which runs it too, and of docs/model_files.md; what is compiled first.
LONG = ("phases", "track")
HERE = [
    pytest.param(
        verb, words, id=verb, marks=[pytest.mark.slow] if verb in SLOW else [pytest.mark.long] if verb in LONG else []
    )
    for verb, words in examples()
    if not reason(words)
]


@pytest.mark.parametrize(("verb", "words"), HERE)
def test_the_example_of_the_help_runs_as_printed(verb, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    known = dict(examples())
    for line in ([known[AFTER[verb]]] if verb in AFTER else []) + [words]:
        assert line[0] == "navsym"
        assert run(line[1:]) == STATUS.get(line[1], 0), capsys.readouterr().err
    assert capsys.readouterr().out.strip()


def test_most_examples_are_run():
    assert len(HERE) >= 21 and {words[1] for _, words in examples() if words[0] == "navsym"} == set(verbs())
