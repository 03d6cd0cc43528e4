"""Section 1, the Remark and (1.13): any rows that complete L_x, and what the weight K°_z costs."""

import sympy as sp

from navsym.claims import PROVED, Equation, claim, fact
from navsym_papers.joint_correction.matrices import exact_inverse
from navsym_papers.joint_correction.section1_systems import flat
from navsym_papers.joint_correction.section1_two_stage import PAIRS, blocks, say_free


def general(m: int, rest: int) -> dict[str, sp.Matrix]:
    """The split system seen through z° = S x + T z with general S and lower triangular T."""
    b = blocks(m, rest)
    S = sp.Matrix(rest, m, lambda r, s: sp.Symbol(f"s{r}{s}", real=True))
    T = sp.Matrix(
        rest,
        rest,
        lambda r, s: sp.Symbol(f"t{r}", positive=True) if r == s else sp.Symbol(f"t{r}{s}", real=True) if s < r else 0,
    )
    L = sp.Matrix(sp.BlockMatrix([[sp.eye(m), sp.zeros(m, rest)], [S, T]]))
    back = sp.Matrix(exact_inverse("L", sp.ImmutableMatrix(L)))
    G = sp.Matrix(sp.BlockMatrix([[b["Gx"], sp.zeros(m, rest)], [b["Gz1"], b["Gz2"]]]))
    turned = (L * G * back).applyfunc(sp.together)
    row = sp.Matrix.hstack(sp.zeros(1, m), b["gz"]) * back
    return {
        **b,
        "S": S,
        "T": T,
        "Gz1": turned[m:, :m],
        "Gz2": turned[m:, m:],
        "g1": row[:, :m],
        "g2": row[:, m:],
        "upper": turned[:m, :],
    }


@claim("1.13.error")
def general_error():
    """In (1.13) the error of x enters that of z through G°_z1 - K°_z g_z1^T, z itself through G°_z2 - K°_z g_z2^T."""
    for m, rest in PAIRS[:4]:
        b = general(m, rest)
        e, f, x, z = (
            sp.Matrix(sp.symbols(f"{name}1:{size + 1}", real=True))
            for name, size in (("e", m), ("f", rest), ("x", m), ("z", rest))
        )
        innovation = (b["g1"] * x + b["g2"] * z - b["g1"] * (x - e) - b["g2"] * (z - f))[0]
        yield (
            (b["Gz1"] - b["Kz"] * b["g1"]) * e + (b["Gz2"] - b["Kz"] * b["g2"]) * f,
            b["Gz1"] * x + b["Gz2"] * z - b["Gz1"] * (x - e) - b["Gz2"] * (z - f) - b["Kz"] * innovation,
        )


@claim("1.13.free_of_gain")
def special_choice_has_no_weight():
    """For the rows b of (1.7), S = 0, the weight K°_z is gone from the influence of x: g_z1 = 0."""
    for m, rest in PAIRS[:4]:
        b = general(m, rest)
        yield [sp.Integer(0)] * m, b["g1"].subs({symbol: 0 for symbol in b["S"]})


@claim("1.13.equivalent")
def general_variant_in_the_old_coordinates():
    """(1.13) is (1.11) plus the injection -T^-1 S K_x of the first innovation, when K°_z = T K_z."""
    for m, rest in PAIRS[:4]:
        b, raw = general(m, rest), blocks(m, rest)
        T_inverse = sp.Matrix(exact_inverse("T", sp.ImmutableMatrix(b["T"])))
        coupling = b["Gz1"] - b["T"] * raw["Kz"] * b["g1"]
        itself = b["Gz2"] - b["T"] * raw["Kz"] * b["g2"]
        first = raw["Gx"] - raw["Kx"] * raw["gx"]
        # the error of S x + T z in the coordinates e (of x) and f (of z): S e + T f
        yield (
            flat(raw["Gz1"] + T_inverse * b["S"] * raw["Kx"] * raw["gx"], raw["Gz2"] - raw["Kz"] * raw["gz"]),
            flat(T_inverse * (coupling + itself * b["S"] - b["S"] * first), T_inverse * itself * b["T"]),
        )


@claim("1.13.preferable")
def preference_of_the_variants():
    """One example: the variance of z - z° is 1 + S (S + 1)/2, larger by (1.13) for S > 0 and smaller for -1 < S < 0.

    dx/dt = q, dz/dt = x, unit noises and gains; (1.11) is S = 0. The reason that the paper gives is 1.13.error.
    But (1.13) injects the first innovation into z (1.13.equivalent), which an optimal filter does too.
    """
    S = sp.Symbol("S", real=True)
    return Equation(1 + S * (S + 1) / 2, steady_variance(S))


@claim("1.13.weight")
def weight_grows_with_the_gain():
    """The weight of the error of x in (1.13) grows with K°_z where g_z1 is not zero; in (1.11) no gain enters it.

    Derivative of the coupling by the gains: -g_z1 of (1.13), which is minus the first row of T^-1 S, against 0.
    """
    for m, rest in PAIRS[:4]:
        b, raw = general(m, rest), blocks(m, rest)
        for gain in raw["Kz"]:
            coupling = (b["Gz1"] - b["Kz"] * b["g1"]).diff(gain)
            yield flat(-(b["Kz"].diff(gain)) * b["g1"], sp.zeros(rest, m)), flat(coupling, (raw["Gz1"]).diff(gain))


def steady_variance(S: sp.Expr) -> sp.Expr:
    """Steady variance of z - z° for dx/dt = q, dz/dt = x, sigma_1 = x + r_1, sigma_2 = z + r_2.

    Both gains K_x and K_z are 1.
    Errors e of x and f of z in the old coordinates (1.13.equivalent), unit intensities:
    de/dt = -e + q - r_1, df/dt = (1 + S) e - f - r_2 + S r_1.
    """
    variables = a, b, d = sp.symbols("a b d", real=True)
    A = sp.Matrix([[-1, 0], [1 + S, -1]])
    B = sp.Matrix([[1, -1, 0], [0, S, -1]])  # of q, r_1, r_2
    P = sp.Matrix([[a, b], [b, d]])
    system = A * P + P * A.T + B * B.T
    rows = sp.Matrix([system[0, 0], system[0, 1], system[1, 1]])
    matrix = rows.jacobian(variables)
    values = matrix.LUsolve(-rows.subs({variable: 0 for variable in variables}))
    return sp.expand(values[2])


@claim("1.13.separate")
def first_stage_of_the_variant_ignores_sigma2():
    """x° of (1.6) does not depend on sigma_2 in the variant either: dx°/dt has no z° and no K°_z."""
    found, meaning = True, list[dict]()
    for m, rest in PAIRS[:4]:
        b = general(m, rest)
        itself, other = b["Gx"] - b["Kx"] * b["gx"], b["upper"][:, m:]
        meaning += say_free(itself, other, b["Kz"])
        found = found and not sp.Matrix.hstack(itself, other).has(*b["Kz"])
        found = found and all(sp.expand(value) == 0 for value in other)
    return fact(True, found, "entries of the first rows", PROVED, meaning=meaning)
