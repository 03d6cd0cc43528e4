"""Guaranteed velocity correction: the estimates of INS errors that survive the worst correlation.

S. R. Martirosyan, Optimal guaranteed algorithms of velocity correction of an inertial
navigation system. Reports of NAS RA 123 (2), 2023 (in Russian).

    system.py      section 1: error equations, measurement, H(tau)
    duality.py     sections 2 and 3: the estimator, its worst correlation, the dual problem
    polynomial.py  section 4.1 to (4.9): the generalised Chebyshev polynomial and its deviations
    weights.py     (4.10) to (4.16): weights, guaranteed errors, estimates of both channels
    beyond.py      what the paper does not have: uniqueness, all interval lengths up to 2 pi
"""

from navsym.claims import Paper

PAPER = Paper(
    module="guaranteed_velocity",
    title="Optimal guaranteed algorithms of velocity correction of an inertial navigation system",
    authors=("S. R. Martirosyan",),
    year=2023,
    source="Reports of NAS RA 123 (2)",
    language="Russian",
    doi="10.54503/0321-1339-2023.123.2-7",
    equations=(
        *(f"1.{k}" for k in range(1, 10)),
        *(f"2.{k}" for k in range(1, 8)),
        *(f"3.{k}" for k in range(1, 7)),
        *(f"4.{k}" for k in range(1, 17)),
    ),
    definitions={
        "1.5": "hypotheses on the noise of the lateral velocity measurement: given, not derived",
        "1.6": "hypotheses on the noise of the longitudinal velocity measurement: given, not derived",
        "2.1": "a general linear system: given",
        "2.2": "a general scalar measurement: given",
        "2.3": "hypotheses on the noise of the general measurement: given",
    },
)
