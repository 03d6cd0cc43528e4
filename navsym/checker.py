"""Independent checker of navsym's certificates: standard library and python-flint, nothing of navsym.

A certificate is a JSON object; numbers are decimals or fractions in strings, expressions are texts, floats are refused.
Expressions: + - * / ** (rational exponent), pi, symbols, sin cos tan cot sec csc sinh cosh tanh exp log atan asin acos
sqrt abs, and the entire functions f_k(x) = (f(x) - its Taylor polynomial of degree < k) / x**k of f = exp, sin, cos for
k = 0 .. 99 (by balls: |x| <= 1 only). Kinds, each with exactly these keys beside "kind", and what is verified:

identity     left, right, symbols: left = right for all real symbols for which both are defined.
exponential  matrix A, solution X, variable t, symbols: X' = A X and X(0) = I, hence X = exp(A t) as far from t = 0 as X
             is defined.
rank         matrix M (p, n), symbols, rank r, point, rows, null: M v = 0 identically for the n - r vectors v of null;
             at the rational point these and the r rows of M are independent: hence rank M = r wherever they are.
positivity   expression, box {symbol: [from, to]}, bits, cells: expression > 0 on the box, by halving.
all          of: every certificate of the list holds.

The optimum: minimise sum sigma |w_i| subject to sum w_i H(t_i) = P over all finite sets of places on the panels. It is
between lower and upper for every value p of the parameter from .. to, on which all the rest may depend. Keys: variable,
panels [{measurement, from, to, sigma, H}], functional P, bits, cells, parameter, from, to, lower, upper. A place is a
fraction v of its panel, t = from + (to - from) v. Below q = H/sigma, W = sigma w, f = x.q with a dual x.
gap, sliver  dual, support [[panel, v]], one place for each unknown: |f| < 1 on all panels and lower <= x.P; the linear
             system for W is regular and sum |W_i| <= upper.
touch, range pieces [{from, to, basis, dual, contacts [{panel, at, weight}], radius}] that tile from .. to. In a piece
             p = (from + to)/2 + s (to - from)/2, H and P are multiplied by the regular matrix basis, and unknowns are
             polynomials in s (lists of coefficients). at = ["0"], ["1"] are the ends of the panel; s_i is the sign of
             weight at s = 0. For all |s| <= 1 Krawczyk's test finds exactly one zero of F = gradient of sum W_i (f(v_i)
             - s_i) - x.P in the box of this radius around (x; v_i that are no ends; W_i). There s_i W_i > 0, places are
             inside, and |f| < 1 elsewhere: the optimum is x.P, and no other estimator reaches it.
Bounds of f on a cell: Taylor's formula; near a contact f is concave or monotone up to the end of the panel. Other cells
are halved, 4 cells + 200 in all (cells bits <= 4 * 10**7). For all |s| <= 1: f(0) + s f'(0) + s s f''(of any s)/2.
"""

from __future__ import annotations

import ast
import json
import operator
import re
from collections.abc import Callable
from fractions import Fraction
from functools import reduce
from math import comb, factorial, gcd, lcm, prod
from typing import Any

from flint import arb, arb_mat, arb_series, ctx, fmpq, fmpq_mat, fmpq_poly, fmpz_poly


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

def distinct(item: Any) -> list[str]:
    names = array(item, label)
    need(all(re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name) for name in names), "expected names")
    need(len({"pi", *names}) == len(names) + 1, "a name given twice, or pi")
    return names

def number(item: Any) -> fmpq:
    need(re.fullmatch(r"-?[0-9]{1,4000}([./][0-9]{1,4000})?", label(item)), "not a number")
    return fmpq(*Fraction(item).as_integer_ratio())

def parse(text: Any) -> ast.expr:
    """Numbers and names become identifiers N_1_5, V_x of our own, so that Python's grammar sees nothing else."""
    mark = lambda found: f" {'N' if found[0][0].isdigit() else 'V'}_{found[0].replace('.', '_')} "  # noqa: E731
    need(re.fullmatch(r"[A-Za-z0-9_+\-*/(). ]{1,100000}", label(text)), f"unexpected characters in {text[:60]!r}")
    try:
        return ast.parse(re.sub(r"[0-9]+(\.[0-9]+)?|[A-Za-z][A-Za-z0-9_]*", mark, text).strip(), mode="eval").body
    except (SyntaxError, MemoryError) as error:
        raise Refused(f"not an expression: {text[:60]!r}") from error

# -- values ------------------------------------------------------------------------------------------------------------
class Jet:
    """a + b s + c s s, s**3 = 0; a constant has the integers b = c = 0. Parts are balls, series of balls in a place
    with coefficients [k], or Exact."""
    def __init__(self, a: Any, b: Any = 0, c: Any = 0):
        self.parts = a, b, c
    def __add__(self, o: Jet) -> Jet:
        return Jet(*(x + y for x, y in zip(self.parts, o.parts, strict=True)))
    def __mul__(self, o: Jet) -> Jet:
        (a, b, c), (d, e, f) = self.parts, o.parts
        if type(e) is int:
            return Jet(a * d) if type(b) is int else Jet(a * d, b * d, c * d)
        return Jet(a * d, a * e, a * f) if type(b) is int else Jet(a * d, a * e + b * d, a * f + b * e + c * d)
    def __sub__(self, o: Jet) -> Jet:
        return self + o * Jet(-1)
    def __truediv__(self, o: Jet) -> Jet:
        return self * power(o, fmpq(-1), arb)
    def __getitem__(self, k: int) -> Jet:
        return Jet(*(part[k] for part in self.parts if type(part) is not int))
    def through(self, f: Any, slopes: Callable[[], tuple[Any, Any]]) -> Jet:
        """A function of this, from its value and, where needed, its derivative and half the second one."""
        _, b, c = self.parts
        g, h = (0, 0) if type(b) is int else slopes()
        return Jet(f, g * b, g * c + h * b * b)

OPERATIONS: dict[type, Any] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
DERIVED = {"tan": "sin(x)/cos(x)", "cot": "cos(x)/sin(x)", "sec": "1/cos(x)", "csc": "1/sin(x)", "sqrt": "x**(1/2)",
           "abs": "(x*x)**(1/2)", "sinh": "(exp(x) - exp(-x))/2", "cosh": "(exp(x) + exp(-x))/2",
           "tanh": "1 - 2/(exp(2*x) + 1)"}
SLOPES: dict[str, Callable[[Any], tuple[Any, Any]]] = {
    "exp": lambda a: (a.exp(), a.exp() / 2), "sin": lambda a: (a.cos(), a.sin() / -2),
    "cos": lambda a: (a.sin() * -1, a.cos() / -2), "log": lambda a: (a**-1, a**-2 / -2),
    "atan": lambda a: ((a * a + 1) ** -1, (a * a + 1) ** -2 * a * -1)}

def value(node: ast.expr, names: dict[str, Jet], field: Any) -> Jet:
    """An expression in balls (field arb; NaN, which fails every comparison, where it may be undefined) or exactly."""
    match node:
        case ast.Name(name) if name.startswith("N_"):
            return Jet(field(number(name[2:].replace("_", "."))))
        case ast.Name("V_pi"):
            return Jet(arb.pi() if field is arb else PI)
        case ast.Name(name):
            need(name[2:] in names, f"unknown name {name[2:]}")
            return names[name[2:]]
        case ast.UnaryOp(ast.UAdd() | ast.USub() as sign, x):
            return value(x, names, field) * Jet(1 if isinstance(sign, ast.UAdd) else -1)
        case ast.Call(ast.Name(name), [argument], []):
            return apply(name[2:], value(argument, names, field), field)
        case ast.BinOp(x, ast.Pow(), q):
            terms = value(q, {}, exact).parts[0].terms
            need(set(terms) <= {frozenset()}, "an exponent that is no rational number")
            return power(value(x, names, field), terms.get(frozenset(), fmpq(0)), field)
        case ast.BinOp(x, sign, y) if type(sign) in OPERATIONS:
            return OPERATIONS[type(sign)](value(x, names, field), value(y, names, field))  # type: ignore[no-any-return]
    raise Refused("not an expression")

def power(x: Jet, q: fmpq, field: Any) -> Jet:
    need(abs(q) < 1000, "a large exponent")
    if q.q == 1 and q >= 0:
        return prod([x] * int(q), start=Jet(field(1)))
    a = x.parts[0]
    return x.through(a**q, lambda: (a ** (q - 1) * q, a ** (q - 2) * (q * (q - 1) / 2)))

def polynomial(c: list[Jet], at: Jet) -> Jet:
    return reduce(lambda total, a: total * at + a, reversed(c), Jet(0))

def apply(name: str, x: Jet, field: Any) -> Jet:
    a = x.parts[0]
    if name in DERIVED:
        return value(parse(DERIVED[name]), {"x": x}, field)
    if name in ("exp", "sin", "cos", "log", "atan", "asin", "acos"):
        return x.through(getattr(a, name)() if hasattr(a, name) else a.key(name), lambda: SLOPES[name](a))
    f, _, digits = name.partition("_")
    need(f in ("exp", "sin", "cos") and re.fullmatch("[0-9]{1,2}", digits), f"function {name}")
    signs, k = {"exp": (1, 1, 1, 1), "sin": (0, 1, 0, -1), "cos": (1, 0, -1, 0)}[f], int(digits)
    c = [Jet(field(fmpq(signs[j % 4], factorial(j)))) for j in range(k + 60)]
    if field is exact:
        return (apply(f, x, field) - polynomial(c[:k], x)) / power(x, fmpq(k), field)
    need(abs(a if isinstance(a, arb) else a[0]) <= 1, f"{name} beyond 1")
    # the last coefficient: the sum of binomial(j, 60)/(j + k)! over j >= 60 is at most e/(60 + k)!
    return polynomial([*c[k:], Jet(arb(0, 3) / factorial(k + 60))], x)

# -- exact numbers -----------------------------------------------------------------------------------------------------
def exact(q: Any) -> Exact:
    return q if isinstance(q, Exact) else Exact({frozenset(): fmpq(q)})

class Exact:
    """A sum of c k1**q1 k2**q2 ... with rational c and q, {frozenset of (k, q): c}. Keys k = (depth, kind, content) are
    symbols, pi, functions of an argument, exp(M) and "cis" exp(i M) of the products M in arguments, and "sum"s: what
    something is divided by, or a root of. What vanishes does so wherever all of it is defined."""
    def __init__(self, terms: dict[Any, Any]):
        self.terms = {m: c for m, c in terms.items() if c != 0}
    def key(self, kind: str, q: Any = 1) -> Exact:
        """(a function of this number)**q; the number itself for the kind "sum"."""
        depth = max([k[0] + 1 for m in self.terms for k, _ in m], default=0)
        return Exact({frozenset({((depth, kind, frozenset(self.terms.items())), q)}): fmpq(1)})
    def __add__(self, o: Any) -> Exact:
        a, b = self.terms, exact(o).terms
        return Exact({m: a.get(m, 0) + b.get(m, 0) for m in {**a, **b}})
    def __mul__(self, o: Any) -> Exact:
        total, others = dict[Any, Any](), exact(o).terms
        need(len(self.terms) * len(others) < 10**6, "too many terms")
        for m, c in self.terms.items():
            for n, d in others.items():
                powers = dict(m)
                for k, q in n:
                    powers[k] = powers.get(k, 0) + q
                mn = frozenset(pair for pair in powers.items() if pair[1] != 0)
                total[mn] = total.get(mn, 0) + c * d
        return Exact(total)
    __radd__, __rmul__ = __add__, __mul__
    def __truediv__(self, q: Any) -> Exact:
        return self * (1 / fmpq(q))
    def __pow__(self, exponent: Any) -> Exact:
        q = fmpq(exponent)
        if len(self.terms) == 1 and q.q == 1:
            ((m, c),) = self.terms.items()
            return Exact({frozenset((k, e * int(q)) for k, e in m): c ** int(q)})
        need(not self.vanishes(), "division by zero, or a root of it")
        tops, bottoms = zip(*((int(c.p), int(c.q)) for c in self.terms.values()), strict=True)
        need(gcd(*tops) * lcm(*bottoms) < 2**100, "a root of a large number")
        c = fmpq(gcd(*tops), lcm(*bottoms))
        parts = [surd(int(p), q * e) for p, e in [*c.p.factor(), *((p, -e) for p, e in c.q.factor())]]
        rest = self / c
        return prod(parts, start=rest if rest.terms == exact(1).terms else rest.key("sum", q))
    def exp(self, kind: str = "exp", sign: int = 1) -> Exact:
        """exp(x), or exp(i sign x) for the kind "cis"."""
        return prod((Exact({m: fmpq(1)}).key(kind, c * sign) for m, c in self.terms.items()), start=exact(1))
    def cos(self) -> Exact:
        return (self.exp("cis") + self.exp("cis", -1)) / 2
    def sin(self) -> Exact:
        return (self + PI / -2).cos()
    def vanishes(self) -> bool:
        """Powers of a sum that differ by integers are multiplied out; then sums of roots of unity are left."""
        parts: dict[Any, Any] = {}
        key = max((k for m in self.terms for k, _ in m if k[1] == "sum"), key=lambda k: k[0], default=None)
        if key is None:
            for m, c in self.terms.items():
                q = dict(m).get(TURN, 0)
                parts.setdefault(m - {(TURN, q)}, []).append((fmpq(q), c))
            return all(unity(part) for part in parts.values())
        lowest = min(dict(m).get(key, 0) for m in self.terms)
        for m, c in self.terms.items():
            e = dict(m).get(key, 0)
            n = fmpq(e - lowest).floor()
            term = Exact({m - {(key, e)}: c}) * prod([Exact(dict(key[2]))] * int(n), start=exact(1))
            parts[e - n] = parts.get(e - n, exact(0)) + term
        return all(part.vanishes() for part in parts.values())

def unity(part: list[tuple[fmpq, fmpq]]) -> bool:
    """The sum of c exp(i pi q) is zero: the cyclotomic polynomial divides it."""
    n = lcm(*(int(q.q) for q, _ in part))
    need(n <= 5040, "roots of unity of a high order")
    z = sum((fmpq_poly([0] * (int(q * n) % (2 * n)) + [c]) for q, c in part), fmpq_poly([0]))
    return bool(z % fmpq_poly(fmpz_poly.cyclotomic(2 * n)) == 0)

PI = exact(1).key("pi")
(((TURN, _),),) = PI.key("cis").terms

def surd(p: int, q: fmpq) -> Exact:
    """p**q for a prime p."""
    half = {2: "2*cos(pi/4)", 3: "2*cos(pi/6)", 5: "4*cos(pi/5) - 1"}.get(p) if q.q == 2 else "1"
    if q.q > 2 or half is None:
        return exact(p).key("sum", q)
    return value(parse(half), {}, exact).parts[0] * fmpq(p) ** int(q.floor())  # type: ignore[no-any-return]

def equal(x: Any, y: Any, why: str) -> None:
    need((x + y * -1).vanishes(), why)

def generic(symbols: Any) -> dict[str, Jet]:
    return {s: Jet(exact(1).key(f"symbol {s}")) for s in distinct(symbols)}

def table(item: Any, columns: int, names: dict[str, Jet], field: Any) -> list[list[Any]]:
    return array(item, lambda row: array(row, lambda e: value(parse(e), names, field).parts, columns))

def identity(item: Any) -> None:
    _, left, right, symbols = fields(item, "kind left right symbols")
    x, y = (value(parse(side), generic(symbols), exact).parts[0] for side in (left, right))
    equal(x, y, "the sides differ")

def exponential(item: Any) -> None:
    _, A, X, t, symbols = fields(item, "kind matrix solution variable symbols")
    names, n = generic([*array(symbols, label), t]), len(array(A, list))
    moving = {t: Jet(names.pop(t).parts[0], exact(1))}
    F, Y, start = (table(M, n, names | t_, exact) for M, t_ in ((A, {}), (X, moving), (X, {t: Jet(exact(0))})))
    for i, j in ((i, j) for i in range(n) for j in range(n)):
        equal(sum(F[i][k][0] * Y[k][j][0] for k in range(n)), Y[i][j][1], "X' differs from A X")
        equal(start[i][j][0], int(i == j), "X(0) differs from I")

def rank(item: Any) -> None:
    _, M, symbols, r, point, rows, null = fields(item, "kind matrix symbols rank point rows null")
    names, n = generic(symbols), len(array(M, list)[0])
    need(isinstance(point, dict) and set(point) == set(names), "the point gives every symbol")
    here = {s: Jet(arb(number(q))) for s, q in point.items()}
    need(len(array(null, list)) == n - whole(r, 0, n), "expected n - r null vectors")
    chosen = array(rows, lambda k: M[whole(k, 0, len(M) - 1)], r)
    det = arb_mat([[e[0] for e in row] for row in table(chosen + null, n, here, arb)]).det()
    need(not det.contains(0), "the rows and null vectors may be dependent at the point")
    for row, v in ((row, v) for row in table(M, n, names, exact) for v in table(null, n, names, exact)):
        equal(sum(a * b for (a, *_), (b, *_) in zip(row, v, strict=True)), 0, "M v does not vanish")

# -- balls -------------------------------------------------------------------------------------------------------------
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

def positivity(item: Any) -> None:
    _, text, box, bits, cells = fields(item, "kind expression box bits cells")
    ctx.prec, tree = whole(bits, 30, 20000), parse(text)
    ends = {s: array(box[s], lambda e: value(parse(e), {}, arb), 2) for s in distinct([*box])}
    def passes(cell: dict[str, Any]) -> Any:
        here = {s: a + (b - a) * Jet(arb(cell[s][0]).union(arb(cell[s][1]))) for s, (a, b) in ends.items()}
        return value(tree, here, arb).parts[0] > 0
    whole_box = dict.fromkeys(ends, (fmpq(0), fmpq(1)))
    cover(whole_box, 4 * whole(cells, 0, min(50000, 4 * 10**7 // bits)) + 200, passes, "not shown to be positive")

# -- the optimum -------------------------------------------------------------------------------------------------------
EVERY, HEAD = arb(0, 1), "kind variable panels functional bits cells parameter from to lower upper "

def dot(x: list[Jet], y: list[Jet]) -> Jet:
    return sum(map(operator.mul, x, y), Jet(0))

class Problem:
    """Panels and functional; p = middle + half s is the value of the parameter, an int half when nothing follows it."""
    def __init__(self, item: Any, more: str):
        _, t, panels, P, bits, cells, p, *numbers = fields(item, HEAD + more)
        ctx.prec, self.limit = whole(bits, 53, 20000), 4 * whole(cells, 0, min(20000, 4 * 10**7 // bits)) + 200
        self.low, self.high, self.lower, self.upper = map(number, numbers[:4])
        self.rest, (self.t, self.p), self.P = numbers[4:], distinct([t, p]), array(P, parse)
        rows = array(panels, lambda panel: fields(panel, "measurement from to sigma H"))
        self.panels = [array([*ends, *array(H, label, len(self.P))], parse) for _, *ends, H in rows]
    def focus(self, middle: arb, half: Any, basis: list[list[fmpq]] | None = None) -> None:
        self.middle, self.half, self.basis = middle, half, [[Jet(arb(q)) for q in row] for row in basis or []]
        for panel in self.panels:
            low, high, sigma = (value(e, self.names(EVERY), arb).parts[0] for e in panel[:3])
            need(high > low and sigma > 0, "noise bound and length are positive")
    def names(self, s: arb) -> dict[str, Jet]:
        return {self.p: Jet(self.middle + s * self.half, self.half)}
    def over(self, make: Callable[[arb], list[Jet]]) -> list[Any]:
        """Enclosures for all |s| <= 1 by Taylor's formula."""
        thin = [x.parts for x in make(arb(0))]
        if type(self.half) is int:
            return [a for a, _, _ in thin]
        return [a + b * EVERY + x.parts[2] * (EVERY * EVERY) for (a, b, _), x in zip(thin, make(EVERY), strict=True)]
    def mixed(self, q: list[Jet]) -> list[Jet]:
        return [dot(row, q) for row in self.basis] or q
    def target(self, s: arb) -> list[Jet]:
        return self.mixed([value(e, self.names(s), arb) for e in self.P])
    def rows(self, panel: int, place: Jet, s: arb, n: int) -> list[Jet]:
        """basis q as series of n terms about a place."""
        ctx.cap, names = n, self.names(s)
        low, high, sigma = (value(e, names, arb) for e in self.panels[panel][:3])
        names[self.t] = low + (high - low) * (place + Jet(arb_series([0, 1])))
        return self.mixed([value(e, names, arb) / sigma * Jet(arb_series([1])) for e in self.panels[panel][3:]])
    def feasible(self, x: Callable[[arb], list[Jet]], contacts: list[tuple[int, arb, int, int]]) -> None:
        """|f| < 1 off the contacts (panel, place, sign, outward direction at an end)."""
        def passes(panel: int, low: arb, high: arb) -> bool:
            near = [c for c in contacts if c[0] == panel and abs(2 * c[1].mid() - low - high) < 2 * (high - low)]
            _, place, sign, end = near[0] if near else (panel, (low + high) / 2, 0, 0)
            centre, n = place.mid(), 16
            r = max(d.upper() for d in (centre - low, high - centre, place.rad()))
            thin, wide = (self.over(lambda s: [dot(x(s), self.rows(panel, Jet(at), s, n))])[0]  # noqa: B023
                          for at in (centre, arb(centre, r)))
            c = [*(thin[k] for k in range(n - 1)), wide[n - 1]]
            rest = [sum((comb(k, d) * c[k].abs_upper() * r ** (k - d) for k in range(d + 1, n)), arb(0))
                    for d in range(3)]
            if not near:
                return bool(abs(c[0]) + rest[0] < 1)
            outward, concave = sign * end * c[1], sign * c[2] + rest[2] < 0
            return bool(rest[0] - sign * c[0] < 1 and (outward > rest[1] or (concave and (end == 0 or outward > 0))))
        for k in range(len(self.panels)):
            unit, test = {"": (fmpq(0), fmpq(1))}, lambda cell, k=k: passes(k, *map(arb, cell[""]))
            self.limit = cover(unit, self.limit, test, "|x.H| <= sigma is not shown")

def gap(item: Any) -> None:
    problem = Problem(item, "dual support")
    (dual, support), m = problem.rest, len(problem.P)
    problem.focus(arb(problem.low).union(arb(problem.high)), 0)
    x, P = array(dual, lambda e: Jet(arb(number(e))), m), problem.target(arb(0))
    problem.feasible(lambda s: x, [])
    need(dot(x, P).parts[0] >= arb(problem.lower), "the lower bound is above x.P")
    places = [(whole(k, 0, len(problem.panels) - 1), number(v)) for k, v in array(support, list, m)]
    need(all(0 <= v <= 1 for _, v in places), "a place outside its panel")
    columns = [[h.parts[0][0] for h in problem.rows(k, Jet(arb(v)), arb(0), 1)] for k, v in places]
    w = arb_mat(columns).transpose().solve(arb_mat([[p.parts[0]] for p in P])).entries()
    need(sum(map(abs, w), arb(0)) <= arb(problem.upper), "the weights cost more than the upper bound")

def optimum(problem: Problem, dual: Any, contacts: Any, radii: Any) -> arb:
    """Krawczyk's test, then |f| < 1 off the contacts; the value x.P."""
    rows = array(contacts, lambda c: fields(c, "panel at weight"))
    panels, places, weights = map(list, zip(*rows, strict=True))
    array(panels, lambda k: whole(k, 0, len(problem.panels) - 1))
    m, l = len(problem.P), len(panels)
    curves = [array(c, lambda e: Jet(arb(number(e)))) for c in (*array(dual, list, m), *places, *weights)]
    ends = [-1 if at == ["0"] else int(at == ["1"]) for at in places]
    signs = [1 if c[0].parts[0] > 0 else -1 for c in curves[m + l:]]
    free = [k for k in range(m + 2 * l) if not (m <= k < m + l and ends[k - m])]
    n, radius = len(free), array(radii, lambda e: arb(number(e)), len(free))
    need(all(r > 0 for r in radius), "a radius is not positive")
    def unknowns(s: arb, shift: list[arb]) -> list[Jet]:
        by, at = dict(zip(free, shift, strict=True)), Jet(s, 0 if type(problem.half) is int else arb(1))
        return [polynomial(c, at) + Jet(by.get(k, arb(0))) for k, c in enumerate(curves)]
    def system(s: arb, shift: list[arb]) -> list[Jet]:
        """F, and behind it its derivatives."""
        z, P = unknowns(s, shift), problem.target(s)
        F, J = [*(p * Jet(-1) for p in P), *[Jet(0)] * (2 * l)], [[Jet(0)] * len(z) for _ in z]
        for i, v, k in zip(range(l), range(m, m + l), range(m + l, m + 2 * l), strict=True):
            q = problem.rows(panels[i], z[v], s, 3)
            f = dot(z[:m], q)
            F[v], F[k] = z[k] * f[1], f[0] - Jet(signs[i])
            J[v][v], J[v][k], J[k][v] = Jet(2) * z[k] * f[2], f[1], f[1]
            for j in range(m):
                F[j] += z[k] * q[j][0]
                J[j][k], J[k][j], J[j][v], J[v][j] = [q[j][0]] * 2 + [z[k] * q[j][1]] * 2
        return [*(F[i] for i in free), *(J[i][k] for i in free for k in free)]
    F = arb_mat(n, 1, problem.over(lambda s: system(s, [arb(0)] * n))[:n])
    J = arb_mat(n, n, problem.over(lambda s: system(s, [EVERY * r for r in radius]))[n:])
    Y, unit = J.mid().inv().mid(), arb_mat(n, n, [int(i == k) for i in range(n) for k in range(n)])
    move = ((unit - Y * J) * arb_mat(n, 1, [EVERY * r for r in radius]) - Y * F).entries()
    need(all(abs(d) < r for d, r in zip(move, radius, strict=True)), "Krawczyk's test fails")
    z = problem.over(lambda s: unknowns(s, move))  # the image of the box is a better box
    need(all(s * w > 0 for s, w in zip(signs, z[m + l:], strict=True)), "a weight of the wrong sign")
    need(all(end or (v > 0 and v < 1) for end, v in zip(ends, z[m:m + l], strict=True)), "a contact outside its panel")
    def x(s: arb) -> list[Jet]:
        return unknowns(s, move)[:m]
    problem.feasible(x, list(zip(panels, z[m:m + l], signs, ends, strict=True)))
    return problem.over(lambda s: [dot(x(s), problem.target(s))])[0]  # type: ignore[no-any-return]

def touch(item: Any) -> None:
    problem = Problem(item, "pieces")
    edge, pieces = problem.low, array(problem.rest[0], lambda p: fields(p, "from to basis dual contacts radius"))
    for low, high, rows, *solution in pieces:
        a, b, basis = number(low), number(high), array(rows, lambda row: array(row, number))
        need(a == edge <= b, "the pieces leave a hole")
        need(fmpq_mat(basis).det() != 0, "a singular basis")
        problem.focus(arb((a + b) / 2), arb((b - a) / 2) if a < b else 0, basis)
        total, edge = optimum(problem, *solution), b
        need(total >= arb(problem.lower) and total <= arb(problem.upper), "the optimum is not between the bounds")
    need(pieces and edge == problem.high, "the pieces do not reach the end")

KINDS: dict[str, Callable[[Any], Any]] = {
    "identity": identity, "exponential": exponential, "rank": rank, "positivity": positivity, "gap": gap, "sliver": gap,
    "touch": touch, "range": touch, "all": lambda item: array(fields(item, "kind of")[1] or None, check)}

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
