"""Frames of vectors: inferred from the declared ones by unification; a sum of vectors of two frames is an error.

A matrix leads from one frame to another: ``C`` with ``rotation = "b to n"`` takes vectors of b to vectors of n,
``skew(v)`` stays in the frame of v, ``A.T`` leads back. A vector is a matrix whose columns have no frame. A name
without a frame is an unknown. Only formulas with a vector of a declared frame are looked at, or of matrices that all
have frames, of several: a rotation alone also acts on numbers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from navsym.core.errors import DomainError
from navsym.language.dimensions import print_part
from navsym.language.shapes import Shape
from navsym.language.tree import SUM, SYMBOL, Tree, fold_tree, list_names
from navsym.language.vectors import BINDERS, RELATIONS

#: The frames of rows and of columns; None for a number.
Sides = tuple[str, str] | None
NONE = "no frame"
#: Unknown frames begin like this, which no name does.
UNKNOWN = "?"


class Unification:
    """Frames that are one."""

    def __init__(self, shapes: Mapping[str, Shape], where: str):
        self.shapes, self.where = shapes, where
        self.parent: dict[str, str] = {}
        self.count = 0

    def fresh(self) -> str:
        """An unknown frame."""
        self.count += 1
        return f"{UNKNOWN}{self.count}"

    def find(self, frame: str) -> str:
        """The frame that an unknown one is."""
        while frame in self.parent:
            frame = self.parent[frame]
        return frame

    def unify(self, x: str, y: str, what: str, left: Tree, right: Tree) -> None:
        """Two frames are one; raises DomainError that names both parts where they cannot be."""
        a, b = self.find(x), self.find(y)
        if a == b:
            return
        if not a.startswith(UNKNOWN) and not b.startswith(UNKNOWN):
            parts = (print_part(left), print_part(right))
            got = " and ".join(f"{part} in {frame}" for part, frame in zip(parts, (a, b), strict=True))
            message = f"expected {what} in one frame; got {got}; turn one of them by its rotation"
            raise DomainError(message, where=self.where)
        if a.startswith(UNKNOWN):
            self.parent[a] = b
        else:
            self.parent[b] = a

    def alike(self, parts: Sequence[Tree], inner: Sequence[Sides], what: str) -> Sides:
        """The frames of parts that are added or compared."""
        known = [(part, sides) for part, sides in zip(parts, inner, strict=True) if sides is not None]
        for part, sides in known[1:]:
            for x, y in zip(known[0][1] or (), sides, strict=True):
                self.unify(x, y, what, known[0][0], part)
        return known[0][1] if known else None

    def symbol(self, name: str) -> Sides:
        """The frames of a name."""
        shape = self.shapes.get(name)
        if shape is None or shape.size is None or shape.kind == "quaternion":
            return None
        ends = shape.frame.split(" to ") if shape.frame else []
        if len(ends) == 2:
            return ends[1].strip(), ends[0].strip()
        if shape.size[1] == 1:
            return shape.frame or f"{UNKNOWN}{name}", NONE
        return shape.frame or f"{UNKNOWN}{name} rows", shape.frame or f"{UNKNOWN}{name} columns"

    def step(self, part: Tree, inner: list[Sides]) -> Sides:
        """The frames of a part from those of its own parts."""
        head, arrays = part.head, [sides for sides in inner if sides is not None]
        if head == SYMBOL:
            return self.symbol(part.args[0])
        if head in (SUM, *RELATIONS):
            sides = self.alike(part.args, inner, "terms" if head == SUM else "two sides")
            return sides if head == SUM else None
        if head in ("cross", "dot"):
            sides = self.alike(part.args, inner, "vectors")
            return sides if head == "cross" else None
        if head == "@":
            return self.times(part, *inner)
        if head == "cov":
            return (arrays[0][0], arrays[-1][0]) if arrays else None
        if head in ("T", "transpose", "inv"):
            return (arrays[0][1], arrays[0][0]) if arrays else None
        if head == "skew":
            return (arrays[0][0], arrays[0][0]) if arrays else None
        if head == "where":
            return self.alike(part.args[1:], inner[1:], "two cases")
        if head == "matrix":
            return self.fresh(), NONE if len(part.args[0].args) == 1 else self.fresh()
        if head == "eye":
            frame = self.fresh()
            return frame, frame
        if head in ("zeros", "diag", "rot"):
            return self.fresh(), self.fresh()
        if head in BINDERS:
            return inner[0]
        if head in ("index", "norm", "det", "trace", "qmul", "conj", "row"):
            return None
        return arrays[0] if arrays else None

    def times(self, part: Tree, left: Sides, right: Sides) -> Sides:
        """A matrix product."""
        if left is None or right is None:
            return None
        self.unify(left[1], right[0], "what a product joins", *part.args)
        return None if left[0] == right[1] == NONE else (left[0], right[1])


def infer_frames(
    trees: Sequence[Tree],
    shapes: Mapping[str, Shape],
    rates: Mapping[str, Tree] | None = None,
    *,
    where: str | Sequence[str] = "",
) -> dict[str, str]:
    """The frames of all vectors and matrices of some formulas, as far as the declared ones settle them.

    trees, shapes, rates, where : as for :func:`navsym.language.dimensions.infer_units`; a rate stays in the frame

    Returns name -> frame, ``b to n`` for a matrix. Raises DomainError that names two parts in different frames;
    says nothing where no vector has a frame and all matrices lead alike.

    >>> from navsym.language.shapes import read_shape
    >>> from navsym.language.vectors import read_hypothesis
    >>> table = {"v": {"vector": 3, "frame": "n"}, "C": {"rotation": "b to n"}, "f": {"vector": 3}}
    >>> shapes = {name: read_shape(name, value, (), "")[0] for name, value in table.items()}
    >>> infer_frames([read_hypothesis("v = C @ f", {name: shape.size for name, shape in shapes.items()})], shapes)
    {'v': 'n', 'C': 'b to n', 'f': 'b'}
    """
    slopes = rates or {}
    names = dict.fromkeys([*list_names(*trees, *slopes.values()), *slopes])
    used = [shapes[name] for name in names if name in shapes]
    declared = {shape.frame for shape in used if shape.frame}
    several = len(declared) > 1 and all(shape.frame for shape in used if shape.size)
    if not (several or any(x.frame and x.kind == "vector" for x in used)) or any(shape.sizes for shape in used):
        return {}
    unification = Unification(shapes, where if isinstance(where, str) else "")
    for name, rate in slopes.items():
        sides = [unification.symbol(name), fold_tree(rate, unification.step)]
        unification.alike([rate, rate], sides, f"{name} and its rate")
    for k, tree in enumerate(trees):
        unification.where = where if isinstance(where, str) else where[k]
        fold_tree(tree, unification.step)
    found = {}
    for shape in used:
        sides_of = unification.symbol(shape.name)
        frames = [unification.find(side) for side in sides_of or ()]
        if frames and not any(frame.startswith(UNKNOWN) for frame in frames):
            found[shape.name] = frames[0] if frames[1] == NONE else f"{frames[1]} to {frames[0]}"
    return found
