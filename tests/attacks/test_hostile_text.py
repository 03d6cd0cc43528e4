"""Hostile text in one slot of an honest file: a formula, a name, a label.

Each is refused with its kind, its place and advice, in under a second, and nothing runs.
"""

from __future__ import annotations

import pytest

from navsym.models.modelfile import read_model
from navsym.prove.claimfile import read_claims

MODEL = """[model]
name = "m"
states = ["y1", "NAME"]
F = [["0", "EXPRESSION"], ["0", "w"]]
[parameters]
w = ["RANGE", "2"]
[[measurement]]
name = "LABEL"
h = ["1", "0"]
sigma = "1"
[interval]
T = "INTERVAL"
"""
HONEST = {"NAME": "y2", "EXPRESSION": "w**2", "RANGE": "1/2", "LABEL": "velocity", "INTERVAL": "pi/2"}

CLAIMS = """[symbols]
a = "real"
p = "positive"
[[claim]]
id = "IDENT"
left = "LEFT"
right = "a"
relation = "="
"""
HONEST_CLAIM = {"IDENT": "c1", "LEFT": "a"}

SYNTAX, LARGE, DOMAIN, UNKNOWN, SHAPE = "syntax", "too-large", "domain", "unknown-symbol", "shape"
TWICE, EMPTY = "duplicate", "empty"

EXPRESSIONS = {
    # code in the place of a formula
    "import os": ('__import__(\\"os\\").system(\\"touch PWNED\\")', SYNTAX),
    "import os, single quotes": ("__import__('os').system('touch PWNED')", SYNTAX),
    "class walk": ("().__class__.__bases__[0].__subclasses__()", SYNTAX),
    "dunder": ("__class__", SYNTAX),
    "attribute of a name": ("w.__class__", SYNTAX),
    "attribute of a number": ("1 .real", SYNTAX),
    "lambda": ("(lambda: 0)()", SYNTAX),
    "f-string": ("f'{1}'", SYNTAX),
    "exec": ("exec('open(1)')", SYNTAX),
    "eval": ("eval(w)", UNKNOWN),
    "print": ("print(w)", UNKNOWN),
    "open": ("open('PWNED','w')", SYNTAX),
    "walrus": ("(q:=1)", SYNTAX),
    "comprehension": ("[w for w in w]", SYNTAX),
    "statement": ("w; import os", SYNTAX),
    "new line statement": ("w\\nimport os", SYNTAX),
    "comment": ("w # comment", SYNTAX),
    "string": ("'w'", SYNTAX),
    "subscript": ("w[0]", SHAPE),
    "star arguments": ("sin(*w)", SYNTAX),
    "keyword argument": ("sin(x=1)", SYNTAX),
    "ternary": ("w if w else w", SYNTAX),
    "comparison": ("w == w", SYNTAX),
    "and": ("w and w", SYNTAX),
    "matrix product": ("w @ w", SHAPE),
    "shift": ("1 << 99999999", SYNTAX),
    "floor division": ("w // 2", SYNTAX),
    "modulo": ("w % 2", SYNTAX),
    "complex": ("1j", SYNTAX),
    "sympy function": ("Integral(w, w)", UNKNOWN),
    "sympy constant": ("oo", UNKNOWN),
    "nan": ("nan", UNKNOWN),
    "I is not the imaginary unit": ("I", UNKNOWN),
    "backslash": ("w\\\\", SYNTAX),
    "backquote": ("`w`", SYNTAX),
    "dollar": ("$(touch PWNED)", SYNTAX),
    "percent format": ("%s%s%n", SYNTAX),
    "html": ("<script>alert(1)</script>", SYNTAX),
    "latex": ("\\\\input{/etc/passwd}", SYNTAX),
    "jinja": ("{{7*7}}", SYNTAX),
    # numbers that are not
    "hexadecimal": ("0x10", SYNTAX),
    "octal": ("0o7", SYNTAX),
    "separator": ("1_0", SYNTAX),
    "open decimal": ("1.", SYNTAX),
    "point first": (".5", SYNTAX),
    "three points": ("1.2.3", SYNTAX),
    "empty exponent": ("1e", SYNTAX),
    "ellipsis": ("...", SYNTAX),
    "Arabic digit": ("٣", SYNTAX),
    "full-width digit": ("１", SYNTAX),
    "superscript": ("w²", SYNTAX),
    "vulgar fraction": ("½", SYNTAX),
    # letters that only look right
    "Cyrillic er": ("р", SYNTAX),
    "Greek omega": ("ω", SYNTAX),
    "script w": ("𝓌", SYNTAX),
    "full-width w": ("ｗ", SYNTAX),
    "combining accent": ("w\u0301", SYNTAX),
    "zero-width space": ("w\u200b", SYNTAX),
    "no-break space": ("w\u00a0+ w", SYNTAX),
    "right-to-left": ("w\u202e+w", SYNTAX),
    "minus sign": ("1\u2212w", SYNTAX),
    "caret": ("w^2", SYNTAX),
    "implicit product": ("2w", SYNTAX),
    "implicit product of brackets": ("(w)(w)", SYNTAX),
    "soft hyphen": ("w\u00ad", SYNTAX),
    "line separator": ("w\u2028+w", SYNTAX),
    "escape sequence": ("\\u001b[2J", SYNTAX),
    "NUL in an escape": ("w\\u0000", SYNTAX),
    # bombs
    "tower": ("9**9**9", LARGE),
    "tower in brackets": ("9**(9**9)", LARGE),
    "tower by the left": ("((((9**999)**999)**999)**999)", LARGE),
    "tower of roots": ("(9**999)**(1/2)", LARGE),
    "hidden tower": ("2**(w+10**300)*2**(-w)", LARGE),
    "tower by logarithm": ("exp(10**9*log(2))", LARGE),
    "tower by symbol": ("((w**1000)**1000)**1000", LARGE),
    "negative tower": ("2**-(10**900)", LARGE),
    "fraction tower": ("(1/3)**99999", LARGE),
    "double exponential": ("sin(exp(exp(exp(99))))", LARGE),
    "hyperbolic bomb": ("abs(sin(cosh(cosh(99))))", LARGE),
    "huge exponent": ("1e999999999", LARGE),
    "huge negative exponent": ("1e-999999999", LARGE),
    "long number": ("9" * 4301, LARGE),
    "long fraction": ("0." + "3" * 5000, LARGE),
    "many brackets": ("(" * 100_000, LARGE),
    "balanced brackets": ("(" * 4000 + "w" + ")" * 4000, LARGE),
    "many functions": ("sin(" * 2000 + "w" + ")" * 2000, LARGE),
    "many powers": ("w" + "**w" * 3000, LARGE),
    "long sum": ("w+" * 100_000 + "w", LARGE),
    "long product of powers": ("*".join(["9**999"] * 1400), LARGE),
    "big roots": ("*".join(f"sqrt({10**200 + i})" for i in range(40)), LARGE),
    "rational root": ("2**(1/10000019)", LARGE),
    "long name": ("w" * 9_000, UNKNOWN),
    # mathematics that does not exist
    "division by zero": ("1/0", DOMAIN),
    "hidden division by zero": ("1/(w-w)", DOMAIN),
    "zero in disguise": ("1/(sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6)))", DOMAIN),
    "zero in disguise to a power": ("(sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6)))**-2", DOMAIN),
    "zero to a negative power": ("0**-1", DOMAIN),
    "logarithm of zero": ("log(0)", DOMAIN),
    "atan2 at the origin": ("atan2(0,0)", DOMAIN),
    "pole": ("tan(pi/2)", DOMAIN),
    "root of a negative number": ("sqrt(-1)", DOMAIN),
    "imaginary by fraction": ("(-8)**(1/3)", DOMAIN),
    "inverse sine of two": ("asin(2)", DOMAIN),
    # almost formulas
    "nothing": ("", EMPTY),
    "blank": ("   ", EMPTY),
    "operator only": ("+", SYNTAX),
    "open bracket": ("(w", SYNTAX),
    "closed bracket": ("w)", SYNTAX),
    "empty call": ("sin()", SYNTAX),
    "two arguments": ("sin(w, w)", SYNTAX),
    "one argument": ("atan2(w)", SYNTAX),
    "function without call": ("sin", SYNTAX),
    "name called": ("w(1)", SYNTAX),
    "comma": ("w, w", SYNTAX),
    "near miss": ("ww", UNKNOWN),
}

NAMES = {
    "statement": ("x; system(1)", SYNTAX),
    "call": ("x()", SYNTAX),
    "dunder": ("__class__", SYNTAX),
    "blank": (" ", SYNTAX),
    "empty": ("", SYNTAX),
    "digit": ("1x", SYNTAX),
    "Cyrillic": ("х", SYNTAX),
    "ligature that folds": ("ﬁ", SYNTAX),
    "html": ("</script>", SYNTAX),
    "new line": ("x\\ny", SYNTAX),
    "quote": ('x\\"', SYNTAX),
    "NUL": ("x\\u0000", SYNTAX),
    "right-to-left": ("x\u202e", SYNTAX),
    "path": ("../x", SYNTAX),
    "long": ("x" * 5_000, LARGE),
    "function": ("sin", TWICE),
    "constant": ("pi", TWICE),
    "parameter": ("w", TWICE),
    "time": ("t", TWICE),
    "another state": ("y1", TWICE),
}

LABELS = {
    "blank": ("", EMPTY),
    "shell": ("$(touch PWNED)", SYNTAX),
    "path": ("../../etc/passwd", SYNTAX),
    "html": ("<b>", SYNTAX),
    "long": ("v" * 100_000, LARGE),
    "new line": ("a\\nb", SYNTAX),
}


def filled(template, honest, slot=None, value=""):
    text = template
    for key, good in honest.items():
        text = text.replace(key, value if key == slot else good)
    return text.encode()


def table():
    """Name -> (reader, file, kind)."""
    cases = {}
    for name, (text, kind) in EXPRESSIONS.items():
        cases[f"F: {name}"] = (read_model, filled(MODEL, HONEST, "EXPRESSION", text), kind)
        claim = text.replace("w", "a").replace("ne" + "a", "new")
        cases[f"claim: {name}"] = (read_claims, filled(CLAIMS, HONEST_CLAIM, "LEFT", claim), kind)
    for name, (text, kind) in NAMES.items():
        cases[f"state: {name}"] = (read_model, filled(MODEL, HONEST, "NAME", text), kind)
    for name, (text, kind) in LABELS.items():
        cases[f"measurement: {name}"] = (read_model, filled(MODEL, HONEST, "LABEL", text), kind)
        cases[f"claim id: {name}"] = (read_claims, filled(CLAIMS, HONEST_CLAIM, "IDENT", text), kind)
    return cases


CASES = table()


@pytest.mark.parametrize("name", CASES)
def test_a_hostile_text_is_refused_and_nothing_runs(name, refused, tmp_path):
    read, data, kind = CASES[name]
    path = tmp_path / "file"
    path.write_bytes(data)
    refused(read, path, kind)


def test_the_honest_files_are_read(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(filled(MODEL, HONEST).replace(b"\n", b"\r\n"))
    assert read_model(path).states == ("y1", "y2")
    path.write_bytes(filled(CLAIMS, HONEST_CLAIM))
    assert len(read_claims(path).claims) == 1
