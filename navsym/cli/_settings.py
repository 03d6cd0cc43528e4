"""Values of parameters from ``--set NAME=VALUE``, read alike by every verb that takes a model file."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.core.errors import DuplicateError, ExpressionSyntaxError


def values_of(settings: Sequence[str] | None) -> dict[str, str]:
    """NAME=VALUE settings as a mapping.

    Raises ExpressionSyntaxError without a sign of equality and DuplicateError for a name given twice.
    """
    values: dict[str, str] = {}
    for setting in settings or ():
        name, equals, value = setting.partition("=")
        name = name.strip()
        if not equals or not name:
            message = f"expected NAME=VALUE; got {setting[:40]!r}; write --set T=5/2"
            raise ExpressionSyntaxError(message, where="--set")
        if name in values:
            raise DuplicateError(f"expected one value of {name}; got two; give one", where="--set")
        values[name] = value.strip()
    return values
