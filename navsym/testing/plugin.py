"""The pytest plugin: every claim of a file ``*.claims.toml`` is one test."""

from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from navsym.prove.claimfile import FileClaim

ENDING = ".claims.toml"


def pytest_addoption(parser: pytest.Parser) -> None:
    """The option ``--navsym-budget``."""
    words = "seconds of processor time for one claim; above it the claim is OPEN and its test fails (default: 20)"
    parser.getgroup("navsym").addoption("--navsym-budget", type=read_budget, metavar="SECONDS", help=words)


def read_budget(text: str) -> float:
    """Seconds above zero."""
    with suppress(ValueError):
        if 0 < float(text) < float("inf"):
            return float(text)
    raise ArgumentTypeError(f"expected seconds above 0; got {text}; write a number such as 60")


def pytest_configure(config: pytest.Config) -> None:
    """Hand the budget to ``assert_claim``."""
    if (seconds := config.getoption("--navsym-budget", None)) is not None:
        from navsym.testing.assertions import BUDGET

        BUDGET.set(seconds)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ClaimsFile | None:
    """Collect a file of claims."""
    return ClaimsFile.from_parent(parent, path=file_path) if file_path.name.endswith(ENDING) else None


class ClaimsFile(pytest.File):
    """A file of claims."""

    def collect(self) -> Iterator[ClaimItem]:
        """One test for each claim; a file that cannot be read is an error of collection, with place and remedy."""
        from navsym.core.errors import NavsymError
        from navsym.prove.claimfile import read_claims

        try:
            claims = read_claims(self.path).claims
        except NavsymError as error:
            raise self.CollectError(f"{error.kind}: {error}") from None
        for claim in claims:
            yield ClaimItem.from_parent(self, name=claim.id, claim=claim)


class ClaimItem(pytest.Item):
    """One claim; it passes when its verdict is the declared one, by default that it holds."""

    def __init__(self, *, claim: FileClaim, **named: Any) -> None:
        super().__init__(**named)
        self.claim = claim

    def runtest(self) -> None:
        """Decide the claim within the budget."""
        from navsym.prove.claimfile import ClaimFile, decide_claims
        from navsym.testing.assertions import BUDGET, ClaimFailedError, describe_failure, require_holds

        verdict = decide_claims(ClaimFile({}, (self.claim,)), seconds=BUDGET.get())[0]
        expected = self.claim.notes.get("expect")
        if expected is None:
            require_holds(verdict, str(self.claim.formula))
        elif verdict.status != expected:
            statement = f"{self.claim.formula}, declared {expected}"
            raise ClaimFailedError(describe_failure(statement, verdict), verdict)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The counterexample in place of a traceback."""
        from navsym.testing.assertions import ClaimFailedError

        return str(excinfo.value) if isinstance(excinfo.value, ClaimFailedError) else super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """File and id."""
        return self.path, None, f"claim {self.name}"
