"""Octave and MATLAB: one file for each function, which returns its status and the results."""

from __future__ import annotations

from collections.abc import Sequence

from navsym.export.accuracy.vectors import Vector
from navsym.export.languages.helpers import Helper, helper_parts, helpers_used, squares_if_needed
from navsym.export.languages.printing import Spelling, assignments, calls
from navsym.export.languages.scripts import branch, domain, vectors_text
from navsym.export.languages.summary import summary
from navsym.export.parts import ExportedFunction

SPELLING = Spelling(
    calls(abs="abs({0})", pow="({0})^({1})", max="max({0}, {1})", min="min({0}, {1})"), "NaN", "Inf"
)


def files(
    functions: Sequence[ExportedFunction], tests: dict[str, list[Vector]], license_: str
) -> dict[str, str]:
    """One file for each function, for each helper, and the test script."""
    found = {f"navsym_{h.name}.m": helper_text(h) for h in helpers_used(*functions)}
    found |= {f"{f.name}.m": source(f, license_) for f in functions}
    sizes = "\n".join(f"  s.{f.name} = [{len(f.inputs)}, {f.size}];" for f in functions)
    return found | {
        "test_vectors.m": TEST.format(license=license_, sizes=sizes),
        "vectors.txt": vectors_text(functions, tests),
    }


def helper_text(helper: Helper) -> str:
    """One function against cancellation."""
    switch, below, above = helper_parts(helper, SPELLING)
    return "\n".join([
        f"function f = navsym_{helper.name}(x)", *squares_if_needed(helper, "  y = x * x;"), f"  if abs(x) < {switch}",
        f"    f = {below};", "  else", f"    f = {above};", "  end", "end", "",
    ])  # fmt: skip


def source(function: ExportedFunction, license_: str) -> str:
    """The text of the file of a function; results are zero where the status is not 0."""
    names = [i.name for i in function.inputs]
    outputs = ", ".join(["status", *(o.name for o in function.outputs)])
    lines = [f"function [{outputs}] = {function.name}({', '.join(names)})", f"  % {license_}"]
    lines += [f"  % {line}" for line in summary(function)]
    lines += [f"  {o.name} = zeros(1, {o.size});" for o in function.outputs]
    lines += [f"  if ~({domain(function, 'realmax', SPELLING)})", "    status = 1;", "    return", "  end"]
    for place, piece in enumerate(function.pieces):
        temporaries, results = assignments(piece, names, SPELLING)
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


TEST = """% {license}
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
