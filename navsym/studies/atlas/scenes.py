"""Error models of the atlas: the generator of error dynamics along a manoeuvre that is written as symbols with rates.

No row is typed. The nonlinear mechanisation of a card is linearised along the manoeuvre (``conventions``); a
measurement is predicted from an estimate with an infinitesimal error, and the coefficient of the error is the row.
Extra states are errors of what a measurement uses beside the motion: a lever arm, a camera's pose and delay,
landmarks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from navsym.conventions.card import DROPPED, KEPT, Card
from navsym.conventions.mechanisation import ROLES, Mechanisation, State, World, unit_error
from navsym.conventions.nilpotent import NOTHING, Array, Nilpotent, constant, identity, skew
from navsym.core.errors import DomainError
from navsym.language.names import quote
from navsym.models.linear import LinearModel

g, V, w, u1, u2, q, k = sp.symbols("g V w u1 u2 q k", real=True)
v1, v2, v3, a1, a2 = sp.symbols("v1 v2 v3 a1 a2", real=True)
heading, roll = sp.symbols("heading roll", real=True)
#: Rate of the Earth north and down, magnetic field, lever arm of the antenna or of the camera.
EARTH = sp.symbols("uN uD", real=True)
FIELD = sp.symbols("m1 m2 m3", real=True)
ARM = sp.symbols("l1 l2 l3", real=True)


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """A motion over a flat Earth.

    velocity : north, east, down
    heading, roll : attitude is a turn by the heading about down, then by the roll about the forward axis
    rates    : symbol -> its derivative
    """

    name: str
    velocity: tuple[sp.Expr | int, ...] = (0, 0, 0)
    heading: sp.Expr | int = 0
    roll: sp.Expr | int = 0
    rates: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)


FORWARD = (V * sp.cos(heading), V * sp.sin(heading), 0)
MANOEUVRES = (
    Manoeuvre("rest"),
    Manoeuvre("straight", (v1, v2, 0)),
    Manoeuvre("accelerated", (v1, v2, 0), rates={v1: a1, v2: a2}),
    Manoeuvre("climb", (v1, v2, v3)),
    Manoeuvre("level turn", FORWARD, heading, rates={heading: w}),
    Manoeuvre("figure eight", FORWARD, heading, rates={heading: w, w: q, q: -k * w}),
    Manoeuvre("rotation about the vertical", heading=heading, rates={heading: w}),
    Manoeuvre("rotation about a level axis", roll=roll, rates={roll: w}),
    Manoeuvre("rotation about two axes", heading=heading, roll=roll, rates={heading: u1, roll: u2}),
    Manoeuvre("figure eight with changing bank", FORWARD, heading, roll, {heading: w, w: q, q: -k * w, roll: u2}),
)

INS = Card("local-level", "NED", earth_rate=KEPT, transport_rate=DROPPED, angle="phi", position_error="metres")
VIO = Card(
    "local-level",
    "NED",
    attitude_error="body",
    vector_error="body",
    earth_rate=DROPPED,
    transport_rate=DROPPED,
    angle="phi",
    position_error="metres",
)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The mechanisation of a card along a manoeuvre.

    C             : attitude as a matrix, the identity where errors are resolved in the body
    turn, velocity, acceleration : of the body beside the Earth, in the body
    gravity       : in the body
    points        : places of beacons from the body in the frame, or of landmarks from the camera in its axes
    rates         : symbol -> derivative
    """

    flow: Mechanisation
    C: sp.Matrix
    turn: sp.Matrix
    velocity: sp.Matrix
    acceleration: sp.Matrix
    gravity: sp.Matrix
    points: tuple[sp.Matrix, ...]
    rates: Mapping[sp.Symbol, sp.Expr]
    field: sp.Matrix

    @property
    def in_body(self) -> bool:
        """True where errors are resolved in the body."""
        return self.flow.card.vector_error == "body"


def tidy(value: sp.Matrix) -> sp.Matrix:
    """Entries as polynomials in sines and cosines, with sin**2 = 1 - cos**2 used."""
    known = {sp.sin(angle) ** 2: 1 - sp.cos(angle) ** 2 for angle in (heading, roll)}
    return value.applyfunc(lambda x: sp.expand(sp.expand(x).subs(known)))


def derivative(value: sp.Matrix, rates: Mapping[sp.Symbol, sp.Expr]) -> sp.Matrix:
    """Rate of a matrix of symbols."""
    return value.applyfunc(lambda x: sp.Add(*(sp.diff(x, s) * rate for s, rate in rates.items())))


def make_scene(card: Card, manoeuvre: Manoeuvre, points: int = 0, arm: Sequence[sp.Symbol] = ()) -> Scene:
    """A manoeuvre in the words of a card.

    points : number of places that are seen
    arm    : lever arm of what sees them; none for the body's origin
    """
    rates = dict(manoeuvre.rates)
    C = sp.rot_ccw_axis3(manoeuvre.heading) * sp.rot_ccw_axis1(manoeuvre.roll)
    velocity = sp.Matrix(manoeuvre.velocity)
    spin = C.T * derivative(C, rates)
    turn = tidy(sp.Matrix([spin[2, 1], spin[0, 2], spin[1, 0]]))
    earth = sp.Matrix([EARTH[0], 0, EARTH[1]]) if card.earth_rate == KEPT else sp.zeros(3, 1)
    acceleration = tidy(C.T * derivative(velocity, rates))
    gravity = tidy(C.T * sp.Matrix([0, 0, g]))
    force = tidy(acceleration - gravity + C.T * (2 * earth).cross(velocity))
    moved = tidy(C.T * velocity)
    in_body = card.vector_error == "body"
    magnetic = sp.Matrix(FIELD)
    lever = sp.Matrix(arm) if arm else sp.zeros(3, 1)
    seen = tuple(sp.Matrix(sp.symbols(f"c{i}1 c{i}2 c{i}3", real=True)) for i in range(1, points + 1))
    for place in seen:
        rates.update(zip(place, -turn.cross(place + lever) - moved if in_body else -velocity, strict=True))
    if in_body:
        rates.update(zip(magnetic, -turn.cross(magnetic), strict=True))
    one, frame = sp.Integer(1), sp.eye(3) if in_body else C
    world = World(
        C=frame.tolist(),
        f=list(force),
        w=list(tidy(turn + C.T * earth)),
        v=list(moved if in_body else velocity),
        r=[0] * 3,
        earth_rate=[earth[0], earth[2]],
        sin=sp.Integer(0),
        cos=one,
        h=0,
        RN=one,
        RE=one,
        slope=0,
        gravity=[g],
        pull=0,
        radius=one,
        gradient_radii={},
    )
    return Scene(Mechanisation(card, world), frame, turn, moved, acceleration, gravity, seen, rates, magnetic)


# Measurements: what an estimate with an error predicts


#: Errors of the extra states by block.
Errors = Mapping[str, Array]
#: Roles whose states a cell has: no scale factors.
STATES = ROLES[:5]

Prediction = Callable[[Scene, State, Errors], Array]


def shifted(vector: sp.Matrix, error: Array) -> Array:
    """A known vector with an error."""
    return constant(list(vector)) + error


def predict_position(scene: Scene, x: State, errors: Errors) -> Array:
    """Position of the body's origin."""
    return x.position


def predict_antenna(scene: Scene, x: State, errors: Errors) -> Array:
    """Position of the end of the lever arm."""
    return x.position + x.attitude @ shifted(sp.Matrix(ARM), errors["arm"])


def predict_velocity(scene: Scene, x: State, errors: Errors) -> Array:
    """Velocity in the frame; at rest a zero-velocity update."""
    return x.velocity


def from_body(scene: Scene, vector: Array) -> Array:
    """What the body sees, turned by the true attitude: three measurements are mixed in a known way."""
    return constant(scene.C.tolist()) @ vector


def predict_body_velocity(scene: Scene, x: State, errors: Errors) -> Array:
    """Velocity in the body: odometer, Doppler log, wheels that do not slip."""
    return from_body(scene, x.attitude.T @ x.velocity)


def predict_field(scene: Scene, x: State, errors: Errors) -> Array:
    """A vector that is known in the frame, as the body sees it."""
    return from_body(scene, x.attitude.T @ constant(list(scene.field)))


def see(scene: Scene, x: State, point: sp.Matrix, errors: Errors, landmark: str) -> Array:
    """A place as the body or its camera sees it."""
    arm = sp.Matrix(ARM) if scene.in_body else sp.zeros(3, 1)
    place = shifted(point + arm, errors[landmark])
    body = x.attitude.T @ (place - x.position)
    camera = body - shifted(arm, errors["camera arm"])
    return from_body(scene, (identity() + skew(errors["camera angle"])).T @ camera)


def predict_range(scene: Scene, x: State, errors: Errors) -> Array:
    """Half the squared distance to a known beacon."""
    seen = see(scene, x, scene.points[0], errors, "landmark 1")
    return constant([seen @ seen * Nilpotent(sp.Rational(1, 2))])


def predict_bearings(scene: Scene, x: State, errors: Errors) -> Array:
    """Directions of all places in the axes of the body or of its camera, where their third component is not zero.

    The delay of the camera moves each place by its rate.
    """
    found: list[Nilpotent] = []
    for number, point in enumerate(scene.points, start=1):
        delay = errors["delay"][0]
        rate = derivative(point, scene.rates)
        seen = see(scene, x, point, errors, f"landmark {number}") + constant(list(rate)) * delay
        depth = Nilpotent(point[2])
        found += [seen[j] * depth - seen[2] * Nilpotent(point[j]) for j in (0, 1)]
    return constant(found)


@dataclass(frozen=True, slots=True)
class Aiding:
    """What is measured beside the inertial sensors.

    predictions : of the measurements, one after the other
    extras      : blocks of states beside position, velocity, attitude and biases
    points      : number of beacons or landmarks
    arm         : True where what sees the points has a lever arm
    """

    name: str
    predictions: tuple[Prediction, ...]
    extras: tuple[str, ...] = ()
    points: int = 0
    arm: bool = False


CAMERA = ("camera angle", "camera arm", "delay")
INS_AIDINGS = (
    Aiding("position", (predict_position,)),
    Aiding("position, known lever arm", (predict_antenna,)),
    Aiding("position, unknown lever arm", (predict_antenna,), ("arm",)),
    Aiding("velocity", (predict_velocity,)),
    Aiding("body velocity", (predict_body_velocity,)),
    Aiding("range to a beacon", (predict_range,), points=1),
    Aiding("bearing to a beacon", (predict_bearings,), points=1),
    Aiding("magnetic field", (predict_field,)),
)
VIO_AIDINGS = (
    Aiding("a landmark", (predict_bearings,), (*CAMERA, "landmark 1"), 1, True),
    Aiding("three landmarks", (predict_bearings,), (*CAMERA, "landmark 1", "landmark 2", "landmark 3"), 3, True),
    Aiding("a known landmark", (predict_bearings,), CAMERA, 1, True),
    Aiding("three known landmarks", (predict_bearings,), CAMERA, 3, True),
    Aiding("a landmark and position", (predict_bearings, predict_position), (*CAMERA, "landmark 1"), 1, True),
    Aiding("a landmark and magnetic field", (predict_bearings, predict_field), (*CAMERA, "landmark 1"), 1, True),
    Aiding("a landmark and velocity", (predict_bearings, predict_velocity), (*CAMERA, "landmark 1"), 1, True),
)
MODELS: Mapping[str, tuple[Card, tuple[Aiding, ...]]] = {"INS": (INS, INS_AIDINGS), "VIO": (VIO, VIO_AIDINGS)}


def size_of(block: str) -> int:
    """Number of states of a block."""
    return 1 if block == "delay" else 3


def list_columns(aiding: Aiding) -> list[tuple[str, int]]:
    """Block and component of every state."""
    blocks = [(role, j) for role in STATES for j in range(3)]
    return blocks + [(block, j) for block in aiding.extras for j in range(size_of(block))]


def error_model(scene: Scene, aiding: Aiding) -> LinearModel:
    """F and H of the errors along a manoeuvre, with the rates of all that moves."""
    columns = list_columns(aiding)
    blocks = {
        block: constant([NOTHING] * size_of(block)) for block in (*CAMERA, "arm", *(f"landmark {i}" for i in (1, 2, 3)))
    }
    truth = scene.flow.truth()
    later = truth.advance(scene.flow.rate(truth)).attitude.T
    F, H = sp.zeros(len(columns), len(columns)), []
    for place, (block, j) in enumerate(columns):
        unit = constant([Nilpotent(0, 1 if i == j else 0) for i in range(size_of(block))])
        estimate, errors = truth, {**blocks, block: unit}
        if block in STATES:
            estimate = scene.flow.estimate(truth, unit_error(block, j))
            moved = scene.flow.column(block, j)
        else:  # a landmark stands still, and the axes in which its error is resolved turn
            turned = block.startswith("landmark") and scene.in_body
            moved = {block: [part.mixed for part in later @ unit]} if turned else {}
        for row, (other, i) in enumerate(columns):
            F[row, place] = moved[other][i] if other in moved else 0
        H.append([part.error for predict in aiding.predictions for part in predict(scene, estimate, errors)])
    names = [f"z{i + 1}" for i in range(len(H[0]))]
    H = tidy(sp.Matrix(H).T)
    states = tuple(f"{block.replace(' ', '_')}_{j + 1}" for block, j in columns)
    return LinearModel(tidy(F), None, H, states, tuple(names), rates=scene.rates)


def cell_names() -> Iterator[str]:
    """Names of all cells: "INS: level turn: position"."""
    for model, (_, aidings) in MODELS.items():
        for manoeuvre in MANOEUVRES:
            for aiding in aidings:
                yield f"{model}: {manoeuvre.name}: {aiding.name}"


def parts_of(name: str) -> tuple[Scene, Aiding]:
    """The scene and the aiding of a cell. Raises DomainError for a name that is no cell."""
    if name not in cell_names():
        raise DomainError(f"expected a cell such as INS: rest: position; got {quote(name)}; see docs/atlas.md")
    model, manoeuvre, aiding = name.split(": ")
    card, aidings = MODELS[model]
    chosen = next(a for a in aidings if a.name == aiding)
    flown = next(m for m in MANOEUVRES if m.name == manoeuvre)
    return make_scene(card, flown, chosen.points, ARM if chosen.arm else ()), chosen


def model_of(name: str) -> LinearModel:
    """The error model of a cell: F, H and the rates of all that moves."""
    return error_model(*parts_of(name))
