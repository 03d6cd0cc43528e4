"""Points of a motion: the relations that bind the names of its quantities, and values that satisfy them, in balls.

A rotation is written by three angles, the specific force in the frame by that in the body, the rates of the Earth and
of the local level by latitude, velocity and radii. What no relation binds is free: at a point it is a random rational.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from flint import arb, arb_mat, fmpq

from navsym.conventions.card import KEPT, Card
from navsym.conventions.mechanisation import Mechanisation
from navsym.conventions.nilpotent import NOTHING, constant
from navsym.conventions.reading import HIDDEN, Problem
from navsym.conventions.symbols import GENERATORS, Formulas
from navsym.core.balls import exact_ball
from navsym.core.errors import DomainError
from navsym.language.declarations import Parameter
from navsym.language.domains import flatten
from navsym.language.expression import read_tree
from navsym.language.names import quote
from navsym.language.printer import print_tree
from navsym.language.tree import NUMBER, POWER, SYMBOL, Tree, build_symbol, list_names, list_parts
from navsym.language.tree import replace as replace_parts

BITS = 256
TRIES = 20  # random points before one is taken that leaves the declared ranges
BRANCHED = ("sqrt", "abs", "log", "asin", "acos", "atan2")  # equal on a range does not mean equal beyond it
ANGLES = tuple(f"{HIDDEN}a{k}" for k in (1, 2, 3))

#: Quantities, and symbols of those that the file lacks -> where their names lie unless they are declared otherwise.
LIMITS: Mapping[str, tuple[float, float]] = {
    **{"latitude": (-1.2, 1.2), "height": (0.25, 1.0), **dict.fromkeys(("radii", "RN", "RE"), (3.0, 6.0))},
    **{"gravity": (0.5, 3.0), "gravitational_parameter": (0.5, 3.0), "pull": (0.5, 3.0)},
    **dict.fromkeys(("earth_rate", "rate"), (0.5, 2.0)),
}


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """A world in balls, and the value of every parameter in it."""

    world: Any
    values: Mapping[str, Any]


class ImpossibleError(Exception):
    """The quantities contradict the card at every point."""


def evaluate(tree: Tree, values: Mapping[str, Any]) -> Any:
    """The ball of a tree; not finite where it has no value."""
    return flatten(tree).run(values)


# The relations


def euler_texts() -> list[str]:
    """The entries of a rotation by three angles; every rotation is one of these."""
    (s1, c1), (s2, c2), (s3, c3) = ((f"sin({a})", f"cos({a})") for a in ANGLES)
    return [
        f"{c1}*{c2}", f"{c1}*{s2}*{s3} - {s1}*{c3}", f"{c1}*{s2}*{c3} + {s1}*{s3}",
        f"{s1}*{c2}", f"{s1}*{s2}*{s3} + {c1}*{c3}", f"{s1}*{s2}*{c3} - {c1}*{s3}",
        f"-{s2}", f"{c2}*{s3}", f"{c2}*{c3}",
    ]  # fmt: skip


def quaternion_texts() -> list[str]:
    """The components of a unit quaternion by three angles; every one is one of these."""
    (s1, c1), (s2, c2), (s3, c3) = ((f"sin({a})", f"cos({a})") for a in ANGLES)
    return [f"{c1}*{c2}", f"{c1}*{s2}", f"{s1}*{c3}", f"{s1}*{s3}"]


def substitute(tree: Tree, bound: Mapping[str, Tree]) -> Tree:
    """The tree with bound names written by free ones."""
    by = {build_symbol(name): bound[name] for name in list_names(tree) if name in bound}
    return replace_parts(tree, by) if by else tree


@lru_cache(maxsize=256)
def relate(problem: Problem, card: Card) -> tuple[Mapping[str, Tree], Mapping[str, Sequence[Tree]]]:
    """Bound name -> what it is in free ones; quantity -> what its components must be."""
    problem = problem.under(card)
    rotation = tuple(build_symbol(f"{HIDDEN}c{i}{j}") for i in range(3) for j in range(3))
    given = {"rotation": rotation, **problem.quantities}
    bound, wanted = dict[str, Tree](), dict[str, Sequence[Tree]]()

    def bind(quantity: str, texts: Sequence[str]) -> None:
        wanted[quantity] = [substitute(read_tree(text, None), bound) for text in texts]
        pairs = zip(given[quantity], wanted[quantity], strict=True)
        names = {tree.args[0]: value for tree, value in pairs if tree.head == SYMBOL}
        if not {*names} & {*list_names(*wanted[quantity])}:  # others are written by these: they are free
            bound.update((name, value) for name, value in names.items() if name not in bound)

    for name, texts in (("quaternion", quaternion_texts()), ("rotation", euler_texts())):
        if name in given and all(tree.head == SYMBOL for tree in given[name]):
            bind(name, texts)
            del wanted[name]
    for name in ("specific_force", "velocity"):
        if {name, f"{name}_body"} <= set(given):
            C, body = ([print_tree(tree) for tree in given[n]] for n in ("rotation", f"{name}_body"))
            bind(name, [" + ".join(f"({C[3 * i + k]})*({body[k]})" for k in range(3)) for i in range(3)])
    for name, vector in list_relations(problem, card).items():
        if len(given.get(name, ())) == len(vector):
            bind(name, vector)
    return {name: substitute(tree, bound) for name, tree in bound.items()}, wanted


def list_relations(problem: Problem, card: Card) -> dict[str, list[str]]:
    """What follows from the rest, by a motion with all its rates in which it is not given."""
    level, given = card.frame == "local-level", problem.quantities
    shape = "ellipsoid" if len(given.get("radii", ())) > 1 else "sphere"
    earth = card.earth if card.earth != "none" else shape
    whole = replace(card, earth=earth, earth_rate=KEPT, transport_rate=KEPT)
    following = ("earth_rate", "transport_rate", "gravity") if level else ()
    free = {name: trees for name, trees in given.items() if name not in following or len(trees) == 1}
    formulas = Formulas(replace(problem, quantities=free), whole)
    flow, vectors, central = Mechanisation(whole, formulas.world), dict[str, Any](), card.gravity_gradient == "central"
    if level:
        vectors = {name: getattr(flow, name)(flow.truth()) for name in following}
    elif formulas.derived:
        vectors["position"] = flow.truth().position
    if central and "gravitational_parameter" in given and len(given.get("gravity", ())) == 1:
        vectors["gravity"] = [formulas.world.pull * formulas.world.radius]
    elif central:
        vectors["gravity"] = formulas.world.gravity
    elif card.gravity_gradient == "normal":
        vectors["gravity"] = [row[2].value * formulas.symbol("gravity", None) for row in flow.normal_axes()]
    return {name: [formulas.write(getattr(x, "value", x)) for x in vector] for name, vector in vectors.items()}


# Values


class Motion(Formulas):
    """The world of a problem in balls, at the values of its names."""

    def __init__(self, problem: Problem, card: Card, values: Mapping[str, Any]):
        self.values = values
        super().__init__(problem, card)

    def symbol(self, name: str, text: str | None) -> Any:
        """The value of a text."""
        self.texts[name] = text if text is not None else HIDDEN + name
        return evaluate(read_tree(self.texts[name], None), self.values)


def draw_values(problem: Problem, seed: int) -> dict[str, Any]:
    """A random rational for every name, in its declared range; no relation binds them."""
    source, places = random.Random(seed), problem.quantities.items()
    limits = {tree.args[0]: LIMITS[n] for n, trees in places if n in LIMITS for tree in trees if tree.head == SYMBOL}
    limits |= {HIDDEN + name: limit for name, limit in LIMITS.items()}
    hidden = dict.fromkeys((*ANGLES, *(HIDDEN + name for name in (*GENERATORS, "latitude", "wander_angle"))))
    declared: Mapping[str, Parameter | None] = {**problem.parameters, **hidden}
    return {name: pick(source, said, *limits.get(name, (-2.0, 2.0))) for name, said in declared.items()}


def pick(source: random.Random, said: Parameter | None, low: float, high: float) -> Any:
    """A random rational in the declared range, else between the limits."""
    if said is not None and said.lower is not None and said.upper is not None:
        low, high = float(exact_ball(said.lower).mid()), float(exact_ball(said.upper).mid())
    elif said is not None and said.kind in ("positive", "nonnegative"):
        low, high = max(low, 0.25), max(high, 3.0)
    start, end = fmpq(round(low * 10**6), 10**6), fmpq(round(high * 10**6), 10**6)
    return arb(start + (end - start) * fmpq(source.randint(101, 899), 1009))


def is_outside(value: Any, said: Parameter) -> bool:
    """True where a value leaves its declared range."""
    if said.lower is not None and said.upper is not None:
        return bool(value < exact_ball(said.lower) or value > exact_ball(said.upper))
    zero = value.contains(0)
    return not {"positive": value > 0, "nonnegative": not value < 0, "nonzero": not zero}.get(said.kind, True)


def draw_point(problem: Problem, card: Card, seed: int) -> Point:
    """A point of the card's relations; ImpossibleError where the quantities contradict them.

    It lies in the declared ranges where one of some tries does. Another one serves formulas that are analytic: two of
    them that agree on the ranges agree there as well. Raises DomainError where other formulas have its names.
    """
    bound, wanted = relate(problem, card)
    problem = problem.under(card)
    for attempt in range(TRIES):
        values = draw_values(problem, seed + 100 * attempt)
        values.update([(name, evaluate(tree, values)) for name, tree in bound.items()])
        point = Point(Motion(problem, card, values).world, values)
        require_relations(problem, card, point, bound, wanted)
        outside = {name for name, said in problem.parameters.items() if is_outside(values[name], said)}
        if not outside:
            return point
    cells = [x for M in (problem.F, problem.H, problem.G, problem.reset) for row in M for x in row]
    for part in list_parts(*cells, *(tree for trees in problem.quantities.values() for tree in trees)):
        is_root = part.head == POWER and (part.args[1].head != NUMBER or part.args[1].args[0].denominator != 1)
        if (is_root or part.head in BRANCHED) and (names := outside & {*list_names(part)}):
            message = f"expected ranges that the relations of the quantities allow; got others for {', '.join(names)}"
            raise DomainError(
                f"{message}; widen them, or write {quote(print_tree(part))} otherwise", where="parameters"
            )
    return point


def require_relations(
    problem: Problem, card: Card, point: Point, bound: Mapping[str, Tree], wanted: Mapping[str, Sequence[Tree]]
) -> None:
    """Refuse quantities that have no values or are none; ImpossibleError where they contradict the card."""
    given, world, level = problem.quantities, point.world, card.frame == "local-level"
    if "height" in problem.measured and not level:
        raise ImpossibleError("a measured height")
    values = {name: [evaluate(tree, point.values) for tree in trees] for name, trees in given.items()}
    for name, parts in values.items():
        if not all(part.is_finite() for part in parts):
            message = f"expected quantities that have values; got a {name} that has none; correct its range"
            raise DomainError(message, where=f"quantities: {name}")
    C, unit = arb_mat(world.C), arb_mat(3, 3, [int(k % 4 == 0) for k in range(9)])
    if not all(x.contains(0) for x in (C * C.transpose() - unit).entries()):
        message = "expected a rotation, C C' = E for all values of its names; got another matrix; "
        message += "write it by angles, by nine names, or as a quaternion of four names"
        raise DomainError(message, where="quantities: rotation")
    if not C.det() > 0:
        message = "expected a rotation, det C = 1; got a reflection; correct the sign or the order of an axis"
        raise DomainError(message, where="quantities: rotation")
    if not all(radius > 0 for radius in values.get("radii", ())):
        message = "expected radii above zero; got another number; correct it or its range"
        raise DomainError(message, where="quantities: radii")
    own = follow(card, world)  # of formulas, that tell the size themselves
    for name, trees in wanted.items():
        is_free = name in own and not any(tree.head == SYMBOL and tree.args[0] in bound for tree in given[name])
        parts = own[name] if is_free else [evaluate(tree, point.values) for tree in trees]
        if not all(x.overlaps(arb(y)) for x, y in zip(values[name], parts, strict=True)):
            raise ImpossibleError(name)


def follow(card: Card, world: Any) -> dict[str, list[Any]]:
    """The Earth's rate without a part to the east, and gravity without one across the vertical."""
    flow = Mechanisation(replace(card, earth_rate=KEPT), world)
    if card.frame == "local-level":
        vectors = {"earth_rate": flow.earth_rate(flow.truth()), "gravity": flow.gravity(flow.truth())}
    elif card.gravity_gradient == "normal":
        axes = flow.normal_axes()
        down = (axes.T @ constant(world.gravity))[2]
        vectors = {"gravity": axes @ [NOTHING, NOTHING, down]}
    else:
        return {}
    return {name: [x.value for x in vector] for name, vector in vectors.items()}
