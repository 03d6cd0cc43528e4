"""The pytest plugin: one test a claim, the budget, and what a user without hypothesis gets."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import navsym as nav
from navsym.testing import ClaimFailedError, assert_claim
from navsym.testing.assertions import BUDGET

ROOT = Path(__file__).resolve().parents[2]
CLAIMS = """\
[symbols]
a = "real"
[[claim]]
id = "double"
left = "sin(2*a)"
right = "2*sin(a)*cos(a)"
[[claim]]
id = "wrong"
left = "sin(2*a)"
right = "2*sin(a)"
[[claim]]
id = "known-to-be-wrong"
left = "cos(2*a)"
right = "2*cos(a)"
expect = "REFUTED"
[[claim]]
id = "said-to-be-wrong"
left = "a + a"
right = "2*a"
expect = "REFUTED"
"""
TESTS = """\
import sys
sys.modules["hypothesis"] = None
from navsym.testing import assert_claim

def test_text():
    assert_claim("sin(T) <= T", T=("0", "pi"))

def test_budget():
    from navsym.testing.assertions import BUDGET
    assert BUDGET.get() == 7.0
"""


def pytest_run(folder, *words):
    """A run of pytest as a user has it: the plugin, and none of the project's own settings."""
    plugin = ["-p", "no:navsym", "-p", "navsym.testing.plugin", "-p", "no:cacheprovider", "-p", "no:hypothesispytest"]
    words = [sys.executable, "-m", "pytest", "-v", "-rf", *plugin, "-c", os.devnull, "--rootdir", folder, *words, "."]
    settings = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(words, cwd=folder, env=settings, capture_output=True, text=True, check=False, timeout=300)


def test_each_claim_is_one_test_and_a_wrong_one_shows_its_counterexample(tmp_path):
    (tmp_path / "angles.claims.toml").write_text(CLAIMS)
    (tmp_path / "broken.claims.toml").write_text("[[claim]\n")
    (tmp_path / "other.toml").write_text("[[claim]\n")
    (tmp_path / "test_mine.py").write_text(TESTS)
    done = pytest_run(tmp_path, "--navsym-budget", "7", "--continue-on-collection-errors")
    said = done.stdout
    assert "angles.claims.toml::double PASSED" in said and "angles.claims.toml::known-to-be-wrong PASSED" in said, said
    assert "angles.claims.toml::wrong FAILED" in said and "REFUTED at a = " in said
    assert "angles.claims.toml::said-to-be-wrong FAILED" in said and "declared REFUTED" in said
    assert "test_text PASSED" in said and "test_budget PASSED" in said
    assert "ERROR collecting broken.claims.toml" in said and "expected TOML" in said and "Traceback" not in said
    assert "4 passed" in said and "2 failed" in said and "1 error" in said


def test_a_budget_that_is_none_is_refused(tmp_path):
    done = pytest_run(tmp_path, "--navsym-budget", "-1")
    assert done.returncode == 4 and "--navsym-budget: expected seconds above 0; got -1; write" in done.stderr


def test_a_claim_is_asserted_by_its_id(tmp_path, monkeypatch):
    monkeypatch.chdir(nav.init(tmp_path / "w").root)
    assert assert_claim("claims/baro.toml:ratio").status == "PROVED"
    assert assert_claim("claims/baro.toml:linear").status == "REFUTED"  # as declared
    text = Path("claims/baro.toml").read_text()
    Path("claims/baro.toml").write_text(text.replace('right = "exp(-d)"', 'right = "exp(-h)"'))
    with pytest.raises(ClaimFailedError, match=r"claims/baro\.toml:ratio, declared PROVED"):
        assert_claim("claims/baro.toml:ratio")
    with pytest.raises(nav.NavsymError, match=r"take one of claims/baro\.toml:ratio"):
        assert_claim("claims/baro.toml:rat")


def test_a_formula_as_text_fails_with_its_counterexample():
    with pytest.raises(ClaimFailedError, match="REFUTED at a = "):
        assert_claim("sin(2*a) = 2*sin(a)")
    with pytest.raises(nav.NavsymError, match="expected"):
        assert_claim("sin(2*a")


def test_a_claim_above_its_budget_is_open():
    token = BUDGET.set(0.05)
    try:
        with pytest.raises(ClaimFailedError, match="OPEN"):
            assert_claim("x**3 + y**3 + z**3 >= 3*x*y*z", x="positive", y="positive", z="positive")
    finally:
        BUDGET.reset(token)
