"""The nonlinear mechanisation in a frame, and the error dynamics of a card by exact linearisation along its flow.

The truth obeys C' = C [w x] - [W x] C, v' = C f + g - (2 w_ie + w_en) x v, and position follows velocity. The estimate
obeys the same equations with the sensors' output less the estimated biases. For an estimate that is the truth with an
error eps e_j, the rate of the error is linear in eps: its coefficient is column j of F.

Sources of the equations: Andreev, Theory of Inertial Navigation; Groves, Principles of GNSS, Inertial, and Multisensor
Integrated Navigation Systems, chapter 5. The errors of a card are definitions; no error equation is typed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from navsym.conventions.card import DROPPED, KEPT, SENSORS, WANDER, Card
from navsym.conventions.nilpotent import (
    ADVANCE,
    NOTHING,
    ONE,
    VALUES,
    ZERO,
    Array,
    Nilpotent,
    constant,
    cross,
    identity,
    rotate,
    skew,
    times,
)

#: Columns: north, east, down in the axes; the third axis is vertical.
AXES: Mapping[str | None, tuple[tuple[int, int, int], ...]] = {
    None: ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "NED": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "ENU": ((0, 1, 0), (1, 0, 0), (0, 0, -1)),
    "NWU": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
}

#: Constants of the sensors, which show (1 + scale) truth + bias.
CONSTANTS = tuple(f"{sensor}_{kind}" for kind in ("bias", "scale") for sensor in SENSORS)
ROLES = ("position", "velocity", "attitude", *CONSTANTS)


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """The quantities of a motion as coefficients: balls, or quotients of polynomials.

    C                : rotation from body to frame, rows
    f, w             : specific force and rate of the body beside inertial space, in the body
    v, r             : velocity in the frame, position from the Earth's centre in the frame
    earth_rate       : in the frame (earth), or (north, down) of a local level
    sin, cos         : of the latitude
    h, RN, RE, slope : height, radii of the meridian and across, dRN/dL
    gravity          : in the frame, or along the down axis of a local level
    pull             : mu/|r|^3
    gradient_radii   : words of a card -> R of its gradient
    transport        : the transport rate in the frame where it has names of its own; body_force : f where f is C' times
                       the force in the frame and has names of its own
    arm, seen        : lever arm in the body, known vector in the frame
    measured         : what the rows of H show; corrections : role -> correction of the reset, if there is one
    meridian, angle  : sine and cosine of the longitude, and of the angle of the Earth beside inertial space
    """

    C: Sequence[Sequence[Any]]
    f: Sequence[Any]
    w: Sequence[Any]
    v: Sequence[Any]
    r: Sequence[Any]
    earth_rate: Sequence[Any]
    sin: Any
    cos: Any
    h: Any
    RN: Any
    RE: Any
    slope: Any
    gravity: Sequence[Any]
    pull: Any
    radius: Any
    gradient_radii: Mapping[str, Any]
    transport: Sequence[Any] | None = None
    body_force: Sequence[Any] | None = None
    arm: Sequence[Any] = (0, 0, 0)
    seen: Sequence[Any] = (0, 0, 0)
    measured: tuple[str, ...] = ()
    corrections: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    meridian: tuple[Any, Any] = (0, 1)
    angle: tuple[Any, Any] = (0, 1)
    wander: tuple[Any, Any] = (0, 1)


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Attitude, velocity, constants of the sensors, position; on the Earth its small change in latitude and so on.

    azimuth : small change of the wander angle, from north to east
    """

    attitude: Array
    velocity: Array
    position: Array
    constants: Mapping[str, Array]
    azimuth: Nilpotent = NOTHING

    def advance(self, rate: State) -> State:
        """The state after the infinitesimal time tau."""
        attitude, velocity = ADVANCE(self.attitude, rate.attitude), ADVANCE(self.velocity, rate.velocity)
        position, azimuth = ADVANCE(self.position, rate.position), self.azimuth.advance(rate.azimuth)
        return State(attitude, velocity, position, self.constants, azimuth)


@dataclass(frozen=True, slots=True, eq=False)
class Mechanisation:
    """The equations of motion and the definition of errors of one card in one world."""

    card: Card
    world: World

    @property
    def is_geodetic(self) -> bool:
        """True where the position is latitude, longitude and height."""
        return self.card.frame == "local-level" and self.card.earth != "none"

    def turn(self, x: State) -> Array:
        """Rotation from north, east, down to the axes."""
        sine, cosine = constant(self.world.wander)
        return constant(axes_rows(self.card, sine + cosine * x.azimuth, cosine - sine * x.azimuth))

    def truth(self) -> State:
        """The true state; its biases and scales are taken from the sensors' output and are zero."""
        position = ZERO if self.is_geodetic else constant(self.world.r)
        return State(constant(self.world.C), constant(self.world.v), position, dict.fromkeys(CONSTANTS, ZERO))

    def sensed(self, x: State, sensor: str) -> Array:
        """What a sensor shows less its bias and its scale by the state x."""
        shown = self.world.w if sensor == "gyro" else self.world.f
        scaled = shown if sensor == "gyro" or self.world.body_force is None else self.world.body_force
        bias, scale = x.constants[f"{sensor}_bias"], x.constants[f"{sensor}_scale"]
        return constant(shown) - bias - scale * constant(scaled)

    # The flow

    def rate(self, x: State) -> State:
        """dx/dt of the mechanisation that is fed with the sensors' output less the biases and scales of x."""
        w, force = self.sensed(x, "gyro"), x.attitude @ self.sensed(x, "accelerometer")
        earth, transport = self.earth_rate(x), self.transport_rate(x)
        attitude = x.attitude @ skew(w) - skew(earth + transport) @ x.attitude
        coriolis = cross(earth + earth + transport, x.velocity)
        velocity = force + self.gravity(x) - coriolis
        position = self.position_rate(x)
        return State(attitude, velocity, position, x.constants, self.least_turn(x, position))

    def trigonometry(self, x: State) -> tuple[Nilpotent, Nilpotent]:
        """Sine and cosine of the latitude."""
        sine, cosine, change = Nilpotent(self.world.sin), Nilpotent(self.world.cos), x.position[0]
        return sine + cosine * change, cosine - sine * change

    def radii(self, x: State, keeping: tuple[str, ...] = (KEPT, "position")) -> tuple[Nilpotent, Nilpotent]:
        """RN + h and RE + h at the state; they change with the latitude where the card says one of ``keeping``."""
        world, card = self.world, self.card
        north, east = (Nilpotent(plus_height(radius, world.h)) for radius in (world.RN, world.RE))
        if card.height_variation == KEPT:
            north, east = north + x.position[2], east + x.position[2]
        if card.radius_variation in keeping:
            # (RE + h) cos L is the distance from the axis, and its derivative is -(RN + h) sin L.
            across = Nilpotent((world.RE - world.RN) * world.sin / world.cos)
            north, east = north + Nilpotent(world.slope) * x.position[0], east + across * x.position[0]
        return north, east

    def earth_rate(self, x: State) -> Array:
        """Rate of the Earth in the frame."""
        if self.card.earth_rate != KEPT:
            return ZERO
        if self.card.frame == "earth":
            return constant(self.world.earth_rate)
        north, down = constant(self.world.earth_rate)
        change = x.position[0] if self.is_geodetic else NOTHING
        return self.turn(x) @ [north + down * change, NOTHING, down - north * change]

    def transport_rate(self, x: State) -> Array:
        """Rate of a local level beside the Earth, in its axes."""
        if self.card.transport_rate != KEPT:
            return ZERO
        turn = self.turn(x)
        north, east, _ = turn.T @ x.velocity
        sine, cosine = self.trigonometry(x)
        meridian, across = self.radii(x, (KEPT,))
        down = NOTHING if self.card.azimuth == WANDER else -east * sine / (across * cosine)
        rate = turn @ [east / across, -north / meridian, down]
        if self.world.transport is not None:
            pairs = zip(self.world.transport, rate, strict=True)
            rate = constant([Nilpotent(name, part.error, part.rate, part.mixed) for name, part in pairs])
        return rate

    def gravity(self, x: State) -> Array:
        """Gravity at the state, in the frame."""
        card, world = self.card, self.world
        if card.frame == "local-level":
            (down,) = constant(world.gravity)
            if card.gravity_gradient == "vertical":
                radius = Nilpotent(world.gradient_radii[str(card.gravity_radius)])
                down = down - Nilpotent(2) * down * x.position[2] / radius
            return self.turn(x) @ [NOTHING, NOTHING, down]
        moved = x.position - constant(world.r)
        value = constant(world.gravity) + self.pull_change(moved)
        if card.centrifugal == KEPT:
            earth = constant(world.earth_rate)
            value = value - cross(earth, cross(earth, moved))
        return value

    def pull_change(self, moved: Array) -> Array:
        """First-order change of gravitation with the position."""
        kind, world = self.card.gravity_gradient, self.world
        if kind in ("none", "normal"):
            return ZERO if kind == "none" else self.normal_change(moved)
        r = constant(world.r)
        along = r @ moved
        if kind == "central":
            return (r * (Nilpotent(3) * along / (r @ r)) - moved) * Nilpotent(world.pull)
        name = self.card.gravity_radius or "radial"
        distance, radius = Nilpotent(world.radius), Nilpotent(world.gradient_radii[name])
        return constant(world.gravity) * (Nilpotent(-2) * along / (distance * radius))

    def normal_change(self, moved: Array) -> Array:
        """The same for gravity along the normal of the Earth, by its curvature and its gradient along the normal."""
        world, level = self.world, self.normal_axes()
        north, east, sunk = level.T @ moved
        down = (level.T @ constant(world.gravity))[2]
        meridian, across = (Nilpotent(plus_height(radius, world.h)) for radius in (world.RN, world.RE))
        grown = NOTHING
        if self.card.gravity_radius:
            grown = Nilpotent(2) * down * sunk / Nilpotent(world.gradient_radii[self.card.gravity_radius])
        return level @ [-down * north / meridian, -down * east / across, grown]

    def normal_axes(self) -> Array:
        """Rotation from north, east, down to a frame of the Earth or of inertial space."""
        level = level_rows(*constant((self.world.sin, self.world.cos, *self.world.meridian)))
        return rotate_about_pole(self.world.angle) @ level if self.card.frame == "inertial" else level

    def position_rate(self, x: State) -> Array:
        """Rate of the position."""
        return self.from_metres(x, x.velocity) if self.is_geodetic else x.velocity

    # Errors: from a truth and an error to an estimate, and back

    def metres(self, x: State) -> Array:
        """Metres along north, east, down per unit of latitude, longitude and height."""
        meridian, across = self.radii(x)
        return constant([meridian, across * self.trigonometry(x)[1], Nilpotent(-1)])

    def to_metres(self, x: State, moved: Array) -> Array:
        """Metres along the axes of a small change of latitude, longitude and height."""
        return self.turn(x) @ (moved * self.metres(x))

    def from_metres(self, x: State, moved: Array) -> Array:
        """The small change of latitude, longitude and height of metres along the axes."""
        return self.turn(x).T @ moved / self.metres(x)

    def reference(self, x: State, estimate: State) -> Array:
        """Rotation from the true frame to that in which the errors are resolved.

        For psi it is the axes at the estimated position. Where axes wander they are told by the least turn for phi.
        """
        if not self.is_geodetic or (self.card.angle != "psi" and self.card.azimuth != WANDER):
            return identity()
        tilt = self.tilt(x, estimate)
        tilt = tilt if self.card.angle == "psi" else constant([NOTHING, NOTHING, tilt[2]])
        return identity() - skew(self.turn(x) @ tilt)

    def tilt(self, x: State, estimate: State) -> Array:
        """The small rotation, in north, east, down, from the axes at the truth to those at the estimate."""
        sine, cosine = self.trigonometry(x)
        latitude, longitude, _ = estimate.position - x.position
        return constant([longitude * cosine, -latitude, estimate.azimuth - x.azimuth - longitude * sine])

    def least_turn(self, x: State, moved: Array) -> Nilpotent:
        """The change of the wander angle with a change of the position, or its rate, by which the axes turn least.

        They do not turn beside the Earth about the vertical.
        """
        wanders = self.is_geodetic and self.card.azimuth == WANDER
        return moved[1] * self.trigonometry(x)[0] if wanders else NOTHING

    def level(self, x: State) -> Array:
        """Rotation from the axes of the local level at the state to the frame of the Earth."""
        sine, cosine = self.trigonometry(x)
        east, ahead = constant(self.world.meridian)
        east, ahead = east + ahead * x.position[1], ahead - east * x.position[1]
        return level_rows(sine, cosine, east, ahead) @ self.turn(x).T

    def estimate(self, x: State, error: Mapping[str, Array]) -> State:
        """The estimate that has this error; every sign is plus."""
        card = self.card
        moved = error["position"]
        if self.is_geodetic and card.position_error == "metres":
            moved = self.from_metres(x, moved)
        azimuth = x.azimuth + self.least_turn(x, moved)
        frame = self.reference(x, replace(x, position=x.position + moved, azimuth=azimuth))
        attitude = frame @ x.attitude
        small = identity() + skew(error["attitude"])
        velocity = frame @ x.velocity
        turned = small @ attitude if card.attitude_error == "frame" else attitude @ small
        return State(
            turned,
            self.shift("velocity", velocity, error["velocity"], attitude, turned),
            self.shift("position", x.position, moved, attitude, turned),
            {name: value + error[name] for name, value in x.constants.items()},
            azimuth,
        )

    def shift(self, role: str, vector: Array, error: Array, attitude: Array, turned: Array) -> Array:
        """The estimated vector S v + R e, by the true and the estimated attitude."""
        S, R = self.sides(role, attitude, turned)
        return S @ vector + R @ error

    def sides(self, role: str, attitude: Array, turned: Array) -> tuple[Array, Array]:
        """S, by which the truth is turned, and R, by which the error is brought to the frame."""
        turns, resolved = self.card.vector(role)
        S = turned @ attitude.T if turns else identity()
        return S, (turned if turns else attitude) if resolved else identity()

    def compare(self, estimate: State, x: State) -> dict[str, Array]:
        """The error of an estimate; every sign is plus."""
        card = self.card
        moved = estimate.position - x.position
        frame = self.reference(x, estimate)
        attitude, velocity = frame @ x.attitude, frame @ x.velocity
        C = estimate.attitude
        small = C @ attitude.T if card.attitude_error == "frame" else attitude.T @ C
        if not self.is_geodetic:
            moved = self.unshift("position", estimate.position, x.position, attitude, estimate.attitude)
        elif card.position_error == "metres":
            moved = self.to_metres(x, moved)
        return {
            "attitude": self.unskew(small),
            "velocity": self.unshift("velocity", estimate.velocity, velocity, attitude, estimate.attitude),
            "position": moved,
            **{name: value - x.constants[name] for name, value in estimate.constants.items()},
        }

    def unshift(self, role: str, estimate: Array, vector: Array, attitude: Array, turned: Array) -> Array:
        """The error of an estimated vector."""
        S, R = self.sides(role, attitude, turned)
        return R.T @ (estimate - S @ vector)

    def half(self) -> Nilpotent:
        """A half as a coefficient."""
        return Nilpotent(1 / (2 * (self.world.cos / self.world.cos)))

    def unskew(self, A: Array) -> Array:
        """p of the skew part [p x] of a matrix."""
        return constant([A[k - 1, k - 2] - A[k - 2, k - 1] for k in range(3)]) * self.half()

    # The linearisation

    def column(self, role: str, component: int) -> dict[str, list[Any]]:
        """A column of F with every sign plus: role of the row -> three coefficients.

        role, component : the state whose error is eps
        """
        flow, error = self, unit_error(role, component)
        plain = self.card.attitude_error == "frame" and not self.card.vector("velocity")[1]
        if plain and not role.endswith("_scale"):  # C stands beside C' alone; a scale belongs to an axis of the body
            flow, error = self.turn_body(), self.turn_errors(constant(self.world.C), error)
        truth = flow.truth()
        estimate = flow.estimate(truth, error)
        after = flow.compare(estimate.advance(flow.rate(estimate)), truth.advance(flow.rate(truth)))
        return {name: [part.mixed for part in vector] for name, vector in after.items()}

    def turn_body(self) -> Mechanisation:
        """The motion in axes of the body that are now those of the frame: any will do, and C stays out of products."""
        f, w = (rotate(constant(self.world.C), v) for v in (self.world.f, self.world.w))
        return Mechanisation(self.card, replace(self.world, C=VALUES(identity()), f=f, w=w))

    def turn_errors(self, A: Array, errors: Mapping[str, Array]) -> dict[str, Array]:
        """Errors in other axes of the body, where they are resolved in it."""
        roles = {"attitude"} if self.card.attitude_error == "body" else set()
        roles |= {"gyro_bias", "accelerometer_bias"}
        roles |= {name for name in ("velocity", "position") if self.card.vector(name)[1]}
        return {name: A @ v if name in roles else v for name, v in errors.items()}


def unit_error(role: str, component: int) -> dict[str, Array]:
    """An error eps in one state."""
    return {name: constant([Nilpotent(0, int(name == role and k == component)) for k in range(3)]) for name in ROLES}


def axes_rows(card: Card, sine: Any, cosine: Any) -> list[list[Any]]:
    """Rotation from north, east, down to the axes, by sine and cosine of the wander angle where the card has one."""
    turned = [[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]] if card.azimuth == WANDER else AXES[None]
    picked = [next((x, k) for k, x in enumerate(row) if x) for row in AXES[card.axes]]
    return [[x if side > 0 else -x for x in turned[k]] for side, k in picked]


def level_rows(sine: Nilpotent, cosine: Nilpotent, east: Nilpotent, ahead: Nilpotent) -> Array:
    """Rotation from north, east, down to the frame of the Earth, by sines and cosines of latitude and longitude."""
    rows = [[-sine * ahead, -east, -cosine * ahead], [-sine * east, ahead, -cosine * east], [cosine, NOTHING, -sine]]
    return constant(rows)


def rotate_about_pole(angle: Sequence[Any], rate: Any = 0) -> Array:
    """Rotation from the frame of the Earth to the inertial one, which moves on by ``rate``."""
    sine, cosine = angle
    s, c = Nilpotent(sine, 0, times(cosine, rate)), Nilpotent(cosine, 0, times(-1, times(sine, rate)))
    return constant([[c, -s, NOTHING], [s, c, NOTHING], [NOTHING, NOTHING, ONE]])


def add_centrifugal(card: Card, gravity: list[Any], earth: Sequence[Any], r: Sequence[Any]) -> list[Any]:
    """Gravity in a turning frame: gravitation of a central field less W x (W x r), where the card keeps this term."""
    if card.gravity_gradient != "central" or card.centrifugal != KEPT:
        return gravity
    whirl = cross(constant(earth), cross(constant(earth), constant(r)))
    return [x - part.value for x, part in zip(gravity, whirl, strict=True)]


def plus_height(radius: Any, height: Any) -> Any:
    """Radius plus height; 0 stands for a height that the model does not know."""
    return radius if type(height) is int else radius + height


def flat_card(card: Card) -> Card:
    """The same errors over a flat Earth that does not turn; its zeros are where a term may be dropped."""
    dropped = {name: getattr(card, name) and DROPPED for name in ("earth_rate", "transport_rate")}
    terms = dict.fromkeys(("gravity_radius", "centrifugal", "height_variation", "radius_variation"))
    metres = card.position_error and "metres"
    return replace(card, earth="none", gravity_gradient="none", position_error=metres, **dropped, **terms)  # type: ignore[arg-type]
