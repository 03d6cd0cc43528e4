"""navsym: derive, decide, solve and export the theory of inertial-navigation aiding.

    >>> import navsym as nav
    >>> nav.prove("sin(2*a) = 2*sin(a)*cos(a)").status
    <Status.PROVED: 'PROVED'>

Every verb of the command line is one function here, with the same words; text, sympy expressions and exact numbers
go in; answers are frozen objects with plain attributes that show themselves in a notebook. ``answer.document()`` is the
JSON that the verb prints. A wrong argument raises :class:`NavsymError` with its kind, its place, and a sentence of the
form *expected …; got …; remedy*.

A first session
---------------

    >>> nav.prove("sin(T) <= T", T=("0", "pi")).status
    <Status.PROVED: 'PROVED'>
    >>> model = nav.Model(states="y1 y2 y3", F=[["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    ...                   H=[["1", "0", "0"]], sigma=["1"], interval="T", targets={"drift": "y3"}, T=("0", "2*pi"))
    >>> drift = nav.solve(model, "drift", T="pi/2")
    >>> print(drift.value)
    4.82842712474619009760337744841939

Conventions
-----------

* Radians, seconds and metres; degrees and hours only in reports, printed numerals and files that say so. A quantity of
  pint, or a value such as ``"90 min"``, is converted to the unit that is declared, else to SI.
* Local axes are east, north, up (x, y, z) unless a model names others. An error is estimate minus truth; an innovation
  is measurement minus prediction. Where a formula needs quaternions they are Hamilton's, scalar first.
* ``dx/dt = F x``, ``z = H x + r``; Phi carries a state forward; P, Q and R are covariances.
* Time runs from 0 to T, the length of the interval; a target is a functional of the state at T.
* ``sigma`` bounds the standard deviation of a measurement, whatever the correlation of its errors.
* Rows of ``mode_transition`` mean *from* and sum to one. A filter starts at step 0; its first measurement is at step 1.
* ``heights[row, column]``: a row is a line of constant y, x runs with the columns.
* Exact numbers are text (``"1/10"``, ``"0.1"``), integers or fractions; a float is refused where an exact number is
  meant. A certified number is a :class:`Number` with ``lower`` and ``upper``; a plain float is a float.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0"

#: Public name -> module that holds it. A module is imported when its name is first used, and its engines with it.
_HOMES = {
    "Model": "navsym.models.model",
    "atlas": "navsym.studies.atlas.kept",
    "audit": "navsym.audit.answer",
    "book": "navsym.book.entries",
    **dict.fromkeys(("Derivation", "derive"), "navsym.models.derivation"),
    **dict.fromkeys(("Observability", "observe"), "navsym.observability.answer"),
    **dict.fromkeys(("Block", "BlockEstimator", "solve_blocks"), "navsym.guaranteed.blocks"),
    "Comparison": "navsym.guaranteed.baselines",
    **dict.fromkeys(("Design", "design"), "navsym.guaranteed.design"),
    "Estimator": "navsym.guaranteed.solver",
    "Formulation": "navsym.guaranteed.formulate",
    "Guard": "navsym.guaranteed.streaming.guard",
    "Estimate": "navsym.guaranteed.streaming.estimate",
    "NavsymError": "navsym.core.errors",
    "Number": "navsym.core.numbers",
    **dict.fromkeys(("PhaseMap", "Phases"), "navsym.guaranteed.phases.answer"),
    "formulate": "navsym.guaranteed.formulate",
    "phases": "navsym.guaranteed.phases.front",
    "solve": "navsym.guaranteed.solver",
    **dict.fromkeys(
        ("Verdict", "Verdicts", "Status", "PROVED", "CERTIFIED", "CONFIRMED", "REFUTED", "OPEN"), "navsym.claims"
    ),
    "init": "navsym.claims.workspace",
    "prove": "navsym.prove.formulas",
    **dict.fromkeys(("Reading", "read"), "navsym.language.latex.reading"),
    **dict.fromkeys(("new_claim", "new_paper"), "navsym.prove.drafts"),
    "Bank": "navsym.multimodel.bank",
    "Conventions": "navsym.conventions.answer",
    "conventions": "navsym.verification.error_models",
    "condition": "navsym.trajectory.conditioning",
    "data": "navsym.core.datasets",
    "filter": "navsym.multimodel.filters",
    "limits": "navsym.trajectory.limits",
    "locate": "navsym.terrain.locate",
    "simulate": "navsym.studies.experiments",
    "sweep": "navsym.studies.run",
    "track": "navsym.trajectory.motion",
    **dict.fromkeys(("show", "verify"), "navsym.verification.decide"),
    "Ledger": "navsym.verification.ledger",
    "check": "navsym.export.acceptance",
    "cite": "navsym.report.citation",
    "claims": "navsym.report.listing",
    "diff": "navsym.export.differences",
    "compare": "navsym.export.compare",
    "doctor": "navsym.core.machine",
    "explain": "navsym.report.explain",
    **dict.fromkeys(("ProgressBar", "explore"), "navsym.report.notebook"),
    "export": "navsym.export.driver",
    "plot": "navsym.report.plots",
    "report": "navsym.report.site",
}

__all__ = ["__version__", *sorted(_HOMES)]

#: Types of answers and of parts of problems, for annotations. ``dir(navsym)`` leaves them out: it lists what one calls.
_ANSWERS = {
    *("Bank", "Block", "BlockEstimator", "Comparison", "Conventions", "Derivation", "Design", "Estimate", "Estimator"),
    *("Formulation", "Ledger", "Observability", "PhaseMap"),
    *("Number", "Phases", "ProgressBar", "Reading", "Status", "Verdict", "Verdicts"),
}

if TYPE_CHECKING:
    from navsym.audit.answer import audit as audit
    from navsym.book.entries import book as book
    from navsym.claims import CERTIFIED as CERTIFIED
    from navsym.claims import CONFIRMED as CONFIRMED
    from navsym.claims import OPEN as OPEN
    from navsym.claims import PROVED as PROVED
    from navsym.claims import REFUTED as REFUTED
    from navsym.claims import Status as Status
    from navsym.claims import Verdict as Verdict
    from navsym.claims import Verdicts as Verdicts
    from navsym.claims.workspace import init as init
    from navsym.conventions.answer import Conventions as Conventions
    from navsym.core.datasets import data as data
    from navsym.core.errors import NavsymError as NavsymError
    from navsym.core.machine import doctor as doctor
    from navsym.core.numbers import Number as Number
    from navsym.export.acceptance import check as check
    from navsym.export.compare import compare as compare
    from navsym.export.differences import diff as diff
    from navsym.export.driver import export as export
    from navsym.guaranteed.baselines import Comparison as Comparison
    from navsym.guaranteed.blocks import Block as Block
    from navsym.guaranteed.blocks import BlockEstimator as BlockEstimator
    from navsym.guaranteed.blocks import solve_blocks as solve_blocks
    from navsym.guaranteed.design import Design as Design
    from navsym.guaranteed.design import design as design
    from navsym.guaranteed.formulate import Formulation as Formulation
    from navsym.guaranteed.formulate import formulate as formulate
    from navsym.guaranteed.phases.answer import PhaseMap as PhaseMap
    from navsym.guaranteed.phases.answer import Phases as Phases
    from navsym.guaranteed.phases.front import phases as phases
    from navsym.guaranteed.solver import Estimator as Estimator
    from navsym.guaranteed.solver import solve as solve
    from navsym.guaranteed.streaming.estimate import Estimate as Estimate
    from navsym.guaranteed.streaming.guard import Guard as Guard
    from navsym.language.latex.reading import Reading as Reading
    from navsym.language.latex.reading import read as read
    from navsym.models.derivation import Derivation as Derivation
    from navsym.models.derivation import derive as derive
    from navsym.models.model import Model as Model
    from navsym.multimodel.bank import Bank as Bank
    from navsym.multimodel.filters import filter as filter
    from navsym.observability.answer import Observability as Observability
    from navsym.observability.answer import observe as observe
    from navsym.prove.drafts import new_claim as new_claim
    from navsym.prove.drafts import new_paper as new_paper
    from navsym.prove.formulas import prove as prove
    from navsym.report.citation import cite as cite
    from navsym.report.explain import explain as explain
    from navsym.report.listing import claims as claims
    from navsym.report.notebook import ProgressBar as ProgressBar
    from navsym.report.notebook import explore as explore
    from navsym.report.plots import plot as plot
    from navsym.report.site import report as report
    from navsym.studies.atlas.kept import atlas as atlas
    from navsym.studies.experiments import simulate as simulate
    from navsym.studies.run import sweep as sweep
    from navsym.terrain.locate import locate as locate
    from navsym.trajectory.conditioning import condition as condition
    from navsym.trajectory.limits import limits as limits
    from navsym.trajectory.motion import track as track
    from navsym.verification.decide import show as show
    from navsym.verification.decide import verify as verify
    from navsym.verification.error_models import conventions as conventions
    from navsym.verification.ledger import Ledger as Ledger


class _FrontDoor(ModuleType):
    """The package itself: a function and a folder may share a name (``prove``, ``export``), and the function is shown.

    Importing ``navsym.prove.equations`` would bind the folder here and hide the function.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if not (isinstance(value, ModuleType) and name in _HOMES):
            super().__setattr__(name, value)


def __getattr__(name: str) -> Any:
    """A public name, imported when it is first asked for (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module 'navsym' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(_HOMES[name]), name)
    setattr(sys.modules[__name__], name, value)
    return value


def load_ipython_extension(shell: Any) -> None:
    """``%load_ext navsym`` in a notebook: ``%prove`` decides a formula, ``%%claims`` a cell of them."""
    from importlib import import_module

    import_module("navsym.cli._magics").register_magics(shell)


def __dir__() -> list[str]:
    return [name for name in __all__ if name not in _ANSWERS]


sys.modules[__name__].__class__ = _FrontDoor
