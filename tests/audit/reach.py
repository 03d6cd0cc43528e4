"""How much of public estimator files is read: the mappings are our own text, the files lie where NAVSYM_CORPORA says.

``python -m tests.audit.reach FOLDER`` writes the table of docs/audit_reach.md; FOLDER/NAME is a clone of OWNER/NAME.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from navsym.audit.cases import Reading
from navsym.audit.names import Names
from navsym.audit.sources import load_unit, read_source
from navsym.audit.syntax import descend, parse_source
from navsym.core.errors import NavsymError
from navsym.language.tomlfile import read_toml

HERE = Path(__file__).parent / "reach"
#: The nodes of the grammars that assign something.
ASSIGNING = frozenset(
    "assignment_expression init_declarator update_expression assignment augmented_assignment let_declaration "
    "compound_assignment_expr".split()
)
GRAMMARS = {"c": "C", "cpp": "C++", "python": "Python", "matlab": "MATLAB", "rust": "Rust"}


@dataclass(frozen=True)
class Reach:
    """What came of one file.

    assignments : in the bodies of its functions
    read        : those that are formulas of the inputs, in every case in which they are met
    reasons     : why the others are not, with how often
    """

    repository: str
    commit: str
    path: str
    language: str
    assignments: int
    read: int
    reasons: Counter[str]


def measure_reach(spec: Path, corpora: str) -> Reach | None:
    """One file, function by function; None without its clone."""
    document = read_toml(spec)
    head = document["file"]
    clone = Path(corpora) / head["repository"].partition("/")[2]
    if not corpora or not clone.is_dir():
        return None
    with tempfile.TemporaryDirectory() as folder:
        for file in (head["path"], *head.get("also", ())):
            command = ["git", "-C", str(clone), "show", f"{head['commit']}:{file}"]
            path = Path(folder) / Path(file).name
            path.write_bytes(subprocess.run(command, capture_output=True, check=True).stdout)
        path = Path(folder) / Path(head["path"]).name
        readings = read_all(path, document)
        unit = load_unit(path, document.get("code", {}).get("language"))
    texts = (head["repository"], head["commit"], head["path"], unit.language)
    return count_reach(texts, unit.source, readings)


def read_all(path: Path, document: dict) -> list[Reading]:
    """Every function of a file, with what the mapping says of all and of it alone."""
    common, head = document.get("code", {}), document["file"]
    also = [Path(file).name for file in head.get("also", ())]
    variants = [{"defined": names} for names in head["variants"]] if "variants" in head else [{}]
    readings = []
    unit = load_unit(path, common.get("language"))
    for name, functions in unit.functions.items():
        for variant, function in product(variants, functions):
            whole = {**common, **variant, "name": "code", "file": path.name, "function": name, "also": also}
            try:
                source = read_source(whole, path.parent, Names(), str(path), function.line)
                readings.append(source.read())
            except NavsymError as error:
                print(f"  {path.name}: {name}: {error.message}", file=sys.stderr)
    return readings


def count_reach(texts: tuple[str, ...], source: bytes, readings: list[Reading]) -> Reach:
    """The assignments of a file that some reading has as a formula, and why the others are none."""
    met = set().union(*(r.met for r in readings))
    refused = {span: r.refused for r in readings for span in r.refused_spans}
    empty = {span: why for r in readings for span, why in r.valueless.items()}
    nodes = [n for n in descend(parse_source(source, texts[3], texts[2])) if n.type in ASSIGNING and in_function(n)]
    reasons: Counter[str] = Counter()
    read = 0
    for node in nodes:
        around = [(low, high) for low, high in met if low <= node.start_byte and node.end_byte <= high]
        span = min(around, key=lambda s: s[1] - s[0], default=None)
        if span is None:
            reasons["behind a jump, or in a statement that is not read"] += 1
        elif span in refused:
            line = source.count(b"\n", 0, node.start_byte) + 1
            known = refused[span]
            why = known.get(line) or next((w for n, w in known.items() if n >= line), "a statement that is not read")
            reasons[why] += 1
        elif span in empty:
            reasons[f"a value that depends on: {empty[span]}"] += 1
        else:
            read += 1
    return Reach(*texts, len(nodes), read, reasons)


def in_function(node) -> bool:
    """True for a node in the body of a function."""
    while (node := node.parent) is not None:
        if node.type in ("function_definition", "function_item"):
            return True
    return False


def write_row(reach: Reach) -> str:
    """A line of the table."""
    share = f"{100 * reach.read / max(reach.assignments, 1):.1f}"
    rest = "; ".join(f"{count} {why}" for why, count in reach.reasons.most_common())
    cells = (reach.repository, reach.commit, reach.path, GRAMMARS[reach.language])
    return "| " + " | ".join((*cells, str(reach.assignments), str(reach.read), share, rest)) + " |"


def main(corpora: str, *names: str) -> None:
    """Print the table; names restrict it."""
    for spec in sorted(HERE.glob("*.toml")):
        if not names or any(spec.stem.startswith(name) for name in names):
            reach = measure_reach(spec, corpora)
            print(f"no clone for {spec.name}" if reach is None else write_row(reach), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
