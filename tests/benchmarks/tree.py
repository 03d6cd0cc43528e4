"""Text to a tree and to a polynomial, against the same text through sympy, in one run.

    python tests/benchmarks/tree.py [--terms 10000] [--symbols 300]

sympy builds the sum from parts that are ready, term by term, and makes its own sparse polynomial of it; no text of ours
goes through its parsers. Processor times; the best of three.
"""

from __future__ import annotations

import argparse
import random
import time
from collections.abc import Callable

import sympy as sp
from sympy.core.cache import clear_cache
from sympy.polys.rings import PolyRing

from navsym.language.expression import read_tree
from navsym.language.polynomials import to_polynomial
from navsym.language.printer import print_tree
from navsym.language.tree import Tree

#: A term: its coefficient, and pairs of a symbol's number and its exponent.
Term = tuple[int, list[tuple[int, int]]]


def draw_terms(terms: int, symbols: int) -> list[Term]:
    """Terms of up to four powers, with coefficients of up to four digits."""
    generator = random.Random(1)

    def power() -> tuple[int, int]:
        return generator.randrange(symbols), generator.choice((1, 1, 2, 3))

    return [
        (generator.randint(-9999, 9999) or 1, [power() for _ in range(generator.randint(1, 4))]) for _ in range(terms)
    ]


def write(terms: list[Term]) -> str:
    """The expanded polynomial as text."""
    texts = [f"{c}*" + "*".join(f"x{s}**{e}" if e > 1 else f"x{s}" for s, e in powers) for c, powers in terms]
    return " + ".join(texts).replace("+ -", "- ")


def build_in_sympy(terms: list[Term], symbols: list[sp.Symbol]) -> sp.Expr:
    """The same sum of sympy."""
    return sp.Add(*(sp.Mul(c, *(symbols[s] ** e for s, e in powers)) for c, powers in terms))


def seconds(action: Callable[[], object]) -> tuple[float, object]:
    """Processor time of the quickest of three runs, and the result."""
    times, result = [], None
    for _ in range(3):
        result = None
        clear_cache()
        started = time.process_time()
        result = action()
        times.append(time.process_time() - started)
    return min(times), result


def main() -> None:
    """Print one line for each step, with its ratio to sympy."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--terms", type=int, default=10_000)
    options.add_argument("--symbols", type=int, default=300)
    given = options.parse_args()
    terms = draw_terms(given.terms, given.symbols)
    text, names = write(terms), [f"x{k}" for k in range(given.symbols)]
    symbols = list(sp.symbols(names))
    peer, expression = seconds(lambda: build_in_sympy(terms, symbols))
    reading, tree = seconds(lambda: read_tree(text, set(names)))
    assert isinstance(tree, Tree) and isinstance(expression, sp.Expr)
    polynomial, found = seconds(lambda: to_polynomial(tree, names))
    ring = PolyRing(names, sp.QQ, sp.lex)
    other, wanted = seconds(lambda: ring.from_expr(expression))
    writing, again = seconds(lambda: print_tree(tree))
    assert len(found.to_dict()) == len(wanted) and read_tree(again) is tree  # type: ignore[attr-defined, arg-type]
    print(f"{len(text) / 1000:.0f} kB, {given.terms} terms, {given.symbols} symbols")
    print(f"text to tree          {reading:.2f} s   sum built in sympy  {peer:.2f} s   ratio {peer / reading:.1f}")
    print(
        f"tree to fmpq_mpoly    {polynomial:.2f} s   ring of sympy       {other:.2f} s   ratio {other / polynomial:.1f}"
    )
    print(f"tree to text          {writing:.2f} s")


if __name__ == "__main__":
    main()
