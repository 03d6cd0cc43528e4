"""Equations 1 to 4: polynomial motion, nilpotent dynamics, transition over a step, measurement."""

from fractions import Fraction
from itertools import pairwise

import sympy as sp

from navsym.claims import CERTIFIED, PROVED, Bound, Equation, Finding, Property, claim, claims, fact, state
from navsym.models import earth as motion
from navsym.trajectory.conditioning import condition_number
from navsym_papers.trajectory import model
from navsym_papers.trajectory.scaling import write_rows
from navsym_papers.trajectory.table import refute_order, say_comparison, say_ends

rho, tau, t = sp.symbols("rho tau t", positive=True)

#: A leading block of each matrix is the matrix of the smaller order, so one order stands for all below it.
ORDER = 8
ORDERS = range(2, 13)
STATE = sp.symbols(f"x1:{ORDER + 1}", real=True)


def speed_polynomial(n: int) -> tuple[sp.Expr, tuple[sp.Symbol, ...]]:
    """V(t) of degree n - 2 with free coefficients: Taylor coefficients are the states x_2 ... x_n at zero."""
    start = STATE[:n]
    return sum(start[j] * t ** (j - 1) / sp.factorial(j - 1) for j in range(1, n)), start


def moved_state(n: int, time: sp.Expr) -> list[sp.Expr]:
    """x(time) by direct integration and differentiation of the speed: no matrix enters."""
    speed, start = speed_polynomial(n)
    terms = sp.Poly(speed, t).all_coeffs()[::-1]
    distance = sum(c * t ** (k + 1) / (k + 1) for k, c in enumerate(terms))
    states = [start[0] + rho * distance, *(sp.diff(speed, t, k) for k in range(n - 1))]
    return [sp.expand(x).subs(t, time) for x in states]


def rate_of_state(n: int) -> list[sp.Expr]:
    return [sp.diff(x, t) for x in moved_state(n, t)]


# -- equation 1 --------------------------------------------------------------------------------------


@claim("1.degree | The speed is a polynomial of degree n - 2 (n = 2 to 8).")
def degree_of_the_speed():

    def speed(n: int) -> sp.Expr:
        return (model.nilpotent_exponential(model.dynamics(n, rho), t) * sp.Matrix(STATE[:n]))[1]

    def say_degree(n: int) -> tuple[dict, dict]:
        text, highest = str(speed(n)), {f"x{n}": [None, None, ["nonzero"]]}
        symbols = {name.name: [None, None, []] for name in speed(n).free_symbols} | {"t": [None, None, []]}
        top = text if n == 2 else f"diff({text}, t, {n - 2})"
        return state(top, "!=", "0", symbols | highest), state(f"diff({text}, t, {n - 1})", "=", "0", symbols)

    orders = range(2, ORDER + 1)
    degrees = tuple(int(sp.Poly(speed(n), t).degree()) for n in orders)
    found = Finding(degrees, "degree of the exact solution", PROVED, scope=f"n = 2..{ORDER}")
    meaning = tuple(text for n in orders for text in say_degree(n))
    return Property(printed=tuple(n - 2 for n in orders), derived=found, meaning=meaning)


CLAIMS_1 = claims(
    "1.row1 | Rate of the coordinate: rho times the speed; n = 8.",
    lambda: Equation(rho * moved_state(ORDER, t)[1], rate_of_state(ORDER)[0]),
    "1.row2 | Second row, dx_1/dt = x_2, as printed. | undecidable: both indices are those of the row above: "
    "dx_1/dt has its equation there; by hand: a latitude in radians does not change at metres per second",
    lambda: Equation(moved_state(ORDER, t)[1], rate_of_state(ORDER)[0]),
    "1.row2* | Second row: dx_2/dt = x_3; n = 8.",
    lambda: Equation(moved_state(ORDER, t)[2], rate_of_state(ORDER)[1]),
    "1.rown | Last row, dx_1/dt = 0, as printed. | undecidable: the index is that of the first row: the last row "
    "is that of x_n, whose initial value stands beside it; by hand: a coordinate at rest whatever the speed",
    lambda: Equation(sp.Integer(0), rate_of_state(ORDER)[0]),
    "1.rown* | Last row: dx_n/dt = 0; n = 8.",
    lambda: Equation(sp.Integer(0), rate_of_state(ORDER)[-1]),
    "1.general | The general form dx/dt = A x with A of equation 3; n = 8.",
    lambda: Equation(list(model.dynamics(ORDER, rho) * sp.Matrix(moved_state(ORDER, t))), rate_of_state(ORDER)),
)


# -- equations 2 and 3 -------------------------------------------------------------------------------


def measured_row(n: int) -> sp.Matrix:
    """Row of the measured coordinate: its gradient in the state."""
    return sp.Matrix([moved_state(n, sp.Integer(0))[0]]).jacobian(STATE[:n])


def powers_of(n: int) -> list[sp.Matrix]:
    """A, A^2, ... up to the first that is 0, by exact powers; rho is a free symbol."""
    powers = [model.dynamics(n, rho)]
    while powers[-1] != sp.zeros(n, n):
        powers.append(powers[-1] * powers[0])
    return powers


#: rho != 0, as both claims below assume.
RHO = {"rho": [None, None, ["nonzero"]]}


def say_powers(n: int) -> tuple[dict, ...]:
    """That each power times A is the next, that the last is 0, and that an entry of the one before is not."""
    powers = powers_of(n)
    texts = [write_rows(power.tolist()) for power in powers]
    products = (state(f"{texts[0]} @ {x}", "=", y, RHO) for x, y in pairwise(texts))
    return *products, state(str(powers[-2][0, n - 1]), "!=", "0", RHO)


CLAIMS_2 = claims(
    "2.H | Row of the measurement, printed with three entries for every n; here n = 8. | undecidable: H has as "
    "many entries as the state: (1, 0, 0) is the case n = 3 only, and after equation 4 it is printed as (1, 0, "
    "..., 0)",
    lambda: Equation(sp.Matrix([[1, 0, 0]]), measured_row(ORDER)),
    "2.H* | Row of the measurement: one and n - 1 zeros; here n = 8.",
    lambda: Equation(sp.Matrix([[1] + [0] * (ORDER - 1)]), measured_row(ORDER)),
    "3.nilpotent | A is nilpotent of index n (n = 2 to 12).",
    lambda: fact(
        tuple(n for n in ORDERS),
        tuple(len(powers_of(n)) for n in ORDERS),
        "exact powers",
        PROVED,
        scope="n = 2..12; for every n the power k moves the diagonal k places up",
        assumptions=("rho != 0",),
        meaning=tuple(text for n in ORDERS for text in say_powers(n)),
    ),
)


@claim("3.nonzero | A has n - 1 elements that are not zero (n = 2 to 12).")
def nonzero_elements():

    def say(n: int) -> list[dict]:
        rows = model.dynamics(n, rho).tolist()
        zeros = [[x for x in row if x == 0] for row in rows]
        found = (str(x) for row in rows for x in row if x != 0)
        parts = [state(text, "!=", "0", RHO if text == "rho" else None) for text in found]
        return parts + [state(write_rows(row), "=", write_rows([0] * len(row))) for row in zeros]

    return fact(
        tuple(n - 1 for n in ORDERS),
        tuple(sum(x != 0 for x in model.dynamics(n, rho)) for n in ORDERS),
        "count",
        PROVED,
        scope="n = 2..12",
        assumptions=("rho != 0",),
        meaning=tuple(text for n in ORDERS for text in say(n)),
    )


@claim("3.elements | A_12 = rho, A_i,i+1 = 1 below, all others zero; here n = 8.")
def elements_of_A():
    rate = sp.Matrix(rate_of_state(ORDER)).subs(t, 0)
    printed = sp.zeros(ORDER, ORDER)
    printed[0, 1] = rho
    for i in range(1, ORDER - 1):
        printed[i, i + 1] = 1
    return Equation(printed, rate.jacobian(STATE))


# -- equation 4 --------------------------------------------------------------------------------------


def printed_transition(n: int) -> sp.Matrix:
    def entry(i: int, j: int) -> sp.Expr:
        if j < i:
            return sp.Integer(0)
        power = tau ** (j - i) / sp.factorial(j - i)
        return rho * power if i == 0 and j > 0 else power

    return sp.Matrix(n, n, entry)


CLAIMS_4 = claims(
    "4.Phi | Transition matrix over a step; n = 8, smaller orders are its leading blocks.",
    lambda: Equation(printed_transition(ORDER), sp.Matrix(moved_state(ORDER, tau)).jacobian(STATE)),
    "4.Phi.series | The transition matrix is the series of exp(A tau), which ends because A is nilpotent; n = 8.",
    lambda: Equation(printed_transition(ORDER), model.nilpotent_exponential(model.dynamics(ORDER, rho), tau)),
)


@claim("4.smaller_step | For rho = 1/r with r growing steadily the error of a step grows with its length.")
def better_for_smaller_steps():
    r, climb, speed = sp.symbols("r V3 V2", positive=True)
    # d/dtau of the integral of (rho(s) - rho(0)) V2 ds: of one sign, so the error only grows.
    growth = sp.factor((1 / (r + climb * tau) - 1 / r) * speed)
    return Bound(growth, "<", sp.Integer(0))


@claim(
    "4.z | The measurement z_(k+1) = H_p x_(k+1), as printed; n = 5. | paper: H_p = H Phi acts on the state before "
    "the step: the index of x is k, as in equations 5 and 6; by hand: n = 2, rho tau = 1, x_k = (0, 1): the "
    "coordinate after the step is 1, the print gives 2"
)
def stepped_measurement_printed():
    after = sp.Matrix(moved_state(5, tau))
    return Equation((measured_row(5) * printed_transition(5) * after)[0], after[0])


@claim("4.z* | The measurement after a step by the state before it: z_(k+1) = H_p x_k; n = 5.")
def stepped_measurement():
    before, after = sp.Matrix(STATE[:5]), sp.Matrix(moved_state(5, tau))
    return Equation((measured_row(5) * printed_transition(5) * before)[0], after[0])


CLAIMS_4_2 = claims(
    "4.H | H = (1, 0, ..., 0); n = 8.",
    lambda: Equation(sp.Matrix([[1] + [0] * (ORDER - 1)]), measured_row(ORDER)),
    "4.Hp | H_p = H Phi = (1, rho tau, ..., rho tau^(n-1)/(n-1)!); n = 8.",
    lambda: Equation(
        sp.Matrix([[sp.Integer(1)] + [rho * tau**j / sp.factorial(j) for j in range(1, ORDER)]]),
        sp.Matrix([moved_state(ORDER, tau)[0]]).jacobian(STATE),
    ),
)


# -- smaller steps and conditioning ------------------------------------------------------------------


def conditioning(n: int, step: sp.Rational):
    """Certified enclosure of mu(N_p) at the rho of the table."""
    return condition_number(rows_of_table(n, step), digits=12)


def rows_of_table(n: int, step: sp.Rational) -> list[list[Fraction]]:
    """N_p at the rho of the table."""
    return motion.observability_rows(n, Fraction(1, 6371000), Fraction(int(step.p), int(step.q)))


def improves(n: int, longer: sp.Rational, shorter: sp.Rational) -> bool:
    """True when the longer step is certified to have the smaller condition number."""
    return conditioning(n, longer).upper < conditioning(n, shorter).lower


@claim(
    "4.hadamard | A smaller step inevitably worsens the condition number (n = 20, 1 s against 0.94 s). | paper: not "
    "inevitably: at n = 20 the smaller step 0.94 s is better than 1 s (6.05e16 against 8.09e16)"
)
def smaller_steps_always_worsen():
    longer, shorter = sp.Integer(1), sp.Rational("0.94")
    method = "certified condition numbers"
    scope = "n = 20, rho = 1/6371000, tau = 1 and 0.94"
    evidence = f"{conditioning(20, longer).rounded(5)} at 1 s, {conditioning(20, shorter).rounded(5)} at 0.94 s"
    meaning, certificate = refute_order((rows_of_table(20, shorter), False), (rows_of_table(20, longer), False))
    holds = improves(20, longer, shorter)
    return fact(
        True, holds, method, CERTIFIED, scope=scope, evidence=evidence, certificate=certificate, meaning=meaning
    )


@claim("4.hadamard*", expect=CERTIFIED)
def smaller_steps_worsen_below_a_second():
    """Each halving of the step from 1 s down to 1/32 s worsens the condition number, n of the table."""
    steps = [sp.Rational(1, 2**k) for k in range(6)]
    holds = all(improves(n, longer, shorter) for n in (2, 3, 4, 5, 10, 19, 20) for longer, shorter in pairwise(steps))
    scope = "rho = 1/6371000, tau = 1, 1/2, ..., 1/32, n of the table"
    enclosed, relations = [], []
    for n in (2, 3, 4, 5, 10, 19, 20):
        ends = [say_ends(rows_of_table(n, step), conditioning(n, step), False) for step in steps]
        enclosed += [end[0] for end in ends]
        relations += [(shorter[1], ">", longer[2]) for longer, shorter in pairwise(ends)]
    meaning, certificate = say_comparison(enclosed, relations)
    return fact(
        True, holds, "certified condition numbers", CERTIFIED, scope=scope, certificate=certificate, meaning=meaning
    )
