"""Inequalities on which provers for the reals are tried, as statements with ranges.

Read from a checkout of github.com/jrh13/hol-light, the files of ``FILES``; figures in docs/corpora.md are of commit
924faf0c3471a04174ffdeb8576ce7cabcb92d64. A problem is a term between backquotes: bounds of symbols imply a relation.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path

from tests.attacks.statements import Statement
from tests.attacks.trees import RELATIONS, Tree, UnreadableError, names_in, number, replace, write

REPOSITORY = "hol-light"
FILES = (
    "Examples/sos.ml", "Rqe/examples.ml", "Formal_ineqs/examples.hl", "Formal_ineqs/examples_other.hl",
    "Formal_ineqs/examples_flyspeck.hl", "Formal_ineqs/examples_poly.hl",
)  # fmt: skip
FUNCTIONS = {"sqrt": "sqrt", "atn": "atan", "acs": "acos", "asn": "asin", "abs": "abs", "sin": "sin", "cos": "cos",
             "tan": "tan", "exp": "exp", "log": "log"}  # fmt: skip
TOKEN = re.compile(r"\s*(?:[&#](\d+(?:\.\d+)?)|(\d+)|([A-Za-z_]\w*'*)|(==>|<=>|/\\|\\/|<=|>=|--|[-+*/()<>=~!?.;\[\]]))")
COMPARISONS = ("<=", ">=", "=", "<", ">")
MIRRORED = {"<=": ">=", ">=": "<=", "<": ">", ">": "<", "=": "="}
Relation = tuple[str, Tree, Tree]


class Reader:
    """Recursive descent over one term."""

    def __init__(self, text: str):
        self.tokens: list[str] = []
        place, text = 0, text.rstrip()
        while place < len(text):
            match = TOKEN.match(text, place)
            if match is None:
                raise UnreadableError(text[place : place + 20])
            self.tokens.append(match[match.lastindex])
            place = match.end()
        self.tokens.append("")
        self.place = 0

    @property
    def token(self) -> str:
        return self.tokens[self.place]

    def take(self, *marks: str) -> str:
        mark = self.token
        if mark == "" or mark not in marks:
            return ""
        self.place += 1
        return mark

    def expect(self, mark: str) -> None:
        if not self.take(mark):
            raise UnreadableError(f"{self.token!r}, expected {mark}")

    def problem(self) -> tuple[list[Relation], list[Relation]]:
        """Hypotheses and conclusions."""
        while self.take("!"):
            while not self.take("."):
                self.place += 1
        given: list[Relation] = []
        found = self.relations()
        while self.take("==>"):
            given, found = given + found, self.relations()
        if self.token:
            raise UnreadableError(self.token)
        return given, found

    def relations(self) -> list[Relation]:
        found = self.relation()
        while self.take("/\\"):
            found += self.relation()
        return found

    def relation(self) -> list[Relation]:
        start = self.place
        try:
            left = self.sum()
            mark = self.take(*COMPARISONS)
            if not mark:
                raise UnreadableError(self.token)
            return [(mark, left, self.sum())]
        except UnreadableError:
            self.place = start
            self.expect("(")
            inside = self.relations()
            self.expect(")")
            return inside

    def sum(self) -> Tree:
        tree = self.product()
        while mark := self.take("+", "-"):
            tree = (mark, tree, self.product())
        return tree

    def product(self) -> Tree:
        tree = self.power()
        while mark := self.take("*", "/"):
            tree = (mark, tree, self.power())
        return tree

    def power(self) -> Tree:
        base = self.atom()
        while self.take("pow"):
            base = ("**", base, self.atom())
        return base

    def atom(self) -> Tree:
        word = self.token
        self.place += 1
        if word == "--":
            return ("neg", self.atom())
        if word == "(":
            tree = self.sum()
            self.expect(")")
            return tree
        if word[:1].isdigit():
            return number(Fraction(word))
        if word in FUNCTIONS:
            return (FUNCTIONS[word], self.atom())
        if re.fullmatch(r"[A-Za-z]\w*", word) and word not in ("pow", "inv", "MOD", "DIV", "EXP"):
            return ("pi",) if word == "pi" else ("name", word)
        raise UnreadableError(word)


def declare(given: list[Relation]) -> tuple[dict[str, object], dict[str, Tree]]:
    """Declarations of the symbols that hypotheses bound, and what stands for a symbol that is bounded on one side."""
    ends: dict[str, dict[str, Tree]] = {}
    for mark, left, right in given:
        if left[0] == "abs" and left[1][0] == "name" and mark == "<=" and not names_in(right):
            ends.setdefault(left[1][1], {}).update({">=": ("neg", right), "<=": right})
            continue
        if left[0] != "name" or names_in(right):
            mark, left, right = MIRRORED[mark], right, left
        if left[0] != "name" or names_in(right) or mark == "=":
            raise UnreadableError("a hypothesis that is no bound of a symbol")
        ends.setdefault(left[1], {})[mark] = right
    symbols: dict[str, object] = {}
    stands: dict[str, Tree] = {}
    for name, bounds in ends.items():
        if set(bounds) == {">=", "<="}:
            symbols[name] = [write(bounds[">="]), write(bounds["<="])]
        elif set(bounds) == {">"} or set(bounds) == {">="}:
            ((mark, low),) = bounds.items()
            symbols[name] = "positive" if mark == ">" else "nonnegative"
            stands[name] = ("+", low, ("name", name))
        else:
            raise UnreadableError(f"{name} between strict bounds")
    return symbols, stands


def statements_of(text: str) -> list[Statement]:
    """The statements of a term, one for each conclusion; raises UnreadableError."""
    if not any(mark in text for mark in COMPARISONS):
        text = f"&0 <= {text}"  # a polynomial that is to be written as a sum of squares
    given, found = Reader(text).problem()
    symbols, stands = declare(given)
    return [make_statement(relation, symbols, stands) for relation in found]


def make_statement(relation: Relation, symbols: Mapping[str, object], stands: Mapping[str, Tree]) -> Statement:
    mark, *sides = relation
    if mark not in RELATIONS:
        raise UnreadableError(mark)
    left, right = (replace(side, dict(stands)) for side in sides)
    names = names_in(left) | names_in(right)
    declared = {name: symbols.get(name, "real") for name in sorted(names)}
    return Statement(f"{write(left)} {mark} {write(right)}", None, declared)


def read_polynomials(text: str) -> Iterator[tuple[str, Statement | None]]:
    """The problems of the file that gives polynomials, least values and domains by names: least < polynomial."""
    named = {name: terms for name, *terms in re.findall(r"(\w+) = `([^`]*)`(?:\s*,\s*`([^`]*)`)?", text)}
    for name in (name.removesuffix("_poly") for name in named if name.endswith("_poly")):
        least, polynomial = (Reader(named[f"{name}_{kind}"][0]).sum() for kind in ("min", "poly"))
        ends = [[Reader(end).sum() for end in row.strip("[]").split(";")] for row in named[f"{name}_dom"]]
        pairs = zip(*ends, strict=True)
        symbols = {f"x{k}": [write(low), write(high)] for k, (low, high) in enumerate(pairs, 1)}
        yield name, make_statement(("<", least, polynomial), symbols, {})


def read_entries(checkout: Path) -> Iterator[tuple[str, Statement | None]]:
    """(file and line, statement) of every problem; None for a term outside the language, or without bounds."""
    for name in FILES:
        text = (checkout / name).read_text(encoding="utf-8")
        if name.endswith("poly.hl"):
            yield from read_polynomials(text)
            continue
        first = max(0, text.find("* Examples. ")) if name.endswith("sos.ml") else 0
        for match in re.compile(r"`([^`]+)`").finditer(text, first):
            if not re.search(r"[&#]\d", match[1]) or text[: match.start()].endswith("new_definition "):
                continue  # about whole numbers, or no statement at all
            place = f"{name.rpartition('/')[2]}:{text.count(chr(10), 0, match.start()) + 1}"
            try:
                for statement in statements_of(match[1]):
                    yield place, statement
            except (UnreadableError, ValueError):
                yield place, None
