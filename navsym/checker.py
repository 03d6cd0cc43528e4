"""Independent checker of navsym's certificates: standard library and python-flint, nothing of navsym.

A certificate is a JSON object; numbers are decimal strings or fractions, expressions are texts, floats are refused.
Balls (arb) contain the true value and every test is a comparison that a NaN fails. Kinds, and what is verified:

identity     left, right, symbols: left = right wherever both are defined (section "exact algebra").
exponential  matrix A, solution X, variable t, symbols: X' = A X and X(0) = I, hence X = exp(A t).
rank         matrix M (p, n), symbols, rank r, point, rows, columns, null: at the rational point the minor of these
             r rows and columns is not 0; M v = 0 identically for the n - r vectors v of null, independent at the
             point. Hence rank M = r wherever the minor and det(null null') are not 0.
positivity   expression, box {symbol: [from, to]}, bits, cells: expression > 0 on the box, by halving.
gap, touch   panels [{measurement, from, to, sigma, H}], variable t, functional P, bits, cells, lower, upper:
             min sum sigma |w_i| subject to sum w_i H(t_i) = P, over all finite sets of places on the panels, lies in
             [lower, upper]. A place is a fraction v of its panel, t = from + (to - from) v.
    gap      dual x with |x.H| <= sigma on all panels: x.P is a lower bound. support [[panel, v]], one place for each
             unknown: the linear system for w is regular, and sum sigma |w_i| is an upper bound.
    touch    dual x, contacts [{panel, at, end, sign, weight}], radius: Krawczyk's test finds exactly one zero of
                 F = (x.H(v_i) - s_i sigma;  x.H'(v_i) where end = "no";  sum w_i H(v_i) - P)
             in the box around (x, places with end = "no", weights). There s_i w_i > 0, places are inside, and
             |x.H| < sigma elsewhere: the optimum is x.P, and no other estimator reaches it.
range        touch for every T in [from, to]; every panel ends at T (parameter). pieces [{from, to, basis, dual, contacts,
             radius}] tile [from, to]. In a piece H and P are multiplied by the regular matrix basis, places are times,
             unknowns are polynomials in s (lists of coefficients; in a touch of degree 0), |s| <= 1, T = (from + to)/2
             + s (to - from)/2, and F at the moving centre is F at s = 0 plus s dF/ds (mean value theorem).
Bounds of f = x.H: a cell around c of half width r passes when |f(c)| + sum |f_k| r^k <= sigma, the last Taylor coefficient
over the whole cell; around an exact contact (there "<" elsewhere) when f is concave, or monotone up to the end of the
panel. Other cells are halved, 4 cells + 200 at most.
"""
# ruff: noqa: E501

from __future__ import annotations

import ast
import json
import re
import secrets
from fractions import Fraction as Q
from math import comb
from typing import Any

from flint import arb, arb_mat, arb_series, ctx, fmpq, fmpq_mat, fmpz, fmpz_mod_ctx, fmpz_mod_poly_ctx


class Refused(Exception):
    """The certificate does not prove what it says."""

def need(condition: Any, why: str) -> None:
    if not bool(condition):
        raise Refused(why)

# -- reading ---------------------------------------------------------------------------------------------------------
def load(text: str) -> Any:
    def pairs(items: list[tuple[str, Any]]) -> dict[str, Any]:
        need(len({k for k, _ in items}) == len(items), "duplicate key")
        return dict(items)

    def refuse(_: str) -> Any:
        raise Refused("a float; numbers are strings")
    try:
        return json.loads(text, object_pairs_hook=pairs, parse_float=refuse, parse_constant=refuse)
    except (ValueError, RecursionError) as error:
        raise Refused(f"not JSON: {error}") from None

def fields(item: Any, names: str) -> list[Any]:
    need(isinstance(item, dict) and set(item) == set(names.split()), f"expected exactly the keys {names}")
    return [item[name] for name in names.split()]

def array(item: Any, size: int | None = None) -> list[Any]:
    need(isinstance(item, list) and len(item) <= 20000 and size in (None, len(item)), f"expected {size} entries")
    return list(item)

def table(item: Any, rows: int, columns: int, read: Any) -> list[list[Any]]:
    return [[read(entry) for entry in array(line, columns)] for line in array(item, rows)]

def whole(item: Any, low: int, high: int) -> int:
    need(type(item) is int and low <= item <= high, f"expected an integer from {low} to {high}")
    return int(item)

def number(item: Any) -> fmpq:
    need(isinstance(item, str) and re.fullmatch(r"-?[0-9]{1,4000}(\.[0-9]{1,4000})?(/[1-9][0-9]{0,99})?", item), "not a number")
    top, _, under = item.partition("/")
    head, _, tail = top.partition(".")
    return fmpq(int(head + tail), 10 ** len(tail) * int(under or 1))

def parse(text: Any) -> ast.expr:
    """Names and numbers become identifiers of our own, so that Python's grammar sees nothing else."""
    need(isinstance(text, str) and text.isascii() and len(text) < 30000, "expected a short ASCII expression")
    done, depth = [], 0
    for token in re.findall(r"[0-9]+(?:\.[0-9]+)?|[A-Za-z][A-Za-z0-9_]*|\*\*|.", text, re.S):
        need(re.fullmatch(r"[A-Za-z0-9][\w.]*|\*\*|[-+*/() ]", token), f"unexpected {token!r}")
        depth += (token == "(") - (token == ")")
        need(depth < 80, "nested too deeply")
        mark = "N_" if token[0].isdigit() else "V_" if token[0].isalpha() else ""
        done.append(f" {mark}{token.replace('.', '_')} " if mark else token)
    try:
        return ast.parse("".join(done).strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise Refused(f"not an expression: {text[:60]}") from None

def value(node: Any, names: dict[str, Any], algebra: Any) -> Any:
    """Value of a parsed expression in an algebra, Balls or a Dice."""
    if isinstance(node, ast.Name) and node.id.startswith("N_"):
        return algebra.number(number(node.id[2:].replace("_", ".")))
    if isinstance(node, ast.Name):
        need(node.id[2:] in names or node.id == "V_pi", f"unknown name {node.id[2:]}")
        return algebra.pi() if node.id == "V_pi" else names[node.id[2:]]
    if isinstance(node, ast.UnaryOp):
        return algebra.number(fmpq(-1 if isinstance(node.op, ast.USub) else 1)) * value(node.operand, names, algebra)
    if isinstance(node, ast.Call):
        need(isinstance(node.func, ast.Name) and len(node.args) == 1 and not node.keywords, "not a function of one argument")
        return applied(node.func.id[2:], value(node.args[0], names, algebra), algebra)  # type: ignore[attr-defined]
    need(isinstance(node, ast.BinOp), "not an expression")
    x = value(node.left, names, algebra)
    if isinstance(node.op, ast.Pow):
        return algebra.power(x, exponent(node.right))
    y = value(node.right, names, algebra)
    if isinstance(node.op, ast.Div):
        return x * algebra.inverse(y)
    return x * y if isinstance(node.op, ast.Mult) else x + (y if isinstance(node.op, ast.Add) else algebra.number(fmpq(-1)) * y)

def exponent(node: Any) -> Q:
    """A small rational number: every other exponent is refused."""
    if isinstance(node, ast.UnaryOp):
        return exponent(node.operand) * (-1 if isinstance(node.op, ast.USub) else 1)
    if isinstance(node, ast.BinOp):
        need(isinstance(node.op, ast.Div) and exponent(node.right), "expected a rational exponent")
        return exponent(node.left) / exponent(node.right)
    need(isinstance(node, ast.Name) and re.fullmatch(r"N_[0-9]{1,3}", node.id), "expected a small exponent")
    return Q(node.id[2:])

def raised(x: Any, n: int, algebra: Any) -> Any:
    if n < 0:
        return algebra.inverse(raised(x, -n, algebra))
    half = raised(x, n // 2, algebra) if n > 1 else algebra.number(fmpq(1))
    return half * half * x if n % 2 else half * half

def applied(name: str, x: Any, algebra: Any) -> Any:
    if name in ("tan", "cot", "sec", "csc"):
        top = algebra.apply("sin" if name == "tan" else "cos", x) if name in ("tan", "cot") else algebra.number(fmpq(1))
        return top * algebra.inverse(algebra.apply("cos" if name in ("tan", "sec") else "sin", x))
    if name not in ("sinh", "cosh", "tanh"):
        return algebra.power(x, Q(1, 2)) if name == "sqrt" else algebra.apply(name, x)
    minus, half = algebra.number(fmpq(-1)), algebra.number(fmpq(1, 2))
    up, down = algebra.apply("exp", x), algebra.apply("exp", minus * x)
    odd, even = half * (up + minus * down), half * (up + down)
    return odd * algebra.inverse(even) if name == "tanh" else odd if name == "sinh" else even

class Balls:
    """Balls, and power series of balls: rigorous enclosures."""
    number, pi = arb, arb.pi

    @staticmethod
    def inverse(x: Any) -> Any:
        need(not (x[0] if isinstance(x, arb_series) else x).contains(0), "division by zero")
        return 1 / x

    @staticmethod
    def power(x: Any, q: Q) -> Any:
        if q.denominator == 1:
            return x**q.numerator if isinstance(x, arb) and q > 0 else raised(x, q.numerator, Balls)
        return Balls.apply("exp", Balls.apply("log", x) * arb(fmpq(q.numerator, q.denominator)))

    @staticmethod
    def apply(name: str, x: Any) -> Any:
        need(name != "log" or (x if isinstance(x, arb) else x[0]) > 0, "root or logarithm of what may not be positive")
        series = name in ("sin", "cos", "exp", "log", "atan")
        need(series or (name in ("asin", "acos", "abs") and isinstance(x, arb)), f"function {name}")
        return abs(x) if name == "abs" else getattr(x, name)()

# -- exact algebra: a random homomorphism into the integers modulo a random prime ---------------------------------------
# An expression is a quotient in the ring generated by symbols, pi, exp(i M / D) and exp(M / D) for the monomials M of
# angles, a root of unity of order N, roots r with r**q = radicand, and one unknown for any other function of an argument.
# A Dice sends the generators to random numbers modulo a fresh prime p of 250 bits, p = 1 modulo N. What is not zero in
# the ring is sent to zero with a probability below 2**-200 (Schwartz and Zippel; the weight bounds degrees and heights),
# what is zero always is; all branches of all roots are tried. Numbers carry a derivative (eps**2 = 0) with respect to t.
D, N, PRIMES = 5040, 2**7 * 3**3 * 5**2 * 7 * 11 * 13, (2, 3, 5, 7, 11, 13)

class Retry(Exception):
    """A radicand that is no power modulo p: throw again."""

class Exact:
    """Value a + b eps modulo p, the sum of monomials it is (for angles; None when there is a quotient of sums), weight."""

    def __init__(self, p: int, a: int, b: int, terms: dict[Any, Q] | None, weight: int):
        need(weight < 10**7, "degree or numbers too large")
        self.p, self.a, self.b, self.terms, self.weight = p, a % p, b % p, terms, weight

    def merge(self, o: Exact, pairs: Any) -> dict[Any, Q] | None:
        total: dict[Any, Q] = {}
        if self.terms is None or o.terms is None or len(self.terms) + len(o.terms) > 60:
            return None
        for m, c in pairs(self.terms, o.terms):
            total[m] = total.get(m, Q(0)) + c
        return {m: c for m, c in total.items() if c}

    def __add__(self, o: Exact) -> Exact:
        terms = self.merge(o, lambda x, y: [*x.items(), *y.items()])
        return Exact(self.p, self.a + o.a, self.b + o.b, terms, self.weight + o.weight)

    def __mul__(self, o: Exact) -> Exact:
        terms = self.merge(o, lambda x, y: [(joined(m, n), c * d) for m, c in x.items() for n, d in y.items()])
        return Exact(self.p, self.a * o.a, self.a * o.b + self.b * o.a, terms, self.weight + o.weight)

def joined(m: Any, n: Any) -> Any:
    exponents = {g: dict(m).get(g, 0) + dict(n).get(g, 0) for g in {**dict(m), **dict(n)}}
    return tuple(sorted((g, e) for g, e in exponents.items() if e))

class Dice:
    def __init__(self, p: int):
        self.p, self.branch, self.radix = p, 0, 1
        self.known: dict[Any, int] = {}
        self.roots: dict[Any, int] = {}
        self.zeta = next(z for z in iter(lambda: pow(self.throw(), (p - 1) // N, p), 0) if all(pow(z, N // q, p) != 1 for q in PRIMES))

    def throw(self) -> int:
        return secrets.randbelow(self.p - 1) + 1

    def unknown(self, *name: Any) -> int:
        return int(self.known.setdefault(name, self.throw()))

    def number(self, q: fmpq) -> Exact:
        height = int(q.p).bit_length() + int(q.q).bit_length()
        return Exact(self.p, int(q.p) * pow(int(q.q), -1, self.p), 0, {(): Q(int(q.p), int(q.q))} if q else {}, height)

    def symbol(self, name: str, slope: int = 0) -> Exact:
        return Exact(self.p, self.unknown("symbol", name), slope, {((name, 1),): Q(1)}, 1)

    def pi(self) -> Exact:
        return self.symbol("pi")

    def inverse(self, x: Exact) -> Exact:
        need(x.a, "division by zero")
        one = pow(x.a, -1, self.p)
        single = x.terms is not None and len(x.terms) == 1
        terms = {tuple((g, -e) for g, e in m): 1 / c for m, c in (x.terms or {}).items()} if single else None
        return Exact(self.p, one, -x.b * one * one, terms, x.weight)

    def power(self, x: Exact, q: Q) -> Exact:
        if q.denominator == 1:
            return raised(x, q.numerator, self)  # type: ignore[no-any-return]
        need(x.a, "root of zero")
        r = self.surd(x) if q.denominator == 2 and x.terms and set(x.terms) == {()} else None
        r = r or self.roots.get((q.denominator, x.a)) or self.root(x.a, q.denominator)
        slope = x.b * r * pow(q.denominator * x.a, -1, self.p)
        return raised(Exact(self.p, r, slope, {((f"root{r}", 1),): Q(1)} if x.b == 0 else None, x.weight), q.numerator, self)  # type: ignore[no-any-return]

    def root(self, a: int, q: int) -> int:
        """One of the q-th roots of a; the branch says which."""
        need(q <= 6, "expected a root of order six at most")
        roots = fmpz_mod_poly_ctx(fmpz_mod_ctx(self.p))([fmpz(-a)] + [fmpz(0)] * (q - 1) + [fmpz(1)]).roots()  # type: ignore[arg-type]
        if len(roots) < q:
            raise Retry
        self.roots[q, a] = sorted(int(r) for r, _ in roots)[self.branch // self.radix % q]
        self.radix *= q
        return self.roots[q, a]

    def surd(self, x: Exact) -> int | None:
        """sqrt(a/b) = sqrt(n)/b, n = a b, and 2 (1 + i) sqrt(n) = sum of exp(2 pi i k k / 4 n), k < 4 n (Gauss); or None."""
        c = (x.terms or {})[()]
        n = c.numerator * c.denominator
        if not 0 < n <= 10000 or N % (4 * n):
            return None
        total = sum(pow(self.zeta, k * k % (4 * n) * (N // (4 * n)), self.p) for k in range(4 * n))
        return total * pow(2 * (1 + pow(self.zeta, N // 4, self.p)) * c.denominator, -1, self.p) % self.p

    def apply(self, name: str, x: Exact) -> Exact:
        if name in ("log", "atan", "asin", "acos", "abs"):
            need(x.b == 0, "derivative of a function outside the language")
            return Exact(self.p, self.unknown(name, x.a), 0, None, x.weight)
        need(name in ("sin", "cos", "exp") and x.terms is not None, f"function {name} of this argument")
        i, up = pow(self.zeta, N // 4, self.p), 1
        for m, c in (x.terms or {}).items():
            turn = name != "exp" and m == (("pi", 1),)
            e = c * N / 2 if turn else c * D
            need(e.denominator == 1 and abs(e) < 10**9, "an angle outside the language")
            up = up * pow(self.zeta if turn else self.unknown("exp" if name == "exp" else "cis", m), int(e), self.p) % self.p
        weight = x.weight + int(sum(abs(c) for c in (x.terms or {}).values()))
        if name == "exp":
            return Exact(self.p, up, x.b * up, None, weight)
        down, half = pow(up, -1, self.p), pow(2, -1, self.p)
        cosine, sine = (up + down) * half, (up - down) * half * pow(i, -1, self.p)
        return Exact(self.p, cosine, -x.b * sine, None, weight) if name == "cos" else Exact(self.p, sine, x.b * cosine, None, weight)

def everywhere(test: Any) -> None:
    """Run the test with fresh dice, at one random point on every branch of the roots that it meets."""
    for attempt in range(4000):
        if attempt % 20 == 0:  # the root of a number exists modulo every other prime, whatever the dice say
            p = next(p for p in iter(lambda: N * (secrets.randbits(220) + 2**220) + 1, 0) if fmpz(p).is_probable_prime())
        dice, last = Dice(p), 1
        try:
            while dice.branch < last:
                dice.roots, dice.radix = {}, 1
                test(dice)
                dice.branch, last = dice.branch + 1, max(last, dice.radix)
                need(last < 3000, "too many roots")
            return
        except Retry:
            continue
    raise Refused("too many roots")

# -- the kinds ---------------------------------------------------------------------------------------------------------
def named(symbols: Any, dice: Dice) -> dict[str, Any]:
    need(all(isinstance(s, str) for s in array(symbols)), "expected names")
    return {s: dice.symbol(s) for s in symbols}

def equal(x: Exact, y: Exact, why: str) -> None:
    need(x.a == y.a, why)

def identity(item: Any) -> None:
    _, left, right, symbols = fields(item, "kind left right symbols")
    sides = parse(left), parse(right)
    everywhere(lambda dice: equal(*(value(side, named(symbols, dice), dice) for side in sides), "the sides differ"))  # type: ignore[call-arg]

def matrix_exponential(item: Any) -> None:
    _, A, X, t, symbols = fields(item, "kind matrix solution variable symbols")
    n = len(array(A))
    need(isinstance(t, str) and t not in array(symbols), "the variable is not a symbol")
    F, S = table(A, n, n, parse), table(X, n, n, parse)

    def test(dice: Dice) -> None:
        names, zero, one = named(symbols, dice), dice.number(fmpq(0)), dice.number(fmpq(1))
        Y = [[value(e, names | {t: dice.symbol(t, 1)}, dice) for e in row] for row in S]
        for i, j in ((i, j) for i in range(n) for j in range(n)):
            right = sum((value(F[i][k], names, dice) * Y[k][j] for k in range(n)), zero)
            need(Y[i][j].b == right.a, "X' differs from A X")
            equal(value(S[i][j], names | {t: zero}, dice), one if i == j else zero, "X(0) differs from I")
    everywhere(test)

def rank(item: Any) -> None:
    _, M, symbols, r, point, rows, columns, null = fields(item, "kind matrix symbols rank point rows columns null")
    p, n = len(array(M)), len(array(array(M)[0]))
    r, A, V = whole(r, 0, min(p, n)), table(M, p, n, parse), table(null, n - whole(r, 0, n), n, parse)
    need(isinstance(point, dict) and set(point) == set(array(symbols)), "the point gives every symbol")
    here = {s: arb(number(q)) for s, q in point.items()}
    I, J = ([whole(k, 0, size - 1) for k in array(part, r)] for part, size in ((rows, p), (columns, n)))
    minor = arb_mat(r, r, [value(A[i][j], here, Balls) for i in I for j in J])
    need(not minor.det().contains(0), "the minor may vanish at the point")
    W = arb_mat(n - r, n, [value(e, here, Balls) for v in V for e in v])
    need(not (W * W.transpose()).det().contains(0), "the null vectors may be dependent")

    def test(dice: Dice) -> None:
        names, zero = named(symbols, dice), dice.number(fmpq(0))
        for a, v in ((a, v) for a in A for v in V):
            terms = (value(x, names, dice) * value(y, names, dice) for x, y in zip(a, v, strict=True))
            equal(sum(terms, zero), zero, "M v does not vanish")
    everywhere(test)

def ball(text: Any) -> arb:
    return arb(value(parse(text), {}, Balls))

def between(low: fmpq, high: fmpq) -> arb:
    return arb((low + high) / 2) + arb((high - low) / 2) * arb(0, 1)

def positivity(item: Any) -> None:
    _, text, box, bits, cells = fields(item, "kind expression box bits cells")
    need(isinstance(box, dict), "expected a box")
    ctx.prec, limit, tree = whole(bits, 30, 20000), 4 * whole(cells, 0, 50000) + 200, parse(text)
    ends = {s: [ball(e) for e in array(pair, 2)] for s, pair in box.items()}
    stack = [{s: (fmpq(0), fmpq(1)) for s in ends}]
    while stack:
        cell, limit = stack.pop(), limit - 1
        need(limit > 0, "not shown to be positive")
        try:
            if value(tree, {s: a + (b - a) * between(*cell[s]) for s, (a, b) in ends.items()}, Balls) > 0:
                continue
        except Refused:
            pass
        s = max(cell, key=lambda s: cell[s][1] - cell[s][0], default=None)
        need(s is not None, "not positive")
        a, b = cell[s]
        stack += [cell | {s: (a, (a + b) / 2)}, cell | {s: ((a + b) / 2, b)}]

# -- the optimum -------------------------------------------------------------------------------------------------------
class Panel:
    """One piece of a measurement; t = origin + width place; places from low to high."""

    def __init__(self, item: Any, t: str, T: tuple[str, arb] | None):
        _, start, end, sigma, H = fields(item, "measurement from to sigma H")
        self.t, self.sigma, self.H = t, ball(sigma), [parse(h) for h in array(H)]
        need(T is None or end == T[0], "every panel ends at the parameter")
        a, b = ball(start), T[1] if T else ball(end)
        need(self.sigma > 0 and b > a, "noise bound and length are positive")
        self.origin, self.width = (arb(0), arb(1)) if T else (a, b - a)
        self.ends = {"from": a, "to": b} if T else {"from": arb(0), "to": arb(1)}

    def taylor(self, place: arb, r: arb, order: int, basis: arb_mat) -> list[list[arb]]:
        """Coefficients of basis H at a place, in units of r."""
        ctx.cap = order + 1
        t = arb_series([self.origin + self.width * place, self.width * r])
        rows = [value(h, {self.t: t}, Balls) + arb_series([0]) for h in self.H]
        need(all(h.prec > order for h in rows), "a series lost terms")
        return (basis * arb_mat([[h[k] for k in range(order + 1)] for h in rows])).tolist()  # type: ignore[no-any-return]

    def around(self, place: arb, basis: arb_mat) -> list[list[arb]]:
        """basis H, its first derivative and half its second over a ball of places, expanded about the middle."""
        thin, wide = (self.taylor(p, arb(1), 10, basis) for p in (place.mid(), place))
        rows, away = [[*t[:10], w[10]] for t, w in zip(thin, wide, strict=True)], place - place.mid()
        return [[polynomial([comb(k, d) * r[k] for k in range(d, 11)], away) for d in range(3)] for r in rows]

def dot(x: Any, y: Any) -> arb:
    return sum((a * b for a, b in zip(x, y, strict=True)), arb(0))

def middle(x: arb) -> fmpq:
    m, e = x.mid().man_exp()
    return fmpq(int(m)) * fmpq(2) ** int(e)

def feasible(panel: Panel, x: list[arb], basis: arb_mat, contacts: list[tuple[arb, int, str]], limit: int) -> int:
    """Prove |f| <= sigma, and < off the contacts, on a panel; returns what is left of the limit."""
    edge, high = middle(panel.ends["from"].lower()), middle(panel.ends["to"].upper())
    low, cells = edge, []
    for c in sorted(contacts, key=lambda c: middle(c[0])):
        marks = [*(middle(o[0]) for o in contacts), *([low] if c[2] != "from" else []), *([high] if c[2] != "to" else [])]
        r = min([abs(m - middle(c[0])) for m in marks if m != middle(c[0])], default=high - low) * fmpq(3, 8)
        a = low if c[2] == "from" else max(middle(c[0].lower()) - r, low)
        b = high if c[2] == "to" else min(middle(c[0].upper()) + r, high)
        cells += [(a, b, c), (edge, a, None)]
        edge = max(edge, b)
    cells += [(edge, high, None)]
    while cells:
        a, b, contact = cells.pop()
        limit -= 1
        need(limit > 0, "|x.H| <= sigma is not shown")
        if a < b and not small(panel, x, basis, a, b, contact, bool(contacts)):
            centre = (a + b) / 2 if contact is None else middle(contact[0])
            left = a if contact and contact[2] == "from" else (3 * a + centre) / 4
            right = b if contact and contact[2] == "to" else (centre + 3 * b) / 4
            cells += [(a, left, None), (right, b, None), (left, right, contact)] if contact else [
                (a, centre, None), (centre, b, None)]
    return limit

def small(panel: Panel, x: list[arb], basis: arb_mat, a: fmpq, b: fmpq, contact: Any, strict: bool) -> bool:
    c = (a + b) / 2 if contact is None else middle(contact[0])
    r, n = arb(max(c - a, b - c)), min(24, max(10, len(x) + 2))
    point, wide = (panel.taylor(place, r, n, basis) for place in (arb(c), between(a, b)))
    f = [dot(x, [h[k] for h in (point if k < n else wide)]) for k in range(n + 1)]
    rest = [sum((comb(k, d) * f[k].abs_upper() for k in range(d + 1, n + 1)), arb(0)) for d in range(3)]
    if contact is None:
        return bool(abs(f[0]) + rest[0] < panel.sigma) or (not strict and bool(abs(f[0]) + rest[0] <= panel.sigma))
    place, s, end = contact
    if not ((end == "from" or arb(a) <= place) and (end == "to" or place <= arb(b)) and rest[0] - s * f[0] < panel.sigma):
        return False
    return bool(s * f[2] + rest[2] < 0) if end == "no" else bool((s if end == "to" else -s) * f[1] > rest[1])

def problem(item: Any, T: tuple[str, arb] | None = None) -> tuple[list[Panel], list[arb], int]:
    ctx.prec = whole(item.get("bits"), 53, 20000)
    panels, P = [Panel(p, item["variable"], T) for p in array(item["panels"])], [ball(p) for p in array(item["functional"])]
    need(0 < len(P) <= 60 and all(len(p.H) == len(P) for p in panels), "one regressor for each unknown")
    return panels, P, 4 * whole(item["cells"], 0, 100000) + 200

def unit(m: int) -> arb_mat:
    return arb_mat(m, m, [int(i == j) for i in range(m) for j in range(m)])

def gap(item: Any) -> None:
    fields(item, "kind variable panels functional bits cells dual support lower upper")
    (panels, P, limit), x = problem(item), [arb(number(e)) for e in array(item["dual"], len(item["functional"]))]
    for panel in panels:
        limit = feasible(panel, x, unit(len(P)), [], limit)
    need(arb(number(item["lower"])) <= dot(x, P), "the lower bound is above x.P")
    support = [(panels[whole(k, 0, len(panels) - 1)], arb(number(v))) for k, v in (array(s, 2) for s in array(item["support"], len(P)))]
    need(all(v >= 0 and v <= 1 for _, v in support), "a place outside its panel")
    columns = [[h[0] for h in panel.taylor(v, arb(1), 0, unit(len(P)))] for panel, v in support]
    w = arb_mat(columns).transpose().solve(arb_mat([[p] for p in P]))
    cost = dot([panel.sigma for panel, _ in support], [abs(w[i, 0]) for i in range(len(P))])
    need(cost <= arb(number(item["upper"])), "the weights cost more than the upper bound")

def polynomial(c: list[arb], s: arb, derivative: bool = False) -> arb:
    total = arb(0)
    for k in range(len(c) - 1, int(derivative) - 1, -1):
        total = total * s + (k * c[k] if derivative else c[k])
    return total

def contact_proof(panels: list[Panel], P: list[arb], basis: arb_mat, piece: Any, T: list[arb], limit: int) -> tuple[arb, int]:
    """Krawczyk's test and |f| < sigma off the contacts; the value x.P and what is left of the limit."""
    m, rows = len(P), [fields(c, "panel at end sign weight") for c in array(piece["contacts"])]
    read = lambda cs: [arb(number(c)) for c in array(cs)]  # noqa: E731
    need(all(row[2] in ("no", "from", "to") and row[3] in (-1, 1) and type(row[3]) is int for row in rows), "end and sign")
    need(all(row[2] == "no" or row[1] == [] for row in rows), "an end has no place of its own")
    on = [panels[whole(row[0], 0, len(panels) - 1)] for row in rows]
    at = [read(row[1]) if row[2] == "no" else T if T and row[2] == "to" else [p.ends[row[2]]] for row, p in zip(rows, on, strict=True)]
    dual, weights, l = [read(c) for c in array(piece["dual"], m)], [read(row[4]) for row in rows], len(rows)
    inner = [i for i in range(l) if rows[i][2] == "no"]
    free = [*range(m), *(m + i for i in inner), *range(m + l, m + 2 * l)]
    z = [*dual, *at, *weights]
    need(0 < l <= 60, "contacts")
    radius = [arb(number(r)) for r in array(piece["radius"], len(free))]
    need(all(r > 0 for r in radius), "radius")
    extent = dict(zip(free, radius, strict=True))

    def system(s: arb, spread: arb) -> tuple[list[arb], list[list[arb]], list[arb]]:
        here = [polynomial(c, s) + extent.get(k, arb(0)) * spread for k, c in enumerate(z)]
        F, J = [], [[arb(0)] * (m + 2 * l) for _ in free]
        H = [panel.around(here[m + i], basis) for i, panel in enumerate(on)]
        for i in range(l):
            F.append(dot(here[:m], [h[0] for h in H[i]]) - rows[i][3] * on[i].sigma)
            J[i][:m], J[i][m + i] = [h[0] for h in H[i]], dot(here[:m], [h[1] for h in H[i]])
        for k, i in enumerate(inner, l):
            F.append(dot(here[:m], [h[1] for h in H[i]]))
            J[k][:m], J[k][m + i] = [h[1] for h in H[i]], 2 * dot(here[:m], [h[2] for h in H[i]])
        for j in range(m):
            F.append(dot(here[m + l :], [h[j][0] for h in H]) - P[j])
            for i in range(l):
                J[l + len(inner) + j][m + i], J[l + len(inner) + j][m + l + i] = here[m + l + i] * H[i][j][1], H[i][j][0]
        return F, J, here

    every = arb(0, 1)
    F, wide, here = system(arb(0), arb(0))[0], *system(every if T or max(map(len, z)) > 1 else arb(0), every)[1:]
    need(len(F) == len(free), "as many equations as unknowns")
    speed = [polynomial(c, every, True) for c in z]
    F = [f + dot(row, speed) * every for f, row in zip(F, wide, strict=True)]
    J = arb_mat([[row[k] for k in free] for row in wide])
    Y = arb_mat([[e.mid() for e in row] for row in arb_mat([[e.mid() for e in row] for row in J.tolist()]).inv().tolist()])
    move = (unit(len(free)) - Y * J) * arb_mat([[r * every] for r in radius]) - Y * arb_mat([[f] for f in F])
    need(all(abs(move[k, 0]) < r for k, r in enumerate(radius)), "Krawczyk's test fails")
    for row, k in enumerate(free):  # the image of the box is a better box
        here[k] = polynomial(z[k], every) + move[row, 0]
    need(all(rows[i][3] * here[m + l + i] > 0 for i in range(l)), "a weight of the wrong sign")
    need(all(here[m + i] > on[i].ends["from"] and here[m + i] < on[i].ends["to"] for i in inner), "a contact outside its panel")
    for panel in panels:
        contacts = [(here[m + i], rows[i][3], rows[i][2]) for i in range(l) if on[i] is panel]
        limit = feasible(panel, here[:m], basis, contacts, limit)
    return dot(here[:m], P), limit

def touch(item: Any) -> None:
    fields(item, "kind variable panels functional bits cells dual contacts radius lower upper")
    panels, P, limit = problem(item)
    total, _ = contact_proof(panels, P, unit(len(P)), item, [], limit)
    need(arb(number(item["lower"])) <= total and total <= arb(number(item["upper"])), "the optimum is not between the bounds")

def range_of(item: Any) -> None:
    fields(item, "kind variable panels functional bits cells parameter from to pieces")
    edge, last, limit = number(item["from"]), number(item["to"]), -1
    need(isinstance(item["parameter"], str) and edge < last, "expected a parameter and its range")
    for piece in array(item["pieces"]):
        a, b = (number(e) for e in fields(piece, "from to basis dual contacts radius")[:2])
        need(a == edge and b > a, "the pieces leave a hole")
        panels, P, first = problem(item, (item["parameter"], between(a, b)))
        basis, m, edge = fmpq_mat(table(piece["basis"], len(P), len(P), number)), len(P), b
        need(basis.det() != 0, "a singular basis")
        A = arb_mat(m, m, [arb(e) for e in basis.entries()])
        target = A * arb_mat([[p] for p in P])
        T = [arb((a + b) / 2), arb((b - a) / 2)]
        limit = contact_proof(panels, [target[i, 0] for i in range(m)], A, piece, T, first if limit < 0 else limit)[1]
    need(edge == last, "the pieces do not reach the end")

KINDS = {"identity": identity, "exponential": matrix_exponential, "rank": rank, "positivity": positivity,
         "gap": gap, "touch": touch, "range": range_of}

def check(item: Any) -> str:
    """The kind of a certificate that holds; raises Refused with the reason otherwise."""
    kind = item.get("kind") if isinstance(item, dict) else None
    need(isinstance(kind, str) and kind in KINDS, "expected a certificate of a known kind")
    before = ctx.prec, ctx.cap
    try:
        ctx.prec = 128
        KINDS[str(kind)](item)
    except (ArithmeticError, RecursionError, ValueError, TypeError, KeyError, IndexError, AttributeError) as error:
        raise Refused(f"{type(error).__name__}: {error}") from None
    finally:
        ctx.prec, ctx.cap = before
    return str(kind)
