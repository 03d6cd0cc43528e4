"""Pages, erratum sheets, explanations and plots of what was decided."""
