"""Statements with vectors, matrices, cases, hypotheses and derivatives: what they mean, and what has no meaning."""

from __future__ import annotations

from tests.checker.proofs import LINE, SQUARE, X0, X1, XY, I, by, modulo, prove, refute, state, stated

ONES = {f"{n}_{i}_0": str(i + k) for k, n in enumerate("uvw") for i in range(3)}
TWOS = {f"{n}_{i}_{j}": str(2 * i + 3 * j + k) for k, n in enumerate("AB") for i in range(2) for j in range(2)}
QUAT = {"q_0_0": "3/5", "q_1_0": "4/5", "q_2_0": "0", "q_3_0": "0"}

THREES, WHOLE, NORMAL = ["3", "7/2", []], [None, None, ["integer"]], {"w": {"mean": "0", "cov": "1", "normal": True}}

FIVE = {"shapes": {"p": [[f"p{i}"] for i in range(5)]}, "random": {"p": {"mean": "zeros(5, 1)", "cov": "eye(5)"}}}
FIVE["random"]["p"] |= {"normal": True}
PAIR = {"shapes": {"p": [["p0"], ["p1"]]}, "random": {"p": {"mean": "[2, 3]", "cov": "[[1, a], [b, 1]]"}}}
PAIR["random"]["p"] |= {"normal": True}
TWO_ABOUT = {"mean": "2", "cov": "1", "normal": False}
MEAN = {"mean": "log(a)", "cov": "1", "normal": True}


def some(point, *names):
    return {key: value for key, value in point.items() if key[0] in names}


CELL, CELLS = (by("balls", bits=64, cells=n) for n in (1, 30))
ABOVE_0, BELOW_1 = (by("range", symbol="fraction__1", end=end, share="1") for end in (0, 1))
#: True statements of the whole language, and false ones that differ in a sign, an index, an order or a transposition.
#: The same proofs are offered for both.
LANGUAGE = [
    (("skew(u) @ v", "=", "cross(u, v)"), ("cross(v, u)", "cross(u, v)*2"), "uv", some(ONES, "u", "v"), [I] * 3, {}),
    (
        ("cross(u, v)[1]", "=", "u[2]*v[3] - u[3]*v[2]"),
        ("u[3]*v[2] - u[2]*v[3]", "u[1]*v[2] - u[2]*v[1]"),
        "uv",
        some(ONES, "u", "v"),
        [I],
        {},
    ),
    (
        ("dot(u, v)", "=", "u[1]*v[1] + u[2]*v[2] + u[3]*v[3]"),
        ("u[1]*v[1] + u[2]*v[2] - u[3]*v[3]",),
        "uv",
        some(ONES, "u", "v"),
        [I],
        {},
    ),
    (("norm(u)**2", "=", "dot(u, u)"), ("dot(u, u)**2", "-dot(u, u)"), "u", some(ONES, "u"), [I], {}),
    (("A @ B", "=", "(B.T @ A.T).T"), ("B @ A", "(A.T @ B.T).T"), "AB", TWOS, [I] * 4, {}),
    (("A[1,2]", "=", "A.T[2,1]"), ("A[2,1]", "A.T[1,2]"), "A", some(TWOS, "A"), [I], {}),
    (("[[1, 2], [3, x]][2,1]", "=", "3"), ("2",), "", {"x": "1"}, [I], {"x": LINE}),
    (
        ("det(A)", "=", "A[1,1]*A[2,2] - A[1,2]*A[2,1]"),
        ("A[1,1]*A[2,2] + A[1,2]*A[2,1]",),
        "A",
        some(TWOS, "A"),
        [I],
        {},
    ),
    (("det([[1, 2, 3], [4, 5, 6], [7, 8, x]])", "=", "27 - 3*x"), ("3*x - 27",), "", {"x": "1"}, [I], {"x": LINE}),
    (("inv(A) @ A", "=", "eye(2)"), ("-eye(2)", "diag(1, 2)"), "A", some(TWOS, "A"), [I] * 4, {}),
    (
        ("inv([[0, 1, 0], [0, 0, 1], [x, 0, 0]])", "=", "[[0, 0, 1/x], [1, 0, 0], [0, 1, 0]]"),
        ("[[0, 1, 0], [0, 0, 1], [1/x, 0, 0]]",),
        "",
        {"x": "2"},
        [I] * 9,
        {"x": LINE},
    ),
    (("trace(A)", "=", "A[1,1] + A[2,2]"), ("A[1,1] - A[2,2]", "A[1,2] + A[2,1]"), "A", some(TWOS, "A"), [I], {}),
    (("transpose(A)", "=", "A.T"), ("A",), "A", some(TWOS, "A"), [I] * 4, {}),
    (
        ("diag([x, 2])", "=", "x*[[1, 0], [0, 0]] + [[0, 0], [0, 2]]"),
        ("zeros(2, 2)",),
        "",
        {"x": "1"},
        [I] * 4,
        {"x": LINE},
    ),
    (("qmul([0, 1, 0, 0], [0, 0, 1, 0])", "=", "[0, 0, 0, 1]"), ("[0, 0, 0, -1]", "[1, 0, 0, 0]"), "", {}, [I] * 4, {}),
    (("qmul(q, conj(q))", "=", "[dot(q, q), 0, 0, 0]"), ("[0, 0, 0, dot(q, q)]",), "q", QUAT, [I] * 4, {}),
    (("rot([0, 0, 0, 1]) @ [1, 2, 3]", "=", "[-1, -2, 3]"), ("[1, -2, -3]",), "", {}, [I] * 3, {}),
    (("rot([1, 0, 0, 1]) @ [1, 0, 0]", "=", "[0, 2, 0]"), ("[0, -2, 0]",), "", {}, [I] * 3, {}),
    (("rot([1, 1, 0, 0]) @ [0, 1, 0]", "=", "[0, 0, 2]"), ("[0, 0, -2]",), "", {}, [I] * 3, {}),
    (("rot([1, 0, 1, 0]) @ [0, 0, 1]", "=", "[2, 0, 0]"), ("[-2, 0, 0]",), "", {}, [I] * 3, {}),
    (("rot([1, 0, 0, 1]) @ [0, 1, 0]", "=", "[-2, 0, 0]"), ("[2, 0, 0]",), "", {}, [I] * 3, {}),
    (("rot([1, 1, 0, 0]) @ [0, 0, 1]", "=", "[0, -2, 0]"), ("[0, 2, 0]",), "", {}, [I] * 3, {}),
    (("rot([1, 0, 1, 0]) @ [1, 0, 0]", "=", "[0, 0, -2]"), ("[0, 0, 2]",), "", {}, [I] * 3, {}),
    (("u.T @ v", "=", "dot(u, v)"), ("-dot(u, v)",), "uv", some(ONES, "u", "v"), [I], {}),
    (("-u/2 + u*3/2", "=", "u"), ("2*u", "-u"), "u", some(ONES, "u"), [I] * 3, {}),
    (
        ("where(x >= 0, x, -x)", "=", "where(x > 0, x, -x)"),
        ("x", "-x"),
        "",
        {"x": "1"},
        [modulo("0", I, "2"), I, I],
        {"x": LINE},
    ),
    (
        ("where(x != 1, 1, 2)", "=", "where(x = 1, 2, 1)"),
        ("1", "where(x = 1, 1, 2)"),
        "",
        {"x": "1"},
        [I] * 2,
        {"x": LINE},
    ),
    (
        ("max(x, 2)", "=", "x + 2 - min(2, x)"),
        ("min(x, 2)", "x"),
        "",
        {"x": "1"},
        [modulo("0", I, "-1"), I, I],
        {"x": LINE},
    ),
    (
        ("where(x = 0, 1, 2)", "=", "2"),
        ("1",),
        "",
        {"x": "1"},
        [by("empty", by("side", by("range", symbol="x", end=0, share="1"), sign=1), hypothesis=0), I],
        {"x": ["0", None, ["open-low"]]},
    ),
    (("sign(x)", "=", "-sign(-x)"), ("sign(-x)", "1"), "", {"x": "1"}, [I] * 3, {"x": LINE}),
    (("diff(x**3, x, 2)", "=", "6*x"), ("3*x**2", "6"), "", {"x": "1"}, [I], {"x": LINE}),
    (("floor(5/2) + floor(-5/2) + floor(pi)", "=", "2"), ("3", "1"), "", {}, [I], {}),
    (("floor(log(exp(2))) + floor(-log(exp(3)))", "=", "-1"), ("0", "-2"), "", {}, [I], {}),
    (("floor(x)", "<=", "1"), ("0", "1/2"), "", {"x": "1/3"}, [CELL, CELL, CELLS, CELLS], {"x": ["0", "3/2", []]}),
    (("-1 - floor(-x)", ">=", "0"), ("1", "1/2"), "", {"x": "1/3"}, [CELL, CELLS, CELLS], {"x": ["1/5", "9/10", []]}),
    (("floor(floor(x) + 1/2)", "=", "floor(x)"), ("floor(x) + 1",), "", {"x": "1/3"}, [I], {"x": LINE}),
    (("diag(x)[1,1]", "=", "x"), ("2",), "", {"x": "1"}, [I], {"x": LINE}),
    *(
        ((f"where({one}, 1, 2)", "=", f"where({same}, {values})"), ("1", "2"), "", {"x": "1"}, [I] * 2, {"x": LINE})
        for one, same, values in (
            ("x > 0", "2*x - x > 0", "1, 2"),
            ("x >= 0", "2*x - x >= 0", "1, 2"),
            ("x < 0", "2*x - x < 0", "1, 2"),
            ("x = 0", "2*x - x = 0", "1, 2"),
            ("x > 0", "-x >= 0", "2, 1"),
            ("x >= 0", "-x > 0", "2, 1"),
            ("x = 0", "-x != 0", "2, 1"),
        )
    ),
    *(
        ((f"diff({f}, x)", "=", slope), (f"-({slope})", f), "", {"x": "1/2", "y": "1"}, [I], {"x": LINE, "y": LINE})
        for f, slope in (
            ("tan(x)", "1 + tan(x)**2"),
            ("cot(x)", "-1 - cot(x)**2"),
            ("sec(x)", "sec(x)*tan(x)"),
            ("csc(x)", "-csc(x)*cot(x)"),
            ("sinh(x) + 1", "cosh(x)"),
            ("cosh(x) + 1", "sinh(x)"),
            ("tanh(x)", "1 - tanh(x)**2"),
            ("sqrt(x)", "1/(2*sqrt(x))"),
            ("abs(x)", "x/abs(x)"),
            ("exp(2*x)", "2*exp(2*x)"),
            ("log(x)", "1/x"),
            ("atan(x)", "1/(1 + x**2)"),
            ("asin(x)", "1/sqrt(1 - x**2)"),
            ("acos(x)", "-1/sqrt(1 - x**2)"),
            ("erf(x)", "2*exp(-x**2)/sqrt(pi)"),
            ("atan2(y, x)", "-y/(x**2 + y**2)"),
            ("atan2(x, y)", "y/(x**2 + y**2)"),
            ("x**y", "y*x**(y - 1)"),
        )
    ),
    (
        ("floor(x)", ">", "x - 1"),
        ("x",),
        "",
        {"x": "1/3"},
        [by("equal", BELOW_1, to="1 - fraction__1", defined=[])],
        {"x": LINE},
    ),
    (
        ("floor(x)", "<=", "x"),
        ("x - 1", "x - 1/2"),
        "",
        {"x": "1/3"},
        [by("equal", ABOVE_0, to="fraction__1", defined=[])],
        {"x": LINE},
    ),
    (("floor(pi*x)", "=", "floor(x*pi)"), ("floor(x)",), "", {"x": "1/3"}, [I], {"x": LINE}),
    (("diff([x**2, x*y], x)", "=", "[2*x, y]"), ("[2*x, x]",), "", XY, [I] * 2, {"x": LINE, "y": LINE}),
]
SEVEN = [f"y{k}" for k in range(7)]
CASES = " + ".join(f"where({y} > 0, 0, 0)" for y in SEVEN)
#: The same with what is random, with rates, whole numbers and cases: statement, its right side, a wrong one.
NULL = f"[{', '.join('0' * 64)}]"
A1, RATES = {"a": "1"}, {"x": "v", "t": "1"}
READ = [
    (stated("E(a*w**2 + sin(a)*w + a)", "=", "", a=LINE) | {"random": NORMAL}, "2*a", "a", A1, [I]),
    (stated("E(w**8)", "=", "") | {"random": NORMAL}, "105", "1", {}, [I]),
    (stated("E(w**2/(a + 1))", "=", "", a=LINE) | {"random": NORMAL}, "1/(a + 1)", "1/a", A1, [I]),
    (stated("E(w*v*v)", "=", "", a=LINE) | {"random": {"w": TWO_ABOUT, "v": TWO_ABOUT | {"mean": "3"}}}, "20", "18",
     A1, [I]),
    (stated("cov(w, v)", "=", "", a=LINE) | {"random": {"w": TWO_ABOUT, "v": TWO_ABOUT}}, "0", "1", A1, [I]),
    (stated("cov(p)", "=", "", a=LINE, b=LINE, given=["a = b"]) | PAIR, "[[1, a], [a, 1]]", "[[1, a], [-a, 1]]",
     {"a": "1/2", "b": "1/2"}, [I, I, modulo("0", I, "-1"), I]),
    (stated("diff(x**2, t)", "=", "", rates=RATES, t=LINE, x=LINE, v=LINE), "2*x*v", "0",
     {"t": "1", "x": "1", "v": "1"}, [I]),
    (stated("diff(x**2, x)", "=", "", rates=RATES, t=LINE, x=LINE, v=LINE), "2*x", "2*x*v",
     {"t": "1", "x": "1", "v": "2"}, [I]),
    (stated("where(x != 0, [1/x, 2][2], 2)", "=", "", x=LINE), "2", "1", X0, [I, I]),
    (stated("where(x = 0, 2, [1/x, 2][2])", "=", "", x=LINE), "2", "1", X0, [I, I]),
    (stated("floor(n + x)", "=", "", n=WHOLE, x=LINE), "n + floor(x)", "n", {"n": "1", "x": "1/2"}, [I]),
    (stated("diff(x**9, x, 8)", "=", "", x=LINE), "362880*x", "x", X1, [I]),
    (stated(f"trace(eye(64)) + {NULL}[64] + [{NULL}][1,64]", "=", ""), "64", "0", {}, [I]),
    (stated("det(eye(5)) + trace(inv(eye(4)))", "=", ""), "5", "0", {}, [I]),
    (stated("asin(x) + acos(x)", "=", "", x=LINE), "acos(x) + asin(x)", "0", X1, [I]),
    (stated(CASES, "=", "", **dict.fromkeys(SEVEN, LINE)), "0", "1", dict.fromkeys(SEVEN, "1"), [I] * 128),
]  # fmt: skip
#: What the language does not mean, with the reason of its refusal.
MEANINGLESS = [
    (stated("u*v", "=", "u", "u", "v"), "a product of matrices is written with @"),
    (stated("A/B", "=", "A", "A", "B"), "a division by a matrix"),
    (stated("1/u", "=", "u", "u"), "a division by a matrix"),
    (stated("u + 1", "=", "u", "u"), "values of different shapes"),
    (stated("u", "=", "0", "u"), "sides of different shapes"),
    (stated("A @ u", "=", "u", "u", "A"), "shapes that do not fit"),
    (stated("cross(u, q)", "=", "u", "u", "q"), "expected a vector"),
    (stated("dot(u, q)", "=", "0", "u", "q"), "vectors of different lengths"),
    (stated("det(G)", "=", "0", "G"), "expected n by n"),
    (stated("u[4]", "=", "0", "u"), "an index beyond"),
    (stated("u[0]", "=", "0", "u"), "expected a size"),
    (stated("A[1]", "=", "0", "A"), "two indices"),
    (stated("A**2", "=", "A", "A"), "expected a number"),
    (stated("sin(u)", "=", "u", "u"), "expected a number"),
    (stated("u", ">=", "u", "u"), "no order"),
    (stated("x.T", "=", "x", x=LINE), "before . and"),
    (stated("u_0_0", "=", "u", "u", u=LINE), "a name given twice"),
    (stated("u", "=", "u", "u") | {"shapes": {"u": [["x"], ["y"]]}}, "an entry without a range"),
    (stated("u", "=", "u", "u") | {"shapes": {"u": [["u_0_0"], ["u_1_0", "u_2_0"]]}}, "one length"),
    (stated("diff(where(x > 0, x, 1), x)", "=", "1", x=LINE), "a derivative of cases"),
    (stated("dot_(x)", "=", "y", rates={"x": None}, x=LINE, y=LINE), "no rate is known"),
    (stated("dot_(u)", "=", "u", "u", rates={"u": "1"}), "another shape"),
    (stated("dot_(x)", "=", "0", rates={"x": "sign(x)"}, x=LINE), "a rate of cases"),
    (stated("gamma(x)", "=", "0", x=LINE), "unknown function"),
    (stated("floor(x)", "=", "x - fraction__1", x=LINE), "a name that is in use"),
    (stated("floor(x)", "=", "x", x=LINE, fraction__1=LINE), "a name that is in use"),
    (stated("diff(floor(x), x)", "=", "0", x=LINE), "a derivative of a floor"),
    (stated("integral(floor(x), x, 0, 1)", "=", "0"), "a floor of a bound variable"),
    (stated("E(floor(x))", "=", "0", x=LINE), "an expectation of a floor"),
    (stated("expm([[floor(x)]])", "=", "0", x=LINE), "an exponential of a floor"),
    # floor(n) is n for a whole number n, which is no variable of a question or derivative: the integral is 1.
    (stated("integral(floor(n), n, 0, 2)", "=", "2", n=WHOLE), "a floor of a bound variable"),
    (stated("limit(floor(n), n, 1/2)", "=", "1/2", n=WHOLE), "a floor of a bound variable"),
    (stated("diff(floor(n), n)", "=", "1", n=WHOLE), "a whole number that varies"),
    (stated("dot_(floor(n))", "=", "1", rates={"n": "1"}, n=WHOLE), "a whole number that varies"),
    (stated("sum(diff(floor(k), k), k, 1, n)", "=", "n", n=WHOLE), "a whole number that varies"),
    # floor(x) is 3 in the range of x, and not for the variable of a question.
    (stated("integral(floor(x), x, 0, 2)", "=", "6", x=THREES), "a floor of a bound variable"),
    (stated("sum(floor(x/2), x, 1, n)", "=", "n", x=THREES, n=WHOLE), "a floor of a bound variable"),
    (stated("limit(floor(x), x, 0)", "=", "3", x=THREES), "a floor of a bound variable"),
    # The rate of y and the mean of w are said outside: there x and m are no variables of a question.
    (stated("integral(dot_(y), x, 0, 1)", "=", "1/2", rates={"y": "x"}, x=LINE, y=LINE), "without an answer"),
    (stated("diff(floor(x), x)", "=", "0", x=THREES), "a derivative of cases"),
    (stated("dot_(floor(x))", "=", "0", rates={"x": "1"}, x=THREES), "a derivative of cases"),
    (stated("dot_(x)", "=", "3", rates={"x": "floor(y)"}, x=LINE, y=THREES), "a rate of cases"),
    (stated("integral(E(w), w, 0, 1)", "=", "0") | {"random": NORMAL}, "the name of a number"),
    (stated("expm([[1, 2]])", "=", "0"), "expected n by n"),
    (stated("transpose(x)", "=", "x", x=LINE), "malformed"),
    (stated("diff(integral(y, y, 0, x), x)", "=", "0", x=LINE), "a derivative of an integral"),
    (stated("sum(integral(k*x, x, 0, 1), k, 1, 2)", "=", "3/2"), "without an answer"),
    (stated("cov(A, B)", "=", "0", "A", "B"), "expected a vector"),
    (stated(f"[{', '.join('0' * 65)}]", "=", "0"), "too many entries"),
    (stated(f"[[{', '.join('0' * 65)}]]", "=", "0"), "too many entries"),
    (stated("eye(65)", "=", "0"), "expected a size"),
    (stated("det(eye(6))", "=", "1"), "expected n by n with n <= 5"),
    (stated("inv(eye(5))", "=", "eye(5)"), "expected n by n with n <= 4"),
    (stated("expm(zeros(17, 17))", "=", "eye(17)"), "expected n by n with n <= 16"),
    (stated("floor(log(0))", "=", "0"), "a number that may not exist"),
    (stated("x", "=", "x", x=LINE) | {"shapes": {"2x": [["x"]]}}, "expected names"),
    (stated("x + ]", "=", "x", x=LINE), "not an expression"),
    (stated("expm([[1]], [[1]])", "=", "[[1]]"), "malformed"),
    (stated("expm([[s__1]])", "=", "[[1]]", s__1=LINE), "a name that is in use"),
    (stated("where(x > 0, 1, [1, 2])", "=", "1", x=LINE), "branches of different shapes"),
    (stated("dot_(x, x)", "=", "1", rates={"x": "1"}, x=LINE), "expected dot_ of 1 argument"),
    (stated("diff(x, x, 9)", "=", "0", x=LINE), "a derivative of a high order"),
    (stated("E(w**3)", "=", "0") | {"random": {"w": NORMAL["w"] | {"normal": False}}}, "a moment that is not declared"),
    (stated("E(w**9)", "=", "0") | {"random": NORMAL}, "a moment that is not declared"),
    (stated("E(p[1])", "=", "0") | FIVE, "up to 4 numbers"),
    (stated("E(x, x)", "=", "0", x=LINE), "malformed"),
    (stated("diff(x**2, limit(y, y, x))", "=", "0", x=LINE), "expected a symbol behind diff"),
    (stated("x", "=", "x", given=["x"], x=LINE), "expected a relation"),
    (stated("]x)", "=", "x", x=LINE), "not an expression"),
    (stated("x x", "=", "x", x=LINE), "more than one"),
    (stated("x", "=", "x;", x=LINE), "unexpected characters"),
    (stated("x", "=", "x", given=["x = 1\n"], x=LINE), "unexpected characters"),
    (stated("x", "=", "x", x=LINE) | {"right": 5}, "expected a text"),
    (stated("x", "=", f"x{' ' * 400000}", x=LINE), "expected a text"),
    (stated("diag(u, u)", "=", "x", "u", x=LINE), "expected a number"),
    (stated("1", "=", "1") | {"symbols": []}, "expected ranges by symbol"),
    (stated(f"where(x > 0, {CASES}, 0)", "=", "0", **dict.fromkeys(("x", *SEVEN), LINE)), "too many cases"),
    (stated("E(exp(w))", "=", "1") | {"random": NORMAL}, "a random number in a function"),
    (stated("E(E(w*sin(w)))", "=", "0") | {"random": NORMAL}, "a random number in a function"),  # it is exp(-1/2)
    (stated("cov(E(exp(w)))", "=", "0") | {"random": NORMAL}, "a random number in a function"),
    (stated("E(w**2/exp(w))", "=", "1") | {"random": NORMAL}, "below a line or in a function"),
    (stated("x", "=", "x", rates=["x"], x=LINE), "expected rates by name"),
    (
        stated("dot_(u)", "=", "u", "u", rates={"u": "u", "v": "2*u"}) | {"shapes": {n: [["u_0_0"]] for n in "uv"}},
        "two rates of one symbol",
    ),
    (stated("cross(u, u, u)", "=", "u", "u"), "malformed"),
    (stated("skew(u, u)", "=", "skew(u)", "u"), "malformed"),
    (stated("floor(x, x)", "=", "x", x=LINE), "malformed"),
    (stated("sign(x, x)", "=", "1", x=LINE), "malformed"),
    (
        stated("E(p[1])", "=", "2", a=LINE, b=LINE) | PAIR | {"random": PAIR["random"] | {"p0": NORMAL["w"]}},
        "a name given twice",
    ),
    (stated("E(w)", "=", "0") | {"random": {"w": NORMAL["w"] | {"normal": 1}}}, "a name given twice"),
    (stated("x", "=", "x", x=LINE) | {"random": []}, "expected random names"),
    (stated("cov(p, p[1])", "=", "0", a=LINE, b=LINE) | PAIR, "expected a number"),
    (stated("cov(p[1], p)", "=", "0", a=LINE, b=LINE) | PAIR, "expected a number"),
    (stated("x", "=", "x", given=["x = 1 = 1"], x=LINE), "more than one"),
    (stated("x", "=", "x", "u", given=["u > u"], x=LINE), "no order"),
]
#: True statements that one proof of everything would make of a part that has no value, or of a case forgotten.
NOWHERE_DEFINED = [
    (stated("[1/x, 2][2]", "=", "2", x=LINE), X0, [I], "no value at the witness"),
    (stated("trace([[1, 1/x], [0, 1]])", "=", "2", x=LINE), X0, [I], "no value at the witness"),
    (stated("inv([[x, 0], [0, 1]])[2,2]", "=", "1", x=LINE), X0, [I], "no value at the witness"),
    (stated("diff(abs(x), x)*0", "=", "0", x=LINE), X0, [I], "no value at the witness"),
    (stated("diff(sqrt(x), y)", "=", "0", x=LINE, y=LINE), {"x": "-1", "y": "0"}, [I], "no value at the witness"),
    (stated("diff(atan2(y, x), y)*0", "=", "0", x=LINE, y=LINE), {"x": "-1", "y": "0"}, [I], "no value at the witness"),
    (stated("min(1/x, 2)*0", "=", "0", x=LINE), X0, [I, I], "no value at the witness"),
    (stated("x", "=", "x", given=["x = 1"], x=LINE), X0, [I], "no value at the witness"),
    (stated("x", "=", "x", given=["x >= 1"], x=LINE), X0, [I], "no value at the witness"),
    (stated("x", "=", "x", given=["x > 0"], x=LINE), X0, [I], "no value at the witness"),
    (stated("x", "=", "x", given=["x != 0"], x=LINE), X0, [I], "no value at the witness"),
    (stated("E(w) - E(w)", "=", "0", a=LINE) | {"random": NORMAL | {"v": MEAN}}, {"a": "-1"}, [I], "at the witness"),
    (stated("y", "=", "y", given=["0*log(x) = 0"], x=LINE, y=LINE), {"x": "-1", "y": "1"}, [I], "at the witness"),
    (stated("y", "=", "y", given=["0*log(x) >= 0"], x=LINE, y=LINE), {"x": "-1", "y": "1"}, [I], "at the witness"),
    (stated("E(p[1]*p[2])", "=", "a + 6", a=LINE, b=LINE) | PAIR, {"a": "0", "b": "1/2"}, [I], "at the witness"),
    (stated("E(p[1]*p[2])", "=", "a + 6", a=LINE, b=LINE) | PAIR, {"a": "2", "b": "2"}, [I], "at the witness"),
    (stated("where(x = 0, [1/x, 2][2], 2)", "=", "2", x=LINE), X0, [I, I], "no value at the witness"),
    (stated("sum([1/k, 2][2], k, 0, 1)", "=", "4"), {}, [I], "no value at the witness"),
    (stated("diff(asin(x), x)*0", "=", "0", x=LINE), X1, [I], "no value at the witness"),
    (stated("dot_(abs(x))*0", "=", "0", rates={"x": "1"}, x=LINE), X0, [I], "no value at the witness"),
    (stated("expm([[0*log(x)]])", "=", "[[1]]", x=LINE), {"x": "-1"}, [I], "no value at the witness|without an answer"),
    (stated("diff(asin(x), y)", "=", "0", x=LINE, y=LINE), {"x": "1", "y": "0"}, [I], "no value at the witness"),
    (stated("diff(acos(x), y)", "=", "0", x=LINE, y=LINE), {"x": "-1", "y": "0"}, [I], "no value at the witness"),
    (stated("x", ">", "0", given=["x >= 0"], x=LINE), X1, [by("range", symbol="x", end=0, share="1")], "end belongs"),
    (
        stated("-x", ">", "0", given=["x <= 0"], x=LINE),
        {"x": "-1"},
        [by("range", symbol="x", end=1, share="1")],
        "end belongs",
    ),
    (stated("floor(0*log(x))*0", "=", "0", x=LINE), {"x": "-1"}, [I], "a number that may not exist"),
    (stated("diff(acos(x), x)*0", "=", "0", x=LINE), {"x": "-1"}, [I], "no value at the witness"),
    (stated("where(x > 0, 1, 2)", "=", "1", x=LINE), X1, [I], "expected 2 entries"),
    (stated("where(x > 0, 1, 2)", "=", "1", x=LINE), X1, [I, I], "the sides differ"),
    (stated("where(x = 0, 1, 2)", "=", "2", x=LINE), X1, [I, I], "the sides differ"),
    (stated("max(x, 0)", "=", "x", x=LINE), X1, [I, I], "the sides differ"),
    (stated("A", "=", "A", "A"), some(TWOS, "A"), [I], "expected 4 entries"),
]
#: Points where a statement of the whole language fails, and where it does not although its other case would.
LANGUAGE_FAILS = [
    (stated("x", "=", "2", given=["x**2 = 4"], x=LINE), {"x": "-2"}, None),
    (stated("sign(x)", "=", "-1", x=LINE), X1, None),
    (stated("where(x > 0, 1, 2)", "=", "1", x=LINE), X0, None),
    (stated("cross(u, v)", "=", "cross(v, u)", "u", "v"), some(ONES, "u", "v"), None),
    (stated("A", "!=", "A.T", "A"), {f"A_{i}_{j}": "1" for i in range(2) for j in range(2)}, None),
    (stated("sin(x)", "!=", "cos(x)", given=["sin(x) = cos(x)"], x=LINE), {"x": "pi/4"}, I),
]
LANGUAGE_STANDS = [
    (stated("x", "=", "2", given=["x**2 = 4"], x=LINE), {"x": "1"}, None, "no value at the point"),
    (stated("x", "=", "2", given=["x >= 2"], x=LINE), {"x": "1"}, None, "no value at the point"),
    (stated("where(x > 0, 1, 2)", "=", "1", x=LINE), X1, None, "not seen to fail"),
    (stated("sign(x)", "=", "1", x=LINE), X1, None, "not seen to fail"),
    (stated("where(x > 0, x, 1/x)", "=", "x", x=LINE), X0, None, "no value at the point"),
    (stated("norm(u)", "=", "1", "u", given=["dot(u, u) = 1"]), some(ONES, "u"), None, "no value at the point"),
]

ZEROED, FALSE = state("x - x", "=", x=LINE), state("x", "=", "1", x=LINE)
SHOWN, DENIED, SQUARED = prove(ZEROED, X0, I), refute(FALSE, X0), prove(SQUARE, X0, by("zero", I))
#: What several certificates say of several statements: each is proved, in their order; or one of them fails.
GRANTS = [
    (ZEROED, SHOWN, "HOLDS"),
    ([ZEROED, ZEROED], {"kind": "all", "of": [SHOWN, SHOWN]}, "HOLDS"),
    ([ZEROED, FALSE], DENIED, "FAILS"),
    ([FALSE, ZEROED], {"kind": "all", "of": [DENIED]}, "FAILS"),
    ([ZEROED, FALSE], SHOWN, "another statement"),
    ([ZEROED], {"kind": "all", "of": [SHOWN, SHOWN]}, "another statement"),
    ([ZEROED], DENIED, "another statement"),
    ([FALSE, FALSE], {"kind": "all", "of": [DENIED, DENIED]}, "another statement"),
    ([FALSE, ZEROED], {"kind": "all", "of": [SHOWN, DENIED]}, "another statement"),
    ([ZEROED, FALSE], {"kind": "all", "of": [SHOWN, DENIED]}, "FAILS"),
    ([ZEROED, FALSE], {"kind": "all", "of": [SHOWN | {"witness": {"x": "log(0)"}}, DENIED]}, "no value|outside|exist"),
    ([ZEROED, FALSE, ZEROED], {"kind": "all", "of": [SHOWN, DENIED]}, "another statement"),
    ([ZEROED, FALSE], {"kind": "all", "of": [DENIED, SHOWN]}, "another statement"),
    ([], {"kind": "all", "of": []}, "expected a list|expected"),
    ([None], {"kind": "identity", "left": "x", "right": "x", "symbols": ["x"]}, "another statement"),
    ([ZEROED], {"kind": "all", "of": {"0": SHOWN}}, "expected certificates"),
    ([ZEROED], {"kind": "all", "of": [[SHOWN]]}, "expected certificates"),
    ([ZEROED], SHOWN | {"proofs": []}, "expected 1 entries"),
]


def list_language():
    """(statement, witness, proofs, whether it holds) of the table LANGUAGE."""
    for (left, relation, right), wrong, names, witness, proofs, symbols in LANGUAGE:
        yield stated(left, relation, right, *names, **symbols), witness, proofs, True
        for other in wrong:
            yield stated(left, relation, other, *names, **symbols), witness, proofs, False
    for statement, right, wrong, witness, proofs in READ:
        yield statement | {"right": right}, witness, proofs, True
        yield statement | {"right": wrong}, witness, proofs, False
