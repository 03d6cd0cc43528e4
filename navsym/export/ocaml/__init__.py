"""The second checker, in OCaml, written from docs/certificates.md alone."""
