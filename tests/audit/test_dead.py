"""Which inputs make no difference to an output that names them."""

from __future__ import annotations

from fractions import Fraction

import pytest

import navsym as nav
from navsym.core.errors import NavsymError


def ask(folder, body, by=("a",), of="out[0]", mapping=""):
    """The verdicts on one output, one for each input."""
    code = f"void step(float a, float b, float c, float out[2])\n{{\n    {body}\n}}\n"
    (folder / "code.c").write_text(code)
    head = f'[[code]]\nname = "m"\nfile = "code.c"\nfunction = "step"\n{mapping}\n'
    names = ", ".join(f'"m:{name}"' for name in by)
    (folder / "spec.toml").write_text(f'{head}[[question]]\nkind = "dead"\nof = "m:{of}"\nby = [{names}]\n')
    return nav.audit(folder / "spec.toml").questions[0]


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ("out[0] = a * b - b * a + c;", "PROVED"),
        ("out[0] = a * b - b * b + c;", "REFUTED"),
        ("out[0] = a; out[0] = b;", "PROVED"),  # written over
        ("out[0] = a; out[0] += b;", "REFUTED"),
        ("float r = 0.0f * a; out[0] = r + c;", "PROVED"),
        ("out[0] = sinf(a) * sinf(a) + cosf(a) * cosf(a);", "PROVED"),
        ("out[0] = sinf(a) * sinf(a) - cosf(a) * cosf(a);", "REFUTED"),
        ("out[0] = log_it(a);", "OPEN"),
        # a case is an output, too
        ("if (a > 0) { out[0] = 1; } else { out[0] = 2; }", "REFUTED"),
        ("if (a > 0) { out[0] = b; } else { out[0] = b; }", "PROVED"),
        ("if (c > 0) { out[0] = b; } else { out[0] = 2 * b; }", "PROVED"),  # one value of c, whatever a is
        ("if (c > 0) { out[0] = b; } else { out[0] = a; }", "REFUTED"),  # alive in one case
        ("if (a > c) { out[0] = b; } else { out[0] = 2 * b; }", "REFUTED"),
    ],
)
def test_an_output_is_dead_in_an_input_that_makes_no_difference_in_any_case(tmp_path, body, status):
    assert str(ask(tmp_path, body).status) == status


def test_the_counterexample_holds_two_values_of_the_input_in_its_range(tmp_path):
    mapping = "[code.symbols]\na = ['2', '3']"
    (entry,) = ask(tmp_path, "out[0] = a * a * b;", mapping=mapping).entries
    assert str(entry.status) == "REFUTED"
    first, second = (Fraction(entry.counterexample[name]) for name in ("a", "a'"))
    assert 2 <= first <= 3 and 2 <= second <= 3 and first != second
    b = Fraction(entry.counterexample["b"])
    assert [*map(Fraction, entry.values)] == [first**2 * b, second**2 * b]
    assert entry.suggestion is None


def test_each_input_has_a_column_and_each_output_a_row(tmp_path):
    question = ask(tmp_path, "out[0] = a + b - b; out[1] = b;", by=("a", "b", "c"), of="out")
    dead = {entry.entry for entry in question.entries if str(entry.status) == "PROVED"}
    assert dead == {(1, 2), (1, 3), (2, 1), (2, 3)} and len(question.entries) == 6


def test_an_input_that_a_relation_holds_is_not_free(tmp_path):
    with pytest.raises(NavsymError, match="free"):
        ask(tmp_path, "out[0] = a * a + b * b;", mapping='relations = ["a**2 + b**2 = 1"]')
