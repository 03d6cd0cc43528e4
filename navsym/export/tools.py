"""What other programs say about exported C: MISRA findings, ctest, and the size of the code on a Cortex-M4.

Nothing is "passed" that did not run: a missing program is reported as "not executed", with what to install.
"""

from __future__ import annotations

import importlib.util
import re
import struct
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from navsym.export.languages.targets import answering
from navsym.export.processes import run

#: Rules of MISRA C:2012 that exported code does not keep, each with its reason.
DEVIATIONS = {
    "15.5": (
        "advisory",
        "A function leaves at once when an argument is outside the proved domain or a result is not finite. One exit "
        "at the end would need a variable for the status and nest the whole computation in it; the status would then "
        "depend on more code than the test that decides it.",
    ),
    "5.9": (
        "advisory",
        "A part of a formula that is defined at zero by its Taylor polynomial is a static function, of the same name "
        "and text in every source that needs it. Each source is complete in itself and can be taken out of the folder "
        "alone.",
    ),
}
#: Advice of cppcheck that is not of MISRA and not taken: the derived bound says what log(1 + x) loses, and where it
#: would lose too much a polynomial stands in its place.
UNTAKEN = ("unpreciseMathCall",)
MISRA_LINE = re.compile(r"^misra-c2012-([\d.]+):([^:]+):(\d+)")
FLAGS = ("-target", "thumb-linux-musleabihf", "-mcpu=cortex_m4", "-Os", "-std=c99", "-ffp-contract=off")
ALLOCATED, EXECUTABLE = 0x2, 0x4


@dataclass(frozen=True, slots=True)
class Said:
    """What a tool said.

    status : "passed", "failed" or "not executed"
    counts : rule -> findings, or function -> bytes
    files  : file -> findings
    """

    tool: str
    status: str
    why: str
    counts: Mapping[str, int] = field(default_factory=dict)
    files: Mapping[str, int] = field(default_factory=dict)


def misra(folder: Path) -> Said:
    """cppcheck with its MISRA add-on over the functions of a C folder, the test program left out.

    Failed when a rule outside DEVIATIONS is broken.
    """
    tool = answering("cppcheck")
    if tool is None:
        return Said("cppcheck", "not executed", "cppcheck is not on this machine (Debian: apt install cppcheck)")
    sources = sorted(p.name for p in folder.glob("*.c") if p.name != "test_main.c")
    command = [
        tool,
        "--addon=misra",
        "--enable=style",
        "--std=c99",
        "--quiet",
        "--template={id}:{file}:{line}",
        *(f"--suppress={name}" for name in UNTAKEN),
    ]
    status, text = run([*command, *sources], folder)
    if status != 0:
        return Said("cppcheck", "not executed", f"cppcheck ended with status {status}: {text[:160]}")
    matches = [match for line in text.splitlines() if (match := MISRA_LINE.match(line))]
    found, files = Counter(m.group(1) for m in matches), Counter(m.group(2) for m in matches)
    beyond = sorted(set(found) - set(DEVIATIONS))
    other = [line for line in text.splitlines() if line.strip() and not MISRA_LINE.match(line)]
    why = f"rules broken: {', '.join(beyond)}" if beyond else "; ".join(other[:3])
    return Said("cppcheck", "failed" if beyond or other else "passed", why, dict(sorted(found.items())), files)


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


def deviations_page(license_: str) -> str:
    """The written list that goes with every C folder."""
    lines = [f"<!-- {license_} -->", "# Deviations from MISRA C:2012", ""]
    lines += ["The rules below are not kept, and why. Whether the code was checked, by which program and with which"]
    lines += ["findings, is what `navsym check` says of this folder; this page claims nothing about it.", ""]
    lines += ["| rule | kind | reason |", "| --- | --- | --- |"]
    return "\n".join([*lines, *(f"| {rule} | {kind} | {reason} |" for rule, (kind, reason) in DEVIATIONS.items()), ""])
