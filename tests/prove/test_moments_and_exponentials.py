"""Expectations, exponentials of matrices, whole parts, the error function and ranges without an end, by `nav.prove`."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

import navsym as nav

W = {"vector": 3, "random": {"mean": "m", "cov": "Q"}}
Q = {"matrix": [3, 3], "symmetric": True}
NORMAL = {"random": {"cov": "s", "law": "normal"}}
V = {"vector": 3}
UNIT = {"u": V, "given": ["dot(u, u) = 1"]}
TURN = "eye(3) + sin(norm(v))/norm(v)*skew(v) + (1 - cos(norm(v)))/norm(v)**2*skew(v) @ skew(v)"
SCHULER = "[[cos(w*t), sin(w*t)/w, g*(1 - cos(w*t))/w**2], [-w*sin(w*t), cos(w*t), g*sin(w*t)/w], [0, 0, 1]]"
#: A true formula, a false one in the same words, and the declarations of both.
PAIRS = [
    ("E(A @ w) = A @ m", "E(A @ w) = m", {"w": W, "A": {"matrix": [3, 3]}, "Q": Q, "m": V}),
    (
        "cov(A @ w) = A @ Q @ A.T",
        "cov(A @ w) = A.T @ Q @ A",
        {"w": W, "A": {"matrix": [3, 3]}, "Q": Q, "m": V},
    ),
    (
        "E(w.T @ A @ w) = trace(A @ Q) + m.T @ A @ m",
        "E(w.T @ A @ w) = trace(A @ Q) - m.T @ A @ m",
        {"w": W, "A": {"matrix": [3, 3]}, "Q": Q, "m": V},
    ),
    ("E(x**4) = 3*s**2", "E(x**4) = 2*s**2", {"x": NORMAL}),
    ("E(x**2) >= E(x)**2", "E(x**2) > E(x)**2", {"x": {"random": {"mean": "m", "cov": "s"}}}),
    ("cov(x, y) = 0", "cov(x, y) = s", {"x": {"random": {"cov": "s"}}, "y": {"random": {"cov": "r"}}}),
    ("expm(skew(v)) = " + TURN, "expm(skew(v)) = " + TURN.replace("eye(3) +", "eye(3) -"), {"v": V}),
    (
        "expm(a*skew(u)) = eye(3) + sin(a)*skew(u) + (1 - cos(a))*skew(u) @ skew(u)",
        "expm(a*skew(u)) = eye(3) + sin(a)*skew(u) + (1 + cos(a))*skew(u) @ skew(u)",
        UNIT,
    ),
    (
        f"expm(t*[[0, 1, 0], [-w**2, 0, g], [0, 0, 0]]) = {SCHULER}",
        f"expm(t*[[0, 1, 0], [-w**2, 0, g], [0, 0, 0]]) = {SCHULER.replace('-w*sin', 'w*sin')}",
        {"w": "positive"},
    ),
    (
        "expm(t*[[0, 1], [0, -b]]) = [[1, (1 - exp(-b*t))/b], [0, exp(-b*t)]]",
        "expm(t*[[0, 1], [0, -b]]) = [[1, (exp(-b*t) - 1)/b], [0, exp(-b*t)]]",
        {"b": "positive"},
    ),
    ("a - 2*pi*floor((a + pi)/(2*pi)) < pi", "a - 2*pi*floor((a + pi)/(2*pi)) < 0", {}),
    ("floor(x + 3) = floor(x) + 3", "floor(2*x) = 2*floor(x)", {}),
    ("floor(-7/2) = -4", "floor(-7/2) = -3", {}),
    ("erf(-x) = -erf(x)", "erf(-x) = erf(x)", {}),
    ("diff(erf(x), x) = 2*exp(-x**2)/sqrt(pi)", "diff(erf(x), x) = exp(-x**2)/sqrt(pi)", {}),
    (
        "integral(exp(-(x - m)**2/(2*s**2))/(s*sqrt(2*pi)), x, -oo, oo) = 1",
        "integral(exp(-(x - m)**2/(2*s**2))/(s*sqrt(pi)), x, -oo, oo) = 1",
        {"s": "positive"},
    ),
    ("log(exp(x) + exp(y)) > x", "log(exp(x) + exp(y)) > x + 1", {}),
    ("log(1 + exp(x)) <= log(2) + x", "log(1 + exp(x)) <= log(2) + x/3", {"x": ("0", "oo")}),
    ("log(1 + x) <= x", "log(1 + x) <= x/2", {"x": ("0", "oo")}),
    ("1/x <= 1", "1/x < 1", {"x": ("1", "oo")}),
]  # fmt: skip


#: Van Loan's matrix of three positions and three velocities that decay.
LOAN = [["0"] * 12 for _ in range(12)]
for axis in range(3):
    LOAN[axis][3 + axis], LOAN[3 + axis][3 + axis], LOAN[3 + axis][9 + axis] = "-t", "b*t", f"t*q{axis + 1}"
    LOAN[9 + axis][6 + axis], LOAN[9 + axis][9 + axis] = "t", "-b*t"
LOAN = "expm([" + ", ".join(f"[{', '.join(row)}]" for row in LOAN) + "])[4,10]"
GIVEN = {"b": "positive", "t": "positive", "q1": "positive"}
PAIRS += [(f"{LOAN} = q1*sinh(b*t)/b", f"{LOAN} = q1*cosh(b*t)/b", GIVEN)]


@pytest.mark.parametrize(("true", "false", "given"), PAIRS, ids=[pair[0][:40] for pair in PAIRS])
def test_a_formula_is_proved_and_its_spoiled_form_refuted(true, false, given):
    proved, refuted = nav.prove(true, **given), nav.prove(false, **given)
    assert proved.status == "PROVED", proved.evidence
    assert refuted.status == "REFUTED", refuted.evidence
    assert proved.check().accepted
    assert refuted.check().accepted


@pytest.mark.long
def test_the_noise_of_a_step_of_six_states_in_symbols_is_an_integral_of_exponentials():
    """Three positions with speeds that decay at rates a, b, c: the integral of expm(A s) Q expm(A s).T."""
    rates, size = "abc", range(6)
    rows = [[{i + 3: "1" if i < 3 else "0"}.get(j, "0") for j in size] for i in size]
    noise, step = [["0"] * 6 for _ in size], [["0"] * 6 for _ in size]
    for k, r in enumerate(rates):
        rows[k + 3][k + 3], noise[k + 3][k + 3] = f"-{r}", f"q*{r}"
        first, second = f"(1 - exp(-{r}*T))", f"(1 - exp(-2*{r}*T))"
        step[k][k] = f"q/{r}*(T - 2*{first}/{r} + {second}/(2*{r}))"
        step[k][k + 3] = step[k + 3][k] = f"q*({first}/{r} - {second}/(2*{r}))"
        step[k + 3][k + 3] = f"q*{second}/2"
    A, Q, S = ("[" + ", ".join(f"[{', '.join(row)}]" for row in matrix) + "]" for matrix in (rows, noise, step))
    given = dict.fromkeys(("T", "q", *rates), "positive")
    text = f"integral(expm(s*{A}) @ {Q} @ expm(s*{A}).T, s, 0, T)"
    assert nav.prove(f"{text} = {S}", **given).status == "PROVED"
    assert nav.prove(f"{text} = {S.replace('/2]', '/3]')}", **given).status == "REFUTED"


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(2, 6))])
def test_an_exponential_of_numbers_agrees_with_scipy(seed):
    """Matrices with real and complex eigenvalues; the entries lie in intervals about those of scipy."""
    generator = np.random.default_rng(seed)
    rows = generator.integers(-2, 3, (2, 2))
    expected = expm(rows.astype(float))
    text = "[" + ", ".join("[" + ", ".join(map(str, row)) + "]" for row in rows.tolist()) + "]"
    for i in (1, 2):
        for j in (1, 2):
            near = f"{expected[i - 1, j - 1]:.9f}"
            assert nav.prove(f"expm({text})[{i},{j}] = {near}", tolerance="1e-8").holds
            assert nav.prove(f"expm({text})[{i},{j}] = {near} + 1/1000", tolerance="1e-8").status == "REFUTED"


@pytest.mark.long
@pytest.mark.parametrize("degree", range(1, 9))
def test_moments_agree_with_gauss_hermite_quadrature(degree):
    points, weights = np.polynomial.hermite_e.hermegauss(20)
    moment = float(weights @ (0.5 + 1.5 * points) ** degree / math.sqrt(2 * math.pi))
    given = {"x": {"random": {"mean": "1/2", "cov": "9/4", "law": "normal"}}}
    size = max(1.0, abs(moment))
    assert nav.prove(f"E(x**{degree}) = {moment:.12f}", tolerance=f"{1e-9 * size:.12f}", **given).holds
    assert not nav.prove(f"E(x**{degree}) = {moment + size:.12f}", tolerance="1/10", **given).holds


@pytest.mark.parametrize("x", ["7/3", "-7/3", "5", "-5", "sqrt(2)", "-pi", "10**6*pi"])
def test_whole_parts_of_numbers_are_those_of_python(x):
    value = math.floor(eval(x, {"sqrt": math.sqrt, "pi": math.pi}))
    assert nav.prove(f"floor({x}) = {value}").status == "PROVED"
    assert nav.prove(f"floor({x}) = {value + 1}").status == "REFUTED"


@pytest.mark.parametrize(
    ("text", "given", "words"),
    [
        ("x = E(x)", {"x": {"random": {"cov": "1"}}}, "inside E"),
        ("E(x) = 0", {"x": {"random": {"mean": "0"}}}, "the key cov"),
        ("E(x) = 0", {"x": {"random": {"cov": "1", "law": "cauchy"}}}, "normal"),
        ("E(x) = 0", {"x": {"matrix": [2, 2], "random": {"cov": "1"}}}, "a random number, or a random vector"),
        ("E(w) = w", {"w": {"vector": 2, "random": {"cov": "1"}}}, "expected"),
        ("expm([[1, 2]]) = 1", {}, "a square matrix"),
        ("x <= 1", {"x": ("oo", "1")}, "a range such as"),
    ],
)
def test_what_cannot_be_meant_is_answered_in_its_own_words(text, given, words):
    with pytest.raises(nav.NavsymError, match=words):
        nav.prove(text, **given)


@pytest.mark.parametrize(
    ("text", "given"),
    [
        ("E(x**3) = 0", {"x": {"random": {"cov": "1"}}}),
        ("E(1/x) = 1", {"x": NORMAL}),
        ("E(x**2) = -1", {"x": {"random": {"cov": "-1"}}}),
        ("E(floor(x)) = 0", {"x": NORMAL}),
        ("diff(floor(x), x) = 0", {}),
        ("integral(floor(x), x, 0, 2) = 1", {}),
    ],
)
def test_what_is_not_declared_or_has_no_rule_stays_open(text, given):
    assert nav.prove(text, **given).status == "OPEN"
