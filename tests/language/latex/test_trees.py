"""Random formulas printed in several styles are read back with the same value, computed by numpy."""

from __future__ import annotations

import random
import re

import numpy as np
import pytest

import navsym as nav
from navsym.claims.formula import Formula
from tests.language.latex.printed_trees import FUNCTIONS, SYMBOLS, VALUES, Printer


def evaluate(text):
    """The value of a text of our own, by Python's arithmetic on arrays."""
    return eval(text, {"__builtins__": {}}, {**VALUES, **FUNCTIONS})


def read_back(seeds):
    """The seeds of formulas that are refused, with the reasons; the others have their value."""
    refused = {}
    for seed in seeds:
        source = random.Random(seed)
        kind = source.choice(["scalar", "scalar", "vector", "matrix"])
        part = Printer(source).draw(kind, source.choice([1, 2, 3, 4]))
        (formula,) = nav.read(f"{part.latex} = {part.latex}", symbols=SYMBOLS).formulas
        if formula.status != "READ":
            refused[seed] = f"{part.latex}: {formula.why}"
            continue
        value = np.asarray(evaluate(formula.left), dtype=float)
        assert value.shape == np.shape(part.value), (part.latex, formula.left)
        np.testing.assert_allclose(value, part.value, rtol=1e-9, atol=1e-9, err_msg=part.latex)
    return refused


def test_random_formulas_keep_their_value():
    assert read_back(range(400)) == {}


@pytest.mark.long
def test_two_thousand_random_formulas_keep_their_value():
    assert read_back(range(1_000, 3_000)) == {}


V, M, N = {"vector": 3}, {"matrix": [2, 2]}, {"matrix": ["n", "n"]}
CONSTRUCTS = {
    "cross(u, v) - skew(u) @ v = zeros(3, 1)": {"u": V, "v": V},
    "det(inv(A)) = 1/det(A)": {"A": M},
    "inv(P @ R).T = inv(R @ P).T": {"P": N, "R": N},
    "rot(qmul(p, q)) = rot(p) @ rot(q)": {"p": {"quaternion": "any"}, "q": {"quaternion": "any"}},
    "conj(conj(q)) = q + q[2]*q": {"q": {"quaternion": "any"}},
    "trace(A) = A[1,1] + A[2,2]": {"A": M},
    "norm(u + v) <= norm(u) + norm(v)": {"u": V, "v": V},
    "diag(a, b) = eye(2)": {"a": "real", "b": "real"},
    "diff(x**3, x, 2) = 6*x": {"x": "real"},
    "integral(exp(-s/c), s, 0, b) = c*(1 - exp(-b/c))": {"c": "positive", "b": "real"},
    "sum(k**2, k, 1, n) = n*(n + 1)*(2*n + 1)/6": {"n": {"integer": ["1", "oo"]}},
    "product(k/(k + 1), k, 1, n) = 1/(n + 1)": {"n": {"integer": ["1", "oo"]}},
    "limit(sin(x)/x, x, oo) = 0": {},
    "where(x > 0, log(x), -x) = max(x, 0) + min(x, 0)": {"x": "real"},
    "sign(x)*abs(x) = floor(x) + erf(x)": {"x": "real"},
    "expm(x*A) = expm(A)": {"x": "real", "A": M},
    "cov(w, x) = E(w*x) - E(w)*E(x)": {"w": {"random": {"cov": "1"}}, "x": {"random": {"cov": "1"}}},
    "atan2(sin(a), cos(a)) = asin(a)": {"a": "real"},
    "y - x**2/2 + z = z*(y - 3*x)": {"x": "real", "y": "real", "z": "real"},
}


@pytest.mark.parametrize("text", CONSTRUCTS)
def test_the_latex_that_a_construct_shows_is_read_as_the_construct(text):
    left, relation, right = re.fullmatch("(.*) (=|<=) (.*)", text).groups()
    shown = Formula(left, relation, right, CONSTRUCTS[text])._repr_latex_()
    (formula,) = nav.read(shown, symbols=CONSTRUCTS[text]).formulas
    assert (formula.left, formula.relation, formula.right) == (left, relation, right), (shown, formula.why)


@pytest.mark.parametrize("text", [*CONSTRUCTS][::2])
def test_the_python_that_a_construct_shows_states_the_construct(text):
    formula = nav.prove(text, seconds=5, **CONSTRUCTS[text]).formula
    again = eval(formula.python(), {"nav": nav})
    assert again.formula.document() == formula.document()


def test_hypotheses_orders_rates_and_words_of_python_are_in_the_python_of_a_formula():
    given = {"given": ["dot(u, u) = 1"], "rates": {"u": "cross(w, u)"}, "u": V, "w": V, "lambda": "positive"}
    moving = nav.prove("dot_(lambda*dot(u, u)) = 0", **given).formula.python()
    assert (
        moving.endswith("given=['dot(u, u) = 1'], rates={'u': 'cross(w, u)'})") and "**{'lambda': 'positive'}" in moving
    )
    assert eval(moving, {"nav": nav}).holds
    assert nav.prove("sin(x) = x", order={"x": 3}).formula.python() == "nav.prove('sin(x) = x', order={'x': 3})"
