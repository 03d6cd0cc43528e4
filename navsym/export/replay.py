"""Others who look at an accepted certificate: a proof kernel, and a second checker that shares no code with the first.

Coq compiles a theory of the statement, and the axioms it rests on are read. The second checker, in OCaml, is compiled
from its own sources when it is first asked. What was said of a certificate is kept by its content, and reports show it.
"""

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import tempfile
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from navsym.core.errors import DomainError, MissingEngineError, OutputError
from navsym.core.store import default_path, key_of
from navsym.export import processes
from navsym.export.coq.theory import write_theory
from navsym.verification.certificates import JUDGES, keep_outcome, read_outcomes

REMEDIES = {
    "coq": "expected Coq with its library Interval; got no coqc that has it; install the packages coq and "
    "libcoq-interval of Debian, or coq-interval of opam",
    "ocaml": "expected OCaml with its library zarith; got no compiler that has it; install the packages ocaml-nox, "
    "ocaml-findlib and libzarith-ocaml-dev of Debian, or zarith of opam",
}
#: The second checker, in the order in which its files need each other.
SOURCES = tuple(
    Path(__file__).with_name("ocaml") / f"{name}.ml"
    for name in "text tree ball value algebra calculus goal cones rules language answers statement condition "
    "observability gap bounds sized words checker".split()
)
#: Seconds for one certificate: no answer is to depend on them, so they are many times what one takes.
PATIENCE = 600
COMPILE = "ocamlfind ocamlopt -w +a-4-9-40-41-42-44-45-70 -package zarith -linkpkg".split()


@dataclass(frozen=True, slots=True)
class Replay:
    """What a proof kernel, or the second checker, says of one certificate.

    status  : PROVED, FAILED where no proof is found or the second checker refuses, UNWRITTEN where it has no words
    axioms  : names of those that the theorems rest on
    seconds : wall time
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
    if name not in JUDGES:
        raise DomainError(f"expected one of {', '.join(JUDGES)}; got {name!r}; choose one", where="kernel")
    version = coq_version() if name == "coq" else ocaml_version()
    if version is None:
        raise MissingEngineError(REMEDIES[name], where="kernel")
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


@cache
def ocaml_version() -> str | None:
    """The digest of the second checker's sources; None where no compiler has its library of large integers."""
    if shutil.which("ocamlfind") is None or shutil.which("ocamlopt") is None:
        return None
    _, folder = processes.run(["ocamlfind", "query", "zarith"], Path())
    if not Path(folder.strip() or "absent", "z.cmi").is_file():  # its running part alone has none
        return None
    return key_of(platform.machine(), *(path.read_text("utf-8") for path in SOURCES))[:12]


def build_checker(folder: Path) -> str:
    """Compile the second checker to ``checker`` in a folder; what the compiler said, or MissingEngineError."""
    for source in SOURCES:
        shutil.copy(source, folder)
    status, said = processes.run([*COMPILE, *(source.name for source in SOURCES), "-o", "checker"], folder)
    if status != 0:
        raise MissingEngineError(f"{REMEDIES['ocaml']} ({' '.join(said.split()[-20:])})", where="kernel")
    return said


def find_checker(version: str) -> Path:
    """The compiled second checker, in the user's cache; raises OutputError where none can be written there."""
    program = default_path().parent / f"second-checker-{version}"
    try:
        if not program.is_file():
            program.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=program.parent) as folder:
                build_checker(Path(folder))
                os.replace(Path(folder, "checker"), program)
    except OSError as error:
        message = f"expected a cache that can be written; got '{error.strerror}'; set NAVSYM_CACHE to another folder"
        raise OutputError(message, where=str(program)) from error
    return program


def replay(certificate: Mapping[str, Any], file: Path, kernel: str = "coq") -> Replay:
    """What a kernel says of a certificate that the checker has accepted; it is kept for the reports.

    file   : where the theory is written
    kernel : ``"coq"``, or ``"ocaml"`` for the second checker

    Raises the errors of :func:`require_kernel`.
    """
    version = require_kernel(kernel)
    try:
        text = write_theory(certificate) if kernel == "coq" else json.dumps(certificate)
    except DomainError as error:
        text, row = "", Replay(kernel, version, "UNWRITTEN", why=error.message)
    else:
        row = recall(kernel, certificate, key_of(version, text)) or ask(kernel, version, text)
        if kernel == "coq":
            file.write_text(text, "utf-8")
            row = replace(row, file=str(file))
    keep_outcome(kernel, certificate, asdict(row) | {"content": key_of(version, text)})
    return row


def recall(kernel: str, certificate: Mapping[str, Any], content: str) -> Replay | None:
    """What the same version proved of the same text before."""
    (known,) = read_outcomes(kernel, [certificate])
    if known is None or known.pop("content", None) != content or known["status"] != "PROVED":
        return None
    return Replay(**known | {"axioms": tuple(known["axioms"])})


def ask(kernel: str, version: str, text: str) -> Replay:
    """Have Coq compile a theory, or the second checker look at a certificate."""
    name = "theory.v" if kernel == "coq" else "certificate.json"
    command = ["coqc", "-q"] if kernel == "coq" else [str(find_checker(version))]
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, name).write_text(text, "utf-8")
        status, said = processes.run([*command, name], Path(folder), PATIENCE)
    seconds = round(time.perf_counter() - began, 2)
    if status != 0:
        answer = "UNWRITTEN" if (kernel, status) == ("ocaml", 2) else "FAILED"
        why = " ".join(said.split()[-30:]) or "it ended without a word"
        return Replay(kernel, version, answer, seconds=seconds, why=why)
    return Replay(kernel, version, "PROVED", read_axioms(said), seconds)


def read_axioms(output: str) -> tuple[str, ...]:
    """Names after the line ``Axioms:``; a name starts its line."""
    _, _, listed = output.partition("Axioms:\n")
    return tuple(dict.fromkeys(re.findall(r"^([A-Za-z_][\w.']*)(?=\s*(?::|$))", listed, re.M)))
