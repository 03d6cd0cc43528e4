"""Units of the symbols that have one in their paper, as powers of metre, second and the unit of the measurement.

The system of ``joint_correction`` is written in the radius of the Earth, the acceleration of gravity and the Schuler
frequency: its time, rates and gains are numbers. ``guaranteed_velocity`` has a time without unit as well. The
time ``t`` of ``terrain_search`` is in seconds up to (6) and counts measurements from (7): it has no entry.
"""

import re

NONE, METRE, SECOND, SIGNAL = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
SPEED, ACCELERATION, RATE, SLOPE = (1, -1, 0), (1, -2, 0), (0, -1, 0), (-1, 0, 1)

#: Paper -> pattern of names -> unit.
PATTERNS = {
    "alpha_beta_filter": {"T": SECOND, "sigma_v": METRE, "a": ACCELERATION, "r|alpha|beta|Lambda|z": NONE},
    "guaranteed_velocity": {"T|tau|v|nu|lambda|k|epsilon|omega0": NONE, "sigma[12]?|z[T0m]": SIGNAL},
    "joint_correction": {"lambda_[ch]|lam|p|t|T|omega(_.*)?|kappa|mu|s|c|u|v|nu_.*|[xy]": NONE},
    "multistructure": {
        "d?v_[xy]": SPEED,
        "v_[xy]'": SPEED,
        "d?h|R": METRE,
        "d?(K|phi)|K'|beta": NONE,
        "g|f|Deltaf": ACCELERATION,
        "Omega|epsilon_[p12]": RATE,
        "t|tau": SECOND,
        "p00|q00": (2, 0, 0),
        "p01|q01": (2, -1, 0),
        "p11|q11": (2, -2, 0),
        "x00": METRE,
        "x10": SPEED,
        "m00": METRE,
        "m10": SPEED,
        "a(00|11)": NONE,
        "a01": SECOND,
        "a10": RATE,
        "h[01]0": SLOPE,
        "h01": (-1, 1, 1),
        "r[01][01]": (0, 0, 2),
        "y[01]0": SIGNAL,
    },
    "terrain_search": {
        "t_[G0kn]|T|Deltat": SECOND,
        "x|y|delta[xy]|Delta[xys]": METRE,
        "[vV]_?[xy]?|delta(V|V[xy])|DeltaV[xy]": SPEED,
        "V[ij]|beta(_[xy])?|phi|n|i|j|M_V?[xy]": NONE,
        "alpha": METRE,
        "[pq][0-9]": SLOPE,
        "G(11|12|22)": (-2, 0, 2),
        "M(11|12|22)": (-2, 1, 2),
        "N(11|12|22)": (-2, 2, 2),
        "deltaH|h_rv": SIGNAL,
    },
    "trajectory": {
        "tau|t|T": SECOND,
        "rho": (-1, 0, 0),
        "radius|r|a|h": METRE,
        "e|latitude|longitude|phi|phi_e|lambda_e": NONE,
        "(latitude|longitude)_rate": RATE,
        "radius_rate|V[123]?": SPEED,
        "share": NONE,
    },
}


def units_of(paper, names):
    """Units of those of the names that have one in the paper."""
    found = {}
    for pattern, unit in PATTERNS[paper].items():
        found |= {name: unit for name in names if re.fullmatch(pattern, name)}
    return found
