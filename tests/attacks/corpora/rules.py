"""Rewrite rules of a floating-point rewriter, as statements ``left = right`` between real formulas.

Read from a checkout of github.com/uwplse/herbie, file ``src/syntax/rules.rkt``; figures in docs/corpora.md are of
commit b56752b171b034a060291bfec1d25e60230fe699. A rule is ``[name left right]`` in prefix form.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

from tests.attacks.statements import Statement
from tests.attacks.trees import Tree, UnreadableError, names_in, number, read, replace, write

REPOSITORY = "herbie"
FILE = "src/syntax/rules.rkt"
TOKEN = re.compile(r"[()\[\]]|[^\s()\[\]]+")
#: Operations by their meaning in the letters x, y and z.
MEANINGS = {
    "neg": "-x", "fabs": "abs(x)", "cbrt": "x**(1/3)", "pow": "x**y", "log1p": "log(1 + x)", "expm1": "exp(x) - 1",
    "hypot": "sqrt(x*x + y*y)", "fma": "x*y + z", "asinh": "log(x + sqrt(x**2 + 1))", "sqr": "x*x",
    "acosh": "log(x + sqrt(x - 1)*sqrt(x + 1))", "atanh": "log((1 + x)/(1 - x))/2", "+": "x + y", "-": "x - y",
    "*": "x*y", "/": "x/y", "atan2": "atan2(x, y)",
} | {name: f"{name}(x)" for name in "sin cos tan asin acos atan exp log sqrt sinh cosh tanh".split()}  # fmt: skip
CONSTANTS = {"PI": "pi", "E": "exp(1)"}


def parse(tokens: list[str]) -> Any:
    """The first item of the tokens, which are taken from the front: a word, or a list."""
    token = tokens.pop(0)
    if token not in "([":
        return token
    items = []
    while tokens and tokens[0] not in ")]":
        items.append(parse(tokens))
    if not tokens:
        raise UnreadableError("a bracket is not closed")
    tokens.pop(0)
    return items


def tree_of(item: Any) -> Tree:
    """The formula of a pattern; raises UnreadableError for what is no real formula of the language."""
    if isinstance(item, str):
        if item in CONSTANTS:
            return read(CONSTANTS[item])
        if re.fullmatch(r"-?\d+(/\d+|\.\d+)?", item):
            value = Fraction(item)
            return number(value) if value >= 0 else ("neg", number(-value))
        if re.fullmatch("[a-z]", item):
            return ("name", item)
        raise UnreadableError(item)
    head, *parts = item
    operands = [tree_of(part) for part in parts]
    if head == "-" and len(operands) == 1:
        head = "neg"
    if head not in MEANINGS:
        raise UnreadableError(str(head))
    meaning = read(MEANINGS[head])
    if len(names_in(meaning)) != len(operands):
        raise UnreadableError(f"{head} of {len(operands)}")
    return replace(meaning, dict(zip("xyz", operands, strict=False)))


def has_word(item: Any, word: str) -> bool:
    return item == word or (isinstance(item, list) and any(has_word(part, word) for part in item))


def statement_of(left: Any, right: Any) -> Statement:
    """The rule as a statement; letters are positive where a cube root is taken, which the language has not."""
    trees = tree_of(left), tree_of(right)
    declared = "positive" if has_word([left, right], "cbrt") else "real"
    return Statement(" = ".join(map(write, trees)), None, dict.fromkeys(sorted(names_in(("+", *trees))), declared))


def read_entries(checkout: Path) -> Iterator[tuple[str, Statement | None]]:
    """(name, statement) of every rule between numbers; None for one outside the language."""
    text = re.sub(r";[^\n]*", "", (checkout / FILE).read_text(encoding="utf-8"))
    for start in re.finditer(r"\(define-ruleset\*? [a-z]", text):
        _, _, _, *items = parse(TOKEN.findall(text[start.start() :]))
        if "#:type" in items:
            place = items.index("#:type")
            kinds = {pair[-1] for pair in items[place + 1]}
            items = items[place + 2 :]
            if kinds - {"real"}:
                continue
        for name, left, right in (item for item in items if isinstance(item, list) and len(item) == 3):
            try:
                yield name, statement_of(left, right)
            except (UnreadableError, ValueError):
                yield name, None
