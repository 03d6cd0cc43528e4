"""The dynamic inversion algorithm: gain, covariance, criterion and the field of Q.

Worked in the variables f of the first stage, where all matrices are integer; the normalised variables
differ by the constant positive diagonal D_s, which changes none of the statements.
"""

import re
from fractions import Fraction
from itertools import pairwise, product

import sympy as sp

from navsym.claims import PROVED, Equation, Property, claims, fact, state
from navsym_papers.trajectory.model import dynamics, first_state, nilpotent_exponential, pascal_rows

N = 3
R = sp.Symbol("R", positive=True)
z = sp.Symbol("z", real=True)
F = sp.Matrix(sp.symbols(f"f1:{N + 1}", real=True))
K = sp.Matrix(sp.symbols(f"K1:{N + 1}", real=True))
Q = sp.diag(*sp.symbols(f"q1:{N + 1}", positive=True))

PHI = sp.Matrix(pascal_rows(N))
H_STEP = sp.ones(1, N)  # H_f: acts on the state before the step


def printed_gain() -> sp.Matrix:
    """The gain with the row H^- of equation 5."""
    return P_AHEAD * H_STEP.T / ((H_STEP * P_AHEAD * H_STEP.T)[0] + R)


def symmetric(name: str) -> sp.Matrix:
    """A symmetric (N, N) matrix of free symbols."""
    return sp.Matrix(N, N, lambda i, j: sp.Symbol(f"{name}{min(i, j) + 1}{max(i, j) + 1}", real=True))


P_BEFORE, P_AHEAD = symmetric("p"), symmetric("m")


def row_after_step() -> sp.Matrix:
    """The row that turns the state after the step into the measurement: H_f Phi_f^-1."""
    return H_STEP * PHI.inv()


def regression_gain() -> sp.Matrix:
    """Covariance of state and measurement over the variance of the measurement: the least-variance gain."""
    row = row_after_step()
    return P_AHEAD * row.T / ((row * P_AHEAD * row.T)[0] + R)


# -- estimator -------------------------------------------------------------------------------------------


def estimator_form(row: sp.Matrix) -> Equation:
    """C y + K z with C = Phi^- - K row, beside prediction and correction."""
    predicted = PHI * F
    derived = predicted + K * (z - (row_after_step() * predicted)[0])
    return Equation(list((PHI - K * row) * F + K * z), list(derived))


SCALE = sp.symbols(f"d1:{N + 1}", positive=True)
NORMALISED = sp.Matrix(sp.symbols(f"y1:{N + 1}", real=True))


def gain():
    row = sp.Matrix([[1] + [0] * (N - 1)])
    return Equation(list(P_AHEAD * row.T / ((row * P_AHEAD * row.T)[0] + R)), list(regression_gain()))


def example_box() -> dict[sp.Symbol, tuple[int, int]]:
    """Positive variances; covariances of either sign, small enough to keep the matrix definite."""
    return {x: ((2, 3) if x == P_AHEAD[i, i] else (-1, 1)) for i in range(N) for x in P_AHEAD[i, i:]}


def covariance(left: sp.Matrix, right: sp.Matrix) -> sp.Expr:
    """Covariance of two linear combinations of the error before the step, term by term."""
    return sum(left[i] * right[j] * P_BEFORE[i, j] for i in range(N) for j in range(N))


def matrix_after(gain: sp.Matrix) -> sp.Matrix:
    """Matrix of the corrected error for any gain: Joseph's form with the row that reads the state after the step."""
    rest = sp.eye(N) - gain * row_after_step()
    return rest * P_AHEAD * rest.T + gain * R * gain.T


CLAIMS_ALGORITHM = claims(
    "algorithm.C | C = Phi^- - K H^0 for any row H^0, as it came out of the scan; n = 3. | scan: H^0 is defined "
    "nowhere: the minus over H of equation 5 came out as a nought; by hand: n = 1, C = 1 - K H^0 is 1 - K only for "
    "H^0 = 1",
    lambda: estimator_form(sp.Matrix([sp.symbols(f"h1:{N + 1}", real=True)])),
    "algorithm.C* | y_(k+1) = C y_k + K z_(k+1) with C = Phi^- - K H^- is prediction and correction; n = 3.",
    lambda: estimator_form(H_STEP),
    "algorithm.estimate | The estimate of x^q, which is y, is D^-1 y, as it came out of the scan; n = 3. | scan: "
    "one line names y_k the estimate of x^q and then x^q = D^-1 p y_k that of x: the second superscript has to be "
    "the star that J uses, and the p belongs to no factor; by hand: D = 2, y = 4: x^q is 4, and 2 is x",
    lambda: Equation(list(sp.diag(*SCALE).inv() * NORMALISED), list(NORMALISED)),
    "algorithm.estimate* | The estimate of x, the solution of D x = y, is x^* = D^-1 y; n = 3.",
    lambda: Equation(
        list(sp.diag(*SCALE).inv() * NORMALISED), [own / scale for own, scale in zip(NORMALISED, SCALE, strict=True)]
    ),
    "algorithm.K | Gain with the row H^- of equation 5, as printed; n = 3. | paper: P^- is the matrix of the state "
    "after the step, but H^- = H_p D^-1 of equation 5 reads the state before it: the row has to be H D^-1, the "
    "same slip as in the second measurement equation of 4; by hand: P^- = E, R = 1, rows (1, 1) before and (1, 0) "
    "after the step: the gain is (1/2, 0), the print has (1/3, 1/3)",
    lambda: Equation(list(printed_gain()), list(regression_gain()), example_box()),
    "algorithm.K* | Gain with the row H D^-1, which reads the state after the step; n = 3.",
    gain,
    "algorithm.P_ahead | P^- = Phi P Phi^T + Q is the matrix of Phi e + w for independent e and w; n = 3.",
    lambda: Equation(
        PHI * P_BEFORE * PHI.T + Q,
        sp.Matrix(N, N, lambda i, j: covariance(PHI[i, :], PHI[j, :]) + (Q[i, i] if i == j else 0)),
    ),
    "algorithm.P | P = (E - K H^-) P^-, with the printed gain, is the matrix of the corrected error; n = 3. | "
    "paper: with the row H^- of equation 5 and its gain; by hand, as in algorithm.K: the print has 2/3, -1/3, 2/3 "
    "where the errors have 5/9, -1/9, 11/9",
    lambda: Equation((sp.eye(N) - printed_gain() * H_STEP) * P_AHEAD, matrix_after(printed_gain()), example_box()),
    "algorithm.P* | P = (E - K H D^-1) P^- is the matrix of the corrected error, for the gain of algorithm.K*; n = 3.",
    lambda: Equation((sp.eye(N) - regression_gain() * row_after_step()) * P_AHEAD, matrix_after(regression_gain())),
)


# -- the field of Q ----------------------------------------------------------------------------------------


def say_field(count: int, n: int) -> dict:
    """That n independent choices among three are so many."""
    return state(str(count), "=", f"product(3, k, 1, {n})")


def size_of_field(printed: int) -> Property:
    return fact(printed, len(field(5)), "enumeration", PROVED, scope="n = 5", meaning=(say_field(printed, 5),))


def field_size_power():
    powers, found = tuple(3**n for n in range(1, 8)), tuple(len(field(n)) for n in range(1, 8))
    meaning = tuple(map(say_field, powers, range(1, 8)))
    return fact(powers, found, "enumeration", PROVED, scope="n = 1..7", meaning=meaning)


#: What the counts are made for: other centres give other numbers.
FIELD_SCOPE = "n = 5, centre 1, 1/3, ..., 1/9, start f = 0, P = E, R = 1, tau = 0.2, row of ones as printed"


def field(n: int) -> list[tuple[Fraction, ...]]:
    """All diagonals around a centre, each element halved, kept or doubled.

    The centre has unequal elements: with equal ones the symmetry of the sum in S would merge candidates.
    """
    centre = [Fraction(1, 2 * i + 1) for i in range(n)]
    factors = product((Fraction(1, 2), Fraction(1), Fraction(2)), repeat=n)
    return [tuple(c * f for c, f in zip(centre, choice, strict=True)) for choice in factors]


def criteria(n: int, row: list[int], residual_after: bool) -> set[Fraction]:
    """Distinct values of J over the field, one step, in exact arithmetic; arguments as for :func:`terms`."""
    return {first + rest for first, rest in terms(n, row, residual_after)}


def terms(n: int, row: list[int], residual_after: bool) -> list[tuple[Fraction, Fraction]]:
    """First term of J and the sum of the others for every candidate of the field.

    row            : row used in the gain
    residual_after : first term from the corrected state instead of the predicted one
    Start: f = 0, P = E, R = 1, measurement 1, weights 1/5 and 1/25 (tau and tau^2 for 0.2 s).
    """
    Phi = pascal_rows(n)
    ahead = [[sum(Phi[i][k] * Phi[j][k] for k in range(n)) for j in range(n)] for i in range(n)]
    values = []
    for q in field(n):
        g = [sum(ahead[i][j] * row[j] for j in range(n)) + q[i] * row[i] for i in range(n)]
        S = sum(a * b for a, b in zip(row, g, strict=True)) + 1
        gains = [x / Fraction(S) for x in g]
        residual = 1 - gains[0] if residual_after else Fraction(1)
        values.append((residual**2, gains[1] ** 2 / 5 + gains[2] ** 2 / 25))
    return values


def counted(values: set[Fraction]) -> tuple[int, str, dict]:
    """How many different values there are, their ends, and that the roots of the gaps between them are positive."""
    gaps = [f"sqrt({b} - {a})" for a, b in pairwise(sorted(values))]
    return len(values), f"{float(min(values)):.9g} to {float(max(values)):.9g}", state("*".join(gaps), ">", "0")


def count_values(count: int) -> Property:
    found, ends, text = counted(criteria(5, [1] * 5, residual_after=False))
    return fact(count, found, "exact enumeration", PROVED, scope=FIELD_SCOPE, evidence=ends, meaning=[text])


def count_first_terms(counts: tuple[int, int]) -> Property:
    """The first of them has no gain in it: its derivative is zero."""
    sets = [{first for first, _ in terms(5, [1] * 5, after)} for after in (False, True)]
    found, ends, text = counted(sets[1])
    meaning = [state("diff(nu**2, K)", "=", "0", {"nu": [None, None, []], "K": [None, None, []]}), text]
    both = len(sets[0]), found
    return fact(counts, both, "exact enumeration", PROVED, scope=FIELD_SCOPE, evidence=ends, meaning=meaning)


def criterion_prefers_standing_still():
    # nu is the innovation, the same for all candidates. The minimum over a field of Q thus falls on the candidate
    # that corrects speed and acceleration least, step after step, however well or badly it fits.
    rho, tau = sp.symbols("rho tau", positive=True)
    x1, x2, nu = sp.symbols("x1 x2 nu", real=True)
    K2, K3 = sp.symbols("K2 K3", real=True)
    gain = sp.Matrix([sp.Symbol("K1", real=True), K2, K3, *sp.symbols("K4 K5", real=True)])
    Phi, estimate = nilpotent_exponential(dynamics(5, rho), tau), sp.Matrix([x1, x2, 0, 0, 0])
    ahead = Phi * estimate
    measured = ahead[0] + nu
    change = ahead + gain * (measured - ahead[0]) - estimate
    derived = (measured - (first_state(5) * estimate)[0]) ** 2 + change[1] ** 2 * tau + change[2] ** 2 * tau**2
    printed = (rho * tau * x2 + nu) ** 2 + nu**2 * (K2**2 * tau + K3**2 * tau**2)
    return Equation(printed, sp.expand(derived))


def values_with_corrected_gain() -> int:
    """With the row of the corrected gain only q_1 enters: three different values of J, for every n.

    K = (g + q_1 e_1) / (g_1 + q_1 + R): a criterion of one step cannot tune the other elements of Q, which
    is why the corrected algorithm carries its candidates through several steps.
    """
    return len(criteria(5, [1, 0, 0, 0, 0], residual_after=True))


CLAIMS_ALGORITHM_2 = claims(
    "algorithm.NQ | Number of values in the field for n = 5, as printed. | undecidable: 3^5 = 243: a digit, or one "
    "candidate of the field that is not counted",
    lambda: size_of_field(242),
    "algorithm.NQ* | Number of values in the field for n = 5.",
    lambda: size_of_field(243),
    "algorithm.NQ.power | The field has 3^n candidates: each of n elements may fall, stay or rise.",
    field_size_power,
    "algorithm.field | For one centre and one start the 3^5 candidates give as many values of J (equal elements "
    "would merge some).",
    lambda: count_values(3**5),
    # The candidates differ in K_(k+1), and so in x*_(k+1); what was estimated before cannot show which of them fits.
    "algorithm.J.first | With x*_k, as printed, the first term of J is one number for all candidates; with "
    "x*_(k+1) it takes 216 values.",
    lambda: count_first_terms((1, 216)),
    "algorithm.J.still | At constant estimated speed J = (rho tau x_2 + nu)^2 + nu^2 (K_2^2 tau + K_3^2 tau^2): "
    "the least gains win.",
    criterion_prefers_standing_still,
)


# -- units of the criterion --------------------------------------------------------------------------------

#: Units as exponents of (metre, second); an angle times the Earth radius counts as metres.
POSITION, SPEED, ACCELERATION, TIME = (1, 0), (1, -1), (1, -2), (0, 1)


def unit(*factors: tuple[tuple[int, int], int]) -> tuple[int, int]:
    """Unit of a product of powers."""
    return (sum(u[0] * p for u, p in factors), sum(u[1] * p for u, p in factors))


def units_of_terms(speed_power: int, acceleration_power: int) -> tuple[tuple[int, int], ...]:
    """Different units of the three terms of J, the last two weighted by these powers of tau."""
    speed, acceleration = (TIME, speed_power), (TIME, acceleration_power)
    return tuple(sorted({unit((POSITION, 2)), unit((SPEED, 2), speed), unit((ACCELERATION, 2), acceleration)}))


def say_units(speed_power: int, acceleration_power: int, relation: str) -> list[dict]:
    """How the factors of two neighbouring terms compare where metres are divided by a and seconds by b."""
    terms = "(a*x)**2/x**2", f"(a/b*v)**2*(b*tau)**{speed_power}/(v**2*tau**{speed_power})"
    terms += (f"(a/b**2*c)**2*(b*tau)**{acceleration_power}/(c**2*tau**{acceleration_power})",)
    symbols = {name: ["0", None, ["open-low"]] for name in ("c", "tau", "v", "x")}
    symbols |= {name: ["1", None, ["open-low"]] for name in "ab"}

    def choose(left: str, right: str) -> dict:
        return state(left, relation, right, {s: symbols[s] for s in symbols if re.search(rf"\b{s}\b", left + right)})

    return [choose(*pair) for pair in pairwise(terms)]


def matrix_is_not_the_covariance():
    # State x' = x without noise, tuned with q > 0: P tends to K R, K the steady gain, while the error, driven by the
    # measurement noise alone, tends to K R/(2 - K): smaller for every 0 < K < 1.
    root = sp.Symbol("K", positive=True)  # steady gain
    matrix, ahead = root * R, root * R / (1 - root)  # P and P^- = P + q, q = K^2 R/(1 - K)
    error = root * R / (2 - root)  # E e^2 = (1 - K)^2 E e^2 + K^2 R
    return Equation(
        [R * root * (1 - root) / (2 - root), sp.Integer(0), root, matrix],
        [matrix - error, error - (1 - root) ** 2 * error - root**2 * R, ahead / (ahead + R), (1 - root) * ahead],
        {root: (0, 1)},
        nonzero=(1 - root,),
    )


CLAIMS_ALGORITHM_3 = claims(
    "algorithm.J.units | The terms of J have three units as printed (m^2, m^2/s, m^2/s^2), and one when weighted "
    "by tau^2 and tau^4.",
    lambda: fact(
        (((2, -2), (2, -1), (2, 0)), ((2, 0),)),
        (units_of_terms(1, 2), units_of_terms(2, 4)),
        "exponents of metre and second",
        PROVED,
        meaning=(*say_units(1, 2, ">"), *say_units(2, 4, "=")),
    ),
    "algorithm.P.not_covariance | Strictly speaking P is no covariance: with a Q of its own choice it differs from "
    "that of the errors; n = 1.",
    matrix_is_not_the_covariance,
)
