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
# # Regimes of the guaranteed estimator
#
# **Question.** Velocity is measured for a time T (in Schuler units), with noise of known variance and
# unknown correlation. Which instants does the best estimator use, with which weights, and what error
# does it guarantee, *for every T up to a full Schuler period*? And where is a grid of instants with a
# linear programme wrong, and by how much?

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp
from ipywidgets import FloatSlider, interact

from navsym.cli.main import run as navsym
from navsym.core.datasets import dataset, local_copy
from navsym.guaranteed.baselines import realise, search_correlations
from navsym.guaranteed.lengths import values_for_lengths
from navsym.guaranteed.phases.driver import find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import model_from

CHANNEL = {
    "model": {
        "name": "velocity channel",
        "states": ["y1", "y2", "y3"],
        "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    },
    "parameters": {"T": ["0", "2*pi"]},
    "measurement": [{"name": "velocity", "h": ["1", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
}
FAMILY = {state: family_of(model_from(CHANNEL), state, "T") for state in ("y1", "y2", "y3")}

# %% [markdown]
# ## The complete solution
# Patterns of instants are searched for, closed forms recognised, and each is proved as a primal-dual
# pair for every T of its regime. Nothing is left open.

# %%
ANSWER = {state: find_phases(family, sp.Integer(0), 2 * sp.pi) for state, family in FAMILY.items()}
for state, answer in ANSWER.items():
    for regime in answer.regimes:
        print(f"{state}  {regime.lower} < T < {regime.upper}:  {regime.closed.value}  {regime.status}")
assert all(r.status == "PROVED" for a in ANSWER.values() for r in a.regimes)
assert all(not a.uncovered for a in ANSWER.values())
ANSWER["y3"]

# %% [markdown]
# ## The phase diagram
# Value, instants and weights against T; regimes are shaded. An instant leaves the estimator where its
# weight vanishes, and two instants are enough for the rest of the period.


# %%
def curve(answer, expression_of, T):
    """A quantity of the regimes on a grid of lengths; NaN outside."""
    symbol = answer.family.parameter
    values = np.full(T.size, np.nan)
    for regime in answer.regimes:
        inside = (float(regime.lower) < T) & (float(regime.upper) > T)
        formula = sp.lambdify(symbol, expression_of(regime), "numpy")
        values[inside] = formula(T[inside])
    return values


NAMES = {"y1": "velocity $y_1$", "y2": "tilt $y_2$", "y3": "drift $y_3$"}
T = np.linspace(0.25, 6.27, 700)
figure, axes = plt.subplots(3, 3, figsize=(11, 8), sharex=True)
for column, (state, answer) in zip(axes.T, ANSWER.items(), strict=True):
    column[0].semilogy(T, curve(answer, lambda r: r.closed.value, T))
    most = max(len(r.closed.places) for r in answer.regimes)
    for k in range(most):
        at = curve(answer, lambda r, k=k: r.closed.places[k] if k < len(r.closed.places) else sp.nan, T)
        weight = curve(answer, lambda r, k=k: r.closed.weights[k] if k < len(r.closed.weights) else sp.nan, T)
        column[1].plot(T, T - at, ".", markersize=2)
        column[2].plot(T, weight, ".", markersize=2)
    for axis in column:
        for k, regime in enumerate(answer.regimes):
            axis.axvspan(float(regime.lower), float(regime.upper), color="0.9" if k % 2 else "0.97", zorder=0)
    column[0].set_title(NAMES[state])
    column[2].set_ylim(-5, 5)  # the weights of a short interval grow beyond every picture
    column[2].set_xlabel("T, Schuler units")
for axis, name in zip(axes[:, 0], (r"guaranteed error, $\sigma$", "instants, Schuler units", "weights"), strict=True):
    axis.set_ylabel(name)
figure.tight_layout()

# %% [markdown]
# The same values by the general search for a thousand lengths, in a few milliseconds:

# %%
lengths = np.linspace(0.3, 6.2, 1000)
for state, answer in ANSWER.items():
    difference = values_for_lengths(FAMILY[state], lengths) / curve(answer, lambda r: r.closed.value, lengths) - 1
    print(state, f"largest relative difference {np.nanmax(np.abs(difference)):.1e}")
    assert np.nanmax(np.abs(difference)) < 1e-9

# %% [markdown]
# ## The dual polynomial
# It touches ±1 at the instants of the estimator and nowhere leaves the band. Move T.


# %%
def draw(length=1.5, state="y3"):
    answer, family = ANSWER[state], FAMILY[state]
    regime = next(r for r in answer.regimes if float(r.lower) <= length <= float(r.upper))
    x = [float(sp.sympify(d).subs(family.parameter, length)) for d in regime.closed.dual]
    places = [float(sp.sympify(p).subs(family.parameter, length)) for p in regime.closed.places]
    u = np.linspace(0.0, length, 400)
    H = np.array([np.ones_like(u), np.sin(u), np.cos(u) - 1.0])
    plt.figure(figsize=(7, 3))
    plt.axhspan(-1, 1, color="0.93")
    plt.plot(length - u, x @ H)
    at = np.array([np.ones_like(places), np.sin(places), np.cos(places) - 1.0])
    plt.plot(length - np.array(places), x @ at, "o")
    plt.xlabel("time from the start, Schuler units")
    plt.ylabel("dual polynomial")
    plt.title(
        f"{NAMES[state]}, T = {length:.2f}: error {float(regime.closed.value.subs(family.parameter, length)):.4f}"
    )
    plt.show()


interact(draw, length=FloatSlider(value=1.5, min=0.3, max=6.2, step=0.05), state=list(FAMILY))

# %% [markdown]
# ## Where a grid and a linear programme are wrong
# The certified value beside every solver, for a short and for a long interval. On the short interval the
# regressors are nearly dependent; a success status is no guarantee.

# %%
for length in ("1/100", "1/4", "5/2"):
    solution = solve(FAMILY["y3"].problem(sp.Rational(length)), digits=30)
    beside = solution.compare().document()
    print(f"T = {length}: {solution.lower} … {solution.upper}")
    print(f"   least squares under its own worst correlation: {beside['least_squares']:.6g}")
    for row in beside["solvers"]:
        error = "no value" if row["value"] is None else f"relative error {row['relative_error']:+.1e}"
        print(f"   {row['solver']:15} {row['status']:20.20} {error}")

# %% [markdown]
# ## The worst noise
# One standard normal number times the signs of the weights is a noise that reaches the guaranteed
# deviation; no correlation that a search tries exceeds it.

# %%
solution = solve(FAMILY["y3"].problem(sp.pi / 2), digits=20)
reached = np.std(realise(solution, 100_000, seed=1))
print(
    f"guaranteed {float(solution.value):.4f}, reached in simulation {reached:.4f}, "
    f"best of a search {search_correlations(solution, 2000):.4f}"
)
assert abs(reached / float(solution.value) - 1) < 0.02

# %% [markdown]
# ## A real noise: Doppler in a city
# A car in Nagoya; twenty minutes are a quarter of a Schuler period. The noise is Doppler velocity minus
# that of a reference system, with gross outliers; the errors of the channel are added by us and are
# therefore known. Each estimator is applied to many windows.

# %%
run, judge = (local_copy(dataset(name)) for name in ("nagoya-spp", "nagoya-reference"))
if run is None or judge is None:
    print("The recorded run is not here: navsym data get nagoya-spp and nagoya-reference, or set NAVSYM_DATA.")
    noise = None
else:
    lines = run.read_text("utf-8").splitlines()
    rows = [line.split() for line in lines if line and not line.startswith("%")]
    clock = np.array([np.dot([3600.0, 60.0, 1.0], [float(p) for p in row[1].split(":")]) for row in rows])
    east = np.array([float(row[16]) for row in rows])
    reference = np.genfromtxt(judge, delimiter=",", skip_header=1, usecols=(0, 11))
    day = 86400.0 * (reference[0, 0] // 86400.0)
    at = np.interp(clock, reference[:, 0] - day, reference[:, 1])
    noise = east - at
    print(
        f"{noise.size} epochs, median |noise| {np.median(np.abs(noise)):.3f} m/s, largest {np.abs(noise).max():.1f} m/s"
    )

# %%
if noise is not None:
    schuler = np.sqrt(9.81 / 6.371e6)
    errors = {"guaranteed": [], "least squares": []}
    window = 400.0
    for start in np.arange(clock[0], clock[-1] - window, 15.0):
        inside = (clock >= start) & (clock <= start + window)
        u = schuler * (start + window - clock[inside])
        H = np.array([np.ones_like(u), np.sin(u), np.cos(u) - 1.0])
        estimator = solve(FAMILY["y2"].problem(sp.Rational(str(round(schuler * window, 6)))), digits=12)
        picked = [int(np.argmin(np.abs(u - float(row.at)))) for row in estimator.support]
        nearest = np.linalg.solve(H[:, picked], [0.0, 1.0, 0.0])
        errors["guaranteed"].append(nearest @ noise[inside][picked])
        errors["least squares"].append((np.linalg.pinv(H.T) @ noise[inside])[1])
    for name, values in errors.items():
        print(f"{name:14} median |error| {np.median(np.abs(values)):.3f}, worst {np.max(np.abs(values)):.3f} m/s")
    plt.figure(figsize=(8, 3))
    for name, values in errors.items():
        plt.plot(np.abs(values), label=name)
    plt.yscale("log")
    plt.legend()
    plt.xlabel("number of the window, one every 15 s")
    plt.ylabel("|error of y2|, m/s")
    plt.show()

# %% [markdown]
# The guaranteed estimator uses three epochs only: it does not average, and an outlier at one of its three
# epochs hits it fully, while least squares spreads every outlier over all estimates. The guarantee bounds
# the error by the noise's deviation whatever its correlation; it does not promise to beat averaging when
# the noise happens to be white.

# %% [markdown]
# ## Out of the house
# The guaranteed error of the tilt as code, on the range for which it is proved.

# %%
with tempfile.TemporaryDirectory() as folder:
    words = ["export", "guaranteed_velocity:4.13.y2", "--to", "python", "--out", folder, "--vectors", "8"]
    assert navsym(words) == 0
    source = (Path(folder) / "python" / "navsym_functions.py").read_text(encoding="utf-8")
print(source)
