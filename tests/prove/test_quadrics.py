"""Quadratic inequalities on spheres, rotations and balls: the best bound is proved, a smaller one is not."""

import random
from fractions import Fraction

import pytest
from flint import fmpq

import navsym as nav
from navsym.prove.rooms.quadrics import split_squares
from tests.sampling import thinned

V = {"vector": 3}
UNIT = ["dot(u, u) = 1", "dot(v, v) = 1"]
C = {"rotation": "b to n"}
BOUNDS = [
    ("dot(u, v)", "1", {"u": V, "v": V, "given": UNIT}),
    ("dot(u, v)**2", "1", {"u": V, "v": V, "given": UNIT}),
    ("dot(p, q)", "1", {"p": {"quaternion": "unit"}, "q": {"quaternion": "unit"}}),
    ("q[1]*q[2]", "1/2", {"q": {"quaternion": "unit"}}),
    ("abs(q[2])", "1", {"q": {"quaternion": "unit"}}),
    ("trace(C)", "3", {"C": C}),
    ("-trace(C)", "1", {"C": C}),
    ("C[1,1] + C[2,2] - C[3,3]", "1", {"C": C}),
    ("C[1,2]", "1", {"C": C}),
    ("norm(u + v)", "2", {"u": V, "v": V, "given": ["dot(u, u) <= 1", "dot(v, v) <= 1"]}),
    ("x*y", "1/2", {"given": ["x**2 + y**2 = 1"]}),
    ("x + y", "sqrt(2)", {"given": ["x**2 + y**2 = 1"]}),
]


@pytest.mark.parametrize(("left", "bound", "given"), thinned(BOUNDS), ids=[row[0] for row in BOUNDS])
def test_the_best_bound_is_proved_and_a_smaller_one_is_not(left, bound, given):
    best = nav.prove(f"{left} <= {bound}", **given)
    assert best.status == "PROVED", best.evidence
    assert best.check().accepted
    assert not nav.prove(f"{left} <= {bound} - 1/10", **given, seconds=5).holds


@pytest.mark.parametrize("seed", range(20))
def test_squares_are_those_of_the_matrix_and_none_of_an_indefinite_one(seed):
    generator = random.Random(seed)
    n = generator.randint(1, 5)
    rows = [[generator.randint(-3, 3) for _ in range(n)] for _ in range(generator.randint(1, n))]
    matrix = [[fmpq(sum(r[i] * r[j] for r in rows)) for j in range(n)] for i in range(n)]
    squares = split_squares(matrix)
    assert squares is not None and all(d > 0 for d, _ in squares)
    again = [[sum(d * r[i] * r[j] for d, r in squares) for j in range(n)] for i in range(n)]
    assert again == matrix
    matrix[-1][-1] -= fmpq(Fraction(1, 7).numerator, 7) + sum(r[-1] ** 2 for r in rows)
    assert split_squares(matrix) is None


def test_a_square_holds_beside_hypotheses_on_roots_that_it_does_not_need():
    given = ["v = u + 2*a", "u = sqrt(a**2 + 1)"]
    assert nav.prove("v**2 + b**2 >= 2*v*b", given=given).status == nav.PROVED
    false = nav.prove("v**2 + b**2 >= 2*v*b + 1/100", given=given)
    assert false.status == nav.REFUTED and false.counterexample["u"] == "sqrt(185)/4" and false.check()
