"""Source text of a new derivation module, and of one more claim for it.

Formulas come in as texts of the language of files and go out as Python source that keeps them
exact: no integer is divided by an integer, no decimal becomes a float.
"""

from __future__ import annotations

import ast
import keyword
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError, DuplicateError, ExpressionSyntaxError, UnknownSymbolError
from navsym.language.expression import parse, symbol
from navsym.language.names import RESERVED, quote
from navsym.language.printer import python_terms, to_python

NAME = re.compile(r"[a-z][a-z0-9_]{1,40}")
NUMBER = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,60}\*?")
NAMES_IN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

#: A side that is longer is written with one term on each line.
WIDE = 92

NOT_YET = '"not looked at yet"'

MODULE = """{heading}

from __future__ import annotations

import sympy as sp

from navsym.claims import Equation, Paper, Status, claim

PAPER = Paper(
    module={name},
    title={title},
    authors={authors},
    year={year},
    source={source},
    language={language},
    equations={equations},
    definitions={{
{definitions}    }},
)
{example}"""

EXAMPLE = '''
x = sp.Symbol("x", real=True)


@claim("example", expect=Status.PROVED)
def example() -> Equation:
    """An example to replace: the printed side stands as in the paper, the derived one follows from a model."""
    return Equation(printed=2 * sp.sin(x) * sp.cos(x), derived=sp.expand_trig(sp.sin(2 * x)))
'''

CLAIM = """

@claim({arguments})
def {function}() -> Equation:
    {title}
    return Equation(
        printed={printed},
        derived={derived},
{tolerance}    )
"""

STATED = """

@claim({arguments})
def {function}() -> Statement:
    {title}
    return {call}
"""

#: What a claim in the words of files imports beside what every module does.
STATED_IMPORTS = """from navsym.claims import Statement
from navsym.prove.formulas import state_formula
"""


def check_module_name(name: str) -> str:
    """The name, when it can be a derivation module; raises ExpressionSyntaxError otherwise."""
    if isinstance(name, str) and NAME.fullmatch(name) and not keyword.iskeyword(name):
        return name
    expected = "a module name of a-z, 0-9 and _ that is no word of Python"
    raise ExpressionSyntaxError(f"expected {expected}; got {quote(name)}; rename it")


def module_source(
    name: str,
    title: str,
    authors: Sequence[str],
    year: int | None,
    source: str,
    language: str,
    equations: Sequence[str],
) -> str:
    """A derivation module that passes the generic tests: every equation is listed, one example is proved.

    Raises ExpressionSyntaxError for a name that cannot be a module.
    """
    for number in equations:
        check_number(number)
    lines = "".join(f'        "{number}": {NOT_YET},\n' for number in equations)
    return MODULE.format(
        name=quote_string(check_module_name(name)),
        heading=write_docstring(f"{title or name}: one sentence on the route from the model to the formulas."),
        title=quote_string(title or name),
        authors=write_tuple(authors),
        year=year,
        source=quote_string(source),
        language=quote_string(language),
        equations=write_tuple(equations),
        definitions=lines,
        example=EXAMPLE,
    )


def quote_string(text: str) -> str:
    """A string as Python source, in double quotes where that needs no escaping."""
    return repr(text) if set(text) & set("\"'\\") or not text.isprintable() else f'"{text}"'


def write_tuple(texts: Sequence[str]) -> str:
    """A tuple of strings as Python source."""
    return "(" + ", ".join(quote_string(text) for text in texts) + ("," if len(texts) == 1 else "") + ")"


def split_numbers(text: str) -> tuple[str, ...]:
    """``"1-6"``, ``"1.1-1.9, 2.1"`` or a list with commas, as numbers in order.

    Raises ExpressionSyntaxError for text that is no list of numbers, DuplicateError for a number that stands twice.
    """
    found: list[str] = []
    for part in (piece.strip() for piece in text.split(",")):
        first, dash, last = part.partition("-")
        prefix, _, low = first.strip().rpartition(".")
        high = last.strip().rpartition(".")[2]
        if dash and low.isdigit() and high.isdigit() and int(low) <= int(high) <= int(low) + 500:
            found += [f"{prefix}.{k}" if prefix else str(k) for k in range(int(low), int(high) + 1)]
        elif part:
            found.append(check_number(part))
    if len(set(found)) < len(found):
        raise DuplicateError("expected each number once; got one twice; correct the list", where="--equations")
    return tuple(found)


def check_number(number: str) -> str:
    """The number of an equation; raises ExpressionSyntaxError when it has another form."""
    if NUMBER.fullmatch(number):
        return number
    raise ExpressionSyntaxError(f"expected an equation number such as 4.3 or 4.3.u2; got {quote(number)}; correct it")


def one_line(text: str, where: str) -> str:
    """The text without blanks around it; raises ExpressionSyntaxError for more than one printable line."""
    if not text.strip().isprintable():
        message = f"expected one printable line; got {quote(text)}; remove line ends and control characters"
        raise ExpressionSyntaxError(message, where=where)
    return text.strip()


def write_docstring(text: str) -> str:
    """Source of a docstring that is the sentence."""
    sentence = one_line(text, "--title")
    return repr(sentence) if set(sentence) & set('"\\') else f'"""{sentence}"""'


def side_source(expression: sp.Expr) -> str:
    """Source of a side of a claim: a sympy value even for a bare number, a long sum with one term on each line."""
    if isinstance(expression, sp.Integer):
        return f"sp.Integer({int(expression)})"
    text = to_python(expression)
    if len(text) <= WIDE or not isinstance(expression, sp.Add):
        return text
    return "(\n" + "".join(f"            {term}\n" for term in python_terms(expression)) + "        )"


# -- claims ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NewClaim:
    """One more claim as words: what ``navsym new-claim`` is told, and the verdict that it found.

    positive  : names that this claim declares positive; other new names are declared real
    tolerance : of a printed numeral, or None
    call      : arguments of ``state_formula``, which take the place of both sides; empty for two sides
    """

    number: str
    title: str
    printed: str = ""
    derived: str = ""
    expect: str = "OPEN"
    corrects: str = ""
    reason: str = ""
    slip: str = ""
    positive: frozenset[str] = frozenset()
    tolerance: str | None = None
    call: Mapping[str, Any] = field(default_factory=dict)

    @property
    def arguments(self) -> str:
        """What stands in the brackets of the decorator."""
        found = [f'"{self.number}"', f"expect=Status.{self.expect}"]
        found += [f'corrects="{check_number(self.corrects)}"'] if self.corrects else []
        found += [f'slip="{self.slip}"'] if self.slip else []
        found += [f"reason={quote_string(one_line(self.reason, '--reason'))}"] if self.reason else []
        return ", ".join(found)


def append_claim(source: str, new: NewClaim) -> str:
    """The source of a module with one more claim at its end, which takes the place of the example.

    Raises DuplicateError when the number is claimed already, DomainError when the file is not a
    derivation module in one file, UnknownSymbolError for a positive name that no side has, and what
    the reader of expressions raises.
    """
    check_number(new.number)
    if f'@claim("{new.number}"' in source:
        message = f"expected a new number; got {new.number}, claimed already; choose another or edit the file"
        raise DuplicateError(message)
    source = source.replace(EXAMPLE, "", 1)
    tree = parse_module(source)
    if new.call:
        return append_stated(source, new, names_at_top(tree))
    given = read_declarations(tree, new.positive)
    texts = ((new.printed, "--printed"), (new.derived, "--derived"))
    sides = [read_claim_side(text, where, given) for text, where in texts]
    used = {s.name for side in sides for s in side.free_symbols}
    if idle := sorted(new.positive - used):
        raise UnknownSymbolError(f"expected names of the two sides; got {idle[0]}; leave it out", where="--positive")
    block = CLAIM.format(
        arguments=new.arguments,
        function=name_function(new.number, names_at_top(tree)),
        title=write_docstring(new.title),
        printed=side_source(sides[0]),
        derived=side_source(sides[1]),
        tolerance="" if new.tolerance is None else f"        tolerance={side_source(read_tolerance(new.tolerance))},\n",
    )
    names = used - names_at_top(tree)
    declared = write_declarations("real", names - new.positive) + write_declarations("positive", names & new.positive)
    return strike_off(source, new.number).rstrip("\n") + "\n" + declared + block


def append_stated(source: str, new: NewClaim, known: set[str]) -> str:
    """The source of a module with one more claim in the words of files."""
    function, title = name_function(new.number, known), write_docstring(new.title)
    block = STATED.format(arguments=new.arguments, function=function, title=title, call=write_call(new.call))
    if "state_formula" not in known:
        first = next(n for n in ast.parse(source).body if isinstance(n, ast.ImportFrom) and n.module == "navsym.claims")
        lines = source.splitlines(keepends=True)
        source = "".join([*lines[: first.end_lineno], STATED_IMPORTS, *lines[first.end_lineno :]])
    return strike_off(source, new.number).rstrip("\n") + "\n" + block


def write_call(arguments: Mapping[str, Any]) -> str:
    """A call of ``state_formula`` as source: texts by place under ``""``, everything else by its name."""
    parts = [quote_formula(text) for text in arguments[""]]
    names = {name: value for name, value in arguments.items() if name and value not in (None, (), [], {})}
    parts += [f"{name}={write_plain(value)}" for name, value in names.items() if not keyword.iskeyword(name)]
    if words := {name: value for name, value in names.items() if keyword.iskeyword(name)}:
        parts.append(f"**{write_plain(words)}")
    whole = f"state_formula({', '.join(parts)})"
    return whole if len(whole) <= WIDE else "state_formula(\n        " + ",\n        ".join(parts) + ",\n    )"


def write_plain(value: Any) -> str:
    """A declaration as Python source: texts, whole numbers, lists and tables of these."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{quote_string(str(key))}: {write_plain(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(write_plain, value)) + "]"
    return repr(value) if type(value) in (bool, int) else quote_string(str(value))


def quote_formula(text: str) -> str:
    """A formula as Python source: LaTeX as it is printed."""
    is_raw = "\\" in text and text.isprintable() and not text.endswith("\\") and '"' not in text
    return f'r"{text}"' if is_raw else quote_string(text)


def write_declarations(kind: str, names: set[str]) -> str:
    """Source that declares new symbols; nothing where there are none."""
    if not names:
        return ""
    ordered = sorted(names)
    made = f'sp.Symbol("{ordered[0]}"' if len(ordered) == 1 else f'sp.symbols("{" ".join(ordered)}"'
    return f"\n\n{', '.join(ordered)} = {made}, {kind}=True)\n"


def read_tolerance(text: str) -> sp.Rational:
    """Half a unit of the last digit, or another positive number, exactly; raises DomainError for anything else."""
    value = read_claim_side(text, "--tolerance")
    if isinstance(value, sp.Rational) and value.is_positive:
        return value
    raise DomainError(f"expected a positive number such as 0.05; got {quote(text)}; write one", where="--tolerance")


def read_declarations(tree: ast.Module, positive: frozenset[str] = frozenset()) -> dict[str, sp.Symbol]:
    """Symbols as the file declares them at its top, and ``positive`` ones that it does not declare yet.

    Raises DuplicateError for a positive name that the file declares otherwise.
    """
    found: dict[str, sp.Symbol] = {}
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            found |= read_symbol_call(node.value)
    for name in sorted(positive):
        if name in found and not found[name].is_positive:
            message = f"expected a new name; got {name}, which the file declares already; change its line there"
            raise DuplicateError(message, where="--positive")
        found[name] = symbol(name, positive=True)
    return found


KINDS = ("real", "positive", "nonnegative", "nonzero")


def read_symbol_call(call: ast.Call) -> dict[str, sp.Symbol]:
    """What ``sp.Symbol("x", real=True)`` or ``sp.symbols("x y", positive=True)`` declares; nothing for another call."""
    named = isinstance(call.func, ast.Attribute) and call.func.attr in ("Symbol", "symbols")
    text = call.args[0].value if named and call.args and isinstance(call.args[0], ast.Constant) else ""
    if not isinstance(text, str):
        return {}
    known = {kind: any(key.arg == kind for key in call.keywords) for kind in KINDS}
    names = [name for name in text.replace(",", " ").split() if NAMES_IN.fullmatch(name) and name not in RESERVED]
    return {name: symbol(name, where="", **known) for name in names}


def read_equation_numbers(source: str) -> tuple[str, ...]:
    """The numbers that the card of a module lists; empty where they are not written out.

    Raises DomainError for a file that was not begun by new-paper.
    """
    for node in ast.walk(parse_module(source)):
        if isinstance(node, ast.keyword) and node.arg == "equations" and isinstance(node.value, ast.Tuple):
            return tuple(str(part.value) for part in node.value.elts if isinstance(part, ast.Constant))
    return ()


def strike_off(source: str, number: str) -> str:
    """The source without the line that lists the equation of a claim as not looked at."""
    equation = number.rstrip("*")
    while equation:
        line = f'        "{equation}": {NOT_YET},\n'
        if line in source:
            return source.replace(line, "", 1)
        equation = equation.rpartition(".")[0]
    return source


def parse_module(source: str) -> ast.Module:
    """The syntax tree of a derivation module; raises DomainError for a file that was not begun by new-paper."""
    try:
        tree = ast.parse(source)
    except SyntaxError as error:
        raise DomainError(f"expected a derivation module; got a syntax error at line {error.lineno}") from error
    if not {"PAPER", "sp", "claim", "Equation", "Status"} <= names_at_top(tree):
        expected = "a module made by navsym new-paper, with PAPER, sp, claim, Equation and Status at its top"
        raise DomainError(f"expected {expected}; got another; add the imports")
    return tree


def names_at_top(tree: ast.Module) -> set[str]:
    """Names that a module defines or imports at its top."""
    names: set[str] = set()
    for node in tree.body:
        if isinstance(node, ast.Assign):
            targets = [t for target in node.targets for t in getattr(target, "elts", [target])]
            names |= {t.id for t in targets if isinstance(t, ast.Name)}
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
    return names


def name_function(number: str, known: set[str]) -> str:
    """A name that is not yet known for the function of a claim: ``claim_2_17_corrected`` of 2.17*."""
    base = "claim_" + re.sub(r"\W", "_", number.replace("*", "_corrected"))
    return next(name for name in (base, *(f"{base}_{k}" for k in range(2, 1000))) if name not in known)


def read_claim_side(text: str, where: str, given: Mapping[str, sp.Symbol] | None = None) -> sp.Expr:
    """A side of a claim; names are those ``given``, or declared real.

    Raises ExpressionSyntaxError that names ``where``.
    """
    names = {name for name in NAMES_IN.findall(text)} - RESERVED
    bad = [name for name in names if keyword.iskeyword(name) or name == "sp"]
    if bad:
        raise ExpressionSyntaxError(f"expected names that Python takes; got {bad[0]}; rename it", where=where)
    known = given or {}
    return parse(text, {name: known.get(name) or symbol(name) for name in names}, where=where)
