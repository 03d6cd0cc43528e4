"""Concrete syntax: the grammars of tree-sitter, loaded when first needed, and bounds on what they are given."""

from __future__ import annotations

import functools
import importlib
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, ClassVar

from navsym.audit.form import Argument, Function, Part, Unit
from navsym.core.errors import MissingEngineError, TooLargeError

DEPTH = 200
SIZE = 2_000_000
NODES = 400_000
DECIMAL = re.compile(r"(?=\.?\d)\d*\.?\d*(e[+-]?\d{1,3})?", re.ASCII | re.IGNORECASE)
ADDRESS = re.compile(r"&\s*[A-Za-z_]\w*", re.ASCII)
COMMENTS = ("comment", "line_continuation", "line_comment", "block_comment")


@functools.cache
def load_parser(grammar: str) -> Any:
    """The parser of a grammar, such as ``c`` or ``rust``; raises MissingEngineError without its wheel."""
    try:
        from tree_sitter import Language, Parser

        module = importlib.import_module(f"tree_sitter_{grammar}")
    except ImportError:
        wheel = f"tree-sitter-{grammar}"
        message = f"expected the grammar {wheel}; got none on this machine; install tree-sitter and {wheel} with pip"
        raise MissingEngineError(message, where="audit") from None
    return Parser(Language(module.language()))


def parse_source(source: bytes, grammar: str, where: str) -> Any:
    """The root of the syntax tree of a source; raises TooLargeError for files and trees past the bounds."""
    if len(source) > SIZE:
        raise TooLargeError(f"expected a file of at most {SIZE} bytes; got {len(source)}; split it", where=where)
    root = load_parser(grammar).parse(source).root_node
    cursor, depth, count = root.walk(), 0, 0
    while True:
        count += 1
        if depth > DEPTH or count > NODES:
            got = f"one deeper than {DEPTH}" if depth > DEPTH else f"more than {NODES} parts"
            message = f"expected nested source of bounded size; got {got}; split it"
            raise TooLargeError(message, where=f"{where}: line {line_of(cursor.node)}")
        if cursor.goto_first_child():
            depth += 1
            continue
        while not cursor.goto_next_sibling():
            if not cursor.goto_parent():
                return root
            depth -= 1


def text_of(node: Any) -> str:
    """The source of a node; nothing of one that is not there."""
    return "" if node is None else str(node.text.decode("utf-8", "replace"))


def line_of(node: Any) -> int:
    """The line of a node, from 1."""
    return int(node.start_point[0]) + 1


def named(node: Any) -> list[Any]:
    """The children that are more than signs; comments left out."""
    return [child for child in (node.named_children if node is not None else ()) if child.type not in COMMENTS]


def field_of(node: Any, name: str) -> Any:
    """The child in a field, or None."""
    return None if node is None else node.child_by_field_name(name)


def find_body(node: Any) -> Any:
    """The body of a statement."""
    block = next((child for child in named(node) if child.type == "block"), None)
    return field_of(node, "consequence") or field_of(node, "body") or block


def sign_of(node: Any) -> str:
    """The operator between two operands, or before one."""
    return next((text_of(child) for child in node.children if not child.is_named), "")


def descend(node: Any) -> Iterator[Any]:
    """A node and all below it."""
    waiting = [node]
    while waiting:
        current = waiting.pop()
        yield current
        waiting.extend(current.children)


def ascend(node: Any) -> Iterator[Any]:
    """The nodes around a node, the nearest first."""
    while (node := node.parent) is not None:
        yield node


def list_above(node: Any) -> list[str]:
    """The kinds of the nodes around a node, the nearest first."""
    return [above.type for above in ascend(node)]


def identifiers_in(node: Any) -> tuple[str, ...]:
    """The names below a node: what a refused statement may write."""
    kinds = ("identifier", "field_identifier")
    return tuple(dict.fromkeys(text_of(inner) for inner in descend(node) if inner.type in kinds))


def find_odd(node: Any) -> str:
    """The kind of something below a node that nobody reads; nothing where all is read."""
    known = SLOTS.get(node.type, frozenset())
    for i, child in enumerate(node.children):
        slot = node.field_name_for_child(i) or child.type.replace("\n", "NL")
        is_known = slot in known or ("*" in known and child.is_named and slot == child.type)
        if child.type not in COMMENTS and not is_known:
            return str(child.type).replace("_", " ")
        if child.type in INNER and (odd := find_odd(child)):
            return odd
    return ""


@functools.lru_cache(1 << 12)
def read_decimal(text: str) -> Fraction | None:
    """The exact value of decimal digits, with a point and an exponent of at most three digits; None for others."""
    return Fraction(text) if len(text) <= 60 and DECIMAL.fullmatch(text) else None


#: Where the order of statements is left, in any of the grammars.
JUMPS = frozenset(
    "return_statement goto_statement break_statement continue_statement throw_statement raise_statement yield "
    "labeled_statement case_statement ERROR return_expression break_expression continue_expression try_expression "
    "macro_invocation await_expression".split()
)


#: What may write names inside an expression, in any of the grammars.
WRITES = frozenset(
    "assignment_expression update_expression assignment augmented_assignment named_expression call_expression call "
    "function_call lambda_expression lambda compound_statement new_expression delete_expression ERROR "
    "compound_assignment_expr macro_invocation closure_expression unsafe_block mutable_specifier pointer_expression "
    "raw".split()
)


#: Sign -> kind of the part, and the sign in it, where one is there; a language adds its own.
OPERATORS: dict[str, tuple[str, ...]] = {
    **{sign: ("op", sign) for sign in "+ - * / %".split()},
    **{sign: ("compare", sign) for sign in "< <= > >= == !=".split()},
    **dict.fromkeys(("&&", "and"), ("both",)),
    **dict.fromkeys(("||", "or"), ("either",)),
}
UNARY = {"-": "minus", "!": "not", "not": "not"}

#: What each node of the grammars may have below it: fields, signs and words, and "*" for parts that are all read. A
#: node that is read and has anything else below it is refused, as an ``else`` behind a loop, or an attribute.
SLOTS: dict[str, frozenset[str]] = {
    kind: frozenset(slots.split())
    for kinds, slots in (
        ("argument_list arguments parenthesized_expression parenthesis", "* argument ( ) ,"),
        ("array_declarator", "declarator size [ ]"), ("array_expression", "* [ ] , ; length"),
        ("assert_statement", "* assert ,"), ("assignment", "left right type = :"),
        ("assignment_expression", "left operator right ="), ("attribute", "object . attribute"),
        ("augmented_assignment compound_assignment_expr", "left operator right"),
        ("binary_expression", "left operator right"), ("boolean_operator", "left operator right && ||"),
        ("binary_operator", "left operator right + - * / ^ .* ./ .^ & |"),
        ("call call_expression", "function arguments"), ("cast_expression", "( type value )"),
        ("comma_expression", "left , right"), ("comparison_operator", "* operators < <= > >= == ~= !="),
        ("compound_statement block initializer_list", "* { } , ;"), ("condition_clause", "( value )"),
        ("conditional_expression", "condition ? consequence : alternative * if else"),
        ("const_item", "const name : type = value ; visibility_modifier"),
        ("declaration", "storage_class_specifier type_qualifier type declarator , ;"),
        ("do_statement", "do body while condition ;"), ("elif_clause", "elif condition : consequence"),
        ("else_clause", "else * body"), ("elseif_clause", "elseif condition * , ; NL"), ("end_keyword", "end"),
        ("expression_list tuple list row pattern_list", "* , ( ) [ ]"), ("expression_statement", "* ;"),
        ("field_expression", "argument operator field value . object *"),
        ("for_expression", "for pattern in value body"),
        ("for_statement", "for ( initializer ; condition update ) body left in right : iterator , end endfor NL *"),
        ("function_call", "name arguments argument * ( )"), ("if_expression", "if condition consequence alternative"),
        ("if_statement", "if condition consequence alternative : * , ; end endif NL"), ("index_expression", "* [ ]"),
        ("init_declarator", "declarator = value"), ("iterator", "* ="),
        ("let_declaration", "let mutable_specifier pattern : type = value else alternative ;"), ("matrix", "* [ ] ;"),
        ("not_operator", "* not argument ~ !"), ("pointer_declarator", "declarator * type_qualifier"),
        ("pointer_expression", "operator argument"), ("postfix_operator", "operand ' .'"),
        ("qualified_identifier scoped_identifier", "scope path :: name"),
        ("range range_expression", "* : .. ..= ( )"), ("reference_expression", "& mutable_specifier value"),
        ("return_expression return_statement", "return * ; ,"), ("slice", "* :"), ("string", "*"),
        ("subscript", "value [ subscript , ]"), ("subscript_argument_list", "* [ ] ,"),
        ("subscript_expression", "argument [ index indices ]"),
        ("switch_statement", "switch * condition body , ; end endswitch NL"),
        ("type_cast_expression", "value as type"), ("type_descriptor", "type type_qualifier"),
        ("unary_expression unary_operator update_expression", "operator argument operand * - + ! ~"),
        ("while_expression", "while condition body"),
        ("while_statement", "while condition : body * , ; end endwhile ( ) NL"),
    )
    for kind in kinds.split()
}  # fmt: skip
#: Parts that are read together with what is above them.
INNER = frozenset(
    "argument_list arguments array_declarator condition_clause init_declarator iterator pattern_list "
    "pointer_declarator range_expression subscript_argument_list type_descriptor".split()
)


@dataclass(slots=True, eq=False)
class SourceReader:
    """Walks the syntax tree of one language; ``shift`` moves the spans of a text that was read alone.

    places : name that the file defines -> what is around each of its definitions, the outermost first
    opened : namespaces and classes whose names are known elsewhere, too
    pointers : pointers, arrays and references that the function being read declares

    A language has ``read_file``, ``read_statement``, ``read_expression``, which give None for what is outside of it,
    ``places_open_to``, the places whose names a bare name may mean at a node, or a member of the own object,
    ``effect``, what an expression writes that stands alone, and VALUE, the way to the expression in the tree of HEAD, a
    text and TAIL: the kind of a statement, and fields, of which an empty one stands for the first part. A node with an
    error in it is refused as a whole, unless it is a statement of a kind in OPEN, whose own statements are looked at.
    """

    HEAD: ClassVar[str] = "a_ = "
    TAIL: ClassVar[str] = ";"
    VALUE: ClassVar[tuple[str, ...]]
    OPEN: ClassVar[tuple[str, ...]] = ("if_statement", "for_statement")
    OPERATORS: ClassVar[dict[str, tuple[str, ...]]] = OPERATORS
    UNARY: ClassVar[dict[str, str]] = UNARY
    REALS: ClassVar[frozenset[str]] = frozenset()

    read_statement: ClassVar[Any]
    read_expression: ClassVar[Any]
    effect: ClassVar[Any]
    places_open_to: ClassVar[Any]

    unit: Unit
    shift: int = 0
    places: dict[str, set[tuple[str, ...]]] = field(default_factory=dict)
    opened: set[str] = field(default_factory=set)
    pointers: set[str] = field(default_factory=set)

    @classmethod
    def read_text(cls, text: str, unit: Unit) -> Part:
        """One expression; its spans count from its own beginning."""
        reader = cls(unit, -len(cls.HEAD))
        root = reader.parse(f"{cls.HEAD}{text}{cls.TAIL}".encode())
        nodes = named(root)
        value = nodes[0] if [node.type for node in nodes] == [cls.VALUE[0]] and not root.has_error else None
        for name in cls.VALUE[1:]:
            value = field_of(value, name) if name else next(iter(named(value)), None)
        return Part("refused", 1, ("no expression",)) if value is None else reader.expression(value)

    def parse(self, source: bytes) -> Any:
        """The root of the syntax tree of a source."""
        return parse_source(source, self.unit.language, self.unit.file)

    def statement(self, node: Any) -> tuple[Part, ...]:
        """A statement; a wrong one is not read, and neither is one outside the language of audit."""
        if node.has_error and node.type not in self.OPEN:
            return (self.unread(node, "a syntax error, or a macro that hides one"),)
        several: tuple[Part, ...] | None = self.read_statement(node)
        several = self.read_common(node) if several is None else several
        is_read = any(part.kind not in ("unread", "jump", "fail") for part in several)
        return (self.unread(node, f"{odd} in a statement"),) if is_read and (odd := find_odd(node)) else several

    def read_common(self, node: Any) -> tuple[Part, ...]:
        """What most languages have, by its kinds in their grammars."""
        match node.type:
            case "expression_statement":
                return tuple(s for child in named(node) for s in self.effect(child))
            case "return_statement":
                values = named(node)
                return (self.part("return", node, self.expression(values[0]) if values else None),)
            case "while_statement" | "while_expression":
                test = self.expression(field_of(node, "condition"))
                return (self.part("loop", node, (), test, (), self.block(find_body(node)), False),)
            case "raise_statement" | "throw_statement":
                return (self.part("fail", node, "an error is raised"),)
        return (self.outside(node),)

    def outside(self, node: Any) -> Part:
        """A statement that is not read."""
        return self.unread(node, f"a statement outside the language of audit ({node.type.replace('_', ' ')})")

    def block(self, node: Any) -> tuple[Part, ...]:
        """The statements of a body; the grammar may take one for two, without a sign between them."""
        lost = {line_of(child) for child in (node.children if node is not None else ()) if child.is_missing}
        odd = [child for child in named(node) if lost & {line_of(child), child.end_point[0] + 1}]
        parts = {child.id: self.unread(child, "a line that the grammar takes for two statements") for child in odd}
        return tuple(s for c in named(node) for s in ((parts[c.id],) if c.id in parts else self.statement(c)))

    def expression(self, node: Any) -> Part:
        """An expression; a wrong or missing one is refused, and so is one outside the language of audit."""
        if node is None:
            return Part("refused", 0, ("a syntax error", (), True, True))
        if node.has_error:
            return self.refuse(node, "a syntax error")
        found = self.read_expression(node) or self.read_plain(node)
        kind = node.type.replace("_", " ")
        if found is not None and found.kind != "refused" and (odd := find_odd(node)):
            return self.refuse(node, f"{odd} in an expression")
        return self.refuse(node, f"an expression outside the language of audit ({kind})") if found is None else found

    def read_plain(self, node: Any) -> Part | None:
        """What most languages have, by its kinds in their grammars."""
        match node.type:
            case "true" | "false" | "boolean" | "boolean_literal":
                kind = "bool" if self.unit.language == "python" else "int"
                return self.part("number", node, int(text_of(node).lower() == "true"), kind)
            case "identifier" | "field_identifier" | "qualified_identifier" | "this" | "self" | "end_keyword":
                return self.part("name", node, text_of(node))
            case "list" | "tuple" | "expression_list" | "initializer_list" | "matrix" | "row":
                return self.part("list", node, self.several(named(node)))
            case "attribute" | "field_expression":
                name = "".join(text_of(node).split())
                is_name = re.fullmatch(r"[^\W\d][\w.]*", name) is not None
                return self.part("name", node, name) if is_name else self.refuse(node, "a member of an expression")
            case "parenthesized_expression" | "parenthesis" | "condition_clause" if len(named(node)) == 1:
                return self.expression(named(node)[0])
            case "binary_expression" | "binary_operator" | "boolean_operator" | "comparison_operator":
                if len(sides := named(node)) == 2:
                    return self.operate(node, sign_of(node), *sides)
                return self.refuse(node, "a chain of comparisons")
            case "unary_expression" | "unary_operator" | "not_operator":
                return self.operate_alone(node, sign_of(node), named(node)[-1])
        return None

    def is_seen(self, node: Any, name: str, is_member: bool = False) -> bool:
        """True where a name means at a node what the file defines under it, or the file defines nothing under it."""
        if self.shift < 0 or not (known := self.places.get(name)):
            return True  # of an expression that is read alone nobody knows where it stands
        near = {*self.places_open_to(node, is_member)}
        return any(place in near or self.opened & {*place[-1:]} for place in known)

    def elsewhere(self, node: Any, what: str) -> Part:
        """A name of the file that is not known at a node."""
        return self.refuse(node, f"{what}, which this file defines in another place")

    def region_of(self, node: Any) -> tuple[int, int] | None:
        """The bytes in which a name is known that is defined at a node; None where it is everywhere."""
        return None

    def define(self, node: Any, name: str, arguments: Iterable[Argument], body: tuple[Part, ...], *more: Any) -> None:
        """One more function of the file."""
        number, extent = more[1] if len(more) > 1 else "auto", (node.start_byte, node.end_byte)
        outputs, region = (*more, ())[0], self.region_of(node)
        function = Function(name, line_of(node), tuple(arguments), body, outputs, number, region, extent)
        self.unit.functions.setdefault(name, []).append(function)

    def take(self, node: Any, text: str, name: str = "") -> None:
        """Note the types in a text that are taken as real though the file does not say what they are."""
        words = self.REALS & {*re.findall(r"\w+", text)} - self.unit.types.keys()
        self.unit.taken += [(word, node.start_byte, name) for word in words if not self.shift]

    def several(self, nodes: Iterable[Any]) -> tuple[Part, ...]:
        """Expressions one by one."""
        return tuple(map(self.expression, nodes))

    def fields(self, node: Any, *names: str) -> tuple[Part, ...]:
        """The expressions in fields of a node."""
        return self.several(field_of(node, name) for name in names)

    def whole(self, node: Any, number: int) -> Part:
        """A whole number that the source implies."""
        return self.part("number", node, number, "int")

    def operate(self, node: Any, sign: str, *operands: Any) -> Part:
        """Two operands with an operator between them."""
        if sign not in self.OPERATORS:
            return self.refuse(node, f"the operator {sign}")
        kind, *more = self.OPERATORS[sign]
        return self.part(kind, node, *more, *map(self.expression, operands))

    def operate_alone(self, node: Any, sign: str, operand: Any) -> Part:
        """One operand with an operator before it."""
        if sign == "+":
            return self.expression(operand)
        if sign not in self.UNARY:
            return self.refuse(node, f"the operator {sign}")
        return self.part(self.UNARY[sign], node, self.expression(operand))

    def set_again(self, node: Any) -> Part | None:
        """A pointer or reference that leads elsewhere from here on; None for other statements."""
        name, given = text_of(field_of(node, "left") or field_of(node, "argument")), text_of(field_of(node, "right"))
        if name not in self.pointers or node.type not in ("assignment_expression", "update_expression"):
            return None
        is_exact = ADDRESS.fullmatch(given) is not None and given[1:].strip() not in self.pointers
        return self.part("moved", node, name, "a pointer that is set again", identifiers_in(node), is_exact)

    def assign(self, node: Any, left: Any, right: Any) -> Part:
        """An assignment, also with an operator for arithmetic."""
        sign = text_of(field_of(node, "operator")).removesuffix("=")
        if sign and self.OPERATORS.get(sign, ("",))[0] != "op":
            return self.unread(node, f"the assignment {sign}=")
        return self.part("assign", node, self.expression(left), sign, self.expression(right))

    def count(self, node: Any, name: Any, source: Any, ends: Sequence[Part], is_closed: bool) -> Part:
        """A loop from a start to a stop, which belongs to it where it is closed, perhaps with a step."""
        if name.type != "identifier" or not 2 <= len(ends) <= 3:
            return self.unread(node, "a loop over something else than a range")
        start, stop, step = (*ends, one := self.whole(source, 1))[:3]
        if is_closed and step.kind not in ("number", "minus"):
            return self.unread(node, "a loop with a step that is no number")
        stop = self.part("op", source, "-" if step.kind == "minus" else "+", stop, one) if is_closed else stop
        return self.part("for", node, text_of(name), start, stop, step, self.block(find_body(node)))

    def literal(self, node: Any, text: str, is_real: bool) -> Part:
        """A number in decimal digits."""
        if (value := read_decimal(text)) is None:
            return self.refuse(node, f"the number {text_of(node)[:20]}")
        return self.part("number", node, value, "real" if is_real else "int")

    def chain(self, node: Any, clauses: list[Any]) -> Part:
        """``if`` with the clauses behind it, the first as its other way."""
        test, then = self.expression(field_of(node, "condition")), self.block(find_body(node))
        is_if = bool(clauses) and field_of(clauses[0], "condition") is not None
        last = self.block(find_body(clauses[0])) if clauses and not is_if else ()
        return self.part("if", node, test, then, (self.chain(clauses[0], clauses[1:]),) if is_if else last)

    def sizes(self, node: Any, shape: tuple[int, ...] | None) -> tuple[Part, ...] | None:
        """A shape as parts."""
        return None if shape is None else tuple(self.whole(node, n) for n in shape)

    def part(self, kind: str, node: Any, *parts: Any) -> Part:
        """A part with its line and span."""
        return Part(kind, line_of(node), parts, (node.start_byte + self.shift, node.end_byte + self.shift))

    def refuse(self, node: Any, why: str) -> Part:
        """An expression that is not read: its names, whether it may write them, and whether it may leave the way."""
        inside, names = {inner.type for inner in descend(node)}, identifiers_in(node)
        is_shouting = "call_expression" in inside and any(name.isupper() for name in names)
        return self.part("refused", node, why, names, bool(inside & WRITES), bool(inside & JUMPS) or is_shouting)

    def unread(self, node: Any, why: str) -> Part:
        """A statement that is not read: all names in it may have been written, or the way may be left there."""
        kind = "jump" if any(inner.type in JUMPS for inner in descend(node)) else "unread"
        return self.part(kind, node, why, identifiers_in(node))
