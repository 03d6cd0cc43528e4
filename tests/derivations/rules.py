"""Rules of judging a paper: each takes a paper with its claims and verdicts, and lists what breaks it.

They hold for the papers here (``test_rules``) and are broken one by one by a small paper (``test_sixth_paper``).
"""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from fractions import Fraction
from pathlib import Path
from typing import get_args

from navsym.claims import CONFIRMED, OPEN, REFUTED, Claim, Paper, compare_equations
from navsym.claims.claim import Slip
from navsym.claims.record import Record
from navsym.prove.grant import UNCHECKED
from tests.derivations.titles import (
    FIGURE,
    ends_of_ranges_in_no_title,
    named_by,
    numbers_of_no_statement,
    numbers_under_a_general_title,
    ranges_narrower_than_the_title,
    sizes_in_no_scope,
    words_that_nothing_shows,
)
from tests.derivations.typed import typed_in

#: Words of a title that say more than one example: their quantifier has to stand in the scope, or a range in the title.
QUANTIFIERS = re.compile(r"\b(every|always|in general|whatever|on average|inevitably|any|never)\b", re.IGNORECASE)
#: A free choice: of a gain, an interval, a start.
CHOICE = re.compile(
    r"\b(?:an?|An?|[Ss]ome|[Oo]ne) (?:[a-z]+ )?(?:gain|run|interval|start|window|step)s? (?:gives?|has|reach)"
)
#: Methods for systems with constant coefficients.
AUTONOMOUS = frozenset(
    "polynomial_of coefficients_of_polynomial observe observe_jointly charpoly eigenvals transition_matrix".split()
)
RANGE = re.compile(r"[\[(][^\])]*\d[^\])]*[\])]|n = \d|\d (to|and|or) \d")


@dataclass(frozen=True, eq=False)
class Judged:
    """A paper with its claims and their verdicts."""

    paper: Paper
    claims: tuple[Claim, ...]
    records: tuple[Record, ...]


def verdicts_other_than_declared(judged: Judged) -> list[str]:
    """Also an undecided finding that is called PROVED, and a run that is called a refutation."""
    return [r.id for r in judged.records if r.status != r.expect]


def quantifiers_without_a_scope(judged: Judged) -> list[str]:
    held = [r for r in judged.records if r.status.holds and QUANTIFIERS.search(r.title)]
    return [
        r.id for r in held if not (r.scope.startswith("all ") or re.search(r"\d", r.scope) or RANGE.search(r.title))
    ]


def slips_in_what_is_not_printed(judged: Judged) -> list[str]:
    return [c.id for c in judged.claims if c.slip and judged.paper.kind_of(c.number) not in ("printed", "beside")]


def unknown_attributions(judged: Judged) -> list[str]:
    """A printed formula that is refuted is a slip of the paper, of its copy, or nobody can tell which.

    A title blames the copy only where the claim does.
    """
    refuted = [c for c in judged.claims if c.expect == REFUTED and judged.paper.kind_of(c.number) == "printed"]
    blamed = [c for c in judged.claims if re.search(r"\b(scan|copy)\b", c.title) and c.slip != "scan"]
    unknown = [c for c in judged.claims if c.slip not in (None, *get_args(Slip))]
    return [c.id for c in (*blamed, *unknown, *(c for c in refuted if not c.slip))]


def names_of_no_claim(judged: Judged) -> list[str]:
    """Entries of the card that name nothing."""
    paper, numbers = judged.paper, [claim.number.rstrip("*") for claim in judged.claims]
    named = [*f"{paper.beside} {paper.remarks} {paper.beyond}".split(), *paper.causes, *paper.scopes]
    return [one for one in named if not any(fnmatchcase(number, one) for number in numbers)]


def causes_that_are_no_slips(judged: Judged) -> list[str]:
    """A cause is a slip that is counted itself; what repeats it is one as well, of the same person."""
    slips = {claim.number: claim.slip for claim in judged.claims if claim.slip and claim.expect == REFUTED}
    causes = judged.paper.causes
    otherwise = [one for one, cause in causes.items() if slips.get(one) != slips.get(cause)]
    return [*(set(causes) - set(slips)), *(set(causes.values()) - (set(slips) - set(causes))), *otherwise]


def left_out_without_a_reason(judged: Judged) -> list[str]:
    return [words for words, why in judged.paper.left_out.items() if not (words.strip() and why.strip())]


def corrections_without_a_star(judged: Judged) -> list[str]:
    """The number without a star states the print, and its correction says something else."""
    known = {r.id: r for r in judged.records}
    wrong = [(r, known.get(r.corrects)) for r in judged.records if r.corrects]
    return [
        r.id
        for r, w in wrong
        if w is None or r.id != f"{w.id}*" or w.status != REFUTED or (r.printed, r.derived) == (w.printed, w.derived)
    ] + [r.id for r in judged.records if r.number.endswith("*") and not r.corrects]


def refutations_without_a_correction(judged: Judged) -> list[str]:
    corrected = {r.corrects for r in judged.records if r.status.holds}
    return [r.id for r in judged.records if r.status == REFUTED and (r.id not in corrected or not r.reason)]


def equations_without_a_claim(judged: Judged) -> list[str]:
    return [*compare_equations(judged.paper, judged.claims).missing]


def runs_and_open_questions_without_evidence(judged: Judged) -> list[str]:
    """What is sampled counts its points or trials; what is open says what was tried."""
    bare = [r for r in judged.records if r.status == CONFIRMED and not re.search(r"\d", r.evidence + r.scope)]
    return [r.id for r in (*bare, *(r for r in judged.records if r.status == OPEN and not r.evidence))]


def certificates_that_lack_without_a_reason(judged: Judged) -> list[str]:
    bare = [r for r in judged.records if UNCHECKED in r.evidence]
    return [r.id for r in bare if r.certificate or not re.search(re.escape(UNCHECKED) + r" \(\w.{10,}\)", r.evidence)]


def statements_of(tree: ast.Module) -> list[tuple[int, list[ast.expr]]]:
    """The printed and the derived side of every statement of a file, with its line.

    A fact that says its meaning in formulas is decided by these.
    """
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("Equation", "Property", "fact"):
            if any(word.arg == "meaning" for word in node.keywords):
                continue
            named = [word.value for word in node.keywords if word.arg in ("printed", "derived")]
            found.append((node.lineno, [*node.args, *named][:2]))
        elif isinstance(node, ast.Yield) and isinstance(node.value, ast.Tuple):
            found.append((node.lineno, node.value.elts))
        elif isinstance(node, ast.Lambda) and isinstance(node.body, ast.GeneratorExp):
            found.append((node.lineno, getattr(node.body.elt, "elts", [])))
    return [(line, sides) for line, sides in found if len(sides) == 2]


def files_of(judged: Judged) -> list[Path]:
    """The sources of the claims of a paper."""
    return sorted({Path(inspect.unwrap(claim.derive).__code__.co_filename) for claim in judged.claims})


def sides_that_nothing_computes(judged: Judged) -> list[str]:
    """A derived side comes from a model or a derivation, or its paper declares it as typed in; and only then."""
    found = dict.fromkeys(typed_in(files_of(judged), statements_of))
    declared = judged.paper.typed.split()
    return [one for one in found if one.rstrip("*") not in declared] + [
        one for one in declared if not {one, f"{one}*"} & {*found}
    ]


def figures_that_choose_alone(judged: Judged) -> list[str]:
    """Who may choose a gain, a run or an interval chooses it for all figures of a sentence, not for one of them."""
    held = [r for r in judged.records if r.status.holds and CHOICE.search(r.title)]
    return [r.id for r in held if len(FIGURE.findall(r.title)) == 1]


def sides_of_one_expression(judged: Judged) -> list[str]:
    """What stands on both sides in the same words holds whatever the model is."""
    files = files_of(judged)
    read = [(file, statements_of(ast.parse(file.read_text(encoding="utf-8")))) for file in files]
    assert any(found for _, found in read)
    return [f"{file.name}:{line}" for file, found in read for line, (a, b) in found if ast.dump(a) == ast.dump(b)]


def moving_quantities_held_in_silence(judged: Judged) -> list[str]:
    """Poles, ranks and frequencies of a matrix are those of constant coefficients: what moves is called constant."""
    moving, wrong = {*judged.paper.moving.split()}, []
    for claim, r in zip(judged.claims, judged.records, strict=True):
        named = {*re.findall(r"[A-Za-z]\w*", f"{r.title} {r.scope} {r.printed} {r.derived}")} & moving
        is_told = re.search(r"\b(constant|frozen|turning|mu = 0)\b", f"{r.title} {r.scope}")
        if named and r.status.holds and not is_told and {name for name, *_ in named_by(claim)} & AUTONOMOUS:
            wrong.append(r.id)
    return wrong


def tolerances_wider_than_half_a_unit(judged: Judged) -> list[str]:
    """A figure is a whole number of units, twice the tolerance; what joins several figures says *within the digits*."""
    wrong = []
    for r in judged.records:
        if r.status.holds and " +- " in r.printed and "within the digits" not in r.title:
            figures, _, tolerance = r.printed.rpartition(" +- ")
            unit = 2 * Fraction(tolerance)
            whole = all((Fraction(x) / unit).denominator == 1 for x in re.findall(r"-?\d+(?:/\d+)?", figures))
            power = {str(n).rstrip("0") for n in (unit.numerator, unit.denominator)} == {"1"}
            wrong += [] if whole and power else [r.id]
    return wrong


RULES: tuple[Callable[[Judged], list[str]], ...] = (
    verdicts_other_than_declared,
    quantifiers_without_a_scope,
    slips_in_what_is_not_printed,
    unknown_attributions,
    names_of_no_claim,
    causes_that_are_no_slips,
    left_out_without_a_reason,
    corrections_without_a_star,
    refutations_without_a_correction,
    equations_without_a_claim,
    runs_and_open_questions_without_evidence,
    certificates_that_lack_without_a_reason,
    sides_of_one_expression,
    tolerances_wider_than_half_a_unit,
    sides_that_nothing_computes,
    figures_that_choose_alone,
    moving_quantities_held_in_silence,
    ends_of_ranges_in_no_title,
    numbers_of_no_statement,
    numbers_under_a_general_title,
    ranges_narrower_than_the_title,
    sizes_in_no_scope,
    words_that_nothing_shows,
)
