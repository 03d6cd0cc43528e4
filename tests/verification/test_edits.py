"""A claim that an edit makes false is REFUTED at once, wherever the edit was, and PROVED again when it is mended."""

from __future__ import annotations

import contextlib
import io
import json
import pickle
import sqlite3
import zipfile

import numpy as np
import pytest

import navsym as nav
from tests.sampling import thinned

HOLDS = ("PROVED", "CERTIFIED")

#: Where the factor comes from -> (lines before the claim, the factor); {n} is 2, or 3 after the edit.
IN_THE_FILE = {
    "a registered function": (
        "TABLE = {{}}\n\ndef register(f):\n    TABLE[f.__name__] = f\n    return f\n\n"
        "@register\ndef two():\n    return {n}\n",
        "TABLE['two']()",
    ),
    "singledispatch": (
        "import functools\n\n@functools.singledispatch\ndef two(k):\n    return 5\n\n"
        "@two.register\ndef _(k: int):\n    return {n}\n",
        "two(0)",
    ),
    "a subclass": (
        "KNOWN = []\n\nclass Base:\n    def __init_subclass__(cls):\n        KNOWN.append(cls)\n\n"
        "class Own(Base):\n    two = {n}\n",
        "KNOWN[0].two",
    ),
    "an update": ("COEFF = {{'k': 7}}\n_ = COEFF.update(k={n})\n", "COEFF['k']"),
    "a descriptor": (
        "class Give:\n    def __set_name__(self, owner, name):\n        owner.two = {n}\n\n"
        "class Own:\n    give = Give()\n",
        "Own.two",
    ),
    "a metaclass": (
        "class Meta(type):\n    def __new__(cls, name, bases, body):\n"
        "        return super().__new__(cls, name, bases, body | {{'two': {n}}})\n\n"
        "class Own(metaclass=Meta):\n    pass\n",
        "Own.two",
    ),
    "a module's getattr": (
        "import sys\n\ndef __getattr__(name):\n    if name == 'two':\n        return {n}\n"
        "    raise AttributeError(name)\n",
        "sys.modules[__name__].two",
    ),
    "a partial": ("import functools\ntwo = functools.partial(max, 1, {n})\n", "two()"),
    "a factory of defaults": (
        "import dataclasses\n\n@dataclasses.dataclass\nclass Own:\n"
        "    two: int = dataclasses.field(default_factory=lambda: {n})\n",
        "Own().two",
    ),
    "text that is executed": ("exec('two = ' + '{n}')\n", "two"),
    "a function that another call replaces": (
        "def two():\n    return 9\n\ntwo.__code__ = (lambda: {n}).__code__\n",
        "two()",
    ),
    "a value in a container of a container": ("import itertools\nROWS = [iter([{n}])]\n", "next(ROWS[0])"),
}


def archive(text: str) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as file:
        file.writestr("zipped_factor.py", text)
    return data.getvalue()


def array(n: int) -> bytes:
    data = io.BytesIO()
    np.save(data, np.array([n]))
    return data.getvalue()


#: What the claim reads -> (file beside the paper, its content for a factor, lines before the claim, the factor).
IN_A_FILE = {
    "a second package": (
        "../second_package/__init__.py",
        lambda n: f"TWO = {n}\n".encode(),
        "from second_package import TWO\n",
        "TWO",
    ),
    "a package by a computed name": (
        "../third_package.py",
        lambda n: f"TWO = {n}\n".encode(),
        "import importlib\nthird = importlib.import_module('third' + '_package')\n",
        "third.TWO",
    ),
    "a zip archive": (
        "../packed.zip",
        lambda n: archive(f"TWO = {n}\n"),
        "import sys, pathlib\nsys.path.insert(0, str(pathlib.Path(__file__).parents[1] / 'packed.zip'))\n"
        "import zipped_factor\nsys.path.pop(0)\nsys.path_importer_cache.clear()\n",
        "zipped_factor.TWO",
    ),
    "json.load": (
        "factor.json",
        lambda n: json.dumps({"two": n}).encode(),
        "import json, pathlib\nPLACE = pathlib.Path(__file__).with_name('factor.json')\n",
        "json.load(PLACE.open())['two']",
    ),
    "read_text": (
        "factor.txt",
        lambda n: str(n).encode(),
        "import pathlib\nTWO = int(pathlib.Path(__file__).with_name('factor.txt').read_text())\n",
        "TWO",
    ),
    "np.load": (
        "factor.npy",
        array,
        "import numpy, pathlib\nPLACE = pathlib.Path(__file__).with_name('factor.npy')\n",
        "int(numpy.load(PLACE)[0])",
    ),
    "a pickle": (
        "factor.pkl",
        lambda n: pickle.dumps(n),
        "import pickle, pathlib\nPLACE = pathlib.Path(__file__).with_name('factor.pkl')\n",
        "pickle.loads(PLACE.read_bytes())",
    ),
    "the size of a file": (
        "factor.bin",
        lambda n: b" " * n,
        "import pathlib\nPLACE = pathlib.Path(__file__).with_name('factor.bin')\n",
        "PLACE.stat().st_size",
    ),
}


def require_change(papers, edit):
    """PROVED with 2; REFUTED, however it is asked, with 3; PROVED again with 2. ``edit`` sets the factor."""
    edit(2)
    papers.verify().write()
    assert papers.status() == "PROVED"
    edit(3)
    assert papers.status() == "REFUTED"
    papers.forget()
    assert nav.cite("tiny:1").status == "REFUTED"
    assert papers.status(fresh=True) == "REFUTED"
    edit(2)
    assert papers.status() == "PROVED"


@pytest.mark.parametrize("where", thinned([name] for name in IN_THE_FILE))
def test_an_edit_of_the_paper(papers, where):
    helper, two = IN_THE_FILE[where]
    require_change(papers, lambda n: papers.add("tiny", helper.format(n=n), two))


@pytest.mark.parametrize("where", thinned([name] for name in IN_A_FILE))
def test_an_edit_of_another_file(papers, where):
    name, content, helper, two = IN_A_FILE[where]
    papers.add("tiny", helper, two)
    place = papers.folder / name
    place.parent.mkdir(exist_ok=True)
    require_change(papers, lambda n: place.write_bytes(content(n)))


def test_an_edit_of_a_file_in_the_folder_of_a_paper(papers):
    papers.write("tiny/__init__.py", "from navsym_papers.tiny.factor import PAPER\n")
    head = "from navsym.claims import Paper\nPAPER = Paper('tiny', 'Tiny', (), 2026, 'none', 'English', equations=())\n"
    claim = (
        "import sympy as sp\nfrom navsym.claims import Equation, claim\nfrom navsym_papers.tiny.factor import TWO\n"
        "x = sp.Symbol('x', real=True)\n\n@claim('1')\ndef doubled():\n    'Twice.'\n"
        "    return Equation(x + x, TWO*x)\n"
    )
    papers.write("tiny/one.py", claim)
    require_change(papers, lambda n: papers.write("tiny/factor.py", f"{head}TWO = {n}\n"))


def test_a_change_of_an_environment_variable(papers, monkeypatch):
    papers.add("tiny", "import os\n", "int(os.environ['FACTOR'])")
    require_change(papers, lambda n: monkeypatch.setenv("FACTOR", str(n)))


def test_an_edit_of_a_database(papers):
    papers.add(
        "tiny",
        "import sqlite3, pathlib\nPLACE = pathlib.Path(__file__).with_name('factors.db')\n",
        "sqlite3.connect(PLACE).execute('select max(two) from factors').fetchone()[0]",
    )

    def edit(n: int) -> None:
        with contextlib.closing(sqlite3.connect(papers.folder / "factors.db")) as base:
            base.executescript(
                f"drop table if exists factors; create table factors (two); insert into factors values ({n})"
            )

    require_change(papers, edit)


def test_a_link_that_points_elsewhere(papers):
    papers.add("tiny", "import pathlib\n", "int(pathlib.Path(__file__).with_name('link').read_text())")
    for n in (2, 3):
        papers.write(f"factor{n}.txt", str(n))

    def edit(n: int) -> None:
        (papers.folder / "link").unlink(missing_ok=True)
        (papers.folder / "link").symlink_to(f"factor{n}.txt")

    require_change(papers, edit)


@pytest.mark.parametrize(
    ("true", "false"),
    [
        ("Bound(x, '<=', 1, {x: (0, 1)})", "Bound(x, '<=', 1, {x: (0, 2)})"),
        ("Bound(x**2 + 1, '>', 0)", "Bound(x**2 + 1, '<', 0)"),
        ("Bound(x, '>=', 0, {x: (0, 1)})", "Bound(x, '>', 0, {x: (0, 1)})"),
        ("Equation(sp.Rational(1, 3), sp.Rational(33, 100), tolerance=sp.Rational(1, 200))",
         "Equation(sp.Rational(1, 3), sp.Rational(33, 100), tolerance=sp.Rational(1, 2000))"),
        ("Equation(sp.Matrix([x + x, x]), sp.Matrix([2*x, x]))",
         "Equation(sp.Matrix([x + x, x]), sp.Matrix([2*x, x + 1]))"),
        ("Bound(y**3, '>=', 0)", "Bound(z**3, '>=', 0)"),
    ],
    ids=["the end of a range", "the relation", "strictness", "the tolerance", "an entry", "what a symbol declares"],
)  # fmt: skip
def test_an_edit_of_the_statement_beside_its_sides(papers, true, false):
    symbols = "y, z = sp.Symbol('y', nonnegative=True), sp.Symbol('z', real=True)\n"
    for statement, statuses in ((true, HOLDS), (false, ("REFUTED",)), (true, HOLDS)):
        papers.add("tiny", symbols, statement=statement)
        assert papers.status() in statuses
