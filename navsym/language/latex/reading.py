r"""Formulas of a document or of a string of LaTeX, read with declared symbols only."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import Any

from navsym.core.answers import Answer, named
from navsym.core.errors import EmptyError, ExpressionSyntaxError, TooLargeError
from navsym.core.tables import Table
from navsym.language.files import name_file, read_text
from navsym.language.latex.climbing import climb
from navsym.language.latex.descent import descend
from navsym.language.latex.documents import ENDINGS, Block, hide_comments, list_blocks
from navsym.language.latex.macros import Macro, expand_macros, list_macros
from navsym.language.latex.meaning import explain, fit_sides, list_columns, take_order
from navsym.language.latex.notation import Notation, build_notation, read_notation
from navsym.language.latex.parts import Part, Refusal, list_names, list_unknown
from navsym.language.latex.rows import Relation, Side, split_relations
from navsym.language.names import NAME, RESERVED, list_calls, quote
from navsym.language.tomlfile import toml_text

SIZE = 4_000_000  # bytes of a document
FORMULAS = 20_000
SIGNS = {"<=": r"\le", ">=": r"\ge", "!=": r"\neq"}
#: An upright word, and a number before it.
UPRIGHT = re.compile(
    r"(?P<number>\d(?:\s|~|\\[,;: ]|\\quad)*)?"
    r"(?P<word>\\(?:text|textrm|mathrm)\s*\{\s*(?P<name>[A-Za-z]+)\s*\})(?![_(])"
)
BOLD = re.compile(r"(?:\\[a-z]+\s*\{\s*)*\\(?:mathbf|boldsymbol|bm)\s*\{?\s*(\\?[A-Za-z]+)")
#: A whole power of e, which may be a name.
EXPONENT = re.compile(r"(?<![A-Za-z\\])e\s*\^\s*(?:\{\s*)?\d")
#: A string with one of these holds formulas among other text.
DELIMITED = re.compile(
    r"(?<!\\)\$|\\\[|\\\(|\\begin\{(?:equation|align|gather|eqnarray|multline|displaymath|flalign|split)"
)


@dataclass(frozen=True, slots=True)
class ReadFormula:
    """One relation of a document.

    line, column : where it begins, from 1
    source       : as it is printed
    status, why  : ``READ``, or ``REFUSED`` with the place of the trouble, what was expected and what came
    left, relation, right : in the language of files; None where it is refused
    symbols      : declared names in it, in the order of writing
    latex        : in one line, with the macros of the document expanded
    trouble      : line and column of the trouble
    unknown      : name -> LaTeX, of the names that nobody declared
    whole        : those of them that end sums and products
    order        : name and order of ``+ O(x^k)`` at the end of the right side, which ``right`` leaves out
    """

    file: str
    line: int
    column: int
    source: str
    status: str
    why: str | None
    left: str | None
    relation: str | None
    right: str | None
    symbols: tuple[str, ...]
    latex: str
    trouble: tuple[int, int] | None = None
    unknown: tuple[tuple[str, str], ...] = ()
    order: tuple[str, int] | None = None
    whole: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The reading in one line; empty when it is refused."""
        if self.status != "READ":
            return ""
        rest = "" if self.order is None else f" + O({self.order[0]}**{self.order[1]})"
        return f"{self.left} {self.relation} {self.right}{rest}"

    def document(self) -> dict[str, Any]:
        """The formula as plain data."""
        known = {"place": named(self, "file line column"), **named(self, "source status why left relation right")}
        known |= {} if self.order is None else {"order": dict([self.order])}
        return {**known, "symbols": list(self.symbols), "latex": self.latex}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Reading(Answer):
    r"""The formulas of a document.

    formulas : :class:`ReadFormula`, in their order
    text     : the document
    notation : the declarations

    >>> import navsym as nav
    >>> reading = nav.read(r"\sin 2a = 2 \sin a \cos a", symbols={"a": "real"})
    >>> reading.formulas[0].left, reading.formulas[0].right
    ('sin(2*a)', '2*sin(a)*cos(a)')
    """

    formulas: tuple[ReadFormula, ...]
    text: str
    notation: Notation

    @property
    def read(self) -> tuple[ReadFormula, ...]:
        """The formulas that are read."""
        return tuple(f for f in self.formulas if f.status == "READ")

    @property
    def undeclared(self) -> tuple[str, ...]:
        """The names that nobody declared, each once."""
        return tuple(dict.fromkeys(name for formula in self.formulas for name, _ in formula.unknown))

    def propose(self, name: str) -> Any:
        """The declaration of a name that nobody declared: real, or a whole number from 1 where it ends a sum."""
        return {"integer": ["1", "oo"]} if any(name in formula.whole for formula in self.formulas) else "real"

    def __repr__(self) -> str:
        return f"<{len(self.read)} of {len(self.formulas)} formulas read>"

    def table(self) -> Table:
        """What a notebook shows."""
        return ("line", "", "reading"), [(f.line, f.status, f.text or f.why or "") for f in self.formulas]

    def document(self) -> dict[str, Any]:
        """The answer as plain data: the JSON document of ``navsym read``."""
        counts = {"read": len(self.read), "refused": len(self.formulas) - len(self.read)}
        return {"formulas": [f.document() for f in self.formulas], **counts, "undeclared": list(self.undeclared)}

    def claims(self, *, definitions: bool = False) -> str:
        """A claim file (TOML) with the formulas that are read: symbols, and each claim with its place and its LaTeX.

        definitions : take ``K = P/(P + R)``, where K stands nowhere before, as a definition: no claim of its own, but
                      written for K in the formulas behind it

        Raises EmptyError when none is read, or nothing but definitions.
        """
        if not self.read:
            raise EmptyError("expected a formula that is read; got none; declare its symbols", where="read: out")
        formulas = self.insert_definitions() if definitions else self.read
        if not formulas:
            raise EmptyError("expected a claim; got definitions only; read them as claims", where="read: definitions")
        used = {name for formula in formulas for name in formula.symbols}
        used |= {v for name, v in self.notation.functions.items() if name in used}
        symbols = {name: value for name, value in self.notation.written.items() if name in used}
        rates = {name: rate for name, rate in self.notation.rates.items() if name in used}
        blocks: list[dict[str, Any]] = []
        ids: set[str] = set()
        for formula in formulas:
            stem = re.sub(r"[^A-Za-z0-9_.-]", "", PurePath(formula.file).stem)[:40].lstrip("_.-") or "formula"
            count = sum(name.startswith(f"{stem}:{formula.line}.") for name in ids) + 1
            ids.add(label := f"{stem}:{formula.line}.{count}")
            keys: dict[str, Any] = {"left": formula.left, "relation": formula.relation, "right": formula.right}
            keys |= {} if formula.order is None else {"order": dict([formula.order])}
            beside = {"printed": formula.latex, "source": f"{formula.file or 'text'}: line {formula.line}"}
            blocks.append({"id": label, **keys, **beside})
        return toml_text({"symbols": symbols, **({"rates": rates} if rates else {}), "claim": blocks})

    def insert_definitions(self) -> tuple[ReadFormula, ...]:
        """The formulas without the definitions, ``name = value`` of a name that is new, with the value for the name.

        A name with a value in itself, with a rate, with an index somewhere, or of a variable, is none that is defined.
        """
        values: dict[str, str] = {}
        seen, claims = set(self.notation.rates), []
        calls = (pieces for one in self.read for pieces in list_calls(one.text, "diff|integral|sum|product|limit"))
        seen |= {pieces[1].strip() for pieces in calls if len(pieces) > 1}
        for formula in self.read:
            name, sides = str(formula.left), [str(formula.left), str(formula.right)]
            is_new = name in formula.symbols and name not in seen and not re.search(rf"\b{name}\b", sides[1])
            indexed = is_new and any(re.search(rf"\b{name}\[", one.text) for one in self.read)
            for known in reversed(values):
                sides = [re.sub(rf"\b{known}\b", f"({values[known]})", side) for side in sides]
            seen |= {*formula.symbols}
            if is_new and not indexed and formula.relation == "=" and formula.order is None:
                values[name] = sides[1]
                continue
            names = {*re.findall(r"[A-Za-z]\w*", " ".join(sides))}
            symbols = tuple(name for name in self.notation.written if name in names)
            claims.append(replace(formula, left=sides[0], right=sides[1], symbols=symbols))
        return tuple(claims)

    def declarations(self) -> str:
        """A skeleton (TOML) of the declarations that are missing, with what is declared already.

        Bold capitals are proposed as matrices, other bold letters as vectors, and a bold I as the unit matrix.
        """
        symbols, latex = dict(self.notation.written), dict(self.notation.spellings)
        questions = ""
        for name, spelled in (pair for formula in self.formulas for pair in formula.unknown):
            safe = f"{name}_" if name in RESERVED else name
            safe = f"{safe}1" if safe.endswith("_") else safe
            bold = BOLD.match(spelled)
            if bold and bold[1] == "I" and name == "I":
                latex["eye"] = spelled
            elif NAME.fullmatch(safe) and safe not in symbols:
                is_matrix = bold is not None and bold[1].lstrip("\\")[:1].isupper()
                symbols[safe] = self.propose(name)
                if bold:
                    symbols[safe] = {"matrix": ["?", "?"]} if is_matrix else {"vector": "?"}
                if re.fullmatch(r"([A-Za-z]{2,}|\\mathbf\{[A-Za-z]{2,}\})(_\w|_\{[^{}]*\})?", spelled):
                    questions += f"# Is {spelled} a product or a name? For a product, declare its letters.\n"
                plain = re.sub(r"\\(mathbf|boldsymbol|bm|mathrm|text|operatorname)\b", "", spelled)
                if re.sub(r"[\\{}\s]", "", plain) != safe:  # the name that LaTeX means without a table
                    latex[safe] = spelled
        if "e" not in symbols and any(EXPONENT.search(formula.latex) for formula in self.formulas):
            questions += "# e in e^2 is Euler's number; declare e where it is a name, such as an eccentricity.\n"
        rates = dict(self.notation.rates)
        head = "# Declare each name: real, positive, a range, { vector = 3 }, { matrix = [3, 3] } and so on.\n"
        tables = {"symbols": symbols, **({"latex": latex} if latex else {}), **({"rates": rates} if rates else {})}
        return head + questions + toml_text(tables)


def read(
    source: str | os.PathLike[str],
    /,
    *,
    symbols: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    latex: Mapping[str, str] | None = None,
    rates: Mapping[str, str] | None = None,
) -> Reading:
    r"""The formulas of a document, or of LaTeX as text, in the language of files.

    source  : a path (``.tex``, ``.rst``, ``.md``, ``.dox``), or text: one formula, or a document with formulas between
              dollars, brackets or ``\begin{equation}``
    symbols : name -> declaration, as in ``[symbols]``: ``"real"``, a range, ``{"vector": 3}``; or the path of a TOML
              file with the tables ``[symbols]``, ``[latex]`` and ``[rates]``
    latex   : name -> how it is printed, where that is not the name itself: ``{"C_bn": "C_b^n"}``
    rates   : name -> its rate, as in ``[rates]``

    Every formula is read twice, by two grammars that share no rule, and counts as read when both agree, every name is
    declared and the shapes fit. Anything else is refused with its place and a question.

    Returns a :class:`Reading`. Raises NavsymError for a file that cannot be read, EmptyError, TooLargeError, and
    ExpressionSyntaxError or ShapeError for a wrong declaration.

    >>> import navsym as nav
    >>> known = {"L": "real", "v_N": "real", "R_N": "positive", "h": "real"}
    >>> nav.read(r"\dot L = \frac{v_N}{R_N + h}", symbols=known).formulas[0].right
    'v_N/(R_N + h)'
    >>> nav.read("x = y z", symbols={"x": "real", "y": "real"}).undeclared
    ('z',)
    """
    notation = choose_notation(symbols, latex, rates)
    require_spellings_readable(notation)
    text, name, form = open_source(source)
    macros = list_macros(text) if form == "tex" else {}
    blocks = list_blocks(text, form) if form else [Block(text, 0, True)]
    lines = [0, *(found.end() for found in re.finditer("\n", text))]
    found = [formula for block in blocks for formula in read_block(block, macros, notation, Lines(name, text, lines))]
    if len(found) > FORMULAS:
        raise TooLargeError(f"expected at most {FORMULAS} formulas; got more; split the document", where=name or "read")
    return Reading(tuple(found), text, notation)


def choose_notation(symbols: Any, latex: Any, rates: Any) -> Notation:
    """The notation of a file, or of tables; tables beside a file add to it."""
    if isinstance(symbols, (str, os.PathLike)):
        notation = read_notation(symbols)
        if latex is None and rates is None:
            return notation
        merged = (dict(notation.spellings) | dict(latex or {}), dict(notation.rates) | dict(rates or {}))
        return build_notation(notation.written, *merged, "read")
    tables = [{} if table is None else table for table in (symbols, latex, rates)]
    return build_notation(tables[0], tables[1], tables[2], "read")


def require_spellings_readable(notation: Notation) -> None:
    """Refuse an entry of ``[latex]`` that is no formula by itself."""
    for name, spelling in notation.spellings:
        try:
            one = Notation(notation.written, notation.shapes, ((name, spelling),))
            descend("1", one)
            climb("1", one)
        except Refusal as refusal:
            raise ExpressionSyntaxError(f"{refusal}", where=f"read: latex.{name}") from None


def open_source(source: Any) -> tuple[str, str, str]:
    """Text, name of the file and form of the document; no form for one formula."""
    if not isinstance(source, (str, os.PathLike)):
        message = f"expected LaTeX as text, or a path; got {quote(source)}; write a string"
        raise ExpressionSyntaxError(message, where="read: source")
    ending = PurePath(source).suffix.lower() if not isinstance(source, str) or len(source) < 1_000 else ""
    plain = isinstance(source, str) and re.search(r"[\n\\$={]", source)
    if isinstance(source, os.PathLike) or (ending in ENDINGS and not plain):
        form = ENDINGS.get(ending, "")
        if not form:
            message = f"expected a file that ends in {' '.join(ENDINGS)}; got {quote(ending)}; rename it"
            raise ExpressionSyntaxError(message, where=name_file(source))
        text = read_text(source, SIZE).replace("\r", " ")
        return (hide_comments(text) if form == "tex" else text), name_file(source), form
    text = str(source)
    if len(text) > SIZE:
        raise TooLargeError(f"expected at most {SIZE} characters; got more; split the text", where="read: source")
    if not text.strip():
        raise EmptyError("expected a formula; got an empty text; write one", where="read: source")
    text = hide_comments(text)
    return text, "", "tex" if DELIMITED.search(text) else ""


def read_with_reals(source: str, symbols: Mapping[str, Any], latex: Mapping[str, Any] | None = None) -> Reading:
    """The formulas of a text in which a letter without a declaration is real; letters side by side stay a question."""
    reading = read(source, symbols=symbols, latex=latex)
    unknown = {name: spelled for formula in reading.formulas for name, spelled in formula.unknown}
    if not unknown or any(re.fullmatch("[A-Za-z]{2,}", spelled) for spelled in unknown.values()):
        return reading
    return read(source, symbols=dict(symbols) | {name: reading.propose(name) for name in unknown}, latex=latex)


@dataclass(frozen=True, slots=True)
class Lines:
    """A document: its name, its text and where its lines begin."""

    name: str
    text: str
    starts: list[int]

    def place(self, at: int) -> tuple[int, int]:
        """Line and column, from 1."""
        from bisect import bisect_right

        line = bisect_right(self.starts, at)
        return line, at - self.starts[line - 1] + 1


def read_block(block: Block, macros: Mapping[str, Macro], notation: Notation, lines: Lines) -> Iterator[ReadFormula]:
    """The relations of one block."""
    try:
        text, places = expand_macros(block.text, macros) if macros else (block.text, list(range(len(block.text))))
        if len(text) > 20_000:
            raise Refusal(0, "a formula of at most 20000 characters", f"{len(text)}", "split it")
        relations = split_relations(text)
    except Refusal as refusal:
        text, places = block.text, list(range(len(block.text)))
        side = Side(text, 0)
        relations = [Relation(side, "", side, 0, refusal)]
    for relation in relations:
        if not block.display and relation.trouble is not None and not relation.sign and "=" not in block.text:
            continue
        whole = [block.start + place for place in [*places, len(block.text)]]
        yield read_relation(relation, whole, notation, lines, block)


def read_relation(relation: Relation, places: list[int], notation: Notation, lines: Lines, block: Block) -> ReadFormula:
    """One relation, read or refused."""
    left, right = relation.left, relation.right

    def join(texts: list[str]) -> str:
        """Both sides in one line."""
        sign = SIGNS.get(relation.sign, relation.sign)
        return " ".join((texts[0] if left is right else f"{texts[0]} {sign} {texts[1]}").split())[:2_000]

    printed = [lines.text[places[s.start] : places[s.start + len(s.text)]].strip() for s in (left, right)]
    source, latex = join(printed), join([left.text, right.text])
    row, column = lines.place(places[relation.at + len(left.text) - len(left.text.lstrip())])
    unknown: list[Part] = []
    try:
        if relation.trouble is not None:
            raise relation.trouble
        if relation.index and not is_whole(notation, relation.index):
            remedy = f'declare {relation.index} = {{ integer = ["1", "oo"] }}'
            raise Refusal(relation.at, "a whole number that runs through the list", relation.index, remedy)
        texts, names, order = read_sides(relation, notation, unknown)
        said = (texts[0], relation.sign, texts[1], names, latex)
        return ReadFormula(lines.name, row, column, source, "READ", None, *said, order=order)
    except Refusal as refusal:
        spot = lines.place(places[min(max(refusal.at, 0), len(places) - 1)])
        why = f"line {spot[0]}, column {spot[1]}: {refusal}"
        pairs = tuple(dict.fromkeys((str(u.args[0]), str(u.args[1])) for u in unknown))
        whole = tuple(dict.fromkeys(str(u.args[0]) for u in unknown if "whole" in u.args[2:]))
        none = (None, None, None, ())
        return ReadFormula(lines.name, row, column, source, "REFUSED", why, *none, latex, spot, pairs, whole=whole)


def is_whole(notation: Notation, name: str) -> bool:
    """True for a name that is declared a whole number."""
    declaration = notation.written.get(name)
    return isinstance(declaration, Mapping) and "integer" in declaration


def read_sides(
    relation: Relation, notation: Notation, unknown: list[Part]
) -> tuple[tuple[str, str], tuple[str, ...], tuple[str, int] | None]:
    """The texts of both sides, the declared names in them, and the order of an O(x^k) behind them.

    ``unknown`` collects the other names. Raises Refusal.
    """
    faces: dict[str, set[bool]] = {}
    parts: list[Part] = []
    for side in (relation.left, relation.right):
        with shifted(side.start):
            refuse_units(side.text, notation)
            parts.append(descend(side.text, notation, faces))
        unknown += list_unknown(parts[-1])
    if unknown:
        first = unknown[0]
        sides = (relation.left, relation.right)
        side = sides[0] if list_unknown(parts[0]) else sides[1]
        names = ", ".join(dict.fromkeys(str(u.args[0]) for u in unknown))
        got = f"{names} undeclared"
        run = re.fullmatch("[A-Za-z]{2,}", str(first.args[1]))
        question = f"declare it: is {first.args[0]} a product or a name?" if run else "declare it"
        if first.args[0] == "I" and first.args[1] != "I":
            question = f"declare it, or write eye = '{first.args[1]}' in [latex] where it is the unit matrix"
        raise Refusal(side.start + first.at, "declared names", got, question)
    both = [name for name, bold in faces.items() if len(bold) > 1]
    if both:
        question = f"{both[0]} in bold and plain type: one name or two?"
        raise Refusal(relation.left.start, "one type for a name", question, r"write \mathbf in [latex]")
    for side, part in zip((relation.left, relation.right), parts, strict=True):
        with shifted(side.start):
            if climb(side.text, notation) != part:
                raise Refusal(part.at, "two readings that agree", "two that differ", "write parts, with parentheses")
    used = dict.fromkeys(name for part in parts for name in list_names(part) if name in notation)
    with shifted(relation.right.start):
        parts[1], order = take_order(parts[1])
    terms = []
    columns = list_columns(parts, notation)
    for side, part, as_column in zip((relation.left, relation.right), parts, columns, strict=True):
        with shifted(side.start):
            terms.append(explain(part, notation, as_column))
    first_term, second_term = fit_sides(terms[0], terms[1], relation.right.start)
    if "eye(?)" in first_term.text + second_term.text:
        expected = "a unit matrix whose size is known"
        raise Refusal(relation.left.start, expected, "one without", "write its size below it")
    if (first_term.shape or second_term.shape) and relation.sign not in ("=", "!="):
        raise Refusal(relation.right.start, "scalars on both sides of an order", "vectors", "compare entries")
    if order is not None and relation.sign != "=":
        raise Refusal(relation.right.start, "= before O(x^k)", relation.sign, "write an equation")
    return (first_term.text, second_term.text), tuple(used), order


def refuse_units(text: str, notation: Notation) -> None:
    r"""Refuse ``9.8\,\text{m}`` and ``\mathrm{i} x`` where m and i are declared names, and commas in numbers."""
    for found in UPRIGHT.finditer(text):
        name, kind = found["name"], "a unit" if found["number"] else "the imaginary unit"
        if name not in notation or not (found["number"] or name in ("i", "j")):
            continue
        if not any(found["word"] in spelling for _, spelling in notation.spellings):
            remedy = f"write {name} = '{found['word']}' in [latex] where it is the name"
            raise Refusal(found.start("word"), "one meaning", f"is {name} a name or {kind}?", remedy)
    if comma := re.search(r"\d\{,\}\d", text):
        got = f"{comma[0]}: a decimal comma, or thousands?"
        raise Refusal(comma.start(), "a number with a point or without", got, "write it so")


@contextlib.contextmanager
def shifted(start: int) -> Iterator[None]:
    """Refusals inside get the place of the whole block."""
    try:
        yield
    except Refusal as refusal:
        refusal.at += start
        raise
