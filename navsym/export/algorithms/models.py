"""A model as flight code: F, Phi(dt), H, Qd(dt), and the steps of a Kalman filter in Joseph's form and in UD form.

Symmetric matrices are upper triangles, row by row; ``U`` is the strict upper triangle of the unit factor in
``P = U D U'``. Measurements are scalar and come one at a time. Ranges of states, of parameters and of the step ``dt``
are those that the model declares: the rounding bounds hold in them, and the test vectors are drawn from them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from itertools import combinations_with_replacement as pairs
from typing import Any

import sympy as sp

from navsym.claims import Equation, Statement
from navsym.core.balls import enclose
from navsym.core.errors import DomainError, DuplicateError
from navsym.export.algorithms.kalman import entry, information, triangle
from navsym.export.chain import SECONDS, Chain, Link, real
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
            where="export: ranges",
        )


def undecided(claim: str) -> Material:
    """The chains of a model cite no claims of papers."""
    raise DomainError(f"expected formulas of the model; got the claim {claim}; report this")


# -- F, Phi, H, Qd ---------------------------------------


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
    upper = list(pairs(range(n), 2))
    law = Equation(
        printed=[Qd[i, j].diff(dt) for i, j in upper] + [Qd[i, j].subs(dt, 0) for i, j in upper],
        derived=[rate[i, j] for i, j in upper] + [sp.S.Zero] * len(upper),
    )
    title = (
        "Covariance of white noise of intensities q over dt, upper triangle: Qd' = F Qd + Qd F' + diag(q), Qd(0) = 0"
    )
    yield "Qd", [Qd[i, j] for i, j in upper], law, title


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


# -- chains ---------------------------------------


class Steps:
    """Links of a chain under construction; numbers and symbols get no name of their own."""

    def __init__(self, plant: Plant):
        self.plant = plant
        self.links: list[Link] = []

    def letter(self, letter: str) -> str:
        """The letter, or one that no parameter of the model has."""
        return free_letter(self.plant, letter)

    def put(self, names: Sequence[str], formulas: Sequence[sp.Expr], theorem: Any = None) -> list[sp.Expr]:
        """The values as symbols, defined by a link; what is a number or a symbol already stays what it is."""
        formulas = [sp.sympify(e, strict=True) for e in formulas]
        new = [k for k, e in enumerate(formulas) if not (e.is_Atom and (e.is_Symbol or e.is_number))]
        made = {k: real(names[k]) for k in new}
        if new:
            link = Link(tuple(names[k] for k in new), "", tuple(formulas[k] for k in new), theorem)
            self.links.append(link)
        return [made.get(k, e) for k, e in enumerate(formulas)]

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


def chains_of(plant: Plant, units: Mapping[str, str]) -> Iterator[tuple[str, Chain]]:
    """Name and chain of every step of the filter."""
    yield "predict", predict(plant, units)
    for k, name in enumerate(plant.measurements):
        yield f"update_{name}", update(plant, k, units)
    if plant.n <= MOST_UD:
        yield "predict_ud", predict_ud(plant, units)
    for k, name in enumerate(plant.measurements):
        yield f"update_{name}_ud", update_ud(plant, k, units)


def chain_of(
    steps: Steps,
    title: str,
    arrays: Mapping[str, tuple[str, ...]],
    outputs: Mapping[str, Sequence[sp.Expr]],
    tests: Mapping[str, Range],
    units: Mapping[str, str],
) -> Chain:
    """The chain of the steps with the arguments in the order of the arrays, then ``z`` and ``dt``, then parameters."""
    plant = steps.plant
    order = (*arrays, steps.letter("z"), STEP)
    title = f"{title}; states {', '.join(plant.states)}"
    named = steps.results(outputs)
    return Chain(
        title, tuple(steps.links), named, Layout(arrays, order, plant.steps | dict(tests), units), plant.ranges
    )


def state_of(plant: Plant, steps: Steps) -> tuple[list[sp.Symbol], dict[str, tuple[str, ...]], dict[str, Range]]:
    """Symbols of the state, its argument and its range."""
    x = steps.letter("x")
    names = tuple(f"{x}{i}" for i in range(plant.n))
    tests = {name: (-size, size) for name, size in zip(names, plant.sizes, strict=True)}
    return [real(name) for name in names], {x: names}, tests


def covariance_of(
    plant: Plant, steps: Steps, letter: str
) -> tuple[sp.Matrix, dict[str, tuple[str, ...]], dict[str, Range]]:
    """A covariance, its argument, and ranges in which it is positive definite: its scaled diagonal dominates."""
    name, n, sizes = steps.letter(letter), plant.n, plant.sizes
    names = triangle(name, n)
    tests = {
        entry(name, i, j).name: (sizes[i] ** 2 / 4, sizes[i] ** 2)
        if i == j
        else (-sizes[i] * sizes[j] / (4 * n), sizes[i] * sizes[j] / (4 * n))
        for i, j in pairs(range(n), 2)
    }
    return sp.Matrix(n, n, lambda i, j: entry(name, i, j)), {name: names}, tests


def transition_of(plant: Plant, steps: Steps) -> sp.Matrix:
    """Phi with a name for each entry that is no number."""
    letter, n = steps.letter("Phi"), plant.n
    names = [f"{letter}{i}_{j}" for i in range(n) for j in range(n)]
    return sp.Matrix(n, n, steps.put(names, list(plant.Phi), lambda: transition_law(plant)))


def row_of(plant: Plant, k: int, steps: Steps) -> tuple[list[sp.Expr], sp.Expr]:
    """The row and the variance of a measurement, with a name for each entry that is no number."""
    h, r = steps.letter("h"), steps.letter("r")
    row = steps.put([f"{h}{i}" for i in range(plant.n)], list(plant.H.row(k)))
    return row, steps.put([f"{r}0"], [plant.variances[k]])[0]


def measured_range(plant: Plant, k: int) -> float:
    """Largest magnitude of a measurement: that of h x and three times its standard deviation."""

    def largest(e: sp.Expr) -> float:
        ends = {s: plant.ranges[s.name] for s in e.free_symbols}
        ball = {s: enclose(low, {}, 64).union(enclose(high, {}, 64)) for s, (low, high) in ends.items()}
        return float(abs(enclose(e, ball, 64)).upper())

    total = sum(largest(h) * size for h, size in zip(plant.H.row(k), plant.sizes, strict=True))
    return total + 3 * largest(sp.sqrt(plant.variances[k]))


# -- Joseph's form ---------------------------------------


def predict(plant: Plant, units: Mapping[str, str]) -> Chain:
    """``x <- Phi x``, ``P <- Phi P Phi' + Q``."""
    steps, n = Steps(plant), plant.n
    x, state, tests = state_of(plant, steps)
    P, covariance, more = covariance_of(plant, steps, "P")
    Q, noise, most = covariance_of(plant, steps, "Q")
    Phi = transition_of(plant, steps)
    y = steps.put([f"{steps.letter('y')}{i}" for i in range(n)], list(Phi * sp.Matrix(x)))
    m = steps.letter("m")
    M = sp.Matrix(n, n, steps.put([f"{m}{i}_{j}" for i in range(n) for j in range(n)], list(Phi * P)))
    upper = list(pairs(range(n), 2))
    N = steps.put(
        triangle(steps.letter("N"), n),
        [(M.row(i) * Phi.row(j).T)[0] + Q[i, j] for i, j in upper],
        lambda: propagation(Phi, P, Q),
    )
    title = "Prediction over dt: x <- Phi x, P <- Phi P Phi' + Q"
    outputs = {"next_x": y, "next_P": N}
    return chain_of(steps, title, state | covariance | noise, outputs, tests | more | most, units)


def propagation(Phi: sp.Matrix, P: sp.Matrix, Q: sp.Matrix) -> Equation:
    """The covariance of Phi e + w, entry by entry from those of e and w, is what the step adds up."""
    n = Phi.rows
    product = (Phi * P) * Phi.T + Q
    upper = list(pairs(range(n), 2))
    places = [[k for k in range(n) if Phi[i, k] != 0] for i in range(n)]
    derived = [
        sum((Phi[i, a] * Phi[j, b] * P[a, b] for a in places[i] for b in places[j]), start=sp.S.Zero) + Q[i, j]
        for i, j in upper
    ]
    return Equation(printed=[product[i, j] for i, j in upper], derived=derived)


def update(plant: Plant, k: int, units: Mapping[str, str]) -> Chain:
    """One measurement: ``P <- (1 - K h) P (1 - K h)' + K r K'`` for ``K = P h'/(h P h' + r)``, as two products."""
    steps, n = Steps(plant), plant.n
    x, state, tests = state_of(plant, steps)
    P, covariance, more = covariance_of(plant, steps, "P")
    z, letter = real(steps.letter("z")), steps.letter
    h, r = row_of(plant, k, steps)
    g = steps.put([f"{letter('g')}{i}" for i in range(n)], list(P * sp.Matrix(h)))
    s, v = steps.put(
        [f"{letter('s')}0", f"{letter('v')}0"],
        [sum(a * b for a, b in zip(h, g, strict=True)) + r, z - sum(a * b for a, b in zip(h, x, strict=True))],
    )
    K = steps.put([f"{letter('K')}{i}" for i in range(n)], [e / s for e in g], information)
    y = steps.put([f"{letter('y')}{i}" for i in range(n)], [a + b * v for a, b in zip(x, K, strict=True)])
    m = letter("m")
    M = sp.Matrix(
        n,
        n,
        steps.put(
            [f"{m}{i}_{j}" for i in range(n) for j in range(n)],
            [P[i, j] - K[i] * g[j] for i in range(n) for j in range(n)],
        ),
    )
    w = steps.put([f"{letter('w')}{i}" for i in range(n)], list(M * sp.Matrix(h)))
    upper = list(pairs(range(n), 2))
    N = steps.put(
        triangle(letter("N"), n),
        [M[i, j] - w[i] * K[j] + K[i] * r * K[j] for i, j in upper],
        lambda: joseph(P, h, r, K),
    )
    name = plant.measurements[k]
    title = f"Correction by {name}, Joseph's form: P <- (1 - K h) P (1 - K h)' + K r K'"
    reach = measured_range(plant, k)
    outputs = {"next_x": y, "next_P": N}
    return chain_of(steps, title, state | covariance, outputs, tests | more | {z.name: (-reach, reach)}, units)


def joseph(P: sp.Matrix, h: Sequence[sp.Expr], r: sp.Expr, K: Sequence[sp.Expr]) -> Equation:
    """M - (M h') K' + K r K' for M = P - K (h P) is (1 - K h) P (1 - K h)' + K r K', for every K."""
    n = P.rows
    row, gain = sp.Matrix([h]), sp.Matrix(K)
    M = P - gain * (row * P)
    code = M - (M * row.T) * gain.T + gain * r * gain.T
    L = sp.eye(n) - gain * row
    form = L * P * L.T + gain * r * gain.T
    upper = list(pairs(range(n), 2))
    return Equation(printed=[code[i, j] for i, j in upper], derived=[form[i, j] for i, j in upper])


# -- UD form ---------------------------------------


def factors_of(
    plant: Plant, steps: Steps, tail: str = ""
) -> tuple[sp.Matrix, list[sp.Symbol], dict[str, tuple[str, ...]], dict[str, Range]]:
    """Unit upper triangular U and diagonal D, their arguments and ranges."""
    n, sizes = plant.n, plant.sizes
    u, d = steps.letter(f"U{tail}"), steps.letter(f"D{tail}")
    above = {(i, j): real(f"{u}{i}_{j}") for i, j in combinations(range(n), 2)}
    diagonal = [real(f"{d}{j}") for j in range(n)]
    tests = {s.name: (-sizes[i] / sizes[j] / 2, sizes[i] / sizes[j] / 2) for (i, j), s in above.items()}
    tests |= {s.name: (size**2 / 4, size**2) for s, size in zip(diagonal, sizes, strict=True)}
    arrays = {u: tuple(s.name for s in above.values()), d: tuple(s.name for s in diagonal)}
    U = sp.Matrix(n, n, lambda i, j: above.get((i, j), sp.S.One if i == j else sp.S.Zero))
    return U, diagonal, {name: entries for name, entries in arrays.items() if entries}, tests


def factor_outputs(U: Mapping[tuple[int, int], sp.Expr], D: Sequence[sp.Expr], n: int) -> dict[str, list[sp.Expr]]:
    """next_U, where there is one, and next_D."""
    above = [U[i, j] for i, j in combinations(range(n), 2)]
    return ({"next_U": above} if above else {}) | {"next_D": list(D)}


def predict_ud(plant: Plant, units: Mapping[str, str]) -> Chain:
    """Thornton's weighted Gram-Schmidt: ``U D U' <- Phi U D U' Phi' + Uq Dq Uq'``."""
    steps, n = Steps(plant), plant.n
    x, state, tests = state_of(plant, steps)
    U, D, arrays, more = factors_of(plant, steps)
    V, E, noise, most = factors_of(plant, steps, "q")
    Phi = transition_of(plant, steps)
    y = steps.put([f"{steps.letter('y')}{i}" for i in range(n)], list(Phi * sp.Matrix(x)))
    w, p, weights = steps.letter("w"), steps.letter("p"), [*D, *E]
    moved = Phi * U
    W = [[*steps.put([f"{w}{n}_{i}_{k}" for k in range(n)], list(moved.row(i))), *V.row(i)] for i in range(n)]
    new: dict[tuple[int, int], sp.Expr] = {}
    diagonal: list[sp.Expr] = [sp.S.Zero] * n
    for j in reversed(range(n)):
        weighted = steps.put([f"{p}{j}_{k}" for k in range(2 * n)], [a * b for a, b in zip(W[j], weights, strict=True)])
        (diagonal[j],) = steps.put(
            [f"{steps.letter('d')}{j}"], [sum(a * b for a, b in zip(W[j], weighted, strict=True))]
        )
        above = [sum(a * b for a, b in zip(W[i], weighted, strict=True)) / diagonal[j] for i in range(j)]
        made = steps.put([f"{steps.letter('u')}{i}_{j}" for i in range(j)], above, orthogonal_rest)
        for i in range(j):
            new[i, j] = made[i]
            rest = [a - made[i] * b for a, b in zip(W[i], W[j], strict=True)]
            W[i] = steps.put([f"{w}{j}_{i}_{k}" for k in range(2 * n)], rest)
    title = "Prediction over dt in UD form (Thornton): U D U' <- Phi U D U' Phi' + Uq Dq Uq'"
    outputs = {"next_x": y} | factor_outputs(new, diagonal, n)
    return chain_of(steps, title, state | arrays | noise, outputs, tests | more | most, units)


def orthogonal_rest() -> Equation:
    """A step of Gram-Schmidt keeps all products of rows, and leaves rows orthogonal to the one taken out.

    With inner products b_il of the rows and u_i = b_ij/b_jj: b_il = (w_i - u_i w_j).(w_l - u_l w_j) + u_i u_l b_jj, and
    (w_i - u_i w_j).w_j = 0. By induction over the columns W D W' = U D U', for every number of states.
    """
    il, ij, lj = (real(name) for name in ("b_il", "b_ij", "b_lj"))
    jj = sp.Symbol("b_jj", positive=True)
    u, v = ij / jj, lj / jj
    return Equation(printed=[il - u * lj - v * ij + u * v * jj + u * v * jj, ij - u * jj], derived=[il, sp.S.Zero])


def update_ud(plant: Plant, k: int, units: Mapping[str, str]) -> Chain:
    """Bierman's update: the factors of P - P h' h P/(h P h' + r) from those of P."""
    steps, n = Steps(plant), plant.n
    x, state, tests = state_of(plant, steps)
    U, D, arrays, more = factors_of(plant, steps)
    z, letter = real(steps.letter("z")), steps.letter
    h, r = row_of(plant, k, steps)
    (v,) = steps.put([f"{letter('v')}0"], [z - sum(a * b for a, b in zip(h, x, strict=True))])
    f = steps.put([f"{letter('f')}{j}" for j in range(n)], list(U.T * sp.Matrix(h)))
    g = steps.put([f"{letter('g')}{j}" for j in range(n)], [a * b for a, b in zip(D, f, strict=True)])
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
    K = steps.put([f"{letter('K')}{i}" for i in range(n)], [e / before for e in gain])
    y = steps.put([f"{letter('y')}{i}" for i in range(n)], [a + b * v for a, b in zip(x, K, strict=True)])
    name = plant.measurements[k]
    title = f"Correction by {name} in UD form (Bierman): U D U' <- P - P h' h P/(h P h' + r), P = U D U'"
    reach = measured_range(plant, k)
    outputs = {"next_x": y} | factor_outputs(new, diagonal, n)
    return chain_of(steps, title, state | arrays, outputs, tests | more | {z.name: (-reach, reach)}, units)


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
