"""Time of an incremental ``navsym verify``: one claim touched in each of two modules, all the others kept.

Works on a copy of the sources. The store is filled with the verdicts of the ledger under the keys of the copy, so that
nothing but the two touched claims is decided. The line: 5 s and the time of the touched claims.

    python tests/benchmarks/incremental.py [repeats]
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 600
#: Claim -> its file and the beginning of its last line; a name that nothing uses is bound before it.
TOUCHED = {
    "alpha_beta_filter:4": ("navsym_papers/alpha_beta_filter.py", "    return Equation(printed=second**2 / (1 -"),
    "terrain_search:cost.few": ("navsym_papers/terrain_search/cost.py", "    return Bound(printed=10 * MV * MV"),
}
FILL = """
import json, pathlib
from navsym.verification.papers import load_papers
from navsym.verification.fingerprints import fingerprints
from navsym.core.store import Store
keys = fingerprints(claim for module in load_papers() for claim in module.claims)
store = Store()
for record in json.loads(pathlib.Path("navsym_papers/verdicts.json").read_text())["claims"]:
    if record["id"] in keys:
        store.put(keys[record["id"]], {**record, "seconds": 0.0})
"""


def python(folder: Path, *words: str) -> tuple[str, float, float]:
    """What Python says in the copy, with its seconds of wall time and of processor time."""
    environment = {**os.environ, "NAVSYM_CACHE": str(folder / "cache")}
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    ended = subprocess.run(
        [sys.executable, *words],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        check=False,
        timeout=SECONDS,
    )
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.stdout, wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def touch(folder: Path, repeat: int) -> None:
    """Change the body of one claim in each of the modules, and not what it says."""
    for name, line in TOUCHED.values():
        text = (folder / name).read_text(encoding="utf-8")
        assert text.count(line) == 1, name
        (folder / name).write_text(text.replace(line, f"    touched = {repeat}\n{line}"), encoding="utf-8")


def main(repeats: int = 3) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for part, package in (("navsym", "navsym"), ("derivations", "navsym_papers")):
            shutil.copytree(ROOT / part, folder / package)
        python(folder, "-c", FILL)
        python(folder, "-m", "navsym", "verify", "--json")  # sources compiled, files in memory
        for repeat in range(repeats):
            touch(folder, repeat)
            told, wall, spent = python(folder, "-m", "navsym", "verify", "--json")
            own = sum(r["seconds"] for r in json.loads(told)["claims"] if r["id"] in TOUCHED)
            print(
                f"two claims decided in {own:.2f} s; beside them {wall - own:.2f} s of wall time "
                f"(the line is 5 s), {spent:.2f} s of processor time with everything"
            )


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
