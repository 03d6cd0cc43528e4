"""Pictures have words and units on both axes, tell their curves apart twice, and are the same each time."""

from __future__ import annotations

from xml.dom import minidom

import numpy as np
import pytest

from docs import drawings
from navsym.report import plots

t = np.linspace(0.0, 1.0, 50)
P = np.column_stack([t, 1 - t])
BUMPS = np.sin(8 * t)[:, None] + np.cos(6 * t)[None, :]
PICTURES = {
    "dual": lambda: drawings.dual_polynomial(t, 8 * t**2 - 8 * t + 1, np.array([0, 0.5, 1]), np.array([1, -4, 3])),
    "phases": lambda: plots.phase_diagram(
        [{"at": t + 0.1, "value": 1 / (t + 0.1), "label": "1/T"}, {"at": t + 1.1, "value": 1 + 0 * t, "label": "1"}],
        parameter="T",
        unit="s",
        quantity="deviation, m/s",
    ),
    "modes": lambda: plots.mode_ribbon(t, P, ("calm", "rough")),
    "errors": lambda: drawings.error_ribbon(t, 0.1 * np.sin(9 * t), 0.1 + 0 * t, quantity="velocity error", unit="m/s"),
    "surface": lambda: drawings.criterion_surface(
        100 * BUMPS, BUMPS[:21, :21] ** 2, cell=90.0, track=np.array([[0.0, 0.0], [3000.0, 3000.0]]), step=50.0
    ),
    "conditions": lambda: drawings.condition_numbers(np.arange(2, 6), 10.0 ** np.arange(2, 6), 10.0 ** np.arange(2, 6)),
    "ladder": lambda: drawings.observability_ladder(("v", "p"), np.array([[1, 2, 2], [1, 2, 3]]), 3),
}


@pytest.mark.parametrize("name", PICTURES)
def test_axes_carry_words_and_units(name):
    axes = PICTURES[name]().axes[0]
    for label in (axes.get_xlabel(), axes.get_ylabel()):
        assert label and ("," in label or "probability" in label)


@pytest.mark.parametrize("name", PICTURES)
def test_the_svg_is_wellformed_and_reproducible(name):
    first, second = plots.svg(PICTURES[name]()), plots.svg(PICTURES[name]())
    assert first == second
    minidom.parseString(first.encode())


def test_regimes_differ_in_line_style_as_well_as_in_colour():
    lines = PICTURES["phases"]().axes[0].get_lines()
    drawn = [line for line in lines if line.get_label() in ("1/T", "1")]
    assert len({line.get_linestyle() for line in drawn}) == len({line.get_color() for line in drawn}) == 2


@pytest.mark.parametrize("name", ["modes", pytest.param("phases", marks=pytest.mark.long)])
def test_pictures_of_the_documentation_are_drawn_by_what_the_package_draws(name):
    """What a picture adds to a drawing of the package is done to its axes: options of the drawing come and go."""
    from docs import pictures

    axes = pictures.PICTURES[name]().axes[0]
    assert axes.get_yscale() == ("log" if name == "phases" else "linear")
    assert name == "phases" or [words.get_text() for words in axes.texts] == ["truth"]
