"""Coverage-guided fuzzing of one reader, where atheris is installed: a driver, not a test.

    pip install atheris
    python tests/attacks/atheris_driver.py claims -runs=100000
"""

from __future__ import annotations

import sys


def main() -> None:
    import atheris

    with atheris.instrument_imports(include=["navsym"]):
        from navsym.methods.campaigns.parser import OUTCOMES, answer
        from navsym.methods.campaigns.readers import READERS

    name = sys.argv.pop(1) if len(sys.argv) > 1 else "expression"
    read, _ = READERS[name]

    def one(data: bytes) -> None:
        outcome = answer(read, data)
        if outcome not in OUTCOMES:
            raise AssertionError(outcome)

    atheris.Setup(sys.argv, one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
