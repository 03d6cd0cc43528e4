"""The benchmark against sympy runs and reports a ratio."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[1] / "benchmarks" / "transition.py"


@pytest.mark.long
def test_the_benchmark_prints_times_of_both_and_their_ratio():
    arguments = [sys.executable, str(SCRIPT), "--rounds", "1", "--limit", "20", "--only", "oscillator, 2"]
    run = subprocess.run(arguments, capture_output=True, text=True, timeout=60, check=True)
    lines = run.stdout.strip().splitlines()
    assert len(lines) == 2
    assert all(re.search(r"ours +[\d.]+ ms +sympy +[\d.]+ ms +[\d.]+ x$", line) for line in lines)
