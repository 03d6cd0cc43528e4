"""The answer: regimes in order, boundaries between them, what is left; as a document, as certificates, as a table."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import fmpq

from navsym.claims import Status
from navsym.claims.display import display_latex, latex_of, write_card, write_table
from navsym.core.answers import Answer, named
from navsym.core.balls import enclose
from navsym.core.errors import DomainError
from navsym.core.exact import decimal, to_fmpq
from navsym.guaranteed.phases.boundaries import Boundary
from navsym.guaranteed.phases.closed_forms import ClosedForm
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.narrow import Sliver
from navsym.guaranteed.phases.patterns import PatternInterval
from navsym.language.expression import to_text
from navsym.language.values import read_constant
from navsym.models.model import contents_of

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
        return solve_at(self.question, {self.parameter: (self.lower, self.upper)}, value, "Phases.at")

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym phases``."""
        head = named(self, "target parameter") | {"range": [to_text(self.lower), to_text(self.upper)]}
        return head | named(self, "regimes boundaries uncovered" + " given_up" * bool(self.given_up))

    def certificates(self) -> list[Mapping[str, Any]]:
        """Certificates of closed forms, of the regimes without one and of slivers, for :func:`navsym.check`."""
        forms = form_certificates(self.regimes)
        ranges = [dict(c) for regime in self.regimes for c in regime.certificates]
        thin = [dict(s.certificate) for regime in self.regimes for s in regime.slivers]
        return forms + ranges + thin + [dict(tie) for tie in self.ties]

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


def solve_at(
    question: Question | None, ranges: Mapping[str, tuple[sp.Expr, sp.Expr]], values: Mapping[str, Any], where: str
) -> Estimator:
    """The certified estimator for values inside their ranges. Raises DomainError."""
    from navsym.guaranteed.solver import solve

    if values.keys() != ranges.keys() or question is None:
        got, names = ", ".join(values) or "none", ", ".join(f"{name}=…" for name in ranges)
        one = "one value of" if len(ranges) == 1 else "values of"
        raise DomainError(f"expected {one} {', '.join(ranges)}; got {got}; write at({names})", where=where)
    units = {p.name: p.unit for p in contents_of(question.model, None, {}, where).parameters.values()}
    points = {name: read_constant(value, f"{where}: {name}", units.get(name, "")) for name, value in values.items()}
    texts = {name: to_text(at) for name, at in points.items()}
    for name, (lower, upper) in ranges.items():
        at = points[name]
        if not (bool(enclose(at - lower) >= 0) and bool(enclose(upper - at) >= 0)):
            ends = f"{end_text(lower)} to {end_text(upper)}"
            message = f"expected a value from {ends}; got {texts[name]}; choose one"
            raise DomainError(message, where=f"{where}: {name}")
    return solve(question.model, question.target, values={**question.values, **texts})


def end_text(end: sp.Expr, side: int = 0) -> str:
    """An end in the language of files; the middle of an enclosure as a decimal of 34 digits, rounded to a side."""
    if end.is_Rational and end.q > 10**9:
        return decimal(to_fmpq(end), DIGITS, side)
    return to_text(end)


# Maps in two parameters


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A part of a map: the second parameter between two numbers, the first between two curves.

    low, high : of the second parameter
    regime    : the optimal estimators there; its ends are formulas in the second parameter
    """

    low: sp.Expr
    high: sp.Expr
    regime: Regime

    def document(self, first: str, second: str) -> dict[str, Any]:
        """Ranges of both parameters as text."""
        return {second: [end_text(self.low), end_text(self.high)], first: list(self.regime.ends)}


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A boundary of a map: one parameter as a formula in the other.

    name, at      : ``name = at``
    along         : the other parameter, from low to high
    why           : what happens there
    """

    name: str
    at: sp.Expr
    along: str
    low: sp.Expr
    high: sp.Expr
    why: str

    @property
    def equation(self) -> str:
        """The equation of the curve."""
        return f"{self.name} = {to_text(self.at)}"

    def values_at(self, name: str, value: sp.Expr) -> list[sp.Expr]:
        """Values of the other parameter on the curve, or at its ends, where a parameter has a value."""
        if name == self.along:
            inside = all(not bool(enclose(e) < 0) for e in (value - self.low, self.high - value))
            own = {s: value for s in self.at.free_symbols}
            return [self.at.subs(own)] if inside else []
        return [self.low, self.high] if self.at == value else []

    def document(self) -> dict[str, Any]:
        """The row of the curve in the document of the verb."""
        return {"equation": self.equation, self.along: [end_text(self.low), end_text(self.high)], "why": self.why}


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """A point of a map at which curves meet."""

    first_name: str
    first: sp.Expr
    second_name: str
    second: sp.Expr
    curves: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """The row of the point in the document of the verb."""
        here = {self.first_name: end_text(self.first), self.second_name: end_text(self.second)}
        return here | {"curves": list(self.curves)}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PhaseMap(Answer):
    """The guaranteed optimum for all values of two parameters in a rectangle.

    family       : the problems by the first parameter, the second beside it
    second       : the second parameter
    first_ends, second_ends : the rectangle
    parts        : in order of the second parameter, then of the first; each with its formula and verdict, or open
    curves       : boundaries between closed forms, as equations
    meetings     : points where curves meet
    gaps         : ranges of the second parameter between which the order of the patterns changes, and no more is known
    given_up     : steps that were given up at the limit of work

    >>> import navsym as nav
    >>> model = nav.Model(states="x v a", F=[["0", "1", "0"], ["0", "0", "1"], ["0"] * 3], H=["x", "v"],
    ...     sigma=["1", "p"], interval="T", targets={"a": "a"}, T=("1", "6"), p=("1/2", "3"))
    >>> found = nav.phases(model, T=("1", "6"), p=("1", "2"))
    >>> found
    PhaseMap(a, T from 1 to 6 and p from 1 to 2: 2 regions, 1 curve, all covered)
    >>> [curve.equation for curve in found.curves]
    ['T = 8/p']
    """

    family: Family
    second: sp.Symbol
    first_ends: tuple[sp.Expr, sp.Expr]
    second_ends: tuple[sp.Expr, sp.Expr]
    parts: tuple[Part, ...]
    curves: tuple[Curve, ...]
    meetings: tuple[Meeting, ...]
    gaps: tuple[tuple[sp.Expr, sp.Expr], ...] = ()
    given_up: tuple[str, ...] = ()
    question: Question | None = None

    @property
    def target(self) -> str:
        """Name of the target."""
        return self.family.target

    @property
    def parameters(self) -> tuple[str, str]:
        """Names of both parameters."""
        return self.family.parameter.name, self.second.name

    @property
    def regions(self) -> tuple[tuple[Part, ...], ...]:
        """Proved parts with one closed form together."""
        found: dict[tuple[Any, ...], list[Part]] = {}
        for part in self.parts:
            form = part.regime.closed
            if form is not None:
                found.setdefault((form.panels, form.places, form.weights, form.dual), []).append(part)
        return tuple(map(tuple, found.values()))

    @property
    def uncovered(self) -> tuple[dict[str, Any], ...]:
        """Parts of the rectangle about which nothing is proved, as text."""
        first, second = self.parameters
        whole = [end_text(end) for end in self.first_ends]
        gaps = [{second: [end_text(a), end_text(b)], first: whole} for a, b in self.gaps]
        return (*gaps, *(p.document(first, second) for p in self.parts if p.regime.closed is None))

    @property
    def covered(self) -> float:
        """The share of the rectangle that the proved parts cover, in doubles."""
        low, high = (float(enclose(e).mid()) for e in self.second_ends)
        height = float(enclose(self.first_ends[1] - self.first_ends[0]).mid())
        lost = sum(float(enclose(b - a).mid()) * height for a, b in self.gaps)
        lost += sum(part_area(part, self.second) for part in self.parts if part.regime.closed is None)
        return 1.0 - lost / ((high - low) * height)

    def at(self, **values: Any) -> Estimator:
        """The certified estimator for values of both parameters in the rectangle: ``map.at(T="3", p="1")``.

        Raises DomainError for other names or values outside the rectangle, and the errors of :func:`navsym.solve`.
        """
        ranges = dict(zip(self.parameters, (self.first_ends, self.second_ends), strict=True))
        return solve_at(self.question, ranges, values, "PhaseMap.at")

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym phases`` with two parameters."""
        first, second = self.parameters
        ends = zip((first, second), (self.first_ends, self.second_ends), strict=True)
        return {
            **named(self, "target parameters"),
            "range": {name: [end_text(a), end_text(b)] for name, (a, b) in ends},
            "regions": [region_document(parts, first, second) for parts in self.regions],
        } | named(self, "curves meetings covered uncovered" + " given_up" * bool(self.given_up))

    def __repr__(self) -> str:
        ranges = zip(self.parameters, (self.first_ends, self.second_ends), strict=True)
        where = " and ".join(f"{name} from {end_text(a)} to {end_text(b)}" for name, (a, b) in ranges)
        counts = [
            f"{len(rows)} {word if len(rows) == 1 else word + 's'}"
            for rows, word in ((self.regions, "region"), (self.curves, "curve"))
        ]
        left = f"{self.covered:.2%} covered" if self.uncovered else "all covered"
        return f"PhaseMap({self.target}, {where}: {', '.join([*counts, left])})"

    def _repr_html_(self) -> str:
        """The regions and curves as tables, for notebooks."""
        rows = [
            (display_latex(latex_of(p.regime.value)), *(" to ".join(e) for e in p.document(*self.parameters).values()))
            for parts in self.regions
            for p in parts
        ]
        first, second = self.parameters
        regions = write_table(("value", second, first), rows)
        curves = write_table(("curve", "event"), [(html.escape(c.equation), html.escape(c.why)) for c in self.curves])
        return write_card([html.escape(repr(self)), regions, curves])


def form_certificates(regimes: Iterable[Regime]) -> list[Mapping[str, Any]]:
    """The certificates of closed forms, each for all values of its regime."""
    return [dict(c) for regime in regimes if regime.closed is not None and (c := regime.closed.verdict.certificate)]


def region_document(parts: tuple[Part, ...], first: str, second: str) -> dict[str, Any]:
    """The row of a region: what its parts share, the weakest verdict, and where they lie."""
    row = parts[0].regime.document()
    proved = all(str(part.regime.status) == "PROVED" for part in parts)
    shared = {key: row[key] for key in ("value", "support", "dual")}
    status = "PROVED" if proved else "CERTIFIED"
    return shared | {"status": status, "parts": [part.document(first, second) for part in parts]}


def part_area(part: Part, second: sp.Symbol) -> float:
    """The area between the curves of a part, by the trapezoidal rule on 64 strips."""
    low, high = (float(enclose(e).mid()) for e in (part.low, part.high))
    width = part.regime.upper - part.regime.lower
    places = [sp.Rational(str(low + (high - low) * k / 64)) for k in range(65)]
    sizes = [abs(float(enclose(width.subs(second, at)).mid())) for at in places]
    return (sum(sizes) - (sizes[0] + sizes[-1]) / 2) * (high - low) / 64
