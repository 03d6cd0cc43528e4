"""Options NAME=VALUE, read alike by every verb: values of parameters from ``--set``, candidates of measurements."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.core.errors import DuplicateError, ExpressionSyntaxError


def values_of(
    settings: Sequence[str] | None,
    option: str = "--set",
    form: str = "NAME=VALUE",
    example: str = "--set T=5/2",
    twice: str = "expected one value of {}; got {} and {}; give one",
) -> dict[str, str]:
    """NAME=VALUE settings of an option as a mapping.

    Raises ExpressionSyntaxError without a sign of equality and DuplicateError for a name given twice.
    """
    values: dict[str, str] = {}
    for setting in settings or ():
        name, equals, value = (part.strip() for part in setting.partition("="))
        if not equals or not name:
            message = f"expected {form}; got {setting[:40]!r}; write {example}"
            raise ExpressionSyntaxError(message, where=option)
        if name in values:
            raise DuplicateError(twice.format(name[:40], values[name][:40], value[:40]), where=option)
        values[name] = value
    return values
