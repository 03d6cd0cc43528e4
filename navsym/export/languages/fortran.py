"""Fortran 2008: one module of pure subroutines; names up to 63 characters, lines continued at 120."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, calls, template
from navsym.export.languages.scripts import branch, domain, short_names, vectors_text
from navsym.export.languages.summary import summary
from navsym.export.parts import ExportedFunction

SPELLING = Spelling(
    calls(abs="abs({0})", pow="(({0})**({1}))", max="max({0}, {1})", min="min({0}, {1})", expm1="navsym_expm1({0})"),
    "nan",
    "inf",
    exponent="d",
)


def files(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str) -> dict[str, str]:
    """Module and test program."""
    names = short_names(functions)
    lines = head(functions, license_)
    for function in functions:
        lines += source(function, names[function.name])
    lines += ["end module navsym_functions", ""]
    return {
        "navsym_functions.f90": "\n".join(piece for line in lines for piece in continued(line)),
        "test_vectors.f90": test(functions, names, license_),
        "vectors.txt": vectors_text(functions, tests),
    }


def head(functions: Sequence[ExportedFunction], license_: str) -> list[str]:
    """The head of the module, with the helpers."""
    lines = [
        f"! {license_}",
        "module navsym_functions",
        "  use, intrinsic :: iso_fortran_env, only: real64",
        "  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite",
        "  implicit none",
        "contains",
    ]
    lines += [line for h in helpers_used(*functions) for line in helper_text(h)]
    operations = {op for f in functions for piece in f.pieces for op in piece.graph.operations()}
    operations |= {op for h in helpers_used(*functions) for op in h.operations}
    return [*lines, *EXPM1] if "expm1" in operations else lines


EXPM1 = [
    "  pure elemental function navsym_expm1(x) result(f)",
    "    real(real64), intent(in) :: x",
    "    real(real64) :: f",
    "    f = 2.0d0 * sinh(x / 2.0d0) * exp(x / 2.0d0)",
    "  end function",
    "",
]


def helper_text(helper: Helper) -> list[str]:
    """One function against cancellation."""
    switch, below, above = helper_parts(helper, SPELLING)
    y = squares_if_needed(helper, ", y")
    return [
        f"  pure elemental function navsym_{helper.name}(x) result(f)",
        "    real(real64), intent(in) :: x",
        f"    real(real64) :: f{''.join(y)}",
        *squares_if_needed(helper, "    y = x * x"),
        f"    if (abs(x) < {switch}) then",
        f"      f = {below}",
        "    else",
        f"      f = {above}",
        "    end if",
        "  end function",
        "",
    ]


def continued(line: str) -> list[str]:
    """A long statement over several lines; comments are cut."""
    if line.lstrip().startswith("!"):
        return [line[:130]]
    parts = []
    while len(line) > 110:
        cut = line.rfind(" ", 40, 110)
        if cut < 0:
            break
        parts.append(line[:cut] + " &")
        line = "      " + line[cut:]
    return [*parts, line]


def source(function: ExportedFunction, name: str) -> list[str]:
    """Lines of the pure subroutine of a function, under this name."""
    names = [i.name for i in function.inputs]
    pieces = [assignments(piece, names, SPELLING) for piece in function.pieces]
    arguments = ", ".join([*names, *(o.name for o in function.outputs), "status"])
    lines = [*(f"  ! {line}" for line in summary(function)), f"  pure subroutine {name}({arguments})"]
    lines += [f"    real(real64), intent(in) :: {n}" for n in names]
    lines += [f"    real(real64), intent(out) :: {o.name}{f'({o.size})' if o.shape else ''}" for o in function.outputs]
    lines += ["    integer, intent(out) :: status", f"    real(real64) :: nv_r({function.size})"]
    lines += [f"    real(real64) :: {local}" for local in dict.fromkeys(t for lets, _ in pieces for t, _ in lets)]
    lines += [f"    {o.name} = 0.0d0" for o in function.outputs]
    test = domain(function, "huge(1.0d0)", SPELLING, " .and. ", ".true.")
    lines += ["    status = 1", f"    if (.not. ({test})) return"]
    for place, (temporaries, results) in enumerate(pieces):
        word = branch(function, place, "if", "else if", "else")
        then = " then" if word != "else" else ""
        limit = function.pieces[place].limit
        word = word.replace(repr(limit), SPELLING.number(limit)) if limit is not None else word
        lines += [f"    {word}{then}"] if len(pieces) > 1 else []
        lines += [f"      {t} = {text}" for t, text in temporaries]
        lines += [f"      nv_r({k + 1}) = {text}" for k, text in enumerate(results)]
    lines += ["    end if"] if len(pieces) > 1 else []
    lines += ["    status = 2", "    if (.not. all(ieee_is_finite(nv_r))) return"]
    k = 0
    for output in function.outputs:
        lines.append(f"    {output.name} = nv_r({k + 1}{f':{k + output.size}' if output.shape else ''})")
        k += output.size
    return [*lines, "    status = 0", "  end subroutine", ""]


def test(functions: Sequence[ExportedFunction], names: dict[str, str], license_: str) -> str:
    """The program that reads the vectors, with a case for each function."""
    widest = max(len(f.inputs) + 3 * f.size for f in functions)
    cases = [line for k, f in enumerate(functions, start=1) for line in case(f, names[f.name], k)]
    prints = [
        f'  print "(a,i0,a,i0,a,f0.3)", "{f.name} vectors ", counts({k}), " wrong ", wrong({k}), " worst ", worst({k})'
        for k, f in enumerate(functions, start=1)
    ]
    text = template("fortran_test.f90").format(
        license=license_,
        total=len(functions),
        widest=widest,
        most=max(f.size for f in functions),
        longest=max(20000, 26 * widest + 300),
        cases="\n".join(cases),
        prints="\n".join(prints),
    )
    return "\n".join(part for line in text.splitlines() for part in continued(line)) + "\n"


def case(function: ExportedFunction, name: str, number: int) -> list[str]:
    """Reading a line of vectors of one function, and its call."""
    n, k, outputs = len(function.inputs), 0, []
    for output in function.outputs:
        outputs.append(f"r({k + 1}:{k + output.size})" if output.shape else f"r({k + 1})")
        k += output.size
    arguments = ", ".join([*(f"v({j + 1})" for j in range(n)), *outputs, "status"])
    return [
        f'    case ("{function.name}")',
        f"      n = {n}",
        f"      m = {function.size}",
        f"      k = {number}",
        "      read(line, *) name, expected, v(1:n + 3 * m)",
        f"      call {name}({arguments})",
    ]
