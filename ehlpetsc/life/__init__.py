"""Surfaces over their life: wear against fatigue in many passes, of which a few are solved.

>>> from ehlpetsc.life import run_life, read_life, run_regimes
"""

from ehlpetsc.life.driver import run_life
from ehlpetsc.life.history import LifeHistory, read_life
from ehlpetsc.life.regimes import run_regimes

__all__ = ["LifeHistory", "read_life", "run_life", "run_regimes"]
