"""All cards under which a model is right, and for every other card an entry and a point that exclude it.

Two blocks are compared in balls at exact points that satisfy the relations of the quantities: a ball that excludes
zero excludes the card. What no point excludes is a candidate; the prover decides about it (``proof``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import islice, product
from typing import Any

from navsym.conventions.card import (
    CHOICES,
    DROPPED,
    ESTIMATE,
    HALF,
    MEASURED_LESS,
    NORTH,
    TRUTH,
    WANDER,
    WHOLE,
    Card,
    list_structures,
)
from navsym.conventions.measuring import MEASURED_MARK, NOISE_MARK, RESET_MARK, full_column
from navsym.conventions.mechanisation import CONSTANTS, ROLES, Mechanisation, flat_card
from navsym.conventions.points import BITS, ImpossibleError, Point, draw_point, evaluate
from navsym.conventions.reading import Problem
from navsym.core.balls import precision
from navsym.core.exact import to_fmpq
from navsym.language.tree import list_names

Block = tuple[str, str]

SIGNS = ("error", "rotation_sign", "attitude_size", "bias_sign", "scale_sign", "innovation")
POINTS = 3
NOTHING_KNOWN: Mapping[str, str] = {}


@dataclass(frozen=True, slots=True)
class Mismatch:
    """An entry of F (places from 0) that differs from the card's at a point (its number)."""

    block: Block
    entries: tuple[tuple[int, int], ...]
    point: int


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """A card with the blocks that exclude it; ``impossible`` names a quantity that contradicts it.

    count : cards that are excluded alike, whatever their signs
    """

    card: Card
    mismatches: tuple[Mismatch, ...]
    impossible: str = ""
    count: int = 1


@cache
def key_of_points(card: Card) -> Card:
    """The card without what has no influence on the points."""
    shape = card.earth if card.frame == "local-level" else "none"
    field = card.gravity_gradient if card.gravity_gradient in ("central", "normal") else "none"
    kept = card.centrifugal if field == "central" else None
    key = Card(card.frame, card.axes, card.azimuth, earth=shape, gravity_gradient=field, centrifugal=kept)
    return replace(key, **card.quaternion())


def plain_card(card: Card) -> Card:
    """The card with every sign plus, whose blocks the signs of others scale."""
    plain = replace(card, error=ESTIMATE, rotation_sign="+", bias_sign=ESTIMATE, scale_sign=None, dropped=())
    return replace(plain, attitude_size=WHOLE)


@cache
def narrow_card(card: Card, role: str) -> Card:
    """The card without the fields that have no influence on the columns of a role (a test compares them)."""
    plain = replace(plain_card(card), innovation=None, **card.quaternion())
    level = card.frame == "local-level"
    turned = role == "attitude" and card.vector("position")[0]  # the position turns with the attitude
    if role == "position" or turned:
        return plain
    if role in CONSTANTS or role.startswith(NOISE_MARK):
        plain = replace(plain, angle=None, earth_rate=None, transport_rate=None, arm_rate=None)
    if role == "attitude" and not card.vector("velocity")[0]:
        plain = replace(plain, angle=None)
    if level or card.gravity_gradient not in ("central", "normal"):  # these settle gravity itself
        plain = replace(plain, gravity_gradient="none")
    kept = plain.centrifugal if plain.gravity_gradient == "central" else None  # gravity itself contains it
    return replace(plain, centrifugal=kept, height_variation=None, radius_variation=None, gravity_radius=None)


class Comparison:
    """The user's blocks beside those of cards at some exact points."""

    def __init__(self, problem: Problem):
        self.problem = problem
        self.drawn = cache(self.draw_or_refuse)
        self.computed = cache(self.compute_columns)
        self.entries = cache(self.evaluate_block)
        self.signs = cache(self.compare)
        self.is_small = cache(self.has_small_terms)
        self.is_zero = cache(self.has_zeros)
        self.noise_sign = cache(self.compare_noise)

    def draw_or_refuse(self, key: Card, number: int) -> Point | ImpossibleError:
        """A point, or why there is none."""
        try:
            return draw_point(self.problem, key, number + 1)
        except ImpossibleError as error:
            return error

    def point(self, key: Card, number: int) -> Point:
        """A point of the card's relations."""
        found = self.drawn(key, number)
        if isinstance(found, ImpossibleError):
            raise found
        return found

    def columns(self, card: Card, role: str, number: int) -> list[dict[str, list[Any]]]:
        """Three columns of F of a card with every sign plus."""
        return self.computed(narrow_card(card, role), role, number)

    def compute_columns(
        self, card: Card, role: str, number: int, key: Card | None = None
    ) -> list[dict[str, list[Any]]]:
        """The same, without looking whether they are there already; ``key`` tells points of another card."""
        world = self.point(key or key_of_points(card), number).world
        return [full_column(Mechanisation(card, world), role, k) for k in range(3)]

    def evaluate_block(self, key: Card, block: Block, number: int) -> list[list[Any]]:
        """The user's block in balls."""
        values = self.point(key, number).values
        return [[evaluate(tree, values) for tree in row] for row in self.problem.block(*block)]

    def sign(self, card: Card, block: Block, sign: Fraction) -> Mismatch | None:
        """The first point that tells the user's block from ``sign`` times the card's, with all entries that differ."""
        if block[0] in CONSTANTS and block[1] in CONSTANTS:
            return self.bias_block(block, key_of_points(card))
        return self.signs(narrow_card(card, block[1]), key_of_points(card), block, sign)

    def compare(self, card: Card, key: Card, block: Block, sign: Fraction) -> Mismatch | None:
        """The same for a card of which only the fields are left that matter."""
        (row, column), factor = block, to_fmpq(sign)
        for number in range(POINTS):
            written = self.entries(key, block, number)
            columns = self.computed(card, column, number)
            wrong = []
            for i, j in product(range(len(written)), range(3)):
                difference = written[i][j] - factor * columns[j][row][i]
                if difference.is_finite() and not difference.contains(0):
                    wrong.append((self.problem.places(row)[i], self.problem.places(column)[j]))
            if wrong:
                return Mismatch(block, tuple(wrong), number)
        return None

    def bias_block(self, block: Block, key: Card) -> Mismatch | None:
        """What no bias or scale may do: depend on others or on motion, or grow where its constants have known signs."""
        moving = {name for trees in self.problem.quantities.values() for name in list_names(*trees)}
        values = self.point(key, 0).values
        wrong = []
        for i, j in product(*(range(3) for _ in range(2))):
            tree = self.problem.block(*block)[i][j]
            value, names = evaluate(tree, values), set(list_names(tree))
            signed = all(self.problem.parameters[name].kind in ("positive", "range") for name in names)
            own = block[0] == block[1] and i == j and not names & moving
            if not value.contains(0) and not (own and not (signed and value > 0)):
                wrong.append((self.problem.roles[block[0]][i], self.problem.roles[block[1]][j]))
        return Mismatch(block, tuple(wrong), 0) if wrong else None

    def show(self, card: Card, block: Block, entry: tuple[int, int], number: int) -> tuple[dict[str, str], str, str]:
        """The point in decimals, the user's entry there and the card's."""
        row, column = block
        i, j = self.problem.places(row).index(entry[0]), self.problem.places(column).index(entry[1])
        with precision(BITS):
            key = key_of_points(card)
            written = self.entries(key, block, number)[i][j]
            columns = self.columns(card, column, number)
            expected, sign = columns[j][row][i], self.block_sign(card, block)
            expected = sign * expected if isinstance(expected, int) else to_fmpq(sign) * expected
            names = list_names(self.problem.block(*block)[i][j])
            point = {name: in_decimals(self.point(key, number).values[name]) for name in names}
            return point, in_decimals(written), in_decimals(expected)

    def block_sign(self, card: Card, block: Block) -> Fraction:
        """The sign by which the signs of a card scale a block; that of a noise is the one that fits more blocks."""
        if block[1].startswith(NOISE_MARK):
            signs = card.signs()
            return signs[block[0]] * self.noise_sign(plain_card(card), tuple(sorted(signs.items())), block[1])
        return sign_of(card, block)

    def compare_noise(self, card: Card, signs: tuple[tuple[str, Fraction], ...], noise: str) -> int:
        """The sign of a noise, which nothing else tells."""
        rows = [(row, sign) for row, sign in signs if row in self.problem.roles]
        found = {s: [self.sign(card, (row, noise), s * sign) for row, sign in rows] for s in (1, -1)}
        sizes = {s: [len(m.entries) for m in mismatches if m] for s, mismatches in found.items()}
        return min((1, -1), key=lambda s: (len(sizes[s]), sum(sizes[s])))

    def has_zeros(self, block: Block) -> bool:
        """True where every entry of the user's block is written as zero."""
        return all(repr(tree) == "<0>" for row in self.problem.block(*block) for tree in row)

    def is_dropped(self, card: Card, block: Block) -> bool:
        """True where the user's block is zero and the card's has small terms only."""
        if block[0].startswith(RESET_MARK):
            return self.is_zero(block)
        return self.is_zero(block) and self.is_small(flat_card(plain_card(card)), block)

    def has_small_terms(self, card: Card, block: Block) -> bool:
        """True where the block vanishes for a card of a flat Earth that does not turn: its terms may be dropped."""
        row, column = block
        return all(is_same(x, 0) for k in range(3) for x in self.columns(card, column, 0)[k][row])


def sign_of(card: Card, block: Block) -> Fraction:
    """The sign, and the share of the angle, by which the signs of a card scale a block; noises are plus."""
    signs = card.signs()
    row, column = block
    if row.startswith(MEASURED_MARK):
        return (-1 if card.innovation == MEASURED_LESS else 1) / signs[column]
    if row.startswith(RESET_MARK):
        return 1 / signs["attitude"]
    return signs[row] / signs.get(column, 1)


def in_decimals(x: Any) -> str:
    """A ball by its leading digits."""
    return str(x) if isinstance(x, int | Fraction) else str(x.str(10, radius=False))


def list_blocks(problem: Problem) -> list[Block]:
    """Blocks in the order in which they exclude: those that depend on few conventions first."""
    roles = [role for role in ROLES if role in problem.roles]
    main = [
        ("attitude", "gyro_bias"),
        ("velocity", "accelerometer_bias"),
        ("velocity", "attitude"),
        ("attitude", "attitude"),
    ]
    blocks = [(row, column) for row in roles for column in roles]
    blocks += [(MEASURED_MARK + kind, column) for kind in problem.measured for column in roles]
    blocks += [(row, NOISE_MARK + noise) for noise in problem.noises for row in roles]
    blocks += [(RESET_MARK + row, column) for row in roles for column in roles if problem.reset]
    return sorted(blocks, key=lambda block: main.index(block) if block in main else len(main) + ("position" in block))


def list_signs(problem: Problem, known: Mapping[str, str] = NOTHING_KNOWN) -> Iterator[dict[str, Any]]:
    """The signs that a card may have beside known words; those of states that the model does not have say nothing."""
    has_vectors = {"velocity", "position"} & set(problem.roles)
    errors = (ESTIMATE, TRUTH) if has_vectors else (known.get("error", ESTIMATE),)  # that of the whole filter
    attitudes: tuple[str | None, ...] = ("+", "-") if "attitude" in problem.roles else (None,)
    sizes = list_sizes(problem)
    has = (any(role.endswith(kind) for role in problem.roles) for kind in ("bias", "scale"))
    biases, scales = ((ESTIMATE, TRUTH) if some else (None,) for some in has)
    shown: tuple[str | None, ...] = CHOICES["innovation"] if problem.measured else (None,)
    for words in product(errors, attitudes, sizes, biases, scales, shown):
        if all(known.get(name, word) == word for name, word in zip(SIGNS, words, strict=True)):
            yield dict(zip(SIGNS, words, strict=True))


def list_sizes(problem: Problem) -> tuple[str | None, ...]:
    """What the state of the attitude may be: alone it does not tell whether it is an angle or half of it."""
    tells = len(problem.roles) > 1 or problem.measured or problem.noises or problem.reset
    return (None,) if "attitude" not in problem.roles else (WHOLE, HALF) if tells else (WHOLE,)


def list_problem_structures(problem: Problem, known: Mapping[str, str] = NOTHING_KNOWN) -> Iterator[Card]:
    """Every card without its signs that a model with these roles and quantities may have beside known words."""
    given, frames = problem.quantities, (known["frame"],) if "frame" in known else CHOICES["frame"]
    placed = {"latitude", "longitude"} <= set(given)
    azimuth = WANDER if "wander_angle" in given and problem.known.get("azimuth") != NORTH else NORTH
    sizes = len(given.get("radii", ())), frames, "height" in given, placed, azimuth, "quaternion" in given
    arm = "lever_arm" in given and {"velocity", "body_velocity"} & set(problem.measured)
    shapes = [(name, word) for name, word in known.items() if name not in SIGNS]
    cards = list_structures(frozenset(problem.roles), *sizes, bool(arm))
    return (card for card in cards if all(getattr(card, name) == word for name, word in shapes))


def list_cards(problem: Problem, known: Mapping[str, str] = NOTHING_KNOWN) -> Iterator[Card]:
    """Every card with its signs that says the known words."""
    signs = list(list_signs(problem, known))
    return (replace(structure, **words) for structure in list_problem_structures(problem, known) for words in signs)


def examine(problem: Problem, comparison: Comparison, most: int = 0) -> Iterator[Outcome]:
    """Every card that agrees with what is known, with up to ``most + 1`` of the blocks that exclude it."""
    blocks, signs = list_blocks(problem), list(list_signs(problem, problem.known))
    for structure in list_problem_structures(problem, problem.known):
        try:
            comparison.point(key_of_points(structure), 0)
        except ImpossibleError as error:
            yield Outcome(structure, (), str(error), len(signs))
            continue
        # Signs only scale rows and columns: blocks are compared for the structure, once for each sign.
        results = cache(lambda block, sign, card=structure: comparison.sign(card, block, sign))
        hopeless = list(islice(list_hopeless(structure, comparison, blocks, results), most + 1))
        if len(hopeless) > most:
            yield Outcome(structure, tuple(hopeless), count=len(signs))
        else:
            yield from (
                judge(replace(structure, **words), structure, comparison, blocks, results, most) for words in signs
            )


def list_hopeless(structure: Card, comparison: Comparison, blocks: Sequence[Block], results: Any) -> Iterator[Mismatch]:
    """The blocks that no signs make right."""
    for block in blocks:
        mismatch, others = results(block, Fraction(1)), list_factors(block, comparison.problem)
        if mismatch and all(results(block, x) for x in others) and not comparison.is_dropped(structure, block):
            yield mismatch


def list_factors(block: Block, problem: Problem) -> Iterator[Fraction]:
    """What the signs of a card may make of a block, beside 1."""
    yield Fraction(-1)
    if HALF in list_sizes(problem) and (block[0] != block[1]) and ("attitude" in "".join(block) or problem.reset):
        yield from (Fraction(sign * x, y) for x, y in ((2, 1), (1, 2)) for sign in (1, -1))


def judge(
    card: Card, structure: Card, comparison: Comparison, blocks: Sequence[Block], results: Any, most: int
) -> Outcome:
    """A card with the blocks that exclude it, up to one more than ``most``, or with those that are dropped."""
    mismatches, dropped = [], []
    for block in blocks:
        mismatch = results(block, comparison.block_sign(card, block))
        if mismatch is None:
            continue
        if comparison.is_dropped(structure, block):
            dropped.append(block)
            continue
        mismatches.append(mismatch)
        if len(mismatches) > most:
            break
    return Outcome(replace(card, dropped=tuple(dropped)), tuple(mismatches))


def has_evidence(card: Card, comparison: Comparison, blocks: Sequence[Block]) -> bool:
    """False where the card of a flat Earth says the same and agrees with what is known: all other terms are dropped."""
    plain = plain_card(card)
    flat, other = flat_card(plain), flat_card(card)
    if flat == plain or any(getattr(other, name) != word for name, word in comparison.problem.known.items()):
        return True
    if isinstance(comparison.drawn(key_of_points(flat), 0), ImpossibleError):
        return True
    for block in blocks:
        if block in card.dropped:
            continue
        row, column = block
        here = comparison.columns(plain, column, 0)
        there = comparison.computed(narrow_card(flat, column), column, 0, key_of_points(plain))
        pairs = ((here[k][row][i], there[k][row][i]) for k in range(3) for i in range(3))
        if any(not is_same(x, y) for x, y in pairs):
            return True
    return False


def is_same(x: Any, y: Any) -> bool:
    """True where two balls overlap."""
    difference = x - y
    return difference == 0 if type(difference) is int else bool(difference.contains(0))


#: Terms of a card that a model may keep or drop within a frame.
TERMS = (
    "earth_rate", "transport_rate", "gravity_gradient", "gravity_radius", "centrifugal", "height_variation",
    "radius_variation",
)  # fmt: skip


def keep_simplest(cards: Sequence[Card], own: Mapping[str, str]) -> list[Card]:
    """Of cards with the same conventions the own one of the model, or those that drop fewest blocks, then terms."""

    def convention(card: Card) -> Card:
        nothing: dict[str, Any] = dict.fromkeys((*TERMS, "arm_rate"))
        return replace(card, **nothing, dropped=())

    def cost(card: Card) -> tuple[bool, int, int]:
        return card.words() != own, len(card.dropped), sum(getattr(card, name) == DROPPED for name in TERMS)

    best: dict[Card, Card] = {}
    for card in cards:
        key = convention(card)
        if key not in best or cost(card) < cost(best[key]):
            best[key] = card
    return list(best.values())


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """Candidates that no point excludes, and why each other card is excluded."""

    candidates: tuple[Card, ...]
    excluded: tuple[Outcome, ...]


def find_candidates(problem: Problem, comparison: Comparison) -> Findings:
    """The candidates among all cards."""
    with precision(BITS):
        outcomes = list(examine(problem, comparison))
        blocks = list_blocks(problem)
        right = [o.card for o in outcomes if not o.mismatches and not o.impossible]
        own = problem.own
        right = [card for card in right if card.words() == own or has_evidence(card, comparison, blocks)]
        wrong = tuple(o for o in outcomes if o.mismatches or o.impossible)
        return Findings(tuple(keep_simplest(right, own)), wrong)


def find_nearest(problem: Problem, comparison: Comparison) -> list[Outcome]:
    """The cards with the fewest blocks that must change."""
    blocks = list_blocks(problem)
    with precision(BITS):
        for most in range(1, len(blocks) + 1):
            outcomes = [o for o in examine(problem, comparison, most) if not o.impossible and len(o.mismatches) <= most]
            outcomes = [o for o in outcomes if o.mismatches and has_evidence(o.card, comparison, blocks)]
            if outcomes:
                return outcomes
    return []
