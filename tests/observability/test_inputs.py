"""Unknown inputs: what is shown whatever they are, against ranks of jets that know nothing of the algorithm."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest
import sympy as sp
from flint import fmpq, fmpq_mat

import navsym as nav
from navsym import checker
from navsym.core.errors import NavsymError


def exact_rank(rows: list[list[sp.Expr]]) -> int:
    """Rank of a matrix of rationals."""
    if not rows or not rows[0]:
        return 0
    flat = [sp.Rational(x) for row in rows for x in row]
    return fmpq_mat(len(rows), len(rows[0]), [fmpq(int(x.p), int(x.q)) for x in flat]).rank()


def rank_of_jets(states, dynamics, outputs, inputs, seed: int) -> int:
    """rank [dz/dx dz/du] - rank dz/du of z, z', ..., z^(n) by x, u, u', ..., at a random rational point.

    Total derivatives by the chain rule; the columns of the inputs are unknown, so that what is known of x is what they
    do not reach.
    """
    n = len(states)
    x, time = sp.symbols(states), sp.Symbol("t")
    jets = [[sp.Symbol(f"{u}_{k}") for k in range(n + 2)] for u in inputs]
    first = {sp.Symbol(u): jet[0] for u, jet in zip(inputs, jets, strict=True)}
    f = [sp.sympify(entry).subs(first) for entry in dynamics]
    moves = dict(zip(x, f, strict=True)) | {a: b for jet in jets for a, b in pairwise(jet)} | {time: 1}
    z = [sp.sympify(entry).subs(first) for entry in outputs]
    listed = list(z)
    for _ in range(n):
        z = [sum(sp.diff(entry, s) * rate for s, rate in moves.items()) for entry in z]
        listed += z
    source = random.Random(seed)
    symbols = [time, *x, *(s for jet in jets for s in jet)]
    at = {s: sp.Rational(source.randrange(1000, 9000), source.randrange(11, 99)) for s in symbols}
    columns = [*x, *(s for jet in jets for s in jet[: n + 1])]
    half = sp.Rational(source.randrange(1, 9), 11)  # sine and cosine of an angle by the tangent of its half
    turn = {sp.sin(sp.Symbol("h")): 2 * half / (1 + half**2), sp.cos(sp.Symbol("h")): (1 - half**2) / (1 + half**2)}
    J = [[sp.diff(entry, s).subs(turn).subs(at) for s in columns] for entry in listed]
    return exact_rank(J) - exact_rank([row[n:] for row in J])


def random_model(seed: int, moving: bool):
    """States, F, H, G with few small entries; with the time in some of them where they move."""
    source = random.Random(seed)
    n, p, q = source.randrange(2, 5), source.randrange(1, 3), source.randrange(1, 3)
    entry = lambda: source.choice(["0", "0", "0", "1", "-1", "2", *(["t", "t**2 - 1"] if moving else [])])  # noqa: E731
    F, H, G = ([[entry() for _ in range(w)] for _ in range(m)] for m, w in ((n, n), (p, n), (n, q)))
    for row in H:
        row[source.randrange(n)] = "1"
    return [f"x{k}" for k in range(n)], F, H, G


@pytest.mark.parametrize("seed", range(48))
def test_ranks_of_random_models_are_those_of_their_jets(seed: int) -> None:
    states, F, H, G = random_model(seed, moving=seed % 3 == 2)
    columns = {f"u{k}": [row[k] for row in G] for k in range(len(G[0]))}
    answer = nav.observe(nav.Model(states, F, H, inputs=columns))
    sums = [
        " + ".join([f"({a})*{s}" for a, s in zip(row, states, strict=True)])
        + "".join(f" + ({g})*u{k}" for k, g in enumerate(enters))
        for row, enters in zip(F, G, strict=True)
    ]
    outputs = [" + ".join(f"({a})*{s}" for a, s in zip(row, states, strict=True)) for row in H]
    assert answer.joint.proved and answer.document()["checked"]
    assert answer.rank == rank_of_jets(states, sums, outputs, list(columns), seed)


#: states, dynamics, measurements, inputs, rank; the first three after Martinelli, Observability, SIAM 2020
NONLINEAR = [
    ("x y h", ["s*cos(h)", "s*sin(h)", "w"], ["x", "y"], "s w", 3),
    ("x y h", ["s*cos(h)", "s*sin(h)", "2"], ["x**2 + y**2"], "s", 1),
    ("x y h", ["2*cos(h)", "2*sin(h)", "w"], ["x**2 + y**2"], "w", 2),
    ("x v b", ["v", "a", "0"], ["x", "a + b"], "a", 3),
    ("x v b k", ["v", "a", "0", "0"], ["x", "k*a + b"], "a", 4),
    ("x v b", ["v", "a + b", "0"], ["x"], "a", 2),
    ("p r k", ["r*p", "u", "0"], ["k*p"], "u", 2),
    ("x y", ["x*u", "y*u + x"], ["y"], "u", 1),
    ("x y", ["x*u", "-y*u"], ["x", "y"], "u", 2),
]


@pytest.mark.parametrize(("states", "dynamics", "outputs", "inputs", "rank"), NONLINEAR)
def test_nonlinear_models_with_unknown_inputs(states, dynamics, outputs, inputs, rank) -> None:
    model = nav.Model(states, dynamics=dynamics, H=outputs, inputs=dict.fromkeys(inputs.split(), "unknown"))
    answer = nav.observe(model)
    assert (answer.rank, answer.joint.proved, answer.document()["checked"]) == (rank, True, True)
    assert rank == rank_of_jets(states.split(), dynamics, outputs, inputs.split(), 5)


def test_an_input_that_is_known_shows_more_than_an_unknown_one() -> None:
    F, H = [["0", "1", "0"], ["0", "0", "1"], ["0", "0", "0"]], ["x"]
    known, unknown = nav.Model("x v b", F, H), nav.Model("x v b", F, H, inputs={"w": ["0", "1", "0"]})
    assert nav.observe(known).rank == 3
    answer = nav.observe(unknown)
    assert (answer.unobservable, answer.document()["inputs"]) == (("b",), ["w"])


@pytest.mark.parametrize("seed", range(0, 48, 3))
def test_a_granted_rank_is_one_of_the_model_with_inputs_in_a_loop_and_of_its_jets(seed: int) -> None:
    """Not more: the closed loop is F + G K for one K. Not less: derivatives by the chain rule, written anew."""
    states, F, H, G = random_model(seed, moving=False)
    q = len(G[0])
    answer = nav.observe(nav.Model(states, F, H, inputs={f"u{k}": [row[k] for row in G] for k in range(q)}))
    above, both, inputs = answer.certificates()[0]["of"]
    numbers = lambda rows: [[int(x) for x in row] for row in rows]  # noqa: E731
    A, B, C = map(sp.Matrix, (numbers(F), numbers(G), numbers(H)))
    looped = sp.Matrix([[sp.Rational(x) for x in row] for row in above["statement"]["F"]])
    assert B.row_join(looped - A).rank() == B.rank()
    O, T = rows_of_jets(A, B, C, len(both["statement"]["H"]) // C.rows)
    assert both["statement"]["H"] == [[str(x) for x in row] for row in O.row_join(T).tolist()]
    assert inputs["statement"]["H"] == [[str(x) for x in row] for row in T.tolist()]
    ranks = [part["statement"]["rank"] for part in (above, both, inputs)]
    assert ranks[0] == ranks[1] - ranks[2] == answer.rank


def rows_of_jets(A, B, C, count: int):
    """z = C x, z' = C A x + C B u, z'' = C A A x + C A B u + C B u', …, so many of them."""
    O = sp.Matrix.vstack(*(C * A**k for k in range(count)))
    blocks = [[C * A ** (k - 1 - j) * B if j < k else 0 * C * B for j in range(count)] for k in range(count)]
    return O, sp.Matrix(sp.BlockMatrix(blocks).as_explicit())


def test_a_granted_rank_beside_inputs_falls_with_each_of_its_parts() -> None:
    declared = {"dynamics": ["v", "a", "0", "0"], "inputs": {"a": "unknown"}}
    (item,) = nav.observe(nav.Model("x v b k", H=["x", "k*a + b"], **declared)).certificates()
    assert checker.check(item) == "all"
    for place, part in enumerate(item["of"]):
        for rank in {*range(6)} - {part["statement"]["rank"]}:
            forged = {**part, "statement": {**part["statement"], "rank": rank}}
            with pytest.raises(checker.Refused):
                checker.check({"kind": "all", "of": [*item["of"][:place], forged, *item["of"][place + 1 :]]})


def test_the_derivatives_of_an_input_have_names_of_their_own() -> None:
    taken = nav.Model("p a_1 b", dynamics=["a_1", "a*p", "0"], H=["p", "a + b"], inputs={"a": "unknown"})
    free = nav.Model("p v b", dynamics=["v", "a*p", "0"], H=["p", "a + b"], inputs={"a": "unknown"})
    first, second = nav.observe(taken), nav.observe(free)
    assert (first.rank, first.document()["checked"]) == (second.rank, second.document()["checked"]) == (3, True)


def test_steps_with_an_unknown_input() -> None:
    Phi = [["1", "1"], ["0", "1"]]
    ranks = [nav.observe(nav.Model("p v", Phi=Phi, H=["p"], inputs={"u": u})).rank for u in (["1", "0"], ["0", "1"])]
    assert ranks == [1, 2]


def test_a_model_with_inputs_is_read_back_from_its_document() -> None:
    for model in (
        nav.Model("x v", [["0", "1"], ["0", "0"]], ["x"], inputs={"a": ["0", "1"]}),
        nav.Model("x v", dynamics=["v", "a*x"], H=["x"], inputs={"a": "unknown"}),
    ):
        again = nav.Model.from_document(model.document())
        assert again.document()["inputs"] == model.document()["inputs"]
        assert nav.observe(again).document() == nav.observe(model).document()


BAD = [
    ({"H": ["x"], "F": [["0"]], "inputs": {"x": ["1"]}}, "inputs.x", "a name of its own"),
    ({"H": ["x"], "F": [["0"]], "inputs": {"u": ["1", "2"]}}, "inputs.u", "one per state"),
    ({"H": ["x"], "dynamics": ["u"], "inputs": {"u": ["1"]}}, "inputs.u", '"unknown"'),
    ({"H": ["x"], "pieces": [("0", "1", [["0"]])], "inputs": {"u": ["1"]}}, "inputs", "[inputs] or [[piece]]"),
]


@pytest.mark.parametrize(("arguments", "where", "said"), BAD)
def test_inputs_that_cannot_be_read_are_refused_at_their_place(arguments, where, said) -> None:
    with pytest.raises(NavsymError) as caught:
        nav.Model("x", **arguments)
    assert where in caught.value.where
    assert said in str(caught.value)


@pytest.mark.parametrize("verb", ["solve", "derive", "phases", "export"])
def test_other_verbs_refuse_unknown_inputs(verb: str) -> None:
    model = nav.Model("x v", [["0", "1"], ["0", "0"]], ["x"], interval="1", inputs={"a": ["0", "1"]})
    with pytest.raises(NavsymError, match="unknown input a"):
        getattr(nav, verb)(model, *(["c"] if verb == "export" else []))


def test_splits_and_relations_are_refused_beside_unknown_inputs() -> None:
    model = nav.Model("x v", [["0", "1"], ["0", "0"]], ["x", "v"], inputs={"a": ["0", "1"]})
    with pytest.raises(NavsymError, match="unknown inputs"):
        nav.observe(model, split=(1, 1))
    turned = {"dynamics": ["-w*s", "w*c"], "relations": ["c**2 + s**2 = 1"]}
    with pytest.raises(NavsymError, match="without relations"):
        nav.observe(nav.Model("c s", H=["c"], inputs={"w": "unknown"}, **turned))
