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
# Nothing here is prepared by a paper: a model file, five questions, code at the end.

# %%
import tempfile
import tomllib
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

from navsym.claims import Optimum
from navsym.cli.main import run
from navsym.guaranteed.problem import from_file
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import linear_model, model_from
from navsym.observability.chains import observe
from navsym.prove.ladder import decide
from navsym.report.notebook import explore
from navsym.testing import ClaimFailedError, assert_claim

# %% [markdown]
# ## 1. The model, in words that a machine reads exactly
# Offset, frequency and drift; the offset is measured.

# %%
CLOCK = """
[model]
name   = "clock"
states = ["offset", "frequency", "drift"]
F      = [["0", "1", "0"], ["0", "0", "1"], ["0", "0", "0"]]

[parameters]
T = ["1/10", "100"]

[[measurement]]
name  = "comparison"
h     = ["1", "0", "0"]
sigma = "1"

[interval]
T = "T"

[targets]
frequency = ["0", "1", "0"]
"""
document = tomllib.loads(CLOCK)
clock = model_from(document)
linear_model(clock)

# %% [markdown]
# ## 2. Can it be observed at all?

# %%
observability = observe(linear_model(clock))
assert observability.observable
observability

# %% [markdown]
# ## 3. The answer for one interval
# The value is enclosed by a lower and an upper bound that meet; the certificate can be replayed elsewhere.

# %%
found = solve(from_file(model_from(document, values={"T": "2"})))
assert found.status in ("PROVED", "CERTIFIED")
assert found.lower.startswith("3.99999") or found.lower.startswith("4")
found

# %% [markdown]
# ## 4. Change a parameter
# The slider asks again for another interval; without a browser its function is simply called.


# %%
def estimator(T: float):
    return solve(from_file(model_from(document, values={"T": f"{T:.2f}"})), digits=8)


assert [round(float(estimator(T).upper), 6) for T in (1, 2, 4)] == [8, 4, 2]
explore(estimator, T=(0.5, 8.0, 2.0))

# %% [markdown]
# It looks like $8\sigma/T$. What looks so for three values is not yet a formula.

# %% [markdown]
# ## 5. From numbers to a formula, for every T
# The dual polynomial must touch its bounds at 0, T/2 and T: it is Chebyshev's. Put weights, instants, dual
# and value together, and have optimality decided for every $T$ of the range at once.

# %%
T, tau = sp.Symbol("T", positive=True), sp.Symbol("tau", real=True)
regressors = (sp.Integer(1), tau - T, (tau - T) ** 2 / 2)
optimum = Optimum(
    regressors=regressors,
    functional=(0, 1, 0),
    variable=tau,
    interval=(sp.Integer(0), T),
    dual=(sp.Integer(1), 8 / T, 16 / T**2),
    support=(sp.Integer(0), T / 2, T),
    weights=(1 / T, -4 / T, 3 / T),
    value=8 / T,
    box={T: (sp.Rational(1, 10), 100)},
)
verdict = decide(optimum)
assert verdict.status.holds
verdict

# %%
x = optimum.dual
at = np.linspace(0, 1, 300)
polynomial = [float(sum(c * h for c, h in zip(x, regressors, strict=True)).subs({T: 1, tau: float(s)})) for s in at]
figure, axis = plt.subplots(figsize=(7, 3))
axis.plot(at, polynomial, color="#0072b2")
axis.axhline(1, color="0.6", lw=0.8)
axis.axhline(-1, color="0.6", lw=0.8)
axis.plot([0, 0.5, 1], [1, -1, 1], "o", color="#d55e00")
axis.set(xlabel=r"$\tau / T$", ylabel="dual polynomial", title="It touches its bounds where one should measure")
plt.close(figure)
assert np.abs(polynomial).max() <= 1 + 1e-12
figure

# %% [markdown]
# ## 6. In your own tests
# The same door for a formula of yours; a wrong one fails with its counterexample.

# %%
assert_claim(sum(abs(w) for w in optimum.weights), 8 / T)
try:
    assert_claim(sum(w**2 for w in optimum.weights), 16 / T**2)
except ClaimFailedError as error:
    caught = error
assert caught.verdict.status == "REFUTED"
print(caught)

# %% [markdown]
# ## 7. Code with a certificate
# A claim file says what is exported; a claim that does not hold is refused.

# %%
CLAIMS = """
[symbols]
T = ["1/10", "100"]
[[claim]]
id    = "deviation"
left  = "1/T + 4/T + 3/T"
right = "8/T"
"""
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "clock.toml"
    path.write_text(CLAIMS)
    status = run(["prove", str(path)])
    status += run(["export", f"{path}:deviation", "--to", "python", "--out", str(Path(folder) / "code")])
    written = sorted(str(p.relative_to(folder)) for p in Path(folder).rglob("*.py"))
assert status == 0 and written
written
