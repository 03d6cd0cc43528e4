"""The answer of an audit: what was read, and the verdict on each entry of each question."""

from __future__ import annotations

import html
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from navsym.audit.cases import Case
from navsym.audit.decide import Decision, Scope, decide_entry, decide_together, measure
from navsym.audit.form import spell_alike, spell_entry
from navsym.audit.meaning import list_meaningless
from navsym.audit.mend import Budget, suggest
from navsym.audit.names import Names
from navsym.audit.questions import SENSES, Entry, Question, is_used, list_entries, read_question
from navsym.audit.senses import weaken
from navsym.audit.sources import Source, find_function, load_unit, read_source
from navsym.audit.values import Cell, Scalar, Unread, places_of
from navsym.claims.display import write_table
from navsym.claims.verdict import CERTIFIED, OPEN, PROVED, REFUTED, Status
from navsym.core.answers import Answer, named
from navsym.core.errors import ExpressionSyntaxError, ShapeError
from navsym.language.files import name_file
from navsym.language.names import expect_keys, join_place, quote, require_path
from navsym.language.printer import print_tree
from navsym.language.schema import as_table, require_distinct, require_key
from navsym.language.tomlfile import read_toml
from navsym.language.tree import Tree, list_names

MOST = 200  # questions of a file
LONGEST = 20_000  # characters of a formula that is shown


@dataclass(frozen=True, slots=True)
class AuditedFile:
    """How far a source was read: statements of the functions asked about, and the refused lines with reasons."""

    file: str
    language: str
    statements: int
    refused: tuple[tuple[int, str], ...]
    unread: int

    def document(self) -> dict[str, Any]:
        """The file as plain data."""
        refused = [{"line": line, "why": why} for line, why in self.refused]
        return {**named(self, "file language statements"), "read": self.statements - self.unread, "refused": refused}


@dataclass(frozen=True, slots=True)
class AuditedEntry:
    """The verdict on one entry.

    entry          : row and column, from 1
    file, line     : where the code assigns it
    counterexample : of REFUTED, spelling of an input -> exact number
    values         : of REFUTED, the code's value and the expected one there
    suggestion     : of REFUTED, the mended right side of the assignment; the mended entry is proved
    why            : of OPEN, the reason; of a case, its conditions; of a weaker sense, what it says
    weaker         : of an entry that does not hold, a sense in which the whole question would hold
    tree           : what the entry should be; None in cases, and where it is not read
    """

    entry: tuple[int, int]
    file: str
    line: int
    status: Status
    sense: str = "exact"
    counterexample: Mapping[str, str] | None = None
    values: tuple[str, str] | None = None
    suggestion: str | None = None
    why: str = ""
    certificate: Mapping[str, Any] | None = None
    weaker: str | None = None
    tree: Tree | None = None

    @property
    def expected(self) -> str | None:
        """What the entry should be, in the symbols of the question; None in cases, and where it is not read."""
        return None if self.tree is None else print_tree(self.tree)

    def document(self) -> dict[str, Any]:
        """The entry as plain data."""
        return {**named(self, "entry file line status counterexample values suggestion"), "why": self.why or None}

    def remark(self) -> str:
        """The ground of the verdict in one line."""
        if self.status == REFUTED and self.values:
            point = ", ".join(f"{name} = {value}" for name, value in (self.counterexample or {}).items())
            mend = f"; write {self.suggestion}" if self.suggestion else ""
            case = f" ({self.why})" if self.why else ""
            return f"is {self.values[0]}, expected {self.values[1]} at {point or 'any point'}{case}{mend}"
        return self.why or self.sense


@dataclass(frozen=True, slots=True)
class AuditedQuestion:
    """A question with the verdicts on its entries; its own is the worst of them.

    inputs : symbol -> how the source spells it, and its declaration; in the order of the function's arguments
    assumptions : what the answer takes for granted of the code, such as ``taken as real: T``
    """

    name: str
    kind: str
    entries: tuple[AuditedEntry, ...]
    inputs: Mapping[str, tuple[str, Any]] = field(default_factory=dict)
    assumptions: tuple[str, ...] = ()

    @property
    def status(self) -> Status:
        """REFUTED, OPEN, CERTIFIED or PROVED, the first that occurs."""
        present = {entry.status for entry in self.entries}
        return next((status for status in (REFUTED, OPEN, CERTIFIED) if status in present), PROVED)

    @property
    def sense(self) -> str:
        """The weakest sense that was needed."""
        return max((entry.sense for entry in self.entries), key=SENSES.index, default="exact")

    @property
    def weaker(self) -> str | None:
        """The strongest sense in which the question would hold if it admitted it; None where there is none."""
        return next((entry.weaker for entry in self.entries if entry.weaker), None)

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificates of the entries, each once."""
        several = [entry.certificate for entry in self.entries if entry.certificate is not None]
        parts = [part for whole in several for part in (whole["of"] if whole["kind"] == "all" else [whole])]
        return [*{id(part): part for part in parts}.values()]

    def document(self, every: bool = False) -> dict[str, Any]:
        """The question as plain data; entries that are PROVED only on demand, ``weaker`` only where there is one."""
        entries = [entry.document() for entry in self.entries if every or entry.status != PROVED]
        known = {**named(self, "name kind status sense" + " weaker" * bool(self.weaker)), "entries": entries}
        return {**known, "assumptions": [*self.assumptions]}


@dataclass(frozen=True, slots=True)
class OutputFormula:
    """An output of a function as a formula of its inputs, in the spelling of the source."""

    name: str
    line: int
    formula: str
    case: str

    def document(self) -> dict[str, Any]:
        """The formula as plain data."""
        return {**named(self, "name line formula"), "case": self.case or None}


@dataclass(frozen=True, slots=True, repr=False)
class Audit(Answer):
    """What an audit found.

    files     : what was read of each source
    questions : the verdicts
    formulas  : the outputs of a function, where no question was asked
    assumptions : what the answer takes for granted of the code
    meaningless : place and reason of every formula that the declared units and frames do not allow
    """

    files: tuple[AuditedFile, ...]
    questions: tuple[AuditedQuestion, ...] = ()
    formulas: tuple[OutputFormula, ...] = ()
    assumptions: tuple[str, ...] = ()
    meaningless: tuple[tuple[str, str], ...] = ()

    @property
    def holds(self) -> bool:
        """True when no question is REFUTED or OPEN, and no formula is meaningless."""
        return all(question.status.holds for question in self.questions) and not self.meaningless

    def __getitem__(self, name: str) -> AuditedQuestion:
        return next(question for question in self.questions if question.name == name)

    def __repr__(self) -> str:
        counts = ", ".join(f"{q.name}: {q.status}" for q in self.questions)
        return f"<audit of {', '.join(Path(f.file).name for f in self.files)}; {counts or 'formulas'}>"

    def tables(self, every: bool = False) -> list[tuple[str, tuple[str, ...], list[Any]]]:
        """Title, heads and rows of what people see; of the entries those that fail, or all."""
        files = [(f.file, f.language, f"{f.statements - f.unread} of {f.statements}") for f in self.files]
        refused = [(f"{f.file}:{line}", why) for f in self.files for line, why in f.refused]
        outputs = [(f.name, str(f.line or ""), f.formula, f.case) for f in self.formulas]
        found: list[tuple[str, tuple[str, ...], list[Any]]] = [
            ("", ("file", "language", "statements read"), files),
            ("", ("not read", "because"), refused),
            ("", ("taken for granted",), [(t,) for t in self.assumptions if not self.questions]),
            ("", ("output", "line", "formula", "case"), outputs),
            ("", ("meaningless", "because"), [*self.meaningless]),
        ]
        for q in self.questions:
            title = f"{q.name} ({q.kind}): {q.status}, {sum(e.status.holds for e in q.entries)} of {len(q.entries)}"
            title += f" entries proved, {q.sense}" if q.status.holds else " entries proved"
            title += f"; {'; '.join(q.assumptions)}" if q.assumptions else ""
            shown = ((e, Path(e.file).name) for e in q.entries if every or not e.status.holds)
            rows = [(f"{e.entry[0]},{e.entry[1]}", f"{f}:{e.line}", str(e.status), e.remark()) for e, f in shown]
            found.append((title, ("entry", "place", "verdict", "remark"), rows))
        return found

    def _repr_html_(self) -> str:
        shown = [(html.escape(title), heads, rows) for title, heads, rows in self.tables() if title or rows]
        return "".join((f"<p>{t}</p>" if t else "") + (write_table(h, r) if r else "") for t, h, r in shown)

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificates of all entries that have one."""
        return [certificate for question in self.questions for certificate in question.certificates()]

    def list_failures(self) -> list[str]:
        """``file:line: message`` for every entry that is REFUTED or OPEN."""
        failing = ((q.name, e) for q in self.questions for e in q.entries if not e.status.holds)
        return [f"{e.file}:{e.line}: {name}[{e.entry[0]},{e.entry[1]}] {e.status}: {e.remark()}" for name, e in failing]

    def annotations(self) -> list[str]:
        """The failures, and ``file:line: message`` for every refused line."""
        meaningless = [f"{place}: {why}" for place, why in self.meaningless]
        unread = [f"{f.file}:{n}: not read: {why}" for f in self.files for n, why in f.refused]
        return [*self.list_failures(), *meaningless, *unread]

    def document(self, every: bool = False) -> dict[str, Any]:
        """The JSON document of ``navsym audit``."""
        document: dict[str, Any] = {"read": {"files": [file.document() for file in self.files]}}
        document["questions"] = [question.document(every) for question in self.questions]
        if self.meaningless:
            document["meaningless"] = [{"place": place, "why": why} for place, why in self.meaningless]
        document["assumptions"] = [*self.assumptions]
        return {**document, "formulas": [f.document() for f in self.formulas]} if self.formulas else document


def audit(path: str | os.PathLike[str], /, function: str | None = None) -> Audit:
    """The formulas of source code, and the verdicts on questions about them.

    path     : a file of questions (TOML); or a source in C, C++, Python, MATLAB or Rust
    function : of a source, whose outputs are wanted as formulas of its inputs

    The source is read by its grammar and run on symbols, case by case. Nothing is compiled or executed. A line outside
    the language of audit is refused with its reason, and what depends on it is OPEN. Numbers of the source are taken
    as real numbers, arrays that are passed apart as apart from each other. Each entry of a question is PROVED
    with a certificate, REFUTED by an exact point, or OPEN.

    Returns an Audit: its ``files``, ``questions`` by name, ``formulas``. Raises NavsymError for what is no
    specification and no source.

    >>> import navsym as nav
    >>> report = nav.audit("examples/audit/yaw_jacobian.toml")
    >>> report["transition"].status, report["transition"].entries[2].line
    (<Status.REFUTED: 'REFUTED'>, 14)
    >>> [entry.suggestion for entry in report["transition"].entries if entry.suggestion]
    ['-v * sinf(x[2]) * dt']
    """
    where = require_path(path, "audit: path")
    if function is not None:
        unit = load_unit(where)
        source = Source("code", unit, find_function(unit, function, "audit: function"), Names(), {}, frozenset(), ())
        formulas = tuple(list_formulas(source))
        return Audit(describe_files([source]), (), formulas, tuple(source.assumptions()))
    if where.suffix != ".toml":
        message = f"expected a specification (TOML), or a source with the name of a function; got {quote(where.name)}; "
        raise ExpressionSyntaxError(f"{message}add --function NAME", where="audit")
    return audit_specification(where)


def audit_specification(path: Path, only: str | None = None) -> Audit:
    """The verdicts on the questions of a file, or on the one of a name."""
    document, where = read_toml(path), name_file(path)
    expect_keys(document, ("code", "question"), where)
    names, by_name = read_sources(document, path.parent, where)
    place = join_place(where, "question")
    blocks = enumerate(read_blocks(document, "question", where))
    questions = [read_question(block, by_name, names, path.parent, join_place(place, i)) for i, block in blocks]
    require_distinct((question.name for question in questions), place)
    chosen = [question for question in questions if only in (None, question.name)]
    noted = names.units or names.frames
    entries = [entry for question in chosen for entry in list_entries(question)] if noted else []
    meaningless = list_meaningless(names, [*by_name.values()], entries)
    answered = tuple(map(answer_question, chosen))
    assumptions = dict.fromkeys(text for question in answered for text in question.assumptions)
    return Audit(describe_files([*by_name.values()]), answered, (), tuple(assumptions), (*meaningless,))


def read_sources(document: Mapping[str, Any], folder: Path, where: str) -> tuple[Names, dict[str, Source]]:
    """The blocks ``[[code]]`` of a file, by their names, and the table of names that they share."""
    names, place = Names(), join_place(where, "code")
    blocks = read_blocks(document, "code", where)
    sources = [read_source(block, folder, names, join_place(place, i)) for i, block in enumerate(blocks)]
    require_distinct((source.name for source in sources), place)
    return names, {source.name: source for source in sources}


def read_blocks(document: Mapping[str, Any], key: str, where: str) -> list[Any]:
    """The blocks ``[[code]]`` or ``[[question]]``."""
    blocks = require_key(dict(document), key, where)
    if not isinstance(blocks, list):
        message = f"expected [[{key}]] blocks; got a single one; write double brackets"
        raise ShapeError(message, where=join_place(where, key))
    if len(blocks) > MOST:
        raise ShapeError(f"expected at most {MOST} blocks; got {len(blocks)}; split the file", where=where)
    return [as_table(block, join_place(join_place(where, key), i)) for i, block in enumerate(blocks)]


def describe_files(sources: Sequence[Source]) -> tuple[AuditedFile, ...]:
    """What was read of each file that the sources have read."""
    units = {source.unit.file: source.unit for source in sources}
    done = []
    for file, unit in units.items():
        readings = [source.read() for source in sources if source.unit.file == file]
        met = set().union(*(reading.met for reading in readings))
        unread = set().union(*(reading.refused_spans for reading in readings)) & met
        refused = {line: why for reading in readings for line, why in reading.refused.items()}
        for name in (file, *(piece[2] for piece in unit.pieces)):
            spans = {span for span in met if unit.locate(1 + unit.source.count(b"\n", 0, span[0]))[0] == name}
            lines = {unit.locate(line)[1]: why for line, why in refused.items() if unit.locate(line)[0] == name}
            if name == file or spans or lines:
                refusals = tuple(sorted(lines.items()))
                done.append(AuditedFile(name, unit.language, len(spans), refusals, len(unread & spans)))
    return tuple(done)


def answer_question(question: Question) -> AuditedQuestion:
    """The verdicts on the entries of a question; of several cases the worst stands for the entry."""
    relations, entries = question.relations(), list_entries(question)
    scopes = [make_scope(question.names, entry, relations) for entry in entries]
    cells = [(e.code, e.expected) for e in entries]
    pairs = {(x.tree, y.tree): None for x, y in cells if isinstance(x, Scalar) and isinstance(y, Scalar)}
    decided: dict[Any, Decision] = {**decide_together([*pairs], scopes[0])} if entries else {}
    decisions = [decide_cells(entry, scope, decided) for entry, scope in zip(entries, scopes, strict=True)]
    weaken(question, entries, decisions, scopes)
    worst: dict[tuple[int, int], AuditedEntry] = {}
    budget = Budget()
    order = (PROVED, CERTIFIED, OPEN, REFUTED)
    for entry, scope, decision in zip(entries, scopes, decisions, strict=True):
        answer = write_answer(question, entry, scope, decision, budget)
        if (known := worst.get(entry.place)) is None or order.index(answer.status) > order.index(known.status):
            worst[entry.place] = answer
    several = (s.assumptions() for s in question.sources.values() if is_used(s.name, question.keys))
    taken = tuple(dict.fromkeys(text for texts in several for text in texts))
    return AuditedQuestion(question.name, question.kind, tuple(worst.values()), question.inputs(), taken)


def decide_cells(entry: Entry, scope: Scope, decided: dict[Any, Decision]) -> Decision:
    """The verdict on one entry in one case, as it stands."""
    code, expected = entry.code, entry.expected
    for cell in (code, expected):
        if isinstance(cell, Unread):
            return Decision(OPEN, why=f"not read: {cell.why}")
    assert isinstance(code, Scalar) and isinstance(expected, Scalar)
    if (code.tree, expected.tree) in decided:  # for all points, whatever the conditions
        return decided[code.tree, expected.tree]
    key = (code.tree, expected.tree, entry.conditions)
    if key not in decided:
        decided[key] = decide_entry(code.tree, expected.tree, scope)
    return decided[key]


def write_answer(question: Question, entry: Entry, scope: Scope, decision: Decision, budget: Budget) -> AuditedEntry:
    """The verdict on one entry with its line, and with a mend where it is refuted."""
    unit = entry.source.unit if entry.source else next(iter(question.sources.values())).unit
    line = next((cell.line for cell in (entry.code, entry.expected) if isinstance(cell, Unread)), None)
    if line is None:
        line = entry.code.line or entry.expected.line or (entry.source.function.line if entry.source else 0)
    point, suggestion, why = None, None, decision.why
    if decision.status == REFUTED:
        spelled = question.names.spellings
        point = {spell_alike(unit, spelled.get(n, n)): value for n, value in (decision.point or {}).items()}
        if (mend := suggest(entry, scope, budget)) is not None:
            line, suggestion = mend.line, mend.text
        why = "; ".join(filter(None, (describe_case(entry), why)))
    right = None if isinstance(entry.expected, Unread) or entry.conditions else entry.expected.tree
    return AuditedEntry(
        entry.place, *unit.locate(line), decision.status, decision.sense, point, decision.values, suggestion, why,
        decision.certificate, decision.weaker, right,
    )  # fmt: skip


def describe_case(case: Entry | Case) -> str:
    """The conditions of a case in words."""
    return " and ".join(c.text if c.holds else f"not {c.text}" for c in case.conditions)


def make_scope(names: Names, entry: Entry, relations: tuple[Any, ...]) -> Scope:
    """Ranges, relations and conditions under which an entry is decided; relations of other symbols do not count."""
    trees = [c.tree for c in (entry.code, entry.expected) if isinstance(c, Scalar)] if relations else []
    used = set(list_names(*trees, *(t for c in entry.conditions for t in (c.left, c.right) if t is not None)))
    near = tuple(relation for relation in relations if used & set(list_names(relation)))
    return Scope(names.ranges(), near, entry.conditions, rotations=tuple(names.rotations.values()))


# The outputs of a function as formulas, when nothing is asked


def list_formulas(source: Source) -> Iterator[OutputFormula]:
    """What the function returns, and what it assigns to parameters, members and globals, case by case."""
    for case in source.read().cases:
        for name, cell in list_outputs(source, case):
            text = f"not read: {cell.why}" if isinstance(cell, Unread) else ""
            if isinstance(cell, Scalar) and measure(cell.tree) > LONGEST:
                text = "not shown: a formula of more than 20,000 characters"
            elif isinstance(cell, Scalar):
                text = source.names.show(print_tree(cell.tree))
            yield OutputFormula(name, cell.line, text, describe_case(case))


def list_outputs(source: Source, case: Case) -> Iterator[tuple[str, Cell]]:
    """Names of outputs with their values."""
    if (value := case.returned) is not None:
        pairs = zip(places_of(value.shape), value.cells, strict=True)
        yield from ((spell_entry(source.unit, "return", place), cell) for place, cell in pairs)
    for name, variable in case.variables.items():
        for place, cell in sorted(variable.cells.items()):
            is_output = variable.is_input or name in source.function.outputs
            if is_output and (isinstance(cell, Unread) or cell.line):
                yield spell_entry(source.unit, name, place), variable.all_unread or cell
