"""The generator against models of the project that were derived by other routes: Schuler's channel, the 1979 paper."""

from __future__ import annotations

from pathlib import Path

import pytest
import sympy as sp

import navsym as nav
from navsym.language.tomlfile import read_toml
from navsym_papers.joint_correction import kinematics

EXAMPLES = Path(__file__).parents[2] / "examples"
#: A level frame on a sphere that does not turn; positions in metres, the height known.
WORDS = (
    "frame=local-level axes=ENU attitude_error=frame rotation_sign=+ vector_error=difference earth=sphere angle=phi "
    "earth_rate=dropped transport_rate=kept gravity_gradient=none height_variation=dropped position_error=metres"
)
R, w, o1, o2, d1, d2 = sp.symbols("R w o1 o2 d1 d2")


def derive(parameters, azimuth="north", **quantities):
    """F of the card along a motion, as a matrix, and the names of its states."""
    signs = {**dict.fromkeys(("error", "bias_sign"), "estimate - truth"), "azimuth": azimuth}
    roles = {"position": "r", "velocity": "v", "attitude": "a", "gyro_bias": "e", "accelerometer_bias": "b"}
    turned = [[str(int(i == j)) for j in range(3)] for i in range(3)]
    model = nav.conventions(
        {
            "card": dict(word.split("=") for word in WORDS.split()) | signs,
            "parameters": dict.fromkeys("w R".split(), "positive") | dict.fromkeys(parameters.split(), "real"),
            "roles": {role: [f"{letter}{k}" for k in (1, 2, 3)] for role, letter in roles.items()},
            "quantities": {"radii": ["R"], "rotation": turned, **quantities},
        }
    ).model()
    plain = {name: sp.Symbol(name) for name in ("R", "w", *parameters.split())}
    return sp.Matrix([[sp.sympify(e, locals=plain) for e in row] for row in model["F"]]), model["states"]


@pytest.mark.long
def test_both_horizontal_channels_at_rest_are_the_schuler_channel_of_the_examples():
    """y1 = velocity/(R w), y2 = tilt, y3 = tilt rate/w in the time w t, w**2 = g/R, without accelerometer errors."""
    F, states = derive("", velocity=["0"] * 3, latitude="0", specific_force=["0", "0", "w**2*R"])
    schuler = sp.Matrix(read_toml(EXAMPLES / "schuler-velocity.toml")["model"]["F"])
    v, a, F = states.index("v1"), states.index("a1"), F[:12, :12]
    for velocity, tilt, sign in ((v, a + 1, -1), (v + 1, a, 1)):
        T = sp.zeros(3, F.shape[0])
        T[0, velocity], T[1, tilt], T[2, :] = sign / (R * w), 1, F[tilt, :] / w
        assert (T * F - w * schuler * T).applyfunc(sp.cancel) == sp.zeros(*T.shape)
        assert (T * F + w * schuler * T).applyfunc(sp.cancel) != sp.zeros(*T.shape)


@pytest.mark.long
def test_axes_that_wander_over_a_sphere_at_rest_give_the_error_equations_of_1979():
    """alpha = -a, beta = alpha - gamma, gamma = (-r2, r1)/R, dp = alpha' - nu, along every motion at a known height.

    The axes have the rate (o1, o2, 0), so that v = R (o2, -o1, 0) and f = R (o2', -o1', w**2 - o1**2 - o2**2).
    """
    motion = {"velocity": ["R*o2", "-R*o1", "0"], "specific_force": ["R*d2", "-R*d1", "R*(w**2 - o1**2 - o2**2)"]}
    F, states = derive("o1 o2 d1 d2 L z", "wander", latitude="L", wander_angle="z", **motion)
    rows = {
        **{f"alpha_{k}": {f"a{k}": -1} for k in (1, 2)},
        "dp_1": {"v2": -1 / R, "a3": o2},
        "dp_2": {"v1": 1 / R, "a3": -o1},
        "beta_1": {"a1": -1, "r2": 1 / R},
        "beta_2": {"a2": -1, "r1": -1 / R},
        "beta_3": {"a3": -1},
        **{f"nu_x{k}": {f"e{k}": 1} for k in (1, 2, 3)},
        "epsilon_1": {"b1": -1 / (R * w**2)},
        "epsilon_2": {"b2": -1 / (R * w**2)},
    }
    T = {name: sp.Matrix([[row.get(state, 0) for state in states]]) for name, row in rows.items()}
    names = {"omega_0": w, "omega_x1": o1, "omega_x2": o2, "domega_x1": d1, "domega_x2": d2, "R": R}
    known = [k for k, state in enumerate(states) if state not in ("r3", "v3")]  # the height is known
    compared = 0
    for symbol, rate in kinematics.error_equations().rates.items():
        if symbol.name not in T:
            continue  # the rate of the Earth in the axes
        rate = rate.subs({s: names[s.name] for s in rate.free_symbols if s.name in names})
        expected = sum((rate.coeff(s) * T[s.name] for s in rate.free_symbols if s.name in T), sp.zeros(1, len(states)))
        row = T[symbol.name]
        found = row * F + row.diff(o1) * d1 + row.diff(o2) * d2
        assert all(sp.cancel(found[k] - expected[k]) == 0 for k in known), symbol
        compared += 1
    assert compared == 7
