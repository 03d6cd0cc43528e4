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
    call(elsewhere, "navsym", "init", "--examples", where=".")
    assert "REFUTED" in call(elsewhere, "navsym", "prove", "examples/formulas.toml", status=1, where=".")
    work = elsewhere / "work Ö"
    (work / "claims" / "angles.claims.toml").write_text(CLAIMS)
    places = "import navsym, navsym_papers as p; print(navsym.__file__, *p.__path__, sep='\\n')"
    assert all(line.startswith(str(elsewhere)) for line in call(elsewhere, "python", "-c", places).splitlines())
    found = json.loads(call(elsewhere, "navsym", "verify", "--json"))
    assert found["counts"]["OPEN"] == 0 and {claim["paper"] for claim in found["claims"]} == {
        "claims/angles.claims.toml",
        "claims/baro.toml",
        "models/alignment.toml",
        "audits/ekf.toml",
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
    assert written == {"navsym.toml", "claims", "models", "audits", "papers", "schemas", ".taplo.toml"} | made


FORMULAS = r"""\frac{P}{P + R} + \frac{R}{P + R} = 1
\left(1 - \frac{P}{P + R}\right) P = \frac{P R}{P + R}
\left(\frac{1}{P} + \frac{1}{R}\right)^{-1} = \frac{P R}{P + R}
\frac{P R}{P + R} < P
\frac{P R}{P + R} < R
a^2 P + Q \ge Q
\frac{P (Q + R)}{P + Q + R} > \frac{P R}{P + R}
\left(1 - \frac{P}{P + R}\right)^2 P + \left(\frac{P}{P + R}\right)^2 R = \frac{P R}{P + R}
\sin 2 a = 2 \sin a \cos a
1 - \cos a = \sin^2 \frac{a}{2}""".splitlines()


@pytest.mark.long
def test_ten_commands_from_a_paper_of_ten_formulas_to_exported_c(elsewhere):
    """Own paper with one misprint, own model, an audit of code with one fault, a guard, the report and C, in order."""
    call(elsewhere, "navsym", "init", "ten", where=".")
    work = elsewhere / "ten"
    (work / "paper.md").write_text("\n\n".join(f"$${formula}$$" for formula in FORMULAS) + "\n")
    (work / "symbols.toml").write_text('[symbols]\na = "real"\nP = "positive"\nQ = "positive"\nR = "positive"\n')
    (work / "ranges.csv").write_text("t,velocity\n0,0.1\n0.5,0.2\n1,0.25\n1.5,0.3\n")
    for name in ("yaw_jacobian.c", "yaw_jacobian.toml"):
        (work / "audits" / name).write_bytes((ROOT / "examples" / "audit" / name).read_bytes())

    def navsym(*words, status=0):
        return call(elsewhere, "navsym", *words, status=status, where="ten")

    said = navsym("read", "paper.md", "--symbols", "symbols.toml", "--out", "claims/paper.toml")
    assert "10 of 10 formulas read" in said
    assert "write -v * sinf(x[2]) * dt" in navsym("audit", "audits/yaw_jacobian.toml", status=1)
    assert "CERTIFIED" in navsym("solve", "models/alignment.toml", "--target", "drift")
    assert "2 with an estimate" in navsym("guard", "models/alignment.toml", "--data", "ranges.csv", "--target", "drift")
    found = json.loads(navsym("verify", "--write", "--json", status=1))
    statuses = [claim["status"] for claim in found["claims"] if claim["paper"] == "claims/paper.toml"]
    assert statuses == ["PROVED"] * 9 + ["REFUTED"]
    assert "At a = 1:" in navsym("explain", "claims/paper.toml:paper:19.1", status=1)
    navsym("report", "--from", "ledger.json", status=1)
    (sheet,) = (work / "report").glob("claims_paper*.erratum.tex")
    assert r"\cos" in sheet.read_text(encoding="utf-8")
    navsym("export", "claims/paper.toml:paper:15.1", "--to", "c", "--out", "code")
    assert "REJECTED" not in navsym("check", "code") and list((work / "code" / "c").glob("*.c"))
