"""Further measurements for ``navsym observe --restore``: reading what could be measured, saying what is enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from navsym.core.errors import DomainError, DuplicateError, ExpressionSyntaxError

if TYPE_CHECKING:
    from navsym.models.linear import LinearModel
    from navsym.models.modelfile import ModelFile

WHERE = "--candidate"


def read_candidates(texts: Sequence[str], found: ModelFile) -> dict[str, list[Any]]:
    """``NAME = formula of the states`` each, as rows of exact coefficients; empty without any."""
    from navsym.language.expression import parse, symbol

    states = {name: symbol(name) for name in found.states}
    known = {name: parameter.symbol for name, parameter in found.parameters.items()} | states
    rows: dict[str, list[Any]] = {}
    for text in texts:
        name, equals, formula = (part.strip() for part in text.partition("="))
        if not equals or not name:
            message = f'expected NAME = formula of the states; got {text[:40]!r}; write "gps = {found.states[0]}"'
            raise ExpressionSyntaxError(message, where=WHERE)
        if name in rows:
            raise DuplicateError(f"expected one formula of {name[:40]}; got two; rename one", where=WHERE)
        rows[name] = coefficients(parse(formula, known, where=f"{WHERE} {name[:40]}"), list(states.values()), name)
    return rows


def coefficients(formula: Any, states: Sequence[Any], name: str) -> list[Any]:
    """One coefficient for each state, where the formula is a sum of states times numbers and parameters."""
    expanded = formula.expand()
    row = [expanded.coeff(state) for state in states]
    rest = (expanded - sum(entry * state for entry, state in zip(row, states, strict=True))).expand()
    if rest != 0 or any(entry.free_symbols & set(states) for entry in row) or not any(row):
        message = "expected a sum of states times numbers and parameters; got another formula; make it linear"
        raise DomainError(message, where=f"{WHERE} {name[:40]}")
    return row


def restoration(model: LinearModel, rows: Mapping[str, Sequence[Any]]) -> dict[str, Any]:
    """The fewest further measurements as plain data; each state is a candidate where none is given."""
    from navsym.observability.sensors import restore

    found = restore(model, rows or None)
    return {
        "hidden": found.hidden,
        "needed": found.needed,
        "fewest": found.fewest,
        "sets": [list(names) for names in found.sets],
        "proved": found.proved,
        "candidates": list(rows) or list(model.states),
    }


def restored_text(data: Mapping[str, Any]) -> str:
    """What is hidden, what is needed at least, and the smallest sets of candidates that are enough."""
    if not data["hidden"]:
        return "every state is shown already: no further measurement is needed\n"
    lines = [f"further measurements: at least {data['needed']} needed, whatever they measure"]
    if not data["sets"]:
        proved = "proved" if data["proved"] else "not proved"
        lines.append(f"not enough, all together: {', '.join(data['candidates'])} ({proved})")
    else:
        fewer = "proved that no fewer of them are" if data["proved"] else "not proved that no fewer of them are"
        lines.append(f"enough ({fewer}):")
        lines += ["  " + ", ".join(names) for names in data["sets"]]
    return "\n".join(lines) + "\n"
