"""Weaker senses of equality: what differs as it stands may be equal on a tangent space, up to an order, or renamed.

A sense turns entries into readings: other pairs of formulas, which are decided like every entry, by the checker. So a
sense is never assumed. One that a question does not admit makes nothing PROVED; the answer says that it would hold.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations, combinations_with_replacement, product
from typing import Any

from navsym.audit.decide import (
    REAL,
    TRIES,
    Decision,
    Scope,
    decide_entry,
    differentiate,
    draw_points,
    list_values,
    measure,
    value_at,
)
from navsym.audit.questions import SENSES, Entry, Question
from navsym.audit.values import Array, Scalar, make_array, matrix_product, transpose
from navsym.claims.verdict import CERTIFIED, OPEN, PROVED, REFUTED, Status
from navsym.core.errors import NavsymError
from navsym.language.polynomials import to_polynomial
from navsym.language.printer import print_tree
from navsym.language.tree import ZERO, Tree, build_product, build_sum, build_symbol, list_names, negate
from navsym.language.tree import replace as replace_parts
from navsym.prove.rooms.goals import player
from navsym.prove.search import Rounds

SMALL = re.compile(r"(?:^|[.>:])(?:dt|delta_?t)$", re.IGNORECASE)  # how a step of time is spelled
BRIEF = 4_000  # characters of an entry of which weaker senses are tried though nobody admits them
SHORT = TRIES[:2]  # the search for such a one
MOST_PAIRS = 400
MOST_STATES = 24
MOST_ORDERS = 8
MOST_STEPS = 20_000


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """What has to be equal in a weaker sense.

    note   : what is used, in words
    places : the entries of the table of which it speaks
    pairs  : code and expectation
    order  : a small symbol and the order of what may be left over
    ranges : of symbols that are no inputs
    """

    note: str
    places: frozenset[int]
    pairs: tuple[tuple[Tree, Tree], ...]
    order: Mapping[str, int] = field(default_factory=dict)
    ranges: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Table:
    """The entries of one matrix, in one case of the code, with all relations and approximations of the sources."""

    question: Question
    entries: list[Entry]
    scope: Scope
    decided: dict[Reading, Decision] = field(default_factory=dict)
    readings: dict[str, list[Reading | None]] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return max(e.place[0] for e in self.entries), max(e.place[1] for e in self.entries)

    @cached_property
    def is_whole(self) -> bool:
        """True when every entry is there, and read on both sides."""
        m, n = self.shape
        return len(self.entries) == m * n and all(map(is_read, self.entries))

    @cached_property
    def by(self) -> list[Tree]:
        """The inputs that columns belong to, where the question names them."""
        asking, keys = self.entries[0].asking, self.question.keys
        return asking.inputs(keys["by"], "by") if asking is not None and "by" in keys else []

    def pair(self, k: int) -> tuple[Tree, Tree]:
        """Code and expectation of an entry that is read."""
        code, expected = self.entries[k].code, self.entries[k].expected
        assert isinstance(code, Scalar) and isinstance(expected, Scalar)
        return code.tree, expected.tree

    def list_readings(self, sense: str) -> list[Reading | None]:
        """What a sense asks; None in it for readings that are left out."""
        if sense not in self.readings:
            self.readings[sense] = [*READERS[sense](self)]
        return self.readings[sense]

    def decide(self, reading: Reading, rounds: Rounds) -> Decision:
        """The verdict on a reading: REFUTED where one pair is, PROVED where all are."""
        if reading in self.decided:
            return self.decided[reading]
        own = {**self.scope.ranges, **reading.ranges}
        certificates, answer, status = list[Any](), Decision(OPEN), PROVED
        for code, expected in reading.pairs:
            used = {*list_names(code, expected)}
            near = tuple(r for r in self.scope.relations if used & {*list_names(r)} and not reading.order)
            scope = replace(self.scope, ranges=own, relations=near, order=reading.order)
            answer = decide_entry(code, expected, scope, rounds)
            if not answer.status.holds:
                break
            certificates.append(answer.certificate)
            status = max(status, answer.status, key=(PROVED, CERTIFIED).index)
        status = status if answer.status.holds else answer.status
        whole = certificates[0] if len(certificates) == 1 else {"kind": "all", "of": certificates}
        self.decided[reading] = Decision(status, certificate=whole if status.holds else None, why=reading.note)
        return self.decided[reading]


def is_read(entry: Entry) -> bool:
    """True for an entry with formulas on both sides."""
    return isinstance(entry.code, Scalar) and isinstance(entry.expected, Scalar)


def weaken(question: Question, entries: Sequence[Entry], decisions: list[Decision], scopes: Sequence[Scope]) -> None:
    """Put weaker verdicts in the place of those that do not hold: of the senses that the question admits.

    Where none is admitted, and the whole question holds in one sense, the reason says so.
    """
    admitted = question.keys.get("senses", ())
    places: dict[Any, list[int]] = {}
    for k, entry in enumerate(entries):
        places.setdefault((id(entry.asking), entry.key), []).append(k)
    waiting = list[tuple[Table, int, int]]()
    for several in places.values():
        scope = replace(scopes[several[0]], relations=question.relations())
        table = Table(question, [entries[k] for k in several], scope)
        failing = [k for k in several if not decisions[k].status.holds and is_read(entries[k])]
        waiting += [(table, several.index(k), k) for k in failing]
    for table, at, k in waiting:
        decisions[k] = admit(table, at, decisions[k], admitted)
    failed = [(table, at, k) for table, at, k in waiting if not decisions[k].status.holds]
    is_brief = all(sum(map(measure, table.pair(at))) <= BRIEF for table, at, _ in failed)
    if not failed or not is_brief or not all(map(is_read, entries)):
        return
    for sense in SENSES[2:]:
        notes = dict[int, str]()
        for table, at, k in failed if sense not in admitted else ():
            if (found := hold(table, at, sense, SHORT)) is None or not found.status.holds:
                break
            notes[k] = f'not exact, but {found.why} (sense {sense}, which senses = ["{sense}"] admits)'
        if len(notes) == len(failed):
            for k, note in notes.items():
                why = "; ".join(filter(None, (decisions[k].why, note)))
                decisions[k] = replace(decisions[k], weaker=sense, why=why)
            return


def admit(table: Table, at: int, exact: Decision, senses: Sequence[str]) -> Decision:
    """The verdict on an entry when these senses are admitted, too: PROVED in the first that holds.

    It is REFUTED only where all of them are, and OPEN where one of them is not decided.
    """
    undecided = list[str]()
    for sense in sorted(senses, key=SENSES.index):
        if (found := hold(table, at, sense, TRIES)) is not None and found.status.holds:
            return replace(found, sense=sense)
        if found is None or found.status == OPEN:
            undecided.append(sense)
    if undecided and exact.status == REFUTED:
        return Decision(OPEN, why=f"not exact, and not decided in the sense {' or '.join(undecided)}")
    return exact


def hold(table: Table, at: int, sense: str, rounds: Rounds) -> Decision | None:
    """Whether an entry holds in a sense: by one of its readings; None where it cannot be asked."""
    readings = [r for r in table.list_readings(sense) if r is None or at in r.places]
    if not readings or not is_read(table.entries[at]):
        return None
    worst: Status = REFUTED
    for reading in readings:
        found = table.decide(reading, rounds) if reading is not None else Decision(OPEN)
        if found.status.holds:
            return found
        worst = OPEN if found.status == OPEN else worst
    return Decision(worst)


# The senses


def read_tangent(table: Table) -> Iterator[Reading]:
    """Rows that agree on all vectors v tangent to the relations: code v = expected v for moves v that span these.

    Of r(x) = p(x) - c with p homogeneous and c not zero, whose gradient is nowhere zero, they have r_j at i and -r_i at
    j; of a rotation matrix C they are C skew(e_k). Other columns have to agree as they are.
    """
    m, n = table.shape
    moves, words = list_moves(table) if table.is_whole and table.by else ([], [])
    rows = [range(i * n, i * n + n) for i in range(m)] if n == len(table.by) else [range(m)] if n == 1 else []
    for row in rows if moves and all(len(row) == len(table.by) for row in rows) else []:
        sides = {x: table.pair(k) for x, k in zip(table.by, row, strict=True)}
        pairs = [pair for x, pair in sides.items() if not any(x in move for move in moves)]
        for move in moves:
            along = [[build_product(sides[x][s], slope) for x, slope in move.items()] for s in (0, 1)]
            pairs.append((build_sum(*along[0]), build_sum(*along[1])))
        yield Reading(f"equal on the tangent space of {' and '.join(words)}", frozenset(row), tuple(pairs))


def list_moves(table: Table) -> tuple[list[dict[Tree, Tree]], list[str]]:
    """Vectors that span the tangent space, by columns, and the relations in words.

    There are none where a relation has another form, or two of them have a symbol in common.
    """
    by, taken, moves, words = {x.args[0]: x for x in table.by}, set[str](), list[dict[Tree, Tree]](), list[str]()
    of_rotations = set[str]()
    for name, entries in table.question.names.rotations.items():
        of_rotations |= {*entries}
        if not {*entries} & {*by}:
            continue
        if not {*entries} <= {*by}:
            return [], []
        columns = [[by[entry] for entry in entries[j::3]] for j in range(3)]
        for a, b in ((0, 1), (1, 2), (2, 0)):
            turned = zip(columns[a], columns[b], strict=True)
            moves.append({x: slope for p, q in turned for x, slope in ((p, q), (q, negate(p)))})
        words.append(f"the rotation {name}")
    for relation in table.scope.relations:
        names = list_names(relation)
        if {*names} <= of_rotations or not {*names} & {*by}:
            continue
        is_new = {*names} <= {*by} and not {*names} & (taken | of_rotations)
        if not is_new or not is_level(relation, names):
            return [], []
        taken |= {*names}
        slopes = {by[name]: differentiate(relation, by[name]) for name in names}
        moves += [{x: slopes[y], y: negate(slopes[x])} for x, y in combinations(slopes, 2)]
        words.append(f"{show(table, relation)} = 0")
    return moves, words


def is_level(relation: Tree, names: list[str]) -> bool:
    """True for p(x) - c with p homogeneous and c not zero: by Euler p' x = m p, so that p' is not zero where p = c."""
    try:
        terms = to_polynomial(relation, names).to_dict()
    except NavsymError:
        return False
    return len({int(sum(powers)) for powers in terms}) == 2 and (0,) * len(names) in terms and len(names) > 1


def read_order(table: Table) -> Iterator[Reading]:
    """Entries that differ by O(s**n) in a small input s, or in several with one factor s."""
    symbols, orders, words = find_small(table)
    held = {n for c in table.scope.conditions for t in (c.left, c.right) if t is not None for n in list_names(t)}
    if not symbols or held & {*symbols} or any(c.left is None for c in table.scope.conditions):
        return
    small, by, ranges = symbols[0], dict[Tree, Tree](), dict[str, Any]()
    if len(symbols) > 1:
        small = table.question.names.free_name("scale")
        by = {build_symbol(s): build_product(build_symbol(small), build_symbol(s)) for s in symbols}
        ranges = {small: ["0", "1", []]}
        if any(table.scope.ranges[s] != REAL for s in symbols):
            return
    for k in range(len(table.entries)):
        for n in orders if is_read(table.entries[k]) else ():
            code, expected = (replace_parts(tree, by) for tree in table.pair(k))
            note = f"equal up to order {n - 1} in {words}"
            yield Reading(note, frozenset({k}), ((code, expected),), {small: n}, ranges)


def find_small(table: Table) -> tuple[list[str], Sequence[int], str]:
    """The small symbols, the orders that may be left over, and their spelling: as declared, or the step of time."""
    keys, names, asking = table.question.keys, table.question.names, table.entries[0].asking
    if "order" in keys and asking is not None:
        symbols = [x.args[0] for x in asking.inputs(keys["order"]["of"], "order")]
        return symbols, (keys["order"]["up_to"] + 1,), ", ".join(names.spellings.get(s, s) for s in symbols)
    steps = [s for s, spelling in names.spellings.items() if SMALL.search(spelling)]
    return (steps, (4, 3, 2), names.spellings[steps[0]]) if len(steps) == 1 else ([], (), "")


def read_approximation(table: Table) -> Iterator[Reading]:
    """Entries that are equal when one thing is put for another, as the mapping declares, on both sides."""
    listed = [a for source in table.question.sources.values() for a in source.approximations]
    for k in [k for k, entry in enumerate(table.entries) if is_read(entry)]:
        code, expected = table.pair(k)
        used = [(a, b) for a, b in listed if any(replace_parts(t, {a: b}) is not t for t in (code, expected))]
        if used:
            words = ", ".join(f"{show(table, a)} = {show(table, b)}" for a, b in used)
            pair = replace_parts(code, dict(used)), replace_parts(expected, dict(used))
            yield Reading(f"equal under {words}", frozenset({k}), (pair,))


def read_noise(table: Table) -> Iterator[Reading]:
    """Matrices V, W of noise with V N V' = W N W' for every covariance N, or for every diagonal one."""
    kind, (m, n) = table.question.keys.get("noise"), table.shape
    if kind is None or not table.is_whole or m * (m + 1) > 2 * MOST_PAIRS or n > MOST_STATES:
        return
    names = {(i, j): table.question.names.free_name(f"noise{i + 1}_{j + 1}") for i in range(n) for j in range(i, n)}
    is_full = kind == "any"
    cells = {place: Scalar(build_symbol(name)) for place, name in names.items()}
    N = make_array((n, n), lambda i, j: cells[min(i, j), max(i, j)] if is_full or i == j else Scalar(ZERO))
    sides = []
    for side in (0, 1):
        V = Array((m, n), tuple(Scalar(table.pair(k)[side]) for k in range(m * n)))
        sides.append(matrix_product(matrix_product(V, N), transpose(V, True)).cells)
    upper = [i * m + j for i, j in combinations_with_replacement(range(m), 2)]
    pairs = [(sides[0][k].tree, sides[1][k].tree) for k in upper]  # type: ignore[union-attr]
    note = f"V N V' is equal for every {'' if is_full else 'diagonal '}covariance N"
    yield Reading(note, frozenset(range(m * n)), tuple(pairs), {}, dict.fromkeys(names.values(), REAL))


def read_renamed(table: Table) -> Iterator[Reading | None]:
    """Square matrices that are equal with rows and columns in another order, and the states in their entries with them.

    Orders are sought at a point, in balls: what differs there differs. None stands for those that were not tried.
    """
    m, n = table.shape
    values = find_values(table) if m == n <= MOST_STATES and table.is_whole else None
    if values is None or len(table.by) not in (0, n):
        return
    orders, is_complete = list_orders(*values)
    for order in orders:
        by = {table.by[i]: table.by[order[i]] for i in range(len(table.by))}
        moved = [table.pair(i * n + j)[0] for i, j in product(order, repeat=2)]
        pairs = [(code, replace_parts(table.pair(k)[1], by)) for k, code in enumerate(moved)]
        words = ", ".join(str(i + 1) for i in order)
        yield Reading(f"equal with the states in the order {words}", frozenset(range(n * n)), tuple(pairs))
    if not is_complete:
        yield None
    elif not orders:  # no order is left at a point: what is different stays so
        differing = [k for k in range(n * n) if not values[0][k // n][k % n].overlaps(values[1][k // n][k % n])]
        yield Reading("", frozenset(range(n * n)), tuple(table.pair(k) for k in differing))


Balls = list[list[Any]]


def find_values(table: Table) -> tuple[Balls, Balls] | None:
    """Both matrices at a point of the scope at which all states are one number; None where there is none."""
    (n, _), pairs = table.shape, [table.pair(k) for k in range(len(table.entries))]
    sides = [tree for pair in pairs for tree in pair]
    conditions = [t for c in table.scope.conditions for t in (c.left, c.right) if t is not None]
    names = list_names(*sides, *table.scope.relations, *conditions)
    box = {name: player.read_range(table.scope.ranges[name]) for name in names}
    terms = [player.parse(print_tree(tree)) for tree in sides]
    states = [x.args[0] for x in table.by if x.args[0] in box]
    drawn = draw_points(box, table.scope)
    points = (point | dict.fromkeys(states, point[states[0]]) if states else point for point in drawn)
    points = (p for p in points if all(player.is_inside(("number", value), box[name]) for name, value in p.items()))
    points = (p for p in points if all(value_at(relation, p) == 0 for relation in table.scope.relations))
    for _, balls in list_values(terms, points, table.scope.conditions):
        code, expected = ([balls[2 * (i * n) + side :][: 2 * n : 2] for i in range(n)] for side in (0, 1))
        return code, expected
    return None


def list_orders(code: Balls, expected: Balls) -> tuple[list[tuple[int, ...]], bool]:
    """Orders p with code[p_i][p_j] = expected[i][j] as far as balls tell, and whether these are all."""
    n, found, steps = len(code), list[tuple[int, ...]](), 0
    waiting: list[tuple[int, ...]] = [()]
    while waiting:
        order = waiting.pop()
        steps += 1
        if steps > MOST_STEPS or len(found) > MOST_ORDERS:
            return found, False
        if len(order) == n:
            found.append(order)
            continue
        i = len(order)
        for new in reversed([k for k in range(n) if k not in order]):
            several = [*enumerate((*order, new))]
            is_row = all(code[new][p].overlaps(expected[i][j]) for j, p in several)
            if is_row and all(code[p][new].overlaps(expected[j][i]) for j, p in several):
                waiting.append((*order, new))
    return found, True


def show(table: Table, tree: Tree) -> str:
    """A formula in the spelling of the source."""
    return table.question.names.show(print_tree(tree))


WEAKER = (read_tangent, read_order, read_approximation, read_noise, read_renamed)
READERS: dict[str, Any] = dict(zip(SENSES[2:], WEAKER, strict=True))
