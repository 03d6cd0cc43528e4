r"""The second reader: tokens by a regular expression, and precedence climbing.

It shares the tables of names with the first one and nothing else; a formula counts as read when both agree.
"""

from __future__ import annotations

import re
from copy import copy
from math import prod
from typing import Any

from navsym.language.latex.clusters import FRACTIONS, Cluster, ClusterReader, entry_rank, list_clusters
from navsym.language.latex.notation import ACCENTS, CALLS, COMMANDS, CONDITIONS, DOTS, GREEK, IF, REST, Notation
from navsym.language.latex.parts import Part, Refusal, degrees
from navsym.language.latex.tokens import Token, clean, match_brace, plain_word, split_tokens, underscore

CLOSING = {"(": ")", "[": "]", "|": "|", "||": "||"}
CLOSING |= {f"{mark}<": f">{mark}" for mark in ("|", "||", "floor", "angle")} | {"{<": ">}"}
MARKS = {r"\cdot": ".", r"\times": "x", r"\otimes": "ox", "/": "/", "*": "*", r"\ast": "*"}
TRANSPOSES = {r"\top": "top", r"\intercal": "top", "T": "T"}


def climb(text: str, notation: Notation) -> Part:
    """The parts of one side of a formula. Raises Refusal."""
    climber = Climber(clean(text), notation, len(text))
    part = climber.climb(0)
    if climber.place < len(climber.tokens):
        climber.refuse("the end")
    return part


class Climber(ClusterReader):
    """The tokens, and the place among them."""

    def __init__(self, tokens: list[Token], notation: Notation, end: int) -> None:
        entries = [(name, list_clusters(latex)) for name, latex in notation.spellings]
        super().__init__(tokens, end, sorted(entries, key=lambda entry: entry_rank(entry[1]), reverse=True))
        self.notation = notation
        self.bound: frozenset[str] = frozenset()
        self.stops: list[str] = []

    def part_of(self, tokens: list[Token]) -> Part:
        """An argument, read to its end."""
        other = copy(self)
        other.tokens, other.place, other.stops = list(tokens), 0, []
        part = other.climb(0)
        if other.place < len(other.tokens):
            other.refuse("the end of the argument")
        return part

    # -- precedence ------------------------------------------------------------------------

    def climb(self, floor: int) -> Part:
        """Operators that bind at least as tightly as ``floor``: 0 sums, 1 products."""
        at = self.tokens[self.place].at if self.place < len(self.tokens) else self.end
        sign = self.look() if floor == 0 and self.look() in ("+", "-") and self.look(1) not in ("_", "^") else ""
        self.place += bool(sign)
        left = self.climb(1) if floor == 0 else self.operand()
        left = Part("-", (left,), at) if sign == "-" else left
        while True:
            token = self.look()
            if floor == 0 and token in ("+", "-"):
                self.place += 1
                right = self.climb(1)
                right = Part("-", (right,), right.at) if token == "-" else right
                left = Part("+", (*(left.args if left.head == "+" else (left,)), right), at)
            elif floor == 1 and not self.is_end():
                mark = MARKS.get(token, "")
                if mark == "x" and self.look(1) in (")", "]", ">floor"):
                    return left
                self.place += bool(mark)
                right = self.operand()
                left = Part("*", (*(left.args if left.head == "*" else (left,)), mark, right), at)
            else:
                return left

    def is_end(self) -> bool:
        """True behind the last factor of a product."""
        token = self.look()
        if token in ("", "+", "-", ",", ";", ")", "]", "}") or token[:1] == ">":
            return True
        return token in self.stops or ("d" in self.stops and self.is_differential(self.place))

    def operand(self) -> Part:
        """One factor."""
        self.open_braces()
        token = self.look()
        if not token or self.is_end():
            self.refuse("a factor")
        entry = self.entry()
        if entry is not None:
            name, found, power = entry
            if name == "eye":
                self.place = found[-1].after
                return self.raised(Part("eye", ("?",), found[0].base[0].at), power)
            if name in CALLS and name not in self.notation:
                return self.function(CALLS[name], found[-1])
            at = found[0].base[0].at if found[0].base else self.tokens[self.place].at
            self.place = found[-1].after
            return self.raised(Part("name", (name,), at), power)
        if token in CLOSING:
            return self.enclosed()
        if token.isdigit() or token == ".":
            return self.numeral()
        if token.startswith("\\begin"):
            return self.table()
        if token in FRACTIONS:
            return self.quotient()
        if landau := self.landau():
            return landau
        return self.symbol()

    def landau(self) -> Part | None:
        """``O(x^k)``, unless the letter is a declared name."""
        here = self.cluster(self.place)
        letters = [t.text for t in here.base if t.text not in "{}"]
        plain = letters == ["O"] and "O" not in self.notation
        if here.sub or here.sup or self.look_at(here.after) != "(" or not (plain or letters == [r"\mathcal", "O"]):
            return None
        at, self.place = here.base[0].at, here.after
        return Part("order", tuple(self.listed()), at)

    def open_braces(self) -> None:
        """Drop braces around what needs none."""
        while self.look() == "{":
            stop = match_brace(self.tokens, self.place)
            if stop == self.place + 1 or self.look_at(stop + 1) not in ("_", "^"):
                if stop == self.place + 1 and self.look_at(stop + 1) in ("_", "^"):
                    return
                del self.tokens[stop], self.tokens[self.place]
                continue
            inner = self.tokens[self.place + 1 : stop]
            one = self.cluster(self.place + 1)
            scripts = self.cluster_scripts(stop + 1)
            double = (one.sub and scripts[0]) or (one.sup and scripts[1])
            if one.after == stop and double:
                return
            closing = CLOSING.get(inner[0].text, "")
            bracketed = bool(closing) and match_brace(self.tokens, self.place + 1, inner[0].text, closing) == stop - 1
            has_brackets = any(t.text in CLOSING or t.text in CLOSING.values() for t in inner)
            bold = self.tokens[self.place].bold and not has_brackets
            if one.after != stop and not bracketed and not bold:
                self.refuse("a script on one symbol")
            del self.tokens[stop], self.tokens[self.place]

    # -- symbols ---------------------------------------------------------------------------

    def symbol(self) -> Part:
        """A name, a function, a sum, or a command with arguments."""
        here = self.cluster(self.place)
        token = here.base[0]
        text = token.text
        command = text[1:] if text[:1] == "\\" and not token.word else ""
        if command in COMMANDS or (token.word and text in CALLS and text not in self.notation):
            return self.function("log?" if command == "log" else CALLS[command or text], here)
        if command in ("sum", "prod"):
            return self.repeated("sum" if command == "sum" else "product", here)
        if command == "int":
            return self.integral(here)
        if command == "lim":
            return self.limit(here)
        if command in DOTS:
            return self.dotted(here, DOTS[command])
        if command == "sqrt":
            return self.root(here)
        if command in ("pi", "infty") and not here.sub:
            self.place = here.after
            return self.raised(Part("num", ("pi" if command == "pi" else "oo",), token.at), here.sup)
        if text == "{" and len(here.base) > 2:
            self.place = here.after
            return self.raised(Part("()", ("{", self.part_of(here.base[1:-1])), token.at), here.sup)
        if text == "e" and here.sup and not here.sub and "e" not in self.notation and len(here.base) == 1:
            self.place = here.after
            return Part("call", ("exp", None, True, self.part_of(here.sup)), token.at)
        return self.letters(here)

    def letters(self, here: Cluster) -> Part:
        """A letter, or letters side by side that are one name."""
        run = self.letter_run()
        if len(run) > 1:
            last = self.cluster(run[-1])
            whole = "".join(self.tokens[at].text for at in run) + underscore(last.sub)
            each = [self.meaning(at) is not None for at in run]
            if all(each) and whole in self.notation:
                self.refuse("one meaning")
            if not all(each):
                if whole not in self.notation:
                    self.refuse("a declared name")
                self.place = last.after
                return self.raised(Part("name", (whole,), here.base[0].at), last.sup)
        found = self.meaning(self.place)
        if found is None:
            self.refuse("a declared name")
        self.place = here.after
        return self.raised(found, here.sup)

    def letter_run(self) -> list[int]:
        """Places of letters side by side, up to the first with a script."""
        run: list[int] = []
        for at in range(self.place, len(self.tokens)):
            token = self.tokens[at]
            if len(token.text) != 1 or token.word or not (token.text.isascii() and token.text.isalpha()):
                break
            before = self.tokens[at - 1]
            if run and (before.end != token.at or before.bold != token.bold):
                break
            if run and "d" in self.stops and token.text == "d" and "d" not in self.notation:
                break
            run.append(at)
        return run

    def meaning(self, place: int) -> Part | None:
        """A declared name, an index of a vector, an identity or nothing."""
        kept, self.place = self.place, place
        try:
            entry = self.entry()
        finally:
            self.place = kept
        here = self.cluster(place)
        token = here.base[0]
        if entry is not None:
            return Part("eye", ("?",), token.at) if entry[0] == "eye" else Part("name", (entry[0],), token.at)
        word = plain_word(token)
        if word is None or len(here.base) != 1:
            return None
        if word == "e" and here.sup and "e" not in self.notation:
            return Part("num", ("1",), token.at)
        name = word + underscore(here.sub)
        if (here.sub is None or underscore(here.sub)) and (name in self.notation or name in self.bound):
            return Part("name", (name,), token.at)
        subscript = "".join(t.text for t in here.sub or ())
        if word in self.notation and self.notation.shapes[word] and subscript:
            pieces = subscript.split(",")
            good = all(re.fullmatch("[1-9][0-9]*", p) or p in self.bound for p in pieces)
            if good and len(pieces) == (1 if self.notation.is_vector(word) else 2):
                return Part("index", (word, *pieces), token.at)
        size = subscript.split(r"\times")
        if word == "I" and token.bold and "I" not in self.notation and size[0] == size[-1] and len(size) < 3:
            return Part("eye", (size[0],), token.at) if re.fullmatch("[1-9][0-9]?|[a-z]", size[0]) else None
        return None

    # -- what follows a symbol ---------------------------------------------------------------

    def raised(self, base: Part, sup: list[Token] | None) -> Part:
        """A base with its superscript."""
        if not sup:
            return base
        return Part("^", (base, self.exponent(sup)), base.at)

    def exponent(self, sup: list[Token]) -> Part:
        """A power, or a mark."""
        sup = [t for t in sup if t.text not in "{}"] if len(sup) <= 4 and "\\frac" not in sup[0].text else sup
        texts = tuple(t.text for t in sup)
        sign, last = ("-", sup[-1]) if len(sup) == 2 and texts[0] == "-" else ("", sup[-1])
        if len(sup) == 1 or sign:
            mark = "top" if last.word and last.text == "T" else TRANSPOSES.get(last.text, "")
            if mark:
                return Part("mark", (sign + mark,), sup[0].at)
        if texts in (("*",), (r"\ast",)):
            return Part("mark", ("*",), sup[0].at)
        if texts in ((r"\times",), (r"\wedge",)):
            return Part("mark", ("skew",), sup[0].at)
        if texts == (r"\mathsf", "T") or texts == ("-", r"\mathsf", "T"):
            return Part("mark", ("top" if len(texts) == 2 else "-top",), sup[0].at)
        if texts[0] in ("(", "[", "'"):
            raise Refusal(sup[0].at, "a power", "an index", "use [latex]")
        return self.part_of(sup)

    def enclosed(self) -> Part:
        """Brackets and bars."""
        opening, at = self.look(), self.tokens[self.place].at
        self.place += 1
        outer = self.stops
        bars = [s for s in outer if s in ("|", "||")]
        if opening in ("|", "||") and bars:
            self.refuse("bars that are not nested", at)
        if opening == "{<" and [t.text for t in self.tokens[self.place : self.place + 7]] == [r"\begin", "{", *"array"]:
            return self.braced_cases(at)
        self.stops = [opening] if opening in ("|", "||") else []
        items = self.climb_items() if opening in ("(", "[", "angle<") else [self.climb(0)]
        self.stops, inner = outer, items[0]
        crossed = self.look() == r"\times"
        self.place += crossed
        if self.look() != CLOSING[opening]:
            self.refuse(CLOSING[opening])
        sub, sup, self.place = self.cluster_scripts(self.place + 1)
        subscript = [t.text for t in sub or ()]
        if len(items) > 1 or opening == "angle<":
            if crossed or sub or (opening == "angle<" and len(items) != 2):
                self.refuse("a list or an inner product", at)
            head = Part("inner", tuple(items), at) if opening == "angle<" else Part("list", (opening, *items), at)
            return self.raised(head, sup)
        crossed |= opening == "floor<" and sub is None and self.notation.has_skew_floor
        if (crossed or subscript == [r"\times"]) and opening in ("(", "[", "floor<"):
            return self.raised(Part("skew", (inner,), at), sup)
        if crossed or (sub and not (subscript == ["2"] and opening[:2] == "||")):
            self.refuse("a bracket without subscript", at)
        kinds = {"|": "abs", "|<": "abs", "||": "norm", "||<": "norm", "floor<": "floor"}
        part = Part(kinds[opening], (inner,), at) if opening in kinds else Part("()", (opening, inner), at)
        return self.raised(part, sup)

    def braced_cases(self, at: int) -> Part:
        """Behind a brace: an array of cases, and the mark of no bracket."""
        part = self.table()
        if part.head != "cases" or self.look() != ">cases":
            self.refuse("cases", at)
        sup, self.place = self.cluster_scripts(self.place + 1)[1:]
        return self.raised(part, sup)

    def list_cases(self, rows: list[list[list[Token]]], at: int) -> Part:
        """Values and conditions, the last one for all the rest."""
        parts: list[Part] = []
        if any(len(row) != 2 or not all(row) for row in rows):
            self.refuse("a value and its condition in each row", at)
        for value, words in rows:
            parts.append(self.part_of(value[:-1] if value[-1].text == "," else value))
            words = words[:-1] if words[-1].text in (".", ",") else words
            if [t.text for t in words if t.word and t.text in REST] and len(words) == 1:
                break
            words = words[1:] if words and words[0].word and words[0].text in IF else words
            parts.append(self.comparison(words, at))
        if len(parts) != 2 * len(rows) - 1 or len(rows) < 2:
            self.refuse("a last row for all the rest", at)
        return Part("cases", tuple(parts), at)

    def comparison(self, tokens: list[Token], at: int) -> Part:
        """A comparison of two or three sides."""
        args: list[Any] = []
        rest: list[Token] = []
        for token in [*tokens, Token("", at, at)]:
            sign = CONDITIONS.get(token.text.lstrip("\\")) if not token.word else None
            if sign or not token.text:
                args += [self.part_of(rest), *([sign] if sign else [])]
                rest = []
            else:
                rest.append(token)
        if len(args) not in (3, 5) or (len(args) == 5 and (args[1][0] != args[3][0] or args[1][0] not in "<>")):
            self.refuse("one comparison", at)
        return Part("cond", tuple(args), at)

    def numeral(self) -> Part:
        """Digits side by side."""
        start = self.place
        while self.look().isdigit() or self.look() == ".":
            self.place += 1
            if self.place < len(self.tokens) and self.tokens[self.place].at != self.tokens[self.place - 1].end:
                break
        digits, first = self.tokens[start : self.place], self.tokens[start]
        text = "".join(t.text for t in digits)
        if not re.fullmatch(r"\d*\.?\d+", text):
            self.refuse("a number", first.at)
        if self.look() == "!" and text.isdigit() and int(text) <= 20 and self.look(1) not in ("_", "^", "'"):
            self.place += 1
            text = str(prod(range(2, int(text) + 1)))
            return Part("num", (text,), first.at)
        sub, sup, self.place = self.cluster_scripts(self.place)
        if sub:
            size = "".join(t.text for t in sub).split(r"\times")
            is_sized = len(size) == 2 and all(re.fullmatch("[1-9][0-9]?|[a-z]", s) for s in size)
            if text != "0" or not first.bold or not is_sized:
                self.refuse("a number without subscript", first.at)
            return self.raised(Part("zeros", tuple(size), first.at), sup)
        if [t.text for t in sup or ()] == [r"\circ"]:
            return degrees(text, first.at)
        return self.raised(Part("num", (text,), first.at), sup)

    def function(self, name: str, here: Cluster) -> Part:
        """A function and what it is taken of."""
        at, power = here.base[0].at, self.exponent(here.sup) if here.sup else None
        if here.sub:
            base = "".join(t.text for t in here.sub)
            if name not in ("log", "log?") or base not in ("2", "10") or power:
                self.refuse("a function without subscript")
            name = f"log_{base}"
        self.place = here.after
        self.open_braces()
        if self.look() in ("(", "[", "{<"):
            return Part("call", (name, power, True, *self.listed()), at)
        if self.look().isdigit():
            number = self.numeral()
            self.open_braces()
            following = self.look() if number.head != "frac" else ""  # degrees end the argument
            named = following[:1].isalpha() or following in (*FRACTIONS, r"\sqrt", r"\pi")
            named |= following[:1] == "\\" and following[1:] in (*GREEK, *ACCENTS, *DOTS)
            if self.is_end() or following in MARKS or not named:
                return Part("call", (name, power, False, number), at)
            product = Part("*", (number, "", self.operand()), number.at)
            return Part("call", (name, power, False, product), at)
        if self.is_end():
            self.refuse(f"the argument of {name}")
        return Part("call", (name, power, False, self.operand()), at)

    def listed(self) -> list[Part]:
        """Arguments in parentheses, commas between them."""
        closing, outer = CLOSING[self.look()], self.stops
        self.place += 1
        self.stops = []
        found = self.climb_items()
        self.stops = outer
        if self.look() != closing or self.look(1) in ("_", "^"):
            self.refuse(closing)
        self.place += 1
        return found

    def climb_items(self) -> list[Part]:
        """Expressions with commas between them."""
        found = [self.climb(0)]
        while self.look() == ",":
            self.place += 1
            found.append(self.climb(0))
        return found

    def dotted(self, here: Cluster, order: int) -> Part:
        """A time derivative of a name."""
        at = here.base[0].at
        inner = here.base[1:]
        inner = inner[1:-1] if inner[0].text == "{" else inner
        scripts = [Token("_", at, at), Token("{", at, at), *here.sub, Token("}", at, at)] if here.sub else []
        if here.sup:
            other = copy(self)
            raised = [Token("^", at, at), Token("{", at, at), *here.sup, Token("}", at, at)]
            other.tokens, other.place = [*inner, *scripts, *raised], 0
            entry = other.entry()
            if entry is not None and entry[2] is None and entry[1][-1].after == len(other.tokens):
                self.place = here.after
                return Part("dot", (Part("name", (entry[0],), at), order), at)
        named = self.part_of([*inner, *scripts])
        if named.head != "name":
            self.refuse("a dot above a name", at)
        self.place = here.after
        return self.raised(Part("dot", (named, order), at), here.sup)

    def root(self, here: Cluster) -> Part:
        """A root."""
        inner, index = here.base[1:], []
        if inner[0].text == "[":
            stop = next(at for at, t in enumerate(inner) if t.text == "]")
            index, inner = inner[1:stop], inner[stop + 1 :]
        inner = inner[1:-1] if inner[0].text == "{" else inner
        if here.sub:
            self.refuse("a root without subscript")
        args = (self.part_of(inner), self.part_of(index)) if index else (self.part_of(inner),)
        self.place = here.after
        return self.raised(Part("sqrt", args, here.base[0].at), here.sup)

    # -- calculus ----------------------------------------------------------------------------

    def quotient(self) -> Part:
        """A fraction or a derivative."""
        at = self.tokens[self.place].at
        above, place = self.group(self.place + 1)
        below, place = self.group(place)
        sub, sup, place = self.cluster_scripts(place)
        if sub or not above or not below:
            self.refuse("a fraction", at)
        letter = self.letter_of(above)
        if not letter or letter != self.letter_of(below):
            self.place = place
            return self.raised(Part("frac", (self.part_of(above), self.part_of(below)), at), sup)
        order, rest = self.split_order(above)
        variable, power = self.split_variable(below[1:])
        if power != order:
            self.refuse("one order", at)
        self.place = place
        if rest:
            return self.raised(Part("diff", (self.part_of(rest), variable, order, letter, True), at), sup)
        if sup:
            self.refuse("an operator without power", at)
        return Part("diff", (self.operand(), variable, order, letter, False), at)

    def letter_of(self, tokens: list[Token]) -> str:
        """``p`` for a partial derivative, ``d`` for another one."""
        if tokens[0].text == r"\partial":
            return "p"
        if tokens[0].text == "d" and (tokens[0].word or "d" not in self.notation):
            return "d" if len(tokens) == 1 or tokens[1].text != "_" else ""
        return ""

    def split_order(self, tokens: list[Token]) -> tuple[int, list[Token]]:
        """The order behind the letter, and what follows it."""
        if len(tokens) > 2 and tokens[1].text == "^":
            stop = 5 if tokens[2].text == "{" else 3
            digit = tokens[3] if tokens[2].text == "{" else tokens[2]
            if digit.text in "23456789" and (stop == 3 or tokens[4].text == "}"):
                return int(digit.text), tokens[stop:]
            self.refuse("an order from 2 to 9", digit.at)
        return 1, tokens[1:]

    def split_variable(self, tokens: list[Token]) -> tuple[Part, int]:
        """The variable of a derivative and its order."""
        power = 1
        raised = [at for at, t in enumerate(tokens) if t.text == "^" and at]
        behind = [t.text for t in tokens[raised[-1] + 1 :] if t.text not in "{}"] if raised else []
        if len(behind) == 1 and behind[0].isdigit():
            power, rest = self.split_order([tokens[0], *tokens[raised[-1] :]])
            tokens = tokens[: raised[-1]] + rest
        if not tokens:
            self.refuse("a variable")
        named = self.part_of(tokens)
        if named.head not in ("name", "index"):
            self.refuse("one variable", tokens[0].at)
        return named, power

    def is_differential(self, place: int) -> bool:
        """True before ``d x``."""
        token = self.tokens[place]
        following = self.tokens[place + 1] if place + 1 < len(self.tokens) else None
        if following is None or token.text != "d" or plain_word(following) is None:
            return False
        return token.word or "d" not in self.notation

    def repeated(self, name: str, here: Cluster) -> Part:
        """A sum or a product over an index."""
        at, sub = here.base[0].at, here.sub or []
        if len(sub) < 3 or sub[1].text != "=" or not here.sup:
            self.refuse("an index with both ends", at)
        index = plain_word(sub[0])
        if index is None:
            self.refuse("one letter as the index", at)
        start, end = self.part_of(sub[2:]), self.part_of(here.sup or [])
        self.place = here.after
        outer, self.bound = self.bound, self.bound.union((index,))
        body = self.climb(1)
        self.bound = outer
        return Part("sum", (name, body, index, start, end), at)

    def limit(self, here: Cluster) -> Part:
        """A limit."""
        at, sub = here.base[0].at, here.sub or []
        arrows = [place for place, token in enumerate(sub) if token.text in (r"\to", r"\rightarrow")]
        if len(arrows) != 1 or arrows[0] == 0 or here.sup:
            self.refuse("a limit with its point", at)
        moving, outer = sub[: arrows[0]], self.bound
        name = plain_word(moving[0])
        script = [t for t in moving[2:] if t.text not in "{}"] if len(moving) > 2 and moving[1].text == "_" else []
        if name is not None and (len(moving) == 1 or underscore(script)):
            self.bound = outer.union((name + underscore(script),))
        by, end = self.part_of(moving), self.part_of(sub[arrows[0] + 1 :])
        if by.head != "name":
            self.refuse("one name that moves", at)
        self.place = here.after
        body = self.climb(1)
        self.bound = outer
        return Part("limit", (body, by, end), at)

    def integral(self, here: Cluster) -> Part:
        """An integral with both ends."""
        at = here.base[0].at
        start, end = self.part_of(here.sub or []), self.part_of(here.sup or [])
        self.place = here.after
        self.stops, outer = [*self.stops, "d"], self.bound
        places = [p for p in range(self.place, len(self.tokens) - 1) if self.is_differential(p)]
        clusters = [self.cluster(p + 1) for p in places]
        self.bound = outer.union(f"{plain_word(c.base[0])}{underscore(c.sub)}" for c in clusters)
        body = self.climb(0)
        if self.place >= len(self.tokens) or not self.is_differential(self.place):
            self.refuse("the differential")
        self.stops = self.stops[:-1]
        variable = self.cluster(self.place + 1)
        found = None if variable.sup else self.meaning(self.place + 1)
        self.bound = outer
        if found is None:
            self.refuse("the variable of the integral")
        self.place = variable.after
        return Part("integral", (body, found, start, end), at)

    def table(self) -> Part:
        r"""A matrix: its source between ``\begin`` and ``\end``, cut at ``\\`` and ``&``."""
        at = self.tokens[self.place].at
        opening = self.named_environment(self.place)
        stop = match_brace(self.tokens, self.place, r"\begin", r"\end")
        body = self.tokens[self.place + 3 + len(opening) : stop]
        if opening == "array":
            body = body[match_brace(body, 0) + 1 :]
        rows = [split_tokens(row, "&") for row in split_tokens(body, "\\\\")]
        rows = [[[t for t in cell if t.text != r"\hline"] for cell in row] for row in rows]
        rows = [[cell for cell in row if [t.text for t in cell] not in (["|"], ["||"])] for row in rows]
        rows = [row for row in rows if any(row)]
        cells = [cell for row in rows for cell in row]
        if opening == "cases" or (opening == "array" and self.look_at(self.place - 1) == "{<"):
            part = self.list_cases(rows, at)
            sup, self.place = self.cluster_scripts(stop + 3 + len(opening))[1:]
            return self.raised(part, sup)
        if len({len(row) for row in rows}) != 1 or not all(cells):
            self.refuse("a whole matrix", at)
        known = ("matrix", "pmatrix", "bmatrix", "vmatrix", "smallmatrix", "array")
        if opening not in known or self.named_environment(stop) != opening:
            self.refuse("a matrix", at)
        part = Part("matrix", (len(rows), *map(self.part_of, cells)), at)
        part = Part("call", ("det", None, True, part), at) if opening == "vmatrix" else part
        sub, sup, self.place = self.cluster_scripts(stop + 3 + len(opening))
        if sub:
            self.refuse("a matrix without subscript", at)
        return self.raised(part, sup)

    def named_environment(self, place: int) -> str:
        r"""The name behind ``\begin`` or ``\end``."""
        stop = match_brace(self.tokens, place + 1)
        return "".join(t.text for t in self.tokens[place + 2 : stop])
