"""From whatever can be exported to a folder of verified code."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from navsym.claims import Verdicts
from navsym.core.errors import DomainError, EmptyError
from navsym.export.languages.targets import find_targets
from navsym.export.materials import functions_from
from navsym.export.package import COUNT, LICENSE, Exported, Order, license_id, write_export
from navsym.export.parts import ExportedFunction
from navsym.export.ready import READY
from navsym.export.streams import export_guard, guard_of
from navsym.language.names import quote

MOST_VECTORS = 100_000
LONGEST_UNIT = 60


def export(
    item: Any,
    to: str | Sequence[str] = "c",
    out: str | os.PathLike[str] = "export",
    *,
    real: str = "double",
    force: bool = False,
    allow_confirmed: bool = False,
    license: str = LICENSE,
    vectors: int = COUNT,
    units: Mapping[str, str] | None = None,
    run: bool = True,
    command: Sequence[str] = (),
    progress: Callable[[int, int, str], None] = lambda done, of, doing: None,
) -> Exported:
    """Write proved formulas as code with test vectors, rounding bounds and certificates, compiled and run here.

    A claim that does not hold is refused, with the one that corrects it; code outside its enclosures is not written.

    item  : id of a claim ("guaranteed_velocity:4.13.y3", "claims.toml:ratio"), regimes "A+B", a ready-made name
            ("kalman"), or a list of these; a verdict of :func:`navsym.prove`; an Estimator, as a function of its
            measurements; Phases with closed forms, as functions of the parameter; a Derivation, as Phi and the
            regressors; a Model or its file, as F, H, Phi, Qd and steps of a Kalman filter in Joseph's and UD form; a
            Guard or its file, as its streaming rule; a conversion, as T and its inverse; an Audit, as it should be
    to    : languages: c, cpp, python, batch, javascript, rust, fortran, casadi, wasm, html, julia, octave
    out   : folder for the code; made when it is not there
    real  : "double" or "float"; force : replace files that are there
    allow_confirmed : accept claims that were only sampled
    license  : SPDX identifier for the headers
    vectors  : test vectors for each function
    units    : symbol or result -> unit, for the documentation of the code
    run      : compile and run the code where this machine can
    command  : words for the manifest that make the same export again
    progress : called with (done, all, name) after each part

    Raises RefusedError (does not hold), FailedError (code outside its enclosures), FolderError, DomainError (no code).

    >>> import navsym as nav
    >>> half = nav.prove("tan(a/2) = sin(a)/(1 + cos(a))", a=("0", "3"))
    >>> nav.export(half, to="python", out="build")
    <export of formula to build: python verified>
    >>> nav.check("build").accepted
    True
    """
    require_export_options(real, license, vectors, units)
    targets = tuple(find_targets([to] if isinstance(to, str) else to, real))
    given = list(item) if isinstance(item, (list, tuple, Verdicts)) else [item]
    guard = guard_of(given, real)
    items = [part for i in given for part in (READY.get(i, (i,)) if isinstance(i, str) else (i,))]
    functions, total = list[ExportedFunction](), len(items) + len(targets)
    for done, part in enumerate([] if guard else items, start=1):
        functions += functions_from(part, real=real, allow_confirmed=allow_confirmed, units=units)
        progress(done, total, part if isinstance(part, str) else "")
    if not guard and not functions:
        raise EmptyError("expected what to export; got an empty list; name a claim or give an answer", where="export")
    steps = iter(range(len(items) + 1, total + 1))
    words = tuple(command) or (f"navsym.export({', '.join(f.name for f in functions) or 'guard'})",)
    order = Order(targets, license, vectors, words, force, run, lambda language: progress(next(steps), total, language))
    return export_guard(guard, order, Path(out)) if guard else write_export(functions, order, Path(out))


def require_export_options(real: Any, license_: Any, vectors: Any, units: Any) -> None:
    """Refuse a type, licence, number of vectors or units that are none; raises DomainError."""
    if not isinstance(real, str) or real not in ("double", "float"):
        raise DomainError(f"expected double or float; got {quote(real)}; correct it", where="real")
    if not isinstance(vectors, int) or isinstance(vectors, bool) or not 4 <= vectors <= MOST_VECTORS:
        raise DomainError(f"expected 4 to {MOST_VECTORS} vectors; got {vectors!r}; correct it", where="vectors")
    license_id(str(license_))
    for name, unit in (units or {}).items():
        text = f"{name}={unit}"
        if not (name and unit) or len(str(unit)) > LONGEST_UNIT or not (text.isascii() and text.isprintable()):
            raise DomainError(f"expected NAME=UNIT in ASCII; got {text[:60]!r}; correct it", where="unit")
