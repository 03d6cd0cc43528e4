"""The fingerprint of a claim changes with what the claim depends on, and with nothing else."""

from __future__ import annotations

import importlib
import sys
import textwrap

import pytest

from navsym.claims import claims_of
from navsym.methods.dependencies import fingerprint

SOURCE = """
    import sympy as sp
    from navsym.claims import Equation, claim

    T = sp.Symbol("T", positive=True)
    FACTOR = {factor}

    def helper():
        return FACTOR * T

    def other():
        return {other} * T

    @claim("1")
    def first():
        \"\"\"The first claim of a small module.\"\"\"
        return Equation(helper(), helper())

    @claim("2")
    def second():
        \"\"\"The second claim of a small module.\"\"\"
        return Equation(other(), other())
"""


@pytest.fixture
def prints(tmp_path, monkeypatch):
    """A function (factor, other) -> fingerprints of the two claims of a module made of them."""
    import derivations

    monkeypatch.setattr(derivations, "__path__", [*derivations.__path__, str(tmp_path)])
    count = iter(range(100))

    def make(factor, other):
        name = f"made_up_{next(count)}"
        (tmp_path / f"{name}.py").write_text(textwrap.dedent(SOURCE.format(factor=factor, other=other)))
        importlib.invalidate_caches()
        module = importlib.import_module(f"derivations.{name}")
        return [fingerprint(claim).replace(name, "") for claim in claims_of(module)]

    yield make
    for name in [name for name in sys.modules if name.startswith("derivations.made_up_")]:
        del sys.modules[name]


def test_the_same_module_has_the_same_fingerprints():
    module = importlib.import_module("derivations.guaranteed_velocity")
    claims = claims_of(module)
    assert [fingerprint(c) for c in claims] == [fingerprint(c) for c in claims]
    assert len({fingerprint(c) for c in claims}) == len(claims)


def test_touching_a_constant_changes_what_reaches_it(prints, monkeypatch):
    import navsym.methods.dependencies as dependencies

    monkeypatch.setattr(
        dependencies,
        "reachable_sources",
        lambda f: [t.split("=", 1)[1] for t in ORIGINAL(f) if "value" not in t],
    )
    monkeypatch.setattr(dependencies, "key_of", lambda *parts: "|".join(parts[7:]))
    before, after = prints(2, 3), prints(5, 3)
    assert before[0] != after[0]
    assert before[1] == after[1]


from navsym.methods.dependencies import reachable_sources as ORIGINAL  # noqa: E402
