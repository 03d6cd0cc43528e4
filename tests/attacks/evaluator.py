"""Values of formulas in interval arithmetic of mpmath: the judge of verdicts, which shares nothing with the package.

Sums, products, roots, exponentials, logarithms, sines, cosines and arctangents of intervals are those of
``mpmath.libmp``, with directed rounding; the other functions are written by these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from mpmath.libmp import (
    finf,
    fone,
    from_int,
    from_rational,
    fzero,
    mpf_cmp,
    mpf_pi,
    mpf_sign,
    mpi_abs,
    mpi_add,
    mpi_atan,
    mpi_cos,
    mpi_div,
    mpi_exp,
    mpi_log,
    mpi_mul,
    mpi_neg,
    mpi_pow_int,
    mpi_sin,
    mpi_sqrt,
    mpi_sub,
    to_str,
)

from tests.attacks.trees import Tree, UnreadableError, read, read_relation

#: Two ends, as raw numbers of mpmath.
Interval = tuple[tuple[int, int, int, int], tuple[int, int, int, int]]

PRECISIONS = (160, 640, 2600)
LARGEST = 30_000  # bits before the point of an argument
ZERO: Interval = (fzero, fzero)
ONE: Interval = (fone, fone)
TWO: Interval = (from_int(2), from_int(2))


class UndefinedError(ArithmeticError):
    """A formula that certainly has no value."""


class UnsureError(ArithmeticError):
    """A formula that may or may not have a value, as far as these intervals show."""


def interval_of(value: Fraction, precision: int) -> Interval:
    """An interval around a rational number."""
    p, q = value.numerator, value.denominator
    return from_rational(p, q, precision, "f"), from_rational(p, q, precision, "c")


def pi_at(precision: int) -> Interval:
    """An interval around pi."""
    return mpf_pi(precision, "f"), mpf_pi(precision, "c")


def sign_of(x: Interval) -> int | None:
    """1, 0 or -1 where all numbers of the interval have this sign, else None."""
    low, high = mpf_sign(x[0]), mpf_sign(x[1])
    return 1 if low > 0 else -1 if high < 0 else 0 if low == high == 0 else None


def evaluate(tree: Tree, values: Mapping[str, Interval], precision: int) -> Interval:
    """All values of a formula; raises UndefinedError or UnsureError."""
    head, *parts = tree
    if head == "number":
        return interval_of(parts[0], precision)
    if head == "pi":
        return pi_at(precision)
    if head == "name":
        return values[parts[0]]
    if head == "**":
        return power(parts[0], parts[1], values, precision)
    operands = [evaluate(part, values, precision) for part in parts]
    return guard(RULES[head](*operands, precision))


def guard(x: Interval) -> Interval:
    """The interval when its ends are finite."""
    if any(end[1] == 0 and end[2] != 0 for end in x):
        raise UnsureError("an infinite end")
    return x


def bounded(x: Interval) -> Interval:
    """The argument of an exponential or a sine, unless it is too large to be computed with."""
    if max(end[2] + end[3] for end in x) > LARGEST:
        raise UnsureError("a huge argument")
    return x


def divide(x: Interval, y: Interval, precision: int) -> Interval:
    if sign_of(y) == 0:
        raise UndefinedError("division by zero")
    if sign_of(y) is None:
        raise UnsureError("a divisor that may be zero")
    return mpi_div(x, y, precision)


def root(x: Interval, precision: int) -> Interval:
    if mpf_sign(x[1]) < 0:
        raise UndefinedError("a root of a negative number")
    if mpf_sign(x[0]) < 0:
        raise UnsureError("a root of what may be negative")
    return mpi_sqrt(x, precision)


def logarithm(x: Interval, precision: int) -> Interval:
    if mpf_sign(x[1]) <= 0:
        raise UndefinedError("a logarithm of what is not positive")
    if mpf_sign(x[0]) <= 0:
        raise UnsureError("a logarithm of what may not be positive")
    return mpi_log(x, precision)


def exponential(x: Interval, precision: int) -> Interval:
    return mpi_exp(bounded(x), precision)


def sine(x: Interval, precision: int) -> Interval:
    return mpi_sin(bounded(x), precision)


def cosine(x: Interval, precision: int) -> Interval:
    return mpi_cos(bounded(x), precision)


def by_ends(rule, x: Interval, precision: int) -> Interval:
    """A function that grows, from its enclosures at both ends."""
    return rule((x[0], x[0]), precision)[0], rule((x[1], x[1]), precision)[1]


def sinh_at(x: Interval, precision: int) -> Interval:
    return mpi_div(mpi_sub(exponential(x, precision), exponential(mpi_neg(x), precision), precision), TWO, precision)


def tanh_at(x: Interval, precision: int) -> Interval:
    grown = mpi_add(exponential(mpi_mul(x, TWO, precision), precision), ONE, precision)
    return mpi_sub(ONE, mpi_div(TWO, grown, precision), precision)


def hyperbolic_cosine(x: Interval, precision: int) -> Interval:
    size = mpi_abs(x, precision)
    ends = [
        mpi_div(mpi_add(exponential(e, precision), exponential(mpi_neg(e), precision), precision), TWO, precision)
        for e in ((size[0], size[0]), (size[1], size[1]))
    ]
    return ends[0][0], ends[1][1]


def arcsine_at(x: Interval, precision: int) -> Interval:
    """atan(x/sqrt((1 - x)(1 + x))), and plus or minus pi/2 at plus or minus 1."""
    if x[0] == x[1] and mpi_abs(x, precision) == ONE:
        half = mpi_div(pi_at(precision), TWO, precision)
        return half if mpf_sign(x[0]) > 0 else mpi_neg(half)
    inside = mpi_mul(mpi_sub(ONE, x, precision), mpi_add(ONE, x, precision), precision)
    return mpi_atan(mpi_div(x, mpi_sqrt(inside, precision), precision), precision)


def arcsine(x: Interval, precision: int) -> Interval:
    size = mpi_abs(x, precision)
    if mpf_cmp(size[0], fone) > 0:
        raise UndefinedError("an arcsine beyond 1")
    if mpf_cmp(size[1], fone) > 0:
        raise UnsureError("an arcsine of what may be beyond 1")
    return by_ends(arcsine_at, x, precision)


def arccosine(x: Interval, precision: int) -> Interval:
    """2 atan2(sqrt(1 - x), sqrt(1 + x)), which keeps its digits near 1, by its ends; it falls."""
    arcsine(x, precision)  # refuses what lies outside

    def at(end: Interval) -> Interval:
        top, bottom = (mpi_sqrt(part(ONE, end, precision), precision) for part in (mpi_sub, mpi_add))
        return mpi_mul(TWO, arctangent2(top, bottom, precision), precision)

    return at((x[1], x[1]))[0], at((x[0], x[0]))[1]


def arctangent2(y: Interval, x: Interval, precision: int) -> Interval:
    """The angle of (x, y) in (-pi, pi]; unsure across the cut and around the origin."""
    up, right, pi = sign_of(y), sign_of(x), pi_at(precision)
    if right == 1:
        return mpi_atan(mpi_div(y, x, precision), precision)
    if up in (1, -1):
        half = mpi_div(pi if up == 1 else mpi_neg(pi), TWO, precision)
        return mpi_sub(half, mpi_atan(mpi_div(x, y, precision), precision), precision)
    if up == right == 0:
        raise UndefinedError("the angle of the origin")
    if up == 0 and right == -1:
        return pi
    raise UnsureError("an angle near the cut or the origin")


def reciprocal(rule):
    return lambda x, precision: divide(ONE, rule(x, precision), precision)


def ratio(top, bottom):
    return lambda x, precision: divide(top(x, precision), bottom(x, precision), precision)


RULES = {
    "+": mpi_add, "-": mpi_sub, "*": mpi_mul, "/": divide, "neg": lambda x, precision: mpi_neg(x),
    "sin": sine, "cos": cosine, "tan": ratio(sine, cosine), "cot": ratio(cosine, sine), "sec": reciprocal(cosine),
    "csc": reciprocal(sine), "exp": exponential, "log": logarithm, "sqrt": root, "abs": mpi_abs,
    "asin": arcsine, "acos": arccosine, "atan": mpi_atan, "atan2": arctangent2,
    "sinh": lambda x, precision: by_ends(sinh_at, x, precision), "cosh": hyperbolic_cosine,
    "tanh": lambda x, precision: by_ends(tanh_at, x, precision),
}  # fmt: skip


def power(base: Tree, exponent: Tree, values: Mapping[str, Interval], precision: int) -> Interval:
    """base**exponent: whole powers of all numbers, others of positive ones, positive ones of zero; 0**0 is unsure."""
    x, e = evaluate(base, values, precision), rational_value(exponent)
    if e is not None and e.denominator == 1:
        if e == 0 and sign_of(x) not in (1, -1):
            raise UnsureError("0**0")
        if abs(e) > 100_000:
            raise UnsureError("a huge power")
        whole = mpi_pow_int(x, abs(int(e)), precision)
        return whole if e >= 0 else divide(ONE, whole, precision)
    sign = sign_of(x)
    if sign == -1 and e is not None:
        raise UndefinedError("a fractional power of a negative number")
    y = evaluate(exponent, values, precision)
    if sign == 0 and e is not None:
        if e > 0:
            return ZERO
        raise UndefinedError("a negative power of zero")
    if sign != 1:
        raise UnsureError("a power of what may not be positive")
    return guard(exponential(mpi_mul(y, mpi_log(x, precision), precision), precision))


def rational_value(tree: Tree) -> Fraction | None:
    """The number that a tree of rational arithmetic is, else None."""
    head, *parts = tree
    if head == "number":
        return parts[0]
    if head not in ("+", "-", "*", "/", "neg"):
        return None
    values = [rational_value(part) for part in parts]
    if None in values or (head == "/" and values[1] == 0):
        return None
    a, b = (*values, Fraction(0))[:2]
    return {"+": a + b, "-": a - b, "*": a * b, "neg": -a}[head] if head != "/" else a / b


# -- Judgements --------------------------------------------------------------------------------------------------------
def compare(x: Interval, relation: str, y: Interval) -> bool | None:
    """Whether the relation certainly holds (True) or certainly fails (False) between all numbers of two intervals."""
    below, above = mpf_cmp(x[1], y[0]), mpf_cmp(y[1], x[0])
    apart = below < 0 or above < 0
    same = x[0] == x[1] == y[0] == y[1]
    if relation in ("=", "!="):
        known = False if apart else True if same else None
        return known if relation == "=" or known is None else not known
    if relation in (">", ">="):
        return compare(y, "<" if relation == ">" else "<=", x)
    if relation == "<":
        return True if below < 0 else False if above <= 0 else None
    return True if below <= 0 else False if above < 0 else None


def judge_at(
    left: Tree, relation: str, right: Tree, point: Mapping[str, Tree], precisions: Sequence[int] = PRECISIONS
) -> str:
    """``holds``, ``fails`` or ``undefined`` where that is certain at the point, else ``unknown``."""
    for precision in precisions:
        try:
            values = {name: evaluate(tree, {}, precision) for name, tree in point.items()}
            sides = [evaluate(side, values, precision) for side in (left, right)]
        except UndefinedError:
            return "undefined"
        except UnsureError:
            continue
        known = compare(sides[0], relation, sides[1])
        if known is not None:
            return "holds" if known else "fails"
    return "unknown"


def judge_text(text: str, point: Mapping[str, str]) -> str:
    """Like :func:`judge_at` for texts; ``unread`` for a text that is no relation of formulas."""
    try:
        return judge_at(*read_relation(text), {name: read(value) for name, value in point.items()})
    except UnreadableError:
        return "unread"


def digits_of(text: str, digits: int) -> str:
    """The value of a formula without names, as a decimal of so many digits, rounded; raises ArithmeticError."""
    for precision in (int(digits * 3.33) + 64, int(digits * 3.33) + 600, int(digits * 3.33) + 6000):
        ends = evaluate(read(text), {}, precision)
        low, high = (to_str(end, digits, min_fixed=-10_000, max_fixed=10_000) for end in ends)
        if low == high:
            return low
    raise UnsureError(f"the digits of {text} are not settled: {low} or {high}")


def bounds_on(tree: Tree, name: str, low: Fraction, high: Fraction, pieces: int) -> tuple[Fraction, Fraction]:
    """Two rational numbers that no value of a formula in one name leaves on [low, high]."""
    step, ends = (high - low) / pieces, []
    for k in range(pieces):
        a, b = interval_of(low + k * step, 80)[0], interval_of(low + (k + 1) * step, 80)[1]
        ends += evaluate(tree, {name: (a, b)}, 80)
    values = [fraction_of(end) for end in ends]
    return min(values), max(values)


def fraction_of(raw: tuple[int, int, int, int]) -> Fraction:
    """A raw number of mpmath, exactly."""
    sign, mantissa, exponent, _ = raw
    if raw == finf:
        raise UnsureError("infinite")
    value = Fraction(mantissa) * Fraction(2) ** exponent
    return -value if sign else value
