"""The built wheel alone, in an environment and a folder elsewhere: a workspace from the first command to the report."""

from __future__ import annotations

import json
import os
import site
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CLAIMS = '[symbols]\na = "real"\n[[claim]]\nid = "double"\nleft = "sin(2*a)"\nright = "2*sin(a)*cos(a)"\n'


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """An environment with the wheel; packages that it needs are those of this one, without its editable installs."""
    folder = tmp_path_factory.mktemp("elsewhere")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, capture_output=True, check=True, timeout=300)
    (wheel,) = folder.glob("*.whl")
    venv.create(folder / "env", with_pip=False, symlinks=True)
    python = folder / "env" / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--no-deps", "--no-index", "-q", str(wheel)]
    subprocess.run(pip, cwd=folder, check=True, capture_output=True, timeout=300)
    (packages,) = (folder / "env" / "lib").glob("python*/site-packages")
    (packages / "others.pth").write_text("\n".join(site.getsitepackages()) + "\n")
    (folder / "home").write_text("a home in which nothing can be written, whoever asks")
    return folder


def call(folder, *words, status=0, where="work Ö"):
    """Standard output of a program of the environment, in the workspace."""
    settings = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "NAVSYM", "XDG"))}
    settings |= {"HOME": str(folder / "home"), "NO_COLOR": "1", "MPLBACKEND": "Agg"}
    program = [str(folder / "env" / "bin" / words[0]), *words[1:]]
    done = subprocess.run(
        program, cwd=folder / where, env=settings, capture_output=True, text=True, check=False, timeout=600
    )
    assert done.returncode == status, done.stdout[-2000:] + done.stderr[-4000:]
    return done.stdout


@pytest.mark.long
def test_the_wheel_alone_is_enough_for_a_workspace(elsewhere):
    call(elsewhere, "navsym", "init", "work Ö", where=".")
    work = elsewhere / "work Ö"
    (work / "claims" / "angles.claims.toml").write_text(CLAIMS)
    places = "import navsym, navsym_papers as p; print(navsym.__file__, *p.__path__, sep='\\n')"
    assert all(line.startswith(str(elsewhere)) for line in call(elsewhere, "python", "-c", places).splitlines())
    found = json.loads(call(elsewhere, "navsym", "verify", "--json"))
    assert found["counts"]["OPEN"] == 0 and {claim["paper"] for claim in found["claims"]} == {
        "claims/angles.claims.toml",
        "claims/baro.toml",
        "models/alignment.toml",
        "pendulum",
    }
    assert json.loads(call(elsewhere, "navsym", "list", "--json"))["claims"][0]["decided"]
    call(elsewhere, "navsym", "report", "--from", "ledger.json")
    call(elsewhere, "navsym", "export", "claims/angles.claims.toml:double", "--to", "python", "--out", "code")
    call(elsewhere, "navsym", "check", "code")
    said = call(elsewhere, "python", "-m", "pytest", "-v", "-p", "no:cacheprovider", "claims")
    assert "angles.claims.toml::double PASSED" in said
    call(elsewhere, "navsym", "show", "alpha_beta_filter:12.stable")
    written = {path.name for path in work.iterdir()}
    made = {"ledger.json", "certificates.json", ".navsym", "report", "code"}
    assert written == {"navsym.toml", "claims", "models", "audits", "papers"} | made
