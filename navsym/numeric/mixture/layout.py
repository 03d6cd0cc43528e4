"""Models, measurements and first estimates in the layout of lanes, for :mod:`navsym.numeric.mixture.kernels`.

Branch b stands in lane b % 8 of group b // 8; its mode is b % modes.
"""

from __future__ import annotations

import math

from navsym.numeric.compiled import njit
from navsym.numeric.mixture.filter import COMPILE


@njit(**COMPILE)
def lay_start(sources, n, means, covariances, x, P):  # type: ignore[no-untyped-def]
    """The estimates of step 0, means (sources, n), covariances (sources, n, n), one in each lane."""
    for s in range(sources):
        for a in range(n):
            x[((s // 8) * n + a) * 8 + s % 8] = means[s, a]
            for c in range(n):
                P[(((s // 8) * n + a) * n + c) * 8 + s % 8] = covariances[s, a, c]


@njit(**COMPILE)
def lay_models(k, branches, modes, F, Q, H, r, U, z, lanes):  # type: ignore[no-untyped-def]
    """Models of step k, branch b has mode b % modes, into the layout of lanes; idle lanes get a unit model.

    F, Q (T or 1, m, n, n), H (T or 1, m, p, n), r (T or 1, m, p), lanes = (F, Q, H, r) flat.
    """
    n, p = F.shape[2], H.shape[2]
    f, q = F[min(k, F.shape[0] - 1)], Q[min(k, Q.shape[0] - 1)]
    h, v = H[min(k, H.shape[0] - 1)], r[min(k, r.shape[0] - 1)]
    for b in range(((branches + 7) // 8) * 8):
        g, lane, i = b // 8, b % 8, b % modes
        used = b < branches
        for a in range(n):
            for c in range(n):
                place = ((g * n + a) * n + c) * 8 + lane
                lanes[0][place] = f[i, a, c] if used else 0.0
                lanes[1][place] = q[i, a, c] if used else (1.0 if a == c else 0.0)
        for a in range(p):
            for c in range(n):
                lanes[2][((g * p + a) * n + c) * 8 + lane] = h[i, a, c] if used else 0.0
            lanes[3][(g * p + a) * 8 + lane] = v[i, a] if used else 1.0


@njit(inline="always", **COMPILE)
def lay_measurement(k, branches, modes, rotated, U, z, came, out):  # type: ignore[no-untyped-def]
    """Measurement k in every lane, rotated into independent scalars where R is not diagonal."""
    p = z.shape[1]
    u = U[min(k, U.shape[0] - 1)]
    for c in range(p):
        came[c] = not math.isnan(z[k, c])
    for b in range(((branches + 7) // 8) * 8):
        g, lane, i = b // 8, b % 8, b % modes
        for c in range(p):
            value = z[k, c] if came[c] else 0.0
            if rotated:
                value = 0.0
                for a in range(p):
                    value += u[i, a, c] * (z[k, a] if came[a] else 0.0)
            out[(g * p + c) * 8 + lane] = value if b < branches else 0.0


@njit(**COMPILE)
def copy_sources(branches, modes, n, x, P, mean, covariance):  # type: ignore[no-untyped-def]
    """Branch b starts from source b // m."""
    for b in range(branches):
        g, lane, s = b // 8, b % 8, b // modes
        for a in range(n):
            mean[(g * n + a) * 8 + lane] = x[((s // 8) * n + a) * 8 + s % 8]
            for c in range(n):
                source = (((s // 8) * n + a) * n + c) * 8 + s % 8
                covariance[((g * n + a) * n + c) * 8 + lane] = P[source]
