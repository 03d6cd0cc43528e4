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
# # Guaranteed velocity correction
#
# **Question.** The noise of a Doppler velocity sensor has a known variance and an unknown correlation.
# How well can velocity error, tilt and drift of an inertial channel be estimated *whatever the
# correlation is*, and which measurements does the best estimator use?
#
# S. R. Martirosyan, Reports of NAS RA 123 (2), 2023.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

from navsym.claims import claims_of
from navsym.cli.main import run as navsym
from navsym.core.casadi_functions import casadi_function, on_grid
from navsym.guaranteed.convex import LP_SOLVERS, GridProblem, guaranteed_lp, least_squares_qp
from navsym.report.notebook import explore, require, show, verdict_table
from navsym_papers import guaranteed_velocity as paper
from navsym_papers.guaranteed_velocity import beyond, duality, model, polynomial, system, weights

BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"

# %% [markdown]
# ## The problem, and H(τ)
# The states at the end of the interval are estimated from $z(\tau) = H^*(\tau) q + w(\tau)$.

# %%
show(system.measurement_at_the_end)

# %%
show(system.second_component)

# %% [markdown]
# ## The worst correlation
# The variance of $\int \Phi z$ is largest when the noise has the sign pattern of $\Phi$, and then its root
# is $\sigma \int |\Phi|$: what has to be minimised.

# %%
show(duality.worst_variance_is_reached)

# %% [markdown]
# The right-hand side of (3.6) has lost its σ:

# %%
show(duality.value_without_sigma)

# %% [markdown]
# ## The generalised Chebyshev polynomial
# With the printed sign of $u_2$ the polynomial leaves its band; with the minus it touches three times.

# %%
show(polynomial.constant_coefficient)

# %%
length = sp.pi / 2
u2, u3 = (u.subs(model.T, length) for u in polynomial.coefficients())
S = polynomial.polynomial(u2, u3).subs(model.T, length)
S_printed = polynomial.polynomial(-u2, u3).subs(model.T, length)
at = np.linspace(0, float(length), 301)
good, bad = (on_grid(casadi_function("S", [model.tau], side), at).ravel() for side in (S, S_printed))
L = float(polynomial.deviation().subs(model.T, length))
figure, axis = plt.subplots(figsize=(7, 3.5))
axis.plot(at, good, color=BLUE, label="$u_2 = -\\sin^2(T/4)/\\cos(T/2)$")
axis.plot(at, bad, "--", color=RED, label="$u_2$ as printed")
axis.axhline(L, color="0.6", lw=0.8)
axis.axhline(-L, color="0.6", lw=0.8)
axis.set(xlabel=r"$\tau$, Schuler units", ylabel=r"$S(\tau)$", title="T = π/2")
axis.legend()
plt.close(figure)
assert np.abs(good).max() <= L * (1 + 1e-12) < np.abs(bad).max()
figure

# %%
show(polynomial.corrected_polynomial_deviates_least)

# %% [markdown]
# ## Weights and estimates
# The weights of (4.12) are right; the estimate (4.14) of $y_2$ has a square too many and is biased.

# %%
show(weights.tilt_estimate)

# %%
show(weights.printed_tilt_estimate_is_biased)

# %% [markdown]
# ## Closed form against the linear programme
# The same problem on a grid that contains 0, T/2 and T, by five solvers. The exact optimum is known, so
# that it shows where each solver stops being trustworthy: for short intervals the three regressors are
# nearly dependent.


# %%
def grid_problem(T: float, count: int = 201) -> GridProblem:
    """The velocity problem for y3 on an even grid."""
    t = np.linspace(0.0, T, count)
    H = casadi_function("H", [model.tau, model.T], sp.Matrix(model.H()))
    columns = np.array([np.array(H(x, T)).ravel() for x in t]).T
    return GridProblem(columns, np.array([0.0, 0.0, 1.0]), spacing=np.full(count, T / (count - 1)))


def closed_form(T: float) -> float:
    """cos(T/2) / sin^2(T/4), the proved optimum for T <= 2 pi/3."""
    return float(weights.PRINTED_ERRORS[2].subs(model.T, sp.Float(T, 30)))


lengths = [1.5, 0.5, 0.1, 0.02, 0.004]
errors = {solver: [] for solver in LP_SOLVERS}
statuses = {}
for T in lengths:
    problem, expected = grid_problem(T), closed_form(T)
    for solver in LP_SOLVERS:
        result = guaranteed_lp(problem, solver=solver)
        off = np.nan if result.value is None else max(abs(result.value - expected) / expected, 1e-17)
        errors[solver].append(off)
        statuses[solver, T] = (result.status, result.claims, off)

# %%
figure, axis = plt.subplots(figsize=(7, 3.5))
for solver, marker in zip(LP_SOLVERS, "os^vD", strict=True):
    axis.loglog(lengths, errors[solver], marker=marker, label=solver)
axis.set(xlabel="T, Schuler units", ylabel="relative error of the value", ylim=(1e-17, 10))
axis.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5))
plt.close(figure)
figure

# %% [markdown]
# What each solver says of itself, beside what it is worth:

# %%
for (solver, T), (status, _, off) in sorted(statuses.items()):
    print(f"{solver:<16} T = {T:<6} says {status[:28]:<28} relative error {off:.1e}")
assert statuses["casadi:highs", 1.5][2] < 1e-9
assert statuses["cvxpy:HIGHS", 0.5][2] < 1e-9

# %% [markdown]
# ## Least squares under its own worst correlation

# %%
spans = np.linspace(0.3, np.pi / 2, 12)
least = [least_squares_qp(grid_problem(T), solver="cvxpy:CLARABEL").value for T in spans]
best = [closed_form(T) for T in spans]
figure, axis = plt.subplots(figsize=(7, 3.5))
axis.semilogy(spans, least, "s-", color=ORANGE, label="least squares, worst correlation")
axis.semilogy(spans, best, "o-", color=BLUE, label="three instants (optimal)")
axis.set(xlabel="T, Schuler units", ylabel=r"guaranteed error of $y_3$, $\sigma$")
axis.legend()
plt.close(figure)
assert all(a > b for a, b in zip(least, best, strict=True))
figure

# %%
show(duality.using_all_measurements_can_be_worse)

# %% [markdown]
# ## How far the formulas really hold
# The paper states T ≤ π/2. Each formula holds until one of its weights changes sign, and what replaces it
# is as short: two instants.

# %%
for claim in (
    beyond.tilt_holds_to_four_thirds_of_pi,
    beyond.drift_holds_to_two_thirds_of_pi,
    beyond.tilt_with_two_instants,
    beyond.drift_with_two_instants,
):
    require(claim)
show(beyond.drift_with_two_instants)

# %%
T = np.linspace(0.25, 2 * np.pi, 500)
with np.errstate(divide="ignore"):
    tilt = np.select([4 * np.pi / 3 >= T, 3 * np.pi / 2 >= T], [2 / np.tan(T / 4), -1 / np.sin(T)], 1.0)
    drift = np.select([2 * np.pi / 3 >= T, np.pi >= T], [np.cos(T / 2) / np.sin(T / 4) ** 2, -1 / np.cos(T)], 1.0)
figure, axis = plt.subplots(figsize=(7, 3.5))
axis.semilogy(T, np.ones_like(T), color=GREEN, label="$y_1$ velocity")
axis.semilogy(T, tilt, color=BLUE, label="$y_2$ tilt")
axis.semilogy(T, drift, color=RED, label="$y_3$ drift")
axis.axvspan(0, np.pi / 2, color=ORANGE, alpha=0.15, label="stated range")
axis.set(xlabel="T, Schuler units", ylabel=r"guaranteed error, $\sigma$", xlim=(0, 2 * np.pi))
axis.legend()
plt.close(figure)
figure

# %% [markdown]
# How long must one measure? Move T: the guaranteed errors of tilt and drift, in units of the noise.


# %%
def errors_for(T):
    tilt = 2 / np.tan(T / 4) if 4 * np.pi / 3 >= T else -1 / np.sin(T) if 3 * np.pi / 2 >= T else 1.0
    drift = np.cos(T / 2) / np.sin(T / 4) ** 2 if 2 * np.pi / 3 >= T else -1 / np.cos(T) if np.pi >= T else 1.0
    figure, axis = plt.subplots(figsize=(7, 2))
    axis.barh(["velocity $y_1$", "tilt $y_2$", "drift $y_3$"], [1.0, tilt, drift], color=[GREEN, BLUE, RED])
    minutes = T * np.sqrt(6.371e6 / 9.81) / 60
    axis.set(xlabel=r"guaranteed error, $\sigma$", title=f"T = {T:.2f}, that is {minutes:.0f} minutes")
    plt.close(figure)
    assert tilt >= 1 - 1e-9 and drift >= 1 - 1e-9
    return figure


explore(errors_for, T=(0.5, 6.2, 1.5))

# %% [markdown]
# ## Every refuted line, with its reason

# %%
refuted = [claim for claim in claims_of(paper) if claim.expect == "REFUTED" and claim.slip]
for claim in refuted:
    require(claim)
    print(f"{claim.number:<24} {claim.slip}: {claim.reason}")

# %%
print(verdict_table(list(claims_of(paper)), lambda claim: claim.number.startswith("4.1")))

# %% [markdown]
# ## Out of the house
# The corrected estimate of the tilt as code. The printed one is refused: what does not hold is not exported.

# %%
with tempfile.TemporaryDirectory() as folder:
    words = ["export", "guaranteed_velocity:4.14.y2*", "--to", "python", "--out", folder, "--vectors", "8"]
    assert navsym(words) == 0
    source = (Path(folder) / "python" / "navsym_functions.py").read_text(encoding="utf-8")
print(source)
