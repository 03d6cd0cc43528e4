"""The alpha-beta tracker in steady state: gains, covariance, noise, lag, stability, from the Riccati equation.

P. R. Kalata, The tracking index: a generalized parameter for alpha-beta and alpha-beta-gamma target
trackers, IEEE Transactions on Aerospace and Electronic Systems, AES-20 (2), 174-182, 1984. The results
have been restated in many textbooks; the numbers are those of this module, in the order of derivation.

**Route.** The covariance P of the prediction obeys P = F (P - P H'S^-1 H P) F' + G G' sigma_w^2 with
S = p11 + sigma_v^2. In r = sigma_v / sqrt(S) its corner p22 gives beta = Lambda r, alpha = 1 - r^2, and what
is left of it is a quadratic. Everything else is linear algebra in r.
"""

import sympy as sp

from navsym.claims import REFUTED, Equation, Paper, claim

PAPER = Paper(
    module="alpha_beta_filter",
    title="The tracking index: a generalized parameter for alpha-beta and alpha-beta-gamma target trackers",
    authors=("P. R. Kalata",),
    year=1984,
    source="IEEE Transactions on Aerospace and Electronic Systems AES-20 (2), 174-182; numbered here as derived",
    language="English",
    equations=tuple(str(number) for number in range(1, 13)),
    remarks="4.riccati 8.product 12.other-root remark.* index-one",
    definitions={
        "1": "the model: position and velocity, acceleration constant in each period and white between them",
        "2": "the form of the filter: alpha corrects the position, beta / T the velocity",
        "3": "the tracking index Lambda = sigma_w T^2 / sigma_v",
    },
    left_out={"the alpha-beta-gamma tracker": "another model; this module has position and velocity alone"},
)

T = sp.Symbol("T", positive=True)  # period
L = sp.Symbol("Lambda", positive=True)  # tracking index
sv = sp.Symbol("sigma_v", positive=True)  # standard deviation of the measurement
r = sp.Symbol("r", positive=True)  # sigma_v / sqrt(S), between 0 and 1
alpha, beta = sp.symbols("alpha beta", positive=True)
a = sp.Symbol("a", real=True)  # a constant acceleration

F = sp.Matrix([[1, T], [0, 1]])
G = sp.Matrix([T**2 / 2, T])
H = sp.Matrix([[1, 0]])
RATIO = {r: (0, 1)}


# -- the route from the Riccati equation ---------------------------------------


def prediction(index: sp.Expr = L) -> sp.Matrix:
    """Covariance of the prediction with p11 and p12 in r; p22 follows from the middle of the equation.

    p11 = S - sigma_v^2 = sigma_v^2 (1/r^2 - 1) by the definition of r. The corner (2, 2) of the Riccati
    equation is p12^2 = S T^2 sigma_w^2, that is p12 = Lambda sigma_v^2 / (r T). The entry (1, 2) gives p22.
    """
    p11, p12 = sv**2 * (1 / r**2 - 1), index * sv**2 / (r * T)
    sw = index * sv / T**2
    S = sv**2 / r**2
    # p12 = p12 - p11 p12 / S + T (p22 - p12^2 / S) + T^3 sigma_w^2 / 2
    p22 = p11 * p12 / (S * T) + p12**2 / S - T**2 * sw**2 / 2
    return sp.Matrix([[p11, p12], [p12, p22]])


def riccati(P: sp.Matrix, index: sp.Expr) -> sp.Matrix:
    """One step of the covariance: correct by the measurement, then predict."""
    S = (H * P * H.T)[0] + sv**2
    corrected = P - P * H.T * H * P / S
    return F * corrected * F.T + G * G.T * (index * sv / T**2) ** 2


def index_of_ratio(sign: int = -1) -> sp.Expr:
    """Lambda as a function of r: the entry (1, 1) of the Riccati equation, quadratic in Lambda, is what is left.

    sign : -1 for the smaller root; the larger one makes a filter that is not stable
    """
    residual = sp.numer(sp.together((riccati(prediction(), L) - prediction())[0] / sv**2))
    second, first, constant = sp.Poly(residual, L).all_coeffs()
    root = sp.sqrt(sp.factor(first**2 - 4 * second * constant))
    candidates = [sp.cancel((-first + s * root) / (2 * second)) for s in (-1, 1)]
    candidates.sort(key=lambda value: value.subs(r, sp.Rational(1, 2)))
    return candidates[0 if sign < 0 else 1]


def ratio() -> sp.Expr:
    """r between 0 and 1 as a function of Lambda: the smaller root of r Lambda(r) = r Lambda; their product is 1."""
    polynomial = sp.Poly(sp.cancel(r * index_of_ratio()) - r * L, r)
    second, first, _ = polynomial.all_coeffs()
    root = sp.sqrt(sp.expand(polynomial.discriminant()))
    return (-first - root) / (2 * second)


def gains(sign: int = -1) -> tuple[sp.Expr, sp.Expr]:
    """alpha and beta of the Kalman gain P H' / S = (alpha, beta / T), in r."""
    P = prediction(index_of_ratio(sign))
    gain = P * H.T * r**2 / sv**2
    return sp.cancel(gain[0]), sp.cancel(gain[1] * T)


def closed_loop() -> sp.Matrix:
    """Transition of the filtered error, (I - K H) F, for any alpha and beta."""
    K = sp.Matrix([alpha, beta / T])
    return (sp.eye(2) - K * H) * F


def noise_covariance() -> sp.Matrix:
    """C = A C A' + K K' for measurement noise of variance one, by Cramer's rule."""
    A, K = closed_loop(), sp.Matrix([alpha, beta / T])
    c = sp.symbols("c11 c12 c22", real=True)
    C = sp.Matrix([[c[0], c[1]], [c[1], c[2]]])
    residual = A * C * A.T + K * K.T - C
    equations = sp.Matrix([residual[0, 0], residual[0, 1], residual[1, 1]])
    matrix, right = equations.jacobian(c), -equations.subs(dict.fromkeys(c, 0))
    solution = matrix.adjugate() * right / matrix.det()
    return sp.Matrix([[solution[0], solution[1]], [solution[1], solution[2]]])


def lag() -> sp.Matrix:
    """Steady error of position and velocity, truth minus estimate, under a constant acceleration a."""
    K = sp.Matrix([alpha, beta / T])
    forced = (sp.eye(2) - K * H) * G * a
    matrix = sp.eye(2) - closed_loop()
    return matrix.adjugate() * forced / matrix.det()


# -- claims ---------------------------------------


@claim("4.riccati")
def riccati_is_solved():
    """The covariance in r solves all entries of the Riccati equation when Lambda is its function of r."""
    index = index_of_ratio()
    P = prediction(index)
    return Equation(P, riccati(P, index), RATIO)


@claim("4")
def index_from_gains():
    """Lambda^2 = beta^2 / (1 - alpha)."""
    first, second = gains()
    return Equation(second**2 / (1 - first), index_of_ratio() ** 2, RATIO)


@claim("5")
def gain_relation():
    """beta = 2 (2 - alpha) - 4 sqrt(1 - alpha)."""
    first, second = gains()
    return Equation(2 * (2 - first) - 4 * sp.sqrt(1 - first), second, RATIO)


position_gain = claim(
    "6",
    "alpha as a function of the tracking index.",
    lambda: Equation(-(L**2 + 8 * L - (L + 4) * sp.sqrt(L**2 + 8 * L)) / 8, 1 - ratio() ** 2),
)
velocity_gain = claim(
    "7",
    "beta as a function of the tracking index.",
    lambda: Equation((L**2 + 4 * L - L * sp.sqrt(L**2 + 8 * L)) / 4, L * ratio()),
)
ratio_in_closed_form = claim(
    "8",
    "r = (4 + Lambda - sqrt(8 Lambda + Lambda^2)) / 4, with alpha = 1 - r^2.",
    lambda: Equation((4 + L - sp.sqrt(8 * L + L**2)) / 4, ratio()),
)
ratio_is_below_one = claim(
    "8.product",
    "The other root of the quadratic is 1/r, so that one of the two lies below one.",
    lambda: Equation(1 / ((4 + L + sp.sqrt(8 * L + L**2)) / 4), ratio()),
)


@claim("9")
def filtered_covariance():
    """Covariance of the filtered state: alpha, beta/T and beta (2 alpha - beta) / (2 (1 - alpha) T^2), by sigma_v^2."""
    first, second = gains()
    corner = second * (2 * first - second) / (2 * (1 - first) * T**2)
    printed = sv**2 * sp.Matrix([[first, second / T], [second / T, corner]])
    P = prediction(index_of_ratio())
    return Equation(printed, P - P * H.T * H * P * r**2 / sv**2, RATIO)


noise_of_position = claim(
    "10.position",
    "Noise of variance one gives the position (2 alpha^2 + 2 beta - 3 alpha beta) / (alpha (4 - 2 alpha - beta)).",
    lambda: Equation(
        (2 * alpha**2 + 2 * beta - 3 * alpha * beta) / (alpha * (4 - 2 * alpha - beta)), noise_covariance()[0, 0]
    ),
)
noise_of_velocity = claim(
    "10.velocity",
    "Noise of variance one gives the filtered velocity 2 beta^2 / (T^2 alpha (4 - 2 alpha - beta)).",
    lambda: Equation(2 * beta**2 / (T**2 * alpha * (4 - 2 * alpha - beta)), noise_covariance()[1, 1]),
)
lag_of_position = claim(
    "11.position",
    "Under a constant acceleration the filtered position lags by (1 - alpha) a T^2 / beta.",
    lambda: Equation((1 - alpha) * a * T**2 / beta, lag()[0]),
)
lag_of_velocity = claim(
    "11.velocity",
    "Under a constant acceleration the filtered velocity lags by (2 alpha - beta) a T / (2 beta).",
    lambda: Equation((2 * alpha - beta) * a * T / (2 * beta), lag()[1]),
)


@claim("12.characteristic")
def characteristic_polynomial():
    """The filter has the characteristic polynomial z^2 - (2 - alpha - beta) z + 1 - alpha."""
    z = sp.Symbol("z", real=True)
    return Equation(z**2 - (2 - alpha - beta) * z + 1 - alpha, (z * sp.eye(2) - closed_loop()).det())


@claim("12.stable")
def steady_filter_is_stable():
    """Of the three conditions of stability only 4 - 2 alpha - beta > 0 needs the gains: it is 4 r."""
    first, second = gains()
    return Equation(4 * r, 4 - 2 * first - second, RATIO)


@claim("12.other-root")
def other_root_is_not_stable():
    """With the larger root of the Riccati equation the same condition is -4 r: not stable."""
    first, second = gains(sign=1)
    return Equation(-4 * r, 4 - 2 * first - second, RATIO)


def discriminant_of_the_filter(first: sp.Expr, second: sp.Expr) -> sp.Expr:
    """Discriminant of the characteristic polynomial at the gains alpha and beta, in r."""
    z = sp.Symbol("z", real=True)
    loop = closed_loop().subs({alpha: first, beta: second}, simultaneous=True)
    return sp.Poly((z * sp.eye(2) - loop).det(), z).discriminant()


@claim(
    "remark.critical",
    expect=REFUTED,
    reason="the optimal gains give complex roots unless r <= 3 - 2 sqrt(2); critically damped is half of their beta",
)
def optimal_gains_are_called_critical():
    """The optimal relation (5) makes the filter critically damped: the discriminant of (12) is zero."""
    return Equation(sp.Integer(0), discriminant_of_the_filter(*gains()), RATIO)


@claim("remark.critical*")
def discriminant_of_optimal_gains():
    """The discriminant is -(1 - r)^2 (6 r - 1 - r^2): negative, hence oscillating, for r > 3 - 2 sqrt(2)."""
    return Equation(-((1 - r) ** 2) * (6 * r - 1 - r**2), discriminant_of_the_filter(*gains()), RATIO)


@claim("remark.critical-relation")
def critical_relation():
    """Critically damped is beta = 2 - alpha - 2 sqrt(1 - alpha), half of the optimal beta."""
    first, second = gains()
    critical = 2 - first - 2 * sp.sqrt(1 - first)
    return Equation([0, 2 * critical], [discriminant_of_the_filter(first, critical), second], RATIO)


@claim("index-one")
def gains_at_index_one():
    """At Lambda = 1 the gains are alpha = 3/4 and beta = 1/2."""
    root = ratio().subs(L, 1)
    return Equation((sp.Rational(3, 4), sp.Rational(1, 2)), (1 - root**2, root))
