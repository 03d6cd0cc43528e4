"""Random streams, and the same questions put to a linear programme in doubles."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations

import numpy as np
from scipy.linalg import expm
from scipy.optimize import linprog

import navsym as nav


@dataclass
class Epochs:
    """A model in doubles with the epochs that a guard was given."""

    F: np.ndarray
    H: np.ndarray
    target: np.ndarray
    rows: list = field(default_factory=list)  # (epoch, t, measurement, z, sigma)
    count: int = 0

    def add(self, t, values, sigma):
        for j, z in values.items():
            self.rows.append((self.count, t, j, z, sigma[j]))
        self.count += 1

    def window(self, memory):
        return [row for row in self.rows if memory is None or row[0] >= self.count - memory]

    def regressors(self, rows, now):
        return np.array([self.H[j] @ expm(self.F * (t - now)) for _, t, j, _, _ in rows])

    def radius(self, now, memory=None):
        """min sum sigma |w| subject to sum w h = P, by HiGHS; None where it is infeasible."""
        rows = self.window(memory)
        if not rows:
            return None
        H, sigma = self.regressors(rows, now), np.array([row[4] for row in rows])
        return solve_lp(np.r_[sigma, sigma], np.c_[H.T, -H.T], self.target)

    def ends(self, now, rows):
        """Least and largest target over all states that keep the bounds of these rows; None where there is none."""
        if not rows:
            return -np.inf, np.inf
        H, z, sigma = self.regressors(rows, now), *(np.array([row[k] for row in rows]) for k in (3, 4))
        A, b = np.r_[H, -H], np.r_[z + sigma, sigma - z]
        found = [linprog(s * self.target, A, b, bounds=(None, None), method="highs") for s in (1, -1)]
        if any(f.status == 2 for f in found):
            return None
        return tuple(s * f.fun if f.status == 0 else -s * np.inf for s, f in zip((1, -1), found, strict=True))

    def explanations(self, now, memory, most):
        """(set of excluded epochs, ends) of every explanation, by trying all sets."""
        rows = self.window(memory)
        epochs = sorted({row[0] for row in rows})
        found = {}
        for size in range(most + 1):
            for chosen in combinations(epochs, size):
                ends = self.ends(now, [row for row in rows if row[0] not in chosen])
                if ends is not None:
                    found[frozenset(chosen)] = ends
        return found


def solve_lp(c, A, b):
    scale = np.abs(A).max(axis=1)
    scale[scale == 0] = 1
    found = linprog(c, A_eq=A / scale[:, None], b_eq=b / scale, method="highs")
    return found.fun if found.status == 0 else None


def random_model(rng, n, p):
    """A rational system of n states with p measurements, as navsym has it and in doubles."""
    F = [[Fraction(int(rng.integers(-2, 3)), 4) for _ in range(n)] for _ in range(n)]
    H = [[Fraction(int(rng.integers(-2, 3))) for _ in range(n)] for _ in range(p)]
    P = [Fraction(int(rng.integers(-2, 3))) for _ in range(n)]
    H[0][0], P[n - 1] = Fraction(1), P[n - 1] or Fraction(1)
    sigma = [Fraction(int(rng.integers(1, 9)), 4) for _ in range(p)]
    names = [f"z{j + 1}" for j in range(p)]
    row = {"goal": P}
    model = nav.Model([f"x{k}" for k in range(n)], F, H, sigma, targets=row, measurements=names)
    return model, Epochs(*(np.array(a, dtype=float) for a in (F, H, P))), [float(s) for s in sigma]


def random_epochs(rng, p, sigma, count, *, noise=None, gaps=0.2):
    """(t as text, values, bounds): uneven times, missing cells, bounds that change now and then."""
    t = Fraction(0)
    for _ in range(count):
        t += Fraction(int(rng.integers(1, 12)), 20)
        bounds = {j: s if rng.random() > 0.2 else float(rng.integers(1, 9)) / 4 for j, s in enumerate(sigma)}
        values = {j: None for j in range(p) if rng.random() > gaps}
        yield t, values, bounds
