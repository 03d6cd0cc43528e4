"""The table of condition numbers: 56 entries, each with the digits that the exact matrix gives.

An entry is printed with five significant digits (or four decimals). The derived side is the certified
enclosure of the condition number, rounded in the same format; both ends of the enclosure round alike.
"""

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from typing import Any

from navsym.claims import CERTIFIED, UNDECIDED, Property, claim, fact, state
from navsym.models.earth import observability_rows, power_rows
from navsym.trajectory.conditioning import Enclosure, certify_condition, condition_number, state_condition

RHO = Fraction(1, 6371000)
STEPS = {"tau0.2": Fraction(1, 5), "tau1": Fraction(1)}
COLUMNS = ("Np", "NpN", "Nf", "Ns")
UNIT_COLUMNS = ("NpN", "Ns")
ORDERS = (2, 3, 4, 5, 10, 19, 20)

#: Order, step -> printed condition numbers of N_p, N_pN, N_f, N_s.
PRINTED: dict[tuple[int, str], tuple[str, str, str, str]] = {
    (2, "tau0.2"): ("6.3710e+07", "6.1623", "6.8541", "6.1623"),
    (2, "tau1"): ("1.2742e+07", "6.1623", "6.8541", "6.1623"),
    (3, "tau0.2"): ("7.2795e+08", "39.0077", "70.9231", "39.0077"),
    (3, "tau1"): ("6.0844e+07", "39.0077", "70.9231", "39.0077"),
    (4, "tau0.2"): ("8.0047e+09", "262.9437", "1.1710e+03", "262.9437"),
    (4, "tau1"): ("2.2291e+08", "262.9437", "1.1710e+03", "262.9437"),
    (5, "tau0.2"): ("8.7781e+10", "1.8524e+03", "2.6170e+04", "1.8524e+03"),
    (5, "tau1"): ("7.4783e+08", "1.8524e+03", "2.6170e+04", "1.8524e+03"),
    (10, "tau0.2"): ("1.3968e+16", "4.1966e+07", "2.1063e+12", "4.1966e+07"),
    (10, "tau1"): ("2.4634e+11", "4.1966e+07", "2.1063e+12", "4.1966e+07"),
    (19, "tau0.2"): ("3.3225e+25", "4.0542e+15", "2.8640e+26", "4.0793e+15"),
    (19, "tau1"): ("1.0438e+16", "4.0431e+15", "5.1125e+24", "4.0507e+15"),
    (20, "tau0.2"): ("3.7743e+26", "2.9984e+16", "1.4788e+26", "2.9904e+16"),
    (20, "tau1"): ("7.5995e+16", "3.0201e+16", "3.3490e+26", "3.0396e+16"),
}

#: The digits that should stand there, for the rows that double precision spoiled.
CORRECTED: dict[tuple[int, str], tuple[str, str, str, str]] = {
    (19, "tau0.2"): ("3.3237e+25", "4.0615e+15", "1.7285e+29", "4.0615e+15"),
    (19, "tau1"): ("1.0459e+16", "4.0615e+15", "1.7285e+29", "4.0615e+15"),
    (20, "tau0.2"): ("3.6639e+26", "3.1661e+16", "1.8020e+31", "3.1661e+16"),
    (20, "tau1"): ("8.0948e+16", "3.1661e+16", "1.8020e+31", "3.1661e+16"),
}


def entry_rows(n: int, step: str, column: str) -> list[list[Fraction]]:
    """The matrix of one entry before its columns are scaled."""
    return power_rows(n) if column in ("Nf", "Ns") else observability_rows(n, RHO, STEPS[step])


@lru_cache(maxsize=256)
def true_value(n: int, step: str, column: str, digits: int = 30) -> Enclosure:
    """Certified condition number of one entry of the table."""
    return condition_number(entry_rows(n, step, column), digits=digits, equilibrate=column in UNIT_COLUMNS)


def in_printed_format(found: Enclosure, printed: str) -> str:
    """The enclosure rounded as the printed numeral is; 'undecided' when its ends round differently."""
    if "e" in printed:
        return found.rounded(5) or UNDECIDED
    places = len(printed.split(".")[1])
    low, high = (round_places(x, places) for x in (found.lower, found.upper))
    return low if low == high else UNDECIDED


def round_places(x: Fraction, places: int) -> str:
    text = str(int(x * 10**places + Fraction(1, 2)))
    return f"{text[:-places]}.{text[-places:]}"


def ends_of(printed: str) -> tuple[Fraction, Fraction]:
    """The numbers that round to a printed numeral: half a unit of its last digit on either side."""
    digits, _, exponent = printed.partition("e")
    half = Fraction(1, 2) * Fraction(10) ** (int(exponent or 0) - len(digits.partition(".")[2]))
    return Fraction(printed) - half, Fraction(printed) + half


def relative_error(printed: str, found: Enclosure) -> Fraction:
    """Printed over true value, minus one."""
    return Fraction(printed) / found.lower - 1


def say_ends(rows: list[list[Fraction]], found: Enclosure, unit: bool) -> tuple[dict[str, Any], Fraction, Fraction]:
    """That the condition number lies between two ends of eight digits, and these ends."""
    narrow = Fraction(1, 10**8)
    lower, upper = map(Fraction, Enclosure(found.lower * (1 - narrow), found.upper * (1 + narrow)).decimal(10))
    return state_condition(rows, lower, upper, equilibrate=unit), lower, upper


#: The rows of a matrix, and whether its columns are divided by their lengths.
Rows = tuple[list[list[Fraction]], bool]
Said = tuple[tuple[dict[str, Any], ...], dict[str, Any]]


def say_comparison(enclosed: Iterable[dict[str, Any]], relations: Iterable[tuple[Fraction, str, Fraction]]) -> Said:
    """What a sentence about condition numbers says, with its certificate.

    enclosed  : condition numbers between ends
    relations : what these ends satisfy; the sentence follows from both
    """
    conditions, compared = [*enclosed], [state(str(x), sign, str(y)) for x, sign, y in relations]
    balls = {"rule": "balls", "bits": 128, "cells": 0}
    parts = [certify_condition(condition) for condition in conditions]
    parts += [{"kind": "proof", "statement": s, "bits": 128, "witness": {}, "proofs": [balls]} for s in compared]
    return (*conditions, *compared), {"kind": "all", "of": parts}


def refute_order(larger: Rows, smaller: Rows, factor: Fraction = Fraction(1)) -> Said:
    """What a sentence says that has factor times one condition number below another one, and its refutation.

    The larger one is at most r, which is certified; so the smaller one would be at most r/factor, which fails.
    """
    known, _, r = say_ends(larger[0], condition_number(larger[0], digits=15, equilibrate=larger[1]), larger[1])
    said = state_condition(smaller[0], Fraction(0), r / factor, equilibrate=smaller[1])
    return (known, said), {"kind": "all", "of": [certify_condition(known), certify_condition(said)]}


def entry(n: int, step: str, column: str, printed: str) -> Property:
    found = true_value(n, step, column)
    lower, upper = found.decimal(12)
    meaning = state_condition(entry_rows(n, step, column), *ends_of(printed), equilibrate=column in UNIT_COLUMNS)
    return fact(
        printed,
        in_printed_format(found, printed),
        "exact matrix, certified singular values",
        CERTIFIED,
        scope=f"n = {n}, rho = 1/6371000, tau = {STEPS[step]}",
        evidence=f"condition number in [{lower}, {upper}]; printed value off by "
        f"{float(relative_error(printed, found)):+.1e}",
        certificate=certify_condition(meaning),
        meaning=(meaning,),
    )


DISTORTED = (
    "the paper calls them distorted itself: ratio exceeds what doubles resolve, the least singular value is noise, and "
    "entries that must be equal differ; by hand: N_f has no tau in it, yet the rows of 0.2 s and 1 s differ"
)
ENTRIES = tuple(
    claim(
        f"table.n{n}.{step}.{column}{star}",
        f"Condition number of {column} for n = {n}, tau = {STEPS[step]} s" + (", as it should read" if star else ""),
        lambda place=(n, step, column, printed): entry(*place),
        expect=None if wrong else CERTIFIED,
        slip="paper" if wrong else None,
        reason=DISTORTED if wrong else "",
    )
    for star, rows in (("", PRINTED), ("*", CORRECTED))
    for (n, step), row in rows.items()
    for wrong in [not star and (n, step) in CORRECTED]
    for column, printed in zip(COLUMNS, row, strict=True)
)


# -- the Earth radius that the digits imply --------------------------------------------------------------


def fits(radius: Fraction) -> bool:
    """True when mu(N_p) with rho = 1/radius rounds to the printed digits for every n up to 10."""
    return all(entry_fits(n, step, radius) for n, step in PRINTED if n <= 10)


def entry_fits(n: int, step: str, radius: Fraction) -> bool:
    printed = PRINTED[n, step][0]
    found = condition_number(observability_rows(n, 1 / radius, STEPS[step]), digits=14)
    return in_printed_format(found, printed) == printed


def implied_radius(resolution: Fraction = Fraction(1, 10)) -> tuple[Fraction, Fraction]:
    """Ends, in metres, of the range of radii around 6371000 m that fits all ten entries; by bisection.

    The condition number grows with the radius there, so the fitting radii form one interval.
    """

    def end(inside: Fraction, outside: Fraction) -> Fraction:
        while abs(outside - inside) > resolution:
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if fits(middle) else (inside, middle)
        return inside

    return end(1 / RHO, Fraction(6370000)), end(1 / RHO, Fraction(6372000))
