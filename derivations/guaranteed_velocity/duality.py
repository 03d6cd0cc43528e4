"""Sections 2 and 3: linear estimators, their worst correlation, and the dual problem."""

from itertools import product

import sympy as sp

from navsym.claims import PROVED, Bound, Equation, Finding, Property, claim, claims, state
from navsym.language.expression import to_text
from navsym.prove.identities import vanishes_identically
from navsym.prove.signs import Sign, prove_sign
from navsym_papers.guaranteed_velocity.model import INSTANTS, STATED, H, T, alternating, tau, weights

sigma = sp.Symbol("sigma", positive=True)
s, b = sp.symbols("s b", real=True)


def generic(name: str, rows: int, columns: int = 1) -> sp.Matrix:
    """A matrix of independent real symbols."""
    return sp.Matrix(rows, columns, lambda i, j: sp.Symbol(f"{name}{i + 1}{j + 1}", real=True))


def fundamental(at: int, size: int) -> sp.Matrix:
    """A fundamental matrix at one instant: any matrix, made of independent symbols."""
    return generic(f"theta{at}_", size, size)


# -- section 2 ---------------------------------------


def regressor_of_general_system(size: int) -> Equation:
    """H = (theta(T)^-1)* theta*(tau) h(tau), from z - w = h* theta(tau) y0 and q = theta(T) y0."""
    at_tau, at_end, h = fundamental(1, size), fundamental(2, size), generic("h", size)
    printed = (at_end.adjugate().T / at_end.det()) * at_tau.T * h
    y0 = generic("y", size)
    # z - w = H* q for every initial state: compare coefficients of y0.
    z = (h.T * at_tau * y0)[0]
    prediction = (printed.T * at_end * y0)[0]
    return Equation(prediction, z)


CLAIMS_2_4 = claims(
    "2.4.two | z = H* q + w with the printed H, for every system of two states.",
    lambda: regressor_of_general_system(2),
    "2.4.three | z = H* q + w with the printed H, for every system of three states.",
    lambda: regressor_of_general_system(3),
)


@claim("2.5")
def estimate_from_impulses():
    """Impulses make the integral of Phi z the sum of Phi_j z(tau_j): z quadratic, boxes of width e -> 0, 3 instants.

    The integral of Phi_j/e over a box is (Z(tau_j + e/2) - Z(tau_j - e/2))
    Phi_j/e with the antiderivative Z, and its limit is a derivative with respect to e.
    """
    c0, c1, c2, e, s = sp.symbols("c0 c1 c2 e s", real=True)
    z, Z = c0 + c1 * s + c2 * s**2, c0 * s + c1 * s**2 / 2 + c2 * s**3 / 3
    Phi, at = generic("Phi", 3), generic("tau", 3)
    boxes = sum((Phi[j] * (Z.subs(s, at[j] + e / 2) - Z.subs(s, at[j] - e / 2)) for j in range(3)), sp.S.Zero)
    return Equation(sum(Phi[j] * z.subs(s, at[j]) for j in range(3)), sp.diff(boxes, e).subs(e, 0))


def error_without_noise(count: int) -> Equation:
    """Delta l = (sum_j Phi_j H(tau_j) - P)* q: zero for every q exactly when (2.6) holds."""
    size = 3
    Phi, P, q = generic("Phi", count), generic("P", size), generic("q", size)
    regressors = [generic(f"H{j}_", size) for j in range(count)]
    estimate = sum((Phi[j] * (regressors[j].T * q)[0] for j in range(count)), sp.Integer(0))
    error = estimate - (P.T * q)[0]
    defect = sum((Phi[j] * regressors[j] for j in range(count)), sp.zeros(size, 1)) - P
    coefficients = [sp.diff(error, symbol) for symbol in q]
    return Equation(tuple(defect), tuple(coefficients))


def piecewise(name: str) -> tuple[sp.Expr, sp.Expr]:
    """A piecewise continuous function of s: one polynomial of degree 2 before the time b, another one behind it."""
    c = sp.symbols(f"{name}1:7", real=True)
    return c[0] + c[1] * s + c[2] * s**2, c[3] + c[4] * s + c[5] * s**2


def integral(pieces: tuple[sp.Expr, sp.Expr], impulse: sp.Expr) -> sp.Expr:
    """The integral over [0, T] of the pieces, which meet at b, and of one impulse."""
    first, second = (sp.integrate(sp.expand(piece), s) for piece in pieces)
    return first.subs(s, b) + second.subs(s, T) - second.subs(s, b) + impulse  # primitives without a constant


def products(one: tuple[sp.Expr, sp.Expr], other: tuple[sp.Expr, sp.Expr]) -> tuple[sp.Expr, sp.Expr]:
    return one[0] * other[0], one[1] * other[1]


CLAIMS_2_6 = claims(
    "2.6 | The error without noise vanishes for every q exactly when the integral of H Phi is P (3 instants).",
    lambda: error_without_noise(3),
)


@claim("2.6.piecewise")
def unbiasedness_with_a_continuous_part():
    """(2.6) with Phi_H: without noise the error is (integral of H Phi - P)* q; H and Phi_H quadratic on two pieces."""
    q, P, at = generic("q", 2), generic("P", 2), generic("h", 2)
    Phi_H, Phi_1 = piecewise("f"), sp.Symbol("Phi1", real=True)
    H_of = [piecewise(name) for name in ("v", "w")]
    z = tuple(q[0] * H_of[0][piece] + q[1] * H_of[1][piece] for piece in (0, 1))
    error = integral(products(Phi_H, z), Phi_1 * (at.T * q)[0]) - (P.T * q)[0]
    defect = [integral(products(Phi_H, H_of[i]), Phi_1 * at[i]) - P[i] for i in (0, 1)]
    return Equation(tuple(defect), tuple(sp.diff(error, symbol) for symbol in q))


@claim("2.D.piecewise")
def worst_variance_with_a_continuous_part():
    """D with Phi_H: r = sgn Phi sgn Phi gives (sigma integral of |Phi|)^2, all signs of two pieces and an impulse.

    ``|Phi|`` is a polynomial of degree 2 on each piece. Below this value every other correlation stays by
    2.D.never-exceeded, which holds for any two times.
    """
    size, impulse = piecewise("f"), sp.Symbol("a1", nonnegative=True)
    printed, derived = [], []
    for signs in product((1, -1), repeat=3):
        Phi = (*(sign * part for sign, part in zip(signs, size, strict=False)), signs[2] * impulse)

        def against(sign: int, Phi: tuple = Phi, signs: tuple = signs) -> sp.Expr:
            """The integral of Phi r with the correlation r between each time and one where Phi has this sign."""
            return integral((Phi[0] * signs[0] * sign, Phi[1] * signs[1] * sign), Phi[2] * signs[2] * sign)

        inner = tuple(Phi[part] * against(signs[part]) for part in range(3))
        derived.append(sigma**2 * integral(inner[:2], inner[2]))
        printed.append((sigma * integral(size, impulse)) ** 2)
    return Equation(tuple(printed), tuple(derived))


@claim("3.1.piecewise")
def weak_duality_with_a_continuous_part():
    """3.1 with Phi_H: integral of |Phi| - x.P is the integral of |Phi| - Phi x.H; quadratic on two pieces."""
    x, at = generic("x", 2), generic("h", 2)
    Phi, size, (Phi_1, a1) = piecewise("f"), piecewise("a"), sp.symbols("Phi1 a1", real=True)
    H_of = [piecewise(name) for name in ("v", "w")]
    P = [integral(products(Phi, H_of[i]), Phi_1 * at[i]) for i in (0, 1)]
    dual = tuple(x[0] * H_of[0][piece] + x[1] * H_of[1][piece] for piece in (0, 1))
    terms = tuple(size[piece] - Phi[piece] * dual[piece] for piece in (0, 1))
    printed = integral(size, a1) - x[0] * P[0] - x[1] * P[1]
    return Equation(printed, integral(terms, a1 - Phi_1 * (x.T * at)[0]))


def variance(weights_: tuple, correlation: sp.Matrix, deviations: tuple) -> sp.Expr:
    """M (sum Phi_j w_j)^2 for a given correlation and given standard deviations."""
    n = len(weights_)
    return sum(
        weights_[i] * weights_[j] * correlation[i, j] * deviations[i] * deviations[j]
        for i in range(n)
        for j in range(n)
    )


@claim("2.D.reached")
def worst_variance_is_reached():
    """sigma(tau) = sigma and r = sgn Phi sgn Phi give (sigma sum |Phi|)^2, for all signs of 4 weights."""
    sizes = sp.symbols("a1:5", positive=True)
    printed, derived = [], []
    for signs in product((1, -1), repeat=4):
        weights_ = tuple(s * a for s, a in zip(signs, sizes, strict=True))
        correlation = sp.Matrix(4, 4, lambda i, j, s=signs: s[i] * s[j])
        printed.append(sigma**2 * sum(sizes) ** 2)
        derived.append(variance(weights_, correlation, (sigma,) * 4))
    return Equation(tuple(printed), tuple(derived))


@claim("2.D.never-exceeded")
def worst_variance_is_not_exceeded():
    """No pair of instants contributes more: |Phi_i Phi_j| sigma^2 >= Phi_i Phi_j r sigma_i sigma_j.

    Summed over all pairs this is the upper bound (sigma sum |Phi|)^2, for any number of instants.
    The variable is chosen tight: sigma_i = sigma s_i with s_i in [0, 1], r = 1 - d with d in [0, 2].
    """
    s1, s2 = sp.symbols("s1 s2", nonnegative=True)
    r = sp.Symbol("r", real=True)
    return Bound(sp.Integer(1), ">=", r * s1 * s2, {s1: (0, 1), s2: (0, 1), r: (-1, 1)})


@claim("2.D.admissible")
def worst_correlation_is_admissible():
    """r(tau, s) = sgn Phi(tau) sgn Phi(s) is a correlation: its quadratic form is a square (4 instants)."""
    c, signs = generic("c", 4), generic("s", 4)
    form = sum(c[i] * c[j] * signs[i] * signs[j] for i in range(4) for j in range(4))
    return Equation((c.T * signs)[0] ** 2, form)


def objective(correlation: int) -> Equation:
    """The squared objective of (2.7) beside the variance at one correlation, for two weights of one sign."""
    a1, a2 = sp.symbols("a1 a2", positive=True)
    between = sp.Matrix([[1, correlation], [correlation, 1]])
    return Equation((sigma * (a1 + a2)) ** 2, variance((a1, a2), between, (sigma, sigma)))


def modulus(weight: sp.Expr) -> sp.Expr:
    """|weight| on the stated range, by its proved sign."""
    positive = prove_sign(weight, STATED).at_least(Sign.NONNEGATIVE)
    return weight if positive else -weight


CLAIMS_2_7 = claims(
    "2.7.name | After (2.7): its objective belongs to the best correlation, -1 for two weights of one sign. | "
    "paper: the introduction, which cites [3] too, calls it the problem of the worst correlation, and so it is",
    lambda: objective(-1),
    "2.7.name* | After (2.7): its objective belongs to the worst correlation, +1 for two weights of one sign.",
    lambda: objective(1),
)


# -- section 3 ---------------------------------------


@claim("3.remark1")
def permuting_components():
    """Exchanging two components of H and of P leaves the constraints as they are; the objective has neither."""
    Phi, P = generic("Phi", 3), generic("P", 3)
    columns = generic("H", 3, 3)
    defect = columns * Phi - P
    exchange = sp.Matrix([[0, 0, 1], [0, 1, 0], [1, 0, 0]])
    exchanged = (exchange * columns) * Phi - exchange * P
    return Equation(exchange * exchanged, defect)


@claim("3.1")
def weak_duality():
    """sum |Phi_j| - x.P = sum (|Phi_j| - Phi_j x.H(tau_j)), for three impulses; 3.1.terms has the sign of each term."""
    Phi, x = generic("Phi", 3), generic("x", 3)
    columns, sizes = generic("H", 3, 3), generic("a", 3)
    P = columns * Phi
    printed = sum(sizes) - (x.T * P)[0]
    derived = sum(sizes[j] - Phi[j] * (x.T * columns[:, j])[0] for j in range(3))
    return Equation(printed, derived)


@claim("3.1.terms")
def terms_of_weak_duality():
    """|Phi| - Phi x.H >= 0 where |x.H| <= 1: with 3.1 and 3.1.piecewise, the dual (3.1) bounds (2.7) from below."""
    Phi, bounded = sp.symbols("Phi s", real=True)
    return Bound(sp.Abs(Phi) - Phi * bounded, ">=", 0, {bounded: (-1, 1)})


@claim("3.2 | The system N Phi = P at the instants 0, T/2, T is consistent, for each of the three states.")
def weights_solve_the_system():
    columns = sp.Matrix.hstack(*(H(at) for at in INSTANTS))
    return Equation(sp.eye(3), sp.Matrix.hstack(*[columns * sp.Matrix(weights(state)) for state in range(3)]), STATED)


def slope_at_the_start() -> sp.Expr:
    """d(x.H)/dtau at tau = 0, x the alternating dual: it is 2 cot(T/4), so that 1 - (x.H)^2 has finitely many zeros."""
    return sp.diff((alternating().T * H())[0], tau).subs(tau, 0)


def finitely_many_contacts() -> Finding:
    """Whether x.H, analytic in tau, is no constant: for the optimal duals (1, 0, 0) of y1, alternating of y2 and y3."""
    moves = vanishes_identically(slope_at_the_start() - 2 * sp.cot(T / 4))
    still = vanishes_identically(H()[0] - 1)
    return Finding((not still, moves, moves), "slope of x.H at tau = 0", PROVED, "all T in (0, pi/2]")


def say_contacts(relation: str) -> tuple[dict, ...]:
    """That 1 - (x.H)^2 stands in this relation to 0 for y1, and that x.H has a slope for y2 and y3."""
    slope, stated = to_text(slope_at_the_start()), {"T": ["0", "pi/2", ["open-low"]]}
    ends = state(slope, "=", "2*cot(T/4)", stated), state("2*cot(T/4)", ">", "0", stated)
    return state(to_text(1 - H()[0] ** 2), relation, "0"), *ends


def sums_of_weights(weights_: tuple) -> tuple:
    """N Phi and sum |Phi_j| at the times 0, pi, 2 pi for T = 2 pi."""
    columns = sp.Matrix.hstack(*(H(at).subs(T, 2 * sp.pi) for at in (sp.Integer(0), sp.pi, 2 * sp.pi)))
    return (*(columns * sp.Matrix(weights_)), sum(abs(w) for w in weights_))


CLAIMS_3_2 = claims(
    "3.2.contacts | The optimal duals (1, 0, 0) of y1 and the alternating one of y2, y3 touch their bounds at m = "
    "3 instants at most. | paper: for y1 the optimal dual (1, 0, 0) gives |X.H| = 1 at every instant; l <= m holds "
    "for a basis only",
    lambda: Property((True, True, True), finitely_many_contacts(), say_contacts("!=")),
    "3.2.contacts* | The dual (1, 0, 0) of y1 touches at every instant, the alternating one at finitely many "
    "(three: unique.*).",
    lambda: Property((False, True, True), finitely_many_contacts(), say_contacts("=")),
    "3.2.theorem | After (3.2): every solution at the contacts of an optimal dual has the value X0.P; here Phi = "
    "(5, -1/2, -9/2). | paper: a solution of (3.2) for y3 at T = 2 pi, X0 = (1, 0, 1), contacts 0, pi, 2 pi has "
    "sum |Phi_j| = 10, not 1; the signs of the weights have to be those of X0.H(tau_j)",
    lambda: Equation((0, 0, 1, 1), sums_of_weights((5, -sp.Rational(1, 2), -sp.Rational(9, 2)))),
)


@claim("3.2.theorem*")
def solution_with_signs_is_optimal():
    """After (3.2): a solution has the value X0.P when sgn Phi_j = X0.H(tau_j) at each of its three instants."""
    sizes, x = sp.symbols("a1:4", nonnegative=True), generic("x", 3)
    printed, derived = [], []
    for signs in product((1, -1), repeat=3):
        columns = generic("H", 3, 3)
        for j, sign in enumerate(signs):  # x.H(tau_j) = sign
            columns[0, j] = (sign - x[1] * columns[1, j] - x[2] * columns[2, j]) / x[0]
        P = columns * sp.Matrix([sign * size for sign, size in zip(signs, sizes, strict=True)])
        printed.append(sum(sizes))
        derived.append((x.T * P)[0])
    return Equation(tuple(printed), tuple(derived))


@claim("3.2.consistent")
def contact_without_solution():
    """(3.2) need not be consistent at chosen contacts: y1, X0 = (1, 0, 0), tau = 0, T = pi/2: |H(0) Phi - e1| > 0."""
    Phi = sp.Symbol("Phi", real=True)
    defect = H(sp.Integer(0)).subs(T, sp.pi / 2) * Phi - sp.Matrix([1, 0, 0])
    return Bound(sp.expand((defect.T * defect)[0]), ">", 0)


@claim("3.3 | (3.1) becomes (3.3): with x = (1, u2, u3)/L the bound |x.H| <= 1 reads |H1 + u2 H2 + u3 H3| <= L.")
def scaling_to_a_polynomial():
    L = sp.Symbol("L", positive=True)
    u2, u3, h1, h2, h3 = sp.symbols("u2 u3 H1 H2 H3", real=True)
    printed = (h1 + u2 * h2 + u3 * h3) / L
    x = sp.Matrix([1 / L, u2 / L, u3 / L])
    return Equation(printed, (x.T * sp.Matrix([h1, h2, h3]))[0])


@claim("3.3.back")
def dual_of_a_polynomial():
    """The converse: a dual x with x1 > 0 and |x.H| <= 1 gives |H1 + u2 H2 + u3 H3| <= L with L = 1/x1, u_j = x_j/x1."""
    x1 = sp.Symbol("x1", positive=True)
    x2, x3, h1, h2, h3 = sp.symbols("x2 x3 H1 H2 H3", real=True)
    L = 1 / x1
    return Equation(h1 + x2 * L * h2 + x3 * L * h3, L * (x1 * h1 + x2 * h2 + x3 * h3))


def coefficients_of_the_polynomial() -> Finding:
    """On which of z2, z3, u2, u3 the polynomial of (3.3) depends: a minimum over any other changes nothing."""
    names = sp.symbols("z2 z3 u2 u3", real=True)
    h1, h2, h3 = sp.symbols("H1 H2 H3", real=True)
    polynomial = h1 + names[2] * h2 + names[3] * h3
    free = tuple(v.name for v in names if not vanishes_identically(sp.diff(polynomial, v)))
    return Finding(free, "normal form of the derivatives", PROVED, "all H1, H2, H3, also for other states than y3")


def say_coefficients(second: str, third: str) -> tuple[dict, ...]:
    """The derivatives of the polynomial by z2, z3, u2, u3, for H2, H3 != 0: these by the names given, else 0."""
    slopes = {"z2": "0", "z3": "0", "u2": "0", "u3": "0"} | {second: "H2", third: "H3"}
    line = {name: [None, None, ["nonzero"] if name in ("H2", "H3") else []] for name in ("H1", "H2", "H3", *slopes)}
    return tuple(state(f"diff(H1 + u2*H2 + u3*H3, {name})", "=", slope, line) for name, slope in slopes.items())


CLAIMS_3_3 = claims(
    "3.3.min | The minimum of (3.3) is taken over z_2, z_3, as printed. | undecidable: z_j stands below the "
    "minimum; the polynomial has the coefficients u_j, as (3.4) and (4.2) have them",
    lambda: Property(("z2", "z3"), coefficients_of_the_polynomial(), say_coefficients("z2", "z3")),
    "3.3.min* | The minimum of (3.3) is taken over u_2, u_3.",
    lambda: Property(("u2", "u3"), coefficients_of_the_polynomial(), say_coefficients("u2", "u3")),
)


@claim("3.4")
def dual_from_polynomial():
    """x01 = 1/L and x0j = u_j/L: alternance of (3.3) for y3 and the constraints of (3.1) give one dual (T <= pi/2)."""
    columns = sp.Matrix.hstack(*(H(at) for at in INSTANTS))
    front, second, third = columns[2, :], columns[0, :], columns[1, :]
    # front + u2 second + u3 third = -L, L, -L at the three times, for (u2, u3, L)
    matrix = sp.Matrix.vstack(second, third, sp.Matrix([[1, -1, 1]])).T
    u2, u3, L = -matrix.adjugate() * front.T / matrix.det()
    x = alternating()
    return Equation((1 / L, u2 / L, u3 / L), (x[2], x[0], x[1]), STATED)


def least_deviation() -> sp.Expr:
    """L for y3: the value of the alternating dual is 1/L."""
    return 1 / alternating()[2]


def total_variation() -> sp.Expr:
    """sum |Phi_j| for y3 on the stated range."""
    return sum((modulus(w) for w in weights(2)), sp.Integer(0))


CLAIMS_3_6 = claims(
    "3.6 | sigma integral |Phi| = L^-1, as printed, for y3. | undecidable: the factor sigma is lost on the right: "
    "(4.13) has sigma1/L, and the units ask for it",
    lambda: Equation(1 / least_deviation(), sigma * total_variation(), STATED),
    "3.6* | sigma integral |Phi| = sigma L^-1, for y3.",
    lambda: Equation(sigma / least_deviation(), sigma * total_variation(), STATED),
)


@claim("3.more-measurements")
def using_all_measurements_can_be_worse():
    """y3, T = pi/2: least squares at 0, pi/8 ... pi/2 has a larger guaranteed error than the three instants."""
    at = [sp.pi / 8 * k for k in range(5)]
    rows = sp.Matrix.hstack(*(H(t).subs(T, sp.pi / 2) for t in at))
    normal = rows * rows.T
    least_squares = (normal.adjugate() / normal.det() * rows)[2, :]
    spread = sum((sp.Abs(w) for w in least_squares), sp.Integer(0))
    optimum = total_variation().subs(T, sp.pi / 2)
    return Bound(optimum, "<", spread)
