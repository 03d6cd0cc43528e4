"""Two versions of navsym at work in one store at the same time: each checks what the other kept, nothing is lost."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CLAIMS = 6
PAPER = f'''"""A paper of a few identities."""

import sympy as sp

from navsym.claims import PROVED, Claim, Equation, Paper

a = sp.Symbol("a", real=True)
PAPER = Paper("tiny", "Tiny", (), 2026, "none", "English", equations=())


def identity(k):
    return lambda: Equation(printed=sp.sin(a) ** 2 + k, derived=1 + k - sp.cos(a) ** 2)


IDENTITIES = tuple(Claim("tiny", str(k), "An identity.", identity(k), expect=PROVED) for k in range({CLAIMS}))
'''
#: The other version decides alike and says so in other words.
OTHER = '''

first = decide


def decide(statement, **limits):
    """As before, in other words."""
    import dataclasses

    return dataclasses.replace(first(statement, **limits), evidence="said by the other version")
'''


@pytest.fixture
def versions(tmp_path):
    """Two checkouts with the same small paper, which differ in a line of the room that decides."""
    folders = tmp_path / "one", tmp_path / "other"
    for folder in folders:
        shutil.copytree(ROOT / "navsym", folder / "navsym", ignore=shutil.ignore_patterns("__pycache__"))
        (folder / "navsym_papers").mkdir()
        shutil.copy(ROOT / "derivations" / "__init__.py", folder / "navsym_papers")
        (folder / "navsym_papers" / "tiny.py").write_text(PAPER, encoding="utf-8")
    with (folders[1] / "navsym" / "prove" / "ladder.py").open("a", encoding="utf-8") as file:
        file.write(OTHER)
    return folders


def started(folder, store):
    environment = {**os.environ, "NAVSYM_CACHE": str(store), "PYTHONPATH": str(folder)}
    command = [sys.executable, "-m", "navsym", "verify", "tiny", "--jobs", "1", "--json"]
    return subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def verified(folders, store):
    """What each version says, all of them at work at the same time, and what it remarks."""
    running = [started(folder, store) for folder in folders]
    try:
        told = [process.communicate(timeout=300) for process in running]
    finally:
        for process in running:
            process.kill()
    assert [process.returncode for process in running] == [0] * len(running), told
    return [json.loads(said)["claims"] for said, _ in told], [remark for _, remark in told]


@pytest.mark.long
def test_the_certificates_of_one_version_are_checked_by_the_other_and_none_is_lost(versions, tmp_path):
    first, _ = verified(versions, tmp_path / "store")
    again, remarks = verified(versions, tmp_path / "store")
    for claims in (*first, *again):
        assert [claim["status"] for claim in claims] == ["PROVED"] * CLAIMS
    assert all(f"granted {CLAIMS} of {CLAIMS}" in remark for remark in remarks)
