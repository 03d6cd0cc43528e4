"""One operator of generated code is changed at a time; the vectors must notice.

    python tests/export/corruption.py [NAME…] [--languages c,python,…] [--each N]

Prints how many corruptions of every function and language were tried and which were not noticed; N of every
function (0: all of them).
"""

from __future__ import annotations

import argparse
import random
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from navsym.export.package import Order, files_of
from navsym.export.roundtrip import run_target
from navsym.export.targets import TARGETS

OTHER = {"+": "-", "-": "+", "*": "/", "/": "*"}
SWAPS = {"sin(": "cos(", "cos(": "sin("}
ASSIGNMENT = re.compile(
    r"^\s+(?:(?:const|let)\s+(?:double\s+|auto\s+)?)?(?:[\w.\[\]: ]+|out\[[^=]*\]|nv_r\(\d+\)) = .*|^\s{12,}.*,$"
)
RESULT = re.compile(r"^\s+(?:r\d+|result\.[\w\[\]]+|nv_r\(\d+\)|out\[[^=]*\]) = ([^;\n]+)", re.M)
SOURCE_OF = {
    "c": "{name}.c", "cpp": "navsym_functions.hpp", "python": "navsym_functions.py", "wasm": "{name}.c",
    "javascript": "navsym_functions.mjs", "rust": "navsym_functions.rs", "fortran": "navsym_functions.f90",
    "julia": "NavsymFunctions.jl", "octave": "{name}.m", "batch": "navsym_batch.c",
}  # fmt: skip


def corrupted(text: str, start: int, end: int) -> Iterator[tuple[str, str]]:
    """(what, text with one operator or function changed) for every one between two places."""
    place = start
    for line in text[start:end].splitlines(keepends=True):
        if ASSIGNMENT.match(line) and "status" not in line and "Formula" not in line:
            for found in re.finditer(r" ([-+*/]) |(?<![\w_])(?:sin|cos)\(", line.partition(" = ")[2] or line):
                old = found.group(0)
                new = SWAPS.get(old) or f" {OTHER[found.group(1)]} "
                at = place + (line.index(" = ") + 3 if " = " in line else 0) + found.start()
                yield f"{line.strip()} : {old} -> {new}", text[:at] + new + text[at + len(old) :]
        place += len(line)


def shifted(text: str, start: int, end: int) -> Iterator[tuple[str, str]]:
    """The same for code without operators: a result is off by one."""
    place = start
    for line in text[start:end].splitlines(keepends=True):
        if found := RESULT.match(line):
            at = place + found.end(1)
            yield f"{line.strip()} + 1.0", text[:at] + " + 1.0" + text[at:]
        elif re.match(r"^\s{12,}[^:]*,$", line) and "r = [" in text:
            at = place + len(line.rstrip()) - 1
            yield f"{line.strip()} + 1.0", text[:at] + " + 1.0" + text[at:]
        place += len(line)


def exported(functions, language: str, folder: Path, count: int = 16) -> Path:
    for name, text in files_of(functions, Order((TARGETS[language],), count=count)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder / language


def survivors(function, language: str, folder: Path, each: int = 0) -> tuple[int, list[str]]:
    """Number of corruptions of one function's source, and those that its vectors did not notice."""
    place = exported([function], language, folder)
    path = place / SOURCE_OF[language].format(name=function.name)
    original = path.read_text()
    start, end = body_of(original, function.name)
    ways = list(corrupted(original, start, end)) or list(shifted(original, start, end))
    if each:
        ways = random.Random(function.name).sample(ways, min(each, len(ways)))
    left = []
    for what, text in ways:
        path.write_text(text)
        if run_target(place, TARGETS[language]).status == "verified":
            left.append(what)
    path.write_text(original)
    return len(ways), left


def body_of(text: str, name: str) -> tuple[int, int]:
    """From the definition of a function to the first line that ends it."""
    defined = [m.start() for m in re.finditer(rf"(?<![\w]){re.escape(name)}(?:_at)?\s*\(", text)]
    for start in defined:
        after = text[start:]
        stop = re.search(r"^(?:\}|end\b|  end subroutine|    return _finite)", after, re.M)
        if stop and (RESULT.search(after, 0, stop.start()) or re.search(r"\br = \[", after[: stop.start()])):
            return start, start + stop.start()
    raise AssertionError(f"no body of {name}")


def campaign(names: list[str], languages: list[str], each: int, folder: Path) -> dict[str, Any]:
    """Corrupt ``each`` operators of every function of the named ready-made exports, in every language."""
    from navsym.cli.export import expanded, functions_for

    tried, left = 0, []
    for name in names:
        for function in (f for claim in expanded([name]) for f in functions_for(claim, "double", False)):
            for language in languages:
                count, alive = survivors(function, language, folder / function.name / language, each)
                tried += count
                left += [f"{language} {function.name}: {what}" for what in alive] + (
                    [f"{language} {function.name}: nothing to corrupt"] if not count else []
                )
    return {"tried": tried, "left": left}


def main() -> None:
    from navsym.export.ready import READY

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--languages", default=",".join(n for n in SOURCE_OF if TARGETS[n].executable()))
    parser.add_argument("--each", type=int, default=1)
    options = parser.parse_args()
    for name in options.names or READY:
        for language in options.languages.split(","):
            with tempfile.TemporaryDirectory() as folder:
                found = campaign([name], [language], options.each, Path(folder))
            said = f"{name:20} {language:11} corrupted {found['tried']:4} unnoticed {len(found['left'])}"
            print("\n    ".join([said, *found["left"]]), flush=True)


if __name__ == "__main__":
    main()
