"""Section 1 for every n and m: what (1.5) to (1.14) state once the chains are named, as matrices of any size.

The rows of A are a_1 ... a_m, those of B are b_1 ... b_(n-m); U and V are the two parts of the inverse of both.
Definition (1.2) and the coefficients theta, phi and delta say how the chains go on: ``A G = Theta A`` and
``B G = Phi_x A + Phi_z B``. Their existence is 1.4.theta, 1.8.basis, 1.10.phi and 1.14.delta.
"""

from collections.abc import Callable

from navsym.claims import Claim, Property, claim
from navsym.prove.claimfile import claims_from, property_of_claim

SQUARE = {"n": "G", "m": "Theta C1 P1 P2", "k": "Phi_z C2 T", "i": "F C11", "o": "Theta_v C12", "j": "D_w C22"}
OTHER = {
    ("m", "n"): "A",
    ("k", "n"): "B",
    ("n", "m"): "U",
    ("n", "k"): "V",
    ("k", "m"): "Phi_x S",
    ("i", "n"): "A_u",
    ("o", "n"): "A_v",
    ("j", "n"): "B_w",
    ("i", "o"): "F_o",
    ("o", "i"): "Theta_u",
    ("j", "i"): "D_u",
    ("1", "m"): "g_x e_m",
    ("1", "k"): "g_z e_k",
    ("1", "n"): "h_1 h_2",
}
INVERTIBLE = "C1 C2 T C11 C12 C22".split()
VECTORS = {"m": "x x_o q_x K_x", "k": "z z_o q_z K_z", "n": "d"}


def shapes() -> dict:
    """The letters of this file with their dimensions."""
    found: dict = {"r_x": "real", "r_z": "real"}
    for size, names in SQUARE.items():
        found |= {name: {"matrix": [size, size], "invertible": name in INVERTIBLE} for name in names.split()}
    for sides, names in OTHER.items():
        found |= {name: {"matrix": [int(s) if s == "1" else s for s in sides]} for name in names.split()}
    for size, names in VECTORS.items():
        found |= {name: {"vector": size} for name in names.split()}
    return found


def of_every_size(left: str, right: str, *given: str) -> Callable[[], Property]:
    """Whether two sides agree for matrices of every size, from relations between them."""

    def derive() -> Property:
        block = {"id": "any", "left": left, "right": right, "given": list(given)}
        return property_of_claim(claims_from({"symbols": shapes(), "claim": [block]}).claims[0])

    return derive


SHIFT_A, SHIFT_B = "A @ G = Theta @ A", "B @ G = Phi_x @ A + Phi_z @ B"
SHIFTS = ("A_u @ G = F @ A_u + F_o @ A_v", "A_v @ G = Theta_u @ A_u + Theta_v @ A_v", "B_w @ G = D_u @ A_u + D_w @ B_w")
GX, GZ1, GZ2 = "C1 @ Theta @ inv(C1)", "C2 @ Phi_x @ inv(C1)", "C2 @ Phi_z @ inv(C2)"
FROM_U, FROM_V, FROM_W = "inv(C11)@(C11@A_u)", "inv(C12)@(C12@A_v)", "inv(C22)@(C22@B_w)"

#: number, title, left side, right side, relations
STATEMENTS = (
    ("1.5.x", "dx/dt = G_x x, G_x = C_1 Theta C_1^-1", "C1 @ A @ G", f"{GX} @ (C1 @ A)", SHIFT_A),
    ("1.5.gx", "sigma_1 = g_x^T x, g_x^T = (1 0 ... 0) C_1^-1", "e_m @ inv(C1) @ (C1 @ A)", "h_1", "e_m @ A = h_1"),
    (
        "1.6.error",
        "the error of (1.6) obeys de/dt = (G_x - K_x g_x^T) e + q_x - K_x r_x",
        "Theta @ x + q_x - Theta @ x_o - (g_x @ x + r_x - g_x @ x_o)*K_x",
        "(Theta - K_x @ g_x) @ (x - x_o) + q_x - r_x*K_x",
    ),
    (
        "1.6.kalman_unique",
        "Riccati rates of P_1, P_2 differ by A_1 D + D A_2^T, D = P_1 - P_2: one start, one solution",
        "Theta @ P1 + P1 @ Theta.T - P1 @ g_x.T @ g_x @ P1 - Theta @ P2 - P2 @ Theta.T + P2 @ g_x.T @ g_x @ P2",
        "(Theta - P1 @ g_x.T @ g_x) @ (P1 - P2) + (P1 - P2) @ (Theta - P2 @ g_x.T @ g_x).T",
        "P1 = P1.T",
        "P2 = P2.T",
    ),
    (
        "1.8.inverse",
        "xi = U C_1^-1 x + V C_2^-1 z: the transformation and its inverse give the identity",
        "U @ inv(C1) @ C1 @ A + V @ inv(C2) @ C2 @ B",
        "eye(n)",
        "U @ A + V @ B = eye(n)",
    ),
    ("1.9.z", "dz/dt = G_z1 x + G_z2 z with (1.10)", "C2 @ B @ G", f"{GZ1} @ (C1 @ A) + {GZ2} @ (C2 @ B)", SHIFT_B),
    ("1.9.sigma2", "sigma_2 = g_z^T z, g_z^T = (1 0 ... 0) C_2^-1", "e_k @ inv(C2) @ (C2 @ B)", "h_2", "e_k @ B = h_2"),
    (
        "1.11.error",
        "the error of (1.11) is driven by that of x through G_z1 alone",
        "Phi_x @ x + Phi_z @ z + q_z - Phi_x @ x_o - Phi_z @ z_o - (g_z @ z + r_z - g_z @ z_o)*K_z",
        "Phi_x @ (x - x_o) + (Phi_z - K_z @ g_z) @ (z - z_o) + q_z - r_z*K_z",
    ),
    (
        "1.13.model",
        "with z = S A xi + T B xi the form stays, G_z1 and G_z2 as follow",
        "(S @ A + T @ B) @ G",
        "(S @ Theta + T @ Phi_x - T @ Phi_z @ inv(T) @ S) @ A + T @ Phi_z @ inv(T) @ (S @ A + T @ B)",
        SHIFT_A,
        SHIFT_B,
    ),
    ("1.14.u", "du/dt = G_u1 u + G_u2 v", "C11 @ A_u @ G", f"C11@F@{FROM_U} + C11@F_o@{FROM_V}", *SHIFTS),
    ("1.14.v", "dv/dt = G_v1 u + G_v2 v", "C12 @ A_v @ G", f"C12@Theta_u@{FROM_U} + C12@Theta_v@{FROM_V}", *SHIFTS),
    ("1.14.w", "dw/dt = G_w1 u + G_w2 w", "C22 @ B_w @ G", f"C22@D_u@{FROM_U} + C22@D_w@{FROM_W}", *SHIFTS),
)

ANY_SIZE: tuple[Claim, ...] = tuple(
    claim(f"{number}.any", f"Matrices of any size: {title}.", of_every_size(left, right, *given))
    for number, title, left, right, *given in STATEMENTS
)
