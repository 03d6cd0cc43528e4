"""What the user has: a model with the roles of its states, the quantities of its parameters, and what is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from navsym.conventions.card import BACKWARD, CHOICES, Card
from navsym.conventions.measuring import CORRECTED, MEASURED, MEASURED_MARK, NOISE_MARK, NOISES, RESET_MARK
from navsym.conventions.mechanisation import ROLES
from navsym.core.errors import DomainError, DuplicateError, EmptyError, ShapeError, UnknownSymbolError
from navsym.language.declarations import Parameter, read_parameters
from navsym.language.expression import read_tree
from navsym.language.names import Table, check_name, join_place, quote, suggest_nearest
from navsym.language.printer import print_tree
from navsym.language.schema import (
    as_formula,
    as_list,
    as_table,
    as_text,
    as_title,
    expect_keys,
    require_distinct,
    require_key,
)
from navsym.language.tree import MINUS_ONE, ONE, SYMBOL, ZERO, Tree, build_sum, build_symbol
from navsym.language.tree import replace as replace_parts
from navsym.models.modelfile import BESIDE, TABLES, read_ranges

#: Quantities -> the numbers of components that they may have.
QUANTITIES: Mapping[str, tuple[int, ...]] = {
    **dict.fromkeys(
        "specific_force specific_force_body angular_rate velocity velocity_body position transport_rate".split(), (3,)
    ),
    **dict.fromkeys("latitude longitude earth_angle wander_angle height radius_slope".split(), (1,)),
    **dict.fromkeys(("lever_arm", "known_vector", *(f"{role}_correction" for role in CORRECTED)), (3,)),
    **{"rotation": (9,), "quaternion": (4,), "earth_rate": (1, 3), "gravity": (1, 3), "radii": (1, 2, 3)},
    "gravitational_parameter": (1,),
}

#: Unit -> the roles and quantities that have it; a position in latitude, longitude and height has three.
UNITS: Mapping[str, str] = {
    "m": "position position_correction height radii radius_slope lever_arm",
    "m/s": "velocity velocity_body velocity_correction",
    "rad": "attitude attitude_correction latitude longitude earth_angle wander_angle rotation quaternion",
    "rad/s": "gyro_bias angular_rate earth_rate transport_rate",
    "m/s^2": "accelerometer_bias specific_force specific_force_body gravity",
    "m^3/s^2": "gravitational_parameter",
    "1": "gyro_scale accelerometer_scale",
}

#: Tables of a model file that say nothing about the error dynamics.
UNUSED = tuple(name for name in TABLES if name not in ("model", "parameters", "units"))

#: Names of quantities that the user has not given begin like this.
HIDDEN = "unnamed_"

Grid = tuple[tuple[Tree, ...], ...]

#: Rotation from the body by a unit quaternion w + x i + y j + z k of Hamilton's algebra that leads from there.
BY_QUATERNION = (
    ("w**2 + x**2 - y**2 - z**2", "2*(x*y - w*z)", "2*(x*z + w*y)"),
    ("2*(x*y + w*z)", "w**2 - x**2 + y**2 - z**2", "2*(y*z - w*x)"),
    ("2*(x*z - w*y)", "2*(y*z + w*x)", "w**2 - x**2 - y**2 + z**2"),
)


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A model and what is said about it.

    F, H, G, reset : entries as trees, row by row; empty where they are not given
    roles      : role -> places of its three states; measured: what H shows -> its rows; noises: noise -> columns of G
    quantities : quantity -> its components as trees
    known      : field of a card -> its value; own: the words of the card from which F was derived
    ranges     : name -> exact ends of an input of exported code
    unused     : tables of the file that were not looked at, and states without a role
    """

    name: str
    states: tuple[str, ...]
    F: tuple[tuple[Tree, ...], ...]
    parameters: Mapping[str, Parameter]
    declared: Table
    roles: Mapping[str, tuple[int, ...]]
    quantities: Mapping[str, tuple[Tree, ...]]
    known: Mapping[str, str]
    unused: tuple[str, ...] = field(default=())
    H: Grid = ()
    G: Grid = ()
    reset: Grid = ()
    measured: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    noises: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    ranges: Mapping[str, tuple[Any, Any]] = field(default_factory=dict)
    own: Mapping[str, str] = field(default_factory=dict)

    def under(self, card: Card) -> Problem:
        """The problem with the rotation that the card makes of a quaternion."""
        if "quaternion" not in self.quantities:
            return self
        words = card.quaternion()
        names = "xyzw" if words.get("quaternion_order") == "scalar last" else "wxyz"
        parts = {build_symbol(name): tree for name, tree in zip(names, self.quantities["quaternion"], strict=True)}
        rows = zip(*BY_QUATERNION, strict=True) if words.get("quaternion_direction") == BACKWARD else BY_QUATERNION
        C = tuple(replace_parts(read_tree(text, None), parts) for row in rows for text in row)
        return replace(self, quantities={**self.quantities, "rotation": C})

    def units(self, card: Card) -> dict[str, str]:
        """The units of states and of quantities with a name, in the errors of a card."""
        units = {word: unit for unit, words in UNITS.items() for word in words.split()}
        components = {role: [build_symbol(self.states[k]) for k in places] for role, places in self.roles.items()}
        found = {
            tree.args[0]: units[name]
            for name, trees in ({**self.quantities} | components).items() if name in units
            for tree in trees if tree.head == SYMBOL
        }  # fmt: skip
        if card.position_error == "geodetic" and "position" in self.roles:
            found |= dict.fromkeys((self.states[k] for k in self.roles["position"][:2]), "rad")
        return found

    @property
    def is_placed(self) -> bool:
        """True where latitude, longitude, radii, and the height above an ellipsoid, tell the position."""
        lifted = "height" in self.quantities or len(self.quantities.get("radii", ())) < 2
        return lifted and {"latitude", "longitude", "radii"} <= set(self.quantities)

    def places(self, side: str) -> tuple[int, ...]:
        """The rows or columns of a side of a block."""
        if side.startswith(MEASURED_MARK):
            return self.measured[side.removeprefix(MEASURED_MARK)]
        if side.startswith(NOISE_MARK):
            return self.noises[side.removeprefix(NOISE_MARK)]
        return self.roles[side.removeprefix(RESET_MARK)]

    def block(self, row: str, column: str) -> list[list[Tree]]:
        """The block of two sides; of the reset less the unit matrix."""
        matrix = getattr(self, matrix_of((row, column)))
        cells = [[matrix[i][j] for j in self.places(column)] for i in self.places(row)]
        if row == RESET_MARK + column:
            for k, cells_of in enumerate(cells):
                cells_of[k] = ZERO if cells_of[k] is ONE else build_sum(cells_of[k], MINUS_ONE)
        return cells


def matrix_of(block: tuple[str, str]) -> str:
    """The matrix in which a block stands: F, H, G or reset."""
    if block[0].startswith(MEASURED_MARK):
        return "H"
    return "reset" if block[0].startswith(RESET_MARK) else "G" if block[1].startswith(NOISE_MARK) else "F"


def read_problem(document: Table, where: str = "") -> Problem:
    """The problem of a document; raises a NavsymError whose ``where`` names the key."""
    expect_keys(document, (*TABLES, *BESIDE), where)
    place, spot = (join_place(where, name) for name in ("model", "parameters"))
    model = as_table(require_key(document, "model", where), place)
    declared = as_table(document.get("parameters", {}), spot)
    parameters = read_parameters(declared, spot)
    expect_keys(model, ("name", "states", "F", "H", "G", "reset"), place)
    spot = join_place(place, "states")
    items = as_list(require_key(model, "states", place), spot, "a list of names")
    states = tuple(check_name(item, where=join_place(spot, k)) for k, item in enumerate(items))
    require_distinct((*parameters, *states), spot)
    if taken := [name for name in (*parameters, *states) if name.startswith(HIDDEN)]:
        message = f"expected names without {HIDDEN}, which is for quantities without a name; got {quote(taken[0])}"
        raise DomainError(f"{message}; rename it", where=join_place(where, "parameters"))
    n = len(states)
    F = read_grid(require_key(model, "F", place), parameters, join_place(place, "F"), n, n)
    more = read_more(document, model, parameters, n, where)
    roles = read_roles(require_key(document, "roles", where), states, join_place(where, "roles"))
    free = [f"state {name}" for k, name in enumerate(states) if not any(k in places for places in roles.values())]
    return Problem(
        name=as_title(model.get("name", "model"), join_place(place, "name")),
        states=states,
        F=F,
        parameters=parameters,
        declared=declared,
        roles=roles,
        quantities=read_quantities(document.get("quantities", {}), parameters, join_place(where, "quantities")),
        known=read_known(document.get("known", {}), join_place(where, "known")),
        unused=(*(name for name in UNUSED if name in document and not (name == "measurement" and "H" in more)), *free),
        ranges=read_ranges(document, states, parameters, where),
        own=read_known(document.get("card", {}), join_place(where, "card")),
        **more,
    )


def read_more(document: Table, model: Table, names: Mapping[str, Any], n: int, where: str) -> dict[str, Any]:
    """H, G and the reset, and what their rows and columns are."""
    place, found = join_place(where, "model"), dict[str, Any]()
    if "measured" in document:
        beside, spot = "measurement" in document and "H" not in model, join_place(where, "measurement")
        blocks = as_list(document["measurement"], spot) if beside else []
        tables = [(as_table(block, join_place(spot, k)), join_place(spot, k)) for k, block in enumerate(blocks)]
        labels = [block.get("name") for block, _ in tables]
        rows = [require_key(block, "h", at) for block, at in tables] if beside else require_key(model, "H", place)
        found["H"] = read_grid(rows, names, join_place(place, "H"), None, n)
        spot = join_place(where, "measured")
        found["measured"] = read_places(document["measured"], MEASURED, labels, len(found["H"]), spot)
    if "noises" in document:
        spot, sizes = join_place(where, "noises"), dict.fromkeys(NOISES, 3)
        found["G"] = read_grid(require_key(model, "G", place), names, join_place(place, "G"), n, None)
        found["noises"] = read_places(document["noises"], sizes, [], len(found["G"][0]), spot)
    for name, table in (("H", "measured"), ("G", "noises")):
        if name in model and name not in found:
            message = f"expected [{table}] beside {name}; got none; say what it shows, such as velocity = [1, 2, 3]"
            raise EmptyError(message, where=join_place(where, table))
    if "reset" in model:
        found["reset"] = read_grid(model["reset"], names, join_place(place, "reset"), n, n)
    return found


def read_places(
    value: Any, sizes: Mapping[str, int], labels: Sequence[Any], most: int, where: str
) -> dict[str, tuple[int, ...]]:
    """Kind -> places of its states, rows or columns: by labels, or by numbers from 1 to ``most``; each has one kind."""
    table, found, taken = as_table(value, where), dict[str, tuple[int, ...]](), dict[int, str]()
    expect_keys(table, tuple(sizes), where)
    for kind, items in table.items():
        spot, places = join_place(where, kind), list[int]()
        listed = as_list(items if isinstance(items, list) else [items], spot, "a list of names or numbers")
        if len(listed) != sizes[kind]:
            raise ShapeError(f"expected {sizes[kind]} of them; got {len(listed)}; give one for each axis", where=spot)
        for k, item in enumerate(listed):
            at = join_place(spot, k)
            if item in labels:
                places.append(labels.index(item))
            elif isinstance(item, int) and not isinstance(item, bool) and 1 <= item <= most:
                places.append(item - 1)
            elif most:
                raise ShapeError(f"expected a number from 1 to {most}; got {quote(item)}; correct it", where=at)
            else:
                near = suggest_nearest(as_text(item, at, "the name of a state"), labels)
                raise UnknownSymbolError(f"expected a state; got {quote(item)}; correct it: {near}", where=at)
            if places[-1] in taken:
                message = f"expected each once; got {quote(item)} in {taken[places[-1]]} and {kind}; drop one"
                raise DuplicateError(message, where=at)
            taken[places[-1]] = kind
        found[kind] = tuple(places)
    return found


def read_cell(value: Any, names: Mapping[str, Any], where: str) -> Tree:
    """An entry as it is written."""
    return read_tree(as_formula(value, where), names.keys(), where=where)


def read_grid(value: Any, names: Mapping[str, Any], where: str, height: int | None, width: int | None) -> Grid:
    """A matrix of entries; None for as many rows or columns as there are."""
    rows = as_list(value, where, "a list of rows")
    width = len(as_list(rows[0], join_place(where, 0), "a list of expressions")) if width is None and rows else width
    for k, row in enumerate([rows, *rows]):
        spot, size = (where, height or len(rows)) if k == 0 else (join_place(where, k - 1), width)
        if len(as_list(row, spot, "a list of expressions")) != size or not row:
            got = f"{len(row)} {'rows' if k == 0 else 'entries'}"
            message = f"expected {size}, one per {'state' if height == width else 'row or state'}; got {got}"
            raise ShapeError(f"{message}; correct the matrix", where=spot)
    return tuple(
        tuple(read_cell(item, names, join_place(join_place(where, i), j)) for j, item in enumerate(row))
        for i, row in enumerate(rows)
    )


def read_roles(value: Any, states: Sequence[str], where: str) -> dict[str, tuple[int, ...]]:
    """Role -> places of its three states; no state has two roles."""
    roles = read_places(value, dict.fromkeys(ROLES, 3), states, 0, where)
    if not {"velocity", "attitude", "position"} & set(roles):
        message = "expected velocity, attitude or position; got none of them; say which states they are"
        raise EmptyError(message, where=where)
    return {role: roles[role] for role in ROLES if role in roles}


def read_quantities(value: Any, names: Mapping[str, Any], where: str) -> dict[str, tuple[Tree, ...]]:
    """Quantity -> its components, row by row."""
    table = as_table(value, where)
    expect_keys(table, tuple(QUANTITIES), where)
    quantities = {}
    for name, items in table.items():
        place, sizes = join_place(where, name), QUANTITIES[name]
        cells = list_cells(items, place)
        rows = [isinstance(row, list) and len(row) for row in items] if len(cells) == 9 else [3, 3, 3]
        if len(cells) not in sizes or rows != [3, 3, 3]:
            wanted = f"{' or '.join(map(str, sizes))} components"
            wanted = "three rows of three entries" if name == "rotation" else wanted
            raise ShapeError(f"expected {wanted}; got {len(cells)} entries; correct {name}", where=place)
        quantities[name] = tuple(read_cell(cell, names, spot) for cell, spot in cells)
    if {"rotation", "quaternion"} <= set(quantities):
        raise DuplicateError("expected rotation or quaternion; got both; remove one of them", where=where)
    return quantities


def list_cells(items: Any, where: str) -> list[tuple[Any, str]]:
    """The entries of a scalar, a list or a matrix, with their places."""
    if not isinstance(items, list):
        return [(items, where)]
    return [cell for k, item in enumerate(as_list(items, where)) for cell in list_cells(item, join_place(where, k))]


def read_known(value: Any, where: str) -> dict[str, str]:
    """The parts of the card that are certain."""
    table = as_table(value, where)
    expect_keys(table, tuple(CHOICES), where)
    for name, word in table.items():
        place = join_place(where, name)
        text = as_text(word, place, "a word")
        if text not in CHOICES[name]:
            message = f"expected one of {', '.join(CHOICES[name])}; got {quote(text)}; correct it"
            raise DomainError(message, where=place)
    return dict(table)


def print_matrix(M: Sequence[Sequence[Tree]]) -> list[list[str]]:
    """A matrix of trees as texts."""
    return [[print_tree(x) for x in row] for row in M]
