"""The atlas: cells are what is computed, ranks are those of textbook equations, and published statements hold."""

from __future__ import annotations

import importlib
import random
import re
import sys
import time
from pathlib import Path

import pytest
import sympy as sp
from flint import nmod_mat

import navsym as nav
from navsym.core.errors import NavsymError
from navsym.models.linear import LinearModel
from navsym.observability.chains import generic_rank, moving_rows
from navsym.report.atlas_page import atlas_pages
from navsym.report.explain import WORDS
from navsym.report.page import MARKS, environment
from navsym.studies.atlas.published import PUBLISHED
from navsym.studies.atlas.scenes import cell_names, model_of
from tests.report.test_page import Reading
from tests.studies.atlas_cells import compute_cell

DOCS = Path(__file__).parents[2] / "docs"
QUICK = (
    "INS: rest: position",
    "INS: rest: bearing to a beacon",  # conditions without real points are not listed
    "INS: straight: velocity",
    "INS: level turn: position",
    "VIO: rest: a known landmark",
)


def test_the_atlas_has_its_cells_in_order():
    listed = [name for name in cell_names() if name in nav.atlas]
    assert list(nav.atlas) == listed
    assert len(nav.atlas) >= 60


@pytest.mark.parametrize("name", QUICK)
def test_a_cell_is_what_is_computed(name):
    assert compute_cell(name) == nav.atlas[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", list(nav.atlas))
def test_every_cell_is_what_is_computed_within_a_minute(name):
    start = time.process_time()
    assert compute_cell(name) == nav.atlas[name]
    assert time.process_time() - start < 60


@pytest.mark.parametrize("statement", PUBLISHED, ids=lambda statement: statement.text[:50])
def test_published_statements_hold(statement):
    assert statement.holds(nav.atlas)


def test_the_page_of_the_atlas_is_up_to_date():
    sys.path.insert(0, str(DOCS))
    try:
        page = importlib.import_module("atlas_table").page()
    finally:
        sys.path.remove(str(DOCS))
    assert (DOCS / "atlas.md").read_text(encoding="utf-8") == "\n".join(page).rstrip("\n") + "\n"


def test_the_page_of_the_report_shows_every_cell_once_and_closes_its_tags():
    ((_, text),) = atlas_pages(environment().get_template, {"marks": MARKS, "meanings": WORDS["meaning"]})
    page = Reading(text)
    assert not page.crossed and not page.open
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    assert {a["href"][1:] for _, a in page.elements if a.get("href", "").startswith("#c-")} <= set(ids)
    assert all(text.count(f"<h3>{name}</h3>") == 1 for name in nav.atlas)


def test_an_unknown_name_of_a_catalogue_gives_the_default_where_one_is_asked_for():
    assert nav.atlas.get("unknown") is None and nav.book.get("unknown", 7) == 7
    assert nav.book.get("transport-rate") is nav.book["transport-rate"]


def test_a_name_that_is_no_cell_is_refused():
    with pytest.raises(NavsymError, match="did you mean INS: rest: position"):
        nav.atlas["INS: rest: positions"]


#: Cells and those of their conditions that set single symbols to zero.
PLAIN = [
    (name, condition, rank)
    for name, cell in nav.atlas.items()
    for condition, rank in cell.drops.items()
    if rank is not None and all(re.fullmatch(r"\w+ = 0", part) for part in condition.split(" and "))
]


def hold_on(name: str, condition: str, rank: int) -> None:
    """Where a condition holds from the beginning, the rank is the one that is listed."""
    model = model_of(name)
    zeros = {sp.Symbol(part[:-4], real=True): 0 for part in condition.split(" and ")}
    there = model.at(zeros)
    rows = [k for k in range(there.H.rows) if any(x != 0 for x in there.H[k, :])]
    rates = {s: rate for s, rate in there.rates.items() if s not in zeros}
    if not rows:
        assert rank == 0
        return
    H = there.H.extract(rows, list(range(there.size)))
    motion, listed = moving_rows(LinearModel(there.F, None, H, there.states, (), there.time, rates))
    assert generic_rank([row for row, _ in listed], motion)[0] == rank


@pytest.mark.parametrize(("name", "condition", "rank"), PLAIN[::25])
def test_the_rank_on_a_drop_is_the_listed_one(name, condition, rank):
    hold_on(name, condition, rank)


@pytest.mark.long
def test_the_rank_on_every_plain_drop_is_the_listed_one():
    for name, condition, rank in PLAIN:
        hold_on(name, condition, rank)


# Ranks of textbook equations: errors in the frame, power series of the sensitivity from t = 0, modulo a prime


PRIME, ORDER = 2**61 - 1, 70
Series = list[int]


def add(*terms: Series) -> Series:
    return [sum(x) % PRIME for x in zip(*terms, strict=True)]


def times(a: Series, b: Series) -> Series:
    return [sum(a[i] * b[k - i] for i in range(k + 1) if a[i] and b[k - i]) % PRIME for k in range(ORDER)]


def minus(a: Series) -> Series:
    return [-x % PRIME for x in a]


def line(*values: int) -> Series:
    return [*(x % PRIME for x in values), *[0] * (ORDER - len(values))]


def derive(a: Series) -> Series:
    return [(k * a[k]) % PRIME for k in range(1, ORDER)] + [0]


def integrate(a: Series, start: int) -> Series:
    return [start % PRIME, *(a[k] * pow(k + 1, -1, PRIME) % PRIME for k in range(ORDER - 1))]


def sine_and_cosine(rate: Series) -> tuple[Series, Series]:
    """Sine and cosine of an angle with this rate that starts at zero."""
    s, c = line(0), line(1)
    for k in range(ORDER - 1):
        share = pow(k + 1, -1, PRIME)
        s[k + 1] = sum(c[i] * rate[k - i] for i in range(k + 1)) * share % PRIME
        c[k + 1] = -sum(s[i] * rate[k - i] for i in range(k + 1)) * share % PRIME
    return s, c


def product(A, B):
    return [
        [add(*(times(a, b) for a, b in zip(row, column, strict=True))) for column in zip(*B, strict=True)] for row in A
    ]


def transpose(A):
    return [list(row) for row in zip(*A, strict=True)]


def skew(v):
    zero = line(0)
    return [[zero, minus(v[2]), v[1]], [v[2], zero, minus(v[0])], [minus(v[1]), v[0], zero]]


def negative(A):
    return [[minus(x) for x in row] for row in A]


def column(v):
    return [[x] for x in v]


def motion(name: str, draw):
    """Velocity in the frame and attitude along a manoeuvre, as series."""
    zero, w = line(0), line(draw())
    heading, roll = zero, zero
    if name == "level turn" or name == "rotation about the vertical":
        heading = w
    if name.startswith("figure eight"):  # w'' = -k w
        heading = line(draw(), draw())
        k = draw()
        for j in range(ORDER - 2):
            heading[j + 2] = -k * heading[j] * pow((j + 1) * (j + 2), -1, PRIME) % PRIME
    if name == "rotation about a level axis":
        roll = w
    if name == "rotation about two axes":
        heading, roll = w, line(draw())
    if name == "figure eight with changing bank":
        roll = line(draw())
    (s, c), (S, K) = sine_and_cosine(heading), sine_and_cosine(roll)
    one = line(1)
    C = product(
        [[c, minus(s), zero], [s, c, zero], [zero, zero, one]], [[one, zero, zero], [zero, K, minus(S)], [zero, S, K]]
    )
    speed = line(draw())
    velocity = [zero] * 3
    if name == "level turn" or name.startswith("figure eight"):
        velocity = [times(speed, c), times(speed, s), zero]
    if name in ("straight", "climb"):
        velocity = [line(draw()), line(draw()), line(draw()) if name == "climb" else zero]
    if name == "accelerated":
        velocity = [line(draw(), draw()), line(draw(), draw()), zero]
    return velocity, C


def reference_rank(cell: str, seed: int) -> int:
    """Rank of the textbook error equations along the manoeuvre."""
    model, name, aiding = cell.split(": ")
    source = random.Random(seed)
    draw = lambda: source.randrange(2, PRIME)  # noqa: E731
    velocity, C = motion(name, draw)
    zero, one = line(0), line(1)
    earth = [line(draw()), zero, line(draw())] if model == "INS" else [zero] * 3
    W, Ct = skew(earth), transpose(C)
    count = 3 if "three" in aiding else 1
    known = "known landmark" in aiding
    n = (
        15
        + (3 if aiding.endswith("unknown lever arm") else 0)
        + (0 if model == "INS" else 7 + (0 if known else 3 * count))
    )
    F = [[zero] * n for _ in range(n)]

    def put(rows, i, j, target):
        for a, row in enumerate(rows):
            for b, x in enumerate(row):
                target[i + a][j + b] = x

    twice = [add(x, x) for x in earth]
    coriolis = [row[0] for row in product(skew(twice), column(velocity))]
    force = [add(derive(v), x) for v, x in zip(velocity, coriolis, strict=True)]
    force[2] = add(force[2], minus(line(draw())))
    unit = [[one if i == j else zero for j in range(3)] for i in range(3)]
    put(unit, 0, 3, F)
    put(negative(skew(twice)), 3, 3, F)
    put(negative(skew(force)), 3, 6, F)
    put(negative(C), 3, 12, F)
    put(negative(W), 6, 6, F)
    put(negative(C), 6, 9, F)
    rows = []

    def measure(blocks):
        height = len(blocks[0][1])
        H = [[zero] * n for _ in range(height)]
        for place, block in blocks:
            put(block, 0, place, H)
        rows.extend(H)

    arm = [line(draw()) for _ in range(3)]
    moved = [row[0] for row in product(C, column(arm))]
    path = [integrate(v, 0) for v in velocity]
    away = [[add(line(draw()), minus(p)) for p in path] for _ in range(count)]
    if aiding.startswith("position") or aiding.endswith("and position"):
        lever = "lever" in aiding
        measure([(0, unit), *([(6, negative(skew(moved)))] if lever else []), *([(15, C)] if n == 18 else [])])
    if aiding == "velocity" or aiding.endswith("and velocity"):
        measure([(3, unit)])
    if aiding == "body velocity":
        measure([(3, Ct), (6, product(Ct, skew(velocity)))])
    if aiding.endswith("magnetic field"):
        measure([(6, product(Ct, skew([line(draw()) for _ in range(3)])))])
    if aiding == "range to a beacon":
        measure([(0, [[minus(x) for x in away[0]]])])
    if aiding == "bearing to a beacon":
        b, seen = away[0], product(Ct, column(away[0]))
        measure([(0, product(directions(seen), negative(Ct))), (6, product(directions(seen), product(Ct, skew(b))))])
    if model == "VIO":
        for k, b in enumerate(away):
            c = [[add(x[0], minus(y))] for x, y in zip(product(Ct, column(b)), arm, strict=True)]
            P = directions(c)
            blocks = [(0, negative(Ct)), (6, product(Ct, skew(b))), (15, skew([x[0] for x in c])), (18, negative(unit))]
            blocks += [(21, [[derive(x[0])] for x in c])] + ([] if known else [(22 + 3 * k, Ct)])
            measure([(place, product(P, block)) for place, block in blocks])
    return rank_of_series(F, rows, n)


def directions(c):
    """c3 dc1 - c1 dc3 and c3 dc2 - c2 dc3."""
    (x,), (y,), (z,) = c
    return [[z, line(0), minus(x)], [line(0), z, minus(y)]]


def rank_of_series(F, rows, n: int) -> int:
    """Rank of the coefficients of h(t) X(t), X' = F X; the last ones are left out, which derivatives do not have."""

    def matrices(A):
        return {
            k: nmod_mat(len(A), n, [x[k] for row in A for x in row], PRIME)
            for k in range(ORDER)
            if any(x[k] for row in A for x in row)
        }

    steps, shown = matrices(F), matrices(rows)
    X = [nmod_mat(n, n, [int(i == j) for i in range(n) for j in range(n)], PRIME)]
    zero = nmod_mat(n, n, [0] * n * n, PRIME)
    for k in range(ORDER - 1):
        X.append(sum((steps[j] * X[k - j] for j in steps if j <= k), zero) * pow(k + 1, -1, PRIME))
    empty = nmod_mat(len(rows), n, [0] * n * len(rows), PRIME)
    listed = [sum((shown[j] * X[k - j] for j in shown if j <= k), empty).tolist() for k in range(ORDER - 2)]
    return nmod_mat([[int(x) for x in row] for block in listed for row in block], PRIME).rank()


SAMPLE = [name for k, name in enumerate(nav.atlas) if k % 9 == 4]


@pytest.mark.parametrize("name", SAMPLE)
def test_ranks_are_those_of_textbook_equations(name):
    assert nav.atlas[name].rank == reference_rank(name, 3)


@pytest.mark.long
def test_all_ranks_are_those_of_textbook_equations():
    ranks = {name: cell.rank for name, cell in nav.atlas.items()}
    assert ranks == {name: reference_rank(name, 4) for name in ranks}
