"""Closed-form transition matrices against sympy's ``Matrix.exp``, measured alternately in one run.

    python tests/benchmarks/transition.py [--rounds N] [--limit SECONDS] [--only NAME]

Each measurement is a child process of its own, because sympy caches what it has computed once.
A peer that runs into the limit is reported as "more than", never as a ratio.
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
import time

import sympy as sp

t = sp.Symbol("t", positive=True)
w, g, R, earth = sp.symbols("w g R Omega", positive=True)
a, b = sp.symbols("a b", positive=True)

SYSTEMS = {
    "oscillator, 2 states": [[0, 1], [-(w**2), 0]],
    "nilpotent, 3 states": [[0, 1, 0], [0, 0, 1], [0, 0, 0]],
    "velocity correction, 3 states": [[0, -1, 0], [0, 0, 1], [0, -1, 0]],
    "damped oscillator, 2 states": [[0, 1], [-(w**2), -2 * a]],
    "two Markov processes, 3 states": [[0, 1, 1], [0, -a, 0], [0, 0, -b]],
    "Schuler channel, 4 states": [[0, 1, 0, 0], [0, 0, -g, 0], [0, 1 / R, 0, 1], [0, 0, 0, 0]],
    "two oscillators, 4 states": [[0, 1, 0, 0], [-(w**2), 0, 1, 0], [0, 0, 0, 1], [0, 0, -(a**2), 0]],
    "two channels and the Earth's turn, 4 states": [
        [0, 2 * earth, 0, -g],
        [-2 * earth, 0, g, 0],
        [0, -1 / R, 0, earth],
        [1 / R, 0, -earth, 0],
    ],
    "Schuler channel with Markov drift, 5 states": [
        [0, 1, 0, 0, 0],
        [0, 0, -g, 0, 1],
        [0, 1 / R, 0, 1, 0],
        [0, 0, 0, -b, 0],
        [0, 0, 0, 0, 0],
    ],
    "two channels, drifts and the Earth's turn, 7 states": [
        [0, 2 * earth, 0, -g, 0, 0, 0],
        [-2 * earth, 0, g, 0, 0, 0, 0],
        [0, -1 / R, 0, earth, 1, 0, 0],
        [1 / R, 0, -earth, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 0, 0],
        [1, 0, 0, 0, 0, 0, 0],
    ],
}


def ours(system: list[list[sp.Expr]]) -> object:
    from navsym.models.transition.exponential import transition_matrix

    return transition_matrix(system, t).matrix


def peer(system: list[list[sp.Expr]]) -> object:
    return (sp.Matrix(system) * t).exp()


def child(run: str, name: str, pipe: object) -> None:
    """One measurement of CPU time after the imports and one warming run on a trivial system."""
    function = {"ours": ours, "peer": peer}[run]
    function([[0, 1], [-1, 0]])
    start = time.perf_counter()
    try:
        function(SYSTEMS[name])
        pipe.send(time.perf_counter() - start)
    except Exception as reason:
        pipe.send(f"failed: {type(reason).__name__}")


def measured(run: str, name: str, limit: float) -> float | str:
    """Seconds, or in words why there is no number."""
    here, there = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("spawn").Process(target=child, args=(run, name, there))
    process.start()
    there.close()
    try:
        return here.recv() if here.poll(limit + 10) else f"more than {limit:g} s"
    except EOFError:
        return "failed: died"
    finally:
        process.kill()
        process.join()


def compare(name: str, rounds: int, limit: float) -> str:
    times: dict[str, list[float]] = {"ours": [], "peer": []}
    words = {"ours": "", "peer": ""}
    for _ in range(rounds):
        for run in times:
            if words[run]:
                continue
            result = measured(run, name, limit)
            if isinstance(result, str):
                words[run] = result
            else:
                times[run].append(result)
    median = {run: statistics.median(values) if values else None for run, values in times.items()}
    shown = {run: words[run] or f"{1000 * (median[run] or 0):9.1f} ms" for run in times}
    ratio = f"{median['peer'] / median['ours']:7.1f} x" if median["ours"] and median["peer"] else "      -"
    return f"{name:52} ours {shown['ours']:>14}   sympy {shown['peer']:>16}   {ratio}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    for name in SYSTEMS:
        if options.only in name:
            print(compare(name, options.rounds, options.limit), flush=True)


if __name__ == "__main__":
    main()
