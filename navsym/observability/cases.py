"""Where the rank of a polynomial matrix is smaller than its generic rank, by cases on pivots.

Elimination up to the wanted rank r finds a minor D that is not the zero polynomial: off D = 0 the rank is r.
On every component of D = 0 the question is asked again, with the equations of the component at hand: entries
that vanish there are no pivots. Two answers end a case:

* the elimination stops before r although its pivot does not vanish on the component: there the rank is
  smaller everywhere (bordered minors, and semicontinuity of the rank on an irreducible set);
* D is a number: no drop.

Components get smaller from case to case, so that this ends; what ends a case early is counted and reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from navsym.core.errors import TooLargeError
from navsym.observability.linear import Matrix, clear_column, sparsest
from navsym.observability.reduction import System, components, lies_in_ideal, take_out_regular
from navsym.observability.ring import Poly, Ring, irreducible_factors

#: Cases looked at, and depth of equations; beyond them the list is not called complete.
CASES = 60
DEPTH = 6
#: Different minors that one case looks at: more of them leave fewer components to examine.
MINORS = 3
#: A variable is replaced by at most so many terms; longer solutions stay equations.
SOLUTION = 120
#: Products of terms for one entry on the way; beyond that a minor is not formed, and the list not called complete.
PRODUCTS = 60_000


@dataclass(slots=True)
class Search:
    """The state of the search: systems on which the rank drops, cases left, and whether all were decided."""

    ring: Ring
    found: list[System] = field(default_factory=list)
    seen: set[str] = field(default_factory=set)
    cases: int = 0
    complete: bool = True


def drops_by_cases(rows: Matrix, rank: int, ring: Ring) -> tuple[list[System], bool]:
    """Systems of equations on which the rank of the rows is below ``rank``, and whether these are all.

    rank is the generic rank of the rows. The union of the real zeros of the systems is the drop locus.
    """
    search = Search(ring)
    visit(search, rows, rank, [])
    return search.found, search.complete


def visit(search: Search, rows: Matrix, rank: int, system: System) -> None:
    """One case: the drops among the real zeros of a system (all points for the empty one)."""
    name = "; ".join(sorted(map(str, system)))
    covered = any(all(lies_in_ideal(f, system) for f in other) for other in search.found)
    if name in search.seen or covered:  # its zeros visibly lie inside a drop that is known already
        return
    search.seen.add(name)
    search.cases += 1
    if search.cases > CASES or len(system) > DEPTH:
        search.complete = False
        return
    reduced = take_out_regular(substitute_rows(rows, system, search.ring), search.ring)
    wanted = rank - reduced.regular
    if wanted <= 0:
        return
    try:
        minors, pivot = minors_on(reduced.rows, wanted, system, search.ring)
    except TooLargeError:
        search.complete = False
        return
    if not minors and is_whole(search, rows, rank, system, pivot):
        search.found.append(system)
    elif not minors:
        # Off pivot = 0 the rank is smaller, but not everywhere: what is listed has to be a drop as it stands.
        search.complete = False
        for child in components([*system, pivot], search.ring):
            visit(search, rows, rank, child)
    elif not any(map(search.ring.is_unit, minors)):
        for child in components([*system, *minors], search.ring):
            visit(search, rows, rank, child)


def is_whole(search: Search, rows: Matrix, rank: int, system: System, pivot: Poly) -> bool:
    """True when the rank is proved to be smaller on all of a system on which elimination stopped at a pivot.

    Off pivot = 0 it is. An irreducible system has the rest in its closure; otherwise the part with
    pivot = 0 is examined on its own, and must be whole again.
    """
    if is_irreducible(system, search.ring) or search.ring.is_unit(pivot):
        return True
    ring = search.ring
    for part in components([*system, pivot], ring):
        search.cases += 1
        if search.cases > CASES:
            return False
        reduced = take_out_regular(substitute_rows(rows, part, ring), ring)
        try:
            minors, following = minors_on(reduced.rows, rank - reduced.regular, part, ring)
        except TooLargeError:
            return False
        if rank <= reduced.regular or minors or not is_whole(search, rows, rank, part, following):
            return False
    return True


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


def minors_on(rows: Matrix, wanted: int, system: System, ring: Ring) -> tuple[list[Poly], Poly]:
    """Some minors of the wanted size that do not vanish on the system, and the last pivot of the first try.

    The first minor decides; further ones are taken without a column of the one before.
    """
    columns = list(range(len(rows[0]))) if rows else []
    found: list[Poly] = []
    first: Poly = ring.constant(1)
    for attempt in range(MINORS):
        pivot, full, used = minor_on(rows, wanted, system, columns, ring)
        if attempt == 0:
            first = pivot
        if not full:
            break
        found.append(pivot)
        if ring.is_unit(pivot):
            break
        columns = [k for k in columns if k != used]
    return found, first


def minor_on(
    rows: Sequence[list[Poly]], wanted: int, system: System, columns: Sequence[int], ring: Ring
) -> tuple[Poly, bool, int]:
    """(last pivot, whether it is a minor of the wanted size, its column) of an elimination on a system.

    Bareiss' elimination over the polynomials, exact whatever the pivots are; pivots must not vanish on the
    system. When only vanishing entries are left, all larger minors around the last one vanish.
    """
    work, free = [list(row) for row in rows], list(columns)
    last, used = ring.constant(1), -1
    for step in range(wanted):
        place = pivot_on(work, step, free, system)
        if place is None:
            return last, False, used
        i, used = place
        if len(work[i][used]) * max(len(entry) for row in work[step:] for entry in row) > PRODUCTS:
            raise TooLargeError(f"expected entries of at most {PRODUCTS} products; got more; fix some parameters")
        work[step], work[i] = work[i], work[step]
        clear_column(work, step, used, last)
        last = work[step][used]
        free.remove(used)
    return last, True, used


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
