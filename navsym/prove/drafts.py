"""Drafts of derivation modules: a module for one more paper, and one more claim in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from navsym.claims.paper import equation_of, papers_folder
from navsym.claims.verdict import Verdict
from navsym.claims.workspace import find_workspace
from navsym.core.answers import Answer
from navsym.core.errors import DomainError, DuplicateError, ExpressionSyntaxError
from navsym.language.files import write_text
from navsym.language.names import quote

#: Arguments of a statement that are no declarations.
BESIDE = ("box", "tolerance", "exists", "given", "rates", "order")


@dataclass(frozen=True, slots=True, repr=False)
class NewPaper(Answer):
    """A derivation module that was written: its file and its name."""

    path: Path
    module: str

    def __repr__(self) -> str:
        return f"<new paper {self.module}: {self.path}>"

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym new-paper``."""
        return {"path": str(self.path), "module": self.module}


@dataclass(frozen=True, slots=True, repr=False)
class DraftedClaim(Answer):
    """A claim that was decided and appended to its module.

    equation : the numbered equation that it belongs to, or None where the card of the paper has none
    """

    path: Path
    id: str
    verdict: Verdict
    equation: str | None

    def __repr__(self) -> str:
        return f"<new claim {self.id}: {self.verdict.status}>"

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym new-claim``."""
        return {
            "path": str(self.path),
            "id": self.id,
            "status": str(self.verdict.status),
            "evidence": self.verdict.evidence,
            "equation": self.equation,
        }


def new_paper(
    name: str,
    *,
    title: str = "",
    authors: Sequence[str] = (),
    year: int | None = None,
    source: str = "",
    language: str = "English",
    equations: str = "1",
    folder: str | Path | None = None,
) -> NewPaper:
    """A derivation module for another paper: its card, its equations, and an example claim.

    name      : module name, small letters, digits and underscores
    equations : every number printed, such as ``"1-6"`` or ``"1.1-1.9, 2.1"``
    folder    : where to write it; by default the workspace's folder of papers, or that of navsym's own

    Raises NavsymError: kind ``syntax`` for a name or number that cannot be, ``duplicate`` for a module that exists.

    >>> import navsym as nav, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     nav.new_paper("schuler_pendulum", authors=["A. Author"], year=1923, folder=folder).module
    'schuler_pendulum'
    """
    from navsym.language.scaffold import check_module_name, module_source, split_numbers

    path = own_folder(folder) / f"{check_module_name(name)}.py"
    if path.exists() or path.with_suffix("").exists():
        message = f"expected a new module; got {name}, which exists; choose another name"
        raise DuplicateError(message, where=str(path))
    text = module_source(name, title, list(authors), year, source, language, split_numbers(equations))
    write_text(path, text)
    return NewPaper(path, name)


def new_claim(
    module: str,
    number: str,
    *,
    printed: str = "",
    derived: str = "",
    formula: str = "",
    relation: str = "=",
    given: Sequence[str] = (),
    symbols: Mapping[str, Any] | None = None,
    title: str = "",
    positive: str = "",
    tolerance: str | None = None,
    corrects: str = "",
    reason: str = "",
    slip: str = "paper",
    folder: str | Path | None = None,
) -> DraftedClaim:
    r"""Decide ``printed = derived``, or a whole formula, and append the claim to a module, with its verdict.

    number    : equation and part, such as ``"4.3.u2"``; a star for a correction
    formula   : in the place of both sides: a relation or a chain of them, in the language of files or in LaTeX
    relation  : between the two sides, one of ``= != < <= > >=``
    given     : hypotheses, each a relation
    symbols   : name -> declaration as for :func:`navsym.prove`: ``("0", "pi")``, ``"positive"``, ``{"vector": 3}``
    positive  : new names that are positive, such as ``"R,g"``; others are real
    tolerance : of a printed numeral, half a unit of its last digit
    corrects  : number of the refuted claim that this one replaces
    reason    : for a refuted claim: what is wrong; ``slip`` says who slipped, ``"paper"`` or ``"scan"``

    Two plain sides become Python source, whose derived side is to be replaced by a route from the model. Whatever has
    ranges, another relation, hypotheses, vectors, matrices, cases, calculus or LaTeX is kept as it is written.
    Raises NavsymError for sides that are no formulas, a number that is claimed already, or no such module.

    >>> import navsym as nav, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     paper = nav.new_paper("pendulum", equations="1-2", folder=folder)
    ...     nav.new_claim("pendulum", "1", printed="2*sin(a)*cos(a)", derived="sin(2*a)", folder=folder)
    ...     nav.new_claim("pendulum", "2", formula=r"\sin a \le a", symbols={"a": ("0", "pi")}, folder=folder)
    <new claim pendulum:1: PROVED>
    <new claim pendulum:2: PROVED>
    """
    from navsym.language.scaffold import NewClaim, append_claim, read_equation_numbers

    path = find_module(module, folder)
    if slip not in ("paper", "scan"):
        raise DomainError(f"expected paper or scan; got {slip[:40]}; name one", where="--slip")
    names = frozenset(name.strip() for name in positive.split(",") if name.strip())
    sentence = title or f"Equation ({number.rstrip('*')}), {'corrected' if corrects else 'as it stands in the paper'}."
    text = path.read_text(encoding="utf-8")
    sides = choose_sides(printed, derived, formula, relation)
    call: dict[str, Any] = {}
    if "=" not in sides or given or symbols or any(is_beyond_numbers(side) for side in sides):
        words = declare_names(text, (*sides, *given), names, dict(symbols or {}))
        call = {"": sides, "given": list(given), "tolerance": tolerance, **words}
    draft = NewClaim(number, sentence, printed, derived, "OPEN", corrects, reason, "", names, tolerance, call)
    append_claim(text, draft)  # what cannot be written is refused before it is decided
    verdict = decide_stated(call) if call else decide_draft(text, draft)
    write_text(path, append_claim(text, declare_verdict(draft, verdict, slip)))
    return DraftedClaim(path, f"{module}:{number}", verdict, equation_of(number, read_equation_numbers(text)))


def find_module(module: str, folder: str | Path | None) -> Path:
    """The file of a derivation module; raises DomainError where there is none."""
    from navsym.language.scaffold import check_module_name

    path = own_folder(folder) / f"{check_module_name(module)}.py"
    if not path.is_file():
        message = f"expected a module in one file; got {module}; make it with navsym new-paper"
        raise DomainError(message, where=str(path))
    return path


def choose_sides(printed: str, derived: str, formula: str, relation: str) -> tuple[str, ...]:
    """The formula alone, or left, relation and right; raises DomainError for a mixture."""
    from navsym.language.scaffold import one_line

    for text, where in ((printed, "--printed"), (derived, "--derived"), (formula, "--formula")):
        one_line(text, where)
    if formula and not (printed or derived or relation != "="):
        return (formula,)
    if formula or not (printed.strip() and derived.strip()):
        got = "both" if formula else "one side or none"
        message = f"expected a printed and a derived side, or a whole formula; got {got}; give one of them"
        raise DomainError(message, where="--formula" if formula else "--derived")
    return printed, relation, derived


def is_beyond_numbers(side: str) -> bool:
    """Whether a side needs the words of files: LaTeX, vectors, matrices, cases or calculus."""
    from navsym.language.vectors import is_wide

    return "\\" in side or is_wide(side)


def declare_names(
    source: str, texts: Sequence[str], positive: frozenset[str], symbols: dict[str, Any]
) -> dict[str, Any]:
    """Declarations of a claim in the words of files: those given, and what the module says of other names in it."""
    from navsym.claims.formula import names_of
    from navsym.language.scaffold import EXAMPLE, KINDS, NAMES_IN, parse_module, read_declarations

    known = read_declarations(parse_module(source.replace(EXAMPLE, "", 1)), positive - symbols.keys())
    used = set[str]().union(*map(names_of, texts)) & known.keys() - symbols.keys()
    for name in symbols:
        if not NAMES_IN.fullmatch(name) or name in BESIDE:
            message = f"expected a name of the formula; got {quote(name)}; rename it"
            raise ExpressionSyntaxError(message, where="--declare")
    words = {name: [kind for kind in KINDS[1:] if getattr(known[name], f"is_{kind}")] for name in sorted(used)}
    return {**symbols, **{name: kinds[0] for name, kinds in words.items() if kinds}}


def decide_stated(call: Mapping[str, Any]) -> Verdict:
    """Verdict on a claim in the words of files, by the arguments of its statement."""
    from navsym.prove.formulas import state_formula
    from navsym.prove.ladder import decide_within

    named = {name: value for name, value in call.items() if name}
    return decide_within(state_formula(*call[""], **named))


def own_folder(folder: str | Path | None) -> Path:
    """The given folder; else that of the workspace's papers, or of navsym's own."""
    workspace = None if folder else find_workspace()
    return Path(folder or (papers_folder() if workspace is None else workspace.papers_folder))


def decide_draft(source: str, draft: Any) -> Verdict:
    """Verdict on the two sides, with the names as the file and the caller declare them.

    Raises DomainError where nothing is decided for real names and everything for positive ones.
    """
    verdict = decide_with(source, draft, draft.positive)
    new = undeclared_names(source, draft)
    if verdict.status != "OPEN" or not new:
        return verdict
    if decide_with(source, draft, draft.positive | new).holds:
        listed = ",".join(sorted(new))
        message = (
            f"expected names that say enough; got {listed} of any sign, for which nothing was decided, while it holds "
            f"for positive ones; add --positive {listed} if they are, or declare them in the file"
        )
        raise DomainError(message, where="--positive")
    return verdict


def decide_with(source: str, draft: Any, positive: frozenset[str]) -> Verdict:
    """Verdict on the two sides when these names are positive."""
    from navsym.claims.statement import Equation
    from navsym.language.scaffold import parse_module, read_claim_side, read_declarations, read_tolerance
    from navsym.prove.ladder import decide_within

    given = read_declarations(parse_module(source), positive)
    printed = read_claim_side(draft.printed, "--printed", given)
    derived = read_claim_side(draft.derived, "--derived", given)
    tolerance = None if draft.tolerance is None else read_tolerance(draft.tolerance)
    return decide_within(Equation(printed, derived, tolerance=tolerance))


def undeclared_names(source: str, draft: Any) -> frozenset[str]:
    """Names of the two sides that neither the file nor the caller declares."""
    from navsym.language.scaffold import EXAMPLE, parse_module, read_claim_side, read_declarations

    given = read_declarations(parse_module(source.replace(EXAMPLE, "", 1)), draft.positive)
    sides = read_claim_side(draft.printed, "--printed"), read_claim_side(draft.derived, "--derived")
    return frozenset(s.name for side in sides for s in side.free_symbols) - frozenset(given)


def declare_verdict(draft: Any, verdict: Verdict, slip: str) -> Any:
    """The draft with its verdict, and with words where a refuted one needs some."""
    refuted = verdict.status == "REFUTED"
    reason = draft.reason or ("say here what is wrong" if refuted else "")
    return replace(draft, expect=str(verdict.status), reason=reason, slip=slip if refuted else "")
