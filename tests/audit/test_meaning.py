"""Units of source code: right code is left alone, slips of powers and of declared units are found with their line."""

from __future__ import annotations

import random
import re
from itertools import islice
from pathlib import Path

import pytest

import navsym as nav
from navsym.audit.answer import read_blocks, read_sources
from navsym.audit.meaning import list_meaningless
from navsym.audit.questions import list_entries, read_question
from navsym.core.errors import NavsymError
from navsym.language.tomlfile import read_toml

EXAMPLES = Path(__file__).parents[2] / "examples" / "audit"
M, S, V, A, W, RAD = "m", "s", "m/s", "m/s^2", "rad/s", "rad"
CAR = {"x[0]": M, "x[1]": M, "x[2]": RAD, "dt": S, "xn[0]": M, "xn[1]": M}
#: Example -> the units of its names.
UNITS = {
    "yaw_jacobian": {**CAR, "x[3]": V},
    "gallery/bearing_speed": {**CAR, "u[0]": V, "u[1]": W},
    "gallery/bias_prior": {"prior": W, "bias": W, "error": W},
    "gallery/body_velocity": {"a": RAD, "v": V, "dt": S, "dx": M},
    "gallery/coriolis": {"f": A, "g": A, "v": V, "wen": W, "wie": W, "fc": A},
    "gallery/coriolis_frame": {"R": "1", "earth": W, "v": V, "dt": S, "dv": V},
    "gallery/earth_rate": {"angle": RAD, "R": "1", "earth": W, "dt": S, "corrected": RAD},
    "gallery/euler_rates": {"x": RAD, "w": W, "dt": S, "xn": RAD},
    "gallery/gravity_sign": {"pitch": RAD, "roll": RAD, "g": A, "a": A},
    "gallery/horizontal_field": {"hx": "uT", "hy": "uT", "two_bx": "uT", "return": "uT"},
    "gallery/innovation_variance": {"P": "m^2", "R": "m^2", "H": "1", "var": "m^2"},
    "gallery/joseph_column": {"P": "m^2", "K": "1", "r": "m^2"},
    "gallery/magnetic_reference": {"R": "1", "m": "uT", "return": "uT"},
    "gallery/magnetometer_fit": {"m": "uT", "o": "uT", "radius": "uT", "r": "uT", "J": "1"},
    "gallery/normal_gravity": {"return": A, "sin_lat": "1", "equator": A, "factor": "1", "e2": "1"},
    "gallery/process_noise": {
        "dt": S, "variance": "m^2/s^4", "return[0]": "m^2", "return[1]": "m^2/s", "return[2]": "m^2/s^2",
    },
    "gallery/quaternion_rate": {"q": "1", "w": W, "dq": "1/s"},
    "gallery/radial_distortion": {"x": M, "k[0]": "1/m^2", "k[1]": "1/m^4", "d": M},
    "gallery/quaternion_correction": {"q": "1", "e": W, "d": W},
    "gallery/gravity_objective": {"q": "1", "a": "1"},
    "gallery/matrix_to_quaternion": {"q": "1", "p": "1"},
    "gallery/mirrored_matrix": {"q": "1", "R": "1"},
    "gallery/pose_residual": {"q": "1", "p": "1"},
    "gallery/product_in_place": {"a": "1", "b": "1"},
    "gallery/rotation_sign": {"q": "1"},
}  # fmt: skip
#: Those whose fault is a power, so that the version before it is meaningless.
SLIPS = {"bearing_speed", "innovation_variance", "process_noise", "radial_distortion"}


def declared(name, units=None, version="after"):
    """The specification of one version of an example with units, and the example's text."""
    document = read_toml(EXAMPLES / f"{name}.toml")
    for key in ("code", "question"):
        named = [block for block in document[key] if block["name"] in (version, "wanted")]
        document[key] = named or document[key]
    for code in document["code"]:
        symbols = code.setdefault("symbols", {})
        for spelling, unit in (UNITS[name] if units is None else units).items():
            said = symbols.get(spelling, {})
            said = {"range": said} if isinstance(said, list) else {"sign": said} if isinstance(said, str) else said
            symbols[spelling] = {**said, "unit": unit}
    return document


def meaningless(document, folder):
    """Place and reason of what the units of a specification do not allow."""
    names, sources = read_sources(document, folder, "spec")
    blocks = read_blocks(document, "question", "spec")
    questions = [read_question(b, sources, names, folder, f"question[{i}]") for i, b in enumerate(blocks)]
    return list_meaningless(names, [*sources.values()], [e for q in questions for e in list_entries(q)])


@pytest.mark.parametrize("name", UNITS)
def test_right_code_with_units_is_left_alone(name):
    assert meaningless(declared(name), (EXAMPLES / name).parent) == []


@pytest.mark.parametrize("name", [name for name in UNITS if name.startswith("gallery/")])
def test_a_fault_of_sign_has_no_wrong_unit_and_a_fault_of_power_has(name):
    found = meaningless(declared(name, version="before"), (EXAMPLES / name).parent)
    assert bool(found) == (Path(name).name in SLIPS), found


# -- mutants -------------------------------------------------------------------------------------------


def mutants(source, folder):
    """Endless random slips: what was changed, and a specification of the changed code or units."""
    while True:
        name = source.choice([name for name, units in UNITS.items() if {*units.values()} - {"1"}])
        units = UNITS[name]
        document = declared(name)
        path = (EXAMPLES / name).parent / document["code"][0]["file"]
        text = path.read_text(encoding="utf-8")
        if source.random() < 1 / 3:
            changed = source.choice([name for name, unit in units.items() if unit not in ("1", RAD)] or [*units])
            unit = f"{units[changed]} {source.choice(('m', 's'))}^{source.choice((-1, 1))}"
            document = declared(name, {**units, changed: unit})
            what = f"{name}: {changed} in {unit}"
        else:
            start = max(
                text.find(f"{word} {function}")
                for word in ("void", "double", "fn", "def", "Vector3f", "Vector3d", "Matrix3d", "=")
                for function in ("after(", "predict(")
            )
            places = [
                (found, spelling)
                for spelling, unit in units.items()
                if unit not in ("1", RAD)
                for found in re.finditer(rf"(?<![\w.]){re.escape(spelling)}(?![\w])(\[\d\]|\(\d(, \d)?\))?", text)
                if found.start() > start
                and re.search(r"=|return", text[text.rfind("\n", 0, found.start()) : found.start()])
            ]
            if not places:
                continue
            found, spelling = source.choice(places)
            if not found[1] and path.suffix in (".m", ".cpp") and spelling not in ("dt", "r"):
                continue  # a square of a vector is nothing
            text = text[: found.start()] + f"({found[0]} * {found[0]})" + text[found.end() :]
            what = f"{name}: {spelling} at {text[: found.start()].count(chr(10)) + 1} squared"
        (folder / path.name).write_text(text, encoding="utf-8")
        yield what, document


@pytest.mark.parametrize("count", [30, pytest.param(250, marks=pytest.mark.long)])
def test_slips_of_powers_and_units_are_noticed(count, tmp_path):
    slips = mutants(random.Random(count), tmp_path)
    missed = [what for what, document in islice(slips, count) if not meaningless(document, tmp_path)]
    assert len(missed) <= count * 0.05, missed


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("y = v + a;", "v in m/s and a in m/s^2"),
        ("y = v + 9.81 * t + 2.0; if (v > 0.1) y = 3.0;", ""),
        ("y = v + 2.0 * t;", "v in m/s and 2*t in s"),
        ("y = sin(v);", "sin of a number without unit; got v in m/s"),
        ("y = v * 2.237;", ""),
        ("y = v; if (v > a) y = 2.0 * v;", "v in m/s and a in m/s^2"),
    ],
)
def test_numbers_may_have_the_unit_of_their_neighbours(line, found, tmp_path):
    (tmp_path / "a.c").write_text(f"double f(double v, double a, double t)\n{{\n double y;\n {line}\n return y;\n}}\n")
    units = "".join(f'{name} = {{ unit = "{unit}" }}\n' for name, unit in (("v", "m/s"), ("a", "m/s^2"), ("t", "s")))
    question = '[[question]]\nname = "same"\nkind = "equal"\nleft = "a:return"\nright = "a:return"\n'
    path = tmp_path / "a.toml"
    path.write_text(f'[[code]]\nname = "a"\nfile = "a.c"\nfunction = "f"\n[code.symbols]\n{units}{question}')
    report = nav.audit(path)
    assert report.holds == (not found) and report["same"].status.holds
    if found:
        ((place, why),) = report.meaningless
        assert place == f"{tmp_path / 'a.c'}:4" and found in why
        assert report.document()["meaningless"] == [{"place": place, "why": why}]
        assert f"{place}: {why}" in report.annotations()


def test_an_unknown_unit_is_refused_at_its_key(tmp_path):
    document = declared("gallery/gravity_sign", {"g": "furlong"})
    with pytest.raises(NavsymError, match="unit") as error:
        meaningless(document, (EXAMPLES / "gallery"))
    assert error.value.where.endswith("symbols.g.unit")


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("y[i] = v[i] + w[i];", "v[0] in n and w[0] in b"),
        ("y[i] = v[i] + C[i][0] * w[0] + C[i][1] * w[1] + C[i][2] * w[2];", ""),
        ("y[i] = v[i] + 2.0 * k * (C[0][i] * v[0] + C[1][i] * v[1] + C[2][i] * v[2]);", "in n and"),
        ("y[i] = C[i][0] * e[0];", "e[0] in e beside C[0][0], b to n"),
        ("y[i] = v[0] * w[i] - v[i] * w[0] + u[i];", ""),
        ("y[i] = w[i];", "w[0] in b and y[0] in n"),
        ("y[i] = v[i] + u[i] * w[i]; if (v[i] > w[i]) y[i] = v[i];", "v[0] in n and w[0] in b"),
    ],
)
def test_a_sum_of_two_frames_is_found_at_its_line(line, found, tmp_path):
    arguments = "double C[3][3], double v[3], double w[3], double e[3], double u[3], double k, double y[3]"
    (tmp_path / "a.c").write_text(f"void f({arguments})\n{{\n for (int i = 0; i < 3; i++) {{\n {line}\n }}\n}}\n")
    frames = (("v", "n"), ("w", "b"), ("e", "e"), ("y", "n"))
    symbols = "".join(f'{name} = {{ vector = 3, frame = "{frame}" }}\n' for name, frame in frames)
    symbols += 'C = { matrix = [3, 3], rotation = true, frame = "b to n" }\n'
    question = '[[question]]\nname = "same"\nkind = "equal"\nleft = "a:y"\nright = "a:y"\n'
    path = tmp_path / "a.toml"
    path.write_text(f'[[code]]\nname = "a"\nfile = "a.c"\nfunction = "f"\n[code.symbols]\n{symbols}{question}')
    report = nav.audit(path)
    assert report.holds == (not found)
    if found:
        assert report.meaningless[0][0] == f"{tmp_path / 'a.c'}:4" and found in report.meaningless[0][1], (
            report.meaningless
        )
