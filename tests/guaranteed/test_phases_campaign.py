"""Random small families: what their regimes say agrees with certified solutions of single values."""

from __future__ import annotations

import os
import random
from collections import Counter

import pytest
import sympy as sp

from navsym.core.balls import enclose
from navsym.core.errors import NavsymError
from navsym.core.exact import from_decimal
from navsym.guaranteed.phases.answer import Phases, Regime
from navsym.guaranteed.phases.driver import find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import model_from
from tests.guaranteed.phases_cover import lost

FUNCTIONS = ("1", "u", "u**2", "sin(u)", "cos(u)", "sin(2*u)", "exp(-u)", "u*exp(-u)", "cos(3*u)")
#: Values at which every family is looked at, and families of one run.
VALUES = 50
FAMILIES = int(os.environ.get("NAVSYM_PHASES_FAMILIES", "4"))


def random_family(rng: random.Random):
    """Two or three functions, the parameter in the functional, a noise bound, a frequency, or the length."""
    H = rng.sample(FUNCTIONS, rng.choice((2, 3)))
    P = [str(rng.randint(-3, 3)) for _ in H]
    P[rng.randrange(len(P))] = "2"
    basis = {"variable": "u", "H": H, "interval": ["0", str(rng.choice(("1", "3/2", "3")))]}
    kind, ends = rng.choice((("functional", (-2, 2)), ("sigma", (1, 3)), ("frequency", (1, 2)), ("length", (1, 4))))
    if kind == "functional":
        P[rng.randrange(len(P))] = "1+p/3"
    elif kind == "sigma":
        basis["H"] = [H, rng.sample(FUNCTIONS, len(H))]
        basis["sigma"] = ["1", "p"]
    elif kind == "frequency":
        basis["H"] = [*H[:-1], "sin(p*u)"]
    else:
        basis["interval"] = ["0", "p"]
    document = {"basis": basis, "parameters": {"p": [str(e) for e in ends]}, "targets": {"c": P}}
    return document, sp.Integer(ends[0]), sp.Integer(ends[1])


def bounds_at(answer: Phases, p: sp.Rational) -> list[tuple[sp.Rational, sp.Rational]]:
    """Every enclosure that the answer proves for the optimum at a value: closed forms, slivers."""
    found = []
    for regime in answer.regimes:
        if regime.closed is not None and inside(regime, p):
            ball = enclose(regime.closed.value.subs(answer.family.parameter, p), bits=200)
            found.append((rational(ball.lower()), rational(ball.upper())))
        for s in regime.slivers:
            if s.start <= from_decimal(str(p.p)) / int(p.q) <= s.end:
                found.append((sp.Rational(s.lower), sp.Rational(s.upper)))
        found += [ends for c in regime.certificates for ends in ranges(c, p)]
    return found


def inside(regime: Regime, p: sp.Rational) -> bool:
    return bool(enclose(p - regime.lower) > 0) and bool(enclose(regime.upper - p) > 0)


def rational(ball) -> sp.Rational:
    mantissa, exponent = ball.mid().man_exp()
    return sp.Rational(int(mantissa)) * sp.Integer(2) ** int(exponent)


def ranges(certificate, p):
    """Bounds of range certificates of the problem itself; those of scaled problems are for another value."""
    if certificate["kind"] == "range" and sp.Rational(certificate["from"]) <= p <= sp.Rational(certificate["to"]):
        yield sp.Rational(certificate["lower"]), sp.Rational(certificate["upper"])


def contradictions(seed: int) -> Counter:
    """Counts of values at which the answer agrees, says nothing, or contradicts a certified solution."""
    rng, count = random.Random(seed), Counter()
    document, lower, upper = random_family(rng)
    try:
        family = family_of(model_from(document), "c", "p")
        answer = find_phases(family, lower, upper)
    except NavsymError as error:
        return Counter({f"refused: {error.kind}": 1})
    for _ in range(VALUES):
        p = lower + (upper - lower) * sp.Rational(rng.randrange(1, 10**6), 10**6)
        found = solve(family.problem(p), digits=12)
        low, high = sp.Rational(found.lower), sp.Rational(found.upper)
        said = bounds_at(answer, p)
        agree = all(a <= high and low <= b for a, b in said)
        count["agrees" if said and agree else "silent" if agree else "CONTRADICTS"] += 1
    count["uncovered"] += len(answer.uncovered)
    count["LOST"] += len(lost(answer))
    return count


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(FAMILIES))
def test_regimes_never_contradict_single_values(seed):
    count = contradictions(seed)
    assert count["CONTRADICTS"] == count["LOST"] == 0


if __name__ == "__main__":
    total: Counter = Counter()
    for seed in range(FAMILIES):
        one = contradictions(seed)
        total += one
        print(seed, dict(one), flush=True)
    print("all", dict(total))
