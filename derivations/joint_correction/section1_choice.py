"""Section 1, after (1.13): when "a_1 ... a_i, b_1 ... b_j for some i < m" is a basis at all.

Nothing is assumed but the coefficients of (1.4) and (1.10): in the basis a_1 ... a_m, b_1 ... b_{n-m} of (1.8) the
matrix G^T shifts the chains, and every further b is a row of numbers in theta and phi.
"""

import sympy as sp

from navsym.claims import Equation, claim

#: (m, n - m) for which the determinants are formed, with all theta and phi as symbols.
SIZES = tuple((m, rest) for m in (1, 2, 3, 4) for rest in (1, 2))


def second_chain(m: int, rest: int, count: int, last: int) -> list[sp.Matrix]:
    """b_1 ... b_count as rows (1, n) in the basis of (1.8); phi_r = 0 for last < r <= m."""
    n = m + rest
    theta = sp.symbols(f"theta1:{m + 1}", real=True)
    phi = [x if r < last or r >= m else sp.Integer(0) for r, x in enumerate(sp.symbols(f"phi1:{n + 1}", real=True))]
    step = sp.zeros(n, n)  # row k: the image of basis vector k under G^T
    for k in range(n):
        if k in (m - 1, n - 1):
            step[k, :] = sp.Matrix([[*theta, *([0] * rest)]]) if k == m - 1 else sp.Matrix([phi])
        else:
            step[k, k + 1] = 1
    rows = [sp.Matrix(1, n, lambda _, s: int(s == m))]
    while len(rows) < count:
        rows.append((rows[-1] * step).applyfunc(sp.expand))
    return rows


def basis_determinant(m: int, rest: int, i: int, last: int) -> sp.Expr:
    """det(a_1 ... a_i, b_1 ... b_{n-i}) over det(a_1 ... a_m, b_1 ... b_{n-m}), squared: the order of rows is free."""
    n = m + rest
    first = [sp.Matrix(1, n, lambda _, s, k=k: int(s == k)) for k in range(i)]
    rows = [*first, *second_chain(m, rest, n - i, last)]
    return sp.expand(sp.Matrix.vstack(*rows).det(method="berkowitz") ** 2)


@claim("1.14.exists")
def largest_i_below_m():
    """A basis with i < m exists when phi_r, r >= 2, is the last of phi_1 ... phi_m not zero: the largest i is r - 1.

    For r <= i < m the determinant is zero, for i = r - 1 it is phi_r^(m-r+1) times that of (1.8), up to sign. With
    phi_1 alone only the second chain by itself (i = 0) would do, with none of them l = n - m and no other basis exists.
    """
    for m, rest in SIZES:
        for last in range(1, m + 1):
            phi = sp.Symbol(f"phi{last}", real=True)
            for i in range(last - 1, m):
                yield (
                    phi ** (2 * (m - last + 1)) if i == last - 1 else sp.Integer(0),
                    basis_determinant(m, rest, i, last),
                )


@claim("1.14.exists.alone")
def no_overlap_no_choice():
    """Without overlap, phi_1 = ... = phi_m = 0, no i < m gives a basis: the modification needs m + l > n."""
    cases = [(m, rest, i) for m, rest in SIZES for i in range(m)]
    return Equation([sp.Integer(0)] * len(cases), [basis_determinant(m, rest, i, 0) for m, rest, i in cases])


one_step_below_the_two_stage_split = claim(
    "1.14.next",
    "The step from i = m to i = m - 1 is possible exactly when phi_m is not zero, whatever the other coefficients.",
    lambda: Equation(
        [sp.Symbol(f"phi{m}", real=True) ** 2 for m, _ in SIZES],
        [basis_determinant(m, rest, m - 1, m) for m, rest in SIZES],
    ),
)
