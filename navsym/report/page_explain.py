"""Why a verdict: the record of a claim told step by step, with the arithmetic of its counterexample.

Everything is read off the record of ``navsym verify``; nothing is decided here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from navsym.report.page_arithmetic import Arithmetic, arithmetic, ball_words, ended

Record = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Step:
    """One step of an explanation: a heading, a sentence, and a formula where there is one."""

    heading: str
    words: str
    formula: str = ""


def steps(record: Record) -> list[Step]:
    """The whole story of one record of ``verify``, in the order in which a reader asks.

    Raises ValueError for a record that is no document of a claim.
    """
    found = [
        Step("What is printed", record["title"], record["printed"]),
        derived_step(record),
        Step("What was asked", question(record)),
        Step("How it was decided", decision(record)),
    ]
    if record["assumptions"]:
        found.append(Step("What it takes for granted", "; ".join(record["assumptions"])))
    if record["status"] == "REFUTED":
        found += counterexample_steps(record)
    if record["reason"]:
        found.append(Step("What went wrong" if record["slip"] else "Remark", slip_words(record)))
    if record["corrects"]:
        found.append(Step("What it corrects", f"It stands in the place of {record['corrects']}."))
    if record.get("certificate"):
        found.append(Step("Do not take our word", replay(record)))
    return found


def derived_step(record: Record) -> Step:
    """The derived side, or that there is none."""
    if not record["derived"]:
        return Step("What follows from the model", "The statement itself was derived and then examined.")
    return Step("What follows from the model", "Derived without looking at the printed side:", record["derived"])


def question(record: Record) -> str:
    """The quantifier in words."""
    scope = record["scope"] or "the numbers as they stand"
    if " +- " in record["printed"]:
        return f"Is the derived value within the printed tolerance, for {scope}?"
    if record["printed"].startswith("dual = "):
        return f"Is this the optimum of the guaranteed-estimation problem, for {scope}?"
    if not record["derived"]:
        return f"Does the printed relation hold, for {scope}?"
    if scope == "one point":
        return "Are the two sides equal for all values in the stated range? One point is enough to say no."
    return f"Are the two sides the same, for {scope}?"


METHODS = (
    (
        "exact point",
        "Exact points of the range were tried, each in ball arithmetic, which encloses every "
        "rounding error. At one of them the balls of the two sides have no point in common.",
    ),
    (
        "exact primal-dual",
        "Weights and dual were put into four conditions: the weights are unbiased, the instants "
        "lie inside the interval, the dual polynomial stays within its bounds, and both values are equal. Together "
        "they prove optimality without any solver.",
    ),
    (
        "normal form after signs",
        "Absolute values and roots of squares were replaced by what they are on the range, "
        "the signs being proved first; then the difference was reduced to its normal form.",
    ),
    (
        "normal form",
        "The difference of the sides was written as a quotient of polynomials with exact coefficients "
        "and multiplied out. Sines and cosines become powers of exp(i x), which leaves nothing to simplify by luck: "
        "two expressions are equal exactly when the numerator is the zero polynomial.",
    ),
    ("squares", "Both sides were proved to have one sign, and their squares were reduced to the same normal form."),
    ("derivative", "The derivatives of the two sides are the same on the range, and so is one value."),
    (
        "ball arithmetic",
        "The range was covered by balls, each with all rounding errors enclosed; none of them leaves room for failure.",
    ),
    ("sign on the box", "The sign was proved on the whole range, by factors of known sign or by halving the range."),
    ("sampling", "No proof was found. The statement was tried at exact points, which confirms and does not prove."),
    ("shape", "The two sides do not even have the same shape."),
    ("none", "Nothing decided it."),
)


def decision(record: Record) -> str:
    """What the method does, and what it found here."""
    method = record["method"]
    told = next((words for start, words in METHODS if method.startswith(start)), "")
    if not told:
        told = f"By an exact method of the derivation itself: {method}."
    evidence = f" Found: {record['evidence']}" if record["evidence"] else ""
    ending = "" if (told + evidence).endswith(".") else "."
    return f"{told}{evidence}{ending} Hence {record['status']}."


def counterexample_steps(record: Record) -> list[Step]:
    """The point of the counterexample, the entries that differ there, and the enclosure of the difference."""
    point = record["counterexample"] or {}
    where = ", ".join(f"{name} = {value}" for name, value in point.items())
    found = [Step("The counterexample", f"At {where}:" if where else "Nothing has to be inserted:")]
    for line in arithmetic(record):
        if line.differs:
            found.append(Step("", arithmetic_words(line)))
    if record["difference"]:
        low, high = record["difference"]
        value = f"is {ball_words((low, high))}" if low == high else f"lies between {low} and {high}"
        found.append(Step("", f"The side on the left minus the other {value}: not zero."))
    return found


def arithmetic_words(line: Arithmetic) -> str:
    """Both sides at the counterexample as a sentence."""
    start = f"Entry {line.entry}: the" if line.entry else "The"
    sides = f"printed side is {ball_words(line.printed)}, the derived side is {ball_words(line.derived)}"
    return ended(f"{start} {sides}")


def slip_words(record: Record) -> str:
    """Whose slip it is, and the reason."""
    place = {"paper": "A slip of the paper: ", "scan": "A slip of the scan, not of the authors: "}
    return place.get(record["slip"] or "", "") + record["reason"] + "."


def replay(record: Record) -> str:
    """How the certificate can be checked."""
    kind = record["certificate"].get("kind", "")
    return (
        f"A certificate of kind '{kind}' goes with this verdict. The report keeps it as a file; `navsym check` on that "
        "file replays it with a program of its own that shares no code with the one that decided."
    )
