"""Exact observability against sympy: rank with proof, and the row-reduced form behind it.

    python tests/benchmarks/observability.py [--rounds N] [--limit SECONDS] [--only NAME]

Peers: ``Matrix.rank`` (which has no proof: it trusts ``simplify`` for zeros) and
``DomainMatrix.rref_den`` over Z[parameters], on the same observability matrices. Ours and the
peer run alternately, each in a child process of its own, because sympy caches what it has computed
once. A peer that runs into the limit is reported as "more than", never as a ratio of its own.
Navigators have a numerical peer as well: the rank of one random point in doubles, by singular values. It is quick, and
nothing says that it is the rank. The set of all drops has a goal in the place of a peer.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import statistics
import time

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

from navsym.models.linear import LinearModel, observability_matrix
from navsym.observability.chains import chains_of, numerators, observe_jointly, prove_rank
from navsym.observability.linear import null_columns, triangular_form
from navsym.observability.rank_drops import chain_determinant
from navsym.observability.ring import Ring
from navsym_papers.joint_correction.inertial import FULL, full_model

a, b, c, d, e, f = sp.symbols("a b c d e f", real=True)


def moving(count: int, measurements: tuple[int, ...]) -> LinearModel:
    """The first states of the moving INS error model: mu, omega_1, omega_2, u_1, u_2, u_3 are symbols."""
    model = full_model()
    H = sp.Matrix([model.H[k, :count] for k in measurements])
    return LinearModel(model.F[:count, :count], None, H, tuple(map(str, FULL[:count])))


def chain(count: int) -> LinearModel:
    """Coupled oscillators with a drift, measured at one end: six parameters, one long chain."""
    F = sp.zeros(count, count)
    symbols = (a, b, c, d, e, f)
    for k in range(0, count - 1, 2):
        F[k, k + 1] = 1
        F[k + 1, k] = -symbols[k // 2 % 6]
        if k + 2 < count:
            F[k + 1, k + 2] = symbols[(k // 2 + 3) % 6]
    return LinearModel(F, None, sp.Matrix([[1, *[0] * (count - 1)]]))


SYSTEMS = {
    "moving INS, 9 states, position": lambda: moving(9, (2, 3)),
    "moving INS, 10 states, velocity and position": lambda: moving(10, (0, 1, 2, 3)),
    "moving INS, 12 states, velocity and position": lambda: moving(12, (0, 1, 2, 3)),
    "coupled oscillators, 9 states": lambda: chain(9),
    "coupled oscillators, 10 states": lambda: chain(10),
}


def skew(a):
    """The matrix of a cross product."""
    return sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def navigation_errors() -> LinearModel:
    """Errors of position, velocity, tilt, gyroscopes and accelerometers, local level; the position is measured."""
    L, h, R, W, *v = sp.symbols("L h R W vN vE vD", real=True)
    force, C = sp.Matrix(sp.symbols("fN fE fD", real=True)), sp.Matrix(3, 3, sp.symbols("c1:4(1:4)", real=True))
    v, position = sp.Matrix(v), sp.Matrix([L, sp.Symbol("longitude", real=True), h])
    turn = sp.Matrix([W * sp.cos(L), 0, -W * sp.sin(L)])
    carried = sp.Matrix([v[1], -v[0], -v[1] * sp.tan(L)]) / (R + h)
    moved = sp.Matrix([v[0] / (R + h), v[1] / ((R + h) * sp.cos(L)), -v[2]])
    pushed = force - (2 * turn + carried).cross(v)
    F = sp.zeros(15, 15)
    F[0:3, 0:3], F[0:3, 3:6] = moved.jacobian(position), moved.jacobian(v)
    F[3:6, 0:3], F[3:6, 3:6] = pushed.jacobian(position), pushed.jacobian(v)
    F[3:6, 6:9], F[3:6, 12:15] = skew(force), C
    F[6:9, 0:3], F[6:9, 3:6] = -(turn + carried).jacobian(position), -(turn + carried).jacobian(v)
    F[6:9, 6:9], F[6:9, 9:12] = -skew(turn + carried), -C
    return LinearModel(F, None, sp.eye(15)[:3, :])


def satellite_and_odometer() -> LinearModel:
    """28 states: position, velocity, tilt, biases and scales of both triads, antenna, odometer and its mounting, delay.

    Position of the antenna, and velocity in the axes of the car; attitude, force and rates are symbols.
    """
    C = sp.Matrix(3, 3, sp.symbols("c1:4(1:4)", real=True))
    force, turn, v, arm = (sp.Matrix(sp.symbols(f"{s}1:4", real=True)) for s in ("s", "w", "v", "l"))
    earth = sp.Matrix([sp.Symbol("uN", real=True), 0, sp.Symbol("uD", real=True)])
    own = C.T * v
    F, H = sp.zeros(28, 28), sp.zeros(6, 28)
    F[0:3, 3:6], F[3:6, 3:6], F[3:6, 6:9] = sp.eye(3), -2 * skew(earth), -skew(C * force)
    F[3:6, 12:15], F[3:6, 18:21] = -C, -C * sp.diag(*force)
    F[6:9, 6:9], F[6:9, 9:12], F[6:9, 15:18] = -skew(earth), -C, -C * sp.diag(*turn)
    H[0:3, 0:3], H[0:3, 6:9], H[0:3, 21:24], H[0:3, 27] = sp.eye(3), -skew(C * arm), C, v
    H[3:6, 3:6], H[3:6, 6:9], H[3:6, 24], H[3:6, 25:27] = C.T, C.T * skew(v), own, skew(own)[:, 1:]
    return LinearModel(F, None, H)


#: Navigators: the model, and the seconds that its rank may take.
NAVIGATORS = {
    "navigator, 15 states with latitude": (navigation_errors, 2),
    "GNSS and odometer, 28 states": (satellite_and_odometer, 60),
}
#: Cells of the atlas with a triple of measurements, and the seconds that their complete sets may take.
TRIPLES = {"INS: rotation about two axes: position": 10, "INS: rotation about two axes: body velocity": 10}


def numerical_rank(model: LinearModel) -> int:
    """The peer in doubles: singular values at one random point, without any proof."""
    source = random.Random(3)
    at = {s: source.uniform(0.3, 2) for s in model.F.free_symbols | model.H.free_symbols}
    F, H = (np.array(matrix.subs(at).evalf().tolist(), dtype=float) for matrix in (model.F, model.H))
    rows = [H]
    for _ in range(model.size - 1):
        rows.append(rows[-1] @ F)
        rows[-1] = rows[-1] / max(1.0, np.abs(rows[-1]).max())
    return int(np.linalg.matrix_rank(np.vstack(rows)))


def complete_set(name: str) -> int:
    """Number of conditions of the complete list of a triple of measurements; -1 where it is not complete."""
    from navsym.studies.atlas.scenes import error_model, parts_of
    from tests.studies.atlas_cells import NODES, find_joint_drops, nonzero_symbols

    scene, aiding = parts_of(name)
    found = find_joint_drops(observe_jointly(error_model(scene, aiding)), nonzero_symbols(scene), NODES)
    return len(found.drops) if found.complete["joint"] else -1


def judge(name: str, kind: str, function, argument, goal: float) -> str:
    """One line for a goal in seconds."""
    seconds, value = timed(function, argument, 10 * goal)
    said = "more than ten times the goal" if seconds is None else f"{'met' if seconds <= goal else 'missed'}"
    return f"{name:46s} {kind:7s} ours {1e3 * (seconds or 10 * goal):9.2f} ms  goal {goal} s: {said}; answer {value}"


def dense(n: int, count: int) -> LinearModel:
    """Numbers everywhere, and ``count`` parameters in one entry each; one measurement."""
    source = random.Random(1)
    F = sp.Matrix(n, n, lambda i, j: source.randint(-3, 3))
    for symbol in (a, b, c, d, e, f)[:count]:
        F[source.randrange(n), source.randrange(n)] = symbol
    return LinearModel(F, None, sp.Matrix(1, n, lambda i, j: source.randint(-2, 2) or 1))


#: Where the rank drops is one determinant here: that is what is formed, by values at points and by the peer.
DENSE = {f"dense, {n} states, {count} parameters": (n, count) for n, count in ((7, 4), (8, 3), (9, 5))}


def ours_determinant(model: LinearModel) -> int:
    """Number of terms of the determinant of the chain."""
    chains = chains_of(model)
    found = chain_determinant([(chains.chains[0].vectors[0], model.size)], chains.matrix, chains.ring)
    return 0 if found is None else len(found)


def sympy_determinant(model: LinearModel) -> int:
    """The peer, vectors and all: the determinant of the observability matrix over the polynomial ring."""
    matrix = sp.Matrix(observability_matrix(model)).applyfunc(sp.expand)
    domain = sp.ZZ[tuple(sorted(matrix.free_symbols, key=str))]
    return len(DomainMatrix.from_Matrix(matrix).convert_to(domain).det())


def ours_rank(model: LinearModel) -> int:
    """Rank with proof: a nonzero minor from below, the number of states or relations from above."""
    return prove_rank(model).rank


def sympy_rank(model: LinearModel) -> int:
    """The peer."""
    return sp.Matrix(observability_matrix(model)).rank()


def square_part(model: LinearModel) -> sp.Matrix:
    """Independent rows of the observability matrix, found beforehand: both sides reduce the same matrix."""
    found = observe_jointly(model)
    rows = [m.basis.row(k) for m, count in zip(found.measurements, found.staircase, strict=True) for k in range(count)]
    return sp.Matrix([list(row) for row in rows])


def ours_reduce(matrix: sp.Matrix) -> int:
    """Null space by elimination without fractions; the rank."""
    ring = Ring.of(matrix)
    entries, _ = numerators([matrix[r, :] for r in range(matrix.rows)], ring)
    found = triangular_form(entries, ring)
    return matrix.cols - len(list(null_columns(found.rows, found.columns, matrix.cols, ring)))


def sympy_reduce(matrix: sp.Matrix) -> int:
    """The peer: the reduced form over the polynomial ring, whose free columns are the null space."""
    symbols = sorted(matrix.free_symbols, key=str)
    domain = sp.ZZ[tuple(symbols)] if symbols else sp.ZZ
    return len(DomainMatrix.from_Matrix(matrix).convert_to(domain).to_sparse().rref_den()[2])


def ours_everything(model: LinearModel) -> int:
    """Chains, companion coefficients and hidden directions as well."""
    return observe_jointly(model).joint_dimension


CONTESTS = {
    "all": (ours_everything, sympy_rank, "Matrix.rank", lambda model: model),
    "rank": (ours_rank, sympy_rank, "Matrix.rank", lambda model: model),
    "reduce": (ours_reduce, sympy_reduce, "rref_den", square_part),
    "doubles": (ours_rank, numerical_rank, "matrix_rank", lambda model: model),
}


CONTEST_OF_DENSE = {"determinant": (ours_determinant, sympy_determinant, "DomainMatrix.det", lambda model: model)}


def timed(function, argument, limit: float) -> tuple[float | None, object]:
    """Seconds of one call in a child process and its result; None when it does not end within the limit."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)

    def work() -> None:
        start = time.perf_counter()
        value = function(argument)
        sender.send((time.perf_counter() - start, value))

    child = context.Process(target=work)
    child.start()
    answer = receiver.recv() if receiver.poll(limit) else (None, None)
    child.terminate()
    child.join()
    return answer


def contest(name: str, kind: str, rounds: int, limit: float) -> str:
    """One line of the report."""
    ours, peer, peer_name, prepare = {**CONTESTS, **CONTEST_OF_DENSE}[kind]
    made = NAVIGATORS[name][0]() if name in NAVIGATORS else None
    argument = prepare(made or (dense(*DENSE[name]) if name in DENSE else SYSTEMS[name]()))
    own, other, values = [], [], set()
    for _ in range(rounds):
        seconds, value = timed(ours, argument, limit)
        own.append(seconds)
        values.add(value)
        if not other or other[-1] is not None:
            seconds, value = timed(peer, argument, limit)
            other.append(seconds)
            values |= {value} if seconds is not None else set()
    mine = statistics.median(own)
    agreed = "" if len(values) == 1 else "  RANKS DIFFER"
    if None in other:
        verdict = f"{peer_name} more than {limit:.0f} s  > {limit / mine:.0f} x"
    else:
        theirs = statistics.median(other)
        verdict = f"{peer_name} {1e3 * theirs:9.1f} ms  {theirs / mine:.1f} x"
    return f"{name:46s} {kind:7s} ours {1e3 * mine:9.2f} ms  {verdict}{agreed}"


def main() -> None:
    """Print one line per system and contest."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    for name in SYSTEMS:
        if options.only in name:
            for kind in ("all", "rank", "reduce"):
                print(contest(name, kind, options.rounds, options.limit), flush=True)
    for name in DENSE:
        if options.only in name:
            print(contest(name, "determinant", options.rounds, options.limit), flush=True)
    for name, (make, goal) in NAVIGATORS.items():
        if options.only in name:
            print(judge(name, "rank", ours_rank, make(), goal), flush=True)
            for kind in ("rank", "doubles"):
                print(contest(name, kind, options.rounds, options.limit), flush=True)
    for name, goal in TRIPLES.items():
        if options.only in name:
            print(judge(name, "set", complete_set, name, goal), flush=True)


if __name__ == "__main__":
    main()
