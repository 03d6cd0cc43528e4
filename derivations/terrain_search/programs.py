"""Terrain search: the instant t_G of crossing from sums over the track, and the sequential correction."""

import sympy as sp

from navsym.claims import Equation
from navsym.export.chain import Chain, Link, Program, kept, symmetric, units_of
from navsym.export.parts import Layout

G, M = sp.symbols("G11 G12 G22", real=True), sp.symbols("M11 M12 M22", real=True)
p, q, k = sp.symbols("p q k", real=True)
bx, by = sp.symbols("beta_x beta_y", real=True)
SUMS = {"G": ("G11", "G12", "G22"), "M": ("M11", "M12", "M22")}
UNITS = units_of(
    {
        "1 (squared slopes)": "G",
        "1 (slope dh/dx)": "p",
        "1 (slope dh/dy)": "q",
        "1": "beta_x beta_y next_G",
        "number of measurements": "M k t_G t_min t_max t_mean next_M next_k",
    }
)


def one_more() -> tuple[sp.Expr, ...]:
    """The sums of g g^T and of k g g^T with one more point; k counts from zero."""
    square = (p * p, p * q, q * q)
    return (
        *(s + x for s, x in zip(G, square, strict=True)),
        *(s + k * x for s, x in zip(M, square, strict=True)),
        k + 1,
    )


def along(sums: tuple[sp.Expr, ...]) -> sp.Expr:
    """The quadratic form of a direction."""
    return sums[0] * bx**2 + 2 * sums[1] * bx * by + sums[2] * by**2


def quotient() -> Equation:
    """Three points from zero: t_G of the sums is the weighted mean of (11*), weights (p bx + q by)^2."""
    values: tuple[sp.Expr, ...] = (sp.S.Zero,) * 7
    slopes = [sp.symbols(f"p{n} q{n}", real=True) for n in range(3)]
    for slope in slopes:
        table = dict(zip((*G, *M, k), values, strict=True)) | dict(zip((p, q), slope, strict=True))
        values = tuple(e.xreplace(table) for e in one_more())
    squares = [(a * bx + b * by) ** 2 for a, b in slopes]
    return Equation(along(values[3:6]) / along(values[:3]), sum(n * s for n, s in enumerate(squares)) / sum(squares))


CROSSING = Program(
    init=kept("Sums over no points: give zeros", ("G", "M", "k"), Layout(SUMS, (), {}, UNITS)),
    step=Chain(
        title="One more point of the track with the slopes p, q of the map",
        links=(
            Link(
                ("A11", "A12", "A22", "B11", "B12", "B22", "k1"),
                "",
                one_more(),
                quotient,
                cites=("terrain_search:11*",),
            ),
        ),
        outputs={"next_G": ("A11", "A12", "A22"), "next_M": ("B11", "B12", "B22"), "next_k": "k1"},
        layout=Layout(SUMS, ("G", "M", "k", "p", "q"), {"k": (0.0, 1e4), "p": (-5.0, 5.0), "q": (-5.0, 5.0)}, UNITS),
        box={"k": (sp.Integer(0), None)},
    ),
    fields={"G": "next_G", "M": "next_M", "k": "next_k"},
)

TESTS = {"G11": (50.0, 100.0), "G12": (-20.0, 20.0), "G22": (50.0, 100.0)}
TESTS |= {"M11": (100.0, 1e4), "M12": (-1e3, 1e3), "M22": (100.0, 1e4), "beta_x": (-1.0, 1.0), "beta_y": (-1.0, 1.0)}
DIRECTION = Chain(
    title="t_G in one direction of the velocity error, from the sums of the track",
    links=(Link(("t_G",), "", (along(M) / along(G),), quotient, cites=("terrain_search:11*",)),),
    outputs={"t_G": "t_G"},
    layout=Layout(SUMS, ("G", "M", "beta_x", "beta_y"), TESTS, UNITS),
)


DET, A2, A1 = sp.symbols("det A2 A1", real=True)


def spread_formulas() -> tuple[tuple[sp.Expr, ...], sp.Expr, sp.Expr]:
    """det G and the sums A2, A1; the middle of the roots; half their distance, without cancellation."""
    sums = (G[0] * G[2] - G[1] ** 2, M[0] * G[1] - M[1] * G[0], M[0] * G[2] - M[2] * G[0])
    middle = (G[2] * M[0] - 2 * G[1] * M[1] + G[0] * M[2]) / (2 * DET)
    return sums, middle, sp.sqrt((G[0] * A1 - 2 * G[1] * A2) ** 2 + 4 * DET * A2**2) / (2 * G[0] * DET)


def extremes() -> tuple[Link, ...]:
    """Least, greatest and mean t_G: the roots of det(M - t G), and the mean over all directions."""
    half, middle, spread = sp.symbols("half middle spread", real=True)
    sums, centre, distance = spread_formulas()
    trace = G[2] * M[0] - 2 * G[1] * M[1] + G[0] * M[2]
    mean = (trace + spread * (M[0] + M[2])) / (spread * (G[0] + G[2] + 2 * spread))
    return (
        Link(("det", "A2", "A1"), "", sums, cites=("terrain_search:12.Ax2*", "terrain_search:12.Ax1")),
        Link(("middle",), "", (centre,), cites=("terrain_search:middle.trace",)),
        Link(("half",), "", (distance,), roots, cites=("terrain_search:roots.solvable",)),
        Link(("t_min", "t_max"), "", (middle - half, middle + half), cites=("terrain_search:roots.range",)),
        Link(("spread",), "", (sp.sqrt(DET),)),
        Link(("t_mean",), "", (mean,), rotated, cites=("terrain_search:mean.rotated",)),
    )


def roots() -> Equation:
    """det(M - t G) vanishes at middle - half and middle + half: at s = half^2 its even and odd parts both do."""
    sums, centre, distance = spread_formulas()
    known = dict(zip((DET, A2, A1), sums, strict=True))
    t, x = sp.symbols("t x", real=True)
    quadratic = sp.Poly(sp.expand((symmetric(M) - (t + x) * symmetric(G)).det()), x)
    c2, c1, c0 = (c.subs(t, centre.xreplace(known)) for c in quadratic.all_coeffs())
    return Equation([sp.S.Zero, sp.S.Zero], [c1, c0 + c2 * (distance**2).xreplace(known)])


def rotated() -> Equation:
    """In the axes of G (eigenvalues a^2, b^2) the mean is (m11/a + m22/b)/(a + b), in any axes the formula used."""
    a, b = sp.symbols("a b", positive=True)
    m = symmetric(M)
    angle = sp.Symbol("phi", real=True)
    R = sp.Matrix([[sp.cos(angle), -sp.sin(angle)], [sp.sin(angle), sp.cos(angle)]])
    g, turned, s = R * sp.diag(a**2, b**2) * R.T, R * m * R.T, a * b
    trace = g[1, 1] * turned[0, 0] - 2 * g[0, 1] * turned[0, 1] + g[0, 0] * turned[1, 1]
    printed = (trace + s * turned.trace()) / (s * (g.trace() + 2 * s))
    return Equation(printed, (m[0, 0] / a + m[1, 1] / b) / (a + b))


EXTREMES = Chain(
    title="Least, greatest and mean t_G over all directions of the velocity error",
    links=extremes(),
    outputs={"t_min": "t_min", "t_max": "t_max", "t_mean": "t_mean"},
    layout=Layout(SUMS, ("G", "M"), TESTS, UNITS),
)

#: t_G counts measurements; in seconds it is t_0 + t_G Deltat (terrain_search:6.time*).
CORRECTION = Chain(
    title="Position and velocity at the end of the track, corrected by both stages of the search",
    links=(
        Link(
            ("at",),
            "",
            (sp.Symbol("t_0", real=True) + sp.Symbol("t_G", real=True) * sp.Symbol("Deltat", real=True),),
            cites=("terrain_search:6.time*",),
        ),
        Link(("x_end", "y_end"), "terrain_search:14.position", rename={"t_G": "at"}),
        Link(("Vx_end", "Vy_end"), "terrain_search:14.velocity"),
    ),
    outputs={"position": ("x_end", "y_end"), "velocity": ("Vx_end", "Vy_end")},
    layout=Layout(
        {},
        ("x", "y", "Vx", "Vy", "i", "j", "Vi", "Vj", "Deltax", "Deltay", "DeltaVx", "DeltaVy", "t_n", "t_0", "t_G"),
        {"i": (-50.0, 50.0), "j": (-50.0, 50.0), "Vi": (-10.0, 10.0), "Vj": (-10.0, 10.0)},
        units_of(
            {
                "m": "x y Deltax Deltay position",
                "m/s": "Vx Vy DeltaVx DeltaVy velocity",
                "1": "i j Vi Vj",
                "s": "t_n t_0 Deltat",
                "number of measurements": "t_G",
            }
        ),
    ),
)


PROGRAMS: dict[str, Chain | Program] = {
    "terrain-crossing": CROSSING,
    "terrain-t-G": DIRECTION,
    "terrain-t-G-extremes": EXTREMES,
    "terrain-correction": CORRECTION,
}
