"""What code calls the functions of its own that stand for parts with a hole at zero."""

from __future__ import annotations

import hashlib
import re

import sympy as sp

from navsym.export.atoms import expm1
from navsym.export.holes import Part, T
from navsym.prove.wording import expression_text

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
