"""Certificates as theories of Coq: the statement as a theorem about real numbers, and a script that proves it.

The theorem says what the checker grants: for all values of the symbols in their ranges at which every term is defined,
the relation holds; or, for a counterexample, that this is not so. It is written from the statement's own text by the
checker's parser. The script follows other forms and signs of factors of the certificate's proof: identities are cleared
by ``field`` modulo ``s^2 = 1 - c^2`` and ``r r = e``, bounds are left to ``interval``. Coq decides if it proves it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from importlib.resources import files
from typing import Any, NamedTuple

from navsym import checker
from navsym.checker import Case, Question, Range, Term, Value
from navsym.core.errors import DomainError
from navsym.export.coq.calculus import Writer, list_all, list_slopes, name_questions, put_answer, put_slopes, strip
from navsym.export.coq.condition import write_condition
from navsym.export.coq.scripts import Follower, prove_modulo, refute
from navsym.export.coq.terms import RELATIONS, Unwritten, defined, ranges, rename, subterms, write_term
from navsym.export.coq.words import write_words

#: How numbers are compared: by polynomials alone, or by balls of few digits, then of many.
PLAIN = "Ltac few_digits := lra.\nLtac many_digits := lra.\n"
#: Files with lemmas and tactics, in the order in which they rest on one another.
LEMMAS = ("tactics.v", "calculus.v", "bounds.v", "condition.v", "words.v")
#: Letters of a theory: larger ones take Coq many minutes.
MOST_LETTERS = 2_000_000
Said = list[tuple[Term, str, Term]]
BALLS = "Ltac few_digits := interval with (i_prec 90).\nLtac many_digits := interval with (i_prec 700).\n"


def write_theory(certificate: Mapping[str, Any]) -> str:
    """The theory of a certificate of a statement, or of several in one.

    Raises DomainError for a certificate of another kind, and where a statement has no counterpart in Coq.

    >>> statement = {"left": "2*x - x", "relation": "=", "right": "x", "symbols": {"x": [None, None, []]}}
    >>> statement |= {"exists": [], "tolerance": None}
    >>> theory = write_theory({"kind": "proof", "statement": statement, "proofs": [{"rule": "identity"}]})
    >>> print(next(line for line in theory.splitlines() if line.startswith("Theorem")))
    Theorem statement_1 : forall (x : R), 2 * x + (- 1) * x = x.
    """
    parts = certificate.get("of", []) if certificate.get("kind") == "all" else [certificate]
    theorems, libraries = [], set[str]()
    for place, part in enumerate(parts, start=1):
        if (kind := part.get("kind")) not in ("proof", "counterexample", "condition", "words"):
            message = f"expected a certificate of a statement; got one of kind {kind}; check it without kernel"
            raise DomainError(message)
        try:
            if part["kind"] == "condition":
                theorems.append(write_condition(f"statement_{place}", part))
                libraries.add("condition.v")
                continue
            if part["kind"] == "words":
                theorems.append(write_words(f"statement_{place}", part))
                libraries |= {"tactics.v", "words.v"}
                continue
            cases = [*read_cases(part)]
            libraries |= {"tactics.v", *(file for case in cases for file in case.list_libraries(part))}
            theorems.append(write_theorem(f"statement_{place}", part, cases))
        except (Unwritten, checker.Refused) as reason:
            raise DomainError(f"expected what Coq has words for; got {reason}; rest on the checker") from None
    names = ", ".join(re.findall(r"^Theorem (\w+)", "\n".join(theorems), re.M))
    balls, calculus = "Interval" in libraries, libraries & {"calculus.v", "words.v"}
    text = "\n".join(
        [
            "Require Import Reals Lra.",
            *(["From Coquelicot Require Import Coquelicot."] if calculus else []),
            *(["From Interval Require Import Tactic."] if balls else []),
            "Open Scope R_scope.\n",
            BALLS if balls else PLAIN,
            *(files("navsym.export.coq").joinpath(name).read_text("utf-8") for name in LEMMAS if name in libraries),
            *theorems,
            f"Definition all := ({names}).\nPrint Assumptions all.\n",
        ]
    )
    if len(text) > MOST_LETTERS:
        raise DomainError(f"expected a theory of at most {MOST_LETTERS} letters; got {len(text)}; rest on the checker")
    return text


class Stated(NamedTuple):
    """One case of a statement: what the checker has of it, and its sides as they were typed."""

    case: Case
    says: Said
    questions: Sequence[tuple[Question, Any, Term]]
    box: Mapping[str, Range]

    def list_libraries(self, part: Mapping[str, Any]) -> Iterator[str]:
        """What its theorem needs beside the library of real numbers."""
        said = [t for x, _, y in self.says for t in (x, y)]
        terms = [*said, *self.case.terms, *(checker.parse(text) for text in part.get("point", {}).values())]
        plain = all(p[0] in ("number", "symbol", "+", "*", "^") for term in terms for p in subterms(term))
        if not plain or (part["kind"] == "proof" and any(relation != "=" for _, relation, _ in self.says)):
            yield "Interval"
        if self.questions or any(list_slopes(*said, *self.case.terms)):
            yield "calculus.v"
        if any(f"'rule': '{rule}'" in str(part.get("proofs")) for rule in ("slope", "squares", "quadratic", "cones")):
            yield from ("calculus.v", "bounds.v")


def read_cases(part: Mapping[str, Any]) -> Iterator[Stated]:
    """The cases of a statement as the checker reads them, with what it does not keep: sides, derivatives, integrals."""
    statement = part["statement"]
    choices: list[bool] | None = []
    if {"order", "random"} & set(statement):
        raise Unwritten("an order or a moment, which the checker reads")
    box = {name: checker.read_range(item) for name, item in statement["symbols"].items()}
    shapes = checker.read_shapes(statement.get("shapes", {}), box, {})
    limit = None if statement["tolerance"] is None else checker.parse(statement["tolerance"])
    answers = checker.Answers(deepcopy(part.get("answers", [])))
    while choices is not None:
        reader = Writer(shapes, statement.get("rates", {}), choices, box)
        for text in statement.get("given", []):
            reader.assume(text)
        for text in statement["exists"]:
            reader.need(*checker.list_entries(reader.read(text)))
        x, y = (reader.read(statement[side]) for side in ("left", "right"))
        says = say(x, statement["relation"], y, limit)
        seen = *(t for a, _, b in says for t in (a, b)), *reader.exists, *reader.given, *reader.zeros
        kept = set(map(id, list_all(*seen)))
        if any(id(s) not in kept for s in reader.marked) or (reader.marked and reader.questions):
            raise Unwritten("a derivative inside of what the checker reads")
        goals = checker.state_goals(x, statement["relation"], y, limit)
        asked, entries = [*reader.questions], [*answers.entries]
        goals = [*goals, *((("symbol", q.value), "=", ()) for q in asked)]
        goals = checker.settle_questions(reader, goals, box, answers)
        values = [goals.pop()[0] for _ in asked][::-1]
        case = reader.make_case(goals, box)
        if case.fractions:
            raise Unwritten("a whole part, which the checker reads")
        yield Stated(case, says, [*zip(asked, entries, values, strict=False)], box)
        choices = checker.next_choices(reader.choices)


def say(x: Value, relation: str, y: Value, tolerance: Term | None) -> Said:
    """What a statement says of its sides, entry by entry; two bounds for an equality within a tolerance."""
    pairs = [*zip(checker.list_entries(x), checker.list_entries(y), strict=True)]
    if tolerance is not None:
        return [(checker.subtract(*side), "<=", tolerance) for a, b in pairs for side in ((b, a), (a, b))]
    if relation == "!=" and len(pairs) > 1:
        return [(term, own, checker.ZERO) for term, own, _ in checker.state_goals(x, relation, y, None)]
    return [(a, relation, b) for a, b in pairs]


def write_theorem(name: str, part: Mapping[str, Any], cases: list[Stated]) -> str:
    """One theorem with its script; of cases one for each."""
    statement = part["statement"]
    printed = f"{statement['left']} {statement['relation']} {statement['right']}"
    printed += "" if statement["tolerance"] is None else f", within {statement['tolerance']}"
    printed += "".join(f", given {text}" for text in statement.get("given", []))
    if part["kind"] != "proof" and (len(cases) > 1 or cases[0].questions):
        raise Unwritten("a case or an integral that fails")
    proofs = iter(part.get("proofs", ()))
    theorems = [
        f"Theorem {name}{f'_{k}' if len(cases) > 1 else ''} : {write_case(part, stated, proofs)}"
        for k, stated in enumerate(cases, start=1)
    ]
    return "\n".join([f"(* {printed} *)", *theorems])


def write_case(part: Mapping[str, Any], stated: Stated, proofs: Iterator[Any]) -> str:
    """What a theorem says of one case, and its script, which takes the cofactors of hypotheses from the proofs."""
    case, wanted, questions, box = stated
    symbols = rename(box)
    names = name_questions([q for q, _, _ in questions], {**symbols})
    needs = [*ranges(box, names), *defined(case.terms, names)]
    needs += [f"{write_term(t, names)} >= 0" for t in case.given] + [f"{write_term(t, names)} = 0" for t in case.zeros]
    says = [(write_term(x, names), RELATIONS[relation], write_term(y, names)) for x, relation, y in wanted]
    claim = " /\\ ".join(map(" ".join, says))
    whole = (f"forall ({' '.join(symbols.values())} : R), " if symbols else "") + "".join(f"{n} -> " for n in needs)
    whole += claim
    slopes = [*list_slopes(*(t for x, _, y in wanted for t in (x, y)), *case.terms)]
    lines = ["intros; split_factors."]
    if part["kind"] == "counterexample":
        place = {name: write_term(checker.parse(part["point"][name]), {}) for name in symbols}
        return "\n".join([f"~ ({whole}).", "Proof.", *refute(place, put_slopes(slopes, place)), "Qed.", ""])
    lines += put_slopes(slopes, names)
    for question in questions:
        lines += put_answer(*question, names)
    for k, ((x, relation, y), goal) in enumerate(zip(wanted, case.goals, strict=True)):
        lines += ["split."] * (k + 1 < len(wanted))
        proof: Mapping[str, Any] = next(proofs, {})
        if relation == "=" and proof.get("rule") == "modulo":
            script = ["apply by_zero.", *prove_modulo(proof, case.zeros, goal.term, names)]
        elif relation == "=" and strip(x) == strip(y):
            script = ["reflexivity."]
        else:
            script = Follower(box, names).prove(proof, strip(goal.term), goal.relation)
        lines += ["{", *script, "}"] if len(wanted) > 1 else script
    return "\n".join([f"{whole}.", "Proof.", *lines, "Qed.", ""])
