"""Convention cards: what an error model may mean, as plain data, and their list."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

ESTIMATE, TRUTH = "estimate - truth", "truth - estimate"
KEPT, DROPPED = "kept", "dropped"
WHOLE, HALF = "angle", "half angle"
NORTH, WANDER = "north", "wander"
HAMILTON, FORWARD, BACKWARD = "Hamilton", "body to frame", "frame to body"
SENSORS = ("gyro", "accelerometer")
IN_BODY = "velocity in body"
MEASURED_LESS, PREDICTED_LESS = "measurement - prediction", "prediction - measurement"

RADII = tuple(n + h for n in ("R", "RN", "RE", "sqrt(RN*RE)", "third radius") for h in (" + h", ""))

#: Field -> its heading in tables, and the words that it may have; None where a field says nothing.
FIELDS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "frame": ("frame", ("inertial", "earth", "local-level")),
    "axes": ("axes", ("NED", "ENU", "NWU")),
    "azimuth": ("azimuth of the axes", (NORTH, WANDER)),
    "error": ("error of velocity and position", (ESTIMATE, TRUTH)),
    "attitude_error": ("attitude error in the", ("frame", "body")),
    "rotation_sign": ("sign of its rotation", ("+", "-")),
    "attitude_size": ("its size", (WHOLE, HALF)),
    "angle": ("angle", ("phi", "psi")),
    "bias_sign": ("error of the biases", (ESTIMATE, TRUTH)),
    "scale_sign": ("error of the scale factors", (ESTIMATE, TRUTH)),
    "vector_error": ("vector errors", ("difference", "rotated", "body", IN_BODY)),
    "position_error": ("position error", ("metres", "geodetic")),
    "innovation": ("innovation", (MEASURED_LESS, PREDICTED_LESS)),
    "arm_rate": ("Earth rate of lever arms", (KEPT, "value", DROPPED)),
    "quaternion_algebra": ("algebra of the quaternion", (HAMILTON, "JPL")),
    "quaternion_direction": ("which turns vectors from", (FORWARD, BACKWARD)),
    "quaternion_order": ("its order", ("scalar first", "scalar last")),
    "earth": ("Earth", ("none", "sphere", "ellipsoid")),
    "earth_rate": ("Earth rate", (KEPT, DROPPED)),
    "transport_rate": ("transport rate", (KEPT, DROPPED)),
    "gravity_gradient": ("gravity gradient", ("none", "central", "radial", "normal", "vertical")),
    "gravity_radius": ("its radius", RADII),
    "centrifugal": ("centrifugal term", (KEPT, DROPPED)),
    "height_variation": ("change of radii with height", (KEPT, DROPPED)),
    "radius_variation": ("change of radii with latitude", (KEPT, "position", DROPPED)),
}
HEADINGS: Mapping[str, str] = {name: heading for name, (heading, _) in FIELDS.items()}
CHOICES: Mapping[str, tuple[str, ...]] = {name: words for name, (_, words) in FIELDS.items()}


@dataclass(frozen=True, slots=True)
class Card:
    """One set of conventions of an error model.

    frame, axes      : where velocity is resolved; axes of a local level
    azimuth          : ``north``, or ``wander``: the axes are turned about down by the wander angle, from north to east,
                       and do not turn beside the Earth about the vertical
    error            : sign of velocity and position errors
    attitude_error   : ``frame``: C_est = (E +- [p x]) C; ``body``: C_est = C (E +- [p x]); C leads from body to frame
    angle            : ``phi``: beside the true local level; ``psi``: beside the local level at the estimated position
    rotation_sign    : the sign of [p x] above
    attitude_size    : ``angle``: p above is the state; ``half angle``: p is two times the state, which is the vector
                       part of the error quaternion, or Rodrigues' parameters
    bias_sign        : sign of the errors of both sensors' biases; a sensor shows (1 + scale) truth + bias
    scale_sign       : the same of their scale factors; None without them
    earth            : shape; ``none`` is flat, with constant gravity
    earth_rate, transport_rate, centrifugal, height_variation : terms that are kept or dropped
    radius_variation : dRN/dL and dRE/dL: kept, dropped, or kept in the equations of the position only
    gravity_gradient : ``central``: of -mu r/|r|^3; ``radial``: -2 g r'/(|r| R); ``vertical``: -2 g/R along down;
                       ``normal``: the same in another frame, where gravity also turns with the normal of the Earth
    gravity_radius   : R of the vertical gradient, in words; of the radial one where there are two radii
    position_error   : ``metres`` along the axes, or ``geodetic`` (latitude, longitude, height)
    vector_error     : ``difference``; ``rotated``: the truth is turned by the attitude error first (right invariant);
                       ``body``: the difference is resolved in the body (left invariant); ``velocity in body``: that
                       of the velocities by their components in the body, C_est' v_est - C' v, and of the positions
    innovation       : what H multiplies the error to; None without H
    arm_rate         : the Earth's rate in the turning of a lever arm: kept, its value without its change, or dropped
    quaternion_algebra, quaternion_direction, quaternion_order : i j = k (Hamilton) or i j = -k (JPL), what the
                       quaternion turns vectors to, and where its scalar stands; None without a quaternion
    dropped          : blocks of zeros where the full equations have small terms
    """

    frame: str
    axes: str | None = None
    azimuth: str | None = None
    error: str = ESTIMATE
    attitude_error: str | None = "frame"
    angle: str | None = None
    rotation_sign: str | None = "+"
    attitude_size: str | None = "angle"
    bias_sign: str | None = ESTIMATE
    scale_sign: str | None = None
    earth: str = "none"
    earth_rate: str | None = None
    transport_rate: str | None = None
    gravity_gradient: str = "none"
    gravity_radius: str | None = None
    centrifugal: str | None = None
    height_variation: str | None = None
    radius_variation: str | None = None
    position_error: str | None = None
    vector_error: str = "difference"
    innovation: str | None = None
    arm_rate: str | None = None
    quaternion_algebra: str | None = None
    quaternion_direction: str | None = None
    quaternion_order: str | None = None
    dropped: tuple[tuple[str, str], ...] = ()

    def document(self) -> dict[str, Any]:
        """The card as JSON data."""
        return {**asdict(self), "dropped": [list(block) for block in self.dropped]}

    def words(self) -> dict[str, str]:
        """What the card says, as the table [card] of a file."""
        return {name: word for name, word in asdict(self).items() if name in CHOICES and word is not None}

    def _repr_latex_(self) -> str:
        from navsym.conventions.typeset import card_latex

        return rf"$\displaystyle {card_latex(self)}$"

    def quaternion(self) -> dict[str, Any]:
        """What is said of the quaternion; of two readings that are one rotation the one in Hamilton's algebra.

        A quaternion of one algebra is the conjugate of that of the other, so it turns vectors the other way.
        """
        if self.quaternion_order is None:
            return {}
        same = (self.quaternion_algebra == HAMILTON) == (self.quaternion_direction == FORWARD)
        order = {"quaternion_order": self.quaternion_order}
        return {"quaternion_algebra": HAMILTON, "quaternion_direction": FORWARD if same else BACKWARD, **order}

    def vector(self, role: str) -> tuple[bool, bool]:
        """Whether the true vector is turned by the attitude error first, and whether the error is resolved in the body.

        Over a curved Earth a position is neither.
        """
        flat = self.frame != "local-level" or self.earth == "none"
        word = self.vector_error if role == "velocity" or (role == "position" and flat) else ""
        word = "" if (role, word) == ("position", IN_BODY) else word
        return word in ("rotated", IN_BODY), word in ("body", IN_BODY)

    def signs(self) -> dict[str, Fraction]:
        """Role -> +1 where the state is estimate minus truth (for an attitude: the sign of its rotation), else -1.

        Of a state that is half of the angle it is a half.
        """
        words = self.error, self.bias_sign, self.scale_sign
        error, bias, scale = (Fraction(-1 if w == TRUTH else 1) for w in words)
        attitude = Fraction(1 if self.rotation_sign == "+" else -1, 2 if self.attitude_size == HALF else 1)
        sensors = {f"{name}_{kind}": x for kind, x in (("bias", bias), ("scale", scale)) for name in SENSORS}
        return {"velocity": error, "position": error, "attitude": attitude, **sensors}


def list_structures(
    roles: frozenset[str],
    radii: int,
    frames: tuple[str, ...],
    height: bool = True,
    placed: bool = False,
    azimuth: str = NORTH,
    quaternion: bool = False,
    arm: bool = False,
) -> Iterator[Card]:
    """Every card without its signs, for a model of these roles.

    radii  : how many radii of the Earth are given: with one it is a sphere, with more an ellipsoid, with none either
    frames : the frames to list
    height : False where radii contain the height
    placed : True where latitude and longitude are given, so that gravity may follow the normal
    azimuth : of local levels
    quaternion : True where the attitude is given by one; arm : True where the velocity of a lever arm's end is measured
    """
    names = [name for name in CHOICES if name.startswith("quaternion")] if quaternion else []
    readings: list[dict[str, Any]] = [
        dict(zip(names, words, strict=True)) for words in product(*(CHOICES[name] for name in names))
    ]
    vectors = CHOICES["vector_error"] if {"attitude", "velocity"} <= roles else ("difference",)
    sides: Sequence[str | None] = CHOICES["attitude_error"] if "attitude" in roles else (None,)
    for frame in frames:
        level = frame == "local-level"
        cards = list(
            list_level(frame, azimuth, roles, radii, height)
            if level
            else list_cartesian(frame, roles, radii, height, placed)
        )
        for side, vector, card, words in product(sides, vectors, cards, readings):
            for rate in CHOICES["arm_rate"] if arm and card.earth_rate == KEPT else (None,):
                yield replace(card, attitude_error=side, vector_error=vector, arm_rate=rate, **words)


def list_cartesian(frame: str, roles: frozenset[str], radii: int, height: bool, placed: bool) -> Iterator[Card]:
    """Cards of the inertial frame and of the frame that turns with the Earth."""
    metres = "metres" if "position" in roles else None
    gradients: list[tuple[str, str, str | None]] = [("none", "none", None)]
    if metres:
        shape = "sphere" if radii == 1 else "ellipsoid"
        names = list_radii(shape, radii, height)
        gradients += [("central", "sphere", None)]
        gradients += [("radial", "ellipsoid", name) for name in (names[1:] if radii == 2 else (None,))]
        gradients += [("normal", shape, name) for name in names] if radii and placed else []
    rates: tuple[str | None, ...] = (KEPT, DROPPED) if frame == "earth" else (None,)
    for (gradient, shape, radius), rate in product(gradients, rates):
        centrifugal: tuple[str | None, ...] = (KEPT, DROPPED) if rate == KEPT and metres else (None,)
        for kept in centrifugal:
            still = Card(frame, earth=shape, earth_rate=rate, centrifugal=kept, position_error=metres)
            yield replace(still, gravity_gradient=gradient, gravity_radius=radius)


def list_level(frame: str, azimuth: str, roles: frozenset[str], radii: int, height: bool) -> Iterator[Card]:
    """Cards of a local level: over a flat Earth, a sphere, an ellipsoid."""
    metres = "metres" if "position" in roles else None
    shapes = {0: ("sphere", "ellipsoid"), 1: ("sphere",)}.get(radii, ("ellipsoid",))
    for axes, angle in product(CHOICES["axes"], CHOICES["angle"]):
        flat = Card(frame, axes, azimuth, angle=angle, position_error=metres, transport_rate=DROPPED)
        for rate in (KEPT, DROPPED):
            yield replace(flat, earth_rate=rate)
        for shape in shapes:
            yield from list_curved(replace(flat, earth=shape), radii, height)


def list_radii(shape: str, radii: int, height: bool) -> list[str | None]:
    """None, and what the radius of the gradient of gravity may be, in words."""
    names = ("third radius",) if radii == 3 else ("R",) if shape == "sphere" else ("sqrt(RN*RE)", "RN", "RE")
    return [None, *(name + end for name in names for end in ((" + h", "") if height else ("",)))]


def list_curved(flat: Card, radii: int, height: bool) -> Iterator[Card]:
    """The ways to keep and to drop terms over a curved Earth."""
    has_position = flat.position_error is not None
    gradients = [("vertical" if name else "none", name) for name in list_radii(flat.earth, radii, height)]
    slopes = CHOICES["radius_variation"] if has_position else (DROPPED,)
    ways: dict[str, Sequence[Any]] = {
        "earth_rate": (KEPT, DROPPED),
        "transport_rate": (KEPT, DROPPED),
        "gravity": gradients if has_position else gradients[:1],
        "height_variation": (KEPT, DROPPED) if has_position else (KEPT,),
        "radius_variation": slopes if flat.earth == "ellipsoid" else (None,),
        "position_error": CHOICES["position_error"] if has_position else (None,),
    }
    for words in product(*ways.values()):
        said: dict[str, Any] = dict(zip(ways, words, strict=True))
        gradient, by = said.pop("gravity")
        yield replace(flat, gravity_gradient=gradient, gravity_radius=by, **said)


# For people


def attitude_formula(card: Mapping[str, Any]) -> str:
    """The definition of the attitude error of a card as JSON data."""
    small = f"(E {card['rotation_sign']} {'2 ' * (card['attitude_size'] == HALF)}[p x])"
    return f"C_est = {small} C" if card["attitude_error"] == "frame" else f"C_est = C {small}"


def list_neighbours(data: Mapping[str, Any]) -> dict[tuple[str, str, str, str], list[int]]:
    """Of an answer as JSON data: heading, word, reason and point of an excluded neighbour -> numbers of its cards."""
    found: dict[tuple[str, str, str, str], list[int]] = {}  # neighbours of several cards may differ alike
    for item in data["excluded"]:
        name, point = item["field"], ", ".join(f"{k} = {v}" for k, v in item["point"].items())
        near = {k: v for k, v in item["card"].items() if k not in (name, "dropped")}.items()
        line = HEADINGS[name], str(item["card"][name] or "none"), item["why"], point
        found.setdefault(line, []).extend(k for k, card in enumerate(data["cards"], 1) if near <= card.items())
    return found
