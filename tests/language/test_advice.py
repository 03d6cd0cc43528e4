"""What people bring from paper, Matlab and numpy is refused with words that lead to the right file."""

from __future__ import annotations

import pytest

from navsym.core.errors import NavsymError
from navsym.language.expression import parse, symbol
from navsym.models.modelfile import read_model
from navsym.prove.claimfile import read_claims

SYMBOLS = {name: symbol(name) for name in ("a", "T", "omega")}
SLIPS = [
    ("a^2", "write ** for a power"),
    ("a\u00b2", "write **2"),
    ("2a", "write products with *"),
    ("2 sin(a)", "write a product with *"),
    ("0,5*a", "write a decimal point: 0.5"),
    ("\u03c9*T", "write its name, omega, here and where it is declared"),
    ("\u03bb", "write its name, lam,"),
    ("\u03a9", "write its name, Omega,"),
    ("2*\u03c0", "write pi"),
    ("ln(a)", "write log, or declare it"),
    ("arctan(a)", "write atan, or"),
    ("tg(a)", "write tan, or"),
    ("Pi*a", "write pi, or"),
    ("e**a", "write exp(...), or"),
    ("omge*T", "did you mean 'omega'?"),
    ("a.*T", "leave the point out"),
    ("np.sin(a)", "write the function alone"),
    ("sin**2(a)", "write the power behind the call: sin(x)**2"),
    ("9.81 m/s*T", "leave the unit out"),
    ("sin(30 deg)", "leave the unit out"),
    ("sin(w*T)", "known are 'T', 'a', 'omega'"),
    ("sin(45\u00b0)", "write *pi/180"),
    ("|a|", "write abs(...)"),
    ("a\u2212T", "write the ASCII minus -"),
    ("a, T", "complete or remove this part"),
]


@pytest.mark.parametrize(("text", "advice"), SLIPS)
def test_a_typical_slip_is_answered_with_what_to_write(text, advice):
    with pytest.raises(NavsymError) as refused:
        parse(text, SYMBOLS)
    assert advice in refused.value.remedy, refused.value.message


def test_a_declared_name_is_no_slip():
    assert str(parse("e*ln + Pi", {name: symbol(name) for name in ("e", "ln", "Pi")})) == "Pi + e*ln"


@pytest.mark.parametrize(("relation", "sign"), [("==", "="), ("\u2264", "<="), ("=>", ">="), ("~=", "!=")])
def test_a_relation_of_another_language_is_translated(tmp_path, relation, sign):
    path = tmp_path / "claims.toml"
    claim = f'[[claim]]\nid = "x"\nleft = "a"\nright = "a"\nrelation = "{relation}"\n'
    path.write_text('[symbols]\na = "real"\n' + claim, encoding="utf-8")
    with pytest.raises(NavsymError, match=f"write {sign}$"):
        read_claims(path)


MODEL = """
[model]
name = "m"
states = ["x"]
F = [["0"]]
[[measurement]]
name = "z"
h = ["1"]
sigma = "1"
"""


@pytest.mark.parametrize(
    ("right", "wrong", "advice"),
    [
        ("[[measurement]]", "[measurement]", r"write \[\[measurement\]\], with two brackets"),
        ('[["0"]]', '"0"', "a matrix by its rows"),
        ('h = ["1"]', '\u03bb = "1"', "keys are ASCII"),
    ],
)
def test_a_slip_of_a_model_file_is_answered_with_what_to_write(tmp_path, right, wrong, advice):
    path = tmp_path / "model.toml"
    path.write_text(MODEL.replace(right, wrong), encoding="utf-8")
    with pytest.raises(NavsymError, match=advice):
        read_model(path)
