"""Certificates of linear systems: a transition matrix, the rank of a matrix with parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import sympy as sp

from navsym.core.errors import NavsymError
from navsym.language.printer import to_text

TRIALS = 8


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
    """The entries in the language of files, row by row; a NavsymError where one stands outside of it."""
    return [[to_text(entry) for entry in M.row(i)] for i in range(M.rows)]
