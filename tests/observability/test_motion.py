"""Ranks of models in time, in pieces and nonlinear ones, against the numerical rank of their flow at 60 digits."""

from __future__ import annotations

import random
from fractions import Fraction
from time import process_time

import pytest
import sympy as sp

import navsym as nav
from navsym.core.errors import DomainError, DuplicateError, UnknownSymbolError
from navsym.core.rational_functions import factor_exactly
from navsym.export.differences import of_model
from navsym.observability.certificates import is_granted
from navsym.observability.chains import prove_rank
from tests.benchmarks.observability import navigation_errors, satellite_and_odometer
from tests.observability.flows import rank_in_time, rank_of_flow, rank_of_pieces, rank_of_steps

TIMES = [Fraction(k, 40) for k in range(1, 13)]


def polynomial_text(coefficients):
    return " + ".join(f"{c}*t**{k}" for k, c in enumerate(coefficients)) or "0"


def random_entry(source):
    return source.choice([[0], [0], [0], [1], [-2], [0, 1], [1, 0, -1]])


def check_in_time(seed):
    source = random.Random(seed)
    n = source.choice([2, 3, 4])
    F = [[random_entry(source) for _ in range(n)] for _ in range(n)]
    H = [[source.choice([[0], [1], [0, 1]]) for _ in range(n)] for _ in range(source.choice([1, 1, 2]))]
    H = [row if any(any(entry) for entry in row) else [[1], *row[1:]] for row in H]
    model = nav.Model(
        [f"x{k}" for k in range(n)],
        F=[[polynomial_text(entry) for entry in row] for row in F],
        H=[[polynomial_text(entry) for entry in row] for row in H],
    )
    answer = nav.observe(model)
    assert answer.rank == rank_in_time(F, H, TIMES), seed
    assert answer.joint.proved and answer.unobservable_basis.rows == n - answer.rank


def check_pieces(seed):
    source = random.Random(seed)
    n = source.choice([2, 3, 4])
    matrices = []
    for _ in range(source.choice([2, 3, 3])):  # strictly triangular in some order: the exponential is a polynomial
        order = source.sample(range(n), n)
        F = [[0] * n for _ in range(n)]
        for a in range(n):
            for b in range(a + 1, n):
                F[order[a]][order[b]] = source.choice([0, 0, 1, -1, 2])
        matrices.append(F)
    H = [[source.choice([0, 0, 1]) for _ in range(n)]]
    H = H if any(H[0]) else [[1, *H[0][1:]]]
    ends = [Fraction(3, 7), Fraction(8, 9), Fraction(13, 10)][: len(matrices)]
    starts = [Fraction(0), *ends[:-1]]
    answer = nav.observe(
        nav.Model([f"x{k}" for k in range(n)], pieces=list(zip(starts, ends, matrices, strict=True)), H=H)
    )
    assert answer.rank == rank_of_pieces(matrices, ends, H), seed


def check_steps(seed):
    source = random.Random(seed)
    n = source.choice([2, 3, 4, 5])
    Phi = [[source.choice([0, 0, 0, 1, -1, 2]) for _ in range(n)] for _ in range(n)]
    H = [[source.choice([0, 0, 1, -1]) for _ in range(n)] for _ in range(source.choice([1, 1, 2]))]
    H = [row if any(row) else [1, *row[1:]] for row in H]
    answer = nav.observe(nav.Model([f"x{k}" for k in range(n)], Phi=Phi, H=H))
    assert answer.rank == rank_of_steps(Phi, H), seed
    assert answer.document()["checked"], seed


def check_nonlinear(seed):
    source = random.Random(seed)
    n = source.choice([2, 3, 4])
    names = [f"x{k}" for k in range(n)]

    def table():
        found = {}
        for _ in range(source.choice([0, 1, 1, 2])):
            exponents = [0] * n
            for _ in range(source.choice([0, 1, 1, 2])):
                exponents[source.randrange(n)] += 1
            found[tuple(exponents)] = source.choice([1, -1, 2])
        return found

    def text(polynomial):
        terms = ("*".join([str(c), *(f"{x}**{e}" for x, e in zip(names, p, strict=True) if e)]) for p, c in polynomial)
        return " + ".join(terms) or "0"

    f, first = [table() for _ in range(n)], source.randrange(n)
    z = [{tuple(int(k == first) for k in range(n)): 1, **table()}]
    answer = nav.observe(nav.Model(names, dynamics=[text(t.items()) for t in f], H=[text(t.items()) for t in z]))
    start = [Fraction(source.randrange(-40, 40), 37) for _ in range(n)]
    assert answer.rank == rank_of_flow(f, z, start, TIMES), seed


@pytest.mark.parametrize("check", [check_in_time, check_pieces, check_nonlinear, check_steps])
def test_the_rank_is_that_of_the_flow(check):
    for seed in range(35):
        check(seed)


@pytest.mark.long
@pytest.mark.parametrize("check", [check_in_time, check_pieces, check_nonlinear, check_steps])
def test_the_rank_is_that_of_the_flow_for_many_models(check):
    for seed in range(1000, 1100):
        check(seed)


# Models in steps


def sampled(**changes):
    arguments = {"states": "x v", "Phi": [["cos(a)", "sin(a)"], ["-sin(a)", "cos(a)"]], "H": ["x"], "a": "real"}
    return nav.Model(**{**arguments, **changes})


def test_an_oscillation_sampled_twice_in_its_period_is_lost_and_the_checker_grants_it():
    answer = nav.observe(sampled())
    a = sp.Symbol("a", real=True)
    assert (answer.rank, answer.kind, answer.split, answer.splits) == (2, "discrete", None, ())
    assert {drop.zeros for drop in answer.rank_drops} == {(sp.sin(a),)}
    assert nav.observe(sampled(), a="pi").rank == rank_of_steps([[-1, 0], [0, -1]], [[1, 0]]) == 1
    assert all(drop["checked"] for drop in answer.document()["rank_drops"])


def test_a_certificate_of_steps_falls_for_another_step():
    answer = nav.observe(nav.Model("x y z", Phi=[[1, 2, 0], [0, 1, 0], [0, 3, 1]], H=["x"]))
    (item,) = answer.certificates()
    assert is_granted(item) and answer.unobservable == ("z",)
    spoiled = {**item, "statement": {**item["statement"], "F": [["1", "2", "1"], ["0", "1", "0"], ["0", "3", "1"]]}}
    assert not is_granted(spoiled)


def test_a_model_of_steps_survives_its_file_and_is_no_model_in_continuous_time(tmp_path):
    sampled().save(tmp_path / "steps.toml")
    assert nav.observe(tmp_path / "steps.toml").document() == nav.observe(sampled()).document()
    for verb in (nav.derive, nav.solve, lambda model: model.linear(), lambda model: nav.observe(model, poles="p + 1")):
        with pytest.raises(DomainError, match="steps Phi"):
            verb(sampled())
    with pytest.raises(DomainError, match="steps Phi"):
        of_model(tmp_path / "steps.toml")


@pytest.mark.parametrize(
    "foreign", [{"F": [[0, 1], [0, 0]]}, {"interval": 1}, {"targets": {"x": "x"}}, {"rates": {"a": "1"}}]
)
def test_what_belongs_to_continuous_time_is_refused_beside_steps(foreign):
    with pytest.raises(DuplicateError, match="expected Phi or"):
        sampled(**foreign)
    with pytest.raises(UnknownSymbolError):
        sampled(Phi=[["t", "0"], ["0", "1"]])


# Models in time


def turning(**changes):
    F = [["0", "f", "1"], ["0", "0", "0"], ["0", "0", "0"]]
    arguments = {"states": "v tilt bias", "F": F, "H": ["v"], "f": "real", "r": "real", "rates": {"f": "r"}}
    return nav.Model(**{**arguments, **changes})


def test_a_changing_force_parts_tilt_from_bias_and_a_frozen_one_does_not():
    answer = nav.observe(turning())
    assert (answer.rank, answer.frozen_rank, answer.kind) == (3, 2, "varying")
    assert {drop.zeros for drop in answer.rank_drops if drop.lasting} == {(sp.Symbol("r", real=True),)}
    assert nav.observe(turning(rates=None)).unobservable == ("(tilt, bias) = (1, -f)",)


def test_a_drop_in_passing_is_no_drop_over_an_interval():
    document = nav.observe(nav.Model("a b", F=[["0", "t"], ["0", "0"]], H=["a"])).document()
    assert (document["joint_dimension"], document["rank_drops"]) == (2, [])
    assert {drop["condition"] for drop in document["instant"]["rank_drops"]} == {"t = 0"}


def test_a_frequency_that_is_zero_is_one_condition():
    drops = nav.observe(nav.Model("a b", F=[["0", "sin(w*t)"], ["0", "0"]], H=["a"], w="real")).rank_drops
    w, t = sp.symbols("w t", real=True)
    assert {drop.zeros for drop in drops if drop.lasting} == {(w,)}
    assert {drop.zeros for drop in drops if not drop.lasting} == {(sp.sin(w * t),)}


def test_the_rank_drops_on_every_listed_condition_and_not_beside_it():
    model = turning(F=[["0", "f", "k*t + c"], ["0", "0", "k"], ["0", "0", "0"]], k="real", c="real")
    conditions = [drop.zeros for drop in nav.observe(model).rank_drops if drop.lasting and drop.subspace == "joint"]
    source = random.Random(7)
    names = ("f", "r", "k", "c")
    inside = beside = 0
    for _ in range(60):
        values = {name: source.choice([0, 0, 1, Fraction(-2, 3)]) for name in names}
        at = {sp.Symbol(name, real=True): sp.Rational(value) for name, value in values.items()}
        listed = any(all(zero.subs(at) == 0 for zero in zeros) for zeros in conditions)
        F = [[[0], [values["f"], values["r"]], [values["c"], values["k"]]], [[0], [0], [values["k"]]], [[0], [0], [0]]]
        assert (rank_in_time(F, [[[1], [0], [0]]], TIMES) < 3) == listed, values
        inside, beside = inside + listed, beside + (not listed)
    assert inside > 5 and beside > 5


# Pieces


def test_a_turn_in_the_middle_carries_what_is_unseen_into_sight():
    still, turn = [[0, 0, 0]] * 3, [[0, 0, 0], [0, 0, 1], [0, -1, 0]]
    last = [[0, 1, 0], [0, 0, 0], [0, 0, 0]]
    pieces = [(0, 1, last), (1, 2, turn), (2, 3, last), (3, 4, still)]
    answer = nav.observe(nav.Model("x y z", pieces=pieces, H=["x"]))
    assert answer.rank == 3 == rank_of_pieces([last, turn, last, still], [1, 2, 3, 4], [[1, 0, 0]])
    assert [piece["joint_dimension"] for piece in answer.document()["pieces"]] == [2, 1, 2, 1]
    assert nav.observe(nav.Model("x y z", pieces=pieces[:2], H=["x"])).rank == 2


def test_pieces_with_symbolic_ends_have_the_rank_of_almost_all_lengths():
    turn, last = [[0, 0, 0], [0, 0, "w"], [0, "-w", 0]], [[0, 1, 0], [0, 0, 0], [0, 0, 0]]
    pieces = [(0, "a", last), ("a", "a + b", turn), ("a + b", "a + b + c", last)]
    declared = dict.fromkeys("abcw", "positive")
    assert nav.observe(nav.Model("x y z", pieces=pieces, H=["x"], **declared)).rank == 3


# Nonlinear models


def test_roots_are_read_with_their_square():
    f = ["u", "v", "0", "0", "0"]
    ranges = [f"sqrt((x - {a})**2 + (y - {b})**2) + c" for a, b in ((0, 0), (1, 0), (0, 2))]
    assert nav.observe(nav.Model("x y u v c", dynamics=f, H=ranges)).rank == 5
    assert nav.observe(nav.Model("x y u v c", dynamics=f, H=ranges[:1])).unobservable == (
        "(x, y, u, v) = (y, -x, v, -u)",
    )
    with pytest.raises(DomainError, match="independent square roots"):
        nav.observe(nav.Model("x y", dynamics=["sqrt(x*y) + sqrt(x)", "sqrt(y)"], H=["x"]))


def test_what_is_not_a_model_is_refused_in_words():
    circle = {"states": "c s", "dynamics": ["-s", "2*c"], "H": ["c"], "relations": ["c**2 + s**2 = 1"]}
    with pytest.raises(DomainError, match="a relation that the motion keeps"):
        nav.observe(nav.Model(**circle))
    with pytest.raises(DomainError, match="the square of a state alone"):
        nav.observe(nav.Model(**{**circle, "relations": ["c*s = 1"]}))
    with pytest.raises(DuplicateError, match="dynamics or F"):
        nav.Model(**circle, F=[[0, 1], [0, 0]])
    with pytest.raises(UnknownSymbolError, match="declare it"):
        turning(rates={"q": "1"})
    with pytest.raises(DomainError, match="which moves"):
        nav.observe(turning(), f=1)
    for verb in (nav.derive, nav.solve):
        with pytest.raises(DomainError, match="constant parameters"):
            verb(turning(interval=1))
    with pytest.raises(DomainError, match="one constant F"):
        nav.observe(nav.Model("x y", dynamics=["y", "0"], H=["x"]), restore=True)


def test_a_nonlinear_model_file_reads_back(tmp_path):
    model = nav.Model("x y", dynamics=["y", "-k*sin(x)"], H=["x**2"], rates={"k": "j"}, k="positive", j="real")
    model.save(tmp_path / "swing.toml")
    assert nav.Model.load(tmp_path / "swing.toml") == model
    assert nav.observe(tmp_path / "swing.toml").rank == 2


# Defects that are mended


@pytest.mark.parametrize("gain", ["sin(w*t)", "exp(w*t) - 1"])
def test_functions_of_what_vanishes_take_their_values_there(gain):
    """x' = gain s + w b shows nothing but x for w = 0: sin(w t) and exp(w t) - 1 vanish with w."""
    answer = nav.observe(nav.Model("x s b", F=[["0", gain, "w"], ["0"] * 3, ["0"] * 3], H=["x"], w="real"))
    joint = [drop for drop in answer.rank_drops if drop.subspace == "joint"]
    (drop,) = (drop for drop in joint if drop.condition == "w = 0")
    assert (answer.rank, drop.lasting, drop.rank, drop.directions.rows, drop.inside) == (3, True, 1, 2, ())


def test_no_rank_is_told_where_functions_become_one():
    """For a = w the two exponentials are one, and x alone is shown: they are no longer independent."""
    F = [["0", "exp(w*t) - exp(a*t)", "w - a"], ["0"] * 3, ["0"] * 3]
    listed = nav.observe(nav.Model("x s b", F=F, H=["x"], w="real", a="real")).rank_drops
    assert [drop.rank for drop in listed if drop.condition == "a - w = 0"] in ([None], [None, None])


def test_constants_of_the_earth_are_factored():
    entry = "x**2 - (7.292115e-5)**2"
    model = nav.Model("a b", F=[["0", entry], ["0", "0"]], H=["a", "b"], x="real")
    assert nav.observe(model).rank == 2
    assert {len(drop.zeros) for drop in nav.observe(model).rank_drops} == {1}
    nav.derive(nav.Model("a b", F=[["0", entry], [entry, "0"]], H=["a"], x="positive", interval=1))


def test_factors_with_large_equal_monomials_multiply_to_the_polynomial():
    from flint import Ordering, fmpz_mpoly_ctx

    x, y = (fmpz_mpoly_ctx.get(("x", "y"), Ordering.degrevlex).gen(k) for k in (0, 1))
    polynomial = -6 * (10**15 * x - 7 * y) ** 2 * (10**15 * x + 7 * y) * (x + 1)
    content, factors = factor_exactly(polynomial)
    product = content * x**0
    for base, power in factors:
        product = product * base**power
    assert product == polynomial and len(factors) == 3


def test_like_sensors_are_redundant():
    answer = nav.observe(nav.Model("x v", F=[[0, 1], [0, 0]], H=["x", "x", "2*x"]))
    assert (answer.rank, answer.redundant) == (2, ("z2", "z3"))


def test_directions_and_functionals_are_what_they_are():
    answer = nav.observe(nav.Model("x v b", F=[[0, 1, 0], [0, 0, 0], [0, 0, 0]], H=["x + b"]))
    assert answer.unobservable == ("(x, b) = (1, -1)",)
    assert set(answer.observable_functionals) == {"x + b", "v"}


def test_conditions_without_real_points_are_not_listed():
    model = nav.Model("a b", F=[["0", "x**2 + x*y + y**2 + 1"], ["0", "0"]], H=["a"], x="real", y="real")
    assert nav.observe(model).rank_drops == ()


# Speed


def test_fifteen_states_with_latitude_have_their_rank_in_two_seconds():
    model = navigation_errors()
    start = process_time()
    proved = prove_rank(model)
    assert (proved.rank, process_time() - start < 2) == (12, True)
    assert proved.upper.startswith("3 hidden directions")


def test_twenty_eight_states_have_their_rank_in_a_minute():
    model = satellite_and_odometer()
    start = process_time()
    proved = prove_rank(model)
    assert proved.upper and process_time() - start < 60
