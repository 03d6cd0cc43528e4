"""Guaranteed velocity correction: the estimates of INS errors that survive the worst correlation.

S. R. Martirosyan, Optimal guaranteed algorithms of velocity correction of an inertial
navigation system. Reports of NAS RA 123 (2), 2023 (in Russian).

    system.py      section 1: error equations, measurement, H(tau)
    duality.py     sections 2 and 3: the estimator, its worst correlation, the dual problem
    polynomial.py  section 4.1 to (4.9): the generalised Chebyshev polynomial and its deviations
    weights.py     (4.10) to (4.16): weights, guaranteed errors, estimates of both channels
    beyond.py      what the paper does not have: uniqueness, all interval lengths
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
        "2.7": "the problem itself: its objective is 2.D, its name 2.7.name",
        "3.5": "the form of a solution, impulses at the chosen times; 4.7 judges it",
    },
    beside=(
        "1.quarter-period 2.7.name 3.remark1 3.more-measurements 3.2.contacts 3.2.theorem 4.2.identity-of-channels "
        "4.6.same-instants 4.scale"
    ),
    remarks=(
        "1.3.spectrum 1.9.root-cause 1.observable 1.quarter-period.minute 3.1.terms 3.2.consistent 3.3.back 4.1.order "
        "4.3.unique 4.4.closed-form 4.5.positive 4.6.stationary 4.6.weights 4.8.signs 4.14.y2.bias unique.*"
    ),
    beyond="4.11.nonzero-beyond range.* position.*",
    causes={"4.4": "4.3.u2"},
    typed="3.3 3.3.back 1.quarter-period 1.quarter-period.minute",
    left_out={
        "after (1.1): all y_i are of one order, beta_3 of a higher one": "no figures of the errors are given",
        "(1.1): U beta_3; before (2.7): sgn of an impulse": "conventions: U in units of omega_0; signs of the weights",
        "section 3: position correction has l = m, hence unique algorithms": "a result of [9], whose model and range "
        "of T are not printed; position.y2 has l = 3 for m = 4 and T >= 2 pi",
        "section 4.1: S0 satisfies the lemma of [9]": "the lemma is not printed; 4.4* proves the optimum without it",
        "section 3: steps 1 to 4 of the algorithm": "3.remark1 and 4.1, 4.4*, 4.10, 3.6* "
        "with 4.13; for any system they rest on the theorems of [9-11], which are quoted",
        "after (4.12): the algorithms are unique by (4.11)": "of y1 too: weights live on the contacts of any one dual, "
        "here (4.6) alone (4.6.same-instants, unique.*), and det N != 0 (4.11.nonzero) leaves one solution",
        "(4.14) and (4.16) are easily realised; section 3: the difference from least squares": "judgements",
        "(2.5): Phi_H as any piecewise continuous function": "2.6.piecewise, 2.D.piecewise, 3.1.piecewise take "
        "polynomials of degree 2 on two pieces",
        "(3.1): both problems have one value, for every system": "proved for this one and every T, by 4.13 and "
        "range.*, and >= for every system, by 3.1 and 3.1.terms; <= needs a separating hyperplane: a statement "
        "here has finitely many real variables, none of which is a function Phi or a number of instants",
        "(3.4) the other way, for every system": "3.3.back says it of the constraint; that its L is least is that <=",
    },
)
