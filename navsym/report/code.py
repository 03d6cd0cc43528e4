"""A formula of a record as one line of Python or C, to be looked at and tried.

Written from the text of the record. Code for a product comes from ``navsym export``, which adds test
vectors, error bounds and a certificate.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from navsym.report.formula.reader import Node, read_formula, unwrapped

Record = Mapping[str, Any]
OPERATIONS = {"sum": "+", "difference": "-", "product": "*", "quotient": "/"}
LOOSENESS = {"sum": 1, "difference": 1, "minus": 2, "product": 3, "quotient": 3, "power": 5}
SAME = frozenset("sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt".split())
TURNED = {"cot": "tan", "sec": "cos", "csc": "sin"}
LONGEST = 400
NAME = re.compile(r"[^A-Za-z0-9]+")
RESERVED = frozenset(
    "lambda and or not in is if else for def del from pass int long short char float double const return".split()
)


class NoCodeError(ValueError):
    """A formula that this small writer leaves to ``navsym export``."""


@dataclass(frozen=True, slots=True)
class Snippet:
    """One function in one language."""

    language: str
    text: str


def snippets(record: Record) -> tuple[Snippet, ...]:
    """The printed side of a statement that holds, as a function; empty where it is no scalar formula."""
    if record["status"] not in ("PROVED", "CERTIFIED") or " +- " in record["printed"]:
        return ()
    tree = read_formula(record["printed"])
    names = sorted(symbols(tree)) if tree is not None else []
    if tree is None or unwrapped(tree).kind == "name" or len(record["printed"]) > LONGEST:
        return ()
    if not names or set(names) & RESERVED:
        return ()
    called = NAME.sub("_", record["id"].partition(":")[2]).strip("_")
    called = called if called[0].isalpha() else f"eq_{called}"
    try:
        return (python(called, names, tree, record["id"]), c(called, names, tree, record["id"]))
    except NoCodeError:
        return ()


def python(called: str, names: list[str], tree: Node, claim: str) -> Snippet:
    """The formula as a function of Python."""
    head = f"import math\n\ndef {called}({', '.join(names)}):  # {claim}\n"
    return Snippet("Python", f"{head}    return {written(tree, 'python')}\n")


def c(called: str, names: list[str], tree: Node, claim: str) -> Snippet:
    """The formula as a function of C on doubles."""
    arguments = ", ".join(f"double {name}" for name in names)
    head = f"#include <math.h>\n\ndouble {called}({arguments}) {{  /* {claim} */\n"
    return Snippet("C", f"{head}    return {written(tree, 'c')};\n}}\n")


def symbols(node: Node) -> set[str]:
    """Names of a formula, without pi."""
    own = {node.text} if node.kind == "name" and node.text != "pi" else set()
    return own.union(*(symbols(part) for part in node.parts))


def written(node: Node, language: str) -> str:
    """A tree as an expression; numbers are doubles, so that no division is one of integers."""
    node = unwrapped(node)
    if node.kind == "number":
        return node.text if "." in node.text or "e" in node.text else f"{node.text}.0"
    if node.kind == "name" and not node.text.endswith("'"):
        return {"python": "math.pi", "c": "M_PI"}[language] if node.text == "pi" else node.text
    if node.kind == "minus":
        return f"-{bound(node.parts[0], 3, language)}"
    if node.kind == "power":
        base, exponent = (written(part, language) for part in node.parts)
        return f"math.pow({base}, {exponent})" if language == "python" else f"pow({base}, {exponent})"
    if node.kind in OPERATIONS and len(node.parts) == 2:
        return operation(node, language)
    if node.kind == "call":
        return call(node, language)
    raise NoCodeError(node.kind)


def operation(node: Node, language: str) -> str:
    """Two operands around their operator, in brackets where they bind looser."""
    own = LOOSENESS[node.kind]
    left, right = bound(node.parts[0], own, language), bound(node.parts[1], own + 1, language)
    return f"{left} {OPERATIONS[node.kind]} {right}" if own == 1 else f"{left}{OPERATIONS[node.kind]}{right}"


def bound(node: Node, own: int, language: str) -> str:
    """A part in brackets where it binds looser than what stands around it."""
    text = written(node, language)
    return f"({text})" if LOOSENESS.get(unwrapped(node).kind, 9) < own else text


def call(node: Node, language: str) -> str:
    """A call of the language's library; raises NoCodeError for a function that it does not have."""
    inside = ", ".join(written(part, language) for part in node.parts)
    place = "math." if language == "python" else ""
    if node.text == "abs":
        return f"abs({inside})" if language == "python" else f"fabs({inside})"
    if node.text in TURNED:
        return f"(1.0/{place}{TURNED[node.text]}({inside}))"
    if node.text not in SAME:
        raise NoCodeError(node.text)
    return f"{place}{node.text}({inside})"
