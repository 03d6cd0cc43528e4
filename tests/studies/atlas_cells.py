"""Cells of the atlas as they are computed: rank, unobservable space in words, exceptional set, certificate.

``docs/atlas_table.py`` keeps them in navsym/studies/atlas/atlas.json; tests compute some of them again.
"""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import sympy as sp
from flint import nmod_mat

from navsym.observability.certificates import Certifier
from navsym.observability.chains import JointObservability, direction_names, numerators, observe_jointly, observed_rows
from navsym.observability.directions import independent_columns, is_closed
from navsym.observability.linear import PRIME, at_point
from navsym.observability.motion import residue_chains
from navsym.observability.pieces import independent_rows, is_spanned
from navsym.observability.rank_drops import DropList, RankDrop, View, closed_systems, conditions_on, join_conditions
from navsym.observability.tree import leaf_on, search_drops
from navsym.studies.atlas.kept import KEPT, RANK, Cell, atlas
from navsym.studies.atlas.scenes import (
    ARM,
    EARTH,
    Aiding,
    Scene,
    cell_names,
    derivative,
    error_model,
    g,
    heading,
    list_columns,
    parts_of,
    roll,
)

#: Cases looked at for the exceptional set of a cell, and letters of a condition that is written.
NODES, LETTERS = 150, 160
#: Components in the frame of the INS, and in the body or camera.
AXES: Mapping[bool, Sequence[str]] = {True: ("north", "east", "down"), False: "xyz"}


def compute_cell(name: str) -> Cell:
    """A cell of the atlas from nothing but its name."""
    scene, aiding = parts_of(name)
    model = error_model(scene, aiding)
    named = (vector for _, vector in (*symmetries(scene, aiding), *single_states(scene, aiding)))
    joint = prove_by_guesses(observe_jointly(model), [*named, *further_guesses(scene, aiding)])
    found = find_joint_drops(joint, nonzero_symbols(scene), NODES)
    certifier = Certifier.of(model)
    drops: dict[str, RankDrop] = {}
    for drop in found.drops:
        drops[shorten(drop.condition, drops)] = drop
    proofs = {RANK: certifier.certify_rank(joint), **{key: certifier.certify_drop(drop) for key, drop in drops.items()}}
    granted = [None if isinstance(item, str) else item for item in proofs.values()]
    return Cell(
        name,
        size=model.size,
        rank=joint.joint_dimension,
        proved=joint.proved,
        unobservable=tuple(name_basis(joint, scene, aiding)),
        drops={key: drop.rank for key, drop in drops.items()},
        complete=found.complete["joint"],
        open=len(found.open["joint"]),
        unchecked={key: item for key, item in proofs.items() if isinstance(item, str)},
        certificate=hashlib.sha256(json.dumps(granted, sort_keys=True).encode()).hexdigest()[:32],
    )


def prove_by_guesses(found: JointObservability, guesses: Iterable[Sequence[sp.Expr]]) -> JointObservability:
    """A rank that is known from below, proved from above where directions of a list are unobservable; else as it was.

    guesses : directions (n,), such as symmetries of a scene; they are checked as identities
    """
    if found.proved:
        return found
    chains, n = found.chains, len(found.states)
    motion, ring, rows = chains.motion, chains.ring, [chain.vectors[0] for chain in chains.chains]
    known = {*ring.symbols, *(angle.symbol for angle in ring.angles)}
    written = [sp.Matrix([guess]) for guess in guesses if any(guess) and sp.Matrix([guess]).free_symbols <= known]
    point = motion.points(1)[0]
    seen = nmod_mat(residue_chains(rows, motion, point), PRIME)
    columns = [numerators([row], ring)[0][0] for row in written]
    unseen = (c for c in columns if (seen * nmod_mat([[x] for x in at_point([c], point)[0]], PRIME)).rank() == 0)
    chosen = independent_columns(unseen, motion, n - found.joint_dimension)
    if len(chosen) < n - found.joint_dimension or not is_closed(rows, motion, chosen):
        return found
    space = sp.ImmutableMatrix(len(chosen), n, [ring.expression(x) for column in chosen for x in column])
    chains = replace(chains, directions=chosen)
    return replace(found, unobservable=space, observed=observed_rows(chains), proved=True, written=chains)


def find_joint_drops(found: JointObservability, known: Iterable[sp.Symbol], nodes: int) -> DropList:
    """The drops of what all measurements show together, by the tree alone, at points where some symbols do not vanish.

    nodes : so many cases at most
    """
    chains = found.chains
    ring = chains.ring
    ring = ring.with_units([ring.context.gen(ring.places[s]) for s in known if s in ring.places])
    motion, rows = replace(chains.motion, ring=ring), [chain.vectors[0] for chain in chains.chains]
    cases = search_drops(rows, found.joint_dimension, ring, motion, nodes=nodes)
    generic = leaf_on([], rows, ring, motion) if cases.drops else None
    view = View("joint", rows, generic, motion, not cases.open, {})
    drops = view.list_drops(closed_systems(cases.drops), 0, cases.drops)
    left = tuple(join_conditions(conditions_on(system, ring)) for system in cases.open)
    return DropList(tuple(drops), {"joint": not cases.open}, {"joint": left})


def shorten(condition: str, others: Container[str] = ()) -> str:
    """A condition that can be read: a long one is cut, and has a number where others begin alike."""
    text = condition if len(condition) <= LETTERS else f"{condition[: LETTERS - 2]} …"
    numbered = (f"{text} ({k})" for k in itertools.count(2))
    return next(name for name in itertools.chain([text], numbered) if name not in others)


def nonzero_symbols(scene: Scene) -> list[sp.Symbol]:
    """Gravity, and the depth of what is seen."""
    return [g, *(point[2] for point in scene.points)]


# Words


def name_basis(joint: JointObservability, scene: Scene, aiding: Aiding) -> Iterator[str]:
    """A basis of the unobservable space: known symmetries and single states first, then what is left, by its states."""
    space = joint.unobservable
    chosen: list[list[sp.Expr]] = []
    for words, vector in (*symmetries(scene, aiding), *single_states(scene, aiding)):
        row = sp.ImmutableMatrix([vector])
        if len(chosen) == space.rows or all(x == 0 for x in row) or not is_spanned(space, row):
            continue
        if len(independent_rows(sp.ImmutableMatrix([*chosen, vector]))) > len(chosen):
            chosen.append(vector)
            yield words
    for k in range(space.rows):
        trial = [*chosen, list(space[k, :])]
        if len(chosen) < space.rows and len(independent_rows(sp.ImmutableMatrix(trial))) > len(chosen):
            chosen = trial
            yield name_direction(space[k, :], scene, aiding)


def single_states(scene: Scene, aiding: Aiding) -> Iterator[tuple[str, list[sp.Expr]]]:
    """Every state by itself."""
    columns = list_columns(aiding)
    for place, (block, j) in enumerate(columns):
        yield name_state(scene, block, (j,)), [sp.Integer(int(k == place)) for k in range(len(columns))]


def name_state(scene: Scene, block: str, places: Sequence[int]) -> str:
    """A block with its components."""
    axes = AXES[not scene.in_body and block in ("position", "velocity", "attitude")]
    return block if block == "delay" else f"{block.replace('_', ' ')} {', '.join(axes[j] for j in places)}"


def name_direction(row: Sequence[sp.Expr], scene: Scene, aiding: Aiding) -> str:
    """A direction by the states that take part; in full where it is short."""
    columns = list_columns(aiding)
    text = direction_names(row, [f"{name_state(scene, block, (j,))}" for block, j in columns])
    if len(text) <= LETTERS:
        return text
    blocks: dict[str, list[int]] = {}
    for value, (block, j) in zip(row, columns, strict=True):
        if value != 0:
            blocks.setdefault(block, []).append(j)
    return " with ".join(name_state(scene, block, places) for block, places in blocks.items())


def symmetries(scene: Scene, aiding: Aiding) -> Iterator[tuple[str, list[sp.Expr]]]:
    """Changes of all that leave the measurements of a camera or of a beacon as they are, where they keep the sensors'.

    They are candidates: the exact unobservable space decides which of them belong to it.
    """
    frame = scene.C
    gravity, velocity = frame * scene.gravity, frame * scene.velocity
    arm = sp.Matrix(ARM) if scene.in_body else sp.zeros(3, 1)
    landmarks = {f"landmark {k}": point + arm for k, point in enumerate(scene.points, start=1)}
    units = [sp.Matrix([int(i == j) for i in range(3)]) for j in range(3)]
    axes = AXES[not scene.in_body]
    for words, axis in (("gravity", gravity / g), *zip(axes, units, strict=True)):
        turned = {"attitude": axis, "velocity": axis.cross(velocity)}
        turned["accelerometer_bias"] = -frame.T * axis.cross(gravity)
        moved = {block: axis.cross(point) for block, point in landmarks.items()}
        yield f"turn about {words} through the body", vector_of(aiding, turned | moved)
        for point in [*landmarks.values()][:1]:
            about = {"position": -axis.cross(point)}
            yield f"turn about {words} through the first point", vector_of(aiding, turned | about)
    for words, unit in zip(axes, units, strict=True):
        yield f"common shift along {words}", vector_of(aiding, {"position": unit} | dict.fromkeys(landmarks, unit))
    scaled = {"velocity": velocity, "accelerometer_bias": -scene.acceleration, "camera arm": arm}
    yield "scale", vector_of(aiding, scaled | landmarks)


def further_guesses(scene: Scene, aiding: Aiding) -> Iterator[list[sp.Expr]]:
    """Changes without a name: an arm that turns with the body, a delay, a change of scale about a point, the Earth."""
    turn, down, forward = scene.turn, scene.C * scene.gravity / g, sp.Matrix([1, 0, 0])
    arm = sp.Matrix(ARM) if scene.in_body else sp.zeros(3, 1)
    for unit in (sp.Matrix([int(i == j) for i in range(3)]) for j in range(3)):
        pull = turn.cross(turn.cross(unit)) + derivative(turn, scene.rates).cross(unit)
        moved = {"position": unit, "velocity": turn.cross(unit), "accelerometer_bias": -pull, "camera arm": -unit}
        yield vector_of(aiding, moved)
        for point in scene.points:
            yield vector_of(aiding, {"position": unit.cross(point)})
    yaw, lean = scene.rates.get(heading, sp.Integer(0)), scene.rates.get(roll, sp.Integer(0))
    late = {"delay": sp.Matrix([1]), "camera angle": -lean * forward, "camera arm": -lean * forward.cross(arm)}
    yield vector_of(aiding, late | {"attitude": -yaw * down})
    landmarks = {f"landmark {k}": point + arm for k, point in enumerate(scene.points, start=1)}
    yield vector_of(aiding, late | {block: yaw * down.cross(point) for block, point in landmarks.items()})
    still = {block: turn.cross(point) for block, point in landmarks.items()}
    yield vector_of(aiding, {"delay": sp.Matrix([1])} | still)
    for point in scene.points:
        grown = {"position": -point - arm, "velocity": scene.C * scene.velocity, "camera arm": arm}
        yield vector_of(aiding, grown | {"accelerometer_bias": -scene.acceleration})
        axis = sp.Matrix([EARTH[0], 0, EARTH[1]])
        across = g * sp.Matrix([point[2] * EARTH[0], 0, -point[0] * EARTH[0]])
        yield vector_of(aiding, {"velocity": across, "attitude": 2 * axis.dot(point) * axis})


def vector_of(aiding: Aiding, parts: Mapping[str, sp.Matrix]) -> list[sp.Expr]:
    """A direction of the state from its blocks."""
    return [sp.expand(parts[block][j]) if block in parts else sp.Integer(0) for block, j in list_columns(aiding)]


def keep_atlas(cells: Iterable[Cell]) -> None:
    """Write cells to ``atlas.json``, in the place of those with the same names. All of them take some minutes."""
    known = {**(atlas.entries if KEPT.exists() else {}), **{cell.name: cell for cell in cells}}
    listed = [known[name] for name in cell_names() if name in known]
    lines = []
    for cell in listed:
        own = {key: value for key, value in cell.document().items() if key != "name"}
        lines.append(f"{json.dumps(cell.name)}: {json.dumps(own, ensure_ascii=False)}")
    KEPT.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
