"""Independent checker of navsym's certificates: it needs the standard library and python-flint, nothing of navsym.

The sections stand in the order of trust: each rests on those before it, and every rule states the theorem that it uses.

1. Trusted are CPython with json, ast and re, and python-flint: rational numbers and polynomials (fmpq, fmpq_poly) are
   exact; an operation on balls, or on series and matrices of balls (arb, arb_series, arb_mat), encloses its results for
   all numbers in the balls, gives NaN where one does not exist, and solves no system that may be singular.
2. Reading. A certificate is a JSON object with a kind and exactly the keys of this kind. Numbers are decimals or
   fractions in strings; floats are refused. Expressions are texts of + - * / ** (rational exponent), pi, symbols,
   sin cos tan cot sec csc sinh cosh tanh exp log atan asin acos sqrt abs, and the entire functions f_k(x) =
   (f(x) - its Taylor polynomial of degree < k)/x**k of f = exp, sin, cos for k = 0 .. 99 (by balls: |x| <= 1 only).
3. Functions of a parameter, and 4. expressions, both in balls. 5. Exact algebra, which decides that numbers are equal.
6. The kinds identity, exponential and rank, by exact algebra. 7. The kinds positivity, by balls, and all.
8. The optimum of guaranteed estimation: the kinds gap and sliver, touch and range. 9. The entry: check.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import product, repeat, zip_longest
from math import factorial, prod
from operator import add, mul, sub, truediv
from typing import Any, NamedTuple

from flint import arb, arb_mat, arb_poly, arb_series, ctx, fmpq, fmpq_poly, fmpz_poly


# -- 1. Refusals -------------------------------------------------------------------------------------------------------
class Refused(Exception):
    """The certificate does not prove its statement."""


class Undefined(Refused):
    """An expression may have no value in these balls; smaller balls may show that it has one."""


def require(condition: Any, why: str) -> None:
    if not condition:
        raise Refused(why)


# -- 2. Reading --------------------------------------------------------------------------------------------------------
def load(text: str) -> Any:
    """The JSON value of a text, without floats, which are rounded, and without keys given twice."""

    def refuse(digits: str) -> Any:
        raise Refused(f"expected a number in a string; got the float {digits}")

    def read_object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        require(len(dict(pairs)) == len(pairs), "a key given twice")
        return dict(pairs)

    try:
        return json.loads(text, object_pairs_hook=read_object, parse_float=refuse, parse_constant=refuse)
    except (ValueError, RecursionError) as error:
        raise Refused(f"not JSON: {error}") from None


def read_fields(item: Any, keys: str) -> list[Any]:
    """The entries of an object that has these keys and no others."""
    require(isinstance(item, dict) and set(item) == set(keys.split()), f"expected exactly the keys {keys}")
    return [item[key] for key in keys.split()]


def read_list(item: Any, read: Callable[[Any], Any], size: int | None = None) -> list[Any]:
    require(isinstance(item, list) and size in (None, len(item)), f"expected {size or 'a list of'} entries")
    return [read(entry) for entry in item]


def read_integer(item: Any, low: int, high: int) -> int:
    require(type(item) is int and low <= item <= high, f"expected an integer from {low} to {high}")
    return int(item)


def matches(pattern: str, item: Any) -> bool:
    return isinstance(item, str) and re.fullmatch(pattern, item) is not None


def read_symbols(names: list[Any]) -> list[str]:
    require(all(matches("[A-Za-z][A-Za-z0-9_]*", name) for name in names), "expected names")
    require(len({"pi", *names}) > len(names), "a name given twice, or pi")
    return names


def read_number(item: Any) -> fmpq:
    require(matches(r"-?[0-9]{1,4000}([./][0-9]{1,4000})?", item), "not a number")
    return fmpq(*Fraction(item).as_integer_ratio())


@lru_cache
def parse(text: Any) -> ast.expr:
    """The syntax tree of an expression, read by Python's own parser.

    An underscore is put before every number and name (_1_5 for 1.5, _x for x): no keyword or literal is left.
    """
    require(matches(r"[A-Za-z0-9_+\-*/(). ]{1,100000}", text), "unexpected characters")
    own = re.sub(r"[0-9]+(\.[0-9]+)?|[A-Za-z][A-Za-z0-9_]*", lambda word: f" _{word[0].replace('.', '_')} ", text)
    try:
        return ast.parse(own.strip(), mode="eval").body
    except SyntaxError as error:
        raise Refused(f"not an expression: {error.msg}") from None


# -- 3. Functions of a parameter ---------------------------------------------------------------------------------------
EVERY = arb(0, 1)  # the ball [-1, 1] of all values of s


class Jet:
    """A function x of s in [-1, 1], as the parts of x(s) = c0 + s c1 + s**2 c2 (three parts) or c0 + s c1 (two).

    The last part encloses a coefficient that itself may depend on s, for all s; a constant has one part. Parts are
    balls; or series of balls in a second variable u, whose coefficient of u**k is part[k]; or Exact numbers, two for
    value and derivative at s = 0. Jets that meet in one operation have the same number of parts, or one.
    """

    def __init__(self, *parts: Any):
        self.parts = parts

    def drop_part(self) -> Jet:
        """The same function with one part less: c0 + s c1 + s**2 c2 = c0 + s (c1 + s c2)."""
        *first, a, b = self.parts
        return Jet(*first, a if isinstance(a, Exact) else a + EVERY * b)

    def enclose(self) -> Any:
        """The values for all s, as a ball or a series of balls."""
        return evaluate_polynomial(self.parts, EVERY)

    def __add__(self, other: Jet) -> Jet:
        return Jet(*(x + y for x, y in zip_longest(self.parts, other.parts, fillvalue=0)))

    def __mul__(self, other: Jet) -> Jet:
        """(c0 + s h) y = c0 y + s (h y), where h has one part less, and so may y."""
        if len(self.parts) == 1 or len(other.parts) == 1:
            return Jet(*(x * y for x in self.parts for y in other.parts))
        return Jet(self.parts[0]) * other + Jet(0, *(Jet(*self.parts[1:]) * other.drop_part()).parts)

    def __sub__(self, other: Jet) -> Jet:
        return self + other * Jet(-1)

    def __truediv__(self, other: Jet) -> Jet:
        return self * raise_power(other, fmpq(-1))

    def __getitem__(self, k: int) -> Jet:
        """The coefficient of u**k."""
        return Jet(*(part[k] for part in self.parts))

    def compose(self, value: Any, differentiate: Callable[[Jet], Jet]) -> Jet:
        """f(x(s)) from the value f(c0) and a rule that gives the jet of f'.

        Hadamard's lemma: for x = c0 + s h, f(x) = f(c0) + s h M, where M is the mean of f'(c0 + r s h) over
        0 <= r <= 1. If f'(c0 + r s h) = d0 + r s d1, then M = d0 + s (mean of r d1), which lies in d0 + s d1/2, for a
        ball is convex. What may not exist ends the evaluation: flint has 0 for NaN times a series without terms.
        """
        if not isinstance(value, Exact) and not arb_series(value)[0].is_finite():
            raise Undefined("a quotient, root or function that may have no value")
        if len(self.parts) == 1:
            return Jet(value)
        mean = Jet(*(d * fmpq(1, k) for k, d in enumerate(differentiate(self.drop_part()).parts, 1)))
        return Jet(value, *(mean * Jet(*self.parts[1:])).parts)


def evaluate_polynomial(coefficients: Sequence[Any], x: Any) -> Any:
    """Horner's scheme, lowest coefficient first."""
    return reduce(lambda total, c: total * x + c, reversed(coefficients))


def dot(x: Sequence[Jet], y: Sequence[Jet]) -> Jet:
    return sum((a * b for a, b in zip(x, y, strict=True)), Jet(0))


def read_ball(text: Any) -> Jet:
    return Jet(arb(read_number(text)))


# -- 4. Expressions ----------------------------------------------------------------------------------------------------
SIGNS: dict[type, Any] = {ast.Add: add, ast.Sub: sub, ast.Mult: mul, ast.Div: truediv, ast.UAdd: add, ast.USub: sub}
DEFINITIONS = {"tan": "sin(x)/cos(x)", "cot": "cos(x)/sin(x)", "sec": "1/cos(x)", "csc": "1/sin(x)"}
DEFINITIONS |= {"sinh": "(exp(x) - exp(-x))/2", "cosh": "(exp(x) + exp(-x))/2", "tanh": "1 - 2/(exp(2*x) + 1)"}
DEFINITIONS |= {"sqrt": "x**(1/2)", "abs": "(x*x)**(1/2)"}
DERIVATIVES = {"exp": "exp(x)", "sin": "cos(x)", "cos": "-sin(x)", "log": "1/x", "atan": "1/(x*x + 1)"}
DERIVATIVES |= {"asin": "(1 - x*x)**(-1/2)", "acos": "-(1 - x*x)**(-1/2)"}
# Derivatives at 0, which repeat after four, and the number of terms of f_k that are summed.
AT_ZERO, TERMS = {"exp": (1, 1, 1, 1), "sin": (0, 1, 0, -1), "cos": (1, 0, -1, 0)}, 60


def evaluate(node: ast.expr, names: dict[str, Jet], field: Any) -> Jet:
    """An expression in balls (field arb) or exactly (field Exact), where names have the given values.

    Enclosures of enclosures are enclosures (Moore, Interval Analysis, 1966). Raises Undefined where a division, root
    or function may have no value.
    """
    match node:
        case ast.Name(name) if name[1:2].isdigit():
            return Jet(field(read_number(name[1:].replace("_", "."))))
        case ast.Name("_pi"):
            return Jet(arb.pi() if field is arb else PI)
        case ast.Name(name):
            require(name[1:] in names, f"unknown symbol {name[1:]}")
            return names[name[1:]]
        case ast.Call(ast.Name(name), [argument], []):
            return apply_function(name[1:], evaluate(argument, names, field), field)
        case ast.BinOp(x, ast.Pow(), exponent):
            terms = evaluate(exponent, {}, Exact).parts[0].terms
            require(set(terms) <= {frozenset()}, "an exponent that is no rational number")
            return raise_power(evaluate(x, names, field), terms.get(frozenset(), fmpq(0))) * Jet(field(1))
        case ast.BinOp(x, sign, y) if type(sign) in SIGNS:
            return SIGNS[type(sign)](evaluate(x, names, field), evaluate(y, names, field))  # type: ignore
        case ast.UnaryOp(ast.UAdd() | ast.USub() as sign, x):
            return SIGNS[type(sign)](Jet(0), evaluate(x, names, field))  # type: ignore[no-any-return]
    raise Refused("not an expression")


def raise_power(x: Jet, q: fmpq) -> Jet:
    """x**q; d(x**q)/dx = q x**(q - 1)."""
    require(abs(q) < 1000, "a large exponent")
    if q.q == 1 and q >= 0:
        return prod([x] * int(q), start=Jet(1))
    base = x.parts[0]
    # flint has 0 for every power of a series without terms, also for the negative ones, which do not exist.
    if isinstance(base, arb_series) and len(base) == 0 and q < 0:
        raise Undefined("a division by zero")
    return x.compose(base**q, lambda y: raise_power(y, q - 1) * Jet(q))


def apply_function(name: str, x: Jet, field: Any) -> Jet:
    """A function of x by its definition, or by its value and its derivative."""
    if name in DEFINITIONS:
        return evaluate(parse(DEFINITIONS[name]), {"x": x}, field)
    if name not in DERIVATIVES:
        return apply_remainder(name, x, field)
    base = x.parts[0]
    value = getattr(base, name)() if hasattr(base, name) else base.make_atom(name)
    return x.compose(value, lambda y: evaluate(parse(DERIVATIVES[name]), {"x": y}, field))


def apply_remainder(name: str, x: Jet, field: Any) -> Jet:
    """f_k(x) = sum over j >= 0 of f^(j + k)(0) x**j / (j + k)!, for |x| <= 1 when by balls.

    The terms from x**60 on are B x**60 with a ball B about 0. Balls about 0 grow in Horner's scheme like the
    majorant X of x, X <= 1; there x**j is at most binomial(j, 60) times x**60, coefficient by coefficient, and the sum
    of binomial(j, 60)/(j + k)! over j >= 60 is at most e/(60 + k)!, which is below 3/(60 + k)!.
    """
    f, _, digits = name.partition("_")
    require(f in AT_ZERO and matches("[0-9]{1,2}", digits), f"function {name}")
    k = int(digits)
    c = [Jet(field(fmpq(AT_ZERO[f][j % 4], factorial(j)))) for j in range(k + TERMS)]
    if field is Exact:
        return (apply_function(f, x, field) - evaluate_polynomial([*c[:k], Jet(0)], x)) * raise_power(x, fmpq(-k))
    require(abs(arb_series(x.enclose())[0]) <= 1, f"{name} beyond 1")
    return evaluate_polynomial([*c[k:], Jet(arb(0, 3) / factorial(k + TERMS))], x)


# -- 5. Exact algebra --------------------------------------------------------------------------------------------------
def collect(pairs: Iterable[tuple[Any, Any]]) -> dict[Any, Any]:
    """The sum of what stands at each key; sums that are zero are left out."""
    total = dict[Any, Any]()
    for key, c in pairs:
        total[key] = total.get(key, 0) + c
    return {key: c for key, c in total.items() if c != 0}


class Exact:
    """A sum of c a1**q1 a2**q2 ... with rational c and q, as {frozenset of (a, q): c}.

    Atoms a = (size, kind, content) are symbols; pi; functions of an argument; "exp" and "cis", exp(i M), of the
    products M of which arguments are sums; and "sum", something by which is divided or of which a root is taken.
    Products follow a**q a**r = a**(q + r) only, which is true wherever both sides exist: numbers with equal terms are
    equal wherever all of both is defined. Equal numbers may have different terms.
    """

    def __init__(self, x: Any):
        """A rational number, or pairs (monomial, coefficient)."""
        self.terms = collect(x if isinstance(x, Iterable) else [(frozenset(), fmpq(x))])

    def __iter__(self) -> Iterator[tuple[Any, Any]]:
        return iter(self.terms.items())

    def make_atom(self, kind: str, q: Any = 1) -> Exact:
        """(the function of this number)**q; an atom is larger than all atoms in its content."""
        size = len(self.terms) + sum(atom[0] for monomial in self.terms for atom, _ in monomial)
        return Exact([(frozenset({((size, kind, frozenset(self)), q)}), fmpq(1))])

    def __add__(self, other: Any) -> Exact:
        return Exact([*self, *Exact(other)])

    def __mul__(self, other: Any) -> Exact:
        y = Exact(other)
        require(len(self.terms) * len(y.terms) < 10**6, "too many terms")
        return Exact((frozenset(collect([*m, *n]).items()), c * d) for (m, c), (n, d) in product(self, y))

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, q: fmpq) -> Exact:
        """One term to an integer power, factor by factor; else (c S)**q = c**q S**q with a rational c > 0."""
        if len(self.terms) == 1 and q.q == 1:
            ((monomial, c),) = self
            return Exact([(frozenset((atom, e * q) for atom, e in monomial), c ** int(q))])
        require(not self.is_zero(), "division by zero, or a root of it")
        coefficients = fmpq_poly([*self.terms.values()])
        c = fmpq(coefficients.numer().content(), coefficients.denom())
        require(c.p * c.q < 2**100, "a root of a large number")
        roots = [raise_prime(int(p), q * e) for p, e in [*c.p.factor(), *((p, -e) for p, e in c.q.factor())]]
        rest = self * (1 / c)
        return prod(roots, start=rest if rest.terms == {frozenset(): 1} else rest.make_atom("sum", q))

    def exp(self, kind: str = "exp", sign: int = 1) -> Exact:
        """exp of a sum is a product; exp(x), or exp(i sign x) for the kind "cis"."""
        return prod((Exact([(m, fmpq(1))]).make_atom(kind, c * sign) for m, c in self), start=Exact(1))

    def cos(self) -> Exact:
        """Euler: cos x = (exp(i x) + exp(-i x))/2."""
        return (self.exp("cis") + self.exp("cis", -1)) * fmpq(1, 2)

    def sin(self) -> Exact:
        return (self + PI * fmpq(-1, 2)).cos()

    def split_powers(self, atom: Any) -> list[tuple[Any, fmpq, Any]]:
        """(the rest of the monomial, the exponent of the atom, the coefficient) of every term."""
        exponents = [fmpq(dict(m).get(atom, 0)) for m in self.terms]
        return [(m - {(atom, q)}, q, c) for q, (m, c) in zip(exponents, self, strict=True)]

    def is_zero(self) -> bool:
        """Whether the number is seen to vanish wherever all of it is defined; larger sums are multiplied out first."""
        sums = [atom for m in self.terms for atom, _ in m if atom[1] == "sum"]
        if not sums:
            return self.is_zero_at_roots_of_unity()
        return all(part.is_zero() for part in self.multiply_out(max(sums, key=lambda atom: atom[0])))

    def multiply_out(self, atom: Any) -> Iterable[Exact]:
        """Numbers without the sum S: this one is S**low times the sum of S**r times one of them, with 0 <= r < 1."""
        base, rows = Exact(atom[2]), self.split_powers(atom)
        low = min(q for _, q, _ in rows).floor()
        raised = [(q - q.floor(), prod([base] * int(q.floor() - low), start=Exact([(m, c)]))) for m, q, c in rows]
        return collect(raised).values()

    def is_zero_at_roots_of_unity(self) -> bool:
        """A rational polynomial vanishes at exp(i pi/n) if and only if the cyclotomic polynomial 2 n divides it."""
        rows = self.split_powers(TURN)
        n = int(fmpq_poly([q for _, q, _ in rows]).denom())
        require(n <= 5040, "roots of a high order")
        divisor = fmpq_poly(fmpz_poly.cyclotomic(2 * n))
        sums = collect((m, fmpq_poly([0] * (int(q * n) % (2 * n)) + [c])) for m, q, c in rows)
        return all(part % divisor == 0 for part in sums.values())


PI = Exact([]).make_atom("pi")
(((TURN, _),),) = PI.make_atom("cis").terms  # the atom exp(i pi)
HALF = fmpq(1, 2)
ROOTS = {
    (p, HALF): evaluate(parse(text), {}, Exact).parts[0]
    for p, text in ((2, "2*cos(pi/4)"), (3, "2*cos(pi/6)"), (5, "4*cos(pi/5) - 1"))
}


def raise_prime(p: int, q: fmpq) -> Exact:
    """p**q for a prime p; roots of 2, 3 and 5 as sums of roots of unity."""
    part = q - q.floor()
    return ROOTS.get((p, part), Exact(p).make_atom("sum", part)) * fmpq(p) ** int(q.floor())


def make_symbols(names: list[Any]) -> dict[str, Jet]:
    return {name: Jet(Exact([]).make_atom(f"symbol {name}")) for name in read_symbols(names)}


# -- 6. Certificates by exact algebra ----------------------------------------------------------------------------------
def read_matrix(rows: Any, columns: int, names: dict[str, Jet], field: Any) -> list[list[Jet]]:
    return read_list(rows, lambda row: read_list(row, lambda e: evaluate(parse(e), names, field), columns))


def check_identity(item: Any) -> None:
    """left = right for all real symbols for which both are defined."""
    _, left, right, symbols = read_fields(item, "kind left right symbols")
    names = make_symbols(read_list(symbols, str))
    x, y = (evaluate(parse(side), names, Exact) for side in (left, right))
    require((x - y).parts[0].is_zero(), "the sides differ")


def check_exponential(item: Any) -> None:
    """solution X(t) = exp(A t) of the matrix A as far from t = 0 as X is defined.

    Theorem: X' = A X with X(0) = I has one solution (Picard and Lindelöf).
    """
    _, matrix, solution, variable, symbols = read_fields(item, "kind matrix solution variable symbols")
    names, n = make_symbols([*read_list(symbols, str), variable]), len(matrix)
    t, zero = names.pop(variable), Jet(Exact(0))
    A = read_matrix(matrix, n, names, Exact)
    X = read_matrix(solution, n, names | {variable: Jet(t.parts[0], 1)}, Exact)
    start = read_matrix(solution, n, names | {variable: zero}, Exact)
    require(len(A) == len(X) == n, "expected square matrices")
    for i, j in product(range(n), repeat=2):
        slope = Jet([*X[i][j].parts, 0][1])
        require((dot(A[i], [row[j] for row in X]) - slope).parts[0].is_zero(), "X' differs from A X")
        require((start[i][j] - Jet(int(i == j))).parts[0].is_zero(), "X(0) differs from I")


def check_rank(item: Any) -> None:
    """rank M = r wherever the chosen rows of the matrix M (p, n) and the n - r vectors of null are independent.

    Theorem: M v = 0 for n - r independent v gives rank M <= r, and r independent rows give rank M >= r. At the rational
    point the determinant of rows and vectors is not zero, so it is zero on a set without volume only.
    """
    _, matrix, symbols, r, point, rows, null = read_fields(item, "kind matrix symbols rank point rows null")
    names, n = make_symbols(read_list(symbols, str)), len(matrix[0])
    require(set(point) == set(names), "the point gives every symbol")
    here = {name: read_ball(number) for name, number in point.items()}
    chosen = read_list(rows, lambda k: matrix[read_integer(k, 0, len(matrix) - 1)], read_integer(r, 0, n))
    square = arb_mat([[e.parts[0] for e in row] for row in read_matrix([*chosen, *null], n, here, arb)])
    require(not square.det().contains(0), "the rows and null vectors may be dependent at the point")
    for row, v in product(read_matrix(matrix, n, names, Exact), read_matrix(null, n, names, Exact)):
        require(dot(row, v).parts[0].is_zero(), "M v does not vanish")


# -- 7. Certificates by balls ------------------------------------------------------------------------------------------
Cell = dict[Any, tuple[fmpq, fmpq]]  # a box: middle and radius of each side
UNIT = (HALF, HALF)  # the side [0, 1]


def set_work(bits: Any, cells: Any) -> Iterator[bool]:
    """Set the precision; return as many True as cells may be looked at."""
    ctx.prec = read_integer(bits, 53, 20000)
    return repeat(True, 4 * read_integer(cells, 0, min(20000, 4 * 10**7 // ctx.prec)) + 200)


def prove_on_cells(cells: list[Cell], budget: Iterator[bool], holds: Callable[[Cell], Any]) -> None:
    """Prove a statement on boxes by halving; it holds on a box when it holds on both halves."""
    for cell in cells:  # the list grows while it is read
        require(next(budget, False), "the bound is not shown in so many cells")
        try:
            proved = holds(cell)
        except Undefined:
            proved = False
        if not proved:
            side = max(cell, key=lambda s: cell[s][1])
            middle, radius = cell[side][0], cell[side][1] / 2
            cells += [cell | {side: (half, radius)} for half in (middle - radius, middle + radius)]


def check_positivity(item: Any) -> None:
    """expression > 0 on the box {symbol: [from, to]}.

    Theorem: the ball of an expression on a cell contains all its values there, and the cells cover the box.
    """
    _, expression, box, bits, cells = read_fields(item, "kind expression box bits cells")
    budget, tree = set_work(bits, cells), parse(expression)
    ends = {s: read_list(box[s], lambda e: evaluate(parse(e), {}, arb), 2) for s in read_symbols([*box])}

    def is_positive(cell: Cell) -> Any:
        names = {s: low + (high - low) * Jet(arb(*cell[s])) for s, (low, high) in ends.items()}
        return evaluate(tree, names, arb).parts[0] > 0

    prove_on_cells([dict.fromkeys(ends, UNIT)], budget, is_positive)


def check_all(item: Any) -> None:
    """Every certificate of the list holds."""
    _, of = read_fields(item, "kind of")
    require(read_list(of, check), "expected a list of entries")


# -- 8. The optimum ----------------------------------------------------------------------------------------------------
# Minimise sum sigma(t_i) |w_i| subject to sum w_i H(t_i) = P over all finite sets of places t_i on the panels, for each
# value from <= p <= to of a parameter, on which everything may depend: lower <= optimum <= upper. A place is a fraction
# v of its panel, t = start + (end - start) v. Below q = H/sigma, W = sigma w, and f(v) = x.q(v) for a vector x, the
# dual. Weak duality (Luenberger, Optimization by Vector Space Methods, 1969, chapter 5): if |f| <= 1 on all panels,
# x.P = sum W_i f(v_i) <= sum |W_i| for all weights with sum W_i q(v_i) = P. So x.P is a lower bound; it is the optimum
# if W_i != 0 only where f(v_i) is the sign of W_i.

HEAD = "kind variable panels functional bits cells parameter from to lower upper"
ORDER = 16  # terms of Taylor's formula


class Contact(NamedTuple):
    """A place of a panel at which f = sign; outward is -1 at its start, 1 at its end and 0 inside."""

    panel: int
    place: arb
    sign: int
    outward: int


class Problem:
    """Panels and functional, evaluated for p = middle + half s by :meth:`set_parameter`."""

    def __init__(self, item: Any, own: str):
        """From the keys of HEAD; ``own`` names the keys that the certificate has beside them."""
        read_fields(item, f"{HEAD} {own}")
        self.budget = set_work(item["bits"], item["cells"])
        self.t, self.p = read_symbols([item["variable"], item["parameter"]])
        self.low, self.high, self.lower, self.upper = (read_number(item[k]) for k in ("from", "to", "lower", "upper"))
        self.functional = read_list(item["functional"], parse)
        rows = read_list(item["panels"], lambda panel: read_fields(panel, "measurement from to sigma H"))
        self.texts: list[Any] = [[*map(parse, ends), read_list(H, parse, len(self.functional))] for _, *ends, H in rows]

    def set_parameter(self, middle: arb, half: fmpq, basis: list[list[Jet]]) -> None:
        """Evaluate what does not depend on a place; H and P are multiplied by the basis, if there is one."""
        self.s, self.basis = Jet(0, 1, 0) if half else Jet(0), basis
        self.names = {self.p: Jet(middle) + self.s * Jet(arb(half))}
        self.target = self.change_basis(self.functional, self.names)
        self.panels: list[Any] = [(*(evaluate(e, self.names, arb) for e in ends), H) for *ends, H in self.texts]
        for start, end, bound, _ in self.panels:
            good = (end - start).enclose() > 0 and bound.enclose() > 0
            require(good, "expected a positive noise bound and length of every panel")

    def change_basis(self, functions: list[ast.expr], names: dict[str, Jet]) -> list[Jet]:
        column = [evaluate(e, names, arb) for e in functions]
        return [dot(row, column) for row in self.basis] or column

    def expand(self, panel: int, place: Jet, terms: int) -> list[Jet]:
        """q(place + u) as series in u; for a wide place the coefficients enclose those at all its points."""
        ctx.cap = terms
        start, end, bound, H = self.panels[read_integer(panel, 0, len(self.panels) - 1)]
        t = start + (end - start) * (place + Jet(arb_series([0, 1])))
        return [h / bound * Jet(arb_series([1])) for h in self.change_basis(H, self.names | {self.t: t})]

    def check_dual(self, x: list[Jet], contacts: list[Contact]) -> None:
        """|f| < 1 on all panels, but at the contacts."""

        def holds(cell: Cell) -> bool:
            ((panel, (middle, half)),) = cell.items()
            near = (c for c in contacts if c.panel == panel and abs(c.place.mid() - middle) < 2 * half)
            return self.is_below_one(x, panel, arb(middle, half), next(near, None))

        prove_on_cells([{k: UNIT} for k in range(len(self.panels))], self.budget, holds)

    def is_below_one(self, x: list[Jet], panel: int, cell: arb, contact: Contact | None) -> bool:
        """Whether |f| < 1 on a cell, but at the contact; f is expanded about the contact, if there is one near.

        Taylor and Lagrange: f(c + u) = sum over k < 15 of f_k u**k + F u**15, with coefficients f_k at c, and F = f_15
        at a point between. The derivatives of this polynomial are the same formulas for f' and f''. At a contact
        sign f = 1; elsewhere sign f < 1 if it rises up to the outward end, or is concave without falling there.
        """
        place = cell if contact is None else contact.place
        centre = place.mid()
        reach = abs(cell.union(place) - centre).upper()
        thin, wide = (dot(x, self.expand(panel, Jet(at), ORDER)).enclose() for at in (centre, arb(centre, reach)))
        f, u = arb_poly([*(thin[k] for k in range(ORDER - 1)), wide[ORDER - 1]]), arb(0, reach)
        if contact is None:
            return bool(abs(f(u)) < 1)
        sign, slope = contact.sign, f.derivative() * (contact.sign * contact.outward)
        concave = slope(place - centre) >= 0 and sign * f.derivative().derivative()(u) < 0
        return bool((concave or slope(u) > 0) and sign * f(u) > -1)


def check_gap(item: Any) -> None:
    """Bounds of the optimum by a dual, and by weights at the places of support [[panel, v]], one for each unknown.

    By weak duality x.P <= optimum; the optimum is at most the cost of weights that solve the regular linear system.
    """
    problem = Problem(item, "dual support")
    problem.set_parameter(arb(problem.low).union(arb(problem.high)), fmpq(0), [])
    m = len(problem.target)
    x = read_list(item["dual"], read_ball, m)
    problem.check_dual(x, [])
    require(dot(x, problem.target).enclose() >= problem.lower, "the lower bound is above x.P")
    support = read_list(item["support"], lambda pair: read_list(pair, lambda entry: entry, 2), m)
    require(all(0 <= read_number(v) <= 1 for _, v in support), "a place outside its panel")
    columns = [[h[0].enclose() for h in problem.expand(panel, read_ball(v), 1)] for panel, v in support]
    weights = arb_mat(columns).transpose().solve(arb_mat([[p.enclose()] for p in problem.target])).entries()
    require(sum(map(abs, weights)) <= problem.upper, "the weights cost more than the upper bound")


class Guess:
    """Unknowns z = (x; v; W) as polynomials in s, with radii; panels, outward directions and signs of the contacts."""

    def __init__(self, problem: Problem, dual: Any, contacts: Any, radius: Any):
        """Places ["0"] and ["1"] are the ends of a panel; the sign of a contact is that of its weight at s = 0."""
        m, rows = len(problem.target), read_list(contacts, lambda c: read_fields(c, "panel at weight"))
        self.panels, places, weights = ([row[k] for row in rows] for k in range(3))
        curves = [read_list(c, read_ball) for c in (*read_list(dual, list, m), *places, *weights)]
        require(rows and all(curves), "expected a contact, and coefficients of every polynomial")
        self.outward = [-1 if at == ["0"] else int(at == ["1"]) for at in places]
        self.signs = [1 if c[0].parts[0] > 0 else -1 for c in curves[m + len(rows) :]]
        self.radii = read_list(radius, read_number, len(curves))
        self.curves = [evaluate_polynomial(c, problem.s) for c in curves]


def linearise(problem: Problem, guess: Guess, z: list[Jet]) -> tuple[arb_mat, arb_mat]:
    """-F and all derivatives of F in a box z = (x; v; W) of unknowns, for all s.

    F = (sum W_i q(v_i) - P; f'(v_i), or at an end v_i less its own place; f(v_i) - s_i) for the contacts i.
    """
    m, l = len(problem.target), len(guess.panels)
    F, J = [*problem.target, *z[m:]], [[Jet(0)] * len(z) for _ in z]
    for i, v, w in zip(range(l), range(m, m + l), range(m + l, m + 2 * l), strict=True):
        q = problem.expand(guess.panels[i], z[v], 3)
        f = dot(z[:m], q)
        F[w], J[w][v], J[w][:m] = Jet(guess.signs[i]) - f[0], f[1], [h[0] for h in q]
        if guess.outward[i]:
            F[v], J[v][v] = guess.curves[v] - z[v], Jet(1)
        else:
            F[v], J[v][v], J[v][:m] = f[1] * Jet(-1), f[2] * Jet(2), [h[1] for h in q]
        for j, h in enumerate(q):
            F[j], J[j][v], J[j][w] = F[j] - z[w] * h[0], z[w] * h[1], h[0]
    return arb_mat([[x.enclose()] for x in F]), arb_mat([[x.enclose() for x in row] for row in J])


def enclose_optimum(problem: Problem, guess: Guess) -> arb:
    """The optimum x.P for all s; no other weights reach it.

    Interval Newton (Neumaier, Interval Methods for Systems of Equations, 1990, chapter 5): let A enclose all
    derivatives of F on a box about c. If c - A**-1 F(c) lies inside the box, F has exactly one zero there, and it lies
    in this image. There the weights are feasible, and f = s_i at the contacts: if s_i W_i > 0 and |f| < 1 elsewhere,
    sum |W_i| = x.P is the optimum, and all optimal weights stand at the contacts. F' is regular: the columns q(v_i) are
    independent, so that the weights are unique, and so are the rows of the basis.
    """
    m, l = len(problem.target), len(guess.panels)
    minus_F = linearise(problem, guess, guess.curves)[0]
    box = [c + Jet(EVERY * r) for c, r in zip(guess.curves, guess.radii, strict=True)]
    move = linearise(problem, guess, box)[1].solve(minus_F, algorithm="precond").entries()
    require(all(abs(d) < r for d, r in zip(move, guess.radii, strict=True)), "Newton's test fails")
    z = [c + Jet(d) for c, d in zip(guess.curves, move, strict=True)]
    places, weights = [v.enclose() for v in z[m : m + l]], [w.enclose() for w in z[m + l :]]
    require(all(s * w > 0 for s, w in zip(guess.signs, weights, strict=True)), "a weight of the wrong sign")
    inside = (end or 0 < v < 1 for end, v in zip(guess.outward, places, strict=True))
    require(all(inside), "a contact outside its panel")
    problem.check_dual(z[:m], list(map(Contact, guess.panels, places, guess.signs, guess.outward)))
    return dot(z[:m], problem.target).enclose()  # type: ignore[no-any-return]


def check_touch(item: Any) -> None:
    """The optimum on pieces [{from, to, basis, dual, contacts [{panel, at, weight}], radius}] that tile from .. to.

    On a piece p = (from + to)/2 + s (to - from)/2; unknowns are lists of coefficients of polynomials in s.
    """
    problem = Problem(item, "pieces")
    edge, m = problem.low, len(problem.functional)
    pieces = read_list(item["pieces"], lambda piece: read_fields(piece, "from to basis dual contacts radius"))
    for low, high, basis, *solution in pieces:
        a, b = read_number(low), read_number(high)
        require(a == edge <= b, "the pieces leave a hole")
        rows = read_list(basis, lambda row: read_list(row, read_ball, m), m)
        problem.set_parameter(arb((a + b) / 2), (b - a) / 2, rows)
        optimum = enclose_optimum(problem, Guess(problem, *solution))
        require(problem.lower <= optimum <= problem.upper, "the optimum is not between the bounds")
        edge = b
    require(pieces and edge == problem.high, "the pieces do not reach the end")


# -- 9. The entry ------------------------------------------------------------------------------------------------------
EVERY_CHECK = (check_identity, check_exponential, check_rank, check_positivity, check_all, check_gap, check_touch)
KINDS = {check.__name__.removeprefix("check_"): check for check in EVERY_CHECK}
KINDS |= {"sliver": check_gap, "range": check_touch}


def check(item: Any) -> str:
    """The kind of a certificate that proves its statement; else raises Refused."""
    before, ctx.prec = (ctx.prec, ctx.cap), 128
    try:
        require(isinstance(item, dict) and item.get("kind") in KINDS, "expected a certificate of a known kind")
        KINDS[item["kind"]](item)
        return str(item["kind"])
    except Refused:
        raise
    except ZeroDivisionError:
        raise Refused("a linear system that may be singular, or a division by zero") from None
    except Exception as error:  # a list in the place of a text, a tree too deep, and the like
        raise Refused(f"malformed: {error!r}") from None
    finally:
        ctx.prec, ctx.cap = before
