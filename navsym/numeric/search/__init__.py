"""Compiled searches over a height map: which hypothesis fits a measured profile best."""
