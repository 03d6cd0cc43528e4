"""One entry decided: what the code computes beside what it should be, granted by the checker.

Search finds cofactors of the declared relations or a point; the statement with its proof, or the point, goes to the
checker as text. Nothing else makes an entry PROVED or REFUTED.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from navsym.audit.evaluate import Condition
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
    build_number,
    build_symbol,
    fold_tree,
    list_names,
    negate,
    parts_of,
    replace,
)
from navsym.prove.grant import IDENTITY, REFUSALS, find_witness, grant, refute_document
from navsym.prove.rooms.goals import player, simple_point
from navsym.prove.search import find_proof, rules_of

SECONDS = 4.0
REAL: list[Any] = [None, None, []]  # the range of a symbol that stands for a part
LONG = 1_500  # characters of both sides: shared parts are named
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

    sense  : "exact", or "manifold" where the declared relations were used
    point  : of REFUTED, symbol -> exact number
    values : of REFUTED, the code's value and the expected one there
    """

    status: Status
    sense: str = "exact"
    point: Mapping[str, str] | None = None
    values: tuple[str, str] | None = None
    why: str = ""
    certificate: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Scope:
    """Where an entry has to hold.

    ranges     : symbol -> its range in the words of the checker
    relations  : polynomials of the symbols that are zero
    conditions : of the case in which the code is
    """

    ranges: Mapping[str, Any]
    relations: tuple[Tree, ...] = ()
    conditions: tuple[Condition, ...] = ()


def decide_entry(code: Tree, expected: Tree, scope: Scope, seconds: float = SECONDS) -> Decision:
    """Whether the code computes what is expected, at all points of the scope."""
    length = measure(code) + measure(expected)
    if length > LONG:
        granted = prove_shared(code, expected, scope)
        if granted is not None:
            return Decision(PROVED, certificate=granted)
    if length > LONGEST:
        return Decision(OPEN, why="a formula of more than 200,000 characters")
    document = write_document(code, expected, scope)
    try:
        granted = prove_document(document)
        if granted is None and scope.relations:
            lifted = lift(code, expected, scope.relations)
            granted = None if lifted is None else prove_document(write_document(code, lifted, scope))
            if granted is not None:
                return Decision(PROVED, "manifold", certificate=granted)
        if granted is not None:
            return Decision(PROVED, certificate=granted)
        dark = next((c for c in scope.conditions if c.left is None), None)
        if dark is not None:  # nobody knows whether a point is in this case
            return search_proof(document, seconds, f"in a case of a condition that is not read: {dark.text}")
        refuted = refute(document, code, expected, scope)
        if refuted is not None:
            return refuted
        return search_proof(document, seconds)
    except REFUSALS as refusal:
        return Decision(OPEN, why=f"not granted: {refusal}")


def measure(tree: Tree) -> int:
    """About how many characters a tree has when it is written out."""
    return fold_tree(tree, lambda part, inner: sum(inner) + 3 * len(inner) + (8 if not inner else 2))


def write_document(code: Tree, expected: Tree, scope: Scope) -> Document:
    """The statement in the words of the checker."""
    names = list_names(code, expected)
    return {
        "left": print_tree(code),
        "relation": "=",
        "right": print_tree(expected),
        "symbols": {name: scope.ranges[name] for name in names},
        "exists": [],
        "tolerance": None,
    }


def prove_document(document: Document) -> Document | None:
    """The certificate of an identity that the checker has granted; None where it has not."""
    (case,), box = player.read_statement(document)
    goals, terms = case.goals, case.terms
    witness = find_witness(terms, box)
    if witness is None or not player.is_identity(goals[0].term):
        return None
    certificate = {"kind": "proof", "statement": document, "bits": BITS, "witness": witness, "proofs": [IDENTITY]}
    return certificate if grant([document], certificate) == "HOLDS" else None


def prove_shared(code: Tree, expected: Tree, scope: Scope) -> Document | None:
    """The certificate of an identity in shared parts, with their meanings as hypotheses; None where it has none."""
    from navsym.audit.shared import shorten_sides

    short = shorten_sides(code, expected)
    if short is None:
        return None
    inputs = short.inputs()
    limits = [player.read_range(scope.ranges[name]) for name in inputs]
    numbers = [simple_point(limit, i % 2) for i, limit in enumerate(limits)]
    point = {name: Fraction(int(q.p), int(q.q)) for name, q in zip(inputs, numbers, strict=True)}
    document: Document = {
        "left": print_tree(short.left),
        "relation": "=",
        "right": print_tree(short.right),
        "symbols": {**{name: scope.ranges[name] for name in inputs}, **{name: REAL for name in short.meanings}},
        "exists": [],
        "tolerance": None,
        "shapes": {},
        "given": [f"{name} = {print_tree(tree)}" for name, tree in short.meanings.items()],
        "rates": {},
    }
    witness = {name: str(value) for name, value in short.complete(point).items()}
    certificate = {"kind": "proof", "statement": document, "bits": BITS, "witness": witness, "proofs": [IDENTITY]}
    try:
        return certificate if grant([document], certificate) == "HOLDS" else None
    except REFUSALS:
        return None


def search_proof(document: Document, seconds: float, why: str = "") -> Decision:
    """What the search for a proof tree makes of the statement; ``why`` it is left open otherwise."""
    (case,), box = player.read_statement(document)
    goals, terms = case.goals, case.terms
    witness = find_witness(terms, box)
    if witness is None:
        return Decision(OPEN, why="no point was found at which both sides have a value")
    proof = find_proof(goals[0], seconds)
    if proof is None:
        return Decision(OPEN, why=why or "no proof and no counterexample was found")
    certificate = {"kind": "proof", "statement": document, "bits": BITS, "witness": witness, "proofs": [proof]}
    grant([document], certificate)
    status = CERTIFIED if "balls" in rules_of(certificate["proofs"]) else PROVED
    return Decision(status, certificate=certificate)


# Relations


def lift(code: Tree, expected: Tree, relations: Sequence[Tree]) -> Tree | None:
    """``expected + sum of cofactor * relation``, equal to the code as it stands; None where division leaves a rest."""
    atoms: dict[Tree, Tree] = {}
    difference = name_atoms(code, atoms), name_atoms(expected, atoms)
    names = sorted({*list_names(*difference, *relations)})
    ring = fmpq_mpoly_ctx.get(names, Ordering.degrevlex)
    try:
        first, second, *zeros = (in_ring(to_polynomial(tree, names), ring) for tree in (*difference, *relations))
    except (DomainError, TooLargeError):
        return None
    rest, terms = first - second, [expected]
    for _ in range(2):
        for relation, zero in zip(relations, zeros, strict=True):
            cofactor, rest = divmod(rest, zero)
            if cofactor != 0:
                written = read_tree(f"({write_polynomial(cofactor)})", set(names))
                back = {symbol: atom for atom, symbol in atoms.items()}
                terms.append(product_of(replace(written, back), relation))
    return sum_of(terms) if rest == 0 else None


def in_ring(polynomial: fmpq_mpoly, ring: fmpq_mpoly_ctx) -> fmpq_mpoly:
    """The same polynomial with another order of its monomials."""
    return ring.from_dict(polynomial.to_dict())


def write_polynomial(polynomial: fmpq_mpoly) -> str:
    """A polynomial as text of the language."""
    return str(polynomial).replace("^", "**")


def sum_of(trees: Sequence[Tree]) -> Tree:
    """The sum, each term as it is."""
    from navsym.language.tree import build_sum

    return build_sum(*trees)


def product_of(a: Tree, b: Tree) -> Tree:
    """The product, each factor as it is."""
    from navsym.language.tree import build_product

    return build_product(a, b)


def name_atoms(tree: Tree, atoms: dict[Tree, Tree]) -> Tree:
    """The tree with a letter for each part that is no sum, product or whole power."""

    def step(part: Tree, inner: list[Tree]) -> Tree:
        if part.head in (NUMBER, SYMBOL):
            return part
        if part.head == POWER and inner[0].head == NUMBER and (exact := rational_value(part)) is not None:
            return build_number(exact)
        if part.head in (SUM, PRODUCT) or (part.head == POWER and is_count(part.args[1])):
            by = {old: new for old, new in zip(parts_of(part), inner, strict=True) if old is not new}
            return replace_parts(part, by)
        return atoms.setdefault(part, build_symbol(f"atom{len(atoms) + 1}x"))

    return fold_tree(tree, step)


def replace_parts(part: Tree, by: Mapping[Tree, Tree]) -> Tree:
    """The part with others in the place of its own parts."""
    from navsym.language.tree import build

    return build(part.head, tuple(by.get(inner, inner) for inner in part.args))


def is_count(exponent: Tree) -> bool:
    """True for a whole exponent from 0 to 64."""
    return exponent.head == NUMBER and exponent.args[0].denominator == 1 and 0 <= exponent.args[0] <= 64


# Counterexamples


def refute(document: Document, code: Tree, expected: Tree, scope: Scope) -> Decision | None:
    """REFUTED by a point of the scope, with both values; None where none is found."""
    (case,), box = player.read_statement(document)
    goals, terms = case.goals, case.terms
    others = list_names(*scope.relations, *(t for c in scope.conditions for t in (c.left, c.right) if t is not None))
    whole = {**box, **{n: player.read_range(scope.ranges[n]) for n in others if n not in box}}
    for point in draw_points(whole, scope):
        place = {name: player.Jet(player.arb(value)) for name, value in point.items()}
        if not all(holds_at(condition, place) for condition in scope.conditions):
            continue
        value = player.value_of(goals[0].term, place)
        if not all(player.value_of(t, place).is_finite() for t in terms) or not (value > 0 or value < 0):
            continue
        texts = {name: write_fraction(value) for name, value in point.items()}
        try:
            certificate = refute_document([document], document, {n: texts[n] for n in document["symbols"]})
        except REFUSALS:
            continue
        values = tuple(value_text(tree, point) for tree in (code, expected))
        return Decision(REFUTED, point=texts, values=(values[0], values[1]), certificate=certificate)
    return None


def draw_points(box: Mapping[str, Any], scope: Scope) -> Iterator[Point]:
    """Simple exact points of the box at which the relations hold."""
    names = sorted(box)
    for k in range(POINTS):
        point = {name: choose_value(box[name], k, i) for i, name in enumerate(names)}
        solved = all(meet(relation, point, box) for relation in scope.relations)
        if solved and all(value_at(relation, point) == 0 for relation in scope.relations):
            yield point


def choose_value(limits: Any, trial: int, place: int) -> fmpq:
    """A simple number of a range."""
    candidate = SIMPLE[(place * (trial // 3 + 1) + trial) % len(SIMPLE)]
    return candidate if player.is_inside(("number", candidate), limits) else simple_point(limits, trial + place)


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
        for at, name in enumerate(names):
            if max(exponents[at] for exponents in terms) == 1:
                rest = [(fmpq(c), e) for e, c in terms.items()]
                parts = [fmpq(0), fmpq(0)]
                for coefficient, exponents in rest:
                    for other, power in zip(names, exponents, strict=True):
                        coefficient = coefficient * point[other] ** int(power) if other != name else coefficient
                    parts[exponents[at]] += coefficient
                if parts[1] != 0:
                    point[name] = -parts[0] / parts[1]
                    break
    return all(player.is_inside(("number", point[name]), box[name]) for name in names)


def value_at(tree: Tree, point: Point) -> Fraction | None:
    """The exact value of a rational formula at a point; None for others."""
    by = {build_symbol(name): build_number(Fraction(int(v.p), int(v.q))) for name, v in point.items()}
    return rational_value(replace(tree, by))


def holds_at(condition: Condition, place: Mapping[str, Any]) -> bool:
    """True where a condition of the case surely is as the case says."""
    if condition.left is None or condition.right is None:
        return True
    term = player.parse(print_tree(sum_of([condition.left, negate(condition.right)])))
    ball = player.value_of(term, dict(place))
    if not ball.is_finite():
        return False
    exact_zero = ball == 0
    truths = {
        "<": (ball < 0, ball >= 0), "<=": (ball <= 0, ball > 0), ">": (ball > 0, ball <= 0),
        ">=": (ball >= 0, ball < 0), "==": (exact_zero, ball != 0), "!=": (ball != 0, exact_zero),
    }  # fmt: skip
    return bool(truths[condition.sign][0 if condition.holds else 1])


def write_fraction(value: fmpq) -> str:
    """A fraction as text."""
    return str(Fraction(int(value.p), int(value.q)))


def value_text(tree: Tree, point: Point) -> str:
    """The value of a formula at a point: exact where it is rational, else to 15 digits."""
    used = {name: point[name] for name in list_names(tree)}
    try:
        exact = value_at(tree, used)
    except NavsymError:
        exact = None
    if exact is not None:
        return str(exact)
    place = {name: player.Jet(player.arb(value)) for name, value in used.items()}
    return str(player.value_of(player.parse(print_tree(tree)), place).str(15, radius=False))


def differentiate(tree: Tree, symbol: Tree) -> Tree:
    """The derivative by the rules of the checker, as a tree; raises DomainError where none is known."""
    from navsym.prove.rooms.goals import write_term

    if measure(tree) > LONGEST:
        raise DomainError("expected a formula of at most 200,000 characters; got a longer one; ask for its parts")
    try:
        term = player.differentiate(player.parse(print_tree(tree)), symbol.args[0])
    except REFUSALS:
        raise DomainError("expected a formula with a derivative; got one without; ask for its parts") from None
    return read_tree(write_term(term), set(list_names(tree))) if term != player.ZERO else ZERO
