"""The reference of the documentation is complete, and what a user calls is documented to the standard."""

from __future__ import annotations

import ast
import importlib.util
import re
import sys
from pathlib import Path

DOCS = Path(__file__).parent.parent / "docs"


def test_the_reference_has_every_folder_and_every_entry_point(tmp_path):
    entry_points, pages = tool("entry_points"), tool("reference_pages")
    pages.write_reference(tmp_path)
    first = (tmp_path / "0_entry_points.md").read_text(encoding="utf-8")
    points = entry_points.entry_points()
    assert len(points) > 100
    for point in points:
        assert f"### {point.node.name}\n" in first, point.name
    rooms = {path.parent for path in (DOCS.parent / "navsym").rglob("*.py")}
    names = {"_".join(path.relative_to(DOCS.parent / "navsym").parts) for path in rooms}
    left_out = {name for name in names if not (tmp_path / f"{name}.md").exists()}
    assert left_out <= {"", "cli"}, left_out


def test_what_a_user_calls_says_what_it_computes_with_shapes_and_errors():
    """The standard of docstrings: a sentence first, the shape of arrays, and what is raised."""
    troubles = [trouble for point in tool("entry_points").entry_points() for trouble in troubles_of(point)]
    assert not troubles, "\n".join(troubles)


def test_the_standard_of_docstrings_can_fall():
    source = """
def poor(x: Array) -> float:
    if not len(x):
        raise EmptyError("x")
    return x[0]
"""
    node = ast.parse(source).body[0]
    point = tool("entry_points").EntryPoint("navsym.core.arrays", node)
    lacking = [trouble.split(": ")[1] for trouble in troubles_of(point)]
    assert lacking == ["a sentence first", "raises EmptyError", "a shape"]


def tool(name):
    """A module of the folder of the documentation."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(DOCS))
    try:
        sys.modules[name] = module
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(DOCS))
    return module


def troubles_of(point):
    """What the docstring of an entry point lacks."""
    doc = point.docstring
    if not re.match(r"\S.*[.:](\s|$)", " ".join(doc.split("\n\n")[0].split())):
        yield f"{point.name}: a sentence first"
    if isinstance(point.node, ast.FunctionDef):
        raised = errors_of(point)
        if raised and "aises" not in doc and "the same errors" not in doc:
            yield f"{point.name}: raises {', '.join(sorted(raised))}"
        types = [argument.annotation for argument in ast.walk(point.node.args) if isinstance(argument, ast.arg)]
        text = " ".join(ast.unparse(kind) for kind in [*types, point.node.returns] if kind is not None)
        if re.search("Array|ndarray", text) and not re.search(r"\(\w+(, ?\w+)*,?\)", doc):
            yield f"{point.name}: a shape"


def errors_of(point, deep=3):
    """Names of the errors that a function, or a helper of its file that it calls, raises."""
    path = DOCS.parent.joinpath(*point.module.split(".")).with_suffix(".py")
    helpers = {n.name: n for n in ast.parse(path.read_text(encoding="utf-8")).body if isinstance(n, ast.FunctionDef)}
    found, seen, waiting = set(), set(), [(point.node, deep)]
    while waiting:
        node, left = waiting.pop()
        for part in ast.walk(node):
            if isinstance(part, ast.Raise) and part.exc is not None:
                what = part.exc.func if isinstance(part.exc, ast.Call) else part.exc
                name = getattr(what, "id", getattr(what, "attr", ""))
                found |= {name} if name.endswith("Error") else set()
            called = getattr(getattr(part, "func", None), "id", None)
            if left and called in helpers and called not in seen:
                seen.add(called)
                waiting.append((helpers[called], left - 1))
    return found
