"""Section 1, (1.7)-(1.13): the two-stage split, its estimator, and the general variant."""

import sympy as sp

from navsym.claims import PROVED, Equation, Finding, claim, fact, state
from navsym.models.linear import LinearModel
from navsym.observability.splits import companion, last_row
from navsym_papers.joint_correction import section1_systems
from navsym_papers.joint_correction.matrices import exact_inverse, unit_row, write_matrix
from navsym_papers.joint_correction.section1_chains import characteristic, coefficients, rank_of, say_affine
from navsym_papers.joint_correction.section1_systems import coordinates, direct_sum, free, k, polynomial_of, systems


def phi_of(s: section1_systems.System) -> list[sp.Expr]:
    """phi_1 ... phi_n: b_{n-m+1} in the basis a_1 ... a_m, b_1 ... b_{n-m}."""
    following = s.chain(2, s.rest + 1)[s.rest, :]
    return coefficients(sp.Matrix.vstack(s.chain(1, s.m), s.chain(2, s.rest)), following)


@claim("1.7.count | n - m <= l: the second chain is long enough to complete the basis.")
def enough_vectors():
    found = tuple(s.found.measurements[1].dimension >= s.rest for s in (*systems(), direct_sum()))
    ranks, relations = [], []
    for s in (*systems(), direct_sum()):
        sizes = [part.dimension for part in s.found.measurements]
        ranks += [(LinearModel(s.G, None, s.model.H[i, :]), sizes[i]) for i in (0, 1)]
        relations.append((f"{s.n} - {sizes[0]}", "<=", str(sizes[1])))
    finding = Finding(found, "exact dimensions of the chains", PROVED)
    return section1_systems.say_ranks((True,) * 5, finding, ranks, *relations)


@claim("1.8.basis | a_1 ... a_m, b_1 ... b_{n-m} is a basis whenever the pair is observable.")
def chains_complete_each_other():
    # Modulo the invariant span of the a's the b's are a chain b, M b, ... of some (k, k) matrix M, k = n - m. By
    # Cayley and Hamilton M^k b is a combination of the first k vectors, whatever M and b are, so that a dependence
    # among them would keep every later vector in the same span.
    identities, relations = [], []
    for size in (1, 2, 3):
        M = sp.Matrix(size, size, lambda r, s, size=size: section1_systems.g[r * size + s])
        theta = characteristic(M)
        power = [M**j for j in range(size + 1)]
        total = sum((t * power[j] for j, t in enumerate(theta)), sp.zeros(size, size))
        identities += [sp.expand(x) == 0 for x in power[size] - total]
        written = " @ ".join([write_matrix(M)] * size)
        relations.append(
            (written, "=", write_matrix(total), {x.name: [None, None, []] for x in section1_systems.g[: size**2]})
        )
    chains = [sp.Matrix.vstack(s.chain(1, s.m), s.chain(2, s.rest)) for s in systems()]
    full = tuple(rank_of(rows) == rows.cols for rows in chains)
    method = "Cayley-Hamilton in the quotient by the first chain"
    finding = Finding(
        all(identities) and all(full), method, PROVED, scope="n - m = 1, 2, 3 with all entries symbolic, every m"
    )
    return section1_systems.say_ranks(
        True, finding, [(section1_systems.seen_at_once(rows), rows.cols) for rows in chains], *relations
    )


@claim("1.8.one_to_one")
def transformation_is_invertible():
    """(x, z) and xi determine each other: the transformation composed with its inverse is the identity."""
    for s in systems():
        L, back = coordinates(s, free("x", s.m), free("z", s.rest))
        yield sp.eye(s.n), L * back


@claim(
    "1.10.gz | g_z^T = (1 0 ... 0)^T C_2^-1, as printed: a column times a matrix. | undecidable: a transposed row (1 "
    "0 ... 0)^T cannot be multiplied by C_2^-1 unless n - m = 1; in (1.5) and after (1.14) the same row stands "
    "without the transposition; by hand: for n - m = 2 a (2, 1) column stands before a (2, 2) matrix"
)
def output_row_of_z_printed():
    size = 2
    columns, rows = unit_row(size).T.cols, free("z", size).rows
    meaning = [state(str(columns), "=", str(rows))]  # a product has a value only where these two counts agree
    return fact(True, columns == rows, "shapes of the factors", PROVED, scope="n - m = 2", meaning=meaning)


@claim("1.10.gz* | g_z^T = (1 0 ... 0) C_2^-1.")
def output_row_of_z():
    for s in systems():
        C2 = free("z", s.rest)
        _, back = coordinates(s, free("x", s.m), C2)
        yield unit_row(s.rest) * exact_inverse("C2", C2), (s.h(2).T * back)[:, s.m :]


@claim("1.10.Phi | Phi_x has phi_1 ... phi_m in its last row and zeros above; Phi_z is the companion of the rest.")
def rows_of_phi():
    s = systems()[2]
    phi = phi_of(s)
    basis = sp.Matrix.vstack(s.chain(1, 2), s.chain(2, 2))
    return Equation(
        sp.Matrix([[0, 0, 0, 1], [phi[0], phi[1], phi[2], phi[3]]]),
        sp.Matrix([coefficients(basis, s.chain(2, 3)[row, :]) for row in (1, 2)]),
    )


@claim("1.10.phi")
def next_vector_of_the_second_chain():
    """b_{n-m+1} in the basis a_1 ... a_m, b_1 ... b_{n-m} has the coefficients phi, the last row of L G L^-1."""
    for s in systems():
        L, back = coordinates(s, sp.eye(s.m), sp.eye(s.rest))
        phi = (L * s.G * back)[s.n - 1, :]
        yield phi * L, s.chain(2, s.rest + 1)[s.rest, :]


# The estimator


def blocks(m: int, rest: int) -> dict[str, sp.Matrix]:
    """General blocks of the split system and general gains, in coordinates with C_1 = C_2 = 1."""
    theta = sp.symbols(f"theta1:{m + 1}", real=True)
    phi = sp.symbols(f"phi1:{m + rest + 1}", real=True)
    return {
        "Gx": sp.Matrix(companion(theta)),
        "Gz1": sp.Matrix(last_row(rest, phi[:m])),
        "Gz2": sp.Matrix(companion(phi[m:])),
        "gx": sp.Matrix(unit_row(m)),
        "gz": sp.Matrix(unit_row(rest)),
        "Kx": sp.Matrix(k[:m]),
        "Kz": sp.Matrix(k[m : m + rest]),
    }


def closed_loop(b: dict[str, sp.Matrix]) -> sp.Matrix:
    """Matrix of the errors (x - x°, z - z°), from the truth and the estimator run side by side."""
    m, rest = b["Gx"].rows, b["Gz2"].rows
    names = [
        sp.symbols(f"{name}1:{size + 1}", real=True) for name, size in (("x", m), ("z", rest), ("e", m), ("f", rest))
    ]
    x, z, e, f = map(sp.Matrix, names)
    dx = b["Gx"] * x - (b["Gx"] * e + b["Kx"] * (b["gx"] * x - b["gx"] * e))
    dz = b["Gz1"] * x + b["Gz2"] * z - (b["Gz1"] * e + b["Gz2"] * f + b["Kz"] * (b["gz"] * z - b["gz"] * f))
    rates = sp.Matrix.vstack(dx, dz)
    by_truth = rates.jacobian([*x, *z])
    by_estimate = rates.jacobian([*e, *f])
    if any(sp.expand(value) != 0 for value in by_truth + by_estimate):
        raise ArithmeticError("the errors do not satisfy equations of their own")
    return by_truth


PAIRS = ((1, 1), (2, 1), (1, 2), (2, 2), (3, 2))


@claim("1.11.gain_unique | Prescribed roots of |pE - G_z2 + K_z g_z^T| determine K_z uniquely.")
def second_gain_is_unique():
    found, meaning = True, list[dict]()
    for size in (1, 2, 3):
        phi = sp.symbols(f"phi1:{size + 1}", real=True)
        C2 = free("z", size)
        G = C2 * companion(phi) * exact_inverse("C2", C2)
        K = sp.Matrix(k[:size])
        values = section1_systems.coefficients_of_polynomial(G - K * unit_row(size) * exact_inverse("C2", C2))[1:]
        jacobian = sp.Matrix(values).jacobian(K)
        meaning += say_affine(values, K, C2.det())
        found = found and rank_of(jacobian) == size and not any(jacobian.has(symbol) for symbol in K)
    method, scope = "the coefficients are affine in K_z with an invertible matrix", "n - m = 1, 2, 3, all phi"
    return fact(True, found, method, PROVED, scope=scope, assumptions=("det C_2 != 0",), meaning=meaning)


@claim("1.11.characteristic")
def characteristic_polynomial_factors():
    """The characteristic polynomial of the whole estimator is the product of those of its stages."""
    for m, rest in PAIRS:
        b = blocks(m, rest)
        first = polynomial_of(b["Gx"] - b["Kx"] * b["gx"])
        second = polynomial_of(b["Gz2"] - b["Kz"] * b["gz"])
        yield first * second, polynomial_of(closed_loop(b))


@claim("1.two_stage.separate")
def first_stage_ignores_the_second():
    """x° does not depend on sigma_2, z° nor K_z: the first rows of the closed loop contain none of them."""
    found, meaning = True, list[dict]()
    for m, rest in PAIRS:
        b = blocks(m, rest)
        rows = closed_loop(b)[:m, :]
        meaning += say_free(rows[:, :m], rows[:, m:], b["Kz"])
        found = found and not rows[:, m:].free_symbols and not any(rows.has(s) for s in b["Kz"])
        found = found and all(value == 0 for value in rows[:, m:])
    scope = f"(m, n - m) in {PAIRS}, all coefficients"
    return fact(True, found, "entries of the closed loop", PROVED, scope=scope, meaning=meaning)


def say_free(rows: sp.Matrix, beyond: sp.Matrix, gains: sp.Matrix) -> list[dict]:
    """That the derivatives of rows by all gains are zero, and so is what stands beyond them."""
    names = sorted({s.name for s in (*rows.free_symbols, *beyond.free_symbols, *gains.free_symbols)})
    symbols = {name: [None, None, []] for name in names}

    (m, n), width = rows.shape, beyond.cols
    slopes = [state(f"diff({write_matrix(rows)}, {gain})", "=", f"zeros({m}, {n})", symbols) for gain in gains]
    used = {s: symbols[s] for s in symbols if s in {x.name for x in beyond.free_symbols}}
    return [*slopes, state(write_matrix(beyond), "=", f"zeros({m}, {width})", used)]


@claim("1.two_stage.influence")
def exact_first_stage_leaves_a_free_second():
    """With x° = x the error of z° obeys the second stage alone: its rate is (G_z2 - K_z g_z^T)(z - z°)."""
    for m, rest in PAIRS[:3]:
        b = blocks(m, rest)
        f = sp.Matrix(sp.symbols(f"f1:{rest + 1}", real=True))
        yield (b["Gz2"] - b["Kz"] * b["gz"]) * f, closed_loop(b)[m:, :] * sp.Matrix.vstack(sp.zeros(m, 1), f)


@claim("1.two_stage.linear")
def influence_is_proportional():
    """m = n - m = 1: what an error of x at t_1 leaves in z at t is proportional to it, small when it is small.

    Error of z after time t for the error e of x at t_1, poles a and b different.
    """
    a, b, t = sp.symbols("a b t", positive=True)
    drive, e, factor = sp.symbols("phi e c", real=True)

    def left(error: sp.Expr) -> sp.Expr:
        return drive * error * (sp.exp(-a * t) - sp.exp(-b * t)) / (b - a)

    moved = left(e).diff(t) + b * left(e) - drive * e * sp.exp(-a * t)
    return Equation([factor * left(e), sp.Integer(0), sp.Integer(0)], [left(factor * e), moved, left(e).subs(t, 0)])


@claim("1.two_stage.dimension")
def fewer_variables_settle_sooner():
    """f_k = exp(-s) sum s^i/i!, i < k, is a transient of k equal poles; one pole more adds exp(-s) s^k/k! (k to 7).

    s = lam t. The difference of k + 1 and k variables is exp(-s) s^k/k! > 0; the sum solves
    (d/ds + 1) f_k = f_{k-1}, f_0 = 0, as a chain of k equal poles does.
    """
    s = sp.Symbol("s", positive=True)

    def transient(k: int) -> sp.Expr:
        return sp.exp(-s) * sum((s**i / sp.factorial(i) for i in range(k)), sp.Integer(0))

    sizes = range(1, 8)
    printed = [sp.exp(-s) * s**k / sp.factorial(k) for k in sizes] + [transient(k - 1) for k in sizes]
    derived = [transient(k + 1) - transient(k) for k in sizes]
    return Equation(printed, derived + [transient(k).diff(s) + transient(k) for k in sizes])
