"""Expressions that do not evaluate: a tree holds what was written, and nothing is computed while it is built.

A part is made once for each way of writing it, so that equality is identity. ``1/(0*x)``, ``0**0`` and ``log(0)`` can
be built; whoever evaluates a tree asks where it is defined. Declarations of symbols are kept outside, by name. Normal
forms are functions of other files.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from threading import RLock
from typing import Any, NoReturn, TypeVar
from weakref import ref

from navsym.core.errors import ExpressionSyntaxError, ShapeError
from navsym.language.names import FUNCTIONS, NAME, quote

T = TypeVar("T")

NUMBER, SYMBOL, SUM, PRODUCT, POWER = "number", "symbol", "+", "*", "**"

#: Number of arguments of the functions of the language, and of pi.
ARITY = {"pi": 0, **dict.fromkeys(FUNCTIONS, 1), "atan2": 2}


class Tree:
    """An expression as it was written, made by the functions ``build_…``.

    head : ``number``, ``symbol``, ``+``, ``*``, ``**``, or the name of what is called: ``pi``, ``sin``, ``atan2``
    args : the parts in their order; a Fraction for a number, a name for a symbol

    >>> x = build_symbol("x")
    >>> build_sum(x, x) is build_sum(x, x), build_sum(x, x).args[0] is x
    (True, True)
    """

    __slots__ = ("__weakref__", "args", "head")

    head: str
    args: tuple[Any, ...]

    def __new__(cls, *_: Any) -> Tree:
        """Refuse: two trees of one writing would not be the same."""
        raise TypeError("expected a call of build_sum and the like; got Tree(...); use these functions")

    def __setattr__(self, name: str, value: Any) -> NoReturn:
        raise AttributeError(f"expected no change of a tree; got a new {name}; build another one")

    def __copy__(self) -> Tree:
        return self

    def __deepcopy__(self, _: Any) -> Tree:
        return self

    def __reduce__(self) -> tuple[Callable[..., Tree], tuple[Any, ...]]:
        parts = list_parts(self)
        place = {part: at for at, part in enumerate(parts)}
        steps = [(p.head, tuple(place[i] for i in parts_of(p)) if parts_of(p) else p.args) for p in parts]
        return rebuild, (steps,)

    def __repr__(self) -> str:
        from navsym.language.printer import print_tree

        return f"<{print_tree(self)}>"


class Entry(ref):  # type: ignore[type-arg]
    """A weak reference to a part, with its key in the table."""

    __slots__ = ("key",)

    key: tuple[Any, ...]


#: Every part that something holds, by head and arguments.
TABLE: dict[tuple[Any, ...], Entry] = {}
LOCK = RLock()
make_empty = object.__new__
write_head, write_args = Tree.__dict__["head"].__set__, Tree.__dict__["args"].__set__


def forget(entry: Entry) -> None:
    """Remove a part that nothing holds any more, unless it has been made again."""
    with LOCK:
        if TABLE.get(entry.key) is entry:
            del TABLE[entry.key]


def build(head: str, args: tuple[Any, ...], key: tuple[Any, ...] = ()) -> Tree:
    """The part of this head and these arguments; the functions below check both, and give a quicker key for numbers."""
    where = (head, key or args)
    entry = TABLE.get(where)
    node: Tree | None = entry() if entry is not None else None
    if node is not None:
        return node
    with LOCK:
        entry = TABLE.get(where)
        node = entry() if entry is not None else None
        if node is None:
            node = make_empty(Tree)
            write_head(node, head)
            write_args(node, args)
            entry = TABLE[where] = Entry(node, forget)
            entry.key = where
        return node


def build_number(value: int | Fraction | str) -> Tree:
    """An exact number, also from a decimal: ``"0.1"`` is 1/10."""
    if isinstance(value, float):
        raise ExpressionSyntaxError(f"expected an exact number; got the float {value!r}; write it as text")
    number = Fraction(value)
    return build(NUMBER, (number,), (number.numerator, number.denominator))


def build_symbol(name: str) -> Tree:
    """A symbol of this name."""
    if not NAME.fullmatch(name):
        raise ExpressionSyntaxError(f"expected a name of ASCII letters and digits; got {quote(name)}; rename it")
    return build(SYMBOL, (name,))


def build_sum(*terms: Tree) -> Tree:
    """Terms with plus signs between them; one term alone is itself, none is 0."""
    return build(SUM, terms) if len(terms) > 1 else terms[0] if terms else ZERO


def build_product(*factors: Tree) -> Tree:
    """Factors with product signs between them; one factor alone is itself, none is 1."""
    return build(PRODUCT, factors) if len(factors) > 1 else factors[0] if factors else ONE


def build_power(base: Tree, exponent: Tree) -> Tree:
    """``base**exponent``."""
    return build(POWER, (base, exponent))


def build_inverse(divisor: Tree) -> Tree:
    """``1/divisor``, which is the power with exponent -1."""
    return build(POWER, (divisor, MINUS_ONE))


def build_call(name: str, *arguments: Tree) -> Tree:
    """A function at its arguments, of the language or of another name; ``pi`` has no arguments.

    Raises ShapeError for a wrong number of arguments, ExpressionSyntaxError for a name that cannot be called.
    """
    wanted = ARITY.get(name, len(arguments))
    if wanted != len(arguments):
        raise ShapeError(f"expected {wanted} arguments of {name}; got {len(arguments)}; correct the call")
    if name in (NUMBER, SYMBOL) or not re.fullmatch(NAME, name):
        raise ExpressionSyntaxError(f"expected the name of a function; got {quote(name)}; rename it")
    return build(name, arguments)


ZERO, ONE, MINUS_ONE, TWO, HALF = (build_number(n) for n in ("0", "1", "-1", "2", "1/2"))
PI = build_call("pi")


def negate(tree: Tree) -> Tree:
    """The tree with a minus before it."""
    return build(PRODUCT, (MINUS_ONE, tree))


def parts_of(tree: Tree) -> tuple[Tree, ...]:
    """The arguments that are trees; none for numbers and symbols."""
    return () if tree.head in (NUMBER, SYMBOL) else tree.args


def list_parts(*trees: Tree) -> list[Tree]:
    """Every distinct part once, behind its own parts, in the order of writing; the trees themselves come too.

    >>> from navsym.language.expression import read_tree
    >>> list_parts(read_tree("2*x + sin(2*x)", {"x"}))
    [<2>, <x>, <2*x>, <sin(2*x)>, <2*x + sin(2*x)>]
    """
    done: dict[Tree, None] = {}
    waiting = list(reversed(trees))
    while waiting:
        node = waiting[-1]
        missing = [part for part in parts_of(node) if part not in done] if node not in done else []
        if missing:
            waiting.extend(reversed(missing))
        else:
            done[waiting.pop()] = None
    return list(done)


def fold_tree(tree: Tree, step: Callable[[Tree, list[T]], T]) -> T:
    """The value of the tree when ``step(part, values of its parts)`` gives the value of a part."""
    values: dict[Tree, T] = {}
    for part in list_parts(tree):
        values[part] = step(part, [values[inner] for inner in parts_of(part)])
    return values[tree]


def replace(tree: Tree, by: Mapping[Tree, Tree]) -> Tree:
    """The tree with other trees in place of some of its parts, all at once; nothing is simplified.

    >>> x, y = build_symbol("x"), build_symbol("y")
    >>> replace(build_sum(x, y), {x: y, y: x}), replace(build_inverse(x), {x: ZERO})
    (<y + x>, <1/0>)
    """

    def step(part: Tree, inner: list[Tree]) -> Tree:
        return by[part] if part in by else build(part.head, tuple(inner)) if inner else part

    return fold_tree(tree, step)


def list_names(*trees: Tree) -> list[str]:
    """Names of the symbols, each once, in the order of writing."""
    return [part.args[0] for part in list_parts(*trees) if part.head == SYMBOL]


def rebuild(steps: Iterable[tuple[str, tuple[Any, ...]]]) -> Tree:
    """The tree of a pickle: head and arguments of each part, which stand for parts by their places in the list."""
    parts: list[Tree] = []
    for head, args in steps:
        leaf = build_number(*args) if head == NUMBER else build(head, args) if head == SYMBOL else None
        parts.append(leaf or build(head, tuple(parts[at] for at in args)))
    return parts[-1]
