"""One entry decided: what the code computes beside what it should be, granted by the checker.

Search finds a proof, below the declared relations where they are needed, or a point; the statement with its proof, or
the point, goes to the checker as text. Nothing else makes an entry PROVED or REFUTED.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpq_mat

from navsym.audit.cases import Condition
from navsym.claims.verdict import CERTIFIED, OPEN, PROVED, REFUTED, Status
from navsym.core.errors import DomainError, NavsymError, TooLargeError
from navsym.language.domains import rational_value
from navsym.language.expression import read_tree
from navsym.language.polynomials import to_polynomial
from navsym.language.printer import print_tree
from navsym.language.tree import (
    NUMBER,
    POWER,
    PRODUCT,
    SUM,
    SYMBOL,
    ZERO,
    Tree,
    build,
    build_number,
    build_sum,
    build_symbol,
    fold_tree,
    list_names,
    list_parts,
    negate,
    parts_of,
)
from navsym.language.tree import replace as replace_parts
from navsym.prove.grant import IDENTITY, REFUSALS, find_witness, grant, refute_document
from navsym.prove.rooms.goals import player, simple_point, write_term
from navsym.prove.search import ROUNDS, Rounds, find_proof, rules_of

#: Of the search for one entry.
TRIES = ROUNDS[:3]
REAL: list[Any] = [None, None, []]  # the range of a symbol that stands for a part
LONG = 1_500  # characters of both sides: shared parts are named
TOGETHER = 40  # long entries that are proved at once
LONGEST = 200_000  # characters of one side
POINTS = 24
BITS = 128
#: Values that are tried first in the place of a symbol: small, and different from each other.
SIMPLE = [fmpq(p, q) for p, q in ((1, 1), (2, 1), (3, 1), (1, 2), (-1, 1), (5, 1), (1, 3), (-2, 1), (7, 1), (3, 2))]

Document = dict[str, Any]
Point = dict[str, fmpq]


@dataclass(frozen=True, slots=True)
class Decision:
    """The verdict on one entry.

    sense  : "exact", or "manifold" where the declared relations were used; weaker ones are put in by audit.senses
    weaker : of an entry that does not hold, a sense in which the whole question would
    point  : of REFUTED, symbol -> exact number
    values : of REFUTED, the code's value and the expected one there
    """

    status: Status
    sense: str = "exact"
    point: Mapping[str, str] | None = None
    values: tuple[str, str] | None = None
    why: str = ""
    certificate: Mapping[str, Any] | None = None
    weaker: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Scope:
    """Where an entry has to hold.

    ranges     : symbol -> its range in the words of the checker
    relations  : polynomials of the symbols that are zero
    conditions : of the case in which the code is
    order      : a small symbol -> n, where the sides have to be equal up to O(symbol**n) only
    rotations  : nine symbols each, row by row
    """

    ranges: Mapping[str, Any]
    relations: tuple[Tree, ...] = ()
    conditions: tuple[Condition, ...] = ()
    order: Mapping[str, int] = field(default_factory=dict)
    rotations: tuple[tuple[str, ...], ...] = ()


def decide_entry(code: Tree, expected: Tree, scope: Scope, rounds: Rounds = TRIES) -> Decision:
    """Whether the code computes what is expected, at all points of the scope."""
    length = measure(code) + measure(expected)
    try:
        if length > LONG and (granted := prove_shared([(code, expected)], scope).get((code, expected))) is not None:
            return Decision(PROVED, certificate=granted)
        if length > LONGEST:
            return Decision(OPEN, why="a formula of more than 200,000 characters")
        document = write_document(code, expected, replace(scope, relations=()))
        if (granted := prove_document(document)) is not None:
            return Decision(PROVED, certificate=granted)
        dark = next((c for c in scope.conditions if c.left is None), None)
        refuted = refute(document, code, expected, scope) if dark is None else None
        if refuted is not None:
            return refuted
        if scope.relations:
            lower = search_proof(write_document(code, expected, scope), scope, rounds)
            if lower.status.holds:
                return replace(lower, sense="manifold")
        # of a case of a condition that is not read nobody knows whether a point is in it
        why = "" if dark is None else f"in a case of a condition that is not read: {dark.text}"
        return search_proof(document, scope, rounds, why)
    except REFUSALS as refusal:
        return Decision(OPEN, why=f"not granted: {refusal}")
    except NavsymError as error:
        return Decision(OPEN, why=error.message)


def decide_together(pairs: Sequence[tuple[Tree, Tree]], scope: Scope) -> dict[tuple[Tree, Tree], Decision]:
    """The verdicts on long entries that are proved by the parts that they share, many by one certificate."""
    long, done = [pair for pair in pairs if sum(map(measure, pair)) > LONG], dict[tuple[Tree, Tree], Document]()
    for first in range(0, len(long), TOGETHER):
        done |= prove_shared(long[first : first + TOGETHER], scope)
    return {pair: Decision(PROVED, certificate=certificate) for pair, certificate in done.items()}


def measure(tree: Tree) -> int:
    """About how many characters a tree has when it is written out."""
    return fold_tree(tree, lambda part, inner: sum(inner) + 3 * len(inner) + (8 if not inner else 2))


def write_document(code: Tree, expected: Tree, scope: Scope) -> Document:
    """The statement in the words of the checker, with the relations as hypotheses."""
    names = list_names(code, expected, *scope.relations, *map(build_symbol, scope.order))
    given = [f"{print_tree(relation)} = 0" for relation in scope.relations]
    symbols = {name: scope.ranges[name] for name in names}
    document = write_equation(print_tree(code), print_tree(expected), symbols, given)
    return document | ({"order": dict(scope.order)} if scope.order else {})


def write_equation(left: str, right: str, symbols: Mapping[str, Any], given: Sequence[str]) -> Document:
    """An equation in the words of the checker, below hypotheses."""
    document: Document = {"left": left, "relation": "=", "right": right, "symbols": symbols}
    document |= {"exists": [], "tolerance": None}
    return document | ({"shapes": {}, "given": given, "rates": {}} if given else {})


def prove_document(document: Document) -> Document | None:
    """The certificate of an identity that the checker has granted; None where it has not."""
    (case,), box = player.read_statement(document)
    witness = find_witness(case.terms, box)[1]
    if witness is None or not all(player.is_identity(goal.term) for goal in case.goals):
        return None
    certificate = write_proof(document, witness, [IDENTITY for _ in case.goals])
    return certificate if grant([document], certificate) == "HOLDS" else None


def write_proof(document: Document, witness: Mapping[str, str], proofs: list[Any]) -> Document:
    """The certificate of a statement with a proof for each of its goals."""
    return {"kind": "proof", "statement": document, "bits": BITS, "witness": witness, "proofs": proofs}


def prove_shared(pairs: Sequence[tuple[Tree, Tree]], scope: Scope) -> dict[tuple[Tree, Tree], Document]:
    """The certificates of identities in shared parts, with their meanings as hypotheses; one for several pairs."""
    done = dict[tuple[Tree, Tree], Document]()
    for equal, short in shorten_pairs(pairs):
        inputs, (left, right) = short.inputs(), zip(*short.pairs, strict=True)
        numbers = [simple_point(player.read_range(scope.ranges[name]), i % 2) for i, name in enumerate(inputs)]
        point = {name: Fraction(int(q.p), int(q.q)) for name, q in zip(inputs, numbers, strict=True)}
        code, expected = (f"[{', '.join(map(print_tree, side))}]" for side in (left, right))
        given = [f"{name} = {print_tree(tree)}" for name, tree in short.meanings.items()]
        ranges = {name: scope.ranges[name] for name in inputs} | dict.fromkeys(short.meanings, REAL)
        document = write_equation(code, expected, ranges, given)
        try:
            witness = {name: str(value) for name, value in short.complete(point).items()}
            certificate = write_proof(document, witness, [IDENTITY for _ in equal])
            if grant([document], certificate) == "HOLDS":
                done |= dict.fromkeys(equal, certificate)
        except (*REFUSALS, TooLargeError):
            continue
    return done


def search_proof(document: Document, scope: Scope, rounds: Rounds, why: str = "") -> Decision:
    """What the search for proof trees makes of the statement; ``why`` it is left open otherwise."""
    (case,), box = player.read_statement(document)
    if "given" in document:  # a point at which the relations hold, too
        near = list_values(case.terms, draw_points(box, scope))
        witness = next(({name: str(value) for name, value in point.items()} for point, _ in near), None)
    else:
        witness = find_witness(case.terms, box)[1]
    if witness is None:
        return Decision(OPEN, why="no point was found at which both sides have a value")
    proofs = [find_proof(goal, rounds=rounds) for goal in case.goals]
    if None in proofs:
        return Decision(OPEN, why=why or "no proof and no counterexample was found")
    certificate = write_proof(document, witness, proofs)
    grant([document], certificate)
    return Decision(CERTIFIED if "balls" in rules_of(proofs) else PROVED, certificate=certificate)


# Counterexamples


def refute(document: Document, code: Tree, expected: Tree, scope: Scope) -> Decision | None:
    """REFUTED by a point of the scope, with both values; None where none is found."""
    (case,), box = player.read_statement(document)
    others = list_names(*scope.relations, *(t for c in scope.conditions for t in (c.left, c.right) if t is not None))
    whole = {**box, **{n: player.read_range(scope.ranges[n]) for n in others if n not in box}}
    goals = [goal.term for goal in case.goals]
    for point, values in list_values([*goals, *case.terms], draw_points(whole, scope), scope.conditions):
        if not any(v > 0 or v < 0 for v in values[: len(goals)]):
            continue
        texts = {name: str(value) for name, value in point.items()}
        try:
            certificate = refute_document([document], document, {n: texts[n] for n in document["symbols"]})
        except REFUSALS:
            continue
        both = value_text(code, point), value_text(expected, point)
        return Decision(REFUTED, "exact", texts, both, "", certificate)
    return None


def list_values(
    terms: Sequence[Any], points: Iterable[Point], conditions: Sequence[Condition] = ()
) -> Iterator[tuple[Point, list[Any]]]:
    """Those of some points at which conditions hold and all terms have a value, with these values."""
    for point in points:
        place = {name: player.Jet(player.arb(value)) for name, value in point.items()}
        if all(holds_at(condition, place) for condition in conditions):
            values = [player.value_of(term, place) for term in terms]
            if all(value.is_finite() for value in values):
                yield point, values


def draw_points(box: Mapping[str, Any], scope: Scope) -> Iterator[Point]:
    """Simple exact points of the box at which the relations hold."""
    names = sorted(box)
    for k in range(POINTS):
        point = dict[str, fmpq]()
        for i, name in enumerate(names):  # a simple number of its range
            simple = SIMPLE[(i * (k // 3 + 1) + k) % len(SIMPLE)]
            is_inside = player.is_inside(("number", simple), box[name])
            point[name] = simple if is_inside else simple_point(box[name], k + i)
        for entries in scope.rotations:
            if {*entries} <= {*names}:
                turn(entries, point, k)
        solved = all(value_at(r, point) == 0 or meet(r, point, box) for r in scope.relations)
        if solved and all(value_at(relation, point) == 0 for relation in scope.relations):
            yield point


def turn(entries: Sequence[str], point: Point, trial: int) -> None:
    """Give nine symbols the entries of a rotation, E + 2 (w S + S S)/(w w + v v) with the skew matrix S of v."""
    w, *v = (SIMPLE[(trial + 3 * i) % len(SIMPLE)] for i in range(4))
    skew = fmpq_mat([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    square = w * w + sum(x * x for x in v)
    whole = fmpq_mat(3, 3, [int(i == j) for i in range(3) for j in range(3)]) + (skew * w + skew * skew) * (2 / square)
    point |= dict(zip(entries, whole.entries(), strict=True))


def meet(relation: Tree, point: Point, box: Mapping[str, Any]) -> bool:
    """Move a point onto a relation: a sphere by its rational points, others by a symbol that they hold linearly."""
    names = sorted(list_names(relation))
    try:
        polynomial = to_polynomial(relation, names)
    except (DomainError, TooLargeError):
        return False
    terms = polynomial.to_dict()
    unit = {tuple(2 * (i == k) for i in range(len(names))) for k in range(len(names))}
    scale = -terms.get((0,) * len(names), fmpq(0))
    if set(terms) == {*unit, (0,) * len(names)} and all(terms[e] == scale for e in unit):
        square = sum((point[name] ** 2 for name in names[1:]), fmpq(0))
        for name in names[1:]:
            point[name] = 2 * point[name] / (1 + square)
        point[names[0]] = (1 - square) / (1 + square)
    else:
        place = [point[name] for name in names]
        for at, name in enumerate(names):
            slope = polynomial.derivative(at)(*place) if polynomial.degrees()[at] == 1 else 0
            if slope != 0:
                point[name] -= polynomial(*place) / slope
                break
    return all(player.is_inside(("number", point[name]), box[name]) for name in names)


def value_at(tree: Tree, point: Point) -> Fraction | None:
    """The exact value of a rational formula at a point; None for others."""
    by = {build_symbol(name): build_number(Fraction(int(v.p), int(v.q))) for name, v in point.items()}
    return rational_value(replace_parts(tree, by))


def holds_at(condition: Condition, place: Mapping[str, Any]) -> bool:
    """True where a condition of the case surely is as the case says."""
    if condition.left is None or condition.right is None:
        return True
    term = player.parse(print_tree(build_sum(condition.left, negate(condition.right))))
    ball = player.value_of(term, dict(place))
    exact_zero = ball == 0
    truths = {
        "<": (ball < 0, ball >= 0), "<=": (ball <= 0, ball > 0), ">": (ball > 0, ball <= 0),
        ">=": (ball >= 0, ball < 0), "==": (exact_zero, ball != 0), "!=": (ball != 0, exact_zero),
    }  # fmt: skip
    return bool(ball.is_finite() and truths[condition.sign][0 if condition.holds else 1])


def value_text(tree: Tree, point: Point) -> str:
    """The value of a formula at a point: exact where it is rational, else to 15 digits."""
    used = {name: point[name] for name in list_names(tree)}
    with contextlib.suppress(NavsymError):
        if (exact := value_at(tree, used)) is not None:
            return str(exact)
    place = {name: player.Jet(player.arb(value)) for name, value in used.items()}
    return str(player.value_of(player.parse(print_tree(tree)), place).str(15, radius=False))


def differentiate(tree: Tree, symbol: Tree) -> Tree:
    """The derivative by the rules of the checker, as a tree; raises DomainError where none is known."""
    if measure(tree) > LONGEST:
        raise DomainError("expected a formula of at most 200,000 characters; got a longer one; ask for its parts")
    try:
        term = player.differentiate(player.parse(print_tree(tree)), symbol.args[0])
    except REFUSALS:
        raise DomainError("expected a formula with a derivative; got one without; ask for its parts") from None
    return read_tree(write_term(term), set(list_names(tree))) if term != player.ZERO else ZERO


# Long entries: the sums that code and expectation share become symbols of their own, with their meaning as hypotheses.
# Code of a filter names its common parts, and what is expected of it has the same parts. Multiplied out they are long;
# by name both sides are short. The statement "shared1x = ... implies left = right" is the same statement as the long
# one: each symbol stands for a polynomial, which has one value at every point. The checker reads it as a whole.

Pair = tuple[Tree, Tree]


@dataclass(frozen=True, slots=True, eq=False)
class Shortened:
    """Pairs of sides in which shared parts are symbols.

    meanings : symbol -> what it stands for, in the symbols of its own parts and the inputs
    """

    pairs: tuple[Pair, ...]
    meanings: Mapping[str, Tree]

    def inputs(self) -> list[str]:
        """The other symbols."""
        names = list_names(*itertools.chain(*self.pairs), *self.meanings.values())
        return [name for name in names if name not in self.meanings]

    def complete(self, point: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """The point with the exact values of the shared parts."""
        known = {build_symbol(name): build_number(value) for name, value in point.items()}
        for name, tree in self.meanings.items():  # each behind those in it
            if (value := rational_value(replace_parts(tree, known))) is None:
                raise TooLargeError("expected numbers of bounded size; got larger ones; ask for fewer entries")
            known[build_symbol(name)] = build_number(value)
        return {symbol.args[0]: number.args[0] for symbol, number in known.items()}


def shorten_pairs(pairs: Sequence[Pair]) -> Iterator[tuple[list[Pair], Shortened]]:
    """Those pairs whose sides are equal as polynomials in shared parts, as they are and by these parts.

    The parts are the sums that both sides have: all of them, then only those without another one inside.
    """
    waiting = list(pairs)
    for is_inner in (False, True):
        codes, expected = ({*list_parts(*side)} for side in zip(*waiting, strict=True))
        parts = list_parts(*itertools.chain(*waiting))
        total, above = set[Tree](), set[Tree]()
        for part in parts:
            if is_polynomial_head(part) and total.issuperset(parts_of(part)):
                total.add(part)
        shared = {part for part in codes & expected & total if part.head == SUM} - {*itertools.chain(*waiting)}
        for part in parts:  # those with a shared one inside
            if any(inner in above or inner in shared for inner in parts_of(part)):
                above.add(part)
        shared = shared - above if is_inner else shared
        if not shared:
            return
        short = name_parts(waiting, parts, shared)
        equal = [is_same(*pair) for pair in short.pairs]
        if any(equal):
            kept = tuple(itertools.compress(short.pairs, equal))
            yield list(itertools.compress(waiting, equal)), Shortened(kept, short.meanings)
        waiting = [pair for pair, is_equal in zip(waiting, equal, strict=True) if not is_equal]
        if not waiting:
            return


def is_same(left: Tree, right: Tree) -> bool:
    """True for two polynomials that are equal."""
    names = list_names(left, right)
    try:
        return bool(to_polynomial(left, names) == to_polynomial(right, names))
    except (DomainError, TooLargeError):
        return False


def is_polynomial_head(part: Tree) -> bool:
    """True for what makes polynomials of polynomials, which have a value at every point."""
    if part.head != POWER:
        return part.head in (NUMBER, SYMBOL, SUM, PRODUCT)
    exponent = part.args[1]
    return exponent.head == NUMBER and exponent.args[0].denominator == 1 and 0 < exponent.args[0] <= 64


def name_parts(pairs: Sequence[Pair], parts: list[Tree], shared: set[Tree]) -> Shortened:
    """The sides with a symbol for each shared part, under names that occur nowhere in them."""
    taken = {part.args[0] for part in parts if part.head == SYMBOL}
    letter = "shared"
    while any(name.startswith(letter) for name in taken):
        letter += "x"
    renamed: dict[Tree, Tree] = {}
    meanings: dict[str, Tree] = {}
    for part in parts:
        inner = tuple(renamed.get(arg, arg) if isinstance(arg, Tree) else arg for arg in part.args)
        renamed[part] = build(part.head, inner) if parts_of(part) else part
        if part in shared:
            name = f"{letter}{len(meanings) + 1}"
            meanings[name], renamed[part] = renamed[part], build_symbol(name)
    return Shortened(tuple((renamed[code], renamed[expected]) for code, expected in pairs), meanings)
