# ---
# jupyter:
#   jupytext:
#     formats: py:percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # From code to correction
#
# **Question.** A filter turns by unit quaternions and corrects its yaw with two antennas. Somebody has written the
# measurement row by hand. Is it the derivative of what the code predicts, and if it is not, what has to change?

# %%
from pathlib import Path
from tempfile import mkdtemp

import navsym as nav

FOLDER = Path(mkdtemp())
CODE = """
void yaw(const float q[4], float c, float s, float *angle)
{
    const float x = c * (1 - 2 * (q[2]*q[2] + q[3]*q[3])) + s * 2 * (q[1]*q[2] - q[0]*q[3]);
    const float y = c * 2 * (q[1]*q[2] + q[0]*q[3]) + s * (1 - 2 * (q[1]*q[1] + q[3]*q[3]));
    *angle = atan2f(y, x);
}

void row(const float q[4], float c, float s, float H[4])
{
    const float x = c * (q[0]*q[0] + q[1]*q[1] - q[2]*q[2] - q[3]*q[3]) + s * 2 * (q[1]*q[2] - q[0]*q[3]);
    const float y = c * 2 * (q[1]*q[2] + q[0]*q[3]) + s * (q[0]*q[0] - q[1]*q[1] + q[2]*q[2] - q[3]*q[3]);
    const float n = x*x + y*y;
    H[0] = (x * (2*c*q[3] + 2*s*q[0]) - y * (2*c*q[0] - 2*s*q[3])) / n;
    H[1] = (x * (2*c*q[2] - 2*s*q[1]) - y * (2*c*q[1] + 2*s*q[2])) / n;
    H[2] = (x * (2*c*q[1] + 2*s*q[2]) - y * (2*c*q[2] + 2*s*q[1])) / n;
    H[3] = (x * (2*c*q[0] - 2*s*q[3]) - y * (-2*c*q[3] - 2*s*q[0])) / n;
}
"""
(FOLDER / "yaw.c").write_text(CODE)

# %% [markdown]
# ## 1. What the code computes
#
# Nothing is compiled. The outputs are formulas of the inputs, with their lines.

# %%
for formula in nav.audit(FOLDER / "yaw.c", function="yaw").formulas:
    print(formula.line, formula.name, "=", formula.formula)

# %% [markdown]
# ## 2. The question
#
# `H` should be the derivative of the angle by `q`. The mapping says that `q` has length one.

# %%
RELATION = 'relations = ["q[0]**2 + q[1]**2 + q[2]**2 + q[3]**2 = 1"]'
SOURCES = "".join(
    f'[[code]]\nname = "{name}"\nfile = "yaw.c"\nfunction = "{name}"\n{RELATION}\n' for name in ("yaw", "row")
)
QUESTION = '[[question]]\nname = "H"\nkind = "jacobian"\nof = "yaw:angle"\nby = "yaw:q"\nis = "row:H"\n'


def ask(question):
    """The answer to the question, about the code as it is now."""
    (FOLDER / "spec.toml").write_text(SOURCES + question)
    return nav.audit(FOLDER / "spec.toml")["H"]


exact = ask(QUESTION)
for entry in exact.entries:
    print(entry.entry, entry.status, entry.line, entry.why)
assert exact.status == nav.REFUTED and exact.weaker is None

# %% [markdown]
# All four entries differ. That alone says little: the two functions write the rotation in two ways, which agree only
# where |q| = 1, and so do their derivatives only along the unit sphere.
#
# ## 3. The sense
#
# A filter moves along the sphere. What matters is whether the row agrees on tangent vectors, the sense `tangent`.

# %%
tangent = ask(f'{QUESTION}senses = ["tangent"]\n')
assert tangent.status == nav.REFUTED

# %% [markdown]
# It does not, so there is a fault. A suggestion mends one entry of a question as it stands. Here the row is compared
# with the derivative of the same formulas: a third function, which is the angle in the other form.

# %%
SAME = CODE.split("    const float n")[0].split("void row")[1].replace("float H[4]", "float *angle")
(FOLDER / "yaw.c").write_text(f"{CODE}\nvoid form{SAME}    *angle = atan2f(y, x);\n}}\n")
FORM = f'[[code]]\nname = "form"\nfile = "yaw.c"\nfunction = "form"\n{RELATION}\n'
third = ask(FORM + QUESTION.replace("yaw:", "form:"))
(wrong,) = (entry for entry in third.entries if not entry.status.holds)
print(f"line {wrong.line}: is {wrong.values[0]}, expected {wrong.values[1]}")
print("write", wrong.suggestion)

# %% [markdown]
# ## 4. The correction
#
# One sign of `H[2]` was lost. With the suggestion in its place the row is proved in the sense `tangent`, and the
# checker accepts the certificates without the search.

# %%
lines = CODE.split("\n")
at = next(i for i, line in enumerate(lines) if "H[2] =" in line)
lines[at] = f"    H[2] = {wrong.suggestion};"
(FOLDER / "yaw.c").write_text("\n".join(lines))
mended = ask(f'{QUESTION}senses = ["tangent"]\n')
print(mended.status, "in the sense", mended.sense)
assert mended.status == nav.PROVED and mended.sense == "tangent"
assert {item.status for item in nav.check(nav.audit(FOLDER / "spec.toml"))} == {"ACCEPTED"}
