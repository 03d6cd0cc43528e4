"""Generated code is compared with files that were read by people. ``python tests/export/test_golden.py --update``."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from navsym.export.languages.targets import TARGETS
from navsym.export.package import Order, files_of
from navsym.export.ready import READY
from tests.export import samples

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "export"
READY_GOLDEN = GOLDEN.with_name("export-ready")
READY_LANGUAGES = ("c", "cpp", "python", "javascript", "rust", "octave")
VECTORS = 2
LANGUAGES = ("c", "cpp", "python", "javascript", "rust", "fortran", "julia", "octave")


def generated() -> dict[str, str]:
    functions = [samples.by_name(name) for name in ("Phi33", "velocity_correction_y3", "versine")]
    order = Order(tuple(TARGETS[name] for name in LANGUAGES), count=6)
    files = files_of(functions, order)
    return {f"{name}.golden": text for name, text in files.items() if kept(name)}


def kept(name: str) -> bool:
    """Code of every language, and one formula's certificates."""
    return name != "manifest.json" and (not name.startswith("certificates/") or "Phi33" in name)


def stored() -> dict[str, str]:
    return {p.relative_to(GOLDEN).as_posix(): p.read_text() for p in sorted(GOLDEN.rglob("*.golden"))}


@pytest.fixture(scope="module")
def fresh() -> dict[str, str]:
    return generated()


def test_the_same_files_are_generated(fresh: dict[str, str]) -> None:
    assert sorted(fresh) == sorted(stored())


@pytest.mark.parametrize("language", (*LANGUAGES, "certificates"))
def test_generated_code_is_the_code_that_was_read(fresh: dict[str, str], language: str) -> None:
    golden = stored()
    for name, text in fresh.items():
        if name.startswith(f"{language}/"):
            assert text == golden.get(name), f"{name} differs; read it, then run this file with --update"


# -- every ready-made export ---------------------------------------


def ready_functions(name: str) -> list:
    from navsym.export.materials import functions_from

    return functions_from(name)


def ready_files(name: str) -> dict[str, str]:
    """Code in six languages and the certificates; tests and vectors are made by the same writers as above."""
    files = files_of(ready_functions(name), Order(tuple(TARGETS[n] for n in READY_LANGUAGES), count=VECTORS))
    words = ("test_", "vectors.", "CMakeLists", "MISRA", "manifest")
    return {f"{n}.golden": text for n, text in files.items() if not n.rpartition("/")[2].startswith(words)}


@pytest.mark.parametrize("name", READY)
def test_every_ready_made_export_is_the_code_that_was_read(name: str) -> None:
    folder, fresh = READY_GOLDEN / name, ready_files(name)
    golden = {p.relative_to(folder).as_posix(): p.read_text() for p in sorted(folder.rglob("*.golden"))}
    assert sorted(fresh) == sorted(golden)
    changed = [file for file, text in fresh.items() if text != golden[file]]
    assert not changed, f"{changed} differ; read them, then run this file with --update"


def rewrite(folder: Path, files: dict[str, str]) -> None:
    for path in folder.rglob("*.golden"):
        path.unlink()
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def update() -> None:

    rewrite(GOLDEN, generated())
    for name in READY:
        rewrite(READY_GOLDEN / name, ready_files(name))


if __name__ == "__main__" and "--update" in sys.argv:
    update()
