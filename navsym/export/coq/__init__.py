"""Statements for the proof kernel Coq."""
