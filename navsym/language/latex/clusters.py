r"""Symbols of the second reader: tokens with their scripts, and the names of the table ``[latex]`` among them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NoReturn

from navsym.language.latex.notation import ACCENTS, DOTS
from navsym.language.latex.parts import Refusal
from navsym.language.latex.tokens import Token, clean, match_brace

FRACTIONS = (r"\frac", r"\dfrac", r"\tfrac", r"\cfrac")


@dataclass(slots=True)
class Cluster:
    """A symbol with the tokens of its scripts; ``after`` is the place behind it."""

    base: list[Token]
    sub: list[Token] | None
    sup: list[Token] | None
    after: int


class ClusterReader:
    """Tokens, the place among them, and the spellings of names, the longest first."""

    def __init__(self, tokens: list[Token], end: int, entries: Sequence[tuple[str, list[Cluster]]] = ()) -> None:
        self.tokens, self.end, self.entries = tokens, end, entries
        self.place = 0

    def look(self, ahead: int = 0) -> str:
        """The text of a token, nothing behind the end."""
        return self.look_at(self.place + ahead)

    def look_at(self, place: int) -> str:
        return self.tokens[place].text if place < len(self.tokens) else ""

    def refuse(self, expected: str, at: int | None = None) -> NoReturn:
        """Refuse the token at hand."""
        here = self.tokens[self.place].at if self.place < len(self.tokens) else self.end
        raise Refusal(here if at is None else at, expected, self.look()[:40] or "the end", "write it another way")

    def group(self, place: int) -> tuple[list[Token], int]:
        """The tokens of an argument, and the place behind it."""
        if place >= len(self.tokens):
            raise Refusal(self.end, "an argument", "the end", "write it")
        text = self.tokens[place].text
        if text == "{":
            stop = match_brace(self.tokens, place)
            return self.tokens[place + 1 : stop], stop + 1
        if text in ("_", "^", "}"):
            raise Refusal(self.tokens[place].at, "an argument", text, "write it")
        after = self.behind_base(place)
        return self.tokens[place:after], after

    def behind_base(self, place: int) -> int:
        """The place behind a symbol without its scripts: a command has its arguments with it."""
        text = self.tokens[place].text
        if self.tokens[place].word:
            return place + 1
        if text == "{":
            return match_brace(self.tokens, place) + 1
        if text in FRACTIONS:
            return self.group(self.group(place + 1)[1])[1]
        if text[:1] == "\\" and (text[1:] in ACCENTS or text[1:] in DOTS):
            return self.group(place + 1)[1]
        if text == r"\sqrt":
            if self.look_at(place + 1) == "[":
                stops = [at for at in range(place, len(self.tokens)) if self.tokens[at].text == "]"]
                if not stops:
                    raise Refusal(self.tokens[place].at, "] behind the order of the root", "the end", "close it")
                place = stops[0]
            return self.group(place + 1)[1]
        return place + 1

    def cluster_scripts(self, place: int) -> tuple[list[Token] | None, list[Token] | None, int]:
        """Subscript, superscript and the place behind them."""
        scripts: dict[str, list[Token]] = {}
        while self.look_at(place) in ("_", "^", "'"):
            side = self.tokens[place].text
            if side == "'":
                stop = place
                while self.look_at(stop) == "'":
                    stop += 1
                if "^" in scripts:
                    raise Refusal(self.tokens[place].at, "a name before its primes", "'", "write the name in [latex]")
                scripts["^"], place = self.tokens[place:stop], stop
                continue
            primes = side == "^" and all(t.text == "'" for t in scripts.get("^", (Token("", 0, 0),)))
            if side in scripts and not primes:
                raise Refusal(self.tokens[place].at, "one script of a kind", "two", "use braces")
            bare = self.look_at(place + 1).isdigit()
            script, after = self.group(place + 1)
            scripts[side] = [*scripts[side], *script] if primes else script
            if bare and self.look_at(after).isdigit() and self.tokens[after].at == self.tokens[after - 1].end:
                raise Refusal(self.tokens[place].at, "a script in braces", "two digits", "use braces")
            place = after
        return scripts.get("_"), scripts.get("^"), place

    def cluster(self, place: int) -> Cluster:
        """The symbol at a place with its scripts, those before it as part of its base."""
        start = place
        while (self.look_at(place) == "{" and self.look_at(place + 1) == "}") or self.look_at(place) in ("_", "^"):
            if self.tokens[place].text == "{":
                place += 2
            place = self.cluster_scripts(place)[2]
        if place >= len(self.tokens):
            raise Refusal(self.end, "a symbol beside its scripts", "the end", "write it")
        after = self.behind_base(place)
        sub, sup, end = self.cluster_scripts(after)
        while self.look_at(end) == "{" and self.look_at(end + 1) == "}" and self.look_at(end + 2) not in ("_", "^"):
            end += 2
        return Cluster(self.tokens[start:after], sub, sup, end)

    def entry(self) -> tuple[str, list[Cluster], list[Token] | None] | None:
        """A spelling of ``[latex]`` at this place, the longest, with the superscript that is no part of it."""
        for name, wanted in self.entries:
            found: list[Cluster] = []
            place = self.place
            try:
                while len(found) < len(wanted) and place < len(self.tokens) and self.tokens[place].text != "}":
                    found.append(self.cluster(place))
                    place = found[-1].after
            except Refusal:
                continue
            if len(found) != len(wanted):
                continue
            rest = split_power(wanted[-1], found[-1])
            pairs = list(zip(wanted, found, strict=True))
            if all(is_spelled(w, f) for w, f in pairs[:-1]) and is_spelled(wanted[-1], rest[0]):
                return name, found, rest[1]
            turned = turn_value(wanted, found)
            if turned is not None:
                return name, found, turned
        return None


@lru_cache(10_000)
def list_clusters(latex: str) -> list[Cluster]:
    """An entry of ``[latex]`` as symbols; nobody changes them."""
    other, found, place = ClusterReader(clean(latex), len(latex)), [], 0
    while place < len(other.tokens):
        found.append(other.cluster(place))
        place = found[-1].after
    return found


def is_spelled(wanted: Cluster, found: Cluster) -> bool:
    """True when a symbol is written as an entry of ``[latex]`` says."""
    return all(is_alike(getattr(wanted, side), getattr(found, side)) for side in ("base", "sub", "sup"))


def split_power(wanted: Cluster, found: Cluster) -> tuple[Cluster, list[Token] | None]:
    """The last symbol of a name without the power behind it: all of its superscript, or what follows its primes."""
    count = len(wanted.sup or ())
    texts = [token.text for token in found.sup or ()]
    if any(token.text != "'" for token in wanted.sup or ()) or texts[:count] != ["'"] * count or "'" in texts[count:]:
        return (found, None) if wanted.sup else (replace(found, sup=None), found.sup)
    own, power = (found.sup or [])[:count], (found.sup or [])[count:]
    return replace(found, sup=own or None), power or None


def turn_value(wanted: list[Cluster], found: list[Cluster]) -> list[Token] | None:
    r"""The T of ``h^T(x)`` for the entry ``h(x)``."""
    if len(wanted) < 4 or wanted[0].sup or not found[0].sup or found[-1].sup:
        return None
    texts = [t.text for t in found[0].sup if t.text not in "{}"]
    mark = texts[-1:] == ["T"] if len(texts) == 1 or texts[:-1] == [r"\mathsf"] else False
    ends = [wanted[at].base[0].text for at in (1, -1)]
    if not (mark or texts in ([r"\top"], [r"\intercal"])) or ends != ["(", ")"]:
        return None
    pairs = zip(wanted, [replace(found[0], sup=None), *found[1:]], strict=True)
    return found[0].sup if all(is_spelled(w, f) for w, f in pairs) else None


def is_alike(wanted: list[Token] | None, found: list[Token] | None) -> bool:
    """The same tokens, braces apart; bold where that is wanted. Scripts before a symbol come in either order."""
    if wanted is None or found is None:
        return wanted is found
    left, right = canonical(wanted), canonical(found)
    pairs = zip(left, right, strict=False)
    is_same = all((w.text, w.word) == (f.text, f.word) and (f.bold or not w.bold) for w, f in pairs)
    return is_same and len(left) == len(right)


def canonical(tokens: list[Token]) -> list[Token]:
    """Tokens with subscripts before superscripts, every script in braces and no other braces."""
    other = ClusterReader(tokens, 0)
    done: list[Token] = []
    place = 0
    while place < len(tokens):
        text = tokens[place].text
        if text in ("_", "^"):
            sub, sup, place = other.cluster_scripts(place)
            for side, script in (("_", sub), ("^", sup)):
                if inner := canonical(script or []):
                    done += [Token(side, 0, 0, True), Token("{", 0, 0, True), *inner, Token("}", 0, 0, True)]
            continue
        if text not in "{}":
            done.append(tokens[place])
        place += 1
    return done


def entry_rank(clusters: list[Cluster]) -> tuple[int, int]:
    """Longer spellings first, then those with more scripts and bold type."""
    marks = [c.base[0].bold + (c.sub is not None) + (c.sup is not None) for c in clusters]
    return (len(clusters), sum(marks))
