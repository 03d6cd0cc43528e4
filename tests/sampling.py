"""Large tables of equal cases: some of them in every run, the others in the long ones."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import pytest


def thinned(rows: Iterable[Sequence[Any]], keep: int = 3) -> list[Any]:
    """Parameters of a test: each ``keep``-th row in every run, the others with the mark ``long``."""
    return [pytest.param(*row, marks=[pytest.mark.long] * (k % keep > 0)) for k, row in enumerate(rows)]
