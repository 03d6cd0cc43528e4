"""Commands of notebooks: formulas and cells of claims are decided, and a wrong line is one line of error."""

from __future__ import annotations

from pathlib import Path

import pytest
from IPython.core.error import UsageError
from IPython.core.interactiveshell import InteractiveShell

import navsym as nav
from navsym.cli._magics import prove_cell
from navsym.core.errors import NavsymError

YAW = Path(__file__).parents[2] / "examples" / "audit" / "yaw_jacobian"
CELL = """[symbols]
a = "real"
[[claim]]
id = "double"
left = "sin(2*a)"
right = "2*sin(a)*cos(a)"
[[claim]]
id = "wrong"
left = "sin(2*a)"
right = "2*sin(a)"
"""


@pytest.fixture
def shell(tmp_path, monkeypatch):
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    InteractiveShell.clear_instance()
    shell = InteractiveShell.instance(history_length=0)
    shell.history_manager.enabled = False
    shell.extension_manager.load_extension("navsym")
    yield shell
    shell.history_manager.end_session()
    InteractiveShell.clear_instance()


def test_a_formula_on_a_line_is_decided_on_its_ranges(shell):
    assert shell.run_line_magic("prove", "sin(T) <= T --range T=0,pi").status == "PROVED"
    assert shell.run_line_magic("prove", "sin(2*a) = 2*sin(a)").status == "REFUTED"


def test_a_cell_of_claims_is_decided_and_kept_by_its_name(shell):
    verdicts = shell.run_cell_magic("claims", "mine", CELL)
    assert [str(v.status) for v in verdicts] == ["PROVED", "REFUTED"] and shell.user_ns["mine"] is verdicts
    assert prove_cell(CELL).document() == verdicts.document()


def test_a_cell_of_latex_may_define_its_names(shell):
    cell = r"$K = \frac{P}{P + R}$, so that $(1 - K)^2 P + K^2 R = (1 - K) P$"
    (verdict,) = shell.run_cell_magic("claims", "--definitions mine", cell)
    assert verdict.status == "PROVED" and shell.user_ns["mine"][0] is verdict
    assert [v.status for v in shell.run_cell_magic("claims", "", cell)] == ["REFUTED", "REFUTED"]


@pytest.mark.parametrize("line", ["--range x=0,1", "not a name"])
def test_a_cell_of_claims_refuses_what_is_no_name(shell, line):
    with pytest.raises(UsageError, match="expected nothing or one name"):
        shell.run_cell_magic("claims", line, "x >= 0")


def test_a_shell_without_pages_shows_what_is_wrong_and_where(shell):
    """The text of an answer names the refuted line with its point, and the entry of the code with its mend."""

    def text(answer):
        return shell.display_formatter.format(answer)[0]["text/plain"]

    verdicts = shell.run_cell_magic("claims", "", "cos(2*a) = 2*cos(a)**2 - 1\ncos(2*a) = 1 - sin(a)**2\n")
    proved, refuted = text(verdicts).splitlines()[-2:]
    assert proved.split()[:3] == ["line", "1", "PROVED"] and "line 2" in refuted and "at a = " in refuted
    assert "at a = " in text(verdicts["line 2"]) and "all real a" in text(verdicts["line 1"])
    assert "write -v * sinf(x[2]) * dt" in text(shell.run_line_magic("audit", str(YAW.with_suffix(".toml"))))


def test_a_cell_of_formulas_as_printed_is_decided_line_by_line(shell):
    cell = r"\cos^2\frac{a}{2} = \frac{1+\cos a}{2} \\" + "\n\nsin(T) <= T --range T=0,pi\nsin(2*a) = 2*sin(a)\n"
    verdicts = shell.run_cell_magic("claims", "", cell)
    assert [str(v.status) for v in verdicts] == ["PROVED", "PROVED", "REFUTED"]
    assert verdicts["line 3"].holds and not verdicts["line 4"].holds
    for wrong, hint in (("\n", "got nothing"), ("x = x\nx", "cell: line 2")):
        with pytest.raises(UsageError, match=hint):
            shell.run_cell_magic("claims", "", wrong)


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("", "expected a relation"),
        ("x = x --range x", "LOWER,UPPER"),
        ("x", "relation"),
        ("x**2 >= 0 --json", "got '--json'"),
        ("x <= 1 --rnge x=0,1", "got '--rnge'"),
        ("x = x --range x=0,1 --range x=0,9", "got 0,1 and 0,9"),
    ],
)
def test_a_wrong_line_is_an_error_without_a_traceback(shell, line, hint):
    with pytest.raises(UsageError, match=hint):
        shell.run_line_magic("prove", line)


def test_an_audit_shows_itself_as_tables_and_runs_nothing_of_the_source(tmp_path):
    """The failing entry with its mend, the outputs of a function, and a hostile name as text."""
    shown = nav.audit("examples/audit/yaw_jacobian.toml")._repr_html_()
    assert "✗ REFUTED" in shown and "yaw_jacobian.c:14" in shown and "write -v * sinf(x[2]) * dt" in shown
    assert shown.count("<table>") == 2
    spec = Path("examples/audit/yaw_jacobian.toml").read_text().replace('"transition"', '"<script>"')
    (tmp_path / "spec.toml").write_text(spec)
    (tmp_path / "yaw_jacobian.c").write_text(Path("examples/audit/yaw_jacobian.c").read_text())
    assert "<script>" not in nav.audit(tmp_path / "spec.toml")._repr_html_()
    assert "xn[0]" in nav.audit("examples/audit/yaw_jacobian.c", function="predict")._repr_html_()


def test_questions_about_source_code_are_decided_on_a_line(shell):
    audit = shell.run_line_magic("audit", f"{YAW}.toml")
    assert audit["transition"].status == "REFUTED"
    assert shell.run_line_magic("audit", f"{YAW}.c --function predict").formulas


@pytest.mark.parametrize("line", ["", "nothing.toml", f"{YAW}.c", f"{YAW}.c --function a --function b"])
def test_a_wrong_line_of_audit_is_an_error_without_a_traceback(shell, line):
    with pytest.raises(UsageError, match="expected"):
        shell.run_line_magic("audit", line)


LATEX = r"""[symbols]
v = { vector = 3 }
T = "positive"

[latex]
v = '\mathbf{v}'

\[ \langle \mathbf{v}, \mathbf{v} \rangle = \|\mathbf{v}\|^2, \quad \lim_{x \to 0} \frac{\sin x}{x} = 1 \]
where $\sum_{k=1}^3 k a = 6 a$ and $|x| = \begin{cases} x & \text{if } x > 1 \\ -x & \text{otherwise} \end{cases}$
"""


def test_a_cell_of_latex_is_decided_behind_its_tables():
    assert [verdict.status for verdict in prove_cell(LATEX)] == ["PROVED", "PROVED", "PROVED", "REFUTED"]


def test_a_refused_formula_of_a_cell_names_its_line():
    with pytest.raises(NavsymError, match=r"line 9.*divisor"):
        prove_cell(LATEX.replace("6 a", "6/a a"))


def test_a_wrong_cell_names_its_line(shell):
    with pytest.raises(UsageError, match="cell: line 1"):
        shell.run_cell_magic("claims", "", "[[claim]\n")


@pytest.mark.long
def test_a_notebook_runs_and_shows_rich_answers(tmp_path):
    cells = ["%load_ext navsym", "%prove sin(T) <= T --range T=0,pi", "%%claims mine\n" + CELL, "mine.holds"]
    import nbformat  # slow to import, and this test is a long one
    from nbclient import NotebookClient

    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in cells])
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.outputs]
    assert all(output.output_type == "execute_result" for output in shown) and len(shown) == 3
    assert "PROVED" in shown[0].data["text/html"] and "REFUTED" in shown[1].data["text/html"]
    assert shown[2].data["text/plain"] == "False"
