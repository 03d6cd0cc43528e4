"""Entries of the book with one token changed: no verdict on them contradicts numbers.

``python -m tests.book.changed COUNT SEED [PATTERN]`` prints what contradicts, and the counts; PATTERN chooses entries
by their statement. A change leaves a statement true at times, so the numbers of ``tests/book/numeric.py`` judge it.
"""

from __future__ import annotations

import copy
import random
import re
import sys
from collections import Counter

import navsym as nav
from navsym.book.entries import without_units
from navsym.prove.claimfile import claims_from, decide_claims
from tests.book.numeric import holds_numerically

TOKEN = re.compile(r"\d+|[A-Za-z_]\w*|\*\*|.")
PAIRS = (("sin", "cos"), ("min", "max"), ("sinh", "cosh"), ("det", "trace"), ("inv", "transpose"), ("asin", "acos"))
OTHERS = {a: b for one, other in PAIRS for a, b in ((one, other), (other, one))}
OTHERS |= {"tan": "sin", "log": "sqrt", "abs": "sign", "+": "-", "-": "+", "/": "*", "**": "*"}


def change(text, names, rng):
    """The text with another number, name, function or sign at one place; a sign between two terms only."""
    tokens = TOKEN.findall(text)
    for _ in range(30):
        place = rng.randrange(len(tokens))
        token, before = tokens[place], "".join(tokens[:place]).rstrip()
        if token.isdigit():
            tokens[place] = str(rng.choice((int(token) + 1, max(int(token) - 1, 0), 2 * int(token))))
        elif token in OTHERS and not (token == "-" and (not before or before[-1] in "(,[=*")):
            tokens[place] = OTHERS[token]
        elif token in names and len(names) > 1:
            tokens[place] = rng.choice([name for name in names if name != token])
        else:
            continue
        break
    return "".join(tokens)


def change_entry(entry, rng):
    """The claim file of an entry with one change in one side."""
    document = copy.deepcopy(without_units(entry.document))
    block = document["claim"][0]
    key = rng.choice([key for key in ("left", "right", "chain") if isinstance(block.get(key), str)])
    names = sorted(set(re.findall(r"[A-Za-z_]\w*", block[key])) & {*document["symbols"]})
    return document | {"claim": [block | {key: change(block[key], names, rng)}]}


def judge(document, seed, seconds=4):
    """``refused``, ``wrong`` or a status; what is refuted where no random number was drawn is no contradiction."""
    try:
        (verdict,) = decide_claims(claims_from(document), seconds=seconds)
    except nav.NavsymError:
        return "refused"
    try:
        holds = holds_numerically(document, seed) if verdict.holds else None
    except (ArithmeticError, ValueError, TypeError, KeyError, IndexError):
        holds = None  # what a change makes may have no numbers
    return "wrong" if verdict.holds and holds is False else str(verdict.status)


def main(count, seed, pattern=""):
    rng = random.Random(seed)
    entries = [entry for entry in nav.book.values() if re.search(pattern, entry.statement)]
    counts = Counter()
    for number in range(count):
        document = change_entry(rng.choice(entries), rng)
        counts[found := judge(document, number)] += 1
        if found == "wrong":
            print(found, document["claim"], flush=True)
    print(dict(counts))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:])
