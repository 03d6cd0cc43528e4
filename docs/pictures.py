"""The pictures of the README and of the documentation: ``python docs/pictures.py`` writes docs/pictures/*.svg.

Every picture is computed here from models, data that come with matplotlib, or the ledger.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import sympy as sp
from matplotlib.figure import Figure
from sympy.polys.matrices import DomainMatrix

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from docs import drawings  # noqa: E402
from navsym.claims import Record  # noqa: E402
from navsym.report import plots  # noqa: E402
from navsym.verification.ledger import may_be_the_copy, records_about, stored_records  # noqa: E402

CHANNEL = {
    "model": {
        "name": "velocity channel",
        "states": ["velocity", "tilt", "drift"],
        "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    },
    "parameters": {"T": ["0", "2*pi"]},
    "measurement": [{"name": "velocity", "h": ["1", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
}


def verdicts() -> Figure:
    """Every numbered equation of the papers with the worst verdict on it, from the ledger."""
    stored = stored_records().values()
    papers = []
    for module in ("guaranteed_velocity", "joint_correction", "multistructure", "terrain_search", "trajectory"):
        card = importlib.import_module(f"navsym_papers.{module}").PAPER
        records = [record for record in stored if record.paper == module]
        cells = [(equation, worst(equation, card.equations, records)) for equation in card.equations]
        names = [author.split()[-1] for author in card.authors]
        author = " and ".join(names) if len(names) < 3 else f"{names[0]} et al."
        refuted = sum(record.status == "REFUTED" for record in records)
        name = f"{author} {card.year}" if card.year else author
        papers.append((f"{name} · {len(records)} claims, {refuted} refuted", cells))
    return plots.verdict_matrix(papers)


def worst(equation: str, equations: Sequence[str], records: Sequence[Record]) -> str:
    """The worst verdict on an equation; a definition where there is none.

    What may be damage of the copy alone is not counted against the paper.
    """
    found = records_about(equation, equations, records)
    if not found:
        return "definition"
    return "perhaps the copy" if may_be_the_copy(found[0]) else str(found[0].status)


def phases() -> Figure:
    """Guaranteed deviation of the drift by the length of the interval, every regime proved."""
    from navsym.guaranteed.phases.driver import find_phases as solved
    from navsym.guaranteed.phases.family import family_of
    from navsym.models.modelfile import model_from

    family = family_of(model_from(CHANNEL), "drift", "T")
    regimes = []
    for regime in solved(family, sp.Integer(0), 2 * sp.pi).regimes:
        at = np.linspace(max(float(regime.lower), 0.6), float(regime.upper) - 1e-6, 200)
        value = sp.lambdify(family.parameter, regime.closed.value, "numpy")(at) + 0 * at
        places = [sp.lambdify(family.parameter, place, "numpy")(at) + 0 * at for place in regime.closed.places]
        latex = sp.latex(regime.closed.value, fold_short_frac=True)
        for wide, plain in ((r"\frac", r"\dfrac"), (r"\left(", "("), (r" \right)", ")")):
            latex = latex.replace(wide, plain)
        label = f"{len(places)} times: ${latex}$"
        regimes.append({"at": at, "value": value, "label": label, "instants": places})
    made = plots.phase_diagram(
        regimes,
        parameter="length of the interval T",
        unit="Schuler units",
        quantity="guaranteed deviation\nof the drift, σ",
    )
    made.axes[0].set_yscale("log")
    return made


def dual() -> Figure:
    """The dual polynomial of the drift in its band at T = pi/2, and what the printed sign of u2 makes of it."""
    from navsym_papers.guaranteed_velocity import model, polynomial, weights

    end = {model.T: sp.pi / 2}
    at = np.linspace(0, np.pi / 2, 300)
    deviation = polynomial.deviation().subs(end)
    u2, u3 = polynomial.coefficients()
    curves = [polynomial.polynomial(first, u3).subs(end) / deviation for first in (u2, polynomial.U2_PRINTED)]
    derived, printed = (sp.lambdify(model.tau, curve, "numpy")(at) for curve in curves)
    optimum = weights.OPTIMAL_ERRORS[2].derive()
    support, found = (np.array([float(x.subs(end)) for x in part]) for part in (optimum.support, optimum.weights))
    return drawings.dual_polynomial(at, derived, support, found, printed=printed, unit="Schuler units")


def ladder() -> Figure:
    """Rank of the rows h, hF, hF^2, ... for each measurement of the full error model, and for all four."""
    from navsym_papers.joint_correction.inertial import full_model

    model = full_model()
    values = {s: sp.Rational(k + 3, 7) for k, s in enumerate(sorted(model.F.free_symbols, key=str))}
    F, H = model.F.subs(values), model.H.subs(values)
    names = [name.replace("sigma_", "σ ") for name in model.measurements]
    ranks = [ranks_of(H[k, :], F, 10) for k in range(H.rows)] + [ranks_of(H, F, 10)]
    return drawings.observability_ladder((*names, "all four"), np.array(ranks), model.size)


def ranks_of(rows: sp.Matrix, F: sp.Matrix, count: int) -> list[int]:
    """Rank of the rows h, of h and hF, and so on."""
    whole, reached = DomainMatrix.from_Matrix(rows).to_field(), []
    power, system = whole, DomainMatrix.from_Matrix(F).to_field()
    for _ in range(count):
        reached.append(whole.rank())
        power = power * system
        whole = whole.vstack(power)
    return reached


def modes() -> Figure:
    """Mode probabilities of the pulsating filter on a simulated switching signal."""
    from navsym.multimodel.filters import run_filter
    from navsym_papers.multistructure.experiment import study
    from navsym_papers.multistructure.experiment.modes import MODES

    models = study.schuler_bank()
    series = study.simulate(models, 1, 60, seed=9)
    found = run_filter(models, series.measurements[0], "pulsating")
    steps = np.arange(1, 61)
    made = plots.mode_ribbon(steps, found.probabilities, MODES)
    axes, truth = made.axes[0], [plots.COLOURS[mode] for mode in series.modes[0]]
    axes.bar(steps, 0.06, width=1, bottom=1.03, color=truth, linewidth=0)  # the true mode as a strip above
    axes.annotate("truth", (1.01, 1.06), xycoords=("axes fraction", "data"), va="center", fontsize=9)
    axes.set_ylim(0, 1.1)
    return made


def surface() -> Figure:
    """The criterion over positions on shaded relief, the track and the fix."""
    from navsym.terrain.search import criteria, prepare
    from navsym_papers.terrain_search.experiment.flights import Setting, course, fly, sample_terrain
    from navsym_papers.terrain_search.experiment.study import GRID

    terrain = sample_terrain()
    setting = Setting(measurements=260, speed=60.0, drift=0.0)
    start, heading = course(terrain, setting, 1, 5)
    flight = fly(terrain, start, heading, setting, np.random.default_rng(11))
    found = criteria(prepare(terrain, flight.track, GRID.position_only))[0, 0]
    return drawings.criterion_surface(
        terrain.heights,
        found,
        cell=terrain.dx,
        track=np.c_[flight.track.x, flight.track.y],
        origin=(terrain.extent[0], terrain.extent[2]),
        step=50.0,
    )


def errors() -> Figure:
    """An error of the northern speed with the ribbon that the smoother claims."""
    from navsym.trajectory.estimate import Settings, estimate
    from navsym.trajectory.tracks import project_positions

    t, radius = np.arange(0.0, 240.0, 1.0), 6_371_000.0
    random = np.random.default_rng(5)
    acceleration = np.cumsum(random.normal(scale=0.05, size=t.size))
    speed = 20.0 + np.cumsum(acceleration)
    north = np.cumsum(speed) - speed / 2
    noise = random.normal(size=t.size)
    track = project_positions(t, np.radians(45) + (north + noise) / radius, 0 * t, 0 * t, 1.0)
    answer, _ = estimate(track, Settings())
    scale = np.polyfit(speed, answer.velocity[:, 1], 1)[0]
    error = answer.velocity[:, 1] / scale - speed
    return drawings.error_ribbon(t, error, answer.velocity_sd[:, 1], quantity="error of the northern speed", unit="m/s")


def conditions() -> Figure:
    """Condition numbers of N_f: certified, as printed, and in double precision."""
    from navsym.trajectory.conditioning import condition
    from navsym_papers.trajectory import table

    orders = np.array([2, 3, 4, 5, 10, 15, 19, 20])
    found = [condition(int(n), "1/5", digits=15).N_f for n in orders]
    printed = [float(row[2]) if (row := table.PRINTED.get((int(n), "tau0.2"))) else np.nan for n in orders]
    return drawings.condition_numbers(
        orders,
        np.array(printed),
        np.array([float(f.enclosure.lower) for f in found]),
        double=np.array([f.double or np.nan for f in found]),
    )


PICTURES: dict[str, Callable[[], Figure]] = {
    "verdicts": verdicts,
    "phases": phases,
    "dual": dual,
    "ladder": ladder,
    "modes": modes,
    "surface": surface,
    "errors": errors,
    "conditions": conditions,
}


def main(names: list[str]) -> None:
    """Write the pictures of these names, or all."""
    folder = Path(__file__).parent / "pictures"
    folder.mkdir(exist_ok=True)
    for name in names or PICTURES:
        (folder / f"{name}.svg").write_text(plots.svg(PICTURES[name]()), encoding="utf-8")
        print(folder / f"{name}.svg")


if __name__ == "__main__":
    main(sys.argv[1:])
