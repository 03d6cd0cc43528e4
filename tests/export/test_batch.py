"""Batches: many points at once, in memory that is used again and never while somebody holds it."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from navsym.export.languages import batch
from navsym.export.languages.targets import TARGETS
from tests.export import samples

pytestmark = pytest.mark.skipif(TARGETS["batch"].executable() is None, reason="needs gcc")
LARGE = 70_001  # rows that end nowhere near a multiple of a wide store, and more bytes than CACHE


@pytest.fixture(scope="module")
def module(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """Phi33 and a matrix of four results, compiled."""
    folder: Path = tmp_path_factory.mktemp("batch")
    functions = [samples.by_name("Phi33"), samples.by_name("rotation")]
    for name, text in batch.files(functions, {f.name: [] for f in functions}, "").items():
        (folder / name).write_text(text)
    spec = importlib.util.spec_from_file_location("navsym_batch_under_test", folder / "navsym_batch.py")
    assert spec and spec.loader
    found = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = found
    spec.loader.exec_module(found)
    return found


def points(n: int, widest: float = 3.0) -> np.ndarray:
    """beta and lambda, as the rows of the batch have them."""
    return np.vstack([np.linspace(0.125, 2, n), np.linspace(-widest, widest, n)])


def address(array: np.ndarray) -> int:
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("n", [0, 1, 7, 512, 513, 200_003])
def test_results_do_not_depend_on_the_size_of_the_batch(module, n: int) -> None:
    beta, angle = points(n)
    found = module.sample_rotation(points(n))
    exact = [np.cos(angle), np.sin(angle) / beta, -beta * np.sin(angle), np.cos(angle)]
    assert found.shape == (4, n)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-13)


def test_memory_of_a_result_that_nobody_holds_is_used_again(module) -> None:
    places = set()
    for _ in range(6):  # while a result is held, the next one lies elsewhere
        result = module.sample_rotation(points(LARGE))
        places.add(address(result))
    del result
    assert len(places) == 2


def test_a_result_that_is_held_is_never_written_again(module) -> None:
    rows = [module.sample_rotation(points(LARGE, widest))[1] for widest in (1.0, 2.0, 3.0)]
    copies = [row.copy() for row in rows]
    for _ in range(5):
        module.sample_rotation(points(LARGE))[:] = 7.0
    for row, copy in zip(rows, copies, strict=True):
        np.testing.assert_array_equal(row, copy)


def test_a_given_array_is_filled_and_a_wrong_one_refused(module) -> None:
    given, out = points(LARGE), np.empty((4, LARGE))
    assert module.sample_rotation(given, out) is out
    np.testing.assert_array_equal(out, module.sample_rotation(given))
    for wrong in (np.empty((3, LARGE)), np.empty((4, LARGE), dtype=np.float32), np.empty((LARGE, 4)).T):
        with pytest.raises(ValueError, match="expected out"):
            module.sample_rotation(given, wrong)


def test_a_point_outside_the_domain_is_refused_wherever_it_stands(module) -> None:
    for place in (0, 511, LARGE - 1):
        given = points(LARGE)
        given[1, place] = np.nan
        with pytest.raises(ValueError, match="proved domain"):
            module.sample_rotation(given)
