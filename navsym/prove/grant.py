"""The grant: the checker has the last word on every verdict, on the statement's own text.

The statement is written down as its author wrote it, a proof or a counterexample is put beside it, and the checker
reads both. A certificate that it refuses leaves the verdict OPEN, whoever claimed it.
"""

from __future__ import annotations

import itertools
import json
import re
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from functools import partial
from typing import Any

import sympy as sp
from flint import arb, ctx, fmpq

from navsym import checker
from navsym.claims.statement import Bound, Equation, Optimum, Property, Statement, state
from navsym.claims.verdict import CERTIFIED, CONFIRMED, OPEN, PROVED, REFUTED, Verdict
from navsym.core.errors import NavsymError
from navsym.core.numbers import Number
from navsym.language.expression import to_text
from navsym.language.names import INVERSES
from navsym.prove.equations import list_entries, shape_of
from navsym.prove.rooms.goals import as_term, draw_points, player, simple_point, subterms, write_term
from navsym.prove.sampling.points import ranges_of, write_range
from navsym.prove.search import SECONDS, find_proof, rules_of
from navsym.prove.wording import decimal_ends

UNCHECKED = "unchecked: no certificate of this statement"
BITS, MORE_BITS = (128, 1024, 8192), (20_000, 190_000)
POINTS, MORE_POINTS = 18, 72
#: Letters of a coordinate that is short enough for a reader, and of one that is too long.
SHORT, LONG = 3, 40
WAVES = ("sin", "cos", "tan", "cot", "sec", "csc")
SHARE = "share"
#: Kinds of certificates that give a statement its verdict.
GRANTS = ("proof", "counterexample", "condition", "observability", "words", "sized")
INVERSE = re.compile(rf"\b({'|'.join(INVERSES)})\s*\(", re.ASCII)
NUMERAL = re.compile(r"(?<![\w.])\d+(?:\.\d+)?[eE][+-]?\d+", re.ASCII)
IDENTITY = {"rule": "identity"}
#: The checker and its player are two modules, and each has its own class.
REFUSALS = (checker.Refused, player.Refused)

Document = dict[str, Any]


# The statement as the checker reads it


def write_statements(statement: Statement) -> list[Document] | None:
    """The statements of the entries in the language of the checker; None for what it has no words for."""
    try:
        if isinstance(statement, Optimum):
            return write_optimum([statement], [0] * len(statement.support))
        if isinstance(statement, (Equation, Bound)):
            shapes = shape_of(statement.printed), shape_of(statement.derived)
            if shapes[0] == shapes[1]:
                exists, limit, symbols = write_beside(statement)
                return [write_entry(statement, *sides, exists, limit, symbols) for sides in list_sides(statement)]
            if isinstance(statement, Equation) and len(shapes[0]) == len(shapes[1]):  # equal matrices have equal sizes
                return [state(str(m), "=", str(n)) for m, n in zip(*shapes, strict=True)]
    except (NavsymError, *REFUSALS):
        pass
    return [dict(text) for text in statement.meaning] or None if isinstance(statement, Property) else None


def list_sides(statement: Equation | Bound) -> list[tuple[str, str]]:
    """Both sides of each entry as text: as written, where that is known."""
    if statement.written is not None:
        left, right = ([*map(write_numerals, side)] for side in (statement.written.left, statement.written.right))
    else:
        left, right = ([*map(to_text, list_entries(side))] for side in (statement.printed, statement.derived))
    pairs = [*zip(left, right, strict=True)]
    if len(pairs) == 1 or isinstance(statement, Equation):
        return pairs
    checker.require(statement.relation == "!=", "matrices have no order")  # they differ where one entry does
    return [(" + ".join(f"(({x}) - ({y}))**2" for x, y in pairs), "0")]


def write_beside(statement: Equation | Bound) -> tuple[list[str], str | None, set[sp.Symbol]]:
    """What has to exist, the tolerance, and the symbols of a statement: the same for all its entries."""
    written, tolerance = statement.written, getattr(statement, "tolerance", None)
    if written is not None:
        limit = None if written.tolerance is None else write_numerals(written.tolerance)
        return [*map(write_numerals, written.exists)], limit, set(written.symbols)
    exists = [sp.sympify(part, strict=True) for part in statement.exists]
    nonzero = [sp.sympify(part, strict=True) for part in getattr(statement, "nonzero", ())]
    sides = (*list_entries(statement.printed), *list_entries(statement.derived))
    symbols = set().union(*(e.free_symbols for e in (*sides, *exists, *nonzero)))
    limit = None if tolerance is None else to_text(sp.sympify(tolerance, strict=True))
    return [*map(to_text, exists), *(f"1/({to_text(d)})" for d in nonzero)], limit, symbols


def write_entry(
    statement: Equation | Bound, left: str, right: str, exists: list[str], limit: str | None, symbols: set[sp.Symbol]
) -> Document:
    """One entry with its symbols, what has to exist, and its tolerance."""
    names = checker.symbols_of(checker.parse(left)).union(
        *(checker.symbols_of(checker.parse(e)) for e in (right, *exists))
    )
    ranges = ranges_of(sorted((s for s in symbols if s.name in names), key=str), statement.box)
    return {
        "left": left,
        "relation": "=" if isinstance(statement, Equation) else statement.relation,
        "right": right,
        "symbols": {symbol.name: write_range(limits) for symbol, limits in ranges.items()},
        "exists": [*exists],
        "tolerance": limit,
    }


def write_numerals(text: str) -> str:
    """The text with 1e-3 and the like as decimals in full, and inverse hyperbolic functions as their logarithms.

    The checker reads no other ones.
    """
    while call := INVERSE.search(text):
        end, depth = call.end(), 1
        while depth:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        form = INVERSES[call[1]].replace("x", f"({text[call.end() : end - 1]})")
        text = f"{text[: call.start()]}({form}){text[end:]}"
    return NUMERAL.sub(lambda numeral: format(Decimal(numeral[0]), "f"), text)


def write_optimum(statements: Sequence[Optimum], panels: Sequence[int]) -> list[Document]:
    """What weak duality needs: constraints, places inside, a dual that is feasible, and equal values.

    One statement for each measurement, which differ in regressors and interval; ``panels`` has the one of each place.
    A place in an interval is start + (end - start) share with a share from 0 to 1.
    """
    first = statements[0]
    moving_parts = [part for s in statements for part in (*s.regressors, *s.interval)]
    whole = sp.Tuple(*moving_parts, *first.functional, *first.dual, *first.support, *first.weights, first.value)
    symbols = sorted(whole.free_symbols - {first.variable}, key=str)
    ranges = {s.name: write_range(limits) for s, limits in ranges_of(symbols, first.box).items()}

    def read(parts: Iterable[Any]) -> list[Any]:
        return [player.parse(to_text(sp.sympify(part, strict=True))) for part in parts]

    def at(term: Any, place: Any) -> Any:
        return player.replace(term, ("symbol", first.variable.name), place)

    rows, ends = [read(s.regressors) for s in statements], [read(s.interval) for s in statements]
    P, x, w, times = map(read, (first.functional, first.dual, first.weights, first.support))
    (value,) = read([first.value])
    exists = [write_term(term) for term in (*P, *x, *w, *times, *(end for pair in ends for end in pair), value)]

    def state(left: Any, relation: str, right: Any, **more: Any) -> Document:
        texts = {"left": write_term(left), "relation": relation, "right": write_term(right)}
        return {**texts, "symbols": {**ranges, **more}, "exists": exists, "tolerance": None}

    def total(xs: Sequence[Any], ys: Sequence[Any]) -> Any:
        return ("+", player.ZERO, *(("*", a, b) for a, b in zip(xs, ys, strict=True)))

    share = {SHARE: ["0", "1", []]}
    inside, feasible = list[Document](), list[Document]()
    for H, (start, end) in zip(rows, ends, strict=True):
        moving = ("+", start, ("*", player.subtract(end, start), ("symbol", SHARE)))
        needed = dict.fromkeys(pair for h in H for pair in player.conditions(at(h, moving)))
        inside += [state(t, sign, player.ZERO, **share) for sign, t in needed if SHARE in player.symbols_of(t)]
        dual = total(x, [at(h, moving) for h in H])
        feasible += [state(side, "<=", player.ONE, **share) for side in (dual, player.negate(dual))]
    sums = [total(w, [at(rows[k][j], t) for t, k in zip(times, panels, strict=True)]) for j in range(len(P))]
    sizes = ("+", player.ZERO, *(("abs", weight) for weight in w))
    return [
        *inside,  # an interval without holes
        *(state(left, "=", p) for left, p in zip(sums, P, strict=True)),
        *(state(a, "<=", b) for t, k in zip(times, panels, strict=True) for a, b in ((ends[k][0], t), (t, ends[k][1]))),
        *feasible,
        *(state(value, "=", side) for side in (total(x, P), sizes)),
    ]


# The verdict


def is_granted(verdict: Verdict) -> bool:
    """True when the certificate is one of the statement's own, which the checker has accepted."""
    certificate = verdict.certificate or {}
    parts = certificate["of"] if certificate.get("kind") == "all" else [certificate]
    return bool(parts) and all(part.get("kind") in GRANTS for part in parts)


def grant_verdict(statement: Statement, verdict: Verdict, seconds: float = SECONDS) -> Verdict:
    """The verdict with a certificate that the checker has accepted for the statement's own text.

    A claimed verdict for which no certificate is found or accepted becomes OPEN, and what the search left open is
    proved here where a proof is found. A computed fact, which is no formula, stays and says that it is unchecked.
    """
    documents = write_statements(statement)
    if documents is None:
        apart = "the two sides have no common statement"
        return leave_unchecked(verdict, statement.unsaid if isinstance(statement, Property) else apart)
    if isinstance(statement, Property) and verdict.certificate:
        return pass_gate(documents, verdict)
    found = grant_documents(documents, verdict, seconds)
    is_fact = isinstance(statement, Property) and found.status == REFUTED
    return replace(found, counterexample=verdict.counterexample) if is_fact else found  # it has no symbols of its own


def grant_documents(documents: Sequence[Document], verdict: Verdict, seconds: float) -> Verdict:
    """The verdict on statements in the words of the checker, with a certificate that it has accepted, or OPEN."""
    try:
        search = find_refutation if verdict.status == REFUTED else partial(prove_all, seconds=seconds)
        found = search(documents, verdict)
    except REFUSALS as refusal:
        return withdraw(verdict, str(refusal)) if says_more(verdict) else verdict
    return pass_gate(documents, found)


def says_more(verdict: Verdict) -> bool:
    """Whether a verdict says PROVED, CERTIFIED or REFUTED."""
    return verdict.status.holds or verdict.status == REFUTED


def pass_gate(documents: Sequence[Document], verdict: Verdict) -> Verdict:
    """The verdict, if the checker accepts its certificate for these statements and says the same; else OPEN.

    The one gate behind all searches: PROVED, CERTIFIED and REFUTED of a statement in the checker's words come out here.
    """
    if not says_more(verdict):
        return verdict
    try:
        answer = grant(documents, verdict.certificate or {})
    except REFUSALS as refusal:
        return withdraw(verdict, str(refusal))
    return verdict if (answer == "HOLDS") == verdict.status.holds else withdraw(verdict, f"the statement {answer}")


def leave_unchecked(verdict: Verdict, why: str = "") -> Verdict:
    """The same verdict, with the word and its reason in the evidence when it is one that others rely on."""
    if verdict.status in (OPEN, CONFIRMED) or UNCHECKED in verdict.evidence:
        return verdict
    words = f"{UNCHECKED} ({why})" if why else UNCHECKED
    return replace(verdict, evidence=f"{verdict.evidence}; {words}".removeprefix("; "))


def withdraw(verdict: Verdict, why: str) -> Verdict:
    """OPEN in the place of a verdict that the checker does not grant."""
    words = f"claimed {verdict.status} by {verdict.method}, but not granted by the checker: {why}"
    return Verdict(OPEN, verdict.method, verdict.scope, verdict.assumptions, words)


def grant(documents: Sequence[Document], certificate: Mapping[str, Any]) -> str:
    """HOLDS or FAILS by the checker, of what has been written down and read again; raises Refused."""
    return checker.grant(list(documents), checker.load(json.dumps(certificate)))


def find_refutation(documents: Sequence[Document], verdict: Verdict) -> Verdict:
    """REFUTED by a point that the checker accepts for one of the entries."""
    point, why = dict(verdict.counterexample or {}), "no entry fails there"
    for document in documents:
        place = {
            name: point.get(name) or str(simple_point(player.read_range(limits), 0))
            for name, limits in document["symbols"].items()
        }
        try:
            certificate = refute_document(documents, document, place)
            refuted = replace(verdict, counterexample={**point, **place}, certificate=certificate)
        except REFUSALS as refusal:
            why = str(refusal)
            continue
        shorter = shorten_point(document, place) if len(documents) == 1 else place
        return refuted if shorter == place else refute_shortly(refuted, document, shorter)
    return withdraw(verdict, why)


def refute_shortly(verdict: Verdict, document: Document, point: Mapping[str, str]) -> Verdict:
    """The refutation at a shorter point; as it is where the checker does not follow there."""
    try:
        certificate = refute_document([document], document, point)
    except REFUSALS:
        return verdict
    difference = difference_at(document, point)
    return replace(verdict, counterexample=point, difference=difference, certificate=certificate)


def shorten_point(document: Document, point: Mapping[str, str]) -> dict[str, str]:
    """The point with whole numbers for roots, multiples of pi and long fractions, where the statement fails there.

    Beside sines and their like an angle stays a multiple of pi.
    """
    if all(len(text) <= SHORT for text in point.values()):
        return dict(point)
    try:
        (case, *others), box = player.read_statement(document)
    except REFUSALS:  # it asks for answers at the point
        return dict(point)
    is_wave = any(part[0] in WAVES for term in case.terms for part in subterms(term))
    kept = {name for name, text in point.items() if len(text) <= SHORT or (is_wave and "pi" in text)}
    shorter = dict(point)
    for name in [n for n in point if n in box and n not in kept] if not others else ():
        with ctx.workprec(BITS[1] if len(shorter[name]) > LONG else ctx.prec):
            for number in list_short_numbers(shorter[name]):
                trial = shorter | {name: str(number)}
                if player.is_inside(player.number(number), box[name]) and fails_at(case, trial):
                    shorter = trial
                    break
    return shorter


def list_short_numbers(text: str) -> Iterator[fmpq]:
    """Simple numbers, and those on both sides of a long fraction with few decimals."""
    yield from (fmpq(n, d) for n, d in ((1, 1), (2, 1), (3, 1), (1, 2), (-1, 1)))
    if len(text) > LONG and (long := re.fullmatch(r"(-?\d+)/(\d+)", text, re.ASCII)):
        for unit in (10**k for k in (1, 2, 3, 6, 9, 12, 24, 48)):
            below = int(long[1]) * unit // int(long[2])
            yield from (fmpq(below, unit), fmpq(below + 1, unit))


def fails_at(case: Any, point: Mapping[str, str]) -> bool:
    """Whether all terms of a case have values at a point, and balls show that one of its goals fails."""
    place = {name: player.Jet(player.value_of(player.parse(text), {})) for name, text in point.items()}
    if not all(player.value_of(term, place).is_finite() for term in case.terms):
        return False
    return any(player.FAILURES[goal.relation](player.value_of(goal.term, place)) for goal in case.goals)


def refute_document(documents: Sequence[Document], document: Document, point: Mapping[str, str]) -> Document:
    """The certificate of a counterexample; raises Refused."""
    refusal = checker.Refused("no counterexample")
    more = answer_at_point(document, point)
    close = MORE_BITS if any("exp(-" in text for text in point.values()) else ()
    ways = itertools.chain(((n, None) for n in BITS), find_zeros(document, point, more), ((n, None) for n in close))
    for bits, zero in ways:
        certificate: Document = {"kind": "counterexample", "statement": document, "bits": bits, "point": dict(point)}
        certificate |= more | {"zero": zero}
        try:
            grant(documents, certificate)
            return certificate
        except REFUSALS as error:
            refusal = error
    raise refusal


def find_zeros(document: Document, point: Mapping[str, str], more: Document) -> Iterator[tuple[int, Any]]:
    """A proof that the term of a relation that equality breaks is 0 at a point."""
    if document["relation"] in ("<", ">", "!="):
        there = {name: player.parse(value) for name, value in point.items()}
        cases, _ = player.read_statement(document, player.Answers(more["answers"], there) if more else None)
        term = cases[0].goals[0].term
        for name, value in cases[0].complete(there).items():
            term = player.replace(term, ("symbol", name), value)
        zero = find_proof(player.Goal(term, "=", {}))
        if zero is not None:
            yield BITS[0], zero


def answer_at_point(document: Document, point: Mapping[str, str]) -> Document:
    """What integrals, sums, products and limits of a statement are at a point, for its certificate."""
    from navsym.language.vectors import BINDERS
    from navsym.prove.calculus.answers import read_with_answers

    if not any(f"{name}(" in json.dumps(document) for name in (*BINDERS, "expm")):
        return {}
    place = {name: player.parse(text) for name, text in point.items()}
    answers = read_with_answers(document, place)[2]
    return {"answers": answers} if answers else {}


def prove_all(documents: Sequence[Document], verdict: Verdict, seconds: float) -> Verdict:
    """PROVED or CERTIFIED with proofs of all entries; REFUTED where a sample breaks one of them."""
    certificates, end = [], time.process_time() + seconds
    for document in documents:
        certificate = prove_document(document, verdict, end - time.process_time())
        if certificate is None:
            return judge_without_proof(documents, document, verdict)
        certificates.append(certificate)
    whole = join_certificates(certificates)
    if verdict.status.holds:
        return replace(verdict, certificate=whole)
    rules = sorted({rule for certificate in certificates for rule in rules_of(certificate["proofs"])})
    is_numeral = any(document.get("tolerance") is not None for document in documents)
    status = CERTIFIED if "balls" in rules or is_numeral else PROVED
    words = f"a proof by the rules {', '.join(rules)}"
    return replace(verdict, status=status, method="proof tree", evidence=words, certificate=whole)


def join_certificates(certificates: Sequence[Document]) -> Document:
    """One certificate of all entries or links."""
    return certificates[0] if len(certificates) == 1 else {"kind": "all", "of": [*certificates]}


def prove_document(document: Document, verdict: Verdict, seconds: float) -> Document | None:
    """The certificate of one entry, not granted yet; None where no proof is found."""
    cases, box = player.read_statement(document)
    goals = [goal for case in cases for goal in case.goals]
    bits, witness = find_witness(cases[0].terms, box)
    if witness is None:
        return None
    if verdict.method.startswith("normal form") and len(goals) == 1 and goals[0].relation == "=":
        proofs: list[Any] = [IDENTITY]
        try:
            checker.prove(IDENTITY, checker.read_statement(document)[0][0].goals[0])
        except REFUSALS:
            proofs = [find_proof(goals[0], seconds)]
    else:
        proofs = [find_proof(goal, seconds) for goal in goals]
    if any(proof is None for proof in proofs):
        return None
    return {"kind": "proof", "statement": document, "bits": bits, "witness": witness, "proofs": proofs}


def find_witness(terms: Sequence[Any], box: Mapping[str, Any]) -> tuple[int, dict[str, str] | None]:
    """A point of the box at which all terms have a value, simple where possible, and the bits that show it.

    That sqrt(1 - cos(3e-14)) has a value takes more bits than most.
    """
    for bits, count in itertools.product(BITS, (POINTS, MORE_POINTS)):
        with ctx.workprec(bits):
            for point, _ in defined_points(terms, box, count):
                return bits, write_point(point)
    return BITS[0], None


def defined_points(
    terms: Sequence[Any], box: Mapping[str, Any], count: int = POINTS
) -> Iterator[tuple[dict[str, fmpq], dict[str, Any]]]:
    """Some points of a box at which all terms have values: as numbers, and for the evaluation."""
    for point in draw_points(box, count if box else 3):
        place = {name: player.Jet(arb(value)) for name, value in point.items()}
        if all(player.value_of(term, place).is_finite() for term in terms):
            yield point, place


def write_point(point: Mapping[str, Any]) -> dict[str, str]:
    """A point as text, by name."""
    return {name: write_term(as_term(value)) for name, value in point.items()}


def judge_without_proof(documents: Sequence[Document], document: Document, verdict: Verdict) -> Verdict:
    """What has no proof: REFUTED where a sample breaks the text, else never more than CONFIRMED."""
    broken = find_failure(document)
    if broken is None:
        return withdraw(verdict, "no certificate was found") if verdict.status.holds else verdict
    try:
        certificate = refute_document(documents, document, broken)
    except REFUSALS:
        return withdraw(verdict, "the text fails at a sample") if verdict.status != OPEN else verdict
    words, difference = "the text fails at an exact point", difference_at(document, broken)
    method = "exact point, ball arithmetic"
    return Verdict(REFUTED, method, "one point", (), words, broken, difference, certificate)


def find_failure(document: Document) -> dict[str, str] | None:
    """A point at which a sample breaks the statement."""
    (case,), box = player.read_statement(document)
    with ctx.workprec(find_witness(case.terms, box)[0]):
        for point, place in defined_points(case.terms, box):
            if any(player.FAILURES[goal.relation](player.value_of(goal.term, place)) for goal in case.goals):
                return write_point(point)
    return None


def difference_at(document: Document, point: Mapping[str, str]) -> Number | None:
    """An enclosure of left - right at a point."""
    place = {name: player.Jet(player.value_of(player.parse(text), {})) for name, text in point.items()}
    value = player.value_of(player.subtract(player.parse(document["left"]), player.parse(document["right"])), place)
    return decimal_ends(value) if value.is_finite() else None
