"""For a user's own tests: assertions that decide formulas, a pytest plugin, and hypothesis strategies.

``assert_claim`` puts a formula through the same door as the claims of the papers and fails with the counterexample::

    from navsym.testing import assert_claim

    def test_triple_angle():
        assert_claim("sin(3*a) = 3*sin(a) - 4*sin(a)**3")

``assert_audited`` does the same for the questions of a specification about source code, with file and line.

The plugin makes one test of each claim in files named ``*.claims.toml``. Strategies draw exact models, intervals and
angles for the symbolic side, and covariances and transition matrices as arrays for the numerical side; only they need
the package ``hypothesis``.
"""

from __future__ import annotations

from typing import Any

_STRATEGIES = "angles covariances intervals matrices mode_transitions model_of models rationals".split()
_HOMES = {
    **dict.fromkeys(
        ("AuditFailedError", "ClaimFailedError", "assert_audited", "assert_claim"), "navsym.testing.assertions"
    ),
    **dict.fromkeys(_STRATEGIES, "navsym.testing.strategies"),
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """A helper, imported when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module 'navsym.testing' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
