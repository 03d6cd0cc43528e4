"""Statements, verdicts, claims and papers: the nouns of navsym, as plain data."""

from navsym.claims.claim import Claim, claim, claims
from navsym.claims.formula import Formula
from navsym.claims.paper import Coverage, Paper, claims_of, compare_equations, equation_of
from navsym.claims.record import Record
from navsym.claims.statement import (
    UNDECIDED,
    Bound,
    Box,
    Equation,
    Finding,
    Optimum,
    Property,
    Statement,
    Worded,
    certify_at_sight,
    fact,
    state,
)
from navsym.claims.verdict import CERTIFIED, CONFIRMED, OPEN, PROVED, REFUTED, Status, Verdict, Verdicts

__all__ = [
    "CERTIFIED",
    "CONFIRMED",
    "OPEN",
    "PROVED",
    "REFUTED",
    "UNDECIDED",
    "Bound",
    "Box",
    "Claim",
    "Coverage",
    "Equation",
    "Finding",
    "Formula",
    "Optimum",
    "Paper",
    "Property",
    "Record",
    "Statement",
    "Status",
    "Verdict",
    "Verdicts",
    "Worded",
    "certify_at_sight",
    "claim",
    "claims",
    "claims_of",
    "compare_equations",
    "equation_of",
    "fact",
    "state",
]
