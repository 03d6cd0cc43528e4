"""A third reader: LaTeX as values, cut at signs and then factor by factor, with no rule of the other two."""

from __future__ import annotations

import re

import numpy as np

from tests.language.latex.third_values import (
    CALLS,
    FUNCTIONS,
    N,
    blend,
    cross,
    derive,
    entry,
    exponential,
    is_column,
    is_scalar,
    literal,
    noise,
    over,
    power,
    skew,
    times,
)

GREEK = set(
    (
        "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi rho "
        "varrho sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma "
        "Upsilon Phi Psi Omega ell "
    ).split()
)
WORDS = "mathrm text textrm operatorname operatorname* mathop textnormal".split()
ACCENTS = (
    "hat widehat tilde widetilde bar overline vec check breve acute grave mathring underline underbar "
    "mathcal mathbb mathfrak mathscr mathsf mathit mathtt "
).split()
SILENT = re.compile(r"\\(?:left|right|[bB]igg?[lr]?|displaystyle|textstyle|limits|nolimits)(?![A-Za-z])"
                    r"|\\(?:mathstrut|thinspace|empty)(?![A-Za-z])"
                    r"|\\\\|\\q?quad(?![A-Za-z])|\\[,;:!> ]|~|\s")  # fmt: skip
BRACKETS = {r"\lvert": "|", r"\rvert": "|", r"\vert": "|", r"\lVert": "‖", r"\rVert": "‖", r"\Vert": "‖", r"\|": "‖",
            r"\lbrack": "[", r"\rbrack": "]", r"\lparen": "(", r"\rparen": ")"}  # fmt: skip


BARE = (*"+-/,(*<>=", r"\cdot", r"\times", r"\otimes")


class Unit:
    """A symbol with its scripts; ``base`` is a mark, or a tuple for what has arguments."""

    def __init__(self, base, bold=False, pre=("", "")):
        self.base, self.bold, self.pre, self.sub, self.sup = base, bold, pre, None, None

    def show(self, power=True):
        """A spelling without spaces, braces and order of scripts; bold type is a star."""
        base = show(self.base)
        scripts = f"_{{{show(self.sub)}}}" if self.sub is not None else ""
        scripts += f"^{{{show(self.sup)}}}" if power and self.sup is not None else ""
        before = f"<{self.pre[0]}^{self.pre[1]}>" if any(self.pre) else ""
        return before + ("★" if self.bold else "") + base + scripts


def show(units):
    """The spelling of anything that holds symbols."""
    if isinstance(units, tuple):
        return units[0] + "".join("{" + show(piece) + "}" for piece in units[1:])
    return units if isinstance(units, str) else units.show() if isinstance(units, Unit) else "".join(map(show, units))


def list_units(latex, bold=False):
    """The symbols of LaTeX; two bars side by side are a norm, unless one of them closes |a| and one opens |b|."""
    latex = re.sub(r"&\s*\|\s*(?=&)", "", latex)
    latex = re.sub(r"(?<![\\\w|])\|(?!\|)([^|]*)\|", r"\\vert \1\\vert ", latex).replace("||", r"\Vert ")
    text = SILENT.sub(
        lambda m: (
            r"\\ "
            if m[0] == r"\\"
            else "{}"
            if re.match(r"\s*[\^_]", latex[m.end() :]) and not m[0][1:].isalpha() and m[0].strip()
            else " "
        ),
        latex,
    )
    text = re.sub(r"\\\{(?!\s*\\begin)", "(", text).replace(r"\}", ")")
    return build(re.findall(r"\\operatorname\*|\\[A-Za-z]+|\\.|[^\s]", text), bold)


def group_of(marks, at):
    """The marks of an argument and the place behind it."""
    if marks[at] != "{":
        if marks[at] in (r"\mathbf", r"\boldsymbol", r"\bm", r"\pmb") or marks[at][1:] in (
            *WORDS,
            *ACCENTS,
            "dot",
            "ddot",
        ):
            return marks[at : (stop := group_of(marks, at + 1)[1])], stop
        return marks[at : at + 1], at + 1
    depth = 0
    for stop in range(at, len(marks)):
        depth += (marks[stop] == "{") - (marks[stop] == "}")
        if depth == 0:
            return marks[at + 1 : stop], stop + 1
    raise ValueError("braces")


def build(marks, bold):
    units, at, pre = [], 0, None
    if marks[:1] == [r"\rm"]:
        return [Unit(("word", [Unit("".join(marks[1:]))]))]
    if marks[:1] in ([r"\bf"], [r"\bfseries"]):
        return build(marks[1:], True)
    while at < len(marks):
        mark, name = marks[at], marks[at][1:] if marks[at][0] == "\\" else ""
        if mark in ("_", "^", "'"):
            target = units[-1] if units and pre is None and units[-1].base not in BARE else None
            if mark == "'":
                units[-1].sup = [*(units[-1].sup or []), Unit("'")]
                at += 1
                continue
            inner, at = group_of(marks, at + 1)
            script = build(inner, bold)
            if target is None:
                pre = pre or ["", ""]
                pre[mark == "^"] = show(script).replace("★", "")
            elif mark == "_":
                target.sub = script
            else:
                target.sup = [*(target.sup or []), *script]
            continue
        if mark == "{":
            inner, at = group_of(marks, at)
            if not inner:
                if at < len(marks) and marks[at] in ("_", "^"):
                    pre = ["", ""]
                continue
            new = build(inner, bold)
            if at < len(marks) and marks[at] == "^" and len(new) == 1 and new[0].sup and new[0].sup[-1].base != "'":
                new = [Unit(("group", new))]
        elif name in ("underbrace", "overbrace"):
            inner, at = group_of(marks, at + 1)
            at = group_of(marks, at + 1)[1] if at < len(marks) and marks[at] in ("_", "^") else at
            new = [Unit(("group", build(inner, bold)))]
        elif name in ("mathbf", "boldsymbol", "bm", "pmb"):
            inner, at = group_of(marks, at + 1)
            new = build(inner, True)
        elif name in WORDS:
            inner, at = group_of(marks, at + 1)
            new = [Unit(("word", [Unit("".join(inner))]))]
        elif name in ("frac", "dfrac", "tfrac", "cfrac"):
            above, at = group_of(marks, at + 1)
            below, at = group_of(marks, at)
            new = [Unit(("frac", build(above, bold), build(below, bold)))]
        elif name == "sqrt":
            order = []
            if marks[at + 1] == "[":
                stop = marks.index("]", at)
                order, at = marks[at + 2 : stop], stop
            inner, at = group_of(marks, at + 1)
            new = [Unit(("sqrt", build(inner, bold), build(order, bold)))]
        elif name in ACCENTS or name in ("dot", "ddot", "dddot"):
            inner, at = group_of(marks, at + 1)
            new = [Unit((mark, build(inner, bold)))]
        elif name == "begin":
            new, at = environment(marks, at)
        else:
            new, at = [Unit(BRACKETS.get(mark, mark), bold and (mark.isalnum() or name in GREEK))], at + 1
        if pre is not None:
            new[0].pre, pre = tuple(pre), None
        units += new
    return units


def environment(marks, at):
    """A matrix or cases."""
    kind, start = group_of(marks, at + 1)
    kind, depth, cell, rows = "".join(kind), 0, [], [[]]
    at = group_of(marks, start)[1] if kind == "array" else start
    while True:
        mark = marks[at]
        if mark == r"\end" and depth == 0:
            break
        depth += (mark == r"\begin") - (mark == r"\end") + (mark == "{") - (mark == "}")
        if depth == 0 and mark in ("&", r"\\"):
            rows[-1].append(cell)
            cell = []
            rows += [[]] if mark == r"\\" else []
        elif mark != r"\hline":
            cell.append(mark)
        at += 1
    rows[-1].append(cell)
    built = [[build(c, False) for c in row] for row in rows if any(row)]
    return [Unit(("env", kind, built))], group_of(marks, at + 1)[1]


class Third:
    """The value of LaTeX: cut at signs, then factor by factor."""

    def __init__(self, symbols, latex, values):
        self.symbols, self.values = symbols, dict(values)
        self.entries = sorted(
            ((list_units(s), n) for n, s in latex.items() if n in symbols), key=lambda e: -self.rank(e[0])
        )
        self.functions = [(list_units(s), n) for n, s in latex.items() if n not in symbols]
        self.floor = "skew" if any(n == "skew" and "lfloor" in s for n, s in latex.items()) else "floor"

    def rank(self, units):
        return 100 * len(units) + sum(u.bold + (u.sub is not None) + (u.sup is not None) for u in units)

    def get(self, name):
        return self.values.setdefault(name, float(noise(("name", name))))

    def is_turning(self, name):
        return isinstance(self.symbols.get(name), dict) and "quaternion" in self.symbols[name]

    def whole(self, latex, as_column=False):
        units = list_units(latex)
        if as_column and len(units) == 1 and units[0].base[0] == "env":
            return literal([[self.value(c)[0]] for c in units[0].base[2][0]])
        if as_column and isinstance(units[0].base, str) and units[0].base in ("(", "["):
            return literal([[self.value(c)[0]] for c in self.commas(units[1:-1])])
        return self.value(units)[0]

    def value(self, units):
        """A sum: its value and whether it is a quaternion."""
        terms, sign, start, depth, bars, inner = [], 1, 0, 0, set(), 0
        for at, u in enumerate(units):
            base = u.base if isinstance(u.base, str) else ""
            depth += (base in ("(", "[", r"\lfloor", r"\langle", r"\{")) - (
                base in (")", "]", r"\rfloor", r"\rangle", r"\}")
            )
            if base in ("|", "‖"):
                bars ^= {base}
            inner += (base == r"\int") - (inner > 0 and depth == 0 and self.is_differential(units, at))
            if base in ("+", "-") and depth == 0 and not bars and not inner and u.sup is None and u.sub is None:
                if units[start:at]:
                    terms.append((sign, self.product(units[start:at])))
                    sign = 1
                sign, start = (-sign if base == "-" else sign), at + 1
        terms.append((sign, self.product(units[start:])))
        total = None
        for sign, (v, _) in terms:
            total = sign * v if total is None else total + sign * v
        return total, any(q for _, (_, q) in terms)

    def is_differential(self, units, at):
        base = units[at].base
        d = base == "d" or (base[0] == "word" and base[1][0].base == "d")
        return (
            d
            and units[at].sub is None
            and at + 1 < len(units)
            and self.is_name(units[at + 1])
            and "d" not in self.symbols
        )

    def is_name(self, u):
        return (isinstance(u.base, str) and (u.base.isalpha() or u.base[1:] in GREEK)) or u.base[0] in (
            "word",
            *("\\" + a for a in ACCENTS),
        )

    def product(self, units):
        total, quaternion, mark, at = None, False, "", 0
        while at < len(units):
            base = units[at].base
            if (
                total is not None
                and base in (r"\cdot", r"\times", r"\otimes", "/", "*", r"\ast")
                and units[at].sup is None
            ):
                mark, at = base, at + 1
                continue
            (v, q), at = self.factor(units, at)
            if total is None:
                total, quaternion = v, q
            elif mark == "/":
                total = over(total, v)
            elif is_column(total) and is_column(v):
                joined = FUNCTIONS["qmul"] if quaternion and q and mark in ("", r"\otimes") else None
                joined = joined or {r"\cdot": FUNCTIONS["dot"], r"\times": cross}[mark]
                total, quaternion = joined(total, v), quaternion and q and mark != r"\cdot"
            else:
                quaternion = (quaternion and is_scalar(v)) or (q and is_scalar(total))
                total = times(total, v)
            mark = ""
        return total, quaternion

    def raised(self, pair, sup, name=""):
        """A value with its superscript."""
        if not sup:
            return pair
        value, quaternion = pair
        text = (
            show(sup)
            .replace("★", "")
            .replace("word{T}", r"\top")
            .replace(r"\mathsf{T}", r"\top")
            .replace(r"\intercal", r"\top")
        )
        if text in ("T", r"\top", "-T", r"-\top") and not (is_scalar(value) and "T" in self.symbols):
            return (value if text[0] != "-" else power(value, -1)).T, False
        if text in ("*", r"\ast"):
            return FUNCTIONS["conj"](value), True
        if text in (r"\times", r"\wedge"):
            return skew(value), False
        exponent = self.value(sup)[0]
        if quaternion:
            assert exponent == -1
            unit = self.symbols[name]["quaternion"] == "unit" if name else False
            turned = FUNCTIONS["conj"](value)
            return (turned if unit else over(turned, power(FUNCTIONS["norm"](value), 2.0))), True
        return (power(value, exponent), False)

    def named(self, units, at):
        """An entry of the table, the longest: name, power and the place behind it."""
        for wanted, name in self.entries:
            found = units[at : at + len(wanted)]
            if len(found) < len(wanted):
                continue
            last, same = (
                found[-1],
                lambda w, f, p=True: (
                    f.show(p) == w.show(p)
                    or (
                        f.show(p).replace("★", "") == w.show(p).replace("★", "")
                        and f.show(p).count("★") >= w.show(p).count("★")
                    )
                ),
            )
            primes = len(wanted[-1].sup or ()) if all(s.base == "'" for s in wanted[-1].sup or ()) else -1
            if all(map(same, wanted[:-1], found[:-1])):
                if same(wanted[-1], last):
                    return name, None, at + len(wanted)
                own = (last.sup or [])[:primes] if primes >= 0 else None
                rest = (last.sup or [])[primes:] if primes >= 0 else None
                if (
                    own is not None
                    and rest
                    and show(own) == show(wanted[-1].sup or [])
                    and same(wanted[-1], last, False)
                    and rest[0].base != "'"
                ):
                    return name, rest, at + len(wanted)
            if (
                len(wanted) > 3
                and wanted[1].base == "("
                and found[0].sup
                and not wanted[0].sup
                and same(wanted[0], found[0], False)
            ) and all(map(same, wanted[1:], found[1:])):
                return name, found[0].sup, at + len(wanted)
        return None

    def closing(self, units, at):
        """Place of the bracket that closes the one here."""
        if units[at].base in ("|", "‖"):
            return next(j for j in range(at + 1, len(units)) if units[j].base == units[at].base)
        depth, ends = 0, (")", "]", r"\rfloor", r"\rangle", r"\}", *("." if units[at].base == r"\{" else ""))
        for j in range(at, len(units)):
            depth += (units[j].base in ("(", "[", r"\lfloor", r"\langle", r"\{")) - (units[j].base in ends)
            if depth == 0:
                return j
        raise ValueError("bracket")

    def commas(self, units):
        pieces, depth = [[]], 0
        for u in units:
            depth += (u.base in ("(", "[")) - (u.base in (")", "]"))
            if depth == 0 and u.base == ",":
                pieces.append([])
            else:
                pieces[-1].append(u)
        return pieces

    def bracket(self, units, at):
        stop, base = self.closing(units, at), units[at].base
        inner, last = units[at + 1 : stop], units[stop]
        crossed = (inner and inner[-1].base == r"\times") or (last.sub and last.sub[0].base == r"\times")
        if base == r"\{":
            return self.raised((self.cases(inner[0].base[2]), False), last.sup), stop + 1
        inner = inner[:-1] if inner[-1].base == r"\times" else inner
        items = self.commas(inner)
        if base == r"\langle":
            return self.raised((FUNCTIONS["dot"](*(self.value(i)[0] for i in items)), False), last.sup), stop + 1
        if len(items) > 1:
            return self.raised((literal([[self.value(i)[0] for i in items]]), False), last.sup), stop + 1
        value, quaternion = self.value(inner)
        if crossed or (base == r"\lfloor" and self.floor == "skew"):
            value, quaternion = skew(value), False
        elif base in ("|", "‖"):
            value, quaternion = (abs(value) if is_scalar(value) else FUNCTIONS["norm"](value)), False
        elif base == r"\lfloor":
            value = FUNCTIONS["floor"](value)
        return self.raised((value, quaternion), last.sup), stop + 1

    def cases(self, rows):
        result = self.value(rows[-1][0])[0]
        for value, condition in reversed(rows[:-1]):
            value = value[:-1] if value[-1].base == "," else value
            term, pieces, signs = self.value(value)[0], [[]], []
            condition = (
                condition[1:] if condition[0].base[0] == "word" and len(condition[0].base[1][0].base) < 5 else condition
            )
            for u in condition:
                sign = (
                    {
                        "<": "<",
                        ">": ">",
                        "=": "=",
                        r"\le": "<=",
                        r"\leq": "<=",
                        r"\ge": ">=",
                        r"\geq": ">=",
                        r"\neq": "!=",
                    }.get(u.base)
                    if isinstance(u.base, str)
                    else None
                )
                if sign:
                    signs.append(sign)
                    pieces.append([])
                elif u.base != ",":
                    pieces[-1].append(u)
            sides = [self.value(p)[0] for p in pieces]
            for j in reversed(range(len(signs))):
                term = FUNCTIONS["where"](FUNCTIONS["C"](sides[j], signs[j], sides[j + 1]), term, result)
            result = term
        return result

    def call(self, name, unit, units, at):
        """A function at its argument."""
        if unit.sub is not None:
            base = float(show(unit.sub))
            name, divisor = "log", FUNCTIONS["log"](base)
        if at < len(units) and units[at].base in ("(", "["):
            stop = self.closing(units, at)
            args, at = [self.value(p)[0] for p in self.commas(units[at + 1 : stop])], stop + 1
        else:
            digits = units[at].base if isinstance(units[at].base, str) and units[at].base.isdigit() else ""
            (value, _), behind = self.factor(units, at)
            if (
                digits
                and behind < len(units)
                and not (units[behind - 1].sup and show(units[behind - 1].sup) == r"\circ")
                and (
                    self.is_name(units[behind]) or units[behind].base == r"\pi" or isinstance(units[behind].base, tuple)
                )
            ):
                word = units[behind].base[1][0].base if units[behind].base[0] == "word" else str(units[behind].base)[1:]
                if word not in CALLS:
                    (other, _), behind = self.factor(units, behind)
                    value = times(value, other)
            args, at = [value], behind
        value = FUNCTIONS[name](*args)
        value = over(value, divisor) if unit.sub is not None else value
        return self.raised((value, False), unit.sup), at

    def factor(self, units, at):
        """One factor and the place behind it."""
        found = self.named(units, at)
        if found:
            name, rest, stop = found
            if stop < len(units) and units[stop].base == "(" and self.takes(name, units, stop):
                stop = self.closing(units, stop) + 1
            return self.raised((self.get(name), self.is_turning(name)), rest, name), stop
        u = units[at]
        for wanted, name in self.functions:
            if len(wanted) == 1 and wanted[0].base == u.base:
                return self.call(name, u, units, at + 1)
        base, word = u.base, u.base[1:] if isinstance(u.base, str) else u.base[1][0].base if u.base[0] == "word" else ""
        if isinstance(base, str) and base in ("(", "[", "|", "‖", r"\lfloor", r"\langle", r"\{"):
            return self.bracket(units, at)
        if isinstance(base, str) and (base.isdigit() or base == "."):
            text = base
            while (
                u.sup is None
                and u.sub is None
                and at + 1 < len(units)
                and isinstance(units[at + 1].base, str)
                and (units[at + 1].base.isdigit() or units[at + 1].base == ".")
            ):
                at += 1
                u = units[at]
                text += u.base
            if u.sub is not None:
                return self.raised((np.zeros((N, 1) if show(u.sub).endswith("1") else (N, N)), False), u.sup), at + 1
            if at + 1 < len(units) and units[at + 1].base == "!":
                return (float(np.prod(range(1, int(text) + 1))), False), at + 2
            if u.sup and show(u.sup) == r"\circ":
                return (over(times(float(text), FUNCTIONS["pi"]), 180.0), False), at + 1
            return self.raised((float(text), False), u.sup), at + 1
        if word in CALLS and word not in self.symbols and (base[0] == "\\" or base[0] == "word"):
            return self.call(CALLS[word], u, units, at + 1)
        if base in (r"\pi", r"\infty"):
            return self.raised((FUNCTIONS["pi" if base == r"\pi" else "oo"], False), u.sup), at + 1
        if base in (r"\sum", r"\prod", r"\lim"):
            return self.big(u, units, at)
        if base == r"\int":
            return self.integral(u, units, at)
        if isinstance(base, tuple) and base[0] in ("frac", "sqrt", "env", "group", r"\dot", r"\ddot", r"\dddot"):
            return self.built(u, units, at)
        if "e" in (base, word) and u.sup and "e" not in self.symbols:
            return (exponential(self.value(u.sup)[0]), False), at + 1
        return self.letter(u, units, at)

    def takes(self, name, units, at):
        declared = self.symbols.get(name)
        function = declared.get("function") if isinstance(declared, dict) else None
        return function is not None and show(units[at + 1 : self.closing(units, at)]).lstrip("\\") == function

    def letter(self, u, units, at):
        word = u.base[1][0].base if u.base[0] == "word" else u.base.lstrip("\\")
        sub = "".join(s.base[1][0].base if s.base[0] == "word" else s.base.lstrip("\\") for s in u.sub or ())
        name = word + (f"_{sub}" if sub else "")
        indices = sub.split(",")
        stop = at + 1
        if name not in self.symbols and name not in self.values and not sub:
            run = word
            while (
                stop < len(units)
                and isinstance(units[stop].base, str)
                and units[stop].base.isalpha()
                and len(units[stop].base) == 1
            ):
                more = units[stop]
                tail = "".join(s.base.lstrip("\\") for s in more.sub or ())
                run, stop = run + more.base + (f"_{tail}" if tail else ""), stop + 1
                if run in self.symbols:
                    return self.raised((self.get(run), self.is_turning(run)), more.sup, run), stop
            stop = at + 1
        if name not in self.symbols and word in self.symbols and sub and not is_scalar(self.get(word)):
            return self.raised(
                (entry(self.get(word), *(self.get(i) if not i.isdigit() else float(i) for i in indices)), False), u.sup
            ), stop
        if name not in self.symbols and word == "I" and u.bold:
            return self.raised((np.eye(N), False), u.sup), stop
        if name not in self.symbols and name not in self.bound_names():
            raise KeyError(name)
        if stop < len(units) and units[stop].base == "(" and self.takes(name, units, stop):
            stop = self.closing(units, stop) + 1
        return self.raised((self.get(name), self.is_turning(name)), u.sup, name), stop

    def bound_names(self):
        return getattr(self, "bound", ())

    def built(self, u, units, at):
        base = u.base
        if base[0] == "group":
            return self.raised(self.value(base[1]), u.sup), at + 1
        if base[0] == "sqrt":
            inner = self.value(base[1])[0]
            value = power(inner, 1 / self.value(base[2])[0]) if base[2] else FUNCTIONS["sqrt"](inner)
            return self.raised((value, False), u.sup), at + 1
        if base[0] == "env":
            if base[1] == "cases":
                return self.raised((self.cases(base[2]), False), u.sup), at + 1
            value = literal([[self.value(c)[0] for c in row] for row in base[2]])
            return self.raised((blend("det", value) if base[1] == "vmatrix" else value, False), u.sup), at + 1
        if base[0] != "frac":
            inner = base[1][0]
            inner.sub = inner.sub or u.sub
            framed = Unit(inner.base, inner.bold, inner.pre)
            framed.sub, framed.sup = inner.sub, u.sup
            if u.sup and not inner.sup and (found := self.named([framed], 0)) and not found[1]:
                inner, u = framed, Unit("")
            (value, quaternion), _ = self.factor([inner], 0)
            for _ in range(base[0].count("d")):
                value = FUNCTIONS["dot_"](value)
            return self.raised((value, quaternion), u.sup), at + 1
        above, below = base[1], base[2]
        first, second = (x[0].base[1][0].base if x[0].base[0] == "word" else x[0].base for x in (above, below))
        if first == second and first in ("d", r"\partial") and not (first == "d" and "d" in self.symbols):
            order = int(show(above[0].sup)) if above[0].sup else 1
            below[-1].sup = None if order > 1 else below[-1].sup
            x = self.value(below[1:])[0]
            if len(above) > 1:
                return self.raised((derive(self.value(above[1:])[0], x, order), False), u.sup), at + 1
            (value, _), stop = self.factor(units, at + 1)
            return (derive(value, x, order), False), stop
        (one, quaternion), (other, _) = self.value(above), self.value(below)
        return self.raised((over(one, other), quaternion), u.sup), at + 1

    def within(self, name):
        other = object.__new__(Third)
        other.__dict__ = {**self.__dict__, "bound": (*self.bound_names(), name)}
        other.get(name)
        return other

    def big(self, u, units, at):
        cut = next(j for j, s in enumerate(u.sub) if s.base in ("=", r"\to", r"\rightarrow"))
        stop, depth = at + 1, 0
        while stop < len(units):
            base = units[stop].base if isinstance(units[stop].base, str) else ""
            depth += (base in ("(", "[", r"\lfloor", r"\langle")) - (base in (")", "]", r"\rfloor", r"\rangle"))
            if base in ("+", "-", ",") and depth == 0 and units[stop].sup is None:
                break
            stop += 1
        named = self.named(u.sub[:cut], 0)
        name = named[0] if named else show(u.sub[:cut]).lstrip("\\").replace("{", "").replace("}", "")
        ends = [self.value(u.sub[cut + 1 :])[0], *([self.value(u.sup)[0]] if u.sup else [])]
        other = self.within(name)
        tag = {r"\sum": "sum", r"\prod": "product", r"\lim": "limit"}[u.base]
        return (FUNCTIONS[tag](other.product(units[at + 1 : stop])[0], other.get(name), *ends), False), stop

    def integral(self, u, units, at):
        ends = self.value(u.sub)[0], self.value(u.sup)[0]
        count, stop = 1, at
        while count:
            stop += 1
            count += (units[stop].base == r"\int") - self.is_differential(units, stop)
        other = self.within(show(units[stop + 1]).strip("\\★").replace("{", "").replace("}", ""))
        (x, _), behind = other.factor(units, stop + 1)
        body = other.value(units[at + 1 : stop])[0]
        return (FUNCTIONS["integral"](body, x, *ends), False), behind
