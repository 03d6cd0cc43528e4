"""Ranks of models in time, in pieces and nonlinear ones, against the numerical rank of their flow at 60 digits."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import sympy as sp
from tests.observability.flows import rank_in_time, rank_of_flow, rank_of_pieces

import navsym as nav
from navsym.core.errors import DomainError, DuplicateError, UnknownSymbolError
from navsym.core.rational_functions import factor_exactly

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
    answer = nav.observe(
        nav.Model(names, dynamics=[text(t.items()) for t in f], H=[text(t.items()) for t in z])
    )
    start = [Fraction(source.randrange(-40, 40), 37) for _ in range(n)]
    assert answer.rank == rank_of_flow(f, z, start, TIMES), seed


@pytest.mark.parametrize("check", [check_in_time, check_pieces, check_nonlinear])
def test_the_rank_is_that_of_the_flow(check):
    for seed in range(35):
        check(seed)


@pytest.mark.long
@pytest.mark.parametrize("check", [check_in_time, check_pieces, check_nonlinear])
def test_the_rank_is_that_of_the_flow_for_many_models(check):
    for seed in range(1000, 1100):
        check(seed)
