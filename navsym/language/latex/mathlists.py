r"""LaTeX as lists of symbols with their scripts, from the nodes of pylatexenc: what the first reader reads.

Braces around one symbol, spaces, sizes of brackets and the commands of bold type leave no trace but a flag.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import accumulate
from typing import Any

from navsym.core.errors import MissingEngineError
from navsym.language.latex.notation import ACCENTS, BOLD, DOTS, SETTINGS, SIZES, SPACES, SWITCHES, WORDS
from navsym.language.latex.parts import DEPTH, Refusal

MATRICES = ("matrix", "pmatrix", "bmatrix", "Bmatrix", "vmatrix", "smallmatrix", "array", "cases")
BRACKETS = {"(": ("open", "("), ")": ("close", ")"), "[": ("open", "["), "]": ("close", "]"), "|": ("bar", "|")}
#: The same of commands.
DELIMITERS = {
    "lvert": ("open", "|"), "lVert": ("open", "||"), "lfloor": ("open", "floor"), "lbrack": ("open", "["),
    "lparen": ("open", "("), "langle": ("open", "langle"), "{": ("open", "{<"), "rvert": ("close", "|"),
    "rVert": ("close", "||"), "rfloor": ("close", "floor"), "rbrack": ("close", "]"), "rparen": ("close", ")"),
    "rangle": ("close", "langle"), "}": ("close", ">}"), "|": ("bar", "||"), "Vert": ("bar", "||"),
    "vert": ("bar", "|"),
}  # fmt: skip


@dataclass(slots=True)
class Noad:
    """A symbol with its scripts.

    kind, value : ``sym`` a character, ``word``, ``cmd`` a command without arguments, ``arg`` one with them,
                  ``group``, ``env``, ``open``, ``close``, ``bar``
    """

    kind: str
    value: Any
    at: int
    end: int
    bold: bool = False
    args: tuple[list[Noad], ...] = ()
    sub: list[Noad] | None = None
    sup: list[Noad] | None = None
    before: tuple[list[Noad] | None, list[Noad] | None] = (None, None)
    shown: int = -1  # where it begins with the command of bold type before it
    spelled: str = ""  # its LaTeX, where that is no stretch of the text

    def is_command(self, *names: str) -> bool:
        """True for one of these commands without arguments."""
        return self.kind == "cmd" and self.value in names

    def is_sign(self, *signs: str) -> bool:
        """True for one of these characters."""
        return self.kind == "sym" and self.value in signs

    @property
    def is_bar(self) -> bool:
        return (self.kind, self.value) == ("bar", "|")

    @property
    def has_scripts(self) -> bool:
        return self.sub is not None or self.sup is not None


def is_same(wanted: Noad, found: Noad, last: bool = False) -> bool:
    """True when a symbol is written as wanted: bold where that is wanted; the last one may have a power behind it."""
    if (wanted.kind, wanted.value) != (found.kind, found.value) or (wanted.bold and not found.bold):
        return False
    pairs = [(wanted.sub, found.sub), *zip(wanted.before, found.before, strict=True)]
    primes = wanted.sup is None or all(n.is_command("prime") for n in wanted.sup)
    behind = found.sup if wanted.sup is None or not found.sup else found.sup[len(wanted.sup) :]
    if last and primes and behind is not found.sup and not (behind and behind[0].is_command("prime")):
        pairs.append((wanted.sup, (found.sup or [])[: len(wanted.sup or ())]))
    elif not (last and wanted.sup is None):
        pairs.append((wanted.sup, found.sup))
    if len(wanted.args) != len(found.args):
        return False
    return all(is_same_list(w, f) for w, f in [*pairs, *zip(wanted.args, found.args, strict=True)])


def is_same_list(wanted: list[Noad] | None, found: list[Noad] | None) -> bool:
    """The same for lists, and for scripts that are not there."""
    if wanted is None or found is None:
        return wanted is found
    return len(wanted) == len(found) and all(map(is_same, wanted, found))


@cache
def load_context() -> Any:
    """What pylatexenc has to know: the commands with arguments, and no other."""
    try:
        from pylatexenc.macrospec import EnvironmentSpec, LatexContextDb, MacroSpec
    except ImportError:
        message = "expected the package pylatexenc; got none; install the packages of requirements.lock"
        raise MissingEngineError(message, where="read") from None
    context = LatexContextDb()
    one = (*BOLD, *(WORDS - {"rm"}), *ACCENTS, *DOTS)
    given = {**dict.fromkeys(one, "{"), **dict.fromkeys(("frac", "dfrac", "tfrac", "cfrac"), "{{"), "sqrt": "[{"}
    macros = [MacroSpec(name, arguments) for name, arguments in given.items()]
    arrays = [EnvironmentSpec(name, "{" if name == "array" else "") for name in MATRICES]
    context.add_context_category("formulas", macros=macros, environments=arrays, specials=[])
    context.set_unknown_macro_spec(MacroSpec(""))
    context.set_unknown_environment_spec(EnvironmentSpec(""))
    return context


@lru_cache(10_000)
def list_spelling(latex: str) -> tuple[Noad, ...]:
    """The symbols of an entry of ``[latex]``; nobody changes them."""
    return tuple(list_noads(latex))


def list_noads(text: str) -> list[Noad]:
    """The symbols of a formula. Raises Refusal for unbalanced braces and for what is no formula."""
    from pylatexenc.latexwalker import LatexWalker, LatexWalkerParseError

    bound_depth(text)
    try:
        nodes, _, _ = LatexWalker(text, latex_context=load_context(), tolerant_parsing=False).get_latex_nodes()
    except LatexWalkerParseError as failure:
        at = min(failure.pos or 0, len(text))
        raise Refusal(at, "balanced braces and whole commands", "others", "close what is open") from None
    return Builder(text).build(nodes, False)


def bound_depth(text: str) -> None:
    """Refuse deep nesting before a recursive reader sees it."""
    depth = 0
    for at, char in enumerate(text):
        depth += (char in "{([") - (char in "})]")
        if depth > DEPTH or at > 20_000:
            raise Refusal(at, f"at most {DEPTH} levels and 20000 characters", "more", "split the formula")


class Builder:
    """Nodes to symbols with scripts."""

    def __init__(self, text: str) -> None:
        self.text = text

    def build(self, nodes: list[Any], bold: bool) -> list[Noad]:
        """A list: scripts go to the symbol before them, or to the one behind them where there is none."""
        if nodes and getattr(nodes[0], "macroname", "") in SWITCHES:
            return self.switch(nodes[0].macroname, nodes[1:])
        units = merge_sides([unit for node in nodes for unit in self.list_units(node, bold)])
        done: list[Noad] = []
        side = ""
        for place, unit in enumerate(units):
            is_second = unit.is_bar and any(n.is_bar and n.end == unit.at for n in done[-1:])
            if side:
                self.attach(done[-1], side, unit, units[place + 1 : place + 2])
                side = ""
            elif unit.is_sign("^", "_"):
                side = "sup" if unit.value == "^" else "sub"
                if not done or not takes_script(done[-1]):
                    done.append(Noad("group", None, unit.at, unit.at))
            elif unit.is_sign("'"):
                prime = Noad("cmd", "prime", unit.at, unit.end)
                primed = done and (not done[-1].sup or done[-1].sup[-1].is_command("prime"))
                if not primed or not takes_script(done[-1]):
                    raise Refusal(unit.at, "a name before its primes", "'", "write the name in [latex]")
                done[-1].sup, done[-1].end = [*(done[-1].sup or []), prime], unit.end
            elif is_second and sum(n.is_bar for n in done) % 2:
                done[-1].value, done[-1].end = "||", unit.end  # but |a||b| has bars that close and open
            else:
                done.append(unit)
        if side:
            raise Refusal(len(self.text), "a script behind ^ or _", "nothing", "write it")
        return self.place_prescripts(done)

    def switch(self, name: str, nodes: list[Any]) -> list[Noad]:
        r"""What stands behind ``{\bf`` or ``{\rm``."""
        if name != "rm":
            return self.build(nodes, True)
        if len(nodes) != 1 or type(nodes[0]).__name__ != "LatexCharsNode":
            raise Refusal(nodes[0].pos if nodes else len(self.text), r"one word behind \rm", "others", r"write \mathrm")
        return [Noad("word", nodes[0].chars.strip(), nodes[0].pos, nodes[0].pos + nodes[0].len)]

    def attach(self, noad: Noad, side: str, unit: Noad, following: list[Noad]) -> None:
        """A script: one symbol, or a group."""
        given = getattr(noad, side)
        primed = side == "sup" and given and all(n.is_command("prime") for n in given)
        if given is not None and not primed:
            raise Refusal(unit.at, "one subscript and one superscript", "two", "put the first part in braces")
        digit = unit.kind == "sym" and unit.value.isdigit()
        if digit and following and following[0].is_sign(*"0123456789") and following[0].at == unit.end:
            raise Refusal(unit.at, "a script in braces", "two digits without", "write ^{12} or a product")
        if unit.is_sign("^", "_"):
            raise Refusal(unit.at, "a script behind ^ or _", unit.value, "write it")
        script = unit.args[0] if unit.kind == "group" and unit.args else [unit]
        setattr(noad, side, [*given, *script] if primed else script)
        noad.end = unit.end

    def place_prescripts(self, noads: list[Noad]) -> list[Noad]:
        """Scripts of nothing go to the symbol behind them; braces around one symbol, or none, fall."""
        done: list[Noad] = []
        before: tuple[list[Noad] | None, list[Noad] | None] | None = None
        start = 0
        for place, noad in enumerate(noads):
            if noad.kind == "group" and not (noad.args and noad.args[0]):
                if noad.has_scripts:
                    before, start = (noad.sub, noad.sup), noad.at
                continue
            if noad.kind == "group" and is_sum(noad.args[0]):
                behind = [n for n in noads[place + 1 :] if n.kind != "group" or n.args[0]]
                if not (stands_apart(done[-1:], "open", "+") and stands_apart(behind[:1], "close", "+-")):
                    raise Refusal(noad.at, "a sum in parentheses", "braces, which are not printed", "write parentheses")
            for inner in self.unwrap(noad):
                if before is not None:
                    if not takes_script(inner) or inner.kind in ("close", "bar"):
                        raise Refusal(start, "a symbol behind its scripts", "another mark", "write the symbol")
                    inner.before, inner.at, inner.shown, before = before, start, start, None
                done.append(inner)
        if before is not None:
            raise Refusal(start, "a symbol beside its scripts", "none", "write the symbol")
        return done

    def unwrap(self, noad: Noad) -> list[Noad]:
        """A group as its symbols; its scripts go to the only one, or to its closing bracket."""
        if noad.kind != "group":
            return [noad]
        inner = noad.args[0]
        if noad.bold and len(inner) > 1:
            for one in inner:
                one.spelled = rf"\mathbf{{{self.text[one.at : one.end]}}}" if one.kind in ("sym", "cmd") else ""
        if not noad.has_scripts:
            if noad.bold and len(inner) == 1:
                inner[0].end, inner[0].shown = noad.end, noad.at
            return inner
        last = inner[-1]
        if noad.bold and len(inner) == 1:
            last.end, last.shown = noad.end, noad.at
        elif noad.bold:
            behind = self.text[self.text.find("}", last.end) + 1 : noad.end]
            last.spelled, last.end = f"{last.spelled}{behind}", noad.end
        if len(inner) == 1 and any(getattr(noad, side) and getattr(last, side) for side in ("sub", "sup")):
            closing = Noad("close", "}", noad.end, noad.end, sub=noad.sub, sup=noad.sup)
            return [Noad("open", "{", noad.at, noad.at + 1), last, closing]
        closed = len(inner) > 1 and inner[0].kind == "open" and match_bracket(inner, 0) == len(inner) - 1
        twice = any(getattr(noad, side) and getattr(last, side) for side in ("sub", "sup"))
        opens = any(n.kind in ("open", "close", "bar") for n in inner)
        if (len(inner) > 1 and not closed and (not noad.bold or opens)) or twice:
            raise Refusal(noad.at, "a script on one symbol or on parentheses", "on braces", "write parentheses")
        last.sub, last.sup, last.end = noad.sub or last.sub, noad.sup or last.sup, noad.end
        return inner

    def list_units(self, node: Any, bold: bool) -> list[Noad]:
        """The symbols of a node, without scripts."""
        kind = type(node).__name__
        at, end = node.pos, node.pos + node.len
        if kind == "LatexCharsNode":
            signs = [(at + place, char) for place, char in enumerate(node.chars) if not char.isspace()]
            return [self.make_sign(where, char, bold) for where, char in signs]
        if kind == "LatexGroupNode":
            return [Noad("group", None, at, end, bold, (self.build(node.nodelist, bold),))]
        if kind == "LatexEnvironmentNode":
            return [self.make_environment(node, at, end)]
        if kind == "LatexMacroNode":
            return self.list_command(node, at, at + len(node.macroname) + 1, end, bold)
        raise Refusal(at, "a formula", "a comment or another formula inside", "remove it")

    def make_sign(self, at: int, char: str, bold: bool) -> Noad:
        """One character; a tie is a space."""
        if char == "~":
            return Noad("group", None, at, at + 1, bold, ([],))
        kind, value = BRACKETS.get(char, ("sym", char))
        return Noad(kind, value, at, at + 1, bold)

    def list_command(self, node: Any, at: int, name_end: int, end: int, bold: bool) -> list[Noad]:
        """A command: nothing for spaces, a bracket, or a symbol."""
        name = node.macroname
        if name in SETTINGS or name in SIZES:
            return []
        if name in SPACES:
            return [Noad("group", None, at, name_end, bold, ([],))]
        if name in ("left", "right"):
            return [Noad("side", name, at, name_end)]
        if name in DELIMITERS:
            return [Noad(*DELIMITERS[name], at, name_end)]
        given = [arg for arg in (node.nodeargd.argnlist if node.nodeargd else ()) if arg is not None]
        if name in WORDS and given:
            word = self.text[given[0].pos : given[0].pos + given[0].len].strip("{} ")
            return [Noad("word", word, at, end, bold)]
        inner = [arg.nodelist if type(arg).__name__ == "LatexGroupNode" else [arg] for arg in given]
        args = tuple(self.build(nodes, bold or name in BOLD) for nodes in inner)  # in braces, or one symbol
        if name in BOLD:
            return [Noad("group", None, at, end, True, args)]
        name = "frac" if name in ("dfrac", "tfrac", "cfrac") else name
        return [Noad("arg", name, at, end, bold, args) if args else Noad("cmd", name, at, name_end, bold)]

    def make_environment(self, node: Any, at: int, end: int) -> Noad:
        """A matrix: its entries as lists, and the length of each row as its value."""
        if node.environmentname not in MATRICES:
            raise Refusal(at, "a matrix or cases", node.environmentname, "write the parts as formulas of their own")
        rows: list[list[list[Any]]] = [[[]]]
        for inner in node.nodelist:
            kind = type(inner).__name__
            if kind == "LatexMacroNode" and inner.macroname == "\\":
                rows.append([[]])
            elif kind == "LatexMacroNode" and inner.macroname == "hline":
                continue
            elif kind == "LatexCharsNode" and "&" in inner.chars:
                from pylatexenc.latexwalker import LatexCharsNode

                start = inner.pos
                for place, piece in enumerate(inner.chars.split("&")):
                    if place:
                        rows[-1].append([])
                    rows[-1][-1].append(LatexCharsNode(chars=piece, pos=start, len=len(piece)))
                    start += len(piece) + 1
            else:
                rows[-1][-1].append(inner)
        built = [[self.build(cell, False) for cell in row] for row in rows]
        built = [[cell for cell in row if [n.kind for n in cell] != ["bar"]] for row in built]  # a line between columns
        built = [row for row in built if any(row)]
        widths = tuple(len(row) for row in built)
        return Noad("env", (node.environmentname, widths), at, end, False, tuple(c for row in built for c in row))


def merge_sides(units: list[Noad]) -> list[Noad]:
    r"""Brackets behind ``\left`` and ``\right`` as brackets that open and close."""
    done: list[Noad] = []
    for unit in units:
        if done and done[-1].kind == "side":
            side = done.pop()
            if side.value == "right" and unit.is_sign("."):
                unit.kind, unit.value = "close", "cases"
            if unit.kind not in ("open", "close", "bar"):
                raise Refusal(unit.at, f"a bracket behind \\{side.value}", "another symbol", "write ( ) [ ] or |")
            unit.kind, unit.at = ("open" if side.value == "left" else "close"), side.at
        done.append(unit)
    if done and done[-1].kind == "side":
        raise Refusal(done[-1].at, f"a bracket behind \\{done[-1].value}", "nothing", "write ( ) [ ] or |")
    return done


def takes_script(noad: Noad) -> bool:
    """True for what a script behind it may belong to."""
    if noad.kind in ("open", "side") or noad.is_sign(*"+-=<>/,;*:"):
        return False
    return not noad.is_command("cdot", "times", "otimes", "circ", "odot", "div", "pm", "mp")


def is_sum(noads: list[Noad]) -> bool:
    """Whether a + or - stands between symbols, outside of brackets."""
    depth = [0, *accumulate((n.kind == "open") - (n.kind == "close") for n in noads)]
    return any(n.is_sign("+", "-") and not depth[place] for place, n in enumerate(noads) if place)


def stands_apart(beside: list[Noad], bracket: str, signs: str) -> bool:
    """Whether a symbol, if there is one, is such a bracket, a bar, a relation or one of these signs."""
    return all(n.kind in (bracket, "bar") or n.is_sign(*signs, *"=<>,;.") for n in beside)


def match_bracket(noads: list[Noad], place: int) -> int:
    """Place of the bracket that closes the one here; -1 where there is none."""
    depth = 0
    for at in range(place, len(noads)):
        depth += (noads[at].kind == "open") - (noads[at].kind == "close")
        if depth == 0:
            return at
    return -1
