"""Eight doubles as one value inside compiled loops.

The loop vectoriser gives up on the short, many-array loops of a bank of filters, so the bank is written with
a value of eight lanes, one hypothesis in each. The compiler maps it to whatever
vectors the machine has. Lanes know ``+ - * /``, :func:`load_lanes`, :func:`store_lanes` and :func:`spread_lanes`;
products and sums may be fused, so results agree with scalar code to rounding and not bit by bit.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

WIDTH = 8
VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
FUSED = ("contract",)


class Lanes(types.Type):
    """The type of eight doubles."""

    def __init__(self) -> None:
        super().__init__(name="Lanes8")


LANES = Lanes()


@register_model(Lanes)
class LanesModel(models.PrimitiveModel):
    """Lanes live in a vector register."""

    def __init__(self, manager: Any, declared: Any) -> None:
        super().__init__(manager, declared, VECTOR)


def teach_operation(symbol: Callable[..., Any], emit: Callable[[Any, Any, Any], Any]) -> None:
    """Teach the compiler one operation between lanes."""

    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            fits = len(args) == 2 and all(isinstance(arg, Lanes) for arg in args)
            return signature(LANES, LANES, LANES) if fits else None

    infer_global(symbol)(Template)

    @lower_builtin(symbol, Lanes, Lanes)
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return emit(builder, *args)


teach_operation(operator.add, lambda builder, a, b: builder.fadd(a, b, flags=FUSED))
teach_operation(operator.sub, lambda builder, a, b: builder.fsub(a, b, flags=FUSED))
teach_operation(operator.mul, lambda builder, a, b: builder.fmul(a, b, flags=FUSED))
teach_operation(operator.truediv, lambda builder, a, b: builder.fdiv(a, b, flags=FUSED))


def pointer_to_lanes(context: Any, builder: Any, declared: Any, array: Any, index: Any) -> Any:
    """Pointer to eight doubles of a flat array, from ``index`` on."""
    data = context.make_array(declared)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), VECTOR.as_pointer())


def is_flat_doubles(declared: Any) -> bool:
    """True for numba's type of a one-dimensional array of doubles."""
    return isinstance(declared, types.Array) and declared.ndim == 1 and declared.dtype == types.float64


@intrinsic
def load_lanes(typingctx: Any, array: Any, index: Any) -> Any:
    """Eight doubles of a flat array from ``index`` on."""
    if not is_flat_doubles(array):
        return None

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        # Numpy promises eight bytes of alignment and no more.
        return builder.load(pointer_to_lanes(context, builder, sig.args[0], args[0], args[1]), align=8)

    return LANES(array, types.intp), generate


@intrinsic
def store_lanes(typingctx: Any, array: Any, index: Any, value: Any) -> Any:
    """Write lanes into a flat array from ``index`` on."""
    if not (is_flat_doubles(array) and isinstance(value, Lanes)):
        return None

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], pointer_to_lanes(context, builder, sig.args[0], args[0], args[1]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, LANES), generate


@intrinsic
def spread_lanes(typingctx: Any, value: Any) -> Any:
    """One double in every lane."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        index = ir.IntType(32)
        single = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), args[0], ir.Constant(index, 0))
        same = ir.Constant(ir.VectorType(index, WIDTH), [0] * WIDTH)
        return builder.shuffle_vector(single, ir.Constant(VECTOR, ir.Undefined), same)

    return LANES(types.float64), generate
