"""Ready-made programs as Python modules, made once for all tests."""

from __future__ import annotations

import functools
import importlib.util
import tempfile
from pathlib import Path
from types import ModuleType

from navsym.export.languages.modules import files
from navsym.export.materials import material_of_claim
from navsym.export.parts import ExportedFunction
from navsym.export.ready import algorithm

LICENSE = "SPDX-License-Identifier: Apache-2.0"


@functools.cache
def decided(claim: str):
    return material_of_claim(claim, False)


@functools.cache
def functions(name: str, real: str = "double") -> tuple[ExportedFunction, ...]:
    return tuple(algorithm(name, decided, real))


@functools.cache
def module(name: str) -> ModuleType:
    """The exported Python of a ready-made algorithm."""
    made = files("python", functions(name), {f.name: [] for f in functions(name)}, LICENSE)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "navsym_functions.py"
        path.write_text(made["navsym_functions.py"])
        spec = importlib.util.spec_from_file_location(f"exported_{name.replace('-', '_')}", path)
        assert spec and spec.loader
        loaded = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(loaded)
    return loaded
