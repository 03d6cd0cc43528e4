"""Equations that name variables, put into rows, and minors that do not vanish where equations hold.

Elimination up to the wanted rank r finds a minor D that is not zero on a set of points: off D = 0 the rank there is r.
Entries that vanish on the set are no pivots.
"""

from __future__ import annotations

from collections.abc import Sequence

from navsym.core.errors import TooLargeError
from navsym.observability.linear import Matrix, clear_column, sparsest
from navsym.observability.reduction import System, lies_in_ideal
from navsym.observability.ring import Poly, Ring, irreducible_factors

#: Different minors that one case looks at: more of them leave fewer components to examine.
MINORS = 3
#: A variable is replaced by at most so many terms; longer solutions stay equations.
SOLUTION = 120
#: Products of terms for one entry on the way; beyond that a minor is not formed.
PRODUCTS = 60_000


def is_irreducible(system: System, ring: Ring) -> bool:
    """True when all equations but one name a variable each: a graph over an irreducible hypersurface."""
    rest = [f for f, place in solved_variables(system, ring) if place is None]
    return not rest or (len(rest) == 1 and irreducible_factors(rest[0]) in ([rest[0]], [-rest[0]]))


def solved_variables(system: System, ring: Ring) -> list[tuple[Poly, int | None]]:
    """Every equation f with the place of a variable x that it names; None where it names none.

    f = c x - g, where c is a unit without x, and x stands in no other equation.
    """
    held = [f.degrees() for f in system]
    uses = [sum(map(bool, degrees)) for degrees in zip(*held, strict=True)]
    found: list[tuple[Poly, int | None]] = []
    for f, degrees in zip(system, held, strict=True):
        places = (k for k, degree in enumerate(degrees) if degree == 1 == uses[k])
        found.append((f, next((k for k in places if ring.is_unit(f.derivative(k))), None)))
    return found


def substitute_row(row: list[Poly], system: System, ring: Ring) -> list[Poly]:
    """The row with the variables that the system solves for replaced; a row times a unit."""
    return substitute_rows([row], system, ring)[0]


def substitute_rows(rows: Matrix, system: System, ring: Ring) -> Matrix:
    """The rows with the variables that the system solves for replaced; rows times units."""
    for f, place in solved_variables(system, ring):
        if place is not None and len(f) <= SOLUTION:
            rows = [replace_in_row(row, f, place, ring) for row in rows]
    return rows


def replace_in_row(row: list[Poly], f: Poly, place: int, ring: Ring) -> list[Poly]:
    """x = g/c in every entry of a row, times the power of c that keeps polynomials; f = c x - g."""
    degree = max(int(entry.degrees()[place]) if entry != 0 else 0 for entry in row)
    if degree == 0:
        return row
    factor = f.derivative(place)
    value = factor * ring.context.gen(place) - f
    return [replace_in_entry(entry, place, value, factor, degree, ring) for entry in row]


def replace_in_entry(entry: Poly, place: int, value: Poly, factor: Poly, degree: int, ring: Ring) -> Poly:
    """c^degree times the entry at x = value/c."""
    total = ring.constant(0)
    for power in range(entry.degrees()[place] if entry != 0 else 0, 0, -1):
        lead = entry
        for k in range(power):
            lead = lead.derivative(place) / (k + 1)
        entry = entry - lead * ring.context.gen(place) ** power
        total += lead * value**power * factor ** (degree - power)
    return total + entry * factor**degree


def minors_on(rows: Matrix, wanted: int, system: System, ring: Ring) -> list[Poly]:
    """Some minors of the wanted size that do not vanish on the system; none where it has none.

    The first minor decides; further ones are taken without a column of the one before.
    """
    columns, found = list(range(len(rows[0]))), list[Poly]()
    for _ in range(MINORS):
        minor, used = minor_on(rows, wanted, system, columns, ring)
        if minor is None:
            break
        found.append(minor)
        if ring.is_unit(minor):
            break
        columns = [k for k in columns if k != used]
    return found


def minor_on(
    rows: Sequence[list[Poly]], wanted: int, system: System, columns: Sequence[int], ring: Ring
) -> tuple[Poly | None, int]:
    """(minor of the wanted size or None, the column of its last pivot) of an elimination on a system.

    Bareiss' elimination over the polynomials, exact whatever the pivots are; pivots must not vanish on the
    system. When only vanishing entries are left, all larger minors around the last one vanish.
    """
    work, free = [list(row) for row in rows], list(columns)
    last, used = ring.constant(1), -1
    for step in range(wanted):
        place = pivot_on(work, step, free, system)
        if place is None:
            return None, used
        i, used = place
        if len(work[i][used]) * max(len(entry) for row in work[step:] for entry in row) > PRODUCTS:
            raise TooLargeError(f"expected entries of at most {PRODUCTS} products; got more; fix some parameters")
        work[step], work[i] = work[i], work[step]
        clear_column(work, step, used, last)
        last = work[step][used]
        free.remove(used)
    return last, used


def pivot_on(work: Matrix, step: int, free: Sequence[int], system: System) -> tuple[int, int] | None:
    """The sparsest entry that does not vanish on the system; entries that do are set aside."""
    if not work:
        return None
    zero = 0 * work[0][0]
    shown = [list(row) for row in work]
    while True:
        place = sparsest(shown, step, free)
        if place is None or not lies_in_ideal(shown[place[0]][place[1]], system):
            return place
        shown[place[0]][place[1]] = zero
