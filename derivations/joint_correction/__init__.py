"""Joint velocity and position correction of an inertial navigation system (Kalenova et al. 1979).

``section1_*`` splits a linear system by its two measurements and builds two-stage estimators,
``section2_*`` derives the error equations and the two groups of observable variables from the
kinematics of small rotations, ``section3_*`` examines the algorithm, its gains and its stability;
``section3_noise`` and ``sensors`` go beyond the paper: what poles cost in noise and which are best, how few
measurements are enough.
"""

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
        "1.12": "the estimate of xi: (1.8) solved for it; 1.8.inverse.any has the inverse",
        "2.5": "defines the position information by gamma of (2.3)",
    },
    beside=(
        "1.dimensions 1.6.gain_unique 1.6.kalman_unique 1.11.gain_unique 1.13.free_of_gain 1.13.weight "
        "1.13.separate 1.14.dimension 1.14.choice 1.14.higher_derivatives 1.14.one_to_one 1.two_stage.* 2.1.climb "
        "2.8.neglected 2.[67].span 2.8.inhomogeneous 2.9.inhomogeneous_printed 2.[89].observable 3.1.overlap "
        "3.1.remaining 3.1.fast 3.1.slow 3.2.gains 3.3.gains 3.3.only_velocity"
    ),
    remarks=(
        "1.6.gain_unique.determinant 1.6.initial 1.6.kalman_unique.* 1.11.characteristic 1.13.preferable "
        "1.13.equivalent 1.14.characteristic 1.14.exists* 1.14.gains_unique 1.14.next 1.two_stage.transition "
        "1.two_stage.dimension 2.1.dropped 2.8.solution 2.[89].accuracy* 2.assumption1.orthodrome.* "
        "2.condition2.height 2.scale.earth 2.scale.mu_u3 2.scale.period 3.2.gains_unique 3.3.gains_unique "
        "3.3.triangular 3.preestimation.* 3.situations.*"
    ),
    beyond="3.coupled.* 3.bias.* 3.noise.* 3.choice.* sensors.*",
    causes={"2.9.inhomogeneous_printed": "2.9.y2"},
    scopes={
        "1.*.any": "",
        "1.two_stage.small": "m = 2, Theta = 0",
        "1.two_stage.linear": "m = n - m = 1",
        "1.two_stage.*": "",
        "1.13.preferable": "",
        "1.14.higher_derivatives": "",
        "1.6.kalman*": "",
        "1.6.*": "m = 1, 2, 3, one family of C_1, not every size",
        "1.11.gain_unique": "one family of C_2, not every size",
        "1.11.characteristic": "(m, n - m) = (1, 1), (2, 1), (1, 2), (2, 2), (3, 2), not every size",
        "1.13*": "(m, n - m) = (1, 1), (2, 1), (1, 2), (2, 2), lower triangular T, not every size",
        "1.14.[en]*": "m <= 4, n - m <= 2, not every size",
        "1.14.[cg]*": "n = 4, m = 3",
        "1.14*": "one system with n = 4, m = 3; i = 1 and 2 where the title names none",
        "1.8.basis": "",
        "1.5.Theta": "one system with n = 5, m = 3",
        "1.10.Phi": "one system with n = 4, m = 2",
        "1.*": "systems with (n, m) = (2, 1), (3, 2), (4, 2), (5, 3), one family of C_1 and C_2, not every size",
        "3.1.remaining": "mu u_3 not 1 or -1, omega and u constant",
        "sensors.full*": "",
        **dict.fromkeys(("3.coupled.*", "sensors.*"), "omega and u constant"),
        **dict.fromkeys(("3.situations.[zn]*", "3.situations.*joint"), "omega and u constant"),
        **dict.fromkeys(("2.8.observable", "2.9.observable", "3.1.slow", "3.noise.position"), "omega and u constant"),
    },
    moving="omega omega_1 omega_2 u u_1 u_2 u_3 kappa",
    typed="1.6.kalman_unique",
    left_out={
        "q_x = L_x q, q_z = L_z q, q_u, q_v, q_w, r_x = r_1, r_z = r_2": "names of the noises in new variables",
        "below (1.13): in general less preferable than (1.11)": "a judgement; 1.13.preferable shows both sides",
        "section 2, condition 1: far below the first cosmic speed": "no figure; 2.scale.mu has mu <= 0.1",
        "section 2, list of dimensionless quantities: nu_i for omega_i, no w_i^c and r_i^c": "names of symbols",
        "section 3.1: with position, velocity is hardly needed": "a judgement; sensors.position says what is missing",
        "the simulation showed the algorithm to be acceptable": "no figures are printed",
        "words of the scan: юбщий, реакционного, Ройтберг, Шакогъко, r_i^h for r_i^M, -K_1^h": "spelling of the copy",
    },
)
