"""What every error of navsym keeps, whatever stands in the file that caused it."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from navsym.core.errors import NavsymError
from navsym.language.names import quote
from navsym.models.modelfile import model_from

ANYTHING = st.text(st.characters(), max_size=20)


@given(ANYTHING, ANYTHING, ANYTHING)
def test_words_of_a_file_cannot_steer_a_terminal_from_a_message(message, where, before):
    error = NavsymError(message, where=where).at(before)
    for text in (str(error), error.message, error.where, *error.as_json()["error"].values()):
        assert text.isprintable() and "\n" not in text
        text.encode("utf-8")


@given(st.text(st.characters(categories=["L", "N", "P", "Zs"]), max_size=20))
def test_printable_words_stay_as_they_are(message):
    assert NavsymError(message).message == message or not message.isprintable()


def test_a_parameter_named_by_a_control_character_is_refused_in_one_printable_line():
    for name in ("\x1f", "\n", "\u2028", "\ud800", "\x1b[31m"):
        try:
            model_from({"parameters": {name: None}}, "f")
        except NavsymError as error:
            assert str(error).isprintable() and error.message.startswith("expected ")
        else:
            raise AssertionError("accepted")


@given(ANYTHING, ANYTHING)
def test_a_message_has_three_parts_whatever_is_quoted_in_it(quoted, name):
    error = NavsymError(f"expected a name; got {quote(quoted)} in {quote(name)}; rename it: did you mean 'a; got b'?")
    assert error.expected == "a name" and error.got == f"{quote(quoted)} in {quote(name)}"
    assert error.remedy == "rename it: did you mean 'a; got b'?"


def test_a_message_of_another_form_is_its_own_remedy():
    error = NavsymError("see the manual")
    assert (error.expected, error.got, error.remedy) == ("", "", "see the manual")
