"""Completion offers verbs, options and claim ids, in the shells themselves where they are installed."""

from __future__ import annotations

import ast
import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from navsym.cli._completion import POSITIONAL, SHELLS, candidates, options
from navsym.cli._options import with_options
from navsym.cli.main import run, verbs

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("navsym ver", ["verify"]),
        ("navsym explain guaranteed_velocity:4.3.u2", ["guaranteed_velocity:4.3.u2", "guaranteed_velocity:4.3.u2*"]),
        ("navsym verify --se", ["--seconds"]),
        ("navsym list --status R", ["REFUTED"]),
        ("navsym list --paper guaranteed_velocity --sl", ["--slip"]),
        ("navsym solve model", []),
        ("navsym nothing ", []),
        ("navsym 'open quote", []),
    ],
)
def test_what_may_come_next(line, expected):
    assert candidates(line, verbs()) == expected


def test_every_option_that_a_verb_takes_is_offered():
    for verb, source in verbs().items():
        app = typer.Typer(add_completion=False)
        app.command(name=verb)(with_options(importlib.import_module(f"navsym.cli.{source.stem}").command, verb))
        declared = [p for p in typer.main.get_command(app).params if p.param_type_name == "option"]
        taken = {flag for option in declared for flag in (*option.opts, *option.secondary_opts)}
        assert {*options(verb, source)} == taken | {"--help"}, verb


def test_the_table_names_verbs_that_exist():
    assert set(POSITIONAL) <= set(verbs())


def test_asking_does_not_load_typer():
    code = "import sys; from navsym.cli.main import run; run(['completion', 'words', 'navsym ver']); "
    done = subprocess.run(
        [sys.executable, "-c", code + "print('typer' in sys.modules)"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert done.stdout.split() == ["verify", "False"]


ASK = {
    "bash": 'eval "$(navsym completion bash)"; COMP_LINE="$LINE"; COMP_POINT=${#COMP_LINE}; _navsym; '
    'printf "%s\\n" "${COMPREPLY[@]}"',
    "fish": 'navsym completion fish | source; complete -C "$LINE"',
    "zsh": 'compdef() { :; }; eval "$(navsym completion zsh)"; compadd() { shift; print -l -- $@; }; '
    "words=(${(s: :)LINE}); CURRENT=$#words; _navsym",
}


@pytest.mark.parametrize("shell", SHELLS)
def test_the_shell_itself_completes_an_id_with_a_colon(shell, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"no {shell} on this machine")
    program = tmp_path / "navsym"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m navsym "$@"\n')
    program.chmod(0o755)
    env = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT), "HOME": str(tmp_path)}
    env["LINE"] = "navsym explain guaranteed_velocity:4.3.u2"
    ends = {"stdin": subprocess.DEVNULL, "capture_output": True, "text": True, "timeout": 120}
    done = subprocess.run([shell, "-c", ASK[shell]], env=env, check=True, **ends)
    found = [word.removeprefix("guaranteed_velocity:") for word in done.stdout.split()]
    assert found == ["4.3.u2", "4.3.u2*"]


def test_the_script_is_installed_where_the_shell_looks(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert run(["completion", "bash", "--install"]) == 0
    script = tmp_path / ".local/share/bash-completion/completions/navsym"
    assert script.read_text() and str(script) in capsys.readouterr().out
    assert run(["completion", "tcsh", "--json"]) == 2


def test_every_verb_has_an_example_in_its_help():
    for verb, source in verbs().items():
        tree = ast.parse(source.read_text(encoding="utf-8"))
        command = next(n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == "command")
        doc = ast.get_docstring(command) or ""
        assert f"Example: navsym {verb}" in doc, verb
