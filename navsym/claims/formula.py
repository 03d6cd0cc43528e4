"""A relation between two sides as its author wrote it, in the language of files."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from keyword import iskeyword
from typing import Any

from navsym.claims.display import SIGNS

NAME = re.compile(r"(?<![\w.])[A-Za-z]\w*", re.ASCII)

#: One side: text, or the rows of a matrix.
Side = str | list[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Formula:
    """Both sides, the relation and the declared symbols: a claim of a claim file, as plain data.

    id          : label of the claim; ``"formula"`` for one that has none
    left, right : text in the language of files, or a list of texts, or of rows, for a matrix
    relation    : one of ``= != < <= > >=``
    symbols     : name -> declaration, as in ``[symbols]``: a range ``["0", "pi"]``, or a word such as ``"positive"``
    box         : name -> range of this formula inside its declaration
    tolerance   : for a printed numeral, the exact number that ``|left - right|`` does not exceed; None for equality
    exists      : expressions that must have a value, beside those that stand in the sides
    given       : hypotheses, each a relation
    chain       : ``"a = b <= c"`` in the place of both sides and their relation
    rates       : name -> derivative by time
    order       : name -> whole number n: equal up to terms of order name**n
    """

    left: Side
    relation: str
    right: Side
    symbols: Mapping[str, Any] = field(default_factory=dict)
    box: Mapping[str, Any] = field(default_factory=dict)
    id: str = "formula"
    tolerance: str | None = None
    exists: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    chain: str | None = None
    rates: Mapping[str, Any] = field(default_factory=dict)
    order: Mapping[str, int] = field(default_factory=dict)

    def __str__(self) -> str:
        within = "" if self.tolerance is None else f" +- {self.tolerance}"
        rest = "".join(f" + O({name}**{n})" for name, n in self.order.items())
        return self.chain or f"{side_text(self.left)}{within} {self.relation} {side_text(self.right)}{rest}"

    def document(self) -> dict[str, Any]:
        """A whole claim file of this formula: ``{"symbols": …, "claim": [{"id", "left", "right", "relation"}]}``."""
        block: dict[str, Any] = {"id": self.id, "left": self.left, "right": self.right, "relation": self.relation}
        if self.chain:
            block = {"id": self.id, "chain": self.chain}
        more = {"box": dict(self.box), "tolerance": self.tolerance, "exists": list(self.exists)}
        more |= {"given": list(self.given), "order": dict(self.order)}
        block |= {key: value for key, value in more.items() if value}
        rates: dict[str, Any] = {"rates": dict(self.rates)} if self.rates else {}
        return {"symbols": dict(self.symbols), **rates, "claim": [block]}

    def python(self) -> str:
        """The call of :func:`navsym.prove` that states it, as Python source.

        >>> import navsym as nav
        >>> nav.prove("sin(T) <= T", T=("0", "pi")).formula.python()
        "nav.prove('sin(T) <= T', T=['0', 'pi'])"
        """
        document = self.document()
        block, rates = document["claim"][0], document.get("rates")
        words = {name: value for name, value in self.symbols.items() if value != "real"}
        words |= {key: block[key] for key in ("box", "tolerance", "exists", "given", "order") if key in block}
        words |= {"rates": rates} if rates else {}
        stated = self.chain or f"{side_text(self.left)} {self.relation} {side_text(self.right)}"
        named = [f"**{{{n!r}: {v!r}}}" if iskeyword(n) else f"{n}={v!r}" for n, v in words.items()]
        return f"nav.prove({', '.join([repr(stated), *named])})"

    def _repr_latex_(self) -> str:
        if self.chain:
            return rf"$\displaystyle {chain_latex(self.chain, self.symbols)}$"
        left, right = (side_latex(side, self.symbols) for side in (self.left, self.right))
        left += "" if self.tolerance is None else rf" \pm {side_latex(self.tolerance, {})}"
        right += "".join(rf" + O({side_latex(f'{name}**{n}', self.symbols)})" for name, n in self.order.items())
        return rf"$\displaystyle {left} {SIGNS.get(self.relation, self.relation)} {right}$"


def names_of(side: Side) -> set[str]:
    """Every name that stands in a side, functions included."""
    return set(NAME.findall(side_text(side)))


def side_text(side: Side) -> str:
    """A side as text: a matrix by its rows, ``[[a, b], [c, d]]``."""
    return str(side) if not isinstance(side, list) else f"[{', '.join(side_text(part) for part in side)}]"


def side_latex(side: Side, names: Mapping[str, Any]) -> str:
    """A side in LaTeX, as it was written."""
    from navsym.language.shapes import read_shape
    from navsym.language.vectors import print_value_latex, read_value

    sizes = {shape.name: shape.size for n, value in names.items() for shape in read_shape(n, value, {*names}, "")}
    return print_value_latex(read_value(side_text(side), sizes).tree)


def chain_latex(chain: str, names: Mapping[str, Any]) -> str:
    """A chain in LaTeX, side by side."""
    parts = re.split(r"([<>!]=|[<>=])(?![^(\[]*[)\]])", chain)
    return " ".join(SIGNS.get(p, p) if k % 2 else side_latex(p.strip(), names) for k, p in enumerate(parts))
