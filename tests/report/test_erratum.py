"""Erratum sheets: worded for an editor, complete, and real LaTeX."""

from __future__ import annotations

import importlib
import json
import math
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from xml.dom import minidom

import numpy as np
import pytest

import navsym as nav
from navsym.claims import Paper, Record, claims_of
from navsym.core.errors import NavsymError
from navsym.language.expression import parse
from navsym.report.erratum import erratum_of
from navsym.report.formula.latex import mathml, sentence_html, sentence_latex
from navsym.report.page import TEMPLATES, environment
from navsym.report.wording import pattern_of, read_wording
from navsym.verification.ledger import Ledger
from tests.report.hostile import ledger, site

DERIVATIONS = Path(__file__).parents[2] / "derivations"
LEDGER = Ledger.from_json(json.loads((DERIVATIONS / "verdicts.json").read_text(encoding="utf-8")))
SHEETS = sorted((DERIVATIONS / "errata").glob("*.toml"))
MODULES = [path.stem for path in SHEETS]


def words_of(module):
    path = DERIVATIONS / "errata" / f"{module}.toml"
    return read_wording(path.read_text(encoding="utf-8"), path.name)


def refuted(module):
    """Numbers of the claims that the source declares to be slips, each cause once."""
    package = importlib.import_module(f"navsym_papers.{module}")
    slips = [claim.number for claim in claims_of(package) if claim.expect == "REFUTED" and claim.slip]
    return [number for number in slips if number not in package.PAPER.causes]


# -- wording ---------------------------------------------------------------------------------


def test_every_paper_with_a_slip_has_a_sheet():
    assert {r.paper for r in LEDGER if r.status == "REFUTED" and r.slip} == set(MODULES)


@pytest.mark.parametrize("module", MODULES)
def test_every_slip_is_worded_and_no_wording_is_left_over(module):
    words, numbers = words_of(module), refuted(module)
    assert [n for n in numbers if pattern_of(n, words) is None] == []
    assert set(words) - {pattern_of(n, words) for n in numbers} == set()


PLACES = (
    "equation|section|formula|table|paragraph|definition|matrix|after|before|experiment|studies|study|measure|rule|"
    "system|model|conclusion|case|sentence|criterion"
)


@pytest.mark.parametrize("module", MODULES)
def test_a_correction_names_a_place_changes_something_and_gives_a_reason(module):
    for number, worded in words_of(module).items():
        assert worded.printed != worded.correct, number
        assert re.search(PLACES, worded.where, re.I), number
        assert worded.why.rstrip().endswith((".", ")", "?")), number


@pytest.mark.parametrize("module", MODULES)
def test_every_correction_can_be_seen_in_numbers(module):
    card = importlib.import_module(f"navsym_papers.{module}").PAPER
    entries = erratum_of(card, [r for r in LEDGER if r.paper == module], words_of(module)).entries
    assert [e.ids[0] for e in entries if not (e.check or e.rows or (e.words and e.words.check))] == []


def folded(prior, stay, likelihood):
    """Numerators of Bayes' rule for a state of two values, and the denominator with the transition squared."""
    step = [[stay, 1 - stay], [1 - stay, stay]]
    ahead = [sum(prior[i] * step[i][j] ** power for i in (0, 1)) for power in (1, 2) for j in (0, 1)]
    return [likelihood[j] * ahead[j] for j in (0, 1)], sum(likelihood[j] * ahead[2 + j] for j in (0, 1))


def spread(weights, estimates):
    """Terms of (13) with unit covariances: weight times one and the square of the distance to the estimate."""
    mean = sum(w * x for w, x in zip(weights, estimates, strict=True))
    return [w * (1 + (x - mean) ** 2) for w, x in zip(weights, estimates, strict=True)]


def variance_after(y):
    """Of one state with P(0) = 1: a jump of variance 25 or none, each with 1/2, then y with the variance 1."""
    ahead = (1, 26)
    likely = [math.exp(-y * y / (2 * (p + 1))) / math.sqrt(p + 1) for p in ahead]
    weights, gains = [one / sum(likely) for one in likely], [p / (p + 1) for p in ahead]
    mean = sum(w * k * y for w, k in zip(weights, gains, strict=True))
    return sum(w * (k + (k * y - mean) ** 2) for w, k in zip(weights, gains, strict=True))


def excess(e, moved, spread=1):
    """Kurtosis less 3 of N(0, 1) with the weight 1 - e and a Gaussian of some variance at a squared distance, e."""
    near, far = e * e * moved, (1 - e) ** 2 * moved
    second = (1 - e) * (1 + near) + e * (spread + far)
    fourth = (1 - e) * (3 + 6 * near + near**2) + e * (3 * spread**2 + 6 * spread * far + far**2)
    return fourth / second**2 - 3


def worst_turn(speed):
    """Left over right side of the first assumption on the worst great circle; s: speed over that of the ground."""
    s = speed / (7.292115e-5 * 6378137)
    return s / math.sqrt(1 - s * s)


def gain_of_unit_columns(n, tau):
    """Condition number of the rows (1, x tau, ..., (x tau)^(n-1)/(n-1)!), x = 1 to n, over that with unit columns."""
    rows = [[(x * tau) ** k / math.factorial(k) for k in range(n)] for x in range(1, n + 1)]
    columns = np.array(rows)
    return np.linalg.cond(columns) / np.linalg.cond(columns / np.linalg.norm(columns, axis=0))


(ABOVE, BELOW), SQUARED = folded((0.5, 0.5), 0.9, (0.8, 0.2))
EARTH = 6.371e6
FIGURES = [  # claim, the figure as the sheet has it, and what it is
    ("multistructure:7", "0.41", SQUARED),
    ("multistructure:7", "1.22", (ABOVE + BELOW) / SQUARED),
    ("multistructure:13", "1.21", sum(spread((0.3, 0.7), (0, 1)))),
    ("multistructure:13", "0.894", 2 * spread((0.3, 0.7), (0, 1))[0]),
    ("multistructure:13", "1.526", 2 * spread((0.3, 0.7), (0, 1))[1]),
    ("guaranteed_velocity:4.11.N", "0.414", 4 * math.sin(math.pi / 4) * math.sin(math.pi / 8) ** 2),
    ("multistructure:20.integral", "0.74", 0.9 * 0.8 + 0.1 * 0.2),
    ("multistructure:4.type", "5.4", 1e7 * math.tan(math.radians(60)) / (6.37e6 * math.cos(math.radians(60)))),
    ("multistructure:2.growth.every", "20", 0.1 * 628 / math.pi),
    ("multistructure:18.next", "1.233", variance_after(3)),
    ("multistructure:18.next", "0.659", variance_after(1)),
    ("multistructure:near", "1.15", excess(0.1, 10)),
    ("multistructure:near", "2.5", excess(1e-6, 1e6) / 1e5),
    ("multistructure:near", "73.5", excess(0.01, 0, 100)),
    ("guaranteed_velocity:4.14.y2", "2.414", 1 / math.tan(math.pi / 8)),
    ("guaranteed_velocity:4.14.y2", "1.707", math.sin(3 * math.pi / 8) / (math.sqrt(2) * math.sin(math.pi / 8))),
    ("guaranteed_velocity:4.14.y2", "0.293", 1 - math.sqrt(0.5)),
    ("joint_correction:2.assumption1.units", "0.64", worst_turn(250)),
    ("joint_correction:2.assumption1.units", "0.48", worst_turn(200)),
    ("joint_correction:2.assumption1.units", "0.22", worst_turn(100)),
    ("terrain_search:cost.additional", "0.072", 11**2 / 41**2),
    ("terrain_search:gain", "17.8", 40.05 / 2.25),
    ("trajectory:earth.tan_phi", "0.9933", 1 - 0.082**2),
    ("trajectory:experiment.sigma_phi.100", "0.076", 1.2e-8 * EARTH),
    ("trajectory:experiment.sigma_phi.100", "0.0013", math.radians(1.2e-8) * EARTH),
    ("trajectory:experiment.sigma_phi.100", "0.0024", math.radians(2.2e-8) * EARTH),
    ("guaranteed_velocity:4.16.y5", "0.293", 1 - math.sqrt(0.5)),
    ("guaranteed_velocity:4.16.y6", "1.707", 1 / (4 * math.sin(math.pi / 8) ** 2)),
    ("terrain_search:cost.additional", "1.072", 1 + 11**2 / 41**2),
    ("trajectory:earth.tan_phi", "0.918", 1 - 0.082),
    ("trajectory:experiment.better", "0.877", gain_of_unit_columns(5, 0.65)),
    ("trajectory:experiment.sigma_v.unit", "1.14", 0.019 * 60),
]
#: Figures of sheets with three digits and more that are data of an example, or end in a claim's evidence.
GIVEN = {
    "trajectory:earth.tan_phi": "0.082",
    "trajectory:experiment.gain": "1.0006",  # experiment.gain has the radius in balls
    "trajectory:experiment.much_better": "2.56",  # the certified table has both condition numbers
    "terrain_search:gain": "40.1 40.05 2.25",
    "multistructure:4.type": "6.37",
}


@pytest.mark.parametrize(("name", "figure", "number"), FIGURES)
def test_the_numbers_of_a_sheet_are_right_to_their_last_digit(name, figure, number):
    module, _, claim = name.partition(":")
    worded = words_of(module)[claim]
    assert figure in worded.check + worded.why
    assert abs(float(figure) - number) <= 0.5001 * 10.0 ** -len(figure.partition(".")[2])


def sides_in_numbers(text):
    """The formulas of a sheet that are equations between numbers: each side with its value."""
    for formula in re.findall(r"\$(.*?)\$", text):
        plain = formula.replace(r"\cdot", "*").replace(r"\pi", "pi").replace(r"\,", "")
        plain = re.sub(r"\\sin\^2\(([^()]*)\)", r"*sin(\1)**2", re.sub(r"\\sin\(", "*sin(", plain))
        plain = re.sub(r"\\sqrt(\d|\{\d+\})", r"sqrt(\1)", plain)
        plain = re.sub(r"\^(\d|\{[^{}]*\})", r"**(\1)", plain).replace("{", "").replace("}", "")
        sides = [side.strip() for side in plain.split("=")]
        is_number = [side and not re.search(r"[^\d\s.+*/()-]", re.sub("sqrt|sin|pi", "", side)) for side in sides]
        if len(sides) > 1 and all(is_number) and r"\pi^" not in formula:  # pi^i is a density
            yield [(side, float(parse(side, {}))) for side in sides]


def wrong_equations(text):
    """Equations between numbers that do not hold to half a unit of the last digit of their last side."""
    for sides in sides_in_numbers(text):
        half = (
            0.5001 * 10.0 ** -len(sides[-1][0].partition(".")[2]) if re.fullmatch(r"-?[\d.]+", sides[-1][0]) else 1e-9
        )
        if any(abs(value - sides[-1][1]) > half for _, value in sides):
            yield sides


def test_a_wrong_equation_on_a_sheet_is_found():
    assert not [*wrong_equations(r"$3\cdot2^2=12$, $4\sin(\pi/4)\sin^2(\pi/8)=0.414$ and $x=3$, $121/1681=0.072$")]
    assert len([*wrong_equations(r"$1+6+3=11$, $121/1681=0.071$, $3^5=242$")]) == 3


@pytest.mark.parametrize("module", MODULES)
def test_equations_between_numbers_on_a_sheet_hold(module):
    texts = [part for worded in words_of(module).values() for part in (worded.correct, worded.why, worded.check)]
    assert any([*sides_in_numbers(text)] for text in texts) or module == "joint_correction"
    assert not [sides for text in texts for sides in wrong_equations(text)]


@pytest.mark.parametrize("module", MODULES)
def test_every_long_figure_of_a_sheet_is_decided(module):
    """It stands in a claim, in the print, in an equation between numbers, or is computed by other code above."""
    claims = [r for r in LEDGER if r.paper == module]
    for number, worded in words_of(module).items():
        near = [r for r in claims if r.number.split(".")[0] == number.split(".")[0]]
        known = " ".join([worded.printed, GIVEN.get(f"{module}:{number}", ""), *(f"{r.to_json()}" for r in near)])
        known += " ".join(figure for name, figure, _ in FIGURES if name == f"{module}:{number}")
        text = f"{worded.correct} {worded.why} {worded.check}"
        known += " ".join(side for sides in sides_in_numbers(text) for side, _ in sides)
        figures = re.findall(r"(?<![\w.^_{(])\d*\.\d+", text.replace(r"\,", ""))
        long = [one for one in figures if len(one.replace(".", "").lstrip("0")) > 2]
        assert not [one for one in long if one not in known], number


@pytest.mark.parametrize(
    ("module", "number", "slip"),
    [("claims/own.toml", "gain", "paper"), ("own", "1", "undecidable"), ("own", "remark", None)],
)
def test_a_refuted_statement_without_a_slip_is_not_dropped(module, number, slip):
    """Nobody said who slipped; only what others say about a paper is left out."""
    record = next(r for r in LEDGER if r.status == "REFUTED" and r.slip and not r.cause)
    card = Paper(module, "T", (), 2020, "", "", ("1",))
    own = replace(record, id=f"{module}:{number}", paper=module, number=number, slip=None, reason="")
    entries = erratum_of(card, [own]).entries
    assert [entry.slip for entry in entries] == ([slip] if slip else [])
    assert all(entry.reason == "The statement is refuted." for entry in entries)


def test_a_whole_equation_is_checked_by_its_two_sides():
    record = next(r for r in LEDGER if r.status == "REFUTED" and r.slip and not r.cause)
    stated = {"printed": "sin(2*a) = sin(a)*cos(a)", "derived": "", "counterexample": {"a": "1"}}
    card = Paper("own", "T", (), 2020, "", "", ("1",))
    ((one,),) = [erratum_of(card, [replace(record, id="own:1", paper="own", number="1", **stated)]).entries]
    assert one.check.whole and float(one.check.printed.rstrip("…")) == pytest.approx(math.sin(2), abs=1e-9)
    assert float(one.check.derived.rstrip("…")) == pytest.approx(math.sin(1) * math.cos(1), abs=1e-9)


def test_what_covers_several_figures_becomes_a_table():
    records = [r for r in LEDGER if r.paper == "trajectory"]
    card = Paper("trajectory", "T", (), 2018, "", "", ())
    entries = erratum_of(card, records, words_of("trajectory")).entries
    (table,) = [entry for entry in entries if entry.rows]
    assert len(table.rows) == 16 and len(table.ids) == 16
    assert {wrong for _, wrong, _ in table.rows}.isdisjoint({right for *_, right in table.rows})


@pytest.mark.parametrize(
    "text",
    [
        "[a",
        '["1"]\nwhere = "x"',
        '["1"]\nwhere="x"\nprinted="y"\ncorrect="z"\nmore="!"',
        "a = 1",
        '["1"]\nwhere="x"\nprinted="$\\\\input{y}$"\ncorrect="z"',
        '["1"]\nwhere="x $"\nprinted="y"\ncorrect="z"',
    ],
)
def test_wording_that_is_none_is_refused_with_its_place(text):
    with pytest.raises(NavsymError, match=r"expected .*; got "):
        read_wording(text, "sheet")


# -- formulas --------------------------------------------------------------------------------


CHILDREN = {"msub": 2, "msup": 2, "mfrac": 2, "munder": 2, "mover": 2, "msubsup": 3, "munderover": 3, "msqrt": 1}


@pytest.mark.parametrize("module", MODULES)
def test_formulas_of_the_sheets_are_mathml_with_the_right_number_of_parts(module):
    for worded in words_of(module).values():
        for text in (worded.where, worded.printed, worded.correct, worded.why, worded.check):
            for formula in re.findall(r"<math.*?</math>", sentence_html(text), re.S):
                for node in minidom.parseString(formula).getElementsByTagName("*"):
                    assert len(node.childNodes) == CHILDREN.get(node.tagName, len(node.childNodes)), text


@pytest.mark.parametrize(
    ("source", "part"),
    [
        (r"\frac{a}{b}", "<mfrac><mrow><mi>a</mi></mrow><mrow><mi>b</mi></mrow></mfrac>"),
        (r"\sin^2 x", "<msup><mi>sin</mi><mn>2</mn></msup>"),
        (r"\begin{bmatrix}1\end{bmatrix}", "<mo>[</mo><mtable>"),
        (r"\displaystyle \text{on the way}", "<mtext>on\u00a0the\u00a0way</mtext>"),
        (r"x_1^2", "<msubsup><mi>x</mi><mn>1</mn><mn>2</mn></msubsup>"),
        (r"\sum_{j=1}^l", "<munderover><mo>∑</mo>"),
        (r"\dot y", '<mover accent="true"><mi>y</mi>'),
        (r"|\ddot x| \le M", '<mover accent="true"><mi>x</mi><mo stretchy="false">¨</mo></mover>'),
        (r"\begin{pmatrix}1&0\\0&1\end{pmatrix}", "<mtable><mtr><mtd>"),
        (r"^2", "<msup><mrow></mrow><mn>2</mn></msup>"),
        (r"\left(x\right)^2", '<mo stretchy="false">(</mo>'),
        (r"\left(\frac{x}{2}\right)^2", "<mo>(</mo>"),
    ],
)
def test_the_small_part_of_latex_is_read(source, part):
    assert part in mathml(source)
    minidom.parseString(f"<p>{mathml(source).replace('<wbr>', '')}</p>")


@pytest.mark.parametrize(
    "source",
    [r"\input{x}", r"\write18", r"\def\a{b}", "{a", r"\frac{a}", r"\begin{tabular}", "a}b", "a & b", "#1", "~"],
)
def test_what_is_not_on_the_list_is_refused(source):
    with pytest.raises(NavsymError, match="expected"):
        sentence_latex(f"words ${source}$ words")


def test_words_around_formulas_are_escaped_in_both_notations():
    assert sentence_html("<b> & $x$") == "&lt;b&gt; &amp; <math><mrow><mi>x</mi></mrow></math>"
    assert sentence_latex("5 % of $x$ & more_") == r"5 \% of $x$ \& more\_"


def test_a_long_formula_may_be_broken_before_signs_but_not_behind_them():
    assert mathml("a=b+c-d").count("<wbr>") == 3
    assert mathml("(-a)").count("<wbr>") == 0 and mathml("=-a").count("<wbr>") == 0


# -- LaTeX -----------------------------------------------------------------------------------


def compiled(tex, folder, wide=False):
    """Pages of a document that pdflatex makes; overfull lines only where they are allowed."""
    (folder / "sheet.tex").write_text(tex, encoding="utf-8")
    done = subprocess.run(
        ["pdflatex", "-no-shell-escape", "-interaction=nonstopmode", "-halt-on-error", "sheet.tex"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        errors="replace",
    )
    assert done.returncode == 0, done.stdout[-2000:]
    assert wide or "Overfull" not in done.stdout
    found = re.search(r"Output written on sheet.pdf \((\d+) page", done.stdout)
    assert found is not None
    return int(found.group(1))


def lacking() -> str:
    """What setting a sheet needs and this machine has not, in a sentence; empty when all is there."""
    if shutil.which("pdflatex") is None or shutil.which("kpsewhich") is None:
        return "no pdflatex: install texlive-latex-base and lmodern"
    names = re.findall(r"\\usepackage(?:\[.*\])?{(.*)}", (TEMPLATES / "erratum.tex").read_text(encoding="utf-8"))
    styles = [f"{name}.sty" for name in ",".join(names).split(",")]
    there = subprocess.run(["kpsewhich", *styles], capture_output=True, text=True, check=False, timeout=60).stdout
    absent = [style for style in styles if f"/{style}\n" not in there]
    return f"LaTeX lacks {', '.join(absent)}: install texlive-latex-base and lmodern" if absent else ""


LACKING = lacking()
needs_latex = pytest.mark.skipif(bool(LACKING), reason=LACKING)


@needs_latex
@pytest.mark.parametrize(
    "module",
    [pytest.param(m, marks=[] if m in ("trajectory", "joint_correction") else pytest.mark.long) for m in MODULES],
)
def test_the_sheet_of_every_paper_compiles_and_no_line_is_too_wide(module, tmp_path):
    files = site(LEDGER.restrict([module]), {module: words_of(module)})
    assert 2 <= compiled(files[f"{module}.erratum.tex"], tmp_path) <= 12


@needs_latex
def test_a_sheet_without_wording_and_one_without_entries_compile(files, card, tmp_path):
    assert compiled(files["sample.erratum.tex"], tmp_path) == 1
    tex = site(ledger([], card))
    assert compiled(tex["sample.erratum.tex"], tmp_path) == 1


DOCUMENT = """
[symbols]
a = {vector = 3}
b = {vector = 3}
x = "positive"
[[claim]]
id = "order"
left = "cross(a, b)"
right = "cross(b, a)"
printed = '\\mathbf{a} \\times \\mathbf{b} = \\mathbf{b} \\times \\mathbf{a}'
expect = "REFUTED"
[[claim]]
id = "order*"
corrects = "order"
left = "cross(a, b)"
right = "-cross(b, a)"
[[claim]]
id = "typed"
left = "(x + 2) - 1"
right = "1*x"
printed = '\\input{elsewhere} x + 2 - 1'
expect = "REFUTED"
"""


def test_a_sheet_of_a_file_shows_formulas_as_they_are_printed_and_typed(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(DOCUMENT)
    ledger = nav.verify(str(path))
    first, second = erratum_of(ledger.cards[str(path)], list(ledger)).entries
    assert [side.text for side in first.wrong] == [
        r"\mathbf{a} \times \mathbf{b} = \mathbf{b} \times \mathbf{a}", "cross(a, b) = cross(b, a)",
    ]  # fmt: skip
    assert [side.text for side in first.right] == ["cross(a, b) = -cross(b, a)"]
    assert [side.text for side in second.wrong] == ["(x + 2) - 1 = 1*x"]  # a command that reads files is not handed on
    sheets = [text for name, text in site(ledger).items() if name.endswith(".erratum.tex")]
    assert len(sheets) == 1 and r"\mathbf{a}" in sheets[0] and r"\input{" not in sheets[0]
    assert Record.from_json(ledger[f"{path}:typed"].ledger_json()).latex == r"\input{elsewhere} x + 2 - 1"


@needs_latex
def test_hostile_words_compile(hostile_words, records, card, tmp_path):
    wild = [
        replace(records[1], number=f"9.{i}", id=f"sample:9.{i}", title=words, reason=words)
        for i, words in enumerate(hostile_words)
    ]
    tex = site(ledger(wild, card))["sample.erratum.tex"]
    plain = "".join(c if ord(c) < 0x250 else "?" for c in tex)  # letters of fonts that are not loaded
    compiled(plain, tmp_path, wide=True)  # one of the words has hundreds of letters


def test_the_filters_of_the_templates_are_there():
    assert {"tex", "sentence", "sentence_tex", "slug"} <= set(environment().filters)
