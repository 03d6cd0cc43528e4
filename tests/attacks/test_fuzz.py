"""Random damage: every reader gives a value or a NavsymError, whatever the bytes are.

Honest files are cut, spliced and sprinkled with the pieces that parsers trip over, which reaches
deeper than random bytes do; those come as well.
"""

from __future__ import annotations

import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from navsym.core.errors import MissingEngineError, NavsymError
from navsym.language.expression import parse, symbol, to_text
from navsym.models.modelfile import model_from
from navsym.prove.claimfile import claims_from
from tests.attacks.campaigns.readers import EXPRESSION, READERS

PIECES = [
    b"",
    b'"',
    b"'",
    b"[",
    b"]",
    b"{",
    b"}",
    b"[[",
    b"]]",
    b"\n",
    b"\r",
    b"\0",
    b"\\",
    b"#",
    b"=",
    b",",
    b".",
    b"-",
    b"**",
    b"/",
    b"(",
    b")",
    b"0",
    b"9",
    b"1e999",
    b"nan",
    b"inf",
    b"true",
    b"null",
    b"\xff",
    b"\xd0\xb0",
    b"\xe2\x80\xae",
    b"1979-05-27",
    b"t",
    b"w",
    b"pi",
    b"sin",
    b"sqrt(",
    b"log(",
    b"exp(",
    b"1/0",
    b"9**9",
    b"**-1",
    b"model",
    b"[basis]\n",
    b"[[piece]]\n",
    b"F = 1\n",
    b'"""',
    b"\\u0000",
    b"\\ud800",
    b"NaN",
    b"Infinity",
    b"\xef\xbb\xbf",
    b"_",
    b"^",
    b" ",
]


def spoiled(honest):
    """The file with a few slices removed, repeated or replaced by awkward pieces."""
    cut = st.tuples(st.integers(0, len(honest)), st.integers(0, 12), st.sampled_from(PIECES) | st.binary(max_size=4))

    def apply(cuts):
        data = honest
        for at, width, piece in cuts:
            data = data[:at] + piece + data[at + width :]
        return data

    return st.lists(cut, min_size=1, max_size=4).map(apply)


#: These say where in ``where``; the readers of numbers may name the entry before they say what is wrong with it.
TEXTS = {"expression", "model", "basis", "claims", "json"}


def survives(read, data, named=False):
    try:
        return read(data)
    except MissingEngineError:
        return None
    except NavsymError as error:
        assert error.kind and re.match(r"([\w.\[\]]+: )?expected " if named else "expected ", error.message)
        assert error.message.isprintable() and error.where.isprintable()
        return None


@pytest.fixture(autouse=True)
def own_folder(tmp_path_factory, monkeypatch):
    """Readers of paths write their inputs here."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path_factory.getbasetemp()))


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=150, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_a_damaged_file_is_read_or_refused(name, data):
    read, honest = READERS[name]
    survives(read, data.draw(spoiled(honest)), name not in TEXTS)


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=60, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=80) | st.text(max_size=40).map(lambda text: text.encode("utf-8", "surrogatepass")))
def test_random_bytes_are_read_or_refused(name, data):
    survives(READERS[name][0], data, name not in TEXTS)


@settings(max_examples=600)
@given(spoiled(EXPRESSION))
def test_a_damaged_expression_is_read_or_refused(data):
    symbols = {"x": symbol("x", positive=True), "T": symbol("T"), "w": symbol("w"), "t": symbol("t")}
    value = survives(lambda data: parse(data.decode("latin-1"), symbols, where="f"), data)
    if value is not None:
        assert parse(to_text(value), symbols).free_symbols == value.free_symbols


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=6),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=8,
)
KEYS = "model basis parameters measurement piece interval targets symbols claim".split()
INNER = "name states F h sigma T variable H interval id left right relation box from to w a".split()
documents = st.dictionaries(
    st.sampled_from(KEYS),
    st.dictionaries(st.sampled_from(INNER), json_values, max_size=4)
    | st.lists(st.dictionaries(st.sampled_from(INNER), json_values, max_size=4), max_size=2)
    | json_values,
    max_size=5,
)


@pytest.mark.parametrize("read", [model_from, claims_from])
@settings(max_examples=300)
@given(document=documents)
def test_a_document_of_wrong_types_is_refused(read, document):
    survives(lambda document: read(document, "f"), document)
