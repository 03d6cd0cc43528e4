"""The card of a paper: what it is, and every equation it numbers."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from types import ModuleType
from typing import Literal

from navsym.claims.claim import PAPERS, Claim
from navsym.core.errors import DuplicateError

#: A printed formula; a printed sentence beside one; a remark of ours; a result beyond the paper.
Kind = Literal["printed", "beside", "remark", "beyond"]


@dataclass(frozen=True, slots=True, eq=False)
class Paper:
    """Bibliographic card and the list of **all** numbered equations, so that omissions show.

    module      : derivation module
    equations   : every number printed in the paper, in order
    definitions : number -> why nothing can be checked there (notation, a given model)
    beside      : claims on printed sentences, which say nothing about the numbered formula beside them
    remarks     : claims in our own words on what is printed
    beyond      : claims on what the paper does not treat
    causes      : refuted claim -> the claim whose slip it only repeats
    scopes      : claims -> the sizes or values they are examined for, unless their statements name them; the first fits
    moving      : names of quantities that move: a claim that takes one as constant, for poles or ranks, says so
    typed       : claims whose derived side is written down and not derived: short sums, identities of printed letters
    left_out    : printed statement -> why no claim judges it

    Claims are named by number or pattern, with blanks between (``"1.3.spectrum range.*"``), a correction by the claim
    that it corrects. All others are on printed formulas. Only what is printed can be a slip.
    """

    module: str
    title: str
    authors: tuple[str, ...]
    year: int | None
    source: str
    language: str
    equations: tuple[str, ...]
    definitions: Mapping[str, str] = field(default_factory=dict)
    doi: str = ""
    beside: str = ""
    remarks: str = ""
    beyond: str = ""
    causes: Mapping[str, str] = field(default_factory=dict)
    scopes: Mapping[str, str] = field(default_factory=dict)
    moving: str = ""
    typed: str = ""
    left_out: Mapping[str, str] = field(default_factory=dict)

    def kind_of(self, number: str) -> Kind:
        """Whether a claim is on a printed formula, on a printed sentence, a remark of ours, or beyond the paper."""
        kinds: tuple[tuple[Kind, str], ...] = (
            ("remark", self.remarks),
            ("beyond", self.beyond),
            ("beside", self.beside),
        )
        name = number.rstrip("*")
        return next((kind for kind, names in kinds if any(fnmatchcase(name, one) for one in names.split())), "printed")

    def scope_of(self, number: str, scope: str) -> str:
        """The scope of a verdict, with the sizes or values that the card names for the claim."""
        more = next((words for name, words in self.scopes.items() if fnmatchcase(number.rstrip("*"), name)), "")
        return scope if scope.endswith(more) else f"{scope}; {more}".removeprefix("; ")


@dataclass(frozen=True, slots=True)
class Coverage:
    """Which numbered equations are claimed, which only define, which are missing."""

    claimed: tuple[str, ...]
    definitions: tuple[str, ...]
    missing: tuple[str, ...]


def equation_of(number: str, equations: Iterable[str]) -> str | None:
    """The numbered equation to which a claim belongs: the longest that it extends.

    ``"4.12.Phi21"`` and ``"4.8*"`` belong to ``"4.12"`` and ``"4.8"``; a short name belongs to none.
    """
    fits = [
        equation for equation in equations if number == equation or number.startswith((f"{equation}.", f"{equation}*"))
    ]
    return max(fits, key=len, default=None)


def compare_equations(paper: Paper, claims: Iterable[Claim]) -> Coverage:
    """Compare the paper's list of equations with the claims made about it; a definition has none on its formula."""
    about = {(equation_of(claim.number, paper.equations), paper.kind_of(claim.number)) for claim in claims}
    definitions = tuple(e for e in paper.equations if e in paper.definitions and (e, "printed") not in about)
    touched = {equation for equation, _ in about} - {*definitions}
    missing = tuple(e for e in paper.equations if e not in touched and e not in definitions)
    return Coverage(tuple(e for e in paper.equations if e in touched), definitions, missing)


def papers_folder() -> Path:
    """Folder of the papers, with the ledger and the wording of erratum sheets: ``derivations/`` in a checkout."""
    return Path(next(iter(importlib.import_module(PAPERS).__path__)))


def paper_names() -> list[str]:
    """Names of the derivation modules, by listing the folder."""
    names = (entry.name for entry in pkgutil.iter_modules([str(papers_folder())]))
    return sorted(name for name in names if not name.startswith("_"))


def import_paper(name: str) -> ModuleType:
    """The module of a paper, or a part of it: ``"trajectory"``, ``"trajectory.experiment.study"``."""
    return importlib.import_module(f"{PAPERS}.{name}")


def experiment_names() -> list[str]:
    """Names of the papers whose numerical experiment can be run again: ``experiment/study.py`` has it."""
    return sorted(path.parts[-3] for path in papers_folder().glob("*/experiment/study.py"))


def claims_of(module: ModuleType) -> tuple[Claim, ...]:
    """All claims of a derivation module, in the order of the source.

    A claim is a module attribute or a member of a tuple that is one; a folder contributes
    the claims of its files in the order of their names.
    """
    found: dict[str, Claim] = {}
    for part in import_parts(module):
        for value in vars(part).values():
            for claim in claims_in(value):
                known = found.setdefault(claim.id, claim)
                if known is not claim:
                    message = f"expected distinct ids of claims; got {claim.id} twice; rename one of them"
                    raise DuplicateError(message, where=str(module.__file__))
    return tuple(found.values())


def claims_in(value: object) -> Iterator[Claim]:
    """The claim that a module attribute is, or the claims in a tuple; nothing for other values."""
    if isinstance(value, Claim):
        yield value
    elif isinstance(value, tuple):
        yield from (item for item in value if isinstance(item, Claim))


def import_parts(module: ModuleType) -> list[ModuleType]:
    """The module itself, and the files below it when it is a folder."""
    path = getattr(module, "__path__", None)
    if path is None:
        return [module]
    names = sorted(entry.name for entry in pkgutil.iter_modules(path))
    return [module, *(importlib.import_module(f"{module.__name__}.{name}") for name in names)]
