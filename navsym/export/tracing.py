"""The operations of a Python function, in the order in which it does them: it is called with a number that takes notes.

What a function does with this number is what it does with a double, unless it asks for a value: a comparison, a
conversion or a table end the trace. Functions of ``math`` are noted by giving the function's own names of them another
meaning during this one call; those of numpy and the operators come by themselves.
"""

from __future__ import annotations

import math
import types
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from numbers import Integral
from typing import Any, NoReturn

import sympy as sp

from navsym.export.expression_graph import Graph, Node

MOST_NODES = 2_000
MOST_POWER = 16
PRODUCTS = 8  # roundings of which each product has one; so many cover a pow within four ulps
LONGEST = 20_000  # characters of the formula that was traced

#: numpy's names of operations, where they are not our own.
UFUNCS = {"subtract": "sub", "multiply": "mul", "divide": "div", "true_divide": "div", "negative": "neg"}
UFUNCS |= {"absolute": "abs", "fabs": "abs", "maximum": "max", "minimum": "min"}
UFUNCS |= dict.fromkeys(("power", "square", "float_power"), "pow")
UFUNCS |= {f"arc{name}": f"a{name}" for name in ("sin", "cos", "tan", "tan2")}
#: casadi's names of operations, where they are not ours in capitals.
CASADI = {"FABS": "abs", "CONSTPOW": "pow", "FMAX": "max", "FMIN": "min"}
CASADI |= {name.upper(): name for name in "add sub mul div neg sqrt hypot pow atan2 expm1".split()}
CASADI |= {name.upper(): name for name in "sin cos tan exp log asin acos atan sinh cosh tanh".split()}
#: Functions that multiply by one double.
SCALES = {"radians": sp.pi / 180, "deg2rad": sp.pi / 180, "degrees": 180 / sp.pi, "rad2deg": 180 / sp.pi}
UNARY = frozenset("neg abs sqrt sin cos tan exp log expm1 asin acos atan sinh cosh tanh".split())
BINARY = frozenset("add sub mul div pow atan2 max min".split())
SIGNS = {"add": "({} + {})", "sub": "({} - {})", "mul": "({}*{})", "div": "({}/{})", "pow": "({}**{})", "neg": "(-{})"}
SIGNS |= {"expm1": "(exp({}) - 1)"}
SIGNS |= {"max": "(({0} + {1} + abs({0} - {1}))/2)", "min": "(({0} + {1} - abs({0} - {1}))/2)"}


class UntraceableError(Exception):
    """What a function does that is no operation on numbers."""


@dataclass(slots=True)
class Notes:
    """The operations so far."""

    nodes: list[Node] = field(default_factory=list)
    literals: list[float | None] = field(default_factory=list)
    refused: str = ""

    def refuse(self, why: str) -> NoReturn:
        """End the trace for this reason, also where the function catches the error."""
        self.refused = why
        raise UntraceableError(why)

    def put(self, op: str, args: Sequence[Any] = (), value: Any = None, literal: float | None = None) -> Traced:
        """Note an operation; raises UntraceableError above the most of them."""
        places = tuple(self.wrap(a).place for a in args)
        if len(self.nodes) >= MOST_NODES:
            self.refuse(f"more than {MOST_NODES} operations")
        self.nodes.append(Node(op, places, value))
        self.literals.append(literal)
        return Traced(self, len(self.nodes) - 1)

    def wrap(self, value: Any) -> Traced:
        """A number as an operation: a double stands for the shortest decimal that rounds to it, or a part of pi."""
        if type(value) is Traced:
            return value
        if isinstance(value, bool) or not isinstance(value, (float, Integral, Fraction)) or not math.isfinite(value):
            self.refuse(f"an operand that is no double: {type(value).__name__}")
        if isinstance(value, (Integral, Fraction)):
            exact = Fraction(value)
        elif share := share_of_pi(float(value)):
            return self.put("const", value=sp.Rational(*share) * sp.pi, literal=float(value))
        else:
            exact = Fraction(repr(float(value)))
        return self.put("const", value=sp.Rational(exact.numerator, exact.denominator), literal=float(value))

    def apply(self, op: str, args: Sequence[Any]) -> Traced:
        """One operation on numbers of which one at least is traced; raises UntraceableError for what is none."""
        n = args[1] if op == "pow" and type(args[1]) is not Traced else None
        if isinstance(n, (float, int)) and float(n).is_integer():
            return self.power(self.wrap(args[0]), int(n))
        if op == "hypot" and args:
            return self.length([self.wrap(a) for a in args])
        if op in SCALES and len(args) == 1:
            scale = SCALES[op]
            return self.put("mul", (args[0], self.put("const", value=scale, literal=float(scale))))
        if len(args) != (1 if op in UNARY else 2) or op not in UNARY | BINARY:
            self.refuse(f"the function {op} of {len(args)} arguments")
        return self.put(op, args)

    def power(self, base: Traced, n: int) -> Traced:
        """A whole power as products; products with 1 make the bound cover a library's pow, see ``PRODUCTS``."""
        if abs(n) > MOST_POWER:
            self.refuse(f"a power of {n}")
        found: Any = 1.0
        for k in range(max(PRODUCTS, abs(n))):
            found = self.put("mul", (found, base if k < abs(n) else 1.0))
        return self.put("div", (1.0, found)) if n < 0 else self.wrap(found)

    def length(self, parts: Sequence[Traced]) -> Traced:
        """The root of a sum of squares; as in :meth:`power`, products with 1 cover what a library's own may err."""
        total = self.put("mul", (parts[0], parts[0]))
        for part in parts[1:]:
            total = self.put("add", (total, self.put("mul", (part, part))))
        found = self.put("sqrt", (total,))
        for _ in range(PRODUCTS):
            found = self.put("mul", (found, 1.0))
        return found


def share_of_pi(value: float) -> tuple[int, int] | None:
    """n and d where a double is what ``n*pi/d`` comes to, or a neighbour of it; None for another one.

    What a double stands for is free to choose: its distance from the exact number is part of the bound.
    """
    for d in (1, 2, 3, 4, 6, 8, 12, 180):
        n = round(value * d / math.pi)
        if 0 < abs(n) <= 360 and abs(value - n * math.pi / d) <= 2 * math.ulp(value):
            return n, d
    return None


Operator = Callable[["Traced", Any], "Traced"]


def noted_operator(op: str) -> tuple[Operator, Operator]:
    """The methods of an operator: with the traced number on its left, and on its right."""
    return (
        lambda traced, other: traced.notes.apply(op, (traced, other)),
        lambda traced, other: traced.notes.apply(op, (other, traced)),
    )


def refuses(why: str) -> Any:
    """The method that ends a trace for this reason."""
    return lambda traced, *_: traced.notes.refuse(why)


class Traced:
    """A number that notes what is done with it."""

    __slots__ = ("notes", "place")

    def __init__(self, notes: Notes, place: int) -> None:
        self.notes, self.place = notes, place

    __add__, __radd__ = noted_operator("add")
    __sub__, __rsub__ = noted_operator("sub")
    __mul__, __rmul__ = noted_operator("mul")
    __truediv__, __rtruediv__ = noted_operator("div")
    __pow__, __rpow__ = noted_operator("pow")

    def __neg__(self) -> Traced:
        return self.notes.apply("neg", (self,))

    def __abs__(self) -> Traced:
        return self.notes.apply("abs", (self,))

    def __pos__(self) -> Traced:
        return self

    def __array_ufunc__(self, ufunc: Any, method: str, *args: Any, **named: Any) -> Traced:
        """A function of numpy."""
        name = str(ufunc.__name__)
        if method != "__call__" or named:
            self.notes.refuse(f"numpy's {name} with options")
        return self.notes.apply(UFUNCS.get(name, name), (*args, 2) if name == "square" else args)

    def __getattr__(self, name: str) -> Any:
        """What a double has and this number has not ends the trace."""
        if hasattr(float, name):
            self.notes.refuse(f"a double's {name}")
        raise AttributeError(name)

    __class__ = property(lambda self: float)  # type: ignore[assignment]  # for isinstance it is a double
    __bool__ = refuses("a branch")
    __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = refuses("a comparison")
    __float__ = __int__ = __index__ = __complex__ = __round__ = __floor__ = __ceil__ = __trunc__ = __hash__ = refuses(
        "a conversion to another number"
    )
    __str__ = __repr__ = __format__ = refuses("a conversion to text")
    __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = __divmod__ = __rdivmod__ = refuses("a division with rest")


def trace(function: Callable[..., Any], names: Sequence[str], by_name: bool) -> tuple[Graph, list[float | None]]:
    """The operations of a function of these arguments, and the number in the code for each constant.

    by_name : call it with keywords
    Raises UntraceableError for what is more than operations on numbers.
    """
    notes = Notes()
    given = {name: notes.put("input", value=k) for k, name in enumerate(names)}
    try:
        if type(function).__module__.startswith("casadi"):
            answer = replay_casadi(function, notes, [*given.values()])
        else:
            noted = with_noted_math(function, {})
            answer = noted(**given) if by_name else noted(*given.values())
        root = notes.wrap(answer).place
    except Exception as error:  # whatever a function does with what is no double
        words = (str(error).splitlines() or [""])[0]
        raise UntraceableError(notes.refused or f"{type(error).__name__}: {words}"[:200]) from None
    if notes.refused:
        raise UntraceableError(notes.refused)
    graph = Graph(tuple(sp.Symbol(name, real=True) for name in names), tuple(notes.nodes), (root,))
    return graph, notes.literals


def replay_casadi(function: Any, notes: Notes, inputs: Sequence[Traced]) -> Any:
    """The operations of a function of casadi, which it lists; scalars in, one scalar out."""
    import casadi as ca

    codes = {getattr(ca, f"OP_{name}"): op for name, op in CASADI.items()}
    listed = function if function.is_a("SXFunction") else function.expand()
    work: dict[int, Any] = {}
    answer: Any = None
    for k in range(listed.n_instructions()):
        code, places, to = listed.instruction_id(k), listed.instruction_input(k), listed.instruction_output(k)
        if code == ca.OP_INPUT:
            work[to[0]] = inputs[places[0]]
        elif code == ca.OP_CONST:
            work[to[0]] = listed.instruction_constant(k)
        elif code == ca.OP_OUTPUT:
            answer = work[places[0]]
        elif code in (ca.OP_SQ, ca.OP_TWICE, ca.OP_INV):
            x = work[places[0]]
            work[to[0]] = notes.power(notes.wrap(x), 2 if code == ca.OP_SQ else -1) if code != ca.OP_TWICE else 2 * x
        else:
            work[to[0]] = notes.apply(codes.get(code, f"number {code} of casadi"), [work[j] for j in places])
    if listed.nnz_in() != len(inputs) or listed.n_in() != len(inputs) or listed.nnz_out() != 1:
        raise UntraceableError("a function of casadi of vectors")
    return answer


def with_noted_math(function: Any, known: dict[int, Any]) -> Any:
    """The same function, with functions of ``math`` that note what is asked of them; so for those that it calls."""
    if id(function) in known:
        return known[id(function)]
    if function is math:
        return types.SimpleNamespace(**{name: noted_value(value) for name, value in vars(math).items()})
    if not isinstance(function, types.FunctionType):
        return noted_value(function)
    names: dict[str, Any] = dict(function.__globals__)
    closure = tuple(types.CellType(with_noted_math(cell.cell_contents, known)) for cell in function.__closure__ or ())
    new = types.FunctionType(function.__code__, names, function.__name__, function.__defaults__, closure or None)
    new.__kwdefaults__ = function.__kwdefaults__
    known[id(function)] = new
    for name in function.__code__.co_names:
        if name in names:
            names[name] = with_noted_math(names[name], known)
    return new


def noted_value(value: Any) -> Any:
    """A function of ``math`` that notes; anything else as it is."""
    name = getattr(value, "__name__", "")
    if not isinstance(value, types.BuiltinFunctionType) or getattr(math, name, None) is not value:
        return value

    plain: Any = value

    def noted(*args: Any) -> Any:
        traced = next((a for a in args if type(a) is Traced), None)
        return plain(*args) if traced is None else traced.notes.apply(UFUNCS.get(name, name), args)

    return noted


def write_trace(graph: Graph) -> str | None:
    """The formula of the only root in the language of files; None when it is too long to be read."""
    texts: list[str] = []
    for node in graph.nodes:
        args = [texts[a] for a in node.args]
        if node.op == "input":
            texts.append(str(graph.inputs[node.value]))
        elif node.op == "const":
            texts.append(f"({node.value})")
        else:
            texts.append(SIGNS.get(node.op, f"{node.op}({', '.join(['{}'] * len(args))})").format(*args))
        if len(texts[-1]) > LONGEST:
            return None
    return texts[graph.roots[0]]
