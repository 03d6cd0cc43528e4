"""Names in generated code: ASCII, no keyword of any target, different also without regard to case."""

from __future__ import annotations

import hashlib
import re
import tomllib
import unicodedata
from collections.abc import Iterable, Mapping
from pathlib import Path

import sympy as sp

from navsym.export.atoms import expm1
from navsym.export.holes import Part, T
from navsym.prove.wording import expression_text

WORDS: dict[str, str] = tomllib.loads(Path(__file__).with_name("words.toml").read_text("utf-8"))
#: What no target may see as a variable, and what it may not see as a function.
TAKEN, FUNCTIONS = (frozenset(WORDS[kind].split()) for kind in ("taken", "functions"))
#: Numbers that the headers of C define, such as M_PI and DBL_MAX.
MACRO = re.compile(r"(?:M|DBL|FLT|LDBL|FP|MATH|HUGE|DECIMAL|INT|LONG|SIZE|CHAR|UINT)_[A-Z0-9_]+")
#: A name of our own would hide the temporaries t0, t1, … of a function body.
TEMPORARY = re.compile(r"(?:[tr]\d+|navsym_\w*|nv_\w*)")


#: Variables of the writers' own, around the formulas.
LOCAL = tuple("b i j k m n r w x y bad data far name near program result results state status steps values".split())
LONGEST = 58  # signs of a name: with a number behind it, what Fortran and C tell apart


def identifier(text: str, taken: Iterable[str] = ()) -> str:
    """A name that every target accepts, made of the given one.

    Greek letters are spelled out, other signs become ``_``; a name that is taken gets a number.
    """
    name = re.sub(r"[^A-Za-z0-9]+", "_", "".join(spelled(c) for c in text)).strip("_") or "x"
    if not name[0].isalpha():
        name = f"x_{name}"
    if name.lower() in TAKEN or TEMPORARY.fullmatch(name.lower()) or MACRO.fullmatch(name):
        name = f"{name}_"
    known = {other.lower() for other in taken}
    candidate, number = name, 1
    while candidate.lower() in known:
        number += 1
        candidate = f"{name.rstrip('_')}_{number}"
    return candidate


def local_names(names: Mapping[int, str], taken: Iterable[str]) -> dict[int, str]:
    """Names of values as names of local variables, different from each other and from the names that are taken."""
    found: dict[int, str] = {}
    used = [*taken, *LOCAL]
    for place, name in names.items():
        found[place] = identifier(name[:LONGEST], used)
        used.append(found[place])
    return found


def spelled(char: str) -> str:
    """An ASCII character itself, a Greek letter by its name, anything else a gap."""
    if char.isascii():
        return char
    words = unicodedata.name(char, "").split()
    return words[-1].lower() if words[:1] == ["GREEK"] else "_"


def function_name(claim_id: str) -> str:
    """``guaranteed_velocity:4.12.Phi33`` -> ``guaranteed_velocity_4_12_Phi33``; a star -> ``_corrected``.

    A name that is a function somewhere gets a ``_``.
    """
    name = identifier(claim_id.replace("*", "_corrected"))
    return f"{name}_" if name.lower() in FUNCTIONS else name


LONGEST_NAME = 24
#: What people call some of them.
NAMES = {
    Part(sp.sin(T), 1): "sinc",
    Part(expm1(T), 1): "exprel",
    Part(sp.sinh(T), 1): "sinhc",
    Part(T - sp.sin(T), 0): "x_minus_sin",
    Part(T - sp.sin(T), 3): "sinc_defect",
}


def name_of(part: Part) -> str:
    """A name from people, or one from the formula with a few digits that tell equal ones apart."""
    if part in NAMES:
        return NAMES[part]
    text = f"{expression_text(part.plain)}{'_over_t' * bool(part.divided)}"
    for sign, word in (("**", ""), ("+", "_plus_"), ("-", "_minus_"), ("/", "_over_")):
        text = text.replace(sign, word)
    plain = re.sub(r"_+", "_", re.sub(r"\W", "_", text)).strip("_")[:LONGEST_NAME].rstrip("_")
    digest = hashlib.sha256(f"{part.formula} {part.divided}".encode()).hexdigest()[:4]
    return f"{plain}_{digest}"
