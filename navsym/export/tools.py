"""What cppcheck says about exported C: the MISRA rules that it breaks, and those that it deviates from on purpose.

Nothing is "passed" that did not run: a missing program is reported as "not executed", with what to install.
"""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from navsym.export.languages.targets import answering
from navsym.export.processes import run

#: Rules of MISRA C:2012 that exported code does not keep, each with its kind and reason.
DEVIATIONS: dict[str, dict[str, str]] = tomllib.loads(Path(__file__).with_name("deviations.toml").read_text("utf-8"))
#: Advice of cppcheck that is not of MISRA and not taken: the derived bound says what log(1 + x) loses, and where it
#: would lose too much a polynomial stands in its place.
UNTAKEN = ("unpreciseMathCall",)
MISRA_LINE = re.compile(r"^misra-c2012-([\d.]+):([^:]+):(\d+)")


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
