"""Statements whose truth is known without the prover, and the judge of its verdicts.

A statement is text with declarations. What is known of it comes from a theorem and a change of known size, or from
interval arithmetic of mpmath; nothing here is shared with the package. Each statement follows from its number and
a seed alone.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

from tests.attacks.evaluator import PRECISIONS, UnsureError, evaluate, judge_at, judge_text, sign_of
from tests.attacks.trees import Tree, UnreadableError, names_in, read, read_relation

POINTS = 24


@dataclass(frozen=True)
class Statement:
    """A relation in the language of files.

    symbols : name -> ``"real"``, ``"positive"``, ``"nonnegative"``, ``"nonzero"``, or two ends; real when missing
    truth   : whether it holds wherever both sides are defined; None where nobody says
    witness : for a false one, a point where it fails, as far as one is known
    beside  : tolerance, existing expression and box, as the front door takes them
    """

    text: str
    truth: bool | None
    symbols: Mapping[str, Any] = field(default_factory=dict)
    witness: Mapping[str, str] | None = None
    family: str = ""
    beside: Mapping[str, Any] = field(default_factory=dict)

    def sides(self) -> tuple[Tree, str, Tree]:
        """Left side, relation and right side; with a tolerance, the distance of the sides and the tolerance."""
        left, relation, right = read_relation(self.text)
        if "tolerance" in self.beside:
            return ("abs", ("-", left, right)), "<=", read(self.beside["tolerance"])
        return left, relation, right

    def declared(self, name: str) -> Any:
        """What a name stands for: its range in the box, or its declaration."""
        return self.beside.get("box", {}).get(name) or self.symbols.get(name, "real")

    def names(self) -> set[str]:
        """The names in both sides."""
        left, _, right = self.sides()
        return names_in(left) | names_in(right)

    def judge_at(self, point: Mapping[str, str], precisions: Sequence[int] = PRECISIONS) -> str:
        """``holds``, ``fails`` or ``undefined`` where that is certain, else ``unknown``.

        ``outside`` where the declarations fail, or what must exist has no value: such a point does not count.
        """
        trees = {name: read(value) for name, value in point.items()}
        exists = read(self.beside.get("exists", "0"))
        known = judge_at(exists, "=", exists, trees)  # holds, or unknown where only equality is not settled
        if is_inside(self, point) is False or known == "undefined":
            return "outside"
        return judge_at(*self.sides(), trees, precisions)


Scheme = Callable[[random.Random], Statement]
SCHEMES: dict[str, Scheme] = {}


def family(name: str) -> Callable[[Scheme], Scheme]:
    """Register the scheme of a family."""

    def register(scheme: Scheme) -> Scheme:
        SCHEMES[name] = scheme
        return scheme

    return register


@lru_cache
def all_schemes() -> Mapping[str, Scheme]:
    """Every family with its scheme."""
    import tests.attacks.schemes.beside
    import tests.attacks.schemes.bounds
    import tests.attacks.schemes.daily
    import tests.attacks.schemes.domains
    import tests.attacks.schemes.identities
    import tests.attacks.schemes.thin
    import tests.attacks.schemes.values  # noqa: F401

    return dict(sorted(SCHEMES.items()))


def make_statement(number: int, seed: int) -> Statement:
    """The statement of a number; the families take turns. A draw that is settled by nobody is drawn again."""
    names = list(all_schemes())
    name = names[number % len(names)]
    for draw in range(100):
        rng = random.Random(f"{seed} {number} {draw}")
        try:
            return replace(all_schemes()[name](rng), family=name)
        except ArithmeticError:
            continue
    raise ValueError(f"no statement of the family {name}")


# -- Points ------------------------------------------------------------------------------------------------------------
SPECIAL = (
    "0", "1", "-1", "1/2", "-1/2", "2", "-2", "1/3", "pi", "-pi", "pi/2", "-pi/2", "2*pi", "-2*pi", "sqrt(2)", "exp(1)",
    "1e-9", "-1e-9", "1e-20", "-1e-20", "1e-30", "1000", "-1000", "1e9", "-3/7", "pi/6", "pi/4", "10", "7",
)  # fmt: skip
INSIDE = ("0", "1", "1/2", "1/3", "1e-3", "1 - 1e-3", "1e-10", "1 - 1e-10", "1e-30", "1 - 1e-30", "2/7", "sqrt(2)/2")


def draw_point(statement: Statement, rng: random.Random) -> dict[str, str]:
    """A point inside the declarations: special numbers, ends and their neighbours, coinciding values, any number."""
    point: dict[str, str] = {}
    for name in sorted(statement.names()):
        same = [other for other in point if statement.declared(other) == statement.declared(name)]
        if same and rng.random() < 0.2:
            point[name] = point[rng.choice(same)]
        else:
            point[name] = draw_value(statement.declared(name), rng)
    return point


def draw_value(declared: Any, rng: random.Random) -> str:
    """A number of one declaration, as text."""
    if isinstance(declared, str):
        value = rng.choice(SPECIAL) if rng.random() < 0.7 else str(Fraction(rng.randint(-999, 999), rng.randint(1, 99)))
        if declared in ("positive", "nonnegative"):
            value = value.removeprefix("-")
        return "1/7" if declared in ("positive", "nonzero") and value == "0" else value
    low, high = declared
    share = rng.choice(INSIDE) if rng.random() < 0.6 else str(Fraction(rng.randint(0, 1000), 1000))
    return {"0": low, "1": high}.get(share) or f"({low}) + (({high}) - ({low}))*({share})"


def is_inside(statement: Statement, point: Mapping[str, str]) -> bool | None:
    """Whether a point satisfies the declarations; None where that is not settled."""
    known: list[bool | None] = []
    for name, value in point.items():
        declared = statement.declared(name)
        if isinstance(declared, str):
            relation = {"positive": ">", "nonnegative": ">=", "nonzero": "!="}.get(declared)
            known.append(is_related(value, relation, "0") if relation else True)
        else:
            known += [is_related(declared[0], "<=", value), is_related(value, "<=", declared[1])]
    return False if False in known else None if None in known else True


def is_related(left: str, relation: str, right: str) -> bool | None:
    """Whether a relation of two constants holds; the same text is equal to itself."""
    if left == right:
        return relation in ("=", "<=", ">=")
    return {"holds": True, "fails": False}.get(judge_text(f"({left}) {relation} ({right})", {}))


# -- Judgements --------------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Judgement:
    """What becomes of one verdict.

    outcome : ``decided``, ``confirmed``, ``open``, ``refused``; ``false confirmed``; or ``wrong``
    """

    outcome: str
    status: str = ""
    why: str = ""


def attack(statement: Statement, seconds: float = 20.0) -> Judgement:
    """The judgement of what the front door says of a statement."""
    import navsym as nav

    try:
        verdict = nav.prove(statement.text, seconds=seconds, **statement.beside, **statement.symbols)
    except nav.NavsymError as error:
        return Judgement("refused", error.kind, str(error))
    except Exception as error:
        return Judgement("wrong", "crash", repr(error))
    return judge(statement, verdict)


def judge(statement: Statement, verdict: Any) -> Judgement:
    """The judgement of a verdict: by the known truth, by values, by the checker."""
    status = str(verdict.status)
    refused = refusal_of_certificates(verdict) or foreign_statement(statement, verdict)
    if status == "REFUTED":
        why = fault_of_counterexample(statement, verdict.counterexample) or refused
        return Judgement("wrong", status, why) if why else Judgement("decided", status)
    if status not in ("PROVED", "CERTIFIED", "CONFIRMED"):
        crashed = "Error" in verdict.evidence and "not decided" in verdict.evidence
        return Judgement("wrong" if crashed else "open", status, verdict.evidence)
    point = dict(statement.witness) if statement.witness is not None else None
    if statement.truth is False:
        why = f"false, by {point}" if point else "false"
    else:
        why = contradiction(statement, verdict.assumptions)
    if status == "CONFIRMED":
        return Judgement("false confirmed" if why else "confirmed", status, why)
    return Judgement("wrong", status, why or refused) if why or refused else Judgement("decided", status)


def refusal_of_certificates(verdict: Any) -> str:
    """Why the checker refuses a certificate of the verdict; empty when it accepts all."""
    from navsym.checker import Refused, check

    for certificate in verdict.certificates():
        try:
            check(dict(certificate))
        except Refused as error:
            return f"certificate refused: {error}"
    return ""


def foreign_statement(statement: Statement, verdict: Any) -> str:
    """Why a certificate is that of another statement; empty when it says what was typed, or states nothing."""
    said = (verdict.certificate or {}).get("statement")
    if said is None:
        return ""
    left, relation, right = read_relation(statement.text)
    if (read(said["left"]), said["relation"], read(said["right"])) != (left, relation, right):
        return f"certificate of another statement: {said['left']} {said['relation']} {said['right']}"
    for name, (low, high, flags) in said["symbols"].items():
        own = range_of(statement.declared(name))
        alike = flags == own[2] and is_same_end(low, own[0]) and is_same_end(high, own[1])
        if "box" not in statement.beside and not alike:
            return f"certificate with other declarations: {name} from {low} to {high} {flags}"
    if not statement.names() <= set(said["symbols"]):
        return f"certificate without a declaration: {sorted(said['symbols'])}"
    tolerance, exists = statement.beside.get("tolerance"), statement.beside.get("exists")
    wanted = (None if tolerance is None else read(tolerance)), [read(exists)] if exists else []
    given = (None if said["tolerance"] is None else read(said["tolerance"])), [read(text) for text in said["exists"]]
    return "" if wanted == given else f"certificate with other conditions: {said['tolerance']}, {said['exists']}"


def is_same_end(written: str | None, declared: str | None) -> bool:
    """Whether two texts are one number, as far as intervals tell: -(1/10) is written -1/10."""
    if written is None or declared is None:
        return written is declared
    return sign_of(evaluate(read(f"({written}) - ({declared})"), {}, PRECISIONS[-1])) in (0, None)


def range_of(declared: Any) -> list[Any]:
    """A declaration as certificates write it: lower end, upper end, flags."""
    if not isinstance(declared, str):
        return [*declared, []]
    low = "0" if declared in ("positive", "nonnegative") else None
    flags = {"positive": ["open-low"], "nonzero": ["nonzero"]}.get(declared, [])
    return [low, None, flags]


def fault_of_counterexample(statement: Statement, given: Mapping[str, str] | None) -> str:
    """What is wrong with a counterexample; empty when the statement may fail there."""
    if statement.truth is True:
        return f"true, but REFUTED at {dict(given or {})}"
    point = {name: str((given or {}).get(name, default_of(statement, name))) for name in statement.names()}
    try:
        found = statement.judge_at(point)
    except UnreadableError as error:
        return f"counterexample {dict(given or {})} is not read: {error}"
    _, relation, _ = statement.sides()
    if found == "fails" or (found == "unknown" and relation != "="):
        return ""  # sides that coincide are told apart by no interval
    if statement.truth is False and not statement.names() <= set(given or {}):
        return ""  # false, and refuted without a point: at a root that no formula gives
    return f"at its counterexample {point}: {found}"


def default_of(statement: Statement, name: str) -> str:
    """A value for a name that a counterexample leaves out."""
    declared = statement.declared(name)
    return "1" if isinstance(declared, str) else declared[0]


def contradiction(statement: Statement, assumptions: tuple[str, ...] | list[str]) -> str:
    """A point where a statement that was said to hold fails, or has no value though no assumption excludes it."""
    rng = random.Random(statement.text)
    for _ in range(POINTS if statement.names() else 1):
        point = draw_point(statement, rng)
        found = statement.judge_at(point, PRECISIONS[:2] if statement.names() else PRECISIONS)
        if found == "fails" and is_inside(statement, point):
            return f"fails at {point}"
        if found == "undefined" and is_inside(statement, point) and not is_excluded(point, assumptions):
            return f"has no value at {point}, and no assumption says so: {list(assumptions)}"
    return ""


def is_excluded(point: Mapping[str, str], assumptions: tuple[str, ...] | list[str]) -> bool:
    """Whether an assumption fails at the point, or may fail, or is written in words."""
    return any(judge_text(assumption, point) != "holds" for assumption in assumptions)


def find_failure(statement: Statement, tries: int = 60) -> Statement:
    """The statement with a witness, sought at awkward points; raises ArithmeticError when none is found."""
    rng = random.Random(statement.text)
    for _ in range(tries if statement.names() else 1):
        point = draw_point(statement, rng)
        if statement.judge_at(point) == "fails" and is_inside(statement, point):
            return replace(statement, witness=point)
    raise UnsureError("no witness")


def truth_of_constants(text: str) -> bool:
    """Whether a relation without names holds; raises ArithmeticError where no precision tells."""
    found = judge_text(text, {})
    if found not in ("holds", "fails"):
        raise UnsureError(f"{text}: {found}")
    return found == "holds"
