"""Forty identities of Kalman filtering, smoothing and least squares for matrices of any size, with false variants.

Written before the code that decides them. Each is: label, left side, true right side, false right side, hypotheses.
Sources: Maybeck, Stochastic Models, Estimation and Control (1979, 1982); Simon, Optimal State Estimation (2006);
Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation (2001); Petersen, Pedersen, The
Matrix Cookbook (2012). One false variant was written anew, because its product had shapes that do not fit.
"""

SYMBOLS = {
    "P": {"matrix": ["n", "n"], "symmetric": True, "positive": True},
    "M": {"matrix": ["n", "n"], "symmetric": True, "positive": True},
    "Q": {"matrix": ["n", "n"], "symmetric": True, "positive": True},
    "R": {"matrix": ["m", "m"], "symmetric": True, "positive": True},
    "W": {"matrix": ["m", "m"], "symmetric": True, "positive": True},
    "N": {"matrix": ["n", "n"], "symmetric": True},
    "D": {"matrix": ["n", "n"]},
    "H": {"matrix": ["m", "n"]},
    "K": {"matrix": ["n", "m"]},
    "G": {"matrix": ["n", "n"]},
    "F": {"matrix": ["n", "n"]},
    "L": {"matrix": ["n", "n"], "invertible": True},
    "T": {"matrix": ["n", "n"], "invertible": True},
    "A": {"matrix": ["n", "n"], "invertible": True},
    "B": {"matrix": ["n", "n"], "invertible": True},
    "C": {"matrix": ["m", "m"], "invertible": True},
    "E": {"matrix": ["n", "n"]},
    "J": {"matrix": ["n", "m"]},
    "O": {"matrix": ["n", "n"], "orthogonal": True},
    "x": {"vector": "n"},
    "y": {"vector": "n"},
    "u": {"vector": "n"},
    "v": {"vector": "n"},
    "z": {"vector": "m"},
    "alpha": "positive",
}

S = "(H @ P @ H.T + R)"
GAIN = f"K = P @ H.T @ inv({S})"
POSTERIOR = f"M = P - P @ H.T @ inv({S}) @ H @ P"
SMOOTHER = "G = P @ F.T @ inv(F @ P @ F.T + Q)"
NORMAL = "inv(H.T @ W @ H)"
HAT = "(H @ inv(H.T @ H) @ H.T)"
BLUE = f"({NORMAL} @ H.T @ W)"
UPDATE = f"y = x + P @ H.T @ inv({S}) @ (z - H @ x)"
OFF = "(eye(n) - K @ H)"

IDENTITIES = [
    ("joseph", f"{OFF} @ P @ {OFF}.T + K @ R @ K.T", f"{OFF} @ P", "(eye(n) + K @ H) @ P", [GAIN]),
    ("joseph-innovation", f"{OFF} @ P @ {OFF}.T + K @ R @ K.T", f"P - K @ {S} @ K.T", f"P + K @ {S} @ K.T", [GAIN]),
    (
        "joseph-any-gain",
        f"{OFF} @ P @ {OFF}.T + K @ R @ K.T",
        f"P - K @ H @ P - P @ H.T @ K.T + K @ {S} @ K.T",
        f"P - 2*K @ H @ P + K @ {S} @ K.T",
        [],
    ),
    (
        "gain-information",
        f"P @ H.T @ inv({S})",
        "inv(inv(P) + H.T @ inv(R) @ H) @ H.T @ inv(R)",
        "inv(inv(P) + H.T @ inv(R) @ H) @ H.T @ R",
        [],
    ),
    (
        "covariance-information",
        "inv(inv(P) + H.T @ inv(R) @ H)",
        f"P - P @ H.T @ inv({S}) @ H @ P",
        f"P + P @ H.T @ inv({S}) @ H @ P",
        [],
    ),
    (
        "woodbury",
        "inv(A + J @ C @ H)",
        "inv(A) - inv(A) @ J @ inv(inv(C) + H @ inv(A) @ J) @ H @ inv(A)",
        "inv(A) + inv(A) @ J @ inv(inv(C) + H @ inv(A) @ J) @ H @ inv(A)",
        [],
    ),
    ("push-through", "inv(eye(n) + J @ H) @ J", "J @ inv(eye(m) + H @ J)", "J @ inv(eye(m) - H @ J)", []),
    ("gain-posterior", f"P @ H.T @ inv({S})", "M @ H.T @ inv(R)", f"M @ H.T @ inv({S})", [POSTERIOR]),
    ("posterior-residual", "H @ M @ H.T", f"R - R @ inv({S}) @ R", f"R + R @ inv({S}) @ R", [POSTERIOR]),
    ("residual-factor", "eye(m) - H @ K", f"R @ inv({S})", f"inv({S}) @ R", [GAIN]),
    ("information-update", "inv(M)", "inv(P) + H.T @ inv(R) @ H", "inv(P) - H.T @ inv(R) @ H", [POSTERIOR]),
    (
        "smoother-covariance",
        "P - G @ (F @ P @ F.T + Q) @ G.T",
        "(eye(n) - G @ F) @ P",
        "(eye(n) - F @ G) @ P",
        [SMOOTHER],
    ),
    (
        "smoother-joseph",
        "P + G @ (N - (F @ P @ F.T + Q)) @ G.T",
        "(eye(n) - G @ F) @ P @ (eye(n) - G @ F).T + G @ (N + Q) @ G.T",
        "(eye(n) - G @ F) @ P @ (eye(n) - G @ F).T + G @ (N - Q) @ G.T",
        [SMOOTHER],
    ),
    ("smoother-information", "inv(inv(P) + F.T @ inv(Q) @ F)", "P - G @ F @ P", "P - G @ P @ F", [SMOOTHER]),
    ("inverse-difference", "inv(A) - inv(B)", "inv(A) @ (B - A) @ inv(B)", "inv(A) @ (A - B) @ inv(B)", []),
    ("inverse-product", "inv(A @ B @ L)", "inv(L) @ inv(B) @ inv(A)", "inv(A) @ inv(B) @ inv(L)", []),
    ("inverse-transpose", "inv(A.T)", "inv(A).T", "inv(A)", []),
    ("transpose-product", "(A @ K @ H).T", "H.T @ K.T @ A.T", "H.T @ K.T @ A", []),
    ("hat-idempotent", f"{HAT} @ {HAT}", HAT, "eye(m)", []),
    ("hat-residual", f"(eye(m) - {HAT}) @ H", "zeros(m, n)", "H", []),
    ("normal-equations", f"H.T @ W @ (z - H @ {BLUE} @ z)", "zeros(n, 1)", "H.T @ W @ z", []),
    ("oblique-projection", f"H @ {BLUE} @ H @ {BLUE}", f"H @ {BLUE}", f"{BLUE}.T @ H.T", []),
    ("blue-covariance", f"{BLUE} @ inv(W) @ {BLUE}.T", NORMAL, "H.T @ W @ H", []),
    (
        "update-information",
        "y",
        "inv(inv(P) + H.T @ inv(R) @ H) @ (inv(P) @ x + H.T @ inv(R) @ z)",
        "inv(inv(P) + H.T @ inv(R) @ H) @ (inv(P) @ x - H.T @ inv(R) @ z)",
        [UPDATE],
    ),
    ("postfit-residual", "z - H @ y", f"R @ inv({S}) @ (z - H @ x)", f"inv({S}) @ R @ (z - H @ x)", [UPDATE]),
    (
        "least-cost",
        "(z - H @ y).T @ inv(R) @ (z - H @ y) + (y - x).T @ inv(P) @ (y - x)",
        f"(z - H @ x).T @ inv({S}) @ (z - H @ x)",
        "(z - H @ x).T @ inv(R) @ (z - H @ x)",
        [UPDATE],
    ),
    ("trace-cyclic", "trace(A @ K @ H)", "trace(H @ A @ K)", "trace(A @ H.T @ K.T)", []),
    (
        "trace-posterior",
        f"trace(P - K @ {S} @ K.T)",
        "trace(P) - trace(K @ H @ P)",
        "trace(P) - 2*trace(K @ H @ P)",
        [GAIN],
    ),
    ("trace-hat", f"trace({HAT})", "n", "m", []),
    ("mean-innovation-squared", f"trace(inv({S}) @ (H @ P @ H.T)) + trace(inv({S}) @ R)", "m", "n", []),
    ("similarity", "inv(T) @ A @ T @ inv(T) @ B @ T", "inv(T) @ A @ B @ T", "inv(T) @ B @ A @ T", []),
    (
        "gain-coordinates",
        "T @ P @ T.T @ (H @ inv(T)).T @ inv(H @ inv(T) @ T @ P @ T.T @ inv(T).T @ H.T + R)",
        f"T @ P @ H.T @ inv({S})",
        f"inv(T) @ P @ H.T @ inv({S})",
        [],
    ),
    (
        "square-root-update",
        f"P - P @ H.T @ inv({S}) @ H @ P",
        f"L @ (eye(n) - L.T @ H.T @ inv({S}) @ H @ L) @ L.T",
        f"L.T @ (eye(n) - L @ H.T @ inv({S}) @ H @ L.T) @ L",
        ["P = L @ L.T"],
    ),
    ("square-root-whitening", "L.T @ inv(P) @ L", "eye(n)", "P @ inv(L) @ inv(L).T @ L", ["P = L @ L.T"]),
    ("square-root-rotation", "L @ O @ (L @ O).T", "P", "O @ P @ O.T", ["P = L @ L.T"]),
    ("rotated-inverse", "inv(O @ P @ O.T)", "O @ inv(P) @ O.T", "O.T @ inv(P) @ O", []),
    (
        "riccati-information",
        "-inv(P) @ D @ inv(P)",
        "-inv(P) @ F - F.T @ inv(P) - inv(P) @ Q @ inv(P) + H.T @ inv(R) @ H",
        "-inv(P) @ F - F.T @ inv(P) - inv(P) @ Q @ inv(P) - H.T @ inv(R) @ H",
        ["D = F @ P + P @ F.T + Q - P @ H.T @ inv(R) @ H @ P"],
    ),
    ("fused-covariance", "inv(inv(P) + inv(M))", "P @ inv(P + M) @ M", "P @ inv(P + M) @ P", []),
    (
        "rank-one-update",
        "inv(A + u @ v.T)",
        "inv(A) - inv(A) @ u @ v.T @ inv(A)/(1 + v.T @ inv(A) @ u)",
        "inv(A) - inv(A) @ u @ v.T @ inv(A)/(1 - v.T @ inv(A) @ u)",
        [],
    ),
    (
        "gain-scale",
        "alpha*P @ H.T @ inv(H @ (alpha*P) @ H.T + alpha*R)",
        f"P @ H.T @ inv({S})",
        f"alpha*P @ H.T @ inv({S})",
        [],
    ),
]
