"""Independent checker of navsym's certificates: it needs the standard library and python-flint, nothing of navsym.

The sections stand in the order of trust: each rests on those before it, and every rule states the theorem that it uses.

1. Trusted are CPython with json and re, and python-flint: rational numbers and polynomials (fmpq, fmpq_poly) are
   exact; an operation on balls, or on series and matrices of balls (arb, arb_series, arb_mat), encloses its results for
   all numbers in the balls, gives NaN where one does not exist, and solves no system that may be singular.
2. Reading. A certificate is a JSON object with a kind and exactly the keys of this kind. Numbers are decimals or
   fractions in strings; floats are refused. Expressions are texts of + - * / **, pi, symbols, sin cos tan cot sec csc
   sinh cosh tanh exp log atan asin acos sqrt abs erf, atan2(y, x), and the entire functions f_k(x) = (f(x) - its
   Taylor polynomial of degree < k)/x**k of f = exp, sin, cos for k = 0 .. 99 (by balls: |x| <= 1 only). A power x**y
   whose exponent is not seen to be a rational number is exp(y*log(x)), so that it exists for x > 0 only.
3. Functions of a parameter, and 4. expressions, both in balls. 5. Exact algebra, which decides that numbers are equal.
6. The kinds identity, exponential and rank, by exact algebra. 7. The kinds positivity, by balls, and all.
8. The optimum of guaranteed estimation: the kinds gap and sliver, touch and range; gross errors: the kind exclusion.
9. The kinds proof and counterexample: statements, the rules of their proofs, answers for integrals, sums, products and
   limits. 10. Equations between matrices of any size: the kinds words and sized. 11. The entry: check.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import deepcopy
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import combinations, pairwise, product, repeat, zip_longest
from math import comb, factorial, isqrt, prod
from operator import add, mul
from typing import Any, NamedTuple

from flint import (
    Ordering,
    arb,
    arb_mat,
    arb_poly,
    arb_series,
    ctx,
    fmpq,
    fmpq_mat,
    fmpq_mpoly,
    fmpq_mpoly_ctx,
    fmpq_poly,
    fmpz_poly,
)


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


def read_sign(item: Any) -> int:
    s = read_integer(item, -1, 1)
    require(s != 0, "expected a sign")
    return s


def read_flag(item: Any) -> bool:
    return read_integer(item, 0, 1) == 1


def set_precision(bits: Any, most: int = 20000) -> None:
    ctx.prec = read_integer(bits, 53, most)


def matches(pattern: str, item: Any) -> bool:
    return isinstance(item, str) and re.fullmatch(pattern, item) is not None


def read_symbols(names: list[Any]) -> list[str]:
    require(all(matches("[A-Za-z][A-Za-z0-9_]*", name) for name in names), "expected names")
    require(len({"pi", *names}) > len(names), "a name given twice, or pi")
    return names


NUMBER = r"-?[0-9]{1,4000}([./][0-9]{1,4000})?"


def read_number(item: Any) -> fmpq:
    require(matches(NUMBER, item), "not a number")
    return fmpq(*Fraction(item).as_integer_ratio())


# A term is a tuple: ("number", q), ("pi",), ("symbol", name), ("+", *terms), ("*", *factors), ("^", base, exponent), or
# the name of a function with its arguments. Terms are equal when their texts are, up to blanks, parentheses and signs.
Term = tuple[Any, ...]
TOKEN = re.compile(r" *([0-9]+(?:\.[0-9]+)?|[A-Za-z][A-Za-z0-9_]*|\*\*|[-+*/(),])")


class Matrix:
    """Rows of terms, all of one length."""

    def __init__(self, rows: Iterable[Iterable[Term]]):
        self.rows = [[*row] for row in rows]
        require(self.rows and self.rows[0] and len({*map(len, self.rows)}) == 1, "expected rows of one length")
        require(len(self.rows) <= 64 and len(self.rows[0]) <= 64, "too many entries")

    def transpose(self) -> Matrix:
        return Matrix(zip(*self.rows, strict=True))


Value = Term | Matrix


def shape_of(x: Value) -> tuple[int, int] | None:
    return (len(x.rows), len(x.rows[0])) if isinstance(x, Matrix) else None


def change_entries(change: Callable[..., Term], *values: Value) -> Value:
    """A function of one or more values of one shape, entry by entry."""
    require(len({*map(shape_of, values)}) == 1, "values of different shapes")
    if not isinstance(values[0], Matrix):
        return change(*values)
    rows = zip(*(x.rows for x in values), strict=True)  # type: ignore[union-attr]
    return Matrix([change(*entries) for entries in zip(*some, strict=True)] for some in rows)


def to_number(x: Value) -> Term:
    require(not isinstance(x, Matrix), "expected a number; got a matrix")
    return x  # type: ignore[return-value]


class Parser:
    """Recursive descent: sums of products of signed powers; ** binds its right side first, above a leading sign."""

    def __init__(self, text: str):
        self.words = ["", *reversed(TOKEN.findall(text))]
        spaces = len(text) - len(text.replace(" ", ""))
        require(sum(map(len, self.words)) == len(text) - spaces, "unexpected characters")

    def take(self, *words: str) -> str:
        """The next word if it is one of these, else nothing."""
        return self.words.pop() if self.words[-1] in words else ""

    def read_sum(self) -> Any:
        terms = [self.read_product()]
        while sign := self.take("+", "-"):
            terms.append(self.read_product() if sign == "+" else self.negate(self.read_product()))
        return self.add(*terms) if len(terms) > 1 else terms[0]

    def negate(self, x: Any) -> Any:
        return change_entries(negate, x)

    def add(self, *terms: Any) -> Any:
        return change_entries(lambda *entries: ("+", *entries), *terms)

    def power(self, base: Any, exponent: Any) -> Any:
        return ("^", to_number(base), to_number(exponent))

    def read_product(self) -> Any:
        """Numbers with at most one matrix among them, from one @ to the next."""
        factors = [self.read_signed()]
        while mark := self.take("*", "/", "@"):
            value = self.read_signed()
            if mark == "@":
                factors = [multiply_matrices(self.join(factors), value)]
                continue
            require(mark == "*" or not isinstance(value, Matrix), "a division by a matrix")
            factors.append(value if mark == "*" else ("^", value, MINUS_ONE))
        return self.join(factors)

    @staticmethod
    def join(factors: list[Value]) -> Value:
        """The product of numbers and at most one matrix."""
        if len(factors) == 1:
            return factors[0]
        places = [k for k, value in enumerate(factors) if isinstance(value, Matrix)]
        require(len(places) < 2, "a product of matrices is written with @")
        if not places:
            return ("*", *factors)
        before, after = factors[: places[0]], factors[places[0] + 1 :]
        return change_entries(lambda entry: ("*", *before, entry, *after), factors[places[0]])

    def read_signed(self) -> Any:
        if sign := self.take("+", "-"):
            return self.read_signed() if sign == "+" else self.negate(self.read_signed())
        base = self.read_entry()
        return self.power(base, self.read_signed()) if self.take("**") else base

    def read_arguments(self) -> list[Any]:
        arguments = [self.read_sum()]
        while self.take(","):
            arguments.append(self.read_sum())
        require(self.take(")"), "not an expression: no )")
        return arguments

    def read_entry(self) -> Any:
        word = self.words.pop()
        if word[:1].isdigit():
            return ("number", read_number(word))
        if word[:1].isalpha():
            if not self.take("("):
                return ("pi",) if word == "pi" else ("symbol", word)
            return call(word, self.read_arguments())
        require(word == "(", "not an expression")
        (inside,) = self.read_arguments()
        return inside


def call(name: str, arguments: list[Term]) -> Term:
    known = name in ("atan2", *DEFINITIONS, *DERIVATIVES) or matches("(exp|sin|cos)_[0-9]{1,2}", name)
    require(known, f"unknown function {name}")
    expected = 2 if name == "atan2" else 1
    require(len(arguments) == expected, f"expected {name} of {expected}; got {len(arguments)} arguments")
    return (name, *arguments)


def negate(term: Term) -> Term:
    return ("number", -term[1]) if term[0] == "number" else ("*", MINUS_ONE, term)


@lru_cache
def parse(text: Any) -> Term:
    """The term of an expression; nothing is evaluated or reordered."""
    require(matches(r"[A-Za-z0-9_+\-*/()., ]{1,400000}", text), "unexpected characters")
    parser = Parser(text)
    term = parser.read_sum()
    require(parser.words == [""], "not an expression: more than one")
    return term


def number(q: Any) -> Term:
    return ("number", fmpq(q))


MINUS_ONE: Term = ("number", fmpq(-1))
ZERO, ONE = number(0), number(1)


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
        return self * raise_power(other, fmpq(-1), arb)

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
DEFINITIONS = {"tan": "sin(x)/cos(x)", "cot": "cos(x)/sin(x)", "sec": "1/cos(x)", "csc": "1/sin(x)"}
DEFINITIONS |= {"sinh": "(exp(x) - exp(-x))/2", "cosh": "(exp(x) + exp(-x))/2", "tanh": "1 - 2/(exp(2*x) + 1)"}
DEFINITIONS |= {"sqrt": "x**(1/2)", "abs": "(x*x)**(1/2)"}
DERIVATIVES = {"exp": "exp(x)", "sin": "cos(x)", "cos": "-sin(x)", "log": "1/x", "atan": "1/(x*x + 1)"}
DERIVATIVES |= {"asin": "(1 - x*x)**(-1/2)", "acos": "-(1 - x*x)**(-1/2)", "erf": "2*exp(-x*x)*pi**(-1/2)"}
# Derivatives at 0, which repeat after four, and the number of terms of f_k that are summed.
AT_ZERO, TERMS = {"exp": (1, 1, 1, 1), "sin": (0, 1, 0, -1), "cos": (1, 0, -1, 0)}, 60


def clip(x: Any) -> arb:
    """Numbers as balls, like arb; with this field functions are restricted to where they exist: :func:`restrict`."""
    return arb(x)


def strict(x: Any) -> arb:
    """Numbers as balls, like arb; with this field 0**0 has no value."""
    return arb(x)


class Nowhere(Refused):
    """An expression exists nowhere in these balls."""


def restrict(f: Callable[[arb], arb], x: Jet, low: int, high: int | None) -> Jet | None:
    """The values of f at the points of a ball between two ends: f exists at no others.

    f is monotone there, so that its values lie between those at the ends. None for what is no ball.
    """
    ball = x.parts[0] if len(x.parts) == 1 else None
    if not isinstance(ball, arb) or not ball.is_finite():
        return None
    if ball < low or (high is not None and ball > high):
        raise Nowhere("an expression that exists nowhere here")
    first, last = ball.lower().max(arb(low)), ball.upper()
    value = f(first).union(f(last if high is None else last.min(arb(high))))
    if not value.is_finite():
        raise Undefined("a function without a bound at the end of its range")
    return Jet(value)


def evaluate(term: Term, names: dict[str, Jet], field: Any) -> Jet:
    """A term in balls (field arb or clip) or exactly (field Exact), where names have the given values.

    Enclosures of enclosures are enclosures (Moore, Interval Analysis, 1966). Undefined: a part may have no value.
    """
    match term:
        case ("number", q):
            return Jet(field(q))
        case ("pi",):
            return Jet(PI if field is Exact else arb.pi())
        case ("symbol", name):
            require(name in names, f"unknown symbol {name}")
            return names[name]
        case ("+", *terms) if field is Exact and not any(len(x.parts) > 1 for x in names.values()):
            return Jet(Exact(pair for t in terms for pair in evaluate(t, names, field).parts[0]))
        case ("+", *terms):
            return reduce(add, (evaluate(t, names, field) for t in terms))
        case ("*", *factors):
            return reduce(mul, (evaluate(t, names, field) for t in factors))
        case ("^", base, exponent):
            q = constant_of(exponent)
            if q is None:
                power = ("exp", ("*", exponent, ("log", base)))
                return evaluate(power, names, field)
            return raise_power(evaluate(base, names, field), q, field) * Jet(field(1))
        case ("atan2", y, x):
            return apply_atan2(evaluate(y, names, field), evaluate(x, names, field), field)
        case (function, argument):
            return apply_function(function, evaluate(argument, names, field), field)
    raise Refused("not an expression")


@lru_cache(1 << 14)
def symbols_of(term: Term) -> frozenset[str]:
    """The names in a term."""
    own = {term[1]} if term[0] == "symbol" else set()
    return frozenset(own.union(*(symbols_of(part) for part in term[1:] if isinstance(part, tuple))))


@lru_cache
def constant_of(term: Term) -> fmpq | None:
    """The rational number that a term without symbols is; None for any other term."""
    if term[0] == "number":
        return term[1]
    if symbols_of(term):
        return None
    before, EFFORT[0] = EFFORT[0], 0  # what a number is does not depend on what was asked before
    try:
        terms = evaluate(term, {}, Exact).parts[0].terms
    finally:
        EFFORT[0] = before
    if not set(terms) <= {frozenset()}:
        return None
    require(value_of(term, {}).is_finite(), "a number that may not exist")  # 0 log(-1) is none
    return terms.get(frozenset(), fmpq(0))


def raise_power(x: Jet, q: fmpq, field: Any) -> Jet:
    """x**q; d(x**q)/dx = q x**(q - 1)."""
    require(abs(q) < 1000, "a large exponent")
    if q.q == 1 and q >= 0:
        if field in (clip, strict) and q == 0 and arb_series(x.enclose())[0].contains(0):
            raise Undefined("0**0 has no value")
        return prod([x] * int(q), start=Jet(1))
    if field is clip and q.q > 1 and (inside := restrict(lambda ball: ball**q, x, 0, None)) is not None:
        return inside
    base = x.parts[0]
    # flint has 0 for every power of a series without terms, also for the negative ones, which do not exist.
    if isinstance(base, arb_series) and len(base) == 0 and q < 0:
        raise Undefined("a division by zero")
    return x.compose(base**q, lambda y: raise_power(y, q - 1, field) * Jet(q))


DOMAINS: dict[str, tuple[int, int | None]] = {"log": (0, None), "asin": (-1, 1), "acos": (-1, 1)}


def apply_function(name: str, x: Jet, field: Any) -> Jet:
    """A function of x by its definition, or by its value and its derivative."""
    if name == "abs" and len(x.parts) == 1 and isinstance(x.parts[0], arb):
        return x.compose(abs(x.parts[0]), Jet)  # a square of a ball may be below 0
    if name in DEFINITIONS:
        return evaluate(parse(DEFINITIONS[name]), {"x": x}, field)
    if name not in DERIVATIVES:
        return apply_remainder(name, x, field)
    if field is clip and name in DOMAINS and (inside := restrict(getattr(arb, name), x, *DOMAINS[name])) is not None:
        return inside
    base = x.parts[0].divide_turns() if field is Exact else x.parts[0]
    value = getattr(base, name)() if hasattr(base, name) else base.make_atom(name)
    return x.compose(value, lambda y: evaluate(parse(DERIVATIVES[name]), {"x": y}, field))


def apply_atan2(y: Jet, x: Jet, field: Any) -> Jet:
    """The angle of the point (x, y); an atom of both to the algebra, and a ball off the negative x axis."""
    if field is Exact:
        return Jet(Exact.make_angle(*y.parts, *x.parts))
    b, a = y.enclose(), x.enclose()
    require(isinstance(a, arb) and isinstance(b, arb), "atan2 in a series")
    if not (a > 0 or b > 0 or b < 0 or (a < 0 and b.is_zero())):
        raise Undefined("atan2 at its cut")
    return Jet(arb.atan2(b, a))


def apply_remainder(name: str, x: Jet, field: Any) -> Jet:
    """f_k(x) = sum over j >= 0 of f^(j + k)(0) x**j / (j + k)!, for |x| <= 1 when by balls.

    The terms from x**60 on are B x**60 with a ball B about 0. Balls about 0 grow in Horner's scheme like the
    majorant X of x, X <= 1; there x**j is at most binomial(j, 60) times x**60, coefficient by coefficient, and the sum
    of binomial(j, 60)/(j + k)! over j >= 60 is at most e/(60 + k)!, which is below 3/(60 + k)!.
    """
    f, _, digits = name.partition("_")
    k = int(digits)
    c = [Jet(field(fmpq(AT_ZERO[f][j % 4], factorial(j)))) for j in range(k + TERMS)]
    if field is Exact:
        require(not has_branch(frozenset(x.parts[0])), f"{name} of a root or angle, which may be 0 throughout a part")
        rest = apply_function(f, x, field) - evaluate_polynomial([*c[:k], Jet(0)], x)
        return rest * raise_power(x, fmpq(-k), field)
    require(abs(arb_series(x.enclose())[0]) <= 1, f"{name} beyond 1")
    return evaluate_polynomial([*c[k:], Jet(arb(0, 3) / factorial(k + TERMS))], x)


# -- 5. Exact algebra --------------------------------------------------------------------------------------------------
def collect(pairs: Iterable[tuple[Any, Any]]) -> dict[Any, Any]:
    """The sum of what stands at each key; sums that are zero are left out."""
    total = dict[Any, Any]()
    for key, c in pairs:
        total[key] = total.get(key, 0) + c
    return {key: c for key, c in total.items() if c != 0}


#: Products of two terms: so far, and at most for one question.
EFFORT, MOST_EFFORT = [0], 10**6


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

    @staticmethod
    def make_angle(y: Exact, x: Exact) -> Exact:
        """atan2(y, x), an atom of its own."""
        (((a, _),),), (((b, _),),) = (part.divide_turns().make_atom("atan2").terms for part in (y, x))
        return Exact([(frozenset({((a[0] + b[0], "atan2", (a[2], b[2])), 1)}), fmpq(1))])

    def __add__(self, other: Any) -> Exact:
        return Exact([*self, *Exact(other)])

    def __mul__(self, other: Any) -> Exact:
        y = Exact(other)
        EFFORT[0] += len(self.terms) * len(y.terms)
        if EFFORT[0] >= MOST_EFFORT:
            EFFORT[0] = 0  # a refusal ends the question: the next one begins anew
            raise Refused("too many terms")
        return Exact((frozenset(collect([*m, *n]).items()), c * d) for (m, c), (n, d) in product(self, y))

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, q: fmpq) -> Exact:
        """One term to an integer power, factor by factor, and so squares, which are >= 0, to any power.

        Else (c S)**q = c**q S**q with a rational c > 0.
        """
        if len(self.terms) == 1 and q.q == 1:
            ((monomial, c),) = self
            return Exact([(frozenset((atom, e * q) for atom, e in monomial), c ** int(q))])
        require(not self.is_zero(), "division by zero, or a root of it")
        if q.q == 1 and q < 0 and all(atom == TURN for m in self.terms for atom, _ in m):
            square = (self * self).divide_turns()
            if set(square.terms) == {frozenset()}:  # 1/x = x/r where x x = r, as for the root of a prime
                return prod([self * (1 / square.terms[frozenset()])] * int(-q), start=Exact(1))
        if (plain := self.divide_turns()).terms != self.terms:
            return plain**q
        (monomial, c), *more = self
        if not more and len(monomial) > 1 and c == 1 and all(fmpq(e).q == 1 and int(e) % 2 == 0 for _, e in monomial):
            squares = (Exact([(frozenset({(atom, 2)}), fmpq(1))]).make_atom("sum", q * e / 2) for atom, e in monomial)
            return prod(squares, start=Exact(1))
        coefficients = fmpq_poly([*self.terms.values()])
        c = fmpq(coefficients.numer().content(), coefficients.denom())
        require(c.p * c.q < 2**100, "a root of a large number")
        roots = [raise_prime(int(p), q * e) for p, e in [*c.p.factor(), *((p, -e) for p, e in c.q.factor())]]
        rest = self * (1 / c)
        return prod(roots, start=rest if rest.terms == {frozenset(): 1} else rest.make_atom("sum", q))

    def exp(self, kind: str = "exp", sign: int = 1) -> Exact:
        """exp of a sum is a product; exp(x), or exp(i sign x) for the kind "cis"."""
        return prod((self.exp_of(kind, m, c * sign) for m, c in self.divide_turns()), start=Exact(1))

    @staticmethod
    def exp_of(kind: str, monomial: Any, c: fmpq) -> Exact:
        """exp(c M), or exp(i c M), of a monomial M, wherever M is defined: exp(c log u) = u**c.

        For whole c, exp(i c M) = (a + i b)**c, (a, b) on the unit circle at M = asin u, acos u, atan u, atan2(y, x).
        """
        match [*monomial]:
            case [((_, "log", content), 1)] if kind == "exp":
                return Exact(content) ** c
            case [((_, "asin" | "acos" | "atan" | "atan2" as name, content), 1)] if kind == "cis" and c.q == 1:
                u, one = Exact(content) if name != "atan2" else None, Exact(1)
                y, x = (u, one) if name == "atan" else map(Exact, content) if u is None else (u, u)
                other = (one + u * u * -1) ** HALF if name in ("asin", "acos") else (x * x + y * y) ** -HALF  # type: ignore
                a, b = {"asin": (other, u), "acos": (u, other)}.get(name, (x * other, y * other))
                i = Exact([(frozenset({(TURN, HALF)}), fmpq(1 if c > 0 else -1))])
                return prod([a + i * b] * abs(int(c)), start=one)  # type: ignore[operator]
        return Exact([(monomial, fmpq(1))]).make_atom(kind, c)

    def log(self) -> Exact:
        """log of a product of exponentials is a sum."""
        match [*self]:
            case [(monomial, c)] if c == 1 and monomial and all(kind == "exp" for (_, kind, _), _ in monomial):
                return Exact((m, d * q) for (_, _, content), q in monomial for m, d in content)
        return self.make_atom("log")

    def erf(self) -> Exact:
        """An odd function: an atom of x or of -x, by the sign of the coefficient that is looked at first."""
        if not self.terms:
            return self
        sign = fmpq(1 if self.terms[min(self.terms, key=hash)] > 0 else -1)
        return (self * sign).make_atom("erf") * sign

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
            return not self.divide_turns().terms
        return all(part.is_zero() for part in self.multiply_out(max(sums, key=lambda atom: atom[0])))

    def multiply_out(self, atom: Any) -> Iterable[Exact]:
        """Numbers without the sum S: this one is S**low times the sum of S**r times one of them, with 0 <= r < 1."""
        base, rows = Exact(atom[2]), self.split_powers(atom)
        low = min(q for _, q, _ in rows).floor()
        shares = {q: Exact((m, c) for m, p, c in rows if p == q) for q in {q for _, q, _ in rows}}
        powers = ((q - q.floor(), prod([base] * int(q.floor() - low), start=x)) for q, x in shares.items())
        return collect(powers).values()

    def divide_turns(self) -> Exact:
        """The same number with polynomials in a root of unity as remainders of their division by its polynomial.

        A rational polynomial vanishes at exp(i pi/n) if and only if the cyclotomic polynomial 2 n divides it.
        """
        if not any(atom == TURN for m in self.terms for atom, _ in m):
            return self
        rows = self.split_powers(TURN)
        n = int(fmpq_poly([q for _, q, _ in rows]).denom())
        require(n <= 5040, "roots of a high order")
        divisor = fmpq_poly(fmpz_poly.cyclotomic(2 * n))
        sums = collect((m, fmpq_poly([0] * (int(q * n) % (2 * n)) + [c])) for m, q, c in rows)
        parts = ((m, k, c) for m, part in sums.items() for k, c in enumerate((part % divisor).coeffs()))
        return Exact((m | ({(TURN, fmpq(k, n))} if k else frozenset()), c) for m, k, c in parts)


def has_branch(content: Any) -> bool:
    """Whether a root, divisor, logarithm or angle stands anywhere in the terms of a number.

    Such terms may be 0 throughout an open set and not be seen to be, as atan(x) + atan(1/x) - pi/2 for x > 0.
    """
    if isinstance(content, str):
        return content in ("sum", "log", "asin", "acos", "atan", "atan2")
    return isinstance(content, (tuple, frozenset)) and any(map(has_branch, content))


PI = Exact([]).make_atom("pi")
TURN = (1, "cis", frozenset(PI))  # the atom exp(i pi)
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


def check_observability(item: Any) -> None:
    """The rows H, D H, D D H, ... have rank r at the point, and at most r where the zeros vanish around it.

    D a = a' + a F, where ' is the derivative along the motion: symbols have rates, and zeros stay zero. Theorem
    (Hermann and Krener, 1977): let N have n - r columns with H N = 0 and F N - N' = N M where the zeros vanish. Then
    a N = 0 gives (D a) N = (a N)' + a (F N - N') = 0, so that no row sees N. What is a sum of zeros with factors
    vanishes with them, around a point where all that is typed has a value and is smooth.
    """
    _, statement, *parts = read_fields(item, "kind statement point order free null shares bits")
    F, H, rates, zeros, r = read_fields(statement, "F H rates zeros rank")
    point, order, free, null, shares, bits = parts
    n, names = read_integer(len(F), 1, 100), make_symbols([*point])
    places = read_list(free, lambda k: read_integer(k, 0, n - 1), n - read_integer(r, 0, n))
    require(set(rates) <= set(names) and len(null) == len(places), "expected a point of all symbols, n - r vectors")
    slopes = {x: evaluate(parse(rate), names, Exact).parts[0] for x, rate in rates.items()}
    moving = names | {x: Jet(*names[x].parts, slope) for x, slope in slopes.items()}
    A, rows, N, (z,) = (
        [[(Exact(e.parts[0]), Exact([*e.parts, 0][1])) for e in row] for row in read_matrix(part, size, moving, Exact)]
        for part, size in ((F, n), (H, n), (null, n), ([zeros], len(zeros)))
    )
    left = list_remainders(A, rows, N, z, places)
    factors = read_matrix(shares, len(z), names, Exact) if z else [[]] * len(left)
    require(len(factors) == len(left), "expected factors for every remainder")
    for value, row in zip(left, factors, strict=True):
        rest = sum((q.parts[0] * x * -1 for q, (x, _) in zip(row, z, strict=True)), value)
        require(rest.is_zero(), "a direction that is seen, or zeros that do not stay")
    here = {x: evaluate(parse(text), {}, Exact) for x, text in point.items()}
    require(all(e.parts[0].is_zero() for e in read_matrix([zeros], len(z), here, Exact)[0]), "the zeros do not vanish")
    set_precision(bits)
    ctx.cap = read_integer(order, 1, 100) + 1
    series = follow_motion(point, rates, order)
    read_series([zeros, *(shares if z else [])], len(z), series)
    V, a, G = read_series(null, n, series), read_series(H, n, series), read_series(F, n, series)
    require(not any(v[k][0].contains(0) for v, k in zip(V, places, strict=True)), "a pivot that may be zero")
    columns, seen = [*zip(*G, strict=True)], [*a]
    for _ in range(order - 1):
        a = [[x.derivative() + sum(map(mul, row, g)) for x, g in zip(row, columns, strict=True)] for row in a]
        seen += a
    whole = arb_mat([[x[0] for x in row] for row in (*seen, *V)])
    require((whole.transpose() * whole).det() > 0, "the rank may be smaller at the point")


def list_remainders(A: Any, rows: Any, N: Any, z: Any, places: list[int]) -> list[Exact]:
    """z', H N and F N - N' - N M of numbers (value, slope), which have to vanish with the zeros.

    N is diagonal in its places, where F N - N' = N M therefore gives M.
    """
    left = [slope for _, slope in z]
    left += [sum((a * b for (a, _), (b, _) in zip(h, v, strict=True)), Exact(0)) for h, v in product(rows, N)]
    for v in N:
        flow = [sum((a * b for (a, _), (b, _) in zip(row, v, strict=True)), Exact(0)) for row in A]
        flow = [x + slope * -1 for x, (_, slope) in zip(flow, v, strict=True)]
        shares = [flow[k] * u[k][0] ** fmpq(-1) for k, u in zip(places, N, strict=True)]
        left += [sum((m * u[i][0] * -1 for m, u in zip(shares, N, strict=True)), flow[i]) for i in range(len(flow))]
    for (j, v), (k, _) in product(enumerate(N), enumerate(places)):
        require(j == k or not v[places[k]][0].terms, "the vectors are not diagonal in the free places")
    return left


def follow_motion(point: dict[str, Any], rates: dict[str, Any], order: int) -> dict[str, Jet]:
    """The symbols along the motion from a point, as series of the time, by Picard's iteration."""
    start = {x: arb_series([*evaluate(parse(text), {}, arb).parts]) for x, text in point.items()}
    series = {x: Jet(value) for x, value in start.items()}
    for _ in range(order):
        values = {x: arb_series(evaluate(parse(rate), series, arb).parts[0]) for x, rate in rates.items()}
        series |= {x: Jet(start[x] + value.integral()) for x, value in values.items()}
    return series


def read_series(rows: Any, columns: int, series: dict[str, Jet]) -> list[list[arb_series]]:
    return [[arb_series(e.parts[0]) for e in row] for row in read_matrix(rows, columns, series, arb)]


def check_condition(item: Any) -> None:
    """The condition number of a matrix N, or of N with columns of unit length, lies between two numbers; or outside.

    It is the quotient of the largest and the smallest singular value. Their squares are the numbers q for which
    N'N - q D is singular, where D is the unit matrix or the diagonal of N'N. Theorem: as many of them lie above q as
    this matrix has positive pivots, when none is 0 (Sylvester's law of inertia).
    """
    _, statement, outside, brackets, bits = read_fields(item, "kind statement outside brackets bits")
    rows, unit, lower, upper = read_fields(statement, "matrix unit lower upper")
    (low, high), (a, b, c, d) = map(read_number, (lower, upper)), read_list(brackets, read_number, 4)
    set_precision(bits)
    n = read_integer(len(read_list(rows, len)) and len(rows[0]), 1, 200)
    N = fmpq_mat(len(rows), n, [x for row in rows for x in read_list(row, read_number, n)])
    gram = N.transpose() * N
    scale = [gram[j, j] if read_flag(unit) else fmpq(1) for j in range(n)]

    def count_above(q: fmpq) -> int:
        rest, above = [[arb(gram[i, j] - q * scale[j] * (i == j)) for j in range(n)] for i in range(n)], 0
        while rest:
            (pivot, *row), *below = rest
            require(pivot > 0 or pivot < 0, "a pivot that may be 0")
            above += bool(pivot > 0)
            rest = [[x - first / pivot * y for x, y in zip(other, row, strict=True)] for first, *other in below]
        return above

    require(count_above(a) > 0 and count_above(b) == 0, "the largest singular value is not enclosed")
    require(c > 0 and count_above(c) == n > count_above(d), "the smallest singular value is not enclosed")
    require(0 <= low <= high, "expected two ends")
    within, beside = low * low <= max(a / d, fmpq(1)) and b / c <= high * high, b / c < low * low or high * high < a / d
    require(beside if read_flag(outside) else within, "the condition number is not shown to lie there")


# -- 7. Certificates by balls ------------------------------------------------------------------------------------------
Cell = dict[Any, tuple[fmpq, fmpq]]  # a box: middle and radius of each side
UNIT = (HALF, HALF)  # the side [0, 1]


def set_work(bits: Any, cells: Any) -> Iterator[bool]:
    """Set the precision; return as many True as cells may be looked at."""
    set_precision(bits)
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
            require(cell, "the bound is not shown")
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

    def change_basis(self, functions: list[Term], names: dict[str, Jet]) -> list[Jet]:
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


def check_exclusion(item: Any) -> None:
    """A set of at most ``most`` epochs, outside which a state x keeps |z - h.x| <= sigma, has those excluded.

    Where h = sum w_i h_i, a state that keeps the bounds gives |z - sum w_i z_i| <= sigma + sum |w_i| sigma_i (Farkas).
    Where that fails, such a set has an epoch of these rows: the last of each contradiction, and those before it.
    """
    fields = read_fields(item, "kind rows most excluded contradictions bits cells")
    _, rows, most, excluded, contradictions, bits, cells = fields
    budget = set_work(bits, cells)
    table = read_list(rows, lambda row: read_fields(row, "epoch H z sigma"))
    epochs, z, sigma = ([read_number(row[k]) for row in table] for k in (0, 2, 3))
    require(all(s >= 0 for s in sigma), "expected noise bounds that are not negative")
    exact = all(matches(NUMBER, e) for row in table for e in row[1])
    matrix: Any = fmpq_mat if exact else arb_mat
    H = [read_list(row[1], read_number if exact else read_entry) for row in table]
    met = []
    for places in read_list(contradictions, list):
        *basis, last = [read_integer(k, 0, len(table) - 1) for k in places]
        columns = matrix([H[k] for k in basis]).transpose()
        weights = columns.solve(matrix([[e] for e in H[last]])).entries()
        zeros = [w == 0 for w in weights]  # a ball is zero when nothing else is in it
        used = [(w, k) for w, k, zero in zip(weights, basis, zeros, strict=True) if not zero]
        distance = abs(sum((w * -z[k] for w, k in used), z[last]))
        require(distance > sum((abs(w) * sigma[k] for w, k in used), sigma[last]), "no contradiction")
        met.append({epochs[k] for k in (last, *(k for _, k in used))})
    for e in read_list(excluded, read_number):
        require(not can_meet(met, e, read_integer(most, 0, 4), budget), "a set without the epoch may explain the data")


def read_entry(text: Any) -> arb:
    return evaluate(parse(text), {}, arb).enclose()


def can_meet(met: list[set[fmpq]], without: fmpq, most: int, budget: Iterator[bool]) -> bool:
    """Whether at most so many epochs, this one not among them, meet all sets: one of them is in the first."""
    require(next(budget, False), "more sets than announced")
    rest = (([s for s in met if e not in s], without, most - 1, budget) for s in met[:1] for e in s - {without})
    return not met or (most > 0 and any(can_meet(*choice) for choice in rest))


def check_cones(item: Any) -> None:
    """lower <= the least sum of costs c_i(w_i) of vectors w_i with sum H_i' w_i = P <= upper; all numbers are rational.

    c_i(w) is the largest w.r of noise r in a set B_i. If all H_i x lie in their B_i, x.P = sum w_i.(H_i x) is at most
    sum c_i(w_i) for all such w (weak duality, as above). The weights of the certificate show the upper bound.
    """
    _, blocks, functional, dual, *ends, bits = read_fields(item, "kind blocks functional dual lower upper bits")
    set_precision(bits)
    lower, upper = map(read_number, ends)
    P = read_list(functional, read_number)
    x, rest, total = fmpq_mat(len(P), 1, read_list(dual, read_number, len(P))), fmpq_mat(len(P), 1, P), arb(0)
    for H, norm, size, weights in read_list(blocks, lambda block: read_fields(block, "H norm size weights")):
        w = read_list(weights, read_number)
        rows = read_list(H, lambda row: read_list(row, read_number, len(P)), len(w))
        matrix, column = fmpq_mat(len(w), len(P), [e for row in rows for e in row]), fmpq_mat(len(w), 1, w)
        rest -= matrix.transpose() * column
        total += find_cost(norm, size, column, matrix * x)
    require(not any(rest.entries()), "the weights do not carry the functional")
    require((x.transpose() * fmpq_mat(len(P), 1, P))[0, 0] >= lower, "the lower bound is above x.P")
    require(total <= upper, "the weights cost more than the upper bound")


def find_cost(norm: Any, size: Any, w: fmpq_mat, y: fmpq_mat) -> arb:
    """The largest w.r of noise r, where y lies: r' size**-1 r <= 1, |r_j| <= s_j, sum |r_j|/s_j <= 1, or r_j <= 0."""
    n = w.nrows()
    if norm == "nonpositive":
        require(size == [] and all(e >= 0 for e in w.entries()), "a weight below zero")
        require(all(e <= 0 for e in y.entries()), "the dual leaves the noise")
        return arb(0)
    rows = read_list(size, lambda row: read_list(row, read_number, n if norm == "l2" else 1), n)
    if norm == "l2":
        shape = fmpq_mat(n, n, [e for row in rows for e in row])
        require(shape == shape.transpose() and is_definite(shape), "expected a positive definite matrix")
        require((y.transpose() * shape.solve(y))[0, 0] <= 1, "the dual leaves the noise")
        return arb((w.transpose() * shape * w)[0, 0]).sqrt()
    require(norm in ("linf", "l1") and all(s > 0 for (s,) in rows), "expected a norm and positive sizes")
    parts = [abs(e) / s for e, (s,) in zip(y.entries(), rows, strict=True)]
    costs = [abs(e) * s for e, (s,) in zip(w.entries(), rows, strict=True)]
    require((max(parts) if norm == "linf" else sum(parts)) <= 1, "the dual leaves the noise")
    return arb(sum(costs) if norm == "linf" else max(costs))


def check_design(item: Any) -> None:
    """Weights that cost at most ``upper`` need things within the budget; no weights within it cost less than ``lower``.

    A dual x with x.P >= lower refutes all weights on rows with |h.x| <= sigma (weak duality). So lesser weights need,
    for each dual, what one of its failing rows needs; and whoever buys that for all duals exceeds the budget.
    """
    fields = read_fields(item, "kind rows costs budget functional support duals lower upper bits cells")
    _, rows, costs, limit, functional, support, duals, low, high, bits, cells = fields
    budget, lower, upper, most = set_work(bits, cells), *map(read_number, (low, high, limit))
    prices = {name: read_number(price) for name, price in costs.items()}
    table, m = read_list(rows, lambda row: read_fields(row, "H sigma needs")), len(read_list(functional, str))
    sigma, needs = [read_entry(row[1]) for row in table], [frozenset(read_list(row[2], str)) for row in table]
    require(min(prices.values(), default=0) >= 0 and all(s > 0 for s in sigma), "a negative cost or noise bound")
    require(all(n <= prices.keys() for n in needs), "a row needs what has no cost")
    texts = [*(row[0] for row in table), *(["1" if i == k else "0" for i in range(m)] for k in range(m))]
    basis = read_list(support, lambda k: read_integer(k, 0, len(texts) - 1), m)
    exact = all(matches(NUMBER, e) for row in (functional, *(texts[k] for k in basis)) for e in row)
    kind: Any = (fmpq_mat, read_number, {}) if exact else (arb_mat, read_entry, {"algorithm": "lu"})
    matrix, read, way = kind
    columns = matrix([read_list(texts[k], read, m) for k in basis]).transpose()
    weights = columns.solve(matrix([[read(p)] for p in functional]), **way).entries()
    zeros = [w == 0 for w in weights]  # a ball is zero when nothing else is in it
    used = [(abs(w), k) for w, k, zero in zip(weights, basis, zeros, strict=True) if not zero]
    require(all(k < len(table) for _, k in used), "a weight that stands at no row")
    require(sum((sigma[k] * w for w, k in used), arb(0)) <= upper, "the weights cost more than the upper bound")
    H, P = arb_mat([read_list(row[0], read_entry, m) for row in table]), arb_mat([[read_entry(p) for p in functional]])
    failing = []
    for x in read_list(duals, lambda dual: arb_mat([[arb(e)] for e in read_list(dual, read_number, m)])):
        require((P * x)[0, 0] >= lower, "the lower bound is above x.P")
        failing.append({n for n, f, s in zip(needs, (H * x).entries(), sigma, strict=True) if not abs(f) <= s})

    def affordable(names: frozenset[str]) -> bool:
        return sum(prices[name] for name in names) <= most

    def can_buy(bought: frozenset[str]) -> bool:  # what some row of each set needs: of the smallest set without one
        require(next(budget, False), "more selections than announced")
        first = min((s for s in failing if not any(n <= bought for n in s)), key=len, default=None)
        return first is None or any(affordable(bought | n) and can_buy(bought | n) for n in first)

    require(affordable(frozenset().union(*(needs[k] for _, k in used))), "the weights need more than the budget")
    free = frozenset(name for name, price in prices.items() if price == 0)
    require(not can_buy(free), "a selection within the budget may do better")


# -- 9. Statements and their proofs ------------------------------------------------------------------------------------
# A goal says that a term is = 0, != 0, >= 0 or > 0 at all points of a box where the term, and other terms that have to
# exist, are defined. A proof is a tree: an object with a rule, its data and the proofs of its premises, which are goals
# that the rule makes from its own. Each rule states the theorem that makes its goal follow from its premises.


class Range(NamedTuple):
    """The values of a symbol: between two terms without symbols, None at infinity; which of them are left out."""

    low: Term | None
    high: Term | None
    open_low: bool = False
    open_high: bool = False
    nonzero: bool = False
    integer: bool = False


class Goal(NamedTuple):
    """``term relation 0`` on a box, where terms of ``exists`` are defined, of ``given`` >= 0 and of ``zeros`` = 0."""

    term: Term
    relation: str
    box: dict[str, Range]
    exists: tuple[Term, ...] = ()
    given: tuple[Term, ...] = ()
    zeros: tuple[Term, ...] = ()


FLAGS = ("open-low", "open-high", "nonzero", "integer")


def read_range(item: Any) -> Range:
    low, high, flags = read_list(item, lambda entry: entry, 3)
    ends = [None if end is None else parse(end) for end in (low, high)]
    require(all(end is None or not symbols_of(end) for end in ends), "a symbol in the end of a range")
    require(all(end is None or value_of(end, {}).is_finite() for end in ends), "a number that may not exist")
    words = read_list(flags, str)
    require(set(words) <= set(FLAGS), "an unknown flag of a range")
    return Range(ends[0], ends[1], *(flag in words for flag in FLAGS))


class Case(NamedTuple):
    """A part of the points of a statement, given >= 0 and zeros = 0 where terms are defined, and what it says there."""

    goals: list[Goal]
    terms: tuple[Term, ...]
    given: tuple[Term, ...]
    zeros: tuple[Term, ...]
    fractions: tuple[tuple[str, Term], ...] = ()

    def complete(self, place: dict[str, Term]) -> dict[str, Term]:
        """A point with the fractions u - floor(u) of the case."""
        for name, u in self.fractions:
            value = substitute(u, place)
            place = place | {name: subtract(value, find_whole(value))}
        return place


def find_whole(u: Term) -> Term:
    """The whole n with n <= u < n + 1, for a term without symbols."""
    near = value_of(u, {})
    require(near.is_finite(), "a number that may not exist")
    for n in (int(near.mid().floor().unique_fmpz() or 0) + k for k in (0, 1, -1)):
        rest = subtract(u, number(n))
        value = value_of(rest, {})
        if value < 1 and (value >= 0 or is_identity(rest)):
            return number(n)
    raise Refused("a number whose whole part is not known")


SIGNS = {"=": (1, "="), "!=": (1, "!="), ">": (1, ">"), ">=": (1, ">="), "<": (-1, ">"), "<=": (-1, ">=")}
MOST_CASES, FAR = 128, 10**9  # cases of a statement, and the largest whole number that a rule is given


def read_statement(item: Any, answers: Answers | None = None) -> tuple[list[Case], dict[str, Range]]:
    """The cases of a statement, which cover all its points, and its box.

    ``shapes`` has names in the place of the entries of vectors and matrices, ``given`` hypotheses, and ``rates`` the
    derivatives by time. One condition after the other is taken to hold, then to fail; each case has goals of its own.
    ``answers`` say what integrals, sums, products and limits are; ``order`` is that of an equation up to small terms;
    ``random`` has the means and covariances of random numbers and vectors.
    """
    keys = "left relation right symbols exists tolerance"
    keys += " shapes given rates" if isinstance(item, dict) and "given" in item else ""
    keys += "".join(f" {key}" for key in ("order", "random") if isinstance(item, dict) and key in item)
    left, relation, right, symbols, exists, tolerance, *rest = read_fields(item, keys)
    random = rest.pop() if "random" in keys else {}
    small = rest.pop() if "order" in keys else None
    require(isinstance(symbols, dict), "expected ranges by symbol")
    box = {name: read_range(symbols[name]) for name in read_symbols([*symbols])}
    shapes, given, rates = rest or ({}, [], {})
    require(isinstance(random, dict) and not set(random) & set(box), "expected random names without a range")
    names = read_shapes(shapes, box, random)
    limit = None if tolerance is None else parse(tolerance)
    require(relation in SIGNS, "an unknown relation")
    cases: list[Case] = []
    choices: list[bool] | None = []
    while choices is not None:
        require(len(cases) < MOST_CASES, "too many cases")
        reader = Reader(names, rates, choices, box)
        reader.read_chances(random)
        for text in read_list(given, str):
            reader.assume(text)
        for text in read_list(exists, str):
            reader.need(*list_entries(reader.read(text)))
        goals = state_goals(reader.read(left), relation, reader.read(right), limit)
        goals = settle_questions(reader, goals, box, answers or Answers([]))
        require(small is None or not reader.fractions, "an order of a floor")
        goals = goals if small is None else expand_goals(reader, goals, small, box)
        cases.append(reader.make_case(goals, box))
        choices = next_choices(reader.choices)
    require(answers is None or not answers.entries, "an answer without a question")
    return cases, box


def read_shapes(shapes: Any, box: dict[str, Range], random: Any) -> dict[str, Value]:
    """The vectors and matrices by name: entries are symbols of the box, and a symbol may stand in several places.

    The entries of random ones have no range.
    """
    require(isinstance(shapes, dict) and not {"pi", *shapes} & set(box), "a name given twice, or pi")
    names: dict[str, Value] = {}
    for name in [*shapes]:
        require(matches("[A-Za-z][A-Za-z0-9_]*", name) and name != "pi", "expected names")
        rows = read_list(shapes[name], lambda row: read_list(row, lambda e: ("symbol", e)))
        known = all((entry[1] in box) != (name in random) for row in rows for entry in row)
        require(known, "an entry without a range, or a random one with a range")
        names[name] = Matrix(rows)
    return names


def state_goals(x: Value, relation: str, y: Value, tolerance: Term | None) -> list[tuple[Term, str, tuple[Term, ...]]]:
    """Terms with their relation to 0 and what stands in them: one for each entry; matrices differ where one does."""
    require(shape_of(x) == shape_of(y), "sides of different shapes")
    pairs = [*zip(list_entries(x), list_entries(y), strict=True)]
    parts = tuple(entry for pair in pairs for entry in pair)
    differences = [subtract(*pair) for pair in pairs]
    if tolerance is not None:
        require(relation == "=", "a tolerance of an inequality")
        sides = [("+", tolerance, sign) for d in differences for sign in (d, negate(d))]
        return [(side, ">=", (*parts, tolerance)) for side in sides]
    sign, own = SIGNS[relation]
    require(not isinstance(x, Matrix) or own in ("=", "!="), "matrices have no order")
    if isinstance(x, Matrix) and own == "!=":
        return [(("+", ZERO, *(("*", d, d) for d in differences)), own, parts)]
    return [(d if sign == 1 else subtract(y, x), own, parts) for d in differences]  # type: ignore[arg-type]


# Vectors and matrices are read as the terms of their entries; a vector is a matrix of one column. All of a text has to
# have a value, also an entry that is not used, but for the branch of a where that is not taken.


def list_entries(x: Value) -> list[Term]:
    return [entry for row in x.rows for entry in row] if isinstance(x, Matrix) else [x]


def to_column(x: Value, size: int | None = None) -> list[Term]:
    require(isinstance(x, Matrix) and len(x.rows[0]) == 1 and size in (None, len(x.rows)), "expected a vector")
    return [row[0] for row in x.rows]  # type: ignore[union-attr]


def to_square(x: Value, most: int) -> list[list[Term]]:
    require(isinstance(x, Matrix) and len(x.rows) == len(x.rows[0]) <= most, f"expected n by n with n <= {most}")
    return x.rows  # type: ignore[union-attr]


def make_column(*entries: Term) -> Matrix:
    return Matrix([entry] for entry in entries)


def make_sum(*terms: Term) -> Term:
    return ("+", *terms) if len(terms) > 1 else terms[0]


def multiply_matrices(x: Value, y: Value) -> Value:
    """Rows times columns; a product of one entry is a number."""
    require(isinstance(x, Matrix) and isinstance(y, Matrix) and len(x.rows[0]) == len(y.rows), "shapes that do not fit")
    columns = [*zip(*y.rows, strict=True)]  # type: ignore[union-attr]
    rows = [[make_sum(*(("*", a, b) for a, b in zip(r, c, strict=True))) for c in columns] for r in x.rows]  # type: ignore
    return rows[0][0] if len(rows) == len(columns) == 1 else Matrix(rows)


def cross(x: Value, y: Value) -> Value:
    """u x v = (u2 v3 - u3 v2, u3 v1 - u1 v3, u1 v2 - u2 v1)."""
    (a, b, c), (d, e, f) = to_column(x, 3), to_column(y, 3)
    rows = ((b, f, c, e), (c, d, a, f), (a, e, b, d))
    return make_column(*(subtract(("*", p, q), ("*", r, s)) for p, q, r, s in rows))


def scalar_product(x: Value, y: Value) -> Term:
    u, v = to_column(x), to_column(y)
    require(len(u) == len(v), "vectors of different lengths")
    return make_sum(*(("*", a, b) for a, b in zip(u, v, strict=True)))


def skew(x: Value) -> Value:
    """The matrix [v] with [v] u = v x u."""
    a, b, c = to_column(x, 3)
    return Matrix([[ZERO, negate(c), b], [c, ZERO, negate(a)], [negate(b), a, ZERO]])


def minor(rows: list[list[Term]], i: int, j: int) -> Term:
    return determinant([row[:j] + row[j + 1 :] for k, row in enumerate(rows) if k != i])


def determinant(rows: list[list[Term]]) -> Term:
    """Laplace: expansion along the first row; the determinant of no rows is 1."""
    if len(rows) < 2:
        return rows[0][0] if rows else ONE
    terms = [("*", entry, minor(rows, 0, j)) for j, entry in enumerate(rows[0])]
    return ("+", *(negate(t) if j % 2 else t for j, t in enumerate(terms)))


def invert(x: Value) -> Value:
    """Cramer: the transposed matrix of the cofactors over the determinant, which has to be != 0."""
    rows = to_square(x, 4)
    inverse, places = ("^", determinant(rows), MINUS_ONE), range(len(rows))
    cofactors = [[negate(minor(rows, i, j)) if (i + j) % 2 else minor(rows, i, j) for i in places] for j in places]
    return Matrix([("*", entry, inverse) for entry in row] for row in cofactors)


def multiply_quaternions(x: Value, y: Value) -> Value:
    """Hamilton's product, scalars first: (a + u)(b + v) = ab - u.v + a v + b u + u x v."""
    (a, *u), (b, *v) = to_column(x, 4), to_column(y, 4)
    w = to_column(cross(make_column(*u), make_column(*v)))
    scalar = subtract(("*", a, b), scalar_product(make_column(*u), make_column(*v)))
    return make_column(scalar, *(("+", ("*", a, q), ("*", b, p), r) for p, q, r in zip(u, v, w, strict=True)))


def conjugate(x: Value) -> Value:
    scalar, *rest = to_column(x, 4)
    return make_column(scalar, *map(negate, rest))


def rotation_of(x: Value) -> Value:
    """The matrix R of v -> q v q*, from body to frame (Solà, Quaternion kinematics, 2017, equation 115)."""
    w, x1, y1, z1 = to_column(x, 4)

    def two(a: Term, b: Term, sign: int, c: Term, d: Term) -> Term:
        return ("*", number(2), ("+", ("*", a, b), ("*", number(sign), c, d)))

    def square(own: Term, *others: Term) -> Term:
        return ("+", ("*", w, w), ("*", own, own), *(("*", MINUS_ONE, o, o) for o in others))

    return Matrix(
        [
            [square(x1, y1, z1), two(x1, y1, -1, w, z1), two(x1, z1, 1, w, y1)],
            [two(x1, y1, 1, w, z1), square(y1, x1, z1), two(y1, z1, -1, w, x1)],
            [two(x1, z1, -1, w, y1), two(y1, z1, 1, w, x1), square(z1, x1, y1)],
        ]
    )


def make_diagonal(*values: Value) -> Value:
    entries = to_column(values[0]) if len(values) == 1 and isinstance(values[0], Matrix) else [*map(to_number, values)]
    return Matrix([e if i == j else ZERO for j in range(len(entries))] for i, e in enumerate(entries))


def read_size(x: Value) -> int:
    require(not isinstance(x, Matrix) and x[0] == "number" and x[1].q == 1 and 1 <= x[1] <= 64, "expected a size")
    return int(x[1])  # type: ignore[index]


#: Functions of values; what is given other arguments than it has is refused.
CALLS: dict[str, Callable[..., Value]] = {
    "cross": cross,
    "dot": scalar_product,
    "norm": lambda x: ("sqrt", make_sum(*(("*", a, a) for a in to_column(x)))),
    "skew": skew,
    "det": lambda x: determinant(to_square(x, 5)),
    "inv": invert,
    "trace": lambda x: make_sum(*(row[i] for i, row in enumerate(to_square(x, 64)))),
    "transpose": lambda x: x.transpose(),
    "eye": lambda n: make_diagonal(*[ONE] * read_size(n)),
    "zeros": lambda m, n: Matrix([ZERO] * read_size(n) for _ in range(read_size(m))),
    "diag": make_diagonal,
    "qmul": multiply_quaternions,
    "conj": conjugate,
    "rot": rotation_of,
}
FRACTION = "fraction__"  # names of u - floor(u), which no text has
MARKS = re.compile(r" *([0-9]+(?:\.[0-9]+)?|[A-Za-z][A-Za-z0-9_]*|\*\*|[<>!]=|[-+*/(),@.\[\]<>=])")


class Reader:
    """Reads the texts of one case: the conditions that it meets get the choices, and then they are taken to hold."""

    def __init__(self, names: dict[str, Value], rates: Any, choices: list[bool], box: dict[str, Range] | None = None):
        self.names, self.rates, self.wanted, self.box = names, rates, choices, box or {}
        require(isinstance(rates, dict), "expected rates by name")
        self.choices: list[bool] = []
        self.met: dict[tuple[str, Term], bool] = {}
        self.slopes: dict[str, Term | None] = {}
        self.dead = self.conditions = 0
        self.exists, self.given, self.zeros = (dict[Term, None]() for _ in range(3))
        self.questions: list[Question] = []
        self.fractions: dict[str, Term] = {}
        self.floors: dict[Term, None] = {}
        self.chances: dict[str, Chance] = {}
        self.outside, self.bound = names, dict[str, str]()  # names of arrays; symbols of variables of questions

    def read(self, text: Any) -> Value:
        """The value of a text."""
        formula = Formula(text, self)
        value = formula.read_sum()
        require(formula.words == [""], "not an expression: more than one")
        return value

    def assume(self, text: Any) -> None:
        """A hypothesis, of numbers or of matrices."""
        formula = Formula(text, self)
        relation, difference = formula.read_relation()
        require(formula.words == [""], "not a hypothesis: more than one")
        require(relation == "=" or not isinstance(difference, Matrix), "matrices have no order")
        for term in list_entries(difference):
            self.suppose(relation, term)

    def suppose(self, relation: str, term: Term) -> None:
        """Note that a term has a value, and this relation to 0."""
        self.need(term)
        if relation == "=":
            self.zeros[term] = None
        if relation in (">", ">="):
            self.given[term] = None
        if relation in (">", "!="):
            self.need(("^", term, MINUS_ONE))

    def need(self, *terms: Term) -> None:
        """Note terms that have to have a value."""
        if not self.dead:
            self.exists |= dict.fromkeys(t for t in terms if t[0] not in ("symbol", "number"))

    def choose(self, relation: str, term: Term) -> bool:
        """Whether a condition is taken to hold in this case; one that is met again has the same answer."""
        require(not symbols_of(term) & set(self.bound), "cases of a bound variable")
        if relation == "!=":
            return not self.choose("=", term)
        self.conditions += 1
        if self.dead:
            return True
        if not symbols_of(term) and (self.bound or self.names != self.outside):
            value = value_of(term, {})
            if value > 0 or value < 0:
                return bool(value > 0) and relation != "="
            require(value.is_finite() and is_identity(term), "a number whose sign is not known")
            return relation != ">"
        known = self.recall(relation, term)
        if known is not None:
            self.need(term)
            return known
        if (relation, term) not in self.met:
            taken = self.wanted[len(self.choices)] if len(self.choices) < len(self.wanted) else True
            self.choices.append(taken)
            self.met[relation, term] = taken
            opposite = {">": ">=", ">=": ">", "=": "!="}[relation]
            self.suppose(relation if taken else opposite, term if taken or relation == "=" else negate(term))
        return self.met[relation, term]

    def recall(self, relation: str, term: Term) -> bool | None:
        """The answer that follows from another condition on the same number, or on the one with the other sign."""
        for (other, known), taken in self.met.items():
            same = is_identity(subtract(term, known))
            if not same and not is_identity(("+", term, known)):
                continue
            sharp = other == (">" if taken else ">=")
            if "=" in (other, relation):
                if other == relation:
                    return taken
            elif same == taken:  # term > 0, or >= 0
                return True if sharp or relation == ">=" else not self.choose("=", term)
            else:  # term < 0, or <= 0
                return False if sharp or relation == ">" else self.choose("=", term)
        return None

    def make_case(self, goals: list[tuple[Term, str, tuple[Term, ...]]], box: dict[str, Range]) -> Case:
        """The goals of this case on its box."""
        shared = {id(parts): parts for _, _, parts in goals}.values()  # entries of one matrix have one tuple
        terms = tuple(dict.fromkeys((*(t for parts in shared for t in parts), *self.exists)))
        box = box | dict.fromkeys(self.fractions, Range(ZERO, ONE, open_high=True))
        names = set().union(*map(symbols_of, (*terms, *self.zeros, *self.given)))
        require(names <= set(box), "a symbol without a range")
        own = tuple(t for t in terms if conditions(t))
        given, zeros = tuple(self.given), tuple(self.zeros)
        stated = [cut_box(Goal(term, relation, box, own, given, zeros)) for term, relation, _ in goals]
        return Case(stated, (*terms, *zeros), given, zeros, tuple(self.fractions.items()))

    def require_plain(self, term: Term, what: str) -> None:
        """Refuse a term with the symbol of a question or of a fraction, which depends on others."""
        require(not is_asked(term), f"{what} of an integral, sum, product or limit")
        require(not symbols_of(term) & set(self.fractions), f"{what} of a floor")

    def require_real(self, name: str) -> None:
        """Refuse a whole number as a variable: where floor(n) was read as n, n is whole."""
        require(name not in self.box or not self.box[name].integer, "a whole number that varies")

    def find_floor(self, x: Term) -> Term:
        """floor(x) as x - f with a symbol f, 0 <= f < 1; floor(n + u) = n + floor(u) for what is seen to be whole.

        What holds for all such f holds for that of x; equal numbers have one. Where n <= u < n + 1, f is u - n.
        """
        self.need(x)
        whole = [t for t in self.list_parts(x) if is_integral(t, self.box, self.floors)]
        rest = [t for t in self.list_parts(x) if t not in whole]
        if self.dead or not rest:
            return x
        u = make_sum(*rest)
        require(not symbols_of(u) & set(self.bound), "a floor of a bound variable")
        if not symbols_of(u):
            return make_sum(*whole, find_whole(u))
        ends = (substitute(u, {s: r[k] for s, r in self.box.items() if r[k]}) for k in (0, 1))  # type: ignore[misc]
        near = (e for e in ends if not symbols_of(e) and abs(value_of(e, {})) < FAR)
        low, *high = sorted(int(find_whole(e)[1].p) for e in near) or [0]
        is_new = not self.choices or self.recall(">=", subtract(u, number(low))) is not None
        if high and high[0] - low < 4 and is_new and self.choose(">=", subtract(u, number(low))):
            for n in range(low, high[0] + 1):
                if self.choose(">", subtract(number(n + 1), u)):
                    return make_sum(*whole, number(n))
        own = f"{FRACTION}{len(self.fractions) + 1}"
        name = next((f for f, v in self.fractions.items() if is_identity(subtract(u, v))), own)
        require(name not in self.box, "a name that is in use")
        self.fractions.setdefault(name, u)
        value = subtract(u, ("symbol", name))
        self.floors[value] = None
        return make_sum(*whole, value)

    def list_parts(self, x: Term) -> list[Term]:
        """The terms of a sum; a floor is one of them."""
        is_sum = x[0] == "+" and x not in self.floors
        return [t for part in x[1:] for t in self.list_parts(part)] if is_sum else [x]

    def read_chances(self, random: Any) -> None:
        """Random numbers and vectors, independent of one another: means, and covariances, which are symmetric and >= 0.

        Sylvester: a symmetric matrix is >= 0 just where all its principal minors are.
        """
        for group, item in random.items():
            mean, covariance, normal = read_fields(item, "mean cov normal")
            entries = [entry[1] for entry in list_entries(self.names.get(group, ("symbol", group)))]
            m, c = list_entries(self.read(mean)), self.read(covariance)
            rows = c.rows if isinstance(c, Matrix) else [[c]]
            sizes = {len(entries), len({*entries}), len(m), len(rows), len(rows[0])}
            require(len(sizes) == 1 and len(m) <= 4, "expected a mean and a covariance for up to 4 numbers")
            require(type(normal) is bool and not set(entries) & {*self.chances, *self.box}, "a name given twice")
            self.need(*m)
            for k in range(1, len(m) + 1):
                for chosen in combinations(range(len(m)), k):
                    self.suppose(">=", determinant([[rows[i][j] for j in chosen] for i in chosen]))
            for i, j in combinations(range(len(m)), 2):
                self.suppose("=", ZERO if rows[i][j] == rows[j][i] else subtract(rows[i][j], rows[j][i]))
            for entry, middle, row in zip(entries, m, rows, strict=True):
                self.chances[entry] = Chance(group, middle, dict(zip(entries, row, strict=True)), normal)

    def expect(self, term: Term) -> Term:
        """The expectation of a polynomial in random numbers, by linearity: a sum of moments."""
        self.require_plain(term, "an expectation")
        chances = set(self.chances)
        for relation, t in conditions(term):
            require(not symbols_of(t) & chances, "a random number below a line or in a function")
            self.need(EXISTING[relation](t))
        parts = [*dict.fromkeys(list_generators(term))]
        fixed = [part[0] != "symbol" or part[1] not in chances for part in parts]
        own = [part for part, known in zip(parts, fixed, strict=True) if known]
        require(not any(symbols_of(part) & chances for part in own), "a random number in a function")  # E(E(w sin w))
        ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(parts))], Ordering.degrevlex)
        top, bottom = to_quotient(term, dict(zip(parts, ring.gens(), strict=True)), ring)

        def write(polynomial: fmpq_mpoly) -> Term:
            rows = []
            for powers, c in polynomial.to_dict().items():
                pairs = [*zip(parts, map(int, powers), fixed, strict=True)]
                factors = [("^", part, number(n)) for part, n, known in pairs if known and n]
                word = [part[1] for part, n, known in pairs if not known for _ in range(n)]
                rows.append(("*", number(c), *factors, self.find_moment(word)))
            return ("+", ZERO, *rows)

        require(not any(n for p in bottom.to_dict() for n, known in zip(p, fixed, strict=True) if not known), "below")
        return ("*", write(top), ("^", write(bottom), MINUS_ONE))

    def find_moment(self, word: Sequence[str]) -> Term:
        """The expectation of a product of random numbers.

        Independent factors have the product of their expectations. Theorem (Stein): E x f = m E f + sum_j c_j E df/dx_j
        for normal numbers with E x = m and cov(x, x_j) = c_j; for any numbers if f has degree 1.
        """
        if not word:
            return ONE
        own = self.chances[word[0]]
        rest = [name for name in word[1:] if self.chances[name].group == own.group]
        others = [name for name in word[1:] if self.chances[name].group != own.group]
        require(len(word) <= 8 and (own.normal or len(rest) < 2), "a moment that is not declared")
        pairs = [("*", own.row[x], self.find_moment(rest[:k] + rest[k + 1 :])) for k, x in enumerate(rest)]
        return ("*", ("+", ("*", own.mean, self.find_moment(rest)), *pairs), self.find_moment(others))

    def find_covariance(self, x: Value, y: Value | None = None) -> Value:
        """E (x - E x)(y - E y)'."""
        u, v = (change_entries(lambda t: subtract(t, self.expect(t)), z) for z in (x, x if y is None else y))
        if isinstance(u, Matrix) and isinstance(v, Matrix):
            to_column(u), to_column(v)
            return change_entries(self.expect, multiply_matrices(u, v.transpose()))
        return self.expect(("*", to_number(u), to_number(v)))

    def differentiate(self, x: Value, name: str) -> Value:
        """The derivative by a symbol, where there is one; by time, t or no name, it is that of all that has a rate."""
        for entry in list_entries(x):
            self.require_plain(entry, "a derivative")
        self.need(*(t for entry in list_entries(x) for t in (entry, *smoothness(entry))))
        if not name or (name == "t" and "t" in self.rates):
            return change_entries(self.differentiate_by_time, x)
        self.require_real(name)
        return change_entries(lambda term: differentiate(term, name), x)

    def differentiate_by_time(self, term: Term) -> Term:
        """The chain rule: the sum of df/ds ds/dt over the symbols that have a rate; the others are constant."""
        self.require_plain(term, "a derivative")
        slopes = self.slopes = self.slopes or self.list_rates()
        rows = [(name, slopes[name]) for name in sorted(symbols_of(term)) if name in slopes]
        require(all(rate is not None for _, rate in rows), "no rate is known")
        for own, _ in rows:
            self.require_real(own)
        return add_terms(multiply_terms(differentiate(term, name), rate) for name, rate in rows)  # type: ignore[arg-type]

    def list_rates(self) -> dict[str, Term | None]:
        """Rates by the symbols of the entries."""
        slopes: dict[str, Term | None] = {}
        before, names, self.names = self.conditions, self.names, self.outside  # no variable of a question stands there
        for name, text in self.rates.items():
            entries = list_entries(self.names.get(name, ("symbol", name)))
            rate = None if text is None else self.read(text)
            require(rate is None or shape_of(rate) == shape_of(self.names.get(name, ONE)), "a rate of another shape")
            rows = [None] * len(entries) if rate is None else list_entries(rate)
            pairs = [(entry[1], row) for entry, row in zip(entries, rows, strict=True)]
            require(all(slopes.get(own, row) == row for own, row in pairs), "two rates of one symbol")
            slopes |= dict(pairs)
        self.names = names
        require(before == self.conditions, "a rate of cases")
        return slopes


class Chance(NamedTuple):
    """A random number: what it is not independent of, its mean, its covariances with these, whether they are normal."""

    group: str
    mean: Term
    row: dict[str, Term]
    normal: bool


def take_off(x: Term, y: Term) -> Term:
    """x - y, and x where y is the number 0: a range is cut by what is said of a symbol alone."""
    return x if y == ZERO else negate(y) if x == ZERO else subtract(x, y)


def smoothness(term: Term) -> list[Term]:
    """Terms with a value only where a term is differentiable."""
    return [EXISTING[relation](t) for relation, t in conditions(term, DIFFERENTIABLE)]


def next_choices(choices: list[bool]) -> list[bool] | None:
    """The choices after these: the last condition that was taken to hold fails; None after the last ones."""
    while choices and not choices[-1]:
        choices = choices[:-1]
    return [*choices[:-1], False] if choices else None


def cut_box(goal: Goal) -> Goal:
    """The goal with ranges cut by the hypotheses that say s >= 0 or -s >= 0 of a symbol."""
    for term in goal.given:
        upper = int(term[0] == "*" and term[1:-1] == (MINUS_ONE,))
        name = term[-1] if upper else term
        if name[0] == "symbol":
            goal = cut_range(goal, name[1], upper)
    return goal


class Formula(Parser):
    """The language of files: numbers, vectors and matrices, conditions and derivatives, as values."""

    def __init__(self, text: Any, reader: Reader):
        require(isinstance(text, str) and len(text) <= 400000, "expected a text")
        self.words, self.reader = ["", *reversed(MARKS.findall(text))], reader
        require(sum(map(len, self.words)) == len(text.replace(" ", "")), "unexpected characters")

    def read_entry(self) -> Any:
        """A value with .T or indices, which count from 1, behind it."""
        value = self.read_value()
        while mark := self.take(".", "["):
            require(isinstance(value, Matrix), "expected a vector or matrix before . and [")
            if mark == ".":
                require(self.take("T"), "expected T behind the point")
                value = value.transpose()
                continue
            places = [read_size(self.read_value())]
            if self.take(","):
                places.append(read_size(self.read_value()))
            require(self.take("]"), "not an expression: no ]")
            require(len(places) == 2 or len(value.rows[0]) == 1, "expected two indices of a matrix")
            i, j = places if len(places) == 2 else (*places, 1)
            require(i <= len(value.rows) and j <= len(value.rows[0]), "an index beyond the last one")
            self.reader.need(*list_entries(value))
            value = value.rows[i - 1][j - 1]
        return value

    def read_value(self) -> Any:
        """A number, a name, a call, rows in brackets, or a sum in parentheses."""
        word = self.words.pop()
        if word[:1].isdigit():
            return ("number", read_number(word))
        if word == "[":
            return self.read_rows()
        if word[:1].isalpha():
            if self.take("("):
                return self.read_call(word)
            require(not word.startswith(FRACTION), "a name that is in use")
            return ("pi",) if word == "pi" else self.reader.names.get(word, ("symbol", word))
        require(word == "(", "not an expression")
        (inside,) = self.read_arguments()
        return inside

    def read_rows(self) -> Matrix:
        """A vector by its entries, or a matrix by its rows."""
        rows: list[list[Term]] = []
        deep = self.words[-1] == "["
        while not rows or self.take(","):
            require(not deep or self.take("["), "expected a row in brackets")
            row = [to_number(self.read_sum())]
            while deep and self.take(","):
                row.append(to_number(self.read_sum()))
            require(not deep or self.take("]"), "not an expression: no ]")
            rows.append(row)
        require(self.take("]"), "not an expression: no ]")
        return Matrix(rows)

    def read_relation(self) -> tuple[str, Value]:
        """A relation to 0, one of = != > >=, and the difference of which it is said."""
        x = self.read_sum()
        word = self.take(*SIGNS)
        require(word, "expected a relation")
        y = self.read_sum()
        sign, relation = SIGNS[word]
        return relation, change_entries(take_off, x, y) if sign == 1 else change_entries(take_off, y, x)

    def read_call(self, name: str) -> Any:
        """A function of values; where, min, max and sign are cases, diff and dot_ derivatives, E and cov moments."""
        if name == "where":
            return self.read_where()
        if name in QUESTIONS:
            return self.read_question(name)
        reader, before, outside = self.reader, self.reader.conditions, self.reader.bound
        reader.bound = outside | ({"": name} if name in ("diff", "dot_") else {})
        arguments = self.read_arguments()
        reader.bound = outside
        if name in ("min", "max"):
            return reduce(lambda x, y: self.pick(name, x, y), map(to_number, arguments))
        if name in ("diff", "dot_"):
            require(before == self.reader.conditions, "a derivative of cases")
            return self.differentiate(name, *arguments)
        if name in ("E", "cov"):
            return change_entries(reader.expect, *arguments) if name == "E" else reader.find_covariance(*arguments)
        if name == "expm":
            return self.ask_exponential(*arguments)
        if name in CALLS:
            if name == "trace":
                self.reader.need(*list_entries(arguments[0]))
            return CALLS[name](*arguments)
        terms = [*map(to_number, arguments)]
        if name in ("sign", "floor"):
            return self.find_sign(*terms) if name == "sign" else self.reader.find_floor(*terms)
        return call(name, terms)

    def read_where(self) -> Any:
        """where(condition, a, b): a where it holds, b elsewhere; what is not taken need not have a value.

        Below an integral both need one, and the value is (a + b + (a - b) sign)/2.
        """
        reader, (relation, difference) = self.reader, self.read_relation()
        u, values = to_number(difference), list[Value]()
        taken = None if relation in (">", ">=") and self.has_sides(u) else reader.choose(relation, u)
        known = [*reader.exists], len(reader.questions)
        for branch in (False, True):
            require(self.take(","), "expected where(condition, a, b)")
            reader.dead += taken is branch
            values.append(self.read_sum())
            reader.dead -= taken is branch
        require(self.take(")"), "not an expression: no )")
        x, y = values
        require(shape_of(x) == shape_of(y), "branches of different shapes")
        if taken is not None:
            return x if taken else y
        plain = all(self.has_sides(t) for v in values for e in list_entries(v) for _, t in conditions(e))
        require(plain and known == ([*reader.exists], len(reader.questions)), "a branch that may have no value")
        side = self.find_sign(u)
        return change_entries(lambda a, b: ("*", number(HALF), ("+", a, b, ("*", subtract(a, b), side))), x, y)

    def cut_body(self) -> tuple[list[str], str]:
        """The words before the first comma, which are taken, and the name behind it."""
        depth, k = 0, len(self.words) - 1
        while k > 1 and (depth or self.words[k] != ","):
            depth += (self.words[k] in ("(", "[")) - (self.words[k] in (")", "]"))
            k -= 1
        body, self.words = self.words[k + 1 :], self.words[:k]
        return body, self.words.pop()

    def read_body(self, body: list[str], kind: str, name: str, value: Term) -> tuple[Value, list[Term]]:
        """What stands there with a value in the place of a name, and what has to have a value for it."""
        reader, words = self.reader, self.words
        own = {} if value[0] != "symbol" else {value[1]: Range(None, None, integer=kind in ("sum", "product"))}
        names, bound, exists, box = reader.names, reader.bound, reader.exists, reader.box
        self.words, reader.exists, reader.names = ["", *body], {}, names | {name: value}
        reader.bound, reader.box = bound | dict.fromkeys(own, kind), box | own
        found, needs = self.read_sum(), [*reader.exists]
        require(self.words == [""], f"expected a variable in {kind}")
        self.words, reader.names, reader.bound, reader.exists, reader.box = words, names, bound, exists, box
        return found, needs

    def read_question(self, kind: str) -> Value:
        """integral(f, x, a, b), sum and product the same, limit(f, x, a): symbols for entries of f, or all terms."""
        reader, first, whole = self.reader, len(self.reader.questions), kind in ("sum", "product")
        body, name = self.cut_body()
        taken = matches("[A-Za-z][A-Za-z0-9_]*", name) and name not in ("pi", "oo", *reader.rates, *reader.chances)
        require(taken and name not in reader.outside, f"expected the name of a number in {kind}")
        variable, ends = f"{name}'{len(reader.bound)}", list[Term]()  # no text has this name
        found, needs = (ZERO, []) if whole else self.read_body(body, kind, name, ("symbol", variable))
        while self.take(","):
            ends.append(to_number(self.read_sum()))
        require(self.take(")") and len(ends) == 2 - (kind == "limit"), f"expected the ends of {kind}, and )")
        if whole and all(constant_of(end) is not None for end in ends):
            return self.write_out(kind, name, body, ends)
        if whole:
            found, needs = self.read_body(body, kind, name, ("symbol", variable))
        require(not reader.fractions, f"{kind} beside a floor")
        reader.need(*(t for t in needs if variable not in symbols_of(t)))
        needs, own = [t for t in needs if variable in symbols_of(t)], f"{name}__{len(reader.questions) + 1}"
        bound = {variable: ("symbol", own)}
        around = Question(kind, "", own, ZERO, ends[0], ends[-1], tuple(substitute(t, bound) for t in needs), ())
        inner = [q.change(lambda t: substitute(t, bound)) for q in reader.questions[first:]]
        reader.questions[first:] = [q._replace(within=(*q.within, around)) for q in inner]

        def ask(term: Term) -> Term:
            if reader.dead:
                return ZERO
            reader.questions.append(
                around._replace(value=f"value {len(reader.questions) + 1}", term=substitute(term, bound))
            )
            return ("symbol", reader.questions[-1].value)

        return change_entries(ask, found if kind != "product" else to_number(found))

    def ask_exponential(self, x: Value) -> Value:
        """expm(A): symbols in the place of its entries."""
        reader, rows, entries = self.reader, to_square(x, 16), list_entries(x)
        reader.need(*entries)
        for entry in entries:
            reader.require_plain(entry, "an exponential")
        if reader.dead:
            return Matrix(rows)
        own = f"s__{len(reader.questions) + 1}"
        value = f"value {len(reader.questions) + 1}"
        reader.questions.append(Question("expm", value, own, ("matrix", *entries), ZERO, ONE, (), ()))
        return Matrix([("symbol", f"{value} {i} {j}") for j in range(len(rows))] for i in range(len(rows)))

    def write_out(self, kind: str, name: str, body: list[str], ends: list[Term]) -> Value:
        """A sum or product with numbers as ends; one of no terms is 0 or 1."""
        terms = list[Value]()
        for k in list_whole(*ends):
            found, needs = self.read_body(body, kind, name, number(k))
            self.reader.need(*list_entries(found), *needs)
            terms.append(found if kind == "sum" else to_number(found))
        return change_entries(lambda *parts: combine(kind, parts), *terms) if terms else combine(kind, ())

    def has_sides(self, x: Term) -> bool:
        """Whether a number has the variable of an integral, which does not see where it is 0."""
        return any(self.reader.bound.get(name) == "integral" for name in symbols_of(x))

    def pick(self, name: str, x: Term, y: Term) -> Term:
        """The smaller or the larger of two numbers, which both need a value: below a question (x + y +- |x - y|)/2."""
        if self.reader.bound:
            gap = ("abs", subtract(x, y))
            return ("*", number(HALF), ("+", x, y, gap if name == "max" else negate(gap)))
        return x if self.reader.choose(">=", subtract(y, x)) == (name == "min") else y

    def find_sign(self, x: Term) -> Term:
        """0, 1 or -1; below an integral x/|x|, which its pieces have to see defined."""
        if self.has_sides(x):
            return ("*", x, ("^", ("abs", x), MINUS_ONE))
        if self.reader.choose("=", x):
            return ZERO
        return ONE if self.reader.choose(">", x) else MINUS_ONE

    def differentiate(self, name: str, x: Value, by: Value | None = None, times: Value = ONE) -> Value:
        """diff(x, symbol, times), or dot_(x) by time."""
        if name == "dot_":
            require(by is None, "expected dot_ of 1 argument")
            return self.reader.differentiate(x, "")
        is_symbol = by is not None and not isinstance(by, Matrix) and by[0] == "symbol" and not is_asked(by)
        require(is_symbol, "expected a symbol behind diff")
        require(read_size(times) <= 8, "a derivative of a high order")
        return reduce(lambda y, _: self.reader.differentiate(y, by[1]), range(read_size(times)), x)  # type: ignore[index]


def subtract(x: Term, y: Term) -> Term:
    return ("+", x, negate(y))


def replace(term: Term, old: Term, new: Term) -> Term:
    """The term with every part that is ``old`` replaced."""
    if term == old:
        return new
    return tuple(replace(part, old, new) if isinstance(part, tuple) else part for part in term)


def substitute(term: Term, values: dict[str, Term]) -> Term:
    """The term with its symbols replaced, all at once."""
    if term[0] == "symbol":
        return values.get(term[1], term)
    return tuple(substitute(part, values) if isinstance(part, tuple) else part for part in term)


def list_exponents(term: Term, besides: Term = ()) -> Iterator[Term]:
    """The exponents in a term, but for those in its parts that are ``besides``."""
    if term != besides:
        if term[0] == "^":
            yield term[2]
        for part in term[1:]:
            if isinstance(part, tuple):
                yield from list_exponents(part, besides)


def keep_power(narrow: Term, wide: Term) -> None:
    """An exponent in the place of an equal one: b**q with a rational q exists for b <= 0, other powers do not."""
    q = constant_of(wide)
    require(q is None or constant_of(narrow) == q, "another exponent")


def is_identity(term: Term) -> bool:
    """Whether a term is seen to vanish wherever it is defined: as a quotient of polynomials, or by its normal form."""
    parts = [*dict.fromkeys(list_generators(term))]
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(parts))], Ordering.degrevlex)
    top, bottom = to_quotient(term, dict(zip(parts, ring.gens(), strict=True)), ring)
    if bottom != 0 and top == 0:
        return True
    if all(part[0] == "symbol" for part in parts):
        return False
    EFFORT[0] = 0
    return bool(evaluate(term, make_symbols(sorted(symbols_of(term))), Exact).parts[0].is_zero())


def list_generators(term: Term) -> Iterator[Term]:
    """The largest parts of a term that are no sums, products or whole powers."""
    match term:
        case ("number", _):
            return
        case ("+", *parts) | ("*", *parts):
            for part in parts:
                yield from list_generators(part)
        case ("^", base, exponent) if is_whole(exponent):
            yield from list_generators(base)
        case _:
            yield term


def is_whole(exponent: Term) -> bool:
    q = constant_of(exponent)
    return q is not None and q.q == 1 and abs(q) <= 1000


Quotient = tuple[fmpq_mpoly, fmpq_mpoly]


def to_quotient(term: Term, generators: dict[Term, fmpq_mpoly], ring: fmpq_mpoly_ctx) -> Quotient:
    """Numerator and denominator; the term is undefined wherever its divisors vanish."""
    match term:
        case ("number", q):
            return ring.constant(q), ring.constant(1)
        case ("+", *parts):
            pairs = [to_quotient(part, generators, ring) for part in parts]
            while len(pairs) > 1:  # in halves: each polynomial is copied a few times only
                rest = pairs[len(pairs) & ~1 :]
                pairs = [*map(add_quotients, pairs[0 : len(pairs) - len(rest) : 2], pairs[1::2]), *rest]
            return pairs[0]
        case ("*", *parts):
            return reduce(multiply_quotients, (to_quotient(part, generators, ring) for part in parts))
        case ("^", base, exponent) if is_whole(exponent):
            n, (top, bottom) = int(constant_of(exponent)), to_quotient(base, generators, ring)  # type: ignore[arg-type]
            limit_work(*(comb(abs(n) + len(part), abs(n)) for part in (top, bottom)))
            return (top**n, bottom**n) if n >= 0 else (bottom**-n, top**-n)
    return generators[term], ring.constant(1)


def limit_work(*products: int) -> None:
    require(max(products) < 10**7, "too many terms")


def add_quotients(x: Quotient, y: Quotient) -> Quotient:
    if x[1] == y[1]:
        return x[0] + y[0], x[1]
    require(x[1] != 0 and y[1] != 0, "a division by zero")
    common = x[1].gcd(y[1])
    left, right = y[1] / common, x[1] / common
    limit_work(len(x[0]) * len(left), len(y[0]) * len(right), len(x[1]) * len(left))
    return x[0] * left + y[0] * right, x[1] * left


def multiply_quotients(x: Quotient, y: Quotient) -> Quotient:
    limit_work(len(x[0]) * len(y[0]), len(x[1]) * len(y[1]))
    return x[0] * y[0], x[1] * y[1]


LEAST = {"log": ">", "sqrt": ">="}
DIVISORS = {"tan": "cos", "sec": "cos", "cot": "sin", "csc": "sin"}


DEFINED, CONTINUOUS, DIFFERENTIABLE = range(3)


def conditions(term: Term, level: int = DEFINED) -> dict[tuple[str, Term], None]:
    """What of a term has to be > 0, >= 0 or != 0 for it to be defined, continuous or differentiable.

    All functions here are differentiable where they are defined, but for roots and arc functions at the ends of their
    ranges, abs at 0, and atan2 at its cut, off which x + sqrt(x**2 + y**2) > 0.
    """
    found: dict[tuple[str, Term], None] = {}
    for part in term[1:]:
        if isinstance(part, tuple):
            found |= conditions(part, level)
    match term:
        case ("^", base, exponent):
            q = constant_of(exponent)
            if q is None or (q.q > 1 and (q < 0 or level == DIFFERENTIABLE)):
                found[">", base] = None
            elif q.q > 1:
                found[">=", base] = None
            elif q <= 0:
                found["!=", base] = None
        case ("log", x):
            found[">", x] = None
        case ("sqrt", x):
            found[">" if level == DIFFERENTIABLE else ">=", x] = None
        case ("asin" | "acos", x):
            for side in (subtract(ONE, x), ("+", ONE, x)):
                found[">" if level == DIFFERENTIABLE else ">=", side] = None
        case ("tan" | "sec" | "cot" | "csc" as name, x):
            found["!=", (DIVISORS[name], x)] = None
        case ("abs", x) if level == DIFFERENTIABLE:
            found["!=", x] = None
        case ("atan2", y, x):
            square = ("+", ("*", x, x), ("*", y, y))
            found["!=", square] = None
            if level != DEFINED:
                found[">", ("+", x, ("sqrt", square))] = None
    return {pair: None for pair in found if pair[1][0] != "number" or not holds(pair[0], pair[1][1])}


def holds(relation: str, value: Any) -> bool:
    """Whether all numbers of a ball, or a rational number, are in this relation to 0."""
    if relation == "!=":
        return bool(value > 0 or value < 0)
    return bool(value > 0 if relation == ">" else value >= 0)


def add_terms(terms: Iterable[Term]) -> Term:
    """A sum without zeros."""
    rest = tuple(t for t in terms if t != ZERO)
    return ("+", *rest) if len(rest) > 1 else rest[0] if rest else ZERO


def multiply_terms(*factors: Term) -> Term:
    """A product without ones."""
    rest = tuple(f for f in factors if f != ONE)
    return ("*", *rest) if len(rest) > 1 else rest[0] if rest else ONE


SLOPES = DERIVATIVES | {"tan": "cos(x)**(-2)", "cot": "-sin(x)**(-2)", "sec": "sin(x)/cos(x)**2"}
SLOPES |= {"csc": "-cos(x)/sin(x)**2", "sinh": "cosh(x)", "cosh": "sinh(x)", "tanh": "1 - tanh(x)**2"}
SLOPES |= {"sqrt": "1/(2*sqrt(x))", "abs": "x/abs(x)"}


def differentiate(term: Term, name: str) -> Term:
    """The derivative by a symbol, where the term is differentiable."""
    if name not in symbols_of(term):
        return ZERO
    match term:
        case ("symbol", _):
            return ONE
        case ("+", *terms):
            return add_terms(differentiate(t, name) for t in terms)
        case ("*", *factors):
            rows = [(*factors[:k], differentiate(t, name), *factors[k + 1 :]) for k, t in enumerate(factors)]
            return add_terms(multiply_terms(*row) for row in rows if ZERO not in row)
        case ("^", base, exponent) if constant_of(exponent) == 1:
            return differentiate(base, name)
        case ("^", base, exponent) if constant_of(exponent) is not None:
            lower = ("^", base, number(constant_of(exponent) - 1))  # type: ignore[operator]
            lower = base if constant_of(exponent) == 2 else lower
            return multiply_terms(exponent, lower, differentiate(base, name))
        case ("^", base, exponent):
            return ("*", term, differentiate(("*", exponent, ("log", base)), name))
        case ("atan2", y, x):
            top = subtract(("*", x, differentiate(y, name)), ("*", y, differentiate(x, name)))
            return ("*", top, ("^", ("+", ("*", x, x), ("*", y, y)), MINUS_ONE))
        case (function, x) if function in SLOPES:
            return multiply_terms(replace(parse(SLOPES[function]), ("symbol", "x"), x), differentiate(x, name))
    raise Refused("no derivative is known")


def prove(proof: Any, goal: Goal) -> None:
    """Check that a proof proves a goal."""
    require(isinstance(proof, dict) and proof.get("rule") in RULES, "expected a proof by a known rule")
    names = set().union(*map(symbols_of, (goal.term, *goal.exists, *goal.given, *goal.zeros)))
    require(names <= set(goal.box), "a symbol without a range")
    RULES[proof["rule"]](proof, goal)


def prove_all(proofs: Any, goals: Sequence[Goal]) -> None:
    for proof, goal in zip(read_list(proofs, lambda entry: entry, len(goals)), goals, strict=True):
        prove(proof, goal)


def prove_defined(proofs: Any, goal: Goal, *terms: Term, level: int = DEFINED) -> None:
    """The terms are defined, or more, in the goal: a proof for each condition, but its own and those of balls."""
    own = with_weaker(set().union(*(conditions(t) for t in (goal.term, *goal.exists))))
    needed = [pair for pair in set_union(conditions(t, level) for t in terms) if pair not in own]
    needed = [pair for pair in needed if symbols_of(pair[1]) or not holds(pair[0], value_of(pair[1], {}))]
    same = [pair for pair in needed if any(r == pair[0] and is_identity(subtract(t, pair[1])) for r, t in own)]
    prove_all(proofs, [goal._replace(term=t, relation=r) for r, t in needed if (r, t) not in same])


def with_weaker(pairs: Iterable[tuple[str, Term]]) -> set[tuple[str, Term]]:
    """Conditions, and those that follow from them: what is > 0 is >= 0 and != 0."""
    return {(weaker, t) for relation, t in pairs for weaker in ((">", ">=", "!=") if relation == ">" else (relation,))}


def set_union(parts: Iterable[dict[Any, None]]) -> dict[Any, None]:
    return dict.fromkeys(key for part in parts for key in part)


def value_of(term: Term, point: dict[str, Jet]) -> arb:
    """The ball of a term at a point; NaN where it may have no value."""
    try:
        value = evaluate(term, point, strict).enclose()
    except Undefined:
        return arb.nan()
    return value if isinstance(value, arb) else arb.nan()


def change_range(goal: Goal, name: str, **changes: Any) -> Goal:
    require(name in goal.box, "a symbol without a range")
    return goal._replace(box=goal.box | {name: goal.box[name]._replace(**changes)})


# Rules that change the goal


def prove_equal(proof: Any, goal: Goal) -> None:
    """The term is another one wherever both are defined, by exact algebra; it is defined wherever the goal's is."""
    _, text, defined, premise = read_fields(proof, "rule to defined proof")
    term = parse(text)
    prove_defined(defined, goal, term)
    require(is_identity(subtract(goal.term, term)), "the terms differ")
    prove(premise, remember(goal, term))


def remember(goal: Goal, term: Term) -> Goal:
    """The goal with another term; the points are still those where the first is defined."""
    return goal._replace(term=term, exists=tuple(dict.fromkeys((*goal.exists, goal.term))))


def prove_rewrite(proof: Any, goal: Goal) -> None:
    """A part of the term is replaced by one that is equal to it at all points of the goal."""
    _, old, new, defined, equal, premise = read_fields(proof, "rule from to defined equal proof")
    before, after = parse(old), parse(new)
    prove_defined(defined, goal, before, after)
    prove(equal, remember(goal, subtract(before, after))._replace(relation="="))
    for exponent in list_exponents(goal.term, before):
        keep_power(replace(exponent, before, after), exponent)
    prove(premise, remember(goal, replace(goal.term, before, after)))


def prove_multiply(proof: Any, goal: Goal) -> None:
    """The term times a factor > 0 has the same sign."""
    _, text, defined, positive, premise = read_fields(proof, "rule by defined positive proof")
    factor = parse(text)
    prove_defined(defined, goal, factor)
    prove(positive, remember(goal, factor)._replace(relation=">"))
    prove(premise, remember(goal, ("*", factor, goal.term)))


def prove_exponential(proof: Any, goal: Goal) -> None:
    """exp rises and exp(0) = 1: exp(f) - 1 has the sign of f."""
    _, premise = read_fields(proof, "rule proof")
    prove(premise, remember(goal, subtract(("exp", goal.term), ONE)))


def prove_side(proof: Any, goal: Goal) -> None:
    """f > 0 or -f > 0 gives f != 0."""
    _, sign, premise = read_fields(proof, "rule sign proof")
    require(goal.relation == "!=", "expected !=")
    signed = goal.term if read_sign(sign) == 1 else negate(goal.term)
    prove(premise, remember(goal, signed)._replace(relation=">"))


def prove_cases(proof: Any, goal: Goal) -> None:
    """u >= 0 or -u >= 0 at every point; |u| is u in the first case and -u in the other."""
    _, text, proofs = read_fields(proof, "rule of proofs")
    u = parse(text)
    prove_defined([], goal, u)
    cases = []
    for upper, signed in enumerate((u, negate(u))):
        case = remember(goal, replace(goal.term, ("abs", u), signed))._replace(given=(*goal.given, signed))
        cases.append(cut_range(case, u[1], upper) if u[0] == "symbol" else case)
    prove_all(proofs, cases)


def cut_range(goal: Goal, name: str, upper: int) -> Goal:
    """The goal for the values >= 0 of a symbol, or for those <= 0."""
    end = goal.box[name].high if upper else goal.box[name].low
    if end is not None and not (value_of(end, {}) > 0 if upper else value_of(end, {}) < 0):
        return goal
    changes = {"high": ZERO, "open_high": False} if upper else {"low": ZERO, "open_low": False}
    return change_range(goal, name, **changes)


def prove_split(proof: Any, goal: Goal) -> None:
    """Every value of a symbol is at most, or at least, a number."""
    _, name, at, proofs = read_fields(proof, "rule symbol at proofs")
    middle = parse(at)
    require(not symbols_of(middle), "expected a number")
    require(value_of(middle, {}).is_finite(), "a number that may not exist")
    parts = ({"high": middle, "open_high": False}, {"low": middle, "open_low": False})
    prove_all(proofs, [change_range(goal, name, **part) for part in parts])


def prove_integers(proof: Any, goal: Goal) -> None:
    """A symbol that is an integer between two numbers is one of finitely many."""
    _, name, first, proofs = read_fields(proof, "rule symbol from proofs")
    require(name in goal.box and goal.box[name].integer, "expected an integer")
    limit, start = goal.box[name], read_integer(first, -FAR, FAR)
    values = read_list(proofs, lambda entry: entry)
    ends = [(limit.low, start - 1, 1), (limit.high, start + len(values), -1)]
    require(all(end is not None and (value_of(end, {}) - k) * sign > 0 for end, k, sign in ends), "more integers")
    prove_all(values, [fix_symbol(goal, name, number(start + k)) for k in range(len(values))])


def fix_symbol(goal: Goal, name: str, value: Term) -> Goal:
    """The goal at one value of a symbol."""
    parts = ((goal.term,), goal.exists, goal.given, goal.zeros)
    (term,), exists, given, zeros = (tuple(substitute(t, {name: value}) for t in part) for part in parts)
    return Goal(term, goal.relation, {k: v for k, v in goal.box.items() if k != name}, exists, given, zeros)


def prove_abstract(proof: Any, goal: Goal) -> None:
    """f = F(u) with u = T in a range, for terms T of new names u: F has its sign for all u in the range.

    F(T) is defined wherever f is; the ranges follow from proofs of T - low and high - T.
    """
    _, names, ranges, text, inside, defined, premise = read_fields(proof, "rule terms ranges to inside defined proof")
    require(isinstance(names, dict) and isinstance(ranges, dict) and set(names) == set(ranges), "expected new names")
    terms = {name: parse(names[name]) for name in read_symbols([*names])}
    require(not set(terms) & set(goal.box), "a name that is in use")
    require(set().union(*map(symbols_of, terms.values())) <= set(goal.box), "a symbol without a range")
    new = {name: read_range(ranges[name]) for name in terms}
    require(not any(limit.nonzero or limit.integer for limit in new.values()), "a range that is no interval")
    form = parse(text)
    back = at_point(form, terms)
    prove_defined(defined, goal, back, *terms.values())
    require(is_identity(subtract(goal.term, back)), "the terms differ")
    goals = []
    for name, limit in new.items():
        for end, is_open, sign in ((limit.low, limit.open_low, 1), (limit.high, limit.open_high, -1)):
            if end is not None:
                side = subtract(terms[name], end) if sign == 1 else subtract(end, terms[name])
                goals.append(remember(goal, side)._replace(relation=">" if is_open else ">="))
    prove_all(inside, goals)
    prove(premise, goal._replace(term=form, box=goal.box | new, exists=(*goal.exists, goal.term)))


def prove_dense(proof: Any, goal: Goal) -> None:
    """f >= 0 where an entire function does not vanish gives f >= 0 everywhere, for a continuous f.

    Theorem: the zeros of an analytic function that is not 0 throughout have no inner points (Krantz and Parks, A Primer
    of Real Analytic Functions, 2002, chapter 4); so what is left is dense in a box whose sides have inner points.
    """
    _, text, point, defined, premise = read_fields(proof, "rule except point defined proof")
    require(goal.relation == ">=", "expected >=")
    seldom = parse(text)
    require(is_entire(seldom), "expected an entire function")
    here = {name: read_ball(value) for name, value in point.items()}
    require(holds("!=", value_of(seldom, here)), "the function may vanish throughout")
    for limit in goal.box.values():
        require(not limit.integer and not is_narrow(limit), "a side without inner points")
    closed = {name: r._replace(open_low=False, open_high=False, nonzero=False) for name, r in goal.box.items()}
    whole = goal._replace(box=closed)
    bare = whole._replace(term=ZERO, exists=(), given=(), zeros=())
    prove_defined(defined, bare, goal.term, *goal.exists, level=CONTINUOUS)
    prove(premise, goal._replace(exists=(*goal.exists, ("^", seldom, MINUS_ONE)), given=(), zeros=()))


def is_narrow(limit: Range) -> bool:
    """Whether a range may have no inner points."""
    return None not in (limit.low, limit.high) and not value_of(limit.high, {}) > value_of(limit.low, {})  # type: ignore


def is_entire(term: Term) -> bool:
    """Whether a term is made of sums, products, whole powers, sin, cos, exp, sinh and cosh of symbols and numbers."""
    if not symbols_of(term):
        return True
    if term[0] == "^":
        q = constant_of(term[2])
        return q is not None and q.q == 1 and q > 0 and is_entire(term[1])
    parts = [part for part in term[1:] if isinstance(part, tuple)]
    known = ("number", "pi", "symbol", "+", "*", "sin", "cos", "exp", "sinh", "cosh")
    return term[0] in known and all(map(is_entire, parts))


# Rules of equations


def prove_identity(proof: Any, goal: Goal) -> None:
    """The term vanishes wherever it is defined, by exact algebra; what is 0 is also >= 0."""
    read_fields(proof, "rule")
    require(goal.relation in ("=", ">=") and is_identity(goal.term), "the sides differ")


def prove_zero(proof: Any, goal: Goal) -> None:
    """What is 0 is >= 0."""
    _, premise = read_fields(proof, "rule proof")
    require(goal.relation == ">=", "expected >=")
    prove(premise, goal._replace(relation="="))


def prove_between(proof: Any, goal: Goal) -> None:
    """f >= 0 and -f >= 0 give f = 0."""
    _, proofs = read_fields(proof, "rule proofs")
    require(goal.relation == "=", "expected an equation")
    prove_all(proofs, [remember(goal, side)._replace(relation=">=") for side in (goal.term, negate(goal.term))])


def prove_solve(proof: Any, goal: Goal) -> None:
    """f = c (A - v) with c != 0, and A = v by the definition of the inverse function A."""
    _, share, own, value, defined, proofs = read_fields(proof, "rule share atom value defined proofs")
    atom, v, c = parse(own), parse(value), read_number(share)
    require(goal.relation == "=" and c != 0, "expected an equation")
    prove_defined(defined, goal, atom, v)
    require(is_identity(subtract(goal.term, ("*", number(c), subtract(atom, v)))), "the equation differs")
    pairs = [(remember(goal, term)._replace(relation=relation)) for relation, term in list_definition(atom, v)]
    prove_all(proofs, pairs)


def list_definition(atom: Term, v: Term) -> list[tuple[str, Term]]:
    """What makes A = v: v has the function of which A is the inverse, and lies in the range of A."""
    match atom:
        case ("log", u):
            return [("=", subtract(("exp", v), u))]
        case ("sqrt" | "abs" as name, u):
            return [("=", subtract(("*", v, v), u if name == "sqrt" else ("*", u, u))), (">=", v)]
        case ("^", u, exponent) if constant_of(exponent) is not None:
            q = constant_of(exponent)
            return [("=", subtract(("^", v, number(q.q)), ("^", u, number(q.p)))), (">=", v)]  # type: ignore[union-attr]
        case ("asin", u):
            return [("=", subtract(("sin", v), u)), (">=", ("+", HALF_TURN, v)), (">=", subtract(HALF_TURN, v))]
        case ("acos", u):
            return [("=", subtract(("cos", v), u)), (">=", v), (">=", subtract(("pi",), v))]
        case ("atan", u):
            tangent = subtract(("*", u, ("cos", v)), ("sin", v))
            return [("=", tangent), (">", ("+", HALF_TURN, v)), (">", subtract(HALF_TURN, v))]
        case ("atan2", y, x):
            across = subtract(("*", x, ("sin", v)), ("*", y, ("cos", v)))
            along = ("+", ("*", x, ("cos", v)), ("*", y, ("sin", v)))
            return [("=", across), (">", along), (">=", subtract(("pi",), v)), (">", ("+", ("pi",), v))]
    raise Refused("expected an inverse function")


def prove_squares(proof: Any, goal: Goal) -> None:
    """L**2 = R**2 with L, R of one sign gives L = R; L >= 0 and L**2 >= R**2 give L >= |R| >= R, and so for >."""
    _, left, right, sign, defined, proofs = read_fields(proof, "rule left right sign defined proofs")
    x, y, s = parse(left), parse(right), read_sign(sign)
    require(goal.relation in ("=", ">=", ">") and (s == 1 or goal.relation == "="), "a wrong sign")
    prove_defined(defined, goal, x, y)
    require(is_identity(subtract(goal.term, subtract(x, y))), "the terms differ")
    squares = remember(goal, subtract(("*", x, x), ("*", y, y)))
    sides = [x if s == 1 else negate(x), *([y if s == 1 else negate(y)] if goal.relation == "=" else [])]
    prove_all(proofs, [squares, *(remember(goal, side)._replace(relation=">=") for side in sides)])


def prove_derivative(proof: Any, goal: Goal) -> None:
    """A differentiable function on a box without holes, with derivatives 0, is constant; at one point it is 0."""
    _, point, value, slopes, defined = read_fields(proof, "rule point value slopes defined")
    require(goal.relation == "=", "expected an equation")
    require(not any(r.nonzero or r.integer for r in goal.box.values()), "a box with holes")
    names = sorted(symbols_of(goal.term))
    changes = [differentiate(goal.term, name) for name in names]
    prove_defined(defined, Goal(ZERO, "=", goal.box), goal.term, *changes, level=DIFFERENTIABLE)
    prove_all(slopes, [Goal(change, "=", goal.box) for change in changes])
    require(isinstance(point, dict) and set(point) == set(names), "the point gives every symbol of the term")
    place = {name: parse(text) for name, text in point.items()}
    require(all(is_inside(place[name], goal.box[name]) for name in names), "the point may lie outside the box")
    prove(value, Goal(substitute(goal.term, place), "=", {}))


def is_inside(value: Term, limit: Range) -> bool:
    """Whether a number is shown to lie in a range."""
    require(not symbols_of(value), "expected a number")
    require(value_of(value, {}).is_finite(), "a number that may not exist")
    q = constant_of(value)
    if (limit.integer and (q is None or q.q > 1)) or (limit.nonzero and not holds("!=", value_of(value, {}))):
        return False
    sides = ((limit.low, limit.open_low, 1), (limit.high, limit.open_high, -1))
    gaps = [(("*", number(sign), subtract(value, end)), is_open) for end, is_open, sign in sides if end is not None]
    return all(value_of(gap, {}) > 0 or (not is_open and is_identity(gap)) for gap, is_open in gaps)


# Rules of signs


def prove_balls(proof: Any, goal: Goal) -> None:
    """The ball of a term on a cell contains its values there, and so does f(c) + f'(cell) (x - c) (Moore, 1966).

    The cells cover the box; a symbol without both ends has the ball of all numbers, in which sin and cos have theirs.
    Where a cell has no point of the goal, nothing is to be shown.
    """
    _, bits, cells = read_fields(proof, "rule bits cells")
    require(goal.relation != "=", "expected an inequality")
    before = ctx.prec
    try:
        budget, names = set_work(bits, cells), set().union(*map(symbols_of, (goal.term, *goal.given)))
        ends = {name: (goal.box[name].low, goal.box[name].high) for name in sorted(names)}
        far = {name: Jet(arb(0, arb.pos_inf())) for name, pair in ends.items() if None in pair}
        sides = {n: [evaluate(end or ZERO, {}, arb) for end in pair] for n, pair in ends.items() if n not in far}

        def is_settled(cell: Cell) -> bool:
            def place(jets: dict[str, Jet]) -> dict[str, Jet]:
                return far | {name: low + (high - low) * jets[name] for name, (low, high) in sides.items()}

            wide = place({name: Jet(arb(*cell[name])) for name in sides})
            try:
                empty = any(evaluate(t, wide, clip).enclose() < 0 for t in goal.given)
                if empty or holds(goal.relation, evaluate(goal.term, wide, clip).enclose()):
                    return True
            except Nowhere:
                return True
            slanted = place({name: Jet(arb(cell[name][0]), arb(0, cell[name][1])) for name in sides})
            return holds(goal.relation, evaluate(goal.term, slanted, arb).enclose())

        prove_on_cells([dict.fromkeys(sides, UNIT)], budget, is_settled)
    finally:
        ctx.prec = before


def prove_given(proof: Any, goal: Goal) -> None:
    """A sum of hypotheses with weights >= 0 is >= 0."""
    _, weights = read_fields(proof, "rule weights")
    shares = read_list(weights, read_number, len(goal.given))
    require(goal.relation == ">=" and all(w >= 0 for w in shares), "expected >= 0 and weights >= 0")
    total = ("+", ZERO, *(("*", number(w), t) for w, t in zip(shares, goal.given, strict=True)))
    require(is_identity(subtract(goal.term, total)), "the term is another one")


def prove_empty(proof: Any, goal: Goal) -> None:
    """A hypothesis h >= 0 with h < 0, or h = 0 with h != 0, at all points of the goal: it has none."""
    _, k, premise = read_fields(proof, "rule hypothesis proof")
    place = read_integer(k, 0, len(goal.given) + len(goal.zeros) - 1)
    signs = [*((negate(h), ">") for h in goal.given), *((h, "!=") for h in goal.zeros)]
    term, relation = signs[place]
    prove(premise, remember(goal, term)._replace(relation=relation))


def prove_modulo(proof: Any, goal: Goal) -> None:
    """f = g + sum c_k h_k, where the hypotheses say h_k = 0: at all points of the goal f is g."""
    _, text, cofactors, defined, premise = read_fields(proof, "rule to cofactors defined proof")
    term, shares = parse(text), read_list(cofactors, parse, len(goal.zeros))
    prove_defined(defined, goal, term, *shares)
    total = ("+", term, *(("*", c, h) for c, h in zip(shares, goal.zeros, strict=True)))
    require(is_identity(subtract(goal.term, total)), "the terms differ")
    prove(premise, remember(goal, term))


def prove_range(proof: Any, goal: Goal) -> None:
    """c (s - low) or c (high - s) with c > 0, by the range of the symbol s."""
    _, name, side, share = read_fields(proof, "rule symbol end share")
    require(name in goal.box and goal.relation in (">=", ">") and read_number(share) > 0, "expected a symbol")
    limit, upper = goal.box[name], read_flag(side)
    end, is_open = (limit.high, limit.open_high) if upper else (limit.low, limit.open_low)
    require(end is not None, "a range without this end")
    open_by_zero = limit.nonzero and is_identity(end)  # type: ignore[arg-type]
    require(goal.relation == ">=" or is_open or open_by_zero, "the end belongs to the range")
    gap = subtract(("symbol", name), end) if not upper else subtract(end, ("symbol", name))  # type: ignore[arg-type]
    require(is_identity(subtract(goal.term, ("*", number(read_number(share)), gap))), "the term is another one")


def prove_angle(proof: Any, goal: Goal) -> None:
    """(-1)**k sin u >= 0, or > 0, for u between k pi and (k + 1) pi; cos u = sin(u + pi/2); times a number c > 0."""
    _, turn, share, proofs = read_fields(proof, "rule turn share proofs")
    k, c = read_integer(turn, -FAR, FAR), read_number(share)
    require(goal.relation in (">=", ">") and c > 0, "expected >= or >")
    waves = [f for f in list_factors(goal.term) if f[0] in ("sin", "cos")]
    require(len(waves) == 1, "expected one sine or cosine")
    ((name, angle),) = waves
    require(is_identity(subtract(goal.term, ("*", number(-c if k % 2 else c), waves[0]))), "the term is another one")
    u = angle if name == "sin" else ("+", angle, ("*", ("pi",), number(HALF)))
    sides = [subtract(u, ("*", ("pi",), number(k))), subtract(("*", ("pi",), number(k + 1)), u)]
    prove_all(proofs, [remember(goal, side) for side in sides])


HALF_TURN: Term = ("*", ("pi",), number(HALF))
# The values of a function lie within the second number of the first; the last says whether the ends are left out.
SPANS: dict[str, tuple[Term, Term, bool]] = {
    "sin": (ZERO, ONE, False),
    "cos": (ZERO, ONE, False),
    "tanh": (ZERO, ONE, True),
    "erf": (ZERO, ONE, True),
    "atan": (ZERO, HALF_TURN, True),
    "asin": (ZERO, HALF_TURN, False),
    "acos": (HALF_TURN, HALF_TURN, False),
    "atan2": (ZERO, ("pi",), False),
}


def prove_bounded(proof: Any, goal: Goal) -> None:
    """c + sum c_k g_k(u_k) is at least c + sum c_k m_k - |c_k| h_k for functions g with |g - m| <= h."""
    _, premise = read_fields(proof, "rule proof")
    require(goal.relation in (">=", ">"), "expected >= or >")
    least, above = [], False
    for term in list_terms(goal.term):
        waves = [f for f in list_factors(term) if symbols_of(f)]
        require(len(waves) <= 1, "a product of functions")
        if not waves:
            least.append(term)
            continue
        require(waves[0][0] in SPANS, "a function without a known range")
        middle, half, inside = SPANS[waves[0][0]]
        share: Term = ("*", *(f for f in list_factors(term) if f != waves[0]), ONE)
        least += [("*", share, middle), negate(("*", ("abs", share), half))]
        above = above or (inside and holds("!=", value_of(share, {})))
    prove(premise, Goal(("+", *least), ">=" if above else goal.relation, {}))


def prove_corners(proof: Any, goal: Goal) -> None:
    """A polynomial of degree one in each symbol is least at a corner of the box."""
    _, names, proofs = read_fields(proof, "rule symbols proofs")
    chosen = read_symbols(read_list(names, str))
    require(goal.relation in (">=", ">") and set(chosen) <= set(goal.box), "expected symbols of the box")
    bound = frozenset().union(*(symbols_of(t) for _, t in conditions(goal.term)))
    require(not bound & set(chosen), "a symbol on which it depends where the term is defined")
    polynomial = evaluate(goal.term, make_symbols(sorted(symbols_of(goal.term))), Exact).parts[0]
    for name in chosen:
        require(degree_in(polynomial, name) <= 1, "a symbol of a higher degree")
    corners = [goal]
    for name in chosen:
        ends = (goal.box[name].low, goal.box[name].high)
        require(None not in ends, "a range without an end")
        corners = [fix_symbol(corner, name, end) for corner in corners for end in ends]  # type: ignore[arg-type]
    prove_all(proofs, [corner._replace(exists=(), given=(), zeros=()) for corner in corners])


def degree_in(polynomial: Exact, name: str) -> int:
    """The degree in a symbol; refused where the symbol occurs in any other way."""
    atom = symbol_atom(name)
    for monomial in polynomial.terms:
        require(all(a == atom or not occurs(atom, a) for a, _ in monomial), "a symbol inside a function")
    powers = [q for _, q, _ in polynomial.split_powers(atom)]
    require(all(q.q == 1 and q >= 0 for q in powers), "a symbol to a power that is no whole number")
    return max((int(q) for q in powers), default=0)


def symbol_atom(name: str) -> Any:
    (((atom, _),),) = make_symbols([name])[name].parts[0].terms
    return atom


def occurs(atom: Any, inside: Any) -> bool:
    """Whether an atom occurs in another one."""
    if inside == atom:
        return True
    return isinstance(inside, (tuple, frozenset)) and any(occurs(atom, part) for part in inside)


def prove_product(proof: Any, goal: Goal) -> None:
    """A product has the product of the signs of its factors b**q; each has its entry, null or [sign, proof].

    Without a proof: an even whole power is >= 0, and > 0 or != 0 when q < 0, since b != 0 where it is defined; so is a
    broken power, abs, sqrt, acos; exp and cosh are > 0. Else sign b > 0, or >= 0 where that is enough.
    """
    _, entries = read_fields(proof, "rule factors")
    factors = list_factors(goal.term)
    require(goal.relation != "=", "expected an inequality")
    signs = 1
    for factor, entry in zip(factors, read_list(entries, lambda item: item, len(factors)), strict=True):
        base, q = (factor[1], constant_of(factor[2])) if factor[0] == "^" else (factor, fmpq(1))
        require(q is not None or entry is None, "an exponent that is no number")
        natural = q is None or q.q > 1 or int(q) % 2 == 0 or factor[0] in ("exp", "cosh", "abs", "sqrt", "acos")
        strict = q is None or q <= 0 or factor[0] in ("exp", "cosh") or goal.relation == ">="
        if factor[0] == "number":
            require(entry is None and (factor[1] != 0 or goal.relation == ">="), "a factor 0")
            signs *= -1 if factor[1] < 0 else 1
        elif entry is None:
            require((natural or (goal.relation == "!=" and strict)) and strict, "a factor without a proof")
        else:
            sign, premise = read_list(entry, lambda item: item, 2)
            s = read_sign(sign)
            enough = ">=" if goal.relation == ">=" or (q is not None and q < 0) else goal.relation
            if natural and goal.relation == ">":
                enough = "!="
            prove(premise, remember(goal, base if s == 1 else negate(base))._replace(relation=enough))
            signs *= 1 if natural else s
    require(signs == 1 or goal.relation == "!=", "the product of the signs is negative")


def list_factors(term: Term) -> list[Term]:
    return [f for part in term[1:] for f in list_factors(part)] if term[0] == "*" else [term]


def list_terms(term: Term) -> list[Term]:
    return [t for part in term[1:] for t in list_terms(part)] if term[0] == "+" else [term]


def prove_sum(proof: Any, goal: Goal) -> None:
    """A sum of terms >= 0 is >= 0, and > 0 when one of them is."""
    _, proofs, strict = read_fields(proof, "rule proofs strict")
    require(goal.relation in (">=", ">"), "expected >= or >")
    terms = list_terms(goal.term)
    k = read_integer(strict, 0, len(terms) - 1) if goal.relation == ">" else -1
    prove_all(proofs, [remember(goal, t)._replace(relation=">" if i == k else ">=") for i, t in enumerate(terms)])


def prove_slope(proof: Any, goal: Goal) -> None:
    """A function that is continuous, and does not fall away from an end of the range of s, is least there.

    Mean value theorem: f(s) - f(end) = f'(r) (s - end) with r between. Strict: f(end) > 0; or the end is left out and
    f' > 0, or f' != 0 at a point and s is the only symbol: inside f is analytic, and constant near no point. Continuity
    is shown on the range with this end, the derivative inside it.
    """
    _, name, side, strict, *rest = read_fields(proof, "rule symbol end strict continuous smooth slope floor")
    continuous, smooth, slope, floor = rest
    require(name in goal.box and goal.relation in (">=", ">"), "expected a symbol")
    limit, upper = goal.box[name], read_flag(side)
    end, is_open = (limit.high, limit.open_high) if upper else (limit.low, limit.open_low)
    require(end is not None, "a range without this end")
    point = parse(strict) if isinstance(strict, str) else None
    by_slope = (point is not None or read_flag(strict)) and goal.relation == ">"
    require(not by_slope or is_open, "the end belongs to the range")
    own_end = {"open_high" if upper else "open_low": False}
    whole = change_range(goal, name, nonzero=False, integer=False, **own_end)
    whole = whole._replace(term=ZERO, exists=(), given=(), zeros=())
    change = differentiate(goal.term, name)
    inside = go_inside(whole, name, goal.term, continuous, smooth, conditions(change))
    if by_slope and point is not None:
        known = symbols_of(goal.term) == {name} and is_inside(point, inside.box[name])
        require(known, "expected a point of one symbol")
        require(holds("!=", value_of(replace(change, ("symbol", name), point), {})), "the slope may vanish throughout")
    is_steep = by_slope and point is None
    rise = inside._replace(term=negate(change) if upper else change, relation=">" if is_steep else ">=")
    prove(slope, rise._replace(exists=(goal.term,)))
    start = fix_symbol(whole._replace(term=goal.term), name, end)  # type: ignore[arg-type]
    prove(floor, start._replace(relation=">" if goal.relation == ">" and not by_slope else ">="))


def go_inside(whole: Goal, name: str, term: Term, continuous: Any, smooth: Any, *needed: Any) -> Goal:
    """The inside of a range, where a term that is continuous on the whole is differentiable, and more as needed."""
    prove_defined(continuous, whole, term, level=CONTINUOUS)
    inside = change_range(whole, name, open_low=True, open_high=True)
    known = with_weaker(conditions(term, CONTINUOUS))
    rest = [pair for pair in set_union([conditions(term, DIFFERENTIABLE), *needed]) if pair not in known]
    prove_all(smooth, [inside._replace(term=t, relation=relation) for relation, t in rest])
    return inside


def prove_concave(proof: Any, goal: Goal) -> None:
    """A function with f'' <= 0 between two ends of the range of s is >= 0 there when it is at both ends.

    Theorem: it lies above its chord. Continuity is shown on the closed range, derivatives inside it.
    """
    _, name, continuous, smooth, curve, floors = read_fields(proof, "rule symbol continuous smooth curve floors")
    require(name in goal.box and goal.relation == ">=", "expected >= and a symbol")
    limit = goal.box[name]
    require(limit.low is not None and limit.high is not None, "a range without an end")
    flags = {"open_low": False, "open_high": False, "nonzero": False, "integer": False}
    whole = change_range(goal, name, **flags)._replace(term=ZERO, exists=(), given=(), zeros=())
    slope = differentiate(goal.term, name)
    second = differentiate(slope, name)
    needed = (conditions(slope, DIFFERENTIABLE), conditions(second))
    inside = go_inside(whole, name, goal.term, continuous, smooth, *needed)
    prove(curve, inside._replace(term=negate(second), relation=">=", exists=(goal.term,)))
    ends = [fix_symbol(whole._replace(term=goal.term), name, end) for end in (limit.low, limit.high)]  # type: ignore
    prove_all(floors, ends)


def prove_cones(proof: Any, goal: Goal) -> None:
    """A polynomial whose coefficients in variables >= 0 are all >= 0 is >= 0; else the variables are compared.

    A symbol is low + y, high - y, (low z + high y)/(y + z), or y and -y one after the other, with y, z >= 0; a last
    variable, 1, makes all terms of one degree in it and the y of ranges with one end. Where y_i >= y_j, y_i is put for
    y_i + y_j. For > every choice of vanishing ones, but for the last and those for no end, has to leave a term.
    """
    _, splits = read_fields(proof, "rule splits")
    require(goal.relation in (">=", ">"), "expected >= or >")
    names = sorted(symbols_of(goal.term))
    require(len(names) <= 8, "too many symbols")
    terms = to_polynomial(goal.term, names)
    signs = [(1, -1) if goal.box[n].low is None and goal.box[n].high is None else (1,) for n in names]
    cones = [make_cone(terms, [goal.box[n] for n in names], chosen) for chosen in product(*signs)]
    for (polynomial, alive), split in zip(cones, read_list(splits, lambda item: item, len(cones)), strict=True):
        check_cone(polynomial, alive, split, goal.relation == ">")


def to_polynomial(term: Term, names: list[str]) -> dict[tuple[int, ...], fmpq]:
    """Exponents and coefficients of a polynomial in all its symbols."""
    value = evaluate(term, make_symbols(names), Exact).parts[0]
    places = {symbol_atom(name): k for k, name in enumerate(names)}
    total = {}
    for monomial, c in value:
        require(all(a in places and fmpq(e).q == 1 and e >= 0 for a, e in monomial), "no polynomial")
        powers = {places[a]: int(e) for a, e in monomial}
        total[tuple(powers.get(k, 0) for k in range(len(names)))] = c
    return total


def make_cone(terms: dict[Any, fmpq], limits: list[Range], signs: Sequence[int]) -> tuple[fmpq_mpoly, list[set[int]]]:
    """The polynomial in y_0 .., z_0 .., 1, times powers of y + z; and sets of variables that are not all 0."""
    n = len(limits)
    context = fmpq_mpoly_ctx.get([f"y{k}" for k in range(2 * n + 1)], Ordering.lex)
    y = context.gens()
    one, tops, bottoms, alive = y[2 * n], [], [], [{2 * n}]
    for k, (limit, sign) in enumerate(zip(limits, signs, strict=True)):
        low, high = (None if end is None else constant_of(end) for end in (limit.low, limit.high))
        require((low is None) == (limit.low is None) and (high is None) == (limit.high is None), "an irrational end")
        if low is not None and high is not None:
            require(low < high, "an empty range")
            pair = (low * y[n + k] + high * y[k], y[k] + y[n + k])
            alive.append({k, n + k})
        elif low is not None:
            pair = (low * one + y[k], one)
        else:
            pair = (high * one - y[k], one) if high is not None else (sign * y[k], one)
        is_open = limit.open_low if low is not None else limit.open_high if high is not None else limit.nonzero
        if is_open and (low is None or high is None):
            alive.append({k})
        tops.append(pair[0])
        bottoms.append(pair[1])
    degrees = [max(powers[k] for powers in terms) if terms else 0 for k in range(n)]
    total = context.constant(0)
    for powers, c in terms.items():
        term = context.constant(c)
        for k, e in enumerate(powers):
            term = term * tops[k] ** e * bottoms[k] ** (degrees[k] - e)
        total = total + term
    return total, alive


def check_cone(polynomial: fmpq_mpoly, alive: list[set[int]], split: Any, strict: bool) -> None:
    """A leaf, null, or [i, j, the proof where y_i >= y_j, the proof where y_j >= y_i]."""
    if split is None:
        require(all(c >= 0 for c in polynomial.to_dict().values()), "a negative coefficient")
        supports = [{k for k, e in enumerate(powers) if e} for powers in polynomial.to_dict()]
        require(not strict or not may_vanish(supports, alive), "it may be 0")
        return
    i, j, first, second = read_list(split, lambda item: item, 4)
    variables = polynomial.context().gens()
    require(read_integer(i, 0, len(variables) - 1) != read_integer(j, 0, len(variables) - 1), "one variable")
    for larger, smaller, part in ((i, j, first), (j, i, second)):
        moved = [v + variables[smaller] if k == larger else v for k, v in enumerate(variables)]
        left = [group | {smaller} if larger in group else group for group in alive]
        check_cone(polynomial.compose(*moved), left, part, strict)


def may_vanish(supports: list[set[int]], alive: list[set[int]]) -> bool:
    """Whether some set of positive variables, one of every set of ``alive``, holds the variables of no term."""
    require(prod(map(len, alive)) <= 2**14, "too many choices")
    return any(not any(s <= {*chosen} for s in supports) for chosen in product(*alive))


def prove_quadratic(proof: Any, goal: Goal) -> None:
    """A v**2 + B v + C >= 0 for all real v when A, C, 4 A C - B**2 >= 0; > 0 when 4 A C - B**2 > 0."""
    _, name, texts, defined, proofs = read_fields(proof, "rule symbol coefficients defined proofs")
    require(goal.relation in (">=", ">"), "expected >= or >")
    a, b, c = read_list(texts, parse, 3)
    v = ("symbol", name)
    require(not any(name in symbols_of(t) for t in (a, b, c)), "the symbol in a coefficient")
    prove_defined(defined, goal, a, b, c)
    whole = ("+", ("*", a, v, v), ("*", b, v), c)
    require(is_identity(subtract(goal.term, whole)), "the term is another one")
    discriminant = subtract(("*", number(4), a, c), ("*", b, b))
    premises = [remember(goal, a), remember(goal, c), remember(goal, discriminant)]
    prove_all(proofs, [*(p._replace(relation=">=") for p in premises[:2]), premises[2]])


def prove_roots(proof: Any, goal: Goal) -> None:
    """A rational function of one symbol keeps its sign between the real roots of N D, which Sturm's theorem counts.

    N/D has the sign of N D where D != 0. Odd factors of N D have no root inside the range; for > and != neither has N,
    the ends included that belong to the range. The range may be widened to rational ends.
    """
    _, low, high = read_fields(proof, "rule from to")
    (name,) = symbols_of(goal.term)
    limit, ends = goal.box[name], [None if end is None else read_number(end) for end in (low, high)]
    exact = [is_end(end, own, sign) for end, own, sign in zip(ends, (limit.low, limit.high), (1, -1), strict=True)]
    top, bottom = to_fraction(goal.term)
    require(goal.relation != "=" and top != 0 and bottom != 0, "expected an inequality")
    inner = inner_number(*ends)
    while (top * bottom)(inner) == 0:
        inner = (inner + (ends[0] if ends[0] is not None else inner - 1)) / 2
    require(goal.relation == "!=" or (top * bottom)(inner) > 0, "the wrong sign")
    if goal.relation != "!=":
        odd = fmpq_poly([1])
        for factor, power in (top * bottom).numer().factor()[1]:
            odd = odd * fmpq_poly(factor) if power % 2 else odd
        require(count_roots(strip(odd, ends), *ends) == 0, "a change of sign")
    if goal.relation != ">=":
        while (common := top.gcd(bottom)).degree() > 0:
            top = top / common
        top = strip(top, [fmpq(0)]) if limit.nonzero else top
        top = strip(top, [e for e, same, is_open in zip(ends, exact, limit[2:4], strict=True) if same and is_open])
        require(all(end is None or top(end) != 0 for end in ends), "a zero at an end")
        require(count_roots(top, *ends) == 0, "a zero inside")


def is_end(end: fmpq | None, own: Term | None, sign: int) -> bool:
    """Whether a rational end is that of the range; refused where it may lie inside."""
    if end is None or own is None:
        require(end is None, "an end inside the range")
        return False
    if is_identity(subtract(own, number(end))):
        return True
    require((value_of(own, {}) - arb(end)) * sign > 0, "an end inside the range")
    return False


def inner_number(low: fmpq | None, high: fmpq | None) -> fmpq:
    if low is not None and high is not None:
        require(low < high, "an empty range")
        return (low + high) / 2
    return fmpq(0) if low is None and high is None else fmpq(low + 1 if low is not None else high - 1)  # type: ignore[operator]


def strip(polynomial: fmpq_poly, roots: Iterable[fmpq | None]) -> fmpq_poly:
    """The polynomial without these roots."""
    for root in roots:
        while root is not None and polynomial.degree() > 0 and polynomial(root) == 0:
            polynomial = polynomial / fmpq_poly([-root, 1])
    return polynomial


def count_roots(polynomial: fmpq_poly, low: fmpq | None, high: fmpq | None) -> int:
    """Distinct real roots between two numbers that are none: Sturm's theorem."""
    require(polynomial.degree() <= 200, "a polynomial of a high degree")
    chain = [polynomial, polynomial.derivative()]
    while chain[-1] != 0:
        rest = chain[-2] % chain[-1]
        scale = max((abs(c) for c in rest.coeffs()), default=fmpq(1))
        chain.append(rest * (-1 / scale) if rest != 0 else rest)

    def changes(at: Callable[[fmpq_poly], fmpq]) -> int:
        signs = [value > 0 for value in map(at, chain[:-1]) if value != 0]
        return sum(a != b for a, b in pairwise(signs))

    def far(p: fmpq_poly, sign: int) -> fmpq:
        return p.leading_coefficient() * sign ** p.degree()

    first = changes(lambda p: far(p, -1) if low is None else p(low))
    return first - changes(lambda p: far(p, 1) if high is None else p(high))


def to_fraction(term: Term) -> tuple[fmpq_poly, fmpq_poly]:
    """A term of one symbol as N/D; the divisors of the term do not vanish where D does not."""
    match term:
        case ("number", q):
            return fmpq_poly([q]), fmpq_poly([1])
        case ("symbol", _):
            return fmpq_poly([0, 1]), fmpq_poly([1])
        case ("+", *terms):
            pairs = map(to_fraction, terms)
            return reduce(
                lambda x, y: (x[0] * y[1] + y[0] * x[1], x[1] * y[1]) if x[1] != y[1] else (x[0] + y[0], x[1]), pairs
            )
        case ("*", *factors):
            return reduce(lambda x, y: (x[0] * y[0], x[1] * y[1]), map(to_fraction, factors))
        case ("^", base, exponent):
            q, (top, bottom) = constant_of(exponent), to_fraction(base)
            require(q is not None and q.q == 1 and abs(q) <= 200, "no rational function")
            n = int(q)  # type: ignore[arg-type]
            return (top**n, bottom**n) if n >= 0 else (bottom**-n, top**-n)
    raise Refused("no rational function")


# Integrals, sums, products and limits. The reader puts a symbol in the place of each and keeps the question what it is.
# An answer is a term, proved to be its value where all else that was typed has values; it takes the symbol's place.

QUESTIONS = ("integral", "sum", "product", "limit")
INFINITY: Term = ("symbol", "oo")
MOST_TERMS, TINY, SLOW = 400, fmpq(-(10**9)), fmpq(1, 1000)


class Question(NamedTuple):
    """The integral, sum or product of a term over a variable from low to high, or its limit at low = high.

    ``needs`` have to have a value wherever the term has to, and the question may stand ``within`` others.
    """

    kind: str
    value: str
    variable: str
    term: Term
    low: Term
    high: Term
    needs: tuple[Term, ...]
    within: tuple[Question, ...]

    def change(self, f: Callable[[Term], Term]) -> Question:
        needs, within = tuple(map(f, self.needs)), tuple(q.change(f) for q in self.within)
        return self._replace(term=f(self.term), low=f(self.low), high=f(self.high), needs=needs, within=within)

    def list_terms(self) -> tuple[Term, ...]:
        return (self.term, *self.needs, self.low, self.high)


class Answers:
    """The answers of a certificate, in the order of the questions; at a point, or for all of the box."""

    def __init__(self, entries: Any, point: dict[str, Term] | None = None):
        self.entries, self.point = read_list(entries, lambda entry: entry), point

    def settle(self, question: Question, goal: Goal) -> Term:
        """The value of a question at all points of a goal."""
        require(self.entries, f"{question.kind} without an answer")
        return ANSWERS[question.kind](self.entries.pop(0), question, goal)


def is_asked(term: Term) -> bool:
    """Whether the symbol of a question stands in a term."""
    return any(" " in name for name in symbols_of(term))


def at_point(term: Term, point: dict[str, Term]) -> Term:
    """The term at a point; an exponent that was no number stays none."""
    for exponent in list_exponents(term):
        keep_power(exponent, substitute(exponent, point))
    return substitute(term, point)


Parts = list[tuple[Term, str, tuple[Term, ...]]]


def settle_questions(reader: Reader, goals: Parts, box: dict[str, Range], answers: Answers) -> Parts:
    """The goals with the values of all questions, which hold where all else that was typed has values."""
    if not reader.questions:
        return goals
    bound = {q.variable for q in reader.questions}
    require(not bound & set(box) and "oo" not in box, "a name that is in use")
    typed = [*(t for goal in goals for t in goal[2]), *reader.exists]
    typed += [t for q in reader.questions for t in q.list_terms()]
    pairs = ((r, t) for r, t in set_union(map(conditions, typed)) if not is_asked(t) and not bound & symbols_of(t))
    exists = tuple(EXISTING[r](t) for r, t in pairs)
    reader.need(*exists)
    known = [tuple(t for t in part if not is_asked(t)) for part in (reader.given, reader.zeros)]
    point, values = answers.point, dict[str, Term]()
    for question in reader.questions:
        q, goal = question.change(lambda t: substitute(t, values)), Goal(ZERO, "=", box, exists, *known)
        if point is not None:
            q, goal = q.change(lambda t: at_point(t, point)), Goal(ZERO, "=", {})
        for outer in q.within:
            goal = bind(outer, goal)
        value = answers.settle(q, goal)
        n = isqrt(len(value) - 1)
        places = [f"{q.value} {i} {j}" for i in range(n) for j in range(n)] if q.kind == "expm" else [q.value]
        values.update(zip(places, value[1:] if q.kind == "expm" else [value], strict=True))
    for part in (reader.exists, reader.given, reader.zeros):
        rows = dict.fromkeys(substitute(t, values) for t in part)
        part.clear()
        part |= rows
    return [(substitute(t, values), r, tuple(substitute(p, values) for p in parts)) for t, r, parts in goals]


EXISTING: dict[str, Callable[[Term], Term]] = {
    ">": lambda t: ("log", t),
    ">=": lambda t: ("sqrt", t),
    "!=": lambda t: ("^", t, MINUS_ONE),
}


def bind(outer: Question, goal: Goal) -> Goal:
    """The goal for all values of the variable of a question; for all numbers where its ends are no numbers."""
    ends = [None if is_infinite(end) or symbols_of(end) else end for end in (outer.low, outer.high)]
    if None not in ends and not value_of(ends[1], {}) > value_of(ends[0], {}):  # type: ignore[arg-type]
        ends = [None, None]
    limit = Range(ends[0], ends[1], integer=outer.kind in ("sum", "product"))
    limit = Range(None, None) if outer.kind == "limit" else limit
    return goal._replace(box=goal.box | {outer.variable: limit})


def is_infinite(end: Term) -> bool:
    """Whether an end is oo or -oo."""
    require(end in (INFINITY, negate(INFINITY)) or "oo" not in symbols_of(end), "a sum or product with oo")
    return "oo" in symbols_of(end)


def prove_vanishing(proof: Any, goal: Goal, plain: Term, term: Term) -> None:
    """A term is 0 by exact algebra, as it is without a proof, or at all points of the goal."""
    if proof is None:
        require(is_identity(plain), "the terms differ")
    else:
        prove(proof, goal._replace(term=term, relation="="))


def answer_integral(entry: Any, q: Question, goal: Goal) -> Term:
    """Over a range in pieces: sum F(d) - F(c) for antiderivatives F on the pieces from c to d.

    Theorem: a function f that is continuous between c and d, where F' = f, has the integral F(d-) - F(c+), improper or
    not, where F has these limits: the integral from c + h to d - h is F(d - h) - F(c + h).
    """
    cuts, pieces = read_fields(entry, "cuts pieces")
    places = [q.low, *read_list(cuts, parse), q.high]
    require(not any(q.variable in symbols_of(place) for place in places), "the variable in a cut")
    rows = zip(read_list(pieces, lambda piece: piece, len(places) - 1), pairwise(places), strict=True)
    return ("+", ZERO, *(integrate_piece(row, q, goal, *ends) for row, ends in rows))


def integrate_piece(piece: Any, q: Question, goal: Goal, c: Term, d: Term) -> Term:
    """F(d) - F(c) by values, for a continuous F, or by limits; x runs from c to d as the parameter does from 0."""
    text, by_limit, continuous, smooth, equal, signs = read_fields(
        piece, "antiderivative limits continuous smooth equal signs"
    )
    F, name, x = parse(text), q.variable, ("symbol", q.variable)
    require(not (is_infinite(c) and is_infinite(d)), "expected a cut between -oo and oo")
    is_open = read_list(by_limit, read_flag, 2)
    require(all(o or not is_infinite(end) for o, end in zip(is_open, (c, d), strict=True)), "expected a limit at oo")
    w = ("^", x, MINUS_ONE)
    if is_infinite(d):
        require(d == INFINITY, "a range that ends at -oo")
        path, limit, ways = add_terms((c, x)), Range(ZERO, None, is_open[0]), (add_terms((c, w)), x)
    elif is_infinite(c):
        require(c == negate(INFINITY), "a range that begins at oo")
        path, limit, ways = subtract(d, x), Range(ZERO, None, is_open[1]), (negate(x), take_off(d, w))
    else:
        across = take_off(d, c)
        path, limit = add_terms((c, ("*", across, x))), Range(ZERO, ONE, *is_open)
        ways = (add_terms((c, ("*", across, w))), take_off(d, ("*", across, w)))
    whole = goal._replace(box=goal.box | {name: limit})
    inside = goal._replace(box=goal.box | {name: limit._replace(open_low=True, open_high=True)})
    slope = differentiate(F, name)
    prove_defined(continuous, whole, substitute(F, {name: path}), level=CONTINUOUS)
    inner = [substitute(t, {name: path}) for t in (F, slope, q.term, *q.needs)]
    prove_defined(smooth, inside, *inner, level=DIFFERENTIABLE)
    difference = subtract(slope, q.term)
    prove_vanishing(equal, inside, difference, substitute(difference, {name: path}))
    ends = [
        find_limit(substitute(F, {name: way}), name, signs, goal) if o else substitute(F, {name: end})
        for o, way, end in zip(is_open, ways, (c, d), strict=True)
    ]
    require(signs == [], "a sign too many")
    return subtract(ends[1], ends[0])


def list_whole(low: Term, high: Term) -> range:
    """The whole numbers from one number to another."""
    a, b = constant_of(low), constant_of(high)
    require(a is not None and b is not None and a.q == b.q == 1, "expected whole ends")
    require(b - a < MOST_TERMS, "too many terms")  # type: ignore[operator]
    return range(int(a), int(b) + 1)  # type: ignore[arg-type]


def combine(kind: str, terms: Iterable[Term]) -> Term:
    """The sum or product of some terms."""
    return ("+", ZERO, *terms) if kind == "sum" else ("*", ONE, *terms)


def answer_sum(entry: Any, q: Question, goal: Goal) -> Term:
    """G(high + 1) - G(low) where G(k + 1) - G(k) = f(k); of a product their quotient where G(k + 1) = f(k) G(k).

    Theorem: induction over whole high >= low - 1, where there are no terms; to oo by the limit. Between numbers, as at
    a point, "terms" are all.
    """
    if entry == "terms":
        rows = [[at_point(t, {q.variable: number(k)}) for t in (q.term, *q.needs)] for k in list_whole(q.low, q.high)]
        prove_defined([], goal, *(t for row in rows for t in row))
        return combine(q.kind, (row[0] for row in rows))
    text, defined, equal, start, count, signs = read_fields(entry, "telescoper defined equal start count signs")
    G, name, k = parse(text), q.variable, ("symbol", q.variable)
    require(is_integral(q.low, goal.box), "expected whole ends")
    path, following = add_terms((q.low, k)), substitute(G, {name: ("+", k, ONE)})
    inside = goal._replace(box=goal.box | {name: Range(ZERO, None, integer=True)})
    first = substitute(G, {name: q.low})
    if not is_infinite(q.high):
        require(is_integral(q.high, goal.box), "expected whole ends")
        inside = inside._replace(given=(*goal.given, subtract(subtract(q.high, q.low), k)))
        prove(count, goal._replace(term=("+", subtract(q.high, q.low), ONE), relation=">="))
        last = substitute(G, {name: ("+", q.high, ONE)})
    else:
        require(q.high == INFINITY and count is None, "a sum to -oo")
        last = find_limit(G, name, signs, goal)
    require(signs == [], "a sign too many")
    prove_defined(defined, inside, *(substitute(t, {name: path}) for t in (G, following, q.term, *q.needs)))
    step = ("+", G, q.term) if q.kind == "sum" else ("*", G, q.term)
    difference = subtract(following, step)
    prove_vanishing(equal, inside, difference, substitute(difference, {name: path}))
    needed = first if q.kind == "sum" else ("^", first, MINUS_ONE)
    prove_defined(start, goal, needed)
    return subtract(last, first) if q.kind == "sum" else ("*", last, needed)


def is_integral(term: Term, box: dict[str, Range], floors: Iterable[Term] = ()) -> bool:
    """Whether a term is seen to be whole: sums and products of whole numbers, whole symbols and floors."""
    if term in floors:
        return True
    match term:
        case ("symbol", name):
            return name in box and box[name].integer
        case ("+" | "*", *parts):
            return all(is_integral(part, box, floors) for part in parts)
    return term[0] == "number" and term[1].q == 1


def answer_limit(entry: Any, q: Question, goal: Goal) -> Term:
    """At oo by growth; at a number a the limit of N/D is N^(n)(a)/D^(n)(a); at oo that of N/D in 1/x at 0.

    Theorem (Taylor): N, D are analytic at a, where the derivatives of order below n vanish, and that of D does not.
    """
    name, far, signs = q.variable, is_infinite(q.low), entry["signs"]
    y, a = ("symbol", name), ZERO if far else q.low
    way = y if not far or q.low == INFINITY else negate(y)
    typed = [substitute(t, {name: way}) for t in (q.term, *q.needs)]
    places = [(r, t) for r, t in set_union(map(conditions, typed)) if name in symbols_of(t)]
    if far:
        for r, t in places:
            c = grow(t, name, lambda c: ask_sign(c, signs, goal))[1]
            require(c is not None and (ask_sign(c, signs, goal) == 1 or r == "!="), "it may have no value")
    if set(entry) == {"signs"}:
        require(far, "expected oo")
        value = find_limit(typed[0], name, signs, goal)
        require(signs == [], "a sign too many")
        return value
    top, bottom, order, defined, zeros, pole, around, _ = read_fields(
        entry, "top bottom order defined zeros pole around signs"
    )
    require(signs == [], "a sign too many")
    N, D, n = parse(top), parse(bottom), read_integer(order, 0, 8)
    f = substitute(typed[0], {name: ("^", y, MINUS_ONE)}) if far else typed[0]
    require(is_identity(subtract(f, ("*", N, ("^", D, MINUS_ONE)))), "the quotient is another one")

    def derive(term: Term, times: int) -> Term:
        return substitute(reduce(lambda t, _: differentiate(t, name), range(times), term), {name: a})

    places = [] if far else places
    orders = read_list(around, lambda k: read_integer(k, 0, 8), len(places))
    require(all(r == "!=" or k == 0 for (r, _), k in zip(places, orders, strict=True)), "a sign on both sides")
    # What is != 0 or > 0 at a is so near a; what has a derivative that is != 0 there vanishes at no other point near a.
    near = [(r if r == "!=" else ">", derive(t, k)) for (r, t), k in zip(places, orders, strict=True)]
    value, divisor = derive(N, n), derive(D, n)
    analytic = (*(derive(t, 0) for t in (N, D, *(t for _, t in places))), *(t for _, t in near), value, divisor)
    # An exponent may become rational at a, and b**q exists for b <= 0, too; N and D exist near a where b > 0.
    analytic += tuple(substitute(t, {name: a}) for t in (*smoothness(N), *smoothness(D)))
    prove_defined(defined, goal, *analytic, level=DIFFERENTIABLE)
    prove_all(pole, [goal._replace(term=t, relation=r) for r, t in (*near, ("!=", divisor))])
    prove_all(zeros, [goal._replace(term=derive(t, k), relation="=") for k in range(n) for t in (N, D)])
    return ("*", value, ("^", divisor, MINUS_ONE))


def answer_expm(entry: Any, q: Question, goal: Goal) -> Term:
    """The entries of X(1), where dX/ds = A X for s from 0 to 1 and X(0) is the unit matrix.

    Theorem (Picard, Lindelöf): a linear equation has one solution with a given start, and exp(s A) is one.
    """
    rows, smooth, equal, start = read_fields(entry, "rows smooth equal start")
    n, s = isqrt(len(q.term) - 1), q.variable
    X = read_list(rows, lambda row: read_list(row, parse, n), n)
    places = [(i, j) for i in range(n) for j in range(n)]
    whole = goal._replace(box=goal.box | {s: Range(ZERO, ONE)})
    prove_defined(smooth, whole, *(x for row in X for x in row), level=DIFFERENTIABLE)
    for (i, j), slope, first in zip(places, *(read_list(p, lambda e: e, n * n) for p in (equal, start)), strict=True):
        image = make_sum(*(("*", q.term[1 + n * i + k], X[k][j]) for k in range(n)))
        change = subtract(differentiate(X[i][j], s), image)
        prove_vanishing(slope, whole, change, change)
        begin = subtract(substitute(X[i][j], {s: ZERO}), ONE if i == j else ZERO)
        prove_vanishing(first, goal, begin, begin)
    return ("matrix", *(substitute(X[i][j], {s: ONE}) for i, j in places))


ANSWERS: dict[str, Callable[[Any, Question, Goal], Term]] = {
    "integral": answer_integral, "sum": answer_sum, "product": answer_sum, "limit": answer_limit, "expm": answer_expm,
}  # fmt: skip


def ask_sign(c: Term, signs: Any, goal: Goal) -> int:
    """The sign of a number that is not 0, from its ball, or by the next proof of a certificate."""
    ball = value_of(c, {}) if not symbols_of(c) else arb.nan()
    if ball > 0 or ball < 0:
        return 1 if ball > 0 else -1
    require(isinstance(signs, list) and signs, "expected a sign with its proof")
    sign, proof = read_list(signs.pop(0), lambda entry: entry, 2)
    s = read_sign(sign)
    prove(proof, goal._replace(term=c if s == 1 else negate(c), relation=">"))
    return s


def find_limit(term: Term, w: str, signs: Any, goal: Goal) -> Term:
    """The limit of a term for w to +oo."""
    degree, c = grow(term, w, lambda t: ask_sign(t, signs, goal))
    require(degree < 0 or (degree == 0 and c is not None), "no limit is known")
    return c if degree == 0 and c is not None else ZERO


def grow(term: Term, w: str, sign: Callable[[Term], int]) -> tuple[fmpq, Term | None]:
    """(d, c) with term/w**d -> c for w to +oo; (d, None) where it is only bounded for large w, by which it is defined.

    Sums and products of limits; powers and functions of them where these are continuous; exp(-c w**d) falls faster than
    any power, log grows slower than any, and sin u/u and atan u/u -> 1 for u -> 0.
    """
    if w not in symbols_of(term):
        return fmpq(0), term
    match term:
        case ("symbol", _):
            return fmpq(1), ONE
        case ("+", *terms):
            parts = [grow(t, w, sign) for t in terms if t != ZERO]
            top = max(d for d, _ in parts)
            first = [c for d, c in parts if d == top]
            return top, None if None in first else add_terms(first)  # type: ignore[arg-type]
        case ("*", *factors):
            parts = [grow(f, w, sign) for f in factors]
            known = [c for _, c in parts if c is not None]
            return sum((d for d, _ in parts), fmpq(0)), multiply_terms(*known) if len(known) == len(parts) else None
        case ("^", base, exponent):
            q = constant_of(exponent)
            if q is None:
                return grow(("exp", ("*", exponent, ("log", base))), w, sign)
            d, c = grow(base, w, sign)
            if q.q > 1 or q <= 0:
                require(c is not None and (sign(c) == 1 or q.q == 1), "a power that may have no value")
            return d * q, None if c is None else ("^", c, number(q))
        case ("sqrt", u):
            return grow(("^", u, number(HALF)), w, sign)
        case (name, u) if name in DEFINITIONS and name not in ("abs", "tanh"):
            return grow(replace(parse(DEFINITIONS[name]), ("symbol", "x"), u), w, sign)
        case (name, u):
            return grow_function(name, *grow(u, w, sign), sign)
    raise Refused("no growth is known")


def grow_function(name: str, d: fmpq, c: Term | None, sign: Callable[[Term], int]) -> tuple[fmpq, Term | None]:
    """The growth of a function of u from that of u."""
    zero = fmpq(0)
    if name == "abs":
        return d, None if c is None else ("abs", c)
    if name == "log":
        require(c is not None and sign(c) == 1, "a logarithm that may have no value")
        return (SLOW, None) if d != 0 else (zero, ("log", c))
    require(name in ("exp", "sin", "cos", "atan", "tanh", "erf"), "no growth is known")
    if d < 0 and name == "erf":
        return d, None if c is None else ("*", number(2), ("^", ("pi",), number(-HALF)), c)
    if d < 0:
        return (zero, ONE) if name in ("exp", "cos") else (d, c)
    if d == 0:
        return zero, None if c is None else (name, c)
    if name in ("sin", "cos"):
        return zero, None
    require(c is not None, "no growth is known")
    if name == "exp":
        require(sign(c) == -1, "an exponential that may grow")  # type: ignore[arg-type]
        return TINY, None
    return zero, multiply_terms(number(sign(c)), HALF_TURN if name == "atan" else ONE)  # type: ignore[arg-type]


# Equations up to small terms


def expand_goals(reader: Reader, goals: Parts, small: Any, box: dict[str, Range]) -> Parts:
    """left - right = O(s**n) for s to 0: all that was typed is analytic at s = 0, where derivatives below n vanish."""
    require(isinstance(small, dict) and len(small) == 1, "expected the order in one symbol")
    ((name, n),) = small.items()
    require(name in box and read_integer(n, 1, 8), "an order in no symbol")
    limit = box[name]
    near = not limit.integer and is_inside(ZERO, Range(limit.low, limit.high)) and not is_narrow(limit)
    require(near, "0 is no limit of the symbol")
    require(not any(name in symbols_of(t) for t in (*reader.given, *reader.zeros)), "a hypothesis on a small symbol")
    zero, found = {name: ZERO}, []
    typed = [t for goal in goals for t in goal[2]] + [*reader.exists]
    analytic = [substitute(t, zero) for part in typed for t in (part, *smoothness(part))]
    reader.exists.clear()
    reader.need(*analytic)
    for term, relation, _ in goals:
        require(relation == "=", "an order of what is no equation")
        for _ in range(n):
            found.append((substitute(term, zero), "=", (*analytic, substitute(term, zero))))
            term = differentiate(term, name)
    return found


RULES: dict[str, Callable[[Any, Goal], None]] = {
    rule.__name__.removeprefix("prove_"): rule
    for rule in (
        prove_equal, prove_rewrite, prove_multiply, prove_exponential, prove_side, prove_cases, prove_split,
        prove_integers, prove_abstract, prove_dense, prove_identity, prove_zero, prove_between, prove_solve,
        prove_squares, prove_derivative, prove_balls, prove_given, prove_empty, prove_modulo, prove_range,
        prove_angle, prove_bounded, prove_corners, prove_product, prove_sum, prove_slope, prove_concave,
        prove_cones, prove_quadratic, prove_roots,
    )
}  # fmt: skip


def read_point(point: Any, box: dict[str, Range]) -> dict[str, Term]:
    """A point of a box: a number for every symbol, shown to lie in its range."""
    require(isinstance(point, dict) and set(point) == set(box), "the point gives every symbol")
    place = {name: parse(text) for name, text in point.items()}
    require(all(is_inside(place[name], box[name]) for name in box), "the point may lie outside the box")
    return place


def lies_in(case: Case, place: dict[str, Term]) -> bool:
    """Whether a point is shown to belong to a case: all of it has a value, and its conditions hold."""
    place = case.complete(place)
    balls = {name: evaluate(value, {}, arb) for name, value in place.items()}
    if not all(value_of(t, balls).is_finite() for t in case.terms):
        return False
    if not all(value_of(t, balls) >= 0 or is_identity(substitute(t, place)) for t in case.given):
        return False
    return all(is_identity(substitute(t, place)) for t in case.zeros)


def check_proof(item: Any) -> None:
    """A statement holds wherever all of it is defined and its hypotheses hold; the witness is such a point."""
    more = " answers" if "answers" in item else ""
    _, statement, bits, witness, proofs, *rest = read_fields(item, f"kind statement bits witness proofs{more}")
    set_precision(bits)
    cases, box = read_statement(statement, Answers(deepcopy(rest[0]) if rest else []))
    place = read_point(witness, box)
    require(any(lies_in(case, place) for case in cases), "the statement may have no value at the witness")
    prove_all(proofs, [goal for case in cases for goal in case.goals])


FAILURES: dict[str, Callable[[arb], Any]] = {
    "=": lambda ball: ball > 0 or ball < 0,
    "!=": lambda ball: ball == 0,
    ">": lambda ball: ball <= 0,
    ">=": lambda ball: ball < 0,
}


def check_counterexample(item: Any) -> None:
    """At a point where all of it is defined a statement fails: by balls, or because a term is exactly 0 there."""
    more = " answers" if "answers" in item else ""
    _, statement, bits, point, zero, *rest = read_fields(item, f"kind statement bits point zero{more}")
    set_precision(bits, 200000)
    require(isinstance(point, dict), "expected numbers by symbol")
    there = {name: parse(text) for name, text in point.items()}
    cases, box = read_statement(statement, Answers(deepcopy(rest[0]) if rest else [], there))
    place = read_point(point, box)
    inside = [case for case in cases if lies_in(case, place)]
    goals = [goal for case in inside for goal in case.goals]
    require(goals, "the statement may have no value at the point")
    if zero is not None:
        (goal,), place = goals, inside[0].complete(place)
        require(goal.relation in (">", "!="), "the statement allows 0")
        prove(zero, Goal(substitute(goal.term, place), "=", {}))
        return
    balls = [{name: evaluate(value, {}, arb) for name, value in case.complete(place).items()} for case in inside]
    values = [(g.relation, value_of(g.term, b)) for case, b in zip(inside, balls, strict=True) for g in case.goals]
    require(any(FAILURES[relation](value) for relation, value in values), "the statement is not seen to fail there")


# -- 10. Matrices of any size ------------------------------------------------------------------------------------------
# A matrix has two dimensions, each a whole number or the name of one; shapes are compared by these names. An equation
# between matrices holds for all values of the names if the difference of its sides, multiplied out into words of
# letters that do not commute, is a sum of c L r M: the relation r is 0 by a declaration, a hypothesis or the definition
# of an inverse. Equal sums of words are equal matrices of every size (Raab, Regensburger, Hossein Poor, Formal proofs
# of operator identities by a single formal computation, 2021).
Letter = tuple[str, bool]  # a name, and whether it is transposed
Word = tuple[Letter, ...]
PROPERTIES = ("symmetric", "positive", "nonnegative", "invertible", "orthogonal", "skew", "diagonal")
REGULAR = ("positive", "invertible")
MOST_WORDS, MOST_SIZE = 20000, 8


class Typed(NamedTuple):
    """A matrix: its dimensions, its value in an algebra, one of PROPERTIES or nothing, and whose product it is."""

    rows: Any
    columns: Any
    body: Any
    known: str = ""
    factors: tuple[Any, ...] = ()


class Algebra:
    """Matrices by their dimensions; what is positive definite, nonnegative or invertible; inverses taken to exist.

    What a value is and how it is computed is said by :class:`Words` and :class:`Sized`.
    """

    make_letter = declare = relate = to_number = add_bodies = scale_body = multiply_bodies = None  # type: Any
    transpose_body = invert_body = make_body = trace = None  # type: Any

    def __init__(self, item: Any):
        self.statement = read_fields(item, "left relation right symbols matrices dimensions given")
        symbols, matrices, dimensions = self.statement[3:6]
        require(isinstance(symbols, dict) and isinstance(matrices, dict), "expected declarations by name")
        self.dimensions = read_list(dimensions, str)
        names = read_symbols([*symbols, *matrices, *self.dimensions])
        require(not any(matches("(trace|inv|arg)__.*", name) for name in names), "a name of the checker's own")
        self.box = {name: read_range(symbols[name]) for name in symbols}
        self.box |= dict.fromkeys(self.dimensions, Range(ONE, None, integer=True))
        self.names: dict[str, Any] = {name: ("symbol", name) for name in self.box}
        self.terms: dict[Term, None] = {}
        self.assumed: dict[str, None] = {}
        self.above: set[Term] = set()  # numbers x' M x with nonnegative M

    def declare_all(self) -> None:
        """The declared matrices, each a letter with its properties; all but products of any shape are square."""
        for name, item in self.statement[4].items():
            size, words = read_fields(item, "size is")
            rows, columns = read_list(size, self.read_dimension, 2)
            require(set(read_list(words, str)) <= set(PROPERTIES), "an unknown property")
            require(not words or rows == columns, "a property of square matrices")
            require((rows, columns) != (1, 1), "a matrix of one entry is declared as a number")
            known = next((word for word in ("positive", "invertible", "nonnegative") if word in words), "")
            known = known or "invertible" * ("orthogonal" in words)
            self.names[name] = Typed(rows, columns, self.make_letter(name, rows, columns, words), known)
            self.declare(self.names[name], words)

    def read_dimension(self, item: Any) -> Any:
        return item if item in self.dimensions else read_integer(item, 1, 64)

    def make(self, rows: Any, columns: Any, body: Any, known: str = "", factors: tuple[Any, ...] = ()) -> Any:
        """A matrix, or the number where it has one row and one column whatever the dimensions are."""
        if not rows == columns == 1:
            return Typed(rows, columns, body, known, factors)
        if known in ("positive", "nonnegative"):
            self.above.add(self.to_number(body))
        return self.to_number(body)

    def add(self, *values: Any) -> Any:
        """A sum; of nonnegative matrices it is nonnegative, and positive definite where one is."""
        if not any(isinstance(x, Typed) for x in values):
            return make_sum(*values)
        require(all(isinstance(x, Typed) for x in values) and len({x[:2] for x in values}) == 1, "different shapes")
        known = {x.known for x in values}
        word = "positive" if "positive" in known else "nonnegative"
        body = reduce(self.add_bodies, (x.body for x in values))
        return Typed(values[0].rows, values[0].columns, body, word if known <= {"positive", "nonnegative"} else "")

    def scale(self, factor: Term, x: Typed) -> Typed:
        sign = self.sign_of(factor)
        known = x.known if sign == ">" else "invertible" * (sign == "!=" and x.known in REGULAR)
        self.terms[factor] = None
        return Typed(x.rows, x.columns, self.scale_body(factor, x.body), known)

    def sign_of(self, term: Term) -> str:
        """``>`` for products of what is declared to be positive, ``!=`` where it is not 0, else nothing."""
        if term[0] == "+":
            some = [part for part in term[1:] if part not in self.above]
            return ">" * bool(some and all(self.sign_of(part) == ">" for part in some))
        signs = set()
        for factor in list_factors(term):
            base = factor[1] if factor[0] == "^" and factor[2][0] == "number" else factor
            limit = self.box.get(base[1], Range(None, None)) if base[0] == "symbol" else Range(None, None)
            low = None if limit.low is None else constant_of(limit.low)
            apart = limit.nonzero or limit.open_low or (low is not None and low > 0)
            above = base[1] > 0 if base[0] == "number" else low is not None and low >= 0 and apart
            signs.add(">" if above else "!=" if limit.nonzero or (base[0] == "number" and base[1] != 0) else "")
        return min(signs, key=("", "!=", ">").index)

    def multiply(self, x: Any, y: Any) -> Any:
        """A product of matrices, whose dimensions fit."""
        require(isinstance(x, Typed) and isinstance(y, Typed) and x.columns == y.rows, "shapes that do not fit")
        factors = (x.factors or (x,)) + (y.factors or (y,))
        known = self.judge_product(factors) if x.rows == y.columns else ""
        return self.make(x.rows, y.columns, self.multiply_bodies(x.body, y.body), known, factors)

    def judge_product(self, factors: tuple[Typed, ...]) -> str:
        """M N M' is nonnegative where N is, positive definite if M is regular; products of regular ones are regular."""
        k = 0
        while 2 * k + 1 < len(factors) and self.transpose(factors[k]).body == factors[-1 - k].body:
            k += 1
        centre, regular = factors[k : len(factors) - k], all(x.known in REGULAR for x in factors)
        middle = centre[0].known if len(centre) == 1 else "" if centre else "positive"
        if regular:
            return "positive" if middle == "positive" else "invertible"
        return "nonnegative" if middle in ("positive", "nonnegative") else ""

    def transpose(self, x: Any) -> Typed:
        require(isinstance(x, Typed), "expected a matrix")
        factors = tuple(self.transpose(factor) for factor in reversed(x.factors))
        return Typed(x.columns, x.rows, self.transpose_body(x.body), x.known, factors)

    def invert(self, x: Any, text: str) -> Typed:
        """The inverse, which is taken to exist unless it is known to; ``text`` is how the matrix is written."""
        require(isinstance(x, Typed) and x.rows == x.columns, "expected a square matrix")
        if x.known not in REGULAR:
            self.assumed[f"{text} invertible"] = None
        known = "positive" if x.known == "positive" else "invertible"
        return Typed(x.rows, x.rows, self.invert_body(x.body, x.rows), known)

    def read(self, text: Any) -> Any:
        """The value of a text."""
        formula = WordFormula(text, self)
        value = formula.read_sum()
        require(formula.words == [""], "not an expression: more than one")
        return value

    def subtract(self, x: Any, y: Any) -> Any:
        """A difference of two matrices of one shape, or of two numbers, which have to have a value."""
        self.terms |= dict.fromkeys(side for side in (x, y) if not isinstance(side, Typed))
        minus = self.scale(MINUS_ONE, y) if isinstance(y, Typed) else negate(y)
        return self.add(x, minus)

    def suppose(self) -> None:
        """The declarations and the hypotheses; S = X is as definite as X."""
        self.declare_all()
        for text in read_list(self.statement[6], str):
            formula = WordFormula(text, self)
            name, x = formula.words[-1], formula.read_sum()
            require(formula.take("="), "expected a hypothesis with =")
            y = formula.read_sum()
            require(formula.words == [""], "not a hypothesis: more than one")
            self.relate(self.subtract(x, y))
            own = self.names.get(name)
            if isinstance(own, Typed) and own is x and isinstance(y, Typed) and not own.known:
                self.names[name] = own._replace(known=y.known)

    def state(self) -> tuple[str, Any]:
        """The relation between both sides, and their difference, after the declarations and the hypotheses."""
        left, relation, right = self.statement[:3]
        self.suppose()
        require(relation in SIGNS, "an unknown relation")
        x, y = self.read(left), self.read(right)
        require(not isinstance(x, Typed) or relation in ("=", "!="), "matrices have no order")
        return relation, self.subtract(x, y)


class WordFormula(Formula):
    """The language of files for matrices of any size: + - @ * of numbers, .T, and the functions of WORD_CALLS."""

    reader: Any

    def __init__(self, text: str, reader: Any):
        super().__init__(text, reader)
        self.every = [*self.words]

    def add(self, *terms: Any) -> Any:
        return self.reader.add(*terms)

    def negate(self, value: Any) -> Any:
        return self.reader.scale(MINUS_ONE, value) if isinstance(value, Typed) else negate(value)

    def read_product(self) -> Any:
        factors = [self.read_signed()]
        while mark := self.take("*", "/", "@"):
            before, value = len(self.words), self.read_signed()
            if mark == "/" and has_trace(value) and not self.reader.sign_of(value):
                self.reader.assumed[f"{write_words(self.every[len(self.words) : before])} != 0"] = None
            if mark == "@":
                factors = [self.reader.multiply(self.scale(factors), value)]
                continue
            require(mark == "*" or not isinstance(value, Typed), "a division by a matrix")
            factors.append(value if mark == "*" else ("^", value, MINUS_ONE))
        return self.scale(factors)

    def scale(self, factors: list[Any]) -> Any:
        """The product of numbers and at most one matrix."""
        matrices = [x for x in factors if isinstance(x, Typed)]
        require(len(matrices) < 2, "a product of matrices is written with @")
        numbers = [x for x in factors if not isinstance(x, Typed)]
        if not matrices:
            return ("*", *numbers) if len(numbers) > 1 else numbers[0]
        return self.reader.scale(multiply_terms(*numbers), matrices[0]) if numbers else matrices[0]

    def power(self, base: Any, exponent: Any) -> Any:
        require(not isinstance(base, Typed) and not isinstance(exponent, Typed), "a power of a matrix")
        whole = is_whole(exponent) and constant_of(exponent) > 0  # type: ignore[operator]
        require(whole or not has_trace(base), "a root or inverse power of a trace; write a quotient")
        return ("^", base, exponent)

    def read_entry(self) -> Any:
        value = self.read_value()
        while self.take("."):
            require(self.take("T"), "expected T behind the point")
            value = self.reader.transpose(value)
        return value

    def read_value(self) -> Any:
        word, is_call = self.words[-1], self.words[-2:-1] == ["("]
        known = is_call or not word[:1].isalpha() or word == "pi" or word in self.reader.names
        require(known and word != "[", "an unknown name, or entries of a matrix")
        return super().read_value()

    def read_call(self, name: str) -> Any:
        """A function of matrices; or one of numbers, with one argument."""
        algebra, before = self.reader, len(self.words)
        if name in ("eye", "zeros"):
            rows = self.read_dimension()
            require(name == "eye" or self.take(","), "expected zeros(m, n)")
            columns = rows if name == "eye" else self.read_dimension()
            require(self.take(")"), "not an expression: no )")
            body = algebra.make_body(name == "eye", rows, columns)
            return algebra.make(rows, columns, body, "positive" * (name == "eye"))
        arguments = self.read_arguments()
        require(len(arguments) == 1 + (name == "dot"), f"a wrong number of arguments of {name}")
        x = arguments[0]
        if name == "inv":
            return algebra.invert(x, write_words(self.every[len(self.words) + 1 : before]))
        if name == "transpose":
            return algebra.transpose(x)
        if name == "trace":
            require(isinstance(x, Typed) and x.rows == x.columns, "expected a square matrix")
            return algebra.trace(x.body, x.rows)
        if name == "dot":
            product = algebra.multiply(algebra.transpose(x), arguments[1])
            require(not isinstance(product, Typed), "expected two vectors")
            return product
        require(name in (*DEFINITIONS, *DERIVATIVES) and not isinstance(x, Typed), f"unknown function {name}")
        require(not has_trace(x), "a function of a trace")
        return (name, x)

    def read_dimension(self) -> Any:
        word = self.words.pop()
        return self.reader.read_dimension(int(word) if word.isdigit() else word)


def has_trace(x: Any) -> bool:
    """Whether a number has traces, or products of one row and one column."""
    return not isinstance(x, Typed) and any(name.startswith("trace__") for name in symbols_of(x))


def write_words(words: list[str]) -> str:
    """The text of words in reverse."""
    spaced = (f" {word} " if word in "+-@" else f"{word} " if word == "," else word for word in reversed(words))
    return "".join(spaced).strip()


class Words(Algebra):
    """The free algebra: a matrix is a sum of words with numbers before them, ``relations`` are sums that are 0.

    A word is split where it has one row or column: what stands between two such places is a number, and moves before
    the word. Such a number, and every trace, is a symbol: trace(A B) = trace(B A), and trace(A) = trace(A').
    """

    def __init__(self, item: Any):
        super().__init__(item)
        self.sizes: dict[str, tuple[Any, Any]] = {}
        self.symmetric: set[str] = set()
        self.inverses: dict[str, str] = {}
        self.arguments: list[tuple[Any, str]] = []
        self.relations: list[Typed] = []

    def make_letter(self, name: str, rows: Any, columns: Any, words: list[str]) -> Any:
        self.sizes[name] = (rows, columns)
        if {"symmetric", "positive", "nonnegative", "diagonal"} & {*words}:
            self.symmetric.add(name)
        return {((name, False),): ONE}

    def declare(self, x: Typed, words: list[str]) -> None:
        """What holds of a declared matrix: U' U = U U' = 1, S + S' = 0, and diagonal matrices of one size commute."""
        ((name, _),) = next(iter(x.body))
        if x.known in REGULAR:
            self.find_inverse(name)
        if "orthogonal" in words:
            for product in (self.multiply(x, self.transpose(x)), self.multiply(self.transpose(x), x)):
                self.relate(self.subtract(product, self.make_unit(x.rows)))
        if "skew" in words:
            self.relate(self.add(x, self.transpose(x)))
        others = self.statement[4].items() if "diagonal" in words else ()
        for other in (n for n, own in others if n in self.names and n != name and "diagonal" in own["is"]):
            y = self.names[other]
            if x.rows == y.rows:
                self.relate(self.subtract(self.multiply(x, y), self.multiply(y, x)))

    def make_unit(self, rows: Any) -> Typed:
        return Typed(rows, rows, {(): ONE}, "positive")

    def make_body(self, is_unit: bool, rows: Any, columns: Any) -> Any:
        return {(): ONE} if is_unit else {}

    def turn(self, word: Word) -> Word:
        """The transpose of a word."""
        return tuple((name, not turned and name not in self.symmetric) for name, turned in reversed(word))

    def rows_of(self, letter: Letter) -> Any:
        return self.sizes[letter[0]][letter[1]]

    def columns_of(self, letter: Letter) -> Any:
        return self.sizes[letter[0]][not letter[1]]

    def fits(self, word: Word, rows: Any, columns: Any) -> bool:
        """Whether the dimensions of a word fit, and are these; of no letters it is the unit matrix."""
        ends = [rows, *(self.columns_of(letter) for letter in word)]
        return ends[-1] == columns and all(self.rows_of(letter) == end for letter, end in zip(word, ends, strict=False))

    def gather(self, pairs: Iterable[tuple[Word, Term]]) -> dict[Word, Term]:
        """A sum of words, with their numbers taken out."""
        total: dict[Word, Term] = {}
        for word, c in pairs:
            word, c = self.take_out(word, c)
            total[word] = add_numbers(total.get(word, ZERO), c)
            require(len(total) <= MOST_WORDS, "too many words")
        return {word: c for word, c in total.items() if c != ZERO}

    def take_out(self, word: Word, c: Term) -> tuple[Word, Term]:
        """u (v' w) x' = (v' w) u x', where v' w has one row and one column."""
        cuts = [k for k in range(len(word) + 1) if word and self.side_of(word, k) == 1]
        for start, end in pairwise(cuts):
            c = multiply_numbers(c, self.make_trace(word[start:end]))
        return (word[: cuts[0]] + word[cuts[-1] :] if cuts else word), c

    def side_of(self, word: Word, k: int) -> Any:
        """The dimension at a place of a word."""
        return self.rows_of(word[k]) if k < len(word) else self.columns_of(word[-1])

    def make_trace(self, word: Word) -> Term:
        """The symbol of a trace: the same one for words that are rotated or transposed."""
        ways = [w[k:] + w[:k] for w in (word, self.turn(word)) for k in range(len(word))]
        order = [*self.sizes]
        first = min([(order.index(name), turned) for name, turned in way] for way in ways)
        return ("symbol", "trace__" + "_".join(f"{k}{'t' * turned}" for k, turned in first))

    def trace_of(self, word: Word, rows: Any) -> Term:
        """The trace of a word; that of the unit matrix is its dimension."""
        if not word:
            return number(rows) if isinstance(rows, int) else ("symbol", rows)
        cut = next((k for k in range(len(word)) if self.rows_of(word[k]) == 1), None)
        return self.make_trace(word) if cut is None else self.take_out(word[cut:] + word[:cut], ONE)[1]

    def trace(self, body: Any, rows: Any) -> Term:
        return reduce(add_numbers, (multiply_numbers(c, self.trace_of(w, rows)) for w, c in body.items()), ZERO)

    def to_number(self, body: Any) -> Term:
        return reduce(add_numbers, (c for c in body.values()), ZERO)

    def add_bodies(self, x: Any, y: Any) -> Any:
        return self.gather([*x.items(), *y.items()])

    def scale_body(self, factor: Term, x: Any) -> Any:
        return self.gather((word, multiply_numbers(factor, c)) for word, c in x.items())

    def multiply_bodies(self, x: Any, y: Any) -> Any:
        require(len(x) * len(y) <= MOST_WORDS, "too many words")
        return self.gather((v + w, multiply_numbers(c, d)) for v, c in x.items() for w, d in y.items())

    def transpose_body(self, x: Any) -> Any:
        return {self.turn(word): c for word, c in x.items()}

    def invert_body(self, x: Any, rows: Any) -> Any:
        """The inverse of a letter; a matrix that is none gets one of its own, which is equal to it."""
        if len(x) == 1:
            ((word, c),) = x.items()
            inverse = ("^", c, MINUS_ONE)
            if c != ONE:
                self.terms[inverse] = None
                return self.scale_body(inverse, self.invert_body({word: ONE}, rows))
            if len(word) < 2:
                return {tuple((self.find_inverse(name), turned) for name, turned in word): ONE}
        name = next((name for body, name in self.arguments if body == x), None)
        if name is None:
            name = f"arg__{len(self.arguments) + 1}"
            self.arguments.append((x, name))
            body = self.make_letter(name, rows, rows, ["symmetric"] if self.transpose_body(x) == x else [])
            self.relate(self.subtract(Typed(rows, rows, body), Typed(rows, rows, x)))
        return {((self.find_inverse(name), False),): ONE}

    def find_inverse(self, name: str) -> str:
        """The letter of an inverse, X Y = Y X = 1; it is symmetric if the other one is."""
        if name not in self.inverses:
            own, rows = f"inv__{name}", self.sizes[name][0]
            self.inverses |= {name: own, own: name}
            y = Typed(rows, rows, self.make_letter(own, rows, rows, ["symmetric"] if name in self.symmetric else []))
            x = y._replace(body={((name, False),): ONE})
            for product in (self.multiply(x, y), self.multiply(y, x)):
                self.relate(self.subtract(product, self.make_unit(rows)))
        return self.inverses[name]

    def relate(self, x: Any) -> None:
        """Note what is 0, transposed too; where X Y = 1 for square matrices, also Y X = 1."""
        x = x if isinstance(x, Typed) else Typed(1, 1, {(): x})
        if any(r.body in (x.body, self.transpose_body(x.body)) for r in self.relations):
            return
        self.relations.append(x._replace(known="", factors=()))
        if self.transpose_body(x.body) != x.body:
            self.relations.append(Typed(x.columns, x.rows, self.transpose_body(x.body)))
        word = max(x.body, key=len, default=())
        if x.rows == x.columns and len(x.body) == 2 and x.body.get((), None) == negate(x.body[word]):
            for k in range(1, len(word)):
                if self.side_of(word, k) == x.rows != 1 and x.body[word] in (ONE, MINUS_ONE):
                    turned = Typed(x.rows, x.rows, {word[k:] + word[:k]: ONE})
                    self.relate(self.subtract(turned, self.make_unit(x.rows)))

    def read_word(self, text: Any) -> Word:
        """A word as it is written in a certificate: ``H.T inv__R``."""
        require(isinstance(text, str), "expected a word")
        word = tuple((name.removesuffix(".T"), name.endswith(".T")) for name in text.split())
        require(all(name in self.sizes and not (t and name in self.symmetric) for name, t in word), "a letter")
        return word

    def expand(self, share: Any, x: Typed) -> Iterator[tuple[Word, Term]]:
        """c L r M; or c trace(L r M) W, where a word W is given."""
        text, *words, place, factor = read_fields(share, "coefficient left right relation word")
        (left, right), c = map(self.read_word, words), parse(text)
        self.check_coefficient(c)
        r = self.relations[read_integer(place, 0, len(self.relations) - 1)]
        rows, columns = x[:2] if factor is None else [self.rows_of(left[0]) if left else r.rows] * 2
        require(self.fits(left, rows, r.rows) and self.fits(right, r.columns, columns), "dimensions that do not fit")
        products = {left + word + right: multiply_numbers(c, d) for word, d in r.body.items()}
        if factor is None:
            yield from products.items()
            return
        word = self.read_word(factor)
        require(self.fits(word, *x[:2]), "dimensions that do not fit")
        yield word, self.trace(products, rows)

    def check_coefficient(self, c: Term) -> None:
        """Its divisors are not 0: as declared, or because the statement divides by them too."""
        known = set_union(map(conditions, self.terms))
        for relation, term in conditions(c):
            own = relation == "!=" and all(
                self.sign_of(f) or any(r != ">=" and is_identity(subtract(f, t)) for r, t in known)
                for f in list_factors(term)
            )
            require(own or (relation, term) in known, "a number that may not exist")


def add_numbers(x: Term, y: Term) -> Term:
    return number(x[1] + y[1]) if x[0] == y[0] == "number" else add_terms((x, y))


def multiply_numbers(x: Term, y: Term) -> Term:
    if x[0] == y[0] == "number":
        return number(x[1] * y[1])
    return ZERO if ZERO in (x, y) else multiply_terms(x, y)


class Sized(Algebra):
    """Matrices of rational numbers, at a point: what is declared and given is seen to hold there."""

    def __init__(self, item: Any, point: Any):
        super().__init__(item)
        sizes, self.matrices, numbers = read_fields(point, "sizes matrices numbers")
        require(isinstance(sizes, dict) and set(sizes) == set(self.dimensions), "the point gives every dimension")
        self.sizes = {name: read_integer(size, 1, MOST_SIZE) for name, size in sizes.items()}
        own = {name: limit for name, limit in self.box.items() if name not in sizes}
        self.place = {name: number(size) for name, size in self.sizes.items()} | read_point(numbers, own)
        self.balls = {name: evaluate(value, {}, arb) for name, value in self.place.items()}

    def make_letter(self, name: str, rows: Any, columns: Any, words: list[str]) -> Any:
        require(isinstance(self.matrices, dict) and name in self.matrices, "the point gives every matrix")
        m, n = self.size_of(rows), self.size_of(columns)
        x = fmpq_mat(read_list(self.matrices[name], lambda row: read_list(row, read_number, n), m))
        require(all(HAS_PROPERTY[word](x) for word in words), "a matrix without its properties")
        return x

    def size_of(self, dimension: Any) -> int:
        return dimension if isinstance(dimension, int) else self.sizes[dimension]

    def declare(self, x: Typed, words: list[str]) -> None:
        """Its properties have been seen."""

    def make_body(self, is_unit: bool, rows: Any, columns: Any) -> Any:
        m, n = self.size_of(rows), self.size_of(columns)
        return fmpq_mat(m, n, [int(is_unit and i == j) for i in range(m) for j in range(n)])

    def value_of(self, term: Term) -> fmpq:
        """A rational number; where it is none, nothing is shown."""
        q = constant_of(substitute(term, self.place))
        require(q is not None and value_of(term, self.balls).is_finite(), "no rational number")
        return q  # type: ignore[return-value]

    def trace(self, body: Any, rows: Any) -> Term:
        return number(sum((body[i, i] for i in range(body.nrows())), fmpq(0)))

    def to_number(self, body: Any) -> Term:
        return number(body[0, 0])

    def add_bodies(self, x: Any, y: Any) -> Any:
        return x + y

    def scale_body(self, factor: Term, x: Any) -> Any:
        return x * self.value_of(factor)

    def multiply_bodies(self, x: Any, y: Any) -> Any:
        return x * y

    def transpose_body(self, x: Any) -> Any:
        return x.transpose()

    def invert_body(self, x: Any, rows: Any) -> Any:
        require(x.det() != 0, "a singular matrix")
        return x.inv()

    def relate(self, x: Any) -> None:
        """A hypothesis holds at the point."""
        zero = x.body == 0 * x.body if isinstance(x, Typed) else self.value_of(x) == 0
        require(zero, "a hypothesis that does not hold")

    def evaluate(self) -> bool:
        """Whether the statement holds at the point."""
        relation, x = self.state()
        require(set(self.matrices) == set(self.statement[4]), "the point gives every matrix")
        for term in self.terms:
            self.value_of(term)
        if isinstance(x, Typed):
            return bool((x.body == 0 * x.body) == (relation == "="))
        sign, own = SIGNS[relation]
        value = sign * self.value_of(x)
        return bool({"=": value == 0, "!=": value != 0, ">": value > 0, ">=": value >= 0}[own])


def make_unit(n: int) -> fmpq_mat:
    return fmpq_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])


def list_minors(x: fmpq_mat, sets: Iterable[Sequence[int]]) -> Iterator[fmpq]:
    """Determinants of rows and columns of the same numbers."""
    for places in sets:
        yield fmpq_mat([[x[i, j] for j in places] for i in places]).det()


def is_definite(x: fmpq_mat) -> bool:
    """Sylvester's criterion: a symmetric matrix is positive definite if its leading minors are positive."""
    leading = [range(k) for k in range(1, x.nrows() + 1)]
    return x == x.transpose() and all(minor > 0 for minor in list_minors(x, leading))


def is_nonnegative(x: fmpq_mat) -> bool:
    """A symmetric matrix is nonnegative if all its principal minors are."""
    n = x.nrows()
    require(n <= MOST_SIZE, "too many rows")
    sets = [[i for i in range(n) if mask >> i & 1] for mask in range(1, 1 << n)]
    return x == x.transpose() and all(minor >= 0 for minor in list_minors(x, sets))


HAS_PROPERTY: dict[str, Callable[[fmpq_mat], bool]] = {
    "symmetric": lambda x: x == x.transpose(),
    "positive": is_definite,
    "nonnegative": is_nonnegative,
    "invertible": lambda x: x.det() != 0,
    "orthogonal": lambda x: x.transpose() * x == make_unit(x.nrows()),
    "skew": lambda x: x.transpose() == -1 * x,
    "diagonal": lambda x: all(x[i, j] == 0 for i in range(x.nrows()) for j in range(x.nrows()) if i != j),
}


def check_words(item: Any) -> None:
    """A relation holds for matrices of all sizes where all of it is defined; the witness is such a point.

    The difference of its sides is equal to the sum of the shares, as sums of words; each share is 0. For >= and > there
    are also c trace(X) and c trace(X Y) with c > 0: X and Y are nonnegative, and trace(X Y) is the trace of Z' X Z with
    Z Z' = Y; it is > 0 where they are positive definite.
    """
    more = " above" if "above" in item else ""
    _, statement, witness, shares, *rest = read_fields(item, f"kind statement witness shares{more}")
    require(Sized(statement, witness).evaluate(), "the statement may have no value at the witness")
    algebra = Words(statement)
    relation, x = algebra.state()
    (sign, own), strict = SIGNS[relation], False
    require(own == "=" or (rest and own != "!="), "a relation that sums of words do not prove")
    x = x if isinstance(x, Typed) else Typed(1, 1, {(): x})
    pairs = [(word, multiply_numbers(number(-sign), c)) for word, c in x.body.items()]
    before = set_union(map(conditions, algebra.terms)), [*algebra.assumed]
    for entry in read_list(rest[0], lambda e: read_fields(e, "coefficient matrices")) if rest else []:
        c, factors = read_number(entry[0]), read_list(entry[1], algebra.read)
        known = [f.known if isinstance(f, Typed) else "" for f in factors]
        is_above = own != "=" and c > 0 and {*known} <= {"positive", "nonnegative"}
        require(is_above and len(known) in (1, 2), "expected one or two nonnegative matrices")
        strict = strict or "nonnegative" not in known
        product = reduce(algebra.multiply, factors)
        pairs.append(((), multiply_numbers(number(c), algebra.trace(product.body, product.rows))))
    require(before == (set_union(map(conditions, algebra.terms)), [*algebra.assumed]), "a part that may have no value")
    require(strict or own != ">", "expected a positive matrix")
    for share in read_list(shares, lambda entry: entry):
        pairs.extend(algebra.expand(share, x))
    require(all(map(is_identity, algebra.gather(pairs).values())), "another sum of words")


def check_sized(item: Any) -> None:
    """A statement on matrices of any size fails at matrices of one size, which have all declared properties."""
    _, statement, point = read_fields(item, "kind statement point")
    require(not Sized(statement, point).evaluate(), "the statement holds there")


def grant(statement: Any, item: Any) -> str:
    """The verdict that a certificate gives a statement: HOLDS or FAILS; raises Refused where it gives none."""
    parts = item["of"] if isinstance(item, dict) and item.get("kind") == "all" else [item]
    statements = statement if isinstance(statement, list) else [statement]
    require(isinstance(parts, list) and all(isinstance(part, dict) for part in parts), "expected certificates")
    own = [part.get("statement") for part in parts]
    refuting = [part for part in parts if part.get("kind") in ("counterexample", "sized") or part.get("outside") == 1]
    kinds = ("proof", "counterexample", "condition", "observability", "words", "sized")
    known = all(part.get("kind") in kinds for part in parts)
    good = own == statements or (len(own) == len(refuting) == 1 and own[0] in statements)
    require(known and good and len(refuting) < 2, "the certificate of another statement")
    check(item)
    return "FAILS" if refuting else "HOLDS"


# -- 11. The entry -----------------------------------------------------------------------------------------------------
EVERY_CHECK: tuple[Callable[[Any], None], ...] = (
    check_identity, check_exponential, check_rank, check_observability, check_condition, check_positivity, check_all,
    check_gap, check_touch, check_exclusion, check_cones, check_design, check_proof, check_counterexample, check_words,
    check_sized,
)  # fmt: skip
KINDS = {check.__name__.removeprefix("check_"): check for check in EVERY_CHECK}
KINDS |= {"sliver": check_gap, "range": check_touch}


def check(item: Any) -> str:
    """The kind of a certificate that proves its statement; else raises Refused."""
    before, ctx.prec, EFFORT[0] = (ctx.prec, ctx.cap), 128, 0
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
