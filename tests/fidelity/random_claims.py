"""Random formulas of the kind that mislead: identities that hold on half of a box, edges, poles and cuts."""

from __future__ import annotations

IDENTITIES = [
    line.split(" == ")
    for line in """\
sqrt({u}**2) == {u}
sqrt({u}**2) == abs({u})
({u}**3)**(1/3) == {u}
{u}**2/{u} == {u}
sqrt({u})**2 == {u}
exp(log({u})) == {u}
log(exp({u})) == {u}
log({u}**2) == 2*log({u})
log({u}*{v}) == log({u}) + log({v})
sqrt({u}*{v}) == sqrt({u})*sqrt({v})
sqrt({u}/{v}) == sqrt({u})/sqrt({v})
asin(sin({u})) == {u}
sin(asin({u})) == {u}
acos(cos({u})) == {u}
cos(acos({u})) == {u}
atan(tan({u})) == {u}
tan(atan({u})) == {u}
atan2(sin({u}), cos({u})) == {u}
atan2({u}, {v}) == atan({u}/{v})
atan2({u}, {v}) == pi/2 - atan2({v}, {u})
atan({u}) + atan(1/({u})) == pi/2
tan({u})*cot({u}) == 1
tan({u}) == sin({u})/cos({u})
abs({u}*{v}) == abs({u})*abs({v})
abs({u} + {v}) == abs({u}) + abs({v})
({u})**{v} == exp({v}*log({u}))
({u}**2)**{v} == {u}**(2*{v})
{u}**{v}*{u}**(-{v}) == 1
sqrt(1 - cos({u})**2) == sin({u})
sqrt(1 - cos({u})) == sqrt(2)*sin({u}/2)
2*atan({u}) == atan(2*{u}/(1 - {u}**2))
2*atan({u}) == asin(2*{u}/(1 + {u}**2))
asin({u}) + acos({u}) == pi/2
{u}/abs({u}) == 1
sin({u} + {v}) == sin({u})*cos({v}) + cos({u})*sin({v})
cosh({u})**2 - sinh({u})**2 == 1
({u} - {v})/({u} - {v}) == 1
({u}**2 - {v}**2)/({u} - {v}) == {u} + {v}
0*log({u}) == 0
sin({u})**2 + cos({u})**2 == 1
{u}**2 == 0
{u} == {u} + 1/10**60
tan({u}) == {u}
sin({u}) == {u}
cos({u}) == 1 - {u}**2/2
exp({u}) == 1 + {u}
log({u}) == {u} - 1
{u}**3 - {u} == 0
1/{u} == 0
({u} - 1/3)**2 == 0
{u}*(1 - {u}) == 1/4
sqrt({u}) == {u}
{u}**2 + {v}**2 == 2*{u}*{v}
atan({u}) == pi/2
tanh({u}) == 1
sqrt(sqrt({u}**2) - {u}) == 0
sec({u})**2 - tan({u})**2 == 1
sin(2*atan2({u}, {v})) == 2*{u}*{v}/({u}**2 + {v}**2)
cos(atan2({u}, {v})/2) == sqrt(1/2 + {v}/(2*sqrt({u}**2 + {v}**2)))""".splitlines()
]
ARGUMENTS = "x; y; -x; x + y; 2*x; x - 1; x*y; x**2; cos(x); sin(x); 1 - x; x/2; x - y; abs(x)".split("; ")
DECLARED = [
    "real",
    "positive",
    "nonnegative",
    "nonzero",
    ["0", "1"],
    ["-1", "1"],
    ["-1", "0"],
    ["0", "2*pi"],
    ["0", "pi/2"],
    ["-pi/2", "pi/2"],
    ["1", "2"],
    ["0", "1/10**30"],
    ["-2", "-1/10**20"],
    ["pi/2", "3*pi/2"],
    ["1/3", "1"],
]
RELATIONS = ["=", "=", "=", "!=", "<", "<=", ">", ">="]


def random_claim(source):
    """A document of one claim."""
    left, right = source.choice(IDENTITIES)
    u, v = (f"({source.choice(ARGUMENTS)})" if source.random() < 0.5 else name for name in "xy")
    left, right = left.format(u=u, v=v), right.format(u=u, v=v)
    if source.random() < 0.3:
        extra = source.choice(["x", "y**2", "1/x", "sqrt(y)", "sin(x)", "log(y)"])
        left, right = f"{left} + {extra}", f"{right} + {extra}"
    symbols = {name: source.choice(DECLARED) for name in "xy"}
    row = {"id": "one", "left": left, "relation": source.choice(RELATIONS), "right": right}
    return {"symbols": symbols, "claim": [row]}
