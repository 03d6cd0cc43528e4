"""Complete verbs, options and claim ids in bash, zsh or fish."""

from __future__ import annotations

from pathlib import Path

from navsym.cli._completion import PLACES, SHELLS
from navsym.cli.output import Told, write_text
from navsym.core.choice import one_of
from navsym.language.files import make_folder


def command(shell: str, *, install: bool = False) -> Told:
    """Print the script that completes verbs, options and claim ids, or install it for this user.

    Example: navsym completion bash --install
    Example: eval "$(navsym completion bash)"        (this shell only)
    """
    one_of(shell, SHELLS, "completion")
    script = Path(__file__).with_suffix(f".{shell}").read_text("utf-8")
    if not install:
        return Told({"shell": shell, "script": script}, script)
    path = Path.home() / PLACES[shell]
    make_folder(path.parent, "print the script and place it yourself")
    write_text(path, script)
    hint = "; add  fpath+=~/.zfunc  before compinit in ~/.zshrc" if shell == "zsh" else ""
    return Told({"shell": shell, "path": str(path)}, f"{path}: open a new shell{hint}")
