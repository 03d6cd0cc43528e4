"""One operator of generated code is changed at a time; the vectors must notice.

    python tests/export/corruption.py [NAME…] [--languages c,python,…] [--each N] [--write PAGE.md]

Prints how many corruptions of every function and language were tried and which were not noticed; N of every
function (0: all of them).
"""

from __future__ import annotations

import argparse
import json
import platform
import random
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from navsym.export.languages.targets import TARGETS
from navsym.export.package import Order, files_of
from navsym.export.roundtrip import run_target

OTHER = {"+": "-", "-": "+", "*": "/", "/": "*"}
SWAPS = {"sin(": "cos(", "cos(": "sin("}
ASSIGNMENT = re.compile(
    r"^\s+(?:(?:const|let)\s+(?:double\s+|auto\s+)?)?(?:[\w.\[\]: ]+|out\[[^=]*\]|nv_r\(\d+\)) = .*|^\s{12,}.*,$"
)
RESULT = re.compile(r"^\s+(?:r\d+|result\.(?!status)[\w\[\]]+|nv_r\(\d+\)|out\[[^=]*\]|\w+\[k\]) = ([^;\n]+)", re.M)
SOURCE_OF = {
    "c": "{name}.c",
    "cpp": "navsym_functions.hpp",
    "python": "navsym_functions.py",
    "wasm": "{name}.c",
    "javascript": "navsym_functions.mjs",
    "rust": "navsym_functions.rs",
    "fortran": "navsym_functions.f90",
    "julia": "NavsymFunctions.jl",
    "octave": "{name}.m",
    "batch": "navsym_batch.c",
}


def corrupted(text: str, start: int, end: int) -> Iterator[tuple[str, str]]:
    """(what, text with one operator or function changed) for every one between two places."""
    place = start
    for line in text[start:end].splitlines(keepends=True):
        if ASSIGNMENT.match(line) and not any(word in line for word in ("status", "Formula", "NAVSYM_BLOCK")):
            # (0 * n) is the place of a batch's first row: 0 / n is the same
            for found in re.finditer(r"(?<!\(0) ([-+*/]) |(?<![\w_])(?:sin|cos)\(", line.partition(" = ")[2] or line):
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
        elif re.match(r"^\s{12,}[^:]*,$", line) and "nv_r = [" in text:
            at = place + len(line.rstrip()) - 1
            yield f"{line.strip()} + 1.0", text[:at] + " + 1.0" + text[at:]
        place += len(line)


def exported(functions, language: str, folder: Path, count: int = 16) -> Path:
    for name, text in files_of(functions, Order((TARGETS[language],), count=count)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder / language


def with_its_start(function) -> list[Any]:
    """A step together with the function that makes its first state: neither compiles without the other."""
    return [function.state.init, function] if function.state else [function]


def survivors(function, language: str, folder: Path, each: int = 0) -> tuple[int, list[str]]:
    """Number of corruptions of one function's source, and those that its vectors did not notice."""
    place = exported(with_its_start(function), language, folder)
    path = place / SOURCE_OF[language].format(name=function.name)
    original = path.read_text()
    start, end = body_of(original, function.name)
    ways = list(corrupted(original, start, end)) or list(shifted(original, start, end))
    if each:
        ways = random.Random(function.name).sample(ways, min(each, len(ways)))
    left = []
    for what, text in ways:
        path.write_text(text)
        outcome = run_target(place, TARGETS[language])
        if not outcome.functions.get(function.name, (0, 0, 0))[1]:  # a compiler that stops says nothing of vectors
            left.append(f"{what} ({outcome.status} {outcome.why})")
    path.write_text(original)
    return len(ways), left


def body_of(text: str, name: str) -> tuple[int, int]:
    """From the definition of a function to the first line that ends it."""
    defined = [m.start() for m in re.finditer(rf"(?<![\w]){re.escape(name)}(?:_at)?\s*\(", text)]
    for start in defined:
        after = text[start:]
        stop = re.search(r"^(?:\}|end\b|  end subroutine|    return _finite)", after, re.M)
        if stop and (RESULT.search(after, 0, stop.start()) or re.search(r"\bnv_r = \[", after[: stop.start()])):
            return start, start + stop.start()
    raise AssertionError(f"no body of {name}")


def campaign(names: list[str], languages: list[str], each: int, folder: Path) -> dict[str, Any]:
    """Corrupt ``each`` operators of every function of the named ready-made exports, in every language.

    Keys: ``tried`` and ``left`` over all, and ``rows``: function -> language -> (tried, not noticed).
    """
    left: list[str] = []
    rows: dict[str, dict[str, tuple[int, int]]] = {}
    for function in (f for name in names for f in ready_functions(name)):
        rows[function.name] = {}
        for language in languages:
            if language == "batch" and not function.inputs:
                continue  # a constant has no batch
            count, alive = survivors(function, language, folder / function.name / language, each)
            rows[function.name][language] = (count, len(alive))
            missed = alive if count else ["nothing to corrupt"]
            left += [f"{language} {function.name}: {what}" for what in missed]
    return {"tried": sum(n for row in rows.values() for n, _ in row.values()), "left": left, "rows": rows}


def ready_functions(name: str) -> list[Any]:
    from navsym.export.materials import functions_from

    return functions_from(name)


PAGE = """# Corrupted exports

Produced by `{command}`; do not edit. {machine}.

In the source of every ready-made function, in every language that runs here, one operator was changed at a time
(`+` and `-`, `*` and `/`, `sin` and `cos`; a result without operators was moved by one), at random by a fixed seed. A
cell is the number of corruptions that the function's own vectors noticed (not the compiler), of those that were
tried; `-`: a constant has no batch. {tried} corruptions were tried, {unnoticed} went unnoticed.
"""


def page(rows: dict[str, dict[str, tuple[int, int]]], languages: list[str], command: str) -> str:
    """The table as a page of the documentation."""
    machine = f"{platform.machine()} {platform.system()}, Python {platform.python_version()}"
    cells = [cell for row in rows.values() for cell in row.values()]
    tried, unnoticed = (sum(column) for column in zip(*cells, strict=True))
    lines = [PAGE.format(command=command, machine=machine, tried=tried, unnoticed=unnoticed)]
    lines += [f"| function | {' | '.join(languages)} |", f"| --- |{' ---: |' * len(languages)}"]
    for name, row in rows.items():
        words = [f"{row[n][0] - row[n][1]}/{row[n][0]}" if n in row else "-" for n in languages]
        lines.append(f"| {name} | {' | '.join(words)} |")
    return "\n".join([*lines, ""])


def main() -> None:
    from navsym.export.ready import READY

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--languages", default=",".join(n for n in SOURCE_OF if TARGETS[n].executable()))
    parser.add_argument("--each", type=int, default=1)
    parser.add_argument("--write", type=Path, help="write the table as a markdown page")
    parser.add_argument("--rows", type=Path, help="JSON of results that are kept and added to, language by language")
    options = parser.parse_args()
    languages = options.languages.split(",")
    rows = json.loads(options.rows.read_text()) if options.rows and options.rows.exists() else {}
    for name in options.names or READY:
        with tempfile.TemporaryDirectory() as folder:
            found = campaign([name], languages, options.each, Path(folder))
        for function, row in found["rows"].items():
            rows[function] = rows.get(function, {}) | row
        said = f"{name:20} corrupted {found['tried']:4} unnoticed {len(found['left'])}"
        print("\n    ".join([said, *found["left"]]), flush=True)
    if options.rows is not None:
        options.rows.write_text(json.dumps(rows))
    if options.write is not None:
        command = " ".join(["python tests/export/corruption.py", *options.names, f"--each {options.each}"])
        known = [name for name in SOURCE_OF if any(name in row for row in rows.values())]
        options.write.write_text(page(rows, known, command), encoding="utf-8")


if __name__ == "__main__":
    main()
