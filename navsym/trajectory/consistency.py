"""Whether standard deviations hold: NIS from the recording itself, NEES from a reference, each with its 95 % band.

NIS is the mean of squared innovations over their predicted variance, NEES that of squared errors over their variance.
Both are one on average where the deviations hold. Errors of neighbouring rows are correlated: with the correlations
rho_k of normalised errors, N rows are worth ``N / (1 + 2 sum rho_k^2)`` independent ones, since products of Gaussians
have the squared correlation (Isserlis). Bar-Shalom, Li, Kirubarajan, Estimation with Applications, 2001, ch. 5.4.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from navsym.core.answers import named
from navsym.core.arrays import Array
from navsym.core.errors import EmptyError, NotFiniteError, ShapeError
from navsym.language.csvfile import read_numbers
from navsym.language.files import name_file

#: Numbers of a reference are smaller, so that their squares have values.
LARGEST = 1e15
#: Quantile of the normal distribution at 97.5 %.
Z975 = 1.959963984540054
#: Columns of a reference; the deviations may be left out.
COLUMNS, DEVIATIONS = ("t", "ve", "vn", "vu"), ("sd_ve", "sd_vn", "sd_vu")
#: Shifts of the reference's clock that are tried, s.
LAGS = np.arange(-40, 41) * 0.05
#: A shift is named when the mean falls by this factor; interpolation between noisy rows alone may halve it.
CLEARLY = 0.4


@dataclass(frozen=True, slots=True)
class Shift:
    """A shift of the reference's clock at which it fits far better.

    seconds, sd : how late the reference is, and the standard deviation of that; mean, parts : NEES there
    """

    seconds: float
    sd: float
    mean: float
    parts: tuple[float, float, float]

    def document(self) -> dict[str, Any]:
        """As part of a JSON document."""
        return named(self, "seconds sd mean parts")

    def __str__(self) -> str:
        side = "late" if self.seconds > 0 else "early"
        east, north, up = self.parts
        return (
            f"the reference fits best {abs(self.seconds):.3f} ± {self.sd:.2g} s {side}, NEES {self.mean:.3g} there "
            f"(E {east:.3g}, N {north:.3g}, U {up:.3g}): check both clocks"
        )


@dataclass(frozen=True, slots=True)
class Consistency:
    """A mean of squares that is one where standard deviations hold.

    mean : over rows and axes; parts: of East, North, Up; band : where 95 % of such means lie, for ``worth``
    independent squares; rows : that were compared; lag : shift of the reference's clock, or None
    """

    mean: float
    parts: tuple[float, float, float]
    band: tuple[float, float]
    rows: int
    worth: float
    lag: Shift | None = None

    @property
    def holds(self) -> bool:
        """Whether the mean lies in its band."""
        return self.band[0] <= self.mean <= self.band[1]

    def document(self) -> dict[str, Any]:
        """As part of a JSON document."""
        return named(self, "mean parts band rows" if self.lag is None else "mean parts band rows lag")


def consistency_of(normalised: Array) -> Consistency | None:
    """The mean of squares of normalised errors (N, 3) and its band; None without rows."""
    if len(normalised) == 0:
        return None
    squares = normalised**2
    worth = sum(independent(normalised[:, c]) for c in range(3))
    parts = tuple(float(value) for value in squares.mean(axis=0))
    return Consistency(float(squares.mean()), (parts[0], parts[1], parts[2]), band(worth), len(squares), worth)


def independent(errors: Array) -> float:
    """Independent squares that those of a series (N,) are worth: correlations up to the first that is not positive."""
    N, power = len(errors), float(errors @ errors)
    if power <= 0.0 or N < 8:
        return float(N)
    products = np.fft.irfft(np.abs(np.fft.rfft(errors, 2 * N)) ** 2, 2 * N)  # of all shifts at once
    rho = products[1 : N // 4] / power
    first = int(np.argmax(rho <= 0.0)) if (rho <= 0.0).any() else len(rho)
    return N / (1.0 + 2.0 * float(rho[:first] @ rho[:first]))


def band(count: float) -> tuple[float, float]:
    """Where 95 % of the means of ``count`` squares of independent normal numbers lie (Wilson and Hilferty 1931).

    >>> [round(x, 3) for x in band(100.0)]
    [0.742, 1.296]
    """
    spread = 2.0 / (9.0 * count)
    low, high = (max(1.0 - spread + sign * Z975 * math.sqrt(spread), 0.0) ** 3 for sign in (-1.0, 1.0))
    return low, high


def compare(t: Array, velocity: Array, deviation: Array, reference: str | os.PathLike[str] | Any) -> Consistency:
    """NEES of velocities (N, 3) with deviations (N, 3) at times t (N,) against a reference, interpolated linearly.

    reference : file with the columns t, ve, vn, vu, or an array (M, 4) of them: seconds and m/s, increasing times;
                three columns more, sd_ve, sd_vn, sd_vu, are the reference's own standard deviations
    Raises EmptyError where no row of the track lies within the times of the reference.
    """
    table, place = reference_table(reference)
    if table.ndim != 2 or table.shape[1] not in (4, 7) or len(table) < 2:
        message = f"expected rows of t, ve, vn, vu; got shape {table.shape}; give two rows or more"
        raise ShapeError(message, where=place)
    if not (np.abs(table) < LARGEST).all() or not (np.diff(table[:, 0]) > 0).all():
        message = f"expected numbers below {LARGEST:g} at increasing times; got others; mend the reference"
        raise NotFiniteError(message, where=place)
    found = consistency_of(normalised_at(0.0, t, velocity, deviation, table))
    if found is None:
        wanted, got = (f"{ends[0]:.10g} to {ends[-1]:.10g}" for ends in (t, table[:, 0]))
        message = f"expected times from {wanted}; got {got}; use one clock"
        raise EmptyError(message, where=place)
    shifted = [normalised_at(float(lag), t, velocity, deviation, table) for lag in LAGS]
    means = [float((errors**2).mean()) if len(errors) else math.inf for errors in shifted]
    best = int(np.argmin(means))
    if means[best] >= CLEARLY * found.mean:
        return found
    whole = consistency_of(shifted[best])
    assert whole is not None
    return replace(found, lag=shift_of(best, means, whole))


def shift_of(best: int, means: list[float], whole: Consistency) -> Shift:
    """The least of the parabola through three neighbouring means, and its deviation.

    The mean of squares at its least is the variance of one error, and ``whole.worth`` of them are independent: the
    information of the shift is ``worth d²mean / (2 mean)``. Without two neighbours it is that of the grid.
    """
    step = float(LAGS[1] - LAGS[0])
    before, least, after = (means[k] if 0 <= k < len(means) else math.inf for k in (best - 1, best, best + 1))
    bend = before - 2 * least + after
    if not (0.0 < bend < math.inf):
        return Shift(float(LAGS[best]), step, least, whole.parts)
    away = step * (before - after) / (2 * bend)
    sd = step * math.sqrt(2 * least / (whole.worth * bend))
    return Shift(float(LAGS[best]) + away, sd, least, whole.parts)


def normalised_at(lag: float, t: Array, velocity: Array, deviation: Array, table: Array) -> Array:
    """Errors over their deviations (K, 3) of the rows within the times of a reference that is ``lag`` late."""
    inside = (t + lag >= table[0, 0]) & (t + lag <= table[-1, 0])
    columns = [np.interp(t[inside] + lag, table[:, 0], column) for column in table[:, 1:].T]
    own = np.stack(columns[3:], axis=1) if len(columns) > 3 else 0.0
    error = velocity[inside] - np.stack(columns[:3], axis=1)
    return np.asarray(error / np.sqrt(deviation[inside] ** 2 + np.square(own)))


def reference_table(reference: Any) -> tuple[Array, str]:
    """The numbers of a reference (M, 4), or (M, 7) with its deviations, and its place in errors."""
    if not isinstance(reference, str | os.PathLike):
        try:
            return np.array(reference, dtype=float), "track: reference"
        except (TypeError, ValueError):
            raise ShapeError("expected rows of t, ve, vn, vu; got others", where="track: reference") from None
    found = read_numbers(reference, ((*COLUMNS, *DEVIATIONS), COLUMNS))
    return np.array(list(found.values())).T, name_file(reference)
