"""From one frame to another: states and quantities of a motion are carried over, through the frame of the Earth.

A local level is turned by latitude and longitude, the inertial frame by the angle of the Earth, and its velocities
contain W x r. Turning a local level about its own axes needs neither.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from navsym.conventions.card import DROPPED, KEPT, NORTH, WANDER, Card
from navsym.conventions.mechanisation import AXES, Mechanisation, State, plus_height, rotate_about_pole
from navsym.conventions.nilpotent import VALUES, ZERO, Array, Nilpotent, constant, cross, identity, rotate, skew, times
from navsym.core.errors import DomainError

LEVEL = "local-level"
OTHERS = "others; correct [quantities]"


@dataclass(frozen=True, slots=True, eq=False)
class Passage:
    """The way from the frame and the axes of one mechanisation to those of another, of the same motion."""

    source: Mechanisation
    target: Mechanisation

    @property
    def stays(self) -> bool:
        """True where only the names of the axes of a local level change, or nothing."""
        wander = [card.azimuth == WANDER for card in (self.source.card, self.target.card)]
        return self.source.card.frame == self.target.card.frame and wander[0] == wander[1]

    def turn(self) -> Array:
        """Rotation from the axes of the source to those of the card."""
        target, source = (constant(AXES[card.axes]) for card in (self.target.card, self.source.card))
        return target @ source.T

    def spin(self) -> Any:
        """The rate of the Earth; 0 where both cards drop it."""
        if KEPT not in (self.source.card.earth_rate, self.target.card.earth_rate):
            return 0
        world = self.source.world
        if self.source.card.frame != LEVEL:
            return world.earth_rate[2]
        north, down = world.earth_rate
        return north * world.cos - down * world.sin

    def carry(self, estimate: State, x: State) -> tuple[State, State]:
        """Estimate and truth in the frame of the card; both may move with tau."""
        if self.stays:
            A = self.turn()
            return turn_state(A, estimate, self.source.is_geodetic), turn_state(A, x, self.source.is_geodetic)
        return self.from_earth(*self.to_earth(estimate, x))

    def to_earth(self, estimate: State, x: State) -> tuple[State, State]:
        """Estimate and truth in the frame of the Earth, with positions in metres."""
        flow = self.source
        if flow.card.frame == "earth":
            return estimate, x
        if flow.card.frame == "inertial":
            R = rotate_about_pole(flow.world.angle, self.spin()).T
            return self.slow_down(R, estimate), self.slow_down(R, x)
        R, moved = flow.level(x), estimate.position - x.position
        tilted = R @ (identity() + skew(flow.turn(x) @ flow.tilt(x, estimate)))
        truth, w = turn_state(R, x, True), flow.world
        centre = locate(w.sin, w.cos, w.meridian, w.h, w.RN, w.RE)
        r = constant([Nilpotent(at, 0, v.value) for at, v in zip(centre, truth.velocity, strict=True)])
        there = r + R @ flow.to_metres(x, moved)
        return replace(turn_state(tilted, estimate, True), position=there), replace(truth, position=r)

    def slow_down(self, R: Array, x: State) -> State:
        """A state of the inertial frame beside the Earth."""
        turned = turn_state(R, x)
        return replace(turned, velocity=turned.velocity - cross(self.pole(), turned.position))

    def pole(self) -> Array:
        """The rate of the Earth in its own frame."""
        return constant([0, 0, self.spin()])

    def from_earth(self, estimate: State, x: State) -> tuple[State, State]:
        """Estimate and truth in the frame of the card."""
        if self.target.card.frame == "earth":
            return estimate, x
        if self.target.card.frame == "inertial":
            R = rotate_about_pole(self.source.world.angle, self.spin())
            faster = (replace(s, velocity=s.velocity + cross(self.pole(), s.position)) for s in (estimate, x))
            return tuple(turn_state(R, s) for s in faster)  # type: ignore[return-value]
        flow, at = self.target, replace(x, position=ZERO)
        now = constant(VALUES(flow.level(at).T @ x.velocity))
        rate = flow.position_rate(replace(at, velocity=now))
        azimuth = Nilpotent(0, 0, flow.least_turn(at, rate).value)
        at = replace(at, position=constant([Nilpotent(0, 0, part.value) for part in rate]), azimuth=azimuth)
        R = flow.level(at).T
        moved = flow.from_metres(at, R @ (estimate.position - x.position))
        place: dict[str, Any] = {"position": at.position + moved, "azimuth": at.azimuth + flow.least_turn(at, moved)}
        tilt = flow.turn(at) @ flow.tilt(at, replace(at, **place))
        tilted = (identity() - skew(tilt)) @ R
        return replace(turn_state(tilted, estimate, True), **place), turn_state(R, at, True)


def carry_motion(source: Mechanisation, card: Card) -> Mechanisation:
    """The mechanisation of a card in the motion of another one."""
    way, world = Passage(source, Mechanisation(card, source.world)), source.world
    moves = not way.stays
    if not moves and card.axes == source.card.axes:
        return way.target
    out = axes_of(way.target).T if moves else identity()
    A = out @ axes_of(source) if moves else way.turn()
    same: dict[str, Any] = {"C": VALUES(A @ source.truth().attitude), "seen": rotate(A, world.seen)}
    if not moves:
        transport = None if world.transport is None else rotate(A, world.transport)
        same |= {"v": rotate(A, world.v), "r": rotate(A, world.r), "transport": transport}
        return Mechanisation(card, replace(world, **same))
    _, truth = way.to_earth(source.truth(), source.truth())
    at, velocity = (constant(VALUES(vector)) for vector in (truth.position, truth.velocity))
    gravity, W = axes_of(source) @ source.gravity(source.truth()), way.spin()
    whirl = cross(way.pole(), cross(way.pole(), at))
    if source.card.frame == "inertial":
        gravity = gravity - whirl
    if card.frame == "inertial":
        gravity, velocity = gravity + whirl, velocity + cross(way.pole(), at)
    gravity, rate = out @ gravity, [0, 0, W]
    if card.frame == LEVEL:
        gravity = (way.target.turn(source.truth()).T @ gravity)[2:]
        rate = [times(W, world.cos), times(-1, times(W, world.sin))]
    same |= {"v": VALUES(out @ velocity), "r": VALUES(out @ at), "gravity": VALUES(gravity)}
    return Mechanisation(card, replace(world, **same, earth_rate=rate, transport=None))


def axes_of(flow: Mechanisation) -> Array:
    """Rotation from the frame of a card to that of the Earth, now."""
    if flow.card.frame == LEVEL:
        return flow.level(replace(flow.truth(), position=ZERO))
    return rotate_about_pole(flow.world.angle).T if flow.card.frame == "inertial" else identity()


def locate(sine: Any, cosine: Any, meridian: Sequence[Any], h: Any, RN: Any, RE: Any) -> list[Any]:
    """The position from the centre of the Earth in its frame, by latitude, longitude, height and both radii."""
    share = 1
    if RN is not RE:  # 1 - e^2, which follows from both radii
        share = RN * cosine * cosine / (RE - RN * sine * sine)
    across = plus_height(RE, h) * cosine
    return [across * meridian[1], across * meridian[0], plus_height(RE * share, h) * sine]


def turn_state(A: Array, x: State, stays: bool = False) -> State:
    """A state in other axes; latitude, longitude and height stay as they are."""
    position = x.position if stays else A @ x.position
    return replace(x, attitude=A @ x.attitude, velocity=A @ x.velocity, position=position)


# The card in another frame


def restore_terms(card: Card, frame: str, radii: int) -> Card:
    """The card with the terms that the same motion has in another frame; ``neglected`` names what is added or taken."""
    if card.frame == LEVEL:
        slope = card.radius_variation and (KEPT if card.position_error else DROPPED)
        return replace(card, transport_rate=KEPT, height_variation=KEPT, radius_variation=slope)
    if frame == LEVEL:
        card = replace(card, centrifugal=card.centrifugal and DROPPED)
        central = card.gravity_gradient == "central" and radii == 1
        if card.position_error and not central and card.gravity_gradient != "normal":
            own = card.gravity_radius or ("third radius" if radii == 3 else "RE")
            shape, name = ("sphere", "R") if radii == 1 else ("ellipsoid", own)
            radius = None if card.gravity_gradient == "none" else name
            return replace(card, earth=shape, gravity_gradient="normal", gravity_radius=radius)
    if (card.frame, frame) == ("earth", "inertial") and card.centrifugal == DROPPED:
        return replace(card, centrifugal=KEPT)
    return card


def change_frame(card: Card, words: Mapping[str, str], radii: int, height: bool, turning: bool, alone: bool) -> Card:
    """The card of the same motion in another frame; raises DomainError where no card has its gravity.

    words   : frame, and axes, azimuth and angle of a local level
    radii   : how many radii of the Earth the model has; height : True where it has the height
    turning : True where the model has the rate of the Earth
    alone   : True for velocities without positions, whose errors would drive them in another frame
    """
    frame = words["frame"]
    moves = frame != card.frame and LEVEL in (frame, card.frame)
    refuse(moves and radii > 1 and not height, "height beside two radii: those that contain it tell no centre", OTHERS)
    place = "position among the roles: its errors drive those of velocity in another frame"
    refuse(alone, place, "none; add its states")
    refuse(card.frame == LEVEL and card.earth == "none", "a curved Earth: a flat one has no centre to go to")
    hub = replace(card, frame="earth", axes=None, azimuth=None, angle=None, transport_rate=None, height_variation=None)
    hub = replace(hub, radius_variation=None, position_error=card.position_error and "metres", arm_rate=None)
    if card.frame == LEVEL:
        normal = "normal" if card.position_error else "none"
        hub = replace(hub, gravity_gradient=normal, centrifugal=DROPPED)
    elif card.frame == "inertial":
        hub = replace(hub, earth_rate=KEPT if turning else DROPPED, centrifugal=KEPT)
    if hub.earth_rate == DROPPED or hub.position_error is None:
        hub = replace(hub, centrifugal=None)
    if "inertial" in (frame, card.frame) and hub.centrifugal:
        apart = hub.centrifugal == KEPT and hub.gravity_gradient in ("central", "none")
        refuse(not apart, "a centrifugal term beside gravitation: without one the gradient of gravity has no equal")
    if frame == "earth":
        return hub
    if frame == "inertial":
        return replace(hub, frame=frame, earth_rate=None, centrifugal=None)
    refuse(not radii, "quantities with radii", OTHERS)
    refuse(hub.centrifugal == KEPT, "gravity with its centrifugal part in one: along the normal there is no other")
    shape, lifted = "sphere" if radii == 1 else "ellipsoid", "R + h" if height else "R"
    vertical = lifted if hub.gravity_gradient == "central" else card.gravity_radius
    slope = None if shape == "sphere" else KEPT if hub.position_error else DROPPED
    same = {"axes": card.axes or "NED", "azimuth": NORTH, "angle": card.angle or "phi"}
    said = {name: words.get(name, word) for name, word in same.items()}
    gravity = {"gravity_gradient": "vertical" if vertical else "none", "gravity_radius": vertical, "centrifugal": None}
    kept: dict[str, Any] = {"transport_rate": KEPT, "height_variation": KEPT, "radius_variation": slope, **said}
    return replace(hub, frame=frame, earth=shape, **gravity, **kept)  # type: ignore[arg-type]


def refuse(wrong: bool, expected: str, got: str = "another card; convert it first, or its axes only") -> None:
    """Refuse a card that has no equal in the other frame."""
    if wrong:
        raise DomainError(f"expected {expected}; got {got}", where="convert: frame")
