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
# # Your own model
#
# **Question.** A clock is compared with a reference for a time $T$. Every comparison has a bounded variance,
# and nobody knows how the errors are correlated. How well can the *frequency* of the clock be known at the
# end, whatever the correlation is? Which comparisons does the best estimator use? May the answer go into
# a receiver?
#
# No paper prepares this: one import, a model, five questions, and code at the end.

# %%
import navsym as nav

# %% [markdown]
# ## 1. The model
# The states are offset, frequency and drift, and the offset is measured. Whole numbers and text are read exactly. A
# float is refused, because `0.1` is not one tenth.

# %%
clock = nav.Model(
    name="clock",
    states="offset frequency drift",
    F=[[0, 1, 0], [0, 0, 1], [0, 0, 0]],
    H=["offset"],
    measurements="comparison",
    sigma=1,
    interval="T",
    targets={"frequency": "frequency"},
    T=("1/10", 100),
)
clock

# %%
try:
    nav.solve(clock, T=0.1)
except nav.NavsymError as error:
    refused = error
assert refused.kind == "domain" and '"1/10"' in str(refused)
print(refused)

# %% [markdown]
# ## 2. Can it be observed at all?

# %%
observability = nav.observe(clock)
assert observability.observable
observability

# %% [markdown]
# ## 3. The answer for one interval
# The value is enclosed by a lower and an upper bound that meet. The independent checker replays the certificate.

# %%
two_seconds = nav.solve(clock, "frequency", T=2)
assert two_seconds.status.holds
assert abs(float(two_seconds.value) - 4) < 1e-15 and two_seconds.value.digits >= 30
two_seconds

# %%
two_seconds.check()

# %% [markdown]
# It is the only optimal estimator, and its dual polynomial shows why: it touches its bounds where one should measure.

# %%
assert two_seconds.unique
two_seconds.plot()

# %% [markdown]
# ## 4. Change the parameter

# %%
values = {T: float(nav.solve(clock, "frequency", T=T, digits=8).value) for T in (1, 2, 4)}
assert [round(value, 6) for value in values.values()] == [8, 4, 2]
values

# %% [markdown]
# It looks like $8\sigma/T$. Three values are not yet a formula.

# %% [markdown]
# ## 5. From numbers to a formula, for every T
# `phases` looks for the formula and proves it for every $T$ of the range at once: value, times and weights.

# %%
answer = nav.phases(clock, "frequency", T=("1/10", 100))
(regime,) = answer.regimes
assert regime.status == nav.PROVED and not answer.uncovered
assert str(regime.value) == "8/T"
assert [str(point.at) for point in regime.support] == ["0", "T/2", "T"]
assert [str(point.weight) for point in regime.support] == ["1/T", "-4/T", "3/T"]
answer

# %%
answer.plot()

# %% [markdown]
# ## 6. A formula of your own
# The moduli of the weights must add up to the value. A wrong formula falls at an exact point.

# %%
right = nav.prove("1/T + 4/T + 3/T = 8/T", T=("1/10", 100))
wrong = nav.prove("1/T**2 + 16/T**2 + 9/T**2 = 16/T**2", T=("1/10", 100))
assert right.status == nav.PROVED and wrong.status == nav.REFUTED
right

# %%
wrong

# %% [markdown]
# ## 7. Code with a certificate
# A proved answer leaves as code, with test vectors, an error bound and a certificate. A refuted formula is not
# exported.

# %%
nav.export(answer, to=["python"], out="build/clock", vectors=8, force=True)
assert nav.check("build/clock").accepted
try:
    nav.export(wrong, to=["python"], out="build/wrong")
except nav.NavsymError as error:
    refused = error
assert refused.kind == "refused"
print(refused)

# %% [markdown]
# ## 8. Back to a file
# The command line reads the same model: `navsym solve build/clock.toml --set T=2`.

# %%
clock.save("build/clock.toml")
assert nav.Model.load("build/clock.toml") == clock
