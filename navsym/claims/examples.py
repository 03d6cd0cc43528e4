"""The files of a new workspace: its list, and a small example of each kind."""

from __future__ import annotations

MANIFEST = """\
[workspace]
claims = ["claims/*.toml"]
models = ["models/*.toml"]
audits = ["audits/*.toml"]
papers = ["papers/*.py"]               # derivation modules of one's own: the only files that are run
"""

CLAIMS = """\
# Pressure over height in an atmosphere of one temperature.
[symbols]
h = "nonnegative"            # height over scale height
d = "nonnegative"            # climb over scale height

[[claim]]
id    = "ratio"
title = "The pressure ratio of a climb does not depend on the height."
left  = "exp(-(h + d))/exp(-h)"
right = "exp(-d)"

[[claim]]
id     = "linear"
title  = "The pressure falls linearly."
left   = "exp(-d)"
right  = "1 - d"
expect = "REFUTED"           # without this line a claim is expected to hold
reason = "the square of d is dropped"

[[claim]]
id       = "linear*"
corrects = "linear"
title    = "The pressure falls at most linearly."
left     = "exp(-d)"
relation = ">="
right    = "1 - d"
"""

MODEL = """\
# One channel of an inertial system in Schuler units; its velocity error is measured for a quarter of a period.
[model]
name   = "alignment"
states = ["v", "tilt", "drift"]
F      = [["0", "-1", "0"], ["1", "0", "1"], ["0", "0", "0"]]

[[measurement]]
name  = "velocity"
h     = ["1", "0", "0"]
sigma = "1"

[interval]
T = "pi/2"

[targets]
drift = ["0", "0", "1"]
"""

PAPER = '''\
"""A pendulum of small angles: its frequency and its energy."""

import sympy as sp

from navsym.claims import Equation, Paper, claim

PAPER = Paper(
    module="pendulum",
    title="A pendulum of small angles",
    authors=("Your Name",),
    year=2026,
    source="lecture notes",
    language="English",
    equations=("1", "2"),
    definitions={"1": "the model: l x'' = -g x"},
)

g, l, A, t = sp.symbols("g l A t", positive=True)
x = A * sp.cos(sp.sqrt(g / l) * t)  # solves (1), starting at rest


@claim("2")
def energy():
    """The energy per mass keeps the value that it has at rest."""
    speed = l * sp.diff(x, t)
    return Equation(printed=g * l * A**2 / 2, derived=speed**2 / 2 + g * l * x**2 / 2)
'''

EXAMPLES = {"claims/baro.toml": CLAIMS, "models/alignment.toml": MODEL, "papers/pendulum.py": PAPER}
