"""Claims of papers decided and kept: fingerprints, verdicts, the ledger."""
