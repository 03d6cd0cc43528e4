"""How the sources are written: linter, types, sizes, names, docstrings, exact numbers, no foreign traces."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LONGEST_FILE, LONGEST_FUNCTION = 700, 60
#: The checker is one file on purpose: it can be taken away, read and run alone. Tables of proofs are long.
LONGER_FILES = {"navsym/checker.py": 4110, "tests/checker/proofs.py": 950}

#: Share of the names of top-level functions that may stand in two files or more.
AMBIGUOUS = 0.10


def tracked(*suffixes: str) -> list[Path]:
    """Files under version control that exist, by ending; without version control, all files."""
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False, timeout=60)
    if done.returncode == 0:
        paths = [ROOT / name for name in done.stdout.decode().split("\0") if name]
    else:
        paths = [p for p in ROOT.rglob("*") if not any(part.startswith(".") for part in p.parts)]
    return sorted(p for p in paths if p.is_file() and (not suffixes or p.suffix in suffixes))


@cache
def tree_of(path: Path) -> ast.Module:
    """A source as a tree, read once for all tests of this file."""
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


@pytest.fixture(scope="module", autouse=True)
def trees() -> Iterator[None]:
    """The trees of all sources are many: other tests are not to carry them along."""
    yield
    tree_of.cache_clear()


def run_tool(*words: str) -> str:
    """Output of a tool of this environment; empty when it found nothing."""
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=ROOT, capture_output=True, text=True, check=False, timeout=300
    )
    return "" if done.returncode == 0 else done.stdout + done.stderr


@pytest.mark.parametrize("words", ["check --quiet --output-format=concise", "format --check --quiet"])
def test_the_linter_finds_nothing(words: str) -> None:
    assert not (found := run_tool("ruff", *words.split(), ".")), found


@pytest.mark.long
def test_the_types_fit() -> None:
    assert not (found := run_tool("mypy", "--no-error-summary")), found


# Sizes and names


def definitions(root: Path) -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef]]:
    """Every function and class of navsym, methods included, with the file that defines it."""
    for path in sorted((root / "navsym").rglob("*.py")):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                yield path.relative_to(root).as_posix(), node


def too_long(paths: Iterable[Path], root: Path) -> list[str]:
    """Python files, and functions of navsym, above their limits."""
    files = ((p.relative_to(root).as_posix(), p.read_bytes().count(b"\n")) for p in paths)
    found = [f"{name}: {lines} lines" for name, lines in files if lines > LONGER_FILES.get(name, LONGEST_FILE)]
    for name, node in definitions(root):
        lines = (node.end_lineno or 0) - node.lineno + 1
        if not isinstance(node, ast.ClassDef) and lines > LONGEST_FUNCTION:
            found.append(f"{name}:{node.lineno}: {node.name}: {lines} lines")
    return found


def ambiguous(root: Path) -> tuple[dict[str, list[str]], int]:
    """Names of top-level functions that stand in several files, with these; and the number of all names."""
    places: dict[str, list[str]] = {}
    for path in sorted((root / "navsym").rglob("*.py")):
        for node in tree_of(path).body:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not is_verb_of_the_command_line(path, node):
                places.setdefault(node.name, []).append(path.relative_to(root).as_posix())
    return {name: files for name, files in places.items() if len(files) > 1}, len(places)


def is_verb_of_the_command_line(path: Path, node: ast.stmt) -> bool:
    """True for the function ``command`` that every file of ``cli`` has."""
    return path.parent.name == "cli" and getattr(node, "name", "") == "command"


def test_a_file_holds_one_idea_and_a_function_does_one_step() -> None:
    assert not (found := too_long(tracked(".py"), ROOT)), "\n".join(["split:", *found])


def test_a_name_is_seldom_defined_twice() -> None:
    twice, names = ambiguous(ROOT)
    lines = [f"{name}: {', '.join(files)}" for name, files in sorted(twice.items(), key=lambda item: -len(item[1]))]
    assert len(twice) < AMBIGUOUS * names, "\n".join([f"{len(twice)} of {names} names are ambiguous:", *lines])


def auxiliary_imperatives(tree: ast.Module) -> list[str]:
    """Words of a program in which a remedy begins with *do*."""
    texts = (n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str))
    return [text for text in texts if re.search(r"; do [a-z]", text)]


def test_no_remedy_begins_with_do() -> None:
    files = (ROOT / "navsym").rglob("*.py")
    assert not {path.name: bad for path in files if (bad := auxiliary_imperatives(tree_of(path)))}
    assert auxiliary_imperatives(ast.parse('f"expected {x}; got {y}; do mend it"'))
    assert not auxiliary_imperatives(ast.parse('f"expected {x}; got {y}; mend it"'))


# Docstrings; their form is judged by ruff


def undocumented(tree: ast.Module, name: str, public: set[str]) -> Iterator[str]:
    """Public functions and classes without a docstring, and their long methods.

    Public is what another room or file imports, which ruff cannot see. A helper inside its file has its name and its
    neighbours to explain it.
    """
    for item in tree.body:
        if not isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) or item.name not in public:
            continue
        if not ast.get_docstring(item) and not is_plain(item):
            yield f"{name}:{item.lineno}: {item.name}"
        if isinstance(item, ast.ClassDef):
            yield from undocumented_methods(item, name)


def undocumented_methods(node: ast.ClassDef, name: str) -> Iterator[str]:
    """Long methods without a docstring; a property has its name to explain it."""
    for item in node.body:
        if not isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef) or item.name.startswith("_"):
            continue
        if len(item.body) > 6 and not ast.get_docstring(item) and not is_plain(item):
            yield f"{name}:{item.lineno}: {node.name}.{item.name}"


def imported_names(files: Iterable[Path]) -> dict[str, set[str]]:
    """Module -> the names that other files import from it."""
    names: dict[str, set[str]] = {}
    for path in files:
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("navsym"):
                names.setdefault(str(node.module), set()).update(alias.name for alias in node.names)
    return names


def is_plain(item: ast.stmt) -> bool:
    """A property or an overload: the class, or the function itself, says what it is."""
    marks = {getattr(d, "id", getattr(d, "attr", "")) for d in getattr(item, "decorator_list", ())}
    return bool(marks & {"property", "cached_property", "overload", "setter"})


def test_every_public_function_says_what_it_computes() -> None:
    files = [p for p in tracked(".py") if p.relative_to(ROOT).parts[0] in ("navsym", "derivations", "notebooks")]
    public = imported_names(files)
    found = []
    for path in files:
        place = path.relative_to(ROOT)
        if place.parts[0] == "navsym":
            names = public.get(".".join(place.with_suffix("").parts), set())
            found += undocumented(tree_of(path), place.as_posix(), names)
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
    files = [p for p in files if p.name != "programs.py"]  # of code in doubles, with the ranges of its test vectors
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


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A package with a long file, a long function, and a name that stands in two files."""
    (tmp_path / "navsym" / "cli").mkdir(parents=True)
    (tmp_path / "navsym" / "long.py").write_text("x = 1\n" * (LONGEST_FILE + 1))
    (tmp_path / "navsym" / "one.py").write_text("def f():\n" + "    g()\n" * LONGEST_FUNCTION + "def g(): ...\n")
    for name in "ab":
        (tmp_path / "navsym" / "cli" / f"{name}.py").write_text("def command(): ...\ndef g(): ...\n")
    return tmp_path


def test_what_is_too_long_or_ambiguous_is_found(house: Path) -> None:
    assert too_long(sorted(house.rglob("*.py")), house) == ["navsym/long.py: 701 lines", "navsym/one.py:1: f: 61 lines"]
    assert ambiguous(house) == ({"g": ["navsym/cli/a.py", "navsym/cli/b.py", "navsym/one.py"]}, 2)


def test_a_missing_docstring_is_found() -> None:
    source = '"""Title."""\ndef f(): ...\ndef g(): ...\nclass C:\n    pass\n'
    assert list(undocumented(ast.parse(source), "a.py", {"f", "C"})) == ["a.py:2: f", "a.py:4: C"]


def test_a_float_in_a_derivation_is_found_and_one_in_a_string_is_not() -> None:
    assert floats_in('"""0.1"""\nx = Rational("0.1")\ny = 0.1 * 1e3\nz = 2j\n', "a.py") == [
        "a.py:3: 0.1",
        "a.py:3: 1000.0",
        "a.py:4: 2j",
    ]


@pytest.mark.parametrize("text", ["see /home/someone/x", "open('/tmp/x')", "--index-url " + "https://a.b" + "/simple"])
def test_a_foreign_trace_is_found(text: str) -> None:
    assert traces_in(text)


@pytest.mark.parametrize("text", ["a/home/b", "derivations/trajectory.py", "~/.cache", "w / work / 2", "/"])
def test_ordinary_text_is_no_trace(text: str) -> None:
    assert not traces_in(text)
