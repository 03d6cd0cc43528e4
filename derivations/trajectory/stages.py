"""What each stage of the normalisation does by itself, and how the condition grows with the order.

The paper decides "already at this stage" whether a second one is needed, and speaks of the curse of dimension;
both are questions about mu(N_f) and mu(N_s) for every n, which certified condition numbers answer.
"""

from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any

from navsym.claims import CERTIFIED, claim, fact
from navsym.trajectory.conditioning import Enclosure
from navsym_papers.trajectory.table import ORDERS, STEPS, UNIT_COLUMNS, entry_rows, say_comparison, say_ends, true_value

LARGEST = 20
METHOD = "certified condition numbers"


@cache
def conditioning(n: int, column: str, step: str = "tau1") -> Enclosure:
    return true_value(n, step, column, 15)


Said = tuple[dict[str, Any], Fraction, Fraction]


@cache
def said(n: int, column: str, step: str = "tau1") -> Said:
    """The statement that encloses one condition number, and its ends."""
    return say_ends(entry_rows(n, step, column), conditioning(n, column, step), column in UNIT_COLUMNS)


def say_order(pairs: Iterable[tuple[Said, Said]], more: Iterable[tuple[Fraction, str, Fraction]] = ()):
    """That the first condition number of each pair is larger than the second, and relations of the ends beside."""
    chosen = [*pairs]
    enclosed = {id(condition): condition for pair in chosen for condition, *_ in pair}
    return say_comparison(enclosed.values(), [*((large[1], ">", small[2]) for large, small in chosen), *more])


def lowered(before: Enclosure, after: Enclosure) -> bool:
    """Whether a condition number is smaller after a stage; the enclosures have to be apart."""
    assert after.upper < before.lower or before.upper < after.lower, "the enclosures overlap"
    return after.upper < before.lower


def growth(column: str) -> list[tuple[object, object]]:
    """Ends of mu(n) / mu(n - 1) for n = 3 ... 20."""
    pairs = [(conditioning(n - 1, column), conditioning(n, column)) for n in range(3, LARGEST + 1)]
    return [(after.lower / before.upper, after.upper / before.lower) for before, after in pairs]


@claim("table.curse", expect=CERTIFIED)
def each_state_costs_nearly_a_digit():
    """The curse of dimension after both stages: each further state multiplies mu(N_s) by 6.3 to 7.8, n to 20."""
    ratios = growth("Ns")
    low, high = min(low for low, _ in ratios), max(high for _, high in ratios)
    ends = {n: said(n, "Ns") for n in range(2, LARGEST + 1)}
    rising = [(after[1], ">", Fraction("6.25") * before[2]) for before, after in pairwise(ends.values())]
    rising += [(after[2], "<", Fraction("7.85") * before[1]) for before, after in pairwise(ends.values())]
    # the least ratio is the first one, and the greatest the last one
    rising.append((ends[3][2], "<", Fraction("6.35") * ends[2][1]))
    rising.append((ends[LARGEST][1], ">", Fraction("7.75") * ends[LARGEST - 1][2]))
    meaning, certificate = say_comparison((end[0] for end in ends.values()), rising)
    return fact(
        ("6.3", "7.8"),
        (f"{float(low):.1f}", f"{float(high):.1f}"),
        METHOD,
        CERTIFIED,
        scope="n = 3 ... 20 against n - 1",
        evidence=f"{float(low):.4f} to {float(high):.4f}; sixteen digits are used up at n = 20",
        certificate=certificate,
        meaning=meaning,
    )


@claim("table.curse.first", expect=CERTIFIED)
def the_first_stage_alone_costs_ever_more():
    """After the first stage alone each further state costs more than the one before: factors from 10.3 to 104."""
    ratios = growth("Nf")
    rising = all(a[1] < b[0] for a, b in pairwise(ratios))
    ends = (f"{float(ratios[0][0]):.1f}", f"{float(ratios[-1][0]):.0f}")
    said_of = [said(n, "Nf") for n in range(2, LARGEST + 1)]
    steps = [(c[1] * a[1], ">", b[2] ** 2) for a, b, c in zip(said_of, said_of[1:], said_of[2:], strict=False)]
    for (before, after), least, most in ((said_of[:2], "10.25", "10.35"), (said_of[-2:], "103.5", "104.5")):
        steps += [(after[1], ">", Fraction(least) * before[2]), (after[2], "<", Fraction(most) * before[1])]
    meaning, certificate = say_comparison((end[0] for end in said_of), steps)
    scope = "n = 3 ... 20 against n - 1"
    return fact(
        (True, "10.3", "104"), (rising, *ends), METHOD, CERTIFIED, scope=scope, certificate=certificate, meaning=meaning
    )


@claim("6.second_stage", expect=CERTIFIED)
def the_second_stage_always_helps():
    """The second stage, if needed: it lowers the condition number for every n from 2 to 20, at n = 2 by a tenth."""
    found = [lowered(conditioning(n, "Nf"), conditioning(n, "Ns")) for n in range(2, LARGEST + 1)]
    gain = conditioning(2, "Nf").lower / conditioning(2, "Ns").upper
    pairs = [(said(n, "Nf"), said(n, "Ns")) for n in range(2, LARGEST + 1)]
    first, second = pairs[0]
    tenth = [(first[1], ">", Fraction("1.105") * second[2]), (first[2], "<", Fraction("1.115") * second[1])]
    meaning, certificate = say_order(pairs, tenth)
    value = (all(found), f"{float(gain):.2f}")
    return fact(
        (True, "1.11"), value, METHOD, CERTIFIED, scope="n = 2 ... 20", certificate=certificate, meaning=meaning
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
    pairs = [
        (said(n, "Nf", step), said(n, "Np", step))[:: 1 if (n, step) in expected else -1]
        for n in ORDERS
        for step in STEPS
    ]
    meaning, certificate = say_order(pairs)
    return fact(
        expected, worse, METHOD, CERTIFIED, scope="n and tau of the table", certificate=certificate, meaning=meaning
    )
