"""The sample functions as a fixture, made once."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest


def load(name: str) -> ModuleType:
    """A helper file beside the tests, by its name."""
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
        assert spec and spec.loader
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
    return sys.modules[name]


@pytest.fixture(scope="session")
def corruption() -> ModuleType:
    return load("corruption")


@pytest.fixture(scope="session")
def programs() -> ModuleType:
    return load("programs")


@pytest.fixture(scope="session")
def samples() -> ModuleType:
    return load("samples")
