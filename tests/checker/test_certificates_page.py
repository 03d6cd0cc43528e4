"""The examples of docs/certificates.md: the certificates are accepted, and every forgery is refused for its reason."""

from __future__ import annotations

import copy
import re
from itertools import accumulate
from pathlib import Path
from typing import Any

import pytest

from navsym import checker

PAGE = (Path(__file__).parents[2] / "docs" / "certificates.md").read_text(encoding="utf-8")
BLOCKS = [checker.load(body) for body in re.findall(r"^```json\n(.*?)^```$", PAGE, re.M | re.S)]
GRANTED = ("proof", "counterexample", "condition", "observability", "words", "sized")
HONEST = [block for block in BLOCKS if isinstance(block, dict)]
OWNERS = accumulate(BLOCKS, lambda before, block: block if isinstance(block, dict) else before)
FORGED = [(item, row) for item, block in zip(OWNERS, BLOCKS, strict=True) if isinstance(block, list) for row in block]


def put(item: Any, pointer: str, value: Any) -> Any:
    """A copy of a certificate with another value at a place."""
    forged = copy.deepcopy(item)
    *path, last = pointer.split("/")[1:]
    here = forged
    for key in path:
        here = here[int(key) if isinstance(here, list) else key]
    here[int(last) if isinstance(here, list) else last] = value
    return forged


def answer(item: Any) -> str:
    """The verdict on the certificate's own statement, its kind if it gives no verdict, or the reason of a refusal."""
    try:
        if item["kind"] in GRANTED:
            return checker.grant(item["statement"], item)
        return checker.check(item)
    except checker.Refused as why:
        return f"refused: {why}"


@pytest.mark.parametrize("item", HONEST, ids=lambda item: item["kind"])
def test_a_certificate_of_the_page_is_accepted(item):
    refuting = item["kind"] in ("counterexample", "sized") or item.get("outside") == 1
    assert answer(item) == (("FAILS" if refuting else "HOLDS") if item["kind"] in GRANTED else item["kind"])


@pytest.mark.parametrize(("item", "row"), FORGED, ids=lambda part: str(part)[:60])
def test_a_forgery_of_the_page_is_refused_for_its_reason(item, row):
    assert set(row) == {"at", "put", "refused"}
    said = answer(put(item, row["at"], row["put"]))
    assert said.startswith("refused: ") and re.search(row["refused"], said), said


def test_every_kind_and_every_rule_has_an_example_and_a_forgery():
    shown = " ".join(map(str, HONEST))
    assert [kind for kind in checker.KINDS if f"'kind': '{kind}'" not in shown] == []
    assert [rule for rule in checker.RULES if f"'rule': '{rule}'" not in shown] == []
    assert [key for key in (*checker.KINDS, *checker.RULES) if f"`{key}`" not in PAGE] == []
    assert [item["kind"] for item in HONEST if not any(own is item for own, _ in FORGED)] == []
