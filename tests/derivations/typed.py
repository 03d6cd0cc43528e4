"""Derived sides that no derivation gave: built of symbols and numbers alone, as the printed side is.

A side is followed through the names of its function, of its file and of its paper. It is derived when it calls what
computes from a model: a function of the paper, a derivative, an integral, a limit, an inverse, a solution.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

#: Calls that only write a formula or a list down.
PLAIN = frozenset(
    "Rational Integer Fraction sqrt sin cos tan cot sec exp log asin acos atan Abs abs Symbol symbols Matrix eye zeros "
    "ones diag list tuple dict set sorted range zip enumerate len str int bool min max sum map items keys values state "
    "join append extend".split()
)


def bind(names: dict[str, list[ast.AST]], target: ast.AST, value: ast.AST) -> None:
    for node in ast.walk(target):
        if isinstance(node, ast.Name):
            names.setdefault(node.id, []).append(value)


def names_of(body: ast.AST) -> dict[str, list[ast.AST]]:
    """What each name of a function stands for: assigned, added to, run through."""
    names: dict[str, list[ast.AST]] = {}
    for node in ast.walk(body):
        if isinstance(node, ast.Assign | ast.AnnAssign | ast.AugAssign):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                bind(names, target, node.value or target)
        elif isinstance(node, ast.For | ast.comprehension):
            bind(names, node.target, node.iter)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if node.func.attr in ("append", "extend"):
                bind(names, node.func.value, node.args[0])
        elif isinstance(node, ast.FunctionDef | ast.Lambda):
            for one in node.args.args:
                bind(names, ast.Name(one.arg), ast.Call(ast.Name("argument"), [], []))
    return names


def top_of(trees: list[ast.Module]) -> dict[str, list[ast.AST]]:
    """What the names of a paper's files stand for; a function computes."""
    top: dict[str, list[ast.AST]] = {}
    for node in (node for tree in trees for node in tree.body):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            bind(top, ast.Name(node.name), ast.Call(ast.Name(node.name), [], []))
        elif isinstance(node, ast.Assign | ast.AnnAssign) and node.value:
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                bind(top, target, node.value)
    return top


def is_computed(side: ast.AST, own: dict[str, list[ast.AST]], top: dict[str, list[ast.AST]]) -> bool:
    waiting, seen = [side], set()
    while waiting:
        for node in ast.walk(waiting.pop()):
            if isinstance(node, ast.Call):
                name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                if name not in PLAIN:
                    return True
            elif isinstance(node, ast.Name) and node.id == "UNDECIDED":
                return True  # an open question claims nothing
            elif isinstance(node, ast.Name) and node.id not in seen:
                seen.add(node.id)
                waiting += own.get(node.id) or top.get(node.id, [])
    return False


def owner_of(tree: ast.Module, line: int) -> tuple[str, ast.AST]:
    """The number of the claim whose statement stands on a line, or the name of its function; and its source."""
    around = next(n for n in tree.body if n.lineno <= line <= (n.end_lineno or 0) or is_decorated(n, line))
    for number, derive, whole in headings_in(around):
        if isinstance(around, ast.FunctionDef) or whole.lineno <= line <= (whole.end_lineno or 0):
            return number, derive or around
    name = getattr(around, "name", ast.unparse(around)[:30])
    rows = (row for node in tree.body for row in headings_in(node))
    return next((one for one, f, _ in rows if isinstance(f, ast.Name) and f.id == name), name), around


def headings_in(node: ast.AST) -> Iterator[tuple[str, ast.expr | None, ast.expr]]:
    """The number of each claim in a statement of a file; what states it, in a table; and where it stands."""
    for call in ast.walk(node):
        called = ast.unparse(call.func) if isinstance(call, ast.Call) and call.args else ""
        if called == "claims":
            rows = [(a, f, f) for a, f in zip(call.args[::2], call.args[1::2], strict=True)]
        else:
            rows = [(call.args[0], None, call)] if called == "claim" else []
        for heading, derive, whole in rows:
            yield ast.unparse(heading).strip("'\"").partition(" | ")[0], derive, whole


def is_decorated(node: ast.AST, line: int) -> bool:
    return isinstance(node, ast.FunctionDef) and any(
        one.lineno <= line <= one.end_lineno for one in node.decorator_list
    )


def typed_in(files: list[Path], statements_of) -> Iterator[str]:
    """The claims, or functions, of a paper's files whose derived side nothing computes."""
    trees = {file: ast.parse(file.read_text(encoding="utf-8")) for file in files}
    top = top_of([*trees.values()])
    for tree in trees.values():
        for line, (_, derived) in statements_of(tree):
            number, source = owner_of(tree, line)
            if not is_computed(derived, names_of(source), top):
                yield number
