"""The front door against statements of known truth: by family, how many are decided, and how many wrongly.

``python -m tests.attacks.campaigns.statements DOCUMENT`` prints the table of what ``navsym campaign statements --json``
has written.
"""

from __future__ import annotations

import functools
import json
import os
import subprocess
import sys
from collections import Counter
from typing import Any

from navsym.core.errors import NavsymError
from navsym.core.sandbox import die_with_parent
from tests.attacks.campaigns.batches import Batch, Result, deal, result
from tests.attacks.statements import Statement, attack, make_statement

SIZE = 100
#: Processor time of one statement, seconds; above it the verdict is OPEN.
SECONDS = 5.0
OUTCOMES = ("decided", "confirmed", "open", "refused", "false confirmed", "wrong")


def make_batches(inputs: int, seed: int = 0) -> list[Batch]:
    """``inputs`` statements in batches of 100, each with numbers of its own."""
    return deal(["statements"], inputs, SIZE, seed)


def judge(task: tuple[str, int, int]) -> Result:
    """Counts by outcome, and by family and outcome; wrong: false verdicts, crashes, certificates that are refused.

    In a process of its own: the front door starts one for each statement, which a process of a campaign may not.
    """
    _, size, seed = task
    told = subprocess.run(
        [sys.executable, "-m", "tests.attacks.campaigns.statements", str(size), str(seed)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        preexec_fn=functools.partial(die_with_parent, os.getpid()),
    )
    if told.returncode != 0:
        raise NavsymError(f"expected a batch of statements; got {told.stderr[-500:]}; read the error")
    return json.loads(told.stdout)


def judge_batch(size: int, seed: int) -> Result:
    """The result of one batch, in this process."""
    counts: Counter[str] = Counter()
    wrong, undecided = [], []
    for number in range(seed % 10**6 * SIZE, seed % 10**6 * SIZE + size):
        statement = make_statement(number, seed // 10**6)
        found = attack(statement, SECONDS)
        counts.update((found.outcome, f"kind {statement.family}: {found.outcome}"))
        row = describe(statement) | {"outcome": found.outcome, "status": found.status, "why": found.why}
        if found.outcome == "wrong":
            wrong.append(row)
        elif found.outcome in ("false confirmed", "open", "refused"):
            undecided.append(row)
    return result(counts, wrong, undecided)


def describe(statement: Statement) -> dict[str, Any]:
    """A statement as plain data."""
    said = {"text": statement.text, "symbols": dict(statement.symbols), "beside": dict(statement.beside)}
    return said | {"family": statement.family, "truth": statement.truth}


def make_table(counts: dict[str, int]) -> str:
    """Markdown: a row for each family, a column for each outcome, and how many of 100 are decided."""
    families = sorted({name.removeprefix("kind ").partition(":")[0] for name in counts if name.startswith("kind ")})
    rows = [[family, *(counts.get(f"kind {family}: {outcome}", 0) for outcome in OUTCOMES)] for family in families]
    rows.append(["all", *(sum(row[k] for row in rows) for k in range(1, len(OUTCOMES) + 1))])
    lines = [f"| family | {' | '.join(OUTCOMES)} | decided, % |", "| --- |" + " ---: |" * (len(OUTCOMES) + 1)]
    for row in rows:
        lines.append(f"| {' | '.join(map(str, row))} | {100 * row[1] / max(1, sum(row[1:])):.0f} |")
    return "\n".join(lines)


if __name__ == "__main__":
    if len(sys.argv) == 3:
        print(json.dumps(judge_batch(*map(int, sys.argv[1:]))))
    else:
        with open(sys.argv[1], encoding="utf-8") as source:
            print(make_table(json.load(source)["counts"]))
