"""Ratios of exported C against hand-written C, casadi's C and numpy, measured alternately in one run.

    python tests/benchmarks/export.py [--points N] [--updates N]

Times are processor time, of all threads together: what waits for another program on the machine is not counted.
Twelve functions H(t) = (1, t, sin t, cos t, …, sin 5t, cos 5t) at N points, as C and as a batch; the Kalman update of
9 states by 3 measurements. Needs gcc; prints ratios and asserts nothing about times, only that all programs compute
the same numbers.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import tempfile
import time
from pathlib import Path

import casadi as ca
import numpy as np
import sympy as sp

from navsym.claims import Equation
from navsym.core.casadi_functions import casadi_function
from navsym.export.functions import function_of, material
from navsym.export.languages import batch, c
from navsym.export.languages.casadi import generated
from navsym.export.parts import ExportedFunction, Material
from navsym.export.ready import algorithm
from navsym.prove.ladder import decide

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
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &at);
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
    subprocess.run(["gcc", "-O2", *sources, "-o", "run", "-lm"], cwd=folder, check=True, timeout=120)
    return folder / "run"


def in_batches(points: int) -> dict[str, float]:
    """Exported batch against lambdify(cse=True), alternately: results dropped, in an array used again, and held."""
    function = exported()
    call = sp.lambdify(t, list(regressors()), cse=True)
    grid = np.linspace(0.0, 3.0, points)
    with tempfile.TemporaryDirectory() as folder:
        for name, text in batch.files([function], {function.name: []}, "").items():
            (Path(folder) / name).write_text(text)
        spec = importlib.util.spec_from_file_location("navsym_batch", Path(folder) / "navsym_batch.py")
        assert spec and spec.loader
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        ours, out = getattr(module, function.name), np.empty((function.size, points))
        held = [ours(grid[None, :])]  # a result that is still in use: the next one needs memory of its own
        ways = {
            "lambdify": lambda: np.array([np.broadcast_to(row, grid.shape) for row in call(grid)]),
            "rows": lambda: call(grid),
            "fresh": lambda: ours(grid[None, :]),
            "again": lambda: ours(grid[None, :], out),
            "held": lambda: held.append(ours(grid[None, :])) or held.pop(0),
        }
        assert np.allclose(ways["lambdify"](), ways["fresh"](), rtol=1e-9, atol=1e-12)
        best = dict.fromkeys(ways, np.inf)
        for _ in range(ROUNDS):
            for name, way in ways.items():
                start = time.process_time()
                way()
                best[name] = min(best[name], time.process_time() - start)
    return {
        "lambdify(cse=True), batch": best["fresh"] / best["lambdify"],
        "lambdify(cse=True), batch into an array used again": best["again"] / best["lambdify"],
        "lambdify(cse=True), batch while the last result is held": best["held"] / best["lambdify"],
        "lambdify(cse=True) that leaves its rows apart": best["fresh"] / best["rows"],
    }


def numbers_of(program: Path, count: int) -> list[float]:
    """What a program of the benchmark prints: best times of the three versions, and their sums."""
    words = [str(program), str(count)]
    text = subprocess.run(words, capture_output=True, text=True, check=True, timeout=600).stdout
    return [float(word) for word in text.split()]


def measure(points: int) -> dict[str, float]:
    """Ratios of times: below one the exported code is faster."""
    with tempfile.TemporaryDirectory() as folder:
        program = build(Path(folder), exported())
        ours, hand, casadi, *sums = numbers_of(program, points)
    assert np.allclose(sums, sums[0], rtol=1e-9), "the three programs must agree"
    return {"hand-written C": ours / hand, "casadi C": ours / casadi} | in_batches(points)


# -- Kalman's update ---------------------------------------

STATES, MEASURED = 9, 3

KALMAN_HAND = """void hand(const double *x, const double P[9][9], const double *z, const double H[3][9],
          const double *R, double *xn, double Pn[9][9])
{
    double g[9], s, v;
    int i, j, k;
    for (i = 0; i < 9; i++) {
        xn[i] = x[i];
        for (j = 0; j < 9; j++) {
            Pn[i][j] = P[i][j];
        }
    }
    for (k = 0; k < 3; k++) {
        s = R[k];
        v = z[k];
        for (i = 0; i < 9; i++) {
            g[i] = 0.0;
            for (j = 0; j < 9; j++) {
                g[i] += Pn[i][j] * H[k][j];
            }
            s += H[k][i] * g[i];
            v -= H[k][i] * xn[i];
        }
        for (i = 0; i < 9; i++) {
            const double gain = g[i] / s;
            xn[i] += gain * v;
            for (j = i; j < 9; j++) {
                Pn[i][j] -= gain * g[j];
                Pn[j][i] = Pn[i][j];
            }
        }
    }
}
"""

KALMAN_DRIVER = """#define _POSIX_C_SOURCE 199309L
#include "kalman_update_9_3.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void hand(const double *x, const double P[9][9], const double *z, const double H[3][9], const double *R,
          double *xn, double Pn[9][9]);
int peer(const double **arg, double **res, long long *iw, double *w, int mem);

static double now(void)
{{
    struct timespec at;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}}

int main(int argc, char **argv)
{{
    const int n = argc > 1 ? atoi(argv[1]) : 100000;
    static double x[9], P[9][9], U[45], z[3], H[3][9], R[3] = {{0.5, 1.0, 2.0}}, xn[9], Pn[9][9], Un[45], w[2000];
    static double Hc[27], Hr[27];
    double best[3] = {{1e9, 1e9, 1e9}}, sum[3] = {{0.0, 0.0, 0.0}};
    long long iw[100];
    int round, who, i, j, k, at = 0;
    for (i = 0; i < 9; i++) {{
        for (j = 0; j < 9; j++) {{
            P[i][j] = (i == j) ? 3.0 + 0.1 * i : 0.02 * ((i * j) % 5 - 2);
        }}
        for (k = 0; k < 3; k++) {{
            H[k][i] = 0.1 * ((i + 2 * k) % 7) - 0.3;
            Hc[3 * i + k] = H[k][i];
            Hr[9 * k + i] = H[k][i];
        }}
    }}
    for (i = 0; i < 9; i++) {{
        for (j = i; j < 9; j++) {{
            U[at++] = P[i][j];
        }}
    }}
    for (round = 0; round < {rounds}; round++) {{
        for (who = 0; who < 3; who++) {{
            const double start = now();
            double total = 0.0;
            for (k = 0; k < n; k++) {{
                z[0] = 1e-6 * k;
                x[8] = 1e-7 * k;
                if (who == 0) {{
                    (void)kalman_update_9_3(x, U, z, Hr, R, xn, Un);
                    total += xn[0] + xn[8] + Un[0] + Un[8] + Un[44];
                }} else {{
                    if (who == 1) {{
                        hand(x, (const double (*)[9])P, z, (const double (*)[9])H, R, xn, Pn);
                    }} else {{
                        const double *arg[5] = {{x, &P[0][0], z, Hc, R}};
                        double *res[2] = {{xn, &Pn[0][0]}};
                        (void)peer(arg, res, iw, w, 0);
                    }}
                    total += xn[0] + xn[8] + Pn[0][0] + Pn[0][8] + Pn[8][8];
                }}
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


def casadi_update() -> str:
    """The update as casadi's users write it: full matrices, gain from the inverse of the innovation's covariance."""
    x, P, z = ca.SX.sym("x", STATES), ca.SX.sym("P", STATES, STATES), ca.SX.sym("z", MEASURED)
    H, R = ca.SX.sym("H", MEASURED, STATES), ca.SX.sym("R", MEASURED)
    gain = P @ H.T @ ca.inv(H @ P @ H.T + ca.diag(R))
    made = ca.Function("peer", [x, P, z, H, R], [x + gain @ (z - H @ x), P - gain @ H @ P])
    return generated(made, "peer")


def measure_update(updates: int) -> dict[str, float]:
    """Ratios of times of one Kalman update."""
    (function,) = algorithm("kalman-update-9-3", no_claim, "double")
    with tempfile.TemporaryDirectory() as folder:
        files = c.files([function], {function.name: []}, "")
        for name in ("navsym_status.h", f"{function.name}.h", f"{function.name}.c"):
            (Path(folder) / name).write_text(files[name])
        (Path(folder) / "hand.c").write_text(KALMAN_HAND)
        (Path(folder) / "peer.c").write_text(casadi_update())
        (Path(folder) / "driver.c").write_text(KALMAN_DRIVER.format(rounds=ROUNDS))
        sources = [f"{function.name}.c", "hand.c", "peer.c", "driver.c"]
        subprocess.run(["gcc", "-O2", *sources, "-o", "run", "-lm"], cwd=folder, check=True, timeout=120)
        ours, hand, casadi, *sums = numbers_of(Path(folder) / "run", updates)
    assert np.allclose(sums, sums[0], rtol=1e-9), f"the three programs must agree: {sums}"
    return {"Kalman update, hand-written C": ours / hand, "Kalman update, casadi C": ours / casadi}


def no_claim(claim: str) -> Material:
    raise AssertionError(f"the update needs no claim of a paper, but asked for {claim}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--updates", type=int, default=100_000)
    options = parser.parse_args()
    for peer, ratio in (measure(options.points) | measure_update(options.updates)).items():
        print(f"exported C / {peer}: {ratio:.3f}  ({1 / ratio:.1f} times)")


if __name__ == "__main__":
    main()
