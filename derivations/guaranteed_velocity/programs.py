"""Velocity correction: guaranteed weights and estimates for every interval, with their table of instants.

The table is a queue in the order of time. ``init`` fills it for an interval T; every ``step`` takes the measurement
at the first instant, adds its share to the estimate and moves the queue. After the last instant the weights are zero,
and further measurements change nothing.
"""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import sympy as sp

from navsym.claims import Equation
from navsym.core.balls import enclose
from navsym.core.errors import DomainError
from navsym.export.chain import Chain, Link, Program, Regimes
from navsym.export.parts import Layout, Material, Output

PLACES = 3
REGIMES = {
    "y1": ("range.y1",),
    "y2": ("range.y2", "range.y2.end*", "range.y2.last"),
    "y3": ("range.y3", "range.y3.end*", "range.y3.last"),
}
W, AT = sp.symbols("w1:4", real=True), sp.symbols("t1:4", real=True)
SUM, Z = sp.Symbol("sum", real=True), sp.Symbol("z", real=True)
UNITS = {
    "T": "1/omega_0 (Schuler time)",
    "instants": "1/omega_0 (Schuler time)",
    "weights": "1",
    "value": "sigma of z",
    "estimate": "unit of z",
    "z": "any, say m/s",
    "sum": "unit of z",
    "tau": "1/omega_0 (Schuler time)",
    "z0": "any, say m/s",
    "zm": "that of z0",
    "zT": "that of z0",
    "dual": "1",
    "sigma": "unit of z",
}


def queue(material: Material) -> Material:
    """Instants and weights of an optimum in the order of time, filled up with the end of the interval.

    Raises DomainError when the order changes inside the regime.
    """
    found: dict[str, list[sp.Expr]] = {output.name: flat for output, flat in material.results}
    ((symbol, ends),) = material.box.items()
    middle = {symbol: enclose(sum(sp.sympify(end, strict=True) for end in ends) / 2)}
    pairs = sorted(
        zip(found["instants"], found["weights"], strict=True), key=lambda pair: float(enclose(pair[0], middle).mid())
    )
    require_order([at for at, _ in pairs], symbol, ends)
    pairs += [(symbol, sp.S.Zero)] * (PLACES - len(pairs))
    results = [
        (Output("instants", (PLACES,)), [at for at, _ in pairs]),
        (Output("weights", (PLACES,)), [w for _, w in pairs]),
        (Output("sum"), [sp.S.Zero]),
        (Output("value"), found["value"]),
    ]
    names = ("instants[0]", "instants[1]", "instants[2]", "weights[0]", "weights[1]", "weights[2]", "sum", "value")
    flat = [e for _, entries in results for e in entries]
    formula = tuple(f"{name} = {e}" for name, e in zip(names, flat, strict=True))
    return replace(material, results=results, source=replace(material.source, formula=formula))


def require_order(instants: list[sp.Expr], symbol: sp.Symbol, ends: tuple[Any, Any]) -> None:
    """Instants are linear in the parameter: in order at both ends, in order between them."""
    for early, late in pairwise(instants):
        gap = sp.expand(late - early)
        linear = gap.is_polynomial(symbol) and sp.Poly(gap, symbol).degree() <= 1
        if not linear or any(enclose(gap.subs(symbol, end)) < 0 for end in ends):
            raise DomainError(
                f"expected instants that keep their order in the regime; got {early} before {late}; split it"
            )


def step_formulas() -> tuple[sp.Expr, ...]:
    """The sum with its first share, and the queue moved by one; the last instant stays."""
    return (SUM + W[0] * Z, W[1], W[2], sp.S.Zero, AT[1], AT[2], AT[2])


def three_steps() -> Equation:
    """Three steps from zero are the estimate: the sum of weights times measurements; a fourth adds nothing."""
    z = sp.symbols("z1:5", real=True)
    values: tuple[sp.Expr, ...] = (sp.S.Zero, *W, *AT)
    for measured in z:
        table = dict(zip((SUM, *W, *AT), values, strict=True)) | {Z: measured}
        values = tuple(e.xreplace(table) for e in step_formulas())
    return Equation(values[0], sum(w * m for w, m in zip(W, z[:3], strict=True)))


STEP = Chain(
    title="One measurement, taken at the first instant of the queue",
    links=(
        Link(
            ("next_sum", "v1", "v2", "v3", "s1", "s2", "s3"),
            "",
            step_formulas(),
            three_steps,
            cites=("guaranteed_velocity:2.5", "guaranteed_velocity:4.14.y3"),
        ),
    ),
    outputs={"next_sum": "next_sum", "next_weights": ("v1", "v2", "v3"), "next_instants": ("s1", "s2", "s3")},
    layout=Layout(
        {"weights": ("w1", "w2", "w3"), "instants": ("t1", "t2", "t3")},
        ("sum", "weights", "instants", "z"),
        {},
        UNITS | {"next_sum": "unit of z", "next_weights": "1", "next_instants": UNITS["instants"]},
    ),
)


def estimator(state: str) -> Program:
    """init(T) and step(z) for one state; ``value`` is its guaranteed standard deviation for sigma = 1."""
    claims = tuple(f"guaranteed_velocity:{number}" for number in REGIMES[state])
    fields = {"instants": "next_instants", "weights": "next_weights", "sum": "next_sum", "value": ""}
    return Program(Regimes(claims, queue, Layout(units=UNITS)), STEP, fields)


PROGRAMS: dict[str, Chain | Program] = {f"velocity-estimator-{state}": estimator(state) for state in ("y1", "y2", "y3")}
