"""C and C++: functions, scalars, arrays, fixed-size matrices ``M(i, j)``; all else is refused with its line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from navsym.audit.form import (
    NO_EXPRESSION,
    OTHER_NAME,
    SECOND,
    TWO_DEFINITIONS,
    UNDEFINED,
    Argument,
    Part,
    names_in,
    walk,
)
from navsym.audit.functions import METHODS
from navsym.audit.preprocessor import (
    DECLARING,
    MADE,
    drop_ways,
    head_of_function,
    list_types,
    list_variables,
    region_of,
    scope_of,
)
from navsym.audit.syntax import SourceReader, ascend, descend, field_of, identifiers_in, list_above, named, text_of
from navsym.audit.values import LIMITS, whole_kind

#: Types of which the custom says that they are real, and what the language says.
OPEN = frozenset("real_t ftype Scalar scalar_t Real postype_t T".split())
REAL = OPEN | {*"float double float32_t float64_t f32 f64".split()}
VIRTUAL = re.compile(r"\b(virtual|override|_*weak_*)\b", re.IGNORECASE)
WHOLE = re.compile(r"(unsigned |signed )*(u?int\d+(_t)?|int|long|short|char|size_t|bool|unsigned|Eigen::Index)( int)?")
VECTOR = re.compile(r"(?:\w+::)*(?:(?:Sparse)?Vector([2-9]|[1-5]\d)[fd]?(?:<[\w, ]+>)?|Vector<\w+,(\d+)>)")
MATRIX = re.compile(
    r"(?:\w+::)*(?:(?:Square)?Matrix([2-9]|[1-5]\d)[fd]?(?:<\w+>)?|Dcm[fd]?|Dcm<\w+>|SquareMatrix<\w+,(\d+)>|Matrix<\w+,(\d+),(\d+)>)"
)
#: Words that a macro may stand for, and nothing is read that was not there.
IDLE = frozenset("inline const static register restrict volatile".split())
ODD = ("union_specifier", "bitfield_clause")  # whose members share their place, or hold less than their type
ROUNDS = 6  # in which names are told from types; a cast that is left is refused
DYNAMIC = re.compile(r"(?:Eigen::)?(?:Matrix|Vector)X[fd]")  # whose size is that of its value
#: Of Eigen, whose coefficients are x, y, z, w; other libraries have other orders.
QUATERNION = re.compile(r"Quaternion[fd]|(Eigen::)Quaternion([fd]|<\w+>)")
#: What stands between two parts of a name and is no plain number: a call with arguments, or an index.
COMPUTED = re.compile(r"\(\s*[^)\s]|\[(?!(0|[1-9]\d*)\])")
POINTER = ("pointer_declarator", "abstract_pointer_declarator")
SECONDS = ("pointer_declarator", "reference_declarator")


def shape_of_type(text: str) -> tuple[int, ...] | None:
    """The sizes of a vector or matrix type; None for others."""
    text = text.replace(" ", "").replace("const", "")
    if re.search(r"<(u?int|unsigned|signed|long(?!double)|short|char|bool|size_t)", text):
        return None
    if QUATERNION.fullmatch(text):
        return (4,)
    if found := VECTOR.fullmatch(text):
        return (int(found[1] or found[2]),)
    if found := MATRIX.fullmatch(text):
        if found[3]:
            rows, columns = int(found[3]), int(found[4])
            return (rows,) if columns == 1 else (rows, columns)
        side = int(found[1] or found[2] or 3)
        return side, side
    return None


@dataclass(slots=True, eq=False)
class Reader(SourceReader):
    """Walks the syntax tree of C and C++.

    locals : the names that the function being read declares
    arrays : those of them that are arrays
    spaces : the namespaces of the file
    directives : the names of macros
    nodes      : of the tree
    hidden : first byte of a name that stands in the tree as a number, since the grammar would take it for a type
    """

    HEAD, VALUE = "int a_ = ", ("declaration", "declarator", "value")
    REALS = OPEN
    OPEN = (*SourceReader.OPEN, "while_statement", "do_statement", "switch_statement", "compound_statement")

    locals: set[str] = field(default_factory=set)
    arrays: set[str] = field(default_factory=set)
    directives: set[str] = field(default_factory=set)
    nodes: list[Any] = field(default_factory=list)
    hidden: dict[int, str] = field(default_factory=dict)
    spaces: set[str] = field(default_factory=set)

    def parse(self, source: bytes) -> Any:
        """The tree of a source in which no variable is taken for a type, as ``b`` is in ``a*(b) - c``."""
        source, known = source if self.shift else drop_ways(source, self.unit), self.unit.variables
        root, text = SourceReader.parse(self, source), bytearray(source)
        self.nodes = [*descend(root)]
        if not self.shift:  # of a file, not of one expression
            known |= list_variables(self.nodes)
            odd = [n if n.type == "union_specifier" else n.parent for n in self.nodes if n.type in ODD]
            unions = (inner for node in odd for inner in descend(node))
            self.unit.types |= list_types(self.nodes)
            self.unit.overlaid |= {text_of(inner) for inner in unions if inner.type == "field_identifier"}
        for _ in range(ROUNDS):
            casts = [field_of(field_of(n, "type"), "type") for n in self.nodes if n.type == "cast_expression"]
            found = [n for n in casts if n is not None and n.type == "type_identifier" and text_of(n) in known]
            if not found:
                break
            for node in found:
                self.hidden[node.start_byte] = text_of(node)
                text[node.start_byte : node.end_byte] = b"1" * len(node.text)
            root = SourceReader.parse(self, bytes(text))
            self.nodes = [*descend(root)]
        return root

    region_of = staticmethod(region_of)

    def restrict(self, node: Any, *names: str) -> None:
        """Note where names are known that are defined at a node."""
        if (region := self.region_of(node)) is not None:
            for name in names:
                self.unit.regions.setdefault(name, []).append(region)

    def read_file(self, root: Any) -> None:
        """Functions, constants and macros, also inside namespaces and classes."""
        inner = (n for n in self.nodes if n.type == "identifier" and n.parent.type in (*DECLARING, "enumerator"))
        heads = ((n, field_of(n.parent, "declarator") or field_of(n.parent, "name")) for n in inner)
        others = {text_of(n) for n, head in heads if head is None or head.id == n.id}
        macros = (n for n in self.nodes if n.type in ("preproc_def", "preproc_function_def"))
        self.directives = {text_of(field_of(n, "name")) for n in macros}
        for node in self.nodes if self.unit.language == "cpp" else ():
            if node.type == "function_definition" and (head := head_of_function(node)) is not None:
                name = text_of(field_of(head, "declarator")).split("::")[-1]
                self.places.setdefault(name, set()).add(scope_of(node))
            elif is_constant(node):
                for child in node.children_by_field_name("declarator"):
                    name = text_of(field_of(child, "declarator") or child)
                    self.places.setdefault(name, set()).add(scope_of(node))
            elif node.type in ("base_class_clause", "using_declaration"):
                self.opened |= {*re.findall(r"\w+", text_of(node))}
        self.spaces = {text_of(field_of(n, "name")) for n in self.nodes if n.type == "namespace_definition"}
        for node in (node for node in self.nodes if node.type == "function_declarator"):
            self.read_head(node)
        for node in self.nodes:
            if node.type == "function_definition":
                self.read_function(node)
            elif node.type == "preproc_def":
                self.read_macro(node)
            elif node.type == "preproc_function_def":
                self.unit.macros[text_of(field_of(node, "name"))] = "a macro with arguments"
                self.restrict(node, text_of(field_of(node, "name")))
            elif node.type == "preproc_call" and text_of(node).startswith("#undef"):
                self.unit.macros[text_of(named(node)[-1]).strip()] = UNDEFINED
            elif node.type == "enumerator_list":
                self.read_enumerators(node)
            elif node.type in ("field_declaration", "declaration"):
                if is_constant(node):
                    done = [s for s in self.declaration(node) if s.kind == "declare" and s.parts[3]]
                    self.unit.constants += done
                    self.restrict(node, *(s.parts[0] for s in done))
                else:
                    self.read_field(node)
        self.unit.constants.sort(key=lambda statement: statement.span)
        self.unit.macros |= dict.fromkeys(others & self.directives, "a macro, and a name of something else as well")

    def read_head(self, node: Any) -> None:
        """Note a function in whose place another one may stand when the program runs."""
        outer = next((n for n in ascend(node) if n.type.endswith(("declaration", "function_definition"))), node)
        *around, name = re.findall(r"\w+", re.sub(r"<[^>]*>", "", text_of(field_of(node, "declarator")))) or [""]
        body = field_of(outer, "body")
        head = outer.text[: None if body is None else body.start_byte - outer.start_byte].decode("utf-8", "replace")
        if (word := VIRTUAL.search(head)) and "final" not in head:
            self.unit.virtual[name] = word[0].strip("_").lower()
        elif around and body is not None and around[-1] not in {*self.unit.types, *self.spaces}:
            self.unit.virtual.setdefault(name, "")

    def read_field(self, node: Any) -> None:
        """A member of a structure, or a variable of the file; one name with two types is left open."""
        kind = number_of(text := self.type_of(node))
        kind = kind if kind in LIMITS else "other" if text == "volatile" else "real"
        is_inside = "function_definition" in list_above(node) and "field" not in node.type
        for child in node.children_by_field_name("declarator") if not is_inside else ():
            name, members = self.declared(field_of(child, "declarator") or child)[0], self.unit.members
            if child.type == "init_declarator" and field_of(child, "declarator").type in SECONDS:
                self.unit.macros[name] = OTHER_NAME
            members[name] = (kind if members.get(name, (kind,))[0] == kind else "other", None)

    def read_enumerators(self, node: Any) -> None:
        """The names of an enumeration, each one more than the one before."""
        previous, one = self.whole(node, -1), self.whole(node, 1)
        for child in named(node):
            if child.type != "enumerator":
                return
            given = field_of(child, "value")
            previous = self.expression(given) if given is not None else self.part("op", child, "+", previous, one)
            name = text_of(field_of(child, "name"))
            self.unit.constants.append(self.part("declare", child, name, "int", (), previous, False))
            self.restrict(child, name)

    def read_macro(self, node: Any) -> None:
        """An object-like macro; a second definition refuses the name."""
        name, value = text_of(field_of(node, "name")), field_of(node, "value")
        body = "" if value is None else re.sub(r"//.*|/\*.*?\*/", "", text_of(value)).strip()
        meaning: Part | str = "a macro without a value" if not body else Reader.read_text(body, self.unit)
        if isinstance(meaning, Part) and any(part.kind == "refused" for part in walk(meaning)):
            meaning = NO_EXPRESSION
        twice = Reader.read_text(f"2*{body}", self.unit) if isinstance(meaning, Part) else None  # (a)+(b) falls apart
        if twice is not None and (twice.parts[0] != "*" or twice.parts[1].span != (0, 1)):
            meaning = "a macro whose operators have no parentheses around them"
        self.unit.macros[name] = TWO_DEFINITIONS if name in self.unit.macros else meaning
        self.restrict(node, name)

    def read_function(self, node: Any) -> None:
        declarator, body = head_of_function(node), field_of(node, "body")
        if declarator is None or body is None:
            return
        name = re.sub(r"<.*?>", "", text_of(field_of(declarator, "declarator"))).split("::")[-1]
        parameters = named(field_of(declarator, "parameters"))
        declared = (n for n in descend(node) if n.type in ("declaration", "parameter_declaration"))
        inner = [field_of(c, "declarator") or c for n in declared for c in n.children_by_field_name("declarator")]
        pairs = [(c, text_of(n)) for c in inner for n in descend(c) if n.type == "identifier"]
        kinds = (*POINTER, "array_declarator")
        self.locals = {name for _, name in pairs}
        self.pointers = {name for c, name in pairs if c.type in kinds or c.parent.type in kinds}
        self.arrays = {name for c, name in pairs if "array_declarator" in (c.type, c.parent.type)}
        is_template = node.parent is not None and node.parent.type == "template_declaration"
        head = field_of(node.parent, "parameters") if is_template else None
        types = {text_of(n) for n in descend(head) if n.type == "type_identifier"} if head is not None else set()
        arguments = tuple(self.argument(p, types) for p in parameters if text_of(p) != "void")
        before = [c for c in named(node) if c.type == "field_initializer_list"]  # what is in no statement
        start = tuple(self.part("unread", c, "the list of members before a constructor", ()) for c in before)
        is_plain = field_of(node, "declarator").type == "function_declarator" and field_of(node, "type") is not None
        is_second = field_of(node, "declarator").type in SECONDS
        is_second &= all(text_of(child) != "const" for child in named(node))
        number = number_of(self.type_of(node)) if is_plain else SECOND if is_second else ""
        whole = start + self.block(body)
        if self.directives & {n.type for n in descend(node) if not n.is_named} - IDLE:
            whole = (self.part("jump", node, "a macro in the place of a word of the language", ()),)
        if not all(p.type.endswith("parameter_declaration") and "volatile" not in text_of(p) for p in parameters):
            whole = (self.part("jump", node, "parameters outside the language of audit", ()),)
        self.define(node, name, arguments, whole, (), number)

    def argument(self, node: Any, types: set[str]) -> Argument:
        """A parameter with its sizes; pointers, references and arrays are shared with the caller.

        types : those of a template, which are those of what is given
        """
        kind, inner = self.type_of(node), field_of(node, "declarator")
        name, sizes, shared = self.declared(inner)
        if inner is not None and any(n.type == "function_declarator" for n in descend(inner)):  # it is only called
            return Argument(next((text_of(n) for n in descend(inner) if n.type == "identifier"), ""), "other", ())
        is_spare = node.type.startswith("optional")
        shape = sizes or self.sizes(node, shape_of_type(kind))
        return Argument(name, "auto" if kind in types else number_of(kind), shape, shared, is_spare)

    def type_of(self, node: Any) -> str:
        """The type of a declaration, with names of types that the file defines replaced."""
        text, types = text_of(field_of(node, "type")), self.unit.types
        if any(text_of(child) == "volatile" for child in named(node)):
            return "volatile"
        for _ in range(ROUNDS):
            text = re.sub(r"(?<![\w:])\w+", lambda found: types.get(found[0], found[0]), text)
        text = "a macro" if self.directives & {*re.findall(r"\w+", text)} else text
        for child in node.children_by_field_name("declarator"):
            if name := re.search(r"[A-Za-z_]\w*", text_of(child)):
                self.unit.kinds.setdefault(name[0], set()).add(text)
                self.take(node, text, name[0])
        return text

    def declared(self, node: Any) -> tuple[str, tuple[Part, ...] | None, bool]:
        """Name, sizes and whether it is shared, of a declarator."""
        sizes: list[Part] = []
        shared = False
        while node is not None and node.type not in ("identifier", "field_identifier"):
            if node.type == "array_declarator":
                size = field_of(node, "size")
                sizes.append(self.expression(size) if size else self.refuse(node, "an array without a size"))
                shared = True
            shared |= node.type in ("reference_declarator", *POINTER)
            if node.type == "function_declarator":
                return text_of(node), None, True
            node = field_of(node, "declarator") or next(iter(named(node)), None)
        return (text_of(node) if node is not None else ""), tuple(reversed(sizes)) or None, shared

    def block(self, node: Any) -> tuple[Part, ...]:
        """The statements of a body, or the one that stands for it."""
        is_body = node is None or node.type in ("compound_statement", "else_clause")
        return tuple(s for child in (named(node) if is_body else [node]) for s in self.statement(child))

    def read_statement(self, node: Any) -> tuple[Part, ...] | None:
        match node.type:
            case "compound_statement":
                return (self.part("block", node, self.block(node)),)
            case "declaration":
                return self.declaration(node)
            case "if_statement":
                then, other = self.block(field_of(node, "consequence")), self.block(field_of(node, "alternative"))
                return (self.part("if", node, *self.fields(node, "condition"), then, other),)
            case "for_statement" | "while_statement" | "do_statement":
                return (self.loop(node),)
            case "switch_statement":
                return (self.switch(node),)
            case "static_assert_declaration" | "using_declaration" | "empty_statement" | "type_definition":
                return ()
        return None

    def loop(self, node: Any) -> Part:
        """``for``, ``while`` and ``do``."""
        start, test, step = (field_of(node, name) for name in ("initializer", "condition", "update"))
        first = () if start is None else self.declaration(start) if start.type == "declaration" else self.effect(start)
        after = () if step is None else self.effect(step)
        body = self.block(field_of(node, "body"))
        return self.part("loop", node, first, self.expression(test), after, body, node.type == "do_statement")

    def switch(self, node: Any) -> Part:
        """``switch`` as ``if``: a case goes on into the next one unless it ends in a jump."""
        cases, test = named(field_of(node, "body")), self.expression(field_of(node, "condition"))
        labels = (n for case in cases for n in descend(case) if n.type in ("case_statement", "..."))
        is_odd = any(n.type == "..." or n.parent.parent.type != "switch_statement" for n in labels)
        is_odd |= any(case.type != "case_statement" for case in cases)
        if is_odd or {part.kind for part in walk(test)} - {"name", "number", "index", "op"}:
            return self.unread(node, "a switch over a call, or with other statements around its cases")
        following, other = tuple[Part, ...](), tuple[Part, ...]()
        ways: list[tuple[Any, tuple[Part, ...]]] = []
        for case in reversed(cases):
            label = field_of(case, "value")
            inner, is_end = self.case([c for c in named(case) if label is None or c.id != label.id])
            following = inner if is_end else (*inner, *following)
            ways.append((case, following)) if label is not None else None
            other = following if label is None else other
        for case, body in ways:
            label = self.expression(field_of(case, "value"))
            other = (self.part("if", case, self.part("compare", case, "==", test, label), body, other),)
        return self.part("block", node, other)

    def case(self, nodes: list[Any]) -> tuple[tuple[Part, ...], bool]:
        """The statements of a case, and whether it ends there."""
        last = nodes[-1] if nodes else None
        if last is not None and last.type == "attributed_statement" and "fallthrough" in text_of(last):
            return self.case(nodes[:-1])
        if last is not None and last.type == "compound_statement":
            inner, is_end = self.case(named(last))
            before = (s for n in nodes[:-1] for s in self.statement(n))
            return (*before, self.part("block", last, inner)), is_end
        is_break = last is not None and last.type == "break_statement"
        done = tuple(s for n in nodes[: len(nodes) - is_break] for s in self.statement(n))
        return done, is_break or (last is not None and last.type in ("return_statement", "throw_statement"))

    def declaration(self, node: Any) -> tuple[Part, ...]:
        """One statement for each declared name."""
        words = {text_of(child) for child in named(node) if child.type in ("storage_class_specifier", "type_qualifier")}
        if words & {"static", "thread_local", "extern"} and not words & {"const", "constexpr"}:
            return (self.unread(node, "a variable that keeps its value between calls, or is changed elsewhere"),)
        kind = self.type_of(node)
        if kind == "volatile" or (MADE in (kind, self.unit.types.get(kind.split("::")[-1])) and not is_second(node)):
            return (self.part("jump", node, "a volatile variable, or an object that may do more when it is made", ()),)
        done = []
        for child in node.children_by_field_name("declarator"):
            value = field_of(child, "value") if child.type == "init_declarator" else None
            inner = field_of(child, "declarator") if child.type == "init_declarator" else child
            name, sizes, shared = self.declared(inner)
            shape = sizes or self.sizes(child, shape_of_type(kind))
            is_call = value is not None and value.type == "argument_list"
            if is_call or (value is not None and value.type == "initializer_list" and sizes is None):
                items = self.several(named(value))  # v(a, b), v{a + b}
                whole = self.part("list", value, items) if items or not is_call else None
                start = items[0] if len(items) == 1 and number_of(kind) != "other" else whole
            else:
                start = None if value is None else self.expression(value)
            if "static" in words and start is not None and names_in(start) & self.locals:
                done.append(self.unread(child, "a variable that keeps the value of the first call"))
                continue
            if inner.type == "structured_binding_declarator":
                done.append(self.unread(child, "several names declared at once"))
                continue
            if inner.type == "function_declarator":  # Vector3f v(a, b, c), which the grammar takes for a function
                items = tuple(map(self.taken_for_parameter, named(field_of(inner, "parameters"))))
                name, start = text_of(field_of(inner, "declarator")), self.part("list", inner, items)
                if shape is None:  # MatrixXd K(n, m), or the declaration of a function
                    why = "a declaration with parentheses of a type without known sizes"
                    done.append(self.part("unread", child, why, (*identifiers_in(child), *names_in(*items))))
                    continue
            start = None if start is None else self.quaternion(child, kind, start)
            is_pointer = any(n.type in (*POINTER, "reference_declarator") for n in descend(inner))
            if is_pointer and sizes is not None:  # an array of pointers, or a pointer to an array
                done.append(self.unread(child, "pointers or references and sizes in one declaration"))
                continue
            is_link: bool | str = shared and sizes is None and inner.type != "function_declarator"
            is_link = (is_link and ("const" in words and "const")) or is_link
            is_dynamic = DYNAMIC.fullmatch(kind) is not None and start is not None and not is_link
            number = "matrix" if is_dynamic else number_of(kind)
            done.append(self.part("declare", child, name, number, shape, start, is_link))
        return tuple(done)

    def quaternion(self, node: Any, kind: str, start: Part) -> Part:
        """What a quaternion is made of: w, x, y and z, or another one."""
        if not QUATERNION.fullmatch(kind) or start.kind == "call":
            return start
        items = start.parts[0] if start.kind == "list" else (start,)
        return self.part("call", node, "Quaternion::new" if len(items) > 1 else "Quaternion::new_unchecked", items)

    def taken_for_parameter(self, node: Any) -> Part:
        """An expression in parentheses behind a declared name: a name alone looks like the type of a parameter."""
        kind = field_of(node, "type") if node.type == "parameter_declaration" else None
        is_name = kind is not None and kind.type == "type_identifier" and text_of(kind) == text_of(node)
        return self.part("name", node, text_of(node)) if is_name else self.expression(node)

    def effect(self, node: Any) -> tuple[Part, ...]:
        """What an expression that stands alone writes."""
        if (moved := self.set_again(node)) is not None:
            return (moved,)
        match node.type:
            case "assignment_expression":
                left, right = field_of(node, "left"), field_of(node, "right")
                if any(inner.type == "primitive_type" for inner in descend(left)):
                    return (self.unread(node, "a type where a name is assigned, as of a reference to an array"),)
                is_chain = right.type == "assignment_expression"  # a = b = c
                first, right = (self.effect(right), field_of(right, "left")) if is_chain else ((), right)
                done = self.assign(node, left, right)
                if "noalias()" in text_of(left) and names_in(*done.parts[:1]) & names_in(*done.parts[2:]):
                    return (self.unread(node, "noalias() of what the target is in"),)
                return (*first, done)
            case "update_expression":
                target, sign = self.expression(field_of(node, "argument")), text_of(field_of(node, "operator"))[0]
                return (self.part("assign", node, target, sign, self.whole(node, 1)),)
            case "comma_expression" | "binary_expression" if (filled := self.comma_list(node)) is not None:
                return (filled,)
            case "comma_expression" | "parenthesized_expression":
                return tuple(s for child in named(node) for s in self.effect(child))
            case "call_expression":
                return (self.part("do", node, self.expression(node)),)
            case "identifier":
                return (self.part("jump", node, "a name alone, as of a macro that holds statements", ()),)
        return (self.unread(node, "an expression without an assignment"),)

    def comma_list(self, node: Any) -> Part | None:
        """``M << a, b, c`` of Eigen as an assignment of all cells; None for others."""
        first, *items = list_commas(node)
        if first.type != "binary_expression" or text_of(field_of(first, "operator")) != "<<":
            return None
        cells = self.several((field_of(first, "right"), *items))
        return self.part("assign", node, self.expression(field_of(first, "left")), "<<", self.part("list", node, cells))

    def read_expression(self, node: Any) -> Part | None:
        match node.type:
            case "identifier" if (name := text_of(node)) not in self.locals and not self.is_seen(node, name):
                return self.elsewhere(node, name)
            case "number_literal" if node.start_byte in self.hidden:
                return self.part("name", node, self.hidden[node.start_byte])
            case "qualified_identifier" if text_of(node).startswith("::"):
                name = text_of(node).removeprefix("::")
                return self.part("name", node, name) if name not in self.locals else self.refuse(node, "a hidden name")
            case "number_literal":
                return self.number(node)
            case "subscript_expression":
                index = field_of(node, "index") or field_of(node, "indices")
                places = named(index) if index.type == "subscript_argument_list" else [index]
                return self.part("index", node, *self.fields(node, "argument"), self.several(places))
            case "call_expression":
                return self.call(node)
            case "field_expression":
                owner = text_of(field_of(node, "argument"))
                if not re.fullmatch(r"[\w.:\[\]()>\- ]*", owner) or COMPUTED.search(owner):
                    return self.refuse(node, "a member of an expression")
                name = re.sub(r"\s", "", text_of(node))
                if self.unit.overlaid & {*(words := re.findall(r"\w+", name))}:
                    return self.refuse(node, "a member of a union, which shares its place with others")
                if self.directives & {*words}:
                    return self.refuse(node, "a member whose name is a macro, too")
                first = re.match(r"(\w+)\[0\]\.", name)
                if first and re.search(rf"\b{first[1]}\s*->".encode(), self.unit.source):
                    return self.refuse(node, f"{name} beside {first[1]}->, which is the same")
                member = name.removeprefix("this->")
                is_alone = self.shift < 0  # of a mend nobody knows what is local
                if member != name and (is_alone or re.match(r"\w+", member)[0] in self.locals):  # type: ignore[index]
                    return self.refuse(node, f"{name} beside a local name that is written alike")
                return self.part("name", node, member)
            case "conditional_expression":
                return self.part("choose", node, *self.fields(node, "condition", "consequence", "alternative"))
            case "cast_expression":
                number = number_of(self.type_of(node))
                if number not in (*LIMITS, "real"):
                    return self.refuse(node, "a cast to a type that is not known, or a name alone in parentheses")
                return self.part("cast", node, number, self.expression(field_of(node, "value")))
            case "pointer_expression":
                sign = text_of(field_of(node, "operator"))
                pointed = self.expression(field_of(node, "argument"))
                if sign == "&" and pointed.kind == "name" and pointed.parts[0] in self.pointers - self.arrays:
                    return self.part("refused", node, "the address of a pointer", identifiers_in(node), True, False)
                if sign == "&":
                    return self.part("address", node, pointed)
                if pointed.kind == "name":
                    return self.part("first", node, pointed)
                if pointed.kind == "op" and pointed.parts[0] == "+" and pointed.parts[1].kind == "name":  # *(p + k)
                    return self.part("index", node, pointed.parts[1], (pointed.parts[2],))
        return None

    def number(self, node: Any) -> Part:
        """A number without its suffix; the grammar takes the sign of some numbers for a part of them."""
        text = text_of(node)
        if text.isdigit() and (text == "0" or text[0] != "0"):
            return self.literal(node, text, False)
        bare = text.removeprefix("-")
        if re.fullmatch(r"0\d+", bare):
            return self.refuse(node, "an octal number")
        suffix = "" if bare.lower().startswith("0x") else bare.lstrip("0123456789.eE+-")
        digits = bare.removesuffix(suffix) if suffix.lower() in ("", "f", "l", "u", "ul") else ""
        number = self.literal(node, digits, any(c in bare.lower() for c in ".ef"))
        if number.kind != "number":
            return number
        kind = "unsigned" if "u" in suffix.lower() else number.parts[1]
        return self.part("number", node, number.parts[0] * (1 if bare == text else -1), kind)

    def call(self, node: Any) -> Part:
        """A function, a method, an entry ``M(i, j)``, or an accessor without arguments, which is a name."""
        function = field_of(node, "function")
        arguments = self.several(named(field_of(node, "arguments")))
        if function.type == "field_expression":
            base, method = self.expression(field_of(function, "argument")), text_of(field_of(function, "field"))
            if base.kind == "name" and base.parts[0] == "this":
                return self.own_call(node, method, arguments)
            if method == "noalias" and not arguments:  # says how Eigen computes, not what
                return base
            if (found := re.fullmatch(r"(?:template)?at<(\d+)>", re.sub(r"\s", "", method))) and not arguments:
                return self.part("index", node, base, (self.whole(node, int(found[1])),))
            if (block := self.block_of(node, base, method, arguments)) is not None:
                return block
            return self.part("method", node, base, method, arguments)
        name = re.sub(r"\s", "", text_of(function))
        if function.type == "primitive_type" or (name in REAL and len(arguments) == 1):
            self.take(node, name)
            kind = number_of(self.unit.types.get(name, name) if name not in self.directives else "a macro")
            is_known = arguments and kind in (*LIMITS, "real")
            return self.part("cast", node, kind, arguments[0]) if is_known else self.refuse(node, "a cast")
        if name in ("static_cast<float>", "static_cast<double>") and arguments:
            return self.part("cast", node, "real", arguments[0])
        if QUATERNION.fullmatch(name):
            return self.quaternion(node, name, self.part("list", node, arguments))
        if name.endswith("::Identity") and QUATERNION.fullmatch(name.removesuffix("::Identity")):
            return self.part("call", node, "Quaternion::identity", ())
        if shape_of_type(name) is not None:
            self.take(node, name)
            is_copy = len(arguments) == 1  # of a matrix
            return self.part("method", node, *arguments, "eval", ()) if is_copy else self.part("list", node, arguments)
        if found := re.fullmatch(r"\(\*(\w+)\)", name):  # (*M)(i, j)
            name = found[1]
        if function.type == "call_expression":  # s.q()(0) is an entry of an accessor, M.transpose()(0, 1) of a value
            owner = self.expression(function)
            if owner.kind == "name":
                return self.part("call", node, owner.parts[0], arguments)
            if not re.fullmatch(r"[\w.:>-]+\(\)", name) or (name.removesuffix("()").split(".")[-1], 0) in METHODS:
                return self.part("index", node, owner, arguments)
            return self.part("call", node, name, arguments)
        if found or function.type in ("identifier", "qualified_identifier", "template_function"):
            return self.own_call(node, name, arguments)
        return self.refuse(node, "a call of an expression")

    def own_call(self, node: Any, name: str, arguments: tuple[Part, ...]) -> Part:
        """A call; a function that the file defines in a namespace or class is known there only."""
        if self.is_seen(node, name):
            return self.part("call", node, name, arguments)
        return self.elsewhere(node, f"the function {name}")

    @staticmethod
    def places_open_to(node: Any, is_member: bool) -> Iterator[tuple[str, ...]]:
        """A namespace or class sees what is defined around it."""
        around = scope_of(node)
        return (around[:k] for k in range(len(around) + 1))

    def block_of(self, node: Any, base: Part, method: str, arguments: tuple[Part, ...]) -> Part | None:
        """``M.block<p, q>(i, j)``, ``M.block(i, j, p, q)``, ``M.row(i)`` and the like as slices; None for others."""
        bare = re.sub(r"\s|template", "", method)
        if bare in ("row", "col") and len(arguments) == 1:
            row = self.part("slice", node, arguments[0], self.part("op", node, "+", arguments[0], self.whole(node, 1)))
            whole = self.part("slice", node, None, None)
            return self.part("index", node, base, (row, whole) if bare == "row" else (whole, arguments[0]))
        found = re.fullmatch(r"(block|segment|head|tail|(top|bottom)(Left|Right)Corner)(?:<([\d,]+)>)?", bare)
        if found is None:
            return None
        sizes = [self.whole(node, int(n)) for n in (found[4] or "").split(",") if n]
        starts = [*arguments]
        if not sizes:
            at = len(starts) // 2 if found[1] in ("block", "segment") else 0
            starts, sizes = starts[:at], starts[at:]
        if found[1] in ("block", "segment"):
            ends = [self.part("op", node, "+", a, n) for a, n in zip(starts, sizes, strict=False)]
            slices = [self.part("slice", node, a, b) for a, b in zip(starts, ends, strict=False)]
        else:
            sides = [found[1] == "tail"] if found[2] is None else [found[2] == "bottom", found[3] == "Right"]
            slices = [self.end_of(node, n, is_last) for n, is_last in zip(sizes, sides, strict=False)]
            starts = sides  # type: ignore[assignment]
        is_known = starts and len(starts) == len(sizes) and all(part.kind == "slice" for part in slices)
        return self.part("index", node, base, tuple(slices)) if is_known else None

    def end_of(self, node: Any, size: Part, is_last: bool) -> Part:
        """The first or the last cells of a side; how many must be a number."""
        if size.kind != "number" or size.parts[0] < 1:
            return self.refuse(node, "a number of cells that is no number")
        return self.part("slice", node, *((self.part("minus", node, size), None) if is_last else (None, size)))


def is_second(node: Any) -> bool:
    """True for a declaration of pointers and references only."""
    inner = (field_of(child, "declarator") or child for child in node.children_by_field_name("declarator"))
    return all(child.type in SECONDS for child in inner)


def is_constant(node: Any) -> bool:
    """True for the declaration of a constant outside of functions."""
    is_const = any(text_of(child) in ("const", "constexpr") for child in node.children)
    return node.type == "declaration" and is_const and "function_definition" not in list_above(node)


def list_commas(node: Any) -> list[Any]:
    """The expressions between commas."""
    if node.type != "comma_expression":
        return [node]
    return [*list_commas(field_of(node, "left")), *list_commas(field_of(node, "right"))]


def number_of(kind: str) -> str:
    """Whether a type holds integers (a name in LIMITS), real numbers ("real") or something else ("other")."""
    kind = re.sub(r"\b(const|static|constexpr|struct)\b", "", kind).strip()
    if WHOLE.fullmatch(kind):
        return whole_kind(kind)
    if QUATERNION.fullmatch(kind):
        return "quaternion"
    if kind.rstrip("&* ") == "auto":
        return "auto"
    is_real = kind in REAL or kind in ("long double", "") or shape_of_type(kind) is not None
    return "real" if is_real else "other"
