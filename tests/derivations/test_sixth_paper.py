"""A paper to come, made in a workspace with the verbs: it keeps every rule, and spoiled it is refused by that rule."""

from __future__ import annotations

import re

import pytest

import navsym as nav
import navsym_papers
from navsym.claims import PROVED
from navsym.verification.decide import record_of
from navsym.verification.papers import load_papers
from tests.derivations.planted import plant, watch
from tests.derivations.rules import RULES, Judged

#: What the verbs do not write: a model, a claim that rests on it, a count, a run, and an open question.
MORE = '''
u, v = sp.symbols("u v", real=True)
SYSTEM = sp.Matrix([[-u]])


@claim("3.pole | The system with u constant has the polynomial v + u.")
def pole():
    return Equation(printed=v + u, derived=SYSTEM.charpoly().eval(v))


@claim("3.near | The slope is at most 1 for u in [0, 2].")
def near():
    return Bound(slope(), "<=", 1, {u: (0, 2)})


def slope() -> sp.Expr:
    """Of the model's parabola."""
    return sp.diff(u**2 - 3 * u, u)


@claim("3", expect=Status.PROVED)
def derivative():
    """The slope of the model is 2 u - 3."""
    return Equation(printed=2 * u - 3, derived=slope())


@claim("3.steep", expect=Status.PROVED)
def steep():
    """The slope is positive at every u that is tried."""
    found = all(slope().subs(u, k) > 0 for k in range(2, 6))
    return fact(True, found, "a count", Status.PROVED, scope="u = 2, 3, 4, 5", unsaid="four numbers are looked at")


@claim("3.figure", expect=Status.CERTIFIED)
def figure():
    """The slope at sqrt(3) is 0.46."""
    return Equation(sp.Rational("0.46"), slope().subs(u, sp.sqrt(3)), tolerance=sp.Rational("0.005"))


@claim("3.run", expect=Status.CONFIRMED)
def run():
    """The slope is positive in a run."""
    return fact(True, bool(slope().subs(u, 7) > 0), "a run", Status.CONFIRMED, scope="one run of 20 steps")


@claim("3.open", expect=Status.OPEN)
def unknown():
    """The slope is steep enough."""
    return fact(True, UNDECIDED, "reading", Status.OPEN, evidence="no figure says what is enough")


@claim("3.turning", expect=Status.REFUTED, reason="it is zero at 3/2, where the parabola turns")
def turning():
    """A remark: the slope is nowhere zero."""
    return Equation(printed=sp.Integer(1), derived=slope().subs(u, sp.Rational(3, 2)))


@claim("3.turning*", expect=Status.PROVED)
def turned():
    """The slope is zero at 3/2."""
    return Equation(printed=sp.Integer(0), derived=slope().subs(u, sp.Rational(3, 2)))
'''

#: Rule, what stands in the paper, and what is put there: one fault each.
FAULTS = (
    ("verdicts_other_than_declared", 'claim("3.open", expect=Status.OPEN)', 'claim("3.open", expect=Status.PROVED)'),
    (
        "verdicts_other_than_declared",
        'claim("3.run", expect=Status.CONFIRMED)',
        'claim("3.run", expect=Status.REFUTED)',
    ),
    ("verdicts_other_than_declared", "u**2 - 3 * u", "u**2 + 3 * u"),
    ("quantifiers_without_a_scope", 'scope="u = 2, 3, 4, 5"', 'scope="some numbers"'),
    ("slips_in_what_is_not_printed", "3.turning 3.run", "2 3.turning 3.run"),
    ("unknown_attributions", 'slip="paper"', 'slip="nobody"'),
    ("unknown_attributions", "3.turning 3.run", "3.run"),
    ("names_of_no_claim", "3.turning 3.run", "3.turning 3.run 3.nothing"),
    ("causes_that_are_no_slips", "causes={}", 'causes={"1": "2"}'),
    ("causes_that_are_no_slips", "causes={}", 'causes={"2": "9"}'),
    ("left_out_without_a_reason", 'left_out={"a figure": "no numbers"}', 'left_out={"a figure": ""}'),
    ("corrections_without_a_star", '"2*"', '"2.mended"'),
    ("corrections_without_a_star", "printed=a/4", "printed=a/3"),
    ("refutations_without_a_correction", "printed=a/4", "printed=a/5"),
    ("refutations_without_a_correction", 'reason="a quarter is meant"', 'reason=""'),
    ("equations_without_a_claim", 'equations=("1",', 'equations=("4", "1",'),
    ("runs_and_open_questions_without_evidence", 'scope="one run of 20 steps"', 'scope="one run"'),
    ("certificates_that_lack_without_a_reason", 'unsaid="four numbers are looked at"', 'unsaid=""'),
    ("sides_of_one_expression", "printed=2 * u - 3", "printed=slope()"),
    ("tolerances_wider_than_half_a_unit", 'Rational("0.005")', 'Rational("0.05")'),
    ("sides_that_nothing_computes", "derived=slope())", "derived=u + u - 3)"),
    ("sides_that_nothing_computes", 'typed="1 2"', 'typed="1 2 3.figure"'),
    ("figures_that_choose_alone", "The slope at sqrt(3) is 0.46.", "A run has the slope 0.46."),
    ("ends_of_ranges_in_no_title", " for u in [0, 2].", "."),
    ("moving_quantities_held_in_silence", "with u constant has", "has"),
    ("numbers_of_no_statement", "The slope at sqrt(3) is 0.46.", "The slope at sqrt(3) is 0.58."),
    ("numbers_under_a_general_title", "The slope is zero at 3/2.", "The slope is zero somewhere."),
    ("ranges_narrower_than_the_title", "for every w and t.", "for every v."),
    ("sizes_in_no_scope", 'scope="u = 2, 3, 4, 5"', 'scope="u = 2, 3, 4"'),
    ("words_that_nothing_shows", "The slope of the model is 2 u - 3.", "The slope of the model is at most 2 u - 3."),
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A workspace with the sixth paper, in which the verbs stand."""
    root = nav.init(tmp_path / "work").root
    nav.new_paper("sixth", title="A sixth paper", authors=["A. B"], year=1979, equations="1-3", folder=root / "papers")
    pairs = (
        ("1", "sin(w*t)**2", "(1 - cos(2*w*t))/2", {"title": "A square of a sine for every w and t."}),
        (
            "2",
            "a/3",
            "(a*sin(w)**2 + a*cos(w)**2)/4",
            {"reason": "a quarter is meant", "slip": "paper", "title": "A third of a."},
        ),
        ("2*", "a/4", "(a*sin(w)**2 + a*cos(w)**2)/4", {"corrects": "2", "title": "A quarter of a."}),
    )
    for number, printed, derived, more in pairs:
        nav.new_claim("sixth", number, printed=printed, derived=derived, folder=root / "papers", **more)
    path = root / "papers" / "sixth.py"
    text = path.read_text(encoding="utf-8").replace("import Equation,", "import UNDECIDED, Bound, Equation,")
    text = text.replace("Status, claim", "Status, claim, fact")
    remarks = "3.pole 3.near 3.turning 3.run 3.steep 3.figure 3.open"
    card = f'    remarks="{remarks}",\n    causes={{}},\n    moving="u",\n    typed="1 2",\n'
    card += '    left_out={"a figure": "no numbers"},\n)\n'
    path.write_text(re.sub(r"^\)\n", lambda _: card, text, count=1, flags=re.MULTILINE) + MORE, encoding="utf-8")
    monkeypatch.chdir(root)
    monkeypatch.setattr(navsym_papers, "__path__", [*navsym_papers.__path__, str(root / "papers")])
    return path


def judged() -> Judged:
    """The paper of the workspace with its verdicts."""
    (module,) = load_papers(["sixth"])
    return Judged(module.paper, module.claims, tuple(record_of(module.paper, claim)[0] for claim in module.claims))


def test_the_sixth_paper_keeps_every_rule(folder):
    found = judged()
    assert {rule.__name__: rule(found) for rule in RULES} == {rule.__name__: [] for rule in RULES}


def test_each_rule_refuses_a_paper_that_breaks_it(folder):
    text = folder.read_text(encoding="utf-8")
    for name, old, new in FAULTS:
        assert old in text, (name, old)
        folder.write_text(text.replace(old, new), encoding="utf-8")
        found = judged()
        assert {rule.__name__: rule(found) for rule in RULES}[name], (name, new)
    assert {name for name, _, _ in FAULTS} == {rule.__name__ for rule in RULES}


def test_a_cancelled_divisor_stays_among_the_assumptions(folder):
    nav.new_claim("sixth", "1.divisor", printed="(a**2 - 1)/(a - 1)", derived="a + 1", folder=folder.parent)
    (record,) = [record for record in judged().records if record.number == "1.divisor"]
    assert record.status == PROVED and any("a" in words and "!= 0" in words for words in record.assumptions)


def felled(paper: str) -> set[str]:
    """The claims that some fault of the paper's own source fells."""
    seen = watch(paper)
    return {outcome.fell for outcome in (plant(paper, place, seen) for place in sorted(seen.names))}


def test_a_side_that_is_built_from_the_other_is_felled_by_no_fault(folder):
    assert "3" in felled("sixth")
    folder.write_text(
        folder.read_text(encoding="utf-8").replace("printed=2 * u - 3", "printed=slope()"), encoding="utf-8"
    )
    assert "3" not in felled("sixth")
