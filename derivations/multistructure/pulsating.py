"""Equations (15)-(17) and the words about the pulsating filter."""

from collections.abc import Callable
from itertools import product

import sympy as sp

from navsym.claims import CERTIFIED, PROVED, Bound, Claim, Equation, Property, claim, claims, fact, state
from navsym.language.expression import to_text
from navsym_papers.multistructure import examples, finite
from navsym_papers.multistructure.finite import Step, step
from navsym_papers.multistructure.moments import mixture, right_side_of_13
from navsym_papers.multistructure.recursion import UNIT

modes = sp.Symbol("I", positive=True)
n = sp.Symbol("n", positive=True)
square = sp.Symbol("D", nonnegative=True)


def forgetful_steps():
    """Steps under (14), all sizes."""
    return [step(m, n, switch=finite.forgetful(m)) for m, n in finite.SIZES]


def whole(s: Step, y: int) -> sp.Expr:
    """pi[x(k-1)], what the Gaussian approximation stands for."""
    return sum(s.modes[j] * s.past[j][y] for j in s.I)


def predicted(s: Step, i: int, x: int) -> sp.Expr:
    """The integral of (15), as a sum of monomials: positive at sight, so that it may be divided by."""
    return sp.expand(sum(s.f(i, x, y) * whole(s, y) for y in s.X))


def rho(s: Step, i: int, predicted: Callable[[Step, int, int], sp.Expr] = predicted) -> sp.Expr:
    """What makes (15) sum to one."""
    return sp.expand(sum(s.L(i, x) * predicted(s, i, x) for x in s.X))


def product_of(
    number: str, condition: str, steps: Callable[[], list[Step]], predicted: Callable, like: str = ""
) -> tuple[Claim, Claim]:
    """(15) or (20), as printed and with the product; ``predicted`` is its integral."""

    def printed() -> Equation:
        s = steps()[0]
        truth = finite.partial(s, 0, 0)
        return Equation([s.L(0, 0) / rho(s, 0, predicted), predicted(s, 0, 0)], [truth, truth], UNIT(s))

    def corrected() -> Equation:
        cases = [(s, i) for s in steps() for i in s.I]
        parts = [s.L(i, 0) / rho(s, i, predicted) * predicted(s, i, 0) for s, i in cases]
        return Equation(parts, [finite.partial(s, 0, i) for s, i in cases])

    reason = (
        f"an equals sign stands between the fraction and the integral where (8) has a product{like}; the copy has one "
        "behind the product sign of (8), too; by hand: a measurement that says nothing makes the fraction 1, and the "
        "posterior is the integral"
    )
    title = f"({number}) as printed: pi^i equals the fraction, and equals the integral."
    right = f"({number}) with the product of fraction and integral: (8) under ({condition}) [I,n = 2,2 3,2 2,3]."
    return claim(number, title, printed, slip="scan", reason=reason), claim(f"{number}*", right, corrected)


partial_densities = product_of("15", "14", forgetful_steps, predicted)


@claim("16 | (16): under (14) rho^i is the density of Y(k) given the mode at k (two modes, two states).")
def mode_likelihood():
    s = step(2, 2, 2, entries=finite.distribution, switch=finite.forgetful(2, finite.distribution))
    return Equation([rho(s, i) for i in s.I], [finite.mode_likelihood(s, i) for i in s.I])


@claim("17 | (17): (10) under (14) [I,n = 2,2 3,2 2,3].")
def mode_probability():
    for s in forgetful_steps():
        below = sp.expand(sum(rho(s, i) * s.p(i, 0) for i in s.I))
        yield [rho(s, i) * s.p(i, 0) / below for i in s.I], [finite.mode(s, i) for i in s.I]


@claim("17.fold")
def mode_probability_of_the_fold():
    """With one density for all pi^j[x(k-1)], (10) is (17) with p^i = sum p^ij g^j(k-1) [I,n = 2,2 3,2 2,3]."""
    for s in finite.every_size():
        fold = {s.past[j][y]: s.past[0][y] for j in s.I for y in s.X}
        likelihood = [sum(s.L(i, x) * s.f(i, x, y) * s.past[0][y] for x in s.X for y in s.X) for i in s.I]
        weight = [likelihood[i] * sum(s.p(i, j) * s.modes[j] for j in s.I) for i in s.I]
        yield [w / sum(weight) for w in weight], [finite.mode(s, i).subs(fold, simultaneous=True) for i in s.I]


@claim("13.sequences")
def weighing_of_sequences():
    """Below (13): the optimal estimate weighs partial ones by g of sequences, here of two modes [I,n = 2,2 3,2 2,3]."""
    for s in finite.every_size():
        value = [sp.Symbol(f"xi_{x}", real=True) for x in s.X]
        evidence = s.probability(Y=0)
        terms = []
        for i, j in product(s.I, s.I):
            weight = s.probability(Y=0, i=i, j=j)
            estimate = sum(value[x] * s.probability(Y=0, x=x, i=i, j=j) for x in s.X) / weight
            terms.append(weight / evidence * estimate)
        yield sum(terms), sum(value[x] * s.probability(Y=0, x=x) for x in s.X) / evidence


def leaves_by_tree(modes: int, steps: int, roots: int) -> int:
    """Hypotheses of the exact tree, counted by growing it from one root, or one for every mode at step 0."""
    sequences = {(j,) for j in range(modes)} if roots > 1 else {()}
    for _ in range(steps):
        sequences = {(*sequence, i) for sequence in sequences for i in range(modes)}
    return len(sequences)


def say_sequences(modes: int, steps: int, count: int) -> dict:
    """That there are so many sequences: the sum of ones over all of them."""
    text = "1"
    for k in range(1, steps + 1):
        text = f"sum({text}, i{k}, 1, {modes})"
    return state(text, "=", str(count))


GRID = [(modes, steps) for modes in (1, 2, 3, 4) for steps in range(6)]


MODELS = [[examples.CALM, examples.JUMP]] * 4
SWITCHING = [examples.STICKY] * 4


def differs(first: examples.Estimate, second: examples.Estimate) -> Property:
    """Whether two estimates differ, by balls; undecided balls are an error, not an answer."""
    if first.ball.overlaps(second.ball):
        raise ArithmeticError("balls overlap: more bits are needed")
    evidence = f"{first.ball.str(12, radius=False)} against {second.ball.str(12, radius=False)}"
    scope = "one model, one series of measurements"
    meaning = [*first.said, *second.said, state(first.text, "!=", second.text, {**first.box, **second.box})]
    return fact(True, True, "ball arithmetic", CERTIFIED, scope=scope, evidence=evidence, meaning=meaning)


CLAIMS_COUNT = claims(
    "count.sequences | Below (13): up to step k there are I^(k+1) sequences of modes, step 0 included (I to 4, k "
    "to 5).",
    lambda: fact(
        tuple(modes ** (steps + 1) for modes, steps in GRID),
        tuple(leaves_by_tree(modes, steps, modes) for modes, steps in GRID),
        "sequences enumerated",
        PROVED,
        scope="I = 1..4, k = 0..5; every step multiplies by I, so for all by induction",
        meaning=[say_sequences(modes, steps + 1, modes ** (steps + 1)) for modes, steps in GRID],
    ),
    "count.growth | Below (13): the number of sequences grows without bound, if there are two modes or more.",
    lambda: Bound(modes * n - n, ">=", n, {modes: (2, None), n: (1, None)}),
    "17.suboptimal | Below (18): the algorithm is suboptimal: in one model its second estimate differs from the "
    "optimal one. | CERTIFIED",
    lambda: differs(*(examples.estimate(MODELS, SWITCHING, [[3], [1]], period) for period in (1, 2))),
)


@claim("17.first")
def first_step_is_exact():
    """The first pulsating estimate is optimal when all modes start from one Gaussian (one model, two modes)."""
    series = [[3]]
    pulsating = examples.run("pulsating", MODELS, SWITCHING, series)[0]
    exact = examples.run("exact", MODELS, SWITCHING, series)[0]
    return Equation([pulsating.mean[0], pulsating.covariance[0][0]], [exact.mean[0], exact.covariance[0][0]])


share, gap = sp.Symbol("epsilon", nonnegative=True), sp.Symbol("d", real=True)


def excess(epsilon, square):
    """Fourth cumulant over squared variance of (1-e) N(0,1) + e N(d,1): zero for a Gaussian."""
    spread = epsilon * (1 - epsilon)
    return spread * (1 - 6 * spread) * square**2 / (1 + spread * square) ** 2


@claim("near.excess")
def excess_of_two():
    """The measure of error below: fourth cumulant of a mixture of two unit Gaussians a distance d apart."""
    e = share
    mean = e * gap
    return Equation(
        excess(e, gap**2),
        sum(w * (3 + 6 * (c - mean) ** 2 + (c - mean) ** 4) for w, c in ((1 - e, 0), (e, gap)))
        / sum(w * (1 + (c - mean) ** 2) for w, c in ((1 - e, 0), (e, gap))) ** 2
        - 3,
        {e: (0, 1)},
    )


@claim(
    "near | The error of the Gaussian approximation vanishes when g^i tends to one for one mode. | paper: g^i near "
    "one is not enough: a mode of probability epsilon at the distance 1/sqrt(epsilon) makes the Gaussian "
    "approximation arbitrarily bad while g tends to one; the distance must be bounded; by hand: epsilon d^2 = 1 "
    "leaves the variance 2 and a fourth cumulant near 1/epsilon"
)
def near_optimal():
    method, evidence = "limit of the exact excess kurtosis", "the excess tends to 1"
    scope = "g = 1 - 1/x^2, unit Gaussians sqrt(x) apart, x -> oo"
    x = sp.Symbol("x", positive=True)
    close = excess(1 / x**2, x)
    meaning = (state(f"limit({to_text(close)}, x, oo)", "=", "0"),)
    return fact(True, sp.limit(close, x, sp.oo) == 0, method, PROVED, scope=scope, evidence=evidence, meaning=meaning)


CLAIMS_NEAR = claims(
    # Divided by epsilon d^4 and cleared of the denominator; D = d^2.
    "near* | With unit variances and the modes a bounded distance d apart the excess is at most epsilon d^4 "
    "(epsilon <= 1/10).",
    lambda: Bound(
        (1 - share) * (1 - 6 * (share * (1 - share))),
        "<=",
        (1 + share * (1 - share) * square) ** 2,
        {share: (0, sp.Rational(1, 10)), square: (0, None)},
    ),
)


@claim("near.spread")
def small_modes_may_be_wide():
    """Equal means, weights 1 - e and e, variances 1 and P: excess 3 e (1 - e) (P - 1)^2/variance^2: e P^2 matters."""
    e, wide = sp.symbols("e P", positive=True)
    variance, fourth = (1 - e) + e * wide, 3 * (1 - e) + 3 * e * wide**2
    printed = 3 * e * (1 - e) * (wide - 1) ** 2 / variance**2
    return Equation(printed, fourth / variance**2 - 3, {e: (0, 1)})


def cumulant(share_: sp.Expr, gap_: sp.Expr, wider: sp.Expr) -> sp.Expr:
    """Fourth cumulant of a mixture of N(0, 1) and, with the weight ``share_``, N(gap_, 1 + wider), as a closed form."""
    w = share_ * (1 - share_)
    return w * (3 * wider**2 + 6 * (1 - 2 * share_) * gap_**2 * wider + (1 - 6 * w) * gap_**4)


@claim("near.cumulant")
def cumulant_of_any_two():
    """Weights 1 - e and e, N(0, 1) and N(d, 1 + v): the fourth cumulant, which has e v^2, e d^2 v and e d^4."""
    e, wider = share, sp.Symbol("v", real=True)
    mean = e * gap
    parts = ((1 - e, -mean, sp.Integer(1)), (e, gap - mean, 1 + wider))
    second = sum(w * (p + c**2) for w, c, p in parts)
    fourth = sum(w * (3 * p**2 + 6 * p * c**2 + c**4) for w, c, p in parts)
    return Equation(cumulant(e, gap, wider), fourth - 3 * second**2)


@claim("near.enough")
def what_is_enough():
    """The square of that cumulant is at most (6 e (v^2 + d^4))^2 (e <= 1/10): both terms small is enough."""
    wider, square = sp.Symbol("v", real=True), sp.Symbol("D", nonnegative=True)
    parts = sp.expand(cumulant(share, sp.sqrt(square), wider) / (share * (1 - share)))
    bound = 6 * (wider**2 + square**2)
    return Bound((bound - parts) * (bound + parts), ">=", 0, {share: (0, sp.Rational(1, 10)), square: (0, None)})


def first_mode_in_the_sums() -> tuple[sp.Matrix, list[sp.Expr]]:
    """(17), (12) and (13) for one state and two modes: g, X and P, and the weight, mean and variance of mode 1."""
    g, a, b, c = mixture(2)
    mean = sum(w * x for w, x in zip(g, a, strict=True))
    variance = sum(right_side_of_13(2)).subs(dict(zip(b, a, strict=True)), simultaneous=True)
    return sp.Matrix([g[0], mean, variance]), [sp.Symbol("w_0", positive=True), a[0], c[0]]


@claim(
    "17.memory | Pulsating needs more memory than Kalman only for (17): the mean of a mode that is done does not "
    "enter X and P. | paper: beside the probabilities of (17) the sums of (12) and (13) that are being built must be "
    "kept, while every model starts from the same estimate; by hand: one state and two modes need a mean and a "
    "variance more, 4 numbers and not 2"
)
def probabilities_are_enough():
    sums, (_, mean, _) = first_mode_in_the_sums()
    return Equation([0, 0], list(sums[1:, :].diff(mean)))


@claim("17.memory*")
def what_must_be_kept():
    """Of a mode that is done g, X and P need weight, mean and variance: slopes of determinant v w^2/(w + v)^4."""
    sums, kept = first_mode_in_the_sums()
    w, v = sp.symbols("w_0 w_1", positive=True)
    return Equation(v * w**2 / (w + v) ** 4, sums.jacobian(kept).det())
