"""The reference as Markdown: one page of the names of ``import navsym as nav``, one of the verbs with their options."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

import navsym as nav
from navsym.cli._options import with_options
from navsym.cli.main import help_line, verbs

#: Text that is shown as it stands.
VERBATIM = "````text\n{}\n````\n\n"


def write_reference(folder: Path) -> None:
    """Both pages; a page is only written when it has changed, and a page of another name goes."""
    folder.mkdir(exist_ok=True)
    pages = {"0_python.md": python_page(), "1_verbs.md": verbs_page()}
    for path in set(folder.glob("*.md")) - {folder / name for name in pages}:
        path.unlink()
    for name, text in pages.items():
        target = folder / name
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def python_page() -> str:
    """Every public name with its signature and its docstring, methods below their class."""
    names = [name for name in nav.__all__ if not name.startswith("__")]
    sections = (section(f"## {name}", f"nav.{name}", getattr(nav, name)) for name in names)
    return "# The names of Python\n\nThese names come with `import navsym as nav`.\n\n" + "".join(sections)


def section(title: str, name: str, value: Any) -> str:
    """One name: signature, first paragraph as text, the rest as it stands; a constant by its value alone."""
    if isinstance(value, nav.Status):
        return f"{title}\n\n" + VERBATIM.format(repr(value))
    first, _, rest = (inspect.getdoc(value) or "").partition("\n\n")
    text = f"{title}\n\n" + VERBATIM.format(signature(name, value)) + f"{prose(first)}\n\n"
    text += VERBATIM.format(rest.strip("\n")) if rest.strip() else ""
    return text + "".join(section(f"### {key}", key, member) for key, member in members(value))


def members(value: Any) -> Iterator[tuple[str, Any]]:
    """Public methods and properties of a class that have a docstring."""
    for key, member in vars(value).items() if inspect.isclass(value) else ():
        described = inspect.isfunction(member) or isinstance(member, property | classmethod)
        if described and not key.startswith("_") and inspect.getdoc(member):
            yield f"{value.__name__}.{key}", getattr(value, key)


def signature(name: str, value: Any) -> str:
    """The call as one writes it, on several lines where it is long; the name alone where nothing is called."""
    if not callable(value) or (inspect.isclass(value) and issubclass(value, Exception | nav.Status)):
        return name
    whole = inspect.signature(value)
    parts = [str(part) for part in whole.parameters.values() if part.name != "self"]
    text = f"{name}({', '.join(parts)}"
    text = "\n    ".join([f"{name}(", *(f"{part}," for part in parts)]) + "\n" if len(text) > 90 else text
    return re.sub(r"(: |-> )(['\"])(.*?)\2", r"\1\3", text + str(whole)[str(whole).rindex(")") :])


def prose(text: str) -> str:
    """A paragraph of a docstring as Markdown: code stays code, and no other sign means anything."""
    parts = re.split(r"(``.+?``)", re.sub(r":\w+:`~?([^`]+)`", r"``\1``", " ".join(text.split())))
    return "".join(p if p.startswith("``") else re.sub(r"([\\*_<>\[\]$|#~`{}^])", r"\\\1", p) for p in parts)


def verbs_page() -> str:
    """One section for each verb of the command line: its line, its usage, its options and an example."""
    text = "# Verbs and their options\n\n`navsym VERB --help` prints the same. Every verb takes `--json`.\n\n"
    for verb, path in verbs().items():
        app = typer.Typer(add_completion=False, rich_markup_mode=None)
        app.command(name=verb)(with_options(importlib.import_module(f"navsym.cli.{path.stem}").command, verb))
        context = typer.main.get_command(app).make_context(f"navsym {verb}", [], resilient_parsing=True)
        text += f"## {verb}\n\n{help_line(path)}\n\n" + VERBATIM.format(context.command.get_help(context).rstrip())
    return text
