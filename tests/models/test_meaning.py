"""Units and frames of models: what is right is left alone, slips of powers and of units are refused at their entry."""

from __future__ import annotations

import copy
import random
import re
from itertools import islice

import pytest

import navsym as nav
from navsym.conventions.card import CHOICES
from navsym.conventions.reading import read_problem
from navsym.core.errors import DomainError, NavsymError
from navsym.models.blocks import write_out
from navsym.models.meaning import require_meaning
from tests.conventions.models import PUBLISHED

CHANNEL = {
    "states": "height rate bias", "F": [["0", "1", "0"], ["2*g/R", "0", "1"], ["0", "0", "0"]], "H": ["height"],
    "measurements": "baro", "sigma": "s", "interval": "T", "targets": {"speed": "rate"},
    "units": {"height": "m", "rate": "m/s", "bias": "m/s^2", "baro": "m"}, "g": {"unit": "m/s^2"}, "R": {"unit": "m"},
    "s": {"sign": "positive", "unit": "m"}, "T": {"sign": "positive", "unit": "s"},
}  # fmt: skip
VECTOR = {"vector": 3}
INERTIAL = {
    "states": ["phi[3]", "dv[3]", "dr[3]", "drift[3]"],
    "F": [["-skew(win)", "0", "0", "-C"], ["skew(C @ f)", "-skew(wie + win)", "0", "0"],
          ["0", "eye(3)", "-skew(wen)", "0"], ["0", "0", "0", "0"]],
    "H": [["0", "eye(3)", "0", "0"]],
    "units": {"phi": {"unit": "rad", "frame": "n"}, "dv": {"unit": "m/s", "frame": "n"},
              "drift": {"unit": "rad/s", "frame": "b"}, "dr": "m"},
    "C": {"matrix": [3, 3], "unit": "1", "frame": "b to n"}, "f": VECTOR | {"unit": "m/s^2", "frame": "b"},
    **dict.fromkeys(("win", "wie", "wen"), VECTOR | {"unit": "rad/s", "frame": "n"}),
}  # fmt: skip
PENDULUM = {
    "states": "angle rate", "dynamics": ["rate", "-g/L*sin(angle) - c*rate"], "H": ["L*sin(angle)"],
    "measurements": "shadow", "units": {"angle": "rad", "shadow": "m", "rate": "rad/s"}, "g": {"unit": "m/s^2"},
    "L": {"unit": "m"}, "c": {"unit": "1/s"}, "relations": ["angle = angle"], "rates": {"L": "c*L"},
}  # fmt: skip
STEPS = {
    "states": "r v", "Phi": [["1", "d"], ["0", "1 - k*d"]], "H": ["r"], "units": {"r": "m", "v": "m/s"},
    "d": {"unit": "s"}, "k": {"unit": "1/s"},
}  # fmt: skip
MODELS = {"channel": CHANNEL, "inertial": INERTIAL, "pendulum": PENDULUM, "steps": STEPS}


@pytest.mark.parametrize("name", MODELS)
def test_a_model_with_units_is_read_and_saved(name, tmp_path):
    model = nav.Model(**MODELS[name])
    model.save(tmp_path / "model.toml")
    assert nav.Model.load(tmp_path / "model.toml") == model
    assert nav.Model.from_document(model.document()) == model


@pytest.mark.parametrize(
    ("name", "change", "where", "got"),
    [
        ("channel", {"F": [["0", "1", "0"], ["2*g/R**2", "0", "1"], ["0", "0", "0"]]}, "F[1][0]", "rate/t in m/s^2"),
        ("channel", {"F": [["0", "1", "0"], ["2*g/R + g", "0", "1"], ["0", "0", "0"]]}, "F[1][0]", "g in m/s^2"),
        ("channel", {"H": [["0", "1", "0"]]}, "H[0][1]", "rate in m/s and z of baro in m"),
        ("channel", {"s": {"sign": "positive", "unit": "s"}}, "sigma[0]", "s in s and z of baro in m"),
        ("channel", {"T": {"sign": "positive", "unit": "m"}}, "F[0][1]", "height/t in 1"),
        ("channel", {"targets": {"sum": ["1", "1", "0"]}}, "targets.sum[1]", "rate in m/s"),
        ("channel", {"units": {"height": "km", "rate": "m/s"}}, "F[0][1]", "height/t in 1000 times the base unit"),
        ("inertial", {"f": VECTOR | {"unit": "m/s", "frame": "b"}}, "F[1][0]", "dv/t in m/s^2"),
        ("inertial", {"f": VECTOR | {"unit": "m/s^2", "frame": "n"}}, "F[1][0]", "C in b and f in n"),
        ("inertial", {"win": VECTOR | {"unit": "rad/s", "frame": "b"}}, "F[0][0]", "skew(win) in b and phi in n"),
        ("pendulum", {"dynamics": ["rate", "-g*L*sin(angle)"]}, "dynamics[1]", "rate/t in 1/s^2"),
        ("pendulum", {"H": ["L*sin(L)"]}, "H[0]", "L in m"),
        ("pendulum", {"rates": {"L": "c"}}, "rates.L", "L/t in m/s"),
        ("pendulum", {"relations": ["angle = rate"]}, "relations[0]", "angle in 1 and rate in 1/s"),
        ("steps", {"Phi": [["1", "d**2"], ["0", "1"]]}, "Phi[0][1]", "d**2*v in s m and r in m"),
        ("steps", {"units": {"r": "m", "u": "m"}}, "units.u", "'u'"),
        ("steps", {"units": {"d": "s"}}, "units.d", "the parameter 'd'"),
        ("steps", {"units": {"r": "furlong"}}, "units.r.unit", "furlong"),
    ],
)  # fmt: skip
def test_a_slip_is_an_error_at_its_entry_that_names_both_units(name, change, where, got):
    with pytest.raises(NavsymError) as error:
        nav.Model(**{**MODELS[name], **change})
    assert where in error.value.where and got.strip("'") in str(error.value), str(error.value)


def test_numbers_in_place_of_symbols_make_no_alarm():
    """A value has lost the unit of its name: the model with values, and its file, are left alone."""
    model = nav.Model(
        **{**CHANNEL, "F": [["0", "1", "0"], ["2*g/R", "-k", "1"], ["0", "0", "0"]], "k": {"unit": "1/s"}}
    )
    for values in ({"k": 1}, {"g": 1, "k": 1}, {"R": 1}, {"R": 2, "k": 3, "g": "9.81"}, {"s": 1, "T": 1, "g": 2}):
        filled = model.with_values(**values)
        assert nav.Model.from_document(filled.document()) == filled


def test_values_do_not_hide_a_slip_of_the_file(tmp_path):
    path = tmp_path / "model.toml"
    nav.Model(**CHANNEL).save(path)
    path.write_text(path.read_text(encoding="utf-8").replace("2*g/R", "2*g/R**2"), encoding="utf-8")
    with pytest.raises(DomainError, match="one unit"):
        nav.derive(path, g="9.81", R=6371000, T=1)
    for units in ("m", {"height": 5}, {"height": {"range": ["0", "1"]}}):
        with pytest.raises(NavsymError, match="units"):
            nav.Model.from_document({**nav.Model(**CHANNEL).document(), "units": units})


def test_numbers_of_a_file_may_be_quantities():
    nav.Model("h v", F=[["0", "1"], ["-1/600", "-1/10"]], H=["h"], units={"h": "m", "v": "m/s"})
    nav.Model("y1 y2", F=[["0", "-1"], ["1", "0"]], H=["y1"], units={"y1": "rad", "t": "1"})
    nav.Model("y1 y2", F=[["0", "-w**2"], ["1", "0"]], H=["y1"], w={"unit": "1/s"})


def test_nothing_is_said_where_nothing_is_declared():
    nav.Model("h v", F=[["0", "g"], ["g**2", "g + 1"]], H=["h"], g="real")


def test_ranges_of_states_are_in_their_units():
    model = nav.Model(
        "h v", F=[["0", "1"], ["0", "0"]], H=["h"], units={"h": "km", "v": "km/s"}, ranges={"h": ("0 m", "9 km")}
    )
    assert model.document()["ranges"]["h"] == ["0", "9"] or model.read().ranges["h"][1] == 9


# -- published models ----------------------------------------------------------------------------------


def with_units(document, geodetic):
    """A conventions file with the units that its roles and quantities have."""
    card = type("Words", (), dict.fromkeys(CHOICES) | {"position_error": "geodetic" if geodetic else "metres"})
    units = read_problem(document).units(card)
    said = {n: {"range": v} if isinstance(v, list) else {"sign": v} for n, v in document["parameters"].items()}
    parameters = {name: value | ({"unit": units[name]} if name in units else {}) for name, value in said.items()}
    return {
        **document,
        "parameters": parameters,
        "units": {n: units[n] for n in document["model"]["states"] if n in units},
    }


GEODETIC = ("Farrell", "Groves, local", "NaveGo", "PSINS")


def published():
    """All published models with units."""
    return {name: with_units(make(), name.startswith(GEODETIC)) for name, make in PUBLISHED.items()}


def test_published_models_agree_with_the_units_of_their_roles():
    for name, document in published().items():
        require_meaning(document, document, name)


def slips(source):
    """Endless random slips: what was changed, and the changed document."""
    documents = [
        *published().items(),
        *((name, nav.Model(**model).document()) for name, model in MODELS.items() if name != "steps"),
    ]
    while True:
        name, document = source.choice(documents)
        document = copy.deepcopy(document)
        F = document["model"].get("F") or [document["model"]["dynamics"]]
        units = {
            n: v["unit"]
            for n, v in document["parameters"].items()
            if isinstance(v, dict) and v.get("unit", "1") not in ("1", "rad")
        }
        i, j = source.randrange(len(F)), source.randrange(len(F[0]))
        used = [found for found in re.finditer(r"[A-Za-z_]\w*", F[i][j]) if found[0] in units]
        if source.random() < 2 / 3:
            if not used:
                continue
            at = source.choice(used)
            new = source.choice([f"({at[0]}**2)", f"(1/{at[0]})", f"({at[0]}**3)"])
            if isinstance(document["parameters"][at[0]], dict) and "vector" in document["parameters"][at[0]]:
                new = f"({at[0]}*norm({at[0]}))"
            F[i][j] = F[i][j][: at.start()] + new + F[i][j][at.end() :]
            what = f"{name}: F[{i}][{j}] = {F[i][j]}"
        else:
            texts = " ".join(cell for row in F for cell in row)
            changed = source.choice(
                [n for n in (*units, *document["units"]) if n in document["units"] or re.search(rf"\b{n}\b", texts)]
            )
            table = document["units"] if changed in document["units"] else document["parameters"]
            said = table[changed] if isinstance(table[changed], dict) else {"unit": table[changed]}
            table[changed] = {**said, "unit": f"{said['unit']} {source.choice('ms')}^{source.choice((-1, 1))}"}
            what = f"{name}: {changed} in {table[changed]['unit']}"
        yield what, document


@pytest.mark.parametrize("count", [40, pytest.param(500, marks=pytest.mark.long)])
def test_slips_of_powers_and_units_are_noticed(count):
    missed = []
    for what, document in islice(slips(random.Random(count)), count):
        try:
            require_meaning(document, write_out(document, ""), "")
            missed.append(what)
        except DomainError:
            pass
    assert len(missed) <= count * 0.05, missed
