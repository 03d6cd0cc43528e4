"""A second opinion on the exact kinds, in plain Python: Fractions and dictionaries, no flint, no grammar in common.

An expression becomes a quotient of polynomials over Q in a root of unity, a step with step**2 = 0 and the roots that
it takes; everything else (symbols, pi, exp(i M), exp(M) for the monomials M of arguments, other functions) is sent to a
random rational number. What is equal stays equal, what is not stays so but for a set of points of measure zero.
Arguments of sin, cos and exp have to be polynomials in symbols, reciprocals of symbols allowed.
"""

from __future__ import annotations

import random
import re
from fractions import Fraction
from functools import cache
from math import lcm
from typing import Any

N = 120  # order of the root of unity
Poly = dict[tuple[int, ...], Fraction]  # exponents of the root of unity, the step, the roots -> coefficient


class OutsideError(Exception):
    """Not in the language of the second opinion."""


# -- expressions -----------------------------------------------------------------------------------------------------


def tree(text: str) -> Any:
    """Nested tuples by recursive descent."""
    tokens = [*re.findall(r"\d+\.\d+|\d+|[A-Za-z]\w*|\*\*|\S", text), ""]
    at = 0

    def take(*marks: str) -> str:
        nonlocal at
        token = tokens[at]
        if not marks or token in marks:
            at += 1
            return token
        return ""

    def chain(marks: tuple[str, str], part: Any) -> Any:
        left = part()
        while mark := take(*marks):
            left = (mark, left, part())
        return left

    def total() -> Any:
        return chain(("+", "-"), lambda: chain(("*", "/"), factor))

    def factor() -> Any:
        if take("-"):
            return ("-", Fraction(0), factor())
        if take("+"):
            return factor()
        base = atom()
        return ("**", base, factor()) if take("**") else base

    def atom() -> Any:
        token = take()
        if token == "(":
            inner = total()
        elif token[:1].isdigit():
            return Fraction(token)
        elif not token[:1].isalpha():
            raise OutsideError(text)
        elif not take("("):
            return token
        else:
            inner = (token, total())
        if not take(")"):
            raise OutsideError(text)
        return inner

    found = total()
    if tokens[at]:
        raise OutsideError(text)
    return found


def constant(node: Any) -> Fraction:
    """The rational number of an exponent."""
    if isinstance(node, Fraction):
        return node
    if not isinstance(node, tuple) or node[0] not in "-/" or len(node) < 3:
        raise OutsideError(str(node))
    left, right = constant(node[1]), constant(node[2])
    return left - right if node[0] == "-" else left / right


# -- arguments as polynomials in names ---------------------------------------------------------------------------------

Angle = dict[tuple[tuple[str, int], ...], Fraction]


def angle(node: Any, names: dict[str, Any]) -> Angle:
    if isinstance(node, Fraction):
        return {(): node} if node else {}
    if isinstance(node, str):
        return names.get(f"angle {node}", {((node, 1),): Fraction(1)})
    if node[0] in ("+", "-"):
        return summed(angle(node[1], names), angle(node[2], names), 1 if node[0] == "+" else -1)
    if node[0] == "*":
        return multiplied(angle(node[1], names), angle(node[2], names))
    if node[0] == "/":
        return multiplied(angle(node[1], names), inverted(angle(node[2], names)))
    if node[0] == "**" and constant(node[2]).denominator == 1:
        n, base = int(constant(node[2])), angle(node[1], names)
        base, result = (base if n >= 0 else inverted(base)), {(): Fraction(1)}
        for _ in range(abs(n)):
            result = multiplied(result, base)
        return result
    raise OutsideError(str(node))


def summed(x: Angle, y: Angle, sign: int) -> Angle:
    found = {m: x.get(m, 0) + sign * y.get(m, 0) for m in {**x, **y}}
    return {m: Fraction(c) for m, c in found.items() if c}


def multiplied(x: Angle, y: Angle) -> Angle:
    found: Angle = {}
    for m, c in x.items():
        for n, d in y.items():
            powers = dict(m)
            for name, e in n:
                powers[name] = powers.get(name, 0) + e
            key = tuple(sorted((name, e) for name, e in powers.items() if e))
            found[key] = found.get(key, Fraction(0)) + c * d
    return {m: c for m, c in found.items() if c}


def inverted(x: Angle) -> Angle:
    if len(x) != 1:
        raise OutsideError("an argument divided by a sum")
    ((m, c),) = x.items()
    return {tuple((name, -e) for name, e in m): 1 / c}


# -- numbers -----------------------------------------------------------------------------------------------------------


@cache
def cyclotomic(n: int) -> tuple[int, ...]:
    """Coefficients, lowest first: (z**n - 1) divided by those of the proper divisors."""
    found = [-1] + [0] * (n - 1) + [1]
    for d in (d for d in range(1, n) if n % d == 0):
        divisor, quotient = cyclotomic(d), []
        while len(found) >= len(divisor):
            c = found[-1]
            quotient.append(c)
            for k, e in enumerate(divisor):
                found[len(found) - len(divisor) + k] -= c * e
            found.pop()
        found = quotient[::-1]
    return tuple(found)


class World:
    """Random numbers for everything but the root of unity, the step and the roots."""

    def __init__(self, source: random.Random, units: dict[Any, int]):
        self.source, self.units = source, units
        self.known: dict[Any, Any] = {}
        self.roots: list[tuple[int, Poly]] = []  # (q, radicand), the root of it is adjoined
        self.finer = False

    def throw(self, key: Any) -> Fraction:
        if key not in self.known:
            sign = self.source.choice((-1, 1))
            self.known[key] = Fraction(sign * self.source.randint(2, 999), self.source.randint(1, 9))
        return self.known[key]

    def times(self, x: Poly, y: Poly) -> Poly:
        """Product, reduced: step**2 = 0, root**q = radicand, the powers of the root of unity below N."""
        found: Poly = {}
        extra: list[Poly] = []
        for m, c in x.items():
            for n, d in y.items():
                e = [a + b for a, b in zip(pad(m, len(self.roots)), pad(n, len(self.roots)), strict=True)]
                if e[1] > 1:
                    continue
                e[0] %= N
                over = next((k for k in reversed(range(len(self.roots))) if e[k + 2] >= self.roots[k][0]), None)
                if over is None:
                    found[tuple(e)] = found.get(tuple(e), Fraction(0)) + c * d
                else:
                    e[over + 2] -= self.roots[over][0]
                    extra.append(self.times({tuple(e): c * d}, self.roots[over][1]))
        for part in extra:
            found = plus(found, part)
        return {m: c for m, c in found.items() if c}

    def zero(self, x: Poly) -> bool:
        """Remainder by the cyclotomic polynomial, for each power of the step and the roots."""
        groups: dict[tuple[int, ...], list[Fraction]] = {}
        for m, c in x.items():
            row = groups.setdefault(pad(m, len(self.roots))[1:], [Fraction(0)] * N)
            row[m[0]] += c
        phi = cyclotomic(N)
        for row in groups.values():
            while len(row) >= len(phi):
                c = row.pop()
                for k, e in enumerate(phi[:-1]):
                    row[len(row) - len(phi) + 1 + k] -= c * e
        return not any(any(row) for row in groups.values())

    def unity(self, turns: Fraction) -> Poly:
        if (turns * N).denominator != 1:
            raise OutsideError(f"{turns} turns")
        return {(int(turns * N) % N, 0): Fraction(1)}

    def exponential(self, kind: str, x: Angle) -> Poly:
        """exp(i x) or exp(x), at t + step when the argument has a derivative there."""
        result: Poly = {(0, 0): Fraction(1)}
        for m, c in x.items():
            if kind == "cis" and m == (("pi", 1),):
                result = self.times(result, self.unity(c / 2))
                continue
            unit = self.units.get((kind, m), 1)
            if (c * unit).denominator != 1:
                self.units[kind, m] = lcm(unit, c.denominator)
                self.finer = True
                continue
            powers = dict(m)
            value: Poly = {(0, 0): self.throw((kind, tuple(p for p in m if p[0] != "+step"))) ** int(c * unit)}
            if "+step" in powers:
                rest = {(0, 1): c * self.monomial({n: e for n, e in powers.items() if n != "+step"})}
                small = self.times(rest, self.unity(Fraction(1, 4))) if kind == "cis" else rest
                value = plus({(0, 0): Fraction(1)}, small) if powers["+step"] == 1 else {(0, 0): Fraction(1)}
            result = self.times(result, value)
        return result

    def monomial(self, powers: dict[str, int]) -> Fraction:
        value = Fraction(1)
        for name, e in powers.items():
            value *= self.throw(name) ** e
        return value


def pad(m: tuple[int, ...], roots: int) -> tuple[int, ...]:
    return m + (0,) * (roots + 2 - len(m))


def plus(x: Poly, y: Poly, sign: int = 1) -> Poly:
    size = max([len(m) for m in (*x, *y)], default=2)
    found: Poly = {}
    for part, s in ((x, 1), (y, sign)):
        for m, c in part.items():
            found[pad(m, size - 2)] = found.get(pad(m, size - 2), Fraction(0)) + s * c
    return {m: c for m, c in found.items() if c}


# -- values ------------------------------------------------------------------------------------------------------------

ONE: Poly = {(0, 0): Fraction(1)}
DERIVED = {
    "tan": "sin(x)/cos(x)",
    "cot": "cos(x)/sin(x)",
    "sec": "1/cos(x)",
    "csc": "1/sin(x)",
    "sinh": "(exp(x) - exp(-x))/2",
    "cosh": "(exp(x) + exp(-x))/2",
    "tanh": "(exp(x) - exp(-x))/(exp(x) + exp(-x))",
}


def value(node: Any, names: dict[str, Any], world: World) -> tuple[Poly, Poly]:
    """Numerator and denominator; a denominator that is a rational number is divided out."""
    top, bottom = quotient(node, names, world)
    if len(bottom) == 1 and not any(next(iter(bottom))):
        return {m: c / next(iter(bottom.values())) for m, c in top.items()}, ONE
    return top, bottom


def quotient(node: Any, names: dict[str, Any], world: World) -> tuple[Poly, Poly]:
    if isinstance(node, Fraction):
        return ({(0, 0): node} if node else {}), ONE
    if isinstance(node, str):
        if node != "pi" and node not in names:
            raise OutsideError(node)
        return names.get(node) or ({(0, 0): world.throw(node)}, ONE)
    if len(node) == 2:
        return called(node[0], node[1], names, world)
    if node[0] == "**":
        return power(value(node[1], names, world), constant(node[2]), world)
    (a, b), (c, d) = value(node[1], names, world), value(node[2], names, world)
    if node[0] in ("+", "-"):
        sign = 1 if node[0] == "+" else -1
        if b == d:
            return plus(a, c, sign), b
        return plus(world.times(a, d), world.times(c, b), sign), world.times(b, d)
    if node[0] == "*":
        return world.times(a, c), world.times(b, d)
    if world.zero(c):
        raise ZeroDivisionError
    return world.times(a, d), world.times(b, c)


def called(name: str, argument: Any, names: dict[str, Any], world: World) -> tuple[Poly, Poly]:
    if name in DERIVED:
        return value(put(tree(DERIVED[name]), argument), names, world)
    if name == "sqrt":
        return power(value(argument, names, world), Fraction(1, 2), world)
    if name == "exp":
        return world.exponential("exp", angle(argument, names)), ONE
    if name in ("sin", "cos"):
        x = angle(argument, names)
        up, down = (world.exponential("cis", {m: s * c for m, c in x.items()}) for s in (1, -1))
        i = world.unity(Fraction(1, 4))
        both = plus(up, down) if name == "cos" else world.times(i, plus(down, up, -1))
        return {m: c / 2 for m, c in both.items()}, ONE
    if name not in ("log", "atan", "asin", "acos"):
        raise OutsideError(name)
    return {(0, 0): world.throw((name, str(sorted(angle(argument, names).items()))))}, ONE


def put(node: Any, argument: Any) -> Any:
    """The tree with the argument in the place of x."""
    return argument if node == "x" else tuple(put(part, argument) for part in node) if isinstance(node, tuple) else node


def power(x: tuple[Poly, Poly], q: Fraction, world: World) -> tuple[Poly, Poly]:
    a, b = x
    if q < 0:
        if world.zero(a):
            raise ZeroDivisionError
        a, b, q = b, a, -q
    top, bottom = ONE, ONE
    if q.denominator == 1:
        for _ in range(int(q)):
            top, bottom = world.times(top, a), world.times(bottom, b)
        return top, bottom
    n = q.denominator
    inner = world.times(a, power((b, ONE), Fraction(n - 1), world)[0])  # root(a/b) = root(a b**(n-1))/b
    return power((root(inner, n, world), b), Fraction(q.numerator), world)


def root(x: Poly, n: int, world: World) -> Poly:
    """An n-th root of a polynomial: of a rational number by primes, of anything else adjoined."""
    if set(x) <= {pad((0, 0), len(m) - 2) for m in x} and x:
        c = next(iter(x.values()))
        result: Poly = {(0, 0): Fraction(1)}
        for part, sign in ((abs(c.numerator), 1), (c.denominator, -1)):
            for prime, e in factors(part):
                result = world.times(result, prime_root(prime, n, sign * e, world))
        return result if c > 0 else world.times(result, adjoined({(0, 0): Fraction(-1)}, n, world))
    return adjoined(x, n, world)


def factors(n: int) -> list[tuple[int, int]]:
    found, p = [], 2
    while n > 1:
        e = 0
        while n % p == 0:
            n, e = n // p, e + 1
        found += [(p, e)] if e else []
        p = p + 1 if p * p <= n or p < 3 else max(n, p + 1)
        if p > 10**5:
            found += [(n, 1)] if n > 1 else []
            break
    return found


def prime_root(p: int, n: int, e: int, world: World) -> Poly:
    """p**(e/n); sqrt 2 = 2 cos(pi/4), sqrt 3 = 2 cos(pi/6), sqrt 5 = 4 cos(pi/5) - 1."""
    whole, rest = divmod(Fraction(e, n), 1)
    result: Poly = {(0, 0): Fraction(p) ** int(whole)}
    if rest == Fraction(1, 2) and p in (2, 3, 5):
        turns = {2: Fraction(1, 8), 3: Fraction(1, 12), 5: Fraction(1, 10)}[p]
        twice = plus(world.unity(turns), world.unity(-turns))
        surd = twice if p < 5 else plus({m: 2 * c for m, c in twice.items()}, ONE, -1)
        return world.times(result, surd)
    base = adjoined({(0, 0): Fraction(p)}, rest.denominator, world) if rest else ONE
    for _ in range(rest.numerator):
        result = world.times(result, base)
    return result


def adjoined(x: Poly, n: int, world: World) -> Poly:
    for k, (q, radicand) in enumerate(world.roots):
        if q == n and world.zero(plus(radicand, x, -1)):
            return {(0, 0, *(int(j == k) for j in range(len(world.roots)))): Fraction(1)}
    world.roots.append((n, x))
    return {(0, 0, *([0] * (len(world.roots) - 1)), 1): Fraction(1)}


# -- the kinds ---------------------------------------------------------------------------------------------------------


def equal(x: tuple[Poly, Poly], y: tuple[Poly, Poly], world: World) -> bool:
    return world.zero(plus(world.times(x[0], y[1]), world.times(y[0], x[1]), -1))


def accepted(item: dict[str, Any], seed: int = 0) -> bool:
    """The second opinion on an identity, an exponential or a rank."""
    test = {"identity": identity, "exponential": exponential, "rank": rank}[item["kind"]]
    units: dict[Any, int] = {}
    while True:
        world = World(random.Random(seed), units)
        answer = bool(test(item, world))
        if not world.finer:
            return answer


def identity(item: dict[str, Any], world: World) -> bool:
    names = dict.fromkeys(item["symbols"])
    left, right = (value(tree(item[side]), names, world) for side in ("left", "right"))
    return equal(left, right, world)


def exponential(item: dict[str, Any], world: World) -> bool:
    t, n, names = item["variable"], len(item["matrix"]), dict.fromkeys(item["symbols"])
    A, X = ([[tree(e) for e in row] for row in item[key]] for key in ("matrix", "solution"))
    moving = {
        t: ({(0, 0): world.throw(t), (0, 1): Fraction(1)}, ONE),
        f"angle {t}": {((t, 1),): Fraction(1), (("+step", 1),): Fraction(1)},
    }
    here, then = ([[value(e, names | extra, world) for e in row] for row in X] for extra in ({t: None}, moving))
    still = {t: ({}, ONE), f"angle {t}": {}}
    for i, j in ((i, j) for i in range(n) for j in range(n)):
        expected = here[i][j]
        for k in range(n):
            a, b = value(A[i][k], names, world)
            top = world.times({(0, 1): Fraction(1)}, world.times(a, here[k][j][0]))
            bottom = world.times(b, here[k][j][1])
            expected = (
                plus(world.times(expected[0], bottom), world.times(top, expected[1])),
                world.times(expected[1], bottom),
            )
        start = value(X[i][j], names | still, world)
        unit = {(0, 0): Fraction(1)} if i == j else {}
        if not equal(then[i][j], expected, world) or not equal(start, (unit, ONE), world):
            return False
    return True


def rank(item: dict[str, Any], world: World) -> bool:
    names = dict.fromkeys(item["symbols"])
    A, V = ([[value(tree(e), names, world) for e in row] for row in item[key]] for key in ("matrix", "null"))
    n = len(A[0])
    if len(V) != n - item["rank"] or len(item["rows"]) != item["rank"]:
        return False
    for a in A:
        for v in V:
            total: tuple[Poly, Poly] = ({}, ONE)
            for (p, q), (r, s) in zip(a, v, strict=True):
                top, bottom = world.times(p, r), world.times(q, s)
                total = plus(world.times(total[0], bottom), world.times(top, total[1])), world.times(total[1], bottom)
            if not world.zero(total[0]):
                return False
    return True  # whether the rows are independent at the point is a question for the balls
