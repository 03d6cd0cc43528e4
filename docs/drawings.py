"""Drawings of the documentation, in the style of :mod:`navsym.report.plots`: plain arrays in, a figure out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import LightSource
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from navsym.report.plots import COLOURS, STYLES, Array, figure, panels


def dual_polynomial(
    times: Array,
    values: Array,
    support: Array,
    weights: Array,
    *,
    printed: Array | None = None,
    sigma: float = 1.0,
    unit: str = "s",
) -> Figure:
    """The dual polynomial in its band; below it the weights of the measurements at which it touches.

    times, values    : (n,) the curve x.H(t)
    support, weights : (k,) instants of the best estimator and what they are multiplied by
    printed          : (n,) the curve of a printed formula that leaves the band, or None
    """
    made, (above, below) = panels((2, 1), 4.4)
    above.axhspan(-sigma, sigma, color="0.93", zorder=0)
    for bound in (-sigma, sigma):
        above.axhline(bound, color="0.4", linewidth=1)
    above.plot(times, values, color=COLOURS[0], label="derived: touches its bounds")
    if printed is not None:
        above.plot(times, printed, STYLES[1], color=COLOURS[1], label="as printed: leaves them")
    above.plot(support, np.interp(support, times, values), "o", color=COLOURS[0])
    above.set(ylabel="dual polynomial, 1")
    above.legend(loc="lower center", frameon=False)
    below.axhline(0, color="0.4", linewidth=1)
    below.vlines(support, 0, weights, color=COLOURS[0], linewidth=3)
    below.plot(support, weights, "o", color=COLOURS[0])
    for at, weight in zip(support, weights, strict=True):
        place = {"xytext": (7, 0), "textcoords": "offset points", "va": "center", "fontsize": 9}
        below.annotate(f"{weight:+.3f}", (at, weight / 2), **place)
    below.set(xlabel=f"time, {unit}", ylabel="weight, 1")
    below.margins(0.07, 0.15)
    above.set_xlabel(below.get_xlabel()).set_visible(False)
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
    heights: Array,
    criterion: Array,
    *,
    cell: float,
    track: Array,
    origin: tuple[float, float] = (0.0, 0.0),
    step: float = 1.0,
) -> Figure:
    """The map in shaded relief with the track; around its last point the criterion over displacements, and the fix.

    heights   : (rows, columns), row = y, in metres; the first cell lies at ``origin``
    criterion : (rows, columns) over displacements of the track, the middle one being zero
    cell      : side of a cell of the map in metres
    step      : step of the displacements in metres
    track     : (n, 2) x and y in metres
    """
    made, axes = figure(7.0, 4.8)
    rows, columns = heights.shape
    left, bottom = origin[0] / 1000, origin[1] / 1000
    extent = (left, left + columns * cell / 1000, bottom, bottom + rows * cell / 1000)
    shade = LightSource(azdeg=315, altdeg=45).hillshade(heights, vert_exag=2.0, dx=cell, dy=cell)
    axes.imshow(shade, cmap="gray", origin="lower", extent=extent, vmin=-0.5, vmax=1.2)
    displaced = [(np.arange(n) - n // 2) * step for n in criterion.shape]
    x, y = (track[-1, axis] + displaced[1 - axis] for axis in (0, 1))
    drawn = axes.contourf(x / 1000, y / 1000, np.sqrt(criterion / len(track)), levels=9, cmap="viridis", alpha=0.75)
    made.colorbar(drawn, ax=axes, label="root mean square misfit, m", location="bottom", shrink=0.5)
    axes.plot(track[:, 0] / 1000, track[:, 1] / 1000, color=COLOURS[1], linewidth=2, label="inertial track")
    row, column = np.unravel_index(np.nanargmin(criterion), criterion.shape)
    fix = (x[column] / 1000, y[row] / 1000)
    axes.plot(*fix, "*", color=COLOURS[4], markeredgecolor="black", markersize=14, label="fix at the end")
    axes.grid(False)
    axes.set(xlabel="x, km", ylabel="y, km", aspect="equal")
    for limit, values, (low, high) in ((axes.set_xlim, x, extent[:2]), (axes.set_ylim, y, extent[2:])):
        along = np.r_[values, track[:, 0 if limit == axes.set_xlim else 1]] / 1000
        limit(max(low, along.min() - 1.5), min(high, along.max() + 1.5))
    axes.legend(loc="best")
    return made


def condition_numbers(sizes: Array, printed: Array, certified: Array, double: Array | None = None) -> Figure:
    """Condition numbers as printed beside the certified ones, logarithmic; a gap is a misprint.

    double : what double precision makes of them, or None
    """
    made, axes = figure()
    axes.semilogy(sizes, certified, "o-", color=COLOURS[0], label="certified")
    if double is not None:
        axes.semilogy(sizes, double, "s--", color=COLOURS[2], markerfacecolor="none", label="double precision")
    axes.semilogy(sizes, printed, "x", color=COLOURS[1], markersize=9, markeredgewidth=2, label="printed")
    axes.set(xlabel="order n, 1", ylabel="condition number, 1", xticks=sizes)
    axes.legend(loc="best", frameon=False)
    return made


def observability_ladder(names: Sequence[str], ranks: Array, size: int) -> Figure:
    """Rank reached by h, hF, hF^2, ... for each measurement: one line of squares, dark while something new is seen.

    ranks : (measurements, rows), the rank after each row
    """
    made, axes = figure(7.0, 0.5 * len(names) + 0.9)
    grown = np.diff(ranks, axis=1, prepend=0) > 0
    for line, (row, new) in enumerate(zip(ranks, grown, strict=True)):
        for place, rank in enumerate(row):
            ground, ink = (COLOURS[0], "white") if new[place] else ("0.93", "0.35")
            axes.add_patch(Rectangle((place + 0.54, line - 0.42), 0.92, 0.84, facecolor=ground))
            axes.text(place + 1, line, str(rank), color=ink, ha="center", va="center", fontsize=9)
        axes.text(len(row) + 0.7, line, f"{row[-1]} of {size}", va="center", fontsize=9, fontweight="bold")
    axes.grid(False)
    axes.spines[["left", "bottom"]].set_visible(False)
    axes.tick_params(length=0)
    axes.set(xlim=(0.5, ranks.shape[1] + 1.8), ylim=(len(names) - 0.5, -0.5))
    axes.set(xticks=np.arange(1, ranks.shape[1] + 1), yticks=range(len(names)), yticklabels=names)
    axes.set(xlabel="rows used of h, hF, hF², …, number", ylabel="measurement, rank")
    return made
