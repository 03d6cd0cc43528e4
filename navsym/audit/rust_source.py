"""Rust: functions of numbers, arrays, and what nalgebra has of matrices and quaternions; all else is refused."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from navsym.audit.form import Argument, Part, names_in
from navsym.audit.syntax import SourceReader, ascend, descend, field_of, identifiers_in, list_above, named, text_of
from navsym.audit.values import whole_kind

OPEN_TYPES = frozenset(("N", "T", "R", "Real"))
REAL = ("f32", "f64", "Self", *OPEN_TYPES)
WHOLE = re.compile(r"[iu](8|16|32|64|128|size)|bool")
VECTOR = re.compile(r"(?:\w+::)*(?:S?Vector(\d)(?:<\w+>)?|SVector<\w+,(\d+)>|Point([23])<\w+>)")
MATRIX = re.compile(r"(?:\w+::)*(?:Matrix(\d)(?:x(\d))?(?:<\w+>)?|SMatrix<\w+,(\d+),(\d+)>)")
ARRAY = re.compile(r"\[(.+);(\d+)\]")
QUATERNION = re.compile(r"(?:\w+::)*(Unit)?Quaternion(?:<\w+>)?")
#: Methods of numbers that are functions in the other languages.
NUMBERS = dict.fromkeys("sin cos tan asin acos atan sinh cosh tanh exp sqrt atan2 hypot".split(), "") | {
    "ln": "log", "exp_m1": "expm1", "ln_1p": "log1p",
    "abs": "fabs", "powf": "pow", "powi": "pow", "max": "fmax", "min": "fmin"
}  # fmt: skip
#: Methods that give what they are called on.
SAME = ("clone", "as_ref", "to_owned", "into_inner", "quaternion", "as_vector", "copied", "eval", "coords")
QUIET = frozenset("println eprintln debug_assert debug_assert_eq assert assert_eq trace debug info warn".split())


#: A text, and what may write in the arguments of a macro.
STRING, WRITING = re.compile(r'"(\\.|[^"\\])*"'), re.compile(r"(?<![=!<>])=(?!=)|mut\b")
INSIDE, OWNER = ("self", "Self", "crate", "super"), "type "
OPEN = "which each type of a trait may define otherwise"
DEFINING = ("struct_item", "enum_item", "union_item", "type_item", "macro_definition")


def type_of(text: str) -> tuple[str, tuple[int, ...] | None]:
    """What a type holds (a name in LIMITS, "real", "quaternion", "other"), and its sizes."""
    bare = re.sub(r"\s|&|'\w+\b|\bmut\b", "", text)
    if QUATERNION.fullmatch(bare):
        return "quaternion", (4,)
    if found := VECTOR.fullmatch(bare):
        return "real", (int(found[1] or found[2] or found[3]),)
    if found := MATRIX.fullmatch(bare):
        rows = int(found[1] or found[3])
        return "real", (rows, int(found[2] or found[4] or rows))
    if found := ARRAY.fullmatch(bare):
        kind, inner = type_of(found[1])
        return kind, None if inner is None or kind == "quaternion" else (int(found[2]), *inner)
    if WHOLE.fullmatch(bare):
        return whole_kind(bare), ()
    return ("real", ()) if bare in REAL and bare != "Self" else ("other", None)


@dataclass(slots=True, eq=False)
class Reader(SourceReader):
    """Walks the syntax tree of Rust.

    foreign      : names that ``use`` brings from elsewhere, or under another name, and numbers of templates
    defined      : the types and macros of the file
    """

    HEAD, VALUE = "const A: f64 = ", ("const_item", "value")
    REALS = OPEN_TYPES
    OPEN = ("if_expression", "for_expression", "block", "expression_statement")

    foreign: set[str] = field(default_factory=set)
    defined: set[str] = field(default_factory=set)

    def read_file(self, root: Any) -> None:
        """Functions, constants and fields, also inside modules and implementations."""
        nodes = [*descend(root)]
        constants = [node for node in nodes if node.type == "const_item" and not is_open(node)]
        for node in constants:
            self.unit.variables.add(name := text_of(field_of(node, "name")))
            if (region := self.region_of(node)) is not None:
                self.unit.regions.setdefault(name, []).append(region)
        for node in (*constants, *(node for node in nodes if node.type == "function_item")):
            modules, owners = place_of(node)
            self.places.setdefault(text_of(field_of(node, "name")), set()).add((*modules, *owners[:1]))
        for node in nodes:
            if node.type in DEFINING and text_of(field_of(node, "type")) not in ("f32", "f64"):
                self.defined.add(text_of(field_of(node, "name")))
            elif node.type == "const_parameter":
                self.foreign.add(text_of(field_of(node, "name")))
        for node in (node for node in nodes if node.type == "use_declaration"):
            is_known = re.match(r"use\s+(std|core)::f(32|64)::consts\b", text_of(node)) is not None
            renamed = {text_of(field_of(n, "alias")) for n in descend(node) if n.type == "use_as_clause"}
            self.foreign |= renamed | {*(identifiers_in(node) if not is_known else ())}
        methods = {n for n, places in self.places.items() if any(p and p[-1].startswith(OWNER) for p in places)}
        self.foreign -= methods
        for node in nodes:
            if node.type == "function_item":
                self.read_function(node)
            elif node in constants and field_of(node, "value") is not None:
                number, shape = self.type_of(text_of(field_of(node, "type")))
                what = text_of(field_of(node, "name")), number, self.sizes(node, shape)
                value = self.expression(field_of(node, "value"))
                self.unit.constants.append(self.part("declare", node, *what, value, False))
            elif node.type == "field_declaration":  # of two structures that have it differently it stays unknown
                name, known = f"self.{text_of(field_of(node, 'name'))}", self.type_of(text_of(field_of(node, "type")))
                self.take(node, text_of(field_of(node, "type")), name)
                self.unit.members[name] = known if self.unit.members.get(name, known) == known else ("other", None)
        self.unit.constants.sort(key=lambda statement: statement.span)

    def type_of(self, text: str) -> tuple[str, tuple[int, ...] | None]:
        """What a type holds; of one that the file defines nothing is known."""
        return ("other", None) if {*re.findall(r"\w+", text)} & self.defined else type_of(text)

    def region_of(self, node: Any) -> tuple[int, int] | None:
        """The item itself where it is compiled under a condition, or the function around an inner one."""
        if is_conditional(node):
            return node.start_byte, node.end_byte
        outer = next((above for above in ascend(node) if above.type == "function_item"), None)
        return None if outer is None else (outer.start_byte, outer.end_byte)

    def read_function(self, node: Any) -> None:
        name, arguments = text_of(field_of(node, "name")), []
        head = field_of(node, "type_parameters")
        types = {text_of(n) for n in descend(head) if n.type == "type_identifier"} if head is not None else set()
        given = (n for n in descend(node) if n.type in ("parameter", "let_declaration"))
        links = (n for n in given if "reference" in getattr(field_of(n, "type") or field_of(n, "value"), "type", ""))
        self.pointers = {text_of(field_of(n, "pattern")).removeprefix("mut ") for n in links}
        for child in [child for child in named(field_of(node, "parameters")) if child.type == "parameter"]:
            kind = text_of(field_of(child, "type"))
            number, shape = self.type_of(kind)
            label = text_of(field_of(child, "pattern")).removeprefix("mut ")
            self.take(child, kind)
            number = "auto" if {*re.findall(r"\w+", kind)} & types and number == "real" else number
            arguments.append(Argument(label, number, self.sizes(child, shape), "&mut" in kind.replace(" ", "")))
        self.take(node, text_of(field_of(node, "return_type")))
        self.define(node, name, arguments, tuple(self.body(field_of(node, "body"))))

    def body(self, node: Any) -> list[Part]:
        """The statements of a function; an expression at its end is its value."""
        nodes = [child for child in named(node) if child.type != "attribute_item"]
        if nodes and is_conditional(nodes[-1]):
            return [*(s for child in nodes for s in self.statement(child))]
        done = [s for child in nodes[:-1] for s in self.statement(child)]
        if not nodes:
            return done
        last = nodes[-1]
        inner = named(last)[0] if last.type == "expression_statement" and not text_of(last).endswith(";") else last
        if inner.type == "if_expression":
            return [*done, self.branch(inner, self.body)]
        is_value = not inner.type.endswith(("statement", "declaration", "_item")) and inner.type not in LOOPS
        return done + ([self.ending(inner)] if is_value else [*self.statement(last)])

    def ending(self, node: Any) -> Part:
        """A returned value; ``Err`` is an end without one, ``Ok`` a value."""
        if node.type == "call_expression" and text_of(field_of(node, "function")) == "Err":
            return self.part("fail", node, "an error is returned")
        if node.type in ("return_expression", "assignment_expression", "compound_assignment_expr", "macro_invocation"):
            return next(iter(self.effect(node)), self.part("return", node, None))
        return self.part("return", node, None if node.type == "unit_expression" else self.expression(node))

    def read_statement(self, node: Any) -> tuple[Part, ...] | None:
        if is_conditional(node) and not node.type.endswith("_item"):
            return (self.unread(node, "a statement that is compiled under a condition"),)
        if node.type == "let_declaration":
            return self.declaration(node)
        if node.type in ("attribute_item", "empty_statement", "use_declaration"):
            return ()
        return None if node.type == "expression_statement" else self.effect(node)

    def effect(self, node: Any) -> tuple[Part, ...]:
        """What an expression that stands alone does."""
        if (moved := self.set_again(node)) is not None:
            return (moved,)
        match node.type:
            case "assignment_expression" | "compound_assignment_expr":
                return (self.assign(node, field_of(node, "left"), field_of(node, "right")),)
            case "if_expression":
                return (self.branch(node, self.block),)
            case "for_expression":
                return (self.loop(node),)
            case "while_expression" if field_of(node, "condition").type not in ("let_condition", "let_chain"):
                return self.read_common(node)
            case "block":
                return (self.part("block", node, self.block(node)),)
            case "return_expression":
                return (self.ending(named(node)[0]) if named(node) else self.part("return", node, None),)
            case "call_expression":
                return (self.part("do", node, self.expression(node)),)
            case "unsafe_block":
                return (self.part("jump", node, "an unsafe block", ()),)
            case "macro_invocation" if text_of(field_of(node, "macro")) in QUIET - self.defined and not WRITING.search(
                STRING.sub("", text_of(node))
            ):
                return ()
            case "macro_invocation" if text_of(field_of(node, "macro")) in ("panic", "unreachable", "todo"):
                return (self.part("fail", node, "a panic"),)
        return (self.outside(node),)

    def declaration(self, node: Any) -> tuple[Part, ...]:
        """``let``; with ``else`` only for a vector that is normalized where it has a length."""
        pattern, given, value = (field_of(node, key) for key in ("pattern", "type", "value"))
        if (other := field_of(node, "alternative")) is not None:
            return self.normalized_or_left(node, text_of(pattern), value, other)
        self.take(node, text_of(given))
        number, shape = self.type_of(text_of(given)) if given is not None else ("auto", None)
        if pattern.type == "tuple_pattern" and value is not None and value.type == "tuple_expression":
            names = [text_of(child).removeprefix("mut ") for child in named(pattern)]
            pairs = [*zip(names, map(self.expression, named(value)), strict=False)]
            is_apart = len({n for n, _ in pairs} & names_in(*(v for _, v in pairs))) == 0
            if len(pairs) == len(named(pattern)) == len(named(value)) and is_apart:
                return tuple(self.part("declare", node, n, "auto", None, v, False) for n, v in pairs)
        if pattern.type != "identifier":
            return (self.unread(node, "a pattern"),)
        is_link = value is not None and any(child.type == "mutable_specifier" for child in value.children)  # &mut x
        start = None if value is None else self.expression(value)
        sizes = self.sizes(node, shape) if shape is not None or number == "auto" else None
        if start is None and shape is None:
            return (self.unread(node, "a name without a type that is known"),)
        number = "auto" if shape is None else number
        return (self.part("declare", node, text_of(pattern), number, sizes, start, is_link),)

    def normalized_or_left(self, node: Any, pattern: str, value: Any, other: Any) -> tuple[Part, ...]:
        """``let Some(u) = v.try_normalize(least) else { .. }``."""
        found, function = re.fullmatch(r"Some\((\w+)\)", pattern), field_of(value, "function")
        is_vector = function is not None and function.type == "field_expression"
        if not found or not is_vector or text_of(field_of(function, "field")) != "try_normalize":
            return (self.unread(node, "a let that may fail"),)
        vector = self.expression(field_of(function, "value"))
        least = self.expression(named(field_of(value, "arguments"))[0])
        length, start = (self.part("method", value, vector, name, ()) for name in ("norm", "normalize"))
        test = self.part("compare", value, ">", length, least)
        return (self.part("if", value, test, (), self.block(other)),
                self.part("declare", node, found[1], "auto", None, start, False))  # fmt: skip

    def branch(self, node: Any, reading: Any) -> Part:
        """``if``; ``reading`` says whether an expression at the end of a block is a value."""
        test = field_of(node, "condition")
        if test.type in ("let_condition", "let_chain"):
            return self.unread(node, "a condition with a pattern")
        then, other = field_of(node, "consequence"), field_of(node, "alternative")
        inner = named(other)[0] if other is not None else None
        is_chain = inner is not None and inner.type == "if_expression"
        rest: tuple[Part, ...] = (self.branch(inner, reading),) if is_chain else tuple(reading(inner))
        return self.part("if", node, self.expression(test), tuple(reading(then)), rest)

    def loop(self, node: Any) -> Part:
        """``for i in 0..n``."""
        source = field_of(node, "value")
        ends = self.several(named(source)) if source.type == "range_expression" else ()
        is_closed = any(text_of(child) == "..=" for child in source.children)
        return self.count(node, field_of(node, "pattern"), source, ends, is_closed)

    def read_expression(self, node: Any) -> Part | None:
        match node.type:
            case "integer_literal" | "float_literal":
                text = text_of(node).replace("_f", "f").replace("_", "")
                bare = re.sub(r"(f32|f64|[iu](8|16|32|64|128|size))$", "", text)
                is_real = node.type == "float_literal" or text.endswith(("f32", "f64"))
                return self.literal(node, bare.removesuffix("."), is_real)
            case "identifier" if (name := text_of(node)) in {*self.unit.variables, "PI"}:
                return self.elsewhere(node, name) if name in self.foreign or not self.is_seen(node, name) else None
            case "scoped_identifier":
                name, last = "".join(text_of(node).split()), text_of(field_of(node, "name"))
                head = name.split("::")[-2]
                words = {word.removeprefix(OWNER) for place in self.places.get(last, ()) for word in place} | {*INSIDE}
                if last in self.unit.variables and head in words:
                    return self.part("name", node, last)
                is_pi = re.fullmatch(r"((std|core)::)?(f32::|f64::)?consts::PI", name)
                return self.part("name", node, "M_PI" if is_pi else name)
            case "reference_expression":
                value = self.expression(field_of(node, "value"))
                is_written = any(child.type == "mutable_specifier" for child in node.children)
                return self.part("address", node, value) if is_written else value
            case "unary_expression":
                return self.operate_alone(node, text_of(node)[0].replace("*", "+"), named(node)[-1])  # *x is x here
            case "index_expression":
                base, place = named(node)
                places = named(place) if place.type == "tuple_expression" else [place]
                return self.part("index", node, self.expression(base), self.several(places))
            case "array_expression":
                size = field_of(node, "length")
                times = 1 if size is None else int(text_of(size)) if text_of(size).isdigit() else 0
                items = self.several(child for child in named(node) if size is None or child.id != size.id)
                return self.part("list", node, items * times) if 0 < times <= 64 else None
            case "type_cast_expression":
                number, _ = self.type_of(text_of(field_of(node, "type")))
                return self.part("cast", node, number, self.expression(field_of(node, "value")))
            case "if_expression":
                return self.choice(node)
            case "call_expression":
                return self.call(node)
        return None

    def choice(self, node: Any) -> Part:
        """``if a { x } else { y }`` as a value."""
        test, then, other = (field_of(node, key) for key in ("condition", "consequence", "alternative"))
        blocks = [named(then), named(named(other)[0]) if other is not None else []]
        is_chain = other is not None and named(other)[0].type == "if_expression"
        if is_chain or any(len(b) != 1 or b[0].type.endswith(("statement", "declaration")) for b in blocks):
            return self.refuse(node, "a choice between more than two expressions")
        if test.type in ("let_condition", "let_chain"):
            return self.refuse(node, "a condition with a pattern")
        return self.part("choose", node, *self.several((test, blocks[0][0], blocks[1][0])))

    def call(self, node: Any) -> Part:
        """A function, a method of a number as a function, a constructor as a list."""
        function = field_of(node, "function")
        arguments = self.several(named(field_of(node, "arguments")))
        if function.type == "generic_function":
            function = field_of(function, "function")
        if function.type == "field_expression":
            return self.method(node, function, arguments)
        name = re.sub(r"::<[^:]*>(?=::|$)|<[^:]*>(?=::|$)|\s", "", text_of(function))
        head, _, last = name.rpartition("::")
        if head in ("", "Self") and (last in self.foreign or not self.is_seen(node, last, bool(head))):
            return self.elsewhere(node, f"the function {last}")
        if head == "Self" and is_open(node):
            return self.refuse(node, f"{name}, {OPEN}")
        if not head or head == "Self":
            return arguments[0] if name in ("Ok", "Some") and arguments else self.part("call", node, last, arguments)
        if {*head.split("::")} & self.defined:
            return self.refuse(node, f"{name}, of a type of the file")
        if QUATERNION.fullmatch(head):
            return self.part("call", node, f"Quaternion::{last}", arguments)
        if last in ("convert", "from", "from_f64", "new_unchecked") and len(arguments) == 1:
            return self.part("call", node, "Convert::into", arguments)
        if last in ("zero", "one") and not arguments:
            return self.part("number", node, int(last == "one"), "auto")
        if (shape := self.type_of(head)[1]) and last == "from_row_slice" and arguments and arguments[0].kind == "list":
            last, arguments = "new", arguments[0].parts[0]
        if shape and last == "new" and arguments:
            sides = (self.whole(node, n) for n in shape)
            return self.part("call", node, "Matrix::new", (*sides, self.part("list", node, arguments)))
        if shape and last in ("zeros", "identity", "zero") and not arguments:
            return self.part("call", node, "eye" if last == "identity" else "zeros", self.sizes(node, shape))
        if head in ("f64", "f32") and last in NUMBERS:
            return self.part("call", node, NUMBERS[last] or last, arguments)
        return self.part("call", node, name, arguments)

    @staticmethod
    def places_open_to(node: Any, is_member: bool) -> list[tuple[str, ...]]:
        """The module around it, or the type and the trait around it."""
        modules, owners = place_of(node)
        return [(*modules, owner) for owner in owners] if is_member else [modules]

    def method(self, node: Any, function: Any, arguments: tuple[Part, ...]) -> Part:
        base, name = self.expression(field_of(function, "value")), text_of(field_of(function, "field"))
        is_own = base.kind == "name" and base.parts[0] == "self"
        if is_own and not self.is_seen(node, name, True):
            return self.elsewhere(node, f"the method {name}")
        if is_own:
            return self.refuse(node, f"{name}, {OPEN}") if is_open(node) else self.part("call", node, name, arguments)
        if name in self.places or name in self.unit.functions:
            return self.refuse(node, f"the method {name} of this file on another value")
        if name in SAME and not arguments:
            return base
        if name == "into" and not arguments:
            return self.part("call", node, "Convert::into", (base,))
        if name in NUMBERS and len(arguments) < 2:
            return self.part("call", node, NUMBERS[name] or name, (base, *arguments))
        return self.part("method", node, base, name, arguments)


def is_open(node: Any) -> bool:
    """True inside a trait, where each type may have another method or constant of a name."""
    return "trait_item" in list_above(node)


def is_conditional(node: Any) -> bool:
    """True behind an attribute that lets a compiler leave it out."""
    while (node := node.prev_named_sibling) is not None and node.type == "attribute_item":
        if re.match(r"#\s*\[\s*cfg\b", text_of(node)):
            return True
    return False


def place_of(node: Any) -> tuple[tuple[str, ...], list[str]]:
    """The modules around a node, and the type and the trait around it."""
    modules = tuple(text_of(field_of(above, "name")) for above in ascend(node) if above.type == "mod_item")
    types = (above for above in ascend(node) if above.type in ("impl_item", "trait_item"))
    nodes = (field_of(above, key) for above in types for key in ("type", "trait", "name"))
    return modules, [OWNER + re.split(r"[<\s]", text_of(n))[0] for n in nodes if n is not None]


LOOPS = ("for_expression", "while_expression", "loop_expression", "match_expression", "block", "unsafe_block")
