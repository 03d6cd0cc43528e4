"""Claims that are decided on their text: vectors, matrices, hypotheses, cases and derivatives.

The player of the search reads the text as the checker does and gives the goals of all entries and cases. An exact point
where one fails refutes, proofs of all of them prove; the checker grants either.
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, combinations, islice
from typing import Any

from flint import arb, ctx, fmpq

from navsym.claims.formula import Formula
from navsym.claims.verdict import CERTIFIED, OPEN, PROVED, REFUTED, Verdict
from navsym.core.balls import precision
from navsym.core.errors import NavsymError
from navsym.prove.calculus.answers import MOST_POINTS, read_with_answers
from navsym.prove.grant import (
    BITS,
    IDENTITY,
    REFUSALS,
    Document,
    join_certificates,
    pass_gate,
    refute_document,
    withdraw,
    write_point,
)
from navsym.prove.relations.points import Rows, cross_cell, draw_corner_points, draw_special_points
from navsym.prove.rooms.goals import as_term, player, subterms, to_sympy, write_term
from navsym.prove.search import EASY, find_proof, rules_of
from navsym.prove.wording import decimal_ends, expression_text
from navsym.prove.words.judge import search_words

POINTS = 16
EDGES = 6  # absolute values and conditions of a case that are 0 at some points
LINES = 3  # across each case: a strip may be thinner than the distance of all other points
FAR = (1, 8, 30, 100, 399)  # whole numbers at which sums are written out
FEW = 4  # points at which an exact zero is sought
PRECISIONS = (64, 512)
TROUBLE = (*REFUSALS, NavsymError, ArithmeticError, RecursionError)


@dataclass(frozen=True, slots=True, eq=False)
class TextClaim:
    """A claim of which the checker reads the whole text.

    documents : its statements in the words of the checker, one for each link of a chain
    kinds     : name -> what it is and the names of its entries
    shown     : name of an entry -> how it is shown, ``v_1`` as ``v[1]``
    scope     : the quantifier in words
    notes     : what is said about the claim, as in a claim between numbers
    """

    formula: Formula
    documents: tuple[Document, ...]
    kinds: Mapping[str, tuple[str, Rows]] = field(default_factory=dict)
    shown: Mapping[str, str] = field(default_factory=dict)
    scope: str = ""
    notes: Mapping[str, str] = field(default_factory=dict)

    @property
    def id(self) -> str:
        """The label of the claim."""
        return self.formula.id

    def show(self, text: str) -> str:
        """The text with entries as they are written on paper."""
        return re.sub(r"[A-Za-z]\w*", lambda name: self.shown.get(name[0], name[0]), text)


def decide_text(claim: TextClaim, seconds: float) -> Verdict:
    """Verdict of the claim: every link, entry and case of it; the checker has the last word."""
    if "matrices" in claim.documents[0]:
        return pass_gate(claim.documents, search_words(claim.documents, claim.scope, seconds))
    return pass_gate(claim.documents, search_text(claim, seconds))


def search_text(claim: TextClaim, seconds: float) -> Verdict:
    """A proof of each goal, or a point at which one fails; the checker has not seen it."""
    end = time.process_time() + seconds
    certificates, assumptions, rules = [], dict[str, None](), set[str]()
    for document in claim.documents:
        try:
            cases, box, answers = read_with_answers(document, seconds=seconds)
        except TROUBLE as error:
            refuted = refute_at_points(claim, document)
            why = f"the checker does not read it: {error}"
            return refuted or Verdict(OPEN, "none", claim.scope, evidence=why)
        points = [*list_points(claim, cases, box)]
        broken = find_failure(points)
        if broken is not None:
            return refute(claim, document, broken)
        if not points:
            return Verdict(OPEN, "none", claim.scope, evidence="no point is known at which all of it has a value")
        proofs = []
        for goal in (goal for case in cases for goal in case.goals):
            proof = IDENTITY if is_identity(goal) else find_proof(goal, max(0.1, end - time.process_time()))
            if proof is None and (failing := refute_at_zero(claim, document, points)):
                return failing
            if proof is None:
                words = f"no proof was found; it holds at {len(points)} exact points"
                return Verdict(OPEN, "proof tree", claim.scope, evidence=words)
            proofs.append(proof)
        rules |= set().union(*map(rules_of, proofs))
        witness = write_point(points[0][0])
        certificate = {"kind": "proof", "statement": document, "bits": BITS[0], "witness": witness, "proofs": proofs}
        certificates.append(certificate | ({"answers": answers} if answers else {}))
        assumptions |= dict.fromkeys(list_assumptions(claim, cases))
    return conclude(claim, certificates, rules, tuple(assumptions))


def conclude(claim: TextClaim, certificates: list[Document], rules: set[str], assumptions: tuple[str, ...]) -> Verdict:
    """PROVED or CERTIFIED with the proofs of all links."""
    method = "entries by exact algebra" if rules <= {"identity"} else "proof tree"
    words = f"{sum(len(c['proofs']) for c in certificates)} goals by the rules {', '.join(sorted(rules))}"
    status = CERTIFIED if "balls" in rules else PROVED
    return Verdict(status, method, claim.scope, assumptions, words, certificate=join_certificates(certificates))


def is_identity(goal: Any) -> bool:
    """Whether exact algebra alone shows an equation."""
    try:
        return goal.relation == "=" and bool(player.is_identity(goal.term))
    except (*REFUSALS, ArithmeticError):
        return False


def list_points(claim: TextClaim, cases: Sequence[Any], box: Mapping[str, Any]) -> Iterator[tuple[dict[str, Any], Any]]:
    """Exact points of the claim with the case in which they lie."""
    kinds = {name: kind for name, kind in claim.kinds.items() if {e for row in kind[1] for e in row} <= set(box)}
    count = max(8, min(POINTS, 8 * POINTS // len(cases))) if box else 1
    for case in cases:
        here = {n: case.goals[0].box[n] for n in box}
        corners = draw_corner_points(here, kinds) if box else iter(())
        bends = [part[1] for goal in case.goals[:EDGES] for part in subterms(goal.term) if part[0] == "abs"]
        met = [*dict.fromkeys((*bends, *case.given))][: EDGES if box else 0]
        pairs = combinations(case.given[:EDGES], 2)  # where two hypotheses >= 0 meet, bounds are attained
        edges = (draw_special_points(here, (*case.zeros, *ends), kinds, 2) for ends in (*((t,) for t in met), *pairs))
        lines = cross_cell(here, case.given, LINES if box and case.given else 0)
        for point in chain(draw_special_points(here, case.zeros, kinds, count), corners, *edges, lines):
            place = {name: as_term(value) for name, value in point.items()}
            try:
                with precision(PRECISIONS[-1]):  # a strip of 1e-40 has an inside
                    inside = all(player.is_inside(place[name], box[name]) for name in box)
                    inside = inside and player.lies_in(case, place)
            except (*REFUSALS, ArithmeticError):
                continue
            if inside:
                yield point, case


def find_failure(points: Sequence[tuple[dict[str, Any], Any]]) -> dict[str, Any] | None:
    """A point at which a goal of its case fails; small differences need many digits."""
    before = ctx.prec
    try:
        for ctx.prec in PRECISIONS:
            for point, case in points:
                balls = evaluate_point(case, point)
                if any(player.FAILURES[goal.relation](player.value_of(goal.term, balls)) for goal in case.goals):
                    return point
    finally:
        ctx.prec = before
    return None


def refute_at_zero(
    claim: TextClaim, document: Document, points: Sequence[tuple[dict[str, Any], Any]]
) -> Verdict | None:
    """REFUTED at a point where a term that must not be 0 seems to be 0, and exact algebra shows it."""
    before = ctx.prec
    for point, case in (*points[-FEW:], *points[:FEW]):  # where hypotheses meet, and simple ones
        if len(case.goals) != 1 or case.goals[0].relation not in (">", "!="):
            continue
        try:
            ctx.prec = PRECISIONS[-1]
            value = player.value_of(case.goals[0].term, evaluate_point(case, point))
        finally:
            ctx.prec = before
        if value.contains(0):
            verdict = refute(claim, document, point)
            return verdict if verdict.status == REFUTED else None
    return None


def evaluate_point(case: Any, point: Mapping[str, Any]) -> dict[str, Any]:
    """A point, with the fractions of the case, for the evaluation in balls."""
    place = case.complete({name: as_term(value) for name, value in point.items()})
    return {name: player.evaluate(value, {}, arb) for name, value in place.items()}


def refute(claim: TextClaim, document: Document, point: Mapping[str, Any]) -> Verdict:
    """REFUTED at a point, when the checker grants it."""
    written = write_point(point)
    values = {n: expression_text(to_sympy(v)) if isinstance(v, tuple) else str(v) for n, v in point.items()}
    shown = {claim.shown.get(name, name): value for name, value in values.items()}
    verdict = Verdict(REFUTED, "exact point, ball arithmetic", "one point", (), "", shown)
    try:
        certificate = refute_document(claim.documents, document, written)
    except REFUSALS as refusal:
        return withdraw(verdict, str(refusal))
    if "order" in document:
        return replace(verdict, certificate=certificate, **describe_lost_order(document, point, shown))
    difference = difference_at(document, point)
    words = "the text fails at an exact point"
    return replace(verdict, evidence=words, certificate=certificate, difference=difference)


def describe_lost_order(document: Document, point: Mapping[str, Any], shown: Mapping[str, str]) -> dict[str, Any]:
    """What a refuted order says: the lowest derivative that differs at 0. Its value is no left - right."""
    ((name, order),) = document["order"].items()
    (case, *_), _, _ = read_with_answers(document, {n: as_term(value) for n, value in point.items()})
    with precision(PRECISIONS[-1]):
        values = [player.value_of(goal.term, evaluate_point(case, point)) for goal in case.goals]
    low = min(i % order for i, value in enumerate(values) if player.FAILURES["="](value))
    words = f"left - right is no O({name}**{order}): both sides differ in the derivative of order {low} at {name} = 0"
    return {"method": f"derivative of order {low} at 0", "evidence": words, "counterexample": {**shown, name: "0"}}


def refute_at_points(claim: TextClaim, document: Document) -> Verdict | None:
    """REFUTED where the questions of a statement have answers at a point, if not at all of them."""
    box = {name: player.read_range(limits) for name, limits in document["symbols"].items()}
    kinds = {name: kind for name, kind in claim.kinds.items() if {e for row in kind[1] for e in row} <= set(box)}
    points = [*islice(draw_corner_points(box, kinds), 1), *draw_special_points(box, (), kinds, MOST_POINTS)]
    whole = [name for name, limit in box.items() if limit.integer]
    points += [points[-1] | dict.fromkeys(whole, fmpq(n)) for n in FAR if whole]
    for point in points if box else [{}]:
        if not all(player.is_inside(player.number(value), box[name]) for name, value in point.items()):
            continue
        place = {name: player.parse(text) for name, text in write_point(point).items()}
        try:
            cases, _, _ = read_with_answers(document, place)
            inside = [(point, case) for case in cases if player.lies_in(case, place)]
            if find_failure(inside) is not None:
                return refute(claim, document, point)
        except TROUBLE:
            continue
    return None


def difference_at(document: Document, point: Mapping[str, Any]) -> Any:
    """An enclosure of left - right at the point, of the entry that differs most visibly."""
    place = {name: player.parse(text) for name, text in write_point(point).items()}
    cases, _, _ = read_with_answers({**document, "relation": "=", "tolerance": None}, place)
    inside = [(case, evaluate_point(case, point)) for case in cases if player.lies_in(case, place)]
    values = [player.value_of(goal.term, balls) for case, balls in inside for goal in case.goals]
    far = [value for value in values if value.is_finite()]
    return decimal_ends(max(far, key=lambda value: abs(float(value.mid())))) if far else None


def list_assumptions(claim: TextClaim, cases: Sequence[Any]) -> Iterator[str]:
    """What the text needs to have a value, where neither ranges nor hypotheses nor the cases say so."""
    known = {t for case in cases for t in (*case.given, *case.zeros)}
    needed = player.set_union(player.conditions(t) for case in cases for t in case.terms)
    positive = {t for relation, t in needed if relation == ">"}
    goal = cases[0].goals[0]._replace(exists=(), zeros=(), given=()) if len(cases) > 1 else cases[0].goals[0]
    for relation, term in needed:
        factors = [f for f in player.list_factors(term) if f[0] != "number"]
        inside = factors[0][1] if len(factors) == 1 and factors[0][0] == "sqrt" else term
        is_known = bool(known & {term, player.negate(term)}) or (relation != ">" and inside in positive)
        if not player.symbols_of(term) or is_known:
            continue
        own = goal._replace(term=term, relation=relation, exists=())
        ways = (own._replace(zeros=()), own) if own.zeros else (own,)
        if all(find_proof(way, rounds=EASY) is None for way in ways):
            yield f"{claim.show(write_condition(term))} {relation} 0"


def write_condition(term: Any) -> str:
    """A term in the usual order, as far as the algebra takes it."""
    try:
        return expression_text(to_sympy(term))
    except TROUBLE:
        return write_term(term)
