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
# A model is symbols, and a derivation reaches a formula by its own route. A claim holds the printed side
# beside the derived one. A verdict says how far the claim holds, and why.
#
# ## Five words first
#
# * **Channel.** An inertial system integrates accelerations. A small tilt of its platform mixes gravity into
#   them, so that the velocity goes wrong; the wrong velocity turns the platform back. The errors of velocity
#   and tilt therefore swing together like a pendulum of 84 minutes, pushed by the drift of a gyroscope. Those
#   three errors are one channel.
# * **Schuler unit.** Time divided by that period over 2π, about 13.4 minutes. A quarter of a
#   swing is $\pi/2$.
# * **Guaranteed error.** Average two measurements with noise of standard deviation σ. If their noises are
#   equal the mean is wrong by σ; if they are opposite, by nothing. Without the correlation one can
#   promise σ and no less. The guaranteed error is that promise, and the best estimate has the smallest one.
# * **Ball.** A number with a radius that holds every rounding error. Where the balls of two sides have no point
#   in common, the sides differ.
# * **Dual polynomial.** The witness that no estimate does better: a curve that stays in a band and touches it
#   just at the times at which the best estimate measures.
#
# Other words are in the glossary of the documentation.

# %%
import navsym as nav

# %% [markdown]
# ## The model
# Velocity error, tilt and drift of one channel, in Schuler units; the velocity is measured.

# %%
channel = nav.Model(
    name="velocity channel",
    states="velocity tilt drift",
    F=[[0, -1, 0], [0, 0, 1], [0, -1, 0]],
    H=["velocity"],
    measurements="Doppler",
    interval="T",
    T=(0, "2*pi"),
)
channel

# %% [markdown]
# The measurement at time τ, referred to the state at the end T, follows from the model:

# %%
nav.derive(channel)

# %% [markdown]
# ## A printed line that is wrong
# Equation (1.9) prints the second component with a minus.

# %%
printed = nav.explain("guaranteed_velocity:1.9.H2")
assert printed.record.status == nav.REFUTED
printed

# %%
corrected = nav.explain("guaranteed_velocity:1.9.H2*")
assert corrected.record.status == nav.PROVED
corrected

# %% [markdown]
# The counterexample is an exact point at which a ball excludes equality: anyone can check it by hand.
# Where does the minus come from? Reversing the time in (1.8) gives exactly the printed line:

# %%
nav.explain("guaranteed_velocity:1.9.root-cause")

# %% [markdown]
# ## A printed line that is right
# The guaranteed error of the drift estimate is proved optimal by a pair, an estimate and a dual polynomial
# with the same value. One shows what can be reached, the other that nothing better can. No solver is believed.
# The four conditions of such a pair are no bias, times inside the interval, a polynomial in its band, and equal
# values. Algebra checks them for every T of the range at once.

# %%
drift = nav.explain("guaranteed_velocity:4.13.y3")
assert drift.record.status == nav.PROVED
drift

# %% [markdown]
# ## Now change something
# Is the printed error still the optimum when the interval is longer than the paper says, T = 3π/4?

# %%
longer = nav.solve(channel, "drift", T="3*pi/4")
assert longer.status == nav.CERTIFIED
longer

# %% [markdown]
# The printed formula promises less there than any estimator can reach:

# %%
promised = nav.prove("cos(3*pi/8)/sin(3*pi/16)**2", "<", longer.lower)
assert promised.holds
promised

# %% [markdown]
# The printed formula ends where a weight changes its sign, at 2π/3 for the drift. The ledger has the proof up to there;
# beyond, two times are enough.

# %%
further = nav.claims("guaranteed_velocity")["guaranteed_velocity:range.y3"]
assert further.status == nav.PROVED and further.record.scope == "all T in (0, 2*pi/3]"
assert [len(nav.solve(channel, "drift", T=T, digits=8).support) for T in ("2", "9/4")] == [3, 2]
further

# %% [markdown]
# `nav.phases` finds the formula of each range of T and proves it; the notebook on regimes does that.

# %% [markdown]
# ## Your own formula
# Any formula of the language is decided in the same way.

# %%
right = nav.prove("sin(3*a) = 3*sin(a) - 4*sin(a)**3")
wrong = nav.prove("sin(3*a) = 3*sin(a) - 4*cos(a)**3")
assert (right.status, wrong.status) == (nav.PROVED, nav.REFUTED)
right

# %%
wrong

# %% [markdown]
# ## The polynomial behind the proof
# It touches its bounds where the estimator measures: at the start, in the middle and at the end. Move T. Beyond 2π/3 it
# touches them twice.


# %%
def polynomial_for(T):
    return nav.solve(channel, "drift", T=f"{T:.2f}", digits=8).plot()


nav.explore(polynomial_for, T=(0.3, 5.0, 1.5))

# %% [markdown]
# ## Code
# A proved formula leaves as code, with test vectors, an error bound and a certificate that `nav.check` replays.

# %%
nav.export("guaranteed_velocity:4.13.y3", to=["python"], out="build/tour", vectors=8, force=True)
assert nav.check("build/tour").accepted
with open("build/tour/python/navsym_functions.py", encoding="utf-8") as source:
    print(source.read())
