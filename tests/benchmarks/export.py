"""Ratios of exported C against hand-written C, casadi's C and numpy, measured alternately in one run.

    python tests/benchmarks/export.py [--points N]

Twelve functions H(t) = (1, t, sin t, cos t, …, sin 5t, cos 5t) at N points. Needs gcc; prints ratios and
asserts nothing about times, only that all programs compute the same numbers.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import sympy as sp

from navsym.claims import Equation
from navsym.export import c
from navsym.export.casadi import generated
from navsym.export.functions import ExportedFunction, function_of, material
from navsym.numeric.casadi_functions import casadi_function
from navsym.proof.ladder import decide

t = sp.Symbol("t", real=True)
HARMONICS = 5
ROUNDS = 7

HAND = """#include <math.h>
void hand(double t, double *h)
{
    const double s = sin(t), c = cos(t);
    double sk = s, ck = c;
    int k;
    h[0] = 1.0;
    h[1] = t;
    for (k = 0; k < %d; k++) {
        const double next = sk * c + ck * s;
        h[2 + 2 * k] = sk;
        h[3 + 2 * k] = ck;
        ck = ck * c - sk * s;
        sk = next;
    }
}
"""

DRIVER = """#define _POSIX_C_SOURCE 199309L
#include "{name}.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void hand(double t, double *h);
int peer(const double **arg, double **res, long long *iw, double *w, int mem);

static double now(void)
{{
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}}

int main(int argc, char **argv)
{{
    const int n = argc > 1 ? atoi(argv[1]) : 1000000;
    double best[3] = {{1e9, 1e9, 1e9}}, sum[3] = {{0.0, 0.0, 0.0}}, h[{size}], w[400];
    long long iw[10];
    int round, who, k;
    for (round = 0; round < {rounds}; round++) {{
        for (who = 0; who < 3; who++) {{
            const double start = now();
            double total = 0.0;
            for (k = 0; k < n; k++) {{
                const double t = 3.0 * (double)k / n;
                if (who == 0) {{
                    (void){name}(t, h);
                }} else if (who == 1) {{
                    hand(t, h);
                }} else {{
                    const double *arg[1] = {{&t}};
                    double *res[1] = {{h}};
                    (void)peer(arg, res, iw, w, 0);
                }}
                total += h[2] + h[{size} - 1] + h[{size} / 2];
            }}
            sum[who] = total;
            if (now() - start < best[who]) {{
                best[who] = now() - start;
            }}
        }}
    }}
    printf("%.9g %.9g %.9g %.12g %.12g %.12g\\n", best[0], best[1], best[2], sum[0], sum[1], sum[2]);
    return 0;
}}
"""


def regressors() -> sp.Matrix:
    return sp.Matrix([1, t, *(f(k * t) for k in range(1, HARMONICS + 1) for f in (sp.sin, sp.cos))])


def exported() -> ExportedFunction:
    formulas = regressors()
    statement = Equation(formulas, formulas, {t: (0, 3)})
    return function_of([material("benchmark:H", statement, decide(statement))], name="harmonics")


def build(folder: Path, function: ExportedFunction) -> Path:
    """One program that calls the three versions in turn."""
    license_ = "SPDX-License-Identifier: Apache-2.0"
    files = c.files([function], {function.name: []}, license_)
    for name in ("navsym_status.h", f"{function.name}.h", f"{function.name}.c"):
        (folder / name).write_text(files[name])
    (folder / "hand.c").write_text(HAND % HARMONICS)
    (folder / "peer.c").write_text(generated(casadi_function("peer", [t], regressors()), "peer"))
    (folder / "driver.c").write_text(DRIVER.format(name=function.name, size=function.size, rounds=ROUNDS))
    sources = [f"{function.name}.c", "hand.c", "peer.c", "driver.c"]
    subprocess.run(["gcc", "-O2", *sources, "-o", "run", "-lm"], cwd=folder, check=True)
    return folder / "run"


def lambdified(points: int) -> float:
    """Least time of sympy's lambdify(cse=True) over the same points."""
    call = sp.lambdify(t, list(regressors()), cse=True)
    grid, best = np.linspace(0.0, 3.0, points), np.inf
    for _ in range(3):
        start = time.perf_counter()
        np.array([np.broadcast_to(row, grid.shape) for row in call(grid)])
        best = min(best, time.perf_counter() - start)
    return float(best)


def measure(points: int) -> dict[str, float]:
    """Ratios of times: below one the exported code is faster."""
    with tempfile.TemporaryDirectory() as folder:
        program = build(Path(folder), exported())
        text = subprocess.run([str(program), str(points)], capture_output=True, text=True, check=True).stdout
    ours, hand, casadi, *sums = (float(word) for word in text.split())
    assert np.allclose(sums, sums[0], rtol=1e-9), "the three programs must agree"
    return {"hand-written C": ours / hand, "casadi C": ours / casadi, "lambdify(cse=True)": ours / lambdified(points)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=1_000_000)
    for peer, ratio in measure(parser.parse_args().points).items():
        print(f"exported C / {peer}: {ratio:.3f}  ({1 / ratio:.1f} times)")


if __name__ == "__main__":
    main()
