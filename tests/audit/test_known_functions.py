"""Functions of numbers and arrays that audit knows: what is read of a call is what numpy and Octave compute."""

from __future__ import annotations

import itertools

import pytest

from navsym.audit.mend import evaluate
from navsym.audit.names import Names
from navsym.audit.values import Array, Scalar
from tests.attacks.campaigns.code import Subject, compute, draw_points, is_same, lacking_tool, read_code

SHAPES = (("v", (3,)), ("M", (3, 3)))
NUMBERS = "sin cos tan exp log sqrt asin acos atan sinh cosh tanh abs expm1 log1p"
NUMPY = (
    f"{NUMBERS} arcsin arccos arctan absolute arctan2 power square hypot deg2rad radians rad2deg degrees array asarray"
)
CALLS = {
    "python": [f"np.{name}({{}})" for name in f"{NUMPY} copy diag outer cross dot matmul linalg.norm transpose".split()]
    + [f"{base}.{name}({{}})" for base in ("v", "M") for name in "transpose copy dot cross norm conjugate".split()],
    "matlab": [
        f"{name}({{}})" for name in f"{NUMBERS} atan2 hypot deg2rad rad2deg diag cross dot norm transpose".split()
    ],
}
ARGUMENTS = [("a", "v", "M"), *(a for n in (0, 1, 2) for a in itertools.product(("a", "v", "M"), repeat=n))]
FORMS = {
    "python": "import numpy as np\n\n\ndef f(a, v, M):\n    return {}\n",
    "matlab": "function y = f(a, v, M)\n    y = {};\nend\n",
}


def read_values(subject):
    """The values of what is read of a function at the points; None where it is not read."""
    names = Names()
    (case,) = read_code("code", subject.text, subject, names).read().cases
    value = case.returned
    if subject.language == "matlab":
        variable = case.variables["y"]
        value = Array((0,), tuple(variable.cells[place] for place in sorted(variable.cells, key=lambda p: p[::-1])))
        value = variable.all_unread or value
    cells = value.cells if isinstance(value, Array) else (value,)
    if not cells or not all(isinstance(cell, Scalar) for cell in cells):
        return None
    points = [name_entries(subject, names, point) for point in draw_points(subject, 1)]
    return [evaluate(cell.tree, point) for point in points for cell in cells]


def name_entries(subject, names, point):
    """The symbols of the entries with their numbers: row by row in Python, column by column from 1 in Octave."""
    first, numbers = int(subject.language == "matlab"), {}
    for (name, sizes, _), values in zip(subject.parameters(), point, strict=True):
        for k, number in enumerate(values):
            row, column = divmod(k, 3)[:: -1 if first else 1]
            entry = f"[{row + first},{column + first}]" if len(sizes or ()) == 2 else f"[{k + first}]" if sizes else ""
            numbers[name + entry] = number
    return {symbol: numbers[key] for key, symbol in names.symbols.items()}


@pytest.mark.parametrize("language", ["matlab", pytest.param("python", marks=pytest.mark.long)])
def test_what_is_read_of_a_call_is_what_runs(language):
    """Calls with no, one, two or three numbers, vectors and matrices: each is read rightly, or refused."""
    if why := lacking_tool(language):
        pytest.skip(why)
    texts = [FORMS[language].format(call.format(", ".join(a))) for call in CALLS[language] for a in ARGUMENTS]
    subjects = [Subject("", text, "f", language, SHAPES) for text in texts]
    read, ran = [read_values(subject) for subject in subjects], compute(texts, subjects[0], 1)
    pairs = [(text, x, y) for text, x, y in zip(texts, read, ran, strict=True) if x is not None and None not in x]
    wrong = [text for text, x, y in pairs if is_same(x, y) is False]
    assert not wrong and sum(is_same(x, y) is True for _, x, y in pairs) >= 50
    assert len([1 for _, x, y in pairs if y is None]) == 0, [text for text, x, y in pairs if y is None]
