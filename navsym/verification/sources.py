"""Files of a user as papers: claims of a claim file, targets of a model, claims of derivation modules of one's own."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from importlib.abc import SourceLoader
from pathlib import Path
from types import ModuleType

from navsym.claims import CERTIFIED, OPEN, PROVED, Claim, Finding, Paper, Property, Statement, Status, Verdict
from navsym.conventions.card import HEADINGS
from navsym.core.errors import DomainError, ExpressionSyntaxError, NavsymError, NotEstimableError
from navsym.language.declarations import Parameter
from navsym.language.files import read_bytes, read_text
from navsym.language.tomlfile import SIZE, read_toml
from navsym.models.model import contents_of
from navsym.prove.claimfile import FileClaim, complete_verdict, property_of_claim, read_claims, statement_of
from navsym.prove.relations.judge import TextClaim
from navsym.prove.wording import expression_text

LARGEST = 5_000_000  # bytes of a derivation module
DIGITS = 12  # of the values of targets
OWN = "navsym_workspace"  # before the name of an imported module


def claims_of_file(name: str, path: Path, go_on: bool = False) -> tuple[Claim, ...]:
    """The claims of a claim file, one for each target of a model file or question of an audit; raises NavsymError."""
    document = read_toml(path)
    if "claim" in document:
        return tuple(claim_of_block(name, path, claim) for claim in read_claims(path, go_on=go_on).claims)
    whose = (claim_of_conventions(name, path),) if "roles" in document else ()
    if whose and "targets" not in document:
        return whose
    if "model" in document or "basis" in document:
        targets = contents_of(path, None, {}, "verify").targets
        return (*whose, *(claim_of_target(name, path, target) for target in targets))
    if "question" in document:
        from navsym.verification.audits import claims_of_audit

        return claims_of_audit(name, path)
    got = ", ".join(document) or "nothing"
    expected = "[[claim]] blocks, [[question]] blocks, or a [model] or [basis] with targets or [roles]"
    message = f"expected {expected}; got {got[:80]}; correct the file"
    raise ExpressionSyntaxError(message, where=str(path))


def claim_of_block(name: str, path: Path, claim: FileClaim | TextClaim) -> Claim:
    """A claim of a claim file; without ``expect`` it is declared to hold."""
    place = place_of_line(name, path, rf"\s*id\s*=\s*{re.escape(json.dumps(claim.id))}")
    title = str(claim.formula)
    if isinstance(claim, FileClaim):
        derive, completed = partial(statement_of, claim), partial(complete_verdict, claim)
        return claim_of_notes(name, claim.id, title, derive, claim.notes, place, completed)
    return claim_of_notes(name, claim.id, title, partial(property_of_claim, claim), claim.notes, place)


def claim_of_notes(
    name: str,
    number: str,
    title: str,
    derive: Callable[[], Statement],
    notes: Mapping[str, str],
    place: str,
    completed: Callable[[Verdict], Verdict] | None = None,
) -> Claim:
    """The claim of a block in a file, with the title, the verdict and the reason that its notes declare."""
    return Claim(
        name,
        number,
        notes.get("title", title),
        derive,
        Status(notes.get("expect", "PROVED")),
        notes.get("corrects"),
        "paper" if notes.get("expect") == "REFUTED" else None,
        notes.get("reason", ""),
        place,
        completed,
        "expect" not in notes,
        notes.get("printed", ""),
    )


def place_of_line(name: str, path: Path, pattern: str) -> str:
    """``claims/baro.toml:12``, the first line that a pattern fits; the file where none does."""
    lines = read_text(path, SIZE).splitlines()
    line = next((place for place, text in enumerate(lines, start=1) if re.match(pattern, text)), None)
    return name if line is None else f"{name}:{line}"


# Models


def claim_of_target(name: str, path: Path, target: str) -> Claim:
    """The claim that the measurements of a model determine a target, with its guaranteed error as evidence."""
    title = f"The measurements determine {target}, with a certified guaranteed error."
    place = place_of_line(name, path, rf"\s*{re.escape(target)}\s*=")
    return Claim(name, target, title, partial(property_of_target, path, target), CERTIFIED, place=place, either=True)


def property_of_target(path: Path, target: str) -> Property:
    """Whether a target is estimable: at the values of the file, and in the middle of the ranges that it leaves open."""
    from navsym.guaranteed.solver import solve

    values = middle_values(contents_of(path, None, {}, "verify").parameters)
    scope = ", ".join(f"{name} = {value}" for name, value in values.items()) or "the numbers of the file"
    try:
        found = solve(path, target, digits=DIGITS, values=values)
    except NotEstimableError as error:
        return Property(True, Finding(False, "null direction", PROVED, scope, evidence=error.message))
    evidence = f"guaranteed standard deviation {found.value} for measurements within their sigma"
    status = found.status if found.check().accepted else OPEN
    finding = Finding(True, "exact primal-dual certificate", status, scope, (), evidence, found.certificate)
    return Property(True, finding, unsaid="the checker grants the optimum, and reads no model")


def claim_of_conventions(name: str, path: Path) -> Claim:
    """The claim that an error model is right under some card of conventions."""
    title = "The error model is right under a card of conventions."
    place = place_of_line(name, path, r"\s*\[roles\]")
    return Claim(name, "conventions", title, partial(property_of_conventions, path), PROVED, place=place, either=True)


def property_of_conventions(path: Path) -> Property:
    """Whether a card is proved, or all are excluded at exact points; the certificates are those of single entries."""
    from navsym.verification.error_models import conventions

    found = conventions(path)
    first = found.cards[0] if found.cards else found.nearest
    words = "; ".join(f"{HEADINGS[key]}: {word}" for key, word in first.words().items()) if first else "none is near"
    blocks = "; ".join(" by ".join(conflict.block) for conflict in found.conflicts)
    evidence = f"{len(found.cards)} cards of {found.examined}; {words}" if found.cards else f"change {blocks}; {words}"
    right = bool(found.cards)
    parts = [part for part in found.proofs if right != (part["kind"] == "counterexample")]
    certificate = {"kind": "all", "of": parts} if parts and right else next(iter(parts), None)
    decided = PROVED if found.complete else OPEN
    finding = Finding(right, "error dynamics of every card", decided, "", (), evidence, certificate)
    return Property(True, finding, tuple(part["statement"] for part in parts[: None if right else 1]))


def middle_values(parameters: Mapping[str, Parameter]) -> dict[str, str]:
    """A value of each parameter: the middle of its range, 1 beside one end or without a range."""
    values = {}
    for name, parameter in parameters.items():
        lower, upper = parameter.lower, parameter.upper
        if lower is not None and upper is not None:
            values[name] = expression_text((lower + upper) / 2)
        elif lower is not None:
            values[name] = expression_text(lower + 1)
        else:
            values[name] = "1" if upper is None else expression_text(upper - 1)
    return values


# Derivation modules of one's own


def own_module(path: Path) -> ModuleType:
    """The module of a file that a workspace lists; it is run once for each text.

    Raises NavsymError, with the line, for what cannot be run or has no card of its paper.
    """
    return run_module(path, read_bytes(path, LARGEST))


class TextLoader(SourceLoader):
    """Runs the text that was read: no byte code is kept, which could be that of another text of the same second."""

    def __init__(self, path: Path, text: bytes) -> None:
        self.path, self.text = path, text

    def get_filename(self, fullname: str) -> str:
        """The file of the module."""
        return str(self.path)

    def get_data(self, path: str | bytes) -> bytes:
        """Its text."""
        return self.text


@lru_cache(maxsize=64)
def run_module(path: Path, text: bytes) -> ModuleType:
    """Run a derivation module; the text is part of the key, so that an edited file is run again."""
    loader = TextLoader(path, text)
    spec = importlib.util.spec_from_file_location(f"{OWN}.{path.stem}", path, loader=loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        loader.exec_module(module)
    except NavsymError as error:
        raise error.at(str(path)) from None
    except Exception as error:
        raise broken_module(path, error) from error
    card = getattr(module, "PAPER", None)
    if not isinstance(card, Paper) or card.module != path.stem:
        got = f"module={card.module!r}" if isinstance(card, Paper) else "none"
        message = f"expected PAPER = Paper(module={path.stem!r}, …); got {got}; write it as navsym new-paper does"
        raise DomainError(message, where=str(path))
    return module


def broken_module(path: Path, error: Exception) -> ExpressionSyntaxError:
    """The error of a derivation module that does not run, with its line."""
    trace, line = error.__traceback__, getattr(error, "lineno", None)
    while trace is not None:
        line = trace.tb_lineno if trace.tb_frame.f_code.co_filename == str(path) else line
        trace = trace.tb_next
    got = f"{type(error).__name__}: {error}"[:200]
    place = f"{path}: line {line}" if line else str(path)
    return ExpressionSyntaxError(f"expected a derivation module that runs; got {got}; correct it", where=place)
