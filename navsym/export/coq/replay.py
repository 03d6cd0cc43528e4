"""A proof kernel beside the checker: theories are written, compiled by Coq, and the axioms they rest on are read."""

from __future__ import annotations

import re
import shutil
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from navsym.core.errors import DomainError, MissingEngineError
from navsym.export import processes
from navsym.export.coq.theory import write_theory

KERNELS = ("coq",)


@dataclass(frozen=True, slots=True)
class Replay:
    """What a proof kernel says of one certificate.

    status  : PROVED, FAILED where its tactics find no proof, UNWRITTEN where no theory is written for it
    axioms  : names of those that the theorems rest on
    seconds : wall time of the compilation
    file    : the theory, or None
    why     : the reason of a status that is not PROVED
    """

    name: str
    version: str
    status: str
    axioms: tuple[str, ...] = ()
    seconds: float = 0.0
    file: str | None = None
    why: str = ""


def require_kernel(name: Any) -> str:
    """The version of a proof kernel; DomainError for one that is not known, MissingEngineError where it is not here."""
    if name not in KERNELS:
        raise DomainError(f"expected one of {', '.join(KERNELS)}; got {name!r}; choose one", where="kernel")
    version = coq_version()
    if version is None:
        raise MissingEngineError(
            "expected Coq with its library Interval; got no coqc that has it; install the packages coq and "
            "libcoq-interval of Debian, or coq-interval of opam",
            where="kernel",
        )
    return version


@cache
def coq_version() -> str | None:
    """The version of coqc on this machine, None where there is none that has its libraries."""
    if shutil.which("coqc") is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        theory = Path(folder, "libraries.v")
        theory.write_text("From Interval Require Import Tactic.\n", "utf-8")
        status, _ = processes.run(["coqc", "-q", theory.name], Path(folder))
        _, text = processes.run(["coqc", "--print-version"], Path(folder))
    return text.split()[0] if status == 0 and text.split() else None


def replay(certificate: Mapping[str, Any], file: Path, kernel: str = "coq") -> Replay:
    """Write the theory of a certificate that the checker has accepted, and have the kernel compile it.

    file : where the theory is written

    Raises the errors of :func:`require_kernel`.
    """
    version = require_kernel(kernel)
    try:
        text = write_theory(certificate)
    except DomainError as error:
        return Replay(kernel, version, "UNWRITTEN", why=error.message)
    file.write_text(text, "utf-8")
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "theory.v").write_text(text, "utf-8")
        status, output = processes.run(["coqc", "-q", "theory.v"], Path(folder))
    seconds = round(time.perf_counter() - began, 2)
    if status != 0:
        why = " ".join(output.split()[-30:]) or "coqc ended without a word"
        return Replay(kernel, version, "FAILED", seconds=seconds, file=str(file), why=why)
    return Replay(kernel, version, "PROVED", read_axioms(output), seconds, str(file))


def read_axioms(output: str) -> tuple[str, ...]:
    """Names after the line ``Axioms:``; a name starts its line."""
    _, _, listed = output.partition("Axioms:\n")
    return tuple(dict.fromkeys(re.findall(r"^([A-Za-z_][\w.']*)(?=\s*(?::|$))", listed, re.M)))
