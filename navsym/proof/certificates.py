"""Certificates of the algebraic verdicts, as plain data that ``navsym check`` replays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from navsym.errors import NavsymError
from navsym.text.expression import to_text


def identity_certificate(left: sp.Expr, right: sp.Expr) -> Mapping[str, Any] | None:
    """``left = right`` in the language of files; None when a side lies outside it."""
    symbols = sorted({s.name for s in left.free_symbols | right.free_symbols})
    try:
        return {"kind": "identity", "left": to_text(left), "right": to_text(right), "symbols": symbols}
    except NavsymError:
        return None
