"""Measurement matrices, noise entry and reset Jacobians of a card, by the same exact linearisation as its F.

A measurement predicted by the estimate less that of the truth is linear in the error: H with every sign plus. Noise
adds to the output of a sensor as the error of its bias does, with the other sign. The reset takes a correction out of
the estimate by the definition of the error: the Jacobian of what is left, to first order in the correction, from the
product of two infinitesimals.

Sources: Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, chapter 14 (lever arms);
Sola, Quaternion kinematics for the error-state Kalman filter, section 6 (reset).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from navsym.conventions.card import DROPPED, SENSORS
from navsym.conventions.mechanisation import CONSTANTS, ROLES, Mechanisation, State, flat_card, unit_error
from navsym.conventions.nilpotent import ZERO, Array, Nilpotent, constant, cross, identity, skew, times

#: What a measurement shows -> the number of its rows.
MEASURED: Mapping[str, int] = {
    **dict.fromkeys("position velocity body_velocity zero_velocity attitude vector".split(), 3),
    "height": 1,
}
#: Noises: of the sensors' outputs, and the drives of their biases and scales.
NOISES = (*SENSORS, *CONSTANTS)
#: Roles that a reset may couple.
CORRECTED = ("attitude", "velocity", "position")
MEASURED_MARK, NOISE_MARK, RESET_MARK = "measured ", "noise ", "reset "


def measure(flow: Mechanisation, kind: str, estimate: State, x: State) -> Array:
    """The measurement that the estimate predicts less the true one; arms are small beside the radii of the Earth."""
    if kind == "position":
        return measure_position(flow, estimate, x)
    if kind == "height":
        moved = estimate.position - x.position
        return constant([moved[2] if flow.is_geodetic else -(flow.turn(x).T @ moved)[2]])
    if kind == "attitude":
        return flow.unskew(estimate.attitude @ x.attitude.T)
    shown = SHOWN[kind]
    return shown(flow, estimate) - shown(flow, x)


def measure_position(flow: Mechanisation, estimate: State, x: State) -> Array:
    """Position of the end of the lever arm, in the units of the card's position error."""
    moved = estimate.position - x.position
    arm = (estimate.attitude - x.attitude) @ constant(flow.world.arm)
    if flow.is_geodetic and flow.card.position_error == "metres":
        moved = flow.to_metres(x, moved)
    elif flow.is_geodetic:
        arm = flow.from_metres(x, arm)
    return moved + arm


def spin(flow: Mechanisation, x: State) -> Array:
    """Velocity of the end of the lever arm beside its origin and the Earth, in the body."""
    at = flow.truth() if flow.card.arm_rate == "value" else x
    turning = at.attitude.T @ flow.earth_rate(at) if flow.card.arm_rate != DROPPED else ZERO
    return cross(flow.sensed(x, "gyro") - turning, constant(flow.world.arm))


#: Velocities of the end of the lever arm: in the frame, and in the body (odometer, Doppler log, wheels that do not
#: slip); and a vector that is known in the frame, as the body sees it: magnetic field, gravity, a star.
SHOWN: Mapping[str, Callable[[Mechanisation, State], Array]] = {
    "velocity": lambda flow, x: x.velocity + x.attitude @ spin(flow, x),
    "body_velocity": lambda flow, x: x.attitude.T @ x.velocity + spin(flow, x),
    "zero_velocity": lambda flow, x: x.velocity,
    "vector": lambda flow, x: x.attitude.T @ constant(flow.world.seen),
}


def measured_column(flow: Mechanisation, role: str, component: int, kinds: tuple[str, ...]) -> dict[str, list[Any]]:
    """A column of H with every sign plus: measurement -> coefficients."""
    truth = flow.truth()
    estimate = flow.estimate(truth, unit_error(role, component))
    return {MEASURED_MARK + kind: [part.error for part in measure(flow, kind, estimate, truth)] for kind in kinds}


def noise_column(flow: Mechanisation, noise: str, component: int) -> dict[str, list[Any]]:
    """A column of G: the error of a bias with the other sign, or the drive of a constant."""
    if noise in CONSTANTS:
        return {name: [int(name == noise and k == component) for k in range(3)] for name in ROLES}
    column = flow.column(f"{noise}_bias", component)
    return {name: [times(-1, x) for x in parts] for name, parts in column.items()}


def reset_column(flow: Mechanisation, role: str, component: int) -> dict[str, list[Any]]:
    """A column of the reset Jacobian less the unit matrix, with every sign plus: linear in the correction.

    The estimate has the error eps e_j plus the correction tau c, which is taken out by the definition of the error.
    What is left changes with eps by 1, and with eps tau by what is returned. The Earth has no part in it; the
    difference of latitude, longitude and height is neither turned nor resolved in the body.
    """
    on_earth, flow = flow.is_geodetic, Mechanisation(flat_card(flow.card), flow.world)
    truth, error, given = flow.truth(), unit_error(role, component), flow.world.corrections
    correction = {name: constant([Nilpotent(0, 0, x) for x in given[name]]) for name in given}
    both = {name: error[name] + correction[name] for name in given}
    C, in_frame = truth.attitude, flow.card.attitude_error == "frame"
    turn = skew(both["attitude"])
    small = identity() + turn + turn @ turn * flow.half()
    back = identity() - skew(correction["attitude"])
    before = small @ C if in_frame else C @ small
    after = back @ before if in_frame else before @ back
    velocity, position = (
        take_out(flow, name, flow.shift(name, vector, both[name], C, before), correction[name], before, after)
        for name, vector in (("velocity", truth.velocity), ("position", truth.position))
    )
    left = flow.compare(State(after, velocity, position, truth.constants), truth)
    left["position"] = ZERO if on_earth else left["position"]
    return {RESET_MARK + name: [part.mixed for part in left[name]] for name in ROLES}


def take_out(flow: Mechanisation, role: str, estimate: Array, correction: Array, before: Array, after: Array) -> Array:
    """An estimated vector without its correction: the inverse of the definition of its error."""
    S, R = flow.sides(role, after, before)
    return S.T @ (estimate - R @ correction)


def full_column(flow: Mechanisation, role: str, component: int) -> dict[str, list[Any]]:
    """A column of F with what stands below it in H and in the reset; or a column of G."""
    if role.startswith(NOISE_MARK):
        return noise_column(flow, role.removeprefix(NOISE_MARK), component)
    column = flow.column(role, component)
    if flow.world.measured:
        column |= measured_column(flow, role, component, flow.world.measured)
    return column | reset_column(flow, role, component) if flow.world.corrections else column
