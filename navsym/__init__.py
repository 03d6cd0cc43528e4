"""navsym: derive, decide, solve and export the theory of inertial-navigation aiding.

    >>> import navsym as nav
    >>> nav.prove("sin(2*a) = 2*sin(a)*cos(a)").status
    <Status.PROVED: 'PROVED'>

Every verb of the command line is one function here, with the same words; text, sympy expressions and exact numbers go
in, and answers are frozen objects with plain attributes that show themselves in a notebook. ``answer.document()`` is the
JSON that the verb prints. A wrong argument raises :class:`NavsymError` with its kind, its place, and a sentence of the
form *expected …; got …; remedy*.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

#: Public name -> module that holds it. A module is imported when its name is first used, and its engines with it.
_HOMES = {
    "NavsymError": "navsym.core.errors",
    "Number": "navsym.core.numbers",
    **dict.fromkeys(("Verdict", "Status", "PROVED", "CERTIFIED", "CONFIRMED", "REFUTED", "OPEN"), "navsym.claims"),
}

__all__ = ["__version__", *sorted(_HOMES)]

if TYPE_CHECKING:
    from navsym.claims import CERTIFIED as CERTIFIED
    from navsym.claims import CONFIRMED as CONFIRMED
    from navsym.claims import OPEN as OPEN
    from navsym.claims import PROVED as PROVED
    from navsym.claims import REFUTED as REFUTED
    from navsym.claims import Status as Status
    from navsym.claims import Verdict as Verdict
    from navsym.core.errors import NavsymError as NavsymError
    from navsym.core.numbers import Number as Number


class _FrontDoor(ModuleType):
    """The package itself: a function and a folder may share a name (``prove``, ``export``), and the function is shown.

    Importing ``navsym.prove.equations`` would bind the folder here and hide the function.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if not (isinstance(value, ModuleType) and name in _HOMES):
            super().__setattr__(name, value)


def __getattr__(name: str) -> Any:
    """A public name, imported when it is first asked for (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module 'navsym' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(_HOMES[name]), name)
    setattr(sys.modules[__name__], name, value)
    return value


def __dir__() -> list[str]:
    return list(__all__)


sys.modules[__name__].__class__ = _FrontDoor
