"""The pulsating filter for two modes, two states and one measurement: predict, correct, weigh, fold.

Every step runs one Kalman filter for each mode from the common Gaussian, weighs them by the likelihood of the
measurement and the predicted probability of the mode, and folds them into one Gaussian again.
"""

import sympy as sp

from navsym.claims import Equation
from navsym.export.chain import Chain, Link, Program, kept, symmetric, units_of
from navsym.export.parts import Layout

MODES = (1, 2)
A = {i: sp.Matrix(2, 2, sp.symbols(f"a{i}_11 a{i}_12 a{i}_21 a{i}_22", real=True)) for i in MODES}
Q = {i: sp.symbols(f"q{i}_11 q{i}_12 q{i}_22", real=True) for i in MODES}
H = {i: sp.Matrix(1, 2, sp.symbols(f"h{i}_1 h{i}_2", real=True)) for i in MODES}
R = {i: sp.Symbol(f"r{i}", positive=True) for i in MODES}
PI = sp.Matrix(2, 2, sp.symbols("p_11 p_12 p_21 p_22", real=True))
m, P = sp.Matrix(sp.symbols("m1 m2", real=True)), sp.symbols("P11 P12 P22", real=True)
g, z = sp.symbols("g1 g2", real=True), sp.Symbol("z", real=True)


def named(text: str) -> tuple[sp.Symbol, ...]:
    """Real symbols of these names."""
    return sp.symbols(text, real=True)


def triangle(matrix: sp.Matrix) -> tuple[sp.Expr, ...]:
    """Upper triangle (11, 12, 22) of a symmetric matrix (2, 2)."""
    return (matrix[0, 0], matrix[0, 1], matrix[1, 1])


# -- one mode ---------------------------------------


def predicted(i: int) -> Link:
    """Mean and covariance of the mode one step ahead."""
    formulas = (*(A[i] * m), *triangle(A[i] * symmetric(P) * A[i].T + symmetric(Q[i])))
    return Link(names(i, "n1 n2 N11 N12 N22"), "", formulas, lambda: moments(i), cites=("multistructure:8.predict",))


def moments(i: int) -> Equation:
    """The covariance of A e + w, entry by entry from the covariances of e and w."""
    derived = [
        sum(A[i][j, a] * A[i][k, b] * symmetric(P)[a, b] for a in (0, 1) for b in (0, 1)) + symmetric(Q[i])[j, k]
        for j, k in ((0, 0), (0, 1), (1, 1))
    ]
    return Equation(list(triangle(A[i] * symmetric(P) * A[i].T + symmetric(Q[i]))), derived)


def corrected(i: int) -> tuple[Link, ...]:
    """Innovation, its variance, gain; corrected mean and covariance."""
    n, N = sp.Matrix(named(f"n1_{i} n2_{i}")), symmetric(named(f"N11_{i} N12_{i} N22_{i}"))
    v, D, K = sp.Symbol(f"v_{i}", real=True), sp.Symbol(f"D_{i}", real=True), sp.Matrix(named(f"K1_{i} K2_{i}"))
    innovation = (z - (H[i] * n)[0], (H[i] * N * H[i].T)[0] + R[i])
    gain = tuple(N * H[i].T / D)
    after = (*(n + K * v), *triangle(N - K * K.T * D))
    return (
        Link(names(i, "v D"), "", innovation),
        Link(names(i, "K1 K2"), "", gain),
        Link(names(i, "c1 c2 C11 C12 C22"), "", after, lambda: information(i), cites=("multistructure:8.correct",)),
    )


def information(i: int) -> Equation:
    """N - K K^T D inverts the sum of informations: (E + N h h^T/r) times it is N, for D = h^T N h + r."""
    N, h_, r = symmetric(named("n11 n12 n22")), H[i].T, R[i]
    D = (h_.T * N * h_)[0] + r
    K = N * h_ / D
    after = N - K * K.T * D
    return Equation(list(after + N * h_ * (h_.T * after) / r), list(N))


def names(i: int, text: str) -> tuple[str, ...]:
    """The words with the number of the mode behind each."""
    return tuple(f"{word}_{i}" for word in text.split())


# -- weights and fold ---------------------------------------


def weights() -> tuple[Link, ...]:
    """Probabilities of the modes; the larger likelihood is taken out of both, so that neither underflows first."""
    v, D, p = (named(f"{letter}_1 {letter}_2") for letter in ("v", "D", "p"))
    e, l, least = named("e_1 e_2"), named("l_1 l_2"), sp.Symbol("least", real=True)
    shares = tuple(sp.exp(least - e[k]) * p[k] / sp.sqrt(D[k]) for k in (0, 1))
    return (
        Link(
            ("p_1", "p_2"),
            "",
            tuple(PI[0, k] * g[0] + PI[1, k] * g[1] for k in (0, 1)),
            cites=("multistructure:5.prediction",),
        ),
        Link(("e_1", "e_2"), "", tuple(v[k] ** 2 / (2 * D[k]) for k in (0, 1)), cites=("multistructure:18",)),
        Link(("least",), "", (sp.Min(*e),)),
        Link(("l_1", "l_2"), "", shares),
        Link(("w_1", "w_2"), "", tuple(l[k] / (l[0] + l[1]) for k in (0, 1)), bayes, cites=("multistructure:17",)),
    )


def bayes() -> Equation:
    """What is taken out of both likelihoods does not change the probabilities (D = d^2 to spare the root)."""
    e, p, least = named("e_1 e_2"), sp.symbols("p_1 p_2", positive=True), sp.Symbol("least", real=True)
    d = sp.symbols("d_1 d_2", positive=True)
    shifted = [sp.exp(least - e[k]) * p[k] / d[k] for k in (0, 1)]
    density = [sp.exp(-e[k]) / (sp.sqrt(2 * sp.pi) * d[k]) * p[k] for k in (0, 1)]
    return Equation([s / (shifted[0] + shifted[1]) for s in shifted], [f / (density[0] + density[1]) for f in density])


def folded() -> tuple[Link, ...]:
    """Mean of the mixture, then its covariance about it."""
    w = named("w_1 w_2")
    c = [sp.Matrix(named(f"c1_{i} c2_{i}")) for i in MODES]
    C = [symmetric(named(f"C11_{i} C12_{i} C22_{i}")) for i in MODES]
    mean = sp.Matrix(named("mean1 mean2"))
    spread = [C[k] + (c[k] - mean) * (c[k] - mean).T for k in (0, 1)]
    return (
        Link(("mean1", "mean2"), "", tuple(w[0] * c[0] + w[1] * c[1]), cites=("multistructure:12*",)),
        Link(
            ("V11", "V12", "V22"),
            "",
            triangle(w[0] * spread[0] + w[1] * spread[1]),
            second_moment,
            cites=("multistructure:13*",),
        ),
    )


def second_moment() -> Equation:
    """The fold keeps the second moment of the mixture."""
    w1, w2 = sp.symbols("w_1 w_2", positive=True)
    w = (w1 / (w1 + w2), w2 / (w1 + w2))
    c, C = (
        [sp.Matrix(named(f"c1_{i} c2_{i}")) for i in MODES],
        [symmetric(named(f"C11_{i} C12_{i} C22_{i}")) for i in MODES],
    )
    mean = w[0] * c[0] + w[1] * c[1]
    folded_ = sum((w[k] * (C[k] + (c[k] - mean) * (c[k] - mean).T) for k in (0, 1)), sp.zeros(2, 2))
    mixture = sum((w[k] * (C[k] + c[k] * c[k].T) for k in (0, 1)), sp.zeros(2, 2))
    return Equation(list(folded_ + mean * mean.T), list(mixture))


# -- the program ---------------------------------------

ARRAYS: dict[str, tuple[str, ...]] = {
    "mean": ("m1", "m2"),
    "covariance": ("P11", "P12", "P22"),
    "probabilities": ("g1", "g2"),
}
ARRAYS |= {f"A{i}": tuple(s.name for s in A[i]) for i in MODES} | {f"Q{i}": tuple(s.name for s in Q[i]) for i in MODES}
ARRAYS |= {f"H{i}": tuple(s.name for s in H[i]) for i in MODES} | {"transition": tuple(s.name for s in PI)}
ORDER = ("mean", "covariance", "probabilities", "A1", "Q1", "H1", "r1", "A2", "Q2", "H2", "r2", "transition", "z")
TESTS = {"P11": (1.0, 2.0), "P12": (-0.5, 0.5), "P22": (1.0, 2.0), "g1": (0.05, 1.0), "g2": (0.05, 1.0)}
TESTS |= {s.name: (-1.5, 1.5) for i in MODES for s in (*A[i], *H[i])} | {s.name: (0.01, 1.0) for s in PI}
TESTS |= {q.name: ((0.3, 1.0) if k != 1 else (-0.2, 0.2)) for i in MODES for k, q in enumerate(Q[i])}
TESTS |= {f"r{i}": (0.1, 4.0) for i in MODES} | {"m1": (-5.0, 5.0), "m2": (-5.0, 5.0), "z": (-10.0, 10.0)}
UNITS = units_of(
    {
        "units of the state": "mean next_mean",
        "their products": "covariance next_covariance Q1 Q2",
        "1": "probabilities next_probabilities transition",
        "unit of the measurement": "z",
        "(unit of the measurement)^2": "r1 r2",
        "ratios of the state's units": "A1 A2",
        "unit of z per state": "H1 H2",
    }
)
LAYOUT = Layout(ARRAYS, ORDER, TESTS, UNITS)
SHARE = (sp.Integer(0), sp.Integer(1))

FILTER = Program(
    init=kept(
        "The common Gaussian and the probabilities of the modes at step 0",
        ("mean", "covariance", "probabilities"),
        LAYOUT,
        {"g1": SHARE, "g2": SHARE},
    ),
    step=Chain(
        title="One step of the pulsating filter: two modes (rows of the transition matrix: from), two states",
        links=(predicted(1), predicted(2), *corrected(1), *corrected(2), *weights(), *folded()),
        outputs={
            "next_mean": ("mean1", "mean2"),
            "next_covariance": ("V11", "V12", "V22"),
            "next_probabilities": ("w_1", "w_2"),
        },
        layout=LAYOUT,
        box={s.name: (sp.Integer(0), None) for s in R.values()},
    ),
    fields={"mean": "next_mean", "covariance": "next_covariance", "probabilities": "next_probabilities"},
)


PROGRAMS: dict[str, Chain | Program] = {"pulsating-filter": FILTER}
