"""The error dynamics of a card as formulas in the user's own names.

The mechanisation runs over quotients of polynomials. At the end the relations of a rotation, C C' = E and its own
cofactors, and sin**2 + cos**2 = 1 bring each entry to a normal form.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from itertools import product
from math import lcm, prod
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx, fmpz_mpoly_ctx, fmpz_mpoly_vec

from navsym.conventions.card import Card
from navsym.conventions.frames import locate
from navsym.conventions.measuring import CORRECTED, full_column
from navsym.conventions.mechanisation import (
    AXES,
    Mechanisation,
    World,
    add_centrifugal,
    axes_rows,
    plus_height,
    rotate_about_pole,
)
from navsym.conventions.nilpotent import constant, rotate, times
from navsym.conventions.reading import HIDDEN, Problem
from navsym.core.exact import to_fmpq
from navsym.core.rational_functions import Quotient, Ratio, cancel_fraction
from navsym.language.expression import read_tree
from navsym.language.printer import print_tree
from navsym.language.tree import NUMBER, POWER, PRODUCT, SUM, Tree, build, fold_tree

NUMERAL = re.compile(r"-?\d+(/\d+)?")

GENERATORS = (
    *(f"c{i}{j}" for i in range(3) for j in range(3)),
    *(
        f"{name}{k}"
        for name in ("f", "b", "w", "v", "u", "r", "g", "t", "e", "l", "m", "ca", "cv", "cp")
        for k in range(3)
    ),
    *"sin cos east ahead turned straight wander_sin wander_cos".split(),
    *"h RN RE third mean slope rate gravity pull radius".split(),
)


#: Places of sines and cosines of one angle each.
CIRCLES = [(k, k + 1) for k in range(GENERATORS.index("sin"), GENERATORS.index("h"), 2)]


def reduce_circles(poly: Any) -> Any:
    """The normal form of a polynomial modulo sin**2 + cos**2 = 1."""
    degrees, context = poly.degrees(), poly.context()
    for sine, cosine in CIRCLES:
        if degrees[sine] > 1:
            poly = divmod(poly, context.gen(sine) ** 2 + context.gen(cosine) ** 2 - 1)[1]
    return poly


class Entry(Ratio):
    """A quotient whose top is in normal form modulo sin**2 + cos**2 = 1: products of rotations stay short."""

    def __init__(self, quotient: Quotient):
        top = reduce_circles(quotient.top)
        super().__init__(quotient if top == quotient.top else cancel_fraction(top, quotient.bottom))


def gradient_names(RN: Any, RE: Any, h: Any, third: Any, mean: Any) -> dict[str, Any]:
    """Words of a card -> the radius of its gradient of gravity; ``mean`` is sqrt(RN RE)."""
    bare = {"R": RN, "RN": RN, "RE": RE, "sqrt(RN*RE)": mean, "third radius": third}
    return {**bare, **{f"{name} + h": plus_height(value, h) for name, value in bare.items()}, "radial": third}


class Formulas:
    """The world of a problem in symbols, with a text for each of them."""

    def __init__(self, problem: Problem, card: Card):
        self.problem, self.card = problem.under(card), card
        self.context = fmpq_mpoly_ctx.get(GENERATORS, "lex")
        self.texts: dict[str, str] = {}
        self.derived: dict[str, Any] = {}
        self.world = self.build()
        flow = Mechanisation(card, self.world)
        self.columns = cache(lambda role: [full_column(flow, role, k) for k in range(3)])  # of F, every sign plus

    def block(self, row: str, column: str, sign: Fraction = Fraction(1)) -> list[list[str]]:
        """A block of F as texts, times a sign."""
        parts = self.columns(column)
        return [[self.write(parts[j][row][i], sign) for j in range(3)] for i in range(len(parts[0][row]))]

    # Symbols and their texts

    def text(self, quantity: str, place: int = 0) -> str | None:
        """What the user writes for a component of a quantity."""
        trees = self.problem.quantities.get(quantity)
        return None if trees is None else print_tree(trees[place])

    def symbol(self, name: str, text: str | None) -> Ratio:
        """A generator, with its text; a number stands for itself."""
        self.texts[name] = text if text is not None else HIDDEN + name
        poly, one = self.context.gen(GENERATORS.index(name)), self.context.constant(1)
        if text is not None and NUMERAL.fullmatch(text):
            poly = one * to_fmpq(Fraction(text))
        return Entry(Quotient(poly, one))

    def vector(self, name: str, quantity: str) -> list[Ratio]:
        """Three components of a quantity."""
        return [self.symbol(f"{name}{k}", self.text(quantity, k)) for k in range(3)]

    def build(self) -> World:
        """The quantities; what follows from others is written by them."""
        given, card = self.problem.quantities, self.card
        C = [[self.symbol(f"c{i}{j}", self.text("rotation", 3 * i + j)) for j in range(3)] for i in range(3)]
        in_frame = "specific_force" in given and (card.attitude_error == "frame" or "specific_force_body" not in given)
        f = self.vector("f", "specific_force" if in_frame else "specific_force_body")
        body = self.vector("b", "specific_force_body") if in_frame and "specific_force_body" in given else None
        if in_frame:
            f = [C[0][k] * f[0] + C[1][k] * f[1] + C[2][k] * f[2] for k in range(3)]
        latitude = self.text("latitude") or HIDDEN + "latitude"
        sine, cosine = self.symbol("sin", f"sin({latitude})"), self.symbol("cos", f"cos({latitude})")
        h: Any = self.symbol("h", self.text("height")) if "height" in given else 0
        RN, RE, third = self.radii()
        circles = self.circle("longitude", "east", "ahead"), self.circle("earth_angle", "turned", "straight")
        angle = self.text("wander_angle") or HIDDEN + "wander_angle"  # of this card, or of one that it goes to
        wander = self.symbol("wander_sin", f"sin({angle})"), self.symbol("wander_cos", f"cos({angle})")
        spin = rotate_about_pole(circles[1] if card.frame == "inertial" else (0, 1))
        r = self.vector("r", "position")
        if self.problem.is_placed and card.frame != "local-level":
            u = locate(sine, cosine, circles[0], h, RN, RE)
            r = rotate(spin, u)
            self.derived = {self.texts[f"r{k}"]: r[k] for k in range(3)}
        squares = " + ".join(f"({self.texts[f'r{k}']})**2" for k in range(3))
        radius = self.symbol("radius", f"sqrt({squares})")
        if self.derived and RN is RE:
            radius = RN + h
        earth = self.earth_rate(sine, cosine, axes_rows(card, *wander))
        east, ahead = circles[0]
        normal = rotate(spin, [cosine * ahead * -1, cosine * east * -1, sine * -1])
        pull, gravity = self.gravitation(r, radius, normal)
        gravity = add_centrifugal(card, gravity, earth, r)
        mean = self.symbol("mean", f"sqrt(({self.texts['RN']})*({self.texts.get('RE', self.texts['RN'])}))")
        w, v, slope = self.vector("w", "angular_rate"), self.vector("v", "velocity"), self.text("radius_slope")
        if "velocity_body" in given and "velocity" not in given:
            v = rotate(constant(C), self.vector("u", "velocity_body"))
        motion = C, f, w, v, r, earth, sine, cosine, h, RN, RE, self.symbol("slope", slope)
        return World(
            *motion,
            *(gravity, pull, radius, gradient_names(RN, RE, h, third, mean)),
            self.vector("t", "transport_rate") if "transport_rate" in given else None,
            body,
            self.vector("l", "lever_arm") if "lever_arm" in given else (0, 0, 0),
            self.vector("m", "known_vector") if self.problem.measured else (0, 0, 0),
            tuple(self.problem.measured),
            {r: self.vector(f"c{r[0]}", f"{r}_correction") for r in CORRECTED} if self.problem.reset else {},
            *(*circles, wander),
        )

    def circle(self, quantity: str, sine: str, cosine: str) -> tuple[Any, Any]:
        """Sine and cosine of an angle; those of zero where it is not given."""
        text = self.text(quantity)
        return (0, 1) if text is None else (self.symbol(sine, f"sin({text})"), self.symbol(cosine, f"cos({text})"))

    def radii(self) -> tuple[Ratio, Ratio, Ratio]:
        """Meridian, prime vertical, and the radius of gravity."""
        count = len(self.problem.quantities.get("radii", ()))
        RN = self.symbol("RN", self.text("radii", 0))
        if count < 2:
            RE = RN if self.card.earth != "ellipsoid" else self.symbol("RE", None)
            return RN, RE, RN
        RE = self.symbol("RE", self.text("radii", 1))
        return RN, RE, self.symbol("third", self.text("radii", 2)) if count == 3 else RE

    def gravitation(self, r: list[Ratio], radius: Ratio, normal: list[Ratio]) -> tuple[Ratio, list[Ratio]]:
        """mu/|r|^3, and gravity in the frame or along down."""
        size = len(self.problem.quantities.get("gravity", ()))
        central = self.card.gravity_gradient == "central"
        if self.card.frame == "local-level":  # of three components the last one is vertical
            down = self.symbol("gravity", self.text("gravity", size - 1))
            return self.symbol("pull", None), [down * AXES[self.card.axes][2][2] if size == 3 else down]
        mu = self.text("gravitational_parameter")
        pull = self.symbol("pull", mu) / (radius * radius * radius if mu else 1)
        if central and (size == 3 or mu):
            return pull, [pull * x * -1 for x in r]
        if size == 3:
            return pull, self.vector("g", "gravity")
        scalar = self.symbol("gravity", self.text("gravity"))
        if self.card.gravity_gradient == "normal":
            return pull, [scalar * x for x in normal]
        pull = scalar / radius if size == 1 and not mu else pull
        return pull, [scalar * x / radius * -1 for x in r]

    def earth_rate(self, sine: Ratio, cosine: Ratio, rows: list[list[Any]]) -> list[Ratio]:
        """The Earth's rate in the frame, or (north, down)."""
        size = len(self.problem.quantities.get("earth_rate", ()))
        if size == 3:
            components = self.vector("e", "earth_rate")
            if self.card.frame != "local-level":
                return components
            terms = [[times(rows[k][j], components[k]) for k in range(3)] for j in (0, 2)]
            return [sum(x for x in parts if type(x) is not int) for parts in terms]
        rate = self.symbol("rate", self.text("earth_rate"))
        if self.card.frame == "local-level":
            return [rate * cosine, rate * sine * -1]
        zero = rate * 0
        return [zero, zero, rate]

    # From texts to quotients, and back

    def read(self, text: str) -> Any:
        """A formula of the user as a quotient, or None where it has other parts than the quantities.

        The quotients obey the relations of the quantities, so that equal ones are equal formulas.
        """
        one = self.context.constant(1)
        places = {t: GENERATORS.index(name) for name, t in self.texts.items()}
        known = {read_tree(t, None): Entry(Quotient(self.context.gen(k), one)) for t, k in places.items()}
        known |= {read_tree(t, None): value for t, value in self.derived.items()}

        def step(part: Tree, inner: list[Any]) -> Any:
            if part.head == NUMBER:
                return Entry(Quotient(self.context.constant(to_fmpq(part.args[0])), one))
            if part in known:
                return known[part]
            if part.head == "tan":
                sine, cosine = (known.get(build(name, part.args)) for name in ("sin", "cos"))
                return sine / cosine if sine and cosine else None
            if part.head == POWER and part.args[1].head == NUMBER and inner[0] is not None:
                number = part.args[1].args[0]
                power = prod([inner[0]] * abs(int(number)), start=inner[0].lift(1))
                return None if number.denominator != 1 else 1 / power if number < 0 else power
            if None in inner or part.head not in (SUM, PRODUCT):
                return None
            return sum(inner[1:], inner[0]) if part.head == SUM else prod(inner[1:], start=inner[0])

        return fold_tree(read_tree(text, None), step)

    def agree(self, left: str, right: str) -> bool:
        """True where formulas are equal by exact algebra modulo the relations of the quantities."""
        pair = self.read(left), self.read(right)
        return None not in pair and self.write(pair[0] - pair[1]) == "0"

    def write(self, value: Any, sign: Fraction = Fraction(1)) -> str:
        """A coefficient in the user's names."""
        if type(value) is int:
            return str(sign * value)
        top, bottom = value.quotient
        terms = reduce_terms(top)
        above = self.write_terms({e: c * sign for e, c in terms.items()})
        if above == "0" or bottom == 1:
            return above
        below = self.write_terms({tuple(map(int, e)): Fraction(str(c)) for e, c in bottom.to_dict().items()})
        return f"{protect(above)}/{protect(below)}"

    def write_terms(self, terms: Mapping[tuple[int, ...], Fraction]) -> str:
        """A polynomial as text."""
        zero = [k for k, name in enumerate(GENERATORS) if self.texts.get(name) == "0"]  # a rule of rotations has them
        terms = {powers: factor for powers, factor in terms.items() if factor and not any(powers[k] for k in zero)}
        parts = [self.write_term(powers, factor) for powers, factor in sorted(terms.items(), reverse=True)]
        return " + ".join(parts).replace("+ -", "- ") or "0"

    def write_term(self, powers: Sequence[int], factor: Fraction) -> str:
        """One term of it."""
        names = [(protect(self.texts[GENERATORS[k]]), n) for k, n in enumerate(powers) if n]
        product = "*".join(name if n == 1 else f"{name}**{n}" for name, n in names)
        if not product:
            return str(factor)
        return {1: product, -1: f"-{product}"}.get(factor) or f"{factor}*{product}"  # type: ignore[call-overload]


def protect(text: str) -> str:
    """A text as a factor: in parentheses unless it is a name or a call."""
    simple = text.replace("_", "").isalnum() or (text[:4] in ("sin(", "cos(") and text.find(")") == len(text) - 1)
    return text if simple else f"({text})"


Terms = dict[tuple[int, ...], Fraction]
WHOLE = fmpz_mpoly_ctx.get((*GENERATORS, "unit"), Ordering.degrevlex)
UNIT = (*(0 for _ in GENERATORS), 1)


@cache
def list_rules() -> Any:
    """A Groebner basis of the relations of a rotation, C C' = E, C' C = E, cofactors = C, and of sines and cosines."""
    C = [[WHOLE.gen(3 * i + j) for j in range(3)] for i in range(3)]
    pairs = [(i, j, rows) for rows in (C, [*zip(*C, strict=True)]) for i in range(3) for j in range(i, 3)]
    relations = [sum(x * y for x, y in zip(rows[i], rows[j], strict=True)) - int(i == j) for i, j, rows in pairs]
    relations += [
        C[i - 2][j - 2] * C[i - 1][j - 1] - C[i - 2][j - 1] * C[i - 1][j - 2] - C[i][j]
        for i, j in product(range(3), repeat=2)
    ]
    relations += [WHOLE.gen(sine) ** 2 + WHOLE.gen(cosine) ** 2 - 1 for sine, cosine in CIRCLES]
    generators: Any = fmpz_mpoly_vec(relations, WHOLE)
    return generators.buchberger_naive().autoreduction(groebner=True)


def reduce_terms(poly: Any) -> Terms:
    """The normal form of a polynomial modulo the relations; a unit beside it tells by what the reduction scales."""
    terms = poly.to_dict()
    common = lcm(*(int(x.q) for x in terms.values()))
    whole = {(*map(int, powers), 0): int(x * common) for powers, x in terms.items()}
    rest: Any = WHOLE.from_dict({**whole, UNIT: common})
    reduced = {tuple(map(int, e)): int(x) for e, x in rest.reduction_primitive_part(list_rules()).to_dict().items()}
    scale = reduced.pop(UNIT)
    return {powers[:-1]: Fraction(x, scale) for powers, x in reduced.items()}
