"""The streaming rule of a guard as code: tables of regressors, the exchange in doubles, bounds of all its errors."""

from __future__ import annotations

import json
import math
import random
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

from flint import arb, arb_mat, fmpq

from navsym.core.balls import precision
from navsym.core.errors import DomainError
from navsym.core.exact import to_fmpq, to_fraction
from navsym.export import streaming_rule
from navsym.export.algorithms.models import plain_name
from navsym.export.functions import RefusedError
from navsym.export.languages.writer import environment
from navsym.export.package import Exported, Order, license_id, manifest, write_verified
from navsym.export.roundtrip import MANIFEST, sealed
from navsym.export.streaming_rule import MOST_EXCHANGES, NEAR, Group, StreamingRule
from navsym.guaranteed.streaming.flow import BITS, Flow
from navsym.guaranteed.streaming.guard import Guard
from navsym.guaranteed.streaming.numbers import to_float

LANGUAGES = ("c", "cpp", "python")
MOST_ENTRIES = 50_000
MOST_UNKNOWNS = 16
#: Beyond this distance of its bounds on the vectors the rule is not worth its name.
WIDEST = 1e-6
UNIT = Fraction(1, 2**53)
LAWS = {
    "bounded": "no error in memory exceeds its sigma",
    "variance": "no standard deviation exceeds its sigma, whatever the correlation; it then bounds that of the error",
}


@dataclass(frozen=True, eq=False)
class Rule:
    """A guard with constant system and fixed memory: its tables of doubles, and how far these are from the truth.

    Rows are ``h_j exp(-F lag)`` in the unknowns that all measurements together need, each a power of two of its unit.
    """

    guard: Guard

    def __post_init__(self) -> None:
        guard, flow = self.guard, self.flow
        if guard.outliers:
            got = f"outliers={guard.outliers}"
            raise RefusedError(f"expected a guard of bounded errors; got {got}; its tree of sets has no bound of time")
        if not flow.is_invariant:
            message = "expected F, h and sigma that do not depend on time; got others; give sigma with every epoch"
            raise RefusedError(message, where="export")
        if guard.length is None or guard.pace is None:
            lost = "memory" if guard.length is None else "step"
            raise RefusedError(f"expected a fixed memory and a step; got no {lost}; give Guard({lost}=...)")
        if flow.size > MOST_UNKNOWNS or self.rows * flow.size > MOST_ENTRIES:
            got = f"{flow.size} unknowns and {self.rows} rows"
            message = f"expected at most {MOST_UNKNOWNS} unknowns and {MOST_ENTRIES} entries; got {got}; shorten memory"
            raise RefusedError(message, where="export")

    @cached_property
    def flow(self) -> Flow:
        """The model in the unknowns of all measurements, apart from what the guard has seen."""
        with precision(BITS):
            return Flow(self.guard.model.read(), self.guard.target, "export")

    @cached_property
    def groups(self) -> list[Group]:
        """Measurements that are bounded together, and those by themselves; see StreamingRule."""
        blocks = {block.members[0]: block for block in self.flow.blocks}
        inside = {j for block in self.flow.blocks for j in block.members[1:]}
        found: list[Group] = []
        for j in sorted(set(range(len(self.flow.names))) - inside):
            block = blocks.get(j)
            if block is None or block.norm == "l1":
                found.append((block.members if block else (j,), (), 1.0))
                continue
            inverse, size = block.shape.inv(), range(len(block.members))
            with precision(BITS):
                reach = upward(to_fraction(max(arb(inverse[k, k]).sqrt().upper() for k in size)))
            found.append((block.members, [[to_float(block.shape[i, k]) for k in size] for i in size], reach))
        return found

    @property
    def pace(self) -> fmpq:
        """The time between epochs."""
        return self.guard.pace or fmpq(1)

    @property
    def rows(self) -> int:
        """Measurements in a full memory."""
        return (self.guard.length or 0) * len(self.flow.names)

    @cached_property
    def name(self) -> str:
        """The name of the code."""
        found = plain_name(plain(f"{self.guard.model.name}_{self.guard.target}_guard"))
        return found if found[0].isalpha() else f"guard_{found}"

    @cached_property
    def numbers(self) -> tuple[list[list[float]], list[float], float]:
        """(table, functional, error beyond half a unit of the last place)."""
        flow, step = self.flow, self.pace
        with precision(BITS):
            balls = []
            for lag in range(self.guard.length or 0):
                back = (flow.systems[0] * arb(-step * lag)).exp()
                balls += [flow.cut(flow.row(j, fmpq(0)) * back).entries() for j in range(len(flow.names))]
            target = flow.cut(flow.row_of_target).entries()
            largest = [max(float(abs(row[k]).upper()) for row in balls) for k in range(flow.size)]
            scales = [fmpq(2) ** -math.frexp(x)[1] if 0.0 < x < math.inf else fmpq(1) for x in largest]
            table = [[nearest(e * s) for e, s in zip(row, scales, strict=True)] for row in balls]
            functional = [nearest(e * s) for e, s in zip(target, scales, strict=True)]
        beyond = max(error for row in [*table, functional] for _, error in row)
        doubles = [[x for x, _ in row] for row in table]
        return doubles, [x for x, _ in functional], upward(beyond) if beyond else 0.0

    @cached_property
    def sigma(self) -> list[float]:
        """The bounds of the model, rounded up."""
        with precision(BITS):
            bounds = [self.flow.sigma(j, fmpq(0))[0] for j in range(len(self.flow.names))]
            return [upward(to_fraction(s.upper())) for s in bounds]

    @property
    def twin(self) -> StreamingRule:
        """The rule in Python."""
        table, functional, tiny = self.numbers
        return StreamingRule(table, functional, self.sigma, tiny, self.guard.length or 0, self.groups)

    def words(self, license_: str, gap: str = "") -> dict[str, Any]:
        """What the templates are filled with."""
        table, functional, tiny = self.numbers
        wide, blank = self.twin.wide, [0] * self.twin.wide
        return {
            "license": license_,
            "name": self.name,
            "upper": self.name.upper(),
            "guard": f"{self.name.upper()}_H",
            "about": f"guaranteed estimate of {plain(self.guard.target)}, epoch by epoch",
            "target": plain(self.guard.target),
            "epochs": self.guard.length,
            "step": f"{self.pace} in the unit of time of the model",
            "law": LAWS[self.guard.bound],
            "names": [plain(name) for name in self.flow.names],
            "size": self.flow.size,
            "wide": wide,
            "near": repr(self.twin.near),
            "perturbed": repr(NEAR),
            "most": MOST_EXCHANGES * wide**2,
            "members": [[*members, *blank][:wide] for members, *_ in self.groups],
            "counts": [len(members) for members, *_ in self.groups],
            "shapes": [
                [[*map(repr, row), *blank][:wide] for row in [*shape, *([blank] * wide)][:wide]]
                for _, shape, _ in self.groups
            ],
            "balls": [int(bool(shape)) for _, shape, _ in self.groups],
            "reaches": [repr(reach) for *_, reach in self.groups],
            "table": [[repr(x) for x in row] for row in table],
            "functional": [repr(x) for x in functional],
            "sigma": [repr(x) for x in self.sigma],
            "tiny": repr(tiny),
            "gap": gap,
        }


def plain(text: str) -> str:
    """A name that the model gives, as it may stand in a comment of any language."""
    return re.sub(r"[^A-Za-z0-9_]", "_", text)


def nearest(x: arb) -> tuple[float, Fraction]:
    """The double nearest to the middle of a ball, and how far beyond half a unit of it the ball reaches."""
    middle = to_fmpq(x)
    value = to_float(middle)
    exact = Fraction(value)
    error = abs(exact - to_fraction(middle)) + to_fraction(arb(x.rad()).upper())
    return value, max(error - UNIT * abs(exact), Fraction(0))


def upward(x: Fraction) -> float:
    """The least double that is not below."""
    value = float(x)
    return value if Fraction(value) >= x else math.nextafter(value, math.inf)


def downward(x: Fraction) -> float:
    """The largest double that is not above."""
    return -upward(-x)


# The stream of test vectors


def draw_stream(rule: Rule, count: int) -> list[dict[str, Any]]:
    """Epochs of a random state with bounded errors, gaps, changed bounds and one that must be refused, in doubles."""
    flow, step, generator = rule.flow, rule.pace, random.Random(0)
    total = (rule.guard.length or 0) + count
    with precision(BITS):
        size = len(flow.functional)
        middle = arb_mat([[arb(generator.randint(-3, 3))] for _ in range(size)])
        rows, share = [], [1.0] * len(flow.names)
        for members, _, reach in rule.groups:
            for j in members:
                share[j] = 1.0 / (len(members) * reach)  # such errors keep the bound that they have together
        for k in range(total):
            state = (flow.systems[0] * arb(step * (k - total // 2))).exp() * middle
            z: list[float | None] = []
            sigma = [s * generator.choice((1.0, 1.0, 1.0, 0.5, 4.0)) for s in rule.sigma]
            for j, bound in enumerate(s * p for s, p in zip(sigma, share, strict=True)):
                true = (flow.row(j, fmpq(0)) * state)[0, 0]
                noisy = float((true + arb(bound) * arb(fmpq(generator.randint(-1000, 1000), 1000))).mid())
                kept = abs(arb(noisy) - true) <= arb(bound) and generator.random() < 0.8
                z.append(noisy if kept and not (total // 3 <= k < total // 3 + 2) else None)
            truth = (flow.row_of_target * state)[0, 0]
            ends = [downward(to_fraction(truth.lower())), upward(to_fraction(truth.upper()))]
            rows.append({"z": z, "sigma": sigma, "truth": ends})
    refused = {"z": [1.0] * len(rule.sigma), "sigma": [0.0] * len(rule.sigma), "truth": [0.0, 0.0]}
    return [*rows[: total // 2], refused, *rows[total // 2 :]]  # it takes no time


def expect(rule: Rule, rows: list[dict[str, Any]]) -> float:
    """Add what the twin says and what the guard proves to every epoch; the largest distance of the twin's bounds.

    Raises RefusedError where the twin has no bounds, or where they are far apart.
    """
    twin = rule.twin
    guard = Guard(rule.guard.model, rule.guard.target, rule.guard.bound, memory=rule.guard.length, step=str(rule.pace))
    widest = 0.0
    for row in rows:
        status, _, radius, least = twin.step(row["z"], row["sigma"])
        row["status"], row["least"] = status, [0.0, 0.0]
        if status == 1:
            continue
        given = {name: Fraction(s) for name, s in zip(guard.flow.names, row["sigma"], strict=True)}
        known = guard.step(row["z"], sigma=given).radius
        if status == 0 and known is not None:
            row["least"] = [downward(Fraction(known.lower)), upward(Fraction(known.upper))]
            widest = max(widest, (radius - least) / radius)
        if status == 3 or (status == 0 and known is None) or widest > WIDEST:
            message = "expected a rule whose rounding errors are small; got bounds that are far apart"
            raise RefusedError(f"{message}; take a shorter memory or a longer step", where="export")
    if all(row["status"] for row in rows):
        message = f"expected a state that {rule.guard.length} epochs determine; got none"
        raise RefusedError(f"{message}; take a longer memory, or leave out what no measurement shows", where="export")
    return widest


def write_twin(rule: Rule, license_: str) -> str:
    """The Python module: the text of the twin, and the tables of this rule."""
    words = rule.words(license_)
    rows = "\n".join(f"    ({', '.join(row)},)," for row in words["table"])
    functional, sigma = (", ".join(words[key]) for key in ("functional", "sigma"))
    groups = "".join(f"    {group!r},\n" for group in rule.groups)
    about = f"{words['about']} from the last {words['epochs']} epochs, each {words['step']} after the one before"
    text = Path(streaming_rule.__file__).read_text(encoding="utf-8")
    return (
        f"# {license_}\n# {about}\n# measurements: {', '.join(words['names'])}\n{text}"
        f"\n\nTABLE = (\n{rows}\n)\nGROUPS = (\n{groups})\n\n\ndef new_guard() -> StreamingRule:\n"
        f'    """A guard with an empty memory."""\n'
        f"    return StreamingRule(TABLE, ({functional},), ({sigma},), {words['tiny']}, {words['epochs']}, GROUPS)\n"
    )


# Files


def files_of_rule(rule: Rule, order: Order) -> tuple[dict[str, str], dict[str, Any]]:
    """Relative name -> text of all files, and the record of the rule."""
    rows = draw_stream(rule, order.count)
    widest = expect(rule, rows)
    gap = repr(2.0 ** math.ceil(math.log2(max(4.0 * widest, 1e-13))))
    words = rule.words(f"SPDX-License-Identifier: {license_id(order.license)}", gap)
    tables = words | {
        key: ["NAN" if x is None else repr(x) for x in column] for key, column in columns_of(rows).items()
    }

    def fill(template: str, **more: Any) -> str:
        return environment().get_template(f"guard/{template}.j2").render(tables | {"rows": rows} | more)

    name, found = rule.name, {}
    wanted = {target.name for target in order.targets}
    for folder in sorted(wanted & {"c", "cpp"}):
        cpp = folder == "cpp"
        found[f"{folder}/{name}.h"] = fill("header.h")
        found[f"{folder}/{name}.hpp" if cpp else f"c/{name}.c"] = fill("header.hpp" if cpp else "source.c")
        found[f"{folder}/test_main.{folder}"] = fill("test_main", cpp=cpp)
        found[f"{folder}/test_vectors.h"] = fill("test_vectors.h")
        found[f"{folder}/CMakeLists.txt"] = fill("CMakeLists.txt", cpp=cpp)
    if "python" in wanted:
        found[f"python/{name}.py"] = write_twin(rule, words["license"])
        found["python/test_vectors.py"] = fill("test_vectors.py")
        found["python/vectors.json"] = json.dumps(rows) + "\n"
    found["guard.json"] = json.dumps(rule.guard.save(), indent=1) + "\n"
    record = {
        "name": name,
        "claims": [f"the least guaranteed error of {rule.guard.target} ({rule.guard.bound})"],
        "status": ["CERTIFIED"],
        "rounding": [f"radius and least enclose the optimum; on the vectors within {gap} of each other"],
    }
    found[MANIFEST] = sealed(manifest([record], "double", order, found))
    return found, record


def columns_of(rows: Sequence[dict[str, Any]]) -> dict[str, list[Any]]:
    """The vectors as the tables of the test program."""
    ends = [(name, k, end) for name in ("truth", "least") for k, end in enumerate(("low", "high"))]
    found = {f"{name}_{end}": [row[name][k] for row in rows] for name, k, end in ends}
    found |= {f"{name}s": [x for row in rows for x in row[name]] for name in ("z", "sigma")}
    return found | {"statuses": [row["status"] for row in rows]}


def export_guard(guard: Guard, order: Order, out: Path) -> Exported:
    """The rule of a guard as code, compiled and replayed; raises RefusedError for a guard that has no such rule."""
    others = [target.name for target in order.targets if target.name not in LANGUAGES]
    if others:
        message = f"expected languages among {', '.join(LANGUAGES)} for a guard; got {others[0]}; leave it out"
        raise DomainError(message, where="export: to")
    files, record = files_of_rule(Rule(guard), order)
    outcomes = write_verified(files, order, out)
    return Exported(out, (record,), outcomes, tuple(files))


def guard_of(items: Sequence[Any], real: str) -> Guard | None:
    """The guard that is to be exported, where it is one or the file of one."""
    found = [item for item in items if isinstance(item, Guard) or (isinstance(item, str) and item.endswith(".json"))]
    if not found:
        return None
    if real != "double":
        raise DomainError(f"expected double for a guard; got {real}; leave it out", where="real")
    if len(items) > 1:
        raise DomainError("expected a guard by itself; got other things beside it; export them one by one")
    return found[0] if isinstance(found[0], Guard) else Guard.load(found[0])
