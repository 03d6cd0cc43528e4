"""Readers of public corpora: on lines of our own, and on the copies that this machine has."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.attacks.corpora import inequalities, integrals, measure, rules
from tests.attacks.evaluator import judge_text
from tests.attacks.trees import UnreadableError

FOLDER = os.environ.get("NAVSYM_CORPORA", "")
#: How many statements each corpus gives, at least.
LEAST = {"antiderivatives": 1_700, "rewrite rules": 300, "inequalities": 60}


def checkout(corpus: str) -> Path:
    """The copy of a corpus; the test is skipped where there is none."""
    path = Path(FOLDER) / measure.CORPORA[corpus].REPOSITORY
    if not FOLDER or not path.is_dir():
        pytest.skip(f"no copy of {path.name}: set NAVSYM_CORPORA to a folder that holds one (docs/corpora.md)")
    return path


def test_an_antiderivative_becomes_its_derivative():
    statement = integrals.read_line(
        "{Tan[x]^2 + ArcTanh[a*x], x, 3, -x + Tan[x] + Log[1 - a^2*x^2]/(2*a) + x*ArcTanh[a*x]}"
    )
    assert dict(statement.symbols) == {"a": "real", "x": "real"}
    assert judge_text(f"abs({statement.text.replace(' = ', ' - (')})) < 1e-40", {"a": "1/3", "x": "0.4"}) == "holds"


@pytest.mark.parametrize("line", ["{I*x, x, 1, I*x^2/2}", "{Erf[x], x, 1, x}", "{1/x, x, 1, PolyLog[2, x]}", "{x, x"])
def test_what_lies_outside_the_language_is_left_out(line):
    with pytest.raises((UnreadableError, ValueError)):
        integrals.read_line(line)


def test_a_minus_stands_before_the_whole_product():
    assert integrals.read_line("{-x^2*2, x, 1, x}").text.endswith("= -(x**2*2)")


def test_a_rule_becomes_an_equation():
    left, right = rules.parse(rules.TOKEN.findall("((sqrt (* x x)) (fabs x))"))
    assert rules.statement_of(left, right).text == "sqrt(x*x) = abs(x)"
    cubic = rules.statement_of(["cbrt", ["pow", "a", "3"]], "a")
    assert cubic.text == "(a**3)**(1/3) = a" and dict(cubic.symbols) == {"a": "positive"}


def test_bounds_of_symbols_become_ranges():
    (closed,) = inequalities.statements_of("&0 <= x /\\ x <= &1 / &2 ==> x pow 2 <= x")
    assert closed.text == "x**2 <= x" and closed.symbols == {"x": ["0", "1/2"]}
    (open_,) = inequalities.statements_of("x > &1 /\\ abs y <= &2 ==> x * y < &3 * x")
    assert open_.text == "(1 + x)*y < 3*(1 + x)" and open_.symbols == {"x": "positive", "y": ["-2", "2"]}
    assert inequalities.statements_of("x pow 2 - &2 * x + &1")[0].text == "0 <= x**2 - 2*x + 1"
    with pytest.raises(UnreadableError):
        inequalities.statements_of("x + y = &1 ==> x * y <= &1 / &4")


def test_the_table_counts_by_corpus():
    row = {"corpus": "rewrite rules", "status": "PROVED", "outcome": "decided", "seconds": 0.25}
    last = measure.make_table(
        [row, row | {"status": "OPEN", "outcome": "open"}], {"rewrite rules": (3, 2)}
    ).splitlines()[-1]
    assert last == "| rewrite rules | 3 | 2 | 2 | 1 | 0 | 0 | 0 | 1 | 0 | 0 | 0 | 50.0 | 0.25 | 0.2 |"


@pytest.mark.parametrize("corpus", LEAST)
def test_as_many_statements_are_read_as_before(corpus):
    found = [statement for _, statement in measure.CORPORA[corpus].read_entries(checkout(corpus)) if statement]
    assert len(found) >= LEAST[corpus]


@pytest.mark.slow
@pytest.mark.parametrize("corpus", LEAST)
def test_no_verdict_about_a_corpus_is_wrong(corpus):
    rows = list(measure.measure(corpus, checkout(corpus), 1 if corpus == "inequalities" else 10, 1e9))
    assert not [row for row in rows if row["outcome"] in ("wrong", "false confirmed")]
