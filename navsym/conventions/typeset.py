"""Cards and models in LaTeX: the definitions of the errors, and matrices block by block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from navsym.claims.formula import side_latex
from navsym.conventions.card import ESTIMATE, HALF, HEADINGS, Card
from navsym.conventions.reading import Problem

#: Role -> its letter; what errors are errors of.
LETTERS = dict(
    position="r", velocity="v", gyro_bias="b_g", accelerometer_bias="b_a", gyro_scale="k_g", accelerometer_scale="k_a"
)
DEFINED = ("attitude", "position", "velocity", "gyro_bias", "accelerometer_bias")


def letter(role: str, card: Card) -> str:
    """The letter of an error."""
    return rf"\delta {LETTERS[role]}" if role in LETTERS else r"\psi" if card.angle == "psi" else r"\varphi"


def define_error(role: str, card: Card) -> str:
    """The definition of one error, the estimate with a hat."""
    if role == "attitude":
        small = (
            rf"\left(E {card.rotation_sign} {'2 ' * (card.attitude_size == HALF)}[{letter(role, card)} \times]\right)"
        )
        return rf"\hat C = {small} C" if card.attitude_error == "frame" else rf"\hat C = C {small}"
    kind, way = role.rpartition("_")[2], card.vector(role)
    x, error = LETTERS[role], {"bias": card.bias_sign, "scale": card.scale_sign}.get(kind, card.error)
    pair = [rf"\hat {x}", rf"\hat C C^T {x}" if way == (True, False) else x]
    pair = [rf"\hat C^T {pair[0]}", f"C^T {x}"] if way == (True, True) else pair
    difference = " - ".join(pair if error == ESTIMATE else reversed(pair))
    return f"{letter(role, card)} = " + (rf"C^T \left({difference}\right)" if way == (False, True) else difference)


def card_latex(card: Card, roles: Sequence[str] = ()) -> str:
    r"""A card: a line for each definition, and one of words.

    >>> print(card_latex(Card("inertial"), ["attitude", "velocity"]))
    \begin{gathered}
    \hat C = \left(E + [\varphi \times]\right) C \\
    \delta v = \hat v - v \\
    \text{frame: inertial; Earth: none; gravity gradient: none}
    \end{gathered}
    """
    defined = ("error", "rotation_sign", "attitude_size", "attitude_error", "bias_sign", "scale_sign", "vector_error")
    words = [f"{HEADINGS[name]}: {word}" for name, word in card.words().items() if name not in defined]
    return stack([*(define_error(role, card) for role in roles or DEFINED), rf"\text{{{'; '.join(words)}}}"])


def stack(lines: Sequence[str]) -> str:
    """Formulas below each other."""
    return "\n".join([r"\begin{gathered}", " \\\\\n".join(lines), r"\end{gathered}"])


def blocks_latex(name: str, rows: Sequence[Sequence[str]], problem: Problem, cards: tuple[Card, Card]) -> list[str]:
    """The blocks of a square matrix that are not zero, each with the letters of its row and column.

    cards : of the rows and of the columns
    """
    lines, names = [], dict.fromkeys(problem.parameters, "real")
    for row, places in problem.roles.items():
        for column, others in problem.roles.items():
            block: list[Any] = [[rows[i][j] for j in others] for i in places]
            if any(cell != "0" for cells in block for cell in cells):
                index = rf"{letter(row, cards[0])},\,{letter(column, cards[1])}"
                lines.append(rf"{name}_{{{index}}} = {side_latex(block, names)}")
    return lines


def model_latex(problem: Problem, card: Card, matrices: Mapping[str, Sequence[Sequence[str]]], source: Card) -> str:
    """A card, and matrices of its states block by block; the columns of T and of what is neglected are the source's."""
    roles, lines = list(problem.roles), []
    for name, rows in matrices.items():
        of = {"T": (card, source), r"\Delta F": (source, source)}.get(name, (card, card))
        lines += blocks_latex(name, rows, problem, of)
    return stack([card_latex(card, roles), *lines])
