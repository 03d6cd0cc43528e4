"""The answer: regimes in order, boundaries between them, what is left; as a document, as certificates, as a table."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import fmpq

from navsym.claims import Status
from navsym.claims.display import display_latex, latex_of, write_card, write_table
from navsym.core.answers import Answer
from navsym.core.balls import enclose
from navsym.core.errors import DomainError
from navsym.core.exact import decimal, to_fmpq
from navsym.guaranteed.phases.boundaries import Boundary
from navsym.guaranteed.phases.closed_forms import ClosedForm
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.narrow import Sliver
from navsym.guaranteed.phases.patterns import PatternInterval
from navsym.language.expression import parse, to_text
from navsym.language.values import write_value

if TYPE_CHECKING:
    from navsym.guaranteed.solver import Estimator

DIGITS = 34


@dataclass(frozen=True, slots=True)
class RegimePoint:
    """One measurement of the optimal estimators of a regime.

    measurement : its name
    at          : its time as a formula in the parameter; None inside the interval without a closed form
    weight      : its weight as a formula; None without a closed form
    sign        : sign of the weight; None where the weight itself is known
    """

    measurement: str
    at: sp.Expr | None
    weight: sp.Expr | None = None
    sign: int | None = None

    def document(self) -> dict[str, Any]:
        """The row of the support in the document of the verb."""
        size = {"sign": self.sign} if self.weight is None else {"weight": to_text(self.weight)}
        return {"measurement": self.measurement, "at": None if self.at is None else to_text(self.at)} | size


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Regime:
    """A range of the parameter in which the optimal estimators measure in one pattern.

    family       : the problems to which it belongs
    lower, upper : ends, exact or the middle of an enclosure
    closed       : closed form, or None
    status       : PROVED, CERTIFIED or OPEN for every value in the regime
    table        : enclosures at some values, for regimes without a closed form
    certificates : of kind "range" and what belongs to it
    slivers      : two-sided certificates of what the range certificate leaves
    held         : values between which the pattern itself is proved, without its slivers
    alone        : values between which no other estimator is proved to be optimal, or None
    """

    family: Family
    span: PatternInterval
    lower: sp.Expr
    upper: sp.Expr
    closed: ClosedForm | None
    status: Status
    table: tuple[dict[str, Any], ...] = ()
    certificates: tuple[Mapping[str, Any], ...] = ()
    slivers: tuple[Sliver, ...] = ()
    held: tuple[fmpq, fmpq] | None = None
    alone: tuple[fmpq, fmpq] | None = None

    @property
    def ends(self) -> tuple[str, str]:
        """The ends as text; the middle of an enclosure as a decimal."""
        return end_text(self.lower), end_text(self.upper)

    @property
    def value(self) -> sp.Expr | None:
        """The guaranteed standard deviation as a formula in the parameter; None without a closed form."""
        return None if self.closed is None else self.closed.value

    @property
    def support(self) -> tuple[RegimePoint, ...]:
        """Where the estimators measure, with weights where they have a closed form, else with signs."""
        family, closed = self.family, self.closed
        if closed is None:
            points = []
            for k, kind, sign in self.span.pattern:
                start, stop = family.panels[k]
                place = {"from": start, "to": stop}.get(kind)
                at = None if place is None else family.time(place)
                points.append(RegimePoint(family.measurements[k], at, sign=sign))
        else:
            rows = zip(closed.panels, closed.places, closed.weights, strict=True)
            points = [RegimePoint(family.measurements[k], family.time(at), w) for k, at, w in rows]
        return tuple(reversed(points) if family.backward else points)

    @property
    def dual(self) -> tuple[sp.Expr, ...] | None:
        """The dual x as formulas, one per unknown; None without a closed form."""
        if self.closed is None:
            return None
        known = dict(zip(self.family.unknowns, self.closed.dual, strict=True))
        return tuple(known.get(k, sp.S.Zero) for k in range(len(known) + len(self.family.left_out)))

    @property
    def unique(self) -> bool | None:
        """True when no other estimator is proved to be optimal on a part of the regime; None when it is not known."""
        return True if self.alone else None

    def document(self) -> dict[str, Any]:
        """The row of the regime in the document of the verb."""
        row: dict[str, Any] = dict(zip(("from", "to"), self.ends, strict=True))
        row["value"] = None if self.value is None else to_text(self.value)
        row["support"] = [point.document() for point in self.support]
        row["dual"] = None if self.dual is None else [to_text(x) for x in self.dual]
        row |= {"table": list(self.table)} if self.closed is None else {"method": self.closed.verdict.method}
        row |= {"status": str(self.status), "unique": self.unique}
        if self.alone:
            ends = zip(self.alone, (1, -1), strict=True)
            row["unique_between"] = [decimal(end, DIGITS, side) for end, side in ends]
        if self.slivers:
            row["slivers"] = [dict(zip(("from", "to", "lower", "upper"), s.row(), strict=True)) for s in self.slivers]
        return row

    def __repr__(self) -> str:
        start, end = self.ends
        value = "no closed form" if self.value is None else to_text(self.value)
        return f"Regime({start} < {self.family.parameter} < {end}: {value}, {self.status})"


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """What a front-door answer was asked, so that it can be asked again for one value: model, target, values."""

    model: Any
    target: str | None
    values: Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Phases(Answer):
    """The guaranteed optimum for every value of a parameter.

    regimes      : in order; each with its formula, support and verdict
    boundaries   : between them, located exactly or enclosed
    uncovered    : parts of the range about which nothing is proved, as pairs of text
    given_up     : steps that were given up at the limit of work
    lower, upper : the range
    family       : the problems by the parameter

    >>> import navsym as nav
    >>> drift = nav.phases("examples/schuler-velocity.toml", "drift", T=("2", "4"))
    >>> drift
    Phases(drift, T from 2 to 4: 3 regimes, 2 boundaries, all covered)
    >>> [regime.ends for regime in drift.regimes]
    [('2', '2*pi/3'), ('2*pi/3', 'pi'), ('pi', '4')]
    """

    family: Family
    lower: sp.Expr
    upper: sp.Expr
    regimes: tuple[Regime, ...]
    boundaries: tuple[Boundary, ...]
    uncovered: tuple[tuple[str, str], ...] = field(default=())
    ties: tuple[Mapping[str, Any], ...] = field(default=())
    given_up: tuple[str, ...] = field(default=())
    question: Question | None = None

    @property
    def target(self) -> str:
        """Name of the target."""
        return self.family.target

    @property
    def parameter(self) -> str:
        """Name of the parameter."""
        return self.family.parameter.name

    def at(self, **value: Any) -> Estimator:
        """The certified estimator for one value of the parameter in the range: ``phases.at(T="1")``.

        Raises DomainError for another name or a value outside the range, and the errors of :func:`navsym.solve`.

        >>> import navsym as nav
        >>> drift = nav.phases("examples/schuler-velocity.toml", "drift", T=("2", "4"))
        >>> drift.at(T="3").value.lower[:12]
        '1.0101086659'
        """
        from navsym.guaranteed.solver import solve

        name, where = self.parameter, "Phases.at"
        if list(value) != [name] or self.question is None:
            got = ", ".join(value) or "none"
            raise DomainError(f"expected one value of {name}; got {got}; write at({name}=…)", where=where)
        text = write_value(value[name], f"{where}: {name}")
        at = parse(text, {}, where=f"{where}: {name}")
        if not (bool(enclose(at - self.lower) >= 0) and bool(enclose(self.upper - at) >= 0)):
            ends = f"{end_text(self.lower)} to {end_text(self.upper)}"
            raise DomainError(f"expected a value from {ends}; got {text}; choose one", where=f"{where}: {name}")
        return solve(self.question.model, self.question.target, values={**self.question.values, name: text})

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym phases``."""
        return {
            "target": self.target,
            "parameter": self.parameter,
            "range": [to_text(self.lower), to_text(self.upper)],
            "regimes": [regime.document() for regime in self.regimes],
            "boundaries": [boundary.document() for boundary in self.boundaries],
            "uncovered": [list(pair) for pair in self.uncovered],
        } | ({"given_up": list(self.given_up)} if self.given_up else {})

    def certificates(self) -> list[Mapping[str, Any]]:
        """Certificates of the regimes without a closed form and of slivers, for :func:`navsym.check`."""
        ranges = [dict(c) for regime in self.regimes for c in regime.certificates]
        thin = [dict(s.certificate) for regime in self.regimes for s in regime.slivers]
        return ranges + thin + [dict(tie) for tie in self.ties]

    def __repr__(self) -> str:
        range_ = f"{self.parameter} from {end_text(self.lower)} to {end_text(self.upper)}"
        counts = [
            f"{len(rows)} {word if len(rows) == 1 else more}"
            for rows, word, more in ((self.regimes, "regime", "regimes"), (self.boundaries, "boundary", "boundaries"))
        ]
        left = f"{len(self.uncovered)} uncovered" if self.uncovered else "all covered"
        return f"Phases({self.target}, {range_}: {', '.join([*counts, left])})"

    def _repr_html_(self) -> str:
        """The regimes as a table, for notebooks."""
        heads = ("from", "to", "value", "times", "verdict")
        rows = [
            (
                display_latex(latex_of(r.lower)),
                display_latex(latex_of(r.upper)),
                "a table of enclosures" if r.value is None else display_latex(latex_of(r.value)),
                display_latex(latex_of(tuple(point.at for point in r.support))) if r.closed else "",
                str(r.status),
            )
            for r in self.regimes
        ]
        return write_card([html.escape(f"{self.target} by {self.parameter}"), write_table(heads, rows)])


def end_text(end: sp.Expr, side: int = 0) -> str:
    """An end in the language of files; the middle of an enclosure as a decimal of 34 digits, rounded to a side."""
    if end.is_Rational and end.q > 10**9:
        return decimal(to_fmpq(end), DIGITS, side)
    return to_text(end)
