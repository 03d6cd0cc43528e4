"""Long entries of covariance code: proved by the parts that both sides share, and never when they are wrong."""

import json
import random
import re
import resource
import time
from importlib import import_module

import pytest

import navsym as nav
from navsym import checker
from navsym.audit.decide import Scope, decide_entry, shorten_pairs
from navsym.language.expression import read_tree
from navsym.language.tree import build_symbol, replace

SPEC = """[[code]]
name = "c"
file = "c.c"
function = "predict"
[code.symbols]
P = {{ matrix = [{n}, {n}], symmetric = true }}
[[question]]
kind = "covariance"
P = "c:P"
F = "c:F"
Q = "c:Q"
is = "c:Pn"
"""


def write_covariance(n, density):
    """P' = F P F' + Q as generated code has it: entries of F and of F P are named, the lower half is copied."""
    draw = random.Random(n)
    size = f"[{n}][{n}]"
    lines = [f"void predict(const float q[4], const float w[3], float dt, const float P{size}, float F{size},"]
    lines += [f"             float Q{size}, float Pn{size}) {{"]
    F = {(i, i): "1" for i in range(n)}
    for i in range(n):
        for j in draw.sample([k for k in range(n) if k != i], density):
            a, b = draw.sample(range(4), 2)
            lines.append(f"  const float f_{i}_{j} = dt*(q[{a}]*w[{b % 3}] - q[{b}]*w[{a % 3}] + {i + 1}*w[{j % 3}]);")
            F[i, j] = f"f_{i}_{j}"
    for i in range(n):
        for j in range(n):
            lines.append(f"  F[{i}][{j}] = {F.get((i, j), '0')};")
            lines.append(f"  Q[{i}][{j}] = {f'{i + 1}*dt' if i == j else '0'};")
    for i in range(n):
        for j in range(n):
            row = " + ".join(f"P[{k}][{j}]" if k == i else f"{F[i, k]}*P[{k}][{j}]" for k in range(n) if (i, k) in F)
            lines.append(f"  const float u_{i}_{j} = {row};")
    for i in range(n):
        for j in range(i, n):
            terms = [f"u_{i}_{k}" if k == j else f"u_{i}_{k}*{F[j, k]}" for k in range(n) if (j, k) in F]
            terms += [f"{i + 1}*dt"] * (i == j)
            lines.append(f"  Pn[{i}][{j}] = {' + '.join(terms)};")
            lines += [f"  Pn[{j}][{i}] = Pn[{i}][{j}];"] * (i != j)
    return "\n".join([*lines, "}", ""])


def ask(folder, n, code):
    """The answer to the question of covariance, and its processor time."""
    (folder / "c.c").write_text(code)
    (folder / "spec.toml").write_text(SPEC.format(n=n))
    start = time.process_time()
    answer = nav.audit(folder / "spec.toml")
    return answer, time.process_time() - start


def test_a_dense_covariance_of_six_states_is_proved_by_shared_parts_and_its_certificates_pass(tmp_path):
    answer, _ = ask(tmp_path, 6, write_covariance(6, 5))
    (question,) = answer.questions
    assert len(question.entries) == 36 and question.status == nav.PROVED
    shared = [c for c in answer.certificates() if c["statement"].get("given")]
    assert shared
    for certificate in shared:
        assert checker.check(json.loads(json.dumps(certificate))) == "proof"


def test_a_wrong_factor_in_a_dense_covariance_is_refuted_where_it_stands(tmp_path, monkeypatch):
    monkeypatch.setattr(
        import_module("navsym.audit.answer"), "suggest", lambda *_: None
    )  # the search for a mend is another test's
    code = write_covariance(6, 5)
    wrong, count = re.subn(r"(Pn\[2\]\[4\] = .*?u_2_0\*)(f_4_0)", r"\1f_4_1", code)
    assert count == 1
    answer, _ = ask(tmp_path, 6, wrong)
    bad = [entry for entry in answer.questions[0].entries if entry.status == nav.REFUTED]
    assert {entry.entry for entry in bad} == {(3, 5), (5, 3)}
    line = 1 + wrong.splitlines().index(next(text for text in wrong.splitlines() if "Pn[2][4] =" in text))
    assert {entry.line for entry in bad} <= {line, line + 1}  # where it is computed, and where it is copied


NAMES = {"a", "b", "c", "shared1", "x"}
PAIRS = [
    ("(a + b)*c + x", "x + c*(a + b)", True),
    ("(a + b)*c - x", "x + c*(a + b)", False),
    ("((a + b)*c + a)*x + (a + b)", "x*((a + b)*c + a) + a + b", True),
    ("(a + b)*(a + b)*x + shared1", "shared1 + x*(a + b)**2", True),
    ("(a + b)*shared1 + x", "x + (a + b)*(a + b)", False),
    ("1/(a + b) + x", "x + 1/(a + b) + 0*a", True),
]


@pytest.mark.parametrize(("left", "right", "is_equal"), PAIRS)
def test_shared_parts_decide_as_the_whole_text_does(monkeypatch, left, right, is_equal):
    sides = [read_tree(text, NAMES) for text in (left, right)]
    scope = Scope({name: [None, None, []] for name in NAMES})
    whole = decide_entry(*sides, scope)
    monkeypatch.setattr(import_module("navsym.audit.decide"), "LONG", 0)
    assert decide_entry(*sides, scope).status == whole.status == (nav.PROVED if is_equal else nav.REFUTED)


def test_the_meanings_put_back_give_the_sides_again():
    left, right = (read_tree(text, NAMES) for text in (PAIRS[2][0], "x*((a + b)*c + a) + (a + b)"))
    ((_, short),) = shorten_pairs([(left, right)])
    ((one, two),) = short.pairs
    assert short.meanings and (one, two) != (left, right)
    for name, tree in reversed(short.meanings.items()):
        one, two = (replace(side, {build_symbol(name): tree}) for side in (one, two))
    assert (one, two) == (left, right)


@pytest.mark.long
def test_twice_the_states_cost_no_more_than_twelve_times_the_time(tmp_path):
    """Four times the entries; multiplied out, each would have four times the terms and the ratio were past sixteen."""
    small, first = ask(tmp_path, 12, write_covariance(12, 4))
    large, second = ask(tmp_path, 24, write_covariance(24, 4))
    assert small.holds and large.holds
    assert second < 12 * first


@pytest.mark.long
def test_sixty_generated_functions_take_less_than_a_minute_and_a_gigabyte(tmp_path):
    seconds = 0.0
    for k in range(60):
        n = 4 + k % 6
        answer, spent = ask(tmp_path, n, write_covariance(n, 1 + k % (n - 1)))
        assert answer.holds
        seconds += spent
    assert seconds < 60 and resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 2**20
