"""One sign flipped or one index shifted in the source of a paper, and which of its claims notice.

A place is a sum, a difference, a minus or a constant index in a file of ``derivations/``; printed sides, decorators and
experiments have none. The paper is imported once with every place watched: a claim *names* the places that its statement
runs through. It is imported again with one of them changed, and the claims that name it are stated and decided anew.
"""

from __future__ import annotations

import ast
import builtins
import functools
import gc
import importlib
import importlib.abc
import importlib.machinery
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from numbers import Number

import sympy as sp

from navsym.claims import Equation, claims_of
from navsym.claims.claim import PAPERS
from navsym.claims.paper import import_paper
from navsym.prove.ladder import decide
from navsym.verification.sides import hash_statement

WATCH = "__watch_planted__"
#: A place: the module behind the package of the papers, and which of its places.
Place = tuple[str, int]


class Places(ast.NodeTransformer):
    """Visits every place of a file in a fixed order; ``change`` says what stands there instead."""

    def __init__(self, change: Callable[[int, ast.expr, ast.expr], ast.expr]) -> None:
        self.change = change
        self.count = 0

    def put(self, node: ast.expr, changed: ast.expr) -> ast.expr:
        place, self.count = self.count, self.count + 1
        return ast.copy_location(self.change(place, node, changed), node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Add | ast.Sub):
            return node
        return self.put(node, ast.BinOp(node.left, ast.Sub() if isinstance(node.op, ast.Add) else ast.Add(), node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        self.generic_visit(node)
        return self.put(node, node.operand) if isinstance(node.op, ast.USub) else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        node.value = self.visit(node.value)
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        for number, index in enumerate(indices):
            if isinstance(index, ast.Constant) and type(index.value) is int and isinstance(node.ctx, ast.Load):
                indices[number] = self.put(index, ast.Constant(index.value - 1 if index.value else 1))
        if not isinstance(node.slice, ast.Tuple):
            node.slice = indices[0]
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.body = [self.visit(statement) for statement in node.body]
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        node.value = node.value and self.visit(node.value)
        return node

    def visit_Assign(self, node: ast.Assign) -> ast.Assign:
        return node if any("printed" in ast.unparse(t).lower() for t in node.targets) else self.generic_visit(node)

    def visit_keyword(self, node: ast.keyword) -> ast.keyword:
        return node if node.arg in ("printed", "title", "reason", "tolerance") else self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.Call:
        return node if ast.unparse(node.func).startswith("printed.") else self.generic_visit(node)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.JoinedStr:
        return node


class Loader(importlib.machinery.SourceFileLoader):
    """Compiles the edited source, past every kept bytecode."""

    edit: Callable[[str, ast.Module], ast.Module]

    def get_code(self, fullname: str):
        tree = ast.parse(self.get_data(self.path), self.path)
        return compile(ast.fix_missing_locations(self.edit(fullname, tree)), self.path, "exec")


class Finder(importlib.abc.MetaPathFinder):
    def __init__(self, paper: str, edit: Callable[[str, ast.Module], ast.Module]) -> None:
        self.prefix, self.edit = f"{PAPERS}.{paper}", edit

    def find_spec(self, fullname, path=None, target=None):
        if fullname != self.prefix and not fullname.startswith(f"{self.prefix}."):
            return None
        spec = importlib.machinery.PathFinder.find_spec(fullname, path, target)
        if spec is not None and isinstance(spec.loader, importlib.machinery.SourceFileLoader):
            spec.loader = Loader(fullname, spec.loader.path)
            spec.loader.edit = self.edit
        return spec


@contextmanager
def edited(paper: str, edit: Callable[[str, ast.Module], ast.Module]) -> Iterator[list]:
    """The claims of a paper whose source was edited; the modules that were loaded before come back afterwards."""
    prefix = f"{PAPERS}.{paper}"
    before = {name: part for name, part in sys.modules.items() if f"{name}.".startswith(f"{prefix}.")}
    for name in before:
        del sys.modules[name]
    finder = Finder(paper, edit)
    sys.meta_path.insert(0, finder)
    try:
        yield claims_of(import_paper(paper))
    finally:
        sys.meta_path.remove(finder)
        for name in [name for name in sys.modules if f"{name}.".startswith(f"{prefix}.")]:
            del sys.modules[name]
        sys.modules.update(before)


def forget_values(paper: str) -> None:
    """Empty the caches of a paper, so that each claim runs through all that it names."""
    for wrapper in gc.get_objects():
        if type(wrapper) is functools._lru_cache_wrapper and str(wrapper.__module__).startswith(f"{PAPERS}.{paper}"):
            wrapper.cache_clear()


def is_model(fullname: str) -> bool:
    return ".experiment" not in fullname


@dataclass
class Watched:
    """Which claims name each place, the line of each place, and the hash of every statement."""

    names: dict[Place, list[str]] = field(default_factory=dict)
    lines: dict[Place, str] = field(default_factory=dict)
    hashes: dict[str, str] = field(default_factory=dict)


def watch(paper: str) -> Watched:
    """Import a paper with every place watched and state all of its claims."""
    seen = Watched()
    running: list[str] = ["import"]

    def at(module: str, number: int, value):
        if isinstance(value, Number | sp.Basic | sp.MatrixBase):
            claims = seen.names.setdefault((module, number), [])
            if running[0] not in claims:
                claims.append(running[0])
        return value

    def edit(fullname: str, tree: ast.Module) -> ast.Module:
        def note(number: int, node: ast.expr, changed: ast.expr) -> ast.expr:
            seen.lines[fullname, number] = f"{node.lineno}: {ast.unparse(node)} -> {ast.unparse(changed)}"[:160]
            return ast.Call(ast.Name(WATCH, ast.Load()), [ast.Constant(fullname), ast.Constant(number), node], [])

        return Places(note).visit(tree) if is_model(fullname) else tree

    setattr(builtins, WATCH, at)
    # the lines of nested places show the text before it is watched
    lines = {}

    def read(fullname: str, tree: ast.Module) -> ast.Module:
        if is_model(fullname):

            def keep(number: int, node: ast.expr, changed: ast.expr) -> ast.expr:
                lines[fullname, number] = f"{node.lineno}: {ast.unparse(node)} -> {ast.unparse(changed)}"
                return node

            Places(keep).visit(ast.parse(ast.unparse(tree)) and tree)
        return edit(fullname, tree)

    try:
        with edited(paper, read) as claims:
            for claim in claims:
                running[0] = claim.number
                forget_values(paper)
                seen.hashes[claim.number] = hash_statement(claim.derive(), None)
    finally:
        delattr(builtins, WATCH)
    seen.lines = lines
    return seen


@dataclass(frozen=True)
class Outcome:
    """What a planted fault did: claims that fell, that say something else now, and that noticed nothing."""

    place: Place
    line: str
    fell: tuple[str, ...]
    moved: tuple[str, ...]
    silent: tuple[str, ...]


def plant(paper: str, place: Place, seen: Watched, most: int = 5) -> Outcome:
    """Change one place, state the claims that name it, and decide those that changed until one falls."""

    def edit(fullname: str, tree: ast.Module) -> ast.Module:
        if fullname != place[0]:
            return tree
        return Places(lambda number, node, changed: changed if number == place[1] else node).visit(tree)

    names = seen.names[place]
    fell, moved, silent, held = [], [], [], []
    try:
        with edited(paper, edit) as claims:
            for claim in claims:
                if "import" not in names and claim.number not in names:
                    continue
                try:
                    statement = claim.derive()
                except Exception:  # the source of the claim refuses its own model: noticed
                    fell.append(claim.number)
                    continue
                if hash_statement(statement, None) == seen.hashes.get(claim.number):
                    silent.append(claim.number)
                else:
                    moved.append(claim.number)
                    held.append((claim, statement))
            held.sort(key=lambda pair: not isinstance(pair[1], Equation))
            for claim, statement in held[: 0 if fell else most]:
                try:
                    status = decide(statement).status
                except Exception:
                    status = None
                if status != claim.expect and not (claim.either and status is not None and status.holds):
                    fell.append(claim.number)
                    break
    except Exception:
        fell.append("import")
    return Outcome(place, seen.lines[place], tuple(fell), tuple(moved), tuple(silent))
