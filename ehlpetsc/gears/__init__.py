"""Spur gear pairs: path of contact, load sharing, losses, hunting teeth.

Geometry alone: no solver, no PETSc. ``ehlpetsc gears CASE.toml`` prints the table of a ``[gears]``
case and draws it.
"""

from ehlpetsc.gears.geometry import GearPair
from ehlpetsc.gears.path import Path, path_of_contact

__all__ = ["GearPair", "Path", "path_of_contact"]
