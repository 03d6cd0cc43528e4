"""Two formulas, claim files, models or exports side by side: proved equal, or the worst point shown."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sympy as sp
from flint import arb

from navsym.claims import REFUTED, Equation
from navsym.core.balls import enclose, hull
from navsym.core.errors import DomainError, EmptyError, ExpressionSyntaxError, NavsymError
from navsym.language.expression import parse, symbol
from navsym.language.files import read_text
from navsym.language.tokens import Source, tokenize
from navsym.prove.ladder import decide
from navsym.prove.sampling.points import range_of
from navsym.prove.wording import decimal_ends, text_of

POINTS = 400
LIMIT = 20_000_000
Record = dict[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Formula:
    """A named formula with the ranges of its symbols.

    outside : its text when the language of files cannot say it; it is then compared as text only
    """

    name: str
    expression: sp.Expr
    box: Mapping[sp.Symbol, tuple[Any, Any]]
    outside: str = ""


def compare(old: Mapping[str, Formula], new: Mapping[str, Formula]) -> Record:
    """The document of ``navsym diff``.

    ``differences``: one record each, ``{"name", "status", "worst", "difference", "why", "assumptions"}`` with status
    EQUAL (proved, on one and the same range), OVERLAP (proved equal, but the ranges differ), DIFFERENT (worst point
    found, its difference enclosed), OPEN, ONLY-OLD or ONLY-NEW. ``equal``: true when every formula is proved equal.
    Raises EmptyError when there is nothing to compare.
    """
    if not old and not new:
        raise EmptyError("expected formulas; got none on either side; do name files that hold some")
    records = [record_for(name, old.get(name), new.get(name)) for name in dict.fromkeys([*old, *new])]
    return {"equal": all(r["status"] == "EQUAL" for r in records), "differences": records}


def record_for(name: str, old: Formula | None, new: Formula | None) -> Record:
    """The record of two formulas of one name, or of one without a counterpart; statuses as in the document."""
    if old is None or new is None:
        status = "ONLY-NEW" if old is None else "ONLY-OLD"
        return said(name, status, "no counterpart")
    if old.outside or new.outside:
        same = old.outside == new.outside and not different_ranges(old, new)
        return said(name, "EQUAL" if same else "OPEN", "the same text" if same else "outside the language of files")
    left, right = old.expression, in_terms_of(new.expression, old)
    box = common_box(old, new)
    verdict = decide(Equation(left, right, box))
    if verdict.status.holds:
        apart = different_ranges(old, new)
        if apart:
            return said(
                name, "OVERLAP", f"equal where both are stated; ranges differ: {', '.join(apart)}", verdict.assumptions
            )
        return said(name, "EQUAL", verdict.method, verdict.assumptions)
    if verdict.status != REFUTED:
        return said(name, "OPEN", verdict.evidence)
    point, difference = worst_point(left - right, box)
    if point is None or difference is None:
        return said(name, "DIFFERENT", "counterexample") | {
            "worst": dict(verdict.counterexample or {}),
            "difference": [verdict.difference.lower, verdict.difference.upper] if verdict.difference else [],
        }
    ends = decimal_ends(difference)
    return said(name, "DIFFERENT", f"largest of {POINTS} points") | {
        "worst": {s.name: text_of(value) for s, value in point.items()},
        "difference": [ends.lower, ends.upper],
    }


def said(name: str, status: str, why: str, assumptions: Sequence[str] = ()) -> Record:
    """A record without a point."""
    return {
        "name": name,
        "status": status,
        "worst": None,
        "difference": None,
        "why": why,
        "assumptions": list(assumptions),
    }


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
        low, high = box.get(mine, (None, None))
        box[mine] = (larger(low, lower), smaller(high, upper))
    return box


def larger(a: Any, b: Any) -> Any:
    """The larger of two exact numbers; of one and None, the number."""
    if a is None or b is None:
        return b if a is None else a
    return a if enclose(sp.sympify(a - b, strict=True), {}) >= 0 else b


def smaller(a: Any, b: Any) -> Any:
    """The smaller of two exact numbers; of one and None, the number."""
    if a is None or b is None:
        return b if a is None else a
    return b if enclose(sp.sympify(a - b, strict=True), {}) >= 0 else a


def worst_point(difference: sp.Expr, box: Mapping[Any, Any]) -> tuple[dict[sp.Symbol, sp.Expr] | None, arb | None]:
    """The sampled point where two formulas are farthest apart, with the difference enclosed there."""
    generator = random.Random(0)
    symbols = sorted(difference.free_symbols, key=lambda s: s.name)
    best: tuple[dict[sp.Symbol, sp.Expr] | None, arb | None] = (None, None)
    for _ in range(POINTS):
        point = {s: random_in(s, box, generator) for s in symbols}
        found = enclose(difference, {s: hull(v, v) for s, v in point.items()}, 128)
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


# -- what can be compared ---------------------------------------


def formulas_of(text: str, ranges: Mapping[str, tuple[Any, Any]]) -> dict[str, Formula]:
    """Formulas of an argument: an export's folder, a claim or model file, or the text of one formula.

    ranges : name -> (lower, upper), exact; symbols without a range are real
    Raises DomainError for a folder that is no export, and the errors of the readers of files and expressions.
    """
    path = Path(text)
    if path.is_dir():
        return of_export(path)
    if text.endswith(".toml"):
        return of_file(path)
    return {"formula": of_text(text, ranges)}


def of_text(text: str, ranges: Mapping[str, tuple[Any, Any]], where: str = "") -> Formula:
    """A formula whose names are real symbols, with ranges where some are given."""
    from navsym.language.names import RESERVED

    names = {t.text for t in tokenize(Source(text, where)) if t.kind == "name"} - RESERVED
    symbols = {name: symbol(name, where=where) for name in sorted(names)}
    box = {symbols[name]: ends for name, ends in ranges.items() if name in symbols}
    return Formula("formula", parse(text, symbols, where=where), box)


def of_file(path: Path) -> dict[str, Formula]:
    """Left sides of a claim file, or the entries of a model's F and H."""
    from navsym.language.tomlfile import read_toml

    document = read_toml(path)
    if "claim" in document:
        from navsym.prove.claimfile import claims_from

        claims = claims_from(document, str(path)).claims
        return {name: found for c in claims for name, found in entries_of(c.id, c.left, c.box).items()}
    return of_model(path)


def entries_of(name: str, side: Any, box: Mapping[sp.Symbol, tuple[Any, Any]]) -> dict[str, Formula]:
    """A formula, or the entries of a matrix or list by their places."""
    if isinstance(side, sp.MatrixBase):
        found = {f"{name}[{i + 1},{j + 1}]": side[i, j] for i in range(side.rows) for j in range(side.cols)}
    elif isinstance(side, (tuple, list)):
        found = {f"{name}[{k + 1}]": e for k, e in enumerate(side)}
    else:
        found = {name: side}
    return {label: Formula(label, e, box) for label, e in found.items()}


def of_model(path: Path) -> dict[str, Formula]:
    """Entries of F and of the measurement rows, by their places."""
    from navsym.models.modelfile import ModelFile, read_model

    model = read_model(path)
    if isinstance(model, ModelFile):
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
            "do export again",
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
