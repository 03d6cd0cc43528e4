"""Everything that follows from a model before an estimator is chosen.

From dx/dt = F x and z_j = h_j x + r_j on [0, T]: the transition matrix, the measurements referred to
the state at the end, the observability matrix, and the conditions that an optimal guaranteed
estimate satisfies. They are the duality of two programmes for a functional P^T x(T):

    minimise  sum_j sigma_j int |Phi_j|   subject to  sum_j int H_j Phi_j = P,
    maximise  x . P                       subject to  |x . H_j(tau)| <= sigma_j  on [0, T].

At the optimum the weights sit where a dual polynomial f_j = x . H_j touches its bound.
Lidov 1964; Karlin and Studden, Tchebycheff Systems, chapter 2.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import sympy as sp

from navsym.claims.display import display_latex, write_card
from navsym.core.answers import Answer
from navsym.core.errors import DomainError, NavsymError, ShapeError
from navsym.language.files import file_in_errors
from navsym.language.printer import to_text
from navsym.models.certificates import exponential_certificate, rank_certificate
from navsym.models.linear import LinearModel, observability_matrix
from navsym.models.model import Model, contents_of
from navsym.models.modelfile import BasisFile, ModelFile, piece_model
from navsym.models.transition.exponential import (
    TransitionMatrix,
    need_constant,
    regressors,
    spread_products,
    transition_matrix,
)

#: Names tried for the time of a measurement and for the multipliers, until one is free.
TIMES = ("tau", "s", "theta", "instant")
MULTIPLIERS = ("x", "lambda_", "multiplier")


@dataclass(frozen=True, slots=True, eq=False)
class PieceRegressors:
    """Regressors on one piece of the interval: rows (p, n), valid for start <= tau <= end."""

    start: sp.Expr
    end: sp.Expr
    rows: sp.ImmutableMatrix


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """Optimality of one target: functional P, dual polynomials f_j and slopes f_j', one row per piece."""

    target: str
    functional: tuple[sp.Expr, ...]
    dual: tuple[tuple[sp.Expr, ...], ...]
    slope: tuple[tuple[sp.Expr, ...], ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Derivation(Answer):
    """Everything that follows from a model before an estimator is chosen.

    states, measurements, sigmas : names and bounds, as the model gives them
    pieces        : H_j(tau), rows (p, n) on each piece of the interval
    time, end     : tau and T
    multipliers   : x, one per unknown
    conditions    : per target, the conditions of an optimal guaranteed estimate
    system        : F (n, n), one matrix per piece; empty for regressors
    transition    : exp(F t) per piece, with the factors of its characteristic polynomial; empty for regressors
    observability_matrix : rows H, H F, ... (n p, n); None for regressors or several pieces
    assumptions   : what the formulas take to hold

    >>> import navsym as nav
    >>> nav.derive("examples/schuler-velocity.toml").Phi[1, :]
    Matrix([[0, cos(t), sin(t)]])
    """

    name: str
    states: tuple[str, ...]
    measurements: tuple[str, ...]
    sigmas: tuple[sp.Expr, ...]
    pieces: tuple[PieceRegressors, ...]
    time: sp.Symbol
    end: sp.Expr
    multipliers: tuple[sp.Symbol, ...]
    conditions: tuple[Conditions, ...]
    system: tuple[sp.ImmutableMatrix, ...] = ()
    transition: tuple[TransitionMatrix, ...] = ()
    observability_matrix: sp.ImmutableMatrix | None = None
    assumptions: tuple[sp.Basic, ...] = ()

    @property
    def F(self) -> sp.ImmutableMatrix:
        """Matrix of the system (n, n). Raises ShapeError for several pieces, DomainError for regressors."""
        return self._only("system", self.system)

    @property
    def Phi(self) -> sp.ImmutableMatrix:
        """Transition matrix exp(F t) (n, n). Raises as :attr:`F`."""
        return self._only("transition", tuple(t.matrix for t in self.transition))

    @property
    def H(self) -> sp.ImmutableMatrix:
        """Measurements referred to the state at T: rows H_j(tau) (p, n). Raises ShapeError for several pieces."""
        return self._only("pieces", tuple(piece.rows for piece in self.pieces))

    def _only(self, name: str, matrices: tuple[sp.ImmutableMatrix, ...]) -> sp.ImmutableMatrix:
        """The matrix of a model in one piece."""
        if not matrices:
            raise DomainError("expected a model with F; got a basis of regressors; give the system", where=self.name)
        if len(matrices) > 1:
            raise ShapeError(f"expected one piece; got {len(matrices)}; use {name}, one by one", where=self.name)
        return matrices[0]

    def document(self, *, latex: bool = False) -> dict[str, Any]:
        """The JSON document of ``navsym derive``; ``latex`` adds the same formulas in LaTeX."""
        data = write_formulas(self, formula_or_relation)
        return data | ({"latex": write_formulas(self, sp.latex)} if latex else {})

    def certificates(self) -> list[Mapping[str, Any]]:
        """Proofs of exp(F t) on each piece, and of the rank of the observability matrix."""
        pairs = zip(self.system, self.transition, strict=True)
        parts = [exponential_certificate(F, Phi.matrix, Phi.time) for F, Phi in pairs]
        if self.observability_matrix is not None:
            parts.append(rank_certificate(self.observability_matrix))
        return [part for part in parts if part is not None]

    def latex(self) -> str:
        """All formulas as LaTeX, one display for each."""
        return "\n".join(f"\\[\n  {show}\n\\]" for show in latex_displays(self)) + "\n"

    def __repr__(self) -> str:
        factors = [kind for t in self.transition for _, _, kind in t.factors]
        targets = ", ".join(c.target for c in self.conditions)
        kinds = f", {', '.join(dict.fromkeys(factors))} factors" if factors else ""
        return f"Derivation({self.name}: {len(self.states)} unknowns{kinds}; conditions for {targets})"

    def _repr_html_(self) -> str:
        """A card for notebooks: the name, and every formula on a line of its own."""
        lines = (escape(display_latex(show)) for show in latex_displays(self))
        return write_card([f"<b>{escape(self.name)}</b>: {escape(', '.join(self.states))}", *lines])

    def _repr_latex_(self) -> str:
        """All formulas, one below the other, for notebooks."""
        return "\n\n".join(f"$$ {show} $$" for show in latex_displays(self))


def derive(
    model: Model | LinearModel | str | os.PathLike[str], *, values: Mapping[str, Any] | None = None, **parameters: Any
) -> Derivation:
    """Transition matrix, regressors, observability matrix and conditions of optimality of a model.

    With dx/dt = F x and z_j = h_j x + r_j on [0, T]: ``Phi = exp(F t)``, ``H_j(tau) = h_j exp(F (tau - T))``, and an
    estimate of P^T x(T) is optimal when its weights sit where ``f_j = x . H_j`` touches ``+-sigma_j`` (Lidov 1964).

    model      : a :class:`navsym.Model`, a LinearModel, or the path of a model file; regressors have conditions only
    parameters : exact values of parameters, such as ``w="1/2"``; ``values`` is the same as a mapping

    Raises DomainError when F varies with the time, or has a repeated factor without a closed form.

    >>> import navsym as nav
    >>> swing = nav.Model("x v", F=[[0, 1], ["-w**2", 0]], H=["x"], interval="T", w="positive", T="positive")
    >>> derivation = nav.derive(swing)
    >>> derivation.Phi[0, 0], derivation.H
    (cos(t*w), Matrix([[cos(w*(T - tau)), -sin(w*(T - tau))/w]]))
    >>> derivation.observability_matrix
    Matrix([
    [1, 0],
    [0, 1]])
    """
    with file_in_errors(model):
        found = contents_of(model, values, parameters, "derive")
        return derive_basis(found) if isinstance(found, BasisFile) else derive_model(found)


def derive_model(found: ModelFile) -> Derivation:
    """Like :func:`derive` for a system, in one piece or several."""
    models = tuple(piece_model(found, piece.F) for piece in found.pieces)
    for model in models:
        need_constant(model, matrix_only=True)
    taken = {str(symbol) for symbol in symbols_in_model(found)} | set(found.states)
    free = next(name for zeros in itertools.count() if (name := "T" + zeros * "0") not in taken)
    end = found.T if found.T is not None else sp.Symbol(free, positive=True)
    tau = sp.Symbol(next(name for name in TIMES if name not in taken), real=True)
    pieces, backward = regressors_of_pieces(found, models, tau, end)
    transition = tuple(transition_matrix(model.F, found.time) for model in models)
    multipliers = multipliers_of(len(found.states), taken | {str(tau)})
    noted = [t.assumptions for t in (*transition, *backward)]
    return Derivation(
        name=found.name,
        states=found.states,
        measurements=tuple(m.name for m in found.measurements),
        sigmas=tuple(m.sigma for m in found.measurements),
        system=tuple(model.F for model in models),
        transition=transition,
        pieces=pieces,
        time=tau,
        end=end,
        multipliers=multipliers,
        observability_matrix=observability_matrix(models[0]) if len(models) == 1 else None,
        conditions=optimality_conditions(found.targets.items(), pieces, multipliers, tau),
        assumptions=tuple(dict.fromkeys(relation for relations in noted for relation in relations)),
    )


def derive_basis(found: BasisFile) -> Derivation:
    """Like :func:`derive` for regressors without a system: only the conditions are left to derive."""
    unknowns = len(found.H[0])
    rows = sp.ImmutableMatrix(found.H)
    taken = {str(symbol) for symbol in rows.free_symbols} | {str(found.variable)}
    multipliers = multipliers_of(unknowns, taken)
    pieces = (PieceRegressors(*found.interval, rows),)
    return Derivation(
        name=found.name,
        states=tuple(f"q{k + 1}" for k in range(unknowns)),
        measurements=tuple(f"z{j + 1}" for j in range(len(found.H))),
        sigmas=found.sigma,
        pieces=pieces,
        time=found.variable,
        end=found.interval[1],
        multipliers=multipliers,
        conditions=optimality_conditions(found.targets.items(), pieces, multipliers, found.variable),
    )


def regressors_of_pieces(
    found: ModelFile, models: tuple[LinearModel, ...], time: sp.Symbol, end: sp.Expr
) -> tuple[tuple[PieceRegressors, ...], list[TransitionMatrix]]:
    """H on each piece, from the last to the first: what lies behind is undone piece by piece."""
    pieces: list[PieceRegressors] = []
    undone: list[TransitionMatrix] = []
    behind = sp.ImmutableMatrix.eye(len(found.states))
    for piece, model in reversed(list(zip(found.pieces, models, strict=True))):
        stop = end if piece.end is None else piece.end
        here = regressors(model, stop, time)
        rows = (here.matrix * behind).applyfunc(spread_products)
        pieces.insert(0, PieceRegressors(piece.start, stop, rows))
        whole = transition_matrix(-model.F, stop - piece.start)
        undone.append(whole)
        behind = whole.matrix * behind
    return tuple(pieces), undone


def optimality_conditions(
    targets: Iterable[tuple[str, tuple[sp.Expr, ...]]],
    pieces: tuple[PieceRegressors, ...],
    multipliers: tuple[sp.Symbol, ...],
    time: sp.Symbol,
) -> tuple[Conditions, ...]:
    """The conditions of every target; the dual polynomials are the same for all, the functional differs."""
    x = sp.Matrix(multipliers)
    dual = tuple(tuple(piece.rows * x) for piece in pieces)
    slope = tuple(tuple(f.diff(time) for f in polynomials) for polynomials in dual)
    return tuple(Conditions(name, functional, dual, slope) for name, functional in targets)


def symbols_in_model(found: ModelFile) -> set[sp.Symbol]:
    """Every symbol that the file uses or declares."""
    declared = {parameter.symbol for parameter in found.parameters.values()}
    matrices = [piece.F.free_symbols for piece in found.pieces]
    rows = [entry.free_symbols for measurement in found.measurements for entry in measurement.h]
    return declared.union({found.time}, *matrices, *rows)


def multipliers_of(count: int, taken: set[str]) -> tuple[sp.Symbol, ...]:
    """x1, x2, ... under a letter that nothing else uses."""
    for letter in MULTIPLIERS:
        names = [f"{letter}{k + 1}" for k in range(count)]
        if not taken & set(names):
            return tuple(sp.Symbol(name, real=True) for name in names)
    letters = ", ".join(MULTIPLIERS)
    raise DomainError(f"parameters: expected a free letter of {letters}; got all of them taken; rename one")


# Formulas as text

Writer = Callable[[sp.Basic], str]


def formula_or_relation(expression: sp.Basic) -> str:
    """An expression or relation in the language of files; sums over roots as sympy writes them."""
    if isinstance(expression, sp.core.relational.Relational):
        return f"{formula_or_relation(expression.lhs)} {expression.rel_op} {formula_or_relation(expression.rhs)}"
    try:
        return to_text(expression)
    except NavsymError:
        return str(expression)


def write_formulas(derivation: Derivation, write: Writer) -> dict[str, Any]:
    """All formulas, written one by one."""
    d = derivation
    measured = zip(d.measurements, d.sigmas, strict=True)
    found: dict[str, Any] = {
        "name": d.name,
        "states": d.states,
        "measurements": [{"name": name, "sigma": sigma} for name, sigma in measured],
        "F": d.system,
        "transition": [
            {
                "time": t.time,
                "matrix": t.matrix,
                "characteristic": [{"factor": f, "multiplicity": times, "form": kind} for f, times, kind in t.factors],
            }
            for t in d.transition
        ],
        "regressors": [{"variable": d.time, "from": p.start, "to": p.end, "H": p.rows} for p in d.pieces],
        "observability_matrix": d.observability_matrix,
        "conditions": [
            {
                "target": c.target,
                "functional": c.functional,
                "dual_polynomial": c.dual,
                "slope": c.slope,
                "value": sp.Add(*(x * p for x, p in zip(d.multipliers, c.functional, strict=True))),
            }
            for c in d.conditions
        ],
        "assumptions": d.assumptions,
    }
    return {key: write_all(value, write) for key, value in found.items()}


def write_all(value: Any, write: Writer) -> Any:
    """Plain data with every formula in it written; a matrix by rows."""
    if isinstance(value, sp.MatrixBase):
        return write_all(value.tolist(), write)
    if isinstance(value, dict):
        return {key: write_all(part, write) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [write_all(part, write) for part in value]
    return write(value) if isinstance(value, sp.Basic) else value


# LaTeX


def latex_displays(derivation: Derivation) -> list[str]:
    """Every formula of a derivation in LaTeX, one for each display."""
    tex = write_formulas(derivation, sp.latex)
    shows = [f"F = {matrix_in_parentheses(F)}" for F in tex["F"]]
    shows += [f"\\Phi({t['time']}) = {matrix_in_parentheses(t['matrix'])}" for t in tex["transition"]]
    for piece in tex["regressors"]:
        v = piece["variable"]
        shows += [
            f"H_{{{j + 1}}}({v}) = {matrix_in_parentheses([[entry] for entry in row])}, "
            f"\\quad {piece['from']} \\le {v} \\le {piece['to']}"
            for j, row in enumerate(piece["H"])
        ]
    if tex["observability_matrix"]:
        shows.append(f"\\mathcal{{O}} = {matrix_in_parentheses(tex['observability_matrix'])}")
    return [*shows, *condition_displays(tex), *tex["assumptions"]]


def matrix_in_parentheses(rows: list[list[str]]) -> str:
    """Rows of LaTeX as a matrix in parentheses."""
    return "\\begin{pmatrix} " + " \\\\ ".join(" & ".join(row) for row in rows) + " \\end{pmatrix}"


def condition_displays(tex: dict[str, Any]) -> list[str]:
    """Dual polynomials with their bounds and slopes, unbiasedness, and the value of each target."""
    if not tex["conditions"]:
        return []
    shows, first = [], tex["conditions"][0]
    for piece, duals, slopes in zip(tex["regressors"], first["dual_polynomial"], first["slope"], strict=True):
        v = piece["variable"]
        for j, (m, f, slope) in enumerate(zip(tex["measurements"], duals, slopes, strict=True), start=1):
            shows += [
                f"f_{{{j}}}({v}) = {f}, \\quad |f_{{{j}}}({v})| \\le {m['sigma']}",
                f"f_{{{j}}}({v}_k) = \\pm {m['sigma']}, \\quad f_{{{j}}}'({v}) = {slope}",
            ]
    v = tex["regressors"][0]["variable"]
    shows.append(f"\\sum_k \\varphi_k H({v}_k) = P, \\quad \\varphi_k f({v}_k) \\ge 0")
    return shows + [
        f"P = {matrix_in_parentheses([[entry] for entry in c['functional']])}, \\quad \\max\\, {c['value']}"
        for c in tex["conditions"]
    ]
