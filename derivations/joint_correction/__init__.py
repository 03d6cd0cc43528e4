"""Joint velocity and position correction of an inertial navigation system (Kalenova et al. 1979).

``section1_*`` splits a linear system by its two measurements and builds two-stage estimators,
``section2_*`` derives the error equations and the two groups of observable variables from the
kinematics of small rotations, ``section3_*`` examines the algorithm, its gains and its stability;
``section3_noise`` and ``sensors`` go beyond the paper: what poles cost in noise and which are best, how few
measurements are enough.
"""

from __future__ import annotations

from navsym.claims import Paper

PAPER = Paper(
    module="joint_correction",
    title="On correction of inertial navigation systems by joint velocity and position information",
    authors=("V. I. Kalenova", "V. M. Morozov", "N. A. Parusnikov", "A. G. Shakot'ko"),
    year=1979,
    source="received 9 October 1979; original title: O korrektsii inertsial'nykh navigatsionnykh sistem "
    "pri pomoshchi sovmestnoi skorostnoi i pozitsionnoi dopolnitel'noi informatsii",
    language="ru",
    equations=(*(f"1.{k}" for k in range(1, 15)), *(f"2.{k}" for k in range(1, 10)), *(f"3.{k}" for k in range(1, 4))),
    definitions={
        "1.1": "the given linear system and its measurements",
        "1.2": "definition of the two chains of vectors",
    },
)
