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
import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import navsym as nav
from navsym_papers.guaranteed_velocity import model, polynomial

BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"


def explain(number):
    """The claim of the paper with this number, decided now; its verdict is the declared one."""
    explanation = nav.explain(f"guaranteed_velocity:{number}")
    assert explanation.record.is_expected
    return explanation


# %% [markdown]
# ## The problem, and H(τ)
# The states at the end of the interval are estimated from $z(\tau) = H^*(\tau) q + w(\tau)$.

# %%
channel = nav.Model(
    name="velocity channel",
    states="y1 y2 y3",
    F=[[0, -1, 0], [0, 0, 1], [0, -1, 0]],
    H=["y1"],
    measurements="velocity",
    interval="T",
    T=(0, "2*pi"),
)
nav.derive(channel)

# %%
explain("1.7")

# %%
explain("1.9.H2")

# %% [markdown]
# ## The worst correlation
# The variance of $\int \Phi z$ is largest when the noise has the sign pattern of $\Phi$, and then its root
# is $\sigma \int |\Phi|$. This is the quantity to be minimised.

# %%
explain("2.D.reached")

# %% [markdown]
# The right-hand side of (3.6) has lost its σ:

# %%
explain("3.6")

# %% [markdown]
# ## The generalised Chebyshev polynomial
# With the printed sign of $u_2$ the polynomial leaves its band; with the minus it touches three times.

# %%
explain("4.3.u2")

# %%
length = sp.pi / 2
u2, u3 = (u.subs(model.T, length) for u in polynomial.coefficients())
at = np.linspace(0, float(length), 301)
good, bad = (
    sp.lambdify(model.tau, polynomial.polynomial(sign * u2, u3).subs(model.T, length), "numpy")(at) for sign in (1, -1)
)
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
explain("4.4*")

# %% [markdown]
# ## Weights and estimates
# The weights of (4.12) are right; the estimate (4.14) of $y_2$ has a square too many and is biased.

# %%
explain("4.14.y2")

# %%
explain("4.14.y2.bias")

# %% [markdown]
# ## The certified optimum against the linear programme
# The same problem on a grid of 201 times, by five solvers. The optimum is certified to thirty digits, so
# that it shows where each solver stops being trustworthy. For short intervals the three regressors are
# nearly dependent.

# %%
lengths = ["3/2", "1/2", "1/10", "1/50", "1/250"]
compared = {T: nav.solve(channel, "y3", T=T).compare() for T in lengths}
errors, statuses = {}, {}
for T, comparison in compared.items():
    for row in comparison.solvers:
        off = np.nan if row.value is None else max(abs(row.relative_error), 1e-17)
        errors.setdefault(row.solver, []).append(off)
        statuses[row.solver, T] = (row.status, off)

# %%
figure, axis = plt.subplots(figsize=(7, 3.5))
for (solver, values), marker in zip(errors.items(), "os^vD", strict=True):
    axis.loglog([float(sp.Rational(T)) for T in lengths], values, marker=marker, label=solver)
axis.set(xlabel="T, Schuler units", ylabel="relative error of the value", ylim=(1e-17, 10))
axis.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5))
plt.close(figure)
figure

# %% [markdown]
# Each solver's own status, beside its true error:

# %%
for (solver, T), (status, off) in sorted(statuses.items()):
    print(f"{solver:<16} T = {T:<6} says {status[:28]:<28} relative error {off:.1e}")
assert statuses["casadi:highs", "3/2"][1] < 1e-9
assert statuses["cvxpy:HIGHS", "1/2"][1] < 1e-9

# %% [markdown]
# ## Least squares under its own worst correlation

# %%
spans = ["3/10", "1/2", "4/5", "11/10", "3/2"]
least, best = [], []
for T in spans:
    estimator = nav.solve(channel, "y3", T=T, digits=12)
    least.append(estimator.compare(solvers=[]).least_squares)
    best.append(float(estimator.value))
figure, axis = plt.subplots(figsize=(7, 3.5))
at = [float(sp.Rational(T)) for T in spans]
axis.semilogy(at, least, "s-", color=ORANGE, label="least squares, worst correlation")
axis.semilogy(at, best, "o-", color=BLUE, label="three times (optimal)")
axis.set(xlabel="T, Schuler units", ylabel=r"guaranteed error of $y_3$, $\sigma$")
axis.legend()
plt.close(figure)
assert all(a > b for a, b in zip(least, best, strict=True))
figure

# %%
explain("3.more-measurements")

# %% [markdown]
# ## How far the formulas really hold
# The paper states T ≤ π/2. Each formula holds until one of its weights changes sign. The formula that replaces it
# is as short: two times. The notebook on regimes has the complete answer.

# %%
for number in ("range.y2", "range.y3", "range.y2.end*"):
    print(explain(number).record.scope)
explain("range.y3.end*")

# %% [markdown]
# How long must one measure? Move T: the guaranteed errors of tilt and drift, in units of the noise.


# %%
def errors_for(T):
    errors = [float(nav.solve(channel, state, T=f"{T:.2f}", digits=8).value) for state in channel.states]
    figure, axis = plt.subplots(figsize=(7, 2))
    axis.barh(["velocity $y_1$", "tilt $y_2$", "drift $y_3$"], errors, color=[GREEN, BLUE, RED])
    minutes = T * np.sqrt(6.371e6 / 9.81) / 60
    axis.set(xlabel=r"guaranteed error, $\sigma$", title=f"T = {T:.2f}, that is {minutes:.0f} minutes")
    plt.close(figure)
    assert min(errors) >= 1 - 1e-9
    return figure


nav.explore(errors_for, T=(0.5, 6.2, 1.5))

# %% [markdown]
# ## Every refuted line, with its reason

# %%
refuted = nav.claims("guaranteed_velocity", status="REFUTED", slip="any")
for claim in refuted:
    print(f"{claim.number:<24} {claim.record.slip}: {claim.record.reason}")

# %%
nav.claims("guaranteed_velocity", words=":4.1")

# %% [markdown]
# ## Code
# The corrected estimate of the tilt leaves as code. The printed one is refused.

# %%
nav.export("guaranteed_velocity:4.14.y2*", to=["python"], out="build/tilt_estimate", vectors=8, force=True)
try:
    nav.export("guaranteed_velocity:4.14.y2", to=["python"], out="build/tilt_printed")
except nav.NavsymError as error:
    refusal = error
assert refusal.kind == "refused"
print(refusal)
