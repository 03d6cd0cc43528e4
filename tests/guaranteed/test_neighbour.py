"""The guard beside interval contractors on the recorded Doppler velocities of a drive in a city."""

from __future__ import annotations

import csv
import functools
import os
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import navsym as nav

MEMORY, SIGMA = 12, 1.0
#: What is known beforehand of the velocity error (m/s), its drift (m/s^2) and the change of it (m/s^3): contractors
#: need a box to begin with.
PRIOR = ((-50.0, 50.0), (-2.0, 2.0), (-0.5, 0.5))
MODEL = {"states": "e d c", "F": [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3], "H": ["e"]}


def recorded():
    """Seconds, and errors of the eastward Doppler velocity in m/s."""
    folder = Path(os.environ.get("NAVSYM_DATA", "")) / "gnss_ins"
    doppler, judge = folder / "nagoya_rover_1Hz_spp.pos", folder / "nagoya_reference.csv"
    if not doppler.exists() or not judge.exists():
        pytest.skip("the recorded drive is not here: set NAVSYM_DATA to a folder with gnss_ins/nagoya_reference.csv")
    with judge.open(encoding="utf-8") as file:
        east = {round(float(row[0]), 1): float(row[11]) for row in list(csv.reader(file))[1:]}
    rows = [line.split() for line in doppler.read_text(encoding="utf-8").splitlines() if not line.startswith("%")]
    clock = [[float(x) for x in row[1].split(":")] for row in rows]
    weekday = min(east) // 86400 * 86400
    seconds = [round(weekday + 3600 * h + 60 * m + s, 1) for h, m, s in clock]
    return seconds, [float(row[16]) - east[t] for t, row in zip(seconds, rows, strict=True)]


def contract(constraints):
    """The box that is left when contractors of ``sum h_k x_k in [low, high]``, forward and backward, change nothing."""
    box = np.array(PRIOR)
    for _ in range(200):
        before = box.copy()
        for h, low, high in constraints:
            parts = np.sort(box * h[:, None], axis=1)
            for k in np.flatnonzero(h):
                rest = parts.sum(axis=0) - parts[k]
                ends = np.sort((np.array([low, high]) - rest[::-1]) / h[k])
                box[k] = max(box[k, 0], ends[0]), min(box[k, 1], ends[1])
                parts[k] = np.sort(box[k] * h[k])
        if np.abs(box - before).max() < 1e-9:
            break
    return box


def contract_by_codac(codac, constraints):
    """The same by a library of interval methods."""
    box, x = codac.IntervalVector([list(side) for side in PRIOR]), codac.VectorVar(len(PRIOR))
    forms = [(codac.AnalyticFunction([x], sum((float(a) * x[k] for k, a in enumerate(h) if a and k), x[0])), low, high)
             for h, low, high in constraints]  # fmt: skip
    contractors = [codac.CtcInverse(f, codac.Interval(low, high)) for f, low, high in forms]
    for _ in range(200):
        before = codac.IntervalVector(box)
        for contractor in contractors:
            contractor.contract(box)
        if max(abs(a.lb() - b.lb()) + abs(a.ub() - b.ub()) for a, b in zip(box, before, strict=True)) < 1e-9:
            break
    return np.array([[side.lb(), side.ub()] for side in box])


def run(contractor, target, most=None):
    """Half widths (epochs, 2) by the guard and by contractors where the assumption holds; the truth is in both."""
    seconds, errors = recorded()
    guard = nav.Guard(nav.Model(**MODEL), target, memory=MEMORY)
    place, window, pairs = MODEL["states"].split().index(target), [], []
    for t, error in list(zip(seconds, errors, strict=True))[:most]:
        elapsed = t - seconds[0]
        truth = np.array([0.8 + 0.002 * elapsed, 0.002, 0.0])
        if abs(error) > SIGMA:  # a gross error is no question of this comparison
            continue
        z = round(truth[0] + error, 6)
        guard.step(z, t=Fraction(str(t)))
        window = [*window, (t, z)][-MEMORY:]
        if len(window) < MEMORY:
            continue
        found = guard.interval()
        low, high = float(found.lower), float(found.upper)
        rows = [(np.array([1.0, s - t, (s - t) ** 2 / 2]), v - SIGMA, v + SIGMA) for s, v in window]
        a, b = contractor(rows)[place]
        assert a - 1e-6 <= low <= truth[place] + 1e-9 and truth[place] - 1e-9 <= high <= b + 1e-6
        pairs.append(((high - low) / 2, (b - a) / 2))
    return np.array(pairs)


def test_the_guard_is_never_wider_than_interval_contractors_and_narrower_for_slopes():
    """Wherever a single measurement shows the target the two agree; for drifts the guard is narrower."""
    ratios = {}
    for target in MODEL["states"].split():
        pairs = run(contract, target, 90)
        assert len(pairs) > 60
        ratios[target] = float(np.median(pairs[:, 0] / pairs[:, 1]))
    assert ratios["e"] <= 1 + 1e-9 and ratios["d"] < 0.9 and ratios["c"] < 0.75


def test_a_library_of_interval_methods_finds_the_box_of_the_plain_contractors():
    codac = pytest.importorskip("codac", reason="pip install codac")
    ours, theirs = run(contract, "d", 40), run(functools.partial(contract_by_codac, codac), "d", 40)
    assert np.allclose(ours, theirs, rtol=1e-6)
