"""The sign of an expression on a whole box, where it exists throughout: found by the search, checked by the checker."""

from __future__ import annotations

import functools
import json

import sympy as sp
from flint import ctx

from navsym import checker
from navsym.claims.statement import Box
from navsym.core.errors import NavsymError
from navsym.language.expression import to_text
from navsym.prove.rooms.goals import player
from navsym.prove.sampling.points import Range, ranges_of, write_range
from navsym.prove.search import ROUNDS, find_proof, rules_of
from navsym.prove.signs.exact import UNKNOWN, Sign, SignProof

#: Processor time for one sign; the search mostly ends before.
SECONDS = 5.0


def prove_sign(expression: sp.Expr, box: Box, wanted: Sign = Sign.NONNEGATIVE) -> SignProof:
    """Prove that the expression exists and is nonnegative (or positive) on the whole box, or return unknown."""
    expression = sp.sympify(expression, strict=True)
    limits = ranges_of(sorted(expression.free_symbols, key=str), box)
    return remember_sign(expression, tuple(limits.items()), wanted)


@functools.lru_cache(maxsize=4096)
def remember_sign(expression: sp.Expr, limits: tuple[tuple[sp.Symbol, Range], ...], wanted: Sign) -> SignProof:
    """The same for given ranges; one question is answered once."""
    before = ctx.prec
    try:
        ctx.prec = 128
        symbols = {symbol.name: write_range(limit) for symbol, limit in limits}
        ranges = {name: checker.read_range(limit) for name, limit in symbols.items()}
        term = checker.parse(to_text(expression))
        relation = ">=" if wanted == Sign.NONNEGATIVE else ">"
        rules: set[str] = set()
        for needed, part in (*checker.conditions(term), (relation, term)):
            goal = checker.Goal(part, needed, ranges)
            proof = find_proof(goal, SECONDS, ROUNDS[:2])
            if proof is None:
                return UNKNOWN
            checker.prove(checker.load(json.dumps(proof)), goal)
            rules |= rules_of(proof)
        return SignProof(wanted, f"a proof by the rules {', '.join(sorted(rules))}", exact="balls" not in rules)
    except (NavsymError, checker.Refused, player.Refused):
        return UNKNOWN
    finally:
        ctx.prec = before
