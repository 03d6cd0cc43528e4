"""What all tests share: reproducible random examples, no colours, no windows."""

from __future__ import annotations

import os

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers

# Examples are the same on every machine and every run; a shared machine may be slow, so no deadline. They would differ
# with the modules that happen to be loaded, whose constants hypothesis also tries, hence with the worker that runs a
# test: so none of these are taken. NAVSYM_EXAMPLES=random looks for new ones, constants of the modules included.
settings.register_profile("navsym", derandomize=True, deadline=None, max_examples=50, database=None)
settings.register_profile("random", deadline=None, max_examples=200, database=None, print_blob=True)
if os.environ.get("NAVSYM_EXAMPLES") == "random":
    settings.load_profile("random")
else:
    settings.load_profile("navsym")
    providers._get_local_constants = lambda: providers._local_constants

os.environ["NO_COLOR"] = "1"
os.environ["MPLBACKEND"] = "Agg"
os.environ.pop("NAVSYM_DEBUG", None)


def pytest_collection_modifyitems(items):
    """Every file is a group of tests that one worker runs, unless its tests name groups of their own.

    What a file prepares is prepared once. Slow tests have twice the time before they count as waiting for ever.
    """
    for item in items:
        if not item.get_closest_marker("xdist_group"):
            item.add_marker(pytest.mark.xdist_group(item.location[0]))
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.timeout(1800))
