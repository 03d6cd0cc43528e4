"""Every claim of the ledger, written as code and read back: ``python -m tests.audit.round_trip [EVERY] [FIRST]``.

What ``navsym export`` writes in a language that audit reads is read there and compared with the formula of the claim.
"""

from __future__ import annotations

import json
import math
import re
import resource
import sys
import tempfile
import time
from collections import Counter
from fractions import Fraction
from pathlib import Path
from typing import Any

from flint import ctx

import navsym as nav
from navsym.prove.rooms.goals import player

ROOT = Path(__file__).resolve().parents[2]
#: Language: the file, the first and the last line around the formula, and how the code calls the results.
FILES = {
    "c": ("c/{}.c", r"    \{ /\* ", r"    \}", "r{}"),
    "cpp": ("cpp/navsym_functions.hpp", r"    \{  // ", r"    \}", None),
    "rust": ("rust/navsym_functions.rs", r"    \{ // ", r"    \}", "nv_r[{}]"),
    "python": ("python/navsym_functions.py", r"    shape = ", r"    return", "r{}"),
    "octave": ("octave/{}.m", r"^  end or   value = NaN", r"  if ~all\(isfinite", "r{}"),
}
#: What stands in a file of its own.
HELPERS = {"octave": "[code.functions]\nnavsym_sqrt = { of = ['x'], is = 'sqrt(x)' }\n"}


def list_claims() -> list[str]:
    """The claims of the ledger that hold."""
    document = json.loads((ROOT / "derivations" / "verdicts.json").read_text())
    return [claim["id"] for claim in document["claims"] if claim["status"] in ("PROVED", "CERTIFIED")]


def find_lines(text: str, name: str, first: str, last: str) -> tuple[int, int] | None:
    """The lines between the one with the first mark, inside a function, and the next with the last."""
    head = re.search(rf"(?:^|[ >]){re.escape(name)}\s?\(", text, re.MULTILINE)
    assert head is not None
    before, lines = text[: head.start()].count("\n"), text[head.start() :].split("\n")
    size = next((i for i, line in enumerate(lines) if i and re.match(r"end|function ", line)), len(lines))
    marks = [[i for i, line in enumerate(lines[:size]) if re.match(mark, line)] for mark in first.split(" or ")]
    for start in (found[0] for found in marks if found):
        end = next((i for i, line in enumerate(lines[:size]) if i > start and re.match(last, line)), None)
        if end is not None:
            return before + start + 2, before + end
    return None


def read_back(claim: str, folder: Path) -> dict[str, str]:
    """The verdict by language; of a claim that is not exported the reason."""
    try:
        made = nav.export(claim, to=[*FILES], out=folder / "out", run=False, vectors=4)
    except nav.NavsymError as error:
        return {"refused": f"{error.kind}: {re.split(r'[;:]', error.message)[0][:60]}"}
    (function, *others) = json.loads((made.out / "manifest.json").read_text())["functions"]
    if others or len(function["pieces"]) != 1 or function["state"]:
        return {"refused": "not one formula"}
    return {language: compare(function, language, folder) for language in FILES}


def compare(function: dict[str, Any], language: str, folder: Path) -> str:
    """PROVED where all results are the formulas of the claim, and a spoiled formula is refuted."""
    file, first, last, result = FILES[language]
    path = Path("out") / file.format(function["name"])
    text = (folder / path).read_text()
    lines = find_lines(text, function["name"], first, last)
    if lines is None:
        return "not read (another layout)"
    formulas = [line.partition(" = ")[2] for line in function["pieces"][0]["source"]["formula"]]
    inside = "\n".join(text.split("\n")[lines[0] - 1 : lines[1]])
    written = re.findall(r"^ *(result\.[^=]*?) = ", inside, re.MULTILINE)
    names = [result.format(k) for k in range(len(formulas))] if result else written
    spelled = spell_inputs(function, language)
    spec = f'[[code]]\nname = "c"\nfile = "{path}"\nfunction = "{function["name"]}"\nlines = {[*lines]}\n'
    spec += "[code.constants]\n" + "".join(
        f'"{digits}" = "{meaning}"\n'
        for digits in sorted({*re.findall(r"\d+\.\d{9,}(?:e-?\d+)?", inside)})
        if (meaning := find_meaning(digits, formulas, bool(function["inputs"])))
    )
    spec += HELPERS.get(language, "") + "[code.symbols]\n"
    spec += "".join(f'"{spelled[i["symbol"]]}" = {range_of(i)}\n' for i in function["inputs"] if i["symbol"] in spelled)
    asked = [*zip(names, names, formulas, strict=True), ("wrong", names[0], f"{formulas[0]} + 1")]
    for key, name, formula in asked:
        right = json.dumps(rename(formula, spelled))
        spec += f'[[question]]\nname = "{key}"\nkind = "equal"\nleft = "c:{name}"\nright = {right}\n'
    (folder / f"{language}.toml").write_text(spec)
    try:
        verdicts = {q.name: q for q in nav.audit(folder / f"{language}.toml").questions}
    except nav.NavsymError as error:
        return f"not read ({error.kind}: {error.message[:80]})"
    assert verdicts.pop("wrong").status != nav.PROVED
    bad = next((q for q in verdicts.values() if not q.status.holds), None)
    return "PROVED" if bad is None else f"{bad.status} ({bad.entries[0].why[:50]})"


def find_meaning(digits: str, formulas: list[str], has_inputs: bool) -> str | None:
    """The constant of the formulas for which a decimal stands, as a rational multiple of pi or a root.

    Formulas of numbers alone are decimals in the code; audit compares each with its formula to the last digit.
    """
    if not has_inputs:
        with ctx.workprec(200):
            values = {formula: float(player.value_of(player.parse(formula), {}).mid()) for formula in formulas}
        return next((f for f, x in values.items() if abs(x - float(digits)) <= 4e-16 * float(digits)), None)
    atoms = {
        "pi": math.pi,
        "pi**2": math.pi**2,
        "1/pi": 1 / math.pi,
        "pi**3": math.pi**3,
        "1/pi**2": math.pi**-2,
        "1": 1,
    }
    atoms |= {text: math.sqrt(int(text[5:-1])) for text in re.findall(r"sqrt\(\d+\)", " ".join(formulas))}
    atoms |= {f"{a}*{b}": atoms[a] * atoms[b] for a in [*atoms] for b in [*atoms] if a < b and "pi" in a + b}
    for atom, value in atoms.items():
        factor = Fraction(float(digits) / value).limit_denominator(20_000)
        if factor and abs(float(factor) * value - float(digits)) <= 4e-16 * float(digits):
            return f"{factor}*{atom}"
    return None


def spell_inputs(function: dict[str, Any], language: str) -> dict[str, str]:
    """How the code calls each symbol: its name, or an entry of an array."""
    spelled, inputs, base = {}, function["inputs"], 1 if language == "octave" else 0
    for argument in function["arguments"]:
        first, size = argument["inputs"]
        for k in range(size):
            entry = f"({k + base})" if language == "octave" else f"[{k}]"
            spelled[inputs[first + k]["symbol"]] = argument["name"] + entry * (size > 1)
    return spelled


def range_of(given: dict[str, Any]) -> str:
    """The range of an input as a mapping has it."""
    low, high = given["low"], given["high"]
    if low is None or high is None or not low < high:
        return '"positive"' if low is not None and low > 0 else '"real"'
    return f'{{ range = ["{Fraction(low)}", "{Fraction(high)}"] }}'


def rename(formula: str, spelled: dict[str, str]) -> str:
    """A formula in the names of the code."""
    return re.sub(r"[A-Za-z_]\w*", lambda found: spelled.get(found[0], found[0]), formula)


def count(claims: list[str]) -> tuple[Counter[str], float]:
    """Verdicts by language and refusals by reason, and the longest time of a claim for export and reading together."""
    counts, longest = Counter[str](), 0.0
    for claim in claims:
        start = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            found = read_back(claim, Path(folder))
        longest = max(longest, time.process_time() - start)
        counts["exported"] += "refused" not in found
        for key, value in found.items():
            counts[f"{key} {value}"] += 1
            if value not in ("PROVED",) and key != "refused":
                print(claim, key, value, flush=True)
    return counts, longest


if __name__ == "__main__":
    every, first = (int(n) for n in (*sys.argv[1:], "1", "0")[:2])
    begun = time.process_time()
    counts_, longest_ = count(list_claims()[first::every])
    for key_, number_ in sorted(counts_.items()):
        print(f"{number_:5d}  {key_}")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    print(f"{time.process_time() - begun:.1f} s, longest claim {longest_:.1f} s, {memory} MB")
