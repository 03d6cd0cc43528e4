"""The filters as truncations of one exact recursion, and the room that they need."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from navsym.core.errors import DomainError, TooLargeError

# The exact posterior after k steps is a mixture with one Gaussian for every sequence of modes. Every filter
# here branches that mixture, weighs the branches by their likelihoods, and then *folds*: it replaces groups
# of Gaussians by one with the same mean and covariance. The groups are all that tells the filters apart:
#
# =============  ==============================  =============================  ======================
# method         branches                        fold                           filters per step
# =============  ==============================  =============================  ======================
# exact          every hypothesis, every mode    none                           m^k
# k-pulsating    every hypothesis, every mode    all into one, every K steps    m, m^2, ..., m^K
# pulsating      every hypothesis, every mode    all into one, every step       m        (GPB1, K = 1)
# gpb2           every hypothesis, every mode    by last mode, every step       m^2
# imm            one per mode, mixed beforehand  by last mode (nothing to do)   m
# polygaussian   one per mode, never mixed       none                           m        (static bank)
# =============  ==============================  =============================  ======================


Branching = Literal["cross", "mixed", "own"]
Folding = Literal["none", "all", "by mode"]

#: Bytes that the hypotheses of one step may take.
MEMORY_LIMIT = 2**30


@dataclass(frozen=True, slots=True)
class Scheme:
    """How a filter truncates.

    branching : "cross" every Gaussian with every mode; "mixed" one Gaussian per next mode, mixed from all;
                "own" each Gaussian keeps its mode
    folding   : "none", "all" into one, "by mode" into one per last mode
    period    : steps between folds
    """

    name: str
    branching: Branching
    folding: Folding
    period: int = 1


SCHEMES = {
    "exact": Scheme("exact", "cross", "none"),
    "pulsating": Scheme("pulsating", "cross", "all"),
    "k-pulsating": Scheme("k-pulsating", "cross", "all", 2),
    "gpb2": Scheme("gpb2", "cross", "by mode"),
    "imm": Scheme("imm", "mixed", "by mode"),
    "polygaussian": Scheme("polygaussian", "own", "none"),
}


def scheme(method: str, depth: int | None = None) -> Scheme:
    """The scheme of a method; ``depth`` is K and belongs to k-pulsating (default 2).

    Raises DomainError for an unknown method, a depth below one, or a depth where none belongs.
    """
    if not isinstance(method, str) or method not in SCHEMES:
        raise DomainError(f"method: expected one of {', '.join(SCHEMES)}; got {method!r}; choose one")
    known = SCHEMES[method]
    if depth is None:
        return known
    if method != "k-pulsating":
        raise DomainError(f"depth: expected none with {method}; got {depth}; it belongs to k-pulsating")
    if isinstance(depth, bool) or not isinstance(depth, int) or depth < 1:
        raise DomainError(f"depth: expected a whole number of steps from 1 on; got {depth!r}; give K >= 1")
    return replace(known, period=depth)


def filters_at(rule: Scheme, modes: int, roots: int, step: int) -> int:
    """One-step Kalman filters that run in step ``step`` = 1, 2, ..., starting from ``roots`` Gaussians.

    multistructure:count.sequences and multistructure:count.K
    """
    if rule.branching != "cross":
        return modes
    if rule.folding == "none":
        return roots * modes**step
    if rule.folding == "by mode":
        return (roots if step == 1 else modes) * modes
    inside = (step - 1) % rule.period + 1
    return (roots if step <= rule.period else 1) * modes**inside


def require_room(rule: Scheme, modes: int, states: int, roots: int, steps: int) -> int:
    """Filters run in all steps together; TooLargeError when the widest step does not fit in memory.

    The error names the count, so that K or the number of steps can be chosen.
    """
    widest = max((filters_at(rule, modes, roots, k) for k in widest_steps(rule, steps)), default=0)
    need = widest * 8 * (4 * states * states + 2 * states + 2 * modes)
    if need > MEMORY_LIMIT:
        raise TooLargeError(
            f"{rule.name}: expected hypotheses that fit in {MEMORY_LIMIT // 2**20} MiB; got {write_count(widest)} "
            f"hypotheses of {states} states; choose a smaller depth, fewer steps, or a folding method"
        )
    return sum(filters_at(rule, modes, roots, k) for k in range(1, steps + 1))


def widest_steps(rule: Scheme, steps: int) -> list[int]:
    """Steps among which the widest is: the last of an exact tree, the last of the first fold, the second."""
    last = min(steps, rule.period) if rule.folding == "all" else steps
    return [k for k in sorted({1, 2, last, steps}) if 1 <= k <= steps]


def write_count(count: int) -> str:
    """A count for people: in full up to 20 digits, then as a power of ten."""
    text = str(count) if count < 10**4000 else ""
    if text and len(text) <= 20:
        return text
    digits = count.bit_length() * 30103 // 100000
    return f"about 10^{digits}"
