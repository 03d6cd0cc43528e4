"""What a part of the source may write: one rule for the statements, calls, macros and functions of all languages.

What is not read may write all names in it, and what has no name there. All else follows from what the parts are.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Container, Iterator
from dataclasses import dataclass

from navsym.audit.form import (
    HIDDEN_MACROS,
    Function,
    Part,
    Unit,
    called_in,
    head_of,
    mentioned_in,
    names_in,
    sides_of,
    walk,
)
from navsym.audit.functions import CONSTANTS, HARMLESS, PURE, does_take, extreme_of, is_known, is_method, is_view


@dataclass(frozen=True, slots=True)
class Writes:
    """What a part may write.

    named   : names that stand for something else from now on
    changed : names of what is changed
    others  : what does not belong to the function may be changed as well
    leaves  : the way may end there, or nobody knows where it goes on
    """

    named: frozenset[str] = frozenset()
    changed: frozenset[str] = frozenset()
    others: bool = False
    leaves: bool = False

    @property
    def names(self) -> frozenset[str]:
        """All names that are written."""
        return self.named | self.changed

    def __bool__(self) -> bool:
        return bool(self.names) or self.others or self.leaves


NOTHING = Writes()


def written_by(unit: Unit, *parts: object, entries: Container[str] = (), numbers: Container[str] = ()) -> Writes:
    """What parts may write.

    entries : names before parentheses that hold entries, as in ``v(0)``
    numbers : names of numbers, of which C gives a called function a copy
    """
    inner = [*walk(*parts)]
    several = [(part, writes) for part in inner if (writes := written_alone(unit, part, entries, numbers))]
    named, changed = ({n for p, w in several if is_naming(unit, p) is kind for n in w.names} for kind in (True, False))
    links, count = [link for part in inner for link in list_links(unit, part)], -1
    while count < len(changed):  # what a second name leads to
        count = len(changed)
        changed |= {source for name, sources in links if name in changed for source in sources}
    others, leaves = (any(getattr(writes, key) for _, writes in several) for key in ("others", "leaves"))
    return Writes(frozenset(named), frozenset(changed), others, leaves)


def is_naming(unit: Unit, part: Part) -> bool:
    """True where a name stands for another value from now on, and what it stood for stays as it is."""
    is_bare = part.kind == "assign" and part.parts[0].kind == "name" and not part.parts[1]
    is_bare = is_bare and "." not in part.parts[0].parts[0]  # a member changes what it belongs to
    return part.kind in ("declare", "for") or (is_bare and unit.language in ("python", "matlab"))


def list_links(unit: Unit, part: Part) -> Iterator[tuple[str, set[str]]]:
    """A name that may be another one for what its value names, with these names."""
    if part.kind == "declare" and part.parts[3] is not None:
        if part.parts[4] or part.parts[1] in ("auto", "other"):
            yield part.parts[0], sources_of(part.parts[3])
    elif part.kind == "assign" and unit.language == "python":
        if part.parts[2].kind not in ("name", "list", "refused") and not is_view(unit, part.parts[2]):
            return
        yield from ((root, sources_of(part.parts[2])) for root in roots_of(unit, part.parts[0], ()))


def sources_of(value: Part) -> set[str]:
    """The names that a value mentions, also where it is not read."""
    hidden = (part.parts[1] for part in walk(value) if part.kind == "refused" and len(part.parts) > 1)
    names = mentioned_in(value).union(*hidden)
    return names | {*map(head_of, names)}


def written_alone(unit: Unit, part: Part, entries: Container[str], numbers: Container[str]) -> Writes:
    """What a part may write beside the parts in it."""
    first, *more = part.parts or ("",)
    match part.kind:
        case "assign" if is_naming(unit, part):
            return Writes(frozenset(first.parts))
        case "assign" | "several":
            targets = (first,) if part.kind == "assign" else first
            changed = frozenset[str]().union(*(roots_of(unit, target, entries) for target in targets))
            return Writes(changed=changed, others=any(name not in entries for name in owners_in(unit, *targets)))
        case "declare" | "for":
            is_link = part.kind == "declare" and part.parts[4] is True  # what is written there is written elsewhere
            is_link |= part.kind == "declare" and unit.language == "cpp" and is_made(part)
            return Writes(frozenset([first]), frozenset(names_in(part) if is_link else ()))
        case "address":
            return Writes(changed=frozenset(mentioned_in(part)))
        case "moved":
            return Writes(changed=frozenset([first, *part.parts[2]]), others=not part.parts[3])
        case "return" | "fail":
            return Writes(leaves=True)
        case "call" | "method" if not is_plain(unit, part, entries):
            return written_by_call(unit, part, entries, numbers)
        case "name" | "refused" | "unread" | "jump":
            words = (first,) if part.kind == "name" else more[0] if more else ()
            is_hidden = any(may_write_by_macro(unit, word) for word in words if word not in entries)
            may_write = is_hidden or part.kind in ("unread", "jump") or any(more[1:])
            may_leave = is_hidden or part.kind == "jump" or more[2:] == [True]
            return Writes(changed=frozenset(words), others=True, leaves=may_leave) if may_write else NOTHING
    return NOTHING


def written_by_call(unit: Unit, part: Part, entries: Container[str], numbers: Container[str]) -> Writes:
    """What a call may write: what its function writes; one that is not known writes all that it is given."""
    name, arguments = (part.parts[0], part.parts[1]) if part.kind == "call" else ("", ())
    functions = unit.functions.get(name, []) if name not in entries else []
    fitting = [f for f in functions if len(f.arguments) == len(arguments)]
    if not fitting:
        given = names_in(part) | {called for called in called_in(part) if called in entries}
        given = {known for known in given if unit.language != "c" or known not in numbers}
        may_leave = name in unit.macros or (name.isupper() and name not in entries)
        return Writes(changed=frozenset(given), others=True, leaves=may_leave)
    done, others = set[str](), False
    for function in fitting:
        inside = written_outside(unit, function)
        given_to = {a.name: value for a, value in zip(function.arguments, arguments, strict=True)}
        touched = given_to.keys() if inside.others else {*map(head_of, inside.changed)} & given_to.keys()
        own = mentioned_in(*(given_to[n] for n in touched))
        outer = {n for n in inside.changed if head_of(n) not in given_to}
        others |= inside.others or bool(outer or owners_in(unit, *(given_to[n] for n in touched)))
        done |= own | outer
    return Writes(changed=frozenset(done), others=others, leaves=name in unit.macros)


def is_made(part: Part) -> bool:
    """True for an object of a class that is not known, which is made of what it may write to."""
    return part.parts[1] == "other" and part.parts[3] is not None and part.parts[3].kind == "list"


def owners_in(unit: Unit, *parts: Part | str) -> set[str]:
    """The functions of the file that parts call, also before a member: what they give may be another name."""
    names = {*names_in(*parts), *(part for part in parts if isinstance(part, str))}
    heads = (re.findall(r"(\w+)\(", name) for name in names)
    return (called_in(*parts) | {*itertools.chain(*heads)}) & unit.functions.keys()


def changed_in(unit: Unit, function: Function) -> Writes:
    """What the body of a function may write, its own copies of parameters among it."""
    if function not in unit.effects:
        unit.effects[function] = Writes(others=True)  # of a recursion, which is not read
        own = {argument.name for argument in function.arguments} | own_names(unit, function)
        unit.effects[function] = written_by(unit, *function.body, entries=own)
    known: Writes = unit.effects[function]
    return known


def own_names(unit: Unit, function: Function) -> frozenset[str]:
    """The names that a function declares, or in Python and MATLAB assigns."""
    named = (written_alone(unit, part, (), ()).named for part in walk(*function.body) if is_naming(unit, part))
    return frozenset[str]().union(*named)


def written_outside(unit: Unit, function: Function) -> Writes:
    """What a call of a function may write: of its parameters those that the caller sees, and what is not its own."""
    inside, shared = changed_in(unit, function), {a.name for a in function.arguments if a.shared}
    shared |= {a.name for a in function.arguments if a.number == "other" and unit.language == "cpp"}  # such as Ref
    own = (own_names(unit, function) | {a.name for a in function.arguments}) - shared
    outside = frozenset(name for name in inside.changed if head_of(name) not in own)
    return Writes(changed=outside, others=inside.others)


def may_write_by_macro(unit: Unit, word: str, around: tuple[str, ...] = ()) -> bool:
    """True for a macro whose text may write to something or leave the function."""
    meaning = unit.macros.get(word, "") if word not in around else ""
    if isinstance(meaning, str):
        return meaning in HIDDEN_MACROS
    inner = (part for part in walk(meaning) if part.kind != "name")
    if any(part.kind == "refused" or written_alone(unit, part, (), ()) for part in inner):
        return True
    return any(may_write_by_macro(unit, name, (*around, word)) for name in names_in(meaning))


def is_plain(unit: Unit, part: Part, entries: Container[str] = ()) -> bool:
    """True for a call that writes nothing: of a known function or method, or an entry ``M(i, j)``."""
    if part.kind == "method":
        return part.parts[1] not in unit.functions and is_method(part.parts[1], len(part.parts[2]), unit.language)
    name, language = part.parts[0], unit.language
    if name in entries:
        return True
    is_pure = name in HARMLESS or name in PURE.get(language, ()) or does_take(name, len(part.parts[1]), language)
    is_pure |= bool(extreme_of(name, language))
    return is_pure and name not in unit.functions


def roots_of(unit: Unit, target: Part, entries: Container[str]) -> set[str]:
    """The variable of a target; all names in one that is not understood, or that is a macro."""
    while target.kind in ("index", "method", "first"):
        target = target.parts[0]
    is_own = target.kind == "call" and target.parts[0] in unit.functions and target.parts[0] not in entries
    if target.kind in ("name", "call") and not is_own:
        name, meaning = str(target.parts[0]), unit.macros.get(target.parts[0])
        return {name, *(sources_of(meaning) if isinstance(meaning, Part) else ())}
    return sources_of(target)


def find_race(unit: Unit, parts: tuple[Part, ...], local: set[str], fixed: set[str]) -> Part | None:
    """An operand with a call that writes what another operand reads, or may read; None where there is none."""
    own = called_in(*parts) & unit.functions.keys()
    writing = {name for name in own if any(written_outside(unit, function) for function in unit.functions[name])}
    for node in (Part("list", 0, parts), *walk(*parts)) if writing else ():
        kinds = ("op", "compare", "call", "method", "index", "list")
        sides = sides_of(node) if node.kind in kinds else []
        for side in sides:
            given = [mentioned_in(*p.parts[1]) for p in walk(side) if p.kind == "call" and p.parts[0] in writing]
            rest = mentioned_in(*(other for other in sides if other is not side)) if given else set()
            rest -= fixed | {*unit.macros, *CONSTANTS}
            shared = {*map(head_of, rest)} & {*map(head_of, set[str]().union(*given))}
            if shared or any(n not in local and not is_known(n, unit.language) for n in rest):
                return side
    return None
