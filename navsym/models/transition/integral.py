"""The covariance that white noise leaves behind: the integral of ``Phi(s) diag(q) Phi(s)'`` in closed form.

Products of sines and cosines become sums, and each term ``s^m exp(a s) cos(b s)`` has an antiderivative of its own
kind. What comes out is a proposal: whoever uses it proves ``Qd' = F Qd + Qd F' + diag(q)`` and ``Qd(0) = 0``.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import sympy as sp
from sympy.simplify.fu import TR8

from navsym.core.errors import DomainError


def noise_integral(Phi: sp.MatrixBase, q: Sequence[sp.Symbol], dt: sp.Symbol) -> sp.ImmutableMatrix:
    """``int_0^dt Phi(s) diag(q) Phi(s)' ds``.

    Phi : (n, n), sums of powers, exponentials, sines and cosines of multiples of dt
    q   : (n,) intensities of the white noises, one for each state

    Raises DomainError for an entry of another kind.

    >>> import sympy as sp
    >>> t, q = sp.Symbol("t"), sp.symbols("q0 q1")
    >>> noise_integral(sp.Matrix([[1, t], [0, 1]]), q, t)
    Matrix([
    [q0*t + q1*t**3/3, q1*t**2/2],
    [       q1*t**2/2,      q1*t]])
    """
    n = Phi.rows
    known: dict[sp.Expr, sp.Expr] = {}

    def value(i: int, j: int) -> sp.Expr:
        products = [(q[k], Phi[i, k] * Phi[j, k]) for k in range(n) if Phi[i, k] != 0 and Phi[j, k] != 0]
        for _, product in products:
            if product not in known:
                known[product] = integral_from_zero(product, dt)
        return sp.Add(*(intensity * known[product] for intensity, product in products))

    upper = {(i, j): value(i, j) for i in range(n) for j in range(i, n)}
    return sp.ImmutableMatrix(n, n, lambda i, j: upper[min(i, j), max(i, j)])


def integral_from_zero(formula: sp.Expr, t: sp.Symbol) -> sp.Expr:
    """The integral of a sum of terms ``t^m exp(a t) cos(b t)`` from 0 to t."""
    plain = formula.replace(lambda e: isinstance(e, (sp.sinh, sp.cosh)), lambda e: e.rewrite(sp.exp))
    terms = sp.Add.make_args(sp.expand(TR8(sp.expand(plain)), deep=False).expand())
    whole = sp.Add(*(antiderivative(term, t) for term in terms))
    return sp.expand(whole - whole.subs(t, 0))


def antiderivative(term: sp.Expr, t: sp.Symbol) -> sp.Expr:
    """``int t^m exp(a t) cos(b t + c) dt``, or with a sine, or without either; the same for any constant factor.

    With l = a + i b it is the real or imaginary part of ``exp(l t + i c) sum_k (-1)^k m!/(m-k)! t^(m-k)/l^(k+1)``.
    """
    constant, rest = term.as_independent(t, as_Add=False)
    power, rate, turn = 0, sp.S.Zero, None
    for factor in sp.Mul.make_args(rest):
        base, exponent = factor.as_base_exp()
        if base == t and exponent.is_Integer and exponent > 0:
            power += int(exponent)
        elif isinstance(factor, sp.exp) and factor.args[0].coeff(t, 1) * t == factor.args[0].expand():
            rate += factor.args[0].coeff(t, 1)
        elif isinstance(factor, (sp.sin, sp.cos)) and turn is None and factor.args[0].diff(t, 2) == 0:
            turn = factor
        elif factor != 1:
            raise DomainError(f"expected powers, exponentials, sines and cosines of the time; got {factor}; give Qd")
    rate = sp.expand(rate)
    if rate == 0 and turn is None:
        return constant * t ** (power + 1) / (power + 1)
    speed = sp.S.Zero if turn is None else turn.args[0].diff(t)
    size = rate**2 + speed**2
    one_over = (rate / size, -speed / size)
    inverse, real, imaginary = one_over, sp.S.Zero, sp.S.Zero
    for k in range(power + 1):
        weight = (-1) ** k * sp.Rational(factorial(power), factorial(power - k)) * t ** (power - k)
        real, imaginary = real + weight * inverse[0], imaginary + weight * inverse[1]
        inverse = (
            inverse[0] * one_over[0] - inverse[1] * one_over[1],
            inverse[0] * one_over[1] + inverse[1] * one_over[0],
        )
    growth = sp.exp(rate * t) if rate != 0 else sp.S.One
    if turn is None:
        return constant * growth * real
    c, s = sp.cos(turn.args[0]), sp.sin(turn.args[0])
    whole = c * real - s * imaginary if isinstance(turn, sp.cos) else c * imaginary + s * real
    return constant * growth * whole
