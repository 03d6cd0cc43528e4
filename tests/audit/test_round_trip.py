"""What navsym exports is read back by audit and proved equal to the claim, in each language that both know.

The lines with the formula are read; the tests of the domain around them are another matter.
"""

from __future__ import annotations

import re

import pytest

import navsym as nav
from tests.audit.round_trip import count, list_claims, read_back

#: A sample of claims with the ranges of their symbols: powers, quotients, roots, angles, several symbols.
CLAIMS = {
    "sin(2*a) = 2*sin(a)*cos(a)": {},
    "(b - 1)*(b + 1) = b**2 - 1": {},
    "1/(1 + t) - 1/(2 + t) = 1/((1 + t)*(2 + t))": {"t": "positive"},
    "sqrt(p**2 + 2*p*q + q**2) = p + q": {"p": "positive", "q": "positive"},
    "exp(x)*exp(-3*x) + cos(x)**2 = exp(-2*x) + 1 - sin(x)**2": {},
}
#: Language: the file, the first and the last line around the formula, and the name of the result.
FILES = {
    "c": ("c/formula.c", r"\{ /\* formula", r"    \}", r"\*value = (\w+);"),
    "cpp": ("cpp/navsym_functions.hpp", r"\{  // formula", r"    \}", "result.value"),
    "rust": ("rust/navsym_functions.rs", r"\{ // formula", r"    \}", "nv_r[0]"),
    "python": (
        "python/navsym_functions.py",
        r"shape = np.broadcast_shapes",
        r"    return",
        r"np\.asarray\((\w+), dtype=np\.float64\), shape",
    ),
    "octave": ("octave/formula.m", r"^  end", r"  if ~all\(isfinite", r"value = (\w+);"),
}
#: What stands in a file of its own.
HELPERS = {"octave": "[code.functions]\nnavsym_sqrt = { of = ['x'], is = 'sqrt(x)' }\n"}


def find_lines(text, first, last):
    """The lines between the one with the first mark and the next with the last."""
    lines = text[text.index("formula(") :].split("\n")
    before = text[: text.index("formula(")].count("\n")
    start = next(i for i, line in enumerate(lines) if re.search(first, line))
    end = next(i for i, line in enumerate(lines) if i > start and re.match(last, line))
    return before + start + 2, before + end


@pytest.mark.parametrize("claim", CLAIMS)
def test_exported_code_reads_back_as_the_claim_from_which_it_was_made(claim, tmp_path):
    """For all reals of the declared ranges; and a spoiled copy does not read back as the claim."""
    nav.export(nav.prove(claim, **CLAIMS[claim]), to=[*FILES], out=tmp_path / "out", run=False)
    for language, (file, first, last, result) in FILES.items():
        text = (tmp_path / "out" / file).read_text()
        lines, name = list(find_lines(text, first, last)), re.search(result, text)[1] if "\\w" in result else result
        spec = f'[[code]]\nname = "c"\nfile = "out/{file}"\nfunction = "formula"\nlines = {lines}\n'
        spec += HELPERS.get(language, "") + "[code.symbols]\n"
        spec += "".join(f'{symbol} = "{declared}"\n' for symbol, declared in CLAIMS[claim].items())
        sides = *claim.split(" = "), f"{claim.split(' = ')[0]} + 1"
        spec += "".join(
            f'[[question]]\nname = "{side}"\nkind = "equal"\nleft = "c:{name}"\nright = "{formula}"\n'
            for side, formula in zip(("left", "right", "wrong"), sides, strict=True)
        )
        (tmp_path / "spec.toml").write_text(spec)
        verdicts = {question.name: question.status for question in nav.audit(tmp_path / "spec.toml").questions}
        assert verdicts == {"left": nav.PROVED, "right": nav.PROVED, "wrong": nav.REFUTED}, language


@pytest.mark.slow
@pytest.mark.parametrize("first", range(20))
def test_every_exported_claim_of_the_ledger_reads_back(first, capsys):
    """A twentieth of the ledger at a time; what is not proved is listed with its reason, and nothing is refuted."""
    counts, _ = count(list_claims()[first::20])
    with capsys.disabled():
        print(first, dict(sorted(counts.items())))
    assert not [key for key in counts if "REFUTED" in key]
    assert sum(counts[f"{language} PROVED"] for language in FILES) >= counts["exported"]


@pytest.mark.parametrize("claim", ["alpha_beta_filter:4", "multistructure:2.growth.every*"])
def test_a_claim_of_the_ledger_reads_back_in_every_language(claim, tmp_path):
    """The second one has no inputs: its code holds decimals, one of them with both signs."""
    assert read_back(claim, tmp_path) == dict.fromkeys(FILES, "PROVED")
