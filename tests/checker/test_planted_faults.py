"""Faults planted into the source of the checker one by one: a verdict of the tables of proofs and texts shows each.

A fault counts as found when some hostile certificate is accepted or some true one is refused; the words of a refusal
do not count. ``tests/checker/mutants.py`` changes every token.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from navsym import checker
from tests.checker import proofs
from tests.checker.forgeries import identity, verdict
from tests.checker.mutants import SOURCE, module_of
from tests.checker.texts import EQUAL, OUTSIDE, UNEQUAL
from tests.sampling import thinned

TEXT = SOURCE.read_text(encoding="utf-8")
# The rule whose rows are looked at first, what stands in the source exactly once, what is put in its place.
FAULTS = [
    # the parser
    ("", 'require(parser.words == [""], "not an expression: more than one")', "pass"),
    ("", 'require(sum(map(len, self.words)) == len(text) - spaces, "unexpected characters")', "pass"),
    ("", 'self.read_product() if sign == "+" else self', 'self.read_product() if sign == "-" else self'),
    (
        "",
        'value = self.read_signed()\n            if mark == "@":',
        'value = self.read_product()\n            if mark == "@":',
    ),
    ("", "self.power(base, self.read_signed()) if", "self.power(base, self.read_entry()) if"),
    # balls
    ("balls", "if ball < low or", "if ball.lower() < low or"),
    ("balls", "arb.atan2(b, a)", "arb.atan2(a, b)"),
    ("balls", "EVERY = arb(0, 1)", "EVERY = arb(0, 0.5)"),
    ("balls", "for half in (middle - radius, middle + radius)", "for half in (middle + radius,)"),
    ("", "if field in (clip, strict) and q == 0", "if field is clip and q == 0"),
    ("corners", 'value > 0 if relation == ">" else value >= 0', 'value >= 0 if relation == ">" else value >= 0'),
    ("balls", "any(evaluate(t, wide, clip).enclose() < 0", "any(evaluate(t, wide, clip).enclose() <= 0"),
    # the exact algebra
    ("identity", "if len(self.terms) == 1 and q.q == 1:", "if len(self.terms) == 1:"),
    ("identity", "return all(part.is_zero() for part", "return any(part.is_zero() for part"),
    ("identity", '"acos", "atan", "atan2")\n', '"acos", "atan")\n'),
    ("", "return Exact(content) ** c", "return Exact(content) ** abs(c)"),
    ("", "(x * other, y * other)", "(y * other, x * other)"),
    ("", "cyclotomic(2 * n)", "cyclotomic(n)"),
    ("equal", "return x[0] * left + y[0] * right, x[1] * left", "return x[0] * right + y[0] * left, x[1] * left"),
    # what has to exist
    ("equal", 'elif q.q > 1:\n                found[">=", base]', 'elif q.q > 9:\n                found[">=", base]'),
    ("equal", 'case ("sqrt", x):\n            found', 'case ("sqrt", x) if level == 2:\n            found'),
    ("slope", "            if level != DEFINED:\n", "            if level > DIFFERENTIABLE:\n"),
    ("derivative", "            if level != DEFINED:\n", "            if level > DIFFERENTIABLE:\n"),
    ("multiply", 'if relation == ">" else (relation,)', 'if relation == ">" else (relation, ">")'),
    ("", 'require(q is None or constant_of(narrow) == q, "another exponent")', "pass"),
    ("concave", '"cos": "-sin(x)"', '"cos": "sin(x)"'),
    # rules that change the goal
    ("equal", 'term)\n    require(is_identity(subtract(goal.term, term)), "the terms differ")', "term)"),
    ("multiply", 'factor)._replace(relation=">")', 'factor)._replace(relation=">=")'),
    ("exponential", '("exp", goal.term), ONE', '("exp", goal.term), ZERO'),
    ("side", 'signed)._replace(relation=">")', 'signed)._replace(relation=">=")'),
    (
        "cases",
        '{"high": ZERO, "open_high": False} if upper else {"low": ZERO, "open_low": False}',
        '{"high": ZERO} if upper else {"low": ZERO}',
    ),
    ("cases", "(value_of(end, {}) > 0 if upper", "(value_of(end, {}) < 0 if upper"),
    (
        "split",
        '{"high": middle, "open_high": False}, {"low": middle, "open_low": False}',
        '{"high": middle}, {"low": middle}',
    ),
    ("integers", "start + len(values), -1", "start + len(values) + 1, -1"),
    ("abstract", 'relation=">" if is_open else ">="', 'relation=">="'),
    ("abstract", "limit.nonzero or limit.integer for limit", "limit.integer for limit"),
    ("dense", 'require(holds("!=", value_of(seldom, here)), "the function may vanish throughout")', "pass"),
    # rules of equations
    ("identity", 'require(goal.relation in ("=", ">=") and is_identity', "require(is_identity"),
    ("zero", '"rule proof")\n    require(goal.relation == ">=", "expected >=")', '"rule proof")'),
    ("solve", '("=", across), (">", along)', '("=", across)'),
    ("solve", '(">=", v), (">=", subtract(("pi",), v))', '(">=", subtract(("pi",), v))'),
    ("squares", '(s == 1 or goal.relation == "=")', "True"),
    ("derivative", 'require(not any(r.nonzero or r.integer for r in goal.box.values()), "a box with holes")', "pass"),
    # rules of signs
    ("given", 'goal.relation == ">=" and all(w >= 0 for w in shares)', 'goal.relation == ">="'),
    ("range", 'require(goal.relation == ">=" or is_open or open_by_zero, "the end belongs to the range")', "pass"),
    ("angle", "number(-c if k % 2 else c)", "number(c)"),
    ("bounded", 'negate(("*", ("abs", share), half))', 'negate(("*", share, half))'),
    ("corners", "require(degree_in(polynomial, name) <= 1", "require(degree_in(polynomial, name) <= 2"),
    ("product", 'or factor[0] in ("exp", "cosh") or goal.relation == ">="', 'or natural or goal.relation == ">="'),
    ("product", "signs *= 1 if natural else s", "signs *= 1"),
    ("sum", 'relation=">" if i == k else ">="', 'relation=">="'),
    ("slope", "require(not by_slope or is_open", "require(True"),
    (
        "slope",
        "name, nonzero=False, integer=False, **own_end)\n"
        "    whole = whole._replace(term=ZERO, exists=(), given=(), zeros=())",
        "name, **own_end)",
    ),
    # the whole language
    (
        "modulo",
        'require(is_identity(subtract(goal.term, total)), "the terms differ")\n'
        "    prove(premise, remember(goal, term))",
        "prove(premise, remember(goal, term))",
    ),
    ("between", "for side in (goal.term, negate(goal.term))]", "for side in (goal.term, goal.term)]"),
    ("modulo", "all(is_identity(substitute(t, place)) for t in case.zeros)", "True"),
    ("", "(c, d, a, f)", "(a, f, c, d)"),
    ("", "two(x1, y1, -1, w, z1)", "two(x1, y1, 1, w, z1)"),
    ("", "self.reader.need(*list_entries(value))", "pass"),
    ("", "conditions(term, DIFFERENTIABLE)]", "conditions(term)]"),
    ("", '{">": ">=", ">=": ">", "=": "!="}', '{">": ">", ">=": ">", "=": "!="}'),
    ("", "negate(minor(rows, i, j)) if (i + j) % 2 else minor", "negate(minor(rows, j, i)) if (i + j) % 2 else minor"),
    ("concave", 'negate(second), relation=">="', 'second, relation=">="'),
    ("cones", 'require(all(c >= 0 for c in polynomial.to_dict().values()), "a negative coefficient")', "pass"),
    ("cones", "for chosen in product(*alive)", "for chosen in product(*alive[:1])"),
    ("quadratic", 'subtract(("*", number(4), a, c), ("*", b, b))', '("*", number(4), a, c)'),
    ("roots", "if power % 2 else odd", "if power % 3 else odd"),
    ("roots", "require((value_of(own, {}) - arb(end)) * sign > 0", "require((value_of(own, {}) - arb(end)) * sign < 0"),
    (
        "roots",
        "signs = [value > 0 for value in map(at, chain[:-1])",
        "signs = [value > 0 for value in map(at, chain[:1])",
    ),
    # statements and points
    ("", "value_of(gap, {}) > 0 or (not is_open and is_identity(gap))", "True"),
    ("", '">": lambda ball: ball <= 0', '">": lambda ball: ball <= 1'),
    ("", 'require(goal.relation in (">", "!="), "the statement allows 0")', "pass"),
]


def wrong_verdicts(module: Any, first: str = "") -> Iterator[str]:
    yield from (f"refused: {pair}" for pair in EQUAL if verdict(identity(*pair), module) != "")
    yield from (f"accepted: {pair}" for pair in UNEQUAL if verdict(identity(*pair), module) == "")
    yield from (f"accepted: {text}" for text in OUTSIDE if verdict(identity(text, text), module) == "")
    yield from proofs.discrepancies(module, reasons=False, first=first)


@pytest.mark.parametrize(("first", "old", "new"), thinned(FAULTS), ids=lambda x: str(x)[:40])
def test_a_planted_fault_changes_a_verdict(first, old, new):
    assert TEXT.count(old) == 1
    assert next(wrong_verdicts(module_of(TEXT.replace(old, new)), first), None) is not None


def test_the_checker_itself_has_every_verdict_right():
    assert list(wrong_verdicts(checker)) == []


def test_every_rule_family_has_a_planted_fault():
    assert len(FAULTS) >= 20
    assert len({first for first, *_ in FAULTS} & set(checker.RULES)) >= 20
