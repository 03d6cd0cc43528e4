"""Questions about public estimator code at a named commit: mappings of our own, files where NAVSYM_CORPORA says.

``python -m tests.audit.reports FOLDER`` writes the table in docs/audit_reports.md; FOLDER/NAME clones OWNER/NAME.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from navsym.audit.answer import Audit, audit
from navsym.core.errors import NavsymError
from navsym.language.tomlfile import read_toml

HERE = Path(__file__).parent / "reports"
SPECS = sorted(HERE.glob("*.toml"))


def ask(spec: Path, corpora: str) -> Audit | None:
    """The verdicts on one file, with SOURCE in the place of its name; None without its clone."""
    head = read_toml(spec)["file"]
    clone = Path(corpora) / head["repository"].partition("/")[2]
    if not corpora or not clone.is_dir():
        return None
    with tempfile.TemporaryDirectory() as folder:
        for file in (head["path"], *head.get("also", ())):
            command = ["git", "-C", str(clone), "show", f"{head['commit']}:{file}"]
            data = subprocess.run(command, capture_output=True, check=True).stdout
            (Path(folder) / Path(file).name).write_bytes(data)
        text = spec.read_text().partition("\n\n")[2].replace("SOURCE", Path(head["path"]).name)
        (Path(folder) / "spec.toml").write_text(text)
        return audit(Path(folder) / "spec.toml")


def write_rows(spec: Path, answer: Audit) -> list[str]:
    """A line of the table for each question."""
    document = read_toml(spec)
    head, rows = document["file"], []
    for question, block in zip(answer.questions, document["question"], strict=True):
        wrong = [entry for entry in question.entries if str(entry.status) != "PROVED"]
        lines = sorted({entry.line for entry in wrong or question.entries})
        where = f"{lines[0]}-{lines[-1]}" if len(lines) > 2 else ", ".join(map(str, lines))
        entries = f"{len(question.entries) - len(wrong)} of {len(question.entries)}"
        cells = (head["repository"], head["commit"], head["path"], where, question.kind, block["name"], entries)
        rows.append("| " + " | ".join((*cells, str(question.status), question.sense)) + " |")
    return rows


def main(corpora: str, *names: str) -> None:
    """Print the table; names restrict it."""
    for spec in SPECS:
        if names and not any(spec.stem.startswith(name) for name in names):
            continue
        try:
            answer = ask(spec, corpora)
        except NavsymError as error:
            print(f"{spec.name}: {error}", file=sys.stderr)
            continue
        for row in [f"no clone for {spec.name}"] if answer is None else write_rows(spec, answer):
            print(row, flush=True)
        for failure in answer.list_failures() if answer else ():
            print(f"  {failure[:400]}", file=sys.stderr)


if __name__ == "__main__":
    main(*sys.argv[1:])
