"""Python with numpy: functions of numbers, lists and arrays; all else is refused with its line."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from typing import Any
from unicodedata import is_normalized

from navsym.audit.form import Argument, Part, names_in, walk
from navsym.audit.functions import CONSTANTS, HARMLESS, NUMBERS, PURE, bare_name, is_known, is_method, names_view
from navsym.audit.syntax import (
    OPERATORS,
    SourceReader,
    ascend,
    descend,
    field_of,
    identifiers_in,
    list_above,
    named,
    text_of,
)

#: Decorators that leave a function what it is.
PLAIN_DECORATORS = re.compile(
    r"@((abc\.)?(abstractmethod|staticmethod|classmethod|property)|((nb|numba)\.)?(jit|njit)(\(.*\))?"
    r"|override|final)", re.DOTALL
)  # fmt: skip
MODULES = {"numpy": "np.", "math": "math.", "numpy.linalg": "np.linalg."}
NUMERIC = ("numpy", "math", "autograd.numpy", "jax.numpy")
#: Names with a meaning of their own, which a file may use for something else.
NAMES = ("np", "numpy", "math", "abs", "max", "min", "float", "range")
#: What may write any name of the module, or a member of what it is given.
RUNNING, ANY = ("exec", "eval", "globals", "vars", "locals", "setattr", "delattr"), "*"
#: How a function binds names of its own, which are followed where they are read.
FOLLOWED = ("assignment", "augmented_assignment", "parameters", "lambda_parameters")
AGAIN = "a function whose name may stand for something else"


@dataclass(slots=True, eq=False)
class Reader(SourceReader):
    """Walks the syntax tree of Python.

    rebound : names of modules and of their functions that the file uses for something else
    times   : how often the module binds a name, in whatever way
    star    : where the last import of all names of a module is
    made    : names that the file binds, imports aside
    changed : names outside of functions that hold more than their one value
    given   : names whose arrays get another name, or go to what may write to them
    computed : members that a class of the file computes when they are read or set; ANY where it may be every one
    """

    HEAD, TAIL, VALUE = "(", ")", ("expression_statement", "")

    rebound: set[str] = field(default_factory=set)
    changed: set[str] = field(default_factory=set)
    given: set[str] = field(default_factory=set)
    times: Counter[str] = field(default_factory=Counter)
    star: int = -1
    made: set[str] = field(default_factory=set)
    computed: set[str] = field(default_factory=set)
    OPERATORS = OPERATORS | {sign: ("op", sign) for sign in ("//", "@", "**")}

    def read_file(self, root: Any) -> None:
        """The functions and constants of a source in Python."""
        self.read_imports(named(root))
        self.read_changes(root)
        self.read_body(named(root))

    def read_imports(self, nodes: list[Any]) -> None:
        """``from numpy import dot`` and its like; a name that the file defines again is not taken."""
        for node in nodes:
            module = text_of(field_of(node, "module_name")) if node.type == "import_from_statement" else ""
            if module in MODULES:
                for child in node.children_by_field_name("name"):
                    own = field_of(child, "alias") or child
                    self.unit.imported[text_of(own)] = MODULES[module] + text_of(field_of(child, "name") or child)

    def read_changes(self, root: Any) -> None:
        """Note what the names of the module are bound to, and which are written by parts or as ``global``."""
        for node in descend(root):
            names = bound_by(node)
            if node.type == "identifier" and may_be_given(node):
                self.given.add(text_of(node))
            if node.type == "identifier" and text_of(node).strip("_") == "builtins":
                names = [*NAMES, ANY]
            elif node.type == "global_statement":
                self.changed |= {text_of(name) for name in named(node)}
            elif node.type == "wildcard_import":
                self.star = max(self.star, node.start_byte)
                names = ["abs", "max", "min", "float", "range", *(() if is_numeric(node.parent) else NAMES)]
            elif node.type == "call" and text_of(field_of(node, "function")) in RUNNING:
                given = named(field_of(node, "arguments"))[:1]
                names = [*map(text_of, given)] if "attr" in text_of(field_of(node, "function")) else [*NAMES, ANY]
                self.changed |= {*names}
            elif node.type in ("assignment", "augmented_assignment", "for_statement"):
                targets = list_targets(node)  # an entry or a member changes what a name of the module holds
                self.changed |= {n for n, t in zip(names, targets, strict=True) if t.type != "identifier"}
            above = list_above(node) if names else []
            is_local, is_import = "function_definition" in above, node.type.startswith("import")
            scope = next((kind for kind in above if kind in ("function_definition", "class_definition")), "")
            if node.type == "function_definition":
                inner = "class_definition" in above and scope != "class_definition"  # of a method, seen there only
                self.places.setdefault(names[0], set()).update([("",)] if inner else self.places_open_to(node, True))
            elif node.type == "class_definition":
                self.read_members(node)
            if not scope or (scope == "function_definition" and node.type not in FOLLOWED):
                self.times.update(names)  # what a function binds otherwise may stand for anything there
            is_other = not is_numeric(node) or (is_local and node.type == "import_from_statement")
            if not is_import or is_other:
                self.rebound |= {*names} & {*NAMES, *self.unit.imported, *CONSTANTS}
            self.made |= {*(() if is_import else names)}
        self.rebound |= {name for name in self.unit.imported if self.times[name] > 1}

    def read_members(self, node: Any) -> None:
        """Note the members of a class that are no plain values: properties, descriptors, and what no class lists."""
        for child in named(field_of(node, "body")):
            inner = field_of(child, "definition") or child
            name, value = text_of(field_of(inner, "name")), (named(inner) or [None])[0]
            if name in ("__getattr__", "__getattribute__", "__setattr__"):
                self.computed.add(ANY)
            elif inner is not child and not re.search(r"@(staticmethod|classmethod)\b", text_of(child)):
                self.computed.add(name)
            elif value is not None and value.type == "assignment" and field_of(value, "right") is not None:
                made = field_of(field_of(value, "right"), "function")
                is_plain = made is None or bare_name(text_of(made)) == "field" or is_known(text_of(made), "python")
                self.computed |= {*(() if is_plain else bound_by(value))}

    def is_computed(self, node: Any) -> bool:
        """True for a member, or one of a member, that a class of the file computes."""
        head, *members = re.findall(r"\w+", text_of(node))
        is_module = head in NAMES or head in self.unit.imported
        return bool(self.computed & {*members, ANY}) and not is_module

    def is_lasting(self, name: str, node: Any) -> bool:
        """True for a name of the module that stands for one thing from its definition on."""
        is_once = self.times[name] == 1 and not {name, ANY} & self.changed
        return is_once and node.start_byte > self.star

    def read_body(self, nodes: list[Any], is_class: bool = False) -> None:
        """Functions and methods, and names of the module that are assigned once, to numbers."""
        assigned: dict[str, list[tuple[Any, Part]]] = {}
        for node in nodes:
            other = None
            if node.type == "decorated_definition":
                decorators = (c for c in named(node) if c.type == "decorator")
                other = next((c for c in decorators if not self.is_plain(c)), None)
                node = field_of(node, "definition")
            if node.type == "class_definition":
                self.read_body(named(field_of(node, "body")), is_class=True)
            elif node.type == "function_definition":
                self.read_function(node, other)
            elif node.type == "expression_statement":
                for statement in self.statement(node):
                    if statement.kind != "assign" or self.unit.text(statement.parts[2]) == "None":  # set elsewhere
                        continue
                    if statement.parts[0].kind == "name":
                        assigned.setdefault(statement.parts[0].parts[0], []).append((node, statement))
        for name, many in assigned.items():
            is_open = name in self.given and may_be_array(many[0][1].parts[2])
            if not is_class and not many[0][1].parts[1] and not is_open and self.is_lasting(name, many[0][0]):
                self.unit.constants.append(many[0][1])

    def is_plain(self, decorator: Any) -> bool:
        """True for a decorator that leaves a function what it is, and is none of the file."""
        text = text_of(decorator)
        return PLAIN_DECORATORS.fullmatch(text) is not None and not {*re.findall(r"\w+", text)} & self.made

    def read_function(self, node: Any, decorator: Any = None) -> None:
        """A function; one whose decorator may change it is not read."""
        name = text_of(field_of(node, "name"))
        given = named(field_of(node, "parameters"))
        arguments = [Argument(name_parameter(n), shared=True, spare="default" in n.type) for n in given]
        body = self.block(field_of(node, "body"))
        if decorator is not None:
            body = (self.part("jump", decorator, "a decorator that may change the function", ()),)
        if "class_definition" not in list_above(node) and not self.is_lasting(name, node):
            body = (self.part("jump", node, AGAIN, ()),)
        if "class_definition" in list_above(node) and self.has_method(node, "__setattr__"):
            body = (self.part("jump", node, "a class that says itself how its members are set", ()),)
        if any(n.type == "identifier" and not is_normalized("NFKC", text_of(n)) for n in descend(node)):
            body = (self.part("jump", node, "a name that Python takes for another one", ()),)
        arguments = arguments[1:] if arguments and arguments[0].name == "self" else arguments
        self.define(node, name, arguments, body)

    def read_statement(self, node: Any) -> tuple[Part, ...] | None:
        match node.type:
            case "if_statement":
                return (self.chain(node, node.children_by_field_name("alternative")),)
            case "for_statement":
                return (self.loop(node),)
            case "assert_statement" if not any(inner.type == "named_expression" for inner in descend(node)):
                calls = (inner for inner in descend(node) if inner.type == "call")
                return tuple(self.part("do", call, self.expression(call)) for call in calls)
            case "pass_statement" | "import_statement" | "import_from_statement":
                return ()
            case "global_statement":
                return (self.part("jump", node, "a global name", ()),)
        return None

    def loop(self, node: Any) -> Part:
        """``for i in range(...)``."""
        source = self.expression(field_of(node, "right"))
        given = source.parts[1] if source.kind == "call" and source.parts[0] == "range" else ()
        ends = (self.whole(node, 0), *given) if len(given) == 1 else given
        return self.count(node, field_of(node, "left"), field_of(node, "right"), ends, False)

    def effect(self, node: Any) -> tuple[Part, ...]:
        """What an expression that stands alone writes."""
        match node.type:
            case "assignment":
                return self.assignment(node)
            case "augmented_assignment":
                return (self.assign(node, field_of(node, "left"), field_of(node, "right")),)
            case "call":
                return (self.part("do", node, self.expression(node)),)
            case "string" | "ellipsis" if not any(inner.type == "interpolation" for inner in descend(node)):
                return ()
        return (self.unread(node, "an expression without an assignment"),)

    def assignment(self, node: Any) -> tuple[Part, ...]:
        left, right = field_of(node, "left"), field_of(node, "right")
        if right is None:
            return ()
        targets, chain = named(left) if left.type in ("pattern_list", "tuple_pattern") else [left], [left]
        while right.type == "assignment":  # a = b = x
            chain, right = [*chain, field_of(right, "left")], field_of(right, "right")
        if len(targets) > 1 and len(chain) > 1:
            return (self.unread(node, "several names assigned twice at once"),)
        value = self.expression(right)
        first: tuple[Part, ...] = ()
        written = {re.match(r"[\w.]*", text_of(target))[0] for target in targets}  # type: ignore[index]
        if len(targets) > 1 and value.kind == "name" and written & names_in(value):
            return (self.unread(node, "names assigned from each other at once"),)
        if value.kind != "name" and (len(chain) > 1 or (len(targets) > 1 and value.kind in ("call", "op"))):
            once = self.part("name", right, f"several@{node.start_byte}")  # made once; no source can have this name
            first, value = (self.part("assign", node, once, "", value),), once
        if len(targets) == 1:
            return (*first, *(self.part("assign", node, self.expression(target), "", value) for target in chain))
        if value.kind == "name":  # a, b = x
            spots = ((self.whole(node, k),) for k in range(len(targets)))
            items = [Part("index", value.line, (value, spot), value.span) for spot in spots]
        elif value.kind == "list" and len(value.parts[0]) == len(targets):
            items = [self.part("name", right, f"several@{node.start_byte}.{k}") for k in range(len(targets))]
            first = tuple(self.part("assign", node, n, "", x) for n, x in zip(items, value.parts[0], strict=True))
        else:
            return (self.unread(node, "several names assigned at once"),)
        pairs = zip(targets, items, strict=True)
        return (*first, *(self.part("assign", node, self.expression(t), "", v) for t, v in pairs))

    def read_expression(self, node: Any) -> Part | None:
        match node.type:
            case "integer" | "float":
                return self.literal(node, text_of(node), node.type == "float")
            case "conditional_expression":
                then, test, other = named(node)
                return self.part("choose", node, *map(self.expression, (test, then, other)))
            case "subscript":
                base = self.expression(field_of(node, "value"))
                places = self.several(inner := node.children_by_field_name("subscript"))
                if len(inner) == 1 and inner[0].type == "tuple":
                    places = places[0].parts[0]
                return self.part("index", node, base, places)
            case "slice":
                return self.slice(node)
            case "attribute" | "identifier" if (
                text_of(node) in CONSTANTS and text_of(node).split(".")[0] in self.rebound
            ):
                return self.refuse(node, f"{text_of(node)}, which this file uses for something else")
            case "attribute" if self.is_computed(node):
                name = text_of(field_of(node, "attribute"))
                if text_of(node) == f"self.{name}" and ANY not in self.computed and self.has_method(node, name):
                    return self.part("call", node, name, ())
                return self.refuse(node, f"{text_of(node)}, which a class of this file may compute")
            case "attribute" if text_of(field_of(node, "attribute")) == "T":
                return self.part("method", node, self.expression(field_of(node, "object")), "T", ())
            case "call":
                return self.call(node)
        return None

    def operate_alone(self, node: Any, sign: str, operand: Any) -> Part:
        """``+v`` is a copy of an array, and no other name of it."""
        if sign == "+":
            return self.part("op", node, "+", self.whole(node, 0), self.expression(operand))
        return SourceReader.operate_alone(self, node, sign, operand)

    def slice(self, node: Any) -> Part:
        colons = [child.start_byte for child in node.children if child.type == ":"]
        if len(colons) != 1:
            return self.refuse(node, "a slice with a step")
        ends = {child.start_byte > colons[0]: self.expression(child) for child in named(node)}
        return self.part("slice", node, ends.get(False), ends.get(True))

    def call(self, node: Any) -> Part:
        """A function or a method; keywords other than dtype=float are refused."""
        function, given = field_of(node, "function"), field_of(node, "arguments")
        arguments = []
        for child in named(given):
            if child.type == "keyword_argument":
                key, value = (text_of(field_of(child, name)) for name in ("name", "value"))
                if key == "dtype" and value in ("float", "np.float64", "np.float32"):
                    continue
                return self.refuse(node, "an argument by keyword")
            arguments.append(self.expression(child))
        name = "".join(text_of(function).split())
        is_own = () in self.places.get(name, ())
        if function.type == "identifier" and name in self.rebound and not is_own:
            return self.refuse(node, f"{name}, which this file uses for something else")
        if function.type == "identifier" and name == "float" and not is_own and len(arguments) == 1:
            return self.part("cast", node, "real", arguments[0])
        if function.type == "attribute":
            base = text_of(field_of(function, "object"))
            if base.partition(".")[0] in self.rebound:
                return self.refuse(node, f"{base}, which this file uses for something else")
            if base in ("np", "numpy", "math", "np.linalg", "numpy.linalg"):
                return self.part("call", node, name, tuple(arguments))
            method = text_of(field_of(function, "attribute"))
            if base == "self" and not self.has_method(node, method):
                return self.refuse(node, f"the method {method}, which another class or file defines")
            if base == "self":
                return self.part("call", node, method, tuple(arguments))
            return self.part("method", node, self.expression(field_of(function, "object")), method, tuple(arguments))
        if function.type == "identifier" and not self.is_seen(node, name):
            return self.elsewhere(node, f"the function {name}")
        if function.type == "identifier":
            meaning = name if is_own else self.unit.imported.get(name, name)
            return self.part("call", node, meaning, tuple(arguments))
        return self.refuse(node, "a call of an expression")

    def has_method(self, node: Any, name: str) -> bool:
        """True where the class around a node defines a method, or there is no class around it."""
        return self.is_seen(node, name, True) and (self.shift < 0 or name in self.places)

    @staticmethod
    def places_open_to(node: Any, is_member: bool) -> list[tuple[str, ...]]:
        """The module, or the class around a node."""
        owner = next((above for above in ascend(node) if above.type == "class_definition"), None)
        return [(str(owner.start_byte),)] if is_member and owner is not None else [()]


def list_targets(node: Any) -> list[Any]:
    """What an assignment or a loop writes: names, entries and members."""
    waiting, done = [field_of(node, "left")], list[Any]()
    while waiting:
        target = waiting.pop(0)
        is_several = target.type.endswith(("_list", "_pattern")) or target.type in ("list", "tuple")
        waiting[:0] = named(target) if is_several else []
        done += [] if is_several else [target]
    return done


def bound_by(node: Any) -> list[str]:
    """The names that a node binds in any way, or parts of which it writes."""
    match node.type:
        case "assignment" | "augmented_assignment" | "for_statement":
            return [re.match(r"\w*", text_of(target))[0] for target in list_targets(node)]  # type: ignore[index]
        case "function_definition" | "class_definition":
            return [text_of(field_of(node, "name"))]
        case "parameters" | "lambda_parameters":
            return [*map(name_parameter, named(node))]
        case "import_statement" | "import_from_statement":
            names = node.children_by_field_name("name")
            return [text_of(field_of(name, "alias") or name).split(".")[0] for name in names]
        case "named_expression" | "as_pattern_target" | "case_pattern" | "delete_statement":
            return [*identifiers_in(node)]
    return []


def is_numeric(node: Any) -> bool:
    """True for an import of numbers and their functions only, under the names by which they are known."""
    module = field_of(node, "module_name")
    if module is not None:
        return text_of(module) in MODULES
    names = node.children_by_field_name("name")
    pairs = [[text_of(field_of(name, key) or name) for key in ("name", "alias")] for name in names]
    return all(meant in NUMERIC or own not in NAMES for meant, own in pairs)


def may_be_given(node: Any) -> bool:
    """True where the array of a name may get another name, or go to what may write to it; not where it is only read."""
    name, above = "", node.parent
    while above.type in ("subscript", "attribute", "parenthesized_expression"):
        if above.type == "subscript" and field_of(above, "value").id != node.id:
            return False  # an index
        name = text_of(field_of(above, "attribute")) if above.type == "attribute" else ""
        if above.type == "attribute" and field_of(above, "object").id != node.id:
            return False  # the name of a member
        node, above = above, above.parent
    if above.type == "argument_list":
        name = "".join(text_of(field_of(above.parent, "function")).split())
        is_quiet = is_known(name, "python") or name in {*HARMLESS, *PURE["python"], "float", "range"}
        return names_view(name) or not is_quiet
    if above.type == "call":
        return name == "transpose" or not is_method(name, len(named(field_of(above, "arguments"))), "python")
    if above.type in ("assignment", "augmented_assignment"):
        return bool(field_of(above, "left").id != node.id)
    return above.type not in ("binary_operator", "unary_operator", "comparison_operator", "slice", "not_operator",
                              "expression_statement", "aliased_import", "dotted_name")  # fmt: skip


def may_be_array(value: Part) -> bool:
    """True for a value that may be an array, and not only a number."""
    parts = [*walk(value)]
    calls = {bare_name(p.parts[0]) for p in parts if p.kind == "call"}
    return value.kind in ("name", "index") or any(p.kind in ("list", "method") for p in parts) or not calls <= NUMBERS


def name_parameter(node: Any) -> str:
    """The name of a parameter, without its type and its default; of several at once with their star."""
    if node.type.endswith("splat_pattern"):
        return text_of(node)
    return text_of(node if node.type == "identifier" else field_of(node, "name") or next(iter(named(node)), node))
