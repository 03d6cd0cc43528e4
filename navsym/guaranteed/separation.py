"""Regressors that share a huge or tiny part, separated: other unknowns for the same problem, exactly.

The regressors of a stiff model are sums of the same exponentials, which cancel in ``x . H`` by as many digits as
exp(1000) has; balls over a cell see the parts and not the sum. With the coefficients C of all regressors in the
products of functions they consist of, the largest first, and ``M C`` in echelon form, the regressors ``M H`` have one
leading product each. ``sum w H = P`` says the same as ``sum w M H = M P``, and ``x . H = x' . M H`` for
``x = M^T x'``. M is rational and regular, and includes powers of ten that bring every regressor to the size of one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp
from flint import arb, fmpq, fmpq_mat

from navsym.core.balls import enclose
from navsym.core.exact import to_fmpq, to_rational
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem

#: Digits that cancel before the regressors are separated, places at which sizes are seen, bits for that.
FAR, SHARES, BITS = 40, [sp.Rational(k, 16) for k in range(17)], 256
Atom = tuple[int, sp.Expr]


@dataclass(frozen=True, slots=True, eq=False)
class SeparatedProblem:
    """The problem in other unknowns, and M."""

    problem: PanelProblem
    matrix: fmpq_mat

    def back(self, dual: tuple[arb, ...]) -> tuple[arb, ...]:
        """The dual in the unknowns of the problem, ``M^T x'``."""
        m = len(dual)
        return tuple(sum((self.matrix[i, j] * dual[i] for i in range(m)), arb(0)) for j in range(m))


def separate_regressors(problem: PanelProblem) -> SeparatedProblem | None:
    """The problem with its regressors separated, or None where a coefficient is not rational."""
    parts = [[atom_coefficients(h, panel) for h in panel.functions] for panel in problem.panels]
    found = {(k, atom) for k, rows in enumerate(parts) for row in rows for atom in row or {}}
    sizes = {(k, atom): atom_digits(problem.panels[k], atom) for k, atom in found}
    if any(row is None for rows in parts for row in rows) or None in sizes.values():
        return None
    m = len(problem.functional)
    atoms = sorted(found, key=lambda a: (-float(sizes[a] or 0.0), a[0], str(a[1])))
    C = [[(parts[k][i] or {}).get(atom, fmpq(0)) for k, atom in atoms] for i in range(m)]
    both, _ = fmpq_mat([[*row, *(fmpq(int(i == j)) for j in range(m))] for i, row in enumerate(C)]).rref()
    R = [[both[i, j] for j in range(len(atoms))] for i in range(m)]
    if not all(any(c != 0 for c in row) for row in R):
        return None
    scale = [leading_scale(row, [sizes[a] or 0.0 for a in atoms]) for row in R]
    M = fmpq_mat([[both[i, len(atoms) + j] * scale[i] for j in range(m)] for i in range(m)])
    return SeparatedProblem(problem_in_atoms(problem, atoms, R, scale, M), M)


def problem_in_atoms(
    problem: PanelProblem, atoms: list[Atom], R: list[list[fmpq]], scale: list[fmpq], M: fmpq_mat
) -> PanelProblem:
    """Panels with the regressors ``scale R atoms`` and the functional ``M P``."""
    m = len(R)
    panels = []
    for k, panel in enumerate(problem.panels):
        mine = [(j, atom) for j, (place, atom) in enumerate(atoms) if place == k]
        rows = [sp.Add(*(to_rational(R[i][j] * scale[i]) * atom for j, atom in mine)) for i in range(m)]
        panels.append(replace(panel, functions=tuple(rows)))
    functional = [sp.Add(*(to_rational(M[i, j]) * problem.functional[j] for j in range(m))) for i in range(m)]
    return PanelProblem(tuple(panels), tuple(functional))


def atom_coefficients(h: sp.Expr, panel: Panel) -> dict[sp.Expr, fmpq] | None:
    """Products of functions of the variable with their rational coefficients; None where one is not rational."""
    found: dict[sp.Expr, fmpq] = {}
    for term in sp.Add.make_args(sp.expand(h, power_exp=False, power_base=False, log=False)):
        c, atom = term.as_independent(panel.variable, as_Add=False)
        if not c.is_Rational:
            return None
        if c != 0:
            found[atom] = found.get(atom, fmpq(0)) + to_fmpq(c)
    return found


def atom_digits(panel: Panel, atom: sp.Expr) -> float | None:
    """The logarithm to base ten of the largest modulus seen on the panel; None where there is no number."""
    places = [panel.start + (panel.end - panel.start) * share for share in SHARES]
    values = [abs(enclose(atom.subs(panel.variable, at), bits=BITS)).mid() for at in places]
    if not all(value.is_finite() for value in values) or not max(values) > 0:
        return None
    return log10_of(max(values))


def leading_scale(row: list[fmpq], sizes: list[float]) -> fmpq:
    """The power of ten that brings the largest part of a regressor to about one."""
    parts = [(c, size) for c, size in zip(row, sizes, strict=True) if c != 0]
    return fmpq(10) ** -round(max(size + log10_of(abs(arb(c))) for c, size in parts))


def log10_of(x: arb) -> float:
    """The logarithm of a positive number to base ten."""
    return float((x.log() / arb(10).log()).mid())
