"""Theorems with known hypotheses, in random arguments, rewritten by equal steps, and changed by known amounts."""

from __future__ import annotations

import random
from fractions import Fraction

from tests.attacks.statements import Statement, family, find_failure
from tests.attacks.trees import ONE, Tree, number, read, replace, write

REAL = """
sin(2*a) = 2*sin(a)*cos(a) | cos(2*a) = 1 - 2*sin(a)**2 | sin(a + b) = sin(a)*cos(b) + cos(a)*sin(b)
cos(a - b) = cos(a)*cos(b) + sin(a)*sin(b) | sin(3*a) = 3*sin(a) - 4*sin(a)**3 | cos(3*a) = 4*cos(a)**3 - 3*cos(a)
cosh(a)**2 - sinh(a)**2 = 1 | sinh(a + b) = sinh(a)*cosh(b) + cosh(a)*sinh(b) | exp(a + b) = exp(a)*exp(b)
tanh(2*a) = 2*tanh(a)/(1 + tanh(a)**2) | sqrt(a**2) = abs(a) | abs(a*b) = abs(a)*abs(b) | abs(a)**2 = a**2
(a + b)**3 = a**3 + 3*a**2*b + 3*a*b**2 + b**3 | a**4 - b**4 = (a - b)*(a + b)*(a**2 + b**2)
sin(a)*sin(b) = (cos(a - b) - cos(a + b))/2 | sin(a) + sin(b) = 2*sin((a + b)/2)*cos((a - b)/2)
atan(sinh(a)) = 2*atan(tanh(a/2)) | cos(atan(a)) = 1/sqrt(1 + a**2) | sin(atan(a)) = a/sqrt(1 + a**2)
log(exp(a)) = a | log(cosh(a) + sinh(a)) = a | sqrt(1 + sinh(a)**2) = cosh(a) | sqrt((a - b)**2) = abs(a - b)
log(exp(a) + exp(b)) = a + log(1 + exp(b - a)) | sin(a)**2 - sin(b)**2 = sin(a + b)*sin(a - b)
abs(a - b) + a + b = a + b + sqrt(a**2 - 2*a*b + b**2) | cosh(2*a) = 1 + 2*sinh(a)**2 | atan(-a) = -atan(a)
sin(a)**4 + cos(a)**4 = 1 - sin(2*a)**2/2 | tanh(a) = 1 - 2/(exp(2*a) + 1)
(a*d - b*c)**2 + (a*c + b*d)**2 = (a**2 + b**2)*(c**2 + d**2) | atan2(sinh(a), 1) = atan(sinh(a))
asin(tanh(a)) = atan(sinh(a)) | acos(1/cosh(a)) = abs(atan(sinh(a))) | sinh(a) = (exp(a) - exp(-a))/2
"""
POSITIVE = """
log(a*b) = log(a) + log(b) | log(a/b) = log(a) - log(b) | sqrt(a*b) = sqrt(a)*sqrt(b) | a**(1/3)*a**(2/3) = a
exp(log(a)/2) = sqrt(a) | log(a**3) = 3*log(a) | atan(a) + atan(1/a) = pi/2 | atan2(a, b) = atan(a/b)
(sqrt(a) - sqrt(b))*(sqrt(a) + sqrt(b)) = a - b | a**b = exp(b*log(a)) | log(sqrt(a)) = log(a)/2
sqrt(a + b + 2*sqrt(a*b)) = sqrt(a) + sqrt(b) | cosh(log(a)) = (a + 1/a)/2 | abs(a) = a
tanh(log(a)) = (a**2 - 1)/(a**2 + 1) | (a**(1/4))**2 = sqrt(a) | a**1.5 = a*sqrt(a) | sqrt(a/b) = sqrt(a)/sqrt(b)
1/(sqrt(a) + sqrt(b))*(a - b) = sqrt(a) - sqrt(b) | exp(-log(a)) = 1/a | sqrt(a**3) = a*sqrt(a)
"""
UNIT = """
sin(acos(a)) = sqrt(1 - a**2) | cos(asin(a)) = sqrt(1 - a**2) | asin(a) + acos(a) = pi/2 | acos(-a) = pi - acos(a)
cos(2*acos(a)) = 2*a**2 - 1 | sin(2*asin(a)) = 2*a*sqrt(1 - a**2) | cos(3*acos(a)) = 4*a**3 - 3*a
asin(-a) = -asin(a) | sin(3*asin(a)) = 3*a - 4*a**3 | acos(a) = 2*asin(sqrt((1 - a)/2)) | sin(asin(a)) = a
sqrt(1 - a)*sqrt(1 + a) = sqrt(1 - a**2) | acos(a) = atan2(sqrt(1 - a**2), a)
"""
PARTIAL = """
tan(a) = sin(a)/cos(a) | (a**2 - 1)/(a - 1) = a + 1 | a/a = 1 | cot(a)*tan(a) = 1 | sec(a)**2 = 1 + tan(a)**2
1/a + 1/b = (a + b)/(a*b) | (1 - cos(a))/sin(a) = tan(a/2) | sin(a)/(1 + cos(a)) = tan(a/2) | csc(a)*sin(a) = 1
tan(a + b) = (tan(a) + tan(b))/(1 - tan(a)*tan(b)) | exp(log(a)) = a | log(a**2) = 2*log(abs(a))
sqrt(a)**2 = a | sqrt(a)*sqrt(b) = sqrt(a*b) | (a**3 - b**3)/(a - b) = a**2 + a*b + b**2 | abs(a)/a = a/abs(a)
sin(asin(a)) = a | cos(acos(a)) = a | cot(a) - tan(a) = 2*cot(2*a) | 2*csc(2*a) = sec(a)*csc(a) | a**0.5*a**0.5 = a
atan2(a, b) + atan2(-a, -b) = 2*atan2(a, b) - pi*abs(a)/a | a*b/b = a | (sin(a)/a)*a = sin(a) | tan(atan(a)) = a
"""
ARGUMENTS = {
    "real": (
        "x", "y", "2*x", "x - y", "x*y", "x**2 - 1", "sin(x)", "x/3 + 1", "cos(y)*x", "abs(x)", "exp(x/2)", "x - pi/3",
        "tanh(y)", "x + sqrt(2)*y", "y/(1 + x**2)", "-x", "atan(x)", "x**3", "1e-3*x", "x + 1/7", "abs(x - 1)", "pi*y",
    ),
    "positive": ("p", "q", "1 + x**2", "exp(y)", "2 + sin(x)", "cosh(x)", "p*q", "p/q", "p**2 + 1/3", "sqrt(p)",
    "p + q",
                 "1 + abs(y)", "3*p", "p**(1/3)", "1/(1 + p)"),
    "unit": ("u", "sin(x)", "tanh(y)", "2*x/(1 + x**2)", "u**2", "-u", "cos(x)*u", "u**3", "1/(1 + p)", "u/2"),
}  # fmt: skip
DECLARED = {"x": "real", "y": "real", "p": "positive", "q": "positive", "u": ["-1", "1"]}
EXPONENTS = (-3, -6, -9, -12, -15, -18, -24, -30)


def split(table: str) -> list[tuple[str, str]]:
    """The sides of a table of equations."""
    return [tuple(line.split(" = ")) for row in table.strip().splitlines() for line in row.split(" | ")]


def draw_theorem(rng: random.Random, table: str, kind: str) -> tuple[Tree, Tree]:
    """Both sides of a theorem, with arguments of a kind in place of its letters."""
    left, right = (read(side) for side in rng.choice(split(table)))
    values = {name: read(rng.choice(ARGUMENTS[kind])) for name in "abcd"}
    if rng.random() < 0.3:  # the letters themselves
        values = {
            name: read({"real": name, "positive": "p" if name == "a" else "q", "unit": "u"}[kind]) for name in "abcd"
        }
    return replace(left, values), replace(right, values)


def rewrite(tree: Tree, rng: random.Random, steps: int) -> Tree:
    """An equal formula, defined where the first is, by random steps at random places."""
    for _ in range(steps):
        tree = rewrite_somewhere(tree, rng)
    return tree


def rewrite_somewhere(tree: Tree, rng: random.Random) -> Tree:
    head, *parts = tree
    inside = [k for k, part in enumerate(parts) if isinstance(part, tuple)]
    if head == "**":
        inside = [0]
    if inside and rng.random() < 0.7:
        k = rng.choice(inside)
        parts[k] = rewrite_somewhere(parts[k], rng)
        return (head, *parts)
    return rewrite_here(tree, rng)


def rewrite_here(tree: Tree, rng: random.Random) -> Tree:
    """One step at the root."""
    head, *parts = tree
    if head in ("+", "*") and rng.random() < 0.5:
        return (head, parts[1], parts[0])
    if head == "*" and parts[1][0] in ("+", "-") and rng.random() < 0.5:
        return (parts[1][0], ("*", parts[0], parts[1][1]), ("*", parts[0], parts[1][2]))
    if head == "-" and rng.random() < 0.5:
        return ("neg", ("-", parts[1], parts[0]))
    if head == "**" and parts[1] == number(2):
        return ("*", parts[0], parts[0])
    if head in ("sin", "tanh", "sinh", "atan") and rng.random() < 0.5:
        return ("neg", (head, ("neg", parts[0])))
    if head in ("cos", "cosh", "abs") and rng.random() < 0.5:
        return (head, ("neg", parts[0]))
    share = number(Fraction(rng.randint(1, 9), rng.randint(1, 9)))
    other = read(rng.choice(("x", "sin(x)", "exp(y)", "x*y", "1/3")))
    square = ("+", ("**", other, number(2)), ONE)
    return rng.choice((
        ("-", ("+", tree, share), share), ("+", share, ("-", tree, share)), ("/", ("*", tree, share), share),
        ("neg", ("neg", tree)), ("/", ("*", tree, square), square), ("-", ("+", tree, other), other),
        ("*", tree, ("+", ("**", ("sin", other), number(2)), ("**", ("cos", other), number(2)))),
        ("/", ("+", tree, tree), number(2)),
    ))  # fmt: skip


def declarations_for(*trees: Tree) -> dict[str, object]:
    """The declarations of the names in some formulas."""
    from tests.attacks.trees import names_in

    return {name: DECLARED.get(name, "real") for name in sorted(set().union(*map(names_in, trees)))}


def equation(left: Tree, right: Tree, relation: str = "=", truth: bool | None = True) -> Statement:
    return Statement(f"{write(left)} {relation} {write(right)}", truth, declarations_for(left, right))


def draw_total(rng: random.Random) -> tuple[Tree, Tree]:
    """A theorem that holds everywhere inside its declarations."""
    return draw_theorem(rng, *rng.choice(((REAL, "real"), (POSITIVE, "positive"), (UNIT, "unit"))))


@family("identities")
def make_identity(rng: random.Random) -> Statement:
    return equation(*draw_total(rng))


@family("rewritings")
def make_rewriting(rng: random.Random) -> Statement:
    left, right = draw_total(rng)
    return equation(rewrite(left, rng, rng.randint(1, 4)), rewrite(right, rng, rng.randint(1, 4)))


@family("partial identities")
def make_partial_identity(rng: random.Random) -> Statement:
    """Sides that are equal where both exist: the rest must stand among the assumptions."""
    return equation(*draw_theorem(rng, PARTIAL, "real"))


@family("perturbed identities")
def make_perturbation(rng: random.Random) -> Statement:
    """One side changed by a small known amount, so that the equation fails and bounds with a margin hold."""
    left, right = draw_total(rng)
    small = read(f"{rng.randint(1, 9)}e{rng.choice(EXPONENTS)}")
    shape = read(rng.choice(("1", "1 + x**2", "exp(x)", "2 + cos(y)", "1/(1 + x**2)", "1 + abs(x)")))
    change = ("*", small, shape)
    kind = rng.choice(("= +", "= *", "<= -", "< +", "!= +", ">= -", "<"))
    moved = ("*", right, ("+", ONE, small)) if kind == "= *" else ("+", right, change)
    lower = ("-", right, change)
    if kind in ("= +", "= *"):
        return find_failure(equation(left, moved, "=", False))
    if kind == "<= -":
        return find_failure(equation(left, lower, "<=", False))
    if kind == "<":
        return equation(left, right, "<", False)
    return equation(left, lower if kind == ">= -" else moved, kind.split()[0], True)


@family("odd names")
def make_odd_names(rng: random.Random) -> Statement:
    """Names that mean something elsewhere: constants, classes, functions and words of other languages."""
    made = rng.choice((make_identity, make_perturbation, make_rewriting))(rng)
    odd = rng.sample(
        ("E", "I", "S", "N", "Q", "O", "C", "beta", "gamma", "zeta", "Symbol", "re", "im", "d", "e", "f"), 8
    )
    names = dict(zip(made.symbols, odd, strict=False))
    left, relation, right = split_text(made.text)
    trees = [replace(read(side), {old: ("name", new) for old, new in names.items()}) for side in (left, right)]
    witness = None if made.witness is None else {names.get(n, n): value for n, value in made.witness.items()}
    symbols = {names[name]: declared for name, declared in made.symbols.items()}
    return Statement(f"{write(trees[0])} {relation} {write(trees[1])}", made.truth, symbols, witness)


def split_text(text: str) -> tuple[str, str, str]:
    from tests.attacks.trees import RELATIONS

    relation = next(relation for relation in RELATIONS if relation in text)
    left, _, right = text.partition(relation)
    return left, relation, right
