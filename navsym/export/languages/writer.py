"""One language in one type: its spelling, and its templates (``navsym/export/templates``), filled in with functions.

A template has the layout of the language and nothing else; formulas come from :mod:`navsym.export.languages.printing`.
In templates a value stands between guillemets, which no language of ours uses, and a block between ``<%`` and ``%>``.
"""

from __future__ import annotations

import functools
import json
import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import PrintedHelper, helpers_used, print_helper
from navsym.export.languages.printing import Spelling, assignments, calls
from navsym.export.languages.summary import field_text, state_record, summary, unit_of
from navsym.export.parts import ExportedFunction

TEMPLATES = Path(__file__).parents[1] / "templates"
TABLE: dict[str, dict[str, Any]] = tomllib.loads(Path(__file__).with_name("spellings.toml").read_text("utf-8"))


@functools.cache
def environment() -> jinja2.Environment:
    """Templates of code: nothing is escaped, and every name must have a value."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        variable_start_string="«",
        variable_end_string="»",
        block_start_string="<%",
        block_end_string="%>",
        comment_start_string="<#",
        comment_end_string="#>",
    )
    made.globals |= {
        "summary": summary,
        "unit_of": unit_of,
        "field_text": field_text,
        "accessors": accessors,
        "zip": zip,
    }
    made.filters["rows"] = in_rows
    return made


def in_rows(numbers: Sequence[str], between: str) -> str:
    """Numbers separated by commas, four in a line; ``between`` stands before every line but the first."""
    return f",\n{between}".join(", ".join(numbers[k : k + 4]) for k in range(0, len(numbers), 4))


def accessors(function: ExportedFunction, result: str, state: str | None = None) -> list[str]:
    """Where every result is: behind ``result``, or behind ``state`` in the field that it replaces."""
    fields = {} if state is None else {name: f"{state}{field}" for name, field in function.replaced.items()}
    places = [(o, fields.get(o.name, f"{result}{o.name}")) for o in function.outputs]
    return [f"{place}[{k}]" if o.shape else place for o, place in places for k in range(o.size)]


@dataclass(frozen=True, slots=True)
class PrintedPiece:
    """One regime in a language: named values (name, expression) and results, up to a limit of the switching input."""

    claim: str
    limit: float | None
    lets: list[tuple[str, str]]
    results: list[str]


@dataclass(frozen=True, slots=True)
class Writer:
    """A language in one type.

    largest, smallest : the ends of the finite numbers; by default the second is the first with a sign
    entry, first      : how an entry of an array is written, counted from which number
    arrays            : False where every input is an argument of its own
    """

    folder: str
    spelling: Spelling
    real: str
    largest: str
    smallest: str = ""
    entry: str = "{0}[{1}]"
    first: int = 0
    arrays: bool = True

    def render(self, template: str, **values: Any) -> str:
        """The text of a template of the language's folder, or of another one when it is named with the folder."""
        place = template if "/" in template else f"{self.folder}/{template}"
        return environment().get_template(f"{place}.j2").render(w=self, s=self.spelling, real=self.real, **values)

    def absolute(self, text: str) -> str:
        """The magnitude of an expression."""
        return self.spelling.calls["abs"].format(text)

    def names(self, function: ExportedFunction) -> list[str]:
        """The name of every input in code: a number by itself, or an entry of its array."""
        if not self.arrays:
            return [i.name for i in function.inputs]
        return [
            self.entry.format(a.name, self.first + k) if a.size else a.name
            for a in function.called_with
            for k in range(a.size or 1)
        ]

    def ends(self, function: ExportedFunction) -> list[tuple[str, str, str]]:
        """(name, least, greatest) of every input; the largest finite numbers where a range has no end."""
        least = self.smallest or f"-{self.largest}"
        return [
            (
                name,
                least if math.isinf(i.low) else self.spelling.number(i.low),
                self.largest if math.isinf(i.high) else self.spelling.number(i.high),
            )
            for name, i in zip(self.names(function), function.inputs, strict=True)
        ]

    def switch(self, function: ExportedFunction) -> str:
        """The input that decides between the regimes."""
        return self.names(function)[function.switch or 0]

    def pieces(self, function: ExportedFunction) -> list[PrintedPiece]:
        """The regimes in order."""
        names = self.names(function)
        made = [(piece, *assignments(piece, names, self.spelling)) for piece in function.pieces]
        return [PrintedPiece(p.source.claim, p.limit, [let[:2] for let in lets], results) for p, lets, results in made]

    def helpers(self, functions: Sequence[ExportedFunction], argument: str = "x") -> list[PrintedHelper]:
        """The parts with a hole that the functions need; ``argument`` is what the formula above the switch is of."""
        return [print_helper(part, real, self.spelling, argument) for part, real in helpers_used(*functions)]

    def columns(self, function: ExportedFunction, tests: Sequence[Vector], wide: Spelling) -> dict[str, list[str]]:
        """Inputs, status, lower, upper and nearest numbers of all vectors, one after the other; doubles as ``wide``."""
        found = {"inputs": [self.spelling.number(x) for v in tests for x in v.inputs]}
        found["status"] = [str(v.status) for v in tests]
        for part in ("lower", "upper", "nearest"):
            values = (x for v in tests for x in (getattr(v, part) or (0.0,) * function.size))
            found[part] = [wide.number(x) for x in values]
        return found


def read_words(language: str, real: str) -> dict[str, Any]:
    """The words of a language for a type."""
    words = {key: v[real] if isinstance(v, dict) and real in v else v for key, v in TABLE[language].items()}
    typed: dict[str, Any] = json.loads(json.dumps(words).replace("KIND", words["kind"]))
    return typed


def writer_of(language: str, real: str) -> Writer:
    """The language in a type."""
    words = read_words(language, real)
    table = calls(words.get("prefix", ""), words.get("ending", ""), **words.get("special", {}))
    spelling = Spelling(table, words["nan"], words["inf"], words.get("suffix", ""), words.get("exponent", "e"))
    layout = {key: words[key] for key in ("smallest", "entry", "first", "arrays") if key in words}
    return Writer(language, spelling, real, words["largest"], **layout)


def vectors_json(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]]) -> str:
    """All vectors as JSON; numbers that JSON does not have are strings."""

    def plain(values: Sequence[float]) -> str:
        shown = (repr(x) if math.isfinite(x) else f'"{x}"' for x in values)
        return f"[{', '.join(shown)}]"

    blocks = []
    for function in functions:
        rows = ",\n".join(
            f'    {{"in": {plain(v.inputs)}, "status": {v.status}, "lower": {plain(v.lower)}, '
            f'"upper": {plain(v.upper)}, "nearest": {plain(v.nearest)}}}'
            for v in tests[function.name]
        )
        blocks.append(f'  "{function.name}": [\n{rows}\n  ]')
    return "{\n" + ",\n".join(blocks) + "\n}\n"


def vectors_text(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]]) -> str:
    """One line a vector: name, status, arguments, lower, upper, nearest; for languages without JSON."""
    lines = []
    for function in functions:
        for v in tests[function.name]:
            tail = [x for part in (v.lower, v.upper, v.nearest) for x in (part or (0.0,) * function.size)]
            numbers = " ".join("NaN" if math.isnan(x) else repr(x) for x in (*v.inputs, *tail))
            lines.append(f"{function.name} {v.status} {numbers}")
    return "\n".join(lines) + "\n"


def short_names(functions: Sequence[ExportedFunction]) -> dict[str, str]:
    """Names of functions with at most 63 signs, which is what Fortran and MATLAB tell apart."""
    return {f.name: f"nv{k}_{f.name}"[:63] if len(f.name) > 63 else f.name for k, f in enumerate(functions)}


def calls_table(functions: Sequence[ExportedFunction], python: bool = False) -> str:
    """How the rows of vectors become calls, as a literal of JSON or of Python."""
    table = {
        f.name: {"arguments": [[a.first, a.size] for a in f.called_with], "state": state_record(f)} for f in functions
    }
    return repr(table) if python else json.dumps(table)
