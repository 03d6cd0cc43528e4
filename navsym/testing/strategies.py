"""Hypothesis strategies: exact models, intervals and angles, covariances and transition matrices."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from hypothesis import strategies as st

from navsym.models.linear import LinearModel

Strategy = st.SearchStrategy[Any]


def rationals(lowest: int = -5, highest: int = 5, denominator: int = 12) -> Strategy:
    """Exact rational numbers of sympy between two integers."""
    numbers = st.fractions(lowest, highest, max_denominator=denominator)
    return numbers.map(lambda q: sp.Rational(q.numerator, q.denominator))


def angles(denominator: int = 12) -> Strategy:
    """Exact angles in [-pi, pi]: rational multiples of pi, radians."""
    return rationals(-1, 1, denominator).map(lambda q: q * sp.pi)


def intervals(lowest: int = 0, highest: int = 10) -> Strategy:
    """Pairs (start, end) of exact numbers with start < end."""
    ends = st.tuples(rationals(lowest, highest), rationals(lowest, highest))
    return ends.filter(lambda pair: pair[0] != pair[1]).map(lambda pair: tuple(sorted(pair)))


def models(largest: int = 4, measurements: int = 2) -> Strategy:
    """Constant linear models dx/dt = F x, z = H x + r with small rational entries."""
    sizes = st.tuples(st.integers(1, largest), st.integers(1, measurements))
    return sizes.flatmap(lambda size: st.builds(model_of, matrices(size[0], size[0]), matrices(size[1], size[0])))


def matrices(rows: int, columns: int) -> Strategy:
    entries = st.integers(-3, 3) | st.sampled_from([Fraction(1, 2), Fraction(-1, 3)])
    row = st.lists(entries, min_size=columns, max_size=columns)
    return st.lists(row, min_size=rows, max_size=rows)


def model_of(F: list[list[Any]], H: list[list[Any]]) -> LinearModel:
    """The model of two lists of rows, with names x1, x2, ... and z1, z2, ..."""
    exact = [[[sp.Rational(str(entry)) for entry in row] for row in rows] for rows in (F, H)]
    states = tuple(f"x{i + 1}" for i in range(len(F)))
    return LinearModel(F=exact[0], H=exact[1], states=states, measurements=tuple(f"z{j + 1}" for j in range(len(H))))


def covariances(size: int = 3, smallest: float = 1e-3) -> Strategy:
    """Symmetric positive definite arrays (size, size): B B' + smallest I with entries of B in [-3, 3]."""
    entries = st.lists(st.floats(-3, 3, width=32), min_size=size * size, max_size=size * size)

    def build(values: list[float]) -> np.ndarray:
        B = np.array(values).reshape(size, size)
        return B @ B.T + smallest * np.eye(size)

    return entries.map(build)


def mode_transitions(modes: int = 3) -> Strategy:
    """Row-stochastic arrays (modes, modes): entry [i, j] leads from mode i to mode j."""
    row = st.lists(st.floats(1 / 64, 1, width=32), min_size=modes, max_size=modes)
    return st.lists(row, min_size=modes, max_size=modes).map(
        lambda rows: np.array(rows) / np.array(rows).sum(axis=1, keepdims=True)
    )
