"""Observability of a model: the answer of the front door, and reading of what may be asked beside it."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from html import escape
from typing import Any

import sympy as sp

from navsym.claims.display import display_latex, latex_of, write_card, write_table
from navsym.claims.statement import Box
from navsym.core.answers import Answer
from navsym.core.errors import DomainError, DuplicateError, ExpressionSyntaxError, ShapeError
from navsym.language.expression import parse, symbol
from navsym.language.files import file_in_errors
from navsym.language.names import RESERVED, join_place, quote, require_flag, require_table
from navsym.language.values import write_entries, write_value
from navsym.models.along import model_along_motion
from navsym.models.linear import LinearModel, linear_row
from navsym.models.model import Model, contents_of
from navsym.models.modelfile import ModelFile
from navsym.observability.accuracy import Accuracy, ask_accuracy
from navsym.observability.chains import (
    JointObservability,
    MeasurementObservability,
    direction_names,
    functional_names,
    need_observable,
    observe_jointly,
    prove_rank,
)
from navsym.observability.document import as_html, as_latex, document_of_observability, list_proofs
from navsym.observability.inputs import observe_driven
from navsym.observability.null_space import NullSpace, follow_directions, read_points
from navsym.observability.pieces import observe_pieces
from navsym.observability.rank_drops import DropList, RankDrop, find_drops
from navsym.observability.sensors import Restoration, restore_observability
from navsym.observability.splits import FeasibleSplit, Split, best_split, choose_split, feasible_splits
from navsym.observability.two_stage import POLE, Stage, StageGains, gains_by_poles, list_stages, stage_gains

#: Variable of polynomials that prescribe poles.
VARIABLE = "p"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Observability(Answer):
    """Observability of a model: the directions of the state that its measurements determine.

    Ranks hold for generic parameters; ``rank_drops`` lists the special ones.

    name                : of the model
    joint               : chains, dimensions and the staircase of all measurements
    rank_drops          : where a dimension drops for special parameters
    rank_drops_complete : subspace -> whether the list of its drops is proved to hold all of them
    kind                : "constant", "discrete", "varying", "nonlinear" or "pieces"
    frozen_rank         : of a varying model, the rank that it has with F and h frozen at one time: another question
    inputs              : unknown inputs; what is observed holds whatever they are
    rank_drops_open     : subspace -> conditions under which nothing was decided when the search ended
    pieces              : of a model in pieces, from, to and the rank of each by itself
    splits, best_split  : two-stage splits of two measurements that observe all; empty and None elsewhere
    split               : the chosen split, None where there is none
    gains               : of the stages, None unless poles were asked for
    restoration         : the fewest further measurements, None unless asked for
    candidates          : names of what could be measured
    contents            : what the model says beside its matrices: noise, interval and targets
    staged              : of three and more measurements the stages with gains, where poles were asked for

    >>> import navsym as nav
    >>> nav.observe("examples/schuler-velocity.toml")
    Observability(schuler-velocity: rank 3 of 3, observable, 0 rank drops)
    """

    name: str
    model: LinearModel
    joint: JointObservability
    rank_drops: tuple[RankDrop, ...]
    rank_drops_complete: Mapping[str, bool]
    splits: tuple[FeasibleSplit, ...] = ()
    best_split: FeasibleSplit | None = None
    split: Split | None = None
    gains: StageGains | None = None
    restoration: Restoration | None = None
    candidates: tuple[str, ...] = ()
    kind: str = "constant"
    frozen_rank: int | None = None
    pieces: tuple[Mapping[str, Any], ...] = ()
    inputs: tuple[str, ...] = ()
    rank_drops_open: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    contents: ModelFile | None = None
    staged: tuple[Stage, ...] = ()

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the n states."""
        return self.joint.states

    @property
    def measurements(self) -> tuple[MeasurementObservability, ...]:
        """The subspace of each measurement by itself: name, dimension, basis (m, n), companion coefficients."""
        return self.joint.measurements

    @property
    def rank(self) -> int:
        """Dimension of what all measurements observe together."""
        return self.joint.joint_dimension

    @property
    def observable(self) -> bool:
        """True when the measurements together determine all states, for all but special parameters."""
        return self.joint.observable

    @property
    def unobservable(self) -> tuple[str, ...]:
        """Directions that no measurement shows, by their components: ``"(x1, x3) = (1, -2)"``."""
        rows = self.unobservable_basis
        return tuple(direction_names(rows[k, :], self.states) for k in range(rows.rows))

    @property
    def observable_functionals(self) -> tuple[str, ...]:
        """Combinations of states that span what is observed, such as ``"x1 + 2*x3"``.

        Of a nonlinear model, of their differentials: ``"k*dS + S*dk"`` is the differential of k S.
        """
        rows = self.joint.observed
        names = [f"d{state}" for state in self.states] if self.kind == "nonlinear" else self.states
        return tuple(functional_names(rows[k, :], names) for k in range(rows.rows))

    @property
    def redundant(self) -> tuple[str, ...]:
        """Measurements that show nothing beside those before them."""
        pairs = zip(self.measurements, self.joint.staircase, strict=True)
        return tuple(measurement.name for measurement, count in pairs if count == 0)

    @property
    def unobservable_basis(self) -> sp.ImmutableMatrix:
        """Rows (n - rank, n) of the directions that no measurement shows."""
        return self.joint.unobservable

    def accuracy(
        self,
        T: Any = None,
        *,
        every: Any = None,
        demands: Mapping[str, Any] | None = None,
        scales: Mapping[str, Any] | None = None,
        start: Mapping[str, Any] | None = None,
    ) -> Accuracy:
        """How well a flight shows the targets: their least standard deviations at its end, enclosed (Cramer and Rao).

        T       : length of the flight, a fraction; by default the interval of the model
        every   : time between samples, the first at 0; by default noise that is white in time, of density sigma**2
        demands : target -> wanted deviation; the answer says when it is met
        scales  : state -> the unit in which it counts for the weakest direction; by default 1
        start   : what moves -> its value at the start: states of a nonlinear model, and parameters with rates

        Raises DomainError for parameters without a value, for inputs and for relations, EmptyError without an interval,
        UnobservableError for pieces that leave a direction open, UnknownSymbolError, and TooLargeError.

        >>> import navsym as nav
        >>> track = nav.Model("p v", F=[[0, 1], [0, 0]], H=["p"], sigma=["1/2"], interval=8)
        >>> nav.observe(track).accuracy()
        Accuracy(model at t = 8: p 0.35355339059327, v 0.076546554461974)
        """
        assert self.contents is not None
        moving = self.model.rates
        question = ask_accuracy(self.contents, self.joint, moving, T, every, demands or {}, scales or {}, start or {})
        return question.answer(self.name)

    def stages(self, poles: Any = (), piece: int | None = None) -> tuple[Stage, ...]:
        """The estimator in stages, one for each measurement, with gains by wanted polynomials.

        poles : characteristic polynomials in p, one per stage: "(p + 1)**2; p + 2; p + 3", or a list; none by default
        piece : of a model in pieces the leg, from 1, which has to show all states by itself

        Raises DomainError for models that move and for roots that are not on the left, ShapeError for a wrong number or
        degree, UnobservableError.

        >>> import navsym as nav
        >>> three = nav.Model("x v b", F=[[0, 1, 0], [0, 0, 1], [0, 0, 0]], H=["x", "b", "v"])
        >>> [(stage.measurement, stage.K) for stage in nav.observe(three).stages("(p + 1)**3")]
        [('z1', (3, 3, 1))]
        """
        contents, joint = self.contents, self.joint
        assert contents is not None
        if self.kind == "pieces":
            if piece is None or not 1 <= piece <= len(contents.pieces):
                message = f"expected the number of a piece, 1 to {len(contents.pieces)}; got {piece}; choose one"
                raise DomainError(message, where="observe: piece")
            model = model_along_motion(contents, contents.pieces[piece - 1])
            joint = observe_jointly(model)
        else:
            model = self.model
        if contents.inputs or contents.Phi is not None or not model.constant:
            message = "expected constant F and H for stages; got a model that moves, steps or inputs; leave them out"
            raise DomainError(message, where="observe: stages")
        return list_stages(joint, read_poles(poles, contents) if poles else ())

    def null_space(
        self,
        H: Sequence[Any],
        Phi: Sequence[Any] = (),
        *,
        first: Mapping[str, Any] | None = None,
        symbols: Mapping[str, Any] | None = None,
    ) -> NullSpace:
        """Whether the Jacobians of a filter keep the directions that no measurement shows, each PROVED or REFUTED.

        H, Phi  : matrices of formulas for each step: H_k as it is evaluated, and Phi_k from there to the next step
        first   : state -> formula of the point at which the first step is linearised; by default its own name
        symbols : declarations of names in H and Phi, as in :func:`navsym.prove`; real without one

        A direction N is kept where all of ``H_0 N, H_1 Phi_0 N, H_2 Phi_1 Phi_0 N, ...`` vanish for all symbols.
        Raises UnobservableError for a model that shows all, ShapeError, and the errors of the prover.

        >>> import navsym as nav
        >>> world = nav.Model("x m", dynamics=["u", "0"], H=["(m - x)**2"], u="real")
        >>> nav.observe(world).null_space([[["-2*(m0 - x0)", "2*(m0 - x0)"]]])
        NullSpace((x, m) = (1, 1) PROVED)
        """
        rows = self.unobservable_basis
        listed = {name: list(rows.row(k)) for k, name in enumerate(self.unobservable)}
        return follow_directions(listed, H, Phi, read_points(first or {}, self.states), symbols or {})

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym observe``; expressions are text of the language of files."""
        return document_of_observability(self)

    def certificates(self) -> list[Mapping[str, Any]]:
        """The generic rank and every rank that is left on a drop, as far as the checker grants them."""
        return [item for item in list_proofs(self).values() if not isinstance(item, str)]

    def latex(self) -> str:
        """The decomposition as a fragment of LaTeX, one display for each formula."""
        return as_latex(self)

    def page(self) -> str:
        """The decomposition as an HTML page of its own, formulas in MathML."""
        return as_html(self, self.name)

    def __repr__(self) -> str:
        word = "observable" if self.observable else f"unobservable {', '.join(self.unobservable)}"
        drops = f"{len(self.rank_drops)} rank drop{'' if len(self.rank_drops) == 1 else 's'}"
        return f"Observability({self.name}: rank {self.rank} of {len(self.states)}, {word}, {drops})"

    def _repr_html_(self) -> str:
        """Dimensions and companion coefficients as a table, for notebooks."""
        n, word = len(self.states), "observable" if self.observable else "not observable"
        rows = [
            (m.name, f"{m.dimension} of {n}", k, display_latex(latex_of(m.companion)))
            for m, k in zip(self.measurements, self.joint.staircase, strict=True)
        ]
        heads = ("measurement", "observes", "taken", "companion coefficients")
        lines = [f"<b>{word}</b>: {self.rank} of {n} dimensions", write_table(heads, rows)]
        lines += [f"unobservable: {escape('; '.join(self.unobservable))}"] if self.unobservable else []
        for drop in self.rank_drops:
            zeros = " and ".join(rf"{latex_of(zero)} = 0" for zero in drop.zeros)
            lines.append(escape(f"the rank of {drop.subspace} drops where {display_latex(zeros)}"))
        return write_card(lines)

    def _repr_latex_(self) -> str:
        """Observed bases and companion coefficients, for notebooks."""
        shows = [
            rf"A_{{{k}}} = {latex_of(m.basis)}, \quad \vartheta^{{({k})}} = {latex_of(m.companion)}"
            for k, m in enumerate(self.measurements, start=1)
        ]
        return display_latex(r" \qquad ".join(shows))


def observe(
    model: Model | LinearModel | str | os.PathLike[str],
    *,
    split: tuple[int, int] | str | None = None,
    poles: Any = None,
    restore: bool = False,
    candidates: Mapping[str, Any] | None = None,
    values: Mapping[str, Any] | None = None,
    **parameters: Any,
) -> Observability:
    """Exact observability of a model: ``dx/dt = F x``, ``dx/dt = f(x)`` or ``x_(k+1) = Phi x_k``, with ``z = h(x)``.

    Ranks are those of ``H, H F, ..., H F^(n-1)`` for generic parameters (Kalman); what each measurement observes is
    spanned by its chain ``a_1 = h, a_(j+1) = F^T a_j`` (Kalenova et al. 1979, (1.2), (1.4)). Where F and H hold
    the time or parameters with rates it is ``a_(j+1) = a_j' + F^T a_j`` (Silverman and Meadows 1967): the rank
    over an interval. A nonlinear model is linearised along its own motion, so that the rows are gradients of Lie
    derivatives (Hermann and Krener 1977): the local rank at a generic state. Pieces are stacked. Of a model in steps
    the rows are ``H, H Phi, ..., H Phi^(n-1)``: the first state from n steps or more. With unknown inputs a functional
    gives its derivative where no input enters it (Basile and Marro 1969).

    model      : a :class:`navsym.Model`, a LinearModel, or the path of a model file
    split      : (i, j), vectors taken from each of two measurements; by default (m, n - m)
    poles      : characteristic polynomials in p, one per stage (:meth:`Observability.stages`): "(p + 1)**2; p + 2"
    restore    : find the fewest further measurements that show every state
    candidates : name -> formula of the states that could be measured, for ``restore``; by default each state
    parameters : exact values of parameters, such as ``w="1/2"``; ``values`` is the same as a mapping

    Raises UnobservableError with the direction when a split or poles are asked for and the states are not observed,
    ShapeError for the wrong number of vectors or polynomials, DomainError for functions that cannot be
    read, roots that are not in the left half-plane, and regressors without F.

    >>> import navsym as nav
    >>> sensor = nav.Model("x v b", F=[[0, 1, 0], [0, 0, "g"], [0, 0, 0]], H=["x + b"], g="real")
    >>> answer = nav.observe(sensor, restore=True)
    >>> answer.rank, answer.observable, answer.unobservable
    (3, True, ())
    >>> [drop.zeros for drop in answer.rank_drops]
    [(g,), (g,)]
    >>> nav.observe(sensor, g=0).unobservable
    ('(x, b) = (1, -1)',)
    """
    restore, candidates = require_flag(restore, "observe: restore"), require_table(candidates, "observe: candidates")
    with file_in_errors(model):
        contents = contents_of(model, values, parameters, "observe")
        if not isinstance(contents, ModelFile):
            message = "expected a [model] with F and h; got a [basis] of regressors; give the system"
            raise DomainError(message, where="observe: model")
        if split is not None or poles is not None or restore or candidates:
            need_one_matrix(contents)
        if contents.inputs or len(contents.pieces) > 1:
            return observe_in_parts(contents)
        request = read_split(split) if split is not None else None
        many = len(contents.measurements) > 2
        polynomials = read_poles(poles, contents) if poles is not None and not many else ()
        rows = read_candidate_rows(candidates, contents) if restore or candidates else None
        found = observe_linear(model_along_motion(contents), contents.name, request, polynomials, rows, contents.box)
        found = replace(found, contents=contents)
        if contents.Phi is not None:  # a two-stage split is a statement on dx/dt = F x
            return replace(found, kind="discrete", splits=(), best_split=None, split=None)
        return replace(found, staged=found.stages(poles)) if poles is not None and many else found


def observe_in_parts(contents: ModelFile) -> Observability:
    """A model in pieces, or with unknown inputs: these without chains, and so without drops."""
    pieces: tuple[Mapping[str, Any], ...] = ()
    if contents.inputs:
        model, joint = observe_driven(contents)
        kind = "discrete" if contents.Phi is not None else kind_of(model)
        drops = DropList((), {"joint": False}, {})
    else:
        model, joint, pieces, drops = observe_pieces(contents)
        kind = "pieces"
    more: dict[str, Any] = {"kind": kind, "pieces": pieces, "inputs": tuple(contents.inputs), "contents": contents}
    more["rank_drops_open"] = drops.open
    return Observability(contents.name, model, joint, drops.drops, drops.complete, **more)


def need_one_matrix(contents: ModelFile) -> None:
    """Refuse splits, poles and candidates beside anything but one matrix F."""
    found = {
        "unknown inputs": contents.inputs,
        "dynamics": contents.dynamics,
        "steps Phi": contents.Phi is not None,
        f"{len(contents.pieces)} pieces": len(contents.pieces) > 1,
    }
    if any(found.values()):
        got = next(words for words, there in found.items() if there)
        message = f"expected one constant F for splits, poles and candidates; got {got}; leave them out"
        raise DomainError(message, where="observe: model")


def observe_linear(
    model: LinearModel,
    name: str = "model",
    request: tuple[int, int] | None = None,
    poles: Sequence[sp.Expr] = (),
    candidates: Mapping[str, Sequence[sp.Expr]] | None = None,
    box: Box | None = None,
) -> Observability:
    """Like :func:`observe` for exact data: poles in the symbol p, rows of candidates, empty for all states.

    box : ranges of parameters; rank drops outside of them are marked as excluded
    """
    joint = observe_jointly(model)
    if (request is not None or poles) and not model.constant:
        message = "expected constant F and H for splits and poles; got entries that move; leave them out"
        raise DomainError(message, where="observe: split")
    if request is not None or poles:
        need_observable(joint)
    two = model.constant and len(joint.measurements) == 2 and joint.observable
    if request is not None and not two:
        raise ShapeError(f"split: expected two measurements; got {len(joint.measurements)}; choose two of them")
    chosen = choose_split(joint, *(request or ())) if two else None
    drops = find_drops(joint, box)
    return Observability(
        name=name,
        model=model,
        joint=joint,
        rank_drops=drops.drops,
        rank_drops_complete=drops.complete,
        rank_drops_open=drops.open,
        splits=feasible_splits(joint) if two else (),
        best_split=best_split(joint) if two else None,
        split=chosen,
        gains=gains_for(joint, chosen, poles) if poles else None,
        kind=kind_of(model),
        frozen_rank=frozen_rank(model),
        restoration=restore_observability(model, candidates or None) if candidates is not None else None,
        candidates=tuple(candidates or model.states) if candidates is not None else (),
    )


def kind_of(model: LinearModel) -> str:
    """constant, varying or nonlinear."""
    if model.constant:
        return "constant"
    return "nonlinear" if {symbol.name for symbol in model.rates} & set(model.states) else "varying"


def frozen_rank(model: LinearModel) -> int | None:
    """Rank of a varying model with its time and moving parameters held, which is the answer to another question."""
    if kind_of(model) != "varying":
        return None
    still = LinearModel(model.F, None, model.H, model.states, model.measurements, sp.Dummy("still", real=True))
    return prove_rank(still).rank


def gains_for(joint: JointObservability, chosen: Split | None, poles: Sequence[sp.Expr]) -> StageGains:
    """Gains of one stage for one measurement, of two stages for two."""
    if chosen is not None:
        if len(poles) > 2:
            raise ShapeError(f"poles: expected at most two polynomials; got {len(poles)}; one per stage")
        return gains_by_poles(chosen, poles[0], poles[1] if len(poles) == 2 else None, POLE)
    if len(joint.measurements) != 1 or len(poles) != 1:
        raise ShapeError(
            "poles: expected one polynomial for one measurement or two for two; "
            f"got {len(poles)} for {len(joint.measurements)}; change the model or the poles"
        )
    K_x, stable = stage_gains(joint.measurements[0].companion, poles[0], "first", POLE)
    return StageGains(K_x, (), (stable, True))


# Reading of arguments


def read_split(value: Any) -> tuple[int, int]:
    """Two whole numbers, from a pair or from a text with a comma between them."""
    parts = re.fullmatch(r"\s*(\d{1,3})\s*,\s*(\d{1,3})\s*", value) if isinstance(value, str) else None
    if parts is not None:
        return int(parts[1]), int(parts[2])
    if isinstance(value, list | tuple) and len(value) == 2 and all(type(part) is int for part in value):
        return value[0], value[1]
    message = f'expected two numbers "i,j"; got {quote(value)}; write 3,2'
    raise ExpressionSyntaxError(message, where="observe: split")


def read_poles(value: Any, contents: ModelFile) -> tuple[sp.Expr, ...]:
    """Polynomials in p; names that the model does not declare are positive symbols of their own."""
    where = "observe: poles"
    declared = {name: parameter.symbol for name, parameter in contents.parameters.items()}
    if VARIABLE in declared:
        message = "expected p to be free for the variable of the polynomials; got a parameter p; rename the parameter"
        raise DuplicateError(message, where=where)
    texts = write_entries(value, where)
    if isinstance(texts, list) and not all(isinstance(text, str) for text in texts):
        raise ShapeError(f"expected polynomials in p; got {quote(value)}; give a list of texts", where=where)
    parts = [part for text in (texts if isinstance(texts, list) else [texts]) for part in text.split(";")]
    names = {name for part in parts for name in re.findall(r"[A-Za-z][A-Za-z0-9_]*", part)}
    names -= RESERVED | declared.keys() | {VARIABLE}
    for name in sorted(names & set(contents.states)):
        raise DuplicateError(f"expected a symbol of its own; got {name}, which is a state; rename it", where=where)
    known = {**declared, VARIABLE: POLE, **{name: symbol(name, positive=True) for name in sorted(names)}}
    return tuple(parse(part.strip(), known, where=where) for part in parts)


def read_candidate_rows(candidates: Mapping[str, Any], contents: ModelFile) -> dict[str, list[sp.Expr]]:
    """Rows of exact coefficients, from formulas of the states or rows of entries."""
    states = {name: symbol(name) for name in contents.states}
    known = {name: parameter.symbol for name, parameter in contents.parameters.items()}
    rows: dict[str, list[sp.Expr]] = {}
    for name, value in candidates.items():
        where = join_place("observe: candidates", name)
        if isinstance(value, list | tuple) or hasattr(value, "tolist"):
            rows[name] = [parse(text, known, where=where) for text in write_entries(value, where)]
        else:
            formula = parse(write_value(value, where), known | states, where=where)
            rows[name] = linear_row(formula, list(states.values()), where)
    return rows
