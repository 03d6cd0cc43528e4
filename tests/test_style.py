"""How the sources are written: linter, types, sizes, docstrings, exact numbers, no foreign traces."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LONGEST = 450

#: Files above LONGEST lines -> why they are not split. Shorten the list, do not lengthen it.
LONG_FILES: dict[str, str] = {}


def tracked(*suffixes: str) -> list[Path]:
    """Files under version control that exist, by ending; without version control, all files."""
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False, timeout=60)
    if done.returncode == 0:
        paths = [ROOT / name for name in done.stdout.decode().split("\0") if name]
    else:
        paths = [p for p in ROOT.rglob("*") if not any(part.startswith(".") for part in p.parts)]
    return sorted(p for p in paths if p.is_file() and (not suffixes or p.suffix in suffixes))


def run_tool(*words: str) -> str:
    """Output of a tool of this environment; empty when it found nothing."""
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=ROOT, capture_output=True, text=True, check=False, timeout=300
    )
    return "" if done.returncode == 0 else done.stdout + done.stderr


def test_the_linter_finds_nothing() -> None:
    assert not (found := run_tool("ruff", "check", "--quiet", "--output-format=concise", ".")), found


def test_the_types_fit() -> None:
    assert not (found := run_tool("mypy", "--no-error-summary")), found


# Sizes


def too_long(paths: list[Path], root: Path) -> list[str]:
    """Python files above LONGEST lines that have no waiver."""
    sizes = ((p.relative_to(root).as_posix(), p.read_bytes().count(b"\n")) for p in paths)
    return [f"{name}: {size} lines" for name, size in sizes if size > LONGEST and name not in LONG_FILES]


def test_files_hold_one_idea() -> None:
    assert not (found := too_long(tracked(".py"), ROOT)), "\n".join(["split:", *found])


def test_waivers_for_long_files_are_still_needed() -> None:
    sizes = {name: (ROOT / name).read_bytes().count(b"\n") for name in LONG_FILES}
    assert not [name for name, size in sizes.items() if size <= LONGEST]
    assert all(LONG_FILES.values())


# Docstrings


def undocumented(source: str, name: str, public: set[str]) -> Iterator[str]:
    """Modules, and public functions and classes, without a docstring.

    Public is what another room or file imports. A helper inside its file has its name and its
    neighbours to explain it.
    """
    tree = ast.parse(source, filename=name)
    if tree.body and not ast.get_docstring(tree):
        yield f"{name}: module"
    for item in tree.body:
        if not isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            continue
        if item.name in public and not ast.get_docstring(item):
            yield f"{name}:{item.lineno}: {item.name}"
        if item.name in public and isinstance(item, ast.ClassDef):
            yield from undocumented_methods(item, name)


def undocumented_methods(node: ast.ClassDef, name: str) -> Iterator[str]:
    """Long methods without a docstring."""
    for item in node.body:
        if not isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef) or item.name.startswith("_"):
            continue
        if len(item.body) > 6 and not ast.get_docstring(item) and not is_plain_property(item):
            yield f"{name}:{item.lineno}: {node.name}.{item.name}"


def imported_names(files: Iterable[Path]) -> dict[str, set[str]]:
    """Module -> the names that other files import from it."""
    names: dict[str, set[str]] = {}
    for path in files:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("navsym"):
                names.setdefault(str(node.module), set()).update(alias.name for alias in node.names)
    return names


def dotted(path: Path) -> str:
    """Name under which a file is imported."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def is_plain_property(item: ast.stmt) -> bool:
    """A property or an overload: the class, or the function itself, says what it is."""
    marks = {getattr(d, "id", getattr(d, "attr", "")) for d in getattr(item, "decorator_list", ())}
    return bool(marks & {"property", "cached_property", "overload", "setter"})


def test_every_public_function_says_what_it_computes() -> None:
    files = [p for p in tracked(".py") if p.relative_to(ROOT).parts[0] in ("navsym", "derivations", "notebooks")]
    public = imported_names(files)
    rooms = [p for p in files if p.relative_to(ROOT).parts[0] == "navsym"]
    found = [
        line
        for p in rooms
        for line in undocumented(p.read_text(), p.relative_to(ROOT).as_posix(), public.get(dotted(p), set()))
    ]
    assert not found, "\n".join(["without a docstring:", *found])


# Exact numbers


def floats_in(source: str, name: str) -> list[str]:
    """Floating-point literals, which have no place where formulas are derived."""
    nodes = [n for n in ast.walk(ast.parse(source, filename=name)) if isinstance(n, ast.Constant)]
    nodes.sort(key=lambda n: (n.lineno, n.col_offset))
    return [f"{name}:{n.lineno}: {n.value!r}" for n in nodes if isinstance(n.value, float | complex)]


def test_no_floating_point_number_enters_a_derivation() -> None:
    files = [p for p in tracked(".py") if p.relative_to(ROOT).parts[0] == "derivations"]
    files = [p for p in files if p.parent.name != "experiment"]  # they simulate and filter; nothing is derived there
    found = [line for p in files for line in floats_in(p.read_text(), p.relative_to(ROOT).as_posix())]
    assert not found, "\n".join(found)


# Foreign traces

#: Where text would stop being true on another machine. Written in pieces, so that this file passes.
TRACES = {
    "a home or scratch folder": r"(?<![\w.~$}])/(?:home|root|Users|work|tmp|mnt|opt)/[\w.-]+",
    "a package registry": r"(?:pypi\.|pythonhosted|/simple\b.*index|--(?:extra-)?index-url)",
    "a development tool's folder": r"site-" r"packages/|\.py" r"env/",
}


def traces_in(text: str) -> list[str]:
    """Machine paths and registry hosts, each with its line number."""
    lines = enumerate(text.splitlines(), start=1)
    return [
        f"{number}: {what}: {line.strip()[:100]}"
        for number, line in lines
        for what, pattern in TRACES.items()
        if re.search(pattern, line)
    ]


def test_no_file_tells_on_which_machine_it_was_written() -> None:
    here = Path(__file__).resolve()
    found = []
    for path in tracked():
        if path == here:
            continue
        data = path.read_bytes()
        if b"\0" not in data[:4096]:
            name = path.relative_to(ROOT).as_posix()
            found += [f"{name}:{line}" for line in traces_in(data.decode("utf-8", "replace"))]
    assert not found, "\n".join(found)


# The checks can fail


def test_a_long_file_is_found(tmp_path: Path) -> None:
    path = tmp_path / "long.py"
    path.write_text("x = 1\n" * (LONGEST + 1))
    assert too_long([path], tmp_path) == [f"long.py: {LONGEST + 1} lines"]


def test_a_missing_docstring_is_found() -> None:
    source = '"""Title."""\ndef f(): ...\ndef g(): ...\nclass C:\n    pass\n'
    assert list(undocumented(source, "a.py", {"f", "C"})) == ["a.py:2: f", "a.py:4: C"]
    assert list(undocumented("x = 1", "b.py", set())) == ["b.py: module"]


def test_a_float_in_a_derivation_is_found_and_one_in_a_string_is_not() -> None:
    assert floats_in('"""0.1"""\nx = Rational("0.1")\ny = 0.1 * 1e3\nz = 2j\n', "a.py") == [
        "a.py:3: 0.1",
        "a.py:3: 1000.0",
        "a.py:4: 2j",
    ]


@pytest.mark.parametrize("text", ["see /home/someone/x", "open('/tmp/x')", "--index-url https://a.b/simple"])
def test_a_foreign_trace_is_found(text: str) -> None:
    assert traces_in(text)


@pytest.mark.parametrize("text", ["a/home/b", "derivations/trajectory.py", "~/.cache", "w / work / 2", "/"])
def test_ordinary_text_is_no_trace(text: str) -> None:
    assert not traces_in(text)
