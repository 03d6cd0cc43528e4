"""What the paper does not ask: over which ground position and velocity cannot be told together, whatever the search.

A measurement k sees of an error (c, v) of position and velocity only g_k'(c + k v), g_k the slopes under it. All
searches of the paper rest on the matrix J of these rows. It is singular exactly when some c + k v lies along the
contour line under every measurement: over a hill of revolution, over a fan, and over every quadratic ground.
"""

from itertools import combinations

import sympy as sp

from navsym.claims import Bound, Equation, claim, claims
from navsym_papers.terrain_search.model import inverse, moment, slopes

s = sp.symbols("s0:6", real=True)
times = sp.symbols("t1:5", real=True)
start, move = sp.Matrix(sp.symbols("x0 y0", real=True)), sp.Matrix(sp.symbols("V_x V_y", real=True))
TURN = sp.Matrix([[0, -1], [1, 0]])
LONGEST = 5


def row(slope: tuple[sp.Expr, sp.Expr], time: sp.Expr) -> sp.Matrix:
    """What one measurement sees: (g', t g')."""
    return sp.Matrix([[*slope, *(time * g for g in slope)]])


def joint_information(points: list) -> sp.Matrix:
    """J = sum of (g, k g)(g, k g)' (4, 4) of the measurements 0…n."""
    G, M1, M2 = (moment(points, power) for power in range(3))
    return sp.Matrix(sp.BlockMatrix([[G, M1], [M1, M2]]))


def bracket(first: tuple, second: tuple) -> sp.Expr:
    """Signed area between two slopes: zero when they have one direction."""
    return first[0] * second[1] - first[1] * second[0]


def four(points: list, at: tuple) -> sp.Expr:
    """[12][34] (t1 - t4)(t2 - t3) + [14][23] (t1 - t2)(t4 - t3)."""
    (g1, g2, g3, g4), (t1, t2, t3, t4) = points, at
    first = bracket(g1, g2) * bracket(g3, g4) * (t1 - t4) * (t2 - t3)
    return first + bracket(g1, g4) * bracket(g2, g3) * (t1 - t2) * (t4 - t3)


CLAIMS_JOINT = claims(
    # Their determinant is [12][34](t1 - t4)(t2 - t3) + [14][23](t1 - t2)(t4 - t3), [ij] the area between two slopes.
    "joint.four | Four measurements fail to fix the four unknowns just when slope directions and times have one "
    "cross-ratio.",
    lambda: Equation(
        four(slopes(3), times),
        sp.Matrix.vstack(*(row(g, t) for g, t in zip(slopes(3), times, strict=True))).det(method="berkowitz"),
    ),
)


@claim("joint.determinant")
def determinant_of_the_joint_search():
    """det J is the sum of the squares of those determinants over all fours of measurements; of fewer it is zero."""
    for size in (1, 2, 3, 4):
        points = slopes(size)
        fours = combinations(range(size + 1), 4)
        yield (
            sum((four([points[k] for k in chosen], chosen) ** 2 for chosen in fours), sp.Integer(0)),
            joint_information(points).det(method="berkowitz"),
        )


def place(k: int) -> sp.Matrix:
    """Where measurement k is taken, from the middle of the hill or the tip of the fan."""
    return start + k * move


def unseen(points: list, position: sp.Matrix, velocity: sp.Matrix) -> Equation:
    """J times an error that no measurement sees is zero."""
    error = sp.Matrix.vstack(position, velocity)
    return Equation([sp.Integer(0)] * 4, list(joint_information(points) * error))


def quadratic_ground() -> tuple[sp.Matrix, sp.Matrix]:
    """Slope at the start and its change from one measurement to the next: Hessian times V, both free."""
    return sp.Matrix(sp.symbols("b_x b_y", real=True)), sp.Matrix(sp.symbols("w_x w_y", real=True))


def quadratic_points(count: int) -> list:
    b, w = quadratic_ground()
    return [tuple(b + k * w) for k in range(count)]


CLAIMS_JOINT_2 = claims(
    # Slopes s_k (x_k - summit) with free s_k; the error is c = R x_0, v = R V, R the quarter turn.
    "joint.hill | Over a hill of revolution of any profile, a turn about its summit is not seen: no search finds "
    "all four numbers.",
    lambda: unseen([tuple(s[k] * place(k)) for k in range(LONGEST)], TURN * start, TURN * move),
    "joint.fan | Over ground that keeps its height along the rays from a point, a stretch from that point is not seen.",
    lambda: unseen([tuple(s[k] * TURN * place(k)) for k in range(LONGEST)], start, move),
)


@claim("joint.quadratic")
def quadratic_ground_is_blind():
    """Over quadratic ground, flown straight and evenly, the error R g_k along the contours is not seen to first order.

    The slopes b + k w change linearly, so that R g_k is itself an error of position R b and velocity R w.
    """
    b, w = quadratic_ground()
    return unseen(quadratic_points(LONGEST), TURN * b, TURN * w)


@claim("joint.quadratic.second")
def second_stage_is_blind():
    """There the second stage of the sequential search answers zero to the velocity R w: S R w = 0."""
    _, w = quadratic_ground()
    G, M1, M2 = (moment(quadratic_points(4), power) for power in range(3))
    return Equation([sp.Integer(0)] * 2, list((M2 - M1 * inverse(G) * M1) * TURN * w))


CLAIMS_JOINT_3 = claims(
    "joint.cubic | Cubic ground is enough: flown along x over the heights x + x^2 y, four measurements fix all "
    "four numbers.",
    lambda: Bound(
        joint_information([(sp.Integer(1), sp.Integer(k) ** 2) for k in range(4)]).det(method="berkowitz"),
        ">",
        sp.Integer(0),
    ),
)


@claim("joint.narrow")
def one_direction_of_slope():
    """Where all slopes have one direction, even the position is not seen across it, and neither is the velocity."""
    across = sp.Matrix(sp.symbols("n_x n_y", real=True))
    return unseen(
        [tuple(s[k] * across) for k in range(LONGEST)], TURN * across, sp.Symbol("q", real=True) * (TURN * across)
    )
