"""What all tests share: reproducible random examples, no colours, no windows."""

from __future__ import annotations

import gc
import os
import re

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers
from xdist.scheduler import LoadScopeScheduling

from navsym.core import loops

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

#: Tests that are grouped by the paper or notebook that is their first parameter.
APART = re.compile(
    r"tests/(?:derivations/test_(?:papers|power|mutants|rules)|fidelity/test_(?:statements|units)|test_notebooks)\.py"
    r"::\w+\[(\d*[a-z_]+)(?:-|\])"
)
#: Files of the export whose sample functions and programs are decided once for all of them.
EXPORT = re.compile(
    r"tests/export/test_(?:batch|golden|helpers|hostile|languages|octave|overflow|reading|refusal|rounding|steps|sweep|tools)\.py"
)

os.environ["NO_COLOR"] = "1"
os.environ["MPLBACKEND"] = "Agg"
os.environ.pop("NAVSYM_DEBUG", None)


class Groups(LoadScopeScheduling):
    """One worker runs a whole file, so that what a file prepares is prepared once.

    Papers and notebooks are groups of their own: the statements of a paper are derived once for the tests of several
    files, and no worker waits for all notebooks. What many files of the export share is one group, too.
    """

    def _split_scope(self, nodeid: str) -> str:
        found = APART.match(nodeid)
        return found[1] if found else "export" if EXPORT.match(nodeid) else nodeid.split("::")[0]


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Stand in for xdist's own ``loadgroup``, which needs an attribute that pytest no longer has."""
    return Groups(config, log) if config.getvalue("dist") == "loadgroup" else None


def pytest_configure(config):
    """Interpret the exchange in short runs: both forms give the same bits, and to compile it takes longer than that."""
    if "not long" in config.getoption("markexpr"):
        loops.TO_COMPILE = 1e9


def pytest_collection_modifyitems(items):
    """Slow tests have twice the time before they count as waiting for ever."""
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.timeout(1800))


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Thousands of collected tests stay to the end: the collector of garbage looks neither for them nor through them.

    It works for the tests, whose many small formulas end by their counts, at every tenth of its usual times.
    """
    gc.disable()
    found = yield
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)
    gc.enable()
    return found
