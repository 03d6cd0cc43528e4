"""An epoch of ``nav.Guard`` beside general solvers: ``python -m tests.benchmarks.guard``.

One stream for all: two measurements an epoch, some missing, bounds that change. The guard takes every epoch, HiGHS (by
scipy and highspy) and cvxpy with clarabel some of them, each with the regressors already made and without a proof.
Processor time: the median of the epochs, the best of a few rounds.
"""

from __future__ import annotations

import argparse
import time
import warnings
from fractions import Fraction

import cvxpy as cp
import numpy as np
from scipy.optimize import linprog

import navsym as nav
from tests.benchmarks.guaranteed import by_highspy

#: Unknowns, epochs in memory, and how many measurements are missing.
CASES = [(3, 16, 0.005), (3, 16, 0.1), (8, 32, 0.005), (8, 32, 0.1)]


def oscillators(n):
    """x1 of three states, or of n/2 oscillators that two sensors see together."""
    if n == 3:
        F = [["0", "1", "0"], ["0", "0", "1"], ["0", "-1", "0"]]
        return nav.Model("x0 x1 x2", F, ["x0", "x1"], ["1", "1/2"], targets={"goal": "x1"})
    F = [["0"] * n for _ in range(n)]
    for k in range(0, n, 2):
        F[k][k + 1], F[k + 1][k] = str(k + 1), str(-k - 1)
    names = [f"x{k}" for k in range(n)]
    return nav.Model(names, F, ["+".join(names[::2]), "+".join(names)], ["1", "1/2"], targets={"goal": "x1"})


def timed(function):
    """Processor time of a call in microseconds, and its answer."""
    start = time.thread_time()
    answer = function()
    return 1e6 * (time.thread_time() - start), answer


def by_linprog(H, P):
    size = np.abs(H).max(axis=1)
    H, P = H / size[:, None], P / size
    return linprog(np.ones(2 * H.shape[1]), A_eq=np.hstack([H, -H]), b_eq=P, method="highs").fun


def by_cvxpy(H, P):
    x = cp.Variable(len(P))
    task = cp.Problem(cp.Maximize(P @ x), [H.T @ x <= 1, H.T @ x >= -1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return task.solve(solver=cp.CLARABEL)


PEERS = {"HiGHS by highspy": by_highspy, "HiGHS by scipy": by_linprog, "cvxpy, clarabel": by_cvxpy}


def follow(n, memory, gaps, count, every):
    """Medians of an epoch, of the guard and of each peer, and the largest difference of a peer's value, relative."""
    guard, rng = nav.Guard(oscillators(n), "goal", "variance", memory=memory), np.random.default_rng(6)
    spent, peers, worst = [], {name: [] for name in PEERS}, 0.0
    for k in range(count):
        z = [None if rng.random() < gaps else int(rng.integers(-9, 9)) for _ in range(2)]
        sigma = {"z1": 2} if rng.random() < gaps / 2 else None
        one, estimate = timed(lambda z=z, sigma=sigma, k=k: guard.step(z, t=Fraction(k, 4), sigma=sigma))
        if k < 2 * memory:  # until the memory is full and its regressors are known
            continue
        spent.append(one)
        assert estimate.high - estimate.low <= 1e-12 * estimate.high
        if k % every == 0:
            H = guard.memory.cloud().scaled.T
            P = np.array([float(e) for e in guard.memory.target().entries()])
            for name, peer in PEERS.items():
                one, value = timed(lambda peer=peer, H=H, P=P: peer(H, P))
                peers[name].append(one)
                worst = max(worst, abs(value / float(estimate.high) - 1))
    return np.median(spent), {name: np.median(times) for name, times in peers.items()}, worst


def main(count=2000, every=100, rounds=3, cases=CASES):
    for n, memory, gaps in cases:
        done = [follow(n, memory, gaps, count, every) for _ in range(rounds)]
        ours = min(own for own, *_ in done)
        theirs = {name: min(times[name] for _, times, _ in done) for name in PEERS}
        ratios = ", ".join(f"{name} {time:.0f} us ({time / ours:.0f} times)" for name, time in theirs.items())
        print(
            f"{n} unknowns, {memory} epochs, {gaps:.1%} missing: guard with its proof {ours:.0f} us; {ratios}; "
            f"values differ by at most {max(worst for *_, worst in done):.0e}",
            flush=True,
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    main(arguments.count, rounds=arguments.rounds)
