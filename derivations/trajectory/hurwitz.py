"""What a count of roots says in the language of the checker: signs of Hurwitz's determinants.

All roots of a0 w^n + ... + an lie left of the imaginary axis just where a0, the determinants D_1 ... D_(n - 1) and an
are positive (Hurwitz). If none is 0, as many roots lie right of it as a0, D_1, D_2/D_1, ..., an change their sign.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from navsym.claims import state
from navsym_papers.trajectory.scaling import write_rows


def say_signs(
    coefficients: Sequence[str], symbols: Mapping[str, Any] | None = None, negative: Sequence[int] = ()
) -> tuple[dict[str, Any], ...]:
    """That a0, D_1 ... D_(n - 1) and an are positive, or those of some places negative.

    coefficients : a0, ..., an as texts, n <= 6
    """
    n = len(coefficients) - 1

    def entry(i: int, j: int) -> str:
        place = 1 + 2 * j - i
        return coefficients[place] if 0 <= place <= n else "0"

    minors = [write_rows([[entry(i, j) for j in range(k)] for i in range(k)]) for k in range(1, n)]
    terms = [coefficients[0], *(f"det({rows})" for rows in minors), coefficients[n]]
    return tuple(state(term, "<" if k in negative else ">", "0", symbols) for k, term in enumerate(terms))
