"""A term as a sum of hypotheses with cofactors: f = sum c_k h_k, by division or by linear algebra of bounded degree.

Division by one hypothesis after the other is tried first. Then the monomials of f are the first ones; every product of
a monomial and a hypothesis of which a term is among them is an unknown, and brings its other terms along. The system is
solved modulo a prime and its solution guessed as fractions; the checker multiplies out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import Any

from flint import Ordering, arb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, nmod_mat

from navsym.prove.rooms.goals import Hole, Holes, Proof, Term, fails, player, write_number, write_term

PRIME = (1 << 61) - 1
ROUNDS = 5
MOST_GIVEN = 5
MOST_VALUES = 8  # the relations of a rotation give every entry by the others
MOST_UNKNOWNS = 2500
FEW_UNKNOWNS = 400  # where roots stand: two of them that are equal by their signs differ by no cofactors

Exponents = tuple[int, ...]
Polynomial = dict[Exponents, fmpq]


def by_cofactors(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Candidates for the rule ``modulo`` with nothing left of the term, or a number where it has a sign."""
    if not goal.zeros:
        return
    parts = [*dict.fromkeys(g for t in (goal.term, *goal.zeros) for g in player.list_generators(t))]
    if not parts:
        return
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(parts))], Ordering.degrevlex)
    generators = dict(zip(parts, ring.gens(), strict=True))
    quotients = [player.to_quotient(t, generators, ring) for t in (goal.term, *goal.zeros)]
    (top, bottom), relations = quotients[0], [h for h, _ in quotients[1:]]
    own = [*relations, *list_own_relations(parts, generators, ring)]
    roots = [k for k, part in enumerate(parts) if part[0] == "sqrt"]
    most = FEW_UNKNOWNS if any(m[k] % 2 for m in read_terms(top) for k in roots) else MOST_UNKNOWNS
    factored = [h.factor()[1] for h in relations if goal.relation == "="]
    factors = (p for pairs in factored if len(pairs) > 1 for p, _ in pairs if divmod(top, p)[1])
    common = math.prod(factors, start=ring.constant(1))
    for more in (ring.constant(1), common)[: 1 + (not common.is_constant())]:  # f is 0 where f p is, and p is not
        divisors = write_divisors(bottom * more, goal, generators, ring)
        for rest, found in find_cofactors(top * more, None if goal.relation == "=" else bottom, own, most):
            if fails(goal.relation, arb(rest)):
                continue
            shares = [
                write_share(c, down, divisors, parts) if c else "0"
                for c, (_, down) in zip(found, quotients[1:], strict=False)
            ]
            yield {"rule": "modulo", "to": f"({rest})", "cofactors": shares, "defined": Holes(), "proof": Hole()}


def by_elimination(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A symbol that a hypothesis s = u gives, by u."""
    for k, zero in enumerate(goal.zeros if len(goal.zeros) <= MOST_VALUES else ()):
        for own, other, sign in list_values(zero):
            if own[1] in player.symbols_of(goal.term) and own[1] not in player.symbols_of(other):
                shares = [str(sign) if j == k else "0" for j in range(len(goal.zeros))]
                equal: Proof = {"rule": "modulo", "to": "0", "cofactors": shares, "defined": Holes(), "proof": Hole()}
                body: Proof = {"rule": "rewrite", "from": own[1], "to": write_term(other), "defined": Holes()}
                yield body | {"equal": equal, "proof": Hole()}


def by_sums_of_hypotheses(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A sum of hypotheses >= 0; what is so with both signs is 0."""
    if not 0 < len(goal.given) <= MOST_GIVEN:
        return
    if goal.relation == "=" and len(goal.given) > 1:
        yield {"rule": "between", "proofs": Holes()}
    for chosen in product((0, 1), repeat=len(goal.given)) if goal.relation == ">=" else ():
        total = player.add_terms(h for h, weight in zip(goal.given, chosen, strict=True) if weight)
        if player.is_identity(player.subtract(goal.term, total)):  # a try is dear: only what the rule accepts
            yield {"rule": "given", "weights": [*map(str, chosen)]}


def list_values(zero: Term) -> Iterator[tuple[Term, Term, int]]:
    """Symbols with the terms that are equal to them, and the sign of zero = sign (symbol - term)."""
    if zero[0] == "symbol":
        yield zero, player.ZERO, 1
    elif zero[0] == "*" and zero[1] == player.MINUS_ONE and len(zero) == 3 and zero[2][0] == "symbol":
        yield zero[2], player.ZERO, -1
    elif zero[0] == "+" and len(zero) == 3:
        left, right = zero[1], player.negate(zero[2])
        right = zero[2][2] if zero[2][:2] == ("*", player.MINUS_ONE) and len(zero[2]) == 3 else right
        if left[0] == "symbol":
            yield left, right, 1
        if right[0] == "symbol":
            yield right, left, -1


def list_own_relations(parts: Sequence[Term], generators: Any, ring: Any) -> Iterator[fmpq_mpoly]:
    """What holds of functions by themselves: sin**2 + cos**2 = 1 and sqrt(u)**2 = u, for polynomials u."""
    for part in parts:
        if part[0] == "sin" and ("cos", part[1]) in generators:
            yield generators[part] ** 2 + generators["cos", part[1]] ** 2 - 1
        if part[0] == "sqrt" and all(g in generators for g in player.list_generators(part[1])):
            top, bottom = player.to_quotient(part[1], generators, ring)
            yield generators[part] ** 2 * bottom - top


def find_cofactors(
    target: fmpq_mpoly, beside: fmpq_mpoly | None, relations: Sequence[fmpq_mpoly], most: int = MOST_UNKNOWNS
) -> Iterator[tuple[fmpq, list[Polynomial]]]:
    """A number r and cofactors with r beside + sum c_k h_k = target: by division, then with more and more unknowns."""
    yield from divide(target, beside, relations)
    wanted, *tables = map(read_terms, (target, *relations))
    columns: dict[tuple[int, Exponents], Polynomial] = {} if beside is None else {(-1, ()): read_terms(beside)}
    monomials = dict.fromkeys(m for table in (wanted, *columns.values()) for m in table)
    fresh: Iterable[Exponents] = [*monomials]
    for _ in range(ROUNDS):
        for m in fresh:
            if len(columns) > most:
                return
            for k, table in enumerate(tables):
                for t in table:
                    shift = tuple(a - b for a, b in zip(m, t, strict=True))
                    if min(shift, default=0) >= 0 and (k, shift) not in columns:
                        columns[k, shift] = {tuple(map(sum, zip(u, shift, strict=True))): c for u, c in table.items()}
        fresh = [m for m in dict.fromkeys(m for column in columns.values() for m in column) if m not in monomials]
        monomials |= dict.fromkeys(fresh)
        solution = solve_modulo(wanted, columns, [*monomials])
        if solution is not None:
            yield (
                solution.pop((-1, ()), fmpq(0)),
                [{m: c for (j, m), c in solution.items() if j == k} for k in range(len(relations))],
            )
        if not fresh:
            return


def divide(
    target: fmpq_mpoly, beside: fmpq_mpoly | None, relations: Sequence[fmpq_mpoly]
) -> Iterator[tuple[fmpq, list[Polynomial]]]:
    """The quotients by one relation after the other, where a multiple of ``beside`` is left."""
    cofactors, rest = [0 * target for _ in relations], target
    for k, relation in [*enumerate(relations)] * 2:
        quotient, rest = divmod(rest, relation)
        cofactors[k] += quotient
    share, rest = (0 * rest, rest) if beside is None else divmod(rest, beside)
    if rest == 0 and share.is_constant():
        yield share.leading_coefficient() if share else fmpq(0), [*map(read_terms, cofactors)]


def read_terms(polynomial: fmpq_mpoly) -> Polynomial:
    """Powers of its symbols -> coefficient."""
    return {tuple(map(int, powers)): c for powers, c in polynomial.to_dict().items()}


def solve_modulo(
    wanted: Polynomial, columns: dict[tuple[int, Exponents], Polynomial], monomials: Sequence[Exponents]
) -> dict[tuple[int, Exponents], fmpq] | None:
    """One solution of sum x_j column_j = wanted in small fractions, of which the first may be long; or None."""
    rows, keys = {m: i for i, m in enumerate(monomials)}, [*columns]
    entries = [[0] * (len(keys) + 1) for _ in monomials]
    for j, table in enumerate((*columns.values(), wanted)):
        for m, c in table.items():
            entries[rows[m]][j] = int(c.p) * pow(int(c.q), -1, PRIME) % PRIME
    reduced, rank = nmod_mat(entries, PRIME).rref()
    solution, pivot = dict[tuple[int, Exponents], Any](), -1
    for i in range(rank):
        pivot = next(j for j in range(pivot + 1, len(keys) + 1) if reduced[i, j])
        if pivot == len(keys):
            return None
        value = guess_fraction(int(reduced[i, len(keys)]))
        if value is None and pivot:
            return None
        if value != 0:
            solution[keys[pivot]] = value
    if solution and keys[0] in solution:  # exactly, from one row
        m, divisor = next(iter(columns[keys[0]].items()))
        rest = (solution[key] * columns[key].get(m, 0) for key in [*solution][1:])
        solution[keys[0]] = (wanted.get(m, fmpq(0)) - sum(rest, fmpq(0))) / divisor
    return solution


def guess_fraction(residue: int) -> fmpq | None:
    """The fraction with small numerator and denominator of this residue: Euclid, stopped halfway."""
    r, s, t, u = PRIME, residue, 0, 1
    while s > 1 << 30:
        r, s, t, u = s, r % s, u, t - r // s * u
    return fmpq(s, u) if u and abs(u) < 1 << 30 else None


def write_share(cofactor: Polynomial, above: fmpq_mpoly, divisors: str, parts: Sequence[Term]) -> str:
    """c D_k/D as text: h_k is H_k/D_k, and f is N/D."""
    text = f"({write_polynomial(cofactor, parts)}){divisors}"
    return text if above == 1 else f"{text}*({write_polynomial(read_terms(above), parts)})"


def write_divisors(bottom: fmpq_mpoly, goal: Any, generators: dict[Term, fmpq_mpoly], ring: Any) -> str:
    """A division by a polynomial: by the goal's own divisors, known to be != 0, as far as they are factors."""
    text, rest = "", bottom
    for _, part in player.conditions(goal.term):
        if not set(player.list_generators(part)) <= set(generators):
            continue
        own, below = player.to_quotient(part, generators, ring)
        while below == 1 and not own.is_constant() and divmod(rest, own)[1] == 0:
            rest, text = divmod(rest, own)[0], f"{text}/({write_term(part)})"
    return text if rest == 1 else f"{text}/({write_polynomial(read_terms(rest), [*generators])})"


def write_polynomial(terms: Polynomial, parts: Sequence[Term]) -> str:
    """The text of a polynomial in these parts, for the checker."""
    return " + ".join(
        "*".join([write_number(c), *(f"{write_term(p)}**{e}" for p, e in zip(parts, powers, strict=True) if e)])
        for powers, c in terms.items()
    )
