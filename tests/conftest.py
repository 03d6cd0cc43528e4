"""What all tests share: reproducible random examples, no colours, no windows."""

from __future__ import annotations

import os

import pytest
from hypothesis import settings

# Examples are the same on every machine and every run; a shared machine may be slow, so no deadline.
settings.register_profile("navsym", derandomize=True, deadline=None, max_examples=50, database=None)
settings.load_profile("navsym")

os.environ["NO_COLOR"] = "1"
os.environ["MPLBACKEND"] = "Agg"
os.environ.pop("NAVSYM_DEBUG", None)


def pytest_collection_modifyitems(items):
    """Slow tests have twice the time before they count as waiting for ever."""
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.timeout(1800))
