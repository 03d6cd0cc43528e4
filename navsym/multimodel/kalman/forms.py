"""Forms in which a filter keeps covariances: Joseph's, roots by QR or by Potter, Bierman's UD.

A form is four operations on stacks of one kind of array. What the multiple-model filters do with them is the same.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError
from navsym.multimodel import moments as mixture
from navsym.multimodel.kalman import square_root
from navsym.multimodel.kalman import steps as kalman

Array = NDArray[np.floating[Any]]
Pair = tuple[Array, Array]


@dataclass(frozen=True, slots=True)
class Form:
    """How covariances are kept, (..., n, n) each.

    keep    : P -> what is kept ; show : what is kept -> P
    predict : (mean, kept, F, Q) -> mean, kept
    correct : (mean, kept, z, H, R) -> mean, kept, log-likelihood
    merge   : (weights (g, k), means (k, n), kept (k, n, n)) -> means (g, n), kept (g, n, n)
    """

    name: str
    keep: Callable[[Array], Array]
    show: Callable[[Array], Array]
    predict: Callable[[Array, Array, Array, Array], Pair]
    correct: Callable[[Array, Array, Array, Array, Array], tuple[Array, Array, Array]]
    merge: Callable[[Array, Array, Array], Pair]


def same(P: Array) -> Array:
    """The covariance itself."""
    return P


def ud_predict(mean: Array, UD: Array, F: Array, Q: Array) -> Pair:
    """Time update of a UD pair, by the triangle of [F U sqrt(D), root of Q]."""
    mean, S = square_root.predict_root(mean, square_root.root_of_ud(UD), F, Q)
    return mean, square_root.ud_of(S)


def ud_merge(weights: Array, means: Array, kept: Array) -> Pair:
    """Mixtures of UD pairs."""
    mean, S = square_root.merge_root(weights, means, square_root.root_of_ud(kept))
    return mean, square_root.ud_of(S)


def ud_keep(P: Array) -> Array:
    """UD pair of a covariance."""
    return square_root.ud_of(square_root.triangular_root(P))


def ud_show(UD: Array) -> Array:
    """Covariance of a UD pair."""
    return square_root.square(square_root.root_of_ud(UD))


ROOTS = (square_root.triangular_root, square_root.square, square_root.predict_root)
FORMS = {
    "joseph": Form("joseph", same, same, kalman.predict, kalman.correct, mixture.merge_groups),
    "qr": Form("qr", *ROOTS, square_root.correct_by_qr, square_root.merge_root),
    "potter": Form(
        "potter", *ROOTS, functools.partial(square_root.by_scalars, square_root.potter), square_root.merge_root
    ),
    "ud": Form(
        "ud", ud_keep, ud_show, ud_predict, functools.partial(square_root.by_scalars, square_root.bierman), ud_merge
    ),
}


def form_of(name: str) -> Form:
    """The form of a name; DomainError for another."""
    if not isinstance(name, str) or name not in FORMS:
        raise DomainError(f"form: expected one of {', '.join(FORMS)}; got {name!r}; choose one")
    return FORMS[name]
