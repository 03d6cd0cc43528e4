"""Names as readers know them: Greek letters, indices, functions upright."""

from __future__ import annotations

import functools
import html
import re

NAMES = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau phi chi psi omega "
    "upsilon Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega lam oo eps"
).split()
GREEK = dict(zip(NAMES, "αβγδεζηθικλμνξπρστφχψωυΓΔΘΛΞΠΣΦΨΩλ∞ε", strict=True))
LATEX_SPELLING = {"lam": "lambda", "oo": "infty", "eps": "varepsilon", "epsilon": "varepsilon", "phi": "varphi"}
LATEX_FUNCTIONS = frozenset("sin cos tan cot sec csc exp log sinh cosh tanh det".split())
STEM = re.compile(r"(?P<stem>[A-Za-z]+?)(?P<index>\d*)$")


def greek_start(stem: str) -> str:
    """The longest Greek name at the beginning of a stem, empty where there is none."""
    return max((name for name in GREEK if stem.startswith(name)), key=len, default="")


@functools.lru_cache(maxsize=4096)
def split_name(name: str) -> tuple[str, str]:
    """Stem and index: ``theta2_11`` -> theta, 2,11; ``y1`` -> y, 1; ``zT`` -> z, T."""
    if name.endswith("_"):  # pi_ is a symbol and must not look like the number pi
        return name, ""
    head, *rest = [part for part in name.split("_") if part] or [name]
    match = STEM.match(head)
    stem, index = (match["stem"], match["index"]) if match else (head, "")
    greek = greek_start(stem)
    base = stem[len(greek) :]
    if len(base) == 2 and (base[0].isupper() or base[1] in "TNm"):  # zT, Vj, DeltaVy
        stem, index = greek + base[0], base[1] + index
    return stem, ",".join(part for part in (index, *rest) if part)


def varied(stem: str) -> bool:
    """True for the error of a Greek symbol, ``dphi``; ``deta`` is rather the determinant of a."""
    return stem[:1] == "d" and stem[1:] in GREEK and stem != "deta"


@functools.lru_cache(maxsize=4096)
def letter_of(stem: str) -> str:
    """The stem with a Greek name at its beginning as a letter: ``DeltaV`` -> ΔV, ``tau`` -> τ, ``dphi`` -> dφ."""
    if varied(stem):
        return "d" + GREEK[stem[1:]]
    greek = greek_start(stem)
    rest = stem[len(greek) :]
    return GREEK[greek] + rest if greek and len(rest) < 2 else stem


def mathml_name(name: str, function: bool = False) -> str:
    """One identifier in MathML; several letters that are no Greek name stand upright."""
    name, primes = name.rstrip("'"), "′" * name.count("'")
    stem, index = (name, "") if function else split_name(name)
    letter = stem if function else letter_of(stem)
    upright = function or len(letter) > 2
    tag = f'<mi mathvariant="normal">{html.escape(letter)}</mi>' if upright else f"<mi>{html.escape(letter)}</mi>"
    if primes:
        tag = f"<msup>{tag}<mo>{primes}</mo></msup>"
    if not index:
        return tag
    below = "<mo>,</mo>".join(
        f"<mn>{part}</mn>" if part.isdigit() else f"<mi>{html.escape(GREEK.get(part, part))}</mi>"
        for part in index.split(",")
    )
    return f"<msub>{tag}<mrow>{below}</mrow></msub>"


def latex_name(name: str, function: bool = False) -> str:
    """The same identifier in LaTeX."""
    if function:
        return f"\\{name}" if name in LATEX_FUNCTIONS else rf"\operatorname{{{latex_escape(name)}}}"
    name, primes = name.rstrip("'"), "'" * name.count("'")
    stem, index = split_name(name)
    greek = greek_start(stem)
    if varied(stem):
        letter = rf"\mathrm{{d}}\{LATEX_SPELLING.get(stem[1:], stem[1:])}"
    elif greek and len(stem) <= len(greek) + 1:
        letter = "\\" + LATEX_SPELLING.get(greek, greek) + " " + latex_escape(stem[len(greek) :])
    else:
        letter = stem if len(stem) == 1 else rf"\mathrm{{{latex_escape(stem)}}}"
    below = ",".join(rf"\{part}" if part in GREEK else latex_escape(part) for part in index.split(",") if part)
    return f"{letter}{primes}_{{{below}}}" if below else letter + primes


LATEX_ESCAPES = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "#": r"\#",
    "%": r"\%",
    "_": r"\_",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    '"': "''",
}


def latex_escape(text: str) -> str:
    """Words for LaTeX: every character that it would obey is written out."""
    return "".join(LATEX_ESCAPES.get(c, c) if c.isprintable() else " " for c in text)
