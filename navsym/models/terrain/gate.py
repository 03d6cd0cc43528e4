"""What may enter a map, a track or a grid of hypotheses: checked once, copied, read-only."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.errors import DomainError, EmptyError, NotFiniteError, ShapeError

Array = NDArray[np.float64]


#: Sizes that no map, track or step in any unit has; within them no sum of squares overflows.
LARGEST, SMALLEST = 1e15, 1e-12


def put(owner: Any, name: str, value: Any) -> None:
    """Set a field of a frozen dataclass while it is being made."""
    object.__setattr__(owner, name, value)


def numbers(name: str, value: Any, ndim: int, why: str) -> Array:
    """A float copy of nested sequences of real numbers with ``ndim`` axes and at least one entry."""
    try:
        raw = np.asarray(value)
        if raw.dtype.kind not in "iufO":
            raise TypeError(f"entries of type {raw.dtype}")
        if raw.dtype.kind == "O" and any(isinstance(v, bool | str | bytes) for v in raw.flat):
            raise TypeError("truth values or words")
        array = np.array(raw, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as reason:
        raise ShapeError(f"{name}: expected numbers, {why}; got {reason!s:.80}; give a full array") from None
    if array.size == 0:
        raise EmptyError(f"{name}: expected numbers, {why}; got none; give at least one")
    if array.ndim != ndim:
        raise ShapeError(f"{name}: expected {ndim} axes, {why}; got shape {array.shape}; mend the nesting")
    return array


def all_finite(name: str, array: Array) -> Array:
    """The same array; NotFiniteError when it holds NaN or an infinity, DomainError above LARGEST."""
    if not np.isfinite(array).all():
        place = [int(i) for i in np.argwhere(~np.isfinite(array))[0]]
        raise NotFiniteError(
            f"{name}: expected finite numbers; got {array[tuple(place)]} at index {place}; remove or mend it"
        )
    if np.abs(array).max() > LARGEST:
        place = [int(i) for i in np.argwhere(np.abs(array) > LARGEST)[0]]
        raise DomainError(
            f"{name}: expected numbers below {LARGEST:g}; got {array[tuple(place)]:g} at index {place}; check the unit"
        )
    return array


def vector(name: str, value: Any, length: int | None, why: str) -> Array:
    """A read-only finite vector (length,)."""
    array = all_finite(name, numbers(name, value, 1, why))
    if length is not None and array.size != length:
        raise ShapeError(f"{name}: expected {length} entries, {why}; got {array.size}; give one for each")
    return frozen(array)


def frozen(array: Any) -> Any:
    """The same array, read-only from now on."""
    array.flags.writeable = False
    return array


def with_voids(heights: Any, nodata: float | None) -> Array:
    """A copy of a matrix of heights with NaN where ``nodata`` stood; other NaN are errors."""
    array = numbers("heights", heights, 2, "rows of y by columns of x")
    if nodata is None:
        return all_finite("heights", array)
    voids = np.isnan(array) if math.isnan(nodata) else array == nodata
    all_finite("heights", np.where(voids, 0.0, array))
    array[voids] = np.nan
    return array


def finite(name: str, value: Any) -> float:
    """A finite float; DomainError otherwise."""
    try:
        number = math.nan if isinstance(value, str | bytes | bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not abs(number) <= LARGEST:
        raise DomainError(f"{name}: expected a finite number below {LARGEST:g}; got {value!r:.60}; mend it")
    return number


def spacing(name: str, value: Any) -> float:
    """A positive float; the message for a negative one says what to do with north-up rasters."""
    number = finite(name, value)
    if number < SMALLEST:
        raise DomainError(
            f"{name}: expected a positive spacing; got {number:g}; "
            "reverse the rows (or columns) so that y (or x) grows with the index"
        )
    return number


def pair(name: str, value: Any) -> Sequence[Any]:
    """Two entries, for x and y; ShapeError otherwise."""
    if isinstance(value, str | bytes) or not hasattr(value, "__len__") or len(value) != 2:
        raise ShapeError(f"{name}: expected two entries, for x and y; got {value!r:.60}; give both")
    return list(value)


def step(name: str, value: Any) -> float:
    """A positive length; DomainError otherwise."""
    number = finite(name, value)
    if number < SMALLEST:
        raise DomainError(f"{name}: expected a positive step; got {value!r:.60}; give its length")
    return number


def count(name: str, value: Any) -> int:
    """An integer of at least 0; DomainError otherwise."""
    number = finite(name, value)
    if number != int(number) or number < 0:
        raise DomainError(f"{name}: expected an integer of at least 0; got {value!r:.60}; indices run from -N to N")
    return int(number)
