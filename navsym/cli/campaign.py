"""Attack navsym on purpose and print the figures: mutants, damaged files, killed writers, full disks and more."""

from __future__ import annotations

import functools
import sys
import time
from typing import Any

from navsym.cli._progress import Progress
from navsym.cli.output import Told
from navsym.core.choice import one_of

#: Campaign -> what is attacked, for the table of docs/attacks.md.
NAMES = {
    "mutants": "mutants of the formulas",
    "parser": "damaged files, and files that lie about their size",
    "fuzz": "every reader of files by inputs that coverage guides",
    "certificates": "altered certificates",
    "statements": "statements of known truth, judged by another arithmetic",
    "code": "one-token mutants of C, Python, MATLAB and Rust, judged by what runs",
    "kills": "writers of the store killed at random moments",
    "disk": "full disk, read-only folder, stale lock, clock set back",
    "engines": "engines: known wrong answers",
    "identities": "textbook identities and their near misses",
    "filters": "NEES and NIS over 10,000 runs; every linear case against least squares",
    "fidelity": "what is decided is what is printed: every claim",
    "checker-mutants": "mutants of the checker itself",
}
RESUME = {
    True: "with --fresh nothing is kept; leave it out to be able to go on",
    False: "the batches are kept: the same command goes on from there",
}


def command(
    name: str,
    modules: list[str] | None = None,
    *,
    share: float = 1.0,
    inputs: int | None = None,
    seed: int = 0,
    jobs: int = 1,
    seconds: float = 3600.0,
    fresh: bool = False,
    markdown: bool = False,
) -> Told:
    """Run a campaign of a checkout; it resumes where it was stopped. Status 1 when anything wrong was found.

    Example: navsym campaign mutants guaranteed_velocity --share 0.02 --jobs 2
    """
    one_of(name, NAMES, "NAME")
    attacks, started = load_attacks(), time.monotonic()
    with Progress("batches", resume=RESUME[fresh]) as bar:
        document = attacks.start_campaign(
            name,
            papers=modules or [],
            share=share,
            inputs=inputs,
            seed=seed,
            jobs=jobs,
            seconds=seconds,
            fresh=fresh,
            progress=bar.follow,
        )
    spent = time.monotonic() - started
    words = [word for word in sys.argv[1:] if word not in ("--markdown", "--fresh")]
    row = {"what": NAMES[name], "words": words, "seconds": spent}
    show = functools.partial(attacks.markdown_row, **row) if markdown else attacks.as_text
    status = 1 if document["wrong"] or document["stopped"] or document["unsaved"] else 0
    return Told(document, lambda: show(document), status)


def load_attacks() -> Any:
    """The module ``tests/attacks/campaigns/start.py`` of the checkout around the papers or the current folder."""
    import importlib
    from pathlib import Path

    from navsym.claims.paper import papers_folder
    from navsym.core.errors import MissingEngineError

    for root in (papers_folder().parent, Path.cwd()):
        if (root / "tests" / "attacks" / "campaigns" / "start.py").exists():
            sys.path[:0] = [str(root)] * (str(root) not in sys.path)
            return importlib.import_module("tests.attacks.campaigns.start")
    raise MissingEngineError(
        "expected the folder tests/attacks of a checkout; got an installation without it; "
        "clone the repository of navsym and run the command in its folder"
    )
