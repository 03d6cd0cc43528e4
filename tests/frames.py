"""A stand-in for a data frame: columns by name and ``to_numpy``, as far as navsym uses one of pandas or polars."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np


class Frame:
    """A table of columns."""

    def __init__(self, columns: dict[Any, Sequence[float]]):
        self.columns = {name: np.asarray(values) for name, values in columns.items()}

    def keys(self) -> Iterator[Any]:
        return iter(self.columns)

    def __getitem__(self, name: Any) -> np.ndarray:
        return self.columns[name]

    def to_numpy(self) -> np.ndarray:
        return np.column_stack(list(self.columns.values()))
