"""Claim files that are right and odd: statements of several families in one file, laid out as people and tools do."""

from __future__ import annotations

import json
import random
from pathlib import Path

from tests.attacks.statements import Statement, make_statement
from tests.attacks.trees import read, replace, write


def draw_statements(rng: random.Random, size: int) -> list[Statement]:
    """Statements whose names differ, so that one table of symbols holds for all."""
    drawn: list[Statement] = []
    while len(drawn) < size:
        statement = make_statement(rng.randrange(10**6), rng.randrange(100))
        if statement.beside or not statement.names():
            continue
        names = {name: f"{name}_{len(drawn)}" for name in sorted(statement.names())}
        drawn.append(rename(statement, names))
    return drawn


def rename(statement: Statement, names: dict[str, str]) -> Statement:
    """The statement with other names."""
    left, relation, right = statement.sides()
    sides = [write(replace(side, {old: ("name", new) for old, new in names.items()})) for side in (left, right)]
    symbols = {new: statement.declared(old) for old, new in names.items()}
    witness = None if statement.witness is None else {names[name]: v for name, v in statement.witness.items()}
    return Statement(f"{sides[0]} {relation} {sides[1]}", statement.truth, symbols, witness, statement.family)


def write_file(path: Path, statements: list[Statement], rng: random.Random) -> None:
    """A claim file: literal or quoted strings, inline tables, comments, empty lines, either end of line, any order."""
    quote = rng.choice((json.dumps, "'{}'".format, "'''{}'''".format, '"""{}"""'.format))
    parts = []
    for k, statement in enumerate(statements):
        left, relation, right = split_sides(statement)
        block = [f'id = "claim-{k}"', f"left = {quote(left)}", f"right = {quote(right)}", f'relation = "{relation}"']
        rng.shuffle(block)
        parts.append("\n".join(["[[claim]]  # one", *block, ""]))
    symbols = {name: ends for statement in statements for name, ends in statement.symbols.items()}
    lines = [f"{name} = {json.dumps(declared)}" for name, declared in symbols.items()]
    rng.shuffle(lines)
    head = "symbols = {" + ", ".join(lines) + "}" if rng.random() < 0.3 else "\n".join(["[symbols]", *lines])
    texts = [head, *parts] if head.startswith("symbols") or rng.random() < 0.5 else [*parts, head]
    end = rng.choice(("\n", "\r\n"))
    path.write_text("\n\n".join(texts).replace("\n", end) + end * rng.randrange(3), encoding="utf-8", newline="")


def split_sides(statement: Statement) -> tuple[str, str, str]:
    """Left side, relation and right side as texts."""
    left, relation, right = statement.sides()
    return write(read(write(left))), relation, write(right)
