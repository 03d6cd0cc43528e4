"""The numerical experiments of papers, run again by name."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from navsym.claims.paper import experiment_names, import_paper
from navsym.core.answers import Answer
from navsym.core.choice import one_of
from navsym.core.errors import DomainError
from navsym.language.names import quote

#: What an experiment may take beside its seed.
OPTIONS = ("runs", "steps", "journal")


@dataclass(frozen=True, slots=True, eq=False)
class Experiment(Answer):
    """Figures of a paper's experiment; the answer of :func:`simulate`.

    name : of the paper; figures : plain data, as the experiment gives them
    """

    name: str
    figures: dict[str, Any]

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym simulate``."""
        return self.figures

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
        """Headings and rows of the table for people."""
        heads, lines = study_of(self.name).as_table(self.figures)
        return heads, lines

    def __repr__(self) -> str:
        heads, lines = self.table()
        return f"<Experiment {self.name}: {len(lines)} rows of {len(heads)} columns>"


def simulate(
    name: str,
    *,
    runs: int | None = None,
    steps: int | None = None,
    seed: int = 1,
    journal: str | os.PathLike[str] | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Experiment:
    """Run the numerical experiment of a paper again, with confidence intervals where it is random.

    name     : of the paper: ``joint_correction``, ``multistructure``, ``terrain_search`` or ``trajectory``
    runs     : Monte-Carlo runs; steps : time steps of each run; default: those of the study
    seed     : same seed, same answer
    journal  : file that keeps finished runs, where the study has one; a second call goes on from it
    progress : called with (finished, all)

    Returns :class:`Experiment`; units stand in its headings. Raises NavsymError of kind ``domain`` for a name that is
    not known and for an option that the study does not have. Source: the paper of that name.

    >>> import navsym as nav
    >>> found = nav.simulate("multistructure", runs=4, steps=2)
    >>> [row["method"] for row in found.document()["methods"]][:2]
    ['exact', 'pulsating']
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise DomainError(f"expected a seed of at least 0; got {quote(seed)}; choose another", where="simulate: seed")
    accepted = options_of(name)
    given = {"runs": runs, "steps": steps, "journal": journal}
    options = {key: value for key, value in given.items() if value is not None}
    for option, value in options.items():
        if option not in accepted:
            takes = ", ".join(("seed", *accepted))
            message = f"expected an option that {name} has ({takes}); got {option}; leave it out"
            raise DomainError(message, where=f"simulate: {option}")
        if option != "journal" and (isinstance(value, bool) or not isinstance(value, int)):
            message = f"expected a whole number; got {quote(value)}; give one"
            raise DomainError(message, where=f"simulate: {option}")
    return Experiment(name, study_of(name).study(seed=seed, progress=progress, **options))


def options_of(name: str) -> tuple[str, ...]:
    """The options beside the seed that the experiment of a paper takes; DomainError for another name."""
    accepted = inspect.signature(study_of(name).study).parameters
    return tuple(option for option in OPTIONS if option in accepted)


def study_of(name: str) -> ModuleType:
    """The module of an experiment: ``study`` gives its figures, ``as_table`` headings and rows."""
    return import_paper(f"{one_of(str(name), experiment_names(), 'name')}.experiment.study")
