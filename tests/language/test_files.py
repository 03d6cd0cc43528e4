"""Strict TOML and JSON."""

from __future__ import annotations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from navsym.core.errors import NavsymError
from navsym.language.jsonfile import parse_json, read_json
from navsym.language.tomlfile import Numeral, parse_toml, read_toml

plain = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**9), 10**9)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cs"]), max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("abc\u0444", max_size=4), inner, max_size=4),
    max_leaves=12,
)


@given(plain)
def test_json_without_traps_is_read_as_it_is(document):
    import json

    assume(document != "")
    assert parse_json(json.dumps(document)) == document
    assert parse_json(json.dumps(document, ensure_ascii=False).replace("\0", "").encode()) is not ...


@pytest.mark.parametrize(
    ("text", "kind", "where"),
    [
        ("", "empty", "f.json"),
        (" \n", "empty", "f.json"),
        ('{"a": 1, "a": 2}', "duplicate", "f.json: a"),
        ('{"m": [1, NaN]}', "not-finite", "f.json: m[1]"),
        ('{"m": {"n": -Infinity}}', "not-finite", "f.json: m.n"),
        ("[1e999]", "not-finite", "f.json: [0]"),
        ("[" * 100_000, "too-large", "f.json"),
        ('{"a":' * 100_000, "too-large", "f.json"),
        ("[" * 70 + "]" * 70, "too-large", "f.json"),
        ("[" + "{}," * 1_000_000 + "{}]", "too-large", "f.json"),
        ("9" * 5000, "too-large", "f.json"),
        ("[" + "9" * 400 + "]", "too-large", "f.json: [0]"),
        ('{"a": "\\ud800"}', "syntax", "f.json: a"),
        ("{\n  'a': 1}", "syntax", "f.json: line 2, column 3"),
        ("[1, 2", "syntax", "f.json: line 1, column 6"),
        ("[1] []", "syntax", "f.json: line 1, column 5"),
    ],
)
def test_json_that_other_readers_repair_is_refused(text, kind, where):
    with pytest.raises(NavsymError, match=r"expected .*; got .*; \w") as caught:
        parse_json(text, "f.json")
    assert (caught.value.kind, caught.value.where[: len(where)]) == (kind, where)


@pytest.mark.parametrize(
    ("text", "kind", "where"),
    [
        ("", "empty", "f.toml"),
        ("a = 1\na = 2", "duplicate", "f.toml"),
        ("[a]\n[a]", "duplicate", "f.toml: line 2"),
        ("x = {a = 1, a = 2}", "duplicate", "f.toml: line 1"),
        ("a.b = 1\na = 2", "duplicate", "f.toml"),
        ("a = nan", "not-finite", "f.toml: a"),
        ("[b]\nc = [1, -inf]", "not-finite", "f.toml: b.c[1]"),
        ("a = 1979-05-27", "syntax", "f.toml: a"),
        ("a = 99", None, ""),
        ("a = " + "9" * 5000, "too-large", "f.toml"),
        ("a = 0x" + "f" * 5000, "too-large", "f.toml: a"),
        ("a = " + "[" * 100_000, "too-large", "f.toml: line 1"),
        ("a = " + "{b = " * 10_000, "too-large", "f.toml: line 1"),
        ("\n" + "a." * 50_000 + "a = 1", "too-large", "f.toml: line 2"),
        ("[" + "a." * 50_000 + "a]", "too-large", "f.toml: line 1"),
        ("a = b", "syntax", "f.toml: line 1, column 5"),
    ],
)
def test_toml_is_strict(text, kind, where):
    if kind is None:
        assert parse_toml(text) == {"a": 99}
        return
    with pytest.raises(NavsymError, match=r"expected .*; got .*; \w") as caught:
        parse_toml(text, "f.toml")
    assert (caught.value.kind, caught.value.where[: len(where)]) == (kind, where)


def test_brackets_and_dots_inside_text_are_text():
    text = 'a = "' + "[" * 99 + "." * 99 + '" # ' + "[" * 99 + "\nb = '''" + "{\n" * 99 + "'''\n" + 'c = "\\"[["'
    assert parse_toml(text)["c"] == '"[['


def test_a_decimal_keeps_its_digits():
    found = parse_toml("a = 0.10\nb = 1_000.5\nc = 1E-3\nd = 7")
    assert found == {"a": "0.10", "b": "1000.5", "c": "1e-3", "d": 7}
    assert isinstance(found["a"], Numeral)


@pytest.mark.parametrize("read", [read_json, read_toml])
@pytest.mark.parametrize("name", ["nothing", ".", "a\0b", "x" * 5000])
def test_a_file_that_cannot_be_read_is_missing(tmp_path, read, name):
    with pytest.raises(NavsymError, match="readable file") as caught:
        read(tmp_path / name)
    assert caught.value.kind == "missing-file" and caught.value.status == 2


@pytest.mark.parametrize(
    "data", [b"\xff\xfe{\0}\0", b"\xfe\xff\0{\0}", b"{\x80}", b"a\0", b"PK\x03\x04", b"\x7fELF", b"\x1f\x8b"]
)
@pytest.mark.parametrize("read", [read_json, read_toml])
def test_what_is_not_plain_utf8_is_said(tmp_path, read, data):
    path = tmp_path / "file"
    path.write_bytes(data)
    with pytest.raises(NavsymError, match="UTF-8") as caught:
        read(path)
    assert caught.value.kind == "syntax" and caught.value.where.startswith(str(path))


@pytest.mark.parametrize("read, text", [(read_json, b'{"a": 1}'), (read_toml, b"a = 1")])
def test_a_byte_order_mark_is_no_part_of_a_file(tmp_path, read, text):
    path = tmp_path / "file"
    path.write_bytes(b"\xef\xbb\xbf" + text)
    assert read(path) == {"a": 1}


@pytest.mark.parametrize("read", [read_json, read_toml])
def test_a_file_above_the_limit_is_not_read_to_its_end(tmp_path, read):
    path = tmp_path / "file"
    with path.open("wb") as file:
        file.truncate(10**9)
    with pytest.raises(NavsymError, match="at most") as caught:
        read(path)
    assert caught.value.kind == "too-large"
