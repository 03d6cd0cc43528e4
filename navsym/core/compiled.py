"""Loops compiled by numba, their machine code kept beside the source where it can be.

What is kept saves time and nothing else: where it cannot be written (a full disk, a folder that is read only) or read
(a file cut short by a power failure), the loop is compiled for this process.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numba


class Kept:
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

    def decorate(function: Callable[..., Any]) -> Any:
        loop = numba.njit(**options)(function)
        try:
            loop.enable_caching()
        except RuntimeError:  # numba finds no folder that it may write to
            return loop
        loop._cache = Kept(loop._cache)
        return loop

    return decorate
