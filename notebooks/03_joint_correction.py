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
# # Joint velocity and position correction
#
# **Question.** Velocity information comes for hours, position information for half an hour. Which errors
# of an inertial system does each of them show, how is the estimation split between them, and does the
# algorithm of 1979 do what it promises?
#
# V. I. Kalenova, V. M. Morozov, N. A. Parusnikov, A. G. Shakot'ko, 1979.

# %%
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
from ipywidgets import FloatSlider, interact

import navsym as nav
from navsym_papers.joint_correction import section3_gains as analysis
from navsym_papers.joint_correction import sensors
from navsym_papers.joint_correction.experiment import ins as experiment
from navsym_papers.joint_correction.experiment import real as aiding
from navsym_papers.joint_correction.experiment.flight import EARTH_RADIUS, SCHULER_RATE, great_circle
from navsym_papers.joint_correction.inertial import full_model, joint_model, position_group, velocity_group

BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"


def explain(number):
    """The claim of the paper with this number, decided now; its verdict is the declared one."""
    explanation = nav.explain(f"joint_correction:{number}")
    assert explanation.record.is_expected
    return explanation


# %% [markdown]
# ## Three frames
# The ideal frame Mx on the vertical, the platform Mz, and Mu in which the computer believes; α turns
# Mx into Mz, β turns Mu into Mz, γ = α − β turns Mx into Mu. Angles are drawn far too large.

# %%
figure, axis = plt.subplots(figsize=(5, 4.2))
for angle, name, colour in ((0.0, "Mx", BLUE), (0.35, "Mz", RED), (0.15, "Mu", GREEN)):
    for turn in (0.0, np.pi / 2):
        end = np.array([np.cos(angle + turn), np.sin(angle + turn)])
        axis.annotate("", end, (0, 0), arrowprops={"arrowstyle": "->", "color": colour, "lw": 2})
    axis.text(*(1.08 * np.array([np.cos(angle), np.sin(angle)])), name, color=colour)
for radius, start, end, name in ((0.6, 0.0, 0.35, "α"), (0.75, 0.15, 0.35, "β"), (0.9, 0.0, 0.15, "γ")):
    arc = np.linspace(start, end, 30)
    axis.plot(radius * np.cos(arc), radius * np.sin(arc), color="black", lw=1)
    axis.text((radius + 0.03) * np.cos(arc[15]), (radius + 0.03) * np.sin(arc[15]), name)
axis.set(xlim=(-0.5, 1.3), ylim=(-0.1, 1.2), aspect="equal", xticks=[], yticks=[])
plt.show()

# %% [markdown]
# ## Error equations from kinematics
# Poisson's equation is linearised and Newton's equation solved for the rates; nothing is copied. One index
# of (2.2) is misprinted:

# %%
explain("2.2.beta3")

# %%
explain("2.2.beta3*")

# %% [markdown]
# What (2.8) and (2.9) keep and what they drop, with the order of every term relative to ρ:

# %%
for group in (velocity_group(), position_group()):
    for variable, rate, dropped in zip(group.variables, group.rates, group.dropped, strict=True):
        left_out = "; ".join(f"{d.term} (μ^{d.order})" for d in dropped) or "nothing"
        print(f"d {variable}/dτ = {rate}    [left out: {left_out}]")

# %%
for number in ("2.8.x6*", "2.9.y2", "2.9.y2*"):
    print(explain(number).record.title)
explain("2.8.x6")

# %% [markdown]
# ## The observability ladder

# %%
joint = nav.observe(joint_model())
steps = np.cumsum((0, *joint.joint.staircase))
figure, axis = plt.subplots(figsize=(7, 3))
for k, (low, high) in enumerate(pairwise(steps)):
    axis.bar(k, high - low, bottom=low, color=(BLUE, BLUE, ORANGE, ORANGE)[k])
    axis.text(
        k,
        (low + high) / 2 if high > low else high - 0.6,
        f"+{high - low}",
        ha="center",
        va="center",
        color="white" if high > low else "black",
    )
names = ["velocity 1", "velocity 2", "position 1", "position 2"]
axis.set(xticks=range(4), xticklabels=names, ylabel="observed dimensions", ylim=(0, 11))
axis.axhline(10, color="black", lw=0.5)
axis.text(-0.4, 10.15, "all ten variables", fontsize=8)
plt.show()
assert joint.observable

# %% [markdown]
# All feasible splits of the position group; the one with the least max(i, j) estimates four derivatives
# of each measurement instead of six.

# %%
for split in nav.observe(position_group().model(("position_1", "position_2"))).splits:
    print(split.i, split.j, "det L =", split.determinant)

# %% [markdown]
# ## Where it breaks
# The velocity group is observable except where μu₃ = ±1: the Earth would have to turn about the vertical with the
# Schuler frequency. The smallest singular value of the six chain vectors shows the loss.

# %%
for drop in nav.observe(velocity_group().model(("velocity_1", "velocity_2"))).rank_drops:
    print(drop.subspace, drop.condition, "complete list" if drop.complete else "")
kappa = np.linspace(-1.5, 1.5, 301)
least = [np.linalg.svd(experiment.chain_matrix(value), compute_uv=False)[-1] for value in kappa]
figure, axis = plt.subplots(figsize=(7, 2.8))
axis.plot(kappa, least, color=BLUE)
axis.axvspan(-0.06, 0.06, color=GREEN, alpha=0.3, label="on the Earth")
axis.set(xlabel="μu₃", ylabel="least singular value")
axis.legend()
plt.show()

# %% [markdown]
# ## Gains, and the true decay
# The gains for (p + λ)³ neglect the link μu₃ between the channels. With the link the triple pole is torn
# apart by the cube root of μu₃: stable exactly for |μu₃| < 1, but slower than wished.

# %%
for number in ("3.2.gains", "3.coupled.stable", "3.coupled.decay", "3.coupled.repaired"):
    print(f"{number:20s} {explain(number).record.title}")
explain("3.coupled.characteristic")


# %%
def draw_poles(decay=1.0, link=0.05):
    """Poles of the six velocity errors for the gains of the paper, and the wished one."""
    matrix = analysis.coupled_velocity_block().subs({analysis.lam: decay, analysis.kappa: link})
    poles = np.linalg.eigvals(np.array(matrix, dtype=float))
    plt.figure(figsize=(4.5, 3.5))
    plt.plot(poles.real, poles.imag, "x", color=RED, label="with the link")
    plt.plot(-decay, 0, "o", mfc="none", color=BLUE, label="wished, six times")
    plt.axvline(0, color="black", lw=0.5)
    plt.legend()
    plt.title(f"decay rate {-poles.real.max():.3f} instead of {decay:.2f}")
    plt.show()


interact(
    draw_poles,
    decay=FloatSlider(value=1.0, min=0.3, max=4.0, step=0.1),
    link=FloatSlider(value=0.05, min=0.0, max=1.2, step=0.01),
)

# %% [markdown]
# ## What the poles cost
# The paper leaves λ_c and λ_h to the engineer. Noise alone wants them small, what the model leaves out wants them
# large: the steady variances have closed forms, and with a constant drive d of y₂ the best λ_h is (16 d²/5)^(1/5).

# %%
for words in (":3.noise", ":3.choice"):
    for claim in nav.claims("joint_correction", words=words):
        print(f"{claim.number:20s} {claim.status:9s} {claim.title}")
explain("3.choice.lambda_h")

# %%
drive, decays = 2.0, np.linspace(0.4, 4.0, 200)
squares = 5 * decays / 4 + drive**2 / decays**4
best = (16 * drive**2 / 5) ** 0.2
figure, axis = plt.subplots(figsize=(7, 3))
axis.plot(decays, np.sqrt(squares), color=BLUE, label="noise and drive d = 2")
axis.plot(decays, np.sqrt(5 * decays / 4), ":", color="0.5", label="noise alone")
axis.plot(best, np.sqrt(25 * best / 16), "o", color=RED, label=f"best λ_h = {best:.3f}")
axis.set(xlabel="λ_h", ylabel="RMS error of y₁, roots of noise", ylim=(0, 6))
axis.legend()
plt.close(figure)
assert squares.min() >= 25 * best / 16 - 1e-12
figure

# %% [markdown]
# ## The experiment
# 250 m/s on a great circle from 45° north, gyroscopes of 0.01°/h; truth is the full model. Ninety minutes of
# velocity, then half an hour of both; y starts at the first measured position. Exact covariance and drawn runs agree.

# %%
STEP = 10.0
flight = great_circle(duration=7200.0, step=STEP)
errors = experiment.Errors()
V, B, P, N = (experiment.Situation[name] for name in ("VELOCITY", "BOTH", "POSITION", "NEITHER"))
print(f"μ = {flight.mu:.3f}, λ_c = 2, λ_h = 3 and 5; position error in metres")
for decay in (3.0, 5.0):
    comparison = experiment.compare(flight, errors, lambda_h=decay)
    print(f"λ_h = {decay}: minutes after t₁", comparison.minutes)
    for name, row in comparison.rows.items():
        print(f"  {name:32s}", "  ".join(f"{value:7.1f}" for value in row))
        assert name == "Kalman filter, full model" or row[-1] > comparison.rows["Kalman filter, full model"][-1]

# %%
cases = {"pre-estimated": [(V, 90), (B, 30)], "not pre-estimated": [(N, 90), (B, 30)]}
figure, axis = plt.subplots(figsize=(7, 3))
for (name, phases), colour in zip(cases.items(), (BLUE, ORANGE), strict=True):
    chosen = experiment.plan(phases, STEP, lambda_h=5.0)
    steps = experiment.steps_of(flight, chosen, errors)
    exact = experiment.position_error(experiment.standard_deviations(steps, errors))
    drawn = experiment.position_error(experiment.monte_carlo(steps, errors, 500, seed=1))
    minutes = np.arange(len(exact)) * STEP / 60 - 90
    axis.plot(minutes, exact, color=colour, label=name)
    axis.plot(minutes[::6], drawn[::6], ".", color=colour, ms=3)
axis.set(xlim=(0.2, 30), ylim=(0, 80), xlabel="minutes of joint information", ylabel="position error, m")
axis.legend()
plt.show()

# %% [markdown]
# All situations of the last paragraph, one after the other: velocity, both, velocity, neither, position.

# %%
phases = [(V, 40), (B, 25), (V, 15), (N, 10), (P, 25)]
chosen = experiment.plan(phases, STEP, lambda_h=5.0)
curve = experiment.standard_deviations(experiment.steps_of(flight, chosen, errors), errors)
bound = experiment.kalman_deviations(flight, chosen, errors)
figure, axes = plt.subplots(2, 1, figsize=(8, 5), sharex=True)
minutes = np.arange(len(curve)) * STEP / 60
for axis, column, factor, label in (
    (axes[0], 6, EARTH_RADIUS, "y₁, m"),
    (axes[1], 1, EARTH_RADIUS * SCHULER_RATE, "x₂, m/s"),
):
    axis.semilogy(minutes, curve[:, column] * factor, color=BLUE, label="algorithm")
    axis.semilogy(minutes, bound[:, column] * factor, color=GREEN, label="Kalman filter")
    axis.set_ylabel(label)
    for end in np.cumsum([length for _, length in phases]):
        axis.axvline(end, color="black", lw=0.5)
for (situation, length), end in zip(phases, np.cumsum([length for _, length in phases]), strict=True):
    axes[0].text(
        end - length / 2, 1.02, situation.name.lower(), transform=axes[0].get_xaxis_transform(), ha="center", fontsize=8
    )
axes[0].legend()
axes[1].set_xlabel("minutes")
plt.show()

# %% [markdown]
# ## How few measurements are enough
# The paper joins both velocities with both coordinates. One coordinate less is enough, and nothing less. With the
# velocities alone four variables are unobservable, and either coordinate shows all four of them at once. With position
# alone it takes exactly $x_3$ and $x_6$. With all constant errors kept, five measurements are missing while
# the Earth's rotation is frozen in the frame. As it turns, at least 14 of the 16 combinations are observable.

# %%
nav.claims("joint_correction", words=":sensors.")

# %%
velocities = nav.observe(sensors.measured_by(("sigma_c1", "sigma_c2")), restore=True)
print("unobservable by the velocities:", *velocities.unobservable)
print("one measurement of these is enough:", *(name for (name,) in velocities.restoration.sets))
assert velocities.restoration.proved and velocities.restoration.needed == 1
velocities

# %% [markdown]
# ## A real flight
# A small aircraft with MEMS sensors: the reckoned velocity and position minus GPS. The general method finds
# the split with m = 2, n = 3; the judge is GPS itself, some seconds ahead.

# %%
record = nav.data()["thor-flight75"]
if record:
    from scipy.io import loadmat

    columns = loadmat(record)["flight_data"][0, 0]
    aided = aiding.reckon({name: columns[name].ravel() for name in aiding.FIELDS})
    two = tuple(aiding.two_stage_estimates(aided, axis, 0.3, 0.3) for axis in (0, 1))
    kalman = tuple(aiding.kalman_estimates(aided, axis) for axis in (0, 1))
    for horizon in (1, 5, 10, 20):
        ours, theirs = (np.sqrt((aiding.outage_errors(aided, e, horizon) ** 2).mean()) for e in (two, kalman))
        print(f"{horizon:2d} s ahead: two stages {ours:6.2f} m, Kalman filter {theirs:6.2f} m")
    figure, axis = plt.subplots(figsize=(7, 3))
    axis.plot(aided.t, two[0][:, 2], color=BLUE, lw=2.2, alpha=0.6, label="two stages")
    axis.plot(aided.t, kalman[0][:, 2], color="black", lw=0.7, label="Kalman filter")
    axis.set(xlabel="t, s", ylabel="northward force error, m/s²")
    axis.legend()
    plt.show()
else:
    print("The recorded flight is not here: navsym data get thor-flight75, or set NAVSYM_DATA.")

# %% [markdown]
# ## The whole paper

# %%
claims = nav.claims("joint_correction")
refuted = nav.claims("joint_correction", status="REFUTED")
print(len(claims), "claims,", len(refuted), "of them refuted:")
for claim in refuted:
    print(f"  {claim.number:28s} {claim.record.slip or '':6s} {claim.record.reason}")
assert full_model().size == 16

# %% [markdown]
# ## Code
# The corrected row of the estimator for y5 leaves as code.

# %%
nav.export("joint_correction:3.3.y5*", to=["python"], out="build/estimator_row", vectors=8, force=True)
