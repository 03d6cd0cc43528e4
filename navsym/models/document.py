"""A derivation as plain data and as LaTeX, and the certificates of its matrices."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from navsym.core.errors import NavsymError
from navsym.language.printer import to_text
from navsym.models.derivation import Conditions, Derivation, PieceRegressors

Writer = Callable[[sp.Basic], str]


def document_of_derivation(derivation: Derivation, *, latex: bool = False) -> dict[str, Any]:
    """Plain data with expressions in the language of files; ``latex`` adds the same formulas in LaTeX."""
    data = write_formulas(derivation, formula_or_relation)
    if latex:
        data["latex"] = write_formulas(derivation, sp.latex)
    return data


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
    return {
        "name": derivation.name,
        "states": list(derivation.states),
        "measurements": [
            {"name": name, "sigma": write(sigma)}
            for name, sigma in zip(derivation.measurements, derivation.sigmas, strict=True)
        ],
        "F": [write_rows(F, write) for F in derivation.system],
        "transition": [
            {
                "time": write(t.time),
                "matrix": write_rows(t.matrix, write),
                "characteristic": [
                    {"factor": write(factor), "multiplicity": times, "form": kind} for factor, times, kind in t.factors
                ],
            }
            for t in derivation.transition
        ],
        "regressors": [piece_data(derivation, piece, write) for piece in derivation.pieces],
        "observability_matrix": (
            None if derivation.observability_matrix is None else write_rows(derivation.observability_matrix, write)
        ),
        "conditions": [condition_data(derivation, c, write) for c in derivation.conditions],
        "assumptions": [write(relation) for relation in derivation.assumptions],
    }


def write_rows(matrix: sp.MatrixBase, write: Writer) -> list[list[str]]:
    """A matrix as rows of texts."""
    return [[write(entry) for entry in row] for row in matrix.tolist()]


def piece_data(derivation: Derivation, piece: PieceRegressors, write: Writer) -> dict[str, Any]:
    """H on one piece, with the ends between which it holds."""
    return {
        "variable": write(derivation.time),
        "from": write(piece.start),
        "to": write(piece.end),
        "H": write_rows(piece.rows, write),
    }


def condition_data(derivation: Derivation, conditions: Conditions, write: Writer) -> dict[str, Any]:
    """The equations of the contacts, for one target."""
    return {
        "target": conditions.target,
        "functional": [write(entry) for entry in conditions.functional],
        "dual_polynomial": [[write(f) for f in polynomials] for polynomials in conditions.dual],
        "slope": [[write(f) for f in slopes] for slopes in conditions.slope],
        "value": write(sp.Add(*(x * p for x, p in zip(derivation.multipliers, conditions.functional, strict=True)))),
    }


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


# Certificates of linear systems: a transition matrix, the rank of a matrix with parameters.


TRIALS = 8


def derivation_certificates(derivation: Derivation) -> list[Mapping[str, Any]]:
    """Proofs of the transition matrix of every piece and of the rank of the observability matrix, as far as known."""
    pairs = zip(derivation.system, derivation.transition, strict=True)
    parts = [exponential_certificate(F, Phi.matrix, Phi.time) for F, Phi in pairs]
    if derivation.observability_matrix is not None:
        parts.append(rank_certificate(derivation.observability_matrix))
    return [part for part in parts if part is not None]


def exponential_certificate(F: sp.MatrixBase, Phi: sp.MatrixBase, time: sp.Symbol) -> dict[str, Any] | None:
    """``Phi = exp(F time)``, that is ``Phi' = F Phi`` and ``Phi(0) = I``; None outside the language of files.

    F, Phi : (n, n), symbols for parameters; ``time`` occurs in Phi only
    """
    symbols = sorted({s.name for s in F.free_symbols | Phi.free_symbols} - {time.name})
    try:
        return {
            "kind": "exponential",
            "matrix": matrix_texts(F),
            "solution": matrix_texts(Phi),
            "variable": time.name,
            "symbols": symbols,
        }
    except NavsymError:
        return None


def rank_certificate(M: sp.MatrixBase) -> dict[str, Any] | None:
    """The generic rank of a matrix of rational functions, with null vectors and a point that attains it.

    M : (p, n). What is found here by the computer algebra system is a proposal; the checker multiplies and proves it.
    None where no point of a few shows the rank.
    """
    null = M.nullspace()
    rank = M.cols - len(null)
    for point in trial_points(sorted(M.free_symbols, key=str)):
        here = M.subs(point)
        rows = here.T.rref()[1] if all(x.is_Rational for x in here) else ()
        if len(rows) == rank and sp.Matrix([*(here.row(k) for k in rows), *(v.subs(point).T for v in null)]).det() != 0:
            return {
                "kind": "rank",
                "matrix": matrix_texts(M),
                "symbols": sorted(s.name for s in M.free_symbols),
                "rank": rank,
                "point": {s.name: to_text(value) for s, value in point.items()},
                "rows": [int(k) for k in rows],
                "null": [[to_text(sp.factor(x)) for x in v] for v in null],
            }
    return None


def trial_points(symbols: Sequence[sp.Symbol]) -> Iterator[dict[sp.Symbol, sp.Rational]]:
    """A few rational points with unlike coordinates."""
    for k in range(1, TRIALS + 1):
        yield {s: sp.Rational(sp.prime(2 * i + k + 3), i + k + 1) for i, s in enumerate(symbols)}


def matrix_texts(M: sp.MatrixBase) -> list[list[str]]:
    return [[to_text(entry) for entry in M.row(i)] for i in range(M.rows)]
