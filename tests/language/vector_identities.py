"""Identities of vectors, rotations, quaternions and kinematics as textbooks print them, each with a false variant.

A row is (left, right, false right). The symbols are those of DECLARED; quaternions have the scalar first, rot(q) leads
from body to frame, and C turns body into frame with the body rate w: dC/dt = C [w].
"""

DECLARED = {
    **{name: {"vector": 3} for name in "uvwab"},
    **{name: {"matrix": [3, 3]} for name in "AB"},
    **{name: {"matrix": [2, 2]} for name in "DE"},
    "F": {"matrix": [2, 3]},
    "P": {"matrix": [2, 2], "symmetric": True},
    "C": {"rotation": "b to n"},
    "q": {"quaternion": "unit"},
    "p": {"quaternion": "unit"},
    "r": {"quaternion": "any"},
    "L": {"function": "t"},
    "s": {"vector": 3, "function": "t"},
    "x": "real",
    "y": "real",
    "k": "positive",
    "phi": "real",
    "theta": ["-1", "1"],
}
RATES = {"C": "C @ skew(w)", "q": "qmul(q, [0, w[1], w[2], w[3]])/2", "u": "a"}

VECTORS = (
    ("cross(u, v)", "-cross(v, u)", "cross(v, u)"),
    ("cross(u, u)", "zeros(3, 1)", "u"),
    ("dot(u, v)", "dot(v, u)", "-dot(v, u)"),
    ("dot(u, cross(u, v))", "0", "dot(u, v)"),
    ("dot(u, cross(v, w))", "dot(v, cross(w, u))", "dot(v, cross(u, w))"),
    (
        "dot(u, cross(v, w))",
        "det([[u[1], u[2], u[3]], [v[1], v[2], v[3]], [w[1], w[2], w[3]]])",
        "det([[u[1], u[2], u[3]], [w[1], w[2], w[3]], [v[1], v[2], v[3]]])",
    ),
    ("cross(u, cross(v, w))", "v*dot(u, w) - w*dot(u, v)", "w*dot(u, v) - v*dot(u, w)"),
    ("cross(cross(u, v), w)", "v*dot(u, w) - u*dot(v, w)", "u*dot(v, w) - v*dot(u, w)"),
    ("cross(u, cross(v, w)) + cross(v, cross(w, u)) + cross(w, cross(u, v))", "[0, 0, 0]", "[0, 0, 1]"),
    (
        "dot(cross(u, v), cross(a, b))",
        "dot(u, a)*dot(v, b) - dot(u, b)*dot(v, a)",
        "dot(u, a)*dot(v, b) + dot(u, b)*dot(v, a)",
    ),
    ("norm(cross(u, v))**2", "norm(u)**2*norm(v)**2 - dot(u, v)**2", "norm(u)**2*norm(v)**2 + dot(u, v)**2"),
    ("cross(cross(u, v), cross(u, w))", "u*dot(u, cross(v, w))", "u*dot(v, cross(u, w))"),
    ("norm(u + v)**2 + norm(u - v)**2", "2*norm(u)**2 + 2*norm(v)**2", "norm(u)**2 + norm(v)**2"),
    ("norm(x*u)", "abs(x)*norm(u)", "x*norm(u)"),
    ("norm(u/norm(u))", "1", "norm(u)"),
    ("dot(u, v)", "(norm(u + v)**2 - norm(u - v)**2)/4", "(norm(u + v)**2 - norm(u - v)**2)/2"),
)
SKEW = (
    ("skew(u) @ v", "cross(u, v)", "cross(v, u)"),
    ("skew(u).T", "-skew(u)", "skew(u)"),
    ("skew(u) @ u", "zeros(3, 1)", "u"),
    ("skew(u) @ skew(u)", "u @ u.T - dot(u, u)*eye(3)", "u @ u.T + dot(u, u)*eye(3)"),
    ("skew(u) @ skew(u) @ skew(u)", "-dot(u, u)*skew(u)", "dot(u, u)*skew(u)"),
    ("skew(u) @ skew(v)", "v @ u.T - dot(u, v)*eye(3)", "u @ v.T - dot(u, v)*eye(3)"),
    ("skew(cross(u, v))", "skew(u) @ skew(v) - skew(v) @ skew(u)", "skew(v) @ skew(u) - skew(u) @ skew(v)"),
    ("skew(cross(u, v))", "v @ u.T - u @ v.T", "u @ v.T - v @ u.T"),
    ("skew(u + v)", "skew(u) + skew(v)", "skew(u) - skew(v)"),
    ("trace(skew(u))", "0", "norm(u)"),
    ("det(skew(u))", "0", "u[1]"),
    ("skew(u) @ v @ w.T", "cross(u, v) @ w.T", "cross(v, u) @ w.T"),
    ("A.T @ skew(A @ u) @ A", "det(A)*skew(u)", "-det(A)*skew(u)"),
)
MATRICES = (
    ("(A @ B).T", "B.T @ A.T", "A.T @ B.T"),
    ("trace(A @ B)", "trace(B @ A)", "trace(A)*trace(B)"),
    ("det(D @ E)", "det(D)*det(E)", "det(D) + det(E)"),
    ("inv(D @ E)", "inv(E) @ inv(D)", "inv(D) @ inv(E)"),
    ("inv(D.T)", "inv(D).T", "inv(D)"),
    ("A @ inv(A)", "eye(3)", "-eye(3)"),
    ("D @ D - trace(D)*D + det(D)*eye(2)", "zeros(2, 2)", "eye(2)"),
    ("det(D.T)", "det(D)", "-det(D)"),
    ("det(x*A)", "x**3*det(A)", "x*det(A)"),
    ("P.T", "P", "-P"),
    ("(F @ F.T).T", "F @ F.T", "-F @ F.T"),
    ("u.T @ A @ v", "dot(u, A @ v)", "dot(v, A @ u)"),
    ("diag(x, y) @ diag(x, y)", "diag(x**2, y**2)", "diag(x**2, x*y)"),
    ("inv(eye(2) + D)", "eye(2) - inv(eye(2) + D) @ D", "eye(2) + inv(eye(2) + D) @ D"),
    ("inv(inv(P) + k*eye(2))", "P - P @ inv(P + eye(2)/k) @ P", "P - P @ inv(P + k*eye(2)) @ P"),
    ("F @ transpose([[1, 0, 0]])", "[F[1,1], F[2,1]]", "[F[1,1], F[1,2]]"),
    ("cross(A @ u, A @ v)", "det(A)*inv(A).T @ cross(u, v)", "det(A)*inv(A) @ cross(u, v)"),
)
ROTATIONS = (
    ("C @ C.T", "eye(3)", "C"),
    ("inv(C)", "C.T", "C"),
    ("norm(C @ u)", "norm(u)", "norm(u)/2"),
    ("dot(C @ u, C @ v)", "dot(u, v)", "dot(C @ u, v)"),
    ("cross(C @ u, C @ v)", "C @ cross(u, v)", "C.T @ cross(u, v)"),
    ("C @ skew(u) @ C.T", "skew(C @ u)", "skew(C.T @ u)"),
    ("trace(C @ skew(u) @ C.T)", "0", "u[1]"),
    (
        "[[cos(phi), -sin(phi)], [sin(phi), cos(phi)]] @ [[cos(x), -sin(x)], [sin(x), cos(x)]]",
        "[[cos(phi + x), -sin(phi + x)], [sin(phi + x), cos(phi + x)]]",
        "[[cos(phi - x), -sin(phi - x)], [sin(phi - x), cos(phi - x)]]",
    ),
    (
        "inv([[1, 0, -sin(theta)], [0, cos(phi), sin(phi)*cos(theta)], [0, -sin(phi), cos(phi)*cos(theta)]])",
        "[[1, sin(phi)*tan(theta), cos(phi)*tan(theta)], [0, cos(phi), -sin(phi)],"
        " [0, sin(phi)/cos(theta), cos(phi)/cos(theta)]]",
        "[[1, sin(phi)*tan(theta), cos(phi)*tan(theta)], [0, cos(phi), sin(phi)],"
        " [0, sin(phi)/cos(theta), cos(phi)/cos(theta)]]",
    ),
)
QUATERNIONS = (
    ("conj(qmul(p, r))", "qmul(conj(r), conj(p))", "qmul(conj(p), conj(r))"),
    ("norm(qmul(p, r))", "norm(p)*norm(r)", "2*norm(p)*norm(r)"),
    ("qmul(q, conj(q))", "[1, 0, 0, 0]", "[0, 0, 0, 1]"),
    ("qmul(qmul(p, q), r)", "qmul(p, qmul(q, r))", "qmul(p, qmul(r, q))"),
    ("qmul([0, 1, 0, 0], [0, 0, 1, 0])", "[0, 0, 0, 1]", "[0, 0, 0, -1]"),
    (
        "qmul(qmul(q, [0, u[1], u[2], u[3]]), conj(q))",
        "[0, (rot(q) @ u)[1], (rot(q) @ u)[2], (rot(q) @ u)[3]]",
        "[0, (rot(q).T @ u)[1], (rot(q).T @ u)[2], (rot(q).T @ u)[3]]",
    ),
    ("rot(q) @ rot(q).T", "eye(3)", "rot(q)"),
    ("det(rot(q))", "1", "-1"),
    ("rot(conj(q))", "rot(q).T", "rot(q)"),
    ("rot(-q)", "rot(q)", "-rot(q)"),
    ("rot(qmul(p, r))", "rot(p) @ rot(r)", "rot(r) @ rot(p)"),
    (
        "rot([cos(x/2), 0, 0, sin(x/2)])",
        "[[cos(x), -sin(x), 0], [sin(x), cos(x), 0], [0, 0, 1]]",
        "[[cos(x), sin(x), 0], [-sin(x), cos(x), 0], [0, 0, 1]]",
    ),
    ("trace(rot(q))", "4*q[1]**2 - 1", "4*q[4]**2 - 1"),
    (
        "rot(q)",
        "(q[1]**2 - dot([q[2], q[3], q[4]], [q[2], q[3], q[4]]))*eye(3)"
        " + 2*[q[2], q[3], q[4]] @ [q[2], q[3], q[4]].T + 2*q[1]*skew([q[2], q[3], q[4]])",
        "(q[1]**2 - dot([q[2], q[3], q[4]], [q[2], q[3], q[4]]))*eye(3)"
        " + 2*[q[2], q[3], q[4]] @ [q[2], q[3], q[4]].T - 2*q[1]*skew([q[2], q[3], q[4]])",
    ),
)
KINEMATICS = (
    ("dot_(C.T)", "-skew(w) @ C.T", "skew(w) @ C.T"),
    ("dot_(C @ C.T)", "zeros(3, 3)", "skew(w)"),
    ("dot_(C @ u)", "C @ (a + cross(w, u))", "C @ (a - cross(w, u))"),
    ("dot_(dot(q, q))", "0", "norm(w)"),
    (
        "dot_(q)",
        "[[0, -w[1], -w[2], -w[3]], [w[1], 0, w[3], -w[2]], [w[2], -w[3], 0, w[1]], [w[3], w[2], -w[1], 0]] @ q/2",
        "[[0, -w[1], -w[2], -w[3]], [w[1], 0, -w[3], w[2]], [w[2], w[3], 0, -w[1]], [w[3], -w[2], w[1], 0]] @ q/2",
    ),
    ("dot_(rot(q) @ b)", "rot(q) @ cross(w, b)", "cross(w, rot(q) @ b)"),
    ("dot_(norm(u))", "dot(u, a)/norm(u)", "norm(a)"),
    ("dot_(cross(s, dot_(s)))", "cross(s, dot_(dot_(s)))", "cross(dot_(s), s)"),
    ("dot_(dot(s, s))/2", "dot(s, dot_(s))", "dot(s, s)"),
    ("dot_(sin(L)*L)", "(L*cos(L) + sin(L))*dot_(L)", "(L*cos(L) - sin(L))*dot_(L)"),
    ("diff(L**2, t, 2)", "2*dot_(L)**2 + 2*L*diff(L, t, 2)", "2*dot_(L)**2 + L*diff(L, t, 2)"),
    ("diff([x*cos(y), x*sin(y)], y)", "[-x*sin(y), x*cos(y)]", "[x*sin(y), x*cos(y)]"),
    ("diff(exp(-k*x**2/2), x, 2)", "(k**2*x**2 - k)*exp(-k*x**2/2)", "(k**2*x**2 + k)*exp(-k*x**2/2)"),
)
CASES = (
    ("where(x >= 0, x, -x)", "abs(x)", "x"),
    ("max(x, y) + min(x, y)", "x + y", "x - y"),
    ("max(x, y)", "(x + y + abs(x - y))/2", "(x + y - abs(x - y))/2"),
    ("x*sign(x)", "abs(x)", "x"),
    ("sign(x)**2*x", "x", "-x"),
    ("where(x = 0, 1, sin(x)/x)*x", "sin(x)", "sin(x)*x"),
    ("min(x, -x)", "-abs(x)", "abs(x)"),
    ("max(x, y)", "max(y, x)", "min(y, x)"),
    ("max(x, y, 0)", "max(y, max(0, x))", "max(x, y)"),
)
EVERYTHING = (*VECTORS, *SKEW, *MATRICES, *ROTATIONS, *QUATERNIONS, *KINEMATICS, *CASES)
