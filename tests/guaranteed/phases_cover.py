"""What an answer of ``phases`` covers, counted again from closed forms, certificates and the holes that it names."""

from __future__ import annotations

import sympy as sp

from navsym.core.exact import to_rational

#: Ends of regimes and holes are printed with 34 digits.
PRINTED = sp.Rational(1, 10**30)


def gaps(known, lower, upper):
    """What stretches leave of a range."""
    left, at = [], sp.Rational(lower)
    for a, b in [*sorted((sp.Rational(a), sp.Rational(b)) for a, b in known), (upper, upper)]:
        left += [(at, min(a, upper))] if at < min(a, upper) else []
        at = max(at, b)
    return left


def followed_pieces(answer):
    """The stretches of the parameter on which contacts are followed, from the certificates."""
    ranges = [one for c in answer.certificates() for one in c.get("of", [c]) if one["kind"] == "range"]
    return [(piece["from"], piece["to"]) for one in ranges for piece in one["pieces"]]


def lost(answer):
    """Stretches of the range that no closed form, piece or sliver covers and ``uncovered`` does not name."""
    known = followed_pieces(answer)
    known += [(to_rational(s.start), to_rational(s.end)) for r in answer.regimes for s in r.slivers]
    known += [(decimal(r.lower), decimal(r.upper)) for r in answer.regimes if r.closed is not None]
    known += [tuple(decimal(sp.sympify(end, rational=True)) for end in pair) for pair in answer.uncovered]
    return [(a, b) for a, b in gaps(known, decimal(answer.lower), decimal(answer.upper)) if b - a > PRINTED]


def decimal(end):
    """An end as a rational number, to 60 digits."""
    return end if end.is_Rational else sp.Rational(str(sp.N(end, 60)))
