"""Functions from claims and answers: a claim of a paper or file, a verdict, an estimator, regimes, a derivation."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from navsym.audit.answer import Audit, AuditedQuestion, audit_specification
from navsym.audit.names import squeeze
from navsym.book.entries import Entry, book
from navsym.claims import CERTIFIED, OPEN, PROVED, Claim, Equation, Paper, Record, Verdict, equation_of
from navsym.conventions.converting import Conversion
from navsym.core.choice import one_of
from navsym.core.errors import DomainError
from navsym.core.sandbox import Exhausted, run_limited
from navsym.export.accuracy.continuation import horner
from navsym.export.algorithms.models import functions_of_model, matrix_function, plain_name, require_ranges
from navsym.export.functions import RefusedError, formula_lines, function_of, material, require_exportable
from navsym.export.languages.names import function_name
from navsym.export.parts import ExportedFunction, Layout, Material, Output, Source, inside
from navsym.export.ready import KALMAN, PAPERS, READY, algorithm, units_of_paper
from navsym.guaranteed.phases.answer import Phases, Regime, end_text
from navsym.guaranteed.phases.front import phases
from navsym.guaranteed.phases.tables import TablePiece, tabulate_regime
from navsym.guaranteed.solver import Estimator, solve
from navsym.language.algebra import to_sympy
from navsym.language.declarations import box_of, read_parameters, symbols_of
from navsym.language.expression import read_tree
from navsym.language.names import quote
from navsym.language.tomlfile import read_toml
from navsym.models.derivation import Derivation
from navsym.models.model import Model, contents_of
from navsym.models.modelfile import BasisFile
from navsym.prove.claimfile import FileClaim, claims_from, close_claim, decide_claim, read_claims, statement_of
from navsym.prove.ladder import leave_open
from navsym.prove.relations.judge import TextClaim
from navsym.prove.wording import expression_text
from navsym.verification.decide import decide_or_grant
from navsym.verification.papers import file_of_source, find_claim, is_model, load_papers, split_id

SECONDS = 90.0
MEGABYTES = 4096
LARGEST_DENOMINATOR = 10**9  # of an exact end; beyond it an end is the middle of an enclosure
EXPORTABLE = "a claim id, a verdict, an entry of the book, an Audit, Estimator, Phases, Derivation, Conversion or Model"


def functions_from(
    item: Any, *, real: str = "double", allow_confirmed: bool = False, units: Mapping[str, str] | None = None
) -> list[ExportedFunction]:
    """The functions of whatever can be exported; raises RefusedError for what does not hold, DomainError for the rest.

    item : claim id ``MODULE:NUMBER``, ``FILE.toml:ID`` or ``book:ID``, regimes ``A+B+C``, ``NAME=A``; a ready-made
           name, record, claim or entry; a verdict with its formula; estimator, phases, derivation, model or model file
    """
    units = units or {}
    if isinstance(item, Entry):
        item = f"book:{item.id}"
    if isinstance(item, str):
        return [f for part in READY.get(item, (item,)) for f in functions_of_claim(part, real, allow_confirmed, units)]
    claim = getattr(item, "claim", item)
    if isinstance(claim, (Claim, Record)):
        return functions_of_claim(claim.id, real, allow_confirmed, units)
    if isinstance(item, Verdict):
        part = material_of_verdict(item, allow_confirmed)
        return [function_of([part], real=real, name=function_name(part.claim), layout=Layout(units=units))]
    if isinstance(item, Audit) and item.questions:
        return [function_of_question(q, Path(item.files[0].file).stem, real, units) for q in item.questions]
    if isinstance(item, Estimator):
        return [function_of_estimator(item, real, units)]
    if isinstance(item, Phases):
        return [function_of_phases(item, real, units)]
    if isinstance(item, Model):
        return functions_of_system(item, real, units)
    if isinstance(item, Conversion):
        return functions_of_conversion(item, real, units)
    if isinstance(item, Derivation):
        return functions_of_derivation(item, real, units)
    raise DomainError(f"expected {EXPORTABLE}; got {quote(item)}; name one of these", where="export")


# Claims by their ids


def functions_of_claim(text: str, real: str, allow_confirmed: bool, units: Mapping[str, str]) -> list[ExportedFunction]:
    """The functions of one claim or of regimes ``A+B+C``; ``name=A+B`` gives a name; a ready-made program has two."""
    if text in (KALMAN, *PAPERS):
        return algorithm(text, lambda claim: material_of_claim(claim, allow_confirmed), real)
    if text.endswith(".toml") and is_model(path := file_of_source(text)):
        if "code" in read_toml(path):
            got, remedy = "an error model that is read from code", "write F as formulas in a model file"
            raise DomainError(f"expected formulas; got {got}; {remedy}", where=path.name)
        return functions_of_system(Model.load(path), real, units)
    name, _, claims = text.rpartition("=") if "=" in text else ("", "", text)
    module, _, target = split_id(claims)
    if module.endswith(".toml") and is_model(file := file_of_source(module)):
        return functions_of_target(file, target, real, units)
    if module.endswith(".toml") and "question" in read_toml(file := file_of_source(module)):
        if target:
            one_of(target, [question["name"] for question in read_toml(file)["question"]], file.name)
        asked = audit_specification(file, target or None).questions
        return [function_of_question(question, file.stem, real, units) for question in asked]
    parts = [material_of_claim(part, allow_confirmed) for part in split_regimes(claims)]
    known = {**units_of_paper(claims.partition(":")[0]), **units}
    return [function_of(parts, real=real, name=function_name(name) if name else None, layout=Layout(units=known))]


def split_regimes(text: str) -> list[str]:
    """The ids in ``A+B+C``: a plus joins two of them where an id follows that is no rest of one with a plus in it."""
    found: list[str] = []
    for part in re.split(r"\+(?=[^+:]+:)", text):
        path, _, start = found[-1].partition(".toml:") if found else ("", "", "")
        whole = start and f"{start}+{part}" in {
            claim.number for claim in load_papers([f"{path}.toml"], go_on=True)[0].claims
        }
        found[-1:] = [f"{found[-1]}+{part}"] if whole else [*found[-1:], part]
    return found


def material_of_claim(text: str, allow_confirmed: bool) -> Material:
    """A claim of a paper or of a file, decided."""
    module, _, number = split_id(text)
    if not module or not number:
        message = f"expected MODULE:NUMBER or FILE.toml:ID; got {text[:80]!r}; correct it"
        raise DomainError(message, where="claim")
    if module == "book":
        return material_of_verdict(book[number].prove(), allow_confirmed)
    paper, claim = find_claim(text)
    better = paper.correction_of(claim.id)
    correction = None if better is None else better.id
    if module.endswith(".toml"):
        return material_from_file(file_of_source(module), number, correction, allow_confirmed)
    return material_from_paper(paper.paper, claim, correction, allow_confirmed)


def material_from_paper(card: Paper, claim: Claim, correction: str | None, allow_confirmed: bool) -> Material:
    """A claim of a paper with its verdict; raises RefusedError, with the claim that corrects it, when it is refuted."""
    statement, equation = claim.derive(), equation_of(claim.number, card.equations)
    return material(
        claim.id,
        statement,
        decide_or_grant(statement, SECONDS),
        title=claim.title,
        paper=", ".join([*card.authors, card.title, str(card.year or "")]).strip(", "),
        equation=f"equation ({equation})" if equation else f"statement {claim.number}",
        correction=correction,
        allow_confirmed=allow_confirmed,
    )


def material_from_file(path: Path, wanted: str, correction: str | None, allow_confirmed: bool) -> Material:
    """A claim of a claim file, decided now."""
    claim = next(claim for claim in read_claims(path, go_on=True).claims if claim.id == wanted)
    outcome = run_limited(decide_claim, (claim,), SECONDS, MEGABYTES)
    verdict = leave_open(outcome) if isinstance(outcome, Exhausted) else outcome
    return material_of(
        claim,
        verdict,
        f"{path.stem}:{wanted}",
        title=claim.notes.get("title", str(claim.formula)),
        equation=f"claim {wanted}",
        paper=path.name,
        correction=correction,
        allow_confirmed=allow_confirmed,
    )


def material_of(claim: FileClaim | TextClaim, verdict: Verdict, label: str, **about: Any) -> Material:
    """A decided claim of a file; of one of the whole language, its closed side as a function of arrays."""
    if isinstance(claim, FileClaim):
        return material(label, statement_of(claim), verdict, **about)
    require_exportable(label, verdict, about.get("correction"), about["allow_confirmed"])
    part = material(label, statement_of(close_claim(claim)), verdict, **about)
    used = {str(s) for _, formulas in part.results for e in formulas for s in e.free_symbols}
    flat = {name: tuple(e for row in rows for e in row) for name, (_, rows) in claim.kinds.items()}
    # A symmetric matrix has entries twice: they stay single numbers.
    arrays = {n: names for n, names in flat.items() if used & {*names} and len({*names}) == len(names)}
    whole = frozenset(name for name, ends in claim.documents[0]["symbols"].items() if "integer" in ends[2])
    return replace(part, arrays=arrays, whole=whole)


ENTRY = re.compile(r"(\w+)\[(\d+(?:,\d+)*)\]", re.ASCII)


def function_of_question(found: AuditedQuestion, stem: str, real: str, units: Mapping[str, str]) -> ExportedFunction:
    """What a question of an audit expects, right where the code is wrong; the inputs are those of the code.

    An array of the code is one argument, row by row. Raises RefusedError where an entry is OPEN or has cases.
    """
    label = f"{stem}:{found.name}"
    for entry in found.entries:
        if entry.status == OPEN or entry.expected is None:
            got = f"entry {','.join(map(str, entry.entry))} of {found.name}, which is {entry.status} or has cases"
            raise RefusedError(f"expected a question whose entries are decided in one case; got {got}; ask for less")
    parameters = read_parameters({name: word for name, (_, word) in found.inputs.items()}, "code.symbols")
    symbols, box = symbols_of(parameters), box_of(parameters)
    cells = {e.entry: to_sympy(read_tree(e.expected, None), symbols) for e in found.entries if e.expected}
    rows, columns = (max(place[axis] for place in cells) for axis in (0, 1))
    matrix = sp.Matrix(rows, columns, lambda i, j: cells[i + 1, j + 1])
    arrays = arrays_of({name: spelling for name, (spelling, _) in found.inputs.items()})
    entry_of = {name: array for array, names in arrays.items() for name in names}
    order = tuple(dict.fromkeys(entry_of.get(name, name) for name in found.inputs))
    title = f"What question {found.name} expects of {found.entries[0].file}"
    layout = Layout(arrays=arrays, order=order, units=units)
    used = {s: ends for s, ends in box.items() if s in matrix.free_symbols}
    return matrix_function(label, matrix, None, title, real, layout, used)


def arrays_of(spellings: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    """Arrays of the code -> symbols of their entries, row by row; entries that the code does not read get a name."""
    places = dict[str, dict[tuple[int, ...], str]]()
    for name, spelling in spellings.items():
        if match := ENTRY.fullmatch(squeeze(spelling)):
            places.setdefault(match[1], {})[tuple(map(int, match[2].split(",")))] = name
    first = int(any("(" in spelling for spelling in spellings.values()))  # MATLAB counts from 1
    ranges = {
        base: [range(first, max(axis) + 1) for axis in zip(*known, strict=True)] for base, known in places.items()
    }
    return {
        base: tuple(places[base].get(at, f"{base}_unread_{'_'.join(map(str, at))}") for at in itertools.product(*axes))
        for base, axes in ranges.items()
    }


def functions_of_target(path: Path, target: str, real: str, units: Mapping[str, str]) -> list[ExportedFunction]:
    """The estimator of a target of a model file; of its one parameter with a range, the regimes."""
    free = [*contents_of(path, None, {}, "export").parameters]
    if len(free) > 1:
        message = f"expected a model of at most one parameter; got {', '.join(free)}; write values for the others"
        raise DomainError(message, where=str(path))
    answer = phases(path, target, parameter=free[0]) if free else solve(path, target)
    return functions_from(answer, real=real, units=units)


def functions_of_system(model: Model, real: str, units: Mapping[str, str]) -> list[ExportedFunction]:
    """The matrices of a model and the steps of its Kalman filter; DomainError for regressors."""
    contents = contents_of(model, None, {}, "export")
    if isinstance(contents, BasisFile):
        message = "expected a model with F and H; got a basis of regressors; export what nav.solve or nav.phases gives"
        raise RefusedError(message)
    return list(functions_of_model(contents, real, units))


def functions_of_conversion(found: Conversion, real: str, units: Mapping[str, str]) -> list[ExportedFunction]:
    """The transformation of the errors in both directions; RefusedError where it is not proved."""
    if not found.proved:
        raise RefusedError("expected a conversion that is proved; got one that is not; convert in smaller steps")
    problem, symbols, result = found.problem, symbols_of(found.problem.parameters), []
    known = {**box_of(problem.parameters), **{symbols[n]: ends for n, ends in problem.ranges.items() if n in symbols}}
    for name, texts, title in (
        ("T", found.T, "Errors of the card from those of the other: x_to = T x"),
        ("T_inverse", found.inverse, "The way back: x = T_inverse x_to"),
    ):
        matrix = sp.Matrix([[to_sympy(read_tree(cell, None), symbols) for cell in row] for row in texts])
        label = f"{plain_name(problem.name)}:{name}"
        require_ranges(sorted(map(str, matrix.free_symbols)), {s.name: ends for s, ends in known.items()})
        box = {s: ends for s, ends in known.items() if s in matrix.free_symbols}
        result.append(matrix_function(label, matrix, None, title, real, Layout(units=units), box))
    return result


# Answers of the front door


def material_of_verdict(verdict: Verdict, allow_confirmed: bool) -> Material:
    """A verdict of :func:`navsym.prove` with the formula that it is about."""
    if verdict.formula is None:
        message = "expected a verdict with its formula; got one without; export the claim by its id"
        raise DomainError(message, where="export")
    (claim,) = claims_from(verdict.formula.document()).claims
    title, label = str(verdict.formula), verdict.id
    return material_of(claim, verdict, label, title=title, equation=f"claim {label}", allow_confirmed=allow_confirmed)


def function_of_estimator(found: Estimator, real: str, units: Mapping[str, str]) -> ExportedFunction:
    """``estimate = sum w_k z_k`` with the times, and the guaranteed standard deviation, as one function of z."""
    if found.status != CERTIFIED:
        raise RefusedError(f"expected a CERTIFIED estimator; got one that is {found.status}; ask for fewer digits")
    count = range(1, len(found.support) + 1)
    z, w = ([sp.Symbol(f"{letter}{k}", real=True) for k in count] for letter in "zw")
    weights = [sp.Rational(point.text[1]) for point in found.support]
    times = [sp.Rational(point.text[0]) for point in found.support]
    value = (sp.Rational(found.lower) + sp.Rational(found.upper)) / 2
    rows = [f"z[{k}]: {point.measurement} at {point.text[0]}" for k, point in enumerate(found.support)]
    plain = dict(zip(w, weights, strict=True))
    results = [
        (Output("estimate"), [sum((a * b for a, b in zip(w, z, strict=True)), start=sp.S.Zero)]),
        (Output("times", (len(times),)), times),
        (Output("value"), [value]),
    ]
    source = Source(
        claim=f"estimator:{found.target}",
        title=f"Guaranteed estimate of {found.target}",
        status=str(found.status),
        method="exact primal-dual certificate",
        scope=f"{'; '.join(rows)}; weights, times and value to {found.digits} digits",
        formula=formula_lines([(output, [e.xreplace(plain) for e in flat]) for output, flat in results]),
        certificate=found.certificate,
    )
    part = Material(source.claim, results, {}, source, tuple(zip(w, weights, strict=True)))
    layout = Layout({"z": tuple(s.name for s in z)}, ("z",), {}, units)
    return function_of([part], real=real, name=function_name(found.target), layout=layout)


def function_of_phases(found: Phases, real: str, units: Mapping[str, str]) -> ExportedFunction:
    """Value, weights and times as functions of the parameter, one piece for each regime.

    A regime without a closed form is a table of polynomials, with the errors of interpolation as two more results.
    Raises RefusedError where a regime is not proved, or ends at a number known by its digits only.
    """
    name, parameter = found.target, found.parameter
    if found.uncovered:
        gap = " to ".join(found.uncovered[0])
        raise RefusedError(
            f"expected regimes on the whole range; got none proved for {parameter} from {gap}; narrow it"
        )
    tabled = any(regime.closed is None for regime in found.regimes)
    parts: list[Material] = []
    for regime in found.regimes:
        start, end = regime.ends
        sure = regime.status == CERTIFIED or (regime.closed is not None and regime.status == PROVED)
        lacking = "" if sure else str(regime.status)
        if regime.closed and any(e.is_Rational and e.q > LARGEST_DENOMINATOR for e in (regime.lower, regime.upper)):
            lacking = lacking or "an end without a closed form"
        if lacking:
            message = f"expected proved closed forms or tables; got {lacking} for {parameter} from {start} to {end}"
            raise RefusedError(f"{message}; choose another range, or export phases.at({parameter}=…)")
        if regime.closed is None:
            parts += [material_of_piece(found, regime, piece) for piece in tabulate_regime(regime)]
        else:
            parts.append(material_of_regime(found, regime, [sp.S.Zero] * 2 if tabled else []))
    parts = join_pieces(parts, found, real) if tabled else parts
    return function_of(parts, real=real, name=function_name(name), layout=Layout(units=units))


def material_of_regime(found: Phases, regime: Regime, errors: Sequence[sp.Expr]) -> Material:
    """Value, weights, times and the places of the measurements of one regime."""
    assert regime.closed is not None and regime.value is not None
    rows = [(point.measurement, point.at, point.weight) for point in regime.support]
    proof = replace(Source.of(regime.closed.verdict, claim=""), status=str(regime.status))
    return material_of_support(found, (regime.lower, regime.upper), regime.value, rows, errors, proof)


def material_of_piece(found: Phases, regime: Regime, piece: TablePiece) -> Material:
    """The same of one piece of a table, as polynomials in the share of the piece that the parameter has passed."""
    family = found.family
    share = sp.Symbol("share" if found.parameter != "share" else "part", real=True)
    power, rows, values = family.parameter**piece.shift, [], []
    for k, place, weight in piece.contacts:
        start, stop = family.panels[k]
        size = horner(weight, share) / power
        rows.append(
            (family.measurements[k], family.time(start + (stop - start) * horner(place, share)), size / family.sigma[k])
        )
        values.append([c if weight[0] > 0 else -c for c in weight])
    value = horner([sum(column) for column in itertools.zip_longest(*values, fillvalue=sp.S.Zero)], share) / power
    error, late = (expression_text(e) for e in (piece.error, piece.time_error))
    scope = f"value and sum of sigma |error of a weight| within {error}, times within {late}, beside rounding"
    method, status = "interpolation about the certified optimum", str(regime.status)
    proof = Source(claim="", status=status, method=method, scope=scope, certificate=piece.certificate)
    ends, errors = (piece.lower, piece.upper), [piece.error, piece.time_error]
    support = rows[:: -1 if family.backward else 1]
    made = material_of_support(found, ends, value, support, errors, proof)
    return replace(made, lets=((share, piece.share),))


def material_of_support(
    found: Phases,
    ends: tuple[sp.Expr, sp.Expr],
    value: sp.Expr,
    support: Sequence[tuple[str, Any, Any]],
    errors: Sequence[sp.Expr],
    proof: Source,
) -> Material:
    """Value, weights and times between two values of the parameter, with the sentences about them.

    support : (measurement, time, weight)
    errors  : of the value and of the times; none where no regime has a table
    proof   : the verdict on them
    """
    names = list(dict.fromkeys(found.family.measurements))
    columns: list[tuple[str, Sequence[Any]]] = [
        ("weights", [weight for *_, weight in support]),
        ("times", [at for _, at, _ in support]),
    ]
    if len(names) > 1:
        columns.append(("measurement", [sp.Integer(names.index(name)) for name, *_ in support]))
    results = [(Output("value"), [value])]
    results += [(Output(name, (len(column),)), list(column)) for name, column in columns]
    results += [(Output(name), [e]) for name, e in zip(("error", "time_error"), errors, strict=False)]
    formula = formula_lines(results)
    formula += tuple(f"measurement {k} is {name}" for k, name in enumerate(names) if len(names) > 1)
    start, end = map(end_text, ends)
    claim = f"phases:{found.target} for {found.parameter} from {start} to {end}"
    source = replace(proof, claim=claim, title=f"Guaranteed estimator of {found.target}", formula=formula)
    return Material(source.claim, results, {found.family.parameter: ends}, source)


def join_pieces(parts: Sequence[Material], found: Phases, real: str) -> list[Material]:
    """Pieces that meet: a gap without a number of the type in it is closed, and a piece without one is left out.

    The number of the type nearest to an end of the range stands for that end. Raises RefusedError for other gaps.
    """
    kind = np.float32 if real == "float" else np.float64
    first, last = (sp.Rational(float(kind(float(sp.N(end, 40))))) for end in (found.lower, found.upper))
    parameter, done, end = found.family.parameter, [], min(found.lower, first)
    for k, part in enumerate(parts, start=1):
        low, high = part.box[parameter]
        high = max(high, last) if k == len(parts) else high
        if inside(low, 1, real) > np.nextafter(kind(inside(end, -1, real)), kind(np.inf)):
            ends = f"{end_text(end)} to {end_text(low)}"
            raise RefusedError(f"expected tables on the whole range; got none from {ends}; narrow the range")
        if inside(end, 1, real) <= inside(high, -1, real):
            done.append(replace(part, box={parameter: (end, high)}))
            end = high
    return done


def functions_of_derivation(found: Derivation, real: str, units: Mapping[str, str]) -> list[ExportedFunction]:
    """Transition matrix Phi(t) and regressors H(tau) of a model in one piece, each proved by its differential equation.

    ``Phi' = F Phi`` and ``H' = H F`` are decided here. Raises RefusedError for a basis, or a model in several pieces.
    """
    if len(found.system) != 1:
        came = "a basis, which has none" if not found.system else f"{len(found.system)} pieces"
        raise RefusedError(f"expected a model with one matrix F; got {came}; export what nav.solve or nav.phases gives")
    F, Phi, rows = found.system[0], found.transition[0].matrix, found.pieces[0].rows
    time = next(iter(Phi.free_symbols - F.free_symbols), sp.Symbol("t", real=True))
    label, layout = plain_name(found.name), Layout(units=units)
    phi_law, h_law = Equation(Phi.diff(time), F * Phi), Equation(rows.diff(found.time), rows * F)
    return [
        matrix_function(f"{label}:Phi", Phi, phi_law, "Transition matrix, Phi' = F Phi", real, layout),
        matrix_function(f"{label}:H", rows, h_law, "Regressors of the state at the end, H' = H F", real, layout),
    ]
