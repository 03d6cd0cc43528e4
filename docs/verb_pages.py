"""The page of verbs: the help of each, as the command line prints it."""

from __future__ import annotations

import importlib
from collections.abc import Iterator

import typer

from navsym.cli.main import help_line, verbs

INTRODUCTION = """`navsym VERB --help` prints the same. A file is read, never executed; every verb takes `--json`."""


def verbs_page() -> str:
    """Markdown with one section for each verb: its line, its usage, its options and an example."""
    lines = ["# Verbs and their options", "", INTRODUCTION, ""]
    for verb, path in verbs().items():
        lines += [f"## {verb}", "", help_line(path), "", "````text", *help_of(verb, path.stem), "````", ""]
    return "\n".join(lines) + "\n"


def help_of(verb: str, module: str) -> Iterator[str]:
    """Lines of the help of a verb."""
    app = typer.Typer(add_completion=False, rich_markup_mode=None)
    app.command(name=verb)(importlib.import_module(f"navsym.cli.{module}").command)
    command = typer.main.get_command(app)
    context = command.make_context(f"navsym {verb}", [], resilient_parsing=True)
    yield from command.get_help(context).rstrip().splitlines()
