"""What the prover says of a card: each block equals the card's, or an entry of it does not.

The statements are formulas of the user's own names. Where names are bound by relations they are written by free ones:
a rotation by three angles, the force in the frame by that in the body, the rate of a local level by the velocity.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import chain
from typing import Any

from navsym.claims.verdict import OPEN, PROVED, Verdict
from navsym.conventions.card import DROPPED, KEPT, Card
from navsym.conventions.measuring import MEASURED_MARK, RESET_MARK
from navsym.conventions.mechanisation import CONSTANTS, Mechanisation
from navsym.conventions.points import BITS, Sampler, evaluate
from navsym.conventions.reading import HIDDEN, Problem, print_matrix
from navsym.conventions.search import Block, narrow_card
from navsym.conventions.symbols import Formulas
from navsym.core.balls import precision
from navsym.core.errors import NavsymError
from navsym.language.expression import read_tree
from navsym.language.names import quote
from navsym.language.printer import print_tree
from navsym.language.tokens import LENGTH
from navsym.language.tree import SYMBOL, Tree, build_symbol, list_names
from navsym.language.tree import replace as replace_parts
from navsym.prove.claimfile import claims_from, decide_claim, statement_of
from navsym.prove.grant import grant_verdict

ANGLES = tuple(f"{HIDDEN}a{k}" for k in (1, 2, 3))


def euler_texts() -> list[str]:
    """The entries of a rotation by three angles; every rotation is one of these."""
    (s1, c1), (s2, c2), (s3, c3) = ((f"sin({a})", f"cos({a})") for a in ANGLES)
    return [
        f"{c1}*{c2}", f"{c1}*{s2}*{s3} - {s1}*{c3}", f"{c1}*{s2}*{c3} + {s1}*{s3}",
        f"{s1}*{c2}", f"{s1}*{s2}*{s3} + {c1}*{c3}", f"{s1}*{s2}*{c3} - {c1}*{s3}",
        f"-{s2}", f"{c2}*{s3}", f"{c2}*{c3}",
    ]  # fmt: skip


def quaternion_texts() -> list[str]:
    """The components of a unit quaternion by three angles; every one is one of these."""
    (s1, c1), (s2, c2), (s3, c3) = ((f"sin({a})", f"cos({a})") for a in ANGLES)
    return [f"{c1}*{c2}", f"{c1}*{s2}", f"{s1}*{c3}", f"{s1}*{s3}"]


class Prover:
    """Statements about the blocks of one problem, each decided once."""

    def __init__(self, problem: Problem):
        self.problem = problem
        self.formulas = cache(lambda card: Formulas(problem, card))
        self.decide = cache(self.decide_texts)
        self.certificates: list[Mapping[str, Any]] = []

    def block_texts(self, card: Card, block: Block, sign: int) -> list[list[str]]:
        """The card's block in the user's names."""
        still = card.earth == "none" and card.earth_rate in (None, DROPPED) and card.vector_error != "rotated"
        # Without gravity among the terms a flat Earth that does not turn is an inertial frame.
        if still and not block[0].startswith((MEASURED_MARK, RESET_MARK)):
            names = ("attitude_error", "vector_error", "position_error")
            card = Card("inertial", **{name: getattr(card, name) for name in names}, **card.quaternion())
        return self.formulas(narrow_card(card, block[1])).block(*block, sign)

    def is_right(self, card: Card, block: Block, sign: int) -> bool:
        """True where the prover grants that the blocks are equal."""
        written = print_matrix(self.problem.block(*block))
        if {*block} <= {*CONSTANTS}:  # a constant may decay; it depends on no other one
            own = block[0] == block[1]
            pairs = [(cell, "0") for i, row in enumerate(written) for j, cell in enumerate(row) if i != j or not own]
        else:
            pairs = [*zip(chain(*written), chain(*self.block_texts(card, block, sign)), strict=True)]
        return all(self.compare(card, *pair).status == PROVED for pair in pairs if pair != ("0", "0"))

    def compare(self, card: Card, left: str, right: str) -> Verdict:
        """The verdict on ``left = right`` under the relations of the quantities."""
        if left == right:
            return self.decide(left, right)
        names = {*self.problem.parameters}
        trees = [read_tree(text, None) for text in (left, right)]
        bound = self.relations(card)
        if set(bound) & set(list_names(*trees)) and not self.is_free_identity(card, trees, names):
            trees = [substitute(tree, bound) for tree in trees]
        texts = [*map(print_tree, trees)]
        if max(map(len, texts)) > LENGTH:  # the checker reads no formula as long as this
            return Verdict(PROVED if self.formulas(card).agree(left, right) else OPEN, "quotients of polynomials")
        return self.decide(*texts)

    def is_free_identity(self, card: Card, trees: Sequence[Tree], names: set[str]) -> bool:
        """True where the texts agree even at a point that satisfies no relation."""
        with precision(BITS):
            values = dict(Sampler(self.problem, card, 99, free=True).values)
            source = Sampler(self.problem, card, 98)
            for name in list_names(*trees):
                if name not in names:
                    values[name] = source.pick(None)
            left, right = (evaluate(tree, values) for tree in trees)
            return bool((left - right).contains(0))

    def decide_texts(self, left: str, right: str) -> Verdict:
        """The verdict on one equation."""
        names = list_names(read_tree(left, None), read_tree(right, None))
        declared = {name: self.problem.declared.get(name, "real") for name in names}
        document = {"symbols": declared, "claim": [{"id": "entry", "left": left, "right": right}]}
        try:
            claim = claims_from(document).claims[0]
        except NavsymError as error:
            error.where = f"model: entry {quote(left)}"
            raise
        # Equality is what is expected: a proof is looked for before a counterexample.
        verdict = grant_verdict(statement_of(claim), Verdict(OPEN, "none"))
        verdict = verdict if verdict.status == PROVED else decide_claim(claim)
        if verdict.certificate is not None:
            self.certificates.append(verdict.certificate)
        return verdict

    def relations(self, card: Card) -> dict[str, str]:
        """Bound name -> text of free ones; later ones may contain earlier ones no more."""
        given = self.problem.under(card).quantities
        result: dict[str, str] = {}
        texts = {name: [print_tree(tree) for tree in trees] for name, trees in given.items()}

        def bind(quantity: str, values: Sequence[str]) -> None:
            for tree, value in zip(given.get(quantity, ()), values, strict=False):
                if tree.head == SYMBOL:
                    result.setdefault(tree.args[0], value)

        if all(tree.head == SYMBOL for tree in given.get("quaternion", ())):
            bind("quaternion", quaternion_texts())
        if all(tree.head == SYMBOL for tree in given.get("rotation", ())):
            bind("rotation", euler_texts())
        rotation = [
            print_tree(substitute(read_tree(text, None), result))
            for text in texts.get("rotation", [f"{HIDDEN}c{i}{j}" for i in range(3) for j in range(3)])
        ]
        if "rotation" not in given:
            result.update(zip(rotation, euler_texts(), strict=True))
            rotation = euler_texts()
        if {"specific_force", "specific_force_body"} <= set(given):
            body = texts["specific_force_body"]
            rows = [[f"({rotation[3 * i + k]})*({body[k]})" for k in range(3)] for i in range(3)]
            bind("specific_force", [*map(" + ".join, rows)])
        flow, formulas = self.free_motion(card)
        vectors: dict[str, Any] = {}
        if card.frame == "local-level":
            for name in ("earth_rate", "transport_rate", "gravity"):
                vectors[name] = getattr(flow, name)(flow.truth())
        elif formulas.derived:
            vectors["position"] = flow.truth().position
            if card.gravity_gradient == "normal":
                vectors["gravity"] = [row[2].value * formulas.symbol("gravity", None) for row in flow.normal_axes()]
        if card.gravity_gradient == "central" and "position" in texts:
            vectors["gravity"] = formulas.world.gravity
        for name, vector in vectors.items():
            if len(given.get(name, ())) == 3:
                bind(name, [formulas.write(getattr(x, "value", x)) for x in vector])
        return result

    def free_motion(self, card: Card) -> tuple[Mechanisation, Formulas]:
        """A motion with all its rates, in which nothing is given that follows from the rest."""
        shape = "ellipsoid" if len(self.problem.quantities.get("radii", ())) > 1 else "sphere"
        earth = card.earth if card.earth != "none" else shape
        whole = replace(card, earth=earth, earth_rate=KEPT, transport_rate=KEPT)
        following = ("earth_rate", "transport_rate", "gravity") if card.frame == "local-level" else ()
        given = self.problem.quantities.items()
        free = {name: trees for name, trees in given if name not in following or len(trees) == 1}
        formulas = Formulas(replace(self.problem, quantities=free), whole)
        return Mechanisation(whole, formulas.world), formulas


def substitute(tree: Tree, bound: Mapping[str, str]) -> Tree:
    """The tree with bound names written by free ones."""
    by = {build_symbol(name): read_tree(text, None) for name, text in bound.items() if name in list_names(tree)}
    return replace_parts(tree, by)
