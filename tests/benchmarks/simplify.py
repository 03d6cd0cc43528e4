"""navsym against sympy's ``simplify`` on formulas of navigation, in one run: times and answers.

    python tests/benchmarks/simplify.py [--limit SECONDS] [--write README.md]

Both get the same two sides. navsym reads them as text and decides; sympy simplifies their difference, in a process of
its own that is ended at the limit. An answer of sympy other than 0 leaves the question open.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
from pathlib import Path

import sympy as sp

import navsym as nav
from navsym.language.printer import to_text

L, e, a, h = sp.symbols("L e a h", real=True)
x, y, z = sp.symbols("x y z", real=True)
MARKS = ("<!-- simplify -->\n", "<!-- end of simplify -->\n")
DECLARED = {"L": ("-1.5", "1.5"), "e": ("0", "1/2"), "a": "positive", "h": "positive"}

Row = tuple[str, sp.Expr, sp.Expr]


def cross(u: sp.Matrix) -> sp.Matrix:
    """The matrix of the product u x ."""
    return sp.Matrix([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])


def normal_radius() -> sp.Expr:
    """Radius of curvature of the prime vertical."""
    return a / sp.sqrt(1 - e**2 * sp.sin(L) ** 2)


def meridian_radius() -> sp.Expr:
    """Radius of curvature of the meridian."""
    return a * (1 - e**2) / (1 - e**2 * sp.sin(L) ** 2) ** sp.Rational(3, 2)


def coriolis() -> Row:
    """North component of ``C r'' = v' + w x v`` for a position over the ellipsoid, differentiated along the motion."""
    t = sp.Symbol("t", real=True)
    track = [sp.Function(name)(t) for name in ("L", "m", "h")]
    names = ("L", "m", "h")
    plain = {f: sp.Symbol(n, real=True) for f, n in zip(track, names, strict=True)}
    rates = {f.diff(t): sp.Symbol(n + "d", real=True) for f, n in zip(track, names, strict=True)}
    second = {f.diff(t, 2): sp.Symbol(n + "dd", real=True) for f, n in zip(track, names, strict=True)}
    latitude, longitude, height = track
    N = normal_radius().subs(L, latitude)
    s, c, sl, cl = sp.sin(latitude), sp.cos(latitude), sp.sin(longitude), sp.cos(longitude)
    r = sp.Matrix([(N + height) * c * cl, (N + height) * c * sl, (N * (1 - e**2) + height) * s])
    C = sp.Matrix([[-s * cl, -s * sl, c], [-sl, cl, 0], [-c * cl, -c * sl, -s]])
    M, R = meridian_radius().subs(L, latitude) + height, N + height
    v = sp.Matrix([M * latitude.diff(t), R * c * longitude.diff(t), -height.diff(t)])
    w = sp.Matrix([longitude.diff(t) * c, -latitude.diff(t), -longitude.diff(t) * s])
    left, right = (C * r.diff(t, 2))[0], (v.diff(t) + cross(w) * v)[0]
    return "Coriolis equation on the ellipsoid", *(side.subs(second).subs(rates).subs(plain) for side in (left, right))


def right_jacobian() -> tuple[sp.Matrix, sp.Matrix]:
    """The right Jacobian of SO(3) at (x, y, z) and what is printed as its inverse."""
    p = sp.sqrt(x**2 + y**2 + z**2)
    K = cross(sp.Matrix([x, y, z]))
    J = sp.eye(3) - (1 - sp.cos(p)) / p**2 * K + (p - sp.sin(p)) / p**3 * K**2
    inverse = sp.eye(3) + K / 2 + (1 / p**2 - (1 + sp.cos(p)) / (2 * p * sp.sin(p))) * K**2
    return J, inverse


def jacobian() -> Row:
    """Entry (1, 2) of the right Jacobian of SO(3) times its inverse."""
    J, inverse = right_jacobian()
    return "Jacobian of SO(3) times its inverse, entry (1, 2)", (J * inverse)[0, 1], sp.S.Zero


def bortz() -> Row:
    """The rotation vector's rate by Bortz' equation gives back the angular rate, first component."""
    w = sp.Matrix(sp.symbols("w1 w2 w3", real=True))
    p = sp.sqrt(x**2 + y**2 + z**2)
    K = cross(sp.Matrix([x, y, z]))
    rate = w + K * w / 2 + (1 - p * sp.sin(p) / (2 * (1 - sp.cos(p)))) / p**2 * K * K * w
    return "Bortz' equation", (right_jacobian()[0] * rate)[0], w[0]


def arc() -> Row:
    """The meridian's arc per radian of latitude, squared, from the coordinates of the ellipse."""
    N = normal_radius()
    length = sp.diff(N * sp.cos(L), L) ** 2 + sp.diff(N * (1 - e**2) * sp.sin(L), L) ** 2
    return "meridian radius from the ellipse", length, meridian_radius() ** 2


def isometric() -> Row:
    """The derivative of the isometric latitude is M / (N cos L)."""
    q = sp.log(sp.tan(sp.pi / 4 + L / 2)) + e / 2 * sp.log((1 - e * sp.sin(L)) / (1 + e * sp.sin(L)))
    return "derivative of the isometric latitude", sp.diff(q, L), meridian_radius() / (normal_radius() * sp.cos(L))


def simplified(left: sp.Expr, right: sp.Expr, limit: float) -> tuple[str, float]:
    """What sympy makes of the difference, and its time."""
    context = multiprocessing.get_context("fork")
    queue: multiprocessing.Queue[str] = context.Queue()

    def work() -> None:
        queue.put("0" if sp.simplify(left - right) == 0 else "not 0")

    start = time.perf_counter()
    child = context.Process(target=work)
    child.start()
    child.join(limit)
    spent = time.perf_counter() - start
    if child.is_alive():
        child.kill()
        child.join()
        return "no answer", spent
    return (queue.get(timeout=5) if child.exitcode == 0 else "an error"), spent


def rows(limit: float) -> list[tuple[str, str, float, str, float]]:
    """Title, navsym's verdict and seconds, sympy's answer and seconds."""
    nav.prove("x = x")  # engines are loaded before the clock starts, for both
    table = []
    for title, left, right in (make() for make in (coriolis, bortz, jacobian, arc, isometric)):
        names = {symbol.name for symbol in (left - right).free_symbols}
        texts = to_text(left), to_text(right)
        start = time.perf_counter()
        verdict = nav.prove(texts[0], "=", texts[1], **{n: d for n, d in DECLARED.items() if n in names})
        spent = time.perf_counter() - start
        table.append((title, str(verdict.status), spent, *simplified(left, right, limit)))
    return table


def markdown(limit: float) -> str:
    """The table for the README."""
    lines = ["| formula | navsym | time | `sympy.simplify` | time |", "| --- | --- | --: | --- | --: |"]
    for title, status, ours, answer, theirs in rows(limit):
        lines.append(f"| {title} | {status} | {ours:.2f} s | {answer} | {theirs:.2f} s |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Print the table, or put it between its marks in a page."""
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("--limit", type=float, default=120.0)
    options.add_argument("--write", type=Path)
    given = options.parse_args()
    table = markdown(given.limit)
    print(table)
    if given.write is not None:
        text = given.write.read_text(encoding="utf-8")
        before, rest = text.split(MARKS[0])
        given.write.write_text(before + MARKS[0] + table + MARKS[1] + rest.split(MARKS[1])[1], encoding="utf-8")


if __name__ == "__main__":
    main()
