"""The guaranteed estimator of any linear model, with a certificate.

Among the linear unbiased estimators of ``P^T q`` from ``z_j = H_j^T q + r_j``, where the noise has a
standard deviation of at most sigma_j and any correlation, the best has the guaranteed standard
deviation ``min sum_j sigma_j integral |Phi_j|`` (Lidov 1964; Martirosyan 2023, (2.7)).
"""

from __future__ import annotations

import html
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from flint import arb

from navsym.claims import CERTIFIED, OPEN, Status
from navsym.claims.display import card, shortened, table, verdict_words
from navsym.core.balls import precision
from navsym.core.errors import NavsymError
from navsym.core.exact import decimal
from navsym.guaranteed.certificate.basis import Basis, DependentError, make_basis
from navsym.guaranteed.certificate.enclosure import Problem
from navsym.guaranteed.certificate.fixed import Certified, certify
from navsym.guaranteed.estimability import drop_dependent
from navsym.guaranteed.problem import GuaranteedProblem
from navsym.guaranteed.search.exchange import find_contacts
from navsym.guaranteed.separation import FAR, separated
from navsym.guaranteed.time_varying import ERROR
from navsym.guaranteed.uniqueness import only_optimal, several_optimal
from navsym.language.expression import to_text

MOST_DIGITS = 1000


@dataclass(frozen=True, slots=True)
class Support:
    """One instant of the estimator: measurement, time and weight as decimal strings."""

    measurement: str
    at: str
    weight: str


@dataclass(frozen=True, slots=True, eq=False)
class GuaranteedSolution:
    """An estimator with its enclosed optimum.

    support      : instants and weights
    dual         : x, decimal strings; ``x . H_j(t)`` is the dual polynomial
    lower, upper : decimal strings that enclose the guaranteed standard deviation
    unique       : True or False only when the estimator is proved to be, or not to be, the only optimal one
    certificate  : plain data for ``navsym check``
    status       : CERTIFIED when the enclosure is as narrow as was asked for, else OPEN
    digits       : how many were asked for
    """

    problem: GuaranteedProblem
    support: tuple[Support, ...]
    dual: tuple[str, ...]
    lower: str
    upper: str
    unique: bool | None
    certificate: Mapping[str, Any]
    status: Status
    width: float
    digits: int = 30

    @property
    def reached(self) -> int:
        """Digits of the enclosure: the largest n with a relative width of at most ``10**-n``."""
        return 0 if self.width >= 1.0 else self.digits if self.width == 0.0 else int(-math.log10(self.width))

    @property
    def weights(self) -> tuple[str, ...]:
        """Weights of the support as decimal strings, in its order."""
        return tuple(row.weight for row in self.support)

    @property
    def value(self) -> float:
        """Middle of the enclosure as a float, for plots."""
        return (float(self.lower) + float(self.upper)) / 2

    def _repr_html_(self) -> str:
        """The estimator as a table, for notebooks."""
        value = self.lower if self.lower == self.upper else f"{shortened(self.lower)} to {shortened(self.upper)}"
        head = f"{html.escape(self.problem.target)}: {html.escape(value)} {verdict_words(str(self.status))}"
        rows = [(row.measurement, shortened(row.at), shortened(row.weight)) for row in self.support]
        return card([head, table(("measurement", "instant", "weight"), rows)], str(self.status))

    def document(self) -> dict[str, Any]:
        """The answer of ``navsym solve``."""
        rows = [{"measurement": r.measurement, "at": r.at, "weight": r.weight} for r in self.support]
        return {
            "target": self.problem.target,
            "status": str(self.status),
            "value": {"lower": self.lower, "upper": self.upper},
            "support": rows,
            "dual": list(self.dual),
            "unique": self.unique,
            "certificate": dict(self.certificate),
        } | ({"missing": self.missing()} if self.status is OPEN else {})

    def missing(self) -> str:
        """What an OPEN answer lacks, in a sentence; empty when nothing does."""
        if self.status is not OPEN:
            return ""
        if self.problem.error:
            why = f"the regressors are integrated, with an error of about {float(self.problem.error):.0e}"
        else:
            why = "no exact contacts were proved to exist, and no dual closer to its bound was proved to keep it"
        digits = f"{self.reached} of the {self.digits} digits asked for"
        return f"the optimum lies between lower and upper for certain, but these agree to {digits} only: {why}"


def solve(problem: GuaranteedProblem, digits: int = 30) -> GuaranteedSolution:
    """The guaranteed estimator and an enclosure of its standard deviation to ``digits`` digits.

    Raises NotEstimableError with a null direction when the measurements do not determine the
    functional, TooLargeError for functions that cannot be resolved, and a NavsymError of kind
    ``"domain"`` for digits outside 1 … 1000.
    """
    if not 1 <= digits <= MOST_DIGITS:
        message = f"digits: expected 1 to {MOST_DIGITS}; got {digits}; choose a number between"
        raise NavsymError(message, kind="domain")
    exact, kept, basis = independent(problem)
    found = certified(exact, digits, basis)
    unique = found.unique
    if unique is None and not problem.error:
        contacts, bound = find_contacts(basis.panels), found.dual
        unique = False if several_optimal(exact, contacts, bound) else only_optimal(exact, basis, contacts, bound)
    status = CERTIFIED if found.reaches(digits) else OPEN
    dual = ["0"] * len(problem.functional)
    for k, x in zip(kept, found.dual, strict=True):
        dual[k] = decimal(x, digits)
    certificate = with_error(problem, found.certificate)
    return GuaranteedSolution(
        problem,
        support_rows(problem, exact, found, digits),
        tuple(dual),
        found.certificate["lower"],
        found.certificate["upper"],
        unique,
        certificate,
        status,
        found.width,
        digits,
    )


def certified(exact: Problem, digits: int, basis: Basis) -> Certified:
    """The optimum and its certificate; of the same problem in other unknowns, where too much cancels in these."""
    other = separated(exact) if basis.loss >= FAR and not any(panel.values for panel in exact.panels) else None
    if other is None:
        return certify(exact, digits, basis)
    better = make_basis(other.problem)
    if better.loss >= basis.loss:
        return certify(exact, digits, basis)
    found = certify(other.problem, digits, better)
    with precision(int(3.34 * (digits + 2 * basis.loss)) + 128):
        return replace(found, dual=other.back(found.dual))


def with_error(problem: GuaranteedProblem, certificate: Mapping[str, Any]) -> Mapping[str, Any]:
    """The certificate; where regressors have an error, it holds for every value of it up to its bound."""
    if not problem.error:
        return certificate
    bound = to_text(problem.error)
    return {**certificate, "kind": "sliver", "parameter": ERROR.name, "from": f"-{bound}", "to": bound}


def support_rows(problem: GuaranteedProblem, exact: Problem, found: Certified, digits: int) -> tuple[Support, ...]:
    """Instants and weights of a certified solution as decimal strings, by measurement and time.

    Places v in [0, 1] on their panels become instants ``start + (end - start) v``.
    """
    rows = []
    with precision(int(3.4 * digits) + 128):
        for k, v, w in found.support:
            panel = exact.panels[k]
            name = problem.measurements[panel.measurement]
            start, end = panel.time(arb(0)), panel.time(arb(1))
            rows.append(
                (
                    float(panel.time(v).mid()),
                    Support(name, decimal(start + (end - start) * v, digits), decimal(w, digits)),
                )
            )
    return tuple(row for _, row in sorted(rows, key=lambda pair: (pair[1].measurement, pair[0])))


# -- unknowns that the measurements do not tell apart ----------------------------------------------


def independent(problem: GuaranteedProblem) -> tuple[Problem, list[int], Basis]:
    """The problem without unknowns whose regressors depend on the others, exactly.

    Returns the reduced problem, the unknowns that are left and its basis. Raises NotEstimableError.
    """
    kept = list(range(len(problem.functional)))
    while True:
        exact = restricted(problem, kept)
        try:
            return exact, kept, make_basis(exact)
        except DependentError as found:
            drop_dependent(problem, kept, found.index, found.relation)


def restricted(problem: GuaranteedProblem, kept: list[int]) -> Problem:
    """The problem with some of the unknowns only."""
    panels = tuple(
        replace(panel, functions=tuple(panel.functions[k] for k in kept)) for panel in problem.exact().panels
    )
    return Problem(panels, tuple(problem.functional[k] for k in kept))
