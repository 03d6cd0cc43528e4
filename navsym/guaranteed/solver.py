"""The guaranteed estimator of any linear model, with a certificate.

Among the linear unbiased estimators of ``P^T q`` from ``z_j = H_j^T q + r_j``, where the noise has a
standard deviation of at most sigma_j and any correlation, the best has the guaranteed standard
deviation ``min sum_j sigma_j integral |Phi_j|`` (Lidov 1964; Martirosyan 2023, (2.7)).
"""

from __future__ import annotations

import html
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from flint import arb

from navsym.claims import CERTIFIED, OPEN, Status
from navsym.claims.display import mark_verdict, shorten_digits, write_card, write_table
from navsym.core.answers import Answer, named
from navsym.core.balls import precision
from navsym.core.errors import DomainError
from navsym.core.exact import decimal
from navsym.core.numbers import Number
from navsym.guaranteed.certificate.basis import Basis, DependentError, make_basis
from navsym.guaranteed.certificate.enclosure import PanelProblem
from navsym.guaranteed.certificate.fixed import CertifiedOptimum, certify
from navsym.guaranteed.estimability import drop_dependent
from navsym.guaranteed.problem import GuaranteedProblem, problem_of
from navsym.guaranteed.search.exchange import find_contacts
from navsym.guaranteed.separation import FAR, separate_regressors
from navsym.guaranteed.time_varying import ERROR
from navsym.guaranteed.uniqueness import is_only_optimum
from navsym.language.expression import to_text
from navsym.language.files import file_in_errors
from navsym.language.names import quote

if TYPE_CHECKING:
    from navsym.guaranteed.baselines import Comparison
    from navsym.models.model import Model

MOST_DIGITS = 1000


@dataclass(frozen=True, slots=True)
class SupportPoint:
    """One measurement that an estimator uses.

    measurement : its name
    at          : time from the start of the interval
    weight      : its weight, in units of the target per unit of the measurement
    text        : time and weight as decimals, rounded to nearest
    """

    measurement: str
    at: Number
    weight: Number
    text: tuple[str, str] = field(repr=False)

    def document(self) -> dict[str, str]:
        """The row of the support in the document of the verb."""
        return {"measurement": self.measurement, "at": self.text[0], "weight": self.text[1]}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Estimator(Answer):
    """The guaranteed estimator of a target, with its enclosed optimum.

    value       : the guaranteed standard deviation ``min sum_j sigma_j integral |Phi_j|``, in units of the target
    support     : where it measures and with which weights; the estimate is ``sum weight * z(at)``
    dual        : x, one number per unknown; ``|x . H_j(t)| <= sigma_j`` everywhere, with equality on the support
    unique      : True or False only when the estimator is proved to be, or not to be, the only optimal one
    certificate : plain data that the independent checker replays
    status      : CERTIFIED when the enclosure is as narrow as was asked for, else OPEN
    problem     : what was solved
    width       : relative width of the enclosure
    asked       : digits that were asked for

    >>> import navsym as nav
    >>> drift = nav.solve("examples/schuler-velocity.toml", "drift", T="pi/2")
    >>> drift
    Estimator(drift: 4.82842712474619..., 3 measurements, CERTIFIED)
    >>> [f"{float(w):.4f}" for w in drift.weights]
    ['-1.7071', '2.4142', '-0.7071']
    """

    value: Number
    support: tuple[SupportPoint, ...]
    dual: tuple[str, ...]
    unique: bool | None
    certificate: Mapping[str, Any]
    status: Status
    problem: GuaranteedProblem
    width: float
    asked: int = 30

    @property
    def target(self) -> str:
        """Name of the target."""
        return self.problem.target

    @property
    def lower(self) -> str:
        """Decimal below the optimum."""
        return self.value.lower

    @property
    def upper(self) -> str:
        """Decimal above the optimum."""
        return self.value.upper

    @property
    def weights(self) -> tuple[Number, ...]:
        """Weights of the support, in its order."""
        return tuple(point.weight for point in self.support)

    @property
    def digits(self) -> int:
        """Digits of the enclosure: the largest n with a relative width of at most ``10**-n``."""
        return 0 if self.width >= 1.0 else self.asked if self.width == 0.0 else int(-math.log10(self.width))

    @property
    def missing(self) -> str:
        """A sentence on what an OPEN answer lacks; empty for others."""
        if self.status is not OPEN:
            return ""
        if self.problem.error:
            why = f"the regressors are integrated, with an error of about {float(self.problem.error):.0e}"
        else:
            why = "no exact contacts were proved to exist, and no dual closer to its bound was proved to keep it"
        digits = f"{self.digits} of the {self.asked} digits asked for"
        return f"the optimum lies between lower and upper for certain, but these agree to {digits} only: {why}"

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym solve``."""
        return named(self, "target status value support dual unique certificate" + " missing" * bool(self.missing))

    def compare(
        self, solvers: Sequence[str] | None = None, progress: Callable[[str], None] = lambda solver: None
    ) -> Comparison:
        """Other estimators under their own worst correlation, and general solvers on a grid: ``--compare``.

        solvers  : names such as "casadi:highs"; by default all that are known
        progress : called with the name of each solver that has answered

        Raises DomainError for an unknown solver.

        >>> import navsym as nav
        >>> drift = nav.solve("examples/schuler-velocity.toml", "drift", T="pi/2")
        >>> drift.compare(solvers=[])
        Comparison(optimum 4.82843, least squares 7.02971, Kalman filter 7.02971, 0 solvers)
        """
        from navsym.guaranteed.baselines import LP_SOLVERS, compare_estimators

        return compare_estimators(self, LP_SOLVERS if solvers is None else solvers, progress)

    def __repr__(self) -> str:
        count = f"{len(self.support)} measurement{'' if len(self.support) == 1 else 's'}"
        return f"Estimator({quote(self.target)[1:-1]}: {self.value}, {count}, {self.status})"

    def _repr_html_(self) -> str:
        """The estimator as a table, for notebooks."""
        value = (
            self.lower if self.lower == self.upper else f"{shorten_digits(self.lower)} to {shorten_digits(self.upper)}"
        )
        head = f"{html.escape(self.target)}: {html.escape(value)} {mark_verdict(str(self.status))}"
        rows = [(p.measurement, shorten_digits(p.text[0]), shorten_digits(p.text[1])) for p in self.support]
        return write_card([head, write_table(("measurement", "time", "weight"), rows)], str(self.status))


def solve(
    model: Model | str | os.PathLike[str] | GuaranteedProblem,
    target: str | None = None,
    *,
    digits: int = 30,
    values: Mapping[str, Any] | None = None,
    **parameters: Any,
) -> Estimator:
    """The guaranteed estimator of a target, and an enclosure of its standard deviation to ``digits`` digits.

    Minimises ``sum_j sigma_j integral |Phi_j|`` subject to ``sum_j integral H_j Phi_j = P``: the standard deviation
    that no correlation of the noise exceeds (Lidov 1964; Martirosyan 2023, (2.7)). The value is in units of the
    target; times run from the start of the interval.

    model      : a :class:`navsym.Model`, the path of a model file, or a :class:`GuaranteedProblem`
    target     : name of the target; not needed where the model has one
    digits     : certified digits of the value, 1 to 1000
    parameters : values of parameters of the model, such as ``T="pi/2"``: text, ints, Fractions, sympy numbers
    values     : the same as a mapping, for parameters whose names are taken by the arguments above

    Raises NotEstimableError with a null direction when the measurements do not determine the target,
    UnknownSymbolError for a parameter that the model does not have, DomainError for a float or a value outside its
    declared range, and TooLargeError for functions that cannot be resolved.

    >>> import navsym as nav
    >>> drift = nav.solve("examples/schuler-velocity.toml", "drift", T="pi/2", digits=20)
    >>> drift.lower, drift.unique
    ('4.82842712474619009760337', True)
    """
    if not isinstance(digits, int) or isinstance(digits, bool) or not 1 <= digits <= MOST_DIGITS:
        got = quote(digits)
        message = f"expected 1 to {MOST_DIGITS} digits; got {got}; choose a whole number between"
        raise DomainError(message, where="solve: digits")
    with file_in_errors(model):
        return solve_problem(problem_of(model, target, values, parameters, "solve"), digits)


def solve_problem(problem: GuaranteedProblem, digits: int = 30) -> Estimator:
    """The estimator of a problem, see :func:`solve`."""
    exact, kept, basis = independent_problem(problem)
    found = certify_separated(exact, digits, basis)
    unique = found.unique
    if unique is None and not problem.error:
        unique = is_only_optimum(exact, basis, find_contacts(basis.panels), found.dual)
    dual = ["0"] * len(problem.functional)
    for k, x in zip(kept, found.dual, strict=True):
        dual[k] = decimal(x, digits)
    return Estimator(
        Number(found.certificate["lower"], found.certificate["upper"]),
        support_rows(problem, exact, found, digits),
        tuple(dual),
        unique,
        certificate_with_error(problem, found.certificate),
        CERTIFIED if found.reaches(digits) else OPEN,
        problem,
        found.width,
        digits,
    )


def certify_separated(exact: PanelProblem, digits: int, basis: Basis) -> CertifiedOptimum:
    """The optimum and its certificate; of the same problem in other unknowns, where too much cancels in these."""
    other = (
        separate_regressors(exact) if basis.loss >= FAR and not any(panel.values for panel in exact.panels) else None
    )
    better = basis if other is None else make_basis(other.problem)
    if other is None or better.loss >= basis.loss:
        return certify(exact, digits, basis)
    found = certify(other.problem, digits, better)
    with precision(int(3.34 * (digits + 2 * basis.loss)) + 128):
        found = replace(found, dual=other.back(found.dual))
    if found.reaches(digits):
        return found
    return min(found, certify(exact, digits, basis), key=lambda answer: answer.width)


def certificate_with_error(problem: GuaranteedProblem, certificate: Mapping[str, Any]) -> Mapping[str, Any]:
    """The certificate; where regressors have an error, it holds for every value of it up to its bound."""
    if not problem.error:
        return certificate
    bound = to_text(problem.error)
    return {**certificate, "kind": "sliver", "parameter": ERROR.name, "from": f"-{bound}", "to": bound}


def support_rows(
    problem: GuaranteedProblem, exact: PanelProblem, found: CertifiedOptimum, digits: int
) -> tuple[SupportPoint, ...]:
    """Times and weights of a certified solution, by measurement and time.

    Places v in [0, 1] on their panels become times ``start + (end - start) v``.
    """
    points = []
    with precision(int(3.4 * digits) + 128):
        for k, v, weight in found.support:
            panel = exact.panels[k]
            start, end = panel.time(arb(0)), panel.time(arb(1))
            at = start + (end - start) * v
            text = decimal(at, digits), decimal(weight, digits)
            name = problem.measurements[panel.measurement]
            numbers = enclosing_number(at, digits + 4), enclosing_number(weight, digits + 4)
            points.append((name, float(at.mid()), SupportPoint(name, *numbers, text)))
    return tuple(point for _, _, point in sorted(points, key=lambda row: row[:2]))


def enclosing_number(x: arb, digits: int) -> Number:
    """The ends of a ball as decimals, rounded outwards."""
    return Number(decimal(x.lower(), digits, -1), decimal(x.upper(), digits, 1))


# Unknowns that the measurements do not tell apart


def independent_problem(problem: GuaranteedProblem) -> tuple[PanelProblem, list[int], Basis]:
    """The problem without unknowns whose regressors depend on the others, exactly.

    Returns the reduced problem, the unknowns that are left and its basis. Raises NotEstimableError.
    """
    kept = list(range(len(problem.functional)))
    while True:
        panels = [replace(panel, functions=tuple(panel.functions[k] for k in kept)) for panel in problem.exact().panels]
        exact = PanelProblem(tuple(panels), tuple(problem.functional[k] for k in kept))
        try:
            return exact, kept, make_basis(exact)
        except DependentError as found:
            drop_dependent(problem, kept, found.index, found.relation)
