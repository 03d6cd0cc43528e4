"""A model as flight code: F, Phi(dt), H, Qd(dt), and the steps of a Kalman filter in Joseph's form and in UD form.

Symmetric matrices are upper triangles, row by row; ``U`` is the strict upper triangle of the unit factor in
``P = U D U'``. Measurements are scalar and come one at a time. Ranges of states, of parameters and of the step ``dt``
are those that the model declares: the rounding bounds hold in them, and the test vectors are drawn from them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from itertools import combinations_with_replacement as pairs
from typing import Any

import sympy as sp

from navsym.claims import Equation, Statement
from navsym.core.balls import enclose
from navsym.core.errors import DomainError, DuplicateError
from navsym.export.algorithms.kalman import entry, information, scalar_product, triangle
from navsym.export.chain import SECONDS, Chain, Link, define, real
from navsym.export.functions import function_of, material, require_exportable
from navsym.export.languages.names import function_name
from navsym.export.parts import ExportedFunction, Layout, Material, Output
from navsym.models.modelfile import STEP, ModelFile, linear_model
from navsym.models.transition.exponential import need_constant, transition_matrix
from navsym.models.transition.integral import noise_integral
from navsym.prove.ladder import decide_within

Range = tuple[float, float]
MOST_UD = 8  # states of a prediction in UD form: its code without loops grows as their cube


@dataclass(frozen=True, slots=True)
class Plant:
    """A model with everything that its code needs.

    F, H, Phi : matrices (n, n), (p, n), (n, n); Phi in the parameters and ``dt``
    variances : of the measurement errors, sigma squared
    ranges    : name of a parameter or of ``dt`` -> exact ends, what the code accepts
    least     : the smallest step from which vectors are drawn
    sizes     : largest magnitude of each state
    """

    name: str
    states: tuple[str, ...]
    measurements: tuple[str, ...]
    F: sp.ImmutableMatrix
    H: sp.ImmutableMatrix
    Phi: sp.ImmutableMatrix
    dt: sp.Symbol
    variances: tuple[sp.Expr, ...]
    ranges: Mapping[str, tuple[Any, Any]]
    least: float
    sizes: tuple[float, ...]

    @property
    def n(self) -> int:
        """Number of states."""
        return len(self.states)

    @property
    def steps(self) -> dict[str, Range]:
        """The steps from which vectors are drawn, by their name."""
        return {STEP: (self.least, float(self.ranges[STEP][1]))}

    @property
    def box(self) -> dict[sp.Symbol, tuple[Any, Any]]:
        """Ranges by symbol."""
        symbols = {
            s for e in (*self.F, *self.H, *self.variances, self.dt) for s in sp.sympify(e, strict=True).free_symbols
        }
        return {s: self.ranges[s.name] for s in symbols}


def functions_of_model(found: ModelFile, real: str, units: Mapping[str, str]) -> Iterator[ExportedFunction]:
    """All functions of a model in one piece with constant F and H.

    ``F``, ``H``, ``Phi`` and ``Qd`` are proved by what defines them; ``predict``, ``update_NAME`` and the same with
    ``_ud`` are chains whose links are proved. Raises DomainError that lists every range that is not declared.
    """
    plant = plant_of(found)
    q = free_letter(plant, "q")
    for name, matrix, law, title in matrices_of(plant):
        arrays = {q: tuple(f"{q}{k}" for k in range(plant.n))} if name == "Qd" else {}
        layout = Layout(arrays, (STEP, q), plant.steps | {q: (0.0, 1.0)}, units)
        title = f"{title}; states {', '.join(plant.states)}"
        yield matrix_function(f"{plant.name}:{name}", matrix, law, title, real, layout, plant.box)
    for name, chain in chains_of(plant, units):
        yield chain.function(function_name(f"{plant.name}_{name}"), undecided, real)


def plant_of(found: ModelFile) -> Plant:
    """The model, read for its code; raises DomainError for missing ranges."""
    linear = linear_model(found)
    need_constant(linear)
    if STEP in found.parameters:
        raise DuplicateError(f"expected {STEP} for the step alone; got a parameter of this name; rename it")
    used = {s.name for m in found.measurements for e in (*m.h, m.sigma) for s in e.free_symbols}
    used |= {s.name for s in linear.F.free_symbols}
    declared: dict[str, tuple[Any, Any]] = {s.name: ends for s, ends in found.box.items()} | dict(found.ranges)
    require_ranges([*found.states, STEP, *sorted(used)], declared)
    dt = sp.Symbol(STEP, real=True)  # zero is accepted: forms that keep their digits there are chosen
    return Plant(
        name=plain_name(found.name),
        states=found.states,
        measurements=tuple(m.name for m in found.measurements),
        F=linear.F,
        H=linear.H,
        Phi=transition_matrix(linear.F, dt).matrix,
        dt=dt,
        variances=tuple(m.sigma**2 for m in found.measurements),
        ranges={name: declared[name] for name in sorted(used)} | {STEP: (sp.S.Zero, declared[STEP][1])},
        least=float(declared[STEP][0]),
        sizes=tuple(max(abs(float(end)) for end in declared[name]) for name in found.states),
    )


def plain_name(title: str) -> str:
    """The title of a model as the beginning of a name in code."""
    return re.sub(r"\W+", "_", title).strip("_") or "model"


def require_ranges(names: Sequence[str], declared: Mapping[str, Any]) -> None:
    """Raise DomainError with the lines to be added for everything that has no range."""
    missing = [name for name in names if name not in declared]
    if missing:
        lines = "; ".join(f'{name} = ["LOW", "HIGH"]' for name in missing)
        raise DomainError(
            f"expected a range of every input, from which vectors are drawn; got none of {', '.join(missing)}; "
            f"write in the model file: [ranges] {lines}",
            where="model: ranges",
        )


def undecided(claim: str) -> Material:
    """The chains of a model cite no claims of papers."""
    raise DomainError(f"expected formulas of the model; got the claim {claim}; report this")


def matrices_of(plant: Plant) -> Iterator[tuple[str, sp.MatrixBase | list[sp.Expr], Statement | None, str]]:
    """Name, entries, the statement that makes them right (None: they are the model's own), and a title."""
    F, Phi, dt, n = plant.F, plant.Phi, plant.dt, plant.n
    yield "F", F, None, "Matrix of the system, dx/dt = F x"
    if plant.H.rows:
        yield "H", plant.H, None, f"Rows of the measurements {', '.join(plant.measurements)}: z = H x + r"
    yield "Phi", Phi, transition_law(plant), "Transition matrix over dt: Phi' = F Phi, Phi(0) = 1"
    q = sp.symbols([f"{free_letter(plant, 'q')}{k}" for k in range(n)], nonnegative=True)
    Qd = noise_integral(Phi, q, dt)
    rate = F * Qd + Qd * F.T + sp.diag(*q)
    entries = upper(Qd)
    law = Equation(
        printed=[e.diff(dt) for e in entries] + [e.subs(dt, 0) for e in entries],
        derived=upper(rate) + [sp.S.Zero] * len(entries),
    )
    title = (
        "Covariance of white noise of intensities q over dt, upper triangle: Qd' = F Qd + Qd F' + diag(q), Qd(0) = 0"
    )
    yield "Qd", entries, law, title


def transition_law(plant: Plant) -> Equation:
    """``Phi' = F Phi`` and ``Phi(0) = 1``."""
    F, Phi, dt = plant.F, plant.Phi, plant.dt
    return Equation(printed=[*Phi.diff(dt), *Phi.subs(dt, 0)], derived=[*(F * Phi), *sp.eye(plant.n)])


def matrix_function(
    label: str,
    matrix: Any,
    law: Statement | None,
    title: str,
    real: str,
    layout: Layout,
    box: Mapping[sp.Symbol, tuple[Any, Any]] | None = None,
) -> ExportedFunction:
    """A matrix ``MODEL:NAME`` as a function of what it depends on; raises RefusedError when its law does not hold."""
    statement = Equation(matrix, matrix)
    verdict = decide_within(law or statement, SECONDS)
    require_exportable(label, verdict, None, False)
    part = material(label, statement, verdict, title=title)
    ((out, flat),) = part.results
    part = Material(label, [(Output(label.rpartition(":")[2], out.shape), flat)], box or {}, part.source)
    return function_of([part], real=real, name=function_name(label.replace(":", "_")), layout=layout)


def free_letter(plant: Plant, letter: str) -> str:
    """A name for an array whose entries, the name with numbers, are no parameters of the model."""
    while any(re.fullmatch(rf"{letter}[\d_]*", name) for name in plant.ranges):
        letter += "_"
    return letter


class Steps:
    """A chain under construction: its arguments with their ranges, and its links; numbers get no name of their own."""

    def __init__(self, plant: Plant, units: Mapping[str, str]):
        self.plant, self.units = plant, units
        self.links: list[Link] = []
        self.arrays: dict[str, tuple[str, ...]] = {}
        self.tests: dict[str, Range] = {}

    def letter(self, letter: str) -> str:
        """The letter, or one that no parameter of the model has."""
        return free_letter(self.plant, letter)

    def given(self, letter: str, ranges: Mapping[str, Range]) -> list[sp.Symbol]:
        """An array argument of these entries, each with its range."""
        self.arrays |= {letter: tuple(ranges)} if ranges else {}
        self.tests |= ranges
        return [real(name) for name in ranges]

    def state(self) -> sp.Matrix:
        """The state as an argument."""
        x = self.letter("x")
        return sp.Matrix(self.given(x, {f"{x}{i}": (-size, size) for i, size in enumerate(self.plant.sizes)}))

    def covariance(self, letter: str) -> sp.Matrix:
        """A covariance as an argument, in ranges in which it is positive definite: its scaled diagonal dominates."""
        name, n, sizes = self.letter(letter), self.plant.n, self.plant.sizes
        ranges = {}
        for i, j in pairs(range(n), 2):
            size = sizes[i] * sizes[j]
            ranges[entry(name, i, j).name] = (size / 4, size) if i == j else (-size / (4 * n), size / (4 * n))
        self.given(name, ranges)
        return sp.Matrix(n, n, lambda i, j: entry(name, i, j))

    def factors(self, tail: str = "") -> tuple[sp.Matrix, list[sp.Symbol]]:
        """Unit upper triangular U and diagonal D as arguments."""
        n, sizes = self.plant.n, self.plant.sizes
        u, d = self.letter(f"U{tail}"), self.letter(f"D{tail}")
        places = list(combinations(range(n), 2))
        halves = {f"{u}{i}_{j}": sizes[i] / sizes[j] / 2 for i, j in places}
        above = dict(zip(places, self.given(u, {name: (-half, half) for name, half in halves.items()}), strict=True))
        diagonal = self.given(d, {f"{d}{j}": (size**2 / 4, size**2) for j, size in enumerate(sizes)})
        return sp.Matrix(n, n, lambda i, j: above.get((i, j), sp.S.One if i == j else sp.S.Zero)), diagonal

    def put(self, names: Sequence[str], formulas: Sequence[sp.Expr], theorem: Any = None) -> list[sp.Expr]:
        """The values as symbols, defined by a link; what is a number or a symbol already stays what it is."""
        formulas = [sp.sympify(e, strict=True) for e in formulas]
        new = [k for k, e in enumerate(formulas) if not (e.is_Atom and (e.is_Symbol or e.is_number))]
        made = {k: real(names[k]) for k in new}
        if new:
            self.links.append(define({made[k]: formulas[k] for k in new}, theorem))
        return [made.get(k, e) for k, e in enumerate(formulas)]

    def vector(self, letter: str, formulas: Iterable[sp.Expr], theorem: Any = None) -> list[sp.Expr]:
        """The values as symbols ``letter0``, ``letter1`` and so on."""
        formulas, name = list(formulas), self.letter(letter)
        return self.put([f"{name}{i}" for i in range(len(formulas))], formulas, theorem)

    def matrix(self, letter: str, formulas: sp.MatrixBase, theorem: Any = None) -> sp.Matrix:
        """The entries of a square matrix as symbols ``letter0_0``, ``letter0_1`` and so on."""
        name, n = self.letter(letter), formulas.rows
        names = [f"{name}{i}_{j}" for i in range(n) for j in range(n)]
        return sp.Matrix(n, n, self.put(names, list(formulas), theorem))

    def transition(self) -> sp.Matrix:
        """Phi with a name for each entry that is no number."""
        return self.matrix("Phi", self.plant.Phi, lambda: transition_law(self.plant))

    def measurement(self, k: int) -> tuple[sp.Symbol, list[sp.Expr], sp.Expr]:
        """The number that is measured, its row, and its variance, with a name for each entry that is no number."""
        z, reach = self.letter("z"), measured_range(self.plant, k)
        self.tests[z] = (-reach, reach)
        row = self.vector("h", self.plant.H.row(k))
        return real(z), row, self.vector("r", [self.plant.variances[k]])[0]

    def results(self, outputs: Mapping[str, Sequence[sp.Expr]]) -> dict[str, tuple[str, ...]]:
        """Outputs -> names of their entries; what has none, or has it twice, gets one."""
        found, used = {}, set()
        for output, flat in outputs.items():
            names = []
            for k, e in enumerate(flat):
                name = e.name if isinstance(e, sp.Symbol) else ""
                if not name or name in used or not any(name in link.results for link in self.links):
                    name = f"{self.letter(output)}{k}"
                    self.links.append(Link((name,), "", (e,)))
                used.add(name)
                names.append(name)
            found[output] = tuple(names)
        return found

    def chain(self, title: str, outputs: Mapping[str, Sequence[sp.Expr]]) -> Chain:
        """The chain, its arguments in the order of the arrays, then ``z`` and ``dt``, then parameters."""
        plant = self.plant
        order = (*self.arrays, self.letter("z"), STEP)
        layout = Layout(self.arrays, order, plant.steps | self.tests, self.units)
        named = self.results(outputs)
        return Chain(f"{title}; states {', '.join(plant.states)}", tuple(self.links), named, layout, plant.ranges)


def chains_of(plant: Plant, units: Mapping[str, str]) -> Iterator[tuple[str, Chain]]:
    """Name and chain of every step of the filter."""
    yield "predict", predict(Steps(plant, units))
    for k, name in enumerate(plant.measurements):
        yield f"update_{name}", update(Steps(plant, units), k)
    if plant.n <= MOST_UD:
        yield "predict_ud", predict_ud(Steps(plant, units))
    for k, name in enumerate(plant.measurements):
        yield f"update_{name}_ud", update_ud(Steps(plant, units), k)


def measured_range(plant: Plant, k: int) -> float:
    """Largest magnitude of a measurement: that of h x and three times its standard deviation."""

    def largest(e: sp.Expr) -> float:
        ends = {s: plant.ranges[s.name] for s in e.free_symbols}
        ball = {s: enclose(low, {}, 64).union(enclose(high, {}, 64)) for s, (low, high) in ends.items()}
        return float(abs(enclose(e, ball, 64)).upper())

    total = sum(largest(h) * size for h, size in zip(plant.H.row(k), plant.sizes, strict=True))
    return total + 3 * largest(sp.sqrt(plant.variances[k]))


def upper(matrix: sp.MatrixBase) -> list[sp.Expr]:
    """The upper triangle of a square matrix, row by row."""
    return [matrix[i, j] for i, j in pairs(range(matrix.rows), 2)]


def predict(steps: Steps) -> Chain:
    """``x <- Phi x``, ``P <- Phi P Phi' + Q``."""
    n = steps.plant.n
    x, P, Q = steps.state(), steps.covariance("P"), steps.covariance("Q")
    Phi = steps.transition()
    y = steps.vector("y", Phi * x)
    M = steps.matrix("m", Phi * P)
    moved = [(M.row(i) * Phi.row(j).T)[0] + Q[i, j] for i, j in pairs(range(n), 2)]
    N = steps.put(triangle(steps.letter("N"), n), moved, lambda: propagation(Phi, P, Q))
    return steps.chain("Prediction over dt: x <- Phi x, P <- Phi P Phi' + Q", {"next_x": y, "next_P": N})


def propagation(Phi: sp.Matrix, P: sp.Matrix, Q: sp.Matrix) -> Equation:
    """The covariance of Phi e + w, entry by entry from those of e and w, is what the step adds up."""
    n = Phi.rows
    places = [[k for k in range(n) if Phi[i, k] != 0] for i in range(n)]
    derived = [
        sum((Phi[i, a] * Phi[j, b] * P[a, b] for a in places[i] for b in places[j]), start=sp.S.Zero) + Q[i, j]
        for i, j in pairs(range(n), 2)
    ]
    return Equation(printed=upper((Phi * P) * Phi.T + Q), derived=derived)


def update(steps: Steps, k: int) -> Chain:
    """One measurement: ``P <- (1 - K h) P (1 - K h)' + K r K'`` for ``K = P h'/(h P h' + r)``, as two products."""
    n, letter = steps.plant.n, steps.letter
    x, P = steps.state(), steps.covariance("P")
    z, h, r = steps.measurement(k)
    g = steps.vector("g", P * sp.Matrix(h))
    s, v = steps.put([f"{letter('s')}0", f"{letter('v')}0"], [scalar_product(h, g) + r, z - scalar_product(h, x)])
    K = steps.vector("K", [e / s for e in g], information)
    y = steps.vector("y", [a + b * v for a, b in zip(x, K, strict=True)])
    M = steps.matrix("m", sp.Matrix(n, n, lambda i, j: P[i, j] - K[i] * g[j]))
    w = steps.vector("w", M * sp.Matrix(h))
    shrunk = [M[i, j] - w[i] * K[j] + K[i] * r * K[j] for i, j in pairs(range(n), 2)]
    N = steps.put(triangle(letter("N"), n), shrunk, lambda: joseph(P, h, r, K))
    name = steps.plant.measurements[k]
    title = f"Correction by {name}, Joseph's form: P <- (1 - K h) P (1 - K h)' + K r K'"
    return steps.chain(title, {"next_x": y, "next_P": N})


def joseph(P: sp.Matrix, h: Sequence[sp.Expr], r: sp.Expr, K: Sequence[sp.Expr]) -> Equation:
    """M - (M h') K' + K r K' for M = P - K (h P) is (1 - K h) P (1 - K h)' + K r K', for every K."""
    row, gain = sp.Matrix([h]), sp.Matrix(K)
    M = P - gain * (row * P)
    code = M - (M * row.T) * gain.T + gain * r * gain.T
    L = sp.eye(P.rows) - gain * row
    return Equation(printed=upper(code), derived=upper(L * P * L.T + gain * r * gain.T))


def factor_outputs(U: Mapping[tuple[int, int], sp.Expr], D: Sequence[sp.Expr], n: int) -> dict[str, list[sp.Expr]]:
    """next_U, where there is one, and next_D."""
    above = [U[i, j] for i, j in combinations(range(n), 2)]
    return ({"next_U": above} if above else {}) | {"next_D": list(D)}


def predict_ud(steps: Steps) -> Chain:
    """Thornton's weighted Gram-Schmidt: ``U D U' <- Phi U D U' Phi' + Uq Dq Uq'``."""
    n, x = steps.plant.n, steps.state()
    (U, D), (V, E) = steps.factors(), steps.factors("q")
    Phi = steps.transition()
    y = steps.vector("y", Phi * x)
    w, p, u, weights = steps.letter("w"), steps.letter("p"), steps.letter("u"), [*D, *E]
    moved = Phi * U
    W = [[*steps.put([f"{w}{n}_{i}_{k}" for k in range(n)], list(moved.row(i))), *V.row(i)] for i in range(n)]
    new: dict[tuple[int, int], sp.Expr] = {}
    diagonal: list[sp.Expr] = [sp.S.Zero] * n
    for j in reversed(range(n)):
        weighted = steps.put([f"{p}{j}_{k}" for k in range(2 * n)], [a * b for a, b in zip(W[j], weights, strict=True)])
        (diagonal[j],) = steps.put([f"{steps.letter('d')}{j}"], [scalar_product(W[j], weighted)])
        above = [scalar_product(W[i], weighted) / diagonal[j] for i in range(j)]
        made = steps.put([f"{u}{i}_{j}" for i in range(j)], above, orthogonal_rest)
        for i in range(j):
            new[i, j] = made[i]
            rest = [a - made[i] * b for a, b in zip(W[i], W[j], strict=True)]
            W[i] = steps.put([f"{w}{j}_{i}_{k}" for k in range(2 * n)], rest)
    title = "Prediction over dt in UD form (Thornton): U D U' <- Phi U D U' Phi' + Uq Dq Uq'"
    return steps.chain(title, {"next_x": y} | factor_outputs(new, diagonal, n))


def orthogonal_rest() -> Equation:
    """A step of Gram-Schmidt keeps all products of rows, and leaves rows orthogonal to the one taken out.

    With inner products b_il of the rows and u_i = b_ij/b_jj: b_il = (w_i - u_i w_j).(w_l - u_l w_j) + u_i u_l b_jj, and
    (w_i - u_i w_j).w_j = 0. By induction over the columns W D W' = U D U', for every number of states.
    """
    il, ij, lj = (real(name) for name in ("b_il", "b_ij", "b_lj"))
    jj = sp.Symbol("b_jj", positive=True)
    u, v = ij / jj, lj / jj
    return Equation(printed=[il - u * lj - v * ij + u * v * jj + u * v * jj, ij - u * jj], derived=[il, sp.S.Zero])


def update_ud(steps: Steps, k: int) -> Chain:
    """Bierman's update: the factors of P - P h' h P/(h P h' + r) from those of P."""
    n, letter, x = steps.plant.n, steps.letter, steps.state()
    U, D = steps.factors()
    z, h, r = steps.measurement(k)
    (v,) = steps.vector("v", [z - scalar_product(h, x)])
    f = steps.vector("f", U.T * sp.Matrix(h))
    g = steps.vector("g", [a * b for a, b in zip(D, f, strict=True)])
    before, gain = r, [sp.S.Zero] * n
    new: dict[tuple[int, int], sp.Expr] = {}
    diagonal: list[sp.Expr] = []
    for j in range(n):
        (after,) = steps.put([f"{letter('s')}{j}"], [before + f[j] * g[j]])
        (ratio,) = steps.put([f"{letter('c')}{j}"], [f[j] / before])
        column = [U[i, j] - gain[i] * ratio for i in range(j)]
        made = steps.put([f"{letter('u')}{i}_{j}" for i in range(j)], column, telescoped)
        diagonal += steps.put([f"{letter('d')}{j}"], [D[j] if f[j] == 0 else D[j] * before / after])
        gain = steps.put(
            [f"{letter('w')}{j}_{i}" for i in range(n)],
            [gain[i] + U[i, j] * g[j] if i < j else g[j] if i == j else sp.S.Zero for i in range(n)],
        )
        new |= {(i, j): made[i] for i in range(j)}
        before = after
    K = steps.vector("K", [e / before for e in gain])
    y = steps.vector("y", [a + b * v for a, b in zip(x, K, strict=True)])
    name = steps.plant.measurements[k]
    title = f"Correction by {name} in UD form (Bierman): U D U' <- P - P h' h P/(h P h' + r), P = U D U'"
    return steps.chain(title, {"next_x": y} | factor_outputs(new, diagonal, n))


def telescoped() -> Equation:
    """One column of Bierman's update, for every number of states.

    With s_j = s_(j-1) + f_j^2 D_j, w the sum of U_k g_k over the columns before and w+ = w + u g: the new column gives
    d (u_i - w_i f/s)(u_l - w_l f/s) with d = D s/(s + f^2 D). That is D u_i u_l + w_i w_l/s - w+_i w+_l/(s + f^2 D).
    The sum over all columns telescopes to U D U' - w w'/(h P h' + r) with w = P h'.
    """
    ui, ul, wi, wl, f = (real(name) for name in ("u_i", "u_l", "w_i", "w_l", "f"))
    D, s = (sp.Symbol(name, positive=True) for name in ("D", "s"))
    t, g = s + f**2 * D, D * f
    column = D * s / t * (ui - wi * f / s) * (ul - wl * f / s)
    change = D * ui * ul + wi * wl / s - (wi + ui * g) * (wl + ul * g) / t
    return Equation(printed=column, derived=change)
