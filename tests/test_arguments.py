"""Wrong arguments at the front door: whatever comes in, what comes out is a NavsymError with a kind and a sentence."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import navsym as nav

x = sp.Symbol("x")


class Mute:
    """An object that cannot say what it is."""

    def __repr__(self):
        raise RuntimeError("no text")


ODD = {
    "none": None,
    "true": True,
    "a float": 1.5,
    "nan": float("nan"),
    "a huge number": 10**400,
    "a number that Python does not write": 10**5000,
    "complex": 1j,
    "empty text": "",
    "blanks": "  ",
    "an end of text": "a\0b",
    "half a letter": "\ud800",
    "long text": "x" * 5000,
    "brackets": "(" * 3000,
    "bytes": b"ab",
    "an empty list": [],
    "a list in a list": [[]],
    "a ragged list": [[1, 2], [3]],
    "a set": {1},
    "an empty table": {},
    "a key that is no text": {1: None},
    "an array": np.zeros((2, 2)),
    "an empty array": np.zeros(0),
    "objects": np.array([None, "a"], dtype=object),
    "a matrix": sp.Matrix([[x]]),
    "an equation": sp.Eq(x, 1),
    "not a number": sp.nan,
    "a function": lambda *a: None,
    "a type": int,
    "a module": sys,
    "a generator": (k for k in "a"),
    "mute": Mute(),
    "no file": Path("no") / "such.toml",
}
STATES = {"states": "x v", "F": [["0", "1"], ["0", "0"]], "H": ["x"], "interval": "1"}
SWING = nav.Model(**STATES)
#: A call with one argument open. What takes a table, a path or a number takes all that is none of these as well.
CALLS = {
    "Model.states": lambda odd: nav.Model(**(STATES | {"states": odd})),
    "Model.F": lambda odd: nav.Model(**(STATES | {"F": odd})),
    "Model.H": lambda odd: nav.Model(**(STATES | {"H": odd})),
    "Model.rates": lambda odd: nav.Model(**STATES, rates=odd),
    "Model.inputs": lambda odd: nav.Model(**STATES, inputs=odd),
    "Model.blocks": lambda odd: nav.Model(**STATES, blocks=odd),
    "Model.load": lambda odd: nav.Model.load(odd),
    "prove": lambda odd: nav.prove(odd),
    "prove.box": lambda odd: nav.prove("x < x", box=odd, seconds=odd),
    "prove.rates": lambda odd: nav.prove("x <", rates=odd),
    "prove.order": lambda odd: nav.prove("x <", order=odd),
    "prove.seconds": lambda odd: nav.prove("x <", seconds=odd),
    "read": lambda odd: nav.read(odd),
    "read.symbols": lambda odd: nav.read(r"\frac", symbols=odd),
    "solve": lambda odd: nav.solve(odd),
    "solve.values": lambda odd: nav.solve(SWING, "no", values=odd),
    "phases": lambda odd: nav.phases(odd),
    "observe": lambda odd: nav.observe(odd),
    "observe.values": lambda odd: nav.observe(SWING, values=odd, no=1),
    "observe.restore": lambda odd: nav.observe(SWING, restore=odd, no=1),
    "observe.poles": lambda odd: nav.observe(SWING, poles=odd, no=1),
    "derive": lambda odd: nav.derive(odd),
    "check": lambda odd: nav.check(odd),
    "export": lambda odd: nav.export(odd),
    "export.real": lambda odd: nav.export("no:such", real=odd),
    "audit": lambda odd: nav.audit(odd),
    "conventions": lambda odd: nav.conventions(odd),
    "track": lambda odd: nav.track(odd),
    "track.window": lambda odd: nav.track("no.csv", window=odd),
    "track.method": lambda odd: nav.track("no.csv", method=odd),
    "filter": lambda odd: nav.filter(odd),
    "locate": lambda odd: nav.locate(odd),
    "data": lambda odd: nav.data(odd),
    "claims.status": lambda odd: nav.claims("no", status=odd),
    "diff": lambda odd: nav.diff(odd, odd),
}
#: Arguments that mean something.
RIGHT = {
    *(("Model.rates", odd) for odd in ("none", "an empty table")),
    *(("Model.inputs", odd) for odd in ("none", "an empty table")),
    *(("Model.blocks", odd) for odd in ("an empty list",)),
    *(("prove", odd) for odd in ("true", "an equation")),
    *(("read.symbols", odd) for odd in ("none", "an empty table")),
    *(
        ("read", odd) for odd in ("an end of text", "half a letter", "long text", "brackets")
    ),  # formulas that are not read
    ("diff", "a huge number"),
    *(("check", odd) for odd in ("an empty table", "a key that is no text")),  # certificates that are rejected
}


@pytest.mark.parametrize("call", CALLS)
def test_an_odd_argument_is_refused_with_a_kind_and_a_sentence(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, odd in ODD.items():
        try:
            CALLS[call](odd)
        except nav.NavsymError as error:
            assert (error.kind and "; got" in str(error)) or "expected" in str(error), (name, str(error))
        else:
            assert (call, name) in RIGHT, name
