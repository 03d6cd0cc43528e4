"""Functions that formulas of code have besides those of sympy, and what they mean."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp


class expm1(sp.Function):
    """exp(x) - 1."""


class filled(sp.Function):
    """filled(Lambda(t, b), k, u) = b(u)/u^k, and its limit at u = 0."""

    nargs = 3


def meaning(part: sp.Lambda, k: sp.Integer, u: sp.Expr) -> sp.Expr:
    """The formula of ``filled``."""
    return part(u) / u**k


MEANING: dict[type, Callable[..., sp.Expr]] = {expm1: lambda x: sp.exp(x) - 1, filled: meaning}


def plain(expression: sp.Expr) -> sp.Expr:
    """The expression with the functions of this file written out."""
    return expression.replace(lambda node: type(node) in MEANING, lambda node: MEANING[type(node)](*node.args))
