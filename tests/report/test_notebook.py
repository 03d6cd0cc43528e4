"""Sliders over a model show the estimator at exact numbers, and a bar of progress ends as one line of text."""

from __future__ import annotations

import random

import matplotlib.pyplot as plt
import pytest
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output

import navsym as nav


def swing(**ranges):
    return nav.Model(
        "x v", F=[["0", "1"], ["-w**2", "0"]], H=["x"], interval="T", targets={"x": "x", "speed": "v"}, **ranges
    )


def test_a_model_has_a_slider_for_each_parameter_with_exact_stops():
    widget = nav.explore(swing(w=("1/2", "2"), T="positive"), "speed", T=("1", "pi"))
    sliders = {slider.description: slider for slider in widget.children[:-1]}
    assert {*sliders} == {"w", "T"} and sliders["T"].options[-1][1] == "pi"
    stop = random.Random(26).randrange(len(sliders["w"].options))
    label, exact = sliders["w"].options[stop]
    sliders["w"].index = stop
    with capture_output():
        widget.update()
    expected = nav.solve(swing(w=("1/2", "2"), T="positive"), "speed", T=sliders["T"].value, w=exact)
    assert f"{float(expected.value):.4g}" in "".join(text.get_text() for text in widget.result.findobj(plt.Text))
    assert float(label) == pytest.approx(eval(exact), rel=1e-3)


def test_a_stop_without_an_estimator_says_why():
    widget = nav.explore(swing(w=("1/2", "2"), T=("0", "2")))
    widget.children[1].index = 0
    with capture_output() as shown:
        widget.update()
    assert widget.result is None and "expected a length of time T above zero" in shown.stdout


@pytest.mark.parametrize(
    ("ranges", "kind", "hint"),
    [
        ({}, "domain", "write T="),
        ({"T": ("1",)}, "shape", "two ends of a slider"),
        ({"T": 3}, "shape", r"got 3; .*T=\(.*nav.solve"),
        ({"T": ("2", "1")}, "domain", "swap"),
        ({"T": ("1", "2"), "u": ("1", "2")}, "domain", "got u"),
    ],
)
def test_a_parameter_without_two_ends_is_asked_for(ranges, kind, hint):
    with pytest.raises(nav.NavsymError, match=hint) as caught:
        nav.explore(swing(w=("1/2", "2"), T="positive"), **ranges)
    assert caught.value.kind == kind and caught.value.where.startswith("explore")


def test_a_function_without_three_numbers_and_a_target_of_no_name_are_refused():
    for ends in (5, (1, 2), (3, 1, 2), (0.0, float("nan"), 1.0)):
        with pytest.raises(nav.NavsymError, match="lowest, highest, start"):
            nav.explore(lambda T: None, T=ends)
    with pytest.raises(nav.NavsymError, match="did you mean speed"):
        nav.explore(swing(w=("1/2", "2"), T=("1", "2")), "sped")


@pytest.mark.parametrize(
    ("steps", "last"),
    [
        ([(1, 2, "a"), (2, 2, "b")], "2 of 2 b"),
        ([("a",), ("b",)], "2 b"),
        ([(3, 9), (4, 9)], "4 of 9"),
        ([(None, 7), (None, 7)], "2 of 7"),
    ],
)
def test_a_bar_understands_whatever_a_call_tells(steps, last):
    bar = nav.ProgressBar()
    assert [bar.tell(*step) for step in steps][-1] == last


def test_a_bar_in_a_notebook_is_drawn_while_it_works_and_is_text_at_its_end(monkeypatch):
    InteractiveShell.clear_instance()
    InteractiveShell.instance(history_length=0).history_manager.enabled = False
    InteractiveShell.instance().kernel = None  # what a notebook has and a terminal has not
    bar = nav.ProgressBar()
    with capture_output() as shown:
        ledger = nav.verify("alpha_beta_filter", progress=bar, jobs=1)
    pages = [output.data["text/html"] for output in shown.outputs]
    InteractiveShell.clear_instance()
    total = len(ledger.claims)
    assert "<progress" in pages[0] and "<progress" not in pages[-1] and pages[-1].startswith(f"{total} of {total}")
    assert not shown.stderr and len(pages) <= total


def test_a_bar_in_a_terminal_is_one_line_that_ends_when_all_is_done(capsys):
    bar = nav.ProgressBar()
    for done in (1, 2):
        bar(done, 2, "a")
    shown = capsys.readouterr()
    assert shown.err.endswith("\r2 of 2 a\x1b[K\n") and shown.err.count("\n") == 1 and not shown.out


@pytest.mark.long
def test_a_notebook_with_sliders_and_a_bar_runs_in_a_kernel_and_leaves_no_bar(tmp_path):
    import nbformat  # slow to import, and this test is a long one
    from nbclient import NotebookClient

    model = "m = nav.Model('x v', F=[['0', '1'], ['-w**2', '0']], H=['x'], interval='3', w=('1/2', '2'))"
    cells = [
        "import navsym as nav",
        f"{model}\nnav.explore(m)",
        "nav.verify('alpha_beta_filter', progress=nav.ProgressBar())",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in cells])
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    widget, (bar, ledger) = notebook.cells[1].outputs[0], notebook.cells[2].outputs
    assert "application/vnd.jupyter.widget-view+json" in widget.data
    assert bar.data["text/html"].startswith("19 of 19") and "19 claims" in ledger.data["text/plain"]


def test_a_function_is_drawn_at_its_start_and_at_all_ends():
    drawn = []
    widget = nav.explore(lambda a, b: drawn.append((a, b)), a=(0.0, 2.0, 0.5), b=(-1.0, 1.0, 0.25))
    assert {(0.0, 0.25), (2.0, 0.25), (0.5, -1.0), (0.5, 1.0)} <= {*drawn}
    assert [slider.value for slider in widget.children[:-1]] == [0.5, 0.25]
