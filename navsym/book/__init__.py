"""The book: standard formulas of navigation and estimation, each with its verdict."""
