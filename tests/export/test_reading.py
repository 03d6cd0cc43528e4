"""Generated code can be read: names of the formulas, results, units, accepted ranges, all in their places."""

from __future__ import annotations

import re

import pytest
import sympy as sp

from navsym.claims import Equation
from navsym.export.functions import function_of, material
from navsym.export.languages.c import header, source, writer
from navsym.export.languages.names import LOCAL, local_names
from navsym.export.languages.summary import accepted, domain_lines, sizes
from navsym.prove.ladder import decide
from tests.export import programs, samples

LICENSE = "SPDX-License-Identifier: Apache-2.0"
PROGRAMS = ("trajectory-filter", "pulsating-filter", "two-stage-observer", "terrain-crossing")


def test_values_keep_the_names_of_their_formulas() -> None:
    _, step = programs.functions("trajectory-filter")
    text = source(step, LICENSE)
    assert re.search(r"const double K1 = m11 / \w+;", text) and "r1 = g2;" in text
    assert "Formula  estimate[0] = g1" in header(step, LICENSE)


def test_names_of_values_differ_from_each_other_and_from_all_that_is_taken() -> None:
    names = dict(enumerate(["K", "k", "double", "t0", "P", "in", "n" * 80, "n" * 81, "bad", "λ"]))
    found = local_names(names, ["P", "value"]).values()
    known = [name.lower() for name in (*found, "P", "value", *LOCAL)]
    assert len(set(known)) == len(known) and all(name.isidentifier() and len(name) < 64 for name in found)


@pytest.mark.long
@pytest.mark.parametrize("name", PROGRAMS)
def test_every_argument_result_and_field_of_a_program_has_a_unit(name: str) -> None:
    start, step = programs.functions(name)
    program = writer(step.arithmetic.name).render("program.h", license=LICENSE, f=step)
    for text in (header(start, LICENSE), header(step, LICENSE), program):
        assert "unit not stated" not in text
    fields = re.findall(r"^    double (\w+)(?:\[\d+\])?; /\* .+ \[.+\] \*/$", program, re.M)
    assert fields == [o.name for o in start.outputs]


def test_every_result_of_a_step_is_one_of_its_named_values() -> None:
    for name in PROGRAMS:
        _, step = programs.functions(name)
        lines = [line.partition(" = ")[0] for line in step.sources[0].formula]
        entries = [f"{o.name}[{k}]" if o.shape else o.name for o in step.outputs for k in range(o.size)]
        assert set(entries) <= set(lines), name


def test_ranges_are_said_in_words() -> None:
    inf = float("inf")
    words = [accepted(*ends) for ends in ((-inf, inf), (0.5, inf), (-inf, 2.0), (0.5, 2.0))]
    assert words == ["when finite", "from 0.5 on", "up to 2.0", "from 0.5 to 2.0"]


def test_an_array_of_like_entries_takes_one_line_and_another_one_each() -> None:
    _, step = programs.functions("trajectory-filter")
    lines = domain_lines(step)
    assert [line.partition(":")[0] for line in lines] == ["f[3]", "P[6]", "q[3]", "R", "z"]
    assert "|f|, |z| <= 1000" in sizes(step) and "|p12|, |p13|, |p23| <= 0.3" in sizes(step)


def test_a_name_that_is_part_of_an_end_is_not_taken_for_the_argument() -> None:
    p = sp.Symbol("p", real=True)
    statement = Equation(p + 1, 1 + p, {p: (-sp.pi, sp.pi)})
    function = function_of([material("m:1", statement, decide(statement))])
    assert function.inputs[0].text == "-pi <= p <= pi"


def test_the_header_lists_what_the_code_calls() -> None:
    assert "Calls    expm1, fabs, sin, sinh of math.h;" in header(samples.by_name("holes"), LICENSE)
    assert "Calls    expm1f, fabsf, sinf, sinhf of math.h;" in header(samples.by_name("holes", "float"), LICENSE)
    extremes = programs.functions("terrain-t-G-extremes")[0]
    assert "Calls    fabs, fmax, fmin, sqrt of math.h; no allocation, no state" in header(extremes, LICENSE)
