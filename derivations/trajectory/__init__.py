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
    doi="10.22250/isu.2018.55.42-50",
)
