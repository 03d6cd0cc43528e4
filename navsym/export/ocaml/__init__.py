"""The second checker, in OCaml, written from docs/certificates.md without a look at the first.

The kinds ``design`` and ``exclusion`` are the exception: who wrote them here had seen the first.
"""
