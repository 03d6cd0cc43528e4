"""INS error model in dimensionless form, and the two groups of well observable variables.

Time tau = omega_0 t; rates in units of omega_0, the rates of the frame and of the Earth in units of
mu omega_0. The groups follow by machine from the full equations: the velocity information is
split into its Schuler part and its constant part, the position information is differentiated,
and terms of order mu^2 rho are dropped, each of them on record.

Kalenova, Morozov, Parusnikov, Shakot'ko 1979, (2.6)-(2.9).
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from navsym.claims import state
from navsym.language.expression import to_text
from navsym.models.linear import LinearModel
from navsym_papers.joint_correction import kinematics as physical
from navsym_papers.joint_correction.kinematics import ALPHA, BETA, EPSILON, ErrorEquations, error_equations

# Bookkeeping of a small parameter: what is kept, what is dropped, and of which order it is.
#
# Every symbol has a declared order, the power of mu relative to the common size rho of the error
# variables; mu itself counts one. The order of a monomial is the sum over its factors.


@dataclass(frozen=True, slots=True)
class Dropped:
    """A term that was neglected: of order ``rho * mu**order``."""

    term: sp.Expr
    order: int


@dataclass(frozen=True, slots=True)
class Truncated:
    """An expression without its terms of high order, and those terms one by one."""

    kept: sp.Expr
    dropped: tuple[Dropped, ...]


def monomial_order(term: sp.Expr, orders: Mapping[sp.Symbol, int]) -> int:
    """Power of mu of one monomial; symbols that are not declared count zero."""
    total = 0
    for base, exponent in term.as_powers_dict().items():
        if base in orders:
            total += orders[base] * int(exponent)
    return total


def truncate(expression: sp.Expr, orders: Mapping[sp.Symbol, int], limit: int) -> Truncated:
    """Keep the monomials of order below ``limit``."""
    terms = sp.Add.make_args(sp.expand(expression))
    dropped = [Dropped(t, monomial_order(t, orders)) for t in terms if t != 0 and monomial_order(t, orders) >= limit]
    kept = sp.Add(*(t for t in terms if monomial_order(t, orders) < limit))
    return Truncated(kept, tuple(dropped))


def pick_order(expression: sp.Expr, orders: Mapping[sp.Symbol, int], order: int) -> sp.Expr:
    """The monomials of one order."""
    return sp.Add(*(t for t in sp.Add.make_args(sp.expand(expression)) if monomial_order(t, orders) == order))


def lowest_order(expression: sp.Expr, orders: Mapping[sp.Symbol, int]) -> int | None:
    """The smallest order of a monomial; None for zero."""
    terms = [t for t in sp.Add.make_args(sp.expand(expression)) if t != 0]
    return min((monomial_order(t, orders) for t in terms), default=None)


def say_orders(terms: Sequence[tuple[sp.Expr, int]], orders: Mapping[sp.Symbol, int], least: int = 0) -> dict[str, Any]:
    """That every monomial is mu to its order times what has none, where each symbol is mu to its own order."""
    powers = {symbol.name: order for symbol, order in orders.items() if symbol != MU}

    def declare(name: re.Match[str]) -> str:
        return f"({name[0]}*mu**({powers[name[0]]}))" if name[0] in powers else name[0]

    texts = [to_text(term) for term, _ in terms]
    left = [re.sub(r"\b[A-Za-z]\w*", declare, text) for text in texts]
    right = [f"mu**{order - least}*({to_text(term.subs(MU, 1))})" for term, order in terms]
    symbols = {
        name: ["0", None, ["open-low"]] for name in sorted({s.name for term, _ in terms for s in term.free_symbols})
    }
    sides = f"[{', '.join(left)}]", f"mu**{least}*[{', '.join(right)}]"
    return state(sides[0], "=", sides[1], symbols | {"mu": ["0", "1", ["open-low", "open-high"]]})


MU = sp.Symbol("mu", positive=True)
PI = sp.Matrix(sp.symbols("pi_1 pi_2", real=True))
NU = sp.Matrix(sp.symbols("nu_1:4", real=True))
OMEGA = sp.Matrix([*sp.symbols("omega_1 omega_2", real=True), 0])
OMEGA_RATE = sp.Matrix([*sp.symbols("domega_1 domega_2", real=True), 0])
EARTH = sp.Matrix(sp.symbols("u_1:4", real=True))
W_C0 = sp.Matrix(sp.symbols("w_c1 w_c2", real=True))
W_M0 = physical.W_M
X = sp.Matrix(sp.symbols("x_1:7", real=True))
Y = sp.Matrix(sp.symbols("y_1:9", real=True))

#: Declared orders: alpha, pi, epsilon, nu, w are of order rho; beta and gamma of order rho/mu;
#: the derivatives of omega with respect to tau are of order mu on "stationary" trajectories.
ORDERS: Mapping[sp.Symbol, int] = {
    MU: 1,
    **dict.fromkeys(BETA, -1),
    **dict.fromkeys(OMEGA_RATE[:2], 1),
    Y[0]: -1,
    Y[4]: -1,
}

#: The same for the physical equations, where mu hides in the rates.
PHYSICAL_ORDERS: Mapping[sp.Symbol, int] = {
    **dict.fromkeys(physical.OMEGA_X[:2], 1),
    **dict.fromkeys(physical.EARTH_X, 1),
    **dict.fromkeys(physical.OMEGA_X_RATE[:2], 2),
    **dict.fromkeys(BETA, -1),
    ALPHA[2]: -1,
    physical.CLIMB: 2,
}


def dimensionless(climb: sp.Expr = sp.S.Zero) -> ErrorEquations:
    """The error equations in tau, pi, nu, omega, u, with every term."""
    equations = error_equations(climb)
    w0 = physical.SCHULER
    to = {
        **dict(zip(physical.DELTA_P, w0 * PI, strict=True)),
        **dict(zip(physical.NU_X, w0 * NU, strict=True)),
        **dict(zip(physical.OMEGA_X[:2], MU * w0 * OMEGA[:2, :], strict=True)),
        **dict(zip(physical.OMEGA_X_RATE[:2], MU * w0**2 * OMEGA_RATE[:2, :], strict=True)),
        **dict(zip(physical.EARTH_X, MU * w0 * EARTH, strict=True)),
        **dict(zip(physical.W_C, w0 * W_C0, strict=True)),
    }
    scale = {**dict.fromkeys(physical.DELTA_P, w0), **dict.fromkeys(physical.EARTH_X, MU * w0)}
    name = {**dict(zip(physical.DELTA_P, PI, strict=True)), **dict(zip(physical.EARTH_X, EARTH, strict=True))}
    rates = {
        name.get(s, s): sp.expand(rate.subs(to, simultaneous=True) / (w0 * scale.get(s, 1)))
        for s, rate in equations.rates.items()
    }
    rates |= dict(zip(OMEGA[:2], OMEGA_RATE[:2], strict=True))
    velocity = [sp.expand(s.subs(to, simultaneous=True) / w0) for s in equations.velocity]
    return ErrorEquations(rates, (velocity[0], velocity[1]), equations.position)


def derivative(expression: sp.Expr, rates: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
    """d/dtau of an expression; symbols without a rate are constant on the interval of correction."""
    return sp.expand(sum((sp.diff(expression, s) * rate for s, rate in rates.items()), sp.Integer(0)))


def leading_rates(equations: ErrorEquations) -> dict[sp.Symbol, sp.Expr]:
    """The motion at mu = 0: Schuler oscillations, while beta, omega and u stand still."""
    moving = [*ALPHA[:2], *PI]
    return {s: pick_order(equations.rates[s], ORDERS, 0) for s in moving}


def velocity_variables(equations: ErrorEquations) -> tuple[sp.Expr, ...]:
    """x_1 ... x_6: Schuler part, its companion, and constant part of sigma_1^c and sigma_2^c.

    With D the derivative at mu = 0, -D^2 is the projection on the Schuler mode: x_2 is the leading
    order of -D^2 sigma, x_1 = -D x_2, and x_3 = (1 + D^2) sigma does not oscillate.
    """
    rates = leading_rates(equations)
    found: list[sp.Expr] = []
    for sigma in equations.velocity:
        second = derivative(derivative(sigma, rates), rates)
        momentum = pick_order(-second, ORDERS, 0)
        found += [-derivative(momentum, rates), momentum, sp.expand(sigma + second)]
    return tuple(found)


def position_variables(equations: ErrorEquations) -> tuple[sp.Expr, ...]:
    """y_1 ... y_8: sigma^M, its derivative, the leading force that drives it, and its derivative."""
    rates = leading_rates(equations)
    found: list[sp.Expr] = []
    for sigma in equations.position:
        speed = derivative(sigma, equations.rates)
        force = pick_order(-derivative(speed, equations.rates), ORDERS, 0)
        found += [sigma, speed, force, derivative(force, rates)]
    return tuple(found)


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Variables with their equations, truncated at order mu^2 rho.

    variables : symbols, and ``meaning`` what they are in the error variables
    rates     : right-hand sides in the symbols of the group
    outputs   : the measurements in them, without noise
    dropped   : terms left out of every right-hand side, and ``dropped_outputs`` of every output
    """

    variables: tuple[sp.Symbol, ...]
    meaning: tuple[sp.Expr, ...]
    rates: tuple[sp.Expr, ...]
    outputs: tuple[sp.Expr, ...]
    dropped: tuple[tuple[Dropped, ...], ...]
    dropped_outputs: tuple[tuple[Dropped, ...], ...]

    def linear(self) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix, tuple[sp.Expr, ...]]:
        """(F, H, forcing): homogeneous part, output matrix, and the terms that are not in the group."""
        F = sp.Matrix([[sp.diff(rate, v) for v in self.variables] for rate in self.rates])
        H = sp.Matrix([[sp.diff(output, v) for v in self.variables] for output in self.outputs])
        rest = sp.Matrix(self.rates) - F * sp.Matrix(self.variables)
        return sp.ImmutableMatrix(F), sp.ImmutableMatrix(H), tuple(sp.expand(r) for r in rest)

    def model(self, names: Sequence[str]) -> LinearModel:
        """The homogeneous part as a model."""
        F, H, _ = self.linear()
        return LinearModel(F, None, H, tuple(map(str, self.variables)), measurements=tuple(names))


#: Order from which terms are neglected.
LIMIT = 2


def velocity_group(equations: ErrorEquations | None = None) -> Group:
    """Error equations of the velocity group, (2.6) and (2.8) of the joint-correction paper, by elimination.

    Raises ArithmeticError when the given equations do not lead to six variables (a defect of the model).
    """
    equations = equations or dimensionless()
    meaning = velocity_variables(equations)
    solve = solve_for(X, meaning, [ALPHA[0], PI[0], W_C0[0], ALPHA[1], PI[1], W_C0[1]])
    return form_group(X, meaning, solve, equations, equations.velocity)


def position_group(equations: ErrorEquations | None = None) -> Group:
    """Error equations of the position group, (2.7) and (2.9), by elimination; beta_1, beta_2 by y_1, y_5.

    Raises ArithmeticError when the given equations do not lead to the four variables (a defect of the model).
    """
    equations = equations or dimensionless()
    meaning = position_variables(equations)
    eliminated = {1: BETA[0], 3: ALPHA[0], 4: PI[0], 5: BETA[1], 7: ALPHA[1], 8: PI[1]}
    solve = solve_for([Y[k - 1] for k in eliminated], [meaning[k - 1] for k in eliminated], list(eliminated.values()))
    group = form_group(Y, meaning, solve, equations, equations.position)
    speeds = {0: Y[1], 4: Y[5]}  # y_2 and y_6 are the derivatives themselves
    rates = tuple(speeds.get(k, rate) for k, rate in enumerate(group.rates))
    return Group(group.variables, meaning, rates, group.outputs, group.dropped, group.dropped_outputs)


def solve_for(
    symbols: Sequence[sp.Symbol], meaning: Sequence[sp.Expr], unknowns: Sequence[sp.Symbol]
) -> dict[sp.Symbol, sp.Expr]:
    """Error variables in the symbols of a group; the system is triangular, each step is linear."""
    pending = list(zip(symbols, meaning, unknowns, strict=True))
    values: dict[sp.Symbol, sp.Expr] = {}
    while pending:
        before = len(pending)
        for item in list(pending):
            symbol, expression, unknown = item
            rest = sp.expand(expression.subs(values))
            factor = sp.diff(rest, unknown)
            others = rest.free_symbols & {u for _, _, u in pending} - {unknown}
            if factor in (1, -1) and not others:
                values[unknown] = sp.expand((symbol - (rest - factor * unknown)) / factor)
                pending.remove(item)
        if len(pending) == before:
            raise ArithmeticError(f"cannot express {[u for _, _, u in pending]} by the variables")
    return values


def form_group(
    variables: Sequence[sp.Symbol],
    meaning: Sequence[sp.Expr],
    solve: Mapping[sp.Symbol, sp.Expr],
    equations: ErrorEquations,
    outputs: Sequence[sp.Expr],
) -> Group:
    """Differentiate, express in the variables, truncate."""

    def written(expression: sp.Expr) -> sp.Expr:
        return sp.expand(expression.subs(solve, simultaneous=True))

    # Ranks above mu rho stay out here, one by one, and nowhere else.
    parts = [truncate(written(derivative(value, equations.rates)), ORDERS, LIMIT) for value in meaning]
    shown = [truncate(written(output), ORDERS, LIMIT) for output in outputs]
    return Group(
        tuple(variables),
        tuple(meaning),
        tuple(part.kept for part in parts),
        tuple(part.kept for part in shown),
        tuple(part.dropped for part in parts),
        tuple(part.dropped for part in shown),
    )


# Models for observability, estimators and simulation

#: Variables of the joint problem (3.2), (3.3): y_3, y_4, y_7, y_8 are x_1, x_2, x_4, x_5.
JOINT = (*X, Y[0], Y[1], Y[4], Y[5])


def joint_model() -> LinearModel:
    """Homogeneous parts of (2.8) and (2.9) together: ten variables, four measurements, dimensionless.

    Raises ArithmeticError as :func:`velocity_group`.
    """
    same = {Y[2]: X[0], Y[6]: X[3]}  # joint_correction:3.1; no rate of y_1, y_2, y_5, y_6 has y_4 or y_8
    velocity, position = velocity_group(), position_group()
    rates = [*velocity.rates, *(position.rates[k].subs(same) for k in (0, 1, 4, 5))]
    outputs = [*velocity.outputs, *position.outputs]
    F = sp.Matrix([[sp.diff(rate, v) for v in JOINT] for rate in rates])
    H = sp.Matrix([[sp.diff(output, v) for v in JOINT] for output in outputs])
    names = ("sigma_c1", "sigma_c2", "sigma_M1", "sigma_M2")
    return LinearModel(F, None, H, tuple(map(str, JOINT)), measurements=names)


#: States of the full model: seven errors and nine constants.
FULL = (*ALPHA[:2], *PI, *BETA, *NU, *EPSILON, *W_C0, *W_M0)


def full_model(order: int | None = None) -> LinearModel:
    """(2.1)-(2.5) with constant instrument errors as states, dimensionless: 16 states, 4 measurements.

    order : terms of the coefficients from this power of mu on are left out; None keeps all
    """
    equations = dimensionless()
    rates = [equations.rates.get(s, sp.Integer(0)) for s in FULL]
    outputs = [*equations.velocity, *equations.position]
    F, H = (state_coefficients(part, order) for part in (rates, outputs))
    names = ("sigma_c1", "sigma_c2", "sigma_M1", "sigma_M2")
    return LinearModel(F, None, H, tuple(map(str, FULL)), measurements=names)


def state_coefficients(expressions: Sequence[sp.Expr], order: int | None) -> sp.Matrix:
    """Coefficients of the full state; powers of mu from ``order`` on are left out."""

    def entry(expression: sp.Expr, state: sp.Symbol) -> sp.Expr:
        value = sp.expand(sp.diff(expression, state))
        return value if order is None else truncate(value, {MU: 1}, order).kept

    return sp.Matrix([[entry(expression, state) for state in FULL] for expression in expressions])
