"""What the paper does not ask: how few measurements are enough, and what is missing when some fail."""

from collections.abc import Sequence
from functools import cache
from itertools import combinations

import flint
import sympy as sp

from navsym.claims import PROVED, Finding, Property, claim
from navsym.models.linear import LinearModel
from navsym.observability.chains import prove_rank
from navsym.observability.sensors import Restoration, restore_observability
from navsym_papers.joint_correction.inertial import EARTH, MU, OMEGA, full_model, joint_model
from navsym_papers.joint_correction.matrices import write_matrix
from navsym_papers.joint_correction.section1_systems import say_ranks, seen_at_once

GENERIC = "all values of mu, omega and u but those of a proper algebraic set"
METHOD = "hidden directions that are exhibited, and minors that are not zero"


@cache
def joint() -> LinearModel:
    """Both groups, (2.6)-(2.9), with all four measurements."""
    return joint_model()


def measured_by(names: Sequence[str]) -> LinearModel:
    """The same model with some of its measurements."""
    model = joint()
    kept = [model.measurements.index(name) for name in names]
    return LinearModel(
        model.F, None, model.H.extract(kept, list(range(model.size))), model.states, measurements=tuple(names)
    )


def hidden(names: Sequence[str]) -> int:
    """How many dimensions some of the measurements never show."""
    return joint().size - prove_rank(measured_by(names)).rank


def others(names: Sequence[str]) -> dict[str, list[sp.Expr]]:
    """The measurements of the model that are not among the names."""
    model = joint()
    rows = zip(model.measurements, model.H.tolist(), strict=True)
    return {name: row for name, row in rows if name not in names}


def found(answer: Restoration, value: object) -> Finding:
    """A value read off an answer whose minimality is proved."""
    assert answer.proved, "a smaller set was not excluded"
    return Finding(value, METHOD, PROVED, scope=GENERIC)


@claim("sensors.one_coordinate")
def one_coordinate_is_enough():
    """With velocity alone four variables are hidden; either coordinate of the position shows all four of them."""
    velocity = ("sigma_c1", "sigma_c2")
    answer = restore_observability(measured_by(velocity), others(velocity))
    finding = found(answer, (answer.unobservable, answer.sets))
    models = [measured_by((*velocity, name)) for name in ("sigma_M1", "sigma_M2")]
    ranks = [(measured_by(velocity), 6), *((model, 10) for model in models)]
    return say_ranks((4, (("sigma_M1",), ("sigma_M2",))), finding, ranks)


@claim("sensors.triples")
def three_of_four_with_both_velocities():
    """Both velocities and one coordinate observe all ten variables; no other three of the four measurements do."""
    names = joint().measurements
    complete = tuple(triple for triple in combinations(names, 3) if not hidden(triple))
    finding = Finding(complete, METHOD, PROVED, scope=GENERIC)
    velocities = ("sigma_c1", "sigma_c2")
    # of the other triples each shows nine
    ranks = [(measured_by(t), 10 if set(velocities) <= set(t) else 9) for t in combinations(names, 3)]
    return say_ranks(((*velocities, "sigma_M1"), (*velocities, "sigma_M2")), finding, ranks)


@claim("sensors.pairs")
def no_two_are_enough():
    """No two of the four measurements observe all ten variables: the pairs hide from one to four."""
    counts = tuple(hidden(pair) for pair in combinations(joint().measurements, 2))
    printed, pairs = (4, 1, 1, 1, 1, 2), combinations(joint().measurements, 2)
    ranks = [(measured_by(pair), 10 - count) for pair, count in zip(pairs, printed, strict=True)]
    return say_ranks(printed, Finding(counts, METHOD, PROVED, scope=GENERIC), ranks)


@claim("sensors.position")
def position_needs_exactly_two_variables():
    """With position alone two measurements are missing, and x_3 and x_6 are the only two variables that will do."""
    model = measured_by(("sigma_M1", "sigma_M2"))
    answer = restore_observability(model)
    both = [model.states.index(name) for name in ("x_3", "x_6")]
    rows = model.F.col_join(model.H)
    symbols = {s.name: [None, None, []] for s in rows.free_symbols}
    still = write_matrix(rows.extract(list(range(rows.rows)), both)), "=", write_matrix(sp.zeros(rows.rows, 2)), symbols
    return say_missing((2, (("x_3", "x_6"),)), found(answer, (answer.needed, answer.sets)), model, both, still)


def say_missing(printed: object, finding: Finding, model: LinearModel, places: list[int], *more: tuple) -> Property:
    """That as many rows are missing as there are places of states, and that these states will do.

    What F and H both send to zero stays where it is and is not seen. Another row sees one dimension of it at most.
    """
    rows = [row for row in (model.F.row(k) for k in range(model.size)) if any(row)]
    seen = LinearModel(model.F, None, model.H.col_join(sp.eye(model.size).extract(places, list(range(model.size)))))
    still = seen_at_once(sp.Matrix.vstack(*rows, model.H))
    return say_ranks(printed, finding, [(still, model.size - len(places)), (seen, model.size)], *more)


@claim("sensors.full")
def complete_model_needs_five():
    """With all constant errors kept and u frozen, five more measurements are needed, and five states will do."""
    model = full_model()
    answer = restore_observability(model)
    places = [model.states.index(name) for name in answer.sets[0]]
    return say_missing((5, 5), found(answer, (answer.needed, answer.fewest)), model, places)


TURNS = 8  # derivatives of the measurements that are taken


def rows_while_turning() -> list[sp.Matrix]:
    """Independent rows of velocity, position and both, with derivatives, while u turns in the frame.

    u' = -mu omega x u makes the model time-varying: a row h is followed by h F + h'. Entries are Taylor coefficients
    at one point, omega constant.
    """
    model = full_model()
    values = dict(zip((MU, *OMEGA), (2, 3, 5, 7), strict=True))
    turn = (-MU * OMEGA.cross(EARTH)).subs(values).jacobian(EARTH)
    series = [sp.Matrix([11, 13, 17])]
    for order in range(TURNS):
        series.append(turn * series[-1] / (order + 1))
    time = sp.Symbol("time")
    path = {**values, **{u: sum(c[k] * time**n for n, c in enumerate(series)) for k, u in enumerate(EARTH)}}

    def expand(entry: sp.Expr) -> list[flint.fmpq]:
        poly = sp.Poly(entry.subs(path), time)
        found = [sp.Rational(poly.coeff_monomial(time**n)) for n in range(TURNS + 1)]
        return [flint.fmpq(int(c.p), int(c.q)) for c in found]

    F = {place: expand(entry) for place, entry in model.F.todok().items()}
    rows = [[expand(entry) for entry in model.H.row(k)] for k in range(model.H.rows)]
    start = [[entry[0] for entry in row] for row in rows]
    for step in range(TURNS):
        length = TURNS - step
        after = []
        for row in rows:
            new = [[(n + 1) * entry[n + 1] for n in range(length)] for entry in row]
            for (i, j), coefficients in F.items():
                for n in range(length):
                    new[j][n] += sum(row[i][m] * coefficients[n - m] for m in range(n + 1))
            after.append(new)
        rows = after
        start += [[entry[0] for entry in row] for row in rows]
    found = []
    for kept in ((0, 1), (2, 3), (0, 1, 2, 3)):
        basis: list[list] = []
        for place, row in enumerate(start):
            wider = [*basis, row]
            if place % 4 in kept and flint.fmpq_mat(
                len(wider), model.size, [x for own in wider for x in own]
            ).rank() == len(wider):
                basis = wider
        found.append(sp.Matrix([[sp.Rational(int(x.p), int(x.q)) for x in row] for row in basis]))
    return found


@claim("sensors.full.turning")
def complete_model_while_turning():
    """With u' = -mu omega x u velocity, position and both show at least 11, 9, 14 of 16 states; frozen 9, 9, 11."""
    scope = "omega constant; measurements with eight derivatives, ranks at one point"
    model, turning = full_model(), rows_while_turning()
    parts = [LinearModel(model.F, None, model.H.extract(list(kept), list(range(16)))) for kept in ((0, 1), (2, 3))]
    frozen = tuple(prove_rank(part).rank for part in (*parts, model))
    printed = (11, 9, 14), (9, 9, 11)
    finding = Finding((tuple(rows.rows for rows in turning), frozen), METHOD, PROVED, scope=scope)
    models = (*map(seen_at_once, turning), *parts, model)
    return say_ranks(printed, finding, zip(models, (*printed[0], *printed[1]), strict=True))
