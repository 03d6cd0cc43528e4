"""One-token mutants of readable C: one that is proved equal to its original must compute the same when it is compiled.

The functions are those of the gallery and what navsym exports. ``python -m tests.attacks.campaigns.code NUMBER SEED``
prints the counts.
"""

from __future__ import annotations

import ctypes
import functools
import math
import multiprocessing
import random
import re
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import navsym as nav
from navsym.audit.answer import make_scope, read_specification
from navsym.audit.decide import decide_entry
from navsym.audit.mend import Budget, suggest
from navsym.audit.questions import list_entries
from navsym.audit.values import Scalar
from navsym.core.errors import NavsymError
from tests.attacks.campaigns.batches import Batch, Result, result

SIZE = 100
GALLERY = Path(__file__).resolve().parents[3] / "examples" / "audit" / "gallery"
#: Claims whose C is short enough to be read by eye, of several papers.
CLAIMS = ("alpha_beta_filter:5", "alpha_beta_filter:4")
TOKEN = re.compile(r"[A-Za-z_]\w*|\d+\.?\d*(?:[eE][+-]?\d+)?f?|[-+*/]=?|\S")
BODY = re.compile(r"^[a-z][\w ]* \w+\([^)]*\)\s*\{(.*?)^\}", re.MULTILINE | re.DOTALL)
SIGNS = {sign: [*"+-*/"] for sign in "+-*/"} | {"+=": ["-="], "-=": ["+="]}
NUMBERS = ("0.0", "1.0", "2.0", "3.0", "0.5", "0.25")
CALLS = {"sin": "cos", "cos": "sin", "sinf": "cosf", "cosf": "sinf", "sqrt": "cos", "tan": "sin"}
#: Every how many of the refuted mutants a mend is sought.
MENDED = 50
SIDES = ("before", "after")
POINTS = 4
#: What a compiled function may take.
SECONDS = 2.0


@dataclass(frozen=True, slots=True)
class Subject:
    """A function of C: ``const`` arrays and numbers come in, the others are changed."""

    name: str
    text: str
    function: str

    def parameters(self) -> list[tuple[str, int, bool]]:
        """Name, number of cells (0 for a number) and whether it is changed, of each parameter."""
        head = re.search(rf"\b{self.function}\(([^)]*)\)", self.text)
        assert head is not None
        done = []
        for text in head[1].split(","):
            sizes = [int(n) for n in re.findall(r"\[(\d+)\]", text)]
            is_changed = "const" not in text and (bool(sizes) or "*" in text)
            done.append(
                (
                    re.findall(r"\w+", text.partition("[")[0])[-1],
                    math.prod(sizes) * bool(sizes or "*" in text),
                    is_changed,
                )
            )
        return done

    def returns(self) -> bool:
        """True for a function with a value."""
        return re.search(rf"(double|float)\s+{self.function}\(", self.text) is not None

    def outputs(self) -> list[str]:
        """What is compared."""
        return [name for name, _, is_changed in self.parameters() if is_changed] + ["return"] * self.returns()


@functools.cache
def list_subjects() -> list[Subject]:
    """The functions ``before`` and ``after`` of the gallery, and exported ones."""
    texts = [(f"{path.stem}.{f}", path.read_text(), f) for path in sorted(GALLERY.glob("*.c")) for f in SIDES]
    with tempfile.TemporaryDirectory() as folder:
        for claim in CLAIMS:
            try:
                made = nav.export(claim, to=["c"], out=Path(folder) / claim.replace(":", "_"), run=False)
            except NavsymError:
                continue
            for path in sorted((made.out / "c").glob(f"{claim.split(':')[0]}*.c")):
                texts.append((path.stem, plain_c(path.read_text()), path.stem))
    return [Subject(*each) for each in texts]


def plain_c(text: str) -> str:
    """An exported function without its own header: the status is a number, the domain is not tested."""
    text = re.sub(r'#include "[^"]*"\n', "", text).replace("navsym_status", "int").replace("NAVSYM_OK", "0")
    text = re.sub(r"    if \(!\(.*?\n    \}\n", "", text, flags=re.S).replace("NAVSYM_DOMAIN", "1")
    return re.sub(r"double \*(\w+)", r"double \1[1]", text).replace("*value = ", "value[0] = ")


def list_mutants(subject: Subject) -> list[str]:
    """The source with one token of the function, or of what it calls, replaced: all that there are."""
    other = next((side for side in SIDES if side != subject.function), "")
    bodies = [body.span(1) for body in BODY.finditer(subject.text) if not re.search(rf"\b{other}\(", body[0])]
    return [mutant for body in bodies for mutant in mutate_body(subject.text, *body)]


def mutate_body(text: str, start: int, end: int) -> list[str]:
    """The source with one token of a body replaced."""
    tokens = [m for m in TOKEN.finditer(text, start, end)]
    words = ("double", "float", "int", "for", "const", "return", "if", "else", "void", *CALLS)
    names = sorted({m[0] for m in tokens if m[0][0].isalpha() and m[0] not in words})
    done = []
    for m in tokens:
        if text.rfind("/*", 0, m.start()) <= text.rfind("*/", 0, m.start()):
            done += [text[: m.start()] + other + text[m.end() :] for other in list_changes(m[0], names)]
    return done


def list_changes(token: str, names: list[str]) -> list[str]:
    """What may stand in the place of a token."""
    if token in CALLS:
        return [CALLS[token]]
    if re.fullmatch(r"\d+", token):
        others = [str(n) for n in range(6)]
    elif token[0].isdigit():
        others = [*NUMBERS]
    else:
        others = SIGNS.get(token, [*names, *NUMBERS[:3]] if token in names else [])
    return [other for other in others if other != token]


# What a compiler says


def compute(sources: list[str], subject: Subject, seed: int) -> list[list[float] | None]:
    """What each source computes at the same points; None for what the compiler refuses."""
    with tempfile.TemporaryDirectory() as name:
        folder, chosen = Path(name), random.Random(seed)
        points = [[[chosen.uniform(0.2, 0.9) for _ in range(max(cells, 1))] for _, cells, _ in subject.parameters()]
                  for _ in range(POINTS)]  # fmt: skip
        return [run_source(source, subject, points, folder / f"m{k}") for k, source in enumerate(sources)]


def run_source(source: str, subject: Subject, points: list[list[list[float]]], path: Path) -> list[float] | None:
    """The results of one source at the points."""
    path.with_suffix(".c").write_text("#include <math.h>\n" + source)
    flags = ["-O0", "-w", "-shared", "-fPIC", "-Dfloat=double", "-Dsinf=sin", "-Dcosf=cos", "-Dsqrtf=sqrt"]
    command = ["gcc", *flags, str(path.with_suffix(".c")), "-o", str(path.with_suffix(".so")), "-lm"]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        return None
    reading, writing = multiprocessing.Pipe(duplex=False)
    task = (path.with_suffix(".so"), subject, points, writing)
    child = multiprocessing.get_context("fork").Process(target=call_library, args=task)
    child.start()
    child.join(SECONDS)
    child.kill()  # a mutant may loop for ever, or write where it must not
    child.join()
    return reading.recv() if reading.poll() else None


def call_library(library: Path, subject: Subject, points: list[list[list[float]]], writing: Any) -> None:
    """Send the results of a compiled function at the points."""
    function = getattr(ctypes.CDLL(str(library)), subject.function)
    function.restype = ctypes.c_double if subject.returns() else ctypes.c_int
    results: list[float] = []
    for point in points:
        given = [
            (ctypes.c_double * (len(v) + 8))(*v) if cells else ctypes.c_double(v[0])
            for v, (_, cells, _) in zip(point, subject.parameters(), strict=True)
        ]
        value = function(*given)
        results += [value] * subject.returns()
        for cells, (_, count, is_changed) in zip(given, subject.parameters(), strict=True):
            results += [*cells[:count]] if is_changed else []
    writing.send(results)


def is_same(a: list[float] | None, b: list[float] | None) -> bool | None:
    """True where both compute the same; None where one of them computes nothing to compare."""
    if a is None or b is None or not all(map(math.isfinite, [*a, *b])):
        return None
    return all(abs(x - y) <= 1e-9 * (1 + abs(x) + abs(y)) for x, y in zip(a, b, strict=True))


# What the audit says


def decide_mutant(subject: Subject, mutant: str, folder: Path, wants_mend: bool) -> tuple[str, str]:
    """PROVED, REFUTED, OPEN or refused; and of REFUTED whether a mend was found, where one is wanted."""
    (folder / "original.c").write_text(subject.text)
    (folder / "mutant.c").write_text(mutant)
    spec = "".join(
        f'[[code]]\nname = "{n}"\nfile = "{n}.c"\nfunction = "{subject.function}"\n' for n in ("original", "mutant")
    )
    for name in subject.outputs():
        spec += f'[[question]]\nname = "{name}"\nkind = "equal"\nleft = "mutant:{name}"\nright = "original:{name}"\n'
    (folder / "spec.toml").write_text(spec)
    statuses, mended = set(), ""
    try:
        _, questions = read_specification(folder / "spec.toml")
        for question in questions:
            for entry in list_entries(question):
                if not (isinstance(entry.code, Scalar) and isinstance(entry.expected, Scalar)):
                    statuses.add("OPEN")
                    continue
                scope = make_scope(question.names, entry, ())
                status = str(decide_entry(entry.code.tree, entry.expected.tree, scope, 0.2).status)
                statuses.add(status)
                if status == "REFUTED" and wants_mend and not mended:
                    mended = "mended" if suggest(entry, scope, Budget()) else "not mended"
    except NavsymError:
        return "refused", ""
    return next(s for s in ("REFUTED", "OPEN", "CERTIFIED", "PROVED") if s in statuses), mended


def make_batches(inputs: int, seed: int = 0) -> list[Batch]:
    """At most ``inputs`` mutants in batches of 100, none twice: a batch is a subject, a first place and a number."""
    shares = [(s.name, first, SIZE, seed) for s in list_subjects() for first in range(0, len(list_mutants(s)), SIZE)]
    chosen = random.Random(seed).sample(shares, min(len(shares), -(-inputs // SIZE)))
    return [Batch(repr(share), share) for share in chosen]


def judge(task: tuple[str, int, int, int]) -> Result:
    """Counts by verdict; wrong: a mutant that is proved and computes something else, or is refuted and does not."""
    name, first, size, seed = task
    subject = next(s for s in list_subjects() if s.name == name)
    mutants = list_mutants(subject)
    chosen = random.Random(seed).sample(mutants, len(mutants))[first : first + size]
    values = compute([subject.text, *chosen], subject, seed)
    counts, wrong = Counter[str](), []
    with tempfile.TemporaryDirectory() as folder:
        for k, mutant in enumerate(chosen):
            status, mended = decide_mutant(subject, mutant, Path(folder), k % MENDED == 0)
            same = is_same(values[0], values[k + 1])
            counts[status] += 1
            if same is not None:
                counts[f"{status} and {'the same' if same else 'another'}"] += 1
            if mended:
                counts[mended] += 1
            if (status in ("PROVED", "CERTIFIED") and same is False) or (status == "REFUTED" and same is True):
                wrong.append([name, status, mutant])
    return result(counts, wrong)


if __name__ == "__main__":
    total, wrong_ones = Counter[str](), list[list[str]]()
    for batch in make_batches(int(sys.argv[1]), int(sys.argv[2])):
        found = judge(batch.items)
        total.update(found["counts"])
        wrong_ones += found["wrong"]
        print(batch.items, dict(total), len(wrong_ones), flush=True)
        for each in found["wrong"]:
            print(*each, sep="\n", flush=True)
