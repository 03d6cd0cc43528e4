"""A small report that holds every kind of verdict, built once."""

from __future__ import annotations

import pytest

from navsym.claims import Paper, Record
from tests.report import hostile

PLAIN = {
    "title": "A formula.",
    "method": "normal form",
    "scope": "all real T",
    "assumptions": [],
    "certificate": None,
    "counterexample": None,
    "difference": None,
    "slip": None,
    "reason": "",
    "evidence": "reduces to 0 in Q",
}


def plain(number: str, status: str, printed: str, derived: str, **changes: object) -> Record:
    base = PLAIN | {"status": status, "expect": status, "printed": printed, "derived": derived} | changes
    return hostile.record(number, "words", **base)


@pytest.fixture(scope="session")
def records() -> list[Record]:
    return [
        plain("1", "PROVED", "sin(2*T)", "2*sin(T)*cos(T)", certificate={"kind": "identity"}),
        plain(
            "2",
            "REFUTED",
            "-sin(T)",
            "sin(T)",
            slip="paper",
            reason="the sign is lost",
            method="exact point, ball arithmetic",
            scope="one point",
            counterexample={"T": "pi/6"},
            difference=["-1.0000000000000000001", "-0.9999999999999999999"],
        ),
        plain("2*", "PROVED", "sin(T)", "sin(T)", corrects="sample:2", title="The sine without a sign."),
        plain("3", "CERTIFIED", "4.6 +- 1/20", "23*sqrt(3)/9", method="ball arithmetic"),
        plain("short-name", "CONFIRMED", "exp(-a*t)", "exp(-a*t)", method="sampling", evidence="at 40 points"),
        plain(
            "7",
            "REFUTED",
            "(True, True)",
            "(True, False)",
            slip="scan",
            reason="a dot is lost in the copy",
            method="exact ranks",
            scope="all T in (0, oo), real w",
            assumptions=["w != 0"],
        ),
        plain("7*", "PROVED", "(True, True, True)", "(True, True, True)", corrects="sample:7", title="With its dot."),
        plain("4", "OPEN", "[[1, T], [0, 1]]", "[[1, T], [0, 1]]", method="none", evidence="nothing helped"),
    ]


@pytest.fixture(scope="session")
def card() -> Paper:
    return Paper(
        "sample",
        "A sample",
        ("A. Author",),
        1984,
        "A journal",
        "English",
        ("1", "2", "3", "4", "5", "6", "7"),
        definitions={"5": "notation"},
        left_out={"section 2: <easily> realised": "a judgement & no figure"},
    )


@pytest.fixture(scope="session")
def files(records: list[Record], card: Paper) -> dict[str, str]:
    return hostile.site(hostile.ledger(records, card))


@pytest.fixture(scope="session")
def hostile_files() -> dict[str, str]:
    """Every hostile word as title, sides, scope, assumption, number, counterexample and paper title."""
    records = [hostile.record(f"{i}", words) for i, words in enumerate(hostile.HOSTILE)]
    records += [hostile.record(words, "plain") for words in hostile.HOSTILE]
    return hostile.site(hostile.ledger(records, title=hostile.HOSTILE[0]))


@pytest.fixture(scope="session")
def hostile_words() -> tuple[str, ...]:
    return hostile.HOSTILE
