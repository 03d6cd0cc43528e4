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
# unknown correlation. At which times does the best estimator measure, with which weights? What error
# does it guarantee, *for every T up to a full Schuler period*? And where does a linear programme on a grid
# go wrong, and by how much?

# %%
import matplotlib.pyplot as plt
import numpy as np

import navsym as nav

channel = nav.Model(
    name="velocity channel",
    states="y1 y2 y3",
    F=[[0, -1, 0], [0, 0, 1], [0, -1, 0]],
    H=["y1"],
    measurements="velocity",
    interval="T",
    T=(0, "2*pi"),
)
NAMES = {"y1": "velocity $y_1$", "y2": "tilt $y_2$", "y3": "drift $y_3$"}
channel

# %% [markdown]
# ## The complete solution
# navsym searches for patterns of times, recognises closed forms, and proves each as a primal-dual
# pair for every T of its regime. Nothing is left open.

# %%
ANSWER = {state: nav.phases(channel, state, T=(0, "2*pi")) for state in NAMES}
for state, answer in ANSWER.items():
    assert all(regime.status == nav.PROVED for regime in answer.regimes) and not answer.uncovered
    for regime in answer.regimes:
        print(state, regime)
ANSWER["y3"]

# %% [markdown]
# ## The phase diagram
# Value and times against T. A time leaves the estimator where its
# weight vanishes, and two times are enough for the rest of the period.

# %%
ANSWER["y2"].plot()

# %%
ANSWER["y3"].plot()

# %% [markdown]
# The closed forms against a search that knows nothing of them: for single lengths, the enclosure of the optimum.

# %%
for state, answer in ANSWER.items():
    for length in ("1/2", "2", "5"):
        estimator = answer.at(T=length)
        assert estimator.status == nav.CERTIFIED and estimator.value.digits >= 25
        print(f"{state}  T = {length:<4} {estimator.value}")

# %% [markdown]
# ## The dual polynomial
# It touches ±1 at the times of the estimator and nowhere leaves the band. Move T.


# %%
def dual_for(T):
    return ANSWER["y3"].at(T=f"{T:.2f}").plot()


nav.explore(dual_for, T=(0.3, 6.2, 1.5))

# %% [markdown]
# ## Where a grid and a linear programme are wrong
# The certified value beside every solver, for a short and for a long interval. On the short interval the
# regressors are nearly dependent; a success status is no guarantee.

# %%
for length in ("1/100", "1/4", "5/2"):
    estimator = nav.solve(channel, "y3", T=length)
    beside = estimator.compare()
    print(f"T = {length}: {estimator.value}")
    print(f"   least squares under its own worst correlation: {beside.least_squares:.6g}")
    for row in beside.solvers:
        error = "no value" if row.value is None else f"relative error {row.relative_error:+.1e}"
        print(f"   {row.solver:15} {row.status:20.20} {error}")

# %% [markdown]
# ## The worst noise
# One standard normal number times the signs of the weights is a noise that reaches the guaranteed
# deviation; no correlation that a search tries exceeds it.

# %%
estimator = nav.solve(channel, "y3", T="pi/2", digits=20)
weights, random = np.array([float(weight) for weight in estimator.weights]), np.random.default_rng(1)  # sigma is 1
noise = random.standard_normal((100_000, 1)) * np.sign(weights)
guaranteed, reached = float(estimator.value), np.std(noise @ weights)
loads = random.standard_normal((2000, weights.size, weights.size))  # correlations U U^T, rows of U of unit length
loads /= np.linalg.norm(loads, axis=2, keepdims=True)
searched = np.linalg.norm(weights @ loads, axis=1).max()
print(f"guaranteed {guaranteed:.4f}, reached in simulation {reached:.4f}, best of a search {searched:.4f}")
assert abs(reached / guaranteed - 1) < 0.02 and searched <= guaranteed

# %% [markdown]
# ## A real noise: Doppler in a city
# A car in Nagoya; twenty minutes are a quarter of a Schuler period. The noise is Doppler velocity minus
# that of a reference system, with gross outliers. We add the errors of the channel ourselves, so that they
# are known. Each estimator is applied to many windows.

# %%
run, judge = (nav.data()[name] for name in ("nagoya-spp", "nagoya-reference"))
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
    noise = east - np.interp(clock, reference[:, 0] - day, reference[:, 1])
    print(f"{noise.size} epochs, median |noise| {np.median(np.abs(noise)):.3f} m/s, largest {abs(noise).max():.1f} m/s")

# %%
if noise is not None:
    schuler = np.sqrt(9.81 / 6.371e6)
    errors = {"guaranteed": [], "least squares": []}
    window = 400.0
    estimator = nav.solve(channel, "y2", T=str(round(schuler * window, 6)), digits=12)
    for start in np.arange(clock[0], clock[-1] - window, 15.0):
        inside = (clock >= start) & (clock <= start + window)
        u = schuler * (start + window - clock[inside])
        H = np.array([np.ones_like(u), np.sin(u), np.cos(u) - 1.0])
        picked = [int(np.argmin(np.abs(schuler * window - u - float(point.at)))) for point in estimator.support]
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
# The guaranteed estimator uses three epochs only. It does not average, and an outlier at one of its three
# epochs hits it fully, while least squares spreads every outlier over all estimates. The guarantee bounds
# the error by the noise's deviation whatever its correlation. It does not promise to beat averaging when
# the noise happens to be white.

# %% [markdown]
# ## Code
# The estimator of the tilt leaves as code, for every T for which it is proved.

# %%
nav.export(ANSWER["y2"], to=["python"], out="build/tilt", vectors=8, force=True)
checked = nav.check("build/tilt")
assert checked.accepted
checked
