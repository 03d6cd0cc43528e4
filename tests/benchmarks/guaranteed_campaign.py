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
import random
import time
from collections import Counter

import numpy as np
import sympy as sp
from scipy.optimize import linprog

from navsym import checker
from navsym.errors import NavsymError
from navsym.methods.guaranteed import solve
from navsym.methods.guaranteed_compare import panel_numbers
from navsym.methods.guaranteed_problem import from_regressors

t = sp.Symbol("t", real=True)


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
    panel = problem.exact().panels[0]
    H, _, _ = panel_numbers(panel, np.linspace(0.0, 1.0, count))
    scale = np.abs(H).max(axis=1)
    P = np.array([float(p) for p in problem.functional]) / scale
    A = H / scale[:, None]
    answer = linprog(np.ones(2 * count), A_eq=np.hstack([A, -A]), b_eq=P, method="highs")
    return answer.fun if answer.success else None


def altered(item, rng):
    """A copy with one number or sign changed enough to matter."""
    forged = copy.deepcopy(item)
    key = rng.choice(["dual", "functional", "bound", "sigma", "point", "sign"])
    if key == "dual":
        # Scaling the whole dual of a gap breaks its bound; another single entry may be another good dual.
        if forged["kind"] == "gap":
            forged["dual"] = [scaled(x, 11) for x in forged["dual"]]
            return forged
        row = rng.randrange(len(forged["dual"]))
        entry = forged["dual"][row]
        value = float(entry if isinstance(entry, str) else entry[0])
        text = repr(round(value * 1.5 + 1e-3 + abs(value), 12)) if abs(value) < 1e15 else "1"
        if "e" in text:
            text = "5"
        forged["dual"][row] = text if isinstance(entry, str) else [text]
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
        rows = forged["support"] if "support" in forged else forged["contacts"]
        row = rng.choice(rows)
        if isinstance(row, list):
            row[1] = rng.choice(["-0.1", "1.1", "2"])
        else:
            row["weight"] = [scaled(row["weight"][0], 12)]
    else:
        if "contacts" in forged:
            row = rng.choice(forged["contacts"])
            row["sign"] = -row["sign"]
        else:
            forged["support"] = forged["support"][:-1]
    return forged


def scaled(text, tenths):
    from fractions import Fraction

    value = Fraction(text) * tenths / 10
    return f"{value.numerator}/{value.denominator}" if len(str(value.denominator)) < 90 else "7"


def difference(forged, certificates):
    """What was changed, for the reader who judges whether it is still true."""
    near = min(certificates, key=lambda c: sum(c.get(k) != v for k, v in forged.items()))
    return [(k, near.get(k), v) for k, v in forged.items() if near.get(k) != v]


def accepted(item) -> bool:
    try:
        checker.check(checker.load(json.dumps(item)))
    except checker.Refused:
        return False
    return True


def main(problems=2000, alterations=5000, seed=1, digits=12, seconds=1e9):
    rng = random.Random(seed)
    begun = time.perf_counter()
    counts, bad, spent = Counter(), [], 0.0
    certificates = []
    for k in range(problems):
        if time.perf_counter() - begun > seconds / 2:
            break
        problem = made(rng)
        start = time.perf_counter()
        try:
            solution = solve(problem, digits)
        except NavsymError as error:
            counts[f"refused: {error.kind}"] += 1
            continue
        spent += time.perf_counter() - start
        counts["solved"] += 1
        counts["certified"] += solution.width <= 10.0**-digits
        counts[solution.certificate["kind"]] += 1
        if solution.width > 10.0**-digits:
            bad.append(
                (
                    k,
                    solution.width,
                    str(problem.stretches[0].rows),
                    str(problem.functional),
                    str(problem.interval),
                )
            )
        if not accepted(solution.certificate):
            counts["CONTRADICTION: checker refuses"] += 1
            bad.append(
                (k, "checker", str(problem.stretches[0].rows), str(problem.functional), str(problem.interval))
            )
        else:
            certificates.append(dict(solution.certificate))
        if k % 4 == 0:
            grid = on_grid(problem)
            if grid is not None and grid < float(solution.lower) * (1 - 1e-5):
                counts["grid below lower bound"] += 1
                bad.append(
                    (
                        k,
                        grid,
                        solution.lower,
                        str(problem.stretches[0].rows),
                        str(problem.functional),
                        str(problem.interval),
                    )
                )
    passed = []
    for k in range(alterations if certificates else 0):
        if time.perf_counter() - begun > seconds:
            break
        forged = altered(rng.choice(certificates), rng)
        if forged in certificates:
            continue
        counts["altered"] += 1
        if accepted(forged):
            counts["ALTERED AND ACCEPTED"] += 1
            passed.append(k)
            print("accepted:", difference(forged, certificates))
    print(dict(counts))
    print(f"{1e3 * spent / max(1, counts['solved']):.1f} ms a problem")
    for row in bad[:12]:
        print(row)
    return counts


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", type=int, default=2000)
    parser.add_argument("--alterations", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9, help="stop after this time and report what was done")
    arguments = parser.parse_args()
    main(arguments.problems, arguments.alterations, arguments.seed, seconds=arguments.seconds)
