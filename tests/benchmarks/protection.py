"""Protection levels on a recorded drive: ``NAVSYM_DATA=… python -m tests.benchmarks.protection``, some minutes.

The errors of the Doppler velocities are recorded; the velocity error of an inertial system is made, so that the truth
is known. (a) The errors as they are: what the levels contain where their assumption holds. (b) Faults of random sizes
and places put into the errors that keep the bound: levels, exclusions and their certificates. (c) Widths beside those
of interval contractors.
"""

from __future__ import annotations

import csv
import os
import sys
import time
from collections import Counter
from fractions import Fraction
from pathlib import Path

import numpy as np

import navsym as nav

MEMORY, SIGMA = 12, 1.0
#: Columns of the Doppler velocities and of the reference.
AXES = {"east": (16, 11), "north": (15, 12), "up": (17, 13)}
DRIFT = nav.Model("e d", [["0", "1"], ["0", "0"]], ["e"], sigma="1", targets={"error": "e"})
#: What is known beforehand of the velocity error (m/s), its drift (m/s^2) and the change of it (m/s^3): contractors
#: need a box to begin with.
PRIOR = ((-50.0, 50.0), (-2.0, 2.0), (-0.5, 0.5))
CURVED = {"states": "e d c", "F": [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3], "H": ["e"]}
#: Sizes of faults in bounds, and their classes.
SIZES, CLASSES = (0.5, 200.0), (2.0, 4.0, 10.0)


def recorded(axis="east"):
    """Seconds, and errors of the Doppler velocity in m/s; None where the recording is not here."""
    folder = Path(os.environ.get("NAVSYM_DATA", "")) / "gnss_ins"
    doppler, judge = folder / "nagoya_rover_1Hz_spp.pos", folder / "nagoya_reference.csv"
    if not doppler.exists() or not judge.exists():
        return None
    measured, true = AXES[axis]
    with judge.open(encoding="utf-8") as file:
        velocity = {round(float(row[0]), 1): float(row[true]) for row in list(csv.reader(file))[1:]}
    rows = [line.split() for line in doppler.read_text(encoding="utf-8").splitlines() if not line.startswith("%")]
    clock = [[float(x) for x in row[1].split(":")] for row in rows]
    weekday = min(velocity) // 86400 * 86400
    seconds = [round(weekday + 3600 * h + 60 * m + s, 1) for h, m, s in clock]
    return seconds, [float(row[measured]) - velocity[t] for t, row in zip(seconds, rows, strict=True)]


def follow(seconds, errors, outliers):
    """(truth, estimate or None, whether the assumption holds) of each epoch; after a contradiction the guard is new."""
    guard, seen = nav.Guard(DRIFT, memory=MEMORY, outliers=outliers), []
    for t, error in zip(seconds, errors, strict=True):
        true = 0.8 + 0.002 * (t - seconds[0])
        seen = [*seen, abs(error) > SIGMA][-MEMORY:]
        fair = sum(seen) <= outliers
        try:
            yield true, guard.step(round(true + error, 6), t=Fraction(str(t))), fair
        except nav.NavsymError as error_of_guard:
            assert error_of_guard.kind == "inconsistent" and not fair, error_of_guard
            guard, seen = nav.Guard(DRIFT, memory=MEMORY, outliers=outliers), []
            yield true, None, fair


def is_contained(true, estimate):
    """Whether the truth is within the level; the measurements are rounded to 1e-6."""
    return abs(estimate.value - true) <= float(estimate.radius.upper) + 1e-6


def judge_as_recorded(outliers):
    """Counts of the errors of all axes as they are, and the median level."""
    counts, levels = Counter(), []
    for axis in AXES:
        for true, estimate, fair in follow(*recorded(axis), outliers):
            if estimate is None or estimate.radius is None:
                counts["contradictions"] += estimate is None
                continue
            inside = is_contained(true, estimate)
            counts += Counter(epochs=1, contained=inside, fair=fair, violated=fair and not inside)
            levels.append(float(estimate.radius.upper))
    return counts, float(np.median(levels))


def choose_places(rng, count, outliers):
    """Places of faults, at most so many in any window of the memory."""
    apart, places, k = int(rng.integers(1, MEMORY)), [], int(rng.integers(MEMORY))
    while k + apart < count:
        places += [k, k + apart][:outliers]
        k += MEMORY + int(rng.integers(3))
    return places


def inject(rng, seconds, errors, outliers):
    """Counts of one pass over a recording whose own errors beyond the bound are taken away before faults come in."""
    clean = [e if abs(e) <= SIGMA else 0.0 for e in errors]
    places = choose_places(rng, len(clean), outliers)
    sizes = {k: float(np.exp(rng.uniform(*np.log(SIZES))) * rng.choice((-1, 1))) for k in places}
    faulty = [e + sizes.get(k, 0.0) for k, e in enumerate(clean)]
    beyond = {seconds[k] for k in places if abs(faulty[k]) > SIGMA}
    counts, accused = Counter(injected=len(places)), set()
    for true, estimate, fair in follow(seconds, faulty, outliers):
        assert fair and estimate is not None, "the assumption holds everywhere"
        if estimate.radius is None:
            continue
        counts += Counter(epochs=1, violated=not is_contained(true, estimate))
        if set(estimate.excluded) - accused:  # a new proof
            accused |= set(estimate.excluded)
            counts += Counter(proofs=1, refused=not estimate.check().accepted)
    counts["wrong"] += len(accused - beyond)
    for k, size in sizes.items():
        band = sum(abs(size) > edge for edge in CLASSES)
        counts += Counter({f"size {band}": 1, f"proved {band}": seconds[k] in accused})
    return counts


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


def compare_widths(contractor, target, most=None, every=1):
    """Half widths (epochs, 2) by the guard and by contractors where the assumption holds; the truth is in both."""
    seconds, errors = recorded()
    guard = nav.Guard(nav.Model(**CURVED), target, memory=MEMORY)
    place, window, pairs = CURVED["states"].split().index(target), [], []
    for t, error in list(zip(seconds, errors, strict=True))[:most]:
        elapsed = t - seconds[0]
        truth = np.array([0.8 + 0.002 * elapsed, 0.002, 0.0])
        if abs(error) > SIGMA:  # a gross error is no question of this comparison
            continue
        z = round(truth[0] + error, 6)
        guard.step(z, t=Fraction(str(t)))
        window = [*window, (t, z)][-MEMORY:]
        if len(window) < MEMORY or guard.epochs % every:
            continue
        found = guard.interval()
        low, high = float(found.lower), float(found.upper)
        rows = [(np.array([1.0, s - t, (s - t) ** 2 / 2]), v - SIGMA, v + SIGMA) for s, v in window]
        a, b = contractor(rows)[place]
        assert a - 1e-6 <= low <= truth[place] + 1e-9 and truth[place] - 1e-9 <= high <= b + 1e-6
        pairs.append(((high - low) / 2, (b - a) / 2))
    return np.array(pairs)


def main(passes=6, every=4):
    if recorded() is None:
        sys.exit("the recorded drive is not here: set NAVSYM_DATA to a folder with gnss_ins/nagoya_reference.csv")
    start = time.process_time()
    for outliers in (0, 1, 2):
        counts, level = judge_as_recorded(outliers)
        print(f"(a) K = {outliers}: {dict(counts)}, median level {level:.2f} m/s", flush=True)
        assert counts["violated"] == 0
    rng, whole = np.random.default_rng(24), Counter()
    for outliers in (1, 2):
        total = Counter()
        for _ in range(passes):
            for axis in AXES:
                total += inject(rng, *recorded(axis), outliers)
        wrong = {name: total[name] for name in ("violated", "wrong", "refused")}
        print(f"(b) K = {outliers}: {dict(sorted(total.items())) | wrong}", flush=True)
        assert not (total["violated"] or total["wrong"] or total["refused"])
        whole += total
    print(f"(b) {whole['injected']} faults, {whole['epochs']} epochs")
    for target in CURVED["states"].split():
        ours, theirs = np.median(pairs := compare_widths(contract, target, every=every), axis=0)
        ratio = np.median(pairs[:, 0] / pairs[:, 1])
        print(f"(c) {target}: {len(pairs)} epochs, {ours:.3g} by the guard, {theirs:.3g} by contractors, {ratio:.2f}")
    print(f"{time.process_time() - start:.0f} s of processor time")


if __name__ == "__main__":
    main()
