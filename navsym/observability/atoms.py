"""Functions in a model as generators of a ring: exponentials, square roots, angles that are products.

Over the rational functions of the symbols these are algebraically independent: exponentials and sines of different
monomials (Ax, Lindemann and Weierstrass), and square roots of radicands no product of which is a square (Kummer).
A polynomial in them is therefore zero exactly where its coefficients are, modulo g^2 = radicand for a root g.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import lcm

import sympy as sp
from flint import fmpz
from sympy.functions.elementary.hyperbolic import HyperbolicFunction
from sympy.functions.elementary.trigonometric import TrigonometricFunction

from navsym.core.errors import DomainError
from navsym.core.rational_functions import factor_exactly
from navsym.models.linear import LinearModel
from navsym.observability.ring import Ring


@dataclass(slots=True, eq=False)
class Atoms:
    """A model in which every function that is no rational one of sines and cosines is a symbol of its own.

    rows    : rows of H, and of further matrices behind
    rates   : symbol -> derivative along the motion, for all that occur and move
    squares : root -> its square
    meaning : symbol -> what it stands for
    """

    F: sp.ImmutableMatrix
    rows: list[list[sp.Expr]]
    rates: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    squares: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    meaning: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)

    @classmethod
    def of(cls, model: LinearModel, others: Sequence[sp.MatrixBase] = ()) -> Atoms:
        """Read a model; rates are followed from symbol to symbol.

        Raises DomainError for other functions, and for roots that depend on each other.
        """
        rows = [list(matrix[k, :]) for matrix in (model.H, *others) for k in range(matrix.rows)]
        given = {model.time: sp.Integer(1)} | {s: sp.sympify(rate, strict=True) for s, rate in model.rates.items()}
        entries = [*model.F, *(entry for row in rows for entry in row), *given.values()]
        names = Names(given, shortest_exponents(entries))
        atoms = cls(model.F.applyfunc(names.read), [[names.read(entry) for entry in row] for row in rows])
        pending = set().union(*(entry.free_symbols for entry in (*atoms.F, *(e for row in atoms.rows for e in row))))
        pending |= set(model.squares)
        while pending:
            symbol = pending.pop()
            rate = names.read(names.rate(symbol))
            if rate != 0 and symbol not in atoms.rates:
                atoms.rates[symbol] = rate
                pending |= rate.free_symbols - atoms.rates.keys()
        atoms.squares, atoms.meaning = {**model.squares, **names.squares}, names.meaning
        need_independent(atoms.squares)
        return atoms


@dataclass(slots=True, eq=False)
class Names:
    """Symbols for functions, each given once; parts: monomial -> k such that exp(monomial/k) is the generator."""

    given: Mapping[sp.Symbol, sp.Expr]
    parts: Mapping[sp.Expr, int]
    meaning: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    squares: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    symbols: dict[tuple[str, sp.Expr], sp.Symbol] = field(default_factory=dict)

    def named(self, kind: str, value: sp.Expr) -> sp.Symbol:
        """The symbol of a function; its name is the text of what it stands for."""
        if (kind, value) not in self.symbols:
            text = sp.exp(value) if kind == "exp" else value
            made = sp.Dummy(f"{text}", real=True)
            self.symbols[kind, value], self.meaning[made] = made, text
        return self.symbols[kind, value]

    def read(self, value: sp.Expr) -> sp.Expr:
        """The expression with its functions replaced."""
        if not value.args:
            return value
        if isinstance(value, HyperbolicFunction):
            return self.read(value.rewrite(sp.exp))
        if isinstance(value, TrigonometricFunction):
            return value.func(sp.Add(*(self.read_angle(term) for term in terms_of(value.args[0]))))
        if isinstance(value, sp.exp):
            return sp.Mul(*(self.read_exponent(term) for term in terms_of(value.args[0])))
        if isinstance(value, sp.Pow) and value.exp.is_Rational and value.exp.q == 2:
            return self.read_root(value.base) ** value.exp.p
        return value.func(*(self.read(part) for part in value.args))

    def read_angle(self, term: sp.Expr) -> sp.Expr:
        """A rational multiple of a symbol or of pi as it is; another monomial as a symbol of its own."""
        share, rest = term.as_coeff_Mul()
        if not share.is_Rational or rest == sp.pi or isinstance(rest, sp.Symbol):
            return term
        return share * self.named("angle", monomial(rest))

    def read_exponent(self, term: sp.Expr) -> sp.Expr:
        """exp of a rational multiple of a monomial as a power of a generator."""
        share, rest = term.as_coeff_Mul()
        parts = self.parts[monomial(rest)]
        return self.named("exp", rest / parts) ** int(share * parts)

    def read_root(self, base: sp.Expr) -> sp.Expr:
        """sqrt(a/b) as sqrt(a b)/b; the sign of b does not matter to a rank."""
        top, bottom = sp.fraction(sp.together(base))
        inside = sp.expand(top * bottom)
        if any(not part.is_Symbol and not part.is_Rational for part in atoms_of(inside)):
            raise DomainError(
                f"expected a square root of a polynomial; got sqrt of {str(base)[:60]}; name it as a state or parameter"
            )
        root = self.named("root", sp.sqrt(inside))
        self.squares[root] = inside
        return root / bottom

    def rate(self, symbol: sp.Symbol) -> sp.Expr:
        """Derivative along the motion of a symbol or of what it stands for."""
        value = self.meaning.get(symbol)
        if value is None:
            return self.given.get(symbol, sp.Integer(0))
        return sp.Add(*(sp.diff(value, s) * self.given.get(s, 0) for s in value.free_symbols))


def terms_of(argument: sp.Expr) -> tuple[sp.Expr, ...]:
    """Terms of an expanded argument."""
    return tuple(term for term in sp.Add.make_args(sp.expand(argument)) if term != 0)


def monomial(rest: sp.Expr) -> sp.Expr:
    """A product of rational powers of symbols and numbers; DomainError for anything else."""
    for part in sp.Mul.make_args(rest):
        base, power = part.as_base_exp()
        if not (power.is_Rational and (base.is_Symbol or base.is_Rational)) or base == sp.pi:
            got = str(rest)[:60]
            raise DomainError(f"expected angles and exponents that are polynomials; got {got}; name it as a parameter")
    return rest


def atoms_of(expression: sp.Expr) -> Iterator[sp.Basic]:
    """Leaves of a polynomial; what is no sum, product or whole power is a leaf."""
    whole_power = isinstance(expression, sp.Pow) and expression.exp.is_Integer
    if isinstance(expression, sp.Add | sp.Mul) or whole_power:
        for part in expression.args:
            yield from atoms_of(part)
    else:
        yield expression


def shortest_exponents(entries: Iterable[sp.Expr]) -> dict[sp.Expr, int]:
    """Monomial -> common denominator of its multiples under all exponentials."""
    parts: dict[sp.Expr, int] = {}
    for entry in entries:
        whole = entry.rewrite(sp.exp) if entry.has(HyperbolicFunction) else entry
        for function in whole.atoms(sp.exp):
            for term in terms_of(function.args[0]):
                share, rest = term.as_coeff_Mul()
                parts[monomial(rest)] = lcm(parts.get(rest, 1), int(share.q))
    return parts


def need_independent(squares: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse roots of which a product is rational: sqrt(2 x), sqrt(3 x), sqrt(6); the point would lie on a branch."""
    ring = Ring.of([*squares.values()])
    pivots: dict[str, set[str]] = {}  # which factors stand in an odd power: linear algebra over two elements
    for root, square in squares.items():
        if square.free_symbols & squares.keys():
            raise DomainError(f"expected roots that are not nested; got {root.name}; name the inner one as a state")
        number, factors = factor_exactly(ring.quotient(square).top)
        vector = {f"{base}" for base, power in factors if power % 2} | ({"-1"} if number < 0 else set())
        vector |= {str(p) for p, power in fmpz(abs(int(number))).factor() if int(power) % 2}
        while vector and max(vector) in pivots:
            vector = vector ^ pivots[max(vector)]
        if not vector:
            raise DomainError(
                f"expected independent square roots; got {root.name}, a product of the others; simplify it"
            )
        pivots[max(vector)] = vector
