"""One sign flipped or one index shifted in the source of a paper, and the claims that notice.

A place is a sum, a difference, a minus or a constant index in a file of ``derivations/``; printed sides, decorators,
experiments and programs for export have none. The paper is imported once with every place watched: a claim *names* the
places that its statement runs through. It is imported again with one of them changed, and the claims that name it are
stated and decided anew.
"""

from __future__ import annotations

import ast
import builtins
import copy
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

from navsym.claims import Claim, Equation, Statement, claims_of
from navsym.claims.claim import PAPERS
from navsym.claims.paper import import_paper
from navsym.core.errors import NavsymError
from navsym.prove.ladder import decide
from navsym.verification.sides import hash_statement

WATCH = "__watch_planted__"
#: A place: the module behind the package of the papers, and which of its places.
Place = tuple[str, int]


class Places(ast.NodeTransformer):
    """Visits every place of a file in a fixed order; ``change`` says what stands there instead."""

    def __init__(self, change: Callable[[int, ast.expr, ast.expr, str], ast.expr]) -> None:
        self.change = change
        self.count = 0

    def put(self, node: ast.expr, changed: ast.expr, words: str = "") -> ast.expr:
        place, self.count = self.count, self.count + 1
        return ast.copy_location(self.change(place, node, changed, words), node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Add | ast.Sub):
            return node
        opposite = ast.Sub() if isinstance(node.op, ast.Add) else ast.Add()
        return self.put(node, ast.BinOp(node.left, opposite, node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        self.generic_visit(node)
        return self.put(node, node.operand) if isinstance(node.op, ast.USub) else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        node.value = self.visit(node.value)
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        for number, index in enumerate(indices):
            if isinstance(index, ast.Constant) and type(index.value) is int and isinstance(node.ctx, ast.Load):
                changed = ast.Constant(index.value - 1 if index.value else 1)
                indices[number] = self.put(index, changed, f"{ast.unparse(node.value)}[{ast.unparse(node.slice)}]: ")
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
        name = ast.unparse(node.func)
        if name in ("Equation", "Bound", "Property", "fact") and node.args:  # the first argument is what is printed
            node.args[1:] = [self.visit(argument) for argument in node.args[1:]]
            node.keywords = [self.visit(keyword) for keyword in node.keywords]
            return node
        return node if name.startswith("printed.") else self.generic_visit(node)

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


def list_caches(paper: str) -> list:
    """The caches of a paper; emptied between claims, so that each claim runs through all that it names."""
    prefix = f"{PAPERS}.{paper}"
    wrappers = [one for one in gc.get_objects() if type(one) is functools._lru_cache_wrapper]
    return [one for one in wrappers if str(one.__module__).startswith(prefix)]


def is_model(fullname: str) -> bool:
    return not fullname.endswith(".programs") and ".experiment" not in fullname


@dataclass
class Watched:
    """Which claims name each place, the line of each place, and the hash of every statement."""

    names: dict[Place, dict[str, None]] = field(default_factory=dict)
    lines: dict[Place, str] = field(default_factory=dict)
    hashes: dict[str, str] = field(default_factory=dict)


def watch(paper: str) -> Watched:
    """Import a paper with every place watched and state all of its claims."""
    seen, running = Watched(), ["import"]

    def note(module: str, number: int, value):
        if isinstance(value, Number | sp.Basic | sp.MatrixBase):
            seen.names.setdefault((module, number), {})[running[0]] = None
        return value

    def edit(fullname: str, tree: ast.Module) -> ast.Module:
        def describe(number: int, node: ast.expr, changed: ast.expr, words: str) -> ast.expr:
            seen.lines[fullname, number] = f"{words}{ast.unparse(node)} -> {ast.unparse(changed)}"
            return node

        def surround(number: int, node: ast.expr, changed: ast.expr, words: str) -> ast.expr:
            return ast.Call(ast.Name(WATCH, ast.Load()), [ast.Constant(fullname), ast.Constant(number), node], [])

        if not is_model(fullname):
            return tree
        Places(describe).visit(copy.deepcopy(tree))
        return Places(surround).visit(tree)

    setattr(builtins, WATCH, note)
    try:
        with edited(paper, edit) as claims:
            caches = list_caches(paper)
            for claim in claims:
                running[0] = claim.number
                for cache in caches:
                    cache.cache_clear()
                seen.hashes[claim.number] = hash_statement(claim.derive(), None)
    finally:
        delattr(builtins, WATCH)
    return seen


@dataclass(frozen=True)
class Outcome:
    """What a planted fault did: a claim that fell, claims that say something else now, and that noticed nothing."""

    place: Place
    line: str
    fell: str
    moved: tuple[str, ...]
    silent: tuple[str, ...]


def plant(paper: str, place: Place, seen: Watched, most: int = 5) -> Outcome:
    """Change one place, state the claims that name it, and decide those that changed until one falls.

    A place that runs on import belongs to all claims: they are stated until one equation falls, which is quick.
    """

    def edit(fullname: str, tree: ast.Module) -> ast.Module:
        if fullname != place[0]:
            return tree
        return Places(lambda number, node, changed, _: changed if number == place[1] else node).visit(tree)

    names, silent, fell = seen.names[place], [], ""
    moved: dict[str, tuple[Claim, Statement | None]] = {}
    try:
        with edited(paper, edit) as claims:
            for claim in claims:
                if not fell and ("import" in names or claim.number in names):
                    statement = state(claim)
                    if statement is None or hash_statement(statement, None) != seen.hashes.get(claim.number):
                        moved[claim.number] = claim, statement
                        early = "import" in names and len(moved) <= most and isinstance(statement, Equation | None)
                        fell = claim.number if early and falls(claim, statement) else ""
                    else:
                        silent.append(claim.number)
            # an equation falls at a point, the quickest
            tried = sorted(moved.values(), key=lambda pair: not isinstance(pair[1], Equation | None))[:most]
            fell = fell or next((claim.number for claim, statement in tried if falls(claim, statement)), "")
    except (NavsymError, ValueError, ArithmeticError, LookupError, TypeError, AttributeError):
        return Outcome(place, seen.lines[place], "the whole paper", (), ())  # it cannot even be imported
    return Outcome(place, seen.lines[place], fell, tuple(moved), tuple(silent))


def state(claim: Claim) -> Statement | None:
    """The statement of a claim; None where its own source refuses the changed model."""
    try:
        return claim.derive()
    except Exception:
        return None


def falls(claim: Claim, statement: Statement | None) -> bool:
    """Whether the changed statement is refused, or decided in another way than the claim declares."""
    try:
        return statement is None or decide(statement).status != claim.expect
    except NavsymError:
        return True
