"""What a title may say: its numbers, ranges, quantifiers and strong words are found in what was decided.

A title is in the letters of its paper, a statement in those of the source. So symbols are compared where a title
quantifies them or names their range. A rule lists claims; those that a person has answered stand in ``answered``.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import FunctionType

import sympy as sp

from navsym.claims import Claim
from navsym.claims.claim import PAPERS
from navsym.claims.record import Record
from navsym.core.errors import NavsymError
from navsym.language.expression import parse

NUMERAL = r"\d+(?:\.\d+)?(?:e-?\d+)?"
#: A number of a title: neither an index, a power, nor a part of a name.
IN_TITLE = re.compile(rf"(?<![\w.^_]){NUMERAL}(?!\w|\.\w|\*\*)")
FIGURE = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.]*[a-z])")
#: What names a claim or an equation instead of a number.
REFERENCE = re.compile(
    r"\(\d[\d.]*\*?\)(?!\^)|\[\d+\]|\b\d+\.\d[\w.]*\.[a-z][\w-]*|\b(?:\d+\.|[a-z]+\.)[a-zA-Z][\w.*-]*"
    r"|(?<=: )\d\.\d+(?=\))|^\d\.\d\b|(?<=remark )\d\.\d"
)
#: A number may stand in other units: powers of ten, minutes, per cent more or less, halves and doubles of a digit.
UNITS = (
    [Fraction(10) ** k for k in range(-9, 10)]
    + [Fraction(n) for n in (2, 60, 3600)]
    + [Fraction(1, 2), Fraction(1, 60)]
)
RANGE = re.compile(r"(\w+) in ([\[(])([^,\[\]]+), ([^\[\]]+?)[\])]")
RELATION = re.compile(r"(?<![\w|.)])([A-Za-z]\w*) (<=|<|>=|>) ((?:\d+ ?\*? ?)?(?:pi)?(?:/\d+)?)(?![\w(])")
QUANTIFIED = re.compile(
    r"\b(?:every|any|whatever|each|all) ([a-zA-Z]|[a-z]+_\w+|alpha|beta|kappa|lambda|mu|sigma|tau)\b"
)
#: Strong words, and what shows them at sight: an inequality, a root that is none, yes or no, or a dual beside a primal.
STRONG = {
    "at most": r"\b(at most|at least|no more than|never|less than|more than|exceeds?|no better|beats?)\b",
    "optimal": r"\b((?:is|are) optimal|optimal (?:among|up to|for)|deviates least|minimum|minimal|least|best)\b",
    "unique": r"\b(unique|uniquely|one solution|one contact|the only)\b",
    "exactly": r"\b(if and only if|exactly when|only (?:when|where|if)|just when|sufficient|suffices|necessary)\b",
}
SHOWN = re.compile(r"[<>]|!=|\bTrue\b|\bFalse\b|^dual = |\+- ")


def numbers_of(text: str) -> set[Fraction]:
    """Numbers of a text, fractions whole and in parts; none of an address in memory."""
    found = re.findall(rf"{NUMERAL}(?:/\d+)?", re.sub(r"0x[0-9a-f]+", "", text))
    return {abs(Fraction(part)) for one in found for part in (one, *one.split("/")) if not part.endswith("/0")}


@cache
def read_file(path: str, _changed: int) -> ast.Module:
    return ast.parse(Path(path).read_text(encoding="utf-8"))


@cache
def read_function(function: FunctionType) -> ast.Module:
    return ast.parse(textwrap.dedent(inspect.getsource(function)))


def body_of(claim: Claim) -> list[ast.AST]:
    """The statements of the function that states a claim, without its docstring."""
    derive = inspect.unwrap(claim.derive)
    first = derive.__code__.co_firstlineno
    path = derive.__code__.co_filename
    tree = read_file(path, Path(path).stat().st_mtime_ns)
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.Lambda)]
    starts = [min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", []))]) for node in nodes]
    node = next(node for node, start in zip(nodes, starts, strict=True) if start == first)
    body = node.body if isinstance(node.body, list) else [node.body]
    return body[1:] if isinstance(node, ast.FunctionDef) and ast.get_docstring(node) else body


def named_in(body: list[ast.AST], scope: dict[str, object]) -> Iterator[tuple[str, object]]:
    """What a piece of source names of its file, and of the files that it names."""
    for node in (node for part in body for node in ast.walk(part)):
        if isinstance(node, ast.Name) and node.id in scope:
            yield node.id, scope[node.id]
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            yield node.attr, getattr(scope.get(node.value.id), node.attr, None)


def named_by(claim: Claim) -> Iterator[tuple[str, object, bool]]:
    """What the source of a claim names, with its value and whether its own source does; then what it calls names."""
    derive = inspect.unwrap(claim.derive)
    waiting, seen = [(body_of(claim), derive.__globals__, True)], set()
    while waiting:
        body, scope, is_own = waiting.pop()
        for name, value in named_in(body, scope):
            yield name, value, is_own
            if isinstance(value, FunctionType) and value.__module__.startswith(f"{PAPERS}.") and value not in seen:
                seen.add(value)
                waiting.append(([read_function(value)], value.__globals__, False))


def source_texts(claim: Claim) -> Iterator[str]:
    """The source of a claim without its docstring, what it closes over, and constants of what it calls."""
    derive = inspect.unwrap(claim.derive)
    yield from (ast.unparse(part) for part in body_of(claim))
    yield from (
        str(value) for value in (*(c.cell_contents for c in derive.__closure__ or ()), *(derive.__defaults__ or ()))
    )
    for name, value, is_own in named_by(claim):
        is_text = isinstance(value, int | str | Fraction | sp.Basic | tuple | list | dict)
        if is_text and (is_own or name.isupper()):
            yield str(value)


def values_of(record: Record) -> Iterator[Fraction]:
    """The values of the sides and of their entries, where these are numbers."""
    sides = [*re.split(r" (?:<=|>=|!=|<|>) ", record.printed.partition(" +- ")[0]), record.derived]
    for text in (part for side in sides for part in [side, *re.split(r", ", side.strip("()[]"))]):
        try:
            yield abs(Fraction(str(sp.N(parse(text, {}), 20))))
        except (NavsymError, ValueError, TypeError):
            continue


def counts_of(side: str) -> set[Fraction]:
    """How many entries a side has, each list of it, and how many rows: numbers that a title may say."""
    return {Fraction(part.count(",") + 1) for part in (side, *re.findall(r"\(([^()]*)\)", side))} | {
        Fraction(side.count("], [") + 1)
    }


def is_said(numeral: str, exact: set[Fraction], values: list[Fraction]) -> bool:
    """Whether a number is a number of the statement in some unit, or a value of it within half of its last digit."""
    x = Fraction(numeral)
    digits = Fraction(10) ** (int(numeral.partition("e")[2] or 0) - len(numeral.partition("e")[0].partition(".")[2]))
    near = [x, x / 100, 1 + x / 100]
    return any(y in exact or y * unit in exact for y in near for unit in UNITS) or any(
        abs(value * unit - x) <= digits / 2 for value in values for unit in (*UNITS, Fraction(100))
    )


def numbers_of_no_statement(judged) -> list[str]:
    """A number of a title is in the statement, its scope, its evidence or its source, or it is a value of a side."""
    wrong = []
    for claim, r in zip(judged.claims, judged.records, strict=True):
        title = REFERENCE.sub(" ", r.title)
        texts = [r.printed, r.derived, r.scope, r.evidence, *r.assumptions, *(r.counterexample or {}).values()]
        exact = set().union(*map(numbers_of, [*texts, *source_texts(claim)]))
        exact |= {Fraction(0), Fraction(1), *counts_of(r.printed), *counts_of(r.derived)}
        if not all(is_said(one, exact, [*values_of(r)]) for one in IN_TITLE.findall(title)):
            wrong.append(r.id)
    return wrong


def end_of(text: str) -> sp.Expr:
    """An end of a range, as titles and scopes write it: 4 pi/3, 3*pi/2, oo."""
    return sp.oo if text == "oo" else -sp.oo if text == "-oo" else parse(re.sub(r"(\d) (?=pi)", r"\1*", text), {})


def ends_of_ranges_in_no_title(judged) -> list[str]:
    """What was decided between two numbers only says in its title how far: each end but 0, 1 and -1 stands there."""
    wrong = []
    for r in (r for r in judged.records if r.status.holds):
        pairs = [(low, high) for _, _, low, high in RANGE.findall(r.scope) if "oo" not in low + high]
        ends = {abs(end_of(end)) for pair in pairs for end in pair} - {0, 1}
        wrong += [] if {Fraction(str(end)) for end in ends if end.is_Rational} <= numbers_of(r.title) else [r.id]
    return wrong


def ranges_narrower_than_the_title(judged) -> list[str]:
    """What a title says of T <= c, or of every T, was decided for all of these."""
    wrong = []
    for r in (r for r in judged.records if r.status.holds):
        scope = {name: (low, high) for name, _, low, high in RANGE.findall(r.scope)}
        related = [(name, sign, end) for name, sign, end in RELATION.findall(r.title) if end and name in scope]
        for name, sign, end in related:
            low, high = map(end_of, scope[name])
            if (high if "<" in sign else -low) < (end_of(end) if "<" in sign else -end_of(end)):
                wrong.append(r.id)
        for name in QUANTIFIED.findall(r.title):
            is_wide = (
                re.search(rf"real {name}\b|all {name}\b(?! in)|\b{name} =", r.scope)
                or scope.get(name, ("", ""))[1] == "oo"
            )
            if not (is_wide or re.search(rf"\b{name} (?:in|from|to|of|>|>=|!=)|\b{name}\^2 !=", r.title)):
                wrong.append(r.id)
    return [*dict.fromkeys(wrong)]


def sizes_in_no_scope(judged) -> list[str]:
    """What a claim runs through, sizes or indices that its title names, stands in the title or the scope with its end.

    A size counts from zero or from one.
    """
    wrong = []
    for claim, r in zip(judged.claims, judged.records, strict=True):
        said = numbers_of(f"{r.scope} {REFERENCE.sub(' ', r.title)}")
        loops = [n for part in body_of(claim) for n in ast.walk(part) if isinstance(n, ast.For | ast.comprehension)]
        local = {
            target.id: node.value
            for part in body_of(claim)
            for node in ast.walk(part)
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        for loop in loops:
            iterated = local.get(loop.iter.id, loop.iter) if isinstance(loop.iter, ast.Name) else loop.iter
            ends = ends_of(iterated, inspect.unwrap(claim.derive).__globals__)
            names = {n.id for n in ast.walk(loop.target) if isinstance(n, ast.Name)}
            is_named = any(re.search(rf"(?<![\w'.]){name}(?![\w'])", r.title) for name in names)
            if ends and (ends[0] or is_named) and not {Fraction(abs(ends[1])), Fraction(abs(ends[1]) + 1)} & said:
                wrong.append(r.id)
    return [*dict.fromkeys(wrong)]


def ends_of(iterated: ast.expr, scope: dict[str, object]) -> tuple[int, int] | None:
    """First and last of the whole numbers that a loop runs through, where its source says them."""
    try:
        numbers = eval(ast.unparse(iterated), scope)  # our own source
    except (NameError, AttributeError, TypeError):
        return None
    is_run = isinstance(numbers, range | tuple) and len(numbers) > 1 and all(type(one) is int for one in numbers)
    return (numbers[0], numbers[-1]) if is_run and [*numbers] == [*range(numbers[0], numbers[-1] + 1)] else None


def words_that_nothing_shows(judged) -> list[str]:
    """A strong word rests on an inequality, a dual, yes or no; an identity that shows it is answered for."""
    held = [r for r in judged.records if r.status.holds and not SHOWN.search(r.printed)]
    return [r.id for r in held if any(re.search(word, r.title, re.IGNORECASE) for word in STRONG.values())]


def numbers_under_a_general_title(judged) -> list[str]:
    """What was decided at numbers only, and says so nowhere, has a number in its title."""
    held = [r for r in judged.records if r.status.holds and r.scope in ("", "numbers")]
    return [r.id for r in held if not IN_TITLE.search(REFERENCE.sub(" ", r.title))]
