"""Terms, ranges and conditions of the checker, written for Coq's library of real numbers."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping

from flint import fmpq

from navsym import checker
from navsym.checker import Range, Term

#: Words of Coq and of its libraries of reals that no symbol may be called.
RESERVED = frozenset(
    "Abs Admitted All Axiom Definition End Fixpoint IZR INR In Inductive Lemma Let Ltac Module PI Proof Prop Qed R R0 "
    "R1 Rabs Rdefinitions Require Section Set Theorem Type Variable acos all as asin at atan cofix cos cosh cot else "
    "end exists exists2 exp few_digits fix for forall fun if in let ln many_digits mat match mod nat nonzero not "
    "number numbers or pow product_over return sin sinh split sqr sqrt sum_over tan tanh then turn unit using where "
    "with zeros".split()
)
FUNCTIONS = {
    "sin": "sin", "cos": "cos", "tan": "tan", "exp": "exp", "log": "ln", "sqrt": "sqrt", "abs": "Rabs",
    "asin": "asin", "acos": "acos", "atan": "atan", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh",
}  # fmt: skip
INVERSES = {"sec": "cos", "csc": "sin"}
RELATIONS = {"=": "=", "!=": "<>", "<": "<", "<=": "<=", ">": ">", ">=": ">="}
#: Digits of one number.
MOST_DIGITS = 400


class Unwritten(Exception):
    """No theorem or script is written for a certificate; the text says why."""


def rename(box: Collection[str]) -> dict[str, str]:
    """Names in Coq: the same, or with an underscore where the word is taken."""
    names: dict[str, str] = {}
    for name in box:
        new = name
        while new in RESERVED or new in names.values() or (new != name and new in box):
            new += "_"
        names[name] = new
    return names


def ranges(box: Mapping[str, Range], names: Mapping[str, str]) -> Iterator[str]:
    """The ranges of the symbols as hypotheses."""
    for name, limit in box.items():
        if limit.integer:
            yield f"(exists k : Z, {names[name]} = IZR k)"
        for end, is_open, (first, last) in (
            (limit.low, limit.open_low, ("{0}", names[name])),
            (limit.high, limit.open_high, (names[name], "{0}")),
        ):
            if end is not None:
                yield f"{first} {'<' if is_open else '<='} {last}".format(write_term(end, names))
        if limit.nonzero:
            yield f"{names[name]} <> 0"


def defined(terms: Iterable[Term], names: Mapping[str, str]) -> list[str]:
    """What has to hold for all terms to be defined, as hypotheses."""
    pairs = checker.set_union(checker.conditions(term) for term in terms)
    return [f"{write_term(term, names)} {RELATIONS[relation]} 0" for relation, term in pairs]


def write_term(term: Term, names: Mapping[str, str], now: Mapping[Term, str] | None = None) -> str:
    """A term in Coq, where parts may have become others; every text is safe as an argument inside parentheses."""
    if hasattr(term, "write"):
        return str(term.write(names))
    if now and term in now:
        return now[term]

    def is_other(part: Term) -> bool:
        return hasattr(part, "write") or bool(now and part in now)

    def inside(part: Term) -> str:
        text = write_term(part, names, now)
        is_call = part[0] in FUNCTIONS and not is_other(part)
        return text if is_call or re.fullmatch(r"\w+", text) else f"({text})"

    def join_factor(part: Term, first: bool) -> str:
        if part[0] == "^" and part[2] == checker.MINUS_ONE and not is_other(part):
            return f"{'1' if first else ''} / {inside(part[1])}"
        return inside(part) if first else f" * {inside(part)}"

    match term:
        case ("number", q):
            if max(len(str(q.p)), len(str(q.q))) > MOST_DIGITS:
                raise Unwritten("a number of too many digits")
            top = f"- {-q.p}" if q.p < 0 else str(q.p)
            return top if q.q == 1 else f"{f'({top})' if q.p < 0 else top} / {q.q}"
        case ("pi",):
            return "PI"
        case ("symbol", name):
            if name not in names:
                raise Unwritten(f"the symbol {name}, which the statement does not have,")
            return names[name]
        case ("+", *parts):
            return " + ".join(
                inside(part) if part[0] in ("number", "+") else write_factor(part, names, now) for part in parts
            )
        case ("*", *parts):
            return "".join(map(join_factor, parts, [True] + [False] * len(parts)))
        case ("^", base, exponent):
            return write_power(inside(base), checker.constant_of(exponent), base, exponent, names, now)
        case ("cot", x):
            return f"cos ({write_term(x, names, now)}) / sin ({write_term(x, names, now)})"
        case ("sec" | "csc" as name, x):
            return f"/ {INVERSES[name]} ({write_term(x, names, now)})"
        case (str(name), x) if name in FUNCTIONS:
            return f"{FUNCTIONS[name]} ({write_term(x, names, now)})"
    raise Unwritten(f"{term[0]} has no counterpart")


def write_factor(part: Term, names: Mapping[str, str], now: Mapping[Term, str] | None) -> str:
    """A term of a sum: a product needs no parentheses, unless it starts with a sign."""
    text = write_term(part, names, now)
    return f"({text})" if text.startswith(("-", "/")) or (now and part in now) else text


def write_power(
    text: str, q: fmpq | None, base: Term, exponent: Term, names: Mapping[str, str], now: Mapping[Term, str] | None
) -> str:
    """A power: whole, of a square root, or of a positive base."""
    if q is None:
        return f"Rpower {text} ({write_term(exponent, names, now)})"
    if q.q == 1:
        if abs(q.p) > 1000:
            raise Unwritten("an exponent beyond 1000")
        power = text if abs(q.p) == 1 else f"{text} ^ {abs(int(q.p))}"
        return power if q.p > 0 else "1" if q.p == 0 else f"/ ({power})" if abs(q.p) > 1 else f"/ {text}"
    if q.q == 2:
        return write_power(f"(sqrt {text})", fmpq(q.p), base, exponent, names, now)
    constant = checker.constant_of(base)
    if q < 0 or (constant is not None and constant > 0):  # the base is positive where there is a value
        return f"exp ({q.p} / {q.q} * ln {text})"
    raise Unwritten("a root that is no square root, of what may be 0")


def subterms(term: Term) -> Iterator[Term]:
    """All parts of a term, the innermost first."""
    for part in term[1:]:
        if isinstance(part, tuple):
            yield from subterms(part)
    yield term
