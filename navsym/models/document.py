"""A derivation as plain data for programs, as text for people, and as LaTeX."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import sympy as sp

from navsym.core.errors import NavsymError
from navsym.language.printer import to_text
from navsym.models.derivation import Conditions, Derivation, Stretch

Writer = Callable[[sp.Basic], str]


def document(derivation: Derivation, *, latex: bool = False) -> dict[str, Any]:
    """Plain data with expressions in the language of files; ``latex`` adds the same formulas in LaTeX."""
    data = formulas(derivation, plain)
    if latex:
        data["latex"] = formulas(derivation, sp.latex)
    return data


def plain(expression: sp.Basic) -> str:
    """An expression or relation in the language of files; sums over roots as sympy writes them."""
    if isinstance(expression, sp.core.relational.Relational):
        return f"{plain(expression.lhs)} {expression.rel_op} {plain(expression.rhs)}"
    try:
        return to_text(expression)
    except NavsymError:
        return str(expression)


def formulas(derivation: Derivation, write: Writer) -> dict[str, Any]:
    """All formulas, written one by one."""
    return {
        "name": derivation.name,
        "states": list(derivation.states),
        "measurements": [
            {"name": name, "sigma": write(sigma)}
            for name, sigma in zip(derivation.measurements, derivation.sigmas, strict=True)
        ],
        "F": [written(F, write) for F in derivation.system],
        "transition": [
            {
                "time": write(t.time),
                "matrix": written(t.matrix, write),
                "characteristic": [
                    {"factor": write(factor), "multiplicity": times, "form": kind} for factor, times, kind in t.factors
                ],
            }
            for t in derivation.transition
        ],
        "regressors": [stretch_data(derivation, stretch, write) for stretch in derivation.stretches],
        "observability_matrix": (
            None if derivation.observability is None else written(derivation.observability, write)
        ),
        "conditions": [condition_data(derivation, c, write) for c in derivation.conditions],
        "assumptions": [write(relation) for relation in derivation.assumptions],
    }


def written(matrix: sp.MatrixBase, write: Writer) -> list[list[str]]:
    """A matrix as rows of texts."""
    return [[write(entry) for entry in row] for row in matrix.tolist()]


def stretch_data(derivation: Derivation, stretch: Stretch, write: Writer) -> dict[str, Any]:
    """H on one stretch, with the ends between which it holds."""
    return {
        "variable": write(derivation.instant),
        "from": write(stretch.start),
        "to": write(stretch.end),
        "H": written(stretch.rows, write),
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


# --- text for people -------------------------------------------------------------------------------


def as_text(data: dict[str, Any]) -> str:
    """The derivation as a page of text; ``data`` is the document."""
    lines = [f"{data['name']}: {len(data['states'])} unknowns {', '.join(data['states'])}", ""]
    for place, F in enumerate(data["F"]):
        lines += [f"F{stretch_name(data, place)}", *grid(F), ""]
    for place, transition in enumerate(data["transition"]):
        lines += [f"Phi({transition['time']}) = exp(F {transition['time']}){stretch_name(data, place)}"]
        lines += [*grid(transition["matrix"])]
        lines += [
            f"  factor {item['factor']}, multiplicity {item['multiplicity']}: {item['form']}"
            for item in transition["characteristic"]
        ]
        lines.append("")
    for stretch in data["regressors"]:
        v = stretch["variable"]
        lines.append(f"H({v}) for {stretch['from']} <= {v} <= {stretch['to']}")
        lines += [f"  {m['name']}: ({', '.join(row)})" for m, row in measured(data, stretch["H"])]
        lines.append("")
    if data["observability_matrix"]:
        lines += ["observability matrix", *grid(data["observability_matrix"]), ""]
    lines += conditions_text(data)
    if data["assumptions"]:
        lines += ["assumed", *(f"  {relation}" for relation in data["assumptions"])]
    return "\n".join(lines).rstrip() + "\n"


def measured(data: dict[str, Any], rows: list[Any]) -> list[tuple[dict[str, str], Any]]:
    """Each measurement beside its row."""
    return list(zip(data["measurements"], rows, strict=True))


def stretch_name(data: dict[str, Any], place: int) -> str:
    """Which stretch a matrix belongs to, when there are several."""
    if len(data["F"]) == 1:
        return ""
    stretch = data["regressors"][place]
    return f", from {stretch['from']} to {stretch['to']}"


def grid(rows: list[list[str]]) -> list[str]:
    """A matrix of texts in aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  [ " + "  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " ]" for row in rows]


def conditions_text(data: dict[str, Any]) -> list[str]:
    """The conditions of the contacts; the dual polynomials are printed once."""
    if not data["conditions"]:
        return []
    t = data["regressors"][0]["variable"]
    lines = ["conditions of the contacts"]
    first = data["conditions"][0]
    for stretch, duals, slopes in zip(data["regressors"], first["dual_polynomial"], first["slope"], strict=True):
        where = f" for {stretch['from']} <= {t} <= {stretch['to']}" if len(data["regressors"]) > 1 else ""
        for (m, f), slope in zip(measured(data, duals), slopes, strict=True):
            lines += [
                f"  {m['name']}{where}: f({t}) = {f}",
                f"    |f({t})| <= {m['sigma']}, at a contact f = +-{m['sigma']}",
                f"    at a contact inside the interval 0 = {slope}",
            ]
    n = len(data["states"])
    lines.append(f"  at most {n} contacts, weights of the sign of f, sum weight H(contact) = P")
    lines += [
        f"  {c['target']}: P = ({', '.join(c['functional'])}), guaranteed deviation = max {c['value']}"
        for c in data["conditions"]
    ]
    return [*lines, ""]


# --- LaTeX -----------------------------------------------------------------------------------------


def as_latex(data: dict[str, Any]) -> str:
    """The derivation as LaTeX, one display for each formula; ``data`` is the document with its LaTeX."""
    tex = data["latex"]
    shows = [f"F = {pmatrix(F)}" for F in tex["F"]]
    shows += [f"\\Phi({t['time']}) = {pmatrix(t['matrix'])}" for t in tex["transition"]]
    for stretch in tex["regressors"]:
        v = stretch["variable"]
        shows += [
            f"H_{{{j + 1}}}({v}) = {pmatrix([[entry] for entry in row])}, "
            f"\\quad {stretch['from']} \\le {v} \\le {stretch['to']}"
            for j, row in enumerate(stretch["H"])
        ]
    if tex["observability_matrix"]:
        shows.append(f"\\mathcal{{O}} = {pmatrix(tex['observability_matrix'])}")
    shows += condition_displays(tex)
    shows += [f"{relation}" for relation in tex["assumptions"]]
    return "\n".join(f"\\[\n  {show}\n\\]" for show in shows) + "\n"


def pmatrix(rows: list[list[str]]) -> str:
    """Rows of LaTeX as a matrix in parentheses."""
    return "\\begin{pmatrix} " + " \\\\ ".join(" & ".join(row) for row in rows) + " \\end{pmatrix}"


def condition_displays(tex: dict[str, Any]) -> list[str]:
    """Dual polynomials with their bounds and slopes, unbiasedness, and the value of each target."""
    if not tex["conditions"]:
        return []
    shows, first = [], tex["conditions"][0]
    for stretch, duals, slopes in zip(tex["regressors"], first["dual_polynomial"], first["slope"], strict=True):
        v = stretch["variable"]
        for j, (m, f, slope) in enumerate(zip(tex["measurements"], duals, slopes, strict=True), start=1):
            shows += [
                f"f_{{{j}}}({v}) = {f}, \\quad |f_{{{j}}}({v})| \\le {m['sigma']}",
                f"f_{{{j}}}({v}_k) = \\pm {m['sigma']}, \\quad f_{{{j}}}'({v}) = {slope}",
            ]
    v = tex["regressors"][0]["variable"]
    shows.append(f"\\sum_k \\varphi_k H({v}_k) = P, \\quad \\varphi_k f({v}_k) \\ge 0")
    return shows + [
        f"P = {pmatrix([[entry] for entry in c['functional']])}, \\quad \\max\\, {c['value']}"
        for c in tex["conditions"]
    ]


# Certificates of linear systems: a transition matrix, the rank of a matrix with parameters.


TRIALS = 8


def derivation_certificate(found: Derivation) -> dict[str, Any] | None:
    """The transition matrix of every stretch and the rank of the observability matrix; None without a system."""
    pairs = zip(found.system, found.transition, strict=True)
    parts = [exponential_certificate(F, Phi.matrix, Phi.time) for F, Phi in pairs]
    parts += [rank_certificate(found.observability)] if found.observability is not None else []
    known = [part for part in parts if part is not None]
    return {"kind": "all", "of": known} if known else None


def exponential_certificate(F: sp.MatrixBase, Phi: sp.MatrixBase, time: sp.Symbol) -> dict[str, Any] | None:
    """``Phi = exp(F time)``, that is ``Phi' = F Phi`` and ``Phi(0) = I``; None outside the language of files.

    F, Phi : (n, n), symbols for parameters; ``time`` occurs in Phi only
    """
    symbols = sorted({s.name for s in F.free_symbols | Phi.free_symbols} - {time.name})
    try:
        return {
            "kind": "exponential",
            "matrix": texts(F),
            "solution": texts(Phi),
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
    for point in points(sorted(M.free_symbols, key=str)):
        here = M.subs(point)
        rows = here.T.rref()[1] if all(x.is_Rational for x in here) else ()
        if len(rows) == rank and sp.Matrix([*(here.row(k) for k in rows), *(v.subs(point).T for v in null)]).det() != 0:
            return {
                "kind": "rank",
                "matrix": texts(M),
                "symbols": sorted(s.name for s in M.free_symbols),
                "rank": rank,
                "point": {s.name: to_text(value) for s, value in point.items()},
                "rows": [int(k) for k in rows],
                "null": [[to_text(sp.factor(x)) for x in v] for v in null],
            }
    return None


def points(symbols: Sequence[sp.Symbol]) -> Iterator[dict[sp.Symbol, sp.Rational]]:
    """A few rational points with unlike coordinates."""
    for k in range(1, TRIALS + 1):
        yield {s: sp.Rational(sp.prime(2 * i + k + 3), i + k + 1) for i, s in enumerate(symbols)}


def texts(M: sp.MatrixBase) -> list[list[str]]:
    return [[to_text(entry) for entry in M.row(i)] for i in range(M.rows)]
