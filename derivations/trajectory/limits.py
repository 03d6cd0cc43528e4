"""What the paper does not ask: how well any algorithm whatever can know speed and acceleration from positions.

Positions are measured within +-sigma for as long as one likes; of the motion only abs(x'') <= M, or abs(x''') <= M,
is known. Two or three positions, no older than a window in closed form, give the derivative now with an error
that no algorithm can undercut: a motion exists that never leaves +-sigma, so that it may be measured as rest for
ever, and has this derivative now. Older positions, and more of them, guarantee nothing.

The window is T with M T^m = 2^(2m-1) m! sigma: on it the Chebyshev polynomial of order m has the bound M as its
m-th derivative. Ages s = -t are counted from now. The constants are those of Landau (order 2) and Matorin (order 3)
for functions on a half line; Peano's kernel turns a rule into its remainder.
"""

import math
from dataclasses import dataclass

import sympy as sp

from navsym.claims import Bound, Equation, claim, claims

sigma, M, T, s, u = sp.symbols("sigma M T s u", positive=True)
y = sp.Symbol("y", real=True)


@dataclass(frozen=True, slots=True)
class Question:
    """Which derivative is asked for, and which one is bounded by M."""

    name: str
    words: str
    derivative: int
    order: int

    @property
    def best(self) -> sp.Expr:
        """The least error that can be guaranteed, in sigma and M."""
        constants = {(1, 2): 2, (1, 3): sp.cbrt(sp.Rational(243, 8)), (2, 3): sp.cbrt(24)}
        share = sp.Rational(self.derivative, self.order)
        return constants[self.derivative, self.order] * sigma ** (1 - share) * M**share


QUESTIONS = (
    Question("velocity.acceleration", "velocity under a bounded acceleration", 1, 2),
    Question("velocity.jerk", "velocity under a bounded jerk", 1, 3),
    Question("acceleration.jerk", "acceleration under a bounded jerk", 2, 3),
)


def bound(order: int) -> sp.Expr:
    """M for which T is the window: the m-th derivative of sigma T_m(1 - 2 s / T)."""
    return sp.Integer(2 ** (2 * order - 1) * math.factorial(order)) * sigma / T**order


def ages(order: int) -> tuple[sp.Expr, ...]:
    """Ages of the positions in use: now, and the extremes of T_m but its last one."""
    return {2: (sp.Integer(0), T / 2), 3: (sp.Integer(0), T / 4, 3 * T / 4)}[order]


# -- the rule: what is guaranteed ----------------------------------------------------------------------


def weights(question: Question) -> list[sp.Expr]:
    """Weights of the positions: the derivative, now, of the polynomial through them."""
    nodes = [-age for age in ages(question.order)]
    time = sp.Symbol("t")
    found = []
    for own in nodes:
        others = [node for node in nodes if node != own]
        cardinal = sp.prod([(time - node) / (own - node) for node in others])
        found.append(sp.diff(sp.expand(cardinal), time, question.derivative).subs(time, 0))
    return found


def kernel(question: Question) -> list[tuple[sp.Expr, sp.Expr, sp.Expr]]:
    """Peano's kernel K in pieces (from, to, K): derivative - rule = integral of K(s) x^(m)(-s) over the window."""
    m, nodes = question.order, ages(question.order)
    power = s ** (m - 1 - question.derivative) / sp.factorial(m - 1 - question.derivative)
    pieces = []
    for i in range(len(nodes) - 1):
        passed = zip(weights(question)[: i + 1], nodes, strict=False)
        K = power - sum(w * (s - age) ** (m - 1) / sp.factorial(m - 1) for w, age in passed)
        pieces.append((nodes[i], nodes[i + 1], sp.expand(K)))
    return pieces


def boundary(K: sp.Expr, m: int, at: sp.Expr, values: tuple[sp.Symbol, ...]) -> sp.Expr:
    """What m partial integrations of K(s) x^(m)(-s) leave at s = ``at``, values[k] = x^(k)(-at)."""
    return -sum(sp.diff(K, s, k).subs(s, at) * values[m - 1 - k] for k in range(m))


def remainder(question: Question) -> Equation:
    """Partial integration of K x^(m) over the pieces: only the derivative now and the weighted positions are left."""
    m, nodes = question.order, ages(question.order)
    values = [sp.symbols(f"x{i}_:{m}", real=True) for i in range(len(nodes))]
    left = sum(
        boundary(K, m, nodes[i + 1], values[i + 1]) - boundary(K, m, nodes[i], values[i])
        for i, (_, _, K) in enumerate(kernel(question))
    )
    rule = sum(w * x[0] for w, x in zip(weights(question), values, strict=True))
    return Equation(values[0][question.derivative] - rule, left)


def positive_kernel(question: Question, i: int) -> Bound:
    """K >= 0 on piece i, written in the share of the piece."""
    start, end, K = kernel(question)[i]
    share = sp.Symbol("share", nonnegative=True)
    shared = sp.expand(K.subs(s, start + share * (end - start)).subs(T, 1))
    return Bound(sp.Integer(0), "<=", shared, {share: (sp.Integer(0), sp.Integer(1))})


def guaranteed(question: Question) -> Equation:
    """Noise sigma by the sum of absolute weights, motion M by the integral of K."""
    # Nodes are in order, so the signs alternate; the kernel is positive.
    noise = sigma * sum((-1) ** i * w for i, w in enumerate(weights(question)))
    motion = M * sum(sp.integrate(K, (s, a, b)) for a, b, K in kernel(question))
    return Equation(*(side.subs(M, bound(question.order)) for side in (question.best, noise + motion)))


# -- the motion: what cannot be undercut ---------------------------------------------------------------


def chebyshev(order: int) -> sp.Expr:
    """sigma T_m(1 - 2 s / T): the invisible motion over the youngest part of the window."""
    return sigma * sp.chebyshevt(order, 1 - 2 * s / T)


#: Older pieces, in u = 0..1 over half a window each, in units of sigma: rest, or waves that repeat with changed sign.
OLDER = {2: sp.Integer(-1), 3: 1 - 6 * u**2 + 4 * u**3}
#: Sign with which the pieces follow each other.
TURNS = {2: 1, 3: -1}


def jet(piece: sp.Expr, variable: sp.Symbol, at: sp.Expr, order: int) -> list[sp.Expr]:
    """Values of a piece and of its derivatives below the order, at one of its ends."""
    return [sp.diff(piece, variable, k).subs(variable, at) for k in range(order)]


def older(order: int) -> sp.Expr:
    """The first older piece as a motion of u; derivatives by s are those by u times (2/T)^k."""
    return sigma * OLDER[order]


def joins(order: int) -> Equation:
    """Values and derivatives below the order agree where the pieces meet, for ever."""
    rate = [(2 / T) ** k for k in range(order)]
    first = jet(chebyshev(order), s, ages(order)[-1], order)
    second = [r * d for r, d in zip(rate, jet(older(order), u, sp.Integer(0), order), strict=True)]
    end = jet(older(order), u, sp.Integer(1), order)
    again = [TURNS[order] * d for d in jet(older(order), u, sp.Integer(0), order)]
    return Equation(first + end, second + again)


def steepness(order: int) -> Equation:
    """The m-th derivative is at most M on every piece: M on the youngest, 0 or M on the older ones."""
    youngest = sp.diff(chebyshev(order), s, order)
    wave = sp.diff(older(order), u, order) * (2 / T) ** order
    printed = [(-1) ** order * bound(order), bound(order) if order == 3 else sp.Integer(0)]
    return Equation(printed, [sp.expand(youngest), sp.expand(wave)])


def inside(piece: sp.Expr, variable: sp.Symbol, low: int) -> Bound:
    """A piece stays within +-sigma: its square is at most one, in units of sigma."""
    return Bound(sp.expand(piece**2), "<=", sp.Integer(1), {variable: (sp.Integer(low), sp.Integer(1))})


def attained(question: Question) -> Equation:
    """The invisible motion and its mirror image differ by twice the bound: every algorithm errs for one of them."""
    now = sp.diff(chebyshev(question.order), s, question.derivative).subs(s, 0) * (-1) ** question.derivative
    return Equation(question.best.subs(M, bound(question.order)), sp.expand(now))


RULES = tuple(
    claim(f"limit.{q.name}.{heading}", derive=derive)
    for q in QUESTIONS
    for heading, derive in (
        (
            f"remainder | The rule for the {q.words} is off by the integral of K x^({q.order}).",
            lambda q=q: remainder(q),
        ),
        *(
            (
                f"kernel.{i} | The kernel of the rule for the {q.words} is not negative on its piece {i} (T = 1).",
                lambda q=q, i=i: positive_kernel(q, i - 1),
            )
            for i in range(1, q.order)
        ),
        (f"upper | The rule guarantees the {q.words} to {sp.sstr(q.best)}.", lambda q=q: guaranteed(q)),
        (
            f"lower | No algorithm guarantees the {q.words} better: a motion that may be measured as rest has it.",
            lambda q=q: attained(q),
        ),
    )
)
MOTIONS = (
    *(
        one
        for m in (2, 3)
        for one in claims(
            f"limit.motion.{m}.joins | The pieces of the invisible motion of order {m} meet with {m - 1} continuous "
            "derivatives.",
            lambda m=m: joins(m),
            f"limit.motion.{m}.steep | The derivative of order {m} of the invisible motion has the absolute value M, "
            "or rests.",
            lambda m=m: steepness(m),
            f"limit.motion.{m}.youngest | The youngest piece of the invisible motion of order {m} never leaves the "
            "noise.",
            lambda m=m: inside(sp.chebyshevt(m, y), y, -1),
        )
    ),
    *claims(
        "limit.motion.3.older | The older piece of the invisible motion of order 3 never leaves the noise.",
        lambda: inside(OLDER[3], u, 0),
        # The heading is made continuous; its greatest acceleration, some seconds later, is 0.1081 m/s^2.
        "limit.yawing | Noise within sqrt(3) m, |dV_2/dt| <= 0.1077 m/s^2, as yawing begins at 100 m/s: V_2 no better "
        "than 0.86 m/s. | CERTIFIED",
        lambda: Equation(
            sp.Rational("0.86"),
            QUESTIONS[0].best.subs({sigma: sp.sqrt(3), M: 100 * sp.sin(sp.pi / 4) * 5 * sp.pi / 180 * 2 * sp.pi / 360}),
            tolerance=sp.Rational("0.005"),
        ),
    ),
)
