"""Inputs guided by coverage for one reader, by atheris: a process of its own, started by the campaign ``fuzz``.

    python -m tests.attacks.campaigns.guided READER FOLDER [options of libFuzzer]

The readers' own lines and those of the reader of TOML beneath them are watched. Half of the inputs are changed by
libFuzzer; a quarter are damaged as by :mod:`tests.attacks.campaigns.parser`, and a quarter are the honest file
damaged so, since what reaches new lines is mostly refused early. What a reader answers is counted
in FOLDER/tally, which outlives this process however it ends; what is wrong stands in FOLDER/wrong, a JSON document
in each line, and the process goes on.
"""

from __future__ import annotations

import json
import random
import sys
from importlib.util import find_spec
from pathlib import Path

import atheris
import numpy as np

PACKAGE = Path(str(find_spec("navsym").origin)).parent
#: Compiled loops cannot be watched.
UNWATCHED = [
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts) for path in PACKAGE.glob("*/kernels/**/*.py")
]

with atheris.instrument_imports(include=["navsym", "tomllib"], exclude=UNWATCHED):
    from tests.attacks.campaigns.parser import OUTCOMES, SLOW, answer, damage, time_fairly
    from tests.attacks.campaigns.readers import READERS

COLUMNS = (*OUTCOMES, "crashed", "slowest")
MOST = 20  # kinds of errors that are written down; the others are counted


def main(arguments: list[str]) -> None:
    """Read inputs until libFuzzer has had enough; it ends the process."""
    reader, folder, *options = arguments
    read, honest = READERS[reader]
    answer(read, honest)  # what is loaded or compiled at the first call is not the file's doing
    tally = np.memmap(folder + "/tally", dtype=float, mode="w+", shape=(len(COLUMNS),))
    kinds: set[str] = set()

    def one(data: bytes) -> None:
        outcome, spent = time_fairly(read, data)
        tally[COLUMNS.index(outcome if outcome in OUTCOMES else "crashed")] += 1
        tally[-1] = max(tally[-1], spent)
        if outcome not in OUTCOMES or spent > SLOW:
            note(f"{outcome}, {spent:.1f} s", data)

    def note(why: str, data: bytes) -> None:
        if len(kinds) < MOST and why[:40] not in kinds:
            kinds.add(why[:40])
            item = {"reader": reader, "data": data.decode("latin-1"), "why": why}
            with Path(folder, "wrong").open("a", encoding="utf-8") as file:
                file.write(json.dumps(item) + "\n")

    def changed(data: bytes, most: int, seed: int) -> bytes:
        source = random.Random(seed)
        choice = source.random()
        if choice < 0.5:
            return atheris.Mutate(data, most)
        return damage(data if choice < 0.75 else honest, source)[:most]

    atheris.Setup([sys.argv[0], *options], one, custom_mutator=changed)
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1:])
