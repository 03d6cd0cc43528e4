"""How far a pattern of contacts is followed: pieces of a range next to each other, as long as they pass."""

from __future__ import annotations

from collections.abc import Callable

from flint import arb, fmpq

from navsym.proof.optimality.enclosure import rational
from navsym.proof.optimality.moving import Member
from navsym.proof.optimality.range import Piece, Track, piece

MOST_PIECES = 200
#: Halvings of a step before the march gives up.
MOST_FAILURES = 12
#: Nearer to the end of a regime than this part of it, a sliver takes over.
NEAREST = fmpq(1, 10**16)


def never() -> bool:
    """No limit is met."""
    return False


def always(piece: Piece) -> bool:
    """Every piece is accepted."""
    return True


Accepts = Callable[[Piece], bool]


def follow(
    track: Track, lower: fmpq, upper: fmpq, enough: Callable[[], bool] = never, accepts: Accepts = always
) -> list[Piece]:
    """Pieces from the middle towards both ends, each as long as its tests allow and accepted, until it is enough."""
    middle = simple((lower + upper) / 2, upper - lower)
    member = track.first(middle)
    if member is None:
        return []
    up = march(track, member, middle, upper, MOST_FAILURES, enough, accepts)
    down = march(track, up[0].ends[0] if up else member, middle, lower, MOST_FAILURES, enough, accepts)
    return [*reversed(down), *up]


def march(
    track: Track,
    member: Member,
    at: fmpq,
    last: fmpq,
    failures: int = MOST_FAILURES,
    enough: Callable[[], bool] = never,
    accepts: Accepts = always,
) -> list[Piece]:
    """Pieces from ``at`` to ``last``, upwards or downwards; given up after ``failures`` halvings of one step, and when
    it is enough.

    accepts : what else a piece has to pass

    Towards the end of a regime a weight, the room of a contact or the room below the bound shrinks to nothing;
    a piece may then be about as long as the root of what is left behind it, so steps square their distance.
    """
    pieces: list[Piece] = []
    span = abs(last - at)
    step, failed = span / 3, 0
    while at != last and len(pieces) < MOST_PIECES and failed < failures and not enough():
        made = None
        for end in ends_to_try(at, last, step, span):
            made = piece(track, member, at, end)
            if made is not None and accepts(made):
                break
            made = None
        if made is None:
            if abs(last - at) < span * NEAREST:
                break
            step, failed = step / 2, failed + 1
            continue
        pieces.append(made)
        step = step * (fmpq(5, 4) if failed == 0 else 1)
        failed = 0
        at, member = end, made.ends[1 if end > at else 0]
    return pieces


def ends_to_try(at: fmpq, last: fmpq, step: fmpq, span: fmpq) -> list[fmpq]:
    """The next end; near the last one that first, then one with the distance to it raised to the power 3/2."""
    rest, side = abs(last - at), 1 if last > at else -1
    if step * fmpq(9, 8) < rest:
        return [simple(at + side * step, step)]
    near = rest * rational(arb(rest / span).sqrt()) / 2
    if rest < span * NEAREST:
        return [last]
    return [last, simple(last - side * near, near), simple(at + side * rest / 2, rest)]


def simple(x: fmpq, step: fmpq) -> fmpq:
    """A short decimal near x, well within the step."""
    unit = fmpq(1)
    while unit > step / 16:
        unit = unit / 10
    return unit * (x / unit).floor()
