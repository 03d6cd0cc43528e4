"""Hostile files: each is refused with a kind, a place and advice, in under a second, and nothing runs.

Every payload is a whole file. Most put one hostile text into one slot of an honest model, claim or
filter-bank file; the rest are files that are not even that. Real files lie in ``files/``.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from navsym.errors import NavsymError
from navsym.text.claimfile import read_claims
from navsym.text.jsonfile import read_json
from navsym.text.modelfile import read_model

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

SYNTAX, LARGE, DOMAIN, UNKNOWN = "syntax", "too-large", "domain", "unknown-symbol"
TWICE, EMPTY, SHAPE, INFINITE, MISSING = "duplicate", "empty", "shape", "not-finite", "missing-file"

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
    "subscript": ("w[0]", SYNTAX),
    "star arguments": ("sin(*w)", SYNTAX),
    "keyword argument": ("sin(x=1)", SYNTAX),
    "ternary": ("w if w else w", SYNTAX),
    "comparison": ("w == w", SYNTAX),
    "and": ("w and w", SYNTAX),
    "matrix product": ("w @ w", SYNTAX),
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
    "rational root": ("2**(1/1009)", LARGE),
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

BROKEN = {
    # not text
    "empty": (b"", EMPTY),
    "blank": (b" \n\t\r\n", EMPTY),
    "byte order mark": (b"\xef\xbb\xbf" + MODEL.encode(), SYNTAX),
    "UTF-16": (MODEL.encode("utf-16"), SYNTAX),
    "UTF-16 without a mark": (MODEL.encode("utf-16-le"), SYNTAX),
    "UTF-32": (MODEL.encode("utf-32"), SYNTAX),
    "Latin-1": ('[model]\nname = "café"'.encode("latin-1"), SYNTAX),
    "overlong UTF-8": (b'a = "\xc0\xaf"', SYNTAX),
    "surrogate in UTF-8": (b'a = "\xed\xa0\x80"', SYNTAX),
    "NUL": (b"[model]\0", SYNTAX),
    "binary": (bytes(range(256)) * 10, SYNTAX),
    "zip": (b"PK\x03\x04" + b"\0" * 100, SYNTAX),
    "pickle": (b"\x80\x04cposix\nsystem\n(S'touch PWNED'\ntR.", SYNTAX),
    "pickle, text": (b"cposix\nsystem\n(S'touch PWNED'\ntR.", SYNTAX),
    "too long": (b"# " + b"x" * 300_000, LARGE),
    # not TOML
    "prose": (b"Once upon a time", SYNTAX),
    "YAML": (b"!!python/object/apply:os.system ['touch PWNED']", SYNTAX),
    "JSON": (b'{"model": {}}', SYNTAX),
    "Python": (b"import os\nos.system('touch PWNED')", SYNTAX),
    "shell": (b"#!/bin/sh\ntouch PWNED\n", SYNTAX),
    "unclosed text": (b'[model]\nname = "m', SYNTAX),
    "unclosed list": (b"[model]\nF = [[", SYNTAX),
    "carriage return alone": (b"[model]\rname = 1", SYNTAX),
    "control character": (b'a = "\x07"', SYNTAX),
    "bad escape": (b'a = "\\q"', SYNTAX),
    "surrogate escape": (b'a = "\\ud800"', SYNTAX),
    # TOML bombs
    "many brackets": (b"a = " + b"[" * 100_000, LARGE),
    "balanced brackets": (b"a = " + b"[" * 50_000 + b"]" * 50_000, LARGE),
    "many inline tables": (b"a = " + b"{a = " * 20_000, LARGE),
    "dotted key": (b"a." * 100_000 + b"a = 1", LARGE),
    "dotted key with blanks": (b"a . " * 50_000 + b"a = 1", LARGE),
    "quoted dotted key": (b'"a".' * 50_000 + b"a = 1", LARGE),
    "dotted table": (b"[" + b"a." * 100_000 + b"a]", LARGE),
    "brackets after a quote": (b"a = '" + b"\n" + b"[" * 100_000, LARGE),
    "many digits": (b"a = " + b"9" * 100_000, LARGE),
    "hexadecimal digits": (b"a = 0x" + b"f" * 100_000, LARGE),
    "many tables": (b"[[claim]]\n" * 20_000, SYNTAX),
    # TOML that means something else
    "key twice": (b"[model]\nname = 'a'\nname = 'b'", TWICE),
    "table twice": (b"[model]\n[model]", TWICE),
    "inline key twice": (b"model = {name = 'a', name = 'b'}", TWICE),
    "date": (b"[model]\nname = 1979-05-27", SYNTAX),
    "time": (b"[model]\nname = 07:32:00", SYNTAX),
    "nan": (b"[model]\nF = [[nan]]", INFINITE),
    "inf": (b"[model]\nF = [[+inf]]", INFINITE),
    "unknown table": (b"[modle]\nname = 'a'", SYNTAX),
    "dunder table": (b"[__proto__]\nname = 'a'", SYNTAX),
    "key of control characters": (b'"\\u001b[31m" = 1', SYNTAX),
    "long key": (b"a" * 200_000 + b" = 1", SYNTAX),
    "model is text": (b"model = 'a'", SHAPE),
    "model is a list": (b"model = [1]", SHAPE),
    "model is true": (b"model = true", SHAPE),
    "no model": (b"[parameters]\nw = 'real'", EMPTY),
}

MODEL_EDITS = {
    "ragged F": ('["0", "w"]', '["0"]', SHAPE),
    "one row": (', ["0", "w"]', "", SHAPE),
    "flat F": ('[["0", "w**2"], ["0", "w"]]', '["0", "w**2"]', SHAPE),
    "empty F": ('[["0", "w**2"], ["0", "w"]]', "[]", EMPTY),
    "boolean": ('"w**2"', "true", SYNTAX),
    "table in F": ('"w**2"', "{a = 1}", SYNTAX),
    "list in F": ('"w**2"', '["w"]', SYNTAX),
    "bare exponent bomb": ('"w**2"', "1e999999999", LARGE),
    "bare nan": ('"w**2"', "nan", INFINITE),
    "bare infinity": ('"w**2"', "-inf", INFINITE),
    "T zero": ('"pi/2"', "0", DOMAIN),
    "T negative": ('"pi/2"', '"-pi"', DOMAIN),
    "T just negative": ('"pi/2"', '"pi - 3.1415926535897932384626433832795028841972"', DOMAIN),
    "T is nothing": ('"pi/2"', '""', EMPTY),
    "T is a state": ('"pi/2"', '"y1"', UNKNOWN),
    "sigma negative": ('sigma = "1"', 'sigma = "-1"', DOMAIN),
    "sigma zero": ('sigma = "1"', "sigma = 0.0", DOMAIN),
    "range upside down": ('"1/2"', '"5"', DOMAIN),
    "range of names": ('"1/2"', '"w"', UNKNOWN),
    "range of bombs": ('"1/2"', '"exp(exp(exp(9)))"', LARGE),
    "range nearly empty": ('"1/2"', '"2 + sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6))"', DOMAIN),
    "measurement twice": ("[interval]", '[[measurement]]\nname = "velocity"\nh = [1, 0]\n[interval]', TWICE),
    "65 states": ('"y2"]', ", ".join(f'"z{i}"' for i in range(65)) + "]", LARGE),
    "unknown key": ('sigma = "1"', 'sigm = "1"', SYNTAX),
    "parameter with code for a name": ("[[measurement]]", '"a; system(1)" = "real"\n[[measurement]]', SYNTAX),
    "parameter t": ("[[measurement]]", 't = "real"\n[[measurement]]', TWICE),
    "parameter pi": ("[[measurement]]", 'pi = "real"\n[[measurement]]', TWICE),
    "target of zeros": ("[interval]", "[targets]\na = [0, 0]\n[interval]", DOMAIN),
    "basis beside the model": ("[interval]", '[basis]\nvariable = "s"\n[interval]', SYNTAX),
}

JSON = {
    "empty": (b"", EMPTY),
    "NaN": (b'{"models": [{"F": [[NaN]]}]}', INFINITE),
    "Infinity": (b"[Infinity]", INFINITE),
    "minus Infinity": (b"[-Infinity]", INFINITE),
    "overflow": (b"[1e400]", INFINITE),
    "key twice": (b'{"models": [], "models": [1]}', TWICE),
    "nested key twice": (b'{"a": {"b": 1, "b": 2}}', TWICE),
    "escaped key twice": (b'{"a": 1, "\\u0061": 2}', TWICE),
    "many brackets": (b"[" * 1_000_00, LARGE),
    "balanced brackets": (b"[" * 500 + b"]" * 500, LARGE),
    "many tables": (b'{"a":' * 100_000, LARGE),
    "many digits": (b"[" + b"9" * 100_000 + b"]", LARGE),
    "digits beyond a double": (b"[" + b"9" * 400 + b"]", LARGE),
    "surrogate": (b'["\\udc00"]', SYNTAX),
    "single quotes": (b"{'a': 1}", SYNTAX),
    "trailing comma": (b"[1,]", SYNTAX),
    "comment": (b"[1] // x", SYNTAX),
    "two documents": (b"{}{}", SYNTAX),
    "undefined": (b"undefined", SYNTAX),
    "Python": (b"__import__('os').system('touch PWNED')", SYNTAX),
    "byte order mark": (b"\xef\xbb\xbf{}", SYNTAX),
    "UTF-16": ("{}".encode("utf-16"), SYNTAX),
    "UTF-16 without a mark": ("{}".encode("utf-16-be"), SYNTAX),
    "broken UTF-8": (b'"\xff"', SYNTAX),
    "NUL": (b"{}\0", SYNTAX),
    "control character": (b'"\x01"', SYNTAX),
    "pickle": (b"cposix\nsystem\n(S'touch PWNED'\ntR.", SYNTAX),
    "npy": (b"\x93NUMPY\x01\0", SYNTAX),
    "too long": (b" " * 16_000_001, LARGE),
}


def filled(template, honest, slot=None, value=""):
    text = template
    for key, good in honest.items():
        text = text.replace(key, value if key == slot else good)
    return text.encode()


def edited(old, new):
    text = filled(MODEL, HONEST).decode()
    assert old in text
    return text.replace(old, new, 1).encode()


def table():
    """name -> (reader, file, kind)"""
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
    for name, (data, kind) in BROKEN.items():
        cases[f"file: {name}"] = (read_model, data, kind)
    for name, (old, new, kind) in MODEL_EDITS.items():
        cases[f"model: {name}"] = (read_model, edited(old, new), kind)
    for name, (data, kind) in JSON.items():
        cases[f"json: {name}"] = (read_json, data, kind)
    return cases


CASES = table()
FILES = {
    "tower.toml": (read_model, LARGE),
    "import.toml": (read_model, SYNTAX),
    "look_alike.toml": (read_claims, SYNTAX),
    "duplicate.toml": (read_claims, TWICE),
    "singular.toml": (read_claims, DOMAIN),
    "ragged.toml": (read_model, SHAPE),
    "bank.json": (read_json, INFINITE),
}

# Whatever starts code, a process or a connection, or writes a file, while a payload is being read.
HEARD: list[str] = []
ARMED = False
PROCESSES = {
    "os.system",
    "os.exec",
    "os.posix_spawn",
    "os.fork",
    "os.forkpty",
    "subprocess.Popen",
    "socket.connect",
    "pty.spawn",
    "ctypes.dlopen",
    "os.remove",
    "os.rename",
    "os.mkdir",
    "shutil.rmtree",
    "pickle.find_class",
}


def listen(event, arguments):
    if not ARMED:
        return
    if event in PROCESSES:
        HEARD.append(event)
    elif event == "compile" and not from_a_module(str(arguments[1])):
        HEARD.append(f"compile {arguments[1]}")
    elif event == "exec" and not from_a_module(arguments[0].co_filename):
        HEARD.append(f"exec {arguments[0].co_filename}")
    elif event == "open" and isinstance(arguments[1], str) and set(arguments[1]) & set("wax+"):
        HEARD.append(f"open {arguments[0]!r} {arguments[1]}")


def from_a_module(filename):
    """The algebra loads parts of itself on first use; a payload would come from no file."""
    return filename.endswith(".py") and os.path.isabs(filename)


sys.addaudithook(listen)


@pytest.fixture(scope="module", autouse=True)
def the_algebra_is_loaded(tmp_path_factory):
    """Everything that an honest file needs is imported before anything is timed or listened to."""
    folder = tmp_path_factory.mktemp("honest")
    (folder / "m.toml").write_bytes(filled(MODEL, HONEST, "EXPRESSION", "abs(sin(exp(2)))*tan(w)**(1/3)"))
    (folder / "c.toml").write_bytes(filled(CLAIMS, HONEST_CLAIM))
    read_model(folder / "m.toml")
    read_claims(folder / "c.toml")


def refused(read, path, kind):
    global ARMED
    HEARD.clear()
    started = time.process_time()
    ARMED = True
    try:
        with pytest.raises(NavsymError) as caught:
            read(path)
    finally:
        ARMED = False
    seconds = time.process_time() - started
    error = caught.value
    assert HEARD == []
    assert not list(Path(path).parent.glob("**/PWNED")) and not Path("PWNED").exists()
    assert (error.kind, error.status) == (kind, 2), str(error)
    assert error.where.startswith(str(path))
    assert error.message.startswith("expected ") and "; got " in error.message and "; do " in error.message
    assert len(str(error)) < 1000 and str(error).isprintable()
    assert seconds < 1.0
    return error


@pytest.mark.parametrize("name", CASES)
def test_a_hostile_file_is_refused_and_nothing_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    read, data, kind = CASES[name]
    path = tmp_path / "file"
    path.write_bytes(data)
    refused(read, path, kind)


@pytest.mark.parametrize("name", FILES)
def test_the_stored_hostile_files_are_refused(name, tmp_path, monkeypatch):
    path = Path(__file__).with_name("files") / name
    monkeypatch.chdir(tmp_path)
    read, kind = FILES[name]
    refused(read, path, kind)


def test_the_honest_files_are_read(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(filled(MODEL, HONEST).replace(b"\n", b"\r\n"))
    assert read_model(path).states == ("y1", "y2")
    path.write_bytes(filled(CLAIMS, HONEST_CLAIM))
    assert len(read_claims(path).claims) == 1


def test_the_listener_hears(tmp_path):
    """A watch that cannot ring proves nothing."""
    global ARMED
    HEARD.clear()
    ARMED = True
    try:
        exec(compile("1 + 1", "<payload>", "exec"))
        (tmp_path / "x").open("w").close()
        os.system("true")
    finally:
        ARMED = False
    assert {word.split()[0] for word in HEARD} == {"compile", "exec", "open", "os.system"}


@pytest.mark.parametrize("read", [read_model, read_claims, read_json])
@pytest.mark.parametrize("name", ["nowhere", ".", "/dev/zero", "/dev/full", "a\0b"])
def test_what_is_no_file_is_missing(read, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NavsymError) as caught:
        read(name)
    assert (caught.value.kind, caught.value.status) == (MISSING, 2)


def test_a_pipe_does_not_hang(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(NavsymError) as caught:
        read_model(path)
    assert caught.value.kind == MISSING


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read everything")
def test_a_file_without_permission_is_missing(tmp_path):
    path = tmp_path / "secret"
    path.write_text("x")
    path.chmod(0)
    with pytest.raises(NavsymError) as caught:
        read_model(path)
    assert caught.value.kind == MISSING
