"""Functions of our own in the styles of flown filters: all of them is read, and means what runs.

Structures of arrays, loops, blocks of Eigen, stacks of numpy, brackets of MATLAB: compilers and interpreters judge.
"""

from __future__ import annotations

import math
import operator

import pytest

from navsym.audit.mend import evaluate
from navsym.audit.names import Names
from navsym.audit.values import Array, List, Scalar
from tests.attacks.campaigns.code import (
    OWN,
    Subject,
    compute,
    draw_points,
    is_same,
    lacking_tool,
    list_subjects,
    read_code,
)

FIRST = ("update",)  # of Eigen, whose compiler is slow
NAMES = sorted(path.stem for path in OWN.iterdir())
SIGNS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne}


def name_inputs(subject, names, point):
    """Symbol -> number, cell by cell: row by row, in Octave column by column from 1."""
    first, numbers = int(subject.language == "matlab"), {}
    for (name, sizes, _), values in zip(subject.parameters(), point, strict=True):
        rows, columns = (*(sizes or ()), 1, 1)[:2]
        for k, number in enumerate(values):
            row, column = (k % rows, k // rows) if first else divmod(k, columns)
            place = [row + first, column + first] if len(sizes or ()) == 2 else [k + first]
            numbers[name + (f"[{','.join(map(str, place))}]" if sizes else "")] = float(number)
    return {symbol: numbers[key] for key, symbol in names.symbols.items() if key in numbers}


def list_results(subject, case):
    """The formulas of all outputs in the order of what runs: what is returned, then what is changed."""
    for name in sorted(subject.outputs(), key="return".__ne__):
        value = case.returned
        if name != "return":
            variable = case.variables[name]
            assert variable.all_unread is None
            order = (lambda place: place[::-1]) if subject.language == "matlab" else None
            value = Array((0,), tuple(variable.cells[place] for place in sorted(variable.cells, key=order)))
        yield from value.cells if isinstance(value, Array) else (value,)


def holds(condition, point):
    """Whether a case is the one of a point."""
    return (
        SIGNS[condition.sign](*(evaluate(side, point) for side in (condition.left, condition.right))) == condition.holds
    )


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[] if n in FIRST or not (OWN / f"{n}.cpp").exists() else pytest.mark.long) for n in NAMES],
)
def test_what_is_read_of_a_function_is_what_runs(name):
    subject = next(s for s in list_subjects() if s.name == name)
    if why := lacking_tool(subject.language):
        pytest.skip(why)
    names = Names()
    reading = read_code("code", subject.text, subject, names).read()
    assert not reading.refused
    (ran,) = compute([subject.text], subject, 1)
    points = draw_points(subject, 1)
    many = len(ran) // len(points)
    for k, point in enumerate(points):
        given = name_inputs(subject, names, point)
        (case,) = [case for case in reading.cases if all(holds(condition, given) for condition in case.conditions)]
        cells = [*list_results(subject, case)]
        assert all(isinstance(cell, Scalar) for cell in cells)
        wanted = ran[k * many : k * many + many]
        if len(cells) != many:  # some entries stay as they come in
            assert len(cells) < many and subject.language in ("c", "rust")
            continue
        assert is_same([evaluate(cell.tree, given) for cell in cells], wanted), name
    assert math.isfinite(sum(ran))


def read_python(body):
    """What a function of a and b returns."""
    text = f"import numpy as np\n\n\ndef f(a, b):\n{body}\n"
    (case,) = read_code("code", text, Subject("", text, "f", "python"), Names()).read().cases
    return case.returned


def test_lists_of_python_are_joined_and_repeated_and_arrays_added():
    shapes = {"[a, b] + [b, a]": (4,), "[a]*3": (3,), "np.array([a, b]) + [b, a]": (2,), "np.array([a, b]*2)*2": (4,)}
    for text, shape in shapes.items():
        assert read_python(f"    x = {text}\n    return x").shape == shape
    assert isinstance(read_python("    x = [a, b]\n    y = x[0:1]\n    return y"), List)
    for text in ("[a, b] - [b, a]", "[a, b]*a", "-1.0 + [a]"):
        assert not isinstance(read_python(f"    x = {text}\n    return x"), Scalar | Array)


@pytest.mark.parametrize(
    ("line", "is_read"),
    [("P = F*P*F.transpose();", True), ("P = 0.5*(P + P.transpose().eval());", True), ("P = P*P.transpose();", True),
     ("P = 0.5*(P + P.transpose());", False), ("P.noalias() = F*F;", True), ("P.noalias() += F*P;", False)],
)  # fmt: skip
def test_a_matrix_of_eigen_that_is_written_while_it_is_read_is_refused(line, is_read):
    text = f"#include <Eigen/Dense>\nvoid f(Eigen::Matrix3d &P, const Eigen::Matrix3d &F)\n{{\n    {line}\n}}\n"
    reading = read_code("code", text, Subject("", text, "f", "cpp"), Names()).read()
    assert bool(reading.refused) is not is_read


def test_a_declaration_without_a_name_is_none():
    text = "double f(double a, double)\n{\n    double = a;\n    return 2*(a) - a;\n}\n"
    reading = read_code("code", text, Subject("", text, "f"), Names()).read()
    assert 3 in reading.refused


def test_a_cast_to_an_unknown_type_is_refused_and_a_variable_in_parentheses_is_none():
    text = "double f(double a, double b)\n{\n    double x = 2.0*(a) - b;\n    return x + (other_t)a;\n}\n"
    (case,) = read_code("code", text, Subject("", text, "f"), Names()).read().cases
    assert evaluate(case.variables["x"].cells[()].tree, {"a": 3.0, "b": 1.0}) == 5.0
    assert "cast" in case.returned.why
