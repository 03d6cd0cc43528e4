"""Speed of the multiple-model filters against filterpy (one run) and batched numpy (many runs).

    python tests/benchmarks/multimodel.py

Peers are measured alternately in the same process; the best of several rounds counts on both sides. Single runs by
the processor time of the process, so that a busy machine does not decide; batches, which use all cores, by the wall
clock. Random dense models, so that nothing is gained from zeros.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from filterpy.kalman import IMMEstimator, KalmanFilter, MMAEFilterBank

from navsym.multimodel.bank import Bank
from navsym.multimodel.filters import run_filter

SIZES = ((3, 3), (8, 6), (16, 9))


def random_bank(modes: int, states: int, seed: int = 0) -> Bank:
    """Stable dense models that observe a third of the states."""
    rng = np.random.default_rng(seed)
    channels = max(1, states // 3)
    models = []
    for i in range(modes):
        F = rng.standard_normal((states, states))
        F /= 1.1 * np.abs(np.linalg.eigvals(F)).max()
        H = rng.standard_normal((channels, states))
        models.append({"F": F, "Q": 0.1 * (i + 1) * np.eye(states), "H": H, "R": (i + 1.0) * np.eye(channels)})
    switch = np.full((modes, modes), 0.1 / max(modes - 1, 1))
    np.fill_diagonal(switch, 0.9)
    return Bank(
        models,
        switch,
        {"mean": np.zeros(states), "covariance": np.eye(states), "probabilities": np.full(modes, 1 / modes)},
    )


def peers(models: Bank) -> list[KalmanFilter]:
    """filterpy's filters of a bank."""
    out = []
    for i in range(models.modes):
        single = KalmanFilter(models.states, models.channels)
        single.F, single.Q = models.F[0, i].copy(), models.Q[0, i].copy()
        single.H, single.R = models.H[0, i].copy(), models.R[0, i].copy()
        single.x, single.P = models.means[i][:, None].copy(), models.covariances[i].copy()
        out.append(single)
    return out


def filterpy_imm(models: Bank, z: np.ndarray) -> np.ndarray:
    """Means of filterpy's IMM."""
    imm = IMMEstimator(peers(models), models.probabilities.copy(), models.mode_transition[0].copy())
    out = []
    for row in z:
        imm.predict()
        imm.update(row[:, None])
        out.append(imm.x[:, 0].copy())
    return np.array(out)


def filterpy_bank(models: Bank, z: np.ndarray) -> np.ndarray:
    """Means of filterpy's static bank."""
    static = MMAEFilterBank(peers(models), models.probabilities.copy(), models.states)
    out = []
    for row in z:
        static.predict()
        static.update(row[:, None])
        out.append(static.x[:, 0].copy())
    return np.array(out)


def best_of(rounds: int, *actions: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> list[float]:
    """Seconds of each action: the least of several rounds, taken in turn."""
    least = [float("inf")] * len(actions)
    for _ in range(rounds):
        for k, action in enumerate(actions):
            began = clock()
            action()
            least[k] = min(least[k], clock() - began)
    return least


def single_runs(sizes: tuple[tuple[int, int], ...], steps: int, peer_steps: int, rounds: int) -> None:
    """Ratios per step against filterpy, with the largest difference of the means."""
    print("one run, microseconds a step      ours     filterpy   ratio   largest difference")
    for modes, states in sizes:
        models = random_bank(modes, states)
        z = np.random.default_rng(1).standard_normal((steps, models.channels))
        for method, peer in (("imm", filterpy_imm), ("polygaussian", filterpy_bank)):

            def ours(method: str = method, models: Bank = models, z: np.ndarray = z) -> object:
                return run_filter(models, z, method, engine="compiled")

            def theirs(peer=peer, models: Bank = models, z: np.ndarray = z) -> object:
                return peer(models, z[:peer_steps])

            difference = np.abs(ours().mean[:peer_steps] - theirs()).max()
            fast, slow = best_of(rounds, ours, theirs, clock=time.process_time)
            fast, slow = fast / steps * 1e6, slow / peer_steps * 1e6
            print(f"  {method:13s} ({modes:2d}, {states}) {fast:16.3f} {slow:12.1f} {slow / fast:7.0f}", end="")
            print(f"   {difference:.1e}")


def batches(sizes: tuple[tuple[int, int], ...], runs: int, steps: int, rounds: int) -> None:
    """Ratios of a batch of runs against numpy's stacked products."""
    from navsym_papers.multistructure.experiment.batch import run_batch
    from tests.twins.mixture import imm_in_numpy

    print(f"batch of {runs} runs, {steps} steps    ours (s)   numpy (s)   ratio   largest difference")
    for modes, states in sizes:
        models = random_bank(modes, states)
        z = np.random.default_rng(2).standard_normal((runs, steps, models.channels))
        ours, theirs = run_batch(models, z, "imm"), imm_in_numpy(models, z)
        difference = max(np.abs(a - b).max() for a, b in zip(ours[:2], theirs[:2], strict=True))
        fast, slow = best_of(rounds, lambda: run_batch(models, z, "imm"), lambda: imm_in_numpy(models, z))  # noqa: B023
        print(f"  imm           ({modes:2d}, {states}) {fast:16.3f} {slow:11.3f} {slow / fast:7.1f}   {difference:.1e}")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="tiny sizes, to see that it runs")
    quick = parser.parse_args(arguments).quick
    single_runs(SIZES[:1] if quick else SIZES, 200 if quick else 20000, 20 if quick else 200, 1 if quick else 5)
    batches(SIZES[:1] if quick else SIZES, 64 if quick else 10000, 2 if quick else 5, 1 if quick else 3)


if __name__ == "__main__":
    main()
