"""Surfaces over their life: wear against fatigue in many passes, of which a few are solved.

>>> from ehlpetsc.life import run_life, read_life, run_regimes
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

_HOMES = {"LifeHistory": "history", "read_life": "history", "run_life": "driver", "run_regimes": "regimes"}
__all__ = list(_HOMES)


def __getattr__(name: str) -> Callable | None:
    """Import at first use: reading a life needs no solver."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
