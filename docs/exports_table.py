"""The table of the ready-made exports: functions by languages, with vectors, worst error, bound, findings and size.

``python docs/exports_table.py --vectors 48 --points 100000 --write docs/exports.md`` compiles and runs everything that
this machine can, writes the page, and says what it cannot run. ``--json`` prints all of it as one document.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import platform
import shlex
import struct
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from navsym.core.errors import MissingEngineError, NavsymError  # noqa: E402
from navsym.core.sandbox import MOST_MEGABYTES, Exhausted, Failed, run_many  # noqa: E402
from navsym.export.folder import write_folder  # noqa: E402
from navsym.export.languages.summary import bound_text  # noqa: E402
from navsym.export.languages.targets import TARGETS, Target, answering, find_targets  # noqa: E402
from navsym.export.materials import functions_of_claim  # noqa: E402
from navsym.export.package import Order, files_of  # noqa: E402
from navsym.export.parts import ExportedFunction  # noqa: E402
from navsym.export.processes import run  # noqa: E402
from navsym.export.ready import READY  # noqa: E402
from navsym.export.roundtrip import Outcome, run_target  # noqa: E402
from navsym.export.tools import Said, misra  # noqa: E402
from tests.attacks.points.sweep import Swept, sweep_c  # noqa: E402

Record = dict[str, Any]
FLAGS = ("-target", "thumb-linux-musleabihf", "-mcpu=cortex_m4", "-Os", "-std=c99", "-ffp-contract=off")
ALLOCATED, EXECUTABLE = 0x2, 0x4
EVERY = "c,cpp,python,batch,javascript,rust,fortran,casadi,wasm,julia,octave"
SECONDS = 36_000.0  # of one task; what runs code has limits of its own


def closing_table(
    groups: Mapping[str, Sequence[ExportedFunction]],
    targets: Sequence[Target],
    count: int,
    progress: Callable[[str], None] = lambda doing: None,
    points: int = 0,
    jobs: int = 1,
) -> Record:
    """Export every group, run every language, ask every tool; the document of ``--json``.

    progress : called with "group languages" when all languages of a group were run, with "function points" after the
        points of a function.
    points   : points at which the C of every function is held besides its vectors
        (:mod:`tests.attacks.points.sweep`).
    jobs     : how many groups, or functions under points, are at work at the same time, each in a child process.
    Keys: ``functions`` (name, group, status, claims, bound, languages, misra, cortex_m4_bytes, points), ``languages``
    and ``tools`` (status, why), ``vectors``, ``points``, ``machine``.
    Raises MissingEngineError when something that runs code is missing or gave up.
    """
    ran = {group: Task(group, functions, tuple(targets), count) for group, functions in groups.items()}
    swept = {(group, f.name): Task(f.name, (f,), (), points) for group, fs in groups.items() for f in fs if points}
    done = dict(all_done([*ran.items(), *swept.items()], jobs, progress))
    records: list[Record] = []
    languages: dict[str, Record] = {}
    tools: dict[str, Record] = {}
    for group, functions in groups.items():
        outcomes, said = done[group]
        for outcome in outcomes:
            worse(languages, outcome.language, outcome.status, outcome.why)
        for name, what in said.items():
            worse(tools, name, what.status, what.why)
        found = {f.name: done[group, f.name] for f in functions if points}
        if found:
            worse(tools, "points", *points_said(found))
        records += [function_row(group, f, outcomes, said) | points_row(found.get(f.name)) for f in functions]
    return {
        "functions": records,
        "languages": languages,
        "tools": tools,
        "vectors": count,
        "points": points,
        "machine": f"{platform.machine()} {platform.system()}, Python {platform.python_version()}",
    }


@dataclass(frozen=True, slots=True)
class Task:
    """Functions to be run in some languages on ``count`` vectors; without languages, held at so many points."""

    name: str
    functions: Sequence[ExportedFunction]
    targets: tuple[Target, ...]
    count: int

    def done(self) -> Any:
        """What every language and tool said, or what came of the points."""
        if not self.targets:
            return sweep_c(self.functions, self.count)[self.functions[0].name]
        with tempfile.TemporaryDirectory(prefix="navsym-table-") as folder:
            write_folder(Path(folder), files_of(self.functions, Order(self.targets, count=self.count)), force=True)
            outcomes = [run_target(Path(folder) / target.name, target) for target in self.targets]
            return outcomes, tools_on(Path(folder) / "c")


def all_done(
    tasks: Sequence[tuple[Any, Task]], jobs: int, progress: Callable[[str], None]
) -> Iterator[tuple[Any, Any]]:
    """(key, result) of every task, as they come; raises what a task raised."""
    for outcome in run_many(lambda item: item[1].done(), tasks, jobs, SECONDS, MOST_MEGABYTES):
        key, task = tasks[outcome.place]
        if isinstance(outcome.value, Failed):
            raise outcome.value.error
        if isinstance(outcome.value, Exhausted):
            raise MissingEngineError(f"expected {task.name} to be run; got {outcome.value.why}; try fewer points")
        progress(f"{task.name} {'languages' if task.targets else 'points'}")
        yield key, outcome.value


def tools_on(folder: Path) -> dict[str, Said]:
    """MISRA, ctest and size, where C was exported."""
    if not folder.is_dir():
        return {}
    return {"misra": misra(folder), "ctest": ctest(folder), "cortex_m4": cortex_m4_sizes(folder)}


def points_said(swept: Mapping[str, Swept]) -> tuple[str, str]:
    """Status and remark on the points of one group."""
    wrong = [f"{name}: {found.wrong} of {found.points} points outside" for name, found in swept.items() if found.wrong]
    return ("failed", "; ".join(wrong)) if wrong else ("passed", "")


def points_row(found: Swept | None) -> Record:
    """What came of one function's points; the example is an input that was wrong."""
    return {"points": None if found is None else asdict(found)}


def worse(table: dict[str, Record], name: str, status: str, why: str) -> None:
    """Keep the worst that was said about a language or a tool over all groups."""
    order = ("verified", "passed", "not executed", "failed")
    if name not in table or order.index(status) > order.index(table[name]["status"]):
        table[name] = {"status": status, "why": why}


def function_row(group: str, function: ExportedFunction, outcomes: Sequence[Outcome], said: dict[str, Said]) -> Record:
    """One function: what every language measured, and what the tools found in its C."""
    measured = {}
    for outcome in outcomes:
        vectors, wrong, worst = outcome.functions.get(function.name, (0, 0, None))
        status = outcome.status if vectors or outcome.status != "verified" else "left out"
        measured[outcome.language] = {"status": status, "vectors": vectors, "wrong": wrong, "worst": worst}
    found, size = said.get("misra"), said.get("cortex_m4")
    return {
        "name": function.name,
        "group": group,
        "status": sorted({source.status for source in function.sources}),
        "claims": [source.claim for source in function.sources],
        "bound": "; ".join(dict.fromkeys(bound_text(function, piece) for piece in function.pieces)),
        "languages": measured,
        "misra": found.files.get(f"{function.name}.c", 0) if found and found.status != "not executed" else None,
        "cortex_m4_bytes": size.counts.get(function.name) if size else None,
    }


# -- ctest, and the size on a Cortex-M4 ---------------------------------------


def ctest(folder: Path) -> Said:
    """Configure, build and test a C or C++ folder by its CMakeLists.txt, outside the folder."""
    if answering("cmake") is None or answering("ctest") is None:
        return Said("ctest", "not executed", "cmake is not on this machine (Debian: apt install cmake; or its wheel)")
    with tempfile.TemporaryDirectory(prefix="navsym-cmake-") as build:
        for command in (
            ["cmake", "-S", str(folder.resolve()), "-B", build],
            ["cmake", "--build", build],
            ["ctest", "--test-dir", build, "--output-on-failure", "--no-tests=error"],
        ):
            status, text = run(command, Path(build))
            if status != 0:
                return Said("ctest", "failed", text.strip()[-300:])
    return Said("ctest", "passed", "")


def cortex_m4_sizes(folder: Path) -> Said:
    """Bytes of code and constants of every function for a Cortex-M4 (-Os), libraries not counted."""
    if importlib.util.find_spec("ziglang") is None:
        return Said("ziglang", "not executed", "ziglang is not installed (pip install ziglang)")
    sizes = {}
    with tempfile.TemporaryDirectory(prefix="navsym-size-") as build:
        for source in sorted(p for p in folder.glob("*.c") if p.name != "test_main.c"):
            made = Path(build) / f"{source.stem}.o"
            command = [sys.executable, "-m", "ziglang", "cc", *FLAGS, "-c", source.name, "-o", str(made)]
            status, text = run(command, folder)
            if status != 0:
                return Said("ziglang", "failed", text.strip()[-300:])
            sizes[source.stem] = loaded_bytes(made.read_bytes())
    return Said("ziglang", "passed", "", sizes)


def loaded_bytes(image: bytes) -> int:
    """Bytes of the sections of a 32-bit little-endian ELF object that end in memory: code and constants."""
    if image[:6] != b"\x7fELF\x01\x01":
        return 0
    (table,) = struct.unpack_from("<I", image, 32)
    size, count = struct.unpack_from("<HH", image, 46)
    headers = (struct.unpack_from("<10I", image, table + k * size) for k in range(count))
    program, notes = 1, 7  # SHT_PROGBITS; SHT_NOTE is left out
    return sum(h[5] for h in headers if h[1] == program and h[1] != notes and h[2] & (ALLOCATED | EXECUTABLE))


# -- markdown ---------------------------------------

INTRODUCTION = """Every function was compiled and run on about {} vectors in its domain, and on those that must be
refused; every result lay inside the ball enclosure of its formula, widened by the derived rounding bound. A language's
column is the worst error in ulp of the nearest number, where the bound is below a thousand ulp; `-` is left out or not
executed. All C and C++ is compiled with `-Wall -Wextra -Wconversion -Wdouble-promotion -pedantic -Werror`: no warning
is left."""
CLOSING = """MISRA counts findings of cppcheck's add-on, all of them in the list of deviations that goes with the code
(`MISRA_DEVIATIONS.md`). M4 bytes are code and constants at `-Os` for a Cortex-M4, without the C library."""
SHORT = {"javascript": "js", "fortran": "f90"}


def as_markdown(document: Record, command: str, title: str = "Ready-made exports") -> str:
    """The page that is committed; produced, never edited."""
    names = [n for n, record in document["languages"].items() if record["status"] != "not executed"]
    lines = [f"# {title}", ""]
    lines += [f"Produced by `{command}`; do not edit. {document['machine']}.", ""]
    lines += [INTRODUCTION.format(document["vectors"]), ""]
    head = ["function", *(SHORT.get(n, n) for n in names), "vectors", "MISRA", "M4 bytes"]
    lines += [f"| {' | '.join(head)} |", f"| --- |{' ---: |' * (len(head) - 1)}"]
    for record in document["functions"]:
        cells = [measured_cell(record["languages"][n]) for n in names]
        vectors = max(found["vectors"] for found in record["languages"].values())
        tail = ["-" if record[key] is None else str(record[key]) for key in ("misra", "cortex_m4_bytes")]
        lines.append(f"| {' | '.join([record['name'], *cells, str(vectors), *tail])} |")
    if made := document.get("seconds"):
        said = ", ".join(f"{name} {seconds:.2g} s" for name, seconds in made.items())
        lines += ["", f"Formulas, proofs and bounds of a group, without its vectors, in processor time: {said}."]
    lines += ["", "## Verdicts and bounds", "", "| function | verdict | bound |", "| --- | --- | --- |"]
    for record in document["functions"]:
        lines.append(f"| {record['name']} | {', '.join(record['status'])} | {record['bound'].replace('|', '/')} |")
    lines += ["", "## Languages and tools", "", "| what | status | remark |", "| --- | --- | --- |"]
    for name, record in (*document["languages"].items(), *document["tools"].items()):
        lines.append(f"| {name} | {record['status']} | {record['why'].replace('|', '/')} |")
    return "\n".join([*lines, "", CLOSING, *points_lines(document), ""])


POINTS = """
## Many points

The C of every function at {} points: every edge of the domain, points near singularities, points with several
arguments at an edge, random ones. Each result lay inside the ball enclosure of its formula, widened by the derived
rounding bound. The enclosures were computed in two doubles with rigorous error bounds; what those did not decide was
decided in balls (third column). Points without a finite enclosure are not counted (fourth column); a constant has one
point. The last column is the worst error in ulp, where the bound is below a thousand ulp. What is believed: the C
compiler and library, IEEE arithmetic of NumPy, the published error bounds of double-word arithmetic, flint's balls.

| function | points | by balls | undefined | outside | worst ulp |
| --- | ---: | ---: | ---: | ---: | ---: |"""


def points_lines(document: Record) -> list[str]:
    """The section on many points, where there were any."""
    if not document["points"]:
        return []
    lines = [POINTS.format(document["points"])]
    for record in document["functions"]:
        p = record["points"]
        cells = [p["points"], p["by_balls"], p["undefined"], p["wrong"], f"{p['worst']:.3g}"]
        lines.append(f"| {' | '.join([record['name'], *map(str, cells)])} |")
    return lines


def measured_cell(found: Record) -> str:
    """What one language measured, in a word."""
    if found["status"] == "verified":
        return f"{found['worst']:.3g}"
    return "-" if found["status"] in ("left out", "not executed") else str(found["status"])


# -- the command ---------------------------------------


def read_words(words: Sequence[str]) -> argparse.Namespace:
    """The options of the command line."""
    reader = argparse.ArgumentParser(description="Run the ready-made exports in every language of this machine.")
    words_of_names = f"ready-made names among {', '.join(READY)}, or model files; all names when none is given"
    reader.add_argument("names", nargs="*", help=words_of_names)
    reader.add_argument("--to", default=EVERY, help="languages")
    reader.add_argument("--real", default="double", choices=("double", "float"))
    reader.add_argument("--vectors", type=int, default=48, help="vectors for each function")
    reader.add_argument("--points", type=int, default=0, help="points at which C is held, too")
    reader.add_argument("--jobs", type=int, default=1, help="groups or functions at the same time")
    reader.add_argument("--write", type=Path, help="write the table as a markdown page")
    reader.add_argument("--json", action="store_true", help="print one JSON document")
    options = reader.parse_args(words)
    unknown = [name for name in options.names if name not in READY and not name.endswith(".toml")]
    if unknown:
        reader.error(f"expected ready-made names among {', '.join(READY)}; got {unknown[0][:40]!r}; correct it")
    return options


def main(words: Sequence[str]) -> int:
    """Run the exports and print or write their table; 1 when something failed."""
    options = read_words(words)
    spoken = [n for n in options.to.split(",") if n not in TARGETS or options.real in TARGETS[n].reals]
    targets = find_targets(spoken, options.real)
    groups, seconds = {}, {}
    for name in options.names or READY:
        start = time.process_time()
        groups[name] = [f for claim in READY.get(name, (name,)) for f in functions_of_claim(claim, options.real)]
        seconds[name] = time.process_time() - start

    def tell(doing: str) -> None:
        print(doing, file=sys.stderr, flush=True)

    document = closing_table(groups, targets, options.vectors, tell, options.points, options.jobs)
    document["seconds"] = seconds
    title = "Exported models" if any(n.endswith(".toml") for n in groups) else "Ready-made exports"
    command = shlex.join(["python", "docs/exports_table.py", *without_option("--write", words)])
    if options.write is not None:
        options.write.write_text(as_markdown(document, command, title), encoding="utf-8")
    if options.json or options.write is None:
        print(json.dumps(document, indent=2) if options.json else as_markdown(document, command, title))
    said = [*document["languages"].values(), *document["tools"].values()]
    return 1 if any(record["status"] == "failed" for record in said) else 0


def without_option(name: str, words: Sequence[str]) -> list[str]:
    """The words without an option and its value."""
    place = words.index(name) if name in words else len(words)
    return [*words[:place], *words[place + 2 :]]


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except NavsymError as error:
        sys.exit(str(error))
