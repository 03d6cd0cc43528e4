"""Claims on matrices of any size, decided: a point of one size refutes, shares of the relations prove."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from flint import arb

from navsym.claims.verdict import OPEN, PROVED, REFUTED, Verdict
from navsym.prove.grant import REFUSALS, Document, join_certificates
from navsym.prove.rooms.goals import player, to_sympy
from navsym.prove.search import EASY, find_proof
from navsym.prove.wording import decimal_ends, expression_text
from navsym.prove.words.points import draw_sized_points, list_numbers, show_point
from navsym.prove.words.shares import find_above, find_shares

FEW = 8  # points that are enough evidence before a proof is sought


def search_words(documents: Sequence[Document], scope: str, seconds: float) -> Verdict:
    """Shares of the relations for all links of a claim, or a point of one size; the checker has not seen them."""
    end, certificates, assumed, count = time.process_time() + seconds, list[Document](), dict[str, None](), 0
    for document in documents:
        try:
            algebra = player.Words(document)
            relation, _ = algebra.state()
        except (*REFUSALS, ArithmeticError, RecursionError) as error:
            return Verdict(OPEN, "none", scope, evidence=f"the checker does not read it: {error}")
        points = []
        for point, holds in draw_sized_points(document):
            if not holds:
                return refute(document, point)
            points.append(point)
            if len(points) == FEW:
                break
        if not points:
            return Verdict(OPEN, "none", scope, evidence="no matrices are known at which all of it has a value")
        above = None if relation == "=" else find_above(document)
        shares = find_shares(document, end) if relation == "=" else None if above is None else []
        if shares is None:
            words = f"no sum of relations was found; it holds at {len(points)} exact points"
            return Verdict(OPEN, "words", scope, evidence=words)
        witness = min(points, key=lambda point: len(str(point)))
        certificates.append({"kind": "words", "statement": document, "witness": witness, "shares": shares})
        certificates[-1] |= {} if above is None else {"above": above}
        assumed |= dict.fromkeys((*algebra.assumed, *list_conditions(algebra)))
        count += len(shares) + len(above or [])
    whole = join_certificates(certificates)
    what = "multiples of relations between the letters" if above is None else "traces of nonnegative matrices"
    evidence = f"the difference is a sum of {count} {what}"
    return Verdict(PROVED, "sums of words", scope, tuple(assumed), evidence, certificate=whole)


def list_conditions(algebra: Any) -> Iterator[str]:
    """What the numbers of a text need to have a value, where their ranges do not say so; traces have been noted."""
    for relation, term in player.set_union(map(player.conditions, algebra.terms)):
        if player.has_trace(term) or not player.symbols_of(term) or algebra.sign_of(term) in (">", relation):
            continue
        if find_proof(player.Goal(term, relation, algebra.box), rounds=EASY) is None:
            yield f"{expression_text(to_sympy(term))} {relation} 0"


def refute(document: Document, point: Mapping[str, Any]) -> Verdict:
    """REFUTED at a point."""
    certificate: Document = {"kind": "sized", "statement": document, "point": point}
    words, difference = "the text fails at exact matrices with all declared properties", difference_at(document, point)
    method, scope = "exact matrices", "matrices of one size"
    return Verdict(REFUTED, method, scope, (), words, show_point(dict(point)), difference, certificate)


def difference_at(document: Document, point: Mapping[str, Any]) -> Any:
    """The difference of the sides at a point, of the entry where it is largest."""
    sized = player.Sized(document, point)
    _, x = sized.state()
    numbers = list_numbers(x.body) if isinstance(x, player.Typed) else [sized.value_of(x)]
    return decimal_ends(arb(max(numbers, key=abs)))
