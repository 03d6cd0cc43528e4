"""Generated code is compared with files that were read by people. ``python tests/export/test_golden.py --update``.

Three formulas in every language, those included that no compiler here runs, and one program in six. What other exports
compute is checked by running them.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import pytest

from navsym.export.languages.targets import TARGETS
from navsym.export.package import Order, files_of
from tests.export import programs, samples

GOLDEN = Path(__file__).resolve().parents[1] / "golden"
LANGUAGES = {
    "formulas": ("c", "cpp", "python", "javascript", "rust", "fortran", "julia", "octave"),
    "program": ("c", "cpp", "python", "javascript", "rust", "octave"),
}


@cache
def generated(name: str) -> dict[str, str]:
    """The files that are compared, by their place in the folder."""
    if name == "formulas":
        functions, count = [samples.by_name(one) for one in ("Phi33", "velocity_correction_y3", "versine")], 6
    else:
        functions, count = list(programs.functions("trajectory-filter")), 2
    files = files_of(functions, Order(tuple(TARGETS[language] for language in LANGUAGES[name]), count=count))
    return {f"{file}.golden": text for file, text in files.items() if is_read(name, file)}


def is_read(name: str, file: str) -> bool:
    """True for files that people read: code, and the certificates of one formula and of the program."""
    folder, _, plain = file.rpartition("/")
    if name == "formulas":
        return plain != "manifest.json" and (folder != "certificates" or "Phi33" in plain)
    return not plain.startswith(("manifest", "test_", "vectors.", "CMakeLists", "MISRA"))


def stored(name: str) -> dict[str, str]:
    return {p.relative_to(GOLDEN / name).as_posix(): p.read_text() for p in sorted((GOLDEN / name).rglob("*.golden"))}


@pytest.mark.parametrize("name", LANGUAGES)
def test_the_same_files_are_generated(name: str) -> None:
    assert sorted(generated(name)) == sorted(stored(name))


@pytest.mark.parametrize(
    ("name", "language"), [(name, folder) for name in LANGUAGES for folder in (*LANGUAGES[name], "certificates")]
)
def test_generated_code_is_the_code_that_was_read(name: str, language: str) -> None:
    golden = stored(name)
    for file, text in generated(name).items():
        if file.startswith(f"{language}/"):
            assert text == golden.get(file), f"{file} differs; read it, then run this file with --update"


def update() -> None:
    """Write the files again."""
    for name in LANGUAGES:
        for path in (GOLDEN / name).rglob("*.golden"):
            path.unlink()
        for file, text in generated(name).items():
            (GOLDEN / name / file).parent.mkdir(parents=True, exist_ok=True)
            (GOLDEN / name / file).write_text(text)


if __name__ == "__main__" and "--update" in sys.argv:
    update()
