"""What is published on degenerate motions, as statements on cells of the atlas: tests hold every one of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from navsym.studies.atlas.kept import Cell

Cells = Mapping[str, Cell]


@dataclass(frozen=True, slots=True)
class Published:
    """A statement of a paper, its source, and the same on the cells."""

    text: str
    source: str
    holds: Callable[[Cells], bool]


def is_lost(cell: Cell, words: str) -> bool:
    """True when a direction of the unobservable basis begins with these words."""
    return any(direction.startswith(words) for direction in cell.unobservable)


def three(cells: Cells, manoeuvre: str) -> Cell:
    """A camera that sees three unknown landmarks."""
    return cells[f"VIO: {manoeuvre}: three landmarks"]


HESCH = "Hesch, Kottas, Bowman and Roumeliotis 2014; Kelly and Sukhatme 2011"
WU = "Wu, Guo, Georgiou and Roumeliotis 2017"
YANG = "Yang, Geneva, Eckenhoff and Huang 2019"
SHIFTS = [f"common shift along {axis}" for axis in "xyz"]
GENERAL = "figure eight with changing bank"
STILL = ("straight", "accelerated", "climb")

PUBLISHED = (
    Published(
        "In general motion a camera with inertial sensors leaves a turn about gravity and a common shift open, no more",
        HESCH,
        lambda cells: set(three(cells, GENERAL).unobservable) == {"turn about gravity through the body", *SHIFTS},
    ),
    Published(
        "A general motion that turns about more than one axis shows the pose of the camera on the body",
        "Kelly and Sukhatme 2011",
        lambda cells: not any("camera" in words for words in three(cells, GENERAL).unobservable),
    ),
    Published(
        "Constant acceleration in the body hides the scale, in a turn at constant speed as on a straight line",
        WU,
        lambda cells: all(is_lost(three(cells, name), "scale") for name in (*STILL, "level turn")),
    ),
    Published(
        "A turn whose rate changes shows the scale",
        WU,
        lambda cells: not is_lost(three(cells, "figure eight"), "scale"),
    ),
    Published(
        "Without rotation all three angles of the attitude are lost",
        WU,
        lambda cells: all(
            is_lost(three(cells, name), f"turn about {axis}") for name in STILL for axis in ("gravity", "x", "y")
        ),
    ),
    Published(
        "Without rotation the lever arm of the camera is lost",
        YANG,
        lambda cells: all(
            is_lost(three(cells, name), f"(camera arm {axis}, landmark 1 {axis}") for name in STILL for axis in "xyz"
        ),
    ),
    Published(
        "Rotation about one axis hides the lever arm of the camera along it",
        YANG,
        lambda cells: is_lost(three(cells, "figure eight"), "(camera arm z, landmark 1 z"),
    ),
    Published(
        "Constant velocity and rate in the body, or a constant acceleration without rotation, hide the time offset",
        YANG,
        lambda cells: all("delay" in " ".join(three(cells, name).unobservable) for name in (*STILL, "level turn")),
    ),
    Published(
        "At rest velocity leaves three directions of tilt, heading and biases open, beside the position",
        "Goshen-Meskin and Bar-Itzhack 1992",
        lambda cells: cells["INS: rest: velocity"].rank == 15 - 3 - 3,
    ),
    Published(
        "A turn about one axis leaves the lever arm of the antenna open along it; about two axes all of it is shown",
        "Hong, Lee, Chun, Kwon and Speyer 2005",
        lambda cells: (
            [
                cells[f"INS: {name}: position, unknown lever arm"].rank
                for name in ("level turn", "figure eight", GENERAL)
            ]
            == [17, 17, 18]
        ),
    ),
)
