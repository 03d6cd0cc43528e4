"""Formulas of inertial navigation and estimation, each with a near miss, and inequalities of the field.

In the language of files: ``GROUPS`` maps a field to its symbols and its rows (left, right, wrong right);
a matrix is a list of rows. ``INEQUALITIES`` has rows (left, relation, right). The reverse of a relation is
claimed nowhere: the tests turn it round themselves.
"""

from __future__ import annotations

from typing import Any

Row = tuple[Any, Any, Any]

ROTATIONS: tuple[Row, ...] = (
    (
        [["cos(a)", "-sin(a)"], ["sin(a)", "cos(a)"]],
        [["sin(a + pi/2)", "-sin(a)"], ["sin(a)", "sin(a + pi/2)"]],
        [["sin(a + pi/2)", "-sin(a)"], ["sin(a)", "sin(a - pi/2)"]],
    ),
    ("(cos(a)*cos(b))**2 + (cos(a)*sin(b))**2 + sin(a)**2", "1", "1 + sin(a)**2*sin(b)**2/1000"),
    (
        "cos(b)*cos(c)*(sin(a)*sin(b)*cos(c) - cos(a)*sin(c)) + cos(b)*sin(c)*(sin(a)*sin(b)*sin(c) + cos(a)*cos(c))"
        " - sin(b)*sin(a)*cos(b)",
        "0",
        "sin(a)*sin(b)*cos(b)/10",
    ),
    (
        "(cos(a/2)*cos(b/2)*cos(c/2) + sin(a/2)*sin(b/2)*sin(c/2))**2"
        " + (sin(a/2)*cos(b/2)*cos(c/2) - cos(a/2)*sin(b/2)*sin(c/2))**2"
        " + (cos(a/2)*sin(b/2)*cos(c/2) + sin(a/2)*cos(b/2)*sin(c/2))**2"
        " + (cos(a/2)*cos(b/2)*sin(c/2) - sin(a/2)*sin(b/2)*cos(c/2))**2",
        "1",
        "1 + sin(a)*sin(b)*sin(c)/4",
    ),
    (
        "2*(cos(a/2)*cos(b/2)*cos(c/2) + sin(a/2)*sin(b/2)*sin(c/2))"
        "*(cos(a/2)*sin(b/2)*cos(c/2) + sin(a/2)*cos(b/2)*sin(c/2))"
        " - 2*(cos(a/2)*cos(b/2)*sin(c/2) - sin(a/2)*sin(b/2)*cos(c/2))"
        "*(sin(a/2)*cos(b/2)*cos(c/2) - cos(a/2)*sin(b/2)*sin(c/2))",
        "sin(b)",
        "cos(b)",
    ),
    ("1 + 2*cos(a)", "1 + 2*(2*cos(a/2)**2 - 1)", "1 + 2*(2*sin(a/2)**2 - 1)"),
    ("sin(a)/a*x", "2*sin(a/2)*cos(a/2)/a*x", "2*sin(a/2)*cos(a/2)/b*x"),
    ("tan(b)*cos(b)", "sin(b)", "sin(b)**2"),
    ("sec(b)**2 - tan(b)**2", "1", "cos(b)"),
    ("(x*cos(a) + y*sin(a))**2 + (y*cos(a) - x*sin(a))**2", "x**2 + y**2", "x**2 + y**2 + x*y*sin(a)/10"),
    (
        [["cos(a)", "sin(a)", "0"], ["-sin(a)", "cos(a)", "0"], ["0", "0", "1"]],
        [["1 - 2*sin(a/2)**2", "sin(a)", "0"], ["-sin(a)", "1 - 2*sin(a/2)**2", "0"], ["0", "0", "1"]],
        [["1 - 2*sin(a/2)**2", "sin(a)", "0"], ["sin(a)", "1 - 2*sin(a/2)**2", "0"], ["0", "0", "1"]],
    ),
    (
        "sin(a + b + c)",
        "sin(a)*cos(b)*cos(c) + cos(a)*sin(b)*cos(c) + cos(a)*cos(b)*sin(c) - sin(a)*sin(b)*sin(c)",
        "sin(a)*cos(b)*cos(c) + cos(a)*sin(b)*cos(c) + cos(a)*cos(b)*sin(c) + sin(a)*sin(b)*sin(c)",
    ),
    ("tan(a/2)", "sin(a)/(1 + cos(a))", "sin(a)/(1 - cos(a))"),
    ("cos(abs(a))", "cos(a)", "abs(cos(a))"),
    ("sin(abs(a))", "abs(a)*sin(a)/a", "sin(a)"),
    ("sin(abs(a))**2", "sin(a)**2", "sin(a)*sin(abs(a))"),
    ("abs(a)*abs(b)", "abs(a*b)", "a*b"),
    ("sqrt(a**2)", "abs(a)", "a"),
    ("sqrt(a**2 - 2*a*b + b**2)", "abs(a - b)", "a - b"),
    ("sqrt(1 - cos(a)**2)", "abs(sin(a))", "sin(a)"),
    ("sqrt((1 - cos(a))/2)", "abs(sin(a/2))", "sin(a/2)"),
    ("sqrt((x**2 + y**2)**2)", "x**2 + y**2", "x**2 - y**2"),
    ("abs(a - b)", "abs(b - a)", "abs(b + a)"),
    ("(a + b + abs(a - b))/2 + (a + b - abs(a - b))/2", "a + b", "a + b + abs(a - b)/100"),
    ("((a + b + abs(a - b))/2)*((a + b - abs(a - b))/2)", "a*b", "abs(a*b)"),
)

QUATERNIONS: tuple[Row, ...] = (
    (
        "(a*e - b*f - c*g - d*h)**2 + (a*f + b*e + c*h - d*g)**2 + (a*g - b*h + c*e + d*f)**2 + (a*h + b*g - c*f"
        " + d*e)**2",
        "(a**2 + b**2 + c**2 + d**2)*(e**2 + f**2 + g**2 + h**2)",
        "(a**2 + b**2 + c**2 + d**2)*(e**2 + f**2 + g**2 - h**2)",
    ),
    (
        "(a**2 + b**2 - c**2 - d**2)**2 + 4*(b*c + a*d)**2 + 4*(b*d - a*c)**2",
        "(a**2 + b**2 + c**2 + d**2)**2",
        "(a**2 + b**2 + c**2 - d**2)**2",
    ),
    (
        "(a**2 + b**2 - c**2 - d**2)*2*(b*c - a*d) + 2*(b*c + a*d)*(a**2 - b**2 + c**2 - d**2)"
        " + 2*(b*d - a*c)*2*(c*d + a*b)",
        "0",
        "a*b*c*d",
    ),
    ("4*a**2 - (a**2 + b**2 + c**2 + d**2)", "3*a**2 - b**2 - c**2 - d**2", "3*a**2 - b**2 - c**2 + d**2"),
    ("a*(e*h - f*g)", "a*e*h - a*f*g", "a*e*h - a*g*e"),
    ([["a", "-b"], ["b", "a"]], [["a + 0*b", "-b"], ["b", "(a**2 + a*b)/(a + b)"]], [["a", "b"], ["b", "a"]]),
    (
        "(b*g - c*f)**2 + (c*e - a*g)**2 + (a*f - b*e)**2",
        "(a**2 + b**2 + c**2)*(e**2 + f**2 + g**2) - (a*e + b*f + c*g)**2",
        "(a**2 + b**2 + c**2)*(e**2 + f**2 + g**2) + (a*e + b*f + c*g)**2",
    ),
    ("a*(b*g - c*f) + b*(c*e - a*g) + c*(a*f - b*e)", "0", "a*b*c*e/10"),
)

SCHULER: tuple[Row, ...] = (
    ("sin(w*T)**2/w**2 + ((1 - cos(w*T))/w)**2", "2*(1 - cos(w*T))/w**2", "2*(1 + cos(w*T))/w**2"),
    (
        [["cos(w*T)", "sin(w*T)/w"], ["-w*sin(w*T)", "cos(w*T)"]],
        [["1 - 2*sin(w*T/2)**2", "2*sin(w*T/2)*cos(w*T/2)/w"], ["-2*w*sin(w*T/2)*cos(w*T/2)", "2*cos(w*T/2)**2 - 1"]],
        [["1 - 2*sin(w*T/2)**2", "2*sin(w*T/2)*cos(w*T/2)/w"], ["2*w*sin(w*T/2)*cos(w*T/2)", "2*cos(w*T/2)**2 - 1"]],
    ),
    ("cos(w*T)*cos(w*T) - (sin(w*T)/w)*(-w*sin(w*T))", "1", "cos(2*w*T)"),
    ("cos(w*(T + t))", "cos(w*T)*cos(w*t) - (sin(w*T)/w)*w*sin(w*t)", "cos(w*T)*cos(w*t) - sin(w*T)*w*sin(w*t)"),
    ("sin(w*(T + t))/w", "cos(w*T)*sin(w*t)/w + sin(w*T)/w*cos(w*t)", "cos(w*T)*sin(w*t)/w - sin(w*T)/w*cos(w*t)"),
    ("sqrt(g/R)*sqrt(R/g)", "1", "R/g"),
    ("2*pi*sqrt(R/g)", "2*pi/sqrt(g/R)", "2*pi*sqrt(g/R)"),
    ("(g/R)*sqrt(R/g)", "sqrt(g/R)", "sqrt(R/g)"),
    ("(1 - cos(w*T))/w**2", "2*sin(w*T/2)**2/w**2", "2*sin(w*T)**2/w**2"),
    ("x*cos(w*T) + y*sin(w*T)/w", "(x*w*cos(w*T) + y*sin(w*T))/w", "(x*w*cos(w*T) + y*sin(w*T))*w"),
    ("exp(-T/t)*exp(T/t)", "1", "exp(T/t)"),
    ("(1 - exp(-2*T/t))/2", "exp(-T/t)*sinh(T/t)", "exp(-T/t)*cosh(T/t)"),
    ("t**2*(1 - exp(-T/t))**2", "t**2*(1 - 2*exp(-T/t) + exp(-2*T/t))", "t**2*(1 - 2*exp(-T/t) + exp(-T/t))"),
    ("exp(T*log(2)/t)", "2**(T/t)", "2**(t/T)"),
    ("cosh(w*T)**2 - sinh(w*T)**2", "1", "cosh(2*w*T)"),
    ("tanh(w*T)", "(1 - exp(-2*w*T))/(1 + exp(-2*w*T))", "(1 - exp(-w*T))/(1 + exp(-w*T))"),
    ("log(w*T)", "log(w) + log(T)", "log(w)*log(T)"),
    ("log(w/T)", "log(w) - log(T)", "log(w)/log(T)"),
    ("log(w**3*T**2)", "3*log(w) + 2*log(T)", "3*log(w) + log(T)"),
    ("log(sqrt(w))", "log(w)/2", "log(w)/3"),
    ("log(exp(w*T))", "w*T", "w + T"),
    ("exp(log(w) + log(T))", "w*T", "w + T"),
    ("exp(2*log(w))", "w**2", "2*w"),
    ("log(1 - exp(-2*w)) + 2*w", "log(exp(2*w) - 1)", "log(exp(2*w) + 1)"),
    ("log((1 + tanh(w))/(1 - tanh(w)))/2", "w", "2*w"),
    ("log(w + sqrt(w**2 + 1))", "-log(sqrt(w**2 + 1) - w)", "log(sqrt(w**2 + 1) - w)"),
    ("log(w**2 - T**2 + T**2)", "2*log(w)", "log(w)"),
    ("log(w**2 + 2*w*T + T**2)", "2*log(w + T)", "2*log(w) + 2*log(T)"),
    ("log(2*w)/log(2)", "1 + log(w)/log(2)", "log(w)/log(2)"),
    ("sqrt(w*T)", "sqrt(w)*sqrt(T)", "sqrt(w + T)"),
    ("sqrt(w**2*T)", "w*sqrt(T)", "T*sqrt(w)"),
    ("sqrt(w + T + 2*sqrt(w*T))", "sqrt(w) + sqrt(T)", "sqrt(w) - sqrt(T)"),
    ("1/(sqrt(w + 1) + sqrt(w))", "sqrt(w + 1) - sqrt(w)", "sqrt(w + 1) + sqrt(w)"),
    ("(w**3)**(1/3)", "w", "w**2"),
    ("sqrt(w**4 + 2*w**2 + 1)", "w**2 + 1", "w**2 - 1"),
)

KALMAN: tuple[Row, ...] = (
    ("p - p**2/(p + r)", "p*r/(p + r)", "p*r/(p - r)"),
    ("(1 - k)**2*p + k**2*r - p*r/(p + r)", "(p + r)*(k - p/(p + r))**2", "(p + r)*(k - r/(p + r))**2"),
    ("1/(1/p + 1/r)", "p - p/(p + r)*p", "p + p/(p + r)*p"),
    ("p/(p + r)", "(1/(1/p + 1/r))/r", "(1/(1/p + 1/r))/p"),
    ("1/(a + u*v/q)", "1/a - 1/a*u*v/a/(q + v*u/a)", "1/a + 1/a*u*v/a/(q + v*u/a)"),
    ([["a", "b"], ["b", "d"]], [["a", "(b*d + b*a)/(a + d)"], ["b", "d"]], [["a", "b"], ["-b", "d"]]),
    (
        [
            ["d/(a*d - b**2)*a - b/(a*d - b**2)*b", "d/(a*d - b**2)*b - b/(a*d - b**2)*d"],
            ["-b/(a*d - b**2)*a + a/(a*d - b**2)*b", "-b/(a*d - b**2)*b + a/(a*d - b**2)*d"],
        ],
        [["1", "0"], ["0", "1"]],
        [["1", "0"], ["0", "-1"]],
    ),
    (
        [["(1 - a/(a + r))*a", "(1 - a/(a + r))*b"], ["b - b/(a + r)*a", "d - b/(a + r)*b"]],
        [
            ["(1 - a/(a + r))**2*a + (a/(a + r))**2*r", "(1 - a/(a + r))*(b - b/(a + r)*a) + a/(a + r)*b/(a + r)*r"],
            [
                "(1 - a/(a + r))*(b - b/(a + r)*a) + a/(a + r)*b/(a + r)*r",
                "d - 2*b/(a + r)*b + (b/(a + r))**2*a + (b/(a + r))**2*r",
            ],
        ],
        [
            ["(1 - a/(a + r))**2*a + (a/(a + r))**2*r", "(1 - a/(a + r))*(b - b/(a + r)*a) + a/(a + r)*b/(a + r)*r"],
            [
                "(1 - a/(a + r))*(b - b/(a + r)*a) - a/(a + r)*b/(a + r)*r",
                "d - 2*b/(a + r)*b + (b/(a + r))**2*a + (b/(a + r))**2*r",
            ],
        ],
    ),
    (
        "(q + sqrt(q**2 + 4*q*r))/2",
        "q + ((q + sqrt(q**2 + 4*q*r))/2)*r/((q + sqrt(q**2 + 4*q*r))/2 + r)",
        "q - ((q + sqrt(q**2 + 4*q*r))/2)*r/((q + sqrt(q**2 + 4*q*r))/2 + r)",
    ),
    ("sqrt(q*r)**2/r", "q", "r"),
    ("-2*a*p*0 + 2*a*(a*r + sqrt(a**2*r**2 + q*r)) + q - (a*r + sqrt(a**2*r**2 + q*r))**2/r", "0", "q/10"),
    ("(2*a - a**2 - a)/a", "1 - a", "1 + a"),
    ("(a**2/(2 - a))*0 + 2*(2 - a) - 4*sqrt(1 - a)", "2*(1 - sqrt(1 - a))**2", "2*(1 + sqrt(1 - a))**2"),
    ("k*(1/k - 1)", "1 - k", "1 + k"),
    ("log(p*r)/2 - log(p)/2", "log(r)/2", "log(p)/2"),
    ("-log(2*pi*p)/2", "-log(2*pi)/2 - log(p)/2", "-log(2*pi)/2 + log(p)/2"),
    ("log(p/(p + r)) - log(r/(p + r))", "log(p) - log(r)", "log(p) + log(r)"),
    ("exp(-u**2/(2*p))/sqrt(2*pi*p)", "exp(-u**2/(2*p) - log(2*pi*p)/2)", "exp(-u**2/(2*p) + log(2*pi*p)/2)"),
    ("(u/p + v/r)/(1/p + 1/r)", "(r*u + p*v)/(p + r)", "(p*u + r*v)/(p + r)"),
    ("u**2/p + v**2/r - (u + v)**2/(p + r)", "(r*u - p*v)**2/(p*r*(p + r))", "(r*u + p*v)**2/(p*r*(p + r))"),
    (
        [["q*T**3/3", "q*T**2/2"], ["q*T**2/2", "q*T"]],
        [["q*T*(T**2/12 + T**2/4)", "q*T*T/2"], ["q*T*T/2", "q*T"]],
        [["q*T*(T**2/12 + T**2/3)", "q*T*T/2"], ["q*T*T/2", "q*T"]],
    ),
    ("q*T**3/3*q*T - (q*T**2/2)**2", "q**2*T**4/12", "q**2*T**4/6"),
    (
        [["a", "b", "c"], ["b", "d", "u"], ["c", "u", "v"]],
        [["a", "b", "c"], ["b", "d", "u"], ["c", "u", "v*q/q"]],
        [["a", "b", "c"], ["b", "d", "u"], ["c", "u", "v/q"]],
    ),
    (
        "a*(d*v - u**2) - b*(b*v - u*c) + c*(b*u - d*c)",
        "a*d*v + 2*b*c*u - a*u**2 - d*c**2 - v*b**2",
        "a*d*v - 2*b*c*u - a*u**2 - d*c**2 - v*b**2",
    ),
)

EARTH: tuple[Row, ...] = (
    (
        "a*(1 - e**2)/(1 - e**2*sin(b)**2)**(3/2)",
        "(a/sqrt(1 - e**2*sin(b)**2))*(1 - e**2)/(1 - e**2*sin(b)**2)",
        "(a/sqrt(1 - e**2*sin(b)**2))*(1 + e**2)/(1 - e**2*sin(b)**2)",
    ),
    (
        "(a*cos(b)/sqrt(1 - e**2*sin(b)**2))**2/a**2"
        " + (a*(1 - e**2)*sin(b)/sqrt(1 - e**2*sin(b)**2))**2/(a**2*(1 - e**2))",
        "1",
        "1 + e**2",
    ),
    ("1 - (a*(1 - f))**2/a**2", "f*(2 - f)", "f*(2 + f)"),
    ("(1 - f)**2", "1 - (2*f - f**2)", "1 - (2*f + f**2)"),
    ("(f*(2 - f))/(1 - f)**2", "1/(1 - f)**2 - 1", "1/(1 - f)**2 + 1"),
    ("sin(b)**2 + (1 - sin(b)**2)", "1", "cos(b)"),
    (
        "sin((b - c)/2)**2 + cos(b)*cos(c)*sin(l/2)**2",
        "(1 - (sin(b)*sin(c) + cos(b)*cos(c)*cos(l)))/2",
        "(1 - (sin(b)*sin(c) - cos(b)*cos(c)*cos(l)))/2",
    ),
    (
        "(cos(c)*sin(l))**2 + (cos(b)*sin(c) - sin(b)*cos(c)*cos(l))**2 + (sin(b)*sin(c) + cos(b)*cos(c)*cos(l))**2",
        "1",
        "1 + sin(l)**2/10",
    ),
    ("a*(1 + f*sin(b)**2*0) + h", "a + h", "a - h"),
    (
        "(a + h)**2*(cos(b)*cos(l))**2 + (a + h)**2*(cos(b)*sin(l))**2 + (a + h)**2*sin(b)**2",
        "(a + h)**2",
        "(a - h)**2",
    ),
    ("sqrt(cos(b)**2*cos(l)**2 + cos(b)**2*sin(l)**2)", "abs(cos(b))", "-cos(b)"),
    (
        "g*(1 + u*sin(b)**2 - v*sin(2*b)**2)",
        "g*(1 + u*sin(b)**2 - 4*v*sin(b)**2*cos(b)**2)",
        "g*(1 + u*sin(b)**2 - 2*v*sin(b)**2*cos(b)**2)",
    ),
    ("g*(1 - e)/(1 - e**2)", "g/(1 + e)", "g/(1 - e)"),
    ("sin(b)*cos(b)", "tan(b)/(1 + tan(b)**2)", "tan(b)/(1 - tan(b)**2)"),
    ("atan(tan(b))", "b", "b/2"),
    ("asin(sin(b))", "b", "-b"),
    ("atan2(sin(b), cos(b))", "b", "2*b"),
    ("atan2(h*sin(b), h*cos(b))", "b", "b*h"),
    ("atan((1 - f)*tan(b)/(1 - f))", "b", "b*(1 - f)"),
    ("tan(atan(x))", "x", "x**2"),
    ("sin(asin(f))", "f", "f**2"),
    ("cos(asin(f))", "sqrt(1 - f**2)", "sqrt(1 + f**2)"),
    ("sin(atan(x))", "x/sqrt(1 + x**2)", "1/sqrt(1 + x**2)"),
    ("asin(f) + acos(f)", "pi/2", "pi/3"),
    ("atan(h) + atan(1/h)", "pi/2", "pi/4"),
    ("asin(x/sqrt(1 + x**2))", "atan(x)", "2*atan(x)"),
    ("2*asin(sqrt((1 - cos(m))/2))", "m", "m/2"),
    ("acos(cos(m))", "m", "2*m"),
    ("2*atan2(sqrt((1 - cos(m))/2), sqrt((1 + cos(m))/2))", "m", "m/2"),
    ("atan2(x, h)", "atan(x/h)", "atan(h/x)"),
    ("atan2(h, x)", "pi/2 - atan(x/h)", "pi/2 + atan(x/h)"),
    ("atan2(-x, h)", "-atan2(x, h)", "atan2(x, h)"),
    ("acos(-f)", "pi - acos(f)", "acos(f)"),
    ("asin(-f)", "-asin(f)", "asin(f)"),
    ("2*atan(f)", "atan(2*f/(1 - f**2))", "atan(2*f/(1 + f**2))"),
    ("2*atan(x)", "atan2(2*x, 1 - x**2)", "atan2(2*x, 1 + x**2)"),
    ("acos((1 - h**2)/(1 + h**2))", "2*atan(h)", "atan(h)"),
    ("atan(x) - atan(-x)", "2*atan(x)", "0"),
    ("2*acos(sqrt((1 + f)/2))", "acos(f)", "acos(f)/2"),
    ("log(tan(pi/4 + b/2))", "log((1 + sin(b))/cos(b))", "log((1 - sin(b))/cos(b))"),
    ("log((1 + sin(b))/(1 - sin(b)))/2", "log((1 + sin(b))/cos(b))", "log((1 + sin(b))*cos(b))"),
    ("log(tan(pi/4 + b/2))", "log(1 + sin(b)) - log(cos(b))", "log(1 + sin(b)) + log(cos(b))"),
)

MOTION: tuple[Row, ...] = (
    (
        "x + s*sin(w*T)/w - v*(1 - cos(w*T))/w",
        "x + 2*sin(w*T/2)/w*(s*cos(w*T/2) - v*sin(w*T/2))",
        "x + 2*sin(w*T/2)/w*(s*cos(w*T/2) + v*sin(w*T/2))",
    ),
    (
        [
            ["1", "sin(w*T)/w", "0", "-(1 - cos(w*T))/w"],
            ["0", "cos(w*T)", "0", "-sin(w*T)"],
            ["0", "(1 - cos(w*T))/w", "1", "sin(w*T)/w"],
            ["0", "sin(w*T)", "0", "cos(w*T)"],
        ],
        [
            ["1", "sin(w*T)/w", "0", "-2*sin(w*T/2)**2/w"],
            ["0", "cos(w*T)", "0", "-sin(w*T)"],
            ["0", "2*sin(w*T/2)**2/w", "1", "sin(w*T)/w"],
            ["0", "sin(w*T)", "0", "cos(w*T)"],
        ],
        [
            ["1", "sin(w*T)/w", "0", "2*sin(w*T/2)**2/w"],
            ["0", "cos(w*T)", "0", "-sin(w*T)"],
            ["0", "2*sin(w*T/2)**2/w", "1", "sin(w*T)/w"],
            ["0", "sin(w*T)", "0", "cos(w*T)"],
        ],
    ),
    ("(s*cos(w*T) - v*sin(w*T))**2 + (s*sin(w*T) + v*cos(w*T))**2", "s**2 + v**2", "s**2 + v**2 + s*v"),
    (
        "(x + T*v + T**2*s/2) + t*(v + T*s) + t**2*s/2",
        "x + (T + t)*v + (T + t)**2*s/2",
        "x + (T + t)*v + (T - t)**2*s/2",
    ),
    ("s*exp(-T/t)*exp(-T/t)", "s*exp(-2*T/t)", "s*exp(-T**2/t**2)"),
    ("t*(1 - exp(-T/t))", "2*t*exp(-T/(2*t))*sinh(T/(2*t))", "2*t*exp(-T/(2*t))*cosh(T/(2*t))"),
    ("(T/t - 1 + exp(-T/t))*t**2", "t*T - t**2*(1 - exp(-T/t))", "t*T + t**2*(1 - exp(-T/t))"),
    ("2*q/t*(t/2)*(1 - exp(-2*T/t))", "q*(1 - exp(-2*T/t))", "q*(1 - exp(-T/t))"),
    ("x**2*w/2*(1 - sin(2*w*T)/(2*w*T))", "x**2*w/2*(1 - sin(w*T)*cos(w*T)/(w*T))", "x**2*w/2*(1 - sin(w*T)/(w*T))"),
    ("sin(w*T)*cos(w*t) - cos(w*T)*sin(w*t)", "sin(w*(T - t))", "sin(w*(T + t))"),
    ("q**2/T + (q**2*T)/3", "q**2*(3 + T**2)/(3*T)", "q**2*(3 + T**2)/T"),
    ("2*q**2*log(2)/pi", "q**2*log(4)/pi", "q**2*log(3)/pi"),
    ("log(q/sqrt(T))", "log(q) - log(T)/2", "log(q) + log(T)/2"),
    ("q*T*(2*T - T)", "q*T**2", "q*T**3"),
    ("T*(T + 1)*(2*T + 1)/6 + (T + 1)**2", "(T + 1)*(T + 2)*(2*T + 3)/6", "(T + 1)*(T + 2)*(2*T + 1)/6"),
    ("(T*(T + 1)/2)**2 + (T + 1)**3", "((T + 1)*(T + 2)/2)**2", "((T + 1)*(T + 3)/2)**2"),
    ("(1 - q**(T + 1))/(1 - q)", "(1 - q**T)/(1 - q) + q**T", "(1 - q**T)/(1 - q) - q**T"),
    ("(q**T)**2", "q**(2*T)", "q**(T**2)"),
    ("sqrt(T**2 + 2*T*t + t**2)", "T + t", "T - t"),
    ("abs(T - t)*abs(T + t)", "abs(T**2 - t**2)", "T**2 - t**2"),
)

NUMBERS: tuple[Row, ...] = (
    ("log(4)", "2*log(2)", "3*log(2)"),
    ("log(6)", "log(2) + log(3)", "log(2)*log(3)"),
    ("log(8)/log(2)", "3", "4"),
    ("log(1/2)", "-log(2)", "log(2)"),
    ("log(sqrt(2))", "log(2)/2", "log(2)/3"),
    ("log(12)/log(18)", "(2*log(2) + log(3))/(log(2) + 2*log(3))", "(log(2) + 2*log(3))/(2*log(2) + log(3))"),
    ("log(3 + 2*sqrt(2))", "2*log(1 + sqrt(2))", "log(1 + sqrt(2))"),
    ("log(2 + sqrt(3)) + log(2 - sqrt(3))", "0", "1/10**30"),
    ("16*atan(1/5) - 4*atan(1/239)", "pi", "pi + 1/10**40"),
    ("4*(atan(1/2) + atan(1/3))", "pi", "3*pi/2"),
    ("8*atan(1/3) + 4*atan(1/7)", "pi", "8*atan(1/3) + 4*atan(1/8)"),
    ("atan(1) + atan(2) + atan(3)", "pi", "0"),
    ("atan(1/2) + atan(1/5) + atan(1/8)", "pi/4", "pi/4 + 1/10**20"),
    ("asin(3/5) + asin(4/5)", "pi/2", "pi/3"),
    ("2*asin(sqrt(2 - sqrt(3))/2)", "pi/6", "pi/12"),
    ("acos(1/3) + asin(1/3)", "pi/2", "pi/4"),
    ("atan2(-1, -1)", "-3*pi/4", "3*pi/4"),
    ("atan2(1, -2) - atan2(1, 2)", "pi - 2*atan(1/2)", "pi + 2*atan(1/2)"),
    ("sqrt(3 + 2*sqrt(2))", "1 + sqrt(2)", "1 + sqrt(3)"),
    ("(2 + sqrt(5))**(1/3) - (sqrt(5) - 2)**(1/3)", "1", "1 - 1/10**50"),
    ("sqrt(2 + sqrt(3))", "(sqrt(6) + sqrt(2))/2", "(sqrt(6) - sqrt(2))/2"),
    ("sqrt(5 + 2*sqrt(6))", "sqrt(2) + sqrt(3)", "sqrt(2) + sqrt(3) + 1/10**60"),
    ("(7 + 5*sqrt(2))**(1/3)", "1 + sqrt(2)", "2 + sqrt(2)"),
    ("cos(pi/5)", "(1 + sqrt(5))/4", "(1 - sqrt(5))/4"),
    ("sin(pi/10)", "(sqrt(5) - 1)/4", "(sqrt(5) + 1)/4"),
    ("cos(pi/12)", "(sqrt(6) + sqrt(2))/4", "(sqrt(6) - sqrt(2))/4"),
    ("tan(pi/8)", "sqrt(2) - 1", "sqrt(2) + 1"),
    (
        "cos(2*pi/17)",
        "(-1 + sqrt(17) + sqrt(34 - 2*sqrt(17)) + 2*sqrt(17 + 3*sqrt(17) - sqrt(34 - 2*sqrt(17))"
        " - 2*sqrt(34 + 2*sqrt(17))))/16",
        "(-1 + sqrt(17) + sqrt(34 - 2*sqrt(17)) - 2*sqrt(17 + 3*sqrt(17) - sqrt(34 - 2*sqrt(17))"
        " - 2*sqrt(34 + 2*sqrt(17))))/16",
    ),
    ("cos(pi/7)*cos(2*pi/7)*cos(3*pi/7)", "1/8", "1/7"),
    ("tan(pi/7)*tan(2*pi/7)*tan(3*pi/7)", "sqrt(7)", "7"),
    ("sin(pi/16)", "sqrt(2 - sqrt(2 + sqrt(2)))/2", "sqrt(2 + sqrt(2 + sqrt(2)))/2"),
    ("exp(log(3)/2)", "sqrt(3)", "3"),
    ("exp(2)*exp(-1)", "exp(1)", "exp(2)"),
    ("2**(1/3)*4**(1/3)", "2", "4"),
    ("sqrt(2)*sqrt(3)", "sqrt(6)", "sqrt(5)"),
    ("(sqrt(2) + sqrt(3))**2", "5 + 2*sqrt(6)", "5 + 2*sqrt(5)"),
    ("1/(2**(1/3) - 1)", "4**(1/3) + 2**(1/3) + 1", "4**(1/3) - 2**(1/3) + 1"),
    ("sinh(log(2))", "3/4", "5/4"),
    ("cosh(log(2))", "5/4", "3/4"),
    ("tanh(log(3))", "4/5", "3/5"),
)

SYMBOLS: dict[str, dict[str, Any]] = {
    "rotations": {"a": ["-7/5", "7/5"], "b": "real", "c": "real", "x": "real", "y": "real"},
    "quaternions": {name: "real" for name in "abcdefgh"},
    "schuler": {**dict.fromkeys(("w", "T", "t", "g", "R"), "positive"), "x": "real", "y": "real"},
    "kalman": {
        **dict.fromkeys(("p", "r", "q", "T"), "positive"),
        "a": ["1/10", "9/10"],
        "b": "real",
        "c": "real",
        "d": "positive",
        "u": "real",
        "v": "real",
        "k": "nonzero",
    },
    "earth": {
        "a": "positive",
        "b": ["-3/2", "3/2"],
        "c": "real",
        "l": "real",
        "h": "positive",
        "g": "positive",
        "e": ["0", "1/2"],
        "f": ["0", "1/2"],
        "u": "real",
        "v": "real",
        "x": "real",
        "m": ["0", "pi"],
    },
    "motion": {**dict.fromkeys(("w", "T", "t", "q"), "positive"), "s": "real", "v": "real", "x": "real"},
    "numbers": {},
}

SYMBOLS["rotations"]["a"] = "real"

GROUPS: dict[str, tuple[Row, ...]] = {
    "rotations": ROTATIONS,
    "quaternions": QUATERNIONS,
    "schuler": SCHULER,
    "kalman": KALMAN,
    "earth": EARTH,
    "motion": MOTION,
    "numbers": NUMBERS,
}
