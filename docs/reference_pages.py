"""The reference as Markdown pages, from docstrings and without importing anything but the verbs.

The first pages have what a user meets (:mod:`entry_points`, :mod:`verb_pages`); then comes one page for each folder of
the package.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from itertools import groupby
from pathlib import Path

from entry_points import PACKAGE, ROOT, EntryPoint, entry_points
from verb_pages import verbs_page

#: Folder -> what its page is called; a folder inside takes the first line of its own docstring.
ROOMS = {
    "claims": "Statements, verdicts, claims and papers",
    "text": "Everything that comes from outside",
    "models": "Models, as symbols",
    "numeric": "Arrays and compiled loops",
    "proof": "What decides statements",
    "methods": "What a user asks for",
    "report": "Pages and errata",
    "export": "Code with certificates",
}
#: Single files of the package that stand in no room.
ALONE = ("checker", "errors", "store", "testing")
INTRODUCTION = """These functions and classes are what the verbs, the notebooks and the examples of these pages call.
Every verb has one of the same meaning; the pages after this one have the rest, room by room."""

Definition = ast.FunctionDef | ast.ClassDef


def write_reference(folder: Path) -> None:
    """All pages; a page is only written when it has changed, and one that has lost its room goes."""
    folder.mkdir(exist_ok=True)
    pages = dict(all_pages())
    for path in folder.glob("*.md"):
        if path.name not in pages:
            path.unlink()
    for name, text in pages.items():
        target = folder / name
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def all_pages() -> Iterator[tuple[str, str]]:
    """Name and text of every page; the glob of the index sorts them by name."""
    yield "0_entry_points.md", entry_page(entry_points())
    yield "0_verbs.md", verbs_page()
    for room, title in ROOMS.items():
        for path in folders(ROOT / PACKAGE / room):
            parts = path.relative_to(ROOT / PACKAGE).parts
            words = title if len(parts) == 1 else first_line(path / "__init__.py").rstrip(".")
            yield "_".join(parts) + ".md", room_page("/".join(parts), words, sorted(path.glob("*.py")))
    files = [ROOT / PACKAGE / f"{name}.py" for name in ALONE]
    yield "z_alone.md", room_page("single files", "What stands in no room", files)


def folders(path: Path) -> Iterator[Path]:
    """A folder and those inside it that hold modules."""
    yield path
    yield from sorted({file.parent for file in path.rglob("*.py")} - {path})


def entry_page(points: Iterable[EntryPoint]) -> str:
    lines = ["# What a user calls", "", INTRODUCTION, ""]
    for module, group in groupby(points, lambda point: point.module):
        lines += [f"## {module}", "", first_line(ROOT.joinpath(*module.split(".")).with_suffix(".py")), ""]
        for point in group:
            lines += definition(point.node)
    return "\n".join(lines) + "\n"


def room_page(room: str, title: str, files: Iterable[Path]) -> str:
    lines = [f"# {room}: {title[:1].lower()}{title[1:]}", ""]
    for path in files:
        parts = public_parts(path)
        if parts or path.name != "__init__.py":
            dotted = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
            lines += [f"## {dotted}", "", first_line(path), "", *parts]
    return "\n".join(lines) + "\n"


def public_parts(path: Path) -> list[str]:
    """Every documented function and class of a file."""
    body = ast.parse(path.read_text(encoding="utf-8")).body
    nodes = (node for node in body if isinstance(node, Definition) and not node.name.startswith("_"))
    return [line for node in nodes for line in definition(node)]


def definition(node: Definition) -> list[str]:
    """Signature and docstring as Markdown; nothing where there is no docstring."""
    doc = ast.get_docstring(node)
    if not doc:
        return []
    first, _, rest = doc.partition("\n\n")
    more = ["````text", *rest.strip("\n").splitlines(), "````", ""] if rest.strip() else []
    return [f"### {node.name}", "", "````text", signature(node), "````", "", prose(first), "", *more]


def prose(text: str) -> str:
    """A paragraph of a docstring as Markdown: code stays code, and no other sign means anything."""
    text = re.sub(r":\w+:`~?([^`]+)`", r"``\1``", " ".join(text.split()))
    parts = re.split(r"(``.+?``)", text)
    return "".join(part if part.startswith("``") else plain(part) for part in parts)


def plain(text: str) -> str:
    """Text with every sign of Markdown written out."""
    return re.sub(r"([\\*_<>\[\]$|#~`{}^])", r"\\\1", text)


def signature(node: Definition) -> str:
    """The head of a definition; fields of a dataclass are in its docstring."""
    if isinstance(node, ast.ClassDef):
        return f"class {node.name}"
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    whole = f"{node.name}({ast.unparse(node.args)}){returns}"
    if len(whole) <= 100:
        return whole
    return "\n".join([f"{node.name}(", *(f"    {part}," for part in arguments(node.args)), f"){returns}"])


def arguments(args: ast.arguments) -> Iterator[str]:
    """One text for each argument, the star before keywords included."""
    places = [*args.posonlyargs, *args.args]
    missing: list[ast.expr | None] = [None] * (len(places) - len(args.defaults))
    for arg, default in zip(places, [*missing, *args.defaults], strict=True):
        yield argument(arg, default)
    if args.vararg or args.kwonlyargs:
        yield f"*{ast.unparse(args.vararg)}" if args.vararg else "*"
    for arg, keyword in zip(args.kwonlyargs, args.kw_defaults, strict=True):
        yield argument(arg, keyword)
    if args.kwarg:
        yield f"**{ast.unparse(args.kwarg)}"


def argument(arg: ast.arg, default: ast.expr | None) -> str:
    return ast.unparse(arg) + (f" = {ast.unparse(default)}" if default is not None else "")


def first_line(path: Path) -> str:
    """First line of a file's docstring."""
    doc = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) if path.exists() else ""
    return (doc or "").split("\n")[0]
