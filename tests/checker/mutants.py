"""Mutants of the checker: each change of one token has to be noticed by a certificate, or be explained.

``navsym campaign checker-mutants`` runs this file by pytest, one case for each mutant; run by itself it prints
the raw score, that is the share of all mutants that :func:`discrepancies` notices, and the survivors. A mutant that
runs out of its time or memory is noticed. ``survivors.txt`` explains the ones that live on, line by line.
"""

from __future__ import annotations

import ast
import gc
import os
import resource
import sys
from collections.abc import Iterator
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "navsym" / "checker.py"
EXPLAINED = Path(__file__).with_name("survivors.txt")
SECONDS, MEMORY = 8, 3 * 2**30
COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
REVERSED = {ast.Lt: ast.Gt, ast.LtE: ast.GtE, ast.Gt: ast.Lt, ast.GtE: ast.LtE}
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Add,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Add,
    ast.Pow: ast.Mult,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
    ast.LShift: ast.Mult,
    ast.RShift: ast.Mult,
}


def mutants(source: str) -> Iterator[tuple[str, int, int]]:
    """Name (change and line, numbered when there are several alike), place of the node, number of the change."""
    seen: dict[str, int] = {}
    tree, lines = ast.parse(source), source.splitlines()
    silent = set(map(id, silent_nodes(tree)))
    for place, node in enumerate(ast.walk(tree)):
        for number, what in enumerate(() if id(node) in silent else changes(node)):
            line = lines[node.lineno - 1].strip()
            key = f"{what} | {line}"
            seen[key] = seen.get(key, 0) + 1
            yield f"{key} | {seen[key]}", place, number


def silent_nodes(tree: ast.Module) -> Iterator[ast.AST]:
    """What no answer depends on: annotations, ``strict=`` and the words of reasons."""
    for node in ast.walk(tree):
        parts = [getattr(node, name, None) for name in ("annotation", "returns")]
        if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.keyword) and node.arg == "strict"):
            parts.append(node)
        for part in parts:
            if isinstance(part, ast.AST):
                yield from ast.walk(part)


def mutated(source: str, place: int, number: int) -> ast.Module:
    tree = ast.parse(source)
    apply(tree, list(ast.walk(tree))[place], number)
    return ast.fix_missing_locations(tree)


def changes(node: ast.AST) -> list[str]:
    """Names of the mutants of one node, in the order of :func:`apply`."""
    if isinstance(node, ast.Compare):
        names = [f"{type(op).__name__} to {COMPARISONS[type(op)].__name__}" for op in node.ops]
        return names + [f"{type(op).__name__} turned round" for op in node.ops if type(op) in REVERSED]
    if isinstance(node, ast.BinOp):
        return [f"{type(node.op).__name__} to {OPERATORS[type(node.op)].__name__}"]
    if isinstance(node, ast.BoolOp):
        return ["and to or" if isinstance(node.op, ast.And) else "or to and"]
    if isinstance(node, ast.UnaryOp):
        return [f"{type(node.op).__name__} dropped"]
    if isinstance(node, ast.IfExp):
        return ["branches exchanged"]
    if isinstance(node, ast.Constant) and type(node.value) in (int, bool):
        return [f"{node.value} changed"]
    if isinstance(node, ast.Expr) and not isinstance(node.value, ast.Constant):
        return ["check dropped" if ast.unparse(node).startswith("require(") else "statement dropped"]
    return ["statement dropped"] if isinstance(node, ast.AugAssign) else []


def apply(tree: ast.Module, node: ast.AST, number: int) -> None:
    """Make the mutant of this number at this node of the tree."""
    if isinstance(node, ast.Compare):
        round_about = [k for k, op in enumerate(node.ops) if type(op) in REVERSED]
        k = number if number < len(node.ops) else round_about[number - len(node.ops)]
        table = COMPARISONS if number < len(node.ops) else REVERSED
        node.ops[k] = table[type(node.ops[k])]()
    elif isinstance(node, ast.BinOp):
        node.op = OPERATORS[type(node.op)]()
    elif isinstance(node, ast.BoolOp):
        node.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
    elif isinstance(node, ast.IfExp):
        node.body, node.orelse = node.orelse, node.body
    elif isinstance(node, ast.Constant):
        node.value = (not node.value) if isinstance(node.value, bool) else node.value + 1
    else:
        replace(tree, node, node.operand if isinstance(node, ast.UnaryOp) else ast.Pass())


def replace(tree: ast.Module, old: ast.AST, new: ast.AST) -> None:
    for parent in ast.walk(tree):
        for field, value in ast.iter_fields(parent):
            if value is old:
                setattr(parent, field, new)
            elif isinstance(value, list) and any(item is old for item in value):
                value[[item is old for item in value].index(True)] = new


class Watched:
    """The checker, whose answers are kept with the lines that each question runs; a mutant is asked what runs its own.

    Its other names are those of the module.
    """

    def __init__(self, module: ModuleType):
        self.module, self.answers = module, dict[str, tuple[str, tuple[Any, ...], Any, str | None, frozenset[int]]]()
        self.changed: frozenset[int] | None = frozenset()  # lines that a mutant has otherwise; None for any
        self.check, self.grant = (partial(self.ask, name) for name in ("check", "grant"))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.module, name)

    def ask(self, name: str, *items: Any) -> Any:
        """What the module says, or said before the change."""
        key = f"{name}{items!r}"
        if key not in self.answers and self.changed == frozenset():
            self.answers[key] = (name, items, *self.watch(name, items))
        _, _, value, why, lines = self.answers.get(key, (name, items, None, None, frozenset()))
        if self.changed is None or key not in self.answers or self.changed & lines:
            return getattr(self.module, name)(*items)
        if why is not None:
            raise self.module.Refused(why)
        return value

    def compare(self) -> str:
        """Whether the module says ``otherwise`` than before, or the same for another ``reason``, or nothing new."""
        found = ""
        for name, items, value, why, lines in self.answers.values():
            if self.changed is not None and not self.changed & lines:
                continue
            try:
                said, new = getattr(self.module, name)(*items), None
            except self.module.Refused as refusal:
                said, new = None, str(refusal)
            if said != value:
                return "otherwise"
            found = found or "reason" * (new != why)
        return found

    def watch(self, name: str, items: tuple[Any, ...]) -> tuple[Any, str | None, frozenset[int]]:
        """Its value, or the reason of a refusal, and the lines that were run, with nothing remembered."""
        lines: set[int] = set()

        def trace(frame: Any, event: str, _: Any) -> Any:
            if frame.f_code.co_filename != "mutant":
                return None
            lines.add(frame.f_lineno)
            return trace

        for function in vars(self.module).values():
            getattr(function, "cache_clear", int)()
        sys.settrace(trace)
        try:
            return getattr(self.module, name)(*items), None, frozenset(lines)
        except self.module.Refused as refusal:
            return None, str(refusal), frozenset(lines)
        finally:
            sys.settrace(None)


@cache
def watched(source: str) -> tuple[Watched, list[ast.AST], list[Any]]:
    """The checker with what it says of all questions, the nodes of its source, and its statements, compiled."""
    from tests.checker.forgeries import discrepancies

    tree = ast.parse(source)
    checker = Watched(module_of(source))
    assert list(discrepancies(checker)) == []
    codes = [(s, compile(ast.Module([s], []), "mutant", "exec")) for s in tree.body]
    gc.freeze()
    return checker, [tree, *list(ast.walk(tree))[1:]], codes


def lines_of(tree: ast.Module, node: ast.AST) -> frozenset[int] | None:
    """The lines of the statement of a node, without the statements inside of it; None outside of functions."""
    found, inside, around = None, False, list[ast.AST](tree.body)
    while around:
        part = next(s for s in around if s.lineno <= node.lineno <= s.end_lineno)  # type: ignore[attr-defined]
        inside = inside or isinstance(part, ast.FunctionDef)
        found = part
        around = [s for name in ("body", "orelse", "finalbody", "handlers", "cases") for s in getattr(part, name, [])]
        around = [s for s in around if isinstance(s, (ast.stmt, ast.ExceptHandler))]
        around += [s for case in getattr(part, "cases", []) for s in case.body]
        last = min((s.lineno for s in around), default=part.end_lineno + 1) - 1  # type: ignore[attr-defined]
        if node.lineno <= last or not any(s.lineno <= node.lineno <= s.end_lineno for s in around):
            break
    if not inside or found is None or isinstance(found, (ast.FunctionDef, ast.ClassDef)):
        return None
    end = found.end_lineno if isinstance(found, ast.Match) else max(last, node.lineno)  # type: ignore[attr-defined]
    return frozenset(range(found.lineno, end + 1))  # type: ignore[attr-defined]


def noticed(source: str, place: int, number: int) -> bool:
    """True when the mutant answers one certificate otherwise; judged in a process of its own."""
    checker, nodes, codes = watched(source)
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 5))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        node, tree = nodes[place], nodes[0]
        checker.changed = lines_of(tree, node)
        own = next(k for k, (s, _) in enumerate(codes) if s.lineno <= node.lineno <= s.end_lineno)
        apply(tree, node, number)
        statement = ast.fix_missing_locations(tree.body[own])  # what is dropped may be the whole statement
        changed = compile(ast.Module([statement], []), "mutant", "exec")
        os._exit(judged(checker, [changed if k == own else code for k, (_, code) in enumerate(codes)]))
    return os.waitpid(child, 0)[1] != 0


def module_of(source: str | ast.Module) -> ModuleType:
    """The checker made of a changed source."""
    module = ModuleType("mutant")
    exec(compile(source, "mutant", "exec"), module.__dict__)
    return module


def judged(checker: Watched, codes: list[Any]) -> int:
    from tests.checker.forgeries import discrepancies, list_others

    try:
        module = checker.module = ModuleType("mutant")
        for code in codes:
            exec(code, module.__dict__)
        found = checker.compare()
        if found == "otherwise" or (not found and next(list_others(module), None) is not None):
            return 1
        return int(found != "" and next(discrepancies(checker), None) is not None)
    except BaseException:
        return 1


def explained() -> set[str]:
    """Names of the mutants that survive, each with its reason in the line below it."""
    lines = EXPLAINED.read_text(encoding="utf-8").splitlines()
    return {line for line in lines if line and not line.startswith(("#", "    "))}


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One case for each mutant, listed only where this file itself is run."""
    every = [pytest.param(*mutant, id=mutant[0]) for mutant in mutants(SOURCE.read_text(encoding="utf-8"))]
    metafunc.parametrize(("name", "place", "number"), every)


def test_a_mutant_is_noticed_or_explained(name, place, number):
    if noticed(SOURCE.read_text(encoding="utf-8"), place, number):
        return
    assert name in explained()
    pytest.skip("survives, see survivors.txt")


def chosen_of(every: list[tuple[str, int, int]], words: list[str]) -> list[tuple[str, int, int]]:
    """All mutants; every OF-th from PART; or those that a file names, line by line."""
    if len(words) == 2:
        return every[int(words[0]) :: int(words[1])]
    names = set(Path(words[0]).read_text(encoding="utf-8").splitlines()) if words else set()
    return [mutant for mutant in every if not words or mutant[0] in names]


def main() -> None:
    """``python tests/checker/mutants.py [PART OF | FILE]``: the score of all mutants, of a part, of those in a file."""
    import tests.checker.forgeries  # noqa: F401  once, before the children

    source = SOURCE.read_text(encoding="utf-8")
    chosen, alive = chosen_of(list(mutants(source)), sys.argv[1:]), 0
    for name, place, number in chosen:
        if not noticed(source, place, number):
            alive += 1
            print(name, flush=True)
    share = 100 * (1 - alive / max(1, len(chosen)))
    print(f"{len(chosen) - alive} of {len(chosen)} noticed: {share:.1f} %")


if __name__ == "__main__":
    main()
