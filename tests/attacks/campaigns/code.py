"""One-token mutants of readable code: one that is proved equal to its original must compute the same when it is run.

The functions are those of the gallery, our own in the styles of flown filters, and what navsym exports, in C, C++ with
Eigen, Python, MATLAB and Rust. The judges are three compilers, numpy and Octave.
``python -m tests.attacks.campaigns.code NUMBER SEED`` prints the counts.
"""

from __future__ import annotations

import atexit
import ctypes
import functools
import importlib.util
import math
import multiprocessing
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import tomllib
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import navsym as nav
from navsym.audit.answer import make_scope
from navsym.audit.decide import TRIES, decide_entry
from navsym.audit.mend import Budget, suggest
from navsym.audit.names import Names
from navsym.audit.questions import Question, list_entries
from navsym.audit.sources import Source, find_function, list_inputs, read_unit
from navsym.audit.values import Scalar
from navsym.core.errors import NavsymError
from navsym.core.sandbox import Exhausted, run_limited
from navsym.export.languages.targets import answering
from tests.attacks.campaigns.batches import Batch, Result, result

SIZE = 100
#: Functions of our own, with the sizes of what comes in where the language does not say them.
OWN = Path(__file__).resolve().parents[1] / "code"
SIZES: dict[str, dict[str, tuple[int, ...]]] = {
    "earth_place": {"x": (3,)}, "joseph_step": {"P": (2, 2)}, "pendulum_step": {"x": (2,)},
    "kf": {"x": (2, 1), "P": (2, 2)}, "strap": {"v": (3, 1), "w": (3, 1), "C": (3, 3)},
    "triad": dict.fromkeys("amgh", (3, 1)), "shapes": {"M": (3, 3), "v": (3, 1)}, "mag": {"q": (4,), "m": (3,)},
    "cv": {"x": (4,), "P": (4, 4), "z": (2,)}, "ctrv": {"x": (4,), "u": (2,)},
    "imu": {"R": (3, 3), "v": (3,), "w": (3,), "a": (3,)},
}  # fmt: skip
GALLERY = Path(__file__).resolve().parents[3] / "examples" / "audit" / "gallery"
#: Claims whose code is short enough to be read by eye.
CLAIMS = ("alpha_beta_filter:5", "alpha_beta_filter:4")
LANGUAGES = {".c": "c", ".cpp": "cpp", ".py": "python", ".m": "matlab", ".rs": "rust"}
#: What runs a language: numpy is here, the others may not be.
TOOLS = {"c": "gcc", "cpp": "g++", "rust": "rustc", "matlab": "octave"}
TOKEN = re.compile(r"[A-Za-z_]\w*|\d+\.?\d*(?:[eE][+-]?\d+)?f?|\*\*|[-+*/]=?|\S")
#: The body of each function, behind its head.
BODIES = {
    "c": re.compile(r"^[a-z][\w ]* \w+\([^)]*\)\s*\{(.*?)^\}", re.MULTILINE | re.DOTALL),
    "cpp": re.compile(r"^[A-Za-z]\w* \w+\([^)]*\)\s*\{(.*?)^\}", re.MULTILINE | re.DOTALL),
    "rust": re.compile(r"^pub fn \w+\([^)]*\)[^{]*\{(.*?)^\}", re.MULTILINE | re.DOTALL),
    "matlab": re.compile(r"^function \w+ = \w+\([^)]*\)(.*?)^end", re.MULTILINE | re.DOTALL),
    "python": re.compile(r"^def \w+\([^)]*\):(.*?)(?=^def|\Z)", re.MULTILINE | re.DOTALL),
}
SIGNS = {sign: [*"+-*/"] for sign in "+-*/"} | {"+=": ["-="], "-=": ["+="], "**": ["*"], "@": ["*"]}
NUMBERS = ("0.0", "1.0", "2.0", "3.0", "0.5", "0.25")
CALLS = {"sin": "cos", "cos": "sin", "sinf": "cosf", "cosf": "sinf", "sqrt": "cos", "tan": "sin", "powi": "powf"}
CALLS |= {"transpose": "eval", "Identity": "Zero", "Zero": "Identity", "y": "z", "x": "y"}
WORDS = {
    *"double float int for const return if else void np array math T let mut f64 pub fn end function in range".split(),
    *"cross dot norm normalized squaredNorm block segment head eval Eigen std auto static inline".split(), *CALLS,
}  # fmt: skip
#: Types of Eigen with their sizes.
MATRIX = re.compile(r"\b(?:Vector(\d)d|Matrix(\d)d|Matrix<double, (\d+), (\d+)>)")
SIDES = ("before", "after")
CPP = ("-O0", "-w", "-fPIC", "-fmax-errors=0")
POINTS = 4
#: Processor time that a compiled function may take; a mutant may loop for ever.
SECONDS = 0.5
ROUNDS = 12


@dataclass(frozen=True, slots=True)
class Subject:
    """A function: some of its parameters come in, the others are changed; ``shapes`` say what the source does not."""

    name: str
    text: str
    function: str
    language: str = "c"
    shapes: tuple[tuple[str, tuple[int, ...]], ...] = ()

    def parameters(self) -> list[tuple[str, tuple[int, ...] | None, bool]]:
        """Name, sizes (None for a number) and whether it is changed, of each parameter."""
        head = re.search(rf"\b{self.function}\(([^)]*)\)", self.text)
        assert head is not None
        known, done = dict(self.shapes), []
        for text in split_types(head[1]):
            name = re.findall(r"[a-z_]\w*", text.partition(":" if self.language == "rust" else "[")[0], re.IGNORECASE)[
                -1
            ]
            sizes = tuple(int(n) for n in re.findall(r"(?:\[|; )(\d+)\]", text)) or sizes_of(text) or known.get(name)
            sizes = sizes or ((1,) if "*" in text else None)
            is_shared = self.language == "c" or (self.language == "cpp" and ("[" in text or "&" in text))
            is_changed = "&mut" in text or (is_shared and "const" not in text and sizes is not None)
            done.append((name, sizes, is_changed))
        return done

    def returned(self) -> tuple[int, ...] | None:
        """The sizes of a matrix of Eigen that is returned; None for others."""
        head = re.search(rf"^([\w:<>, ]+) {self.function}\(", self.text, re.MULTILINE)
        return sizes_of(head[1]) if head is not None and self.language == "cpp" else None

    def outputs(self) -> list[str]:
        """What is compared."""
        if found := re.search(rf"function (\w+) = {self.function}\(", self.text):
            return [found[1]]
        return [name for name, _, is_changed in self.parameters() if is_changed] + ["return"] * self.returns()

    def returns(self) -> bool:
        """True for a function with a value."""
        pattern = rf"(double|float)\s+{self.function}\(|{self.function}\([^)]*\) ->"
        return self.language == "python" or bool(self.returned()) or re.search(pattern, self.text) is not None


def sizes_of(text: str) -> tuple[int, ...] | None:
    """The sizes of a type of Eigen."""
    found = MATRIX.search(text)
    if found is None or not found[2]:
        return None if found is None else (int(found[1]),) if found[1] else (int(found[3]), int(found[4]))
    return int(found[2]), int(found[2])


@functools.cache
def list_subjects() -> list[Subject]:
    """The functions ``before`` and ``after`` of the gallery, our own, and exported ones."""
    done = []
    for path in sorted(p for p in GALLERY.iterdir() if p.suffix in LANGUAGES):
        blocks = tomllib.loads(path.with_suffix(".toml").read_text())["code"]
        for side in SIDES:
            language, text = LANGUAGES[path.suffix], leave_out(path, next(s for s in SIDES if s != side))
            text = (
                text if language != "cpp" else re.sub(r"(Vector\d|Matrix\d)f", r"\1d", text).replace("float", "double")
            )
            symbols = next(b for b in blocks if b["function"] == side).get("symbols", {})
            sizes = {n: d.get("vector", d.get("matrix")) for n, d in symbols.items() if isinstance(d, dict)}
            shapes = tuple((n, (s,) if isinstance(s, int) else tuple(s)) for n, s in sizes.items() if s)
            done.append(Subject(f"{path.stem}.{side}", text, side, language, shapes))
    for path in sorted(OWN.iterdir()):
        shapes = tuple(SIZES.get(path.stem, {}).items())
        done.append(Subject(path.stem, path.read_text(), path.stem, LANGUAGES[path.suffix], shapes))
    with tempfile.TemporaryDirectory() as folder:
        for claim in CLAIMS:
            try:
                made = nav.export(claim, to=["c"], out=Path(folder) / claim.replace(":", "_"), run=False)
            except NavsymError:
                continue
            for path in sorted((made.out / "c").glob(f"{claim.split(':')[0]}*.c")):
                done.append(Subject(path.stem, plain_c(path.read_text()), path.stem))
    return done


def leave_out(path: Path, other: str) -> str:
    """A source without one of its functions."""
    text = path.read_text()
    found = next((m for m in BODIES[LANGUAGES[path.suffix]].finditer(text) if re.search(rf"\b{other}\(", m[0])), None)
    return text if found is None else text[: found.start()] + text[found.end() :]


def plain_c(text: str) -> str:
    """An exported function without its own header: the status is a number, the domain is not tested."""
    text = re.sub(r'#include "[^"]*"\n', "", text).replace("navsym_status", "int").replace("NAVSYM_OK", "0")
    text = re.sub(r"    if \(!\(.*?\n    \}\n", "", text, flags=re.S).replace("NAVSYM_DOMAIN", "1")
    return re.sub(r"double \*(\w+)", r"double \1[1]", text).replace("*value = ", "value[0] = ")


def list_mutants(subject: Subject) -> list[str]:
    """The source with one token of the function, or of what it calls, replaced: all that there are."""
    spans = [body.span(1) for body in BODIES[subject.language].finditer(subject.text)]
    return [mutant for span in spans for mutant in mutate_body(subject.text, *span)]


def mutate_body(text: str, start: int, end: int) -> list[str]:
    """The source with one token of a body replaced."""
    tokens = [m for m in TOKEN.finditer(text, start, end)]
    names = sorted({m[0] for m in tokens if m[0][0].isalpha() and m[0] not in WORDS})
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


# What a compiler and two interpreters say


def compute(sources: list[str], subject: Subject, seed: int) -> list[list[float] | None]:
    """What each source computes at the same points; None for what cannot be run."""
    points = draw_points(subject, seed)
    with tempfile.TemporaryDirectory() as folder:
        if subject.language == "python":
            done = [run_limited(run_python, (source, subject, points)) for source in sources]  # some change a module
            return [None if isinstance(values, Exhausted) else values for values in done]
        if subject.language == "matlab":
            return run_octave(sources, subject, points, Path(folder))
        library, alive = compile_all(sources, subject, Path(folder))
        return call_all(library, alive, len(sources), subject, points)


def draw_points(subject: Subject, seed: int) -> list[list[Any]]:
    """Numbers for all cells of all parameters, some times."""
    chosen, sizes = random.Random(seed), [math.prod(sizes or ()) for _, sizes, _ in subject.parameters()]
    return [[np.array([chosen.uniform(0.2, 0.9) for _ in range(n)]) for n in sizes] for _ in range(POINTS)]


def run_python(source: str, subject: Subject, points: list[list[Any]]) -> list[float] | None:
    """The results of a function with numpy."""
    scope: dict[str, Any] = {}
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # np.matrix is on its way out, and is in use
            exec(compile(source, "mutant", "exec"), scope)
            shapes = [sizes or () for _, sizes, _ in subject.parameters()]
            values = [
                scope[subject.function](*(v.copy().reshape(s)[()] for v, s in zip(point, shapes, strict=True)))
                for point in points
            ]
            return [float(x) for value in values for x in np.ravel(np.array(value, dtype=float))]
    except (ArithmeticError, LookupError, NameError, TypeError, ValueError, SyntaxError, AttributeError):
        return None


def run_octave(sources: list[str], subject: Subject, points: list[list[Any]], folder: Path) -> list[list[float] | None]:
    """The results of functions in Octave, one text after the other."""
    lines = ["1;"]
    calls = []
    for point in points:
        shaped = zip(point, subject.parameters(), strict=True)
        given = [f"reshape([{' '.join(map(repr, map(float, v)))}], {rows_of(s)})" for v, (_, s, _) in shaped]
        calls.append(f"{subject.function}({', '.join(given)})(:)'")
    for k, source in enumerate(sources):
        (folder / f"m{k}.m").write_text(source)
        lines += [f"try; eval(fileread('m{k}.m')); r = [{', '.join(calls)}];",
                  f"printf('%d', {k}); printf(' %.17g', r); printf('\\n'); catch; end"]  # fmt: skip
    (folder / "all.m").write_text("\n".join(lines) + "\n")
    command = ["octave", "--norc", "--quiet", "--no-gui", "all.m"]
    text = subprocess.run(command, capture_output=True, check=False, cwd=folder, text=True).stdout
    rows = {int(row.split()[0]): [float(x) for x in row.split()[1:]] for row in text.splitlines() if row}
    return [rows.get(k) for k in range(len(sources))]


def rows_of(sizes: tuple[int, ...] | None) -> str:
    """The size of an array for Octave."""
    return ", ".join(map(str, (*(sizes or ()), 1, 1)[:2]))


def compile_all(sources: list[str], subject: Subject, folder: Path) -> tuple[Path, list[int]]:
    """One library with a function ``m<k>_...`` for each source, and the places of those that the compiler takes."""
    names = sorted({*re.findall(r"^[A-Za-z][\w:<>, ]* (\w+)\(", subject.text, re.MULTILINE)})
    library, alive = folder / "all.so", [*range(len(sources))]
    for _ in range(ROUNDS):
        lines = list[str]()
        starts = []
        for k in alive:
            text = re.sub(rf"\b({'|'.join(names)})\b", rf"m{k}_\1", sources[k])
            if subject.language == "rust":
                text = text.replace("pub fn ", '#[no_mangle]\npub extern "C" fn ')
            if subject.language == "cpp":
                text += wrap_eigen(subject, f"m{k}_{subject.function}")
            starts.append(len(lines))
            lines += text.split("\n")
        path = folder / ("all." + {"rust": "rs"}.get(subject.language, subject.language))
        path.write_text("\n".join(lines))
        if subject.language == "rust":
            command = ["rustc", "--crate-type", "cdylib", "--error-format=short", "-A", "warnings", path, "-o", library]
        else:
            flags = "-O0 -shared -fPIC -Dfloat=double -Dsinf=sin -Dcosf=cos -Dsqrtf=sqrt -include math.h".split()
            flags += ["-Werror=implicit-function-declaration"]
            command = ["gcc", *flags, path, "-o", library, "-lm"]
            if subject.language == "cpp":
                command = ["g++", *CPP, *eigen(), "-shared", path, "-o", library]
        said = subprocess.run(command, capture_output=True, check=False, text=True)
        if said.returncode == 0:
            return library, alive
        mark = r".*(?:error|required from here)"  # a wrong template is found in the library, and named here
        bad = {int(n) - 1 for n in re.findall(rf"^[^\s:]*all\.\w+:(\d+):\d+: {mark}", said.stderr, re.MULTILINE)}
        ends = [*starts[1:], len(lines)]
        alive = [k for k, a, b in zip(alive, starts, ends, strict=True) if not any(a <= n < b for n in bad)]
        if not bad:
            break
    return library, []


@functools.cache
def eigen() -> list[str]:
    """How the compiler finds Eigen, read once for all: among the headers that come with casadi."""
    package, folder = importlib.util.find_spec("casadi"), Path(tempfile.mkdtemp(prefix="navsym-eigen-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    assert package is not None and package.origin is not None
    where = ["-I", f"{Path(package.origin).parent}/include/eigen3"]
    (folder / "eigen.hpp").write_text("#include <Eigen/Dense>\n")
    subprocess.run(["g++", *CPP, *where, "-x", "c++-header", folder / "eigen.hpp"], check=True)
    return [*where, "-include", f"{folder}/eigen.hpp"]


def wrap_eigen(subject: Subject, name: str) -> str:
    """A function of C around one of C++: cells come in and go out row by row."""
    heads, given, back = list[str](), list[str](), list[str]()
    result = subject.returned()
    head = re.search(rf"\b{subject.function}\(([^)]*)\)", subject.text)
    assert head is not None
    for k, ((_, sizes, is_changed), text) in enumerate(zip(subject.parameters(), split_types(head[1]), strict=True)):
        heads.append(f"double {'*' * bool(sizes)}a{k}")
        if sizes_of(text) is None:
            given.append(f"a{k}")
            continue
        given.append(f"p{k}")
        back.append(f"{map_cells(sizes, f'a{k}')} = p{k};" if is_changed else "")
        heads[-1] += f"|{eigen_type(sizes)} p{k} = {map_cells(sizes, f'a{k}')};"
    values = " ".join(h.partition("|")[2] for h in heads)
    call, ends = f"{name}({', '.join(given)})", " ".join(back)
    is_number = result is None and subject.returns()
    before = f"{map_cells(result, 'out')} = " if result else "const double value = " if is_number else ""
    head_text = ", ".join([*(h.partition("|")[0] for h in heads), *["double *out"] * bool(result)])
    return (f'\nextern "C" double {name}_c({head_text})\n{{ {values} {before}{call}; {ends} '
            f"return {'value' if is_number else '0.0'}; }}")  # fmt: skip


def split_types(text: str) -> list[str]:
    """The parameters of a head; a comma may stand between the sizes of a type."""
    return re.split(r",(?![^<]*>)", text)


def eigen_type(sizes: Any, order: str = "") -> str:
    """A matrix or a column of Eigen."""
    rows, columns = (*sizes, 1)[:2]
    return f"Eigen::Matrix<double, {rows}, {columns}{order if columns > 1 else ''}>"


def map_cells(sizes: Any, name: str) -> str:
    """Cells row by row as a matrix."""
    return f"(Eigen::Map<{eigen_type(sizes, ', Eigen::RowMajor')}>({name}))"


def call_all(
    library: Path, alive: list[int], number: int, subject: Subject, points: list[list[Any]]
) -> list[list[float] | None]:
    """The results of compiled functions; one that fails ends its process, and the others go on in a new one."""
    results: list[list[float] | None] = [None] * number
    waiting = [*alive]
    while waiting:
        reading, writing = multiprocessing.Pipe(duplex=False)
        child = multiprocessing.get_context("fork").Process(
            target=call_library, args=(library, waiting, subject, points, writing)
        )
        child.start()
        writing.close()
        done = 0
        try:
            while True:
                results[waiting[done]] = reading.recv()
                done += 1
        except (EOFError, IndexError):
            child.join()
        waiting = waiting[done + 1 :]
    return results


def call_library(library: Path, places: list[int], subject: Subject, points: list[list[Any]], writing: Any) -> None:
    """Send the results of compiled functions at the points, one after the other."""
    loaded = ctypes.CDLL(str(library))
    for k in places:
        signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)  # the end of this process
        function = getattr(loaded, f"m{k}_{subject.function}" + "_c" * (subject.language == "cpp"))
        result = math.prod(subject.returned() or (0,))
        function.restype = ctypes.c_double if subject.returns() else ctypes.c_int
        results: list[float] = []
        for point in points:
            shaped = [*zip(point, subject.parameters(), strict=True)]
            given = [(ctypes.c_double * (len(v) + 8))(*v) if s else ctypes.c_double(v[0]) for v, (_, s, _) in shaped]
            out = (ctypes.c_double * result)()
            value = function(*given, *[out] * bool(result))
            results += [*out] if result else [value] * subject.returns()
            for cells, (v, (_, _, is_changed)) in zip(given, shaped, strict=True):
                results += [*cells[: len(v)]] if is_changed else []
        writing.send(results)


def is_same(a: list[float] | None, b: list[float] | None) -> bool | None:
    """True where both compute the same; None where one of them computes nothing to compare."""
    if a is None or b is None or not all(map(math.isfinite, [*a, *b])):
        return None
    return len(a) == len(b) and all(abs(x - y) <= 1e-9 * (1 + abs(x) + abs(y)) for x, y in zip(a, b, strict=True))


# What the audit says


@dataclass(slots=True)
class Comparison:
    """A subject beside its mutants: the original is read once, and a pair of formulas is decided once."""

    subject: Subject
    names: Names
    original: Source
    decided: dict[Any, str]

    def questions(self, mutant: str) -> Iterator[Question]:
        """Whether the mutant computes the same, output by output."""
        sources = {"mutant": read_code("mutant", mutant, self.subject, self.names), "original": self.original}
        for output in self.subject.outputs():
            keys = {"left": f"mutant:{output}", "right": f"original:{output}"}
            yield Question(output, "equal", keys, "mutant", sources, self.names, Path())


@functools.cache
def compare(subject: Subject) -> Comparison:
    """The subject, read."""
    names = Names()
    return Comparison(subject, names, read_code("original", subject.text, subject, names), {})


def read_code(name: str, text: str, subject: Subject, names: Names) -> Source:
    """A text as the code of a question."""
    unit = read_unit(text.encode(), name, subject.language, None)
    function = find_function(unit, subject.function, name)
    source = Source(name, unit, function, names, dict(subject.shapes), frozenset(), ())
    names.inputs |= list_inputs(source, function)
    return source


def decide_mutant(subject: Subject, mutant: str, wants_mend: bool = False) -> tuple[str, str]:
    """PROVED, REFUTED, OPEN or refused; and of REFUTED whether a mend was found, where one is wanted."""
    statuses, mended, comparison = set(), "", compare(subject)
    try:
        for question in comparison.questions(mutant):
            for entry in list_entries(question):
                if not (isinstance(entry.code, Scalar) and isinstance(entry.expected, Scalar)):
                    statuses.add("OPEN")
                    continue
                scope = make_scope(question.names, entry, ())
                key = (entry.code.tree, entry.expected.tree, entry.conditions)
                if key not in comparison.decided:
                    comparison.decided[key] = str(decide_entry(*key[:2], scope, TRIES[:1]).status)
                status = comparison.decided[key]
                statuses.add(status)
                if status == "REFUTED" and wants_mend and not mended:
                    mended = "mended" if suggest(entry, scope, Budget()) else "not mended"
    except NavsymError:
        return "refused", ""
    return next(s for s in ("REFUTED", "OPEN", "CERTIFIED", "PROVED") if s in statuses), mended


def lacking_tool(language: str) -> str:
    """Why the code of a language cannot be run here; empty when it can: a stub without its compiler does not answer."""
    tool = TOOLS.get(language)
    return "" if tool is None or answering(tool) is not None else f"needs {tool}, which does not answer here"


def make_batches(inputs: int, seed: int = 0) -> list[Batch]:
    """At most ``inputs`` mutants in batches of 100, none twice: a batch is a subject, a first place and a number."""
    shares = [(s.name, first, SIZE, seed) for s in list_subjects() for first in range(0, len(list_mutants(s)), SIZE)]
    chosen = random.Random(seed).sample(shares, min(len(shares), -(-inputs // SIZE)))
    return [Batch(repr(share), share) for share in sorted(chosen)]


def judge(task: tuple[str, int, int, int]) -> Result:
    """Counts by verdict; wrong: a mutant that is proved and computes something else, or is refuted and does not."""
    name, first, size, seed = task
    subject = next(s for s in list_subjects() if s.name == name)
    mutants = list_mutants(subject)
    chosen = random.Random(seed).sample(mutants, len(mutants))[first : first + size]
    values = compute([subject.text, *chosen], subject, seed)
    assert values[0] is not None, "the original does not run"
    counts, wrong, lacking = Counter[str](), list[Any](), list[Any]()
    for k, mutant in enumerate(chosen):
        is_first = not (counts["mended"] or counts["not mended"])  # a mend is sought once in a batch
        status, mended = decide_mutant(subject, mutant, is_first)
        same = is_same(values[0], values[k + 1])
        counts[status] += 1
        counts[subject.language] += 1
        if same is not None:
            counts[f"{status} and {'the same' if same else 'another'}"] += 1
        if mended:
            counts[mended] += 1
            lacking += [[name, mended, mutant]] * (mended == "not mended")
        if (status in ("PROVED", "CERTIFIED") and same is False) or (status == "REFUTED" and same is True):
            wrong.append([name, status, mutant])
    return result(counts, wrong, lacking)


if __name__ == "__main__":
    total, wrong_ones = Counter[str](), list[list[str]]()
    for batch in make_batches(int(sys.argv[1]), int(sys.argv[2])):
        found = judge(batch.items)
        total.update(found["counts"])
        wrong_ones += found["wrong"]
        print(batch.items, dict(total), len(wrong_ones), flush=True)
        for each in found["wrong"]:
            print(*each, sep="\n", flush=True)
