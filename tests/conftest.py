"""What all tests share: reproducible random examples, no colours, no windows."""

from __future__ import annotations

import os

from hypothesis import settings

# Examples are the same on every machine and every run; a shared machine may be slow, so no deadline.
settings.register_profile("navsym", derandomize=True, deadline=None, max_examples=50, database=None)
settings.load_profile("navsym")

os.environ["NO_COLOR"] = "1"
os.environ["MPLBACKEND"] = "Agg"
os.environ.pop("NAVSYM_DEBUG", None)
