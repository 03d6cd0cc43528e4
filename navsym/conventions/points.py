"""Points of a motion: values of the user's parameters that satisfy the relations of the quantities, in balls.

A rotation satisfies C C' = E, the specific force in the frame is C times that in the body, the rates of the Earth and
of the local level follow from latitude, velocity and radii. What no relation binds is a random rational.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import arb, arb_mat, fmpq

from navsym.conventions.card import KEPT, Card
from navsym.conventions.frames import locate
from navsym.conventions.measuring import CORRECTED
from navsym.conventions.mechanisation import Mechanisation, World, add_centrifugal, axes_rows, rotate_about_pole
from navsym.conventions.nilpotent import rotate
from navsym.conventions.reading import Problem
from navsym.core.balls import exact_ball
from navsym.core.errors import DomainError
from navsym.language.declarations import Parameter
from navsym.language.domains import flatten
from navsym.language.names import quote
from navsym.language.printer import print_tree
from navsym.language.tree import NUMBER, POWER, SYMBOL, Tree, list_names, list_parts

BITS = 256
TRIES = 20  # random points before one is taken that leaves the declared ranges
BRANCHED = ("sqrt", "abs", "log", "asin", "acos", "atan2")  # equal on a range does not mean equal beyond it


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """A world in balls, and the value of every parameter in it."""

    world: World
    values: Mapping[str, Any]


class ImpossibleError(Exception):
    """The quantities contradict the card at every point."""


def evaluate(tree: Tree, values: Mapping[str, Any]) -> Any:
    """The ball of a tree; not finite where it has no value."""
    return flatten(tree).run(values)


class Sampler:
    """One random point; the quantities are settled one after the other, each bound to those before it."""

    def __init__(self, problem: Problem, card: Card, seed: int, free: bool = False):
        self.problem, self.card = problem.under(card), card
        self.random = random.Random(seed)
        self.rows: list[list[Any]] = []
        self.values: dict[str, Any] = {}
        self.outside: set[str] = set()
        if not free:
            self.draw_quaternion()
            self.draw_rotation()
        bound = [tree for trees in self.problem.quantities.values() for tree in trees if tree.head != SYMBOL]
        for name in list_names(*bound):
            self.values.setdefault(name, self.pick(problem.parameters[name]))
        if free:
            for name, parameter in problem.parameters.items():
                self.values.setdefault(name, self.pick(parameter))

    def draw_quaternion(self) -> None:
        """A unit quaternion with rational components, where they are names."""
        trees = self.problem.quantities.get("quaternion", ())
        if all(tree.head == SYMBOL for tree in trees):
            x, y, z = (fmpq(self.random.randint(1, 9) * self.random.choice((-1, 1)), 7) for _ in range(3))
            n = 1 + x * x + y * y + z * z
            for tree, part in zip(trees, (1 - 2 / n, 2 * x / n, 2 * y / n, 2 * z / n), strict=False):
                self.assign(tree.args[0], arb(part))

    def draw_rotation(self) -> None:
        """A rotation by Cayley's formula, where its entries are nine names: other quantities may be written by them."""
        trees = self.problem.quantities.get("rotation", ())
        if len({*trees}) == 9 and all(tree.head == SYMBOL for tree in trees):
            self.settle("rotation", [x for row in self.cayley() for x in row])

    def pick(self, parameter: Parameter | None, low: float = -2.0, high: float = 2.0) -> Any:
        """A random rational in the declared range."""
        if parameter is not None and parameter.lower is not None and parameter.upper is not None:
            low, high = float(exact_ball(parameter.lower).mid()), float(exact_ball(parameter.upper).mid())
        elif parameter is not None and parameter.kind in ("positive", "nonnegative"):
            low, high = 0.25, 3.0
        share = self.random.randint(101, 899)
        start, end = fmpq(round(low * 10**6), 10**6), fmpq(round(high * 10**6), 10**6)
        return arb(start + (end - start) * fmpq(share, 1000))

    def assign(self, name: str, value: Any) -> None:
        """Give a name its value, and note where that leaves its range."""
        self.values[name], said = value, self.problem.parameters[name]
        if said.lower is not None and said.upper is not None:
            is_inside = not (value < exact_ball(said.lower) or value > exact_ball(said.upper))
        else:
            zero = value.contains(0)
            is_inside = {"positive": value > 0, "nonnegative": not value < 0, "nonzero": not zero}.get(said.kind, True)
        self.outside |= set() if is_inside else {name}

    def settle(self, name: str, wanted: Sequence[Any] | None = None, low: float = -2.0, high: float = 2.0) -> list[Any]:
        """The components of a quantity: what its expressions say, else ``wanted``, else random ones.

        Raises ImpossibleError where an expression contradicts ``wanted``.
        """
        trees = self.problem.quantities.get(name)
        if trees is None:
            return list(wanted) if wanted is not None else [self.pick(None, low, high)]
        result = []
        for k, tree in enumerate(trees):
            if tree.head == SYMBOL and tree.args[0] not in self.values:
                value = wanted[k] if wanted is not None else self.pick(self.problem.parameters[tree.args[0]], low, high)
                self.assign(tree.args[0], value)
            result.append(evaluate(tree, self.values))
            if not result[-1].is_finite():
                message = f"expected quantities that have values; got a {name} that has none; correct its range"
                raise DomainError(message, where=f"quantities: {name}")
            if wanted is not None and not result[-1].overlaps(wanted[k]):
                raise ImpossibleError(name)
        return result

    def vector(self, name: str) -> list[Any]:
        """Three components without a relation."""
        found = self.settle(name)
        return found if len(found) == 3 else [self.pick(None) for _ in range(3)]

    def rotation(self) -> list[list[Any]]:
        """The rotation that the file says, or one by Cayley's formula."""
        known = "rotation" in self.problem.quantities
        flat = self.settle("rotation", None if known else [x for row in self.cayley() for x in row])
        C = [flat[3 * k : 3 * k + 3] for k in range(3)]
        if not all((dot(C[i], C[j]) - int(i == j)).contains(0) for i in range(3) for j in range(3)):
            message = "expected a rotation, C C' = E for all values of its names; got another matrix; "
            message += "write it by angles, by nine names, or as a quaternion of four names"
            raise DomainError(message, where="quantities: rotation")
        if not arb_mat(C).det() > 0:
            message = "expected a rotation, det C = 1; got a reflection; correct the sign or the order of an axis"
            raise DomainError(message, where="quantities: rotation")
        return C

    def cayley(self) -> list[list[Any]]:
        """A rotation with rational entries."""
        q = [fmpq(self.random.randint(1, 9) * self.random.choice((-1, 1)), 7) for _ in range(4)]
        a, b, c, d = q
        n = a * a + b * b + c * c + d * d
        rows = [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
        ]
        return [[arb(x / n) for x in row] for row in rows]

    def forces(self, C: list[list[Any]]) -> list[Any]:
        """The specific force in the body; that in the frame is C times it."""
        if "specific_force" in self.problem.quantities and "specific_force_body" not in self.problem.quantities:
            frame = self.settle("specific_force")
            return [dot(column, frame) for column in zip(*C, strict=True)]
        body = self.vector("specific_force_body")
        self.settle("specific_force", [dot(row, body) for row in C])
        return body

    def turned(self, ned: Sequence[Any]) -> list[Any]:
        """A vector in the axes from north, east, down."""
        return [dot(row, ned) for row in self.rows]

    def draw(self) -> Point:
        """The point."""
        card, given = self.card, self.problem.quantities
        level = card.frame == "local-level"
        if "height" in self.problem.measured and not level:
            raise ImpossibleError("a measured height")
        C = self.rotation()
        f, w, v = self.forces(C), self.vector("angular_rate"), self.vector("velocity")
        (latitude,) = self.settle("latitude", None, -1.2, 1.2)
        sine, cosine = latitude.sin(), latitude.cos()
        wander = self.circle("wander_angle")
        self.rows = axes_rows(card, *wander)
        h: Any = self.settle("height", None, 0.25, 1.0)[0] if "height" in given else 0
        RN, RE, third = self.radii()
        meridian, angle = self.circle("longitude"), self.circle("earth_angle")
        turn = rotate_about_pole(angle if card.frame == "inertial" else (0, 1))
        normal = rotate(turn, (-cosine * meridian[1], -cosine * meridian[0], -sine))
        if self.problem.is_placed and not level:
            r = self.settle("position", rotate(turn, locate(sine, cosine, meridian, h, RN, RE)))
        else:
            r = self.vector("position")
        radius = dot(r, r).sqrt()
        earth = self.rotation_of_earth(sine, cosine, level)
        pull, gravity = self.gravitation(r, radius, level, normal, earth)
        motion = C, f, w, v, r, earth, sine, cosine, h, RN, RE, self.settle("radius_slope")[0]
        world = World(
            *motion,
            *(gravity, pull, radius, gradient_names(RN, RE, h, third, (RN * RE).sqrt()), None, None),
            self.settle("lever_arm") if "lever_arm" in given else (0, 0, 0),
            self.vector("known_vector"),
            tuple(self.problem.measured),
            {r: self.vector(f"{r}_correction") for r in CORRECTED} if self.problem.reset else {},
            *(meridian, angle, wander),
        )
        transport = self.transport(world) if level and "transport_rate" in given else None
        if transport is None and "transport_rate" in given:
            self.settle("transport_rate")
        if transport is not None:
            world = replace(world, transport=transport)
        for name, parameter in self.problem.parameters.items():
            if name not in self.values:
                self.values[name] = self.pick(parameter)
        return Point(world, self.values)

    def circle(self, name: str) -> tuple[Any, Any]:
        """Sine and cosine of an angle; those of zero where it is not given."""
        angle = self.settle(name)[0] if name in self.problem.quantities else arb(0)
        return angle.sin(), angle.cos()

    def radii(self) -> tuple[Any, Any, Any]:
        """Meridian, prime vertical, and the radius of gravity."""
        found = self.settle("radii", None, 3.0, 6.0)
        if not all(radius > 0 for radius in found):
            message = "expected radii above zero; got another number; correct it or its range"
            raise DomainError(message, where="quantities: radii")
        if len(found) == 1:
            sphere = self.card.earth != "ellipsoid"
            return found[0], found[0] if sphere else self.pick(None, 3.0, 6.0), found[0]
        return found[0], found[1], found[-1]

    def gravitation(
        self, r: list[Any], radius: Any, level: bool, normal: list[Any], earth: list[Any]
    ) -> tuple[Any, list[Any]]:
        """mu/|r|^3, and gravity in the frame or along down."""
        if "gravitational_parameter" in self.problem.quantities:
            pull = self.settle("gravitational_parameter", None, 0.5, 3.0)[0] / radius**3
        else:
            pull = self.pick(None, 0.5, 3.0)
        size = len(self.problem.quantities.get("gravity", ()))
        if level:
            scalar = self.pick(None, 0.5, 3.0) if size == 3 else self.settle("gravity", None, 0.5, 3.0)[0]
            if size == 3:
                trees = self.problem.quantities["gravity"]
                if any(t.head != SYMBOL or t.args[0] in self.values for t in trees):
                    found = self.settle("gravity")
                    scalar = dot([row[2] for row in self.rows], found)
                self.settle("gravity", self.turned([arb(0), arb(0), scalar]))
            return pull, [scalar]
        if size == 3:
            central = add_centrifugal(self.card, [-pull * x for x in r], earth, r)
            fields = {"central": central, "normal": [self.pick(None, 0.5, 3.0) * x for x in normal]}
            wanted = fields.get(self.card.gravity_gradient)
            return pull, self.settle("gravity", wanted)
        parameter = self.card.gravity_gradient == "central" and "gravitational_parameter" in self.problem.quantities
        size_of = self.settle("gravity", [pull * radius] if parameter else None, 0.5, 3.0)[0]
        if self.card.gravity_gradient == "normal":
            return pull, [size_of * x for x in normal]
        if size == 1 and "gravitational_parameter" not in self.problem.quantities:
            pull = size_of / radius
        return pull, add_centrifugal(self.card, [-size_of * x / radius for x in r], earth, r)

    def rotation_of_earth(self, sine: Any, cosine: Any, level: bool) -> list[Any]:
        """The Earth's rate in the frame, or (north, down) of a local level."""
        trees = self.problem.quantities.get("earth_rate", ())
        if len(trees) != 3:
            (rate,) = self.settle("earth_rate", None, 0.5, 2.0)
            return [rate * cosine, -rate * sine] if level else [arb(0), arb(0), rate]
        if not level:
            return self.settle("earth_rate")
        if all(tree.head != SYMBOL for tree in trees):
            found = self.settle("earth_rate")
            north, east, down = (dot(column, found) for column in zip(*self.rows, strict=True))
            if not east.contains(0):
                raise ImpossibleError("earth_rate")
            return [north, down]
        rate = self.pick(None, 0.5, 2.0)
        self.settle("earth_rate", self.turned([rate * cosine, arb(0), -rate * sine]))
        return [rate * cosine, -rate * sine]

    def transport(self, world: World) -> list[Any]:
        """The transport rate in the axes, in the names that it has."""
        flow = Mechanisation(replace(self.card, transport_rate=KEPT), world)
        return self.settle("transport_rate", [arb(x.value) for x in flow.transport_rate(flow.truth())])


def dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    """The sum of u_k v_k in balls."""
    return sum((x * y for x, y in zip(u, v, strict=True)), arb(0))


def gradient_names(RN: Any, RE: Any, h: Any, third: Any, mean: Any) -> dict[str, Any]:
    """Words of a card -> the radius of its gradient of gravity; ``mean`` is sqrt(RN RE)."""
    bare = {"R": RN, "RN": RN, "RE": RE, "sqrt(RN*RE)": mean, "third radius": third}
    lifted = {f"{name} + h": value if type(h) is int else value + h for name, value in bare.items()}
    return {**bare, **lifted, "radial": third}


def draw_point(problem: Problem, card: Card, seed: int) -> Point:
    """A point of the card's relations; ImpossibleError where the quantities contradict them.

    It lies in the declared ranges where one of some tries does. Another one serves formulas that are analytic: two of
    them that agree on the ranges agree there as well. Raises DomainError where other formulas have its names.
    """
    for attempt in range(TRIES):
        sampler = Sampler(problem, card, seed + 100 * attempt)
        point = sampler.draw()
        if not sampler.outside:
            return point
    cells = [x for M in (problem.F, problem.H, problem.G, problem.reset) for row in M for x in row]
    for part in list_parts(*cells, *(tree for trees in problem.quantities.values() for tree in trees)):
        is_root = part.head == POWER and (part.args[1].head != NUMBER or part.args[1].args[0].denominator != 1)
        if (is_root or part.head in BRANCHED) and (names := sampler.outside & {*list_names(part)}):
            message = f"expected ranges that the relations of the quantities allow; got others for {', '.join(names)}"
            raise DomainError(
                f"{message}; widen them, or write {quote(print_tree(part))} otherwise", where="parameters"
            )
    return point
