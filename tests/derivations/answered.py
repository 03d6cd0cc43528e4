"""Claims that a rule of ``titles`` lists, each with the reason why its title is right all the same.

An entry that its rule lists no more is stale and fails (``test_rules``).
"""

from __future__ import annotations

ROOTS = "the sides are products whose zeros in the named range the title lists"
SQUARE = "the difference is a square, or a sum of squares with positive factors"
MATRIX = "a constant matrix or a constant entry of one"
UNIT = "units and orders have no sizes"
EVERY = "the quantity cancels before the statement is made: it stands in the source as a symbol"
SIZES = "modes and values of the step that the source builds: step(m, n)"
PRINTED = "a figure of the paper, set against the one that is decided"
LEGENDRE = "least squares: the inverse of the information, which the source integrates"

ANSWERED: dict[str, dict[str, str]] = {
    "numbers_of_no_statement": {
        "guaranteed_velocity:range.y2.last.contacts": "the next zeros of cos(s/2 + pi/4) and sin(s/2 + pi/4)",
        "guaranteed_velocity:3.1.terms": "the number 3.1 is that of an equation",
        "joint_correction:2.assumption1.orthodrome": "s <= 27/50 is 250 m/s over 465 m/s of the ground, rounded up",
        "joint_correction:2.scale.period": "60 < 2 pi/mu is twenty times 3",
        "joint_correction:2.scale.earth": "the square of the sine of 45 degrees is 1/2 there",
        **dict.fromkeys(("multistructure:20*", "multistructure:15*", "multistructure:9*"), SIZES),
        "terrain_search:9.small": "r/250 is 0.4 per cent of r",
        "terrain_search:11.beta": "measurements of the tracks that the source builds: slopes(1), slopes(2)",
        "terrain_search:table.close.mean": PRINTED,
        "terrain_search:sigmaV.floor": "121/400 is the square of 0.55; 0.38 is the right side, a mean of distances",
        "terrain_search:velocity.orders": "121 is 11 by 11",
        "terrain_search:table.bias.gain": "6849/12500 is nine tenths of 0.6088, which the bias gives",
        "trajectory:experiment.heading": "cos(4 pi/9) is the cosine of 80 degrees",
        "trajectory:experiment.together.100": PRINTED,
        "trajectory:experiment.together": "open: the speeds of the two sentences",
        "trajectory:experiment.figures": "open: the speeds and the numbers of the figures",
        "trajectory:experiment.gain.exponent": "the printed gain with another exponent in its last component",
        "trajectory:limit.yawing": "100 sin(pi/4) m/s times the greatest turn rate of the printed heading",
        "trajectory:window.order": "7.4 is the cube root of 400",
    },
    "ends_of_ranges_in_no_title": {
        "joint_correction:2.condition2.height": "59560/8898289 is e^2",
        "joint_correction:2.assumption1.orthodrome": "s <= 27/50 is 250 m/s over 465 m/s of the ground, rounded up",
        "terrain_search:9.small": "a tenth of the speed",
    },
    "moving_quantities_held_in_silence": {
        **dict.fromkeys(
            ("joint_correction:1.14.characteristic", "joint_correction:1.14.gains_unique"),
            "u is a variable of section 1, not the rate of the Earth",
        ),
        "joint_correction:3.1.overlap": "combinations of errors at one time: no motion enters",
        "joint_correction:3.3.gains": "the gains cancel omega: the errors have a constant matrix",
    },
    "ranges_narrower_than_the_title": {
        "guaranteed_velocity:range.y1.contacts": "T enters through s = T - tau alone",
        "guaranteed_velocity:2.6": "q is linear: its coefficients are compared",
        "joint_correction:2.9.observable": EVERY,
        "joint_correction:3.noise.velocity": "l is lambda_c",
        "multistructure:17.same": EVERY,
        "terrain_search:10.flat": EVERY,
        "terrain_search:case1.value": EVERY,
        "trajectory:experiment.better*": "the cases are n and tau of the table",
    },
    "sizes_in_no_scope": {
        "multistructure:K.longer": "4 steps are the whole series: the optimal estimate",
        "multistructure:17.suboptimal": "2 steps are the whole series: the optimal estimate",
        "trajectory:3.elements": "n = 8 has 6 entries of one",
    },
    "words_that_nothing_shows": {
        **dict.fromkeys(
            (
                "guaranteed_velocity:range.y1.contacts",
                "guaranteed_velocity:range.y2.last.contacts",
                "guaranteed_velocity:range.y3.last.contacts",
            ),
            ROOTS,
        ),
        "guaranteed_velocity:2.6": "the coefficients of q are the differences of the condition, entry by entry",
        "guaranteed_velocity:3.3.min*": "the minimum is that of the paper, the claim names its variables",
        "joint_correction:1.6.kalman_unique.any": "the difference obeys a linear equation",
        "joint_correction:1.14.next": "the determinant is phi_m or its square: not zero when phi_m is not",
        "joint_correction:1.14.dimension": "a difference, no bound",
        "joint_correction:1.14.choice": "all splits of one system are counted",
        "joint_correction:3.3.triangular": "the blocks of the whole matrix are compared",
        "joint_correction:3.2.gains_unique": "an affine map with the determinant 1 or -1",
        "joint_correction:3.choice.lambda_h": "the difference is (lambda - m)^2 times a sum of positive terms",
        "joint_correction:sensors.position": "all pairs of variables are tried",
        "joint_correction:sensors.full.turning": "directions are exhibited and minors are not zero",
        "multistructure:18.exponent": "the completed square is compared",
        "multistructure:K.fold": "the estimate is that of the exact tree",
        "multistructure:17.first": "the estimate is that of the exact tree",
        "multistructure:19": "the probabilities of each step are compared",
        "terrain_search:6.rest": "zero velocity is among the hypotheses of the second stage",
        "terrain_search:10.sufficient": SQUARE,
        "terrain_search:joint.four": "the determinant vanishes where the cross-ratios agree",
        "terrain_search:roots.gram": SQUARE,
        "terrain_search:sequential.below": "all hypotheses are counted",
        "terrain_search:sequential.shrinks.sign": SQUARE,
        "terrain_search:offset.groups": SQUARE,
        "trajectory:algorithm.J.still": SQUARE,
        "trajectory:experiment.together.least": SQUARE,
        **dict.fromkeys((f"trajectory:window.{k}" for k in ("position", "velocity", "acceleration", "jerk")), LEGENDRE),
        "trajectory:table.n2.best": SQUARE,
    },
    "numbers_under_a_general_title": {
        "guaranteed_velocity:range.y3.meets.2": "at T = pi",
        "guaranteed_velocity:1.observable": "A and h1 are the constant ones of (1.3) and (1.4)",
        **dict.fromkeys(
            (f"guaranteed_velocity:{k}" for k in ("1.3", "1.9.H1", "4.12.Phi11", "4.12.Phi12", "4.12.Phi13")), MATRIX
        ),
        **dict.fromkeys(("joint_correction:2.scale.tau_low", "joint_correction:2.scale.tau_high"), "numbers in words"),
        "joint_correction:2.9.inhomogeneous_printed*": UNIT,
        "joint_correction:3.3.only_velocity": EVERY,
        "joint_correction:3.3.triangular": EVERY,
        "terrain_search:10.informative": "an example, as *may* says",
        "terrain_search:joint.cubic": "the heights of the title",
        "terrain_search:interval.whole": "an example, as *may* says",
        "trajectory:algorithm.J.units": UNIT,
        "trajectory:1.rho3": MATRIX,
        "trajectory:experiment.sigma_v.unit*": UNIT,
        "trajectory:experiment.sigma_a.unit": UNIT,
    },
}
