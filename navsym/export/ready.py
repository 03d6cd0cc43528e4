"""Ready-made exports: names that stand for claims, regimes joined in the order of the parameter."""

from __future__ import annotations

_GV = "guaranteed_velocity"

#: Name -> arguments of ``navsym export``.
READY: dict[str, tuple[str, ...]] = {
    "velocity-correction": (
        f"velocity_correction_y1={_GV}:range.y1",
        f"velocity_correction_y2={_GV}:range.y2+{_GV}:range.y2.end*+{_GV}:range.y2.last",
        f"velocity_correction_y3={_GV}:range.y3+{_GV}:range.y3.end*+{_GV}:range.y3.last",
        f"estimate_y1={_GV}:4.14.y1",
        f"estimate_y2={_GV}:4.14.y2*",
        f"estimate_y3={_GV}:4.14.y3",
    ),
    "velocity-weights": tuple(f"{_GV}:4.12.Phi{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
    "earth": (
        "earth_tan_geocentric_latitude=trajectory:earth.tan_phi*",
        "earth_radius_squared=trajectory:earth.r",
        "earth_north=trajectory:earth.rotation.xi2",
        "earth_up=trajectory:earth.rotation.xi3",
        "earth_latitude_rate=trajectory:kinematics.phi_rate",
        "earth_longitude_rate=trajectory:kinematics.lambda_rate*",
    ),
}
