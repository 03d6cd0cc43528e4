"""Regimes without a closed form as tables: polynomials of times and weights, and how far they are from the optimum.

The checker has shown that the optimum of a piece of a range lies in a box about its curves. Newton's step from other
curves has its image about the same optimum (Neumaier 1990, chapter 5); a residual of their order makes it small.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from flint import arb, fmpq, fmpq_mat

from navsym.core.balls import precision, tape
from navsym.core.errors import DomainError
from navsym.core.exact import decimal, from_decimal, to_fmpq, to_rational
from navsym.guaranteed.certificate.enclosure import interval_ball
from navsym.guaranteed.certificate.moving import MovingProblem
from navsym.guaranteed.certificate.range import (
    BITS,
    enclose_series,
    free_unknowns,
    moving_system,
    newton_image,
    solution_curves,
)
from navsym.guaranteed.phases.answer import Regime
from navsym.guaranteed.phases.certify_range import echelon_form, rescale_family
from navsym.guaranteed.phases.family import Family

#: Degrees of the polynomials: the first is taken whose errors are below NEAR of the largest weight, or else the last.
DEGREES, NEAR = (2, 4, 7, 10), fmpq(1, 2**58)
#: How often Newton's image is taken, and digits of an error, rounded up.
IMAGES, DIGITS = 4, 3


@dataclass(frozen=True, slots=True, eq=False)
class TablePiece:
    """A piece of a table: ``parameter = middle + half s`` with |s| <= 1.

    lower, upper : of the parameter
    share        : s as a formula in the parameter
    contacts     : (panel, polynomial in s of the place as a fraction of the panel, polynomial of sigma times the weight
                   times the parameter to the power ``shift``)
    error        : bounds that of the value, and the sum of sigma times those of the weights
    time_error   : bounds those of the times
    certificate  : of the piece; the independent checker replays it
    """

    lower: sp.Rational
    upper: sp.Rational
    share: sp.Expr
    contacts: tuple[tuple[int, tuple[sp.Rational, ...], tuple[sp.Rational, ...]], ...]
    shift: int
    error: sp.Rational
    time_error: sp.Rational
    certificate: Mapping[str, Any]


def tabulate_regime(regime: Regime) -> Iterator[TablePiece]:
    """The pieces of a regime that is certified without a closed form, in order, as far as its certificates go.

    Raises DomainError where the optimum is not enclosed closely enough for a table.
    """
    family = regime.family
    for document in regime.certificates:
        tied = document["kind"] == "all"  # rows scaled by powers of the parameter
        body = document["of"][0] if tied else document
        if body["kind"] != "range":
            continue
        form = echelon_form(family) if tied else None
        shift, scaled = (0, family) if form is None else (form.shift, rescale_family(family, form))
        for row in body["pieces"]:
            one = dict(body) | {"pieces": [row], "from": row["from"], "to": row["to"]}
            proof = dict(document) | {"of": [one, *document["of"][1:]]} if tied else one
            low, high = (sp.Rational(row[end]) for end in ("from", "to"))
            a, b = to_fmpq(low), to_fmpq(high)
            basis = fmpq_mat([[to_fmpq(sp.Rational(e)) for e in line] for line in row["basis"]])
            moving = MovingProblem(scaled.moving, family.parameter, basis, (a + b) / 2, (b - a) / 2)
            with precision(BITS):
                m, panels = moving.size, [c["panel"] for c in row["contacts"]]
                l = len(panels)
                for degree in DEGREES:
                    curves, errors = refine_curves(moving, row, degree)
                    if max(errors[m:]) < NEAR * max(abs(w[0]) for w in curves[m + l :]):
                        break
                cost = sum(errors[m + l :], arb(0)) / (arb(a) ** shift)
                late = max((e * measure(family, k, a, b)).upper() for e, k in zip(errors[m:], panels, strict=False))
            exact = [tuple(map(to_rational, c)) for c in curves]
            share = (family.parameter - (low + high) / 2) * 2 / (high - low)
            contacts = tuple(zip(panels, exact[m : m + l], exact[m + l :], strict=True))
            yield TablePiece(low, high, share, contacts, shift, round_up(cost), round_up(late), proof)


def measure(family: Family, panel: int, a: fmpq, b: fmpq) -> arb:
    """The length of a panel for all values of the parameter between two."""
    start, stop = family.panels[panel]
    return arb(tape(stop - start).run({family.parameter: interval_ball(a, b)}))


def round_up(x: arb) -> sp.Rational:
    """A short number that is not below a ball."""
    return sp.Rational(decimal(to_fmpq(x.upper()), DIGITS, 1))


def refine_curves(moving: MovingProblem, row: Mapping[str, Any], degree: int) -> tuple[list[list[fmpq]], list[arb]]:
    """Curves of a degree through the box of a piece, and how far the optimum is from each at most, for all s.

    Raises DomainError where Newton's image is not finite.
    """
    columns = [*row["dual"], *(c["at"] for c in row["contacts"]), *(c["weight"] for c in row["contacts"])]
    known = [[from_decimal(e) for e in column] for column in columns]
    pattern = tuple(
        (c["panel"], {"0": "from", "1": "to"}[c["at"][0]] if c["at"] in (["0"], ["1"]) else "no", 1 if w[0] > 0 else -1)
        for c, w in zip(row["contacts"], known[-len(row["contacts"]) :], strict=True)
    )
    curves = solution_curves(moving, pattern, [c[0] for c in known], degree) or known
    free = free_unknowns(pattern, moving.size)
    z = [list(map(arb, c)) for c in curves]
    radius = {k: arb(from_decimal(row["radius"][k])) + distance(curves[k], known[k]) for k in free}
    residual = enclose_series(lambda s: moving_system(moving, pattern, z, {}, s)[0], degree + 4)
    for _ in range(IMAGES):
        move = newton_image(moving, pattern, z, residual, radius, free)
        if move is None:
            ends = " to ".join((row["from"], row["to"]))
            message = f"expected a range where the optimum is enclosed closely; got none from {ends}; narrow the range"
            raise DomainError(message, where="export: phases")
        radius = {k: arb(abs(d).upper()) for k, d in move.items()}
    return curves, [radius.get(k, arb(0)) for k in range(len(z))]


def distance(one: Sequence[fmpq], other: Sequence[fmpq]) -> arb:
    """A bound of the difference of two polynomials for all |s| <= 1."""
    size = max(len(one), len(other))
    pad = [[*c, *[fmpq(0)] * (size - len(c))] for c in (one, other)]
    return arb(sum((abs(a - b) for a, b in zip(*pad, strict=True)), fmpq(0)))
