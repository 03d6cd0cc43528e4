"""From one card to another: the transformation of the errors, and the model in them, proved on the user's own texts.

Both errors are defined for the same estimate and truth. The error of one card is put into an estimate, which is
carried over where axes or frames differ, and read by the definition of the other: T, and along the flow its rate T'.
Then F_to T = T F + T', H_to T = H and G_to = T G.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import partial
from typing import Any

from navsym.claims.verdict import PROVED
from navsym.conventions.card import CHOICES, KEPT, Card
from navsym.conventions.frames import LEVEL, OTHERS, Passage, carry_motion, change_frame, refuse, restore_terms
from navsym.conventions.generating import require_names, write_blocks
from navsym.conventions.measuring import NOISE_MARK
from navsym.conventions.mechanisation import ROLES, Mechanisation, unit_error
from navsym.conventions.nilpotent import NOTHING, Array, constant
from navsym.conventions.points import BITS
from navsym.conventions.proof import Prover
from navsym.conventions.reading import HIDDEN, Problem, matrix_of, print_matrix
from navsym.conventions.search import TERMS, Comparison, list_cards, plain_card
from navsym.conventions.symbols import Formulas
from navsym.core.answers import Answer
from navsym.core.balls import precision
from navsym.core.errors import DomainError
from navsym.language.names import quote

#: What a conversion changes exactly: the definition of the errors, and where they are resolved.
CONVERTED = (
    "error", "attitude_error", "angle", "rotation_sign", "attitude_size", "bias_sign", "scale_sign", "position_error",
    "vector_error", "axes", "azimuth", "frame",
)  # fmt: skip
LONG = 400  # letters of a statement that are too many for the checker
Texts = tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Conversion(Answer):
    """The same model in the errors of another card.

    source, target : the cards
    T, inverse     : x_to = T x and x = inverse x_to, in the order of the states; P_to = T P T'
    rate           : dT/dt along the true flow
    neglected      : what the target has and the model has not, or the reverse, in the errors of the source: where
                     terms are dropped, F + neglected is converted; zeros where the conversion is exact
    F, H, G, reset : of the target; empty where the model has none; Q and R stay. In other axes or another frame a
                     measurement stays as it was resolved; the corrections of the reset are those of the target
    quantities     : those of the target in the names of the file, such as the rotation to the new axes
    problem        : the model that was converted; ``export`` writes T and its inverse as code
    proofs         : certificates of the entries that the checker granted; longer ones are decided by exact algebra
    proved         : True where F_to = T (F + neglected) + T', T inverse = E, H_to T = H and G_to = T G: each entry
                     granted by the checker, or decided by exact algebra where it is long
    """

    source: Card
    target: Card
    T: Texts
    inverse: Texts
    rate: Texts
    neglected: Texts
    F: Texts
    H: Texts
    G: Texts
    reset: Texts
    quantities: Mapping[str, Any]
    proved: bool
    problem: Problem
    proofs: tuple[Mapping[str, Any], ...] = ()

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificates of single entries."""
        return [*self.proofs]

    def document(self) -> dict[str, Any]:
        """The conversion as JSON data."""
        names = ("T", "inverse", "rate", "neglected", "F", "H", "G", "reset")
        matrices = {name: [list(row) for row in getattr(self, name)] for name in names}
        cards = {"from": self.source.document(), "to": self.target.document()}
        return {**cards, **matrices, "quantities": dict(self.quantities), "proved": self.proved}

    def __repr__(self) -> str:
        changed = [f.name for f in fields(Card) if getattr(self.source, f.name) != getattr(self.target, f.name)]
        words = ", ".join(f"{name} {getattr(self.target, name)}" for name in changed)
        rest = f", up to {len(self.neglected_entries())} named entries" * bool(self.neglected_entries())
        return f"Conversion(to {words or 'the same card'}; {'PROVED' if self.proved else 'not all is proved'}{rest})"

    def latex(self) -> str:
        """The new card, T, F and what is neglected in LaTeX, block by block."""
        from navsym.conventions.typeset import model_latex

        matrices = {"T": self.T, "F": self.F, r"\Delta F": self.neglected}
        return model_latex(self.problem, self.target, matrices, self.source)

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {self.latex()}$"

    def neglected_entries(self) -> list[tuple[int, int]]:
        """The entries of ``neglected`` that are not zero, from 1."""
        return [(i + 1, j + 1) for i, row in enumerate(self.neglected) for j, x in enumerate(row) if x != "0"]


def read_target(source: Card, changes: Mapping[str, str], problem: Problem) -> tuple[Card, Card]:
    """The card to convert to, and the source with the terms that it then has.

    Raises DomainError for what is no definition of an error and no term, or has no transformation.
    """
    for name, word in changes.items():
        if name not in CHOICES or word not in CHOICES[name]:
            known = ", ".join(CHOICES.get(name, (*CONVERTED, *TERMS)))
            got = quote(word if name in CHOICES else name)
            raise DomainError(f"expected one of {known}; got {got}; correct it", where=f"convert: {name}")
    terms = {name: word for name, word in changes.items() if name in TERMS}
    given, frame = problem.quantities, changes.get("frame", source.frame)
    whole = replace(source, **terms, dropped=())
    moved = whole
    if frame != source.frame or changes.get("azimuth", source.azimuth) != source.azimuth:
        sizes = len(given.get("radii", ())), "height" in given, "earth_rate" in given
        tilted = source.frame != LEVEL and any(repr(x) != "<0>" for x in given.get("earth_rate", ())[:-1])
        refuse(tilted, "one number as earth_rate: the third axis is that of the Earth", OTHERS)
        whole = restore_terms(whole, frame, sizes[0])
        alone = "velocity" in problem.roles and "position" not in problem.roles
        moved = change_frame(whole, {**changes, "frame": frame}, *sizes, alone)
    elif terms and plain_card(whole) not in map(plain_card, list_cards(problem, whole.words())):
        message = f"expected terms of one card; got {', '.join(terms)} beside others; change what belongs to them, too"
        raise DomainError(message, where="convert")
    curved = moved.frame == "local-level" and moved.earth != "none"
    names = [n for n in CONVERTED if getattr(moved, n) is not None and (curved or n != "position_error")]
    for name in (name for name in changes if name not in (*names, *TERMS) or (name in terms and moved != whole)):
        message = f"expected one of {', '.join(names)}; got {quote(name)}; it says nothing beside the others"
        raise DomainError(message, where="convert")
    for block in source.dropped:
        if matrix_of(block) in ("G", "H"):
            got = f"zeros in {' by '.join(block)}"
            raise DomainError(f"expected H and G without dropped blocks; got {got}; write them out", where="convert")
    words: dict[str, Any] = {name: word for name, word in changes.items() if name not in TERMS}
    target = replace(moved, **words)
    if "position" in problem.measured and target.position_error != source.position_error:
        message = "expected a measured position in the units of the error; got another unit; convert without it"
        raise DomainError(message, where="convert: position_error")
    return target, whole


def transform(way: Passage, role: str, component: int, C: Array | None = None) -> dict[str, Array]:
    """A column of T and of its rate with every sign plus: role -> nilpotents whose error and mixed part they are.

    C : rotation from the body to the axes that the way has for its body
    """
    truth = way.source.truth()
    later = truth.advance(way.source.rate(truth))
    given = unit_error(role, component)
    given = way.source.turn_errors(C, given) if C is not None else given
    error = way.target.compare(*way.carry(way.source.estimate(later, given), later))
    error = way.target.turn_errors(C.T, error) if C is not None else error
    return {name: error[name] for name in ROLES}


class Converter:
    """The matrices of one conversion as texts in the user's names."""

    def __init__(
        self, problem: Problem, source: Card, target: Card, progress: Callable[[int, int], None] = lambda done, of: None
    ):
        self.problem, self.source, self.target = problem, source, target
        self.prover, self.comparison = Prover(problem), Comparison(problem)
        self.n = len(problem.states)
        self.formulas = Formulas(problem, plain_card(source))
        roles = len(problem.roles)  # columns of T and its inverse, blocks of F, rows of what is proved
        self.progress, self.done, self.steps = progress, 0, 6 * roles + roles * roles + 2 * self.n
        self.rotation = constant(self.formulas.world.C)
        self.moves = any(getattr(source, n) != getattr(target, n) for n in ("frame", "axes", "azimuth"))

    def step(self) -> None:
        """One more step is done."""
        self.done += 1
        self.progress(self.done, max(self.done, self.steps))

    def transformation(self, way: Passage, back: bool = False) -> tuple[list[list[str]], list[list[str]]]:
        """T and its rate, or its inverse; states without a role stay as they are."""
        T = [["1" if i == j else "0" for j in range(self.n)] for i in range(self.n)]
        rate = [["0"] * self.n for _ in range(self.n)]
        way = Passage(way.target, way.source) if back else way
        signs = [self.source.signs(), self.target.signs()]
        for column, places in self.problem.roles.items():
            for k, j in enumerate(places):
                self.step()
                parts = transform(way, column, k, self.rotation)
                for row, rows in self.problem.roles.items():
                    sign = signs[not back][row] / signs[back][column]
                    for i, part in zip(rows, parts[row], strict=True):
                        T[i][j], rate[i][j] = (self.formulas.write(x, sign) for x in (part.error, part.mixed))
        return T, rate

    def matrices(self, way: Passage, inverse: list[list[str]]) -> list[list[list[str]]]:
        """F, H, G and the reset of the target."""
        problem, signs, own = self.problem, self.target.signs(), self.source.signs()
        matrices = {name: print_matrix(getattr(problem, name)) for name in ("F", "H", "G", "reset")}

        def sign(block: tuple[str, str]) -> Fraction:
            self.step()
            if block[1].startswith(NOISE_MARK):  # the sign of a noise is that of the model as it was
                return signs[block[0]] / own[block[0]] * self.comparison.block_sign(self.source, block)
            return self.comparison.block_sign(self.target, block)

        if moves := self.moves:
            matrices["H"] = multiply_texts(matrices["H"], inverse)
        kept = {name: M for name, M in matrices.items() if M and (name != "H" or not moves)}
        write_blocks(problem, way.target, self.formulas, sign, kept)
        return list(matrices.values())

    def quantities(self, flow: Mechanisation) -> dict[str, Any]:
        """The quantities of the target in the names of the file; those that need others are left out."""
        given: dict[str, Any] = {name: print_matrix([trees])[0] for name, trees in self.problem.quantities.items()}
        if self.moves:
            whole = Mechanisation(replace(flow.card, earth_rate=KEPT, transport_rate=KEPT), flow.world)
            x, world, level = whole.truth(), flow.world, flow.card.frame == LEVEL
            gravity = constant(world.gravity)
            if len(given.get("gravity", ())) == 3 and self.source.frame == LEVEL == flow.card.frame:
                gravity = whole.turn(x) @ [NOTHING, NOTHING, *gravity]
            vectors: dict[str, Any] = {"velocity": x.velocity, "known_vector": constant(world.seen)}
            vectors["velocity_body"] = x.attitude.T @ x.velocity
            vectors["earth_rate"] = whole.earth_rate(x) if level else constant(world.earth_rate)
            vectors |= {"specific_force": x.attitude @ constant(world.f), "gravity": gravity}
            there: tuple[Any, Any] = (whole.transport_rate(x), []) if level else ([], constant(world.r))
            vectors |= zip(("transport_rate", "position"), there, strict=True)
            vectors = {name: v for name, v in vectors.items() if len(given.get(name, "")) == 3 or name == "gravity"}
            if self.source.frame == flow.card.frame and len(given.get("gravity", "")) < 3:
                del vectors["gravity"]
            if {"rotation", "quaternion"} & set(given):
                vectors["rotation"] = [entry for row in x.attitude for entry in row]
            given |= {name: [self.formulas.write(x.value) for x in vector] for name, vector in vectors.items()}
            given.pop("quaternion", None)
        if "rotation" in given:
            given["rotation"] = [given["rotation"][k : k + 3] for k in (0, 3, 6)]
        return {name: texts for name, texts in given.items() if texts and HIDDEN not in repr(texts)}

    def neglected(self) -> list[list[str]]:
        """F of the source with all its terms less F of the model."""
        n, F = range(self.n), print_matrix(self.problem.F)
        whole = [list(row) for row in F]
        flow = Mechanisation(plain_card(self.source), self.formulas.world)
        sign = partial(self.comparison.block_sign, self.source)
        write_blocks(self.problem, flow, self.formulas, sign, {"F": whole})
        return [[self.subtract(whole[i][j], F[i][j]) for j in n] for i in n]

    def subtract(self, x: str, y: str) -> str:
        """x - y as a text."""
        left, right = self.formulas.read(x), self.formulas.read(y)
        if x == y or None in (left, right):
            return "0" if x == y or self.is_equal(x, y) else f"{x} - ({y})"
        return self.formulas.write(left - right)

    def is_proved(self, pairs: Sequence[tuple[list[list[str]], list[list[str]]]]) -> bool:
        """True where matrices are equal, entry by entry."""
        for rows in (rows for pair in pairs for rows in zip(*pair, strict=True)):
            self.step()
            if not all(x == y or self.is_equal(x, y) for x, y in zip(*rows, strict=True)):
                return False
        return True

    def is_equal(self, x: str, y: str) -> bool:
        """True where the checker grants that formulas are equal, or exact algebra where they are long."""
        if len(x) + len(y) > LONG and self.formulas.agree(x, y):
            return True
        return self.prover.compare(plain_card(self.source), x, y).status == PROVED


def multiply_texts(A: Sequence[Sequence[str]], B: Sequence[Sequence[str]]) -> list[list[str]]:
    """A B as texts; zeros and ones cost nothing."""

    def term(a: str, b: str) -> str:
        return b if a == "1" else a if b == "1" else f"({a})*({b})"

    columns = list(zip(*B, strict=True))
    return [
        [
            " + ".join(f"({term(a, b)})" for a, b in zip(row, column, strict=True) if "0" not in (a, b)) or "0"
            for column in columns
        ]
        for row in A
    ]


def add_texts(A: list[list[str]], B: list[list[str]]) -> list[list[str]]:
    """A + B as texts."""
    return [
        [b if a == "0" else a if b == "0" else f"{a} + ({b})" for a, b in zip(*rows, strict=True)]
        for rows in zip(A, B, strict=True)
    ]


def convert(
    problem: Problem,
    source: Card,
    changes: Mapping[str, str],
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Conversion:
    """The model of a problem, which is right under ``source``, in the errors of another card."""
    target, whole = read_target(source, changes, problem)
    converter = Converter(problem, whole, target, progress)
    flow = Mechanisation(plain_card(whole), converter.formulas.world)
    way = Passage(flow, carry_motion(flow, plain_card(target)))
    free = flow.turn_body()
    apart = Passage(free, carry_motion(free, plain_card(target)))
    (T, rate), (inverse, _) = converter.transformation(apart), converter.transformation(apart, back=True)
    with precision(BITS):
        F, H, G, reset = converter.matrices(way, inverse)
        exact = whole == source
        neglected = [["0"] * len(T) for _ in T] if exact else converter.neglected()
    require_names("convert", T, inverse, rate, neglected, F, H, G, reset)
    unit = [["1" if i == j else "0" for j in range(len(T))] for i in range(len(T))]
    before = print_matrix(problem.F) if exact else add_texts(print_matrix(problem.F), neglected)
    pairs = [(multiply_texts(T, inverse), unit), (multiply_texts(F, T), add_texts(multiply_texts(T, before), rate))]
    if H:
        pairs.append((multiply_texts(H, T), print_matrix(problem.H)))
    if G:
        pairs.append((G, multiply_texts(T, print_matrix(problem.G))))
    frozen = (tuple(map(tuple, M)) for M in (T, inverse, rate, neglected, F, H, G, reset))
    said = converter.quantities(way.target), converter.is_proved(pairs), problem, tuple(converter.prover.certificates)
    return Conversion(source, target, *frozen, *said)  # type: ignore[call-arg,arg-type]
