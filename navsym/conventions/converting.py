"""From one card to another: the transformation of the errors, and the model in them, proved on the user's own texts.

Both errors are defined for the same estimate and truth. The error of one card is put into an estimate and read by the
definition of the other: T, and along the flow its rate T'. Then F_to T = T F + T', H_to T = H and G_to = T G.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from navsym.claims.verdict import PROVED
from navsym.conventions.card import CHOICES, Card
from navsym.conventions.measuring import MEASURED_MARK, NOISE_MARK, RESET_MARK, unit_error
from navsym.conventions.mechanisation import BIASES, ROLES, Mechanisation
from navsym.conventions.points import BITS
from navsym.conventions.proof import Prover
from navsym.conventions.reading import Problem
from navsym.conventions.search import Comparison, change, plain_card
from navsym.conventions.symbols import Formulas
from navsym.core.balls import precision
from navsym.core.errors import DomainError
from navsym.language.names import quote

#: What a conversion may change: the definition of the errors, not the mechanisation.
CONVERTED = (
    "error", "attitude_error", "angle", "rotation_sign", "bias_sign", "position_error", "vector_error",
)  # fmt: skip
Texts = tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Conversion:
    """The same model in the errors of another card.

    source, target : the cards
    T, inverse     : x_to = T x and x = inverse x_to, in the order of the states; P_to = T P T'
    rate           : dT/dt along the true flow
    F, H, G        : of the target; H and G are empty where the model has none; Q and R stay
    proved         : True where the checker grants F_to T = T F + T', T inverse = E, H_to T = H and G_to = T G
    """

    source: Card
    target: Card
    T: Texts
    inverse: Texts
    rate: Texts
    F: Texts
    H: Texts
    G: Texts
    proved: bool

    def document(self) -> dict[str, Any]:
        """The conversion as JSON data."""
        names = ("T", "inverse", "rate", "F", "H", "G")
        matrices = {name: [list(row) for row in getattr(self, name)] for name in names}
        return {"from": self.source.document(), "to": self.target.document(), **matrices, "proved": self.proved}

    def __repr__(self) -> str:
        changed = [f.name for f in fields(Card) if getattr(self.source, f.name) != getattr(self.target, f.name)]
        words = ", ".join(f"{name} {getattr(self.target, name)}" for name in changed)
        return f"Conversion(to {words or 'the same card'}; {'PROVED' if self.proved else 'not all is proved'})"


def read_target(source: Card, changes: Mapping[str, str], problem: Problem) -> Card:
    """The card to convert to; raises DomainError for what is no definition of an error, or has no transformation."""
    curved = source.frame == "local-level" and source.earth != "none"
    names = [n for n in CONVERTED if getattr(source, n) is not None and (curved or n != "position_error")]
    for name, word in changes.items():
        if name not in names:
            known = ", ".join(names)
            message = f"expected one of {known}; got {quote(name)}; the mechanisation itself stays"
            raise DomainError(message, where="convert")
        if word not in CHOICES[name]:
            message = f"expected one of {', '.join(CHOICES[name])}; got {quote(word)}; correct it"
            raise DomainError(message, where=f"convert: {name}")
    dropped = [block for block in source.dropped if not block[0].startswith(RESET_MARK)]
    if dropped:
        got = "; ".join(f"zeros in {row} by {column}" for row, column in dropped)
        raise DomainError(f"expected a model without dropped blocks; got {got}; write them out", where="convert")
    target = change(source, changes)
    if "position" in problem.measured and target.position_error != source.position_error:
        message = "expected a measured position in the units of the error; got another unit; convert without it"
        raise DomainError(message, where="convert: position_error")
    return target


def transform(source: Mechanisation, target: Mechanisation, role: str, component: int) -> dict[str, list[Any]]:
    """A column of T and of its rate with every sign plus: role -> nilpotents whose error and mixed part they are."""
    truth = source.truth()
    later = truth.advance(source.rate(truth))
    error = target.compare(source.estimate(later, unit_error(role, component)), later)
    return {name: error[name] for name in ROLES}


class Converter:
    """The matrices of one conversion as texts in the user's names."""

    def __init__(self, problem: Problem, source: Card, target: Card):
        self.problem, self.source, self.target = problem, source, target
        self.prover, self.comparison = Prover(problem), Comparison(problem)
        self.n = len(problem.states)

    def transformation(self, source: Card, target: Card) -> tuple[list[list[str]], list[list[str]]]:
        """T and its rate; states without a role stay as they are."""
        T = [["1" if i == j else "0" for j in range(self.n)] for i in range(self.n)]
        rate = [["0"] * self.n for _ in range(self.n)]
        formulas = Formulas(self.problem, plain_card(source))
        flows = [Mechanisation(plain_card(card), formulas.world) for card in (source, target)]
        signs = [card.signs() for card in (source, target)]
        for column, places in self.problem.roles.items():
            for k, j in enumerate(places):
                parts = transform(flows[0], flows[1], column, k)
                for row, rows in self.problem.roles.items():
                    sign = signs[1][row] * signs[0][column]
                    for i, part in zip(rows, parts[row], strict=True):
                        T[i][j], rate[i][j] = (formulas.write(x, sign) for x in (part.error, part.mixed))
        return T, rate

    def matrices(self) -> tuple[list[list[str]], list[list[str]], list[list[str]]]:
        """F, H and G of the target."""
        from navsym.language.printer import print_tree

        problem, card = self.problem, plain_card(self.target)
        written = [[[print_tree(x) for x in row] for row in M] for M in (problem.F, problem.H, problem.G)]
        F, H, G = ([row[:] for row in M] for M in written)
        signs = self.target.signs()
        sides = list(problem.roles)
        blocks = [(F, row, column) for row in sides for column in sides if not {row, column} <= {*BIASES}]
        blocks += [(H, MEASURED_MARK + kind, column) for kind in problem.measured for column in sides]
        blocks += [(G, row, NOISE_MARK + noise) for row in sides for noise in problem.noises]
        for matrix, row, column in blocks:
            sign = self.comparison.block_sign(self.target, (row, column))
            if column.startswith(NOISE_MARK):  # the sign of a noise is that of the model as it was
                own = self.source.signs()
                sign = signs[row] * own[row] * self.comparison.block_sign(self.source, (row, column))
            texts = self.prover.block_texts(card, (row, column), sign)
            for i, line in zip(problem.places(row), texts, strict=True):
                for j, text in zip(problem.places(column), line, strict=True):
                    matrix[i][j] = text
        return F, H, G

    def is_proved(self, pairs: Sequence[tuple[list[list[str]], list[list[str]]]]) -> bool:
        """True where the prover grants that matrices are equal, entry by entry."""
        card = plain_card(self.target)
        return all(
            x == y or self.prover.compare(card, x, y).status == PROVED
            for left, right in pairs
            for rows in zip(left, right, strict=True)
            for x, y in zip(*rows, strict=True)
        )


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


def convert(problem: Problem, source: Card, changes: Mapping[str, str]) -> Conversion:
    """The model of a problem, which is right under ``source``, in the errors of another card."""
    from navsym.language.printer import print_tree

    target = read_target(source, changes, problem)
    converter = Converter(problem, source, target)
    T, rate = converter.transformation(source, target)
    inverse, _ = converter.transformation(target, source)
    with precision(BITS):
        F, H, G = converter.matrices()
    old = [[[print_tree(x) for x in row] for row in M] for M in (problem.F, problem.H, problem.G)]
    unit = [["1" if i == j else "0" for j in range(len(T))] for i in range(len(T))]
    pairs = [(multiply_texts(T, inverse), unit), (multiply_texts(F, T), add_texts(multiply_texts(T, old[0]), rate))]
    if H:
        pairs.append((multiply_texts(H, T), old[1]))
    if G:
        pairs.append((G, multiply_texts(T, old[2])))
    frozen = (freeze(M) for M in (T, inverse, rate, F, H, G))
    return Conversion(source, target, *frozen, proved=converter.is_proved(pairs))  # type: ignore[misc,arg-type]


def freeze(M: Sequence[Sequence[str]]) -> Texts:
    """A matrix that nobody changes."""
    return tuple(tuple(row) for row in M)
