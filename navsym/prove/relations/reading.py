"""Claims with vectors, matrices, hypotheses, chains, cases or derivatives, read and written down for the checker.

Every text is read by :mod:`navsym.language.vectors`, which says what is wrong with it and where. The checker gets the
texts as they were typed, the names of all entries, the hypotheses and the rates.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from navsym.claims.formula import Formula, names_of, side_text
from navsym.core.errors import DomainError, ExpressionSyntaxError, ShapeError, UnknownSymbolError
from navsym.language.advice import advise_on_relation
from navsym.language.declarations import read_range
from navsym.language.dimensions import infer_units
from navsym.language.frames import infer_frames
from navsym.language.names import FUNCTIONS, expect_keys, quote, suggest_nearest
from navsym.language.printer import to_text
from navsym.language.schema import Table, as_list, as_table, as_text, join_place, require_key
from navsym.language.shapes import RANGES, Shape, read_shape
from navsym.language.tree import Tree, fold_tree, list_names, list_parts
from navsym.language.vectors import (
    BINDERS,
    RELATIONS,
    Size,
    describe_size,
    is_wide,
    list_free_names,
    read_hypothesis,
    read_value,
)
from navsym.prove.grant import Document, write_numerals
from navsym.prove.relations.judge import TextClaim

#: Two sides of a chain at each of its relations, outside of parentheses and brackets.
SIGN = re.compile(r"[<>!]=|[<>=]")
MOST_LINKS, MOST_ORDER = 16, 8
KEYS = ("id", "left", "right", "relation", "chain", "given", "box", "tolerance", "exists", "order")
#: What may stand between matrices of any size.
WORD_NAMES = ("+", "-", "*", "/", "@", ".T", "transpose", "inv", "trace", "dot", "eye", "zeros")
WORD_HEADS = {*WORD_NAMES, *RELATIONS, "T", "**", "number", "symbol", "pi"}
TIME = "t"


def read_shapes(table: Table, rates: Table, where: str) -> dict[str, Shape]:
    """The declared names by name, with the derivatives of functions of time, and rates taken from ``[rates]``."""
    taken, found = {*table}, dict[str, Shape]()
    for name, value in table.items():
        for shape in read_shape(name, value, taken, join_place(where, name)):
            found[shape.name] = shape
            taken |= {shape.name, *(entry for row in shape.rows for entry in row)}
    for name in rates:
        if name not in found:
            hint = suggest_nearest(name, found)
            raise UnknownSymbolError(
                f"expected a declared name; got {quote(name)}; declare it below [symbols]: {hint}",
                where=join_place("rates", name),
            )
    if TIME not in found and any(shape.rates for shape in found.values()):
        found[TIME] = Shape(TIME, ((TIME,),), "scalar", {TIME: RANGES["real"]})
    return found


def is_text_claim(block: Table, symbols: Table) -> bool:
    """True for a claim that the grammar of numbers alone does not have."""
    if {"given", "chain", "order"} & set(block):
        return True
    texts = [text for key in ("left", "right") for text in list_cells(block.get(key))]
    texts += [str(text) for text in block.get("exists", ()) if isinstance(block.get("exists"), list)]
    tables = {name for name, value in symbols.items() if isinstance(value, dict)}
    return any(is_wide(text) or tables & names_of(text) for text in texts)


def list_cells(side: Any) -> list[str]:
    """The texts of a side: of its entries where it is a list."""
    return [text for part in side for text in list_cells(part)] if isinstance(side, list) else [str(side)]


def read_text_claim(
    block: Table,
    shapes: Mapping[str, Shape],
    rates: Table,
    make_formula: Callable[[Table], Formula],
    limit: Callable[[str, Sequence[Any], str], list[Any]],
    where: str,
) -> TextClaim:
    """One claim.

    make_formula : the claim as it is written
    limit        : name, ends and place of a range of the claim itself -> the range in the words of the checker
    """
    expect_keys(block, KEYS, where)
    sizes = {name: shape.size for name, shape in shapes.items()}
    links = read_links(block, where)
    trees = [read_link(link, sizes, where) for link in links]
    texts = [text for left, _, right in links for text in (left, right)]
    given = read_texts(block.get("given", []), place := join_place(where, "given"))
    stated = [read_hypothesis(text, sizes, where=join_place(place, i)) for i, text in enumerate(given)]
    exists = read_texts(block.get("exists", []), join_place(where, "exists"))
    for i, text in enumerate(exists):
        trees.append(read_value(text, sizes, where=join_place(join_place(where, "exists"), i)).tree)
    order = read_order(block, shapes, join_place(where, "order"))
    trees += stated
    free = set(order).union(*map(list_free_names, trees))
    require_expected(trees, shapes, where)
    require_still(trees, sorted(n for n in free & shapes.keys() if shapes[n].rates or n in rates), where)
    used, slopes = collect_names([*texts, *exists], free, given, shapes, rates, sizes)
    require_rates(trees, slopes, where)
    require_meaning([*trees[: len(links)], *stated], used, shapes, rates, "tolerance" in block, where)
    relations = [text for name in used for text in shapes[name].relations]
    ranges = {entry: span for name in used for entry, span in shapes[name].ranges.items()}
    ranges |= read_box(block, shapes, limit, join_place(where, "box"))
    formula = make_formula(block)
    if any(shape.sizes for shape in shapes.values()) and is_of_any_size([shapes[n] for n in used], trees):
        plain = {"exists": exists, "tolerance": formula.tolerance, "rates": slopes}
        require_plain({**plain, "box": block.get("box"), "order": order}, where)
        declared, scope = declare_any_size(shapes, used, trees, ranges, where)
        declared["given"] = [*map(clean, given)]
        documents = [{"left": clean(x), "relation": sign, "right": clean(y)} | declared for x, sign, y in links]
        return TextClaim(formula, tuple(documents), scope=limit_scope(scope, given, {}))
    common: Document = {
        "symbols": ranges,
        "exists": [*map(clean, exists)],
        "tolerance": formula.tolerance and clean(formula.tolerance),
    }
    common |= {"shapes": {n: [[*row] for row in shapes[n].rows] for n in used if shapes[n].size}}
    common |= {"given": [*map(clean, (*given, *relations))], "rates": slopes}
    common |= {"order": order} if order else {}
    common |= read_random([shapes[name] for name in used], sizes)
    documents = [{"left": clean(x), "relation": sign, "right": clean(y)} | common for x, sign, y in links]
    kinds = {name: (kind_of(shapes[name]), shapes[name].rows) for name in used if shapes[name].size}
    shown = {entry: text for name in used for entry, text in shapes[name].shown().items()}
    scope = describe_scope([shapes[n] for n in used if not (shapes[n].label or n in order)], ranges)
    return TextClaim(formula, tuple(documents), kinds, shown, limit_scope(scope, given, order))


def require_meaning(
    trees: Sequence[Tree], used: Sequence[str], shapes: Mapping[str, Shape], rates: Table, is_printed: bool, where: str
) -> None:
    """Refuse sums of different units and of vectors in different frames, as far as units and frames are declared.

    is_printed : a printed number stands for a quantity in the units of its author
    """
    own = {name: shapes[name] for name in (*used, TIME) if name in shapes}
    if not any(shape.unit or shape.frame for shape in own.values()):
        return
    if is_printed:
        trees = [side for tree in trees for side in tree.args if list_names(side)]
    sizes = {name: shape.size for name, shape in shapes.items()}
    derived = any(part.head == "dot_" for part in list_parts(*trees))
    slopes = {n: read_value(side_text(rates[n]), sizes).tree for n in rates if derived and n in own}
    infer_units(trees, own, slopes, where=where)
    infer_frames(trees, own, slopes, where=where)


def read_box(
    block: Table, shapes: Mapping[str, Shape], limit: Callable[[str, Sequence[Any], str], list[Any]], where: str
) -> dict[str, list[Any]]:
    """The ranges of the claim itself."""
    found = {}
    for name, ends in as_table(block.get("box", {}), where).items():
        if name not in shapes:
            expect_keys({name: ends}, tuple(shapes), where)
        found[name] = limit(name, ends, join_place(where, name))
    return found


def read_random(shapes: Iterable[Shape], sizes: Mapping[str, Size]) -> Document:
    """Means and covariances of the random names in the words of the checker; nothing where there are none."""
    found: Document = {}
    for shape in shapes:
        known, place, n = shape.random, join_place(join_place("symbols", shape.name), "random"), len(shape.rows)
        if known is None:
            continue
        for key, size in (("mean", shape.size), ("cov", shape.size and (n, n))):
            own = read_value(known[key], sizes, where=join_place(place, key)).size
            if own != size:
                message = f"expected {describe_size(size)}; got {describe_size(own)}; correct it"
                raise ShapeError(message, where=join_place(place, key))
        found[shape.name] = {**known, "mean": clean(known["mean"]), "cov": clean(known["cov"])}
    return {"random": found} if found else {}


def require_expected(trees: Sequence[Tree], shapes: Mapping[str, Shape], where: str) -> None:
    """Refuse a random name outside of an expectation or covariance."""

    def collect(part: Tree, inner: list[frozenset[str]]) -> frozenset[str]:
        if part.head == "symbol":
            return frozenset(name for name in part.args if name in shapes and shapes[name].random)
        return frozenset() if part.head in ("E", "cov") else frozenset().union(*inner)

    for name in sorted(frozenset().union(*(fold_tree(tree, collect) for tree in trees))):
        message = f"expected the random {name} inside E(...) or cov(...); got it outside; state what is expected of it"
        raise DomainError(message, where=where)


def require_still(trees: Sequence[Tree], moving: Sequence[str], where: str) -> None:
    """Refuse an integral, sum or limit over the time on which other symbols depend."""
    if moving and any(part.head in BINDERS and part.args[1].args == (TIME,) for part in list_parts(*trees)):
        message = f"expected another variable than {TIME}, on which {moving[0]} depends; got {TIME}; call it tau"
        raise DomainError(message, where=where)


def kind_of(shape: Shape) -> str:
    """How points of it are drawn."""
    return next((word for word in ("orthogonal", "positive") if word in shape.properties), shape.kind)


def is_of_any_size(shapes: Sequence[Shape], trees: Sequence[Tree]) -> bool:
    """Whether a claim has a matrix of any size, also a unit matrix of a named dimension."""
    sized = any(part.args[0].head == "symbol" for part in list_parts(*trees) if part.head in ("eye", "zeros"))
    return sized or any(shape.sizes for shape in shapes)


def require_plain(parts: Mapping[str, Any], where: str) -> None:
    """Refuse what claims on matrices of any size do not have."""
    for name, value in parts.items():
        if value:
            message = f"expected a claim on matrices of any size alone; got {name} beside it; remove it"
            raise DomainError(message, where=join_place(where, name))


def declare_any_size(
    shapes: Mapping[str, Shape],
    used: Sequence[str],
    trees: Sequence[Tree],
    ranges: Mapping[str, Sequence[Any]],
    where: str,
) -> tuple[Document, str]:
    """The declarations of a claim on matrices of any size in the words of the checker, and its scope in words."""
    for part in list_parts(*trees):
        if part.head not in WORD_HEADS and part.head not in FUNCTIONS:
            message = f"expected {' '.join(WORD_NAMES)} of matrices of any size; got {part.head}"
            raise ShapeError(f"{message}; write it with these, or give the dimensions as numbers", where=where)
    matrices: dict[str, Any] = {}
    sides: dict[str, None] = {}
    for shape in (shapes[name] for name in used):
        if shape.size is None:
            continue
        if shape.rates or shape.kind == "quaternion":
            message = f"expected constant matrices and vectors beside those of any size; got {shape.name}"
            raise ShapeError(f"{message}; state the claim without it", where=where)
        words = ["orthogonal"] if shape.kind == "rotation" else [*shape.properties]
        matrices[shape.name] = {"size": [*shape.size], "is": words}
        sides |= dict.fromkeys(side for side in shape.size if isinstance(side, str))
    for part in list_parts(*trees):
        if part.head in ("eye", "zeros"):
            sides |= dict.fromkeys(size.args[0] for size in part.args if size.head == "symbol")
    known = {side for shape in shapes.values() for side in shape.size or () if isinstance(side, str)}
    sides |= dict.fromkeys(name for tree in trees for name in sorted(list_names(tree)) if name in known)
    numbers = [shapes[n] for n in used if shapes[n].size is None and n not in sides]
    for name in {*sides} & {*shapes}:
        require_dimension(shapes[name], where)
    scope = describe_scope([*numbers, *(shapes[name] for name in matrices)], ranges)
    symbols = {shape.name: ranges[shape.name] for shape in numbers}
    return {"symbols": symbols, "matrices": matrices, "dimensions": [*sides]}, scope


def require_dimension(shape: Shape, where: str) -> None:
    """Refuse a dimension that is declared as something else than a whole number from 1 on."""
    limit = shape.ranges.get(shape.name, [None, None, []])
    if shape.size is not None or limit != ["1", None, ["integer"]]:
        message = f"expected {shape.name} as a dimension alone; got another declaration of it"
        raise DomainError(f'{message}; write {{ integer = ["1", "oo"] }}, or rename one', where=where)


def read_links(block: Table, where: str) -> list[tuple[str, str, str]]:
    """Left side, relation and right side of each link of a chain, or of the one relation."""
    if "chain" not in block:
        sides = [side_text(require_key(block, key, where)) for key in ("left", "right")]
        return [(sides[0], read_relation(block, where), sides[1])]
    place = join_place(where, "chain")
    for key in ("left", "right", "relation"):
        if key in block:
            raise ExpressionSyntaxError(f"expected a chain alone; got {key} beside it; remove one of them", where=place)
    text = as_text(block["chain"], place, "a chain")
    marks = list_relations(text)
    if not 1 <= len(marks) <= MOST_LINKS:
        message = f'expected 1 to {MOST_LINKS} relations; got {len(marks)}; write "a = b <= c"'
        raise ExpressionSyntaxError(message, where=place)
    ends = [0, *(end for mark in marks for end in (mark.start(), mark.end())), len(text)]
    sides = [text[a:b].strip() for a, b in zip(ends[::2], ends[1::2], strict=True)]
    return [(sides[k], mark[0], sides[k + 1]) for k, mark in enumerate(marks)]


def read_relation(block: Table, where: str) -> str:
    """The relation of a claim."""
    relation = as_text(block.get("relation", "="), join_place(where, "relation"), "a relation")
    if relation not in RELATIONS:
        hint = advise_on_relation(relation, RELATIONS)
        message = f"expected one of {' '.join(RELATIONS)}; got {quote(relation)}; correct it: {hint}"
        raise ExpressionSyntaxError(message, where=join_place(where, "relation"))
    return relation


def list_relations(text: str) -> list[re.Match[str]]:
    """The relations of a text that stand in no parentheses and brackets."""
    depth, depths = 0, []
    for char in text:
        depth += (char in "([") - (char in ")]")
        depths.append(depth)
    return [mark for mark in SIGN.finditer(text) if depths[mark.start()] == 0]


def read_link(link: tuple[str, str, str], sizes: Mapping[str, Size], where: str) -> Tree:
    """The tree of both sides, which have one shape."""
    left, right = (
        read_value(text, sizes, where=join_place(where, key))
        for text, key in zip(link[::2], ("left", "right"), strict=True)
    )
    if left.size != right.size:
        got = f"{describe_size(left.size)} and {describe_size(right.size)}"
        raise ShapeError(f"expected two sides of one shape; got {got}; correct one of them", where=where)
    if left.size is not None and link[1] not in ("=", "!="):
        message = f"expected = or != between matrices; got {link[1]}; compare them entry by entry"
        raise ShapeError(message, where=join_place(where, "relation"))
    from navsym.language.tree import build

    return build(link[1], (left.tree, right.tree))


def read_order(block: Table, shapes: Mapping[str, Shape], where: str) -> dict[str, int]:
    """The small number and the order of the terms that do not count; none of a chain or an inequality."""
    if "order" not in block:
        return {}
    table = as_table(block["order"], where)
    if len(table) != 1 or "chain" in block or block.get("relation", "=") != "=":
        message = "expected the order in one number, beside one equation; got another claim; write order = { eps = 2 }"
        raise ExpressionSyntaxError(message, where=where)
    ((name, order),) = table.items()
    if name not in shapes or shapes[name].size is not None:
        raise UnknownSymbolError(
            f"expected the name of a number; got {quote(name)}; declare it: {suggest_nearest(name, shapes)}",
            where=where,
        )
    if not isinstance(order, int) or isinstance(order, bool) or not 1 <= order <= MOST_ORDER:
        message = f"expected a whole number from 1 to {MOST_ORDER}; got {quote(order)}; correct it"
        raise DomainError(message, where=where)
    return {name: order}


def read_texts(value: Any, where: str) -> list[str]:
    """A list of texts."""
    items = [] if value in ([], ()) else as_list(value, where)
    return [as_text(item, join_place(where, i), "an expression") for i, item in enumerate(items)]


def collect_names(
    texts: Iterable[str],
    free: set[str],
    given: Sequence[str],
    shapes: Mapping[str, Shape],
    rates: Table,
    sizes: Mapping[str, Size],
) -> tuple[list[str], dict[str, str | None]]:
    """The free names of texts, those of hypotheses and rates, in the order of declaration; and the rates."""
    derived = any(re.search(r"\b(diff|dot_)\s*\(", text) for text in (*texts, *given))
    waiting = [*free.union(*map(names_of, given)) & set(shapes)]
    used, slopes = set[str](), dict[str, str | None]()
    while waiting:
        name = waiting.pop()
        if name in used:
            continue
        used.add(name)
        if shapes[name].random:
            moments = [(shapes[name].random or {})[key] for key in ("mean", "cov")]
            waiting += [n for text in moments for n in names_of(text) & set(shapes)]
        if not derived:
            continue
        own = dict(shapes[name].rates or {})
        if name in rates:
            place = join_place("rates", name)
            text = side_text(rates[name])
            if read_value(text, sizes, where=place).size != shapes[name].size:
                message = f"expected a rate of the shape of {name}; got another one; correct it"
                raise ShapeError(message, where=place)
            own = {name: clean(text)}
        slopes |= own
        waiting += [n for text in own.values() if text is not None for n in names_of(text) & set(shapes)]
    if derived and (slopes or any(shape.rates for shape in shapes.values())) and TIME in shapes:
        slopes[TIME] = "1"
    return [name for name in shapes if name in used], slopes


def require_rates(trees: Sequence[Tree], rates: Mapping[str, str | None], where: str) -> None:
    """Refuse a derivative by time of what has no rate at all: it would silently be 0."""
    for part in list_parts(*trees):
        if part.head == "dot_" and not set(rates) & {*list_names(part)}:
            names = ", ".join(sorted(list_names(part))) or "a number"
            message = f'expected a rate below dot_; got none of {names}; write [rates], or declare {{ function = "t" }}'
            raise DomainError(message, where=where)


def clean(text: str) -> str:
    """The text on one line, with decimals as the checker reads them."""
    return write_numerals(" ".join(text.split()))


def describe_scope(shapes: Sequence[Shape], ranges: Mapping[str, Sequence[Any]]) -> str:
    """The quantifier in words."""
    words = []
    for shape in shapes:
        if shape.random:
            law = "normal " if shape.random["normal"] else "random "
            words.append(f"{law}{shape.name} of mean {shape.random['mean']} and covariance {shape.random['cov']}")
        elif shape.kind == "scalar":
            words.append(describe_range(shape.name, ranges[shape.name]))
        elif shape.sizes or shape.properties:
            kind = f"{' '.join(shape.properties)} " if shape.properties else ""
            rows, columns = shape.size or (1, 1)
            size = str(rows) if columns == 1 else f"({rows} x {columns})"
            words.append(f"{kind}{shape.name} in R^{size}")
        elif shape.relations:
            words.append(f"{shape.name} in {'SO(3)' if shape.kind == 'rotation' else 'S^3'}")
        else:
            rows, columns = shape.size or (1, 1)
            words.append(f"{shape.name} in R^{rows}" if columns == 1 else f"{shape.name} in R^({rows} x {columns})")
    return "all " + ", ".join(words) if words else "numbers"


def limit_scope(scope: str, given: Sequence[str], order: Mapping[str, int]) -> str:
    """The scope with what limits it: hypotheses, and the small number of an order."""
    small = "".join(f", up to O({name}**{power}) for {name} to 0" for name, power in order.items())
    return scope + (f" with {', '.join(map(clean, given))}" if given else "") + small


def describe_range(name: str, limits: Sequence[Any]) -> str:
    """A range in words: ``real x != 0``, ``T in [0, pi]``."""
    low, high, flags = limits
    if low is None and high is None:
        return f"{'integer' if 'integer' in flags else 'real'} {name}" + " != 0" * ("nonzero" in flags)
    left = "(" if low is None or "open-low" in flags else "["
    right = ")" if high is None or "open-high" in flags else "]"
    return f"{name} in {left}{low or '-oo'}, {high or 'oo'}{right}" + " whole" * ("integer" in flags)


def limit_scalar(name: str, ends: Any, shape: Shape, place: str) -> list[Any]:
    """The range of a claim itself for a scalar without a range of its own."""
    if shape.kind != "scalar" or shape.ranges[name][:2] != [None, None]:
        message = f"expected a real scalar; got {name}, which has entries or a range; narrow its declaration"
        raise DomainError(message, where=place)
    low, high = read_range(ends, place, shape.unit)
    return [to_text(low), to_text(high), list(shape.ranges[name][2])]
