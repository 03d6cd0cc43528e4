"""Every notebook runs from top to bottom with errors fatal, and holds no mathematics of its own."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent.parent / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.py"))


#: This one runs in the ten minutes, the others in CI.
FIRST = ("10_your_own_model",)


def as_parameter(path):
    """A notebook, long when it is not among the first."""
    return pytest.param(path, id=path.stem, marks=[] if path.stem in FIRST else [pytest.mark.long])


@pytest.mark.parametrize("path", [as_parameter(path) for path in NOTEBOOKS])
@pytest.mark.filterwarnings("ignore")
def test_the_notebook_runs(path, monkeypatch):
    monkeypatch.delenv("MPLBACKEND", raising=False)  # a kernel has its own, which shows pictures
    jupytext = pytest.importorskip("jupytext")
    nbclient = pytest.importorskip("nbclient")
    notebook = jupytext.read(path)
    client = nbclient.NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(FOLDER.parent)}}
    )
    client.execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    pictures = [data for output in outputs if "<Figure" in (data := output.get("data", {})).get("text/plain", "")]
    assert outputs and all("image/png" in data for data in pictures)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_notebook_is_a_percent_script_without_outputs_that_asserts_something(path):
    text = path.read_text(encoding="utf-8")
    assert "# %%" in text
    tree = ast.parse(text)
    asserts = [node for node in ast.walk(tree) if isinstance(node, ast.Assert)]
    assert asserts


def imports_of(path):
    """Modules that a notebook imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield str(node.module)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_notebook_uses_the_front_door_and_not_the_command_line(path):
    modules = list(imports_of(path))
    assert "navsym" in modules
    assert not [name for name in modules if name.startswith("navsym.cli")]


def test_a_model_of_ones_own_needs_one_import():
    assert list(imports_of(FOLDER / "10_your_own_model.py")) == ["navsym"]
