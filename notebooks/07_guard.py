# ---
# jupyter:
#   jupytext:
#     formats: py:percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Protection levels for the velocity of an inertial system
#
# **Question.** An inertial system drifts, and a receiver measures its velocity by Doppler shifts, in a city, with gross
# errors. How far off is the corrected velocity at most, second by second, and which epochs are faulty?
#
# The Doppler velocities are recorded, and so are their errors. The inertial system is made: it is the reference of the
# same run plus an offset and a drift, so that the true error is known and every protection level can be judged.

# %%
import csv
from fractions import Fraction

import matplotlib.pyplot as plt
import numpy as np

import navsym as nav

BLUE, ORANGE, RED = "#0072b2", "#e69f00", "#d55e00"
SIGMA, MEMORY = 1.0, 12  # m/s, the declared bound of a Doppler error; epochs
MODEL = nav.Model("e d", [["0", "1"], ["0", "0"]], ["e"], sigma="1", targets={"error": "e"})  # velocity error, drift


def recorded(doppler, reference):
    """Seconds, and errors of the eastward Doppler velocity in m/s against the reference."""
    with open(reference, encoding="utf-8") as file:
        east = {round(float(row[0]), 1): float(row[11]) for row in list(csv.reader(file))[1:]}
    with open(doppler, encoding="utf-8") as file:
        rows = [line.split() for line in file if not line.startswith("%")]
    clock = [[float(x) for x in row[1].split(":")] for row in rows]
    weekday = min(east) // 86400 * 86400
    seconds = [round(weekday + 3600 * h + 60 * m + s, 1) for h, m, s in clock]
    return seconds, [float(row[16]) - east[t] for t, row in zip(seconds, rows, strict=True)]


def made(count=400, rate=0.02):
    """The same where the recording is not here: errors within the bound, and some far outside."""
    generator = np.random.default_rng(4)
    gross = generator.uniform(3, 30, count) * (generator.random(count) < rate)
    return list(range(count)), list(generator.uniform(-0.6, 0.6, count) + gross)


doppler, judge = (nav.data()[name] for name in ("nagoya-spp", "nagoya-reference"))
if doppler is None or judge is None:
    print("The recorded run is not here: navsym data get nagoya-spp, and nagoya-reference, or set NAVSYM_DATA.")
seconds, errors = recorded(doppler, judge) if doppler and judge else made()
beyond = np.abs(errors) > SIGMA
worst = np.abs(errors).max()
print(f"{len(errors)} epochs; {beyond.mean():.1%} of the errors exceed {SIGMA} m/s, the worst is {worst:.0f} m/s")

# %% [markdown]
# ## Protection levels
# `truth` is the error of the inertial system. What the guard sees is this plus the error of the Doppler velocity. With
# `outliers=K` the radius holds as long as at most K of the epochs in memory are gross; the reference tells where that
# is so. Data that no K gross errors explain are refused, and the guard starts anew.

# %%
truth = [0.8 + 0.002 * (t - seconds[0]) for t in seconds]


def run(outliers, errors):
    """(truth, estimate or None, whether the assumption holds) of every epoch."""
    guard, rows, seen = nav.Guard(MODEL, memory=MEMORY, outliers=outliers), [], []
    for t, true, error in zip(seconds, truth, errors, strict=True):
        seen = [*seen, abs(error) > SIGMA][-MEMORY:]
        try:
            estimate = guard.step(round(true + error, 6), t=Fraction(str(t)))
        except nav.NavsymError as contradiction:
            assert contradiction.kind == "inconsistent"
            guard, estimate, seen = nav.Guard(MODEL, memory=MEMORY, outliers=outliers), None, []
        rows.append((true, estimate, sum(seen) <= outliers))
    return rows


def judged(rows):
    """Epochs with an estimate, those that contain the truth, those of a true assumption, and violations of these."""
    known = [(abs(e.value - true) <= float(e.radius.upper) + 1e-9, fair) for true, e, fair in rows if e and e.radius]
    return len(known), sum(c for c, _ in known), sum(f for _, f in known), sum(f and not c for c, f in known)


for outliers in (0, 1, 2):
    rows = run(outliers, errors)
    count, contained, fair, violated = judged(rows)
    radius = np.median([float(e.radius.upper) for _, e, _ in rows if e and e.radius])
    print(
        f"K = {outliers}: {contained} of {count} contained; the assumption holds at {fair}, violated {violated}; "
        f"median protection level {radius:.2f} m/s; {sum(e is None for _, e, _ in rows)} contradictions"
    )
    assert violated == 0

# %%
times = np.array(seconds) - seconds[0]
shown = [(t, true, e) for t, (true, e, _) in zip(times, rows, strict=True) if e and e.radius]
middle = np.array([e.value for *_, e in shown])
level = np.array([float(e.radius.upper) for *_, e in shown])
figure, axes = plt.subplots(figsize=(8, 3.2))
axes.fill_between(
    [t for t, *_ in shown], middle - level, middle + level, color=BLUE, alpha=0.3, label="protection level"
)
axes.plot(times, truth, color="black", label="error of the inertial system")
axes.plot(times, np.add(truth, errors), ".", color=ORANGE, ms=3, label="inertial minus Doppler")
axes.set(xlabel="s", ylabel="m/s", ylim=(-4, 8), title="Two gross errors allowed in twelve epochs")
axes.legend(loc="upper left", fontsize=8)
plt.show()

# %% [markdown]
# ## Faults that are proved
# Gross errors are injected into the epochs whose own error is within the bound. Every exclusion carries a certificate:
# no other set of at most K epochs explains the data. The independent checker replays it.

# %%
generator = np.random.default_rng(1)
clean = [e if abs(e) <= SIGMA else 0.0 for e in errors]
places = {k + int(generator.integers(4)) for k in range(MEMORY, len(clean) - 4, MEMORY)}
injected = [
    e + (generator.choice((-1, 1)) * generator.uniform(5, 40) if k in places else 0) for k, e in enumerate(clean)
]
rows = run(2, injected)
count, contained, fair, violated = judged(rows)
assert contained == count and fair == count and violated == 0

accused = {t for _, e, _ in rows if e for t in e.excluded}
faulty = {seconds[k] for k in places}
excluding = [e for _, e, _ in rows if e and e.excluded]
print(f"{len(faulty)} injected, {len(accused & faulty)} proved faulty, {len(accused - faulty)} wrongly")
assert accused <= faulty and all(row.status == "ACCEPTED" for e in excluding[::25] for row in e.check())

# %% [markdown]
# ## What to buy
# Before the drive: a position of bound 5 m, or one of 1 m at five times the price, and a Doppler velocity, at seven
# instants. The best selection within each budget is proved against all others. `slope` says how the level changes with
# an instant.

# %%
OFFER = nav.Model(
    "p v d", [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3], ["p", "v"], sigma=["5", "1"], targets={"drift": "d"}
)
for budget in (4, 8, 12):
    best = nav.design(OFFER, times=range(0, 70, 10), budget=budget, sensors={"z1": [("5", 1), ("1", 5)], "z2": 2})
    print(f"budget {budget}: level {float(best.value.upper):.4f} m/s^2 for {best.cost}: {', '.join(best.bought)}")
    assert best.status == nav.CERTIFIED and best.check()
for point in best.points:
    print(
        f"{point.measurement} at {point.at} s: weight {point.weight:.4g}, share {point.share:.2f}, slope {point.slope}"
    )

# %% [markdown]
# ## On board
# The guard of bounded errors becomes C without allocation, with bounds of all rounding errors. Its stream of test
# vectors is compiled and replayed before anything is written.

# %%
board = nav.Guard(MODEL, memory=MEMORY, step=1)
exported = nav.export(board, ["c", "python"], "build/guard", force=True)
print(exported)
assert all(outcome.status in ("verified", "not executed") for outcome in exported.outcomes)
