"""Ready-made exports: names that stand for claims, regimes joined in the order of the parameter."""

from __future__ import annotations

from navsym.export.steps import Stage, Step

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

_AHEAD = ("m11", "m12", "m13", "", "m22", "m23", "", "", "m33")
_AFTER = ("n11", "n12", "n13", "", "n22", "n23", "", "", "n33")
_COVARIANCE = ("p11", "p12", "p13", "p22", "p23", "p33")

#: Name -> a stateful step.
STEPS: dict[str, Step] = {
    "trajectory-filter": Step(
        stages=(
            Stage("trajectory:algorithm.P_ahead", _AHEAD),
            Stage("trajectory:algorithm.K*", ("K1", "K2", "K3")),
            Stage("trajectory:algorithm.C", ("g1", "g2", "g3")),
            Stage("trajectory:algorithm.P", _AFTER),
        ),
        outputs={"estimate": ("g1", "g2", "g3"), "covariance": tuple(n for n in _AFTER if n)},
        state={"f1": "g1", "f2": "g2", "f3": "g3"}
        | {old: f"n{old[1:]}" for old in _COVARIANCE},
    ),
}
