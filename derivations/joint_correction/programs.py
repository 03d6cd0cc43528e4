"""The two-stage observer of joint correction: velocity stage (3.2), position stage (3.3), gains from two poles.

The rates are the claims of the paper; a step integrates them by the classical rule of Runge and Kutta with the
measurements held. For these linear rates the rule is Taylor's formula up to the fourth order, so that the step's
own error is below |A h|^5/120 times the state (h in the units of the paper's time). Where an information is missing,
its gains are set to zero: that is the paper's own rule for its situations.
"""

import sympy as sp

from navsym.claims import Equation
from navsym.export.chain import Chain, Link, Program, real
from navsym.export.parts import Layout

STATE = ("x1", "x2", "x3", "x4", "x5", "x6", "y1", "y2", "y5", "y6")
RATES = (*(f"3.2.x{k}" for k in range(1, 7)), "3.3.y1*", "3.3.y2", "3.3.y5*", "3.3.y6*")
GAINS = tuple(f"Kc{k}" for k in range(1, 7)), ("Kh1", "Kh2", "Kh5", "Kh6")
h = sp.Symbol("h", positive=True)
lam_c, lam_h = sp.symbols("lambda_c lambda_h", positive=True)


# -- gains ---------------------------------------


def gain_formulas() -> tuple[sp.Expr, ...]:
    """Gains that put all poles of a channel at -lambda, the two channels alike."""
    velocity = (1 - 3 * lam_c**2, 3 * lam_c - lam_c**3, lam_c**3)
    return (*velocity, *velocity, 2 * lam_h, lam_h**2, 2 * lam_h, lam_h**2)


def poles() -> Equation:
    """With these gains the errors of a channel have (p + lambda_c)^3 and (p + lambda_h)^2."""
    p = sp.Symbol("p", real=True)
    gains = gain_formulas()
    schuler = sp.Matrix([[0, 1, 0], [-1, 0, 0], [0, 0, 0]]) - sp.Matrix(gains[:3]) * sp.Matrix([[0, 1, 1]])
    slow = sp.Matrix([[0, 1], [0, 0]]) - sp.Matrix(gains[6:8]) * sp.Matrix([[1, 0]])
    return Equation(
        [(p + lam_c) ** 3, (p + lam_h) ** 2], [(p * sp.eye(3) - schuler).det(), (p * sp.eye(2) - slow).det()]
    )


# -- one step of Runge and Kutta ---------------------------------------


def rates(stage: int, at: str) -> tuple[Link, ...]:
    """The ten rates at the state named by ``at`` + its number."""
    names = {s: f"{at}{s}" for s in STATE}
    renamed = names | {"y2_true": names["y2"]}
    return tuple(
        Link((f"k{stage}_{s}",), f"joint_correction:{claim}", rename=renamed)
        for s, claim in zip(STATE, RATES, strict=True)
    )


def moved(stage: int, share: sp.Expr) -> Link:
    """The state moved along the rates of the stage before."""
    formulas = tuple(real(s) + share * real(f"k{stage - 1}_{s}") for s in STATE)
    return Link(tuple(f"b{stage}_{s}" for s in STATE), "", formulas)


def last() -> Link:
    """The state after the step, from the four rates: ``s + h/6 (k1 + 2 k2 + 2 k3 + k4)``."""
    formulas = tuple(
        real(s) + h / 6 * (real(f"k1_{s}") + 2 * real(f"k2_{s}") + 2 * real(f"k3_{s}") + real(f"k4_{s}")) for s in STATE
    )
    return Link(tuple(f"next_{s}" for s in STATE), "", formulas, fourth_order)


def fourth_order() -> Equation:
    """For s' = a s + b the rule gives Taylor's formula of the solution up to h^4, for every a, b and s."""
    a, b, s = sp.symbols("a b s", real=True)
    k1 = a * s + b
    k2 = a * (s + h / 2 * k1) + b
    k3 = a * (s + h / 2 * k2) + b
    k4 = a * (s + h * k3) + b
    taylor = s + sum(h**n / sp.factorial(n) * a ** (n - 1) * (a * s + b) for n in range(1, 5))
    return Equation(s + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), taylor)


WORDS = "x y x0 y0 Kc Kh sigma_c sigma_M mu u_3 omega_1 omega_2 h lambda_c lambda_h next_x next_y"
UNITS = dict.fromkeys(WORDS.split(), "1 (dimensionless as in section 2 of the paper)")
ARRAYS = {
    "x": STATE[:6],
    "y": STATE[6:],
    "Kc": GAINS[0],
    "Kh": GAINS[1],
    "sigma_c": ("sigma_c1", "sigma_c2"),
    "sigma_M": ("sigma_M1", "sigma_M2"),
}
NEXT = tuple(f"next_{s}" for s in STATE)
TESTS = {"mu": (0.01, 0.1), "u_3": (-1.0, 1.0), "omega_1": (-1.0, 1.0), "omega_2": (-1.0, 1.0), "h": (1e-4, 0.1)}
TESTS |= {s: (-10.0, 10.0) for s in (*STATE, "sigma_c1", "sigma_c2", "sigma_M1", "sigma_M2")}
TESTS |= {k: (-3.0, 3.0) for k in (*GAINS[0], *GAINS[1])} | {"lambda_c": (1e-3, 10.0), "lambda_h": (1e-3, 10.0)}

ORDER = ("x", "y", "Kc", "Kh", "mu", "u_3", "omega_1", "omega_2", "sigma_c", "sigma_M", "h")

OBSERVER = Program(
    init=Chain(
        title="Gains for the poles -lambda_c (velocity stage) and -lambda_h (position stage), and the first estimates",
        links=(
            Link(
                (*GAINS[0], *GAINS[1]),
                "",
                gain_formulas(),
                poles,
                cites=("joint_correction:3.2.gains", "joint_correction:3.coupled.position_plain"),
            ),
        ),
        outputs={"x": STATE[:6], "y": STATE[6:], "Kc": GAINS[0], "Kh": GAINS[1]},
        layout=Layout({"x0": STATE[:6], "y0": STATE[6:]}, ("lambda_c", "lambda_h", "x0", "y0"), TESTS, UNITS),
        box={"lambda_c": (sp.Integer(0), None), "lambda_h": (sp.Integer(0), None)},
    ),
    step=Chain(
        title="Both stages over one step h with the measurements held",
        links=(
            *rates(1, ""),
            moved(2, h / 2),
            *rates(2, "b2_"),
            moved(3, h / 2),
            *rates(3, "b3_"),
            moved(4, h),
            *rates(4, "b4_"),
            last(),
        ),
        outputs={"next_x": NEXT[:6], "next_y": NEXT[6:]},
        layout=Layout(ARRAYS, ORDER, TESTS, UNITS),
        box={"h": (sp.Integer(0), sp.Integer(1))},
    ),
    fields={"x": "next_x", "y": "next_y", "Kc": "", "Kh": ""},
)


PROGRAMS: dict[str, Chain | Program] = {"two-stage-observer": OBSERVER}
