"""Hostile files: not text, not TOML, bombs, twins, wrong types and wrong shapes.

Each is refused with its kind, its place and advice, in under a second, and nothing runs.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from navsym.core.errors import NavsymError
from navsym.language.jsonfile import read_json
from navsym.models.modelfile import read_model
from navsym.prove.claimfile import read_claims

MODEL = """[model]
name = "m"
states = ["y1", "y2"]
F = [["0", "w**2"], ["0", "w"]]
[parameters]
w = ["1/2", "2"]
[[measurement]]
name = "velocity"
h = ["1", "0"]
sigma = "1"
[interval]
T = "pi/2"
"""

SYNTAX, LARGE, DOMAIN, UNKNOWN = "syntax", "too-large", "domain", "unknown-symbol"
TWICE, EMPTY, SHAPE, INFINITE, MISSING = "duplicate", "empty", "shape", "not-finite", "missing-file"

BROKEN = {
    # not text
    "empty": (b"", EMPTY),
    "blank": (b" \n\t\r\n", EMPTY),
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
    "UTF-16": ("{}".encode("utf-16"), SYNTAX),
    "UTF-16 without a mark": ("{}".encode("utf-16-be"), SYNTAX),
    "broken UTF-8": (b'"\xff"', SYNTAX),
    "NUL": (b"{}\0", SYNTAX),
    "control character": (b'"\x01"', SYNTAX),
    "pickle": (b"cposix\nsystem\n(S'touch PWNED'\ntR.", SYNTAX),
    "npy": (b"\x93NUMPY\x01\0", SYNTAX),
    "too long": (b" " * 16_000_001, LARGE),
}


def edited(old, new):
    assert old in MODEL
    return MODEL.replace(old, new, 1).encode()


def table():
    """Name -> (reader, file, kind)."""
    broken = {f"file: {name}": (read_model, data, kind) for name, (data, kind) in BROKEN.items()}
    edits = {f"model: {n}": (read_model, edited(old, new), kind) for n, (old, new, kind) in MODEL_EDITS.items()}
    return broken | edits | {f"json: {name}": (read_json, data, kind) for name, (data, kind) in JSON.items()}


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


@pytest.mark.parametrize("name", CASES)
def test_a_hostile_file_is_refused_and_nothing_runs(name, refused, tmp_path):
    read, data, kind = CASES[name]
    path = tmp_path / "file"
    path.write_bytes(data)
    refused(read, path, kind)


@pytest.mark.parametrize("name", FILES)
def test_the_stored_hostile_files_are_refused(name, refused):
    read, kind = FILES[name]
    refused(read, Path(__file__).with_name("files") / name, kind)


def test_the_watch_hears(listen_to, tmp_path):
    """A watch that cannot ring proves nothing."""

    def ring():
        exec(compile("1 + 1", "<payload>", "exec"))
        (tmp_path / "x").open("w").close()
        os.system("true")

    assert {word.split()[0] for word in listen_to(ring)} == {"compile", "exec", "open", "os.system"}


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
