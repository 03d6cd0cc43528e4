"""Dead reckoning and what the errors of its sensors do to the position: equations (1)-(3).

Course and log: the speed along (``vy``) and across (``vx``, to starboard) the ship's axis is turned by the
heading K and integrated into latitude and longitude on a sphere of radius R at height h.
"""

from dataclasses import dataclass

import sympy as sp

latitude, longitude = sp.symbols("phi lambda", real=True)
vy, vx, heading, height = sp.symbols("v_y v_x K h", real=True)
radius = sp.Symbol("R", positive=True)

d_latitude, d_longitude = sp.symbols("dphi dlambda", real=True)
d_vy, d_vx, d_heading, d_height = sp.symbols("dv_y dv_x dK dh", real=True)


@dataclass(frozen=True, slots=True)
class ErrorModel:
    """Equations ``d/dt error = S(reckoned, readings, error, sensor_error)`` of a system.

    It works without errors when its sensors do.

    reckoned, readings   : what the system shows and what its sensors say
    errors, sensor_errors: reckoned minus true, reading minus true
    rates                : the ideal algorithm, d/dt of the reckoned values
    """

    reckoned: tuple[sp.Symbol, ...]
    readings: tuple[sp.Symbol, ...]
    errors: tuple[sp.Symbol, ...]
    sensor_errors: tuple[sp.Symbol, ...]
    rates: tuple[sp.Expr, ...]

    def right_side(self) -> sp.Matrix:
        """S: the ideal algorithm at the shown values minus the same at the true ones."""
        truth = {
            shown: shown - error
            for shown, error in zip((*self.reckoned, *self.readings), (*self.errors, *self.sensor_errors), strict=True)
        }
        return sp.Matrix([rate - rate.subs(truth, simultaneous=True) for rate in self.rates])

    def linear_parts(self) -> tuple[sp.Matrix, sp.Matrix]:
        """S1 = dS/d error and S2 = dS/d sensor_error at zero errors: multistructure:3."""
        S = self.right_side()
        zero = dict.fromkeys((*self.errors, *self.sensor_errors), 0)
        return (S.jacobian(sp.Matrix(self.errors)).subs(zero), S.jacobian(sp.Matrix(self.sensor_errors)).subs(zero))


def dead_reckoning() -> ErrorModel:
    """Reckoning by log, compass and depth or height: two coordinates, four sensors."""
    north = vy * sp.cos(heading) - vx * sp.sin(heading)
    east = vy * sp.sin(heading) + vx * sp.cos(heading)
    return ErrorModel(
        reckoned=(latitude, longitude),
        readings=(vy, vx, heading, height),
        errors=(d_latitude, d_longitude),
        sensor_errors=(d_vy, d_vx, d_heading, d_height),
        rates=(north / (radius + height), east / ((radius + height) * sp.cos(latitude))),
    )
