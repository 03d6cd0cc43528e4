"""How names are written: declarations, and the table ``[latex]`` of names that are printed otherwise."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from navsym.core.errors import DuplicateError, ExpressionSyntaxError, ShapeError
from navsym.language.files import name_file
from navsym.language.names import FUNCTIONS, check_name, expect_keys, join_place, quote
from navsym.language.shapes import PROPERTIES
from navsym.language.tomlfile import read_toml

#: Rows and columns, as written; none for a scalar.
Shape = tuple[str, ...]

GREEK = frozenset(
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi rho varrho sigma "
    "varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega ell"
    "".split()
)
BOLD = frozenset("mathbf boldsymbol bm pmb".split())
#: Fonts from here to the end of the group.
SWITCHES = frozenset("bf bfseries rm".split())
WORDS = frozenset("mathrm text textrm operatorname operatorname* mathop rm textnormal".split())
ACCENTS = frozenset(
    "hat widehat tilde widetilde bar overline vec check breve acute grave mathring underline underbar mathcal mathbb "
    "mathfrak mathscr mathsf mathit mathtt".split()
)
DOTS = {"dot": 1, "ddot": 2, "dddot": 3}
#: Spaces, behind which a script belongs to the symbol that follows; and commands that leave no trace.
SPACES = frozenset([*",;:! >\n", "quad", "qquad", "thinspace", "empty"])
SETTINGS = frozenset("displaystyle textstyle limits nolimits mathstrut".split())
SIZES = frozenset(f"{size}{side}" for size in ("big", "Big", "bigg", "Bigg") for side in ("", "l", "r"))

#: Commands and words that are functions of the language.
CALLS: Mapping[str, str] = {name: name for name in FUNCTIONS} | dict(
    arcsin="asin", arccos="acos", arctan="atan", ln="log", arctan2="atan2", sgn="sign", sign="sign", tr="trace",
    arsinh="asinh", arcosh="acosh", artanh="atanh", Tr="trace", trace="trace", det="det", diag="diag", skew="skew",
    erf="erf", min="min", max="max", expm="expm", rot="rot", E="E", cov="cov", Cov="cov",
)  # fmt: skip
#: Commands of LaTeX that are functions; other names of functions stand in ``\operatorname`` or ``\mathrm``.
COMMANDS = frozenset("sin cos tan cot sec csc exp ln log sinh cosh tanh arcsin arccos arctan det min max".split())

#: Words of a sentence that stand beside a formula; they are no names.
SENTENCE = frozenset("if for when otherwise else and or where with such that as is are by of in on the to".split())
#: Words in rows of cases: before a condition, and for all the rest.
IF, REST = ("if", "for", "when"), ("otherwise", "else", "elsewhere")
#: Relations inside the conditions of cases.
CONDITIONS = {"<": "<", ">": ">", "=": "=", "le": "<=", "leq": "<=", "ge": ">=", "geq": ">=", "ne": "!=", "neq": "!="}

DECLARATIONS = ("vector", "rotation", "quaternion", "matrix", "function", "integer", "random")
COMPANIONS = ("unit", "frame", "range", *PROPERTIES)


@dataclass(frozen=True, slots=True)
class Notation:
    r"""What is declared, and how it is written.

    written   : name -> declaration, as in ``[symbols]``
    shapes    : name -> rows and columns, none for a scalar
    spellings : (name, LaTeX), as in ``[latex]``
    rates     : name -> its rate, as in ``[rates]``
    quaternions, functions : names of quaternions, True where one has unit length; name -> variable of its function
    """

    written: Mapping[str, Any] = field(default_factory=dict)
    shapes: Mapping[str, Shape] = field(default_factory=dict)
    spellings: tuple[tuple[str, str], ...] = ()
    rates: Mapping[str, str] = field(default_factory=dict)
    quaternions: Mapping[str, bool] = field(default_factory=dict)
    functions: Mapping[str, str] = field(default_factory=dict)

    def __contains__(self, name: object) -> bool:
        return name in self.shapes

    @property
    def has_skew_floor(self) -> bool:
        r"""True where the entry ``skew = '\lfloor\cdot\rfloor'`` says that these brackets are cross matrices."""
        plain = [(name, re.sub(r"\\left|\\right|\s+", "", latex)) for name, latex in self.spellings]
        return ("skew", r"\lfloor\cdot\rfloor") in plain

    def is_vector(self, name: str) -> bool:
        """True for a declared column."""
        return self.shapes.get(name, ())[1:] == ("1",)


def read_notation(path: str | os.PathLike[str]) -> Notation:
    """The notation of a TOML file with ``[symbols]``, and ``[latex]`` and ``[rates]`` where needed.

    Raises NavsymError for a file that is none, ExpressionSyntaxError, ShapeError or DuplicateError for a wrong entry.
    """
    where, document = name_file(path), read_toml(path)
    expect_keys({key: table for key, table in document.items() if key != "claim"}, ("symbols", "latex", "rates"), where)
    return build_notation(document.get("symbols", {}), document.get("latex", {}), document.get("rates", {}), where)


def build_notation(symbols: Any, latex: Any, rates: Any, where: str) -> Notation:
    """The notation of the three tables."""
    for key, table in (("symbols", symbols), ("latex", latex), ("rates", rates)):
        if not isinstance(table, Mapping):
            message = f"expected a table of names; got {quote(table)}; write name = …"
            raise ShapeError(message, where=join_place(where, key))
    shapes: dict[str, Shape] = {}
    quaternions, functions = {}, {}
    for name, declaration in symbols.items():
        place = join_place(join_place(where, "symbols"), name)
        shapes[check_name(name, where=place)] = read_shape(declaration, place)
        if isinstance(declaration, Mapping) and "quaternion" in declaration:
            quaternions[name] = declaration["quaternion"] == "unit"
        if isinstance(declaration, Mapping) and "function" in declaration:
            functions[name] = str(declaration["function"])
    require_spellings(latex, shapes, join_place(where, "latex"))
    return Notation(dict(symbols), shapes, tuple(latex.items()), dict(rates), quaternions, functions)


def require_spellings(latex: Mapping[str, Any], shapes: Mapping[str, Shape], where: str) -> None:
    """Refuse a spelling of a name that is not declared, one that is no text, and one of two names."""
    owners: dict[str, str] = {}
    for name, spelling in latex.items():
        place = join_place(where, name)
        if not isinstance(spelling, str) or not spelling.strip() or len(spelling) > 200:
            message = f"expected LaTeX as text, at most 200 characters; got {quote(spelling)}; write {name} = '…'"
            raise ExpressionSyntaxError(message, where=place)
        if name not in shapes and name not in CALLS and name != "eye":
            message = f"expected a declared name; got {quote(name)}; declare it below [symbols]"
            raise ExpressionSyntaxError(message, where=place)
        plain = re.sub(r"\s+", "", spelling)
        if plain in owners:
            message = f"expected one name for {quote(spelling)}; got {owners[plain]} and {name}; remove one"
            raise DuplicateError(message, where=place)
        owners[plain] = name


def read_shape(declaration: Any, where: str) -> Shape:
    """Rows and columns of what a declaration declares; none for a scalar."""
    if not isinstance(declaration, Mapping):
        require_scalar(declaration, where)
        return ()
    expect_keys(declaration, (*DECLARATIONS, *COMPANIONS), where)
    if "quaternion" in declaration:
        return ("4", "1")
    if "rotation" in declaration:
        return ("3", "3")
    if "vector" in declaration:
        return (str(declaration["vector"]), "1")
    if "matrix" in declaration:
        size = declaration["matrix"]
        if not isinstance(size, (list, tuple)) or len(size) != 2:
            message = f'expected rows and columns; got {quote(size)}; write matrix = ["3", "3"]'
            raise ShapeError(message, where=join_place(where, "matrix"))
        return (str(size[0]), str(size[1]))
    return ()


def require_scalar(declaration: Any, where: str) -> None:
    """Refuse a declaration of a scalar that is none."""
    words = ("real", "positive", "nonnegative", "nonzero")
    ends = isinstance(declaration, (list, tuple)) and len(declaration) == 2
    if not ends and declaration not in words:
        expected = f'a range such as ["0", "1"], one of {", ".join(words)}, or a table such as {{ vector = 3 }}'
        raise ExpressionSyntaxError(f"expected {expected}; got {quote(declaration)}; correct it", where=where)
