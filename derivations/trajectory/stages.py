"""What each stage of the normalisation does by itself, and how the condition grows with the order.

The paper decides "already at this stage" whether a second one is needed, and speaks of the curse of dimension;
both are questions about mu(N_f) and mu(N_s) for every n, which certified condition numbers answer.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

from navsym.claims import CERTIFIED, Finding, Property, claim
from navsym.trajectory.conditioning import Enclosure
from navsym_papers.trajectory.table import COLUMNS, ORDERS, PRINTED, STEPS, true_value

LARGEST = 20
METHOD = "certified condition numbers"


@cache
def conditioning(n: int, column: str, step: str = "tau1") -> Enclosure:
    return true_value(n, step, column, 15)


def lowered(before: Enclosure, after: Enclosure) -> bool:
    """Whether a condition number is smaller after a stage; the enclosures have to be apart."""
    assert after.upper < before.lower or before.upper < after.lower, "the enclosures overlap"
    return after.upper < before.lower


def printed_lowered(n: int, step: str) -> bool:
    """The same by the printed digits, first stage alone."""
    row = PRINTED[n, step]
    return float(row[COLUMNS.index("Nf")]) < float(row[COLUMNS.index("Np")])


def growth(column: str) -> list[tuple[object, object]]:
    """Ends of mu(n) / mu(n - 1) for n = 3 ... 20."""
    pairs = [(conditioning(n - 1, column), conditioning(n, column)) for n in range(3, LARGEST + 1)]
    return [(after.lower / before.upper, after.upper / before.lower) for before, after in pairs]


@claim("table.curse", expect=CERTIFIED)
def each_state_costs_nearly_a_digit():
    """The curse of dimension after both stages: each further state multiplies mu(N_s) by 6.3 to 7.8, n to 20."""
    ratios = growth("Ns")
    low, high = min(low for low, _ in ratios), max(high for _, high in ratios)
    return Property(
        printed=("6.3", "7.8"),
        derived=Finding(
            (f"{float(low):.1f}", f"{float(high):.1f}"),
            METHOD,
            CERTIFIED,
            scope="n = 3 ... 20 against n - 1",
            evidence=f"{float(low):.4f} to {float(high):.4f}; sixteen digits are used up at n = 20",
        ),
    )


@claim("table.curse.first", expect=CERTIFIED)
def the_first_stage_alone_grows_faster_than_any_power():
    """After the first stage alone each further state costs more than the one before: factors from 10.3 to 104."""
    ratios = growth("Nf")
    rising = all(a[1] < b[0] for a, b in pairwise(ratios))
    ends = (f"{float(ratios[0][0]):.1f}", f"{float(ratios[-1][0]):.0f}")
    found = Finding((rising, *ends), METHOD, CERTIFIED, scope="n = 3 ... 20 against n - 1")
    return Property(printed=(True, "10.3", "104"), derived=found)


@claim("6.second_stage", expect=CERTIFIED)
def the_second_stage_always_helps():
    """The second stage, if needed: it lowers the condition number for every n from 2 to 20, at n = 2 by a tenth."""
    found = [lowered(conditioning(n, "Nf"), conditioning(n, "Ns")) for n in range(2, LARGEST + 1)]
    gain = conditioning(2, "Nf").lower / conditioning(2, "Ns").upper
    return Property(
        printed=(True, "1.11"),
        derived=Finding((all(found), f"{float(gain):.2f}"), METHOD, CERTIFIED, scope="n = 2 ... 20"),
    )


@claim("6.first_stage.worse", expect=CERTIFIED)
def the_first_stage_alone_can_worsen():
    """The first stage alone raises the condition number for n = 10 at 1 s, and for n = 19 and 20 at both steps."""
    worse = tuple(
        (n, step)
        for n in ORDERS
        for step in STEPS
        if not lowered(conditioning(n, "Np", step), conditioning(n, "Nf", step))
    )
    expected = ((10, "tau1"), (19, "tau0.2"), (19, "tau1"), (20, "tau0.2"), (20, "tau1"))
    return Property(printed=expected, derived=Finding(worse, METHOD, CERTIFIED, scope="n and tau of the table"))
