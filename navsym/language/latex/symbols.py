r"""Names for the first reader: what a symbol with its scripts means, by declarations and by the table ``[latex]``."""

from __future__ import annotations

import re
from copy import copy
from dataclasses import replace
from typing import Any, ClassVar, NoReturn, Self

from navsym.language.latex.mathlists import Noad, is_same, is_same_list, list_spelling, match_bracket
from navsym.language.latex.notation import CALLS, GREEK, SENTENCE, Notation
from navsym.language.latex.parts import Part, Refusal

POWER = re.compile(r"(.*)\^(?:\{[^{}]*\}|\\[a-z]+|.)(?=(?:_.*)?$)", re.S)
COMMANDED = ("frac", "sqrt", *CALLS)
LEAD = re.compile(r"^(?:\\[,;:! ]|\\q?quad(?![A-Za-z])|~|\s)+")


class SymbolReader:
    """A list of symbols, and the place in it; the grammar is added by those who inherit."""

    expression: ClassVar[Any]
    call: ClassVar[Any]
    exponent: ClassVar[Any]

    def __init__(self, text: str, notation: Notation, noads: list[Noad], faces: dict[str, set[bool]]) -> None:
        self.text, self.notation, self.noads, self.faces = text, notation, noads, faces
        self.bound: tuple[str, ...] = ()
        self.place, self.integrals = 0, 0
        self.bars: list[str] = []
        spelled = [(name, list_spelling(latex)) for name, latex in notation.spellings]
        marks = [sum(n.bold + (n.sub is not None) + (n.sup is not None) for n in found) for _, found in spelled]
        ranks = {name: (len(found), count) for (name, found), count in zip(spelled, marks, strict=True)}
        self.spelled = sorted(spelled, key=lambda pair: ranks[pair[0]], reverse=True)  # longer ones first

    def start(self, noads: list[Noad]) -> Self:
        """A reader of a list of its own: the argument of a command."""
        reader = copy(self)
        reader.noads, reader.place, reader.bars, reader.integrals = noads, 0, [], 0
        return reader

    def inside(self, noads: list[Noad]) -> Part:
        """The whole of such a list."""
        reader = self.start(noads)
        part = reader.expression()
        if reader.place < len(noads):
            reader.refuse("an operator or the end", "remove it")
        return part

    @property
    def noad(self) -> Noad | None:
        return self.noads[self.place] if self.place < len(self.noads) else None

    def refuse(self, expected: str, remedy: str) -> NoReturn:
        """Refuse the symbol at hand."""
        noad = self.noad
        at = noad.at if noad else self.noads[-1].end if self.noads else len(self.text)
        got = self.text[noad.at : noad.end][:40] if noad else "the end"
        raise Refusal(at, expected, got, remedy)

    def spelling(self) -> tuple[Part, Noad] | None:
        """A name that stands in ``[latex]``, the longest; a subscript behind it would be another name."""
        for name, wanted in self.spelled:
            found = self.noads[self.place : self.place + len(wanted)]
            turned = transposed_value(wanted, found)
            if turned is not None:
                self.place += len(wanted)
                if not any(w.bold for w in wanted):
                    self.faces.setdefault(name, set()).add(found[0].bold)
                return Part("name", (name,), found[0].at), turned
            pairs = zip(wanted, found, strict=False)
            if len(found) == len(wanted) and all(is_same(w, f, last=w is wanted[-1]) for w, f in pairs):
                if name == "eye":
                    self.place += len(wanted)
                    return Part("eye", ("?",), found[0].at), replace(found[-1], sub=None)
                if name in CALLS and name not in self.notation:
                    self.place += len(wanted) - 1
                    return self.call(CALLS[name]), Noad("group", None, 0, 0)
                self.place += len(wanted)
                last = found[-1]
                if not any(w.bold for w in wanted):
                    self.faces.setdefault(name, set()).add(found[0].bold)
                behind = (last.sup or [])[len(wanted[-1].sup or ()) :] or None
                rest = Noad(last.kind, last.value, last.at, last.end, sup=behind)
                return Part("name", (name,), found[0].at), rest
        return None

    def name(self, noad: Noad) -> Part:
        """A letter, a Greek letter or a word with its subscript; letters side by side may be one name."""
        word = self.base(noad)
        if noad.kind == "word" and noad.value in SENTENCE and not noad.has_scripts and word not in self.notation:
            self.refuse("a formula without words", "write the words outside")
        value = self.value(noad)
        if value is not None:
            return value
        if noad.kind == "word":
            self.refuse_operator(noad)
        if word is None or noad.before != (None, None):
            return self.unknown(noad)
        if word == "e" and noad.sup and not noad.sub and "e" not in self.notation:
            self.place += 1
            return Part("call", ("exp", None, True, self.inside(noad.sup)), noad.at)
        run = self.run()
        if len(run) > 1:
            whole = "".join(str(n.value) for n in run) + self.flat_subscript(run[-1])
            known = all(self.is_known(place) for place in range(self.place, self.place + len(run)))
            if known and whole in self.notation:
                self.refuse("one meaning", f"say in [latex] whether {whole} is a product or a name")
            if not known:
                self.place += len(run)
                head = "name" if whole in self.notation else "unknown"
                letters, flat = "".join(str(n.value) for n in run), self.flat_subscript(run[-1])
                spelled = (rf"\mathbf{{{letters}}}" if noad.bold else letters) + (f"_{{{flat[1:]}}}" if flat else "")
                part = Part(head, (whole,) if head == "name" else (whole, spelled), noad.at)
                return self.power(part, run[-1])
        return self.single(noad, word)

    def value(self, noad: Noad) -> Part | None:
        r"""A value such as ``f(x, y)``, ``h(\cdot)`` or ``f(x)`` of an undeclared name: one name of its own."""
        closing = find_closing(self.noads, self.place + 1)
        turned = noad.sup is not None and len(noad.sup) == 1 and transpose_mark(noad.sup[0]) != ""
        named = self.base(noad) is not None or noad.kind == "arg"
        if closing < 0 or not named or (noad.sup and not turned and not self.is_index(noad.sup)):
            return None
        inner = self.noads[self.place + 2 : closing]
        dotted = len(inner) == 1 and inner[0].is_command("cdot")
        single = len(inner) == 1 and (self.base(inner[0]) is not None or inner[0].kind == "arg")
        if len(split_noads(inner, ",")) < 2 and not dotted and (not single or self.is_known(self.place)):
            return None
        opening = self.noads[self.place + 1]
        spelled = self.spell(noad) + self.text[opening.at : self.noads[closing].end]
        self.place = closing + 1
        part = Part("unknown", (suggest_name(spelled), spelled), noad.at)
        return self.power(part, noad if turned else self.noads[closing])

    def single(self, noad: Noad, word: str) -> Part:
        """One letter with its subscript."""
        found = self.resolve(noad, word)
        if found is None:
            return self.unknown(noad)
        self.place += 1
        return self.power(found, noad)

    def base(self, noad: Noad) -> str | None:
        """The name of a symbol without its scripts."""
        if noad.kind == "sym" and noad.value.isascii() and noad.value.isalpha():
            return str(noad.value)
        if noad.kind == "cmd" and noad.value in GREEK:
            return str(noad.value)
        if noad.kind == "word" and re.fullmatch(r"[A-Za-z][A-Za-z0-9]*", noad.value):
            return str(noad.value)
        return None

    def resolve(self, noad: Noad, word: str) -> Part | None:
        """What a symbol with its subscript means; None where nobody declared it."""
        flat = self.flat_subscript(noad)
        name = word + flat
        if (flat or noad.sub is None) and (name in self.notation or name in self.bound):
            self.faces.setdefault(name, set()).add(noad.bold)
            return Part("name", (name,), noad.at)
        if noad.sub and word in self.notation and self.notation.shapes[word]:
            indices = [self.index(piece) for piece in split_noads(noad.sub, ",")]
            wanted = 1 if self.notation.is_vector(word) else 2
            if len(indices) == wanted and all(indices):
                return Part("index", (word, *indices), noad.at)
        if word == "I" and noad.bold and noad.sub and "I" not in self.notation:
            size = self.sizes(noad.sub)
            if size and size[0] == size[-1]:
                return Part("eye", (size[0],), noad.at)
        return None

    def flat_subscript(self, noad: Noad) -> str:
        """``_eS`` for a subscript of plain symbols, nothing for others."""
        pieces = [self.base(n) or (n.value if n.is_sign(*"0123456789") else None) for n in noad.sub or ()]
        if not pieces or None in pieces or any(n.has_scripts for n in noad.sub or ()):
            return ""
        return "_" + "".join(map(str, pieces))

    def index(self, noads: list[Noad]) -> str:
        """An index: digits, or the index of a sum."""
        text = "".join(str(n.value) for n in noads)
        plain = all(n.kind == "sym" and not n.has_scripts for n in noads)
        return text if plain and ((text.isdigit() and text[:1] != "0") or text in self.bound) else ""

    def sizes(self, noads: list[Noad]) -> list[str]:
        r"""Rows and columns of ``_{3 \times 3}`` or ``_3``."""
        pieces = split_noads(noads, "times")
        texts = ["".join(str(n.value) for n in piece) for piece in pieces]
        return texts if len(texts) <= 2 and all(re.fullmatch("[1-9][0-9]?|[a-z]", t) for t in texts) else []

    def is_known(self, place: int) -> bool:
        """True when the symbol at a place has a meaning of its own."""
        kept, self.place = self.place, place
        try:
            noad = self.noads[place]
            if noad.is_sign("e") and noad.sup and "e" not in self.notation:
                return True
            return self.spelling() is not None or self.resolve(noad, str(noad.value)) is not None
        finally:
            self.place = kept

    def run(self) -> list[Noad]:
        """Letters side by side, without a space between them."""
        run: list[Noad] = []
        for noad in self.noads[self.place :]:
            letter = noad.kind == "sym" and noad.value.isascii() and noad.value.isalpha()
            if not letter or (run and (run[-1].has_scripts or run[-1].end != noad.at or run[-1].bold != noad.bold)):
                break
            if run and self.integrals and noad.value == "d" and "d" not in self.notation:
                break
            run.append(noad)
        return run

    def unknown(self, noad: Noad) -> Part:
        """A symbol that nobody declared, with the name that it might have."""
        self.refuse_operator(noad)
        prefix = noad.is_command("Delta", "delta", "nabla") and not noad.has_scripts
        is_prefix = prefix and self.place + 1 < len(self.noads)
        if noad.kind in ("sym", "cmd") and self.base(noad) is None and not is_prefix:
            self.refuse("a symbol of the language", "write it otherwise, or as a name in [latex]")
        if noad.kind == "word" and self.base(noad) is None:
            self.refuse("a formula without words", "write the words outside")
        self.place += 1
        if prefix and self.noad is not None:
            following = self.noad
            if (following.kind in ("arg", "word") and following.value not in COMMANDED) or self.base(following):
                self.place += 1
                return self.power(self.unknown_from(noad.at, following), following)
        spelled = self.spell(noad)
        word, flat = self.base(noad), self.flat_subscript(noad)
        if word and (flat or noad.sub is None) and noad.before == (None, None):
            return self.power(Part("unknown", (word + flat, spelled), noad.at), noad)
        return Part("unknown", (suggest_name(spelled), spelled), noad.at)

    def refuse_operator(self, noad: Noad) -> None:
        r"""Refuse ``\mathbb{E}[x + y]`` and words before parentheses: they are functions, no factors."""
        following = self.noads[self.place + 1] if self.place + 1 < len(self.noads) else None
        operator = (noad.kind == "word" and len(noad.value) > 1) or noad.value in ("mathbb", "mathcal", "mathscr")
        if operator and not noad.has_scripts and following is not None and following.kind == "open":
            self.refuse("a function of the language", "write its value as a name in [latex]")

    def spell(self, noad: Noad) -> str:
        """The LaTeX of a name without its power."""
        spelled = noad.spelled or self.text[noad.at if noad.shown < 0 else noad.shown : noad.end]
        if noad.sup and (is_power(noad.sup) or transpose_mark(noad.sup[-1])):
            spelled = POWER.sub(r"\1", spelled)
        return spelled if noad.spelled else LEAD.sub("", self.balance(spelled, noad))

    def unknown_from(self, start: int, noad: Noad) -> Part:
        r"""``\Delta t`` and ``\nabla f(x)`` as one name."""
        closing = find_closing(self.noads, self.place)
        value = closing > 0 and not noad.sup and not noad.spelled and not self.is_known(self.place - 1)
        end = self.noads[closing].end if value else noad.at
        self.place = closing + 1 if value else self.place
        spelled = self.text[start:end] if value else self.text[start : noad.at if noad.shown < 0 else noad.shown]
        spelled = spelled.partition("{")[0].rpartition("\\")[0] if noad.spelled else spelled
        spelled += "" if value else self.spell(noad)
        return Part("unknown", (suggest_name(spelled), spelled), start)

    def balance(self, spelled: str, noad: Noad) -> str:
        """The LaTeX of a name with the braces that it needs."""
        missing = spelled.count("}") - spelled.count("{")
        start, end = noad.at if noad.shown < 0 else noad.shown, noad.end
        while missing > 0 and start > 0:
            start -= 1
            missing -= (self.text[start] == "{") - (self.text[start] == "}")
            spelled = self.text[start] + spelled
        while missing < 0 and end < len(self.text):
            missing += (self.text[end] == "}") - (self.text[end] == "{")
            spelled, end = spelled + self.text[end], end + 1
        return spelled

    def power(self, base: Part, noad: Noad) -> Part:
        """The base with the superscript of the symbol: a power, or a mark such as the T of a transpose."""
        if noad.sup is None:
            return base
        if base.head in ("name", "index", "unknown") and self.is_index(noad.sup):
            spelled = self.text[noad.at if noad.shown < 0 else noad.shown : noad.end]
            return Part("unknown", (suggest_name(spelled), spelled), base.at)
        return Part("^", (base, self.exponent(noad.sup)), base.at)

    def is_index(self, sup: list[Noad]) -> bool:
        """True for a superscript that can only be part of a name."""
        if not sup:
            return False
        first, is_alone = sup[0], len(sup) == 1
        if is_alone and (transpose_mark(first) or first.is_sign("*") or first.is_command("ast", "times", "wedge")):
            return False
        is_begun = first.kind == "open" or first.is_command("prime")
        return is_begun or any(n.is_sign(",") for n in sup) or (is_alone and not self.is_operand(first))

    def is_operand(self, noad: Noad) -> bool:
        """True for what may be a power alone."""
        is_number = noad.is_sign(*"0123456789") or noad.is_command("pi")
        return is_number or noad.kind in ("arg", "word", "bar") or self.base(noad) is not None


def transpose_mark(noad: Noad) -> str:
    """``T`` for the letter, ``top`` for what is nothing but a transpose."""
    if noad.has_scripts:
        return ""
    if noad.is_command("top", "intercal") or (noad.kind == "word" and noad.value == "T"):
        return "top"
    if noad.kind == "arg" and noad.value == "mathsf" and [n.value for n in noad.args[0]] == ["T"]:
        return "top"
    return "T" if noad.is_sign("T") else ""


def find_closing(noads: list[Noad], place: int) -> int:
    """Place of the parenthesis that closes the plain one here; -1 where there is none."""
    if place >= len(noads) or noads[place].kind != "open" or noads[place].value != "(" or noads[place].has_scripts:
        return -1
    return match_bracket(noads, place)


def transposed_value(wanted: tuple[Noad, ...], found: list[Noad]) -> Noad | None:
    r"""The closing parenthesis with the T of ``h^T(x)``, for the entry ``h(x)``."""
    if len(found) != len(wanted) or len(wanted) < 4 or wanted[0].sup or not found[0].sup or found[-1].has_scripts:
        return None
    if (wanted[1].kind, wanted[-1].kind) != ("open", "close") or len(found[0].sup) != 1:
        return None
    if not transpose_mark(found[0].sup[0]) or not is_same(wanted[0], found[0], last=True):
        return None
    rest = found[-1]
    whole = is_same_list(list(wanted[1:]), found[1:])
    return Noad(rest.kind, rest.value, rest.at, rest.end, sup=found[0].sup) if whole else None


def is_power(sup: list[Noad]) -> bool:
    """True for a superscript that is no part of a name: a number, or the mark of a transpose."""
    rest = sup[1:] if sup[0].is_sign("-") else sup
    return bool(rest) and (all(n.is_sign(*"0123456789") for n in rest) or transpose_mark(rest[0]) != "")


def split_noads(noads: list[Noad], mark: str) -> list[list[Noad]]:
    """A list cut at a mark."""
    pieces: list[list[Noad]] = [[]]
    for noad in noads:
        if noad.is_sign(mark) or noad.is_command(mark):
            pieces.append([])
        else:
            pieces[-1].append(noad)
    return pieces


def suggest_name(spelled: str) -> str:
    """A name for a symbol that is written with more than letters."""
    words = re.sub(r"\\(mathbf|boldsymbol|bm|mathrm|text|mathcal|left|right)\b", "", spelled)
    words = words.replace("'", "_prime").replace("+", "p").replace("-", "m").replace("|", "_")
    name = re.sub(r"[^A-Za-z0-9]+", "_", words).strip("_")[:60]
    return name if name[:1].isalpha() else f"s_{name}" if name else "symbol"
