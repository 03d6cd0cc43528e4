"""Arguments of the functions by the names that the command line gives them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from navsym.core.errors import NavsymError


@contextmanager
def called_options(function: str) -> Iterator[None]:
    """Places of errors in words of the command line: ``limits: noise`` becomes ``--noise``."""
    try:
        yield
    except NavsymError as error:
        if error.where.startswith(f"{function}: "):
            error.where = ", ".join(f"--{name}" for name in error.where.removeprefix(f"{function}: ").split(", "))
        raise
