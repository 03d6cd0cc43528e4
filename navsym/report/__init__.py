"""Verdicts for people: pages, errata, explanations, citations, pictures, notebooks."""
