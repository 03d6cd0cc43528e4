"""Formulas of a caller, decided: text, sympy expressions or a claim file go in, verdicts come out."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, overload

from navsym.claims import Bound, Equation, Statement, Verdict, Verdicts
from navsym.claims.formula import names_of, side_text
from navsym.core.errors import DomainError, ExpressionSyntaxError, UnknownSymbolError
from navsym.core.sandbox import require_jobs, require_limits
from navsym.language.files import name_file
from navsym.language.names import RESERVED, list_calls, quote, require_table, suggest_nearest
from navsym.language.tomlfile import parse_toml, read_toml

if TYPE_CHECKING:
    from navsym.prove.claimfile import ClaimFile

SECONDS = 20.0
#: The end of a sum that is a name, beside a whole number.
END = re.compile(r"\s*(?:\d+\s*\*\s*)?([A-Za-z]\w*)\s*(?:[+-]\s*\d+\s*)?", re.ASCII)
RELATION = re.compile(r"!=|<=|>=|==|=<|=>|<>|~=|[=<>]|[\u2260\u2264\u2265]")

#: Called after each claim of a file with its verdict and the number of claims.
Progress = Callable[[Verdict, int], None]


@overload
def prove(
    statement: os.PathLike[str], /, *, seconds: float = ..., jobs: int = ..., progress: Progress | None = ...
) -> Verdicts: ...


@overload
def prove(
    statement: Any,
    relation: str | None = ...,
    right: Any = ...,
    /,
    *,
    box: Mapping[str, Any] | None = ...,
    tolerance: Any = ...,
    exists: Any = ...,
    given: Any = ...,
    rates: Mapping[str, Any] | None = ...,
    order: Mapping[str, int] | None = ...,
    seconds: float = ...,
    **symbols: Any,
) -> Verdict: ...


def prove(
    statement: Any,
    relation: str | None = None,
    right: Any = None,
    /,
    *,
    box: Mapping[str, Any] | None = None,
    tolerance: Any = None,
    exists: Any = (),
    given: Any = (),
    rates: Mapping[str, Any] | None = None,
    order: Mapping[str, int] | None = None,
    seconds: float = SECONDS,
    jobs: int = 1,
    progress: Progress | None = None,
    **symbols: Any,
) -> Verdict | Verdicts:
    """Verdict of a formula, or the verdicts of a claim file.

    statement : a formula as text, ``"sin(2*a) = 2*sin(a)*cos(a)"``, a chain of them, ``"a <= b = c"``, or in LaTeX
                (with a backslash); or its left side, followed by ``relation`` and ``right``; or the path or text of a
                claim file (TOML). A side is text, an exact number, a sympy expression, or rows or a matrix of these.
    relation  : one of ``= != < <= > >=``
    symbols   : declarations: ``T=("0", "2*pi")`` for a closed range, ``"real"``, ``"positive"``, ``"nonnegative"``,
                ``"nonzero"``, or a table such as ``u={"vector": 3}``; without one real, or as sympy assumes, and where
                it ends a sum or a product a whole number from 1
    box       : name -> range, inside the declaration of that symbol
    tolerance : of a printed numeral, half a unit of its last digit: ``|left - right| <= tolerance``
    exists    : expression, or list of them, that must have a value: points where one has none do not count
    given     : hypothesis, or list of them, each a relation: ``"dot(u, u) = 1"``
    rates     : name -> derivative by time, for ``dot_(x)``
    order     : name -> whole number: ``{"eps": 2}`` for equality up to terms of order eps**2
    seconds   : limit for one formula, seconds of processor time; above it the verdict is OPEN
    jobs, progress : claims of a file decided at the same time; called with each verdict and their number

    The formula is written down and read again in the language of files, so that nothing but that language is decided:
    first an exact point is sought where it fails, then a proof by exact algebra or balls. Angles are radians.

    Returns a :class:`Verdict`, or :class:`Verdicts` for a file, in the order of the file. Raises NavsymError for what
    is no formula: kinds ``syntax``, ``unknown-symbol``, ``domain`` (a float, a side without a value), ``shape``.

    >>> import navsym as nav
    >>> nav.prove("sin(2*a) = 2*sin(a)*cos(a)")
    <PROVED: sin(2*a) = 2*sin(a)*cos(a); normal form; all real a>
    >>> nav.prove("cross(u, cross(v, u)) = v - u*dot(u, v)", given="dot(u, u) = 1", u={"vector": 3}, v={"vector": 3})
    <PROVED: cross(u, cross(v, u)) = v - u*dot(u, v); proof tree; all u in R^3, v in R^3 with dot(u, u) = 1>
    >>> nav.prove("inv(A @ B) = inv(B) @ inv(A)", A={"matrix": ["n", "n"]}, B={"matrix": ["n", "n"]}).assumptions
    ('A @ B invertible', 'B invertible', 'A invertible')
    >>> nav.prove(0.5, "=", "1/2")
    Traceback (most recent call last):
    navsym.core.errors.DomainError: prove: left: expected an exact number; got the float 0.5; write "1/2" ...
    """
    beside = dict(tolerance=tolerance, exists=exists, given=given) | read_options(box, rates, order, seconds, jobs)
    if relation is None and is_file(statement):
        refuse_declarations(symbols or {name: value for name, value in beside.items() if value not in (None, {}, ())})
        return prove_file(statement, seconds, jobs, progress)
    sides = split_formula(statement, relation, right, symbols)
    from navsym.prove.claimfile import decide_claims

    return decide_claims(read_formula(sides, symbols, beside), seconds=seconds)[0]


def prove_file(source: str | os.PathLike[str], seconds: float, jobs: int, progress: Progress | None) -> Verdicts:
    """The verdicts of a claim file, or of its text."""
    is_text = is_claim_text(source)
    document = parse_toml(str(source), "prove") if is_text else read_toml(source)  # before the slow import of algebra
    from navsym.prove.claimfile import claims_from, decide_claims

    claims = claims_from(document, "prove" if is_text else name_file(source), go_on=True)
    return decide_claims(claims, jobs=jobs, seconds=seconds, progress=progress)


def state_formula(
    statement: Any,
    relation: str | None = None,
    right: Any = None,
    /,
    *,
    box: Mapping[str, Any] | None = None,
    tolerance: Any = None,
    exists: Any = (),
    given: Any = (),
    rates: Mapping[str, Any] | None = None,
    order: Mapping[str, int] | None = None,
    **symbols: Any,
) -> Statement:
    """The statement of a claim in a derivation module, with the arguments of :func:`prove`.

    Of two sides with a relation the left one is what is printed, of a whole formula all of it. What has vectors,
    hypotheses, cases or conditions of its text is decided when the claim is stated, and the statement says whether it
    holds. Raises NavsymError as prove does.

    >>> state_formula("sin(a) <= a", a=("0", "pi")).relation
    '<='
    >>> state_formula("norm(R @ u) = norm(u)", u={"vector": 3}, R={"rotation": "b to n"}).derived.value
    True
    """
    from navsym.prove.claimfile import FileClaim, property_of_claim, statement_of, text_conditions

    beside = dict(tolerance=tolerance, exists=exists, given=given) | read_options(box, rates, order, SECONDS, 1)
    (claim,) = read_formula(split_formula(statement, relation, right, symbols), symbols, beside).claims
    if not isinstance(claim, FileClaim) or text_conditions(claim):
        return replace(property_of_claim(claim), is_whole=relation is None)
    found = statement_of(claim)
    if relation is None and isinstance(found, Equation) and tolerance is None:  # the formula is what is printed
        return Bound(found.printed, "=", found.derived, found.box, found.exists, found.written)
    return found


@dataclass(frozen=True, slots=True)
class Sides:
    """What a caller says: two sides in any accepted form, and the relation between them; or the text of a chain.

    order : name and order of an ``O(x^k)`` that stands behind the right side
    """

    left: Any
    relation: str
    right: Any
    chain: str = ""
    order: tuple[str, int] | None = None


def choose_order(printed: tuple[str, int] | None, order: Mapping[str, int] | None) -> Mapping[str, int] | None:
    """The order that stands in the formula, or beside it."""
    if printed is None:
        return order
    if order:
        message = "expected one order; got O(...) in the formula and order= beside it; remove one of them"
        raise DomainError(message, where="prove: order")
    return dict([printed])


def read_formula(sides: Sides, given: Mapping[str, Any], beside: Mapping[str, Any]) -> ClaimFile:
    """One formula as a claim file, with the box, tolerance and existing expressions beside it."""
    from navsym.language.values import (
        declared_unit,
        merge_declarations,
        read_assumptions,
        write_declaration,
        write_entries,
        write_value,
    )
    from navsym.prove.claimfile import ClaimFile, Symbols, read_claim

    left, right, order = sides.chain, "", choose_order(sides.order, beside["order"])
    if not sides.chain:
        left, right = write_entries(sides.left, "prove: left"), write_entries(sides.right, "prove: right")
    existing = beside["exists"] if isinstance(beside["exists"], (list, tuple)) else [beside["exists"]]
    exists = write_entries(list(existing), "prove: exists")
    hypotheses = list(beside["given"]) if isinstance(beside["given"], (list, tuple)) else [beside["given"]]
    slopes = {name: write_entries(rate, f"prove: rates.{name}") for name, rate in dict(beside["rates"]).items()}
    texts = (left, right, exists, *map(str, hypotheses), *slopes.values())
    dimensions = {side for value in given.values() for side in list_dimensions(value)} - given.keys()
    moments = [text for value in given.values() for text in list_moments(value)]
    known = dict(given) | dict.fromkeys(order or ())
    words: dict[str, Any] = dict.fromkeys(
        sorted((symbols_in((*texts, *moments), known) - dimensions) | slopes.keys()), "real"
    )
    ends = {name for text in texts for name in list_ends(side_text(text))} & words.keys() - given.keys()
    assumed = read_assumptions((sides.left, sides.right, *existing), "prove")
    words |= {name: {"integer": ["1", "oo"]} for name in ends}
    words |= {name: word for name, word in assumed.items() if word != "real" or name not in ends}
    declared = {name: write_declaration(value, f"prove: {name}") for name, value in given.items()}
    for name in declared.keys() - words.keys():
        message = (
            f"expected a symbol of the formula; got {quote(name)}; remove or correct it: {suggest_nearest(name, words)}"
        )
        raise UnknownSymbolError(message, where=f"prove: {name}")
    table, narrowed = merge_declarations(words, declared, "prove")
    narrowed |= {
        name: write_declaration(ends, f"prove: box.{name}", declared_unit(name, declared))
        for name, ends in beside["box"].items()
    }
    block: dict[str, Any] = {"id": "formula", "box": narrowed}
    block |= {"chain": left} if sides.chain else {"left": left, "relation": sides.relation, "right": right}
    block |= {"exists": exists} if exists else {}
    block |= {"given": hypotheses} if hypotheses else {}
    block |= {"order": order} if order else {}
    if beside["tolerance"] is not None:
        block["tolerance"] = write_value(beside["tolerance"], "prove: tolerance")
    symbols = Symbols.read(table, "prove", slopes)
    return ClaimFile(symbols.parameters, (read_claim(block, symbols, "prove"),))


def list_ends(text: str) -> Iterator[str]:
    """The names that end sums and products, as ``n`` and ``n - 1``: they count, and without a declaration from 1."""
    for pieces in list_calls(text, "sum|product"):
        yield from (end[1] for end in map(END.fullmatch, pieces[2:4]) if end)


def list_dimensions(value: Any) -> list[str]:
    """The names of dimensions in a declaration such as ``{"matrix": ["n", "n"]}``."""
    sizes = (value.get("matrix"), value.get("vector")) if isinstance(value, Mapping) else ()
    sides = [side for size in sizes for side in (size if isinstance(size, (list, tuple)) else [size])]
    return [side for side in sides if isinstance(side, str)]


def list_moments(value: Any) -> list[str]:
    """The texts of mean and covariance in a declaration such as ``{"random": {"mean": "0", "cov": "s"}}``."""
    table = value.get("random") if isinstance(value, Mapping) else None
    return [str(table[key]) for key in ("mean", "cov") if key in table] if isinstance(table, Mapping) else []


def read_options(box: Any, rates: Any, order: Any, seconds: Any, jobs: Any) -> dict[str, Any]:
    """The tables beside a formula; refuses what is no mapping, and limits that are no numbers."""
    require_limits(seconds, where="prove: seconds")
    require_jobs(jobs, "prove: jobs")
    tables = {"box": box, "rates": rates, "order": order}
    return {key: require_table(table, f"prove: {key}") for key, table in tables.items()}


def is_claim_text(statement: Any) -> bool:
    """True for the text of a claim file."""
    return isinstance(statement, str) and "[[claim]]" in statement


def is_file(statement: Any) -> bool:
    """True for a path, for text that ends like a claim file, and for the text of one."""
    is_path = isinstance(statement, os.PathLike) or (isinstance(statement, str) and statement.endswith(".toml"))
    return is_path or is_claim_text(statement)


def refuse_declarations(names: Mapping[str, Any]) -> None:
    """Refuse declarations beside a claim file, which has its own."""
    if names:
        message = f"expected declarations in the file; got {', '.join(names)} beside it; write them below [symbols]"
        raise DomainError(message, where="prove")


def split_formula(statement: Any, relation: str | None, right: Any, given: Mapping[str, Any]) -> Sides:
    """The two sides as given, or of a text at its one relation; a text with a backslash is LaTeX."""
    if relation is not None:
        return Sides(read_latex_side(statement, given), relation, read_latex_side(right, given))
    if isinstance(statement, str) and "\\" in statement:
        return read_latex(statement, given)
    if not isinstance(statement, str):
        expected = "a formula as text, or two sides with their relation between them"
        message = f'expected {expected}; got {quote(statement)}; write prove(left, "=", right)'
        raise ExpressionSyntaxError(message, where="prove: statement")
    fronts = [(mark, statement[: mark.start()].count) for mark in RELATION.finditer(statement)]
    marks = [mark for mark, count in fronts if sum(map(count, "([")) <= sum(map(count, ")]"))]  # outside brackets
    if not marks:
        message = f"expected a relation = != < <= > >= or a file.toml; got {quote(statement)}; write both sides"
        raise ExpressionSyntaxError(message, where="prove: statement")
    if len(marks) > 1:
        return Sides("", "", "", statement)
    (mark,) = marks
    return Sides(statement[: mark.start()].strip(), mark[0], statement[mark.end() :].strip())


def read_latex_side(side: Any, given: Mapping[str, Any]) -> Any:
    """A side in LaTeX as text of the language of files; any other side as it is."""
    is_latex = isinstance(side, str) and "\\" in side
    return read_latex(f"{side} = 0", given).left if is_latex else side


def read_latex(statement: str, given: Mapping[str, Any]) -> Sides:
    """The two sides of a formula in LaTeX; a letter without a declaration is real."""
    from navsym.language.latex.reading import read_with_reals

    reading = read_with_reals(statement, given)
    refused = next((formula for formula in reading.formulas if formula.status != "READ"), None)
    if refused is not None:
        raise ExpressionSyntaxError(str(refused.why).partition(": ")[2], where=f"prove: statement, line {refused.line}")
    first, *others = reading.formulas
    if not others:
        return Sides(first.left, str(first.relation), first.right, order=first.order)
    linked = all(one.right == other.left for one, other in itertools.pairwise(reading.formulas))
    if not linked or any(one.order for one in reading.formulas):
        count = len(reading.formulas)
        message = f"expected one formula or a chain of them; got {count} in {quote(statement)}; prove them one by one"
        raise ExpressionSyntaxError(message, where="prove: statement")
    links = [f"{formula.relation} {formula.right}" for formula in reading.formulas]
    return Sides("", "", "", f"{first.left} {' '.join(links)}")


def symbols_in(sides: Iterable[Any], given: Mapping[str, Any]) -> set[str]:
    """Names in texts that are symbols: no function, and not a function or number of another language.

    ``e`` and ``ln`` count where the caller declares them; the reader says of the others what to write instead.
    """
    from navsym.language.advice import FOREIGN
    from navsym.language.vectors import BINDERS, INFINITE, TAKES

    called = {name for side in sides for name in re.findall(r"([A-Za-z]\w*)\s*\(", side_text(side))}
    functions = called & {*TAKES, *BINDERS} | ({INFINITE} if called & set(BINDERS) else set())
    return set().union(*map(names_of, sides)) - RESERVED - ((FOREIGN.keys() | functions) - given.keys())
