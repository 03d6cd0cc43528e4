"""Equations 5 and 6: normalised variables in one stage and in two, and why both end at the same place."""

from functools import lru_cache
from itertools import product
from math import comb

import sympy as sp

from navsym.claims import PROVED, Equation, Property, claim, claims, fact, state
from navsym_papers.trajectory import model

x = sp.Symbol("x", real=True)

rho, tau = sp.symbols("rho tau", positive=True)

#: Small order for statements with irrational norms; the two-stage procedure is printed for n = 5.
SMALL, PRINTED = 4, 5
LARGEST = 30
X = sp.symbols(f"x1:{PRINTED + 1}", real=True)


def step(n: int) -> sp.Matrix:
    return model.nilpotent_exponential(model.dynamics(n, rho), tau)


def measured(n: int) -> sp.Matrix:
    """H_p = H Phi."""
    return model.first_state(n) * step(n)


def N_p(n: int) -> sp.Matrix:
    return model.stepped_rows(measured(n), step(n))


def D(n: int) -> sp.Matrix:
    """Matrix of the one-stage procedure: norms of the columns of N_p."""
    return sp.diag(*model.norms_of_columns(N_p(n)))


def D_f(n: int) -> sp.Matrix:
    """First stage: the entries of H_p."""
    return model.row_scaling(measured(n))


def in_first_stage(n: int) -> tuple[sp.Matrix, sp.Matrix]:
    """Transition matrix and measurement row in f = D_f x."""
    scale = D_f(n)
    return (scale * step(n) * scale.inv()).applyfunc(sp.cancel), (measured(n) * scale.inv()).applyfunc(sp.cancel)


def N_f(n: int) -> sp.Matrix:
    Phi_f, h_f = in_first_stage(n)
    return model.stepped_rows(h_f, Phi_f)


def D_s(n: int) -> sp.Matrix:
    return sp.diag(*model.norms_of_columns(N_f(n)))


# -- one stage -----------------------------------------------------------------------------------------


def powers(n: int) -> list[sp.Expr]:
    """Lengths of the columns 1^k, 2^k, ..., n^k for k = 0 ... n - 1."""
    return [sp.sqrt(sum(sp.Integer(i) ** (2 * k) for i in range(1, n + 1))) for k in range(n)]


def sensitivity(matrix: sp.Matrix) -> list[sp.Expr]:
    return [*matrix.diff(rho), *matrix.diff(tau)]


CLAIMS_5 = claims(
    "5.Phi | Phi^- = D Phi D^-1: binomial coefficients times |column i| / |column j| of the powers i^(j-1); n = 4.",
    lambda: Equation(
        D(SMALL) * step(SMALL) * D(SMALL).inv(),
        sp.Matrix(SMALL, SMALL, lambda i, j: comb(j, i) * powers(SMALL)[i] / powers(SMALL)[j]),
    ),
    "5.H | H^- = H_p D^-1: one over the lengths of the columns of the powers i^(j-1); n = 4.",
    lambda: Equation(list(measured(SMALL) * D(SMALL).inv()), [1 / length for length in powers(SMALL)]),
)


@claim("5.independent | The normalised matrices Phi^- and H^- do not depend on rho and tau; n = 5.")
def independent_of_rho_and_tau():
    scale = D(PRINTED)
    changes = sensitivity(scale * step(PRINTED) * scale.inv()) + sensitivity(measured(PRINTED) * scale.inv())
    return Equation([sp.Integer(0)] * len(changes), changes)


# -- two stages: the first -----------------------------------------------------------------------------


PRINTED_NF = sp.Matrix(
    [[1, 1, 1, 1, 1], [1, 2, 4, 8, 16], [1, 3, 9, 27, 81], [1, 4, 16, 64, 256], [1, 5, 25, 125, 625]]
)


@lru_cache(maxsize=1)
def transitions() -> sp.Matrix:
    """Phi_f of the largest order: its leading blocks are those of all smaller orders."""
    return in_first_stage(LARGEST)[0]


SCOPE = f"n = {LARGEST} and, as leading blocks, every smaller n; D_f exp(A tau) D_f^-1 for free rho, tau"


def write_rows(rows) -> str:
    """A matrix, or a vector, in the language of statements."""
    return "[" + ", ".join(write_rows(row) if isinstance(row, list) else str(row) for row in rows) + "]"


POSITIVE = {name: ["0", None, ["open-low"]] for name in ("rho", "tau")}


def say_entries(rows: list[dict[tuple[int, int], int]]) -> tuple[dict, ...]:
    """That D_f Phi D_f^-1, not multiplied out, has these entries at these places: one statement for each row."""
    scale, Phi = D_f(LARGEST), step(LARGEST)

    def write(i: int, j: int) -> str:
        return f"({scale[i, i]})*({Phi[i, j]})/({scale[j, j]})"

    texts = [([write(*place) for place in row], list(row.values())) for row in rows]
    return tuple(state(write_rows(left), "=", write_rows(right), POSITIVE) for left, right in texts)


CLAIMS_6 = claims(
    "6.Df | D_f = diag(1, rho tau, rho tau^2/2!, rho tau^3/3!, rho tau^4/4!) turns H_p into a row of ones.",
    lambda: Equation(sp.diag(1, rho * tau, rho * tau**2 / 2, rho * tau**3 / 6, rho * tau**4 / 24), D_f(PRINTED)),
    "6.Phif | Phi_f for n = 5.",
    lambda: Equation(
        sp.Matrix([[1, 1, 1, 1, 1], [0, 1, 2, 3, 4], [0, 0, 1, 3, 6], [0, 0, 0, 1, 4], [0, 0, 0, 0, 1]]),
        in_first_stage(PRINTED)[0],
    ),
    "6.Hf | H_f = (1, 1, 1, 1, 1).",
    lambda: Equation(sp.Matrix([[1, 1, 1, 1, 1]]), in_first_stage(PRINTED)[1]),
    "6.Nf | N_f for n = 5.",
    lambda: Equation(PRINTED_NF, N_f(PRINTED)),
)


@claim("6.Phif.triangular | Phi_f is upper triangular with integer elements, Phi_f,ii = 1 and Phi_f,1j = 1; n = 30.")
def transition_is_triangular():
    Phi, places = transitions(), [(i, j) for i in range(LARGEST) for j in range(LARGEST)]
    holds = all(Phi[i, j].is_Integer and (j >= i or Phi[i, j] == 0) for i, j in places)
    holds = holds and all(Phi[i, j] == 1 for i, j in places if i in (0, j))
    rows = [{(i, j): comb(j, i) for j in range(LARGEST)} for i in range(LARGEST)]
    return fact(True, holds, "exact matrix", PROVED, scope=SCOPE, meaning=say_entries(rows))


def recurrence_holds(row_step: int) -> Property:
    """Phi_(i + row_step(i), j+1) = Phi_ij + Phi_(i+1)j wherever all three elements exist.

    row_step 1 is i + 1; 0 stands for the printed i + i.
    """
    Phi = transitions()

    def target(i: int) -> int:
        return 2 * i + 1 if row_step == 0 else i + 1

    rows, columns = [i for i in range(LARGEST) if target(i) < LARGEST], range(LARGEST - 1)
    found = all(Phi[target(i), j + 1] == Phi[i, j] + Phi[i + 1, j] for i in rows for j in columns)

    def say(i: int) -> dict:
        before = [write_rows([Phi[i + k, j] for j in columns]) for k in (0, 1)]
        return state(write_rows([Phi[target(i), j + 1] for j in columns]), "=", " + ".join(before))

    return fact(True, found, "exact matrix", PROVED, scope=SCOPE, meaning=tuple(map(say, rows)))


def reached(allowed) -> int:
    """How many elements above the diagonal of the printed 5 x 5 matrix the rules determine.

    Known at the start: the diagonal, the first row, the zeros below the diagonal.
    """
    known = {(i, j) for i in range(PRINTED) for j in range(PRINTED) if i >= j or i == 0}
    size = 0
    while size != len(known):
        size = len(known)
        known |= {
            (i + 1, j + 1)
            for i, j in product(range(PRINTED - 1), repeat=2)
            if allowed(i, j) and {(i, j), (i + 1, j)} <= known
        }
    return sum(j > i for i, j in known)


def say_range(allowed) -> Property:
    """That the rules lead to the printed matrix; an element that no rule names, unlike those known, is any number."""
    Phi = [["1"] * PRINTED, *([int(i == j) for j in range(PRINTED)] for i in range(1, PRINTED))]
    symbols = {f"p{i}{j}": [None, None, []] for j in range(PRINTED) for i in range(1, j) if not allowed(i - 1, j - 1)}
    for j in range(1, PRINTED):
        for i in range(1, j):
            Phi[i][j] = f"p{i}{j}" if f"p{i}{j}" in symbols else f"({Phi[i - 1][j - 1]} + {Phi[i][j - 1]})"
    meaning = [state(write_rows(Phi), "=", write_rows(model.pascal_rows(PRINTED)), symbols)]
    return fact(10, reached(allowed), "closure of the rules", PROVED, scope="n = 5", meaning=meaning)


CLAIMS_6_2 = claims(
    "6.Phif.recurrence | Phi_(i+i, j+1) = Phi_ij + Phi_(i+1)j, as printed. | undecidable: the first index is i + "
    "1: with i + i, i = 2, j = 3 the rule asks Phi_4,4 = 2 + 1, but it is 1",
    lambda: recurrence_holds(0),
    "6.Phif.recurrence* | Phi_(i+1, j+1) = Phi_ij + Phi_(i+1)j: Pascal's triangle of n = 30.",
    lambda: recurrence_holds(1),
    "6.Phif.range | The recurrence for i >= j determines all 10 elements above the diagonal (n = 5). | "
    "undecidable: for i >= j the recurrence only says 0 = 0 + 0 and 1 = 1 + 0: six of the ten elements above the "
    "diagonal stay undetermined; the range has to be i <= j",
    lambda: say_range(lambda i, j: i >= j),
    "6.Phif.range* | The recurrence for i <= j determines all 10 elements above the diagonal (n = 5).",
    lambda: say_range(lambda i, j: i <= j),
)


@claim("6.Nf.elements | N_f,ij = i^(j-1); n = 16.")
def observability_elements():
    found = tuple(int(x) for x in N_f(16))
    printed = tuple(i**j for i in range(1, 17) for j in range(16))
    rows = [[f"{i}**{j}" for j in range(16)] for i in range(1, 17)]
    meaning = (state(write_rows(rows), "=", write_rows(N_f(16).tolist())),)
    return fact(printed, found, "exact matrix", PROVED, scope="n = 16", meaning=meaning)


CLAIMS_6_3 = claims(
    "6.Nf.row_step | Row x of N_f times Phi_f is row x + 1, for every x: the binomial theorem, columns 1 to 16.",
    lambda: Equation(
        [(x + 1) ** j for j in range(16)], [sum(x**m * comb(j, m) for m in range(j + 1)) for j in range(16)]
    ),
)


# -- two stages: the second ----------------------------------------------------------------------------


CLAIMS_6_4 = claims(
    "6.Np | N_p = N_f D_f with the printed matrices; n = 5.",
    lambda: Equation(
        PRINTED_NF * sp.diag(1, rho * tau, rho * tau**2 / 2, rho * tau**3 / 6, rho * tau**4 / 24), N_p(PRINTED)
    ),
)


@claim("6.Np.rows | Row x of N_p, H Phi(x tau), is row (x^0, x^1, ...) of N_f times D_f, for every positive x; n = 12.")
def observability_row_by_row():
    x = sp.Symbol("x", positive=True)
    n = 12
    return Equation(
        [x**j * (rho * tau**j / sp.factorial(j) if j else 1) for j in range(n)],
        list(model.first_state(n) * model.nilpotent_exponential(model.dynamics(n, rho), x * tau)),
    )


CLAIMS_6_5 = claims(
    "6.D | D = D_s D_f for positive rho and tau; n = 5.",
    lambda: Equation(D_s(PRINTED) * D_f(PRINTED), D(PRINTED)),
    "6.D.orders | D = D_s D_f for positive rho and tau, column by column, n = 2 to 8.",
    lambda: Equation(
        [x for n in range(2, 9) for x in (D_s(n) * D_f(n)).diagonal()],
        [x for n in range(2, 9) for x in D(n).diagonal()],
    ),
    "6.Ns | N_s = N_pN for positive rho and tau; n = 5.",
    lambda: Equation(N_f(PRINTED) * D_s(PRINTED).inv(), N_p(PRINTED) * D(PRINTED).inv()),
)


@claim("6.more_stages | With D_p = diag(1, rho, ..., rho) as a first stage the model no longer contains rho; n = 5.")
def an_earlier_stage_takes_rho_out():
    D_p = sp.diag(1, *([rho] * (PRINTED - 1)))
    changes = [*(D_p * step(PRINTED) * D_p.inv()).diff(rho), *(measured(PRINTED) * D_p.inv()).diff(rho)]
    return Equation([sp.Integer(0)] * len(changes), changes)
