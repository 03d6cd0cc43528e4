r"""The first reader: recursive descent over lists of symbols with scripts."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from math import factorial
from typing import Any

from navsym.language.latex.mathlists import MATRICES, Noad, list_noads
from navsym.language.latex.notation import CALLS, COMMANDS, CONDITIONS, DOTS, IF, REST, Notation
from navsym.language.latex.parts import Part, Refusal, degrees, join_factors, join_terms
from navsym.language.latex.symbols import POWER, SymbolReader, is_power, split_noads, suggest_name, transpose_mark

PAIRS = {"cases": "cases", "(": ")", "[": "]", "|": "|", "||": "||", "floor": "floor", "{": "}", "{<": ">}",
         "langle": "langle"}  # fmt: skip
BIG = {"sum": "sum", "prod": "product"}


def descend(text: str, notation: Notation, faces: dict[str, set[bool]] | None = None) -> Part:
    """The parts of one side of a formula. Raises Refusal with the place in the text.

    faces : filled with name -> whether it is written in bold type, for names that stand in no table
    """
    noads = list_noads(text)
    reader = Descent(text, notation, noads, {} if faces is None else faces)
    part = reader.expression()
    if reader.place < len(noads):
        reader.refuse("an operator or the end", "remove it")
    return part


class Descent(SymbolReader):
    """A list of symbols, and the place in it."""

    def expression(self) -> Part:
        """Terms with their signs."""
        terms: list[Part] = []
        while True:
            noad, sign = self.noad, ""
            if noad and noad.is_sign("+", "-") and not noad.has_scripts:
                sign = noad.value
                self.place += 1
            elif terms:
                break
            at = noad.at if noad else 0
            term = self.term()
            terms.append(Part("-", (term,), at) if sign == "-" else term)
        return join_terms(terms)

    def ends(self) -> bool:
        """True where a product ends."""
        noad = self.noad
        if noad is None or noad.kind == "close" or noad.is_sign("+", "-", ",", ";"):
            return True
        if noad.kind == "bar":
            return noad.value in self.bars
        return self.integrals > 0 and self.is_differential()

    def term(self) -> Part:
        """Factors with the marks between them."""
        factors: list[Any] = [self.factor()]
        while not self.ends():
            mark = self.mark()
            if mark is None:
                break
            factors += [mark, self.factor()]
        return join_factors(factors)

    def mark(self) -> str | None:
        r"""The mark of a product, an empty one where nothing is written; None for the cross of ``[v \times]``."""
        noad = self.noad
        if noad is None or noad.has_scripts:
            return ""
        marks = {"cdot": ".", "times": "x", "otimes": "ox", "ast": "*"}
        mark = marks.get(noad.value, "") if noad.kind == "cmd" else noad.value if noad.is_sign("/", "*") else ""
        if mark == "x" and self.place + 1 < len(self.noads) and self.noads[self.place + 1].kind == "close":
            return None
        self.place += bool(mark)
        return mark

    def factor(self) -> Part:
        """A symbol with its powers."""
        noad = self.noad
        if noad is None:
            self.refuse("a number, a name or a group", "complete the formula")
        named = self.spelling()
        if named is not None:
            part, last = named
            return self.power(part, last)
        if noad.kind == "open" or (noad.kind == "bar" and noad.value not in self.bars):
            return self.bracket(noad)
        if noad.kind == "sym" and (noad.value.isdigit() or noad.value == "."):
            return self.number()
        if self.is_landau(noad):
            return self.landau(noad)
        if noad.kind == "env":
            self.place += 1
            return self.power(self.cases(noad) if noad.value[0] == "cases" else self.matrix(noad), noad)
        if noad.kind == "arg":
            return self.command(noad)
        if noad.kind == "cmd":
            return self.plain_command(noad)
        if noad.kind == "word" and noad.value in CALLS and noad.value not in self.notation:
            return self.call(CALLS[noad.value])
        return self.name(noad)

    def is_landau(self, noad: Noad) -> bool:
        r"""True for O, plain, upright or ``\mathcal``, before a parenthesis, where it is no declared name."""
        following = self.noads[self.place + 1] if self.place + 1 < len(self.noads) else None
        if following is None or following.kind != "open" or following.value != "(" or noad.has_scripts:
            return False
        if noad.kind == "arg" and noad.value == "mathcal":
            return len(noad.args[0]) == 1 and noad.args[0][0].is_sign("O") and not noad.args[0][0].has_scripts
        return noad.kind in ("sym", "word") and noad.value == "O" and "O" not in self.notation

    def landau(self, noad: Noad) -> Part:
        """``O(x^k)``: terms of an order."""
        self.place += 1
        opening = self.noads[self.place]
        return Part("order", tuple(self.arguments(opening)), noad.at)

    # -- powers and brackets --------------------------------------------------------------

    def exponent(self, sup: list[Noad]) -> Part:
        """A superscript."""
        if not sup:
            raise Refusal(self.noads[self.place - 1].at, "a power", "empty braces", "write it")
        first, last = sup[0], sup[-1]
        minus = len(sup) == 2 and first.is_sign("-")
        mark = transpose_mark(last) if len(sup) == 1 or minus else ""
        if mark:
            return Part("mark", ("-" * minus + mark,), first.at)
        if len(sup) == 1 and (last.is_sign("*") or last.is_command("ast")):
            return Part("mark", ("*",), first.at)
        if len(sup) == 1 and last.is_command("times", "wedge"):
            return Part("mark", ("skew",), first.at)
        if self.is_index(sup):
            raise Refusal(first.at, "a power", "an index", "write the name with its index in [latex]")
        return self.inside(sup)

    def bracket(self, opening: Noad) -> Part:
        """What stands in brackets or bars, with its powers."""
        self.place += 1
        is_bar = opening.kind == "bar" or opening.value in ("|", "||")
        if is_bar:
            if opening.kind == "bar" and self.bars:
                raise Refusal(opening.at, "bars that are not nested", "bars inside bars", r"write \left| and \right|")
            self.bars.append(opening.value)
        kept, self.integrals = self.integrals, 0
        outer, self.bars = self.bars, self.bars if is_bar and opening.kind == "bar" else []
        noad = self.noad
        is_array = noad is not None and noad.kind == "env" and noad.value[0] == "array" and not noad.has_scripts
        has_cases = opening.value == "{<" and is_array
        items = [self.cases(self.noads[self.place])] if has_cases else [self.expression()]
        while opening.value in ("(", "[", "langle") and self.noad is not None and self.noad.is_sign(","):
            self.place += 1
            items.append(self.expression())
        self.bars, self.integrals = outer, kept
        if is_bar:
            self.bars.pop()
        crossed = self.noad is not None and self.noad.is_command("times")
        self.place += crossed
        closing = self.noad
        wanted = "cases" if has_cases else PAIRS[opening.value]
        if closing is None or closing.kind not in ("close", "bar") or closing.value != wanted:
            self.refuse(f"the bracket that closes {self.text[opening.at : opening.end]}", "close it")
        self.place += 1
        if len(items) > 1 or opening.value == "langle":
            return self.close_list(opening, items, closing, crossed)
        if has_cases:
            return self.power(items[0], closing)
        return self.close(opening, items[0], closing, crossed)

    def close_list(self, opening: Noad, items: list[Part], closing: Noad, crossed: bool) -> Part:
        """Entries with commas between them: a column, or an inner product."""
        if crossed or closing.sub or (opening.value == "langle" and len(items) != 2):
            raise Refusal(opening.at, "a list without subscript, or an inner product of two", "others", "write entries")
        if opening.value == "langle":
            return self.power(Part("inner", tuple(items), opening.at), closing)
        return self.power(Part("list", (opening.value, *items), opening.at), closing)

    def close(self, opening: Noad, inner: Part, closing: Noad, crossed: bool) -> Part:
        """A group by its bracket and by the subscript of the closing one."""
        kind = opening.value
        crossed |= kind == "floor" and closing.sub is None and self.notation.has_skew_floor
        crossed |= closing.sub is not None and len(closing.sub) == 1 and closing.sub[0].is_command("times")
        part = Part("()", (kind, inner), opening.at)
        if crossed and kind in ("[", "(", "floor"):
            part = Part("skew", (inner,), opening.at)
        elif closing.sub and kind == "||" and len(closing.sub) == 1 and closing.sub[0].is_sign("2"):
            part = Part("norm", (inner,), opening.at)
        elif closing.sub or crossed:
            raise Refusal(closing.at, "a bracket without subscript", "one", "write it as a name in [latex]")
        elif kind in ("|", "||", "floor"):
            part = Part({"|": "abs", "||": "norm", "floor": "floor"}[kind], (inner,), opening.at)
        return self.power(part, closing)

    def number(self) -> Part:
        """Digits side by side; a number with a power ends there."""
        start = noad = self.noads[self.place]
        text = ""
        while noad.kind == "sym" and (noad.value.isdigit() or noad.value == "."):
            text += noad.value
            self.place += 1
            following = self.noad
            if noad.has_scripts or following is None or following.at != noad.end:
                break
            noad = following
        last = self.noads[self.place - 1]
        if self.noad is not None and self.noad.is_sign("!") and text.isdigit() and not last.has_scripts:
            if int(text) > 20 or self.noad.has_scripts:
                self.refuse("a factorial up to 20!", "write the number")
            text, last = str(factorial(int(text))), self.noad
            self.place += 1
        if not re.fullmatch(r"[0-9]*\.?[0-9]+", text) or start.before != (None, None):
            raise Refusal(start.at, "a number", text, "correct it")
        if last.sub is None and last.sup and len(last.sup) == 1 and last.sup[0].is_command("circ"):
            return degrees(text, start.at)
        if last.sub is not None:
            size = self.sizes(last.sub)
            if text == "0" and last.bold and len(size) == 2:
                return self.power(Part("zeros", tuple(size), start.at), last)
            if text in ("0", "1") and last.bold:
                spelled = self.balance(self.text[start.at if start.shown < 0 else start.shown : last.end], last)
                spelled = POWER.sub(r"\1", spelled) if last.sup and is_power(last.sup) else spelled
                return self.power(Part("unknown", (suggest_name(spelled), spelled), start.at), last)
            raise Refusal(start.at, "a number without subscript", self.text[start.at : last.end], "name it in [latex]")
        return self.power(Part("num", (text,), start.at), last)

    # -- commands -------------------------------------------------------------------------

    def plain_command(self, noad: Noad) -> Part:
        """A command without arguments."""
        name = str(noad.value)
        if name in COMMANDS:
            return self.call(CALLS[name])
        if name == "pi" and noad.sub is None:
            self.place += 1
            return self.power(Part("num", ("pi",), noad.at), noad)
        if name == "infty" and not noad.has_scripts:
            self.place += 1
            return Part("num", ("oo",), noad.at)
        if name in BIG:
            return self.big(noad, BIG[name])
        if name == "int":
            return self.integral(noad)
        if name == "lim":
            return self.limit(noad)
        return self.name(noad)

    def call(self, name: str) -> Part:
        """A function: what is in parentheses behind it, or one factor with a number before it."""
        noad = self.noads[self.place]
        self.place += 1
        power = self.exponent(noad.sup) if noad.sup else None
        if noad.sub is not None:
            base = "".join(str(n.value) for n in noad.sub)
            if name != "log" or base not in ("2", "10") or power:
                got = self.text[noad.at : noad.end]
                raise Refusal(noad.at, "a function without subscript", got, "write it otherwise")
            name = f"log_{base}"
        elif noad.is_command("log"):
            name = "log?"
        following = self.noad
        if following is not None and following.kind == "open" and following.value in ("(", "[", "{<"):
            return Part("call", (name, power, True, *self.arguments(following)), noad.at)
        factors: list[Any] = []
        if following is not None and following.kind == "sym" and following.value.isdigit():
            factors = [self.number()]
            behind = self.noad  # in \sin 2x a name
            named = behind is not None and (self.base(behind) is not None and behind.value not in CALLS)
            named |= behind is not None and (behind.is_command("pi") or behind.kind == "arg")
            if self.ends() or factors[0].head == "frac" or not named:
                return Part("call", (name, power, False, factors[0]), noad.at)
            factors.append("")
        if following is None or self.ends():
            self.refuse(f"what {name} is taken of", "write it in parentheses")
        factors.append(self.factor())
        return Part("call", (name, power, False, join_factors(factors)), noad.at)

    def arguments(self, opening: Noad) -> list[Part]:
        """Expressions in parentheses with commas between them."""
        self.place += 1
        kept, self.bars, self.integrals = (self.bars, self.integrals), [], 0
        found = [self.expression()]
        while self.noad is not None and self.noad.is_sign(","):
            self.place += 1
            found.append(self.expression())
        closing = self.noad
        self.bars, self.integrals = kept
        if closing is None or closing.kind != "close" or closing.value != PAIRS[opening.value]:
            self.refuse(f"the bracket that closes {opening.value}", "close it")
        elif closing.has_scripts:
            raise Refusal(closing.at, "a power behind the name of the function", "one behind its argument", "move it")
        self.place += 1
        return found

    def command(self, noad: Noad) -> Part:
        """A command with arguments."""
        name = str(noad.value)
        if name == "frac":
            return self.fraction(noad)
        if name == "sqrt":
            self.place += 1
            inner = [self.inside(arg) for arg in noad.args]
            return self.power(Part("sqrt", tuple(reversed(inner)), noad.at), noad)
        if name in DOTS:
            return self.dotted(noad)
        return self.unknown(noad)

    def dotted(self, noad: Noad) -> Part:
        r"""``\dot x``: a time derivative, of a name with its subscript."""
        (inner,) = noad.args
        if len(inner) != 1 or (inner[0].has_scripts and noad.sub):
            raise Refusal(noad.at, "a dot above one name", "more", "write the derivative as a fraction")
        base = inner[0]
        if noad.sup and not base.sup:
            spelled = self.start([replace(base, sub=base.sub or noad.sub, sup=noad.sup)]).spelling()
            if spelled is not None and not spelled[1].sup:
                self.place += 1
                return Part("dot", (spelled[0], DOTS[noad.value]), noad.at)
        joined = Noad(base.kind, base.value, noad.at, noad.end, base.bold, base.args, base.sub or noad.sub, base.sup)
        begin, behind = base.at if base.shown < 0 else base.shown, self.text[base.end : noad.end].strip()
        joined.spelled = base.spelled or self.text[begin : base.end] + behind.removeprefix("}")  # the name has no dot
        named = self.start([joined]).factor()
        if named.head not in ("name", "unknown"):
            raise Refusal(noad.at, "a dot above a name", "another part", "write the derivative as a fraction")
        self.place += 1
        return self.power(Part("dot", (named, DOTS[noad.value]), noad.at), noad)

    def fraction(self, noad: Noad) -> Part:
        """A quotient, or a derivative."""
        above, below = noad.args
        self.place += 1
        if not above or not below:
            raise Refusal(noad.at, "a numerator and a denominator", "an empty one", "write it")
        letter = self.differential_letter(above[0])
        if letter and letter == self.differential_letter(below[0]):
            return self.power(self.derivative(noad, letter), noad)
        if above[0].is_sign("d") and below[0].is_sign("d") and len(below) > 1:
            raise Refusal(noad.at, "one meaning", "is d a name or a derivative?", r"write \mathrm{d}, or rename d")
        return self.power(Part("frac", (self.inside(above), self.inside(below)), noad.at), noad)

    def differential_letter(self, noad: Noad) -> str:
        r"""``d`` or ``p`` for what stands before a variable in a derivative."""
        if noad.is_command("partial") and noad.sub is None:
            return "p"
        word = noad.kind == "word" and noad.value == "d"
        plain = noad.is_sign("d") and "d" not in self.notation
        return "d" if (word or plain) and noad.sub is None else ""

    def derivative(self, noad: Noad, letter: str) -> Part:
        """``d^n f / d x^n``, or the operator before what it is applied to."""
        above, below = noad.args
        order = self.order(above[0].sup, noad)
        plain = len(below) == 2 and self.base(below[1]) is not None and below[1].before == (None, None)
        if len(below) > 1 and not plain and order == 1 and not below[0].sup:
            by = self.inside(below[1:])
            if by.head not in ("name", "unknown"):
                raise Refusal(noad.at, "one variable and one order", "others", "write one derivative after the other")
            return self.apply_derivative(noad, by, order, letter)
        variable = below[1] if len(below) == 2 else None
        name = self.base(variable) if variable else None
        if variable is None or name is None or self.order(variable.sup, noad) != order or below[0].sup:
            raise Refusal(noad.at, "one variable and one order", "others", "write one derivative after the other")
        found = self.resolve(variable, name)
        return self.apply_derivative(noad, found or self.variable(variable, name), order, letter)

    def apply_derivative(self, noad: Noad, by: Part, order: int, letter: str) -> Part:
        """The derivative of what stands above the line, or behind it."""
        above = noad.args[0]
        if len(above) > 1:
            return Part("diff", (self.inside(above[1:]), by, order, letter, True), noad.at)
        if self.ends():
            self.refuse("what is differentiated", "write it behind the operator")
        return Part("diff", (self.factor(), by, order, letter, False), noad.at)

    def variable(self, noad: Noad, name: str) -> Part:
        """A variable that nobody declared."""
        flat = self.flat_subscript(noad)
        spelled = self.spell(noad)
        return Part("unknown", (name + flat if flat or noad.sub is None else suggest_name(spelled), spelled), noad.at)

    def order(self, sup: list[Noad] | None, noad: Noad) -> int:
        """The order of a derivative."""
        if sup is None:
            return 1
        if len(sup) == 1 and sup[0].is_sign(*"23456789"):
            return int(sup[0].value)
        raise Refusal(noad.at, "an order from 2 to 9", "another one", "write it as digits")

    def big(self, noad: Noad, name: str) -> Part:
        """A sum or a product over an index: all factors behind it."""
        pieces = split_noads(noad.sub or [], "=")
        if len(pieces) != 2 or len(pieces[0]) != 1 or not noad.sup:
            raise Refusal(noad.at, "an index with both ends, such as k=1 and n", "others", "write both ends")
        index = self.base(pieces[0][0])
        if index is None or pieces[0][0].has_scripts:
            raise Refusal(noad.at, "one letter as the index", "another", "rename it")
        start, end = self.inside(pieces[1]), self.inside(noad.sup)
        self.place += 1
        kept, self.bound = self.bound, (*self.bound, index)
        body = self.term()
        self.bound = kept
        return Part("sum", (name, body, index, start, end), noad.at)

    def limit(self, noad: Noad) -> Part:
        """A limit of all factors behind it."""
        pieces = split_noads(noad.sub or [], "to" if any(n.is_command("to") for n in noad.sub or ()) else "rightarrow")
        ends = [n for n in (noad.sub or [])[-1:] if n.sup and len(n.sup) == 1 and n.sup[0].is_sign("+", "-")]
        if ends or any(n.is_command("downarrow", "uparrow") for n in noad.sub or ()):
            raise Refusal(noad.at, "a limit from both sides", "one from one side", r"write 1/x, and x \to \infty")
        if len(pieces) != 2 or not pieces[0] or noad.sup or any(n.is_sign("^", "+", "-") for n in pieces[0]):
            raise Refusal(noad.at, r"a limit with its point, such as \lim_{x \to 0}", "another", "write the point")
        kept, moving = self.bound, pieces[0][0]
        name = self.base(moving) if len(pieces[0]) == 1 and moving.before == (None, None) and not moving.sup else None
        self.bound = (*kept, f"{name}{self.flat_subscript(moving)}") if name else kept
        by, end = self.inside(pieces[0]), self.inside(pieces[1])
        if by.head not in ("name", "unknown"):
            raise Refusal(noad.at, "one name that moves", "others", r"write it in [latex]")
        self.place += 1
        body = self.term()
        self.bound = kept
        return Part("limit", (body, by, end), noad.at)

    def integral(self, noad: Noad) -> Part:
        """An integral with both ends, up to its differential."""
        if not noad.sub or not noad.sup:
            raise Refusal(noad.at, "an integral with both ends", "one without", "write both ends")
        start, end = self.inside(noad.sub), self.inside(noad.sup)
        self.place += 1
        self.integrals += 1
        kept, letters = self.bound, pairwise(self.noads[self.place :])
        self.bound = (*kept, *(str(v.value) + self.flat_subscript(v) for d, v in letters if self.is_before(d, v)))
        body = self.expression()
        if not self.is_differential():
            self.refuse("the differential of the integral", "write d and its variable at the end")
        self.integrals -= 1
        self.place += 1
        variable = self.noad
        name = self.base(variable) if variable else None
        if variable is None or name is None or variable.sup:
            self.refuse("the variable of the integral", "write one name behind d")
        by = self.resolve(variable, name) or self.variable(variable, name)
        self.bound = kept
        self.place += 1
        return Part("integral", (body, by, start, end), noad.at)

    def is_differential(self) -> bool:
        """True before ``d x``."""
        here = self.noads[self.place : self.place + 2]
        return len(here) == 2 and self.is_before(*here)

    def is_before(self, noad: Noad, behind: Noad) -> bool:
        """True for the d before a name."""
        return not noad.has_scripts and self.base(behind) is not None and self.differential_letter(noad) == "d"

    def matrix(self, noad: Noad) -> Part:
        """A matrix, row by row."""
        kind, widths = noad.value
        if len(set(widths)) != 1 or not all(noad.args):
            raise Refusal(noad.at, "rows of one length without gaps", "others", "write every entry")
        if kind not in MATRICES or kind == "Bmatrix" or len(widths) * widths[0] > 400:
            raise Refusal(noad.at, "a matrix", kind, "write it in brackets")
        cells = [self.inside(cell) for cell in noad.args]
        part = Part("matrix", (len(widths), *cells), noad.at)
        return Part("call", ("det", None, True, part), noad.at) if kind == "vmatrix" else part

    def cases(self, noad: Noad) -> Part:
        """Values with their conditions, the last one for all the rest."""
        self.place += noad is self.noad
        widths = noad.value[1]
        if set(widths) != {2} or len(widths) < 2 or not all(noad.args):
            raise Refusal(noad.at, "rows of a value and its condition", "others", "write both")
        parts: list[Part] = []
        for place in range(0, len(noad.args), 2):
            value, words = noad.args[place], noad.args[place + 1]
            value = value[:-1] if value[-1].is_sign(",") else value
            words = words[:-1] if words[-1].is_sign(".", ",") else words
            last = place + 2 == len(noad.args)
            rest = len(words) == 1 and words[0].kind == "word" and words[0].value in REST
            if last != rest:
                expected = r"a last row for all the rest, and no other: \text{otherwise}"
                raise Refusal(noad.at, expected, "others", "write it, or the cases as formulas of their own")
            parts.append(self.inside(value))
            if not last:
                parts.append(self.condition(words[1:] if words[0].kind == "word" and words[0].value in IF else words))
        return Part("cases", tuple(parts), noad.at)

    def condition(self, noads: list[Noad]) -> Part:
        """A comparison, or two in one direction."""
        marks = [n for n in noads if n.kind in ("sym", "cmd") and n.value in CONDITIONS and not n.has_scripts]
        signs = [CONDITIONS[str(n.value)] for n in marks]
        if not 0 < len(marks) < 3 or (len(marks) == 2 and {s[0] for s in signs} not in ({"<"}, {">"})):
            at = noads[0].at if noads else 0
            raise Refusal(at, "one comparison, or two in one direction", "another condition", "write such a one")
        places = [-1, *(noads.index(mark) for mark in marks), len(noads)]
        sides = [self.inside(noads[a + 1 : b]) for a, b in pairwise(places)]
        args = [sides[0], *(piece for pair in zip(signs, sides[1:], strict=True) for piece in pair)]
        return Part("cond", tuple(args), sides[0].at)
