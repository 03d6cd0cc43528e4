"""Blocks of vector measurements: against two convex solvers, hand-made optima, and forged certificates."""

from __future__ import annotations

import copy
import json
import warnings
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

import navsym as nav
from navsym import checker
from navsym.cli.main import run


def random_blocks(rng, norms=("l2", "linf", "l1", "ellipsoid")):
    """Blocks of every norm with decimals of one digit, a target, and the same in doubles for a solver."""
    m = int(rng.integers(1, 6))
    blocks, plain = [], []
    for _ in range(int(rng.integers(m, 12))):
        p, norm = int(rng.integers(1, 5)), str(rng.choice(norms))
        H = rng.integers(-20, 21, (p, m)) / 10
        sizes = rng.integers(1, 21, p) / 10
        shape = np.diag(sizes**2)
        if norm == "ellipsoid":
            root = rng.integers(-3, 4, (p, p))
            shape = (root @ root.T + np.eye(p, dtype=int)).astype(float)
        bound = shape.astype(int).tolist() if norm == "ellipsoid" else sizes.tolist()
        blocks.append(nav.Block(H.tolist(), bound, "l2" if norm == "ellipsoid" else norm))
        plain.append((H, "l2" if norm == "ellipsoid" else norm, sizes, shape))
    target = rng.integers(-5, 6, m)
    target[0] = target[0] or 1
    return blocks, plain, target.tolist()


def value_by(solver, plain, target, constraints=(), **options):
    """The least guaranteed error by cvxpy; None where no weights keep the constraints."""
    import cvxpy as cp

    weights = [cp.Variable(H.shape[0]) for H, *_ in plain]
    costs = []
    for w, (_, norm, sizes, shape) in zip(weights, plain, strict=True):
        if norm == "l2":
            costs.append(cp.norm(np.linalg.cholesky(shape).T @ w, 2))
        else:
            costs.append(cp.norm(cp.multiply(sizes, w), 1 if norm == "linf" else "inf"))
    balance = sum(H.T @ w for w, (H, *_) in zip(weights, plain, strict=True)) == np.array(target)
    asked = [balance]
    for factors, relation, bound in constraints:
        total = sum(np.array(c) @ w for c, w in zip(factors, weights, strict=True))
        asked.append({"<=": total <= bound, ">=": total >= bound, "=": total == bound}[relation])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # "may be inaccurate": the tolerance is beyond what the solver promises
        value = cp.Problem(cp.Minimize(sum(costs)), asked).solve(solver=solver, **options)
        return float(value) if value is not None and np.isfinite(value) else None


def value_by_casadi(plain, target):
    """The least sum of |w| sizes by casadi and HiGHS, for boxes only: w = u - v with u, v >= 0."""
    import casadi as ca

    H, sizes = np.vstack([H for H, *_ in plain]), np.concatenate([sizes for *_, sizes, _ in plain])
    split = ca.SX.sym("split", 2 * len(sizes))
    problem = {"x": split, "f": ca.dot(np.r_[sizes, sizes], split), "g": np.hstack([H.T, -H.T]) @ split}
    solver = ca.qpsol("solver", "highs", problem, {"highs": {"output_flag": False}})
    return float(solver(lbx=0, lbg=np.array(target), ubg=np.array(target))["f"])


TIGHT = {"tol_gap_abs": 1e-12, "tol_gap_rel": 1e-12, "tol_feas": 1e-12}
LOOSE = {"eps_abs": 1e-10, "eps_rel": 1e-10}
CONES = {
    "CLARABEL": lambda *problem: value_by("CLARABEL", *problem, **TIGHT),
    "SCS": lambda *problem: value_by("SCS", *problem, max_iters=100_000, **LOOSE),
}
BOXES = {
    "CLARABEL": CONES["CLARABEL"],
    "OSQP": lambda *problem: value_by("OSQP", *problem, max_iter=100_000, polishing=True, **LOOSE),
    "casadi": value_by_casadi,
}


def compare(count, rng, solvers=CONES, **options):
    """The worst relative distance of each solver from the enclosures of so many problems."""
    worst = dict.fromkeys(solvers, 0.0)
    solved = 0
    while solved < count:
        blocks, plain, target = random_blocks(rng, **options)
        try:
            found = nav.solve_blocks(blocks, target)
        except nav.NavsymError as error:
            assert error.kind == "not-estimable"
            continue
        solved += 1
        lower, upper = (Fraction(end) for end in (found.value.lower, found.value.upper))
        assert lower <= upper <= lower * (1 + Fraction(1, 10**12))
        assert checker.check(checker.load(json.dumps(found.certificate))) == "cones"
        for name, value_of in solvers.items():
            worst[name] = max(worst[name], abs(value_of(plain, target) / float(lower) - 1))
    return worst


def test_the_value_is_that_of_two_convex_solvers():
    worst = compare(15, np.random.default_rng(7))
    assert worst["CLARABEL"] < 1e-9 and worst["SCS"] < 1e-3


@pytest.mark.slow
def test_the_value_is_that_of_two_convex_solvers_for_two_hundred_problems():
    worst = compare(200, np.random.default_rng(8))
    assert worst["CLARABEL"] < 1e-9 and worst["SCS"] < 1e-3


def test_boxes_alone_are_enclosed_sharply_also_where_several_duals_are_optimal():
    rng = np.random.default_rng(12)
    for _ in range(150):
        blocks, _, target = random_blocks(rng, norms=["linf"])
        try:
            value = nav.solve_blocks(blocks, target).value
        except nav.NavsymError:
            continue
        assert Fraction(value.upper) - Fraction(value.lower) <= Fraction(value.upper) / 10**18


def test_sums_of_absolute_values_have_the_optimum_of_three_solvers():
    worst = compare(12, np.random.default_rng(11), BOXES, norms=["linf"])
    assert worst["CLARABEL"] < 1e-9 and worst["casadi"] < 1e-9 and worst["OSQP"] < 0.3


@pytest.mark.slow
def test_five_hundred_sums_of_absolute_values_have_the_optimum_of_three_solvers():
    worst = compare(500, np.random.default_rng(12), BOXES, norms=["linf"])
    print(worst)  # documented
    assert worst["CLARABEL"] < 1e-9 and worst["casadi"] < 1e-9 and worst["OSQP"] < 0.3


def test_weights_are_unbiased_and_the_noise_of_the_worst_case_costs_the_value_exactly():
    rng = np.random.default_rng(9)
    for _ in range(20):
        blocks, _, target = random_blocks(rng)
        try:
            found = nav.solve_blocks(blocks, target)
        except nav.NavsymError:
            continue
        sums = [sum(w[j] * b.H[j, k] for b, w in zip(blocks, found.weights, strict=True) for j in range(len(w)))
                for k in range(len(target))]  # fmt: skip
        assert sums == target
        attained = sum(
            a * r for w, noise in zip(found.weights, found.noise, strict=True) for a, r in zip(w, noise, strict=True)
        )
        lower = Fraction(found.value.lower)
        assert lower <= Fraction(int(attained.p), int(attained.q)) <= Fraction(found.value.upper)
        assert abs(sum(found.shares) - 1) < 1e-12


def test_one_ball_measured_twice_has_the_radius_of_one():
    """Two equal blocks with noise in the unit ball: no estimate of an entry is better than a single measurement."""
    block = nav.Block([[1, 0], [0, 1]])
    assert nav.solve_blocks([block, block], [1, 0]).value.upper.startswith("1.0000000000000000")


def test_blocks_of_one_number_are_the_scalar_problem():
    times = [0, 1, 3]
    found = nav.solve_blocks([nav.Block([[1, t]], "1/2", "linf") for t in times], [0, 1])
    assert Fraction(found.value.lower) <= Fraction(1, 3) <= Fraction(found.value.upper)
    basis = nav.Model(states="x v", F=[["0", "1"], ["0", "0"]], H=["x"], sigma="1/2", targets={"v": "v"})
    guard = nav.Guard(basis, "v")
    for t in times:
        last = guard.step(0, t=t)
    assert abs(float(last.radius.lower) - float(found.value.lower)) < 1e-15


def test_a_constraint_makes_the_weights_blind_to_a_drift():
    blocks = [nav.Block([[1], [1]], 1, "linf") for _ in range(4)]
    drift = [[2 * k, 2 * k + 1] for k in range(4)]
    free = nav.solve_blocks(blocks, [1])
    found = nav.solve_blocks(blocks, [1], constraints=[(drift, 0)])
    assert sum(w * t for ws, ts in zip(found.weights, drift, strict=True) for w, t in zip(ws, ts, strict=True)) == 0
    assert float(found.value.lower) >= float(free.value.lower) and found.check()


@pytest.mark.parametrize(("relation", "bound"), [("=", 1), (">=", 1), ("<=", -1)])
def test_a_target_of_zeros_beside_a_constraint_that_zero_weights_break_is_answered(relation, bound):
    blocks, factors, side = [nav.Block([["1"]])] * 3, [["1"], ["2"], ["3"]], bound
    found = nav.solve_blocks(blocks, ["0"], constraints=[(factors, relation, bound)])  # weights of zero mean
    assert float(found.value.lower) == pytest.approx(1) and [2 * w[0] for w in found.weights] == [-side, 0, side]
    assert nav.check(found)[0].status == "ACCEPTED"
    with pytest.raises(nav.NavsymError, match="every estimate of it is free"):
        nav.solve_blocks(blocks, ["0"], constraints=[(factors, relation, -bound if relation != "=" else 0)])


def bounded_sums(rng, plain):
    """Bounds of sums of weights, and of single weights; about half of them bind."""
    sizes = [H.shape[0] for H, *_ in plain]
    ones = [[1] * p for p in sizes]
    c = float(rng.integers(0, 8)) / 4
    asked = [(ones, "<=", c), (ones, ">=", -c)]
    for _ in range(int(rng.integers(0, 3))):
        k = int(rng.integers(len(sizes)))
        one = [[int(i == k and j == 0) for j in range(p)] for i, p in enumerate(sizes)]
        asked.append((one, str(rng.choice(["<=", ">="])), float(rng.integers(-2, 3)) / 4))
    return asked


def test_bounded_sums_and_weights_cost_what_a_convex_solver_finds_and_are_kept_exactly():
    rng, solved, bind = np.random.default_rng(21), 0, 0
    while solved < 30:
        blocks, plain, target = random_blocks(rng)
        asked = bounded_sums(rng, plain)
        try:
            free = nav.solve_blocks(blocks, target)
        except nav.NavsymError:
            continue
        value = value_by("CLARABEL", plain, target, asked, **TIGHT)
        solved += 1
        try:
            found = nav.solve_blocks(blocks, target, constraints=asked)
        except nav.NavsymError as error:
            assert error.kind == "not-estimable" and value is None
            continue
        assert value == pytest.approx(float(found.value.upper), rel=1e-8) and found.check()
        assert Fraction(found.value.upper) - Fraction(found.value.lower) <= Fraction(found.value.upper) / 10**12
        bind += float(found.value.lower) > float(free.value.upper) * (1 + 1e-9)
        for factors, relation, bound in asked:
            total = sum(Fraction(int(w.p), int(w.q)) * a
                        for ws, c in zip(found.weights, factors, strict=True)
                        for w, a in zip(ws, c, strict=True))  # fmt: skip
            assert total <= Fraction(bound) if relation == "<=" else total >= Fraction(bound)
    assert bind > 7


def test_a_constraint_that_makes_the_error_twenty_orders_larger_is_kept():
    blocks = [nav.Block([["1"]]), nav.Block([["1e-20"]])]
    found = nav.solve_blocks(blocks, ["1"], constraints=[([["1"], ["0"]], "<=", "1/2")])
    assert float(found.value) == pytest.approx(5e19, rel=1e-15) and found.check()


def test_a_certificate_with_a_weight_below_zero_is_refused():
    """Of 1 and 2 the second alone is best; at most 1/3 of both together needs the first below zero."""
    blocks = [nav.Block([[1]], 1, "linf"), nav.Block([[2]], 1, "linf")]
    found = nav.solve_blocks(blocks, [1], constraints=[([[1], [1]], "<=", "1/3")])
    assert [[str(e) for e in w] for w in found.weights] == [["-1/3"], ["2/3"]] and found.value.upper.startswith("1")
    forged = copy.deepcopy(dict(found.certificate))
    forged["functional"][1], forged["blocks"][2]["weights"] = "1/6", ["-1/6"]
    with pytest.raises(checker.Refused, match="below zero"):
        checker.check(checker.load(json.dumps(forged)))


def test_several_targets_have_an_answer_each_and_a_nuisance_parameter_may_be_unknown():
    blocks = [nav.Block([[1, 0, 1], [0, 1, 1]]), nav.Block([[1, 0, 0], [0, 1, 0]], 2)]
    found = nav.solve_blocks(blocks, {"x": [1, 0, 0], "difference": [1, -1, 0]})
    assert list(found) == ["x", "difference"] and all(one.check() for one in found.values())
    assert found["difference"].estimate([[3, 1], [3, 1]]) == pytest.approx(2)


def test_a_target_that_is_not_measured_is_refused():
    with pytest.raises(nav.NavsymError) as caught:
        nav.solve_blocks([nav.Block([[1, 0]])], [0, 1])
    assert caught.value.kind == "not-estimable"


def test_a_target_within_dependent_unknowns_is_estimated():
    found = nav.solve_blocks([nav.Block([[1, 1], [2, 2]])], [3, 3])
    assert found.check() and found.estimate([[1, 2]]) == pytest.approx(3)


@pytest.mark.parametrize(
    ("make", "kind"),
    [
        (lambda: nav.Block([[1, 2], [3]]), "shape"),
        (lambda: nav.Block([]), "empty"),
        (lambda: nav.Block([[1]], 0), "domain"),
        (lambda: nav.Block([[1]], "nan"), "not-finite"),
        (lambda: nav.Block([[1]], 1, "l3"), "domain"),
        (lambda: nav.Block([[1, 0], [0, 1]], [[1, 2], [2, 1]]), "domain"),
        (lambda: nav.Block([[1, 0], [0, 1]], [[1, 0]]), "shape"),
        (lambda: nav.Block([[1], [1]], [1, 2, 3]), "shape"),
        (lambda: nav.solve_blocks([nav.Block([[1]])], [0]), "domain"),
        (lambda: nav.solve_blocks([nav.Block([[1]])], [1, 2]), "shape"),
        (lambda: nav.solve_blocks([], [1]), "empty"),
        (lambda: nav.solve_blocks([nav.Block([[1]])], [1], constraints=[([[1]], "<", 0)]), "domain"),
        (lambda: nav.solve_blocks([nav.Block([[1]])], [1], constraints=[[[1]]]), "domain"),
        (lambda: nav.solve_blocks([nav.Block([[1]])], [1], constraints=[([[1]], "<=", "1/2")]), "not-estimable"),
        (lambda: nav.solve_blocks([nav.Block([[1]])], [1], constraints=[([[1, 2]], 0)]), "shape"),
    ],
)
def test_what_is_no_block_is_an_error_of_one_line(make, kind):
    with pytest.raises(nav.NavsymError) as caught:
        make()
    assert caught.value.kind == kind and "\n" not in str(caught.value) and str(caught.value).count(";") >= 2


def change_certificates(problems, each, rng):
    """How many of so many changed certificates are refused; any other has a weight at regressors that are zero."""
    refused = 0
    for _ in range(problems):
        blocks, _, target = random_blocks(rng)
        try:
            document = dict(nav.solve_blocks(blocks, target).certificate)
        except nav.NavsymError:
            continue
        for _ in range(each):
            forged = copy.deepcopy(document)
            block = forged["blocks"][int(rng.integers(len(forged["blocks"])))]
            j = int(rng.integers(len(block["weights"])))
            what = int(rng.integers(4))
            if what == 0:
                block["weights"][j] = str(Fraction(block["weights"][j]) + Fraction(1, 10**9))
            elif what == 1:
                forged["dual"] = [str(Fraction(e) * (1 + Fraction(1, 10**9))) for e in forged["dual"]]
            elif what == 2:
                forged["lower"] = str(Fraction(forged["upper"]) * (1 + Fraction(1, 10**9)))
            else:
                forged["upper"] = str(Fraction(forged["lower"]) * (1 - Fraction(1, 10**9)))
            row_is_zero = what == 0 and all(Fraction(h) == 0 for h in block["H"][j])
            try:
                checker.check(checker.load(json.dumps(forged)))
            except checker.Refused:
                refused += 1
            else:
                assert row_is_zero, (what, j)
    return refused


def test_changed_certificates_are_refused():
    assert change_certificates(30, 10, np.random.default_rng(10)) > 200


@pytest.mark.slow
def test_twenty_thousand_changed_certificates_are_refused():
    assert change_certificates(300, 100, np.random.default_rng(13)) > 20_000


# Blocks in model files and in the stream

PLANE = {
    "states": "x y u v",
    "F": [["0", "0", "1", "0"], ["0", "0", "0", "1"], ["0"] * 4, ["0"] * 4],
    "H": ["x", "y", "u + v"],
    "sigma": ["1", "2", "1/2"],
    "targets": {"x": "x", "turn": "u - v"},
}
NORMS = [("l2", None), ("l2", [["1", "-1/2"], ["-1/2", "1"]]), ("l1", None), ("linf", None)]


def plane(norm, shape=None, **more):
    """Positions whose errors are bounded together, beside a rate by itself."""
    block = {"measurements": "z1 z2", "norm": norm} | ({"shape": shape} if shape else {})
    return nav.Model(**PLANE | more, blocks=[block])


def plain_block(norm, shape, places, sigma):
    """Sizes and shape in doubles of the members that were measured."""
    R = np.eye(2) if shape is None else np.array([[float(Fraction(e)) for e in row] for row in shape])
    s = np.array([sigma[j] for j in places])
    return s, R[np.ix_(places, places)] * np.outer(s, s)


@pytest.mark.parametrize(("norm", "shape"), NORMS)
@pytest.mark.parametrize("F", [PLANE["F"], [["0", "0", "1", "0"], ["0", "0", "0", "1"], ["-1"] + ["0"] * 3, ["0"] * 4]])
def test_a_guard_with_blocks_has_the_radius_of_a_convex_solver_also_where_members_are_missing(norm, shape, F):
    from scipy.linalg import expm

    rng, guard = np.random.default_rng(5), nav.Guard(plane(norm, shape, F=F), "turn", memory=6)
    A, rows, checked = np.array(F, dtype=float), [], 0
    h = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1]])
    for k in range(10):
        seen = [j for j in range(3) if rng.random() < 0.8]
        rows = [*rows, (k / 2, seen)][-6:]
        found = guard.step({f"z{j + 1}": 0 for j in seen}, t=f"{k}/2")
        plain = []
        for t, members in rows:
            back, places = expm(A * (t - k / 2)), [j for j in members if j < 2]
            if places:
                plain.append((h[places] @ back, norm, *plain_block(norm, shape, places, [1.0, 2.0])))
            if 2 in members:
                plain.append((h[[2]] @ back, "linf", np.array([0.5]), np.eye(1)))
        rank = np.linalg.matrix_rank(np.vstack([H for H, *_ in plain]))
        if found.radius is None or rank < 4:
            continue
        checked += 1
        assert value_by("CLARABEL", plain, [0, 0, 1, -1], **TIGHT) == pytest.approx(float(found.radius), rel=1e-8)
        assert Fraction(found.radius.upper) - Fraction(found.radius.lower) <= Fraction(found.radius.upper) / 10**12
        errors = {(t, name): r for t, name, r in found.worst_case()}
        attained = sum(w * errors[t, name] for t, name, w in found.weights)
        assert attained == pytest.approx(float(found.radius), rel=1e-12)
        exact = PLANE["F"] == F
        assert (found.certificate is not None) == (exact or norm == "linf") and found.certificates() == (
            [found.certificate] if found.certificate else []
        )
        assert found.certificate is None or found.check()
    assert checked >= 4
    assert nav.Guard.load(guard.save()).step([1, 1, 1], t=6) == guard.step([1, 1, 1], t=6)


def test_errors_inside_a_disc_never_contradict_and_the_radius_contains_them():
    rng, guard = np.random.default_rng(6), nav.Guard(plane("l2", sigma=["1", "1", "5"]), "turn", memory=5)
    for k in range(12):
        angle, size = rng.uniform(0, 2 * np.pi), rng.choice([1, rng.random()]) * (1 - 1e-9)
        z = [3 + 2 * k + size * np.cos(angle), 1 - k + size * np.sin(angle), 1]
        found = guard.step(z, t=k)
        if found.radius is not None:
            assert abs(found.value - 3) <= float(found.radius.upper)
            allowed = guard.interval()
            assert float(allowed.lower) <= 3 <= float(allowed.upper)


def test_errors_that_fit_a_box_and_no_disc_are_a_contradiction():
    """A point that stands still, seen at (0, 0) and (3/2, 3/2): each coordinate alone is possible, both are not."""
    still = {"states": "x y", "F": [["0", "0"], ["0", "0"]], "H": ["x", "y"], "targets": {"x": "x"}}
    box = nav.Guard(nav.Model(**still), "x")
    disc = nav.Guard(nav.Model(**still, blocks=[{"measurements": "z1 z2"}]), "x")
    assert [guard.step([0, 0], t=0).value for guard in (box, disc)] == [0.0, 0.0]
    box.step(["3/2", "3/2"], t=1)
    with pytest.raises(nav.NavsymError, match="contradiction at t = 0, 1") as caught:
        disc.step(["3/2", "3/2"], t=1)
    assert caught.value.kind == "inconsistent"
    assert disc.step(["1.4", "1.4"], t=1).radius.upper.startswith("1")


def test_a_sum_of_errors_on_an_interval_is_that_of_single_measurements_and_their_sums():
    """On [0, T] a position and a velocity with |r1|/s1 + |r2|/s2 <= 1 are a little better than each alone."""
    line = {"states": "x v", "F": [["0", "1"], ["0", "0"]], "H": ["x", "v"], "sigma": ["1", "2"], "targets": {"v": "v"}}
    both = [{"measurements": "z1 z2", "norm": "l1"}]
    times = [f"{k}/8" for k in range(9)]
    rows = [[["1", str(Fraction(t) - 1)], ["0", "1"]] for t in times]
    for target, options in (("v", {}), ("x", {"targets": {"x": "x"}})):
        found = nav.solve(nav.Model(**line | options, interval="1", blocks=both), target)
        grid = nav.solve_blocks(
            [nav.Block(H, ["1", "2"], "l1") for H in rows], [int(target == "x"), int(target == "v")]
        )
        alone = nav.solve(nav.Model(**line | options, interval="1"), target)
        assert float(found.lower) <= float(grid.value.upper) * (1 + 1e-15) and found.check()
        assert float(found.upper) == pytest.approx(float(grid.value.lower), rel=1e-9)  # the best times are on the grid
        assert float(found.upper) <= float(alone.upper)
        assert nav.solve(
            nav.Model(**line | options, interval="1", blocks=[both[0] | {"norm": "linf"}]), target
        ).value == (alone.value)


def test_blocks_are_read_from_files_and_written_back(tmp_path, capsys):
    path = tmp_path / "plane.toml"
    plane("l2", NORMS[1][1]).save(path)
    again = nav.Model.load(path)
    assert again.document() == nav.Model.load(path).document() and again.read().blocks[0].names == ("z1", "z2")
    data = tmp_path / "data.csv"
    data.write_text("t,z1,z2,z3\n0,0,0,1\n1,1,,1\n2,2,0,1\n3,3,0,1\n")
    assert run(["guard", str(path), "--data", str(data), "--target", "turn", "--json"]) == 0
    last = json.loads(capsys.readouterr().out)["epochs"][-1]
    assert last["certificate"]["kind"] == "cones" and {b["norm"] for b in last["certificate"]["blocks"]} == {
        "l2",
        "linf",
    }
    assert run(["solve", str(path), "--target", "turn", "--json"]) == 2
    assert "Guard" in json.loads(capsys.readouterr().out)["error"]["message"]


@pytest.mark.parametrize(
    "block",
    [
        {"measurements": "z1 z9"},
        {"measurements": "z1 z1"},
        {"measurements": []},
        {"norm": "l2"},
        {"measurements": "z1 z2", "norm": "l3"},
        {"measurements": "z1 z2", "norm": "l1", "shape": [["1", "0"], ["0", "1"]]},
        {"measurements": "z1 z2", "shape": [["1", "1"], ["1", "1"]]},
        {"measurements": "z1 z2", "shape": [["2", "0"], ["0", "1"]]},
        {"measurements": "z1 z2", "shape": [["1", "0"]]},
        {"measurements": "z1 z2", "colour": "red"},
        "z1 z2",
    ],
)
def test_what_is_no_block_of_a_model_is_an_error_of_one_line(block):
    with pytest.raises(nav.NavsymError) as caught:
        nav.Model(**PLANE, blocks=[block])
    assert "\n" not in str(caught.value) and caught.value.where.startswith("Model: blocks")


@pytest.mark.parametrize(
    "ask",
    [
        lambda model: nav.Guard(plane("l1"), "x", "variance"),
        lambda model: nav.design(model, "x", times=range(3), budget=3),
        lambda model: nav.solve(nav.Model(**PLANE, interval="1", blocks=[{"measurements": "z1 z2"}]), "x"),
        lambda model: nav.phases(
            nav.Model(**PLANE, interval="T", T=("1", "2"), blocks=[{"measurements": "z1 z2"}]), "x"
        ),
    ],
)
def test_what_has_no_answer_with_blocks_is_refused(ask):
    with pytest.raises(nav.NavsymError, match=r"l1|l2") as caught:
        ask(plane("l2"))
    assert "\n" not in str(caught.value)


# Blocks beside gross errors


def ends_by(solver, plain, data, target):
    """Least and largest target over all states that keep every block; None where there is none."""
    import cvxpy as cp

    x = cp.Variable(len(target))
    kept = []
    for (H, norm, sizes, shape), z in zip(plain, data, strict=True):
        r = z - H @ x
        if norm == "l2":
            kept.append(cp.norm(np.linalg.inv(np.linalg.cholesky(shape)) @ r, 2) <= 1)
        else:
            kept.append(cp.norm(cp.multiply(1 / sizes, r), 1 if norm == "l1" else "inf") <= 1)
    values = []
    for sign in (1, -1):
        problem = cp.Problem(cp.Minimize(sign * (np.array(target) @ x)), kept)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "may be inaccurate", as above
            problem.solve(solver=solver, **TIGHT)
        if "infeasible" in problem.status:
            return None
        values.append(sign * problem.value)
    return values


@pytest.mark.parametrize(("norm", "shape"), NORMS[:3])
@pytest.mark.parametrize("most", [1, pytest.param(2, marks=pytest.mark.long)])
def test_gross_errors_beside_blocks_are_bounded_as_by_a_convex_solver_for_all_sets(norm, shape, most):
    """Every set of epochs is left out in turn; the members and the rate by itself of an epoch are wrong together."""
    rng, epochs = np.random.default_rng(40 + most), 5 + most
    guard, rows = nav.Guard(plane(norm, shape), "turn", outliers=most), []
    bad = set(rng.choice(epochs, size=most, replace=False).tolist())
    for k in range(epochs):
        z = [2 * k + rng.uniform(-0.4, 0.4), 1 - k + rng.uniform(-0.8, 0.8), 1 + rng.uniform(-0.4, 0.4)]
        z = [round(float(e), 6) + (40 if k in bad and j == 0 else 0) for j, e in enumerate(z)]
        found = guard.step(z, t=k)
        rows.append((k, np.array(z)))
    explained = {}
    for size in range(most + 1):
        for chosen in combinations(range(epochs), size):
            plain, data = [], []
            for k, z in rows:
                back = np.eye(4) + (k - epochs + 1) * np.eye(4, k=2)
                if k not in chosen:
                    plain.append((np.eye(4)[:2] @ back, norm, *plain_block(norm, shape, [0, 1], [1.0, 2.0])))
                    plain.append((np.array([[0, 0, 1.0, 1]]) @ back, "linf", np.array([0.5]), np.eye(1)))
                    data += [z[:2], z[2:]]
            ends = ends_by("CLARABEL", plain, data, [0, 0, 1, -1])
            if ends is not None:
                explained[frozenset(chosen)] = ends
    low, high = found.value - float(found.radius.upper), found.value + float(found.radius.upper)
    expected = min(e[0] for e in explained.values()), max(e[1] for e in explained.values())
    assert (low, high) == pytest.approx(expected, abs=1e-6)
    assert Fraction(found.radius.upper) - Fraction(found.radius.lower) <= Fraction(found.radius.upper) / 10**12
    assert set(found.excluded) == {float(k) for k in frozenset.intersection(*explained)} == {float(k) for k in bad}
    more = [2 * epochs, 1 - epochs, 1]
    assert nav.Guard.load(guard.save()).step(more, t=epochs) == guard.step(more, t=epochs)


@pytest.mark.parametrize("F", [PLANE["F"], [["0", "0", "1", "0"], ["0", "0", "0", "1"], ["-1"] + ["0"] * 3, ["0"] * 4]])
def test_the_exclusion_of_a_block_is_certified_and_spoiled_certificates_are_refused(F):
    shape = [["1", "-1/2"], ["-1/2", "1"]]
    rng, guard, seen = np.random.default_rng(3), nav.Guard(plane("l2", shape, F=F), "turn", outliers=1), 0
    truth = {"F": np.array(F, dtype=float), "x": np.array([1.0, -2, 0.5, 1])}
    from scipy.linalg import expm

    for k in range(9):
        x = expm(truth["F"] * k / 2) @ truth["x"]
        z = [x[0] + rng.uniform(-0.3, 0.3), x[1] + rng.uniform(-0.6, 0.6), x[2] + x[3] + rng.uniform(-0.4, 0.4)]
        found = guard.step([float(f"{e + (30 if k == 5 and j < 2 else 0):.6f}") for j, e in enumerate(z)], t=f"{k}/2")
        if found.certificate is None:
            continue
        seen += 1
        assert found.excluded == (2.5,) and found.check().accepted
        innocent = next(t for row in found.certificate["rows"] if (t := row["epoch"]) != "5/2")
        for forged in ({"excluded": ["5/2", innocent]}, {"most": 3}, {"contradictions": []}):
            with pytest.raises(checker.Refused):
                checker.check(checker.load(json.dumps(found.certificate | forged)))
    assert seen >= 2


def test_a_block_that_is_wrong_in_a_direction_that_no_member_shows_is_excluded():
    """A point that stands still: (1, 1) and (-1, -1) keep a box of 3/2 and leave a disc; one fix of three is wrong."""
    still = {
        "states": "x y",
        "F": [["0", "0"], ["0", "0"]],
        "H": ["x", "y"],
        "targets": {"x": "x"},
        "sigma": ["3/2"] * 2,
    }
    box = nav.Guard(nav.Model(**still), "x", outliers=1)
    disc = nav.Guard(nav.Model(**still, blocks=[{"measurements": "z1 z2"}]), "x", outliers=1)
    for guard, excluded in ((box, ()), (disc, (2.0,))):
        for k, z in enumerate([["1.2", "1.2"], ["1", "1"], ["-1.2", "-1.2"]]):
            last = guard.step(z, t=k)
        assert last.excluded == excluded
    assert last.check().accepted and abs(last.value - 1.1) < 0.01
    rows = [[Fraction(e) for e in (*row["H"], row["sigma"])] for row in last.certificate["rows"]]
    assert any(a * b for a, b, _ in rows)
    for a, b, sigma in rows:  # no more and no less than the disc allows
        assert a * a + b * b <= (sigma * 2 / 3) ** 2 <= (a * a + b * b) * (1 + Fraction(1, 10**20))
    with pytest.raises(nav.NavsymError, match="but 1") as caught:
        disc.step(["9", "9"], t=3)
    assert caught.value.kind == "inconsistent"


def test_gaps_stay_closed_for_many_random_streams_with_blocks_and_gross_errors():
    rng, counted = np.random.default_rng(8), 0
    for _ in range(6):
        norm, shape = NORMS[int(rng.integers(3))]
        target, most = str(rng.choice(["x", "turn"])), int(rng.integers(1, 3))
        guard, state = nav.Guard(plane(norm, shape), target, outliers=most, memory=7), rng.uniform(-3, 3, 4)
        bad = set(rng.choice(9, size=most, replace=False).tolist())
        for k in range(9):
            noise = rng.uniform(-1, 1, 3) * [0.4, 0.8, 0.5] * (1 - 1e-6)
            x = state[:2] + k * state[2:]
            z = np.array([*x, state[2] + state[3]]) + noise + (rng.normal(size=3) * 30 if k in bad else 0)
            seen = [j for j in range(3) if rng.random() < 0.9]
            found = guard.step({f"z{j + 1}": float(z[j]) for j in seen}, t=k)
            if found.radius is None:
                continue
            true = {"x": x[0], "turn": state[2] - state[3]}[target]
            assert abs(found.value - true) <= float(found.radius.upper) * (1 + 1e-12)
            assert set(found.excluded) <= {float(e) for e in bad}
            assert found.certificate is None or found.check().accepted
            counted += 1
            assert Fraction(found.radius.upper) - Fraction(found.radius.lower) <= Fraction(found.radius.upper) / 10**12
    assert counted > 20


@pytest.mark.parametrize("blocks", ["abc", nav.Block([["1"]]), [["1"]], None, 5])
def test_what_is_no_list_of_blocks_is_refused(blocks):
    with pytest.raises(nav.NavsymError, match="expected a list of blocks"):
        nav.solve_blocks(blocks, ["1"])


@pytest.mark.parametrize("given", [[["1"]], [["1", "2", "3"]], [["1"], ["2"]], [], 5, [5]])
def test_measurements_that_do_not_fit_the_blocks_are_refused(given):
    found = nav.solve_blocks([nav.Block([["1", "0"], ["0", "1"]])], ["1", "1"])
    assert found.estimate([["1", "2"]]) == 3.0
    with pytest.raises(nav.NavsymError):
        found.estimate(given)


@pytest.mark.parametrize(
    ("blocks", "target", "constraints", "value"),
    [
        (
            [nav.Block([["1/2"]], "5", "linf"), nav.Block([["-2"], ["0"], ["2"]], [[3, 1, 0], [1, 3, -2], [0, -2, 5]])],
            [-1],
            [([[0], [1, -1, 0]], "<=", 0), ([[0], [-1, 0, 1]], "=", 0)],
            10,
        ),
        (
            [
                nav.Block([["1", "0"]]),
                nav.Block([["0", "0"]], ["5"]),
                nav.Block([["0", "-1"], ["2", "3"]], ["1/4", "5"]),
                nav.Block([["0", "0"]], ["1/4"], "linf"),
            ],
            [0, 1],
            [([[0], [0], [0, -1], [-1]], "<=", -1), ([[0], [1], [-1, 0], [-1]], "<=", 0)],
            Fraction(1, 2),
        ),
        (
            [
                nav.Block([[2, 1, 3, 0], [-1, 1, 0, 0]], 1, "l1"),
                nav.Block([["1/2", -1, 1, 0]], 5, "linf"),
                nav.Block([[3, 2, -1, 1], [2, 2, 3, 3], [2, 3, -1, 0]], "1/4"),
            ],
            [1, 1, 2, 0],
            [],
            Fraction(2, 3),
        ),
    ],
)
def test_weights_that_are_zero_at_the_optimum_leave_no_gap_and_break_no_constraint(blocks, target, constraints, value):
    found = nav.solve_blocks(blocks, target, constraints=constraints)
    lower, upper = Fraction(found.value.lower), Fraction(found.value.upper)
    assert lower <= value <= upper and upper - lower <= value * Fraction(1, 10**20) and found.check()


@pytest.mark.parametrize("digits", [16, 27])
def test_rows_that_doubles_do_not_tell_apart_have_two_bounds_that_meet(digits):
    small = Fraction(1, 10**digits)
    found = nav.solve_blocks([nav.Block([[1, 1], [1, 1 + small]])], [1, 0])
    lower, upper = Fraction(found.value.lower), Fraction(found.value.upper)
    square = (1 + 1 / small) ** 2 + 1 / small**2  # the weights (1 + 1/small, -1/small) are the only ones
    assert lower**2 <= square <= upper**2 and upper - lower <= upper / 10**20 and found.check()


def test_units_of_unknowns_that_are_far_apart_leave_no_gap():
    blocks = [nav.Block([[1, 3e15], [0, 6e15]], [2, 1]), nav.Block([[2, 1e15], [-2, 0], [2, 0]], [2, 5, 1])]
    value = nav.solve_blocks(blocks, [1, 1e15]).value
    assert Fraction(value.upper) - Fraction(value.lower) <= Fraction(value.upper) / 10**20
