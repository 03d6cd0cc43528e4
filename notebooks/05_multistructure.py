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
# # Signals whose model switches
#
# **Question.** The errors of a navigation system follow one of several models, and nobody says which or when it
# changes. The exact estimate needs one Kalman filter for every sequence of models. What may be thrown away?
#
# D. Obidin, D. Makarchuk, O. Kostenko, N. Mishukova, 2018.

# %%
import matplotlib.pyplot as plt
import numpy as np
from ipywidgets import FloatSlider, IntSlider, interact

import navsym as nav
from navsym_papers.multistructure import interval
from navsym_papers.multistructure.experiment import road, study
from navsym_papers.multistructure.experiment.modes import MODES, SchulerChannel

BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"


def explain(number):
    """The claim of the paper with this number, decided now; its verdict is the declared one."""
    explanation = nav.explain(f"multistructure:{number}")
    assert explanation.record.is_expected
    return explanation


# %% [markdown]
# ## The exact recursion
# State and mode together are Markov, so Bayes' rule gives a recursion (7)-(11). Every one of its formulas is
# total probability and Bayes' rule; they are decided with free symbols for all probabilities.

# %%
explain("8")

# %%
explain("10")

# %% [markdown]
# The printed (9) takes the density of the wrong mode:

# %%
explain("9")

# %%
explain("9*")

# %% [markdown]
# ## Why it cannot be kept up

# %%
series = study.simulate(study.schuler_bank(), 1, 7, seed=2).measurements[0]
print("Kalman filters up to step k = 1, 2, ... with three modes")
for method, K in (("exact", None), ("k-pulsating", 3), ("gpb2", None), ("imm", None), ("pulsating", None)):
    counts = [nav.filter(study.schuler_bank(), series[:k], method, depth=K).filters_run for k in range(1, 8)]
    print(f"  {method:12s} {K or '':>2}", counts)

# %%
explain("count.sequences")

# %% [markdown]
# ## One step, four ways to fold
# Two modes after a surprising measurement. The exact density at step 2 has four summands; the pulsating filter
# folded at step 1 and has two; GPB2 folds four into two afterwards; IMM folds two into each before it predicts.


# %%
def two_modes(stay):
    models = [{"F": [[1]], "Q": [[q]], "H": [[1]], "R": [[1]]} for q in (0, 25)]
    initial = {"mean": [0], "covariance": [[1]], "probabilities": [0.5, 0.5]}
    return nav.Bank(models, [[stay, 1 - stay], [1 - stay, stay]], initial)


def draw_folds(stay=0.9, first=3.0, second=1.0, depth=2):
    series = [[first], [second], [0.0]]
    x = np.linspace(-4, 8, 400)
    figure, axes = plt.subplots(1, 3, figsize=(11, 3), sharey=True)
    for method, colour, K in (
        ("exact", "black", None),
        ("pulsating", RED, None),
        ("k-pulsating", ORANGE, depth),
        ("gpb2", GREEN, None),
        ("imm", BLUE, None),
    ):
        found = nav.filter(two_modes(stay), series, method, depth=K)
        for k, axis in enumerate(axes):
            mean, variance = found.mean[k, 0], found.covariance[k, 0, 0]
            name = method if K is None else f"{method} {K}"
            axis.plot(
                x,
                np.exp(-0.5 * (x - mean) ** 2 / variance) / np.sqrt(2 * np.pi * variance),
                color=colour,
                label=f"{name}: {found.probabilities[k, 1]:.3f}",
            )
            axis.set_title(f"step {k + 1}: moments, P[jump]")
            axis.legend(fontsize=7)
    plt.show()


interact(
    draw_folds,
    stay=FloatSlider(value=0.9, min=0.5, max=0.99, step=0.01),
    first=FloatSlider(value=3.0, min=-6.0, max=6.0, step=0.5),
    second=FloatSlider(value=1.0, min=-6.0, max=6.0, step=0.5),
    depth=IntSlider(value=2, min=1, max=3),
)

# %% [markdown]
# At step 1 all are exact (no fold has come yet), and the paper's filter is suboptimal from step 2 on:

# %%
explain("17.first")

# %%
explain("17.suboptimal")

# %% [markdown]
# ## Folding: mean and covariance
# (13) is right once its sum runs over i; its middle line is not: the spread of the partial estimates would count twice.

# %%
explain("13.every")

# %%
explain("13.middle")

# %% [markdown]
# Partial estimates need not be stored, as promised, but the adders must be: a mean and a covariance.

# %%
explain("17.memory")

# %%
explain("17.memory*")

# %% [markdown]
# ## Memoryless modes
# (14)-(17) replace the chain by its unconditional probabilities. That does not follow from the Gaussian
# approximation: the mode before is still known through its posterior.

# %%
explain("14.follows")

# %%
explain("14.follows*")

# %%
series = study.simulate(study.schuler_bank(), 200, 30, seed=2)
loss = {}
for forget in (False, True):
    true = [
        np.log(nav.filter(study.schuler_bank(), z, memoryless=forget).probabilities[np.arange(30), m]).mean()
        for z, m in zip(series.measurements[:60], series.modes[:60], strict=True)
    ]
    loss["memoryless" if forget else "Markov"] = -float(np.mean(true))
print({name: round(value, 3) for name, value in loss.items()}, "nats per step, lower is better")

# %% [markdown]
# ## The likelihood (18), and what is Gaussian
# A part is Gaussian, the sum is not.

# %%
explain("18")

# %%
explain("15.gaussian")

# %%
explain("15.gaussian*")

# %% [markdown]
# ## How to choose K
# The paper asks for statistical modelling. The Schuler channel with a drift that jumps and a velocity that degrades;
# quality against cost, with 95 % intervals. Excess is the squared distance from the exact estimate in units of its
# variance.

# %%
document = study.study(runs=250, seed=1, steps=7)
exact = document["methods"][0]
plt.figure(figsize=(6, 4))
for row in document["methods"][1:-1]:
    label = f"K = {row['depth']}" if row["depth"] else row["method"]
    colour = ORANGE if row["method"] in ("k-pulsating", "pulsating") else BLUE
    plt.errorbar(row["filters_per_step"], row["excess"]["mean"], row["excess"]["half_width"], fmt="o", color=colour)
    plt.annotate(label, (row["filters_per_step"], row["excess"]["mean"]), xytext=(5, 5), textcoords="offset points")
plt.xlabel("Kalman filters per step")
plt.ylabel("excess over the exact estimate")
plt.xscale("log")
plt.xlim(2.5, 32)
plt.xticks((3, 5, 10, 20, 30), ("3", "5", "10", "20", "30"))
plt.minorticks_off()
plt.title(f"modes: {', '.join(MODES)}")
plt.show()
by_name = {(row["method"], row["depth"]): row for row in document["methods"]}
assert by_name["k-pulsating", 4]["excess"]["mean"] < by_name["pulsating", None]["excess"]["mean"]
assert exact["log_likelihood"]["mean"] >= by_name["pulsating", None]["log_likelihood"]["mean"]

# %% [markdown]
# Up to step K nothing is lost. In the model of the claims below K = 2 beats K = 1 summed over steps 1 to 4, but not at
# every step. There the state keeps or turns its sign and is measured once, so that averages over
# all measurements are certified integrals over one number. And K = 3 can miss what K = 2 finds, because it folds where
# the modes have just parted.

# %%
explain("K.exact")

# %%
explain("K.better*")

# %%
explain("K.better")

# %%
explain("K.fold")

# %%
explain("K.longer")

# %%
one, two = ([float(interval.mean_of(share).ball.mid()) for share in row] for row in interval.squared_distances())
figure, axis = plt.subplots(figsize=(5, 3))
steps = np.arange(1, len(one) + 1)
axis.bar(steps - 0.18, one, 0.36, color=ORANGE, label="K = 1")
axis.bar(steps + 0.18, two, 0.36, color=BLUE, label="K = 2")
axis.set(xlabel="step", ylabel="mean square distance from optimal", xticks=steps)
axis.legend()
plt.close(figure)
assert sum(two) < sum(one) and two[2] > one[2]
figure

# %% [markdown]
# ## Where IMM wins
# The Schuler channel again, with modes that last ever longer: log loss of the true mode, and NEES, with 95 % intervals.
# IMM runs as many Kalman filters as pulsating and, where modes last (0.8 and more), beats it and K = 2 with ease; GPB2
# remains a little better for three times as many filters. A consistent filter has a NEES of 3, the number of states.

# %%
stays = (0.5, 0.8, 0.95, 0.99)
study_of_stays = study.switching_study(stays, runs=150, steps=60)
figure, axes = plt.subplots(1, 2, figsize=(11, 3.6))
for axis, name in zip(axes, ("log_loss", "nees"), strict=True):
    for number, label in enumerate(("pulsating", "K = 2", "K = 3", "K = 4", "gpb2", "imm")):
        scores = [getattr(study_of_stays[stay][number], name) for stay in stays]
        axis.errorbar(
            np.arange(len(stays)) + 0.06 * number,
            [m.mean for m in scores],
            [m.half_width for m in scores],
            fmt="o",
            ms=4,
            label=label,
        )
    axis.set(
        xticks=np.arange(len(stays)) + 0.15,
        xticklabels=[f"{s:g}" for s in stays],
        yscale="log",
        xlabel="probability that a mode lasts another step",
    )
axes[0].set_ylabel("log loss, nats per step")
axes[1].set_ylabel("NEES")
axes[1].axhline(3, color="0.6", lw=0.8)
axes[1].text(-0.1, 3.2, "3: consistent", fontsize=8)
axes[0].legend(fontsize=7)
plt.close(figure)
rare = {score.method: score for score in study_of_stays[0.99] if score.depth is None}
assert rare["imm"].log_loss.mean < rare["pulsating"].log_loss.mean
assert rare["imm"].filters_per_step < rare["gpb2"].filters_per_step
for stay, scores in study_of_stays.items():
    print(f"{stay:<5}", "  ".join(f"{x.method} {x.depth or ''}: {x.log_loss.mean:.3f}" for x in scores))
figure

# %% [markdown]
# Move K and the probability of switching: the distance from the exact estimate over seven steps.


# %%
def depth_and_switching(K=2, switch=0.1, runs=40):
    """Excess of K-pulsating and of IMM over the exact estimate, in units of its variance."""
    base, stay = study.schuler_bank(), np.full((3, 3), switch / 2)
    np.fill_diagonal(stay, 1.0 - switch)
    chosen = nav.Bank(
        SchulerChannel().models(),
        stay,
        {"mean": base.means[0], "covariance": base.covariances[0], "probabilities": np.full(3, 1 / 3)},
    )
    scores = study.compare(chosen, [("k-pulsating", K), ("imm", None)], runs, 7, 1, exact=True)
    for score in scores[1:]:
        excess = score.excess
        print(f"{score.method:12s} K {score.depth or '':>2} excess {excess.mean:.3f} +- {excess.half_width:.3f}")


interact(
    depth_and_switching,
    K=IntSlider(value=2, min=1, max=5),
    switch=FloatSlider(value=0.1, min=0.0, max=0.6, step=0.05),
    runs=IntSlider(value=40, min=20, max=200, step=20),
)

# %% [markdown]
# Nor is a confident mode enough for the Gaussian approximation; the others must also stay near it, and not be wide.

# %%
explain("near")

# %%
explain("near*")

# %% [markdown]
# ## How long a mistake about the modes lasts
# A fold, a truncated tree or a wrong covariance reaches the modes through the likelihoods. If each of them is known
# within a factor exp(±c), one step errs by tanh(c/2) at most; and (10) with ρ^i forgets, for two modes: whatever is
# measured, an error of the log-odds is multiplied by at most κ, so that it never exceeds 2c/(1 - κ). Drawn: κ = 0.8,
# c = 0.1, mistakes at random and at their worst.

# %%
for words in (":10.forgets", ":17.error"):
    for claim in nav.claims("multistructure", words=words):
        print(f"{claim.number:24s} {claim.status:9s} {claim.title}")

# %%
explain("10.forgets")

# %%
generator, c, stay = np.random.default_rng(3), 0.1, 0.9
limit = 2 * c / (1 - (2 * stay - 1))
figure, axis = plt.subplots(figsize=(7, 3))
for name, colour in (("at random", BLUE), ("at their worst", RED)):
    odds = wrong = 1.0
    gap = []
    for _ in range(40):
        ratio = np.exp(generator.normal(0.0, 1.0 if name == "at random" else 0.0))
        mistake = generator.uniform(-2 * c, 2 * c) if name == "at random" else 2 * c
        odds, wrong = (
            r * (stay * x + 1 - stay) / ((1 - stay) * x + stay)
            for r, x in ((ratio, odds), (ratio * np.exp(mistake), wrong))
        )
        gap.append(abs(np.log(wrong / odds)))
    axis.plot(np.arange(1, 41), gap, color=colour, label=f"mistakes {name}")
    assert max(gap) <= limit
axis.axhline(limit, color="black", lw=0.8, label="2c/(1 - κ)")
axis.set(xlabel="step", ylabel="error of the log-odds", ylim=(0, 1.1 * limit))
axis.legend()
plt.close(figure)
figure

# %% [markdown]
# ## Modes that never switch
# The polygaussian filter is exact then, and stays a bank of I filters.

# %%
explain("21.optimal")

# %% [markdown]
# ## A real road
# A car in a city: satellite positions that are fixed or float, and a fix that is wrong now and then. Velocities
# of the reference system are integrated; the filter sees no flags.

# %%
files = [nav.data()[name] for name in ("nagoya-reference", "nagoya-rtk")]
if all(files):
    run_of_nagoya = road.read_road(files[0].parent)
    for method in ("pulsating", "imm", "gpb2"):
        judged = road.judge(run_of_nagoya, method)
        print(
            f"{method:10s} horizontal rms {judged.rms_raw:.1f} m -> {judged.rms:.2f} m; wrong fixes noticed "
            f"{judged.caught} of {judged.wrong_fixes}; good fixes kept {judged.kept} of {judged.good_fixes}; "
            f"NEES {judged.nees:.0f} (2 if the noise were white, which it is not)"
        )
        print(judged.confusion)
    judged = road.judge(run_of_nagoya, "imm")
    figure, axis = plt.subplots(figsize=(10, 2.6))
    seconds = 0.2 * np.arange(len(run_of_nagoya.flag))
    flag, guess = run_of_nagoya.flag, judged.estimate.probabilities.argmax(axis=1)
    axis.plot(seconds, np.where(flag < 0, np.nan, flag), color="0.6", label="receiver's flag")
    axis.plot(seconds, guess + 0.08, color=RED, lw=0.8, label="most probable mode")
    axis.set(yticks=(0, 1, 2), yticklabels=road.QUALITY, xlabel="t, s")
    axis.legend(fontsize=7)
    plt.show()
    assert judged.caught > 0 and judged.rms < judged.rms_raw
else:
    print("The recorded run is not here: navsym data get nagoya-reference, and nagoya-rtk, or set NAVSYM_DATA.")

# %% [markdown]
# ## All claims

# %%
refuted = nav.claims("multistructure", status="REFUTED")
print(len(nav.claims("multistructure")), "claims,", len(refuted), "refuted and corrected")
for claim in refuted:
    print(f"  {claim.number:16s} {claim.record.slip}: {claim.record.reason}")

# %% [markdown]
# ## Code
# The likelihood of an innovation, equation (18), leaves as code.

# %%
nav.export("multistructure:18", to=["python"], out="build/likelihood", vectors=8, force=True)
