"""Source text of a new derivation module, and of one more claim for it.

Formulas come in as texts of the language of files and go out as Python source that keeps them
exact: no integer is divided by an integer, no decimal becomes a float.
"""

from __future__ import annotations

import ast
import keyword
import re
from collections.abc import Sequence

import sympy as sp

from navsym.errors import DomainError, DuplicateError, ExpressionSyntaxError
from navsym.text.expression import parse, symbol
from navsym.text.names import RESERVED, shown
from navsym.text.python_source import side_source

NAME = re.compile(r"[a-z][a-z0-9_]{1,40}")
NUMBER = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,60}\*?")
NAMES_IN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

NOT_YET = '"not looked at yet"'

MODULE = '''"""{heading}: one sentence on the route from the model to the formulas."""

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

x = sp.Symbol("x", real=True)


@claim("example", expect=Status.PROVED)
def example() -> Equation:
    """An example to replace: the printed side stands as in the paper, the derived one follows from a model."""
    return Equation(printed=2 * sp.sin(x) * sp.cos(x), derived=sp.expand_trig(sp.sin(2 * x)))
'''

CLAIM = '''

@claim({arguments})
def {function}() -> Equation:
    """{title}"""
    return Equation(
        printed={printed},
        derived={derived},
    )
'''


def check_module_name(name: str) -> str:
    """The name, when it can be a derivation module; raises ExpressionSyntaxError otherwise."""
    if NAME.fullmatch(name) and not keyword.iskeyword(name):
        return name
    raise ExpressionSyntaxError(
        f"expected a module name of small letters, digits and underscores; got {shown(name)}; do rename it"
    )


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
        name=quoted(check_module_name(name)), heading=plain(title) or name, title=quoted(title or name),
        authors=several(authors), year=year, source=quoted(source), language=quoted(language),
        equations=several(equations), definitions=lines,
    )  # fmt: skip


def quoted(text: str) -> str:
    """A string as Python source, in double quotes where that needs no escaping."""
    return repr(text) if set(text) & set("\"'\\") or not text.isprintable() else f'"{text}"'


def several(texts: Sequence[str]) -> str:
    """A tuple of strings as Python source."""
    return "(" + ", ".join(quoted(text) for text in texts) + ("," if len(texts) == 1 else "") + ")"


def equation_numbers(text: str) -> tuple[str, ...]:
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
        raise DuplicateError("expected each number once; got one twice; do correct the list", where="--equations")
    return tuple(found)


def check_number(number: str) -> str:
    if NUMBER.fullmatch(number):
        return number
    raise ExpressionSyntaxError(
        f"expected an equation number such as 4.3 or 4.3.u2; got {shown(number)}; do correct it"
    )


def plain(text: str) -> str:
    """A sentence that may stand in a docstring."""
    return " ".join(text.replace("\\", "/").replace('"', "'").split())


# -- claims ----------------------------------------------------------------------------------


def with_claim(
    source: str, number: str, title: str, printed: str, derived: str, expect: str, corrects: str, reason: str,
    slip: str = "",
) -> str:  # fmt: skip
    """The source of a module with one more claim at its end.

    Raises DuplicateError when the number is claimed already, DomainError when the file is not a
    derivation module in one file, and what the reader of expressions raises.
    """
    check_number(number)
    tree = module_tree(source)
    if f'@claim("{number}"' in source:
        message = f"expected a new number; got {number}, claimed already; do choose another or edit the file"
        raise DuplicateError(message)
    known = assigned(tree)
    sides = [read(text, where) for text, where in ((printed, "--printed"), (derived, "--derived"))]
    names = sorted({s.name for side in sides for s in side.free_symbols} - known)
    arguments = [f'"{number}"', f"expect=Status.{expect}"]
    arguments += [f'corrects="{check_number(corrects)}"'] if corrects else []
    arguments += [f'slip="{slip}"'] if slip else []
    arguments += [f'reason="{plain(reason)}"'] if reason else []
    block = CLAIM.format(
        arguments=", ".join(arguments), function=function_name(number, known), title=plain(title),
        printed=side_source(sides[0]), derived=side_source(sides[1]),
    )  # fmt: skip
    return looked_at(source, number).rstrip("\n") + "\n" + declared(names) + block


def declared(names: Sequence[str]) -> str:
    """Source that declares new symbols; nothing where there are none."""
    if not names:
        return ""
    made = f'sp.Symbol("{names[0]}"' if len(names) == 1 else f'sp.symbols("{" ".join(names)}"'
    return f"\n\n{', '.join(names)} = {made}, real=True)\n"


def looked_at(source: str, number: str) -> str:
    """The source without the line that lists the equation of a claim as not looked at."""
    equation = number.rstrip("*")
    while equation:
        line = f'        "{equation}": {NOT_YET},\n'
        if line in source:
            return source.replace(line, "", 1)
        equation = equation.rpartition(".")[0]
    return source


def module_tree(source: str) -> ast.Module:
    try:
        tree = ast.parse(source)
    except SyntaxError as error:
        raise DomainError(f"expected a derivation module; got a syntax error at line {error.lineno}") from error
    if not {"PAPER", "sp", "claim", "Equation", "Status"} <= assigned(tree):
        raise DomainError(
            "expected a module made by navsym new-paper, with PAPER, sp, claim, Equation and Status at its top; "
            "got another; do add the imports"
        )
    return tree


def assigned(tree: ast.Module) -> set[str]:
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


def function_name(number: str, known: set[str]) -> str:
    base = "claim_" + re.sub(r"\W", "_", number.replace("*", "_corrected"))
    return next(name for name in (base, *(f"{base}_{k}" for k in range(2, 1000))) if name not in known)


def read(text: str, where: str) -> sp.Expr:
    """A side of a claim, every name declared real; raises ExpressionSyntaxError that names ``where``."""
    names = {name for name in NAMES_IN.findall(text)} - RESERVED
    bad = [name for name in names if keyword.iskeyword(name) or name == "sp"]
    if bad:
        raise ExpressionSyntaxError(f"expected names that Python takes; got {bad[0]}; do rename it", where=where)
    return parse(text, {name: symbol(name) for name in names}, where=where)
