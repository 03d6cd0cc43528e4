"""Numbers with two infinitesimals, eps and tau, whose squares are zero: exact linearisation along a flow.

The coefficients may be balls or quotients of polynomials; an integer 0 stands for a coefficient that is absent.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: A vector or a matrix of nilpotents.
Array = NDArray[np.object_]


def times(x: Any, y: Any) -> Any:
    """The product of coefficients; absent ones cost nothing."""
    return 0 if (type(x) is int and x == 0) or (type(y) is int and y == 0) else x * y


def plus(x: Any, y: Any) -> Any:
    """The sum of coefficients; absent ones cost nothing."""
    if type(x) is int and x == 0:
        return y
    return x if type(y) is int and y == 0 else x + y


class Nilpotent:
    """``value + error eps + rate tau + mixed eps tau`` with eps**2 = tau**2 = 0.

    >>> x = Nilpotent(3, 1) * Nilpotent(2, 0, 5)
    >>> x.value, x.error, x.rate, x.mixed
    (6, 2, 15, 5)
    """

    __slots__ = ("error", "mixed", "rate", "value")

    def __init__(self, value: Any = 0, error: Any = 0, rate: Any = 0, mixed: Any = 0):
        self.value, self.error, self.rate, self.mixed = value, error, rate, mixed

    def parts(self) -> tuple[Any, Any, Any, Any]:
        """The four coefficients."""
        return self.value, self.error, self.rate, self.mixed

    def __add__(self, other: Nilpotent) -> Nilpotent:
        if self is NOTHING or other is NOTHING:
            return other if self is NOTHING else self
        return Nilpotent(*map(plus, self.parts(), other.parts()))

    def __neg__(self) -> Nilpotent:
        if self is NOTHING:
            return self
        return Nilpotent(*(times(-1, part) for part in self.parts()))

    def __sub__(self, other: Nilpotent) -> Nilpotent:
        return self + -other

    def __mul__(self, other: Nilpotent) -> Nilpotent:
        if self is NOTHING or other is NOTHING:
            return NOTHING
        if self is ONE or other is ONE:
            return other if self is ONE else self
        (a, e, t, m), (A, E, T, M) = self.parts(), other.parts()
        mixed = plus(plus(times(a, M), times(m, A)), plus(times(e, T), times(t, E)))
        return Nilpotent(times(a, A), plus(times(a, E), times(e, A)), plus(times(a, T), times(t, A)), mixed)

    def __truediv__(self, other: Nilpotent) -> Nilpotent:
        return self * other.inverse()

    def inverse(self) -> Nilpotent:
        """1/x; the value must not be zero."""
        one = self.value if type(self.value) is int and abs(self.value) == 1 else 1 / self.value
        square = one * one
        curved = times(2, times(square * one, times(self.error, self.rate)))
        error, rate, mixed = (times(-1, times(square, part)) for part in self.parts()[1:])
        return Nilpotent(one, error, rate, plus(mixed, curved))

    def advance(self, rate: Nilpotent) -> Nilpotent:
        """``x + tau * rate``, for a rate without tau."""
        return self + Nilpotent(0, 0, rate.value, rate.error)


NOTHING, ONE = Nilpotent(), Nilpotent(1)


LIFT: Any = np.frompyfunc(lambda x: x if type(x) is Nilpotent else Nilpotent(x), 1, 1)
VALUES: Any = np.frompyfunc(lambda x: x.value, 1, 1)
#: ``x + tau * rate``, entry by entry.
ADVANCE: Any = np.frompyfunc(Nilpotent.advance, 2, 1)


def constant(values: Any) -> Array:
    """A vector or matrix of nilpotents, of numbers or coefficients without infinitesimals.

    Entries are objects: ``+``, ``-`` and ``@`` are theirs.
    """
    return LIFT(np.array(values, dtype=object))  # type: ignore[no-any-return]


ZERO = constant([NOTHING] * 3)


def cross(u: Array, v: Array) -> Array:
    """u x v."""
    return constant([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])


def skew(u: Array) -> Array:
    """The matrix of ``u x``."""
    return constant([[NOTHING, -u[2], u[1]], [u[2], NOTHING, -u[0]], [-u[1], u[0], NOTHING]])


def identity() -> Array:
    """The unit matrix."""
    return constant([[ONE if i == j else NOTHING for j in range(3)] for i in range(3)])


def rotate(A: Array, v: Any) -> Any:
    """A v in coefficients."""
    return VALUES(A @ constant(v))
