"""Public bug fixes, read before and after: the mappings are our own text, the files lie where NAVSYM_CORPORA says.

``python -m tests.audit.fixes FOLDER`` writes the table of docs/audit_fixes.md; FOLDER/NAME is a clone of OWNER/NAME.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from navsym.audit.answer import Audit, audit
from navsym.core.errors import NavsymError
from navsym.language.tomlfile import read_toml

HERE = Path(__file__).parent / "fixes"


@dataclass(frozen=True)
class Fix:
    """A commit that corrected a formula.

    repository : OWNER/NAME
    commit     : the correction; the wrong version is its first parent
    path       : of the source
    before     : for each code the lines in the wrong version, where only some lines are read; after : in the right one
    fault      : what was wrong: a sign, an index, a name for another, a factor, a power, ...
    entries    : the entries that the correction changed, which must be the refuted ones
    """

    name: str
    repository: str
    commit: str
    path: str
    fault: str
    entries: tuple[tuple[int, int], ...]
    before: tuple[int, ...] | None
    after: tuple[int, ...] | None
    kind: str
    spec: str


def read_fix(path: Path) -> Fix:
    """One mapping: ``[fix]``, an empty line, and the questions with SOURCE in the place of the file.

    WHOLE stands there where only the other code is restricted to lines.
    """
    document = read_toml(path)
    head = document["fix"]
    kinds = dict.fromkeys(block["kind"] for block in document["question"])
    entries = tuple((int(i), int(j)) for i, j in head["entries"])
    lines = [tuple(head[key]) if key in head else None for key in ("before", "after")]
    texts = (head[key] for key in ("repository", "commit", "path", "fault"))
    return Fix(path.stem, *texts, entries, *lines, ", ".join(kinds), path.read_text().partition("\n\n")[2])


FIXES = [read_fix(path) for path in sorted(HERE.glob("*.toml"))]


def find_clone(fix: Fix, corpora: str) -> Path | None:
    """The clone of a repository, where there is one."""
    folder = Path(corpora) / fix.repository.partition("/")[2]
    return folder if corpora and folder.is_dir() else None


def read_version(fix: Fix, clone: Path, revision: str) -> bytes:
    """The file at a revision."""
    command = ["git", "-C", str(clone), "show", f"{revision}:{fix.path}"]
    return subprocess.run(command, capture_output=True, check=True).stdout


def audit_version(fix: Fix, clone: Path, is_after: bool) -> Audit:
    """The verdicts on the wrong or the right version."""
    source = read_version(fix, clone, fix.commit if is_after else f"{fix.commit}^")
    lines = fix.after if is_after else fix.before
    with tempfile.TemporaryDirectory() as folder:
        name = Path(fix.path).name
        (Path(folder) / name).write_bytes(source)
        spec = Path(folder) / "spec.toml"
        given = f'file = "{name}"' + (f"\nlines = {list(lines)}" if lines else "")
        whole = fix.spec.replace('file = "WHOLE"', f'file = "{name}"')
        spec.write_text(whole.replace('file = "SOURCE"', given))
        return audit(spec)


@dataclass(frozen=True)
class Row:
    """What came of one fix: verdicts, whether exactly the corrected entries fell, the line and the mend."""

    fix: Fix
    before: str
    after: str
    located: bool
    line: str
    mended: bool
    seconds: float
    why: str = ""


def run_fix(fix: Fix, clone: Path) -> Row:
    """Both versions, decided."""
    start = time.process_time()
    try:
        old, new = (audit_version(fix, clone, is_after) for is_after in (False, True))
    except NavsymError as error:
        return Row(fix, "refused", "refused", False, "", False, time.process_time() - start, error.message)
    fallen = [e for q in old.questions for e in q.entries if str(e.status) == "REFUTED"]
    worst = [max((str(q.status) for q in a.questions), key=ORDER.index) for a in (old, new)]
    located = bool(fallen) and {e.entry for e in fallen} == set(fix.entries)
    open_ = [e.why for a in (old, new) for q in a.questions for e in q.entries if str(e.status) == "OPEN"]
    lines = ", ".join(dict.fromkeys(str(e.line) for e in fallen))
    mended = any(e.suggestion for e in fallen)
    return Row(fix, *worst, located, lines, mended, time.process_time() - start, next(iter(open_), ""))


ORDER = ("PROVED", "CERTIFIED", "OPEN", "REFUTED")


def write_row(row: Row) -> str:
    """A line of the table."""
    fix = row.fix
    entries = " ".join(f"{i},{j}" for i, j in fix.entries) if len(fix.entries) < 9 else f"all {len(fix.entries)}"
    languages = {".py": "Python", ".m": "MATLAB", ".c": "C", ".h": "C"}
    language = "C++" if 'language = "cpp"' in fix.spec else languages.get(Path(fix.path).suffix, "C++")
    where = (entries, row.line) if row.located else ("", row.line)
    mend, seconds = "yes" if row.mended else "", f"{row.seconds:.1f}"
    named = (fix.repository, fix.commit, fix.path, language, fix.kind, fix.fault)
    cells = (*named, row.before, *where, mend, row.after, seconds)
    return "| " + " | ".join(cells) + " |"


def main(corpora: str, *names: str) -> None:
    """Print the table; names restrict it."""
    for fix in FIXES:
        if names and not any(fix.name.startswith(name) for name in names):
            continue
        clone = find_clone(fix, corpora)
        row = None if clone is None else run_fix(fix, clone)
        print(f"no clone of {fix.repository}" if row is None else write_row(row), flush=True)
        if row is not None and row.why:
            print(f"  {fix.name}: {row.why}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
