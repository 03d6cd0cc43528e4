"""An intermediate value that overflows comes back as a status, also where a division would make a zero of it."""

from __future__ import annotations

import importlib.util
import random
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from flint import arb

from navsym.claims import Equation
from navsym.core.balls import enclose, tape
from navsym.core.errors import DomainError
from navsym.export.accuracy.vectors import vectors
from navsym.export.functions import ExportedFunction, function_of
from navsym.export.languages import modules
from navsym.export.languages.summary import summary
from navsym.export.languages.targets import TARGETS
from tests.attacks.points.sweep import compiled_c, sweep_c
from tests.export import samples

x, y = sp.symbols("x y", real=True)
COMPILER = pytest.mark.skipif(TARGETS["c"].executable() is None, reason="needs a C compiler")
HUGE = sp.Integer(10) ** 300
#: Formula, largest argument, one where nothing overflows and one where a hidden value does.
HIDDEN = {
    "cube": (1 / (1 + x**3 / HUGE), 10**200, 1e90, 1e120),
    "angle": (sp.atan2(sp.Integer(1), x**3 / HUGE + 1), 10**200, 1e90, 1e120),
    "power": ((1 + x**3) ** sp.Rational(-1, 7), 10**200, 1e90, 1e120),
    "quotient": (sp.atan(x**2 + x) / (x**2 + x) + 1 / (2 + x**4), 10**100, 1e70, 1e90),
}


def function(name: str, real: str = "double") -> ExportedFunction:
    formula, most, _, _ = HIDDEN[name]
    return function_of([samples.of_statement(name, Equation(formula, formula, {x: (1, most)}))], real=real)


@COMPILER
@pytest.mark.parametrize("name", HIDDEN)
def test_a_hidden_overflow_is_a_status_and_not_a_number(name: str, tmp_path: Path) -> None:
    made, (_, _, small, large) = function(name), HIDDEN[name]
    (call,) = compiled_c([made], tmp_path)
    statuses, _ = call(np.array([[small, large]]))
    assert statuses.tolist() == [0, 2]
    (found,) = sweep_c([made], 256).values()
    assert found.wrong == 0 and found.undefined


def test_numpy_says_so_as_well(tmp_path: Path) -> None:
    made = function("cube")
    file = tmp_path / "navsym_functions.py"
    file.write_text(modules.files("python", [made], {made.name: vectors(made, 4)}, "")["navsym_functions.py"])
    spec = importlib.util.spec_from_file_location("navsym_functions_of_overflow", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    call = getattr(module, made.name)
    with np.errstate(all="ignore"):
        assert float(call(1e90)) == pytest.approx(1 / (1 + 1e270 / 1e300))
        with pytest.raises(ArithmeticError):
            call(1e120)


@pytest.mark.parametrize("real", ["double", "float"])
def test_what_cannot_overflow_is_not_asked_for(real: str) -> None:
    assert not any(piece.graph.guards for f in samples.functions(real) for piece in f.pieces)


def test_the_bound_of_a_declared_range_holds_on_all_of_it() -> None:
    """A finite end is where vectors and bounds end, however far it is; only a missing one is replaced."""
    made = function_of([samples.of_statement("far", Equation(x * y, y * x, {x: (0, 10**9), y: (-(10**7), 5)}))])
    assert [(i.low, i.high) for i in made.inputs] == [(i.test_low, i.test_high) for i in made.inputs]
    assert max(v.inputs[0] for v in vectors(made, 40) if v.status == 0) == 1e9


@pytest.mark.parametrize(("real", "size"), [("double", 400), ("float", 60)])
def test_a_constant_that_the_type_does_not_have_is_refused(real: str, size: int) -> None:
    formula = sp.Integer(10) ** size * x
    with pytest.raises(DomainError, match="rescale"):
        function_of([samples.of_statement("large", Equation(formula, formula, {x: (0, 1)}))], real=real)


#: Formula with no declared range, a point where its value is plain, and one where a hidden value is none.
UNDECLARED = {
    "gain": (x / (x + y), (1.0, 3.0), (1.5e308, 1.5e308)),
    "root": (sp.Max(sp.sqrt(x), 1) + y, (4.0, 0.0), (-1.0, 0.0)),
    "ratio": (1 / (1 + x**2 * y**2), (1.0, 2.0), (1e200, 1e-3)),
}


@COMPILER
@pytest.mark.parametrize("name", UNDECLARED)
def test_far_outside_of_an_undeclared_range_there_is_a_status_and_no_wrong_number(name, tmp_path) -> None:
    """Bounds are stated up to a thousand there, but a call with 1e308 must not give zero for a half."""
    formula, good, bad = UNDECLARED[name]
    made = function_of([samples.of_statement(name, Equation(formula, formula))])
    (call,) = compiled_c([made], tmp_path)
    given = {"x": (good[0], bad[0]), "y": (good[1], bad[1])}
    statuses, _ = call(np.array([given[i.symbol.name] for i in made.inputs]))
    assert statuses.tolist() == [0, 2]


# -- underflow ---------------------------------------

TINY = sp.Rational(1, 10**200)


@COMPILER
@pytest.mark.parametrize("formula", [sp.sqrt(x * y), x * y / (x * y + y**2), (x * y) ** sp.Rational(2, 3) / x])
def test_a_product_that_loses_its_digits_by_underflow_is_a_status(formula: sp.Expr, tmp_path: Path) -> None:
    """x y is 1e-340 at the second point, which is zero in double; the root of it is 1e-170."""
    statement = Equation(formula, formula, {x: (TINY, 1), y: (TINY, 1)})
    made = function_of([samples.of_statement("tiny", statement)])
    (call,) = compiled_c([made], tmp_path)
    statuses, results = call(np.array([[1e-100, 1e-170, 1e-155], [1e-120, 1e-170, 1e-155]]))
    assert statuses.tolist() == [0, 2, 2]
    (found,) = sweep_c([made], 256).values()
    assert found.wrong == 0
    exact = formula.subs({x: sp.Rational(1, 10**100), y: sp.Rational(1, 10**120)})
    assert results[0, 0] == pytest.approx(float(exact), rel=1e-14)


def random_formula(generator: random.Random, depth: int) -> sp.Expr:
    """Positive quantities by operations that lose no digits unless they overflow or underflow."""
    if depth == 0:
        return generator.choice(POSITIVE)
    a, b = random_formula(generator, depth - 1), random_formula(generator, generator.randrange(depth))
    return generator.choice([a + b, a * b, a / b, sp.sqrt(a), a ** sp.Rational(2, 3), a**3, 1 / (1 + a)])


POSITIVE = sp.symbols("x y z", positive=True)


@COMPILER
@pytest.mark.parametrize("seed", [1, *(pytest.param(k, marks=pytest.mark.slow) for k in range(2, 12))])
def test_no_random_formula_over_four_hundred_decades_gives_a_wrong_number(seed: int, tmp_path: Path) -> None:
    generator, made = random.Random(seed), []
    while len(made) < 12:
        formula = random_formula(generator, 4)
        box = {s: (TINY, 1 / TINY) for s in sorted(formula.free_symbols, key=str)}
        if box:
            statement = Equation(formula, formula, box)
            made.append((formula, function_of([samples.of_statement(f"wide{len(made)}", statement)])))
    for (formula, function), call in zip(made, compiled_c([f for _, f in made], tmp_path), strict=True):
        given = 10.0 ** np.random.default_rng(seed).uniform(-195, 195, (len(function.inputs), 100))
        statuses, (results,) = call(given)
        flattened, symbols = tape(formula), [i.symbol for i in function.inputs]
        for k in np.flatnonzero(statuses == 0):
            exact = enclose(flattened, dict(zip(symbols, map(arb, given[:, k].tolist()), strict=True)), 300)
            near = abs(exact - float(results[k])) <= abs(exact) * arb("1e-12") or abs(exact) < arb(2) ** -1020
            assert near, (formula, given[:, k], results[k])


w = sp.Symbol("x", real=True, nonzero=True)
#: Quotients that underflow inside at the second point of (x, y), not at the first, and at the third without harm.
QUOTIENTS = [
    ((1 - sp.cos(w)) / w**2, (1e-3, 0.0), (3e-162, 0.0), None),
    (x**2 / (x**2 + y**2), (1e-3, 2e-3), (1e-162, 2e-162), (0.0, 2e-3)),
    (x**2 / (x**2 + y**2), (1e-3, 2e-3), (1e-170, 2e-161), (1e-180, 1.0)),
    (x * y / (x + y), (1e-3, 2e-3), (1e-200, 1e-200), (0.0, 2e-3)),
    (x * y / sp.sin(y + x), (1e-3, 2e-3), (1e-170, 1e-170), (0.0, 2e-3)),
    ((x**2 + y**2) / (x + y), (1e-3, 2e-3), (1e-180, 1e-180), (1e-180, 1.0)),
]


@COMPILER
@pytest.mark.parametrize(("formula", "good", "bad", "zero"), QUOTIENTS)
def test_underflow_inside_a_quotient_is_a_status_and_a_zero_by_right_is_not(formula, good, bad, zero, tmp_path) -> None:
    made = function_of([samples.of_statement("quotient", Equation(formula, formula))])
    (call,) = compiled_c([made], tmp_path)
    points = [point for point in (good, bad, zero) if point]
    columns = {"x": [a for a, _ in points], "y": [b for _, b in points]}
    statuses, results = call(np.array([columns[i.symbol.name] for i in made.inputs]))
    assert statuses.tolist() == [0, 2, 0][: len(points)]
    exact = [
        float(formula.subs({x: sp.Rational(a), w: sp.Rational(a), y: sp.Rational(b)}).evalf(30)) for a, b in points
    ]
    assert results[0][0] == pytest.approx(exact[0], rel=1e-12)
    assert zero is None or results[0][2] == pytest.approx(exact[2], rel=1e-12, abs=1e-300)
    assert any("the status says where" in line for line in summary(made))


def test_a_divisor_that_cannot_be_tiny_is_not_asked() -> None:
    for formula in (1 / (1 + x**2 * y**2), (x + y) / sp.sqrt(4 + x**4), x / (3 + sp.exp(y))):
        made = function_of([samples.of_statement("large", Equation(formula, formula))])
        small = [node for piece in made.pieces for node in piece.graph.nodes if node.op == "min"]
        assert not small


def test_a_header_names_the_hole_of_its_domain() -> None:
    whole, hole = sp.Symbol("w", real=True), sp.Symbol("w", real=True, nonzero=True)
    for symbol, box, said in (
        (hole, {}, "w: w != 0;"),
        (whole, {}, "w: w real;"),
        (hole, {hole: (-1, 1)}, "w: -1 <= w <= 1, w != 0;"),
        (sp.Symbol("w", positive=True), {}, "w: 0 < w;"),
    ):
        formula = sp.cos(symbol) / symbol**2
        made = function_of([samples.of_statement("hole", Equation(formula, formula, box))])
        assert any(said in line for line in summary(made)), summary(made)
