"""Names in generated code: ASCII, no keyword of any target, different also without regard to case."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping

#: Keywords, functions of the C library, and words of our own, that no target may see as a variable.
TAKEN = frozenset(
    """
    abs acos and as asin asm assert async atan atan2 auto await begin bool break call case catch cbrt ceil
    char class const continue copysign cos cosh def default defer del delete do double e else elif elseif end
    endif enum erf erfc except exec exp exp2 expm1 export extends extern fabs false finally float floor fma
    fmax fmin fmod fn for from function gamma global goto i if impl implicit import in inline int integer
    interface intent is j j0 j1 jn lambda let lgamma list local log log10 log1p log2 long loop match math
    max min mod module move mut namespace nan new nil none nonlocal not null operator or out parameter pass
    pi pow print private program protected pub public pure raise real ref register remainder restrict result
    return round self short signed sin sinh sizeof sqrt static status struct subroutine super switch tan tanh
    template tgamma this throw trait true try type typedef typeof union unless unsigned use using var virtual
    void volatile where while with y0 y1 yield yn
    eof err errno every here huge infinity left linux np number ok shape some std stderr stdin stdout unix
    """.split()
)
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
    """``guaranteed_velocity:4.12.Phi33`` -> ``guaranteed_velocity_4_12_Phi33``; a star -> ``_corrected``."""
    return identifier(claim_id.replace("*", "_corrected"))
