"""Surfaces over their life: wear against fatigue in many passes, of which a few are solved.

>>> from ehlpetsc.life import run_life, read_life
"""

from importlib import import_module
from typing import Any

from ehlpetsc.base.environment import need_solver
from ehlpetsc.life.history import LifeHistory, read_life

__all__ = ["LifeHistory", "read_life", "run_life"]


def __getattr__(name: str) -> Any:
    if name != "run_life":
        raise AttributeError(f"module 'ehlpetsc.life' has no attribute {name!r}")
    need_solver()  # unlike reading a life
    return import_module("ehlpetsc.life.driver").run_life
