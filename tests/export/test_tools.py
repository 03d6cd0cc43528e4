"""What other programs say about exported code is said as it is: found, not found, or not executed."""

from __future__ import annotations

import importlib
import importlib.util
import json
import shutil
import sys
from pathlib import Path

import pytest
import sympy as sp

from navsym.claims import Equation
from navsym.cli.main import run
from navsym.export import tools
from navsym.export.functions import function_of, material
from navsym.export.languages import targets
from navsym.export.languages.targets import TARGETS
from navsym.export.package import Order, files_of
from navsym.export.parts import Layout
from navsym.export.roundtrip import run_target
from navsym.prove.ladder import decide
from tests.export import programs, samples
from tests.report.devtools import Browser


@pytest.fixture(scope="module")
def table():
    """The script that makes docs/exports.md."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "docs"))
    try:
        yield importlib.import_module("exports_table")
    finally:
        sys.path.pop(0)


def written(functions, language: str, folder: Path, count: int = 6) -> Path:
    for name, text in files_of(functions, Order((TARGETS[language],), count=count)).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder / language


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="needs cppcheck with its MISRA add-on")
def test_misra_findings_are_deviations_that_are_written_down(tmp_path: Path) -> None:
    folder = written(programs.functions("trajectory-filter"), "c", tmp_path)
    said = tools.misra(folder)
    assert said.status == "passed" and set(said.counts) <= set(tools.DEVIATIONS) and said.counts
    assert all(rule in (folder / "MISRA_DEVIATIONS.md").read_text() for rule in said.counts)


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="needs cppcheck with its MISRA add-on")
def test_a_part_with_a_hole_in_two_sources_breaks_no_other_rule(tmp_path: Path) -> None:
    a = sp.Symbol("a", real=True)
    quotient = sp.log(1 + a) / a
    functions = [
        function_of([samples.of_statement(name, Equation(form, form, {a: (0, 1)}))])
        for name, form in (("one", quotient), ("two", 2 + quotient))
    ]
    said = tools.misra(written(functions, "c", tmp_path))
    assert said.status == "passed" and "5.9" in said.counts, said.why


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="needs cppcheck with its MISRA add-on")
def test_a_broken_rule_without_a_deviation_is_a_failure(tmp_path: Path) -> None:
    body = "    if (a) goto end;\n    a = 07;\nend:\n    return a;\n"
    (tmp_path / "bad.c").write_text(f"int f(int a);\nint f(int a)\n{{\n{body}}}\n")
    said = tools.misra(tmp_path)
    assert said.status == "failed" and "rules broken" in said.why


@pytest.mark.skipif(shutil.which("cmake") is None, reason="needs cmake")
def test_ctest_runs_the_vectors(table, tmp_path: Path) -> None:
    functions = [samples.by_name("versine"), *programs.functions("trajectory-filter")]
    for language in ("c", "cpp"):
        folder = written(functions, language, tmp_path)
        said = table.ctest(folder)
        assert said.status == "passed", said.why
        before = sorted(p.name for p in folder.iterdir())
        assert "CMakeCache.txt" not in before


def test_a_missing_tool_is_not_executed_and_says_what_to_install(table, tmp_path: Path, monkeypatch) -> None:
    for place in (tools, table):
        monkeypatch.setattr(place, "answering", lambda name: None)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    for said in (tools.misra(tmp_path), table.ctest(tmp_path), table.cortex_m4_sizes(tmp_path)):
        assert said.status == "not executed" and "install" in said.why


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="needs ziglang (extra cross)")
def test_the_size_on_a_cortex_m4_is_measured(table, tmp_path: Path) -> None:
    said = table.cortex_m4_sizes(written([samples.by_name("versine")], "c", tmp_path))
    assert said.status == "passed" and 40 < said.counts["sample_versine"] < 2000
    assert table.loaded_bytes(b"no object at all") == 0


@pytest.mark.browser
@pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None or shutil.which("chromium") is None,
    reason="needs ziglang (extra cross) and chromium",
)
def test_the_page_computes_shows_and_stays_offline(tmp_path: Path) -> None:
    functions = [samples.by_name(name) for name in ("Phi33", "velocity_correction_y3", "rotation")]
    folder = written(functions, "html", tmp_path)
    outcome = run_target(folder, TARGETS["html"])
    assert outcome.status == "verified" and len(outcome.functions) == 3, outcome.why
    browser = Browser(tmp_path / "profile")
    try:
        browser.open((folder / "index.html").resolve().as_uri())
        text = browser.value("new Promise(done => setTimeout(() => done(document.body.innerText), 300))") or ""
        text = browser.value("document.body.innerText")
        assert "PROVED" in text and "guaranteed_velocity:4.12.Phi33" in text and "wrong 0" in text
        cells = "[...document.querySelectorAll('section')][0].querySelectorAll('table tr')[1].children"
        field = "document.querySelector('section input')"
        browser.value(f"{field}.value = '1.25'; {field}.dispatchEvent(new Event('input'))")
        value = float(browser.value(f"{cells}[1].textContent"))
        low, high = json.loads(browser.value(f"{cells}[2].textContent"))
        exact = (1 - 2 * sp.cos(sp.Rational(5, 8))) / (4 * sp.sin(sp.Rational(5, 16)) ** 2)
        assert low <= value <= high and low < float(exact.evalf(30)) < high and high - low < 1e-13
        browser.value(f"{field}.value = '9'; {field}.dispatchEvent(new Event('input'))")
        assert "outside the proved domain" in browser.value("document.querySelector('table').innerText")
        assert not browser.trouble, browser.trouble
    finally:
        browser.close()


def test_text_of_a_claim_cannot_leave_the_script_of_the_page() -> None:
    from navsym.export.languages import wasm

    a = sp.Symbol("a", real=True)
    statement = Equation(sp.sin(a) + 1, 1 + sp.sin(a))
    hostile = "</script><img src=x onerror=alert(1)>"
    function = function_of([material("m:1", statement, decide(statement), title=hostile, paper=hostile)])
    original, wasm.compiled = wasm.compiled, lambda *_: b""
    try:
        text = wasm.page_files([function], {function.name: []}, "x")["index.html"]
    finally:
        wasm.compiled = original
    assert "<img" not in text and text.count("</script>") == 2


# -- the table ---------------------------------------


def test_the_table_says_what_ran_and_what_did_not(table, monkeypatch) -> None:
    chosen = [TARGETS[n] for n in ("python", "julia")]
    monkeypatch.setattr(targets, "answers", lambda path: False)
    document = table.closing_table({"g": [samples.by_name("Phi33")]}, chosen, 6)
    (record,) = document["functions"]
    assert record["languages"]["python"]["status"] == "verified" and record["languages"]["julia"]["worst"] is None
    assert document["languages"]["julia"]["status"] == "not executed" and record["misra"] is None
    page = table.as_markdown(document, "python docs/exports_table.py")
    assert "julia | not executed" in page and "| guaranteed_velocity_4_12_Phi33 |" in page


def test_the_table_is_the_same_with_several_at_work(table) -> None:
    groups = {"g": [samples.by_name("Phi33")], "h": [samples.by_name("versine")]}
    said: list[str] = []
    chosen = [TARGETS["python"]]
    tables = [table.closing_table(groups, chosen, 6, said.append, points=64, jobs=jobs) for jobs in (1, 2)]
    assert tables[0] == tables[1] and tables[0]["functions"][1]["points"]["points"] >= 64
    assert sorted(said[:4]) == sorted(said[4:]) and "g languages" in said and "sample_versine points" in said


def test_the_table_names_what_is_ready_made(table, capsys) -> None:
    with pytest.raises(SystemExit) as ended:
        table.main(["no-such", "--json"])
    assert ended.value.code == 2 and "velocity-correction" in capsys.readouterr().err


# -- units ---------------------------------------


def test_units_stand_in_headers_and_manifest(tmp_path: Path, capsys) -> None:
    words = ["export", "guaranteed_velocity:4.12.Phi33", "--no-run", "--vectors", "4", "--unit", "value=1"]
    assert run([*words, "--out", str(tmp_path / "o"), "--json"]) == 0
    capsys.readouterr()
    header = (tmp_path / "o" / "c" / "guaranteed_velocity_4_12_Phi33.h").read_text()
    assert "[1/omega_0 (Schuler time)]" in header and "Result   value [1]" in header
    (function,) = json.loads((tmp_path / "o" / "manifest.json").read_text())["functions"]
    assert function["inputs"][0]["unit"].startswith("1/omega_0") and function["outputs"][0]["unit"] == "1"
    assert run(["export", "guaranteed_velocity:4.12.Phi33", "--unit", "T", "--out", str(tmp_path / "p")]) == 2


def test_a_unit_that_nobody_stated_is_not_invented() -> None:
    a = sp.Symbol("a", real=True)
    statement = Equation(a + 1, 1 + a)
    function = function_of([material("m:1", statement, decide(statement))], layout=Layout(units={"a": "m"}))
    assert function.inputs[0].unit == "m" and function.outputs[0].unit == ""
