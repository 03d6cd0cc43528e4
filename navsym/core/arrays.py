"""Arrays at the gate: copied, checked once, read-only.

Everything that comes from a caller passes through one of these functions at construction,
so that the code behind them may trust shapes and finiteness and never has to look again.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError, EmptyError, NotFiniteError, ShapeError
from navsym.core.units import convert_number, is_quantity, unit_text

Array = NDArray[np.float64]
#: A shape; None stands for a size that is not prescribed.
Shape = Sequence[int | None]

#: Rounding allowed in a matrix that a caller calls semidefinite, or in a sum that should be one.
SLACK = 1e-9
#: Difference allowed between the two halves of a covariance whose variances are 1.
ASYMMETRY = 1e-12


def as_array(name: str, value: Any, shape: Shape, why: str, unit: str = "") -> Array:
    """A read-only float copy of ``value``, of the given shape and without NaN or infinities.

    name  : what the caller calls it; opens every error message
    shape : expected sizes, None where any positive size will do
    why   : what the axes are, "one entry per measurement"
    unit  : what quantities of pint are converted to; SI where it is empty

    Raises ShapeError, EmptyError (no entries), NotFiniteError, and DomainError for a quantity of another dimension.
    """
    return freeze(need_finite(name, need_shape(name, as_floats(name, value, why, unit), shape, why)))


def need_shape(name: str, array: Array, shape: Shape, why: str) -> Array:
    """The same array; EmptyError where it has no entries, ShapeError where its shape is another one."""
    if array.size == 0:
        raise EmptyError(f"{name}: expected shape {describe_shape(shape)}, {why}; got no entries; give at least one")
    fits = array.ndim == len(shape) and all(
        want is None or want == got for want, got in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise ShapeError(
            f"{name}: expected shape {describe_shape(shape)}, {why}; got {array.shape}; give one entry for each"
        )
    return array


def need_finite(name: str, array: Array) -> Array:
    """The same array; NotFiniteError where it holds NaN or an infinity."""
    if not np.isfinite(array).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise NotFiniteError(f"{name}: expected finite numbers; got {array[place]} at index {place}; remove or mend it")
    return array


def without_units(value: Any, where: str, unit: str = "") -> Any:
    """Quantities of pint as floats in a unit, or in SI, also inside lists; everything else as it is."""
    if is_quantity(value):
        return convert_number(np.asarray(value.magnitude, dtype=np.float64), unit_text(value), unit, where)[()]
    if isinstance(value, list | tuple) and "pint" in sys.modules:
        return [without_units(item, where, unit) for item in value]
    return value


def as_floats(name: str, value: Any, why: str, unit: str = "") -> Array:
    """A float copy of nested sequences of numbers; ragged rows, truth values and words are a ShapeError."""
    value = without_units(value, name, unit)
    try:
        raw = np.asarray(value)
        if raw.dtype.kind not in "iufO" or (raw.dtype == object and any(isinstance(v, bool | str) for v in raw.flat)):
            raise TypeError("truth values or words")
        return np.array(raw, dtype=np.float64)
    except (TypeError, ValueError) as error:
        reason = "rows of different lengths" if "inhomogeneous" in str(error) else error
        raise ShapeError(
            f"{name}: expected numbers in rows of one length, {why}; got {reason}; give a full array"
        ) from None
    except OverflowError:
        raise NotFiniteError(f"{name}: expected numbers below 1.8e308; got a larger one; rescale it") from None


def describe_shape(shape: Shape) -> str:
    """A shape for people: ``(3, any)``."""
    sizes = ["any" if size is None else str(size) for size in shape]
    return f"({', '.join(sizes)}{',' if len(sizes) == 1 else ''})"


def freeze(array: Array) -> Array:
    """The same array, read-only from now on."""
    array.flags.writeable = False
    return array


def as_positive(name: str, value: Any, shape: Shape, why: str) -> Array:
    """Like :func:`as_array`, and every entry above zero (DomainError otherwise)."""
    array = as_array(name, value, shape, why)
    if array.min() <= 0.0:
        place = tuple(int(i) for i in np.argwhere(array <= 0.0)[0])
        raise DomainError(f"{name}: expected positive numbers; got {array[place]} at index {place}; {why}")
    return array


def as_covariance(name: str, value: Any, n: int | None) -> Array:
    """A covariance matrix (n, n): symmetric and positive semidefinite, made exactly symmetric.

    Asymmetry (1e-12) and negative eigenvalues (1e-9) of the size of rounding pass, in units in which the variances
    are 1; a negative variance does not, nor a covariance with a state whose variance is zero.

    Raises ShapeError, NotFiniteError, EmptyError, DomainError.
    """
    array = as_array(name, value, (n, n), "a covariance, states by states")
    if array.shape[0] != array.shape[1]:
        raise ShapeError(f"{name}: expected a square covariance; got {array.shape}; give all rows")
    variances = np.diagonal(array)
    if variances.min() < 0.0:
        i = int(variances.argmin())
        least = float(np.linalg.eigvalsh(0.5 * array + 0.5 * array.T)[0])
        raise DomainError(
            f"{name}: expected a positive semidefinite covariance; got the eigenvalue {least:.6g}, "
            f"for [{i}, {i}] = {variances[i]}; mend this variance"
        )
    # Units in which the variances are 1: what is small beside one variance may be large beside another.
    scale = np.sqrt(np.where(variances > 0.0, variances, 1.0))
    unit = array / scale[:, None] / scale
    asymmetry = np.abs(unit - unit.T)
    if asymmetry.max() > ASYMMETRY:
        i, j = sorted(int(k) for k in np.unravel_index(asymmetry.argmax(), array.shape))
        pair = f"[{i}, {j}] = {array[i, j]} against [{j}, {i}] = {array[j, i]}"
        raise DomainError(f"{name}: expected a symmetric covariance; got {pair}; symmetrise it")
    least = float(np.linalg.eigvalsh(0.5 * unit + 0.5 * unit.T)[0])
    if least < -SLACK:
        raise DomainError(
            f"{name}: expected a positive semidefinite covariance; got the eigenvalue {least:.6g}, variances taken for "
            "1; mend its entries"
        )
    return freeze(0.5 * array + 0.5 * array.T)


def as_probabilities(name: str, value: Any, k: int | None = None) -> Array:
    """A probability vector (k,): entries in [0, 1] that sum to one, scaled to do so exactly.

    Raises DomainError for a negative entry or a sum that differs from one by more than 1e-9.
    """
    array = as_array(name, value, (k,), "one probability per mode")
    return freeze(scale_rows(name, array[np.newaxis])[0])


def as_transition(name: str, value: Any, k: int | None = None) -> Array:
    """A matrix of transition probabilities (k, k), entry [i, j] leads from i to j; rows sum to one."""
    array = as_array(name, value, (k, k), "rows = from, columns = to")
    if array.shape[0] != array.shape[1]:
        raise ShapeError(f"{name}: expected a square matrix; got {array.shape}; rows = from, columns = to")
    return freeze(scale_rows(name, array))


def scale_rows(name: str, array: Array) -> Array:
    """Rows of probabilities divided by their sums; DomainError when they are none."""
    if array.min() < 0.0:
        raise DomainError(f"{name}: expected probabilities; got the negative entry {array.min()}; mend it")
    sums = array.sum(axis=1, keepdims=True)
    worst = int(np.abs(sums - 1.0).argmax())
    if abs(float(sums[worst, 0]) - 1.0) > SLACK:
        raise DomainError(
            f"{name}: expected probabilities that sum to 1; got others: row {worst} sums to {sums[worst, 0]:.12g}; "
            "divide it by its sum"
        )
    return array / sums
