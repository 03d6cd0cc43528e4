"""Trees to the computer algebra system and back: it is a guest that evaluates, and both ways are checked.

``to_sympy`` bounds every step before sympy does it. ``from_sympy`` takes expressions of the language only.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NoReturn

import sympy as sp

from navsym.core.errors import (
    DomainError,
    DuplicateError,
    ExpressionSyntaxError,
    NavsymError,
    NotFiniteError,
    TooLargeError,
    UnknownSymbolError,
)
from navsym.language import arithmetic
from navsym.language.arithmetic import BITS, BUILDERS, Refusal, number_bits
from navsym.language.names import check_name, quote
from navsym.language.tree import (
    HALF,
    MINUS_ONE,
    NUMBER,
    ONE,
    POWER,
    PRODUCT,
    SUM,
    SYMBOL,
    Tree,
    build,
    build_call,
    build_inverse,
    build_number,
    build_power,
    build_product,
    build_sum,
    list_parts,
    parts_of,
)

NAMES: dict[type, str] = {builder: name for name, builder in BUILDERS.items() if isinstance(builder, type)}

ROOT_TOTAL = 3_000  # bits of all numbers under roots in one expression


# -- to sympy -------------------------------------------------------------------------


def to_sympy(tree: Tree, symbols: Mapping[str, sp.Symbol]) -> sp.Expr:
    """The expression of sympy that the tree means, evaluated as sympy does, every step bounded before it is done.

    symbols : declared name -> symbol

    Raises UnknownSymbolError, DomainError (division by zero, a value that is not real) or TooLargeError.

    >>> from navsym.language.expression import read_tree
    >>> to_sympy(read_tree("x + x", {"x"}), {"x": sp.Symbol("x")})
    2*x
    """

    def refuse_part(part: Tree, refusal: Refusal) -> NoReturn:
        raise refusal.error(f"expected {refusal.expected}; got {refusal.got}; {refusal.remedy}")

    return evaluate(tree, symbols, refuse_part)[tree]


def evaluate(
    tree: Tree, symbols: Mapping[str, sp.Symbol], refuse_part: Callable[[Tree, Refusal], NoReturn]
) -> dict[Tree, sp.Expr]:
    """The values of all parts; ``refuse_part`` raises the error for a part that has none."""
    values: dict[Tree, sp.Expr] = {}
    roots = 0
    for part in list_parts(tree):
        inner = [values[argument] for argument in parts_of(part)]
        try:
            is_root = part.head == "sqrt" or (part.head == POWER and inner[1].is_integer is not True)
            roots += number_bits(inner[0]) if is_root else 0  # the algebra factors these, again in every product
            if roots > ROOT_TOTAL:
                got = f"more, with {roots} bits"
                raise Refusal(TooLargeError, f"at most {ROOT_TOTAL} bits under roots", got, "split the expression")
            values[part] = evaluate_part(part, inner, symbols)
        except Refusal as refusal:
            refuse_part(part, refusal)
        except (NavsymError, RecursionError, MemoryError):
            raise
        except Exception as failure:  # sympy's own evaluation gave up on an exotic constant
            got = f"one on which the algebra stops ({type(failure).__name__})"
            refuse_part(part, Refusal(DomainError, "a value that exists exactly", got, "simplify it"))
    return values


def evaluate_part(part: Tree, inner: list[sp.Expr], symbols: Mapping[str, sp.Symbol]) -> sp.Expr:
    """The value of a part from those of its own parts."""
    if part.head == NUMBER:
        return arithmetic.require_real(sp.Rational(*part.args[0].as_integer_ratio()))
    if part.head == SYMBOL:
        if part.args[0] not in symbols:
            raise UnknownSymbolError(f"expected a declared name; got {quote(part.args[0])}; declare it")
        return symbols[part.args[0]]
    if part.head == "pi":
        return sp.pi
    if part.head == SUM:
        return arithmetic.add_exactly(inner)
    if part.head == PRODUCT:
        return arithmetic.multiply_exactly(inner)
    if part.head == POWER:
        return arithmetic.invert_exactly(inner[0]) if part.args[1] is MINUS_ONE else arithmetic.raise_exactly(*inner)
    if part.head not in BUILDERS:
        raise Refusal(ExpressionSyntaxError, "a function of the language", quote(part.head), "rewrite the formula")
    return arithmetic.call_function(part.head, inner)


def evaluate_freely(tree: Tree, values: dict[Tree, sp.Expr]) -> sp.Expr:
    """The value of a tree that adds a step or two to parts with values, without bounds; ``values`` takes it up."""
    steps = {SUM: sp.Add, PRODUCT: sp.Mul, POWER: sp.Pow, **BUILDERS}
    for part in list_parts(tree):
        if part not in values:
            value = sp.Rational(*part.args[0].as_integer_ratio()) if part.head == NUMBER else None
            values[part] = value if value is not None else steps[part.head](*(values[inner] for inner in part.args))
    return values[tree]


#: What is left to be done, and its name in the language.
BINDERS: dict[type[Any], str] = {
    sp.Sum: "sum",
    sp.Product: "product",
    sp.Integral: "integral",
    sp.Limit: "limit",
    sp.Derivative: "diff",
}


# -- from sympy ---------------------------------------------------------------------


def from_sympy(expression: Any, calculus: bool = False) -> Tree:
    """The tree that shows an expression of sympy in the usual order, with divisors below one line.

    Sums, products, integrals, limits and derivatives that are left to be done are calls where ``calculus`` is allowed.

    Raises ExpressionSyntaxError for a class that the language does not have, by its name; DomainError for floats,
    with their exact spelling; DuplicateError for two symbols of one name; TooLargeError for numbers above 4,000 digits.

    >>> x = sp.Symbol("x")
    >>> from_sympy(sp.sqrt(x) * 3 / (4 * x**2))
    <3/(4*x**(3/2))>
    """
    try:
        expression = sp.sympify(expression, strict=True)
    except (sp.SympifyError, TypeError):
        refuse(expression)
    require_one_symbol_per_name(expression)
    if not calculus and (found := sorted(expression.atoms(*BINDERS), key=str)):
        refuse(found[0])
    trees: dict[Any, Tree] = {}
    parts: dict[Any, list[sp.Basic]] = {}
    waiting = [expression]
    while waiting:
        e = waiting[-1]
        if e not in parts:
            parts[e] = shown_parts(e)
            waiting.extend(part for part in reversed(parts[e]) if part not in trees)
        else:
            trees[e] = trees.get(e) or show(e, parts[e], trees)
            waiting.pop()
    return trees[expression]


def refuse(part: object) -> NoReturn:
    """Raise the error for what the language does not have."""
    if isinstance(part, sp.Float):
        raise float_error(float(part), "")
    kind = type(part).__name__
    text = quote(str(part)) if not isinstance(part, str) else quote(part)
    expected = "numbers, names, + - * / **, pi and the functions of the language"
    raise ExpressionSyntaxError(f"expected {expected}; got {kind} {text}; rewrite it exactly in these terms")


def float_error(value: float, where: str) -> NavsymError:
    """The error for a float where an exact number is meant, with the exact spelling of its shortest decimal."""
    if value != value or value in (float("inf"), float("-inf")):
        return NotFiniteError(f"expected an exact number; got {value}; write a finite one", where=where)
    exact = Fraction(repr(value))
    spelling = f'"{exact}"' if exact.denominator == 1 else f'"{exact}" or "{value!r}"'
    return DomainError(f"expected an exact number; got the float {value!r}; write {spelling} as text", where=where)


def require_one_symbol_per_name(expression: sp.Basic) -> None:
    """Refuse two symbols of one name: in print they are the same, and for the algebra they are not."""
    known: dict[str, sp.Symbol] = {}
    for symbol in expression.atoms(sp.Symbol):
        if known.setdefault(symbol.name, symbol) != symbol:
            first, second = sorted((sp.srepr(symbol), sp.srepr(known[symbol.name])))
            message = f"expected one symbol of each name; got {first} and {second}; use one of them"
            raise DuplicateError(message)


def shown_parts(e: sp.Basic) -> list[sp.Basic]:
    """The expressions whose trees an expression is built of."""
    if isinstance(e, sp.Add):
        return list(e.as_ordered_terms())
    if isinstance(e, sp.Mul):
        return [factor.base if has_minus(factor) else factor for factor in split_coefficient(e)[1]]
    if isinstance(e, sp.Pow):
        return [e.base] if e.exp.is_Rational else [e.base, e.exp]
    if type(e) in BINDERS:
        return [e.args[0], *(part for limits in list_limits(e) for part in limits if not part.is_infinite)]
    return list(e.args) if isinstance(e, sp.Function) else []


def list_limits(e: sp.Basic) -> list[tuple[sp.Basic, ...]]:
    """The variables of a sum, an integral, a limit or a derivative, each with its ends or its point."""
    if isinstance(e, sp.Limit):
        if str(e.args[3]) != "+-" and not e.args[2].is_infinite:
            message = f'expected a limit from both sides; got {quote(str(e))}; write dir="+-"'
            raise ExpressionSyntaxError(message)
        return [tuple(e.args[1:3])]
    if isinstance(e, sp.Derivative):
        return [(x,) for x, count in e.variable_count for _ in range(int(count))]
    if any(len(limits) != 3 for limits in e.limits):
        message = f"expected both ends of each variable; got {quote(str(e))}; write them, as in (x, 0, 1)"
        raise ExpressionSyntaxError(message)
    return [tuple(limits) for limits in e.limits]


def show_end(end: sp.Basic, trees: Mapping[Any, Tree]) -> Tree:
    """A variable, an end or a point, which may lie at infinity."""
    if not end.is_infinite:
        return trees[end]
    infinite = build(SYMBOL, ("oo",))
    return infinite if end is sp.oo else build_product(MINUS_ONE, infinite)


def show(e: sp.Basic, parts: list[sp.Basic], trees: Mapping[Any, Tree]) -> Tree:
    """The tree of an expression from those of its parts."""
    if isinstance(e, sp.Rational):
        return show_number(e)
    if e is sp.pi:
        return build_call("pi")
    if e is sp.E:
        return build_call("exp", ONE)
    if isinstance(e, sp.Symbol):
        return build(SYMBOL, (check_name(e.name),))
    if isinstance(e, sp.Add):
        return build_sum(*(trees[term] for term in parts))
    if isinstance(e, sp.Mul):
        return show_product(e, trees)
    if isinstance(e, sp.Pow):
        return show_power(e, e.exp, trees)
    if type(e) in BINDERS:
        tree = trees[e.args[0]]
        for limits in list_limits(e):
            tree = build_call(BINDERS[type(e)], tree, *(show_end(part, trees) for part in limits))
        return tree
    name = NAMES.get(type(e))
    if name is None or len(e.args) != (2 if name == "atan2" else 1):
        refuse(e)
    return build_call(name, *(trees[part] for part in e.args))


def show_number(value: sp.Rational) -> Tree:
    """A number that is not too long to be written."""
    if number_bits(value) > BITS:
        raise TooLargeError(f"expected numbers of at most {BITS} bits; got a larger one; rescale")
    return build_number(Fraction(int(value.p), int(value.q)))


def split_coefficient(e: sp.Mul) -> tuple[sp.Rational, tuple[sp.Basic, ...]]:
    """The rational coefficient of a product and its other factors."""
    coefficient, rest = e.as_coeff_Mul()
    if not isinstance(coefficient, sp.Rational):
        refuse(coefficient)
    return coefficient, sp.Mul.make_args(rest)


def has_minus(factor: sp.Basic) -> bool:
    """True for a power that stands below the line of a quotient."""
    return isinstance(factor, sp.Pow) and bool(factor.exp.is_Rational and factor.exp < 0)


def show_product(e: sp.Mul, trees: Mapping[Any, Tree]) -> Tree:
    """Factors above and below one line; with a sum below, one divisor after another: reading would multiply it out."""
    coefficient, factors = split_coefficient(e)
    above = [trees[factor] for factor in factors if not has_minus(factor)]
    below = [show_power(factor, -factor.exp, trees) for factor in factors if has_minus(factor)]
    if coefficient.q != 1:
        below.insert(0, build_number(int(coefficient.q)))
    bare = not above
    if bare or abs(coefficient.p) != 1:
        above.insert(0, build_number(int(coefficient.p)))
    elif coefficient < 0:
        above.insert(0, MINUS_ONE)
    if any(divisor.head == SUM for divisor in below):
        if bare and coefficient.q != 1:  # 1/2 at the head of a product is one number
            above, below = [show_number(coefficient)], below[1:]
        divisors = [build_inverse(divisor) for divisor in below]
    else:
        divisors = [build_inverse(build_product(*below))] if below else []
    return build_product(*(above[1:] if above == [ONE] else above), *divisors)


def show_power(e: sp.Pow, exponent: sp.Expr, trees: Mapping[Any, Tree]) -> Tree:
    """A power of the base of ``e``; square roots by name, negative exponents as quotients."""
    base = trees[e.base]
    if exponent == 1:
        return base
    if not exponent.is_Rational:
        return build_power(base, trees[exponent])
    if exponent < 0:
        return build_inverse(show_power(e, -exponent, trees))
    power = show_number(exponent)
    return build_call("sqrt", base) if power is HALF else build_power(base, power)
