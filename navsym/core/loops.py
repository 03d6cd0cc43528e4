"""Loops that are interpreted first and compiled when that pays.

To compile the loops of the exchange costs a new machine some twenty seconds once, to load them half a second; a
single problem needs milliseconds interpreted. So the time spent interpreting is counted, and a loop is compiled
when all of them together have cost as much as compiling would (the rule of the skier who rents until he has
paid the price of the skis: never more than twice what the best choice costs).

Machine code is kept beside the source where it can be. It saves time and nothing else: where it cannot be written (a
full disk, a folder that is read only) or read (a file cut short by a power failure), the loop is compiled for this
process.

Both forms do the same operations on doubles in the same order, without sums or functions of a library whose
rounding is its own affair; so an answer does not depend on when the compiler came in.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache, update_wrapper
from pathlib import Path
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")

#: Seconds of interpreting after which a loop is compiled: where it was never compiled, and where it was.
TO_COMPILE, TO_LOAD = 20.0, 0.6


class Meter:
    """Seconds spent interpreting since the program started."""

    spent = 0.0


class Kernel(Generic[P, R]):
    """A function on plain numbers and arrays that is interpreted or compiled; both give the same bits.

    py_func : the function as it is written
    """

    def __init__(self, function: Callable[P, R]):
        self.py_func = function
        self.fast: Callable[P, R] | None = None
        update_wrapper(self, function)

    def __call__(self, *given: P.args, **named: P.kwargs) -> R:
        if self.fast is not None:
            return self.fast(*given, **named)
        if self.price() < Meter.spent:
            return self.compiled()(*given, **named)
        start = time.perf_counter()
        answer = self.py_func(*given, **named)
        Meter.spent += time.perf_counter() - start
        return answer

    def compiled(self) -> Callable[P, R]:
        """The compiled function; the written one where there is no compiler."""
        self.fast = cast("Callable[P, R]", compile_loop(cast(FunctionType, self.py_func)))
        return self.fast

    def price(self) -> float:
        """Seconds to have it compiled: to load it where it lies compiled on the disk, else to compile it."""
        return TO_LOAD if was_compiled(cast(FunctionType, self.py_func)) else TO_COMPILE


def kernel(function: Callable[P, R]) -> Kernel[P, R]:
    """Decorator of a loop that Python calls."""
    return Kernel(function)


def part(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator of a loop that only other loops call, or Python for an instant: compiled with them."""
    function.__dict__["part"] = True
    return function


@cache
def compile_loop(function: FunctionType) -> Callable[..., Any]:
    """The function compiled, with every part that it calls."""
    names = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    parts = {name: compile_loop(source_function(g)) for name, g in names.items() if is_loop(g)}
    twin = FunctionType(function.__code__, {**function.__globals__, **parts}, function.__name__)
    twin.__qualname__, twin.__doc__ = function.__qualname__, function.__doc__
    try:
        return njit()(twin)  # type: ignore[no-any-return]
    except ImportError:  # a machine without numba
        return function


def is_loop(thing: Any) -> bool:
    """True for a kernel, and for a function marked by :func:`part`."""
    return isinstance(thing, Kernel) or bool(getattr(thing, "part", False))


def source_function(thing: Any) -> FunctionType:
    """The function as it is written, also of a kernel."""
    return cast(FunctionType, thing.py_func if isinstance(thing, Kernel) else thing)


@cache
def was_compiled(function: FunctionType) -> bool:
    """True when an index of compiled code newer than the source lies beside it; a hint about time only."""
    source = Path(function.__code__.co_filename)
    version = f"py{sys.version_info[0]}{sys.version_info[1]}"
    try:
        indices = list((source.parent / "__pycache__").glob(f"{source.stem}.{function.__name__}-*.{version}.nbi"))
        return any(index.stat().st_mtime >= source.stat().st_mtime for index in indices)
    except OSError:
        return False


class CodeStore:
    """numba's store of compiled code, without its failures."""

    def __init__(self, inner: Any):
        self.inner = inner

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The kept code, or None; what a damaged file holds is forgotten, whatever its reader makes of it."""
        try:
            return self.inner.load_overload(signature, context)
        except Exception:
            with suppress(OSError):
                self.inner.flush()
            return None

    def save_overload(self, signature: Any, code: Any) -> None:
        """Keep the code if there is room for it."""
        with suppress(OSError):
            self.inner.save_overload(signature, code)


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Decorator: numba's ``njit`` with these options, kept on the disk where that is possible."""
    import numba

    def decorate(function: Callable[..., Any]) -> Any:
        loop = numba.njit(**options)(function)
        try:
            loop.enable_caching()
        except RuntimeError:  # numba finds no folder that it may write to
            return loop
        loop._cache = CodeStore(loop._cache)
        return loop

    return decorate
