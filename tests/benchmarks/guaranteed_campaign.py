"""Random guaranteed problems and altered certificates: ``python tests/benchmarks/guaranteed_campaign.py``.

Each problem has 2 to 8 functions (powers, sines, cosines, exponentials, products), T from 0.1 to 10, unit,
random or degenerate functionals. Three routes must agree: the certified enclosure, the independent checker,
and HiGHS on a grid (an upper bound of the optimum up to its tolerance). Alterations of accepted certificates
must be refused, unless they leave the statement true.
"""

from __future__ import annotations

import argparse
import copy
import json
import os
import random
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import numpy as np
import sympy as sp
from scipy.optimize import linprog

from navsym import checker
from navsym.core.errors import NavsymError
from navsym.guaranteed.problem import from_regressors
from navsym.guaranteed.solver import solve

t = sp.Symbol("t", real=True)
#: Certificates of the first problems are kept for alterations.
KEPT = 300


def some_function(rng):
    w = sp.Rational(rng.randint(1, 12), rng.choice([1, 2, 4, 5]))
    a = sp.Rational(rng.randint(-6, 4), rng.choice([4, 5, 8]))
    kinds = [
        t ** rng.randint(0, 5),
        sp.sin(w * t),
        sp.cos(w * t),
        sp.exp(a * t),
        t * sp.sin(w * t),
        t * sp.exp(a * t),
        sp.exp(a * t) * sp.cos(w * t),
        sp.cos(w * t) - 1,
    ]
    return rng.choice(kinds)


def some_problem(rng):
    m = rng.randint(2, 8)
    functions = []
    while len(functions) < m:
        f = some_function(rng)
        if f not in functions and f != 0:
            functions.append(f)
    T = sp.Rational(rng.randint(1, 100), 10)
    kind = rng.random()
    if kind < 0.5:
        k = rng.randrange(m)
        P = [int(j == k) for j in range(m)]
    elif kind < 0.8:
        P = [sp.Rational(rng.randint(-9, 9), rng.randint(1, 5)) for _ in range(m)]
    else:  # the value at an instant, or the difference of two: few contacts
        at = T * sp.Rational(rng.randint(0, 4), 4)
        P = None, at
    return functions, P, T


def made(rng):
    functions, P, T = some_problem(rng)
    if isinstance(P, tuple):
        at = P[1]
        functions = [sp.sympify(f) for f in functions]
        P = [f.subs(t, at) for f in functions]
        if all(p == 0 for p in P):
            P[0] = sp.Integer(1)
    if all(p == 0 for p in P):
        P = [1] + [0] * (len(functions) - 1)
    return from_regressors([functions], P, t, (0, T))


def on_grid(problem, count=400):
    """The optimum on a grid by HiGHS, in orthogonal functions; None where doubles cannot tell.

    In the functions of the problem its tolerance may hide a solution that is far from one.
    """
    panel = problem.exact().panels[0]
    _, H, _ = panel.numbers(np.linspace(0.0, 1.0, count))
    scale = np.abs(H).max(axis=1)
    Q, R = np.linalg.qr((H / scale[:, None]).T)
    if np.linalg.cond(R) > 1e9:
        return None
    P = np.linalg.solve(R.T, np.array([float(p) for p in problem.functional]) / scale)
    size = np.abs(P).max()
    answer = linprog(np.ones(2 * count), A_eq=np.hstack([Q.T, -Q.T]), b_eq=P / size, method="highs")
    return float(answer.fun * size) if answer.success else None


def altered(item, rng):
    """A copy with one number or sign changed enough to matter."""
    forged = copy.deepcopy(item)
    key = rng.choice(["dual", "functional", "bound", "sigma", "point", "sign"])
    if key == "dual":
        # Scaling the whole dual of a gap breaks its bound; another single entry may be another good dual.
        if forged["kind"] == "gap":
            forged["dual"] = [scaled(x, 11) for x in forged["dual"]]
            return forged
        dual = forged["pieces"][0]["dual"]
        row = rng.randrange(len(dual))
        value = float(dual[row][0])
        text = repr(round(value * 1.5 + 1e-3 + abs(value), 12)) if abs(value) < 1e15 else "1"
        if "e" in text:
            text = "5"
        dual[row] = [text]
    elif key == "functional":
        forged["functional"] = [f"({p})*11/10" for p in forged["functional"]]
    elif key == "bound":
        if rng.random() < 0.5:
            forged["lower"] = scaled(forged["lower"], 11)
        else:
            forged["upper"] = scaled(forged["upper"], 9)
    elif key == "sigma":
        forged["panels"][0]["sigma"] = rng.choice(["9/10", "11/10", "-1", "0"])
    elif key == "point":
        rows = forged["support"] if "support" in forged else forged["pieces"][0]["contacts"]
        row = rng.choice(rows)
        if isinstance(row, list):
            row[1] = rng.choice(["-0.1", "1.1", "2"])
        else:
            row["weight"] = [scaled(row["weight"][0], 12)]
    else:
        if "pieces" in forged:
            row = rng.choice(forged["pieces"][0]["contacts"])
            row["weight"] = [f"-{row['weight'][0]}".replace("--", "")]
        else:
            forged["support"] = forged["support"][:-1]
    return forged


def scaled(text, tenths):
    from fractions import Fraction

    value = Fraction(text) * tenths / 10
    return f"{value.numerator}/{value.denominator}" if len(str(value.denominator)) < 90 else "7"


def accepted(item) -> bool:
    try:
        checker.check(checker.load(json.dumps(item)))
    except checker.Refused:
        return False
    return True


def problem_record(seed, k, digits):
    """Problem k solved, checked and compared with a grid; plain data."""
    problem = made(random.Random(f"problem {seed} {k}"))
    record = {"problem": k, "functions": str(problem.stretches[0].rows), "P": str(problem.functional)}
    record["T"] = str(problem.interval[1])
    start = time.perf_counter()
    try:
        solution = solve(problem, digits=digits)
    except NavsymError as error:
        return record | {"refused": error.kind}
    record |= {"seconds": time.perf_counter() - start, "width": solution.width, "kind": solution.certificate["kind"]}
    record |= {"unique": solution.unique, "accepted": accepted(solution.certificate)}
    grid = on_grid(problem) if k % 4 == 0 else None
    record["grid_below"] = grid is not None and grid < float(solution.lower) * (1 - 1e-5)
    if k < KEPT:
        record["certificate"] = dict(solution.certificate)
    return record


def alteration_record(seed, k, certificates):
    """Alteration k of a kept certificate: whether it was refused."""
    rng = random.Random(f"alteration {seed} {k}")
    original = rng.choice(certificates)
    forged = altered(original, rng)
    if forged == original:
        return {"alteration": k, "same": True}
    record = {"alteration": k, "kind": forged["kind"], "accepted": accepted(forged)}
    if record["accepted"]:
        record["changed"] = str([(key, original.get(key), v) for key, v in forged.items() if original.get(key) != v])
    return record


def known(path, name):
    """Records of one kind that an earlier run has written; a torn last line is left out."""
    if path is None or not path.exists():
        return {}
    found = {}
    for line in path.read_text().splitlines():
        try:
            record = json.loads(line)
        except ValueError:
            continue
        if name in record:
            found[record[name]] = record
    return found


def run(name, tasks, function, path, jobs, until):
    """Records of the tasks that are not known yet, in processes; every one is written at once."""
    records = known(path, name)
    missing = [k for k in tasks if k not in records]
    with ExitStack() as stack:
        each = map if jobs == 1 else stack.enter_context(ProcessPoolExecutor(jobs)).map
        file = stack.enter_context((path or Path(os.devnull)).open("a"))
        for start in range(0, len(missing), 8 * jobs):
            if time.perf_counter() > until:
                break
            for record in each(function, missing[start : start + 8 * jobs]):
                file.write(json.dumps(record) + "\n")
                file.flush()
                records[record[name]] = record
    return records


def table_of(problems, alterations, digits):
    """The figures of the campaign as rows of text."""
    solved = [r for r in problems.values() if "width" in r]
    refused = Counter(r["refused"] for r in problems.values() if "refused" in r)
    only, several = (sum(r["unique"] is word for r in solved) for word in (True, False))
    certified = [r for r in solved if r["width"] <= 10.0**-digits]
    altered_ = [r for r in alterations.values() if not r.get("same")]
    rows = [
        ("problems", len(problems)),
        ("solved", len(solved)),
        (f"certified at 1e-{digits}", f"{len(certified)} ({100 * len(certified) / max(1, len(solved)):.2f} %)"),
        *((f"by {kind}", n) for kind, n in sorted(Counter(r["kind"] for r in solved).items())),
        *((f"refused: {kind}", n) for kind, n in sorted(refused.items())),
        ("contradictions: checker refuses", sum(not r["accepted"] for r in solved)),
        ("contradictions: grid below the lower bound", sum(r["grid_below"] for r in solved)),
        ("proved unique / proved not unique", f"{only} / {several}"),
        ("median and largest time, ms", "{:.1f} / {:.0f}".format(*times_of(solved))),
        ("altered certificates", len(altered_)),
        ("of these accepted", sum(r["accepted"] for r in altered_)),
    ]
    return "\n".join(f"{name:45} {value}" for name, value in rows)


def times_of(solved):
    seconds = sorted(1e3 * r["seconds"] for r in solved) or [0.0]
    return seconds[len(seconds) // 2], seconds[-1]


def main(problems=2000, alterations=5000, seed=1, digits=12, seconds=1e9, jobs=1, out=None):
    begun = time.perf_counter()
    done = run("problem", range(problems), partial(problem_record, seed, digits=digits), out, jobs, begun + seconds / 2)
    kept = [done[k]["certificate"] for k in sorted(done) if done[k].get("accepted") and "certificate" in done[k]]
    tasks = range(alterations if kept else 0)
    forged = run("alteration", tasks, partial(alteration_record, seed, certificates=kept), out, jobs, begun + seconds)
    print(table_of(done, forged, digits))
    for record in [*done.values(), *forged.values()]:
        wide = record.get("width", 0.0) > 10.0**-digits
        if wide or record.get("accepted") is ("alteration" in record) or record.get("grid_below"):
            print({k: v for k, v in record.items() if k != "certificate"})
    return done, forged


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", type=int, default=2000)
    parser.add_argument("--alterations", type=int, default=6000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9, help="stop after this time and report what was done")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, help="records, a line each; a second run goes on where the first stopped")
    a = parser.parse_args()
    main(a.problems, a.alterations, a.seed, seconds=a.seconds, jobs=a.jobs, out=a.out)
