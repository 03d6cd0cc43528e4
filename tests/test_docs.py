"""The documentation builds with warnings fatal, and every block of it that can run is run."""

from __future__ import annotations

import ast
import doctest
import json
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
import warnings
from pathlib import Path

import pytest

from navsym.cli.main import run

DOCS = Path(__file__).parent.parent / "docs"
PAGES = sorted(DOCS.glob("*.md"))
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
BLOCK = re.compile(r"^(?P<indent> *)```(?P<kind>\w+)\n(?P<body>.*?)^ *```$", re.M | re.S)


def blocks(path):
    for found in BLOCK.finditer(path.read_text(encoding="utf-8")):
        yield found["kind"], textwrap.dedent(found["body"])


#: Pages that take more than five seconds of processor time.
LONG = ("cookbook", "gallery", "model_files", "python", "worst_correlation")
RUNNING = [path for path in PAGES if any(kind in ("python", "sh", "toml") for kind, _ in blocks(path))]


@pytest.mark.parametrize(
    "path", [pytest.param(p, id=p.stem, marks=[pytest.mark.long] if p.stem in LONG else []) for p in RUNNING]
)
def test_every_block_runs_in_order(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(DOCS.parent / "examples", tmp_path / "examples")
    script, said = [], ""
    for kind, body in blocks(path):
        if kind == "text":  # what the commands above it print, a line or its beginning
            assert [line for line in body.splitlines() if spaced(line) not in said] == [], said
        elif kind == "toml":
            (tmp_path / body.splitlines()[0].removeprefix("# file: ")).write_text(body, encoding="utf-8")
        elif kind == "sh":
            capsys.readouterr()
            for line in body.splitlines():
                program, *words = shlex.split(line)
                assert program == "navsym" and run(words) == 0, (line, capsys.readouterr())
            said = spaced(capsys.readouterr().out)
        elif kind == "python":
            if "import pint" in body:
                pytest.importorskip("pint", reason="pint is not installed: pip install 'navsym[units]'")
            script.append(body)
    if script:
        run_script(script)


def run_script(bodies):
    """The Python of a page in a namespace of its own, as a session when it has prompts."""
    names, text = {"__name__": "page"}, "\n".join(bodies)
    with warnings.catch_warnings():
        warnings.simplefilter("default")  # as in a process of its own
        if ">>>" not in bodies[0]:
            exec(compile(text, "page.py", "exec", dont_inherit=True), names)
            return
        session = doctest.DocTestParser().get_doctest(text, names, "page", None, 0)
        failures = []
        doctest.DocTestRunner(optionflags=FLAGS, verbose=False).run(session, out=failures.append)
        assert not failures, "".join(failures)


def spaced(text):
    """Text with single spaces: a table may be wider or narrower."""
    return " ".join(text.split())


def test_the_blocks_are_found():
    assert sum(kind == "sh" for path in RUNNING for kind, _ in blocks(path)) >= 6


@pytest.mark.long
def test_the_site_builds_without_a_warning(tmp_path):
    for needed in ("sphinx", "myst_nb", "furo"):
        pytest.importorskip(needed)
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-d", str(tmp_path / "d")]
    done = subprocess.run(
        [*command, str(DOCS), str(tmp_path / "site")], capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert "Riccati" in (tmp_path / "site" / "new_paper.html").read_text(encoding="utf-8")
    assert "nav.prove" in (tmp_path / "site" / "reference" / "0_python.html").read_text(encoding="utf-8")
    for path in (tmp_path / "site").rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert 'class="math"><code>' not in text, f"{path.name}: a formula that is not set in type"
        assert not re.search(r"<(script|link|img)[^>]*(src|href)=\"https?:", text), f"{path.name} asks a network"


def test_the_glossary_has_three_languages_in_every_line():
    rows = [line for line in (DOCS / "glossary.md").read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    assert len(rows) > 25
    for row in rows[2:]:
        english, russian, ukrainian = (cell.strip() for cell in row.strip("|").split("|"))
        assert english.isascii() and re.search("[а-яё]", russian) and re.search("[а-яієїґ]", ukrainian)
        assert not re.search("[ыэёъ]", ukrainian) and not re.search("[ієїґ]", russian)


def test_the_picture_of_the_readme_agrees_with_the_ledger():
    ledger = json.loads((DOCS.parent / "derivations" / "verdicts.json").read_text(encoding="utf-8"))
    picture = (DOCS / "pictures" / "verdicts.svg").read_text(encoding="utf-8")
    assert "docs/pictures/verdicts.svg" in (DOCS.parent / "README.md").read_text(encoding="utf-8")
    for module in ("guaranteed_velocity", "joint_correction", "multistructure", "terrain_search", "trajectory"):
        statuses = [record["status"] for record in ledger["claims"] if record["paper"] == module]
        words = f"{len(statuses)} claims, {statuses.count('REFUTED')} refuted"
        assert words in picture, f"{module}: run python docs/pictures.py verdicts"


def test_every_picture_of_the_site_is_made_by_the_command():
    tree = ast.parse((DOCS / "pictures.py").read_text(encoding="utf-8"))
    table = next(n.value for n in tree.body if isinstance(n, ast.AnnAssign) and n.target.id == "PICTURES")
    made = {key.value for key in table.keys}
    assert {path.stem for path in (DOCS / "pictures").glob("*.svg")} == made
    used = set(re.findall(r"pictures/(\w+)\.svg", (DOCS / "pictures.md").read_text(encoding="utf-8")))
    assert used == made


def test_every_screenshot_is_made_by_its_command_and_shown_once():
    made = re.findall(r'photograph\(browser, "(\w+)"\)|"(\w+)": \("', (DOCS / "screens.py").read_text(encoding="utf-8"))
    names = sorted(one or other for one, other in made)
    assert names == sorted(path.stem for path in (DOCS / "pictures").glob("*.png"))
    texts = [path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")]
    assert sorted(name for text in texts for name in re.findall(r"pictures/(\w+)\.png", text)) == names
