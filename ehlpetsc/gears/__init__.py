"""Gear pairs: geometry, path of contact, load sharing, losses, hunting teeth, standards.

Geometry alone: no solver, no PETSc. ``ehlpetsc gears CASE.toml`` prints the table of a ``[gears]``
case and draws it.
"""

from importlib import import_module

from ehlpetsc.gears.geometry import GearPair

__all__ = ["GearPair", "Path", "path_of_contact"]


def __getattr__(name: str) -> object:
    """Names of the path of contact, which a case without gears does not load."""
    if name in ("Path", "path_of_contact"):
        return getattr(import_module("ehlpetsc.gears.path"), name)
    raise AttributeError(f"module 'ehlpetsc.gears' has no attribute {name!r}")
