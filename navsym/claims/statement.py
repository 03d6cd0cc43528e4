"""What can be asserted: plain data with a printed and a derived side.

The printed side is what a paper or a user says. The derived side follows from a model by a
route of its own. Expressions are sympy objects without floating-point numbers; this file
only carries them and never looks inside, so that importing it costs nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from navsym.claims.display import SIGNS, display_latex, latex_of
from navsym.claims.formula import Formula, side_text
from navsym.claims.verdict import Status

#: Box: symbol -> (lower, upper), exact numbers, None for an end at infinity.
Box = Mapping[Any, tuple[Any, Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Written:
    """A statement as its author wrote it: what the checker reads, whatever the algebra makes of it.

    left, right : text of each entry
    exists      : text of what has to exist beside the sides
    tolerance   : text, or None
    symbols     : the symbols of all names in these texts
    """

    left: tuple[str, ...]
    right: tuple[str, ...]
    exists: tuple[str, ...] = ()
    tolerance: str | None = None
    symbols: tuple[Any, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Equation:
    """``printed = derived`` for all values of the symbols in the box.

    printed, derived : expressions, matrices of one shape, or sequences of expressions
    box              : ranges of the symbols; a symbol that is not named is any real number
                       (or any positive one, when it was declared positive)
    tolerance        : None for equality; an exact number for ``|printed - derived| <= tolerance``,
                       which is how a printed numeral is meant (half a unit of its last digit)
    nonzero          : expressions that the statement takes to be nonzero
    exists           : expressions that must have a value: points where one has none are not points of the
                       statement, though the algebra may have cancelled what is undefined there
    written          : the text of the statement, where it has one
    """

    printed: Any
    derived: Any
    box: Box = field(default_factory=dict)
    tolerance: Any = None
    nonzero: tuple[Any, ...] = ()
    exists: tuple[Any, ...] = ()
    written: Written | None = None

    def _repr_latex_(self) -> str:
        """Both sides for notebooks, with a question mark: a statement is not yet a verdict."""
        within = "" if self.tolerance is None else rf" \pm {latex_of(self.tolerance)}"
        return display_latex(rf"{latex_of(self.printed)}{within} \overset{{?}}{{=}} {latex_of(self.derived)}")


@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """``printed relation derived`` on the whole box; relation is one of ``= != < <= > >=``.

    The printed side stands on the left: ``Bound(det, "!=", 0, box)`` says that the printed
    determinant does not vanish anywhere in the box. ``exists``: as in :class:`Equation`.
    """

    printed: Any
    relation: str
    derived: Any
    box: Box = field(default_factory=dict)
    exists: tuple[Any, ...] = ()
    written: Written | None = None

    def _repr_latex_(self) -> str:
        sign = rf"\overset{{?}}{{{SIGNS.get(self.relation, self.relation)}}}"
        return display_latex(f"{latex_of(self.printed)} {sign} {latex_of(self.derived)}")


@dataclass(frozen=True, slots=True, eq=False)
class Optimum:
    """A printed solution of the guaranteed-estimation problem and of its dual.

    Minimise ``integral |Phi|`` subject to ``integral H(t) Phi(t) dt = functional`` over
    ``interval``; dual: maximise ``x . functional`` subject to ``|x . H(t)| <= 1``.

    regressors : derived H(t), one expression per unknown
    functional : P
    variable   : the symbol t
    interval   : (start, end)
    dual       : printed x
    support    : printed instants
    weights    : printed weights, one per instant
    value      : printed optimal value (for a noise bound of one)
    box        : ranges of the parameters
    """

    regressors: tuple[Any, ...]
    functional: tuple[Any, ...]
    variable: Any
    interval: tuple[Any, Any]
    dual: tuple[Any, ...]
    support: tuple[Any, ...]
    weights: tuple[Any, ...]
    value: Any
    box: Box = field(default_factory=dict)

    def _repr_latex_(self) -> str:
        """The problem, and the solution that is asserted."""
        t, (start, end) = latex_of(self.variable), self.interval
        over = rf"\int_{{{latex_of(start)}}}^{{{latex_of(end)}}}"
        problem = rf"\min {over} |\Phi|\,d{t}, \quad {over} {latex_of(self.regressors)}^T\, \Phi\,d{t} = "
        found = rf"{latex_of(self.weights)} \text{{ at }} {latex_of(self.support)}"
        answer = rf"{latex_of(self.functional)}^T: \quad {found}"
        return display_latex(rf"{problem}{answer}, \quad \text{{value }} {latex_of(self.value)}")


#: The value of a finding whose method did not decide: the claim is then OPEN, whatever is printed.
UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """A derived fact that an exact method has decided: a rank, a count, yes or no.

    value       : an exact, comparable value (bool, int, Fraction, str, tuple of these); :data:`UNDECIDED`, or a tuple
                  that holds it, where the method did not decide
    status      : how strongly the method decided it (PROVED, CERTIFIED or CONFIRMED)
    method, scope, assumptions, evidence, certificate : as in a verdict
    """

    value: Any
    method: str
    status: Status
    scope: str = ""
    assumptions: tuple[str, ...] = ()
    evidence: str = ""
    certificate: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Property:
    """A printed fact in words, as a value, beside the value that was found.

    printed : what the paper says, for example ``True``, ``3`` or ``"three instants"``
    derived : a :class:`Finding` whose value is compared with it
    meaning : what the printed fact says, as statements that the checker reads (:func:`state`); empty where it has no
              words for it
    unsaid  : without a meaning, why: what the language of the checker lacks
    """

    printed: Any
    derived: Finding
    meaning: tuple[Mapping[str, Any], ...] = ()
    unsaid: str = ""

    def _repr_latex_(self) -> str:
        return display_latex(rf"{latex_of(self.printed)} \overset{{?}}{{=}} {latex_of(self.derived.value)}")


def fact(
    printed: Any, value: Any, method: str, status: Status, *, unsaid: str = "", meaning: Any = (), **found: Any
) -> Property:
    """A :class:`Property` of a printed fact and of the value that a method found, with the parts of a :class:`Finding`.

    >>> fact(2, 2, "a count", Status.PROVED, scope="one list").derived.value
    2
    """
    return Property(printed, Finding(value, method, status, **found), tuple(meaning), unsaid)


@dataclass(frozen=True, slots=True, eq=False)
class Worded(Property):
    """Whether a formula in the words of files holds, with that formula and a point where it fails.

    is_whole : the formula is what is printed, and not only its left side
    """

    formula: Formula = field(kw_only=True)
    counterexample: Mapping[str, Any] = field(default_factory=dict, kw_only=True)
    is_whole: bool = field(default=False, kw_only=True)

    @property
    def sides(self) -> tuple[str, str]:
        """Both sides of an equation; of another relation, a chain or a whole formula all of it, and nothing."""
        formula = self.formula
        if self.is_whole or formula.chain or formula.relation != "=" or formula.order:
            return str(formula), ""
        within = "" if formula.tolerance is None else f" +- {formula.tolerance}"
        return side_text(formula.left) + within, side_text(formula.right)

    def _repr_latex_(self) -> str:
        return self.formula._repr_latex_()


Statement = Equation | Bound | Optimum | Property


def state(left: str, relation: str, right: str, symbols: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """One formula as a statement of the checker (docs/certificates.md), for the meaning of a property.

    symbols : name -> [low, high, flags]

    >>> state("x**2", ">=", "x", {"x": ["1", None, []]})["relation"]
    '>='
    """
    sides = {"left": left, "relation": relation, "right": right}
    return {**sides, "symbols": dict(symbols or {}), "exists": [], "tolerance": None}


def certify_at_sight(text: Mapping[str, Any]) -> dict[str, Any]:
    """The certificate of a statement that its normal form shows, or balls on its ranges; true at their lower ends.

    A matrix on the right stands there by its entries.

    >>> certify_at_sight(state("2 + 2", "=", "4"))["proofs"]
    [{'rule': 'identity'}]
    """
    rule = {"rule": "identity"} if text["relation"] == "=" else {"rule": "balls", "bits": 128, "cells": 100}
    witness = {name: ends[0] or "1" for name, ends in text["symbols"].items()}
    proofs = [rule] * (1 + text["right"].count(","))
    return {"kind": "proof", "statement": text, "bits": 128, "witness": witness, "proofs": proofs}
