"""Devyatisilny and Shurygin 2018: derivatives of a measured position, conditioning, adaptive filter.

Split along the paper: ``earth`` (basic model notions), ``motion`` (equations 1 to 4), ``scaling`` (equations
5 and 6), ``table`` (condition numbers), ``stages`` (what each stage does by itself), ``algorithm`` (dynamic
inversion), ``experiment``, ``gain``, ``figures`` and ``speeds`` (three runs that differ in speed alone);
``limits`` and ``window`` go beyond it: what no algorithm can undercut.
"""

from navsym.claims import Paper

PAPER = Paper(
    module="trajectory",
    title="Mathematical models of trajectory parameter reconstruction for embedded GLONASS systems",
    authors=("A. S. Devyatisilny", "A. V. Shurygin"),
    year=2018,
    source="Informatika i sistemy upravleniya, 2018, no. 1 (55), 42-50",
    language="ru",
    equations=("1", "2", "3", "4", "5", "6"),
    definitions={},
    beside=(
        "1.degree 3.nilpotent 3.nonzero 4.hadamard 4.smaller_step 5.independent 6.Phif.* 6.Nf.elements "
        "6.N[sp]* 6.D 6.more_stages algorithm.P.not_covariance experiment.figures experiment.violated.* "
        "experiment.distortion experiment.better experiment.gain"
    ),
    remarks=(
        "4.Phi.series 6.D.orders 6.Nf.row_step 6.Np.rows 6.first_stage.worse 6.second_stage earth.ellipse "
        "algorithm.NQ.power algorithm.field algorithm.J.* experiment.heading experiment.parts experiment.stop "
        "experiment.physical experiment.one_gain.* experiment.sigma_v.straight.100.noise experiment.sigma_v.2 "
        "experiment.sigma_v.300 experiment.sigma_v.yaw.100.full experiment.together* experiment.gain.exponent"
    ),
    beyond="limit.* window.* table.curse* table.n2.closed table.n2.best 6.Nf.det* experiment.straight.*",
    causes={
        "algorithm.P": "algorithm.K",
        "experiment.sigma_phi.2": "experiment.sigma_phi.100",
        "experiment.sigma_phi.300": "experiment.sigma_phi.100",
        **{
            f"experiment.{name}": "experiment.gain" for name in ("sigma_phi.gain", "sigma_v.yaw.100", "sigma_a.yaw.100")
        },
    },
    scopes={
        "1.row*": "n = 8",
        "1.general": "n = 8",
        "algorithm.J.still": "n = 5",
        "experiment.straight.*": "n = 3, three steps",
        "window.legendre": "d to 9, r to 3",
    },
    typed=("algorithm.P.not_covariance algorithm.estimate experiment.heading experiment.together.least experiment.eps"),
    left_out={
        "lambda = lambda^e": "one meridian plane: true whatever the meridian is",
        "(5): N_pN = N_p D^-1 is the observability matrix of (5), with columns of unit length": "what x^q = D x means",
        "S_k = x_k^q, N_p = N_s D_s D_f": "follow from 6.D and 6.Np by N_s = N_f D_s^-1",
        "the algorithm: P(0) = P_0": "a first value, given",
        "the algorithm: Q*_k in P^-_(k+1), Q*_(k+1) below": "an index of a step, read as the Q that J_(k+1) chooses",
        "sigma_v = 0.019 m, sigma_a = 0.003 m/s^2 on straight courses": "no interval is given; after yawing the gain "
        "forgets for minutes, and some start gives any value from 0.36 to 0.017 m/s",
        "failure in physical variables, explained by condition numbers": "the trials are not described",
        "figures 1 to 4": "not printed as numbers; experiment.figures stays open",
    },
    doi="10.22250/isu.2018.55.42-50",
)
