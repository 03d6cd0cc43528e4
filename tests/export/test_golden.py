"""Generated code is compared with files that were read by people. ``python tests/export/test_golden.py --update``."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from navsym.export.package import Order, files_of
from navsym.export.targets import TARGETS

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "export"
LANGUAGES = ("c", "cpp", "python", "javascript", "rust", "fortran", "julia", "octave")


def generated(samples) -> dict[str, str]:
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
def fresh(samples) -> dict[str, str]:
    return generated(samples)


def test_the_same_files_are_generated(fresh: dict[str, str]) -> None:
    assert sorted(fresh) == sorted(stored())


@pytest.mark.parametrize("language", (*LANGUAGES, "certificates"))
def test_generated_code_is_the_code_that_was_read(fresh: dict[str, str], language: str) -> None:
    golden = stored()
    for name, text in fresh.items():
        if name.startswith(f"{language}/"):
            assert text == golden.get(name), f"{name} differs; read it, then run this file with --update"


def update() -> None:
    sys.path.insert(0, str(Path(__file__).parent))
    import samples

    for path in GOLDEN.rglob("*.golden"):
        path.unlink()
    for name, text in generated(samples).items():
        path = GOLDEN / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


if __name__ == "__main__" and "--update" in sys.argv:
    update()
