"""Commands of notebooks, after ``%load_ext navsym``: ``%prove``, ``%%claims`` for a cell, ``%audit`` for code."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import navsym as nav
from navsym.cli import audit as audit_verb
from navsym.cli import prove as prove_verb
from navsym.cli.diff import read_ranges
from navsym.core.errors import EmptyError, ExpressionSyntaxError, NavsymError
from navsym.language.names import quote

if TYPE_CHECKING:
    from navsym.audit.answer import Audit
    from navsym.claims import Verdict, Verdicts

FUNCTION = re.compile(r"\s+--function\s+")
RANGE = re.compile(r"\s+--range[\s=]+")
OPTION = re.compile(r"[<>=].*\s(--[A-Za-z]\S*)")
#: A cell with a line that begins like this is a claim file; any other has a formula on each line.
TABLE = re.compile(r"^\s*\[+\s*(symbols|claim|rates)\b", re.M)


def register_magics(shell: Any) -> None:
    """Add the commands to a shell of IPython, and tables of their answers where it has no pages."""
    from IPython.core.error import UsageError

    def refuse_shortly(work: Callable[[str], Any], text: str) -> Any:
        try:
            return work(text)
        except NavsymError as error:
            raise UsageError(f"{error.kind}: {error}") from None

    def prove(line: str) -> Verdict:
        """Decide one formula: ``%prove sin(T) <= T --range T=0,pi``; names without a range are real."""
        return refuse_shortly(prove_line, line)

    def claims(line: str, cell: str) -> Verdicts:
        """Decide a cell of TOML, of a formula a line, or of LaTeX; ``%%claims name`` keeps the verdicts by a name.

        ``%%claims --definitions`` takes ``K = ...`` in LaTeX, where K stands nowhere before, as a definition.
        """
        words = line.split()
        name = " ".join(word for word in words if word != "--definitions")
        if name and not name.isidentifier():
            raise UsageError(f"syntax: %%claims: expected nothing or one name; got {quote(name)}; correct it")
        verdicts = refuse_shortly(partial(prove_cell, definitions="--definitions" in words), cell)
        if name:
            shell.push({name: verdicts})
        return verdicts

    def audit(line: str) -> Audit:
        """Decide the questions of a file: ``%audit spec.toml``; ``%audit ekf.c --function NAME`` lists formulas."""
        return refuse_shortly(audit_line, line)

    for magic, kind in ((audit, "line"), (prove, "line"), (claims, "cell")):
        shell.register_magic_function(magic, kind, magic.__name__)
    plain = shell.display_formatter.formatters["text/plain"]
    for home, name, verb in (("claims.verdict", "Verdicts", prove_verb), ("audit.answer", "Audit", audit_verb)):
        plain.for_type_by_name(f"navsym.{home}", name, lambda found, page, _, say=verb.as_text: page.text(say(found)))


def prove_line(line: str) -> Verdict:
    """The verdict of a formula with its ranges; raises NavsymError for what is none."""
    formula, *texts = RANGE.split(line.strip())
    if option := OPTION.search(formula):
        got = quote(option[1])
        raise ExpressionSyntaxError(f"expected --range NAME=LOWER,UPPER; got {got}; leave it out", where="prove")
    return nav.prove(formula, **read_ranges(texts))


def audit_line(line: str) -> Audit:
    """The verdicts on a specification, or the formulas of a function; raises NavsymError for what is neither."""
    file, *names = FUNCTION.split(line.strip())
    if len(names) > 1:
        raise ExpressionSyntaxError(f"expected one function; got {len(names)}; ask for one at a time", where="%audit")
    return nav.audit(file.strip("\"'"), function=names[0].strip() if names else None)


def prove_at(number: int, line: str) -> Verdict:
    """The verdict of a line of a cell, whose id is that line."""
    try:
        verdict = prove_line(line.removesuffix(r"\\"))
    except NavsymError as error:
        raise error.at(f"cell: line {number}") from None
    formula = verdict.formula and replace(verdict.formula, id=f"line {number}")
    return replace(verdict, formula=formula)


def prove_cell(text: str, definitions: bool = False) -> Verdicts:
    """The verdicts of a claim file in memory, of formulas one a line, or of LaTeX below its tables.

    Raises NavsymError for what is none of these.
    """
    from navsym.claims import Verdicts
    from navsym.language.latex.reading import DELIMITED
    from navsym.language.tomlfile import parse_toml
    from navsym.prove.claimfile import claims_from, decide_claims

    formulas = None if "[[claim]]" in text else DELIMITED.search(text)
    if formulas is None and TABLE.search(text) is None:
        lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
        if not lines:
            raise EmptyError("expected a formula or [[claim]] blocks; got nothing; write one", where="cell")
        return Verdicts(tuple(prove_at(number, line) for number, line in lines))
    text = read_cell(text, formulas.start(), definitions) if formulas else text
    return decide_claims(claims_from(parse_toml(text, "cell"), "cell", go_on=True))


def read_cell(text: str, start: int, definitions: bool) -> str:
    """The claim file of formulas in LaTeX, behind ``[symbols]`` and ``[latex]`` where these are given."""
    from navsym.language.latex.reading import read_with_reals
    from navsym.language.tomlfile import parse_toml

    tables = parse_toml(text[:start], "cell") if TABLE.search(text[:start]) else {}
    blank = re.sub(r"[^\n]", " ", text[:start])
    reading = read_with_reals(blank + text[start:], tables.get("symbols", {}), tables.get("latex"))
    refused = next((formula for formula in reading.formulas if formula.status != "READ"), None)
    if refused is not None:
        raise ExpressionSyntaxError(str(refused.why), where="cell")
    return reading.claims(definitions=definitions)
