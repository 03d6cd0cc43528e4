"""Section 1, (1.14): the form u, v, w for a basis with i < m, and the choice of i."""

import sympy as sp

from navsym.claims import PROVED, Equation, Finding, claim
from navsym.observability.splits import companion, last_row
from navsym_papers.joint_correction import section1_systems
from navsym_papers.joint_correction.matrices import corner, exact_inverse, shift, to_lowest_terms, unit_row
from navsym_papers.joint_correction.section1_chains import coefficients, theta_of
from navsym_papers.joint_correction.section1_systems import System, flat, free, k, overlapping, polynomial_of

#: Splits i, j of the overlapping system (n = 4, m = 3) that have all three parts.
CASES = ((2, 2), (1, 3))


def parts(i: int, j: int) -> tuple[System, dict[str, sp.ImmutableMatrix], dict[str, sp.ImmutableMatrix]]:
    """The system, the free matrices, and the rows L_u, L_v, L_w of the definition."""
    s = overlapping()
    C = {"u": free("x", i), "v": free("v", s.m - i), "w": free("z", j)}
    A = s.chain(1, s.m)
    rows = {"u": C["u"] * A[:i, :], "v": C["v"] * A[i:, :], "w": C["w"] * s.chain(2, j)}
    return s, C, rows


def delta_of(s: System, i: int, j: int) -> list[sp.Expr]:
    """delta_1 ... delta_n: b_{j+1} in the basis a_1 ... a_i, b_1 ... b_j."""
    basis = sp.Matrix.vstack(s.chain(1, i), s.chain(2, j))
    return coefficients(basis, s.chain(2, j + 1)[j, :])


@claim("1.14.matrices | F, F°, Theta_u, Theta_v, D_u, D_w as printed, solved from the chains (i = 2, j = 2, m = 3).")
def constant_matrices():
    s = overlapping()
    t1, t2, t3 = theta_of(s)
    d1, d2, d3, d4 = delta_of(s, 2, 2)
    A, B = s.chain(1, 4), s.chain(2, 3)
    first = [coefficients(A[:3, :], A[row, :]) for row in (1, 2, 3)]
    second = [coefficients(sp.Matrix.vstack(A[:2, :], B[:2, :]), B[row, :]) for row in (1, 2)]
    printed = [[0, 1, 0], [0, 0, 1], [t1, t2, t3], [0, 0, 0, 1], [d1, d2, d3, d4]]
    return Equation([sp.sympify(x) for row in printed for x in row], [x for row in [*first, *second] for x in row])


@claim("1.14.delta | b_{j+1} in the basis a_1 ... a_i, b_1 ... b_j has the coefficients delta, here by Cramer's rule.")
def delta_relation():
    for i, j in CASES:
        s = overlapping()
        basis = sp.Matrix.vstack(s.chain(1, i), s.chain(2, j))
        target = s.chain(2, j + 1)[j, :]
        det = basis.det(method="berkowitz")
        delta = []
        for r in range(4):
            changed = basis.as_mutable()
            changed[r, :] = target
            delta.append(changed.det(method="berkowitz") / det)
        yield to_lowest_terms(sp.Matrix([delta])) * basis, target


@claim("1.14.outputs")
def outputs():
    """sigma_1 = g_u^T u, sigma_2 = g_w^T w with g_u^T = (1 0 ... 0) C_11^-1, g_w^T = (1 0 ... 0) C_22^-1."""
    for i, j in CASES:
        s, C, rows = parts(i, j)
        yield (
            flat(
                unit_row(i) * exact_inverse("C11", C["u"]) * rows["u"],
                unit_row(j) * exact_inverse("C22", C["w"]) * rows["w"],
            ),
            flat(s.h(1).T, s.h(2).T),
        )


@claim("1.14.dimension | The system (1.14) has m + j variables, m - i more than xi.")
def dimension():
    i, j, m, n = (sp.Symbol(name, integer=True, positive=True) for name in "ijmn")
    counted = [parts(*case) for case in CASES]
    sizes = [sum(rows[name].rows for name in "uvw") - s.n for s, _, rows in counted]
    expected = [(m - i).subs({m: s.m, i: case[0]}) for (s, _, _), case in zip(counted, CASES, strict=True)]
    return Equation([*expected, m - i], [*map(sp.Integer, sizes), (i + (m - i) + j - n).subs(n, i + j)])


@claim("1.14.one_to_one")
def u_and_w_determine_the_state():
    """(u, w) = L_* xi is one to one: L_* times its inverse is the identity, although v is carried along."""
    for i, j in CASES:
        _, _, rows = parts(i, j)
        L = sp.ImmutableMatrix.vstack(rows["u"], rows["w"])
        yield sp.eye(4), L * exact_inverse("L", L)


@claim("1.14.error")
def error_dynamics():
    """Errors of the algorithm: u and v by themselves, w driven by the error of u alone (i = 2, m = 3, j = 2)."""
    printed, derived = [], []
    i, m, j = 2, 3, 2
    theta = sp.symbols("theta1:4", real=True)
    delta = sp.symbols("delta1:5", real=True)
    sizes = {"u": i, "v": m - i, "w": j}
    truth = {name: sp.Matrix(sp.symbols(f"{name}1:{size + 1}", real=True)) for name, size in sizes.items()}
    guess = {name: sp.Matrix(sp.symbols(f"{name}e1:{size + 1}", real=True)) for name, size in sizes.items()}
    gains = {"u": sp.Matrix(k[:2]), "v": sp.Matrix(k[2:3]), "w": sp.Matrix(k[3:5])}
    full = companion([*theta])
    chain = sp.Matrix.vstack(truth["u"], truth["v"])
    chain_guess = sp.Matrix.vstack(guess["u"], guess["v"])
    link, own = last_row(j, delta[:i]), companion(delta[i:])
    first = sp.Matrix.vstack(gains["u"], gains["v"]) * (truth["u"][0] - guess["u"][0])
    rate = full * chain - full * chain_guess - first
    rate_w = link * truth["u"] + own * truth["w"] - link * guess["u"] - own * guess["w"]
    rate_w -= gains["w"] * (truth["w"][0] - guess["w"][0])
    error = {name: truth[name] - guess[name] for name in sizes}
    F, F0 = shift(i), corner(i, m - i)
    printed += list((F - gains["u"] * unit_row(i)) * error["u"] + F0 * error["v"])
    printed += list(
        (last_row(m - i, theta[:i]) - gains["v"] * unit_row(i)) * error["u"] + companion(theta[i:]) * error["v"]
    )
    printed += list(link * error["u"] + (own - gains["w"] * unit_row(j)) * error["w"])
    derived += [*rate, *rate_w]
    return Equation(printed, derived)


@claim("1.14.characteristic")
def characteristic_polynomial():
    """The poles of (1.14) are those of the (u, v) stage, of order m, and of the w stage, of order j."""
    theta, delta = sp.symbols("theta1:4", real=True), sp.symbols("delta1:5", real=True)
    first = companion(theta) - sp.Matrix(k[:3]) * unit_row(3)
    second = companion(delta[2:]) - sp.Matrix(k[3:5]) * unit_row(2)
    link = sp.Matrix.hstack(last_row(2, delta[:2]), sp.zeros(2, 1))
    whole = sp.Matrix.vstack(sp.Matrix.hstack(first, sp.zeros(3, 2)), sp.Matrix.hstack(link, second))
    expected = polynomial_of(first) * polynomial_of(second)
    return Equation(expected, polynomial_of(whole))


@claim("1.14.higher_derivatives")
def higher_derivatives_take_longer():
    """Degree 3, white noise: the variance of derivative r falls as T^-(2r+1), with 16, 1200, 25920, 100800 over it.

    So the higher derivatives are the slower ones at first. Polynomial of degree 3 in white noise of unit
    intensity; information matrix with the entries T^(i+j+1)/((i+j+1) i! j!).
    """
    T = sp.Symbol("T", positive=True)
    information = sp.Matrix(
        4, 4, lambda i, j: T ** (i + j + 1) / (sp.Integer(i + j + 1) * sp.factorial(i) * sp.factorial(j))
    )
    covariance = exact_inverse("information", sp.ImmutableMatrix(information))
    printed = [constant / T ** (2 * r + 1) for r, constant in enumerate((16, 1200, 25920, 100800))]
    return Equation(printed, [covariance[r, r] for r in range(4)])


@claim("1.14.choice")
def choice_of_i():
    """The least max(i, j) over all bases: for the overlapping system i = j = 2, not the two-stage i = m = 3."""
    from navsym.observability.splits import best_split

    best = best_split(overlapping().found)
    method = "all determinants of a_1 ... a_i, b_1 ... b_j"
    basis = sp.Matrix.vstack(overlapping().chain(1, 2), overlapping().chain(2, 2))
    finding = Finding((best.i, best.j), method, PROVED, scope="l = 4")
    larger = [(f"2 + abs({i} - 2)", ">", "2") for i in (0, 1, 3)]  # of i and 4 - i
    return section1_systems.say_ranks((2, 2), finding, [(section1_systems.seen_at_once(basis), 4)], *larger)


@claim("1.14.gains_unique")
def gains_of_the_first_stage_are_unique():
    """Prescribed roots of the (u, v) stage determine K_u and K_v together, those of the w stage K_w.

    The coefficients are affine in the gains with a matrix of determinant 1 or -1 for all theta and delta.
    """
    theta, delta = sp.symbols("theta1:4", real=True), sp.symbols("delta1:5", real=True)
    values = []
    for matrix, size, gains in ((companion(theta), 3, k[:3]), (companion(delta[2:]), 2, k[3:5])):
        polynomial = polynomial_of(matrix - sp.Matrix(gains) * unit_row(size))
        p = next(symbol for symbol in polynomial.free_symbols if symbol.name == "p")
        rows = sp.Matrix([sp.expand(polynomial).coeff(p, size - 1 - r) for r in range(size)])
        values.append(sp.expand(rows.jacobian(gains).det(method="berkowitz")) ** 2)
    return Equation([sp.Integer(1), sp.Integer(1)], values)
