"""The file of ``navsym prove``: symbols with their ranges, and claims with two sides each."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import sympy as sp

from navsym.claims import OPEN, PROVED, REFUTED, Bound, Equation, Finding, Statement, Status, Verdict, Verdicts
from navsym.claims.formula import Formula, Side, names_of
from navsym.claims.statement import Worded, Written
from navsym.core.choice import one_of
from navsym.core.errors import DomainError, EmptyError, NavsymError, ShapeError, TooLargeError
from navsym.core.sandbox import Exhausted, Failed, run_many
from navsym.language.arithmetic import sign_of_constant
from navsym.language.declarations import Parameter, box_of, read_parameters, read_range, require_positive, symbols_of
from navsym.language.expression import ZERO, Expr, Matrix, Parsed, Symbol, parse
from navsym.language.files import name_file
from navsym.language.names import quote
from navsym.language.schema import (
    Table,
    as_label,
    as_list,
    as_table,
    as_text,
    as_title,
    expect_keys,
    join_place,
    read_entry,
    read_entry_noting,
    require_distinct,
    require_key,
)
from navsym.language.shapes import Shape
from navsym.language.tomlfile import read_toml
from navsym.language.vectors import read_value
from navsym.prove.assumptions import is_nonnegative, is_nonzero, is_positive
from navsym.prove.calculus.answers import read_with_answers
from navsym.prove.grant import write_statements
from navsym.prove.ladder import decide
from navsym.prove.relations.judge import TROUBLE, TextClaim, decide_text
from navsym.prove.relations.reading import is_text_claim, limit_scalar, read_relation, read_shapes, read_text_claim
from navsym.prove.rooms.goals import player, write_term
from navsym.prove.sampling.points import ranges_of, write_range
from navsym.prove.wording import expression_text, scope_of

CLAIMS = 2_000

Box = dict[Symbol, tuple[Expr, Expr]]


@dataclass(frozen=True, slots=True, eq=False)
class Symbols:
    """The declarations of a file, as they are written and as they are read."""

    written: Table
    parameters: Mapping[str, Parameter]
    shapes: Mapping[str, Shape]
    rates: Table

    @classmethod
    def read(cls, table: Any, where: str, rates: Any = None) -> Symbols:
        """The declarations of a ``[symbols]`` table, and of ``[rates]``."""
        whole = {name: widen_range(value) for name, value in as_table(table, where).items()}
        scalars = {name: value for name, value in whole.items() if not isinstance(value, dict)}
        slopes = as_table({} if rates is None else rates, where)
        parameters = read_parameters(scalars, where)
        return cls(whole, parameters, read_shapes(whole, slopes, where), slopes)

    def formula(self, block: Table) -> Formula:
        """A claim as it is written, with the declarations of the names in it."""
        sides = [side_as_written(block.get(side, "")) for side in ("left", "right")]
        box, exists, given = block.get("box", {}), tuple(map(str, block.get("exists", ()))), block.get("given", ())
        chain, names = block.get("chain"), set(box)
        names = names.union(*map(names_of, (*sides, *exists, *map(str, given), *([chain] if chain else []))))
        is_derived = any({"diff", "dot_"} & names_of(side) for side in (*sides, chain or ""))
        rates = {name: text for name, text in self.rates.items() if is_derived}
        order = block.get("order", {})
        names = names.union(rates, order, *map(names_of, rates.values()))
        symbols = {name: value for name, value in self.written.items() if name in names}
        tolerance = None if "tolerance" not in block else str(block["tolerance"])
        relation, more = block.get("relation", "="), (tuple(given), chain, rates, dict(order))
        return Formula(sides[0], relation, sides[1], symbols, box, block["id"], tolerance, exists, *more)

    def limit(self, name: str, ends: Any, place: str) -> list[Any]:
        """A claim's own range of a name in the words of the checker."""
        if name not in self.parameters:
            return limit_scalar(name, ends, self.shapes[name], place)
        box = box_of(self.parameters) | read_box({name: ends}, self.parameters, place.rpartition(".")[0])
        own = self.parameters[name].symbol
        return write_range(ranges_of([own], box)[own])


def widen_range(value: Any) -> Any:
    """A range up to infinity as a word, or as a table."""
    if not isinstance(value, (list, tuple)) or not {"oo", "-oo"} & {str(end) for end in value}:
        return value
    word = {"0 oo": "nonnegative", "-oo oo": "real"}.get(" ".join(map(str, value)))
    return word or {"range": [*value]}


def side_as_written(value: Any) -> Side:
    """A side of a claim as text: decimals and integers of TOML by their digits."""
    return [side_as_written(part) for part in value] if isinstance(value, list) else str(value)


@dataclass(frozen=True, slots=True, eq=False)
class FileClaim:
    """One formula of the user.

    formula     : as it is written
    left, right : expressions, or matrices of one shape (given as lists of rows)
    relation    : one of ``= != < <= > >=``
    box         : symbol -> (lower, upper), the file's ranges and those of the claim itself
    tolerance   : None for equality; the exact number that ``|left - right|`` does not exceed
    symbols     : the declared symbols; None where ``formula`` is a name and no text
    divisors    : what the text divides by, also where the algebra has cancelled it since
    radicands   : what the text takes roots of, to be nonnegative, likewise
    arguments   : what the text takes logarithms and symbolic powers of, to be positive, likewise
    notes       : what is said about the claim: expect, title, corrects, reason
    """

    formula: Formula
    left: Any
    right: Any
    relation: str
    box: Mapping[Symbol, tuple[Expr, Expr]]
    tolerance: Expr | None = None
    symbols: tuple[Symbol, ...] | None = ()
    divisors: tuple[Expr, ...] = ()
    radicands: tuple[Expr, ...] = ()
    arguments: tuple[Expr, ...] = ()
    notes: Mapping[str, str] = field(default_factory=dict, kw_only=True)

    @property
    def id(self) -> str:
        """The label of the claim."""
        return self.formula.id


@dataclass(frozen=True, slots=True, eq=False)
class UndefinedClaim:
    """A claim that cannot be read, or has a side without a value; ``place`` counts the claims of the file."""

    formula: Formula
    place: int
    error: NavsymError

    @property
    def id(self) -> str:
        """The label of the claim."""
        return self.formula.id


@dataclass(frozen=True, slots=True, eq=False)
class ClaimFile:
    """``[symbols]`` and ``[[claim]]``; ``undefined`` only where the reader was asked to go on."""

    symbols: Mapping[str, Parameter]
    claims: tuple[FileClaim | TextClaim, ...]
    undefined: tuple[UndefinedClaim, ...] = ()


def read_claims(path: str | os.PathLike[str], *, go_on: bool = False) -> ClaimFile:
    """The claims of a TOML file; raises a NavsymError that names the file and the key.

    go_on : keep the claims of which both sides have values, as long as there is one, and note the others
    """
    return claims_from(read_toml(path), name_file(path), go_on=go_on)


def claims_from(document: Table, where: str = "", *, go_on: bool = False) -> ClaimFile:
    """Like :func:`read_claims` for a document in memory."""
    expect_keys(document, ("symbols", "claim", "rates", "latex"), where)  # [latex] is for those who read documents
    symbols = Symbols.read(document.get("symbols", {}), join_place(where, "symbols"), document.get("rates"))
    blocks = require_key(document, "claim", where)
    place = join_place(where, "claim")
    if not isinstance(blocks, list):
        raise ShapeError("expected [[claim]] blocks; got a single one; write double brackets", where=place)
    if not blocks:
        raise EmptyError("expected at least one [[claim]]; got none; add one", where=place)
    if len(blocks) > CLAIMS:
        message = f"expected at most {CLAIMS} claims; got {len(blocks)}; split the file"
        raise TooLargeError(message, where=place)
    found = [read_claim_or_error(block, symbols, place, i) for i, block in enumerate(blocks)]
    require_distinct((claim.id for claim in found), place)
    claims = tuple(claim for claim in found if not isinstance(claim, UndefinedClaim))
    undefined = tuple(claim for claim in found if isinstance(claim, UndefinedClaim))
    if undefined and not (go_on and claims):
        raise undefined[0].error
    return ClaimFile(symbols.parameters, claims, undefined)


def read_claim_or_error(block: Any, symbols: Symbols, where: str, place: int) -> FileClaim | TextClaim | UndefinedClaim:
    """The claim, or why it cannot be read; one without a label is refused."""
    try:
        return read_claim(block, symbols, join_place(where, place))
    except NavsymError as error:
        if not isinstance(block, dict) or not isinstance(block.get("id"), str):
            raise
        as_label(block["id"], join_place(join_place(where, place), "id"))
        return UndefinedClaim(Formula("", "=", "", id=block["id"]), place, error)


def read_claim(block: Any, symbols: Symbols, where: str) -> FileClaim | TextClaim:
    """One [[claim]] block."""
    table = dict(as_table(block, where))
    notes = {name: NOTES[name](table.pop(name), join_place(where, name)) for name in NOTES if name in table}
    if is_text_claim(table, symbols.written):
        as_label(require_key(table, "id", where), join_place(where, "id"))
        read_tolerance(table.get("tolerance"), table.get("relation", "="), join_place(where, "tolerance"))
        claim = read_text_claim(table, symbols.shapes, symbols.rates, symbols.formula, symbols.limit, where)
        return replace(claim, notes=notes)
    expect_keys(table, ("id", "left", "right", "relation", "box", "tolerance", "exists"), where)
    as_label(require_key(table, "id", where), join_place(where, "id"))
    relation = read_relation(table, where)
    known = symbols_of(symbols.parameters)
    left, left_cells = read_side(require_key(table, "left", where), known, join_place(where, "left"))
    right, right_cells = read_side(require_key(table, "right", where), known, join_place(where, "right"))
    cells = left_cells + right_cells + read_existing(table.get("exists"), known, join_place(where, "exists"))
    require_comparable(left, right, relation, where)
    tolerance = read_tolerance(table.get("tolerance"), relation, join_place(where, "tolerance"))
    box = box_of(symbols.parameters) | read_box(table.get("box", {}), symbols.parameters, join_place(where, "box"))
    noted = [
        tuple(dict.fromkeys(part for cell in cells for part in getattr(cell, name)))
        for name in ("divisors", "radicands", "arguments")
    ]
    names = tuple(known.values())
    return FileClaim(symbols.formula(table), left, right, relation, box, tolerance, names, *noted, notes=notes)


#: What a claim may say about itself beside its formula; ``printed`` and ``source`` as ``read`` writes them.
NOTES: Mapping[str, Callable[[Any, str], str]] = {
    "expect": lambda value, where: one_of(as_text(value, where, "a verdict"), tuple(Status), where),
    "title": as_title,
    "corrects": as_label,
    "reason": as_title,
    "printed": partial(as_text, what="a text"),
    "source": partial(as_text, what="a text"),
}


def read_existing(value: Any, known: Mapping[str, Symbol], where: str) -> list[Parsed]:
    """The expressions that must have a value; their divisors, radicands and logarithms are conditions of the claim."""
    if value is None:
        return []
    return [read_entry_noting(item, known, join_place(where, i)) for i, item in enumerate(as_list(value, where))]


def read_tolerance(value: Any, relation: str, where: str) -> Expr | None:
    """Half a unit of the last digit, or another positive number, exactly."""
    if value is None:
        return None
    if relation != "=":
        raise DomainError(f"expected = beside a tolerance; got {relation}; remove the tolerance", where=where)
    tolerance = read_entry(value, {}, where)
    require_positive(tolerance, "a tolerance", where)
    return tolerance


def read_side(value: Any, known: Mapping[str, Symbol], where: str) -> tuple[Any, list[Parsed]]:
    """An expression, a column given as a list, or a matrix given as a list of rows; with its cells."""
    if not isinstance(value, list):
        parsed = read_entry_noting(value, known, where)
        return parsed.expression, [parsed]
    rows = [row if isinstance(row, list) else [row] for row in as_list(value, where)]
    cells = [
        [
            read_entry_noting(cell, known, join_place(join_place(where, i), j))
            for j, cell in enumerate(as_list(row, where))
        ]
        for i, row in enumerate(rows)
    ]
    if len({len(row) for row in cells}) > 1:
        raise ShapeError("expected rows of one length; got a ragged matrix; correct it", where=where)
    return Matrix([[cell.expression for cell in row] for row in cells]), [c for row in cells for c in row]


def require_comparable(left: Any, right: Any, relation: str, where: str) -> None:
    """Refuse sides of different shapes, and an order between matrices."""
    shapes = [getattr(side, "shape", None) for side in (left, right)]
    if shapes[0] != shapes[1]:
        message = f"expected two sides of one shape; got {shapes[0]} and {shapes[1]}; correct one of them"
        raise ShapeError(message.replace("None", "a scalar"), where=where)
    if shapes[0] is not None and relation not in ("=", "!="):
        message = f"expected = or != between matrices; got {relation}; compare them entry by entry"
        raise ShapeError(message, where=join_place(where, "relation"))


def read_box(value: Any, symbols: Mapping[str, Parameter], where: str) -> Box:
    """The claim's own ranges; they may narrow what the file says of a symbol, not contradict it."""
    box = {}
    for name, ends in as_table(value, where).items():
        place = join_place(where, name)
        if name not in symbols:
            expect_keys({name: ends}, tuple(symbols), where)
        lower, upper = read_range(ends, place)
        parameter = symbols[name]
        unnamed = ZERO if parameter.symbol.is_nonnegative else None
        low_end = unnamed if parameter.lower is None else parameter.lower
        if is_outside(lower, low_end) or is_outside(parameter.upper, upper):
            message = f"expected a range inside the declaration of {name}; got a wider one; narrow it"
            raise DomainError(message, where=place)
        box[parameter.symbol] = (lower, upper)
    return box


def is_outside(inner: Expr | None, outer: Expr | None) -> bool:
    """True when ``inner < outer`` is certain; None means no end."""
    return inner is not None and outer is not None and sign_of_constant(inner - outer) == -1


# A user's own formulas, decided one by one.


SECONDS = 20.0


def decide_claims(
    claims: ClaimFile,
    *,
    jobs: int = 1,
    seconds: float = SECONDS,
    progress: Callable[[Verdict, int], None] | None = None,
) -> Verdicts:
    """The verdict of every claim, each decided in a child process of its own.

    A claim that needs more than ``seconds`` is OPEN. Order and verdicts do not depend on ``jobs``. Where a side
    has no value, the claim is OPEN, and its error stands beside the verdicts.
    """
    verdicts: dict[int, Verdict] = {}
    for outcome in run_many(partial(decide_claim, seconds=seconds / 2), claims.claims, jobs, seconds):
        verdict = outcome.value
        if isinstance(verdict, (Exhausted, Failed)):
            why = verdict.why if isinstance(verdict, Exhausted) else str(verdict.error)
            verdict = Verdict(OPEN, "none", evidence=f"not decided: {why}")
        verdicts[outcome.place] = replace(verdict, formula=claims.claims[outcome.place].formula)
        if progress is not None:
            progress(verdicts[outcome.place], len(claims.claims))
    done = [verdicts[place] for place in sorted(verdicts)]
    for claim in claims.undefined:
        done.insert(claim.place, Verdict(OPEN, "none", evidence=claim.error.message, formula=claim.formula))
    return Verdicts(tuple(done), {claim.id: claim.error for claim in claims.undefined})


def decide_claim(claim: FileClaim | TextClaim, seconds: float = SECONDS / 2) -> Verdict:
    """Verdict of one claim, with what its text divides by and takes roots of among the assumptions."""
    if isinstance(claim, TextClaim):
        return decide_text(claim, seconds)
    return complete_verdict(claim, decide(statement_of(claim), seconds=seconds))


def complete_verdict(claim: FileClaim, verdict: Verdict) -> Verdict:
    """The verdict with the scope of the text and its conditions, which the algebra may have cancelled."""
    if verdict.status == REFUTED:
        return verdict
    assumptions = dict.fromkeys((*verdict.assumptions, *text_conditions(claim)))
    sides = [tuple(side) if isinstance(side, sp.MatrixBase) else side for side in (claim.left, claim.right)]
    parts = sp.Tuple(*sides, *claim.divisors, *claim.radicands, *claim.arguments)  # all symbols of the text, as in a/a
    return replace(verdict, scope=scope_of(parts, claim.box), assumptions=tuple(assumptions))


def text_conditions(claim: FileClaim) -> list[str]:
    """What the text divides by and takes roots and logarithms of, where the algebra has cancelled it since."""
    found = [f"{expression_text(d)} != 0" for d in claim.divisors if not is_nonzero(d, claim.box)]
    found += [f"{expression_text(r)} >= 0" for r in claim.radicands if not is_nonnegative(r, claim.box)]
    return found + [f"{expression_text(a)} > 0" for a in claim.arguments if not is_positive(a, claim.box)]


def existing_parts(claim: FileClaim) -> tuple[sp.Expr, ...]:
    """Expressions with a value exactly where the text has one, whatever the algebra has cancelled."""
    return (
        *(1 / divisor for divisor in claim.divisors),
        *(sp.sqrt(radicand) for radicand in claim.radicands),
        *(sp.log(argument) for argument in claim.arguments),
    )


def require_numbers(claim: FileClaim | TextClaim) -> FileClaim:
    """The claim, when its sides are numbers or lists of numbers; raises DomainError for one of the whole language."""
    if isinstance(claim, FileClaim):
        return claim
    got = f"{quote(str(claim.formula))}, which has vectors, integrals, derivatives, cases, hypotheses or an order"
    raise DomainError(f"expected a claim between numbers; got {got}; write its entries out", where=claim.id)


def close_claim(claim: FileClaim | TextClaim) -> FileClaim:
    """The claim between numbers; of one of the whole language, a side of it on both sides, entry by entry.

    The side is the first that has a value without a case and without an antiderivative or limit that was searched for,
    as the checker reads it: its text stands for itself. Raises DomainError where there is none.
    """
    if isinstance(claim, FileClaim):
        return claim
    document, formula = claim.documents[0], claim.formula
    is_equation = len(claim.documents) == 1 and document["relation"] == "=" and not (formula.order or formula.tolerance)
    for side in ("left", "right") if is_equation and not {"matrices", "random"} & {*document} else ():
        if entries := list_closed_entries(document, side):
            used = {name for text in list_texts(entries) for name in re.findall(r"[A-Za-z]\w*", text)}
            limits = {name: ends for name, ends in document["symbols"].items() if name in used}
            symbols = {name: declare_limits(*ends) for name, ends in limits.items()}
            block = {"id": claim.id, "left": entries, "right": entries}
            closed = claims_from({"symbols": symbols, "claim": [block]}, claim.id).claims[0]
            if not isinstance(closed, FileClaim):  # erf is of the whole language, too
                continue
            ends = {s: [end and parse(end, {}) for end in limits[s.name][:2]] for s in closed.symbols or ()}
            return replace(closed, box={**closed.box, **{s: (low, high) for s, (low, high) in ends.items()}})
    expected = "one exact equation with a side without integrals, limits, cases, floor, erf and chances, of known size"
    raise DomainError(f"expected {expected}; got {quote(str(formula))}; write one so", where=claim.id)


def list_closed_entries(document: Mapping[str, Any], side: str) -> Any:
    """The texts of the entries of a side, in rows where it is a matrix; None where it has cases or is not closed."""
    sizes = {name: (len(rows), len(rows[0])) for name, rows in document["shapes"].items()}
    sizes |= {name: None for name in document["symbols"]}
    size = read_value(document[side], sizes).size
    zero = "0" if size is None else f"zeros({size[0]}, {size[1]})"
    try:
        cases, _, answers = read_with_answers({**document, "left": document[side], "right": zero})
    except TROUBLE:
        return None
    texts = [write_term(goal.term) for goal in cases[0].goals]
    if len(cases) != 1 or answers or any(player.FRACTION in text for text in texts):
        return None
    if size is None:
        return texts[0]
    columns = int(size[1])
    return texts if columns == 1 else [texts[k : k + columns] for k in range(0, len(texts), columns)]


def declare_limits(low: str | None, high: str | None, flags: Sequence[str]) -> Any:
    """Limits in the words of the checker as a declaration, without ends; a number that is whole is a real one here."""
    if (low, high) == ("0", None) and "open-low" in flags:
        return "positive"
    return "nonzero" if "nonzero" in flags else "real"


def statement_of(claim: FileClaim | TextClaim) -> Statement:
    """The file's claim as a statement of the ladder; raises DomainError for one of the whole language."""
    claim = require_numbers(claim)
    formula = claim.formula
    left, right = list_texts(formula.left), list_texts(formula.right)
    as_typed = claim.symbols is not None
    written = Written(left, right, formula.exists, formula.tolerance, claim.symbols or ()) if as_typed else None
    if claim.relation == "=":
        exists = existing_parts(claim)
        return Equation(claim.left, claim.right, claim.box, claim.tolerance, exists=exists, written=written)
    return Bound(claim.left, claim.relation, claim.right, claim.box, existing_parts(claim), written)


def list_texts(side: Side) -> tuple[str, ...]:
    """The texts of the entries of a side, row by row."""
    return (side,) if isinstance(side, str) else tuple(text for row in side for text in list_texts(row))


def property_of_claim(claim: FileClaim | TextClaim) -> Worded:
    """Whether a claim holds, decided now: of those with vectors, cases, derivatives, hypotheses or conditions."""
    verdict = decide_claim(claim)
    texts = claim.documents if isinstance(claim, TextClaim) else tuple(write_statements(statement_of(claim)) or ())
    said = texts if verdict.certificate else ()
    point, fails = verdict.counterexample or {}, verdict.status == REFUTED
    if fails:
        at = ", ".join(f"{name} = {value}" for name, value in point.items())
        words = f"{verdict.evidence}: {at}" if at else verdict.evidence
        verdict = replace(verdict, status=PROVED, evidence=words, assumptions=())
    parts = (verdict.scope, verdict.assumptions, verdict.evidence, verdict.certificate)
    found = Finding(not fails, verdict.method, verdict.status, *parts)
    return Worded(True, found, meaning=said, formula=claim.formula, counterexample=point)
