"""The reference has every public name and every verb, and the docstring of each public name meets the standard."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import sys
import textwrap
from pathlib import Path

import pytest

import navsym as nav
from navsym.cli.main import verbs

DOCS = Path(__file__).parent.parent / "docs"
CALLED = [
    name for name in nav.__all__ if callable(getattr(nav, name)) and not isinstance(getattr(nav, name), nav.Status)
]


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The pages of the reference, by name."""
    sys.path.insert(0, str(DOCS))
    try:
        folder = tmp_path_factory.mktemp("reference")
        importlib.import_module("reference_pages").write_reference(folder)
    finally:
        sys.path.remove(str(DOCS))
    return {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.md")}


def test_every_public_name_is_in_the_reference(pages):
    sections = dict(re.findall(r"^## (\w+)\n\n(.*?)(?=^## |\Z)", pages["0_python.md"], re.M | re.S))
    assert set(sections) == {name for name in nav.__all__ if not name.startswith("__")}


def test_the_front_door_lists_what_one_calls():
    """What an editor completes after ``nav.`` fits one screen; types of answers are there for annotations."""
    assert 15 <= sum(not name.startswith("_") for name in dir(nav)) <= 45
    assert all(inspect.isclass(getattr(nav, name)) for name in set(nav.__all__) - set(dir(nav)))


def test_every_verb_and_every_option_is_in_the_reference(pages):
    sections = dict(re.findall(r"^## ([\w-]+)\n\n(.*?)(?=^## |\Z)", pages["1_verbs.md"], re.M | re.S))
    assert set(sections) == set(verbs())
    for verb, text in sections.items():
        assert f"Example: navsym {verb}" in text and "--json" in text, verb
        silent = re.findall(r"^  (--[\w-]+|\w[\w.]*) <[^>]*>\s*$\n(?=  \S|\n|`)", text, re.M)
        assert silent == [], f"{verb}: {silent} without a word of help"


def test_public_docstrings_say_results_shapes_and_errors():
    troubles = [f"{name}: {trouble}" for name in CALLED for trouble in troubles_of(getattr(nav, name))]
    assert not troubles, "\n".join(troubles)


def poor(x: list[float] | np.ndarray) -> float:  # noqa: F821
    """mean"""  # noqa: D400
    if not len(x):
        raise nav.NavsymError("x")
    return x[0]


def test_the_standard_of_docstrings_can_fall():
    assert list(troubles_of(poor)) == ["a sentence first", "raises NavsymError", "a shape"]


def troubles_of(value):
    """Parts of the standard that a docstring lacks: a sentence first, the errors, the shape of arrays."""
    doc = inspect.getdoc(value) or ""
    if not re.match(r"\S.*[.:](\s|$)", " ".join(doc.split("\n\n")[0].split())):
        yield "a sentence first"
    if inspect.isfunction(value):
        raised = errors_of(value)
        if raised and "aises" not in doc:
            yield f"raises {', '.join(sorted(raised))}"
        if re.search("Array|ndarray", str(inspect.signature(value))) and not re.search(r"\(\w+(, ?\w+)*,?\)", doc):
            yield "a shape"


def errors_of(function, depth=3):
    """Names of the errors that a function, or a helper of its module that it calls, raises."""
    names = set()
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
        if isinstance(node, ast.Raise) and node.exc is not None:
            raised = ast.unparse(node.exc.func if isinstance(node.exc, ast.Call) else node.exc)
            names.add(raised.rpartition(".")[2])
        helper = function.__globals__.get(getattr(getattr(node, "func", None), "id", ""))
        if depth and inspect.isfunction(helper) and helper.__module__ == function.__module__:
            names |= errors_of(helper, depth - 1)
    return {name for name in names if name.endswith("Error")}
