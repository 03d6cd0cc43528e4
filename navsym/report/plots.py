"""Pictures in one style: units on the axes, colours that everybody can tell apart, SVG.

Every function takes plain arrays and returns a matplotlib ``Figure`` made without any global state;
``svg`` turns it into text that is the same for the same data.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import LightSource
from matplotlib.figure import Figure

#: The palette of Okabe and Ito, told apart with every common colour blindness.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#f0e442", "#000000")
STYLES = ("-", "--", ":", "-.")
Array = np.ndarray
Rows = Sequence[Mapping[str, Any]]


def figure(width: float = 7.0, height: float = 3.5) -> tuple[Figure, Axes]:
    """An empty figure with one pair of axes, without a frame on the right and above."""
    made = Figure(figsize=(width, height), layout="constrained")
    axes = made.add_subplot()
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
    return made, axes


def svg(picture: Figure) -> str:
    """The picture as SVG text, without a date and with reproducible names inside."""
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": "navsym", "svg.fonttype": "none"}):
        picture.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def dual_polynomial(times: Array, values: Array, support: Array, *, sigma: float = 1.0, unit: str = "s") -> Figure:
    """The dual polynomial between its bounds, with the instants at which it touches them.

    times, values : (n,) the curve x.H(t)
    support       : (k,) instants of the best estimator
    """
    made, axes = figure()
    axes.plot(times, values, color=COLOURS[0])
    for bound in (-sigma, sigma):
        axes.axhline(bound, color="0.4", linewidth=1, linestyle="--")
    axes.plot(support, np.interp(support, times, values), "o", color=COLOURS[1], label="instants of measurement")
    axes.set(xlabel=f"time, {unit}", ylabel="dual polynomial, 1")
    axes.legend(loc="best", frameon=False)
    return made


def phase_diagram(regimes: Rows, *, parameter: str, unit: str, quantity: str) -> Figure:
    """The optimum over a parameter, one colour and line style for each regime, boundaries as lines.

    regimes : each with ``at`` (n,) values of the parameter, ``value`` (n,) and ``label``
    """
    made, axes = figure()
    for place, regime in enumerate(regimes):
        axes.plot(regime["at"], regime["value"], STYLES[place % 4], color=COLOURS[place % 7], label=regime["label"])
        if place:
            axes.axvline(regime["at"][0], color="0.6", linewidth=0.8)
    axes.set(xlabel=f"{parameter}, {unit}", ylabel=quantity)
    axes.legend(loc="best", frameon=False)
    return made


def mode_ribbon(times: Array, probabilities: Array, names: Sequence[str], *, truth: Array | None = None) -> Figure:
    """Mode probabilities as a ribbon that is always one high; the true mode as a strip above it.

    probabilities : (n, k), rows sum to one
    truth         : (n,) numbers of the true modes, or None
    """
    made, axes = figure(height=3.0)
    axes.stackplot(times, probabilities.T, colors=COLOURS[: probabilities.shape[1]], labels=names, step="mid")
    if truth is not None:
        for mode in range(probabilities.shape[1]):
            axes.fill_between(times, 1.03, 1.09, where=truth == mode, color=COLOURS[mode], step="mid", linewidth=0)
    axes.set(xlabel="time, s", ylabel="probability of the mode", ylim=(0, 1.1 if truth is not None else 1))
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    return made


def error_ribbon(times: Array, error: Array, deviation: Array, *, quantity: str, unit: str) -> Figure:
    """An error with the ribbon of three standard deviations that the filter claims."""
    made, axes = figure(height=3.0)
    axes.fill_between(times, -3 * deviation, 3 * deviation, color=COLOURS[5], alpha=0.4, label="3 standard deviations")
    axes.plot(times, error, color=COLOURS[0], linewidth=1, label="error")
    axes.set(xlabel="time, s", ylabel=f"{quantity}, {unit}")
    axes.legend(loc="best", frameon=False)
    return made


def criterion_surface(
    heights: Array, criterion: Array, *, cell: float, track: Array, found: tuple[float, float]
) -> Figure:
    """The map in shaded relief, the criterion as contours over it, the track and the fix.

    heights   : (rows, columns), row = y, in metres
    criterion : the same shape; NaN where no hypothesis lies
    cell      : side of a cell in metres
    track     : (n, 2) x and y in metres
    """
    made, axes = figure(6.5, 5.5)
    rows, columns = heights.shape
    extent = (0.0, columns * cell, 0.0, rows * cell)
    shade = LightSource(azdeg=315, altdeg=45).hillshade(heights, vert_exag=2.0, dx=cell, dy=cell)
    axes.imshow(shade, cmap="gray", origin="lower", extent=extent, vmin=-0.5, vmax=1.2)
    x = (np.arange(columns) + 0.5) * cell
    y = (np.arange(rows) + 0.5) * cell
    drawn = axes.contour(x, y, criterion, levels=8, cmap="viridis", linewidths=1)
    made.colorbar(drawn, ax=axes, label="criterion, m²")
    axes.plot(track[:, 0], track[:, 1], color=COLOURS[1], linewidth=2, label="track")
    axes.plot(*found, "*", color=COLOURS[4], markeredgecolor="black", markersize=14, label="fix")
    axes.grid(False)
    axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    axes.legend(loc="upper right")
    return made


def condition_numbers(sizes: Array, printed: Array, certified: Array) -> Figure:
    """Condition numbers as printed beside the certified ones, logarithmic; a gap is a misprint."""
    made, axes = figure()
    axes.semilogy(sizes, certified, "o-", color=COLOURS[0], label="certified")
    axes.semilogy(sizes, printed, "x", color=COLOURS[1], markersize=9, markeredgewidth=2, label="printed")
    axes.set(xlabel="order n, 1", ylabel="condition number, 1")
    axes.legend(loc="best", frameon=False)
    return made


def observability_ladder(names: Sequence[str], ranks: Array, size: int) -> Figure:
    """Rank reached by h, hF, hF^2, ... for each measurement: a stair that stops where nothing new is seen.

    ranks : (measurements, size), the rank after each power of F
    """
    made, axes = figure(height=3.0)
    powers = np.arange(1, ranks.shape[1] + 1)
    for place, (name, row) in enumerate(zip(names, ranks, strict=True)):
        axes.step(powers, row + 0.05 * place, STYLES[place % 4], where="mid", color=COLOURS[place % 7], label=name)
    axes.axhline(size, color="0.4", linewidth=1, linestyle="--")
    axes.set(xlabel="rows h, hF, hF², …, 1", ylabel="rank, 1", ylim=(0, size + 0.5), xticks=powers)
    axes.legend(loc="lower right", frameon=False)
    return made
