"""Random relations between rational functions of one symbol, and their truth by another program.

The truth comes from sympy's own isolation of real roots (Vincent, Akritas and Strzebonski): the ends of the range
are added as roots, and exact values between neighbours decide. Run as a script it compares many of them.

    python tests/prove/one_symbol.py SEED COUNT
"""

from __future__ import annotations

import itertools
import random
import sys
import time
from dataclasses import dataclass

import sympy as sp

from navsym.claims import CERTIFIED, PROVED, REFUTED, Bound, Equation
from navsym.prove.ladder import decide

RELATIONS = (">=", ">=", ">=", "<=", ">", ">", "<", "!=", "!=", "=")
HOLDS = {
    "<": lambda s: s < 0,
    "<=": lambda s: s <= 0,
    ">": lambda s: s > 0,
    ">=": lambda s: s >= 0,
    "!=": lambda s: s != 0,
    "=": lambda s: s == 0,
}


@dataclass(frozen=True)
class Case:
    """``left relation right`` for a symbol in [lower, upper]; None is infinity."""

    left: sp.Expr
    relation: str
    right: sp.Expr
    symbol: sp.Symbol
    lower: sp.Rational | None
    upper: sp.Rational | None

    @property
    def statement(self) -> Equation | Bound:
        box = {self.symbol: (self.lower, self.upper)}
        if self.relation == "=":
            return Equation(self.left, self.right, box)
        return Bound(self.left, self.relation, self.right, box)


def truth(case: Case) -> bool | None:
    """Whether the relation holds wherever both sides exist; None when they exist nowhere."""
    x = case.symbol
    top, bottom = (sp.Poly(part, x) for part in sp.fraction(sp.together(case.left - case.right)))
    for side in (case.left, case.right):  # the difference may have cancelled a pole of both
        bottom *= sp.Poly(sp.fraction(sp.together(side))[1], x)
        top *= sp.Poly(sp.fraction(sp.together(side))[1], x)
    ends = [sp.Integer(0)] if x.is_nonnegative or x.is_nonzero else []
    ends += [end for end in (case.lower, case.upper) if end is not None]
    factors = {sp.Poly(x - end, x, domain="QQ") for end in ends}
    known = [factor for part in (top, bottom) if not part.is_zero for factor, _ in part.factor_list()[1]]
    factors |= {sp.Poly(factor.as_expr(), x, domain="QQ").monic() for factor in known}
    places = isolated(sorted(factors, key=str))
    between = [(left[1] + right[0]) / 2 for left, right in itertools.pairwise(places)]
    outside = [places[0][0] - 1, places[-1][1] + 1] if places else [sp.Integer(0)]
    holds = HOLDS[case.relation]
    inside = [point for point in (*between, *outside) if belongs(case, point)]
    good = [holds(sp.sign(top.eval(point) * bottom.eval(point))) for point in inside]
    for low, high in places:
        if not roots_between(bottom, low, high) and place_belongs(case, low, high, ends):
            good.append(holds(0) if roots_between(top, low, high) else holds(sign_near(top, bottom, low, high)))
    return all(good) if good else None


def isolated(factors: list[sp.Poly]) -> list[tuple[sp.Rational, sp.Rational]]:
    """Disjoint intervals with one root each of irreducible polynomials."""
    found = [[low, high, factor] for factor in factors for (low, high), _ in factor.intervals()]
    while True:
        found.sort(key=lambda item: (item[0], item[1]))
        meeting = [(one, two) for one, two in itertools.pairwise(found) if one[1] >= two[0]]
        if not meeting:
            return [(low, high) for low, high, _ in found]
        for item in itertools.chain(*meeting):
            low, high, factor = item
            middle = (low + high) / 2
            if low < high:
                item[0 if factor.eval(middle) * factor.eval(low) > 0 else 1] = middle


def sign_near(top: sp.Poly, bottom: sp.Poly, low: sp.Rational, high: sp.Rational) -> sp.Integer:
    """Sign at a place where neither vanishes."""
    middle = (low + high) / 2
    return sp.sign(top.eval(middle) * bottom.eval(middle))


def roots_between(polynomial: sp.Poly, low: sp.Rational, high: sp.Rational) -> bool:
    return polynomial.is_zero or bool(polynomial.degree() > 0 and polynomial.count_roots(low, high))


def belongs(case: Case, point: sp.Rational) -> bool:
    """True for a rational number of the range."""
    low, high = case.lower, case.upper
    declared = not (case.symbol.is_positive and point <= 0) and not (case.symbol.is_nonnegative and point < 0)
    declared = declared and not (case.symbol.is_nonzero and point == 0)
    return declared and (low is None or point >= low) and (high is None or point <= high)


def place_belongs(case: Case, low: sp.Rational, high: sp.Rational, ends: list[sp.Rational]) -> bool:
    """True for the root between two numbers: an end of the range is one itself, else any number there tells."""
    here = [end for end in ends if low <= end <= high]
    return belongs(case, here[0] if here else (low + high) / 2)


# -- random cases ---------------------------------------


def random_case(generator: random.Random) -> Case:
    """Near misses, touching from above and below, poles, ranges that end at roots."""
    word = generator.choice(("real", "real", "real", "positive", "nonnegative", "nonzero"))
    x = sp.Symbol("x", real=True, **({} if word == "real" else {word: True}))
    roots = [small(generator) for _ in range(4)]
    top = sp.prod([factor(generator, x, roots) for _ in range(generator.randint(1, 4))])
    if generator.random() < 0.5:  # mostly true, and false by little
        top = top**2 + generator.choice((0, 0, 1, -1)) * tiny(generator) ** 2
    top = generator.choice((top, top, sp.expand(top), sp.expand(top) + generator.choice((1, -1)) * tiny(generator)))
    bottom = sp.prod([factor(generator, x, roots) for _ in range(generator.choice((0, 0, 1, 2)))])
    bottom = generator.choice((bottom, sp.expand(bottom), bottom**2))
    other = generator.choice((sp.Integer(0), x, small(generator), x**2, 1 / (x - roots[0]), 1 / (x**2 + 1)))
    lower, upper = random_range(generator, roots)
    sign = generator.choice((1, 1, -1))
    return Case(sign * top / bottom + other, generator.choice(RELATIONS), other, x, lower, upper)


def random_range(generator: random.Random, roots: list[sp.Rational]) -> tuple[sp.Rational | None, sp.Rational | None]:
    """Nothing, a half line or an interval, often with an end at or next to a root."""

    def end() -> sp.Rational:
        root = generator.choice(roots)
        return generator.choice((root, root, small(generator), root + tiny(generator), root - tiny(generator)))

    kind = generator.choice(("all", "all", "from", "to", "both", "both"))
    low, high = sorted((end(), end()))
    high = high if low < high else low + 1
    if high <= 0:
        low, high = -high, -low  # also for what is declared positive
    low = low if low < high else high - 1
    high = max(high, sp.Rational(1, 7))
    return (low if kind in ("from", "both") else None), (high if kind in ("to", "both") else None)


def small(generator: random.Random) -> sp.Rational:
    q = generator.choice((1, 1, 2, 3, 7, 60))
    return sp.Rational(generator.randint(-4 * q, 4 * q), q)


def tiny(generator: random.Random) -> sp.Rational:
    return sp.Rational(1, 10 ** generator.choice((1, 3, 6, 9, 12, 18, 24, 30)))


def factor(generator: random.Random, x: sp.Symbol, roots: list[sp.Rational]) -> sp.Expr:
    """Something with known, near, irrational or no real roots."""
    a, b, e = generator.choice(roots), generator.choice(roots), tiny(generator)
    return generator.choice(
        (
            x - a,
            x - a,
            (x - a) ** 2,
            (x - a) ** 3,
            (x - a) * (x - a - e),
            (x - a) ** 2 + e,
            (x - a) ** 2 - e,
            x**2 + a * x + b,
            x**2 - 2,
            x**2 - 2 - e,
            x**3 - x - 1,
            (x**3 - x - 1) ** 2,
            x**5 - x + a,
            x**2 + x + 1,
            x,
            (x**2 - 2) ** 2,
            (x**2 - 2) * (x - a),
            x**4 - a * x**2 + b**2,
            sp.expand((x - a) ** 2 * (x - b) ** 2) + e,
        )
    )


def verdict_against(case: Case) -> tuple[str, bool | None, str]:
    """Status, truth, and what is wrong; empty when nothing is."""
    verdict, true = decide(case.statement), truth(case)
    wrong = true is not (verdict.status != REFUTED) if verdict.status in (PROVED, CERTIFIED, REFUTED) else False
    undecided = verdict.status not in (PROVED, CERTIFIED, REFUTED) and true is not None
    return str(verdict.status), true, "false" if wrong else "undecided" if undecided else ""


def main(seed: int, count: int) -> None:
    """Compare many cases, and print what is wrong."""
    generator, counts, start = random.Random(seed), dict[str, int](), time.process_time()
    for number in range(count):
        case = random_case(generator)
        began = time.process_time()
        status, true, wrong = verdict_against(case)
        seconds = time.process_time() - began
        key = f"{status} of {'true' if true else 'false' if true is not None else 'empty'}"
        counts[key] = counts.get(key, 0) + 1
        if wrong or seconds > 10:
            print(number, wrong, f"{seconds:.1f} s", status, true, case, flush=True)
    print(counts, f"{time.process_time() - start:.0f} s", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
