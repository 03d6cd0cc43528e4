"""Small functions with traps of meaning in them: the wrong reading is never PROVED, the right one never REFUTED.

``traps.txt`` holds them: the end of the file, what is asked for, what it is ("-" where the language has no such
number), and wrong readings of it.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import navsym as nav

TRAPS = [block.partition("\n") for block in (Path(__file__).parent / "traps.txt").read_text().split("==== ")[1:]]


def ask(folder, source, end, left, right):
    """The verdict on one question about the function f; none where the question itself makes no sense."""
    (folder / f"source{end}").write_text(source)
    head = f'[[code]]\nname = "code"\nfile = "source{end}"\nfunction = "f"\n'
    (folder / "spec.toml").write_text(f'{head}[[question]]\nkind = "equal"\nleft = "code:{left}"\nright = "{right}"\n')
    try:
        return str(nav.audit(folder / "spec.toml").questions[0].status)
    except nav.NavsymError as error:
        return error.kind


@pytest.mark.parametrize(("head", "source"), [(head, source) for head, _, source in TRAPS])
def test_a_trap_of_meaning_is_read_rightly_or_refused(tmp_path, head, source):
    end, left, right, *wrong = re.split(r" \| ", head)
    assert right == "-" or ask(tmp_path, source, end, left, right) in ("PROVED", "OPEN")
    for claim in wrong:
        assert ask(tmp_path, source, end, left, claim) != "PROVED"


def test_most_of_what_has_a_right_reading_is_read(tmp_path):
    """So that a reader which refuses all does not pass."""
    known = [(re.split(r" \| ", head), source) for head, _, source in TRAPS if " | - | " not in head]
    proved = [ask(tmp_path, source, *head[:3]) == "PROVED" for head, source in known]
    assert sum(proved) >= 0.6 * len(proved) > 20


def test_a_pointer_that_is_set_to_one_variable_leaves_the_others_read(tmp_path):
    source = (
        "double a, b, c;\ndouble f(double x) {\n  double *q = &a;\n  q = &b;\n  c = 2*x;\n  *q = 5;\n  return c;\n}\n"
    )
    assert ask(tmp_path, source, ".c", "return", "2*x") == "PROVED"
    assert ask(tmp_path, source.replace("&b;", "&c;"), ".c", "return", "2*x") == "OPEN"
    assert ask(tmp_path, source.replace("q = &b;", "q = p(x);"), ".c", "return", "2*x") == "OPEN"
