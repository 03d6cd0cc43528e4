"""Common real zeros of polynomials as a list of simple systems.

A system is a list of polynomials that vanish together. Systems are split along factors, tidied by Groebner
bases where those stay small, and left out where no real point can satisfy them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpz_mpoly_vec

from navsym.methods.observability.ring import Poly, Ring, divide, divides, gcd_all, irreducible_factors

System = list[Poly]

#: Groebner bases: number of polynomials, terms of each, bits of a coefficient.
LIMITS = (24, 120, 1000)
BRANCHES = 40


def components(polynomials: Sequence[Poly], ring: Ring) -> list[list[Poly]]:
    """Real common zeros as a list of simple systems: {f = 0} or {f = 0 and g = 0 ...}.

    The greatest common divisor gives the hypersurfaces; what remains is branched on its factors
    until every branch is a system that does not factor any more.
    """
    common = gcd_all(polynomials, ring.constant(0))
    found = hypersurfaces(common, ring)
    rest = [divide(p, common) for p in polynomials]
    if not any(p.is_constant() for p in rest):
        found += branch(rest, ring)
    return irredundant(found)


def hypersurfaces(common: Poly, ring: Ring) -> list[list[Poly]]:
    """Real zeros of one polynomial, factor by factor; a sum of squares breaks up further."""
    found: list[list[Poly]] = []
    for f in irreducible_factors(common):
        for system in real_systems([f], ring):
            found += [system] if system == [f] else branch(system, ring)
    return found


def branch(start: Sequence[Poly], ring: Ring) -> list[list[Poly]]:
    """Split ``{all start = 0}`` along factors; a branch too long to split is kept as it is."""
    open_branches, closed, steps = [list(start)], [], 0
    while open_branches:
        system = open_branches.pop()
        steps += 1
        if steps > BRANCHES:
            closed.append(system)
            continue
        tidy = tidied(system, ring)
        if tidy is None:
            continue
        for place, f in enumerate(tidy):
            parts = alternatives(f, ring)
            if parts != [[f]]:
                open_branches += [[*tidy[:place], *part, *tidy[place + 1 :]] for part in parts]
                break
        else:
            closed.append(tidy)
    return closed


def alternatives(f: Poly, ring: Ring) -> list[list[Poly]]:
    """The real zeros of one polynomial as a union of systems; [[f]] when nothing is gained."""
    factors = irreducible_factors(f)
    if len(factors) != 1 or factors[0] != f:
        return [[g] for g in factors]
    return real_systems([f], ring)


def real_systems(system: list[Poly], ring: Ring) -> list[list[Poly]]:
    """A sum of squares of monomials vanishes over the reals only where every monomial does."""
    f = system[0]
    terms = f.to_dict()
    signs = {int(c) > 0 for c in terms.values()}
    if len(terms) < 2 or len(signs) > 1 or any(p % 2 for powers in terms for p in powers):
        return [system]
    if any(not any(powers) for powers in terms):
        return []  # a positive constant beside squares
    return [[ring.context.from_dict({tuple(min(p, 1) for p in powers): 1}) for powers in terms]]


def tidied(system: list[Poly], ring: Ring) -> list[Poly] | None:
    """Reduced generators of the same real zeros; None when there are none."""
    system = [p.primitive()[1] for p in system if p != 0]
    if any(p.is_constant() for p in system) or nowhere(system, ring):
        return None
    kept: list[Poly] = []
    for p in sorted(dict.fromkeys(map(Hashed, system)), key=lambda h: (h.poly.total_degree(), len(h.poly))):
        if not any(divides(q, p.poly) for q in kept):
            kept.append(p.poly)
    if len(kept) > 1:
        generators: Any = fmpz_mpoly_vec(kept, ring.context)
        basis, done = generators.buchberger_naive(limits=LIMITS)
        if done:
            reduced = [p for p in basis.autoreduction(groebner=True) if p != 0]
            if any(p.is_constant() for p in reduced) or nowhere(reduced, ring):
                return None
            kept = reduced
    return kept


def nowhere(system: Sequence[Poly], ring: Ring) -> bool:
    """Sine and cosine of half an angle do not vanish together."""
    gens = [(ring.context.gen(sine), ring.context.gen(cosine)) for sine, cosine in ring.pairs()]
    return any(all(any(f == g or f == -g for f in system) for g in pair) for pair in gens)


@dataclass(frozen=True, slots=True)
class Hashed:
    """A polynomial that can stand in a set: equal texts are equal polynomials of one ring."""

    poly: Poly

    def __hash__(self) -> int:
        return hash(str(self.poly))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Hashed) and self.poly == other.poly


def irredundant(systems: list[list[Poly]]) -> list[list[Poly]]:
    """Without repetitions and without systems that lie inside another one."""
    kept: list[list[Poly]] = []
    for system in sorted(systems, key=lambda s: (len(s), [len(f) for f in s], [str(f) for f in s])):
        if not any(all(vanishes(f, system) for f in other) for other in kept):
            kept.append(system)
    return kept


def vanishes(value: Poly, system: System) -> bool:
    """Whether a polynomial lies in the ideal of a system that is its own Groebner basis."""
    if value == 0 or not system:
        return bool(value == 0)
    if any(divides(f, value) for f in system):
        return True
    generators: Any = fmpz_mpoly_vec(system, value.context())
    reduced: Any = value
    return bool(reduced.reduction_primitive_part(generators) == 0)
