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
# # A tour in ten minutes
#
# **Question.** A paper prints a formula for the error with which an inertial system can be corrected.
# Is the formula right? For which intervals? What should have been printed instead, and may I put it
# into a flight computer?
#
# A model is symbols; a derivation reaches a formula by its own route; a claim holds the printed side
# beside the derived one; a verdict says how far the claim holds and why.
#
# ## Five words first
#
# * **Channel.** An inertial system integrates accelerations. A small tilt of its platform mixes gravity into
#   them, so that the velocity goes wrong; the wrong velocity turns the platform back. The errors of velocity
#   and tilt therefore swing together like a pendulum of 84 minutes, pushed by the drift of a gyroscope. Those
#   three errors are one channel.
# * **Schuler unit.** Time divided by that period over 2π, about 13.4 minutes. A quarter of a
#   swing is $\pi/2$.
# * **Guaranteed error.** Two measurements with noise of standard deviation σ, averaged: if their noises are
#   equal the mean is wrong by σ; if they are opposite, by nothing. Who does not know the correlation can
#   promise σ and no less. The guaranteed error is that promise, and the best estimate is the one whose promise
#   is smallest.
# * **Ball.** A number with a radius that holds every rounding error. Where the balls of two sides have no point
#   in common, the sides differ.
# * **Dual polynomial.** The witness that no estimate does better: a curve that stays in a band and touches it
#   just at the instants at which the best estimate measures.
#
# Other words are in the glossary of the documentation.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

from navsym.claims import Equation, Optimum
from navsym.cli.main import run as navsym
from navsym.prove.ladder import decide
from navsym.report.notebook import explore, require, show
from navsym_papers.guaranteed_velocity import model, polynomial, system, weights

# %% [markdown]
# ## The model
# Velocity error, tilt and drift of one channel, in Schuler units; the velocity is measured.

# %%
model.CHANNEL

# %% [markdown]
# The measurement at time τ, referred to the state at the end T, derived from the model:

# %%
model.H()

# %% [markdown]
# ## A printed line that is wrong
# Equation (1.9) prints the second component with a minus.

# %%
show(system.second_component)

# %%
show(system.second_component_corrected)

# %% [markdown]
# The counterexample is an exact point at which a ball excludes equality: anyone can check it by hand.
# Where does the minus come from? Reversing the time in (1.8) gives exactly the printed line:

# %%
show(system.reversed_argument)

# %% [markdown]
# ## A printed line that is right
# The guaranteed error of the drift estimate. It is proved optimal by a pair, an estimate and a dual polynomial
# with the same value: one shows what can be reached, the other that nothing better can. No solver is believed;
# the four conditions of such a pair (no bias, instants inside the interval, polynomial in its band, equal
# values) are checked by algebra for every T of the range at once.

# %%
drift = weights.OPTIMAL_ERRORS[2]
show(drift)

# %%
for claim in (system.second_component, system.second_component_corrected, drift):
    require(claim)

# %% [markdown]
# ## Now change something
# Is the printed error still the optimum when the interval is longer than the paper says, T = 3π/4?
# Put the statement together and ask.

# %%
printed = drift.derive()
longer = Optimum(
    printed.regressors,
    printed.functional,
    printed.variable,
    printed.interval,
    printed.dual,
    printed.support,
    printed.weights,
    printed.value,
    box={model.T: (0, 3 * sp.pi / 4)},
)
verdict = decide(longer)
assert verdict.status == "REFUTED"
verdict

# %% [markdown]
# The formulas end where a weight changes its sign: at 2π/3 for the drift.

# %%
T = np.linspace(0.3, 2 * np.pi, 400)
first = np.cos(T / 2) / np.sin(T / 4) ** 2
with np.errstate(divide="ignore"):
    second = -1 / np.cos(T)
error = np.where(2 * np.pi / 3 >= T, first, np.where(np.pi >= T, second, 1.0))
figure, axis = plt.subplots(figsize=(7, 3.5))
axis.plot(T, error, color="#0072b2", label="guaranteed error of $y_3$")
axis.axvspan(0, np.pi / 2, color="#e69f00", alpha=0.15, label="range that the paper states")
for bound in (2 * np.pi / 3, np.pi):
    axis.axvline(bound, color="0.6", lw=0.8)
axis.set(xlabel="T, Schuler units", ylabel=r"$d_{opt}(y_3)\,/\,\sigma$", ylim=(0, 12), xlim=(0, 2 * np.pi))
axis.legend()
plt.close(figure)
figure

# %% [markdown]
# ## Your own formula
# Any formula of the language goes through the same door.

# %%
a = sp.Symbol("a", real=True)
right = decide(Equation(sp.sin(3 * a), 3 * sp.sin(a) - 4 * sp.sin(a) ** 3))
wrong = decide(Equation(sp.sin(3 * a), 3 * sp.sin(a) - 4 * sp.cos(a) ** 3))
assert (right.status, wrong.status) == ("PROVED", "REFUTED")
right, wrong

# %% [markdown]
# The polynomial behind the proof touches its bounds at the start, in the middle and at the end:

# %%
at = np.linspace(0, np.pi / 2, 200)
S = sp.lambdify(model.tau, polynomial.polynomial(*polynomial.coefficients()).subs(model.T, sp.pi / 2), "numpy")
L = float(polynomial.deviation().subs(model.T, sp.pi / 2))
figure, axis = plt.subplots(figsize=(7, 3))
axis.plot(at, S(at) / L, color="#0072b2")
axis.axhline(1, color="0.6", lw=0.8)
axis.axhline(-1, color="0.6", lw=0.8)
axis.plot([0, np.pi / 4, np.pi / 2], [-1, 1, -1], "o", color="#d55e00")
axis.set(xlabel=r"$\tau$, Schuler units", ylabel=r"$S_0(\tau)\,/\,L_1$", title="T = π/2")
plt.close(figure)
assert np.abs(S(at)).max() <= L * (1 + 1e-12)
figure

# %% [markdown]
# Move T. Up to 2π/3 the polynomial stays in its band and touches it three times; beyond, the formulas go
# on to be numbers but are no longer an estimator: the middle of the band is left.

# %%
general = sp.lambdify((model.tau, model.T), polynomial.polynomial(*polynomial.coefficients()), "numpy")
bound_of = sp.lambdify(model.T, polynomial.deviation(), "numpy")


def polynomial_for(T):
    at = np.linspace(0, T, 200)
    figure, axis = plt.subplots(figsize=(7, 3))
    axis.axhspan(-1, 1, color="0.93")
    axis.plot(at, general(at, T) / bound_of(T), color="#0072b2")
    axis.plot([0, T / 2, T], [-1, 1, -1], "o", color="#d55e00")
    axis.set(xlabel=r"$\tau$, Schuler units", ylabel=r"$S_0(\tau)\,/\,L_1$", title=f"T = {T:.2f}")
    plt.close(figure)
    return figure


explore(polynomial_for, T=(0.3, 2.9, 1.5))

# %% [markdown]
# ## Out of the house
# What is proved leaves as code, with test vectors, an error bound and a certificate that `navsym check` replays.

# %%
with tempfile.TemporaryDirectory() as folder:
    words = ["export", "guaranteed_velocity:4.13.y3", "--to", "python", "--out", folder, "--vectors", "8"]
    assert navsym(words) == 0
    source = (Path(folder) / "python" / "navsym_functions.py").read_text(encoding="utf-8")
print(source)
