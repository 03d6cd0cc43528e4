"""Fortran, Julia and Octave/MATLAB: three spellings of the same assignments.

Their toolchains are often missing; then the manifest says "not executed", never "verified".
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.printing import (
    Spelling,
    assignments,
    calls,
    helper_parts,
    helpers_used,
    squares_if_needed,
    summary,
)
from navsym.export.parts import ExportedFunction

JULIA = Spelling(calls(abs="abs({0})", atan2="atan({0}, {1})", pow="({0})^({1})", max="max({0}, {1})",
                       min="min({0}, {1})"), "NaN", "Inf")  # fmt: skip
OCTAVE = Spelling(
    calls(abs="abs({0})", pow="({0})^({1})", max="max({0}, {1})", min="min({0}, {1})"), "NaN", "Inf"
)
FORTRAN = Spelling(
    calls(abs="abs({0})", pow="(({0})**({1}))", max="max({0}, {1})", min="min({0}, {1})", expm1="navsym_expm1({0})"),
    "nan", "inf", exponent="d",
)  # fmt: skip


def vectors_text(functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]]) -> str:
    """One line a vector: name, status, arguments, lower, upper, nearest; for languages without JSON."""
    lines = []
    for function in functions:
        for v in tests[function.name]:
            tail = [x for part in (v.lower, v.upper, v.nearest) for x in (part or (0.0,) * function.size)]
            numbers = " ".join("NaN" if math.isnan(x) else repr(x) for x in (*v.inputs, *tail))
            lines.append(f"{function.name} {v.status} {numbers}")
    return "\n".join(lines) + "\n"


# -- Julia ---------------------------------------


def julia_files(
    functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str
) -> dict[str, str]:
    """Module and test script."""
    head = [f"# {license_}", "# Every function returns (status, results...); results are there when status == 0.",
            "module NavsymFunctions", ""]  # fmt: skip
    head += [line for name in helpers_used(*functions) for line in julia_helper(name)]
    body = [line for f in functions for line in julia_source(f)]
    return {
        "NavsymFunctions.jl": "\n".join([*head, *body, "end", ""]),
        "test_vectors.jl": JULIA_TEST.format(license=license_),
        "vectors.txt": vectors_text(functions, tests),
    }


def julia_helper(name: str) -> list[str]:
    """One function against cancellation."""
    switch, below, above = helper_parts(name, JULIA)
    return [f"function navsym_{name}(x)", *squares_if_needed(name, "    y = x * x"),
            f"    return abs(x) < {switch} ? {below} : {above}", "end", ""]  # fmt: skip


def julia_source(function: ExportedFunction) -> list[str]:
    names = [i.name for i in function.inputs]
    lines = [*(f"# {line}" for line in summary(function)), f"function {function.name}({', '.join(names)})"]
    lines += [f"    if !({domain(function, 'floatmax(Float64)', JULIA)})", "        return (1,)", "    end"]
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, JULIA)
        word = branch(function, place, "if", "elseif", "else")
        lines += [f"    {word}"] if len(function.pieces) > 1 else []
        lines += [f"        {name} = {text}" for name, text in temporaries]
        lines += [f"        r{k} = {text}" for k, text in enumerate(results)]
    lines += ["    end"] if len(function.pieces) > 1 else []
    entries = ", ".join(f"r{k}" for k in range(function.size))
    lines += [f"    if !all(isfinite, ({entries},))", "        return (2,)", "    end"]
    return [*lines, f"    return (0, {entries})", "end", ""]


def branch(function: ExportedFunction, place: int, first: str, later: str, last: str) -> str:
    piece = function.pieces[place]
    if piece.limit is None:
        return last
    condition = f"{function.inputs[function.switch or 0].name} <= {piece.limit!r}"
    return f"{later if place else first} ({condition})"


def domain(
    function: ExportedFunction, largest: str, s: Spelling, both: str = " && ", true: str = "true"
) -> str:
    """Comparisons of every argument with its range, in this language."""
    tests = []
    for i in function.inputs:
        low = f"-{largest}" if math.isinf(i.low) else s.number(i.low)
        high = largest if math.isinf(i.high) else s.number(i.high)
        tests.append(f"({i.name} >= {low}){both}({i.name} <= {high})")
    return both.join(tests) or true


JULIA_TEST = """# {license}
include("NavsymFunctions.jl")

function main()
    count, wrong, worst = Dict{{String,Int}}(), Dict{{String,Int}}(), Dict{{String,Float64}}()
    for line in eachline(joinpath(@__DIR__, "vectors.txt"))
        words = split(line)
        name, status = String(words[1]), parse(Int, words[2])
        numbers = parse.(Float64, words[3:end])
        f = getfield(NavsymFunctions, Symbol(name))
        inputs = first(methods(f)).nargs - 1
        size = div(length(numbers) - inputs, 3)
        found = f(numbers[1:inputs]...)
        count[name] = get(count, name, 0) + 1
        bad = found[1] != status ? 1 : 0
        if found[1] == 0 && status == 0
            for j in 1:size
                low, high, near = numbers[inputs + j], numbers[inputs + size + j], numbers[inputs + 2size + j]
                bad += low <= found[1 + j] <= high ? 0 : 1
                unit = abs(near) * eps(Float64)
                if unit > 0 && high - near < 1000 * unit
                    worst[name] = max(get(worst, name, 0.0), abs(found[1 + j] - near) / unit)
                end
            end
        end
        wrong[name] = get(wrong, name, 0) + bad
    end
    for name in keys(count)
        println("$name vectors $(count[name]) wrong $(wrong[name]) worst $(get(worst, name, 0.0))")
    end
    exit(Base.count(>(0), values(wrong)))
end

main()
"""

# -- Octave and MATLAB ---------------------------------------


def octave_files(
    functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str
) -> dict[str, str]:
    """One file for each function, for each helper, and the test script."""
    found = {f"navsym_{name}.m": octave_helper(name) for name in helpers_used(*functions)}
    found |= {f"{f.name}.m": octave_source(f, license_) for f in functions}
    sizes = "\n".join(f"  s.{f.name} = [{len(f.inputs)}, {f.size}];" for f in functions)
    return found | {
        "test_vectors.m": OCTAVE_TEST.format(license=license_, sizes=sizes),
        "vectors.txt": vectors_text(functions, tests),
    }


def octave_helper(name: str) -> str:
    """One function against cancellation."""
    switch, below, above = helper_parts(name, OCTAVE)
    return "\n".join([
        f"function f = navsym_{name}(x)", *squares_if_needed(name, "  y = x * x;"), f"  if abs(x) < {switch}",
        f"    f = {below};", "  else", f"    f = {above};", "  end", "end", "",
    ])  # fmt: skip


def octave_source(function: ExportedFunction, license_: str) -> str:
    names = [i.name for i in function.inputs]
    outputs = ", ".join(["status", *(o.name for o in function.outputs)])
    lines = [f"function [{outputs}] = {function.name}({', '.join(names)})", f"  % {license_}"]
    lines += [f"  % {line}" for line in summary(function)]
    lines += [f"  {o.name} = zeros(1, {o.size});" for o in function.outputs]
    lines += [f"  if ~({domain(function, 'realmax', OCTAVE)})", "    status = 1;", "    return", "  end"]
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, OCTAVE)
        lines += [f"  {branch(function, place, 'if', 'elseif', 'else')}"] if len(function.pieces) > 1 else []
        lines += [f"    {name} = {text};" for name, text in temporaries]
        lines += [f"    r{k} = {text};" for k, text in enumerate(results)]
    lines += ["  end"] if len(function.pieces) > 1 else []
    entries = ", ".join(f"r{k}" for k in range(function.size))
    lines += [f"  if ~all(isfinite([{entries}]))", "    status = 2;", "    return", "  end"]
    k = 0
    for output in function.outputs:
        lines.append(f"  {output.name} = [{', '.join(f'r{k + e}' for e in range(output.size))}];")
        k += output.size
    return "\n".join([*lines, "  status = 0;", "end", ""])


OCTAVE_TEST = """% {license}
function test_vectors()
{sizes}
  names = fieldnames(s);
  count = zeros(size(names)); wrong = count; worst = count;
  file = fopen(fullfile(fileparts(mfilename("fullpath")), "vectors.txt"));
  line = fgetl(file);
  while ischar(line)
    words = strsplit(strtrim(line), " ");
    name = words{{1}}; k = find(strcmp(names, name)); shape = s.(name);
    numbers = str2double(words(3:end)); n = shape(1); m = shape(2);
    arguments = num2cell(numbers(1:n));
    results = cell(1, nargout(name));
    [results{{:}}] = feval(name, arguments{{:}});
    count(k) = count(k) + 1;
    wrong(k) = wrong(k) + (results{{1}} ~= str2double(words{{2}}));
    if results{{1}} == 0 && str2double(words{{2}}) == 0
      values = [results{{2:end}}];
      low = numbers(n+1:n+m); high = numbers(n+m+1:n+2*m); near = numbers(n+2*m+1:n+3*m);
      wrong(k) = wrong(k) + sum(~(values >= low & values <= high));
      unit = abs(near) * eps; good = unit > 0 & high - near < 1000 * unit;
      worst(k) = max([worst(k), abs(values(good) - near(good)) ./ unit(good)]);
    end
    line = fgetl(file);
  end
  fclose(file);
  for k = 1:numel(names)
    printf("%s vectors %d wrong %d worst %.3g\\n", names{{k}}, count(k), wrong(k), worst(k));
  end
  exit(sum(wrong > 0));
end
"""

# -- Fortran ---------------------------------------


def fortran_files(
    functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str
) -> dict[str, str]:
    """Module and test program; names up to 63 characters, lines continued at 120."""
    names = {f.name: f"nv{k}_{f.name}"[:63] if len(f.name) > 63 else f.name for k, f in enumerate(functions)}
    lines = fortran_head(functions, license_)
    for function in functions:
        lines += fortran_source(function, names[function.name])
    lines += ["end module navsym_functions", ""]
    return {
        "navsym_functions.f90": "\n".join(piece for line in lines for piece in continued(line)),
        "test_vectors.f90": fortran_test(functions, names, license_),
        "vectors.txt": vectors_text(functions, tests),
    }


def fortran_head(functions: Sequence[ExportedFunction], license_: str) -> list[str]:
    """The head of the module, with the helpers."""
    lines = [f"! {license_}", "module navsym_functions", "  use, intrinsic :: iso_fortran_env, only: real64",
             "  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite", "  implicit none", "contains"]  # fmt: skip
    lines += [line for name in helpers_used(*functions) for line in fortran_helper(name)]
    operations = {op for f in functions for piece in f.pieces for op in piece.graph.operations()}
    return [*lines, *FORTRAN_EXPM1] if operations & {"expm1", "exprel"} else lines


FORTRAN_EXPM1 = [
    "  pure elemental function navsym_expm1(x) result(f)", "    real(real64), intent(in) :: x",
    "    real(real64) :: f", "    f = 2.0d0 * sinh(x / 2.0d0) * exp(x / 2.0d0)", "  end function", "",
]  # fmt: skip


def fortran_helper(name: str) -> list[str]:
    """One function against cancellation."""
    switch, below, above = helper_parts(name, FORTRAN)
    y = squares_if_needed(name, ", y")
    return [f"  pure elemental function navsym_{name}(x) result(f)", "    real(real64), intent(in) :: x",
            f"    real(real64) :: f{''.join(y)}", *squares_if_needed(name, "    y = x * x"),
            f"    if (abs(x) < {switch}) then", f"      f = {below}", "    else", f"      f = {above}", "    end if",
            "  end function", ""]  # fmt: skip


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


def fortran_source(function: ExportedFunction, name: str) -> list[str]:
    names = [i.name for i in function.inputs]
    pieces = [assignments(piece, names, FORTRAN) for piece in function.pieces]
    arguments = ", ".join([*names, *(o.name for o in function.outputs), "status"])
    lines = [*(f"  ! {line}" for line in summary(function)), f"  pure subroutine {name}({arguments})"]
    lines += [f"    real(real64), intent(in) :: {n}" for n in names]
    lines += [
        f"    real(real64), intent(out) :: {o.name}{f'({o.size})' if o.shape else ''}"
        for o in function.outputs
    ]
    lines += ["    integer, intent(out) :: status", f"    real(real64) :: nv_r({function.size})"]
    lines += [f"    real(real64) :: {local}" for local in dict.fromkeys(t for lets, _ in pieces for t, _ in lets)]
    lines += [f"    {o.name} = 0.0d0" for o in function.outputs]
    test = domain(function, "huge(1.0d0)", FORTRAN, " .and. ", ".true.")
    lines += ["    status = 1", f"    if (.not. ({test})) return"]
    for place, (temporaries, results) in enumerate(pieces):
        word = branch(function, place, "if", "else if", "else")
        then = " then" if word != "else" else ""
        limit = function.pieces[place].limit
        word = word.replace(repr(limit), FORTRAN.number(limit)) if limit is not None else word
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


FORTRAN_TEST = """! {license}
program test_vectors
  use, intrinsic :: iso_fortran_env, only: real64
  use navsym_functions
  implicit none
  integer, parameter :: total = {total}
  character(len=200) :: name
  character(len={longest}) :: line
  real(real64) :: v({widest}), r({most}), unit, worst(total)
  integer :: expected, status, io, n, m, j, k, counts(total), wrong(total)
  counts = 0
  wrong = 0
  worst = 0.0d0
  open(10, file="vectors.txt", status="old")
  do
    read(10, "(a)", iostat=io) line
    if (io /= 0) exit
    read(line, *) name
    select case (trim(name))
{cases}
    end select
    counts(k) = counts(k) + 1
    if (status /= expected) wrong(k) = wrong(k) + 1
    if (status == 0 .and. expected == 0) then
      do j = 1, m
        if (.not. (r(j) >= v(n + j) .and. r(j) <= v(n + m + j))) wrong(k) = wrong(k) + 1
        unit = abs(v(n + 2 * m + j)) * epsilon(1.0d0)
        if (unit > 0.0d0 .and. v(n + m + j) - v(n + 2 * m + j) < 1000 * unit) then
          worst(k) = max(worst(k), abs(r(j) - v(n + 2 * m + j)) / unit)
        end if
      end do
    end if
  end do
{prints}
  if (any(wrong > 0)) error stop 1
end program
"""


def fortran_test(functions: Sequence[ExportedFunction], names: dict[str, str], license_: str) -> str:
    """The program that reads the vectors, with a case for each function."""
    widest = max(len(f.inputs) + 3 * f.size for f in functions)
    cases = [line for k, f in enumerate(functions, start=1) for line in fortran_case(f, names[f.name], k)]
    prints = [
        f'  print "(a,i0,a,i0,a,f0.3)", "{f.name} vectors ", counts({k}), " wrong ", wrong({k}), " worst ", worst({k})'
        for k, f in enumerate(functions, start=1)
    ]
    text = FORTRAN_TEST.format(
        license=license_, total=len(functions), widest=widest, most=max(f.size for f in functions),
        longest=max(20000, 26 * widest + 300), cases="\n".join(cases), prints="\n".join(prints),
    )  # fmt: skip
    return "\n".join(part for line in text.splitlines() for part in continued(line)) + "\n"


def fortran_case(function: ExportedFunction, name: str, number: int) -> list[str]:
    """Reading a line of vectors of one function, and its call."""
    n, k, outputs = len(function.inputs), 0, []
    for output in function.outputs:
        outputs.append(f"r({k + 1}:{k + output.size})" if output.shape else f"r({k + 1})")
        k += output.size
    arguments = ", ".join([*(f"v({j + 1})" for j in range(n)), *outputs, "status"])
    return [f'    case ("{function.name}")', f"      n = {n}", f"      m = {function.size}", f"      k = {number}",
            "      read(line, *) name, expected, v(1:n + 3 * m)", f"      call {name}({arguments})"]  # fmt: skip
