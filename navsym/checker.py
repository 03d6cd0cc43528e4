"""Independent checker of navsym's certificates: standard library and python-flint, nothing of navsym.

A certificate is a JSON object; numbers are decimals or fractions in strings, expressions are texts, floats are refused.
Expressions: + - * / ** (rational exponent), pi, symbols, sin cos tan cot sec csc sinh cosh tanh exp log atan sqrt, exact ones
also asin acos abs, and the entire functions f_k(x) = (f(x) - Taylor polynomial of degree < k) / x**k of f = exp, sin, cos for
k = 0 .. 99 (by balls: |x| <= 1 only). Kinds, and what is verified:

identity     left, right, symbols: left = right wherever both are defined.
exponential  matrix A, solution X, variable t, symbols: X' = A X and X(0) = I, hence X = exp(A t).
rank         matrix M (p, n), symbols, rank r, point, rows, null: M v = 0 identically for the n - r vectors v of null; at the
             rational point these and the r rows of M are independent: hence rank M = r wherever they are.
positivity   expression, box {symbol: [from, to]}, bits, cells: expression > 0 on the box, by halving.
all          of: every certificate of the list holds.
The optimum: minimise sum sigma |w_i| subject to sum w_i H(t_i) = P (functional) over all finite sets of places on the panels
[{measurement, from, to, sigma, H}]. A place is a fraction v of its panel, t = from + (to - from) v. Below q = H/sigma, W = sigma w.
gap          dual x with |x.q| < 1 on all panels: lower <= x.P is a bound. support [[panel, v]], one place for each unknown: the
             linear system for W is regular and sum |W_i| <= upper. So the optimum lies in [lower, upper].
sliver       gap for every value of the parameter in [from, to].
touch        dual x, contacts [{panel, at, end, sign, weight}], radius: Krawczyk's test finds exactly one zero of F = gradient of
             sum W_i (x.q(v_i) - s_i) - x.P in the box around (x; v_i = at where end = "no"; W_i = weight). There s_i W_i > 0,
             places are inside, and |x.q| < 1 elsewhere: the optimum is x.P, and no other estimator reaches it.
range        touch for every value p of the parameter in [from, to]; ends, sigma, H and P may depend on it. pieces [{from, to, basis,
             dual, contacts, radius}] tile [from, to]: H and P are multiplied by the regular matrix basis, unknowns are polynomials
             in s (lists of coefficients, of one number in a touch), p = (from + to)/2 + s (to - from)/2, |s| <= 1.
Bounds of f = x.q on a cell: Taylor's formula; near an exact contact f is concave or monotone up to the end of the panel. Other cells
are halved, 4 cells + 200 in all. For all |s| <= 1: f(0) + s f'(0) + s s f''(of any s)/2.
"""
# ruff: noqa: E501

from __future__ import annotations

import ast
import json
import re
from collections.abc import Callable
from functools import reduce
from math import comb, factorial, prod
from typing import Any

from flint import Ordering, arb, arb_mat, arb_series, ctx, fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpz_poly


class Refused(Exception):
    """The certificate does not prove what it says."""

def need(condition: Any, why: str) -> None:
    if not bool(condition):
        raise Refused(why)

# -- reading -----------------------------------------------------------------------------------------------------------
def load(text: str) -> Any:
    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        need(len(dict(pairs)) == len(pairs), "duplicate key")
        return dict(pairs)
    refuse = lambda _: need(False, "a float; numbers are strings")  # noqa: E731
    try:
        return json.loads(text, object_pairs_hook=unique, parse_float=refuse, parse_constant=refuse)
    except (ValueError, RecursionError) as error:
        raise Refused(f"not JSON: {error}") from None

def fields(item: Any, names: str) -> list[Any]:
    need(isinstance(item, dict) and set(item) == set(names.split()), f"expected exactly the keys {names}")
    return [item[name] for name in names.split()]

def array(item: Any, read: Any, size: int | None = None) -> list[Any]:
    need(isinstance(item, list) and size in (None, len(item)), f"expected {size or 'a list of'} entries")
    return [read(entry) for entry in item]

def whole(item: Any, low: int, high: int) -> int:
    need(type(item) is int and low <= item <= high, f"expected an integer from {low} to {high}")
    return int(item)

def label(item: Any) -> str:
    need(isinstance(item, str), "expected a text")
    return str(item)

def number(item: Any) -> fmpq:
    found = re.fullmatch(r"(-?[0-9]{1,4000})(?:\.([0-9]{1,4000})|/([1-9][0-9]{0,99}))?", label(item))
    need(found, "not a number")
    head, tail, under = found.groups("")  # type: ignore[union-attr]
    return fmpq(int(head + tail), 10 ** len(tail) * int(under or 1))

def parse(text: Any) -> ast.expr:
    """Numbers and names become identifiers N_1_5, V_x of our own, so that Python's grammar sees nothing else."""
    mark = lambda found: f" {'N' if found[0][0].isdigit() else 'V'}_{found[0].replace('.', '_')} "  # noqa: E731
    need(re.fullmatch(r"[A-Za-z0-9_+\-*/(). ]{1,100000}", label(text)), f"unexpected characters in {text[:60]!r}")
    try:
        return ast.parse(re.sub(r"[0-9]+(\.[0-9]+)?|[A-Za-z][A-Za-z0-9_]*", mark, text).strip(), mode="eval").body
    except (SyntaxError, MemoryError) as error:
        raise Refused(f"not an expression: {text[:60]!r}") from error

DERIVED = {"tan": "sin(x)/cos(x)", "cot": "cos(x)/sin(x)", "sec": "1/cos(x)", "csc": "1/sin(x)", "sqrt": "x**(1/2)",
           "sinh": "(exp(x) - exp(-x))/2", "cosh": "(exp(x) + exp(-x))/2", "tanh": "1 - 2/(exp(2*x) + 1)"}

def value(node: Any, names: dict[str, Any], algebra: Any) -> Any:
    """The value of an expression in an algebra: Exact, Balls, or Rational for exponents."""
    match node:
        case ast.Name(name) if name.startswith("N_"):
            return algebra.number(number(name[2:].replace("_", ".")))
        case ast.Name(name):
            need(name == "V_pi" or name[2:] in names, f"unknown name {name[2:]}")
            return algebra.pi() if name == "V_pi" else names[name[2:]]
        case ast.UnaryOp(ast.UAdd() | ast.USub() as sign, x):
            return algebra.number(fmpq(1 if isinstance(sign, ast.UAdd) else -1)) * value(x, names, algebra)
        case ast.Call(ast.Name(name), [argument], []):
            x, rule = value(argument, names, algebra), DERIVED.get(name[2:])
            return value(parse(rule), {"x": x}, algebra) if rule else algebra.apply(name[2:], x)
        case ast.BinOp(x, ast.Pow(), q):
            return algebra.power(value(x, names, algebra), value(q, {}, Rational))
        case ast.BinOp(left, ast.Add() | ast.Sub() | ast.Mult() | ast.Div() as sign, right):
            x, y = value(left, names, algebra), value(right, names, algebra)
            if isinstance(sign, ast.Mult | ast.Div):
                return x * (y if isinstance(sign, ast.Mult) else algebra.inverse(y))
            return x + (y if isinstance(sign, ast.Add) else algebra.number(fmpq(-1)) * y)
    raise Refused("not an expression")

class Rational:
    number, inverse = staticmethod(lambda q: q), staticmethod(lambda q: 1 / q)

def kernel(name: str) -> tuple[str, int, Callable[[int], fmpq]]:
    """f, k and the Taylor coefficients of f for the name "f_k"."""
    f, _, k = name.partition("_")
    need(f in ("exp", "sin", "cos") and re.fullmatch("[0-9]{1,2}", k), f"function {name}")
    signs = {"exp": (1, 1, 1, 1), "sin": (0, 1, 0, -1), "cos": (1, 0, -1, 0)}[f]
    return f, int(k), lambda n: fmpq(signs[n % 4], factorial(n))

# -- exact algebra -----------------------------------------------------------------------------------------------------
class Finer(Exception):
    """Start again with other roots of the generators, or with more of them."""

class Exact:
    """Polynomials over Q in generators made when they are met: symbols, pi, step, roots, reciprocals, exp M and exp i M ("cis")
    for the monomials M of arguments, other functions of an argument. Each relation, scale g**n = older generators, eliminates
    one, newer ones lead: what is reduced to zero vanishes wherever nothing is divided by zero."""
    def __init__(self, unit: int, size: int):
        self.unit, self.known, self.relations = unit, dict[str, Any](), list[tuple[int, int, Any, Any]]()
        self.ring = fmpq_mpoly_ctx.get([f"g{k}" for k in reversed(range(size))], Ordering.lex)
        self.one, self.turn = self.ring.constant(1), f"cis {self.pi()}"
        self.step = self.generator("step", lambda g: (2, self.one, g**2))
        cyclotomic = fmpz_poly.cyclotomic(2 * unit).coeffs()
        self.generator(self.turn, lambda g: (1, self.one, sum(c * g**k for k, c in enumerate(cyclotomic))))
        self.i = self.exponent(self.turn, fmpq(1, 2))
    def number(self, q: fmpq) -> Any:
        return self.ring.constant(q)
    def pi(self) -> Any:
        return self.generator("pi")
    def generator(self, key: str, relation: Any = None) -> Any:
        if key not in self.known:
            place = self.ring.nvars() - 1 - len(self.known)
            if place < 0:
                raise Finer(self.unit, 2 * self.ring.nvars())
            self.known[key] = self.ring.gen(place)
            self.relations += [(place, *relation(self.known[key]))] if relation else []
        return self.known[key]
    def exponent(self, key: str, q: fmpq, relation: Any = None) -> Any:
        """key**q, from the generator key**(1/unit)."""
        if (q * self.unit).q > 1:
            raise Finer(self.unit * int((q * self.unit).q), self.ring.nvars())
        g = self.generator(key, relation)
        return (g if q > 0 else self.generator(f"1/({g})", lambda h: (1, g, g * h - 1))) ** abs(int(q * self.unit))
    def reduced(self, x: Any) -> Any:
        """A remainder of x, equal to x."""
        return reduce(lambda y, relation: divmod(y, relation[3])[1], reversed(self.relations), x)
    def fraction(self, x: Any) -> tuple[Any, Any]:
        """x as a quotient: reciprocals are cleared, other generators with a relation are left below its degree."""
        top, bottom = x, self.one
        for place, n, scale, relation in reversed(self.relations):
            k = max(0, *(p.degrees()[place] // n for p in (top, bottom))) if scale != 1 else 0
            top, bottom = (divmod(p * scale**k, relation)[1] for p in (top, bottom))
            common = top.gcd(bottom)
            top, bottom = top / common, bottom / common
        return top, bottom
    def equal(self, x: Any, y: Any, why: str) -> None:
        (a, b), (c, d) = self.fraction(x), self.fraction(y)
        need(self.reduced(a * d - b * c) == 0, why)
    def inverse(self, x: Any) -> Any:
        need(self.fraction(x)[0] != 0, "division by zero")
        x = self.reduced(x)
        c = x.leading_coefficient()
        return (self.generator(f"1/({x / c})", lambda g: (1, x / c, x / c * g - 1)) if x != c else self.one) / c
    def power(self, x: Any, q: fmpq) -> Any:
        if q.q == 1:
            need(abs(q) * len(str(x)) < 10**6, "too large a power")
            return (x if q > 0 else self.inverse(x)) ** abs(int(q))
        x = self.reduced(x)
        need(self.fraction(x)[0] != 0, "root of zero")
        c = abs(x.leading_coefficient())
        need(c.p * c.q < 2**100, "root of a large number")
        parts = [self.surd(int(p), q * e) for p, e in [*c.p.factor(), *((p, -e) for p, e in c.q.factor())]]
        return prod(parts, start=self.one if x == c else self.root(x / c, q))
    def root(self, x: Any, q: fmpq) -> Any:
        return self.exponent(f"root {x}", q, lambda g: (self.unit, self.one, g**self.unit - x))
    def surd(self, n: int, q: fmpq) -> Any:
        """n**q for a prime n; 4 sqrt(n) = (1 - i) sum of exp(2 pi i k k/(4 n)), k < 4 n (Gauss)."""
        if q.q == 1 or (q.q == 2 and n in (2, 3, 5)):
            gauss = sum(self.exponent(self.turn, fmpq(k * k % (4 * n), 2 * n)) for k in range(4 * n)) if q.q == 2 else 0
            return (gauss * (1 - self.i) / 4 if q.q == 2 else 1) * self.number(fmpq(n) ** int((q - fmpq(int(q.q) - 1, 2)).p))
        return self.root(self.number(fmpq(n)), q)
    def exponential(self, kind: str, x: Any, sign: int = 1) -> Any:
        """exp(sign x) or "cis" exp(sign i x): a product over the monomials of x."""
        result, step = self.one, self.ring.nvars() - 2
        for exponents, c in self.reduced(x).to_dict().items():
            M = self.ring.from_dict({exponents: 1})
            result *= self.exponent(f"{kind} {M}", c * sign) if not exponents[step] else 1 + sign * c * M * (self.i if kind == "cis" else 1)
        return result
    def apply(self, name: str, x: Any) -> Any:
        if name == "exp":
            return self.exponential("exp", x)
        if name in ("sin", "cos"):
            up, down = self.exponential("cis", x), self.exponential("cis", x, -1)
            return (up + down) / 2 if name == "cos" else self.i * (down - up) / 2
        if name in ("log", "atan", "asin", "acos", "abs"):
            return self.power(x * x, fmpq(1, 2)) if name == "abs" else self.generator(f"{name} {self.reduced(x)}")
        f, k, taylor = kernel(name)
        return (self.apply(f, x) - sum(taylor(j) * x**j for j in range(k))) * self.inverse(x) ** k

def exactly(symbols: Any, test: Callable[[Exact, dict[str, Any]], None]) -> None:
    """Run a test in an algebra; again in a finer or larger one when it asks for that."""
    names, unit, size = array(symbols, label), 1, 8
    need(len(set(names)) == len(names), "a symbol named twice")
    while unit <= 5040 and size <= 1024:
        try:
            algebra = Exact(unit, size)
            return test(algebra, {s: algebra.generator(f"symbol {s}") for s in names})
        except Finer as error:
            unit, size = error.args
    raise Refused("too many generators")

def identity(item: Any) -> None:
    _, left, right, symbols = fields(item, "kind left right symbols")
    sides = parse(left), parse(right)
    exactly(symbols, lambda algebra, names: algebra.equal(*(value(s, names, algebra) for s in sides), "the sides differ"))  # type: ignore[call-arg]

def products(A: Any, B: Any) -> Any:
    return [[sum(a * b for a, b in zip(row, column, strict=True)) for column in zip(*B, strict=True)] for row in A]

def matrix_exponential(item: Any) -> None:
    """X(t + step) = X(t) + step A X(t) modulo step**2, X(0) = I."""
    _, A, X, t, symbols = fields(item, "kind matrix solution variable symbols")
    n = len(array(A, list))
    need(label(t) not in array(symbols, label), "the variable is not a symbol")
    F, S = (array(table, lambda row: array(row, parse, n), n) for table in (A, X))
    def test(algebra: Exact, names: dict[str, Any]) -> None:
        at = lambda M, t_: [[value(e, names | t_, algebra) for e in row] for row in M]  # noqa: E731
        now = algebra.generator("now")
        start, here, then = at(S, {t: algebra.number(fmpq(0))}), at(S, {t: now}), at(S, {t: now + algebra.step})
        speed = products(at(F, {}), here)
        for i, j in ((i, j) for i in range(n) for j in range(n)):
            algebra.equal(then[i][j], here[i][j] + algebra.step * speed[i][j], "X' differs from A X")
            algebra.equal(start[i][j], algebra.number(fmpq(int(i == j))), "X(0) differs from I")
    exactly(symbols, test)

def rank(item: Any) -> None:
    _, M, symbols, r, point, rows, null = fields(item, "kind matrix symbols rank point rows null")
    n = len(array(M, list)[0])
    A, V = array(M, lambda row: array(row, parse, n)), array(null, lambda v: array(v, parse, n), n - whole(r, 0, n))
    need(isinstance(point, dict) and set(point) == set(array(symbols, label)), "the point gives every symbol")
    here = {s: Jet(arb(number(q))) for s, q in point.items()}
    square = [*(A[whole(k, 0, len(A) - 1)] for k in array(rows, int, r)), *V]
    det = arb_mat([[value(e, here, Balls).parts[0] for e in row] for row in square]).det()
    need(not det.contains(0), "the rows and null vectors may be dependent at the point")
    def test(algebra: Exact, names: dict[str, Any]) -> None:
        B, W = ([[value(e, names, algebra) for e in row] for row in part] for part in (A, V))
        for row in products(B, list(zip(*W, strict=True))):
            for entry in row:
                algebra.equal(entry, algebra.number(fmpq(0)), "M v does not vanish")
    exactly(symbols, test)

# -- balls -------------------------------------------------------------------------------------------------------------
class Jet:
    """a + b s + c s s; the parts are balls, or series of balls in a place."""
    def __init__(self, a: Any, b: Any = 0, c: Any = 0):
        self.parts = a, b, c
    def __add__(self, o: Jet) -> Jet:
        return Jet(*(x + y for x, y in zip(self.parts, o.parts, strict=True)))
    def __mul__(self, o: Jet) -> Jet:
        (a, b, c), (d, e, f) = self.parts, o.parts
        return Jet(a * d, a * e + b * d, a * f + b * e + c * d)

EVERY, ZERO, MINUS = arb(0, 1), Jet(arb(0)), Jet(arb(-1))
FUNCTIONS: dict[str, Callable[[Any], tuple[Any, Any, Any]]] = {  # value, derivative, half the second derivative
    "exp": lambda a: (a.exp(), a.exp(), a.exp() / 2), "sin": lambda a: (a.sin(), a.cos(), -a.sin() / 2),
    "cos": lambda a: (a.cos(), -a.sin(), -a.cos() / 2), "log": lambda a: (a.log(), 1 / a, -1 / (2 * a * a)),
    "atan": lambda a: (a.atan(), 1 / (1 + a * a), -a / (1 + a * a) ** 2), "inverse": lambda a: (1 / a, -1 / (a * a), 1 / (a * a * a))}

class Balls:
    """Rigorous enclosures; NaN, which fails every comparison, where a function may be undefined."""
    number, pi, inverse = (staticmethod(f) for f in (lambda q: Jet(arb(q)), lambda: Jet(arb.pi()), lambda x: Balls.apply("inverse", x)))
    @staticmethod
    def power(x: Jet, q: fmpq) -> Any:
        if q < 0 or q.q > 1:
            return Balls.inverse(Balls.power(x, -q)) if q < 0 else Balls.apply("exp", Balls.apply("log", x) * Jet(arb(q)))
        need(q < 1000, "a large exponent")
        return prod([x] * int(q), start=Jet(arb(1)))
    @staticmethod
    def apply(name: str, x: Jet) -> Jet:
        a, b, c = x.parts
        if name in FUNCTIONS:
            f, g, h = FUNCTIONS[name](a)
            return Jet(f, g * b, g * c + h * b * b)
        _, k, taylor = kernel(name)
        n = 60
        need(abs(a if isinstance(a, arb) else a[0]) <= 1, f"{name} beyond 1")
        # the last coefficient: the sum of binomial(j, n)/(j + k)! over j >= n is at most e/(n + k)!
        return polynomial([*(Jet(arb(taylor(j + k))) for j in range(n)), Jet(EVERY * 3 / factorial(n + k))], x)

def polynomial(c: list[Jet], at: Jet) -> Jet:
    total = ZERO
    for a in reversed(c):
        total = total * at + a
    return total

def cover(box: dict[str, Any], limit: int, passes: Callable[[dict[str, Any]], Any], why: str) -> int:
    """Halve a box of pairs of fractions until all its cells pass; returns what is left of the limit."""
    cells = [box]
    while cells:
        cell, limit = cells.pop(), limit - 1
        need(limit > 0, why)
        if not passes(cell):
            side = max(cell, key=lambda s: cell[s][1] - cell[s][0])
            low, high = cell[side]
            cells += [cell | {side: half} for half in ((low, (low + high) / 2), ((low + high) / 2, high))]
    return limit

def between(low: fmpq, high: fmpq) -> arb:
    return arb(low).union(arb(high))

def positivity(item: Any) -> None:
    _, text, box, bits, cells = fields(item, "kind expression box bits cells")
    ctx.prec, tree = whole(bits, 30, 20000), parse(text)
    ends = {s: array(pair, lambda e: value(parse(e), {}, Balls), 2) for s, pair in box.items()}
    def passes(cell: dict[str, Any]) -> Any:
        return value(tree, {s: a + (b + MINUS * a) * Jet(between(*cell[s])) for s, (a, b) in ends.items()}, Balls).parts[0] > 0
    cover(dict.fromkeys(ends, (fmpq(0), fmpq(1))), 4 * whole(cells, 0, 50000) + 200, passes, "not shown to be positive")

# -- the optimum -------------------------------------------------------------------------------------------------------
def matrix(rows: Any) -> Jet:
    """A jet of matrices from a matrix of jets; their sums and products follow the same rules."""
    return Jet(*(arb_mat([[e.parts[i] for e in row] for row in rows]) for i in range(3)))

def entry(M: Jet, i: int, j: int) -> Jet:
    return Jet(*(part[i, j] for part in M.parts))

def derivatives(away: Jet, n: int) -> Jet:
    """Taylor coefficients 0 .. n - 1 times this matrix: f, f' and f''/2."""
    powers = [Jet(arb(1))]
    for _ in range(n):
        powers.append(powers[-1] * away)
    return matrix([[Jet(arb(comb(k, d))) * powers[max(0, k - d)] for d in range(3)] for k in range(n)])

class Problem:
    """Panels and functional; p = middle + half s is the value of the parameter, half = 0 when there is none to follow."""
    def __init__(self, item: Any, parameter: str = "", middle: Any = 0, half: Any = 0):
        ctx.prec, self.limit = whole(item["bits"], 53, 20000), 4 * whole(item["cells"], 0, 100000) + 200
        self.t, self.P, self.panels = label(item["variable"]), array(item["functional"], parse), []
        self.parameter, self.middle, self.half = parameter, arb(middle), arb(half)
        self.m, self.n = len(self.P), 16
        self.basis = matrix([[Jet(arb(int(i == j))) for i in range(self.m)] for j in range(self.m)])
        for _, *rest, H in array(item["panels"], lambda panel: fields(panel, "measurement from to sigma H")):
            self.panels.append(array(rest, parse) + array(H, parse, self.m))
            low, high, sigma = self.frame(len(self.panels) - 1, EVERY)
            need((high + MINUS * low).parts[0] > 0 and sigma.parts[0] > 0, "noise bound and length are positive")
    def over(self, make: Callable[[arb], Jet]) -> Any:
        """Enclosure for all |s| <= 1 by Taylor's formula."""
        a, b, _ = make(arb(0)).parts
        return a if self.half == 0 else a + b * EVERY + make(EVERY).parts[2] * (EVERY * EVERY)
    def names(self, s: arb) -> dict[str, Jet]:
        return {self.parameter: Jet(self.middle + self.half * s, self.half)}
    def frame(self, panel: int, s: arb) -> list[Jet]:
        return [value(tree, self.names(s), Balls) for tree in self.panels[panel][:3]]
    def target(self, s: arb) -> Jet:
        return self.basis * matrix([[value(p, self.names(s), Balls)] for p in self.P])
    def taylor(self, panel: int, place: arb, s: arb) -> Jet:
        """Row by row the Taylor coefficients of basis q about the middle of a ball of places, the last over the whole ball."""
        ctx.cap, both, (low, high, sigma) = self.n, [], self.frame(panel, s)
        for at in (place.mid(), place):
            names = self.names(s) | {self.t: low + (high + MINUS * low) * Jet(arb_series([at, 1]))}
            q = [value(h, names, Balls) * Balls.inverse(sigma) for h in self.panels[panel][3:]]
            both.append([[part + arb_series([0]) for part in h.parts] for h in q])
        return self.basis * matrix([[Jet(*(part[k] for part in (thin if k < self.n - 1 else wide))) for k in range(self.n)]
                                    for thin, wide in zip(*both, strict=True)])
    def feasible(self, panel: int, x: Callable[[arb], Jet], contacts: list[tuple[arb, int, str]]) -> None:
        """|f| < 1 on a panel off the contacts, f = x.q."""
        def passes(cell: dict[str, Any]) -> bool:
            low, high = map(arb, cell["place"])
            near = [c for c in contacts if abs(2 * c[0].mid() - low - high) < 2 * (high - low)][:1]
            centre = near[0][0].mid() if near else ((low + high) / 2).mid()
            r = max([abs(centre - low), abs(centre - high), *(c[0].rad() for c in near)]).upper()
            c = self.over(lambda s: x(s) * self.taylor(panel, arb(centre, r), s)).entries()
            rest = [sum((comb(k, d) * c[k].abs_upper() * r ** (k - d) for k in range(d + 1, self.n)), arb(0)) for d in range(3)]
            if not near:
                return bool(abs(c[0]) + rest[0] < 1)
            _, sign, end = near[0]
            outward = sign * c[1] * {"from": -1, "to": 1, "no": 0}[end]
            concave = sign * c[2] + rest[2] < 0 and (end == "no" or outward > 0)
            return bool(rest[0] - sign * c[0] < 1 and (concave or outward > rest[1]))
        self.limit = cover({"place": (fmpq(0), fmpq(1))}, self.limit, passes, "|x.H| <= sigma is not shown")

def gap(item: Any) -> None:
    moving = " parameter from to" if item["kind"] == "sliver" else ""
    *_, dual, support, lower, upper = fields(item, f"kind variable panels functional bits cells{moving} dual support lower upper")
    problem = Problem(item, label(item["parameter"]), between(number(item["from"]), number(item["to"]))) if moving else Problem(item)
    x, P = matrix([array(dual, lambda e: Jet(arb(number(e))), problem.m)]), problem.target(arb(0))
    for panel in range(len(problem.panels)):
        problem.feasible(panel, lambda s: x, [])
    need(arb(number(lower)) <= (x * P).parts[0][0, 0], "the lower bound is above x.P")
    places = [(whole(k, 0, len(problem.panels) - 1), number(v)) for k, v in array(support, list, problem.m)]
    need(all(0 <= v <= 1 for _, v in places), "a place outside its panel")
    columns = [[row[0] for row in problem.taylor(k, arb(v), arb(0)).parts[0].tolist()] for k, v in places]
    w = arb_mat(columns).transpose().solve(P.parts[0])
    need(sum(map(abs, w.entries()), arb(0)) <= arb(number(upper)), "the weights cost more than the upper bound")

def contacts_hold(problem: Problem, piece: Any) -> arb:
    """Krawczyk's test, then |f| < 1 off the contacts; the value x.P."""
    rows = array(piece["contacts"], lambda c: fields(c, "panel at end sign weight"))
    m, l = problem.m, len(rows)
    panels, signs, ends = [whole(r[0], 0, len(problem.panels) - 1) for r in rows], [whole(r[3], -1, 1) for r in rows], [r[2] for r in rows]
    need(all(row[2] == "no" or row[1] == [] for row in rows), "an end has no place of its own")
    curve = lambda c: array(c, lambda e: Jet(arb(number(e))))  # noqa: E731
    places = [curve(row[1]) if row[2] == "no" else [Jet(arb({"from": 0, "to": 1}[row[2]]))] for row in rows]
    curves = [*array(piece["dual"], curve, m), *places, *(curve(row[4]) for row in rows)]
    free = [k for k in range(m + 2 * l) if not m <= k < m + l or ends[k - m] == "no"]
    radius = dict(zip(free, array(piece["radius"], lambda e: arb(number(e)), len(free)), strict=True))
    need(all(signs) and all(r > 0 for r in radius.values()), "signs and radii are not zero")

    def unknowns(s: arb, shift: dict[int, arb]) -> list[Jet]:
        return [polynomial(c, Jet(s, arb(1))) + Jet(shift.get(k, arb(0))) for k, c in enumerate(curves)]

    def system(s: arb, shift: dict[int, arb]) -> Jet:
        """F, and behind it its derivatives."""
        z, P = unknowns(s, shift), problem.target(s)
        F, J = [MINUS * entry(P, j, 0) for j in range(m)] + [ZERO] * (2 * l), [[ZERO] * len(z) for _ in z]
        for i, v, k in zip(range(l), range(m, m + l), range(m + l, m + 2 * l), strict=True):
            D = derivatives(z[v] + Jet(-z[v].parts[0].mid()), problem.n)
            taylor = problem.taylor(panels[i], z[v].parts[0], s)
            q, f = taylor * D, matrix([z[:m]]) * taylor * D
            F[v], F[k] = z[k] * entry(f, 0, 1), entry(f, 0, 0) + Jet(arb(-signs[i]))
            J[v][v], J[v][k], J[k][v] = Jet(arb(2)) * z[k] * entry(f, 0, 2), entry(f, 0, 1), entry(f, 0, 1)
            for j in range(m):
                F[j] += z[k] * entry(q, j, 0)
                J[j][k], J[k][j], J[j][v], J[v][j] = [entry(q, j, 0)] * 2 + [z[k] * entry(q, j, 1)] * 2
        return matrix([[F[i], *(J[i][k] for k in free)] for i in free])
    n, box = len(free), {k: EVERY * r for k, r in radius.items()}
    F = problem.over(lambda s: system(s, {})).tolist()
    J = arb_mat([row[1:] for row in problem.over(lambda s: system(s, box)).tolist()])
    Y, unit = J.mid().inv().mid(), arb_mat(n, n, [int(i == k) for i in range(n) for k in range(n)])
    move = (unit - Y * J) * arb_mat([[r] for r in box.values()]) - Y * arb_mat([row[:1] for row in F])
    need(all(abs(d) < r for d, r in zip(move.entries(), radius.values(), strict=True)), "Krawczyk's test fails")
    shift = dict(zip(free, move.entries(), strict=True))  # the image of the box is a better box
    z = problem.over(lambda s: matrix([unknowns(s, shift)])).entries()
    need(all(signs[i] * z[m + l + i] > 0 for i in range(l)), "a weight of the wrong sign")
    need(all(z[m + i] > 0 and z[m + i] < 1 for i in range(l) if ends[i] == "no"), "a contact outside its panel")
    dual = lambda s: matrix([unknowns(s, shift)[:m]])  # noqa: E731
    for panel in range(len(problem.panels)):
        problem.feasible(panel, dual, [(z[m + i], signs[i], ends[i]) for i in range(l) if panels[i] == panel])
    return problem.over(lambda s: dual(s) * problem.target(s))[0, 0]  # type: ignore[no-any-return]

def touch(item: Any) -> None:
    *_, lower, upper = fields(item, "kind variable panels functional bits cells dual contacts radius lower upper")
    total = contacts_hold(Problem(item), item)
    need(arb(number(lower)) <= total and total <= arb(number(upper)), "the optimum is not between the bounds")

def range_of(item: Any) -> None:
    *_, parameter, low, high, pieces = fields(item, "kind variable panels functional bits cells parameter from to pieces")
    edge, limit = number(low), 0
    for piece in array(pieces, dict):
        a, b, basis, *_ = fields(piece, "from to basis dual contacts radius")
        need(number(a) == edge < number(b), "the pieces leave a hole")
        edge, A = number(b), array(basis, lambda row: array(row, number))
        need(fmpq_mat(A).det() != 0, "a singular basis")
        problem = Problem(item, label(parameter), arb((number(a) + edge) / 2), arb((edge - number(a)) / 2))
        problem.basis, problem.limit = matrix([[Jet(arb(q)) for q in row] for row in A]), limit or problem.limit
        contacts_hold(problem, piece)
        limit = problem.limit
    need(edge == number(high), "the pieces do not reach the end")

KINDS: dict[str, Callable[[Any], Any]] = {
    "identity": identity, "exponential": matrix_exponential, "rank": rank, "positivity": positivity, "gap": gap,
    "sliver": gap, "touch": touch, "range": range_of, "all": lambda item: array(fields(item, "kind of")[1] or None, check)}

def check(item: Any) -> str:
    """The kind of a certificate that holds; raises Refused with the reason otherwise."""
    kind = label(item.get("kind") if isinstance(item, dict) else None)
    need(kind in KINDS, "expected a certificate of a known kind")
    before, ctx.prec = (ctx.prec, ctx.cap), 128
    try:
        KINDS[kind](item)
    except (ArithmeticError, RecursionError, ValueError, TypeError, KeyError, IndexError, AttributeError) as error:
        raise Refused(f"{type(error).__name__}: {error}") from None
    finally:
        ctx.prec, ctx.cap = before
    return kind
