"""Where the names of C are known: what the preprocessor surely leaves out, in which scope a name stands, as what."""

from __future__ import annotations

import itertools
import re
from typing import Any

from navsym.audit.form import Unit
from navsym.audit.syntax import ascend, descend, field_of, list_above, named, text_of

WAYS = ("preproc_if", "preproc_ifdef", "preproc_elif", "preproc_elifdef", "preproc_else")
#: Comments and texts, what is no blank, and the lines of the preprocessor.
HIDING = re.compile(rb"(?s)//(?:\\\r?\n|[^\n])*|/\*.*?(?:\*/|\Z)|R\"\w*\(.*?\)\w*\"|\"(?:\\.|[^\"\\\n])*\"|'\\?.'")
BLACK = re.compile(rb"[^\s]")
DIRECTIVE = re.compile(
    rb"(?<!\\\n)(?<!\\\r\n)^[ \t]*#[ \t]*((?:el)?if(?:n?def)?|else|endif|define|undef)\b([^\n]*)", re.MULTILINE
)

NAMED = ("preproc_def", "enumerator")
#: What gives a class a meaning of its own, and how a type is called whose objects do something when they are made.
ACTIVE, MADE = ("operator_name", "base_class_clause"), "an object of the file"
SCOPES = ("namespace_definition", "struct_specifier", "class_specifier")
DECLARING = (
    "init_declarator declaration parameter_declaration array_declarator pointer_declarator reference_declarator "
    "field_declaration"
).split()


def region_of(node: Any) -> tuple[int, int] | None:
    """The way of an undecided ``#if`` around a definition, or the function around an inner one."""
    for above in ascend(node):
        if above.type in WAYS:
            other = field_of(above, "alternative")
            return above.start_byte, above.end_byte if other is None else other.start_byte
        if above.type == "function_definition":
            return above.start_byte, above.end_byte
    return None


def drop_ways(source: bytes, unit: Unit) -> bytes:
    """The source with blanks for what the preprocessor surely leaves out, and for the conditions that say so.

    A file says that a name is not defined by defining it itself: ``#ifndef NAME`` before ``#define NAME``.
    """
    defined, own = unit.defined, "__cplusplus"
    bare, text, before = HIDING.sub(lambda found: BLACK.sub(b" ", found[0]), source), bytearray(source), 0
    known = {*(defined or ()), *([own] if unit.language == "cpp" else ())}
    doubtful, states = set[str](), list[str]()  # "on", "off", "past" behind "on", or "open"

    def state_of(word: str, rest: str) -> str:
        """Of the lines behind a condition; "open" where it is no number and no name of which something is known."""
        if (name := re.fullmatch(r"(!?)\s*defined\s*\(?\s*(\w+)\s*\)?", rest)) and word == "if":
            word, rest = "ifndef" if name[1] else "ifdef", name[2]
        if word == "if":
            return "open" if not re.fullmatch("[0-9]+", rest) else "on" if int(rest) else "off"
        is_open = rest in doubtful or (defined is None and rest not in {own, *known})
        return "open" if is_open else "on" if (rest in known) == (word == "ifdef") else "off"

    def blank(start: int, end: int) -> None:
        text[start:end] = BLACK.sub(b" ", text[start:end])

    directives = [*DIRECTIVE.finditer(bare)]
    for found, following in itertools.zip_longest(directives, directives[1:]):
        word, rest = (part.decode("utf-8", "replace").strip() for part in found.groups())
        if {"off", "past"} & {*states}:
            blank(before, found.start())
        before = found.end()
        old = states.pop() if word.startswith("e") and states else ""
        is_hidden = bool({"off", "past"} & {*states})
        if word in ("define", "undef"):
            if is_hidden:
                blank(*found.span())
            elif name := re.match(r"\w+", rest):
                (doubtful.add if "open" in states else known.add if word == "define" else known.discard)(name[0])
            continue
        new = "past" if old in ("on", "past") else old if old == "open" else "on"
        new = state_of(word.removeprefix("el"), rest) if "if" in word and old in ("", "off") else new
        if word == "ifndef" and new == "open" and rest not in doubtful and following is not None:
            is_own = following[1] == b"define" and following[2].split()[:1] == [rest.encode()]
            new = "on" if is_own else new
        if word != "endif":
            states.append(new)
        if is_hidden or "open" not in (old, new if word != "endif" else ""):
            blank(*found.span())
        elif old == "off":  # the first way of which nothing is known
            text[slice(*found.span(1))] = found[1].removeprefix(b"el").rjust(len(word))
    return bytes(text)


def head_of_function(node: Any) -> Any:
    """The name of a function with its parameters; None where there is none."""
    head = field_of(node, "declarator")
    while head is not None and head.type != "function_declarator":
        head = field_of(head, "declarator") or next(iter(named(head)), None)
    return head


def scope_of(node: Any) -> tuple[str, ...]:
    """The namespaces and classes around a node, those before the name of the function among them."""
    names = list[str]()
    for above in (node, *ascend(node)):
        text = text_of(field_of(above, "name")) if above.type in SCOPES else ""
        if above.type == "function_definition":
            text = text_of(field_of(head_of_function(above), "declarator")).rpartition("::")[0]
        names[:0] = re.findall(r"\w+", re.sub(r"<.*>", "", text))
    return tuple(names)


def list_types(nodes: list[Any]) -> dict[str, str]:
    """What names of types stand for that a source defines; nothing is known of two meanings, or in an ``#if``."""
    types: dict[str, str] = {}
    templates = (node for node in nodes if node.type.endswith("type_parameter_declaration"))
    open_types = {text_of(inner) for node in templates for inner in named(node)}
    for node in nodes:
        if node.type in ("struct_specifier", "class_specifier") and (body := field_of(node, "body")) is not None:
            name = text_of(field_of(node, "name"))
            heads = {text_of(field_of(n, "declarator")) for n in descend(body) if n.type == "function_declarator"}
            is_made = heads & {name, f"~{name}"} or any(n.type in ACTIVE for n in descend(node))
            types[name] = MADE if is_made else "own"
        if node.type in ("type_definition", "alias_declaration"):
            name = field_of(node, "declarator") or field_of(node, "name")
            is_plain = name.type == "type_identifier"
            meaning = text_of(field_of(node, "type")) if is_plain else "pointer"
            name = next((n for n in descend(name) if n.type == "type_identifier"), name)
            meaning = meaning if not {*WAYS} & {*list_above(node)} else "several types"
            if meaning not in open_types and not re.search(rf"\b{text_of(name)}\b", meaning):
                types[text_of(name)] = meaning if types.get(text_of(name), meaning) == meaning else "several types"
    return types


def list_variables(nodes: list[Any]) -> set[str]:
    """The names of a source that are declared or defined as values, and never as types."""
    values, types = set[str](), set[str]()
    for node in nodes:
        name = node if node.type == "identifier" else field_of(node, "name") if node.type in NAMED else None
        if name is not None and node.parent is not None and (node.type in NAMED or node.parent.type in DECLARING):
            values.add(text_of(name))
        elif node.type.endswith(("_specifier", "type_definition", "alias_declaration")):
            types |= {text_of(child) for child in node.children if child.type == "type_identifier"}
    return values - types
