"""What units a formula allows: the ways of scaling its symbols that scale every term of a sum alike.

The unit of a product is the sum of those of its factors, terms of a sum have the same unit, and the arguments of
sin, exp and the like have none: linear equations for the exponents of a base unit in the symbols. They are solved
exactly, for all base units at once; a symbol without an entry in a table of units may have any.
"""

from __future__ import annotations

from fractions import Fraction

import sympy as sp

from navsym.claims import Optimum
from navsym.prove.equations import list_entries

ALIKE = (sp.Max, sp.Min)  # arguments of one unit, which is that of the value
ONLY_ALIKE = (sp.atan2,)  # arguments of one unit, a value without


class Scaling:
    """The equations of a statement, in reduced form: leading symbol -> the others by their coefficients."""

    def __init__(self, pairs=()):
        self.solved = {}
        self.units = {}
        for left, right in pairs:
            self.same(left, right)

    def same(self, left, right):
        """Two formulas have one unit; zero has every one."""
        forms = [self.unit(side) for side in (left, right) if side != 0]
        if len(forms) == 2:
            self.equal(*forms)

    def unit(self, formula):
        """The unit of a formula: symbol -> exponent."""
        if formula not in self.units:
            self.units[formula] = self.unit_of(formula)
        return self.units[formula]

    def unit_of(self, formula):
        if formula.is_Symbol:
            return {formula.name: Fraction(1)}
        if formula.is_Mul:
            return total((self.unit(factor), 1) for factor in formula.args)
        if formula.is_Pow and formula.exp.is_Rational:
            return total([(self.unit(formula.base), Fraction(int(formula.exp.p), int(formula.exp.q)))])
        if formula.is_Add or isinstance(formula, (*ALIKE, *ONLY_ALIKE)):
            first, *others = [self.unit(part) for part in formula.args if part != 0] or [{}]
            for other in others:
                self.equal(first, other)
            return {} if isinstance(formula, ONLY_ALIKE) else first
        if isinstance(formula, sp.Abs):
            return self.unit(formula.args[0])
        for part in formula.args:
            if not isinstance(formula, sp.sign):
                self.equal(self.unit(part), {})
        return {}

    def equal(self, left, right):
        """Add the equation that two units are the same."""
        row = self.reduced(total([(left, 1), (right, -1)]))
        if not row:
            return
        lead = min(row)
        row = {name: value / row[lead] for name, value in row.items()}
        for name, other in self.solved.items():
            if lead in other:
                self.solved[name] = total([(other, 1), (row, -other[lead])])
        self.solved[lead] = row

    def reduced(self, row):
        """A row without the leading symbols of those that stand already."""
        return total([(row, 1), *((self.solved[name], -value) for name, value in row.items() if name in self.solved)])

    def denied(self, table):
        """The first equation that a table of units (name -> tuple of exponents) contradicts, or None.

        Symbols without an entry are eliminated first: they have whatever unit makes the equations hold.
        """
        bases = [dict(zip(table, powers, strict=True)) for powers in zip(*table.values(), strict=True)]
        for row in self.among(table):
            if any(sum(value * powers[name] for name, value in row.items()) for powers in bases):
                return row
        return None

    def among(self, names):
        """The equations that follow for these symbols alone."""
        ordered = Scaling()
        for row in self.solved.values():  # the smallest name leads: those of others come first
            ordered.equal({(name in names, name): value for name, value in row.items()}, {})
        return [{name: value for (_, name), value in row.items()} for lead, row in ordered.solved.items() if lead[0]]


def total(parts):
    """Sum of multiples of rows."""
    found = {}
    for row, factor in parts:
        for name, value in row.items():
            found[name] = found.get(name, 0) + value * factor
    return {name: value for name, value in found.items() if value}


def pairs_of(statement):
    """Pairs of formulas of one unit: the two sides, or what an optimum says of weights, dual and instants."""
    if not isinstance(statement, Optimum):
        return list(zip(list_entries(statement.printed), list_entries(statement.derived), strict=True))
    t, regressors, functional = statement.variable, statement.regressors, statement.functional
    found = [(place, t) for place in (*statement.interval, *statement.support)]
    found += [(dual * h, sp.Integer(1)) for dual, h in zip(statement.dual, regressors, strict=True)]
    for weight in statement.weights:
        found += [(weight * h, p) for h, p in zip(regressors, functional, strict=True)]
        found.append((weight, statement.value))
    return found


def narrowed(statement):
    """Number of equations that the printed side adds to those of the derived one, for its symbols.

    A formula allows every unit that its own derivation allows.
    """
    pairs = pairs_of(statement)
    names = {symbol.name for _, derived in pairs for symbol in derived.free_symbols}
    return len(Scaling(pairs).among(names)) - len(Scaling((derived, derived) for _, derived in pairs).solved)
