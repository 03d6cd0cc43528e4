"""Section 1, (1.2)-(1.6): what one measurement observes, and the observer for it."""

import sympy as sp

from navsym.claims import PROVED, Bound, Equation, Finding, claim, claims, fact, state
from navsym.language.expression import to_text
from navsym.models.linear import LinearModel
from navsym.observability.chains import numerators
from navsym.observability.linear import linear_relation, triangular_form
from navsym.observability.ring import Ring
from navsym.observability.splits import companion
from navsym_papers.joint_correction import section1_systems
from navsym_papers.joint_correction.matrices import exact_inverse, unit_row, write_matrix

s = sp.Symbol("s", positive=True)


@claim("1.dimensions | m <= n, l <= n and m + l >= n for an observable pair.")
def dimensions():
    found = all(
        first.dimension <= s.n and second.dimension <= s.n and first.dimension + second.dimension >= s.n
        for s in (*section1_systems.systems(), section1_systems.direct_sum())
        for first, second in [s.found.measurements]
    )
    ranks, relations = [], []
    for s in (*section1_systems.systems(), section1_systems.direct_sum()):
        sizes = [part.dimension for part in s.found.measurements]
        alone = [LinearModel(s.G, None, s.model.H[number, :]) for number in (0, 1)]
        ranks += [*zip(alone, sizes, strict=True), (s.model, s.n)]
        relations += [*((str(size), "<=", str(s.n)) for size in sizes), (f"{sizes[0]} + {sizes[1]}", ">=", str(s.n))]
    return section1_systems.say_ranks(True, Finding(found, "exact dimensions of the chains", PROVED), ranks, *relations)


@claim("1.3.basis | The first m vectors a_1 ... a_m are a basis of what sigma_1 observes.")
def chain_is_a_basis():
    counts = tuple(rank_of(s.chain(1, s.m)) for s in section1_systems.systems())
    longer = tuple(rank_of(s.chain(1, 2 * s.n)) for s in section1_systems.systems())
    value = counts if counts == longer else None
    finding = Finding(value, "exact ranks of m and of 2 n vectors", PROVED)
    ranks = [(section1_systems.seen_at_once(s.chain(1, s.m)), s.m) for s in section1_systems.systems()]
    ranks += [(LinearModel(s.G, None, s.model.H[0, :]), s.m) for s in section1_systems.systems()]
    return section1_systems.say_ranks(tuple(s.m for s in section1_systems.systems()), finding, ranks)


def rank_of(rows: sp.MatrixBase) -> int:
    """Exact generic rank: pivots of a fraction-free elimination."""
    ring = Ring.of(rows)
    entries, _ = numerators([rows[r, :] for r in range(rows.rows)], ring)
    return len(triangular_form(entries, ring).rows)


def characteristic(matrix: sp.MatrixBase) -> list[sp.Expr]:
    """theta_1 ... theta_m of a matrix: its characteristic polynomial is p^m - theta_m p^(m-1) - ... - theta_1."""
    values = [-value for value in section1_systems.coefficients_of_polynomial(matrix)[1:]]
    return values[::-1]


def theta_of(s: section1_systems.System) -> tuple[sp.Expr, ...]:
    return s.found.measurements[0].companion


CLAIMS_1_4 = claims(
    "1.4.theta | a_{m+1} is the combination of a_1 ... a_m with the coefficients theta of Cayley and Hamilton.",
    lambda: (
        (sp.Matrix([characteristic(s.block)]) * s.chain(1, s.m), s.chain(1, s.m + 1)[s.m, :])
        for s in section1_systems.systems()
    ),
)


@claim("1.5.Theta | Theta has ones above the diagonal and theta_1 ... theta_m in its last row.")
def companion_matrix():
    s = section1_systems.systems()[3]
    t1, t2, t3 = theta_of(s)
    A = s.chain(1, 4)
    solved = sp.Matrix([[*coefficients(A[:3, :], A[row, :])] for row in (1, 2, 3)])
    return Equation(sp.Matrix([[0, 1, 0], [0, 0, 1], [t1, t2, t3]]), solved)


def coefficients(basis: sp.MatrixBase, row: sp.MatrixBase) -> list[sp.Expr]:
    """Coefficients of a row in a basis of rows, by the exact elimination of the house."""
    ring = Ring.of(sp.Matrix.vstack(sp.Matrix(basis), sp.Matrix(row)))
    entries, _ = numerators([*(basis[r, :] for r in range(basis.rows)), row], ring)
    values = linear_relation(entries[:-1], entries[-1], ring)
    if values is None:
        raise ArithmeticError("the row lies outside of the span")
    return [ring.expression(value) for value in values]


def observer(size: int) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """(G_x, K, g_x) of a general scalar observer of the given order in coordinates with C_1 = free."""
    theta = sp.symbols(f"theta1:{size + 1}", real=True)
    C1 = section1_systems.free("x", size)
    back = exact_inverse("C1", C1)
    return C1 * companion(theta) * back, sp.Matrix(section1_systems.k[:size]), unit_row(size) * back


@claim("1.6.gain_unique")
def gain_is_unique():
    """Prescribed roots of |pE - G_x + K_x g_x^T| determine K_x uniquely, for every choice of them."""
    found, meaning = True, list[dict]()
    for size in (1, 2, 3):
        G, K, row = observer(size)
        values = section1_systems.coefficients_of_polynomial(G - K * row)[1:]
        jacobian = sp.Matrix(values).jacobian(K)
        meaning += say_affine(values, K, section1_systems.free("x", size).det())
        linear = not any(jacobian.has(symbol) for symbol in K)
        found = found and linear and rank_of(jacobian) == size
    method = "the coefficients are affine in K_x with an invertible matrix"
    return fact(True, found, method, PROVED, scope="all theta", assumptions=("det C_1 != 0",), meaning=meaning)


def say_affine(values: list[sp.Expr], K: sp.Matrix, determinant: sp.Expr) -> list[dict]:
    """That values are affine in K, and that the determinant of their slopes times another number is 1."""
    slopes = sp.Matrix(values).jacobian(K)
    constants = [value.subs(dict.fromkeys(K, 0)) for value in values]
    names = {s.name for value in (*values, determinant) for s in value.free_symbols}
    symbols = {name: [None, None, []] for name in sorted(names)}
    values_text, start = write_matrix(sp.Matrix(values)), write_matrix(sp.Matrix(constants))
    matrix, used = write_matrix(slopes), {s.name for s in slopes.free_symbols | determinant.free_symbols}
    moved = (
        f"{matrix} @ {write_matrix(sp.Matrix(K))}" if len(K) > 1 else write_matrix(slopes * K[0])
    )  # 1 by 1: a number
    product = f"det({matrix})*({to_text(determinant)})"
    return [
        state(values_text, "=", f"{start} + {moved}", symbols),
        state(product, "=", "1", {s: symbols[s] for s in sorted(used)}),
    ]


@claim("1.6.gain_unique.determinant")
def gain_determinant():
    """The matrix of that affine map has determinant 1/det C_1 up to sign, so no theta makes it singular."""
    values = []
    for size in (1, 2, 3):
        G, K, row = observer(size)
        values_of = section1_systems.coefficients_of_polynomial(G - K * row)[1:]
        jacobian = sp.Matrix(values_of).jacobian(K)
        values.append(sp.expand(jacobian.det(method="berkowitz")) ** 2)
    return Equation([section1_systems.free("x", size).det() ** -2 for size in (1, 2, 3)], values)


@claim("1.6.initial | With x°(t_0) = C_1 (sigma_10 0 ... 0)^T the first innovation is zero.")
def initial_estimate():
    first = sp.Symbol("sigma_10", real=True)
    values = []
    for size in (1, 2, 3):
        _, _, row = observer(size)
        start = section1_systems.free("x", size) * sp.Matrix([first, *[0] * (size - 1)])
        values.append((row * start)[0])
    return Equation([first] * 3, values)


@claim("1.6.kalman_unique | m = 1: with process noise the steady Riccati equation has one nonnegative solution.")
def steady_kalman_gain():
    # 2 a P + Q - P^2/R = -(P - P_1)(P - P_2)/R with real roots P_1, P_2, and P_1 P_2 = -Q R < 0. (For Q = 0 and a > 0
    # both roots 0 and 2 a R are nonnegative: the gain is then unique only with an initial covariance.)
    a, P = sp.symbols("a P", real=True)
    Q, R = sp.symbols("Q R", positive=True)
    root = sp.sqrt(a**2 * R**2 + Q * R)
    first, second = a * R + root, a * R - root
    return Equation([-Q * R, 2 * a * P + Q - P**2 / R], [first * second, -(P - first) * (P - second) / R])


@claim("1.6.kalman_unique.stabilising")
def difference_of_two_steady_solutions():
    """m = 2: D -> A_1 D + D A_2^T has the determinant (d_1 - d_2)^2 + (t_1 + t_2)(t_1 d_2 + t_2 d_1).

    D is the difference of 1.6.kalman_unique.any, t the traces and d the determinants of A_i. Where both stabilise,
    both t are negative and both d positive: the determinant is positive, and D = 0.
    """
    a, b = (sp.Matrix(2, 2, sp.symbols(f"{name}1:5", real=True)) for name in "ab")
    both = sp.Matrix(sp.kronecker_product(a, sp.eye(2)) + sp.kronecker_product(sp.eye(2), b))
    t1, t2, d1, d2 = a.trace(), b.trace(), a.det(), b.det()
    return Equation((d1 - d2) ** 2 + (t1 + t2) * (t1 * d2 + t2 * d1), both.det(method="berkowitz"))


CLAIMS_1 = claims(
    # Its entries are exp(-s) times 1 + s, s/lam, lam s, 1 - s with s = lam t; the largest for lam > 1 is lam s =
    # s^2/t, and s^2 exp(-s) <= 24/s^2.
    "1.two_stage.small | m = 2, Theta = 0: at a fixed instant the error transition vanishes as both poles -lam go "
    "to the left.",
    lambda: Bound(s**2 * sp.exp(-s), "<=", 24 / s**2, {s: (0, None)}),
)


@claim("1.two_stage.transition | The error transition matrix behind that bound solves its differential equation.")
def error_transition():
    lam, t = sp.symbols("lam t", positive=True)
    error = companion([0, 0]) - sp.Matrix([2 * lam, lam**2]) * unit_row(2)
    transition = sp.exp(-lam * t) * sp.Matrix([[1 - lam * t, t], [-(lam**2) * t, 1 + lam * t]])
    return Equation(transition.diff(t), error * transition)
