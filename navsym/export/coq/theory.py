"""Certificates as theories of Coq: the statement as a theorem about real numbers, and a script that proves it.

The theorem says what the checker grants: for all values of the symbols in their ranges at which every term is defined,
the relation holds; or, for a counterexample, that this is not so. It is written from the statement's own text by the
checker's parser. The script does not follow the certificate's proof: identities are cleared by ``field`` modulo
``s^2 = 1 - c^2`` and ``r r = e``, and inequalities are left to ``interval``. Coq decides whether it proves the theorem.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from importlib.resources import files
from typing import Any

from navsym import checker
from navsym.checker import Case, Range, Term
from navsym.core.errors import DomainError
from navsym.export.coq.condition import write_condition
from navsym.export.coq.scripts import prove_bound, prove_equality, prove_modulo, refute
from navsym.export.coq.terms import RELATIONS, Unwritten, defined, ranges, rename, subterms, write_term

#: How numbers are compared: by polynomials alone, or by balls of few digits, then of many.
PLAIN = "Ltac few_digits := lra.\nLtac many_digits := lra.\n"
Names = Mapping[str, str]
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
    theorems = []
    for place, part in enumerate(parts, start=1):
        if part.get("kind") not in ("proof", "counterexample", "condition"):
            message = (
                f"expected a certificate of a statement; got one of kind {part.get('kind')}; check it without kernel"
            )
            raise DomainError(message)
        try:
            write = write_condition if part["kind"] == "condition" else write_theorem
            theorems.append(write(f"statement_{place}", part))
        except (Unwritten, checker.Refused) as reason:
            raise DomainError(f"expected what Coq has words for; got {reason}; rest on the checker") from None
    names = ", ".join(re.findall(r"^Theorem (\w+)", "\n".join(theorems), re.M))
    kinds = {part["kind"] == "condition" for part in parts}
    balls = any(part["kind"] != "condition" and needs_balls(part) for part in parts)
    lemmas = [*["tactics.v"] * (False in kinds), *["condition.v"] * (True in kinds)]
    return "\n".join(
        [
            "Require Import Reals Lra.",
            *(["From Interval Require Import Tactic."] if balls else []),
            "Open Scope R_scope.\n",
            BALLS if balls else PLAIN,
            *(files("navsym.export.coq").joinpath(name).read_text("utf-8") for name in lemmas),
            *theorems,
            f"Definition all := ({names}).\nPrint Assumptions all.\n",
        ]
    )


def needs_balls(part: Mapping[str, Any]) -> bool:
    """Whether anything but polynomials and fractions is compared by size."""
    statement = part["statement"]
    cases, _ = checker.read_statement(statement)
    terms = [t for case in cases for t in (*case.terms, *(goal.term for goal in case.goals))]
    terms += [checker.parse(text) for text in part.get("point", {}).values()]
    plain = all(piece[0] in ("number", "symbol", "+", "*", "^") for term in terms for piece in subterms(term))
    return not plain or (part["kind"] == "proof" and statement["relation"] != "=")


def write_theorem(name: str, part: Mapping[str, Any]) -> str:
    """One theorem with its script; of vectors, hypotheses and cases one for each case."""
    statement = part["statement"]
    cases, box = checker.read_statement(statement)
    names = rename(box)
    printed = f"{statement['left']} {statement['relation']} {statement['right']}"
    printed += "" if statement["tolerance"] is None else f", within {statement['tolerance']}"
    printed += "".join(f", given {text}" for text in statement.get("given", []))
    require_words(statement, cases)
    says = [[(goal.term, goal.relation, checker.ZERO) for goal in case.goals] for case in cases]
    if is_plain(statement):
        says = [relations(statement, [checker.parse(statement[side]) for side in ("left", "right")])]
    if part["kind"] != "proof" and len(says) > 1:
        raise Unwritten("a case that fails")
    proofs = iter(part.get("proofs", ()))
    theorems = [
        f"Theorem {name}{f'_{k}' if len(cases) > 1 else ''} : {write_case(part, case, wanted, box, names, proofs)}"
        for k, (case, wanted) in enumerate(zip(cases, says, strict=True), start=1)
    ]
    return "\n".join([f"(* {printed} *)", *theorems])


def require_words(statement: Mapping[str, Any], cases: list[Case]) -> None:
    """Refuse what the reader of the checker has computed: derivatives, moments, whole parts, orders."""
    text = " ".join([statement["left"], statement["right"], *statement["exists"], *statement.get("given", [])])
    computed = re.search(r"\b(diff|dot_|E|cov)\(", text) or {"order", "random"} & set(statement)
    if computed or any(case.fractions for case in cases):
        raise Unwritten("a derivative, moment, whole part or order, which the checker reads")


def write_case(
    part: Mapping[str, Any], case: Case, wanted: Said, box: Mapping[str, Range], names: Names, proofs: Iterator[Any]
) -> str:
    """What a theorem says of one case, and its script, which takes the cofactors of hypotheses from the proofs."""
    needs = [*ranges(box, names), *defined(case.terms, names)]
    needs += [f"{write_term(t, names)} >= 0" for t in case.given] + [f"{write_term(t, names)} = 0" for t in case.zeros]
    says = [(write_term(x, names), RELATIONS[relation], write_term(y, names)) for x, relation, y in wanted]
    claim = " /\\ ".join(map(" ".join, says))
    whole = (f"forall ({' '.join(names.values())} : R), " if names else "") + "".join(f"{n} -> " for n in needs) + claim
    lines = ["intros."]
    if part["kind"] == "counterexample":
        lines = refute(part["point"], names)
        whole = f"~ ({whole})"
    for k, (x, relation, y) in enumerate(wanted if part["kind"] == "proof" else ()):
        lines += ["split."] * (k + 1 < len(wanted))
        script = prove_bound(names)
        proof: Mapping[str, Any] = next(proofs, {})
        if relation == "=" and proof.get("rule") == "modulo":
            script = prove_modulo(proof, case.zeros, x, names)
        elif relation == "=":
            script = ["reflexivity."] if x == y else prove_equality(parts_of(part, case, x, y), names)
        lines += ["{", *script, "}"] if len(wanted) > 1 else script
    return "\n".join([f"{whole}.", "Proof.", *lines, "Qed.", ""])


def parts_of(part: Mapping[str, Any], case: Case, x: Term, y: Term) -> tuple[Term, ...]:
    """The terms of an equation."""
    return case.terms if is_plain(part["statement"]) else (x, y)


def is_plain(statement: Mapping[str, Any]) -> bool:
    """Whether both sides are numbers that the first reader of the checker reads, too."""
    try:
        return "given" not in statement and bool(checker.parse(statement["left"]) and checker.parse(statement["right"]))
    except checker.Refused:
        return False


def relations(statement: Mapping[str, Any], sides: list[Term]) -> list[tuple[Term, str, Term]]:
    """What has to be shown, as (left, relation, right); two bounds for an equality within a tolerance."""
    x, y = sides
    if statement["tolerance"] is None:
        return [(x, statement["relation"], y)]
    tolerance = checker.parse(statement["tolerance"])
    return [(checker.subtract(x, y), "<=", tolerance), (checker.subtract(y, x), "<=", tolerance)]
