"""A campaign from its name: the batches and the judge that ``navsym campaign NAME`` runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from navsym.core.store import default_path, open_store
from navsym.verification.papers import load_papers
from tests.attacks.campaigns import cases, certificates, code, disks, fuzz, kills, mutants, parser, statements
from tests.attacks.campaigns.batches import Batch, run_campaign
from tests.attacks.campaigns.words import as_text as as_text
from tests.attacks.campaigns.words import markdown_row as markdown_row

ROOT = Path(__file__).resolve().parents[3]
#: Campaigns that are tables of cases: where they are, and how many are one batch.
TABLES = {
    "engines": ("tests/engines", 10),
    "identities": ("tests/prove/test_textbook.py", 40),
    "filters": ("tests/honesty", 30),
    "fidelity": ("tests/fidelity", 8),
    "checker-mutants": ("tests/checker/mutants.py", 24),
}


def start_campaign(
    name: str,
    *,
    papers: Sequence[str],
    share: float,
    inputs: int | None,
    seed: int,
    jobs: int,
    seconds: float,
    fresh: bool,
    progress: Callable[[int, int], None],
) -> dict[str, Any]:
    """The document of a campaign; its batches are kept in the store, and taken from there, unless it is ``fresh``.

    inputs : number of damaged files, certificates, statements or kills; None for 10000, or 200 kills
    """
    batches, judge = prepare_campaign(name, papers, share, inputs or (200 if name == "kills" else 10_000), seed)
    limits: dict[str, Any] = {"jobs": jobs, "seconds": seconds, "progress": progress}
    if fresh:
        return run_campaign(name, batches, judge, **limits)
    with open_store() as store:
        return run_campaign(name, batches, judge, store=store, **limits)


def prepare_campaign(name: str, papers: Sequence[str], share: float, inputs: int, seed: int) -> tuple[list[Batch], Any]:
    """The batches of a campaign, and their judge."""
    if name in TABLES:
        return cases.make_batches(ROOT, *TABLES[name]), cases.judge
    if name == "mutants":
        claims = [claim for module in load_papers(papers) for claim in module.claims]
        return mutants.make_batches(claims, share, seed), mutants.judge
    if name == "fuzz":
        return fuzz.make_batches(inputs, default_path().with_name("corpus"), seed), fuzz.judge
    if name == "certificates":
        return certificates.make_batches(certificates.honest_certificates(), inputs, seed), certificates.judge
    if name == "disk":
        return disks.make_batches(), disks.judge
    campaign = {"parser": parser, "kills": kills, "statements": statements, "code": code}[name]
    return campaign.make_batches(inputs, seed), campaign.judge
