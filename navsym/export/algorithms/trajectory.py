"""The trajectory filter: value, rate and second rate of one coordinate from its measured values."""

from __future__ import annotations

import sympy as sp

from navsym.export.chain import Chain, Link, Program, kept
from navsym.export.parts import Layout

COVARIANCE = ("p11", "p12", "p13", "p22", "p23", "p33")
AHEAD = ("m11", "m12", "m13", "", "m22", "m23", "", "", "m33")
AFTER = ("n11", "n12", "n13", "", "n22", "n23", "", "", "n33")

#: Definite matrices only: variances between one and two, covariances below a third.
TESTS = {n: ((1.0, 2.0) if n[1] == n[2] else (-0.3, 0.3)) for n in COVARIANCE}
TESTS |= {"q1": (1e-3, 1.0), "q2": (1e-3, 1.0), "q3": (1e-3, 1.0), "R": (1e-3, 10.0)}
LAYOUT = Layout(
    arrays={"f": ("f1", "f2", "f3"), "P": COVARIANCE, "q": ("q1", "q2", "q3")},
    order=("f", "P", "q", "R", "z"),
    tests=TESTS,
    units={"f": "unit of z", "P": "(unit of z)^2", "q": "(unit of z)^2", "R": "(unit of z)^2", "z": "any, say m"},
)

FILTER = Program(
    init=kept("The first estimate (value, tau f', tau^2 f''/2) and its covariance, upper triangle", ("f", "P"), LAYOUT),
    step=Chain(
        title="Prediction over tau and correction by one measurement of the value",
        links=(
            Link(AHEAD, "trajectory:algorithm.P_ahead"),
            Link(("K1", "K2", "K3"), "trajectory:algorithm.K*"),
            Link(("g1", "g2", "g3"), "trajectory:algorithm.C*"),
            Link(AFTER, "trajectory:algorithm.P*"),
        ),
        outputs={"estimate": ("g1", "g2", "g3"), "covariance": tuple(n for n in AFTER if n)},
        layout=LAYOUT,
        box={"R": (sp.Integer(0), None)},
    ),
    fields={"f": "estimate", "P": "covariance"},
)
