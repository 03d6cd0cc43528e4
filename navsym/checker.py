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
             weight at s = 0. For all |s| <= 1 Newton's step with all derivatives of the box of this radius around
             (x; v; W) stays inside: the box has exactly one zero of F = (sum W_i q(v_i) - P; f'(v_i) or, at an end,
             v_i - at; f(v_i) - s_i). There s_i W_i > 0, places are inside, and |f| < 1 elsewhere: the optimum is x.P,
             and no other estimator reaches it. (F' is regular, hence so is basis.)
Bounds of f on a cell: Taylor's formula; near a contact f is concave, or monotone up to the end of the panel. Other
cells are halved, 4 cells + 200 in all (cells bits <= 4 * 10**7). For all |s| <= 1: f(0) + s f'(0) + s s (a ball).
"""

from __future__ import annotations

import ast
import json
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import product, repeat, zip_longest
from math import factorial, prod
from typing import Any

from flint import arb, arb_mat, arb_poly, arb_series, ctx, fmpq, fmpq_poly, fmpz_poly


class Refused(Exception):
    """The certificate does not prove what it says."""


def need(condition: Any, why: str) -> None:
    if not condition:
        raise Refused(why)


# -- reading -----------------------------------------------------------------------------------------------------------
def load(text: str) -> Any:
    refuse = lambda what: need(None, f"a float, or a key given twice: {what}")  # noqa: E731
    unique = lambda pairs: dict(pairs) if len(dict(pairs)) == len(pairs) else refuse(pairs)  # noqa: E731
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


def distinct(names: list[Any]) -> list[str]:
    need(all(re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name) for name in names), "expected names")
    need(len({"pi", *names}) > len(names), "a name given twice, or pi")
    return names


def number(item: Any) -> fmpq:
    need(re.fullmatch(r"-?[0-9]{1,4000}([./][0-9]{1,4000})?", item), "not a number")
    return fmpq(*Fraction(item).as_integer_ratio())


@lru_cache
def parse(text: Any) -> ast.expr:
    """Numbers and names become identifiers _1_5, _x of our own, so that Python's grammar sees nothing else."""
    need(re.fullmatch(r"[A-Za-z0-9_+\-*/(). ]{1,100000}", text), "unexpected characters")
    own = re.sub(r"[0-9]+(\.[0-9]+)?|[A-Za-z][A-Za-z0-9_]*", lambda x: f" _{x[0].replace('.', '_')} ", text)
    return ast.parse(own.strip(), mode="eval").body


# -- values ------------------------------------------------------------------------------------------------------------
class Jet:
    """A function of s in [-1, 1]: c0 + s c1 + s s c2, or c0 + s c1, where the last part holds the values for all s; a
    constant has one part. Parts are balls, series of balls in a place with coefficients [k], or Exact (near s = 0)."""

    def __init__(self, *parts: Any):
        self.parts = parts

    def cut(self) -> Jet:
        """One part less: the last one, times s, joins the one before."""
        *first, a, b = self.parts
        return Jet(*first, a if isinstance(a, Exact) else a + EVERY * b)

    def all(self) -> Any:
        """The values for all s, as a ball or a series of balls."""
        return polynomial(self.parts, EVERY)

    def __add__(self, o: Jet) -> Jet:
        return Jet(*(x + y for x, y in zip_longest(self.parts, o.parts, fillvalue=0)))

    def __mul__(self, o: Jet) -> Jet:
        """(c0 + s h) o = c0 o + s (h o)."""
        if len(self.parts) == 1 or len(o.parts) == 1:
            return Jet(*(x * y for x in self.parts for y in o.parts))
        return Jet(self.parts[0]) * o + Jet(0, *(Jet(*self.parts[1:]) * o.cut()).parts)

    def __sub__(self, o: Jet) -> Jet:
        return self + o * Jet(-1)

    def __truediv__(self, o: Jet) -> Jet:
        return self * power(o, fmpq(-1))

    def __getitem__(self, k: int) -> Jet:
        return Jet(*(part[k] for part in self.parts))

    def through(self, value: Any, slope: Callable[[Jet], Jet]) -> Jet:
        """A function f of x = c0 + s h from f(c0) and its derivative, whose mean from c0 to x is multiplied by s h."""
        if len(self.parts) == 1:
            return Jet(value)
        mean = Jet(*(c * fmpq(1, k) for k, c in enumerate(slope(self.cut()).parts, 1)))
        return Jet(value, *(mean * Jet(*self.parts[1:])).parts)


OPERATIONS: dict[type, Any] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.UAdd: operator.add,
    ast.USub: operator.sub,
}
DERIVED = {
    "tan": "sin(x)/cos(x)",
    "cot": "cos(x)/sin(x)",
    "sec": "1/cos(x)",
    "csc": "1/sin(x)",
    "sqrt": "x**(1/2)",
    "abs": "(x*x)**(1/2)",
    "sinh": "(exp(x) - exp(-x))/2",
    "cosh": "(exp(x) + exp(-x))/2",
    "tanh": "1 - 2/(exp(2*x) + 1)",
}
SLOPES = {
    "exp": "exp(x)",
    "sin": "cos(x)",
    "cos": "-sin(x)",
    "log": "1/x",
    "atan": "1/(x*x + 1)",
    "asin": "(1 - x*x)**(-1/2)",
    "acos": "-(1 - x*x)**(-1/2)",
}


def value(node: ast.expr, names: dict[str, Jet], field: Any) -> Jet:
    """An expression in balls (field arb; NaN, which fails every comparison, where it may be undefined) or exactly."""
    match node:
        case ast.Name(name) if name[1:2].isdigit():
            return Jet(field(number(name[1:].replace("_", "."))))
        case ast.Name("_pi"):
            return Jet(arb.pi() if field is arb else PI)
        case ast.Name(name):
            return names[name[1:]]
        case ast.Call(ast.Name(name), [argument], []):
            return apply(name[1:], value(argument, names, field), field)
        case ast.BinOp(x, ast.Pow(), q):
            terms = value(q, {}, Exact).parts[0].terms
            need(set(terms) <= {frozenset()}, "an exponent that is no rational number")
            return power(value(x, names, field), terms.get(frozenset(), fmpq(0))) * Jet(field(1))
        case ast.BinOp(x, sign, y) if type(sign) in OPERATIONS:
            return OPERATIONS[type(sign)](value(x, names, field), value(y, names, field))  # type: ignore[no-any-return]
        case ast.UnaryOp(ast.UAdd() | ast.USub() as sign, x):
            return OPERATIONS[type(sign)](Jet(0), value(x, names, field))  # type: ignore[no-any-return]
    raise Refused("not an expression")


def power(x: Jet, q: fmpq) -> Jet:
    need(abs(q) < 1000, "a large exponent")
    if q.q == 1 and q >= 0:
        return prod([x] * int(q), start=Jet(1))
    return x.through(x.parts[0] ** q, lambda y: power(y, q - 1) * Jet(q))


def polynomial(c: Sequence[Any], at: Any) -> Any:
    return reduce(lambda total, a: total * at + a, reversed(c))


def apply(name: str, x: Jet, field: Any) -> Jet:
    a = x.parts[0]
    if name in DERIVED:
        return value(parse(DERIVED[name]), {"x": x}, field)
    if name in SLOPES:
        here = getattr(a, name)() if hasattr(a, name) else a.key(name)
        return x.through(here, lambda y: value(parse(SLOPES[name]), {"x": y}, field))
    f, _, digits = name.partition("_")
    need(f in ("exp", "sin", "cos") and re.fullmatch("[0-9]{1,2}", digits), f"function {name}")
    signs, k = {"exp": (1, 1, 1, 1), "sin": (0, 1, 0, -1), "cos": (1, 0, -1, 0)}[f], int(digits)
    c = [Jet(field(fmpq(signs[j % 4], factorial(j)))) for j in range(k + 60)]
    if field is Exact:
        return (apply(f, x, field) - polynomial([*c[:k], Jet(0)], x)) * power(x, fmpq(-k))
    need(abs(arb_series(x.all())[0]) <= 1, f"{name} beyond 1")
    # the last coefficient: the sum of binomial(j, 60)/(j + k)! over j >= 60 is at most e/(60 + k)!
    return polynomial([*c[k:], Jet(arb(0, 3) / factorial(k + 60))], x)


# -- exact numbers -----------------------------------------------------------------------------------------------------
def collect(pairs: Iterable[tuple[Any, Any]]) -> dict[Any, Any]:
    """The sums, other than zero, of what stands at each key."""
    total = dict[Any, Any]()
    for k, c in pairs:
        total[k] = total.get(k, 0) + c
    return {k: c for k, c in total.items() if c != 0}


class Exact:
    """A sum of c k1**q1 k2**q2 ... with rational c and q, {frozenset of (k, q): c}. Keys k = (size, kind, content) are
    symbols, pi, functions of an argument, exp(M) and "cis" exp(i M) of the products M in arguments, and "sum"s: what
    something is divided by, or a root of. What vanishes does so wherever all of it is defined."""

    def __init__(self, x: Any):
        self.terms = collect(x if isinstance(x, Iterable) else [(frozenset(), fmpq(x))])

    def __iter__(self) -> Iterator[tuple[Any, Any]]:
        return iter(self.terms.items())

    def key(self, kind: str, q: Any = 1) -> Exact:
        """(a function of this number)**q; the number itself for the kind "sum"."""
        size = len(self.terms) + sum(k[0] for m in self.terms for k, _ in m)
        return Exact([(frozenset({((size, kind, frozenset(self)), q)}), fmpq(1))])

    def __add__(self, o: Any) -> Exact:
        return Exact([*self, *Exact(o)])

    def __mul__(self, o: Any) -> Exact:
        other = Exact(o)
        need(len(self.terms) * len(other.terms) < 10**6, "too many terms")
        return Exact((frozenset(collect([*m, *n]).items()), c * d) for (m, c), (n, d) in product(self, other))

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, q: fmpq) -> Exact:
        if len(self.terms) == 1 and q.q == 1:
            ((m, c),) = self
            return Exact([(frozenset((k, e * q) for k, e in m), c ** int(q))])
        need(not self.vanishes(), "division by zero, or a root of it")
        all_c = fmpq_poly([*self.terms.values()])
        c = fmpq(all_c.numer().content(), all_c.denom())
        need(c.p * c.q < 2**100, "a root of a large number")
        parts = [surd(int(p), q * e) for p, e in [*c.p.factor(), *((p, -e) for p, e in c.q.factor())]]
        rest = self * (1 / c)
        return prod(parts, start=rest if rest.terms == {frozenset(): 1} else rest.key("sum", q))

    def exp(self, kind: str = "exp", sign: int = 1) -> Exact:
        """exp(x), or exp(i sign x) for the kind "cis"."""
        return prod((Exact([(m, fmpq(1))]).key(kind, c * sign) for m, c in self), start=Exact(1))

    def cos(self) -> Exact:
        return (self.exp("cis") + self.exp("cis", -1)) * fmpq(1, 2)

    def sin(self) -> Exact:
        return (self + PI * fmpq(-1, 2)).cos()

    def vanishes(self) -> bool:
        """Powers of a sum that differ by integers are multiplied out; then sums of roots of unity are left."""
        key = max((k for m in self.terms for k, _ in m if k[1] == "sum"), key=lambda k: k[0], default=TURN)
        powers = [fmpq(dict(m).get(key, 0)) for m in self.terms]
        terms = [(m - {(key, q)}, q, c) for q, (m, c) in zip(powers, self, strict=True)]
        if key != TURN:
            base, low = Exact(key[2]), min(powers).floor()
            raised = [(q - q.floor(), prod([base] * int(q.floor() - low), start=Exact([(m, c)]))) for m, q, c in terms]
            return all(part.vanishes() for part in collect(raised).values())
        n = int(fmpq_poly(powers).denom())
        need(n <= 5040, "roots of a high order")
        turn = fmpq_poly(fmpz_poly.cyclotomic(2 * n))
        sums = collect((m, fmpq_poly([0] * (int(q * n) % (2 * n)) + [c])) for m, q, c in terms)
        return all(part % turn == 0 for part in sums.values())


PI = Exact([]).key("pi")
(((TURN, _),),) = PI.key("cis").terms
SURDS = {
    (p, fmpq(1, 2)): value(parse(text), {}, Exact).parts[0]
    for p, text in ((2, "2*cos(pi/4)"), (3, "2*cos(pi/6)"), (5, "4*cos(pi/5) - 1"))
}


def surd(p: int, q: fmpq) -> Exact:
    """p**q for a prime p."""
    part = q - q.floor()
    return SURDS.get((p, part), Exact(p).key("sum", part)) * fmpq(p) ** int(q.floor())


def generic(symbols: list[Any]) -> dict[str, Jet]:
    return {s: Jet(Exact([]).key(f"symbol {s}")) for s in distinct(symbols)}


def table(item: Any, columns: int, names: dict[str, Jet], field: Any) -> list[list[Jet]]:
    return array(item, lambda row: array(row, lambda e: value(parse(e), names, field), columns))


def dot(x: list[Jet], y: list[Jet]) -> Jet:
    return sum(map(operator.mul, x, y), Jet(0))


def identity(left: Any, right: Any, symbols: Any) -> None:
    x, y = (value(parse(side), generic(array(symbols, str)), Exact) for side in (left, right))
    need((x - y).parts[0].vanishes(), "the sides differ")


def exponential(matrix: Any, solution: Any, variable: Any, symbols: Any) -> None:
    names, n = generic([*array(symbols, str), variable]), len(matrix)
    moving, start = Jet(names.pop(variable).parts[0], 1), Jet(Exact(0))
    A, X, I = (
        table(rows, n, names | at, Exact)
        for rows, at in ((matrix, {}), (solution, {variable: moving}), (solution, {variable: start}))
    )
    need(len(A) == len(X) == n, "expected square matrices")
    for i, j in product(range(n), repeat=2):
        rise = dot(A[i], [row[j] for row in X]) - Jet([*X[i][j].parts, 0][1])
        need(rise.parts[0].vanishes(), "X' differs from A X")
        need((I[i][j] - Jet(int(i == j))).parts[0].vanishes(), "X(0) differs from I")


def rank(matrix: Any, symbols: Any, rank: Any, point: Any, rows: Any, null: Any) -> None:
    names, n = generic(array(symbols, str)), len(matrix[0])
    need(set(point) == set(names), "the point gives every symbol")
    here = {s: ball(q) for s, q in point.items()}
    chosen = array(rows, lambda k: matrix[whole(k, 0, len(matrix) - 1)], whole(rank, 0, n))
    square = arb_mat([[e.parts[0] for e in row] for row in table([*chosen, *null], n, here, arb)])
    need(not square.det().contains(0), "the rows and null vectors may be dependent at the point")
    for row, v in product(table(matrix, n, names, Exact), table(null, n, names, Exact)):
        need(dot(row, v).parts[0].vanishes(), "M v does not vanish")


# -- balls -------------------------------------------------------------------------------------------------------------
EVERY, UNIT, ORDER = arb(0, 1), (fmpq(1, 2), fmpq(1, 2)), 16


def ball(text: Any) -> Jet:
    return Jet(arb(number(text)))


def work(bits: Any, cells: Any) -> Iterator[bool]:
    """Sets the precision; True for every cell that may be looked at."""
    ctx.prec = whole(bits, 53, 20000)
    return repeat(True, 4 * whole(cells, 0, min(20000, 4 * 10**7 // ctx.prec)) + 200)


def cover(cells: list[dict[Any, tuple[fmpq, fmpq]]], budget: Iterator[bool], passes: Any) -> None:
    """Halve boxes, of middles and radii, until all cells pass."""
    for cell in cells:
        need(next(budget, False), "the bound is not shown in so many cells")
        if not passes(cell):
            side = max(cell, key=lambda s: cell[s][1])
            middle, r = cell[side][0], cell[side][1] / 2
            cells += [cell | {side: (half, r)} for half in (middle - r, middle + r)]


def positivity(expression: Any, box: Any, bits: Any, cells: Any) -> None:
    budget, tree = work(bits, cells), parse(expression)
    ends = {s: array(box[s], lambda e: value(parse(e), {}, arb), 2) for s in distinct([*box])}

    def passes(cell: dict[str, tuple[fmpq, fmpq]]) -> Any:
        return value(tree, {s: a + (b - a) * Jet(arb(*cell[s])) for s, (a, b) in ends.items()}, arb).parts[0] > 0

    cover([dict.fromkeys(ends, UNIT)], budget, passes)


# -- the optimum -------------------------------------------------------------------------------------------------------
class Problem:
    """Panels and functional, after focus at p = middle + half s."""

    def __init__(self, variable: Any, panels: Any, functional: Any, bits: Any, cells: Any, parameter: Any, **rest: Any):
        self.budget, (self.t, self.p) = work(bits, cells), distinct([variable, parameter])
        self.low, self.high, self.lower, self.upper = map(number, fields(rest, "from to lower upper"))
        self.P = array(functional, parse)
        rows = array(panels, lambda panel: fields(panel, "measurement from to sigma H"))
        self.panels = [[*map(parse, ends), *array(H, parse, len(self.P))] for _, *ends, H in rows]

    def focus(self, middle: arb, half: fmpq, basis: list[list[Jet]]) -> None:
        self.s, self.basis = Jet(0, 1, 0) if half else Jet(0), basis
        self.names = {self.p: Jet(middle) + self.s * Jet(arb(half))}
        self.target = self.mixed(self.P, self.names)

    def mixed(self, q: list[ast.expr], names: dict[str, Jet]) -> list[Jet]:
        column = [value(e, names, arb) for e in q]
        return [dot(row, column) for row in self.basis] or column

    def rows(self, panel: int, place: Jet, n: int) -> list[Jet]:
        """basis q as series of n terms about a place."""
        ctx.cap = n
        low, high, sigma, *H = self.panels[whole(panel, 0, len(self.panels) - 1)]
        start, end, bound = (value(e, self.names, arb) for e in (low, high, sigma))
        need((end - start).all() > 0 and bound.all() > 0, "noise bound and length are positive")
        t = start + (end - start) * (place + Jet(arb_series([0, 1])))
        return [h / bound * Jet(arb_series([1])) for h in self.mixed(H, self.names | {self.t: t})]

    def feasible(self, x: list[Jet], contacts: list[Any]) -> None:
        """|f| < 1 off the contacts (panel, place, sign, outward direction at an end)."""

        def passes(cell: dict[int, tuple[fmpq, fmpq]]) -> bool:
            ((panel, (middle, half)),) = cell.items()
            part = arb(middle, half)
            near = [c for c in contacts if c[0] == panel and abs(c[1].mid() - middle) < 2 * half]
            _, place, sign, end = [*near, (panel, part, 1, 0)][0]
            centre = place.mid()
            r = abs(part.union(place) - centre).upper()
            thin, wide = (dot(x, self.rows(panel, Jet(at), ORDER)).all() for at in (centre, arb(centre, r)))
            f, u = arb_poly([*(thin[k] for k in range(ORDER - 1)), wide[ORDER - 1]]), arb(0, r)
            if not near:
                return bool(abs(f(u)) < 1)
            slope = f.derivative() * (sign * end)
            concave = slope(place - centre) >= 0 and sign * f.derivative().derivative()(u) < 0
            return bool((concave or slope(u) > 0) and sign * f(u) > -1)

        cover([{k: UNIT} for k in range(len(self.panels))], self.budget, passes)


def gap(dual: Any, support: Any, **head: Any) -> None:
    problem = Problem(**head)
    problem.focus(arb(problem.low).union(arb(problem.high)), fmpq(0), [])
    m, P = len(problem.P), [[p.all()] for p in problem.target]
    x = array(dual, ball, m)
    problem.feasible(x, [])
    need(dot(x, problem.target).all() >= problem.lower, "the lower bound is above x.P")
    need(all(0 <= number(v) <= 1 for _, v in array(support, list, m)), "a place outside its panel")
    columns = [[h[0].all() for h in problem.rows(k, ball(v), 1)] for k, v in support]
    w = arb_mat(columns).transpose().solve(arb_mat(P)).entries()
    need(sum(map(abs, w)) <= problem.upper, "the weights cost more than the upper bound")


def optimum(problem: Problem, dual: Any, contacts: Any, radii: Any) -> arb:
    """Newton's test, then |f| < 1 off the contacts; the value x.P."""
    panels, places, weights = zip(*array(contacts, lambda c: fields(c, "panel at weight")), strict=True)
    m, l = len(problem.P), len(panels)
    curves = [array(c, ball) for c in (*array(dual, list, m), *places, *weights)]
    ends = [-1 if at == ["0"] else int(at == ["1"]) for at in places]
    signs = [1 if c[0].parts[0] > 0 else -1 for c in curves[m + l :]]
    radius, centre = array(radii, number, len(curves)), [polynomial(c, problem.s) for c in curves]

    def system(z: list[Jet]) -> tuple[arb_mat, arb_mat]:
        """-F, and all derivatives of F."""
        F, J = [*problem.target, *z[m:]], [[Jet(0)] * len(z) for _ in z]
        for i, v, w in zip(range(l), range(m, m + l), range(m + l, m + 2 * l), strict=True):
            q = problem.rows(panels[i], z[v], 3)
            f = dot(z, q)
            F[w], J[w][v], J[w][:m] = Jet(signs[i]) - f[0], f[1], [h[0] for h in q]
            F[v], J[v][v] = curves[v][0] - z[v], Jet(1)
            if not ends[i]:
                F[v], J[v][v], J[v][:m] = f[1] * Jet(-1), f[2] * Jet(2), [h[1] for h in q]
            for j, h in enumerate(q):
                F[j], J[j][v], J[j][w] = F[j] - z[w] * h[0], z[w] * h[1], h[0]
        return arb_mat([[x.all()] for x in F]), arb_mat([[x.all() for x in row] for row in J])

    F, J = system(centre)[0], system([c + Jet(EVERY * r) for c, r in zip(centre, radius, strict=True)])[1]
    move = J.solve(F, algorithm="precond").entries()
    need(all(abs(d) < r for d, r in zip(move, radius, strict=True)), "Newton's test fails")
    z = [c + Jet(d) for c, d in zip(centre, move, strict=True)]  # the image of the box is a better box
    v, w = [x.all() for x in z[m : m + l]], [x.all() for x in z[m + l :]]
    need(all(s * x > 0 for s, x in zip(signs, w, strict=True)), "a weight of the wrong sign")
    need(all(end or 0 < x < 1 for end, x in zip(ends, v, strict=True)), "a contact outside its panel")
    problem.feasible(z, list(zip(panels, v, signs, ends, strict=True)))
    return dot(z, problem.target).all()  # type: ignore[no-any-return]


def touch(pieces: Any, **head: Any) -> None:
    problem = Problem(**head)
    edge, m = problem.low, len(problem.P)
    for low, high, basis, *solution in array(pieces, lambda p: fields(p, "from to basis dual contacts radius")):
        a, b = number(low), number(high)
        need(a == edge <= b, "the pieces leave a hole")
        problem.focus(arb((a + b) / 2), (b - a) / 2, array(basis, lambda row: array(row, ball, m), m))
        need(problem.lower <= optimum(problem, *solution) <= problem.upper, "the optimum is not between the bounds")
        edge = b
    need(pieces and edge == problem.high, "the pieces do not reach the end")


KINDS: dict[str, Callable[..., Any]] = {
    "identity": identity,
    "exponential": exponential,
    "rank": rank,
    "positivity": positivity,
    "gap": gap,
    "sliver": gap,
    "touch": touch,
    "range": touch,
    "all": lambda of: array(of or None, check),
}


def check(item: Any) -> str:
    """The kind of a certificate that holds (its keys are the names of the parameters); else raises Refused."""
    before, ctx.prec = (ctx.prec, ctx.cap), 128
    try:
        need(item["kind"] in KINDS, "expected a certificate of a known kind")
        KINDS[item["kind"]](**{key: item[key] for key in item if key != "kind"})
        return str(item["kind"])
    except Exception as error:
        raise error if isinstance(error, Refused) else Refused(repr(error)) from None
    finally:
        ctx.prec, ctx.cap = before
