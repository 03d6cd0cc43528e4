"""What the stream remembers: epochs and their measurements, referred to the state at one time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from flint import arb, arb_mat, fmpq

from navsym.core.errors import TooLargeError
from navsym.guaranteed.search.cones import Cone
from navsym.guaranteed.streaming.exchange import Cloud
from navsym.guaranteed.streaming.flow import Flow, Together
from navsym.guaranteed.streaming.numbers import to_float

MOST_ROWS = 200_000
#: Steps whose transitions are one stride, see Flow.long_exponential.
STRIDE = 64


@dataclass(frozen=True, slots=True)
class Row:
    """One measurement: time, place in the model, value and bound; the bound also as exact text.

    own : the bound that was given with the measurement, None where it is the model's
    """

    t: fmpq
    j: int
    z: fmpq
    sigma: arb
    text: str
    own: fmpq | None


def group_rows(flow: Flow, rows: Sequence[Row]) -> list[tuple[Together, list[int]]]:
    """Rows of one time that are bounded together, by their places; rows by themselves are left out."""
    if not flow.blocks:
        return []
    at: dict[tuple[int, int, int], int] = {(int(r.t.p), int(r.t.q), r.j): i for i, r in enumerate(rows)}
    times = dict.fromkeys((p, q) for p, q, _ in at)
    found = [(block, [at[*t, j] for j in block.members if (*t, j) in at]) for t in times for block in flow.blocks]
    return [(block, places) for block, places in found if len(places) > 1]


def list_cones(flow: Flow, rows: Sequence[Row], first: int = 0) -> list[tuple[Cone, list[int]]]:
    """The same with the noise that they may have together, in balls; places begin with ``first``."""
    found = []
    for block, places in group_rows(flow, rows):
        here = [rows[i] for i in places]
        size = block.size([row.j for row in here], [row.sigma for row in here], arb_mat)
        found.append((Cone(block.norm, size), [i + first for i in places]))
    return found


class Memory:
    """Rows ``v_i = h_j(t_i) Phi(t_i, reference)``, balls and doubles, in the order of time.

    Lists grow at their end; what leaves is counted in ``first`` (rows) and ``oldest`` (epochs) and dropped when half
    of a list has left, into new lists, so that an estimate that holds the old ones stays as it is.
    """

    def __init__(self, flow: Flow, length: int | None):
        self.flow, self.length = flow, length
        self.reference: fmpq | None = None
        self.times: list[fmpq] = []
        self.counts: list[int] = []
        self.rows: list[Row] = []
        self.vectors: list[arb_mat] = []
        self.sigmas: list[arb] = []
        self.data: list[arb] = []
        self.cones: list[tuple[Cone, list[int]]] = []
        self.first = self.oldest = 0
        self.gone = 0  # epochs that have left since the reference time was chosen
        self.moved = 0  # rows that were dropped from the lists
        self.since: fmpq | None = None  # the oldest epoch when doubles last left no room for those before
        self.scaled = np.zeros((64, flow.size))
        self.shifted = np.zeros(64)
        self.wide = 0.0
        self.seen: Counter[int] = Counter()
        self.carry: arb_mat | None = None

    def __len__(self) -> int:
        return len(self.rows) - self.first

    def add(self, at: fmpq, taken: Sequence[tuple[int, fmpq, fmpq | None]]) -> None:
        """Put an epoch in; where the memory is full the oldest leaves. Call it at the working precision."""
        if len(self) + len(taken) > MOST_ROWS:
            message = f"expected at most {MOST_ROWS} measurements in memory; got more; give a memory (--memory)"
            raise TooLargeError(message, where="Guard")
        if self.reference is None:
            self.reference = at
        elif self.flow.stride == 0:
            self.flow.stride = (at - self.times[-1]) * STRIDE
        rows = []
        for j, z, own in taken:
            sigma, text = (arb(own), str(own)) if own is not None else self.flow.sigma(j, at)
            rows.append(Row(at, j, z, sigma, text, own))
        self.seen.update(row.j for row in rows)
        kept, n = vars(self).copy(), len(self.rows)
        try:
            self.fill([at], [len(rows)], rows)
        except OverflowError:
            self.restore(kept, n)
            self.times, self.counts, self.rows = [*self.times, at], [*self.counts, len(rows)], [*self.rows, *rows]
            if self.length is not None and len(self.times) - self.oldest > self.length:
                self.forget()
            self.refer_within_doubles()
        if self.length is not None and len(self.times) - self.oldest > self.length:
            self.forget()

    @property
    def restart(self) -> float | None:
        """The oldest epoch, where those before left for want of room in doubles."""
        return to_float(self.since) if self.since is not None and self.times[self.oldest] == self.since else None

    def forget(self) -> None:
        """The oldest epoch leaves."""
        self.seen.subtract(row.j for row in self.rows[self.first : self.first + self.counts[self.oldest]])
        self.first += self.counts[self.oldest]
        self.oldest += 1
        self.gone += 1

    def refer_within_doubles(self) -> None:
        """Refer to the oldest epoch in memory, or to the newest where doubles overflow; the oldest leave where both do.

        Half of the epochs leave at once, so that few tries are made. Raises TooLargeError where one epoch overflows.
        """
        while True:
            for reference in (self.times[self.oldest], self.times[-1]):
                kept, n = vars(self).copy(), len(self.rows)
                try:
                    return self.refer(reference)
                except OverflowError:
                    self.restore(kept, n)
            if len(self.times) - self.oldest == 1:
                message = "expected regressors within the range of doubles; got an overflow; scale the unknowns"
                raise TooLargeError(message, where="Guard")
            for _ in range((len(self.times) - self.oldest + 1) // 2):
                self.forget()
            self.since = self.times[self.oldest]

    def put(self, row: Row) -> None:
        """A row at the end of all lists."""
        n = len(self.rows)
        if n == len(self.scaled):
            self.scaled = np.concatenate([self.scaled, np.zeros_like(self.scaled)])
            self.shifted = np.concatenate([self.shifted, np.zeros_like(self.shifted)])
        h = self.flow.row(row.j, row.t)
        vector = self.flow.cut(h if self.carry is None else h * self.carry)
        parts, z = (vector / row.sigma).entries(), arb(row.z)
        scaled, shifted = [*map(float, parts)], float(z / row.sigma)
        if not isfinite(shifted):
            message = "expected z/sigma within the range of doubles; got an overflow; scale z"
            raise TooLargeError(message, where="Guard")
        if not all(map(isfinite, scaled)):
            raise OverflowError("regressors")
        self.scaled[n] = scaled
        self.wide = max(self.wide, *(float(e.rad()) for e in parts))
        self.shifted[n] = shifted
        self.rows.append(row)
        self.vectors.append(vector)
        self.sigmas.append(row.sigma)
        self.data.append(z)

    def take_back(self, before: tuple[Any, ...]) -> None:
        """The state that :meth:`mark` described."""
        kept, epochs, rows, (self.flow.stride, self.flow.columns, self.flow.size) = before
        self.restore(kept, rows)
        for entries in (self.times, self.counts):
            del entries[epochs:]
        self.seen = Counter(row.j for row in self.rows[self.first :])

    def restore(self, kept: dict[str, Any], rows: int) -> None:
        """The lists of before, without the rows that have joined them since."""
        self.__dict__.update(kept)
        for column in (self.rows, self.vectors, self.sigmas, self.data):
            del column[rows:]  # type: ignore[attr-defined]
        self.cones = [pair for pair in self.cones if pair[1][0] < rows]

    def mark(self) -> tuple[Any, ...]:
        """What :meth:`take_back` needs: the lists themselves, since other unknowns make new ones, and their lengths."""
        flow = self.flow
        return vars(self).copy(), len(self.times), len(self.rows), (flow.stride, flow.columns, flow.size)

    def refer(self, reference: fmpq) -> None:
        """Drop what has left, and refer everything to a time."""
        times, counts, rows = self.times[self.oldest :], self.counts[self.oldest :], self.rows[self.first :]
        self.times, self.counts, self.rows, self.vectors, self.sigmas, self.data = [], [], [], [], [], []
        self.cones = []
        self.widen()
        self.moved += self.first
        self.first = self.oldest = self.gone = 0
        self.reference = reference
        self.fill(times, counts, rows)

    def widen(self) -> None:
        """Room for rows of the present number of unknowns."""
        self.scaled, self.shifted = np.zeros((len(self.scaled), self.flow.size)), np.zeros(len(self.shifted))
        self.wide = 0.0

    def kinds(self) -> frozenset[int]:
        """The measurements of the model that are in memory."""
        return frozenset(j for j, count in self.seen.items() if count)

    def fill(self, times: Sequence[fmpq], counts: Sequence[int], rows: Sequence[Row]) -> None:
        """Put known epochs in again, referred to the reference time as it is."""
        entries = iter(rows)
        for at, count in zip(times, counts, strict=True):
            self.carry = self.flow.transition(self.reference, at)  # type: ignore[arg-type]
            for _ in range(count):
                self.put(next(entries))
            self.times.append(at)
            self.counts.append(count)
            start = len(self.rows) - count
            self.cones += list_cones(self.flow, self.rows[start:], start)

    def cloud(self, *, data: bool = False, first: int | None = None) -> Cloud:
        """The rows in memory, or from a place on, as the exchange takes them; with measurements where they matter."""
        first = self.first if first is None else first
        window = slice(first, len(self.rows))
        return Cloud(
            self.vectors,
            self.sigmas,
            self.scaled[window],
            self.data if data else (),
            self.shifted[window] if data else None,
            self.wide,
            first,
            cones=[pair for pair in self.cones if pair[1][0] >= first],
        )

    def target(self) -> arb_mat:
        """P Phi(now, reference)."""
        row = self.flow.row_of_target
        return self.flow.cut(row if self.carry is None else row * self.carry)
