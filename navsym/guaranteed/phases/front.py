"""The front of the search: a model and ranges of one parameter or two."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from navsym.core.errors import DomainError, DuplicateError, ExpressionSyntaxError
from navsym.guaranteed.phases.answer import PhaseMap, Phases, Question
from navsym.guaranteed.phases.budget import DEFAULT_SECONDS, Budget
from navsym.guaranteed.phases.driver import Ends, find_phases
from navsym.guaranteed.phases.family import declared_symbol, family_of
from navsym.guaranteed.phases.plane import find_map
from navsym.guaranteed.problem import GuaranteedProblem
from navsym.language.files import file_in_errors
from navsym.language.values import read_constant
from navsym.models.model import contents_of
from navsym.models.modelfile import BasisFile, ModelFile

if TYPE_CHECKING:
    from navsym.models.model import Model


def phases(
    model: Model | str | os.PathLike[str],
    target: str | None = None,
    *,
    parameter: str | Sequence[str] = "T",
    quick: bool = False,
    unique: bool = False,
    seconds: float = DEFAULT_SECONDS,
    values: Mapping[str, Any] | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
    **parameters: Any,
) -> Phases | PhaseMap:
    """The guaranteed optimum for every value of one parameter or two: regimes, boundaries, closed forms.

    On each regime the optimal estimator measures in one pattern. A closed form of value, times and weights is proved
    for every value of the parameter; elsewhere the optimum is certified for every value by enclosures. With two
    parameters the answer is a :class:`PhaseMap`: regions with closed forms, each proved as a whole, equations of the
    curves between them and the points where these meet; what is not proved is listed in ``uncovered``.

    model      : a :class:`navsym.Model`, or the path of a model file
    target     : name of the target; not needed where the model has one
    parameters : a pair is the range of the parameter that varies, such as ``T=("0", "2*pi")``; two pairs make a
                 map; a single value is put in for another parameter
    parameter  : the parameter that varies, or two, over declared ranges, where no pair is given
    quick      : leave regimes without a closed form uncertified
    unique     : also prove of closed forms that no other estimator is optimal (slower)
    seconds    : processor time after which the search stops; ``uncovered`` then names what is left
    values     : the same as ``parameters``, for names that are taken by the arguments above
    progress   : called with (finished, all) steps

    Raises DomainError for a range that is empty or missing, NotEstimableError, UnknownSymbolError for an unknown
    parameter, and the errors of model files.

    >>> import navsym as nav
    >>> drift = nav.phases("examples/schuler-velocity.toml", "drift", T=("2", "3"))
    >>> for regime in drift.regimes:
    ...     print(regime)
    Regime(2 < T < 2*pi/3: ..., PROVED)
    Regime(2*pi/3 < T < 3: -1/cos(T), PROVED)
    """
    twice = next((name for name in parameters if name in (values or {})), None)
    if twice is not None:
        raise DuplicateError(f"expected one value; got two of {twice}; give one", where=f"phases: {twice}")
    given = {**(values or {}), **parameters}
    pairs = {name: value for name, value in given.items() if isinstance(value, (tuple, list))}
    names = names_of_parameters(model, pairs, parameter, {"quick": quick, "unique": unique})
    fixed = {name: value for name, value in given.items() if name not in pairs}
    with file_in_errors(model):
        contents = contents_of(model, None, fixed, "phases")
        first, *second = [range_ends(contents, name, pairs.get(name)) for name in names]
        family = family_of(contents, target, *names)
        answer: Phases | PhaseMap
        if second:
            beside = declared_symbol(contents, names[1])
            answer = find_map(family, beside, first, second[0], Budget.of(seconds), progress)
        else:
            answer = find_phases(family, *first, certify=not quick, unique=unique, seconds=seconds, progress=progress)
    return replace(answer, question=Question(model, target, fixed))


def names_of_parameters(
    model: Any, pairs: Mapping[str, Any], parameter: str | Sequence[str], options: Mapping[str, bool]
) -> list[str]:
    """The one or two parameters that vary. Raises DomainError, also for options that a map does not have."""
    if isinstance(model, GuaranteedProblem):
        message = "expected a model with a free parameter; got a problem, whose numbers are all given; give the model"
        raise DomainError(message, where="phases: model")
    names = [*pairs] or ([parameter] if isinstance(parameter, str) else [*parameter])
    if not 1 <= len(set(names)) == len(names) <= 2:
        got = ", ".join(map(str, names)) or "none"
        raise DomainError(f"expected a range, or two; got those of {got}; give values to the others", where="phases")
    for name in (name for name, value in options.items() if value and len(names) == 2):
        message = "expected one range with it; got two; leave it out, or give one parameter a value"
        raise DomainError(message, where=f"phases: {name}")
    return names


def range_ends(contents: ModelFile | BasisFile, name: str, pair: Sequence[Any] | None) -> Ends:
    """The ends of a range that is given, or of the one that the model declares for the parameter.

    Raises ExpressionSyntaxError for other than two ends, and DomainError where there is no range.
    """
    where = f"phases: {name}"
    if pair is not None:
        if len(pair) != 2:
            got = f"{len(pair)}"
            raise ExpressionSyntaxError(f'expected two ends; got {got}; write {name}=("0", "2*pi")', where=where)
        unit = next((p.unit for p in contents.parameters.values() if p.name == name), "")
        lower, upper = (read_constant(end, where, unit) for end in pair)
        return lower, upper
    for symbol, ends in contents.box.items():
        if symbol.name == name and None not in ends:
            return ends
    message = f'expected a range of {name}; got none; give {name}=("0", "2*pi") (--range "0, 2*pi")'
    raise DomainError(message, where=where)
