"""Octave and MATLAB: one file for each function, which returns its status and the results.

Only numbers of type double enter: integers and singles would round on the way, complex numbers compare by magnitude, a
matrix is no row of entries. Roots, logarithms and powers that are not real are NaN here, as in every other language.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_about, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, calls, code_names, template
from navsym.export.languages.programs import octave_program, octave_through_state
from navsym.export.languages.scripts import branch, short_names, vectors_text
from navsym.export.languages.summary import summary
from navsym.export.parts import Argument, ExportedFunction, Output

#: Functions that leave the real numbers where those of C give NaN: the condition under which they stay real.
REAL = {
    "sqrt": ("x", "x >= 0", "sqrt(x)"),
    "log": ("x", "x >= 0", "log(x)"),
    "asin": ("x", "abs(x) <= 1", "asin(x)"),
    "acos": ("x", "abs(x) <= 1", "acos(x)"),
    "pow": ("x, y", "x >= 0 || y == fix(y)", "x ^ y"),
}
SPELLING = Spelling(
    calls(abs="abs({0})", max="max({0}, {1})", min="min({0}, {1})")
    | {
        name: f"navsym_{name}({', '.join(f'{{{k}}}' for k in range(len(given.split(', '))))})"
        for name, (given, _, _) in REAL.items()
    },
    "NaN",
    "Inf",
)

NUMBERS = """function good = navsym_numbers(x, n, low, high)
  % {license}
  % True for n finite real numbers of type double between low and high, in a row or in a column.
  good = isa(x, 'double') && isreal(x) && numel(x) == n && max(size(x)) == n;
  good = good && all(isfinite(x)) && all(x(:).' >= low) && all(x(:).' <= high);
end
"""


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """One file for each function, each helper, each call of a program, and the test."""
    names = short_names(functions)
    found = {f"{names[f.name]}.m": source(f, names[f.name], license_) for f in functions}
    found |= {f"navsym_{h.name}.m": helper_text(h, license_) for h in helpers_used(*functions)}
    found |= {name: text for f in functions for name, text in octave_program(f, names, license_).items()}
    code = "\n".join(found.values())
    found |= {f"navsym_{name}.m": real_text(name, license_) for name in REAL if f"navsym_{name}(" in code}
    return found | {
        "navsym_numbers.m": NUMBERS.format(license=license_),
        "test_vectors.m": test(functions, names, license_),
        "vectors.txt": vectors_text(functions, tests),
    }


def helper_text(helper: Helper, license_: str) -> str:
    """One function against cancellation."""
    switch, below, above = helper_parts(helper, SPELLING)
    return "\n".join(
        [
            f"function f = navsym_{helper.name}(x)",
            f"  % {license_}",
            f"  % {helper_about(helper, SPELLING)}",
            *squares_if_needed(helper, "  y = x * x;"),
            f"  if abs(x) < {switch}",
            f"    f = {below};",
            "  else",
            f"    f = {above};",
            "  end",
            "end",
            "",
        ]
    )


def real_text(name: str, license_: str) -> str:
    """A function that stays real."""
    given, condition, value = REAL[name]
    return "\n".join(
        [
            f"function f = navsym_{name}({given})",
            f"  % {license_}",
            f"  % {value} where it is real, else NaN.",
            f"  if {condition}",
            f"    f = {value};",
            "  else",
            "    f = NaN;",
            "  end",
            "end",
            "",
        ]
    )


def source(function: ExportedFunction, name: str, license_: str) -> str:
    """The text of the file of a function; results are NaN where the status is not 0."""
    names = code_names(function, "{0}({1})", first=1)
    lines = [f"function {results_text(function)} = {name}({', '.join(a.name for a in function.called_with)})"]
    lines += [f"  %{name.upper()}  {function.sources[0].title or function.name}", "  %"]
    lines += [f"  % {counted_from_one(line)}" for line in summary(function)]
    lines += [f"  % Shape    {o.name}: {shape_text(o)}" for o in function.outputs]
    lines += [
        "  % Status   0: results are there; 1: an argument is outside the proved domain, or no double;",
        "  %          2: a result would overflow or is undefined here; results are NaN unless it is 0.",
        "",
        f"  % {license_}",
        "  status = 1;",
    ]
    lines += [f"  {o.name} = NaN({', '.join(map(str, rows_and_columns(o)))});" for o in function.outputs]
    tests = " && ...\n       ".join(in_range(function, a) for a in function.called_with)
    lines += [f"  if ~({tests})", "    return", "  end"] if tests else []
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, SPELLING)
        lines += [f"  {branch(function, place, 'if', 'elseif', 'else')}"] if len(function.pieces) > 1 else []
        inner = "    " if len(function.pieces) > 1 else "  "
        lines += [f"{inner}{local} = {text};" for local, text in temporaries]
        lines += [f"{inner}r{k} = {text};" for k, text in enumerate(results)]
    lines += ["  end"] if len(function.pieces) > 1 else []
    entries = ", ".join(f"r{k}" for k in range(function.size))
    lines += [f"  if ~all(isfinite([{entries}]))", "    status = 2;", "    return", "  end"]
    k = 0
    for output in function.outputs:
        lines.append(f"  {output.name} = {placed(output, k)};")
        k += output.size
    return "\n".join([*lines, "  status = 0;", "end", ""])


def counted_from_one(line: str) -> str:
    """A formula of an entry with its place as the language counts it."""
    return re.sub(r"^(Formula  \w+)\[(\d+)\] =", lambda found: f"{found[1]}({int(found[2]) + 1}) =", line)


def in_range(function: ExportedFunction, argument: Argument) -> str:
    """The test of one argument; entries of an array have one range or their own."""
    inputs = function.inputs[argument.first : argument.first + (argument.size or 1)]
    ends = [[SPELLING.number(x) for x in column] for column in ([i.low for i in inputs], [i.high for i in inputs])]
    low, high = (column[0] if len(set(column)) == 1 else f"[{' '.join(column)}]" for column in ends)
    return f"navsym_numbers({argument.name}, {argument.size or 1}, {low}, {high})"


def results_text(function: ExportedFunction) -> str:
    """The results of a call: status first."""
    return f"[{', '.join(['status', *(o.name for o in function.outputs)])}]"


def rows_and_columns(output: Output) -> tuple[int, int]:
    """A number, a column or a matrix."""
    rows, columns = (*output.shape, 1, 1)[:2] if output.shape else (1, 1)
    return rows, columns


def shape_text(output: Output) -> str:
    """What a caller gets, in words."""
    rows, columns = rows_and_columns(output)
    return "a number" if not output.shape else f"a column of {rows}" if columns == 1 else f"{rows} by {columns}"


def placed(output: Output, first: int) -> str:
    """An output made of its entries, row by row."""
    rows, columns = rows_and_columns(output)
    made = [", ".join(f"r{first + i * columns + j}" for j in range(columns)) for i in range(rows)]
    return f"[{'; '.join(made)}]" if output.shape else made[0]


# -- the test ---------------------------------------


def test(functions: Sequence[ExportedFunction], names: dict[str, str], license_: str) -> str:
    """The program that reads the vectors; a step is run through its state."""
    rows = []
    for f in functions:
        call = f"@navsym_through_{names[f.name]}" if f.state else f"@{names[f.name]}"
        sizes = " ".join(str(a.size or 1) for a in f.called_with)
        rows.append(f"    '{f.name}', {call}, [{sizes}], {len(f.outputs)}; ...")
    through = [octave_through_state(f, names[f.name], results_text(f)) for f in functions if f.state]
    return template("octave_test.m").format(license=license_, known="\n".join(rows)) + "".join(through)
