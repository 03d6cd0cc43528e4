"""One step of exact arithmetic at a time, bounded before it is done.

sympy evaluates while it builds: ``9**9**9`` would be computed, ``exp(10**9*log(2))`` turned
into a power and computed, ``1/0`` become ``zoo``. Here the size of every power is bounded
first, and every result must be a finite real expression.
"""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp
from sympy.core.evalf import PrecisionExhausted

from navsym.core.errors import DomainError, NavsymError, TooLargeError
from navsym.language.tokens import EXPONENT

BITS = 13_000  # size of any number, below 4000 digits
GROWTH = 9_000  # argument of exp, sinh and cosh: exp(9000) is just below 2**BITS
FACTORS = 128  # of one product: the algebra compares all of them
DENOMINATOR = 1_000_000  # of an exponent: the atmosphere has 5.25588 and its inverse, measured laws have six decimals
ROOT_BITS = 700  # size of a number under a root: sympy looks for square factors in it

SAME_NAME = "sin cos tan cot sec csc exp log sqrt asin acos atan atan2 sinh cosh tanh".split()
BUILDERS: dict[str, Callable[..., sp.Expr]] = {"abs": sp.Abs, **{name: getattr(sp, name) for name in SAME_NAME}}


#: Roots are the real ones of numbers that are not negative, as in (-8)**(1/3).
ROOT_ADVICE = "restrict the symbols, or take the sign out of an odd root: -(8**(1/3))"


class Refusal(Exception):
    """Why a step is not done; the parser adds the place."""

    def __init__(self, error: type[NavsymError], expected: str, got: str, remedy: str):
        super().__init__(expected)
        self.error, self.expected, self.got, self.remedy = error, expected, got, remedy


def refuse_size(expected: str, got: str) -> Refusal:
    """A refusal for size."""
    return Refusal(TooLargeError, expected, got, "rescale, or state the formula without this power")


def refuse_value(got: str) -> Refusal:
    """A refusal for a value that does not exist or is not real."""
    return Refusal(DomainError, "a finite real value", got, "restrict or correct the expression")


def add_exactly(terms: list[sp.Expr]) -> sp.Expr:
    """The sum."""
    return require_real(sp.Add(*terms)) if len(terms) > 1 else terms[0]


def multiply_exactly(factors: list[sp.Expr]) -> sp.Expr:
    """The product, with the size of its numbers bounded first."""
    if len(factors) > 2 and sum(number_bits(factor) for factor in factors) > 4 * BITS:
        raise refuse_size(f"numbers of at most {BITS} bits", "a product of many large ones")
    return require_real(sp.Mul(*factors)) if len(factors) > 1 else factors[0]


def invert_exactly(divisor: sp.Expr) -> sp.Expr:
    """One over the divisor, which must not be a zero, open or in disguise."""
    if sign_of_constant(divisor) == 0:
        raise Refusal(DomainError, "a nonzero divisor", "zero", "correct the denominator")
    return require_real(sp.Pow(divisor, -1))


def raise_exactly(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """``base**exponent`` with the size of the result bounded before it is computed."""
    bound_exponent(base, exponent)
    if exponent.is_zero and sign_of_constant(base) == 0:
        raise Refusal(DomainError, "a nonzero base", "zero to the power zero", "write the value that is meant")
    if exponent.is_extended_negative and sign_of_constant(base) == 0:
        raise Refusal(DomainError, "a nonzero base", "zero to a negative power", "correct the denominator")
    if exponent.free_symbols and sign_of_constant(base) == -1:
        raise refuse_value("a negative number to a symbolic power")
    if exponent.is_Rational and exponent.q > EXPONENT:
        return require_real(raise_to_decimal(base, exponent))
    return require_real(sp.Pow(base, exponent))


def raise_to_decimal(base: sp.Expr, exponent: sp.Rational) -> sp.Expr:
    """``base**exponent`` with the numbers of the base taken apart into primes.

    Of ``75**(1/131397)`` the algebra would make ``(3 * 5**43799...)**(...)``, a number of a hundred thousand digits.
    """
    number, rest = base.as_coeff_Mul()
    if not number.is_Rational or number <= 0:
        return sp.Pow(base, exponent)
    primes = sp.factorrat(number, limit=2**15)
    powers = [sp.Pow(prime, multiplicity * exponent) for prime, multiplicity in sorted(primes.items())]
    return sp.Mul(*powers, sp.Pow(rest, exponent))


def call_function(name: str, arguments: list[sp.Expr]) -> sp.Expr:
    """Function of the language at exact arguments."""
    if name == "sqrt":
        return raise_exactly(arguments[0], sp.Rational(1, 2))
    for argument in arguments:
        bound_constant(name, argument)
    check_domain(name, arguments[0])
    if name == "exp":
        bound_logarithms(arguments[0])
    return require_real(BUILDERS[name](*arguments))


def check_domain(name: str, argument: sp.Expr) -> None:
    """Refuse a constant outside the domain before the algebra turns ``sin(asin(2))`` into 2."""
    if name in ("asin", "acos") and sign_of_constant(1 - argument**2) == -1:
        raise refuse_value("the inverse of a sine or cosine above one")
    if name == "log" and sign_of_constant(argument) == -1:
        raise refuse_value("the logarithm of a negative number")


def sign_of_constant(value: sp.Expr) -> int | None:
    """Sign of a constant: -1, 1, or 0 for zero and what 120 digits cannot tell from it; None with symbols."""
    if value.free_symbols:
        return None
    if not value.is_Rational:
        try:
            value = value.evalf(10, maxn=120, strict=True)
        except PrecisionExhausted:
            return 0
    return int(sp.sign(value)) if value.is_comparable else None


def bound_exponent(base: sp.Expr, exponent: sp.Expr) -> None:
    """Refuse a power whose numbers, or whose total exponent, would be too large.

    Every rational part of the exponent counts, also beside symbols: ``2**(x + n)*2**(-x)`` is ``2**n``.
    """
    size = max((abs(part) for part in [*rational_parts(exponent), *irrational_parts(exponent)]), default=sp.Integer(0))
    bits = number_bits(base)
    if size > EXPONENT:
        raise refuse_size(f"an exponent of at most {EXPONENT}", "a larger one")
    if exponent.is_Rational and exponent.q > DENOMINATOR:
        raise refuse_size(f"a fractional exponent with a denominator of at most {DENOMINATOR}", "a larger one")
    if exponent.is_Rational and total_exponent(base) * size > EXPONENT:
        raise refuse_size(f"a total exponent of at most {EXPONENT}", "powers of powers beyond it")
    if bits * size > BITS:
        raise refuse_size(f"numbers of at most {BITS} bits", f"about {int(bits * size)} bits")
    if not exponent.is_integer and bits > ROOT_BITS:
        raise refuse_size(f"at most {ROOT_BITS} bits under a root", f"{bits} bits")


def bound_constant(name: str, argument: sp.Expr) -> None:
    """Refuse constants such as ``sin(exp(exp(99)))``: comparing them would need their whole digits."""
    if argument.free_symbols:
        return
    size = abs(argument.evalf(5))
    largest = GROWTH if name in ("exp", "sinh", "cosh") else sp.Integer(2) ** BITS
    if size.is_Float and size > largest:
        raise refuse_size(f"an argument of {name} of bounded size", "a larger constant")


def bound_logarithms(argument: sp.Expr) -> None:
    """``exp(n*log(a))`` is turned into ``a**n``: the caps of powers hold for it."""
    for term in sp.Add.make_args(argument):
        for factor in sp.Mul.make_args(term):
            if isinstance(factor, sp.log):
                bound_exponent(factor.args[0], term / factor)


def rational_parts(exponent: sp.Expr) -> list[sp.Rational]:
    """Rational coefficients of the terms of an exponent."""
    parts = (term.as_coeff_Mul()[0] for term in sp.Add.make_args(exponent))
    return [part for part in parts if part.is_Rational]


def irrational_parts(exponent: sp.Expr) -> list[sp.Expr]:
    """The value of a constant exponent that is no fraction, to a few digits.

    Of towers such as ``9**9**9**(1/2)`` sympy would want all digits when it puts terms in order.
    """
    if exponent.free_symbols or exponent.is_Rational:
        return []
    value = exponent.evalf(5)
    return [value] if value.is_Float else []


def number_bits(base: sp.Expr) -> int:
    """Size of the numbers that a power of ``base`` would raise: its rational factors."""
    bits = 0
    for factor in sp.Mul.make_args(base):
        inner = factor.base if factor.is_Pow else factor
        if inner.is_Rational:
            bits += int(inner.p).bit_length() * (abs(inner.p) > 1) + int(inner.q).bit_length() * (inner.q > 1)
    return bits


def total_exponent(base: sp.Expr) -> sp.Rational:
    """Largest rational exponent inside ``base``, which the outer one would multiply."""
    powers = (factor for factor in sp.Mul.make_args(base) if factor.is_Pow)
    inside = (abs(part) for factor in powers for part in rational_parts(factor.exp))
    return max(inside, default=sp.Integer(1))


def require_real(value: sp.Expr) -> sp.Expr:
    """The value, when it is finite and real as far as a look at its surface tells."""
    for term in sp.Add.make_args(value):
        for factor in sp.Mul.make_args(term):
            if factor in (sp.nan, sp.zoo, sp.oo, -sp.oo):
                raise refuse_value("an undefined or infinite value")
            if factor is sp.I or (
                factor.is_Pow and factor.base.is_negative and factor.exp.is_Rational and not factor.exp.is_integer
            ):
                raise Refusal(DomainError, "a finite real value", "a root of a negative number", ROOT_ADVICE)
            if factor.is_Rational and number_bits(factor) > BITS:
                raise refuse_size(f"numbers of at most {BITS} bits", "a larger number")
    return value
