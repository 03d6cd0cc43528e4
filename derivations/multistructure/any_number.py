"""The recurrences for any number of modes and of values of the state, by induction.

Every right side is a quotient of sums over modes and over values of the state, and so is Bayes' rule on the joint
table of the step; both are built term by term. A claim here says that the next term adds the same to both, whatever
stood there before (capital letters: sums so far, free), and that both are zero before the first term. That is an
induction over the number of modes and the number of values, with no bound on either; sums that converge, and
integrals, inherit it by linearity. :mod:`navsym_papers.multistructure.finite` decides the same for small sizes whole.
"""

from __future__ import annotations

import sympy as sp

from navsym.claims import Equation, claim

#: One pair of modes (i now, j before) and of values (x now, y before): transition density f, likelihood l,
#: p^ij, g^j(k-1) and pi^j[x(k-1) = y].
f, l, p, g, q = sp.symbols("f l p g q", positive=True)
#: Sums so far: over modes at one value, over values, of densities, of whole terms.
W, S, R, N, D = sp.symbols("W S R N D", nonnegative=True)
xi = sp.Symbol("xi", real=True)


def entry():
    """The entry of the joint table f[Y, x, i, y, j / Y_0^{k-1}]: the chain rule of the model."""
    return g * q * p * f * l


@claim("8.every")
def partial_posterior():
    """(8) for any number of modes and values: numerator and denominator grow by the entries of the joint table."""
    numerator_mode = l * f * (W + p * g * q) - l * f * W  # one mode more in the inner sum, at one value y
    numerator_value = l * (S + f * W) - l * S  # one value y more, its inner sum complete
    denominator_pair = (R + l * f * q) * p * g - R * p * g  # one pair (x, y) more in rho^ij
    denominator_mode = (D + R * p * g) - D  # one mode more, its rho^ij complete
    empty = [numerator_mode.subs({W: 0, p: 0}), (R * p * g).subs(R, 0)]
    return Equation(
        printed=[numerator_mode, numerator_value, denominator_pair, denominator_mode, *empty],
        derived=[entry(), l * f * W, entry(), R * p * g, 0, 0],
    )


@claim("10.every")
def mode_probability():
    """(10) for any number of modes and values: the weight rho^ij p^ij g^j is the sum of its entries."""
    pair = (R + l * f * q) * p * g - R * p * g
    return Equation(
        printed=[pair, (R * p * g).subs(R, 0), (N + R * p * g) / (D + R * p * g)],
        derived=[entry(), 0, (N + p * g * R) / (D + g * p * R)],
    )


@claim("11.every")
def mixture():
    """(11), summed over i, for any number of modes: g^i pi^i[x] is the entry of (x, i) over that of the evidence."""
    weight, whole = sp.symbols("w E", positive=True)
    inside = sp.Symbol("n", nonnegative=True)
    return Equation(
        printed=[S / whole + (weight / whole) * (inside / weight), 0 * whole], derived=[(S + inside) / whole, 0]
    )


@claim("12.every")
def estimate():
    """(12), summed over i, for any number of modes: g^i X^i is the share of mode i in the whole mean."""
    weight, whole = sp.symbols("w E", positive=True)
    moment, inside = sp.Symbol("M", real=True), sp.Symbol("n", nonnegative=True)
    one_value = (weight / whole) * ((moment + xi * inside) / weight)
    return Equation(
        printed=[one_value, S / whole + one_value],
        derived=[moment / whole + xi * inside / whole, (S + moment + xi * inside) / whole],
    )


@claim("13.sequences.every")
def sequences():
    """Below (13) for any number of sequences: P[sequence] times its estimate adds its share of the whole mean."""
    weight, whole = sp.symbols("w E", positive=True)
    moment, before = sp.symbols("M B", real=True)
    return Equation(printed=before / whole + (weight / whole) * (moment / weight), derived=(before + moment) / whole)


@claim("17.every")
def forgetful():
    """(15)-(17) for any number of modes: with p^ij = p^i the factor leaves the sums, and pi[x(k-1)] is the mixture."""
    numerator = l * f * (W + g * q) * p - l * f * W * p  # p^i times the likelihood times (15)'s integral
    weight = (R + l * f * q * g) * p - R * p  # p^i rho^i, rho^i over the mixture of all j
    return Equation(printed=[numerator, weight, p * (S + R * g) - p * S], derived=[entry(), entry(), p * g * R])


@claim("21.every")
def frozen():
    """(20), (21) for any number of modes: with (19) a mode j other than i adds nothing, and i adds its own entries."""
    other = (S + R * 0 * g) - S
    own = (S + R * 1 * g) - S
    return Equation(
        printed=[other, own, l * (W + f * q) - l * W], derived=[entry().subs(p, 0), R * g, (entry() / g).subs(p, 1)]
    )


@claim("5.every")
def prediction():
    """(5), (14), (19) for any number of modes: one mode j more adds p^ij P[I = j]; p^i P[I = j]; its own or nothing."""
    before, start, share = sp.symbols("B s c", nonnegative=True)
    # c: probability of the modes so far, which is 1 when all have come.
    return Equation(
        printed=[(before + p * start) - before, p * (share + start), before + 0 * start, before + 1 * start],
        derived=[p * start, p * share + p * start, before, before + start],
    )
