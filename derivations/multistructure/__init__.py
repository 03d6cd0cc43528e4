"""Obidin and others 2018: filters for error signals of inertial navigation whose model switches.

The files follow the paper: error models (1)-(3), the jump model (4)-(6) with (14) and (19), the recursion
(7)-(11), moments (12)-(13), the Gaussian step (15)-(18), the pulsating filters, the polygaussian filter
(19)-(21). Recurrences for densities are total probability and Bayes' rule: they are decided on finite-state
analogues with free symbols for every probability (:mod:`navsym_papers.multistructure.finite`), where integrals
are sums, for any number of modes by induction (:mod:`navsym_papers.multistructure.any_number`), and again for Gaussian
families. Words are decided by counting, by one exact example, or by an integral in balls.

``conditions`` has what stands in words between the equations; ``forgetting`` goes beyond the paper: how wrong the
probabilities of the modes can be, and for how long.

Slips without a claim of their own, since nothing can be computed from them: the text below (11) says "in the form (1)"
for the form (11), and "the j-th step" above (12) for the k-th.
"""

from __future__ import annotations

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
        "4": "the switching state model itself: matrices A, G and the mode I(k) are given",
        "6": "the switching measurement model itself; it defines H, V and R",
    },
)
