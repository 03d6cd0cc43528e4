"""Obidin and others 2018: filters for error signals of inertial navigation whose model switches.

The files follow the paper: error models (1)-(3), the jump model (4)-(6) with (14) and (19), the recursion
(7)-(11), moments (12)-(13), the Gaussian step (15)-(18), the pulsating filters, the polygaussian filter
(19)-(21). Recurrences for densities are total probability and Bayes' rule: they are decided on finite-state
analogues with free symbols for every probability (:mod:`navsym_papers.multistructure.finite`), where integrals
are sums, and again for Gaussian families: for the numbers of modes and values that each title names. Words are
decided by counting, by one exact example, or by an integral in balls.

``conditions`` has what stands in words between the equations; ``forgetting`` goes beyond the paper: how wrong the
probabilities of the modes can be, and for how long.
"""

from navsym.claims import Paper

PAPER = Paper(
    module="multistructure",
    title="Method of estimation of the multistructural signal of errors of inertial navigation systems",
    authors=("D. Obidin", "D. Makarchuk", "O. Kostenko", "N. Mishukova"),
    year=2018,
    source="received 7 June 2018, accepted 17 July 2018",
    language="Ukrainian",
    equations=tuple(str(number) for number in range(1, 22)),
    definitions={
        "1": "the equation of errors in general: it defines S; its arguments and its shape are claimed beside it",
        "2": "the same without the errors of the parameters; what follows is claimed beside it",
        "4": "the switching state model itself: matrices A, G and the mode I(k) are given",
        "6": "the switching measurement model itself; it defines H, V and R",
    },
    beside=(
        "1.inertial 1.nonlinear 2.drift.polar 2.growth* 3.time 4.type 6.markov 8.correct 8.definition 8.posterior "
        "8.predict 10.definition 11.form 12.optimal 13.sequences 14.follows 15.gaussian 17.cost 17.memory "
        "17.suboptimal K.better accumulate count.growth near 18.next 19.count 20.rho 21.mixture 21.optimal"
    ),
    remarks=(
        "1.arguments 2.form 2.drift.across 2.drift.equation 3.inertial 5.prediction 8.joseph 11.parts "
        "12.selection 13.densities 13.every 17.first 17.fold 17.same 21.prior K.second K.third K.series "
        "near.* accumulate.all"
    ),
    beyond="10.forgets* 10.error* 17.error* K.exact K.fold K.longer",
    scopes={
        "17.memory": "one state, two modes",
        "17.same": "F = 1, Q = 2, H = 1, R = 3, one series of measurements",
        "17.first": "one series of measurements, z = 3",
        "19": "3 modes, 1 to 6 steps",
        **dict.fromkeys(
            ("8.joseph", "8.posterior", "18.exponent", "18.normaliser"), "(states, measurements) (1,1), (2,1), (1,2)"
        ),
    },
    typed=("17.error 17.error.sharp 15.gaussian 13.every accumulate near.excess near.spread near.cumulant"),
    left_out={
        "(18), exponent: v^T/(2D) v": "a division by a matrix, read as the inverse",
        "above (4): S(psi, 0, 0) = 0": "the definition of an error model: what is shown less what is true",
        "(6): V(k) is white noise": "Gaussian densities, as they are used below (13), need normal noise; an assumption",
        "(8): a sign = behind the sign of multiplication": "damage of the copy, read as the product that (15*) has too",
        "below (21): g^i(0) = p^i": "a first value, given; it holds when step 0 has no measurement",
        "unlike existing methods": "a comparison without a method named",
        "(8) to (21) for any number of modes and values": "claimed for the numbers that each title names",
        "below (4): W(k)": "its covariance is not printed",
        "(3): the dots over S1 and S2": "part of two names: the printed definitions are partial derivatives, no rates",
        "below (21): a prior that is a weighted sum of Gaussians": "its weights for each mode are not "
        "printed, nor those of the pairs of a mode and a component behind them: no sides to compare",
        "below (11): in the form (1); above (12): on the j-th step": "(11) and k; nothing is computed from them",
        "(3) acceptable in most cases, (4) more adequate, K by statistical modelling": "judgements and advice",
    },
)
