"""Forty names and words that must reach a page as text, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from navsym.claims import Paper, Record
from navsym.report.page import pages
from navsym.report.wording import Words
from navsym.verification.ledger import Ledger
from navsym.verification.papers import PaperSummary

HOSTILE = (
    "<script>alert(1)</script>",
    "</script><script>alert(2)</script>",
    "<img src=x onerror=alert(3)>",
    '"><svg onload=alert(4)>',
    "' onmouseover='alert(5)",
    '" onfocus="alert(6)" autofocus="',
    "javascript:alert(7)",
    "<a href=javascript:alert(8)>x</a>",
    "<iframe src=//example.org></iframe>",
    "<style>*{display:none}</style>",
    "</style><b>",
    "<!-- comment",
    "--><b>",
    "]]><b>",
    "<![CDATA[x",
    "<?xml version='1.0'?>",
    "&lt;script&gt;",
    "&amp;",
    "&#60;script&#62;",
    "{{ 7 * 7 }}",
    "{% raw %}",
    "{# comment #}",
    "{{ cycler.__init__ }}",
    "<math><mtext></mtext></math>",
    "</math><script>alert(9)</script>",
    "<mtext><img src=x onerror=alert(10)></mtext>",
    "</article></main></html>",
    "</title><script>alert(11)</script>",
    "<meta http-equiv=refresh content=0>",
    "<base href=//example.org>",
    "<form action=//example.org><input name=x>",
    "<input type=image src=x onerror=alert(12)>",
    "../../../outside",
    "..\\..\\outside",
    "a\x00b",
    "a\u202eb",
    "a\u2028b",
    "\ufefflook",
    "x" * 500,
    "<svg><animate onbegin=alert(13) attributeName=x></svg>",
)


def record(number: str, words: str, **changes: object) -> Record:
    """A record that says the same hostile words everywhere."""
    found: dict[str, object] = {
        "id": f"sample:{number}",
        "paper": "sample",
        "number": number,
        "title": words,
        "status": "REFUTED",
        "expect": "REFUTED",
        "method": words,
        "scope": words,
        "assumptions": [words],
        "printed": words,
        "derived": words,
        "latex": words,
        "corrects": None,
        "slip": "paper",
        "reason": words,
        "evidence": words,
        "counterexample": {words: words},
        "difference": [words, words],
        "certificate": {"kind": words},
        "seconds": 0.5,
    }
    return Record.from_json(found | changes)


def ledger(records: Iterable[Record], card: Paper | None = None, title: str = "A sample") -> Ledger:
    """The verdicts of one paper."""
    paper = PaperSummary("sample", title, 1, 1, 0, ())
    return Ledger(tuple(records), (paper,), cards={} if card is None else {"sample": card})


def site(found: Ledger, words: Mapping[str, Words] | None = None) -> dict[str, str]:
    """All files of the report: name -> text."""
    return dict(pages(found, words))
