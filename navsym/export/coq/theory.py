"""Certificates as theories of Coq: the statement as a theorem about real numbers, and a script that proves it.

The theorem says what the checker grants: for all values of the symbols in their ranges at which every term is defined,
the relation holds; or, for a counterexample, that this is not so. It is written from the statement's own text by the
checker's parser. The script does not follow the certificate's proof: identities are cleared by ``field`` modulo
``s^2 = 1 - c^2`` and ``r r = e``, and inequalities are left to ``interval``. Coq decides whether it proves the theorem.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from navsym import checker
from navsym.checker import Term
from navsym.core.errors import DomainError
from navsym.export.coq.scripts import prove_bound, prove_equality, refute
from navsym.export.coq.terms import RELATIONS, Unwritten, defined, ranges, rename, subterms, write_term

#: How numbers are compared: by polynomials alone, or by balls of few digits, then of many.
PLAIN = "Ltac few_digits := lra.\nLtac many_digits := lra.\n"
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
        if part.get("kind") not in ("proof", "counterexample"):
            message = (
                f"expected a certificate of a statement; got one of kind {part.get('kind')}; check it without kernel"
            )
            raise DomainError(message)
        try:
            theorems.append(write_theorem(f"statement_{place}", part))
        except Unwritten as reason:
            raise DomainError(f"expected what Coq has words for; got {reason}; rest on the checker") from None
    names = ", ".join(f"statement_{place}" for place in range(1, len(parts) + 1))
    balls = any(needs_balls(part) for part in parts)
    return "\n".join(
        [
            "Require Import Reals Lra.",
            *(["From Interval Require Import Tactic."] if balls else []),
            "Open Scope R_scope.\n",
            BALLS if balls else PLAIN,
            files("navsym.export.coq").joinpath("tactics.v").read_text("utf-8"),
            *theorems,
            f"Definition all := ({names}).\nPrint Assumptions all.\n",
        ]
    )


def needs_balls(part: Mapping[str, Any]) -> bool:
    """Whether anything but polynomials and fractions is compared by size."""
    statement = part["statement"]
    terms = [checker.parse(text) for text in (statement["left"], statement["right"], *part.get("point", {}).values())]
    plain = all(piece[0] in ("number", "symbol", "+", "*", "^") for term in terms for piece in subterms(term))
    return not plain or (part["kind"] == "proof" and statement["relation"] != "=")


def write_theorem(name: str, part: Mapping[str, Any]) -> str:
    """One theorem with its script."""
    statement = part["statement"]
    goals, terms, box = checker.read_statement(statement)
    names = rename(box)
    sides = [checker.parse(statement[side]) for side in ("left", "right")]
    says = [(write_term(x, names), relation, write_term(y, names)) for x, relation, y in relations(statement, sides)]
    if len(says) > 1 and part["kind"] != "proof":
        raise Unwritten("a tolerance that fails")
    needs = [*ranges(box, names), *defined(terms, names)]
    claim = " /\\ ".join(f"{x} {RELATIONS[relation]} {y}" for x, relation, y in says)
    quantified = f"forall ({' '.join(names.values())} : R), " if names else ""
    whole = quantified + "".join(f"{need} -> " for need in needs) + claim
    printed = f"{statement['left']} {statement['relation']} {statement['right']}"
    if statement["tolerance"] is not None:
        printed += f", within {statement['tolerance']}"
    if part["kind"] == "counterexample":
        lines = refute(part["point"], names)
        whole = f"~ ({whole})"
    elif statement["relation"] == "=" and statement["tolerance"] is None:
        lines = ["intros.", *prove_equality(terms, names)]
    else:
        lines = ["intros.", *(["split."] if len(says) > 1 else []), *(prove_bound(names) * len(says))]
    return "\n".join([f"(* {printed} *)", f"Theorem {name} : {whole}.", "Proof.", *lines, "Qed.", ""])


def relations(statement: Mapping[str, Any], sides: list[Term]) -> list[tuple[Term, str, Term]]:
    """What has to be shown, as (left, relation, right); two bounds for an equality within a tolerance."""
    x, y = sides
    if statement["tolerance"] is None:
        return [(x, statement["relation"], y)]
    tolerance = checker.parse(statement["tolerance"])
    return [(checker.subtract(x, y), "<=", tolerance), (checker.subtract(y, x), "<=", tolerance)]
