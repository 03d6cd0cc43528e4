"""Names of the source as symbols of statements, and back."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from navsym.core.errors import DuplicateError, ExpressionSyntaxError
from navsym.language.declarations import box_of, read_parameters
from navsym.language.names import NAME_LENGTH, RESERVED, check_name, join_place, quote
from navsym.language.tree import Tree, build_symbol
from navsym.prove.sampling.points import ranges_of, write_range

SPELLING = re.compile(r"[A-Za-z_]\w*(?:(?:\.|->|::)\w+)*(?:\(\))?(?:\s*(?:\[[\d,\s]*\]|\([\d,\s]*\)))*", re.ASCII)


def squeeze(spelling: str) -> str:
    """A spelling without blanks, ``->`` as it is: ``P[0, 1]``, ``P[0][1]`` and ``P(0, 1)`` are one entry."""
    bare = re.sub(r"\s", "", spelling).replace("][", ",")
    return re.sub(r"\((\d+(?:,\d+)*)\)", r"[\1]", bare)


@dataclass(slots=True, eq=False)
class Names:
    """One table for all sources of an audit: a spelling is one symbol, whoever uses it.

    symbols      : squeezed spelling -> name of its symbol
    spellings    : name of a symbol -> how the source writes it
    declarations : name of a symbol -> its declaration, as in [symbols]
    inputs       : names that no source assigns, which an expression may hold though no source reads them
    declared     : names of symbols that a mapping declares
    rotations    : matrices that are rotations, with the names of their nine symbols row by row
    units, frames : squeezed spelling of an input, or of an array of them -> its declared unit or frame
    """

    symbols: dict[str, str] = field(default_factory=dict)
    spellings: dict[str, str] = field(default_factory=dict)
    declarations: dict[str, Any] = field(default_factory=dict)
    written: dict[str, Any] = field(default_factory=dict)
    inputs: set[str] = field(default_factory=set)
    declared: set[str] = field(default_factory=set)
    rotations: dict[str, tuple[str, ...]] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    frames: dict[str, str] = field(default_factory=dict)

    def symbol(self, spelling: str) -> Tree:
        """The symbol of an input, made when it is first met."""
        key = squeeze(spelling)
        if key not in self.symbols:
            name = self.symbols[key] = self.free_name(key)
            self.declarations.setdefault(name, "real")
            self.spellings.setdefault(name, spelling)
        return build_symbol(self.symbols[key])

    def twin(self, symbol: Tree) -> Tree:
        """Another symbol of the same range, which is shown as ``x'``."""
        name = symbol.args[0]
        twin = self.symbol(f"{self.spellings.get(name, name)}'")
        self.declarations[twin.args[0]] = self.declarations[name]
        return twin

    def free_name(self, spelling: str) -> str:
        """A name of the language that is like a spelling and not taken."""
        base = re.sub(r"[^A-Za-z0-9]+", "_", spelling).strip("_") or "x"
        base = (base if base[0].isalpha() else f"x{base}")[: NAME_LENGTH - 6]
        name, k = base, 2
        while name in RESERVED or name in self.declarations:
            name, k = f"{base}_{k}", k + 1
        return name

    def declare(self, spelling: str, declaration: Any, where: str) -> None:
        """A declaration of ``[code.symbols]``: a range, a word, or a table with a name of its own."""
        key, name = squeeze(spelling), None
        if isinstance(declaration, Mapping):
            if (name := declaration.get("name")) is not None:
                check_name(name, where=join_place(where, "name"))
            declaration = declaration.get("range", declaration.get("sign", "real"))
        is_name = re.fullmatch(r"[A-Za-z]\w*", key, re.ASCII) is not None and len(key) <= NAME_LENGTH
        is_free = is_name and key not in RESERVED and key not in self.declarations
        name = name or self.symbols.get(key) or (key if is_free else self.free_name(key))
        if self.declarations.get(name, declaration) != declaration and self.declarations[name] != "real":
            message = f"expected one declaration of {quote(name)}; got two different ones; make them equal"
            raise DuplicateError(message, where=where)
        self.declarations[name] = declaration
        self.declared.add(name)
        self.symbols[key] = name
        self.spellings.setdefault(name, spelling)

    def translate(self, text: str, where: str) -> str:
        """An expression of a question: spellings of the source in it become their symbols."""
        if not isinstance(text, str):
            raise ExpressionSyntaxError(f"expected an expression as text; got {quote(text)}; quote it", where=where)

        def step(found: re.Match[str]) -> str:
            key = squeeze(found[0])
            if key in self.symbols:
                return self.symbols[key]
            return str(self.symbol(found[0].strip()).args[0]) if key.partition("[")[0] in self.inputs else found[0]

        return SPELLING.sub(step, text)

    def show(self, text: str) -> str:
        """A text of statements in the spelling of the source."""
        return re.sub(r"[A-Za-z][A-Za-z0-9_]*", lambda found: self.spellings.get(found[0], found[0]), text)

    def ranges(self) -> dict[str, Any]:
        """Symbol -> its range in the words of the checker."""
        for name, declaration in self.declarations.items():
            if name not in self.written and declaration == "real":
                self.written[name] = [None, None, []]
            elif name not in self.written:
                parameters = read_parameters({name: declaration}, "code.symbols")
                symbol = parameters[name].symbol
                self.written[name] = write_range(ranges_of([symbol], box_of(parameters))[symbol])
        return dict(self.written)
