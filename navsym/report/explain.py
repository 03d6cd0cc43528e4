"""Why a verdict: the record of a claim told step by step, with the arithmetic of its counterexample.

Everything is read off the record of ``navsym verify``; nothing is decided here.
"""

from __future__ import annotations

import contextlib
import functools
import html
import inspect
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import takewhile
from pathlib import Path
from typing import Any

from navsym.claims import Claim, Record
from navsym.claims.display import mark_verdict, write_card
from navsym.claims.paper import papers_folder
from navsym.claims.workspace import find_workspace
from navsym.core.answers import Answer, named
from navsym.core.balls import Tape, enclose, tape
from navsym.core.errors import NavsymError
from navsym.core.numbers import Number
from navsym.language.expression import parse, symbol
from navsym.language.names import RESERVED
from navsym.prove.wording import decimal_ends
from navsym.report.formula.sides import only_truth
from navsym.verification.decide import SECONDS, decide_claim_of, require_workers, sides
from navsym.verification.papers import find_claim


@dataclass(frozen=True, slots=True)
class Correction:
    """The claim that stands in the place of a refuted one: its id, what it says, and its formula where it has one."""

    id: str
    title: str
    formula: str | None


@dataclass(frozen=True, slots=True, repr=False)
class Explanation(Answer):
    """Why a claim has its verdict, step by step; ``str`` gives the words.

    record     : the verdict, decided now
    paper      : title of the paper
    source     : file and line of the derivation
    steps      : headings, sentences and formulas
    correction : what stands in the place of a refuted claim, or None
    """

    record: Record
    paper: str
    source: str
    steps: tuple[Step, ...]
    correction: Correction | None

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym explain``."""
        correction = self.correction
        head = named(self.record, "id status") | named(self, "paper source")
        head |= {"corrected_by": correction and correction.id, **named(self, "steps")}
        return head | {"correction": correction and named(correction, "title formula")}

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificate of the verdict, when it has one."""
        return [] if self.record.certificate is None else [self.record.certificate]

    def __str__(self) -> str:
        return "\n".join(f"{step.heading}: {step.words} {step.formula}".strip(": ") for step in self.steps)

    def __repr__(self) -> str:
        return f"<explanation of {self.record.id}: {self.record.status}, {len(self.steps)} steps>"

    def _repr_html_(self) -> str:
        lines = [f"<b>{html.escape(self.record.id)}</b> {mark_verdict(str(self.record.status))}"]
        for step in self.steps:
            head = f"<b>{html.escape(step.heading)}.</b> " if step.heading else ""
            formula = f" <code>{html.escape(step.formula)}</code>" if step.formula else ""
            lines.append(f"{head}{html.escape(step.words)}{formula}")
        return write_card(lines, str(self.record.status))


def explain(claim: str, *, seconds: float = SECONDS) -> Explanation:
    """Why a claim has its verdict: both sides, the question, the method, and the arithmetic of a counterexample.

    The claim is decided now. Numbers at a counterexample are computed again in balls from the text of the two sides.

    claim   : id such as "guaranteed_velocity:4.3.u2"
    seconds : limit of processor time; above it the verdict is OPEN

    Raises DomainError, with the ids that come closest, for an id that is none.

    >>> import navsym as nav
    >>> why = nav.explain("alpha_beta_filter:remark.critical")
    >>> why
    <explanation of alpha_beta_filter:remark.critical: REFUTED, 9 steps>
    >>> why.correction.id
    'alpha_beta_filter:remark.critical*'
    """
    require_workers(None, seconds)
    module, wanted = find_claim(claim)
    _, record = decide_claim_of(wanted.id, seconds)
    better = module.correction_of(wanted.id)
    correction = None if better is None else Correction(better.id, better.title, formula_of(better))
    return Explanation(record, module.paper.title, place_of(wanted), tuple(steps(record)), correction)


def place_of(claim: Claim) -> str:
    """File and line of a claim, from the workspace or the folder of the papers on."""
    if claim.place:
        return claim.place
    code, workspace = inspect.unwrap(claim.derive).__code__, find_workspace()
    file = Path(code.co_filename)
    roots = (papers_folder().parent, *([] if workspace is None else [workspace.root]))
    root = next((root for root in roots if file.is_relative_to(root)), file.parent)
    return f"{file.relative_to(root).as_posix()}:{code.co_firstlineno}"


def formula_of(claim: Claim) -> str | None:
    """The formula that a claim prints; None where its title says all."""
    printed, _ = sides(claim.derive())
    return None if only_truth(printed) else printed


# The arithmetic of a counterexample, done again in balls from the text of the two sides.
#
# So a reader sees numbers that the decision itself did not hand over.


LONGEST = 20_000
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
SURE = 12  # digits of an enclosure around a rounded number that is shown without its ends


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """One entry of a side of a claim, ready to be evaluated."""

    program: Tape
    names: frozenset[str]

    def at(self, point: Mapping[str, Any]) -> Any:
        """A ball that holds the value at a point; not finite where there is none."""
        return enclose(self.program, {symbol(name): value for name, value in point.items()})


@functools.lru_cache(maxsize=1024)
def read_side(text: str) -> Side:
    """An entry from its text; raises NavsymError for text outside the language."""
    expression = parse(text, {name: symbol(name) for name in NAME.findall(text) if name not in RESERVED})
    return Side(tape(expression), frozenset(s.name for s in expression.free_symbols))


@dataclass(frozen=True, slots=True, eq=False)
class Arithmetic:
    """Both sides of one entry, and their values at the counterexample."""

    entry: int
    sides: tuple[Side, Side]
    printed: Number
    derived: Number

    @property
    def differs(self) -> bool:
        """True when the two sides are apart: no number lies in both enclosures."""
        low, high = Fraction(self.printed.lower), Fraction(self.printed.upper)
        return high < Fraction(self.derived.lower) or Fraction(self.derived.upper) < low


def arithmetic(record: Record) -> list[Arithmetic]:
    """Values of both sides at the counterexample, for the entries that are numbers there."""
    if record.counterexample is None:
        return []
    left, right = record.printed.split(" +- ")[0], record.derived
    if not right and left.count(" = ") == 1:  # a whole equation was stated
        left, right = left.split(" = ")
    printed, derived = entries_of(left), entries_of(right)
    if not derived or len(printed) != len(derived):
        return []
    single, found = len(printed) == 1, []
    for place, pair in enumerate(zip(printed, derived, strict=True), start=1):
        with contextlib.suppress(NavsymError, ValueError, ArithmeticError, TypeError):
            if pair[0] != pair[1]:
                point = {name: read_side(value).at({}) for name, value in record.counterexample.items()}
                sides = read_side(pair[0]), read_side(pair[1])
                values = (value_at(side, point) for side in sides)
                found.append(Arithmetic(0 if single else place, sides, *values))
    return found


def value_at(side: Side, point: Mapping[str, Any]) -> Number:
    """Decimals below and above the value of a side at a point; raises ValueError where it is no finite number."""
    ball = side.at(point) if side.names <= point.keys() else None
    if ball is None or not ball.is_finite():
        raise ValueError("expected a finite number")
    return decimal_ends(ball)


def entries_of(text: str) -> list[str]:
    """Scalar entries of a side: those of a tuple or a matrix, or the text itself."""
    text = text.strip()
    if len(text) > LONGEST or not text:
        return []
    if text[0] not in "([":
        return [text]
    parts, depth, start = [], 0, 1
    for place, char in enumerate(text):
        depth += (char in "([") - (char in ")]")
        if depth == 0 and place < len(text) - 1:
            return [text]  # a bracket does not hold the whole
        if depth == 0 or (char == "," and depth == 1):
            parts.append(text[start:place])
            start = place + 1
    parts = [part for part in parts if part.strip()]
    if depth or (text[0] == "(" and len(parts) == 1):
        return [text]
    return [entry for part in parts for entry in entries_of(part)]


def ended(sentence: str) -> str:
    """The sentence with its full stop; cut digits end with an ellipsis already."""
    return sentence if sentence.endswith(("…", ".")) else sentence + "."


def number_words(value: Number) -> str:
    """``0.95885…`` for ends that agree so far, ``0.995`` for ends on both sides of it; both ends otherwise."""
    low, high = value.lower, value.upper
    if low == high:
        return low.rstrip("0").rstrip(".") if "." in low else low
    near = format(Decimal(f"{(Decimal(low) + Decimal(high)) / 2:.8g}").normalize(), "f")
    if value.digits >= SURE and Fraction(near) in value:
        return near
    shared = "".join(a for a, _ in takewhile(lambda pair: pair[0] == pair[1], zip(low, high, strict=False)))
    return f"{shared[:14]}…" if "." in shared and len(shared) > 6 else f"between {low} and {high}"


@dataclass(frozen=True, slots=True)
class Step:
    """One step of an explanation: a heading, a sentence, and a formula where there is one."""

    heading: str
    words: str
    formula: str = ""


#: What reports say of kinds, slips, verdicts and methods.
WORDS: dict[str, dict[str, str]] = tomllib.loads(Path(__file__).with_name("words.toml").read_text("utf-8"))


def steps(record: Record) -> list[Step]:
    """The whole story of one record of ``verify``, in the order in which a reader asks.

    Raises ValueError for a record that is no document of a claim.
    """
    found = [
        *side_steps(record),
        Step("What was asked", question(record)),
        Step("How it was decided", decision(record)),
    ]
    if record.assumptions:
        found.append(Step("What it takes for granted", "; ".join(record.assumptions)))
    if record.status == "REFUTED":
        found += counterexample_steps(record)
    if record.reason:
        words = f"{WORDS['slip'].get(record.slip or '', '')}{record.reason}."
        found.append(Step("What went wrong" if record.slip else "Remark", words))
    if record.cause:
        found.append(Step("Where it comes from", f"It repeats the slip of {record.cause}, where it is counted."))
    if record.corrects:
        found.append(Step("What it corrects", f"It stands in the place of {record.corrects}."))
    if record.certificate:
        found.append(Step("Do not take our word", replay(record)))
    return found


def side_steps(record: Record) -> list[Step]:
    """Both sides; "derived" is said only of a side that a derivation has made."""
    if record.paper.endswith(".toml"):
        right = [Step("What it is compared with", "The other side, as the file states it:", record.derived)]
        latex = [Step("What is printed", "In the LaTeX of the document:", record.latex)] if record.latex else []
        states = Step("What the file states", record.title, record.printed)
        return [*latex, states, *(right if record.derived else [])]
    derived = Step("What follows from the model", "Derived without looking at the printed side:", record.derived)
    whole = Step("What follows from the model", "The statement itself was derived and then examined.")
    heading = "What replaces it" if record.corrects else WORDS["opening"][record.kind]
    return [Step(heading, record.title, record.printed), derived if record.derived else whole]


def question(record: Record) -> str:
    """The quantifier in words."""
    scope = record.scope or "the numbers as they stand"
    if " +- " in record.printed:
        return f"Is the derived value within the printed tolerance, for {scope}?"
    if record.printed.startswith("dual = "):
        return f"Is this the optimum of the guaranteed-estimation problem, for {scope}?"
    if not record.derived:
        return f"Does the printed relation hold, for {scope}?"
    if scope == "one point":
        return "Are the two sides equal for all values in the stated range? One point is enough to say no."
    return f"Are the two sides the same, for {scope}?"


def decision(record: Record) -> str:
    """What the method does, and what it found here."""
    method = record.method
    told = next((words for start, words in WORDS["method"].items() if method.startswith(start)), "")
    if not told:
        told = f"By an exact method of the derivation itself: {method}."
    evidence = f" Found: {record.evidence}" if record.evidence else ""
    ending = "" if (told + evidence).endswith(".") else "."
    return f"{told}{evidence}{ending} Hence {record.status}."


def counterexample_steps(record: Record) -> list[Step]:
    """The point of the counterexample, the entries that differ there, and the enclosure of the difference."""
    where = record.point_text
    found = [Step("The counterexample", f"At {where}:" if where else "Nothing has to be inserted:")]
    for line in arithmetic(record):
        if line.differs:
            start = f"Entry {line.entry}: the" if line.entry else "The"
            first, second = ("printed", "derived") if record.derived else ("left", "right")
            printed, derived = number_words(line.printed), number_words(line.derived)
            found.append(Step("", ended(f"{start} {first} side is {printed}, the {second} side is {derived}")))
    if record.difference:
        low, high = record.difference.lower, record.difference.upper
        value = f"is {number_words(record.difference)}" if low == high else f"lies between {low} and {high}"
        found.append(Step("", f"The side on the left minus the other {value}: not zero."))
    return found


def replay(record: Record) -> str:
    """How the certificate can be checked."""
    kind = (record.certificate or {}).get("kind", "")
    return (
        f"A certificate of kind '{kind}' goes with this verdict. The report keeps it as a file; `navsym check` on that "
        "file replays it with a program of its own that shares no code with the one that decided."
    )
