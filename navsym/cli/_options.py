"""Arguments of the functions by the names that the command line gives them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from navsym.core.errors import NavsymError

#: A remedy of the Python call that sets a switch.
FLAG = re.compile(r"\b([a-z_]+)=True\b")


@contextmanager
def called_options(function: str) -> Iterator[None]:
    """Errors in words of the command line: ``limits: noise`` becomes ``--noise``, and ``force=True`` ``--force``."""
    try:
        yield
    except NavsymError as error:
        if error.where.startswith(f"{function}: "):
            error.where = ", ".join(f"--{name}" for name in error.where.removeprefix(f"{function}: ").split(", "))
        switched = FLAG.sub(lambda found: f"--{found[1].replace('_', '-')}", error.remedy)
        error.message = error.message.removesuffix(error.remedy) + switched
        raise
