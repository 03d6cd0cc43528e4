"""Where claims come from: what a workspace lists, or else the papers; a claim is found by its id."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from navsym.claims import Claim, Paper, claims_of, compare_equations, equation_of
from navsym.claims.paper import import_paper, paper_names
from navsym.claims.workspace import FILE, find_workspace
from navsym.core.choice import one_of
from navsym.core.errors import DomainError, EmptyError
from navsym.core.store import key_of
from navsym.language.tomlfile import read_toml


@dataclass(frozen=True, slots=True, eq=False)
class PaperModule:
    """A derivation module, its paper, its claims, and the digest of its text."""

    name: str
    paper: Paper
    claims: tuple[Claim, ...]
    source: str = ""

    def correction_of(self, wanted: str) -> Claim | None:
        """The claim that corrects the one of an id, or None."""
        return next((claim for claim in self.claims if claim.corrects_id == wanted), None)


@dataclass(frozen=True, slots=True)
class PaperSummary:
    """How many numbered equations of a paper are claimed or definitions, and which are missing.

    source : digest of the text from which its verdicts come; in ledgers only, empty where it is not known
    """

    module: str
    title: str
    equations: int
    claimed: int
    definitions: int
    missing: tuple[str, ...]
    source: str = ""


def paper_module(module: ModuleType) -> PaperModule:
    """The paper card and the claims of an imported derivation module."""
    paper: Paper = module.PAPER
    return PaperModule(paper.module, paper, claims_of(module), text_digest(module))


@functools.cache  # of a module, not of its file: its text is what was imported
def text_digest(module: ModuleType) -> str:
    """Digest of the file of a module, or of all files in its folder."""
    path = Path(str(module.__file__))
    inside = sorted(path.parent.rglob("*")) if hasattr(module, "__path__") else [path]
    files = [file for file in inside if file.is_file() and "__pycache__" not in file.parts]
    return key_of(*(part for file in files for part in (file.name, file.read_bytes().hex())))


def load_papers(names: Iterable[str] = (), *, go_on: bool = False) -> list[PaperModule]:
    """The papers and files of these names, in this order, or all; raises DomainError for a name that is none.

    Inside a workspace all are what it lists; outside, the papers that come with navsym. By name, these and any claim or
    model file are known everywhere. With ``go_on`` the claims of a file are those of it that can be read.
    """
    workspace = find_workspace()
    listed: dict[str, Path | None] = dict.fromkeys(paper_names()) if workspace is None else {**workspace.names()}
    if workspace is not None and not listed:
        message = "expected files that a pattern names; got none; write one, or correct the patterns"
        raise EmptyError(message, where=str(workspace.root / FILE))
    wanted = [name_source(str(name), listed) for name in names] or [*listed]
    return [load_source(name, listed, go_on) for name in dict.fromkeys(wanted)]


def name_source(name: str, listed: Mapping[str, Path] | Mapping[str, Path | None]) -> str:
    """The name under which a file is listed, where it is; a name of anything else as it stands."""
    if name in listed or not name.endswith(".toml"):
        return name
    path = Path(name)
    same = (known for known, file in listed.items() if file is not None and path.exists() and file.samefile(path))
    return next(same, name)


def file_of_source(name: str) -> Path:
    """The claim or model file of a name: one that the workspace lists, or another one below the current folder."""
    workspace = find_workspace()
    listed: Mapping[str, Path] = {} if workspace is None else workspace.names()
    return listed.get(name_source(name, listed), Path(name))


def is_model(path: Path) -> bool:
    """True for a file of a model, whose ids name targets."""
    return not {"model", "basis"}.isdisjoint(read_toml(path))


def load_source(name: str, listed: Mapping[str, Path | None], go_on: bool) -> PaperModule:
    """The claims of a name: a file of the workspace or another one, or a paper that comes with navsym."""
    path = listed.get(name) or (Path(name) if name.endswith(".toml") else None)
    if path is None:
        one_of(name, dict.fromkeys([*listed, *paper_names()]), "paper")
        return paper_module(import_paper(name))

    from navsym.verification.audits import files_of_source
    from navsym.verification.sources import claims_of_file, own_module

    if path.suffix == ".py":
        return paper_module(own_module(path))
    card = Paper(name, f"Formulas of {name}", (), None, name, "", ())  # it numbers no equations: none is missing
    digest = key_of(*(file.read_bytes().hex() for file in files_of_source(path)))
    return PaperModule(name, card, claims_of_file(name, path, go_on), digest)


def summarise_paper(module: PaperModule) -> PaperSummary:
    """Coverage of the numbered equations of a paper."""
    covered = compare_equations(module.paper, module.claims)
    counts = (len(module.paper.equations), len(covered.claimed), len(covered.definitions))
    return PaperSummary(module.name, module.paper.title, *counts, tuple(covered.missing), module.source)


def list_changed(summaries: Iterable[PaperSummary], papers: Iterable[PaperModule]) -> list[str]:
    """Papers whose text is not the one from which these verdicts come; of verdicts without a digest nobody knows."""
    known = {paper.module: paper.source for paper in summaries}
    return [paper.name for paper in papers if known.get(paper.name, "") not in ("", paper.source)]


def split_id(wanted: str) -> tuple[str, str, str]:
    """Module or file, colon and number of an id: ``claims/baro.toml:ratio``, ``guaranteed_velocity:4.3.u2``."""
    file, ending, label = wanted.partition(".toml:")
    return (f"{file}.toml", ":", label) if ending else wanted.partition(":")


def find_claim(wanted: str) -> tuple[PaperModule, Claim]:
    """Paper and claim of an id ``module:number``; raises DomainError that lists the ids that begin so."""
    wanted = str(wanted)
    module, colon, number = split_id(wanted)
    if not colon and (known := papers_with(wanted)):
        whole = " or ".join(f"{name}:{wanted}" for name in known)
        message = f"expected the id of a claim, MODULE:NUMBER; got {wanted[:80]}; take {whole}"
        raise DomainError(message, where="claim")
    (paper,) = load_papers([module], go_on=True)
    for claim in paper.claims:
        if claim.number == number:
            return paper, claim
    load_papers([module])  # says why one of the others cannot be read
    ids = [claim.id for claim in paper.claims]
    close = [known for known in ids if known.startswith(wanted)] if number else ids
    if not close:
        close = [f"{module}:{n}" for n in difflib.get_close_matches(number, [c.number for c in paper.claims])]
    advice = f"take one of {', '.join(close[:6])}" if close else f"see navsym list --paper {module}"
    raise DomainError(f"expected the id of a claim; got {wanted[:80]}; {advice}", where="claim")


def papers_with(number: str) -> list[str]:
    """Papers that have claims of this number, or of parts of it."""
    numbers = ((paper.name, claim.number) for paper in load_papers() for claim in paper.claims)
    return sorted({name for name, known in numbers if known == number or known.startswith(f"{number}.")})


def claim_ids(wanted: str) -> list[str]:
    """Ids of all claims about a numbered equation, ``module:4.16``; of anything else, the id itself."""
    wanted = str(wanted)
    module, colon, number = split_id(wanted)
    if not colon:
        return [wanted]
    (paper,) = load_papers([module], go_on=True)
    numbers, equations = [claim.number for claim in paper.claims], paper.paper.equations
    if number in numbers or number not in equations:
        return [wanted]
    return [f"{module}:{n}" for n in numbers if equation_of(n, equations) == number] or [wanted]
