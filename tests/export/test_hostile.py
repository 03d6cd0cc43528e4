"""A user's formula exports as well as a paper's: awkward names, poles, every function, matrices, single precision."""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from navsym.cli.main import run
from navsym.export.languages.targets import TARGETS
from tests.export import programs

LANGUAGES = [n for n, tool in (("c", "gcc"), ("python", ""), ("javascript", "node")) if not tool or shutil.which(tool)]
EVERY = [n for n in TARGETS if TARGETS[n].executable() and n != "html"]


def exported(folder: Path, symbols: str, left: str, right: str, *words: str) -> tuple[int, Path]:
    file = folder / "mine.toml"
    given = {"left": left, "right": right}
    sides = "\n".join(f"{k} = {v if v.startswith('[') else json.dumps(v)}" for k, v in given.items())
    file.write_text(f'[symbols]\n{symbols}\n[[claim]]\nid = "it"\n{sides}\n')
    out = folder / "out"
    command = ["export", f"{file}:it", "--to", ",".join(LANGUAGES), "--vectors", "10", "--out", str(out), *words]
    return run([*command, "--json"]), out


@pytest.mark.parametrize(
    "names",
    [
        ("double", "int"),
        ("lambda", "E"),
        ("T", "t"),
        *(
            pytest.param(pair, marks=pytest.mark.slow)
            for pair in (
                ("I", "def"),
                ("x_", "x"),
                ("status", "r0"),
                ("t0", "nv_k"),
                ("value", "NaN"),
                ("self", "this"),
                ("function", "numbers"),
                ("navsym_sinc", "Math"),
                ("M_PI", "DBL_MAX"),
                ("np", "shape"),
                ("left", "every"),
                ("here", "Number"),
                ("errno", "r"),
                ("Ok", "w"),
                ("bad", "in"),
                ("n" * 64, "n" * 63 + "m"),
            )
        ),
    ],
)
def test_any_names_become_arguments(names: tuple[str, str], tmp_path: Path, capsys) -> None:
    a, b = names
    status, _ = exported(tmp_path, f'{a} = ["0", "2"]\n{b} = "real"', f"{a}*{b} + 2*{b}", f"({a} + 2)*{b}")
    document = json.loads(capsys.readouterr().out)
    assert status == 0, document
    assert [row["status"] for row in document["languages"]] == ["verified"] * len(LANGUAGES)


@pytest.mark.slow
def test_names_of_every_language_become_arguments_in_every_language(tmp_path: Path, capsys) -> None:
    names = [
        "M_PI",
        "DBL_MAX",
        "np",
        "shape",
        "left",
        "every",
        "here",
        "Number",
        "errno",
        "r",
        "Ok",
        "w",
        "bad",
        "main",
        "printf",
        "if",
        "n" * 64,
        "n" * 63 + "m",
    ]
    symbols = "\n".join(f'"{name}" = ["0", "2"]' for name in names)
    left, right = " + ".join(f"2*{n}" for n in names), f"2*({' + '.join(names)})"
    status, _ = exported(tmp_path, symbols, left, right, "--to", ",".join(EVERY))
    document = json.loads(capsys.readouterr().out)
    assert status == 0, document
    assert {row["status"] for row in document["languages"]} == {"verified"}


@pytest.mark.parametrize("name", ["__x", "q" * 200, "x y", "é", "1a", "a;b", "a\\nb", "pi", "sin"])
def test_names_that_are_none_are_refused(name: str, tmp_path: Path, capsys) -> None:
    status, out = exported(tmp_path, f'"{name}" = "real"', "2", "2")
    assert status == 2 and "expected" in json.loads(capsys.readouterr().out)["error"]["message"]
    assert not out.exists()


SLOWER = (
    ("tan(a/2)", "sin(a)/(1 + cos(a))"),
    ("cosh(a)**2 - sinh(a)**2 + tanh(a)", "1 + tanh(a)"),
    ("asin(p/4) + acos(p/4)", "acos(p/4) + asin(p/4)"),
    ("sqrt(a**2 + 1)**3", "(a**2 + 1)*sqrt(a**2 + 1)"),
    ("exp(a) - 1", "exp(a/2)**2 - 1"),
    ("(p + 1)**30", "(1 + p)**29*(p + 1)"),
    ('[["a", "p"], ["a*p", "1"]]', '[["a", "p"], ["p*a", "1"]]'),
    (" + ".join(f"sin({k}*a)*{k}" for k in range(1, 40)), " + ".join(f"{k}*sin({k}*a)" for k in range(1, 40))),
)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("2*atan2(a, p)", "atan2(a, p) + atan2(a, p)"),
        ("log(p) + log(p + 1)", "log(p + 1) + log(p)"),
        ("abs(a)*2", "abs(a) + abs(a)"),
        *(pytest.param(*sides, marks=pytest.mark.slow) for sides in SLOWER),
    ],
)
def test_every_function_of_the_language_leaves(left: str, right: str, tmp_path: Path, capsys) -> None:
    status, _ = exported(tmp_path, 'a = ["-3", "3"]\np = ["1/10", "2"]', left, right)
    document = json.loads(capsys.readouterr().out)
    assert status == 0, document
    assert all(row["status"] == "verified" for row in document["languages"])


def test_a_pole_comes_back_as_a_status_and_not_as_a_number(tmp_path: Path, capsys) -> None:
    status, out = exported(tmp_path, 'T = ["0", "2"]', "1/(T - 1)", "(T + 1)/(T**2 - 1)")
    assert status == 0
    spec = importlib.util.spec_from_file_location("pole", out / "python" / "navsym_functions.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    with np.errstate(all="ignore"), pytest.raises(ArithmeticError):
        module.mine_it(1.0)
    with pytest.raises(ValueError, match="T: expected"):
        module.mine_it(2.5)
    if shutil.which("gcc"):
        body = "double v = 7.0; return ((int)mine_it(1.0, &v) * 10) + (v == 7.0);"
        main = f'#include "mine_it.h"\nint main(void) {{ {body} }}\n'
        (out / "c" / "main.c").write_text(main)
        subprocess.run(["gcc", "mine_it.c", "main.c", "-o", "pole", "-lm"], cwd=out / "c", check=True, timeout=120)
        done = subprocess.run([str(out / "c" / "pole")], check=False, timeout=60)
        assert done.returncode == 21  # not finite, nothing written


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs a C compiler")
def test_single_precision_never_becomes_double(tmp_path: Path) -> None:
    from navsym.export.languages.c import files

    functions = [*programs.functions("pulsating-filter", "float"), *programs.functions("earth-geocentric", "float")]
    for name, text in files(functions, {f.name: [] for f in functions}, programs.LICENSE).items():
        (tmp_path / name).write_text(text)
    for f in functions:
        flags = ["-std=c99", "-Wdouble-promotion", "-Wfloat-conversion", "-Wconversion", "-Werror", "-S", "-O1"]
        subprocess.run(["gcc", *flags, f"{f.name}.c", "-o", f"{f.name}.s"], cwd=tmp_path, check=True, timeout=120)
        code = (tmp_path / f"{f.name}.s").read_text()
        assert not [word for word in ("cvtss2sd", "mulsd", "addsd", "divsd", "subsd", "sqrtsd") if word in code]
