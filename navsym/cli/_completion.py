"""What may come next on a command line, found without importing a verb: it is asked at every press of Tab.

Verbs are listed, options are read from the sources and their table, claims from the ledger.
"""

from __future__ import annotations

import ast
import json
import shlex
from collections.abc import Callable, Iterable
from pathlib import Path

from navsym.claims.paper import experiment_names, paper_names, papers_folder
from navsym.claims.workspace import find_workspace
from navsym.cli._options import words_of
from navsym.core.errors import NavsymError

SHELLS = ("bash", "zsh", "fish")
STATUSES = ("PROVED", "CERTIFIED", "CONFIRMED", "REFUTED", "OPEN")


def candidates(line: str, verbs: dict[str, Path]) -> list[str]:
    """Words that complete the last word of a line; none where a file name is wanted.

    line  : the command line up to the cursor, with the program's name
    verbs : verb -> source file
    """
    words, last = split(line)
    if not words:
        return begin(last, (*verbs, "--help", "--version"))
    verb, before = words[0], words[1:]
    if verb not in verbs:
        return []
    if before and before[-1] in VALUES:
        return begin(last, VALUES[before[-1]]())
    if last.startswith("-"):
        return begin(last, options(verb, verbs[verb]))
    return begin(last, POSITIONAL[verb]()) if verb in POSITIONAL else []


def split(line: str) -> tuple[list[str], str]:
    """Finished words after the program's name, and the one that is being written."""
    try:
        words = shlex.split(line)
    except ValueError:  # an open quote
        words = line.split()
    last = "" if not words or line[-1:].isspace() else words.pop()
    return words[1:], last


def begin(start: str, words: Iterable[str]) -> list[str]:
    return [word for word in words if word.startswith(start)]


def options(verb: str, source: Path) -> list[str]:
    """Options of a verb: the parameters of its command that are given by keyword only."""
    tree = ast.parse(source.read_bytes())
    command = next(n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == "command")
    own = [flag for a in command.args.kwonlyargs for flag in words_of(verb, a.arg)["flag"].split("/")]
    return [*own, "--json", "--help"]


def claims() -> list[str]:
    """Ids of all claims, from the ledger."""
    try:
        workspace = find_workspace()
        ledger = papers_folder() / "verdicts.json" if workspace is None else workspace.ledger_file
        document = json.loads(ledger.read_text(encoding="utf-8"))
        return [str(record["id"]) for record in document["claims"]]
    except (OSError, ValueError, LookupError, TypeError, NavsymError):  # a damaged ledger completes nothing
        return []


def sources() -> list[str]:
    """Files and papers of the workspace, or the papers that come with navsym."""
    try:
        workspace = find_workspace()
        return paper_names() if workspace is None else [*workspace.names()]
    except NavsymError:
        return []


def datasets() -> list[str]:
    """Words after ``navsym data``."""
    from navsym.core.datasets import DATASETS

    return ["list", "get", *DATASETS]


POSITIONAL: dict[str, Callable[[], Iterable[str]]] = {
    "show": claims,
    "explain": claims,
    "cite": claims,
    "export": claims,
    "verify": sources,
    "report": sources,
    "new-claim": paper_names,
    "simulate": experiment_names,
    "campaign": lambda: ("mutants", "engines", "parser", "fuzz", "certificates", "identities", *paper_names()),
    "data": datasets,
    "completion": lambda: SHELLS,
}
VALUES: dict[str, Callable[[], Iterable[str]]] = {
    "--paper": sources,
    "--status": lambda: STATUSES,
    "--slip": lambda: ("paper", "scan", "undecidable", "any"),
    "--real": lambda: ("double", "float"),
    "--policy": lambda: ("strict", "repair"),
}

#: Where the script of each shell, ``completion.SHELL`` in this folder, is installed below the home of the user.
PLACES = {
    "bash": ".local/share/bash-completion/completions/navsym",
    "zsh": ".zfunc/_navsym",
    "fish": ".config/fish/completions/navsym.fish",
}
