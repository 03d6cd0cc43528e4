"""Two formulas, claim files, models or exports side by side: proved equal, or the worst point shown."""

from __future__ import annotations

import json
import os
import random
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import sympy as sp
from flint import arb

from navsym.claims import REFUTED, Bound, Equation, Record
from navsym.claims.display import count_in_words
from navsym.claims.formula import Formula as Statement
from navsym.core.answers import Answers, named
from navsym.core.balls import enclose, hull
from navsym.core.errors import DomainError, EmptyError, ExpressionSyntaxError, NavsymError, ShapeError
from navsym.core.numbers import Number
from navsym.core.tables import Table
from navsym.export.parts import overlap
from navsym.language.expression import parse_noting, symbol
from navsym.language.files import read_text
from navsym.language.names import quote, require_table
from navsym.language.tokens import Source, tokenize
from navsym.language.values import read_constant, write_value
from navsym.prove.claimfile import (
    FileClaim,
    existing_parts,
    read_claims,
    require_numbers,
    statement_of,
    text_conditions,
)
from navsym.prove.ladder import decide
from navsym.prove.relations.judge import TextClaim
from navsym.prove.sampling.points import range_of
from navsym.prove.wording import decimal_ends, expression_text
from navsym.verification.ledger import Ledger, read_ledger
from navsym.verification.papers import file_of_source, find_claim, is_model, split_id

POINTS = 400
LEDGER = "a ledger"
LIMIT = 20_000_000


#: Divisors, radicands, arguments of logarithms.
Noted = tuple[tuple[sp.Expr, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Formula:
    """A named formula with the ranges of its symbols.

    outside : its text when it is no formula between numbers; it is then compared as text only
    unread  : why it was not compared, where its text cannot be read or is not all of it
    noted   : divisors, radicands and arguments of logarithms of its text, also where the algebra has cancelled them
    right   : for the left side of a claim, its right side
    stated  : for a claim, its relation and its tolerance
    """

    name: str
    expression: sp.Expr
    box: Mapping[sp.Symbol, tuple[Any, Any]]
    outside: str = ""
    noted: Noted = ((), (), ())
    right: sp.Expr | None = None
    stated: tuple[str, ...] = ()
    unread: str = ""


@dataclass(frozen=True, slots=True)
class Difference:
    """What came of two formulas of one name.

    status      : EQUAL (proved, on one range), OVERLAP (proved equal, but the ranges differ), DIFFERENT, OPEN,
                  ONLY-OLD or ONLY-NEW
    worst       : for DIFFERENT, the point that was found: symbol -> exact number
    difference  : old - new there, or None
    why         : how it is known
    assumptions : what the proof takes for granted
    """

    name: str
    status: str
    why: str
    assumptions: tuple[str, ...] = ()
    worst: Mapping[str, str] | None = None
    difference: Number | None = None

    def document(self) -> dict[str, Any]:
        """One entry of ``differences`` in the JSON document of ``navsym diff``."""
        ends = self.difference and [self.difference.lower, self.difference.upper]
        return named(self, "name status worst") | {"difference": ends} | named(self, "why assumptions")


@dataclass(frozen=True, slots=True, repr=False)
class Differences(Answers[Difference]):
    """Formulas of two sides by their names; ``equal`` when every one is proved equal."""

    differences: tuple[Difference, ...]

    @property
    def equal(self) -> bool:
        """True when every formula is proved equal, on one and the same range."""
        return all(found.status == "EQUAL" for found in self.differences)

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym diff``."""
        return {"equal": self.equal, "differences": [found.document() for found in self.differences]}

    def __repr__(self) -> str:
        counts = Counter(found.status for found in self.differences)
        return f"<{count_in_words(len(self), 'formula')}: {', '.join(f'{n} {status}' for status, n in counts.items())}>"

    def table(self) -> Table:
        """One line for each formula: how it compares, and where it differs most."""
        rows = []
        for record in self:
            point = ", ".join(f"{k} = {v}" for k, v in (record.worst or {}).items())
            size = f"old - new {record.difference.words}" if record.difference else ""
            words = f"{size} at {point or 'every point'}" if size else record.why
            if record.assumptions:
                words += f"; where {', '.join(record.assumptions)}"
            rows.append((record.name, record.status, words))
        return ("formula", "status", "where"), rows


def diff(old: Any, new: Any, *, box: Mapping[str, Any] | None = None, **ranges: Any) -> Differences:
    """Two formulas, claim files, models, exported folders or ledgers compared exactly, formula by formula.

    Claims are EQUAL where both sides, the relation and the tolerance are.

    old, new : formulas (text, sympy, or the id of a claim for what it prints), paths of claim or model files (TOML)
               or of ledgers (JSON), or exported folders; both of one kind
    box      : ranges of symbols, ``{"T": ("0", "2*pi")}``; the same as ``T=("0", "2*pi")``. Others are real

    Raises ShapeError for two kinds, DomainError for a file or folder of another kind, EmptyError without formulas.

    >>> import navsym as nav
    >>> nav.diff("sin(2*a)", "2*sin(a)*cos(a)").equal
    True
    >>> changed = nav.diff("sqrt(x**2)", "x", x=("-1", "1"))
    >>> changed[0].status, dict(changed[0].worst)
    ('DIFFERENT', {'x': '-1'})
    """
    sides = [
        os.fspath(value) if isinstance(value, os.PathLike) else write_value(value, f"diff: {name}")
        for value, name in ((old, "old"), (new, "new"))
    ]
    kinds = [kind_of_text(text) for text in sides]
    if kinds[0] != kinds[1]:
        message = f"expected two things of one kind; got {kinds[0]} and {kinds[1]}; compare each with its own kind"
        raise ShapeError(message, where=str(sides[1])[:200])
    if kinds[0] == LEDGER:
        return compare_ledgers(*map(read_ledger, sides))
    known = {name: exact_range(name, ends) for name, ends in {**require_table(box, "diff: box"), **ranges}.items()}
    return compare_formulas(*(formulas_of(text, kinds[0], known) for text in sides))


def kind_of_text(text: str) -> str:
    """What a text names; a file of another kind is refused."""
    from navsym.language.tomlfile import read_toml

    if text.endswith(".toml"):
        return "a claim file" if "claim" in read_toml(Path(text)) else "a model file"
    if os.path.isdir(text):  # a long formula is no name of a file, which Path.is_dir does not bear
        return "a folder"
    if text.endswith(".json"):
        return LEDGER
    if os.path.exists(text):
        expected = "a formula, a file named *.toml, an exported folder or a ledger"
        message = f"expected {expected}; got another file; name one of these"
        raise DomainError(message, where=text)
    return "a formula"


def compare_ledgers(old: Ledger, new: Ledger) -> Differences:
    """What has become of every claim: EQUAL where statement and verdict are the same."""
    before, now = ({record.id: record for record in ledger} for ledger in (old, new))
    return Differences(tuple(compare_records(name, before.get(name), now.get(name)) for name in {**before, **now}))


def compare_records(name: str, old: Record | None, new: Record | None) -> Difference:
    """What has become of one claim."""
    if old is None or new is None:
        words = f"new, {new.status}" if new else f"gone, it was {old.status if old else 'unknown'}"
        return Difference(name, "ONLY-NEW" if old is None else "ONLY-OLD", words)
    if old.status != new.status:
        return Difference(name, "DIFFERENT", f"{new.status}, it was {old.status}", worst=new.counterexample)
    if old.statement != new.statement:
        return Difference(name, "DIFFERENT", f"another statement, {new.status} as before")
    return Difference(name, "EQUAL", f"the same statement, {new.status}")


def exact_range(name: str, ends: Any) -> tuple[sp.Expr, sp.Expr]:
    """Two exact ends of a range; raises ShapeError for what is no pair."""
    where = f"diff: {name}"
    if not isinstance(ends, (tuple, list)) or len(ends) != 2:
        raise ShapeError(f'expected two ends; got {quote(ends)}; write {name}=("0", "1")', where=where)
    lower, upper = (read_constant(end, where) for end in ends)
    return lower, upper


def compare_formulas(old: Mapping[str, Formula], new: Mapping[str, Formula]) -> Differences:
    """What came of every name on either side; raises EmptyError when there is nothing to compare."""
    if not old and not new:
        raise EmptyError("expected formulas; got none on either side; name files that hold some")
    names = dict.fromkeys([*old, *new])
    return Differences(tuple(compare_claims(name, old.get(name), new.get(name)) for name in names))


def compare_claims(name: str, old: Formula | None, new: Formula | None) -> Difference:
    """What came of two formulas of one name; of two claims, of both sides, relation and tolerance."""
    found = compare_pair(name, old, new)
    if old is None or new is None or found.status != "EQUAL":
        return found
    if old.right is not None and new.right is not None and old.right != in_terms_of(new.right, old):
        right = compare_pair(name, replace(old, expression=old.right), replace(new, expression=new.right))
        if right.status != "EQUAL":
            return replace(right, why=f"right side: {right.why}")
    if old.stated != new.stated:
        return Difference(name, "DIFFERENT", f"{' '.join(old.stated)} has become {' '.join(new.stated)}")
    return found


def compare_pair(name: str, old: Formula | None, new: Formula | None) -> Difference:
    """What came of two formulas of one name, or of one without a counterpart."""
    if old is None or new is None:
        return Difference(name, "ONLY-NEW" if old is None else "ONLY-OLD", "no counterpart")
    if unread := old.unread or new.unread:
        return Difference(name, "OPEN", f"not compared: {unread}")
    if old.outside or new.outside:
        if old.outside == new.outside and not different_ranges(old, new):
            return Difference(name, "EQUAL", "the same text")
        return Difference(name, "OPEN", "not compared: no formula between numbers, and the texts are not the same")
    claim = claim_of(old, new)
    verdict = decide(statement_of(claim))
    if verdict.status.holds:
        apart = different_ranges(old, new)
        words = f"equal where both are stated; ranges differ: {', '.join(apart)}" if apart else verdict.method
        assumptions = tuple(dict.fromkeys((*verdict.assumptions, *text_conditions(claim))))
        return Difference(name, "OVERLAP" if apart else "EQUAL", words, assumptions)
    if verdict.status != REFUTED:
        return Difference(name, "OPEN", verdict.evidence)
    point, difference = worst_point(claim.left - claim.right, claim.box, existing_parts(claim))
    if point is None or difference is None:
        return Difference(name, "DIFFERENT", "counterexample", (), verdict.counterexample or {}, verdict.difference)
    exact = {s.name: expression_text(value) for s, value in point.items()}
    return Difference(name, "DIFFERENT", f"largest of {POINTS} points", (), exact, decimal_ends(difference))


def claim_of(old: Formula, new: Formula) -> FileClaim:
    """``old = new`` in the old one's symbols, where both texts have a value."""
    words = Statement(old.name, "=", new.name)
    both = zip(old.noted, new.noted, strict=True)
    noted = (tuple(dict.fromkeys((*mine, *(in_terms_of(part, old) for part in others)))) for mine, others in both)
    right = in_terms_of(new.expression, old)
    return FileClaim(words, old.expression, right, "=", common_box(old, new), None, None, *noted)


def different_ranges(old: Formula, new: Formula) -> list[str]:
    """Names of the symbols of either formula whose stated ranges are not the same."""
    names = {s.name for s in (*old.expression.free_symbols, *new.expression.free_symbols)}
    ends = [{s.name: ends for s, ends in f.box.items()} for f in (old, new)]
    return sorted(n for n in names if not same_range(*(e.get(n, (None, None)) for e in ends)))


def same_range(one: tuple[Any, Any], other: tuple[Any, Any]) -> bool:
    """Ends that are equal, or missing on both sides."""
    return all(
        a is b or (a is not None and b is not None and enclose(sp.sympify(a - b, strict=True), {}).contains(0))
        for a, b in zip(one, other, strict=True)
    )


def in_terms_of(expression: sp.Expr, other: Formula) -> sp.Expr:
    """The same formula with the other one's symbols, by name."""
    known = {s.name: s for s in (*other.expression.free_symbols, *other.box)}
    return expression.xreplace({s: known[s.name] for s in expression.free_symbols if s.name in known})


def common_box(old: Formula, new: Formula) -> dict[sp.Symbol, tuple[Any, Any]]:
    """The ranges of both, by the symbols of the old one; where both have one, the overlap."""
    known = {s.name: s for s in (*old.expression.free_symbols, *old.box)}
    box = dict(old.box)
    for s, (lower, upper) in new.box.items():
        mine = known.get(s.name, s)
        box[mine] = overlap(box.get(mine, (None, None)), (lower, upper))
    return box


def worst_point(
    difference: sp.Expr, box: Mapping[Any, Any], existing: Sequence[sp.Expr] = ()
) -> tuple[dict[sp.Symbol, sp.Expr] | None, arb | None]:
    """The sampled point where two formulas are farthest apart, with the difference enclosed there.

    existing : parts that have a value at the point
    """
    generator = random.Random(0)
    symbols = sorted(difference.free_symbols.union(*(part.free_symbols for part in existing)), key=lambda s: s.name)
    best: tuple[dict[sp.Symbol, sp.Expr] | None, arb | None] = (None, None)
    for _ in range(POINTS):
        point = {s: random_in(s, box, generator) for s in symbols}
        balls = {s: hull(v, v) for s, v in point.items()}
        found = enclose(difference, balls, 128)
        if not all(enclose(part, balls, 128).is_finite() for part in existing):
            continue
        if found.is_finite() and (best[1] is None or abs(found).lower() > abs(best[1]).upper()):
            best = point, found
    return best


def random_in(s: sp.Symbol, box: Mapping[Any, Any], generator: random.Random) -> sp.Expr:
    """An exact number of the range, short enough to read; ends and quarters are likely."""
    limits = range_of(s, box)
    low = limits.lower if limits.lower is not None else (limits.upper - 10 if limits.upper is not None else -10)
    high = limits.upper if limits.upper is not None else low + 20
    share = sp.Rational(generator.choice([1, 4, *range(4), *(generator.randint(0, 100) for _ in range(12))]), 100)
    if generator.random() < 0.2:
        share = sp.Rational(generator.randint(0, 4), 4)
    value = low + (high - low) * share
    return high if limits.open_lower and share == 0 else value


def formulas_of(text: str, kind: str, ranges: Mapping[str, tuple[Any, Any]]) -> dict[str, Formula]:
    """Formulas of an argument: an export's folder, a claim or model file, or the text of one formula.

    ranges : name -> (lower, upper), exact; symbols without a range are real
    Raises DomainError for a folder that is no export, and the errors of the readers of files and expressions.
    """
    if kind in READERS:
        return READERS[kind](Path(text))
    return {"formula": of_claim(text) if ":" in text else of_text(text, ranges)}


def of_claim(wanted: str) -> Formula:
    """What a claim prints, by its id; raises ShapeError for a claim that prints no single expression."""
    module, _, label = split_id(wanted)
    _, claim = find_claim(wanted)
    if module.endswith(".toml") and not is_model(path := file_of_source(module)):
        found = next(require_numbers(c) for c in read_claims(path, go_on=True).claims if c.id == label)
        return Formula("formula", found.left, found.box, noted=noted_in(found))
    statement = claim.derive()
    printed = getattr(statement, "printed", None)
    if not isinstance(printed, sp.Expr) or not isinstance(statement, (Equation, Bound)):
        raise ShapeError(f"expected a claim of one expression; got another one; see navsym show {wanted}", where=wanted)
    return Formula("formula", printed, statement.box)


def of_text(text: str, ranges: Mapping[str, tuple[Any, Any]], where: str = "") -> Formula:
    """A formula whose names are real symbols, with ranges where some are given."""
    from navsym.language.names import RESERVED

    names = {t.text for t in tokenize(Source(text, where)) if t.kind == "name"} - RESERVED
    symbols = {name: symbol(name, where=where) for name in sorted(names)}
    box = {symbols[name]: ends for name, ends in ranges.items() if name in symbols}
    parsed = parse_noting(text, symbols, where=where)
    return Formula("formula", parsed.expression, box, noted=noted_in(parsed))


def noted_in(text: Any) -> Noted:
    """Divisors, radicands and arguments of logarithms that a reader of a text, or of a claim, has noted."""
    return text.divisors, text.radicands, text.arguments


def of_file(path: Path) -> dict[str, Formula]:
    """Claims of a claim file."""
    file = read_claims(path, go_on=True)
    unread = {c.id: Formula(c.id, sp.S.Zero, {}, unread=str(c.error)) for c in file.undefined}
    return {name: found for c in file.claims for name, found in entries_by_place(c).items()} | unread


def entries_by_place(claim: FileClaim | TextClaim) -> dict[str, Formula]:
    """Both sides of a claim, or of its entries by their places; the text of one of the whole language."""
    name = claim.id
    if isinstance(claim, TextClaim):
        text = json.dumps([claim.documents, claim.formula.document()], sort_keys=True)
        return {name: Formula(name, sp.S.Zero, {}, outside=text)}
    side = claim.left
    found = {name: (side, claim.right)}
    if isinstance(side, sp.MatrixBase):
        places = [(i, j) for i in range(side.rows) for j in range(side.cols)]
        found = {f"{name}[{i + 1},{j + 1}]": (side[i, j], claim.right[i, j]) for i, j in places}
    stated = (claim.relation, *([] if claim.tolerance is None else [f"within {claim.tolerance}"]))
    return {
        label: Formula(label, left, claim.box, noted=noted_in(claim), right=right, stated=stated)
        for label, (left, right) in found.items()
    }


def of_model(path: Path) -> dict[str, Formula]:
    """Entries of F and of the measurement rows, by their places."""
    from navsym.models.modelfile import ModelFile, need_fixed, read_model

    model = read_model(path)
    if isinstance(model, ModelFile):
        if not model.pieces:
            need_fixed(model, str(path))
        matrices = {f"F{k + 1 if len(model.pieces) > 1 else ''}": p.F for k, p in enumerate(model.pieces)}
        rows = [list(m.h) for m in model.measurements]
    else:
        matrices, rows = {}, [list(row) for row in model.H]
    matrices["H"] = sp.Matrix(rows)
    return {
        label: Formula(label, matrix[i, j], model.box)
        for name, matrix in matrices.items()
        for i in range(matrix.rows)
        for j in range(matrix.cols)
        for label in (f"{name}[{i + 1},{j + 1}]",)
    }


def of_export(folder: Path) -> dict[str, Formula]:
    """Formulas of an export's manifest, one for each result and regime."""
    where = str(folder / "manifest.json")
    try:
        manifest = json.loads(read_text(folder / "manifest.json", LIMIT))
        functions = [(str(f["name"]), f["inputs"], f["pieces"]) for f in manifest["functions"]]
        found = {}
        for name, inputs, pieces in functions:
            ranges = {str(i["symbol"]): exact_ends(i) for i in inputs}
            for place, piece in enumerate(pieces):
                for line in piece["source"]["formula"]:
                    result, _, text = str(line).partition(" = ")
                    label = f"{name}.{result}" + (f" (regime {place + 1})" if len(pieces) > 1 else "")
                    found[label] = of_line(text, ranges, where)
        return found
    except NavsymError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise DomainError(
            f"expected a manifest of navsym export; got one without its keys ({type(error).__name__}: {error}); "
            "export again",
            where=where,
        ) from None


def of_line(text: str, ranges: Mapping[str, tuple[Any, Any]], where: str) -> Formula:
    """A formula of a manifest; one that was written in other words than those of files keeps its text."""
    try:
        return of_text(text, ranges, where)
    except ExpressionSyntaxError:
        present = set(re.findall(r"\w+", text))
        box = {sp.Symbol(name, real=True): ends for name, ends in ranges.items() if name in present}
        return Formula("formula", sp.Add(*box), box, outside=text)


def exact_ends(record: Mapping[str, Any]) -> tuple[Any, Any]:
    """Accepted range of an input as exact numbers."""
    ends = (record["low"], record["high"])
    return tuple(None if e is None else sp.Rational(*float(e).as_integer_ratio()) for e in ends)  # type: ignore[return-value]


READERS = {"a claim file": of_file, "a model file": of_model, "a folder": of_export}
