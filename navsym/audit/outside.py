"""What code is compared with from other files: claims and models."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from navsym.core.errors import DomainError, ExpressionSyntaxError, UnknownSymbolError
from navsym.language.names import quote
from navsym.language.printer import to_text
from navsym.models.model import Model
from navsym.prove.claimfile import read_claims, require_numbers


def read_claim_side(reference: Any, folder: Path, where: str) -> list[list[str]]:
    """The right side of a claim of a claim file, ``"formulas.toml:half-angle"``, as rows of texts."""
    if not isinstance(reference, str) or ".toml:" not in reference:
        message = f'expected a claim such as "claims.toml:name"; got {quote(reference)}; write file and id'
        raise ExpressionSyntaxError(message, where=where)
    file, _, name = reference.rpartition(":")
    claims = {claim.id: claim for claim in read_claims(folder / file).claims}
    if name not in claims:
        message = f"expected a claim of {file} ({', '.join([*claims][:12])}); got {quote(name)}; correct the id"
        raise UnknownSymbolError(message, where=where)
    claim = require_numbers(claims[name])
    if claim.relation != "=" or claim.tolerance is not None:
        raise DomainError("expected an equation; got another claim; choose one with =", where=where)
    right = claim.formula.right
    rows = right if isinstance(right, list) else [right]
    return [[str(cell) for cell in row] if isinstance(row, list) else [str(row)] for row in rows]


def read_model_matrices(path: Path) -> dict[str, list[list[str]]]:
    """F, and H, of a linear model file as rows of texts."""
    model = Model.load(path)
    found = {"F": model.F, "H": model.H}
    return {
        key: [[to_text(matrix[i, j]) for j in range(matrix.shape[1])] for i in range(matrix.shape[0])]
        for key, matrix in found.items()
        if matrix is not None
    }
