"""Surfaces over their life: wear against fatigue in many passes, of which a few are solved.

>>> from ehlpetsc.life import run_life, read_life, run_regimes
"""

from importlib import import_module
from typing import Any

from ehlpetsc.api import need_solver
from ehlpetsc.life.history import LifeHistory, read_life

__all__ = ["LifeHistory", "read_life", "run_life", "run_regimes"]


SOLVING = {"run_life": "driver", "run_regimes": "regimes"}  # modules that import PETSc, unlike reading a life


def __getattr__(name: str) -> Any:
    if name not in SOLVING:
        raise AttributeError(f"module 'ehlpetsc.life' has no attribute {name!r}")
    need_solver()
    return getattr(import_module(f"ehlpetsc.life.{SOLVING[name]}"), name)
