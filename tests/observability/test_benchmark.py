"""The benchmark against sympy runs, agrees on the ranks and reports a ratio."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[1] / "benchmarks" / "observability.py"


@pytest.mark.long
def test_the_benchmark_prints_times_of_both_and_their_ratio():
    arguments = [sys.executable, str(SCRIPT), "--rounds", "1", "--limit", "20", "--only", "oscillators, 9"]
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=120, check=True)
    lines = done.stdout.strip().splitlines()
    assert len(lines) == 3
    assert all(re.search(r"ours +[\d.]+ ms +\S+ +[\d.]+ ms +[\d.]+ x$", line) for line in lines)
