"""What the prover says of a card: each block equals the card's, or an entry of it does not.

The statements are formulas of the user's own names. Where names are bound by relations they are written by free ones:
a rotation by three angles, the force in the frame by that in the body, the rate of a local level by the velocity.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import chain
from typing import Any

from navsym.claims.verdict import OPEN, PROVED, Verdict
from navsym.conventions.card import Card
from navsym.conventions.mechanisation import CONSTANTS
from navsym.conventions.points import BITS, draw_values, evaluate, relate, substitute
from navsym.conventions.reading import Problem, print_matrix
from navsym.conventions.search import Block, key_of_points, narrow_card
from navsym.conventions.symbols import Formulas
from navsym.core.balls import precision
from navsym.core.errors import NavsymError
from navsym.language.expression import read_tree
from navsym.language.names import quote
from navsym.language.printer import print_tree
from navsym.language.tokens import LENGTH
from navsym.language.tree import Tree, list_names
from navsym.prove.claimfile import claims_from, decide_claim, statement_of
from navsym.prove.grant import grant_verdict


class Prover:
    """Statements about the blocks of one problem, each decided once."""

    def __init__(self, problem: Problem):
        self.problem = problem
        rest = {name: trees for name, trees in problem.quantities.items() if name != "transport_rate"}
        self.formulas = cache(
            lambda card, rates=True: Formulas(problem if rates else replace(problem, quantities=rest), card)
        )
        self.decide = cache(self.decide_texts)
        with precision(BITS):
            self.free_values = draw_values(problem, 99)
        self.certificates: list[Mapping[str, Any]] = []

    def block_texts(self, card: Card, block: Block, sign: Fraction, rates: bool = True) -> list[list[str]]:
        """The card's block in the user's names; without those of a transport rate it is written by the velocity."""
        return self.formulas(narrow_card(card, block[1]), rates).block(*block, sign)

    def is_right(self, card: Card, block: Block, sign: Fraction) -> bool:
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
        trees = [read_tree(text, None) for text in (left, right)]
        bound, _ = relate(self.problem, key_of_points(card))
        if set(bound) & set(list_names(*trees)) and not self.is_free_identity(trees):
            trees = [substitute(tree, bound) for tree in trees]
        texts = [*map(print_tree, trees)]
        if max(map(len, texts)) > LENGTH:  # the checker reads no formula as long as this
            return Verdict(PROVED if self.formulas(card).agree(left, right) else OPEN, "quotients of polynomials")
        return self.decide(*texts)

    def is_free_identity(self, trees: Sequence[Tree]) -> bool:
        """True where the texts agree even at a point that satisfies no relation."""
        with precision(BITS):
            left, right = (evaluate(tree, self.free_values) for tree in trees)
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
