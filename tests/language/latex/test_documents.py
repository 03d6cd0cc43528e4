r"""Documents: where formulas stand, rows of ``align``, macros, hostile input, the verb, and what is written out."""

from __future__ import annotations

import io
import json
import random
import re
import sys
import time

import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from navsym.language.latex.climbing import climb
from navsym.language.latex.descent import descend
from navsym.language.latex.macros import expand_macros, list_macros
from navsym.language.latex.notation import build_notation
from navsym.language.latex.parts import Refusal
from navsym.prove.claimfile import claims_from

ABC = dict.fromkeys("a b c d x y".split(), "real")
TEX = r"""% $z = 1$ in a comment
\newcommand{\half}[1]{\frac{#1}{2}}
\newcommand\vel{\mathbf{v}}
\DeclareMathOperator{\sgn}{sgn}
Text with $a = b + c$, a lone $x$ and \$5.
\begin{verbatim} $a = 0$ \end{verbatim}
\begin{align}
  a &= b + c \label{eq:a} \\
    &= \half{b} - c^2, \\
  a &= b
     + c \\
  a &= b \\
    &\quad - c, \quad b = c^2 \\
  \sgn(a) &\le b \le c
\end{align}
$$a = \left( b \right)$$ \[ b = c . \]
\begin{equation*} \begin{split} a &= b \\ &= c \end{split} \end{equation*}
"""
EXPECTED = [
    (5, "a = b + c"), (8, "a = b + c"), (9, "a = b/2 - c**2"), (10, "a = b + c"), (12, "a = b - c"), (13, "b = c**2"),
    (14, "sign(a) <= b"), (14, "b <= c"), (16, "a = b"), (16, "b = c"), (17, "a = b"), (17, "a = c"),
]  # fmt: skip


def texts(reading):
    """Line and reading of each formula, or why there is none."""
    shown = (f"{f.left} {f.relation} {f.right}" if f.status == "READ" else f.why for f in reading.formulas)
    return [(f.line, text) for f, text in zip(reading.formulas, shown, strict=True)]


def test_a_latex_document_gives_one_formula_per_relation():
    assert texts(nav.read(TEX, symbols=ABC)) == EXPECTED


def test_a_formula_is_shown_as_printed_and_with_its_macros_expanded():
    formula = nav.read(TEX, symbols=ABC).formulas[2]
    assert formula.source == r"a = \half{b} - c^2" and formula.latex == r"a = \frac{b}{2} - c^2"
    assert (formula.line, formula.column) == (9, 8)


def test_restructured_text_has_directives_and_roles(tmp_path):
    path = tmp_path / "page.rst"
    path.write_text(
        "Inline :math:`a = b` and :math:`x`.\n\n.. math:: b = c\n\n.. math::\n   :label: one\n\n   a &= b \\\\\n"
        "     &= c\n\n   c = d\n\nText = no formula\n\n* Item\n\n  .. math::\n\n    x = y\n",
        encoding="utf-8",
    )
    assert texts(nav.read(path, symbols=ABC)) == [
        (1, "a = b"), (3, "b = c"), (8, "a = b"), (9, "a = c"), (11, "c = d"), (19, "x = y"),
    ]  # fmt: skip


def test_markdown_has_dollars_and_fences_and_no_formulas_in_code(tmp_path):
    path = tmp_path / "page.md"
    path.write_text(
        "A $a = b$, `$a = c$` and \\$3.\n\n$$\nb = c\n$$\n\n```math\nx = y\n```\n\n```python\nprice = '$a = d$'\n```\n"
        "Costs $5 and\n\n$6.\n\\[ c = d \\]\n",
        encoding="utf-8",
    )
    assert texts(nav.read(path, symbols=ABC)) == [(1, "a = b"), (4, "b = c"), (8, "x = y"), (17, "c = d")]


def test_doxygen_has_formulas_between_its_own_marks(tmp_path):
    path = tmp_path / "page.dox"
    path.write_text("A \\f$a = b\\f$ and\n\\f[ b = c \\f]\n\\f{align*}{\n x &= y \\\\\n &= a\n\\f}\n", encoding="utf-8")
    assert texts(nav.read(path, symbols=ABC)) == [(1, "a = b"), (2, "b = c"), (4, "x = y"), (5, "x = a")]


ROWS = {
    r"a &= b \\ & \le c \\ &= d": ["a = b", "a <= c", "c = d"],
    r"a &= b \\ & \approx c \\ &= d": ["a = b", None, "c = d"],
    r"a = b \in \mathbb{R}": ["a = b", None],
    r"&a + b \\ &= c \\ &= d": ["a + b = c", "a + b = d"],
    r"a & \\ & ~~~ + b \\ &= c": ["a + b = c"],
    r"a \\ b \\ &= c": [None, None, None],
    r"a &= b \\ c \\ &= d": ["a = b", None, None],
    r"a &= b \\[1em] \empty &= \textcolor{red}{c + d}": ["a = b", "a = c + d"],
    r"a = \text{}^x b": [None],
    r"\Rightarrow a = b": ["a = b"],
    r"a = b \Rightarrow c = d": [None],
    r"\boxed{a = b}": ["a = b"],
    r"a = \underbrace{b + c}_{x} d": ["a = (b + c)*d"],
    r"a = b \text{ where } c = d": ["a = b", "c = d"],
    r"a = b \text{ if } c = d": [None, None],
    r"a = b \quad \forall x": ["a = b"],
    r"a = b \quad \forall x > 0": [None],
    r"a = 1, b = 2": ["a = 1", "b = 2"],
    r"a = b, \quad k = 1, 2, \ldots, 2n": ["a = b", "1 <= k", "k <= 2*n"],
    r"a = b \quad \text{for} \quad k=1\ldots4": ["a = b", "1 <= k", "k <= 4"],
    r"k = 1, 3, \ldots, n": [None],
    r"x = 1, 2, \ldots, n": [None, None],
    r"x = \left\{\begin{array}{ll} a & x > 0 \\ b & \mathrm{otherwise} \end{array}\right., \quad a = b":
        ["x = where(x > 0, a, b)", "a = b"],
    r"x = (a, b)": [None],
    r"(v, v) = (v, v)": [None],
    r"v = (a, b, c)": ["v = [[a], [b], [c]]"],
    r"w = \begin{bmatrix} a & v \end{bmatrix}": ["w = [[a], [v]]"],
    r"v = w w": [None],
    r"v = [v^T\; v^T]^T": [None],
}  # fmt: skip


@pytest.mark.parametrize("text", ROWS)
def test_rows_and_lists_are_read_in_their_parts(text):
    symbols = ABC | {n: {"integer": ["1", "oo"]} for n in "kn"} | {"v": {"vector": 3}, "w": {"vector": "?"}}
    formulas = nav.read(f"$${text}$$", symbols=symbols).formulas
    assert [f"{f.left} {f.relation} {f.right}" if f.status == "READ" else None for f in formulas] == ROWS[text]


BESIDE = ["a = b, c", "a = 1, 2, 3", r"a = b \quad c", r"a = b, \quad t \in [0, 1]", r"a = b \\ c"]


@pytest.mark.parametrize("text", BESIDE)
def test_a_row_with_something_beside_its_formula_is_refused_whole(text):
    reading = nav.read(text, symbols=ABC)
    assert [f.status for f in reading.formulas][-1] == "REFUSED" and len(reading.read) <= text.count("\\\\")


# -- macros and hostile input


ENDLESS = [
    r"\newcommand{\x}{\x}", r"\newcommand{\x}{\x\x}", r"\def\x{\y}\def\y{\x + \x}", r"\newcommand{\x}[1]{\x{#1 + #1}}",
]  # fmt: skip
CODE = [r"\input{passwords}", r"\write18{rm x}", r"\csname a\endcsname", r"\ifx a b\fi", r"\catcode`a=1"]


@pytest.mark.parametrize("body", ENDLESS)
def test_a_macro_without_an_end_is_refused_in_little_time(body):
    begin = time.process_time()
    (formula,) = nav.read(body + r"\[ a = \x{b} \]", symbols=ABC).formulas
    assert formula.status == "REFUSED" and ("macro" in formula.why or "arguments" in formula.why)
    assert time.process_time() - begin < 2


@pytest.mark.parametrize("body", CODE)
def test_a_macro_with_code_is_not_expanded(body):
    source = rf"\newcommand{{\x}}{{{body}}} $a = \x$"
    assert list_macros(source) == {}
    assert [f.status for f in nav.read(source, symbols=ABC).formulas] == ["REFUSED"]


def test_macros_take_arguments_and_keep_places():
    macros = list_macros(r"\newcommand{\f}[2]{\frac{#1}{#2}} \renewcommand{\v}{\mathbf{v}} \def\w{\omega}")
    text, places = expand_macros(r"\f{a}{\f b c} + \v\w a", macros)
    assert text == r"\frac{a}{\frac{b}{c}} + \mathbf{v}\omega a"
    assert len(places) == len(text) and places[-1] == len(r"\f{a}{\f b c} + \v\w a") - 1


HOSTILE = [
    "{" * 10_000, "(" * 10_000 + "a" + ")" * 10_000, r"\frac{" * 10_000, r"\sqrt{" * 10_000 + "a" + "}" * 10_000,
    "a^{" * 10_000 + "a" + "}" * 10_000, "-" * 20_000, r"\left(" * 9_000, r"\begin{bmatrix}" * 5_000,
    "$" * 20_000, r"\[" * 20_000, r"\begin{align}" * 20_000, "a" * 1_000_000, r"\\" * 100_000, "&" * 100_000,
    "= " * 50_000,
    "_^" * 50_000, r"\newcommand{\a}{" * 20_000, "|" * 10_000, r"\sin" * 5_000, "a = " + "b + " * 4_000 + "b",
    "''''" * 5_000, "%" * 100_000,
    r"\f[" * 10_000, "x" + "^x" * 5_000, r"\dot" * 5_000, r"\int_0^1" * 2_000, r"\sum_{k=1}^n" * 2_000,
    "\\", "\\" * 9_999,
]  # fmt: skip


@pytest.mark.parametrize("place", range(len(HOSTILE)))
@pytest.mark.parametrize("form", ["", "$$"])
def test_hostile_text_ends_soon_and_is_refused(place, form):
    begin = time.process_time()
    try:
        reading = nav.read(f"{form}{HOSTILE[place]}{form}", symbols=ABC)
    except NavsymError:
        reading = None
    assert reading is None or len(reading.read) <= 1
    assert time.process_time() - begin < 8


PIECES = [
    r"\begin{cases}", r"\end{cases}", r"\left\{", r"\right.", r"\langle", r"\rangle", r"\lim_{x \to 0}",
    "f(x, y)", r"\Delta",
    r"\text{otherwise}", "&", r"\\", "<", "!", "*", r"\mathbf{ab}",
    *"abcxyd123+-=()[]{}|_^'/,.& ", r"\frac", r"\sqrt", r"\sin", r"\cdot", r"\times", r"\left", r"\right",
    r"\mathbf", r"\hat",
    r"\int", r"\sum", r"\begin{bmatrix}", r"\end{bmatrix}", r"\\", r"\,", r"\top", r"\|", r"\dot", r"\omega",
    r"\mathrm", r"\quad", r"\partial", "{}", "_0^1", "^T", "{a}", "{b}", r"\lfloor", r"\rfloor", r"\log",
    r"\operatorname{atan2}",
    "d", "dx",
]  # fmt: skip


def test_random_pieces_never_break_a_reader():
    notation = build_notation({**ABC, "v": {"vector": 3}}, {"c": r"\hat{c}_k", "d": "(x)"}, {}, "")
    source = random.Random(11)
    for _ in range(2_500):
        text = "".join(source.choices(PIECES, k=source.randint(1, 12)))
        for reader in (descend, climb):
            try:
                reader(text, notation)
            except Refusal as refusal:
                assert 0 <= refusal.at <= len(text), text


# -- the verb, claim files and declarations


def test_the_verb_prints_one_document_and_its_status(tmp_path, capsys):
    path, table = tmp_path / "a.tex", tmp_path / "s.toml"
    path.write_text("$a = b + c$ and $a = bz$", encoding="utf-8")
    table.write_text('[symbols]\na = "real"\nb = "real"\nc = "real"\n', encoding="utf-8")
    assert run(["read", str(path), "--symbols", str(table), "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    first, second = document.pop("formulas")
    assert document == {"read": 1, "refused": 1, "undeclared": ["bz"]}
    assert first == {
        "place": {"file": str(path), "line": 1, "column": 2}, "source": "a = b + c", "status": "READ", "why": None,
        "left": "a", "relation": "=", "right": "b + c", "symbols": ["a", "b", "c"], "latex": "a = b + c",
    }  # fmt: skip
    assert second["status"] == "REFUSED" and "a product or a name" in second["why"] and second["left"] is None
    assert run(["read", str(path), "--symbols", str(table)]) == 1
    shown = capsys.readouterr().out
    lines = shown.splitlines()
    assert lines[2] == "  a = b + c" and lines[-1] == "undeclared: bz"
    (caret,) = [place for place, line in enumerate(lines) if line.strip() == "^"]
    assert lines[caret - 1].strip() == path.read_text() and lines[caret - 1][lines[caret].index("^") :] == "bz$"


def test_standard_input_is_one_formula_or_a_document(monkeypatch, capsys):
    for text, count in (("a = b\n", 1), ("$a = b$ and $b = c$\n", 2)):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
        assert run(["read", "-", "--json"]) == 1
        assert json.loads(capsys.readouterr().out)["refused"] == count


def test_the_claim_file_that_is_written_is_decided(tmp_path, capsys):
    path, table, out = tmp_path / "a.tex", tmp_path / "s.toml", tmp_path / "claims.toml"
    path.write_text(r"\[ \sin 2a = 2 \sin a \cos a, \quad \tfrac{a}{a} = 2 \]", encoding="utf-8")
    table.write_text('[symbols]\na = ["1", "2"]\n', encoding="utf-8")
    assert run(["read", str(path), "--symbols", str(table), "--out", str(out)]) == 0
    assert 'printed = "\\\\sin 2a = 2 \\\\sin a \\\\cos a"' in out.read_text() and "line 1" in out.read_text()
    capsys.readouterr()
    assert run(["prove", str(out), "--json"]) == 1
    assert [c["status"] for c in json.loads(capsys.readouterr().out)["claims"]] == ["PROVED", "REFUTED"]


def test_declared_skeletons_read_what_they_were_made_from(tmp_path):
    text = r"$$\dot{L} = \frac{v_N}{R_{N} + h}$$ $$\hat{x}_{k|k-1} = F x' + P_k^-$$"
    table = tmp_path / "s.toml"
    first = nav.read(text)
    assert first.undeclared == ("L", "v_N", "R_N", "h", "hat_x_k_km1", "F", "x_prime", "P_k_m")
    table.write_text(first.declarations(), encoding="utf-8")
    again = nav.read(text, symbols=table)
    assert again.undeclared == () and len(again.read) == 2


@pytest.mark.parametrize(
    ("tables", "word"),
    [
        ({"symbols": {"a": "reel"}}, "reel"),
        ({"symbols": {"a": {"vectr": 3}}}, "vector"),
        ({"symbols": {"a": {"matrix": 3}}}, "rows and columns"),
        ({"symbols": {"a": 1.5}}, "range"),
        ({"symbols": {"2a": "real"}}, "name"),
        ({"latex": {"a": "x"}}, "declared name"),
        ({"symbols": {"a": "real", "b": "real"}, "latex": {"a": "x_1", "b": "x_1"}}, "one name"),
        ({"symbols": {"a": "real"}, "latex": {"a": "{x"}}, "braces"),
        ({"symbols": {"a": "real"}, "latex": {"a": 3}}, "LaTeX as text"),
        ({"symbols": 5}, "table"),
    ],
)
def test_a_wrong_declaration_is_an_error_that_names_it(tables, word):
    with pytest.raises(NavsymError, match=word):
        nav.read("a = b", **tables)


def test_a_wrong_source_is_an_error(tmp_path):
    for bad in (5, "", "   ", tmp_path, tmp_path / "none.tex", tmp_path / "page.docx"):
        with pytest.raises(NavsymError):
            nav.read(bad)


def test_the_second_reader_has_a_veto(monkeypatch):
    from navsym.language.latex import reading

    assert nav.read("a = b c", symbols=ABC).formulas[0].status == "READ"
    monkeypatch.setattr(reading, "climb", lambda text, notation: descend("c b" if "b" in text else text, notation))
    (formula,) = nav.read("a = b c", symbols=ABC).formulas
    assert formula.status == "REFUSED" and "two readings that agree" in formula.why


def test_prove_takes_latex():
    assert nav.prove(r"\sin(2a) = 2\sin a\cos a").status == nav.PROVED
    assert nav.prove(r"\frac{x}{y} \ge 1", x=("2", "3"), y=("1", "2")).holds
    assert nav.prove(r"\frac{a}{2} = a").status == nav.REFUTED
    assert nav.prove(r"\frac{a}{b} = c = a").status == nav.REFUTED
    bad = [r"\sin a b = 1", r"ab\cdot c = 1", r"\frac{a}{b}", r"\dot{C} = C\,[\omega\times]"]
    for text in bad:
        with pytest.raises(NavsymError) as caught:
            nav.prove(text)
        assert caught.value.where.startswith("prove: statement")


@pytest.mark.parametrize(
    ("latex", "status"),
    [
        (r"\sin x = x - \frac{x^3}{6} + O(x^5)", "PROVED"),
        (r"\sin x = x - \frac{x^3}{6} + O(x^6)", "REFUTED"),
        (r"e^{\epsilon} = 1 + \epsilon + \mathcal{O}(\epsilon^2)", "PROVED"),
        (r"\cos\theta = 1 - \mathcal O\left(\theta^{2}\right)", "PROVED"),
        (r"\tan t = \mathrm{O}(t)", "PROVED"),
        (r"\tan t = O(t^2)", "REFUTED"),
    ],
)
def test_terms_of_an_order_at_the_end_are_the_order_of_the_claim(latex, status):
    assert nav.prove(latex).status == status


@pytest.mark.parametrize(
    "latex",
    [
        r"\cos x + O(x^2) = 1", r"\cos x = 1 + 2 O(x^2)", r"\cos x = 1 + O(1)", r"\cos x = 1 + O(x^2)^2",
        r"\cos x = 1 + O(x^{n})", r"\cos x = \frac{1 + O(x^2)}{1}", r"\cos x \le 1 + O(x^2)", r"\cos x = 1 + O(x, y)",
        r"\cos x = (1 + O(x^2))", r"\sin x = x + O(x^3) = O(x)", r"\cos x = 1 + O_2(x^2)",
    ],
)  # fmt: skip
def test_other_terms_of_an_order_are_refused(latex):
    with pytest.raises(NavsymError):
        nav.prove(latex)


def test_a_letter_o_with_a_declaration_is_a_name():
    reading = nav.read("y = a + O x", symbols={"y": "real", "a": "real", "O": "real", "x": "real"})
    assert reading.formulas[0].right == "a + O*x" and reading.formulas[0].order is None


def test_an_order_is_written_into_the_claim_file(tmp_path):
    reading = nav.read(r"\sqrt{1 + \epsilon} = 1 + \epsilon/2 + O(\epsilon^2)", symbols={"epsilon": "real"})
    assert reading.formulas[0].document()["order"] == {"epsilon": 2} and "O(epsilon**2)" in repr(reading._repr_html_())
    (tmp_path / "claims.toml").write_text(reading.claims())
    assert [v.status for v in nav.prove(tmp_path / "claims.toml")] == [nav.PROVED]


def test_an_order_is_said_once():
    with pytest.raises(NavsymError, match="one order"):
        nav.prove(r"\sin x = x + O(x^3)", order={"x": 3})


def test_claims_take_their_latex_and_source_along():
    block = {"id": "a", "left": "x", "right": "x", "printed": "x = x", "source": "p. 3"}
    assert len(claims_from({"symbols": {"x": "real"}, "claim": [block]}).claims) == 1
    with pytest.raises(NavsymError, match="text"):
        claims_from({"symbols": {"x": "real"}, "claim": [{**block, "printed": ["x"]}]})


RADII = r"""$K = \frac{P}{P + R}$, $S = P + R$ and $K S = P$. With $w = \sin a$, $\frac{dw}{da} = \cos a$;
$W = \cos a$, $W^2 + w^2 = 1$."""
POSITIVE = {"P": "positive", "R": "positive"}


def test_definitions_are_written_for_their_names_in_the_claims_behind_them(tmp_path):
    reading = nav.read(RADII, symbols={"K": "real", "S": "real", "a": "real", "w": "real", "W": "real", **POSITIVE})
    (tmp_path / "claims.toml").write_text(reading.claims(definitions=True))
    verdicts = nav.prove(tmp_path / "claims.toml")
    assert [v.status for v in verdicts] == [nav.PROVED] * 3
    (tmp_path / "spoiled.toml").write_text(reading.claims(definitions=True).replace("cos(a)", "sin(2*a)"))
    assert [v.status for v in nav.prove(tmp_path / "spoiled.toml")] == [nav.PROVED, nav.REFUTED, nav.REFUTED]
    assert reading.claims().count("[[claim]]") == 7


@pytest.mark.parametrize(
    ("latex", "claims"),
    [
        ("$x + y = 2$, $x = y$", 2),  # x stands before
        ("$x = x y$", 1),  # and in its own value
        ("$v = u + u$, $v_1 = 2 u_1$", 2),  # an entry of it is used
        (r"$x \le y$, $y = z$", 2),
        (r"$\dot x = y$, $x = z$, $z = y$", 3),  # x has a rate
        (r"$z = y$, $\frac{dy^2}{dz} = y$", 2),  # z is a variable
    ],
)
def test_what_only_looks_like_a_definition_stays_a_claim(latex, claims):
    names = {"x": "real", "y": "real", "z": "real", "u": {"vector": 2}, "v": {"vector": 2}}
    reading = nav.read(latex, symbols=names, rates={"x": "y"})
    assert reading.claims(definitions=True).count("[[claim]]") == claims


def test_a_document_of_definitions_has_no_claim():
    with pytest.raises(NavsymError, match="definitions only"):
        nav.read("$x = y$", symbols={"x": "real", "y": "real"}).claims(definitions=True)


def test_the_skeleton_asks_whether_letters_with_an_index_are_a_product():
    assert r"Is \mathbf{Bu}_{t} a product or a name?" in nav.read(r"\mathbf{x} = \mathbf{Bu}_t").declarations()


def test_the_skeleton_has_whole_numbers_at_the_ends_of_sums_and_asks_what_e_is():
    skeleton = nav.read(r"\sum_{k=1}^{n} e^2 k = y").declarations()
    assert 'n = { integer = ["1", "oo"] }' in skeleton and 'y = "real"' in skeleton and "declare e where" in skeleton
    assert "declare e" not in nav.read(r"e^{-t} = y").declarations()
    assert nav.prove(r"\sum_{k=1}^{n} k = \frac{n(n + 1)}{2}").status == nav.PROVED


KALMAN = r"""\begin{align} \mathbf{S} &= \mathbf{H}\mathbf{P}\mathbf{H}^T + \mathbf{R} \\
\mathbf{K} &= \mathbf{P}\mathbf{H}^T \mathbf{S}^{-1} \end{align} and the update $\mathbf{P}^+ = (\mathbf{I} -
\mathbf{K}\mathbf{H})\mathbf{P}$ is $\mathbf{P}^+ = \mathbf{P} - \mathbf{K}\mathbf{S}\mathbf{K}^T$ or
$\mathbf{P}^+ = (\mathbf{I} - \mathbf{K}\mathbf{H})\mathbf{P}(\mathbf{I} - \mathbf{K}\mathbf{H})^T +
\mathbf{K}\mathbf{R}\mathbf{K}^T$."""


def test_a_page_on_the_kalman_update_goes_from_latex_to_verdicts_for_any_size(tmp_path):
    skeleton = nav.read(KALMAN).declarations()
    assert 'H = { matrix = ["?", "?"] }' in skeleton and 'eye = "\\\\mathbf{I}"' in skeleton
    table = skeleton.replace('"?", "?"', '"n", "n"').replace("P_p", "U")
    for name, size in (("H", '"m", "n"'), ("K", '"n", "m"'), ("S", '"m", "m"'), ("R", '"m", "m"')):
        table = table.replace(f'{name} = {{ matrix = ["n", "n"]', f"{name} = {{ matrix = [{size}]")
    for name in "PRS":
        table = re.sub(rf"(?m)^({name} = .*\]) }}", r"\1, symmetric = true, positive = true }", table)
    (tmp_path / "symbols.toml").write_text(table)
    reading = nav.read(KALMAN, symbols=tmp_path / "symbols.toml")
    (tmp_path / "claims.toml").write_text(reading.claims(definitions=True))
    (tmp_path / "spoiled.toml").write_text(reading.claims(definitions=True).replace("H.T + R", "H.T - R", 1))
    assert [v.status for v in nav.prove(tmp_path / "claims.toml")] == [nav.PROVED] * 2
    assert nav.PROVED not in {v.status for v in nav.prove(tmp_path / "spoiled.toml")[:1]}


@pytest.mark.parametrize(
    ("printed", "left", "spelling"),
    [
        (r"\dot L = 0", "dot_(L)", None),
        (r"\ddot{x_1} = 0", "dot_(dot_(x_1))", None),
        (r"\dot{C}_b^n = 0", "dot_(C_b)", "C_b^n"),
        (r"\dot{\hat{x}} = 0", "dot_(hat_x)", r"\hat{x}"),
        (r"\dot{\mathbf{p}}_k = 0", "dot_(p_k)", r"\mathbf{p}_k"),
    ],
)
def test_the_skeleton_of_a_name_below_a_dot_declares_the_name_and_not_its_derivative(printed, left, spelling):
    (formula,) = nav.read(printed).formulas
    ((name, spelled), *_) = formula.unknown
    latex = {name: spelled} if spelling else {}
    assert spelled.replace(" ", "") == (spelling or name)
    (again,) = nav.read(
        printed, symbols=dict.fromkeys([name for name, _ in formula.unknown], "real"), latex=latex
    ).formulas
    assert (again.left, again.right) == (left, "0")
