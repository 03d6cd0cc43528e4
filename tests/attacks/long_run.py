"""The long attack: statements on each construct, decided in this process, by shares of time.

``python -m tests.attacks.long_run SEED SECONDS OUT`` appends to OUT a line for each statement that is not decided, and
at the end a line with the counts by construct. ``python -m tests.attacks.long_run table OUT...`` adds them up.
"""

from __future__ import annotations

import json
import random
import signal
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import navsym as nav
from navsym.prove.claimfile import decide_claim
from navsym.prove.formulas import read_formula, read_options, split_formula
from tests.attacks import calculus_schemes, constructs, matrix_schemes, number_schemes
from tests.attacks.constructs import Construct, Scheme, judge_status, keep_used

SCHEMES: dict[str, Scheme] = {
    **constructs.SCHEMES,
    **matrix_schemes.SCHEMES,
    **calculus_schemes.SCHEMES,
    **number_schemes.SCHEMES,
}

OUTCOMES = ("decided", "confirmed", "open", "refused", "false confirmed", "wrong")
SECONDS = 4.0
#: A construct whose statements take longer than SLOW seconds has a quarter of the time of the others.
SLOW = 0.1


class Late(BaseException):
    """The statement has used its time."""


def raise_late(*_: Any) -> None:
    raise Late


def decide_here(statement: Construct, seconds: float = SECONDS) -> nav.Verdict:
    """What ``nav.prove`` grants, without the process of its own that each statement has there."""
    given = dict(statement.given)
    beside = {"tolerance": given.pop("tolerance", None), "exists": (), "given": given.pop("given", ())}
    beside |= read_options(None, given.pop("rates", None), given.pop("order", None), seconds, 1)
    claims = read_formula(split_formula(statement.text, None, None, given), given, beside)
    return decide_claim(claims.claims[0], seconds=seconds / 2)


def outcome_here(statement: Construct, seconds: float = SECONDS) -> tuple[str, str]:
    """The outcome of a statement, and what was said; ``open`` when its processor time is over."""
    signal.signal(signal.SIGPROF, raise_late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        return judge_status(decide_here(statement, seconds), statement.truth)
    except Late:
        return "open", "time"
    except nav.NavsymError as error:
        return "refused", str(error)
    except Exception as error:
        return "wrong", repr(error)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def draw(name: str, seed: int, number: int, schemes: Mapping[str, Scheme] = SCHEMES) -> Construct:
    """The statement of a construct with a number; the same numbers give the same statement."""
    return keep_used(schemes[name](random.Random(f"{name} {seed} {number}")))


def run(seed: int, seconds: float, out: Path, schemes: Mapping[str, Scheme] = SCHEMES) -> dict[str, Counter[str]]:
    """Judge statements for so many seconds by the clock."""
    counts = {name: Counter[str]() for name in schemes}
    spent, start = dict.fromkeys(schemes, 0.0), time.monotonic()
    with out.open("a", encoding="utf-8") as log:
        try:
            while time.monotonic() < start + seconds:
                name = min(spent, key=lambda n: spent[n] * (1 if spent[n] <= SLOW * counts[n].total() else 4))
                number, before = counts[name].total(), time.process_time()
                statement = draw(name, seed, number, schemes)
                found, why = outcome_here(statement)
                counts[name][found] += 1
                spent[name] += time.process_time() - before
                if found != "decided":
                    row = {"found": found, "name": name, "seed": seed, "number": number, "text": statement.text}
                    row |= {"given": statement.given, "truth": statement.truth, "why": why[:300]}
                    log.write(json.dumps(row, default=str) + "\n")
                    log.flush()
        finally:
            log.write(json.dumps({"counts": counts, "spent": spent}) + "\n")
    return counts


def make_table(paths: Sequence[Path]) -> str:
    """Markdown: a row for each construct, its outcomes and its milliseconds for a statement."""
    counts, spent = dict[str, Counter[str]](), Counter[str]()
    for line in (line for path in paths for line in path.read_text(encoding="utf-8").splitlines()):
        if line.startswith('{"counts"'):
            document = json.loads(line)
            spent.update(document["spent"])
            for name, outcomes in document["counts"].items():
                counts.setdefault(name, Counter()).update(outcomes)
    rows = []
    for name in sorted(counts):
        each = 1000 * spent[name] / max(1, counts[name].total())
        rows.append([name.replace("_", " "), counts[name].total(), *(counts[name][o] for o in OUTCOMES), round(each)])
    rows.append(["all", *(sum(row[k] for row in rows) for k in range(1, len(OUTCOMES) + 2)), ""])
    lines = [f"| construct | asked | {' | '.join(OUTCOMES)} | ms |", "| --- |" + " ---: |" * (len(OUTCOMES) + 2)]
    return "\n".join([*lines, *(f"| {' | '.join(map(str, row))} |" for row in rows)])


if __name__ == "__main__":
    if sys.argv[1] == "table":
        print(make_table([*map(Path, sys.argv[2:])]))
    else:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))  # the counts are written all the same
        run(int(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3]))
